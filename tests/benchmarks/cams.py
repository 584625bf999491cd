"""Profile and curvature of the lift's cam, from the solved linkage."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.linkages import by_hand as linkage_by_hand
from benchmarks.plain import (
    ALSO,
    FEW,
    ON_GRID,
    PIVOT,
    POINTS,
    ROLLER_RADIUS,
    SENSE,
    STEPS,
    Quintic,
    again,
    as_far_apart,
    by_table,
    differences,
    differences_on,
    given,
    hermite,
    knots,
    motion_at,
    pitch,
    splined,
    turn,
)
from benchmarks.table import Channels, Kernel, Method

from core.cam import envelope
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[2] / "resources" / "examples"

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
    reference = _solved(there, 0) / along
    rate = -SENSE * there.kinematics.follower.turn[1]
    q = distance * rate / (1.0 + rate)
    psi = np.arctan((q - reference.real) / reference.imag)
    contact = reference.real + ROLLER_RADIUS * np.sin(psi) + 1j * (reference.imag - ROLLER_RADIUS * np.cos(psi))
    arm = reference - distance
    normal = np.sin(psi) - 1j * np.cos(psi)
    cosine = np.abs((normal.conjugate() * 1j * arm).real) / np.abs(arm)
    return contact * along * _back(there), np.arccos(cosine)


def _solved(there: Any, order: int) -> np.ndarray:
    """The roller's centre or a derivative of it."""
    return np.asarray(there.kinematics.follower.origin[order])


def _size(z: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt(z.real * z.real + z.imag * z.imag))


def _between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The unsigned angle between two lines."""
    across = a.real * b.imag - a.imag * b.real
    return np.arctan2(np.abs(across), np.abs(a.real * b.real + a.imag * b.imag))


def by_hand(there: Any, setting: None) -> Channels:
    """The offset of the pitch curve along its normal, in the global frame."""
    centre = _solved(there, 0)
    tangent = _solved(there, 1) - (1j * SENSE) * centre
    normal = tangent * (-1j * SENSE / _size(tangent))
    return (centre + ROLLER_RADIUS * normal) * _back(there), _between(normal, there.kinematics.travel)


def _by_tangent(curve: np.ndarray, tangent: np.ndarray, there: Any) -> Channels:
    """The offset of the pitch curve, and the angle between its normal and the way of the roller, in the cam's frame."""
    inwards = tangent * (-1j * SENSE / _size(tangent))
    return curve + ROLLER_RADIUS * inwards, _between(inwards, there.kinematics.travel * _back(there))


def finite_differences(there: Any, step: float) -> Channels:
    curve, tangent, _ = differences(pitch, there.theta, step)
    return _by_tangent(curve, tangent, there)


def on_grid(there: Any, setting: tuple[int, int]) -> Channels:
    """The tangent by differences between the places that are given."""
    curve = _solved(there, 0) * _back(there)
    return _by_tangent(curve, differences_on(curve, there.theta[1] - there.theta[0], *setting, orders=1)[0], there)


def _spline_on(there: Any, every: int) -> Any:
    """A cubic spline through every so manieth of the places that are given."""
    from scipy.interpolate import CubicSpline

    curve, at = (_solved(there, 0) * _back(there))[::every], there.theta[::every]
    return CubicSpline(np.append(at, at[0] + 2.0 * np.pi), np.append(curve, curve[:1]), bc_type="periodic")


def spline_on_grid(there: Any, every: int) -> Channels:
    return from_curve(there, _spline_on(there, every))


def cubic(there: Any, points: int) -> Any:
    return splined(points, pitch)


def quintic(there: Any, points: int) -> Any:
    """The pitch curve with two derivatives from the linkage by hand."""
    at = knots(points)
    r, v, a = linkage_by_hand(motion_at(at), None)[3:6]
    back = np.exp(-1j * SENSE * at)
    return hermite(at, r * back, (v - 1j * SENSE * r) * back, (a - 2j * SENSE * v - r) * back)


def from_curve(there: Any, curve: Any) -> Channels:
    return _by_tangent(curve(there.theta), curve(there.theta, 1), there)


def from_table(there: Any, table: Quintic) -> Channels:
    return _by_tangent(*table.at(there.theta, 0, 1), there)


def at_knots(theta: np.ndarray) -> Channels:
    """What a table of profile and pressure angle holds: all by hand."""
    r, v = linkage_by_hand(motion_at(theta), None)[3:5]
    back = np.exp(-1j * SENSE * theta)
    normal = (v - 1j * SENSE * r) * (-1j * SENSE)
    normal /= _size(normal)
    return (r + ROLLER_RADIUS * normal) * back, _between(normal, 1j * (r - PIVOT))


ON_SPLINE = (1, 2, 4, 10)
HANDED = (
    "of the solved linkage the roller's centre with velocity and acceleration, its direction of travel, and e^{iθ}"
    + ALSO
)
KEPT = "tables and splines"

PROFILE = Kernel(
    "profile",
    "Profile and pressure angle",
    given=given,
    again=again,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand),
        Method("instant centre, printed (18)-(20)", printed),
        Method(
            "differences between the given places", on_grid, ON_GRID, "order, every", on_grid=True, scaled=as_far_apart
        ),
        Method(
            "cubic spline through the given places",
            spline_on_grid,
            ON_SPLINE,
            "every",
            on_grid=True,
            scaled=as_far_apart,
        ),
        Method(
            "finite differences, places by hand",
            finite_differences,
            (1e-5, 1e-2, 1e-3, 3e-4, 1e-4, 3e-5, 1e-6),
            "step",
            special=True,
        ),
        Method("cubic spline of the pitch curve", from_curve, POINTS, "points", keeps=cubic),
        Method("quintic table of the pitch curve", from_table, FEW, "points", keeps=quintic),
        *by_table(at_knots),
    ),
    roundings=34 + 10 + 12 + 24,  # as in the cam's own tests, and 24 of the motion
    digits=8e-15,
    handed=HANDED,
    warm=KEPT,
)

# -- curvature --------------------------------------------------------------------------------------------


def our_curvature(there: Any, setting: None) -> Channels:
    """And its slope, which comes with it."""
    return (envelope(there.kinematics, there.face, there.cam, SENSE).flank.pitch_curvature,)


def _bend(tangent: np.ndarray, turning: np.ndarray) -> Channels:
    """-d Im(t̄ w)/|t|³."""
    across = tangent.real * turning.imag - tangent.imag * turning.real
    square = tangent.real * tangent.real + tangent.imag * tangent.imag
    return (across / (square * np.sqrt(square)) * -SENSE,)


def bend_by_hand(there: Any, setting: None) -> Channels:
    centre, speed, gain = (_solved(there, order) for order in range(3))
    return _bend(speed - (1j * SENSE) * centre, gain - (2j * SENSE) * speed - centre)


def bend_by_differences(there: Any, step: float) -> Channels:
    _, tangent, turning = differences(pitch, there.theta, step)
    return _bend(tangent, turning)


def bend_on_grid(there: Any, setting: tuple[int, int]) -> Channels:
    """By differences between the places that are given."""
    curve = _solved(there, 0) * _back(there)
    return _bend(*differences_on(curve, there.theta[1] - there.theta[0], *setting))


def three_points(there: Any, every: int) -> Channels:
    """The circle through three of the places that are given."""
    b = _solved(there, 0) * _back(there)
    before, after = b - np.roll(b, every), np.roll(b, -every) - b
    area = before.real * after.imag - before.imag * after.real
    return (-SENSE * 2.0 * area / (_size(before) * _size(after) * _size(before + after)),)


def bend_of_curve(there: Any, curve: Any) -> Channels:
    return _bend(curve(there.theta, 1), curve(there.theta, 2))


def bend_of_table(there: Any, table: Quintic) -> Channels:
    return _bend(*table.at(there.theta, 1, 2))


def bend_of_spline(there: Any, every: int) -> Channels:
    return bend_of_curve(there, _spline_on(there, every))


def bend_at_knots(theta: np.ndarray) -> Channels:
    r, v, a = linkage_by_hand(motion_at(theta), None)[3:6]
    return _bend(v - 1j * SENSE * r, a - 2j * SENSE * v - r)


CURVATURE = Kernel(
    "curvature",
    "Curvature of the pitch curve",
    given=given,
    again=again,
    grid=turn,
    methods=(
        Method("KINDYNA", our_curvature, ours=True),
        Method("numpy by hand", bend_by_hand),
        Method(
            "differences between the given places",
            bend_on_grid,
            ON_GRID,
            "order, every",
            on_grid=True,
            scaled=as_far_apart,
        ),
        Method(
            "circle through three given places", three_points, ON_SPLINE, "every", on_grid=True, scaled=as_far_apart
        ),
        Method(
            "cubic spline through the given places",
            bend_of_spline,
            ON_SPLINE,
            "every",
            on_grid=True,
            scaled=as_far_apart,
        ),
        Method("finite differences, places by hand", bend_by_differences, STEPS, "step", special=True),
        Method("cubic spline of the pitch curve", bend_of_curve, POINTS, "points", keeps=cubic),
        Method("quintic table of the pitch curve", bend_of_table, FEW, "points", keeps=quintic),
        *by_table(bend_at_knots),
    ),
    roundings=34 + 10 + 12 + 24,
    digits=1.2e-14,
    handed=HANDED,
    warm=KEPT,
)

# -- under every face ---------------------------------------------------------------------------------------

FACES = {
    "translating roller": "card_picker",
    "translating flat face": "tappet_flat",
    "knife edge": "tappet_knife",
    "swinging roller": "rocker_cam",
    "swinging flat face": "rocker_flat",
    "shoe": "rocker_shoe",
}


def under_faces(n: int) -> dict[str, Callable[[], object]]:
    """Profile, pressure angle and curvature of an example under each face, from its solved linkage."""
    return {what: _under(Study(load(EXAMPLES / f"{name}.toml"), n)) for what, name in FACES.items()}


def _under(study: Study) -> Callable[[], object]:
    kinematics, drive, sense = study.linkage, study.design.drive, study.sense
    face, body = drive.face, kinematics.follower
    _ = body.z, body.angle, kinematics.motion.angles.unit, kinematics.travel

    def run() -> object:
        flank = envelope(kinematics, face, drive.cam, sense).flank
        return flank.profile, flank.pressure_angle, flank.profile_curvature

    return run
