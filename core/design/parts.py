"""What the user typed: frozen parts in the user's own units, so that a file round-trips exactly.

No part holds a result, a view setting or another kind's keys; a part that is None does not exist.
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
    words_of,
)
from core.design.followers import (
    FACE,
    FORM,
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
    """A curve known by its name in the table of laws. ``crossover``: where a symmetric law turns from acceleration to
    deceleration, as a fraction of the span. ``flat_fraction``: over which fraction of its span half a cycloid (C1 ... C4) keeps
    its acceleration constant."""

    law: str = placed(FileLayout(missing=" | ".join(LAWS)))
    crossover: float = number("Crossover", 0.01, 0.99, default=0.5, step=0.05, help="0.5 = symmetric")
    flat_fraction: float = number(
        "Constant acceleration",
        0.0,
        1.0,
        default=0.0,
        step=0.05,
        help="fraction of the span, of half a cycloid C1 ... C4",
    )


@frozen
class SccaCurve:
    """Sine - constant - cosine acceleration: of what constant velocity leaves of the span, how much is sine ramp and
    how much constant acceleration; the rest is cosine (Norton ch. 3: b, c, d)."""

    law: ClassVar[str] = "scca"
    cv_fraction: float = number("Constant velocity", 0.0, 0.99, default=0.0, step=0.05, help="fraction of the span")
    ramp_fraction: float = number("Sine ramp", 0.0, 1.0, default=0.25, step=0.05, help="fraction of the rest")
    flat_fraction: float = number(
        "Constant acceleration", 0.0, 1.0, default=0.0, step=0.05, help="fraction of the rest"
    )


@frozen
class PolynomialEnd:
    """What a polynomial does at one end, per degree of cam angle; an absent jerk is left free."""

    velocity: float = number("Velocity", default=0.0, help="per degree")
    acceleration: float = number("Acceleration", default=0.0, help="per degree squared")
    jerk: float | None = number("Jerk", default=None, help="per degree cubed; empty = free")


@frozen
class PolynomialCurve:
    """The polynomial of least degree with the wanted ends."""

    law: ClassVar[str] = "polynomial"
    start: PolynomialEnd = placed(FileLayout(PolynomialEnd, single=True, whole=True), PolynomialEnd())
    end: PolynomialEnd = placed(FileLayout(PolynomialEnd, single=True, whole=True), PolynomialEnd())


@frozen
class SplinePoint:
    """What a spline does at an angle from the segment's start: its value (from the segment's start too), velocity and
    acceleration per degree, as far as they are given."""

    at_deg: float = number("At", 0.0, 360.0)
    value: float | None = number("Value", default=None)
    velocity: float | None = number("Velocity", default=None)
    acceleration: float | None = number("Acceleration", default=None)


@frozen
class SplineCurve:
    """The curve of least jerk (in the mean square) through the points; periodic where it takes the whole turn, else it
    starts and ends at rest where no point says otherwise."""

    law: ClassVar[str] = "spline"
    points: tuple[SplinePoint, ...] = placed(FileLayout(SplinePoint, whole=True), ())


AT_REST, JOINED = "rest", "joined"
TABLE_ENDS = (AT_REST, "stop", "free", JOINED)


@frozen
class TableCurve(SplineCurve):
    """The same curve through rows of a table: cam angle and value, and velocity and acceleration where they are known, which
    the file holds as lists of numbers. What the first and the last row leave open of velocity and acceleration is what ``start`` and
    ``end`` say: at rest, velocity 0 alone, free, or joined, as the neighbour has them there, whatever the row says."""

    law: ClassVar[str] = "table"
    start: str = choice("Start", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it begins")
    end: str = choice("End", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it ends")
    points: tuple[SplinePoint, ...] = placed(FileLayout(SplinePoint, whole=True, rows=True), ())


@frozen
class ComputedCurve:
    """A curve that nobody types, for it follows from other parts: its pieces over the span, 0 ... 1, in the motion's unit, from the
    segment's start."""

    law: ClassVar[str] = "computed"
    pieces: tuple[Piece, ...] = placed(FileLayout(in_file=False))


Curve = NamedCurve | SccaCurve | PolynomialCurve | SplineCurve | TableCurve | ComputedCurve
CURVES: Mapping[str, type[SccaCurve | PolynomialCurve | SplineCurve]] = MappingProxyType(
    {c.law: c for c in (SccaCurve, PolynomialCurve, SplineCurve, TableCurve)}
)
"""Laws with keys of their own; every other one is Named."""


def curve_of(law: str) -> Curve:
    """The curve of that law, its other entries at their defaults."""
    return CURVES[law]() if law in CURVES else NamedCurve(law)


def _curve_class(table: Mapping[str, Any]) -> type[Curve]:
    law = table.get(LAW)
    return CURVES.get(law, NamedCurve) if isinstance(law, str) else NamedCurve


@frozen
class Segment:
    """One stretch of the motion: cam span, rise (end minus start, in the motion's unit), and the curve between."""

    span_deg: float = number("Span", 1e-6, 360.0, step=1.0, help="cam angle this segment takes")
    rise: float = number("Rise", help="end minus start; negative for a return", step=1.0, of_motion=True)
    curve: Curve = placed(FileLayout(NamedCurve, choose=_curve_class, brief=True), NamedCurve("dwell"))


@frozen
class TableOrigin:
    """A motion that is read from a table whenever the design is."""

    table: str = placed(FileLayout(missing="a file"))
    column: str = placed(FileLayout(brief=True), "")
    angle_column: str = placed(FileLayout(brief=True), "")


@frozen
class InverseOrigin:
    """The motion of a linkage's driver that makes an output do what is typed beside it."""

    linkage: str = placed(FileLayout(missing="a design file with [linkage]"))
    output: str = placed(FileLayout(missing="the number of a link"))


@frozen
class Origin:
    """What a motion is a function of, as typed: one of these. Paths are relative to the design's folder."""

    from_: TableOrigin | None = placed(FileLayout(TableOrigin, single=True), None)
    sum: tuple[str, ...] = placed(FileLayout(each=str), ())
    inverse: InverseOrigin | None = placed(FileLayout(InverseOrigin, single=True), None)

    @property
    def key(self) -> str:
        """Of the table [motion]."""
        return "from" if self.from_ is not None else "inverse" if self.inverse is not None else "sum"

    @property
    def names(self) -> tuple[str, ...]:
        """The files as typed."""
        of_one = (
            self.inverse.linkage if self.inverse is not None else self.from_.table if self.from_ is not None else ""
        )
        return (of_one,) if of_one else self.sum


@frozen
class Follows:
    """Where a motion follows from: ``origin`` as typed in a file of ``folder``; ``asked`` of an inverse, the motion of its output; the
    files that were read, those that they follow from among them; ``made``: what followed, which nothing else may become."""

    origin: Origin
    folder: str
    asked: Any
    files: tuple[str, ...]
    made: Any = None


@frozen
class Motion:
    """The follower's motion over one turn: where it stands at cam angle 0, and its segments in order.

    ``unit`` is ``mm`` for a follower that slides and ``deg`` for one that swings; ``advance`` how far it goes on each turn where it
    does not come back: a feed, an indexer.
    """

    FILE_ORDER: ClassVar[tuple[str, ...]] = ("start", "advance", "segments")

    start: float = number("Start", help="position at cam angle 0", of_motion=True)
    segments: tuple[Segment, ...] = placed(FileLayout(Segment), ())
    unit: str = placed(FileLayout(in_file=False), "mm")
    advance: float | None = number(
        "Advance", default=None, help="a turn, where the motion does not come back: rises add up to it", of_motion=True
    )

    follows: Follows | None = placed(FileLayout(in_file=False), None)

    @property
    def is_as_linked(self) -> bool:
        """Whether it is its own, or still what followed from its origin."""
        return self.follows is None or self.follows.made == (self.start, self.segments, self.advance)

    @property
    def gain(self) -> float:
        """What its rises add up to: the advance of a turn, 0 where it comes back."""
        return self.advance or 0.0

    @property
    def scale(self) -> float:
        """From the motion's unit to SI."""
        return UNITS[self.unit].factor


# -- followers: lengths only ------------------------------------------------------------------------------

LAYOUTS = tuple("abcdefgh")


def faces_of(flat: type[Flat] | None, *, brief: bool = False, default: Any = Rolling()) -> Any:  # noqa: B008
    """A dataclass field for the face of a follower, whose keys stand in the follower's table."""
    words = {"roller": Rolling, **({} if flat is None else {"flat": flat}), "knife": Knife, "shoe": Shoe}
    placing = chosen_by_word(FACE, words, "Face", otherwise=default.face, brief=brief, help="what touches the cam")
    return placed(placing, default)


@frozen(kw_only=True)
class SecondArm:
    """Where the second roller of a conjugate pair stands: at the end of an arm that is fixed to the first."""

    arm_mm: float = length("Second arm", help="pivot to the second roller's centre")
    angle_deg: float = number(
        "Second arm's angle", -360.0, 360.0, help="from the first roller's arm, counter-clockwise"
    )


@frozen(kw_only=True)
class SecondPlace:
    """Where the second roller of a conjugate pair stands on a follower that slides."""

    distance_mm: float = length(
        "Second roller's distance", help="behind the first, against the direction; centre to centre"
    )


def _second(kind: type[SecondArm] | type[SecondPlace]) -> Any:
    """A dataclass field for the second roller's place; None but for a conjugate pair."""
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
    offset_mm: float = coordinate("Offset", default=0.0, help="of the guide from the cam centre, positive to its left")
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
    side: str = choice(
        "Side", tuple(SIDES), help="of the ray from the pivot to the cam centre on which the roller lies"
    )
    second: SecondArm | None = _second(SecondArm)


@frozen(kw_only=True)
class OscillatingFlat:
    """Arm on a fixed pivot with a flat face on the cam; the contact moves along it, so that it has no length of its own."""

    face: OffsetFlat = faces_of(OffsetFlat, default=OffsetFlat())
    pivot_x_mm: float = coordinate("Pivot x", help="from the cam centre")
    pivot_y_mm: float = coordinate("Pivot y", help="from the cam centre")
    side: str = choice(
        "Side", tuple(SIDES), help="of the ray from the pivot to the cam centre on which the contact lies"
    )


Follower = CamSlider | Translating | Oscillating | OscillatingFlat


@frozen
class Output:
    """What a motion alone moves, an axis without a mechanism: a slide in mm, or what turns about a pivot in deg. It has no lengths."""

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
    found: Face = follower.face.on(cam)
    return found


SENSES: Mapping[str, float] = MappingProxyType({"ccw": 1.0, "cw": -1.0})


SPRINGS = ("fixed", "retuned")


@frozen
class ElasticShaft:
    """What makes the camshaft flexible: a spring between the drive, which turns evenly, and the cam (Kim1990 Fig. 1).

    ``spring``: the loads are the design's own, or Kim1990's valve spring, made anew for each speed.
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
        choice("Spring", SPRINGS, default="fixed", help="retuned: Kim1990's, as stiff as each speed asks")
    )
    spring_factor: float = seldom(
        number("Spring factor", 0.0, 1e3, default=1.5, step=0.1, help="Kim1990's a of a retuned spring")
    )


def _elastic_class(table: Mapping[str, Any]) -> type[ElasticShaft] | None:
    return ElasticShaft if any(field.name in table for field in fields(ElasticShaft)) else None


@frozen
class Shaft:
    """The camshaft: sense and speed of rotation, flywheel, motor; ``elastic`` where it twists."""

    rotation: str = choice("Rotation", tuple(SENSES))
    speed_rpm: float = leading(number("Speed", 0.0, 1e5, open_low=True, step=1.0))
    flywheel_inertia_kg_m2: float = number("Flywheel inertia", 0.0, default=0.0, help="at the camshaft")
    speed_fluctuation: float = number(
        "Speed fluctuation C_s", 0.0, 2.0, open_low=True, default=0.02, help="target for sizing: (max - min) / mean"
    )
    motor_slope_nm_s_per_rad: float = number(
        "Motor slope", 0.0, open_low=True, default=50.0, help="torque gained per rad/s of lost speed", guessed=True
    )
    motor_inertia_kg_m2: float | None = number("Motor inertia", 0.0, default=None, help="of its rotor, at the motor")
    gear_ratio: float | None = number(
        "Gear ratio",
        0.0,
        1e4,
        open_low=True,
        default=None,
        help="turns of the motor per turn of the camshaft; 1 where none is given",
    )
    elastic: ElasticShaft | None = placed(FileLayout(ElasticShaft, choose=_elastic_class), None)

    @property
    def sense(self) -> float:
        """d of the papers: +1 when the shaft turns counter-clockwise, -1 clockwise."""
        return SENSES[self.rotation]

    @property
    def signed_rpm(self) -> float:
        """The speed, negative where the shaft turns clockwise."""
        return SENSES.get(self.rotation, 1.0) * self.speed_rpm


# -- a servo in place of the cam ---------------------------------------------------------------------------

ROTARY, LINEAR = "rotary", "linear"


@frozen(kw_only=True)
class Servo:
    """A servo motor that makes the motion itself, where a cam else would; its gearing, and what it moves besides the masses of [loads].
    ``kind`` is the motor's."""

    kind: str = choice("Motor", (ROTARY, LINEAR))
    inertia_kg_m2: float | None = number(
        "Inertia moved", 0.0, default=None, help="at the output shaft, added to the loads"
    )
    mass_kg: float | None = number("Mass moved", 0.0, default=None, help="added to the loads")
    friction_nm: float | None = number(
        "Friction torque", 0.0, default=None, help="at the output shaft, against its turning"
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
        "Peak torque", 0.0, open_low=True, default=None, help="the most that the motor gives"
    )
    rated_torque_nm: float | None = number(
        "Rated torque", 0.0, open_low=True, default=None, help="that it bears for good, as rms"
    )
    rated_rpm: float | None = number(
        "Rated speed", 0.0, open_low=True, default=None, help="up to which it gives that torque"
    )
    regenerates: bool = flag("Regenerates", help="gives braking energy back")


def _mass(label: str, help: str = "") -> float:
    field: float = number(label, 0.0, default=0.0, help=help)
    return field


def _friction() -> float:
    field: float = number(
        "Guide friction", 0.0, 10.0, default=0.0, step=0.01, help="coefficient between slider and guide"
    )
    return field


@frozen(kw_only=True)
class Loads(ForceElements):
    """What every follower's loads share; in a file what a follower adds stands first. ``contact``: of a face that slides."""

    contact: ContactFriction | None = placed(FileLayout(ContactFriction, choose=rubs), None)
    gravity_m_s2: float = seldom(number("Gravity", 0.0, default=9.80665))
    gravity_angle_deg: float = seldom(number("Gravity direction", -360.0, 360.0, default=-90.0, help="-90 = downwards"))
    least_contact_force_n: float | None = number(
        "Least contact force", 0.0, default=None, help="that must press the follower on an open cam"
    )
    restitution: float | None = number(
        "Restitution",
        0.0,
        0.95,
        default=None,
        step=0.05,
        help="speed of rebound per speed of landing, where the follower left the cam; 0 where none is given",
    )


@frozen(kw_only=True)
class CamSliderLoads(Loads):
    """Masses and forces of the cam-driven slider."""

    slider_mass_kg: float = _mass("Slider mass")
    rod_mass_kg: float = _mass("Rod mass")
    rod_inertia_kg_m2: float = _mass("Rod inertia", "about its centre of mass")
    rod_centre: float = seldom(
        number("Rod centre", 0.0, 1.0, default=0.5, step=0.05, help="fraction of the rod from the arm's pin")
    )
    arm_mass_kg: float = _mass("Arm mass")
    arm_inertia_kg_m2: float = _mass("Arm inertia", "about its centre of mass")
    arm_centre_mm: float = coordinate("Arm centre", default=0.0, help="centre of mass: distance from the pivot")
    arm_centre_angle_deg: float = seldom(
        number("Arm centre angle", -360.0, 360.0, default=0.0, help="from the slider arm")
    )
    roller_mass_kg: float = _mass("Roller mass")
    roller_inertia_kg_m2: float = _mass("Roller inertia", "about its own centre; turns with the arm")
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
    roller_inertia_kg_m2: float = _mass("Roller inertia", "about its own centre; turns with the arm")
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


def _not_here(default: Any = None) -> Any:
    """A dataclass field for an element that these loads cannot have."""
    return placed(FileLayout(in_file=False), default)


@frozen(kw_only=True)
class OutputLoads(ForceElements):
    """What every output's loads share: forces along its motion, and none between links."""

    follower_stiffness_n_per_mm: None = _not_here()
    follower_damping_ratio: None = _not_here()
    springs: tuple[()] = _not_here(())
    torsion_springs: tuple[()] = _not_here(())
    pair_friction: tuple[()] = _not_here(())


@frozen(kw_only=True)
class SlideLoads(OutputLoads):
    """Mass and forces of what a motion in mm moves."""

    mass_kg: float = _mass("Mass moved")
    force_n: float = number("Force", default=0.0, help="on it, along the positive motion")
    friction_n: float = number("Friction force", 0.0, default=0.0, help="against the motion, whichever way it goes")


@frozen(kw_only=True)
class TurnLoads(OutputLoads):
    """Inertia and torques of what a motion in deg turns."""

    inertia_kg_m2: float = _mass("Inertia turned")
    torque_nm: float = number("Torque", default=0.0, help="on it, along the positive motion")
    friction_nm: float = number("Friction torque", 0.0, default=0.0, help="against the motion, whichever way it goes")


OUTPUT_LOADS: Mapping[str, type[SlideLoads] | type[TurnLoads]] = MappingProxyType({"mm": SlideLoads, "deg": TurnLoads})
"""Unit of a motion that is alone -> its loads."""


# -- kinds of followers ------------------------------------------------------------------------------------


@frozen
class FollowerKind:
    """One row per follower: the classes its tables of the file are read into, and the unit of its motion.

    flat  classes of follower and loads under a flat face, where they are others
    """

    label: str
    follower: type[Follower]
    loads: type[Loads]
    motion_unit: str
    flat: tuple[type[Follower], type[Loads]] | None = None

    @property
    def faces(self) -> Mapping[str, type]:
        """The faces that it can have, by the words of the file."""
        return words_of(self.follower, FACE)

    @property
    def forms(self) -> Mapping[str, type]:
        """The forms that its cam can have under a roller, by the words of the file."""
        return words_of(self.under(Rolling.face)[1], FORM)

    @property
    def followers(self) -> tuple[type[Follower], ...]:
        """Classes of the table ``[follower]`` for this kind."""
        return (self.follower, *(self.flat or ())[:1])

    def under(self, face: str) -> tuple[type[Follower], type[Cam], type[Loads]]:
        """The classes of follower, cam and loads with this face."""
        follower, loads = self.flat if self.flat and face == Flat.face else (self.follower, self.loads)
        return follower, RollerCam if face == Rolling.face else DiskCam, loads


FOLLOWER_KINDS: Mapping[str, FollowerKind] = MappingProxyType(
    {
        "cam-slider": FollowerKind("Cam-driven slider", CamSlider, CamSliderLoads, "mm"),
        "translating": FollowerKind("Translating follower", Translating, TranslatingLoads, "mm"),
        "oscillating": FollowerKind(
            "Oscillating follower", Oscillating, OscillatingLoads, "deg", (OscillatingFlat, OscillatingFlatLoads)
        ),
    }
)


def kind_of(follower: Follower) -> str:
    """The slug of a follower's kind."""
    return next(slug for slug, row in FOLLOWER_KINDS.items() if type(follower) in row.followers)
