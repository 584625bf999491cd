"""The rows of a table over one turn, in order and each cam angle once, with the error of every column."""

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
"""Of a column's size: rows that scatter less are exact, and are met to this."""
MOST_JUDGED = 5000  # places of a table that its scatter is judged at
FAR = 8.0  # errors, by which the difference of two rows may be off their velocities
MOST_OFF = 0.02  # of the rows: where more are, it is not single rows that are wrong
MOST_ELSE = 0.1  # of the rows: where more contradict beside runs of spoiled rows, the columns do as a whole
SCALED = 0.05  # by how much a column differs as a whole from the derivative of that before, where its single rows cannot be judged
_ORDERS = range(3, 11)  # of the differences that a scatter is judged by
_FALLS = 0.6  # of the order before: where the highest order still falls so, there is no error to be seen
_ALIKE = 1.25  # differences of a higher order that find no less than this part of the scatter find nothing new


@frozen(eq=False)
class TurnRows:
    """Rows over one turn.

    x       (n,) cam angle [deg], rising from 0 on
    values  of each derivative that the table holds the values (n,), in the motion's unit per degree^order; nan where a cell is left out
    errors  of each its standard deviation, at least ``EXACT`` of its size
    sizes   of each the largest value
    exact   the displacement is known better than any gauge: it is met to ``EXACT``
    """

    x: np.ndarray
    values: dict[int, np.ndarray]
    errors: dict[int, float]
    sizes: dict[int, float]
    exact: bool

    def only(self, orders: set[int]) -> TurnRows:
        """The same with these columns."""
        return replace(self, values={order: values for order, values in self.values.items() if order in orders})


def turn_rows(
    table: MeasuredTable, errors: dict[int, float], left_out: Sequence[int], others: Mapping[int, Sequence[int]]
) -> TurnRows:
    """The rows but those left out.

    errors  of each column, in the motion's unit per degree^order, 0 = exact
    others  by order the rows that a column is left out of besides
    """
    used = table.used_rows(left_out)
    x, place = distinct_angles(table.angles[used])
    values, sizes, found = {}, {}, {}
    for column in table.columns:
        every = column.values.copy()
        every[list(others.get(column.order, ()))] = np.nan
        every = every[used]
        there = np.isfinite(every)
        count = np.bincount(place[there], minlength=x.size)
        with np.errstate(invalid="ignore"):
            mean = np.bincount(place[there], every[there], minlength=x.size) / count
        if column.order > 2 or not there.any():
            continue
        values[column.order] = mean
        sizes[column.order] = float(np.nanmax(np.abs(mean - (np.nanmin(mean) if column.order == 0 else 0.0)))) or 1.0
        found[column.order] = max(errors[column.order], EXACT * sizes[column.order])
    return TurnRows(x, values, found, sizes, found.get(0, 0.0) <= EXACT * sizes.get(0, 0.0))


def integrated(rows: TurnRows) -> tuple[TurnRows, float]:
    """The same with the displacement, where the rows hold none: the integral of the column of least order by the cubic through the two
    rows before and the two behind each step, less what that gains over a turn; and this, by degrees of that column.

    What the errors of the rows add up to is the error of the displacement, at least what the cubic and the parabola differ by.
    """
    order, gain = min(rows.values), 0.0
    x, values, errors, sizes = rows.x, dict(rows.values), dict(rows.errors), dict(rows.sizes)
    step = np.diff(x, append=x[0] + 360.0)
    for below in range(order - 1, -1, -1):  # none where there are displacements
        above = values[below + 1]
        rises, doubt = _rises(x, step, above)
        gained = float(rises.sum()) / 360.0
        gain = gained if below == order - 1 else gain
        values[below + 1] = above - gained
        whole = np.append(0.0, np.cumsum(rises - gained * step)[:-1])
        values[below] = whole - (whole.min() if below == 0 else float(whole @ step) / 360.0)
        sizes[below] = float(np.abs(values[below]).max()) or 1.0
        adds_up = 0.5 * errors[below + 1] * sqrt(360.0 * float(np.median(step)))
        errors[below] = max(adds_up, float(np.abs(np.cumsum(doubt)).max()), EXACT * sizes[below])
        relative = errors[below] / sizes[below]
        for each in range(below + 1, 3):
            if each in errors:
                errors[each] = max(errors[each], relative * sizes[each])
    return replace(rows, values=values, errors=errors, sizes=sizes, exact=errors[0] <= EXACT * sizes[0]), gain


def _rises(x: np.ndarray, step: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The integral of y from each row to the next (n,) by the cubic through four rows, and what the parabola through three differs by."""
    before, after, behind = np.roll(step, 1), np.roll(step, -1), np.roll(y, -1)
    slope = (behind - y) / step
    bends = [
        (slope - np.roll(slope, 1)) / (step + before),
        (np.roll(slope, -1) - slope) / (step + after),
    ]
    third = (bends[1] - bends[0]) / (before + step + after)
    first = step * (y + 0.5 * step * slope) - step**3 / 6.0 * bends[0]
    more = -third * (step**4 / 12.0 + before * step**3 / 6.0)
    return first + more, more


def scatter(x: np.ndarray, y: np.ndarray, derivative: int = 0) -> float:
    """The error of a value that the rows themselves show: the deviation of their normalised divided differences, of the least order from
    which on higher ones find no less. What is smooth between the joins falls with the order, an error does not.

    x           (n,) cam angles [deg] in order, y (n,) values; repeated angles count once
    derivative  that the values are: where they stand still nothing is seen, but one of them that is constant is exact
    """
    n, found = x.size, []
    turned, each = np.append(x, x + 360.0), np.append(y, y)
    for order in _ORDERS:
        if order + 2 > n:
            break
        at = np.arange(0, n, -(-n // MOST_JUDGED))[:, None] + np.arange(order + 1)
        places, rows = turned[at], each[at]
        moving = np.any(rows != 0.0, axis=1) if derivative else np.ptp(rows, axis=1) > 0.0
        if not moving.any():
            return 0.0
        places, rows = places[moving], rows[moving]
        width = places[:, -1:] - places[:, :1]
        apart = (places[:, :, None] - places[:, None, :]) / width[:, :, None] + np.eye(order + 1)
        weights = 1.0 / apart.prod(axis=2)
        weights /= np.sqrt((weights**2).sum(axis=1))[:, None]
        found.append(deviation(np.abs((weights * (rows - rows[:, :1])).sum(axis=1))))
    if len(found) < 2 or found[-1] < _FALLS * found[-2]:
        return 0.0  # too few rows to tell an error from the motion
    least = min(found)
    return next((each for each in found if each <= _ALIKE * least), 0.0)


def spoiled_runs(
    x: np.ndarray, before: np.ndarray, y: np.ndarray, error_before: float, error: float
) -> list[tuple[int, ...]]:
    """Runs of up to 15 rows whose y contradicts the rise of the column before, the rows around them agreeing with it; none where the
    columns contradict each other as a whole.

    x       (n,) cam angles [deg] in order over the turn; before, y (n,) the columns
    errors  of a value of each

    Between two rows Δ(before)/h differs from the mean of y by r, but for h²/12 of the third derivative, which the column before tells
    itself. Rows off by d_k make r_k = -(d_k + d_(k+1))/2: from the first contradiction on, d_(k+1) = -2 r_k - d_k, and the run ends
    where that comes back to 0. A jump or a step contradicts between two rows only, and never comes back; what is off by ever more and
    ever less has no end of its own, and is no run either.
    """
    n, longest = x.size, min(LONGEST, x.size // COARSE)
    h = np.diff(np.append(x, x[0] + 360.0))
    rise, mean = (np.roll(before, -1) - before) / h, 0.5 * (np.roll(y, -1) + y)
    r, moving = rise - mean, np.abs(rise) > 0.1 * np.abs(rise).max()
    place, third = np.concatenate((x[-1:] - 360.0, x, x[:2] + 360.0)), np.concatenate((before[-1:], before, before[:2]))
    for power in range(1, 4):
        third = power * np.diff(third) / (place[power:] - place[:-power])
    bend = np.maximum.reduce([np.roll(np.abs(third), k) for k in range(-2, 3)])
    allowed = h**2 / 6.0 * bend + FAR * np.hypot(sqrt(2.0) * error_before / h, sqrt(0.5) * error)
    off = np.abs(r) > allowed
    if off.all() or (moving.any() and abs(float(np.median(mean[moving] / rise[moving])) - 1.0) > SCALED):
        return []
    around = np.roll(np.arange(n), -int(np.argmin(off)))  # from an interval on that contradicts nothing
    found, k = [], 0
    while k < n:
        if not off[around[k]]:
            k += 1
            continue
        wrong, last = [0.0], k
        while last < n and len(wrong) <= longest + 1:
            wrong.append(-2.0 * float(r[around[last]]) - wrong[-1])
            if abs(wrong[-1]) <= 2.0 * allowed[around[k : last + 1]].max():
                break
            last += 1
        rows = around[k + 1 : last + 1]
        size, steps = np.abs(wrong[:-1]).max(), np.abs(np.diff([*wrong[:-1], 0.0])).max()
        quiet = np.count_nonzero(~off[around[k : last + 1]])
        alone = not off[around[np.mod([k - 2, k - 1, last + 1, last + 2], n)]].any()
        if 0 < rows.size <= longest and last < n and alone and quiet <= rows.size // 5 and steps > 0.5 * size:
            found.append(tuple(rows.tolist()))
            k = last + 1
        else:
            while k < n and off[around[k]]:
                k += 1
    explained = sum(len(run) + 1 for run in found)
    return found if np.count_nonzero(off) - explained <= MOST_ELSE * n else []


@frozen(eq=False)
class Disagreement:
    """Of a column that is not the derivative of the one before it: its order, by how much it is too large in the whole, and the rows, by
    their cam angles (m,) [deg], between which and the next they differ by more than their errors."""

    order: int
    factor: float
    angles: np.ndarray


def disagreements(rows: TurnRows) -> list[Disagreement]:
    """Columns that contradict the one before them on more than single rows.

    From row to row Δy is h times the mean of y' but for h²/12 Δy''. What that may be is told by the second differences of y'; a jump of
    y' is one of them too.
    """
    found, orders = [], sorted(rows.values)
    for before, order in pairwise(orders):
        if order != before + 1:
            continue
        x = np.append(rows.x, rows.x[0] + 360.0)
        y, slope = (np.append(rows.values[k], rows.values[k][0]) for k in (before, order))
        h = np.diff(x)
        rise, meant = np.diff(y), 0.5 * h * (slope[1:] + slope[:-1])
        bend = np.abs(np.diff(slope))
        bend = 0.5 * np.maximum.reduce([np.roll(bend, k) for k in range(-2, 3)])
        allowed = h * bend + FAR * np.hypot(rows.errors[before] * sqrt(2.0), h * rows.errors[order])
        known = np.isfinite(rise) & np.isfinite(meant)
        off = known & (np.abs(rise - meant) > allowed) & (h < 20.0)
        if off.sum() > MOST_OFF * known.sum():
            factor = float(meant[known] @ rise[known]) / max(float(rise[known] @ rise[known]), 1e-300)
            found.append(Disagreement(order, factor, rows.x[off]))
    return found


__all__ = ["EXACT", "Disagreement", "TurnRows", "disagreements", "scatter", "spoiled_runs", "turn_rows"]
