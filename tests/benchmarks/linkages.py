"""Linkage: arm pin and roller centre of the lift, with velocity and acceleration, from the slider's motion."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.plain import (
    ALSO,
    FEW,
    HAND,
    L0,
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
    warm="tables; KINDYNA's plan for solving the linkage",
)
