"""Linkage: arm pin and roller centre of the lift, with velocity and acceleration, from the slider's motion."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks import peers
from benchmarks.plain import (
    BETA0,
    L0,
    PHI0,
    PIVOT,
    G,
    arm_pin,
    differences,
    displacement,
    given,
    roller,
    splined,
    tabled,
    turn,
)
from benchmarks.table import Channels, Kernel, Method

from core.followers import built
from core.mechanism import solve_mechanism

START = np.array([PHI0, BETA0])


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
def printed(there: Any, setting: None) -> Channels:
    """Shin1995 (9), (10) by the tangent of the half angle, the sign that fits the base position; then (11)-(14)."""
    y = there.motion.y
    slider, h, l1, l2 = L0 + y[0], G.guide_height, G.slider_arm, G.rod
    a, b, c = 2.0 * slider * l1, 2.0 * h * l1, l2**2 - slider**2 - l1**2 - h**2
    d, e, f = 2.0 * slider * l2, 2.0 * h * l2, l1**2 - slider**2 - l2**2 - h**2

    def half(p: Any, q: Any, r: Any, sign: float) -> Any:
        return 2.0 * np.arctan((-q + sign * np.sqrt(p * p + q * q - r * r)) / (r - p))

    at_base = [2.0 * L0 * l1, b, l2**2 - L0**2 - l1**2 - h**2], [2.0 * L0 * l2, e, l1**2 - L0**2 - l2**2 - h**2]
    signs = [
        min((1.0, -1.0), key=lambda s, row=row, goal=goal: abs(np.exp(1j * half(*row, s)) - np.exp(1j * goal)))
        for row, goal in zip(at_base, (PHI0, BETA0), strict=True)
    ]
    phi, beta = half(a, b, c, signs[0]), half(d, e, f, signs[1])
    return _carried(phi, beta, *_rates(phi, beta, y))


def _loop(x: np.ndarray, slider: float) -> list[float]:
    """The loop equation and its solution's place."""
    phi, beta = x
    return [
        G.slider_arm * np.cos(phi) + G.rod * np.cos(beta) - slider,
        G.slider_arm * np.sin(phi) + G.rod * np.sin(beta) - G.guide_height,
    ]


def _each(there: Any, solve: Any) -> Channels:
    """Angle by angle, each from the one before."""
    x, found = START, []
    for slider in (L0 + there.motion.y[0]).tolist():
        x = solve(x, slider)
        found.append(x)
    phi, beta = np.array(found).T
    return _carried(phi, beta, *_rates(phi, beta, there.motion.y))


def newton(there: Any, tolerance: float) -> Channels:
    from scipy.optimize import fsolve

    return _each(there, lambda x, slider: fsolve(_loop, x, args=(slider,), xtol=tolerance))


def hybrid(there: Any, tolerance: float) -> Channels:
    from scipy.optimize import root

    return _each(there, lambda x, slider: root(_loop, x, args=(slider,), method="hybr", tol=tolerance).x)


def finite_differences(there: Any, step: float) -> Channels:
    """Positions by circles that meet; their derivatives by central differences."""
    ends = (arm_pin, roller)
    moved = [d for end in ends for d in differences(lambda t, end=end: end(displacement(t)), there.theta, step)]
    return [*moved, _rod(displacement(there.theta), moved[0])]


def _rod(y: np.ndarray, pin: np.ndarray) -> np.ndarray:
    """Direction from the arm's pin to the slider's."""
    return (PIVOT + L0 + y + 1j * G.guide_height - pin) / G.rod


def table(there: Any, points: int) -> Channels:
    def exact(theta: np.ndarray) -> list[np.ndarray]:
        return list(ours(given(theta), None))

    return tabled(points, exact, there.theta)


def spline(there: Any, points: int) -> Channels:
    curves = [splined(points, lambda t, end=end: end(displacement(t))) for end in (arm_pin, roller)]
    moved = [curve(there.theta, order) for curve in curves for order in range(3)]
    return [*moved, _rod(displacement(there.theta), moved[0])]


TOLERANCES = (1e-10, 1e-2, 1e-5)

KERNEL = Kernel(
    "linkage",
    "Linkage: positions, velocities, accelerations",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("tangent substitution, printed (7)-(14)", printed),
        Method("Newton (fsolve)", newton, TOLERANCES, "xtol", one_by_one=True),
        Method("Powell hybrid (root)", hybrid, TOLERANCES, "tol", one_by_one=True),
        Method("finite differences", finite_differences, (1e-4, 1e-1, 1e-2, 1e-3, 1e-5, 1e-6), "step"),
        Method("linear table", table, (3600, 90, 360, 36_000), "points"),
        Method("cubic spline", spline, (3600, 90, 360, 36_000), "points"),
        Method("pylinkage's formulas in a loop of one's own, compiled by numba", peers.pylinkage, needs=("pylinkage", "numba")),
        Method("pylinkage's formulas in a loop of one's own", peers.pylinkage_plain, needs=("pylinkage",), one_by_one=True),
        Method("mechanism", peers.mechanism, needs=("mechanism",), one_by_one=True),
    ),
    roundings=2 + 6 + 6 + 4 * 4 + 24,  # of the linkage's own tests, and 24 of the motion
    digits=1.2e-14,
)
