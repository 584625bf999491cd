"""Faces of followers, one row each: the envelope, what limits it, how it is proved, how it looks, whether it rolls."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.cam import shape
from core.cam.shape import INNER, CamShape, FaceOutline, Flank, relative_motion, size_of, sliding, turned_back
from core.design import DiskCam, Flat, Knife, OffsetFlat, Roller, Shoe, TiltedFlat, si
from core.errors import NoCam, angle_ranges
from core.findings import ERROR, Finding
from core.followers.dimensions import rounded
from core.instant_centres import cam_follower_centre
from core.mechanism.kinematics import REVOLUTE, Kinematics
from core.motion.extremes import Range
from core.numerics.derivatives import between_lines, cross, dot, heading, spread
from core.numerics.lazy import once

# -- A straight face on the cam, in a body that slides or swings ------------------------------------------------


ROUNDS = 20  # of a search for a base radius
DIGITS = 5  # of a base radius that would do
NEAR = 1e-4  # of that: what is less above the limit will do
MARGIN = 0.1  # of a drawn face beyond where it touches, parts of that
NO_RADIUS = (
    "no larger base radius was found that would do: lengthen the rise, lower the motion, or put the pivot farther away"
)
THICK = 0.06  # of a drawn face, parts of the cam's size


def normal_of(face: Flat) -> complex:
    """The face's normal m in the frame of its body, from the cam to the face: the body's x axis, but for its tilt."""
    return heading(np.radians(face.tilt_deg))


def envelope(kinematics: Kinematics, face: Flat, cam: object, sense: float) -> CamShape:
    """Profile of a disk cam under a straight face of normal m through the reference point R, by its support function.

    In the cam's frame the face's line has the normal angle ν = arg m - dθ and the distance h = Re(m̄R) from the cam centre, so
    with derivatives by ν: contact C = m(h + i h_ν), h_ν = h'/(φ' - d); radius of curvature ρ = h + h_νν,
    h_νν = (h''(φ' - d) - h'φ'')/(φ' - d)³. It lies x = h_ν - Im(m̄R) along the face from R. Raises NoCam where the face
    passes the cam centre, or turns as fast as the cam.
    """
    motion, follower = relative_motion(kinematics, sense), kinematics.follower
    r, turn = follower.origin, follower.turn
    m = normal_of(face) * follower.unit
    into = -m
    rate = turn[1] - sense
    h, g = dot(m, r[0]), cross(m, r[0])
    _require_cam(kinematics, h, sense * rate, cam, face.noun)
    by_angle = turn[1] * g + dot(m, r[1])  # h'
    slope = by_angle / rate  # h_ν
    back = turned_back(kinematics, sense)

    @once
    def contact() -> np.ndarray:
        place = np.empty(np.broadcast(h, slope).shape, dtype=complex)
        place.real, place.imag = h, slope
        return np.multiply(place, m, out=place)

    @once
    def radius() -> np.ndarray:
        a, b = turn[1], turn[2]
        second = b * g - a * a * h + 2.0 * a * cross(m, r[1]) + dot(m, r[2])  # h''
        return np.asarray(h + (second * rate - by_angle * b) / (rate * rate * rate))

    flank = Flank(
        straight=True,
        name=INNER,
        body=kinematics.carrier,
        reference=r[0],
        relative_velocity=lambda: motion[1],
        centre=lambda: cam_follower_centre(kinematics, sense),
        profile=lambda: contact() * back(),
        contact=contact,
        normal=into,
        pressure_angle=lambda: between_lines(m, _travel(kinematics, contact())),
        profile_curvature=lambda: _inverse(radius()),
        profile_velocity=lambda: 1j * m * (radius() * rate) * back(),
        sliding=lambda: sliding(kinematics, motion, contact(), into, sense),
        support=h,
        support_angle=lambda: m * back(),
        profile_radius=radius,
        on_face=lambda: slope - g,
    )
    return CamShape((flank,), sense)


@np.errstate(divide="ignore")
def _inverse(radius: np.ndarray) -> np.ndarray:
    return 1.0 / radius


def _travel(kinematics: Kinematics, contact: np.ndarray) -> np.ndarray:
    """The direction (n,) in which the follower's point at the contact goes: about its pivot, or along its guide."""
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == REVOLUTE:
        return 1j * (contact - kinematics.bodies[pair.body].position(pair.point))
    return kinematics.line(pair)


def _require_cam(kinematics: Kinematics, support: np.ndarray, rate: np.ndarray, cam: object, name: str) -> None:
    fast = spread(rate >= 0.0, support.shape[-1])
    NoCam.where(
        fast,
        lambda: NoCam(
            f"the {name} turns as fast as the cam, or faster: no cam can touch it on the outside",
            "motion.segments",
            "lengthen the rise, or lower the motion",
            angle_ranges(kinematics.theta, fast),
        ),
    )
    bad = support <= 0.0
    NoCam.where(
        bad,
        lambda: NoCam(
            f"the {name} passes the cam centre, by {-support.min() * 1e3:.9g} mm: no cam radius is left",
            *size_of(cam, name, 0.0),
            angle_ranges(kinematics.theta, bad),
        ),
    )


def is_undercut(extremes: Mapping[str, Range], face: Flat) -> bool:
    """Whether the radius of curvature somewhere is 0 or less: there the profile has a cusp, or would have to be concave."""
    return extremes["profile_radius"].low.value <= 0.0


def own_distance(shape: CamShape, face: Flat) -> np.ndarray:
    """Distance of the profile's own points from the face (n,) [m]."""
    flank = shape.flank
    return np.abs(dot(flank.support_angle, shape.flank.profile) - flank.support)


def gaps(shape: CamShape, face: Flat, positions: int) -> np.ndarray:
    """Least distance of all profile points from the line of the face [m], by brute force at ``positions`` cam positions (m,):
    negative where the profile enters the face, positive where it stays away from it."""
    flank, profile = shape.flank, shape.flank.profile
    step = max(1, profile.size // positions)
    rows = zip(flank.support_angle[::step], flank.support[::step], strict=True)
    return np.array([float((h - dot(m, profile)).min()) for m, h in rows])


def outline(shape: CamShape, face: Flat, kinematics: Kinematics) -> FaceOutline:
    """The face as a plate, held at the middle of its back: as wide as it is, else a little wider than where it touches."""
    flank, m, own = shape.flank, normal_of(face), si(face)
    size = float(np.abs(shape.flank.contact).max())
    if own.face_half_width is None:
        room = MARGIN * float(np.ptp(flank.on_face)) or MARGIN * size
        low, high = float(flank.on_face.min()) - room, float(flank.on_face.max()) + room
    else:
        low, high = own.face_centre - own.face_half_width, own.face_centre + own.face_half_width
    thick = THICK * size
    corners = m * np.array([1j * low, 1j * high, thick + 1j * high, thick + 1j * low, 1j * low])
    return FaceOutline(corners, m * complex(thick, 0.5 * (low + high)))


def findings(extremes: Mapping[str, Range], face: Flat, cam: DiskCam, least_at: LeastAt) -> list[Finding]:
    """A radius of curvature that is not positive, and a face that the contact leaves."""
    return [*_undercut(extremes, face, cam, least_at), *_too_narrow(extremes, face)]


def _undercut(extremes: Mapping[str, Range], face: Flat, cam: DiskCam, least_at: LeastAt) -> list[Finding]:
    if not is_undercut(extremes, face):
        return []
    least = extremes["profile_radius"].low
    values: dict[str, float | str] = {"radius_mm": 1e3 * least.value, "face": face.face, "remedy": NO_RADIUS}
    wanted = _base_radius(cam.base_radius_mm, 1e3 * least.value, least_at)
    if wanted:
        values |= {"base_radius_mm": wanted, "remedy": f"a base radius of {wanted:.5g} mm would do"}
    return [Finding("undercut", ERROR, size_of(cam, "", 0.0)[0], degrees(least.theta), values)]


def _base_radius(base: float, least: float, least_at: LeastAt) -> float:
    """The base radius [mm], to a few digits and upwards, that keeps the radius of curvature positive; 0 where none was found.

    least: the least radius of curvature with the base radius ``base`` [mm], which grows as that does under a face that slides,
    and faster under one that swings: by secants (Illinois), below the radius from which on there is no cam (``wall``).
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
        found = 1e3 * least_at("profile_radius", radius)
        if math.isnan(found):
            wall = radius
            continue
        if found > 0.0:
            above = (radius, found)
        else:
            below = (radius, found)
            above = above and (above[0], 0.5 * above[1])
        far = above or (radius - found, 0.0)
        radius = below[0] - below[1] * (far[0] - below[0]) / (far[1] - below[1])
        if above and above[0] - radius < NEAR * radius:
            return above[0]
        radius *= 1.0 + 0.5 * NEAR
    return above[0] if above else 0.0


def _too_narrow(extremes: Mapping[str, Range], face: Flat) -> list[Finding]:
    """Where the contact runs farthest beyond the face, and the half width about its centre that would do."""
    half, centre = face.face_half_width_mm, face.face_centre_mm
    if half is None:
        return []
    found = extremes["contact_on_face"]
    worst = max(found.low, found.high, key=lambda end: abs(1e3 * end.value - centre))
    needed = abs(1e3 * worst.value - centre)
    if needed <= half:
        return []
    values = {"contact_mm": 1e3 * worst.value, "needed_mm": needed, "half_width_mm": half}
    return [Finding("face-too-narrow", ERROR, "follower.face_half_width_mm", degrees(worst.theta), values)]


# -- faces of followers, one row each ---------------------------------------------------------------------------


Extremes = Mapping[str, Range]
LeastAt = Callable[[str, float], float]


class FaceRow(NamedTuple):
    """What every face fills; ``face`` is its part of the design, with its size.

    envelope      kinematics, face, cam, sense of rotation -> the cam's shape; raises NoCam
    limits        quantities whose refined extremes its findings are taken from
    undercut      extremes, face -> whether the profile has a cusp, or crosses itself where it is curved too much
    findings      extremes, face, cam, least_at -> what is exceeded, the pressure angle aside; least_at: quantity, base radius
                  [mm] -> the quantity's refined least value with that one, NaN where there is no cam
    proof         name of its tangency in the certificate
    own_distance  shape, face -> (n,) [m] distance of the profile's own points from the face, which should be 0
    gaps          shape, face, positions -> (m,) [m] least distance of any profile point from the face, by brute force
    outline       shape, face, kinematics -> how it looks
    rolls         it turns on its own axis, so that nothing slides on the cam
    steep         what makes its pressure angle large, and the field of that; empty where it is the cam's size
    """

    envelope: Callable[[Kinematics, Any, Any, float], CamShape]
    limits: tuple[str, ...]
    undercut: Callable[[Extremes, Any], bool]
    findings: Callable[[Extremes, Any, Any, LeastAt], list[Finding]]
    proof: str
    own_distance: Callable[[CamShape, Any], np.ndarray]
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
        shape.own_distance,
        shape.gaps,
        shape.outline,
        rolls,
    )


_FLAT = FaceRow(
    envelope, ("pressure_angle", "profile_radius", "contact_on_face"), is_undercut,
    findings, "face_tangency", own_distance, gaps, outline,
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
