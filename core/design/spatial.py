"""Cams in space: a barrel cam or a globoidal cam that moves the output of a motion, and the rules of their dimensions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import atan2, cos, degrees, hypot, pi, radians, sin, sqrt, tan
from types import MappingProxyType
from typing import Any, ClassVar

from core.design.fields import (
    LONGEST_MM,
    MAIN,
    chosen_by_word,
    early,
    leading,
    length,
    number,
    placed,
    seldom,
    whole,
)
from core.design.followers import FORM
from core.errors import MISSING, Fault
from core.frozen import frozen

# -- the parts ----------------------------------------------------------------------------------------------------


@frozen
class SpatialGroove:
    """A groove with the roller between its flanks; of a turret one groove a roller."""

    form: ClassVar[str] = "groove"
    holds: ClassVar[bool] = True
    play_mm: float = number(
        "Play", 0.0, LONGEST_MM, default=0.0, help="of the roller in the groove, on the side of the flank behind it"
    )


@frozen
class Rib:
    """A rib between two rollers: neighbours on a turret, or two rollers side by side on a slide."""

    form: ClassVar[str] = "rib"
    holds: ClassVar[bool] = True
    roller_distance_mm: float | None = number(
        "Roller distance", 0.0, LONGEST_MM, open_low=True, default=None,
        help="between the axes of both rollers of a motion in mm; a turret has none",
    )  # fmt: skip


SpatialForm = SpatialGroove | Rib


def _known(label: str, help: str) -> Any:
    return number(label, 0.0, LONGEST_MM, open_low=True, default=None, help=f"{help}; empty = not known")


@frozen(kw_only=True)
class SpatialCam:
    """Dimensions of a cam in space that both kinds have."""

    kind: ClassVar[str]
    label: ClassVar[str]
    form: SpatialForm = placed(
        chosen_by_word(
            FORM, {class_.form: class_ for class_ in (SpatialGroove, Rib)}, "Form", otherwise=SpatialGroove.form, weight=MAIN
        ),
        SpatialGroove(),
    )  # fmt: skip
    roller_radius_mm: float = leading(length("Roller radius", help="at its inner end"))
    roller_length_mm: float = leading(length("Roller length", help="along its axis"))
    roller_inner_mm: float = leading(
        length(
            "Inner distance", help="of the roller's inner end from the cam's axis; globoidal: from the turret's axis"
        )
    )
    roller_taper_deg: float = seldom(
        number("Roller taper", -60.0, 60.0, default=0.0, help="half angle of a conical roller; > 0 narrows to its outer end")
    )  # fmt: skip
    rollers: int = whole("Rollers", 1, 100, default=1, help="evenly on the turret")
    length_mm: float | None = _known("Length of the blank", "along the cam's axis")
    outer_radius_mm: float | None = _known("Blank radius", "outer radius of the blank")
    bore_mm: float | None = _known("Bore", "diameter")
    keyway_width_mm: float | None = _known("Keyway width", "of the groove in the bore")
    keyway_depth_mm: float | None = _known("Keyway depth", "from the bore")
    keyway_angle_deg: float | None = number(
        "Keyway angle", -360.0, 360.0, default=None, help="of its middle in the cam's frame; empty = not known"
    )

    @property
    def taper(self) -> float:
        """Half angle τ of the roller [rad]."""
        return radians(self.roller_taper_deg)

    @property
    def outer_mm(self) -> float:
        """Distance of the roller's outer end, as ``roller_inner_mm`` [mm]."""
        return self.roller_inner_mm + self.roller_length_mm

    @property
    def outer_roller_radius_mm(self) -> float:
        """Radius of the roller at its outer end, r - L tan τ [mm]."""
        return self.roller_radius_mm - self.roller_length_mm * tan(self.taper)


@frozen(kw_only=True)
class BarrelCam(SpatialCam):
    """Barrel cam, whose roller slides along the cam's axis, or is on an arm or a turret with its axis parallel to the roller."""

    kind: ClassVar[str] = "barrel"
    label: ClassVar[str] = "Barrel cam"
    arm_mm: float | None = early(_known("Arm", "axis of the turret or arm to the roller, of a motion in degrees"))


@frozen(kw_only=True)
class GloboidalCam(SpatialCam):
    """Globoidal cam, whose rollers point at the axis of an arm or a turret, which crosses the cam's axis at a right angle."""

    kind: ClassVar[str] = "globoidal"
    label: ClassVar[str] = "Globoidal cam"
    centre_distance_mm: float = leading(length("Centre distance", help="cam's axis to the turret's axis"))


SPATIAL_CAMS: Mapping[str, type[SpatialCam]] = MappingProxyType({row.kind: row for row in (BarrelCam, GloboidalCam)})
"""Word of ``cam.kind`` -> class of its table."""

# -- rules of the dimensions --------------------------------------------------------------------------------------


def shape_faults(cam: SpatialCam, path: str) -> Iterator[Fault]:
    """Faults of dimensions that exclude each other, whatever the motion is; none where a length is not positive."""
    lengths = (cam.roller_radius_mm, cam.roller_length_mm, cam.roller_inner_mm, getattr(cam, "centre_distance_mm", 1.0))
    if any(length <= 0.0 for length in lengths):
        return
    least = min(cam.roller_radius_mm, cam.outer_roller_radius_mm)
    if least <= 0.0:
        steepest = degrees(atan2(cam.roller_radius_mm, cam.roller_length_mm))
        yield Fault(
            f"{path}.roller_taper_deg", cam.roller_taper_deg, "the roller ends in a point before its outer end",
            f"< {steepest:.6g} deg, by the roller's radius over its length",
        )  # fmt: skip
    yield from _globoid_faults(cam, path) if isinstance(cam, GloboidalCam) else _barrel_faults(cam, path)
    bore, key = cam.bore_mm, cam.keyway_width_mm
    if bore is not None and key is not None and key >= bore:
        yield Fault(f"{path}.keyway_width_mm", key, "not narrower than the bore", f"< {bore:g} mm")


def _barrel_faults(cam: SpatialCam, path: str) -> Iterator[Fault]:
    """The roller is smaller than its distance from the cam's axis; the blank contains the groove, the bore is inside of it."""
    inner, play = cam.roller_inner_mm, getattr(cam.form, "play_mm", 0.0)
    if cam.roller_radius_mm >= inner:
        yield Fault(
            f"{path}.roller_radius_mm", cam.roller_radius_mm, "not smaller than the roller's distance from the cam's axis",
            f"< {inner:g} mm",
        )  # fmt: skip
    if cam.outer_radius_mm is not None and cam.outer_radius_mm <= inner:
        yield Fault(
            f"{path}.outer_radius_mm",
            cam.outer_radius_mm,
            "the roller does not reach into the blank",
            f"> {inner:g} mm",
        )
    if play >= inner:
        yield Fault(f"{path}.play_mm", play, "not smaller than the roller's inner distance", f"< {inner:g} mm")
    else:
        yield from _hole_faults(cam, path, inner - play, "the floor of the groove")


def _globoid_faults(cam: GloboidalCam, path: str) -> Iterator[Fault]:
    """The roller ends before the cam's axis, and is smaller than its distance from that axis."""
    room = cam.centre_distance_mm - cam.outer_mm
    if cam.centre_distance_mm <= cam.roller_inner_mm:
        yield Fault(
            f"{path}.centre_distance_mm", cam.centre_distance_mm, "the rollers are beyond the cam's axis",
            f"> {cam.outer_mm:g} mm, inner distance and length of the roller",
        )  # fmt: skip
    elif room <= 0.0:
        yield Fault(
            f"{path}.roller_length_mm", cam.roller_length_mm, "the roller crosses the cam's axis",
            f"< {cam.centre_distance_mm - cam.roller_inner_mm:g} mm, centre distance less inner distance",
        )  # fmt: skip
    elif max(cam.roller_radius_mm, cam.outer_roller_radius_mm) >= room:
        yield Fault(
            f"{path}.roller_radius_mm", cam.roller_radius_mm, "not smaller than the roller's distance from the cam's axis",
            f"< {room:g} mm",
        )  # fmt: skip
    else:
        yield from _hole_faults(
            cam, path, room - getattr(cam.form, "play_mm", 0.0), "the waist of the cam, where the rollers end"
        )


def _hole_faults(cam: SpatialCam, path: str, core_mm: float, limit: str) -> Iterator[Fault]:
    """Bore and keyway are inside of the core of the cam, of a radius [mm]."""
    if cam.bore_mm is None:
        return
    half_bore, half_width = 0.5 * cam.bore_mm, 0.5 * (cam.keyway_width_mm or 0.0)
    if half_bore >= core_mm:
        yield Fault(f"{path}.bore_mm", cam.bore_mm, f"not smaller than {limit}", f"< {2.0 * core_mm:g} mm")
    elif cam.keyway_depth_mm is not None and hypot(half_bore + cam.keyway_depth_mm, half_width) >= core_mm > half_width:
        deepest = sqrt(core_mm**2 - half_width**2) - half_bore
        yield Fault(f"{path}.keyway_depth_mm", cam.keyway_depth_mm, f"reaches {limit}", f"< {deepest:.6g} mm")


def motion_faults(cam: SpatialCam, unit: str, advance: float | None) -> Iterator[Fault]:
    """Faults of a cam in space with a motion in ``unit``, which advances by ``advance`` [deg] a turn."""
    turns, arm = unit == "deg", getattr(cam, "arm_mm", None)
    if isinstance(cam, GloboidalCam) and not turns:
        yield Fault(
            "cam.kind", cam.kind, "moves an arm or a turret, and the motion is in mm", "barrel, or a motion in deg"
        )
        return
    if isinstance(cam, BarrelCam) and turns and arm is None:
        yield Fault("cam.arm_mm", MISSING, "missing: the motion is in degrees", "> 0 mm, axis of the arm to the roller")
    if not turns and arm is not None:
        yield Fault("cam.arm_mm", arm, "a roller that slides has no arm", "leave it out, or a motion in deg")
    if not turns and cam.rollers != 1:
        yield Fault("cam.rollers", cam.rollers, "a motion in mm has no turret", "1")
    yield from _rib_faults(cam, turns)
    if turns and cam.rollers > 1:
        yield from _room_faults(cam, arm)
    if not turns and advance:
        yield Fault("motion.advance_mm", advance, "a barrel cam repeats a motion in mm every turn", "no advance")
    pitch = 360.0 / cam.rollers if cam.rollers >= 1 else 360.0
    if turns and advance:
        steps = advance / pitch
        if abs(steps - round(steps)) > 1e-9 * max(1.0, abs(steps)):
            yield Fault(
                "motion.advance_deg", advance, "no multiple of the pitch of the rollers", f"multiples of {pitch:.12g} deg"
            )  # fmt: skip


def _rib_faults(cam: SpatialCam, turns: bool) -> Iterator[Fault]:
    """A rib is between neighbours of a turret, or between two rollers at a stated distance."""
    if not isinstance(cam.form, Rib):
        return
    distance = cam.form.roller_distance_mm
    if turns:
        if distance is not None:
            yield Fault("cam.roller_distance_mm", distance, "follows from the rollers of the turret", "leave it out")
        if cam.rollers < 2:
            yield Fault("cam.rollers", cam.rollers, "a rib is between two rollers", ">= 2")
    elif distance is None:
        yield Fault(
            "cam.roller_distance_mm", MISSING, "missing: a rib is between two rollers", "> 0 mm, between their axes"
        )
    else:
        widest = 2.0 * max(cam.roller_radius_mm, cam.outer_roller_radius_mm)
        if distance <= widest:
            yield Fault("cam.roller_distance_mm", distance, "the rollers touch each other", f"> {widest:g} mm")


def _room_faults(cam: SpatialCam, arm: float | None) -> Iterator[Fault]:
    """Neighbours on the turret do not touch: each stays on its side of the plane between them."""
    half = pi / cam.rollers
    if isinstance(cam, GloboidalCam):
        # the rim of an end is at u sin(π/n) - r cos(π/n) from that plane
        ends = ((cam.roller_inner_mm, cam.roller_radius_mm), (cam.outer_mm, cam.outer_roller_radius_mm))
        fits = all(u * sin(half) > r * cos(half) for u, r in ends)
    else:
        widest = max(cam.roller_radius_mm, cam.outer_roller_radius_mm)
        fits = arm is None or arm * sin(half) > widest
    if not fits:
        yield Fault(
            "cam.rollers", cam.rollers, "more rollers than fit on the turret: neighbours touch each other",
            "fewer rollers, a smaller radius, or a larger " + ("inner distance" if isinstance(cam, GloboidalCam) else "arm"),
        )  # fmt: skip
