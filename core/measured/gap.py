"""Stretches of the turn without a row: a dwell where the rows at both ends are level, half a lobe that is mirrored, or a refusal."""

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

WIDE = 1.5  # steps, and the widest other step: an end of the rows farther from the other leaves the turn open
EQUAL = 5.0  # errors that the ends of a dwell may differ by
FLAT = 0.1  # of the largest slope of the rows: the slope at the ends of a dwell, at most, or as much as the errors make of it
CLOSES = 0.02  # of what it rises to: what a lobe of velocities or accelerations may gain over its rows


class FitError(KindynaError):
    """No motion can be made of the table, or none with this measuring error."""


class OpenTurnError(FitError):
    """The rows leave the turn open: half a lobe, or one without its ends."""


@frozen
class Gap:
    """From cam angle to cam angle [deg], the second counted on past 360; level: of the dwell there, in the motion's unit, None where the
    rows at both ends are not level."""

    start: float
    end: float
    level: float | None


def turn_gaps(table: MeasuredTable, error: float) -> list[Gap]:
    """The gaps of a table. error: of a value [as ``table.values``].

    Raises OpenTurnError where the first and the last row are the ends of one and are not level, or where nothing tells what velocities
    and accelerations do there.
    """
    x, place = distinct_angles(table.angles)
    y, n = np.bincount(place, table.values) / np.bincount(place), x.size
    step = np.diff(np.append(x, x[0] + 360.0))
    usual = float(np.median(step))
    wide = np.isin(x, [start for start, _ in gaps(table.angles)])
    first, last = int(place[0]), int(place[-1])
    if (first - last) % n != 1:  # the angles fall, or the rows are in another order
        first, last = (
            (last, first) if (last - first) % n == 1 else ((int(np.argmax(step)) + 1) % n, int(np.argmax(step)))
        )
    wide[last] = step[last] > WIDE * usual + SAME
    level = _is_level(step, y, wide, error)
    if (
        wide[last]
        and not level[last]
        and step[last] > WIDE * np.delete(step, [last, *np.flatnonzero(level)]).max() + SAME
    ):
        apart, allowed = abs(float(y[first] - y[last])), EQUAL * sqrt(2.0) * error
        differ = f"differ by {apart / abs(table.size):.6g} {table.unit}" if apart > allowed else "are not level"
        lines = table.lines_text([int(np.flatnonzero(place == i)[0]) for i in (last, first)])
        raise OpenTurnError(
            f"{lines}: no rows from {x[last]:.6g} to {x[first] or 360.0:.6g} deg, "
            f"and the rows at both ends {differ}; add the rows of the whole turn, or reflect half a lobe in the row of its peak: --mirror"
        )
    if level.any() and table.layout.order:
        _require_return(np.roll(x, -first), np.roll(y, -first), table.layout.order)
    return [
        Gap(
            float(x[i]),
            float(x[i] + step[i]),
            shortest(0.5 * float(y[i] + y[(i + 1) % n]), error) if level[i] else None,
        )
        for i in np.flatnonzero(wide).tolist()
    ]


def _is_level(step: np.ndarray, y: np.ndarray, wide: np.ndarray, error: float) -> np.ndarray:
    """Which gaps (n,) have equal rows at both ends that go on level, as far as the rows next to them tell."""
    allowed, slope = EQUAL * sqrt(2.0) * error, np.abs(np.roll(y, -1) - y) / step
    level = wide & (np.abs(np.roll(y, -1) - y) <= allowed)
    flat = max(FLAT * float(slope[~wide].max(initial=0.0)), allowed / float(np.median(step)))
    for way in (1, -1):
        near, next_to_it = np.roll(slope, -way), np.roll(slope, -2 * way)
        level &= np.minimum(near, np.abs(1.5 * near - 0.5 * next_to_it)) <= flat  # of a parabola at its vertex 0
    return level


def _require_return(x: np.ndarray, y: np.ndarray, order: int) -> None:
    """Raises OpenTurnError where velocities or accelerations (n,) do not bring the motion back over their rows."""
    step = np.mod(np.diff(x), 360.0)
    for _ in range(order):
        y = np.append(0.0, np.cumsum(0.5 * (y[1:] + y[:-1]) * step))
        if abs(y[-1]) > CLOSES * np.abs(y).max():
            raise OpenTurnError(
                f"the rows do not cover the turn, and the motion ends {abs(y[-1]) / np.abs(y).max():.2g} of its stroke from where it "
                "begins; add the rows of the whole turn, or take displacements, which --mirror reflects"
            )


def filled(table: MeasuredTable, between: Sequence[Gap]) -> MeasuredTable:
    """The table with rows of a dwell in its gaps, behind its own; their line is 0."""
    dwells = [gap for gap in between if gap.level is not None]
    if not dwells:
        return table
    x, _ = distinct_angles(table.angles)
    step = float(np.median(np.diff(x)))
    added = [
        np.linspace(gap.start, gap.end, max(2, ceil((gap.end - gap.start) / step - 1e-6) + 1))[1:-1] for gap in dwells
    ]
    level = np.concatenate([np.full(each.size, gap.level) for each, gap in zip(added, dwells, strict=True)])
    angles = np.mod(np.concatenate(added), 360.0)
    return replace(
        table,
        lines=np.append(table.lines, np.zeros(angles.size, dtype=int)),
        angles=np.append(table.angles, angles),
        values=np.append(table.values, level),
        other_columns=tuple(
            replace(each, values=np.append(each.values, np.zeros(angles.size))) for each in table.other_columns
        ),
    )


def mirror_rows(table: MeasuredTable) -> MeasuredTable:
    """The table with its rows reflected in that of the largest displacement, its first or last.

    Raises TableError where there are no displacements, the largest is another row, or the rows cover more than half a turn.
    """

    def refuse(problem: str) -> TableError:
        return TableError(table.name, [RowFault(0, f"--mirror: {problem}")])

    if table.layout.order:
        raise refuse(f"a table of {table.layout.quantity}; wanted: displacements over half a lobe")
    x, place = distinct_angles(table.angles)
    error = max(
        scatter(x, np.bincount(place, table.values) / np.bincount(place)), abs(table.size) * 10.0**-table.decimals
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
        raise refuse("the rows cover more than half a turn of the cam; wanted: half a lobe, from or to its peak")
    reflected = np.flatnonzero((np.abs(away) > SAME) & (np.abs(away) < 180.0 - SAME))[::-1]
    order, signs = np.append(np.arange(last + 1), reflected), np.repeat([1.0, -1.0], [last + 1, reflected.size])
    if peak == 0:
        order, signs = np.roll(order, reflected.size), np.roll(signs, reflected.size)
    angles = np.mod(table.angles[peak] + signs * away[order], 360.0)
    return replace(
        table,
        lines=table.lines[order],
        angles=np.where((angles > 360.0 - SAME) | (angles < SAME), 0.0, angles),
        values=y[order],
        closing=None,
        other_columns=tuple(
            replace(each, values=each.values[order] * (signs if each.order % 2 else 1.0))
            for each in table.other_columns
        ),
        notes=(*table.notes, f"the rows are reflected in line {table.lines[peak]} ({table.angles[peak]:.6g} deg)"),
    )


__all__ = ["FitError", "Gap", "OpenTurnError", "filled", "mirror_rows", "turn_gaps"]
