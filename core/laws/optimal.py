"""Optimal laws: the least peak or mean square of a derivative, within limits on other derivatives.

The law s(u) rises from 0 to 1 over u = 0 ... 1. Its derivative of order m is straight between knots, a B-spline of degree
m + 1, so that the peaks of that derivative are at knots.
A least peak is a linear program, a least mean square one linear system, and with limits a problem of least distance.
Where lower derivatives or the rise exceed a limit between knots, their extremes are added as rows until none does.

Sources: C. de Boor 1978, *A Practical Guide to Splines*; C. L. Lawson, R. J. Hanson 1974, *Solving Least Squares
Problems*, ch. 23.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.laws.knots import Knots, OptimalTask, Points
from core.laws.pieces import Piece
from core.numerics.lazy import checkpoint

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

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
class OptimalLaw:
    """An optimal law.

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
    knots = Knots(task)
    peak = replace(task, rms=False, least_straight=task.straight)
    is_free = not (task.limits or task.bounds)
    is_possible = not task.rms or is_free or _linear_program(knots, limit_rows(peak, knots)) is not None
    solution = (least_mean if task.rms else least_peak)(task, knots) if is_possible else None
    if solution is not None:
        return OptimalLaw(knots.pieces(solution.states), solution.least)
    limits = task.limits
    # the limit that is too small for the others, else for those before it
    trials = [(k, (*limits[:k], *limits[k + 1 :])) for k in range(len(limits))]
    trials += [(k, limits[:k]) for k in reversed(range(len(limits)))]
    for k, others in trials:
        order = limits[k][0]
        least = least_limit(replace(peak, limits=(*others, limits[k])), order)
        if least is not None:
            raise NoOptimalLaw(order, least)
    raise NoOptimalLaw(0, 0.0)


def least_limit(task: OptimalTask, order: int) -> float | None:
    """Least limit of a derivative that a law keeps together with the other limits; None where no law keeps these."""
    others = tuple(limit for limit in task.limits if limit[0] != order)
    return _peak_of_law(replace(task, rms=False, order=order, limits=others, least_straight=task.straight))


@lru_cache(maxsize=64)
def _peak_of_law(task: OptimalTask) -> float | None:
    knots = Knots(task)
    solution = least_peak(task, knots)
    return None if solution is None else knots.peak(solution.states, task.order)


@frozen(eq=False)
class Solution:
    """Derivatives (n + 1, m + 1) at the knots, and the lower bound of what is minimised."""

    states: np.ndarray
    least: float


# -- rows of the inequalities -------------------------------------------------------------------------------------


@frozen(eq=False)
class Row:
    """Points at which sign × derivative is at most a limit, or at most what is minimised where the limit is None."""

    order: int
    sign: float
    limit: float | None
    part: tuple[float, float]
    points: Points


def limit_rows(task: OptimalTask, knots: Knots) -> list[Row]:
    """Rows at the knots, and at the ends of the bounds."""
    peaks: list[tuple[int, float | None]] = [*task.limits, *(() if task.rms else ((task.order, None),))]
    rows = [Row(order, sign, limit, (0.0, 1.0), knots.points) for order, limit in peaks for sign in (1.0, -1.0)]
    rows += [Row(1, -1.0, 0.0, (0.0, 1.0), knots.points)] if task.rising else []
    for low, high, value, sign in task.bounds:
        inside = knots.u[(knots.u > low) & (knots.u < high)]
        rows.append(Row(0, sign, sign * value, (low, high), knots.at(np.array([low, *inside, high]))))
    return rows


def with_exceeding(
    rows: list[Row], knots: Knots, states: np.ndarray, peak: float, near: float
) -> tuple[list[Row], bool]:
    """Rows with the extremes that exceed them, and points near these, and whether there are any.

    Points on either side, at the part ``near`` of the interval, halve the rounds of a linear program.

    Parameters
    ----------
    rows : list of Row
    knots : Knots
    states : ndarray (n + 1, m + 1), dimensionless
        Derivatives of orders 0 ... m at the knots.
    peak : float
        Limit of the rows without one.
    near : float
        Distance from an extreme to the points on either side, as a part of the interval.

    Returns
    -------
    rows : list of Row
    exceeds : bool
    """
    result, exceeds = [], False
    for row in rows:
        points = knots.extremes(states, row.order) + knots.at(np.array(row.part))
        u = knots.at_span(points)
        points = points.part((u >= row.part[0]) & (u <= row.part[1]))
        limit = peak if row.limit is None else row.limit
        excess = row.sign * knots.value(states, row.order, points) - limit
        above = excess > WITHIN * max(abs(limit), 1e-3)
        exceeds |= bool(above.any())
        added = points.part(above)
        width = knots.h[added.interval]
        sides = (
            Points(added.interval, np.clip(added.offset + side * near * width, 0.0, width)) for side in (-1.0, 1.0)
        )
        added = sum(sides, added) if row.order < knots.m and near else added
        at = knots.at_span(added)
        result.append(replace(row, points=row.points + added.part((at >= row.part[0]) & (at <= row.part[1]))))
    return result, exceeds


# -- least peak: a linear program ---------------------------------------------------------------------------------


def least_peak(task: OptimalTask, knots: Knots) -> Solution | None:
    """Law of least peak; None where there is none."""
    rows = limit_rows(task, knots)
    for k in range(ROUNDS):
        checkpoint()
        solution = _linear_program(knots, rows)
        if solution is None:
            return None
        rows, exceeds = with_exceeding(rows, knots, solution.states, solution.least, NEAR * NEARER**k)
        if not exceeds:
            break
    return solution


def _linear_program(knots: Knots, rows: list[Row]) -> Solution | None:
    less, sides = less_rows(knots, rows)
    equal, values = equal_rows(knots, less.shape[1])
    target = np.zeros(less.shape[1])
    target[-1] = 1.0
    result = solve(target, less, sides, equal, values, (None, None))
    if result.x is None:
        return None
    states = knots.corrected(result.x[:-1].reshape(knots.u.size, knots.m + 1))
    less_dual, equal_dual = np.minimum(result.ineqlin.marginals, 0.0), result.eqlin.marginals
    # of unknowns without bounds, the error of the dual's equations costs at most its product with them
    error = np.abs(target - less.T @ less_dual - equal.T @ equal_dual) @ np.abs(result.x)
    return Solution(states, float(sides @ less_dual + values @ equal_dual - error))


def solve(
    target: np.ndarray, less: Any, sides: np.ndarray, equal: Any, values: np.ndarray, bounds: Any
) -> OptimizeResult:
    """Solution of a linear program by the dual simplex method, whose vertices keep the peaks at knots.

    Parameters
    ----------
    target : ndarray (c,), dimensionless
        Weights of the unknowns in what is minimised.
    less : sparse array (r, c)
    sides : ndarray (r,), dimensionless
    equal : sparse array (e, c)
    values : ndarray (e,), dimensionless
    bounds : (float or None, float or None), or ndarray (c, 2), dimensionless

    Returns
    -------
    OptimizeResult
        Without ``x`` where the program has no solution.
    """
    from scipy.optimize import linprog  # slow to import

    for options in ATTEMPTS:
        result = linprog(
            target,
            A_ub=less,
            b_ub=sides,
            A_eq=equal,
            b_eq=values,
            bounds=bounds,
            method="highs-ds",
            options=options,
        )
        if result.status in (SOLVED, INFEASIBLE):
            break
    return result


def less_rows(knots: Knots, rows: list[Row]) -> tuple[Any, np.ndarray]:
    """Limits at the points of rows, as a sparse matrix with its right-hand sides; the last unknown is the peak.

    Parameters
    ----------
    knots : Knots
    rows : list of Row

    Returns
    -------
    matrix : sparse array (r, (n + 1)(m + 1) + 1), dimensionless
    sides : ndarray (r,), dimensionless
    """
    from scipy.sparse import csr_array

    size = knots.u.size * (knots.m + 1) + 1
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
    if not count:
        return csr_array((0, size)), np.zeros(0)
    parts = np.concatenate(weight_of), (np.concatenate(row_of), np.concatenate(column_of))
    return csr_array(parts, shape=(count, size)), np.concatenate(sides)


def equal_rows(knots: Knots, size: int) -> tuple[Any, np.ndarray]:
    """Continuity at the knots, and the equations, as a sparse matrix with its right-hand sides.

    Parameters
    ----------
    knots : Knots
    size : int
        Number of unknowns; those after the derivatives at the knots have no weight.

    Returns
    -------
    matrix : sparse array (e, size), dimensionless
    values : ndarray (e,), dimensionless
    """
    from scipy.sparse import csr_array

    m, n = knots.m, knots.h.size
    row_of, column_of, weight_of = [], [], []
    ends = Points(np.arange(n), knots.h)
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


def least_mean(task: OptimalTask, knots: Knots) -> Solution | None:
    """Law of least root mean square; None where no law keeps the limits."""
    points, share = knots.quadrature(knots.m - task.order + 2)
    root = np.sqrt(share)[:, None] * knots.value(knots.basis, task.order, points)
    return least_squares(knots, root, np.zeros(share.size), limit_rows(task, knots))


def least_squares(knots: Knots, root: np.ndarray, offset: np.ndarray, limits: list[Row]) -> Solution | None:
    """Law of the least |root x + offset| for the unknowns x of the basis; None where no law keeps the limits.

    Parameters
    ----------
    knots : Knots
    root : ndarray (k, m + n + 1), dimensionless
    offset : ndarray (k,), dimensionless
    limits : list of Row

    Returns
    -------
    Solution or None
    """
    equal, values = knots.conditions_of_unknowns()
    given = np.linalg.lstsq(equal, values)[0]
    free = np.linalg.svd(equal)[2][np.linalg.matrix_rank(equal) :].T
    orthogonal, upper = np.linalg.qr(root @ free)
    size = np.abs(np.diag(upper))
    if size.size and size.min() < 1e-13 * size.max():
        raise NoOptimalLaw(0, 0.0)
    fixed = root @ given + offset
    projected = orthogonal.T @ fixed
    constant = float(np.sum(fixed**2) - np.sum(projected**2))
    rows: list[Row] = [
        replace(row, points=row.points.part(np.zeros(row.points.offset.size, dtype=bool))) for row in limits
    ]
    distance, dual = np.zeros(projected.size), 0.0
    for _ in range(ROUNDS):
        unknowns = given + free @ np.linalg.solve(upper, distance - projected)
        states = knots.integrated(unknowns[: knots.m], unknowns[knots.m :])
        rows, exceeds = with_exceeding(rows, knots, states, 0.0, 0.0)
        if not exceeds:
            break
        matrix = np.concatenate([row.sign * knots.value(knots.basis, row.order, row.points) for row in rows])
        limits_of_rows = np.concatenate([np.full(row.points.offset.size, row.limit) for row in rows])
        inverse = np.linalg.solve(upper.T, (matrix @ free).T).T
        nearest = _least_distance(-inverse, matrix @ given - limits_of_rows - inverse @ projected)
        if nearest is None:
            return None
        distance, dual = nearest
    return Solution(states, math.sqrt(max(constant + dual, 0.0)))


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
