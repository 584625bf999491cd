"""Addresses inside a design, spelled as in the file: ``follower.rod_mm``, ``motion.segments[2].rise_mm``,
``linkage.links[2].points.A``. One walk over the entries of its tables (``fields.slots_of``) serves forms, ranges, edits,
``assumed`` and files alike.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from dataclasses import MISSING, fields, is_dataclass, replace
from functools import lru_cache
from math import nan
from typing import Any, TypeVar

from core.design.design import MOTIONS, Design, with_drive_table, with_table
from core.design.fields import LAW, FileEntry, Info, slots, slots_of
from core.design.parts import Segment, Shaft, curve_of
from core.frozen import frozen
from core.numerics.lazy import Column
from core.units import NO_UNIT, Unit, split_unit

# -- addresses inside a design, spelled as in the file ----------------------------------------------------------


_STEP = re.compile(r"(\w+)(?:\[(\d{1,9})\])?$")
_UNIT_OF_MOTION = re.compile(r"_(mm|deg)$")
Step = tuple[str, int | None]
_NO_ROW = object()
_LISTS = ("drives", "timing")
"""Lists at the top of a file."""
P = TypeVar("P")


@frozen
class Entry:
    """One value that can be edited: its path, what is known of it, its unit, what stands there; in_file: path of the entry
    of the file, which of a pair holds both."""

    path: str
    info: Info
    unit: Unit
    value: Any
    in_file: str


# -- rows of lists ----------------------------------------------------------------------------------------


def row_at(path: str, rows: str = "") -> tuple[str, int, str]:
    """The row of a list that a path leads to or into: the list's path, the row's number from 0, and what of the path lies in the
    row; "", -1 and the path where it leads into none. rows: path of the only list that counts; else the first on the way."""
    name = re.escape(rows) or r"[\w.]+"
    match = re.match(rf"({name})\[(\d{{1,9}})\]\.?", path)
    return (match[1], int(match[2]), path[match.end() :]) if match else ("", -1, path)


def followed(marks: Sequence[str], rows: str, order: Sequence[int | None]) -> tuple[str, ...]:
    """The paths, those into rows of a list with the rows' new numbers, those of rows that are gone left out; order: for each
    row the number that it, or what it is a copy of, had, None where it is new."""
    made: list[str] = []
    for mark in marks:
        name, number, _ = row_at(mark, rows)
        rest = mark.removeprefix(f"{name}[{number}]")
        made += [f"{rows}[{new}]{rest}" for new, old in enumerate(order) if old == number] if name else [mark]
    return tuple(made)


# -- entries ----------------------------------------------------------------------------------------------


def entries(design: Design, name: str) -> Iterator[Entry]:
    """The entries of one table of the design, in the order of the file; none where it lacks the table."""
    part = design.tables.get(name)
    if part is not None:
        yield from entries_of(part, name)


def entries_of(part: Any, path: str) -> Iterator[Entry]:
    """The entries of a part and of the parts in it, in the order of the file."""
    return (entry for _, entry in _walk(part, path, getattr(part, "unit", "")) if entry is not None)


def entry_at(design: Design, path: str) -> Entry | None:
    """The entry at a path; None where the design has none there."""
    for name, part in design.tables.items():
        if path.startswith(f"{name}."):
            for at, entry in _walk(part, name, getattr(part, "unit", ""), path):
                if at == path and entry is not None:
                    return entry
    return None


def by_weight(rows: Iterable[Entry]) -> list[Entry]:
    """Entries with what matters most first: by their weight and order, else as they are; those of each row of a list stay together."""
    found, lists, ranks = list(rows), dict[str, int](), []
    for i, row in enumerate(found):
        of_list, inside, _ = row.path.partition("]")
        at = lists.setdefault(of_list if inside else "", len(lists))
        ranks.append((at, -row.info.weight, row.info.order, i))
    return [found[rank[-1]] for rank in sorted(ranks)]


def names_a_link(path: str, info: Info) -> bool:
    """Whether the whole number at a path says which link is meant, and counts nothing."""
    return info.whole and path.rpartition(".")[2] in ("number", "link", "on", "other")


def all_paths(design: Design) -> Iterator[str]:
    """Every path that may be assumed, in the order of the file: of what stands there as one entry, that one too."""
    for name, part in design.tables.items():
        for path, _ in _walk(part, name, getattr(part, "unit", "")):
            yield path


def in_order(part: Any, unit: str = "") -> list[FileEntry]:
    """The entries of a part's table in the order of the file: a segment's law comes first."""
    return sorted(slots_of(part, unit), key=lambda slot: slot.key != LAW)


def _walk(part: Any, path: str, unit: str, to: str = "") -> Iterator[tuple[str, Entry | None]]:
    """Every path in a part that may be assumed, in the order of the file, with its entry; None of what is no single value:
    a law, a pair, a list of points. to: a path; parts that it does not lead into are left out."""
    for slot in in_order(part, unit):
        holder = getattr(part, slot.within) if slot.within else part
        at, kind = f"{path}.{slot.key}", slot.placing.kind
        if kind is None:
            yield from _values(holder, slot, at, path)
            continue
        value = getattr(holder, slot.names[0])
        if value is None:
            continue
        if slot.placing.whole and value:
            yield at, None
        if slot.placing.key:
            name, only = slots(kind)
            for row in value:
                row_at = f"{path if slot.placing.spread else at}.{getattr(row, name.key)}"
                yield from _values(row, only, row_at, row_at)
        elif isinstance(value, tuple):
            for i, row in enumerate(value):
                if to.startswith(f"{at}[{i}]") or not to:
                    yield from _walk(row, f"{at}[{i}]", unit, to)
        elif to.startswith(at) or not to:
            yield from _walk(value, at, unit, to)


def _values(part: Any, slot: FileEntry, at: str, path: str) -> Iterator[tuple[str, Entry | None]]:
    """The paths of one entry of the file; at: its own, path: of the part whose fields hold it."""
    if slot.info is None:
        if slot.key == LAW:
            yield at, None
    elif not slot.names:
        yield at, Entry(at, slot.info, NO_UNIT, getattr(part, slot.key), at)
    elif len(slot.names) == 1:
        yield at, Entry(at, slot.info, split_unit(slot.key)[1], getattr(part, slot.names[0]), at)
    else:
        yield at, None
        for name, info in zip(slot.names, slot.infos, strict=True):
            yield f"{path}.{name}", Entry(f"{path}.{name}", info, split_unit(name)[1], getattr(part, name), at)


# -- values -----------------------------------------------------------------------------------------------


def get(design: Design, path: str) -> Any:
    """The value at a path; of a point its pair of coordinates. Raises KeyError where the path leads nowhere."""
    (name, index), *steps = _steps(path)
    if not steps and index is None and name in ("name", "assumed", "shaft", "drives", "timing", "balancer"):
        return getattr(design, name)
    part, rest, _ = _table(design, path)
    value, _ = _opened(part, rest, path)
    return _nowhere(path) if value is _NO_ROW else value


def put(design: Design, path: str, value: Any) -> Design:
    """The design with the value at a path replaced. Raises KeyError where the path leads nowhere."""
    (name, index), *steps = _steps(path)
    if not steps and index is None and name in ("name", "assumed", "drives", "timing"):
        return replace(design, **{name: value})
    part, rest, with_part = _table(design, path)
    return with_part(_opened(part, rest, path)[1](value))


def _table(design: Design, path: str) -> tuple[Any, Sequence[Step], Callable[[Any], Design]]:
    """The table of the design that a path begins with, None where the design could have it; the steps from there on; the
    function that gives the design with another one."""
    (name, index), *steps = _steps(path)
    if name in _LISTS and index is not None and design.listed:
        rows = getattr(design, name)
        if index >= len(rows):
            return _nowhere(path)

        def with_row(row: Any) -> Design:
            changed: dict[str, Any] = {name: (*rows[:index], row, *rows[index + 1 :])}
            return replace(design, **changed)

        if name == "drives" and steps and steps[0][1] is None and _named(steps)[0] in rows[index].sections:
            drive, (table, rest) = rows[index], _named(steps)
            part = drive.tables.get(table)
            return (
                _nowhere(path)
                if part is None and rest
                else (part, rest, lambda new: with_row(with_drive_table(drive, table, new)))
            )
        return rows[index], steps, with_row
    name, steps = _named([(name, None), *steps])
    part = design.tables.get(name)
    if index is not None or name not in design.sections or (steps and part is None):
        return _nowhere(path)
    return part, steps, lambda new: with_table(design, name, new)


def _named(steps: Sequence[Step]) -> tuple[str, list[Step]]:
    """The name of the table that steps begin with, and the rest: of a second driver's motion two of them are the name."""
    (name, _), *rest = steps
    if f"{name}." == MOTIONS and rest:
        return f"{MOTIONS}{rest[0][0]}", rest[1:]
    return name, rest


def _opened(part: Any, steps: Sequence[Step], path: str) -> tuple[Any, Callable[[Any], Any]]:
    """What stands at the steps from a part, and the function that gives the part with another value there."""
    if not steps:
        return part, lambda value: value
    (name, index), *rest = steps
    if isinstance(part, Segment) and name == LAW and not rest:
        return part.curve.law, lambda value: replace(part, curve=curve_of(value))
    slot = _slot(part, name, path)
    if slot.placing.word and index is None and not rest:
        old = getattr(part, slot.within)
        return getattr(old, name), lambda value: replace(
            part, **{slot.within: of_class(slot.placing.words[value], old)}
        )
    if slot.within:
        inner, put_inner = _opened(getattr(part, slot.within), steps, path)
        return inner, lambda value: replace(part, **{slot.within: put_inner(value)})
    if slot.info is not None and index is None and not rest:
        return _value(part, slot, name)
    field = slot.names[0]
    old = getattr(part, field)
    if slot.placing.spread:
        rest = list(steps)
    if slot.placing.key and rest:
        inner, put_inner = _row(old, slot, rest, path)
    elif index is None:
        inner, put_inner = _opened(old, rest, path)
    elif isinstance(old, tuple) and index < len(old):
        inner, put_row = _opened(old[index], rest, path)

        def put_inner(value: Any) -> Any:
            return (*old[:index], put_row(value), *old[index + 1 :])
    else:
        return _nowhere(path)
    return inner, lambda value: replace(part, **{field: put_inner(value)})


def of_class(kind: type[P], *others: Any, **values: Any) -> P:
    """A part of this class: each field as given, else as another part has it that has a field of that name, else at its
    default; no number where there is none."""
    made: dict[str, Any] = {}
    for each in fields(kind):  # type: ignore[arg-type]
        given = [getattr(other, each.name) for other in others if hasattr(other, each.name)]
        if each.name in values or given:
            made[each.name] = values[each.name] if each.name in values else given[0]
        elif each.default is MISSING and each.default_factory is MISSING:
            made[each.name] = nan
    return kind(**made)


def _value(part: Any, slot: FileEntry, name: str) -> tuple[Any, Callable[[Any], Any]]:
    """The entry of a part, or one of the two fields of a pair."""
    names = (name,) if name in slot.names else slot.names
    if len(names) == 1:
        return getattr(part, names[0]), lambda value: replace(part, **{names[0]: value})
    pair = tuple(getattr(part, each) for each in names)
    return pair, lambda value: value if is_dataclass(value) else replace(part, **dict(zip(names, value, strict=True)))


def _row(rows: tuple[Any, ...], slot: FileEntry, steps: Sequence[Step], path: str) -> tuple[Any, Callable[[Any], Any]]:
    """A row that is told by its name, or a value of it; a new one where there is none of that name and it is one value."""
    key, only = slots(slot.placing.kind)
    (name, _), *rest = steps
    place = next((i for i, row in enumerate(rows) if getattr(row, key.key) == name), len(rows))
    if place == len(rows):
        if rest or len(only.names) > 1:
            return _nowhere(path)
        return _NO_ROW, lambda value: (*rows, slot.placing.kind(name, value))
    inner, put_inner = _opened(rows[place], rest, path) if rest else _value(rows[place], only, only.key)
    return inner, lambda value: (*rows[:place], put_inner(value), *rows[place + 1 :])


def _slot(part: Any, name: str, path: str) -> FileEntry:
    """The entry of a part's table of this key, or held in a field of this name."""
    if not is_dataclass(part):
        return _nowhere(path)
    plain = _UNIT_OF_MOTION.sub("", name)
    for slot in slots_of(part):
        if name == slot.key or name in slot.names or (slot.info and slot.info.of_motion and plain == slot.key):
            return slot
    return next((slot for slot in slots_of(part) if slot.placing.spread), None) or _nowhere(path)


def _steps(path: str) -> list[Step]:
    matches = [_STEP.match(text) for text in path.split(".")]
    return [
        (match[1], None if match[2] is None else int(match[2])) if match is not None else _nowhere(path)
        for match in matches
    ]


def _nowhere(path: str) -> Any:
    raise KeyError(f"{path}: no such entry in this design")


# -- what is assumed --------------------------------------------------------------------------------------


def is_assumed(design: Design, path: str) -> bool:
    """Whether the value at a path is assumed, itself or with the point or the table of points it stands in."""
    return path in design.assumed or any(path.startswith(f"{each}.") for each in design.assumed)


def with_guesses_marked(design: Design, given: Container[str] = ()) -> Design:
    """The numbers of the shaft that are guessed marked as assumed, but those of the given keys."""
    for slot in slots(Shaft):
        if slot.info is not None and slot.info.guessed and slot.key not in given:
            design = with_assumed(design, f"shaft.{slot.key}", True)
    return design


def with_assumed(design: Design, path: str, on: bool) -> Design:
    """A path marked as assumed, in the order of the file, or no longer: of what is assumed as a whole the other values
    stay so."""
    kept = list(dict.fromkeys(each for each in design.assumed if each != path))
    order = {each: i for i, each in enumerate(all_paths(design))}
    new = [path] if on else []
    for each in [each for each in kept if not on and path.startswith(f"{each}.")]:
        kept.remove(each)
        new += [
            p
            for p in order
            if p.startswith(f"{each}.") and p != path and not path.startswith(f"{p}.") and p not in kept
        ]
    for each in new:
        place = order.get(each, len(order))
        at = next((i for i, p in enumerate(kept) if order.get(p, -1) > place), len(kept))
        kept.insert(at, each)
    return replace(design, assumed=tuple(kept))


# -- the parts of a design in SI units and radians --------------------------------------------------------------


class SI:
    """The same part in SI and radians; names lose their unit suffix: ``rod_mm`` -> ``rod`` [m]."""

    def __init__(self, part: Any) -> None:
        for f in fields(part):
            value = getattr(part, f.name)
            name, unit = split_unit(f.name)
            is_number = isinstance(value, int | float | Column) and not isinstance(value, bool)
            self.__dict__[name] = value * unit.factor if is_number else value

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("read-only")


@lru_cache(maxsize=64)
def si(part: Any) -> SI:
    """The part of a design in SI units and radians (cached: parts are frozen)."""
    return SI(part)
