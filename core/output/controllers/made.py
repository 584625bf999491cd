"""A table for a controller: its rows, its file, and the certificate of the file read back."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.numerics.cancellation import checkpoint
from core.output.controllers.cycle import Cycle, cycle
from core.output.controllers.deviation import QUANTITIES, Deviation, largest, table_at
from core.output.controllers.interpolation import KINDS, Table
from core.output.controllers.layout import FileTable, as_read, read, rounded, rounding_of, steps, written
from core.output.controllers.placement import CERTAIN, HAIR, Placer, equal
from core.output.controllers.request import EQUAL, PLACED, Request
from core.output.controllers.row import UNKNOWN, Controller
from core.output.controllers.slave import NEAR, TURN, Slave
from core.output.profile.digits import rounded_up

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
    request: Request
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


def ecam(slave: Slave, controller: Controller, request: Request, name: str, speed_rpm: float = 0.0) -> Ecam:
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
    def __init__(self, slave: Slave, row: Controller, request: Request, name: str, speed_rpm: float) -> None:
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


def with_points(request: Request, points: int) -> Request:
    """The same table with so many rows."""
    return replace(request, points=points, error=None, velocity_error=None, acceleration_error=None)


__all__ = ["NOT_PUBLISHED", "QUANTITIES", "Ecam", "Jump", "ecam", "read_back", "steps", "with_points"]
