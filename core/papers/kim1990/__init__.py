"""Kim, Jeon, Lee and Park 1990, dynamic stability of a single cam drive: its statements in the order of the paper."""

from core.papers.claim import AS_SCANNED, MISPRINT, Row, kept, mended, named
from core.papers.kim1990 import chart, equations
from core.papers.kim1990 import judgements as judge
from core.papers.kim1990.chart import EXAMPLE, require_kim
from core.papers.kim1990.sheets import (
    CHART,
    DISPLACEMENT,
    ELEVEN,
    FORCES,
    HISTORIES,
    LINEARISATION,
    MEAN,
    MEAN_SLOPE,
    PSI,
)

WHOLE = "parametric resonance at 1/N of the shaft's frequency: η ≈ 1, 2, 3, 4, 5"
SMALL = "for Q up to 0.1 the mean wind-up stays within 0.02; it grows with Q"

_POINTS = tuple(
    Row(
        f"Fig. {number}",
        f"η = {eta:.2f}, Q = {q:.2f} is {'stable' if stable else 'unstable'}",
        chart.point(number),
        judge.figure,
        EXAMPLE,
        HISTORIES[number],
    )
    for number, eta, q, stable in chart.FIGURES
)

ROWS = (
    Row("Fig. 3, §1", "the wind-up spoils the follower's motion and tires the shaft", chart.follower_error, judge.follower_error, EXAMPLE,
        LINEARISATION),
    Row("(1)", "Ic d²θc/dt² + Kc (θc - θi) = Tc", equations.shaft_spring, named(AS_SCANNED,
        "{symbol} here and in the sentence before it, {fitting} in the list of symbols, in (8), (12) and (17): along the solution of Fig. "
        "9 (1) holds with a stiffness of {needed:.6f} Ic ω² = η² Ic ω², by (12) that of {fitting}"), EXAMPLE),
    Row("(3), Fig. 2", "Fc = Mv Ẋ + Kv X", equations.contact_force, mended(AS_SCANNED,
        "Ẍ for Ẋ, a dot that the scan may have lost: as printed the largest force is {printed_largest:.3g} N, off by {printed:.2g} of the "
        "largest, {largest:.4g} N; with Ẍ it is Newton-Euler's to {corrected:.1g}"), EXAMPLE, FORCES),
    Row("(4), Fig. 2", "Tc = Mv X'² θc + Mv X''X' θc² + Kv XX'", equations.cam_torque, mended(MISPRINT,
        "by (3) and (1) Tc = -Fc X' = -(Mv X'² d²θc/dt² + Mv X''X' (dθc/dt)² + Kv XX'): without the minus and the dots of θc, which the "
        "scan may have lost, it is off by {printed:.2g} of the largest, {largest:.4g} N·m; corrected it is that of the energies to "
        "{corrected:.1g}"), EXAMPLE, FORCES),
    Row("(5)", "(Fs)max = Kv Xm > |Mm Ẍm|", equations.spring_mass, named(MISPRINT,
        "{fitting} for {symbol}: the softest spring with which the follower stays on the cam, a = {factor:.6f} in (7), has "
        "Kv Xm/Ẍm = {needed:.6g} kg, the follower's mass; what Mv or Mm mean the paper says nowhere"), EXAMPLE),
    Row("(8)", "the right side is -a Mv X''m (dθi/dt)² X'/Xm", equations.load_without_x, mended(MISPRINT,
        "X is missing: XX'/Xm; as printed it is a force, which in SI leaves {printed:.3g} of the spring's largest torque along the "
        "solution of Fig. 9, with X {corrected:.1g}"), EXAMPLE),
    Row("(13)", "the spring's term is -4π²η²β", chart.spring_growth, judge.spring_sign, EXAMPLE),
    Row("(13), right side", "2πQ a X''m XX'/Xm over 1 + Q (X'/X'm)²", equations.load_without_slope, mended(MISPRINT,
        "X'm² is missing below, which (21) and (22) have, a factor of {times:,.0f} for this cam in SI: along the solution of Fig. 9 (13) "
        "as printed leaves {printed:.2g} of the spring's largest torque, with it {corrected:.1g}"), EXAMPLE),
    Row("(14), Fig. 3", "Ie d²θc/dt² + Ce (dθc/dt)² = 0", equations.rigid_turn, mended(MISPRINT,
        "θc = θi - 2πβ belongs there: along the solution of Fig. 9 the printed sum leaves {printed:.2g} of the spring's largest "
        "torque; with the corrected line (17) leaves {corrected:.1g}"), EXAMPLE, LINEARISATION),
    Row("(15), (16), (20)", "dθc/dt = dθi/dt - 2πβ, d²θc/dt² = -2πβ', β = exp(-½ ∫ 2 Ce θi/Ie dτ) ζ", equations.rates, mended(AS_SCANNED,
        "dβ/dt, d²β/dt² and dθi/dt, dots that the scan may have lost: as printed each is off by {printed:.2g} of its largest or more, with "
        "the dots by {corrected:.1g} or less"), EXAMPLE),
    Row("(17)", "the right side is -Me, Me = -a Mv X''m (dθi/dt)² XX'/Xm", equations.load_sign, mended(MISPRINT,
        "Me without its minus: along the solution of Fig. 9 (17) as printed leaves {printed:.2g} of the spring's largest torque, "
        "with the other sign {corrected:.1g}"), EXAMPLE),
    Row("(18)", "the right side is -[Me + Ce (dθi/dt)²]/2π", equations.linear_load, mended(MISPRINT,
        "[Ce (dθi/dt)² - Me]/2π, as (19) has it: along the solution of Fig. 9 (18) as printed leaves {printed:.2g} of the spring's largest "
        "torque, with that sign {corrected:.1g}, once the square of dβ/dt is added that it drops"), EXAMPLE),
    Row("(19)", "[Ks + Ce (dθi/dt)² - Me'] β", equations.slope_of_c, mended(AS_SCANNED,
        "Ce' for Ce, a prime that the scan may have lost: the slope of Ce by differences is off by {printed:.2g} of its largest from Ce, "
        "by {corrected:.1g} from Ce'"), EXAMPLE),
    Row("(22)", "ψ holds X''X'' + X'²", chart.load_means, judge.load_slope, EXAMPLE, PSI),
    Row("(21) → (22)", "(22) stands for (21) where Q ≪ 1", chart.approximation, judge.approximation, EXAMPLE, CHART),
    Row("(27), G0", "G0 = γ² + Ψ0 Q", equations.constant_term, mended(MISPRINT,
        "η² for γ²: at the first edge of (22), η = {eta:.6f}, the determinant must vanish; its smallest eigenvalue is {printed:.3g} "
        "as printed and {corrected:.1g} with η²"), EXAMPLE),
    Row("(27), Gk", "Gk = Ψk = Q", equations.other_terms, mended(MISPRINT,
        "Gk = Ψk Q: at the first edge of (22), η = {eta:.6f}, the smallest eigenvalue is {printed:.3g} as printed and "
        "{corrected:.1g} with Ψk Q"), EXAMPLE),
    Row("(28)", "|K| ≅ … ρ-2 ρ-1 π0 ρ1 ρ2 … = 0", equations.diagonal, mended(AS_SCANNED,
        "ρ0 for π0, as the scan may have read it: at Q = 0, η = {eta:g} the determinant is the product with ρ0 (to {corrected:.1g}); with "
        "π in its place it is off by {printed:.2g} of it"), EXAMPLE),
    Row("(29)", "γ = 2π(η - r)", equations.exponent, mended(AS_SCANNED,
        "γ = 2πj(η - r), a j that the scan may have lost: at η = {eta:g}, r = 1, ρ1 must vanish; it is {printed:.3g} as printed and "
        "{corrected:.1g} with j"), EXAMPLE),
    Row("(33), Fig. 4", "X, X' and X'' of the single harmonic cam, then a dwell", equations.profile, kept(
        "the printed curves are those of the example to {off:.1g} of their largest"), EXAMPLE, DISPLACEMENT),
    Row("(23), Fig. 5", "Ψ(y) = a X''m (X''X + X'²)/(X'm² Xm)", equations.load_slope, kept(
        "the slope of the spring's torque is that to {off:.1g} of its largest, {largest:.4g}; its mean is {mean:.1g}"), EXAMPLE, PSI),
    Row("Figs. 6, 7", SMALL, chart.means, judge.wind_up, EXAMPLE, MEAN),
    Row("Figs. 6, 7, contact", "the follower stays on the cam for Q below 0.1 and leaves it above", chart.losses, judge.contact, EXAMPLE,
        MEAN_SLOPE),
    Row("§6 (1)", "the wind-up stays within 0.02 turns, so that linearising it is safe", chart.later_turns, judge.later_turns, EXAMPLE,
        HISTORIES[12]),
    Row("§6 (2)", "ten harmonics, an 11 x 11 matrix, give the edges", chart.eleven, judge.eleven, EXAMPLE, ELEVEN),
    Row("Fig. 8, §7, places", WHOLE, chart.at_q_with_errors, judge.whole_numbers_only, EXAMPLE, CHART),
    Row("Fig. 8", "the tongues at η ≈ 1 and 2 are much wider than the others", chart.at_q, judge.widest, EXAMPLE, CHART),
    Row("Fig. 8, §7, Q", "tongues widen with Q", chart.growing, judge.widen_with_q, EXAMPLE, CHART),
    Row("Fig. 8, §7, speed", "tongues widen towards the natural frequency (small η)", chart.at_q_in_both, judge.widen_with_speed, EXAMPLE,
        CHART),
    *_POINTS,
    Row("§6, Figs. 9-12", "the histories say the same as the chart of Fig. 8", chart.histories_and_chart, judge.histories_and_chart,
        EXAMPLE, CHART),
)  # fmt: skip
"""Every row of the paper."""

__all__ = ["EXAMPLE", "ROWS", "require_kim"]
