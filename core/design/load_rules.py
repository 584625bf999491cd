"""Rules of force elements: that what they hold on to is there, and that they can act at all. Each must bear any number, nan included."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

from core.design.design import Drive
from core.design.linkage import CRANK, FRAME_LINK
from core.design.loads import Attachment, ForceElements, PairFriction, PointSpring, Process, TorsionSpring
from core.design.parts import CamSlider, Oscillating, OscillatingFlat, Output, Translating
from core.design.topology import pins
from core.errors import MISSING, Fault

Pairs = Mapping[str, tuple[bool, tuple[int, ...]]]
"""Name of a pair -> whether it is a pin, and its links."""


class _Built:
    """What a follower builds: its links by number, their names and points, and its pairs."""

    def __init__(self, links: Mapping[int, tuple[str, tuple[str, ...]]], pairs: Pairs, second: int) -> None:
        self.links, self.pairs, self.second = MappingProxyType(links), MappingProxyType(pairs), second


_ARM = _Built({1: ("frame", ("pivot",)), 2: ("arm", ("pivot", "roller"))}, {"pivot": (True, (1, 2))}, 2)
FOLLOWER_LINKS: Mapping[type, _Built] = MappingProxyType(
    {
        CamSlider: _Built(
            {
                1: ("frame", ("pivot",)), 2: ("arm", ("pivot", "arm_pin", "roller")), 3: ("rod", ("arm_pin", "slider_pin")),
                4: ("slider", ("slider_pin",)),
            },
            {"pivot": (True, (1, 2)), "arm_pin": (True, (2, 3)), "slider_pin": (True, (3, 4)), "guide": (False, (4, 1))}, 2,
        ),
        Translating: _Built({1: ("frame", ()), 2: ("follower", ("roller",))}, {"guide": (False, (2, 1))}, 2),
        Oscillating: _ARM,
        OscillatingFlat: _ARM,
        Output: _Built({1: ("frame", ()), 2: ("output", ())}, {}, 2),
    }
)  # fmt: skip
"""Follower -> the links and pairs that it builds; ``second``: the link with the second roller of a conjugate pair."""


def link_points(drive: Drive) -> Mapping[int, tuple[str, ...]]:
    """The links of a drive by number, each with the names of its points."""
    if drive.is_linkage:
        return {link.number: tuple(link.places) for link in drive.linkage.links}
    built = FOLLOWER_LINKS[type(drive.mechanism)]
    second = getattr(drive.mechanism, "second", None) is not None
    return {
        n: (*points, *(("second_roller",) if second and n == built.second else ()))
        for n, (_, points) in built.links.items()
    }


def link_names(drive: Drive) -> Mapping[int, str]:
    """What the links of a drive are called: ``2 (arm)``."""
    if drive.is_linkage:
        return {n: f"{n} (frame)" if n == FRAME_LINK else str(n) for n in sorted(link_points(drive))}
    return {n: f"{n} ({name})" for n, (name, _) in FOLLOWER_LINKS[type(drive.mechanism)].links.items()}


def pairs_of(drive: Drive) -> Pairs:
    """The pairs of a drive in which there may be friction."""
    if not drive.is_linkage:
        return FOLLOWER_LINKS[type(drive.mechanism)].pairs
    found: dict[str, tuple[bool, tuple[int, ...]]] = {pin.name: (True, pin.links) for pin in pins(drive.linkage)}
    return found | {str(s.link): (False, (s.link, s.on)) for s in drive.linkage.sliders}


def turning_links(drive: Drive) -> tuple[int, ...]:
    """The links of a drive that can turn: no slide leads from them to the frame. None of a follower on a guide."""
    slides, still = [set(links) for pin, links in pairs_of(drive).values() if not pin], {FRAME_LINK}
    while more := set().union(*(links for links in slides if links & still)) - still:
        still |= more
    return tuple(n for n in link_names(drive) if n not in still)


def element_faults(drive: Drive) -> Iterator[Fault]:
    """Every fault of the force elements of a drive."""
    loads = drive.loads
    if not isinstance(loads, ForceElements) or drive.mechanism is None:
        return
    for name, rule in _RULES.items():
        for i, row in enumerate(getattr(loads, name)):
            yield from rule(row, drive, f"loads.{name}[{i}]")
    yield from _rubs_once(loads, drive)
    if loads.follower_stiffness_n_per_mm and drive.cam is None:
        path = "loads.follower_stiffness_n_per_mm"
        yield Fault(
            path,
            loads.follower_stiffness_n_per_mm,
            "there is no cam that drives an elastic follower",
            "none, or give a cam",
        )


def _no_link(drive: Drive, number: int | None, path: str) -> Iterator[Fault]:
    names = link_names(drive)
    if number not in names:
        yield Fault(path, MISSING if number is None else number, "no such link", " | ".join(names.values()))


def _attached(at: Attachment, drive: Drive, path: str) -> Iterator[Fault]:
    if absent := list(_no_link(drive, at.link, f"{path}.link")):
        yield from absent
        return
    points = link_points(drive)[at.link]
    known = " | ".join((*points, "at = [x, y]"))
    if at.point is None and (at.x_mm is None or at.y_mm is None):
        yield Fault(f"{path}.point", MISSING, f"where on link {at.link} is not said", known)
    elif at.point is not None and (at.x_mm is not None or at.y_mm is not None):
        yield Fault(f"{path}.at", [at.x_mm, at.y_mm], "stands beside point", "one of the two")
    elif at.point is not None and at.point not in points:
        yield Fault(f"{path}.point", at.point, f"link {at.link} has no such point", known)


def _spring(row: PointSpring, drive: Drive, path: str) -> Iterator[Fault]:
    missing = [*_attached(row.from_, drive, f"{path}.from"), *_attached(row.to, drive, f"{path}.to")]
    if missing:
        yield from missing
    elif row.from_.link == row.to.link:
        yield Fault(
            f"{path}.to.link",
            row.to.link,
            "both ends are on one link, whose points keep their distance",
            "another link",
        )
    elif row.from_.point is not None and row.from_.point == row.to.point:
        problem = f"lies on the other end: {row.to.point} joins both links, so that the spring has no length"
        yield Fault(f"{path}.to.point", row.to.point, problem, "another point")


def _torsion(row: TorsionSpring, drive: Drive, path: str) -> Iterator[Fault]:
    yield from _no_link(drive, row.link, f"{path}.link")
    yield from _no_link(drive, row.on, f"{path}.on")
    if row.link == row.on:
        yield Fault(f"{path}.on", row.on, "a link does not turn against itself", "another link")


def _friction(row: PairFriction, drive: Drive, path: str) -> Iterator[Fault]:
    known = pairs_of(drive)
    if row.pair not in known:
        yield Fault(f"{path}.pair", row.pair, "no such pair", " | ".join(known) or "none: no pin and no slide")
        return
    pin, links = known[row.pair]
    named = (row.link, row.other)
    several = " or ".join(f"[{min(links)}, {n}]" for n in sorted(links)[1:])
    if pin and row.radius_mm is None:
        yield Fault(f"{path}.radius_mm", MISSING, "missing", "> 0 mm, of the pin")
    if pin and row.length_mm is not None:
        yield Fault(f"{path}.length_mm", row.length_mm, f"{row.pair} is a pin", "radius_mm")
    if not pin and row.radius_mm is not None:
        yield Fault(f"{path}.radius_mm", row.radius_mm, f"{row.pair} is a slide", "length_mm, or nothing")
    if named == (None, None) and len(links) > 2:
        yield Fault(f"{path}.links", MISSING, f"the pin joins links {', '.join(map(str, links))}", several)
    elif named != (None, None) and (row.link == row.other or not set(named) <= set(links)):
        yield Fault(f"{path}.links", list(named), f"are not two links joined by {row.pair}", several)


def _rubs_once(loads: ForceElements, drive: Drive) -> Iterator[Fault]:
    """The friction of a pair is stated once: of a guide, either as the loads' own or among those of the pairs."""
    seen: set[tuple[Any, ...]] = set()
    for i, row in enumerate(loads.pair_friction):
        path, key = f"loads.pair_friction[{i}].pair", (row.pair, frozenset((row.link, row.other)))
        own = getattr(loads, "friction", 0.0) if row.pair == "guide" and not drive.is_linkage else 0.0
        if key in seen:
            yield Fault(path, row.pair, "has its friction already, in another row", "each pair once")
        elif own > 0.0:
            yield Fault(
                path,
                row.pair,
                f"has its friction already, Guide friction = {own:g}",
                "Guide friction = 0, or another pair",
            )
        seen.add(key)


_WINDOWS = (
    ("cam_from_deg", "cam_to_deg"),
    ("position_from_mm", "position_to_mm"),
    ("position_from_deg", "position_to_deg"),
)


def _process(row: Process, drive: Drive, path: str) -> Iterator[Fault]:
    yield from _when(row, drive, path)
    yield from _where(row, drive, path)
    if row.points:
        yield from _table(row, path)
    if row.points and (row.force_n or row.torque_nm):
        key = "force_n" if row.force_n else "torque_nm"
        yield Fault(f"{path}.{key}", getattr(row, key), "stands beside points", "one of the two")


def _when(row: Process, drive: Drive, path: str) -> Iterator[Fault]:
    """Over a part of the turn, at a part of the motion, or by a table: one of them, whole."""
    given = [keys for keys in _WINDOWS if any(getattr(row, key) is not None for key in keys)]
    if not given and not row.points:
        yield Fault(
            f"{path}.cam_from_deg",
            MISSING,
            "when it acts is not said",
            "cam_from_deg and cam_to_deg, positions, or points",
        )
    for keys in given[1:] if not row.points else given:
        beside = "points" if row.points else given[0][0]
        yield Fault(f"{path}.{keys[0]}", getattr(row, keys[0]), f"stands beside {beside}", "one of the two")
    for first, last in given[:1] if not row.points else ():
        low, high = getattr(row, first), getattr(row, last)
        by_angle = first == "cam_from_deg"
        unit = first.rsplit("_", 1)[1]
        if low is None or high is None:
            absent = first if low is None else last
            yield Fault(f"{path}.{absent}", MISSING, "missing", f"with {last if low is None else first}")
        elif not by_angle and drive.is_linkage and drive.linkage.driver.kind == CRANK:
            yield Fault(f"{path}.{first}", low, "a crank has no motion", "cam_from_deg and cam_to_deg")
        elif not by_angle and unit != drive.motion_unit:
            yield Fault(
                f"{path}.{first}", low, f"the motion is in {drive.motion_unit}", f"position_from_{drive.motion_unit}"
            )
        elif low == high or (by_angle and (low, high) == (360.0, 0.0)):
            yield Fault(
                f"{path}.{last}",
                high,
                f"is {first}: it never acts",
                "another one" + (", or 0 and 360" if by_angle else ""),
            )
        elif not by_angle and low > high:
            yield Fault(f"{path}.{last}", high, f"lies before {first}", f"> {low:g} {unit}")


def _where(row: Process, drive: Drive, path: str) -> Iterator[Fault]:
    """On the output along its motion, or at a point of a link."""
    directed = row.direction_deg is not None
    if row.link is None:
        for key in ("point", "direction_deg"):
            if getattr(row, key) is not None:
                yield Fault(
                    f"{path}.link", MISSING, f"missing beside {key}", " | ".join(list(link_names(drive).values())[1:])
                )
                return
        if drive.is_linkage:
            yield Fault(f"{path}.link", MISSING, "missing", " | ".join(list(link_names(drive).values())[1:]))
        elif row.force_n and drive.motion_unit == "deg":
            yield Fault(
                f"{path}.force_n", row.force_n, "the follower swings", "torque_nm, or a link, a point and a direction"
            )
        elif row.torque_nm and drive.motion_unit == "mm":
            yield Fault(f"{path}.torque_nm", row.torque_nm, "the follower slides", "force_n, or a link that turns")
        return
    if absent := list(_no_link(drive, row.link, f"{path}.link")):
        yield from absent
        return
    points = link_points(drive)[row.link]
    if row.point is not None and row.point not in points:
        yield Fault(f"{path}.point", row.point, f"link {row.link} has no such point", " | ".join(points))
    elif row.point is None and (row.force_n or directed):
        yield Fault(f"{path}.point", MISSING, "missing: a force acts at a point", " | ".join(points))
    if row.force_n and not directed:
        yield Fault(
            f"{path}.direction_deg",
            MISSING,
            "missing: a force on a link has a direction",
            "an angle in the global frame",
        )


def _table(row: Process, path: str) -> Iterator[Fault]:
    """Rows in the order of their angles, one an angle; where the last stands at 360 deg it is the first at 0 deg again."""
    rows = row.points
    if len(rows) < 2:
        yield Fault(f"{path}.points", [[p.deg, p.value] for p in rows], "one row makes no table", "two rows at least")
    for i, (one, other) in enumerate(itertools.pairwise(rows), 1):
        if not other.deg > one.deg:
            problem = f"comes after {one.deg:g} deg: the rows are not sorted"
            yield Fault(f"{path}.points[{i}].deg", other.deg, problem, f"> {one.deg:g} deg")
            return
    first, last = rows[0], rows[-1]
    if first.deg == 0.0 and last.deg == 360.0 and first.value != last.value:
        problem = f"is {first.value:g} at 0 deg: the table is not closed"
        yield Fault(
            f"{path}.points[{len(rows) - 1}].value",
            last.value,
            problem,
            f"{first.value:g}, or leave the row at 360 deg out",
        )


_RULES: Mapping[str, Callable[[Any, Drive, str], Iterator[Fault]]] = MappingProxyType(
    {"springs": _spring, "torsion_springs": _torsion, "pair_friction": _friction, "process": _process}
)
