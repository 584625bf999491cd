"""The tables of a file as a design; all that is wrong with the whole file is told at once."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping
from typing import Any

from cattrs import BaseValidationError

from core.design import (
    CURVES,
    FOLLOWER_KINDS,
    Design,
    Drive,
    Elastic,
    End,
    FollowerKind,
    Motion,
    Named,
    Segment,
    Shaft,
    part_faults,
    whole_faults,
)
from core.errors import DesignError, Fault
from core.project.counts import require_few_entries
from core.project.hooks import NO_NUMBER, NO_WORD, converter, keys_of, required_keys
from core.project.linkage_reading import linkage_from_table
from core.project.telling import did_you_mean, faults_of, hinted, missing, nearest, spelled, unknown_key
from core.project.writing import FORMAT

_KINDS = ("follower", "linkage", "drives")  # the table that tells the kind
_OPTIONAL = ("loads",)
_KNOWN = ("format", "name", "assumed", "motion", "follower", "cam", "shaft", "loads")
_POINT = re.compile(r"(\.points)\[\d+\]\.\w+$")  # of a spline: assumed one by one, or all together
_ONE_KIND = "exactly one of [follower] | [linkage] | [[drives]]"


def from_table(table: Mapping[str, Any]) -> Design:
    """The design in the tables of a file. Raises DesignError with all faults; with one alone where there is too much of
    something."""
    require_few_entries(table)
    found = [*_format_faults(table), *_name_faults(table), *_kind_faults(table)]
    if next((kind for kind in _KINDS if kind in table), "") == "linkage":
        design, told = linkage_from_table(table, _read)
        if found or told:
            raise DesignError([*found, *told])
        return design
    parts: dict[str, Any] = {}
    if "follower" in table or not any(kind in table for kind in _KINDS):
        row, told = _follower_kind(table)
        unit = row.motion_unit if row else _likely_unit(table)
        found += [*_unknown_keys(table), *_assumed_faults(table, row, unit), *told]
        for name, part in _parts(row).items():
            parts[name], told = _read(table, name, part, unit)
            found += told
    if found:
        raise DesignError(found)
    drive = Drive(parts["motion"], parts["follower"], parts["cam"], parts["loads"])
    return Design(table["name"], parts["shaft"], (drive,), tuple(table.get("assumed", ())))


def motion_from_table(table: Mapping[str, Any], unit: str) -> Motion:
    """A motion that need not be whole, in ``unit``. Raises DesignError with all other faults."""
    require_few_entries({"motion": table})
    motion, found = _read({"motion": table}, "motion", Motion, unit)
    missing_yet = whole_faults(motion, "motion") if motion is not None else []
    if blunders := [fault for fault in found if fault not in missing_yet]:
        raise DesignError(blunders)
    assert isinstance(motion, Motion)
    return motion


# -- the head of the file ---------------------------------------------------------------------------------


def _format_faults(table: Mapping[str, Any]) -> Iterator[Fault]:
    if "format" not in table:
        yield missing("format", str(FORMAT))
    elif type(table["format"]) is not int or table["format"] != FORMAT:
        yield Fault("format", table["format"], "unknown format", str(FORMAT))


def _name_faults(table: Mapping[str, Any]) -> Iterator[Fault]:
    if "name" not in table:
        yield missing("name", "any text")
    elif not isinstance(table["name"], str):
        yield Fault("name", table["name"], "must be text", "any text")
    elif not table["name"].strip():
        yield Fault("name", table["name"], "empty", "any text")


def _kind_faults(table: Mapping[str, Any]) -> Iterator[Fault]:
    there = [kind for kind in _KINDS if kind in table]
    if not there:
        yield missing("follower", _ONE_KIND)
    elif there[0] == "drives":
        yield Fault(there[0], table[there[0]], "this kind of design is not supported yet", "[follower] | [linkage]")
    for other in there[1:]:
        yield Fault(other, table[other], f"stands beside {there[0]}, but a design is of one kind", _ONE_KIND)


def _unknown_keys(table: Mapping[str, Any]) -> Iterator[Fault]:
    for key, value in table.items():
        if key not in _KNOWN and key not in _KINDS:
            yield unknown_key(spelled(key), key, value, _KNOWN)


def _assumed_faults(table: Mapping[str, Any], row: FollowerKind | None, unit: str) -> Iterator[Fault]:
    paths = table.get("assumed", [])
    if not isinstance(paths, list | tuple):
        yield Fault("assumed", paths, "must be a list of field paths")
        return
    if not paths:
        return
    segments = table["motion"].get("segments") if isinstance(table.get("motion"), Mapping) else None
    known = _field_paths(row, unit, len(segments) if isinstance(segments, list | tuple) else 0, _is_elastic(table))
    sure = {path.partition(".")[0] for path in known}  # without the others' kind nothing is known of them
    for i, path in enumerate(paths):
        if not isinstance(path, str):
            yield Fault(f"assumed[{i}]", path, "must be a field path, as text")
        elif _POINT.sub(r"\1", path) not in known and (row or path.partition(".")[0] in sure):
            yield Fault(f"assumed[{i}]", path, f"no such entry in this design{did_you_mean(path, known)}")


def _curve_keys() -> list[str]:
    """What the kinds of curves add to a segment's table."""
    keys = [f.name for curve in (Named, *CURVES.values()) for f in dataclasses.fields(curve) if f.name != "law"]
    ends = [f"{end}.{f.name}" for end in ("start", "end") for f in dataclasses.fields(End)]
    return [*keys, *ends]


def _is_elastic(table: Mapping[str, Any]) -> bool:
    shaft = table.get("shaft")
    return isinstance(shaft, Mapping) and any(f.name in shaft for f in dataclasses.fields(Elastic))


def _field_paths(row: FollowerKind | None, unit: str, segments: int, elastic: bool) -> dict[str, None]:
    """Every path that may be assumed, in the order of the file."""
    parts = {name: part for name, part in _parts(row).items() if part}
    paths = [f"{name}.{key}" for name, part in parts.items() for field, key in keys_of(part, unit).items() if field != "elastic"]
    if elastic:
        paths += [f"shaft.{f.name}" for f in dataclasses.fields(Elastic)]
    of_segment = (*keys_of(Segment, unit).values(), *_curve_keys())
    for i in range(segments):
        paths += [f"motion.segments[{i}].{key}" for key in of_segment]
    return {path: None for path in paths if path != "motion.segments"}


# -- its tables -------------------------------------------------------------------------------------------


def _follower_kind(table: Mapping[str, Any]) -> tuple[FollowerKind | None, list[Fault]]:
    """The row of the follower's kind; where that is misspelt, the one probably meant."""
    follower = table.get("follower")
    if not isinstance(follower, Mapping):
        return None, []  # told with the table itself
    kinds = " | ".join(FOLLOWER_KINDS)
    if "kind" not in follower:
        return None, [missing("follower.kind", kinds)]
    kind = follower["kind"]
    if not isinstance(kind, str):
        return None, [Fault("follower.kind", kind, "must be text", kinds)]
    if kind in FOLLOWER_KINDS:
        return FOLLOWER_KINDS[kind], []
    meant = nearest(kind, tuple(FOLLOWER_KINDS))
    told = [hinted(Fault("follower.kind", kind, "unknown word", kinds))]
    return FOLLOWER_KINDS[meant] if meant else None, told


def _likely_unit(table: Mapping[str, Any]) -> str:
    """The unit of the motion where the follower does not tell."""
    motion = table.get("motion")
    return "deg" if isinstance(motion, Mapping) and "start_deg" in motion else "mm"


def _parts(row: FollowerKind | None) -> dict[str, type | None]:
    """The class of each table, None where it depends on an unknown kind."""

    def of(name: str) -> type | None:
        classes = {getattr(each, name) for each in ([row] if row else FOLLOWER_KINDS.values())}
        return classes.pop() if len(classes) == 1 else None

    return {"motion": Motion, "follower": of("follower"), "cam": of("cam"), "shaft": Shaft, "loads": of("loads")}


def _read(table: Mapping[str, Any], name: str, part: type | None, unit: str) -> tuple[Any, list[Fault]]:
    """One table as a part of the design, and all that is wrong with it."""
    if name not in table and name not in _OPTIONAL:
        keys = f" with {', '.join(required_keys(part, unit))}" if part else ""
        return None, [] if name == "follower" else [missing(name, f"a table [{name}]{keys}")]
    at = table.get(name, {})
    if not isinstance(at, Mapping):
        return None, [Fault(name, at, "must be a table", f"[{name}]")]
    if part is None:
        return None, []
    if name == "follower":
        at = {key: value for key, value in at.items() if key != "kind"}
    found: list[Fault] = []
    try:
        read: Any = converter(unit).structure(at, part)
    except BaseValidationError as error:
        found = list(faults_of(error, name, at, unit))
        read = converter(unit, strict=False).structure(at, part)
    told = {fault.path for fault in found}
    for fault in part_faults(read, name):
        if fault.path not in told and fault.value is not NO_NUMBER and fault.value is not NO_WORD:
            found.append(hinted(fault))
    return read, found
