"""How hard a follower strikes the other flank of a groove, or the other cam of a conjugate pair: its flight across the play."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from core.dynamics.elements import Loading
from core.dynamics.flank_changes import At, FlankChange
from core.dynamics.flight import FADES, FreeFollower
from core.errors import NoAnswer
from core.mechanism import Mechanism
from core.motion import TURN, Angles, Program

NODES = 12  # of a panel, on which motion and levers are polynomials
ORDERS = np.arange(NODES)
PANEL = math.radians(2.0)
STEP, PART = (
    math.radians(1.0),
    0.2,
)  # of the integration; of the time in which the free follower swings by a radian, or is damped
LAST = 1e-11  # [rad] of the angle of landing
LONGEST = 0.125 * TURN  # of a flight: one that hangs in the play for longer strikes nothing worth naming
NEAR, FAR = 1e-5, 0.2  # [rad] where the angle is looked for at which the contact is lost: first step, farthest
BEYOND, PLAYS = 0.02, 20.0  # of the stroke, and of the play: how far beyond the motion the follower is foreseen to fly


def with_impacts(
    changes: Sequence[FlankChange],
    at: At,
    mechanism: Mechanism,
    loading: Loading,
    program: Program,
    omega: float,
    play: float,
) -> tuple[FlankChange, ...]:
    """The changes with the speed of impact along the normal [m/s]; None where the follower comes back to the flank that it left, or
    stays in the play as friction has stopped it.

    The roller that keeps to the first flank follows the motion s(θ), to the second one s + play/g₂; g the gap that a flank opens for
    each unit of motion, -g₂ its closing. From the angle at which the flank that it leaves would have to pull it the follower flies as
    M y'' + ... = 0 says, until the gap g(θ)(y - s) at the other one has closed. Of the normal distance the square of the play beside
    the radius of curvature is left out.
    """
    if not changes or not play > 0.0:
        return tuple(changes)
    motion = program.state(program.angles(np.linspace(0.0, TURN, 721))).displacement
    y, slope = np.asarray(motion[0]), np.asarray(motion[1])
    beyond = max(BEYOND * float(np.ptp(y)), PLAYS * play)
    try:
        free = FreeFollower(
            mechanism, loading, y.min() - beyond, y.max() + beyond, FADES * omega * float(np.abs(slope).max()) or 1.0
        )
        crossing = _Crossing(_Flanks(at, program, mechanism.sense), free, play, omega)
        return tuple(replace(change, impact=crossing.impact(change.theta, change.to)) for change in changes)
    except NoAnswer:  # it flies where the mechanism cannot stand, or jams
        return tuple(changes)


class _Row(NamedTuple):
    """Motion s and the gaps g that the two flanks open for each unit of it, at an angle: value and two derivatives by it."""

    motion: np.ndarray
    opening: tuple[np.ndarray, np.ndarray]


class _Flanks:
    """Motion and gaps by the cam angle, counted on over the turns: polynomials on panels, made when they are passed."""

    def __init__(self, at: At, program: Program, sense: float) -> None:
        self._at, self._program, self._sense = at, program, sense
        self._panels: dict[tuple[int, int], np.ndarray] = {}

    def bounds(self, theta: float) -> tuple[float, float]:
        """Where the piece of the motion in which an angle lies begins and ends."""
        turns = math.floor(theta / TURN) * TURN
        piece = self._piece(theta)
        return turns + float(self._program.starts[piece]), turns + float(self._program.ends[piece])

    def _piece(self, theta: float) -> int:
        return max(int(np.searchsorted(self._program.starts, theta % TURN, side="right")) - 1, 0)

    def row(self, theta: float) -> _Row:
        piece, at = self._piece(theta), theta % TURN
        start, end = float(self._program.starts[piece]), float(self._program.ends[piece])
        count = max(1, math.ceil((end - start) / PANEL))
        half = 0.5 * (end - start) / count
        number = min(int((at - start) / (2.0 * half)), count - 1)
        middle = start + (2 * number + 1) * half
        if (piece, number) not in self._panels:
            self._panels[piece, number] = self._made(piece, middle, half)
        x = min(max((at - middle) / half, -1.0), 1.0)
        motion, first, second = (np.cos(ORDERS * math.acos(x)) @ self._panels[piece, number]).reshape(3, 3).T
        return _Row(motion, (first, second))

    def _made(self, piece: int, middle: float, half: float) -> np.ndarray:
        """Chebyshev coefficients (NODES, 9) of motion and gaps, of their first and of their second derivatives."""
        x = chebyshev.chebpts1(NODES)
        angles = Angles(middle + half * x, np.full(NODES, piece))
        _, forces = self._at(angles)
        gaps = [-self._sense * contact.lever for contact in forces.contacts]
        values = np.array([np.asarray(self._program.state(angles).displacement[0]), *gaps])
        found = np.zeros((3, NODES, 3))
        found[0] = np.linalg.solve(chebyshev.chebvander(x, NODES - 1), values.T)
        for order in (1, 2):
            found[order, :-order] = chebyshev.chebder(found[0], order, 1.0 / half)
        return np.concatenate(list(found), axis=1)


class _Crossing:
    def __init__(self, flanks: _Flanks, free: FreeFollower, play: float, omega: float) -> None:
        self._flanks, self._free, self._omega = flanks, free, omega
        self._clear = (0.0, play)  # at each flank where the motion is s itself

    def impact(self, theta: float, to: int) -> float | None:
        """The speed at the flank ``to``, of the follower that leaves the other one at about this angle."""
        begin = self._lost(theta, 1 - to)
        if begin is None:
            return None
        place, slope, _ = self._guided(begin, 1 - to)
        theta, state = begin, np.array([place, slope])
        longest = self._longest_step(theta, place, slope)

        def closed(step: float) -> float:
            return self._gap(theta + step, self._flown(theta, state, step), to)[0]

        from scipy.optimize import brentq

        while theta < begin + LONGEST:
            after = self._flown(theta, state, longest)
            left = self._gap(theta + longest, after, to)[0]
            if left <= 0.0:
                step = float(brentq(closed, 0.0, longest, xtol=LAST))
                return max(-self._gap(theta + step, self._flown(theta, state, step), to)[1] * self._omega, 0.0)
            if self._gap(theta + longest, after, 1 - to)[0] <= 0.0:
                return None
            theta, state = theta + longest, after
        return None

    def _longest_step(self, theta: float, y: float, slope: float) -> float:
        """So short that springs and dampers count as what they are."""
        off, faster = self._clear[1] / abs(self._flanks.row(theta).opening[1][0]), 1e-3 * abs(slope) or 1.0
        stiff = (self._acceleration(theta, y + off, slope) - self._acceleration(theta, y - off, slope)) / (2.0 * off)
        damped = (self._acceleration(theta, y, slope + faster) - self._acceleration(theta, y, slope - faster)) / (
            2.0 * faster
        )
        return min(STEP, PART / max(math.sqrt(abs(stiff)), abs(damped), PART))

    def _flown(self, theta: float, state: np.ndarray, step: float) -> np.ndarray:
        """y and dy/dθ a step later (Runge and Kutta's)."""

        def rate(at: float, y: np.ndarray) -> np.ndarray:
            return np.array([y[1], self._acceleration(at, float(y[0]), float(y[1]))])

        one = rate(theta, state)
        two = rate(theta + 0.5 * step, state + 0.5 * step * one)
        three = rate(theta + 0.5 * step, state + 0.5 * step * two)
        four = rate(theta + step, state + step * three)
        return np.asarray(state + step / 6.0 * (one + 2.0 * two + 2.0 * three + four))

    def _acceleration(self, theta: float, y: float, slope: float) -> float:
        """y'' of the free follower by the angle."""
        return self._free.acceleration(theta, y, slope * self._omega) / self._omega**2

    def _gap(self, theta: float, state: np.ndarray, flank: int) -> tuple[float, float]:
        """Between follower and flank, and its derivative by the angle [m]."""
        motion, opening = self._flanks.row(theta)
        by, off, drift = opening[flank], state[0] - motion[0], state[1] - motion[1]
        return float(self._clear[flank] + by[0] * off), float(by[0] * drift + by[1] * off)

    def _guided(self, theta: float, flank: int) -> tuple[float, float, float]:
        """y and two derivatives of the follower that keeps to a flank."""
        motion, opening = self._flanks.row(theta)
        by, clear = opening[flank], self._clear[flank]
        off = np.array([-1.0 / by[0], by[1] / by[0] ** 2, by[2] / by[0] ** 2 - 2.0 * by[1] ** 2 / by[0] ** 3])
        y, slope, bend = motion + clear * off
        return float(y), float(slope), float(bend)

    def _lost(self, theta: float, flank: int) -> float | None:
        """The angle at which a flank would have to pull the follower; of the first, which it keeps to as the motion says, the given one.

        Where the acceleration jumps there it is that of the jump; None where it lies far off.
        """
        if not self._clear[flank]:
            return theta

        def leaving(at: float) -> float:
            y, slope, bend = self._guided(at, flank)
            opening = self._flanks.row(at).opening[flank][0]
            return float(opening * (self._acceleration(at, y, slope) - bend))

        start, _ = self._flanks.bounds(theta)
        here, step = leaving(theta), NEAR
        side = -1.0 if here > 0.0 else 1.0
        while step < FAR:
            beside = theta + side * step
            if beside < start:
                return theta
            if (leaving(beside) > 0.0) != (here > 0.0):
                from scipy.optimize import brentq

                return float(brentq(leaving, theta, beside))
            step *= 2.0
        return None
