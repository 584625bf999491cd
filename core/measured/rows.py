"""The rows of a table over one turn, in order and each cam angle once, with the error of every column."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import sqrt

import numpy as np

from core.frozen import frozen
from core.measured.table import MeasuredTable, distinct

EXACT = 1e-10
"""Of a column's size: rows that scatter less are exact, and are met to this."""
MOST_JUDGED = 5000  # places of a table that its scatter is judged at
SPIKE = 10.0  # times what the rows around a row, or its error, are off
FAR = 8.0  # errors, by which the difference of two rows may be off their velocities
MOST_OFF = 0.02  # of the rows: where more are, it is not single rows that are wrong
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
    used = table.used(left_out)
    x, place = distinct(table.angles[used])
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


def scatter(x: np.ndarray, y: np.ndarray, derivative: int = 0) -> float:
    """The error of a value that the rows themselves show: the median of their normalised divided differences, of the least order from
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
        found.append(float(np.median(np.abs((weights * (rows - rows[:, :1])).sum(axis=1)))) / 0.6745)
    if len(found) < 2 or found[-1] < _FALLS * found[-2]:
        return 0.0  # too few rows to tell an error from the motion
    least = min(found)
    return next((each for each in found if each <= _ALIKE * least), 0.0)


def spikes(x: np.ndarray, before: np.ndarray, y: np.ndarray, error: float) -> np.ndarray:
    """Rows (k,) of a column that stand out of both rows beside them, and as much off the slope of the column before: a jump stands out of
    one of them only. x (n,) cam angles [deg] in order, before (n,) and y (n,) the columns over the turn, error of one value of y."""
    apart = np.mod(np.roll(x, -1) - np.roll(x, 1), 360.0)
    off = y - (np.roll(before, -1) - np.roll(before, 1)) / apart
    usual = np.sort(np.abs(np.stack([np.roll(off, k) for k in range(-6, 7)])), axis=0)[8]
    sides = np.stack((y - np.roll(y, 1), y - np.roll(y, -1))) * np.sign(off)
    alone = (sides > 0.3 * np.abs(off)).all(axis=0) & (
        np.abs(sides.mean(axis=0) - np.abs(off)) < 0.3 * np.abs(off)
    )  # no kink either
    return np.flatnonzero(alone & (np.abs(off) > SPIKE * np.maximum(usual, error)))


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


__all__ = ["EXACT", "Disagreement", "TurnRows", "disagreements", "scatter", "spikes", "turn_rows"]
