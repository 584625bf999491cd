"""Ranges of a linkage's driver between dead centres, its change points, and the angles of its links without jumps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from math import pi
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import FRAME_LINK, Linkage, Motion
from core.design.linkage import MOST_TURNS
from core.design.topology import GROUP, INPUT
from core.frozen import frozen
from core.mechanism.branches import HALF, Branch, bridge
from core.mechanism.dyads import DyadSolution
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import SolutionPlan, plan_of
from core.mechanism.mechanism import LinkageSolution, at_driver, solve
from core.numerics.derivatives import Derivatives
from core.numerics.lazy import once
from core.numerics.ranges import nonnegative_ranges, zero_minima

# -- results ----------------------------------------------------------------------------------------------------


TURN = 2.0 * pi
SAMPLES = 721
_LEAST = 33
_BEYOND = 3  # samples beyond both ends of a full turn, so that a zero at an end is between samples


@frozen
class DriverRange:
    """Driver positions low ... high [rad or m] between two dead centres, or between the requested ends.

    Attributes
    ----------
    low, high : float
        Ends [rad or m].
    low_joint, high_joint : str
        Joint of the dyad, or the links of the group, that locks at the end; empty where none locks.
    """

    low: float
    high: float
    low_joint: str = ""
    high_joint: str = ""

    @property
    def is_free(self) -> bool:
        """Whether the range ends at no dead centre."""
        return not self.low_joint and not self.high_joint


@frozen(eq=False)
class UnwrappedAngle:
    """Angle of a link without jumps of 2π.

    Attributes
    ----------
    at : ndarray (m,) [rad or m]
        Samples of the driver position.
    angle : ndarray (m,) [rad]
        Continuous angle there.
    middle : float or None
        Middle [rad] of a swing of less than a turn.
    rotates : bool
        The link makes full turns while the driver makes one.
    """

    at: np.ndarray
    angle: np.ndarray
    middle: float | None
    rotates: bool

    def unwrapped(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        """The continuous angle with its derivatives, from an angle -π ... π at q (n,) [rad]."""
        return Derivatives(lambda order: angle[order] if order else self.unwrap(q[0], angle[0]))

    def unwrap(self, q: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """Add the missing whole turns to angles.

        Parameters
        ----------
        q : ndarray (n,) [rad or m]
            Driver positions.
        angle : ndarray (n,) [rad]
            Angles there, -π ... π.

        Returns
        -------
        ndarray (n,) [rad]
        """
        if self.middle is not None:
            over = angle - self.middle
            if (np.abs(over) <= pi).all():
                return angle
            return angle - TURN * np.rint(over / TURN)
        return angle + TURN * np.rint((np.interp(q, self.at, self.angle) - angle) / TURN)


@frozen(eq=False)
class _LazyAngle:
    """An UnwrappedAngle that is calculated when it is first read."""

    angles: Callable[[], Mapping[int, UnwrappedAngle]]
    link: int

    @property
    def rotates(self) -> bool:
        return self.angles()[self.link].rotates

    @property
    def angle(self) -> np.ndarray:
        return self.angles()[self.link].angle

    def unwrapped(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        return Derivatives(lambda order: angle[order] if order else self.angles()[self.link].unwrap(q[0], angle[0]))


@frozen
class ChangePoint:
    """Driver position [rad or m] at which a dyad is in line, its two assemblies coincide, and it moves from one into the other."""

    at: float
    joint: str


@frozen(eq=False)
class DriverRanges:
    """Ranges and change points of a linkage's driver, in rising order.

    Attributes
    ----------
    plan : SolutionPlan
        None for a full turn without a linkage.
    ranges : tuple of DriverRange
        Divided where the driver's turn begins; for a linkage that is drawn only the range of the drawing.
    changes : tuple of ChangePoint
    branch : Branch
    angles : mapping of int to UnwrappedAngle
        By link.
    is_periodic : bool
        Every link returns to its position after the cycle.
    is_swinging : bool
        A crank that oscillates in its range.
    turns : int
        Turns of the driver in a cycle.
    others : tuple of DriverRange
        Ranges of a linkage that is drawn, beyond that of the drawing.
    """

    plan: SolutionPlan
    ranges: tuple[DriverRange, ...]
    changes: tuple[ChangePoint, ...]
    branch: Branch
    angles: Mapping[int, _LazyAngle]
    is_periodic: bool = True
    is_swinging: bool = False
    turns: int = 1
    others: tuple[DriverRange, ...] = ()

    @property
    def motions(self) -> tuple[Motion, ...]:
        """Separate motions of further drivers."""
        return tuple(self.plan.linkage.own_motions.values()) if self.plan else ()

    def solve(self, q: Derivatives) -> LinkageSolution:
        """Solution for the driver at q (n,) with continuous angles; NaN outside the ranges."""
        solution = solve(self.plan, q, self.branch)
        for link, angle in self.angles.items():
            pose = solution.poses[link]
            solution.poses[link] = pose.with_turn(angle.unwrapped(q, pose.turn))
        return solution


# -- search -----------------------------------------------------------------------------------------------------


@lru_cache(maxsize=64)
def driver_ranges_of(linkage: Linkage, low: float = 0.0, high: float = TURN) -> DriverRanges:
    """Ranges and change points for driver positions low ... high [rad or m]; cached.

    For a linkage that is drawn the position of the drawing is included; a crank's range may extend through 0. The cycle of a crank
    is the number of turns after which the links driven by a ratio return, or twice that number where the other links need it.

    Raises
    ------
    NoPosition
        Two assemblies are equally near to the drawing.
    """
    plan = plan_of(linkage)
    if high - low != TURN:
        if linkage.drawn is None:
            return _ranges(plan, low, high, False)
        from core.mechanism.drawn import drawn_position  # imported here to save start-up time

        drawn = drawn_position(linkage.drawn)
        return _range_around(_ranges(plan, min(low, drawn), max(high, drawn), False, drawn), drawn)
    turns = linkage.turns
    cycle = _cycle(plan, low, turns or 1)
    if cycle.is_periodic or turns is None or 2 * turns > MOST_TURNS:
        return cycle
    double = _cycle(plan, low, 2 * turns)
    return double if double.is_periodic else cycle


def _cycle(plan: SolutionPlan, low: float, turns: int) -> DriverRanges:
    """Ranges and change points of a crank through a number of turns from `low` [rad] on."""
    turn = TURN * turns
    if plan.linkage.drawn is None:
        return replace(_ranges(plan, low, low + turn, True), turns=turns)
    from core.mechanism.drawn import drawn_position  # imported here to save start-up time

    drawn = drawn_position(plan.linkage.drawn)
    for half in _HALVES if plan.linkage.turns is None else ():  # without a period, only the range of the drawing counts
        result = _range_around(_ranges(plan, drawn - half, drawn + half, False, drawn), drawn)
        if result.ranges and result.ranges[0].low_joint and result.ranges[0].high_joint:
            return replace(result, is_swinging=True)
    result = _ranges(plan, low, low + turn, True, drawn % turn)
    if not result.ranges or (len(result.ranges) == 1 and result.ranges[0].is_free):
        return replace(result, turns=turns)
    locked = [r.high for r in result.ranges if r.high_joint]  # the turn is divided in the gap behind one of them
    begin = locked[0] if locked else result.ranges[0].low
    beyond = min((r.low for r in result.ranges if r.low > begin), default=begin + turn)
    begin += min(0.5 * (beyond - begin), _OFFSET) if locked else -_OFFSET
    begin += turn * np.floor((drawn - begin) / turn)
    result = _ranges(plan, begin, begin + turn, False, drawn)
    return replace(_range_around(result, drawn), is_swinging=True) if result.ranges else result


def _range_around(result: DriverRanges, position: float) -> DriverRanges:
    """The driver ranges with only the range around a driver position, or the nearest to it."""
    if not result.ranges:
        return result
    nearest = _nearest(result.ranges, position)
    changes = tuple(c for c in result.changes if nearest.low <= c.at <= nearest.high)
    others = tuple(r for r in result.ranges if r is not nearest)
    return replace(result, ranges=(nearest,), changes=changes, others=others)


def _nearest(ranges: Sequence[DriverRange], position: float) -> DriverRange:
    """The range around a driver position, or the nearest to it."""
    return min(ranges, key=lambda r: max(r.low - position, position - r.high, 0.0))


def _ranges(plan: SolutionPlan, low: float, high: float, full_turn: bool, drawn: float | None = None) -> DriverRanges:
    """Ranges and change points for driver positions low ... high.

    full_turn: they are a crank's turn; drawn: driver position of the drawing.
    """
    branch = Branch(low)
    ranges, changes = [DriverRange(low, high)], []
    sampled = _Samples(plan, branch, high - low, full_turn, drawn is not None)
    for i, (step, _) in enumerate(plan.steps):
        if step.kind == INPUT:
            continue
        if step.kind == GROUP:
            ranges = _group_ranges(plan, i, branch, ranges, drawn)
        else:
            if step.kind in SIDED and drawn is not None:
                drawn = _assembled_near(plan, i, branch, ranges, drawn, sampled)
                if drawn is None:
                    ranges = []
                    break
                from core.mechanism.drawn import choose_side  # imported here to save start-up time

                choose_side(plan, i, branch, drawn)
            if step.kind in SIDED:
                changes += _add_change_points(plan, i, branch, ranges, sampled)
            ranges = [
                _part(r, a, b, step.joint)
                for r in ranges
                for a, b in nonnegative_ranges(_gap(plan, i, branch), *sampled.gaps(i, r))
                if b - a > _SHORTEST * (high - low)
            ]
        if not ranges:
            break
    if not ranges:
        return DriverRanges(plan, (), (), branch, MappingProxyType({}))
    angles, is_periodic = _link_angles(plan, ranges, branch, sampled)
    inside = tuple(sorted((c for c in changes if low <= c.at < high), key=lambda c: c.at))
    return DriverRanges(plan, tuple(ranges), inside, branch, MappingProxyType(angles), is_periodic)


def guided_ranges(
    plan: SolutionPlan, start: float, ends: Callable[[], tuple[float, float]], angles: Mapping[int, float]
) -> DriverRanges:
    """Driver ranges of a mechanism in a single assembly, without a search for ranges and change points.

    The angle of every link is continuous through the driver positions between `ends` [rad or m], from its value `angles` [rad]
    at `start`.
    """
    branch = Branch()

    @once
    def unwrapped() -> dict[int, UnwrappedAngle]:  # late: forces and the cam profile need no angles
        at = np.linspace(*ends(), PATH)
        poses = solve(plan, at_driver(at), branch).poses
        result = {}
        for link, first in angles.items():
            angle = np.unwrap(_without_nan(np.array(np.broadcast_to(poses[link].turn[0], at.shape))))
            angle += TURN * np.rint((first - np.interp(start, at, angle)) / TURN)
            result[link] = _unwrapped_angle(at, angle, rotates=False)
        return result

    return DriverRanges(plan, (), (), branch, MappingProxyType({link: _LazyAngle(unwrapped, link) for link in angles}))


@lru_cache(maxsize=4)
def followed_ranges(linkage: Linkage, last: DriverRanges) -> DriverRanges | None:
    """Driver ranges of a linkage that differs a little from another one, without a search: with the branch of the other.

    Its driver is taken to pass the same range, to the moved dead centres where the other has some. Where another dyad locks, the
    solution has no position, and the ranges must be searched.

    Parameters
    ----------
    linkage : Linkage
    last : DriverRanges
        Ranges of the other linkage.

    Returns
    -------
    DriverRanges or None
        None where the other linkage has a group, where the order of solution differs, and where a change point or a dead centre is
        not found near that of the other linkage.
    """
    plan = plan_of(linkage)
    same_order = [step for step, _ in plan.steps] == [step for step, _ in last.plan.steps]
    same_driver = (linkage.driver, linkage.turns) == (last.plan.linkage.driver, last.plan.linkage.turns)
    has_group = any(step.kind == GROUP for step, _ in plan.steps)
    if not (same_order and same_driver and not has_group and linkage.branch == last.plan.linkage.branch):
        return None
    branch, points = Branch(last.branch.start, last.branch.chosen), list[ChangePoint]()
    for index, near in last.branch.changes.items():
        changes = _moved_changes(plan, index, branch, near)
        if changes.size != near.size:
            return None
        points += _with_bridges(plan, index, branch, changes.tolist())
    points.sort(key=lambda point: point.at)
    ranges = _moved_ranges(plan, branch, last.ranges)
    if not ranges:
        return None
    total = ranges[-1].high - ranges[0].low
    parts = [np.linspace(r.low, r.high, _sample_count(r.high - r.low, total)) for r in ranges]
    is_full = len(ranges) == 1 and ranges[0].is_free and total == TURN * last.turns
    angles = MappingProxyType(_lazy_angles(plan, branch, tuple(last.angles), parts, is_full))
    return replace(last, plan=plan, ranges=ranges, changes=tuple(points), branch=branch, angles=angles)


def _moved_ranges(plan: SolutionPlan, branch: Branch, near: Sequence[DriverRange]) -> tuple[DriverRange, ...]:
    """Ranges between the dead centres near those of another linkage, at which the same dyads lock; () where one is not found."""
    joints = {joint for r in near for joint in (r.low_joint, r.high_joint)} - {""}
    locking = [i for i, (step, _) in enumerate(plan.steps) if step.joint in joints]
    if not locking:
        return () if joints else tuple(near)
    around = (1.0 if plan.driver.revolute else plan.size) * _AROUND
    ends = [end for r in near for end in ((r.low, r.low_joint), (r.high, r.high_joint))]
    at = np.concatenate([end + around if joint else np.array([end]) for end, joint in ends])
    if not (np.diff(at) > 0.0).all():
        return ()

    def gap(q: np.ndarray) -> np.ndarray:
        solution = solve(plan, at_driver(q), branch, locking[-1] + 1)
        return np.min([_solution_gap(solution, index, branch, q) for index in locking], axis=0)

    ranges = nonnegative_ranges(gap, at, gap(at))
    if len(ranges) != len(near):
        return ()
    offsets, reach = np.ravel(ranges) - [end for end, _ in ends], [around[-1] if joint else 0.0 for _, joint in ends]
    if not ((np.abs(offsets) < reach) | (offsets == 0.0)).all():
        return ()
    return tuple(replace(r, low=low, high=high) for r, (low, high) in zip(near, ranges, strict=True))


def _moved_changes(plan: SolutionPlan, index: int, branch: Branch, near: np.ndarray) -> np.ndarray:
    """Change points (k,) of a dyad near others (m,); k and m differ where one is not found or two are too near each other."""
    scale = 1.0 if plan.driver.revolute else plan.size
    at = (near[:, None] + scale * _AROUND).ravel()
    if not (np.diff(at) > 0.0).all():
        return near[:0]
    gap = _gap(plan, index, branch)
    return zero_minima(lambda q: np.abs(gap(q)), at, np.abs(gap(at)), _TOUCH * plan.size)


_AROUND = np.linspace(
    -0.2, 0.2, 33
)  # a dragged joint moves a change point less than this, in units of the driver's scale
PATH = 65  # positions from the base position on; between two of them no link turns by more than half a turn
_HALVES = (0.5 * TURN, 4.0 * TURN)  # search on both sides for the range of a swing without a period
_SHORTEST = 1e-6  # of the requested positions: the ends of a shorter range depend on rounding
SIDED = ("RRR", "RRP", "RPR")
_INSIDE = 1e-2  # of a range: at this distance from its ends the two assemblies of a dyad are distinct
_SAME = 1e-6  # [rad or m] a change point this near to an end of the range is at the end; its own error is about 1e-8
_OFFSET = 2e-6  # distance from a change point at which the dyad is open on both sides
_TRIES = 7  # to find the width of a bridge
_TOUCH = 1e-12  # of the size: a smaller minimum of the gap is a change point


def _sample_count(length: float, total: float) -> int:
    return max(_LEAST, int(SAMPLES * max(1.0, total / TURN) * length / max(total, 1e-300)))


def _gap(plan: SolutionPlan, index: int, branch: Branch) -> Callable[[np.ndarray], np.ndarray]:
    """Function for the gap of a dyad at driver positions (n,); see `DyadSolution.gap`."""
    return lambda q: _solution_gap(solve(plan, at_driver(q), branch, index + 1), index, branch, q)


def _solution_gap(solution: LinkageSolution, index: int, branch: Branch, q: np.ndarray) -> np.ndarray:
    """Gap of a dyad in a solution at q (n,); infinite on the bridge over a change point, where the dyad never locks."""
    dyad = solution.steps[index]
    assert isinstance(dyad, DyadSolution)
    return _off_bridges(np.broadcast_to(dyad.gap, q.shape), index, branch, q)


def _off_bridges(value: np.ndarray, index: int, branch: Branch, q: np.ndarray) -> np.ndarray:
    for bridge_ in branch.bridges.get(index, ()):
        value = np.where(bridge_.covers(q), np.inf, value)
    return value


class _Samples:
    """Solutions at samples of driver ranges, which are reused for further steps while neither range nor branch changes.

    full_turn: the range is a crank's turn, which is also sampled a little beyond both ends.
    """

    def __init__(self, plan: SolutionPlan, branch: Branch, length: float, full_turn: bool, drawn: bool) -> None:
        self._plan, self._branch, self._length, self._drawn = plan, branch, length, drawn
        self.full_turn = full_turn
        self._solved: dict[Any, tuple[np.ndarray, LinkageSolution]] = {}
        self._gaps: dict[Any, tuple[np.ndarray, np.ndarray]] = {}

    def at(self, r: DriverRange) -> np.ndarray:
        """Positions (n,) from end to end."""
        return np.linspace(r.low, r.high, _sample_count(r.high - r.low, self._length))

    def beyond(self, r: DriverRange) -> int:
        """Number of further positions beyond each end."""
        return _BEYOND if self.full_turn and r.is_free else 0

    def solution(self, index: int, r: DriverRange) -> tuple[np.ndarray, LinkageSolution]:
        """Positions (n,), including those beyond the ends, and the solution there up to this step at least."""
        branch, steps = self._branch, self._plan.steps
        known = len(branch.changes), len(branch.bridges), len(branch.tracks), len(branch.chosen)
        key = (r.low, r.high, *known)
        if key not in self._solved or len(self._solved[key][1].steps) <= index:
            q, more = self.at(r), self.beyond(r)
            if more:
                steps_beyond = (q[1] - q[0]) * np.arange(1.0, more + 1.0)
                q = np.concatenate((q[0] - steps_beyond[::-1], q, q[-1] + steps_beyond))
            self._solved[key] = q, solve(self._plan, at_driver(q), branch, self._last(index, len(steps)))
        return self._solved[key]

    def _last(self, index: int, count: int) -> int:
        """Number of steps that can be solved: up to the next one whose assembly is unknown."""
        for i in range(index + 1, count):
            kind = self._plan.steps[i][0].kind
            if kind == GROUP and i not in self._branch.tracks:
                return i
            if self._drawn and kind in SIDED and i not in self._branch.chosen:
                return i
        return count

    def gaps(self, index: int, r: DriverRange, beyond: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Positions (n,) from end to end, or beyond, and the gap of a dyad there; its own change points do not change the gap."""
        key = (index, r.low, r.high)
        if key not in self._gaps:
            q, solution = self.solution(index, r)
            self._gaps[key] = q, _solution_gap(solution, index, self._branch, q)
        q, value = self._gaps[key]
        value, inside = _off_bridges(value, index, self._branch, q), slice(self.beyond(r), q.size - self.beyond(r))
        return (q, value) if beyond else (q[inside], value[inside])


def _add_change_points(
    plan: SolutionPlan, index: int, branch: Branch, ranges: list[DriverRange], sampled: _Samples
) -> list[ChangePoint]:
    """Change points of a dyad, which are added to the branch with their bridges."""
    gap = _gap(plan, index, branch)
    changes: list[float] = []
    scale = 1.0 if plan.driver.revolute else plan.size
    for r in ranges:
        at, value = sampled.gaps(index, r, beyond=True)
        is_locked = value < -_TOUCH * plan.size  # next to such samples the gap changes its sign
        distance = np.where(is_locked, np.inf, np.abs(value))
        minima = zero_minima(lambda q: np.abs(gap(q)), at, distance, _TOUCH * plan.size)
        if not minima.size:
            continue
        both_sides = gap(np.concatenate((minima - scale * _OFFSET, minima + scale * _OFFSET))).reshape(2, -1)
        for change in minima[(both_sides > 0.0).all(axis=0)].tolist():  # a zero without a change of sign
            changes.append(next((end for end in (r.low, r.high) if abs(change - end) < _SAME), change))
    return _with_bridges(plan, index, branch, changes) if changes else []


def _with_bridges(plan: SolutionPlan, index: int, branch: Branch, changes: list[float]) -> list[ChangePoint]:
    """Add change points of a dyad to the branch, with their bridges."""
    step, _ = plan.steps[index]
    scale = 1.0 if plan.driver.revolute else plan.size
    branch.changes[index] = np.array(sorted(changes))
    at, half, links = np.array(changes), np.full(len(changes), scale * HALF), (step.links[0], step.links[1])
    shorter = np.ones(at.size)
    for _ in range(_TRIES):
        half *= shorter
        q = np.stack((at - half, at + half), axis=1).ravel()
        ends = _end_states(solve(plan, at_driver(q), branch, index + 1), links, q.size)
        shorter = np.where(np.isfinite(ends).all(axis=(1, 2, 3)), 1.0, 0.25)  # a dead centre is near
        if (shorter == 1.0).all():
            break
    rows = zip(at.tolist(), half.tolist(), ends, strict=True)
    branch.bridges[index] = tuple(bridge(change, width, links, states) for change, width, states in rows)
    return [ChangePoint(change, step.joint) for change in changes]


def _end_states(solution: LinkageSolution, links: tuple[int, ...], n: int) -> np.ndarray:
    """States (m, 2, 4, 6): x, y, angle of both links with three derivatives at both ends of m bridges."""
    columns = []
    for link in links:
        pose = solution.poses[link]
        angle = np.array(pose.turn.spread(n).all)
        angle[0] = np.unwrap(angle[0].reshape(-1, 2)).ravel()
        z = pose.origin.spread(n).all
        columns += [z.real, z.imag, angle]
    return np.array(columns).transpose(2, 1, 0).reshape(-1, 2, 4, 6)


def _assembled_near(
    plan: SolutionPlan, index: int, branch: Branch, ranges: list[DriverRange], drawn: float, sampled: _Samples
) -> float | None:
    """The drawn driver position where the dyad can be assembled there, else the nearest one inside a range; None without a range."""
    gap = _gap(plan, index, branch)
    if any(r.low <= drawn <= r.high for r in ranges) and gap(np.array([drawn]))[0] > 0.0:
        return drawn
    length = ranges[-1].high - ranges[0].low
    inside = [
        (a + _INSIDE * (b - a), b - _INSIDE * (b - a))
        for r in ranges
        for a, b in nonnegative_ranges(gap, *sampled.gaps(index, r))
        if b - a > _SHORTEST * length
    ]
    return min((min(max(drawn, a), b) for a, b in inside), key=lambda at: abs(at - drawn), default=None)


def _group_ranges(
    plan: SolutionPlan, index: int, branch: Branch, ranges: list[DriverRange], drawn: float | None = None
) -> list[DriverRange]:
    """The parts of the ranges, or of the one around the drawn position, through which a group can be continued."""
    from core.mechanism.continuation import follow, joined_path  # imported here to save start-up time

    step, _ = plan.steps[index]
    parts = []
    if drawn is not None:
        ranges = [_nearest(ranges, drawn)]
        drawn = min(max(drawn, ranges[0].low), ranges[0].high)
    for r in ranges:
        track = follow(plan, index, branch, r.low, r.high, drawn)
        if track is not None:
            parts.append((_part(r, track.low, track.high, "-".join(map(str, step.links))), track))
    if parts:
        branch.tracks[index] = joined_path([track for _, track in parts])
    return [r for r, _ in parts]


def _part(r: DriverRange, low: float, high: float, joint: str) -> DriverRange:
    """The part low ... high of a range; where it is shorter, the joint locks."""
    return DriverRange(low, high, r.low_joint if low == r.low else joint, r.high_joint if high == r.high else joint)


def _link_angles(
    plan: SolutionPlan, ranges: list[DriverRange], branch: Branch, sampled: _Samples
) -> tuple[dict[int, _LazyAngle], bool]:
    """Continuous angle by link, and whether every link returns to its position after the cycle."""
    is_full = sampled.full_turn and len(ranges) == 1 and ranges[0].is_free
    parts = [sampled.at(r) for r in ranges]
    ends = solve(plan, at_driver(parts[0][[0, -1]]), branch).poses
    driver = None if plan.is_inner else plan.linkage.driver.link
    links = [link for link in ends if link not in (FRAME_LINK, driver)]
    is_periodic = not is_full or all(_returns(ends[link], plan.size) for link in links)
    return _lazy_angles(plan, branch, links, parts, is_full), is_periodic


def _lazy_angles(
    plan: SolutionPlan, branch: Branch, links: Iterable[int], parts: list[np.ndarray], is_full: bool
) -> dict[int, _LazyAngle]:
    """Continuous angle by link through the driver positions of each part, late since few results need it."""

    @once
    def unwrapped() -> dict[int, UnwrappedAngle]:
        solved = [solve(plan, at_driver(q), branch).poses for q in parts]
        result = {}
        for link in links:
            wrapped = [np.broadcast_to(poses[link].turn[0], q.shape) for q, poses in zip(parts, solved, strict=True)]
            angle = np.concatenate([near_zero(np.unwrap(_without_nan(np.array(part)))) for part in wrapped])
            rotates = is_full and bool(abs(angle[-1] - angle[0]) > pi)
            result[link] = _unwrapped_angle(np.concatenate(parts), angle, rotates)
        return result

    return {link: _LazyAngle(unwrapped, link) for link in links}


def _returns(pose: Pose, size: float) -> bool:
    """Whether a pose (2,) at both ends of a full turn is the same."""
    angle, z = np.broadcast_to(pose.turn[0], 2), np.broadcast_to(pose.origin[0], 2)
    turn_error = abs(np.remainder(angle[1] - angle[0] + pi, TURN) - pi)
    return bool(turn_error < 1e-6 and abs(z[1] - z[0]) < 1e-6 * size)


def _unwrapped_angle(q: np.ndarray, angle: np.ndarray, rotates: bool) -> UnwrappedAngle:
    """From continuous angles (m,) at driver positions q (m,)."""
    middle = 0.5 * float(angle.max() + angle.min()) if np.ptp(angle) < 0.9 * TURN and not rotates else None
    return UnwrappedAngle(q, angle, middle, rotates)


def _without_nan(angle: np.ndarray) -> np.ndarray:
    """The angles (n,), with the neighbour's value where rounding makes one NaN at a dead centre."""
    failed = ~np.isfinite(angle)
    if failed.any() and not failed.all():
        index = np.arange(angle.size)
        angle[failed] = angle[~failed][np.abs(index[failed][:, None] - index[~failed]).argmin(axis=1)]
    return angle


def near_zero(angle: np.ndarray) -> np.ndarray:
    """Continuous angles shifted by whole turns so that the middle of a swing, or the start of a rotation, is in -π ... π.

    Parameters
    ----------
    angle : ndarray (..., n) [rad]
        Leading axes are designs.

    Returns
    -------
    ndarray (..., n) [rad]
    """
    low, high = angle.min(axis=-1, keepdims=True), angle.max(axis=-1, keepdims=True)
    at = np.where(high - low >= 0.9 * TURN, angle[..., :1], 0.5 * (high + low))
    return np.asarray(angle - TURN * np.rint(at / TURN))
