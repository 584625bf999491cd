"""Faces of followers, one row each: the envelope, what limits it, how it is proved, how it looks, whether it rolls."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.cam import flat_face, round_face
from core.cam.shape import CamShape, FaceOutline
from core.design import Knife, OffsetFlat, Roller, Shoe, TiltedFlat
from core.findings import Finding
from core.mechanism.kinematics import Kinematics
from core.motion.extremes import Range

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
        round_face.envelope,
        ("pressure_angle", "pitch_curvature"),
        round_face.is_undercut,
        round_face.findings,
        proof,
        round_face.own_distance,
        round_face.gaps,
        round_face.outline,
        rolls,
    )


_FLAT = FaceRow(
    flat_face.envelope, ("pressure_angle", "profile_radius", "contact_on_face"), flat_face.is_undercut,
    flat_face.findings, "face_tangency", flat_face.own_distance, flat_face.gaps, flat_face.outline,
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
