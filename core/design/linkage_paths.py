"""Values of a linkage by path, spelled as in the file: ``linkage.links[2].points.A``, ``linkage.driver.speed_rpm``.

A point's path may end in ``.x_mm`` or ``.y_mm``; alone it stands for both, as a pair.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

from core.design.fields import info_of
from core.design.linkage import Link, Linkage, LinkageDesign, Place, Side
from core.design.paths import Entry, motion_entries, motion_get, motion_put
from core.design.units import split_unit

LINKAGE_SECTIONS = ("motion", "linkage", "cam", "loads")
PAIRS = {
    "points": ("x_mm", "y_mm"),
    "through": ("through_x_mm", "through_y_mm"),
    "centre": ("centre_x_mm", "centre_y_mm"),
}
"""What stands in the file as [x, y] -> the fields it is kept in."""


def linkage_entries(design: LinkageDesign, name: str) -> Iterator[Entry]:
    """The entries of one table, in the order of the file; none where the design lacks it."""
    part = getattr(design, name)
    if part is None:
        return
    if name == "motion":
        yield from motion_entries(part)
    elif name == "linkage":
        yield from _of(part.driver, "linkage.driver")
        for side in part.branch:
            for entry in _of(side, "linkage.branch"):
                yield replace(entry, path=f"linkage.branch.{side.joint}")
        for i, link in enumerate(part.links):
            at = f"linkage.links[{i}]"
            yield from _of(link, at)
            for place in link.points:
                yield from _of(place, f"{at}.points.{place.name}")
        for i, slider in enumerate(part.sliders):
            yield from _of(slider, f"linkage.sliders[{i}]")
    else:
        yield from _of(part, name)
        for rows in ("masses", "forces"):
            for i, row in enumerate(getattr(part, rows, ())):
                yield from _of(row, f"{name}.{rows}[{i}]")


def _of(part: Any, path: str) -> Iterator[Entry]:
    for field in fields(part):
        info = info_of(field)
        if info is not None:
            yield Entry(f"{path}.{field.name}", info, split_unit(field.name)[1], getattr(part, field.name))


def paths(design: LinkageDesign) -> Iterator[str]:
    """Every path that may be assumed, in the order of the file: of what stands there as one entry, that one too."""
    told: set[str] = set()
    for name in LINKAGE_SECTIONS:
        for entry in linkage_entries(design, name):
            for path in (*_holders(entry.path), entry.path):
                if path not in told:
                    told.add(path)
                    yield path


def _holders(path: str) -> Iterator[str]:
    """Entries of the file that hold the value at a path; a segment's law comes before its span."""
    for pattern, holders in _HOLDERS:
        match = re.fullmatch(pattern, path)
        if match:
            yield from (match.expand(holder) for holder in holders)


_HOLDERS = (
    (r"(.*\.points)\.(\w+)\.[xy]_mm", (r"\1", r"\1.\2")),
    (r"(.*\.(?:through|centre))_[xy]_mm", (r"\1",)),
    (r"(motion\.segments\[\d+\])\.span_deg", (r"\1.law",)),
)


def linkage_get(design: LinkageDesign, path: str) -> Any:
    """The value at a path. Raises KeyError where the path leads nowhere."""
    head, _, rest = path.partition(".")
    if head == "motion" and design.motion is not None and rest:
        return motion_get(design.motion, path)
    at: Any = design
    for name, index in _steps(path):
        at = _child(at, name, path)
        if index is not None:
            at = _item(at, index, path)
    return (at.x_mm, at.y_mm) if isinstance(at, Place) else at


def linkage_put(design: LinkageDesign, path: str, value: Any) -> LinkageDesign:
    """The design with the value at a path replaced. Raises KeyError where the path leads nowhere."""
    head, _, rest = path.partition(".")
    if head == "motion" and design.motion is not None and rest:
        return replace(design, motion=motion_put(design.motion, path, value))
    changed: LinkageDesign = _put(design, _steps(path), value, path)
    return changed


def _put(at: Any, steps: list[tuple[str, int | None]], value: Any, path: str) -> Any:
    if not steps:
        return value
    (name, index), rest = steps[0], steps[1:]
    if isinstance(at, Link) and name == "points" and rest:
        if rest[0][0] not in at.places:
            _nowhere(path)
        named = (p if p.name != rest[0][0] else _put_pair(p, name, rest[1:], value, path) for p in at.points)
        return replace(at, points=tuple(named))
    if isinstance(at, Linkage) and name == "branch" and rest:
        sides = [s for s in at.branch if s.joint != rest[0][0]]
        place = next((i for i, s in enumerate(at.branch) if s.joint == rest[0][0]), len(sides))
        return replace(at, branch=(*sides[:place], Side(rest[0][0], value), *sides[place:]))
    if name in PAIRS and not hasattr(at, name):
        return _put_pair(at, name, rest, value, path)
    old = _child(at, name, path)
    if index is None:
        return replace(at, **{name: _put(old, rest, value, path)})
    items = list(old)
    items[index] = _put(_item(old, index, path), rest, value, path)
    return replace(at, **{name: tuple(items)})


def _put_pair(part: Any, name: str, rest: list[tuple[str, int | None]], value: Any, path: str) -> Any:
    if rest:
        return _put(part, rest, value, path)
    return replace(part, **dict(zip(PAIRS[name], value, strict=True)))


def _child(at: Any, name: str, path: str) -> Any:
    if isinstance(at, tuple):  # points and sides by name
        key = "name" if at and isinstance(at[0], Place) else "joint"
        found = next((item for item in at if getattr(item, key, None) == name), None)
        return _nowhere(path) if found is None else found.side if isinstance(found, Side) else found
    if is_dataclass(at) and name in {f.name for f in fields(at)}:
        return getattr(at, name)
    if name in PAIRS and is_dataclass(at) and hasattr(at, PAIRS[name][0]):
        return tuple(getattr(at, key) for key in PAIRS[name])
    return _nowhere(path)


def _item(items: Any, index: int, path: str) -> Any:
    return items[index] if isinstance(items, tuple) and index < len(items) else _nowhere(path)


def _steps(path: str) -> list[tuple[str, int | None]]:
    steps = []
    for text in path.split("."):
        match = re.match(r"(\w+)(?:\[(\d+)\])?$", text)
        if match is None:
            _nowhere(path)
        else:
            steps.append((match[1], int(match[2]) if match[2] is not None else None))
    return steps


def _nowhere(path: str) -> Any:
    raise KeyError(f"{path}: no such entry in this design")


def assumed_in(design: LinkageDesign, path: str) -> bool:
    """Whether the value at a path is assumed, itself or with the point or the table of points it stands in."""
    return path in design.assumed or any(path.startswith(f"{each}.") for each in design.assumed)


def linkage_assumed(design: LinkageDesign, path: str, on: bool) -> LinkageDesign:
    """A path marked as assumed, in the order of the file, or no longer: of what is assumed as a whole the other values
    stay so."""
    kept: set[str] = {each for each in design.assumed if each != path}
    order = list(paths(design))
    if on:
        kept.add(path)
    for each in [each for each in kept if not on and path.startswith(f"{each}.")]:
        kept.discard(each)
        kept.update(p for p in order if p.startswith(f"{each}.") and p != path and not path.startswith(f"{p}."))
    return replace(design, assumed=(*(p for p in order if p in kept), *(p for p in design.assumed if p in kept - set(order))))


def place_of(design: LinkageDesign, link: int, name: str) -> str:
    """The path of a point of a link."""
    i = next(i for i, each in enumerate(design.linkage.links) if each.number == link)
    return f"linkage.links[{i}].points.{name}"
