"""Which link of a linkage leads, and how: a crank at speed, or a link that follows a motion, which a cam can make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice, product
from math import floor, inf, isfinite, log10, pi

import numpy as np

from core.design import (
    CRANK,
    FRAME_LINK,
    MOTION,
    Design,
    Driver,
    Linkage,
    LinkageCam,
    Motion,
    Roller,
    Segment,
    Side,
    all_paths,
    curve_of,
    faults,
    with_drive,
)
from core.design.linkage_rules import sided_joints
from core.design.topology import driver_pair, driver_turns
from core.errors import NoPosition
from core.mechanism.assembly import unit_speed_kinematics
from core.mechanism.drawn import as_drawn, drawn_place
from core.mechanism.driver_ranges import TURN, DriverRange, DriverRanges, driver_ranges_of
from core.mechanism.driving import swept
from core.mechanism.kinematics import Kinematics
from core.mechanism.mechanism import body_name
from core.mechanism.plan import plan_of
from core.mechanism.solving import at_driver
from core.motion import program
from core.numerics.cancellation import checkpoint

SWING, SLIDE = (
    np.deg2rad(30.0),
    0.1,
)  # of a first motion: radians of a pinned link, parts of the size of one that slides
ROLLER_SIZE = 0.08  # of a first roller, parts of the size
LAW, SPANS = "cycloidal", (60.0, 120.0, 60.0, 120.0)
SAME_PLACE = 1e-6  # of the size: a position this near is the same
_NEAR = 1e-3  # of a range: a position this near to its end is its dead centre
MOST_SIDES = 256  # ways of assembly that are tried


def drivers(design: Design) -> Iterator[Driver]:
    """Every way to drive the linkage: a link pinned to the frame at speed or by a motion, one that slides there by a
    motion; those whose linkage could be solved."""
    speed = design.drive.linkage.driver.speed_rpm
    for link in sorted(n for n in design.drive.linkage.by_number if n != FRAME_LINK):
        for kind in (CRANK, MOTION):
            driver = Driver(link, kind, speed)
            changed = replace(design.drive.linkage, driver=driver, branch=(), drawn=None)
            motion = None if kind == CRANK else Motion(0.0, (Segment(360.0, 0.0),), _unit(changed))
            cam = design.drive.cam if kind == MOTION else None
            if not faults(with_drive(design, mechanism=changed, motion=motion, cam=cam)):
                yield driver


def with_driver(design: Design, driver: Driver, kinematics: Kinematics) -> Design:
    """The design led by ``driver`` from the position that ``kinematics`` shows (n = 1), in which it stays assembled.

    A link that comes to follow a motion gets one to begin with, from this position: dwell, rise, dwell, return, as far
    as the linkage lets it, all of it assumed. A crank at speed has neither motion nor cam. Raises NoPosition where the
    linkage cannot be led so from here.
    """
    old = design.drive.linkage.driver
    if (driver.link, driver.kind, driver.on) == (old.link, old.kind, old.on):
        return with_drive(design, mechanism=replace(design.drive.linkage, driver=driver))
    linkage = replace(design.drive.linkage, driver=driver, branch=(), drawn=None)
    place = driver_place(linkage, kinematics)
    if driver.kind == CRANK:
        linkage = _as_before(design, _assembled(linkage, kinematics, place % TURN, 0.0, TURN)[0], place, kinematics)
        assumed = tuple(path for path in design.assumed if not path.startswith(("motion.", "cam.")))
        return with_drive(design, mechanism=linkage, motion=None, cam=None, assumed=assumed)
    half = pi if _unit(linkage) == "deg" else plan_of(linkage).size
    _, room = _assembled(linkage, kinematics, place, place - half, place + half)
    motion = _first_motion(linkage, room, place)
    # sides hold from the driver's lowest position on, which is another one now
    low, high = swept(program(motion))
    start = min(max(place, low), high)  # it is rounded
    linkage = _as_before(design, _assembled(linkage, kinematics, start, low, high)[0], place, kinematics)
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    changed = with_drive(design, mechanism=linkage, motion=motion, assumed=assumed)
    advances = f"motion.advance_{motion.unit}"  # which it does not
    marks = tuple(path for path in all_paths(changed) if path.startswith("motion.") and path != advances)
    return replace(changed, assumed=(*marks, *assumed))


def _as_before(design: Design, linkage: Linkage, place: float, kinematics: Kinematics) -> Linkage:
    """The linkage by its signs, or as drawn, as the design is."""
    if design.drive.linkage.drawn is None:
        return linkage
    return as_drawn(linkage, place, {n: kinematics.bodies[body_name(n)] for n in linkage.by_number})


def redrawn(design: Design, kinematics: Kinematics) -> Design:
    """The design with its linkage drawn as it stands in the position that ``kinematics`` shows (n = 1), instead of its signs."""
    linkage = design.drive.linkage
    poses = {n: kinematics.bodies[body_name(n)] for n in linkage.by_number}
    return with_drive(design, mechanism=as_drawn(linkage, driver_place(linkage, kinematics), poses))


def with_signs(design: Design) -> Design:
    """The design whose linkage is assembled by signs as it is drawn. Raises NoPosition where no signs tell its assembly."""
    linkage = with_drive(design, mechanism=design.drive.posed).drive.linkage
    if linkage.drawn is None:
        return design
    low, high = (0.0, TURN) if linkage.driver.kind == CRANK else swept(program(design.drive.motion))
    driver_ranges = driver_ranges_of(linkage, low, high)
    if not driver_ranges.ranges:
        raise NoPosition("its links cannot be put together as drawn", "linkage.drawn", "change their lengths")
    here, place = driver_ranges.ranges[0], drawn_place(linkage.drawn)
    if linkage.driver.kind == CRANK and not driver_ranges.swings:
        place %= TURN
    least = 2.0 * _NEAR * (here.high - here.low)
    place = min(max(place, here.low + least * bool(here.low_joint)), here.high - least * bool(here.high_joint))
    kinematics = unit_speed_kinematics(linkage, np.array([place]), driver_ranges)
    at = place % TURN if linkage.driver.kind == CRANK else place
    signed, _ = _assembled(replace(linkage, drawn=None), kinematics, at, low, high)
    return with_drive(design, mechanism=signed)


def with_roller(design: Design, link: int, point: str) -> Design:
    """The design with its cam under a roller at this point; a first roller has a radius to begin with, assumed.

    Raises NoPosition where no motion drives the linkage.
    """
    if design.drive.cam is not None:
        return with_drive(design, cam=replace(design.drive.cam, link=link, point=point))
    if design.drive.motion is None:
        raise NoPosition(
            "a cam needs a motion to be made for", "linkage.driver.kind", "let a link follow a motion first"
        )
    radius = _readable(1e3 * ROLLER_SIZE * plan_of(design.drive.linkage).size)
    mark = "cam.roller_radius_mm"
    assumed = (*(path for path in design.assumed if path != mark), mark)
    return with_drive(design, cam=LinkageCam(link=link, point=point, face=Roller(radius)), assumed=assumed)


def without_roller(design: Design) -> Design:
    """The design without its cam."""
    assumed = tuple(path for path in design.assumed if not path.startswith("cam."))
    return with_drive(design, cam=None, assumed=assumed)


def roller_places(design: Design) -> tuple[tuple[int, str], ...]:
    """Link and point of every place that a roller can have: each point that moves, once, on the first link that has it."""
    fixed = set(design.drive.linkage.by_number[FRAME_LINK].places)
    found: dict[str, int] = {}
    for link in design.drive.linkage.links:
        for name in link.places:
            if name not in fixed:
                found.setdefault(name, link.number)
    return tuple((link, name) for name, link in found.items())


def _unit(linkage: Linkage) -> str:
    return "deg" if driver_turns(linkage) else "mm"


def driver_place(linkage: Linkage, kinematics: Kinematics) -> float:
    """Where the driver stands [rad or m]."""
    name = body_name(linkage.driver.link)
    if _unit(linkage) == "mm":
        return float(kinematics.coordinates[f"slide{driver_pair(linkage)}"][0][0])
    if linkage.driver.on != FRAME_LINK:
        turned, against = (
            kinematics.bodies[body_name(n)].angle[0, 0] for n in (linkage.driver.link, linkage.driver.on)
        )
        return float(turned - against)
    return (
        float(kinematics.coordinates[name][0][0])
        if name in kinematics.coordinates
        else float(kinematics.bodies[name].angle[0, 0])
    )


def _assembled(
    linkage: Linkage, kinematics: Kinematics, place: float, low: float, high: float
) -> tuple[Linkage, DriverRange]:
    """The linkage with the sides that it has in this position, and the range around it, between low and high."""
    joints = sided_joints(linkage)
    for sides in islice(product((1, -1), repeat=len(joints)), MOST_SIDES):
        checkpoint()
        tried = replace(linkage, branch=tuple(Side(joint, side) for joint, side in zip(joints, sides, strict=True)))
        driver_ranges = driver_ranges_of(tried, low, high)
        here = next((r for r in driver_ranges.ranges if r.low <= place <= r.high), None)
        if (
            here is not None
            and _away(here, place)
            and apart(driver_ranges, kinematics, place) < SAME_PLACE * driver_ranges.plan.size
        ):
            return tried, here
    raise NoPosition(
        f"link {linkage.driver.link} cannot lead the linkage from this position",
        "linkage.driver.link",
        "turn it to another position first: here it stands at a dead centre, or beyond one",
    )


def _away(here: DriverRange, place: float) -> bool:
    """Not at a dead centre, from which no push would bring it on."""
    least = _NEAR * (here.high - here.low)
    return not ((here.low_joint and place - here.low < least) or (here.high_joint and here.high - place < least))


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # rates at a dead centre are infinite
def apart(driver_ranges: DriverRanges, kinematics: Kinematics, place: float) -> float:
    """How far any point is from where it stands [m]; infinite where the linkage cannot be assembled."""
    poses = driver_ranges.solve(at_driver(np.array([place]))).poses
    apart = [
        abs(poses[link].carried(at)[0][0] - kinematics.bodies[body_name(link)].carried(at)[0][0])
        for link, places in driver_ranges.plan.points.items()
        for at in places.values()
    ]
    worst = float(np.max(apart))
    return worst if isfinite(worst) else inf


def first_motion(linkage: Linkage, place: float) -> Motion | None:
    """Dwell, rise, dwell, return from a driver position [rad or m] of a linkage that is drawn; None where it cannot stand there."""
    half = pi if _unit(linkage) == "deg" else plan_of(linkage).size
    ranges = driver_ranges_of(linkage, place - half, place + half).ranges
    here = next((each for each in ranges if each.low <= place <= each.high), None)
    return None if here is None or here.low == here.high else _first_motion(linkage, here, place)


def _first_motion(linkage: Linkage, here: DriverRange, place: float) -> Motion:
    """Dwell, rise, dwell, return from here, to the side with more room, half of it at most."""
    unit = _unit(linkage)
    scale = 180.0 / pi if unit == "deg" else 1e3
    ahead, behind = here.high - place, place - here.low
    most = SWING if unit == "deg" else SLIDE * plan_of(linkage).size
    rise = _readable(min(most, 0.5 * max(ahead, behind)) * scale) * (1.0 if ahead >= behind else -1.0)
    spans = [Segment(span, 0.0) for span in SPANS]
    spans[1] = Segment(SPANS[1], rise, curve_of(LAW))
    spans[3] = Segment(SPANS[3], -rise, curve_of(LAW))
    return Motion(round(place * scale, 6) + 0.0, tuple(spans), unit)


def _readable(value: float) -> float:
    """The number of one digit below a value."""
    unit = 10.0 ** floor(log10(value))
    return round(floor(value / unit + 1e-9) * unit, 9)
