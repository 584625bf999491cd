"""Errors of the path that a controller runs between the rows of a table, and the effect of its cycles."""

from __future__ import annotations

import math

import numpy as np

from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import find_highest
from core.output.controllers.rows import KINDS, Table, evaluate
from core.output.controllers.slave import NEAR, TURN, Slave

# -- effect of the controller's cycles --------------------------------------------------------------------------


CYCLE_SAMPLES = np.clip(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 9)), 1e-9, 1.0 - 1e-9)


@frozen
class Cycle:
    """Effect of a cycle time on the drive.

    Attributes
    ----------
    acceleration_step : largest step of the acceleration from a cycle to the next, for any position of the cycles, by second
        differences of the sampled path [m/s² or deg/s²]
    at_deg : master angle of that step [deg]
    dominates_above_rpm : speed above which the error between two cycles exceeds that of the table; None: at no speed
    """

    acceleration_step: float
    at_deg: float
    dominates_above_rpm: float | None


def cycle_effect(slave: Slave, kind: str, table: Table, deviation: float, cycle_ms: float, speed_rpm: float) -> Cycle:
    """Effect of a cycle time T on the path p(x) of a table: steps h = ω T degrees, accelerations Δ²p/T², their steps Δ³p/T².

    A straight line between two cycles has the error h²/8 max|s''|, which exceeds the deviation of the table
    above h = √(8 deviation/max|s''|).
    """
    seconds, h = cycle_ms / 1e3, 6.0 * speed_rpm * cycle_ms / 1e3
    coefficients = KINDS[kind].coefficients(table)

    def path(x: np.ndarray) -> np.ndarray:
        turns = np.floor((x - table.x[0]) / TURN)
        x = x - TURN * turns
        piece = np.clip(np.searchsorted(table.x, x, side="right") - 1, 0, table.x.size - 2)
        return np.asarray(evaluate(coefficients[:, piece], x - table.x[piece], 1)[0] + slave.advance * turns)

    breaks = np.unique(np.mod((table.x[:, None] - h * np.arange(4)).ravel(), TURN))
    ends = np.append(breaks, breaks[0] + TURN)
    x = (ends[:-1, None] + np.diff(ends)[:, None] * CYCLE_SAMPLES).ravel()
    step = np.abs(path(x + 3.0 * h) - 3.0 * path(x + 2.0 * h) + 3.0 * path(x + h) - path(x)) / seconds**2
    largest = int(np.argmax(step))
    acceleration = float(np.abs(slave.values[2]).max())
    limit = (
        math.sqrt(8.0 * deviation / acceleration) / (6.0 * seconds) if acceleration > 0.0 and deviation > 0.0 else None
    )
    scale = 1e-3 if slave.unit == "mm" else 1.0
    return Cycle(float(step[largest]) * scale, float(np.mod(x[largest] + 1.5 * h, TURN)), limit)


# -- errors of the interpolated path ----------------------------------------------------------------------------


SAMPLES = ((100, 17), (1000, 9), (10**9, 7))  # below this number of rows: samples of a piece, ends included
MANY = 33  # samples of a piece within which the curve jumps
COARSE, COARSE_REACH = 5, 4  # samples, and rows on either side, for an accuracy of some per cent
FEW, REFINED = 1000, 64  # above this number of pieces only those with the largest errors are refined
QUANTITIES = ("deviation", "velocity", "acceleration")


@frozen
class Deviation:
    """Largest errors of the value and its derivatives, as many as the interpolation has.

    Attributes
    ----------
    values : errors of value, velocity and acceleration [unit, per degree]
    at_deg : their master angles [deg]
    """

    values: tuple[float, ...]
    at_deg: tuple[float, ...]


def table_at(slave: Slave, x: np.ndarray, orders: int = 3) -> Table:
    """Table of the exact curve; at a jump a row has the mean of both sides, which leaves the smaller error.

    Parameters
    ----------
    slave : Slave
    x : ndarray (n,) [deg]
        Master angles of the rows.
    orders : int
        Number of derivatives, the value included.

    Returns
    -------
    Table
    """
    return _table(x, *slave.side_states(x, orders))


def _table(x: np.ndarray, left: np.ndarray, right: np.ndarray) -> Table:
    states = 0.5 * (left + right)
    return Table(x, states, (float(states[1, 0]), float(states[1, -1])) if states.shape[0] > 1 else (0.0, 0.0))


class _SmoothIntervals:
    """Intervals within which both the pieces of a table and the exact curve are smooth.

    Attributes
    ----------
    row : (m,) piece of the table to which an interval belongs
    first, last : (n,) first and last interval of each piece of the table
    piece : (m,) piece of the exact curve
    starts, ends : (m,) master angles [deg]
    """

    def __init__(self, slave: Slave, a: np.ndarray, b: np.ndarray) -> None:
        """Divide the pieces of a table from ``a`` to ``b`` (n,) [deg]."""
        begin = np.searchsorted(slave.edges, a + NEAR, side="right")
        inside = np.maximum(np.searchsorted(slave.edges, b - NEAR) - begin, 0)
        self.row = np.repeat(np.arange(a.size), inside + 1)
        self.last = np.cumsum(inside + 1) - 1
        self.first = self.last - inside
        number = np.arange(self.row.size) - self.first[self.row]
        self.piece = np.clip(begin[self.row] + number - 1, 0, slave.edges.size - 2)
        self.starts = np.where(number == 0, a[self.row], slave.edges[self.piece])
        self.ends = np.where(number == inside[self.row], b[self.row], slave.edges[self.piece + 1])
        self._slave, self._a = slave, a

    def sampled(self, count: int, orders: int) -> tuple[np.ndarray, np.ndarray]:
        """Samples of each interval with both ends, and the exact curve at them.

        Returns
        -------
        angles : ndarray (m, count) [deg]
            From the start of the row.
        exact : ndarray (orders, m, count) [unit, per degree]
        """
        w = (self.ends - self.starts)[:, None] * _positions(count)
        at = self.starts[:, None] + w  # in rising order, which is evaluated fastest
        at[:, -1] = self.ends
        piece, exact = self.piece, np.empty((orders, *at.shape))
        order = np.argsort(piece, kind="stable")
        exact[:, order] = self._slave.state(at[order].ravel(), np.repeat(piece[order], count), orders).reshape(
            exact.shape
        )
        return at - self._a[self.row, None], exact

    def errors(self, coefficients: np.ndarray, w: np.ndarray, exact: np.ndarray, orders: int) -> np.ndarray:
        """Largest error (orders, m) of each interval: the largest sample, and the parabola through it."""
        return _sample_peaks(np.abs(evaluate(coefficients[:, self.row, None], w, orders) - exact[:orders]))

    def worst(
        self, coefficients: np.ndarray, w: np.ndarray, exact: np.ndarray, orders: int, many: int = MANY
    ) -> np.ndarray:
        """Largest error (orders, n) of each piece of the table; ``many`` samples where the curve jumps within it."""
        errors = np.maximum.reduceat(self.errors(coefficients, w, exact, orders), self.first, axis=1)
        is_divided = self.last > self.first
        if w.shape[1] < many and is_divided.any():
            divided = _SmoothIntervals(
                self._slave, self.starts[self.first[is_divided]], self.ends[self.last[is_divided]]
            )
            errors[:, is_divided] = divided.worst(coefficients[:, is_divided], *divided.sampled(many, orders), orders)
        return np.asarray(errors)


def _samples(rows: int) -> int:
    return next(count for fewer, count in SAMPLES if rows < fewer)


def piece_errors(slave: Slave, kind: str, x: np.ndarray, orders: int = 1) -> np.ndarray:
    """Largest errors of value and derivatives between the rows of a table.

    The first and the last sample of a piece are also its rows, so that the motion is evaluated once.

    Parameters
    ----------
    slave : Slave
    kind : str
        Row of ``KINDS``.
    x : ndarray (n,) [deg]
        Master angles of the rows.
    orders : int
        Number of derivatives, the value included.

    Returns
    -------
    ndarray (orders, n - 1) [unit, per degree]
    """
    row, smooth = KINDS[kind], _SmoothIntervals(slave, x[:-1], x[1:])
    w, exact = smooth.sampled(_samples(x.size), max(orders, row.needs))
    starts, ends = exact[:, smooth.first, 0], exact[:, smooth.last, -1]
    table = _table(x, np.column_stack((starts[:, :1], ends)), np.column_stack((starts, ends[:, -1:])))
    return smooth.worst(row.coefficients(table), w, exact, orders)


def errors_near(
    slave: Slave, kind: str, steps: np.ndarray, angle: float, orders: int = 1, coarse: bool = False
) -> np.ndarray:
    """Largest errors in the piece at a given angle, for tables with different numbers of equal steps.

    A spline through all rows is solved for the rows near the angle only, so it needs more than 2 reach steps.

    Parameters
    ----------
    slave : Slave
    kind : str
        Row of ``KINDS``.
    steps : ndarray (k,), dimensionless
        Numbers of equal steps.
    angle : float
        Master angle [deg].
    orders : int
        Number of derivatives, the value included.
    coarse : bool
        An accuracy of some per cent is sufficient.

    Returns
    -------
    ndarray (orders, k) [unit, per degree]
    """
    row = KINDS[kind]
    reach = min(row.reach, COARSE_REACH) if coarse else row.reach
    at = np.floor(angle / TURN * steps)
    first = np.clip(at - reach, 0, steps - 1 - 2 * reach)
    x = TURN * (first + np.arange(2 * reach + 2)[:, None]) / steps
    states = table_at(slave, x.ravel(), max(1, row.needs)).states.reshape(-1, *x.shape)
    if reach:
        coefficients = row.of_equal_steps(TURN / steps, states)[:, (at - first).astype(int), np.arange(steps.size)]
    else:  # separate pieces in one table: the pieces between them are not used
        table = Table(x.T.ravel(), states.swapaxes(1, 2).reshape(states.shape[0], -1))
        coefficients = row.coefficients(table)[:, ::2]
    smooth = _SmoothIntervals(slave, TURN * at / steps, TURN * (at + 1.0) / steps)
    count = COARSE if coarse else _samples(int(steps.min()))
    return smooth.worst(coefficients, *smooth.sampled(count, orders), orders, COARSE if coarse else MANY)


def _positions(count: int) -> np.ndarray:
    return np.asarray(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count)))


def _sample_peaks(errors: np.ndarray) -> np.ndarray:
    """Largest samples (orders, n) of (orders, n, k), with the increase by the parabola through the neighbours."""
    positions = _positions(errors.shape[2])
    peak = errors.argmax(axis=2)
    middle = np.clip(peak, 1, positions.size - 2)
    left, highest, right = (np.take_along_axis(errors, (middle + k)[:, :, None], axis=2)[:, :, 0] for k in (-1, 0, 1))
    before, behind = positions[middle] - positions[middle - 1], positions[middle + 1] - positions[middle]
    rise, fall = (highest - left) / before, (highest - right) / behind
    slope = (rise * behind - fall * before) / (before + behind)
    curvature = np.maximum((rise + fall) / (before + behind), 1e-300)
    increase = np.where(peak == middle, np.minimum(slope**2 / (4.0 * curvature), 0.25 * highest), 0.0)
    return np.asarray(errors.max(axis=2) + increase)


class _SearchIntervals:
    """Intervals in which the largest errors are searched: ``starts``, ``ends`` (m,) [rad]."""

    def __init__(self, starts: np.ndarray, ends: np.ndarray) -> None:
        self.starts, self.ends = np.deg2rad(starts), np.deg2rad(ends)


def largest_errors(slave: Slave, kind: str, table: Table) -> Deviation:
    """Certificate of a table: the largest errors over the turn, refined, on both sides of every join and row.

    Parameters
    ----------
    slave : Slave
    kind : str
        Row of ``KINDS``.
    table : Table

    Returns
    -------
    Deviation
    """
    smooth, coefficients = _SmoothIntervals(slave, table.x[:-1], table.x[1:]), KINDS[kind].coefficients(table)
    orders = KINDS[kind].derivatives
    names = QUANTITIES[:orders]
    selected = np.arange(smooth.row.size)
    if selected.size > FEW:
        sampled = smooth.errors(coefficients, *smooth.sampled(SAMPLES[1][1], orders), orders)
        selected = np.unique(np.argpartition(sampled, -REFINED, axis=1)[:, -REFINED:])
    rows, pieces = smooth.row[selected], smooth.piece[selected]

    def errors(angles: Angles) -> dict[str, np.ndarray]:
        row, x = rows[angles.piece], np.rad2deg(angles.theta)
        exact = slave.state(x, pieces[angles.piece], orders)
        path = evaluate(coefficients[:, row], x - table.x[row], orders)
        return dict(zip(names, np.abs(path - exact), strict=True))

    peaks = find_highest(errors, _SearchIntervals(smooth.starts[selected], smooth.ends[selected]))  # type: ignore[arg-type]
    return Deviation(
        tuple(peaks[name].value for name in names),
        tuple(min(float(np.round(np.rad2deg(peaks[name].theta), 9)), TURN) for name in names),
    )
