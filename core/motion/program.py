"""The compiled motion: displacement of the output and its three exact derivatives at any cam angle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from math import pi
from typing import Any

import numpy as np

from core.design import Motion
from core.design.curves import segment_shape, with_joined_ends
from core.findings import ERROR, NOTE, WARNING, Finding
from core.frozen import frozen
from core.laws import Piece, PieceTable
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
    """Cam angles, each with the piece of the motion to which it belongs.

    Attributes
    ----------
    theta : ndarray (n,) [rad]
        Cam angle, 0 ... 2π; a function that returns it is called on first use.
    piece : ndarray (n,), dimensionless
        Row of ``CompiledMotion``; at a join it selects the left or the right limit.
    cached : bool
        Whether results at these angles may be stored.
    search : bool
        Whether extremes are searched between these angles; such results are stored under a name of their own.
    unit : ndarray (n,) complex, dimensionless
        e^{iθ}, computed on first use.
    """

    theta: Lazy[np.ndarray] = Lazy()
    piece: np.ndarray  # type: ignore[misc]  # ``theta`` has no default, though mypy takes ``Lazy()`` for one
    cached: bool = False
    search: bool = False
    unit: Lazy[np.ndarray] = Lazy(lambda angles: unit(angles.theta))

    @property
    def count(self) -> int:
        """Number n of the angles; with many designs, shape (m, n), that of each."""
        return self.piece.shape[-1]


@frozen(eq=False)
class Join:
    """Join of two segments.

    Attributes
    ----------
    theta : float [rad]
        Cam angle.
    jump : ndarray (4,) [m or rad, per radian^k]
        Jumps of displacement, velocity, acceleration and jerk.
    jumps : ndarray (4,), dimensionless
        Whether each jump exceeds rounding.
    """

    theta: float
    jump: np.ndarray
    jumps: np.ndarray


@frozen(eq=False)
class MotionState:
    """Displacement of the output and its derivatives at given cam angles.

    Attributes
    ----------
    angles : Angles
        The n cam angles.
    displacement : Derivatives
        Displacement y (n,) [m or rad] and its three derivatives by cam angle.
    velocity_sign : ndarray (n,), dimensionless
        Sign of the velocity that the segment states: 0 in a dwell, unaffected by rounding.
    within : ndarray (2, n) [rad], [m or rad]
        Cam angle and displacement in the middle of the piece of each angle, where the turn is subdivided at switching
        angles; else those of the angle itself.
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

    @property
    def count(self) -> int:
        """Number n of the angles."""
        return self.angles.count


class CompiledMotion:
    """A motion compiled to one table of m pieces.

    Attributes
    ----------
    starts, ends : ndarray (m,) [rad]
        Cam angles at which each piece starts and ends.
    segment : ndarray (m,), dimensionless
        Index of the segment to which each piece belongs.
    velocity_signs : ndarray (m,), dimensionless
        Sign of the velocity on each piece: -1, 0 or 1.
    """

    _copies = 1  # how many motions share the pieces of the table

    def __init__(self, motion: Motion) -> None:
        pieces, rows = _table_rows(motion)
        self._table = PieceTable(pieces)
        self._set(motion, np.array(rows).T)
        self._gains = np.array([motion.gain * motion.scale])

    def _set(self, motion: Motion, rows: np.ndarray) -> None:
        """Compute the arrays from rows (6, m), or from rows (6, k, m) of k motions."""
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
        """Compile many motions whose spans and rises are columns (count,) and whose curves have the same pieces."""
        pieces, rows = _table_rows(motion)
        compiled = cls.__new__(cls)
        compiled._table, compiled._copies = PieceTable(pieces), count
        columns = np.empty((len(rows[0]), count, len(rows)))
        for piece, row in enumerate(rows):
            for k, value in enumerate(row):
                columns[k, :, piece] = value
        compiled._set(motion, columns)
        compiled._gains = np.broadcast_to(motion.gain * motion.scale, count)
        return compiled

    @classmethod
    def stacked(cls, motions: Sequence[CompiledMotion]) -> CompiledMotion:
        """Concatenate compiled motions with equally many pieces.

        The result supports ``state`` at angles with known pieces, and ``jumps``.
        """
        result = cls.__new__(cls)
        result.motion = motions[0].motion  # for its unit, which all share
        for name in ("_gains", "starts", "ends", "segment", "_span", "_gain", "_base", "velocity_signs"):
            setattr(result, name, np.concatenate([getattr(motion, name) for motion in motions], axis=-1))
        result._table = PieceTable.stacked([motion._table for motion in motions])
        return result

    def angles(self, theta: np.ndarray, cached: bool = False) -> Angles:
        """Cam angles with their pieces; at a join the piece to the right.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Any cam angles; they are reduced to 0 ... 2π.
        cached : bool
            Whether results at these angles may be stored.

        Returns
        -------
        Angles
        """
        theta = np.asarray(theta, dtype=float)
        if theta.size and (theta.min() < 0.0 or theta.max() >= TURN - SNAP):
            theta = np.mod(theta, TURN)
            theta = np.where(theta >= TURN - SNAP, 0.0, theta)  # the end of the turn is the first join
        piece = np.searchsorted(self.starts - SNAP, theta, side="right") - 1
        return Angles(theta, piece, cached)

    def uncut(self, angles: Angles) -> Angles:
        """The same angles with the pieces of the motion itself."""
        return angles

    def state(self, angles: Angles) -> MotionState:
        """Motion at given cam angles, with exact derivatives."""
        return self.state_from_curve(self.curve(angles), angles)

    def curve(self, angles: Angles) -> Callable[[int], np.ndarray]:
        """Values of the pieces' curves s(u), u = 0 ... 1, at given cam angles.

        Parameters
        ----------
        angles : Angles
            The n cam angles.

        Returns
        -------
        Callable[[int], ndarray (n,), dimensionless]
            Derivative of the given order by u.
        """
        piece = angles.piece
        row = piece if self._copies == 1 else piece % self._table.starts.size
        return self._table.rows(row, (angles.theta - self.starts[piece]) / self._span[piece])

    def state_from_curve(
        self,
        curve: Callable[[int], np.ndarray],
        angles: Angles,
        at_angles: Callable[[np.ndarray], np.ndarray] | None = None,
    ) -> MotionState:
        """Motion at given cam angles from the values of the pieces' curves there.

        Parameters
        ----------
        curve : Callable[[int], ndarray (n,), dimensionless]
            Derivative of the given order of s(u) by u.
        angles : Angles
            The n cam angles.
        at_angles : Callable[[ndarray (m,)], ndarray (n,)], optional
            Selects, from one value per piece, the value at each angle (dimensionless); default: by ``angles.piece``.

        Returns
        -------
        MotionState
        """
        select = at_angles or (lambda row: row[angles.piece])

        def row(order: int) -> np.ndarray:
            y = np.multiply(curve(order), select(self._gain[order]))
            if not order:
                y += select(self._base)
            return y

        return MotionState(angles, Derivatives(row), select(self.velocity_signs))

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients (k, m) [SI] of each piece's polynomial in the cam angle from its start, without ``sines``."""
        polynomial = self._table.derivatives[0]
        rows = self._gain[0] * polynomial / self._span ** np.arange(polynomial.shape[0])[:, None]
        rows[0] += self._base
        return np.asarray(rows)

    @cached_property
    def sines(self) -> np.ndarray:
        """Amplitude [SI], frequency [1/rad], phase [rad] (3, j, m) of each piece's sines, from its start."""
        amplitude, frequency, phase = self._table.sines
        return np.array([self._gain[0] * amplitude, frequency / self._span, phase])

    @cached_property
    def joins(self) -> tuple[Join, ...]:
        """Joins of the segments in order of cam angle, the join at 360 -> 0 last."""
        first, jump, jumps = self.jumps()
        theta = np.append(self.starts[first][1:], 0.0)
        return tuple(Join(float(theta[i]), jump[:, i], jumps[:, i]) for i in range(first.size))

    @cached_property
    def position_range(self) -> tuple[float, float]:
        """Lowest and highest position [m or rad], which are at ends of pieces, since the motion turns nowhere between."""
        pieces = np.arange(self.starts.size)
        ends = [self.state(Angles(theta, pieces)).displacement[0] for theta in (self.starts, self.ends)]
        return float(np.min(ends)), float(np.max(ends))

    @cached_property
    def is_rest_to_rest(self) -> bool:
        """Whether every segment starts and ends with velocity 0, without a jump of displacement."""
        begin, end = (
            self.state(Angles(ends, np.arange(ends.size))).displacement[1] for ends in (self.starts, self.ends)
        )
        first, last = (np.diff(self.segment, **outside) != 0 for outside in ({"prepend": -1}, {"append": -1}))
        bound = JUMP_BOUND * EPS * np.abs(self._gain[1]) * self._table.sizes()[1]
        moves = (first & (np.abs(begin) > bound)) | (last & (np.abs(end) > bound))
        return not moves.any() and not any(join.jumps[0] for join in self.joins)

    def jumps(self, turns: int = 1, orders: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Jumps of s, v, a, j at the end of every segment.

        Parameters
        ----------
        turns : int
            Number of stacked motions; their joins follow one another.
        orders : int
            Number of derivatives, displacement included.

        Returns
        -------
        first : ndarray (k,), dimensionless
            Piece with which each of the k segments starts.
        jump : ndarray (orders, k) [m or rad, per radian^order]
            Right limit minus left limit; at the end of the turn the advance is subtracted.
        jumps : ndarray (orders, k), dimensionless
            Whether each jump exceeds rounding.
        """
        segment = self.segment.reshape(turns, -1)
        edge, differs = np.ones((turns, 1), dtype=bool), segment[:, 1:] != segment[:, :-1]
        first, last = (np.concatenate(row, axis=1).ravel().nonzero()[0] for row in ((edge, differs), (differs, edge)))

        def at_next(rows: np.ndarray) -> np.ndarray:
            of_turns = rows.reshape(*rows.shape[:-1], turns, -1)
            return np.concatenate((of_turns[..., 1:], of_turns[..., :1]), axis=-1).reshape(rows.shape)

        pieces, ends = np.array([first, last]), np.array([self.starts[first], self.ends[last]])
        first_motion = slice(first.size // self._copies)  # the motions share their curves
        curve = self.curve(Angles(ends[:, first_motion].ravel(), pieces[:, first_motion].ravel()))

        def of_motions(order: int) -> np.ndarray:
            row = curve(order)
            return row if self._copies == 1 else np.tile(row.reshape(2, -1), self._copies).ravel()

        displacement = self.state_from_curve(of_motions, Angles(ends.ravel(), pieces.ravel())).displacement
        begin, end = np.array([displacement[order] for order in range(orders)]).reshape(orders, 2, -1).swapaxes(0, 1)
        jump = at_next(begin) - end
        jump[0].reshape(turns, -1)[:, -1] += self._gains  # the advance of the next turn
        # rounding at the ends of a segment is relative to its largest s, v, a, j
        size = (np.abs(self._gain[:orders]) * np.tile(self._table.sizes()[:orders], self._copies))[:, last]
        size[0] += np.abs(self._base[last])
        bound = JUMP_BOUND * EPS * np.maximum(size, at_next(size))
        bound *= 1.0 + TURN / np.minimum(self._span[last], at_next(self._span[last]))
        bound[0] += 1e-9 * self.motion.scale  # tolerance of the sum of rises
        return first, jump, np.abs(jump) > bound


def _table_rows(motion: Motion) -> tuple[list[Piece], list[tuple[Any, ...]]]:
    """Pieces of all segments, and the row of each: segment, start and span [rad], level, gain, sign of the velocity."""
    pieces: list[Piece] = []
    rows = []
    spans = [s.span_deg for s in motion.segments]
    # the spans may miss 360° by 1e-9; all segments share the difference, so that the last one ends at 360°
    *sums, turn = _sums_before([*spans, 0.0])
    to_turn = 360.0 / turn
    heights = _sums_before([s.rise for s in motion.segments])
    for i, (segment, start_deg, height) in enumerate(zip(motion.segments, sums, heights, strict=True)):
        shape = segment_shape(with_joined_ends(motion, i), len(motion.segments) == 1, f"motion.segments[{i}]")
        begin, span, level = (
            np.deg2rad(start_deg) * to_turn,
            np.deg2rad(segment.span_deg) * to_turn,
            motion.first + height,
        )
        pieces += shape.pieces
        for piece, velocity_sign in zip(shape.pieces, shape.velocity_signs, strict=True):
            rows.append((i, begin + piece.start * span, span, level, shape.gain, velocity_sign))
    return pieces, rows


def _sums_before(values: list[float]) -> list[float]:
    """Compensated sum of all values before each value."""
    sums, high, low = [], 0.0, 0.0
    for value in values:
        sums.append(high + low)
        high, error = two_sum(high, value)
        low += error
    return sums


@lru_cache(maxsize=32)
def program(motion: Motion) -> CompiledMotion:
    """Compile a motion. Raises DesignError where a law is unknown."""
    return CompiledMotion(motion)


def motion_at(compiled: CompiledMotion, q: Derivatives) -> Derivatives:
    """Motion driven by an angle q, with three derivatives by the variable of q (chain rule).

    The angle may exceed a turn; each full turn adds the advance.

    Parameters
    ----------
    compiled : CompiledMotion
    q : Derivatives
        Driving angle (n,) [rad] and its derivatives.

    Returns
    -------
    Derivatives
        Displacement (n,) [m or rad] and its derivatives.
    """
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
    """Largest magnitude of the velocity at whole degrees [m or rad, per radian]."""
    compiled = program(motion)
    return float(np.abs(compiled.state(compiled.angles(np.deg2rad(degrees(360)))).displacement[1]).max())


_AT_REST = 1e-9  # fraction of the largest velocity and acceleration, below which the motion is at rest


@lru_cache(maxsize=32)
def connected_segments(motion: Motion, index: int) -> tuple[int, ...]:
    """Indices of the segments around a given one that join without rest, in the order of the turn.

    Two segments are connected where velocity or acceleration at their join is not 0 and is continuous.
    """
    compiled, count = program(motion), len(motion.segments)
    largest = np.abs(compiled.state(compiled.angles(np.deg2rad(degrees(360)))).y).max(axis=1)
    state = compiled.state(compiled.angles(np.array([join.theta for join in compiled.joins]))).y
    is_moving_at = (np.abs(state[1:3]) > _AT_REST * largest[1:3, None]).any(axis=0)
    connected = [
        bool(is_moving) and not join.jumps[1:3].any()
        for is_moving, join in zip(is_moving_at, compiled.joins, strict=True)
    ]
    first = last = index
    while connected[first - 1] and (first - 1) % count != index:
        first = (first - 1) % count
    while connected[last] and (last + 1) % count != first:
        last = (last + 1) % count
    return tuple((first + k) % count for k in range((last - first) % count + 1))


def degrees(samples: int) -> np.ndarray:
    """Equally spaced cam angles over one turn, 360 i/N, each rounded once.

    Parameters
    ----------
    samples : int
        Number N of angles.

    Returns
    -------
    ndarray (N,) [deg]
    """
    return 360.0 * np.arange(samples) / samples


_JUMPS = (
    ("jump-displacement", ERROR, 0),
    ("jump-velocity", ERROR, 1),
    ("jump-acceleration", WARNING, 2),
)


INTEGER_TOLERANCE = 1e-9
"""A number of stops per turn, or of turns per stop, this close to an integer is one."""


def findings(compiled: CompiledMotion) -> list[Finding]:
    """Findings on a motion: jumps at its joins, and an advance that is no integer fraction or multiple of a turn.

    Of each join only the lowest order that jumps is reported.
    """
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
    if min(abs(x - round(x)) for x in (parts, 1.0 / parts)) > INTEGER_TOLERANCE:
        ratio = (max(round(parts), 1), max(round(1.0 / parts), 1))
        near = 360.0 * ratio[1] / ratio[0]
        values = {"advance": compiled.motion.gain, "near": float(np.copysign(near, compiled.motion.gain))}
        result.append(Finding("uneven-advance", NOTE, f"motion.advance_{unit}", None, values))
    return result


# -- turn of a shaft with several drives ------------------------------------------------------------------------


CLOSEST = 1e-11  # [rad] ends of pieces that are closer coincide


@frozen
class ShaftPosition:
    """Position of a drive on the shaft: drive angle = rotation_sign·(machine angle - phase).

    Attributes
    ----------
    phase : float [rad]
        Machine angle at drive angle 0.
    rotation_sign : float
        -1 for a crank whose angle, counted counter-clockwise, decreases as the shaft turns; else 1.
    """

    phase: float = 0.0
    rotation_sign: float = 1.0

    def drive_angle(self, machine: np.ndarray) -> np.ndarray:
        """Drive angles, 0 ... 2π.

        Parameters
        ----------
        machine : ndarray (n,) [rad]
            Machine angles.

        Returns
        -------
        ndarray (n,) [rad]
        """
        return np.asarray(np.mod(self.rotation_sign * (machine - self.phase), TURN))

    def machine_angle(self, drive: np.ndarray) -> np.ndarray:
        """Machine angles, 0 ... 2π.

        Parameters
        ----------
        drive : ndarray (n,) [rad]
            Drive angles.

        Returns
        -------
        ndarray (n,) [rad]
        """
        return np.asarray(np.mod(self.phase + self.rotation_sign * drive, TURN))


def piece_ends(cuts: Sequence[np.ndarray]) -> np.ndarray:
    """Ends of the pieces of a turn that is divided at all given angles, 0 and 2π included.

    Parameters
    ----------
    cuts : sequence of ndarray (k,) [rad]
        Dividing angles.

    Returns
    -------
    ndarray (m + 1,) [rad]
    """
    ends = distinct(np.concatenate((np.zeros(1), *cuts)))
    ends = ends[np.diff(ends, prepend=-1.0) > CLOSEST]
    return np.append(ends[ends < TURN - CLOSEST], TURN)


class MachineTurn:
    """Pieces of the machine's turn: no drive has a join inside a piece.

    Attributes
    ----------
    starts, ends : ndarray (m,) [rad]
        Machine angles.
    """

    def __init__(self, drives: Sequence[tuple[Any, ShaftPosition]]) -> None:
        self.drives = tuple(drives)
        ends = piece_ends([position.machine_angle(drive.starts) for drive, position in self.drives])
        self.starts, self.ends = ends[:-1], ends[1:]

    def angles(self, theta: np.ndarray) -> Angles:
        """Machine angles with their pieces; at a join the piece to the right.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Any machine angles.

        Returns
        -------
        Angles
        """
        theta = np.mod(np.asarray(theta, dtype=float), TURN)
        theta = np.where(theta >= TURN - CLOSEST, 0.0, theta)
        return Angles(theta, np.searchsorted(self.starts - CLOSEST, theta, side="right") - 1)

    def drive_angles(self, number: int, angles: Angles, cached: bool = False) -> Angles:
        """Angles of one drive at machine angles, on the same side of its joins."""
        drive, position = self.drives[number]
        middle = (0.5 * (self.starts + self.ends))[angles.piece]
        inside = drive.angles(position.drive_angle(middle))
        theta = inside.theta + position.rotation_sign * (angles.theta - middle)
        return Angles(np.clip(theta, drive.starts[inside.piece], drive.ends[inside.piece]), inside.piece, cached)


# -- turn of a motion or a crank, subdivided at further angles --------------------------------------------------


class SubdividedTurn:
    """A compiled motion or crank with further pieces; joins and all else are those of the original.

    Attributes
    ----------
    starts, ends : ndarray (m,) [rad]
        Angles at which each piece starts and ends.
    """

    def __init__(self, original: Any, cuts: tuple[float, ...]) -> None:
        """Subdivide at angles [rad] in ascending order; angles at an end of a piece are ignored."""
        self._original = original
        angles, starts, ends, owner = np.array(cuts), [], [], []
        for i, (a, b) in enumerate(zip(original.starts.tolist(), original.ends.tolist(), strict=True)):
            inside = angles[(angles > a + CLOSEST) & (angles < b - CLOSEST)]
            edges = np.concatenate(([a], inside[np.diff(inside, prepend=a) > CLOSEST], [b]))
            starts.append(edges[:-1])
            ends.append(edges[1:])
            owner.append(np.full(edges.size - 1, i))
        self.starts, self.ends, self._owner = np.concatenate(starts), np.concatenate(ends), np.concatenate(owner)
        middle = Angles(0.5 * (self.starts + self.ends), self._owner)
        self._middle = np.array([middle.theta, original.state(middle).displacement[0]])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._original, name)

    @property
    def velocity_signs(self) -> np.ndarray:
        """Sign (m,) of the velocity on each piece: -1, 0 or 1."""
        return np.asarray(self._original.velocity_signs[self._owner])

    @property
    def segment(self) -> np.ndarray:
        """Segment (m,) to which each piece belongs."""
        return np.asarray(self._original.segment[self._owner])

    def angles(self, theta: np.ndarray, cached: bool = False) -> Angles:
        """Angles with their pieces; at a join the piece to the right.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Any angles.
        cached : bool
            Whether results at these angles may be stored.

        Returns
        -------
        Angles
        """
        inner = self._original.angles(theta)
        piece = np.searchsorted(self.starts - SNAP, inner.theta, side="right") - 1
        return Angles(inner.theta, np.clip(piece, 0, None), cached)

    def uncut(self, angles: Angles) -> Angles:
        """The same angles with the pieces of the original."""
        return Angles(angles.theta, self._owner[angles.piece], unit=lambda: angles.unit)

    def state(self, angles: Angles) -> MotionState:
        """Motion at given angles."""
        state = self._original.state(self.uncut(angles))
        return MotionState(angles, state.displacement, state.velocity_sign, self._middle[:, angles.piece])
