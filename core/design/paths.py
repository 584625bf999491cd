"""Paths of values in a design, as in the file: ``follower.rod_mm``, ``motion.segments[2].rise_mm``, ``linkage.links[2].points.A``.

Forms, ranges, edits, assumed values and files all walk over the same entries (``fields.slots_of``).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from dataclasses import MISSING, fields, is_dataclass, replace
from functools import lru_cache
from math import nan
from typing import Any, TypeVar

from core.design.design import MOTIONS, SHARED, Design, with_drive_table, with_table
from core.design.fields import LAW, FileEntry, Info, slots, slots_of
from core.design.motions import Segment, curve_of
from core.design.parts import Shaft
from core.frozen import frozen
from core.numerics.lazy import Column
from core.units import NO_UNIT, Unit, split_unit

# -- entries of a design ----------------------------------------------------------------------------------------


_STEP = re.compile(r"(\w+)(?:\[(\d{1,9})\])?$")
_UNIT_OF_MOTION = re.compile(r"_(mm|deg)$")
Step = tuple[str, int | None]
_NO_ROW = object()
_LISTS = ("drives", "timing", "outlines", "clearances")
"""Lists at the top of a file; the first two only where the design lists its drives."""
P = TypeVar("P")


@frozen
class Entry:
    """One value that can be edited.

    Attributes
    ----------
    path : of the value
    info, unit, value : its metadata, unit and present value
    in_file : path of its entry in the file, which for a pair has both values
    """

    path: str
    info: Info
    unit: Unit
    value: Any
    in_file: str


# -- rows of lists ----------------------------------------------------------------------------------------


def row_at(path: str, rows: str = "") -> tuple[str, int, str]:
    """Split a path at a row of a list: the list's path, the row's number from 0, and the rest of the path.

    ("", -1, path) where the path has no row. ``rows`` is the path of the list; without it the first list counts.
    """
    name = re.escape(rows) or r"[\w.]+"
    match = re.match(rf"({name})\[(\d{{1,9}})\]\.?", path)
    return (match[1], int(match[2]), path[match.end() :]) if match else ("", -1, path)


def followed(marks: Sequence[str], rows: str, order: Sequence[int | None]) -> tuple[str, ...]:
    """Paths with the new numbers of reordered rows of a list, without those of removed rows.

    ``order`` is the previous number of each row or of its original, None for a new row.
    """
    result: list[str] = []
    for mark in marks:
        name, number, _ = row_at(mark, rows)
        rest = mark.removeprefix(f"{name}[{number}]")
        result += [f"{rows}[{new}]{rest}" for new, old in enumerate(order) if old == number] if name else [mark]
    return tuple(result)


# -- entries of a table -----------------------------------------------------------------------------------


def entries(design: Design, name: str) -> Iterator[Entry]:
    """Entries of one table of the design, in the order of the file; empty without the table."""
    part = design.tables.get(name)
    if part is not None:
        yield from entries_of(part, name)


def entries_of(part: Any, path: str) -> Iterator[Entry]:
    """Entries of a part and of its inner parts, in the order of the file."""
    return (entry for _, entry in _walk(part, path, getattr(part, "unit", "")) if entry is not None)


def entry_at(design: Design, path: str) -> Entry | None:
    """Entry at a path; None where the design has none."""
    for name, part in design.tables.items():
        if path.startswith(f"{name}."):
            for at, entry in _walk(part, name, getattr(part, "unit", ""), path):
                if at == path and entry is not None:
                    return entry
    return None


def by_weight(rows: Iterable[Entry]) -> list[Entry]:
    """Entries sorted by weight, then order; entries of one row of a list stay together."""
    unsorted, lists, ranks = list(rows), dict[str, int](), []
    for i, row in enumerate(unsorted):
        of_list, inside, _ = row.path.partition("]")
        at = lists.setdefault(of_list if inside else "", len(lists))
        ranks.append((at, -row.info.weight, row.info.order, i))
    return [unsorted[rank[-1]] for rank in sorted(ranks)]


def names_a_link(path: str, info: Info) -> bool:
    """Whether the whole number at a path is the number of a link, not a count."""
    return info.whole and path.rpartition(".")[2] in ("number", "link", "on", "other")


def all_paths(design: Design) -> Iterator[str]:
    """All paths that can be assumed, in the order of the file, with those of pairs and lists that are one entry."""
    for name, part in design.tables.items():
        yield from (path for path, _ in _walk(part, name, getattr(part, "unit", "")))


def text_paths(design: Design) -> Iterator[str]:
    """Paths of texts that are given: names of the design and its drives, laws, points of loads, events of a sequence."""
    yield "name"
    for name, part in design.tables.items():
        yield from _texts(part, name)


def _texts(part: Any, path: str) -> Iterator[str]:
    """Paths of the texts of a part and of the rows of its lists."""
    for slot in slots_of(part):
        if slot.key == LAW:
            yield f"{path}.{LAW}"
        elif slot.info is None and slot.names:
            value = getattr(getattr(part, slot.within) if slot.within else part, slot.names[0])
            at = f"{path}.{slot.key}"
            if isinstance(value, str):
                yield at
            elif is_dataclass(value):
                yield from _texts(value, at)
            elif isinstance(value, tuple) and not slot.placing.key:
                for i, row in enumerate(value):
                    if is_dataclass(row):
                        yield from _texts(row, f"{at}[{i}]")


def in_order(part: Any, unit: str = "") -> list[FileEntry]:
    """Entries of a part's table in the order of the file, a segment's law first."""
    return sorted(slots_of(part, unit), key=lambda slot: slot.key != LAW)


def _walk(part: Any, path: str, unit: str, to: str = "") -> Iterator[tuple[str, Entry | None]]:
    """Paths in a part that can be assumed, in the order of the file, with their entries; None for a law, a pair or a list.

    With a path ``to``, only parts on the way to it are visited.
    """
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
    """Paths of one entry of the file; ``at`` is its path, ``path`` that of the part with its fields."""
    if slot.info is None:
        if slot.key == LAW:
            yield at, None
    elif not slot.names:
        yield at, Entry(at, slot.info, NO_UNIT, getattr(part, slot.key), at)
    elif len(slot.names) == 1:
        yield at, Entry(at, slot.info, split_unit(slot.key)[1], getattr(part, slot.names[0]), at)
    else:
        yield at, None
        yield from (
            (f"{path}.{name}", Entry(f"{path}.{name}", info, split_unit(name)[1], getattr(part, name), at))
            for name, info in zip(slot.names, slot.infos, strict=True)
        )


# -- values -----------------------------------------------------------------------------------------------


def get(design: Design, path: str) -> Any:
    """Value at a path; for a point its pair of coordinates.

    Raises
    ------
    KeyError
        Where the design has no such path.
    """
    (name, index), *steps = _steps(path)
    if not steps and index is None and name in ("name", "assumed", *SHARED, *_LISTS, "balancer"):
        return getattr(design, name)
    part, rest, _ = _table(design, path)
    value, _ = _lens(part, rest, path)
    return _no_entry(path) if value is _NO_ROW else value


def put(design: Design, path: str, value: Any) -> Design:
    """Design with the value at a path replaced.

    Raises
    ------
    KeyError
        Where the design has no such path.
    """
    (name, index), *steps = _steps(path)
    if not steps and index is None and name in ("name", "assumed", *_LISTS):
        return replace(design, **{name: value})
    part, rest, with_part = _table(design, path)
    return with_part(_lens(part, rest, path)[1](value))


def _table(design: Design, path: str) -> tuple[Any, Sequence[Step], Callable[[Any], Design]]:
    """Table at the start of a path, None where the design could have it, and the remaining steps.

    Also a function of a new table that returns the changed design.
    """
    (name, index), *steps = _steps(path)
    if name in _LISTS and index is not None and (design.listed or name not in _LISTS[:2]):
        rows = getattr(design, name)
        if index >= len(rows):
            return _no_entry(path)

        def with_row(row: Any) -> Design:
            changed: dict[str, Any] = {name: (*rows[:index], row, *rows[index + 1 :])}
            return replace(design, **changed)

        if name == "drives" and steps and steps[0][1] is None and _named(steps)[0] in rows[index].sections:
            drive, (table, rest) = rows[index], _named(steps)
            part = drive.tables.get(table)
            return (
                _no_entry(path)
                if part is None and rest
                else (part, rest, lambda new: with_row(with_drive_table(drive, table, new)))
            )
        return rows[index], steps, with_row
    name, steps = _named([(name, None), *steps])
    part = design.tables.get(name)
    if index is not None or name not in design.sections or (steps and part is None):
        return _no_entry(path)
    return part, steps, lambda new: with_table(design, name, new)


def _named(steps: Sequence[Step]) -> tuple[str, list[Step]]:
    """Name of the table at the start of steps, and the rest; the name of a second driver's motion has two steps."""
    (name, _), *rest = steps
    if f"{name}." == MOTIONS and rest:
        return f"{MOTIONS}{rest[0][0]}", rest[1:]
    return name, rest


def _lens(part: Any, steps: Sequence[Step], path: str) -> tuple[Any, Callable[[Any], Any]]:
    """Value at steps from a part, and a function of a new value that returns the changed part."""
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
        inner, put_inner = _lens(getattr(part, slot.within), steps, path)
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
        inner, put_inner = _lens(old, rest, path)
    elif isinstance(old, tuple) and index < len(old):
        inner, put_row = _lens(old[index], rest, path)

        def put_inner(value: Any) -> Any:
            return (*old[:index], put_row(value), *old[index + 1 :])
    else:
        return _no_entry(path)
    return inner, lambda value: replace(part, **{field: put_inner(value)})


def of_class(kind: type[P], *sources: Any, **values: Any) -> P:
    """Part of a class, with each field from the values, else from the first source part that has it, else its default.

    A number without a default is NaN, a text is empty, and a part has such values itself: ``faults`` reports them.
    """
    arguments: dict[str, Any] = {}
    for part in fields(kind):  # type: ignore[arg-type]
        given = [getattr(source, part.name) for source in sources if hasattr(source, part.name)]
        if part.name in values or given:
            arguments[part.name] = values[part.name] if part.name in values else given[0]
        elif part.default is MISSING and part.default_factory is MISSING:
            arguments[part.name] = _blank(kind, part.name)
    return kind(**arguments)


def _blank(kind: Any, name: str) -> Any:
    """Value of a field that a file must give, before it is typed."""
    slot = next((slot for slot in slots(kind) if name in slot.names), None)
    if slot is None or slot.info is not None:
        return nan
    return of_class(slot.placing.kind) if slot.placing.single else ""


def _value(part: Any, slot: FileEntry, name: str) -> tuple[Any, Callable[[Any], Any]]:
    """Value of an entry of a part, or of one field of a pair, and a function that replaces it."""
    names = (name,) if name in slot.names else slot.names
    if len(names) == 1:
        return getattr(part, names[0]), lambda value: replace(part, **{names[0]: value})
    pair = tuple(getattr(part, field) for field in names)
    return pair, lambda value: value if is_dataclass(value) else replace(part, **dict(zip(names, value, strict=True)))


def _row(rows: tuple[Any, ...], slot: FileEntry, steps: Sequence[Step], path: str) -> tuple[Any, Callable[[Any], Any]]:
    """Row of a list by its name, or a value in it; an unknown name adds a row where rows have one value."""
    key, only = slots(slot.placing.kind)
    (name, _), *rest = steps
    index = next((i for i, row in enumerate(rows) if getattr(row, key.key) == name), len(rows))
    if index == len(rows):
        if rest or len(only.names) > 1:
            return _no_entry(path)
        return _NO_ROW, lambda value: (*rows, slot.placing.kind(name, value))
    inner, put_inner = _lens(rows[index], rest, path) if rest else _value(rows[index], only, only.key)
    return inner, lambda value: (*rows[:index], put_inner(value), *rows[index + 1 :])


def _slot(part: Any, name: str, path: str) -> FileEntry:
    """Entry of a part's table by its key, or by the name of its field."""
    if not is_dataclass(part):
        return _no_entry(path)
    plain = _UNIT_OF_MOTION.sub("", name)
    for slot in slots_of(part):
        if name == slot.key or name in slot.names or (slot.info and slot.info.of_motion and plain == slot.key):
            return slot
    return next((slot for slot in slots_of(part) if slot.placing.spread), None) or _no_entry(path)


def _steps(path: str) -> list[Step]:
    matches = [_STEP.match(text) for text in path.split(".")]
    return [
        (match[1], None if match[2] is None else int(match[2])) if match is not None else _no_entry(path)
        for match in matches
    ]


def _no_entry(path: str) -> Any:
    raise KeyError(f"{path}: no such entry in this design")


# -- assumed values ---------------------------------------------------------------------------------------


def is_assumed(design: Design, path: str) -> bool:
    """Whether the value at a path is assumed, by itself or with its point or list of points."""
    return path in design.assumed or any(path.startswith(f"{mark}.") for mark in design.assumed)


def with_guesses_marked(design: Design, given: Container[str] = ()) -> Design:
    """Design with the default numbers of the shaft marked as assumed, except those of the given keys."""
    for slot in slots(Shaft):
        if slot.info is not None and slot.info.guessed and slot.key not in given:
            design = with_assumed(design, f"shaft.{slot.key}", True)
    return design


def with_assumed(design: Design, path: str, on: bool) -> Design:
    """Design with a path marked as assumed, in the order of the file, or unmarked.

    Where a list or a pair is marked in one entry, unmarking a value of it leaves its other values marked.
    """
    marks = list(dict.fromkeys(mark for mark in design.assumed if mark != path))
    order = {entry: i for i, entry in enumerate(all_paths(design))}
    new = [path] if on else []
    for mark in [mark for mark in marks if not on and path.startswith(f"{mark}.")]:
        marks.remove(mark)
        new += [
            p
            for p in order
            if p.startswith(f"{mark}.") and p != path and not path.startswith(f"{p}.") and p not in marks
        ]
    for mark in new:
        rank = order.get(mark, len(order))
        at = next((i for i, p in enumerate(marks) if order.get(p, -1) > rank), len(marks))
        marks.insert(at, mark)
    return replace(design, assumed=tuple(marks))


# -- SI units and radians ---------------------------------------------------------------------------------------


_NUMBERS = (float, int, Column)


@lru_cache(maxsize=256)
def _si_fields(kind: Any) -> tuple[tuple[str, str, float], ...]:
    """Fields of a type of part: name, name without the suffix of the unit, and factor of the unit."""
    split = [(field.name, *split_unit(field.name)) for field in fields(kind)]
    return tuple((key, name, unit.factor) for key, name, unit in split)


class SI:
    """A part in SI units and radians; its fields have no unit suffix: ``rod_mm`` becomes ``rod`` [m]."""

    def __init__(self, part: Any) -> None:
        kind: Any = type(part)
        values = vars(part)
        for key, name, factor in _si_fields(kind):
            value = values[key]
            is_number = isinstance(value, _NUMBERS) and value is not True and value is not False
            self.__dict__[name] = value * factor if is_number else value

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("read-only")


@lru_cache(maxsize=64)
def si(part: Any) -> SI:
    """Part of a design in SI units and radians; cached, since parts are frozen."""
    return SI(part)
