"""Forces: contact force and drive torque of the lift, friction included, from linkage and cam."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks import compiled
from benchmarks.linkages import by_hand as linkage_by_hand
from benchmarks.plain import (
    ALSO,
    HAND,
    POINTS,
    ROLLER_RADIUS,
    SENSE,
    again,
    by_table,
    given,
    knots,
    motion_at,
    turn,
)
from benchmarks.table import Channels, Kernel, Method
from mechanisms import LIFT

from core.design import Design, get, put
from core.dynamics import newton_euler
from core.study import Study


def ours(there: Any, setting: None) -> Channels:
    """And every pin's force besides."""
    told = newton_euler(there.kinematics, there.shape, there.loading, there.omega)
    return told.contact, told.torque


def _cross(a: Any, b: Any) -> Any:
    return a.real * b.imag - a.imag * b.real


def statics(
    loading: Any, omega: Any, push: Any, way: np.ndarray, normal: np.ndarray, places: Any, gains: Any, g: Any = HAND
) -> Channels:
    """Body by body: the slider's guide by the rod's moments, what the rod leaves to the arm, the contact by the arm's moments
    about its pivot. places, gains: arm pin, slider pin and, of places alone, roller; all along the x axis of the guide."""
    masses = {mass.body: mass for mass in loading.masses}
    arm, rod, slider = (masses[name] for name in ("arm", "rod", "slider"))
    (pin, pin_a, roller), (gain, gain_a) = places, gains
    # the rod's centre is a part of its length, whatever that is
    square, at_arm, at_rod = omega * omega, arm.inertia.centre / g.slider_arm, rod.inertia.centre.real / HAND.rod
    from_pivot, along = pin - g.pivot, pin_a - pin
    turned = gain_a - gain
    lost_arm = arm.inertia.mass * (arm.gravity - square * at_arm * gain)
    lost_rod = rod.inertia.mass * (rod.gravity - square * (gain + at_rod * turned))
    carried = slider.inertia.mass * (slider.gravity - square * gain_a) + push
    spin = rod.inertia.about_centre * square / g.rod**2 * _cross(along, turned)
    moment = spin - at_rod * _cross(along, lost_rod) - _cross(along, carried)
    sign = np.sign(moment / along.real)
    grip = loading.friction * way * sign  # the guide's force turns by so much
    guide = moment / (along.real + grip * along.imag)
    at_pin = lost_rod + carried
    at_pin.real -= guide * grip
    at_pin.imag += guide
    lever = _cross(roller - g.pivot, normal)
    held = _cross(from_pivot, at_pin) + _cross(at_arm * from_pivot, lost_arm)
    held -= arm.inertia.about_centre * square / g.slider_arm**2 * _cross(from_pivot, gain)
    contact = held / lever
    return contact, -SENSE * contact * _cross(roller, normal)


def by_hand(there: Any, setting: None) -> Channels:
    bodies, loading = there.kinematics.bodies, there.loading
    places = bodies["rod"].origin[0], bodies["slider"].origin[0], there.kinematics.follower.origin[0]
    gains = bodies["rod"].origin[2], bodies["slider"].origin[2]
    push = loading.others[0].force
    return statics(loading, there.omega, push, there.motion.velocity_sign, there.shape.flank.normal, places, gains)


def of_motion(there: Any, loading: Any, omega: Any, way: np.ndarray, g: Any = HAND) -> tuple[Any, Any, Channels]:
    """Motion, linkage, cam and forces by hand: roller, the cam's normal there; contact force and torque."""
    y, _, push = there.motion.y
    pin, _, pin_gain, roller, roller_speed, _, _ = linkage_by_hand(there, None, g)
    normal = (roller_speed - 1j * SENSE * roller) * (-1j * SENSE)
    normal /= np.sqrt(normal.real * normal.real + normal.imag * normal.imag)
    places = pin, g.pivot + g.base + y + 1j * g.guide_height, roller
    return roller, normal, statics(loading, omega, OUTPUT, way, normal, places, (pin_gain, push + 0j), g)


def at_knots(theta: np.ndarray) -> Channels:
    """What a table of forces holds: all by hand."""
    there = motion_at(theta)
    return of_motion(there, LOADING, OMEGA, np.sign(there.motion.y[1]))[2]


def cubic(there: Any, points: int) -> Any:
    from scipy.interpolate import CubicSpline

    at = knots(points)
    return CubicSpline(at, np.array(at_knots(at)), axis=1)


_SHOWN = given(turn(4))
LOADING, OMEGA, OUTPUT = _SHOWN.loading, _SHOWN.omega, _SHOWN.loading.others[0].force

KERNEL = Kernel(
    "torque",
    "Contact force and torque",
    given=given,
    again=again,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand, special=True),
        Method("compiled by numba", compiled.forces, special=True, needs=("numba",)),
        *by_table(at_knots),
        Method("cubic spline", lambda there, curve: curve(there.theta), POINTS[:7], "points", keeps=cubic),
    ),
    handed="the solved linkage: positions, angles, velocities and accelerations of all bodies; normal of the cam, masses, loads"
    + ALSO,
    warm="tables and splines",
)

# -- the whole chain, motion to torque ------------------------------------------------------------------------

_OTHER = count(1)


def anew(of: Design) -> Design:
    """One that nobody has had before."""
    by = 1e-6 * next(_OTHER)
    return put(
        put(of, "motion.start_mm", get(of, "motion.start_mm") + by), "follower.rod_mm", get(of, "follower.rod_mm") + by
    )


def our_chain(there: Any, setting: None) -> Channels:
    told = Study(there.design, angles=there.angles).dynamics
    return told.contact, told.torque


EDITS = {"length": "follower.rod_mm", "base radius": "cam.base_radius_mm", "speed": "shaft.speed_rpm"}
"""Number of the lift that an edit changes -> its path."""


def after_edit(path: str, angles: int) -> Callable[[], Channels]:
    """Contact force, torque and profile of the lift after one of its numbers has been changed; the edit itself is made beforehand."""
    design = put(LIFT, path, get(LIFT, path) * (1.0 + 1e-7 * next(_OTHER)))

    def run() -> Channels:
        study = Study(design, angles)
        told = study.dynamics
        return told.contact, told.torque, study.cam.flank.profile

    return run


def lift_by_hand() -> Channels:
    """The same of all of the lift at 3,600 angles."""
    there = motion_at(turn(3600))
    roller, normal, (contact, torque) = of_motion(there, LOADING, OMEGA, np.sign(there.motion.y[1]))
    return contact, torque, (roller + ROLLER_RADIUS * normal) * np.exp(-1j * SENSE * there.theta)


CHAIN = Kernel(
    "chain",
    "Whole chain, motion to torque",
    given=lambda theta: SimpleNamespace(
        theta=theta, design=LIFT, angles=Study(LIFT).program.angles(theta), loading=LOADING, omega=OMEGA
    ),
    again=lambda there: SimpleNamespace(**{**vars(there), "design": anew(there.design)}),
    grid=turn,
    methods=(
        Method("KINDYNA", our_chain, ours=True),
        Method("numpy by hand", lambda there, setting: at_knots(there.theta), special=True),
        Method(
            "compiled by numba",
            compiled.chain,
            special=True,
            needs=("numba",),
        ),
    ),
    handed="the design as read from its file",
    warm="KINDYNA's plan for solving the linkage",
    values="torque",
)
