"""The turn of a shaft on which several motions run, each by its own angle: where the pieces of all of them end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from core.frozen import frozen
from core.motion.program import TURN, Angles
from core.numerics.vectors import distinct

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


def all_ends(cuts: Sequence[np.ndarray]) -> np.ndarray:
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
        ends = all_ends([place.machine(program.starts) for program, place in self.programs])
        self.starts, self.ends = ends[:-1], ends[1:]

    def angles(self, theta: np.ndarray) -> Angles:
        """Any machine angles (n,) [rad], each with the piece right of it."""
        theta = np.mod(np.asarray(theta, dtype=float), TURN)
        theta = np.where(theta >= TURN - CLOSEST, 0.0, theta)
        return Angles(theta, np.searchsorted(self.starts - CLOSEST, theta, side="right") - 1)

    def own(self, number: int, angles: Angles, kept: bool = False) -> Angles:
        """The angles of one program at machine angles, each on the same side of its joins."""
        program, place = self.programs[number]
        middle = (0.5 * (self.starts + self.ends))[angles.piece]
        inside = program.angles(place.own(middle))
        theta = inside.theta + place.sense * (angles.theta - middle)
        return Angles(np.clip(theta, program.starts[inside.piece], program.ends[inside.piece]), inside.piece, kept)
