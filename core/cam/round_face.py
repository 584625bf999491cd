"""A round on the cam - roller, shoe, or an edge of radius 0 - as an envelope, with its limits, its proof and its outline."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from types import MappingProxyType

import numpy as np

from core.cam.shape import (
    INNER,
    OUTER,
    SECOND,
    CamShape,
    FaceOutline,
    Flank,
    curvature,
    curvature_slope,
    relative_motion,
    sliding,
    turned_back,
)
from core.cam.sizes import face_table, size_of
from core.design import RoundFace, Shoe
from core.errors import NoCam, angle_ranges
from core.findings import ERROR, Finding
from core.instant_centres import cam_follower_centre
from core.mechanism.kinematics import Kinematics
from core.motion.extremes import Range
from core.numerics.lazy import once
from core.numerics.vectors import between_lines

POINTS = 181  # of an outline
_WORDS: Mapping[type, Mapping[str, str]] = MappingProxyType({Shoe: {"face": Shoe.face}})
SPARE = 0.3  # of a drawn shoe beyond where it touches [rad]
_OF_SECOND = ("second roller", "cam.second.roller_radius_mm", "make it smaller, or put the second roller farther out")
WEDGE = 0.12  # length of a drawn edge, parts of the cam's size


def envelope(kinematics: Kinematics, face: RoundFace, cam: object, sense: float) -> CamShape:
    """Profile of a disk cam under a round of radius Rr: n = -i d t/|t|, profile (R + Rr n) e^{-idθ}.

    Takes the place of Shin1995 (19), (20), which are written for one quadrant; Q stays a check (18).
    Raises NoCam where it covers the cam centre or stands still on the cam (a cusp).
    """
    return CamShape((round_envelope(kinematics, face, cam, sense, 1e-3 * face.radius_mm),), sense)


def round_envelope(
    kinematics: Kinematics, face: RoundFace, cam: object, sense: float, offset: float, name: str = INNER
) -> Flank:
    """The flank beside the pitch curve of the reference point: (R + offset n) e^{-idθ}, with the curvature κ_p/(1 - offset κ_p).

    offset [m]: Rr; of the outer flank of a groove -(Rr + play), where the follower pushes along -n. Raises as ``envelope``.
    """
    motion, side = relative_motion(kinematics, sense), 1.0 if name != OUTER else -1.0
    reference, t = motion[0], motion[1]
    of_cam = size_of(cam, face.noun, face.radius_mm)
    _require_cam(
        kinematics, reference, t, 1e-3 * face.radius_mm, *(_OF_SECOND if name == SECOND else (face.noun, *of_cam))
    )
    speed = np.abs(t)
    normal = np.empty(t.shape, dtype=complex)  # -i d t/|t|
    np.divide(t.imag, sense * speed, out=normal.real)
    np.divide(t.real, -sense * speed, out=normal.imag)
    back = turned_back(kinematics, sense)
    bend = once(lambda: curvature(motion, sense))
    return Flank(
        name=name,
        body=kinematics.carrier,
        reference=reference,
        relative_velocity=t,
        centre=lambda: cam_follower_centre(kinematics, sense),
        profile=lambda: (reference + offset * normal) * back(),
        contact=lambda: reference + offset * normal,
        normal=side * normal,
        pressure_angle=lambda: between_lines(normal, kinematics.travel),
        profile_curvature=lambda: _beyond(bend(), offset),
        profile_velocity=lambda: t * (1.0 - offset * bend()) * back(),
        sliding=lambda: sliding(kinematics, motion, reference + offset * normal, side * normal, sense),
        radius=1e-3 * face.radius_mm,
        offset=offset,
        pitch=lambda: reference * back(),
        pitch_curvature=bend,
        pitch_curvature_slope=lambda: curvature_slope(motion, sense),
    )


@np.errstate(divide="ignore")
def _beyond(pitch_curvature: np.ndarray, offset: float) -> np.ndarray:
    """Curvature of the curve that runs beside, by the offset on the convex side's inside."""
    return pitch_curvature / (1.0 - offset * pitch_curvature)


def _require_cam(
    kinematics: Kinematics, reference: np.ndarray, t: np.ndarray, radius: float, name: str, field: str, hint: str
) -> None:
    """Raises NoCam; name: of the round, field, hint: which entry makes the cam larger, and how."""
    distance = np.abs(reference)
    bad = distance <= radius
    NoCam.where(
        bad,
        lambda: NoCam(
            f"the {name} covers the cam centre: its own centre comes as near as {distance.min() * 1e3:.9g} mm, "
            f"less than the {name} radius {radius * 1e3:.9g} mm, so the cam's radius turns negative",
            field,
            hint,
            angle_ranges(kinematics.theta, bad),
        ),
    )
    still = t == 0.0
    NoCam.where(
        still,
        lambda: NoCam(
            f"the {name} stands still on the cam (cusp of the pitch curve)",
            field,
            "change it",
            angle_ranges(kinematics.theta, still),
        ),
    )


def is_undercut(extremes: Mapping[str, Range], face: RoundFace) -> bool:
    """Whether the pitch curve is somewhere no blunter than the round: there the profile has a cusp, or crosses itself."""
    return 1e-3 * face.radius_mm * extremes["pitch_curvature"].high.value >= 1.0


def own_distance(shape: CamShape, face: RoundFace) -> np.ndarray:
    """Distance of the profile's own points from the round (n,) [m]."""
    flank = shape.flank
    return np.abs(np.abs(shape.flank.profile - flank.pitch) - 1e-3 * face.radius_mm)


def gaps(shape: CamShape, face: RoundFace, positions: int) -> np.ndarray:
    """Least distance from the centre to all profile points, less the radius [m], by brute force at ``positions`` cam
    positions (m,): negative where the profile enters the round, positive where it stays away from it."""
    pitch, profile, radius = shape.flank.pitch, shape.flank.profile, 1e-3 * face.radius_mm
    step = max(1, pitch.size // positions)
    # one by one, so that memory stays small for a million points
    return np.array([float(np.abs(profile - centre).min()) - radius for centre in pitch[::step]])


def outline(shape: CamShape, face: RoundFace, kinematics: Kinematics) -> FaceOutline:
    """A roller as a circle; a shoe as half of one, or as much more as the contact wanders, held at its centre; an edge as a wedge
    whose point lies there, held at its back."""
    radius, away = 1e-3 * face.radius_mm, -shape.flank.normal / kinematics.follower.unit
    middle = complex(away.mean())
    middle /= abs(middle) or 1.0
    if not radius:
        length = WEDGE * float(np.abs(shape.reference).max()) * middle
        return FaceOutline(np.array([0.0, length * (1.0 + 0.4j), length * (1.0 - 0.4j), 0.0]), length)
    half = np.pi
    if face.slides:
        half = min(np.pi, max(np.pi / 2.0, float(np.abs(np.angle(away / middle)).max()) + SPARE))
    return FaceOutline(-radius * middle * np.exp(1j * np.linspace(-half, half, POINTS)), 0j)


def findings(extremes: Mapping[str, Range], face: RoundFace, cam: object, least_at: object) -> list[Finding]:
    """The pitch curve's smallest radius against that of the round."""
    if not is_undercut(extremes, face):
        return []
    sharpest = extremes["pitch_curvature"].high
    key = f"{face.face}_radius_mm"
    values: dict[str, float | str] = {
        "pitch_radius_mm": 1e3 / sharpest.value,
        key: face.radius_mm,
        **_WORDS.get(type(face), {}),
    }
    return [Finding("undercut", ERROR, f"{face_table(cam, face)}.{key}", degrees(sharpest.theta), values)]
