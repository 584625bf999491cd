"""Linkage: arm pin and roller centre of the lift, with velocity and acceleration, from the slider's motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from benchmarks import peers
from benchmarks.plain import (
    ALSO,
    BETA0,
    FEW,
    L0,
    ON_GRID,
    PHI0,
    PIVOT,
    POINTS,
    STEPS,
    G,
    arm_pin,
    as_far_apart,
    by_table,
    differences,
    differences_on,
    displacement,
    given,
    hermite,
    knots,
    motion_at,
    splined,
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


def _side() -> float:
    """+1 where the arm's pin lies left of the line from the pivot to the slider's."""
    return math.copysign(1.0, L0 * math.sin(PHI0) - G.guide_height * math.cos(PHI0))


@np.errstate(invalid="ignore", divide="ignore")
def by_hand(there: Any, setting: None) -> Channels:
    """Two circles that meet; the loop equation's two derivatives by unit vectors of arm and rod."""
    l1, l2 = G.slider_arm, G.rod
    y, speed, gain = there.motion.y[:3]
    to = (L0 + y) + 1j * G.guide_height
    square = to.real * to.real + G.guide_height**2
    along = (0.5 * (l1 * l1 - l2 * l2)) / square + 0.5
    pin = np.empty(y.shape, dtype=complex)
    pin.real, pin.imag = along, _side() * np.sqrt((l1 * l1) / square - along * along)
    pin *= to
    rod = (to - pin) / l2
    across = rod.real * pin.imag - rod.imag * pin.real
    arm_speed, rod_speed = -speed * rod.real / across, speed * pin.real / (l2 * across)
    push = (
        gain * rod.real
        + arm_speed * arm_speed * (rod.real * pin.real + rod.imag * pin.imag)
        + l2 * rod_speed * rod_speed
    )
    turned, turning = 1j * arm_speed * pin, np.empty(y.shape, dtype=complex)
    turning.real, turning.imag = -arm_speed * arm_speed, -push / across
    turning *= pin
    ahead = (G.roller_arm / l1) * np.exp(1j * G.fixed_angle)
    return [PIVOT + pin, turned, turning, PIVOT + ahead * pin, ahead * turned, ahead * turning, rod]


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


def _loop(x: np.ndarray, slider: float) -> list[float]:
    """The loop equation."""
    phi, beta = x.tolist()
    return [
        G.slider_arm * math.cos(phi) + G.rod * math.cos(beta) - slider,
        G.slider_arm * math.sin(phi) + G.rod * math.sin(beta) - G.guide_height,
    ]


def _loop_slopes(x: np.ndarray, slider: float) -> list[list[float]]:
    """Its derivatives by φ and β."""
    phi, beta = x.tolist()
    return [
        [-G.slider_arm * math.sin(phi), -G.rod * math.sin(beta)],
        [G.slider_arm * math.cos(phi), G.rod * math.cos(beta)],
    ]


def newton(there: Any, tolerance: float) -> Channels:
    """Angle by angle, each from the one before."""
    from scipy.optimize import fsolve

    x, found = START, []
    for slider in (L0 + there.motion.y[0]).tolist():
        x = fsolve(_loop, x, args=(slider,), fprime=_loop_slopes, xtol=tolerance)
        found.append(x)
    phi, beta = np.array(found).T
    return _carried(phi, beta, *_rates(phi, beta, there.motion.y))


def _with_roller(there: Any, pin: np.ndarray, speed: np.ndarray, gain: np.ndarray) -> Channels:
    """The roller stands on the arm with the pin; the rod lies between that and the slider."""
    ahead = (G.roller_arm / G.slider_arm) * np.exp(1j * G.fixed_angle)
    rod = (PIVOT + L0 + there.motion.y[0] + 1j * G.guide_height - pin) / G.rod
    return [pin, speed, gain, PIVOT + ahead * (pin - PIVOT), ahead * speed, ahead * gain, rod]


def _pin_at(theta: np.ndarray) -> np.ndarray:
    return arm_pin(displacement(theta))


def finite_differences(there: Any, step: float) -> Channels:
    """Positions by circles that meet; their derivatives by central differences."""
    return _with_roller(there, *differences(_pin_at, there.theta, step))


def on_grid(there: Any, setting: tuple[int, int]) -> Channels:
    """The same between the cam angles that are given."""
    pin = arm_pin(there.motion.y[0])
    return _with_roller(there, pin, *differences_on(pin, there.theta[1] - there.theta[0], *setting))


def cubic(there: Any, points: int) -> Any:
    return splined(points, _pin_at)


def quintic(there: Any, points: int) -> Any:
    at = knots(points)
    return hermite(at, *by_hand(motion_at(at), None)[:3])


def from_curve(there: Any, curve: Any) -> Channels:
    return _with_roller(there, *(curve(there.theta, order) for order in range(3)))


TOLERANCES = (1e-10, 1e-2, 1e-5)

KERNEL = Kernel(
    "linkage",
    "Linkage: positions, velocities, accelerations",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand, special=True),
        Method("tangent substitution, printed (7)-(14)", printed, special=True),
        Method("Newton, all angles at once", newton_at_once, (6, 3, 4, 5), "steps"),
        Method("Newton (fsolve)", newton, TOLERANCES, "xtol", one_by_one=True),
        Method("finite differences", finite_differences, STEPS, "step", special=True),
        Method(
            "differences between the given angles",
            on_grid,
            ON_GRID,
            "order, every",
            special=True,
            on_grid=True,
            scaled=as_far_apart,
        ),
        *by_table(lambda at: by_hand(motion_at(at), None)),
        Method("cubic spline", from_curve, POINTS, "points", keeps=cubic),
        Method(
            "quintic table",
            lambda there, table: _with_roller(there, *table.at(there.theta, 0, 1, 2)),
            FEW,
            "points",
            keeps=quintic,
        ),
        Method("pylinkage's formulas, numba", peers.pylinkage, needs=("pylinkage", "numba"), special=True),
        Method("pylinkage's formulas", peers.pylinkage_plain, needs=("pylinkage",), special=True, one_by_one=True),
        Method("mechanism", peers.mechanism, needs=("mechanism", "matplotlib"), one_by_one=True),
    ),
    roundings=2 + 6 + 6 + 4 * 4 + 24,  # of the linkage's own tests, and 24 of the motion
    digits=1.2e-14,
    handed="displacement, velocity and acceleration of the slider; lengths and the base position" + ALSO,
    warm="tables and splines; what KINDYNA knows of the plan by which a linkage is solved",
)
