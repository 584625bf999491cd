"""Limits of a mechanism: cranks that cannot turn, dead centres, flat transmission angles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import degrees

import numpy as np

from core.design import FRAME_LINK, Design, Link
from core.design.linkage import MOST_TURNS, Linkage
from core.errors import angle_list
from core.findings import ERROR, NOTE, WARNING, Finding
from core.mechanism.driver_ranges import DriverRanges
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name
from core.motion.extremes import Extreme, Extremes

# -- limits of a mechanism --------------------------------------------------------------------------------------


LEAST_TRANSMISSION = 40.0  # [deg] usual in machine shops: Norton ch. 2
AT_DEAD_CENTRE = 1e-3  # sine of the transmission angle below which nothing can be driven, against any play
MOST_APART = 1e-6  # of both radii: as far as pitch circles may miss each other, that are written with so many digits
SINGULAR = ("dead-centre", "rod-across-guide")
"""Codes of what must not vanish in a follower's linkage."""
LEAST_SINGULAR = 0.05
_AMID = 0.382  # of a range: no symmetric place


def findings(
    driver_ranges: DriverRanges,
    singular: Mapping[str, Extremes],
    transmission: Mapping[str, Extremes],
    turns_fully: bool,
) -> list[Finding]:
    """What the driver ranges exceed, the extremes of ``SINGULAR``, and those of the transmission angle [rad] at each
    joint; turns_fully: the
    crank is to."""
    found = []
    if redundant := driver_ranges.plan.redundant:
        held = _held_without_need(driver_ranges) or redundant
        found.append(Finding("redundant-links", NOTE, "linkage.links", None, {"links": _and(held)}))
    if driver_ranges.swings:
        found.append(_swings(driver_ranges))
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
        found.append(Finding("crank-cannot-turn", ERROR, "linkage.driver.link", ends[0], values))
    linkage = driver_ranges.plan.linkage
    if turns_fully and (linkage.turns is None or not driver_ranges.closes):
        field = "linkage.drivers" if linkage.drivers else "linkage.links"
        most = min(MOST_TURNS, 2 * (linkage.turns or MOST_TURNS))
        shown = "turn is" if driver_ranges.turns == 1 else f"{driver_ranges.turns} turns are"
        found.append(Finding("no-common-period", NOTE, field, None, {"most": most, "shown": shown}))
    if linkage.drivers:
        found += _wheels(linkage)
    for change in driver_ranges.changes:
        at = degrees(change.at) / driver_ranges.turns if turns_fully else None
        found.append(Finding("change-point", WARNING, "linkage.links", at, {"joint": change.joint}))
    passed = locked | {change.joint for change in driver_ranges.changes}
    for code, extreme in singular.items():
        found += _singular(code, extreme.low)
    for joint, extreme in transmission.items():
        lowest = degrees(extreme.low.value)
        if joint in passed or lowest >= LEAST_TRANSMISSION:
            continue
        at, values = degrees(extreme.low.theta), {"joint": joint, "value": lowest, "limit": LEAST_TRANSMISSION}
        if lowest < degrees(AT_DEAD_CENTRE):
            found.append(Finding("linkage-dead-centre", ERROR, "linkage.links", at, values))
        else:
            found.append(Finding("transmission-angle", WARNING, "linkage.links", at, values))
    return found


def _held_without_need(driver_ranges: DriverRanges) -> tuple[int, ...]:
    """The links that hold each other without need, where the driver stands amid its range: not at its start, where cranks often lie
    in line and the rank is what rounding makes of it."""
    from core.mechanism.drawn import as_drawn
    from core.mechanism.solving import unit_speed_kinematics
    from core.mechanism.unfinished import unfinished

    linkage, here = driver_ranges.plan.linkage, driver_ranges.ranges[0]
    place = here.low + _AMID * (here.high - here.low)
    bodies = unit_speed_kinematics(linkage, np.array([place]), driver_ranges).bodies
    return unfinished(as_drawn(linkage, place, {n: bodies[body_name(n)] for n in linkage.by_number})).redundant


def _and(numbers: Sequence[int]) -> str:
    """``2, 3 and 4``."""
    *first, last = map(str, numbers)
    return f"{', '.join(first)} and {last}" if first else last


def _wheels(linkage: Linkage) -> Iterator[Finding]:
    """Pitch circles of second inputs that do not touch where their links hold their centres."""
    from core.mechanism.drivers import wheel_distance, wheel_pairs

    rows = {each.link: i for i, each in enumerate(linkage.drivers)}
    for pair in wheel_pairs(linkage):
        gap = wheel_distance(pair, linkage)
        if abs(gap) > MOST_APART * (pair.first.radius + pair.second.radius):
            at = f"linkage.drivers[{rows[pair.second.link]}]"
            places = linkage.by_number[pair.carrier].places
            values: dict[str, float | str] = {
                "first": pair.first.radius, "second": pair.second.radius, "link": pair.second.link,
                "distance": abs(places[pair.second.point] - places[pair.first.point]),
                "gap": abs(gap), "how": "apart" if gap > 0.0 else "into each other",
            }  # fmt: skip
            yield Finding("wheels-apart", WARNING, at, None, values)


def _swings(driver_ranges: DriverRanges) -> Finding:
    """Between which ends a crank goes to and fro, and where else it could."""
    (here,) = driver_ranges.ranges
    others = [(degrees(r.low), degrees(r.high)) for r in driver_ranges.others]
    values: dict[str, float | str] = {
        "low": degrees(here.low), "high": degrees(here.high), "low_joint": here.low_joint, "high_joint": here.high_joint,
        "others": f"; it could be assembled within {angle_list(others)} too" if others else "",
    }  # fmt: skip
    return Finding("swinging-driver", NOTE, "linkage.driver.link", None, values)


def _singular(code: str, low: Extreme) -> list[Finding]:
    if low.value >= LEAST_SINGULAR:
        return []
    severity = ERROR if low.value < AT_DEAD_CENTRE else WARNING
    return [Finding(code, severity, "follower.rod_mm", degrees(low.theta), {"value": low.value})]


# -- dimensions of a linkage from places ------------------------------------------------------------------------


_MM = 1e-3


def movable_points(design: Design) -> Mapping[str, str]:
    """The points that can be put elsewhere, with the path of their coordinates in the first link that has them: all but those
    of a driver that slides, whose place the motion gives."""
    linkage = design.drive.linkage
    sliding, driver = {s.link for s in linkage.sliders}, linkage.driver.link
    given = set(linkage.by_number[driver].places) if driver in sliding else set()
    found: dict[str, str] = {}
    for i, link in enumerate(linkage.links):
        for name in link.places:
            if name not in given:
                found.setdefault(name, f"linkage.links[{i}].points.{name}")
    return found


def point_changes(design: Design, kinematics: Kinematics, name: str, to: complex) -> dict[str, tuple[float, float]]:
    """Path -> coordinates [mm], unrounded, with which a named point is at ``to`` [m] in the position that ``kinematics`` shows
    (n = 1).

    A point of the frame moves alone, all links keep their lengths. Of any other the links that have it change where it
    stands in them, all else staying where it is at this position; on the driver it keeps to its line from the pivot, on a
    link that slides to the guide. A link whose frame begins at its first point, with the second on its x axis, keeps it so.
    """
    linkage = design.drive.linkage
    having = [link for link in linkage.links if name in link.places]
    having = [link for link in having if link.number == FRAME_LINK] or having
    sliding = {s.link for s in linkage.sliders}
    for link in having:
        if link.number in sliding:
            to = _along_guide(kinematics, link.number, name, to)
        elif link.number == linkage.driver.link:
            to = _along_crank(linkage.by_number[FRAME_LINK], link, kinematics, name, to)
    return {
        f"linkage.links[{i}].points.{point}": (at.real, at.imag)
        for i, link in enumerate(linkage.links)
        if link in having and link.number not in sliding
        for point, at in _moved(design, link, kinematics, name, to).items()
    }


def _pose(kinematics: Kinematics, link: int) -> tuple[complex, complex]:
    """Origin [m] and x axis."""
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


def _moved(design: Design, link: Link, kinematics: Kinematics, name: str, to: complex) -> dict[str, complex]:
    """The points of a link that change, in its frame [mm]."""
    origin, axis = _pose(kinematics, link.number)
    place = (to - origin) * axis.conjugate() / _MM
    if not _is_tidy(design, link):
        return {name: place}
    places = {**link.places, name: place}
    first, second = list(places.values())[:2]
    turn = (second - first).conjugate() / abs(second - first) if second != first else 1.0
    return {point: (at - first) * turn for point, at in places.items()}


def _is_tidy(design: Design, link: Link) -> bool:
    """Whether a link's frame begins at its first point and leads to the second, and nothing else stands in it."""
    linkage = design.drive.linkage
    fixed = (
        {FRAME_LINK, linkage.driver.link}
        | {s.on for s in linkage.sliders}
        | {m.link for m in design.drive.loads.masses}
    )
    first, *others = link.places.values()
    return link.number not in fixed and first == 0 and bool(others) and others[0].imag == 0.0 and others[0].real > 0.0
