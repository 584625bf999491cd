"""The motion of a controller's slave axis over the angle of its master, exactly; and the request for its table."""

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
from core.motion import Angles, CompiledMotion, program
from core.output.channels import channels
from core.output.controllers.rows import INTERPOLATIONS, MOST_ROWS
from core.project import number_of
from core.requests import option, text_option
from core.study import Study

# -- slave axis -------------------------------------------------------------------------------------------------


TURN = 360.0
CERTAIN = 11  # reliable decimals of an angle [deg]
NEAR = 1e-8  # [deg] a row nearer to an edge counts as on it
JUMP = 1e-9  # relative to the largest value over the turn: less is rounding
MOTION = "motion"

Derivatives = Callable[[Angles], Callable[[int], np.ndarray]]


@frozen
class Alignment:
    """Relation between the master's angle x and the drive's angle: θ = ±(x - shift_deg)."""

    shift_deg: float = 0.0
    reverse: bool = False


ALIGNED = Alignment()


class Slave:
    """A piecewise smooth function of the master's angle over one turn.

    Attributes
    ----------
    edges : (m + 1,) master angles between which it is smooth, 0 to 360 [deg]
    joins : (m + 1,) whether an edge is an end of a segment or a jump of value, velocity or acceleration
    jumps : (3, m) jumps of value, velocity and acceleration at the start of each piece [unit, per degree]
    values : (3, k) value, velocity and acceleration at samples of all pieces [unit, per degree]
    unit : mm or deg
    advance : increase of the value in a turn of the master [unit]
    """

    def __init__(
        self,
        rows: Derivatives,
        starts: np.ndarray,
        joins: np.ndarray,
        unit: str,
        scale: float,
        alignment: Alignment,
        advance: float | None = None,
    ) -> None:
        """Build the function from the motion of a drive.

        Parameters
        ----------
        rows : Derivatives
            Angles of the drive -> order of the derivative by that angle [rad] -> values (n,) [SI].
        starts : ndarray (k,) [rad]
            Starts of the pieces, the first at 0.
        joins : ndarray (j,) [rad]
            Joins of the segments.
        unit : str
        scale : float
            SI units of the unit.
        alignment : Alignment
        advance : float, optional
            Increase in a turn of the drive, where known [unit].
        """
        self.unit, self._rows, self._starts = unit, rows, starts
        self._sign, self._shift = (-1.0 if alignment.reverse else 1.0), alignment.shift_deg
        self._factor = np.array([(self._sign * np.pi / 180.0) ** k / scale for k in range(3)])
        drive_angles = np.rad2deg(starts)
        edges = np.mod(np.round(self._shift + self._sign * drive_angles, CERTAIN), TURN)
        self.edges = np.array(sorted({0.0, TURN, *edges.tolist()}))
        middle = self._sign * (0.5 * (self.edges[:-1] + self.edges[1:]) - self._shift)
        self._turns = np.floor(middle / TURN)
        self._piece = np.searchsorted(drive_angles, middle - TURN * self._turns, side="right") - 1
        self._ends = np.append(starts[1:], 2.0 * np.pi)
        gain = advance or 0.0
        if unit == "deg" and advance is None:  # an angle that rotates continuously
            last = starts.size - 1
            first = float(rows(Angles(np.zeros(1), np.zeros(1, dtype=int)))(0)[0])
            end = float(rows(Angles(np.array([2.0 * np.pi]), np.array([last])))(0)[0])
            gain = TURN * round((end - first) / (2.0 * np.pi))
        self._gained, self.advance = gain * self._turns, self._sign * gain
        self.values = self._sampled()
        join_angles = set(np.mod(np.round(self._shift + self._sign * np.rad2deg(joins), CERTAIN), TURN).tolist())
        size = np.maximum(np.abs(self.values).max(axis=1), 1e-300)
        left, right = self.end_states(1), self.end_states(0)
        before = np.roll(left, 1, axis=1)
        before[0, 0] -= self.advance
        self.jumps = right - before
        self.jumps[np.abs(self.jumps) <= JUMP * size[:, None]] = 0.0
        is_join = [angle in join_angles for angle in self.edges[:-1].tolist()]
        self.joins = np.array([*(np.array(is_join) | self.jumps.any(axis=0)), True])
        self.joins[0] = True

    def state(self, x: np.ndarray, piece: np.ndarray, orders: int = 3) -> np.ndarray:
        """Value, velocity and acceleration at given angles, in given pieces.

        Parameters
        ----------
        x : ndarray (n,) [deg]
            Master angles.
        piece : ndarray (n,), dimensionless
            Piece of each angle.
        orders : int
            Number of derivatives, the value included.

        Returns
        -------
        ndarray (orders, n) [unit, per degree]
        """
        drive_angles = self._sign * (x - self._shift) - TURN * self._turns[piece]
        rows = self._rows(Angles(np.deg2rad(drive_angles), self._piece[piece]))
        states = np.array([np.broadcast_to(rows(k), x.shape) * self._factor[k] for k in range(orders)])
        if self.advance:
            states[0] += self._gained[piece]
        return states

    def piece_of(self, x: np.ndarray) -> np.ndarray:
        """Piece on the right of given angles; at the end of the turn the last one.

        Parameters
        ----------
        x : ndarray (n,) [deg]

        Returns
        -------
        ndarray (n,), dimensionless
        """
        return np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, self.edges.size - 2)

    def end_states(self, end: int) -> np.ndarray:
        """Value, velocity and acceleration at the start (end=0) or the end (end=1) of each piece.

        Returns
        -------
        ndarray (3, m) [unit, per degree]
        """
        pieces = np.arange(self.edges.size - 1)
        return self.state(self.edges[pieces + end], pieces)

    def adjacent_pieces(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pieces on the left and on the right of given angles; at the ends of the turn the piece within it.

        Parameters
        ----------
        x : ndarray (n,) [deg]

        Returns
        -------
        left, right : ndarray (n,), dimensionless
        """
        edge = np.clip(np.searchsorted(self.edges, x - NEAR), 0, self.edges.size - 1)
        on_edge = np.abs(self.edges[edge] - x) <= NEAR
        last = self.edges.size - 2
        right = np.where(on_edge, np.minimum(edge, last), np.clip(edge - 1, 0, last))
        left = np.where(on_edge, np.maximum(edge - 1, 0), right)
        return left, right

    def side_states(self, x: np.ndarray, orders: int = 3) -> tuple[np.ndarray, np.ndarray]:
        """Value, velocity and acceleration on the left and on the right of given angles; at the ends of the turn within it.

        Parameters
        ----------
        x : ndarray (n,) [deg]
        orders : int
            Number of derivatives, the value included.

        Returns
        -------
        left, right : ndarray (orders, n) [unit, per degree]
        """
        left_piece, right_piece = self.adjacent_pieces(x)
        right = self.state(x, right_piece, orders)
        left, is_edge = right, left_piece != right_piece
        if is_edge.any():
            left = right.copy()
            left[:, is_edge] = self.state(x[is_edge], left_piece[is_edge], orders)
        return left, right

    @property
    def size(self) -> float:
        """Largest absolute value [unit]."""
        return float(np.abs(self.values[0]).max())

    def _sampled(self) -> np.ndarray:
        """Value, velocity and acceleration (3, k) at samples of all pieces."""
        part, pieces = np.linspace(0.0, 1.0, 33), np.arange(self.edges.size - 1)
        x = self.edges[:-1, None] + np.diff(self.edges)[:, None] * part
        return self.state(x.ravel(), np.repeat(pieces, part.size))


# -- possible slaves ---------------------------------------------------------------------------------------


def _coordinate(name: str, study: Study, order: int) -> np.ndarray:
    return np.asarray(study.linkage.coordinates[name][order])


def _point_part(point: str, part: str, study: Study, order: int) -> np.ndarray:
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    return np.asarray(getattr(pose.position(point, order), part))


_COORDINATES = {"slider_position": "slider_position", "phi": "phi", "beta": "beta"}


def positions(design: Design) -> Mapping[str, Callable[[Study, int], np.ndarray]]:
    """Functions of all positions in a design.

    Returns
    -------
    dict of str to function
        Column -> function of a study and the order of the derivative by the drive's angle, which gives
        ndarray (n,) [m or rad, per rad].
    """
    result: dict[str, Callable[[Study, int], np.ndarray]] = {}
    for row in channels(design, ("motion", "linkage")):
        sort, _, member = row.name.partition(".")
        if row.name == "displacement":
            result[row.slug] = lambda study, order: study.motion.displacement[order]
        elif row.name in _COORDINATES:
            result[row.slug] = partial(_coordinate, _COORDINATES[row.name])
        elif sort in ("link", "slide") and not member.endswith(("_velocity", "_acceleration")):
            result[row.slug] = partial(_coordinate, f"{sort}{member}")
        elif sort == "point" and member.endswith(("_x", "_y")):
            result[row.slug] = partial(_point_part, member[:-2], "real" if member.endswith("_x") else "imag")
    return result


def slave_axis(study: Study, of: str = MOTION, alignment: Alignment = ALIGNED, segment: int | None = None) -> Slave:
    """The motion, one of its segments stretched to the turn, or a position of the linkage by the name of its column.

    Raises KindynaError where the design has no such position or segment, NoSolution where the linkage has no position.
    """
    design = study.design
    available = positions(design)
    if of == MOTION and "motion" in study.stages:
        compiled = program(design.drive.motion)
        unit, scale = compiled.motion.unit, compiled.motion.scale

        def motion(angles: Angles) -> Callable[[int], np.ndarray]:
            return compiled.state(angles).displacement.__getitem__

        if segment is not None:
            return _segment(compiled, segment, motion, alignment.reverse)
        return Slave(motion, compiled.starts, _joins(compiled), unit, scale, alignment, compiled.motion.gain)
    if segment is not None:
        raise KindynaError(f"--segment {segment}: {of} has no segments; allowed: --of motion")
    if of not in available:
        names = ([MOTION] if "motion" in study.stages else []) + list(available)
        raise KindynaError(f"--of {of}: this design has no position of that name; allowed: {' | '.join(names)}")
    if study.turn_ranges:
        raise KindynaError("--of: the crank of this design does not turn fully; allowed: one that does")
    value, driven = available[of], study.uncut
    unit = "deg" if of.endswith("_deg") else "mm"
    scale = np.pi / 180.0 if unit == "deg" else 1e-3

    def channel(angles: Angles) -> Callable[[int], np.ndarray]:
        at = study.at(angles)
        return lambda order: value(at, order)

    return Slave(channel, driven.starts, _joins(driven), unit, scale, alignment)


def _segment(compiled: CompiledMotion, number: int, motion: Derivatives, reverse: bool) -> Slave:
    segments = compiled.motion.segments
    if not 1 <= number <= len(segments):
        raise KindynaError(f"--segment {number}: no such segment; allowed: 1 ... {len(segments)}")
    pieces = np.flatnonzero(compiled.segment == number - 1)
    start = compiled.starts[pieces[0]]
    part = (compiled.ends[pieces[-1]] - start) / np.deg2rad(TURN)

    def stretched(angles: Angles) -> Callable[[int], np.ndarray]:
        rows = motion(Angles(start + angles.theta * part, angles.piece + pieces[0]))
        return lambda order: rows(order) * part**order

    starts = (compiled.starts[pieces] - start) / part
    unit, scale, rise = compiled.motion.unit, compiled.motion.scale, segments[number - 1].rise
    return Slave(stretched, starts, starts[:1], unit, scale, Alignment(0.0, reverse), rise)


def _joins(compiled: Any) -> np.ndarray:
    return np.array([join.theta for join in compiled.joins])


# -- request ----------------------------------------------------------------------------------------------------


PLACED, EQUAL = "placed", "equal"
PER_TURN = {"deg": TURN, "rad": 2.0 * math.pi, "counts": None, "mm": None}
"""Unit of the master -> units in a turn; None: given by the user."""
DEFAULT_ERROR = 1e-3


@frozen
class EcamRequest:
    """A table for a controller, which is requested separately."""

    interpolation: str | None = option(
        choice(
            "Between the rows", INTERPOLATIONS, default=None, help="interpolation of the controller between two rows"
        ),
        default_text="the controller's default",
        metavar="NAME",
    )
    placing: str | None = option(
        choice("Position of rows", (PLACED, EQUAL), default=None, help="positions of the rows over the turn"),
        "--as",
        default_text="placed, where the controller allows it",
        words={PLACED: "Placed for the least error", EQUAL: "At equal steps"},
    )
    error: float | None = option(
        number("Largest error", 0.0, open_low=True, default=None, help="of the position, in the motion's unit"),
        default_text="0.001",
        metavar="MM",
        one_of=("Number of rows", "The fewest that keep an error"),
    )
    points: int | None = option(
        whole("Rows", 2, MOST_ROWS, default=None, help="number of rows, with the least error"),
        one_of=("Number of rows", "A given number"),
    )
    velocity_error: float | None = option(
        number("Velocity error", 0.0, open_low=True, default=None, help="largest error of the velocity, per degree of the master"),
        default_text="any", metavar="X",
    )  # fmt: skip
    acceleration_error: float | None = option(
        number("Acceleration error", 0.0, open_low=True, default=None, help="largest error of the acceleration, per degree²"),
        default_text="any", metavar="X",
    )  # fmt: skip
    master: str = choice("Master counts in", tuple(PER_TURN), default="deg", help="unit of the master")
    master_per_turn: float | None = option(
        number("Master, per turn", 0.0, open_low=True, default=None, help="units of the master in a turn"),
        default_text="360 deg, 2π rad", metavar="X",
    )  # fmt: skip
    slave_scale: float = option(
        number("Slave's scale", default=1.0, help="the file holds scale times the position, plus the offset"),
        metavar="A",
    )
    slave_offset: float = option(number("Slave's offset", default=0.0, help="in the file's unit"), metavar="B")
    reverse: bool = flag("Run backwards", help="the motion at minus the master's angle")
    shift_deg: float = option(
        number("Shift", -3600.0, 3600.0, default=0.0, help="the motion begins later by this number of degrees"),
        "--shift",
        metavar="DEG",
    )
    segment: int | None = option(
        whole("Segment", 1, 10**6, default=None, help="this segment alone, counted from 1, where a file is one segment"),
        default_text="the full turn", metavar="N",
    )  # fmt: skip
    of: str = text_option(
        "motion of the slave: motion, or the column of a position, such as link4_deg", default=MOTION, metavar="CHANNEL"
    )
    cycle_ms: float | None = option(
        number("Cycle", 0.0, 1e4, open_low=True, default=None,
               help="cycle time of the controller, for the steps of the acceleration at the design's speed"),
        "--cycle", default_text="not computed", metavar="MS",
    )  # fmt: skip

    @property
    def per_turn(self) -> float:
        """Units of the master in a turn. Raises KindynaError where they are not given."""
        units = self.master_per_turn or PER_TURN[self.master]
        if units is None:
            raise KindynaError(f"--master {self.master}: needs --master-per-turn, the {self.master} in a turn")
        return units

    @property
    def limits(self) -> tuple[float, float, float]:
        """Limits of the errors of position, velocity and acceleration; inf without a limit. Raises KindynaError."""
        limits = self.error, self.velocity_error, self.acceleration_error
        if self.points is not None and any(limit is not None for limit in limits):
            raise KindynaError("--points: cannot be combined with errors; allowed: --points, or errors")
        if all(limit is None for limit in limits) and self.points is None:
            limits = DEFAULT_ERROR, None, None
        return tuple(math.inf if limit is None else limit for limit in limits)  # type: ignore[return-value]

    def require(self) -> None:
        """Raises KindynaError for a scale of zero."""
        if self.slave_scale == 0.0:
            raise KindynaError("--slave-scale 0: all rows would be equal; allowed: any other number")


# -- slave of a design ------------------------------------------------------------------------------------------


def drive_slave(design: Design, drive: str, request: EcamRequest) -> tuple[Slave, str, float]:
    """Slave of a drive, the name of its table, and the speed of its master [rpm].

    On a shaft with several drives the shaft is the master of all; each drive begins at its phase. Raises KindynaError.
    """
    number = number_of(design, drive)
    single = only(design, number)
    if request.segment is not None and request.shift_deg:
        raise KindynaError("--shift: cannot be combined with --segment; allowed: one of them")
    shift = request.shift_deg + design.drives[number].phase
    result = slave_axis(Study(single), request.of, Alignment(shift, request.reverse), request.segment)
    return result, single.name, single.speed_rpm


def slave_choices(design: Design, drive: str) -> dict[str, str]:
    """Possible slave -> its description: the motion, and every position of the linkage."""
    single = only(design, number_of(design, drive))
    choices = {MOTION: "the motion"} if single.drive.motion is not None else {}
    labels = {row.slug: row.label for row in channels(single, ("motion", "linkage"))}
    return choices | {name: labels[name] for name in positions(single) if name not in SAME_AS_MOTION}


SAME_AS_MOTION = ("displacement_mm", "displacement_deg")
"""Columns that equal the motion."""
