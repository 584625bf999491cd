"""Formulas of forces, stresses, shaft, servo and stability, one row each; ``core.study.formulas`` puts them behind those of the motion."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from math import isfinite

from core.design.parts import ElasticShaft
from core.errors import NoSolution
from core.study.camshaft import is_complete
from core.study.drive_forces import roller_lives
from core.study.member_quantities import TRAIN_NAMES
from core.study.study import Study, shaft_in_chart
from core.study.symbols import Formula

_VALUES, _BALANCE, _WALK = (
    "study.member_quantities",
    "dynamics.momentum_residual",
    "dynamics.newton_euler",
)
_ENERGY, _LINKS, _POWER = "balance of energy", "balance of the links", "virtual power"
_PAIRS, _SIZES, _DRIVER = "Forces in the pairs", "Size and direction of a force", "Torque or force of the driver"

# -- which designs use a formula ----------------------------------------------------------------------------------


def has_flywheel(study: Study, names: Collection[str]) -> bool:
    """Whether the torque of the shaft has a mean and a swing of energy: every drive has a solution, and a motor turns it."""
    try:
        if study.design.listed:
            return is_complete(study.camshaft)
        return "motor_torque" in names and study.jam is None
    except NoSolution:
        return False


def has_true_speed(study: Study, names: Collection[str]) -> bool:
    """Whether the motor turns the shaft with its flywheel."""
    return has_flywheel(study, names) and study.flywheel.runs


def has_life(study: Study, names: Collection[str]) -> bool:
    """Whether a roller has a rolling life."""
    return any(roller_lives(single) for single in study.solved_drives.values())


def has_finite_life(study: Study, names: Collection[str]) -> bool:
    """Whether a roller of the only drive wears out."""
    return has_life(study, names) and isfinite(min(life.hours for life in roller_lives(study)))


def is_shaft_of_drives(study: Study, names: Collection[str]) -> bool:
    """Whether several drives turn with one shaft, and all have a solution."""
    return study.design.listed and is_complete(study.camshaft)


def _elastic(study: Study) -> ElasticShaft | None:
    return None if study.design.shaft is None else study.design.shaft.elastic


def is_flexible(study: Study, names: Collection[str] = ()) -> bool:
    """Whether the design's shaft is flexible and has a point in the chart of stability."""
    return _elastic(study) is not None and shaft_in_chart(study) is not None


def has(*quantities: str, without: str = "") -> Callable[[Study, Collection[str]], bool]:
    """Whether the design has these quantities, and not that one."""
    return lambda study, names: all(name in names for name in quantities) and without not in names


def _is_spring(spring: str, study: Study, names: Collection[str]) -> bool:
    elastic = _elastic(study)
    return is_flexible(study) and elastic is not None and elastic.spring == spring


def _is_damped(study: Study, names: Collection[str]) -> bool:
    elastic = _elastic(study)
    return is_flexible(study) and elastic is not None and elastic.damping_ratio > 0.0


# -- forces -----------------------------------------------------------------------------------------------------

_SHIN24 = "Shin1995 (24), (26), corrected"
_NEWTON = ("m a_G = Σ F", "I α̇ = Σ (r - r_G) × F + Σ M")
_NEWTON_LETTERS = "m.body a_G F.body I.body α̇ r.body r_G M.body"


def _pair(name: str, source: str) -> tuple[Formula, ...]:
    """Components of the force in a pair of a follower."""
    return tuple(
        Formula(f"{name}_{axis}", _PAIRS, _NEWTON, _NEWTON_LETTERS, source, _WALK, member=name) for axis in "xy"
    )  # fmt: skip


def _size(name: str, size: str = "", direction: str = "", member: str = "") -> tuple[Formula, ...]:
    """Size and direction of the force in a pair."""
    return (
        Formula(size or name, _SIZES, ("F = √(F_x² + F_y²)",), "F.pair F_x F_y", "components of a force", f"{_VALUES}.force_component",
                member=member),
        Formula(direction or f"{name}_direction", _SIZES, ("ε = atan2(F_y, F_x)",), "ε.direction F_x F_y", "components of a force",
                f"{_VALUES}.force_component", member=member),
    )  # fmt: skip


def _hertz(second: bool) -> tuple[Formula, ...]:
    """Stresses under the first roller or face, or under the second roller."""
    index, key, member = ("₂", "second_", "second") if second else ("", "", "first")
    p, a, source, of = (f"p{index}", f"a{index}", "Hertz, line contact", "stress.contact_stress")
    p_key, a_key = (p, a) if second else ("p.stress", "a.contact")
    shear, depth = ("τ₂", "z₂") if second else ("τ.shear", "z.depth")
    title = "Stress under the second roller" if second else "Contact pressure"
    return (
        Formula(f"{key}contact_pressure", title, (f"{p} = √(F_c E* κ_rel/(π b))", "1/E* = Σ (1 - ν²)/E"),
                f"{p_key} F_c.flank E* κ_rel b.width ν E.young", source, "stress.contact_pressure", member=member),
        Formula(f"{key}subsurface_shear", title, (f"τ{index} = 0.300283 {p}",), f"{shear} {p_key}", source, of,
                working=f"τ{index} = 0.30028310600078 {p}", values=p_key, member=member),
        Formula(f"{key}subsurface_shear_depth", title, (f"z{index} = 0.786151 {a}",), f"{depth} {a_key}", source, of,
                working=f"z{index} = 0.78615137775742 {a}", values=a_key, member=member),
        Formula(f"{key}contact_half_width", title, (f"{a} = 2 {p}/(E* κ_rel)",), f"{a_key} {p_key} E* κ_rel", source, of,
                member=member),
        Formula(f"{key}roller_speed", "Speed of the roller", ("ω_r = ω (d - α′ ∓ d |t|/R_r)",), "ω_r ω d α′ t R_r",
                "rolling without slip", "stress.roller_speed", working="n_r = ω u", values="ω u.roller", member=member),
    )  # fmt: skip


_FORCES: tuple[Formula, ...] = (
    Formula("contact_force", "Contact force", ("F_c = Q/l", "Q = Σ (F · ∂r/∂q + M ∂α/∂q)"),
            "F_c Q.power l F.body r.body q.driver M.body α.body", f"{_POWER}; {_SHIN24}", _WALK),
    Formula("second_contact_force", "Contact force", ("F_c2 = Q/l_2",), "F_c2 Q.power l_2", f"{_POWER}; {_SHIN24}", _WALK,
            remark="the second roller is in contact where F_c would pull"),
    Formula("momentum_balance.slider", "Balance of the slider",
            ("m_s L̈ = A_x + F + m_s g_x - μ|N| sgn L̇", "0 = A_y + N + m_s g_y"),
            "m_s L̈ A_x F.slider g_x μ N L̇ A_y g_y", "Shin1995 (21), corrected", _BALANCE, has("phi", "guide_force"),
            remark="x along the guide"),
    Formula("momentum_balance.friction", "Guide force with friction", ("N = N_0/(1 + τ)", "τ = sgn(N_0) μ sgn(L̇) tan β"),
            "N N_0 τ.friction μ L̇ β", "friction in closed form", _WALK, has("phi", "guide_force"),
            remark="the guide jams where μ|tan β| ≥ 1"),
    Formula("momentum_balance.rod", "Balance of the rod", ("m_A a_G = B - A + m_A g", "I_A β̈ = (r_B - r_G) × B - (r_A - r_G) × A"),
            "m_A a_G B A g I_A β̈ r_B r_G r_A.pin", "Shin1995 (22), (23), corrected", _BALANCE, has("phi", "guide_force")),
    Formula("momentum_balance.slider_arm", "Contact force on the slider's arm",
            ("J φ̈ = -r_B × B + r_G × m_L g + r_R × m_R g - F_c (r_R × n)", "J = I_L + m_L r_L² + I_R + m_R Z_l²"),
            "J φ̈ r_B B r_G m_L g r_R m_R F_c n I_L r_L I_R Z_l", "Shin1995 (24)-(26), corrected", _BALANCE,
            has("phi", "follower_torque", "contact_force"), remark="moments about the pivot"),
    Formula("momentum_balance.arm", "Contact force on an arm", ("J φ̈ = M - F_c (r_C × n)", "J = I_L + m_L r_L² + I_R + m_R Z_l²"),
            "J φ̈ M.arm F_c r_C n I_L m_L r_L I_R m_R Z_l", "balance of momentum", _BALANCE,
            has("follower_torque", "contact_force", without="phi")),
    Formula("momentum_balance.guide", "Contact force on a guide",
            ("m ÿ = -F_c (n · e) - k y - F_0 + m (g · e) + F - μ|N| sgn ẏ",),
            "m.follower ÿ F_c n e.guide k.spring y F_0 g F.loads μ N ẏ", "balance of momentum", _BALANCE,
            has("guide_force", "contact_force", without="phi")),
    Formula("driver_torque", _DRIVER, ("T = -Σ (F - m a) · ∂r/∂q",), "T.driver F.body m.body a.body r.body q.driver", _POWER, _WALK),
    Formula("driver_force", _DRIVER, ("F_d = -Σ (F - m a) · ∂r/∂q",), "F_d F.body m.body a.body r.body q.driver", _POWER, _WALK),
    Formula("link{}_input_torque", "Torque or force of a second input", ("T = -Σ M_k",), "T.input M_k", "moments of the link",
            "dynamics.walk.input_loads"),
    Formula("link{}_input_force", "Torque or force of a second input", ("F = -Σ F_k",), "F.input F_k", "forces of the link",
            "dynamics.walk.input_loads"),
    Formula("force", "Force or torque of the motion", ("F = m ÿ - F_e + F_r sgn ẏ",), "F.motion m.motion ÿ F_e F_r ẏ", "Newton", _WALK),
    Formula("output_torque", "Force or torque of the motion", ("T = I ÿ - T_e + T_r sgn ẏ",),
            "T.motion I.motion ÿ T_e T_r.friction ẏ", "Euler", _WALK),
    Formula("output_power", "Power", ("P = T ẏ",), "P.power T.output ẏ", _ENERGY, f"{_VALUES}.output_power"),
    Formula("drive_torque", "Cam torque", ("T_c = -d (C × F_c (n + μ v̂))",), "T_c d C F_c n μ.contact v̂", "Shin1995 (27)", _WALK,
            working="T_c = -d (C_x p_y - C_y p_x) F", values="d C_x C_y p_x.direction p_y.direction F.flank",
            remark="positive where it drives against the cam"),
    Formula("follower_torque", "Torque on the arm", ("T_L = -F_c (r_R × n)",), "T_L F_c r_R n", "Shin1995 (24), (25), corrected", _WALK,
            working="T_L = -F ((C_x - P_x) p_y - (C_y - P_y) p_x)",
            values="F.flank p_x.direction p_y.direction C_x C_y P_x.pivot P_y.pivot"),
    Formula("guide_force", "Guide force", ("N = e × G",), "N e.line G", "Shin1995 (21), corrected", f"{_VALUES}.guide_reaction",
            working="N = e_x G_y - e_y G_x", values="G_x G_y e_x.line e_y.line"),
    *_pair("slider_pin", "Shin1995 (21), (23), corrected"),
    *_pair("arm_pin", "Shin1995 (21), (23), corrected"),
    *_pair("pivot", _LINKS),
    *_pair("guide", _LINKS),
    *(row for name in TRAIN_NAMES for row in _pair(name, _LINKS)),
    Formula("guide_couple", _PAIRS, _NEWTON, _NEWTON_LETTERS, _LINKS, _WALK, member="guide"),
    *(Formula(f"bearing_{axis}", "Camshaft bearing", ("O = -Σ F_k p_k",), "O F_k.flank p_k", "balance of the camshaft", _WALK,
              member="bearing") for axis in "xy"),
    *(Formula(f"force.{{}}_{axis}", _PAIRS, _NEWTON, _NEWTON_LETTERS, _LINKS, _WALK) for axis in "xy"),
    Formula("couple.{}", _PAIRS, _NEWTON, _NEWTON_LETTERS, _LINKS, _WALK),
    *(row for name in ("slider_pin", "arm_pin", "pivot", "bearing", "guide", *TRAIN_NAMES) for row in _size(name, member=name)),
    *_size("force.{}", size="force.{}_size"),
    Formula("jam_factor", "Jamming factor", ("j = μ |∂N/∂f|",), "j μ N f", "friction in closed form", _WALK, remark="friction jams from 1"),
    *_hertz(second=False),
    *_hertz(second=True),
    Formula("life_hours", "Rolling life", ("L_10 = (C/P)^(10/3)",), "L_10 C.rating P.equivalent", "ISO 281", "stress.rolling_life",
            has_life, working="L = 3600^(-1) (C/P)^(10/3) 10^6 2 π/n_r", values="C.rating P.equivalent n_r"),
)  # fmt: skip

_POWERS: tuple[Formula, ...] = (
    *(Formula(name, "Kinetic energy", ("E = Σ (½ m v² + ½ I ω²)",), "E.kinetic m.body v.body I.body ω.body", _ENERGY,
              "dynamics.kinetic_energy") for name in ("kinetic_energy", "kinetic_energy.{}")),
    Formula("power.load", "Power", ("P = F ẏ",), "P.power F.motion ẏ", _ENERGY, "dynamics.element_power"),
    Formula("power.drive", "Power", ("P = T ω",), "P.power T.driver ω", _ENERGY, "dynamics.input_power"),
    Formula("power.gravity", "Power", ("P = Σ m g · v",), "P.power m.body g v.point", _ENERGY, "dynamics.gravity_power"),
    Formula("power.friction_{}", "Power", ("P = -μ |N| |v|",), "P.power μ N v.point", "Coulomb friction", _WALK),
    Formula("power.{}", "Power", ("P = F · v + M ω",), "P.power F.body v.point M.body ω.body", _ENERGY, "dynamics.element_power"),
    Formula("power_balance.springs", "Springs and dampers between points", ("F = k (l - l_0) + c l̇",),
            "F.element k.spring l.spring l_0 c.damper l̇", "along the line between the points", "dynamics.elements.Spring",
            lambda study, names: any(name.startswith("power.spring") for name in names)),
    Formula("power_balance", "Balance of power", ("T ω = dE_k/dt + dE_p/dt + P_f - P_e",), "T.shaft ω E_k E_p t.time P_f P_e",
            _ENERGY, "dynamics.power_residual", lambda study, names: bool({"contact_force", "driver_torque"} & set(names)),
            remark="holds at every cam angle"),
    *(Formula(name, "Elastic follower", ("m z̈ + c ż + k (z - s) + k_s z = 0",), "m.elastic z̈ c.elastic ż k.elastic z.mass s.cam k_s",
              "one mass on the follower's stiffness", "elastic.Response.error", working=line, values=keys)
      for name, line, keys in (("elastic_displacement", "z = s + e", "s.cam e.deviation"),
                               ("elastic_error", "e = z - s", "z.mass s.cam"),
                               ("elastic_acceleration", "z̈ = ω² s″ + ë", "ω s″.cam ë"))),
    Formula("elastic_contact_force", "Elastic follower", ("F_e = F_c + Δ",), "F_e.elastic F_c.rigid Δ.elastic",
            "one mass on the follower's stiffness", "study.drive_forces.DriveForces.elastic_contact_force"),
)  # fmt: skip

# -- shaft, servo and stability -----------------------------------------------------------------------------------

_SHIN19, _SIZING = (
    "Shin1995 Figs. 19, 20, not linearised",
    "sizing by the true speed; textbook's estimate by the energy of the turn",
)
_ENERGY_LINE, _MOTOR_LINE = "d/dθ[½(I + J_e) ω²] = T_m - T_s", "T_m = T̄ + k (ω̄ - ω)"
_MOTOR, _MOTOR_LETTERS = "Speed and motor torque", "T_m T̄ k.motor ω̄ ω.shaft θ I.flywheel J_e T_s.loads"
_WHEEL = "shaft.Flywheel"
_GEAR = "shaft.servo"
_HILL, _EDGES = "Kim1990 (21)", "Edges of the forbidden bands"
_TONGUES = "stability.tongues.harmonic_tongues"
_SERVO = "balance at the motor"

_SHAFT: tuple[Formula, ...] = (
    Formula("motor_torque", _MOTOR, (_MOTOR_LINE, _ENERGY_LINE), _MOTOR_LETTERS, _SHIN19, f"{_WHEEL}.motor_torque", has_flywheel),
    Formula("camshaft_speed", _MOTOR, (_ENERGY_LINE, _MOTOR_LINE), _MOTOR_LETTERS, _SHIN19, f"{_WHEEL}.speed", has_flywheel),
    Formula("linear_motor_torque", "Motor torque, linear equation", ("T_m = Σ T_n e^(i n θ)/(1 + i n I ω̄/k)",),
            "T_m T_n n.order θ I.shaft ω̄ k.motor", "Shin1995 Figs. 19, 20", f"{_WHEEL}.linear_motor_torque",
            lambda study, names: study.levels_torque and has_true_speed(study, names) and not study.design.listed,
            working="T_m = T̄ + H", values="T̄ H.harmonics"),
    Formula("mean_torque_nm", "Flywheel", ("T̄ = W/(2 π)",), "T̄ W.turn", _SIZING, f"{_WHEEL}.mean_torque", has_flywheel),
    Formula("energy_swing_j", "Flywheel", ("ΔE = W_M - W_m",), "ΔE W_M W_m", _SIZING, f"{_WHEEL}.energy_swing", has_flywheel),
    Formula("needed_inertia_kg_m2", "Flywheel", ("I = I_C - I_m",), "I.flywheel I_C I_m", _SIZING, f"{_WHEEL}.needed_inertia",
            has_flywheel),
    Formula("estimated_inertia_kg_m2", "Flywheel", ("I = max(ΔE/(C_s ω̄²) - I_m, 0)",), "I.flywheel ΔE C_s ω̄ I_m", _SIZING,
            f"{_WHEEL}.estimated_inertia", has_flywheel, remark="I by max(...) is the estimate"),
    Formula("fluctuation", "Flywheel", ("C = (ω_M - ω_m)/ω̄",), "C.fluctuation ω_M ω_m ω̄", _SIZING, f"{_WHEEL}.fluctuation",
            has_true_speed),
    Formula("min_speed_rpm", "Flywheel", ("n = ω_m",), "n.speed ω_m", _SIZING, f"{_WHEEL}.speed_range", has_true_speed),
    Formula("max_speed_rpm", "Flywheel", ("n = ω_M",), "n.speed ω_M", _SIZING, f"{_WHEEL}.speed_range", has_true_speed),
    Formula("torque_nm", "Torque of all drives", ("T(θ) = Σ T_k(θ - θ_k)",), "T.all θ.machine T_k θ_k.phase", "one shaft",
            "study.camshaft.Camshaft.torque", lambda study, names: study.design.listed),
    Formula("rms_nm", "Torque of all drives", ("T_r = √M",), "T_r M.square", "definition of the mean square",
            "study.camshaft.Camshaft.rms_torque", is_shaft_of_drives),
    Formula("peak_power_w", "Torque of all drives", ("P = T ω̄",), "P.power T.peak ω̄", "power at constant speed",
            "study.camshaft.Camshaft.peak_power", is_shaft_of_drives),
    Formula("balancer_torque_nm", "Balance cam", ("x = 2(E_0 - W)/(F_0 + √(F_0² + 2 K (E_0 - W)))", "x′ = -(T - T̄)/(F_0 + K x)"),
            "x.balance E_0 W.angle F_0.balance K.spring x′.balance T.all T̄", "energy of its spring", "shaft.balancer.balance_drive",
            lambda study, names: study.design.balancer is not None and has_flywheel(study, names), remark="W = ∫(T - T̄) dθ of all drives"),
    Formula("servo_torque", "Servo", ("T_s = J_r i ÿ + (F + m ÿ + F_r) k/i",), "T_s.servo J_r i ÿ F.load m.servo F_r.servo k.losses",
            _SERVO, f"{_GEAR}.motor_torque"),
    Formula("servo_force", "Servo", ("F_s = (F + m ÿ + F_r) k",), "F_s F.load m.servo ÿ F_r.servo k.losses", _SERVO,
            f"{_GEAR}.motor_torque"),
    Formula("servo_speed", "Servo", ("n_s = i ẏ",), "n_s.servo i ẏ", "gear of the servo", "study.drive_forces.servo_speed"),
    Formula("servo_velocity", "Servo", ("v_s = ẏ",), "v_s ẏ", "a linear motor", "study.drive_forces.servo_speed"),
    Formula("servo_power", "Servo", ("P_s = T_s i ẏ",), "P_s T_s.servo i ẏ", _ENERGY, "study.drive_forces.servo_power"),
)  # fmt: skip

_STABILITY: tuple[Formula, ...] = (
    Formula("natural_rpm", "Frequency and inertia ratio", ("n_s = √(K_s/I_c)",), "n_s K_s I_c", "Kim1990",
            "stability.critical_speeds.Machine.natural", is_flexible),
    Formula("eta", "Frequency and inertia ratio", ("η = √(K_s/I_c)/ω̄",), "η K_s I_c ω̄", "Kim1990 (12)",
            "stability.critical_speeds.Machine.eta", is_flexible),
    Formula("q", "Frequency and inertia ratio", ("Q = M_v X′_m²/I_c",), "Q.inertia M_v X′_m I_c", "Kim1990",
            "stability.critical_speeds.Machine", lambda study, names: is_flexible(study) and not study.design.listed),
    Formula("verdicts.exact", "Wind-up of the shaft, Hill's form",
            ("ζ″ + 4 π² [(η² + Q ψ)/D + (Q C/D)²] ζ = 2 π Q (C + U)/√D", "ζ = √D β"), "ζ ζ″ η Q.inertia ψ.load D C.hill U β.windup",
            _HILL, "stability.coefficients.inertia_and_pull", is_flexible),
    Formula("verdicts.approximation", "Wind-up by Kim1990's approximation", ("ζ″ + 4 π² (η² + Q ψ) ζ = 2 π Q (C + U)",),
            "ζ ζ″ η Q.inertia ψ.load C.hill U", "Kim1990 (22)", "stability.coefficients.inertia_and_pull", is_flexible,
            remark="D is set to 1, and with it C left out of the left side; given besides the exact form"),
    Formula("bands.retuned", _EDGES, ("[R² - T(Q ψ/D + (Q C/D)²)] a = η² T(1/D) a",),
            "R.orders T.toeplitz Q.inertia ψ.load D C.hill a.harmonics η", f"{_HILL}, harmonics", _TONGUES,
            partial(_is_spring, "retuned"), remark="an eigenvalue problem"),
    Formula("bands.fixed", _EDGES, ("[R² - T((Q C/D)²)] a = η² T((1 + Q ψ_1)/D) a",),
            "R.orders T.toeplitz Q.inertia C.hill D a.harmonics η ψ_1",
            f"{_HILL}, harmonics, for loads that do not change with the speed", _TONGUES, partial(_is_spring, "fixed"),
            remark="an eigenvalue problem"),
    Formula("bands.damped", "Edges with damping", ("(R T(D) R - Q T(ψ + κ) - 2 i ζ η R - η²) a = 0",),
            "R.orders T.toeplitz D Q.inertia ψ.load κ.slope ζ.damping η a.harmonics", f"{_HILL}, harmonics",
            "stability.floquet.monodromy",
            _is_damped, remark="real η are edges"),
    Formula("wind_up", "Steady response of the shaft", ("ϕ = T_s/K_s",), "ϕ T_s K_s", "Kim1990 (13), corrected",
            "stability.steady.SteadyTurn.wind_up"),
    Formula("shaft_torque", "Steady response of the shaft", ("T_s = K_s ϕ",), "T_s K_s ϕ", "Kim1990 §1, steady response",
            "stability.steady.SteadyTurn.torque"),
    Formula("follower_error", "Steady response of the shaft", ("Δ = X_c - X_i",), "Δ.follower X_c X_i", "Kim1990 §1, steady response",
            "stability.steady.SteadyTurn.error"),
)  # fmt: skip

FORCE_FORMULAS: tuple[Formula, ...] = (*_FORCES, *_POWERS, *_SHAFT, *_STABILITY)
"""Rows of forces, powers, shaft and stability, in the order in which a report prints them."""
