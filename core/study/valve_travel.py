"""Travel of the valve of a drive: where it is closed, and the motion at which its lash is taken up."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np

from core.design import Drive, si
from core.dynamics import Lash
from core.errors import NoAssembly
from core.mechanism import DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, MotionState
from core.number_text import input_text, result_text
from core.numerics.derivatives import Derivatives
from core.numerics.lazy import lazy
from core.numerics.roots import BracketEnds, bracketed_root

VALVE_GUIDE = "valve_guide"
"""Coordinate of the valve of a pushrod train."""


class ValveTravel:
    """Travel of the valve of a drive along its opening, as a function of the motion; the lash is not taken off.

    The valve is a slide of the linkage or of the pushrod train; of any other follower the motion is the valve's.

    Attributes
    ----------
    drive : Drive
    program : CompiledMotion
        The motion of the drive.
    """

    def __init__(self, drive: Drive, mechanism: Mechanism, program: Any, ranges: Callable[[], DriverRanges]) -> None:
        self.drive, self.program = drive, program
        self._mechanism, self._ranges = mechanism, ranges
        self._name = VALVE_GUIDE if drive.valve is None or drive.valve.link is None else f"slide{drive.valve.link}"

    def position(self, kinematics: Kinematics) -> Derivatives:
        """Position of the valve (n,) [m], and its derivatives by cam angle.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.

        Returns
        -------
        Derivatives
        """
        return kinematics.coordinates.get(self._name, kinematics.motion.displacement)

    def at(self, y: float) -> float:
        """Position of the valve [m] at a motion [m or rad]."""
        zero, one = np.zeros(1), np.ones(1)
        state = MotionState(Angles(zero, np.zeros(1, dtype=int)), Derivatives.of((np.array([y]), one, zero, zero)), one)
        return float(self.position(solve_mechanism(self._mechanism, state, self._ranges()))[0][0])

    @lazy
    def closed(self) -> float:
        """Position of the closed valve [m]: of a linkage that where its motion is lowest, of a follower 0.

        Raises
        ------
        NoAssembly
            The slide of the valve in a linkage does not grow with the motion.
        """
        if self.drive.valve is None or (link := self.drive.valve.link) is None:
            return 0.0
        lowest, highest = self.program.position_range
        if self.drive.is_valve_motion:
            return lowest
        closed, opened = self.at(lowest), self.at(highest)
        if not opened > closed:
            travel = f"{result_text(1e3 * (closed - opened), 6)} mm"
            raise NoAssembly(
                f"the valve would close while the motion rises: the slide of link {link} becomes shorter by {travel}",
                "valve.link",
                "turn angle_deg of this slider by 180°, or choose another slider",
            )
        return closed

    def motion_at(self, travel: float) -> float:
        """Motion [m or rad] at which the valve has moved a travel [m] from where it is closed; infinite where it never has."""
        opens, (low, high) = self.closed + travel, self.program.position_range
        if travel <= 0.0:  # rounding would decide
            return low
        if self.drive.is_valve_motion:
            return opens if opens <= high else inf
        ends = BracketEnds(low, self.at(low) - opens, high, self.at(high) - opens)
        if ends.fa * ends.fb > 0.0:
            return inf
        return bracketed_root(lambda y: self.at(y) - opens, ends).b

    @lazy
    def lash(self) -> Lash:
        """Lash, with the motion at which it is taken up.

        Raises
        ------
        NoAssembly
            The train moves the valve by less than the lash.
        """
        size: float = si(self.drive.valve).lash
        at_motion = self.motion_at(size)
        if at_motion == inf:
            typed, most = input_text(1e3 * size), self.at(self.program.position_range[1]) - self.closed
            raise NoAssembly(
                f"the valve stays closed: its lash is {typed} mm, and the train moves it by {result_text(1e3 * most, 6)} mm",
                "valve.lash_mm",
                "lower the lash, or raise the lift",
            )
        return Lash(size, at_motion)
