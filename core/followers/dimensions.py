"""Which lengths and angles a drawing of a drive can show, and between which places: the typed dimensions of followers and cams.

Each stands in the frame of a body, or in the global frame, where it never moves: places [m] there.
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
from core.numerics.derivatives import heading

# -- which lengths and angles a drawing of a drive can show, and between which places ---------------------------


LENGTH, RADIUS, ANGLE = "length", "radius", "angle"


@frozen
class Dimension:
    """One dimension: kind, symbol, value [mm, deg], and the body in whose frame its places [m] stand.

    places   of a length: its two ends; of a radius: centre and a place on the circle; of an angle: its vertex and a place on
             each leg, counter-clockwise from the first where the value is positive
    along    of a length: unit vector of the direction it is measured in; 0: from end to end
    """

    kind: str
    symbol: str
    value: float
    body: str
    places: tuple[complex, ...]
    along: complex = 0j


def dimensions_of(design: Design, kinematics: Kinematics) -> list[Dimension]:
    """The dimensions of a drive that stands on the positions of the kinematics."""
    drive = design.drive
    return [*OF_MECHANISM[type(drive.mechanism)](design, kinematics), *_of_cam(design, kinematics)]


TYPED, MEASURED = 9, 5
"""Digits of a length that was typed, without the last bits that its places keep; of one that is measured between places."""


def _length(
    symbol: str, body: str, one: complex, other: complex, along: complex = 0j, digits: int = TYPED
) -> Iterator[Dimension]:
    """None where its ends coincide."""
    size = abs(other - one) if along == 0 else abs(((other - one) * along.conjugate()).real)
    if size > 1e-9 * max(abs(one), abs(other)):
        yield Dimension(LENGTH, symbol, float(f"{size * 1e3:.{digits}g}"), body, (one, other), along)


def _coordinates(place: complex) -> Iterator[Dimension]:
    """x and y of a place from the cam centre."""
    yield from _length("x ", FRAME, 0j, place, 1.0 + 0j)
    yield from _length("y ", FRAME, 0j, place, 1j)


def _points(kinematics: Kinematics, body: str) -> Mapping[str, complex]:
    return kinematics.bodies[body].points


def _second_arm(follower: Any, points: Mapping[str, complex]) -> Iterator[Dimension]:
    if follower.second is not None:
        places = (points["pivot"], points["roller"], points["second_roller"])
        yield from _length("Zl₂ ", "arm", places[0], places[2])
        yield Dimension(ANGLE, "", follower.second.angle_deg, "arm", places)


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
    g, place = si(follower), kinematics.follower.origin[0]
    along = cmath.rect(1.0, g.direction)
    lowest = min((complex(z) for z in place), key=lambda z: (z * along.conjugate()).real)
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


def _linkage(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    """Of every link that moves, from its first point to each of the others."""
    for name, pose in kinematics.bodies.items():
        points = list(pose.points.values())
        if name not in (FRAME, kinematics.follower_body):
            for other in points[1:]:
                yield from _length("", name, points[0], other, digits=MEASURED)


OF_MECHANISM: Mapping[type, Callable[[Design, Kinematics], Iterator[Dimension]]] = MappingProxyType(
    {
        CamSlider: _cam_slider,
        Translating: _translating,
        Oscillating: _oscillating,
        OscillatingFlat: _oscillating_flat,
        Linkage: _linkage,
    }
)
"""Mechanism -> its dimensions."""


def _of_cam(design: Design, kinematics: Kinematics) -> Iterator[Dimension]:
    """Base circle, face, and the second roller of a conjugate pair."""
    drive = design.drive
    if drive.cam is None:
        return
    base = getattr(drive.cam, "base_radius_mm", 0.0)
    if base:
        yield Dimension(RADIUS, "Br ", base, FRAME, (0j, cmath.rect(1e-3 * base, BASE_AT)))
    radius = drive.face.radius_mm
    if radius:
        yield Dimension(RADIUS, "Rr ", radius, kinematics.follower_body, (0j, cmath.rect(1e-3 * radius, FACE_AT)))
    second = getattr(drive.cam.form, "second", None)
    if second is not None and "second_roller" in kinematics.bodies[kinematics.carrier].points:
        centre = kinematics.bodies[kinematics.carrier].points["second_roller"]
        places = (centre, centre + cmath.rect(1e-3 * second.roller_radius_mm, FACE_AT))
        yield Dimension(RADIUS, "Rr₂ ", second.roller_radius_mm, kinematics.carrier, places)


BASE_AT, FACE_AT = -2.2, 0.7  # directions of the arrows to the circles [rad]


# -- whether a follower's lengths meet in the base position -----------------------------------------------------


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
    NoAssembly.raise_where(
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
