"""The equations behind a report's numbers, one row each: as one line of text, with their source, and for which designs they stand.

Where a paper is marked corrected, its printed equation is wrong and this one is computed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from core.design import NamedCurve
from core.frozen import frozen
from core.laws import FLAT_FORMULA, FLAT_WHERE, named_law
from core.output.report.formula import mathml
from core.output.summary import flywheel
from core.study import Study, names_of, roller_lives
from core.study.study import shaft_in_chart

LOWERED = str.maketrans("0123456789aehijklmnoprstuvx", "₀₁₂₃₄₅₆₇₈₉ₐₑₕᵢⱼₖₗₘₙₒₚᵣₛₜᵤᵥₓ")
_INDEX = re.compile(r"(?<=\w)_(\w+)")


@frozen
class Equation:
    """One row.

    name    what it gives; lines: the equations; where: what their letters mean
    source  paper and number, or what it follows from
    needs   patterns; each must be a fact of the design: a quantity of ``core.study``, ``life``,
            ``elastic follower``, ``flywheel``, ``stability``, ``spring fixed``, ``damped shaft``, ``drives``, ``balancer``
    without patterns of which none may be
    """

    name: str
    lines: tuple[str, ...]
    source: str
    where: str = ""
    needs: tuple[str, ...] = ()
    without: tuple[str, ...] = ()

    @property
    def mathml(self) -> tuple[str, ...]:
        """Its lines as MathML."""
        return tuple(mathml(line) for line in self.lines)

    @property
    def meaning(self) -> str:
        """What its letters mean, their indices lowered: R_r is written Rᵣ where that letter can be lowered, else Rr."""
        return _INDEX.sub(lambda found: _lowered(found[1]), self.where)

    def holds(self, facts: frozenset[str]) -> bool:
        """Whether a design with these facts uses it."""
        return all(_any(pattern, facts) for pattern in self.needs) and not any(
            _any(pattern, facts) for pattern in self.without
        )


def _lowered(index: str) -> str:
    return index.translate(LOWERED) if all(ord(letter) in LOWERED for letter in index) else index


def _any(pattern: str, facts: Iterable[str]) -> bool:
    return any(re.fullmatch(pattern, fact) for fact in facts)


FLAT, GUIDE, ARM, SLIDER, LINKS = (
    "contact_on_face",
    "guide_force",
    "follower_torque",
    "phi",
    "force\\..*|link\\..*|slide\\..*",
)

EQUATIONS: tuple[Equation, ...] = (
    Equation(
        "Displacement over a segment",
        ("y = y_0 + h s(u)", "u = (θ - θ_0)/β"),
        "definition of a motion law",
        "h rise, β span, θ₀ cam angle and y₀ displacement at the start of the segment",
        ("displacement",),
    ),
    Equation(
        "Velocity, acceleration, jerk",
        ("ẏ = ω y′", "ÿ = ω² y″", "y⃛ = ω³ y‴"),
        "constant speed ω",
        "′ is d/dθ; derivatives in closed form, segment by segment",
        ("displacement",),
    ),
    Equation(
        "Triangle of arm and rod",
        (
            "K = √((A + (B + C))(C - (A - B))(C + (A - B))(A + (B - C)))",
            "φ = atan2(H, L) + σ atan2(K, r² + (L₁ - L₂)(L₁ + L₂))",
            "β = atan2(H, L) - σ atan2(K, r² - (L₁ - L₂)(L₁ + L₂))",
        ),
        "Shin1995 (8)-(10), by the triangle's area",
        "A ≥ B ≥ C the sides r = √(L² + H²), L₁ slider arm, L₂ rod; L = L₀ + y slider position, H guide height, σ = ±1 by the layout",
        (SLIDER,),
    ),
    Equation(
        "Velocities of arm and rod",
        ("φ̇ = L̇ cos β/(L₁ sin(β - φ))", "β̇ = L̇ cos φ/(L₂ sin(φ - β))"),
        "Shin1995 (11), (12)",
        "",
        (SLIDER,),
    ),
    Equation(
        "Accelerations of arm and rod",
        (
            "φ̈ = (L̈ cos β + L₁ φ̇² cos(φ - β) + L₂ β̇²)/(L₁ sin(β - φ))",
            "β̈ = (L̈ cos φ + L₂ β̇² cos(φ - β) + L₁ φ̇²)/(L₂ sin(φ - β))",
        ),
        "Shin1995 (13), (14)",
        "",
        (SLIDER,),
    ),
    Equation(
        "Roller centre on its arm",
        ("R = P + Z_l e^(iα)", "R′ = i α′ (R - P)"),
        "Shin1995 §3",
        "P pivot, Z_l roller arm, α its angle",
        (ARM, "pitch_x"),
    ),
    Equation(
        "Roller centre on its guide",
        ("R = e(S + i ε)", "S = √((R_b + R_r)² - ε²) + y"),
        "geometry of the guide",
        "e direction of the guide, ε offset, R_b base radius, R_r roller radius",
        (GUIDE, "pitch_x"),
        (SLIDER,),
    ),
    Equation(
        "Angles of the links",
        ("Σ r_k e^(iθ_k) = 0",),
        "closed loops, dyad by dyad",
        "r_k sides of the loop, θ_k their angles; each dyad a triangle of known sides",
        (LINKS,),
    ),
    Equation(
        "Velocities of points",
        ("V_P = V_A + V_PA", "V_PA = i ω_k (r_P - r_A)"),
        "Velocity 6.1",
        "A and P on one link k",
        (LINKS,),
    ),
    Equation(
        "Transmission angle",
        ("μ = atan2(|c₁ × c₂|, |c₁ · c₂|)",),
        "angle between the links at the joint",
        "c₁, c₂ from the joint along its two links",
        ("transmission\\..*",),
    ),
    Equation(
        "Normal of the cam",
        ("t = R′ - i d R", "n = -i d t/|t|"),
        "Shin1995 (19), for any pose",
        "d = +1 where the shaft turns counter-clockwise, -1 clockwise; n points into the cam",
        ("pitch_x",),
    ),
    Equation("Pitch curve", ("c = R e^(-i d θ)",), "Shin1995 §3", "in the frame of the cam", ("pitch_x",)),
    Equation(
        "Profile",
        ("p = (R + R_r n) e^(-i d θ)",),
        "Shin1995 (20), for any pose",
        "R_r radius of roller or shoe, 0 of a knife edge",
        ("pitch_x",),
    ),
    Equation(
        "Instant centre of cam and arm",
        ("Q = q P/|P|", "q = |P| φ′/(φ′ - d)"),
        "Shin1995 (18), φ' against the cam; Kennedy",
        "the normal passes through Q",
        (ARM, "pitch_x"),
    ),
    Equation(
        "Pressure angle",
        ("tan ψ = |n × v|/|n · v|",),
        "Shin1995 (19), for any pose",
        "v direction in which the roller centre travels",
        ("pressure_angle", "pitch_x"),
    ),
    Equation(
        "Pressure angle of a straight face",
        ("tan ψ = |m × v|/|m · v|",),
        "definition",
        "v direction in which the point of the face that touches travels",
        ("pressure_angle", FLAT),
    ),
    Equation(
        "Curvature of the pitch curve",
        ("κ_p = -d Im(t̄ w)/|t|³", "w = R″ - 2 i d R′ - R"),
        "curvature of a plane curve",
        "positive where convex",
        ("pitch_curvature",),
    ),
    Equation(
        "Curvature of the profile",
        ("κ = κ_p/(1 - R_r κ_p)",),
        "parallel curve",
        "undercut where R_r κ_p ≥ 1",
        ("pitch_curvature",),
    ),
    Equation(
        "Profile under a straight face",
        ("p = m(h + i h_ν) e^(-i d θ)", "κ = 1/(h + h_νν)"),
        "support function of the face",
        "m normal of the face, h its distance from the cam centre, ν the angle of m in the frame of the cam",
        (FLAT,),
    ),
    Equation(
        "Outer flank",
        ("p_o = (R - (R_r + s_p) n) e^(-i d θ)", "κ_o = κ_p/(1 + (R_r + s_p) κ_p)"),
        "second envelope of the roller",
        "s_p play in the groove",
        ("outer_x",),
    ),
    Equation(
        "Second profile", ("p_2 = (R_2 + R_r2 n_2) e^(-i d θ)",), "as the first", "of the second roller", ("second_x",)
    ),
    Equation(
        "Balance of the slider",
        ("m_s L̈ = A_x + F + m_s g_x - μ|N| sgn L̇", "0 = A_y + N + m_s g_y"),
        "Shin1995 (21), corrected",
        "A force of the rod on the slider, N of the guide, F external force, x along the guide",
        (SLIDER, GUIDE),
    ),
    Equation(
        "Guide force with friction",
        ("N = N_0/(1 + τ)", "τ = sgn(N_0) μ sgn(L̇) tan β"),
        "friction in closed form",
        "N₀ guide force without friction; the guide jams where μ|tan β| ≥ 1",
        (SLIDER, GUIDE),
    ),
    Equation(
        "Balance of the rod",
        ("m_A a_G = B - A + m_A g", "I_A β̈ = (r_B - r_G) × B - (r_A - r_G) × A"),
        "Shin1995 (22), (23), corrected",
        "B force of the arm on the rod, G its centre of mass, I_A about G",
        (SLIDER, GUIDE),
    ),
    Equation(
        "Contact force on the slider's arm",
        ("J φ̈ = -r_B × B + r_G × m_L g + r_R × m_R g - F_c (r_R × n)", "J = I_L + m_L r_L² + I_R + m_R Z_l²"),
        "Shin1995 (24)-(26), corrected",
        "moments about the pivot; L the arm, R the roller, inertias about their centres of mass",
        (SLIDER, ARM, "contact_force"),
    ),
    Equation(
        "Contact force on an arm",
        ("J φ̈ = M - F_c (r_C × n)", "J = I_L + m_L r_L² + I_R + m_R Z_l²"),
        "balance of the arm",
        "moments about the pivot; M of weight, spring and loads, C point of contact or roller centre",
        (ARM, "contact_force"),
        (SLIDER,),
    ),
    Equation(
        "Contact force on a guide",
        ("m ÿ = -F_c (n · e) - k y - F_0 + m (g · e) + F - μ|N| sgn ẏ",),
        "balance of the follower",
        "e direction of the guide, k spring rate, F₀ preload, F loads, N guide force",
        (GUIDE, "contact_force"),
        (SLIDER,),
    ),
    Equation(
        "Forces of the links",
        ("m a_G = Σ F", "I α̇ = Σ (r - r_G) × F + Σ M"),
        "balance of the links, dyad by dyad",
        "G centre of mass, α angular velocity of the link, moments about G",
        ("force\\..*",),
    ),
    Equation(
        "Torque or force of the driver",
        ("T = -Σ (F - m a) · ∂r/∂q",),
        "virtual power",
        "q position of the driver",
        ("driver_torque|driver_force",),
    ),
    Equation(
        "Cam torque",
        ("T_c = -d (R × F_c n)",),
        "Shin1995 (27)",
        "positive where it drives against the cam",
        ("drive_torque", "contact_force"),
    ),
    Equation(
        "Contact pressure",
        ("p = √(F_c E′ κ_rel/(π b))", "1/E′ = Σ (1 - ν²)/E"),
        "Hertz, line contact",
        "b thickness, κ_rel sum of the curvatures of cam and roller",
        ("contact_pressure",),
    ),
    Equation(
        "Rolling life",
        ("L_10 = (C/P)^(10/3)",),
        "ISO 281",
        "in million turns of the roller; C its load rating, P the equivalent load",
        ("life",),
    ),
    Equation(
        "Flywheel",
        ("(ω_max - ω_min)/ω̄ = C_s", "I ≈ ΔE/(C_s ω̄²)", "ΔE = max W - min W", "W = ∫(T_c - T̄) dθ"),
        "least inertia by the true speed; estimate by the energy of the turn",
        "C_s fluctuation of speed wanted, bars mean values",
        ("flywheel",),
    ),
    Equation(
        "Speed and motor torque",
        ("d/dθ[½(I + J_e) ω²] = T_m - T_s", "T_m = T̄ + k (ω̄ - ω)"),
        "Shin1995 Figs. 19, 20, not linearised",
        "J_e inertia of the mechanism at the shaft, k slope of the motor, T_s torque of springs, weight, loads and friction",
        ("flywheel",),
    ),
    Equation(
        "Torque of all drives",
        ("T(θ) = Σ T_k(θ - θ_k)",),
        "one shaft",
        "θ machine angle, θ_k phase of drive k",
        ("drives",),
    ),
    Equation(
        "Balance cam",
        ("x = 2(E_0 - W)/(F_0 + √(F_0² + 2 K (E_0 - W)))", "x′ = -(T - T̄)/(F_0 + K x)"),
        "energy of its spring",
        "W = ∫(T - T̄) dθ of all drives, K spring rate, F₀ preload, E₀ energy at its start",
        ("balancer",),
    ),
    Equation(
        "Frequency and inertia ratio",
        ("η² = K_s/(I_c ω²)", "Q = M_v X′_m²/I_c"),
        "Kim1990",
        "K_s stiffness of the shaft, I_c inertia of the camshaft, M_v follower mass, X′_m greatest slope of the motion",
        ("stability",),
        ("drives",),
    ),
    Equation(
        "Wind-up of the shaft, Hill's form",
        ("ζ″ + 4 π² [(η² + Q ψ)/D + (Q C/D)²] ζ = 2 π Q (C + U)/√D", "ζ = √D β"),
        "Kim1990 (21)",
        "β wind-up in turns; D = J/I_c inertia, C = D_θ/(2Q), U load of the cam by the cam angle, ψ = U_θ",
        ("stability",),
    ),
    Equation(
        "Wind-up by Kim1990's approximation",
        ("ζ″ + 4 π² (η² + Q ψ) ζ = 2 π Q (C + U)",),
        "Kim1990 (22)",
        "D set to 1, and with it C left out of the left side; given beside the exact form",
        ("stability",),
    ),
    Equation(
        "Edges of the forbidden bands",
        ("[R² - T(Q ψ/D + (Q C/D)²)] a = η² T(1/D) a",),
        "Kim1990 (21), harmonics",
        "R the orders r or r + ½, T(·) the Toeplitz matrix of Fourier coefficients; an eigenvalue problem",
        ("stability", "spring retuned"),
    ),
    Equation(
        "Edges of the forbidden bands",
        ("[R² - T((Q C/D)²)] a = η² T((1 + Q ψ_1)/D) a",),
        "Kim1990 (21), harmonics, for loads that do not change with the speed",
        "ψ = η² ψ₁; R the orders r or r + ½, T(·) the Toeplitz matrix of Fourier coefficients; an eigenvalue problem",
        ("stability", "spring fixed"),
    ),
    Equation(
        "Edges with damping",
        ("(R T(D) R - Q T(ψ + κ) - 2 i ζ η R - η²) a = 0",),
        "Kim1990 (21), harmonics",
        "real η are edges; ζ damping ratio, κ = C_θ",
        ("stability", "damped shaft"),
    ),
    Equation(
        "Elastic follower",
        ("m z̈ + c ż + k (z - s) + k_s z = 0",),
        "one mass on the follower's stiffness",
        "s motion of the cam, z of the mass, k stiffness of the follower, k_s of its closing spring, c damping",
        ("elastic follower",),
    ),
    Equation(
        "Springs and dampers between points",
        ("F = k (l - l_0) + c l̇",),
        "along the line between the points",
        "l their distance, l₀ without load",
        ("power\\.spring.*",),
    ),
    Equation(
        "Balance of power",
        ("T ω = dE_k/dt + dE_p/dt + P_f - P_e",),
        "proof, at every cam angle",
        "E_k kinetic energy, E_p of weight and springs, P_f lost in friction and dampers, P_e of external forces",
        ("contact_force|driver_torque",),
    ),
)


# -- motion laws --------------------------------------------------------------------------------------------


def _law(slug: str) -> Equation | None:
    """The formula of a law, None of one that does not move."""
    law = named_law(slug)
    if not law.formula:
        return None
    source, _, _ = law.source.partition(":")
    if law.own:
        name = law.label if law.label.isupper() else law.label.lower()
        return Equation(f"Motion law: {name}", law.formula, source, law.where)
    where = law.where or ("of a return: s(u) times a negative rise" if law.rises < 0 else "")
    return Equation(f"Motion law: {law.label}", law.formula, source if source[:1].isupper() else "definition", where)


FLAT_LAW = Equation(
    "Motion law: half cycloid with constant acceleration", FLAT_FORMULA, "half a modified trapezoid", FLAT_WHERE
)


# -- which a design uses ------------------------------------------------------------------------------------


def equations_of(study: Study) -> tuple[Equation, ...]:
    """Those that the design's numbers come from: displacement and its derivatives, the motion laws, then the other rows of
    ``EQUATIONS`` whose facts the whole or one of its drives has."""
    whole, singles = _whole_facts(study), tuple(study.solved_drives.values())
    holders = [whole, *(whole | _facts(each) for each in singles)]
    used = [row for row in EQUATIONS if any(row.holds(facts) for facts in holders)]
    curves = [s.curve for each in singles if "motion" in each.stages for s in each.program.motion.segments]
    of_curves = (FLAT_LAW if isinstance(c, NamedCurve) and c.flat_fraction else _law(c.law) for c in curves)
    laws = [law for law in of_curves if law is not None]
    motion = [row for row in used if row.needs == ("displacement",)]
    return (*motion, *dict.fromkeys(laws), *(row for row in used if row not in motion))


def _facts(study: Study) -> frozenset[str]:
    """What a drive has."""
    own = {"life": bool(roller_lives(study)), "elastic follower": study.is_elastic}
    return frozenset((*names_of(study.design), *(name for name, there in own.items() if there)))


def _whole_facts(study: Study) -> frozenset[str]:
    """What the shaft has; of several drives, one of which has no answer, nothing of what they do together."""
    wheel, design = bool(flywheel(study)), study.design
    own = {"drives": design.listed, "flywheel": wheel, "stability": shaft_in_chart(study) is not None}
    own["balancer"] = wheel and design.balancer is not None
    elastic = study.design.shaft.elastic if study.design.shaft is not None else None
    if elastic is not None:
        own |= {f"spring {elastic.spring}": True, "damped shaft": elastic.damping_ratio > 0.0}
    return frozenset(name for name, there in own.items() if there)


__all__ = ["EQUATIONS", "Equation", "equations_of"]
