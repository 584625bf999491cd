"""Every scalar of a study, one row each: its names in files and in words, its unit and its value; its formula is a row of ``FORMULAS``.

Most rows belong to any design. Others belong to a link, point, pair or body of a linkage: their names contain that member,
``link.3_velocity``, ``point.B_x``, and their rows have {} instead.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import field, replace
from functools import lru_cache, partial
from importlib import import_module
from itertools import chain
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from core.cam import OUTER, SECOND
from core.design import FOLLOWER_KINDS, MOTION, Design, Unit, split_unit
from core.design.spatial import SPATIAL_CAMS
from core.dynamics import element_power, gravity_power, input_power, kinetic_energy
from core.dynamics.walk import input_of
from core.frozen import frozen
from core.mechanism import body_name
from core.shaft import Flywheel
from core.study.drive_forces import roller_pv, roller_speed, servo_power, servo_speed, servo_torque
from core.study.member_quantities import (
    CLEARANCE,
    PUSHROD,
    SINGULAR_OF,
    SLIDER,
    TRAIN_PAIRS,
    TRAINS,
    centre_distance,
    centre_velocity,
    contact_stress_part,
    coordinate,
    force_component,
    guide_reaction,
    has_any,
    has_motor_torque,
    has_steady_turn,
    has_steady_vibration,
    has_variable_speed,
    members,
    motion_by_time,
    motor_quantity,
    output_power,
    point_component,
    polar_angle,
    position_modulo,
    profile_radius,
    push_product,
    reference_velocity,
    rocker_ratio,
    second_roller_distance,
    shaft_speed,
    singular_value,
    transmission_angle,
    valve_lift,
)
from core.study.study import FLAT, NEEDS, Study

if TYPE_CHECKING:
    from core.study.symbols import Formula

FOLLOWERS = frozenset(FOLLOWER_KINDS)
ALONE = frozenset({MOTION})
DISK = FOLLOWERS | {"linkage"}
"""Kinds that a disk cam can have."""
SURFACES = frozenset(SPATIAL_CAMS)
"""Kinds of cams in space, which move an output."""
OUTPUTS = ALONE | SURFACES
ALL_KINDS = DISK | OUTPUTS
GUIDED = frozenset({"cam-slider", "translating"})
PIVOTED = frozenset({"cam-slider", "oscillating"})

PROFILE, KINEMATICS, DYNAMICS = "profile.csv", "kinematics.csv", "dynamics.csv"
LINKAGE, ORBIT, SERVO, CLEARANCES = "linkage.csv", "orbit.csv", "servo.csv", "clearance.csv"
TABLES: Mapping[str, str] = MappingProxyType(
    {"motion": KINEMATICS, "linkage": LINKAGE, "cam": PROFILE, "dynamics": DYNAMICS, "stability": ORBIT}
)
"""Stage -> CSV file with its quantities."""


@frozen
class Quantity:
    """A scalar of a study, as tables, plots, limits and reports use it.

    Attributes
    ----------
    name : name in limits, graphs and setups
    slug : column name, which ends with the unit; empty for a quantity of checks, which no reader sees
    label, symbol : in words and in formulas
    family : chooses its colour: displacement, velocity, speed, acceleration, jerk, pressure-angle, curvature, force, torque, stress,
        angle, length, energy, power, ratio
    stage : stage of the study that computes it
    value : study -> ndarray (n,) in SI units, by time where it is a rate; where the name has {}: of study and member
    kinds : kinds of mechanism that have it
    needs : row of ``NEEDS``, what else the design must have
    is_periodic : whether it is an angle that wraps, without extremes
    exists : whether a study of such a design has it
    needs_smooth_profile : whether it exists only where the profile has no undercut (``extremes.has_quantity`` checks both)
    approximates : quantity that it approximates; it is drawn dashed
    file : CSV file of its column, where that is not the file of its stage
    variant : ending of its row of ``FORMULAS``, where the design's face or kind of cam has a formula of its own
    """

    name: str
    slug: str
    label: str
    symbol: str
    family: str
    stage: str
    value: Callable[..., np.ndarray] = field(compare=False)
    kinds: frozenset[str] = ALL_KINDS
    needs: str = ""
    is_periodic: bool = False
    exists: Callable[[Study], bool] = has_any
    needs_smooth_profile: bool = False
    approximates: str = ""
    file: str = ""
    variant: str = ""

    @property
    def column(self) -> str:
        """Name of its column in its table; in that of a servo, which has no other motor, ``motor_...``."""
        return self.slug.replace("servo_", "motor_", 1) if self.file == SERVO else self.slug

    @property
    def unit(self) -> Unit:
        """Unit at the end of its slug."""
        return split_unit(self.slug)[1]

    @property
    def formula(self) -> Formula | None:
        """Its row of ``FORMULAS``; None where no reader sees the quantity."""
        from core.study.formulas import FORMULAS  # a quantity is computed without its formula

        name = shape_of(self.name)
        return FORMULAS.get(f"{name}{self.variant}") or FORMULAS.get(name)

    @property
    def equation(self) -> str:
        """Its equation, as the report prints it."""
        return "" if self.formula is None else self.formula.lines[0]

    @property
    def flat(self) -> str:
        """Its equation under a straight face, where that is another."""
        flat, round_ = (replace(self, variant=variant).equation for variant in (FLAT, ""))
        return "" if flat == round_ else flat

    @property
    def source(self) -> str:
        """Author, year and number of its equation, or the principle that it follows from."""
        return "" if self.formula is None else self.formula.source

    @property
    def table(self) -> str:
        """CSV file with its column."""
        return self.file or TABLES[self.stage]

    def values(self, study: Study) -> np.ndarray:
        """Values in the unit of its column.

        Parameters
        ----------
        study : Study

        Returns
        -------
        ndarray (n,) [unit of the column]
        """
        return np.asarray(self.value(study) / self.unit.factor + 0.0)  # no minus zero in tables


# -- rows of any design -----------------------------------------------------------------------------------------

_DIRECTIONS = (
    Quantity(f"{name}_direction", f"{name}_direction_deg", f"{label}, direction", f"∠{symbol}", "angle",
             "dynamics", partial(force_component, pair=name, component="direction"), kinds, is_periodic=True)
    for name, label, symbol, kinds in (
        ("slider_pin", "Slider pin", "A", SLIDER), ("arm_pin", "Arm pin", "B", SLIDER), ("pivot", "Pivot", "P", PIVOTED | TRAINS),
        ("bearing", "Camshaft bearing", "O", FOLLOWERS), ("guide", "Guide", "G", GUIDED | PUSHROD), *TRAIN_PAIRS,
    )
)  # fmt: skip
_TRAIN_FORCES = (
    Quantity(f"{name}{end}", f"{name}{end}_n", f"{label}{words}", f"{symbol}{index}" if index else f"|{symbol}|", "force",
             "dynamics", partial(force_component, pair=name, component=component), kinds)
    for name, label, symbol, kinds in TRAIN_PAIRS
    for end, words, index, component in (("_x", ", x", "x", "x"), ("_y", ", y", "y", "y"), ("", "", "", "size"))
)  # fmt: skip
_HERTZ = (
    ("contact_pressure", "mpa", "Contact pressure", "p", "stress", "pressure"),
    ("subsurface_shear", "mpa", "Subsurface shear", "τ", "stress", "shear"),
    ("subsurface_shear_depth", "mm", "Depth of the largest shear", "z_τ", "length", "depth"),
    ("contact_half_width", "mm", "Half width of the contact", "a", "length", "half_width"),
)  # fmt: skip


def _contact(key: str, index: str, second: bool) -> Iterator[Quantity]:
    """Stresses under the first roller or face, or under the second roller."""

    def labelled(label: str) -> str:
        return f"Second {label.lower()}" if second else label

    for name, unit, label, symbol, family, part in _HERTZ:
        yield Quantity(f"{key}{name}", f"{key}{name}_{unit}", labelled(label), f"{symbol}{index}", family,
                       "dynamics", partial(contact_stress_part, part=part, second=second), needs="second stress" if second else "stress",
                       needs_smooth_profile=True)  # fmt: skip
    roller = "second" if second else "first"
    yield Quantity(f"{key}roller_speed", f"{key}roller_speed_rpm", labelled("Roller's own speed"), f"n_r{index}", "speed",
                   "dynamics", partial(roller_speed, roller=roller), needs=f"{roller} rating")  # fmt: skip


_CONTACT = (*_contact("", "", second=False), *_contact("second_", "₂", second=True))


def _value(module: str, name: str) -> Callable[[Study], np.ndarray]:
    """Value by a function of a module that few designs need, which is imported with the first value."""

    def value(study: Study) -> np.ndarray:
        function: Callable[[Study], np.ndarray] = getattr(import_module(f"{__package__}.{module}"), name)
        return function(study)

    return value


def _unseen(
    name: str, stage: str, value: Callable[[Study], np.ndarray], kinds: frozenset[str] = ALL_KINDS, needs: str = ""
) -> Quantity:
    """A quantity of checks, which no reader sees."""
    return Quantity(name, "", "", "", "", stage, value, kinds, needs)


# {m} is the unit of the motion: mm where the output slides, deg where it swings
_ROWS: tuple[Quantity, ...] = (
    Quantity("displacement", "displacement_{m}", "Displacement", "y", "displacement",
             "motion", lambda s: motion_by_time(s, 0), needs="motion"),
    Quantity("velocity", "velocity_{m}_s", "Velocity", "ẏ", "velocity", "motion", lambda s: motion_by_time(s, 1), needs="motion"),
    Quantity("acceleration", "acceleration_{m}_s2", "Acceleration", "ÿ", "acceleration",
             "motion", lambda s: motion_by_time(s, 2), needs="motion"),
    Quantity("jerk", "jerk_{m}_s3", "Jerk", "y⃛", "jerk", "motion", lambda s: motion_by_time(s, 3), needs="motion"),
    Quantity("position_modulo", "position_modulo_{m}", "Position modulo the advance", "y mod a", "displacement",
             "motion", position_modulo, OUTPUTS, is_periodic=True),
    Quantity("slider_position", "slider_position_mm", "Slider position", "L", "displacement",
             "linkage", lambda s: coordinate(s, "slider_position"), SLIDER, file=KINEMATICS),
    Quantity("phi", "phi_deg", "Arm angle", "φ", "angle", "linkage", lambda s: coordinate(s, "phi"), SLIDER, file=KINEMATICS),
    Quantity("phi_velocity", "phi_rad_s", "Arm velocity", "φ̇", "velocity",
             "linkage", lambda s: coordinate(s, "phi", 1), SLIDER, file=KINEMATICS),
    Quantity("phi_acceleration", "phi_rad_s2", "Arm acceleration", "φ̈", "acceleration",
             "linkage", lambda s: coordinate(s, "phi", 2), SLIDER, file=KINEMATICS),
    Quantity("beta", "beta_deg", "Rod angle", "β", "angle", "linkage", lambda s: coordinate(s, "beta"), SLIDER, file=KINEMATICS),
    Quantity("beta_velocity", "beta_rad_s", "Rod velocity", "β̇", "velocity",
             "linkage", lambda s: coordinate(s, "beta", 1), SLIDER, file=KINEMATICS),
    Quantity("beta_acceleration", "beta_rad_s2", "Rod acceleration", "β̈", "acceleration",
             "linkage", lambda s: coordinate(s, "beta", 2), SLIDER, file=KINEMATICS),
    Quantity("valve_lift", "valve_lift_mm", "Valve lift", "y_v", "displacement",
             "linkage", valve_lift, needs="valve", file=KINEMATICS),
    Quantity("valve_velocity", "valve_velocity_mm_s", "Valve velocity", "ẏ_v", "velocity",
             "linkage", partial(valve_lift, order=1), needs="valve", file=KINEMATICS),
    Quantity("valve_acceleration", "valve_acceleration_mm_s2", "Valve acceleration", "ÿ_v", "acceleration",
             "linkage", partial(valve_lift, order=2), needs="valve", file=KINEMATICS),
    Quantity("piston_clearance", "piston_clearance_mm", "Clearance of valve and piston", "c", "length",
             "linkage", _value("piston", "piston_clearance"), needs="piston", file=KINEMATICS),
    Quantity("rocker_ratio", "rocker_ratio", "Rocker ratio", "i", "ratio", "linkage", rocker_ratio, TRAINS, file=KINEMATICS),
    Quantity("pad_position", "pad_position_mm", "Pad on the tip", "x_t", "length",
             "linkage", lambda s: coordinate(s, "pad_position"), TRAINS, file=KINEMATICS),
    Quantity("profile_x", "x_mm", "Profile x", "x", "length", "cam", lambda s: s.cam.flank.profile.real, DISK, needs="cam"),
    Quantity("profile_y", "y_mm", "Profile y", "y", "length", "cam", lambda s: s.cam.flank.profile.imag, DISK, needs="cam"),
    Quantity("pitch_x", "pitch_x_mm", "Pitch curve x", "x_p", "length", "cam", lambda s: s.cam.flank.pitch.real, DISK, needs="pitch"),
    Quantity("pitch_y", "pitch_y_mm", "Pitch curve y", "y_p", "length", "cam", lambda s: s.cam.flank.pitch.imag, DISK, needs="pitch"),
    Quantity("pressure_angle", "pressure_angle_deg", "Pressure angle", "ψ", "pressure-angle",
             "cam", lambda s: s.cam.flank.pressure_angle, DISK, needs="cam"),
    Quantity("pitch_curvature", "pitch_curvature_per_mm", "Pitch curvature", "κ_p", "curvature",
             "cam", lambda s: s.cam.flank.pitch_curvature, DISK, needs="pitch"),
    Quantity("radius", "radius_mm", "Cam radius", "r", "length", "cam", profile_radius, DISK, needs="cam"),
    Quantity("polar_angle", "polar_angle_deg", "Polar angle", "ϑ", "angle", "cam", polar_angle, DISK, needs="cam", is_periodic=True),
    Quantity("profile_curvature", "profile_curvature_per_mm", "Profile curvature", "κ", "curvature",
             "cam", lambda s: s.cam.flank.profile_curvature, DISK, needs="cam"),
    Quantity("contact_on_face", "contact_on_face_mm", "Contact on the face", "x_f", "length",
             "cam", lambda s: s.cam.flank.on_face, DISK, needs="straight"),
    Quantity("outer_x", "outer_x_mm", "Outer flank x", "x_o", "length",
             "cam", lambda s: s.cam.only(OUTER).flank.profile.real, DISK, needs=OUTER),
    Quantity("outer_y", "outer_y_mm", "Outer flank y", "y_o", "length",
             "cam", lambda s: s.cam.only(OUTER).flank.profile.imag, DISK, needs=OUTER),
    Quantity("outer_curvature", "outer_curvature_per_mm", "Outer flank's curvature", "κ_o", "curvature",
             "cam", lambda s: s.cam.only(OUTER).flank.profile_curvature, DISK, needs=OUTER),
    Quantity("second_x", "second_x_mm", "Second profile x", "x₂", "length",
             "cam", lambda s: s.cam.only(SECOND).flank.profile.real, DISK, needs=SECOND),
    Quantity("second_y", "second_y_mm", "Second profile y", "y₂", "length",
             "cam", lambda s: s.cam.only(SECOND).flank.profile.imag, DISK, needs=SECOND),
    Quantity("second_pitch_x", "second_pitch_x_mm", "Second pitch curve x", "x_p2", "length",
             "cam", lambda s: s.cam.only(SECOND).flank.pitch.real, DISK, needs=SECOND),
    Quantity("second_pitch_y", "second_pitch_y_mm", "Second pitch curve y", "y_p2", "length",
             "cam", lambda s: s.cam.only(SECOND).flank.pitch.imag, DISK, needs=SECOND),
    Quantity("second_pressure_angle", "second_pressure_angle_deg", "Second pressure angle", "ψ₂", "pressure-angle",
             "cam", lambda s: s.cam.only(SECOND).flank.pressure_angle, DISK, needs=SECOND),
    Quantity("second_pitch_curvature", "second_pitch_curvature_per_mm", "Second pitch curvature", "κ_p2", "curvature",
             "cam", lambda s: s.cam.only(SECOND).flank.pitch_curvature, DISK, needs=SECOND),
    Quantity("second_profile_curvature", "second_profile_curvature_per_mm", "Second profile's curvature", "κ₂", "curvature",
             "cam", lambda s: s.cam.only(SECOND).flank.profile_curvature, DISK, needs=SECOND),
    Quantity("pressure_angle", "pressure_angle_deg", "Pressure angle", "ψ", "pressure-angle",
             "cam", lambda s: s.surface.pressure_angle, SURFACES, needs="cam"),
    Quantity("sliding", "sliding_mm_s", "Sliding of the roller", "v_s", "velocity",
             "cam", lambda s: s.surface.sliding * abs(s.omega), SURFACES, needs="cam"),
    Quantity("surface_curvature", "curvature_per_mm", "Curvature of the flank", "κ", "curvature",
             "cam", lambda s: s.surface.curvature, SURFACES, needs="cam"),
    Quantity("contact_force", "contact_force_n", "Contact force", "F_c", "force",
             "dynamics", lambda s: s.dynamics.contact, needs="loaded cam"),
    Quantity("valve_spring_force", "valve_spring_force_n", "Valve spring force", "F_s", "force",
             "dynamics", _value("valve_springs", "valve_spring_force"), needs="valve springs"),
    Quantity("valve_spring_stress", "valve_spring_stress_mpa", "Valve spring stress", "τ_s", "stress",
             "dynamics", _value("valve_springs", "valve_spring_stress"), needs="valve springs"),
    Quantity("second_contact_force", "second_contact_force_n", "Second contact force", "F_c2", "force",
             "dynamics", lambda s: s.dynamics.contacts[1].force, needs=SECOND),
    Quantity("force", "force_n", "Force", "F", "force", "dynamics", lambda s: s.dynamics.driver, OUTPUTS, needs="slide"),
    Quantity("output_torque", "torque_nm", "Torque", "T", "torque", "dynamics", lambda s: s.dynamics.driver, OUTPUTS, needs="turned"),
    Quantity("output_power", "power_w", "Power", "P", "power",
             "dynamics", output_power, OUTPUTS, needs="loaded"),
    Quantity("roller_pv", "roller_pv_mpa_m_s", "PV of the roller", "PV", "stress",
             "dynamics", roller_pv, SURFACES, needs="loaded cam"),
    Quantity("drive_torque", "drive_torque_nm", "Cam torque", "T_c", "torque",
             "dynamics", lambda s: s.dynamics.torque, needs="loaded cam"),
    Quantity("motor_torque", "motor_torque_nm", "Motor torque with flywheel", "T_m", "torque",
             "dynamics", motor_quantity(Flywheel.motor_torque), needs="shaft", exists=has_motor_torque),
    Quantity("servo_torque", "servo_torque_nm", "Servo's torque", "T_s", "torque",
             "dynamics", servo_torque, needs="rotary servo", file=SERVO),
    Quantity("servo_force", "servo_force_n", "Servo's force", "F_s", "force",
             "dynamics", servo_torque, needs="linear servo", file=SERVO),
    Quantity("servo_speed", "servo_speed_rpm", "Servo's speed", "n_s", "speed",
             "dynamics", servo_speed, needs="rotary servo", file=SERVO),
    Quantity("servo_velocity", "servo_velocity_mm_s", "Servo's velocity", "v_s", "velocity",
             "dynamics", servo_speed, needs="linear servo", file=SERVO),
    Quantity("servo_power", "servo_power_w", "Servo's power", "P_s", "power", "dynamics", servo_power, needs="servo", file=SERVO),
    Quantity("guide_force", "guide_force_n", "Guide force", "N", "force", "dynamics", lambda s: guide_reaction(s).normal, GUIDED),
    Quantity("slider_pin_x", "slider_pin_x_n", "Slider pin, x", "A_x", "force",
             "dynamics", lambda s: force_component(s, "slider_pin", "x"), SLIDER),
    Quantity("slider_pin_y", "slider_pin_y_n", "Slider pin, y", "A_y", "force",
             "dynamics", lambda s: force_component(s, "slider_pin", "y"), SLIDER),
    Quantity("arm_pin_x", "arm_pin_x_n", "Arm pin, x", "-B_x", "force",
             "dynamics", lambda s: force_component(s, "arm_pin", "x"), SLIDER),
    Quantity("arm_pin_y", "arm_pin_y_n", "Arm pin, y", "-B_y", "force",
             "dynamics", lambda s: force_component(s, "arm_pin", "y"), SLIDER),
    Quantity("pivot_x", "pivot_x_n", "Pivot, x", "P_x", "force", "dynamics", lambda s: force_component(s, "pivot", "x"), PIVOTED | TRAINS),
    Quantity("pivot_y", "pivot_y_n", "Pivot, y", "P_y", "force", "dynamics", lambda s: force_component(s, "pivot", "y"), PIVOTED | TRAINS),
    Quantity("bearing_x", "bearing_x_n", "Camshaft bearing, x", "O_x", "force",
             "dynamics", lambda s: force_component(s, "bearing", "x"), FOLLOWERS),
    Quantity("bearing_y", "bearing_y_n", "Camshaft bearing, y", "O_y", "force",
             "dynamics", lambda s: force_component(s, "bearing", "y"), FOLLOWERS),
    Quantity("camshaft_speed", "speed_rpm", "Camshaft speed", "n", "speed",
             "dynamics", shaft_speed, needs="shaft", exists=has_motor_torque),
    Quantity("follower_torque", "slider_torque_nm", "Slider torque", "T_L", "torque",
             "dynamics", lambda s: s.dynamics.follower_torque, PIVOTED),
    Quantity("slider_pin", "slider_pin_n", "Slider pin", "|A|", "force",
             "dynamics", lambda s: force_component(s, "slider_pin", "size"), SLIDER),
    Quantity("arm_pin", "arm_pin_n", "Arm pin", "|B|", "force", "dynamics", lambda s: force_component(s, "arm_pin", "size"), SLIDER),
    Quantity("pivot", "pivot_n", "Pivot", "|P|", "force", "dynamics", lambda s: force_component(s, "pivot", "size"), PIVOTED | TRAINS),
    Quantity("bearing", "bearing_n", "Camshaft bearing", "|O|", "force",
             "dynamics", lambda s: force_component(s, "bearing", "size"), FOLLOWERS),
    Quantity("guide_x", "guide_x_n", "Guide, x", "G_x", "force", "dynamics", lambda s: force_component(s, "guide", "x"), GUIDED | PUSHROD),
    Quantity("guide_y", "guide_y_n", "Guide, y", "G_y", "force", "dynamics", lambda s: force_component(s, "guide", "y"), GUIDED | PUSHROD),
    Quantity("guide", "guide_n", "Guide, with friction", "|G|", "force",
             "dynamics", lambda s: force_component(s, "guide", "size"), GUIDED | PUSHROD),
    Quantity("guide_couple", "guide_couple_nm", "Couple on the guide", "M_G", "torque",
             "dynamics", lambda s: s.dynamics.couples["guide"], GUIDED | PUSHROD),
    *_TRAIN_FORCES,
    *_DIRECTIONS,
    Quantity("jam_factor", "jam_factor", "Jamming factor", "μ|tan β|", "ratio", "dynamics", lambda s: guide_reaction(s).jam, GUIDED),
    *_CONTACT,
    Quantity("elastic_displacement", "elastic_displacement_{m}", "Elastic follower", "z", "displacement",
             "dynamics", lambda s: s.motion.displacement[0] + s.elastic_error(), needs="elastic", exists=has_steady_vibration),
    Quantity("elastic_error", "elastic_error_{m}", "Elastic follower, error", "z - s", "displacement",
             "dynamics", lambda s: s.elastic_error(), needs="elastic", exists=has_steady_vibration),
    Quantity("elastic_acceleration", "elastic_acceleration_{m}_s2", "Elastic follower, acceleration", "z̈", "acceleration",
             "dynamics", lambda s: s.motion.displacement[2] * s.omega**2 + s.elastic_error(2),
             needs="elastic", exists=has_steady_vibration),
    Quantity("elastic_contact_force", "elastic_contact_force_n", "Contact force, elastic follower", "F_c", "force",
             "dynamics", lambda s: s.elastic_contact_force, needs="elastic open", exists=has_steady_vibration),
    Quantity("linear_motor_torque", "linear_motor_torque_nm", "Motor torque, linear, Shin1995", "T_m", "torque",
             "dynamics", motor_quantity(Flywheel.linear_motor_torque), needs="shaft", exists=has_variable_speed,
             approximates="motor_torque"),
    Quantity("instant_centre", "instant_centre_mm", "Instant centre Q", "Q", "length",
             "cam", centre_distance, FOLLOWERS, needs="cam"),
    Quantity("instant_centre_x", "instant_centre_x_mm", "Instant centre Q, x", "Q_x", "length",
             "cam", lambda s: s.cam.flank.centre.finite.real, DISK, needs="cam"),
    Quantity("instant_centre_y", "instant_centre_y_mm", "Instant centre Q, y", "Q_y", "length",
             "cam", lambda s: s.cam.flank.centre.finite.imag, DISK, needs="cam"),
    Quantity("instant_centre_velocity", "instant_centre_velocity_mm_s", "Velocity of Q", "V_Q", "velocity",
             "cam", centre_velocity, DISK, needs="cam"),
    Quantity("reference_velocity", "roller_centre_velocity_mm_s", "Velocity of the roller centre", "V_R", "velocity",
             "cam", reference_velocity, DISK, needs="pitch"),
    Quantity("wind_up", "wind_up_deg", "Wind-up of the shaft", "θ_i - θ_c", "angle",
             "stability", lambda s: s.steady_turn.wind_up(s.theta), needs="elastic shaft", exists=has_steady_turn),
    Quantity("follower_error", "follower_error_{m}", "Follower's error", "ΔX", "displacement",
             "stability", lambda s: s.steady_turn.error(s.theta), needs="elastic shaft", exists=has_steady_turn),
    Quantity("shaft_torque", "shaft_torque_nm", "Torque in the shaft", "T_s", "torque",
             "stability", lambda s: s.steady_turn.torque(s.theta), needs="elastic shaft", exists=has_steady_turn),
    *(_unseen(code, "linkage", partial(singular_value, code=code), kinds) for code, kinds in SINGULAR_OF.items()),
    _unseen("profile_radius", "cam", lambda s: s.cam.flank.profile_radius, DISK, needs="straight"),
    _unseen("flank_margin", "cam", lambda s: s.surface.margin, SURFACES, needs="cam"),
    _unseen("rib_wall", "cam", lambda s: s.rib_thickness, SURFACES, needs="rib"),
    _unseen("second_roller_distance", "cam", second_roller_distance, DISK, needs=SECOND),
    _unseen("second_push", "cam", push_product, DISK, needs=SECOND),
)  # fmt: skip


def _of_all_kinds(rows: list[Quantity]) -> Quantity:
    """Rows of one name as one quantity, computed by the row of the study's kind."""
    if len(rows) == 1:
        return rows[0]
    by_kind = {kind: row.value for row in rows for kind in row.kinds}
    return replace(
        rows[0],
        kinds=frozenset(by_kind),
        value=lambda study: by_kind[study.design.drive.kind](study),
    )


def _by_name() -> dict[str, Quantity]:
    rows: dict[str, list[Quantity]] = {}
    for row in _ROWS:
        rows.setdefault(row.name, []).append(row)
    return {name: _of_all_kinds(same) for name, same in rows.items()}


QUANTITIES: Mapping[str, Quantity] = MappingProxyType(_by_name())
"""Name -> quantity. A name can have several rows, as the pressure angle of a disk cam and that of a cam in space."""

OF_MOTOR = frozenset({"motor_torque", "linear_motor_torque", "camshaft_speed"})
"""Quantities of the stage ``dynamics`` that flywheel and motor change; all forces are computed at constant speed."""

OF_CONTACT = frozenset(row.name for row in _CONTACT)
"""Quantities of the stage ``dynamics`` that the materials of cam and roller change."""

OF_SPEED = frozenset({"instant_centre_velocity", "reference_velocity", "sliding"})
"""Quantities of the stage ``cam`` that the machine's speed changes."""


# -- rows of members of a linkage ---------------------------------------------------------------------------

TRANSMISSION = "transmission.{}"
DISTANCE = "{}_mm"
"""Name and column of the clearance of two bodies, whose member is the names of both: ``link_3__frame``."""
OF_MEMBERS: Mapping[str, tuple[Quantity, ...]] = MappingProxyType(
    {
        "link": (
            Quantity("link.{}", "link{}_deg", "Link {}", "θ{}", "angle", "linkage", lambda s, n: coordinate(s, f"link{n}")),
            Quantity("link.{}_velocity", "link{}_rad_s", "Link {}, velocity", "ω{}", "velocity",
                     "linkage", lambda s, n: coordinate(s, f"link{n}", 1)),
            Quantity("link.{}_acceleration", "link{}_rad_s2", "Link {}, acceleration", "α{}", "acceleration",
                     "linkage", lambda s, n: coordinate(s, f"link{n}", 2)),
        ),
        "slide": (
            Quantity("slide.{}", "link{}_slide_mm", "Slide of link {}", "s{}", "displacement",
                     "linkage", lambda s, n: coordinate(s, f"slide{n}")),
            Quantity("slide.{}_velocity", "link{}_slide_mm_s", "Slide of link {}, velocity", "ṡ{}", "velocity",
                     "linkage", lambda s, n: coordinate(s, f"slide{n}", 1)),
            Quantity("slide.{}_acceleration", "link{}_slide_mm_s2", "Slide of link {}, acceleration", "s̈{}", "acceleration",
                     "linkage", lambda s, n: coordinate(s, f"slide{n}", 2)),
        ),
        "point": (
            Quantity("point.{}_x", "{}_x_mm", "{}, x", "x_{}", "length", "linkage", lambda s, point: point_component(s, point, "x")),
            Quantity("point.{}_y", "{}_y_mm", "{}, y", "y_{}", "length", "linkage", lambda s, point: point_component(s, point, "y")),
            Quantity("point.{}_vx", "{}_vx_mm_s", "{}, velocity x", "ẋ_{}", "velocity",
                     "linkage", lambda s, point: point_component(s, point, "vx")),
            Quantity("point.{}_vy", "{}_vy_mm_s", "{}, velocity y", "ẏ_{}", "velocity",
                     "linkage", lambda s, point: point_component(s, point, "vy")),
            Quantity("point.{}_ax", "{}_ax_mm_s2", "{}, acceleration x", "ẍ_{}", "acceleration",
                     "linkage", lambda s, point: point_component(s, point, "ax")),
            Quantity("point.{}_ay", "{}_ay_mm_s2", "{}, acceleration y", "ÿ_{}", "acceleration",
                     "linkage", lambda s, point: point_component(s, point, "ay")),
            Quantity("point.{}_speed", "{}_speed_mm_s", "{}, speed", "|V_{}|", "velocity",
                     "linkage", lambda s, point: point_component(s, point, "speed")),
        ),
        "dyad": (
            Quantity(TRANSMISSION, "transmission_{}_deg", "Transmission angle at {}", "μ_{}", "pressure-angle",
                     "linkage", transmission_angle),
        ),
        "guide": (
            Quantity("force.{}_x", "link{}_guide_x_n", "Guide of link {}, x", "F_{}x", "force",
                     "dynamics", lambda s, pair: force_component(s, pair, "x")),
            Quantity("force.{}_y", "link{}_guide_y_n", "Guide of link {}, y", "F_{}y", "force",
                     "dynamics", lambda s, pair: force_component(s, pair, "y")),
            Quantity("force.{}_size", "link{}_guide_n", "Guide of link {}", "|F_{}|", "force",
                     "dynamics", lambda s, pair: force_component(s, pair, "size")),
            Quantity("force.{}_direction", "link{}_guide_direction_deg", "Guide of link {}, direction", "∠F_{}", "angle",
                     "dynamics", lambda s, pair: force_component(s, pair, "direction"), is_periodic=True),
            Quantity("couple.{}", "link{}_couple_nm", "Couple on the guide of link {}", "M_{}", "torque",
                     "dynamics", lambda s, pair: s.dynamics.couples[pair]),
        ),
        "pin": (
            Quantity("force.{}_x", "{}_x_n", "Force at {}, x", "F_{}x", "force",
                     "dynamics", lambda s, pair: force_component(s, pair, "x")),
            Quantity("force.{}_y", "{}_y_n", "Force at {}, y", "F_{}y", "force",
                     "dynamics", lambda s, pair: force_component(s, pair, "y")),
            Quantity("force.{}_size", "{}_n", "Force at {}", "|F_{}|", "force",
                     "dynamics", lambda s, pair: force_component(s, pair, "size")),
            Quantity("force.{}_direction", "{}_direction_deg", "Force at {}, direction", "∠F_{}", "angle",
                     "dynamics", lambda s, pair: force_component(s, pair, "direction"), is_periodic=True),
        ),
        "bodies": (
            Quantity("kinetic_energy", "kinetic_energy_j", "Kinetic energy", "E", "energy",
                     "dynamics", lambda s: kinetic_energy(s.linkage, s.loading, s.omega)),
        ),
        "body": (
            Quantity("kinetic_energy.{}", "{}_kinetic_energy_j", "Kinetic energy of {}", "E {}", "energy",
                     "dynamics", lambda s, body: kinetic_energy(s.linkage, s.loading, s.omega, body)),
        ),
        "load": (
            Quantity("power.load", "load_power_w", "Power of spring and external force", "P", "power",
                     "dynamics", lambda s: s.loading.acting(s.linkage) * element_power(s.loading.named["load"], s.linkage, s.omega)),
        ),
        "drive": (
            Quantity("power.drive", "drive_power_w", "Power of the drive", "P_d", "power",
                     "dynamics", lambda s: input_power(s.linkage, s.dynamics)),
        ),
        "gravity": (
            Quantity("power.gravity", "gravity_power_w", "Power of gravity", "P_g", "power",
                     "dynamics", lambda s: gravity_power(s.linkage, s.loading, s.omega)),
        ),
        "friction": (
            Quantity("power.friction_{}", "friction_{}_power_w", "Power of friction at {}", "P_μ {}", "power",
                     "dynamics", lambda s, pair: -s.dynamics.friction_power_by_pair[pair]),
        ),
        "element": (
            Quantity("power.{}", "{}_power_w", "Power of {}", "P {}", "power",
                     "dynamics", lambda s, name: s.loading.acting(s.linkage) * element_power(s.loading.named[name], s.linkage, s.omega)),
        ),
        "swing": (
            Quantity("driver_angle", "driver_angle_deg", "Driver angle", "φ", "angle",
                     "linkage", lambda s: s.drive.displacement[0], exists=lambda s: s.by_cycle),
        ),
        "second driver": (
            Quantity("link{}_input_torque", "link{}_input_torque_nm", "Input torque of link {}", "T", "torque",
                     "dynamics", lambda s, n: s.dynamics.couples[input_of(body_name(int(n)))]),
        ),
        "second slide": (
            Quantity("link{}_input_force", "link{}_input_force_n", "Input force of link {}", "F", "force",
                     "dynamics", lambda s, n: s.dynamics.couples[input_of(body_name(int(n)))]),
        ),
        "driving pin": (
            Quantity("driver_torque", "driver_torque_nm", "Driver torque", "T", "torque", "dynamics", lambda s: s.dynamics.driver),
        ),
        "driving slide": (
            Quantity("driver_force", "driver_force_n", "Driver force", "F_d", "force", "dynamics", lambda s: s.dynamics.driver),
        ),
        CLEARANCE: (
            Quantity(DISTANCE, DISTANCE, "Clearance of {}", "d", "length", "linkage", lambda s, pair: s.clearances.of_member(s, pair),
                     file=CLEARANCES),
        ),
    }
)  # fmt: skip
"""Sort of member -> its rows; a sort with one member has a name without {}. A name belongs to the first row that matches."""
_NUMBERED = frozenset({"link", "slide", "guide", "second driver", "second slide"})
"""Sorts whose members are numbers of links."""
_WORDED = frozenset({"body", "friction", "element"})
"""Sorts whose members are words, such as ``torsion_spring2``."""


@lru_cache(maxsize=1024)
def _match(name: str) -> tuple[str, Quantity, str] | None:
    """Sort, row and member of a name; None where no member has it."""
    for sort, rows in OF_MEMBERS.items():
        for row in rows:
            before, has_member, after = row.name.partition("{}")
            if not has_member and name == row.name:
                return sort, row, ""
            if has_member and name.startswith(before) and name.endswith(after):
                member = name[len(before) : len(name) - len(after)]
                is_member = member.isdecimal() if sort in _NUMBERED else member.replace("_", "0").isalnum()
                if is_member and (sort != CLEARANCE or "__" in member):
                    return sort, row, member
    return None


def shape_of(name: str) -> str:
    """The name with {} in place of its member: ``link.{}_velocity`` of ``link.3_velocity``; the name itself where it has none."""
    match = None if name in QUANTITIES else _match(name)
    return name if match is None else match[1].name


def member_of(name: str) -> str:
    """Link, point, pair or body in the name of a quantity; empty where it has none."""
    match = None if name in QUANTITIES else _match(name)
    return "" if match is None else match[2]


@lru_cache(maxsize=1024)
def quantity(name: str) -> Quantity:
    """Row of a quantity by its name, with the member of a linkage filled in. Raises KeyError."""
    if name in QUANTITIES:
        return QUANTITIES[name]
    if (match := _match(name)) is None:
        raise KeyError(name)
    sort, row, member = match
    words = re.sub(r"(?<=[a-z])(?=\d)", " ", member).replace("_", " ") if sort in _WORDED else member
    words = _pair_words(member) if sort == CLEARANCE else words
    return replace(
        row,
        name=name,
        slug=row.slug.format(member),
        label=row.label.format(words),
        symbol=row.symbol.format(member),
        value=partial(_member_value, row, member) if member else row.value,
    )


def _pair_words(member: str) -> str:
    """Names of two bodies in words: ``link 3 and frame``."""
    return " and ".join(name.replace("_", " ") for name in member.split("__"))


def _member_value(row: Quantity, member: str, study: Study) -> np.ndarray:
    return row.value(study, member)


@lru_cache(maxsize=1)
def _slugs() -> tuple[tuple[re.Pattern[str], str], ...]:
    def pattern(slug: str) -> re.Pattern[str]:
        if slug == DISTANCE:
            return re.compile(r"(\w+__\w+)_mm")
        return re.compile(re.escape(slug).replace(r"\{\}", r"(\w+)").replace(r"\{m\}", "(?:mm|deg)"))

    rows = (*_ROWS, *chain.from_iterable(OF_MEMBERS.values()))
    return tuple((pattern(row.slug), row.label) for row in rows if row.slug)


def label_of(column: str) -> str:
    """Label of a column, the same in every design; empty where no design has the column."""
    matches = ((pattern.fullmatch(column), label) for pattern, label in _slugs())
    found = next(((match.groups(), label) for match, label in matches if match), None)
    if found is None:
        return ""
    groups, label = found
    return label.format(*(map(_pair_words, groups) if label == OF_MEMBERS[CLEARANCE][0].label else groups))


# -- quantities of a study and of a design -----------------------------------------------------------------------------


def quantities_of(study: Study, stage: str | None = None) -> Mapping[str, Quantity]:
    """Quantities of a study, of one stage or of all."""
    rows = dict(_rows_of(names_of(study.design), stage))
    if stage in (None, "linkage") and study.mechanism.ranged:
        for link, turning in study.driver_ranges.angles.items():
            name = f"link.{link}"
            if turning.rotates and name in rows:
                rows[name] = replace(rows[name], is_periodic=True)
    return rows


@lru_cache(maxsize=64)
def _rows_of(names: tuple[str, ...], stage: str | None) -> Mapping[str, Quantity]:
    rows = {name: quantity(name) for name in names}
    return {name: row for name, row in rows.items() if stage in (None, row.stage)}


@lru_cache(maxsize=64)
def names_of(design: Design) -> tuple[str, ...]:
    """Names of all quantities of a design, in the order of stages and tables."""
    kind = design.drive.kind
    needs = tuple([need for need in _needs_of(kind) if NEEDS[need].is_met(design)])
    return _names(kind, needs, tuple(members(design)))


@lru_cache(maxsize=64)
def _names(kind: str, needs: tuple[str, ...], members: tuple[tuple[str, str], ...]) -> tuple[str, ...]:
    """Names of all quantities of the designs of a kind that meet these needs and have these members, whatever their numbers."""
    rows = [(row.stage, row.name) for row in _ROWS if kind in row.kinds and row.needs in needs]
    rows += [(row.stage, row.name.format(member)) for sort, member in members for row in OF_MEMBERS[sort]]
    return tuple(name for stage in TABLES for row_stage, name in rows if row_stage == stage)


@lru_cache(maxsize=64)
def _needs_of(kind: str) -> tuple[str, ...]:
    """Rows of ``NEEDS`` that the quantities of a kind of design have."""
    return tuple(dict.fromkeys(row.needs for row in _ROWS if kind in row.kinds))


def why_absent(design: Design, slug: str) -> str:
    """Which designs have a column that this one lacks, after a semicolon; empty for a column that no design has."""
    rows = [row for row in _ROWS if slug in (row.slug.format(m="mm"), row.slug.format(m="deg"))]
    if not rows and "__" in slug:
        return "; designs with [[outlines]] of both bodies have it"
    if not rows:
        return "; designs of the kind linkage have it" if label_of(slug) and not design.drive.links else ""
    kind, units = design.drive.kind, {unit for unit in ("mm", "deg") if slug == rows[0].slug.format(m=unit)}
    fitting = [row for row in rows if kind in row.kinds]
    if not fitting:
        return f"; designs of the kind {' | '.join(sorted({kind for row in rows for kind in row.kinds}))} have it"
    needs = " or ".join(dict.fromkeys(NEEDS[row.needs].words for row in fitting if not NEEDS[row.needs].is_met(design)))
    if needs:
        return f"; designs with {needs} have it"
    if design.drive.motion_unit not in units:
        return f"; designs whose motion is in {' or '.join(units)} have it"
    return "; it does not exist in this design, as its findings say"
