"""Addresses inside a design, spelled as in the file: ``follower.rod_mm``, ``motion.segments[2].rise_mm``.

Forms, edits, ``assumed`` and headless variations all name a value so.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

from core.design.fields import Info, info_of
from core.design.parts import Elastic, Motion, Segment, Shaft, SingleCam, curve_of
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
    yield from motion_entries(part) if isinstance(part, Motion) else _part_entries(part, name, None)
    if isinstance(part, Shaft) and part.elastic is not None:
        yield from _part_entries(part.elastic, name, None)


def motion_entries(motion: Motion) -> Iterator[Entry]:
    """The entries of a motion and its segments."""
    yield from _part_entries(motion, "motion", motion.unit)
    for i, segment in enumerate(motion.segments):
        yield from _part_entries(segment, f"motion.segments[{i}]", motion.unit)
        yield from _part_entries(segment.curve, f"motion.segments[{i}]", None)


def motion_get(motion: Motion, path: str) -> Any:
    """The value at a path below ``motion``. Raises KeyError where the path leads nowhere."""
    return _walk(None, motion, _steps(path, motion.unit)[1:], path)


def motion_put(motion: Motion, path: str, value: Any) -> Motion:
    """The motion with the value at such a path replaced. Raises KeyError where the path leads nowhere."""
    try:
        changed: Motion = _put(motion, _steps(path, motion.unit)[1:], value, path)
    except (IndexError, TypeError):
        return _nowhere(path)
    return changed


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
    return _walk(design, None, _steps(path, design.drive.motion.unit), path)


def _walk(design: SingleCam | None, at: Any, steps: list[tuple[str, int | None]], path: str) -> Any:
    try:
        for name, index in steps:
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


def with_elastic(design: SingleCam, elastic: Elastic | None) -> SingleCam:
    """The design with a flexible shaft, or with a rigid one: then nothing is assumed of its elasticity any more."""
    gone = {f"shaft.{name}" for name in _names(Elastic)} if elastic is None else set()
    assumed = tuple(path for path in design.assumed if path not in gone)
    return replace(with_section(design, "shaft", replace(design.shaft, elastic=elastic)), assumed=assumed)


def _put(part: Any, steps: list[tuple[str, int | None]], value: Any, path: str) -> Any:
    if not steps:
        return value
    (name, index), rest = steps[0], steps[1:]
    if isinstance(part, Segment) and name == "law":
        return replace(part, curve=curve_of(value))
    if isinstance(part, Segment) and name in _names(part.curve):  # a curve's keys stand in the segment's table
        return replace(part, curve=_put(part.curve, steps, value, path))
    if isinstance(part, Shaft) and part.elastic is not None and name in _names(Elastic):
        return replace(part, elastic=_put(part.elastic, steps, value, path))
    key = _field_name(part, name, path)
    if index is None:
        return replace(part, **{key: _put(getattr(part, key), rest, value, path)})
    items = list(getattr(part, key))
    items[index] = _put(items[index], rest, value, path)
    return replace(part, **{key: tuple(items)})


def _child(design: SingleCam | None, at: Any, name: str, path: str) -> Any:
    if at is None and design is not None:
        if name in SECTIONS:
            return section(design, name)
        return getattr(design, name) if name in ("name", "assumed") else _nowhere(path)
    if isinstance(at, Segment) and name == "law":
        return at.curve.law
    if isinstance(at, Segment) and name in _names(at.curve):
        return getattr(at.curve, name)
    if isinstance(at, Shaft) and at.elastic is not None and name in _names(Elastic):
        return getattr(at.elastic, name)
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
