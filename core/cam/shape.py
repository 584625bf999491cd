"""The cam's shape: pitch curve and profile as the envelope of the follower's face, in closed form."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import RollerCam, si
from core.errors import NoCam, angle_ranges
from core.instant_centres import Centres, cam_follower_centre
from core.train import Train
from core.vectors import cross, dot, unit


@dataclass(frozen=True, eq=False)
class Flank:
    """One side of the cam that the follower touches, at n cam angles.

    pitch, profile   (n,) complex [m] in the cam's own frame, which is the global frame at cam angle 0
    normal           (n,) complex unit vector in the global frame, from the roller centre to the contact
    pressure_angle   (n,) [rad], unsigned, 0 ... π/2
    pitch_curvature  (n,) [1/m], positive where the cam is convex; profile_curvature likewise
    pitch_curvature_slope  (n,) its derivative by cam angle
    """

    pitch: np.ndarray
    profile: np.ndarray
    normal: np.ndarray
    pressure_angle: np.ndarray
    pitch_curvature: np.ndarray
    pitch_curvature_slope: np.ndarray
    profile_curvature: np.ndarray


@dataclass(frozen=True, eq=False)
class CamShape:
    """The cam at n cam angles: its flanks (one for an open cam), the reference point R of the follower in the
    global frame (n,) [m], its velocity t relative to the cam, and the instant centre Q of follower and cam."""

    flanks: tuple[Flank, ...]
    sense: float
    reference: np.ndarray
    relative_velocity: np.ndarray
    centre: Centres

    @property
    def flank(self) -> Flank:
        return self.flanks[0]


def relative_motion(train: Train, sense: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity t = R' - idR of the reference point relative to the cam, w = R'' - 2idR' - R and
    x = R''' - 3idR'' - 3R' + idR (n,): the derivatives of the pitch curve, turned into the global frame."""
    r0, r1, r2, r3 = train.follower.z
    i = 1j * sense
    return r1 - i * r0, r2 - 2.0 * i * r1 - r0, r3 - 3.0 * i * r2 - 3.0 * r1 + i * r0


def curvature(t: np.ndarray, w: np.ndarray, x: np.ndarray, sense: float) -> tuple[np.ndarray, np.ndarray]:
    """κ_p = -d Im(t̄ w)/|t|³, convex positive for both senses, and κ_p' (n,) [1/m, 1/m per rad]."""
    speed = np.abs(t)
    cube = speed * speed * speed
    turn = cross(t, w)
    return -sense * turn / cube, -sense * (cross(t, x) - 3.0 * turn * dot(t, w) / (speed * speed)) / cube


def roller_envelope(train: Train, cam: RollerCam, sense: float) -> CamShape:
    """Profile of a disk cam under a roller: n = -i d t/|t|, profile (R + Rr n) e^{-idθ}.

    Takes the place of Shin1995 (19), (20), which are written for one quadrant; Q stays a check (18).
    Raises NoCam where the roller covers the cam centre or stands still on the cam (a cusp).
    """
    radius = si(cam).roller_radius
    reference = train.follower.z[0]
    t, w, x = relative_motion(train, sense)
    _require_cam(train, reference, t, radius)
    normal = (-1j * sense) * t / np.abs(t)
    back = unit(-sense * train.theta)
    pitch_curvature, slope = curvature(t, w, x, sense)
    with np.errstate(divide="ignore"):
        profile_curvature = pitch_curvature / (1.0 - radius * pitch_curvature)
    flank = Flank(
        pitch=reference * back,
        profile=(reference + radius * normal) * back,
        normal=normal,
        pressure_angle=np.arctan2(np.abs(cross(normal, train.travel)), np.abs(dot(normal, train.travel))),
        pitch_curvature=pitch_curvature,
        pitch_curvature_slope=slope,
        profile_curvature=profile_curvature,
    )
    return CamShape((flank,), sense, reference, t, cam_follower_centre(train, sense))


def _require_cam(train: Train, reference: np.ndarray, t: np.ndarray, radius: float) -> None:
    distance = np.abs(reference)
    bad = distance <= radius
    if bad.any():
        raise NoCam(
            f"the roller covers the cam centre: its own centre comes as near as {distance.min() * 1e3:.9g} mm, "
            f"less than the roller radius {radius * 1e3:.9g} mm, so the cam's radius turns negative",
            "cam.base_radius_mm",
            "make it larger, or the roller smaller, or lower the motion",
            angle_ranges(train.theta, bad),
        )
    still = t == 0.0
    if still.any():
        raise NoCam(
            "the roller stands still on the cam (cusp of the pitch curve)",
            "cam.base_radius_mm",
            "change it",
            angle_ranges(train.theta, still),
        )


ENVELOPES: Mapping[type, Callable[[Train, Any, float], CamShape]] = MappingProxyType({RollerCam: roller_envelope})


def envelope(train: Train, cam: Any, sense: float) -> CamShape:
    """The cam that moves the follower body of the train; sense: d = +1 counter-clockwise, -1 clockwise."""
    return ENVELOPES[type(cam)](train, cam, sense)
