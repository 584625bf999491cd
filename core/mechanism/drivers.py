"""Driver of a linkage: a crank at constant speed, or a link that follows a motion; circuits, and the wheels of second inputs."""

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
from core.mechanism.driver_ranges import TURN, DriverRange, DriverRanges, driver_ranges_of
from core.mechanism.kinematics import Kinematics
from core.mechanism.linkage import plan_of
from core.mechanism.mechanism import at_driver, body_name
from core.mechanism.solving import unit_speed_kinematics
from core.motion import SNAP, Angles, CompiledMotion, Join, MotionState, degrees, program
from core.numerics.derivatives import Derivatives, heading
from core.numerics.lazy import checkpoint

# -- motion of a crank ------------------------------------------------------------------------------------------


class CrankMotion:
    """Motion of a crank over its cycle, with a piece for each range in which the linkage can be assembled.

    It has the methods of a compiled motion whose value is the crank's angle. A swinging crank moves at constant speed through its
    range in the first half of the cycle, and back in the second.

    Attributes
    ----------
    starts, ends : ndarray (m,) [rad]
        Ends of the pieces: driver angles, or angles of the cycle where the crank swings or the cycle has several turns.
    swing : DriverRange or None
        Range of a swinging crank.
    """

    joins: tuple[Join, ...] = ()

    def __init__(self, driver_ranges: DriverRanges) -> None:
        self.swing = driver_ranges.ranges[0] if driver_ranges.is_swinging else None
        ranges = [(0.0, np.pi), (np.pi, TURN)] if self.swing else [(r.low, r.high) for r in driver_ranges.ranges]
        self.turns = driver_ranges.turns
        if self.turns > 1 and not self.swing:
            is_full = len(ranges) == 1 and driver_ranges.ranges[0].is_free
            ranges = [(0.0, TURN)] if is_full else [(a / self.turns, b / self.turns) for a, b in ranges]
        self._ranges = tuple(ranges)
        self.starts, self.ends = np.array(self._pieces(driver_ranges.motions)).reshape(-1, 2).T

    def _pieces(self, motions: Iterable[Motion]) -> list[tuple[float, float]]:
        """The ranges, divided where a piece of a second driver's motion begins, so that every part is smooth."""
        starts = {float(at) for motion in motions for at in program(motion).starts}
        if not starts:
            return list(self._ranges)
        if self.swing is not None:
            low, high = self.swing.low, self.swing.high
            angles = (at + TURN * k for at in starts for k in range(int(low // TURN) - 1, int(high // TURN) + 2))
            cuts = {(angle - low) / (high - low) * np.pi for angle in angles if low < angle < high}
            cuts |= {TURN - at for at in cuts}
        else:
            cuts = {(at + TURN * k) / self.turns for at in starts for k in range(self.turns)}
        parts = []
        for a, b in self._ranges:
            ends = [a, *sorted(at for at in cuts if a + SNAP < at < b - SNAP), b]
            parts += list(pairwise(ends))
        return parts

    def angles(self, theta: np.ndarray, cached: bool = False) -> Angles:
        """Driver angles, or angles of the cycle, with their pieces.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Any angles.
        cached : bool
            As of a compiled motion.

        Returns
        -------
        Angles
        """
        theta = np.mod(np.asarray(theta, dtype=float), TURN)
        theta = np.where(theta >= TURN - SNAP, 0.0, theta)
        piece = np.clip(np.searchsorted(self.starts, theta, side="right") - 1, 0, None)
        return Angles(theta, piece, cached)

    def is_assembled(self, theta: np.ndarray) -> np.ndarray:
        """Whether the linkage can be assembled and is not locked.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Angles, 0 ... 2π.

        Returns
        -------
        ndarray (n,) of bool, dimensionless
        """
        if self.swing is not None:
            return (theta != 0.0) & (theta != np.pi)
        if self._ranges == ((0.0, TURN),):
            return np.ones(theta.shape, dtype=bool)
        inside = [(theta > a) & (theta < b) for a, b in self._ranges]
        inside += [(theta == 0.0) & (a == 0.0) for a, _ in self._ranges[:1]]
        return np.any(inside, axis=0)

    def degrees(self, samples: int) -> np.ndarray:
        """Angles 0 ... 360(N-1)/N at which the linkage can be assembled.

        Parameters
        ----------
        samples : int
            Number N.

        Returns
        -------
        ndarray (n,) [deg]
        """
        angles = degrees(samples)
        return angles[self.is_assembled(np.deg2rad(angles))]

    def theta(self, position: float) -> float:
        """Angle 0 ... 2π [rad] at which the crank has a position [rad], in the first half of the cycle where it swings."""
        if self.swing is None:
            return float(position / self.turns % TURN)
        low, high = self.swing.low, self.swing.high
        return float(np.clip((position - low) / (high - low), 0.0, 1.0) * np.pi)

    def state(self, angles: Angles) -> MotionState:
        """Angle of the crank, φ = φ_0 + r (θ - θ_0), with its derivatives by the angle of the cycle."""
        ones = np.ones(angles.theta.size)
        zeros = np.zeros(angles.theta.size)
        if self.swing is not None:
            low, high = self.swing.low, self.swing.high
            sign = np.where(self.ends[angles.piece] <= np.pi, 1.0, -1.0)
            rate = (high - low) / np.pi
            q = np.where(sign > 0.0, low + rate * angles.theta, low + rate * (TURN - angles.theta))
            return MotionState(angles, Derivatives.of((q, rate * sign, zeros, zeros)), sign)
        q = angles.theta * self.turns
        return MotionState(angles, Derivatives.of((q, ones * self.turns, zeros, zeros)), ones)


@lru_cache(maxsize=32)
def motion_extent(program: CompiledMotion) -> tuple[float, float]:
    """Lowest and highest driver position [rad or m] of a motion, with a small margin."""
    low, high = with_margin(np.array(program.position_range))
    return float(low), float(high)


def with_margin(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest of positions, with a small margin.

    Parameters
    ----------
    y : ndarray (..., n) [rad or m]
        Leading axes are designs.

    Returns
    -------
    low, high : ndarray (...,) [rad or m]
    """
    low, high = y.min(axis=-1), y.max(axis=-1)
    margin = np.where(high == low, 1e-6, 1e-9 * (high - low))
    return low - margin, high + margin


# -- choice of the driver, and the roller of a cam --------------------------------------------------------------


SWING = np.deg2rad(30.0)  # [rad] of the first motion of a pinned link
SLIDE = 0.1  # of the size: first motion of a sliding link
ROLLER_SIZE = 0.08  # of the size: radius of a first roller
LAW, SPANS = "cycloidal", (60.0, 120.0, 60.0, 120.0)
SAME_POSITION = 1e-6  # of the size: smaller distances are the same position
_NEAR = 1e-3  # of a range: a position nearer to its end is at the dead centre
MOST_SIDES = 256  # assemblies that are tried


def drivers(design: Design) -> Iterator[Driver]:
    """All possible drivers of a linkage with which it can be solved.

    A link pinned to the frame can be driven at constant speed or by a motion, a sliding one by a motion.
    """
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
    """The design with another driver, assembled as in the position (n = 1) of the kinematics.

    A link that follows a motion receives a first motion from this position: dwell, rise, dwell, return, as large as the linkage
    allows and marked as assumed. A crank at constant speed has neither motion nor cam.

    Raises
    ------
    NoPosition
        The link cannot drive the linkage from this position.
    """
    old = design.drive.linkage.driver
    if (driver.link, driver.kind, driver.on) == (old.link, old.kind, old.on):
        return with_drive(design, mechanism=replace(design.drive.linkage, driver=driver))
    linkage = replace(design.drive.linkage, driver=driver, branch=(), drawn=None)
    q = driver_position(linkage, kinematics)
    if driver.kind == CRANK:
        linkage = _drawn_as_design(design, _assembled(linkage, kinematics, q % TURN, 0.0, TURN)[0], q, kinematics)
        assumed = tuple(path for path in design.assumed if not path.startswith(("motion.", "cam.")))
        return with_drive(design, mechanism=linkage, motion=None, cam=None, assumed=assumed)
    half = pi if _unit(linkage) == "deg" else plan_of(linkage).size
    _, widest = _assembled(linkage, kinematics, q, q - half, q + half)
    motion = _first_motion(linkage, widest, q)
    # sides are stated at the driver's lowest position, which has changed
    low, high = motion_extent(program(motion))
    start = min(max(q, low), high)  # the motion's start is rounded
    linkage = _drawn_as_design(design, _assembled(linkage, kinematics, start, low, high)[0], q, kinematics)
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    changed = with_drive(design, mechanism=linkage, motion=motion, assumed=assumed)
    advance = f"motion.advance_{motion.unit}"  # a first motion has none
    marks = tuple(path for path in all_paths(changed) if path.startswith("motion.") and path != advance)
    return replace(changed, assumed=(*marks, *assumed))


def _drawn_as_design(design: Design, linkage: Linkage, q: float, kinematics: Kinematics) -> Linkage:
    """The linkage with branch signs, or with its drawn pose where the design has one; q: driver position [rad or m]."""
    if design.drive.linkage.drawn is None:
        return linkage
    from core.mechanism.drawn import as_drawn  # imported here to save start-up time

    return as_drawn(linkage, q, {n: kinematics.bodies[body_name(n)] for n in linkage.by_number})


def with_drawn_pose(design: Design, kinematics: Kinematics) -> Design:
    """The design with its linkage drawn in the position (n = 1) of the kinematics, instead of branch signs."""
    from core.mechanism.drawn import as_drawn  # imported here to save start-up time

    linkage = design.drive.linkage
    poses = {n: kinematics.bodies[body_name(n)] for n in linkage.by_number}
    return with_drive(design, mechanism=as_drawn(linkage, driver_position(linkage, kinematics), poses))


def with_signs(design: Design) -> Design:
    """The design with branch signs of the drawn assembly instead of the drawn pose.

    Raises
    ------
    NoPosition
        No branch signs describe the drawn assembly.
    """
    linkage = with_drive(design, mechanism=design.drive.posed).drive.linkage
    if linkage.drawn is None:
        return design
    from core.mechanism.drawn import drawn_position  # imported here to save start-up time

    low, high = (0.0, TURN) if linkage.driver.kind == CRANK else motion_extent(program(design.drive.motion))
    driver_ranges = driver_ranges_of(linkage, low, high)
    if not driver_ranges.ranges:
        raise NoPosition("its links cannot be assembled as drawn", "linkage.drawn", "change their lengths")
    drawn_range, q = driver_ranges.ranges[0], drawn_position(linkage.drawn)
    if linkage.driver.kind == CRANK and not driver_ranges.is_swinging:
        q %= TURN
    inset = 2.0 * _NEAR * (drawn_range.high - drawn_range.low)
    low_end = drawn_range.low + inset * bool(drawn_range.low_joint)
    q = min(max(q, low_end), drawn_range.high - inset * bool(drawn_range.high_joint))
    kinematics = unit_speed_kinematics(linkage, np.array([q]), driver_ranges)
    at = q % TURN if linkage.driver.kind == CRANK else q
    signed, _ = _assembled(replace(linkage, drawn=None), kinematics, at, low, high)
    return with_drive(design, mechanism=signed)


def with_roller(design: Design, link: int, point: str) -> Design:
    """The design with its cam under a roller at a point of a link; the radius of a first roller is marked as assumed.

    Raises
    ------
    NoPosition
        No motion drives the linkage.
    """
    if design.drive.has_disk:
        return with_drive(design, cam=replace(design.drive.cam, link=link, point=point))
    if design.drive.motion is None:
        raise NoPosition("a cam needs a motion", "linkage.driver.kind", "let a link follow a motion first")
    radius = _readable(1e3 * ROLLER_SIZE * plan_of(design.drive.linkage).size)
    mark = "cam.roller_radius_mm"
    assumed = (*(path for path in design.assumed if path != mark), mark)
    return with_drive(design, cam=LinkageCam(link=link, point=point, face=Roller(radius)), assumed=assumed)


def without_roller(design: Design) -> Design:
    """The design without its cam."""
    assumed = tuple(path for path in design.assumed if not path.startswith("cam."))
    return with_drive(design, cam=None, assumed=assumed)


def roller_points(design: Design) -> tuple[tuple[int, str], ...]:
    """Link and name of every point at which a roller can be: each moving point once, on the first link that has it."""
    fixed = set(design.drive.linkage.by_number[FRAME_LINK].places)
    links: dict[str, int] = {}
    for link in design.drive.linkage.links:
        for name in link.places:
            if name not in fixed:
                links.setdefault(name, link.number)
    return tuple((link, name) for name, link in links.items())


def _unit(linkage: Linkage) -> str:
    return "deg" if driver_turns(linkage) else "mm"


def driver_position(linkage: Linkage, kinematics: Kinematics) -> float:
    """Position [rad or m] of the driver in kinematics with n = 1."""
    name = body_name(linkage.driver.link)
    if _unit(linkage) == "mm":
        return float(kinematics.coordinates[f"slide{driver_pair(linkage)}"][0][0])
    if linkage.driver.on != FRAME_LINK:
        angle, reference = (
            kinematics.bodies[body_name(n)].angle[0, 0] for n in (linkage.driver.link, linkage.driver.on)
        )
        return float(angle - reference)
    if name in kinematics.coordinates:
        return float(kinematics.coordinates[name][0][0])
    return float(kinematics.bodies[name].angle[0, 0])


def _assembled(
    linkage: Linkage, kinematics: Kinematics, q: float, low: float, high: float
) -> tuple[Linkage, DriverRange]:
    """The linkage with the sides of this position, and the driver range around it, between low and high."""
    joints = sided_joints(linkage)
    for sides in islice(product((1, -1), repeat=len(joints)), MOST_SIDES):
        checkpoint()
        signed = replace(linkage, branch=tuple(Side(joint, side) for joint, side in zip(joints, sides, strict=True)))
        driver_ranges = driver_ranges_of(signed, low, high)
        current = next((r for r in driver_ranges.ranges if r.low <= q <= r.high), None)
        if (
            current is not None
            and not _is_dead_centre(current, q)
            and range_distance(driver_ranges, kinematics, q) < SAME_POSITION * driver_ranges.plan.size
        ):
            return signed, current
    raise NoPosition(
        f"link {linkage.driver.link} cannot drive the linkage from this position",
        "linkage.driver.link",
        "turn it to another position first: this one is at a dead centre, or beyond it",
    )


def _is_dead_centre(current: DriverRange, q: float) -> bool:
    """Whether a position is at a dead centre of its range."""
    near = _NEAR * (current.high - current.low)
    return bool((current.low_joint and q - current.low < near) or (current.high_joint and current.high - q < near))


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # rates at a dead centre are infinite
def range_distance(driver_ranges: DriverRanges, kinematics: Kinematics, q: float) -> float:
    """Largest distance [m] between the points of driver ranges at q and those of the kinematics (n = 1); infinite without assembly."""
    poses = driver_ranges.solve(at_driver(np.array([q]))).poses
    distances = [
        abs(poses[link].fixed_point(at)[0][0] - kinematics.bodies[body_name(link)].fixed_point(at)[0][0])
        for link, points in driver_ranges.plan.points.items()
        for at in points.values()
    ]
    worst = float(np.max(distances))
    return worst if isfinite(worst) else inf


def first_motion(linkage: Linkage, q: float) -> Motion | None:
    """First motion (dwell, rise, dwell, return) from a driver position q [rad or m] of a linkage that is drawn.

    None where the linkage cannot be assembled at q.
    """
    half = pi if _unit(linkage) == "deg" else plan_of(linkage).size
    ranges = driver_ranges_of(linkage, q - half, q + half).ranges
    current = next((r for r in ranges if r.low <= q <= r.high), None)
    return None if current is None or current.low == current.high else _first_motion(linkage, current, q)


def _first_motion(linkage: Linkage, current: DriverRange, q: float) -> Motion:
    """Dwell, rise, dwell, return, towards the farther end of the driver range and at most half of the way."""
    unit = _unit(linkage)
    scale = 180.0 / pi if unit == "deg" else 1e3
    ahead, behind = current.high - q, q - current.low
    most = SWING if unit == "deg" else SLIDE * plan_of(linkage).size
    rise = _readable(min(most, 0.5 * max(ahead, behind)) * scale) * (1.0 if ahead >= behind else -1.0)
    spans = [Segment(span, 0.0) for span in SPANS]
    spans[1] = Segment(SPANS[1], rise, curve_of(LAW))
    spans[3] = Segment(SPANS[3], -rise, curve_of(LAW))
    return Motion(round(q * scale, 6) + 0.0, tuple(spans), unit)


def _readable(value: float) -> float:
    """Largest number with one significant digit that is not above a value."""
    unit = 10.0 ** floor(log10(value))
    return round(floor(value / unit + 1e-9) * unit, 9)


# -- the circuits of a linkage ----------------------------------------------------------------------------------


@frozen
class Circuit:
    """A circuit: the design drawn in it, the range of its driver [rad or m], and whether the design is in it now."""

    design: Design
    range: DriverRange
    is_current: bool


def circuits(design: Design) -> tuple[Circuit, ...]:
    """Circuits of a linkage, the current one first; for a driver with a motion only those in which it can perform all of it.

    Two assemblies belong to one circuit where the driver can move the links from one to the other, through change points too.

    Raises
    ------
    NoPosition
        The links of the design do not meet.
    """
    from core.mechanism.drawn import as_drawn  # imported here to save start-up time

    linkage = with_drive(design, mechanism=design.drive.posed).drive.linkage
    low, high = (0.0, TURN) if linkage.driver.kind == CRANK else motion_extent(program(design.drive.motion))
    plain = replace(linkage, drawn=None, branch=())
    joints = sided_joints(plain)
    current = driver_ranges_of(linkage, low, high)
    if not current.ranges:
        raise NoPosition("its links cannot be assembled", "linkage.links", "change their lengths")
    result = [(Circuit(design, r, i == 0), current) for i, r in enumerate(current.ranges)]
    for sides in islice(product((1, -1), repeat=len(joints)), MOST_SIDES):
        checkpoint()
        signed = replace(plain, branch=tuple(Side(joint, side) for joint, side in zip(joints, sides, strict=True)))
        ranges = driver_ranges_of(signed, low, high)
        for r in ranges.ranges:
            if linkage.driver.kind != CRANK and not r.is_free:
                continue
            q = 0.5 * (r.low + r.high)
            kinematics = unit_speed_kinematics(signed, np.array([q]), ranges)
            turns = (-TURN, 0.0, TURN) if linkage.driver.kind == CRANK else (0.0,)
            if any(_contains(circuit, known, kinematics, q + turn) for circuit, known in result for turn in turns):
                continue
            drawn = as_drawn(plain, q, {n: kinematics.bodies[body_name(n)] for n in plain.by_number})
            try:
                drawn_ranges = driver_ranges_of(drawn, low, high)
            except NoPosition:  # two assemblies so near to each other that no drawing distinguishes them
                continue
            if drawn_ranges.ranges:
                circuit = Circuit(with_drive(design, mechanism=drawn), drawn_ranges.ranges[0], False)
                result.append((circuit, drawn_ranges))
    return tuple(circuit for circuit, _ in result)


def _contains(circuit: Circuit, ranges: DriverRanges, kinematics: Kinematics, q: float) -> bool:
    """Whether a circuit contains the position (n = 1) of the kinematics, with the driver at q."""
    if not circuit.range.low <= q <= circuit.range.high:
        return False
    return range_distance(ranges, kinematics, q) < SAME_POSITION * ranges.plan.size


# -- the wheels of second inputs --------------------------------------------------------------------------------


@frozen
class Wheel:
    """Pitch circle: its link, the point of that link at its centre, and its radius [mm]; a rack has radius 0 and no point."""

    link: int
    point: str
    radius: float


@frozen
class WheelPair:
    """Two wheels in mesh, or with a common belt.

    Attributes
    ----------
    kind : str
        GEAR, INTERNAL, BELT or RACK.
    first, second : Wheel
    carrier : int
        Link on which both centres are.
    along : complex
        Direction, in the carrier's frame, in which a rack (the second) moves when its pinion turns counter-clockwise.
    """

    kind: str
    first: Wheel
    second: Wheel
    carrier: int
    along: complex = 0j

    @property
    def circles(self) -> tuple[Wheel, ...]:
        """The wheels that are circles, which a rack is not."""
        return tuple(wheel for wheel in (self.first, self.second) if wheel.radius)


def wheel_distance(pair: WheelPair, linkage: Linkage) -> float:
    """Gap [mm] between the pitch circles, negative where they intersect; at most 0 for a belt, and 0 for a rack."""
    if pair.kind == RACK:
        return 0.0
    points = linkage.by_number[pair.carrier].places
    distance = abs(points[pair.second.point] - points[pair.first.point])
    first, second = pair.first.radius, pair.second.radius
    if pair.kind == INTERNAL:
        return abs(first - second) - distance
    return min(distance - first - second, 0.0) if pair.kind == BELT else distance - first - second


def wheel_pairs(linkage: Linkage) -> Iterator[WheelPair]:
    """Wheels of every second input with given radii, or with teeth and a module.

    The first wheel turns with the driver, or is fixed to the frame where the driver's link carries the second.
    """
    pivot = driver_pair(linkage)
    if pivot is None:
        return
    pins = {step.links[0]: step.joint for step in solving_order(linkage).steps if step.kind == INPUT}
    driver = linkage.driver.link
    for row in linkage.drivers:
        radii = row.pitch_radii
        if radii is not None and row.kind == RACK:
            yield from _rack_pair(linkage, row, pivot, pins.get(row.link, ""), radii)
            continue
        if radii is None or not is_pin(pivot) or row.on not in (FRAME_LINK, driver) or row.link not in pins:
            continue
        first = Wheel(driver if row.on == FRAME_LINK else FRAME_LINK, pivot, radii[0])
        yield WheelPair(row.kind or GEAR, first, Wheel(row.link, pins[row.link], radii[1]), row.on)


def _rack_pair(
    linkage: Linkage, row: SecondDriver, driving: str, driven: str, radii: tuple[float, float]
) -> Iterator[WheelPair]:
    """Pinion and rack on a common carrier; the pinion is the driver's wheel, or that of the second input."""
    slides = input_slides(linkage, row)
    rack, pin = (row.link, driving) if slides else (linkage.driver.link, driven)
    lines = [s for s in linkage.sliders if (s.link, s.on) == (rack, row.on)]
    if not lines or not pin or not is_pin(pin) or pin not in linkage.by_number[row.on].places:
        return
    turns = (linkage.driver.link if row.on == FRAME_LINK else FRAME_LINK) if slides else row.link
    sign = -1.0 if linkage.ratios[row.link] < 0.0 else 1.0
    along = heading(radians(lines[0].angle_deg)) * sign
    yield WheelPair(RACK, Wheel(turns, pin, max(radii)), Wheel(rack, "", 0.0), row.on, along)
