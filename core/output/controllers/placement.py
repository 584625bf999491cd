"""Where the rows of a table stand: equal steps, or placed so that the largest error is least for their count.

Between two joins the error of a piece of length h falls as h^k. Rows are placed where the k-th root of the error is the same in every
piece (de Boor's equidistribution, with the measured error of each piece): then the largest is least for that count. Equal steps are
tried all upwards, for there the error is not monotone in their number; where one fails, that place is looked at for all others at once.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from core.numerics.cancellation import checkpoint
from core.output.controllers.deviation import errors_near, piece_errors
from core.output.controllers.interpolation import KINDS
from core.output.controllers.slave import NEAR, TURN, Slave

HAIR = 1e-3  # [deg] between two rows that tell both sides of a jump
NOISE = 1e-13  # of the largest value: errors below it are rounding
FEW, FINE, LARGE = 64, 256, 2000  # pieces
FLOOR = 1e-3  # of the mean root of the errors: a piece without any still counts so much
CELLS = {2: 256, 4: 96, 6: 40}  # of a part that the first placing rests on, by the order
PASSES, PASSES_LARGE = 12, 3
EVEN = 1.005  # the largest root of an error over the mean one: good enough
BLOCK = 64  # counts of equal steps tried at once, then twice as many ...
PLACES = 24  # ... at the last so many places where one failed
SURELY = 0.9  # of the pieces that the errors of a fine mesh call for: fewer never do
SEVERAL, GROWTH = 64, 1.25
CERTAIN = 2e-4  # of an error: what samples may miss or add ...
ROUGHLY = 1.15  # ... and coarse ones
ALL = np.inf


class Placer:
    """Rows for one slave under one interpolation.

    limits  of the errors of value, velocity and acceleration [unit, per degree]; inf where there is none. Of all inf the value's
            error is what is made least
    kinks   rows stand where only the jerk jumps, too, which many rows are better for
    hairs   angles [deg] at which two rows stand a hair apart; hair: how far that is
    apart   least distance of two rows [deg]
    """

    def __init__(
        self,
        slave: Slave,
        kind: str,
        limits: Sequence[float],
        hair: float = HAIR,
        free: bool = True,
        kinks: bool = False,
        apart: float = 0.0,
    ) -> None:
        self.slave, self.kind, self.row = slave, kind, KINDS[kind]
        self.orders = max((k + 1 for k, limit in enumerate(limits) if limit < ALL), default=1)
        self.limits = np.array([limit if limit < ALL else 1.0 for limit in limits[: self.orders]])
        self._counts = np.array([limit < ALL for limit in limits[: self.orders]])
        self._counts[0] |= not self._counts.any()
        self._power = 1.0 / np.maximum(self.row.order - np.arange(self.orders), 1)
        self.parts = slave.edges if kinks else slave.edges[slave.joins] if kind != "zebra" else np.array([0.0, TURN])
        jumping = slave.jumps[: self.row.through].any(axis=0)
        jumping[0] = False  # both ends of the turn have rows of their own
        self.hairs = slave.edges[:-1][jumping] if free and kind != "zebra" else np.zeros(0)
        self.hair, self._apart = hair, apart
        self._first: tuple[list[np.ndarray], list[np.ndarray]] | None = None
        self._many: tuple[list[np.ndarray], list[np.ndarray]] | None = None

    # -- one table ------------------------------------------------------------------------------------------

    def x_of(self, knots: np.ndarray) -> np.ndarray:
        """The angles of all rows, two where a jump is told."""
        if not self.hairs.size:
            return knots
        kept = knots[~np.isin(knots, self.hairs)]
        return np.sort(np.concatenate((kept, self.hairs - 0.5 * self.hair, self.hairs + 0.5 * self.hair)))

    def roots(self, knots: np.ndarray) -> np.ndarray:
        """Of each piece between knots (n,) the largest root of an error over its limit: at most 1 where all are kept."""
        x = self.x_of(knots)
        errors = piece_errors(self.slave, self.kind, x, self.orders)
        if self.hairs.size:
            errors = errors[:, ~np.isin(x[:-1], self.hairs - 0.5 * self.hair)]
        if self.kind == "zebra":
            errors = np.maximum(errors, np.roll(errors, 1, axis=1))
        return self._root(errors)

    def _root(self, errors: np.ndarray) -> np.ndarray:
        over = errors[self._counts] / self.limits[self._counts][:, None]
        return np.asarray((over ** self._power[self._counts][:, None]).max(axis=0))

    # -- placed ---------------------------------------------------------------------------------------------

    @property
    def _floor(self) -> float:
        return float((NOISE * self.slave.size / self.limits[0]) ** self._power[0])

    def _reference(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Of every part a mesh, and the sum of the roots up to each of its ends."""
        if self._first is None:
            cells = CELLS[self.row.order]
            mesh = [np.linspace(a, b, cells + 1) for a, b in zip(self.parts[:-1], self.parts[1:], strict=True)]
            roots = self.roots(_joined(mesh)).reshape(len(mesh), cells)
            self._first = mesh, [self._sum(each) for each in roots]
        return self._first

    def _measured(self, counts: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """The same by the pieces of a balanced table."""
        knots = self.balanced(counts)[0]
        ends = np.concatenate(([0], np.cumsum(counts))).tolist()
        roots = self.roots(knots)
        return [knots[a : b + 1] for a, b in pairwise(ends)], [self._sum(roots[a:b]) for a, b in pairwise(ends)]

    def _sum(self, roots: np.ndarray) -> np.ndarray:
        roots = np.maximum(roots, max(FLOOR * float(roots.mean()), 1e-3 * self._floor, 1e-300))
        return np.concatenate(([0.0], np.cumsum(roots)))

    def balanced(self, counts: np.ndarray, passes: int = PASSES) -> tuple[np.ndarray, np.ndarray]:
        """Knots with so many pieces in each part (p,), and the largest root of each part (p,)."""
        mesh, sums = (list(each) for each in self._reference())
        passes = min(passes, PASSES_LARGE) if counts.sum() > LARGE else passes
        best: list[np.ndarray] = [np.zeros(0)] * len(mesh)
        worst = np.full(len(mesh), np.inf)
        for _ in range(passes):
            knots = self._knots(mesh, sums, counts)
            roots = np.split(self.roots(_joined(knots)), np.cumsum(counts)[:-1])
            done = True
            for i, each in enumerate(roots):
                top = float(each.max())
                if top < worst[i]:
                    worst[i], best[i] = top, knots[i]
                if counts[i] > 1 and top > max(EVEN * float(each.mean()), self._floor):
                    done = False
                    mesh[i], sums[i] = _corrected(mesh[i], sums[i], knots[i], self._sum(each))
            if done:
                break
        return _joined(best), worst

    def _knots(self, mesh: Sequence[np.ndarray], sums: Sequence[np.ndarray], counts: np.ndarray) -> list[np.ndarray]:
        """Of each part the knots between which the sums grow alike."""
        made = [
            np.interp(np.arange(n + 1) / n * s[-1], s, at) for n, s, at in zip(counts.tolist(), sums, mesh, strict=True)
        ]
        for each, a, b in zip(made, self.parts[:-1], self.parts[1:], strict=True):
            each[1:-1] += self.hair * (1.0 - 2.0 * (each[1:-1] - a) / (b - a))  # inside of the rows that tell a jump
            each[0], each[-1] = a, b
            spare = b - a - (each.size - 1) * self._apart
            if self._apart and spare > 0.0:
                free = np.maximum(np.diff(each) - self._apart, 0.0)
                each[1:-1] = a + np.cumsum(self._apart + free[:-1] * spare / free.sum())
        return made

    @property
    def _hair_root(self) -> float:
        """The same of the pieces of a hair's breadth, whatever stands elsewhere."""
        if not self.hairs.size:
            return 0.0
        x = np.sort(np.concatenate((self.hairs - 0.5 * self.hair, self.hairs + 0.5 * self.hair)))
        return float(self._root(piece_errors(self.slave, self.kind, x, self.orders)[:, ::2]).max())

    def least(self, most: int) -> np.ndarray | None:
        """The fewest knots that keep the limits; None where that takes more than ``most`` rows."""
        if self.kind == "zebra":
            return self._least_zebra(most)
        _, sums = self._reference()
        if SURELY * sum(float(total[-1]) for total in sums) > most or self._hair_root > 1.0:
            return None
        low = np.zeros(len(sums), dtype=int)  # too few
        high = np.full(len(sums), -1)  # enough
        counts = np.maximum(np.ceil([0.98 * total[-1] for total in sums]), 1).astype(int)
        while True:
            checkpoint()
            if np.minimum(counts, most + 1).sum() + 1 + self.hairs.size > most and np.maximum(low, 1).sum() > most:
                return None
            counts = np.minimum(counts, most + 1)
            worst = self.balanced(counts)[1]
            fits = worst <= 1.0
            if ((~fits) & (counts > most)).any():
                return None
            high = np.where(fits & ((high < 0) | (counts < high)), counts, high)
            low = np.where(fits, low, np.maximum(low, counts))
            if ((high >= 0) & (high - low <= 1)).all():
                break
            wanted = np.ceil(counts * np.minimum(worst, 1e6)).astype(int)
            wanted = np.where(fits, np.minimum(wanted, counts - 1), np.maximum(wanted, counts + 1))
            bound = np.where(high < 0, np.iinfo(int).max, high - 1)
            counts = np.where((high >= 0) & (high - low <= 1), high, np.clip(wanted, low + 1, bound))
        if int(high.sum()) + 1 + self.hairs.size > most:
            return None
        return self.balanced(high)[0]

    def _least_zebra(self, most: int) -> np.ndarray | None:
        _, sums = self._reference()
        count = max(2 * int(np.ceil(0.45 * sums[0][-1])), 4)
        while count <= most:
            knots, worst = self.balanced(np.array([count]))
            if worst[0] <= 1.0:
                return knots
            count = max(2 * int(0.5 * min(count * worst[0] * 0.98, 4.0 * count)), count + 2)
        return None

    def of_count(self, pieces: int, passes: int = PASSES, tries: int = 3) -> np.ndarray:
        """So many pieces placed for the least error; at least one in each part."""
        _, sums = self._reference()
        need = np.maximum([float(total[-1]) for total in sums], 1e-300)
        best, top = np.zeros(0), np.inf
        for _ in range(tries):
            counts = _shared(need, pieces)
            knots, worst = self.balanced(counts, passes)
            if worst.max() < top:
                best, top = knots, float(worst.max())
            need, before = worst * counts, need
            if need.size == 1 or np.allclose(need, before, rtol=1e-3):
                break
        return best

    def errors(self, pieces: int) -> np.ndarray:
        """Errors of value, velocity and acceleration (3,) with so many pieces, as many as the interpolation has; where they are many,
        placed as if they were endlessly many."""
        mesh, sums = self._reference()
        if pieces < FINE:
            x = self.x_of(self.of_count(pieces, *((2, 1) if pieces > FEW else (3, 2))))
        else:
            if self._many is None:
                self._many = self._measured(_shared(np.array([each[-1] for each in sums]), FINE))
            mesh, sums = self._many
            x = self.x_of(_joined(self._knots(mesh, sums, _shared(np.array([each[-1] for each in sums]), pieces))))
        return self.errors_at(x)

    def errors_at(self, x: np.ndarray) -> np.ndarray:
        """The same of rows at angles x (n,) [deg]."""
        return np.asarray(piece_errors(self.slave, self.kind, x, self.row.derivatives).max(axis=1))

    def root(self, x: np.ndarray) -> float:
        """The largest root of an error over its limit of rows at angles x (n,) [deg]."""
        return float(self._root(piece_errors(self.slave, self.kind, x, self.orders)).max())

    # -- equal ----------------------------------------------------------------------------------------------

    def keeping(self, steps: Sequence[int]) -> Iterator[int]:
        """Of these numbers of equal steps, in rising order, all that seem to keep the limits. After some, whose files all have not kept
        them, it is the digits that err, and fewer are tried."""
        first, size, tried = 0, BLOCK, 0
        places: list[float] = []
        while first < len(steps):
            checkpoint()
            block = np.array(steps[first : first + size])
            first, size = first + size, 2 * size
            for place in places[-PLACES:]:
                block = block[self._roots_near(block, place, 1.0) <= 1.0 + CERTAIN]
            while block.size:
                count, block = int(block[0]), block[1:]
                root, place = self.root_of(count)
                if root <= 1.0 + CERTAIN:
                    yield count
                    tried += 1
                    if tried > SEVERAL:
                        first = bisect_left(steps, int(GROWTH * count) + 1)
                        break
                    continue
                block = block[self._roots_near(block, place, 1.0) <= 1.0 + CERTAIN]
                places = [*(each for each in places if each != place), place]

    def best_equal(self, steps: Sequence[int]) -> tuple[int, float]:
        """The one of these numbers of equal steps whose largest root is least, and that root; of those that keep the limits any."""
        few = [count for count in steps[:-1] if count <= 2 * self.row.reach]
        counts = np.array(steps[len(few) : -1])
        bound, seen = np.zeros(counts.size), set()
        (top, place), best = self.root_of(steps[-1]), steps[-1]
        for count in few if top > 1.0 else ():
            top, best = min((top, best), (self.root_of(count)[0], count))
        while counts.size and top > 1.0:
            checkpoint()
            if place not in seen:
                bound = np.maximum(bound, self._roots_near(counts, place, top))
                seen.add(place)
            counts, bound = (each[bound < (1.0 - CERTAIN) * top] for each in (counts, bound))
            if counts.size:
                likely = int(np.argmin(bound))
                count, bound[likely] = int(counts[likely]), np.inf
                root, place = self.root_of(count)
                top, best = min((top, best), (root, count))
        return best, top

    def root_of(self, steps: int) -> tuple[float, float]:
        """The largest root of so many equal steps, and an angle [deg] near which others are likely to err most."""
        x = equal(steps)
        roots = self.roots(x)
        worst = int(np.argmax(roots))
        edges = self.slave.edges[1:-1]
        within = edges[(edges > x[worst] - NEAR) & (edges < x[worst + 1] + NEAR)]
        return float(roots[worst]), float(within[0] if within.size else 0.5 * (x[worst] + x[worst + 1]))

    def _roots_near(self, steps: np.ndarray, place: float, level: float) -> np.ndarray:
        """Of each number of equal steps (k,) the root of the piece in which an angle lies, coarsely where it is above a level; 0 where they
        are too few to say."""
        roots, kept = np.zeros(steps.size), np.flatnonzero(steps > 2 * self.row.reach)
        for coarse in (True, False):
            if kept.size:
                roots[kept] = self._root(errors_near(self.slave, self.kind, steps[kept], place, self.orders, coarse))
                kept = kept[roots[kept] <= ROUGHLY * level]
        return roots


def equal(steps: int) -> np.ndarray:
    """The ends of so many equal steps of the turn [deg]."""
    return TURN * np.arange(steps + 1) / steps


def _joined(knots: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([*(each[:-1] for each in knots), knots[-1][-1:]])


def _corrected(
    mesh: np.ndarray, total: np.ndarray, knots: np.ndarray, measured: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A finer mesh and its sums, so that they grow over each piece between knots as it was measured."""
    if knots.size > mesh.size:
        return knots, measured
    at = np.union1d(mesh, knots)
    sums = np.interp(at, mesh, total)
    expected = np.maximum(np.diff(np.interp(knots, mesh, total)), 1e-300)
    piece = np.clip(np.searchsorted(knots, 0.5 * (at[:-1] + at[1:])) - 1, 0, knots.size - 2)
    grown = np.diff(sums) * (np.diff(measured) / expected)[piece]
    return at, np.concatenate(([0.0], np.cumsum(grown)))


def _shared(need: np.ndarray, pieces: int) -> np.ndarray:
    """Pieces (p,) of each part, at least one, so that the largest need of a piece is least."""
    counts = np.maximum(np.floor(need / need.sum() * (pieces - need.size)), 1).astype(int)
    while counts.sum() > pieces:
        counts[np.argmin(np.where(counts > 1, need / np.maximum(counts - 1, 1), np.inf))] -= 1
    while counts.sum() < pieces:
        counts[np.argmax(need / counts)] += 1
    return counts


__all__ = ["HAIR", "Placer", "equal"]
