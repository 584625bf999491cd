"""What all other rows of a table predict of a run of its rows, left out, where a smooth curve has been measured.

A lift has a bounded acceleration, which may jump: from one triple of rows to the next it changes by a part of its
largest. For a table of s⁽ᵏ⁾ with p = 3 - k this is the prior

    e = E y,  e_j = s^(p-1) by the divided difference at the rows j+1 ...  -  the same at the rows j ...
    e ~ N(0, M),  M = a² I + σ² E Eᵀ

with a = A/2, A the largest |s^(p-1)| that the table reaches at two places (one may be a wrong run), and σ the error of
a row. Where a lift bends more than that to one side alone, its velocity jumps or changes within a few rows: wrong rows bend to both
sides. There a is as large as that acceleration. With Q = Eᵀ M⁻¹ E the run B of m rows differs from what all other rows predict by
Q_BB⁻¹ (Q y)_B, covariance Q_BB⁻¹ (Cook, Weisberg 1982, deletion of subsets; Wahba 1978, splines as such a prior). So where B is right,

    T(B) = (Q y)_Bᵀ Q_BB⁻¹ (Q y)_B                is χ² with m degrees of freedom,
    T(B, all by the same) = (1ᵀ (Q y)_B)² / 1ᵀ Q_BB 1    with one.
"""

from __future__ import annotations

from math import comb, sqrt

import numpy as np

from core.measured.table import SAME, distinct

COST, START = 10.0, 15.0
"""In T: of each value that is wrong, and of a run; a right row of 360 exceeds both in one of 5000 tables."""
LONGEST = 15  # rows of a run
COARSE = 24  # angles of a lift for each row of the longest run; twice and three times as many of its derivatives
REPEATS = 8  # rows for each angle, at most
CORE = 64  # rows of a block
NOISE = 0.25  # of A may be errors
MANY = 150  # angles, from which on A is that of means over two rows at least
ONE_SIDED = 0.25  # of an acceleration: the most to the other side within the longest run, where it is a bend to one


def contrasts(x: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray]:
    """E (r, n) for rows at cam angles x (n,) [deg] in order, and which of its rows (r,) compare derivatives; the others
    are differences of rows at the same angle. Few of them overlap, and those stand close to each other."""
    new = np.append(True, np.diff(x) > SAME)
    place = np.cumsum(new) - 1
    each = np.zeros((place[-1] + 1, x.size))
    each[place, np.arange(x.size)] = 1.0 / np.bincount(place)[place]  # means
    at = x[new]
    for power in range(1, order):
        each = power * np.diff(each, axis=0) / (at[power:] - at[:-power])[:, None]
    changes = np.diff(each, axis=0)
    again = np.flatnonzero(~new)
    unit = np.eye(x.size)
    result = np.concatenate((changes, unit[again] - unit[again - 1]))
    by_column = np.argsort((result != 0.0).argmax(axis=1), kind="stable")
    return result[by_column], by_column < len(changes)


def precision_matrix(x: np.ndarray, order: int, change: np.ndarray, error: float) -> np.ndarray:
    """Q (n, n) for rows at cam angles x [deg] in order, with p, a at each row (n,) and σ."""
    from scipy.linalg import solveh_banded
    from scipy.sparse import csr_array

    differences, changes = contrasts(x, order)
    sparse = csr_array(differences)
    size = np.where(differences != 0.0, change, 0.0).max(axis=1)
    spread = error**2 * (sparse @ sparse.T).toarray() + np.diag(np.where(changes, size**2, 0.0))
    row, column = np.nonzero(spread)
    bands = np.zeros((int((row - column).max()) + 1, len(spread)))
    for below in range(len(bands)):
        bands[below, : len(spread) - below] = spread.diagonal(-below)
    return sparse.T @ solveh_banded(bands, differences, lower=True, check_finite=False)


def quadratic_forms(precision: np.ndarray, pull: np.ndarray, run: np.ndarray) -> np.ndarray:
    """pull_Bᵀ precision_BB⁻¹ pull_B of the first 1 ... m rows of each run (r, m), by one Cholesky factor of each."""
    least = 1e-13 * float(precision.diagonal().max()) * np.eye(run.shape[1])
    factor = np.linalg.cholesky(precision[run[:, :, None], run[:, None, :]] + least)
    return np.cumsum(np.linalg.solve(factor, pull[run][:, :, None])[:, :, 0] ** 2, axis=1)


def leave_out(
    precision: np.ndarray, values: np.ndarray, part: np.ndarray, kept: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Q and Q y of the rows kept (m,) once a part (k,) of the rows is left out, and its T."""
    pull = precision @ values
    weights = np.linalg.solve(
        precision[np.ix_(part, part)], np.column_stack((precision[np.ix_(part, kept)], pull[part]))
    )
    across = precision[np.ix_(kept, part)]
    rest = precision[np.ix_(kept, kept)] - across @ weights[:, :-1]
    return rest, pull[kept] - across @ weights[:, -1], float(pull[part] @ weights[:, -1])


def run_scores(precision: np.ndarray, pull: np.ndarray, run: np.ndarray) -> np.ndarray:
    """Scores (2, r, m) of the first 1 ... m rows of each run (r, m): each row wrong by itself, all by the same."""
    length = np.arange(run.shape[1])
    square = np.cumsum(np.cumsum(precision[run[:, :, None], run[:, None, :]], axis=1), axis=2)[:, length, length]
    shifted = np.cumsum(pull[run], axis=1) ** 2 / square
    return np.stack((quadratic_forms(precision, pull, run) - COST * (length + 1.0), shifted - 2.0 * COST))


def step_row(precision: np.ndarray, pull: np.ndarray, run: np.ndarray) -> int | None:
    """The row behind a step beside or inside a run that, all rows being right, explains as much as leaving out the run;
    None where none does."""
    whole = float(pull[run] @ np.linalg.solve(precision[np.ix_(run, run)], pull[run]))
    behind = np.cumsum(pull[::-1])[::-1]
    square = np.cumsum(np.cumsum(precision[::-1, ::-1], axis=0), axis=1)[::-1, ::-1].diagonal()
    at = np.append(run, min(run[-1] + 1, len(pull) - 1))
    explained = behind[at] ** 2 / square[at]
    return int(at[np.argmax(explained)]) if whole - explained.max() < 2.0 * run.size + START else None


def deviation(sizes: np.ndarray) -> float:
    """The standard deviation of normal numbers of these sizes (n,), robust against others: the mean of those below 2.5 times that which
    their median tells, as a median of rounded rows steps with their last digit."""
    usual = float(np.median(sizes)) / 0.6745
    return (
        float(sizes[sizes <= 2.5 * usual].mean()) / 0.77242
    )  # of |z| below 2.5: √(2/π) (1 - exp(-2.5²/2))/P(|z| < 2.5)


class TableRows:
    """Cam angles x (n,) [deg] in order and values y (n,) around the turn, and the order p of their differences."""

    def __init__(self, x: np.ndarray, y: np.ndarray, order: int) -> None:
        self.x, self.y, self.order = x, y, order
        self.angles = distinct(x)[0].size
        self.longest = min(LONGEST, self.angles // (COARSE * (4 - order)))
        self.distance = float(np.median(np.diff(distinct(x)[0])))

    @property
    def testable(self) -> bool:
        """Not so where the rows are few, or repeat each angle many times."""
        return self.longest > 1 and self.x.size <= REPEATS * self.angles and bool(np.ptp(self.y))

    def around(self, kept: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the rows at places of the rows kept, which may lie beyond either end; their rising angles [deg]."""
        number = kept[np.mod(at, kept.size)]
        return number, self.x[number] + 360.0 * (at // kept.size)

    def scatter(self) -> float:
        """The error that |e| shows, robust against wrong rows; at least 1e-7 of the range."""
        sizes, every = [], np.arange(self.x.size)
        for start in range(0, self.x.size, CORE):
            number, x = self.around(every, np.arange(start, start + CORE + self.order))
            differences, changes = contrasts(x, self.order)
            each = differences[changes]
            sizes.append(np.abs(each @ self.y[number]) / np.sqrt((each**2).sum(axis=1)))
        return max(deviation(np.concatenate(sizes)), 1e-7 * float(np.ptp(self.y)))

    def changes(self, kept: np.ndarray, error: float, least: float) -> np.ndarray:
        """a at each row (n,), by the rows kept; at least so much."""
        usual = np.full(self.x.size, max(0.5 * self.largest(kept, error), least))
        if self.order < 3:
            return usual
        x, bend = self.bends(kept, 1)
        other = [_around(np.maximum(sign * bend, 0.0), self.longest) for sign in (-1.0, 1.0)]
        noise = 1.5 * sqrt(6.0) * error / self.distance**2
        one_sided = np.where(bend > 0.0, *other) < ONE_SIDED * np.abs(bend) + noise
        local = _around(np.where(one_sided, np.abs(bend), 0.0), 1)
        return np.maximum(usual, 0.5 * np.interp(self.x, x, local, period=360.0))

    def largest(self, kept: np.ndarray, error: float) -> float:
        """A of the rows kept: the second largest peak of |s^(p-1)|, of means over the fewest rows at which the error
        makes out a quarter of it at most; half of the longest run where none suffices."""
        power = self.order - 1
        for width in range(1 if self.angles < MANY else 2, max(2, self.longest // 2) + 1):
            size = np.abs(self.bends(kept, width)[1])
            from_peak = np.abs(
                np.mod(np.arange(size.size) - np.argmax(size) + size.size // 2, size.size) - size.size // 2
            )
            largest = float(size[from_peak > self.longest].max())
            noise = error * sqrt(comb(2 * power, power) / width) / (width * self.distance) ** power
            if not power or noise < NOISE * largest:
                break
        return largest

    def bends(self, kept: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
        """s^(p-1) (m,) of the rows kept, of means over so many, and the cam angles [deg] in the middle; rows closer to each other than
        usual count as one."""
        _, place = np.unique(np.rint((self.x[kept] - self.x[kept[0]]) / self.distance), return_inverse=True)
        x, each = (np.bincount(place, v) / np.bincount(place) for v in (self.x[kept], self.y[kept]))
        n, at = x.size, np.arange(x.size + 3 * width)
        x, each = x[at % n] + 360.0 * (at // n), each[at % n]
        x, each = (np.convolve(v, np.full(width, 1.0 / width), "valid") for v in (x, each))
        if self.order == 1:
            each = each - np.median(each)
        for power in range(1, self.order):
            each = power * (each[width:] - each[:-width]) / (x[power * width :] - x[: -power * width])
        middle = x[(self.order - 1) * width // 2 :][:n]
        by_angle = np.argsort(np.mod(middle, 360.0), kind="stable")
        return np.mod(middle, 360.0)[by_angle], each[:n][by_angle]


def _around(values: np.ndarray, reach: int) -> np.ndarray:
    """The largest of the values (n,) around a turn within so many on either side."""
    padded = np.concatenate((values[-reach:], values, values[:reach]))
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1).max(axis=1))
