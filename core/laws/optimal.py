"""Laws made to measure: the least peak or mean square of a derivative, within limits on other derivatives.

The law s(u) rises from 0 to 1 over u = 0 ... 1. Its derivative of order m is straight between knots, a B-spline of degree
m + 1, so that the peaks of that derivative are at knots. The unknowns are the derivatives of orders 0 ... m at the knots.
A least peak is a linear program, a least mean square one linear system, and with limits a problem of least distance.
Where lower derivatives or the rise exceed a limit between knots, their extremes are added as rows until none does.

Sources: C. de Boor 1978, *A Practical Guide to Splines*; C. L. Lawson, R. J. Hanson 1974, *Solving Least Squares
Problems*, ch. 23.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.laws.pieces import Piece
from core.numerics.roots import gauss

WITHIN = 1e-9  # of a limit: largest excess between knots
HIGHEST = 3  # order of the derivatives that can be limited: jerk
BISECTIONS = 60
ROUNDS = 30  # of added rows
NO_DISTANCE = 1e-13  # of the residual of a problem of least distance without a solution
_TIGHT = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
ATTEMPTS: tuple[dict[str, Any], ...] = (_TIGHT, {**_TIGHT, "presolve": False}, {"presolve": False})
"""Options of the linear program, the next ones where it fails: rows at points close to each other may defeat it."""
SOLVED, INFEASIBLE = 0, 2  # of a linear program
NEAR, NEARER = 0.25, 0.25  # part of an interval from an extreme to further rows, and its factor from round to round


@frozen
class OptimalTask:
    """What a law made to measure must do, normalised to span 1 and rise 1.

    Attributes
    ----------
    order : order of the derivative that is minimised, 1 ... 3
    rms : whether its root mean square is minimised, and not its peak
    limits : (order, largest absolute value) of other derivatives
    conditions : (u, order, value) of derivatives that are given
    periodic : whether velocity and acceleration at the end equal those at the start
    vibration_free : cycles a span of undamped followers that are at rest after it
    bounds : (from, to, value, sign): s at most (sign 1) or at least (sign -1) the value over a part of the span
    intervals : number of equal intervals between knots
    least_straight : least order of the derivative that is straight between knots
    """

    order: int
    rms: bool = False
    limits: tuple[tuple[int, float], ...] = ()
    conditions: tuple[tuple[float, int, float], ...] = ()
    periodic: bool = False
    vibration_free: tuple[float, ...] = ()
    bounds: tuple[tuple[float, float, float, float], ...] = ()
    intervals: int = 60
    least_straight: int = 1

    @property
    def straight(self) -> int:
        """Order m of the derivative that is straight between knots."""
        orders = [order for order, _ in self.limits] + [order for _, order, _ in self.conditions]
        return max(self.least_straight, self.order, 2 * self.order - 2 if self.rms else 0, *orders)


@frozen
class OptimalLaw:
    """A law made to measure.

    Attributes
    ----------
    pieces : the law, between knots
    least : lower bound of the minimised peak or root mean square for these knots, by the dual problem
    """

    pieces: tuple[Piece, ...]
    least: float


class NoOptimalLaw(KindynaError):
    """No law keeps the limits or passes the bounds.

    Attributes
    ----------
    order : order of the derivative whose limit is too small; 0 where bounds, points and ends contradict each other
    least : smallest limit of that derivative that a law keeps
    """

    field = "motion.segments"

    def __init__(self, order: int, least: float) -> None:
        self.order, self.least = order, least
        super().__init__(
            f"motion.segments: no law keeps the limits; the least limit of derivative {order} is {least:.9g}"
            if order
            else "motion.segments: no law meets the points, ends and bounds; remove one"
        )


@lru_cache(maxsize=256)
def optimal_law(task: OptimalTask) -> OptimalLaw:
    """Law of least peak or mean square of a derivative. Raises NoOptimalLaw where there is none."""
    knots = _Knots(task)
    peak = replace(task, rms=False, least_straight=task.straight)
    is_free = not (task.limits or task.bounds)
    is_possible = not task.rms or is_free or _linear_program(knots, _rows(peak, knots)) is not None
    solution = (_least_mean if task.rms else _least_peak)(task, knots) if is_possible else None
    if solution is not None:
        return OptimalLaw(knots.pieces(solution.states), solution.least)
    limits = task.limits
    # the limit that is too small for the others, else for those before it
    trials = [(k, (*limits[:k], *limits[k + 1 :])) for k in range(len(limits))]
    trials += [(k, limits[:k]) for k in reversed(range(len(limits)))]
    for k, others in trials:
        order = limits[k][0]
        solution = _least_peak(replace(peak, order=order, limits=others), knots)
        if solution is not None:
            raise NoOptimalLaw(order, knots.peak(solution.states, order))
    raise NoOptimalLaw(0, 0.0)


# -- derivatives at knots -----------------------------------------------------------------------------------------


@frozen(eq=False)
class _Solution:
    """Derivatives (n + 1, m + 1) at the knots, and the lower bound of what is minimised."""

    states: np.ndarray
    least: float


@frozen(eq=False)
class _Points:
    """Points of the span, each in an interval at a distance from its start."""

    interval: np.ndarray
    offset: np.ndarray

    def __add__(self, more: _Points) -> _Points:
        return _Points(np.append(self.interval, more.interval), np.append(self.offset, more.offset))

    def part(self, selected: np.ndarray) -> _Points:
        return _Points(self.interval[selected], self.offset[selected])


@frozen(eq=False)
class _Equation:
    """Sum of weights times derivatives at the knots = value; a column is knot (m + 1) + order."""

    columns: np.ndarray
    weights: np.ndarray
    value: float


class _Knots:
    """Laws whose derivative of order m is straight between n + 1 knots."""

    def __init__(self, task: OptimalTask) -> None:
        self.m = task.straight
        points = np.unique([0.0, 1.0, *(u for u, _, _ in task.conditions)])
        equal = np.linspace(0.0, 1.0, task.intervals + 1)
        distance = np.abs(equal[:, None] - points).min(axis=1)
        # a knot at a point replaces an equal one close to it
        self.u = np.union1d(points, equal[distance > 0.05 / task.intervals])
        self.h = np.diff(self.u)
        self.equations = [*self._conditions(task), *self._vibration(task)]

    @cached_property
    def points(self) -> _Points:
        """The knots."""
        n = self.h.size
        return _Points(np.minimum(np.arange(n + 1), n - 1), np.append(np.zeros(n), self.h[-1]))

    def at(self, u: np.ndarray) -> _Points:
        """Points at u (k,)."""
        interval = np.clip(np.searchsorted(self.u, u, side="right") - 1, 0, self.h.size - 1)
        return _Points(interval, u - self.u[interval])

    def weights(self, order: int, points: _Points) -> tuple[np.ndarray, np.ndarray]:
        """Columns and weights (k, j) of the derivative of an order at points, by Taylor's series from the knot before."""
        i, w, m = points.interval, points.offset, self.m
        rest = m - order
        terms = [w**k / math.factorial(k) for k in range(rest + 1)]
        columns = [i * (m + 1) + order + k for k in range(rest + 1)]
        slope = w ** (rest + 1) / (math.factorial(rest + 1) * self.h[i])
        columns += [i * (m + 1) + m, (i + 1) * (m + 1) + m]
        return np.stack(columns, axis=1), np.stack([*terms, -slope, slope], axis=1)

    def value(self, states: np.ndarray, order: int, points: _Points) -> np.ndarray:
        """Derivative of an order at points, of states (n + 1, m + 1, ...)."""
        columns, weights = self.weights(order, points)
        rows = states.reshape(-1, *states.shape[2:])[columns]
        return np.asarray(np.einsum("kj,kj...->k...", weights, rows))

    def _conditions(self, task: OptimalTask) -> list[_Equation]:
        result = []
        for u, order, value in task.conditions:
            columns, weights = self.weights(order, self.at(np.array([u])))
            result.append(_Equation(columns.ravel(), weights.ravel(), value))
        last = self.h.size * (self.m + 1)
        for order in range(1, min(self.m, 2) + 1) if task.periodic else ():
            result.append(_Equation(np.array([last + order, order]), np.array([1.0, -1.0]), 0.0))
        return result

    def _vibration(self, task: OptimalTask) -> list[_Equation]:
        """∫ s'' cos ωu du = ∫ s'' sin ωu du = 0 for an undamped follower of ω = 2π cycles."""
        result = []
        for cycles in task.vibration_free:
            omega = 2.0 * math.pi * cycles
            nodes, weight = gauss(self.m + 10 + math.ceil(omega * float(self.h.max())))
            interval = np.repeat(np.arange(self.h.size), nodes.size)
            points = _Points(interval, (self.h[:, None] * nodes).ravel())
            columns, weights = self.weights(2, points)
            u, share = self.u[interval] + points.offset, (self.h[:, None] * weight).ravel()
            size = columns.max() + 1
            for wave in (np.cos, np.sin):
                row = np.bincount(columns.ravel(), (weights * (share * wave(omega * u))[:, None]).ravel(), size)
                result.append(_Equation(np.flatnonzero(row), row[row != 0.0], 0.0))
        return result

    def integrated(self, start: np.ndarray, straight: np.ndarray) -> np.ndarray:
        """Derivatives (n + 1, m + 1, ...) at the knots from those at the start (m, ...), and of order m (n + 1, ...)."""
        m, h = self.m, self.h.reshape(-1, *([1] * (straight.ndim - 1)))
        states = np.empty((straight.shape[0], m + 1, *straight.shape[1:]))
        states[:, m] = straight
        for order in reversed(range(m)):
            rest = m - order
            step = sum(h**k / math.factorial(k) * states[:-1, order + k] for k in range(1, rest + 1))
            step = step + h**rest / math.factorial(rest + 1) * np.diff(straight, axis=0)
            states[:, order] = start[order] + np.concatenate((0.0 * step[:1], np.cumsum(step, axis=0)))
        return states

    @cached_property
    def basis(self) -> np.ndarray:
        """Derivatives at the knots (n + 1, m + 1, m + n + 1) per unknown: those at the start, and that of order m."""
        columns = np.eye(self.m + self.u.size)
        return self.integrated(columns[: self.m], columns[self.m :])

    def conditions_of_unknowns(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows and values of the equations in the unknowns of the basis."""
        basis = self.basis.reshape(-1, self.basis.shape[2])
        rows = np.array([row.weights @ basis[row.columns] for row in self.equations])
        return rows, np.array([row.value for row in self.equations])

    def corrected(self, states: np.ndarray) -> np.ndarray:
        """States that meet all equations to rounding, next to given ones."""
        unknowns = np.append(states[0, : self.m], states[:, self.m])
        rows, values = self.conditions_of_unknowns()
        unknowns = unknowns + np.linalg.lstsq(rows, values - rows @ unknowns)[0]
        return self.integrated(unknowns[: self.m], unknowns[self.m :])

    def zeros(self, states: np.ndarray, order: int) -> _Points:
        """Zeros of a derivative inside the intervals: between those of its derivative it is monotonic."""
        if order > self.m:
            return _Points(np.zeros(0, dtype=int), np.zeros(0))
        turning = self.zeros(states, order + 1)
        u = np.sort(np.append(self.u, self.u[turning.interval] + turning.offset))
        low, high = self.at(u[:-1]), self.at(u[:-1])
        high = _Points(low.interval, np.minimum(low.offset + np.diff(u), self.h[low.interval]))
        first = self.value(states, order, low)
        changes = first * self.value(states, order, high) < 0.0
        low, high, first = low.part(changes), high.part(changes), first[changes]
        left, right = low.offset, high.offset
        for _ in range(BISECTIONS if left.size else 0):
            middle = 0.5 * (left + right)
            is_left = self.value(states, order, _Points(low.interval, middle)) * first > 0.0
            left, right = np.where(is_left, middle, left), np.where(is_left, right, middle)
        return _Points(low.interval, 0.5 * (left + right))

    def extremes(self, states: np.ndarray, order: int) -> _Points:
        """Points among which a derivative has its extremes: the knots, and the zeros of its derivative."""
        return self.points + self.zeros(states, order + 1) if order < self.m else self.points

    def peak(self, states: np.ndarray, order: int) -> float:
        """Largest absolute value of a derivative."""
        return float(np.abs(self.value(states, order, self.extremes(states, order))).max())

    def pieces(self, states: np.ndarray) -> tuple[Piece, ...]:
        """The law as polynomials between knots."""
        factors = np.array([1.0 / math.factorial(k) for k in range(self.m + 2)])
        slope = np.diff(states[:, self.m]) / self.h
        rows = (np.column_stack((states[:-1], slope)) * factors).tolist()
        return tuple(Piece(start, tuple(row)) for start, row in zip(self.u[:-1].tolist(), rows, strict=True))


# -- rows of the inequalities -------------------------------------------------------------------------------------


@frozen(eq=False)
class _Row:
    """Points at which sign × derivative is at most a limit, or at most what is minimised where the limit is None."""

    order: int
    sign: float
    limit: float | None
    part: tuple[float, float]
    points: _Points


def _rows(task: OptimalTask, knots: _Knots) -> list[_Row]:
    """Rows at the knots, and at the ends of the bounds."""
    peaks: list[tuple[int, float | None]] = [*task.limits, *(() if task.rms else ((task.order, None),))]
    rows = [_Row(order, sign, limit, (0.0, 1.0), knots.points) for order, limit in peaks for sign in (1.0, -1.0)]
    for low, high, value, sign in task.bounds:
        inside = knots.u[(knots.u > low) & (knots.u < high)]
        rows.append(_Row(0, sign, sign * value, (low, high), knots.at(np.array([low, *inside, high]))))
    return rows


def _with_exceeding(
    rows: list[_Row], knots: _Knots, states: np.ndarray, peak: float, near: float
) -> tuple[list[_Row], bool]:
    """Rows with the extremes that exceed them, and points near these, and whether there are any.

    Points on either side, at the part ``near`` of the interval, halve the rounds of a linear program.
    """
    result, exceeds = [], False
    for row in rows:
        points = knots.extremes(states, row.order) + knots.at(np.array(row.part))
        u = knots.u[points.interval] + points.offset
        points = points.part((u >= row.part[0]) & (u <= row.part[1]))
        limit = peak if row.limit is None else row.limit
        excess = row.sign * knots.value(states, row.order, points) - limit
        above = excess > WITHIN * max(abs(limit), 1e-3)
        exceeds |= bool(above.any())
        added = points.part(above)
        width = knots.h[added.interval]
        sides = (
            _Points(added.interval, np.clip(added.offset + side * near * width, 0.0, width)) for side in (-1.0, 1.0)
        )
        added = sum(sides, added) if row.order < knots.m and near else added
        at = knots.u[added.interval] + added.offset
        result.append(replace(row, points=row.points + added.part((at >= row.part[0]) & (at <= row.part[1]))))
    return result, exceeds


# -- least peak: a linear program ---------------------------------------------------------------------------------


def _least_peak(task: OptimalTask, knots: _Knots) -> _Solution | None:
    """Law of least peak; None where there is none."""
    rows = _rows(task, knots)
    for k in range(ROUNDS):
        solution = _linear_program(knots, rows)
        if solution is None:
            return None
        rows, exceeds = _with_exceeding(rows, knots, solution.states, solution.least, NEAR * NEARER**k)
        if not exceeds:
            break
    return solution


def _linear_program(knots: _Knots, rows: list[_Row]) -> _Solution | None:
    from scipy.optimize import linprog  # slow to import
    from scipy.sparse import csr_array

    m, n = knots.m, knots.h.size
    size = (n + 1) * (m + 1) + 1  # the last unknown is the peak
    row_of, column_of, weight_of, sides, count = [], [], [], [], 0
    for row in rows:
        columns, weights = knots.weights(row.order, row.points)
        at = count + np.arange(columns.shape[0])
        scale = 1.0 / max(abs(row.limit), 1e-3) if row.limit is not None else 1.0
        row_of.append(np.repeat(at, columns.shape[1]))
        column_of.append(columns.ravel())
        weight_of.append(scale * row.sign * weights.ravel())
        if row.limit is None:
            row_of.append(at)
            column_of.append(np.full(at.size, size - 1))
            weight_of.append(np.full(at.size, -1.0))
        sides.append(np.full(at.size, 0.0 if row.limit is None else scale * row.limit))
        count += at.size
    less = csr_array(
        (np.concatenate(weight_of), (np.concatenate(row_of), np.concatenate(column_of))), shape=(count, size)
    )
    equal, values = _equal_rows(knots, size)
    target = np.zeros(size)
    target[-1] = 1.0
    for options in ATTEMPTS:
        result = linprog(
            target,
            A_ub=less,
            b_ub=np.concatenate(sides),
            A_eq=equal,
            b_eq=values,
            bounds=(None, None),
            method="highs-ds",
            options=options,
        )
        if result.status in (SOLVED, INFEASIBLE):
            break
    if result.x is None:
        return None
    states = knots.corrected(result.x[:-1].reshape(n + 1, m + 1))
    less_dual, equal_dual = np.minimum(result.ineqlin.marginals, 0.0), result.eqlin.marginals
    # of unknowns without bounds, the error of the dual's equations costs at most its product with them
    error = np.abs(target - less.T @ less_dual - equal.T @ equal_dual) @ np.abs(result.x)
    return _Solution(states, float(np.concatenate(sides) @ less_dual + values @ equal_dual - error))


def _equal_rows(knots: _Knots, size: int) -> tuple[Any, np.ndarray]:
    """Continuity at the knots, and the equations, as a sparse matrix with its right-hand sides."""
    from scipy.sparse import csr_array

    m, n = knots.m, knots.h.size
    row_of, column_of, weight_of = [], [], []
    ends = _Points(np.arange(n), knots.h)
    for order in range(m):
        columns, weights = knots.weights(order, ends)
        at = order * n + np.arange(n)
        row_of += [np.repeat(at, columns.shape[1]), at]
        column_of += [columns.ravel(), np.arange(1, n + 1) * (m + 1) + order]
        weight_of += [weights.ravel(), np.full(n, -1.0)]
    for k, equation in enumerate(knots.equations):
        row_of.append(np.full(equation.columns.size, m * n + k))
        column_of.append(equation.columns)
        weight_of.append(equation.weights)
    count = m * n + len(knots.equations)
    values = np.append(np.zeros(m * n), [equation.value for equation in knots.equations])
    parts = np.concatenate(weight_of), (np.concatenate(row_of), np.concatenate(column_of))
    return csr_array(parts, shape=(count, size)), values


# -- least mean square ------------------------------------------------------------------------------------------


def _least_mean(task: OptimalTask, knots: _Knots) -> _Solution | None:
    """Law of least root mean square; None where no law keeps the limits."""
    nodes, weight = gauss(knots.m - task.order + 2)
    interval = np.repeat(np.arange(knots.h.size), nodes.size)
    points = _Points(interval, (knots.h[:, None] * nodes).ravel())
    root = np.sqrt((knots.h[:, None] * weight).ravel())[:, None] * knots.value(knots.basis, task.order, points)
    equal, values = knots.conditions_of_unknowns()
    given = np.linalg.lstsq(equal, values)[0]
    free = np.linalg.svd(equal)[2][np.linalg.matrix_rank(equal) :].T
    orthogonal, upper = np.linalg.qr(root @ free)
    size = np.abs(np.diag(upper))
    if size.size and size.min() < 1e-13 * size.max():
        raise NoOptimalLaw(0, 0.0)
    projected = orthogonal.T @ (root @ given)
    constant = float(np.sum((root @ given) ** 2) - np.sum(projected**2))
    rows: list[_Row] = [
        replace(row, points=row.points.part(np.zeros(row.points.offset.size, dtype=bool))) for row in _rows(task, knots)
    ]
    distance, dual = np.zeros(projected.size), 0.0
    for _ in range(ROUNDS):
        unknowns = given + free @ np.linalg.solve(upper, distance - projected)
        states = knots.integrated(unknowns[: knots.m], unknowns[knots.m :])
        rows, exceeds = _with_exceeding(rows, knots, states, 0.0, 0.0)
        if not exceeds:
            break
        matrix = np.concatenate([row.sign * knots.value(knots.basis, row.order, row.points) for row in rows])
        limits = np.concatenate([np.full(row.points.offset.size, row.limit) for row in rows])
        inverse = np.linalg.solve(upper.T, (matrix @ free).T).T
        nearest = _least_distance(-inverse, matrix @ given - limits - inverse @ projected)
        if nearest is None:
            return None
        distance, dual = nearest
    return _Solution(states, math.sqrt(max(constant + dual, 0.0)))


def _least_distance(matrix: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, float] | None:
    """Shortest x with matrix x >= sides, and the dual value of |x|²; None where there is none (Lawson, Hanson, ch. 23)."""
    from scipy.optimize import nnls  # slow to import

    size = np.linalg.norm(matrix, axis=1)
    size[size == 0.0] = 1.0
    matrix, sides = matrix / size[:, None], sides / size
    extended = np.vstack((matrix.T, sides))
    target = np.append(np.zeros(matrix.shape[1]), 1.0)
    weights, _ = nnls(extended, target, maxiter=50 * sides.size)
    residual = extended @ weights - target
    if -residual[-1] < NO_DISTANCE:
        return None
    weights /= -residual[-1]
    distance = matrix.T @ weights
    return distance, float(2.0 * sides @ weights - distance @ distance)
