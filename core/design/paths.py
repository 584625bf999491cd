"""Addresses inside a design, spelled as in the file: ``follower.rod_mm``, ``motion.segments[2].rise_mm``.

Forms, edits, ``assumed`` and headless variations all name a value so.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

from core.design.fields import Info, info_of
from core.design.parts import Motion, Segment, SingleCam, curve_of
from core.design.units import NO_UNIT, UNITS, Unit, split_unit

SECTIONS = ("motion", "follower", "cam", "shaft", "loads")
_STEP = re.compile(r"([A-Za-z_0-9]+)(?:\[(\d+)\])?$")


@dataclass(frozen=True)
class Entry:
    """One value that can be edited: its path, what is known of it, its unit, what stands there."""

    path: str
    info: Info
    unit: Unit
    value: Any


def section(design: SingleCam, name: str) -> Any:
    """One table of the file: ``motion``, ``follower``, ``cam``, ``shaft`` or ``loads``."""
    return design.shaft if name == "shaft" else getattr(design.drive, name)


def with_section(design: SingleCam, name: str, part: Any) -> SingleCam:
    """The design with one table replaced."""
    if name == "shaft":
        return replace(design, shaft=part)
    return replace(design, drive=replace(design.drive, **{name: part}))


def entries(design: SingleCam, name: str) -> Iterator[Entry]:
    """The entries of one table, in the order of the file; the motion's segments are walked too."""
    part = section(design, name)
    yield from _part_entries(part, name, getattr(part, "unit", None))
    if isinstance(part, Motion):
        for i, segment in enumerate(part.segments):
            yield from _part_entries(segment, f"{name}.segments[{i}]", part.unit)
            yield from _part_entries(segment.curve, f"{name}.segments[{i}]", None)


def _part_entries(part: Any, path: str, motion_unit: str | None) -> Iterator[Entry]:
    for field in fields(part):
        info = info_of(field)
        if info is None:
            continue
        in_motion_unit = motion_unit is not None and field.name in ("start", "rise")
        key = f"{field.name}_{motion_unit}" if in_motion_unit else field.name
        unit = UNITS[motion_unit] if in_motion_unit and motion_unit else split_unit(field.name)[1]
        yield Entry(f"{path}.{key}", info, unit or NO_UNIT, getattr(part, field.name))


def get(design: SingleCam, path: str) -> Any:
    """The value at a path. Raises KeyError where the path leads nowhere."""
    at: Any = None
    try:
        for name, index in _steps(path, design.drive.motion.unit):
            at = _child(design, at, name, path)
            if index is not None:
                at = at[index]
    except (IndexError, TypeError):
        _nowhere(path)
    return at


def put(design: SingleCam, path: str, value: Any) -> SingleCam:
    """The design with the value at a path replaced. Raises KeyError where the path leads nowhere."""
    steps = _steps(path, design.drive.motion.unit)
    if steps == [("name", None)] or steps == [("assumed", None)]:
        return replace(design, **{steps[0][0]: value})
    top = section(design, steps[0][0]) if steps[0][0] in SECTIONS else _nowhere(path)
    try:
        return with_section(design, steps[0][0], _put(top, steps[1:], value, path))
    except (IndexError, TypeError):
        return _nowhere(path)


def _put(part: Any, steps: list[tuple[str, int | None]], value: Any, path: str) -> Any:
    if not steps:
        return value
    (name, index), rest = steps[0], steps[1:]
    if isinstance(part, Segment) and name == "law":
        return replace(part, curve=curve_of(value))
    if isinstance(part, Segment) and name in _names(part.curve):  # a curve's keys stand in the segment's table
        return replace(part, curve=_put(part.curve, steps, value, path))
    key = _field_name(part, name, path)
    if index is None:
        return replace(part, **{key: _put(getattr(part, key), rest, value, path)})
    items = list(getattr(part, key))
    items[index] = _put(items[index], rest, value, path)
    return replace(part, **{key: tuple(items)})


def _child(design: SingleCam, at: Any, name: str, path: str) -> Any:
    if at is None:
        if name in SECTIONS:
            return section(design, name)
        return getattr(design, name) if name in ("name", "assumed") else _nowhere(path)
    if isinstance(at, Segment) and name == "law":
        return at.curve.law
    if isinstance(at, Segment) and name in _names(at.curve):
        return getattr(at.curve, name)
    return getattr(at, _field_name(at, name, path))


def _field_name(part: Any, name: str, path: str) -> str:
    return name if name in _names(part) else _nowhere(path)


def _names(part: Any) -> set[str]:
    return {f.name for f in fields(part)}


def _steps(path: str, motion_unit: str) -> list[tuple[str, int | None]]:
    """Names of fields and indices: the motion's own numbers lose the unit that they carry in the file."""
    in_file = {f"{name}_{motion_unit}": name for name in ("start", "rise")}
    steps = []
    for text in path.split("."):
        match = _STEP.match(text)
        if match is None:
            _nowhere(path)
        else:
            steps.append((in_file.get(match[1], match[1]), int(match[2]) if match[2] is not None else None))
    return steps


def _nowhere(path: str) -> Any:
    raise KeyError(f"{path}: no such entry in this design")
