"""What rounding leaves of each link's pose, carried from the frame outwards: the condition of a linkage."""

from __future__ import annotations

import numpy as np

from core.design import FRAME_LINK
from core.design.topology import SolutionStep
from core.frozen import frozen
from core.mechanism.dyads import DyadSolution
from core.mechanism.groups import GroupSolution
from core.mechanism.kinematics import Pose
from core.mechanism.plan import Joint, JointEnd, SolutionPlan
from core.mechanism.solving import InputSolution, Solved
from core.motion import steepest
from core.numerics.vectors import cross


@frozen(eq=False)
class ErrorBound:
    """Bounds of the errors of a link's origin [m] and angle [rad], in units of eps."""

    origin: np.ndarray
    angle: np.ndarray


def error_bounds(plan: SolutionPlan, solved: Solved) -> dict[int, ErrorBound]:
    """The bounds (n,) for every link.

    A dyad's coordinates x answer an error δ of its loop by |δ||c_other|/|c1 × c2|; the loop's own rounding is relative
    to the size of its terms.
    """
    poses = solved.poses
    zero = np.zeros(1)
    driver = plan.driver
    turned = np.ones(1) if driver.revolute else zero
    found = {FRAME_LINK: ErrorBound(zero, zero)}
    if not plan.inner:
        found[plan.linkage.driver.link] = ErrorBound(
            abs(driver.first.point) + abs(driver.second.point) * turned + 1e-300, turned
        )
    with np.errstate(divide="ignore", invalid="ignore"):
        for (step, joints), result in zip(plan.steps, solved.steps, strict=True):
            if isinstance(result, InputSolution):
                _input(plan, step.links[0], joints[0], poses, found)
            elif isinstance(result, GroupSolution):
                _group(step, joints, result, poses, found)
            else:
                _dyad(step, joints, result, poses, found)
    return found


def condition(plan: SolutionPlan, solved: Solved) -> np.ndarray:
    """(n,) the largest bound of any link, its whole length turned by its angle's error, relative to the size."""
    rows = [d.origin / plan.size + d.angle for d in error_bounds(plan, solved).values()]
    worst = np.max(np.broadcast_arrays(*rows), axis=0)
    return np.where(np.isnan(worst), np.inf, 4.0 * worst + 4.0)  # at a dead centre 0 · ∞ of a pin at its link's origin


def _at(held: JointEnd, poses: dict[int, Pose], found: dict[int, ErrorBound]) -> np.ndarray:
    """Of a point of a known link."""
    bound = found[held.link]
    return np.asarray(
        bound.origin + abs(held.point) * bound.angle + np.abs(poses[held.link].origin[0]) + abs(held.point)
    )


def _input(plan: SolutionPlan, link: int, pin: Joint, poses: dict[int, Pose], found: dict[int, ErrorBound]) -> None:
    """Its angle goes by the driver's, its place by its pin; of what slides the place on the line by the driver's."""
    on = next(each.on for each in plan.linkage.drivers if each.link == link)
    own = plan.linkage.own_motions.get(link)
    slope = abs(plan.gains[link]) if own is None else steepest(own)
    if not pin.revolute:
        angle = found[on].angle + 1.0
        reach = np.abs(poses[link].origin[0] - poses[on].origin[0])
        slid = slope * (1.0 + 2.0 * np.pi) + reach * (1.0 + angle)
        found[link] = ErrorBound(_at(pin.first, poses, found) + slid + abs(pin.second.point) * (1.0 + angle), angle)
        return
    angle = found[on].angle + 1.0 + slope * (1.0 + 2.0 * np.pi * (plan.linkage.turns or 1))
    found[link] = ErrorBound(_at(pin.first, poses, found) + abs(pin.second.point) * (1.0 + angle), angle)


def _dyad(
    step: SolutionStep,
    joints: tuple[Joint, ...],
    closed: DyadSolution,
    poses: dict[int, Pose],
    found: dict[int, ErrorBound],
) -> None:
    """A link that slides keeps its angle against what it slides on; along a known guide it goes by its coordinate."""
    a, b = step.links
    outer_a, inner, outer_b = joints
    c1, c2 = closed.columns
    det = np.abs(cross(c1, c2))
    at_a, at_b = (_at(outer.first, poses, found) for outer in (outer_a, outer_b))
    guide_a, guide_b = (found[outer.first.link].angle + 1.0 for outer in (outer_a, outer_b))
    turned = sum(guide - 1.0 for guide, outer in ((guide_a, outer_a), (guide_b, outer_b)) if not outer.revolute)
    miss = at_a + at_b + closed.reach * (2.0 + turned)
    x1, x2 = 2.0 + np.abs(c2) * miss / det, 2.0 + np.abs(c1) * miss / det
    angle_b = (x2 if inner.revolute else x1) if outer_b.revolute else guide_b
    angle_a = (x1 if inner.revolute else angle_b) if outer_a.revolute else guide_a
    placed_a = outer_a.second if outer_a.revolute else inner.first
    placed_b = inner.second if inner.revolute and not outer_b.revolute else outer_b.second
    slid_a, slid_b = (0.0 if outer.revolute else x + miss for outer, x in ((outer_a, x1), (outer_b, x2)))
    found[a] = ErrorBound(at_a + slid_a + abs(placed_a.point) * angle_a, angle_a)
    found[b] = ErrorBound(at_b + slid_b + abs(placed_b.point) * angle_b, angle_b)


def _group(
    step: SolutionStep,
    joints: tuple[Joint, ...],
    result: GroupSolution,
    poses: dict[int, Pose],
    found: dict[int, ErrorBound],
) -> None:
    """By the size of J's inverse; lengths there are in units of the size."""
    known = [_at(h, poses, found) for j in joints for h in (j.first, j.second) if h.link not in step.links]
    size = max(abs(h.point) for j in joints for h in (j.first, j.second)) or 1.0
    inverse = np.full(result.determinant.shape, np.inf)
    fine = np.isfinite(result.determinant) & (result.determinant != 0.0)
    inverse[fine] = np.abs(np.linalg.pinv(result.matrix[fine])).sum(axis=2).max(axis=1)
    miss = np.max(np.broadcast_arrays(*known), axis=0) / size + 8.0
    for link in step.links:
        found[link] = ErrorBound(size * inverse * miss + np.abs(poses[link].origin[0]), inverse * miss + 1.0)
