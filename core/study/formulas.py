"""Formulas of quantities, figures and residuals, one row each; here those of motion, linkage and cam.

A row says what the report prints, what its symbols are, where it is from, how it is evaluated, and which function computes it. Where a
paper is marked corrected, its printed equation is wrong and this one is computed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from core.study.force_formulas import FORCE_FORMULAS, has
from core.study.spatial_symbols import SPATIAL_FORMULAS
from core.study.study import FLAT
from core.study.symbols import Formula

_TRIANGLE = "Shin1995 (9), (10), by the triangle's area"
_LAW, _SHIN8 = "definition of a motion law", "Shin1995 (8)"
_CENTRE = "Shin1995 (18), φ′ against the cam; Kennedy"
_POSE, _FACE, _PARALLEL = "Shin1995 (20), for any pose", "support function of the face", "parallel curve"
_VALUES, _CAM = "study.member_quantities", "cam.shape"
_COORDINATE, _ARM_AND_ROD = f"{_VALUES}.coordinate", "followers.cam_slider.cam_slider"


def _rotated(axis: str, x: str, y: str) -> str:
    """A coordinate in the frame of the cam, of a point (x, y) of the global frame."""
    return f"({x}) cos(d θ) + ({y}) sin(d θ)" if axis == "x" else f"({y}) cos(d θ) - ({x}) sin(d θ)"


_MOTION: tuple[Formula, ...] = (
    Formula("displacement", "Displacement over a segment", ("y = y_0 + h s(u)", "u = (θ - θ_0)/β"),
            "y y_0 h.rise s.law u.law θ θ_0 β.span", _LAW, f"{_VALUES}.motion_by_time"),
    Formula("velocity", "Velocity, acceleration, jerk", ("ẏ = ω y′",), "ẏ ω y′", "constant speed ω", f"{_VALUES}.motion_by_time",
            remark="′ is d/dθ; derivatives in closed form, segment by segment"),
    Formula("acceleration", "Velocity, acceleration, jerk", ("ÿ = ω² y″",), "ÿ ω y″", "constant speed ω", f"{_VALUES}.motion_by_time"),
    Formula("jerk", "Velocity, acceleration, jerk", ("y⃛ = ω³ y‴",), "y⃛ ω y‴", "constant speed ω", f"{_VALUES}.motion_by_time"),
    Formula("position_modulo", "Position modulo the advance", ("m = y - k a",), "m.modulo y k.advance a.advance",
            "advance of the motion", f"{_VALUES}.position_modulo"),
    Formula("slider_position", "Slider position", ("L = L_0 + y",), "L L_0 y", _SHIN8, _ARM_AND_ROD),
    Formula("phi", "Triangle of arm and rod",
            ("φ = atan2(H, L) + σ atan2(K, r² + (L₁ - L₂)(L₁ + L₂))",
             "K = √((A + (B + C))(C - (A - B))(C + (A - B))(A + (B - C)))"),
            "φ H L σ K.triangle r.triangle L₁ L₂ A.side B.side C.side", _TRIANGLE,
            _ARM_AND_ROD, working="φ = atan2(H, L) + σ arccos((r² + L₁² - L₂²)/(2 r L₁))",
            values="H L σ r.triangle L₁ L₂"),
    Formula("beta", "Triangle of arm and rod",
            ("β = atan2(H, L) - σ atan2(K, r² - (L₁ - L₂)(L₁ + L₂))",
             "K = √((A + (B + C))(C - (A - B))(C + (A - B))(A + (B - C)))"),
            "β H L σ K.triangle r.triangle L₁ L₂ A.side B.side C.side", _TRIANGLE,
            _ARM_AND_ROD, working="β = atan2(H, L) - σ arccos((r² + L₂² - L₁²)/(2 r L₂))",
            values="H L σ r.triangle L₁ L₂"),
    Formula("phi_velocity", "Velocities of arm and rod", ("φ̇ = L̇ cos β/(L₁ sin(β - φ))",), "φ̇ L̇ β φ L₁", "Shin1995 (11), (12)",
            _ARM_AND_ROD),
    Formula("beta_velocity", "Velocities of arm and rod", ("β̇ = L̇ cos φ/(L₂ sin(φ - β))",), "β̇ L̇ β φ L₂", "Shin1995 (11), (12)",
            _ARM_AND_ROD),
    Formula("phi_acceleration", "Accelerations of arm and rod",
            ("φ̈ = (L̈ cos β + L₁ φ̇² cos(φ - β) + L₂ β̇²)/(L₁ sin(β - φ))",), "φ̈ L̈ β φ L₁ L₂ φ̇ β̇", "Shin1995 (13), (14)", _ARM_AND_ROD),
    Formula("beta_acceleration", "Accelerations of arm and rod",
            ("β̈ = (L̈ cos φ + L₂ β̇² cos(φ - β) + L₁ φ̇²)/(L₂ sin(φ - β))",), "β̈ L̈ β φ L₁ L₂ φ̇ β̇", "Shin1995 (13), (14)", _ARM_AND_ROD),
)  # fmt: skip

_TRAINS: tuple[Formula, ...] = (
    Formula("valve_lift", "Valve lift", ("y_v = max(y_o - λ, 0)",), "y_v y_o λ.lash", "lash λ at the valve's tip", f"{_VALUES}.valve_lift"),
    Formula("valve_velocity", "Valve lift", ("ẏ_v = ω y′_v",), "ẏ_v ω y′_v", "constant speed ω", f"{_VALUES}.valve_lift"),
    Formula("valve_acceleration", "Valve lift", ("ÿ_v = ω² y″_v",), "ÿ_v ω y″_v", "constant speed ω", f"{_VALUES}.valve_lift"),
    Formula("piston_clearance", "Valve and piston",
            ("c = c_0 + x_p - y_p", "x = √((R + l)² - e²) - R cos θ - √(l² - (R sin θ - e)²)"),
            "c.piston c_0.piston x_p y_p x.piston R.throw l.rod e.pin θ.throw", "Heywood, ch. 2, with the pin offset",
            "study.piston.piston_clearance", values="c_0.piston x_p y_p",
            remark="flat crown: x_p = x, y_p = y_v cos ν; pocket parallel to the head: x_p = x cos ν, y_p = y_v"),
    Formula("valve_spring_force", "Valve spring", ("F_s = F_0 + k y_v + F_w", "F_w = Σ k c_n (z_n/tan z_n - 1) e^(i n θ)",
                                                   "z_n = π (n ω/ω_1) √(1 - 2 i ζ ω_1/(n ω))"),
            "F_s F_0.valve k.valve y_v.spring F_w c_n z_n ω_1 ζ.surge ω θ n.harmonic", "Marti, NACA TM 818; wave in the spring",
            "study.valve_springs.valve_spring_force", values="F_0.valve k.valve y_v.spring F_w",
            remark="c_n: harmonics of the lift, the first 100"),
    Formula("valve_spring_stress", "Valve spring", ("τ_s = K 8 F D/(π d³)", "K = (4 C + 2)/(4 C - 3)", "C = D/d"),
            "τ_s K.coil F.spring D.coil d.wire C.coil", "Shigley, ch. 10, Bergsträsser", "study.valve_springs.valve_spring_stress",
            values="K.coil F.spring D.coil d.wire"),
    Formula("rocker_ratio", "Rocker", ("i = h/l",), "i.ratio h.pad l.arm", "levers of the rocker", f"{_VALUES}.rocker_ratio"),
    Formula("pad_position", "Rocker", ("x_t = p (sin β - sin β_0)",), "x_t p.pad β.pad β_0.pad", "a round pad on a flat tip",
            "followers.trains.rocker", remark="to the left of the direction in which the valve opens, from the place on the closed valve"),
)  # fmt: skip

_LINKAGE: tuple[Formula, ...] = (
    Formula("link.{}", "Angles of the links", ("Σ r_k e^(i θ_k) = 0",), "r_k θ_k", "closed loops, dyad by dyad", _COORDINATE,
            remark="each dyad is a triangle of known sides"),
    Formula("slide.{}", "Angles of the links", ("Σ r_k e^(i θ_k) = 0",), "r_k θ_k", "closed loops, dyad by dyad", _COORDINATE,
            working="s = s_0", values="s_0"),
    Formula("driver_angle", "Angle of the crank", ("φ = φ_0 + r (θ - θ_0)",), "φ.driver φ_0 r.cycle θ.cycle θ_0.cycle",
            "ends of the drawn circuit, ratios", "mechanism.drivers.CrankMotion.state"),
    Formula("link.{}_velocity", "Velocities of links and slides", ("θ̇ = ω θ′",), "θ̇ ω θ′", "Velocity 6.4", _COORDINATE),
    Formula("slide.{}_velocity", "Velocities of links and slides", ("ṡ = ω s′",), "ṡ ω s′", "Velocity 6.4", _COORDINATE),
    Formula("link.{}_acceleration", "Accelerations of links and slides", ("θ̈ = ω² θ″",), "θ̈ ω θ″", "loop equations", _COORDINATE),
    Formula("slide.{}_acceleration", "Accelerations of links and slides", ("s̈ = ω² s″",), "s̈ ω s″", "loop equations", _COORDINATE),
    *(Formula(f"point.{{}}_{axis}", "Points of the links", ("r_P = o + (a + i b) e^(i θ)",), "r_P o a.point b.point θ.link",
              "closed loops", f"{_VALUES}.point_component", working=line, values=f"o_{axis} a.point b.point θ.link")
      for axis, line in (("x", "x = o_x + a cos θ - b sin θ"), ("y", "y = o_y + a sin θ + b cos θ"))),
    *(Formula(f"point.{{}}_v{axis}", "Velocities of points", ("V_P = V_A + V_PA", "V_PA = i ω_k (r_P - r_A)"),
              "V_P V_A V_PA ω_k r_P r_A", "Velocity 6.1", f"{_VALUES}.point_component", working=line, values=keys,
              remark="A and P on one link k")
      for axis, line, keys in (("x", "ẋ = ω x′", "ω x′"), ("y", "ẏ = ω y′", "ω y′.point"))),
    Formula("point.{}_speed", "Velocities of points", ("V = √(ẋ² + ẏ²)",), "V.point ẋ ẏ.point", "Velocity 6.1",
            f"{_VALUES}.point_component"),
    *(Formula(f"point.{{}}_a{axis}", "Accelerations of points", ("a_P = a_A + (i α_k - ω_k²)(r_P - r_A)",),
              "a_P a_A α_k ω_k r_P r_A", "loop equations", f"{_VALUES}.point_component", working=line, values=keys)
      for axis, line, keys in (("x", "ẍ = ω² x″", "ω x″"), ("y", "ÿ = ω² y″", "ω y″.point"))),
    Formula("transmission.{}", "Transmission angle", ("μ = atan2(|c₁ × c₂|, |c₁ · c₂|)",), "μ.transmission c₁ c₂",
            "angle between the links at the joint", f"{_VALUES}.transmission_angle", working="μ = atan2(s, c)", values="s.sine c.cosine"),
    Formula("{}_mm", "Clearance of two bodies", ("d = min |q - p|",), "d.clearance p.outline q.outline",
            "points p and q of both outlines", "study.clearances.Clearances.of_member", working="d = √((q_x - p_x)² + (q_y - p_y)²)",
            values="p_x q_x p_y q_y", remark="0 where the bodies meet"),
)  # fmt: skip


def _places(
    symbol: str, name: str, title: str, line: str, letters: str, offset: str, keys: str, **more: str
) -> Iterator[Formula]:
    """Rows of both coordinates of a point of a profile or pitch curve: (R + offset n) e^(-i d θ)."""
    index = "2" if "second" in name else ""
    for axis in "xy":
        parts = (f"R_{index}{part}" + (f" + {offset} n_{index}{part}" if offset else "") for part in "xy")
        first = symbol.format(axis)
        normal = f"n_{index}x n_{index}y" if offset else ""
        yield Formula(
            f"{name}_{axis}", title, (line,), letters, more.get("source", _POSE), more.get("function", f"{_CAM}.round_envelope"),
            working=f"{first} = {_rotated(axis, *parts)}", values=f"R_{index}x R_{index}y {keys} d θ {normal}".replace("  ", " ").strip(),
        )  # fmt: skip


_CAM_ROWS: tuple[Formula, ...] = (
    Formula("loop_closure.arm", "Roller centre on its arm", ("R = P + Z_l e^(iα)", "R′ = i α′ (R - P)"), "R P Z_l α R′ α′",
            "Shin1995 §3", "followers.direct.oscillating", has("follower_torque", "pitch_x")),
    Formula("loop_closure.guide", "Roller centre on its guide", ("R = e(S + iε)", "S = √((R_b + R_r)² - ε²) + y"),
            "R e.guide S ε R_b R_r y", "geometry of the guide", "followers.direct.translating",
            has("guide_force", "pitch_x", without="phi")),
    Formula("tangency", "Normal of the cam", ("n = -i d t/|t|", "t = R′ - i d R"), "n d t R′ R", "Shin1995 (19), for any pose",
            f"{_CAM}.envelope", has("pitch_x"), remark="n points into the cam"),
    *_places("{}_p", "pitch", "Pitch curve", "c = R e^(-i d θ)", "c R d θ", "", "", source="Shin1995 §3"),
    *_places("{}", "profile", "Profile", "p = (R + R_r n) e^(-i d θ)", "p.profile R R_r n d θ", "R_r", "R_r"),
    *(Formula(f"profile_{axis}{FLAT}", "Profile under a straight face", ("p = m(h + i h_ν) e^(-i d θ)",),
              "p.profile m h.support h_ν d θ", _FACE, "cam.faces.envelope",
              working=f"{axis} = {_rotated(axis, 'm_x h - m_y h_ν', 'm_y h + m_x h_ν')}", values="m_x m_y h.support h_ν d θ")
      for axis in "xy"),
    Formula("radius", "Profile in polar coordinates", ("r = |p|",), "r p.profile", "polar coordinates of the profile",
            f"{_VALUES}.profile_radius", working="r = √(x² + y²)", values="x.profile y.profile"),
    Formula("polar_angle", "Profile in polar coordinates", ("ϑ = arg(p)",), "ϑ p.profile", "polar coordinates of the profile",
            f"{_VALUES}.polar_angle", working="ϑ = atan2(y, x) + 2 π k", values="y.profile x.profile k.turn"),
    Formula("contact_on_face", "Profile under a straight face", ("x_f = h_ν - m × R",), "x_f h_ν m R", _FACE, "cam.faces.envelope",
            working="x_f = h_ν - (m_x R_y - m_y R_x)", values="h_ν m_x m_y R_x R_y"),
    Formula("instant_centre", "Instant centre of cam and follower", ("Q = e · q", "q = -i (R′ - i φ′ R)/(d - φ′)"),
            "Q e.centres q.centre R′ φ′ R d", _CENTRE, f"{_VALUES}.centre_distance",
            working="Q = (e_x (R′_y - φ′ R_x) - e_y (R′_x + φ′ R_y))/(d - φ′)",
            values="R_x R_y R′_x R′_y φ′ d e_x.centres e_y.centres", remark="the normal passes through it"),
    *(Formula(f"instant_centre_{axis}", "Instant centre of cam and follower", ("q = -i (R′ - i φ′ R)/(d - φ′)",),
              "q.centre R′ φ′ R d", _CENTRE, "instant_centres.cam_follower_centre", working=line, values=keys)
      for axis, line, keys in (("x", "Q_x = (R′_y - φ′ R_x)/(d - φ′)", "R_x R′_y φ′ d"),
                               ("y", "Q_y = -(R′_x + φ′ R_y)/(d - φ′)", "R_y R′_x φ′ d"))),
    Formula("instant_centre_velocity", "Velocities at the cam", ("V_Q = ω Q",), "V_Q ω Q.velocity", "Shin1995 (15)-(17), for any pose",
            f"{_VALUES}.centre_velocity"),
    Formula("reference_velocity", "Velocities at the cam", ("V_R = σ ω |R′|",), "V_R σ.centre ω R′", "Shin1995 (15)-(17), for any pose",
            f"{_VALUES}.reference_velocity", working="V_R = σ ω √(R′_x² + R′_y²)", values="σ.centre ω R′_x R′_y"),
    Formula("pressure_angle", "Pressure angle", ("tan ψ = |n × v|/|n · v|",), "ψ n v", "Shin1995 (19), for any pose",
            f"{_CAM}.round_envelope", working="ψ = atan2(|n_x v_y - n_y v_x|, |n_x v_x + n_y v_y|)", values="n_x n_y v_x v_y"),
    Formula(f"pressure_angle{FLAT}", "Pressure angle of a straight face", ("tan ψ = |m × v|/|m · v|",), "ψ m v",
            "definition of the pressure angle", "cam.faces.envelope",
            working="ψ = atan2(|m_x v_y - m_y v_x|, |m_x v_x + m_y v_y|)", values="m_x m_y v_x v_y"),
    Formula("pitch_curvature", "Curvature of the pitch curve", ("κ_p = -d (t × w)/|t|³", "w = R″ - 2 i d R′ - R"),
            "κ_p d t w R″ R′ R", "curvature of a plane curve", f"{_CAM}.curvature",
            working="κ_p = -d (t_x w_y - t_y w_x)/(t_x² + t_y²)^(3/2)", values="d t_x t_y w_x w_y", remark="positive where convex"),
    Formula("profile_curvature", "Curvature of the profile", ("κ = κ_p/(1 - R_r κ_p)",), "κ κ_p R_r", _PARALLEL,
            f"{_CAM}.round_envelope", remark="undercut where R_r κ_p ≥ 1"),
    Formula(f"profile_curvature{FLAT}", "Profile under a straight face", ("κ = 1/(h + h_νν)",), "κ h.support h_νν", _FACE,
            "cam.faces.envelope", working="κ = 1/ρ", values="ρ"),
    *_places("{}_o", "outer", "Outer flank", "p_o = (R - (R_r + s_p) n) e^(-i d θ)", "p_o R R_r s_p n d θ", "(-R_r - s_p)", "R_r s_p",
             source="second envelope of the roller"),
    Formula("outer_curvature", "Outer flank", ("κ_o = κ_p/(1 + (R_r + s_p) κ_p)",), "κ_o κ_p R_r s_p", _PARALLEL, f"{_CAM}.round_envelope"),
    *_places("{}₂", "second", "Second profile", "p_2 = (R_2 + (R_r2 + s_p) n_2) e^(-i d θ)", "p_2 R_2 R_r2 s_p n_2 d θ",
             "(R_r2 + s_p)", "R_r2 s_p"),
    *_places("{}_p2", "second_pitch", "Second profile", "c_2 = R_2 e^(-i d θ)", "c_2 R_2 d θ", "", "", source="Shin1995 §3"),
    Formula("second_pressure_angle", "Second profile", ("tan ψ₂ = |n_2 × v_2|/|n_2 · v_2|",), "ψ₂ n_2 v_2",
            "Shin1995 (19), for any pose", f"{_CAM}.round_envelope",
            working="ψ₂ = atan2(|n_2x v_2y - n_2y v_2x|, |n_2x v_2x + n_2y v_2y|)", values="n_2x n_2y v_2x v_2y"),
    Formula("second_pitch_curvature", "Second profile", ("κ_p2 = -d (t_2 × w_2)/|t_2|³",), "κ_p2 d t_2 w_2",
            "curvature of a plane curve", f"{_CAM}.curvature",
            working="κ_p2 = -d (t_2x w_2y - t_2y w_2x)/(t_2x² + t_2y²)^(3/2)", values="d t_2x t_2y w_2x w_2y"),
    Formula("second_profile_curvature", "Second profile", ("κ₂ = κ_p2/(1 - (R_r2 + s_p) κ_p2)",), "κ₂ κ_p2 R_r2 s_p", _PARALLEL,
            f"{_CAM}.round_envelope"),
)  # fmt: skip

FORMULAS: Mapping[str, Formula] = MappingProxyType(
    {row.name: row for row in (*_MOTION, *_TRAINS, *_LINKAGE, *_CAM_ROWS, *SPATIAL_FORMULAS, *FORCE_FORMULAS)}
)
"""Name -> row, in the order in which a report prints them."""
