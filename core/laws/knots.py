"""Laws whose highest derivative is straight between knots: derivatives at points, extremes, and pieces.

The law s(u) has u = 0 ... 1. Its derivative of order m is straight between knots, a B-spline of degree m + 1. The unknowns are
the derivatives of orders 0 ... m at the knots.

Source: C. de Boor 1978, *A Practical Guide to Splines*.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from core.frozen import frozen
from core.laws.pieces import Piece
from core.numerics.roots import gauss

BISECTIONS = 50


@frozen
class OptimalTask:
    """What an optimal law must do, normalised to span 1 and rise 1.

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
    rising : whether s does not fall
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
    rising: bool = False

    @property
    def straight(self) -> int:
        """Order m of the derivative that is straight between knots."""
        orders = [order for order, _ in self.limits] + [order for _, order, _ in self.conditions]
        return max(self.least_straight, self.order, 2 * self.order - 2 if self.rms else 0, *orders)


# -- derivatives at knots -----------------------------------------------------------------------------------------


@frozen(eq=False)
class Points:
    """Points of the span, each in an interval at a distance from its start."""

    interval: np.ndarray
    offset: np.ndarray

    def __add__(self, more: Points) -> Points:
        return Points(np.append(self.interval, more.interval), np.append(self.offset, more.offset))

    def part(self, selected: np.ndarray) -> Points:
        """Some of the points.

        Parameters
        ----------
        selected : ndarray (k,), dimensionless
            Mask or numbers of the points.
        """
        return Points(self.interval[selected], self.offset[selected])


@frozen(eq=False)
class Equation:
    """Sum of weights times derivatives at the knots = value; a column is knot (m + 1) + order."""

    columns: np.ndarray
    weights: np.ndarray
    value: float


class Knots:
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
    def points(self) -> Points:
        """The knots."""
        n = self.h.size
        return Points(np.minimum(np.arange(n + 1), n - 1), np.append(np.zeros(n), self.h[-1]))

    def resampled(self, knots: Knots, states: np.ndarray) -> np.ndarray:
        """Derivatives at these knots of a law with other knots, next to it where they are fewer or elsewhere.

        Parameters
        ----------
        knots : Knots
            Knots of the law.
        states : ndarray (n + 1, m + 1), dimensionless
            Derivatives of orders 0 ... m at the knots.

        Returns
        -------
        ndarray (k + 1, m + 1), dimensionless
            Derivatives at the k + 1 knots here.
        """
        rows = [knots.value(states, order, knots.at(self.u)) for order in range(self.m + 1)]
        return self.corrected(np.stack(rows, axis=1))

    def at(self, u: np.ndarray) -> Points:
        """Points at values of u.

        Parameters
        ----------
        u : ndarray (k,), dimensionless

        Returns
        -------
        Points
        """
        interval = np.clip(np.searchsorted(self.u, u, side="right") - 1, 0, self.h.size - 1)
        return Points(interval, u - self.u[interval])

    def at_span(self, points: Points) -> np.ndarray:
        """Values u of points (k,).

        Parameters
        ----------
        points : Points

        Returns
        -------
        ndarray (k,), dimensionless
        """
        return np.asarray(self.u[points.interval] + points.offset)

    def quadrature(self, count: int) -> tuple[Points, np.ndarray]:
        """Gauss points of every interval, and their weights.

        Parameters
        ----------
        count : int
            Points of an interval.

        Returns
        -------
        points : Points
        weights : ndarray (k,), dimensionless
        """
        nodes, weight = gauss(count)
        interval = np.repeat(np.arange(self.h.size), nodes.size)
        return Points(interval, (self.h[:, None] * nodes).ravel()), (self.h[:, None] * weight).ravel()

    def weights(self, order: int, points: Points) -> tuple[np.ndarray, np.ndarray]:
        """Columns and weights (k, j) of the derivative of an order at points, by Taylor's series from the knot before.

        Parameters
        ----------
        order : int
        points : Points

        Returns
        -------
        columns : ndarray (k, j), dimensionless
            Numbers knot (m + 1) + order of derivatives at the knots.
        weights : ndarray (k, j), dimensionless
        """
        i, w, m = points.interval, points.offset, self.m
        rest = m - order
        terms = [w**k / math.factorial(k) for k in range(rest + 1)]
        columns = [i * (m + 1) + order + k for k in range(rest + 1)]
        slope = w ** (rest + 1) / (math.factorial(rest + 1) * self.h[i])
        columns += [i * (m + 1) + m, (i + 1) * (m + 1) + m]
        return np.stack(columns, axis=1), np.stack([*terms, -slope, slope], axis=1)

    def value(self, states: np.ndarray, order: int, points: Points) -> np.ndarray:
        """Derivative of an order at points, of states (n + 1, m + 1, ...).

        Parameters
        ----------
        states : ndarray (n + 1, m + 1, ...), dimensionless
            Derivatives of orders 0 ... m at the knots, of one law or of several.
        order : int
        points : Points

        Returns
        -------
        ndarray (k, ...), dimensionless
        """
        columns, weights = self.weights(order, points)
        rows = states.reshape(-1, *states.shape[2:])[columns]
        return np.asarray(np.einsum("kj,kj...->k...", weights, rows))

    def _conditions(self, task: OptimalTask) -> list[Equation]:
        result = []
        for u, order, value in task.conditions:
            columns, weights = self.weights(order, self.at(np.array([u])))
            result.append(Equation(columns.ravel(), weights.ravel(), value))
        last = self.h.size * (self.m + 1)
        for order in range(1, min(self.m, 2) + 1) if task.periodic else ():
            result.append(Equation(np.array([last + order, order]), np.array([1.0, -1.0]), 0.0))
        return result

    def _vibration(self, task: OptimalTask) -> list[Equation]:
        """∫ s'' cos ωu du = ∫ s'' sin ωu du = 0 for an undamped follower of ω = 2π cycles."""
        result = []
        for cycles in task.vibration_free:
            omega = 2.0 * math.pi * cycles
            points, share = self.quadrature(self.m + 10 + math.ceil(omega * float(self.h.max())))
            columns, weights = self.weights(2, points)
            u = self.at_span(points)
            size = columns.max() + 1
            for wave in (np.cos, np.sin):
                row = np.bincount(columns.ravel(), (weights * (share * wave(omega * u))[:, None]).ravel(), size)
                result.append(Equation(np.flatnonzero(row), row[row != 0.0], 0.0))
        return result

    def integrated(self, start: np.ndarray, straight: np.ndarray) -> np.ndarray:
        """Derivatives (n + 1, m + 1, ...) at the knots from those at the start (m, ...), and of order m (n + 1, ...).

        Parameters
        ----------
        start : ndarray (m, ...), dimensionless
            Derivatives of orders 0 ... m - 1 at the start.
        straight : ndarray (n + 1, ...), dimensionless
            Derivative of order m at the knots.

        Returns
        -------
        ndarray (n + 1, m + 1, ...), dimensionless
        """
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
        """Rows and values of the equations in the unknowns of the basis.

        Returns
        -------
        rows : ndarray (e, m + n + 1), dimensionless
        values : ndarray (e,), dimensionless
        """
        basis = self.basis.reshape(-1, self.basis.shape[2])
        rows = np.array([row.weights @ basis[row.columns] for row in self.equations])
        return rows, np.array([row.value for row in self.equations])

    def corrected(self, states: np.ndarray) -> np.ndarray:
        """States that meet all equations to rounding, next to given ones.

        Parameters
        ----------
        states : ndarray (n + 1, m + 1), dimensionless
            Derivatives of orders 0 ... m at the knots.

        Returns
        -------
        ndarray (n + 1, m + 1), dimensionless
        """
        unknowns = np.append(states[0, : self.m], states[:, self.m])
        rows, values = self.conditions_of_unknowns()
        unknowns = unknowns + np.linalg.lstsq(rows, values - rows @ unknowns)[0]
        return self.integrated(unknowns[: self.m], unknowns[self.m :])

    def zeros(self, states: np.ndarray, order: int) -> Points:
        """Zeros of a derivative inside the intervals: between those of its derivative it is monotonic.

        Parameters
        ----------
        states : ndarray (n + 1, m + 1), dimensionless
            Derivatives of orders 0 ... m at the knots.
        order : int

        Returns
        -------
        Points
        """
        if order > self.m:
            return Points(np.zeros(0, dtype=int), np.zeros(0))
        turning = self.zeros(states, order + 1)
        u = np.sort(np.append(self.u, self.at_span(turning)))
        low, high = self.at(u[:-1]), self.at(u[:-1])
        high = Points(low.interval, np.minimum(low.offset + np.diff(u), self.h[low.interval]))
        first = self.value(states, order, low)
        changes = first * self.value(states, order, high) < 0.0
        low, high, first = low.part(changes), high.part(changes), first[changes]
        left, right = low.offset, high.offset
        for _ in range(BISECTIONS if left.size else 0):
            middle = 0.5 * (left + right)
            is_left = self.value(states, order, Points(low.interval, middle)) * first > 0.0
            left, right = np.where(is_left, middle, left), np.where(is_left, right, middle)
        return Points(low.interval, 0.5 * (left + right))

    def extremes(self, states: np.ndarray, order: int) -> Points:
        """Points among which a derivative has its extremes: the knots, and the zeros of its derivative.

        Parameters
        ----------
        states : ndarray (n + 1, m + 1), dimensionless
            Derivatives of orders 0 ... m at the knots.
        order : int

        Returns
        -------
        Points
        """
        return self.points + self.zeros(states, order + 1) if order < self.m else self.points

    def peak(self, states: np.ndarray, order: int) -> float:
        """Largest absolute value of a derivative.

        Parameters
        ----------
        states : ndarray (n + 1, m + 1), dimensionless
            Derivatives of orders 0 ... m at the knots.
        order : int

        Returns
        -------
        float
        """
        return float(np.abs(self.value(states, order, self.extremes(states, order))).max())

    def pieces(self, states: np.ndarray) -> tuple[Piece, ...]:
        """The law as polynomials between knots.

        Parameters
        ----------
        states : ndarray (n + 1, m + 1), dimensionless
            Derivatives of orders 0 ... m at the knots.

        Returns
        -------
        tuple of Piece
        """
        factors = np.array([1.0 / math.factorial(k) for k in range(self.m + 2)])
        slope = np.diff(states[:, self.m]) / self.h
        rows = (np.column_stack((states[:-1], slope)) * factors).tolist()
        return tuple(Piece(start, tuple(row)) for start, row in zip(self.u[:-1].tolist(), rows, strict=True))
