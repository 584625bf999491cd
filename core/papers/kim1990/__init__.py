"""Kim, Jeon, Lee and Park 1990, dynamic stability of a single cam drive: its statements in the order of the paper."""

from core.papers.claim import Row, kept, misprint
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
    Row("(3), Fig. 2", "Fc = Mv Ẋ + Kv X", equations.contact_force, misprint(
        "Ẍ for Ẋ: as printed the largest force is {printed_largest:.3g} N, off by {printed:.2g} of the largest, {largest:.4g} N; "
        "with Ẍ it is Newton-Euler's to {corrected:.1g}"), EXAMPLE, FORCES),
    Row("(4), Fig. 2", "Tc = Mv X'² θc + Mv X''X' θc² + Kv XX'", equations.cam_torque, misprint(
        "Tc = -Fc X' = -(Mv X'² θ̈c + Mv X''X' θ̇c² + Kv XX'): without the dots and the sign it is off by {printed:.2g} of the "
        "largest, {largest:.4g} N·m; corrected it is that of the energies to {corrected:.1g}"), EXAMPLE, FORCES),
    Row("(5)", "(Fs)max = Kv Xm > |Mm Ẍm|", equations.spring_mass, misprint(
        "Mv for Mm, which is explained nowhere: the mass that (5) and (7) have in common is {ratio:.6f} Mv = {mass:.4g} kg")
        , EXAMPLE),
    Row("(13)", "the spring's term is -4π²η²β", chart.spring_growth, judge.spring_sign, EXAMPLE),
    Row("(14), Fig. 3", "Ie θ̈c + Ce θ̇c² = 0", equations.rigid_turn, misprint(
        "θc = θi - 2πβ belongs there: along the solution of Fig. 9 the printed sum leaves {printed:.2g} of the spring's largest "
        "torque; with the corrected line (17) leaves {corrected:.1g}"), EXAMPLE, LINEARISATION),
    Row("(17)", "the right side is -Me, Me = -a Mv X''m ω² XX'/Xm", equations.load_sign, misprint(
        "Me without its minus: along the solution of Fig. 9 (17) as printed leaves {printed:.2g} of the spring's largest torque, "
        "with the other sign {corrected:.1g}"), EXAMPLE),
    Row("(18)", "the right side is -[Me + Ce θ̇i²]/2π", equations.linear_load, misprint(
        "[Ce θ̇i² - Me]/2π, as (19) has it: along the solution of Fig. 9 (18) as printed leaves {printed:.2g} of the spring's largest "
        "torque, with that sign {corrected:.1g}, once the square of β̇ is added that it drops"), EXAMPLE),
    Row("(19)", "[Ks + Ce θ̇i² - Me'] β", equations.slope_of_c, misprint(
        "Ce' for Ce: the slope of Ce by differences is off by {printed:.2g} of its largest from Ce, by {corrected:.1g} from Ce'")
        , EXAMPLE),
    Row("(22)", "ψ holds X''X'' + X'²", chart.load_means, judge.load_slope, EXAMPLE, PSI),
    Row("(21) → (22)", "(22) stands for (21) where Q ≪ 1", chart.approximation, judge.approximation, EXAMPLE, CHART),
    Row("(27), G0", "G0 = γ² + Ψ0 Q", equations.constant_term, misprint(
        "η² for γ²: at the first edge of (22), η = {eta:.6f}, the determinant must vanish; its smallest eigenvalue is {printed:.3g} "
        "as printed and {corrected:.1g} with η²"), EXAMPLE),
    Row("(27), Gk", "Gk = Ψk = Q", equations.other_terms, misprint(
        "Gk = Ψk Q: at the first edge of (22), η = {eta:.6f}, the smallest eigenvalue is {printed:.3g} as printed and "
        "{corrected:.1g} with Ψk Q"), EXAMPLE),
    Row("(28)", "|K| ≅ … ρ-2 ρ-1 π0 ρ1 ρ2 … = 0", equations.diagonal, misprint(
        "ρ0 for π0: at Q = 0, η = {eta:g} the determinant is the product with ρ0 (to {corrected:.1g}); with π in its place it is "
        "off by {printed:.2g} of it"), EXAMPLE),
    Row("(29)", "γ = 2π(η - r)", equations.exponent, misprint(
        "γ = 2πj(η - r): at η = {eta:g}, r = 1, ρ1 must vanish; it is {printed:.3g} as printed and {corrected:.1g} with j"), EXAMPLE),
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
    Row("Fig. 8, §7, speed", "tongues widen towards the natural frequency (small η)", chart.at_q, judge.widen_with_speed, EXAMPLE, CHART),
    *_POINTS,
    Row("§6, Figs. 9-12", "the histories say the same as the chart of Fig. 8", chart.histories_and_chart, judge.histories_and_chart,
        EXAMPLE, CHART),
    Row("§7", "harmonic balance saves much time against direct integration", chart.effort, judge.effort, EXAMPLE, CHART),
)  # fmt: skip
"""Every row of the paper."""

__all__ = ["EXAMPLE", "ROWS", "require_kim"]
