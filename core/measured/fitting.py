"""Motions fitted to measured rows: dwells, laws and tables, or the spline of least jerk that the errors allow."""

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
    require_motion,
    with_motion,
)
from core.design.motion_edits import without_marks
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws.polynomial import jerk_rows
from core.measured.gap import FitError, Gap, turn_gaps, with_dwell_rows
from core.measured.outliers import Outliers, outliers
from core.measured.rows import Disagreement, TurnRows, disagreements, integrated, scatter, spoiled_runs, turn_rows
from core.measured.smoothing import SplineBasis, basis, derivative, distances, natural
from core.measured.structure import AccelerationJump, SegmentFit, Structure, Switches, far, motion_structure
from core.measured.table import LEAST_ANGLES, MeasuredColumn, MeasuredTable, distinct_angles
from core.measured.units import QUANTITIES
from core.motion import Angles, CompiledMotion, program
from core.number_text import result_text
from core.numerics.lazy import checkpoint

# -- motion through measured rows -------------------------------------------------------------------------------


KNOTS = (45, 90, 180, 360, 720)
"""Numbers of knots in the order of trial; more than 180 only where the error requires them."""
TYPICAL, MOST = 180, 720
MET = 3.0  # residual in errors, below which a row that was left out agrees with the motion
NEAR = 1e-6  # residual relative to the range, below which laws and dwells fit as well as a spline
EXACT = 1e-9  # scatter relative to the range of the values, below which rows are exact
OPEN = 3.0  # least difference of the ends of an open table, in widest steps between neighbours


class Contradiction(FitError):
    """Rows contradict each other, and it cannot be decided which of them are wrong."""


@frozen(eq=False)
class ColumnFit:
    """Residuals of a column.

    Attributes
    ----------
    error : error of a value [unit of the column]
    is_guessed : whether the error was not stated
    residuals : ndarray (n,) [unit of the column], measured minus fitted; NaN where a cell is left out
    rms : root mean square of the residuals of the rows in use [unit of the column]
    """

    column: MeasuredColumn
    error: float
    is_guessed: bool
    residuals: np.ndarray
    rms: float

    @property
    def largest(self) -> int:
        """Row of the largest residual."""
        return int(np.nanargmax(np.abs(self.residuals)))


@frozen(eq=False)
class MotionFit:
    """A motion fitted to a table.

    Attributes
    ----------
    motion : over the full turn, independent of the table
    columns : residuals of the column of the motion, and of those of its other derivatives
    segments : recognised dwells, laws and tables; empty for one spline
    jumps : jumps of the acceleration that the rows show
    contradicted : columns that are no derivative of the previous column
    compared : orders of the columns that do not determine the motion: contradicted ones and those after them, or those
        that the user does not trust
    spoiled : order of a column -> its rows that contradict the neighbouring rows
    outliers : wrong and possibly wrong rows of the column of the motion
    left_out : rows that the curve ignores: wrong and possibly wrong ones
    gaps : intervals without rows
    offset : constant that the table adds to a velocity or acceleration [unit of the table], 0 for a displacement
    smoothing : λ of mean square residual + λ ∫ (d³s/dθ³)² dθ [deg^(5 - 2k)] for derivative k, of the first smoothed
        interval
    freedom : number of free values of the motion
    stroke, lowest : highest minus lowest position, and lowest position [mm or deg]
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
        """Measuring error of the column of the motion."""
        return self.columns[0].error

    @property
    def is_guessed(self) -> bool:
        """Whether that error was not stated."""
        return self.columns[0].is_guessed

    @property
    def residuals(self) -> np.ndarray:
        """Residuals (n,) of the column of the motion, measured minus fitted [unit of the table]."""
        return self.columns[0].residuals

    @property
    def rms(self) -> float:
        """Root mean square residual of the column of the motion."""
        return self.columns[0].rms

    @property
    def points(self) -> tuple[SplinePoint, ...]:
        """Points of all splines and tables."""
        return tuple(
            point
            for segment in self.motion.segments
            if isinstance(segment.curve, SplineCurve)
            for point in segment.curve.points
        )

    @property
    def largest(self) -> int:
        """Row of the largest residual."""
        return self.columns[0].largest

    @property
    def waves(self) -> float:
        """Durbin-Watson statistic of the residuals in the order of the angles: 2 at random, near 0 in waves.

        Durbin and Watson 1950.
        """
        used = self.table.used_rows(self.left_out)
        left = self.residuals[used[np.argsort(self.table.angles[used], kind="stable")]]
        square = float(left @ left)
        return float(np.sum(np.diff(left) ** 2)) / square if square else 2.0

    def curve(self, angles: np.ndarray, column: int = 0) -> np.ndarray:
        """Fitted values of a column.

        Parameters
        ----------
        angles : ndarray (n,) [deg]
            Cam angles.
        column : int
            Index in ``columns``.

        Returns
        -------
        ndarray (n,) [unit of the column]
        """
        measured = self.columns[column].column
        return _measured(self.motion, measured.order, angles) / measured.size + (self.offset if column == 0 else 0.0)

    def derivative(self, angles: np.ndarray, order: int) -> np.ndarray:
        """Derivative of the motion by cam angle.

        Parameters
        ----------
        angles : ndarray (n,) [deg]
            Cam angles.
        order : int
            Order of the derivative.

        Returns
        -------
        ndarray (n,) [unit of the motion per deg^order]
        """
        return _measured(self.motion, order, angles)


Errors = float | Mapping[str, float] | None
"""Standard deviation of a value in the unit of its column: for the motion's column, or by quantity; None: from the rows."""


def fit(
    table: MeasuredTable,
    error: Errors = None,
    lowest: float | None = None,
    keep_all: bool = False,
    laws: bool = True,
    dwells: bool = True,
    switches: Switches = (),
) -> MotionFit:
    """Motion of a table: dwells, laws recognised within the error, and the least jerk that the errors allow elsewhere.

    Where columns contradict each other, the trusted ones (``ColumnChoice.trust``) determine the motion, else each
    column that agrees with the previous one; the result lists the others (``contradicted``, ``compared``).

    Parameters
    ----------
    table : MeasuredTable
    error : Errors
        0: the rows are exact to their last digit; None: estimated from the rows, at least the rounding of the last
        digit.
    lowest : float [mm or deg], optional
        Lowest position of the motion; default: as measured, 0 for velocities and accelerations.
    keep_all : bool
        Also use rows that contradict their neighbours.
    laws, dwells : bool
        Recognise laws and dwells; without both the motion is one spline of least jerk.
    switches : Switches
        Required kind of the segment at a cam angle [deg]: table, dwell, or a named law.

    Returns
    -------
    MotionFit

    Raises
    ------
    SwitchError
        Where a segment cannot have its required kind.
    FitError
        Where the error is invalid or exceeds the motion, trusted columns contradict each other, the rows leave the turn
        open, or no motion is near them.
    Contradiction
        Where rows contradict each other and it cannot be decided which of them are wrong, unless all are used or the
        error is 0.

    References
    ----------
    Reinsch 1967, Smoothing by spline functions.
    """
    stated = _stated(table, error)
    stated_error = stated.get(table.layout.quantity)
    gaps = tuple(
        turn_gaps(table, _at_least_rounding(table, guess_error(table) if stated_error is None else stated_error))
    )
    turn = with_dwell_rows(table, gaps)
    result = outliers(table, (stated_error or 0.0) * abs(table.size))
    use_all = keep_all or stated_error == 0.0
    doubtful = {*result.wrong, *result.possible, *(row for stretch in result.undecided for row in stretch)}
    spoiled = {} if keep_all or table.layout.order else dict(_spoiled(table, stated, doubtful))
    if result.undecided and not use_all:
        raise Contradiction(
            f"{contradiction(table, result)}; correct them, state a larger measuring error, or keep all rows"
        )
    left_out = () if use_all else tuple(sorted(result.wrong + result.possible))
    errors = {
        column.quantity: stated[column.quantity]
        if column.quantity in stated
        else guess_error(table, _rows_left_out(column, left_out, spoiled), i)
        for i, column in enumerate(table.columns)
    }
    rows = _rows(turn, errors, left_out, spoiled)
    contradicted = tuple(disagreements(rows)) if rows is not None else ()
    compared = _compared(table, rows, contradicted)
    fitted_structure, offset = None, 0.0
    if rows is not None and (laws or dwells):
        moving, offset = integrated(rows.only(set(rows.values) - set(compared)))
        fitted_structure = motion_structure(moving, table.motion_unit, laws, dwells, switches)
    if fitted_structure is None or (table.layout.order and not switches):
        fitted_structure, offset = _better_structure(
            turn, errors[table.layout.quantity], left_out, fitted_structure, offset
        )
    motion = fitted_structure.motion
    if not table.layout.order and not switches:
        _require_near(table, motion, _at_least_rounding(table, errors[table.layout.quantity]), left_out, doubtful)
    compiled = program(motion)
    ends = compiled.state(Angles(compiled.starts, np.arange(compiled.starts.size))).displacement[0] / motion.scale
    low, high = float(ends.min()), float(ends.max())
    lowest_position = lowest if lowest is not None else (_lowest_measured(table) if table.layout.order else low)
    shifted = (
        Motion(motion.start + (lowest_position - low), motion.segments, motion.unit)
        if lowest_position != low
        else motion
    )
    if (
        fitted_structure.segments and left_out and not table.layout.order
    ):  # a kink looks like a wrong row until its law is found
        allowed = MET * _at_least_rounding(table, errors[table.layout.quantity])
        distance = np.abs(table.values - _measured(motion, 0, table.angles))
        agreeing = {row for row in left_out if distance[row] <= allowed}
        left_out = tuple(row for row in left_out if row not in agreeing)
        wrong, possible = (tuple(r for r in rows if r not in agreeing) for rows in (result.wrong, result.possible))
        result = replace(result, wrong=wrong, possible=possible)
    columns = []
    for i, column in enumerate(table.columns):
        residuals = (
            column.values - _measured(shifted if i else motion, column.order, table.angles) - (0.0 if i else offset)
        ) / column.size
        used = table.used_rows(_rows_left_out(column, left_out, spoiled))
        finite = residuals[used][np.isfinite(residuals[used])]
        rms = sqrt(float(np.mean(finite**2))) if finite.size else 0.0
        columns.append(ColumnFit(column, errors[column.quantity], column.quantity not in stated, residuals, rms))
    return MotionFit(
        table=table,
        motion=shifted,
        columns=tuple(columns),
        segments=fitted_structure.segments,
        jumps=fitted_structure.jumps,
        contradicted=contradicted,
        compared=compared,
        spoiled={table.layout.order: result.wrong, **spoiled},
        outliers=result,
        left_out=left_out,
        gaps=gaps,
        offset=offset / table.size,
        smoothing=fitted_structure.smoothing,
        freedom=fitted_structure.freedom,
        stroke=high - low,
        lowest=lowest_position,
    )


def _at_least_rounding(table: MeasuredTable, error: float) -> float:
    """Measuring error, at least the rounding of the last digit [unit of ``table.values``]."""
    return max(error, 10.0**-table.decimals / sqrt(12.0)) * abs(table.size)


def _require_near(
    table: MeasuredTable, motion: Motion, error: float, left_out: tuple[int, ...], spoiled: Collection[int]
) -> None:
    """Raise FitError where rows in use are far from the motion; ``error`` in the unit of ``table.values``.

    Rows at the angle of a spoiled row are ignored.
    """
    x, y = _means(table, left_out)
    is_valid = ~np.isin(x, table.angles[list(spoiled)])
    distance = np.abs(y - _measured(motion, 0, x)) * is_valid
    worst, allowed = int(np.argmax(distance)), far(error, float(np.ptp(y[is_valid] if is_valid.any() else y)))
    if distance[worst] > allowed:
        size, bound = (f"{result_text(value / abs(table.size))} {table.unit}" for value in (distance[worst], allowed))
        raise FitError(
            f"at {result_text(x[worst], 5)} deg the rows are {size} away from the nearest motion; allowed: at "
            f"most {bound}; correct them, or state "
            "a larger measuring error"
        )


def _means(table: MeasuredTable, left_out: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Distinct cam angles [deg] of the rows in use, and the mean of the values at each."""
    used = table.used_rows(left_out)
    x, index = distinct_angles(table.angles[used])
    return x, np.bincount(index, table.values[used]) / np.bincount(index)


def _stated(table: MeasuredTable, error: Errors) -> dict[str, float]:
    """Stated errors by quantity; an error of 0 holds for all columns."""
    if error is None:
        return {}
    errors = dict(error) if isinstance(error, Mapping) else {table.layout.quantity: error}
    units = {column.quantity: column.unit for column in table.columns}
    for quantity, value in errors.items():
        if quantity not in units:
            raise FitError(
                f"measuring error of the {quantity}: the table has no such column; columns: {', '.join(units)}"
            )
        if not 0.0 <= value < np.inf:
            raise FitError(f"measuring error {value:g}: allowed: 0 or more {units[quantity]}")
    return dict.fromkeys(units, 0.0) | errors if error == 0.0 else errors


def _compared(table: MeasuredTable, rows: TurnRows | None, contradicted: Collection[Disagreement]) -> tuple[int, ...]:
    """Orders of the columns that do not determine the motion. Raises FitError where trusted columns disagree."""
    available, trusted = [column.order for column in table.columns], table.layout.trusted
    if not trusted:
        return tuple(order for order in available if any(column.order <= order < 3 for column in contradicted))
    orders = {QUANTITIES.index(quantity) for quantity in trusted}
    for pair in disagreements(rows.only(orders)) if rows is not None else ():
        raise FitError(
            f"the {QUANTITIES[pair.order]} is {result_text(pair.factor)} times the derivative of the "
            f"{QUANTITIES[pair.order - 1]}: they contradict "
            "each other; correct the unit or the speed, or trust only one of them"
        )
    return tuple(order for order in available if order not in orders)


def _lowest_measured(table: MeasuredTable) -> float:
    """Lowest position in a column of displacements of a table of velocities or accelerations; 0 without one."""
    return next((float(np.nanmin(column.values)) for column in table.other_columns if not column.order), 0.0)


def _spoiled(
    table: MeasuredTable, stated: Mapping[str, float], doubtful: Collection[int]
) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Order of each other column, and its rows that contradict the previous column.

    ``doubtful``: rows whose displacement is wrong.
    """
    rows_in_order = np.delete(np.arange(table.angles.size), table.closing[:1] if table.closing else ())
    rows_in_order = rows_in_order[np.argsort(table.angles[rows_in_order], kind="stable")]
    if rows_in_order.size != distinct_angles(table.angles[rows_in_order])[0].size:
        return
    by_order = {other.order: (i, other) for i, other in enumerate(table.columns)}
    for other in table.other_columns:
        if other.order >= len(QUANTITIES) or other.order - 1 not in by_order:
            continue
        pair = by_order[other.order - 1], by_order[other.order]
        is_finite = np.isfinite([column.values[rows_in_order] for _, column in pair]).all(axis=0)
        rows = rows_in_order[is_finite & ~np.isin(rows_in_order, list(doubtful))]
        if rows.size < LEAST_ANGLES:
            continue
        left_out = tuple(doubtful)
        previous_error, error = (
            max(stated.get(column.quantity, guess_error(table, left_out, i)), 10.0**-column.decimals / sqrt(12.0))
            * abs(column.size)
            for i, column in pair
        )
        values, derivatives = (column.values[rows] for _, column in pair)
        runs = spoiled_runs(table.angles[rows], values, derivatives, previous_error, error)
        wrong = tuple(sorted(rows[[k for run in runs for k in run]].tolist())) if runs else ()
        doubtful = {*doubtful, *wrong}
        yield other.order, wrong


def _rows_left_out(
    column: MeasuredColumn, left_out: tuple[int, ...], spoiled: Mapping[int, tuple[int, ...]]
) -> tuple[int, ...]:
    """Rows that are left out of a column."""
    return tuple(sorted({*left_out, *spoiled.get(column.order, ())}))


def _rows(
    table: MeasuredTable, errors: Mapping[str, float], left_out: tuple[int, ...], spoiled: Mapping[int, tuple[int, ...]]
) -> TurnRows | None:
    """Rows of a table over one turn; None where nothing moves."""
    error = errors[table.layout.quantity]
    deviation = float(np.std(table.values[table.used_rows(left_out)])) / abs(table.size)
    if not deviation:
        return None
    if error >= deviation:
        raise FitError(
            f"measuring error {error:g} {table.unit}: as large as the motion; allowed: 0 ... {result_text(deviation, 5)} {table.unit}"
        )
    by_order = {
        column.order: max(errors[column.quantity], 10.0**-column.decimals / sqrt(12.0)) * abs(column.size)
        for column in table.columns
    }
    return turn_rows(table, by_order, left_out, spoiled)


def contradiction(table: MeasuredTable, result: Outliers) -> str:
    """Text on rows that contradict each other where it cannot be decided which of them are wrong."""
    rows = [row for stretch in result.undecided for row in stretch]
    text = f"{table.lines_text(rows)}: they contradict each other, and it cannot be decided which of them are wrong{_left_open(table)}"
    either = " or ".join(f"{table.lines_text(reading)} ({len(reading)} rows)" for reading in result.readings)
    return f"{text}: leave out {either}" if either else text


def _left_open(table: MeasuredTable) -> str:
    """Text on rows whose ends are farther apart than any two neighbours; else empty."""
    order = np.argsort(table.angles, kind="stable")
    last, first = table.closing or (int(order[-1]), int(order[0]))
    inner = table.values[order[order != last] if table.closing else order]
    if table.layout.order or not abs(table.values[last] - table.values[first]) > OPEN * np.abs(np.diff(inner)).max():
        return ""
    jump = abs(table.values[last] - table.values[first]) / abs(table.size)
    return (
        f" (line {table.lines[last]}, where the turn ends, is {result_text(jump)} {table.unit} from line "
        f"{table.lines[first]}, where it starts: a "
        "measured motion must return to its start)"
    )


def guess_error(table: MeasuredTable, left_out: tuple[int, ...] = (), column: int = 0) -> float:
    """Measuring error of a column from the scatter of its rows, at least the rounding of the last digit.

    Two digits, in the unit of the column; 0 where the rows are exact.
    """
    checkpoint()
    values_column = table.columns[column]
    used = table.used_rows(left_out)
    used = used[np.isfinite(values_column.values[used])]
    x, index = distinct_angles(table.angles[used])
    if x.size < LEAST_ANGLES:
        return 0.0
    count = np.bincount(index)
    seen = (
        scatter(x, np.bincount(index, values_column.values[used]) / count, values_column.order)
        * sqrt(float(np.median(count)))
        / abs(values_column.size)
    )
    result = max(seen, 10.0**-values_column.decimals / sqrt(12.0))
    if result <= EXACT * float(np.ptp(values_column.values[used])) / abs(values_column.size):
        return 0.0
    power = 10.0 ** (floor(log10(result)) - 1)
    return float(f"{np.ceil(result / power) * power:.2g}")


def with_measured_motion(design: Design, fit: MotionFit) -> Design:
    """Design with its motion replaced by a measured one. Raises DesignError where the units differ."""
    unit = require_motion(design).unit
    if fit.motion.unit != unit:
        value = f"measured in {fit.motion.unit}"
        raise DesignError([Fault("motion", value, "not the unit of this design's follower", f"a table in {unit}")])
    return without_marks(with_motion(design, fit.motion))


# -- spline of least jerk ---------------------------------------------------------------------------------


@frozen(eq=False)
class _SplineSolution:
    """Spline by u = angle/360: knots [deg], states s, s', s'' (m, 3), and the offset of the table, by degrees."""

    knots: np.ndarray
    at: np.ndarray
    offset: float
    smoothing: float
    freedom: float


def _solve(table: MeasuredTable, error: float, left_out: tuple[int, ...]) -> _SplineSolution:
    used = table.used_rows(left_out)
    x, mean = _means(table, left_out)
    if not np.ptp(mean):  # no motion
        some = slice(None, None, -(-x.size // LEAST_ANGLES))
        return _through(table, x[some], mean[some])
    if error == 0.0 and x.size <= MOST:
        return _through(table, x, mean)
    target = (error * table.size * 360.0**table.layout.order) ** 2
    variance = float(np.var(table.values[used])) * 360.0 ** (2 * table.layout.order)
    if target >= variance:
        greatest = sqrt(variance) / 360.0**table.layout.order / abs(table.size)
        raise FitError(
            f"measuring error {error:g} {table.unit}: as large as the motion; allowed: 0 ... {result_text(greatest, 5)} {table.unit}"
        )
    rows = _knotted(table, target, x.size, left_out)
    return _smoothed(rows, _lambda(rows, target))


def _knotted(table: MeasuredTable, target: float, angles: int, left_out: tuple[int, ...]) -> SplineBasis:
    """Basis with twice the knots that just follow the rows within the error, so that the jerk determines the curve.

    All rows are knots where they are few.
    """
    if angles <= TYPICAL:
        return basis(table, TYPICAL, left_out)
    counts = KNOTS if target else KNOTS[-1:]  # exact rows use the greatest number
    for i, count in enumerate(counts):
        checkpoint()
        rows = basis(table, count, left_out)
        if rows.least < target:
            return basis(table, counts[i + 1], left_out) if count < TYPICAL else rows
        if count >= angles:
            break
    return rows


def _lambda(rows: SplineBasis, target: float) -> float:
    """λ at which the mean square of the residuals has its target; the least λ where it stays above."""
    low, high = -14.0, 18.0
    for _ in range(64):
        middle = 0.5 * (low + high)
        if float(rows.mean_square(rows.scale * 10.0**middle)) < target:
            low = middle
        else:
            high = middle
    return rows.scale * 10.0**low


def _smoothed(rows: SplineBasis, smoothing: float) -> _SplineSolution:
    weights = rows.weights(smoothing)
    at = rows.at @ weights
    constant = float(np.mean(rows.values) - rows.mean @ weights)
    freedom = float(rows.freedom(smoothing))
    if rows.order == 0:
        at[:, 0] += constant
    by_degree = 360.0 ** (5 - 2 * rows.order)
    offset = constant / 360.0**rows.order if rows.order else 0.0
    return _SplineSolution(rows.knots, at, offset, smoothing * by_degree, freedom)


def _through(table: MeasuredTable, knots: np.ndarray, values: np.ndarray) -> _SplineSolution:
    """Curve of least jerk through all values; velocities and accelerations with the offset of least jerk."""
    order = table.layout.order
    scaled = values * 360.0**order
    if order == 0:
        at = natural(knots, 0, (scaled - scaled[0])[:, None])[:, :, 0]
        at[:, 0] += scaled[0]
        return _SplineSolution(knots, at, 0.0, 0.0, float(knots.size))
    if order == 2:
        unit_curves = natural(knots, 2, np.eye(knots.size)[:, 1:])
        matrix = derivative(knots, unit_curves, 2, knots)
        result = np.linalg.solve(np.column_stack((matrix, np.ones(knots.size))), scaled)
        at = unit_curves @ result[:-1]
        at[:, 2] = scaled - result[-1]
        return _SplineSolution(knots, at, float(result[-1]) / 360.0**2, 0.0, float(knots.size))
    curves = natural(knots, order, np.stack((scaled, np.ones(knots.size)), axis=1))
    jerk = jerk_rows(distances(knots), curves, np.roll(curves, -1, axis=0))
    of_values, of_constant = jerk[:, :, 0].ravel(), jerk[:, :, 1].ravel()
    offset = float(of_values @ of_constant / (of_constant @ of_constant))
    return _SplineSolution(
        knots, curves[:, :, 0] - offset * curves[:, :, 1], offset / 360.0**order, 0.0, float(knots.size)
    )


# -- motion -----------------------------------------------------------------------------------------------


def _motion(table: MeasuredTable, solution: _SplineSolution) -> Motion:
    """One spline over the turn with positions at its knots, and the measured derivative there.

    The derivative is stated so that it does not depend on differences of positions.
    """
    start = float(derivative(solution.knots, solution.at[:, :, None], 0, np.zeros(1))[0, 0])
    order, by_degree = table.layout.order, 360.0**table.layout.order
    names = ("", "velocity", "acceleration")
    points = tuple(
        SplinePoint(angle, state[0] - start, **({names[order]: state[order] / by_degree} if order else {}))
        for angle, state in zip(solution.knots.tolist(), solution.at.tolist(), strict=True)
    )
    return Motion(start, (Segment(360.0, 0.0, SplineCurve(points)),), table.motion_unit)


def _better_structure(
    table: MeasuredTable, error: float, left_out: tuple[int, ...], structure: Structure | None, offset: float
) -> tuple[Structure, float]:
    """One spline and its offset, or the dwells and laws with theirs, where these fit the rows as well."""
    residual = np.inf if structure is None else _residual(table, structure.motion, offset, left_out)
    enough = max(MET * error, NEAR * float(np.ptp(table.values[table.used_rows(left_out)])) / abs(table.size))
    if structure is not None and residual <= enough:
        return structure, offset
    solution = _solve(table, error, left_out)
    spline = Structure(_motion(table, solution), (), (), solution.freedom, solution.smoothing)
    if structure is not None and residual <= _residual(table, spline.motion, solution.offset, left_out):
        return structure, offset
    return spline, solution.offset


def _residual(table: MeasuredTable, motion: Motion, offset: float, left_out: tuple[int, ...]) -> float:
    """Root mean square residual of the rows in use [unit of the table]."""
    rows = table.used_rows(left_out)
    residuals = table.values[rows] - _measured(motion, table.layout.order, table.angles[rows]) - offset
    return sqrt(float(np.mean(residuals**2))) / abs(table.size)


def _measured(motion: Motion, order: int, angles: np.ndarray) -> np.ndarray:
    """Derivative s⁽ᵏ⁾ (n,) of the motion at cam angles [deg], in its unit per degree^k."""
    compiled: CompiledMotion = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad(angles))).displacement[order]
    return y * (np.pi / 180.0) ** order / motion.scale
