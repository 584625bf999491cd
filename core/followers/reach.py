"""Whether a follower's lengths meet in the base position: the roller on the base circle, motion at 0; and what to change."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from core.design import Cam, Follower, LinkPoint, Rolling, RoundFace, SecondArm, face_of, si
from core.errors import NoAssembly
from core.mechanism.triangle import opposite_angle
from core.numerics.vectors import heading

FACE = "face"
"""The middle of a face that has no round, as a place to be drawn elsewhere; no body has such a point."""

SECOND = "second_roller"
"""Name of the point of a follower at which the second roller of a conjugate pair stands."""


def second_on_arm(second: SecondArm | None, first: float = 0.0) -> tuple[LinkPoint, ...]:
    """The second roller's centre in the frame of the arm; first: angle of the first roller's arm there [rad]."""
    if second is None:
        return ()
    at = second.arm_mm * heading(first + si(second).angle)
    return (LinkPoint(SECOND, at.real, at.imag),)


def rounded(length: float, direction: Callable[[float], int], digits: int = 6) -> str:
    """A length to so many digits, by ``ceil`` or ``floor``: what a reader then types in must not be refused again."""
    if length <= 0.0:
        return "0"
    places = math.floor(math.log10(length)) - digits + 1
    return f"{direction(length / 10.0**places) * 10.0**places:.12g}"


def _triangle_range(one: float, other: float) -> str:
    """The range of the third side of a triangle of two sides [m], in mm."""
    return f"{rounded(abs(one - other) * 1e3, math.ceil)} ... {rounded((one + other) * 1e3, math.floor)}"


def reach_of(follower: Follower, cam: Cam) -> float:
    """Distance of the face's reference from the cam centre on the base circle [m]: base radius + radius of the face."""
    return 1e-3 * cam.base_radius_mm + 1e-3 * face_of(follower, cam).radius_mm


def angle_at_pivot(arm: float, pivot: float, reach: float, face: RoundFace | Rolling, name: str, field: str) -> float:
    """The angle [rad] at the pivot of the triangle arm, pivot's distance from the cam centre, reach (Br + Rr) [m].

    face: at the arm's end; name, field: of the arm, as in messages. Raises NoAssembly where the three make no triangle.
    """
    angle = opposite_angle(arm, pivot, reach)
    NoAssembly.where(
        np.isnan(angle),
        lambda: NoAssembly(
            f"the {face.noun} cannot reach the base circle: {name} {arm * 1e3:.9g} mm, pivot {pivot * 1e3:.9g} mm from the cam "
            f"centre, {face.reach} {reach * 1e3:.9g} mm make no triangle",
            field,
            f"make the {name} {_triangle_range(pivot, reach)} mm long, or {face.reach} "
            f"{_triangle_range(pivot, arm)} mm",
        ),
    )
    return angle
