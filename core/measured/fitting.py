"""A motion through measured rows: the least jerk that the measuring error allows."""

from __future__ import annotations

from collections.abc import Iterator
from math import floor, log10, sqrt

import numpy as np

from core.design import Design, Motion, Segment, SplineCurve, SplinePoint, require_motion, with_motion
from core.design.motions import without_marks
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.laws.polynomial import jerk_rows
from core.measured.basis import SplineBasis, basis, derivative, distances, natural
from core.measured.columns import OtherColumn
from core.measured.outliers import Outliers, outliers
from core.measured.table import LEAST_ANGLES, MeasuredTable, distinct
from core.motion import Angles, Program, program
from core.numerics.cancellation import checkpoint

KNOTS = (45, 90, 180, 360, 720)
"""How many knots are tried; 180 where they suffice, more only where the error is finer than they can follow."""
USUAL, MOST = 180, 720
LEAST_FREE = 0.2  # of the rows must be left over to judge a scatter by
EXACT = 1e-9  # of the range of the values: rows that scatter less are exact
_LAMBDAS = np.logspace(-14.0, 18.0, 257)  # of the scale; beyond either end nothing changes


class FitError(KindynaError):
    """No motion can be made of the table with this measuring error."""


class Contradiction(FitError):
    """Rows contradict each other, and it cannot be decided which of them are wrong."""


@frozen(eq=False)
class MotionFit:
    """A motion fitted to a table.

    motion      over the whole turn: one spline segment, which needs the table no longer
    error       the measuring error; guessed: it was not stated
    residuals   (n,) measured minus curve, for every row
    outliers    rows that contradict those beside them
    left_out    rows the curve ignores: those that are wrong, and those that may be
    offset      constant that the table adds to a velocity or acceleration; 0 for a displacement
    smoothing   λ of  mean square residual + λ ∫ (d³s/dθ³)² dθ  [deg^(5 - 2k)] for derivative k
    freedom     how many values the curve was free to choose
    stroke      highest minus lowest position [mm or deg]; lowest: the lowest

    error, residuals, rms and offset are in the unit of the table; rms is that of the rows used.
    """

    table: MeasuredTable
    motion: Motion
    error: float
    guessed: bool
    residuals: np.ndarray
    outliers: Outliers
    left_out: tuple[int, ...]
    offset: float
    smoothing: float
    freedom: float
    rms: float
    stroke: float
    lowest: float

    @property
    def points(self) -> tuple[SplinePoint, ...]:
        """Of the spline."""
        curve = self.motion.segments[0].curve
        assert isinstance(curve, SplineCurve)
        return curve.points

    @property
    def largest(self) -> int:
        """The row of the largest residual."""
        return int(np.argmax(np.abs(self.residuals)))

    @property
    def waves(self) -> float:
        """How much the residuals of rows beside each other differ: 2 where they are at random, near 0 where they go in
        waves (Durbin, Watson 1950)."""
        used = self.table.used(self.left_out)
        left = self.residuals[used[np.argsort(self.table.angles[used], kind="stable")]]
        square = float(left @ left)
        return float(np.sum(np.diff(left) ** 2)) / square if square else 2.0

    def differences(self) -> Iterator[tuple[OtherColumn, float, float, int]]:
        """Of each column of another quantity: the largest difference from the motion's own derivative and the column's largest size,
        both in the column's unit, and the row where they differ so."""
        for other, (values, size) in zip(self.table.layout.beside, self.table.beside, strict=True):
            if np.isfinite(values).any():
                off = np.abs(values - _measured(self.motion, other.order, self.table.angles) / size)
                row = int(np.nanargmax(off))
                yield other, float(off[row]), float(np.nanmax(np.abs(values))), row

    def curve(self, angles: np.ndarray) -> np.ndarray:
        """What the table would hold at these cam angles [deg] without measuring errors, in its unit."""
        return _measured(self.motion, self.table.layout.order, angles) / self.table.size + self.offset


def fit(
    table: MeasuredTable, error: float | None = None, lowest: float | None = None, keep_all: bool = False
) -> MotionFit:
    """The motion of least ∫ jerk² whose rows are missed by the measuring error in the root mean square.

    That is Reinsch's discrepancy principle (1967): a curve closer to the rows than their error follows the error, and
    one further away loses what was measured, so λ is where the two are equal.

    error     of one value, one standard deviation in the unit of the table; 0: the curve goes through all rows; None:
              estimated by generalised cross-validation (Craven, Wahba 1979), at least the rounding of the last digit
    lowest    lowest position of the motion [mm or deg]; None: as measured, 0 for velocities and accelerations
    keep_all  also rows that contradict those beside them, which else are left out

    Raises FitError where the error is none, or swallows the whole motion; Contradiction where rows contradict each
    other and it cannot be decided which of them are wrong, unless all are kept or the error is 0.
    """
    if error is not None and not 0.0 <= error < np.inf:
        raise FitError(f"measuring error {error:g}: allowed: 0 or more {table.unit}")
    result = outliers(table, (error or 0.0) * abs(table.size))
    all_kept = keep_all or error == 0.0
    if result.undecided and not all_kept:
        raise Contradiction(
            f"{contradiction(table, result)}; correct them, state a larger measuring error, or keep all rows"
        )
    out = () if all_kept else tuple(sorted(result.wrong + result.possible))
    stated = guess_error(table, out) if error is None else error
    solved = _solved(table, stated, out)
    motion = _motion(table, solved)
    compiled = program(motion)
    ends = compiled.state(Angles(compiled.starts, np.arange(compiled.starts.size))).displacement[0] / motion.scale
    low, high = float(ends.min()), float(ends.max())
    wanted = lowest if lowest is not None else (0.0 if table.layout.order else low)
    moved = Motion(motion.start + (wanted - low), motion.segments, motion.unit) if wanted != low else motion
    missed = table.values - _measured(motion, table.layout.order, table.angles)
    residuals = (missed - solved.offset) / table.size
    return MotionFit(
        table=table,
        motion=moved,
        error=stated,
        guessed=error is None,
        residuals=residuals,
        outliers=result,
        left_out=out,
        offset=solved.offset / table.size,
        smoothing=solved.smoothing,
        freedom=solved.freedom,
        rms=sqrt(float(np.mean(residuals[table.used(out)] ** 2))),
        stroke=high - low,
        lowest=wanted,
    )


def contradiction(table: MeasuredTable, result: Outliers) -> str:
    """The rows that contradict each other where it cannot be decided which of them are wrong."""
    rows = [row for stretch in result.undecided for row in stretch]
    return f"{table.named(rows)}: they contradict each other, and nothing tells which of them are wrong"


def guess_error(table: MeasuredTable, left_out: tuple[int, ...] = ()) -> float:
    """The measuring error estimated from the scatter of the rows, at least that of rounding to the last digit; two digits
    of it, in the unit of the table, and 0 where the rows are exact.

    Where the best curve would be free to choose as many values as there are rows, their scatter cannot be distinguished
    from motion, and rounding alone counts.
    """
    checkpoint()
    rows = basis(table, USUAL, left_out)
    grid = _LAMBDAS * rows.scale
    free = 1.0 - rows.freedom(grid) / rows.values.size
    judged = np.flatnonzero(free >= LEAST_FREE)
    best = judged[np.argmin(rows.mean_square(grid[judged]) / free[judged] ** 2)]
    is_inside = best > judged[0] or best == 0
    variance = float(rows.mean_square(grid[best])) / free[best] if is_inside else 0.0
    scatter = sqrt(variance) / 360.0**rows.order / abs(table.size)
    result = max(scatter, 10.0**-table.decimals / sqrt(12.0))
    if result <= EXACT * float(np.ptp(table.values)) / abs(table.size):
        return 0.0
    power = 10.0 ** (floor(log10(result)) - 1)
    return float(f"{np.ceil(result / power) * power:.2g}")


def into_design(design: Design, fit: MotionFit) -> Design:
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
    used = table.used(out)
    x, place = distinct(table.angles[used])
    mean = np.bincount(place, table.values[used]) / np.bincount(place)
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


def _measured(motion: Motion, order: int, angles: np.ndarray) -> np.ndarray:
    """s⁽ᵏ⁾ of the motion (n,) by degrees at cam angles [deg], in its own unit."""
    compiled: Program = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad(angles))).displacement[order]
    return y * (np.pi / 180.0) ** order / motion.scale
