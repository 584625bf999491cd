"""Gaps of a table without rows: dwells where both ends are level, else an error; reflection of half a lobe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil, sqrt

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.measured.rows import scatter
from core.measured.sheet import RowFault, TableError
from core.measured.strokes import shortest
from core.measured.table import SAME, MeasuredTable, distinct_angles, gaps
from core.number_text import result_text

WIDE = 1.5  # a wider gap between the last and the first row, in typical and in widest steps, leaves the turn open
EQUAL = 5.0  # largest difference of the ends of a dwell, in errors
FLAT = 0.1  # largest slope at the ends of a dwell relative to the largest slope, or as much as the errors explain
CLOSES = 0.02  # largest gain of a lobe of velocities or accelerations relative to its peak


class FitError(KindynaError):
    """The table, or this measuring error, gives no motion."""


class OpenTurnError(FitError):
    """The rows leave the turn open: half a lobe, or a lobe without its ends."""


@frozen
class Gap:
    """Interval without rows between two cam angles [deg]; the end may exceed 360.

    ``level`` is that of a dwell there [unit of the motion], None where the rows at both ends are not level.
    """

    start: float
    end: float
    level: float | None


def turn_gaps(table: MeasuredTable, error: float) -> list[Gap]:
    """Gaps of a table.

    Parameters
    ----------
    table : MeasuredTable
    error : float
        Error of a value [unit of ``table.values``].

    Returns
    -------
    list of Gap

    Raises
    ------
    OpenTurnError
        Where the gap between the last and the first row is not level, or velocities and accelerations do not return the
        motion to its start.
    """
    x, index = distinct_angles(table.angles)
    y, n = np.bincount(index, table.values) / np.bincount(index), x.size
    step = np.diff(np.append(x, x[0] + 360.0))
    typical = float(np.median(step))
    is_wide = np.isin(x, [start for start, _ in gaps(table.angles)])
    first, last = int(index[0]), int(index[-1])
    if (first - last) % n != 1:  # descending or unsorted angles
        first, last = (
            (last, first) if (last - first) % n == 1 else ((int(np.argmax(step)) + 1) % n, int(np.argmax(step)))
        )
    is_wide[last] = step[last] > WIDE * typical + SAME
    is_level = _is_level(step, y, is_wide, error)
    if (
        is_wide[last]
        and not is_level[last]
        and step[last] > WIDE * np.delete(step, [last, *np.flatnonzero(is_level)]).max() + SAME
    ):
        difference, allowed = abs(float(y[first] - y[last])), EQUAL * sqrt(2.0) * error
        cause = (
            f"differ by {result_text(difference / abs(table.size), 5)} {table.unit}"
            if difference > allowed
            else "are not level"
        )
        lines = table.lines_text([int(np.flatnonzero(index == i)[0]) for i in (last, first)])
        raise OpenTurnError(
            f"{lines}: no rows from {result_text(x[last])} to {result_text(x[first] or 360.0)} deg, "
            f"and the rows at both ends {cause}; add the rows of the full turn, or mirror half a lobe at the row of its peak: --mirror"
        )
    if is_level.any() and table.layout.order:
        _require_return(np.roll(x, -first), np.roll(y, -first), table.layout.order)
    return [
        Gap(
            float(x[i]),
            float(x[i] + step[i]),
            shortest(0.5 * float(y[i] + y[(i + 1) % n]), error) if is_level[i] else None,
        )
        for i in np.flatnonzero(is_wide).tolist()
    ]


def _is_level(step: np.ndarray, y: np.ndarray, is_wide: np.ndarray, error: float) -> np.ndarray:
    """Whether each gap (n,) has equal values at both ends, and the neighbouring rows continue level."""
    allowed, slope = EQUAL * sqrt(2.0) * error, np.abs(np.roll(y, -1) - y) / step
    level = is_wide & (np.abs(np.roll(y, -1) - y) <= allowed)
    flat = max(FLAT * float(slope[~is_wide].max(initial=0.0)), allowed / float(np.median(step)))
    for direction in (1, -1):
        slope_at_end, next_slope = np.roll(slope, -direction), np.roll(slope, -2 * direction)
        level &= (
            np.minimum(slope_at_end, np.abs(1.5 * slope_at_end - 0.5 * next_slope)) <= flat
        )  # a parabola extrapolates to 0 at its vertex
    return level


def _require_return(x: np.ndarray, y: np.ndarray, order: int) -> None:
    """Raise OpenTurnError where velocities or accelerations (n,) do not return the motion to its start."""
    step = np.mod(np.diff(x), 360.0)
    for _ in range(order):
        y = np.append(0.0, np.cumsum(0.5 * (y[1:] + y[:-1]) * step))
        if abs(y[-1]) > CLOSES * np.abs(y).max():
            raise OpenTurnError(
                "the rows do not cover the turn, and the motion ends "
                f"{result_text(abs(y[-1]) / np.abs(y).max(), 2)} of its stroke from its "
                "start; add the rows of the full turn, or use displacements, which --mirror completes"
            )


def with_dwell_rows(table: MeasuredTable, between: Sequence[Gap]) -> MeasuredTable:
    """Table with rows of a dwell in its gaps, after its own rows; their line is 0."""
    dwells = [gap for gap in between if gap.level is not None]
    if not dwells:
        return table
    x, _ = distinct_angles(table.angles)
    step = float(np.median(np.diff(x)))
    added = [
        np.linspace(gap.start, gap.end, max(2, ceil((gap.end - gap.start) / step - 1e-6) + 1))[1:-1] for gap in dwells
    ]
    level = np.concatenate([np.full(column.size, gap.level) for column, gap in zip(added, dwells, strict=True)])
    angles = np.mod(np.concatenate(added), 360.0)
    return replace(
        table,
        lines=np.append(table.lines, np.zeros(angles.size, dtype=int)),
        angles=np.append(table.angles, angles),
        values=np.append(table.values, level),
        other_columns=tuple(
            replace(column, values=np.append(column.values, np.zeros(angles.size))) for column in table.other_columns
        ),
    )


def mirror_rows(table: MeasuredTable) -> MeasuredTable:
    """Table completed by the reflection of its rows at that of the largest displacement, its first or last.

    Raises TableError where the table has no displacements, the largest is another row, or the rows cover more than half
    a turn.
    """

    def refuse(problem: str) -> TableError:
        return TableError(table.name, [RowFault(0, f"--mirror: {problem}")])

    if table.layout.order:
        raise refuse(f"a table of {table.layout.quantity}; allowed: displacements over half a lobe")
    x, index = distinct_angles(table.angles)
    error = max(
        scatter(x, np.bincount(index, table.values) / np.bincount(index)), abs(table.size) * 10.0**-table.decimals
    )
    y, last = table.values, table.angles.size - 1
    peak = max((0, last), key=lambda row: float(y[row]))
    if float(y[peak]) < float(y.max()) - EQUAL * error:
        raise refuse(
            f"{table.lines_text([int(np.argmax(y))])} has the largest lift and is neither the first nor the last row; allowed: half a "
            "lobe, from or to its peak"
        )
    away = np.mod(table.angles - table.angles[peak] + 180.0, 360.0) - 180.0
    if (
        min(
            away.max(initial=0.0, where=np.abs(away) < 180.0 - SAME),
            -away.min(initial=0.0, where=np.abs(away) < 180.0 - SAME),
        )
        > SAME
    ):
        raise refuse("the rows cover more than half a turn of the cam; allowed: half a lobe, from or to its peak")
    mirrored = np.flatnonzero((np.abs(away) > SAME) & (np.abs(away) < 180.0 - SAME))[::-1]
    order, signs = np.append(np.arange(last + 1), mirrored), np.repeat([1.0, -1.0], [last + 1, mirrored.size])
    if peak == 0:
        order, signs = np.roll(order, mirrored.size), np.roll(signs, mirrored.size)
    angles = np.mod(table.angles[peak] + signs * away[order], 360.0)
    return replace(
        table,
        lines=table.lines[order],
        angles=np.where((angles > 360.0 - SAME) | (angles < SAME), 0.0, angles),
        values=y[order],
        closing=None,
        other_columns=tuple(
            replace(column, values=column.values[order] * (signs if column.order % 2 else 1.0))
            for column in table.other_columns
        ),
        notes=(
            *table.notes,
            f"the rows are mirrored at line {table.lines[peak]} ({result_text(table.angles[peak])} deg)",
        ),
    )
