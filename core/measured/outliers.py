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
from math import sqrt

import numpy as np

from core.frozen import frozen
from core.measured.deletion import (
    CORE,
    COST,
    LONGEST,
    START,
    TableRows,
    leave_out,
    precision_matrix,
    quadratic_forms,
    run_scores,
    step_row,
)
from core.measured.table import MeasuredTable
from core.numerics.cancellation import checkpoint

CERTAIN, POSSIBLE = 0.99, 0.05  # probability of being wrong, from which a row is named, and may be wrong
MOST = 0.1  # of the rows; where more contradict, it is not single runs that are wrong
PASSES = 20
MARGIN = 24  # rows beyond the ends of a block: more than ten correlation lengths of the prior
AT_ONCE = 50_000  # rows that are looked at together
MANY = 4000  # rows, from which on a table is searched only where a row stands out of those beside it
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
    if rows.x.size > MANY:
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
