"""Rows of a table over one turn, in order and each cam angle once, with the error of every column."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import sqrt

import numpy as np

from core.frozen import frozen
from core.measured.outliers import COARSE, LONGEST, deviation
from core.measured.table import MeasuredTable, distinct_angles

EXACT = 1e-10
"""Scatter relative to the size of a column, below which its rows are exact, and to which they are then fitted."""
MOST_JUDGED = 5000  # positions at which the scatter of a table is evaluated
FAR = 8.0  # errors by which the difference of two rows may deviate from their velocities
MOST_OFF = 0.02  # fraction of contradicting rows, above which the column contradicts the previous one
MOST_ELSE = 0.1  # fraction of rows that contradict outside of runs, above which the columns contradict each other
SCALED = (
    0.05  # relative difference of a column from the derivative of the previous one, above which runs are not searched
)
_ORDERS = range(3, 11)  # of the differences that show the scatter
_FALLS = 0.6  # ratio of the scatters of the two highest orders, below which no error is visible
_SAME_SCATTER = 1.25  # ratio to the least scatter, below which an order shows the same scatter


@frozen(eq=False)
class TurnRows:
    """Rows over one turn.

    Attributes
    ----------
    x : ndarray (n,) [deg]
        Cam angles, ascending from 0.
    values : dict of int to ndarray (n,) [unit of the motion per deg^order]
        Values of each derivative in the table, NaN where a cell is left out.
    errors : standard deviation of each, at least ``EXACT`` of its size
    sizes : largest value of each
    exact : whether the displacement is fitted to ``EXACT``
    """

    x: np.ndarray
    values: dict[int, np.ndarray]
    errors: dict[int, float]
    sizes: dict[int, float]
    exact: bool

    def only(self, orders: set[int]) -> TurnRows:
        """Rows with only these columns."""
        return replace(self, values={order: values for order, values in self.values.items() if order in orders})


def turn_rows(
    table: MeasuredTable, errors: dict[int, float], left_out: Sequence[int], others: Mapping[int, Sequence[int]]
) -> TurnRows:
    """Rows of a table without those left out.

    ``errors``: error of each column [unit of the motion per deg^order], 0 for exact rows; ``others``: order of a column
    -> further rows that are left out of it.
    """
    used = table.used_rows(left_out)
    x, index = distinct_angles(table.angles[used])
    values, sizes, bounded_errors = {}, {}, {}
    for column in table.columns:
        column_values = column.values.copy()
        column_values[list(others.get(column.order, ()))] = np.nan
        column_values = column_values[used]
        is_finite = np.isfinite(column_values)
        count = np.bincount(index[is_finite], minlength=x.size)
        with np.errstate(invalid="ignore"):
            mean = np.bincount(index[is_finite], column_values[is_finite], minlength=x.size) / count
        if column.order > 2 or not is_finite.any():
            continue
        values[column.order] = mean
        sizes[column.order] = float(np.nanmax(np.abs(mean - (np.nanmin(mean) if column.order == 0 else 0.0)))) or 1.0
        bounded_errors[column.order] = max(errors[column.order], EXACT * sizes[column.order])
    return TurnRows(x, values, bounded_errors, sizes, bounded_errors.get(0, 0.0) <= EXACT * sizes.get(0, 0.0))


def integrated(rows: TurnRows) -> tuple[TurnRows, float]:
    """Rows with displacements integrated from velocities or accelerations, and the mean by degrees that was subtracted.

    The column of least order is integrated by the cubic through the two rows before and the two after each step, minus
    its gain over a turn. Rows with displacements are unchanged. The error of the displacement is the accumulated error
    of the rows, at least the difference of the cubic from the parabola.
    """
    order, gain = min(rows.values), 0.0
    x, values, errors, sizes = rows.x, dict(rows.values), dict(rows.errors), dict(rows.sizes)
    step = np.diff(x, append=x[0] + 360.0)
    for below in range(order - 1, -1, -1):  # empty where there are displacements
        derivative = values[below + 1]
        rises, cubic_part = _rises(x, step, derivative)
        mean = float(rises.sum()) / 360.0
        gain = mean if below == order - 1 else gain
        values[below + 1] = derivative - mean
        integral = np.append(0.0, np.cumsum(rises - mean * step)[:-1])
        values[below] = integral - (integral.min() if below == 0 else float(integral @ step) / 360.0)
        sizes[below] = float(np.abs(values[below]).max()) or 1.0
        accumulated = 0.5 * errors[below + 1] * sqrt(360.0 * float(np.median(step)))
        errors[below] = max(accumulated, float(np.abs(np.cumsum(cubic_part)).max()), EXACT * sizes[below])
        relative = errors[below] / sizes[below]
        for higher in range(below + 1, 3):
            if higher in errors:
                errors[higher] = max(errors[higher], relative * sizes[higher])
    return replace(rows, values=values, errors=errors, sizes=sizes, exact=errors[0] <= EXACT * sizes[0]), gain


def _rises(x: np.ndarray, step: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Integral of y to the next row (n,) by the cubic through four rows; its difference from a parabola's."""
    before, after, next_y = np.roll(step, 1), np.roll(step, -1), np.roll(y, -1)
    slope = (next_y - y) / step
    second_differences = [
        (slope - np.roll(slope, 1)) / (step + before),
        (np.roll(slope, -1) - slope) / (step + after),
    ]
    third = (second_differences[1] - second_differences[0]) / (before + step + after)
    parabola = step * (y + 0.5 * step * slope) - step**3 / 6.0 * second_differences[0]
    cubic_part = -third * (step**4 / 12.0 + before * step**3 / 6.0)
    return parabola + cubic_part, cubic_part


def scatter(x: np.ndarray, y: np.ndarray, derivative: int = 0) -> float:
    """Error of a value that the rows show: the deviation of their normalised divided differences.

    The lowest order whose higher orders show no less is used: what is smooth between the joins decreases with the
    order, an error does not.

    Parameters
    ----------
    x : ndarray (n,) [deg]
        Distinct cam angles in order.
    y : ndarray (n,) [unit of the values]
    derivative : int
        Order of the derivative; where a displacement is constant it shows no error, a derivative only where it is 0.

    Returns
    -------
    float [unit of the values]
    """
    n, scatters = x.size, []
    two_turns, values = np.append(x, x + 360.0), np.append(y, y)
    for order in _ORDERS:
        if order + 2 > n:
            break
        indices = np.arange(0, n, -(-n // MOST_JUDGED))[:, None] + np.arange(order + 1)
        angles, samples = two_turns[indices], values[indices]
        varies = np.any(samples != 0.0, axis=1) if derivative else np.ptp(samples, axis=1) > 0.0
        if not varies.any():
            return 0.0
        angles, samples = angles[varies], samples[varies]
        width = angles[:, -1:] - angles[:, :1]
        distances = (angles[:, :, None] - angles[:, None, :]) / width[:, :, None] + np.eye(order + 1)
        weights = 1.0 / distances.prod(axis=2)
        weights /= np.sqrt((weights**2).sum(axis=1))[:, None]
        scatters.append(deviation(np.abs((weights * (samples - samples[:, :1])).sum(axis=1))))
    if len(scatters) < 2 or scatters[-1] < _FALLS * scatters[-2]:
        return 0.0  # too few rows to tell an error from the motion
    least = min(scatters)
    return next((values for values in scatters if values <= _SAME_SCATTER * least), 0.0)


def spoiled_runs(
    x: np.ndarray, before: np.ndarray, y: np.ndarray, error_before: float, error: float
) -> list[tuple[int, ...]]:
    """Runs of up to 15 rows whose y contradicts the differences of the previous column, amid rows that agree.

    Between two rows Δ(before)/h differs from the mean of y by r, apart from h²/12 of the third derivative, which the
    previous column shows. Rows with errors d_k have r_k = -(d_k + d_(k+1))/2: from the first contradiction on d_(k+1) =
    -2 r_k - d_k, and the run ends where this returns to 0. A jump or a step contradicts between two rows only and does
    not return; an error that grows and shrinks gradually has no end of its own and is no run either.

    Parameters
    ----------
    x : ndarray (n,) [deg]
        Cam angles in order over the turn.
    before : ndarray (n,) [unit of the motion per deg^(k - 1)]
        Previous column.
    y : ndarray (n,) [unit of the motion per deg^k]
    error_before, error : float
        Errors of a value of each.

    Returns
    -------
    list of tuple of int
        Row numbers of each run; empty where the columns contradict each other as a whole.
    """
    n, longest = x.size, min(LONGEST, x.size // COARSE)
    h = np.diff(np.append(x, x[0] + 360.0))
    rise, mean = (np.roll(before, -1) - before) / h, 0.5 * (np.roll(y, -1) + y)
    difference, is_moving = rise - mean, np.abs(rise) > 0.1 * np.abs(rise).max()
    angles, third = (
        np.concatenate((x[-1:] - 360.0, x, x[:2] + 360.0)),
        np.concatenate((before[-1:], before, before[:2])),
    )
    for power in range(1, 4):
        third = power * np.diff(third) / (angles[power:] - angles[:-power])
    bound = np.maximum.reduce([np.roll(np.abs(third), k) for k in range(-2, 3)])
    allowed = h**2 / 6.0 * bound + FAR * np.hypot(sqrt(2.0) * error_before / h, sqrt(0.5) * error)
    is_off = np.abs(difference) > allowed
    if is_off.all() or (is_moving.any() and abs(float(np.median(mean[is_moving] / rise[is_moving])) - 1.0) > SCALED):
        return []
    order = np.roll(np.arange(n), -int(np.argmin(is_off)))  # from an interval without contradiction on
    runs, k = [], 0
    while k < n:
        if not is_off[order[k]]:
            k += 1
            continue
        errors, last = [0.0], k
        while last < n and len(errors) <= longest + 1:
            errors.append(-2.0 * float(difference[order[last]]) - errors[-1])
            if abs(errors[-1]) <= 2.0 * allowed[order[k : last + 1]].max():
                break
            last += 1
        rows = order[k + 1 : last + 1]
        size, steps = np.abs(errors[:-1]).max(), np.abs(np.diff([*errors[:-1], 0.0])).max()
        agreeing = np.count_nonzero(~is_off[order[k : last + 1]])
        is_isolated = not is_off[order[np.mod([k - 2, k - 1, last + 1, last + 2], n)]].any()
        if 0 < rows.size <= longest and last < n and is_isolated and agreeing <= rows.size // 5 and steps > 0.5 * size:
            runs.append(tuple(rows.tolist()))
            k = last + 1
        else:
            while k < n and is_off[order[k]]:
                k += 1
    explained = sum(len(run) + 1 for run in runs)
    return runs if np.count_nonzero(is_off) - explained <= MOST_ELSE * n else []


@frozen(eq=False)
class Disagreement:
    """A column that is not the derivative of the previous one.

    Attributes
    ----------
    order : order of the derivative in the column
    factor : ratio of the column to that derivative
    angles : ndarray (m,) [deg]
        Cam angles of the rows between which and the next they differ by more than their errors.
    """

    order: int
    factor: float
    angles: np.ndarray


def disagreements(rows: TurnRows) -> list[Disagreement]:
    """Columns that contradict the previous one on more than single rows.

    From row to row Δy is h times the mean of y' minus h²/12 Δy''. The bound on Δy'' comes from the second differences
    of y', which include its jumps.
    """
    result, orders = [], sorted(rows.values)
    for before, order in pairwise(orders):
        if order != before + 1:
            continue
        x = np.append(rows.x, rows.x[0] + 360.0)
        y, slope = (np.append(rows.values[k], rows.values[k][0]) for k in (before, order))
        h = np.diff(x)
        rise, expected = np.diff(y), 0.5 * h * (slope[1:] + slope[:-1])
        bound = np.abs(np.diff(slope))
        bound = 0.5 * np.maximum.reduce([np.roll(bound, k) for k in range(-2, 3)])
        allowed = h * bound + FAR * np.hypot(rows.errors[before] * sqrt(2.0), h * rows.errors[order])
        is_finite = np.isfinite(rise) & np.isfinite(expected)
        is_off = is_finite & (np.abs(rise - expected) > allowed) & (h < 20.0)
        if is_off.sum() > MOST_OFF * is_finite.sum():
            factor = float(expected[is_finite] @ rise[is_finite]) / max(
                float(rise[is_finite] @ rise[is_finite]), 1e-300
            )
            result.append(Disagreement(order, factor, rows.x[is_off]))
    return result
