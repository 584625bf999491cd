"""Rows of a table that no smooth curve can follow together with the rows beside them, found before any curve is fitted.

Every run of 1 ... 15 rows is tested by what all others predict of it (``deletion``). The run of the largest score
T - COST m is left out where that exceeds START, and all is computed anew, a too; where none is left, runs whose rows are
all off by the same are tried, with the score T - 2 COST. Rows inside a run that agree with all others come back. At last
a run is divided in two where these explain more.

Last, each place is judged with the others left out: the weights exp(score/2) of all runs, and that of none, exp(START/2),
sum to the probability of each row to be wrong. From CERTAIN on it is named. A place without such a row is not decided,
nor are two where a step, all rows being right, explains as much: what stands between them may be a longer wrong run.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb, sqrt

import numpy as np

from core.frozen import frozen
from core.measured.table import SAME, MeasuredTable, distinct_angles
from core.numerics.lazy import checkpoint

# -- what all other rows of a table predict of a run of its rows, left out, where a smooth curve has ------------


COST, START = 10.0, 15.0
"""In T: of each value that is wrong, and of a run; a right row of 360 exceeds both in one of 5000 tables."""
LONGEST = 15  # rows of a run
COARSE = 24  # angles of a lift for each row of the longest run; twice and three times as many of its derivatives
REPEATS = 8  # rows for each angle, at most
CORE = 64  # rows of a block
NOISE = 0.25  # of A may be errors
MANY_ANGLES = 150  # angles, from which on A is that of means over two rows at least
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
        self.angles = distinct_angles(x)[0].size
        self.longest = min(LONGEST, self.angles // (COARSE * (4 - order)))
        self.distance = float(np.median(np.diff(distinct_angles(x)[0])))

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
        for width in range(1 if self.angles < MANY_ANGLES else 2, max(2, self.longest // 2) + 1):
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


# -- rows of a table that no smooth curve can follow together with the rows beside them, found ------------------


CERTAIN, POSSIBLE = 0.99, 0.05  # probability of being wrong, from which a row is named, and may be wrong
MOST = 0.1  # of the rows; where more contradict, it is not single runs that are wrong
PASSES = 20
MARGIN = 24  # rows beyond the ends of a block: more than ten correlation lengths of the prior
AT_ONCE = 50_000  # rows that are looked at together
MANY_ROWS = 4000  # rows, from which on a table is searched only where a row stands out of those beside it
LEAST_CHANGE = 0.2  # least a, in errors per squared row distance: so long the correlation is at most


@frozen
class Outliers:
    """Rows by their place in the table.

    wrong       they contradict the rows beside them
    possible    at the ends of wrong runs: the others do not decide whether they are wrong too
    undecided   stretches of rows that contradict each other, where it cannot be decided which of them are wrong
    readings    of two steps with no wrong side the rows that would be wrong, those between the steps or all others, the fewest first; a
                dialog shows them, and leaving out the rows of one is to choose it
    """

    wrong: tuple[int, ...] = ()
    possible: tuple[int, ...] = ()
    undecided: tuple[tuple[int, ...], ...] = ()
    readings: tuple[tuple[int, ...], ...] = ()


@lru_cache(maxsize=8)
def outliers(table: MeasuredTable, error: float) -> Outliers:
    """The rows that contradict those beside them by more than the error of a value, in the unit of ``table.values``.

    Where |e| shows a larger error than that stated, it counts; so does rounding to the last digit.
    """
    order = np.argsort(table.angles, kind="stable")
    rows = TableRows(table.angles[order], table.values[order], 3 - table.layout.order)
    if not rows.testable:
        return Outliers()
    rounding = 10.0**-table.decimals / sqrt(12.0) * abs(table.size)
    looked_at = np.ones(rows.x.size, dtype=bool)
    if rows.x.size > MANY_ROWS:
        looked_at = _suspicious(rows, max(error, rounding))
        if not looked_at.any():
            return Outliers()
    search = _Search(rows, max(error, rounding, rows.scatter()), looked_at)
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
    """The rows (n,) near any that is farther off the cubic through the two before and the two behind it than rows around it are: a run of
    wrong rows is so at its ends."""
    y = np.concatenate((rows.y[-8:], rows.y, rows.y[:8]))
    off = np.abs(y[2:-2] - (4.0 * (y[1:-3] + y[3:-1]) - y[:-4] - y[4:]) / 6.0)
    usual = max(float(np.median(off)), error, 1e-9 * float(np.ptp(rows.y)))
    found = np.zeros(rows.x.size, dtype=bool)
    for first in range(0, rows.x.size, AT_ONCE):
        n = min(AT_ONCE, rows.x.size - first)
        part = off[first : first + n + 12]
        around = np.partition(np.stack([part[k : k + n] for k in range(13)]), 6, axis=0)[6]
        found[first : first + n] = part[6 : 6 + n] > 12.0 * np.maximum(around, usual)
    near = np.flatnonzero(found)[:, None] + np.arange(-2 * LONGEST, 2 * LONGEST + 1)
    found[near % rows.x.size] = True
    return found


class _Search:
    """The search for the runs to leave out, for a known error of a value, in blocks of which some rows (n,) are looked at."""

    def __init__(self, rows: TableRows, error: float, looked_at: np.ndarray) -> None:
        self.rows, self.error = rows, error
        blocks = np.arange(0, rows.x.size, CORE)
        self.blocks = blocks[np.logical_or.reduceat(looked_at, blocks)].tolist()
        self._blocks: dict[tuple[bytes, bytes], np.ndarray] = {}

    def change(self, left_out: np.ndarray) -> np.ndarray:
        """a at each row (n,), by those that are left."""
        least = LEAST_CHANGE * self.error / self.rows.distance ** (self.rows.order - 1)
        return self.rows.changes(np.flatnonzero(~left_out), self.error, least)

    def scores(self, kept: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Scores (2, m, longest) of the runs of 1 ... rows from each row kept on that is looked at; the places of these (m,) among them."""
        longest, parts, places = self.rows.longest, [], []
        margin = min(MARGIN, (kept.size - 1) // 2)
        for first in self.blocks:
            checkpoint()
            start, end = np.searchsorted(kept, (first, first + CORE))
            places.append(np.arange(start, end))
            number, x = self.rows.around(kept, np.arange(start - margin, end + margin + longest))
            key = (change[number].tobytes(), number.tobytes())
            if key not in self._blocks:
                precision = precision_matrix(x, self.rows.order, change[number], self.error)
                run = margin + np.arange(end - start)[:, None] + np.arange(longest)
                self._blocks[key] = run_scores(precision, precision @ self.rows.y[number], run)
            parts.append(self._blocks[key])
        return np.concatenate(parts, axis=1), np.concatenate(places)

    def largest_first(self) -> np.ndarray | None:
        """Which rows (n,) to leave out; None where there are too many, or no end. Runs whose rows are wrong by the same are
        tried where no others are left."""
        left_out, moved = np.zeros((2, self.rows.x.size), dtype=bool)
        for _ in range(PASSES):
            kept, now = np.flatnonzero(~left_out), self.change(left_out)
            (single, shifted), places = self.scores(kept, now)
            scores = single if single.max() >= START else shifted
            best = scores.max(axis=1)
            if best.max() < START:
                return left_out
            least = max(START, 0.25 * best.max())
            while best.max() >= least:  # the largest, and others that do not depend on it
                chosen = int(np.argmax(best))
                first = int(places[chosen])
                run = kept[np.mod(np.arange(first, first + 1 + int(np.argmax(scores[chosen]))), kept.size)]
                left_out[run] = True
                moved[run] |= scores is shifted
                away = np.abs(np.mod(places - first + kept.size // 2, kept.size) - kept.size // 2)
                best[away <= 3 * LONGEST] = -np.inf
            for run in stretches(left_out & ~moved):
                self.restore(left_out, run, now)
            if left_out.sum() > MOST * left_out.size:
                return None
        return None

    def near(self, left_out: np.ndarray, run: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Numbers (m,) of the rows around a run that is left out, others left out but itself not, and their Q (m, m)."""
        others = left_out.copy()
        others[run] = False
        kept = np.flatnonzero(~others)
        first = int(np.searchsorted(kept, run[0]))
        before = min(2 * MARGIN, (kept.size - run.size) // 2)
        number, x = self.rows.around(kept, np.arange(first - before, first + run.size + before))
        return number, precision_matrix(x, self.rows.order, change[number], self.error)

    def restore(self, left_out: np.ndarray, run: np.ndarray, change: np.ndarray) -> None:
        """Of a run of rows left out, those that agree with all others are kept again."""
        number, precision = self.near(left_out, run, change)
        at = np.flatnonzero(np.isin(number, run))
        covariance = np.linalg.inv(precision[np.ix_(at, at)])
        missed = covariance @ (precision @ self.rows.y[number])[at]
        best, kept = 0.0, slice(0)
        for length in range(1, run.size):
            part = np.arange(run.size - length + 1)[:, None] + np.arange(length)
            gain = COST * length - quadratic_forms(covariance, missed, part)[:, -1]
            if gain.max() > best:
                first = int(np.argmax(gain))
                best, kept = float(gain[first]), slice(first, first + length)
        if best > 0.0:
            left_out[run[kept]] = False
            for rest in (run[: kept.start], run[kept.stop :]):
                if rest.size > 1:
                    self.restore(left_out, rest, change)

    def divide(self, left_out: np.ndarray) -> None:
        """Each run left out gives way to a part of it at one end and another run, where both together score more: one
        that spans two wrong places explains both, though the rows between may be right."""
        change = self.change(left_out)
        for run in stretches(left_out):
            number, precision = self.near(left_out, run, change)
            at = np.flatnonzero(np.isin(number, run))
            best = float(run_scores(precision, precision @ self.rows.y[number], at[None]).max())
            others = left_out.copy()
            others[run] = False
            result = run
            for part in (at[end] for k in range(1, at.size) for end in (slice(k), slice(k, None))):
                kept = np.delete(np.arange(number.size), part)
                rest, pull, explained = leave_out(precision, self.rows.y[number], part, kept)
                first = int(np.searchsorted(kept, at[0]))
                starts = np.arange(max(first - LONGEST, 0), first + at.size)
                tried = starts[:, None] + np.arange(min(self.rows.longest, kept.size - starts[-1]))
                scores = run_scores(rest, pull, tried).max(axis=0)
                score = explained - COST * part.size + float(scores.max()) - START
                if score > best:
                    row, last = np.unravel_index(np.argmax(scores), scores.shape)
                    best, result = score, number[np.append(part, kept[tried[row, : last + 1]])]
            left_out[:] = others
            left_out[result] = True

    def probabilities(
        self, left_out: np.ndarray, ends: set[int]
    ) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
        """The probability of each row (n,) that it is wrong; the stretches where none is wrong for certain; of two steps there the rows on
        either side, the fewest first.

        ends    the first and the last row of the file, where they stand side by side

        Each place is judged with the others left out; where that changes what is left out, all are judged again. Two
        steps may bound a long run of wrong rows, on either side of them; a step between the ends of the file may be
        a drift of all rows. What stands close to a place that cannot be decided cannot either; nor is a place whose run is
        longer than those that are tested.
        """
        untested = [run for run in stretches(left_out) if run.size > self.rows.longest]
        for _ in range(PASSES):
            change, runs = self.change(left_out), stretches(left_out)
            places = [self.probability(left_out, run, change) for run in runs]
            probability = np.max([own for own, _ in places], axis=0, initial=0.0) + np.zeros(left_out.size)
            if np.array_equal(probability > 0.5, left_out):
                break
            left_out = probability > 0.5
        steps = [step for _, step in places if step is not None]
        undecided = self.contradicting(left_out, change)
        for run, (own, step) in zip(runs, places, strict=True):
            if own.max() < CERTAIN or (step is not None and (len(steps) > 1 or step in ends)):
                undecided[run] = True
                undecided |= own > POSSIBLE
        for run in untested:
            undecided[run] = True
        close = np.mod(np.flatnonzero(undecided)[:, None] + np.arange(-2 * LONGEST, 2 * LONGEST + 1), left_out.size)
        for own, _ in places:
            if (own[close] > POSSIBLE).any():
                undecided |= own > POSSIBLE
        readings = []
        if len(steps) == 2 and undecided[steps].all():
            between = np.zeros(undecided.size, dtype=bool)
            between[min(steps) : max(steps)] = True
            readings = sorted((np.flatnonzero(between), np.flatnonzero(~between)), key=len)
        return np.where(undecided, 0.0, probability), stretches(undecided), readings

    def contradicting(self, left_out: np.ndarray, change: np.ndarray) -> np.ndarray:
        """The rows (n,) of the run that still contradicts the others most, once all that is to be left out is."""
        kept, result = np.flatnonzero(~left_out), np.zeros(left_out.size, dtype=bool)
        both, places = self.scores(kept, change)
        scores = both.max(axis=0)
        if scores.max() >= START:
            chosen, last = np.unravel_index(np.argmax(scores), scores.shape)
            result[kept[np.mod(places[chosen] + np.arange(last + 1), kept.size)]] = True
        return result

    def probability(self, left_out: np.ndarray, run: np.ndarray, change: np.ndarray) -> tuple[np.ndarray, int | None]:
        """Of each row (n,) that it belongs to a wrong run at the place of one left out; the row behind a step
        that explains as much, if any."""
        number, precision = self.near(left_out, run, change)
        pull = precision @ self.rows.y[number]
        tried = np.arange(number.size - self.rows.longest + 1)[:, None] + np.arange(self.rows.longest)
        scores = run_scores(precision, pull, tried).max(axis=0)
        top = max(START, float(scores.max()))
        weights = np.exp(0.5 * (scores - top))
        weights /= weights.sum() + np.exp(0.5 * (START - top))
        own = np.zeros(left_out.size)
        for length in range(1, self.rows.longest + 1):
            np.add.at(own, number[tried[:, :length]], weights[:, length - 1 : length])
        first, last = np.unravel_index(np.argmax(scores), scores.shape)
        step = step_row(precision, pull, tried[first, : last + 1])
        return own, None if step is None else int(number[step])


def stretches(marked: np.ndarray) -> list[np.ndarray]:
    """The runs of True (n,) around the turn, each as the numbers of its rows in order."""
    where = np.flatnonzero(marked)
    if where.size in (0, marked.size):
        return [where] if where.size else []
    runs = np.split(where, np.flatnonzero(np.diff(where) > 1) + 1)
    if len(runs) > 1 and runs[0][0] == 0 and runs[-1][-1] == marked.size - 1:
        runs[0] = np.concatenate((runs.pop(), runs[0]))
    return runs
