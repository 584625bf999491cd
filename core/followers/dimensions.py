"""Dimensions of followers and cams for drawings, and lengths of a follower in its base position.

A dimension is given by points [m] in the frame of a body, or in the global frame where it does not move.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import (
    Cam,
    CamSlider,
    Design,
    Follower,
    Linkage,
    LinkPoint,
    Oscillating,
    OscillatingFlat,
    Pushrod,
    Rocker,
    Rolling,
    RoundFace,
    SecondArm,
    Translating,
    face_of,
    si,
)
from core.errors import NoAssembly
from core.frozen import frozen
from core.mechanism.dyads import opposite_angle
from core.mechanism.kinematics import FRAME, Kinematics
from core.number_text import result_text
from core.numerics.derivatives import heading

# -- dimensions of a drawing ------------------------------------------------------------------------------------


LENGTH, RADIUS, ANGLE = "length", "radius", "angle"


@frozen
class Dimension:
    """A dimension of a drawing.

    Attributes
    ----------
    kind : str
        LENGTH, RADIUS or ANGLE.
    symbol : str
    value : float
        In mm or deg.
    body : str
        Body in whose frame the points are given.
    points : tuple of complex
        In m. Two ends of a length; centre and a point of the circle of a radius; vertex and a point on each leg of an angle,
        counter-clockwise from the first where the value is positive.
    along : complex
        Unit vector in which a length is measured; 0 from end to end.
    """

    kind: str
    symbol: str
    value: float
    body: str
    points: tuple[complex, ...]
    along: complex = 0j


def dimensions_of(design: Design, kinematics: Kinematics) -> list[Dimension]:
    """Dimensions of the mechanism and the cam of a drive in the position of the kinematics."""
    drive = design.drive
    return [*MECHANISM_DIMENSIONS[type(drive.mechanism)](design, kinematics), *_cam_dimensions(design, kinematics)]


TYPED, MEASURED = 9, 5
"""Significant digits of a typed length, without rounding errors, and of one measured between points."""


def _length(
    symbol: str, body: str, start: complex, end: complex, along: complex = 0j, digits: int = TYPED
) -> Iterator[Dimension]:
    """A length, unless its ends coincide."""
    size = abs(end - start) if along == 0 else abs(((end - start) * along.conjugate()).real)
    if size > 1e-9 * max(abs(start), abs(end)):
        yield Dimension(LENGTH, symbol, float(f"{size * 1e3:.{digits}g}"), body, (start, end), along)


def _coordinates(point: complex) -> Iterator[Dimension]:
    """Coordinates x and y of a point from the cam centre."""
    yield from _length("x ", FRAME, 0j, point, 1.0 + 0j)
    yield from _length("y ", FRAME, 0j, point, 1j)


def _points(kinematics: Kinematics, body: str) -> Mapping[str, complex]:
    return kinematics.bodies[body].points


def _second_arm(follower: Any, points: Mapping[str, complex], body: str = "arm") -> Iterator[Dimension]:
    if follower.second is not None:
        corners = (points["pivot"], points["roller"], points["second_roller"])
        yield from _length("Zl₂ ", body, corners[0], corners[2])
        yield Dimension(ANGLE, "", follower.second.angle_deg, body, corners)


def _cam_slider(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    follower: Any = design.drive.mechanism
    g, arm, rod = si(follower), _points(kinematics, "arm"), _points(kinematics, "rod")
    pivot = complex(g.pivot_x, g.pivot_y)
    yield from _length("L1 ", "arm", arm["pivot"], arm["arm_pin"])
    yield from _length("Zl ", "arm", arm["pivot"], arm["roller"])
    yield from _length("L2 ", "rod", rod["arm_pin"], rod["slider_pin"])
    yield Dimension(ANGLE, "γ ", follower.fixed_angle_deg, "arm", (arm["pivot"], arm["arm_pin"], arm["roller"]))
    yield from _second_arm(follower, arm)
    yield from _coordinates(pivot)
    guide = cmath.rect(1.0, g.guide_angle)
    yield from _length("H ", FRAME, pivot, pivot + 1j * guide * g.guide_height, 1j * guide)


def _translating(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    follower: Any = design.drive.mechanism
    g, origin = si(follower), kinematics.follower.origin[0]
    along = cmath.rect(1.0, g.direction)
    lowest = min((complex(z) for z in origin), key=lambda z: (z * along.conjugate()).real)
    yield from _length("e ", FRAME, 0j, 1j * along * g.offset, 1j * along)
    tilt = getattr(follower.face, "face_tilt_deg", 0.0)
    if tilt:
        square = 1j * along * abs(lowest) / kinematics.follower.unit[0]
        yield Dimension(ANGLE, "", tilt, "follower", (0j, -square, -square * cmath.rect(1.0, tilt * cmath.pi / 180.0)))
    if follower.second is not None:
        points = _points(kinematics, "follower")
        yield from _length("", "follower", points["roller"], points["second_roller"])


def _oscillating(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    follower: Any = design.drive.mechanism
    g, arm = si(follower), _points(kinematics, "arm")
    yield from _length("Zl ", "arm", arm["pivot"], arm["roller"])
    yield from _second_arm(follower, arm)
    yield from _coordinates(complex(g.pivot_x, g.pivot_y))


def _oscillating_flat(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    g, arm = si(design.drive.mechanism), _points(kinematics, "arm")
    yield from _length("f ", "arm", arm["pivot"], arm["roller"])
    yield from _coordinates(complex(g.pivot_x, g.pivot_y))


def _rocker(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    follower: Any = design.drive.mechanism
    g, rocker = si(follower), _points(kinematics, "rocker")
    yield from _length("Zl ", "rocker", rocker["pivot"], rocker["roller"])
    yield from _pad(follower, rocker, "roller")
    yield from _second_arm(follower, rocker, "rocker")
    yield from _coordinates(complex(g.pivot_x, g.pivot_y))


def _pushrod(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    follower: Any = design.drive.mechanism
    g, rod, rocker = si(follower), _points(kinematics, "pushrod"), _points(kinematics, "rocker")
    along = cmath.rect(1.0, g.direction)
    yield from _length("e ", FRAME, 0j, 1j * along * g.offset, 1j * along)
    yield from _length("L ", "pushrod", rod["lower_ball"], rod["upper_ball"])
    yield from _length("a ", "rocker", rocker["pivot"], rocker["upper_ball"])
    yield from _pad(follower, rocker, "upper_ball")
    yield from _coordinates(complex(g.pivot_x, g.pivot_y))


def _pad(follower: Any, points: Mapping[str, complex], arm: str) -> Iterator[Dimension]:
    """Arm of the pad, and its angle from the arm to a point of the rocker."""
    yield from _length("p ", "rocker", points["pivot"], points["pad_centre"])
    corners = (points["pivot"], points[arm], points["pad_centre"])
    yield Dimension(ANGLE, "γ ", follower.pad_angle_deg, "rocker", corners)


def _linkage(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    """Distances of every moving link from its first point to each of the others."""
    for name, pose in kinematics.bodies.items():
        points = list(pose.points.values())
        if name not in (FRAME, kinematics.follower_body):
            for point in points[1:]:
                yield from _length("", name, points[0], point, digits=MEASURED)


MECHANISM_DIMENSIONS: Mapping[type, Callable[[Design, Kinematics], Iterator[Dimension]]] = MappingProxyType(
    {
        CamSlider: _cam_slider,
        Translating: _translating,
        Oscillating: _oscillating,
        OscillatingFlat: _oscillating_flat,
        Rocker: _rocker,
        Pushrod: _pushrod,
        Linkage: _linkage,
    }
)
"""Class of the mechanism -> function for its dimensions."""


def _cam_dimensions(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    """Base circle, face, and the second roller of a conjugate pair."""
    drive = design.drive
    if not drive.has_disk:
        return
    base = getattr(drive.cam, "base_radius_mm", 0.0)
    if base:
        yield Dimension(RADIUS, "Br ", base, FRAME, (0j, cmath.rect(1e-3 * base, BASE_DIRECTION)))
    radius = drive.face.radius_mm
    if radius:
        yield Dimension(
            RADIUS, "Rr ", radius, kinematics.follower_body, (0j, cmath.rect(1e-3 * radius, FACE_DIRECTION))
        )
    second = getattr(drive.cam.form, "second", None)
    if second is not None and "second_roller" in kinematics.bodies[kinematics.carrier].points:
        centre = kinematics.bodies[kinematics.carrier].points["second_roller"]
        ends = (centre, centre + cmath.rect(1e-3 * second.roller_radius_mm, FACE_DIRECTION))
        yield Dimension(RADIUS, "Rr₂ ", second.roller_radius_mm, kinematics.carrier, ends)


BASE_DIRECTION, FACE_DIRECTION = -2.2, 0.7  # [rad] of the arrows to the circles


# -- lengths of a follower in the base position -----------------------------------------------------------------


FACE = "face"
"""Name of the middle of a straight face, which can be dragged; no body has such a point."""

SECOND = "second_roller"
"""Name of the follower's point at the centre of the second roller of a conjugate pair."""


def second_on_arm(second: SecondArm | None, first: float = 0.0) -> tuple[LinkPoint, ...]:
    """Centre of the second roller in the frame of the arm, where the first roller's arm has the angle `first` [rad]."""
    if second is None:
        return ()
    at = second.arm_mm * heading(first + si(second).angle)
    return (LinkPoint(SECOND, at.real, at.imag),)


def rounded(length: float, direction: Callable[[float], int], digits: int = 6) -> str:
    """Text of a length with some significant digits, rounded by `ceil` or `floor` so that the printed limit is allowed."""
    if length <= 0.0:
        return "0"
    exponent = math.floor(math.log10(length)) - digits + 1
    return f"{direction(length / 10.0**exponent) * 10.0**exponent:.12g}"


def _triangle_range(first: float, second: float) -> str:
    """Range in mm of the third side of a triangle with two given sides [m], with as many digits as tell its ends apart."""
    low, high = abs(first - second) * 1e3, (first + second) * 1e3
    ends = [(rounded(low, math.ceil, digits), rounded(high, math.floor, digits)) for digits in range(6, 13)]
    return " ... ".join(next((pair for pair in ends if float(pair[0]) < float(pair[1])), ends[-1]))


def reach_of(follower: Follower, cam: Cam) -> float:
    """Distance of the face's reference from the cam centre on the base circle [m]: base radius + radius of the face."""
    return 1e-3 * cam.base_radius_mm + 1e-3 * face_of(follower, cam).radius_mm


def angle_at_pivot(arm: float, pivot: float, reach: float, face: RoundFace | Rolling, name: str, field: str) -> float:
    """Angle [rad] at the pivot of the triangle with the sides arm, pivot and reach.

    Parameters
    ----------
    arm, pivot, reach : float
        Length of the arm, distance of the pivot from the cam centre, and Br + Rr [m].
    face : RoundFace or Rolling
        Face at the arm's end.
    name, field : str
        Name and path of the arm, for messages.

    Returns
    -------
    float

    Raises
    ------
    NoAssembly
        The three lengths make no triangle.
    """
    angle = opposite_angle(arm, pivot, reach)
    NoAssembly.raise_where(
        np.isnan(angle),
        lambda: NoAssembly(
            f"the {face.noun} cannot reach the base circle: {name} {result_text(arm * 1e3, 6)} mm, pivot "
            f"{result_text(pivot * 1e3, 6)} mm from the cam "
            f"centre, {face.reach} {result_text(reach * 1e3, 6)} mm make no triangle",
            field,
            f"make the {name} {_triangle_range(pivot, reach)} mm long, or {face.reach} "
            f"{_triangle_range(pivot, arm)} mm",
        ),
    )
    return angle
