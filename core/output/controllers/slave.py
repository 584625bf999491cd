"""What a controller's slave axis has to do: the motion, or a coordinate of the linkage, over the angle of the master, exactly."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from core.design import Design, only
from core.design.fields import choice, flag, number, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import Angles, Program, program
from core.motion.extremes import find_highest
from core.output.channels import channels
from core.output.controllers.rows import INTERPOLATIONS, KINDS, MOST_ROWS, Table, evaluated
from core.project import number_of
from core.requests import asked, typed
from core.study import Study

# -- what a controller's slave axis has to do -------------------------------------------------------------------


TURN = 360.0
CERTAIN = 11  # decimals of an angle [deg] that are certain
NEAR = 1e-8  # [deg] a row this near to an edge stands on it
JUMP = 1e-9  # of the largest value over the turn: less is rounding
MOTION = "motion"

Rows = Callable[[Angles], Callable[[int], np.ndarray]]


@frozen
class Placing:
    """How the master's angle x runs against the drive's own: own = sense·(x - shift_deg)."""

    shift_deg: float = 0.0
    reverse: bool = False


PLAIN = Placing()


class Slave:
    """A smooth-by-pieces function of the master's angle over one turn.

    edges    (m + 1,) angles of the master [deg], 0 ... 360, between which it is smooth
    joins    which of them are ends of segments, or places where value, velocity or acceleration jumps
    unit     mm or deg
    advance  what the value grows by in a turn of the master
    """

    def __init__(
        self,
        rows: Rows,
        starts: np.ndarray,
        joins: np.ndarray,
        unit: str,
        scale: float,
        placing: Placing,
        advance: float | None = None,
    ) -> None:
        """rows: own angles -> order of the derivative by the own angle [rad] -> (n,) [SI]; starts (k,) of its pieces [rad], 0 the
        first; joins (j,) of the segments [rad]; scale: SI units of the unit; advance [unit]: what it grows by in a turn of its own, where
        that is known."""
        self.unit, self._rows, self._starts = unit, rows, starts
        self._sense, self._shift = (-1.0 if placing.reverse else 1.0), placing.shift_deg
        self._factor = np.array([(self._sense * np.pi / 180.0) ** k / scale for k in range(3)])
        own = np.rad2deg(starts)
        edges = np.mod(np.round(self._shift + self._sense * own, CERTAIN), TURN)
        self.edges = np.array(sorted({0.0, TURN, *edges.tolist()}))
        middle = self._sense * (0.5 * (self.edges[:-1] + self.edges[1:]) - self._shift)
        self._turns = np.floor(middle / TURN)
        self._piece = np.searchsorted(own, middle - TURN * self._turns, side="right") - 1
        self._ends = np.append(starts[1:], 2.0 * np.pi)
        gain = advance or 0.0
        if unit == "deg" and advance is None:  # an angle that goes round goes on
            last = starts.size - 1
            first = float(rows(Angles(np.zeros(1), np.zeros(1, dtype=int)))(0)[0])
            end = float(rows(Angles(np.array([2.0 * np.pi]), np.array([last])))(0)[0])
            gain = TURN * round((end - first) / (2.0 * np.pi))
        self._before, self.advance = gain * self._turns, self._sense * gain
        self.values = self._sampled()
        places = set(np.mod(np.round(self._shift + self._sense * np.rad2deg(joins), CERTAIN), TURN).tolist())
        size = np.maximum(np.abs(self.values).max(axis=1), 1e-300)
        left, right = self.ends_of(1), self.ends_of(0)
        before = np.roll(left, 1, axis=1)
        before[0, 0] -= self.advance
        self.jumps = right - before
        """(3, m) of value, velocity and acceleration at the start of each piece."""
        self.jumps[np.abs(self.jumps) <= JUMP * size[:, None]] = 0.0
        here = [place in places for place in self.edges[:-1].tolist()]
        self.joins = np.array([*(np.array(here) | self.jumps.any(axis=0)), True])
        self.joins[0] = True

    def state(self, x: np.ndarray, piece: np.ndarray, orders: int = 3) -> np.ndarray:
        """Value, velocity and acceleration [unit, per degree] at angles x (n,) [deg] taken to lie in these pieces (n,): (orders, n)."""
        own = self._sense * (x - self._shift) - TURN * self._turns[piece]
        rows = self._rows(Angles(np.deg2rad(own), self._piece[piece]))
        made = np.array([np.broadcast_to(rows(k), x.shape) * self._factor[k] for k in range(orders)])
        if self.advance:
            made[0] += self._before[piece]
        return made

    def piece_of(self, x: np.ndarray) -> np.ndarray:
        """The piece right of angles x (n,) [deg], the last one at the end of the turn."""
        return np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.edges.size - 2)

    def ends_of(self, end: int) -> np.ndarray:
        """Value, velocity, acceleration (3, m) at the start (0) or the end (1) of each piece."""
        pieces = np.arange(self.edges.size - 1)
        return self.state(self.edges[pieces + end], pieces)

    def pieces_beside(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The pieces (n,) before and behind angles x (n,) [deg]; at both ends of the turn those within it."""
        edge = np.clip(np.searchsorted(self.edges, x - NEAR), 0, self.edges.size - 1)
        on_edge = np.abs(self.edges[edge] - x) <= NEAR
        last = self.edges.size - 2
        behind = np.where(on_edge, np.minimum(edge, last), np.clip(edge - 1, 0, last))
        before = np.where(on_edge, np.maximum(edge - 1, 0), behind)
        return before, behind

    def sides(self, x: np.ndarray, orders: int = 3) -> tuple[np.ndarray, np.ndarray]:
        """Value, velocity, acceleration (orders, n) before and behind angles x (n,) [deg]; at both ends of the turn those within it."""
        before, behind = self.pieces_beside(x)
        made = self.state(x, behind, orders)
        left, two = made, before != behind
        if two.any():
            left = made.copy()
            left[:, two] = self.state(x[two], before[two], orders)
        return left, made

    @property
    def size(self) -> float:
        """Its largest value."""
        return float(np.abs(self.values[0]).max())

    def _sampled(self) -> np.ndarray:
        """Value, velocity and acceleration (3, n) at some angles of all pieces."""
        part, pieces = np.linspace(0.0, 1.0, 33), np.arange(self.edges.size - 1)
        x = self.edges[:-1, None] + np.diff(self.edges)[:, None] * part
        return self.state(x.ravel(), np.repeat(pieces, part.size))


# -- what can be a slave -----------------------------------------------------------------------------------


def _coordinate(name: str, study: Study, order: int) -> np.ndarray:
    return np.asarray(study.linkage.coordinates[name][order])


def _place(point: str, part: str, study: Study, order: int) -> np.ndarray:
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    return np.asarray(getattr(pose.position(point, order), part))


_OWN = {"slider_position": "slider_position", "phi": "phi", "beta": "beta"}


def positions(design: Design) -> Mapping[str, Callable[[Study, int], np.ndarray]]:
    """Column -> value and derivatives by the drive's own angle of every position that a design has."""
    found: dict[str, Callable[[Study, int], np.ndarray]] = {}
    for row in channels(design, ("motion", "linkage")):
        sort, _, member = row.name.partition(".")
        if row.name == "displacement":
            found[row.slug] = lambda study, order: study.motion.displacement[order]
        elif row.name in _OWN:
            found[row.slug] = partial(_coordinate, _OWN[row.name])
        elif sort in ("link", "slide") and not member.endswith(("_velocity", "_acceleration")):
            found[row.slug] = partial(_coordinate, f"{sort}{member}")
        elif sort == "point" and member.endswith(("_x", "_y")):
            found[row.slug] = partial(_place, member[:-2], "real" if member.endswith("_x") else "imag")
    return found


def slave(study: Study, of: str = MOTION, placing: Placing = PLAIN, segment: int | None = None) -> Slave:
    """The motion, or a segment of it alone, counted from 1 and stretched to the turn; or a position of the linkage by the name of its
    column.

    Raises KindynaError where the design has none of that name or number, NoAnswer where the linkage has no position.
    """
    design = study.design
    there = positions(design)
    if of == MOTION and "motion" in study.stages:
        compiled = program(design.drive.motion)
        unit, scale = compiled.motion.unit, compiled.motion.scale

        def motion(angles: Angles) -> Callable[[int], np.ndarray]:
            return compiled.state(angles).displacement.__getitem__

        if segment is not None:
            return _segment(compiled, segment, motion, placing.reverse)
        return Slave(motion, compiled.starts, _joins(compiled), unit, scale, placing, compiled.motion.gain)
    if segment is not None:
        raise KindynaError(f"--segment {segment}: of {of} there are no segments; allowed: --of motion")
    if of not in there:
        names = ([MOTION] if "motion" in study.stages else []) + list(there)
        raise KindynaError(f"--of {of}: this design has no position of that name; allowed: {' | '.join(names)}")
    if study.turn_ranges:
        raise KindynaError("--of: the crank of this design does not turn fully; allowed: one that does")
    value, driven = there[of], study.uncut
    unit = "deg" if of.endswith("_deg") else "mm"
    scale = np.pi / 180.0 if unit == "deg" else 1e-3

    def channel(angles: Angles) -> Callable[[int], np.ndarray]:
        at = study.at(angles)
        return lambda order: value(at, order)

    return Slave(channel, driven.starts, _joins(driven), unit, scale, placing)


def _segment(compiled: Program, number: int, motion: Rows, reverse: bool) -> Slave:
    segments = compiled.motion.segments
    if not 1 <= number <= len(segments):
        raise KindynaError(f"--segment {number}: no such segment; allowed: 1 ... {len(segments)}")
    mine = np.flatnonzero(compiled.segment == number - 1)
    start = compiled.starts[mine[0]]
    part = (compiled.ends[mine[-1]] - start) / np.deg2rad(TURN)

    def stretched(angles: Angles) -> Callable[[int], np.ndarray]:
        rows = motion(Angles(start + angles.theta * part, angles.piece + mine[0]))
        return lambda order: rows(order) * part**order

    starts = (compiled.starts[mine] - start) / part
    unit, scale, rise = compiled.motion.unit, compiled.motion.scale, segments[number - 1].rise
    return Slave(stretched, starts, starts[:1], unit, scale, Placing(0.0, reverse), rise)


def _joins(compiled: Any) -> np.ndarray:
    return np.array([join.theta for join in compiled.joins])


# -- what the drive is really given -----------------------------------------------------------------------------


PARTS = np.clip(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 9)), 1e-9, 1.0 - 1e-9)


@frozen
class Cycle:
    """acceleration_step  largest step of the acceleration from one cycle to the next, by second differences of the sampled path,
                          wherever the cycles fall [m/s², or deg/s²]
    at_deg             angle of the master where it stands
    dominates_above_rpm  from this speed on the straight line between two cycles errs by more than the table; None: at none
    """

    acceleration_step: float
    at_deg: float
    dominates_above_rpm: float | None


def cycle(slave: Slave, kind: str, table: Table, deviation: float, cycle_ms: float, speed_rpm: float) -> Cycle:
    """The path p(x) of a table in cycles of T = cycle_ms: steps of h = ω T degrees, accelerations Δ²p/T², their steps Δ³p/T².

    Between two cycles a straight line errs by h²/8 max|s''| (physics of linear interpolation), which passes the deviation of the table
    at h = √(8 deviation/max|s''|).
    """
    seconds, h = cycle_ms / 1e3, 6.0 * speed_rpm * cycle_ms / 1e3
    coefficients = KINDS[kind].coefficients(table)

    def path(x: np.ndarray) -> np.ndarray:
        turns = np.floor((x - table.x[0]) / TURN)
        x = x - TURN * turns
        piece = np.clip(np.searchsorted(table.x, x, side="right") - 1, 0, table.x.size - 2)
        return np.asarray(evaluated(coefficients[:, piece], x - table.x[piece], 1)[0] + slave.advance * turns)

    breaks = np.unique(np.mod((table.x[:, None] - h * np.arange(4)).ravel(), TURN))
    ends = np.append(breaks, breaks[0] + TURN)
    x = (ends[:-1, None] + np.diff(ends)[:, None] * PARTS).ravel()
    step = np.abs(path(x + 3.0 * h) - 3.0 * path(x + 2.0 * h) + 3.0 * path(x + h) - path(x)) / seconds**2
    top = int(np.argmax(step))
    bend = float(np.abs(slave.values[2]).max())
    limit = math.sqrt(8.0 * deviation / bend) / (6.0 * seconds) if bend > 0.0 and deviation > 0.0 else None
    scale = 1e-3 if slave.unit == "mm" else 1.0
    return Cycle(float(step[top]) * scale, float(np.mod(x[top] + 1.5 * h, TURN)), limit)


# -- how far what a controller runs is from the exact curve -----------------------------------------------------


SAMPLES = ((100, 17), (1000, 9), (10**9, 7))  # of a piece, its ends among them, where there are fewer rows than so many
MANY = 33  # of one within which the curve jumps
COARSE, COARSE_REACH = 5, 4  # samples, and rows on either side, where some per cent will do
FEW, TOPS = 1000, 64  # of more pieces than so many only those are refined that err most
QUANTITIES = ("deviation", "velocity", "acceleration")


@frozen
class Deviation:
    """Largest errors of value, velocity and acceleration [unit, per degree], and the angles of the master [deg] where they stand;
    as many as the interpolation has derivatives."""

    values: tuple[float, ...]
    at_deg: tuple[float, ...]


def table_at(slave: Slave, x: np.ndarray, orders: int = 3) -> Table:
    """The rows of a table at angles x (n,) [deg]; where something jumps the mean of both sides, which leaves the smaller error."""
    return _between(x, *slave.sides(x, orders))


def _between(x: np.ndarray, before: np.ndarray, behind: np.ndarray) -> Table:
    states = 0.5 * (before + behind)
    return Table(x, states, (float(states[1, 0]), float(states[1, -1])) if states.shape[0] > 1 else (0.0, 0.0))


class _Smooth:
    """The intervals within which both a table's pieces, from ``a`` to ``b`` (n,) [deg], and the exact curve are smooth.

    row     (m,) the piece that an interval is part of; first, last (n,) intervals of each piece
    piece   (m,) that of the exact curve
    starts, ends  (m,) [deg]
    """

    def __init__(self, slave: Slave, a: np.ndarray, b: np.ndarray) -> None:
        begin = np.searchsorted(slave.edges, a + NEAR, side="right")
        inside = np.maximum(np.searchsorted(slave.edges, b - NEAR) - begin, 0)
        self.row = np.repeat(np.arange(a.size), inside + 1)
        self.last = np.cumsum(inside + 1) - 1
        self.first = self.last - inside
        number = np.arange(self.row.size) - self.first[self.row]
        self.piece = np.clip(begin[self.row] + number - 1, 0, slave.edges.size - 2)
        self.starts = np.where(number == 0, a[self.row], slave.edges[self.piece])
        self.ends = np.where(number == inside[self.row], b[self.row], slave.edges[self.piece + 1])
        self._slave, self._a = slave, a

    def sampled(self, count: int, orders: int) -> tuple[np.ndarray, np.ndarray]:
        """So many angles of each interval, both ends among them, from the start of its row (m, count) [deg]; and the exact curve there
        (orders, m, count)."""
        w = (self.ends - self.starts)[:, None] * _parts(count)
        at = self.starts[:, None] + w  # in rising order, which is evaluated soonest
        at[:, -1] = self.ends
        piece, known = self.piece, np.empty((orders, *at.shape))
        order = np.argsort(piece, kind="stable")
        known[:, order] = self._slave.state(at[order].ravel(), np.repeat(piece[order], count), orders).reshape(
            known.shape
        )
        return at - self._a[self.row, None], known

    def errors(self, coefficients: np.ndarray, w: np.ndarray, known: np.ndarray, orders: int) -> np.ndarray:
        """The largest error of every interval (orders, m), by samples and a parabola through the highest of them."""
        return _peaks(np.abs(evaluated(coefficients[:, self.row, None], w, orders) - known[:orders]))

    def worst(
        self, coefficients: np.ndarray, w: np.ndarray, known: np.ndarray, orders: int, many: int = MANY
    ) -> np.ndarray:
        """The largest error of every piece (orders, n); many: samples of one within which the curve jumps."""
        made = np.maximum.reduceat(self.errors(coefficients, w, known, orders), self.first, axis=1)
        parted = self.last > self.first
        if w.shape[1] < many and parted.any():
            near = _Smooth(self._slave, self.starts[self.first[parted]], self.ends[self.last[parted]])
            made[:, parted] = near.worst(coefficients[:, parted], *near.sampled(many, orders), orders)
        return np.asarray(made)


def _samples(rows: int) -> int:
    return next(count for fewer, count in SAMPLES if rows < fewer)


def piece_errors(slave: Slave, kind: str, x: np.ndarray, orders: int = 1) -> np.ndarray:
    """Largest errors (orders, n - 1) of value and derivatives between rows at angles x (n,) [deg]. The first and the last sample of a
    piece are what its rows hold, so that the motion is evaluated once."""
    row, smooth = KINDS[kind], _Smooth(slave, x[:-1], x[1:])
    w, known = smooth.sampled(_samples(x.size), max(orders, row.needs))
    starts, ends = known[:, smooth.first, 0], known[:, smooth.last, -1]
    table = _between(x, np.column_stack((starts[:, :1], ends)), np.column_stack((starts, ends[:, -1:])))
    return smooth.worst(row.coefficients(table), w, known, orders)


def errors_near(
    slave: Slave, kind: str, steps: np.ndarray, place: float, orders: int = 1, coarse: bool = False
) -> np.ndarray:
    """The same (orders, k) in tables of so many equal steps (k,), of the piece in which an angle [deg] lies; coarse: to some per cent.

    What runs through all rows is solved for those near it, which hold nearly all of what it does there: of more than 2 reach steps.
    """
    row = KINDS[kind]
    reach = min(row.reach, COARSE_REACH) if coarse else row.reach
    at = np.floor(place / TURN * steps)
    first = np.clip(at - reach, 0, steps - 1 - 2 * reach)
    x = TURN * (first + np.arange(2 * reach + 2)[:, None]) / steps
    states = table_at(slave, x.ravel(), max(1, row.needs)).states.reshape(-1, *x.shape)
    if reach:
        coefficients = row.of_equal(TURN / steps, states)[:, (at - first).astype(int), np.arange(steps.size)]
    else:  # pieces that need not join, one behind the other: what runs from one to the next nobody looks at
        table = Table(x.T.ravel(), states.swapaxes(1, 2).reshape(states.shape[0], -1))
        coefficients = row.coefficients(table)[:, ::2]
    smooth = _Smooth(slave, TURN * at / steps, TURN * (at + 1.0) / steps)
    count = COARSE if coarse else _samples(int(steps.min()))
    return smooth.worst(coefficients, *smooth.sampled(count, orders), orders, COARSE if coarse else MANY)


def _parts(count: int) -> np.ndarray:
    return np.asarray(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count)))


def _peaks(errors: np.ndarray) -> np.ndarray:
    """The largest of samples (orders, n, k), each with what a parabola through it and its neighbours adds."""
    parts = _parts(errors.shape[2])
    top = errors.argmax(axis=2)
    beside = np.clip(top, 1, parts.size - 2)
    left, highest, right = (np.take_along_axis(errors, (beside + k)[:, :, None], axis=2)[:, :, 0] for k in (-1, 0, 1))
    before, behind = parts[beside] - parts[beside - 1], parts[beside + 1] - parts[beside]
    rise, fall = (highest - left) / before, (highest - right) / behind
    slope = (rise * behind - fall * before) / (before + behind)
    bend = np.maximum((rise + fall) / (before + behind), 1e-300)
    added = np.where(top == beside, np.minimum(slope**2 / (4.0 * bend), 0.25 * highest), 0.0)
    return np.asarray(errors.max(axis=2) + added)


class _Pieces:
    """Where the largest errors are looked for: ``starts``, ``ends`` (m,) [rad]."""

    def __init__(self, starts: np.ndarray, ends: np.ndarray) -> None:
        self.starts, self.ends = np.deg2rad(starts), np.deg2rad(ends)


def largest(slave: Slave, kind: str, table: Table) -> Deviation:
    """The certificate: the largest errors over the turn, refined, on both sides of every join and row."""
    smooth, coefficients = _Smooth(slave, table.x[:-1], table.x[1:]), KINDS[kind].coefficients(table)
    orders = KINDS[kind].derivatives
    names = QUANTITIES[:orders]
    kept = np.arange(smooth.row.size)
    if kept.size > FEW:
        sampled = smooth.errors(coefficients, *smooth.sampled(SAMPLES[1][1], orders), orders)
        kept = np.unique(np.argpartition(sampled, -TOPS, axis=1)[:, -TOPS:])
    rows, pieces = smooth.row[kept], smooth.piece[kept]

    def errors(angles: Angles) -> dict[str, np.ndarray]:
        row, x = rows[angles.piece], np.rad2deg(angles.theta)
        exact = slave.state(x, pieces[angles.piece], orders)
        made = evaluated(coefficients[:, row], x - table.x[row], orders)
        return dict(zip(names, np.abs(made - exact), strict=True))

    found = find_highest(errors, _Pieces(smooth.starts[kept], smooth.ends[kept]))  # type: ignore[arg-type]
    return Deviation(
        tuple(found[name].value for name in names),
        tuple(min(float(np.round(np.rad2deg(found[name].theta), 9)), TURN) for name in names),
    )


# -- what a table for a controller shall hold -------------------------------------------------------------------


PLACED, EQUAL = "placed", "equal"
PER_TURN = {"deg": TURN, "rad": 2.0 * math.pi, "counts": None, "mm": None}
"""Unit of the master -> how many of them make a turn; None: that must be given."""
USUAL_ERROR = 1e-3


@frozen
class EcamRequest:
    """Of one table; which controller it is for is asked for beside it."""

    interpolation: str | None = asked(
        choice(
            "Between the rows", INTERPOLATIONS, default=None, help="what the controller is set to run between two rows"
        ),
        usual="what it usually runs",
        metavar="NAME",
    )
    placing: str | None = asked(
        choice("Rows stand", (PLACED, EQUAL), default=None, help="where the rows stand"),
        "--as",
        usual="placed, where the controller takes that",
        words={PLACED: "Placed for the least error", EQUAL: "At equal steps"},
    )
    error: float | None = asked(
        number("Largest error", 0.0, open_low=True, default=None, help="of the position, in the motion's unit"),
        usual="0.001",
        metavar="MM",
        one_of=("Number of rows", "The fewest that keep an error"),
    )
    points: int | None = asked(
        whole("Rows", 2, MOST_ROWS, default=None, help="as many rows, with the least error"),
        one_of=("Number of rows", "As many as given"),
    )
    velocity_error: float | None = asked(
        number("Velocity error", 0.0, open_low=True, default=None, help="largest error of the velocity, per degree of the master"),
        usual="any", metavar="X",
    )  # fmt: skip
    acceleration_error: float | None = asked(
        number("Acceleration error", 0.0, open_low=True, default=None, help="largest error of the acceleration, per degree²"),
        usual="any", metavar="X",
    )  # fmt: skip
    master: str = choice("Master counts in", tuple(PER_TURN), default="deg", help="unit of the master")
    master_per_turn: float | None = asked(
        number("Master, per turn", 0.0, open_low=True, default=None, help="units of the master that make a turn"),
        usual="360 deg, 2π rad", metavar="X",
    )  # fmt: skip
    slave_scale: float = asked(
        number("Slave's scale", default=1.0, help="the file holds scale times the position, plus the offset"),
        metavar="A",
    )
    slave_offset: float = asked(number("Slave's offset", default=0.0, help="in the file's unit"), metavar="B")
    reverse: bool = flag("Run backwards", help="the motion at minus the master's angle")
    shift_deg: float = asked(
        number("Shift", -3600.0, 3600.0, default=0.0, help="the motion begins so many degrees later"),
        "--shift",
        metavar="DEG",
    )
    segment: int | None = asked(
        whole("Segment", 1, 10**6, default=None, help="this segment alone, counted from 1, where a file is one segment"),
        usual="the whole turn", metavar="N",
    )  # fmt: skip
    of: str = typed(
        "what the slave does: motion, or the column of a position, such as link4_deg", default=MOTION, metavar="CHANNEL"
    )
    cycle_ms: float | None = asked(
        number("Cycle", 0.0, 1e4, open_low=True, default=None, help="of the controller, at the design's speed: what the drive is given"),
        "--cycle", usual="not looked at", metavar="MS",
    )  # fmt: skip

    @property
    def per_turn(self) -> float:
        """Units of the master in a turn. Raises KindynaError where nobody says."""
        found = self.master_per_turn or PER_TURN[self.master]
        if found is None:
            raise KindynaError(f"--master {self.master}: needs --master-per-turn, the {self.master} that make a turn")
        return found

    @property
    def limits(self) -> tuple[float, float, float]:
        """Of the errors of position, velocity and acceleration; inf where there is none. Raises KindynaError."""
        given = self.error, self.velocity_error, self.acceleration_error
        if self.points is not None and any(each is not None for each in given):
            raise KindynaError("--points: so many rows have the error that they have; allowed: --points, or errors")
        if all(each is None for each in given) and self.points is None:
            given = USUAL_ERROR, None, None
        return tuple(math.inf if each is None else each for each in given)  # type: ignore[return-value]

    def require(self) -> None:
        """Raises KindynaError for a scale of zero."""
        if self.slave_scale == 0.0:
            raise KindynaError("--slave-scale 0: all rows would be alike; allowed: any other number")


# -- the slave of a design, by the angle of its machine ---------------------------------------------------------


def slave_of(design: Design, drive: str, request: EcamRequest) -> tuple[Slave, str, float]:
    """What the slave does, what its table is called, and the speed of its master [rpm].

    Of a shaft with several drives the master is the shaft, one for all of them: each begins at its phase. Raises KindynaError.
    """
    number = number_of(design, drive)
    single = only(design, number)
    if request.segment is not None and request.shift_deg:
        raise KindynaError("--shift: a segment alone begins where it begins; allowed: --shift, or --segment")
    shift = request.shift_deg + design.drives[number].phase_deg
    placed = slave(Study(single), request.of, Placing(shift, request.reverse), request.segment)
    return placed, single.name, single.speed_rpm


def slaves_of(design: Design, drive: str) -> dict[str, str]:
    """What the slave may be -> in words: the motion, and every position of the linkage."""
    single = only(design, number_of(design, drive))
    moves = {MOTION: "the motion"} if single.drive.motion is not None else {}
    labels = {row.slug: row.label for row in channels(single, ("motion", "linkage"))}
    return moves | {name: labels[name] for name in positions(single) if name not in OF_MOTION}


OF_MOTION = ("displacement_mm", "displacement_deg")
"""The same as the motion."""
