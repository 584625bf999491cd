"""A solved mechanism as Kinematics: every link a body, so that drawing, centres, cam and forces walk it like any other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import numpy as np

from core.design import CRANK, Linkage
from core.design.topology import GROUP, SolutionStep, is_pin
from core.errors import NoAssembly, NoPosition, angle_list, angle_ranges
from core.mechanism.driver_ranges import DriverRanges, driver_ranges_of, guided_ranges
from core.mechanism.dyads import DyadSolution, line_of
from core.mechanism.kinematics import FRAME, Kinematics, Pose
from core.mechanism.linkage import Joint, SolutionPlan
from core.mechanism.mechanism import ROLLER, InputSolution, Mechanism, Solved, at_driver, condition, mechanism_of
from core.motion import Angles, MotionState
from core.numerics.derivatives import Derivatives, cross, difference, dot, heading, product, scaled, spread

Points = Mapping[int, Mapping[str, complex]]


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # rates at a dead centre are infinite
def solve_mechanism(mechanism: Mechanism, motion: MotionState, driver_ranges: DriverRanges | None = None) -> Kinematics:
    """Every body at the motion's positions y (4, n), with three derivatives by the motion's angle.

    driver_ranges: where the links can go; without one they are followed from the base position through all that the motion
    takes. The cam's follower is a body of its own where the reference is not its link's origin. Raises NoSolution, naming
    the angles, where links do not meet.
    """
    plan, y, n = mechanism.plan, motion.displacement, motion.theta.shape[-1]
    if driver_ranges is None:
        driver_ranges = driver_ranges_for(mechanism, lambda: (float(y[0].min()), float(y[0].max())))
    q = y if driver_ranges.swings or driver_ranges.turns > 1 else _driver(mechanism, motion)
    solved = driver_ranges.solve(q)
    calm = _require(mechanism, driver_ranges, solved, motion)
    if mechanism.require is not None:
        mechanism.require(mechanism.start, motion)
    points, reference, ground = mechanism.places, mechanism.reference, mechanism.ground
    bodies = {
        name: _body(solved.poses[link], points[link], mechanism, n, calm) for link, name in mechanism.bodies.items()
    }
    output, on = mechanism.bodies[plan.driver.second.link], plan.driver.first.link
    follower = carrier = output
    if reference is not None:
        follower, carrier = reference.body, mechanism.bodies[reference.link]
        if follower not in bodies:
            bodies[follower] = _at_reference(bodies[carrier], points[reference.link][reference.point], calm)
    return Kinematics(
        motion=motion,
        bodies=bodies,
        pairs=mechanism.joined,
        dyads=mechanism.dyads,
        output=output,
        follower_body=follower,
        ground=ground,
        travel=lambda: _travel(mechanism, driver_ranges, q[0], bodies, ground),
        coordinates=lambda: {name: _coordinate(solved, plan, what, n) for name, what in mechanism.coordinates.items()},
        base=mechanism.base,
        residual=lambda: spread(_residual(plan, solved), n),
        condition=lambda: spread(condition(plan, solved), n),
        singular=lambda: _singular(mechanism, solved, n),
        transmission=lambda: {joint: spread(dyad.transmission, n) for joint, dyad in _dyads(mechanism, solved)},
        carrier=carrier,
        sense=mechanism.sense,
        driver_on=mechanism.bodies.get(on, FRAME),
        by_driver=lambda: _by_driver(mechanism, driver_ranges, q[0], points),
    )


def driver_ranges_for(mechanism: Mechanism, ends: Callable[[], tuple[float, float]]) -> DriverRanges:
    """The driver ranges of a mechanism for motions between two ends [rad or m], or the whole turn of its crank."""
    if mechanism.ranged:
        return driver_ranges_of(mechanism.linkage, *ends())

    def positions() -> tuple[float, float]:
        low, high = ends()
        reached = mechanism.start + mechanism.sense * np.array([0.0, low, high])
        return float(reached.min()), float(reached.max())

    return guided_ranges(mechanism.plan, mechanism.start, positions, mechanism.angles)


def unit_speed_kinematics(linkage: Linkage, positions: np.ndarray, driver_ranges: DriverRanges) -> Kinematics:
    """The linkage with its driver at these positions (n,) [rad or m] and derivatives by the driver's own coordinate:
    what needs directions only, such as instant centres, stands in a dwell of the motion too."""
    state = MotionState(
        Angles(positions, np.zeros(positions.size, dtype=int)), at_driver(positions), np.ones(positions.size)
    )
    return solve_mechanism(mechanism_of(linkage), state, driver_ranges)


def _driver(mechanism: Mechanism, motion: MotionState) -> Derivatives:
    """q = start + sense y with its derivatives by the motion's angle."""
    y, start, sense = motion.displacement, mechanism.start, mechanism.sense
    if mechanism.linkage.driver.kind == CRANK:
        return at_driver(y[0])
    if not start and sense == 1.0:
        return y
    return Derivatives(lambda order: sense * y[order] if order else start + sense * y[0])


def _require(mechanism: Mechanism, driver_ranges: DriverRanges, solved: Solved, motion: MotionState) -> bool:
    """Every link somewhere at every angle; a mechanism that refuses for itself stays off dead centres too. Whether all rates are finite
    for sure."""
    calm = True
    for (step, _), result in zip(driver_ranges.plan.steps, solved.steps, strict=True):
        if isinstance(result, InputSolution):
            continue
        least = result.sine.min() if isinstance(result, DyadSolution) else 0.0
        calm = calm and bool(least > _CALM)
        if least > 0.0:  # nan is not
            continue
        first, last = (solved.poses[step.links[i]] for i in (0, -1))
        lost = ~np.isfinite(first.unit + last.unit)
        if mechanism.refuse is not None and isinstance(result, DyadSolution):
            lost = lost | ~(result.sine > 0.0)
        lost = spread(lost, motion.theta.shape[-1])
        if mechanism.refuse is not None:
            NoAssembly.raise_where(lost, lambda lost=lost: mechanism.refuse(motion, solved, lost))  # type: ignore[misc]
            continue
        NoPosition.raise_where(lost, lambda step=step, lost=lost: _apart(driver_ranges, step, motion, lost))  # type: ignore[misc]
    return calm


_CALM = 1e-30  # sine of the transmission angle above which three derivatives stay below the largest number


def _apart(driver_ranges: DriverRanges, step: SolutionStep, motion: MotionState, lost: np.ndarray) -> NoAssembly:
    """Why the links of a step do not meet at some angles: the driver's positions at which they do, and, disjoint from these, those to which
    a motion takes it."""
    links = " and ".join(map(str, step.links)) if len(step.links) == 2 else ", ".join(map(str, step.links))
    joint = f" at {step.joint}" if step.kind != GROUP and is_pin(step.joint) else ""
    driver, y = driver_ranges.plan.driver, motion.displacement[0]
    scale, unit = (180.0 / np.pi, "deg") if driver.revolute else (1e3, "mm")
    ends = [float(y.min()), *(end for r in driver_ranges.ranges for end in (r.low, r.high)), float(y.max())]
    beyond = [(a * scale, b * scale) for a, b in zip(ends[::2], ends[1::2], strict=True) if a < b]
    hint = "change their lengths"
    if driver_ranges.ranges:
        ranges = [(r.low * scale, r.high * scale) for r in driver_ranges.ranges]
        hint = f"they do with the driver within {angle_list(ranges, unit=unit)}"
        if driver_ranges.plan.linkage.driver.kind != CRANK and beyond:
            hint += f", and the motion takes it to {angle_list(beyond, unit=unit)}: lessen its rise, or change their lengths"
    kind = NoPosition if driver_ranges.plan.linkage.driver.kind == CRANK else NoAssembly
    return kind(f"links {links} do not meet{joint}", "linkage.links", hint, angle_ranges(motion.theta, lost))


def _body(pose: Pose, points: Mapping[str, complex], mechanism: Mechanism, n: int, calm: bool) -> Pose:
    """A link of the own frame as a body in the global one, with a value at each of the n positions. Where not all rates are finite, as
    at a dead centre, they warn nobody."""
    place, turn = mechanism.place, mechanism.turn
    along = heading(turn) if turn else 1.0

    def origin(order: int) -> np.ndarray:
        row = pose.origin[order]
        row = row * along if turn else row
        return spread(row + place if place and not order else row, n)

    def angle(order: int) -> np.ndarray:
        row = pose.turn[order]
        return spread(row + turn if turn and not order else row, n)

    there = Pose(
        Derivatives(origin, pose.origin.constant),
        Derivatives(angle, pose.turn.constant),
        points,
        lambda: spread(pose.unit * along if turn else pose.unit, n),
        lambda: (scaled(pose.spin, along) if turn else pose.spin).spread(n),
    )
    return (
        there
        if calm
        else Pose(
            there.origin.without_warnings(),
            there.turn.without_warnings(),
            points,
            lambda: there.unit,
            lambda: there.spin.without_warnings(),
        )
    )


def _at_reference(pose: Pose, at: complex, calm: bool) -> Pose:
    """The cam's follower as a body: its origin is the reference point, and it turns with its link."""
    place = pose.carried(at)
    return Pose(
        place if calm else place.without_warnings(),
        pose.turn,
        MappingProxyType({ROLLER: 0j}),
        lambda: pose.unit,
        lambda: pose.spin,
    )


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _by_driver(mechanism: Mechanism, driver_ranges: DriverRanges, q: np.ndarray, points: Points) -> Mapping[str, Pose]:
    """Every body at the driver's positions (n,), its derivatives by the driver's coordinate."""
    poses = driver_ranges.solve(at_driver(q)).poses
    return {
        name: _body(poses[link], points[link], mechanism, q.shape[-1], False) for link, name in mechanism.bodies.items()
    }


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _travel(
    mechanism: Mechanism, driver_ranges: DriverRanges, q: np.ndarray, bodies: Mapping[str, Pose], ground: str
) -> np.ndarray:
    """The direction (n,) in which the reference point can go, in a dwell too: about its link's pivot or along its guide
    where the frame holds the link, else by the derivative with respect to the driver's coordinate q (n,)."""
    reference, plan = mechanism.reference, mechanism.plan
    if reference is None:
        return np.ones(q.shape[-1], dtype=complex)
    at = plan.points[reference.link][reference.point]
    if not ground:
        path = driver_ranges.solve(at_driver(q)).poses[reference.link].carried(at)[1] * heading(mechanism.turn)
        return spread(np.asarray(path / np.abs(path)), q.shape[-1])
    held = next(j for j, name in mechanism.pair_names.items() if name == ground)
    own = held.second if held.second.link == reference.link else held.first
    arm = 1j * (at - own.point) if held.revolute else own.along
    return np.asarray(bodies[mechanism.bodies[reference.link]].unit * (arm / abs(arm)))


def _coordinate(solved: Solved, plan: SolutionPlan, what: int | str, n: int) -> Derivatives:
    """The angle of a link, or the slide of a sliding pair, in the own frame, of n values."""
    if isinstance(what, int):
        return solved.poses[what].turn.spread(n).without_warnings()
    joint = next(j for j in plan.joints if j.name == what)
    return _slide(solved, joint).spread(n).without_warnings()


def _slide(solved: Solved, joint: Joint) -> Derivatives:
    """How far the sliding link's point has gone along the line [m]."""
    line, point = (joint.first, joint.second) if str(joint.second.link) == joint.name else (joint.second, joint.first)
    g, along = line_of(solved.poses, line)
    return product(along, difference(solved.poses[point.link].carried(point.point), g), dot)


def _residual(plan: SolutionPlan, solved: Solved) -> np.ndarray:
    """How far the pairs are open at worst (n,), relative to the size of the linkage."""
    worst, poses = np.zeros(1), solved.poses
    for joint in plan.joints:
        one, other = (poses[held.link].carried(held.point)[0] for held in (joint.first, joint.second))
        gap = other - one
        if not joint.revolute:
            gap = cross(joint.first.along * poses[joint.first.link].unit, gap)
        worst = np.maximum(worst, np.abs(gap))
    return worst / plan.size


def _dyads(mechanism: Mechanism, solved: Solved) -> Iterator[tuple[str, DyadSolution]]:
    """Each dyad by its joint."""
    for (step, _), result in zip(mechanism.plan.steps, solved.steps, strict=True):
        if isinstance(result, DyadSolution):
            yield step.joint, result


def _singular(mechanism: Mechanism, solved: Solved, n: int) -> Mapping[str, np.ndarray]:
    """What must not vanish: the sine of each dyad's transmission angle, and what the mechanism adds."""
    found = {mechanism.singular.get(joint, joint): dyad.sine for joint, dyad in _dyads(mechanism, solved)}
    if mechanism.more_singular is not None:
        found |= mechanism.more_singular(solved)
    return {code: spread(value, n) for code, value in found.items()}
