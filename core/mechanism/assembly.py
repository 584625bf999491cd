"""A solved linkage as a Train: every link a body, so that drawing, centres, cam and forces walk it like any other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from core.derivatives import Derivatives, difference, product
from core.design import CRANK, FRAME_LINK, Linkage, LinkageCam
from core.design.topology import GROUP, is_pin
from core.errors import NoPosition, angle_list, angle_ranges
from core.mechanism.closing import line_of
from core.mechanism.course import Course
from core.mechanism.dyads import Closed
from core.mechanism.plan import Joint, Plan
from core.mechanism.rounding import condition
from core.mechanism.solving import Solved, at_driver
from core.motion import Angles, MotionState
from core.train import FRAME, REVOLUTE, SLIDING, Dyad, Pair, Pose, Train
from core.vectors import cross, dot

ROLLER = "roller"


def body_name(link: int) -> str:
    """The name of a link among the bodies of a Train."""
    return FRAME if link == FRAME_LINK else f"link{link}"


def link_number(body: str) -> int:
    """The number of the link that is this body."""
    return FRAME_LINK if body == FRAME else int(body.removeprefix("link"))


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # rates at a dead centre are infinite
def linkage_train(linkage: Linkage, motion: MotionState, course: Course, cam: LinkageCam | None = None) -> Train:
    """Every link at the driver's positions motion.y (4, n), with three derivatives by the motion's angle.

    With a cam the roller is a body of its own, its origin the roller's centre. Raises NoPosition, naming the driver
    angles, where links do not meet.
    """
    solved = course.solve(at_driver(motion.y[0]) if linkage.driver.kind == CRANK else Derivatives.of(motion.y))
    _require(course, solved, motion)
    plan, n = course.plan, motion.theta.size
    names = pair_names(plan)
    bodies = {body_name(link): _body(plan, link, pose, n) for link, pose in sorted(solved.poses.items())}
    output, follower, ground = body_name(linkage.driver.link), body_name(linkage.driver.link), names[plan.driver]
    travel: Callable[[], np.ndarray] = partial(np.ones, n, dtype=complex)
    if cam is not None:
        follower, ground = ROLLER, _ground(plan, names, cam.link)
        bodies[ROLLER], travel = _roller(plan, bodies, course, motion, cam)
    return Train(
        motion=motion,
        bodies=bodies,
        pairs={name: _pair(joint, name) for joint, name in names.items()},
        dyads=tuple(
            Dyad(step.kind, tuple(body_name(n) for n in step.links), tuple(names[j] for j in joints))
            for step, joints in reversed(plan.steps)
        ),
        output=output,
        follower_body=follower,
        ground=ground,
        travel=travel,
        coordinates=lambda: _coordinates(linkage, plan, bodies),
        base={},
        residual=lambda: _residual(plan, bodies),
        condition=lambda: np.broadcast_to(condition(plan, solved), n),
        singular=lambda: {
            step.joint: np.broadcast_to(result.sine, n)
            for (step, _), result in zip(plan.steps, solved.steps, strict=True)
            if isinstance(result, Closed)
        },
        carrier=body_name(cam.link) if cam is not None else output,
    )


def _ground(plan: Plan, names: Mapping[Joint, str], link: int) -> str:
    """The pair that holds a link on the frame; empty where none does."""
    held = (names[j] for j in plan.joints if {j.first.link, j.second.link} == {FRAME_LINK, link})
    return next(held, "")


def unit_speed_train(linkage: Linkage, positions: np.ndarray, course: Course) -> Train:
    """The linkage with its driver at these positions (n,) [rad or m] and derivatives by the driver's own coordinate:
    what needs directions only, such as instant centres, stands in a dwell of the motion too."""
    state = MotionState(
        Angles(positions, np.zeros(positions.size, dtype=int)), at_driver(positions).all, np.ones(positions.size)
    )
    return linkage_train(linkage, state, course)


def pair_names(plan: Plan) -> Mapping[Joint, str]:
    """Every pair of the linkage with the name it has in a Train, the driver's first: its pin's, or the sliding link's
    number; further links on one pin add theirs."""
    names: dict[Joint, str] = {}
    for joint in plan.joints:
        taken = joint.name in names.values()
        names[joint] = f"{joint.name}_{body_name(joint.second.link)}" if taken else joint.name
    return MappingProxyType(names)


def _require(course: Course, solved: Solved, motion: MotionState) -> None:
    """Every link somewhere at every angle."""
    for step, _ in course.plan.steps:
        lost = ~np.isfinite(solved.poses[step.links[0]].unit + solved.poses[step.links[-1]].unit)
        if not lost.any():
            continue
        links = " and ".join(map(str, step.links)) if len(step.links) == 2 else ", ".join(map(str, step.links))
        joint = f" at {step.joint}" if step.kind != GROUP and is_pin(step.joint) else ""
        ranges = [(float(np.rad2deg(r.low)), float(np.rad2deg(r.high))) for r in course.ranges]
        hint = "change their lengths"
        if ranges and course.plan.driver.revolute:
            hint = f"they do with the driver within {angle_list(ranges)}"
        where = angle_ranges(motion.theta, np.broadcast_to(lost, motion.theta.shape))
        raise NoPosition(f"links {links} do not meet{joint}", "linkage.links", hint, where)


def _body(plan: Plan, link: int, pose: Pose, n: int) -> Pose:
    points = dict(plan.points[link])
    for joint in plan.joints:
        for held in (joint.first, joint.second):
            if held.link == link and not joint.revolute:
                points[joint.name] = held.point
    origin, turn = (rows.spread(n).quiet() for rows in (pose.origin, pose.turn))
    return Pose(origin, turn, MappingProxyType(points), lambda: np.broadcast_to(pose.unit, n))


def _pair(joint: Joint, name: str) -> Pair:
    on, body = body_name(joint.first.link), body_name(joint.second.link)
    return Pair(
        REVOLUTE if joint.revolute else SLIDING, on, body, joint.name, 0j if joint.revolute else joint.first.along
    )


def _roller(
    plan: Plan, bodies: Mapping[str, Pose], course: Course, motion: MotionState, cam: LinkageCam
) -> tuple[Pose, Callable[[], np.ndarray]]:
    """The roller's centre as a body, and where it goes when the driver moves forward (a unit vector, (n,))."""
    pose = bodies[body_name(cam.link)]
    at = plan.points[cam.link][cam.point]

    @np.errstate(divide="ignore", invalid="ignore", over="ignore")
    def travel() -> np.ndarray:
        forward = course.solve(at_driver(motion.y[0])).poses[cam.link].derivative(at, 1)
        return np.asarray(forward / np.abs(forward))

    return Pose(pose.carried(at).quiet(), pose.turn, MappingProxyType({ROLLER: 0j}), lambda: pose.unit), travel


def _coordinates(linkage: Linkage, plan: Plan, bodies: Mapping[str, Pose]) -> dict[str, np.ndarray]:
    """Angle of each moving link, slide of each that slides, (4, n)."""
    found = {name: pose.angle for name, pose in bodies.items() if name not in (FRAME, ROLLER)}
    for joint in plan.joints:
        if not joint.revolute:
            found[f"slide{joint.name}"] = _slide(bodies, joint)
    return found


def _slide(bodies: Mapping[str, Pose], joint: Joint) -> np.ndarray:
    """How far the sliding link's point has gone along the line (4, n) [m]."""
    line, own = (joint.first, joint.second) if str(joint.second.link) == joint.name else (joint.second, joint.first)
    g, along = line_of({line.link: bodies[body_name(line.link)]}, line)
    gap = difference(bodies[body_name(own.link)].carried(own.point), g)
    return product(along, gap, dot).all


def _residual(plan: Plan, bodies: Mapping[str, Pose]) -> np.ndarray:
    """How far the pairs are open at worst (n,), relative to the size of the linkage."""
    worst = np.zeros(1)
    for joint in plan.joints:
        ends = []
        for held in (joint.first, joint.second):
            pose = bodies[body_name(held.link)]
            ends.append(pose.derivative(held.point, 0))
        gap = ends[1] - ends[0]
        if not joint.revolute:
            gap = cross(joint.first.along * bodies[body_name(joint.first.link)].unit, gap)
        worst = np.maximum(worst, np.abs(gap))
    return worst / plan.size
