"""A motion through measured rows: dwells, laws and tables where there are displacements, else the least jerk that the error allows."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from math import floor, log10, sqrt

import numpy as np

from core.design import (
    Design,
    Motion,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
    laid_out,
    require_motion,
    with_motion,
)
from core.design.motion_edits import without_marks
from core.design.rules import MOST_OF_LIST
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws.polynomial import jerk_rows
from core.measured.gap import FitError, Gap, filled, turn_gaps
from core.measured.outliers import Outliers, outliers
from core.measured.rows import Disagreement, TurnRows, disagreements, integrated, scatter, spoiled_runs, turn_rows
from core.measured.sheet import RowFault, TableError, Worksheet, number
from core.measured.smoothing import SplineBasis, basis, derivative, distances, natural
from core.measured.structure import AccelerationJump, SegmentFit, Structure, Switches, far, structured
from core.measured.table import LEAST_ANGLES, MeasuredColumn, MeasuredTable, distinct_angles
from core.measured.units import QUANTITIES
from core.motion import Angles, CompiledMotion, program
from core.numerics.lazy import checkpoint

# -- A table as the curve of one segment ------------------------------------------------------------------------


ORDERS = np.arange(4)
MOST_FAULTS = 100  # that are named
RETURNS = 0.01  # of all that it rises: a measured table ends no nearer to where it began


def rows_of(sheet: Worksheet) -> tuple[np.ndarray, np.ndarray]:
    """Angles and values (n,) of the first two columns, from those of the first row. Raises TableError for a cell that is no number,
    angles that do not rise, or too few rows."""
    faults: list[RowFault] = []
    found: list[tuple[float, float]] = []
    for row in sheet.rows:
        if len(faults) >= MOST_FAULTS:
            break
        cells = [number(cell, sheet.decimal) for cell in row.cells[:2]]
        if len(cells) < 2 or cells[0] is None or cells[1] is None:
            faults.append(RowFault(row.line, f"{' '.join(row.cells)!r}: no angle and value; correct it"))
        elif found and cells[0] <= found[-1][0]:
            faults.append(
                RowFault(row.line, f"angle {cells[0]:g} after {found[-1][0]:g}; sort the rows, each angle once")
            )
        else:
            found.append((cells[0], cells[1]))
    if not faults and not 2 <= len(found) <= MOST_OF_LIST:
        faults.append(RowFault(0, f"{len(found)} rows; allowed: 2 ... {MOST_OF_LIST}"))
    if faults:
        raise TableError(sheet.name, faults)
    x, y = np.array(found).T
    return x - x[0], y - y[0]


def segment_from_table(
    design: Design, index: int, sheet: Worksheet, *, as_is: bool = False, joined: bool = False
) -> Design:
    """The design whose segment follows the table, which need not be whole then. as_is: the table's own span [deg] and rise [the motion's
    unit], for which the next segments give or take; else it is stretched to the segment's. joined: velocity and acceleration at its ends
    are those of its neighbours; else it begins and ends at rest. Raises TableError, also where a table without a rise is to be stretched
    to one."""
    x, y = rows_of(sheet)
    segment, at = require_motion(design).segments[index], f"motion.segments[{index}]"
    if as_is:
        for key, value in (("law", TableCurve.law), ("span_deg", float(x[-1])), ("rise", float(y[-1]))):
            design = laid_out(design, f"{at}.{key}", value)
    elif abs(y[-1]) <= RETURNS * np.ptp(y) and segment.rise:
        raise TableError(
            sheet.name,
            [
                RowFault(
                    0,
                    f"ends where it begins, and the segment rises by {segment.rise:g}; take it as it is, or a whole "
                    "turn as a measured motion",
                )
            ],
        )
    else:
        x, y = x * (segment.span_deg / x[-1]), y * (segment.rise / y[-1] if y[-1] else 1.0)
    motion = require_motion(design)
    x[-1], y[-1] = motion.segments[index].span_deg, motion.segments[index].rise
    points = [SplinePoint(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    if joined:
        for end, (velocity, acceleration) in zip((0, -1), _neighbours(design, index), strict=True):
            points[end] = replace(points[end], velocity=velocity, acceleration=acceleration)
    changed = replace(motion.segments[index], curve=TableCurve(tuple(points)))
    return with_motion(
        design, replace(motion, segments=(*motion.segments[:index], changed, *motion.segments[index + 1 :]))
    )


def _neighbours(design: Design, index: int) -> list[tuple[float, float]]:
    """Velocity and acceleration [unit per degree, per degree²] where the segment before ends and the one behind begins."""
    motion = require_motion(design)
    compiled = program(motion)
    before, behind = (index - 1) % len(motion.segments), (index + 1) % len(motion.segments)
    last = int(np.flatnonzero(compiled.segment == before)[-1])
    first = int(np.flatnonzero(compiled.segment == behind)[0])
    found = []
    for piece, theta in ((last, compiled.ends[last]), (first, compiled.starts[first])):
        y = compiled.state(Angles(np.array([theta]), np.array([piece]))).y[:, 0]
        per_degree = y / motion.scale * np.deg2rad(1.0) ** ORDERS
        found.append((float(per_degree[1]), float(per_degree[2])))
    return found


# -- A motion through measured rows -----------------------------------------------------------------------------


KNOTS = (45, 90, 180, 360, 720)
"""How many knots are tried; 180 where they suffice, more only where the error is finer than they can follow."""
USUAL, MOST = 180, 720
MET = 3.0  # errors, within which a row that was left out is met by the motion of the others: it is not wrong
NEAR = 1e-6  # of their range: velocities and accelerations that laws and dwells meet so are met no better by one spline
EXACT = 1e-9  # of the range of the values: rows that scatter less are exact
OPEN = 3.0  # times the widest step between neighbours: an end farther from the beginning does not come back


class Contradiction(FitError):
    """Rows contradict each other, and it cannot be decided which of them are wrong."""


@frozen(eq=False)
class ColumnFit:
    """What a motion leaves of a column: error, residuals (n,), nan where a cell is left out, and their root mean square over the rows
    used, all in the column's unit; guessed: the error was not stated."""

    column: MeasuredColumn
    error: float
    is_guessed: bool
    residuals: np.ndarray
    rms: float

    @property
    def largest(self) -> int:
        """The row of the largest residual."""
        return int(np.nanargmax(np.abs(self.residuals)))


@frozen(eq=False)
class MotionFit:
    """A motion fitted to a table.

    motion     over the whole turn; it needs the table no longer
    columns    the column of the motion, and those of its other derivatives: error and residuals of each
    found      dwells, laws and tables that the motion is made of; empty: one spline
    jumps      of the acceleration, where the rows show them
    contradicted  columns that are no derivative of the one before
    compared   orders of the columns that the motion is not made of: those that are contradicted, and those behind, or those that the user
               does not trust
    spoiled    by the order of a column the rows of it that contradict those beside them
    outliers   of the motion's column the same, and what may be
    left_out   rows the curve ignores: those that are wrong, and those that may be
    gaps       stretches without a row
    offset     constant that the table adds to a velocity or acceleration; 0 for a displacement
    smoothing  λ of  mean square residual + λ ∫ (d³s/dθ³)² dθ  [deg^(5 - 2k)] for derivative k, of the first stretch that was smoothed
    freedom    how many values the motion was free to choose
    stroke     highest minus lowest position [mm or deg]; lowest: the lowest

    offset is in the unit of the table.
    """

    table: MeasuredTable
    motion: Motion
    columns: tuple[ColumnFit, ...]
    segments: tuple[SegmentFit, ...]
    jumps: tuple[AccelerationJump, ...]
    contradicted: tuple[Disagreement, ...]
    compared: tuple[int, ...]
    spoiled: Mapping[int, tuple[int, ...]]
    outliers: Outliers
    left_out: tuple[int, ...]
    gaps: tuple[Gap, ...]
    offset: float
    smoothing: float
    freedom: float
    stroke: float
    lowest: float

    @property
    def error(self) -> float:
        """The measuring error of the motion's column."""
        return self.columns[0].error

    @property
    def is_guessed(self) -> bool:
        """Whether it was not stated."""
        return self.columns[0].is_guessed

    @property
    def residuals(self) -> np.ndarray:
        """(n,) measured minus curve of the motion's column, for every row."""
        return self.columns[0].residuals

    @property
    def rms(self) -> float:
        """Of the motion's column."""
        return self.columns[0].rms

    @property
    def points(self) -> tuple[SplinePoint, ...]:
        """Of all splines and tables."""
        return tuple(
            point
            for segment in self.motion.segments
            if isinstance(segment.curve, SplineCurve)
            for point in segment.curve.points
        )

    @property
    def largest(self) -> int:
        """The row of the largest residual."""
        return self.columns[0].largest

    @property
    def waves(self) -> float:
        """How much the residuals of rows beside each other differ: 2 where they are at random, near 0 where they go in
        waves (Durbin, Watson 1950)."""
        used = self.table.used_rows(self.left_out)
        left = self.residuals[used[np.argsort(self.table.angles[used], kind="stable")]]
        square = float(left @ left)
        return float(np.sum(np.diff(left) ** 2)) / square if square else 2.0

    def curve(self, angles: np.ndarray, column: int = 0) -> np.ndarray:
        """What the table would hold at these cam angles [deg] without measuring errors, in the unit of one of ``columns``."""
        own = self.columns[column].column
        return _measured(self.motion, own.order, angles) / own.size + (self.offset if column == 0 else 0.0)

    def derivative(self, angles: np.ndarray, order: int) -> np.ndarray:
        """s⁽ᵏ⁾ of the motion (n,) at cam angles [deg], in its own unit per degree^order."""
        return _measured(self.motion, order, angles)


Errors = float | Mapping[str, float] | None
"""Of a value, one standard deviation in the unit of its column: of the motion's column, or by quantity; None = what the rows tell."""


def fit(
    table: MeasuredTable,
    error: Errors = None,
    lowest: float | None = None,
    keep_all: bool = False,
    laws: bool = True,
    dwells: bool = True,
    switches: Switches = (),
) -> MotionFit:
    """The motion of a table: dwells that stand still, laws where they are recognised within the error, and the least jerk that the
    errors allow elsewhere.

    error     0: the rows are as good as their last digit; None: what they tell themselves, at least the rounding of the last digit
    lowest    lowest position of the motion [mm or deg]; None: as measured, 0 for velocities and accelerations
    keep_all  also rows that contradict those beside them, which else are left out
    laws, dwells  whether they are looked for; without both the motion is one spline of least jerk (Reinsch 1967)
    switches  what the segment at a cam angle [deg] shall be in place of what is found: table, dwell, or a named law

    Where columns contradict each other, those that the table's layout trusts make the motion (``ColumnChoice.trust``), else each that
    agrees with the one before it: the answer says which (``contradicted``, ``compared``), and a dialog asks and lays out anew.

    Raises SwitchError where a segment cannot be that, FitError where the error is none, or swallows the whole motion, or columns that are
    trusted contradict each other, the rows leave the turn open, or no motion comes near them; Contradiction where rows contradict each
    other and it cannot be decided which of them are wrong, unless all are kept or the error is 0.
    """
    stated = _stated(table, error)
    own = stated.get(table.layout.quantity)
    between = tuple(turn_gaps(table, _at_least_rounding(table, guess_error(table) if own is None else own)))
    turn = filled(table, between)
    result = outliers(table, (own or 0.0) * abs(table.size))
    all_kept = keep_all or own == 0.0
    doubtful = {*result.wrong, *result.possible, *(row for stretch in result.undecided for row in stretch)}
    others = {} if keep_all or table.layout.order else dict(_spoiled(table, stated, doubtful))
    if result.undecided and not all_kept:
        raise Contradiction(
            f"{contradiction(table, result)}; correct them, state a larger measuring error, or keep all rows"
        )
    out = () if all_kept else tuple(sorted(result.wrong + result.possible))
    errors = {
        each.quantity: stated[each.quantity]
        if each.quantity in stated
        else guess_error(table, _of(each, out, others), i)
        for i, each in enumerate(table.columns)
    }
    rows = _rows(turn, errors, out, others)
    contradicted = tuple(disagreements(rows)) if rows is not None else ()
    compared = _compared(table, rows, contradicted)
    made, offset = None, 0.0
    if rows is not None and (laws or dwells):
        moving, offset = integrated(rows.only(set(rows.values) - set(compared)))
        made = structured(moving, table.motion_unit, laws, dwells, switches)
    if made is None or (table.layout.order and not switches):
        made, offset = _nearer(turn, errors[table.layout.quantity], out, made, offset)
    motion = made.motion
    if not table.layout.order and not switches:
        _require_near(table, motion, _at_least_rounding(table, errors[table.layout.quantity]), out, doubtful)
    compiled = program(motion)
    ends = compiled.state(Angles(compiled.starts, np.arange(compiled.starts.size))).displacement[0] / motion.scale
    low, high = float(ends.min()), float(ends.max())
    wanted = lowest if lowest is not None else (_stands(table) if table.layout.order else low)
    moved = Motion(motion.start + (wanted - low), motion.segments, motion.unit) if wanted != low else motion
    if made.segments and out and not table.layout.order:  # a kink looks like a wrong row until its law is found
        allowed = MET * _at_least_rounding(table, errors[table.layout.quantity])
        left = np.abs(table.values - _measured(motion, 0, table.angles))
        met = {row for row in out if left[row] <= allowed}
        out = tuple(row for row in out if row not in met)
        wrong, possible = (tuple(r for r in rows if r not in met) for rows in (result.wrong, result.possible))
        result = replace(result, wrong=wrong, possible=possible)
    columns = []
    for i, each in enumerate(table.columns):
        missed = (
            each.values - _measured(moved if i else motion, each.order, table.angles) - (0.0 if i else offset)
        ) / each.size
        used = table.used_rows(_of(each, out, others))
        known = missed[used][np.isfinite(missed[used])]
        rms = sqrt(float(np.mean(known**2))) if known.size else 0.0
        columns.append(ColumnFit(each, errors[each.quantity], each.quantity not in stated, missed, rms))
    return MotionFit(
        table=table,
        motion=moved,
        columns=tuple(columns),
        segments=made.segments,
        jumps=made.jumps,
        contradicted=contradicted,
        compared=compared,
        spoiled={table.layout.order: result.wrong, **others},
        outliers=result,
        left_out=out,
        gaps=between,
        offset=offset / table.size,
        smoothing=made.smoothing,
        freedom=made.freedom,
        stroke=high - low,
        lowest=wanted,
    )


def _at_least_rounding(table: MeasuredTable, error: float) -> float:
    """A measuring error in the table's unit as that of ``table.values``, at least that of the last digit."""
    return max(error, 10.0**-table.decimals / sqrt(12.0)) * abs(table.size)


def _require_near(
    table: MeasuredTable, motion: Motion, error: float, out: tuple[int, ...], spoiled: Collection[int]
) -> None:
    """Raises FitError where the rows, but those left out and those at the angle of a spoiled one, are far off the motion. error: of a value
    [as ``table.values``]."""
    x, y = _means(table, out)
    right = ~np.isin(x, table.angles[list(spoiled)])
    off = np.abs(y - _measured(motion, 0, x)) * right
    worst, allowed = int(np.argmax(off)), far(error, float(np.ptp(y[right] if right.any() else y)))
    if off[worst] > allowed:
        size, bound = (f"{value / abs(table.size):.4g} {table.unit}" for value in (off[worst], allowed))
        raise FitError(
            f"at {x[worst]:.6g} deg the rows are {size} off the nearest motion; allowed: at most {bound}; correct the rows there, or state "
            "a larger measuring error"
        )


def _means(table: MeasuredTable, out: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The different cam angles [deg] of the rows but those left out, and the mean of the values at each."""
    used = table.used_rows(out)
    x, place = distinct_angles(table.angles[used])
    return x, np.bincount(place, table.values[used]) / np.bincount(place)


def _stated(table: MeasuredTable, error: Errors) -> dict[str, float]:
    """The errors that were stated, by quantity; one of 0 is that of all columns."""
    if error is None:
        return {}
    given = dict(error) if isinstance(error, Mapping) else {table.layout.quantity: error}
    there = {each.quantity: each.unit for each in table.columns}
    for quantity, value in given.items():
        if quantity not in there:
            raise FitError(
                f"measuring error of the {quantity}: the table has no such column; there are: {', '.join(there)}"
            )
        if not 0.0 <= value < np.inf:
            raise FitError(f"measuring error {value:g}: allowed: 0 or more {there[quantity]}")
    return dict.fromkeys(there, 0.0) | given if error == 0.0 else given


def _compared(table: MeasuredTable, rows: TurnRows | None, contradicted: Collection[Disagreement]) -> tuple[int, ...]:
    """The orders of the columns that the motion is not made of. Raises FitError where columns that are trusted contradict each other."""
    there, trusted = [each.order for each in table.columns], table.layout.trusted
    if not trusted:
        return tuple(order for order in there if any(each.order <= order < 3 for each in contradicted))
    orders = {QUANTITIES.index(quantity) for quantity in trusted}
    for gap in disagreements(rows.only(orders)) if rows is not None else ():
        raise FitError(
            f"the {QUANTITIES[gap.order]} is {gap.factor:.4g} times the derivative of the {QUANTITIES[gap.order - 1]}: they contradict "
            "each other, and not both can be trusted; correct the unit or the speed, or trust one of them"
        )
    return tuple(order for order in there if order not in orders)


def _stands(table: MeasuredTable) -> float:
    """The lowest position that a table of velocities or accelerations tells, by a column of displacements beside them; 0 without one."""
    return next((float(np.nanmin(each.values)) for each in table.other_columns if not each.order), 0.0)


def _spoiled(
    table: MeasuredTable, stated: Mapping[str, float], doubtful: Collection[int]
) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Of the other columns, by their order, the rows that contradict the column before; doubtful: rows whose own displacement is wrong."""
    every = np.delete(np.arange(table.angles.size), table.closing[:1] if table.closing else ())
    every = every[np.argsort(table.angles[every], kind="stable")]
    if every.size != distinct_angles(table.angles[every])[0].size:
        return
    by_order = {each.order: (i, each) for i, each in enumerate(table.columns)}
    for each in table.other_columns:
        if each.order >= len(QUANTITIES) or each.order - 1 not in by_order:
            continue
        both = by_order[each.order - 1], by_order[each.order]
        known = np.isfinite([column.values[every] for _, column in both]).all(axis=0)
        rows = every[known & ~np.isin(every, list(doubtful))]
        if rows.size < LEAST_ANGLES:
            continue
        left_out = tuple(doubtful)
        before, own = (
            max(stated.get(column.quantity, guess_error(table, left_out, i)), 10.0**-column.decimals / sqrt(12.0))
            * abs(column.size)
            for i, column in both
        )
        y, dy = (column.values[rows] for _, column in both)
        runs = spoiled_runs(table.angles[rows], y, dy, before, own)
        wrong = tuple(sorted(rows[[k for run in runs for k in run]].tolist())) if runs else ()
        doubtful = {*doubtful, *wrong}
        yield each.order, wrong


def _of(column: MeasuredColumn, out: tuple[int, ...], others: Mapping[int, tuple[int, ...]]) -> tuple[int, ...]:
    """The rows that a column goes without."""
    return tuple(sorted({*out, *others.get(column.order, ())}))


def _rows(
    table: MeasuredTable, errors: Mapping[str, float], out: tuple[int, ...], others: Mapping[int, tuple[int, ...]]
) -> TurnRows | None:
    """The rows of a table that move."""
    error = errors[table.layout.quantity]
    whole = float(np.std(table.values[table.used_rows(out)])) / abs(table.size)
    if not whole:
        return None
    if error >= whole:
        raise FitError(
            f"measuring error {error:g} {table.unit}: no smaller than the motion itself; allowed: 0 ... {whole:.6g} {table.unit}"
        )
    by_order = {
        each.order: max(errors[each.quantity], 10.0**-each.decimals / sqrt(12.0)) * abs(each.size)
        for each in table.columns
    }
    return turn_rows(table, by_order, out, others)


def contradiction(table: MeasuredTable, result: Outliers) -> str:
    """The rows that contradict each other where it cannot be decided which of them are wrong."""
    rows = [row for stretch in result.undecided for row in stretch]
    text = f"{table.lines_text(rows)}: they contradict each other, and nothing tells which of them are wrong{_left_open(table)}"
    either = " or ".join(f"{table.lines_text(reading)} ({len(reading)} rows)" for reading in result.readings)
    return f"{text}: {either} may be, to be left out" if either else text


def _left_open(table: MeasuredTable) -> str:
    """That the rows do not come back, where they end farther from their beginning than any two neighbours are apart; else empty."""
    order = np.argsort(table.angles, kind="stable")
    last, first = table.closing or (int(order[-1]), int(order[0]))
    inner = table.values[order[order != last] if table.closing else order]
    if table.layout.order or not abs(table.values[last] - table.values[first]) > OPEN * np.abs(np.diff(inner)).max():
        return ""
    jump = abs(table.values[last] - table.values[first]) / abs(table.size)
    return (
        f" (line {table.lines[last]}, where the turn ends, is {jump:.6g} {table.unit} from line {table.lines[first]}, where it begins: a "
        "motion read from a table must come back)"
    )


def guess_error(table: MeasuredTable, left_out: tuple[int, ...] = (), column: int = 0) -> float:
    """The measuring error of a column that the scatter of its rows shows (``rows.scatter``), at least that of rounding to the last digit;
    two digits of it, in the column's unit, and 0 where the rows are exact."""
    checkpoint()
    each = table.columns[column]
    used = table.used_rows(left_out)
    used = used[np.isfinite(each.values[used])]
    x, place = distinct_angles(table.angles[used])
    if x.size < LEAST_ANGLES:
        return 0.0
    count = np.bincount(place)
    seen = (
        scatter(x, np.bincount(place, each.values[used]) / count, each.order)
        * sqrt(float(np.median(count)))
        / abs(each.size)
    )
    result = max(seen, 10.0**-each.decimals / sqrt(12.0))
    if result <= EXACT * float(np.ptp(each.values[used])) / abs(each.size):
        return 0.0
    power = 10.0 ** (floor(log10(result)) - 1)
    return float(f"{np.ceil(result / power) * power:.2g}")


def with_measured_motion(design: Design, fit: MotionFit) -> Design:
    """The design with its motion replaced by the measured one. Raises DesignError where its follower moves otherwise."""
    unit = require_motion(design).unit
    if fit.motion.unit != unit:
        value = f"measured in {fit.motion.unit}"
        raise DesignError(
            [Fault("motion", value, "the follower of this design does not move so", f"a table in {unit}")]
        )
    return without_marks(with_motion(design, fit.motion))


# -- solving ----------------------------------------------------------------------------------------------


@frozen(eq=False)
class _Solved:
    """knots [deg] and the states s, s', s'' there by u (m, 3); offset: what the table adds, by degrees, 0 for a
    displacement."""

    knots: np.ndarray
    at: np.ndarray
    offset: float
    smoothing: float
    freedom: float


def _solved(table: MeasuredTable, error: float, out: tuple[int, ...]) -> _Solved:
    used = table.used_rows(out)
    x, mean = _means(table, out)
    if not np.ptp(mean):  # nothing moves
        few = slice(None, None, -(-x.size // LEAST_ANGLES))
        return _through(table, x[few], mean[few])
    if error == 0.0 and x.size <= MOST:
        return _through(table, x, mean)
    wanted = (error * table.size * 360.0**table.layout.order) ** 2
    whole = float(np.var(table.values[used])) * 360.0 ** (2 * table.layout.order)
    if wanted >= whole:
        most = sqrt(whole) / 360.0**table.layout.order / abs(table.size)
        raise FitError(
            f"measuring error {error:g} {table.unit}: no smaller than the motion itself; allowed: 0 ... {most:.6g} {table.unit}"
        )
    rows = _knotted(table, wanted, x.size, out)
    return _smoothed(rows, _lambda(rows, wanted))


def _knotted(table: MeasuredTable, wanted: float, angles: int, out: tuple[int, ...]) -> SplineBasis:
    """With twice the knots that could just follow the rows within the error, so that it is the jerk which decides; all
    rows where they are few."""
    if angles <= USUAL:
        return basis(table, USUAL, out)
    tried = KNOTS if wanted else KNOTS[-1:]  # exact rows take the most
    for i, count in enumerate(tried):
        checkpoint()
        rows = basis(table, count, out)
        if rows.least < wanted:
            return basis(table, tried[i + 1], out) if count < USUAL else rows
        if count >= angles:
            break
    return rows


def _lambda(rows: SplineBasis, wanted: float) -> float:
    """λ at which the mean square of the residuals is as wanted; the least where they stay above it."""
    low, high = -14.0, 18.0
    for _ in range(64):
        middle = 0.5 * (low + high)
        if float(rows.mean_square(rows.scale * 10.0**middle)) < wanted:
            low = middle
        else:
            high = middle
    return rows.scale * 10.0**low


def _smoothed(rows: SplineBasis, smoothing: float) -> _Solved:
    weights = rows.weights(smoothing)
    at = rows.at @ weights
    constant = float(np.mean(rows.values) - rows.mean @ weights)
    freedom = float(rows.freedom(smoothing))
    if rows.order == 0:
        at[:, 0] += constant
    by_degree = 360.0 ** (5 - 2 * rows.order)
    offset = constant / 360.0**rows.order if rows.order else 0.0
    return _Solved(rows.knots, at, offset, smoothing * by_degree, freedom)


def _through(table: MeasuredTable, knots: np.ndarray, values: np.ndarray) -> _Solved:
    """The curve of least jerk through all values; the offset of velocities is that which costs least jerk."""
    order = table.layout.order
    given = values * 360.0**order
    if order == 0:
        at = natural(knots, 0, (given - given[0])[:, None])[:, :, 0]
        at[:, 0] += given[0]
        return _Solved(knots, at, 0.0, 0.0, float(knots.size))
    if order == 2:
        each = natural(knots, 2, np.eye(knots.size)[:, 1:])
        rows = derivative(knots, each, 2, knots)
        result = np.linalg.solve(np.column_stack((rows, np.ones(knots.size))), given)
        at = each @ result[:-1]
        at[:, 2] = given - result[-1]
        return _Solved(knots, at, float(result[-1]) / 360.0**2, 0.0, float(knots.size))
    both = natural(knots, order, np.stack((given, np.ones(knots.size)), axis=1))
    jerk = jerk_rows(distances(knots), both, np.roll(both, -1, axis=0))
    own, one = jerk[:, :, 0].ravel(), jerk[:, :, 1].ravel()
    offset = float(own @ one / (one @ one))
    return _Solved(knots, both[:, :, 0] - offset * both[:, :, 1], offset / 360.0**order, 0.0, float(knots.size))


# -- the motion -------------------------------------------------------------------------------------------


def _motion(table: MeasuredTable, solved: _Solved) -> Motion:
    """One spline over the turn: its points are positions at the knots, and there too what was measured, so that no
    velocity or acceleration hangs on differences of positions."""
    start = float(derivative(solved.knots, solved.at[:, :, None], 0, np.zeros(1))[0, 0])
    order, by_degree = table.layout.order, 360.0**table.layout.order
    names = ("", "velocity", "acceleration")
    points = tuple(
        SplinePoint(place, state[0] - start, **({names[order]: state[order] / by_degree} if order else {}))
        for place, state in zip(solved.knots.tolist(), solved.at.tolist(), strict=True)
    )
    return Motion(start, (Segment(360.0, 0.0, SplineCurve(points)),), table.motion_unit)


def _nearer(
    table: MeasuredTable, error: float, out: tuple[int, ...], made: Structure | None, offset: float
) -> tuple[Structure, float]:
    """One spline and what the table adds to it, or the dwells and laws that were found with theirs, where these meet the rows as well."""
    missed = np.inf if made is None else _missed(table, made.motion, offset, out)
    enough = max(MET * error, NEAR * float(np.ptp(table.values[table.used_rows(out)])) / abs(table.size))
    if made is not None and missed <= enough:
        return made, offset
    solved = _solved(table, error, out)
    spline = Structure(_motion(table, solved), (), (), solved.freedom, solved.smoothing)
    if made is not None and missed <= _missed(table, spline.motion, solved.offset, out):
        return made, offset
    return spline, solved.offset


def _missed(table: MeasuredTable, motion: Motion, offset: float, out: tuple[int, ...]) -> float:
    """By how much the rows are off the motion: root of the mean square, in the table's unit."""
    rows = table.used_rows(out)
    left = table.values[rows] - _measured(motion, table.layout.order, table.angles[rows]) - offset
    return sqrt(float(np.mean(left**2))) / abs(table.size)


def _measured(motion: Motion, order: int, angles: np.ndarray) -> np.ndarray:
    """s⁽ᵏ⁾ of the motion (n,) by degrees at cam angles [deg], in its own unit."""
    compiled: CompiledMotion = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad(angles))).displacement[order]
    return y * (np.pi / 180.0) ** order / motion.scale
