"""A table for a controller: its rows, its file, and the certificate of the file read back."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.number_text import result_text, rounded_up
from core.numerics.lazy import checkpoint
from core.output.controllers.errors import Cycle, Deviation, cycle_effect, largest_errors, table_at
from core.output.controllers.layout import FileTable, file_bytes, read_file, round_column, rounded_table, rounding_error
from core.output.controllers.placing import SAMPLING_ERROR, SPLIT, RowPlacer, equal_steps
from core.output.controllers.rows import KINDS, UNKNOWN, Controller, Table
from core.output.controllers.slave import EQUAL, NEAR, PLACED, TURN, EcamRequest, Slave

NOT_PUBLISHED = "not certified: how this controller interpolates is not published"
TRIES, MARGIN = 8, 1e-3
DEFAULT_POINTS = 361  # of a table that cannot be certified
ORDERS = ("displacement", "velocity", "acceleration")
ERROR_NAMES = ("position", *ORDERS[1:])
OPTIONS = ("--error", "--velocity-error", "--acceleration-error")


@frozen
class Jump:
    """A jump of the exact curve.

    Attributes
    ----------
    at_deg : master angle [deg]
    of : displacement, velocity or acceleration
    jump : size of the jump [unit, per degree]
    rows : number of rows at the jump
    bound : largest error of the value that a single row leaves [unit]; None where unknown
    """

    at_deg: float
    of: str
    jump: float
    rows: int
    bound: float | None


@frozen(eq=False)
class Ecam:
    """A table for an electronic cam, with its certificate.

    Attributes
    ----------
    content : bytes of the file
    table : the table that the controller reads from it, with both ends of the turn [deg, unit]
    rows : number of rows in the file
    deviation : largest errors; None where the controller's interpolation is not published
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
        """Effect of the controller's cycle time; None where it is not requested."""
        if self.request.cycle_ms is None or self.deviation is None or not self.speed_rpm:
            return None
        return cycle_effect(
            self.slave,
            self.interpolation,
            self.table,
            self.deviation.values[0],
            self.request.cycle_ms,
            abs(self.speed_rpm),
        )


def ecam(slave: Slave, controller: Controller, request: EcamRequest, name: str, speed_rpm: float = 0.0) -> Ecam:
    """Table for a request. Raises KindynaError where there is no such table."""
    return _TableBuilder(slave, controller, request, name, speed_rpm).build()


def table_from_file(
    row: Controller, contents: FileTable, per_turn: float, scale: float = 1.0, offset: float = 0.0, advance: float = 0.0
) -> Table:
    """Table of a file over degrees of the master, in the motion's unit, with both ends of the turn.

    Parameters
    ----------
    row : Controller
    contents : FileTable
    per_turn : float
        Master units in a turn.
    scale, offset : float
        The file holds scale times the position plus the offset.
    advance : float
        Increase of the value in a turn [unit].

    Returns
    -------
    Table
    """
    x, s = contents.master * (TURN / per_turn), (contents.slave - offset) / scale
    v = np.zeros(s.size) if contents.velocity is None else contents.velocity / scale * (per_turn / TURN)
    a = np.zeros(s.size) if contents.acceleration is None else contents.acceleration / scale * (per_turn / TURN) ** 2
    states = np.array([s, v, a])
    if row.first_row == "one-step":
        x, states = np.append(x[-1] - TURN, x), np.column_stack((states[:, -1] - [advance, 0.0, 0.0], states))
    elif not row.has_both_ends:
        x, states = np.append(x, x[0] + TURN), np.column_stack((states, states[:, 0] + [advance, 0.0, 0.0]))
    slopes = tuple(slope / scale * (per_turn / TURN) for slope in contents.end_slopes)
    return Table(x, states, (slopes[0], slopes[1]))


class _TableBuilder:
    """Places the rows of a table, writes its file, and certifies it."""

    def __init__(self, slave: Slave, row: Controller, request: EcamRequest, name: str, speed_rpm: float) -> None:
        request.require()
        self.slave, self.row, self.request, self.name, self.speed = slave, row, request, name, speed_rpm
        self.kind = row.select_interpolation(request.interpolation)
        self.per_turn, self.limits = request.per_turn, request.limits
        self.is_certified = self.kind != UNKNOWN
        self.placing = request.placing or (EQUAL if row.equal_steps or not self.is_certified else PLACED)
        self.most = row.rows[1]
        if self.placing == PLACED and row.equal_steps:
            raise KindynaError(f"--as placed: {row.slug} requires equal steps; allowed: equal")
        if request.points is not None and not row.rows[0] <= request.points <= row.rows[1]:
            raise KindynaError(f"--points {request.points}: {row.slug} allows {row.rows[0]} ... {row.rows[1]} rows")
        if not self.is_certified and (request.error or request.velocity_error or request.acceleration_error):
            raise KindynaError(f"--error: {NOT_PUBLISHED}; allowed: --points N" + self._other_interpolations())
        if request.segment is not None and not row.last_is_one:
            raise KindynaError(
                f"--segment {request.segment}: {row.slug} requires the full turn; "
                "allowed: a controller whose file is one segment, such as inventor"
            )
        derivatives = KINDS[self.kind].derivatives if self.is_certified else 3
        if derivatives < 3 and math.isfinite(self.limits[2]):
            raise KindynaError(
                "--acceleration-error: straight lines have no acceleration; allowed: --error, --velocity-error"
            )

    def _other_interpolations(self) -> str:
        known = [name for name in self.row.interpolation if name != UNKNOWN]
        return f", or --interpolation {' | '.join(known)}" if known else ""

    def build(self) -> Ecam:
        """Build the table. Raises KindynaError."""
        if self.kind == "zebra" and self.placing == EQUAL and self.request.points is None:
            raise KindynaError(
                "--as equal: straight and quintic segments in turn need placed rows; allowed: placed, or --points N"
            )
        if not self.is_certified:
            return self._certified_table(self._equal_rows(self.request.points or min(DEFAULT_POINTS, self.most)))
        if self.request.points is not None:
            return self._certified_table(self._rows_of_number(self.request.points, (math.inf,) * 3))
        return self._fewest_rows()

    # -- the rows -------------------------------------------------------------------------------------------

    def _placer(self, limits: tuple[float, ...], kinks: bool = False) -> RowPlacer:
        count = self.row.unit * TURN / self.per_turn if self.row.integer else 0.0
        least_distance = self.row.least_step + count if self.row.least_step else 0.0  # for any rounding of both rows
        return RowPlacer(
            self.slave,
            self.kind,
            limits,
            max(SPLIT, 2.0 * count, least_distance),
            self.placing == PLACED,
            kinks,
            least_distance,
        )

    @property
    def _extra(self) -> int:
        """Number of ends of the turn without a row in the file."""
        return 0 if self.row.has_both_ends else 1

    def _steps(self) -> list[int]:
        """Numbers of equal steps that the controller allows."""
        low, high = self.row.rows[0] - 1 + self._extra, self.most - 1 + self._extra
        if not self.row.step_units:
            return list(range(low, high + 1))
        counts = sorted(round(self.per_turn / unit) for unit in self.row.step_units if self.per_turn % unit == 0.0)
        allowed = [count for count in counts if low <= count <= high]
        if not allowed:
            units = ", ".join(map(str, self.row.step_units))
            raise KindynaError(
                f"{self.row.slug}: a turn of {self.per_turn:g} master units is no whole number of equal steps of {units} units in "
                f"{low} ... {high} steps; choose another --master-per-turn"
            )
        return allowed

    def _equal_rows(self, rows: int) -> np.ndarray:
        count = rows - 1 + self._extra
        if self.row.step_units and count not in self._steps():
            allowed = ", ".join(str(steps + 1 - self._extra) for steps in self._steps())
            raise KindynaError(
                f"--points {rows}: {self.row.slug} requires steps of whole units; allowed: {allowed} rows"
            )
        return equal_steps(count)

    def _rows_of_number(self, rows: int, limits: tuple[float, ...]) -> np.ndarray:
        """Angles of a number of rows with the least error relative to the limits."""
        if self.placing == EQUAL:
            return self._equal_rows(rows)
        trials = []
        for kinks in (False, True):
            placer = self._placer(limits, kinks)
            pieces = rows - 1 + self._extra - placer.splits.size
            least = placer.parts.size - 1
            if self.kind == "zebra" and rows % 2:
                raise KindynaError(
                    f"--points {rows}: {self.row.slug} requires segments in pairs; allowed: an even number"
                )
            if pieces < least and not kinks:
                raise KindynaError(
                    f"--points {rows}: the joins of this motion need {least + 1 - self._extra + placer.splits.size} rows at least"
                )
            if pieces >= least:
                x = placer.row_angles(placer.place(pieces))
                trials.append((placer.largest_root(x), x))
            if self.kind == "zebra":
                break
        return min(trials, key=lambda trial: trial[0])[1]

    @cached_property
    def _rounding(self) -> float:
        """Largest error of a position by rounding in the file [unit]."""
        column = self.request.slave_scale * self.slave.values[0] + self.request.slave_offset
        if self.row.normalised:
            return rounding_error(self.row, np.ones(1)) * float(np.ptp(self.slave.values[0]))
        return rounding_error(self.row, column) / abs(self.request.slave_scale)

    def _fewest_rows(self) -> Ecam:
        """Table of the fewest rows whose file satisfies the limits. Raises KindynaError with the least possible errors."""
        limits = np.array(self.limits)
        limits[0] -= self._rounding
        best: tuple[float, np.ndarray, Deviation] | None = None
        for i, x in enumerate(self._candidates(limits)):
            checkpoint()
            deviation = self._certificate(x)
            ratios = self._over_limits(deviation)
            if ratios.max() <= 1.0 and self._over_limits((table := self._certified_table(x)).deviation).max() <= 1.0:
                return table
            if best is None or ratios.max() < best[0]:
                best = float(ratios.max()), x, deviation
            if self.placing == PLACED:
                limits[: ratios.size] /= np.where(ratios > 1.0, ratios * (1.0 + MARGIN * 2.0**i), 1.0)
        for x in self._best_rows():
            deviation = self._certificate(x)
            largest = float(self._over_limits(deviation).max())
            if best is not None and largest >= best[0]:
                break
            best = largest, x, deviation
        assert best is not None, "at least one is tried"
        if best[0] <= 1.0 and self._over_limits((table := self._certified_table(best[1])).deviation).max() <= 1.0:
            return table
        raise KindynaError(self._refusal(*best[1:]))

    def _over_limits(self, deviation: Deviation | None) -> np.ndarray:
        """Errors relative to their limits."""
        assert deviation is not None
        return np.array(deviation.values) / np.array(self.limits)[: len(deviation.values)]

    def _candidates(self, limits: np.ndarray) -> Iterator[np.ndarray]:
        """Rows that should satisfy the limits, which are reduced while their files do not."""
        if self.row.step_units:
            yield from map(equal_steps, self._steps())
            return
        if limits[0] <= 0.0:
            return
        if self.placing == EQUAL:
            placer = self._placer(tuple(limits))
            if self._best_steps[1] <= 1.0 + SAMPLING_ERROR and limits[0] > placer.noise:
                yield from map(equal_steps, placer.admissible_steps(self._steps()))
            return
        for _ in range(TRIES):
            placer = self._placer(tuple(limits))
            knots = placer.fewest(self.most + self._extra)
            best = None if knots is None else placer.row_angles(knots)
            if self.kind != "zebra" and (best is None or best.size > 4 * placer.slave.edges.size):
                kinked = self._placer(tuple(limits), kinks=True)
                knots = kinked.fewest(self.most if best is None else best.size - 1)
                best = best if knots is None else kinked.row_angles(knots)
            if best is None:
                return
            yield best

    def _best_rows(self) -> Iterator[np.ndarray]:
        """Rows with the least error relative to the limits.

        With equal steps, then half of them and so on, as long as the rounding of more rows has the larger effect.
        """
        if self.row.step_units:
            return  # all are tried already
        if self.placing == EQUAL:
            count, fewest = self._best_steps[0], self._steps()[0]
            while count >= fewest:
                yield equal_steps(count)
                count //= 2
            return
        rows = self.most - (self.most % 2 if self.kind == "zebra" else 0)
        yield self._rows_of_number(rows, self.limits)

    @cached_property
    def _best_steps(self) -> tuple[int, float]:
        return self._placer(self.limits).best_steps(self._steps())

    def _refusal(self, x: np.ndarray, least: Deviation) -> str:
        """Message on the limits that no rows satisfy: the least possible errors, and their cause."""
        symbol = "deg" if self.slave.unit == "deg" else self.slave.unit
        units = (symbol, f"{symbol}/deg", f"{symbol}/deg²")
        lines = []
        for k, ratio in enumerate(self._over_limits(least).tolist()):
            if ratio > 1.0:
                value, limit = f"{rounded_up(least.values[k], 4):g} {units[k]}", self.limits[k]
                lines.append(
                    f"{OPTIONS[k]} {limit:g}: {self.row.slug} cannot keep it; the least error of the {ERROR_NAMES[k]} is {value}, at "
                    f"{result_text(least.at_deg[k], 5)} deg, limited by "
                    f"{self._limiting_cause(x, k, least, units)}; allowed: at least {value}"
                )
        return "\n".join(lines)

    def _limiting_cause(self, x: np.ndarray, order: int, least: Deviation, units: tuple[str, ...]) -> str:
        """Cause of the error in a table with rows at angles x (n,) [deg]."""
        row, at = int(np.clip(np.searchsorted(x, least.at_deg[order]), 1, x.size - 1)), least.at_deg[order]
        step, edges = float(x[row] - x[row - 1]), self.slave.edges[:-1]
        on_rows = self.placing == PLACED and self.kind not in ("zebra", "clamped-spline")
        reach = self._placer(self.limits).split if on_rows else 1.01 * step
        near = np.flatnonzero(self.slave.jumps.any(axis=0) & (np.abs(edges - at) <= reach))
        if near.size:
            i = int(near[0])
            jump_order = int(np.flatnonzero(self.slave.jumps[:, i])[0])
            size = abs(float(self.slave.jumps[jump_order, i]))
            cause = f"the jump of the {ERROR_NAMES[jump_order]} by {result_text(size)} {units[jump_order]} at {result_text(edges[i])} deg"
            if order == 0 and jump_order:
                share = Fraction(KINDS[self.kind].jump[jump_order - 1]).limit_denominator(99)
                cause += (
                    f", which at the step {result_text(step, 3)} deg causes up to about {share} "
                    f"h{'²' * (jump_order - 1)}|Δ{'va'[jump_order - 1]}|"
                )
            return cause
        if order == 0 and least.values[0] <= 3.0 * self._rounding:
            return "the digits of its numbers" + (": choose a larger --slave-scale" if self.row.integer else "")
        return f"its {self.most} rows"

    # -- the file -------------------------------------------------------------------------------------------

    def _certificate(self, x: np.ndarray) -> Deviation:
        """Certificate of rows at angles x (n,) [deg], with both ends of the turn, as their file will be read."""
        contents = rounded_table(self.row, self._file_table(table_at(self.slave, self._round_master(x))), self.per_turn)
        return largest_errors(self.slave, self.kind, self._read_back(contents))

    def _read_back(self, contents: FileTable) -> Table:
        request = self.request
        return table_from_file(
            self.row, contents, self.per_turn, request.slave_scale, request.slave_offset, self.slave.advance
        )

    def _certified_table(self, x: np.ndarray) -> Ecam:
        """File of rows at angles x (n,) [deg], with both ends of the turn, and its certificate."""
        x = self._round_master(x)
        table = table_at(self.slave, x)
        content = file_bytes(self.row, self._file_table(table), self.name, self.kind)
        contents = read_file(self.row, content, self.per_turn)
        read_table = self._read_back(contents)
        deviation = largest_errors(self.slave, self.kind, read_table) if self.is_certified else None
        count = contents.slave.size
        return Ecam(
            self.row, self.kind, self.slave, content, read_table, count, deviation, tuple(self._jumps(x)), self.speed, self.request,
            self.placing,
        )  # fmt: skip

    def _round_master(self, x: np.ndarray) -> np.ndarray:
        """Master angles rounded as in the file. Raises KindynaError where two rows coincide."""
        if "master" not in self.row.columns:
            return x
        per_turn = 1.0 if self.row.normalised else self.per_turn
        result = np.asarray(round_column(self.row, x / TURN * per_turn) / per_turn * TURN)
        end_error = abs(result[-1] - TURN)
        if not (np.diff(result) > 0.0).all() or end_error > NEAR:
            closest_requested = float(np.diff(x).min())  # negative where a row at a jump passes its neighbour
            distance = f" at a distance of {result_text(closest_requested, 3)} deg" if closest_requested > 0.0 else ""
            raise KindynaError(
                f"--master-per-turn {self.per_turn:g}: too coarse, the master would not rise from row to row"
                f"{distance}{', or the turn is no whole number' if end_error > NEAR else ''}; choose a larger one"
            )
        result[-1] = TURN
        if self.row.least_step and (least_distance := float(np.diff(result).min())) < self.row.least_step - NEAR:
            raise KindynaError(
                f"{self.row.slug}: the distance of two rows is {result_text(least_distance, 3)} deg; allowed: "
                f"at least {self.row.least_step:g} deg"
            )
        return result

    def _file_table(self, table: Table) -> FileTable:
        """The rows in the units of the file."""
        scale, per_degree = self.request.slave_scale, TURN / self.per_turn
        selected = (
            slice(1, None)
            if self.row.first_row == "one-step"
            else slice(None)
            if self.row.has_both_ends
            else slice(None, -1)
        )
        s, v, a = table.states[:, selected]
        slopes = (table.slopes[0] * scale * per_degree, table.slopes[1] * scale * per_degree)
        master = table.x[selected] / per_degree
        return FileTable(
            master, scale * s + self.request.slave_offset, scale * v * per_degree, scale * a * per_degree**2, slopes,
            range=(0.0, self.per_turn),
        )  # fmt: skip

    def _jumps(self, x: np.ndarray) -> Iterator[Jump]:
        if not self.is_certified:
            return
        row = KINDS[self.kind]
        for i, at in enumerate(self.slave.edges[:-1].tolist()):
            if not self.slave.jumps[:, i].any():
                continue
            order = int(np.flatnonzero(self.slave.jumps[:, i])[0])
            has_two_rows = i == 0 or (self.placing == PLACED and order < row.through and self.kind != "zebra")
            row_index = int(np.clip(np.searchsorted(x, at), 1, x.size - 1))
            on_row = float(np.abs(x - at).min()) <= NEAR
            count = 2 if has_two_rows else 1
            size = float(self.slave.jumps[order, i])
            bound = None
            if order and not has_two_rows and not (on_row and order >= row.through):
                bound = row.jump[order - 1] * float(x[row_index] - x[row_index - 1]) ** order * abs(size)
            yield Jump(at, ORDERS[order], size, count, bound)
