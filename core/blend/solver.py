"""What the designer asks for, solved over a family: along a curve of points that meet all wishes but one, the last is a
bracketed root. Every refusal knows the ranges that would have been accepted."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from math import inf

import numpy as np

from core.blend.family import Family, Solution, Task
from core.blend.roots import GRID, Interval, bracketed, extent, intervals, roots
from core.blend.sheet import TINY, Sheet, sheets, slack
from core.blend.wishes import Found, Wish, hardest_first, measure

OPEN = 1e-9  # a height that must be above 0, as a share of the stroke, this small at the end of a range: an open end
SAME = 1e-9  # a setting that varies by less over all that the others leave is determined by them
_BRANCHES = 3
_ENDLESS = 1e6  # a setting that gets so many times greater than usual has no upper end
_LOOKS = np.array([0.03, 0.2, 0.5, 0.77, 0.96])
_INNER = GRID[16:-11:3]


@dataclass(frozen=True)
class Range:
    """From low to high; an open end can only be approached."""

    low: float
    high: float
    low_open: bool = False
    high_open: bool = False


class Determined(Exception):
    """The other wishes determine this one: ``ranges`` hold its one value."""

    def __init__(self, wish: Wish, ranges: Sequence[Range]) -> None:
        super().__init__(wish.name)
        self.wish, self.ranges = wish, tuple(ranges)


class Problem:
    """A family, a task and as many wishes as the family has free numbers."""

    def __init__(self, family: Family, task: Task, wishes: Sequence[Wish]) -> None:
        self.family, self.task, self.wishes = family, task, tuple(wishes)
        self._inner: dict[tuple[Sheet, Wish, bytes], np.ndarray] = {}

    def solutions(self) -> list[Solution]:
        """Every solution, the gentlest first. Raises Determined where the others determine a wish: then it is none."""
        found = [self.family.solution(self.task, p, i) for p, i in self._points() if self._is_feasible(p, i)]
        return sorted(found, key=lambda s: s.peak_acceleration)

    def _is_feasible(self, found: Found, i: int) -> bool:
        return bool(slack(self.family, self.task, found)[i] >= 0.0)

    def _points(self) -> Iterator[tuple[Found, int]]:
        if not self.family.bent:
            yield self.family.solve(self.task, {}), 0
            return
        if all(w.linear for w in self.wishes):
            pinned = sheets(self.family, self.task, self.wishes, 0) if self._bent_is_given else []
            for sheet in pinned:
                yield sheet.at(np.empty((0, 1))), 0
            if pinned:
                return
        if sum(not w.linear for w in self.wishes) > 1:
            yield from self._crossings()
            return
        for wish, others in self._splits():
            curves = self.curves(others)
            if curves:
                for curve in curves:
                    yield from curve.where(wish)
                return

    def _crossings(self) -> Iterator[tuple[Found, int]]:
        """Where two wishes that are not linear both come true: Newton's method from every cell of a sheet in which
        each changes its sign."""
        bent = [w for w in self.wishes if not w.linear]
        for sheet in sheets(self.family, self.task, [w for w in self.wishes if w.linear], 2):

            def missed(x: np.ndarray, sheet: Sheet = sheet) -> np.ndarray:
                found = sheet.at(x)
                with np.errstate(all="ignore"):
                    return np.array([measure(w, self.family, self.task, found) / w.value - 1.0 for w in bent])

            x = _newton(missed, _cells(missed))
            good = (np.abs(missed(x)) <= 1e-11).all(axis=0) & (x > 0.0).all(axis=0) & (x < 1.0).all(axis=0)
            x = np.unique(x[:, good].round(12), axis=1) if good.sum() > 1 else x[:, good]
            x = _newton(missed, x)
            for i in range(x.shape[1]):
                yield sheet.at(x), i

    @property
    def _bent_is_given(self) -> bool:
        return self.family.bent in {w.name for w in self.wishes}

    def _splits(self) -> Iterator[tuple[Wish, list[Wish]]]:
        """Ways to choose the wish that the root is found for: one that is not linear first."""
        for wish in hardest_first(self.wishes):
            yield wish, [w for w in self.wishes if w is not wish]

    def curves(self, wishes: Sequence[Wish]) -> list[Curve]:
        """The points that meet all wishes but one, as curves. At most one of them may be not linear."""
        linear = [w for w in wishes if w.linear]
        bent = [w for w in wishes if not w.linear]
        if len(bent) > 1:
            return []
        found = sheets(self.family, self.task, linear, 1 + len(bent))
        if not bent:
            return [Curve(self, sheet.at) for sheet in found]
        return [Curve(self, at) for sheet in found for at in self._branches(sheet, bent[0], GRID[None, :])]

    def size_of(self, wish: Wish) -> float:
        """What the values of a wish are usually like."""
        stroke, span = max(self.task.rise, self.task.back), self.task.span
        return {"length": span, "peak": span, "vcv": stroke / span, "vcv2": stroke / span}.get(wish.name, stroke)

    def spaces(self) -> list[Callable[[np.ndarray], Found]]:
        """All points that meet the wishes, over as many coordinates 0 ... 1 as these leave free numbers (k, n)."""
        linear = [w for w in self.wishes if w.linear]
        bent = [w for w in self.wishes if not w.linear]
        found = sheets(self.family, self.task, linear, len(self.family.free) - len(linear))
        if len(bent) > 1:
            return []
        if not bent:
            return [sheet.at for sheet in found]
        look = np.random.default_rng(1995).random((len(self.family.free) - len(self.wishes), 500))
        return [at for sheet in found for at in self._branches(sheet, bent[0], look)]

    def _branches(self, sheet: Sheet, wish: Wish, look: np.ndarray) -> list[Callable[[np.ndarray], Found]]:
        """The points of a sheet of one coordinate more that meet a wish: as many branches as are seen at most at one
        place, counted from the lowest and, where there are several, from the highest too."""
        inner = np.isfinite(self._inner_of(sheet, wish, look)[:_BRANCHES]).any(axis=1)
        count = int(inner.sum())
        rows = [*range(count), *(range(-count, 0) if count > 1 else ())]
        return [partial(self._on_sheet, sheet, wish, row) for row in rows]

    def _on_sheet(self, sheet: Sheet, wish: Wish, branch: int, x: np.ndarray) -> Found:
        return sheet.at(np.vstack([x, self._inner_of(sheet, wish, x)[branch]]))

    def _inner_of(self, sheet: Sheet, wish: Wish, x: np.ndarray) -> np.ndarray:
        """``_met_on_sheet``, kept: the branches are looked at in the same places."""
        key = (sheet, wish, x.tobytes())
        if key not in self._inner:
            self._inner[key] = self._met_on_sheet(sheet, wish, x)
        return self._inner[key]

    def _met_on_sheet(self, sheet: Sheet, wish: Wish, x: np.ndarray) -> np.ndarray:
        """Where on the last coordinate a wish is met at each x: the lowest places, and from the end the highest ones
        (2 x _BRANCHES, n)."""
        n, t = x.shape[1], _INNER

        def missed(rows: np.ndarray, inner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            found = sheet.at(np.vstack([x[:, rows], inner]))
            with np.errstate(all="ignore"):
                values = measure(wish, self.family, self.task, found) - wish.value
            return values, slack(self.family, self.task, found)

        values = missed(np.repeat(np.arange(n), t.size), np.tile(t, n))[0].reshape(n, t.size)
        with np.errstate(invalid="ignore"):
            row, cell = np.nonzero(np.sign(values[:, 1:]) * np.sign(values[:, :-1]) < 0.0)
        made = np.full((2 * _BRANCHES, n), np.nan)
        if not row.size:
            return made
        low = bracketed(lambda t: missed(row, t)[0], t[cell], t[cell + 1], values[row, cell], values[row, cell + 1])
        error, slacks = missed(row, low)
        good = (slacks >= 0.0) & (np.abs(error) <= 1e-9 * max(abs(wish.value), TINY))
        for i in np.unique(row[good]):
            inner = np.sort(low[good & (row == i)])[:_BRANCHES]
            made[: inner.size, i] = inner
            made[2 * _BRANCHES - inner.size :, i] = inner
        return made

    # -- ranges -------------------------------------------------------------------------------------------

    def ranges(self, wish: Wish) -> list[Range]:
        """What a wish may be while the others stay; empty where they leave nothing, or cannot be followed."""
        others = [w for w in self.wishes if w is not wish]
        if len(others) != len(self.family.free) - 1:
            return self.bounds(wish, others)
        return merged([r for curve in self.curves(others) for r in curve.ranges(wish)])

    def bounds(self, wish: Wish, kept: Sequence[Wish]) -> list[Range]:
        """What a linear wish may be while only some of the others stay.

        With the bent number given, the feasible points are a polytope and the wish takes its extremes in the corners:
        there as many heights are 0 as wishes were let go.
        """
        family, missing = self.family, len(self.family.free) - 1 - len(kept)
        if not family.bent or not wish.linear or not all(w.linear for w in kept) or missing < 0:
            return []
        found = []
        for corner in combinations((*family.positive, *family.constant), missing):
            zeros = [Wish(name, 0.0) for name in corner]
            closed = Problem(family, self.task, [*kept, *zeros])
            found += [r for curve in closed.curves([*kept, *zeros]) for r in Curve(closed, curve.at, True).ranges(wish)]
        return [Range(min(r.low for r in found), max(r.high for r in found), True, True)] if found else []


def _cells(missed: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Centres (2, n) of the cells of a grid over the unit square at whose corners both rows take both signs."""
    axis = GRID[12::2]
    rows = np.sign(missed(np.array(np.meshgrid(axis, axis, indexing="ij")).reshape(2, -1))).reshape(2, axis.size, -1)
    corners = np.array([rows[:, a : a + axis.size - 1, b : b + axis.size - 1] for a in (0, 1) for b in (0, 1)])
    with np.errstate(invalid="ignore"):
        i, j = np.nonzero((corners.min(axis=0) < 0.0).all(axis=0) & (corners.max(axis=0) > 0.0).all(axis=0))
    middle = 0.5 * (axis[1:] + axis[:-1])
    return np.array([middle[i], middle[j]])


def _newton(missed: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    """Many starts (2, n) at once, steps cut to stay inside the unit square; those that are lost are nan."""
    for _ in range(40):
        step = 1e-7 * np.minimum(x, 1.0 - x)
        here = missed(x)
        (a, c), (b, d) = (
            (missed(x + step * side) - missed(x - step * side)) / (2.0 * step[row])
            for row, side in enumerate(np.eye(2)[:, :, None])
        )
        with np.errstate(all="ignore"):
            move = np.array([d * here[0] - b * here[1], a * here[1] - c * here[0]]) / (a * d - b * c)
        with np.errstate(invalid="ignore"):
            x = np.where(x - move <= 0.0, 0.5 * x, np.where(x - move >= 1.0, 0.5 * (1.0 + x), x - move))
    return x


class Curve:
    """The points of a family along a number from 0 to 1. closed: heights that must be above 0 may be 0."""

    def __init__(self, problem: Problem, at: Callable[[np.ndarray], Found], closed: bool = False) -> None:
        self.at, self._problem, self._closed = at, problem, closed

    def _slack(self, x: np.ndarray) -> np.ndarray:
        found = self.at(x[None, :])
        slacks = slack(self._problem.family, self._problem.task, found)
        return slacks + 1e-12 if self._closed else slacks

    def _measure(self, wish: Wish, x: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            values = measure(wish, self._problem.family, self._problem.task, self.at(x[None, :]))
        return np.where(np.isfinite(values), values, np.nan)

    def where(self, wish: Wish) -> Iterator[tuple[Found, int]]:
        """The feasible points at which a wish has its value. Raises Determined where it has one value everywhere."""
        for interval in intervals(self._slack):
            if self._is_determined(wish, interval):
                raise Determined(wish, [self._range(wish, interval)])
            size = abs(wish.value)
            for x in roots(lambda v: self._measure(wish, v) - wish.value, interval, size):
                yield self.at(np.array([[x]])), 0

    def ranges(self, wish: Wish) -> list[Range]:
        """The values a wish takes, stretch by stretch."""
        return [self._range(wish, interval) for interval in intervals(self._slack)]

    def _range(self, wish: Wish, interval: Interval) -> Range:
        (low, at_low), (high, at_high) = extent(lambda x: self._measure(wish, x), interval)
        low_open, high_open = self._is_open(at_low), self._is_open(at_high)
        if wish.name != "acceleration":
            low = 0.0 if abs(low) <= SAME * high else low
        elif high_open:
            high = inf
        if high_open and high > _ENDLESS * self._problem.size_of(wish):
            high = inf
        return Range(low, high, low_open, high_open)

    def _is_determined(self, wish: Wish, interval: Interval) -> bool:
        """Whether the wish has one value over the whole interval."""
        values = self._measure(wish, interval.low + (interval.high - interval.low) * _LOOKS)
        return interval.high - interval.low > 1e-9 and bool(np.ptp(values) <= SAME * np.abs(values).max())

    def _is_open(self, x: float) -> bool:
        found = self.at(np.array([[x]]))
        family, task = self._problem.family, self._problem.task
        return any(found[name][0] <= OPEN * task.rise for name in family.positive)


def merged(ranges: Sequence[Range]) -> list[Range]:
    """The same stretches, those that meet made one."""
    found: list[Range] = []
    for r in sorted(ranges, key=lambda r: (r.low, r.low_open)):
        if found and r.low <= found[-1].high + 1e-9 * abs(found[-1].high):
            last = found.pop()
            high = max(last.high, r.high)
            open_ = all(q.high_open for q in (last, r) if q.high == high)
            r = Range(last.low, high, last.low_open, open_)
        found.append(r)
    return found
