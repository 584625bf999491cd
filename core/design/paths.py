"""Addresses inside a design, spelled as in the file: ``follower.rod_mm``, ``motion.segments[2].rise_mm``,
``linkage.links[2].points.A``. One walk over the fields of its parts serves forms, edits, ``assumed`` and files alike.

Where a part stands in the file is said by the metadata of its field: a list by number or by name, a part whose keys stand
in the table of the whole. Two coordinates stand in the file as one pair.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import Field, dataclass, fields, is_dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any, cast

from core.design.fields import Info, info_of, placing_of
from core.design.parts import Motion, Segment, curve_of
from core.design.units import NO_UNIT, Unit, split_unit
from core.design.whole import SECTIONS, Design, with_table

_STEP = re.compile(r"(\w+)(?:\[(\d+)\])?$")
Step = tuple[str, int | None]

PAIRS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "points": ("x_mm", "y_mm"),
        "through": ("through_x_mm", "through_y_mm"),
        "centre": ("centre_x_mm", "centre_y_mm"),
    }
)
"""What stands in the file as [x, y] -> the fields it is kept in."""


@dataclass(frozen=True)
class Entry:
    """One value that can be edited: its path, what is known of it, its unit, what stands there."""

    path: str
    info: Info
    unit: Unit
    value: Any


@lru_cache(maxsize=256)
def fields_in_order(part: Any) -> tuple[Field[Any], ...]:
    """The fields of a part as they follow each other in the file: as the class says, else as they are declared."""
    wanted = getattr(part, "FILE_ORDER", ())
    own = {field.name: field for field in fields(part)}
    return tuple(own.pop(name) for name in wanted if name in own) + tuple(own.values())


# -- entries ----------------------------------------------------------------------------------------------


def entries(design: Design, name: str) -> Iterator[Entry]:
    """The entries of one table of the design, in the order of the file; none where it lacks the table."""
    part = design.tables.get(name)
    if part is not None:
        yield from entries_of(part, name, getattr(part, "unit", None))


def entries_of(part: Any, path: str, motion_unit: str | None = None) -> Iterator[Entry]:
    """The entries of a part and of the parts in it, in the order of the file."""
    for field in fields_in_order(cast(Hashable, type(part))):
        value, info, placing = getattr(part, field.name), info_of(field), placing_of(field)
        if info is not None:
            key = _key(part, field.name, motion_unit)
            yield Entry(f"{path}.{key}", info, split_unit(key)[1] or NO_UNIT, value)
        elif is_dataclass(value):
            yield from entries_of(value, path if placing.inside else f"{path}.{field.name}", motion_unit)
        elif isinstance(value, tuple):
            for i, row in enumerate(value):
                if not is_dataclass(row):
                    break
                at = f"{path}.{field.name}.{getattr(row, placing.key)}" if placing.key else f"{path}.{field.name}[{i}]"
                rows = entries_of(row, at, motion_unit)
                yield from (replace(entry, path=at) for entry in rows) if placing.single else rows


def _key(part: Any, name: str, motion_unit: str | None) -> str:
    """The motion's own numbers carry its unit in the file."""
    return f"{name}_{motion_unit}" if motion_unit and isinstance(part, Motion | Segment) and name in ("start", "rise") else name


def all_paths(design: Design) -> Iterator[str]:
    """Every path that may be assumed, in the order of the file: of what stands there as one entry, that one too."""
    seen: set[str] = set()
    for name in SECTIONS:
        for entry in entries(design, name):
            for path in (*_holders(entry.path), entry.path):
                if path not in seen:
                    seen.add(path)
                    yield path


_HOLDERS = (
    (r"(.*\.points)\.(\w+)\.[xy]_mm", (r"\1", r"\1.\2")),
    (r"(.*\.(?:through|centre))_[xy]_mm", (r"\1",)),
    (r"(motion\.segments\[\d+\])\.span_deg", (r"\1.law",)),
    (r"(motion\.segments\[\d+\]\.(?:start|end|points)).*", (r"\1",)),
)


def _holders(path: str) -> Iterator[str]:
    """Entries of the file that hold the value at a path; a segment's law comes before its span."""
    for pattern, holders in _HOLDERS:
        match = re.fullmatch(pattern, path)
        if match:
            yield from (match.expand(holder) for holder in holders)


# -- values -----------------------------------------------------------------------------------------------


def get(design: Design, path: str) -> Any:
    """The value at a path; of a point its pair of coordinates. Raises KeyError where the path leads nowhere."""
    (name, index), *rest = _steps(path)
    if not rest and name in ("name", "assumed", "shaft"):
        return getattr(design, name)
    at = design.tables.get(name)
    if at is None or index is not None:
        return at if at is None and name in design.sections and not rest else _nowhere(path)
    for step in rest:
        at = _item(_child(at, step[0], path), step[1], path)
    single = placing_single(at)
    if single is not None:
        return getattr(at, single)
    return tuple(getattr(at, key) for key in PAIRS["points"]) if _is_pair(at) else at


def put(design: Design, path: str, value: Any) -> Design:
    """The design with the value at a path replaced. Raises KeyError where the path leads nowhere."""
    (name, index), *rest = _steps(path)
    if not rest and name in ("name", "assumed"):
        return replace(design, **{name: value})
    if name not in design.sections or index is not None:
        _nowhere(path)
    if not rest:
        return with_table(design, name, value)
    part = design.tables.get(name)
    return with_table(design, name, _nowhere(path) if part is None else _put(part, rest, value, path))


def _put(at: Any, steps: list[Step], value: Any, path: str) -> Any:
    if not steps:
        if _is_pair(at) and not is_dataclass(value):
            return replace(at, **dict(zip(PAIRS["points"], value, strict=True)))
        single = placing_single(at)
        return value if single is None or is_dataclass(value) else replace(at, **{single: value})
    (name, index), rest = steps[0], steps[1:]
    if isinstance(at, Segment) and name == "law":
        return replace(at, curve=curve_of(value))
    holder = _holding(at, name)
    if holder is not None:
        return replace(at, **{holder: _put(getattr(at, holder), steps, value, path)})
    if name in PAIRS and name not in _names(at) and not rest:
        if PAIRS[name][0] not in _names(at):
            _nowhere(path)
        return replace(at, **dict(zip(PAIRS[name], value, strict=True)))
    field = _field(at, name, path)
    old, placing = getattr(at, field.name), placing_of(field)
    if placing.key and rest:
        return replace(at, **{field.name: _put_row(old, field, rest, value, path)})
    if index is None:
        return replace(at, **{field.name: _put(old, rest, value, path)})
    items = list(old)
    items[index] = _put(_item(old, index, path), rest, value, path)
    return replace(at, **{field.name: tuple(items)})


def _put_row(rows: tuple[Any, ...], field: Field[Any], steps: list[Step], value: Any, path: str) -> tuple[Any, ...]:
    """A row of a list that is told by name; a new one where a row is one value."""
    placing, name = placing_of(field), steps[0][0]
    if any(getattr(row, placing.key) == name for row in rows):
        return tuple(_put(row, steps[1:], value, path) if getattr(row, placing.key) == name else row for row in rows)
    if placing.row is None:
        return _nowhere(path)
    return (*rows, placing.row(name, value))


def _child(at: Any, name: str, path: str) -> Any:
    if isinstance(at, tuple):  # rows by name
        found = [row for row in at if is_dataclass(row) and name in (getattr(row, "name", None), getattr(row, "joint", None))]
        return found[0] if found else _nowhere(path)
    if not is_dataclass(at):
        return _nowhere(path)
    if isinstance(at, Segment) and name == "law":
        return at.curve.law
    holder = _holding(at, name)
    if holder is not None:
        return _child(getattr(at, holder), name, path)
    if name in PAIRS and name not in _names(at) and PAIRS[name][0] in _names(at):
        return tuple(getattr(at, key) for key in PAIRS[name])
    return getattr(at, _field(at, name, path).name)


def _holding(at: Any, name: str) -> str | None:
    """The field of a part inside this one whose keys stand in its table, where ``name`` is one of them."""
    for field in fields(at):
        inner = getattr(at, field.name)
        if placing_of(field).inside and is_dataclass(inner) and name in _names(inner) and name != "law":
            return field.name
    return None


def _field(at: Any, name: str, path: str) -> Field[Any]:
    if isinstance(at, Motion | Segment):
        name = re.sub(r"^(start|rise)_(mm|deg)$", r"\1", name)
    found = next((field for field in fields(at) if field.name == name), None)
    return _nowhere(path) if found is None else found


def _item(items: Any, index: int | None, path: str) -> Any:
    if index is None:
        return items
    return items[index] if isinstance(items, tuple) and index < len(items) else _nowhere(path)


def _is_pair(at: Any) -> bool:
    return is_dataclass(at) and PAIRS["points"][0] in _names(at)


def placing_single(at: Any) -> str | None:
    """The one field of a row that is a single value in the file: a joint's side."""
    return getattr(at, "SINGLE", None) if is_dataclass(at) else None


def _names(part: Any) -> frozenset[str]:
    return _names_of(cast(Hashable, type(part)))


@lru_cache(maxsize=256)
def _names_of(part: Any) -> frozenset[str]:
    return frozenset(field.name for field in fields(part))


def _steps(path: str) -> list[Step]:
    steps: list[Step] = []
    for text in path.split("."):
        match = _STEP.match(text)
        if match is None:
            _nowhere(path)
        else:
            steps.append((match[1], int(match[2]) if match[2] is not None else None))
    return steps


def _nowhere(path: str) -> Any:
    raise KeyError(f"{path}: no such entry in this design")


# -- what is assumed --------------------------------------------------------------------------------------


def is_assumed(design: Design, path: str) -> bool:
    """Whether the value at a path is assumed, itself or with the point or the table of points it stands in."""
    return path in design.assumed or any(path.startswith(f"{each}.") for each in design.assumed)


def with_assumed(design: Design, path: str, on: bool) -> Design:
    """A path marked as assumed, in the order of the file, or no longer: of what is assumed as a whole the other values
    stay so."""
    kept = list(dict.fromkeys(each for each in design.assumed if each != path))
    order = {each: i for i, each in enumerate(all_paths(design))}
    new = [path] if on else []
    for each in [each for each in kept if not on and path.startswith(f"{each}.")]:
        kept.remove(each)
        new += [p for p in order if p.startswith(f"{each}.") and p != path and not path.startswith(f"{p}.") and p not in kept]
    for each in new:
        place = order.get(each, len(order))
        at = next((i for i, p in enumerate(kept) if order.get(p, -1) > place), len(kept))
        kept.insert(at, each)
    return replace(design, assumed=tuple(kept))
