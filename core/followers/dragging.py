"""Dimensions from dragged joints: a joint is moved to a new position at one cam angle, and the typed values follow.

Cam angle and motion do not change. So the base position follows from the new position less the motion at this angle.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import pi
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from core.design import (
    CamSlider,
    Design,
    Knife,
    Oscillating,
    OscillatingFlat,
    Pushrod,
    Rocker,
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
from core.number_text import result_text
from core.units import split_unit, unit_kind

if TYPE_CHECKING:
    from core.design.outline_bodies import Body

Changes = Mapping[str, Any]
"""Value as in the file, by path."""


@frozen
class Drag:
    """A joint that can be dragged.

    Attributes
    ----------
    label : str
        Name for the user.
    field : str
        Path of the value that mainly changes.
    changes : callable
        Changed values from design, kinematics (n = 1) and new position [m].
    """

    label: str
    field: str
    changes: Callable[[Design, Kinematics, complex], Changes]


def _pivot(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Position of the pivot; all lengths stay."""
    return {"follower.pivot_x_mm": to.real * 1e3, "follower.pivot_y_mm": to.imag * 1e3}


def _arm_pin(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Slider arm, rod and fixed angle; pivot and slider do not move, and the roller stays on the base circle."""
    pivot, slider = _at(kinematics, "pivot"), _at(kinematics, "slider_pin")
    return {
        "follower.slider_arm_mm": abs(to - pivot) * 1e3,
        "follower.rod_mm": abs(slider - to) * 1e3,
        **_fixed_angle(design, kinematics, pivot, to, slider),
    }


def _slider_pin(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Rod, guide height and fixed angle; pivot and arm pin do not move, and the roller stays on the base circle."""
    pivot, pin = _at(kinematics, "pivot"), _at(kinematics, "arm_pin")
    along = cmath.exp(1j * si(design.drive.mechanism).guide_angle)
    return {
        "follower.rod_mm": abs(to - pin) * 1e3,
        "follower.guide_height_mm": ((to - pivot) / along).imag * 1e3,
        **_fixed_angle(design, kinematics, pivot, pin, to),
    }


def _fixed_angle(design: Design, kinematics: Kinematics, pivot: complex, pin: complex, slider: complex) -> Changes:
    """Fixed angle and layout for given pins of arm and rod: γ = α0 - φ0 - δ (Shin 1995, eq. (5)), φ0 at the base position.

    Raises NoAssembly where arm and rod do not meet there.
    """
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
            f"slider arm {result_text(l1 * 1e3, 6)} mm and rod {result_text(l2 * 1e3, 6)} mm do not meet in the "
            "base position, where the slider is "
            f"{result_text(r * 1e3, 6)} mm from the pivot",
            "follower.rod_mm",
            "choose another position of the joint",
        )
    phi = cmath.phase(start) + sigma * math.atan2(k, r * r + (l1 - l2) * (l1 + l2))
    layout = _layout(follower, slider_right=start.real > l1 * math.cos(phi))
    return {
        "follower.fixed_angle_deg": _near(base.alpha - phi - g.guide_angle, g.fixed_angle),
        "follower.layout": layout,
    }


def _roller(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Roller arm, fixed angle and base radius; arm, rod and slider do not move."""
    follower = design.drive.mechanism
    assert isinstance(follower, CamSlider)
    g, base = si(follower), base_position(follower, _reach(design))
    pivot = _at(kinematics, "pivot")
    arm = _at(kinematics, "arm_pin") - pivot
    fixed = g.fixed_angle + cmath.phase((to - pivot) / (arm * cmath.exp(1j * g.fixed_angle)))
    first = abs(to - pivot) * cmath.exp(1j * (base.phi + fixed + g.guide_angle))
    left = (first / -pivot).imag < 0.0  # the roller arm is clockwise from the ray to the cam
    return {
        "follower.roller_arm_mm": abs(to - pivot) * 1e3,
        "follower.fixed_angle_deg": _near(fixed, g.fixed_angle),
        "follower.layout": _layout(follower, roller_above=left == LAYOUT_TABLE[follower.layout].cam_left),
        "cam.base_radius_mm": abs(pivot + first) * 1e3 - design.drive.face.radius_mm,
    }


def _on_guide(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Offset and base radius of a translating follower, at the same motion."""
    g = si(design.drive.mechanism)
    local = to * cmath.exp(-1j * g.direction)
    start = local.real - float(kinematics.motion.displacement[0][0])
    if start <= 0.0:
        raise NoAssembly(
            f"in the base position the {design.drive.face.noun} would be {result_text(-start * 1e3, 6)} mm behind the cam centre",
            "cam.base_radius_mm",
            "move it farther out",
        )
    return {
        "follower.offset_mm": local.imag * 1e3,
        "cam.base_radius_mm": REACHES[type(design.drive.follower.face)](design, complex(start, local.imag)) * 1e3
        - design.drive.face.radius_mm,
    }


def _face_distance(design: Design, reference: complex) -> float:
    """Distance [m] of a tilted face from the cam centre, from its reference point [m] in the guide's frame."""
    return (reference * cmath.exp(-1j * si(design.drive.follower.face).face_tilt)).real


REACHES: Mapping[type, Callable[[Design, complex], float]] = MappingProxyType(
    {**dict.fromkeys((Rolling, Knife, Shoe), lambda design, reference: abs(reference)), TiltedFlat: _face_distance}
)
"""Class of the face -> its reach on the base circle [m], from its reference point there in the guide's frame."""


def _on_arm(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Arm, side and base radius of an oscillating follower; pivot and motion do not change."""
    follower = design.drive.mechanism
    assert isinstance(follower, Oscillating)
    pivot, rotation = _at(kinematics, "pivot"), SIDES[follower.side] * float(kinematics.motion.displacement[0][0])
    first = (to - pivot) * cmath.exp(-1j * rotation)  # in the base position
    side = "left" if (first / -pivot).imag > 0.0 else "right"
    return {
        "follower.arm_mm": abs(to - pivot) * 1e3,
        "follower.side": side,
        "cam.base_radius_mm": abs(pivot + first) * 1e3 - design.drive.face.radius_mm,
    }


def _second_arm(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Arm of the second roller and its angle from the first."""
    follower: Any = design.drive.mechanism
    pivot = _at(kinematics, "pivot")
    between = cmath.phase((to - pivot) / (complex(kinematics.follower.origin[0][0]) - pivot))
    return {
        "follower.second.arm_mm": abs(to - pivot) * 1e3,
        "follower.second.angle_deg": _near(between, math.radians(follower.second.angle_deg)),
    }


def _behind(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Distance of the second roller behind the first, along the guide."""
    along = cmath.rect(1.0, si(design.drive.mechanism).direction)
    distance = ((complex(kinematics.follower.origin[0][0]) - to) * along.conjugate()).real
    if distance <= 0.0:
        raise NoAssembly(
            "the second roller would be in front of the first", "follower.second.distance_mm", "move it behind"
        )
    return {"follower.second.distance_mm": distance * 1e3}


def _face(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Face offset and base radius of a flat face through the new position, in the same direction."""
    follower = design.drive.mechanism
    assert isinstance(follower, OscillatingFlat)
    normal = complex(kinematics.follower.unit[0])
    offset = ((to - _at(kinematics, "pivot")) * normal.conjugate()).real * 1e3
    return {
        "follower.face_offset_mm": offset,
        "cam.base_radius_mm": design.drive.cam.base_radius_mm + offset - follower.face.face_offset_mm,
    }


def _arm_of_rocker(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Arm, side, pad's angle and base radius of a rocker; pivot, pad and valve do not move."""
    pivot, pad = _at(kinematics, "pivot"), _at(kinematics, "pad_centre")
    rocker, first = kinematics.bodies["rocker"], kinematics.base["rocker"][0]
    base = (to - pivot) * cmath.exp(1j * first) / complex(rocker.unit[0])  # in the base position
    return {
        "follower.arm_mm": abs(to - pivot) * 1e3,
        "follower.side": "left" if (base / -pivot).imag > 0.0 else "right",
        **_pad_angle(design, pivot, to, pad),
        "cam.base_radius_mm": abs(pivot + base) * 1e3 - design.drive.face.radius_mm,
    }


def _pad_of_rocker(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Pad's arm and angle, and the base radius, with which the valve has the same lift; pivot and roller do not move."""
    follower = design.drive.mechanism
    assert isinstance(follower, Rocker)
    pivot, roller = _at(kinematics, "pivot"), _at(kinematics, "roller")
    valve = cmath.exp(1j * si(follower).valve_direction)
    pad = (to - pivot) / valve
    along = pad.real - float(kinematics.motion.displacement[0][0])
    if abs(along) >= abs(pad):
        raise NoAssembly(
            f"with a pad's arm of {result_text(abs(pad) * 1e3, 6)} mm the pad cannot follow the valve to its seat",
            "follower.pad_mm",
            "move it farther from the pivot, across the valve",
        )
    closed = complex(along, math.copysign(math.sqrt((abs(pad) - along) * (abs(pad) + along)), pad.imag))
    base = pivot + (roller - pivot) * closed / pad
    return {
        **_pad(design, pivot, roller, to),
        "cam.base_radius_mm": abs(base) * 1e3 - design.drive.face.radius_mm,
    }


def _pad_of_pushrod(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Pad's arm and angle; the rocker does not move."""
    return _pad(design, _at(kinematics, "pivot"), _at(kinematics, "upper_ball"), to)


def _pad(design: Design, pivot: complex, arm: complex, to: complex) -> Changes:
    return {"follower.pad_mm": abs(to - pivot) * 1e3, **_pad_angle(design, pivot, arm, to)}


def _pad_angle(design: Design, pivot: complex, arm: complex, pad: complex) -> Changes:
    """Angle of the pad from the arm to a point of the rocker."""
    angle = cmath.phase((pad - pivot) / (arm - pivot))
    return {"follower.pad_angle_deg": _near(angle, si(design.drive.mechanism).pad_angle)}


def _upper_ball(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Pushrod, push arm, side and pad's angle; tappet, pivot and pad do not move."""
    pivot, ball = _at(kinematics, "pivot"), _at(kinematics, "lower_ball")
    return {
        "follower.pushrod_mm": abs(to - ball) * 1e3,
        "follower.push_arm_mm": abs(to - pivot) * 1e3,
        "follower.side": "left" if ((to - ball) / (pivot - ball)).imag > 0.0 else "right",
        **_pad_angle(design, pivot, to, _at(kinematics, "pad_centre")),
    }


def _lower_ball(design: Design, kinematics: Kinematics, to: complex) -> Changes:
    """Seat of the lower ball in the tappet, and the pushrod; the rocker does not move."""
    tappet = kinematics.bodies["tappet"]
    seat = (to - complex(tappet.origin[0][0])) / complex(tappet.unit[0])
    return {
        "follower.seat_x_mm": seat.real * 1e3,
        "follower.seat_y_mm": seat.imag * 1e3,
        "follower.pushrod_mm": abs(_at(kinematics, "upper_ball") - to) * 1e3,
    }


def _point(name: str) -> Callable[[Design, Kinematics, complex], Changes]:
    return lambda design, kinematics, to: point_changes(design, kinematics, name, to)


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
        Rocker: {
            "pivot": Drag("pivot", "follower.pivot_x_mm", _pivot),
            "roller": Drag("roller", "follower.arm_mm", _arm_of_rocker),
            "pad_centre": Drag("pad", "follower.pad_mm", _pad_of_rocker),
            SECOND: Drag("second roller", "follower.second.arm_mm", _second_arm),
        },
        Pushrod: {
            "pivot": Drag("pivot", "follower.pivot_x_mm", _pivot),
            "roller": Drag("roller", "follower.offset_mm", _on_guide),
            "lower_ball": Drag("lower ball", "follower.seat_x_mm", _lower_ball),
            "upper_ball": Drag("upper ball", "follower.push_arm_mm", _upper_ball),
            "pad_centre": Drag("pad", "follower.pad_mm", _pad_of_pushrod),
            SECOND: Drag("second roller", "follower.second.distance_mm", _behind),
        },
    }
)
"""Class of the follower -> joints that can be dragged, by the names of their points."""


def joints_of(design: Design) -> Mapping[str, Drag]:
    """All that can be dragged: joints by the names of their points; ends of springs, centres of mass, corners of outlines by paths."""
    return {**_joints(design), **_free_ends(design), **_centres(design), **_corners(design)}


def _corners(design: Design) -> Mapping[str, Drag]:
    """Corners of the outlines in the plane of the mechanism, of a design with one drive."""
    corners: dict[str, Drag] = {}
    if not design.outlines:
        return corners
    from core.design.outline_bodies import body_of  # few designs have outlines

    for i, outline in enumerate(design.outlines if not design.listed else ()):
        body = body_of(design, outline)
        if body is None or outline.plane is not None:
            continue
        for j in range(len(outline.points)):
            path = f"outlines[{i}].points[{j}]"
            label = f"corner {j + 1} of the outline of {outline.of}"
            corners[path] = Drag(label, f"{path}.x_mm", _in_outline(path, body))
    return corners


def _in_outline(path: str, body: Body) -> Callable[[Design, Kinematics, complex], Changes]:
    """Coordinates in the frame of the outlines of a body."""

    def changes(design: Design, kinematics: Kinematics, to: complex) -> Changes:
        from core.followers.outline_frames import outline_frame  # as above

        origin, axis = outline_frame(design, kinematics, body)
        local = (to - complex(origin[0])) * complex(axis[0]).conjugate()
        return {f"{path}.x_mm": local.real * 1e3, f"{path}.y_mm": local.imag * 1e3}

    return changes


def _centres(design: Design) -> Mapping[str, Drag]:
    """Centres of mass of links."""
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
    """Ends of springs that are given by coordinates, not by a point."""
    ends: dict[str, Drag] = {}
    for i, spring in enumerate(getattr(design.drive.loads, "springs", ())):
        for key, end, label in (("from", spring.from_, "first"), ("to", spring.to, "second")):
            if end.point is None:
                path = f"loads.springs[{i}].{key}"
                ends[path] = Drag(f"{label} end of spring {i + 1}", f"{path}.x_mm", _on_link(f"{path}.at", end.link))
    return ends


def _on_link(path: str, link: int) -> Callable[[Design, Kinematics, complex], Changes]:
    """Coordinates in the frame of a link, or in the global frame for the frame link."""

    def changes(design: Design, kinematics: Kinematics, to: complex) -> Changes:
        drive = design.drive
        body = kinematics.bodies.get(built(drive.mechanism, drive.cam).bodies.get(link, FRAME))
        local = to if body is None else (to - complex(body.origin[0][0])) * complex(body.unit[0]).conjugate()
        return {path: (local.real * 1e3, local.imag * 1e3)}

    return changes


def _joints(design: Design) -> Mapping[str, Drag]:
    drags = DRAGS.get(type(design.drive.mechanism))
    if design.drive.is_alone:
        return {}
    if not drags:
        return {name: Drag(f"joint {name}", path, _point(name)) for name, path in movable_points(design).items()}
    noun, has_second = design.drive.face.noun, getattr(design.drive.mechanism, "second", None) is not None
    drags = {name: drag for name, drag in drags.items() if has_second or name != SECOND}
    return {name: replace(drag, label=noun) if drag.label == ROLLER else drag for name, drag in drags.items()}


RIMS: Mapping[str, str] = MappingProxyType(
    {
        "cam.base_radius_mm": "base circle",
        "cam.roller_radius_mm": "roller",
        "follower.shoe_radius_mm": "shoe",
        "cam.outer_radius_mm": "blank",
        "cam.roller_inner_mm": "inner end of the roller",
    }
)
"""Label of a circle in the drawing, by the path of its radius."""


def rims_of(design: Design) -> Mapping[str, str]:
    """Labels of the circles whose radius can be dragged, by the paths of their fields."""
    typed = {row.path for name in ("cam", "follower") if name in design.tables for row in entries(design, name)}
    return {path: label for path, label in RIMS.items() if path in typed}


def move_joint(design: Design, kinematics: Kinematics, name: str, to: complex, decimals: int = 6) -> Design:
    """The design with a joint moved to `to` [m] in the position (n = 1) of the kinematics; it may have faults.

    Lengths [mm] are rounded to `decimals`, angles [deg] to two more.

    Raises
    ------
    KeyError
        There is no such joint.
    NoAssembly
        No dimensions allow this position.
    """
    for path, value in joints_of(design)[name].changes(design, kinematics, to).items():
        if isinstance(value, tuple):
            value = tuple(round(number, decimals) + 0.0 for number in value)
        elif not isinstance(value, str):
            value = round(value, decimals + unit_kind(split_unit(path)[1].symbol).decimals) + 0.0
        design = put(design, path, value)
    return design


def _at(kinematics: Kinematics, point: str) -> complex:
    """Position of a point [m]."""
    body = next(body for body in kinematics.bodies.values() if point in body.points)
    return complex(body.position(point)[0])


def _reach(design: Design) -> float:
    return reach_of(design.drive.follower, design.drive.cam)


def _near(angle: float, old: float) -> float:
    """The angle [rad] in degrees, with the whole turns that bring it nearest to the old one."""
    return math.degrees(angle - 2.0 * pi * round((angle - old) / (2.0 * pi)))


def _layout(follower: CamSlider, **changed: bool) -> str:
    """Letter of the follower's layout with one of its sides changed."""
    layout = replace(LAYOUT_TABLE[follower.layout], **changed)
    return next(letter for letter, row in LAYOUT_TABLE.items() if row == layout)
