"""General linkages dyad by dyad: joint B of a crank-rocker, with velocity and acceleration, at any crank angles."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks import peers
from benchmarks.exact_dyads import LENGTHS
from benchmarks.plain import differences, splined, tabled, turn
from benchmarks.table import Channels, Kernel, Method
from linkages import four_bar

from core.mechanism import at_driver, course_of

GROUND, CRANK, COUPLER, ROCKER = LENGTHS


def given(theta: np.ndarray) -> SimpleNamespace:
    """The course of the linkage is found once, as it is in a study."""
    return SimpleNamespace(theta=theta, q=at_driver(theta), course=course_of(four_bar(*LENGTHS).drive.mechanism))


def _on_rocker(turned: np.ndarray, speed: Any, gain: Any) -> Channels:
    """B from the rocker's unit vector (n,), angular velocity and acceleration."""
    u = ROCKER * turned
    return [GROUND + u, 1j * speed * u, (1j * gain - speed * speed) * u]


def ours(there: Any, setting: None) -> Channels:
    """Joint B of the rocker, as any view asks for it."""
    pose = there.course.solve(there.q).poses[4]
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


def _loop(x: np.ndarray, c: float, s: float) -> list[float]:
    phi, psi = x
    return [
        c + COUPLER * np.cos(phi) - GROUND - ROCKER * np.cos(psi),
        s + COUPLER * np.sin(phi) - ROCKER * np.sin(psi),
    ]


def newton(there: Any, tolerance: float) -> Channels:
    """Angle by angle, each from the one before."""
    from scipy.optimize import fsolve

    x, found = np.array([0.8, 1.4]), []
    for theta in there.theta.tolist():
        x = fsolve(_loop, x, args=(CRANK * np.cos(theta), CRANK * np.sin(theta)), xtol=tolerance)
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


def table(there: Any, points: int) -> Channels:
    return tabled(points, lambda theta: list(ours(given(theta), None)), there.theta)


def spline(there: Any, points: int) -> Channels:
    curve = splined(points, joint)
    return [curve(there.theta, order) for order in range(3)]


KERNEL = Kernel(
    "dyads",
    "General linkage by dyads: a four-bar",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("tangent of the half angle (Freudenstein)", half_angle),
        Method("Newton (fsolve)", newton, (1e-10, 1e-2, 1e-5), "xtol", one_by_one=True),
        Method("finite differences", finite_differences, (1e-4, 1e-1, 1e-2, 1e-3, 1e-5, 1e-6), "step"),
        Method("linear table", table, (3600, 90, 360, 36_000), "points"),
        Method("cubic spline", spline, (3600, 90, 360, 36_000), "points"),
        Method("pylinkage, compiled by numba", peers.pylinkage_four_bar, needs=("pylinkage", "numba")),
        Method("its formulas alone in a loop of one's own, compiled", peers.dyad, needs=("pylinkage", "numba")),
        Method("its formulas alone in a loop of one's own", peers.dyad_plain, needs=("pylinkage",), one_by_one=True),
        Method("mechanism", peers.four_bar, needs=("mechanism",), one_by_one=True),
    ),
    roundings=2 + 6 + 6 + 4 * 4,  # as of the cam's own linkage, whose triangle it is
    digits=2e-15,
)
