"""Positions of the rows of a table: placed for the least error, or at equal steps."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from core.numerics.lazy import checkpoint
from core.output.controllers.errors import errors_near, piece_errors
from core.output.controllers.rows import KINDS
from core.output.controllers.slave import NEAR, TURN, Slave

SPLIT = 1e-3  # [deg] between two rows at both sides of a jump
NOISE = 1e-13  # relative to the largest value: errors below it are rounding
FEW, FINE, LARGE = 64, 256, 2000  # pieces
FLOOR = 1e-3  # relative to the mean root of the errors: least weight of a piece
CELLS = {2: 256, 4: 96, 6: 40}  # order of the interpolation -> cells of the first mesh in a part
PASSES, PASSES_LARGE = 12, 3
EVEN = 1.005  # ratio of the largest to the mean root at which a table is balanced
BLOCK = 64  # numbers of equal steps tried at once, doubled from block to block ...
ANGLES = 24  # ... at the last angles where a number failed
CERTAIN_PART = 0.9  # of the pieces estimated from a fine mesh: fewer never suffice
SEVERAL, GROWTH = 64, 1.25
SAMPLING_ERROR = 2e-4  # relative error of samples ...
COARSE_ERROR = 1.15  # ... and factor of coarse ones
NOISE = 16.0 * float(np.finfo(float).eps)  # rounding of computed errors, relative to the largest value


class RowPlacer:
    """Positions of rows for one slave and one interpolation.

    A piece is rated by the root of its error over the limit, which is proportional to its length: for order p of the error,
    (error/limit)^(1/p). At most 1 satisfies the limits.

    Attributes
    ----------
    limits : limits of the errors of value, velocity and acceleration [unit, per degree]; if none is finite, the error of the
        value is minimised
    parts : (p + 1,) master angles that are rows in every table [deg]
    splits : (q,) master angles of jumps with a row on either side [deg]
    split : distance of these two rows [deg]
    """

    def __init__(
        self,
        slave: Slave,
        kind: str,
        limits: Sequence[float],
        split: float = SPLIT,
        free: bool = True,
        kinks: bool = False,
        least_distance: float = 0.0,
    ) -> None:
        """Prepare the placing.

        ``limits`` are inf where there is none. With ``free``, jumps have two rows. With ``kinks``, jumps of the jerk have
        rows too, which is better for many rows. ``least_distance`` [deg] of two rows.
        """
        self.slave, self.kind, self.row = slave, kind, KINDS[kind]
        self.orders = max((k + 1 for k, limit in enumerate(limits) if limit < np.inf), default=1)
        self.limits = np.array([limit if limit < np.inf else 1.0 for limit in limits[: self.orders]])
        self._counts = np.array([limit < np.inf for limit in limits[: self.orders]])
        self._counts[0] |= not self._counts.any()
        self._power = 1.0 / np.maximum(self.row.order - np.arange(self.orders), 1)
        self.parts = slave.edges if kinks else slave.edges[slave.joins] if kind != "zebra" else np.array([0.0, TURN])
        has_jump = slave.jumps[: self.row.through].any(axis=0)
        has_jump[0] = False  # both ends of the turn are separate rows
        self.splits = slave.edges[:-1][has_jump] if free and kind != "zebra" else np.zeros(0)
        self.split, self._least_distance = split, least_distance
        self._first_mesh: tuple[list[np.ndarray], list[np.ndarray]] | None = None
        self._fine_mesh: tuple[list[np.ndarray], list[np.ndarray]] | None = None

    # -- rating of a table ----------------------------------------------------------------------------------

    def row_angles(self, knots: np.ndarray) -> np.ndarray:
        """Angles of all rows: the knots, with two rows at a split jump.

        Parameters
        ----------
        knots : ndarray (n,) [deg]

        Returns
        -------
        ndarray (m,) [deg]
        """
        if not self.splits.size:
            return knots
        without_jumps = knots[~np.isin(knots, self.splits)]
        return np.sort(np.concatenate((without_jumps, self.splits - 0.5 * self.split, self.splits + 0.5 * self.split)))

    def error_roots(self, knots: np.ndarray) -> np.ndarray:
        """Largest root of an error over its limit in each piece between knots; at most 1 where all limits are satisfied.

        Parameters
        ----------
        knots : ndarray (n,) [deg]

        Returns
        -------
        ndarray (n - 1,), dimensionless
        """
        x = self.row_angles(knots)
        errors = piece_errors(self.slave, self.kind, x, self.orders)
        if self.splits.size:
            errors = errors[:, ~np.isin(x[:-1], self.splits - 0.5 * self.split)]
        if self.kind == "zebra":
            errors = np.maximum(errors, np.roll(errors, 1, axis=1))
        return self._root(errors)

    def _root(self, errors: np.ndarray) -> np.ndarray:
        ratio = errors[self._counts] / self.limits[self._counts][:, None]
        return np.asarray((ratio ** self._power[self._counts][:, None]).max(axis=0))

    # -- rows placed for the least error --------------------------------------------------------------------

    @property
    def _floor(self) -> float:
        return float((NOISE * self.slave.size / self.limits[0]) ** self._power[0])

    def _reference(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Mesh of every part, and the sums of the roots up to its nodes."""
        if self._first_mesh is None:
            cells = CELLS[self.row.order]
            mesh = [np.linspace(a, b, cells + 1) for a, b in zip(self.parts[:-1], self.parts[1:], strict=True)]
            roots = self.error_roots(_join(mesh)).reshape(len(mesh), cells)
            self._first_mesh = mesh, [self._sum(part) for part in roots]
        return self._first_mesh

    def _balanced_mesh(self, counts: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Mesh and sums of the roots from the pieces of a balanced table."""
        knots = self.balance(counts)[0]
        ends = np.concatenate(([0], np.cumsum(counts))).tolist()
        roots = self.error_roots(knots)
        return [knots[a : b + 1] for a, b in pairwise(ends)], [self._sum(roots[a:b]) for a, b in pairwise(ends)]

    def _sum(self, roots: np.ndarray) -> np.ndarray:
        roots = np.maximum(roots, max(FLOOR * float(roots.mean()), 1e-3 * self._floor, 1e-300))
        return np.concatenate(([0.0], np.cumsum(roots)))

    def balance(self, counts: np.ndarray, passes: int = PASSES) -> tuple[np.ndarray, np.ndarray]:
        """Knots of equal roots within each part.

        Parameters
        ----------
        counts : ndarray (p,), dimensionless
            Number of pieces in each part.
        passes : int
            Largest number of corrections.

        Returns
        -------
        knots : ndarray (n,) [deg]
        worst : ndarray (p,), dimensionless
            Largest root of each part.
        """
        mesh, sums = (list(part) for part in self._reference())
        passes = min(passes, PASSES_LARGE) if counts.sum() > LARGE else passes
        best: list[np.ndarray] = [np.zeros(0)] * len(mesh)
        worst = np.full(len(mesh), np.inf)
        for _ in range(passes):
            knots = self._knots(mesh, sums, counts)
            roots = np.split(self.error_roots(_join(knots)), np.cumsum(counts)[:-1])
            is_balanced = True
            for i, part in enumerate(roots):
                largest = float(part.max())
                if largest < worst[i]:
                    worst[i], best[i] = largest, knots[i]
                if counts[i] > 1 and largest > max(EVEN * float(part.mean()), self._floor):
                    is_balanced = False
                    mesh[i], sums[i] = _correct_mesh(mesh[i], sums[i], knots[i], self._sum(part))
            if is_balanced:
                break
        return _join(best), worst

    def _knots(self, mesh: Sequence[np.ndarray], sums: Sequence[np.ndarray], counts: np.ndarray) -> list[np.ndarray]:
        """Knots of each part at which the sums of the roots increase equally."""
        result = [
            np.interp(np.arange(n + 1) / n * s[-1], s, at) for n, s, at in zip(counts.tolist(), sums, mesh, strict=True)
        ]
        for knots, a, b in zip(result, self.parts[:-1], self.parts[1:], strict=True):
            knots[1:-1] += self.split * (1.0 - 2.0 * (knots[1:-1] - a) / (b - a))  # inside of the rows at a split jump
            knots[0], knots[-1] = a, b
            spare = b - a - (knots.size - 1) * self._least_distance
            if self._least_distance and spare > 0.0:
                free = np.maximum(np.diff(knots) - self._least_distance, 0.0)
                knots[1:-1] = a + np.cumsum(self._least_distance + free[:-1] * spare / free.sum())
        return result

    @property
    def _split_root(self) -> float:
        """Largest root of the pieces at split jumps, which other rows do not influence."""
        if not self.splits.size:
            return 0.0
        x = np.sort(np.concatenate((self.splits - 0.5 * self.split, self.splits + 0.5 * self.split)))
        return float(self._root(piece_errors(self.slave, self.kind, x, self.orders)[:, ::2]).max())

    def fewest(self, most: int) -> np.ndarray | None:
        """The fewest knots that satisfy the limits; None where they need more than ``most`` rows.

        Returns
        -------
        ndarray (n,) [deg] or None
        """
        if self.kind == "zebra":
            return self._fewest_zebra(most)
        _, sums = self._reference()
        if CERTAIN_PART * sum(float(total[-1]) for total in sums) > most or self._split_root > 1.0:
            return None
        low = np.zeros(len(sums), dtype=int)  # too few pieces
        high = np.full(len(sums), -1)  # sufficient pieces
        counts = np.maximum(np.ceil([0.98 * total[-1] for total in sums]), 1).astype(int)
        while True:
            checkpoint()
            if np.minimum(counts, most + 1).sum() + 1 + self.splits.size > most and np.maximum(low, 1).sum() > most:
                return None
            counts = np.minimum(counts, most + 1)
            worst = self.balance(counts)[1]
            satisfies = worst <= 1.0
            if ((~satisfies) & (counts > most)).any():
                return None
            high = np.where(satisfies & ((high < 0) | (counts < high)), counts, high)
            low = np.where(satisfies, low, np.maximum(low, counts))
            if ((high >= 0) & (high - low <= 1)).all():
                break
            requested = np.ceil(counts * np.minimum(worst, 1e6)).astype(int)
            requested = np.where(satisfies, np.minimum(requested, counts - 1), np.maximum(requested, counts + 1))
            bound = np.where(high < 0, np.iinfo(int).max, high - 1)
            counts = np.where((high >= 0) & (high - low <= 1), high, np.clip(requested, low + 1, bound))
        if int(high.sum()) + 1 + self.splits.size > most:
            return None
        return self.balance(high)[0]

    def _fewest_zebra(self, most: int) -> np.ndarray | None:
        _, sums = self._reference()
        count = max(2 * int(np.ceil(0.45 * sums[0][-1])), 4)
        while count <= most:
            knots, worst = self.balance(np.array([count]))
            if worst[0] <= 1.0:
                return knots
            count = max(2 * int(0.5 * min(count * worst[0] * 0.98, 4.0 * count)), count + 2)
        return None

    def place(self, pieces: int, passes: int = PASSES, tries: int = 3) -> np.ndarray:
        """Knots of a given number of pieces, at least one in each part, for the least error.

        Returns
        -------
        ndarray (pieces + 1,) [deg]
        """
        _, sums = self._reference()
        need = np.maximum([float(total[-1]) for total in sums], 1e-300)
        best, largest = np.zeros(0), np.inf
        for _ in range(tries):
            counts = _share(need, pieces)
            knots, worst = self.balance(counts, passes)
            if worst.max() < largest:
                best, largest = knots, float(worst.max())
            need, previous = worst * counts, need
            if need.size == 1 or np.allclose(need, previous, rtol=1e-3):
                break
        return best

    def errors(self, pieces: int) -> np.ndarray:
        """Largest errors with a given number of pieces; above ``FINE`` pieces the asymptotic placing is used.

        Returns
        -------
        ndarray (orders,) [unit, per degree]
            Value, velocity and acceleration, as many as the interpolation has.
        """
        mesh, sums = self._reference()
        if pieces < FINE:
            x = self.row_angles(self.place(pieces, *((2, 1) if pieces > FEW else (3, 2))))
        else:
            if self._fine_mesh is None:
                self._fine_mesh = self._balanced_mesh(_share(np.array([total[-1] for total in sums]), FINE))
            mesh, sums = self._fine_mesh
            x = self.row_angles(_join(self._knots(mesh, sums, _share(np.array([total[-1] for total in sums]), pieces))))
        return self.errors_at(x)

    def errors_at(self, x: np.ndarray) -> np.ndarray:
        """Largest errors of a table.

        Parameters
        ----------
        x : ndarray (n,) [deg]
            Master angles of the rows.

        Returns
        -------
        ndarray (orders,) [unit, per degree]
        """
        return np.asarray(piece_errors(self.slave, self.kind, x, self.row.derivatives).max(axis=1))

    def largest_root(self, x: np.ndarray) -> float:
        """Largest root of an error over its limit in a table.

        Parameters
        ----------
        x : ndarray (n,) [deg]
            Master angles of the rows.
        """
        return float(self._root(piece_errors(self.slave, self.kind, x, self.orders)).max())

    # -- equal steps ----------------------------------------------------------------------------------------

    @property
    def noise(self) -> float:
        """Rounding of computed errors of the value [unit]."""
        return NOISE * float(np.abs(self.slave.values[0]).max())

    def admissible_steps(self, steps: Sequence[int]) -> Iterator[int]:
        """Numbers of equal steps, in rising order, that seem to satisfy the limits.

        After ``SEVERAL`` numbers whose files fail, the rounding of the file is the reason, and larger ones are tried more sparsely.
        """
        first, size, tried = 0, BLOCK, 0
        angles: list[float] = []
        while first < len(steps):
            checkpoint()
            block = np.array(steps[first : first + size])
            first, size = first + size, 2 * size
            for angle in angles[-ANGLES:]:
                block = block[self._roots_near(block, angle, 1.0) <= 1.0 + SAMPLING_ERROR]
            while block.size:
                count, block = int(block[0]), block[1:]
                root, angle = self.steps_root(count)
                if root <= 1.0 + SAMPLING_ERROR:
                    yield count
                    tried += 1
                    if tried > SEVERAL:
                        first = bisect_left(steps, int(GROWTH * count) + 1)
                        break
                    continue
                block = block[self._roots_near(block, angle, 1.0) <= 1.0 + SAMPLING_ERROR]
                angles = [*(other for other in angles if other != angle), angle]

    def best_steps(self, steps: Sequence[int]) -> tuple[int, float]:
        """Number of equal steps with the least root, and that root; any number that satisfies the limits.

        An error of the value below its noise counts as the least, for the bounds of other numbers are noise too.
        """
        enough = max(1.0, float((self.noise / self.limits[0]) ** self._power[0]))
        few = [count for count in steps[:-1] if count <= 2 * self.row.reach]
        counts = np.array(steps[len(few) : -1])
        bound, used = np.zeros(counts.size), set()
        (least, angle), best = self.steps_root(steps[-1]), steps[-1]
        for count in few if least > enough else ():
            least, best = min((least, best), (self.steps_root(count)[0], count))
        while counts.size and least > enough:
            checkpoint()
            if angle not in used:
                bound = np.maximum(bound, self._roots_near(counts, angle, least))
                used.add(angle)
            counts, bound = (values[bound < (1.0 - SAMPLING_ERROR) * least] for values in (counts, bound))
            if counts.size:
                likely = int(np.argmin(bound))
                count, bound[likely] = int(counts[likely]), np.inf
                root, angle = self.steps_root(count)
                least, best = min((least, best), (root, count))
        return best, least

    def steps_root(self, steps: int) -> tuple[float, float]:
        """Largest root for a number of equal steps, and an angle [deg] at which others are likely to be worst."""
        x = equal_steps(steps)
        roots = self.error_roots(x)
        worst = int(np.argmax(roots))
        edges = self.slave.edges[1:-1]
        within = edges[(edges > x[worst] - NEAR) & (edges < x[worst + 1] + NEAR)]
        return float(roots[worst]), float(within[0] if within.size else 0.5 * (x[worst] + x[worst + 1]))

    def _roots_near(self, steps: np.ndarray, angle: float, level: float) -> np.ndarray:
        """Root (k,) of the piece at an angle for numbers of equal steps (k,), coarse above a level; 0 for too few steps."""
        roots, selected = np.zeros(steps.size), np.flatnonzero(steps > 2 * self.row.reach)
        for coarse in (True, False):
            if selected.size:
                roots[selected] = self._root(
                    errors_near(self.slave, self.kind, steps[selected], angle, self.orders, coarse)
                )
                selected = selected[roots[selected] <= COARSE_ERROR * level]
        return roots


def equal_steps(steps: int) -> np.ndarray:
    """Ends of equal steps of the turn.

    Returns
    -------
    ndarray (steps + 1,) [deg]
    """
    return TURN * np.arange(steps + 1) / steps


def _join(knots: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([*(part[:-1] for part in knots), knots[-1][-1:]])


def _correct_mesh(
    mesh: np.ndarray, total: np.ndarray, knots: np.ndarray, measured: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A finer mesh and its sums, which increase over each piece between knots as measured."""
    if knots.size > mesh.size:
        return knots, measured
    fine = np.union1d(mesh, knots)
    sums = np.interp(fine, mesh, total)
    expected = np.maximum(np.diff(np.interp(knots, mesh, total)), 1e-300)
    piece = np.clip(np.searchsorted(knots, 0.5 * (fine[:-1] + fine[1:])) - 1, 0, knots.size - 2)
    increase = np.diff(sums) * (np.diff(measured) / expected)[piece]
    return fine, np.concatenate(([0.0], np.cumsum(increase)))


def _share(need: np.ndarray, pieces: int) -> np.ndarray:
    """Pieces (p,) of each part, at least one, so that the largest need of a piece is least."""
    counts = np.maximum(np.floor(need / need.sum() * (pieces - need.size)), 1).astype(int)
    while counts.sum() > pieces:
        counts[np.argmin(np.where(counts > 1, need / np.maximum(counts - 1, 1), np.inf))] -= 1
    while counts.sum() < pieces:
        counts[np.argmax(need / counts)] += 1
    return counts
