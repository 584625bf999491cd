"""Profile and curvature of the lift's cam, from the solved linkage."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.linkages import by_hand as linkage_by_hand
from benchmarks.plain import (
    ALSO,
    PIVOT,
    ROLLER_RADIUS,
    SENSE,
    again,
    by_table,
    given,
    motion_at,
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


def at_knots(theta: np.ndarray) -> Channels:
    """What a table of profile and pressure angle holds: all by hand."""
    r, v = linkage_by_hand(motion_at(theta), None)[3:5]
    back = np.exp(-1j * SENSE * theta)
    normal = (v - 1j * SENSE * r) * (-1j * SENSE)
    normal /= _size(normal)
    return (r + ROLLER_RADIUS * normal) * back, _between(normal, 1j * (r - PIVOT))


HANDED = (
    "the roller's centre of the solved linkage with velocity and acceleration, its direction of travel, and e^{iθ}"
    + ALSO
)
KEPT = "tables"

PROFILE = Kernel(
    "profile",
    "Profile and pressure angle",
    given=given,
    again=again,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand),
        *by_table(at_knots),
    ),
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
        *by_table(bend_at_knots),
    ),
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
