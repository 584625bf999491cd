"""When a process force works: on a part of the turn, at a part of the motion, or as a table over the turn.

Where it switches the torque jumps, so that the turn is cut there; which side of a cut an angle is on, its piece tells.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from core.frozen import frozen
from core.motion import TURN, MotionState
from core.motion.extremes import piecewise_angles
from core.motion.roots import crossings

_LEVEL = 1e-9  # [m or rad] a dwell this near to the end of a part of the motion lies in it


@frozen
class OverTurn:
    """On from one angle to another [rad], past 0 where the first is the larger."""

    start: float
    end: float

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """1 where it is on, else 0, and the derivative by cam angle (n,)."""
        at = motion.within[0]
        after, before = at >= self.start, at < self.end
        on = after & before if self.start < self.end else after | before
        return on.astype(float), np.zeros(at.size)

    def cuts(self, program: Any) -> np.ndarray:
        """Angles (m,) [rad] at which it switches."""
        return np.mod([self.start, self.end], TURN)


@frozen
class OverMotion:
    """On while the motion [m or rad] lies between two values, these included."""

    low: float
    high: float

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """1 where it is on, else 0, and the derivative by cam angle (n,)."""
        y = motion.within[1]
        return ((y >= self.low - _LEVEL) & (y <= self.high + _LEVEL)).astype(float), np.zeros(y.size)

    def cuts(self, program: Any) -> np.ndarray:
        """Angles (m,) [rad] at which it switches: roots of the motion."""
        angles = piecewise_angles(program)
        y = program.state(angles).displacement[0]
        levels = np.array([[self.low], [self.high]])
        return crossings(lambda there: program.state(there).displacement[0] - levels, angles, y - levels).theta


@frozen
class ByTable:
    """Linear between rows of angle [rad] and value, periodic."""

    angles: tuple[float, ...]
    values: tuple[float, ...]

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """Value and derivative by cam angle (n,)."""
        at = np.array([self.angles[-1] - TURN, *self.angles, self.angles[0] + TURN])
        rows = np.array([self.values[-1], *self.values, self.values[0]])
        width = np.diff(at)
        slope = np.where(width > 0.0, np.diff(rows) / np.where(width > 0.0, width, 1.0), 0.0)
        row = np.clip(np.searchsorted(at, motion.within[0], side="right") - 1, 0, slope.size - 1)
        return rows[row] + slope[row] * (motion.theta - at[row]), slope[row]

    def cuts(self, program: Any) -> np.ndarray:
        """Its rows."""
        return np.mod(self.angles, TURN)


Schedule = OverTurn | OverMotion | ByTable
