"""Dimensions from places: a joint that can be drawn elsewhere is put where it is wanted at one cam angle, the typed values
follow.

What the motion says stays true: the cam angle, and how far the follower has gone there. So the base position is found
backwards, from the place at this angle less the motion.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import pi
from types import MappingProxyType
from typing import Any

from core.design import (
    CamSlider,
    Design,
    Knife,
    Oscillating,
    OscillatingFlat,
    Rolling,
    Shoe,
    TiltedFlat,
    Translating,
    entries,
    put,
    si,
)
from core.design.parts import SIDES
from core.errors import NoAssembly
from core.followers import built
from core.followers.cam_slider import LAYOUT_TABLE, base_position
from core.followers.dimensions import FACE, SECOND, reach_of
from core.frozen import frozen
from core.mechanism.checks import movable_points, point_changes
from core.mechanism.dyads import area4_of
from core.mechanism.kinematics import FRAME, Kinematics
from core.mechanism.mechanism import ROLLER
from core.units import split_unit, unit_kind

Changes = Mapping[str, Any]
"""Path -> value as in the file."""


@frozen
class Drag:
    """One joint: its name for the reader, the path of the value that is edited by it above all, and what follows from a place
    ``to`` [m] in the position that ``kinematics`` shows (n = 1)."""

    label: str
    field: str
    changes: Callable[[Design, Kinematics, complex], Changes]


def _pivot(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """It moves alone; all lengths stay."""
    return {"follower.pivot_x_mm": to.real * 1e3, "follower.pivot_y_mm": to.imag * 1e3}


def _arm_pin(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Slider arm, rod and fixed angle: pivot and slider stay where they are, the roller on the base circle."""
    pivot, slider = _at(kinematics, "pivot"), _at(kinematics, "slider_pin")
    return {
        "follower.slider_arm_mm": abs(to - pivot) * 1e3,
        "follower.rod_mm": abs(slider - to) * 1e3,
        **_turned_arm(design, kinematics, pivot, to, slider),
    }


def _slider_pin(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Rod, guide height and fixed angle: pivot and arm pin stay where they are, the roller on the base circle."""
    pivot, pin = _at(kinematics, "pivot"), _at(kinematics, "arm_pin")
    along = cmath.exp(1j * si(design.drive.mechanism).guide_angle)
    return {
        "follower.rod_mm": abs(to - pin) * 1e3,
        "follower.guide_height_mm": ((to - pivot) / along).imag * 1e3,
        **_turned_arm(design, kinematics, pivot, pin, to),
    }


def _turned_arm(design: Design, kinematics: Kinematics, pivot: complex, pin: complex, slider: complex) -> Changes:
    """Fixed angle and layout with which the pins of arm and rod stand at these places: γ = α0 - φ0 - δ, Shin1995 (5), with
    φ0 of the triangle whose slider is back at the base position. Raises NoAssembly where there is none."""
    follower = design.drive.mechanism
    assert isinstance(follower, CamSlider)
    g, base = si(follower), base_position(follower, _reach(design))
    along = cmath.exp(1j * g.guide_angle)
    arm, end = (pin - pivot) / along, (slider - pivot) / along
    sigma = math.copysign(1.0, (arm * end.conjugate()).imag)
    start = complex(end.real - float(kinematics.motion.displacement[0][0]), end.imag)
    l1, l2, r = abs(arm), abs(end - arm), abs(start)
    k = area4_of(r, l1, l2)
    if not k > 0.0:
        raise NoAssembly(
            f"slider arm {l1 * 1e3:.9g} mm and rod {l2 * 1e3:.9g} mm do not meet in the base position, where slider and "
            f"pivot are {r * 1e3:.9g} mm apart",
            "follower.rod_mm",
            "put the joint elsewhere",
        )
    phi = cmath.phase(start) + sigma * math.atan2(k, r * r + (l1 - l2) * (l1 + l2))
    layout = _layout(follower, slider_right=start.real > l1 * math.cos(phi))
    return {
        "follower.fixed_angle_deg": _near(base.alpha - phi - g.guide_angle, g.fixed_angle),
        "follower.layout": layout,
    }


def _roller(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Roller arm, fixed angle and base radius: arm, rod and slider stay where they are."""
    follower = design.drive.mechanism
    assert isinstance(follower, CamSlider)
    g, base = si(follower), base_position(follower, _reach(design))
    pivot = _at(kinematics, "pivot")
    arm = _at(kinematics, "arm_pin") - pivot
    fixed = g.fixed_angle + cmath.phase((to - pivot) / (arm * cmath.exp(1j * g.fixed_angle)))
    first = abs(to - pivot) * cmath.exp(1j * (base.phi + fixed + g.guide_angle))
    left = (first / -pivot).imag < 0.0  # of the ray to the cam: the roller arm turned clockwise from it
    return {
        "follower.roller_arm_mm": abs(to - pivot) * 1e3,
        "follower.fixed_angle_deg": _near(fixed, g.fixed_angle),
        "follower.layout": _layout(follower, roller_above=left == LAYOUT_TABLE[follower.layout].cam_left),
        "cam.base_radius_mm": abs(pivot + first) * 1e3 - design.drive.face.radius_mm,
    }


def _on_guide(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Offset and base radius: the roller has gone as far as the motion says."""
    g = si(design.drive.mechanism)
    place = to * cmath.exp(-1j * g.direction)
    back = place.real - float(kinematics.motion.displacement[0][0])
    if back <= 0.0:
        raise NoAssembly(
            f"in the base position the {design.drive.face.noun} would stand {-back * 1e3:.9g} mm behind the cam centre",
            "cam.base_radius_mm",
            "put it farther out",
        )
    return {
        "follower.offset_mm": place.imag * 1e3,
        "cam.base_radius_mm": REACHES[type(design.drive.follower.face)](design, complex(back, place.imag)) * 1e3
        - design.drive.face.radius_mm,
    }


def _of_face(design: Design, place: complex) -> float:
    """Distance of a tilted face from the cam centre where the line at the offset meets it at a place [m], in the guide's frame."""
    return (place * cmath.exp(-1j * si(design.drive.follower.face).face_tilt)).real


REACHES: Mapping[type, Callable[[Design, complex], float]] = MappingProxyType(
    {**dict.fromkeys((Rolling, Knife, Shoe), lambda design, place: abs(place)), TiltedFlat: _of_face}
)
"""Face -> its reach on the base circle [m] by where its reference stands there, in the guide's frame."""


def _on_arm(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Arm, side and base radius: the pivot stays, the arm has turned as far as the motion says."""
    follower = design.drive.mechanism
    assert isinstance(follower, Oscillating)
    pivot, turned = _at(kinematics, "pivot"), SIDES[follower.side] * float(kinematics.motion.displacement[0][0])
    first = (to - pivot) * cmath.exp(-1j * turned)  # in the base position
    side = "left" if (first / -pivot).imag > 0.0 else "right"
    return {
        "follower.arm_mm": abs(to - pivot) * 1e3,
        "follower.side": side,
        "cam.base_radius_mm": abs(pivot + first) * 1e3 - design.drive.face.radius_mm,
    }


def _second_arm(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """The second roller's arm and its angle from the first: nothing else moves."""
    follower: Any = design.drive.mechanism
    pivot = _at(kinematics, "pivot")
    between = cmath.phase((to - pivot) / (complex(kinematics.follower.origin[0][0]) - pivot))
    return {
        "follower.second.arm_mm": abs(to - pivot) * 1e3,
        "follower.second.angle_deg": _near(between, math.radians(follower.second.angle_deg)),
    }


def _behind(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """How far the second roller stands behind the first, along the guide."""
    along = cmath.rect(1.0, si(design.drive.mechanism).direction)
    distance = ((complex(kinematics.follower.origin[0][0]) - to) * along.conjugate()).real
    if distance <= 0.0:
        raise NoAssembly(
            "the second roller would stand before the first", "follower.second.distance_mm", "put it behind"
        )
    return {"follower.second.distance_mm": distance * 1e3}


def _face(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Face offset and base radius: the face goes through the place, and keeps its direction."""
    follower = design.drive.mechanism
    assert isinstance(follower, OscillatingFlat)
    normal = complex(kinematics.follower.unit[0])
    offset = ((to - _at(kinematics, "pivot")) * normal.conjugate()).real * 1e3
    return {
        "follower.face_offset_mm": offset,
        "cam.base_radius_mm": design.drive.cam.base_radius_mm + offset - follower.face.face_offset_mm,
    }


def _point(name: str) -> Callable[[Design, Kinematics, complex], Changes]:
    return lambda design, kinematics, to: point_changes(design, kinematics, name, to)


def _of_linkage(design: Design) -> Mapping[str, Drag]:
    return {name: Drag(f"joint {name}", path, _point(name)) for name, path in movable_points(design).items()}


DRAGS: Mapping[type, Mapping[str, Drag]] = MappingProxyType(
    {
        Oscillating: {
            "pivot": Drag("pivot", "follower.pivot_x_mm", _pivot),
            "roller": Drag("roller", "follower.arm_mm", _on_arm),
            SECOND: Drag("second roller", "follower.second.arm_mm", _second_arm),
        },
        OscillatingFlat: {
            "pivot": Drag("pivot", "follower.pivot_x_mm", _pivot),
            FACE: Drag("flat face", "follower.face_offset_mm", _face),
        },
        CamSlider: {
            "pivot": Drag("pivot", "follower.pivot_x_mm", _pivot),
            "arm_pin": Drag("arm pin", "follower.slider_arm_mm", _arm_pin),
            "slider_pin": Drag("slider pin", "follower.rod_mm", _slider_pin),
            "roller": Drag("roller", "follower.roller_arm_mm", _roller),
            SECOND: Drag("second roller", "follower.second.arm_mm", _second_arm),
        },
        Translating: {
            "roller": Drag("roller", "follower.offset_mm", _on_guide),
            SECOND: Drag("second roller", "follower.second.distance_mm", _behind),
        },
    }
)
"""Kind of follower -> the joints that can be drawn elsewhere, by the names of their points."""


def joints_of(design: Design) -> Mapping[str, Drag]:
    """What of a design can be drawn elsewhere: joints by the names of their points, free ends of springs and centres of mass by
    their paths."""
    return {**_joints(design), **_free_ends(design), **_centres(design)}


def _centres(design: Design) -> Mapping[str, Drag]:
    """The centres of mass of links."""
    rows = enumerate(getattr(design.drive.loads, "masses", ()))
    return {
        f"loads.masses[{i}]": Drag(
            f"centre of mass of link {row.link}",
            f"loads.masses[{i}].centre_x_mm",
            _on_link(f"loads.masses[{i}].centre", row.link),
        )
        for i, row in rows
    }


def _free_ends(design: Design) -> Mapping[str, Drag]:
    """The ends of springs that no point names: at a place of a link, of the frame in the global frame."""
    ends: dict[str, Drag] = {}
    for i, spring in enumerate(getattr(design.drive.loads, "springs", ())):
        for key, end, label in (("from", spring.from_, "first"), ("to", spring.to, "second")):
            if end.point is None:
                path = f"loads.springs[{i}].{key}"
                ends[path] = Drag(f"{label} end of spring {i + 1}", f"{path}.x_mm", _on_link(f"{path}.at", end.link))
    return ends


def _on_link(path: str, link: int) -> Callable[[Design, Kinematics, complex], Changes]:
    """A place in the frame of a link, of the frame in the global one."""

    def changes(design: Design, kinematics: Kinematics, to: complex) -> Changes:
        drive = design.drive
        body = kinematics.bodies.get(built(drive.mechanism, drive.cam).bodies.get(link, FRAME))
        local = to if body is None else (to - complex(body.origin[0][0])) * complex(body.unit[0]).conjugate()
        return {path: (local.real * 1e3, local.imag * 1e3)}

    return changes


def _joints(design: Design) -> Mapping[str, Drag]:
    drags = DRAGS.get(type(design.drive.mechanism))
    if not drags:
        return _of_linkage(design)
    noun, paired = design.drive.face.noun, getattr(design.drive.mechanism, "second", None) is not None
    drags = {name: drag for name, drag in drags.items() if paired or name != SECOND}
    return {name: replace(drag, label=noun) if drag.label == ROLLER else drag for name, drag in drags.items()}


RIMS: Mapping[str, str] = MappingProxyType(
    {"cam.base_radius_mm": "base circle", "cam.roller_radius_mm": "roller", "follower.shoe_radius_mm": "shoe"}
)
"""Radius that is drawn as a circle -> what it is of."""


def rims_of(design: Design) -> Mapping[str, str]:
    """The circles of a design whose radius can be drawn larger and smaller, by the paths of their fields."""
    typed = {row.path for name in ("cam", "follower") if name in design.tables for row in entries(design, name)}
    return {path: label for path, label in RIMS.items() if path in typed}


def move_joint(design: Design, kinematics: Kinematics, name: str, to: complex, decimals: int = 6) -> Design:
    """The design with a joint at ``to`` [m] in the position that ``kinematics`` shows (n = 1). Lengths are rounded to so many
    decimals [mm], angles to two more [deg]. It may have faults. Raises KeyError for a joint there is none of, NoAssembly where
    nothing fits."""
    for path, value in joints_of(design)[name].changes(design, kinematics, to).items():
        if isinstance(value, tuple):
            value = tuple(round(number, decimals) + 0.0 for number in value)
        elif not isinstance(value, str):
            value = round(value, decimals + unit_kind(split_unit(path)[1].symbol).decimals) + 0.0
        design = put(design, path, value)
    return design


def _at(kinematics: Kinematics, point: str) -> complex:
    """Where a point stands [m]."""
    body = next(body for body in kinematics.bodies.values() if point in body.points)
    return complex(body.position(point)[0])


def _reach(design: Design) -> float:
    return reach_of(design.drive.follower, design.drive.cam)


def _near(angle: float, old: float) -> float:
    """The angle [rad] without the whole turns that take it away from the old one, in degrees."""
    return math.degrees(angle - 2.0 * pi * round((angle - old) / (2.0 * pi)))


def _layout(follower: CamSlider, **changed: bool) -> str:
    """The letter of the follower's layout with one of its sides changed."""
    row = LAYOUT_TABLE[follower.layout]
    wanted = replace(row, **changed)
    return next(letter for letter, each in LAYOUT_TABLE.items() if each == wanted)
