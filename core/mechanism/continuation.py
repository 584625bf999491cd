"""Path of a group of links by continuation from one driver position to the next, for first guesses of Newton's method between."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.mechanism.branches import Branch, GroupPath
from core.mechanism.drawn import nearest_assembly
from core.mechanism.dyads import Bodies
from core.mechanism.groups import NEAR, GroupSolution, group_solution, newton
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import LinkGroup, SolutionPlan
from core.mechanism.mechanism import at_driver, solve
from core.numerics.derivatives import Derivatives, cross

STEPS = 72  # least number over the range
FINEST = 1e-9  # of the longest step: a step this short is at a dead centre
STARTS = 120  # first guesses of an assembly
TRIES = 24  # positions of the driver at which a first assembly is searched
_TRUST = 0.05  # largest deviation of a step from its prediction: in radians, and as a fraction of the size


def joined_path(tracks: Sequence[GroupPath]) -> GroupPath:
    """One path from the paths through several ranges."""
    return GroupPath(np.concatenate([t.at for t in tracks]), np.concatenate([t.states for t in tracks]))


def follow(
    plan: SolutionPlan, index: int, branch: Branch, low: float, high: float, place: float | None = None
) -> GroupPath | None:
    """Path of a group through driver positions low ... high [rad or m], as far as its first assembly can be continued.

    The first assembly is searched at one driver position after the other and has the stated sides. For a linkage that is drawn,
    the search begins at `place`, the driver's position in the drawing. None where there is no assembly.
    """
    group = plan.group(index)
    first = None
    positions = np.linspace(low, high, TRIES + 1)[:-1]
    if place is not None:
        positions = np.append(place, positions[np.argsort(np.abs(positions - place))])
    for q in positions:
        first = _assembled(plan, index, group, branch, float(q))
        if first is not None:
            break
    if first is None:
        return None
    forward = _walk(plan, index, group, branch, float(q), first, high, (high - low) / STEPS)
    backward = _walk(plan, index, group, branch, float(q), first, low, -(high - low) / STEPS)
    nodes = [*backward[:0:-1], *forward]
    return GroupPath(np.array([at for at, _ in nodes]), np.array([state for _, state in nodes]))


def _at(q: float) -> Derivatives:
    """Driver coordinate q with unit speed."""
    return at_driver(np.array([q]))


def _known_poses(plan: SolutionPlan, index: int, branch: Branch, q: float) -> dict[int, Pose]:
    return solve(plan, _at(q), branch, index).poses


def _state(group: LinkGroup, result: GroupSolution) -> np.ndarray:
    """Coordinates of one position with three derivatives (4, 3k)."""
    rows = []
    for order in range(4):
        row: list[float] = []
        for link in group.links:
            z, angle = result.poses[link].origin[order][0] / group.size, result.poses[link].turn[order][0]
            row += [z.real, z.imag, angle]
        rows.append(row)
    return np.array(rows)


def _walk(
    plan: SolutionPlan,
    index: int,
    group: LinkGroup,
    branch: Branch,
    q: float,
    first: np.ndarray,
    end: float,
    step: float,
) -> list[tuple[float, np.ndarray]]:
    """Nodes from q towards `end`; steps shorten where the path curves, and stop before a dead centre."""
    known = _known_poses(plan, index, branch, q)
    solution = group_solution(group, known, _at(q), first[:, None])
    nodes = [(q, _state(group, solution))]
    sign = np.sign(solution.determinant[0])
    longest = step
    while q != end:
        target = end if abs(end - q) <= abs(step) * 1.001 else q + step
        move = target - q
        x, v, a, j = nodes[-1][1]
        guess = x + move * (v + move * (a / 2.0 + move * j / 6.0))
        known = _known_poses(plan, index, branch, target)
        x, last = newton(group, known, _at(target), guess[:, None], steps=6)
        following = group_solution(group, known, _at(target), x) if last[0] <= NEAR else None
        if (
            following is not None
            and np.sign(following.determinant[0]) == sign
            and np.abs(x[:, 0] - guess).max() < _TRUST
        ):
            q = target
            nodes.append((q, _state(group, following)))
            step = float(np.copysign(min(abs(longest), 1.6 * abs(step)), step))
        else:
            step = 0.5 * move
            if abs(step) < FINEST * abs(longest):
                break
    return nodes


def _assembled(plan: SolutionPlan, index: int, group: LinkGroup, branch: Branch, q: float) -> np.ndarray | None:
    """First assembly (3k,) at q, in the order of the links' angles; None where there is none."""
    known = _known_poses(plan, index, branch, q)
    repeated = {link: _repeated(pose, STARTS) for link, pose in known.items()}
    x, last = newton(group, repeated, _at(q), _starts(group, known), steps=40)
    x = x[:, last <= NEAR]
    x[2::3] = np.remainder(x[2::3] + np.pi, 2.0 * np.pi) - np.pi
    if plan.linkage.drawn is not None:
        return _nearest(plan, index, group, known, q, x)
    repeated = {link: _repeated(p, x.shape[1]) for link, p in known.items()}
    x = x[:, _has_stated_sides(plan, group, repeated, q, x)]
    return x[:, np.lexsort(np.round(x[2::3], 6)[::-1])[0]] if x.size else None


def _nearest(
    plan: SolutionPlan, index: int, group: LinkGroup, known: Bodies, q: float, x: np.ndarray
) -> np.ndarray | None:
    """The position among (3k, m) that is nearest to the drawing."""
    if not x.size:
        return None
    _, first = np.unique(np.round(x, 6), axis=1, return_index=True)
    x = x[:, np.sort(first)]
    poses = group_solution(group, {link: _repeated(p, x.shape[1]) for link, p in known.items()}, _at(q), x).poses
    return np.asarray(x[:, nearest_assembly(plan, plan.steps[index][0], poses)])


def _repeated(pose: Pose, n: int) -> Pose:
    return Pose(pose.origin.spread(n), pose.turn.spread(n), unit=np.broadcast_to(pose.unit, n))


def _starts(group: LinkGroup, known: Bodies) -> np.ndarray:
    """Evenly distributed first guesses (3k, STARTS), by the additive recurrence of Roberts (2018)."""
    k = 3 * len(group.links)
    ratio = 2.0
    for _ in range(40):
        ratio = (1.0 + ratio) ** (1.0 / (k + 1))
    share = np.mod(0.5 + np.outer(ratio ** -np.arange(1.0, k + 1), np.arange(1.0, STARTS + 1)), 1.0)
    centre = np.mean([pose.origin[0][0] for pose in known.values()]) / group.size
    x = 4.0 * (share - 0.5)
    x[0::3] += centre.real
    x[1::3] += centre.imag
    x[2::3] *= 0.5 * np.pi
    return x


def _has_stated_sides(plan: SolutionPlan, group: LinkGroup, known: Bodies, q: float, x: np.ndarray) -> np.ndarray:
    """Mask (m,) of the positions with the stated sides.

    A pin is left (+1) or right (-1) of the line from the next pin of its lower-numbered link to that of its higher-numbered link.
    """
    mask = np.ones(x.shape[1], dtype=bool)
    if not x.size:
        return mask
    poses = group_solution(group, known, _at(q), x).poses
    for name, side in plan.sides.items():
        links = [n for n in group.links if name in plan.points[n]]
        if len(links) < 2:
            continue
        pin = poses[links[0]].fixed_point(plan.points[links[0]][name])[0]
        next_pins = [_next_pin(plan, group, n, name) for n in links[:2]]
        ends = [({**known, **poses})[n].fixed_point(at)[0] for n, at in next_pins]
        mask &= np.sign(cross(ends[1] - ends[0], pin - ends[0])) == side
    return mask


def _next_pin(plan: SolutionPlan, group: LinkGroup, link: int, name: str) -> tuple[int, complex]:
    """First pin but `name` of a link, or of a link joined to it by a sliding pair, as link and point; else the link's origin."""
    sliding = [
        {j.first.link, j.second.link} - {link}
        for j in group.joints
        if not j.revolute and link in (j.first.link, j.second.link)
    ]
    for number in (link, *(n for numbers in sliding for n in numbers)):
        for pin, at in plan.points[number].items():
            if pin != name and any(pin in points for n, points in plan.points.items() if n != number):
                return number, at
    return link, 0j
