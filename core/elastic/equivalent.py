"""One mass in place of an elastic follower: its equivalents in the coordinate of the motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from core.cam import envelope
from core.dynamics import Loading, ScheduledForce
from core.errors import NoAnswer
from core.frozen import frozen
from core.mechanism import DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, MotionState
from core.numerics.derivatives import Derivatives

PLACES = 17  # of the stroke, at which the natural frequency is looked at
STIFFNESS, DAMPING = "loads.follower_stiffness_n_per_mm", "loads.follower_damping_ratio"


@frozen
class Equivalent:
    """The one mass m z'' + c z' + k (z - s) + ks z = 0 in the motion's coordinate, SI; of a motion that turns all of it by angle.

    mass       m [kg, or kg m²]
    stiffness  k [N/m, or N m/rad] between the cam's motion s and the mass
    closing    ks, of closing spring, further springs and weight: the second derivative of their potential
    damping    c = 2 ζ √(m (k + ks)) and what dampers add, against the frame [N s/m, or N m s/rad]
    dampers    that part of c which the rigid follower has too
    """

    mass: float
    stiffness: float
    closing: float
    damping: float
    dampers: float = 0.0

    @property
    def natural(self) -> float:
        """ω0 = √((k + ks)/m) [rad/s], without damping."""
        return math.sqrt((self.stiffness + self.closing) / self.mass)

    @property
    def ratio(self) -> float:
        """ζ = c/(2 √(m (k + ks))), of all damping."""
        return self.damping / (2.0 * self.mass * self.natural)

    @property
    def share(self) -> float:
        """k/(k + ks): how far the mass goes where the cam goes 1, at standstill."""
        return self.stiffness / (self.stiffness + self.closing)


@frozen
class Elasticity:
    """The equivalents in the middle of the stroke; way: |dR/dy| there [m per m or rad], of the point at which the stiffness is given;
    the least and the greatest natural frequency over the stroke [rad/s]."""

    middle: Equivalent
    way: float
    lowest: float
    highest: float


def equivalent(
    mechanism: Mechanism,
    driver_ranges: DriverRanges,
    loading: Loading,
    face: Any,
    cam: Any,
    sense: float,
    stroke: tuple[float, float],
    stiffness: float,
    ratio: float,
) -> Elasticity:
    """The follower as one mass, by its equivalents in the middle of the stroke: m = J of the kinetic energy J ẏ²/2; ks = V'' of the
    potential energy; c of dampers from the heat c ẏ²; k = k_R |dR/dy|², R the roller's centre (else the contact in the middle of the
    stroke) and k_R the stiffness there along its path, so that k = k_R arm² for an arm.

    stiffness  k_R [N/m]; ratio: ζ of critical damping 2 √(m (k + ks)), of the follower on its stiffness and all springs
    stroke     lowest and highest motion [m or rad]

    Process forces and constant ones only move the place about which it vibrates, and are left out. Raises NoAnswer where there is
    no mass, the springs push it away from the cam more strongly than k holds it, or it is damped so much that nothing vibrates.
    """
    low, high = stroke
    y = np.concatenate(([0.5 * (low + high)], np.linspace(low, high, PLACES)))
    still = by_motion(mechanism, driver_ranges, y, 0.0)
    moving = by_motion(mechanism, driver_ranges, y, 1.0)
    flank = envelope(still, face, cam, sense).flank
    place = flank.contact if flank.straight else flank.reference
    held, pose = still.bodies[flank.body], moving.bodies[flank.body]
    way = pose.origin[1] + 1j * pose.turn[1] * (place - held.origin[0])
    steady = Loading(loading.masses, tuple(e for e in loading.others if not isinstance(e, ScheduledForce)))
    ways = np.broadcast_to(np.abs(way), y.size)
    k = stiffness * ways**2
    mass, closing = steady.inertia(moving, 1)[0], steady.potential(moving)[1]
    dampers = sum((element.lost(moving, 1.0) for element in steady.elements), np.zeros(y.size))
    if not (mass > 0.0).all():
        raise NoAnswer(
            "an elastic follower without a mass does not vibrate",
            "loads",
            "give its masses, or take its stiffness away",
        )
    if not (k + closing > 0.0).all():
        stronger = float((-closing / k).max())
        raise NoAnswer(
            f"weight and springs push the follower's mass away {stronger:.4g} times as strongly as its stiffness holds it",
            STIFFNESS,
            "allowed: less than once; enlarge it, or weaken them",
        )
    natural = np.sqrt((k + closing) / mass)
    damping = 2.0 * ratio * mass * natural + dampers
    found = Equivalent(float(mass[0]), float(k[0]), float(closing[0]), float(damping[0]), float(dampers[0]))
    if found.ratio >= 1.0:
        raise NoAnswer(
            f"with its dampers the follower's damping ratio is {found.ratio:.4g}: nothing vibrates",
            DAMPING,
            "allowed with them: below 1; weaken the dampers, or enlarge the stiffness",
        )
    return Elasticity(found, float(ways[0]), float(natural.min()), float(natural.max()))


def by_motion(mechanism: Mechanism, driver_ranges: DriverRanges, y: np.ndarray, speed: float) -> Kinematics:
    """The mechanism at motions (n,), at cam angle 0, with derivatives by the motion times ``speed``."""
    one, none = np.full(y.size, speed), np.zeros(y.size)
    angles = Angles(none, np.zeros(y.size, dtype=int))
    return solve_mechanism(mechanism, MotionState(angles, Derivatives.of((y, one, none, none)), one), driver_ranges)
