"""Schedules of process forces: where in the turn, or in the motion, a force acts, and its size."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.frozen import frozen
from core.motion import TURN, MotionState
from core.motion.extremes import crossings, piecewise_angles

# -- schedules of process forces --------------------------------------------------------------------------------


_TOLERANCE = 1e-9  # [m or rad] a dwell this near to the end of a window of the motion is inside it


@frozen
class AngleWindow:
    """Factor 1 from one cam angle to another [rad], past 0 where the first is the larger, and 0 elsewhere."""

    start: float
    end: float

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """Factor of the force and its derivative by cam angle.

        Parameters
        ----------
        motion : MotionState
            At n cam angles.

        Returns
        -------
        factor, slope : ndarray (n,), dimensionless and [1/rad]
        """
        theta = motion.within[0]
        after, before = theta >= self.start, theta < self.end
        on = after & before if self.start < self.end else after | before
        return on.astype(float), np.zeros(theta.size)

    def cuts(self, program: Any) -> np.ndarray:
        """Cam angles at which the force switches.

        Parameters
        ----------
        program : CompiledMotion

        Returns
        -------
        ndarray (m,) [rad]
        """
        return np.mod([self.start, self.end], TURN)


@frozen
class MotionWindow:
    """Factor 1 while the motion [m or rad] is between two values, these included, and 0 elsewhere."""

    low: float
    high: float

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """Factor of the force and its derivative by cam angle.

        Parameters
        ----------
        motion : MotionState
            At n cam angles.

        Returns
        -------
        factor, slope : ndarray (n,), dimensionless and [1/rad]
        """
        y = motion.within[1]
        return ((y >= self.low - _TOLERANCE) & (y <= self.high + _TOLERANCE)).astype(float), np.zeros(y.size)

    def cuts(self, program: Any) -> np.ndarray:
        """Cam angles at which the force switches: roots of the motion.

        Parameters
        ----------
        program : CompiledMotion

        Returns
        -------
        ndarray (m,) [rad]
        """
        angles = piecewise_angles(program)
        y = program.state(angles).displacement[0]
        levels = np.array([[level] for level in (self.low, self.high) if np.isfinite(level)])
        return crossings(lambda at: program.state(at).displacement[0] - levels, angles, y - levels).theta


@frozen
class ScheduleTable:
    """Values of the force, linear between rows of cam angle [rad] and value, periodic."""

    angles: tuple[float, ...]
    values: tuple[float, ...]

    def value(self, motion: MotionState) -> tuple[np.ndarray, np.ndarray]:
        """Value of the force and its derivative by cam angle.

        Parameters
        ----------
        motion : MotionState
            At n cam angles.

        Returns
        -------
        value, slope : ndarray (n,) [N or N m] and [N/rad or N m/rad]
        """
        theta = np.array([self.angles[-1] - TURN, *self.angles, self.angles[0] + TURN])
        values = np.array([self.values[-1], *self.values, self.values[0]])
        width = np.diff(theta)
        slope = np.where(width > 0.0, np.diff(values) / np.where(width > 0.0, width, 1.0), 0.0)
        row = np.clip(np.searchsorted(theta, motion.within[0], side="right") - 1, 0, slope.size - 1)
        return values[row] + slope[row] * (motion.theta - theta[row]), slope[row]

    def cuts(self, program: Any) -> np.ndarray:
        """Cam angles of the rows.

        Parameters
        ----------
        program : CompiledMotion

        Returns
        -------
        ndarray (m,) [rad]
        """
        return np.mod(self.angles, TURN)


Schedule = AngleWindow | MotionWindow | ScheduleTable
