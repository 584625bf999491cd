"""Contact force at every speed of the shaft: the speed from which the follower leaves the cam, and the cam angle."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from core.cam import CamShape
from core.dynamics.forces import newton_euler
from core.dynamics.loading import Loading
from core.dynamics.unit_loads import UnitLoads, unit_loads
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, CompiledMotion
from core.motion.extremes import Extreme, find_extremes, find_highest, piecewise_angles
from core.numerics.roots import BracketEnds, bracketed_root

ROUNDING = 1e-12  # of the largest force at standstill: a smaller force counts as 0
SLOW = 1e-6  # of the design's speed: friction has a direction, but inertia forces are negligible
HIGHEST_SPEED = 1e5 * math.pi / 30.0  # [rad/s] a follower that stays on the cam up to this speed never leaves it
SPEEDS = 9  # of a range, at which a follower with friction is evaluated
SPEED_TOLERANCE = 1e-9  # of the highest speed, for the speed of the least force
GROWTH = 1.25  # factor between successive speeds of the search for lift-off
FIRST = 0.2  # of the design's speed: the first speed of this search
NEAR, LAST = 1e-4, 1e-13  # accuracy of the root of the samples and of the refined root, by the speed

At = Callable[[Angles], tuple[Kinematics, CamShape]]
Position = tuple[Kinematics, CamShape, UnitLoads]


@frozen
class LeastForce:
    """Least contact force [N] over a turn and a range of speeds, with its cam angle [rad] and speed [rad/s]."""

    value: float
    theta: float
    omega: float


@frozen
class LiftOff:
    """Least speed omega [rad/s] at which the least contact force falls to a level, and the cam angle theta [rad].

    The speed is 0 where the force is not above the level at standstill.
    """

    omega: float
    theta: float


@frozen(eq=False)
class ForceTerms:
    """Terms of the contact force at n cam angles, F_c = A + ω C + ω² B.

    Attributes
    ----------
    static : ndarray (n,) [N]
        A, of springs, weights and other forces.
    damping : ndarray (n,) [N s]
        C, of dampers.
    inertia : ndarray (n,) [N s²]
        B, of masses.
    """

    static: np.ndarray
    damping: np.ndarray
    inertia: np.ndarray

    def force(self, omega: float | np.ndarray) -> np.ndarray:
        """Contact force F_c at a speed.

        Parameters
        ----------
        omega : float or ndarray (m, 1) [rad/s]

        Returns
        -------
        ndarray (n,) or (m, n) [N]
        """
        return np.asarray(self.static + omega * (self.damping + omega * self.inertia))

    def least(self, high: float) -> tuple[np.ndarray, np.ndarray]:
        """Least force at speeds 0 ... high, and its speed: an end of the range, or the minimum of the parabola.

        Parameters
        ----------
        high : float
            Highest speed [rad/s].

        Returns
        -------
        force, omega : ndarray (n,) [N], [rad/s]
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            lowest = np.where(self.inertia > 0.0, -0.5 * self.damping / self.inertia, 0.0)
        speed = np.clip(np.nan_to_num(lowest), 0.0, high)
        speed = np.where(self.force(high) < self.force(speed), high, speed)
        speed = np.where(self.static < self.force(speed), 0.0, speed)
        return self.force(speed), speed

    def greatest(self, high: float) -> np.ndarray:
        """Greatest force at speeds 0 ... high.

        Parameters
        ----------
        high : float
            Highest speed [rad/s].

        Returns
        -------
        ndarray (n,) [N]
        """
        return -ForceTerms(-self.static, -self.damping, -self.inertia).least(high)[0]

    def roots(self, level: float = 0.0) -> np.ndarray:
        """Speeds at which the force is equal to the level, in rising order; NaN where no positive speed is.

        Parameters
        ----------
        level : float
            Force [N].

        Returns
        -------
        ndarray (2, n) [rad/s]
        """
        constant = self.static - level
        with np.errstate(divide="ignore", invalid="ignore"):
            discriminant_root = np.sqrt(self.damping**2 - 4.0 * constant * self.inertia)  # NaN without a root
            half = -0.5 * (self.damping + np.copysign(discriminant_root, self.damping))
            roots = np.array([half / self.inertia, constant / half])
        return np.sort(np.where(np.isfinite(roots) & (roots > 0.0), roots, np.nan), axis=0)


def _contact_force(position: Position, loading: Loading, omega: float) -> np.ndarray:
    """Contact force (n,); NaN, which searches ignore, where a valve train is loose."""
    kinematics, shape, units = position
    force = newton_euler(kinematics, shape, loading, omega, units=units).contact
    return force if loading.contact_window is None else np.where(loading.acting(kinematics), force, np.nan)


class ContactForce:
    """Contact force F_c(θ, ω) of a cam with one flank, with its extremes over the turn and over speeds.

    Without friction in pairs the force is a parabola over the speed at each angle, whose extremes and roots have a
    closed form. Friction in pairs changes with the direction of their reactions: then every speed is solved separately.

    at: cam angles -> kinematics and cam, which do not depend on the speed; omega: the design's speed [rad/s]
    """

    def __init__(self, at: At, loading: Loading, program: CompiledMotion, omega: float) -> None:
        self.loading, self.program, self.omega = loading, program, omega
        pairs = tuple(friction.pair for friction in loading.frictions)

        @lru_cache(maxsize=4)
        def position(angles: Angles) -> Position:
            kinematics, shape = at(angles)
            return kinematics, shape, unit_loads(kinematics, shape, loading.contact_friction, pairs)

        self._position = position

    @property
    def has_friction(self) -> bool:
        """Whether pairs have friction, so that the force is no parabola over the speed."""
        return bool(self.loading.frictions)

    def at_speed(self, angles: Angles, omega: float) -> np.ndarray:
        """Contact force F_c at a speed; NaN where a valve train is loose.

        Parameters
        ----------
        angles : Angles
            n cam angles.
        omega : float
            Speed [rad/s].

        Returns
        -------
        ndarray (n,) [N]
        """
        return _contact_force(self._position(angles), self.loading, omega)

    def terms(self, angles: Angles) -> ForceTerms:
        """Terms of the force of a follower without friction in pairs, from three solutions."""
        assert not self.has_friction, "no parabola"
        position, omega = self._position(angles), self.omega
        static = _contact_force(position, self.loading, 0.0)
        inertia = _contact_force(position, self.loading.inertial_with_contact, 1.0)
        moving = _contact_force(position, self.loading, omega) - omega * omega * inertia
        damping = (moving - static) / omega
        scale = ROUNDING * (np.abs(static) + omega * omega * np.abs(inertia)) / omega
        return ForceTerms(static, np.where(np.abs(damping) <= scale, 0.0, damping), inertia)

    # -- least and greatest force ---------------------------------------------------------------------------

    def least(self, high: float) -> LeastForce:
        """The least force at any angle and any speed 0 ... high [rad/s], refined."""
        if self.has_friction:
            return self._least_with_friction(high)
        top = find_highest(lambda angles: {"": -self.terms(angles).least(high)[0]}, self.program)[""]
        omega = self.terms(self.program.angles(np.array([top.theta]))).least(high)[1]
        return LeastForce(-top.value, top.theta, float(omega[0]))

    def _least_with_friction(self, high: float) -> LeastForce:
        speeds = self._speeds(high)
        angles = piecewise_angles(self.program)
        sampled = [float(np.nanmin(self.at_speed(angles, speed))) for speed in speeds]
        i = int(np.argmin(sampled))
        speed = speeds[i]
        if 0 < i < SPEEDS - 1:
            from scipy.optimize import minimize_scalar

            bounds, options = (speeds[i - 1], speeds[i + 1]), {"xatol": SPEED_TOLERANCE * high}
            speed = float(minimize_scalar(lambda x: self.least_at_speed(x).value, bounds=bounds, options=options).x)
        least = self.least_at_speed(speed)
        return LeastForce(least.value, least.theta, 0.0 if i == 0 else speed)

    def greatest(self, high: float) -> float:
        """Greatest force [N] at any angle and any speed 0 ... high [rad/s], refined.

        With friction in pairs the speed is the one with the greatest force of a few speeds.
        """
        if not self.has_friction:
            return find_highest(lambda angles: {"": self.terms(angles).greatest(high)}, self.program)[""].value
        angles = piecewise_angles(self.program)
        worst_speed = max(self._speeds(high), key=lambda speed: float(np.nanmax(self.at_speed(angles, speed))))
        return find_extremes(lambda angles: {"": self.at_speed(angles, worst_speed)}, self.program)[""].high.value

    def _speeds(self, high: float) -> list[float]:
        """Speeds at which a follower with friction is evaluated, from nearly 0 on."""
        slow = SLOW * self.omega
        speeds: list[float] = np.linspace(slow, max(high, 2.0 * slow), SPEEDS).tolist()
        return speeds

    def sampled(self, angles: Angles, high: float) -> tuple[float, float]:
        """Least and greatest force [N] at these angles and any speed 0 ... high [rad/s].

        With friction in pairs the speeds are the lowest and the highest one.
        """
        if not self.has_friction:
            terms = self.terms(angles)
            return float(np.nanmin(terms.least(high)[0])), float(np.nanmax(terms.greatest(high)))
        speeds = self._speeds(high)
        force = np.array([self.at_speed(angles, speeds[0]), self.at_speed(angles, speeds[-1])])
        return float(np.nanmin(force)), float(np.nanmax(force))

    def least_at_speed(self, omega: float) -> Extreme:
        """Least force [N] over the turn at one speed [rad/s], refined."""
        return find_extremes(lambda angles: {"": self.at_speed(angles, omega)}, self.program)[""].low

    # -- lift-off -------------------------------------------------------------------------------------------

    def lift_off(self, level: float = 0.0) -> LiftOff | None:
        """Least speed at which the least contact force falls to the level [N]; None where it is above HIGHEST_SPEED.

        At each angle A - level + ω C + ω² B = 0 gives the speed; the least of them over the turn is refined.
        """
        static = self.least_at_speed(SLOW * self.omega if self.has_friction else 0.0)
        tolerance = ROUNDING * (
            abs(level) + float(np.nanmax(np.abs(self.at_speed(piecewise_angles(self.program), self.omega))))
        )
        if static.value <= level + tolerance:
            return LiftOff(0.0, static.theta)
        if self.has_friction:
            return self._lift_off_with_friction(level)

        def slowness(angles: Angles) -> dict[str, np.ndarray]:
            return {"": np.nan_to_num(1.0 / self.terms(angles).roots(level)[0])}

        top = find_highest(slowness, self.program)[""]
        return LiftOff(1.0 / top.value, top.theta) if top.value * HIGHEST_SPEED > 1.0 else None

    def _lift_off_with_friction(self, level: float) -> LiftOff | None:
        """Root of the least force over the speed: first of the least of the samples, then of the refined least."""
        angles = piecewise_angles(self.program)

        def sampled(omega: float) -> float:
            return float(np.nanmin(self.at_speed(angles, omega))) - level

        def margin(omega: float) -> float:
            return self.least_at_speed(omega).value - level

        slow, fast = SLOW * self.omega, FIRST * self.omega
        while (value := sampled(fast)) > 0.0:
            slow, fast = fast, GROWTH * fast
            if fast > HIGHEST_SPEED:
                return None
        near = bracketed_root(sampled, BracketEnds(slow, sampled(slow), fast, value), NEAR * fast).b
        below, step = near, NEAR * near  # the refined least is below that of the samples, and so is its root
        while (least := margin(below)) <= 0.0:  # it is positive at the slowest speed
            near, value, below, step = below, least, max(below - step, SLOW * self.omega), 4.0 * step
        root = bracketed_root(margin, BracketEnds(below, least, near, value), LAST * near).b
        return LiftOff(root, self.least_at_speed(root).theta)


@frozen(eq=False)
class ContactMap:
    """Contact force over cam angle and speed.

    Attributes
    ----------
    theta : ndarray (n,) [rad]
    omega : ndarray (m,) [rad/s]
    force : ndarray (m, n) [N]
    zero : ndarray (2, n) [rad/s]
        Speeds at which the force is zero at each angle; NaN where it is not.
    """

    theta: np.ndarray
    omega: np.ndarray
    force: np.ndarray
    zero: np.ndarray


def contact_map(contact: ContactForce, theta: np.ndarray, omega: np.ndarray) -> ContactMap:
    """Contact force over cam angle and speed, with its zero line.

    The zero line is exact without friction in pairs; otherwise it is interpolated between neighbouring speeds, linearly
    in the square of the speed.

    Parameters
    ----------
    contact : ContactForce
    theta : ndarray (n,) [rad]
        Cam angles.
    omega : ndarray (m,) [rad/s]
        Rising positive speeds.

    Returns
    -------
    ContactMap
    """
    angles = contact.program.angles(theta)
    if not contact.has_friction:
        terms = contact.terms(angles)
        return ContactMap(theta, omega, np.nan_to_num(terms.force(omega[:, None])), terms.roots())
    force = np.nan_to_num([contact.at_speed(angles, float(speed)) for speed in omega])
    zero = np.full((2, theta.size), np.nan)
    square = omega * omega
    for j in range(theta.size):
        rows = np.flatnonzero(force[:-1, j] * force[1:, j] < 0.0)[:2]
        fraction = force[rows, j] / (force[rows, j] - force[rows + 1, j])
        zero[: rows.size, j] = np.sqrt(square[rows] + fraction * (square[rows + 1] - square[rows]))
    return ContactMap(theta, omega, force, zero)
