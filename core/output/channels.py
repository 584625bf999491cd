"""What can be plotted, tabled and exported, one row each: column name, unit, equation, source.

The quantity itself stands in ``core.study.quantities``; here is what a reader of it needs to know.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from core.design import Design, Unit, split_unit
from core.frozen import frozen
from core.study import QUANTITIES, Study, names_of, quantity

PROFILE, KINEMATICS, DYNAMICS = "profile.csv", "kinematics.csv", "dynamics.csv"
LINKAGE, ORBIT = "linkage.csv", "orbit.csv"
ANGLES: Mapping[str, str] = MappingProxyType(
    {PROFILE: "cam_angle_deg", KINEMATICS: "cam_angle_deg", ORBIT: "input_angle_deg"}
)
"""First column of the tables whose angle is one and the same in every kind of design: the cam's, or that of a flexible shaft's input."""


@frozen
class Channel:
    """One row.

    slug       column name; its ending tells the unit
    quantity   row of ``QUANTITIES``
    label, symbol
    family     what sets its colour: displacement, velocity, speed, acceleration, jerk, pressure-angle, curvature,
               force, torque, stress, angle, length
    table      CSV file it stands in
    equation   formula, with its source
    beside     quantity that it is an approximation of, to be compared with: drawn dashed
    """

    slug: str
    quantity: str
    label: str
    symbol: str
    family: str
    table: str
    equation: str
    source: str
    beside: str = ""

    @property
    def unit(self) -> Unit:
        return split_unit(self.slug)[1]

    @property
    def stage(self) -> str:
        return quantity(self.quantity).stage

    def values(self, study: Study) -> np.ndarray:
        """The channel in its own unit (n,)."""
        return quantity(self.quantity).value(study) / self.unit.factor + 0.0  # no minus zero in tables


# slug, quantity, label, symbol, family, equation, source: of the first roller or face, and of the second roller
_CONTACT = (
    ("contact_pressure_mpa", "contact_pressure", "Contact pressure", "p", "stress", "√(F_c E* κ_rel/(π b))", "Hertz, line contact"),
    ("subsurface_shear_mpa", "subsurface_shear", "Subsurface shear", "τ", "stress", "0.300283 p", "Hertz, line contact"),
    ("subsurface_shear_depth_mm", "subsurface_shear_depth", "Depth of the largest shear", "z_τ", "length", "0.786151 a",
     "Hertz, line contact"),
    ("contact_half_width_mm", "contact_half_width", "Half width of the contact", "a", "length", "2p/(E* κ_rel)", "Hertz, line contact"),
    ("roller_speed_rpm", "roller_speed", "Roller's own speed", "n_r", "speed", "ω(d - α' ∓ d|t|/Rr)", "rolling without slip"),
)  # fmt: skip

# {m} is the unit of the motion: mm where the output slides, deg where it swings
_ROWS = (
    Channel("displacement_{m}", "displacement", "Displacement", "y", "displacement", KINEMATICS, "law of the segment",
            "Shin1995 (8)"),
    Channel("velocity_{m}_s", "velocity", "Velocity", "ẏ", "velocity", KINEMATICS, "ω y'", "law of the segment"),
    Channel("acceleration_{m}_s2", "acceleration", "Acceleration", "ÿ", "acceleration", KINEMATICS, "ω² y''",
            "law of the segment"),
    Channel("jerk_{m}_s3", "jerk", "Jerk", "y⃛", "jerk", KINEMATICS, "ω³ y'''", "law of the segment"),
    Channel("slider_position_mm", "slider_position", "Slider position", "L", "displacement", KINEMATICS, "L0 + y",
            "Shin1995 (8)"),
    Channel("phi_deg", "phi", "Arm angle", "φ", "angle", KINEMATICS, "triangle r, L1, L2", "Shin1995 (9), by the triangle's area"),
    Channel("phi_rad_s", "phi_velocity", "Arm velocity", "φ̇", "velocity", KINEMATICS, "L̇ cos β/(L1 sin(β-φ))",
            "Shin1995 (12)"),
    Channel("phi_rad_s2", "phi_acceleration", "Arm acceleration", "φ̈", "acceleration", KINEMATICS,
            "(L̈ cos β + L1 φ̇² cos(φ-β) + L2 β̇²)/(L1 sin(β-φ))", "Shin1995 (14)"),
    Channel("beta_deg", "beta", "Rod angle", "β", "angle", KINEMATICS, "triangle r, L1, L2", "Shin1995 (10), by the triangle's area"),
    Channel("beta_rad_s", "beta_velocity", "Rod velocity", "β̇", "velocity", KINEMATICS, "L̇ cos φ/(L2 sin(φ-β))",
            "Shin1995 (11)"),
    Channel("beta_rad_s2", "beta_acceleration", "Rod acceleration", "β̈", "acceleration", KINEMATICS,
            "(L̈ cos φ + L2 β̇² cos(φ-β) + L1 φ̇²)/(L2 sin(φ-β))", "Shin1995 (13)"),
    Channel("x_mm", "profile_x", "Profile x", "x", "length", PROFILE, "(R + Rr n) e^{-idθ}", "Shin1995 (20), for any pose"),
    Channel("y_mm", "profile_y", "Profile y", "y", "length", PROFILE, "(R + Rr n) e^{-idθ}", "Shin1995 (20), for any pose"),
    Channel("pitch_x_mm", "pitch_x", "Pitch curve x", "x_p", "length", PROFILE, "R e^{-idθ}", "Shin1995 §3"),
    Channel("pitch_y_mm", "pitch_y", "Pitch curve y", "y_p", "length", PROFILE, "R e^{-idθ}", "Shin1995 §3"),
    Channel("pressure_angle_deg", "pressure_angle", "Pressure angle", "ψ", "pressure-angle", PROFILE,
            "angle between normal n and travel of the roller centre", "Shin1995 (19), for any pose"),
    Channel("pitch_curvature_per_mm", "pitch_curvature", "Pitch curvature", "κ_p", "curvature", PROFILE,
            "-d Im(t̄ w)/|t|³", "curvature of a plane curve"),
    Channel("radius_mm", "radius", "Cam radius", "r", "length", PROFILE, "|R + Rr n|", "Shin1995 (20), for any pose"),
    Channel("polar_angle_deg", "polar_angle", "Polar angle", "ϑ", "angle", PROFILE, "arg((R + Rr n) e^{-idθ})",
            "Shin1995 (20), for any pose"),
    Channel("profile_curvature_per_mm", "profile_curvature", "Profile curvature", "κ", "curvature", PROFILE,
            "κ_p/(1 - Rr κ_p)", "parallel curve"),
    Channel("contact_on_face_mm", "contact_on_face", "Contact on the face", "x_f", "length", PROFILE, "h_ν - Im(m̄R)",
            "support function of the face"),
    Channel("outer_x_mm", "outer_x", "Outer flank x", "x_o", "length", PROFILE, "(R - (Rr + play) n) e^{-idθ}",
            "second envelope of the roller"),
    Channel("outer_y_mm", "outer_y", "Outer flank y", "y_o", "length", PROFILE, "(R - (Rr + play) n) e^{-idθ}",
            "second envelope of the roller"),
    Channel("outer_curvature_per_mm", "outer_curvature", "Outer flank's curvature", "κ_o", "curvature", PROFILE,
            "κ_p/(1 + (Rr + play) κ_p)", "parallel curve"),
    Channel("second_x_mm", "second_x", "Second profile x", "x₂", "length", PROFILE, "(R₂ + (Rr₂ + play) n₂) e^{-idθ}", "as the first"),
    Channel("second_y_mm", "second_y", "Second profile y", "y₂", "length", PROFILE, "(R₂ + (Rr₂ + play) n₂) e^{-idθ}", "as the first"),
    Channel("second_pitch_x_mm", "second_pitch_x", "Second pitch curve x", "x_p2", "length", PROFILE, "R₂ e^{-idθ}", "as the first"),
    Channel("second_pitch_y_mm", "second_pitch_y", "Second pitch curve y", "y_p2", "length", PROFILE, "R₂ e^{-idθ}", "as the first"),
    Channel("second_pressure_angle_deg", "second_pressure_angle", "Second pressure angle", "ψ₂", "pressure-angle", PROFILE,
            "angle between normal n₂ and travel of the second roller's centre", "as the first"),
    Channel("second_pitch_curvature_per_mm", "second_pitch_curvature", "Second pitch curvature", "κ_p2", "curvature", PROFILE,
            "-d Im(t̄₂ w₂)/|t₂|³", "as the first"),
    Channel("second_profile_curvature_per_mm", "second_profile_curvature", "Second profile's curvature", "κ₂", "curvature", PROFILE,
            "κ_p2/(1 - (Rr₂ + play) κ_p2)", "as the first"),
    Channel("contact_force_n", "contact_force", "Contact force", "F_c", "force", DYNAMICS,
            "moment or force balance of the follower", "Shin1995 (24), (26), corrected"),
    Channel("second_contact_force_n", "second_contact_force", "Second contact force", "F_c2", "force", DYNAMICS,
            "the same balance with R₂, n₂, where F_c would pull", "as the first"),
    Channel("drive_torque_nm", "drive_torque", "Cam torque", "T_c", "torque", DYNAMICS, "-d (R × F_c n)",
            "Shin1995 (27)"),
    Channel("motor_torque_nm", "motor_torque", "Motor torque with flywheel", "T_m", "torque", DYNAMICS,
            "T̄ + k(ω̄ - ω), d/dθ[½(I + J_e)ω²] = T_m - T_s", "Shin1995 Figs. 19, 20, not linearised"),
    Channel("guide_force_n", "guide_force", "Guide force", "N", "force", DYNAMICS, "N0/(1 + τ)",
            "Shin1995 (21), corrected"),
    Channel("slider_pin_x_n", "slider_pin_x", "Slider pin, x", "A_x", "force", DYNAMICS, "by rod on slider", "Shin1995 (21)"),
    Channel("slider_pin_y_n", "slider_pin_y", "Slider pin, y", "A_y", "force", DYNAMICS, "by rod on slider", "Shin1995 (21)"),
    Channel("arm_pin_x_n", "arm_pin_x", "Arm pin, x", "-B_x", "force", DYNAMICS, "by rod on arm", "Shin1995 (23), corrected"),
    Channel("arm_pin_y_n", "arm_pin_y", "Arm pin, y", "-B_y", "force", DYNAMICS, "by rod on arm", "Shin1995 (23), corrected"),
    Channel("pivot_x_n", "pivot_x", "Pivot, x", "P_x", "force", DYNAMICS, "by frame on arm", "balance of the arm"),
    Channel("pivot_y_n", "pivot_y", "Pivot, y", "P_y", "force", DYNAMICS, "by frame on arm", "balance of the arm"),
    Channel("bearing_x_n", "bearing_x", "Camshaft bearing, x", "O_x", "force", DYNAMICS, "by frame on camshaft", "-F_c n"),
    Channel("bearing_y_n", "bearing_y", "Camshaft bearing, y", "O_y", "force", DYNAMICS, "by frame on camshaft", "-F_c n"),
    Channel("speed_rpm", "camshaft_speed", "Camshaft speed", "n", "speed", DYNAMICS,
            "d/dθ[½(I + J_e)ω²] = T_m - T_s", "energy of the shaft"),
    Channel("slider_torque_nm", "follower_torque", "Slider torque", "T_L", "torque", DYNAMICS, "-F_c (r_R × n)",
            "Shin1995 (24), (25), corrected"),
    Channel("slider_pin_n", "slider_pin", "Slider pin", "|A|", "force", DYNAMICS, "√(A_x² + A_y²)", "Shin1995 (21)"),
    Channel("arm_pin_n", "arm_pin", "Arm pin", "|B|", "force", DYNAMICS, "√(B_x² + B_y²)", "Shin1995 (23), corrected"),
    Channel("pivot_n", "pivot", "Pivot", "|P|", "force", DYNAMICS, "√(P_x² + P_y²)", "balance of the arm"),
    Channel("bearing_n", "bearing", "Camshaft bearing", "|O|", "force", DYNAMICS, "|F_c|", "-F_c n"),
    Channel("guide_x_n", "guide_x", "Guide, x", "G_x", "force", DYNAMICS, "by frame on slider, friction included", "balance of the slider"),
    Channel("guide_y_n", "guide_y", "Guide, y", "G_y", "force", DYNAMICS, "by frame on slider, friction included", "balance of the slider"),
    Channel("guide_n", "guide", "Guide, with friction", "|G|", "force", DYNAMICS, "√(N² + (μN)²)", "balance of the slider"),
    Channel("guide_couple_nm", "guide_couple", "Couple on the guide", "M_G", "torque", DYNAMICS, "by frame on slider",
            "balance of the slider"),
    *(
        Channel(f"{name}_direction_deg", f"{name}_direction", f"{label}, direction", f"∠{symbol}", "angle", DYNAMICS,
                f"arg({symbol}_x + i {symbol}_y)", "of the force in the global frame")
        for name, label, symbol in (("slider_pin", "Slider pin", "A"), ("arm_pin", "Arm pin", "B"), ("pivot", "Pivot", "P"),
                                    ("bearing", "Camshaft bearing", "O"), ("guide", "Guide", "G"))
    ),
    Channel("jam_factor", "jam_factor", "Jamming factor", "μ|tan β|", "ratio", DYNAMICS,
            "μ|tan β|; jams from 1", "friction in closed form"),
    *(
        Channel(f"{key}{row[0]}", f"{key}{row[1]}", f"{name}{row[2] if not key else row[2].lower()}", f"{row[3]}{index}", row[4],
                DYNAMICS, row[5], row[6])
        for key, name, index in (("", "", ""), ("second_", "Second ", "₂"))
        for row in _CONTACT
    ),
    Channel("elastic_displacement_{m}", "elastic_displacement", "Elastic follower", "z", "displacement", DYNAMICS,
            "m z̈ + c ż + k(z - s) + k_s z = 0", "one mass on the follower's stiffness"),
    Channel("elastic_error_{m}", "elastic_error", "Elastic follower, error", "z - s", "displacement", DYNAMICS,
            "m z̈ + c ż + k(z - s) + k_s z = 0", "one mass on the follower's stiffness"),
    Channel("elastic_acceleration_{m}_s2", "elastic_acceleration", "Elastic follower, acceleration", "z̈", "acceleration", DYNAMICS,
            "m z̈ + c ż + k(z - s) + k_s z = 0", "one mass on the follower's stiffness"),
    Channel("elastic_contact_force_n", "elastic_contact_force", "Contact force, elastic follower", "F_c", "force", DYNAMICS,
            "F_c of the follower's own motion z", "one mass on the follower's stiffness"),
    Channel("linear_motor_torque_nm", "linear_motor_torque", "Motor torque, linear, Shin1995", "T_m", "torque", DYNAMICS,
            "T_n/(1 + i n I ω̄/k) by harmonic", "Shin1995 Figs. 19, 20", beside="motor_torque"),
    Channel("instant_centre_mm", "instant_centre", "Instant centre Q", "Q", "length", PROFILE,
            "Zxy φ'/(φ' - d) from the cam centre to the pivot; y' across a guide", "Shin1995 (18), φ' against the cam; Kennedy"),
    Channel("instant_centre_x_mm", "instant_centre_x", "Instant centre Q, x", "Q_x", "length", PROFILE,
            "where cam and follower move alike", "Kennedy"),
    Channel("instant_centre_y_mm", "instant_centre_y", "Instant centre Q, y", "Q_y", "length", PROFILE,
            "where cam and follower move alike", "Kennedy"),
    Channel("instant_centre_velocity_mm_s", "instant_centre_velocity", "Velocity of Q", "V_Q", "velocity", PROFILE, "Q θ̇",
            "Shin1995 (15)"),
    Channel("roller_centre_velocity_mm_s", "reference_velocity", "Velocity of the roller centre", "V_R", "velocity", PROFILE,
            "V_Q Zl/(Zxy - Q); V_Q on a guide", "Shin1995 (16), (17)"),
    Channel("wind_up_deg", "wind_up", "Wind-up of the shaft", "θ_i - θ_c", "angle", ORBIT, "2πβ, steady response",
            "Kim1990 (13), corrected"),
    Channel("follower_error_{m}", "follower_error", "Follower's error", "ΔX", "displacement", ORBIT, "X(θ_c) - X(θ_i)",
            "Kim1990 §1, steady response"),
    Channel("shaft_torque_nm", "shaft_torque", "Torque in the shaft", "T_s", "torque", ORBIT, "K_s (θ_i - θ_c)",
            "Kim1990 §1, steady response"),
)  # fmt: skip


_FLAT: Mapping[str, str] = MappingProxyType(
    {
        "profile_x": "m(h + i h_ν) e^{-idθ}",
        "profile_y": "m(h + i h_ν) e^{-idθ}",
        "pressure_angle": "angle between the face's normal m and travel of its point that touches",
        "radius": "|h + i h_ν|",
        "polar_angle": "arg(m(h + i h_ν) e^{-idθ})",
        "profile_curvature": "1/(h + h_νν)",
    }
)
"""Equations under a straight face: h its distance from the cam centre, ν the angle of its normal in the cam's frame."""


def _for_unit(row: Channel, unit: str) -> Channel:
    return replace(row, slug=row.slug.format(m=unit))


# -- linkages ---------------------------------------------------------------------------------------------

# quantity's name as a pattern -> slug, label, symbol, family, equation, source; {} is the link, point, joint or pair
_BY_NAME: tuple[tuple[str, str, str, str, str, str, str], ...] = (
    (r"link\.(\d+)", "link{}_deg", "Link {}", "θ{}", "angle", "triangles of the dyads", "Velocity, closed loops"),
    (r"link\.(\d+)_velocity", "link{}_rad_s", "Link {}, velocity", "ω{}", "velocity", "ω_d θ'", "Velocity 6.4"),
    (r"link\.(\d+)_acceleration", "link{}_rad_s2", "Link {}, acceleration", "α{}", "acceleration", "ω_d² θ''",
     "loop equations"),
    (r"slide\.(\d+)", "link{}_slide_mm", "Slide of link {}", "s{}", "displacement", "along the line", "loop equations"),
    (r"slide\.(\d+)_velocity", "link{}_slide_mm_s", "Slide of link {}, velocity", "ṡ{}", "velocity", "ω_d s'",
     "Velocity 6.4"),
    (r"slide\.(\d+)_acceleration", "link{}_slide_mm_s2", "Slide of link {}, acceleration", "s̈{}", "acceleration", "ω_d² s''",
     "loop equations"),
    (r"point\.(\w+)_x", "{}_x_mm", "{}, x", "x_{}", "length", "pose of its link", "closed loops"),
    (r"point\.(\w+)_y", "{}_y_mm", "{}, y", "y_{}", "length", "pose of its link", "closed loops"),
    (r"point\.(\w+)_vx", "{}_vx_mm_s", "{}, velocity x", "ẋ_{}", "velocity", "V_A + V_PA", "Velocity 6.1"),
    (r"point\.(\w+)_vy", "{}_vy_mm_s", "{}, velocity y", "ẏ_{}", "velocity", "V_A + V_PA", "Velocity 6.1"),
    (r"point\.(\w+)_ax", "{}_ax_mm_s2", "{}, acceleration x", "ẍ_{}", "acceleration", "loop equations", "loop equations"),
    (r"point\.(\w+)_ay", "{}_ay_mm_s2", "{}, acceleration y", "ÿ_{}", "acceleration", "loop equations", "loop equations"),
    (r"point\.(\w+)_speed", "{}_speed_mm_s", "{}, speed", "|V_{}|", "velocity", "√(ẋ² + ẏ²)", "Velocity 6.1"),
    (r"transmission\.(\w+)", "transmission_{}_deg", "Transmission angle at {}", "μ_{}", "pressure-angle",
     "arcsin(|c1 × c2|/(|c1||c2|))", "angle between the links at the joint"),
    (r"force\.(\d+)_x", "link{}_guide_x_n", "Guide of link {}, x", "F_{}x", "force", "dyad by dyad", "balance of the links"),
    (r"force\.(\d+)_y", "link{}_guide_y_n", "Guide of link {}, y", "F_{}y", "force", "dyad by dyad", "balance of the links"),
    (r"force\.(\d+)_size", "link{}_guide_n", "Guide of link {}", "|F_{}|", "force", "√(F_x² + F_y²)", "balance of the links"),
    (r"force\.(\d+)_direction", "link{}_guide_direction_deg", "Guide of link {}, direction", "∠F_{}", "angle", "arg(F_x + i F_y)",
     "of the force in the global frame"),
    (r"force\.(\w+)_direction", "{}_direction_deg", "Force at {}, direction", "∠F_{}", "angle", "arg(F_x + i F_y)",
     "of the force in the global frame"),
    (r"force\.(\w+)_x", "{}_x_n", "Force at {}, x", "F_{}x", "force", "dyad by dyad", "balance of the links"),
    (r"force\.(\w+)_y", "{}_y_n", "Force at {}, y", "F_{}y", "force", "dyad by dyad", "balance of the links"),
    (r"force\.(\w+)_size", "{}_n", "Force at {}", "|F_{}|", "force", "√(F_x² + F_y²)", "balance of the links"),
    (r"couple\.(\w+)", "link{}_couple_nm", "Couple on the guide of link {}", "M_{}", "torque", "dyad by dyad",
     "balance of the links"),
    ("kinetic_energy", "kinetic_energy_j", "Kinetic energy", "E", "energy", "Σ ½m v² + ½I α̇²", "balance of energy"),
    (r"kinetic_energy\.(\w+)", "{}_kinetic_energy_j", "Kinetic energy of {}", "E {}", "energy", "½m v² + ½I α̇²", "balance of energy"),
    (r"power\.load", "load_power_w", "Power of spring and external force", "P", "power", "F ẏ", "balance of energy"),
    (r"power\.drive", "drive_power_w", "Power of the drive", "P_d", "power", "T ω", "balance of energy"),
    (r"power\.gravity", "gravity_power_w", "Power of gravity", "P_g", "power", "Σ m g·v", "balance of energy"),
    (r"power\.friction_(\w+)", "friction_{}_power_w", "Power of friction at {}", "P_μ {}", "power", "-μ|N||v|", "balance of energy"),
    (r"power\.(\w+)", "{}_power_w", "Power of {}", "P {}", "power", "F·v", "balance of energy"),
    ("driver_torque", "driver_torque_nm", "Driver torque", "T", "torque", "-Σ(F - ma)·∂r/∂q", "virtual power"),
    ("driver_force", "driver_force_n", "Driver force", "F_d", "force", "-Σ(F - ma)·∂r/∂q", "virtual power"),
)  # fmt: skip
_TABLES: Mapping[str, str] = MappingProxyType(
    {"motion": KINEMATICS, "linkage": LINKAGE, "cam": PROFILE, "dynamics": DYNAMICS}
)


@lru_cache(maxsize=1024)
def _linkage_row(name: str) -> Channel:
    for pattern, slug, label, symbol, family, equation, source in _BY_NAME:
        match = re.fullmatch(pattern, name)
        if match:
            of = match[1] or "" if match.groups() else ""
            words = (
                re.sub(r"(?<=[a-z])(?=\d)", " ", of).replace("_", " ") if name.startswith(("power", "kinetic")) else of
            )
            table = _TABLES[quantity(name).stage]
            return Channel(
                slug.format(of), name, label.format(words), symbol.format(of), family, table, equation, source
            )
    raise KeyError(name)


_SLUGS = tuple(
    (re.compile(re.escape(slug).replace(r"\{m\}", "(?:mm|deg)").replace(r"\{\}", r"(\w+)")), label)
    for slug, label in (*((row.slug, row.label) for row in _ROWS), *((row[1], row[2]) for row in _BY_NAME))
)


def label_of(column: str) -> str:
    """A column in words, as any design that has it calls it; empty for what no design has."""
    matches = ((pattern.fullmatch(column), label) for pattern, label in _SLUGS)
    return next((label.format(*match.groups()) for match, label in matches if match), "")


_SHARED: Mapping[str, Channel] = MappingProxyType({row.quantity: row for row in _ROWS})
_ORDER: Mapping[str, int] = MappingProxyType({name: place for place, name in enumerate(_SHARED)})


def _rows_of(design: Design) -> tuple[Channel, ...]:
    """A row for each quantity of this very design that a reader can see, in the order of the tables: first those that any
    design may have, then those of its links."""
    return _rows_named(design.drive.motion_unit, names_of(design))


@lru_cache(maxsize=64)  # an edit of a length changes no name
def _rows_named(unit: str, names: tuple[str, ...]) -> tuple[Channel, ...]:
    shared = sorted((name for name in names if name in _ORDER), key=_ORDER.__getitem__)
    own = [name for name in names if name not in QUANTITIES]
    rows = (_for_unit(_SHARED[name], unit) for name in shared)
    if "contact_on_face" in names:
        rows = (replace(row, equation=_FLAT.get(row.quantity, row.equation), source=_source(row)) for row in rows)
    return (*rows, *(_linkage_row(name) for name in own))


def _source(row: Channel) -> str:
    return "support function of the face" if row.quantity in _FLAT else row.source


def channels(design: Design, stages: Iterable[str] = ()) -> tuple[Channel, ...]:
    """The rows of this design, of the named stages or of all."""
    rows, wanted = _rows_of(design), tuple(stages)
    return tuple(row for row in rows if not wanted or row.stage in wanted)


def channel(design: Design, slug: str) -> Channel:
    """One row of a design by its slug. Raises KeyError."""
    rows = _rows_of(design)
    for row in rows:
        if row.slug == slug:
            return row
    raise KeyError(f"{slug}: no such channel; allowed: {', '.join(row.slug for row in rows)}")


def existing(study: Study, rows: Iterable[Channel]) -> list[Channel]:
    """Those rows that this very design has."""
    return [row for row in rows if quantity(row.quantity).exists(study)]
