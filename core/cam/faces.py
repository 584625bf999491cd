"""Faces of followers, one row each: envelope, limits, proof of tangency, outline, and whether the face rolls.

The cam under a straight face is computed here, under a round one in ``core.cam.shape``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.cam import shape
from core.cam.shape import INNER, CamShape, FaceOutline, Flank, cam_frame_rotation, relative_motion, size_entry, sliding
from core.design import DiskCam, Flat, Knife, OffsetFlat, Roller, Shoe, TiltedFlat, si
from core.errors import NoCam, angle_ranges
from core.findings import ERROR, Finding
from core.followers.dimensions import rounded
from core.instant_centres import cam_follower_centre
from core.mechanism.kinematics import REVOLUTE, Kinematics
from core.motion.extremes import Extremes
from core.number_text import COMPARED_DIGITS, result_text
from core.numerics.derivatives import between_lines, cross, dot, heading, spread
from core.numerics.lazy import once

# -- A straight face on the cam, in a body that slides or swings ------------------------------------------------


ROUNDS = 20  # of the search for a base radius
DIGITS = 5  # of the base radius that is proposed
NEAR = 1e-4  # relative: a base radius so little above the limit is accepted
MARGIN = 0.1  # of a drawn face beyond its contacts, relative to their range
NO_RADIUS = (
    "no larger base radius removes the undercut: lengthen the rise, lower the motion, or put the pivot farther away"
)
THICK = 0.06  # of a drawn face, relative to the cam's size


def face_normal(face: Flat) -> complex:
    """The face's normal m in the frame of its body, from the cam to the face: the x axis turned by the tilt."""
    return heading(np.radians(face.tilt_deg))


def envelope(kinematics: Kinematics, face: Flat, cam: object, rotation_sign: float) -> CamShape:
    """Cam under a straight face of normal m through the reference point R, by its support function; ψ the angle from m to the travel.

    In the cam's frame the face's line has the normal angle ν = arg m - dθ and the distance h = Re(m̄R) from the cam
    centre, so with derivatives by ν: contact C = m(h + i h_ν), h_ν = h'/(φ' - d); radius of curvature ρ = h + h_νν,
    h_νν = (h''(φ' - d) - h'φ'')/(φ' - d)³. φ is the rotation of the follower, ′ the derivative by cam angle θ. The contact has
    the distance x = h_ν - Im(m̄R) from R along the face. The pressure angle ψ is the angle between the line of m and the
    velocity of the follower's point at the contact.

    Parameters
    ----------
    kinematics : Kinematics
    face : Flat
    cam : DiskCam or LinkageCam
        The design's table ``cam``, which names the field in a fault.
    rotation_sign : float
        d = +1 where the cam turns counter-clockwise, -1 clockwise.

    Returns
    -------
    CamShape

    Raises
    ------
    NoCam
        Where the face passes the cam centre, or turns as fast as the cam.

    References
    ----------
    Support function of the face; definition of the pressure angle.
    """
    motion, follower = relative_motion(kinematics, rotation_sign), kinematics.follower
    r, turn = follower.origin, follower.turn
    m = face_normal(face) * follower.unit
    into_cam = -m
    rate = turn[1] - rotation_sign
    h, g = dot(m, r[0]), cross(m, r[0])
    _require_cam(kinematics, h, rotation_sign * rate, cam, face.noun)
    h_prime = turn[1] * g + dot(m, r[1])
    slope = h_prime / rate  # h_ν
    to_cam_frame = cam_frame_rotation(kinematics, rotation_sign)

    @once
    def contact() -> np.ndarray:
        point = np.empty(np.broadcast(h, slope).shape, dtype=complex)
        point.real, point.imag = h, slope
        return np.multiply(point, m, out=point)

    @once
    def radius() -> np.ndarray:
        a, b = turn[1], turn[2]
        second = b * g - a * a * h + 2.0 * a * cross(m, r[1]) + dot(m, r[2])  # h''
        return np.asarray(h + (second * rate - h_prime * b) / (rate * rate * rate))

    flank = Flank(
        straight=True,
        name=INNER,
        body=kinematics.carrier,
        reference=r[0],
        relative_velocity=lambda: motion[1],
        centre=lambda: cam_follower_centre(kinematics, rotation_sign),
        profile=lambda: contact() * to_cam_frame(),
        contact=contact,
        normal=into_cam,
        pressure_angle=lambda: between_lines(m, _travel(kinematics, contact())),
        profile_curvature=lambda: _inverse(radius()),
        profile_velocity=lambda: 1j * m * (radius() * rate) * to_cam_frame(),
        sliding=lambda: sliding(kinematics, motion, contact(), into_cam, rotation_sign),
        support=h,
        support_angle=lambda: m * to_cam_frame(),
        profile_radius=radius,
        on_face=lambda: slope - g,
    )
    return CamShape((flank,), rotation_sign)


@np.errstate(divide="ignore")
def _inverse(radius: np.ndarray) -> np.ndarray:
    return 1.0 / radius


def _travel(kinematics: Kinematics, contact: np.ndarray) -> np.ndarray:
    """Direction (n,) of the velocity of the follower's point at the contact: about its pivot, or along its guide."""
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == REVOLUTE:
        return 1j * (contact - kinematics.bodies[pair.body].position(pair.point))
    return kinematics.line(pair)


def _require_cam(kinematics: Kinematics, support: np.ndarray, rate: np.ndarray, cam: object, name: str) -> None:
    too_fast = spread(rate >= 0.0, support.shape[-1])
    NoCam.raise_where(
        too_fast,
        lambda: NoCam(
            f"the {name} turns as fast as the cam, or faster: no cam can touch it on the outside",
            "motion.segments",
            "lengthen the rise, or lower the motion",
            angle_ranges(kinematics.theta, too_fast),
        ),
    )
    outside = support <= 0.0
    NoCam.raise_where(
        outside,
        lambda: NoCam(
            f"the {name} passes the cam centre by {result_text(-support.min() * 1e3, 6)} mm, so no cam radius is left",
            *size_entry(cam, name, 0.0),
            angle_ranges(kinematics.theta, outside),
        ),
    )


def is_undercut(extremes: Mapping[str, Extremes], face: Flat) -> bool:
    """Whether the smallest radius of curvature is 0 or less: the profile has a cusp, or would have to be concave."""
    return extremes["profile_radius"].low.value <= 0.0


def contact_distance(shape: CamShape, face: Flat) -> np.ndarray:
    """Distance of the profile's points from the face at the cam angle at which they are in contact.

    Parameters
    ----------
    shape : CamShape
    face : Flat

    Returns
    -------
    ndarray (n,) [m]
    """
    flank = shape.flank
    return np.abs(dot(flank.support_angle, shape.flank.profile) - flank.support)


def gaps(shape: CamShape, face: Flat, positions: int) -> np.ndarray:
    """Least distance of the profile from the line of the face, by brute force; negative where the profile enters it.

    Parameters
    ----------
    shape : CamShape
    face : Flat
    positions : int
        Number m of cam positions.

    Returns
    -------
    ndarray (m,) [m]
    """
    flank, profile = shape.flank, shape.flank.profile
    step = max(1, profile.size // positions)
    rows = zip(flank.support_angle[::step], flank.support[::step], strict=True)
    return np.array([float((h - dot(m, profile)).min()) for m, h in rows])


def outline(shape: CamShape, face: Flat, kinematics: Kinematics) -> FaceOutline:
    """The face as a plate, attached at the middle of its back; without a stated width a little wider than its range."""
    flank, m, dimensions = shape.flank, face_normal(face), si(face)
    size = float(np.abs(shape.flank.contact).max())
    if dimensions.face_half_width is None:
        margin = MARGIN * float(np.ptp(flank.on_face)) or MARGIN * size
        low, high = float(flank.on_face.min()) - margin, float(flank.on_face.max()) + margin
    else:
        low, high = (
            dimensions.face_centre - dimensions.face_half_width,
            dimensions.face_centre + dimensions.face_half_width,
        )
    thick = THICK * size
    corners = m * np.array([1j * low, 1j * high, thick + 1j * high, thick + 1j * low, 1j * low])
    return FaceOutline(corners, m * complex(thick, 0.5 * (low + high)))


def findings(extremes: Mapping[str, Extremes], face: Flat, cam: DiskCam, least_at: LeastAt) -> list[Finding]:
    """Findings for a radius of curvature that is not positive, and for a contact beyond the face."""
    return [*_undercut(extremes, face, cam, least_at), *_too_narrow(extremes, face)]


def _undercut(extremes: Mapping[str, Extremes], face: Flat, cam: DiskCam, least_at: LeastAt) -> list[Finding]:
    if not is_undercut(extremes, face):
        return []
    least = extremes["profile_radius"].low
    values: dict[str, float | str] = {"radius_mm": 1e3 * least.value, "face": face.face, "remedy": NO_RADIUS}
    base_radius = _base_radius(cam.base_radius_mm, 1e3 * least.value, least_at)
    if base_radius:
        values |= {
            "base_radius_mm": base_radius,
            "remedy": f"a base radius of {result_text(base_radius, COMPARED_DIGITS)} mm is sufficient",
        }
    return [Finding("undercut", ERROR, size_entry(cam, "", 0.0)[0], degrees(least.theta), values)]


def _base_radius(base: float, least: float, least_at: LeastAt) -> float:
    """The least base radius [mm], rounded up, that keeps the radius of curvature positive; 0 if the search fails.

    least: the least radius of curvature [mm] at the base radius ``base`` [mm]. It grows by the same amount under a face
    that slides, and faster under one that swings: the search is by secants (Illinois), below the radius from which on
    there is no cam (``wall``).
    """
    below, above, wall, radius = (base, least), None, math.inf, base - least
    for _ in range(ROUNDS):
        if radius >= wall:
            radius = 0.5 * (below[0] + wall)
        radius = float(rounded(radius, math.ceil, DIGITS))
        if above and radius >= above[0]:
            return above[0]
        if radius <= below[0] or radius >= wall:
            break
        value = 1e3 * least_at("profile_radius", radius)
        if math.isnan(value):
            wall = radius
            continue
        if value > 0.0:
            above = (radius, value)
        else:
            below = (radius, value)
            above = above and (above[0], 0.5 * above[1])
        end = above or (radius - value, 0.0)
        radius = below[0] - below[1] * (end[0] - below[0]) / (end[1] - below[1])
        if above and above[0] - radius < NEAR * radius:
            return above[0]
        radius *= 1.0 + 0.5 * NEAR
    return above[0] if above else 0.0


def _too_narrow(extremes: Mapping[str, Extremes], face: Flat) -> list[Finding]:
    """Finding where the contact is farthest beyond the face, with the half width about its centre that contains it."""
    half, centre = face.face_half_width_mm, face.face_centre_mm
    if half is None:
        return []
    contact = extremes["contact_on_face"]
    worst = max(contact.low, contact.high, key=lambda end: abs(1e3 * end.value - centre))
    needed = abs(1e3 * worst.value - centre)
    if needed <= half:
        return []
    values = {"contact_mm": 1e3 * worst.value, "needed_mm": needed, "half_width_mm": half}
    return [Finding("face-too-narrow", ERROR, "follower.face_half_width_mm", degrees(worst.theta), values)]


# -- faces of followers, one row each ---------------------------------------------------------------------------


ExtremesByName = Mapping[str, Extremes]
LeastAt = Callable[[str, float], float]


class FaceRow(NamedTuple):
    """Properties of a face; ``face`` is its table of the design, with its size.

    Attributes
    ----------
    envelope : kinematics, face, cam, sense of rotation -> the cam's shape; raises NoCam
    limits : quantities whose refined extremes its findings are taken from
    undercut : extremes, face -> whether the profile has a cusp, or crosses itself where it is curved too much
    findings : extremes, face, cam, least_at -> the findings besides the pressure angle; least_at: quantity, base radius
        [mm] -> the refined least value of the quantity with this base radius, NaN where there is no cam
    proof : name of its tangency in the certificate
    contact_distance : shape, face -> (n,) [m] distance of the profile's points from the face, which should be 0
    gaps : shape, face, positions -> (m,) [m] least distance of any profile point from the face, by brute force
    outline : shape, face, kinematics -> its outline
    rolls : it turns about its axis, so that it does not slide on the cam
    steep : what makes its pressure angle large, and the field of that; empty where it is the cam's size
    """

    envelope: Callable[[Kinematics, Any, Any, float], CamShape]
    limits: tuple[str, ...]
    undercut: Callable[[ExtremesByName, Any], bool]
    findings: Callable[[ExtremesByName, Any, Any, LeastAt], list[Finding]]
    proof: str
    contact_distance: Callable[[CamShape, Any], np.ndarray]
    gaps: Callable[[CamShape, Any, int], np.ndarray]
    outline: Callable[[CamShape, Any, Kinematics], FaceOutline]
    rolls: bool = False
    steep: tuple[str, str] = ("", "")


def _round(proof: str = "face_tangency", rolls: bool = False) -> FaceRow:
    return FaceRow(
        shape.envelope,
        ("pressure_angle", "pitch_curvature"),
        shape.is_undercut,
        shape.findings,
        proof,
        shape.contact_distance,
        shape.gaps,
        shape.outline,
        rolls,
    )


_FLAT = FaceRow(
    envelope, ("pressure_angle", "profile_radius", "contact_on_face"), is_undercut,
    findings, "face_tangency", contact_distance, gaps, outline,
)  # fmt: skip

FACES: Mapping[type, FaceRow] = MappingProxyType(
    {
        Roller: _round("roller_tangency", rolls=True),
        Knife: _round(),
        Shoe: _round(),
        TiltedFlat: _FLAT._replace(steep=("tilt", "follower.face_tilt_deg")),
        OffsetFlat: _FLAT._replace(steep=("offset from the pivot", "follower.face_offset_mm")),
    }
)


def row_of(face: Any) -> FaceRow:
    """The row of a face."""
    return FACES[type(face)]
