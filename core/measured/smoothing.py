"""Curves of least jerk within the errors of their rows: weighted least squares over the states at knots.

    minimise  Σ_k Σ_i ((y_ki - s⁽ᵏ⁾(x_i))/σ_k)² + λ ∫ s'''²

over curves that are quintics between knots, with s, s', s'' at each (``laws.polynomial``); λ so that the mean square is
1 (Reinsch 1967), or less where the only error is the rounding of many digits. Known values at an end hold exactly. The
equations are banded, so that the cost is linear in rows and knots.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import log, log10, sqrt
from typing import Any

import numpy as np

from core.frozen import frozen
from core.laws.polynomial import STATES, jerk_rows, least_jerk_states, quintics
from core.measured.table import MeasuredTable, distinct_angles
from core.numerics.lazy import checkpoint

# -- splines of least jerk over one turn, in diagonal coordinates -----------------------------------------------


SPLINES_AT_ONCE = 240  # splines, or knots, that are computed together, which bounds the memory
CLOSE = 0.05  # least distance of knots relative to the typical distance


def choose_knots(angles: np.ndarray, most: int) -> np.ndarray:
    """Knots among the cam angles of a table, as dense as its rows, without very close ones.

    Parameters
    ----------
    angles : ndarray (n,) [deg]
    most : int
        Greatest number of knots.

    Returns
    -------
    ndarray (m,) [deg]
    """
    x, _ = distinct_angles(angles)
    if x.size > most:
        x = x[(np.arange(most) * x.size) // most]
    width = np.diff(np.append(x, x[0] + 360.0))
    return x[np.append(True, width[:-1] > CLOSE * float(np.median(width)))]


def given_order(order: int) -> int:
    """Order of the derivative that is given at the knots of a spline for a table of s⁽ᵏ⁾.

    For accelerations positions are given: a curve of least jerk through accelerations has polygons as accelerations.
    """
    return order if order < 2 else 0


def natural(knots: np.ndarray, order: int, given: np.ndarray) -> np.ndarray:
    """States of the natural splines with given values at the knots, by u = angle/360.

    Parameters
    ----------
    knots : ndarray (m,) [deg]
    order : int
        Order of the given derivative; positions instead of accelerations, see ``given_order``.
    given : ndarray (m, r) [unit of the motion]
        Values at the knots; a displacement must be 0 at the first one.

    Returns
    -------
    ndarray (m, 3, r) [unit of the motion]
        s, s', s''.
    """
    order = given_order(order)
    fixed = np.zeros((knots.size, STATES), dtype=bool)
    fixed[:, order], fixed[0, 0] = True, True
    result = np.empty((knots.size, STATES, given.shape[1]))
    for first in range(0, given.shape[1], SPLINES_AT_ONCE):
        part = given[:, first : first + SPLINES_AT_ONCE]
        known_states = np.zeros((knots.size, STATES, part.shape[1]))
        known_states[:, order] = part
        result[:, :, first : first + SPLINES_AT_ONCE] = least_jerk_states(distances(knots), known_states, fixed)
    return result


def distances(knots: np.ndarray) -> np.ndarray:
    """Distance of each knot to the next around the turn.

    Parameters
    ----------
    knots : ndarray (m,) [deg]

    Returns
    -------
    ndarray (m,), dimensionless
        Fraction of the turn.
    """
    return np.diff(np.append(knots, knots[0] + 360.0)) / 360.0


def derivative(knots: np.ndarray, at: np.ndarray, order: int, angles: np.ndarray) -> np.ndarray:
    """Derivative s⁽ᵏ⁾ by u = angle/360 of curves with given states.

    Parameters
    ----------
    knots : ndarray (m,) [deg]
    at : ndarray (m, 3, r) [unit of the motion]
        States at the knots.
    order : int
        Order k.
    angles : ndarray (n,) [deg]

    Returns
    -------
    ndarray (n, r) [unit of the motion]
    """
    return np.asarray(_by_states(knots, order, angles) @ at.reshape(STATES * knots.size, -1))


def _by_states(knots: np.ndarray, order: int, angles: np.ndarray) -> Any:
    """Sparse matrix (n, 3m) from the states at the knots to s⁽ᵏ⁾ by u at cam angles."""
    from scipy.sparse import csr_array

    m, n = knots.size, angles.size
    piece = (np.searchsorted(knots, angles, side="right") - 1).astype(np.int32)  # half the memory of a long table
    w = np.mod(angles - knots[piece], 360.0) / 360.0
    unit_states = np.broadcast_to(
        np.eye(2 * STATES), (m, 2 * STATES, 2 * STATES)
    )  # a curve for each state at either end
    rows = quintics(distances(knots), unit_states[:, :STATES], unit_states[:, STATES:])
    values = np.zeros((n, 2 * STATES))
    for power in range(5, order - 1, -1):  # Horner
        falling = float(np.prod(np.arange(power - order + 1, power + 1)))
        values = values * w[:, None] + falling * rows[piece, power]
    columns = STATES * np.stack((piece % m, (piece + 1) % m), axis=1)[:, :, None] + np.arange(STATES, dtype=np.int32)
    ends = np.arange(0, values.size + 1, 2 * STATES, dtype=np.int32)
    return csr_array((values.ravel(), columns.ravel(), ends), shape=(n, STATES * m))


@frozen(eq=False)
class SplineBasis:
    """Rows of a table in the diagonal coordinates of its splines.

    Attributes
    ----------
    knots : ndarray (m,) [deg]
    order : order of the measured derivative
    values : ndarray (n,) [unit of the motion], by u = angle/360
    at : ndarray (m, 3, r) [unit of the motion]
        States at the knots of each coordinate's curve.
    seen : ndarray (r,), dimensionless
        Share of a coordinate that the rows determine, 0 ... 1; the rest, 1 - seen, is its jerk times ``scale``.
    projection : ndarray (r,) [unit of the motion]
        Projection of the rows on each coordinate.
    mean : ndarray (r,) [unit of the motion]
        Mean of each coordinate over the rows.
    scale : λ at which rows and jerk have the same mean weight
    least : mean square of the part that no curve with these knots has
    """

    knots: np.ndarray
    order: int
    values: np.ndarray
    at: np.ndarray
    seen: np.ndarray
    projection: np.ndarray
    mean: np.ndarray
    scale: float
    least: float

    def weights(self, smoothing: float | np.ndarray) -> np.ndarray:
        """Coordinates of the curve for λ.

        Parameters
        ----------
        smoothing : float or ndarray (...,), dimensionless
            λ.

        Returns
        -------
        ndarray (..., r), dimensionless
        """
        stiff = np.asarray(smoothing)[..., None] / self.scale
        return self.projection / (self.seen + stiff * (1.0 - self.seen))

    def mean_square(self, smoothing: float | np.ndarray) -> np.ndarray:
        """Mean square of the residuals for λ, which increases with λ.

        Parameters
        ----------
        smoothing : float or ndarray (...,), dimensionless
            λ.

        Returns
        -------
        ndarray (...,) [(unit of the motion)²]
        """
        stiff = np.asarray(smoothing)[..., None] / self.scale * (1.0 - self.seen)
        with np.errstate(divide="ignore", invalid="ignore"):
            part = self.projection**2 / self.seen * (stiff / (self.seen + stiff)) ** 2
        return self.least + np.where(self.seen > 0.0, part, 0.0).sum(axis=-1)

    def freedom(self, smoothing: float | np.ndarray) -> np.ndarray:
        """Number of free values of the curve for λ: trace of the matrix from rows to curve, with the constant.

        Parameters
        ----------
        smoothing : float or ndarray (...,), dimensionless
            λ.

        Returns
        -------
        ndarray (...,), dimensionless
        """
        stiff = np.asarray(smoothing)[..., None] / self.scale * (1.0 - self.seen)
        return 1.0 + (self.seen / (self.seen + stiff)).sum(axis=-1)


def _stiffness(knots: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Matrix (r, r) of ∫ of the product of the jerks of two curves with these states."""
    width, following = distances(knots), np.append(np.arange(1, knots.size), 0)
    result = np.zeros((at.shape[2], at.shape[2]))
    for first in range(0, knots.size, SPLINES_AT_ONCE):
        some = slice(first, first + SPLINES_AT_ONCE)
        jerk = jerk_rows(width[some], at[some], at[following[some]]).reshape(-1, at.shape[2])
        result += jerk.T @ jerk
    return result


@lru_cache(maxsize=8)
def basis(table: MeasuredTable, most: int, left_out: tuple[int, ...] = ()) -> SplineBasis:
    """Basis of the rows of a table without those left out, with at most ``most`` knots; values by u = angle/360."""
    used = table.used_rows(left_out)
    angles, order = table.angles[used], table.layout.order
    y = table.values[used] * 360.0**order
    knots = choose_knots(angles, most)
    unit_values = np.eye(knots.size)[:, 1 - given_order(order) :]
    at = natural(knots, order, unit_values)
    rows, states_of = (
        _by_states(knots, order, angles),
        at.reshape(-1, unit_values.shape[1]),
    )  # their product would have n m elements
    mean = rows.mean(axis=0) @ states_of
    square = states_of.T @ ((rows.T @ rows) @ states_of) / used.size - np.outer(
        mean, mean
    )  # the constant removes the mean
    normal, stiff = 0.5 * (square + square.T), _stiffness(knots, at)
    scale = float(np.trace(normal) / np.trace(stiff))
    half = np.linalg.inv(np.linalg.cholesky(normal + scale * stiff))
    unseen, turn = np.linalg.eigh(half @ (scale * stiff) @ half.T)
    turn = half.T @ turn
    seen = np.clip(1.0 - unseen, 0.0, 1.0)
    seen[seen < 1e-13] = 0.0
    deviation = y - y.mean()
    projection = np.where(seen > 0.0, turn.T @ (states_of.T @ (rows.T @ deviation)) / used.size, 0.0)
    best = turn @ np.divide(projection, seen, out=np.zeros_like(projection), where=seen > 0.0)
    exact = rows @ (states_of @ best) - mean @ best
    least = float(np.mean((deviation - exact) ** 2))
    coordinates = (at.reshape(-1, turn.shape[0]) @ turn).reshape(at.shape)  # one product for all knots
    return SplineBasis(knots, order, y, coordinates, seen, projection, mean @ turn, scale, least)


# -- least jerk over an interval of rows ------------------------------------------------------------------------


FEWEST, MOST = 12, 3000  # steps between knots
STIFF = 1e-6  # least weight of the jerk, which determines the curve where no rows are; less for smaller relative errors
FINE, MET = (
    1e-6,
    6.0,
)  # relative error, below which it is rounding, and residual in errors to which such rows are fitted
ROWS_AT_ONCE = 20_000  # rows whose equations are assembled together
_BAND = 2 * STATES


@frozen(eq=False)
class SmoothCurve:
    """Curve of an interval.

    Attributes
    ----------
    knots : ndarray (m,) [deg]
    states : ndarray (m, 3) [unit of the motion, per deg, per deg²]
    left : root mean square of the residuals in errors
    freedom : number of free values of the curve
    smoothing : λ by degrees, with the σ of the displacement as a factor
    """

    knots: np.ndarray
    states: np.ndarray
    left: float
    freedom: float
    smoothing: float


End = Sequence[float | None]
"""s, s', s'' at an end; None where unknown."""


def smooth(
    x: np.ndarray,
    values: Mapping[int, np.ndarray],
    errors: Mapping[int, float],
    start: float,
    end: float,
    ends: tuple[End, End],
) -> SmoothCurve:
    """Curve of least jerk within the errors, between two cam angles.

    Parameters
    ----------
    x : ndarray (n,) [deg]
        Cam angles of the rows.
    values : Mapping of int to ndarray (n,) [unit of the motion per deg^order]
        Values of each derivative, NaN where there is none.
    errors : Mapping of int to float
        Error of each derivative.
    start, end : float [deg]
    ends : tuple of two End
        Known states at start and end.

    Returns
    -------
    SmoothCurve

    References
    ----------
    Reinsch 1967, Smoothing by spline functions.
    """
    from scipy.optimize import brentq

    count = sum(int(np.isfinite(y).sum()) for y in values.values())
    greatest = min(MOST, max(x.size // 2, 1))
    steps, is_last = min(FEWEST, greatest), False
    while True:
        checkpoint()
        system = _System(x, values, errors, np.linspace(start, end, steps + 1), ends)
        states, left = system.solve(0.0)
        if is_last or steps >= greatest:
            break
        is_last = left <= count + 2.0 * sqrt(2.0 * count)  # one more doubling, so that the jerk determines the curve
        steps = min(2 * steps, greatest)
    finite = [(order, y[np.isfinite(y)]) for order, y in values.items() if np.isfinite(y).any()]
    least = max(min([STIFF, *(errors[order] / (float(np.ptp(y)) or 1.0) for order, y in finite)]), 1e-14)
    weight = least
    if left < count:

        def excess(power: float) -> float:
            checkpoint()
            return log(max(system.solve(10.0**power)[1], 1e-300) / count)

        low, high = log10(least), 14.0
        weight = 10.0 ** (
            high if excess(high) < 0.0 else float(brentq(excess, low, high, xtol=1e-9)) if excess(low) < 0.0 else low
        )
    states, left = system.solve(weight)
    order = min(values)
    fine = errors[order] <= FINE * float(np.nanmax(np.abs(values[order]), initial=0.0))
    while fine and weight > least and system.largest(states) > MET:
        weight = max(0.1 * weight, least)
        states, left = system.solve(weight)
    return SmoothCurve(system.knots, states, sqrt(left / max(count, 1)), system.freedom(weight), weight * system.scale)


class _System:
    """Banded normal equations of the rows and of the jerk, in states scaled by powers of the distance of the knots."""

    def __init__(
        self,
        x: np.ndarray,
        values: Mapping[int, np.ndarray],
        errors: Mapping[int, float],
        knots: np.ndarray,
        ends: tuple[End, End],
    ) -> None:
        self.knots, self.h = knots, float(knots[1] - knots[0])
        self.size = self.h ** -np.arange(STATES)  # of a state with scaled value 1
        n = STATES * knots.size
        self.rows, self.side = np.zeros((_BAND, n)), np.zeros(n)
        self.least: tuple[np.ndarray, float] | None = None
        self.row_equations: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        m = knots.size - 1
        unit_states = np.eye(_BAND)[None] * np.tile(self.size, 2)[:, None]
        table = quintics(np.array([self.h]), unit_states[:, :STATES], unit_states[:, STATES:])[
            0
        ]  # (6 powers, 6 states)
        piece = np.clip(((x - knots[0]) / self.h).astype(int), 0, m - 1)
        for order, y in values.items():
            finite = np.flatnonzero(np.isfinite(y))
            for first in range(0, finite.size, ROWS_AT_ONCE):
                at = finite[first : first + ROWS_AT_ONCE]
                w, i, right = x[at] - knots[piece[at]], piece[at], y[at] / errors[order]
                powers = np.zeros((at.size, 6))
                for power in range(order, 6):
                    powers[:, power] = np.prod(np.arange(power - order + 1, power + 1)) * w ** (power - order)
                equations = powers @ table / errors[order]
                self._add(i, equations, right)
                self.row_equations.append((i, equations, right))
        # ∫ s'''² is equal for every piece; it is scaled to the weight of the rows
        jerk = jerk_rows(np.array([self.h]), unit_states[:, :STATES], unit_states[:, STATES:])[0]
        block, self.jerk = jerk.T @ jerk, np.zeros((_BAND, n))
        for a in range(_BAND):
            for b in range(a + 1):
                self.jerk[a - b, STATES * np.arange(m) + b] += block[a, b]
        self.scale = float(self.rows[0].sum() / self.jerk[0].sum())
        self.fixed, self.known = np.zeros(n, dtype=bool), np.zeros(n)
        for index, end in ((0, ends[0]), (n - STATES, ends[1])):
            for k, value in enumerate(end):
                if value is not None:
                    self.fixed[index + k], self.known[index + k] = True, value / self.size[k]

    def _add(self, piece: np.ndarray, equations: np.ndarray, right: np.ndarray) -> None:
        for a in range(_BAND):
            self.side += np.bincount(STATES * piece + a, equations[:, a] * right, minlength=self.side.size)
            for b in range(a + 1):
                self.rows[a - b] += np.bincount(
                    STATES * piece + b, equations[:, a] * equations[:, b], minlength=self.side.size
                )

    def _matrix(self, weight: float) -> tuple[np.ndarray, np.ndarray]:
        band = self.rows + weight * self.scale * self.jerk
        right = self.side - _times(band, self.known)
        right[self.fixed] = self.known[self.fixed]
        band = band.copy()
        for diagonal in range(_BAND):
            n = band.shape[1] - diagonal
            band[diagonal, :n][self.fixed[:n] | self.fixed[diagonal:]] = 0.0
        tiny = 1e-13 * float(band[0].max())
        band[0] = np.where(self.fixed, 1.0, band[0] + tiny)  # for states without rows
        return band, right

    def solve(self, weight: float) -> tuple[np.ndarray, float]:
        """States (m, 3) by degrees, and the sum of squared residuals; the first call must have weight 0."""
        from scipy.linalg import solveh_banded

        band, right = self._matrix(weight)
        solution = solveh_banded(band, right, lower=True, check_finite=False)
        if (
            self.least is None
        ):  # the curve of the rows alone; the residuals of others increase with their distance to it
            left, columns = 0.0, np.arange(_BAND)
            for piece, equations, target in self.row_equations:
                residuals = target - (equations * solution[STATES * piece[:, None] + columns]).sum(axis=1)
                left += float(residuals @ residuals)
            self.least = solution, left
        distance = solution - self.least[0]
        return solution.reshape(-1, STATES) * self.size, self.least[1] + float(distance @ _times(self.rows, distance))

    def largest(self, states: np.ndarray) -> float:
        """Largest residual of the rows, in errors.

        Parameters
        ----------
        states : ndarray (m, 3) [unit of the motion, per deg, per deg²]

        Returns
        -------
        float
        """
        scaled, columns = (states / self.size).ravel(), np.arange(_BAND)
        return max(
            float(np.abs(right - (equations * scaled[STATES * piece[:, None] + columns]).sum(axis=1)).max(initial=0.0))
            for piece, equations, right in self.row_equations
        )

    def freedom(self, weight: float) -> float:
        """Trace of the matrix from rows to curve."""
        from scipy.linalg import cho_solve_banded, cholesky_banded

        band, _ = self._matrix(weight)
        factor: Any = cholesky_banded(band, lower=True, check_finite=False)
        n, trace = band.shape[1], 0.0
        for first in range(0, n, 240):
            columns = np.arange(first, min(first + 240, n))
            unit = np.zeros((n, columns.size))
            for diagonal in range(_BAND):
                inside = columns + diagonal < n
                unit[(columns + diagonal)[inside], np.flatnonzero(inside)] = self.rows[diagonal, columns[inside]]
                inside = columns >= diagonal
                unit[(columns - diagonal)[inside], np.flatnonzero(inside)] = self.rows[
                    diagonal, (columns - diagonal)[inside]
                ]
            unit[self.fixed] = 0.0
            solved = cho_solve_banded((factor, True), unit, check_finite=False)
            trace += float(solved[columns, np.arange(columns.size)][~self.fixed[columns]].sum())
        return trace


def _times(band: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Product of a symmetric matrix, given by its lower bands, and a vector."""
    result = band[0] * x
    for diagonal in range(1, band.shape[0]):
        n = x.size - diagonal
        result[diagonal:] += band[diagonal, :n] * x[:n]
        result[:n] += band[diagonal, :n] * x[diagonal:]
    return np.asarray(result)
