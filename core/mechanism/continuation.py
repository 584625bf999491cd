"""A group of links followed from one position of the driver to the next: where Newton starts anywhere between."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.mechanism.branches import Branch, GroupPath
from core.mechanism.drawn import nearest
from core.mechanism.dyads import Bodies
from core.mechanism.groups import NEAR, GroupSolution, group_solution, newton
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import LinkGroup, SolutionPlan
from core.mechanism.mechanism import at_driver, solve
from core.numerics.derivatives import Derivatives, cross

STEPS = 72  # over the whole range, at least
FINEST = 1e-9  # of the range: a step this short stands before a dead centre
STARTS = 120
TRIES = 24  # positions of the driver at which a first assembly is searched
_TRUST = 0.05  # of what a step may miss its prediction by: radians, and parts of the size


def merged(tracks: Sequence[GroupPath]) -> GroupPath:
    """Tracks of several ranges as one."""
    return GroupPath(np.concatenate([t.at for t in tracks]), np.concatenate([t.states for t in tracks]))


def follow(
    plan: SolutionPlan, index: int, branch: Branch, low: float, high: float, place: float | None = None
) -> GroupPath | None:
    """The track of a group through low ... high, as far as it goes from its first assembly; None where there is none.

    The first assembly is searched at positions of the driver in turn; sides that are stated must be kept there. Where it is
    drawn, with the driver at ``place``, that is its first position, or the nearest at which it can be assembled.
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
    """The driver at one place, at unit speed."""
    return at_driver(np.array([q]))


def _known_poses(plan: SolutionPlan, index: int, branch: Branch, q: float) -> dict[int, Pose]:
    return solve(plan, _at(q), branch, index).poses


def _state(group: LinkGroup, result: GroupSolution) -> np.ndarray:
    """Coordinates with three derivatives (4, 3k) of one position."""
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
    """Nodes from q towards ``end``; steps shorten where the path bends, and end before a dead centre."""
    known = _known_poses(plan, index, branch, q)
    here = group_solution(group, known, _at(q), first[:, None])
    nodes = [(q, _state(group, here))]
    sign = np.sign(here.determinant[0])
    longest = step
    while q != end:
        target = end if abs(end - q) <= abs(step) * 1.001 else q + step
        move = target - q
        x, v, a, j = nodes[-1][1]
        guess = x + move * (v + move * (a / 2.0 + move * j / 6.0))
        known = _known_poses(plan, index, branch, target)
        found, last = newton(group, known, _at(target), guess[:, None], steps=6)
        there = group_solution(group, known, _at(target), found) if last[0] <= NEAR else None
        kept = (
            there is not None and np.sign(there.determinant[0]) == sign and np.abs(found[:, 0] - guess).max() < _TRUST
        )
        if there is not None and kept:
            q = target
            nodes.append((q, _state(group, there)))
            step = float(np.copysign(min(abs(longest), 1.6 * abs(step)), step))
        else:
            step = 0.5 * move
            if abs(step) < FINEST * abs(longest):
                break
    return nodes


def _assembled(plan: SolutionPlan, index: int, group: LinkGroup, branch: Branch, q: float) -> np.ndarray | None:
    """The first of all assemblies found at q (3k,), in the order of the links' angles; None where there is none."""
    known = _known_poses(plan, index, branch, q)
    many = {link: _repeated(pose, STARTS) for link, pose in known.items()}
    x, last = newton(group, many, _at(q), _spread(group, known), steps=40)
    good = x[:, last <= NEAR]
    good[2::3] = np.remainder(good[2::3] + np.pi, 2.0 * np.pi) - np.pi
    if plan.linkage.drawn is not None:
        return _nearest(plan, index, group, known, q, good)
    many = {link: _repeated(p, good.shape[1]) for link, p in known.items()}
    good = good[:, _kept_sides(plan, group, many, q, good)]
    return good[:, np.lexsort(np.round(good[2::3], 6)[::-1])[0]] if good.size else None


def _nearest(
    plan: SolutionPlan, index: int, group: LinkGroup, known: Bodies, q: float, x: np.ndarray
) -> np.ndarray | None:
    """Of the positions (3k, m) the one nearest to what is drawn."""
    if not x.size:
        return None
    _, first = np.unique(np.round(x, 6), axis=1, return_index=True)
    x = x[:, np.sort(first)]
    poses = group_solution(group, {link: _repeated(p, x.shape[1]) for link, p in known.items()}, _at(q), x).poses
    return np.asarray(x[:, nearest(plan, plan.steps[index][0], poses)])


def _repeated(pose: Pose, n: int) -> Pose:
    return Pose(pose.origin.spread(n), pose.turn.spread(n), unit=np.broadcast_to(pose.unit, n))


def _spread(group: LinkGroup, known: Bodies) -> np.ndarray:
    """Starts (3k, STARTS) spread evenly, the same every time (additive recurrence of Roberts)."""
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


def _kept_sides(plan: SolutionPlan, group: LinkGroup, known: Bodies, q: float, x: np.ndarray) -> np.ndarray:
    """Which positions have the stated sides: a pin left (+1) or right of the line from the next pin of its
    lower-numbered link to that of the higher."""
    kept = np.ones(x.shape[1], dtype=bool)
    if not x.size:
        return kept
    poses = group_solution(group, known, _at(q), x).poses
    for name, side in plan.sides.items():
        links = [n for n in group.links if name in plan.points[n]]
        if len(links) < 2:
            continue
        pin = poses[links[0]].carried(plan.points[links[0]][name])[0]
        held = [_other_end(plan, group, n, name) for n in links[:2]]
        ends = [({**known, **poses})[n].carried(at)[0] for n, at in held]
        kept &= np.sign(cross(ends[1] - ends[0], pin - ends[0])) == side
    return kept


def _other_end(plan: SolutionPlan, group: LinkGroup, link: int, name: str) -> tuple[int, complex]:
    """The first other pin of a link, or of the link that it slides on or that slides on it; its own origin where there is none."""
    slid = [
        {j.first.link, j.second.link} - {link}
        for j in group.joints
        if not j.revolute and link in (j.first.link, j.second.link)
    ]
    for each in (link, *(n for ends in slid for n in ends)):
        for other, at in plan.points[each].items():
            if other != name and any(other in places for n, places in plan.points.items() if n != each):
                return each, at
    return link, 0j
