"""The contact force at every speed of the shaft: from which speed on the follower leaves the cam, and where."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from core.cam import CamShape
from core.dynamics.elements import Loading
from core.dynamics.forces import newton_euler
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, CompiledMotion
from core.motion.extremes import Extreme, find_extremes, find_highest, piecewise_angles

NOTHING = 1e-12  # of the largest force at standstill: a force below it is none
SLOWLY = 1e-6  # of the design's speed: turns, so that friction has a direction, but nothing has to be accelerated
FASTEST = 1e5 * math.pi / 30.0  # [rad/s] a follower that stays on the cam up to here never leaves it
BETWEEN = 9  # speeds of a range at which a follower with friction is looked at
CLOSE = 1e-9  # of the highest speed: to that the one of the least force is found
GROWTH = 1.25  # from one speed tried to the next
FIRST = 0.2  # of the design's speed: the first one tried

At = Callable[[Angles], tuple[Kinematics, CamShape]]


@frozen
class LeastForce:
    """The least contact force [N] over a turn, and over a range of speeds: where [rad], and at which speed [rad/s]."""

    value: float
    theta: float
    omega: float


@frozen
class LiftOff:
    """The least speed omega [rad/s] at which the least contact force falls to a level, and the cam angle theta [rad]; 0 where it is
    no more than that at standstill."""

    omega: float
    theta: float


@frozen(eq=False)
class Parts:
    """F_c = A + ω C + ω² B at n cam angles: A of springs, weights and other forces [N], C of dampers [N s], B of masses [N s²], each
    (n,)."""

    standing: np.ndarray
    damped: np.ndarray
    inertial: np.ndarray

    def force(self, omega: float | np.ndarray) -> np.ndarray:
        """F_c (n,) [N] at the speed omega [rad/s]; (m, n) at speeds (m, 1)."""
        return np.asarray(self.standing + omega * (self.damped + omega * self.inertial))

    def least(self, high: float) -> tuple[np.ndarray, np.ndarray]:
        """The least force (n,) at speeds 0 ... high, and these speeds (n,): at an end, or where the parabola is lowest."""
        with np.errstate(divide="ignore", invalid="ignore"):
            lowest = np.where(self.inertial > 0.0, -0.5 * self.damped / self.inertial, 0.0)
        speed = np.clip(np.nan_to_num(lowest), 0.0, high)
        speed = np.where(self.force(high) < self.force(speed), high, speed)
        speed = np.where(self.standing < self.force(speed), 0.0, speed)
        return self.force(speed), speed

    def greatest(self, high: float) -> np.ndarray:
        """The greatest force (n,) at speeds 0 ... high."""
        return -Parts(-self.standing, -self.damped, -self.inertial).least(high)[0]

    def roots(self, level: float = 0.0) -> np.ndarray:
        """The speeds (2, n) at which the force is at the level, rising; NaN where there is none above 0."""
        rest = self.standing - level
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.sqrt(self.damped**2 - 4.0 * rest * self.inertial)  # NaN without a root
            half = -0.5 * (self.damped + np.copysign(room, self.damped))
            both = np.array([half / self.inertial, rest / half])
        return np.sort(np.where(np.isfinite(both) & (both > 0.0), both, np.nan), axis=0)


class ContactForce:
    """The contact force of a cam on one side, F_c(θ, ω), with its least value over the turn and over speeds.

    Without friction in pairs it is a parabola over the speed at each angle, and what is least or zero follows in closed form there.
    Friction in pairs changes with the direction of their reactions: then every speed is solved.

    at      cam angles -> kinematics and cam; neither depends on the speed
    omega   the design's own speed [rad/s]
    """

    def __init__(self, at: At, loading: Loading, program: CompiledMotion, omega: float) -> None:
        self._at, self.loading, self.program, self.omega = lru_cache(maxsize=4)(at), loading, program, omega

    @property
    def rubs(self) -> bool:
        """Whether pairs rub, so that the force is no parabola over the speed."""
        return bool(self.loading.frictions)

    def at_speed(self, angles: Angles, omega: float) -> np.ndarray:
        """F_c (n,) [N]."""
        return newton_euler(*self._at(angles), self.loading, omega).contact

    def parts(self, angles: Angles) -> Parts:
        """The three parts, each from a solution of its own; of a follower without friction in pairs."""
        assert not self.rubs, "no parabola"
        place, one = self._at(angles), self.omega
        standing = newton_euler(*place, self.loading, 0.0).contact
        inertial = newton_euler(*place, self.loading.inertial_with_contact, 1.0).contact
        moving = newton_euler(*place, self.loading, one).contact - one * one * inertial
        damped = (moving - standing) / one
        scale = NOTHING * (np.abs(standing) + one * one * np.abs(inertial)) / one
        return Parts(standing, np.where(np.abs(damped) <= scale, 0.0, damped), inertial)

    # -- the least force ------------------------------------------------------------------------------------

    def least(self, high: float) -> LeastForce:
        """The least force at any angle and any speed 0 ... high [rad/s], refined."""
        if self.rubs:
            return self._least_with_friction(high)
        top = find_highest(lambda angles: {"": -self.parts(angles).least(high)[0]}, self.program)[""]
        there = self.parts(self.program.angles(np.array([top.theta]))).least(high)[1]
        return LeastForce(-top.value, top.theta, float(there[0]))

    def _least_with_friction(self, high: float) -> LeastForce:
        speeds = self._speeds(high)
        angles = piecewise_angles(self.program)
        sampled = [float(self.at_speed(angles, speed).min()) for speed in speeds]
        i = int(np.argmin(sampled))
        speed = speeds[i]
        if 0 < i < BETWEEN - 1:
            from scipy.optimize import minimize_scalar

            around, finest = (speeds[i - 1], speeds[i + 1]), {"xatol": CLOSE * high}
            speed = float(minimize_scalar(lambda x: self.at_own(x).value, bounds=around, options=finest).x)
        found = self.at_own(speed)
        return LeastForce(found.value, found.theta, 0.0 if i == 0 else speed)

    def greatest(self, high: float) -> float:
        """The greatest force [N] at any angle and any speed 0 ... high [rad/s], refined; with friction in pairs at the speed that is
        worst of some."""
        if not self.rubs:
            return find_highest(lambda angles: {"": self.parts(angles).greatest(high)}, self.program)[""].value
        angles = piecewise_angles(self.program)
        worst = max(self._speeds(high), key=lambda speed: float(self.at_speed(angles, speed).max()))
        return find_extremes(lambda angles: {"": self.at_speed(angles, worst)}, self.program)[""].high.value

    def _speeds(self, high: float) -> list[float]:
        """Where a follower with friction is looked at: from next to standstill on."""
        slow = SLOWLY * self.omega
        found: list[float] = np.linspace(slow, max(high, 2.0 * slow), BETWEEN).tolist()
        return found

    def sampled(self, angles: Angles, high: float) -> tuple[float, float]:
        """The least and the greatest force [N] at these angles (n,) and any speed 0 ... high [rad/s]; with friction in pairs at standstill
        and at the highest speed."""
        if not self.rubs:
            parts = self.parts(angles)
            return float(parts.least(high)[0].min()), float(parts.greatest(high).max())
        speeds = self._speeds(high)
        force = np.array([self.at_speed(angles, speeds[0]), self.at_speed(angles, speeds[-1])])
        return float(force.min()), float(force.max())

    def at_own(self, omega: float) -> Extreme:
        """The least force over the turn at one speed, refined."""
        return find_extremes(lambda angles: {"": self.at_speed(angles, omega)}, self.program)[""].low

    # -- lift-off -------------------------------------------------------------------------------------------

    def lift_off(self, level: float = 0.0) -> LiftOff | None:
        """The least speed at which the least contact force falls to the level [N]; None where no speed up to ``FASTEST`` does that.

        At each angle A - level + ω C + ω² B = 0 gives the speed; the least of them over the turn is refined.
        """
        standing = self.at_own(SLOWLY * self.omega if self.rubs else 0.0)
        size = NOTHING * (
            abs(level) + float(np.abs(self.at_speed(piecewise_angles(self.program), self.omega)).max(initial=0.0))
        )
        if standing.value <= level + size:
            return LiftOff(0.0, standing.theta)
        if self.rubs:
            return self._lift_off_with_friction(level)

        def slowness(angles: Angles) -> dict[str, np.ndarray]:
            return {"": np.nan_to_num(1.0 / self.parts(angles).roots(level)[0])}

        top = find_highest(slowness, self.program)[""]
        return LiftOff(1.0 / top.value, top.theta) if top.value * FASTEST > 1.0 else None

    def _lift_off_with_friction(self, level: float) -> LiftOff | None:
        angles = piecewise_angles(self.program)
        slow, fast = 0.0, FIRST * self.omega
        while self.at_speed(angles, fast).min() > level:
            slow, fast = fast, GROWTH * fast
            if fast > FASTEST:
                return None

        def spare(omega: float) -> float:
            return self.at_own(omega).value - level

        from scipy.optimize import brentq

        root = float(brentq(spare, max(slow / GROWTH, SLOWLY * self.omega), fast))
        return LiftOff(root, self.at_own(root).theta)


@frozen(eq=False)
class ContactMap:
    """The contact force over cam angle and speed.

    theta (n,) [rad]; omega (m,) [rad/s]; force (m, n) [N]; zero (2, n) [rad/s]: the speeds at which it passes zero at each angle,
    NaN where it does not.
    """

    theta: np.ndarray
    omega: np.ndarray
    force: np.ndarray
    zero: np.ndarray


def contact_map(contact: ContactForce, theta: np.ndarray, omega: np.ndarray) -> ContactMap:
    """At cam angles (n,) and rising speeds (m,) > 0. The zero line is exact where no pair rubs; else it is taken between the speeds
    next to it, along the force's straight line over the speed squared."""
    angles = contact.program.angles(theta)
    if not contact.rubs:
        parts = contact.parts(angles)
        return ContactMap(theta, omega, parts.force(omega[:, None]), parts.roots())
    force = np.array([contact.at_speed(angles, float(speed)) for speed in omega])
    zero = np.full((2, theta.size), np.nan)
    square = omega * omega
    for j in range(theta.size):
        turns = np.flatnonzero(force[:-1, j] * force[1:, j] < 0.0)[:2]
        part = force[turns, j] / (force[turns, j] - force[turns + 1, j])
        zero[: turns.size, j] = np.sqrt(square[turns] + part * (square[turns + 1] - square[turns]))
    return ContactMap(theta, omega, force, zero)
