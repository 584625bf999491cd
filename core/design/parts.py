"""Design inputs as frozen parts in the units of the user, so that a file is written back exactly as it was read.

Parts contain no results and no view settings; a part that does not exist is None.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any

from core.design.fields import (
    LONGEST_MM,
    FileLayout,
    choice,
    chosen_by_word,
    coordinate,
    flag,
    leading,
    length,
    number,
    placed,
    seldom,
)
from core.design.followers import (
    FACE,
    CamDetails,
    Conjugate,
    ContactFriction,
    Face,
    Form,
    Groove,
    Knife,
    OffsetFlat,
    Open,
    Rolling,
    Shoe,
    TiltedFlat,
    form_of,
    rubs,
)
from core.design.loads import ForceElements, ValveSpring, valve_springs
from core.frozen import frozen

# -- followers: lengths only ------------------------------------------------------------------------------

LAYOUTS = tuple("abcdefgh")


def faces_of(*classes: Any, brief: bool = False, default: Any = Rolling()) -> Any:  # noqa: B008
    """Dataclass field for the face of a follower, one of some classes, with its keys in the follower's table."""
    words = {class_.face: class_ for class_ in classes}
    placing = chosen_by_word(FACE, words, "Face", otherwise=default.face, brief=brief, help="the part on the cam")
    return placed(placing, default)


@frozen(kw_only=True)
class SecondArm:
    """Position of the second roller of a conjugate pair, at the end of an arm fixed to the first arm."""

    arm_mm: float = length("Second arm", help="pivot to the second roller's centre")
    angle_deg: float = number(
        "Second arm's angle", -360.0, 360.0, help="from the first roller's arm, counter-clockwise"
    )


@frozen(kw_only=True)
class SecondPlace:
    """Position of the second roller of a conjugate pair on a translating follower."""

    distance_mm: float = length(
        "Second roller's distance",
        help="from the first roller, opposite to the direction; centre to centre",
    )


def _second(kind: type[SecondArm] | type[SecondPlace]) -> Any:
    """Dataclass field for the position of the second roller; None without a conjugate pair."""
    return placed(FileLayout(kind, single=True), None)


@frozen(kw_only=True)
class CamSlider:
    """Roller arm and slider arm on one pivot, rod to a slider on a straight guide (Shin1995, Figs. 1-3)."""

    layout: str = choice("Layout", LAYOUTS, help="a...h: cam left/right, roller above/below, slider right/left")
    face: Rolling | Knife | Shoe = faces_of(Rolling, Knife, Shoe, brief=True)
    slider_arm_mm: float = length("Slider arm L1", help="pivot to the rod's pin")
    rod_mm: float = length("Rod L2", help="arm's pin to slider pin")
    guide_height_mm: float = coordinate(
        "Guide height H", help="distance of the guide from the pivot, along guide + 90 deg"
    )
    guide_angle_deg: float = seldom(
        number("Guide angle", -360.0, 360.0, default=0.0, help="0 = horizontal, 90 = vertical")
    )
    roller_arm_mm: float = length("Roller arm Zl", help="pivot to roller centre")
    fixed_angle_deg: float = number(
        "Fixed angle", -360.0, 360.0, help="from slider arm to roller arm, counter-clockwise"
    )
    pivot_x_mm: float = coordinate("Pivot x", help="from the cam centre; > 0 puts the cam left of the pivot")
    pivot_y_mm: float = coordinate("Pivot y", help="from the cam centre")
    second: SecondArm | None = _second(SecondArm)


@frozen(kw_only=True)
class Translating:
    """Follower that slides on a straight guide."""

    face: Rolling | TiltedFlat | Knife | Shoe = faces_of(Rolling, TiltedFlat, Knife, Shoe)
    offset_mm: float = coordinate(
        "Offset", default=0.0, help="of the guide from the cam centre, positive to the left of the direction"
    )
    direction_deg: float = seldom(number("Direction", -360.0, 360.0, default=90.0, help="of the rise, 90 = upwards"))
    second: SecondPlace | None = _second(SecondPlace)


SIDES: Mapping[str, float] = MappingProxyType({"left": 1.0, "right": -1.0})


@frozen(kw_only=True)
class Oscillating:
    """Arm on a fixed pivot with a roller, a knife edge or a shoe on the cam."""

    face: Rolling | Knife | Shoe = faces_of(Rolling, OffsetFlat, Knife, Shoe)
    arm_mm: float = length("Arm", help="pivot to roller centre")
    pivot_x_mm: float = coordinate("Pivot x", help="from the cam centre")
    pivot_y_mm: float = coordinate("Pivot y", help="from the cam centre")
    side: str = choice("Side", tuple(SIDES), help="of the roller, seen from the pivot towards the cam centre")
    second: SecondArm | None = _second(SecondArm)


@frozen(kw_only=True)
class OscillatingFlat:
    """Arm on a fixed pivot with a flat face on the cam, along which the contact moves."""

    face: OffsetFlat = faces_of(Rolling, OffsetFlat, Knife, Shoe, default=OffsetFlat())
    pivot_x_mm: float = coordinate("Pivot x", help="from the cam centre")
    pivot_y_mm: float = coordinate("Pivot y", help="from the cam centre")
    side: str = choice("Side", tuple(SIDES), help="of the contact, seen from the pivot towards the cam centre")


# -- valve trains -----------------------------------------------------------------------------------------


def _pad_angle(arm: str) -> Any:
    return number("Pad angle", -360.0, 360.0, help=f"from the {arm} to the pad's arm, counter-clockwise")


def _pad_arm() -> Any:
    return length("Pad arm", help="pivot to the centre of the pad on the valve's tip")


def _pad_radius() -> Any:
    return number("Pad radius", 0.0, LONGEST_MM, help="of the round pad on the flat tip of the valve")


def _valve_direction() -> Any:
    return number("Valve direction", -360.0, 360.0, help="in which the valve opens, -90 = downwards")


@frozen(kw_only=True)
class Rocker:
    """Rocker between cam and valve, with a roller or a shoe on the cam and a round pad on the valve's tip."""

    face: Rolling | Shoe = faces_of(Rolling, Shoe)
    arm_mm: float = length("Arm", help="pivot to the centre of roller or shoe")
    pivot_x_mm: float = coordinate("Pivot x", help="from the cam centre")
    pivot_y_mm: float = coordinate("Pivot y", help="from the cam centre")
    side: str = choice("Side", tuple(SIDES), help="of the roller, seen from the pivot towards the cam centre")
    pad_mm: float = _pad_arm()
    pad_angle_deg: float = _pad_angle("arm")
    pad_radius_mm: float = _pad_radius()
    valve_direction_deg: float = _valve_direction()
    second: SecondArm | None = _second(SecondArm)


@frozen(kw_only=True)
class Pushrod:
    """Tappet, pushrod between two balls, and rocker with a round pad on the valve's tip."""

    face: Rolling | TiltedFlat | Knife | Shoe = faces_of(Rolling, TiltedFlat, Knife, Shoe)
    offset_mm: float = coordinate(
        "Offset",
        default=0.0,
        help="of the tappet's guide from the cam centre, positive to the left of the direction",
    )
    direction_deg: float = seldom(
        number("Direction", -360.0, 360.0, default=90.0, help="of the tappet's rise, 90 = upwards")
    )
    seat_x_mm: float = coordinate("Lower ball x", help="in the tappet, along the direction from its reference point")
    seat_y_mm: float = coordinate("Lower ball y", help="in the tappet, to the left of the direction")
    pushrod_mm: float = length("Pushrod", help="between the centres of its balls")
    pivot_x_mm: float = coordinate("Pivot x", help="of the rocker, from the cam centre")
    pivot_y_mm: float = coordinate("Pivot y", help="of the rocker, from the cam centre")
    push_arm_mm: float = length("Push arm", help="pivot of the rocker to the upper ball")
    side: str = choice("Side", tuple(SIDES), help="of the upper ball, seen from the lower ball towards the pivot")
    pad_mm: float = _pad_arm()
    pad_angle_deg: float = _pad_angle("push arm")
    pad_radius_mm: float = _pad_radius()
    valve_direction_deg: float = _valve_direction()
    second: SecondPlace | None = _second(SecondPlace)


Follower = CamSlider | Translating | Oscillating | OscillatingFlat | Rocker | Pushrod


@frozen
class Output:
    """Output of a motion without a mechanism: a slide in mm, or a rotary axis in deg."""

    unit: str = placed(FileLayout(in_file=False), "mm")


# -- cam, shaft, loads ------------------------------------------------------------------------------------


@frozen
class DiskCam(CamDetails):
    """Disk cam under a face that is not a roller."""

    base_radius_mm: float = leading(length("Base radius Br", help="smallest radius of the cam where the motion is 0"))
    form: Open = form_of(Open)


@frozen
class RollerCam(CamDetails):
    """Disk cam followed by a roller."""

    base_radius_mm: float = leading(length("Base radius Br", help="smallest radius of the cam where the motion is 0"))
    roller_radius_mm: float = leading(length("Roller radius Rr"))
    form: Form = form_of(Open, Groove, Conjugate)


Cam = RollerCam | DiskCam


def face_of(follower: Follower, cam: Cam) -> Face:
    """The face of a follower with its size."""
    face: Face = follower.face.on(cam)
    return face


SENSES: Mapping[str, float] = MappingProxyType({"ccw": 1.0, "cw": -1.0})


SPRINGS = ("fixed", "retuned")


@frozen
class ElasticShaft:
    """Flexible camshaft: a torsion spring between the drive at constant speed and the cam (Kim1990 Fig. 1).

    ``spring`` selects the loads of the design, or Kim1990's valve spring, adapted to each speed.
    """

    camshaft_inertia_kg_m2: float = leading(
        number("Camshaft inertia", 0.0, open_low=True, help="of cam and shaft on the cam's side of its flexible part"),
        2,
    )
    stiffness_nm_per_rad: float = leading(
        number("Shaft stiffness", 0.0, open_low=True, help="torque per angle of twist"), 1
    )
    damping_ratio: float = number("Shaft damping ratio", 0.0, 0.99, default=0.0, step=0.005, help="of critical damping")
    spring: str = seldom(
        choice(
            "Spring",
            SPRINGS,
            default="fixed",
            help="retuned = valve spring of Kim1990, with its stiffness adapted to each speed",
        )
    )
    spring_factor: float = seldom(
        number("Spring factor", 0.0, 1e3, default=1.5, step=0.1, help="factor a of the retuned spring (Kim1990)")
    )


def _elastic_class(table: Mapping[str, Any]) -> type[ElasticShaft] | None:
    return ElasticShaft if any(field.name in table for field in fields(ElasticShaft)) else None


@frozen
class Shaft:
    """The camshaft: sense of rotation and speed, flywheel, motor, and elasticity where it is flexible."""

    rotation: str = choice("Rotation", tuple(SENSES))
    speed_rpm: float = leading(number("Speed", 0.0, 1e5, open_low=True, step=1.0))
    flywheel_inertia_kg_m2: float = number("Flywheel inertia", 0.0, default=0.0, help="at the camshaft")
    speed_fluctuation: float = number(
        "Speed fluctuation C_s", 0.0, 2.0, open_low=True, default=0.02, help="target for sizing: (max - min) / mean"
    )
    motor_slope_nm_s_per_rad: float = number(
        "Motor slope", 0.0, open_low=True, default=50.0, help="increase of torque per rad/s of speed lost", guessed=True
    )
    motor_inertia_kg_m2: float | None = number("Motor inertia", 0.0, default=None, help="of its rotor, at the motor")
    gear_ratio: float | None = number(
        "Gear ratio",
        0.0,
        1e4,
        open_low=True,
        default=None,
        help="turns of the motor per turn of the camshaft; empty = 1",
    )
    elastic: ElasticShaft | None = placed(FileLayout(ElasticShaft, choose=_elastic_class), None)

    @property
    def sense(self) -> float:
        """Sense of rotation d: +1 counter-clockwise, -1 clockwise."""
        return SENSES[self.rotation]

    @property
    def signed_rpm(self) -> float:
        """Speed [rpm], negative where the shaft turns clockwise."""
        return SENSES.get(self.rotation, 1.0) * self.speed_rpm


# -- a servo in place of the cam ---------------------------------------------------------------------------

ROTARY, LINEAR = "rotary", "linear"


@frozen(kw_only=True)
class Servo:
    """A servo motor in place of a cam, with its gearing, and the masses that it moves in addition to [loads]."""

    kind: str = choice("Motor", (ROTARY, LINEAR))
    inertia_kg_m2: float | None = number(
        "Driven inertia", 0.0, default=None, help="at the output shaft, added to the loads"
    )
    mass_kg: float | None = number("Driven mass", 0.0, default=None, help="added to the loads")
    friction_nm: float | None = number(
        "Friction torque", 0.0, default=None, help="at the output shaft, against its rotation"
    )
    friction_n: float | None = number("Friction force", 0.0, default=None, help="against the motion")
    gear_ratio: float = number(
        "Gear ratio", 0.0, 1e4, open_low=True, default=1.0, help="turns of the motor per turn of the output shaft"
    )
    travel_mm_per_turn: float | None = number(
        "Travel per turn", 0.0, open_low=True, default=None, help="of the output shaft, where it moves a slide"
    )
    efficiency: float = number(
        "Efficiency", 0.0, 1.0, open_low=True, default=1.0, help="of the gearing, in both directions"
    )
    rotor_inertia_kg_m2: float = number("Rotor inertia", 0.0, default=0.0, help="at the motor")
    peak_torque_nm: float | None = number(
        "Peak torque", 0.0, open_low=True, default=None, help="largest torque of the motor"
    )
    rated_torque_nm: float | None = number(
        "Rated torque", 0.0, open_low=True, default=None, help="in continuous running, as rms"
    )
    rated_rpm: float | None = number(
        "Rated speed", 0.0, open_low=True, default=None, help="largest speed at the rated torque"
    )
    regenerates: bool = flag("Regenerates", help="recovers braking energy")


def _mass(label: str, help: str = "") -> float:
    field: float = number(label, 0.0, default=0.0, help=help)
    return field


def _friction() -> float:
    field: float = number(
        "Guide friction", 0.0, 10.0, default=0.0, step=0.01, help="coefficient of friction in the guide"
    )
    return field


@frozen(kw_only=True)
class Loads(ForceElements):
    """Loads common to all followers; ``contact`` is the friction of a sliding face."""

    contact: ContactFriction | None = placed(FileLayout(ContactFriction, choose=rubs), None)
    gravity_m_s2: float = seldom(number("Gravity", 0.0, default=9.80665))
    gravity_angle_deg: float = seldom(number("Gravity direction", -360.0, 360.0, default=-90.0, help="-90 = downwards"))
    least_contact_force_n: float | None = number(
        "Least contact force", 0.0, default=None, help="between follower and open cam"
    )
    restitution: float | None = number(
        "Restitution",
        0.0,
        0.95,
        default=None,
        step=0.05,
        help="rebound speed over landing speed, after lift-off; empty = 0",
    )


@frozen(kw_only=True)
class CamSliderLoads(Loads):
    """Masses and forces of the cam-driven slider."""

    slider_mass_kg: float = _mass("Slider mass")
    rod_mass_kg: float = _mass("Rod mass")
    rod_inertia_kg_m2: float = _mass("Rod inertia", "about its centre of mass")
    rod_centre: float = seldom(
        number(
            "Rod centre",
            0.0,
            1.0,
            default=0.5,
            step=0.05,
            help="centre of mass: fraction of the rod from the arm's pin",
        )
    )
    arm_mass_kg: float = _mass("Arm mass")
    arm_inertia_kg_m2: float = _mass("Arm inertia", "about its centre of mass")
    arm_centre_mm: float = coordinate("Arm centre", default=0.0, help="centre of mass: distance from the pivot")
    arm_centre_angle_deg: float = seldom(
        number("Arm centre angle", -360.0, 360.0, default=0.0, help="from the slider arm")
    )
    roller_mass_kg: float = _mass("Roller mass")
    roller_inertia_kg_m2: float = _mass("Roller inertia", "about its centre; it rotates with the arm")
    friction: float = _friction()
    external_force_n: float = leading(number("External force", default=0.0, help="on the slider, along +guide"))
    spring_rate_n_per_mm: float = leading(
        number("Spring rate", 0.0, default=0.0, help="pulls the slider back by rate times y")
    )


@frozen(kw_only=True)
class TranslatingLoads(Loads):
    """Masses and closing spring of a translating follower."""

    follower_mass_kg: float = _mass("Follower mass", "with its roller")
    valve_mass_kg: float | None = number(
        "Valve mass", 0.0, default=None, help="of valve, retainer and keepers, added to the follower's; empty = 0"
    )
    friction: float = _friction()
    spring_rate_n_per_mm: float = leading(number("Spring rate", 0.0, default=0.0))
    preload_n: float = leading(number("Spring preload", default=0.0, help="towards the cam, where the motion is 0"))
    valve_springs: tuple[ValveSpring, ...] = valve_springs()


@frozen(kw_only=True)
class OscillatingLoads(Loads):
    """Masses and closing spring of an oscillating follower."""

    arm_mass_kg: float = _mass("Arm mass")
    arm_inertia_kg_m2: float = _mass("Arm inertia", "about its centre of mass")
    arm_centre_mm: float = coordinate("Arm centre", default=0.0, help="centre of mass: distance from the pivot")
    arm_centre_angle_deg: float = seldom(number("Arm centre angle", -360.0, 360.0, default=0.0, help="from the arm"))
    roller_mass_kg: float = _mass("Roller mass")
    roller_inertia_kg_m2: float = _mass("Roller inertia", "about its centre; it rotates with the arm")
    spring_rate_nm_per_rad: float = leading(number("Spring rate", 0.0, default=0.0))
    preload_nm: float = leading(number("Spring preload", default=0.0, help="against the motion, where it is 0"))


@frozen(kw_only=True)
class OscillatingFlatLoads(Loads):
    """Masses and closing spring of an arm with a flat face."""

    arm_mass_kg: float = _mass("Arm mass")
    arm_inertia_kg_m2: float = _mass("Arm inertia", "about its centre of mass")
    arm_centre_mm: float = coordinate("Arm centre", default=0.0, help="centre of mass: distance from the pivot")
    arm_centre_angle_deg: float = seldom(
        number(
            "Arm centre angle", -360.0, 360.0, default=0.0, help="from the direction along the face towards the contact"
        )
    )
    spring_rate_nm_per_rad: float = leading(number("Spring rate", 0.0, default=0.0))
    preload_nm: float = leading(number("Spring preload", default=0.0, help="against the motion, where it is 0"))


@frozen(kw_only=True)
class ValveTrainLoads(Loads):
    """Masses of rocker and valve, and the spring that closes the valve."""

    valve_mass_kg: float = _mass("Valve mass", "of valve, retainer and keepers")
    rocker_inertia_kg_m2: float = _mass("Rocker inertia", "about its pivot")
    spring_rate_n_per_mm: float = leading(number("Spring rate", 0.0, default=0.0, help="of the valve spring"))
    preload_n: float = leading(number("Spring preload", default=0.0, help="of the closed valve"))
    valve_springs: tuple[ValveSpring, ...] = valve_springs()


@frozen(kw_only=True)
class RockerLoads(ValveTrainLoads):
    """Masses and valve spring of a rocker."""

    roller_mass_kg: float = _mass("Roller mass")
    roller_inertia_kg_m2: float = _mass("Roller inertia", "about its centre; it rotates with the rocker")


@frozen(kw_only=True)
class PushrodLoads(ValveTrainLoads):
    """Masses and valve spring of a pushrod train."""

    tappet_mass_kg: float = _mass("Tappet mass", "with its roller")
    pushrod_mass_kg: float = _mass("Pushrod mass", "half of it at each ball")


def _excluded(default: Any = None) -> Any:
    """Dataclass field for an element that these loads cannot have."""
    return placed(FileLayout(in_file=False), default)


@frozen(kw_only=True)
class OutputLoads(ForceElements):
    """Loads common to all outputs: forces along the motion, none between links."""

    follower_stiffness_n_per_mm: None = _excluded()
    follower_damping_ratio: None = _excluded()
    springs: tuple[()] = _excluded(())
    torsion_springs: tuple[()] = _excluded(())
    pair_friction: tuple[()] = _excluded(())


@frozen(kw_only=True)
class SlideLoads(OutputLoads):
    """Mass and forces of the output of a motion in mm."""

    mass_kg: float = _mass("Driven mass")
    force_n: float = number("Force", default=0.0, help="on the output, along the positive motion")
    friction_n: float = number("Friction force", 0.0, default=0.0, help="against the motion, in both directions")


@frozen(kw_only=True)
class TurnLoads(OutputLoads):
    """Inertia and torques of the output of a motion in deg."""

    inertia_kg_m2: float = _mass("Driven inertia")
    torque_nm: float = number("Torque", default=0.0, help="on the output, along the positive motion")
    friction_nm: float = number("Friction torque", 0.0, default=0.0, help="against the motion, in both directions")


OUTPUT_LOADS: Mapping[str, type[SlideLoads] | type[TurnLoads]] = MappingProxyType({"mm": SlideLoads, "deg": TurnLoads})
"""Unit of a motion without a mechanism -> class of its loads."""
