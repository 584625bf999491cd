"""Which link of a linkage leads, and how: a crank at speed, or a link that follows a motion, which a cam can make."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import islice, pairwise, product
from math import floor, inf, isfinite, log10, pi, radians

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
from core.design.linkage import BELT, GEAR, INTERNAL, RACK, SecondDriver
from core.design.linkage_rules import sided_joints
from core.design.topology import INPUT, driver_pair, driver_turns, input_slides, is_pin, solving_order
from core.errors import NoPosition
from core.frozen import frozen
from core.mechanism.drawn import as_drawn, drawn_place
from core.mechanism.driver_ranges import TURN, DriverRange, DriverRanges, driver_ranges_of
from core.mechanism.kinematics import Kinematics
from core.mechanism.linkage import plan_of
from core.mechanism.mechanism import at_driver, body_name
from core.mechanism.solving import unit_speed_kinematics
from core.motion import SNAP, Angles, CompiledMotion, Join, MotionState, degrees, program
from core.numerics.derivatives import Derivatives, heading
from core.numerics.lazy import checkpoint

# -- how the driver runs through its ranges ---------------------------------------------------------------------


class CrankProgram:
    """A crank's turn: one piece for each range in which the linkage can be assembled, the whole turn where it can
    everywhere. Looks like the program of a motion whose value is the angle itself. A crank that swings goes at speed through its
    range in the first half of a cycle, and back in the second.

    starts, ends  (m,) driver angles, or those of the cycle [rad]: where it swings, or comes back after several turns
    swing         the range through which it goes to and fro, where it does
    """

    joins: tuple[Join, ...] = ()

    def __init__(self, driver_ranges: DriverRanges) -> None:
        self.swing = driver_ranges.ranges[0] if driver_ranges.swings else None
        ranges = [(0.0, np.pi), (np.pi, TURN)] if self.swing else [(r.low, r.high) for r in driver_ranges.ranges]
        self.turns = driver_ranges.turns
        if self.turns > 1 and not self.swing:
            whole = len(ranges) == 1 and driver_ranges.ranges[0].free
            ranges = [(0.0, TURN)] if whole else [(a / self.turns, b / self.turns) for a, b in ranges]
        self._open = tuple(ranges)
        self.starts, self.ends = np.array(self._cut(driver_ranges.motions)).reshape(-1, 2).T

    def _cut(self, motions: Iterable[Motion]) -> list[tuple[float, float]]:
        """The ranges, cut also where a segment of a second driver's own motion begins: between them all is smooth."""
        begin = {float(at) for motion in motions for at in program(motion).starts}
        if not begin:
            return list(self._open)
        if self.swing is not None:
            low, high = self.swing.low, self.swing.high
            places = (at + TURN * k for at in begin for k in range(int(low // TURN) - 1, int(high // TURN) + 2))
            there = {(place - low) / (high - low) * np.pi for place in places if low < place < high}
            there |= {TURN - at for at in there}
        else:
            there = {(at + TURN * k) / self.turns for at in begin for k in range(self.turns)}
        parts = []
        for a, b in self._open:
            ends = [a, *sorted(at for at in there if a + SNAP < at < b - SNAP), b]
            parts += list(pairwise(ends))
        return parts

    def angles(self, theta: np.ndarray, cached: bool = False) -> Angles:
        """Any driver angles (n,) [rad], each with its piece."""
        theta = np.mod(np.asarray(theta, dtype=float), TURN)
        theta = np.where(theta >= TURN - SNAP, 0.0, theta)
        piece = np.clip(np.searchsorted(self.starts, theta, side="right") - 1, 0, None)
        return Angles(theta, piece, cached)

    def within(self, theta: np.ndarray) -> np.ndarray:
        """(n,) where the linkage can be assembled and is not locked."""
        if self.swing is not None:
            return (theta != 0.0) & (theta != np.pi)
        if self._open == ((0.0, TURN),):
            return np.ones(theta.shape, dtype=bool)
        inside = [(theta > a) & (theta < b) for a, b in self._open]
        inside += [(theta == 0.0) & (a == 0.0) for a, _ in self._open[:1]]
        return np.any(inside, axis=0)

    def degrees(self, samples: int) -> np.ndarray:
        """Of 0 ... 360(N-1)/N those driver angles [deg] at which the linkage stands somewhere."""
        all_of = degrees(samples)
        return all_of[self.within(np.deg2rad(all_of))]

    def theta(self, place: float) -> float:
        """The angle [rad], 0 ... 2π, at which the crank stands at a place [rad]: on its way forth where it swings."""
        if self.swing is None:
            return float(place / self.turns % TURN)
        low, high = self.swing.low, self.swing.high
        return float(np.clip((place - low) / (high - low), 0.0, 1.0) * np.pi)

    def state(self, angles: Angles) -> MotionState:
        """The crank's angle and its derivatives by itself, or by the angle of the cycle.

        References
        ----------
        φ = φ_0 + r (θ - θ_0) over each part of the cycle: ends of the drawn circuit, ratios.
        """
        one = np.ones(angles.theta.size)
        none = np.zeros(angles.theta.size)
        if self.swing is not None:
            low, high = self.swing.low, self.swing.high
            sign = np.where(self.ends[angles.piece] <= np.pi, 1.0, -1.0)
            rate = (high - low) / np.pi
            q = np.where(sign > 0.0, low + rate * angles.theta, low + rate * (TURN - angles.theta))
            return MotionState(angles, Derivatives.of((q, rate * sign, none, none)), sign)
        q = angles.theta * self.turns
        return MotionState(angles, Derivatives.of((q, one * self.turns, none, none)), one)


@lru_cache(maxsize=32)
def swept(program: CompiledMotion) -> tuple[float, float]:
    """Lowest and highest driver position [rad or m] of a motion: its pieces turn at their ends only. A motion that stands
    still is given a little room."""
    pieces = np.arange(program.starts.size)
    ends = Angles(np.concatenate((program.starts, program.ends)), np.concatenate((pieces, pieces)))
    low, high = with_room(program.state(ends).displacement[0])
    return float(low), float(high)


def with_room(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A little less than the lowest and more than the highest of positions (..., n)."""
    low, high = y.min(axis=-1), y.max(axis=-1)
    room = np.where(high == low, 1e-6, 1e-9 * (high - low))
    return low - room, high + room


# -- which link of a linkage leads, and how ---------------------------------------------------------------------


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
            and range_distance(driver_ranges, kinematics, place) < SAME_PLACE * driver_ranges.plan.size
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
def range_distance(driver_ranges: DriverRanges, kinematics: Kinematics, place: float) -> float:
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


# -- the circuits of a linkage ----------------------------------------------------------------------------------


@frozen
class Circuit:
    """One of them: the design drawn in it, with the range of its driver [rad or m]; here: the design is in it now."""

    design: Design
    range: DriverRange
    here: bool


def circuits(design: Design) -> tuple[Circuit, ...]:
    """The circuits of a linkage, its own first; of one that follows a motion those that let it go through all of that.

    Two assemblies are one circuit where the driver takes the links from one to the other, over change points too. Raises
    NoPosition where its own links do not meet.
    """
    linkage = with_drive(design, mechanism=design.drive.posed).drive.linkage
    low, high = (0.0, TURN) if linkage.driver.kind == CRANK else swept(program(design.drive.motion))
    plain = replace(linkage, drawn=None, branch=())
    joints = sided_joints(plain)
    found: list[tuple[Circuit, DriverRanges]] = []
    own = driver_ranges_of(linkage, low, high)
    if not own.ranges:
        raise NoPosition("its links cannot be put together", "linkage.links", "change their lengths")
    found += [(Circuit(design, r, i == 0), own) for i, r in enumerate(own.ranges)]
    for sides in islice(product((1, -1), repeat=len(joints)), MOST_SIDES):
        checkpoint()
        tried = replace(plain, branch=tuple(Side(joint, side) for joint, side in zip(joints, sides, strict=True)))
        ranges = driver_ranges_of(tried, low, high)
        for each in ranges.ranges:
            if linkage.driver.kind != CRANK and not each.free:
                continue
            place = 0.5 * (each.low + each.high)
            kinematics = unit_speed_kinematics(tried, np.array([place]), ranges)
            turns = (-TURN, 0.0, TURN) if linkage.driver.kind == CRANK else (0.0,)
            if any(_goes_there(circuit, known, kinematics, place + turn) for circuit, known in found for turn in turns):
                continue
            made = as_drawn(plain, place, {n: kinematics.bodies[body_name(n)] for n in plain.by_number})
            try:
                whole = driver_ranges_of(made, low, high)
            except NoPosition:  # two assemblies as near to each other: no drawing tells them apart
                continue
            if whole.ranges:
                found.append((Circuit(with_drive(design, mechanism=made), whole.ranges[0], False), whole))
    return tuple(circuit for circuit, _ in found)


def _goes_there(circuit: Circuit, ranges: DriverRanges, kinematics: Kinematics, place: float) -> bool:
    """Whether the links of a circuit stand so (n = 1) with the driver at this place."""
    if not circuit.range.low <= place <= circuit.range.high:
        return False
    return range_distance(ranges, kinematics, place) < SAME_PLACE * ranges.plan.size


# -- the wheels of second inputs --------------------------------------------------------------------------------


@frozen
class Wheel:
    """A pitch circle: the link that it is fixed to, the point of that link at its centre, its radius [mm]; of a rack 0, and no point."""

    link: int
    point: str
    radius: float


@frozen
class WheelPair:
    """Two wheels that roll on each other, or carry a belt; carrier: the link on which both their centres are. along: the way in which a
    rack, the second, goes where its pinion turns counter-clockwise, in the frame of the carrier."""

    kind: str
    first: Wheel
    second: Wheel
    carrier: int
    along: complex = 0j

    @property
    def round(self) -> tuple[Wheel, ...]:
        """Those that are circles."""
        return tuple(wheel for wheel in (self.first, self.second) if wheel.radius)


def wheel_distance(pair: WheelPair, linkage: Linkage) -> float:
    """How far the pitch circles are from touching [mm], less than 0 where they cross; of a belt only how far its pulleys
    cross. A rack lies where its pinion is."""
    if pair.kind == RACK:
        return 0.0
    places = linkage.by_number[pair.carrier].places
    distance = abs(places[pair.second.point] - places[pair.first.point])
    one, other = pair.first.radius, pair.second.radius
    if pair.kind == INTERNAL:
        return abs(one - other) - distance
    return min(distance - one - other, 0.0) if pair.kind == BELT else distance - one - other


def wheel_pairs(linkage: Linkage) -> Iterator[WheelPair]:
    """The wheels of every second input whose radii follow from radius_mm, or from teeth and a module: the first turns with the
    driver, or stands on the frame where the driver's link carries the second."""
    pivot = driver_pair(linkage)
    if pivot is None:
        return
    pins = {step.links[0]: step.joint for step in solving_order(linkage).steps if step.kind == INPUT}
    driver = linkage.driver.link
    for each in linkage.drivers:
        radii = each.pitch_radii
        if radii is not None and each.kind == RACK:
            yield from _rack(linkage, each, pivot, pins.get(each.link, ""), radii)
            continue
        if radii is None or not is_pin(pivot) or each.on not in (FRAME_LINK, driver) or each.link not in pins:
            continue
        first = Wheel(driver if each.on == FRAME_LINK else FRAME_LINK, pivot, radii[0])
        yield WheelPair(each.kind or GEAR, first, Wheel(each.link, pins[each.link], radii[1]), each.on)


def _rack(
    linkage: Linkage, row: SecondDriver, driving: str, driven: str, radii: tuple[float, float]
) -> Iterator[WheelPair]:
    """The pinion of a rack that slides along a line of the link that carries both: the driver's wheel, or that of the second input."""
    slides = input_slides(linkage, row)
    rack, pin = (row.link, driving) if slides else (linkage.driver.link, driven)
    lines = [s for s in linkage.sliders if (s.link, s.on) == (rack, row.on)]
    if not lines or not pin or not is_pin(pin) or pin not in linkage.by_number[row.on].places:
        return
    turns = (linkage.driver.link if row.on == FRAME_LINK else FRAME_LINK) if slides else row.link
    sense = -1.0 if linkage.ratios[row.link] < 0.0 else 1.0
    along = heading(radians(lines[0].angle_deg)) * sense
    yield WheelPair(RACK, Wheel(turns, pin, max(radii)), Wheel(rack, "", 0.0), row.on, along)
