"""The tables of a linkage's file as a design; all that is wrong is told at once."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from core.design import (
    MOTION,
    Design,
    Drive,
    Driver,
    Link,
    Linkage,
    LinkageCam,
    LinkageLoads,
    LinkForce,
    LinkMass,
    Motion,
    Place,
    Shaft,
    Side,
    Slider,
    faults,
    info_of,
)
from core.design.paths import PAIRS, all_paths
from core.design.topology import driver_pair, is_pin
from core.errors import MISSING, Fault
from core.project.hooks import NO_NUMBER, NO_WORD
from core.project.tables import Table
from core.project.telling import did_you_mean, hinted, missing, spelled, unknown_key

_KNOWN = ("format", "name", "assumed", "motion", "linkage", "cam", "shaft", "loads")
_MOTION_SPEED = 60.0  # [rpm] of a motion's shaft where the file does not say: one turn a second
_STRUCTURE = r"linkage|linkage\.links\[\d+\]|linkage\.branch\..*|linkage\.driver\.(link|kind)|.*\.(link|on|point)"
"""Paths of faults that may follow from links that could not be read."""
ReadPart = Callable[[Mapping[str, Any], str, type, str], tuple[Any, list[Fault]]]


def linkage_from_table(table: Mapping[str, Any], read: ReadPart) -> tuple[Design, list[Fault]]:
    """The design as far as it can be read, and all that is wrong but for the head of the file; ``read`` reads a table of
    the file as a part, its motion in a unit."""
    found: list[Fault] = []
    for key, value in table.items():
        if key not in _KNOWN and key not in ("follower", "drives"):
            found.append(unknown_key(spelled(key), key, value, _KNOWN))
    shaft: Shaft | None = None
    if "shaft" in table:
        shaft, told = read(table, "shaft", Shaft, "mm")
        found += told
    linkage = _linkage(table["linkage"], found, shaft)
    motion: Motion | None = None
    if "motion" in table:
        motion, told = read(table, "motion", Motion, _unit(linkage, table["motion"]))
        found += told
    cam = None
    if "cam" in table:
        cam = Table(table["cam"], "cam", found).part(LinkageCam, {}, {})
    loads = _loads(table.get("loads", {}), found)
    name = table.get("name", "")
    assumed = table.get("assumed", ())
    plain = tuple(p for p in assumed if isinstance(p, str)) if isinstance(assumed, list | tuple) else ()
    design = Design(name, shaft, (Drive(motion, linkage, cam, loads),), plain)
    found += _rule_faults(design, found, "motion" in table)
    found += _assumed_faults(assumed, design)
    return design, found


def _linkage(at: Any, found: list[Fault], shaft: Shaft | None) -> Linkage:
    table = Table(at, "linkage", found)
    links = tuple(row.part(Link, {}, {"points": _points(row)}) for row in table.rows("links"))
    if table.is_table and "links" not in table.entries:
        found.append(missing("linkage.links", "[[linkage.links]] with number and points"))
    sliders = tuple(row.part(Slider, {"through": PAIRS["through"]}, {}) for row in table.rows("sliders"))
    driver = table.take("driver", lambda value: _driver(Table(value, "linkage.driver", found), shaft), NO_NUMBER)
    if driver is NO_NUMBER:
        driver = Driver(NO_NUMBER, NO_WORD)
        if table.is_table:
            found.append(missing("linkage.driver", '{ link = 2, kind = "crank", speed_rpm = 60.0 }'))
    branch = table.take("branch", lambda value: _branch(Table(value, "linkage.branch", found)), ())
    table.rest()
    return Linkage(links, sliders, driver, branch)


def _driver(table: Table, shaft: Shaft | None) -> Driver:
    """The driver; where the shaft says how fast it turns, it need not."""
    given: dict[str, Any] = {}
    if table.is_table and "kind" not in table.entries:
        table.found.append(missing(f"{table.path}.kind", "crank | motion"))
        given["kind"] = NO_WORD
    if "speed_rpm" not in table.entries:
        if table.is_table and table.entries.get("kind") != MOTION and shaft is None:
            table.found.append(missing(f"{table.path}.speed_rpm", "of the crank, in rpm; negative = clockwise"))
        given["speed_rpm"] = _MOTION_SPEED if shaft is None else shaft.signed_rpm
    return table.part(Driver, {}, given)


def _points(row: Table) -> tuple[Place, ...]:
    info = info_of(next(iter(f for f in Place.__dataclass_fields__.values() if f.name == "x_mm")))
    assert info is not None

    def read(value: Any) -> tuple[Place, ...]:
        points = Table(value, f"{row.path}.points", row.found)
        return tuple(Place(str(name), *points.pair(spelled(name), info, xy)) for name, xy in points.entries.items())

    told = row.take("points", read, NO_NUMBER)
    if told is NO_NUMBER:
        if row.is_table:
            row.found.append(missing(f"{row.path}.points", "{ A = [0.0, 0.0], B = [40.0, 0.0] }, in mm"))
        return ()
    return tuple(told)


def _branch(table: Table) -> tuple[Side, ...]:
    sides = []
    for joint, side in table.entries.items():
        if isinstance(side, bool) or not isinstance(side, int) or side not in (-1, 1):
            table.tell(spelled(joint), side, "no side", "1 | -1")
        else:
            sides.append(Side(str(joint), side))
    return tuple(sides)


def _loads(at: Any, found: list[Fault]) -> LinkageLoads:
    table = Table(at, "loads", found)
    masses = tuple(row.part(LinkMass, {"centre": PAIRS["centre"]}, {}) for row in table.rows("masses"))
    forces = tuple(row.part(LinkForce, {}, {}) for row in table.rows("forces"))
    return table.part(LinkageLoads, {}, {"masses": masses, "forces": forces})


def _unit(linkage: Linkage, motion: Any) -> str:
    """Degrees where the driver turns, mm where it slides; where that is not known, as the motion has it."""
    numbers = [link.number for link in linkage.links]
    pair = driver_pair(linkage) if linkage.driver.link in numbers else None
    if pair is None:
        return "mm" if isinstance(motion, Mapping) and "start_mm" in motion else "deg"
    return "deg" if is_pin(pair) else "mm"


def _rule_faults(design: Design, found: list[Fault], motion_there: bool) -> Iterator[Fault]:
    """What the rules say of what could be read; of a part that is already told nothing more."""
    told = {fault.path for fault in found}
    broken = any(re.match(r"linkage($|\.(links|sliders|driver)\b)", path) for path in told)
    for fault in faults(design):
        path = _as_in_file(fault.path)
        unread = fault.value is NO_NUMBER or fault.value is NO_WORD
        unread |= path == "motion" and fault.value is MISSING and motion_there
        follows = broken and (fault.value is MISSING or re.fullmatch(_STRUCTURE, path))
        if path not in told and not unread and not follows:
            told.add(path)
            fault = replace(fault, path=path)
            yield hinted(fault) if fault.problem == "unknown word" else fault


def _as_in_file(path: str) -> str:
    """A pair of coordinates is one entry of the file."""
    path = re.sub(r"(\.points\.[^.]+)\.[xy]_mm$", r"\1", path)
    return re.sub(r"\.(through|centre)_[xy]_mm$", r".\1", path)


def _assumed_faults(assumed: Any, design: Design) -> Iterator[Fault]:
    if not isinstance(assumed, list | tuple):
        yield Fault("assumed", assumed, "must be a list of field paths")
        return
    known = dict.fromkeys(all_paths(design))
    for i, path in enumerate(assumed):
        if not isinstance(path, str):
            yield Fault(f"assumed[{i}]", path, "must be a field path, as text")
        elif path not in known:
            yield Fault(f"assumed[{i}]", path, f"no such entry in this design{did_you_mean(path, known)}")
