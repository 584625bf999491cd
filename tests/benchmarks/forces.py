"""Forces: contact force and drive torque of the lift, friction included, from linkage and cam."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.plain import SENSE, G, displacement, given, tabled, turn
from benchmarks.plain import arm_pin as pin_at
from benchmarks.plain import roller as roller_at
from benchmarks.table import Channels, Kernel, Method

from core.dynamics import newton_euler


def ours(there: Any, setting: None) -> Channels:
    """And every pin's force besides."""
    told = newton_euler(there.kinematics, there.shape, there.loading, there.omega)
    return told.contact, told.torque


def _cross(a: Any, b: Any) -> Any:
    return (np.conjugate(a) * b).imag


def _nine(there: Any, points: dict[str, np.ndarray], gains: dict[str, np.ndarray], spins: dict[str, np.ndarray]) -> Channels:
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
                a[:, row, column] = _cross(place, force)
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
        "pivot": bodies["arm"].z[0], "arm_pin": bodies["rod"].z[0], "slider_pin": bodies["slider"].z[0],
        "roller": there.kinematics.follower.z[0],
    }  # fmt: skip
    gains = {}
    for name, inertia in ((m.body, m.inertia) for m in loading.masses):
        centre = bodies[name].carried(inertia.centre).all
        points[f"{name}_centre"], gains[name] = centre[0], centre[2]
    return _nine(there, points, gains, {name: bodies[name].angle[2] for name in ("arm", "rod")})


def finite_differences(there: Any, step: float) -> Channels:
    """Positions at three neighbouring angles give the accelerations; forces as above."""
    masses = {mass.body: mass for mass in there.loading.masses}
    pivot = complex(G.pivot_x, G.pivot_y)

    def positions(theta: np.ndarray) -> dict[str, np.ndarray]:
        y = displacement(theta)
        pin, end = pin_at(y), roller_at(y)
        slider = pivot + there.kinematics.base["slider"][0] + y + 1j * G.guide_height
        along = (pin - pivot) / G.slider_arm
        return {
            "pivot": np.full(theta.size, pivot), "arm_pin": pin, "slider_pin": slider, "roller": end,
            "arm_centre": pivot + along * masses["arm"].inertia.centre,
            "rod_centre": pin + (slider - pin) / G.rod * masses["rod"].inertia.centre, "slider_centre": slider,
            "arm_angle": np.unwrap(np.angle(along)), "rod_angle": np.unwrap(np.angle(slider - pin)),
        }  # fmt: skip

    before, here, after = (positions(there.theta + k * step) for k in (-1, 0, 1))
    second = {k: (after[k] - 2.0 * here[k] + before[k]) / step**2 for k in here}
    return _nine(
        there,
        here,
        {name: second[f"{name}_centre"] for name in ("arm", "rod", "slider")},
        {name: second[f"{name}_angle"] for name in ("arm", "rod")},
    )


def table(there: Any, points: int) -> Channels:
    return tabled(points, lambda theta: list(ours(given(theta), None)), there.theta)


def spline(there: Any, points: int) -> Channels:
    from scipy.interpolate import CubicSpline

    knots = turn(points + 1) * (points + 1) / points
    return [CubicSpline(knots, column)(there.theta) for column in ours(given(knots), None)]


KERNEL = Kernel(
    "torque",
    "Contact force and torque",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("nine equations at once", generic),
        Method("finite differences, nine equations", finite_differences, (1e-4, 1e-2, 1e-3, 1e-5, 1e-6), "step"),
        Method("linear table", table, (3600, 90, 360, 36_000), "points"),
        Method("cubic spline", spline, (3600, 90, 360, 36_000), "points"),
    ),
    roundings=34 + 22 + 30 + 24,  # as in the forces' own tests, and 24 of the motion
    digits=5e-15,
)
