"""A table for a controller: its rows, its file, and the certificate of the file read back."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.output.controllers.layout import FileTable, as_read, read, rounded, rounding_of, written
from core.output.controllers.rows import KINDS, UNKNOWN, Controller, Table
from core.output.controllers.slave import (
    EQUAL,
    NEAR,
    PLACED,
    TURN,
    Cycle,
    Deviation,
    EcamRequest,
    Slave,
    cycle,
    errors_near,
    largest,
    piece_errors,
    table_at,
)
from core.output.files.profile_request import rounded_up

# -- where the rows of a table stand ----------------------------------------------------------------------------


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


# -- A table for a controller -----------------------------------------------------------------------------------


NOT_PUBLISHED = "not certified: how this controller interpolates is not published"
TRIES, MISSED = 8, 1e-3
USUAL_POINTS = 361  # of what cannot be certified, where nobody says
ORDERS = ("displacement", "velocity", "acceleration")
SAID = ("position", *ORDERS[1:])
OPTIONS = ("--error", "--velocity-error", "--acceleration-error")


@frozen
class Jump:
    """Where the exact curve jumps: angle of the master [deg], what of it, by how much [unit, per degree], how many rows tell it, and
    what one row leaves of the value's error, at most."""

    at_deg: float
    of: str
    jump: float
    rows: int
    bound: float | None


@frozen(eq=False)
class Ecam:
    """A table, ready to be written.

    content    the file
    table      what the controller reads in it, both ends of the turn among its rows [deg, unit]
    rows       of the file
    deviation  None where the controller's interpolation is not published
    """

    controller: Controller
    interpolation: str
    slave: Slave
    content: bytes
    table: Table
    rows: int
    deviation: Deviation | None
    jumps: tuple[Jump, ...]
    speed_rpm: float
    request: EcamRequest
    placing: str

    @cached_property
    def cycle(self) -> Cycle | None:
        """What the drive is given in the controller's cycles, where they are asked for."""
        if self.request.cycle_ms is None or self.deviation is None or not self.speed_rpm:
            return None
        return cycle(
            self.slave,
            self.interpolation,
            self.table,
            self.deviation.values[0],
            self.request.cycle_ms,
            abs(self.speed_rpm),
        )


def ecam(slave: Slave, controller: Controller, request: EcamRequest, name: str, speed_rpm: float = 0.0) -> Ecam:
    """The table that a request asks for. Raises KindynaError where there is none such."""
    return _Maker(slave, controller, request, name, speed_rpm).made()


def read_back(
    row: Controller, found: FileTable, per_turn: float, scale: float = 1.0, offset: float = 0.0, advance: float = 0.0
) -> Table:
    """What a file says, by degrees of the master and in the motion's unit, both ends of the turn among its rows."""
    x, s = found.master * (TURN / per_turn), (found.slave - offset) / scale
    v = np.zeros(s.size) if found.velocity is None else found.velocity / scale * (per_turn / TURN)
    a = np.zeros(s.size) if found.acceleration is None else found.acceleration / scale * (per_turn / TURN) ** 2
    states = np.array([s, v, a])
    if row.first_row == "one-step":
        x, states = np.append(x[-1] - TURN, x), np.column_stack((states[:, -1] - [advance, 0.0, 0.0], states))
    elif not row.closing:
        x, states = np.append(x, x[0] + TURN), np.column_stack((states, states[:, 0] + [advance, 0.0, 0.0]))
    slopes = tuple(slope / scale * (per_turn / TURN) for slope in found.end_slopes)
    return Table(x, states, (slopes[0], slopes[1]))


class _Maker:
    def __init__(self, slave: Slave, row: Controller, request: EcamRequest, name: str, speed_rpm: float) -> None:
        request.require()
        self.slave, self.row, self.request, self.name, self.speed = slave, row, request, name, speed_rpm
        self.kind = row.chosen(request.interpolation)
        self.per_turn, self.limits = request.per_turn, request.limits
        self.certified = self.kind != UNKNOWN
        self.placing = request.placing or (EQUAL if row.equal_steps or not self.certified else PLACED)
        self.most = row.rows[1]
        if self.placing == PLACED and row.equal_steps:
            raise KindynaError(f"--as placed: {row.slug} takes equal steps only; allowed: equal")
        if request.points is not None and not row.rows[0] <= request.points <= row.rows[1]:
            raise KindynaError(f"--points {request.points}: {row.slug} takes {row.rows[0]} ... {row.rows[1]} rows")
        if not self.certified and (request.error or request.velocity_error or request.acceleration_error):
            raise KindynaError(f"--error: {NOT_PUBLISHED}; allowed: --points N" + self._others())
        if request.segment is not None and not row.last_is_one:
            raise KindynaError(
                f"--segment {request.segment}: {row.slug} takes the whole turn; "
                "allowed: a controller whose file is one segment, such as inventor"
            )
        derivatives = KINDS[self.kind].derivatives if self.certified else 3
        if derivatives < 3 and math.isfinite(self.limits[2]):
            raise KindynaError(
                "--acceleration-error: straight lines have no acceleration; allowed: --error, --velocity-error"
            )

    def _others(self) -> str:
        known = [each for each in self.row.interpolation if each != UNKNOWN]
        return f", or --interpolation {' | '.join(known)}" if known else ""

    def made(self) -> Ecam:
        """The table. Raises KindynaError."""
        if self.kind == "zebra" and self.placing == EQUAL and self.request.points is None:
            raise KindynaError(
                "--as equal: straight and quintic segments in turn are placed; allowed: placed, or --points N"
            )
        if not self.certified:
            return self._of(self._equal(self.request.points or min(USUAL_POINTS, self.most)))
        if self.request.points is not None:
            return self._of(self._fixed(self.request.points, (math.inf,) * 3))
        return self._kept()

    # -- the rows -------------------------------------------------------------------------------------------

    def _placer(self, limits: tuple[float, ...], kinks: bool = False) -> Placer:
        count = self.row.unit * TURN / self.per_turn if self.row.integer else 0.0
        apart = self.row.least_step + count if self.row.least_step else 0.0  # whichever way both rows are rounded
        return Placer(
            self.slave, self.kind, limits, max(HAIR, 2.0 * count, apart), self.placing == PLACED, kinks, apart
        )

    @property
    def _extra(self) -> int:
        """Ends of the turn that no row of the file stands for."""
        return 0 if self.row.closing else 1

    def _steps(self) -> list[int]:
        """The numbers of equal steps that the controller takes."""
        low, high = self.row.rows[0] - 1 + self._extra, self.most - 1 + self._extra
        if not self.row.step_units:
            return list(range(low, high + 1))
        made = sorted(round(self.per_turn / unit) for unit in self.row.step_units if self.per_turn % unit == 0.0)
        fitting = [count for count in made if low <= count <= high]
        if not fitting:
            units = ", ".join(map(str, self.row.step_units))
            raise KindynaError(
                f"{self.row.slug}: a turn of {self.per_turn:g} master units is no whole number of equal steps of {units} units in "
                f"{low} ... {high} steps; choose another --master-per-turn"
            )
        return fitting

    def _equal(self, rows: int) -> np.ndarray:
        count = rows - 1 + self._extra
        if self.row.step_units and count not in self._steps():
            allowed = ", ".join(str(each + 1 - self._extra) for each in self._steps())
            raise KindynaError(f"--points {rows}: {self.row.slug} takes steps of whole units; allowed: {allowed} rows")
        return equal(count)

    def _fixed(self, rows: int, limits: tuple[float, ...]) -> np.ndarray:
        """So many rows that err least, measured by these limits."""
        if self.placing == EQUAL:
            return self._equal(rows)
        tried = []
        for kinks in (False, True):
            placer = self._placer(limits, kinks)
            pieces = rows - 1 + self._extra - placer.hairs.size
            least = placer.parts.size - 1
            if self.kind == "zebra" and rows % 2:
                raise KindynaError(f"--points {rows}: {self.row.slug} takes segments in pairs; allowed: an even number")
            if pieces < least and not kinks:
                raise KindynaError(
                    f"--points {rows}: the joins of this motion need {least + 1 - self._extra + placer.hairs.size} rows at least"
                )
            if pieces >= least:
                x = placer.x_of(placer.of_count(pieces))
                tried.append((placer.root(x), x))
            if self.kind == "zebra":
                break
        return min(tried, key=lambda each: each[0])[1]

    @cached_property
    def _rounding(self) -> float:
        """By how much the file rounds a position, at most [unit]."""
        column = self.request.slave_scale * self.slave.values[0] + self.request.slave_offset
        if self.row.normalised:
            return rounding_of(self.row, np.ones(1)) * float(np.ptp(self.slave.values[0]))
        return rounding_of(self.row, column) / abs(self.request.slave_scale)

    def _kept(self) -> Ecam:
        """The fewest rows whose file, read back, keeps the limits. Raises KindynaError with the least that can be."""
        limits = np.array(self.limits)
        limits[0] -= self._rounding
        best: tuple[float, np.ndarray, Deviation] | None = None
        for i, x in enumerate(self._candidates(limits)):
            checkpoint()
            found = self._worth(x)
            over = self._over(found)
            if over.max() <= 1.0 and self._over((made := self._of(x)).deviation).max() <= 1.0:
                return made
            if best is None or over.max() < best[0]:
                best = float(over.max()), x, found
            if self.placing == PLACED:
                limits[: over.size] /= np.where(over > 1.0, over * (1.0 + MISSED * 2.0**i), 1.0)
        for x in self._bests():
            found = self._worth(x)
            most = float(self._over(found).max())
            if best is not None and most >= best[0]:
                break
            best = most, x, found
        assert best is not None, "there is one at least"
        if best[0] <= 1.0 and self._over((made := self._of(best[1])).deviation).max() <= 1.0:
            return made
        raise KindynaError(self._refusal(*best[1:]))

    def _over(self, found: Deviation | None) -> np.ndarray:
        """The errors over their limits."""
        assert found is not None
        return np.array(found.values) / np.array(self.limits)[: len(found.values)]

    def _candidates(self, limits: np.ndarray) -> Iterator[np.ndarray]:
        """Rows that should keep the limits, which may fall while they do not."""
        if self.row.step_units:
            yield from map(equal, self._steps())
            return
        if limits[0] <= 0.0:
            return
        if self.placing == EQUAL:
            if self._best_equal[1] <= 1.0 + CERTAIN:
                yield from map(equal, self._placer(tuple(limits)).keeping(self._steps()))
            return
        for _ in range(TRIES):
            placer = self._placer(tuple(limits))
            knots = placer.least(self.most + self._extra)
            best = None if knots is None else placer.x_of(knots)
            if self.kind != "zebra" and (best is None or best.size > 4 * placer.slave.edges.size):
                kinked = self._placer(tuple(limits), kinks=True)
                knots = kinked.least(self.most if best is None else best.size - 1)
                best = best if knots is None else kinked.x_of(knots)
            if best is None:
                return
            yield best

    def _bests(self) -> Iterator[np.ndarray]:
        """Rows that err least, measured by the limits; then half as many and so on, for as long as the digits of more rows are what errs
        more."""
        if self.row.step_units:
            return  # all have been tried
        if self.placing == EQUAL:
            count, fewest = self._best_equal[0], self._steps()[0]
            while count >= fewest:
                yield equal(count)
                count //= 2
            return
        rows = self.most - (self.most % 2 if self.kind == "zebra" else 0)
        yield self._fixed(rows, self.limits)

    @cached_property
    def _best_equal(self) -> tuple[int, float]:
        return self._placer(self.limits).best_equal(self._steps())

    def _refusal(self, x: np.ndarray, least: Deviation) -> str:
        """What of the limits no rows keep, the least that can be, and what holds it."""
        symbol = "deg" if self.slave.unit == "deg" else self.slave.unit
        units = (symbol, f"{symbol}/deg", f"{symbol}/deg²")
        lines = []
        for k, over in enumerate(self._over(least).tolist()):
            if over > 1.0:
                value, limit = f"{rounded_up(least.values[k], 4):g} {units[k]}", self.limits[k]
                lines.append(
                    f"{OPTIONS[k]} {limit:g}: {self.row.slug} cannot keep it; the least error of the {SAID[k]} is {value}, at "
                    f"{least.at_deg[k]:.6g} deg, held by {self._holds(x, k, least, units)}; allowed: at least {value}"
                )
        return "\n".join(lines)

    def _holds(self, x: np.ndarray, order: int, least: Deviation, units: tuple[str, ...]) -> str:
        """What keeps an error from being less than that of rows at angles x (n,) [deg]."""
        place, at = int(np.clip(np.searchsorted(x, least.at_deg[order]), 1, x.size - 1)), least.at_deg[order]
        step, edges = float(x[place] - x[place - 1]), self.slave.edges[:-1]
        on_rows = self.placing == PLACED and self.kind not in ("zebra", "clamped-spline")
        reach = self._placer(self.limits).hair if on_rows else 1.01 * step
        near = np.flatnonzero(self.slave.jumps.any(axis=0) & (np.abs(edges - at) <= reach))
        if near.size:
            i = int(near[0])
            jumping = int(np.flatnonzero(self.slave.jumps[:, i])[0])
            size = abs(float(self.slave.jumps[jumping, i]))
            told = f"the jump of the {SAID[jumping]} by {size:.4g} {units[jumping]} at {edges[i]:.6g} deg"
            if order == 0 and jumping:
                share = Fraction(KINDS[self.kind].jump[jumping - 1]).limit_denominator(99)
                told += f", which at the step {step:.3g} deg leaves up to about {share} h{'²' * (jumping - 1)}|Δ{'va'[jumping - 1]}|"
            return told
        if order == 0 and least.values[0] <= 3.0 * self._rounding:
            return "the digits of its numbers" + (": choose a larger --slave-scale" if self.row.integer else "")
        return f"its {self.most} rows"

    # -- the file -------------------------------------------------------------------------------------------

    def _worth(self, x: np.ndarray) -> Deviation:
        """The certificate of rows at angles x (n,) [deg], both ends of the turn among them, as their file will be read."""
        found = as_read(self.row, self._file(table_at(self.slave, self._on_units(x))), self.per_turn)
        return largest(self.slave, self.kind, self._back(found))

    def _back(self, found: FileTable) -> Table:
        request = self.request
        return read_back(self.row, found, self.per_turn, request.slave_scale, request.slave_offset, self.slave.advance)

    def _of(self, x: np.ndarray) -> Ecam:
        """The file of rows at angles x (n,) [deg], both ends of the turn among them, and what it is worth."""
        x = self._on_units(x)
        table = table_at(self.slave, x)
        content = written(self.row, self._file(table), self.name, self.kind)
        found = read(self.row, content, self.per_turn)
        back = self._back(found)
        deviation = largest(self.slave, self.kind, back) if self.certified else None
        count = found.slave.size
        return Ecam(
            self.row, self.kind, self.slave, content, back, count, deviation, tuple(self._jumps(x)), self.speed, self.request,
            self.placing,
        )  # fmt: skip

    def _on_units(self, x: np.ndarray) -> np.ndarray:
        """Angles as the file's digits of the master say them. Raises KindynaError where two rows would be one."""
        if "master" not in self.row.columns:
            return x
        per_turn = 1.0 if self.row.normalised else self.per_turn
        made = np.asarray(rounded(self.row, x / TURN * per_turn) / per_turn * TURN)
        ends = abs(made[-1] - TURN)
        if not (np.diff(made) > 0.0).all() or ends > NEAR:
            wanted = float(np.diff(x).min())  # below zero where rows that tell a jump pass their neighbours
            apart = f" where they stand {wanted:.3g} deg apart" if wanted > 0.0 else ""
            raise KindynaError(
                f"--master-per-turn {self.per_turn:g}: too coarse, the master would not rise from row to row"
                f"{apart}{', or the turn is no whole number' if ends > NEAR else ''}; choose a larger one"
            )
        made[-1] = TURN
        if self.row.least_step and (closest := float(np.diff(made).min())) < self.row.least_step - NEAR:
            raise KindynaError(
                f"{self.row.slug}: two rows stand {closest:.3g} deg apart; allowed: at least {self.row.least_step:g} deg"
            )
        return made

    def _file(self, table: Table) -> FileTable:
        """The rows in the file's units."""
        scale, per_degree = self.request.slave_scale, TURN / self.per_turn
        kept = (
            slice(1, None) if self.row.first_row == "one-step" else slice(None) if self.row.closing else slice(None, -1)
        )
        s, v, a = table.states[:, kept]
        slopes = (table.slopes[0] * scale * per_degree, table.slopes[1] * scale * per_degree)
        master = table.x[kept] / per_degree
        return FileTable(
            master, scale * s + self.request.slave_offset, scale * v * per_degree, scale * a * per_degree**2, slopes,
            range=(0.0, self.per_turn),
        )  # fmt: skip

    def _jumps(self, x: np.ndarray) -> Iterator[Jump]:
        if not self.certified:
            return
        row = KINDS[self.kind]
        for i, at in enumerate(self.slave.edges[:-1].tolist()):
            if not self.slave.jumps[:, i].any():
                continue
            order = int(np.flatnonzero(self.slave.jumps[:, i])[0])
            two = i == 0 or (self.placing == PLACED and order < row.through and self.kind != "zebra")
            place = int(np.clip(np.searchsorted(x, at), 1, x.size - 1))
            on_row = float(np.abs(x - at).min()) <= NEAR
            told = 2 if two else 1
            size = float(self.slave.jumps[order, i])
            bound = None
            if order and not two and not (on_row and order >= row.through):
                bound = row.jump[order - 1] * float(x[place] - x[place - 1]) ** order * abs(size)
            yield Jump(at, ORDERS[order], size, told, bound)


def with_points(request: EcamRequest, points: int) -> EcamRequest:
    """The same table with so many rows."""
    return replace(request, points=points, error=None, velocity_error=None, acceleration_error=None)
