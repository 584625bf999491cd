"""All links of a linkage at any positions of its driver, step by step."""

from __future__ import annotations

import numpy as np

from core.design import FRAME_LINK
from core.design.topology import GROUP, INPUT
from core.frozen import frozen
from core.mechanism.change_points import Branch
from core.mechanism.dyads import DYADS, DyadSolution
from core.mechanism.groups import GroupSolution, group_solution, newton
from core.mechanism.kinematics import FRAME_POSE, Pose
from core.mechanism.loop_closure import pin_of, placed, turned_like
from core.mechanism.plan import Joint, SolutionPlan
from core.motion import at_turn, program
from core.numerics.derivatives import Derivatives, constant, product, scaled, sum_of, turning
from core.numerics.vectors import unit


@frozen(eq=False)
class InputSolution:
    """A second driving link: where it is."""

    pose: Pose


@frozen(eq=False)
class Solved:
    """Link -> pose (the frame included), NaN where it cannot be assembled; what each step found."""

    poses: dict[int, Pose]
    steps: tuple[DyadSolution | GroupSolution | InputSolution, ...]


def driver_pose(plan: SolutionPlan, q: Derivatives) -> Pose:
    """The driving link at q: its angle [rad] where it is pinned to the frame, else its slide [m]."""
    on, own = plan.driver.first, plan.driver.second
    if plan.driver.revolute:
        pin = constant(on.point)
        return placed(pin, own.point, lambda: unit(q[0]), q)
    turned = on.along / own.along
    start = on.point - own.point * turned
    origin = Derivatives(lambda order: q[order] * on.along if order else q[0] * on.along + start)
    return Pose(origin, constant(np.angle(turned)), unit=np.atleast_1d(turned))


def at_driver(values: np.ndarray) -> Derivatives:
    """Driver positions (n,) as q at unit speed: then every derivative is by the driver's coordinate."""
    return Derivatives.of((values, np.ones(1), np.zeros(1), np.zeros(1)))


def solve(plan: SolutionPlan, q: Derivatives, branch: Branch, steps: int | None = None) -> Solved:
    """The poses of all links for the driver at q (n,) [rad or m], NaN where links do not meet; with three derivatives by what
    q's are by: the motion's angle, or the driver's own coordinate.

    branch: sides beyond change points, and where Newton starts; steps: solve only so many of the plan's.
    """
    poses: dict[int, Pose] = {FRAME_LINK: FRAME_POSE}
    if not plan.inner:
        poses[plan.linkage.driver.link] = driver_pose(plan, q)
    found: list[DyadSolution | GroupSolution | InputSolution] = []
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for i, (step, joints) in enumerate(plan.steps[:steps]):
            if step.kind == GROUP:
                found.append(_grouped(plan, i, q, branch, poses))
                continue
            if step.kind == INPUT:
                poses[step.links[0]] = _driven_too(plan, step.links[0], joints[0], q, poses)
                found.append(InputSolution(poses[step.links[0]]))
                continue
            closed = DYADS[step.kind](poses, joints, branch.side(i, plan.side(step.joint), q[0]))
            poses[step.links[0]], poses[step.links[1]] = closed.poses
            for bridge in branch.bridges.get(i, ()):
                bridge.apply(q, poses)
            found.append(closed)
    return Solved(poses, tuple(found))


def _driven_too(plan: SolutionPlan, link: int, pin: Joint, q: Derivatives, poses: dict[int, Pose]) -> Pose:
    """A second driving link: its angle against another link, or its place on the line there, is ratio q + offset; its angle that of its
    own motion at q."""
    row, own = next(each for each in plan.linkage.drivers if each.link == link), plan.linkage.own_motions.get(link)
    given = scaled(q, plan.gains[link]) if own is None else at_turn(program(own), q)
    if not pin.revolute:
        return _slid(pin, given, row.offset_mm * 1e-3, poses[row.on])
    turned = sum_of(poses[row.on].turn, given)
    offset = np.deg2rad(row.offset_deg)
    angle = Derivatives(lambda order: turned[order] if order else turned[0] + offset)
    return placed(pin_of(poses, pin.first), pin.second.point, lambda: unit(angle[0]), angle)


def _slid(pair: Joint, given: Derivatives, offset: float, on: Pose) -> Pose:
    """A link on the line of a known one: given + offset [m] on from where their points lie on each other."""
    heading, turn = turned_like(on, pair.first.along / pair.second.along)
    place = Derivatives(lambda order: given[order] if order else given[0] + offset)
    at = sum_of(on.carried(pair.first.point), product(turning(pair.first.along * on.unit, on.turn), place))
    return placed(at, pair.second.point, heading, turn)


def _grouped(plan: SolutionPlan, index: int, q: Derivatives, branch: Branch, poses: dict[int, Pose]) -> GroupSolution:
    group = plan.group(index)
    x, last = newton(group, poses, q, branch.tracks[index].start(q[0]))
    x[:, ~(last < LARGEST_CORRECTION)] = np.nan
    result = group_solution(group, poses, q, x)
    poses.update(result.poses)
    return result


LARGEST_CORRECTION = 1e-8
"""A last correction of Newton larger than this, relative to the size, is no position."""
