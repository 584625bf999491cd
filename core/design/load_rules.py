"""Rules of force elements: their attachments exist, and they can act. A rule must accept any number, NaN included."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

from core.design.design import Drive
from core.design.linkage import CRANK, FRAME_LINK
from core.design.loads import Attachment, ForceElements, PairFriction, PointSpring, Process, TorsionSpring, ValveSpring
from core.design.parts import CamSlider, Oscillating, OscillatingFlat, Output, Pushrod, Rocker, Translating
from core.design.topology import pins
from core.errors import MISSING, Fault

Pairs = Mapping[str, tuple[bool, tuple[int, ...]]]
"""Name of a pair -> whether it is a pin, and its links."""


class _FollowerLinks:
    """Links of a follower by number, with their names and points, and its pairs."""

    def __init__(self, links: Mapping[int, tuple[str, tuple[str, ...]]], pairs: Pairs, second: int) -> None:
        self.links, self.pairs, self.second = MappingProxyType(links), MappingProxyType(pairs), second


_ARM = _FollowerLinks({1: ("frame", ("pivot",)), 2: ("arm", ("pivot", "roller"))}, {"pivot": (True, (1, 2))}, 2)
FOLLOWER_LINKS: Mapping[type, _FollowerLinks] = MappingProxyType(
    {
        CamSlider: _FollowerLinks(
            {
                1: ("frame", ("pivot",)), 2: ("arm", ("pivot", "arm_pin", "roller")), 3: ("rod", ("arm_pin", "slider_pin")),
                4: ("slider", ("slider_pin",)),
            },
            {"pivot": (True, (1, 2)), "arm_pin": (True, (2, 3)), "slider_pin": (True, (3, 4)), "guide": (False, (4, 1))}, 2,
        ),
        Translating: _FollowerLinks({1: ("frame", ()), 2: ("follower", ("roller",))}, {"guide": (False, (2, 1))}, 2),
        Oscillating: _ARM,
        OscillatingFlat: _ARM,
        Rocker: _FollowerLinks(
            {
                1: ("frame", ("pivot",)), 2: ("rocker", ("pivot", "roller", "pad_centre")), 3: ("pad", ("pad_centre",)),
                4: ("valve", ("tip",)),
            },
            {"pivot": (True, (1, 2)), "pad_centre": (True, (2, 3)), "pad": (False, (3, 4)), "valve_guide": (False, (4, 1))}, 2,
        ),
        Pushrod: _FollowerLinks(
            {
                1: ("frame", ("pivot",)), 2: ("tappet", ("roller", "lower_ball")), 3: ("pushrod", ("lower_ball", "upper_ball")),
                4: ("rocker", ("pivot", "upper_ball", "pad_centre")), 5: ("pad", ("pad_centre",)), 6: ("valve", ("tip",)),
            },
            {
                "guide": (False, (2, 1)), "lower_ball": (True, (2, 3)), "upper_ball": (True, (3, 4)), "pivot": (True, (1, 4)),
                "pad_centre": (True, (4, 5)), "pad": (False, (5, 6)), "valve_guide": (False, (6, 1)),
            }, 2,
        ),
        Output: _FollowerLinks({1: ("frame", ()), 2: ("output", ())}, {}, 2),
    }
)  # fmt: skip
"""Follower -> its links and pairs; ``second`` is the link with the second roller of a conjugate pair."""


def link_points(drive: Drive) -> Mapping[int, tuple[str, ...]]:
    """Number of a link -> names of its points."""
    if drive.is_linkage:
        return {link.number: tuple(link.places) for link in drive.linkage.links}
    follower = FOLLOWER_LINKS[type(drive.mechanism)]
    second = getattr(drive.mechanism, "second", None) is not None
    return {
        n: (*points, *(("second_roller",) if second and n == follower.second else ()))
        for n, (_, points) in follower.links.items()
    }


def link_names(drive: Drive) -> Mapping[int, str]:
    """Number of a link -> its name, ``2 (arm)``."""
    if drive.is_linkage:
        return {n: f"{n} (frame)" if n == FRAME_LINK else str(n) for n in sorted(link_points(drive))}
    return {n: f"{n} ({name})" for n, (name, _) in FOLLOWER_LINKS[type(drive.mechanism)].links.items()}


def pairs_of(drive: Drive) -> Pairs:
    """Pairs of a drive, in which there may be friction."""
    if not drive.is_linkage:
        return FOLLOWER_LINKS[type(drive.mechanism)].pairs
    pinned: dict[str, tuple[bool, tuple[int, ...]]] = {pin.name: (True, pin.links) for pin in pins(drive.linkage)}
    return pinned | {str(s.link): (False, (s.link, s.on)) for s in drive.linkage.sliders}


def turning_links(drive: Drive) -> tuple[int, ...]:
    """Links of a drive that can turn, those without a chain of slides to the frame."""
    slides, parallel = [set(links) for pin, links in pairs_of(drive).values() if not pin], {FRAME_LINK}
    while more := set().union(*(links for links in slides if links & parallel)) - parallel:
        parallel |= more
    return tuple(n for n in link_names(drive) if n not in parallel)


def element_faults(drive: Drive) -> Iterator[Fault]:
    """Faults of the force elements of a drive."""
    loads = drive.loads
    if not isinstance(loads, ForceElements) or drive.mechanism is None:
        return
    for name, rule in _RULES.items():
        for i, row in enumerate(getattr(loads, name, ())):
            yield from rule(row, drive, f"loads.{name}[{i}]")
    yield from _friction_given_once(loads, drive)
    if loads.follower_stiffness_n_per_mm and not drive.has_disk:
        path = "loads.follower_stiffness_n_per_mm"
        yield Fault(
            path,
            loads.follower_stiffness_n_per_mm,
            "there is no cam that drives an elastic follower",
            "none, or add a cam",
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
    allowed = " | ".join((*points, "at = [x, y]"))
    if at.point is None and (at.x_mm is None or at.y_mm is None):
        yield Fault(f"{path}.point", MISSING, f"the point on link {at.link} is missing", allowed)
    elif at.point is not None and (at.x_mm is not None or at.y_mm is not None):
        yield Fault(f"{path}.at", [at.x_mm, at.y_mm], "cannot be combined with point", "one of the two")
    elif at.point is not None and at.point not in points:
        yield Fault(f"{path}.point", at.point, f"link {at.link} has no such point", allowed)


def _spring(row: PointSpring, drive: Drive, path: str) -> Iterator[Fault]:
    missing = [*_attached(row.from_, drive, f"{path}.from"), *_attached(row.to, drive, f"{path}.to")]
    if missing:
        yield from missing
    elif row.from_.link == row.to.link:
        yield Fault(
            f"{path}.to.link",
            row.to.link,
            "both ends are on one link, so that the length is constant",
            "another link",
        )
    elif row.from_.point is not None and row.from_.point == row.to.point:
        problem = f"coincides with the first end: {row.to.point} joins both links, so that the spring has no length"
        yield Fault(f"{path}.to.point", row.to.point, problem, "another point")


def _torsion(row: TorsionSpring, drive: Drive, path: str) -> Iterator[Fault]:
    yield from _no_link(drive, row.link, f"{path}.link")
    yield from _no_link(drive, row.on, f"{path}.on")
    if row.link == row.on:
        yield Fault(f"{path}.on", row.on, "a link cannot turn relative to itself", "another link")


def _valve_spring(row: ValveSpring, drive: Drive, path: str) -> Iterator[Fault]:
    """A valve spring fits its wire and its installed length, and is the only closing spring."""
    if row.coil_mm <= row.wire_mm:
        yield Fault(f"{path}.coil_mm", row.coil_mm, "is not larger than the wire", f"> {row.wire_mm:g} mm")
    if row.total_coils < row.active_coils:
        yield Fault(f"{path}.total_coils", row.total_coils, "fewer than the active ones", f">= {row.active_coils:g}")
    if row.free_mm < row.installed_mm:
        yield Fault(f"{path}.free_mm", row.free_mm, "below the installed length", f">= {row.installed_mm:g} mm")
    if path.endswith("[0]"):
        for key in ("spring_rate_n_per_mm", "preload_n"):
            if value := getattr(drive.loads, key):
                yield Fault(f"loads.{key}", value, "cannot be combined with valve_springs", "0, or no valve_springs")


def _friction(row: PairFriction, drive: Drive, path: str) -> Iterator[Fault]:
    known = pairs_of(drive)
    if row.pair not in known:
        yield Fault(f"{path}.pair", row.pair, "no such pair", " | ".join(known) or "none: no pin and no slide")
        return
    pin, links = known[row.pair]
    stated = (row.link, row.other)
    allowed = " or ".join(f"[{min(links)}, {n}]" for n in sorted(links)[1:])
    if pin and row.radius_mm is None:
        yield Fault(f"{path}.radius_mm", MISSING, "missing", "> 0 mm, of the pin")
    if pin and row.length_mm is not None:
        yield Fault(f"{path}.length_mm", row.length_mm, f"{row.pair} is a pin", "radius_mm")
    if not pin and row.radius_mm is not None:
        yield Fault(f"{path}.radius_mm", row.radius_mm, f"{row.pair} is a slide", "length_mm, or nothing")
    if stated == (None, None) and len(links) > 2:
        yield Fault(f"{path}.links", MISSING, f"the pin joins links {', '.join(map(str, links))}", allowed)
    elif stated != (None, None) and (row.link == row.other or not set(stated) <= set(links)):
        yield Fault(f"{path}.links", list(stated), f"are not two links joined by {row.pair}", allowed)


def _friction_given_once(loads: ForceElements, drive: Drive) -> Iterator[Fault]:
    """The friction of a pair is given once; that of a guide by its field or in the list of pairs."""
    seen: set[tuple[Any, ...]] = set()
    for i, row in enumerate(loads.pair_friction):
        path, key = f"loads.pair_friction[{i}].pair", (row.pair, frozenset((row.link, row.other)))
        guide = getattr(loads, "friction", 0.0) if row.pair == "guide" and not drive.is_linkage else 0.0
        if key in seen:
            yield Fault(path, row.pair, "has its friction already, in another row", "each pair once")
        elif guide > 0.0:
            yield Fault(
                path,
                row.pair,
                f"has its friction already, Guide friction = {guide:g}",
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
        yield Fault(f"{path}.{key}", getattr(row, key), "cannot be combined with points", "one of the two")


def _when(row: Process, drive: Drive, path: str) -> Iterator[Fault]:
    """A process force acts over a part of the turn, at a part of the motion, or by a table: one of them, complete."""
    given = [keys for keys in _WINDOWS if any(getattr(row, key) is not None for key in keys)]
    if not given and not row.points:
        yield Fault(
            f"{path}.cam_from_deg",
            MISSING,
            "the time at which it acts is missing",
            "cam_from_deg and cam_to_deg, positions, or points",
        )
    for keys in given[1:] if not row.points else given:
        first_given = "points" if row.points else given[0][0]
        yield Fault(
            f"{path}.{keys[0]}", getattr(row, keys[0]), f"cannot be combined with {first_given}", "one of the two"
        )
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
                f"equals {first}: it never acts",
                "another value" + (", or 0 and 360" if by_angle else ""),
            )
        elif not by_angle and low > high:
            yield Fault(f"{path}.{last}", high, f"is less than {first}", f"> {low:g} {unit}")


def _where(row: Process, drive: Drive, path: str) -> Iterator[Fault]:
    """A process force acts on the output along its motion, or at a point of a link."""
    directed = row.direction_deg is not None
    if row.link is None:
        for key in ("point", "direction_deg"):
            if getattr(row, key) is not None:
                yield Fault(
                    f"{path}.link",
                    MISSING,
                    f"missing, required by {key}",
                    " | ".join(list(link_names(drive).values())[1:]),
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
    """The rows of a table have ascending angles; a row at 360 deg equals the one at 0 deg."""
    rows = row.points
    if len(rows) < 2:
        yield Fault(f"{path}.points", [[p.deg, p.value] for p in rows], "a table needs two rows", "at least two rows")
    for i, (previous, row_i) in enumerate(itertools.pairwise(rows), 1):
        if not row_i.deg > previous.deg:
            problem = f"follows {previous.deg:g} deg: the rows are not sorted"
            yield Fault(f"{path}.points[{i}].deg", row_i.deg, problem, f"> {previous.deg:g} deg")
            return
    first, last = rows[0], rows[-1]
    if first.deg == 0.0 and last.deg == 360.0 and first.value != last.value:
        problem = f"is {first.value:g} at 0 deg: the table is not closed"
        yield Fault(
            f"{path}.points[{len(rows) - 1}].value",
            last.value,
            problem,
            f"{first.value:g}, or remove the row at 360 deg",
        )


_RULES: Mapping[str, Callable[[Any, Drive, str], Iterator[Fault]]] = MappingProxyType(
    {
        "springs": _spring,
        "torsion_springs": _torsion,
        "pair_friction": _friction,
        "process": _process,
        "valve_springs": _valve_spring,
    }
)
