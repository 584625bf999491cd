"""Rows of a table that no smooth curve joins to their neighbours, detected before a curve is fitted.

Every run of 1 ... 15 rows is tested against its prediction from all other rows. The run with the largest score
T - COST m is left out where that exceeds START, and all is computed again, a too; where no run is left, runs whose rows
have the same error are tried, with the score T - 2 COST. Rows inside a run that agree with all others are restored. At
last a run is divided in two where these explain more.

Then each run is evaluated with the others left out: the weights exp(score/2) of all runs, and exp(START/2) of no run,
give the probability of each row to be wrong. From CERTAIN on a row is reported as wrong. A run without such a row is
not decided, nor are two runs that a step between valid rows explains as well: the rows between may be a longer wrong
run.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb, sqrt

import numpy as np

from core.frozen import frozen
from core.measured.table import SAME, MeasuredTable, distinct_angles
from core.numerics.lazy import checkpoint

# -- prediction of left out rows from all others ----------------------------------------------------------------


COST, START = 10.0, 15.0
"""Cost in T of each wrong value, and of a run; a valid row of 360 exceeds both in one of 5000 tables."""
LONGEST = 15  # rows of a run
COARSE = 24  # least angles of a lift per row of the longest run; twice and three times for its derivatives
REPEATS = 8  # greatest number of rows per angle
CORE = 64  # rows of a block
NOISE = 0.25  # largest fraction of A that may be error
MANY_ANGLES = 150  # number of angles from which A is computed from means of at least two rows
ONE_SIDED = 0.25  # largest opposite acceleration within the longest run of a one-sided curvature


def contrasts(x: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Contrasts E of rows at given cam angles: differences of order p, and differences of rows at the same angle.

    Few of them overlap, and overlapping ones are adjacent.

    Parameters
    ----------
    x : ndarray (n,) [deg]
        Cam angles in order.
    order : int
        Order p of the differences.

    Returns
    -------
    contrasts : ndarray (r, n) [1/deg^(p - 1)]
    changes : ndarray (r,), dimensionless
        Whether a contrast compares derivatives.
    """
    new = np.append(True, np.diff(x) > SAME)
    index = np.cumsum(new) - 1
    derivatives = np.zeros((index[-1] + 1, x.size))
    derivatives[index, np.arange(x.size)] = 1.0 / np.bincount(index)[index]  # means
    angles = x[new]
    for power in range(1, order):
        derivatives = power * np.diff(derivatives, axis=0) / (angles[power:] - angles[:-power])[:, None]
    changes = np.diff(derivatives, axis=0)
    repeated = np.flatnonzero(~new)
    unit = np.eye(x.size)
    result = np.concatenate((changes, unit[repeated] - unit[repeated - 1]))
    by_column = np.argsort((result != 0.0).argmax(axis=1), kind="stable")
    return result[by_column], by_column < len(changes)


def precision_matrix(x: np.ndarray, order: int, change: np.ndarray, error: float) -> np.ndarray:
    """Precision matrix Q = Eᵀ (σ² E Eᵀ + a²)⁻¹ E of rows at given cam angles.

    Parameters
    ----------
    x : ndarray (n,) [deg]
        Cam angles in order.
    order : int
        Order p of the differences.
    change : ndarray (n,) [unit of the values per deg^(p - 1)]
        Scale a of the changes of the derivative of order p - 1 at each row.
    error : float
        Error σ of a value.

    Returns
    -------
    ndarray (n, n) [1/(unit of the values)²]
    """
    differences, changes = contrasts(x, order)
    size = np.where(differences != 0.0, change, 0.0).max(axis=1)
    reach = [np.flatnonzero(row) for row in differences]
    first, last = (np.array([columns[end] for columns in reach]) for end in (0, -1))
    width = int((np.searchsorted(first, last, "right") - np.arange(first.size)).max())
    spread = np.zeros((first.size, first.size))
    for distance in range(width):
        products = (differences[: first.size - distance] * differences[distance:]).sum(axis=1)
        row = np.arange(products.size)
        spread[row, row + distance] = spread[row + distance, row] = error**2 * products
    spread[np.diag_indices_from(spread)] += np.where(changes, size**2, 0.0)
    solution = solve_banded(spread, differences, width)
    result = np.zeros((x.size, x.size))
    for columns, row, solved in zip(reach, differences, solution, strict=True):
        result[columns] += row[columns, None] * solved
    return result


def solve_banded(matrix: np.ndarray, right: np.ndarray, width: int) -> np.ndarray:
    """Solution X of A X = B with a symmetric positive definite band matrix A, by elimination.

    For the few rows of a block it takes as long as LAPACK, whose import takes longer than a table to be searched.

    Parameters
    ----------
    matrix : ndarray (r, r) [any unit]
        Matrix A, zero from the diagonal number ``width`` on.
    right : ndarray (r, n) [any unit]
        Right sides B.
    width : int
        Number of the first diagonal that is zero, for A is symmetric on either side.

    Returns
    -------
    ndarray (r, n) [unit of B by that of A]
    """
    upper, solution = matrix.copy(), right.copy()
    for i in range(len(upper)):
        below = slice(i + 1, i + width)
        factors = upper[below, i, None] / upper[i, i]
        upper[below, i : i + width] -= factors * upper[i, i : i + width]
        solution[below] -= factors * solution[i]
    for i in reversed(range(len(upper))):
        beyond = slice(i + 1, i + width)
        solution[i] = (solution[i] - upper[i, beyond] @ solution[beyond]) / upper[i, i]
    return solution


def quadratic_forms(precision: np.ndarray, pull: np.ndarray, run: np.ndarray) -> np.ndarray:
    """Quadratic forms pᵀ Q⁻¹ p of the first 1 ... m rows of each run.

    Parameters
    ----------
    precision : ndarray (n, n) [1/(unit of the values)²]
        Matrix Q.
    pull : ndarray (n,) [1/unit of the values]
        Vector p.
    run : ndarray (r, m), dimensionless
        Row numbers of each run.

    Returns
    -------
    ndarray (r, m), dimensionless
    """
    least = 1e-13 * float(precision.diagonal().max()) * np.eye(run.shape[1])
    factor = np.linalg.cholesky(precision[run[:, :, None], run[:, None, :]] + least)
    return np.cumsum(np.linalg.solve(factor, pull[run][:, :, None])[:, :, 0] ** 2, axis=1)


def leave_out(
    precision: np.ndarray, values: np.ndarray, left_out: np.ndarray, remaining: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Precision Q and pull Q y of the remaining rows once some rows are left out, and the T of these rows.

    Parameters
    ----------
    precision : ndarray (n, n) [1/(unit of the values)²]
    values : ndarray (n,) [unit of the values]
    left_out : ndarray (k,), dimensionless
        Numbers of the rows to leave out.
    remaining : ndarray (m,), dimensionless
        Numbers of the remaining rows.

    Returns
    -------
    precision : ndarray (m, m) [1/(unit of the values)²]
    pull : ndarray (m,) [1/unit of the values]
    explained : float
    """
    pull = precision @ values
    weights = np.linalg.solve(
        precision[np.ix_(left_out, left_out)], np.column_stack((precision[np.ix_(left_out, remaining)], pull[left_out]))
    )
    across = precision[np.ix_(remaining, left_out)]
    reduced = precision[np.ix_(remaining, remaining)] - across @ weights[:, :-1]
    return reduced, pull[remaining] - across @ weights[:, -1], float(pull[left_out] @ weights[:, -1])


def run_scores(precision: np.ndarray, pull: np.ndarray, run: np.ndarray) -> np.ndarray:
    """Scores of the first 1 ... m rows of each run.

    Parameters
    ----------
    precision : ndarray (n, n) [1/(unit of the values)²]
    pull : ndarray (n,) [1/unit of the values]
    run : ndarray (r, m), dimensionless
        Row numbers of each run.

    Returns
    -------
    ndarray (2, r, m), dimensionless
        With an independent error of each row, and with the same error of all rows.
    """
    length = np.arange(run.shape[1])
    square = np.cumsum(np.cumsum(precision[run[:, :, None], run[:, None, :]], axis=1), axis=2)[:, length, length]
    shifted = np.cumsum(pull[run], axis=1) ** 2 / square
    return np.stack((quadratic_forms(precision, pull, run) - COST * (length + 1.0), shifted - 2.0 * COST))


def step_row(precision: np.ndarray, pull: np.ndarray, run: np.ndarray) -> int | None:
    """Row after a step next to or inside a run that explains as much as leaving out the run; None where no step does.

    Parameters
    ----------
    precision : ndarray (n, n) [1/(unit of the values)²]
    pull : ndarray (n,) [1/unit of the values]
    run : ndarray (m,), dimensionless
        Row numbers of the run.

    Returns
    -------
    int or None
    """
    total = float(pull[run] @ np.linalg.solve(precision[np.ix_(run, run)], pull[run]))
    sums_after = np.cumsum(pull[::-1])[::-1]
    square = np.cumsum(np.cumsum(precision[::-1, ::-1], axis=0), axis=1)[::-1, ::-1].diagonal()
    steps = np.append(run, min(run[-1] + 1, len(pull) - 1))
    explained = sums_after[steps] ** 2 / square[steps]
    return int(steps[np.argmax(explained)]) if total - explained.max() < 2.0 * run.size + START else None


def deviation(sizes: np.ndarray) -> float:
    """Robust standard deviation of normal numbers from the mean of those below 2.5 deviations.

    The mean is used because the median of rounded rows varies in steps of their last digit.

    Parameters
    ----------
    sizes : ndarray (n,) [any unit]
        Magnitudes of the numbers.

    Returns
    -------
    float
    """
    estimate = float(np.median(sizes)) / 0.6745
    return (
        float(sizes[sizes <= 2.5 * estimate].mean()) / 0.77242
    )  # mean of |z| < 2.5: √(2/π) (1 - exp(-2.5²/2))/P(|z| < 2.5)


class TableRows:
    """Rows of a table around the turn.

    Attributes
    ----------
    x : ndarray (n,) [deg]
        Cam angles in order.
    y : ndarray (n,) [unit of the values]
    order : int
        Order p of their differences.
    """

    def __init__(self, x: np.ndarray, y: np.ndarray, order: int) -> None:
        self.x, self.y, self.order = x, y, order
        self.angles = distinct_angles(x)[0].size
        self.longest = min(LONGEST, self.angles // (COARSE * (4 - order)))
        self.distance = float(np.median(np.diff(distinct_angles(x)[0])))

    @property
    def is_testable(self) -> bool:
        """Whether the rows are numerous, do not repeat angles many times, and are not constant."""
        return self.longest > 1 and self.x.size <= REPEATS * self.angles and bool(np.ptp(self.y))

    def around(self, remaining: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Row numbers and ascending angles at positions that may exceed either end of the remaining rows.

        Parameters
        ----------
        remaining : ndarray (m,), dimensionless
            Numbers of the remaining rows.
        at : ndarray (k,), dimensionless
            Positions in ``remaining``, modulo m.

        Returns
        -------
        number : ndarray (k,), dimensionless
        angles : ndarray (k,) [deg]
        """
        number = remaining[np.mod(at, remaining.size)]
        return number, self.x[number] + 360.0 * (at // remaining.size)

    def scatter(self) -> float:
        """Error of a value from the differences of the rows, robust against wrong rows; at least 1e-7 of the range."""
        sizes, all_rows = [], np.arange(self.x.size)
        for start in range(0, self.x.size, CORE):
            number, x = self.around(all_rows, np.arange(start, start + CORE + self.order))
            differences, changes = contrasts(x, self.order)
            weights = differences[changes]
            sizes.append(np.abs(weights @ self.y[number]) / np.sqrt((weights**2).sum(axis=1)))
        return max(deviation(np.concatenate(sizes)), 1e-7 * float(np.ptp(self.y)))

    def changes(self, remaining: np.ndarray, error: float, least: float) -> np.ndarray:
        """Scale a of the changes at each row, computed from the remaining rows.

        Parameters
        ----------
        remaining : ndarray (m,), dimensionless
            Numbers of the remaining rows.
        error : float
            Error of a value.
        least : float
            Lower limit of a.

        Returns
        -------
        ndarray (n,) [unit of the values per deg^(p - 1)]
        """
        uniform = np.full(self.x.size, max(0.5 * self.largest(remaining, error), least))
        if self.order < 3:
            return uniform
        x, curvature = self.curvatures(remaining, 1)
        opposite = [_around(np.maximum(sign * curvature, 0.0), self.longest) for sign in (-1.0, 1.0)]
        noise = 1.5 * sqrt(6.0) * error / self.distance**2
        one_sided = np.where(curvature > 0.0, *opposite) < ONE_SIDED * np.abs(curvature) + noise
        local = _around(np.where(one_sided, np.abs(curvature), 0.0), 1)
        return np.maximum(uniform, 0.5 * np.interp(self.x, x, local, period=360.0))

    def largest(self, remaining: np.ndarray, error: float) -> float:
        """Scale A of the remaining rows: the second largest peak of |s^(p-1)|.

        Computed from means over the fewest rows for which the error is at most a quarter of it; over half of the
        longest run where no number suffices.

        Parameters
        ----------
        remaining : ndarray (m,), dimensionless
            Numbers of the remaining rows.
        error : float
            Error of a value.

        Returns
        -------
        float [unit of the values per deg^(p - 1)]
        """
        power = self.order - 1
        for width in range(1 if self.angles < MANY_ANGLES else 2, max(2, self.longest // 2) + 1):
            size = np.abs(self.curvatures(remaining, width)[1])
            from_peak = np.abs(
                np.mod(np.arange(size.size) - np.argmax(size) + size.size // 2, size.size) - size.size // 2
            )
            largest = float(size[from_peak > self.longest].max())
            noise = error * sqrt(comb(2 * power, power) / width) / (width * self.distance) ** power
            if not power or noise < NOISE * largest:
                break
        return largest

    def curvatures(self, remaining: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
        """Derivative s^(p-1) of the remaining rows from means over ``width`` rows; very close rows count as one.

        Parameters
        ----------
        remaining : ndarray (m,), dimensionless
            Numbers of the remaining rows.
        width : int

        Returns
        -------
        angles : ndarray (k,) [deg]
            In the middle of the rows used.
        derivative : ndarray (k,) [unit of the values per deg^(p - 1)]
        """
        _, index = np.unique(np.rint((self.x[remaining] - self.x[remaining[0]]) / self.distance), return_inverse=True)
        x, values = (np.bincount(index, v) / np.bincount(index) for v in (self.x[remaining], self.y[remaining]))
        n, positions = x.size, np.arange(x.size + 3 * width)
        x, values = x[positions % n] + 360.0 * (positions // n), values[positions % n]
        x, values = (np.convolve(v, np.full(width, 1.0 / width), "valid") for v in (x, values))
        if self.order == 1:
            values = values - np.median(values)
        for power in range(1, self.order):
            values = power * (values[width:] - values[:-width]) / (x[power * width :] - x[: -power * width])
        middle = x[(self.order - 1) * width // 2 :][:n]
        by_angle = np.argsort(np.mod(middle, 360.0), kind="stable")
        return np.mod(middle, 360.0)[by_angle], values[:n][by_angle]


def _around(values: np.ndarray, reach: int) -> np.ndarray:
    """Largest of the values (n,) within a reach on either side, around the turn."""
    padded = np.concatenate((values[-reach:], values, values[:reach]))
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1).max(axis=1))


# -- detection --------------------------------------------------------------------------------------------------


CERTAIN, POSSIBLE = 0.99, 0.05  # least probability of a wrong row, and of a possibly wrong one
MOST = 0.1  # greatest fraction of rows in wrong runs
PASSES = 20
MARGIN = 24  # rows beyond the ends of a block: more than ten correlation lengths of the prior
AT_ONCE = 50_000  # rows that are processed together
MANY_ROWS = 4000  # number of rows from which a table is searched only near suspicious rows
LEAST_CHANGE = 0.2  # least a in errors per squared row distance, which limits the correlation length


@frozen
class Outliers:
    """Wrong rows by their number in the table.

    Attributes
    ----------
    wrong : rows that contradict their neighbours
    possible : rows at the ends of wrong runs that may be wrong, too
    undecided : intervals of rows that contradict each other, where it cannot be decided which of them are wrong
    readings : of two steps without a wrong side, the rows that would be wrong, those between the steps or all others,
        the fewest first
    """

    wrong: tuple[int, ...] = ()
    possible: tuple[int, ...] = ()
    undecided: tuple[tuple[int, ...], ...] = ()
    readings: tuple[tuple[int, ...], ...] = ()


@lru_cache(maxsize=8)
def outliers(table: MeasuredTable, error: float) -> Outliers:
    """Rows that contradict their neighbours by more than the error of a value, in the unit of ``table.values``.

    A larger error shown by the rows replaces the stated one; so does the rounding of the last digit.
    """
    order = np.argsort(table.angles, kind="stable")
    rows = TableRows(table.angles[order], table.values[order], 3 - table.layout.order)
    if not rows.is_testable:
        return Outliers()
    rounding = 10.0**-table.decimals / sqrt(12.0) * abs(table.size)
    searched = np.ones(rows.x.size, dtype=bool)
    if rows.x.size > MANY_ROWS:
        searched = _suspicious(rows, max(error, rounding))
        if not searched.any():
            return Outliers()
    search = _Search(rows, max(error, rounding, rows.scatter()), searched)
    left_out = search.largest_first()
    if left_out is None:
        return Outliers(undecided=(tuple(order.tolist()),))
    search.divide(left_out)
    first, last = (int(np.flatnonzero(order == row)[0]) for row in (0, order.size - 1))
    probability, undecided, readings = search.probabilities(
        left_out, {first, last} if abs(first - last) in (1, order.size - 1) else set()
    )
    return Outliers(
        wrong=tuple(np.sort(order[probability >= CERTAIN]).tolist()),
        possible=tuple(np.sort(order[(probability > POSSIBLE) & (probability < CERTAIN)]).tolist()),
        undecided=tuple(tuple(order[run].tolist()) for run in undecided),
        readings=tuple(tuple(np.sort(order[rows]).tolist()) for rows in readings),
    )


def _suspicious(rows: TableRows, error: float) -> np.ndarray:
    """Rows (n,) near a row whose distance to the cubic through its four neighbours exceeds that of the rows around it.

    The ends of a run of wrong rows are such rows.
    """
    y = np.concatenate((rows.y[-8:], rows.y, rows.y[:8]))
    distance = np.abs(y[2:-2] - (4.0 * (y[1:-3] + y[3:-1]) - y[:-4] - y[4:]) / 6.0)
    typical = max(float(np.median(distance)), error, 1e-9 * float(np.ptp(rows.y)))
    suspicious = np.zeros(rows.x.size, dtype=bool)
    for first in range(0, rows.x.size, AT_ONCE):
        n = min(AT_ONCE, rows.x.size - first)
        window = distance[first : first + n + 12]
        around = np.partition(np.stack([window[k : k + n] for k in range(13)]), 6, axis=0)[6]
        suspicious[first : first + n] = window[6 : 6 + n] > 12.0 * np.maximum(around, typical)
    neighbours = np.flatnonzero(suspicious)[:, None] + np.arange(-2 * LONGEST, 2 * LONGEST + 1)
    suspicious[neighbours % rows.x.size] = True
    return suspicious


class _Search:
    """Search for the runs to leave out, for a known error of a value, in the blocks that contain searched rows (n,)."""

    def __init__(self, rows: TableRows, error: float, searched: np.ndarray) -> None:
        self.rows, self.error = rows, error
        blocks = np.arange(0, rows.x.size, CORE)
        self.blocks = blocks[np.logical_or.reduceat(searched, blocks)].tolist()
        self._blocks: dict[tuple[bytes, bytes], np.ndarray] = {}

    def change(self, left_out: np.ndarray) -> np.ndarray:
        """Scale a (n,) from the remaining rows."""
        least = LEAST_CHANGE * self.error / self.rows.distance ** (self.rows.order - 1)
        return self.rows.changes(np.flatnonzero(~left_out), self.error, least)

    def scores(self, remaining: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Scores (2, m, longest) of the runs from each searched remaining row; positions (m,) of these rows."""
        longest, parts, positions = self.rows.longest, [], []
        margin = min(MARGIN, (remaining.size - 1) // 2)
        for first in self.blocks:
            checkpoint()
            start, end = np.searchsorted(remaining, (first, first + CORE))
            positions.append(np.arange(start, end))
            number, x = self.rows.around(remaining, np.arange(start - margin, end + margin + longest))
            key = (change[number].tobytes(), number.tobytes())
            if key not in self._blocks:
                precision = precision_matrix(x, self.rows.order, change[number], self.error)
                run = margin + np.arange(end - start)[:, None] + np.arange(longest)
                self._blocks[key] = run_scores(precision, precision @ self.rows.y[number], run)
            parts.append(self._blocks[key])
        return np.concatenate(parts, axis=1), np.concatenate(positions)

    def largest_first(self) -> np.ndarray | None:
        """Rows (n,) to leave out, largest score first; None where they are too many, or the search does not end."""
        left_out, is_shifted = np.zeros((2, self.rows.x.size), dtype=bool)
        for _ in range(PASSES):
            remaining, change = np.flatnonzero(~left_out), self.change(left_out)
            (single, shifted), positions = self.scores(remaining, change)
            scores = single if single.max() >= START else shifted
            best = scores.max(axis=1)
            if best.max() < START:
                return left_out
            least = max(START, 0.25 * best.max())
            while best.max() >= least:  # the largest, and independent ones
                chosen = int(np.argmax(best))
                first = int(positions[chosen])
                run = remaining[np.mod(np.arange(first, first + 1 + int(np.argmax(scores[chosen]))), remaining.size)]
                left_out[run] = True
                is_shifted[run] |= scores is shifted
                distance = np.abs(np.mod(positions - first + remaining.size // 2, remaining.size) - remaining.size // 2)
                best[distance <= 3 * LONGEST] = -np.inf
            for run in true_runs(left_out & ~is_shifted):
                self.restore(left_out, run, change)
            if left_out.sum() > MOST * left_out.size:
                return None
        return None

    def near(self, left_out: np.ndarray, run: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Row numbers (m,) around a left out run, and their Q (m, m), with the run but no other left out rows."""
        others = left_out.copy()
        others[run] = False
        remaining = np.flatnonzero(~others)
        first = int(np.searchsorted(remaining, run[0]))
        before = min(2 * MARGIN, (remaining.size - run.size) // 2)
        number, x = self.rows.around(remaining, np.arange(first - before, first + run.size + before))
        return number, precision_matrix(x, self.rows.order, change[number], self.error)

    def restore(self, left_out: np.ndarray, run: np.ndarray, change: np.ndarray) -> None:
        """Restore the rows of a run that agree with all others."""
        number, precision = self.near(left_out, run, change)
        positions = np.flatnonzero(np.isin(number, run))
        covariance = np.linalg.inv(precision[np.ix_(positions, positions)])
        errors = covariance @ (precision @ self.rows.y[number])[positions]
        best, restored = 0.0, slice(0)
        for length in range(1, run.size):
            part = np.arange(run.size - length + 1)[:, None] + np.arange(length)
            gain = COST * length - quadratic_forms(covariance, errors, part)[:, -1]
            if gain.max() > best:
                first = int(np.argmax(gain))
                best, restored = float(gain[first]), slice(first, first + length)
        if best > 0.0:
            left_out[run[restored]] = False
            for remainder in (run[: restored.start], run[restored.stop :]):
                if remainder.size > 1:
                    self.restore(left_out, remainder, change)

    def divide(self, left_out: np.ndarray) -> None:
        """Replace a run by a part at one of its ends and another run, where both together have a larger score.

        A run across two wrong places explains both, although the rows between may be valid.
        """
        change = self.change(left_out)
        for run in true_runs(left_out):
            number, precision = self.near(left_out, run, change)
            positions = np.flatnonzero(np.isin(number, run))
            best = float(run_scores(precision, precision @ self.rows.y[number], positions[None]).max())
            without_run = left_out.copy()
            without_run[run] = False
            result = run
            for part in (positions[end] for k in range(1, positions.size) for end in (slice(k), slice(k, None))):
                remaining = np.delete(np.arange(number.size), part)
                reduced, pull, explained = leave_out(precision, self.rows.y[number], part, remaining)
                first = int(np.searchsorted(remaining, positions[0]))
                starts = np.arange(max(first - LONGEST, 0), first + positions.size)
                runs = starts[:, None] + np.arange(min(self.rows.longest, remaining.size - starts[-1]))
                scores = run_scores(reduced, pull, runs).max(axis=0)
                score = explained - COST * part.size + float(scores.max()) - START
                if score > best:
                    row, last = np.unravel_index(np.argmax(scores), scores.shape)
                    best, result = score, number[np.append(part, remaining[runs[row, : last + 1]])]
            left_out[:] = without_run
            left_out[result] = True

    def probabilities(
        self, left_out: np.ndarray, ends: set[int]
    ) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
        """Probability (n,) of each row to be wrong; undecided intervals; alternatives of two steps, fewest rows first.

        ``ends`` are the first and the last row of the file, where they are adjacent. Each run is evaluated with the
        others left out; where that changes the rows left out, all are evaluated again. Two steps may bound a long run
        of wrong rows on either side; a step between the ends of the file may be a drift of all rows. Rows close to an
        undecided run are undecided, and so are runs longer than those tested.
        """
        untested = [run for run in true_runs(left_out) if run.size > self.rows.longest]
        for _ in range(PASSES):
            change, runs = self.change(left_out), true_runs(left_out)
            results = [self.probability(left_out, run, change) for run in runs]
            probability = np.max([run_probability for run_probability, _ in results], axis=0, initial=0.0) + np.zeros(
                left_out.size
            )
            if np.array_equal(probability > 0.5, left_out):
                break
            left_out = probability > 0.5
        steps = [step for _, step in results if step is not None]
        undecided = self.contradicting(left_out, change)
        for run, (run_probability, step) in zip(runs, results, strict=True):
            if run_probability.max() < CERTAIN or (step is not None and (len(steps) > 1 or step in ends)):
                undecided[run] = True
                undecided |= run_probability > POSSIBLE
        for run in untested:
            undecided[run] = True
        neighbourhood = np.mod(
            np.flatnonzero(undecided)[:, None] + np.arange(-2 * LONGEST, 2 * LONGEST + 1), left_out.size
        )
        for run_probability, _ in results:
            if (run_probability[neighbourhood] > POSSIBLE).any():
                undecided |= run_probability > POSSIBLE
        readings = []
        if len(steps) == 2 and undecided[steps].all():
            between = np.zeros(undecided.size, dtype=bool)
            between[min(steps) : max(steps)] = True
            readings = sorted((np.flatnonzero(between), np.flatnonzero(~between)), key=len)
        return np.where(undecided, 0.0, probability), true_runs(undecided), readings

    def contradicting(self, left_out: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Rows (n,) of the run with the largest remaining score."""
        remaining, result = np.flatnonzero(~left_out), np.zeros(left_out.size, dtype=bool)
        pair, positions = self.scores(remaining, change)
        scores = pair.max(axis=0)
        if scores.max() >= START:
            chosen, last = np.unravel_index(np.argmax(scores), scores.shape)
            result[remaining[np.mod(positions[chosen] + np.arange(last + 1), remaining.size)]] = True
        return result

    def probability(self, left_out: np.ndarray, run: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, int | None]:
        """Probability (n,) of each row to be in a wrong run where one is left out; row after an equivalent step."""
        number, precision = self.near(left_out, run, change)
        pull = precision @ self.rows.y[number]
        runs = np.arange(number.size - self.rows.longest + 1)[:, None] + np.arange(self.rows.longest)
        scores = run_scores(precision, pull, runs).max(axis=0)
        top = max(START, float(scores.max()))
        weights = np.exp(0.5 * (scores - top))
        weights /= weights.sum() + np.exp(0.5 * (START - top))
        probability = np.zeros(left_out.size)
        for length in range(1, self.rows.longest + 1):
            np.add.at(probability, number[runs[:, :length]], weights[:, length - 1 : length])
        first, last = np.unravel_index(np.argmax(scores), scores.shape)
        step = step_row(precision, pull, runs[first, : last + 1])
        return probability, None if step is None else int(number[step])


def true_runs(marked: np.ndarray) -> list[np.ndarray]:
    """Runs of True around the turn, each as its row numbers in order.

    Parameters
    ----------
    marked : ndarray (n,), dimensionless

    Returns
    -------
    list of ndarray (k,), dimensionless
    """
    positions = np.flatnonzero(marked)
    if positions.size in (0, marked.size):
        return [positions] if positions.size else []
    runs = np.split(positions, np.flatnonzero(np.diff(positions) > 1) + 1)
    if len(runs) > 1 and runs[0][0] == 0 and runs[-1][-1] == marked.size - 1:
        runs[0] = np.concatenate((runs.pop(), runs[0]))
    return runs
