"""Kinematics of a mechanism at given motions or driver positions, with every link as a body."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import numpy as np

from core.design import CRANK, Linkage
from core.design.topology import GROUP, SolutionStep, is_pin
from core.errors import NoAssembly, NoPosition, angle_list, angle_ranges
from core.mechanism.driver_ranges import DriverRanges, driver_ranges_of, guided_ranges
from core.mechanism.dyads import DyadSolution, line_of
from core.mechanism.kinematics import Kinematics, Pose
from core.mechanism.linkage import Joint, SolutionPlan
from core.mechanism.mechanism import (
    ROLLER,
    InputSolution,
    LinkageSolution,
    Mechanism,
    at_driver,
    condition,
    mechanism_of,
)
from core.motion import Angles, MotionState
from core.numerics.derivatives import Derivatives, cross, difference, dot, heading, product, scaled, spread

Points = Mapping[int, Mapping[str, complex]]


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # rates at a dead centre are infinite
def solve_mechanism(mechanism: Mechanism, motion: MotionState, driver_ranges: DriverRanges | None = None) -> Kinematics:
    """Kinematics of a mechanism whose driver follows a motion, with three derivatives by the motion's angle.

    The follower is a separate body where the reference point is not the origin of its link.

    Parameters
    ----------
    mechanism : Mechanism
    motion : MotionState
        Motion y (n,) [rad or m] with its derivatives.
    driver_ranges : DriverRanges, optional
        Ranges of the driver; by default those from the base position through the extremes of the motion.

    Returns
    -------
    Kinematics

    Raises
    ------
    NoSolution
        Links do not meet at some angles, which the message names.
    """
    plan, y, n = mechanism.plan, motion.displacement, motion.count
    if driver_ranges is None:
        driver_ranges = driver_ranges_for(mechanism, lambda: (float(y[0].min()), float(y[0].max())))
    q = y if driver_ranges.is_swinging or driver_ranges.turns > 1 else _driver(mechanism, motion)
    solution = driver_ranges.solve(q)
    is_finite = _require_assembly(mechanism, driver_ranges, solution, motion)
    if mechanism.require is not None:
        mechanism.require(mechanism.start, motion)
    points, reference, ground = mechanism.link_points, mechanism.names.reference, mechanism.ground
    bodies = {
        name: _body(solution.poses[link], points[link], mechanism, n, is_finite)
        for link, name in mechanism.bodies.items()
    }
    output, on = mechanism.bodies[plan.driver.second.link], plan.driver.first.link
    follower = carrier = output
    if reference is not None:
        follower, carrier = reference.body, mechanism.bodies[reference.link]
        if follower not in bodies:
            bodies[follower] = _follower_pose(bodies[carrier], points[reference.link][reference.point], is_finite)
    return Kinematics(
        motion=motion,
        bodies=bodies,
        pairs=mechanism.pairs_by_name,
        dyads=mechanism.dyads,
        output=output,
        follower_body=follower,
        ground=ground,
        travel=lambda: _travel(mechanism, driver_ranges, q[0], bodies, ground),
        coordinates=lambda: {
            name: _coordinate(solution, plan, key, n) for name, key in mechanism.names.coordinates.items()
        },
        base=mechanism.base,
        residual=lambda: spread(_residual(plan, solution), n),
        condition=lambda: spread(condition(plan, solution), n),
        singular=lambda: _singular(mechanism, solution, n),
        transmission=lambda: {joint: spread(dyad.transmission, n) for joint, dyad in _dyads(mechanism, solution)},
        carrier=carrier,
        driver_sign=mechanism.driver_sign,
        driver_on=mechanism.names.body(on),
        by_driver=lambda: _by_driver(mechanism, driver_ranges, q[0], points),
    )


def driver_ranges_for(mechanism: Mechanism, ends: Callable[[], tuple[float, float]]) -> DriverRanges:
    """Driver ranges of a mechanism for motions between two ends [rad or m], or of the full turn of its crank."""
    if mechanism.ranged:
        return driver_ranges_of(mechanism.linkage, *ends())

    def positions() -> tuple[float, float]:
        low, high = ends()
        q = mechanism.start + mechanism.driver_sign * np.array([0.0, low, high])
        return float(q.min()), float(q.max())

    return guided_ranges(mechanism.plan, mechanism.start, positions, mechanism.angles)


def unit_speed_kinematics(linkage: Linkage, positions: np.ndarray, driver_ranges: DriverRanges) -> Kinematics:
    """Kinematics of a linkage at driver positions, with derivatives by the driver's coordinate, which are defined in a dwell too.

    Parameters
    ----------
    linkage : Linkage
    positions : ndarray (n,) [rad or m]
        Driver positions.
    driver_ranges : DriverRanges
        Ranges of the driver.

    Returns
    -------
    Kinematics
    """
    state = MotionState(
        Angles(positions, np.zeros(positions.size, dtype=int)), at_driver(positions), np.ones(positions.size)
    )
    return solve_mechanism(mechanism_of(linkage), state, driver_ranges)


def _driver(mechanism: Mechanism, motion: MotionState) -> Derivatives:
    """Driver coordinate q = start + driver_sign y with its derivatives by the motion's angle."""
    y, start, sign = motion.displacement, mechanism.start, mechanism.driver_sign
    if mechanism.linkage.driver.kind == CRANK:
        return at_driver(y[0])
    if not start and sign == 1.0:
        return y
    return Derivatives(lambda order: sign * y[order] if order else start + sign * y[0])


def _require_assembly(
    mechanism: Mechanism, driver_ranges: DriverRanges, solution: LinkageSolution, motion: MotionState
) -> bool:
    """Raise NoSolution where links do not meet, or where a mechanism with `refuse` is at a dead centre.

    Returns whether all derivatives are certain to be finite.
    """
    is_finite = True
    for (step, _), result in zip(driver_ranges.plan.steps, solution.steps, strict=True):
        if isinstance(result, InputSolution):
            continue
        least = result.sine.min() if isinstance(result, DyadSolution) else 0.0
        is_finite = is_finite and bool(least > _LEAST_SINE)
        if least > 0.0:  # False for NaN
            continue
        first, last = (solution.poses[step.links[i]] for i in (0, -1))
        failed = ~np.isfinite(first.unit + last.unit)
        if mechanism.refuse is not None and isinstance(result, DyadSolution):
            failed = failed | ~(result.sine > 0.0)
        failed = spread(failed, motion.count)
        if mechanism.refuse is not None:
            NoAssembly.raise_where(failed, lambda failed=failed: mechanism.refuse(motion, solution, failed))  # type: ignore[misc]
            continue
        error = lambda step=step, failed=failed: _assembly_error(driver_ranges, step, motion, failed)  # noqa: E731
        NoPosition.raise_where(failed, error)
    return is_finite


_LEAST_SINE = 1e-30  # sine of the transmission angle above which three derivatives do not overflow


def _assembly_error(
    driver_ranges: DriverRanges, step: SolutionStep, motion: MotionState, failed: np.ndarray
) -> NoAssembly:
    """Error where the links of a step do not meet: the driver ranges in which they do, and the positions of the motion beyond them."""
    links = " and ".join(map(str, step.links)) if len(step.links) == 2 else ", ".join(map(str, step.links))
    joint = f" at {step.joint}" if step.kind != GROUP and is_pin(step.joint) else ""
    driver, y = driver_ranges.plan.driver, motion.displacement[0]
    scale, unit = (180.0 / np.pi, "deg") if driver.revolute else (1e3, "mm")
    ends = [float(y.min()), *(end for r in driver_ranges.ranges for end in (r.low, r.high)), float(y.max())]
    beyond = [(a * scale, b * scale) for a, b in zip(ends[::2], ends[1::2], strict=True) if a < b]
    hint = "change their lengths"
    if driver_ranges.ranges:
        ranges = [(r.low * scale, r.high * scale) for r in driver_ranges.ranges]
        hint = f"they meet with the driver within {angle_list(ranges, unit=unit)}"
        if driver_ranges.plan.linkage.driver.kind != CRANK and beyond:
            hint += f", but the motion moves it to {angle_list(beyond, unit=unit)}: reduce the rise, or change their lengths"
    kind = NoPosition if driver_ranges.plan.linkage.driver.kind == CRANK else NoAssembly
    return kind(f"links {links} do not meet{joint}", "linkage.links", hint, angle_ranges(motion.theta, failed))


def _body(pose: Pose, points: Mapping[str, complex], mechanism: Mechanism, n: int, is_finite: bool) -> Pose:
    """Pose in the global frame, with a value at each of n positions, of a link in the mechanism's frame.

    Infinite derivatives, as at a dead centre, raise no warnings.
    """
    frame, turn = mechanism.origin, mechanism.turn
    along = heading(turn) if turn else 1.0

    def origin(order: int) -> np.ndarray:
        row = pose.origin[order]
        row = row * along if turn else row
        return spread(row + frame if frame and not order else row, n)

    def angle(order: int) -> np.ndarray:
        row = pose.turn[order]
        return spread(row + turn if turn and not order else row, n)

    def spin() -> Derivatives:
        row = scaled(pose.spin, along) if turn else pose.spin
        return (
            row if row.constant else row.spread(n)
        )  # the angle of a link at rest has one value without being constant

    body = Pose(
        Derivatives(origin, pose.origin.constant),
        Derivatives(angle, pose.turn.constant),
        points,
        lambda: spread(pose.unit * along if turn else pose.unit, n),
        spin,
    )
    if is_finite:
        return body
    return Pose(
        body.origin.without_warnings(),
        body.turn.without_warnings(),
        points,
        lambda: body.unit,
        lambda: body.spin.without_warnings(),
    )


def _follower_pose(pose: Pose, at: complex, is_finite: bool) -> Pose:
    """Pose of the follower body: its origin is the reference point, its angle that of its link."""
    origin = pose.fixed_point(at)
    return Pose(
        origin if is_finite else origin.without_warnings(),
        pose.turn,
        MappingProxyType({ROLLER: 0j}),
        lambda: pose.unit,
        lambda: pose.spin,
    )


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _by_driver(mechanism: Mechanism, driver_ranges: DriverRanges, q: np.ndarray, points: Points) -> Mapping[str, Pose]:
    """Poses of all bodies at driver positions (n,), with derivatives by the driver's coordinate."""
    poses = driver_ranges.solve(at_driver(q)).poses
    return {
        name: _body(poses[link], points[link], mechanism, q.shape[-1], False) for link, name in mechanism.bodies.items()
    }


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _travel(
    mechanism: Mechanism, driver_ranges: DriverRanges, q: np.ndarray, bodies: Mapping[str, Pose], ground: str
) -> np.ndarray:
    """Direction (n,) in which the reference point moves, also defined in a dwell.

    About the pivot or along the guide of its link on the frame; without such a pair by the derivative by the driver's coordinate q.
    """
    reference, plan = mechanism.names.reference, mechanism.plan
    if reference is None:
        return np.ones(q.shape[-1], dtype=complex)
    at = plan.points[reference.link][reference.point]
    if not ground:
        path = driver_ranges.solve(at_driver(q)).poses[reference.link].fixed_point(at)[1] * heading(mechanism.turn)
        return spread(np.asarray(path / np.abs(path)), q.shape[-1])
    joint = next(j for j, name in mechanism.pair_names.items() if name == ground)
    end = joint.second if joint.second.link == reference.link else joint.first
    arm = 1j * (at - end.point) if joint.revolute else end.along
    return np.asarray(
        bodies[mechanism.bodies[reference.link]].unit * (np.complex128(arm) / abs(arm))
    )  # NaN on the pivot


def _coordinate(solution: LinkageSolution, plan: SolutionPlan, key: int | str, n: int) -> Derivatives:
    """Angle of a link, or slide of a sliding pair, in the mechanism's frame (n,)."""
    if isinstance(key, int):
        return solution.poses[key].turn.spread(n).without_warnings()
    joint = next(j for j in plan.joints if j.name == key)
    return _slide(solution, joint).spread(n).without_warnings()


def _slide(solution: LinkageSolution, joint: Joint) -> Derivatives:
    """Position [m] of the sliding link's point along the line."""
    line, point = (joint.first, joint.second) if str(joint.second.link) == joint.name else (joint.second, joint.first)
    g, along = line_of(solution.poses, line)
    return product(along, difference(solution.poses[point.link].fixed_point(point.point), g), dot)


def _residual(plan: SolutionPlan, solution: LinkageSolution) -> np.ndarray:
    """Largest gap of a pair (n,), divided by the size of the linkage."""
    worst, poses = np.zeros(1), solution.poses
    for joint in plan.joints:
        first, second = (poses[end.link].fixed_point(end.point)[0] for end in (joint.first, joint.second))
        gap = second - first
        if not joint.revolute:
            gap = cross(joint.first.along * poses[joint.first.link].unit, gap)
        worst = np.maximum(worst, np.abs(gap))
    return worst / plan.size


def _dyads(mechanism: Mechanism, solution: LinkageSolution) -> Iterator[tuple[str, DyadSolution]]:
    """Joint and solution of every dyad."""
    for (step, _), result in zip(mechanism.plan.steps, solution.steps, strict=True):
        if isinstance(result, DyadSolution):
            yield step.joint, result


def _singular(mechanism: Mechanism, solution: LinkageSolution, n: int) -> Mapping[str, np.ndarray]:
    """Measures that must not vanish: the sine of each dyad's transmission angle, and those of the mechanism."""
    measures = {mechanism.names.singular.get(joint, joint): dyad.sine for joint, dyad in _dyads(mechanism, solution)}
    if mechanism.more_singular is not None:
        measures |= mechanism.more_singular(solution)
    return {code: spread(value, n) for code, value in measures.items()}
