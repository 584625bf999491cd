"""General linkages dyad by dyad: joint B of a crank-rocker, with velocity and acceleration, at any crank angles."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import LENGTHS
from benchmarks.plain import (
    FEW,
    by_table,
    hermite,
    knots,
    turn,
)
from benchmarks.table import Channels, Kernel, Method
from linkages import four_bar

from core.mechanism import at_driver, driver_ranges_of

GROUND, CRANK, COUPLER, ROCKER = LENGTHS


def given(theta: np.ndarray) -> SimpleNamespace:
    return SimpleNamespace(theta=theta, mechanism=four_bar(*LENGTHS).drive.mechanism)


def _on_rocker(turned: np.ndarray, speed: Any, gain: Any) -> Channels:
    """B from the rocker's unit vector (n,), angular velocity and acceleration."""
    u = ROCKER * turned
    return [GROUND + u, 1j * speed * u, (1j * gain - speed * speed) * u]


def ours(there: Any, setting: None) -> Channels:
    """Joint B of the rocker, as any view asks for it."""
    pose = driver_ranges_of(there.mechanism).solve(at_driver(there.theta)).poses[4]
    return _on_rocker(pose.unit, pose.turn[1], pose.turn[2])


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


def joint(theta: np.ndarray) -> np.ndarray:
    """Where the circles about A and O4 meet, left of the line between them [mm]."""
    a = CRANK * np.exp(1j * theta)
    d = GROUND - a
    square = np.abs(d) ** 2
    along = (square + COUPLER**2 - ROCKER**2) / (2.0 * square)
    return np.asarray(a + d * (along + 1j * np.sqrt(COUPLER**2 / square - along**2)))


def quintic(there: Any, points: int) -> Any:
    at = knots(points)
    return hermite(at, *by_hand(SimpleNamespace(theta=at), None))


def fourier(there: Any, points: int) -> Any:
    """Harmonics of the joint, which a crank that turns round has."""
    numbers = np.fft.fftfreq(points, 1.0 / points)
    c = np.fft.fft(joint(turn(points))) / points
    return numbers, c


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
        *by_table(lambda at: by_hand(SimpleNamespace(theta=at), None)),
        Method("quintic table", lambda there, table: table.at(there.theta, 0, 1, 2), FEW, "points", keeps=quintic),
        Method("harmonics (FFT)", by_transform, (64, 32, 40, 48, 56), "points", keeps=fourier, on_grid=True),
    ),
    handed="crank angles, lengths, and the side on which the joint is",
    warm="tables and harmonics; KINDYNA's data on the linkage and its order of solution",
)
