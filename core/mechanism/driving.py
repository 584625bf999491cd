"""How the driver runs through its ranges: a crank at speed, piece by piece of its ranges."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from itertools import pairwise

import numpy as np

from core.design import Motion
from core.mechanism.driver_ranges import TURN, DriverRanges
from core.motion import SNAP, Angles, Join, MotionState, Program, degrees, program
from core.numerics.derivatives import Derivatives


class CrankProgram:
    """A crank's turn: one piece for each range in which the linkage can be assembled, the whole turn where it can
    everywhere. Looks like the program of a motion whose value is the angle itself. A crank that swings goes at speed through its
    range in the first half of a cycle, and back in the second.

    starts, ends  (m,) driver angles, or those of the cycle [rad]: where it swings, or comes back after several turns
    swing         the range through which it goes to and fro, where it does
    """

    joins: tuple[Join, ...] = ()

    def __init__(self, driver_ranges: DriverRanges) -> None:
        self.swing = driver_ranges.ranges[0] if driver_ranges.swings else None
        ranges = [(0.0, np.pi), (np.pi, TURN)] if self.swing else [(r.low, r.high) for r in driver_ranges.ranges]
        self.turns = driver_ranges.turns
        if self.turns > 1 and not self.swing:
            whole = len(ranges) == 1 and driver_ranges.ranges[0].free
            ranges = [(0.0, TURN)] if whole else [(a / self.turns, b / self.turns) for a, b in ranges]
        self._open = tuple(ranges)
        self.starts, self.ends = np.array(self._cut(driver_ranges.motions)).reshape(-1, 2).T

    def _cut(self, motions: Iterable[Motion]) -> list[tuple[float, float]]:
        """The ranges, cut also where a segment of a second driver's own motion begins: between them all is smooth."""
        begin = {float(at) for motion in motions for at in program(motion).starts}
        if not begin:
            return list(self._open)
        if self.swing is not None:
            low, high = self.swing.low, self.swing.high
            places = (at + TURN * k for at in begin for k in range(int(low // TURN) - 1, int(high // TURN) + 2))
            there = {(place - low) / (high - low) * np.pi for place in places if low < place < high}
            there |= {TURN - at for at in there}
        else:
            there = {(at + TURN * k) / self.turns for at in begin for k in range(self.turns)}
        parts = []
        for a, b in self._open:
            ends = [a, *sorted(at for at in there if a + SNAP < at < b - SNAP), b]
            parts += list(pairwise(ends))
        return parts

    def angles(self, theta: np.ndarray, kept: bool = False) -> Angles:
        """Any driver angles (n,) [rad], each with its piece."""
        theta = np.mod(np.asarray(theta, dtype=float), TURN)
        theta = np.where(theta >= TURN - SNAP, 0.0, theta)
        piece = np.clip(np.searchsorted(self.starts, theta, side="right") - 1, 0, None)
        return Angles(theta, piece, kept)

    def within(self, theta: np.ndarray) -> np.ndarray:
        """(n,) where the linkage can be assembled and is not locked."""
        if self.swing is not None:
            return (theta != 0.0) & (theta != np.pi)
        if self._open == ((0.0, TURN),):
            return np.ones(theta.shape, dtype=bool)
        inside = [(theta > a) & (theta < b) for a, b in self._open]
        inside += [(theta == 0.0) & (a == 0.0) for a, _ in self._open[:1]]
        return np.any(inside, axis=0)

    def degrees(self, samples: int) -> np.ndarray:
        """Of 0 ... 360(N-1)/N those driver angles [deg] at which the linkage stands somewhere."""
        all_of = degrees(samples)
        return all_of[self.within(np.deg2rad(all_of))]

    def theta(self, place: float) -> float:
        """The angle [rad], 0 ... 2π, at which the crank stands at a place [rad]: on its way forth where it swings."""
        if self.swing is None:
            return float(place / self.turns % TURN)
        low, high = self.swing.low, self.swing.high
        return float(np.clip((place - low) / (high - low), 0.0, 1.0) * np.pi)

    def state(self, angles: Angles) -> MotionState:
        """The crank's angle and its derivatives by itself, or by the angle of the cycle."""
        one = np.ones(angles.theta.size)
        none = np.zeros(angles.theta.size)
        if self.swing is not None:
            low, high = self.swing.low, self.swing.high
            sign = np.where(self.ends[angles.piece] <= np.pi, 1.0, -1.0)
            rate = (high - low) / np.pi
            q = np.where(sign > 0.0, low + rate * angles.theta, low + rate * (TURN - angles.theta))
            return MotionState(angles, Derivatives.of((q, rate * sign, none, none)), sign)
        q = angles.theta * self.turns
        return MotionState(angles, Derivatives.of((q, one * self.turns, none, none)), one)


@lru_cache(maxsize=32)
def swept(program: Program) -> tuple[float, float]:
    """Lowest and highest driver position [rad or m] of a motion: its pieces turn at their ends only. A motion that stands
    still is given a little room."""
    pieces = np.arange(program.starts.size)
    ends = Angles(np.concatenate((program.starts, program.ends)), np.concatenate((pieces, pieces)))
    low, high = with_room(program.state(ends).displacement[0])
    return float(low), float(high)


def with_room(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A little less than the lowest and more than the highest of positions (..., n)."""
    low, high = y.min(axis=-1), y.max(axis=-1)
    room = np.where(high == low, 1e-6, 1e-9 * (high - low))
    return low - room, high + room
