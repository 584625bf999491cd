"""The cam's shape: pitch curve and profile as the envelope of the follower's face, in closed form."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import LinkageCam, RollerCam, si
from core.errors import NoCam, angle_ranges
from core.instant_centres import Centres, cam_follower_centre
from core.mechanism.kinematics import Kinematics
from core.numerics.derivatives import BINOMIAL, Derivatives
from core.numerics.lazy import Lazy
from core.numerics.vectors import cross, dot


@dataclass(frozen=True, eq=False)
class Flank:
    """One side of the cam that the follower touches, at n cam angles; all but the normal may be given as functions.

    pitch, profile   (n,) complex [m] in the cam's own frame, which is the global frame at cam angle 0
    normal           (n,) complex unit vector in the global frame, from the roller centre to the contact
    pressure_angle   (n,) [rad], unsigned, 0 ... π/2
    pitch_curvature  (n,) [1/m], positive where the cam is convex; profile_curvature likewise
    pitch_curvature_slope  (n,) its derivative by cam angle
    """

    pitch: Lazy[np.ndarray] = Lazy()
    profile: Lazy[np.ndarray] = Lazy()
    normal: Lazy[np.ndarray] = Lazy()
    pressure_angle: Lazy[np.ndarray] = Lazy()
    pitch_curvature: Lazy[np.ndarray] = Lazy()
    pitch_curvature_slope: Lazy[np.ndarray] = Lazy()
    profile_curvature: Lazy[np.ndarray] = Lazy()


@dataclass(frozen=True, eq=False)
class CamShape:
    """The cam at n cam angles: its flanks (one for an open cam), the reference point R of the follower in the
    global frame (n,) [m], its velocity t relative to the cam, and the instant centre Q of follower and cam."""

    flanks: tuple[Flank, ...]
    sense: float
    reference: np.ndarray
    relative_velocity: np.ndarray
    centre: Lazy[Centres] = Lazy()

    @property
    def flank(self) -> Flank:
        return self.flanks[0]


def relative_motion(kinematics: Kinematics, sense: float) -> Derivatives:
    """The pitch curve's derivatives, turned into the global frame: the reference point R, its velocity t = R' - idR relative
    to the cam, w = R'' - 2idR' - R and x = R''' - 3idR'' - 3R' + idR, by Leibniz of R e^{-idθ}."""
    r = kinematics.follower.origin

    def row(order: int) -> np.ndarray:
        terms = [c * (-1j * sense) ** (order - k) * r[k] for k, c in enumerate(BINOMIAL[order][:-1])]
        return np.asarray(sum(terms, r[order]))

    return Derivatives(row)


def curvature(motion: Derivatives, sense: float) -> np.ndarray:
    """κ_p = -d Im(t̄ w)/|t|³ (n,) [1/m], convex positive for both senses."""
    speed = np.abs(motion[1])
    return -sense * cross(motion[1], motion[2]) / (speed * speed * speed)


def curvature_slope(motion: Derivatives, sense: float) -> np.ndarray:
    """κ_p' (n,) [1/m per rad]."""
    t, w, x = (motion[order] for order in (1, 2, 3))
    square = dot(t, t)
    bend = cross(t, x) - 3.0 * cross(t, w) * dot(t, w) / square
    return -sense * bend / (square * np.sqrt(square))


# what sets the cam's size: its field, and what to do
SIZES: Mapping[type, tuple[str, str]] = MappingProxyType({
    RollerCam: ("cam.base_radius_mm", "make it larger, or the roller smaller, or lower the motion"),
    LinkageCam: ("cam.point", "let the roller run farther from the frame's origin, or make it smaller"),
})  # fmt: skip


def roller_envelope(kinematics: Kinematics, cam: RollerCam | LinkageCam, sense: float) -> CamShape:
    """Profile of a disk cam under a roller: n = -i d t/|t|, profile (R + Rr n) e^{-idθ}.

    Takes the place of Shin1995 (19), (20), which are written for one quadrant; Q stays a check (18).
    Raises NoCam where the roller covers the cam centre or stands still on the cam (a cusp).
    """
    radius = si(cam).roller_radius
    motion = relative_motion(kinematics, sense)
    reference, t = motion[0], motion[1]
    _require_cam(kinematics, reference, t, cam)
    normal = (-1j * sense) * t / np.abs(t)

    @cache
    def back() -> np.ndarray:
        """e^{-idθ}."""
        turned = kinematics.motion.angles.unit
        return turned.conj() if sense > 0.0 else turned

    bend = cache(lambda: curvature(motion, sense))
    flank = Flank(
        pitch=lambda: reference * back(),
        profile=lambda: (reference + radius * normal) * back(),
        normal=normal,
        pressure_angle=lambda: np.arctan2(np.abs(cross(normal, kinematics.travel)), np.abs(dot(normal, kinematics.travel))),
        pitch_curvature=bend,
        pitch_curvature_slope=lambda: curvature_slope(motion, sense),
        profile_curvature=lambda: _beyond(bend(), radius),
    )
    return CamShape((flank,), sense, reference, t, lambda: cam_follower_centre(kinematics, sense))


@np.errstate(divide="ignore")
def _beyond(pitch_curvature: np.ndarray, radius: float) -> np.ndarray:
    """Curvature of the curve that runs beside by the roller's radius, on the convex side's inside."""
    return pitch_curvature / (1.0 - radius * pitch_curvature)


def _require_cam(kinematics: Kinematics, reference: np.ndarray, t: np.ndarray, cam: RollerCam | LinkageCam) -> None:
    radius = si(cam).roller_radius
    distance = np.abs(reference)
    bad = distance <= radius
    if bad.any():
        raise NoCam(
            f"the roller covers the cam centre: its own centre comes as near as {distance.min() * 1e3:.9g} mm, "
            f"less than the roller radius {radius * 1e3:.9g} mm, so the cam's radius turns negative",
            *SIZES[type(cam)],
            angle_ranges(kinematics.theta, bad),
        )
    still = t == 0.0
    if still.any():
        raise NoCam(
            "the roller stands still on the cam (cusp of the pitch curve)",
            SIZES[type(cam)][0],
            "change it",
            angle_ranges(kinematics.theta, still),
        )


ENVELOPES: Mapping[type, Callable[[Kinematics, Any, float], CamShape]] = MappingProxyType(
    {RollerCam: roller_envelope, LinkageCam: roller_envelope}
)


def envelope(kinematics: Kinematics, cam: Any, sense: float) -> CamShape:
    """The cam that moves the follower body of the kinematics; sense: d = +1 counter-clockwise, -1 clockwise."""
    return ENVELOPES[type(cam)](kinematics, cam, sense)
