"""Laws made to measure for a machine: the least peak or mean square of an effect that is known by its values only.

The effect depends on s, s', s''. Every step of a search minimises its linearisation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from core.frozen import frozen
from core.laws.knots import Knots, OptimalTask, Points
from core.laws.optimal import (
    NEAR,
    NoOptimalLaw,
    Row,
    Solution,
    equal_rows,
    least_mean,
    least_peak,
    least_squares,
    less_rows,
    limit_rows,
    optimal_law,
    solve,
    with_exceeding,
)
from core.laws.pieces import Piece
from core.numerics.lazy import checkpoint

ROUNDS = 30  # of added nodes

# -- least peak or mean square of an effect in a machine ---------------------------------------------------------

Effect = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Effects of a law at u (k,) with s, s', s'' (3, k): values (r, k), and their derivatives (3, r, k) by s, s', s''.

The first one is minimised, a second one must not be negative.
"""
STARTS = ((2, True), (2, False), (3, False), (3, True), (1, False))
"""Order of the derivative, and whether its root mean square is least, of the laws at which a search begins."""
MODERATE = 2.0  # largest acceleration of the law of least velocity, over the least one
QUARTERS = np.arange(4) / 4.0  # of an interval: nodes at which effects are evaluated
STEPS = 60  # of a search
FIRST_STEP, LEAST_STEP = 0.5, 1e-7  # of the largest derivative of order m: trust region
LEAST_GAIN = 1e-9  # of the effect: a smaller predicted gain ends a search
GOOD, FAIR = 0.75, 0.1  # part of the predicted gain that enlarges the trust region, and that accepts a step
BETWEEN = 1e-5  # of the largest effect: excess between nodes
DENSE = np.arange(32) / 32.0  # of an interval: points at which the effects of a law are checked between the nodes
COARSE = 20  # intervals of the searches for a least peak; from the best law one more search has all intervals
HALVINGS = 12  # of a step of least squares
PENALTY = 10.0  # on a negative second effect, both relative to their size at the start


@frozen(eq=False)
class LocalLaw:
    """A law of least peak or root mean square of an effect, near the law at which its search began.

    Attributes
    ----------
    pieces : the law, between knots
    value : largest effect, or its root mean square
    least : that of the linearised effect, within the last trust region
    starts : effect of the law that each search began at, and of the one it led to; peaks with at most ``COARSE`` intervals
    """

    pieces: tuple[Piece, ...]
    value: float
    least: float
    starts: tuple[tuple[float, float], ...]


def local_law(task: OptimalTask, effect: Effect) -> LocalLaw:
    """Law of least peak of an effect, or of its root mean square, the best of searches from five laws.

    It does not reverse where the task admits that. A step towards the least peak is a linear program with the linearised effect,
    in a trust region about the present law. A step towards the least mean square is a problem of least distance (Gauss, Newton).

    Parameters
    ----------
    task : OptimalTask
        ``order`` is that of the highest derivative on which the effect depends, ``rms`` whether its root mean square is least.
    effect : Effect
        Infinite where a law has no solution; the first of the five laws is returned where none has one.

    Returns
    -------
    LocalLaw

    Raises
    ------
    NoOptimalLaw
        Where no law satisfies the task.
    """
    optimal_law(replace(task, rms=False))
    searched = task if task.rms else replace(task, intervals=min(task.intervals, COARSE))
    search = _search(searched, effect) or _search(task, effect)
    if search is None:
        raise NoOptimalLaw(0, 0.0)
    runs = [(start, search.run(start)) for start in search.starts()]
    reached = [end for _, end in runs]
    if search.knots.h.size < task.intervals and (finer := _search(task, effect)) is not None:
        near = finer.evaluated(finer.knots.resampled(search.knots, min(reached, key=_value).states))
        begin = min([near, *finer.starts(STARTS[:2])], key=_value)
        search, reached = finer, [finer.run(begin)]
    best = search.refined(min(reached, key=_value))
    return LocalLaw(
        search.knots.pieces(best.states), best.value, best.least, tuple((start.value, end.value) for start, end in runs)
    )


def _search(task: OptimalTask, effect: Effect) -> _Search | None:
    """Search among the laws of a task, which do not reverse where that is possible; None where there are none."""
    knots = Knots(replace(task, rms=False))
    for limited in (replace(task, rising=True), task):
        gentle = least_peak(replace(limited, order=2, rms=False), knots)
        if gentle is not None:
            return (_SquareSearch if task.rms else _PeakSearch)(limited, knots, effect, gentle)
    return None


def _value(reached: _Reached) -> float:
    return reached.value


@frozen(eq=False)
class _Reached:
    """A law of a search: derivatives at the knots, its effects at the nodes with derivatives, and the linearised least one."""

    states: np.ndarray
    effects: np.ndarray
    partials: np.ndarray
    value: float
    least: float


class _Search:
    """Search for a law of least effect."""

    def __init__(self, task: OptimalTask, knots: Knots, effect: Effect, gentle: Solution) -> None:
        self.task, self.knots, self.effect, self.gentle = task, knots, effect, gentle
        self.limits = limit_rows(replace(task, rms=True), knots)
        self.points, self.share = self.nodes()
        self.part = math.nan
        """Weight of a negative second effect, by the effects of the first law."""

    def nodes(self) -> tuple[Points, np.ndarray]:
        """Nodes (k,), and their weights in the mean."""
        raise NotImplementedError

    def size(self, effects: np.ndarray) -> float:
        """What is minimised of effects (r, k) at the nodes."""
        raise NotImplementedError

    def starts(self, aims: Sequence[tuple[int, bool]] = STARTS) -> list[_Reached]:
        """Laws at which searches begin; that of least velocity has a moderate acceleration."""
        is_bounded = any(order == 2 for order, _ in self.task.limits)
        moderate = () if is_bounded else ((2, MODERATE * self.gentle.least),)
        solutions = []
        for order, rms in aims:
            checkpoint()
            limits = (*self.task.limits, *(moderate if order == 1 else ()))
            task = replace(self.task, order=order, rms=rms, limits=limits)
            known = self.gentle if (order, rms) == (2, False) else None
            solutions.append(known or (least_mean if rms else least_peak)(task, self.knots))
        return [self.evaluated(solution.states) for solution in solutions if solution is not None]

    def refined(self, reached: _Reached) -> _Reached:
        """The law whose effect between nodes is no larger."""
        return reached

    def run(self, start: _Reached) -> _Reached:
        """Law of least effect near a law."""
        raise NotImplementedError

    def evaluated(self, states: np.ndarray) -> _Reached:
        """Effects of a law."""
        s = np.array([self.knots.value(states, order, self.points) for order in range(3)])
        effects, partials = self.effect(self.knots.at_span(self.points), s)
        is_finite = np.isfinite(effects).all() and np.isfinite(partials).all()
        if is_finite and math.isnan(self.part):
            first, last = np.abs(effects[0]).max(), np.abs(effects[-1]).max()
            self.part = PENALTY * float(first / last) if last else 0.0
        value = self.size(effects) if is_finite else math.inf
        return _Reached(states, effects, partials, value, value)


class _PeakSearch(_Search):
    """Least peak, by linear programs in a trust region."""

    def nodes(self) -> tuple[Points, np.ndarray]:
        return self._parts(QUARTERS), np.zeros(0)

    def _parts(self, parts: np.ndarray) -> Points:
        """Points at parts of every interval, and the end."""
        n = self.knots.h.size
        points = Points(np.repeat(np.arange(n), parts.size), (self.knots.h[:, None] * parts).ravel())
        return points + self.knots.points.part(np.arange(n + 1) == n)

    def refined(self, reached: _Reached) -> _Reached:
        nodes, dense, present = self.points, self._parts(DENSE), reached
        for _ in range(ROUNDS):
            self.points = dense
            checked = self.evaluated(present.states)
            size, low = np.abs(checked.effects[0]), np.maximum(-checked.effects[1:], 0.0).max(axis=0, initial=0.0)
            is_peak = (size >= np.append(size[1:], 0.0)) & (size >= np.append(0.0, size[:-1]))
            exceeds = is_peak & (size > (1.0 + BETWEEN) * np.abs(present.effects[0]).max())
            exceeds |= low > BETWEEN * np.abs(checked.effects[-1]).max()
            if not exceeds.any() or not 0.0 < checked.value < math.inf:
                break
            self.points = nodes = nodes + dense.part(exceeds)
            vars(self).pop("_at_nodes", None)
            present = self.run(self.evaluated(present.states))
        return replace(checked, least=present.least)

    def size(self, effects: np.ndarray) -> float:
        return float(np.abs(effects[0]).max() + self.part * np.maximum(-effects[1:], 0.0).max(initial=0.0))

    def run(self, start: _Reached) -> _Reached:
        present, m = start, self.knots.m
        if not 0.0 < start.value < math.inf:
            return start
        step = FIRST_STEP * float(np.abs(start.states[:, m]).max())
        smallest = LEAST_STEP * step
        for _ in range(STEPS):
            checkpoint()
            moved = self._moved(present, step)
            if moved is None:  # a law of other knots may exceed a limit
                step *= 4.0
                continue
            states, least = moved
            present = replace(present, least=least)
            gain = present.value - least
            if gain <= LEAST_GAIN * present.value or step < smallest:
                break
            self.limits, exceeds = with_exceeding(self.limits, self.knots, states, 0.0, NEAR)
            if exceeds:
                continue
            following = self.evaluated(states)
            part = (present.value - following.value) / gain
            step *= 2.0 if part > GOOD else 1.0 if part > FAIR else 0.25
            if part > FAIR:
                present = replace(following, least=least)
        return present

    @cached_property
    def _at_nodes(self) -> list[Any]:
        """Sparse matrices that give s, s', s'' at the nodes from the derivatives at the knots."""
        rows = ([Row(order, 1.0, 1.0, (0.0, 1.0), self.points)] for order in range(3))
        return [less_rows(self.knots, row)[0][:, :-1] for row in rows]

    @cached_property
    def _equal(self) -> tuple[Any, np.ndarray]:
        return equal_rows(self.knots, self.knots.u.size * (self.knots.m + 1) + 2)

    def _moved(self, present: _Reached, step: float) -> tuple[np.ndarray, float] | None:
        """Law of the least linearised peak within a trust region, and that peak.

        The last two unknowns are the peak, and how far the second effect is negative.
        """
        from scipy.sparse import csr_array, hstack, vstack  # slow to import

        knots, unit, unknowns = self.knots, present.value, present.states.ravel()
        limits, sides = less_rows(knots, self.limits)
        rows, right = [hstack([limits, csr_array((sides.size, 1))])], [sides]
        for k, (effect, column) in enumerate(zip(present.effects, ((-1.0, 0.0), (0.0, -1.0)), strict=False)):
            slope = sum(
                csr_array((p[k] / unit)[:, None] * matrix)
                for p, matrix in zip(present.partials, self._at_nodes, strict=True)
            )
            scale = 1.0 if k == 0 else self.part
            offset = effect / unit - slope @ unknowns
            last = csr_array(np.tile(column, (effect.size, 1)))
            for sign in (1.0, -1.0) if k == 0 else (-1.0,):
                rows.append(hstack([sign * scale * slope, last]))
                right.append(-sign * scale * offset)
        low, high = np.full(unknowns.size + 2, -np.inf), np.full(unknowns.size + 2, np.inf)
        straight = slice(knots.m, unknowns.size, knots.m + 1)
        low[straight], high[straight] = unknowns[straight] - step, unknowns[straight] + step
        low[-1] = 0.0
        target = np.append(np.zeros(unknowns.size), [1.0, 1.0])
        result = solve(
            target, vstack(rows, format="csr"), np.concatenate(right), *self._equal, np.column_stack([low, high])
        )
        if result.x is None:
            return None
        return knots.corrected(result.x[:-2].reshape(present.states.shape)), unit * float(result.fun)


class _SquareSearch(_Search):
    """Least root mean square, by problems of least distance."""

    def nodes(self) -> tuple[Points, np.ndarray]:
        return self.knots.quadrature(self.knots.m + 2)

    def size(self, effects: np.ndarray) -> float:
        return float(np.sqrt(self.share @ effects[0] ** 2))

    def run(self, start: _Reached) -> _Reached:
        present, knots, weight = start, self.knots, np.sqrt(self.share)
        if not 0.0 < start.value < math.inf:
            return start
        at_nodes = [knots.value(knots.basis, order, self.points) for order in range(3)]
        for _ in range(STEPS):
            checkpoint()
            root = weight[:, None] * sum(
                p[0][:, None] * rows for p, rows in zip(present.partials, at_nodes, strict=True)
            )
            unknowns = np.append(present.states[0, : knots.m], present.states[:, knots.m])
            try:
                solution = least_squares(knots, root, weight * present.effects[0] - root @ unknowns, self.limits)
            except NoOptimalLaw:  # the effect leaves the law undetermined
                solution = None
            if solution is None:
                break
            present = replace(present, least=min(solution.least, present.value))
            if present.value - present.least <= LEAST_GAIN * present.value:
                break
            for k in range(HALVINGS):
                following = self.evaluated(present.states + 0.5**k * (solution.states - present.states))
                if following.value < present.value:
                    break
            else:
                break
            present = replace(following, least=min(present.least, following.value))
        return present
