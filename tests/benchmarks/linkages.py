"""Linkage: arm pin and roller centre of the lift, with velocity and acceleration, from the slider's motion."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.plain import (
    ALSO,
    BETA0,
    FEW,
    HAND,
    L0,
    PHI0,
    PIVOT,
    SIDE,
    G,
    by_table,
    given,
    hermite,
    knots,
    motion_at,
    turn,
)
from benchmarks.table import Channels, Kernel, Method

from core.followers import built
from core.mechanism import solve_mechanism


def ours(there: Any, setting: None) -> Channels:
    """Third derivatives, which only the cam's curvature asks for, are not made."""
    kinematics = solve_mechanism(built(there.follower, there.cam), there.motion)
    rod = kinematics.bodies["rod"]
    return [*(pose.origin[order] for pose in (rod, kinematics.follower) for order in range(3)), rod.unit]


def _carried(phi: np.ndarray, beta: np.ndarray, speed: np.ndarray, gain: np.ndarray) -> Channels:
    """Pin and roller of an arm, and the direction of a rod, at these angles."""
    pin = G.slider_arm * np.exp(1j * phi)
    ends = (pin, pin * (G.roller_arm / G.slider_arm) * np.exp(1j * G.fixed_angle))
    moved = [d for z in ends for d in (PIVOT + z, 1j * speed * z, (1j * gain - speed * speed) * z)]
    return [*moved, np.exp(1j * beta)]


def _rates(phi: np.ndarray, beta: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """φ', φ'' (11)-(14)."""
    l1, l2 = G.slider_arm, G.rod
    b1 = y[1] * np.cos(phi) / (l2 * np.sin(phi - beta))
    p1 = y[1] * np.cos(beta) / (l1 * np.sin(beta - phi))
    p2 = (y[2] * np.cos(beta) + l1 * p1 * p1 * np.cos(phi - beta) + l2 * b1 * b1) / (l1 * np.sin(beta - phi))
    return p1, p2


@np.errstate(invalid="ignore", divide="ignore")
def by_hand(there: Any, setting: None, g: Any = HAND) -> Channels:
    """Two circles that meet; the loop equation's two derivatives by unit vectors of arm and rod."""
    l1, l2 = g.slider_arm, g.rod
    y, speed, gain = there.motion.y[:3]
    to = (g.base + y) + 1j * g.guide_height
    square = to.real * to.real + g.guide_height**2
    along = (0.5 * (l1 * l1 - l2 * l2)) / square + 0.5
    pin = np.empty(to.shape, dtype=complex)
    pin.real, pin.imag = along, SIDE * np.sqrt((l1 * l1) / square - along * along)
    pin *= to
    rod = (to - pin) / l2
    across = rod.real * pin.imag - rod.imag * pin.real
    arm_speed, rod_speed = -speed * rod.real / across, speed * pin.real / (l2 * across)
    push = (
        gain * rod.real
        + arm_speed * arm_speed * (rod.real * pin.real + rod.imag * pin.imag)
        + l2 * rod_speed * rod_speed
    )
    turned, turning = 1j * arm_speed * pin, np.empty(to.shape, dtype=complex)
    turning.real, turning.imag = -arm_speed * arm_speed, -push / across
    turning *= pin
    ahead = (g.roller_arm / l1) * np.exp(1j * g.fixed_angle)
    return [g.pivot + pin, turned, turning, g.pivot + ahead * pin, ahead * turned, ahead * turning, rod]


def newton_at_once(there: Any, steps: int) -> Channels:
    """Newton's method for all angles at once, each from the base position."""
    slider, l1, l2 = L0 + there.motion.y[0], G.slider_arm, G.rod
    phi, beta = np.full(slider.shape, PHI0), np.full(slider.shape, BETA0)
    for _ in range(steps):
        c, s, cb, sb = np.cos(phi), np.sin(phi), np.cos(beta), np.sin(beta)
        f, g = l1 * c + l2 * cb - slider, l1 * s + l2 * sb - G.guide_height
        across = s * cb - c * sb
        phi, beta = phi + (f * cb + g * sb) / (l1 * across), beta - (f * c + g * s) / (l2 * across)
    return _carried(phi, beta, *_rates(phi, beta, there.motion.y))


def _with_roller(there: Any, pin: np.ndarray, speed: np.ndarray, gain: np.ndarray) -> Channels:
    """The roller stands on the arm with the pin; the rod lies between that and the slider."""
    ahead = (G.roller_arm / G.slider_arm) * np.exp(1j * G.fixed_angle)
    rod = (PIVOT + L0 + there.motion.y[0] + 1j * G.guide_height - pin) / G.rod
    return [pin, speed, gain, PIVOT + ahead * (pin - PIVOT), ahead * speed, ahead * gain, rod]


def quintic(there: Any, points: int) -> Any:
    at = knots(points)
    return hermite(at, *by_hand(motion_at(at), None)[:3])


KERNEL = Kernel(
    "linkage",
    "Linkage: positions, velocities, accelerations",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand, special=True),
        Method("Newton, all angles at once", newton_at_once, (6, 3, 4, 5), "steps"),
        *by_table(lambda at: by_hand(motion_at(at), None)),
        Method(
            "quintic table",
            lambda there, table: _with_roller(there, *table.at(there.theta, 0, 1, 2)),
            FEW,
            "points",
            keeps=quintic,
        ),
    ),
    handed="displacement, velocity and acceleration of the slider; lengths and the base position" + ALSO,
    warm="tables; what KINDYNA knows of the plan by which a linkage is solved",
)
