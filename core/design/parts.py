"""Design inputs as frozen parts in the units of the user, so that a file is written back exactly as it was read.

Parts contain no results and no view settings; a part that does not exist is None.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any, ClassVar

from core.design.fields import (
    LAW,
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
    Flat,
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
from core.design.loads import ForceElements
from core.frozen import frozen
from core.laws import LAWS, Piece
from core.units import UNITS

# -- motion ----------------------------------------------------------------------------------------------


@frozen
class NamedCurve:
    """A curve of the table of laws.

    Attributes
    ----------
    law : slug of the law
    crossover : change from acceleration to deceleration of a symmetric law, as a fraction of the span
    flat_fraction : fraction of the span with constant acceleration, for a half cycloid C1 ... C4
    """

    law: str = placed(FileLayout(missing=" | ".join(LAWS)))
    crossover: float = number("Crossover", 0.01, 0.99, default=0.5, step=0.05, help="0.5 = symmetric")
    flat_fraction: float = number(
        "Constant acceleration",
        0.0,
        1.0,
        default=0.0,
        step=0.05,
        help="fraction of the span, for the half cycloids C1 ... C4",
    )


@frozen
class SccaCurve:
    """Sine - constant - cosine acceleration (Norton ch. 3: b, c, d).

    Fractions of the span without its constant velocity are sine ramp and constant acceleration; the rest is cosine.
    """

    law: ClassVar[str] = "scca"
    cv_fraction: float = number("Constant velocity", 0.0, 0.99, default=0.0, step=0.05, help="fraction of the span")
    ramp_fraction: float = number(
        "Sine ramp", 0.0, 1.0, default=0.25, step=0.05, help="fraction of the span outside constant velocity"
    )
    flat_fraction: float = number(
        "Constant acceleration",
        0.0,
        1.0,
        default=0.0,
        step=0.05,
        help="fraction of the span outside constant velocity",
    )


@frozen
class PolynomialEnd:
    """Derivatives of a polynomial at one end, per degree of cam angle; without a jerk the jerk is free."""

    velocity: float = number("Velocity", default=0.0, help="per degree")
    acceleration: float = number("Acceleration", default=0.0, help="per degree squared")
    jerk: float | None = number("Jerk", default=None, help="per degree cubed; empty = free")


@frozen
class PolynomialCurve:
    """The polynomial of least degree with given derivatives at its ends."""

    law: ClassVar[str] = "polynomial"
    start: PolynomialEnd = placed(FileLayout(PolynomialEnd, single=True, whole=True), PolynomialEnd())
    end: PolynomialEnd = placed(FileLayout(PolynomialEnd, single=True, whole=True), PolynomialEnd())


@frozen
class SplinePoint:
    """Value, velocity and acceleration of a spline at an angle, as far as given; angle and value are from the segment's start."""

    at_deg: float = number("At", 0.0, 360.0)
    value: float | None = number("Value", default=None)
    velocity: float | None = number("Velocity", default=None)
    acceleration: float | None = number("Acceleration", default=None)


@frozen
class SplineCurve:
    """The curve of least mean-square jerk through points: periodic over a full turn, else at rest at its ends by default."""

    law: ClassVar[str] = "spline"
    points: tuple[SplinePoint, ...] = placed(FileLayout(SplinePoint, whole=True), ())


AT_REST, JOINED = "rest", "joined"
TABLE_ENDS = (AT_REST, "stop", "free", JOINED)


@frozen
class TableCurve(SplineCurve):
    """The curve of least jerk through rows of a table: cam angle, value, and velocity and acceleration where known.

    ``start`` and ``end`` determine velocity and acceleration that the first and the last row do not give: at rest, velocity
    0 only, free, or joined, equal to those of the neighbour whatever the row gives.
    """

    law: ClassVar[str] = "table"
    start: str = choice("Start", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it begins")
    end: str = choice("End", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it ends")
    points: tuple[SplinePoint, ...] = placed(FileLayout(SplinePoint, whole=True, rows=True), ())


@frozen
class ComputedCurve:
    """A curve computed from other parts: pieces over the span 0 ... 1, in the unit of the motion, from the segment's start."""

    law: ClassVar[str] = "computed"
    pieces: tuple[Piece, ...] = placed(FileLayout(in_file=False))


Curve = NamedCurve | SccaCurve | PolynomialCurve | SplineCurve | TableCurve | ComputedCurve
CURVES: Mapping[str, type[SccaCurve | PolynomialCurve | SplineCurve]] = MappingProxyType(
    {c.law: c for c in (SccaCurve, PolynomialCurve, SplineCurve, TableCurve)}
)
"""Law with further keys -> class of its curve; the curves of other laws are ``NamedCurve``."""


def curve_of(law: str) -> Curve:
    """Default curve of a law."""
    return CURVES[law]() if law in CURVES else NamedCurve(law)


def _curve_class(table: Mapping[str, Any]) -> type[Curve]:
    law = table.get(LAW)
    return CURVES.get(law, NamedCurve) if isinstance(law, str) else NamedCurve


@frozen
class Segment:
    """One segment of the motion: cam span, rise (end minus start, in the unit of the motion), and curve."""

    span_deg: float = number("Span", 1e-6, 360.0, step=1.0, help="cam angle of this segment")
    rise: float = number("Rise", help="end minus start; negative for a return", step=1.0, of_motion=True)
    curve: Curve = placed(FileLayout(NamedCurve, choose=_curve_class, brief=True), NamedCurve("dwell"))


@frozen
class TableOrigin:
    """A motion that is read from a table together with the design."""

    table: str = placed(FileLayout(missing="a file"))
    column: str = placed(FileLayout(brief=True), "")
    angle_column: str = placed(FileLayout(brief=True), "")


@frozen
class InverseOrigin:
    """The motion of a linkage's driver that gives an output link the motion in the design."""

    linkage: str = placed(FileLayout(missing="a design file with [linkage]"))
    output: str = placed(FileLayout(missing="the number of a link"))


@frozen
class Origin:
    """Linked files of a motion, one of these kinds; paths are relative to the folder of the design."""

    from_: TableOrigin | None = placed(FileLayout(TableOrigin, single=True), None)
    sum: tuple[str, ...] = placed(FileLayout(each=str), ())
    inverse: InverseOrigin | None = placed(FileLayout(InverseOrigin, single=True), None)

    @property
    def key(self) -> str:
        """Key in the table [motion]."""
        return "from" if self.from_ is not None else "inverse" if self.inverse is not None else "sum"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the files, as typed."""
        single = (
            self.inverse.linkage if self.inverse is not None else self.from_.table if self.from_ is not None else ""
        )
        return (single,) if single else self.sum


@frozen
class Follows:
    """Origin of a motion from linked files.

    Attributes
    ----------
    origin : as typed in a file of ``folder``
    folder : folder of the design
    asked : motion of the output, for the inverse of a linkage
    files : all files that were read
    made : (start, segments, advance) that were computed from them
    """

    origin: Origin
    folder: str
    asked: Any
    files: tuple[str, ...]
    made: Any = None


@frozen
class Motion:
    """Motion of the follower over one turn.

    Attributes
    ----------
    start : position at cam angle 0
    segments : in the order of the turn
    unit : ``mm`` for a slide, ``deg`` for a swing
    advance : displacement per turn of a feed or an indexer; None where the motion returns
    follows : linked files; None where the motion is typed
    """

    FILE_ORDER: ClassVar[tuple[str, ...]] = ("start", "advance", "segments")

    start: float = number("Start", help="position at cam angle 0", of_motion=True)
    segments: tuple[Segment, ...] = placed(FileLayout(Segment), ())
    unit: str = placed(FileLayout(in_file=False), "mm")
    advance: float | None = number(
        "Advance", default=None, help="per turn, where the motion does not return: the sum of the rises", of_motion=True
    )

    follows: Follows | None = placed(FileLayout(in_file=False), None)

    @property
    def is_as_linked(self) -> bool:
        """Whether it is not linked to files, or is unchanged since it was computed from them."""
        return self.follows is None or self.follows.made == (self.start, self.segments, self.advance)

    @property
    def gain(self) -> float:
        """Sum of the rises: the advance per turn, 0 where the motion returns."""
        return self.advance or 0.0

    @property
    def scale(self) -> float:
        """Factor from the unit of the motion to SI."""
        return UNITS[self.unit].factor


# -- followers: lengths only ------------------------------------------------------------------------------

LAYOUTS = tuple("abcdefgh")


def faces_of(flat: type[Flat] | None, *, brief: bool = False, default: Any = Rolling()) -> Any:  # noqa: B008
    """Dataclass field for the face of a follower, with its keys in the follower's table."""
    words = {"roller": Rolling, **({} if flat is None else {"flat": flat}), "knife": Knife, "shoe": Shoe}
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
    face: Rolling | Knife | Shoe = faces_of(None, brief=True)
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

    face: Rolling | TiltedFlat | Knife | Shoe = faces_of(TiltedFlat)
    offset_mm: float = coordinate(
        "Offset", default=0.0, help="of the guide from the cam centre, positive to the left of the direction"
    )
    direction_deg: float = seldom(number("Direction", -360.0, 360.0, default=90.0, help="of the rise, 90 = upwards"))
    second: SecondPlace | None = _second(SecondPlace)


SIDES: Mapping[str, float] = MappingProxyType({"left": 1.0, "right": -1.0})


@frozen(kw_only=True)
class Oscillating:
    """Arm on a fixed pivot with a roller, a knife edge or a shoe on the cam."""

    face: Rolling | Knife | Shoe = faces_of(OffsetFlat)
    arm_mm: float = length("Arm", help="pivot to roller centre")
    pivot_x_mm: float = coordinate("Pivot x", help="from the cam centre")
    pivot_y_mm: float = coordinate("Pivot y", help="from the cam centre")
    side: str = choice("Side", tuple(SIDES), help="of the roller, seen from the pivot towards the cam centre")
    second: SecondArm | None = _second(SecondArm)


@frozen(kw_only=True)
class OscillatingFlat:
    """Arm on a fixed pivot with a flat face on the cam, along which the contact moves."""

    face: OffsetFlat = faces_of(OffsetFlat, default=OffsetFlat())
    pivot_x_mm: float = coordinate("Pivot x", help="from the cam centre")
    pivot_y_mm: float = coordinate("Pivot y", help="from the cam centre")
    side: str = choice("Side", tuple(SIDES), help="of the contact, seen from the pivot towards the cam centre")


Follower = CamSlider | Translating | Oscillating | OscillatingFlat


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
    friction: float = _friction()
    spring_rate_n_per_mm: float = leading(number("Spring rate", 0.0, default=0.0))
    preload_n: float = leading(number("Spring preload", default=0.0, help="towards the cam, where the motion is 0"))


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
