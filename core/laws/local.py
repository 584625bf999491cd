"""Optimal laws of a machine: the least peak or mean square of an effect that is known by its values only.

The effect depends on s, s', s''. Every step of a search minimises its linearisation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from core.frozen import frozen
from core.laws.knots import Knots, OptimalTask, Points
from core.laws.optimal import (
    NEAR,
    NoOptimalLaw,
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
    searched = task if task.rms else replace(task, intervals=min(task.intervals, COARSE))
    family = _family(searched) or _family(task)
    if family is None:
        optimal_law(replace(task, rms=False))  # says which limit no law keeps
        raise NoOptimalLaw(0, 0.0)
    search = _search(family, effect)
    runs = [(start, search.run(start)) for start in search.starts(STARTS)]
    reached = [end for _, end in runs]
    if family.knots.h.size < task.intervals and (finer := _family(task)) is not None:
        search = _search(finer, effect)
        near = search.evaluated(finer.knots.resampled(family.knots, min(reached, key=_value).states))
        reached = [search.run(min([near, *search.starts(STARTS[:2])], key=_value))]
    best = search.refined(min(reached, key=_value))
    return LocalLaw(
        search.knots.pieces(best.states), best.value, best.least, tuple((start.value, end.value) for start, end in runs)
    )


class _Family:
    """Laws that satisfy a task, and those of least derivatives among them; they do not depend on the effect."""

    def __init__(self, task: OptimalTask, knots: Knots, gentle: Solution) -> None:
        self.task, self.knots, self._gentle = task, knots, gentle
        self._starts: dict[tuple[int, bool], Solution | None] = {(2, False): gentle}

    def start(self, order: int, rms: bool) -> Solution | None:
        """Law of a least derivative; that of least velocity has a moderate acceleration."""
        if (order, rms) in self._starts:
            return self._starts[order, rms]
        is_bounded = any(bounded == 2 for bounded, _ in self.task.limits)
        moderate = ((2, MODERATE * self._gentle.least),) if order == 1 and not is_bounded else ()
        task = replace(self.task, order=order, rms=rms, limits=(*self.task.limits, *moderate))
        result = self._starts[order, rms] = (least_mean if rms else least_peak)(task, self.knots)
        return result

    @cached_property
    def equal(self) -> tuple[Any, np.ndarray]:
        """Equations of a step: the unknowns are the derivatives at the knots, the peak, and how far it is below 0."""
        return equal_rows(self.knots, self.knots.u.size * (self.knots.m + 1) + 2)


@lru_cache(maxsize=32)
def _family(task: OptimalTask) -> _Family | None:
    """Laws of a task, which do not reverse where that is possible; None where there are none."""
    knots = Knots(replace(task, rms=False))
    for limited in (replace(task, rising=True), task):
        gentle = least_peak(replace(limited, order=2, rms=False), knots)
        if gentle is not None:
            return _Family(limited, knots, gentle)
    return None


def _search(family: _Family, effect: Effect) -> _Search:
    return (_SquareSearch if family.task.rms else _PeakSearch)(family, effect)


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

    def __init__(self, family: _Family, effect: Effect) -> None:
        self.family, self.knots, self.effect = family, family.knots, effect
        self.limits = limit_rows(replace(family.task, rms=True), self.knots)
        self.points, self.share = self.nodes()
        self.part = math.nan
        """Weight of a negative second effect, by the effects of the first law."""

    def nodes(self) -> tuple[Points, np.ndarray]:
        """Nodes (k,), and their weights in the mean."""
        raise NotImplementedError

    def size(self, effects: np.ndarray) -> float:
        """What is minimised of effects (r, k) at the nodes."""
        raise NotImplementedError

    def starts(self, aims: Sequence[tuple[int, bool]]) -> list[_Reached]:
        """Laws at which searches begin."""
        solutions = [self.family.start(order, rms) for order, rms in aims]
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
        is_outside = False  # the present law may exceed a limit between knots: any next one replaces it
        for _ in range(STEPS):
            checkpoint()
            linearised = self._linearised_optimum(present, step)
            if linearised is None:  # no law within the limits is this near
                step *= 4.0
                continue
            states, least = linearised
            gain = present.value - least
            if not is_outside and (gain <= LEAST_GAIN * present.value or step < smallest):
                present = replace(present, least=least)
                self.limits, is_outside = with_exceeding(self.limits, self.knots, present.states, 0.0, NEAR)
                if not is_outside:
                    break
                continue
            following = self.evaluated(states)
            part = 1.0 if is_outside else (present.value - following.value) / gain
            step *= 2.0 if part > GOOD else 1.0 if part > FAIR else 0.25
            if part > FAIR:
                present, is_outside = replace(following, least=least), False
        return present

    @cached_property
    def _at_nodes(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Columns and weights (k, j) that give s, s', s'' at the nodes from the derivatives at the knots."""
        return [self.knots.weights(order, self.points) for order in range(3)]

    def _linearised_optimum(self, present: _Reached, step: float) -> tuple[np.ndarray, float] | None:
        """Law of the least linearised peak within a trust region, and that peak."""
        from scipy.sparse import csr_array, vstack  # slow to import

        knots, unit, unknowns = self.knots, present.value, present.states.ravel()
        count = unknowns.size + 2
        rows, sides = [], []
        if self.limits:
            limits, right = less_rows(knots, self.limits)
            limits.resize((right.size, count))
            rows, sides = [limits], [right]
        columns = np.hstack([column for column, _ in self._at_nodes])
        k = columns.shape[0]
        # each effect with its scale, its signs, and the unknown that bounds it
        for i, (scale, signs) in enumerate(((1.0, (1.0, -1.0)), (self.part, (-1.0,)))[: present.effects.shape[0]]):
            parts = zip(present.partials[:, i], self._at_nodes, strict=True)
            slope = scale / unit * np.hstack([p[:, None] * weights for p, (_, weights) in parts])
            offset = scale / unit * present.effects[i] - (slope * unknowns[columns]).sum(axis=1)
            for sign in signs:
                data = np.hstack([sign * slope, np.full((k, 1), -1.0)])
                at = np.hstack([columns, np.full((k, 1), unknowns.size + i)])
                row_starts = np.arange(0, data.size + 1, data.shape[1])
                rows.append(csr_array((data.ravel(), at.ravel(), row_starts), shape=(k, count)))
                sides.append(-sign * offset)
        low, high = np.full(count, -np.inf), np.full(count, np.inf)
        straight = slice(knots.m, unknowns.size, knots.m + 1)
        low[straight], high[straight] = unknowns[straight] - step, unknowns[straight] + step
        low[-1] = 0.0
        target = np.append(np.zeros(unknowns.size), [1.0, 1.0])
        less = vstack(rows, format="csr")
        less.sum_duplicates()
        result = solve(target, less, np.concatenate(sides), *self.family.equal, np.column_stack([low, high]))
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
