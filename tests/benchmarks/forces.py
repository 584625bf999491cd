"""Forces: contact force and drive torque of the lift, friction included, from linkage and cam."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.linkages import by_hand as linkage_by_hand
from benchmarks.plain import (
    ALSO,
    L0,
    PIVOT,
    POINTS,
    SENSE,
    G,
    again,
    by_table,
    given,
    knots,
    motion_at,
    turn,
)
from benchmarks.table import Channels, Kernel, Method

from core.dynamics import newton_euler


def ours(there: Any, setting: None) -> Channels:
    """And every pin's force besides."""
    told = newton_euler(there.kinematics, there.shape, there.loading, there.omega)
    return told.contact, told.torque


def _cross(a: Any, b: Any) -> Any:
    return a.real * b.imag - a.imag * b.real


def _statics(
    loading: Any, omega: float, push: Any, way: np.ndarray, normal: np.ndarray, places: Any, gains: Any
) -> Channels:
    """Body by body: the slider's guide by the rod's moments, what the rod leaves to the arm, the contact by the arm's moments
    about its pivot. places, gains: arm pin, slider pin and, of places alone, roller; all along the x axis of the guide."""
    masses = {mass.body: mass for mass in loading.masses}
    arm, rod, slider = (masses[name] for name in ("arm", "rod", "slider"))
    (pin, pin_a, roller), (gain, gain_a) = places, gains
    square, at_arm, at_rod = omega * omega, arm.inertia.centre / G.slider_arm, rod.inertia.centre.real / G.rod
    from_pivot, along = pin - PIVOT, pin_a - pin
    turned = gain_a - gain
    lost_arm = arm.inertia.mass * (arm.gravity - square * at_arm * gain)
    lost_rod = rod.inertia.mass * (rod.gravity - square * (gain + at_rod * turned))
    carried = slider.inertia.mass * (slider.gravity - square * gain_a) + push
    spin = rod.inertia.about_centre * square / G.rod**2 * _cross(along, turned)
    moment = spin - at_rod * _cross(along, lost_rod) - _cross(along, carried)
    sign = np.sign(moment / along.real)
    grip = loading.friction * way * sign  # the guide's force turns by so much
    guide = moment / (along.real + grip * along.imag)
    at_pin = lost_rod + carried
    at_pin.real -= guide * grip
    at_pin.imag += guide
    lever = _cross(roller - PIVOT, normal)
    held = _cross(from_pivot, at_pin) + _cross(at_arm * from_pivot, lost_arm)
    held -= arm.inertia.about_centre * square / G.slider_arm**2 * _cross(from_pivot, gain)
    contact = held / lever
    return contact, -SENSE * contact * _cross(roller, normal)


def by_hand(there: Any, setting: None) -> Channels:
    bodies, loading = there.kinematics.bodies, there.loading
    places = bodies["rod"].origin[0], bodies["slider"].origin[0], there.kinematics.follower.origin[0]
    gains = bodies["rod"].origin[2], bodies["slider"].origin[2]
    push = loading.others[0].force
    return _statics(loading, there.omega, push, there.motion.velocity_sign, there.shape.flank.normal, places, gains)


def at_knots(theta: np.ndarray) -> Channels:
    """What a table of forces holds: motion, linkage, cam and forces by hand."""
    there = motion_at(theta)
    y, speed, gain = there.motion.y
    pin, _, pin_gain, roller, roller_speed, _, _ = linkage_by_hand(there, None)
    normal = (roller_speed - 1j * SENSE * roller) * (-1j * SENSE)
    normal /= np.sqrt(normal.real * normal.real + normal.imag * normal.imag)
    places = pin, PIVOT + L0 + y + 1j * G.guide_height, roller
    way = np.sign(speed)
    return _statics(LOADING, OMEGA, LOADING.others[0].force, way, normal, places, (pin_gain, gain + 0j))


def cubic(there: Any, points: int) -> Any:
    from scipy.interpolate import CubicSpline

    at = knots(points)
    return CubicSpline(at, np.array(at_knots(at)), axis=1)


_SHOWN = given(turn(4))
LOADING, OMEGA = _SHOWN.loading, _SHOWN.omega

KERNEL = Kernel(
    "torque",
    "Contact force and torque",
    given=given,
    again=again,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand, body by body", by_hand, special=True),
        *by_table(at_knots),
        Method("cubic spline", lambda there, curve: curve(there.theta), POINTS[:7], "points", keeps=cubic),
    ),
    handed="the solved linkage: places, angles, velocities and accelerations of all bodies; normal of the cam, masses, loads"
    + ALSO,
    warm="tables and splines",
)
