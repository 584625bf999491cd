"""What a controller's slave axis has to do: the motion, or a coordinate of the linkage, over the angle of the master, exactly."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from core.design import Design
from core.errors import KindynaError
from core.frozen import frozen
from core.motion import Angles, Program, program
from core.output.channels import channels
from core.study import Study

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
    return np.asarray(getattr(pose.place(point, order), part))


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


__all__ = ["MOTION", "TURN", "Placing", "Slave", "positions", "slave"]
