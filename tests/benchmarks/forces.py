"""Forces: contact force and drive torque of the lift, friction included, from linkage and cam."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.linkages import by_hand as linkage_by_hand
from benchmarks.plain import (
    ALSO,
    L0,
    ON_GRID,
    PIVOT,
    POINTS,
    SENSE,
    G,
    again,
    as_far_apart,
    by_table,
    differences_on,
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


def _nine(
    there: Any, points: dict[str, np.ndarray], gains: dict[str, np.ndarray], spins: dict[str, np.ndarray]
) -> Channels:
    """Three bodies cut free and the camshaft: nine equations for pivot, arm pin, slider pin, guide, contact and torque,
    built and solved for all angles at once; friction takes the sign of the guide's force without it."""
    way, loading = there.motion.velocity_sign, there.loading
    masses = {mass.body: mass for mass in loading.masses}
    normal, axis = there.shape.flank.normal, there.kinematics.pairs["guide"].axis
    mu, n = loading.friction, way.size
    pivot, pin_b, pin_a, reference = (points[k] for k in ("pivot", "arm_pin", "slider_pin", "roller"))
    lost = {k: masses[k].inertia.mass * (masses[k].gravity - there.omega**2 * gains[k]) for k in gains}
    push = loading.others[0].size(there.kinematics) * axis

    def solved(sign: np.ndarray) -> np.ndarray:
        guide = 1j * axis - mu * way * sign * axis
        a, b = np.zeros((n, 9, 9)), np.zeros((n, 9))
        # columns: pivot x y, arm pin x y, slider pin x y, guide, contact, torque
        for row, entries, given_force in (
            (0, ((0, 1.0), (1, 1j), (2, 1.0), (3, 1j), (7, -normal)), lost["arm"]),
            (3, ((2, -1.0), (3, -1j), (4, -1.0), (5, -1j)), lost["rod"]),
            (6, ((4, 1.0), (5, 1j), (6, guide)), lost["slider"] + push),
        ):
            for column, force in entries:
                a[:, row, column], a[:, row + 1, column] = np.real(force), np.imag(force)
            b[:, row], b[:, row + 1] = -given_force.real, -given_force.imag
        for row, body, entries in (
            (2, "arm", ((0, pivot, 1.0), (1, pivot, 1j), (2, pin_b, 1.0), (3, pin_b, 1j), (7, reference, -normal))),
            (5, "rod", ((2, pin_b, -1.0), (3, pin_b, -1j), (4, pin_a, -1.0), (5, pin_a, -1j))),
        ):
            for column, place, force in entries:
                a[:, row, column] = _cross(place, np.asarray(force))
            spin = masses[body].inertia.about_centre * there.omega**2 * spins[body]
            b[:, row] = -(_cross(points[f"{body}_centre"], lost[body]) - spin)
        a[:, 8, 8], a[:, 8, 7] = SENSE, _cross(reference, normal)
        return np.asarray(np.linalg.solve(a, b[..., None])[..., 0])

    first = solved(np.zeros(n))
    told = solved(np.sign(first[:, 6])) if mu else first
    return told[:, 7], told[:, 8]


def generic(there: Any, setting: None) -> Channels:
    bodies, loading = there.kinematics.bodies, there.loading
    points = {
        "pivot": bodies["arm"].origin[0], "arm_pin": bodies["rod"].origin[0], "slider_pin": bodies["slider"].origin[0],
        "roller": there.kinematics.follower.origin[0],
    }  # fmt: skip
    gains = {}
    for name, inertia in ((m.body, m.inertia) for m in loading.masses):
        pose, arm = bodies[name], inertia.centre * bodies[name].unit
        points[f"{name}_centre"] = pose.origin[0] + arm
        gains[name] = pose.origin[2] + (1j * pose.turn[2] - pose.turn[1] ** 2) * arm
    return _nine(there, points, gains, {name: bodies[name].turn[2] for name in ("arm", "rod")})


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


def on_grid(there: Any, setting: tuple[int, int]) -> Channels:
    """Accelerations by differences between the places that are given, forces by hand."""
    bodies, loading = there.kinematics.bodies, there.loading
    places = bodies["rod"].origin[0], bodies["slider"].origin[0], there.kinematics.follower.origin[0]
    gains = [differences_on(z, there.theta[1] - there.theta[0], *setting)[1] for z in places[:2]]
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
        Method("nine equations at once", generic, special=True),
        Method(
            "differences between the given places, by hand",
            on_grid,
            ON_GRID,
            "order, every",
            special=True,
            on_grid=True,
            scaled=as_far_apart,
        ),
        *by_table(at_knots),
        Method("cubic spline", lambda there, curve: curve(there.theta), POINTS[:7], "points", keeps=cubic),
    ),
    roundings=34 + 22 + 30 + 24,  # as in the forces' own tests, and 24 of the motion
    digits=5e-15,
    handed="the solved linkage: places, angles, velocities and accelerations of all bodies; normal of the cam, masses, loads"
    + ALSO,
    warm="tables and splines",
)
