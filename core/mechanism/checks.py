"""Findings on a mechanism: locked cranks, dead centres, small transmission angles; and dimensions from the positions of points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import degrees
from types import MappingProxyType

import numpy as np

from core.design import FRAME_LINK, Design, Link
from core.design.linkage import MOST_TURNS, Linkage
from core.errors import angle_list
from core.findings import ERROR, NOTE, WARNING, Finding
from core.mechanism.driver_ranges import DriverRanges
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name
from core.motion.extremes import Extreme, Extremes

# -- findings ---------------------------------------------------------------------------------------------------


LEAST_TRANSMISSION = 40.0  # [deg] typical limit: Norton, Design of Machinery, ch. 2
AT_DEAD_CENTRE = 1e-3  # sine of the transmission angle below which play prevents any motion
MOST_GAP = 1e-6  # of the sum of both radii: larger gaps between pitch circles are not rounding of the file's digits
SINGULAR: Mapping[str, str] = MappingProxyType(
    {
        "dead-centre": "follower.rod_mm",
        "rod-across-guide": "follower.rod_mm",
        "pad-in-line": "follower.pad_angle_deg",
        "pushrod-in-line": "follower.pushrod_mm",
    }
)
"""Code of a measure that must not vanish in a follower's linkage -> path of the field that changes it."""
LEAST_SINGULAR = 0.05
_INSIDE = 0.382  # of a range: avoids its middle, where positions may be symmetric


def findings(
    driver_ranges: DriverRanges,
    singular: Mapping[str, Extremes],
    transmission: Mapping[str, Extremes],
    turns_fully: bool,
) -> list[Finding]:
    """Findings on the driver's ranges, the measures of `SINGULAR` and the transmission angles.

    Parameters
    ----------
    driver_ranges : DriverRanges
    singular : mapping of str to Extremes
        Extremes of the measures 0 ... 1, by code.
    transmission : mapping of str to Extremes
        Extremes of the transmission angle [rad], by joint.
    turns_fully : bool
        The driver is a crank that is meant to rotate continuously.

    Returns
    -------
    list of Finding
    """
    result = []
    if plan_redundant := driver_ranges.plan.redundant:
        redundant = _redundant_links(driver_ranges) or plan_redundant
        result.append(Finding("redundant-links", NOTE, "linkage.links", None, {"links": _and(redundant)}))
    if driver_ranges.is_swinging:
        result.append(_swinging_finding(driver_ranges))
        turns_fully = False
    locked = {joint for r in driver_ranges.ranges for joint in (r.low_joint, r.high_joint) if joint}
    if turns_fully and locked:
        ranges = angle_list([(degrees(r.low), degrees(r.high)) for r in driver_ranges.ranges])
        ends = [
            degrees(end) / driver_ranges.turns
            for r in driver_ranges.ranges
            for end, joint in ((r.low, r.low_joint), (r.high, r.high_joint))
            if joint
        ]
        values: dict[str, float | str] = {"ranges": ranges, "joints": ", ".join(sorted(locked))}
        result.append(Finding("crank-cannot-turn", ERROR, "linkage.driver.link", ends[0], values))
    linkage = driver_ranges.plan.linkage
    if turns_fully and (linkage.turns is None or not driver_ranges.is_periodic):
        field = "linkage.drivers" if linkage.drivers else "linkage.links"
        most = min(MOST_TURNS, 2 * (linkage.turns or MOST_TURNS))
        shown = "turn is" if driver_ranges.turns == 1 else f"{driver_ranges.turns} turns are"
        result.append(Finding("no-common-period", NOTE, field, None, {"most": most, "shown": shown}))
    if linkage.drivers:
        result += _wheel_findings(linkage)
    for change in driver_ranges.changes:
        at = degrees(change.at) / driver_ranges.turns if turns_fully else None
        result.append(Finding("change-point", WARNING, "linkage.links", at, {"joint": change.joint}))
    passed = locked | {change.joint for change in driver_ranges.changes}
    for code, extreme in singular.items():
        result += _singular_findings(code, extreme.low)
    for joint, extreme in transmission.items():
        lowest = degrees(extreme.low.value)
        if joint in passed or lowest >= LEAST_TRANSMISSION:
            continue
        at, values = degrees(extreme.low.theta), {"joint": joint, "value": lowest, "limit": LEAST_TRANSMISSION}
        if lowest < degrees(AT_DEAD_CENTRE):
            result.append(Finding("linkage-dead-centre", ERROR, "linkage.links", at, values))
        else:
            result.append(Finding("transmission-angle", WARNING, "linkage.links", at, values))
    return result


def _redundant_links(driver_ranges: DriverRanges) -> tuple[int, ...]:
    """Redundant links with the driver inside its range; at its start cranks are often in line, and rounding decides the rank."""
    from core.mechanism.drawn import as_drawn
    from core.mechanism.solving import unit_speed_kinematics
    from core.mechanism.unfinished import mobility

    linkage, first = driver_ranges.plan.linkage, driver_ranges.ranges[0]
    q = first.low + _INSIDE * (first.high - first.low)
    bodies = unit_speed_kinematics(linkage, np.array([q]), driver_ranges).bodies
    return mobility(as_drawn(linkage, q, {n: bodies[body_name(n)] for n in linkage.by_number})).redundant


def _and(numbers: Sequence[int]) -> str:
    """``2, 3 and 4``."""
    *first, last = map(str, numbers)
    return f"{', '.join(first)} and {last}" if first else last


def _wheel_findings(linkage: Linkage) -> Iterator[Finding]:
    """Pitch circles of second inputs that do not touch at the distance of their centres."""
    from core.mechanism.drivers import wheel_distance, wheel_pairs

    rows = {row.link: i for i, row in enumerate(linkage.drivers)}
    for pair in wheel_pairs(linkage):
        gap = wheel_distance(pair, linkage)
        if abs(gap) > MOST_GAP * (pair.first.radius + pair.second.radius):
            path = f"linkage.drivers[{rows[pair.second.link]}]"
            points = linkage.by_number[pair.carrier].places
            values: dict[str, float | str] = {
                "first": pair.first.radius, "second": pair.second.radius, "link": pair.second.link,
                "distance": abs(points[pair.second.point] - points[pair.first.point]),
                "gap": abs(gap), "how": "apart" if gap > 0.0 else "into each other",
            }  # fmt: skip
            yield Finding("wheels-apart", WARNING, path, None, values)


def _swinging_finding(driver_ranges: DriverRanges) -> Finding:
    """Range in which a crank oscillates, and the other ranges in which the linkage can be assembled."""
    (only,) = driver_ranges.ranges
    others = [(degrees(r.low), degrees(r.high)) for r in driver_ranges.others]
    values: dict[str, float | str] = {
        "low": degrees(only.low), "high": degrees(only.high), "low_joint": only.low_joint, "high_joint": only.high_joint,
        "others": f"; it could be assembled within {angle_list(others)} too" if others else "",
    }  # fmt: skip
    return Finding("swinging-driver", NOTE, "linkage.driver.link", None, values)


def _singular_findings(code: str, low: Extreme) -> list[Finding]:
    if low.value >= LEAST_SINGULAR:
        return []
    severity = ERROR if low.value < AT_DEAD_CENTRE else WARNING
    return [Finding(code, severity, SINGULAR[code], degrees(low.theta), {"value": low.value})]


# -- dimensions of a linkage from the positions of its points ---------------------------------------------------


_MM = 1e-3


def movable_points(design: Design) -> Mapping[str, str]:
    """Points that can be moved, with the path of their coordinates in the first link that has them.

    Excluded are the points of a sliding driver, whose position the motion determines.
    """
    linkage = design.drive.linkage
    sliding, driver = {s.link for s in linkage.sliders}, linkage.driver.link
    excluded = set(linkage.by_number[driver].places) if driver in sliding else set()
    paths: dict[str, str] = {}
    for i, link in enumerate(linkage.links):
        for name in link.places:
            if name not in excluded:
                paths.setdefault(name, f"linkage.links[{i}].points.{name}")
    return paths


def point_changes(design: Design, kinematics: Kinematics, name: str, to: complex) -> dict[str, tuple[float, float]]:
    """Coordinates by path, unrounded [mm], that move a named point to `to` [m] in the position (n = 1) of the kinematics.

    A point of the frame moves alone, and all links keep their lengths. For any other point the links that have it change, and
    all other points keep their positions; on the driver it stays on its line from the pivot, on a sliding link on the guide. A
    link whose frame has its first point as origin and its second point on the x axis keeps that form.
    """
    linkage = design.drive.linkage
    changed = [link for link in linkage.links if name in link.places]
    changed = [link for link in changed if link.number == FRAME_LINK] or changed
    sliding = {s.link for s in linkage.sliders}
    for link in changed:
        if link.number in sliding:
            to = _along_guide(kinematics, link.number, name, to)
        elif link.number == linkage.driver.link:
            to = _along_crank(linkage.by_number[FRAME_LINK], link, kinematics, name, to)
    return {
        f"linkage.links[{i}].points.{point}": (at.real, at.imag)
        for i, link in enumerate(linkage.links)
        if link in changed and link.number not in sliding
        for point, at in _changed_points(design, link, kinematics, name, to).items()
    }


def _pose(kinematics: Kinematics, link: int) -> tuple[complex, complex]:
    """Origin [m] and x axis of a link."""
    body = kinematics.bodies[body_name(link)]
    return complex(body.z[0, 0]), complex(np.exp(1j * body.angle[0, 0]))


def _along_guide(kinematics: Kinematics, link: int, name: str, to: complex) -> complex:
    old, (_, axis) = complex(kinematics.bodies[body_name(link)].point(name)[0, 0]), _pose(kinematics, link)
    return old + axis * ((to - old) * axis.conjugate()).real


def _along_crank(frame: Link, link: Link, kinematics: Kinematics, name: str, to: complex) -> complex:
    pivots = [p for p in link.places if p in frame.places]
    if not pivots or name in pivots:
        return to
    body = kinematics.bodies[body_name(link.number)]
    start, old = complex(body.point(pivots[0])[0, 0]), complex(body.point(name)[0, 0])
    along = (old - start) / abs(old - start)
    return start + along * ((to - start) * along.conjugate()).real


def _changed_points(design: Design, link: Link, kinematics: Kinematics, name: str, to: complex) -> dict[str, complex]:
    """Points of a link [mm] that change, in its frame."""
    origin, axis = _pose(kinematics, link.number)
    local = (to - origin) * axis.conjugate() / _MM
    if not _has_normal_frame(design, link):
        return {name: local}
    points = {**link.places, name: local}
    first, second = list(points.values())[:2]
    turn = (second - first).conjugate() / abs(second - first) if second != first else 1.0
    return {point: (at - first) * turn for point, at in points.items()}


def _has_normal_frame(design: Design, link: Link) -> bool:
    """Whether a link's frame has its first point as origin and its second on the x axis, and only points are given in it."""
    linkage = design.drive.linkage
    fixed = (
        {FRAME_LINK, linkage.driver.link}
        | {s.on for s in linkage.sliders}
        | {m.link for m in design.drive.loads.masses}
    )
    first, *others = link.places.values()
    return link.number not in fixed and first == 0 and bool(others) and others[0].imag == 0.0 and others[0].real > 0.0
