"""All links of a linkage at any positions of its driver, step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.design import FRAME_LINK
from core.design.topology import GROUP
from core.mechanism.dyads import DYADS, Closed
from core.mechanism.groups import Group, Settled, newton, settled
from core.mechanism.plan import Plan
from core.mechanism.way import Bridge, Way
from core.train import Pose
from core.vectors import turning, unit


@dataclass(frozen=True, eq=False)
class Solved:
    """Link -> pose (the frame included), NaN where it cannot be assembled; what each step found."""

    poses: dict[int, Pose]
    steps: tuple[Closed | Settled, ...]


def frame_pose() -> Pose:
    """The link that stands still."""
    return Pose(np.zeros((4, 1), dtype=complex), np.zeros((4, 1)), unit=np.ones(1, dtype=complex))


def driver_pose(plan: Plan, q: np.ndarray) -> Pose:
    """The driving link at q (4, n): its angle [rad] where it is pinned to the frame, else its slide [m]."""
    on, own = plan.driver.first, plan.driver.second
    if plan.driver.revolute:
        heading = unit(q[0])
        z = turning(-own.point * heading, q) if own.point else np.zeros(q.shape, dtype=complex)
        z[0] += on.point
        return Pose(z, q, unit=heading)
    n = q.shape[1]
    turned = on.along / own.along
    angle = np.zeros((4, n))
    angle[0] = np.angle(turned)
    z = q * on.along
    z[0] += on.point - own.point * turned
    return Pose(z, angle, unit=np.full(n, turned))


def at_driver(values: np.ndarray) -> np.ndarray:
    """Driver positions (n,) as q (4, n) at unit speed: then every derivative is by the driver's coordinate."""
    q = np.zeros((4, values.size))
    q[0], q[1] = values, 1.0
    return q


def solve(plan: Plan, q: np.ndarray, way: Way, steps: int | None = None) -> Solved:
    """Poses with three derivatives for the driver at q (4, n), derivatives by whatever q's are by.

    way: sides beyond change points, and where Newton starts; steps: only so many of the plan's.
    """
    poses: dict[int, Pose] = {FRAME_LINK: frame_pose(), plan.linkage.driver.link: driver_pose(plan, q)}
    found: list[Closed | Settled] = []
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for i, (step, joints) in enumerate(plan.steps[:steps]):
            if step.kind == GROUP:
                found.append(_grouped(plan, i, q, way, poses))
                continue
            closed = DYADS[step.kind](poses, joints, way.side(i, plan.side(step.joint), q[0]))
            poses[step.links[0]], poses[step.links[1]] = closed.poses
            _bridged(step.links, way.bridges.get(i, ()), q, poses)
            found.append(closed)
    return Solved(poses, tuple(found))


def _bridged(links: tuple[int, ...], bridges: tuple[Bridge, ...], q: np.ndarray, poses: dict[int, Pose]) -> None:
    """Lay the bridges that the driver's positions fall on."""
    laid = [(bridge, there) for bridge in bridges if (there := bridge.within(q[0])).any()]
    if laid:
        for link in links:
            pose = poses[link]
            poses[link] = Pose(pose.z.copy(), pose.angle.copy(), unit=np.array(pose.unit))
    for bridge, there in laid:
        bridge.lay(q, there, poses)


def _grouped(plan: Plan, index: int, q: np.ndarray, way: Way, poses: dict[int, Pose]) -> Settled:
    step, joints = plan.steps[index]
    group = Group(step.links, joints, plan.size)
    x, last = newton(group, poses, way.tracks[index].start(q[0]))
    x[:, ~(last < LOST)] = np.nan
    result = settled(group, poses, x)
    poses.update(result.poses)
    return result


LOST = 1e-8
"""A last correction of Newton larger than this, relative to the size, is no position."""
