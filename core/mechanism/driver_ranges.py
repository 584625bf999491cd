"""Where the driver of a linkage can move, and how its links turn there, without a jump."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
from core.mechanism.continuation import follow, merged
from core.mechanism.drawn import choose_side, drawn_place
from core.mechanism.dyads import DyadSolution
from core.mechanism.linkage import SolutionPlan, plan_of
from core.mechanism.mechanism import Solved, at_driver, solve
from core.numerics.derivatives import Derivatives
from core.numerics.lazy import once

# -- where a function of the driver's position is not negative --------------------------------------------------


Function = Callable[[np.ndarray], np.ndarray]

_CUTS = 257  # samples of a bracket of a minimum: so many cost hardly more than a few
_ROUNDS = 3  # each makes it 128 times narrower; what is lowest is flat there
_BESIDES = np.array([-3, -2, -1, 1, 2, 3])[:, None]  # samples around a lowest one
_PARTS = np.linspace(0.0, 1.0, 9)[1:-1, None]  # of a bracket of a change of sign
_DECADES = 10.0 ** -np.arange(1.0, 17.0)[:, None]
_ABOUT = np.concatenate((-_DECADES, _DECADES))  # of it, from where a straight line through its ends changes its sign


def ranges_where(function: Function, at: np.ndarray, value: np.ndarray) -> list[tuple[float, float]]:
    """Ranges in which ``function`` (n,) -> (n,) is >= 0, from its value (n,) at rising samples at (n,); NaN counts as negative.

    A gap or an island that falls between samples is found where its slopes point at it, but not beside what is infinite.
    """
    value = _nan_is_negative(value)
    for sign in (1.0, -1.0):  # gaps, then islands
        at, value = _with_minima(function, at, value, sign)
    good = value >= 0.0
    edge = np.flatnonzero(good[1:] != good[:-1])
    inside = _edges(function, at[[edge, edge + 1]], value[[edge, edge + 1]], good[edge])
    ends = {int(i): float(x) for i, x in zip(edge, inside, strict=True)}
    found, begin = [], float(at[0]) if good[0] else None
    for i in edge.tolist():
        if good[i] and begin is not None:
            found.append((begin, ends[i]))
            begin = None
        else:
            begin = ends[i]
    if begin is not None:
        found.append((begin, float(at[-1])))
    return found


def touched(function: Function, at: np.ndarray, value: np.ndarray, least: float) -> np.ndarray:
    """Where the function (n,) -> (n,), known at samples (n,), comes down to no more than ``least`` and goes up again: places (k,).

    Beside zero its root goes through as smoothly as a line: by the samples around that is known at once; else it is narrowed down.
    """
    value = _nan_is_negative(value)
    around = _may_reach_zero(value, value) + _BESIDES
    if around.size and around.min() >= 0 and around.max() < at.size:
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sign(_BESIDES) * np.sqrt(value[around])
            places = _at_zero(at[around], root)
        near = (at[around[2]] < places) & (places < at[around[3]])
        if near.all() and (function(places) <= least).all():
            return places
    places, values = _lowest(function, at, value, 1.0)
    return places[values <= least]


def _at_zero(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """x (k,) where y is 0, by Lagrange's polynomial in y through points (m, k)."""
    others = y[:, None] - y  # of each point those that the others are away
    own = np.arange(len(y))
    parts = y[:, None] / others
    parts[own, own] = 1.0
    return np.asarray((x * parts.prod(axis=0)).sum(axis=0))


def _nan_is_negative(value: np.ndarray) -> np.ndarray:
    return np.where(np.isnan(value), -np.inf, value)


def _with_minima(function: Function, at: np.ndarray, value: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
    """The samples and, between them, minima (of sign times the function) that may lie on the other side of zero."""
    places, values = _lowest(function, at, value, sign)
    order = np.argsort(np.concatenate((at, places)), kind="stable")
    return np.concatenate((at, places))[order], np.concatenate((value, values))[order]


def _lowest(function: Function, at: np.ndarray, value: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
    spots = _may_reach_zero(value, sign * value)
    low, high = at[spots - 1], at[spots + 1]
    if not spots.size:
        return low, low
    share = np.linspace(0.0, 1.0, _CUTS)[:, None]
    rows = np.arange(spots.size)
    for _ in range(_ROUNDS):
        x = low + (high - low) * share
        y = sign * _nan_is_negative(function(x.ravel())).reshape(x.shape)
        best = y.argmin(axis=0)
        before, after = np.maximum(best - 1, 0), np.minimum(best + 1, _CUTS - 1)
        low, high = x[before, rows], x[after, rows]
    place, value = x[best, rows], y[best, rows]
    corner = _corner(low, y[before, rows], high, y[after, rows])
    there = sign * _nan_is_negative(function(corner))
    lower = there < value
    return np.where(lower, corner, place), sign * np.where(lower, there, value)


def _may_reach_zero(value: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Samples (k,) of v, the value (n,) or its opposite, between which and their neighbours it may be 0: beside nothing infinite."""
    left, middle, right = v[:-2], v[1:-1], v[2:]
    with np.errstate(invalid="ignore"):
        steepest = np.maximum(left - middle, right - middle)
        may = (middle >= 0.0) & (middle <= left) & (middle <= right) & (middle <= steepest) & np.isfinite(middle)
        may &= (value[:-2] < np.inf) & (value[2:] < np.inf)
    return np.flatnonzero(may) + 1


def _corner(low: np.ndarray, left: np.ndarray, high: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Where two straight flanks, of these values at low and high, meet at zero between them: a minimum with a corner, such as of the
    sine of guides that turn parallel, is not flat at its bottom."""
    with np.errstate(divide="ignore", invalid="ignore"):
        corner = (low * right + high * left) / (left + right)
    return np.where(np.isfinite(corner) & (low <= corner) & (corner <= high), corner, low)


def _edges(function: Function, at: np.ndarray, value: np.ndarray, good: np.ndarray) -> np.ndarray:
    """At each change of sign, between places (2, m) with these values, the last number where the function is >= 0, which it is at the
    first place where ``good`` (m,). A call costs more than its values, so each bracket is cut at many places at a time: evenly, and
    closer and closer to where a straight line is zero."""
    at, value = (np.where(good, each, each[::-1]) for each in (at, value))
    rows = np.arange(good.size)
    while True:
        (begin, end), (above, below) = at, value
        width = end - begin
        with np.errstate(invalid="ignore", divide="ignore"):
            part = above / (above - below)
        part = np.where(np.isfinite(part), part, 0.5)
        x = begin + width * np.sort(np.clip(np.concatenate((_PARTS + 0.0 * part, part + _ABOUT)), 0.0, 1.0), axis=0)
        if not ((x != begin) & (x != end)).any():
            return begin
        y = _nan_is_negative(function(x.ravel())).reshape(x.shape)
        x, y = np.vstack((begin, x, end)), np.vstack((above, y, below))
        keeps = y >= 0.0
        keeps[0], keeps[-1] = True, False  # whatever rounding makes of places that are the ends
        first = keeps.argmin(axis=0)  # the first that is negative
        at, value = (np.array([each[first - 1, rows], each[first, rows]]) for each in (x, y))


# -- where the driver of a linkage can move, and how its links turn there, without a jump -----------------------


TURN = 2.0 * pi
SAMPLES = 721
_LEAST = 33
_BEYOND = 3  # samples beyond both ends of a whole turn: what lies on them lies between samples


@frozen
class DriverRange:
    """The driver's positions low ... high [rad or m] between two dead centres, or between the requested ends.

    low_joint, high_joint  where it locks: the joint of the dyad, or the links of a group; empty where it does not
    """

    low: float
    high: float
    low_joint: str = ""
    high_joint: str = ""

    @property
    def free(self) -> bool:
        """No dead centre ends it."""
        return not self.low_joint and not self.high_joint


@frozen(eq=False)
class UnwrappedAngle:
    """How a link's angle goes on without jumps: samples (m,) of driver position and angle; ``middle`` of its swing where
    that is less than a turn in a single range; turns: it goes round while the driver goes once round."""

    at: np.ndarray
    angle: np.ndarray
    middle: float | None
    turns: bool

    def of(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        """An angle between -π and π and its derivatives, the angle without jumps."""
        return Derivatives(lambda order: angle[order] if order else self.continued(q[0], angle[0]))

    def continued(self, q: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """The angles (n,) of -π ... π at q with the whole turns they lack."""
        if self.middle is not None:
            over = angle - self.middle
            if (np.abs(over) <= pi).all():
                return angle
            return angle - TURN * np.rint(over / TURN)
        return angle + TURN * np.rint((np.interp(q, self.at, self.angle) - angle) / TURN)


@frozen(eq=False)
class _Later:
    """A turning that is made when an angle is read."""

    made: Callable[[], Mapping[int, UnwrappedAngle]]
    link: int

    @property
    def turns(self) -> bool:
        return self.made()[self.link].turns

    @property
    def angle(self) -> np.ndarray:
        return self.made()[self.link].angle

    def of(self, q: Derivatives, angle: Derivatives) -> Derivatives:
        return Derivatives(lambda order: angle[order] if order else self.made()[self.link].continued(q[0], angle[0]))


@frozen
class ChangePoint:
    """A change point: at this position of the driver a dyad's links lie in line and both its assemblies meet; the
    linkage goes on smoothly into the other."""

    at: float
    joint: str


@frozen(eq=False)
class DriverRanges:
    """Ranges and change points in rising order, cut where the driver's turn begins; the branch; turning by link;
    closes: after the cycle every link stands as before. Of a linkage that is drawn the range in which it is drawn is
    the only one, ``others`` those besides; swings: a crank goes to and fro in it. turns: of the driver in a
    cycle. plan: None of a whole turn by itself, of no linkage."""

    plan: SolutionPlan
    ranges: tuple[DriverRange, ...]
    changes: tuple[ChangePoint, ...]
    branch: Branch
    turning: Mapping[int, UnwrappedAngle | _Later]
    closes: bool = True
    swings: bool = False
    turns: int = 1
    others: tuple[DriverRange, ...] = ()

    @property
    def motions(self) -> tuple[Motion, ...]:
        """Those that further drivers follow by themselves."""
        return tuple(self.plan.linkage.own_motions.values()) if self.plan else ()

    def solve(self, q: Derivatives) -> Solved:
        """Poses for the driver at q, angles without jumps; NaN outside the ranges."""
        solved = solve(self.plan, q, self.branch)
        for link, turning in self.turning.items():
            pose = solved.poses[link]
            solved.poses[link] = pose.turning_as(turning.of(q, pose.turn))
        return solved


@lru_cache(maxsize=64)
def driver_ranges_of(linkage: Linkage, low: float = 0.0, high: float = TURN) -> DriverRanges:
    """Ranges and change points for driver positions low ... high [rad or m]; kept. Of a linkage that is drawn also at the place where it
    is, and of a crank the whole range to and fro, through 0 too. A crank's cycle is as many turns as bring back the links that are driven
    by a ratio, or twice as many where the others need them. Raises NoPosition where two ways to assemble it are as near to what
    is drawn."""
    plan = plan_of(linkage)
    if high - low != TURN:
        place = None if linkage.drawn is None else drawn_place(linkage.drawn)
        if place is None:
            return _ranges(plan, low, high, False)
        return _around(_ranges(plan, min(low, place), max(high, place), False, place), place)
    turns = linkage.turns
    found = _cycle(plan, low, turns or 1)
    if found.closes or turns is None or 2 * turns > MOST_TURNS:
        return found
    twice = _cycle(plan, low, 2 * turns)
    return twice if twice.closes else found


def _cycle(plan: SolutionPlan, low: float, turns: int) -> DriverRanges:
    """Ranges and change points of a crank through so many turns from ``low`` [rad] on."""
    drawn, turn = plan.linkage.drawn, TURN * turns
    if drawn is None:
        return replace(_ranges(plan, low, low + turn, True), turns=turns)
    place = drawn_place(drawn)
    for half in (
        _HALVES if plan.linkage.turns is None else ()
    ):  # no turn is like another: only what is around the drawn position counts
        found = _around(_ranges(plan, place - half, place + half, False, place), place)
        if found.ranges and found.ranges[0].low_joint and found.ranges[0].high_joint:
            return replace(found, swings=True)
    found = _ranges(plan, low, low + turn, True, place % turn)
    if not found.ranges or (len(found.ranges) == 1 and found.ranges[0].free):
        return replace(found, turns=turns)
    locked = [r.high for r in found.ranges if r.high_joint]  # the turn is cut in the gap behind one of them
    begin = locked[0] if locked else found.ranges[0].low
    beyond = min((r.low for r in found.ranges if r.low > begin), default=begin + turn)
    begin += min(0.5 * (beyond - begin), _BESIDE) if locked else -_BESIDE
    begin += turn * np.floor((place - begin) / turn)
    found = _ranges(plan, begin, begin + turn, False, place)
    return replace(_around(found, place), swings=True) if found.ranges else found


def _around(found: DriverRanges, place: float) -> DriverRanges:
    """The range around a place of the driver, or the nearest, alone."""
    if not found.ranges:
        return found
    own = _nearest(found.ranges, place)
    changes = tuple(c for c in found.changes if own.low <= c.at <= own.high)
    return replace(found, ranges=(own,), changes=changes, others=tuple(r for r in found.ranges if r is not own))


def _nearest(ranges: Sequence[DriverRange], place: float) -> DriverRange:
    """The range around a place of the driver, or the nearest."""
    return min(ranges, key=lambda r: max(r.low - place, place - r.high, 0.0))


def _ranges(plan: SolutionPlan, low: float, high: float, whole: bool, place: float | None = None) -> DriverRanges:
    """Ranges and change points for driver positions low ... high; whole: a crank's turn; place: of the driver as drawn."""
    branch = Branch(low)
    ranges, changes = [DriverRange(low, high)], []
    sampled = _Samples(plan, branch, high - low, whole, place is not None)
    for i, (step, _) in enumerate(plan.steps):
        if step.kind == INPUT:
            continue
        if step.kind == GROUP:
            ranges = _followed(plan, i, branch, ranges, place)
        else:
            if step.kind in SIDED and place is not None:
                place = _assembled_near(plan, i, branch, ranges, place, sampled)
                if place is None:
                    ranges = []
                    break
                choose_side(plan, i, branch, place)
            if step.kind in SIDED:
                changes += _changes(plan, i, branch, ranges, sampled)
            ranges = [
                _within(r, a, b, step.joint)
                for r in ranges
                for a, b in ranges_where(_gap(plan, i, branch), *sampled.gaps(i, r))
                if b - a > _STANDS * (high - low)
            ]
        if not ranges:
            break
    if not ranges:
        return DriverRanges(plan, (), (), branch, MappingProxyType({}))
    turning, closes = _turning(plan, ranges, sampled)
    inside = tuple(sorted((c for c in changes if low <= c.at < high), key=lambda c: c.at))
    return DriverRanges(plan, tuple(ranges), inside, branch, MappingProxyType(turning), closes)


def guided_ranges(
    plan: SolutionPlan, start: float, ends: Callable[[], tuple[float, float]], angles: Mapping[int, float]
) -> DriverRanges:
    """The driver ranges of a mechanism that stays as it is assembled at ``start``, through driver positions between two ends [rad
    or m]: no ranges and no change points are searched. Every link's angle goes on without a jump from what it is at the
    start, ``angles`` [rad] by link."""
    branch = Branch()

    @once
    def followed() -> dict[int, UnwrappedAngle]:  # where somebody asks for an angle: forces and the cam's shape do not
        at = np.linspace(*ends(), PATH)
        poses = solve(plan, at_driver(at), branch).poses
        turning = {}
        for link, first in angles.items():
            angle = np.unwrap(_filled(np.array(np.broadcast_to(poses[link].turn[0], at.shape))))
            angle += TURN * np.rint((first - np.interp(start, at, angle)) / TURN)
            turning[link] = _turning_by(at, angle, turns=False)
        return turning

    return DriverRanges(plan, (), (), branch, MappingProxyType({link: _Later(followed, link) for link in angles}))


PATH = (
    65  # positions through which links are followed from the base: no link turns by more than half a turn between two
)
_HALVES = (0.5 * TURN, 4.0 * TURN)  # so far to both sides is a swing searched that no period bounds
_STANDS = 1e-6  # of the requested positions: in a shorter range nothing moves, and rounding decides its ends
SIDED = ("RRR", "RRP", "RPR")
_WITHIN = 1e-2  # of a range: so far from its ends the two ways to assemble a dyad can be told apart
_SAME = 1e-6  # [rad or m] a change point this near to an end of the range is there; it is found to about 1e-8
_BESIDE = 2e-6  # so far from a change point the dyad is open on both sides
_TRIES = 7  # at the width of a bridge
_TOUCH = 1e-12  # of the size: a gap this small at its least is a change point


def _samples(length: float, whole: float) -> int:
    return max(_LEAST, int(SAMPLES * max(1.0, whole / TURN) * length / max(whole, 1e-300)))


def _gap(plan: SolutionPlan, index: int, branch: Branch) -> Callable[[np.ndarray], np.ndarray]:
    """What a dyad has left at driver positions (n,)."""
    return lambda q: _left(solve(plan, at_driver(q), branch, index + 1), index, branch, q)


def _left(solved: Solved, index: int, branch: Branch, q: np.ndarray) -> np.ndarray:
    """The same of what is solved at q (n,); on the bridge over a change point, where it is never open, infinite."""
    closed = solved.steps[index]
    assert isinstance(closed, DyadSolution)
    value = np.broadcast_to(closed.gap, q.shape)
    for over in branch.bridges.get(index, ()):
        value = np.where(over.within(q), np.inf, value)
    return value


class _Samples:
    """Samples of ranges of the driver: what is solved there for one step serves the others, as long as neither the range nor the
    branch becomes another. whole: a crank's turn, which is sampled a little beyond both its ends too."""

    def __init__(self, plan: SolutionPlan, branch: Branch, length: float, whole: bool, drawn: bool) -> None:
        self._plan, self._branch, self._length, self._drawn = plan, branch, length, drawn
        self.whole = whole
        self._solved: dict[Any, tuple[np.ndarray, Solved]] = {}

    def at(self, r: DriverRange) -> np.ndarray:
        """Positions (n,) from end to end."""
        return np.linspace(r.low, r.high, _samples(r.high - r.low, self._length))

    def beyond(self, r: DriverRange) -> int:
        """How many there are beyond each end besides."""
        return _BEYOND if self.whole and r.free else 0

    def solved(self, index: int, r: DriverRange) -> tuple[np.ndarray, Solved]:
        """Positions (n,), those beyond included, and the links there as far as this step at least."""
        branch, steps = self._branch, self._plan.steps
        known = len(branch.changes), len(branch.bridges), len(branch.tracks), len(branch.chosen)
        key = (r.low, r.high, *known)
        if key not in self._solved or len(self._solved[key][1].steps) <= index:
            q, more = self.at(r), self.beyond(r)
            if more:
                beside = (q[1] - q[0]) * np.arange(1.0, more + 1.0)
                q = np.concatenate((q[0] - beside[::-1], q, q[-1] + beside))
            self._solved[key] = q, solve(self._plan, at_driver(q), branch, self._last(index, len(steps)))
        return self._solved[key]

    def _last(self, index: int, count: int) -> int:
        """How many steps can be solved: up to the next one of which it is not yet known how it is assembled."""
        for i in range(index + 1, count):
            kind = self._plan.steps[i][0].kind
            if kind == GROUP and i not in self._branch.tracks:
                return i
            if self._drawn and kind in SIDED and i not in self._branch.chosen:
                return i
        return count

    def gaps(self, index: int, r: DriverRange, beyond: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Positions (n,) from end to end, or beyond, and what a dyad has left there."""
        q, solved = self.solved(index, r)
        value, inside = _left(solved, index, self._branch, q), slice(self.beyond(r), q.size - self.beyond(r))
        return (q, value) if beyond else (q[inside], value[inside])


def _changes(
    plan: SolutionPlan, index: int, branch: Branch, ranges: list[DriverRange], sampled: _Samples
) -> list[ChangePoint]:
    """Find the change points of a dyad and lay bridges over them."""
    step, _ = plan.steps[index]
    gap = _gap(plan, index, branch)
    found: list[float] = []
    scale = 1.0 if plan.driver.revolute else plan.size
    for r in ranges:
        at, left = sampled.gaps(index, r, beyond=True)
        closed = left < -_TOUCH * plan.size  # beside it the gap is crossed, not touched
        room = np.where(closed, np.inf, np.abs(left))
        low = touched(lambda q: np.abs(gap(q)), at, room, _TOUCH * plan.size)
        if not low.size:
            continue
        beside = gap(np.concatenate((low - scale * _BESIDE, low + scale * _BESIDE))).reshape(2, -1)
        for place in low[(beside > 0.0).all(axis=0)].tolist():  # touched, not crossed
            found.append(next((end for end in (r.low, r.high) if abs(place - end) < _SAME), place))
    if not found:
        return []
    branch.changes[index] = np.array(sorted(found))
    at, half, links = np.array(found), np.full(len(found), scale * HALF), (step.links[0], step.links[1])
    shorter = np.ones(at.size)
    for _ in range(_TRIES):
        half *= shorter
        q = np.stack((at - half, at + half), axis=1).ravel()
        ends = _end_states(solve(plan, at_driver(q), branch, index + 1), links, q.size)
        shorter = np.where(np.isfinite(ends).all(axis=(1, 2, 3)), 1.0, 0.25)  # where a dead centre is near
        if (shorter == 1.0).all():
            break
    rows = zip(at.tolist(), half.tolist(), ends, strict=True)
    branch.bridges[index] = tuple(bridge(place, width, links, states) for place, width, states in rows)
    return [ChangePoint(place, step.joint) for place in found]


def _end_states(solved: Solved, links: tuple[int, ...], n: int) -> np.ndarray:
    """(m, 2, 4, 6): x, y, angle of both links with three derivatives at both ends of m bridges, solved in this order."""
    columns = []
    for link in links:
        pose = solved.poses[link]
        angle = np.array(pose.turn.spread(n).all)
        angle[0] = np.unwrap(angle[0].reshape(-1, 2)).ravel()
        z = pose.origin.spread(n).all
        columns += [z.real, z.imag, angle]
    return np.array(columns).transpose(2, 1, 0).reshape(-1, 2, 4, 6)


def _assembled_near(
    plan: SolutionPlan, index: int, branch: Branch, ranges: list[DriverRange], place: float, sampled: _Samples
) -> float | None:
    """The place, where the dyad can be assembled there, else the nearest one well within a range in which it can; None where
    there is none."""
    gap = _gap(plan, index, branch)
    if any(r.low <= place <= r.high for r in ranges) and gap(np.array([place]))[0] > 0.0:
        return place
    length = ranges[-1].high - ranges[0].low
    there = [
        (a + _WITHIN * (b - a), b - _WITHIN * (b - a))
        for r in ranges
        for a, b in ranges_where(gap, *sampled.gaps(index, r))
        if b - a > _STANDS * length
    ]
    return min((min(max(place, a), b) for a, b in there), key=lambda at: abs(at - place), default=None)


def _followed(
    plan: SolutionPlan, index: int, branch: Branch, ranges: list[DriverRange], place: float | None = None
) -> list[DriverRange]:
    """The parts of the ranges through which a group can be followed; where it is drawn, of the one around that place."""
    step, _ = plan.steps[index]
    kept = []
    if place is not None:
        ranges = [_nearest(ranges, place)]
        place = min(max(place, ranges[0].low), ranges[0].high)
    for r in ranges:
        track = follow(plan, index, branch, r.low, r.high, place)
        if track is not None:
            kept.append((_within(r, track.low, track.high, "-".join(map(str, step.links))), track))
    if kept:
        branch.tracks[index] = merged([track for _, track in kept])
    return [r for r, _ in kept]


def _within(r: DriverRange, low: float, high: float, joint: str) -> DriverRange:
    """The part low ... high of a range; where it is shorter, the joint locks."""
    return DriverRange(low, high, r.low_joint if low == r.low else joint, r.high_joint if high == r.high else joint)


def _turning(
    plan: SolutionPlan, ranges: list[DriverRange], sampled: _Samples
) -> tuple[dict[int, UnwrappedAngle], bool]:
    parts = [sampled.solved(len(plan.steps) - 1, r) for r in ranges]
    inside = [slice(sampled.beyond(r), q.size - sampled.beyond(r)) for r, (q, _) in zip(ranges, parts, strict=True)]
    at = np.concatenate([q[own] for own, (q, _) in zip(inside, parts, strict=True)])
    full = sampled.whole and len(ranges) == 1 and ranges[0].free
    found: dict[int, UnwrappedAngle] = {}
    closes = True
    for link in parts[0][1].poses:
        if link == FRAME_LINK or (link == plan.linkage.driver.link and not plan.inner):
            continue
        along = [
            np.array(np.broadcast_to(solved.poses[link].turn[0], q.shape)[own])
            for own, (q, solved) in zip(inside, parts, strict=True)
        ]
        angle = np.concatenate([near_zero(np.unwrap(_filled(part))) for part in along])
        found[link] = _turning_by(at, angle, turns=full and bool(abs(angle[-1] - angle[0]) > pi))
        if full:
            lost = abs(np.remainder(angle[-1] - angle[0] + pi, TURN) - pi)
            place = np.broadcast_to(parts[0][1].poses[link].origin[0], parts[0][0].shape)[inside[0]]
            closes &= bool(lost < 1e-6 and abs(place[-1] - place[0]) < 1e-6 * plan.size)
    return found, closes


def _turning_by(q: np.ndarray, angle: np.ndarray, turns: bool) -> UnwrappedAngle:
    """From angles (m,) without jumps at driver positions q (m,)."""
    middle = 0.5 * float(angle.max() + angle.min()) if np.ptp(angle) < 0.9 * TURN and not turns else None
    return UnwrappedAngle(q, angle, middle, turns)


def _filled(angle: np.ndarray) -> np.ndarray:
    """The angles, of which rounding may have lost one at a dead centre: there as its neighbour's."""
    lost = ~np.isfinite(angle)
    if lost.any() and not lost.all():
        places = np.arange(angle.size)
        angle[lost] = angle[~lost][np.abs(places[lost][:, None] - places[~lost]).argmin(axis=1)]
    return angle


def near_zero(angle: np.ndarray) -> np.ndarray:
    """Swings (..., n) moved by whole turns so that their middle lies in -π ... π, or where one goes round, its start."""
    low, high = angle.min(axis=-1, keepdims=True), angle.max(axis=-1, keepdims=True)
    at = np.where(high - low >= 0.9 * TURN, angle[..., :1], 0.5 * (high + low))
    return np.asarray(angle - TURN * np.rint(at / TURN))
