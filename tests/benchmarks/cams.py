"""Profile and curvature of the lift's cam, from the solved linkage."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.plain import PIVOT, ROLLER_RADIUS, SENSE, differences, given, pitch, splined, tabled, turn
from benchmarks.table import Channels, Kernel, Method

from core.cam import envelope

# -- profile and pressure angle ---------------------------------------------------------------------------


def ours(there: Any, setting: None) -> Channels:
    flank = envelope(there.kinematics, there.face, there.cam, SENSE).flank
    return flank.profile, flank.pressure_angle


def _back(there: Any) -> np.ndarray:
    """e^{-idθ}, which every method is handed."""
    turned: np.ndarray = there.angles.unit
    return turned.conj() if SENSE > 0.0 else turned


def printed(there: Any, setting: None) -> Channels:
    """Shin1995 (18)-(20), in the frame whose x axis goes from the cam centre to the pivot, φ' counted against the cam."""
    distance, along = abs(PIVOT), PIVOT / abs(PIVOT)
    reference = there.kinematics.follower.z[0] / along
    rate = -SENSE * there.kinematics.follower.angle[1]
    q = distance * rate / (1.0 + rate)
    psi = np.arctan((q - reference.real) / reference.imag)
    contact = reference.real + ROLLER_RADIUS * np.sin(psi) + 1j * (reference.imag - ROLLER_RADIUS * np.cos(psi))
    arm = reference - distance
    normal = np.sin(psi) - 1j * np.cos(psi)
    cosine = np.abs((normal.conjugate() * 1j * arm).real) / np.abs(arm)
    return contact * along * _back(there), np.arccos(cosine)


def _by_tangent(curve: np.ndarray, tangent: np.ndarray, there: Any) -> Channels:
    """The offset of the pitch curve, and the angle between its normal and the way of the roller."""
    inwards = -1j * SENSE * tangent / np.abs(tangent)
    way = there.kinematics.travel * _back(there)
    across, along = (inwards.conjugate() * way).imag, (inwards.conjugate() * way).real
    return curve + ROLLER_RADIUS * inwards, np.arctan2(np.abs(across), np.abs(along))


def finite_differences(there: Any, step: float) -> Channels:
    curve, tangent, _ = differences(pitch, there.theta, step)
    return _by_tangent(curve, tangent, there)


def spline_normal(there: Any, points: int) -> Channels:
    """A cubic spline through points of the pitch curve, which is how a drawing program offsets it."""
    curve = splined(points, pitch)
    return _by_tangent(curve(there.theta), curve(there.theta, 1), there)


def table(there: Any, points: int) -> Channels:
    return tabled(points, lambda theta: list(ours(given(theta), None)), there.theta)


PROFILE = Kernel(
    "profile",
    "Profile and pressure angle",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("instant centre, printed (18)-(20)", printed),
        Method("finite differences", finite_differences, (1e-5, 1e-1, 1e-2, 1e-3, 1e-4, 1e-7), "step"),
        Method("cubic spline of the pitch curve", spline_normal, (3600, 90, 360, 36_000), "points"),
        Method("linear table", table, (3600, 90, 360, 36_000), "points"),
    ),
    roundings=34 + 10 + 12 + 24,  # as in the cam's own tests, and 24 of the motion
    digits=8e-15,
)

# -- curvature --------------------------------------------------------------------------------------------


def our_curvature(there: Any, setting: None) -> Channels:
    """And its slope, which comes with it."""
    return (envelope(there.kinematics, there.face, there.cam, SENSE).flank.pitch_curvature,)


def _bend(tangent: np.ndarray, turning: np.ndarray) -> Channels:
    return (-SENSE * (tangent.conjugate() * turning).imag / np.abs(tangent) ** 3,)


def bend_by_differences(there: Any, step: float) -> Channels:
    _, tangent, turning = differences(pitch, there.theta, step)
    return _bend(tangent, turning)


def three_points(there: Any, step: float) -> Channels:
    """The circle through three neighbouring points."""
    a, b, c = (pitch(there.theta + k * step) for k in (-1, 0, 1))
    area = ((b - a).conjugate() * (c - a)).imag
    return (-SENSE * 2.0 * area / (np.abs(b - a) * np.abs(c - b) * np.abs(a - c)),)


def bend_of_spline(there: Any, points: int) -> Channels:
    curve = splined(points, pitch)
    return _bend(curve(there.theta, 1), curve(there.theta, 2))


STEPS = (1e-4, 1e-1, 1e-2, 1e-3, 1e-5, 1e-6)

CURVATURE = Kernel(
    "curvature",
    "Curvature of the pitch curve",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", our_curvature, ours=True),
        Method("finite differences", bend_by_differences, STEPS, "step"),
        Method("circle through three points", three_points, STEPS, "step"),
        Method("cubic spline of the pitch curve", bend_of_spline, (3600, 90, 360, 36_000), "points"),
    ),
    roundings=34 + 10 + 12 + 24,
    digits=1.2e-14,
)
