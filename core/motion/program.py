"""The motion compiled: prescribed position of the output at every cam angle, with three exact derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from math import pi
from typing import Any

import numpy as np

from core.design import Motion
from core.findings import ERROR, NOTE, WARNING, Finding
from core.frozen import frozen
from core.laws import Piece, PieceTable
from core.motion.curves import curve_shape, with_joined_ends
from core.numerics.derivatives import Derivatives, distinct, unit
from core.numerics.lazy import Lazy
from core.numerics.roots import two_sum

# -- the motion compiled ----------------------------------------------------------------------------------------


TURN = 2.0 * pi
EPS = float(np.finfo(float).eps)
SNAP = 4.0 * EPS * TURN  # an angle this close below a join is on the join: it gets the right-hand limit
JUMP_BOUND = 64.0  # a jump below this many eps of the neighbouring values is rounding


@frozen(eq=False)
class Angles:
    """Cam angles, each with the piece of the motion that it is taken to lie in.

    theta  (n,) [rad], 0 ... 2π
    piece  (n,) row of ``CompiledMotion``; at a join it says which side is meant
    kept   True for a grid that stages may keep results of
    search True for the samples between which extremes are searched: kept apart from what tables and plots show
    unit   (n,) complex, e^{iθ}, made when it is read
    """

    theta: np.ndarray
    piece: np.ndarray
    cached: bool = False
    search: bool = False
    unit: Lazy[np.ndarray] = Lazy(lambda angles: unit(angles.theta))


@frozen(eq=False)
class Join:
    """Where two segments meet: cam angle [rad], the jumps of s, v, a, j there (4,) [SI, per radian], and which of
    them are more than rounding."""

    theta: float
    jump: np.ndarray
    jumps: np.ndarray


@frozen(eq=False)
class MotionState:
    """The motion at ``angles``: displacement y and its three derivatives by cam angle [m or rad], and the sign of its
    velocity as the segment states it (n,): 0 in a dwell, never toggled by rounding.

    within  (2, n) cam angle and displacement in the middle of the piece that each angle is taken to lie in, where the turn is cut
            at what switches; else those of the angle itself
    """

    angles: Angles
    displacement: Derivatives
    velocity_sign: np.ndarray
    within: Lazy[np.ndarray] = Lazy(lambda state: np.array([state.theta, state.displacement[0]]))

    @property
    def y(self) -> np.ndarray:
        """Displacement (4, n) [m or rad] with its derivatives by cam angle up to the third."""
        return self.displacement.all

    @property
    def theta(self) -> np.ndarray:
        """Cam angles (n,) [rad]."""
        return self.angles.theta


class CompiledMotion:
    """A motion compiled to one table of pieces.

    starts    (m,) cam angle [rad] where each piece starts; ends (m,) where it ends
    segment   (m,) the segment it belongs to
    """

    _copies = 1  # of the table's pieces, one after the other

    def __init__(self, motion: Motion) -> None:
        pieces, rows = _rows_of(motion)
        self._table = PieceTable(pieces)
        self._set(motion, np.array(rows).T)
        self._gains = np.array([motion.gain * motion.scale])

    def _set(self, motion: Motion, rows: np.ndarray) -> None:
        """From rows (6, m), or (6, k, m) of as many motions."""
        segment, starts, span, levels, gain, signs = rows
        ends = np.concatenate((starts[..., 1:], np.full((*starts.shape[:-1], 1), TURN)), axis=-1)
        self.motion = motion
        self.starts, self.ends, self.velocity_signs, self._span = (x.ravel() for x in (starts, ends, signs, span))
        self.segment = segment.ravel().astype(int)
        self._base = levels.ravel() * motion.scale
        # h/β^k, so that derivatives by u become derivatives by cam angle
        self._gain = gain.ravel() * motion.scale / self._span ** np.arange(4)[:, None]

    @classmethod
    def from_columns(cls, motion: Motion, count: int) -> CompiledMotion:
        """As ``stacked``, of so many motions: one in which spans and rises are columns (count,), of curves that these only stretch."""
        pieces, rows = _rows_of(motion)
        made = cls.__new__(cls)
        made._table, made._copies = PieceTable(pieces), count
        columns = np.empty((len(rows[0]), count, len(rows)))
        for piece, row in enumerate(rows):
            for k, each in enumerate(row):
                columns[k, :, piece] = each
        made._set(motion, columns)
        made._gains = np.broadcast_to(motion.gain * motion.scale, count)
        return made

    @classmethod
    def stacked(cls, programs: Sequence[CompiledMotion]) -> CompiledMotion:
        """Several motions of as many pieces: those of the second follow on those of the first. Of it ``state`` is asked, at angles whose
        pieces are known, and ``jumps``."""
        made = cls.__new__(cls)
        made.motion = programs[0].motion  # for its unit, which all share
        for name in ("_gains", "starts", "ends", "segment", "_span", "_gain", "_base", "velocity_signs"):
            setattr(made, name, np.concatenate([getattr(each, name) for each in programs], axis=-1))
        made._table = PieceTable.stacked([each._table for each in programs])
        return made

    def angles(self, theta: np.ndarray, cached: bool = False) -> Angles:
        """Any cam angles (n,) [rad], each with the piece right of it."""
        theta = np.asarray(theta, dtype=float)
        if theta.size and (theta.min() < 0.0 or theta.max() >= TURN - SNAP):
            theta = np.mod(theta, TURN)
            theta = np.where(theta >= TURN - SNAP, 0.0, theta)  # the end of the turn is the first join
        piece = np.searchsorted(self.starts - SNAP, theta, side="right") - 1
        return Angles(theta, piece, cached)

    def uncut(self, angles: Angles) -> Angles:
        """The same, whose pieces are the motion's own."""
        return angles

    def state(self, angles: Angles) -> MotionState:
        """The motion at these angles; exact derivatives, no interpolation."""
        return self.state_from_curve(self.curve(angles), angles)

    def curve(self, angles: Angles) -> Callable[[int], np.ndarray]:
        """order -> of the curves of the pieces, from 0 to 1, the value (n,) at these angles or its derivative by the part of the span."""
        at = angles.piece
        own = at if self._copies == 1 else at % self._table.starts.size
        return self._table.rows(own, (angles.theta - self.starts[at]) / self._span[at])

    def stretched(
        self,
        curve: Callable[[int], np.ndarray],
        angles: Angles,
        taken: Callable[[np.ndarray], np.ndarray] | None = None,
    ) -> MotionState:
        """The motion of what ``curve`` gives at these angles; taken: how what each piece has (m,) is taken there, where there is a quicker
        way than by the angles' pieces."""
        at = taken or (lambda row: row[angles.piece])

        def row(order: int) -> np.ndarray:
            y = np.multiply(curve(order), at(self._gain[order]))
            if not order:
                y += at(self._base)
            return y

        return MotionState(angles, Derivatives(row), at(self.velocity_signs))

    @cached_property
    def powers(self) -> np.ndarray:
        """Of every piece the coefficients (k, m) [SI] of the powers of the cam angle from its start; ``sines`` add to them."""
        polynomial = self._table.derivatives[0]
        rows = self._gain[0] * polynomial / self._span ** np.arange(polynomial.shape[0])[:, None]
        rows[0] += self._base
        return np.asarray(rows)

    @cached_property
    def sines(self) -> np.ndarray:
        """Amplitude [SI], frequency [per radian] and phase [rad] (3, j, m) of every piece's sines, by the cam angle from its start."""
        amplitude, frequency, phase = self._table.sines
        return np.array([self._gain[0] * amplitude, frequency / self._span, phase])

    @cached_property
    def joins(self) -> tuple[Join, ...]:
        """Every join of two segments, the one at 360 -> 0 last."""
        first, jump, jumps = self.jumps()
        where = np.append(self.starts[first][1:], 0.0)
        return tuple(Join(float(where[i]), jump[:, i], jumps[:, i]) for i in range(first.size))

    @cached_property
    def rests(self) -> bool:
        """Whether every segment begins and ends with velocity 0, where the one before it ends."""
        begin, end = (
            self.state(Angles(ends, np.arange(ends.size))).displacement[1] for ends in (self.starts, self.ends)
        )
        first, last = (np.diff(self.segment, **beyond) != 0 for beyond in ({"prepend": -1}, {"append": -1}))
        bound = JUMP_BOUND * EPS * np.abs(self._gain[1]) * self._table.sizes()[1]
        moves = (first & (np.abs(begin) > bound)) | (last & (np.abs(end) > bound))
        return not moves.any() and not any(join.jumps[0] for join in self.joins)

    def jumps(self, turns: int = 1, orders: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """At the end of every segment: the piece it begins with (k,), the jumps of s, v, a, j (4, k), or of so many of them, and which are
        more than rounding, at the end of the turn beyond the advance; of so many motions, where several are stacked, one after the
        other."""
        segment = self.segment.reshape(turns, -1)
        first = np.flatnonzero(np.diff(segment, axis=1, prepend=-1))
        last = np.flatnonzero(np.diff(segment, axis=1, append=-1))

        def of_next(rows: np.ndarray) -> np.ndarray:
            return np.roll(rows.reshape(*rows.shape[:-1], turns, -1), -1, axis=-1).reshape(rows.shape)

        pieces, ends = np.array([first, last]), np.array([self.starts[first], self.ends[last]])
        own = slice(first.size // self._copies)  # the curves of the others are these
        curve = self.curve(Angles(ends[:, own].ravel(), pieces[:, own].ravel()))

        def tiled(order: int) -> np.ndarray:
            return np.tile(curve(order).reshape(2, -1), self._copies).ravel()

        there = self.state_from_curve(tiled, Angles(ends.ravel(), pieces.ravel())).displacement
        begin, end = np.array([there[order] for order in range(orders)]).reshape(orders, 2, -1).swapaxes(0, 1)
        jump = of_next(begin) - end
        jump[0].reshape(turns, -1)[:, -1] += self._gains  # where the next turn begins
        # what a segment's own size of s, v, a, j leaves to rounding at its ends
        size = (np.abs(self._gain[:orders]) * np.tile(self._table.sizes()[:orders], self._copies))[:, last]
        size[0] += np.abs(self._base[last])
        bound = JUMP_BOUND * EPS * np.maximum(size, of_next(size))
        bound *= 1.0 + TURN / np.minimum(self._span[last], of_next(self._span[last]))
        bound[0] += 1e-9 * self.motion.scale  # the sum of rises may miss zero by this
        return first, jump, np.abs(jump) > bound


def _rows_of(motion: Motion) -> tuple[list[Piece], list[tuple[Any, ...]]]:
    """The pieces of all segments; and of each its segment, start and span of that [rad], level, gain and sign of the velocity."""
    pieces: list[Piece] = []
    rows = []
    spans = [s.span_deg for s in motion.segments]
    # spans may miss the turn by 1e-9: shared by all, else the last one would end before or behind its end
    *sums, turn = _sums_before([*spans, 0.0])
    whole = 360.0 / turn
    heights = _sums_before([s.rise for s in motion.segments])
    for i, (part, before, height) in enumerate(zip(motion.segments, sums, heights, strict=True)):
        shape = curve_shape(with_joined_ends(motion, i), len(motion.segments) == 1, f"motion.segments[{i}]")
        begin, span, level = np.deg2rad(before) * whole, np.deg2rad(part.span_deg) * whole, motion.start + height
        pieces += shape.pieces
        for piece, velocity_sign in zip(shape.pieces, shape.velocity_signs, strict=True):
            rows.append((i, begin + piece.start * span, span, level, shape.gain, velocity_sign))
    return pieces, rows


def _sums_before(values: list[float]) -> list[float]:
    """The sum of all values before each of them: what rounding takes is kept beside the sum."""
    sums, high, low = [], 0.0, 0.0
    for value in values:
        sums.append(high + low)
        high, lost = two_sum(high, value)
        low += lost
    return sums


@lru_cache(maxsize=32)
def program(motion: Motion) -> CompiledMotion:
    """The compiled motion. Raises DesignError where a law is unknown."""
    return CompiledMotion(motion)


def motion_at(compiled: CompiledMotion, q: Derivatives) -> Derivatives:
    """A motion that goes by an angle q (n,) [rad] which may be beyond a turn: its advance with each, and three derivatives by what
    q's are by, by the chain rule."""
    y = compiled.state(compiled.angles(q[0])).displacement
    gain = compiled.motion.gain * compiled.motion.scale

    def row(order: int) -> np.ndarray:
        if not order:
            return np.asarray(y[0] + gain * np.floor((q[0] + SNAP) / TURN) if gain else y[0])
        if order == 1:
            return y[1] * q[1]
        if order == 2:
            return np.asarray(y[2] * q[1] ** 2 + y[1] * q[2])
        return np.asarray(y[3] * q[1] ** 3 + 3.0 * y[2] * q[1] * q[2] + y[1] * q[3])

    return Derivatives(row)


@lru_cache(maxsize=32)
def largest_rate(motion: Motion) -> float:
    """The largest rate of a motion at whole degrees, in SI per radian."""
    compiled = program(motion)
    return float(np.abs(compiled.state(compiled.angles(np.deg2rad(degrees(360)))).displacement[1]).max())


_AT_REST = 1e-9  # of the largest velocity and acceleration: less is rest


@lru_cache(maxsize=32)
def connected_segments(motion: Motion, index: int) -> tuple[int, ...]:
    """The segments that go on into each other without rest, of which one is given, in the order of the turn: where they meet velocity
    or acceleration is another than 0, the same on both sides."""
    compiled, count = program(motion), len(motion.segments)
    largest = np.abs(compiled.state(compiled.angles(np.deg2rad(degrees(360)))).y).max(axis=1)
    at = compiled.state(compiled.angles(np.array([join.theta for join in compiled.joins]))).y
    moving = (np.abs(at[1:3]) > _AT_REST * largest[1:3, None]).any(axis=0)
    passed = [bool(moves) and not join.jumps[1:3].any() for moves, join in zip(moving, compiled.joins, strict=True)]
    first = last = index
    while passed[first - 1] and (first - 1) % count != index:
        first = (first - 1) % count
    while passed[last] and (last + 1) % count != first:
        last = (last + 1) % count
    return tuple((first + k) % count for k in range((last - first) % count + 1))


def degrees(samples: int) -> np.ndarray:
    """0 ... 360(N-1)/N in degrees (n,), each rounded once."""
    return 360.0 * np.arange(samples) / samples


_JUMPS = (
    ("jump-displacement", ERROR, 0),
    ("jump-velocity", ERROR, 1),
    ("jump-acceleration", WARNING, 2),
)


WHOLE = 1e-9  # turns, or parts of one, this near to a whole number are whole


def findings(compiled: CompiledMotion) -> list[Finding]:
    """Jumps of displacement, velocity and acceleration; for each join only the first that jumps is named. An advance of an angle after
    which what turns stands otherwise, and never at the same places again."""
    result = []
    unit, scale = compiled.motion.unit, compiled.motion.scale
    joins = compiled.joins
    for i, join in enumerate(joins):
        for code, severity, order in _JUMPS:
            if join.jumps[order]:
                values: dict[str, float | str] = {"jump": float(join.jump[order]) / scale, "unit_name": unit}
                field = f"motion.segments[{(i + 1) % len(joins)}]"
                result.append(Finding(code, severity, field, float(np.rad2deg(join.theta)), values))
                break
    parts = 360.0 / abs(compiled.motion.gain) if unit == "deg" and compiled.motion.gain else 1.0
    if min(abs(x - round(x)) for x in (parts, 1.0 / parts)) > WHOLE:
        parts_of = (max(round(parts), 1), max(round(1.0 / parts), 1))
        near = 360.0 * parts_of[1] / parts_of[0]
        values = {"advance": compiled.motion.gain, "near": float(np.copysign(near, compiled.motion.gain))}
        result.append(Finding("uneven-advance", NOTE, f"motion.advance_{unit}", None, values))
    return result


# -- the turn of a shaft on which several motions run, each by its own angle ------------------------------------


CLOSEST = 1e-11  # [rad] ends of pieces nearer than this are one


@frozen
class ShaftPosition:
    """Where a drive stands on the shaft: its own angle is sense·(machine angle - phase) [rad]; sense is -1 of a crank whose own
    angle, counted counter-clockwise, falls as the shaft turns."""

    phase: float = 0.0
    sense: float = 1.0

    def own(self, machine: np.ndarray) -> np.ndarray:
        """Own angles (n,), 0 ... 2π, of machine angles (n,) [rad]."""
        return np.asarray(np.mod(self.sense * (machine - self.phase), TURN))

    def machine(self, own: np.ndarray) -> np.ndarray:
        """Machine angles (n,), 0 ... 2π, of own angles (n,) [rad]."""
        return np.asarray(np.mod(self.phase + self.sense * own, TURN))


def piece_ends(cuts: Sequence[np.ndarray]) -> np.ndarray:
    """Ends of pieces over one turn (m + 1,), 0 and 2π among them, at all the cuts [rad]."""
    ends = distinct(np.concatenate((np.zeros(1), *cuts)))
    ends = ends[np.diff(ends, prepend=-1.0) > CLOSEST]
    return np.append(ends[ends < TURN - CLOSEST], TURN)


class MachineTurn:
    """Pieces of the machine's turn, in none of which a program (of a motion, or of a crank that turns fully) has a join.

    starts, ends  (m,) machine angles [rad]
    """

    def __init__(self, programs: Sequence[tuple[Any, ShaftPosition]]) -> None:
        self.programs = tuple(programs)
        ends = piece_ends([place.machine_angle(program.starts) for program, place in self.programs])
        self.starts, self.ends = ends[:-1], ends[1:]

    def angles(self, theta: np.ndarray) -> Angles:
        """Any machine angles (n,) [rad], each with the piece right of it."""
        theta = np.mod(np.asarray(theta, dtype=float), TURN)
        theta = np.where(theta >= TURN - CLOSEST, 0.0, theta)
        return Angles(theta, np.searchsorted(self.starts - CLOSEST, theta, side="right") - 1)

    def own(self, number: int, angles: Angles, cached: bool = False) -> Angles:
        """The angles of one program at machine angles, each on the same side of its joins."""
        program, place = self.programs[number]
        middle = (0.5 * (self.starts + self.ends))[angles.piece]
        inside = program.angles(place.drive_angle(middle))
        theta = inside.theta + place.rotation_sign * (angles.theta - middle)
        return Angles(np.clip(theta, program.starts[inside.piece], program.ends[inside.piece]), inside.piece, cached)


# -- A motion's turn, or a crank's, cut at further angles -------------------------------------------------------


class SubdividedTurn:
    """A program with more pieces: looks like the one that it is made of, whose joins it keeps.

    starts, ends  (m,) angles [rad] of its pieces
    """

    def __init__(self, program: Any, cuts: tuple[float, ...]) -> None:
        """cuts: angles [rad] in rising order; those at an end of a piece add nothing."""
        self._program = program
        at, starts, ends, of = np.array(cuts), [], [], []
        for i, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
            inside = at[(at > a + CLOSEST) & (at < b - CLOSEST)]
            edges = np.concatenate(([a], inside[np.diff(inside, prepend=a) > CLOSEST], [b]))
            starts.append(edges[:-1])
            ends.append(edges[1:])
            of.append(np.full(edges.size - 1, i))
        self.starts, self.ends, self._of = np.concatenate(starts), np.concatenate(ends), np.concatenate(of)
        middle = Angles(0.5 * (self.starts + self.ends), self._of)
        self._middle = np.array([middle.theta, program.state(middle).displacement[0]])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._program, name)

    @property
    def velocity_signs(self) -> np.ndarray:
        """Sign (m,) of the velocity on each piece: -1, 0 or 1."""
        return np.asarray(self._program.velocity_signs[self._of])

    @property
    def segment(self) -> np.ndarray:
        """(m,) the segment that each piece belongs to."""
        return np.asarray(self._program.segment[self._of])

    def angles(self, theta: np.ndarray, cached: bool = False) -> Angles:
        """Any angles (n,) [rad], each with the piece right of it."""
        inner = self._program.angles(theta)
        piece = np.searchsorted(self.starts - SNAP, inner.theta, side="right") - 1
        return Angles(inner.theta, np.clip(piece, 0, None), cached)

    def uncut(self, angles: Angles) -> Angles:
        """The same, with the pieces of the program that it is made of."""
        return Angles(angles.theta, self._of[angles.piece], unit=lambda: angles.unit)

    def state(self, angles: Angles) -> MotionState:
        """The motion at these angles."""
        state = self._program.state(self.uncut(angles))
        return MotionState(angles, state.displacement, state.velocity_sign, self._middle[:, angles.piece])
