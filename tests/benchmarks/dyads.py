"""General linkages dyad by dyad: joint B of a crank-rocker, with velocity and acceleration, at any crank angles."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks import peers
from benchmarks.exact_dyads import LENGTHS
from benchmarks.plain import (
    FEW,
    ON_GRID,
    POINTS,
    STEPS,
    as_far_apart,
    by_table,
    differences,
    differences_on,
    hermite,
    knots,
    splined,
    turn,
)
from benchmarks.table import Channels, Kernel, Method
from linkages import four_bar

from core.mechanism import at_driver, course_of

GROUND, CRANK, COUPLER, ROCKER = LENGTHS


def given(theta: np.ndarray) -> SimpleNamespace:
    return SimpleNamespace(theta=theta, mechanism=four_bar(*LENGTHS).drive.mechanism)


def _on_rocker(turned: np.ndarray, speed: Any, gain: Any) -> Channels:
    """B from the rocker's unit vector (n,), angular velocity and acceleration."""
    u = ROCKER * turned
    return [GROUND + u, 1j * speed * u, (1j * gain - speed * speed) * u]


def ours(there: Any, setting: None) -> Channels:
    """Joint B of the rocker, as any view asks for it."""
    pose = course_of(there.mechanism).solve(at_driver(there.theta)).poses[4]
    return _on_rocker(pose.unit, pose.turn[1], pose.turn[2])


def _rates(theta: np.ndarray, phi: np.ndarray, psi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angular velocity and acceleration of the rocker from those of crank and coupler (any textbook)."""
    across = np.sin(psi - phi)
    coupler = CRANK * np.sin(theta - psi) / (COUPLER * across)
    rocker = CRANK * np.sin(theta - phi) / (ROCKER * across)
    gain = CRANK * np.cos(theta - phi) + COUPLER * coupler**2 - ROCKER * rocker**2 * np.cos(psi - phi)
    return rocker, gain / (ROCKER * across)


@np.errstate(invalid="ignore", divide="ignore")
def half_angle(there: Any, setting: None) -> Channels:
    """Freudenstein's equation by the tangent of the half angle, for rocker and coupler."""
    c, s = np.cos(there.theta), np.sin(there.theta)
    k1, k2 = GROUND / CRANK, GROUND / ROCKER
    k3 = (CRANK**2 - COUPLER**2 + ROCKER**2 + GROUND**2) / (2.0 * CRANK * ROCKER)
    a, b, e = c - k1 - k2 * c + k3, -2.0 * s, k1 - (k2 + 1.0) * c + k3
    psi = 2.0 * np.arctan((-b - np.sqrt(b * b - 4.0 * a * e)) / (2.0 * a))
    k4, k5 = GROUND / COUPLER, (ROCKER**2 - GROUND**2 - CRANK**2 - COUPLER**2) / (2.0 * CRANK * COUPLER)
    a, b, e = c - k1 + k4 * c + k5, -2.0 * s, k1 + (k4 - 1.0) * c + k5
    phi = 2.0 * np.arctan((-b - np.sqrt(b * b - 4.0 * a * e)) / (2.0 * a))
    return _on_rocker(np.exp(1j * psi), *_rates(there.theta, phi, psi))


@np.errstate(invalid="ignore", divide="ignore")
def by_hand(there: Any, setting: None) -> Channels:
    """Two circles that meet; the loop equation's two derivatives by unit vectors of coupler and rocker."""
    a = np.empty(there.theta.shape, dtype=complex)
    a.real, a.imag = CRANK * np.cos(there.theta), CRANK * np.sin(there.theta)
    d = GROUND - a
    square = d.real * d.real + d.imag * d.imag
    along = (0.5 * (COUPLER**2 - ROCKER**2)) / square + 0.5
    arm = np.empty_like(a)  # the coupler
    arm.real, arm.imag = along, np.sqrt(COUPLER**2 / square - along * along)
    arm *= d
    rocker = arm - d
    across = arm.real * rocker.imag - arm.imag * rocker.real
    coupler_speed = (rocker.real * a.imag - rocker.imag * a.real) / across
    speed = (arm.real * a.imag - arm.imag * a.real) / across
    # what the acceleration is along the coupler
    gain = (a.real * arm.real + a.imag * arm.imag) + coupler_speed * coupler_speed * COUPLER**2
    gain -= speed * speed * (rocker.real * arm.real + rocker.imag * arm.imag)
    turning = np.empty_like(a)
    turning.real, turning.imag = -speed * speed, gain / across
    return [GROUND + rocker, 1j * speed * rocker, turning * rocker]


def newton_at_once(there: Any, steps: int) -> Channels:
    """Newton's method for all angles at once, each from one pose."""
    theta = there.theta
    ax, ay = CRANK * np.cos(theta), CRANK * np.sin(theta)
    phi, psi = np.full(theta.shape, 0.8), np.full(theta.shape, 1.8)
    for _ in range(steps):
        c, s, cb, sb = np.cos(phi), np.sin(phi), np.cos(psi), np.sin(psi)
        f, g = ax + COUPLER * c - GROUND - ROCKER * cb, ay + COUPLER * s - ROCKER * sb
        across = s * cb - c * sb
        phi, psi = phi + (f * cb + g * sb) / (COUPLER * across), psi + (f * c + g * s) / (ROCKER * across)
    return _on_rocker(np.exp(1j * psi), *_rates(theta, phi, psi))


def _loop(x: np.ndarray, c: float, s: float) -> list[float]:
    phi, psi = x.tolist()
    return [
        c + COUPLER * math.cos(phi) - GROUND - ROCKER * math.cos(psi),
        s + COUPLER * math.sin(phi) - ROCKER * math.sin(psi),
    ]


def _loop_slopes(x: np.ndarray, c: float, s: float) -> list[list[float]]:
    phi, psi = x.tolist()
    return [
        [-COUPLER * math.sin(phi), ROCKER * math.sin(psi)],
        [COUPLER * math.cos(phi), -ROCKER * math.cos(psi)],
    ]


def newton(there: Any, tolerance: float) -> Channels:
    """Angle by angle, each from the one before."""
    from scipy.optimize import fsolve

    x, found = np.array([0.8, 1.4]), []
    for theta in there.theta.tolist():
        turned = CRANK * math.cos(theta), CRANK * math.sin(theta)
        x = fsolve(_loop, x, args=turned, fprime=_loop_slopes, xtol=tolerance)
        found.append(x)
    phi, psi = np.array(found).T
    return _on_rocker(np.exp(1j * psi), *_rates(there.theta, phi, psi))


def joint(theta: np.ndarray) -> np.ndarray:
    """Where the circles about A and O4 meet, left of the line between them [mm]."""
    a = CRANK * np.exp(1j * theta)
    d = GROUND - a
    square = np.abs(d) ** 2
    along = (square + COUPLER**2 - ROCKER**2) / (2.0 * square)
    return np.asarray(a + d * (along + 1j * np.sqrt(COUPLER**2 / square - along**2)))


def finite_differences(there: Any, step: float) -> Channels:
    return differences(joint, there.theta, step)


def on_grid(there: Any, setting: tuple[int, int]) -> Channels:
    """Between the crank angles that are given."""
    b = joint(there.theta)
    return [b, *differences_on(b, there.theta[1] - there.theta[0], *setting)]


def cubic(there: Any, points: int) -> Any:
    return splined(points, joint)


def quintic(there: Any, points: int) -> Any:
    at = knots(points)
    return hermite(at, *by_hand(SimpleNamespace(theta=at), None))


def from_curve(there: Any, curve: Any) -> Channels:
    return [curve(there.theta, order) for order in range(3)]


def fourier(there: Any, points: int) -> Any:
    """Harmonics of the joint, which a crank that turns round has."""
    numbers = np.fft.fftfreq(points, 1.0 / points)
    c = np.fft.fft(joint(turn(points))) / points
    return numbers, c


def from_harmonics(there: Any, kept: Any) -> Channels:
    """The trigonometric polynomial and its derivatives, by matrices of e^{ikθ}."""
    numbers, c = kept
    order = np.argsort(numbers)
    numbers, c = numbers[order], c[order]
    rows = np.stack((c, 1j * numbers * c, -numbers * numbers * c))
    z = np.exp(1j * there.theta)
    told = np.zeros((3, z.size), dtype=complex)
    for k in range(numbers.size - 1, -1, -1):  # Horner
        told *= z
        told += rows[:, k, None]
    return list(told * np.exp(1j * numbers[0] * there.theta))


def by_transform(there: Any, kept: Any) -> Channels:
    """The same on an even grid over the turn, by inverse transforms of as many places."""
    numbers, c = kept
    theta, n = there.theta, there.theta.size
    first = c * np.exp(1j * numbers * theta[0])
    wide = np.zeros((3, n), dtype=complex)
    where = numbers.astype(int)
    wide[:, where] = n * np.stack((first, 1j * numbers * first, -numbers * numbers * first))
    return list(np.fft.ifft(wide))


KERNEL = Kernel(
    "dyads",
    "General linkage by dyads: a four-bar",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand, special=True),
        Method("tangent of the half angle (Freudenstein)", half_angle, special=True),
        Method("Newton, all angles at once", newton_at_once, (6, 3, 4, 5, 7), "steps"),
        Method("Newton (fsolve)", newton, (1e-10, 1e-2, 1e-5), "xtol", one_by_one=True),
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
        *by_table(lambda at: by_hand(SimpleNamespace(theta=at), None)),
        Method("cubic spline", from_curve, POINTS, "points", keeps=cubic),
        Method("quintic table", lambda there, table: table.at(there.theta, 0, 1, 2), FEW, "points", keeps=quintic),
        Method("harmonics", from_harmonics, (64, 16, 24, 32, 40, 48, 56), "points", keeps=fourier),
        Method("harmonics (FFT)", by_transform, (64, 32, 40, 48, 56), "points", keeps=fourier, on_grid=True),
        Method("pylinkage, numba", peers.pylinkage_four_bar, needs=("pylinkage", "numba")),
        Method("pylinkage's formulas, numba", peers.dyad, needs=("pylinkage", "numba"), special=True),
        Method("pylinkage's formulas", peers.dyad_plain, needs=("pylinkage",), special=True, one_by_one=True),
        Method("mechanism", peers.four_bar, needs=("mechanism", "matplotlib"), one_by_one=True),
    ),
    roundings=2 + 6 + 6 + 4 * 4,  # as of the cam's own linkage, whose triangle it is
    digits=2e-15,
    handed="crank angles, lengths, and on which side the joint lies",
    warm="tables, splines and harmonics; what KINDYNA knows of the linkage and its order of solution",
)
