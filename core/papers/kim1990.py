"""Kim, Jeon, Lee and Park 1990, dynamic stability of a single cam drive: its statements in the order of the paper."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import exp

import numpy as np

from core.papers import kim1990_chart as chart
from core.papers import kim1990_equations as equations
from core.papers.claim import (
    AGREES,
    AS_SCANNED,
    METHOD,
    MISPRINT,
    Examples,
    FigureTable,
    Judgement,
    PaperFigure,
    Row,
    agreement,
    corrected_print,
    correction_verdict,
    plot_figure,
    table_by_column,
    within_bound,
    wrong_symbol,
)
from core.papers.kim1990_chart import EXAMPLE, FIGURES, averages, eleven, run_of, shaft_of
from core.papers.kim1990_chart import ROWS as CHART_ROWS
from core.papers.kim1990_equations import forces
from core.plot import Plot, PlotCurve
from core.stability import (
    EQUATIONS,
    ETA_MAX,
    Chart,
    averages_plots,
    coefficients_plot,
    count_up_to,
    history_plot,
    tongues,
)
from core.stability import chart as stability_chart
from core.stability.coefficients import APPROXIMATE, EXACT
from core.stability.critical_speeds import CAM_ANGLE, Columns, averages_columns, coefficients_columns, windup_columns
from core.stability.stage import FROM_REST, STABLE, STEADY, UNSTABLE, Verdict

# -- judges of the claims ---------------------------------------------------------------------------------------

ROUNDING = 1e-12
NEAR = 0.1  # of a tongue's width: greatest error of an edge that is drawn correctly
SMALL_ERROR = 0.01  # of the stroke: a larger error disturbs a motion
SMALL_Q, SMALL_WIND_UP = 0.1, 0.02
"""Kim1990 §6 (1): greatest Q of the claim, and greatest mean wind-up."""

Loss = tuple[float, float, float | None]
"""η, Q, and y at which the follower leaves the cam, None where it stays on the cam."""


def _eta(n: int) -> str:
    return f"{0.5 * n:g}"


def spring_sign(eta: float, printed: float, corrected: float) -> Judgement:
    """Judge (13): logarithm of the growth of β in a turn with the spring's term as printed and with the other sign."""
    return correction_verdict(MISPRINT, printed > ROUNDING, corrected > ROUNDING), (
        f"+4π²η²β: as printed any shaft would run away, by {exp(printed):.3g} a turn at η = {eta:g}, "
        f"and by {exp(corrected):.3g} with the other sign"
    )


def load_slope(printed: float, corrected: float, trace_as_printed: float, trace: float) -> Judgement:
    """Judge (22): mean of ψ as printed and with X''X for X''X'', and the traces at the point of Fig. 12."""
    words = {True: STABLE, False: UNSTABLE}
    return correction_verdict(MISPRINT, abs(printed) > ROUNDING, abs(corrected) > ROUNDING), (
        f"X''X + X'²: ψ is the slope of a periodic torque, so its mean is 0; as printed it is {printed:.3g}, and at the "
        f"point of Fig. 12 (22) is {words[abs(trace_as_printed) <= 2.0]}, trace {trace_as_printed:.4f}; corrected it is "
        f"{words[abs(trace) <= 2.0]}, {trace:.4f}"
    )


def judge_approximation(q: float, approximate: np.ndarray, exact: np.ndarray) -> Judgement:
    """Judge (21) → (22): whether the tongues of both have a common η; if not, dropping D and C separates them.

    Parameters
    ----------
    q : float
    approximate, exact : ndarray (11, 2), dimensionless
        Edges η of the tongues.
    """
    disjoint = 1 + np.flatnonzero((exact[:, 0] > approximate[:, 1]) | (approximate[:, 0] > exact[:, 1]))
    approximate_shift, shift = ((edges.mean(axis=1) - 0.5 * np.arange(1, 12)) / q for edges in (approximate, exact))
    return AGREES if disjoint.size == 0 else METHOD, (
        f"D → 1 and C → 0 are not right to the first order in Q: the tongues of the exact form (21) move with it by "
        f"{shift[3]:.3f} Q for n = 4 and "
        f"{shift[10]:.3f} Q for n = 11, those of the approximation (22) do not move (n = 4: {approximate_shift[3]:.3f} Q); "
        f"at Q = {q:g} they have nothing in common "
        f"for n = {', '.join(map(str, disjoint)) or 'none'}"
    )


def whole_numbers_only(q: float, widths: np.ndarray, errors: np.ndarray) -> Judgement:
    """Judge Fig. 8: whether only the tongues at integer η are open.

    Parameters
    ----------
    q : float
    widths, errors : ndarray (11,), dimensionless
        Widths of the tongues in η, and the bounds of their errors.
    """
    is_open = widths > errors
    between = [n for n in range(1, 12, 2) if is_open[n - 1]]
    sizes = ", ".join(f"{widths[n - 1]:.4f} at {_eta(n)}" for n in between[:3]) or "none open between them"
    return agreement(is_open[1::2].all() and not between), (
        f"at 2/N, η ≈ n/2: the dwell gives ψ odd harmonics; by the approximation (22), the equation of Fig. 8, "
        f"widths at Q = {q:g}: {sizes}"
    )


def widest(q: float, widths: np.ndarray) -> Judgement:
    """Judge Fig. 8: whether the tongues n = 2 and 4, at η ≈ 1 and 2, are wider than every other.

    Parameters
    ----------
    q : float
    widths : ndarray (11,), dimensionless
        Widths of the tongues in η.
    """
    order = np.argsort(-widths, kind="stable")[:4] + 1
    sizes = ", ".join(f"{_eta(n)} ({widths[n - 1]:.4f})" for n in order)
    named = ", ".join(f"{widths[n - 1]:.2g} at {_eta(n)}" for n in range(2, 9, 2))
    return agreement(widths[[1, 3]].min() > np.delete(widths, [1, 3]).max()), (
        f"by the approximation (22), the equation of Fig. 8, the widest at Q = {q:g} are at η ≈ {sizes}; "
        f"at the integer η alone, which the paper names, "
        f"{named}"
    )


def widen_with_q(q: np.ndarray, small: np.ndarray, large: np.ndarray) -> Judgement:
    """Judge Fig. 8: whether each tongue is wider at the larger of two Q.

    Parameters
    ----------
    q : ndarray (2,), dimensionless
    small, large : ndarray (11,), dimensionless
        Widths of the tongues in η at the smaller and the larger Q.
    """
    wider = large > small
    return agreement(wider.all()), (
        f"by the approximation (22), the equation of Fig. 8, {int(wider.sum())} of {small.size} are wider at Q = {q[1]:g} "
        f"than at {q[0]:g}"
    )


def widen_with_speed(q: float, widths: np.ndarray, exact: np.ndarray) -> Judgement:
    """Judge Fig. 8: whether each tongue at an integer η, which the claim is about, is wider than the next.

    Parameters
    ----------
    q : float
    widths, exact : ndarray (11,), dimensionless
        Widths of the tongues in η by (22) and by (21).
    """
    sizes, others = (
        ", ".join(f"{row[n - 1]:.2e} at η ≈ {_eta(n)}" for n in range(2, 11, 2)) for row in (widths, exact)
    )
    return agreement((np.diff(widths[1::2]) < 0.0).all()), (
        f"by the approximation (22), the equation of Fig. 8, widths at Q = {q:g}: {sizes} (by the exact form (21): "
        f"{others})"
    )


def judge_eleven(q: float, off: np.ndarray, widths: np.ndarray) -> Judgement:
    """Judge §6 (2): whether the 11 x 11 matrix gives every edge within a part of the tongue's width.

    Parameters
    ----------
    q : float
    off : ndarray (11,), dimensionless
        Errors of the edges η; infinite where the matrix has no such edge.
    widths : ndarray (11,), dimensionless
        Widths of the tongues in η.
    """
    good = off <= NEAR * widths
    poor = [int(i) for i in np.flatnonzero(~good)]
    far = [f"{off[i] / widths[i]:.2g} of it at {_eta(i + 1)}" for i in poor if np.isfinite(off[i])]
    lacking = [_eta(i + 1) for i in poor if np.isinf(off[i])]
    return agreement(good.all()), "; ".join(
        [f"at Q = {q:g} within {NEAR:g} of their own width for n = {', '.join(map(str, 1 + np.flatnonzero(good)))}"]
        + ([f"the edges of the approximation (22) are off by {', '.join(far)} (η)"] if far else [])
        + ([f"at η ≈ {', '.join(lacking)} the matrix has one edge only"] if lacking else [])
    )


def wind_up(q: np.ndarray, means: np.ndarray, slopes: np.ndarray) -> Judgement:
    """Judge Figs. 6, 7: whether the means of the first turn from rest grow with Q and are small up to Q = 0.1.

    Parameters
    ----------
    q : ndarray (rows,), dimensionless
    means : ndarray (rows, n) [turns]
        Mean |β| by η.
    slopes : ndarray (rows, n), dimensionless
        Mean |β'| by η.
    """
    rising = (np.diff(means, axis=0) > 0.0).all() and (np.diff(slopes[:3], axis=0) > 0.0).all()
    largest = means[q <= SMALL_Q].max()
    return agreement(rising and largest <= SMALL_WIND_UP), (
        f"the mean of the first turn from rest is at most {largest:.4f} for η = 0.5 ... 5; later turns reach more (Figs. 9-12)"
    )


def contact(q: np.ndarray, is_lost: np.ndarray, later: Sequence[Loss]) -> Judgement:
    """Judge Figs. 6, 7: whether the follower stays on the cam up to Q = 0.1 and leaves it above.

    Parameters
    ----------
    q : ndarray (rows,), dimensionless
        Rising.
    is_lost : ndarray (rows,) of bool, dimensionless
        Whether it leaves the cam in the first turn.
    later : sequence of Loss
        Losses of contact in the turns of Figs. 9-12.
    """
    small = q <= SMALL_Q
    stays = not is_lost[small].any() and all(y is None for _, point_q, y in later if point_q <= SMALL_Q)
    points = [f"(η = {eta:.2f}, Q = {point_q:.2f}) from y = {y:.4f}" for eta, point_q, y in later if y is not None]
    least = f"Q = {q[is_lost][0]:g}" if is_lost.any() else "none of these Q"
    return agreement(stays and is_lost[~small].all()), (
        f"in the first turn, which these figures average, it leaves it from {least} on; later it does at "
        f"{' and at '.join(points) or 'none of the points of Figs. 9-12'} (the calculation of the wind-up does not contain its flight)"
    )


_SHORT: Mapping[str, str] = {
    APPROXIMATE: "approximate (22)",
    EXACT: "exact (21)",
    STEADY: "steady response",
    FROM_REST: "from rest",
}


def figure(stable: bool, models: Sequence[Verdict], rest: Verdict, readings: Mapping[str, bool]) -> Judgement:
    """Judge Figs. 9-12: a point of the chart in every model; the last of models, the steady response, decides.

    ``stable`` is the paper's statement. Where no model agrees, the sentence says whether a reading of its print does.
    """
    says = STABLE if stable else UNSTABLE
    states = "; ".join(
        f"{_SHORT[v.model]} {v.state}{_growth_text(v)}{_loss_text(v, 'it leaves the cam at', ' of each turn')}"
        for v in models
    )
    print_text = ""
    if all(v.state != says for v in models):
        agreeing = [name for name, is_stable in readings.items() if is_stable == stable]
        so = f"{' and '.join(agreeing)} {'make' if len(agreeing) > 1 else 'makes'} it so" if agreeing else "makes it so"
        print_text = (
            f"; of {len(readings)} readings of the print {'' if agreeing else 'none '}{so}: {', '.join(readings)}"
        )
    loss = _loss_text(rest, "follower off the cam from")
    return agreement(models[-1].state == says), (
        f"{states}; from rest max|β| = {rest.largest:.6f} in 30 turns{loss}{print_text}"
    )


def _growth_text(verdict: Verdict) -> str:
    return f", e^{verdict.growth:.3f} a turn" if verdict.state == UNSTABLE else ""


def _loss_text(verdict: Verdict, words: str, after: str = "") -> str:
    return "" if verdict.contact_lost is None else f", {words} y = {verdict.contact_lost:.4f}{after}"


def judge_follower_error(stroke: float, twist: float, torque: float) -> Judgement:
    """Judge §1: error of the follower relative to its stroke, and twist [turns] and torque [N m] of the shaft."""
    return agreement(stroke > SMALL_ERROR and torque > 0.0), (
        f"at the point of Fig. 9 the follower's error is {stroke:.3f} of its stroke, and the shaft's torque up to "
        f"±{torque:.3g} N·m (twist {twist:.4f} turns)"
    )


def judge_later_turns(points: Sequence[tuple[float, float, float]]) -> Judgement:
    """Judge §6 (1): whether the wind-up of later turns stays as small as the mean of the first one."""
    words = ", ".join(f"{largest:.4f} at ({eta:.2f}, {q:.2f})" for eta, q, largest in points)
    return agreement(all(largest <= SMALL_WIND_UP for *_, largest in points)), (
        f"only the mean of the first turn is so small; in 30 turns it reaches {words} (η, Q)"
    )


def judge_histories_and_chart(points: Sequence[tuple[int, str, str]]) -> Judgement:
    """Judge §6: whether histories from rest and the chart of (22) agree at each point."""
    states = "; ".join(
        f"Fig. {number}: {chart} by the approximation (22), from rest {rest}" for number, chart, rest in points
    )
    return agreement(all(chart == rest for _, chart, rest in points)), states


# -- figures ----------------------------------------------------------------------------------------------------

UNSEEN = 1e-5  # error of an edge η that is invisible in an image
PROFILE = {"displacement": "displacement X", "velocity": "velocity X'", "acceleration": "acceleration X''"}


def _table(columns: Columns) -> FigureTable:
    return FigureTable(tuple(columns[0]), tuple(columns[1]))


def _sheet(
    number: int, title: str, table: Callable[[Examples], FigureTable], plots: Callable[[Examples], tuple[Plot, ...]]
) -> PaperFigure:
    full = f"Kim1990 Fig. {number}: {title}"
    return plot_figure(f"figure_{number}", full, table, plots)


# -- Figs. 2 to 5 -------------------------------------------------------------------------------------------


def _forces_table(examples: Examples) -> FigureTable:
    f = forces(examples)
    names = ("force", "force printed", "torque", "torque printed")
    columns = ("contact_force_n", "contact_force_as_printed_n", "cam_torque_nm", "cam_torque_as_printed_nm")
    return FigureTable(("cam_angle_deg", *columns), (np.rad2deg(f["theta"]), *(f[name] for name in names)))


def _forces(examples: Examples) -> tuple[Plot, ...]:
    f = forces(examples)
    degrees = np.concatenate(([0.0], np.rad2deg(f["theta"]), [360.0]))

    def full_turn(name: str) -> np.ndarray:
        return np.concatenate((f[name][:1], f[name], f[name][-1:]))

    axes = (("force", "Contact force Fc, N"), ("torque", "Torque Tc on the cam, N·m"))
    return tuple(
        Plot(
            CAM_ANGLE,
            axis,
            (
                PlotCurve(degrees, full_turn(what), "here"),
                PlotCurve(degrees, full_turn(f"{what} printed"), "as printed", 1, True),
            ),
        )
        for what, axis in axes
    )


def _angles(examples: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Input and cam angle (n,) [deg] over the first turn of Fig. 12."""
    y = np.arange(721) / 720.0
    return 360.0 * y, 360.0 * (y - run_of(examples, 12).at(y)[0])


def _angles_table(examples: Examples) -> FigureTable:
    ideal, actual = _angles(examples)
    return FigureTable(("input_angle_deg", "cam_angle_deg", "twist_deg"), (ideal, actual, ideal - actual))


def _linearisation(examples: Examples) -> tuple[Plot, ...]:
    ideal, actual = _angles(examples)
    both = (PlotCurve(ideal, ideal, "θi, the angle of linearisation", 1, True), PlotCurve(ideal, actual, "θc"))
    return Plot("Input angle θi, °", "Angle, °", both), Plot(
        "Input angle θi, °", "2πβ = θi - θc, °", (PlotCurve(ideal, ideal - actual),)
    )


def _profile(examples: Examples) -> dict[str, np.ndarray]:
    """X, X', X'' relative to their largest values (n,) by cam angle [deg]."""
    study, sizes = examples.study(EXAMPLE), shaft_of(examples).coefficients.sizes
    y = study.motion.displacement
    parts = (y[0] - sizes.lowest) / sizes.stroke, y[1] / sizes.slope, y[2] / sizes.curvature
    return {"cam_angle_deg": study.angle_degrees, **dict(zip(PROFILE, parts, strict=True))}


def _profile_plots(examples: Examples) -> tuple[Plot, ...]:
    """Plot to the end of the dwell; X'' jumps where the next turn begins."""
    degrees, *rows = _profile(examples).values()
    around = np.append(degrees, 360.0)
    curves = tuple(
        PlotCurve(around, np.append(row, row[-1:]), label, i, family=name)
        for i, (row, (name, label)) in enumerate(zip(rows, PROFILE.items(), strict=True))
    )
    return (Plot(CAM_ANGLE, "Relative to the largest", curves),)


# -- Figs. 6 to 12 ------------------------------------------------------------------------------------------


def _averages_table(examples: Examples) -> FigureTable:
    return _table(averages_columns(averages(examples, CHART_ROWS)))


def _chart(examples: Examples) -> Chart:
    return stability_chart(shaft_of(examples).coefficients, None, CHART.title, eta_max=ETA_MAX, error=UNSEEN)


def _tongues(examples: Examples) -> FigureTable:
    """Edges by Q, of (21) and of (22)."""
    shaft, q = shaft_of(examples), np.arange(1, 25) / 200.0
    count = count_up_to(ETA_MAX)
    columns: list[list[float]] = [[], [], [], [], []]
    for number, equation in enumerate(EQUATIONS):
        edges = tongues(shaft.coefficients, q, count, equation, error=1e-9).edges
        for i, q_value in enumerate(q.tolist()):
            for n in range(count):
                for column, value in zip(
                    columns, (float(number == 0), q_value, n + 1.0, *edges[i, n].tolist()), strict=True
                ):
                    column.append(value)
    words = tuple(EQUATIONS[list(EQUATIONS)[0 if is_first else 1]] for is_first in columns[0])
    return FigureTable(
        ("equation", "q", "n", "eta_low", "eta_high"), (words, *(np.array(column) for column in columns[1:]))
    )


def _eleven(examples: Examples) -> FigureTable:
    """Errors of the edges of the 11 x 11 matrix relative to (22), with the widths of the tongues."""
    numbers = eleven(examples)
    n = np.arange(1, numbers["off"].size + 1)

    def texts(values: np.ndarray) -> tuple[str, ...]:
        return tuple(f"{value:.6g}" if np.isfinite(value) else "one edge only" for value in values.tolist())

    off, widths = numbers["off"], numbers["widths"]
    columns = (n.astype(float), 0.5 * n, texts(off), widths, texts(off / widths))
    return FigureTable(
        ("n", "eta", "edge_off_by", "width", "part_of_width"),
        columns,
        f"Edges of the 11 x 11 matrix, Q = {numbers['q']:g}",
    )


def _history(number: int) -> PaperFigure:
    index = [figure[0] for figure in FIGURES].index(number)
    _, eta, q, _ = FIGURES[index]
    return _sheet(
        number,
        f"wind-up from rest at η = {eta:.2f}, Q = {q:.2f}",
        lambda examples: _table(windup_columns([run_of(examples, number)])),
        lambda examples: (history_plot(run_of(examples, number)),),
    )


FORCES = _sheet(2, "contact force and torque on the cam", _forces_table, _forces)
LINEARISATION = _sheet(3, "the angle about which it is linearised", _angles_table, _linearisation)
DISPLACEMENT = _sheet(4, "profile of the single harmonic cam", lambda e: table_by_column(_profile(e)), _profile_plots)
PSI = _sheet(
    5,
    "the periodic function ψ, a = 1.5",
    lambda examples: _table(coefficients_columns(shaft_of(examples).coefficients)),
    lambda examples: (coefficients_plot(shaft_of(examples).coefficients, ("ψ",)),),
)
MEAN = _sheet(
    6, "mean of |β| through the first turn", _averages_table, lambda e: averages_plots(averages(e, CHART_ROWS))[:1]
)
MEAN_SLOPE = _sheet(
    7, "mean of |dβ/dy| through the first turn", _averages_table, lambda e: averages_plots(averages(e, CHART_ROWS))[1:]
)
CHART = PaperFigure("figure_8", "Kim1990 Fig. 8: regions of instability", _tongues, _chart)
ELEVEN = PaperFigure("section_6_2", "Kim1990 §6 (2): edges of the 11 x 11 matrix", _eleven)
HISTORIES = {figure[0]: _history(figure[0]) for figure in FIGURES}


# -- rows of claims ---------------------------------------------------------------------------------------------

INTEGERS = "parametric resonance at 1/N of the shaft's frequency: η ≈ 1, 2, 3, 4, 5"
SMALL = "for Q up to 0.1 the mean wind-up stays within 0.02; it grows with Q"

_POINTS = tuple(
    Row(
        f"Fig. {number}",
        f"η = {eta:.2f}, Q = {q:.2f} is {'stable' if stable else 'unstable'}",
        chart.point(number),
        figure,
        EXAMPLE,
        HISTORIES[number],
    )
    for number, eta, q, stable in chart.FIGURES
)

ROWS = (
    Row("Fig. 3, §1", "the wind-up disturbs the follower's motion and loads the shaft", chart.follower_error, judge_follower_error, EXAMPLE,
        LINEARISATION),
    Row("(1)", "Ic d²θc/dt² + Kc (θc - θi) = Tc", equations.shaft_spring, wrong_symbol(AS_SCANNED,
        "{symbol} here and in the sentence before it, {fitting} in the list of symbols, in (8), (12) and (17): along the solution of Fig. "
        "9 (1) holds with a stiffness of {needed:.6f} Ic ω² = η² Ic ω², by (12) that of {fitting}"), EXAMPLE),
    Row("(3), Fig. 2", "Fc = Mv Ẋ + Kv X", equations.print_errors("force"), corrected_print(AS_SCANNED,
        "Ẍ for Ẋ, a dot that the scan may have lost: as printed the largest force is {printed_largest:.3g} N, off by {printed:.2g} of the "
        "largest, {largest:.4g} N; with Ẍ it is Newton-Euler's to {corrected:.1g}"), EXAMPLE, FORCES),
    Row("(4), Fig. 2", "Tc = Mv X'² θc + Mv X''X' θc² + Kv XX'", equations.print_errors("torque"), corrected_print(MISPRINT,
        "by (3) and (1) Tc = -Fc X' = -(Mv X'² d²θc/dt² + Mv X''X' (dθc/dt)² + Kv XX'): without the minus and the dots of θc, which the "
        "scan may have lost, it is off by {printed:.2g} of the largest, {largest:.4g} N·m; corrected it is that of the energies to "
        "{corrected:.1g}"), EXAMPLE, FORCES),
    Row("(5)", "(Fs)max = Kv Xm > |Mm Ẍm|", equations.spring_mass, wrong_symbol(MISPRINT,
        "{fitting} for {symbol}: the softest spring with which the follower stays on the cam, a = {factor:.6f} in (7), has "
        "Kv Xm/Ẍm = {needed:.6g} kg, the follower's mass; the paper does not define Mv or Mm"), EXAMPLE),
    Row("(8)", "the right side is -a Mv X''m (dθi/dt)² X'/Xm", equations.load_without_x, corrected_print(MISPRINT,
        "X is missing: XX'/Xm; as printed it is a force, which in SI leaves {printed:.3g} of the spring's largest torque along the "
        "solution of Fig. 9, with X {corrected:.1g}"), EXAMPLE),
    Row("(13)", "the spring's term is -4π²η²β", chart.spring_growth, spring_sign, EXAMPLE),
    Row("(13), right side", "2πQ a X''m XX'/Xm over 1 + Q (X'/X'm)²", equations.load_without_slope, corrected_print(MISPRINT,
        "X'm² is missing below, which (21) and (22) have, a factor of {times:,.0f} for this cam in SI: along the solution of Fig. 9 (13) "
        "as printed leaves {printed:.2g} of the spring's largest torque, with it {corrected:.1g}"), EXAMPLE),
    Row("(14), Fig. 3", "Ie d²θc/dt² + Ce (dθc/dt)² = 0", equations.rigid_turn, corrected_print(MISPRINT,
        "θc = θi - 2πβ belongs there: along the solution of Fig. 9 the printed sum leaves {printed:.2g} of the spring's largest "
        "torque; with the corrected line (17) leaves {corrected:.1g}"), EXAMPLE, LINEARISATION),
    Row("(15), (16), (20)", "dθc/dt = dθi/dt - 2πβ, d²θc/dt² = -2πβ', β = exp(-½ ∫ 2 Ce θi/Ie dτ) ζ", equations.rates,
        corrected_print(AS_SCANNED,
        "dβ/dt, d²β/dt² and dθi/dt, dots that the scan may have lost: as printed each is off by {printed:.2g} of its largest or more, with "
        "the dots by {corrected:.1g} or less"), EXAMPLE),
    Row("(17)", "the right side is -Me, Me = -a Mv X''m (dθi/dt)² XX'/Xm", equations.load_sign, corrected_print(MISPRINT,
        "Me without its minus: along the solution of Fig. 9 (17) as printed leaves {printed:.2g} of the spring's largest torque, "
        "with the other sign {corrected:.1g}"), EXAMPLE),
    Row("(18)", "the right side is -[Me + Ce (dθi/dt)²]/2π", equations.linear_load, corrected_print(MISPRINT,
        "[Ce (dθi/dt)² - Me]/2π, as (19) has it: along the solution of Fig. 9 (18) as printed leaves {printed:.2g} of the spring's largest "
        "torque, with that sign {corrected:.1g}, once the square of dβ/dt is added that it drops"), EXAMPLE),
    Row("(19)", "[Ks + Ce (dθi/dt)² - Me'] β", equations.slope_of_c, corrected_print(AS_SCANNED,
        "Ce' for Ce, a prime that the scan may have lost: the slope of Ce by differences is off by {printed:.2g} of its largest from Ce, "
        "by {corrected:.1g} from Ce'"), EXAMPLE),
    Row("(22)", "ψ holds X''X'' + X'²", chart.load_means, load_slope, EXAMPLE, PSI),
    Row("(21) → (22)", "(22) stands for (21) where Q ≪ 1", chart.approximation, judge_approximation, EXAMPLE, CHART),
    Row("(27), G0", "G0 = γ² + Ψ0 Q", equations.constant_term, corrected_print(MISPRINT,
        "η² for γ²: at the first edge of (22), η = {eta:.6f}, the determinant must vanish; its smallest eigenvalue is {printed:.3g} "
        "as printed and {corrected:.1g} with η²"), EXAMPLE),
    Row("(27), Gk", "Gk = Ψk = Q", equations.other_terms, corrected_print(MISPRINT,
        "Gk = Ψk Q: at the first edge of (22), η = {eta:.6f}, the smallest eigenvalue is {printed:.3g} as printed and "
        "{corrected:.1g} with Ψk Q"), EXAMPLE),
    Row("(28)", "|K| ≅ … ρ-2 ρ-1 π0 ρ1 ρ2 … = 0", equations.diagonal, corrected_print(AS_SCANNED,
        "ρ0 for π0, as the scan may have read it: at Q = 0, η = {eta:g} the determinant is the product with ρ0 (to {corrected:.1g}); with "
        "π in its place it is off by {printed:.2g} of it"), EXAMPLE),
    Row("(29)", "γ = 2π(η - r)", equations.exponent, corrected_print(AS_SCANNED,
        "γ = 2πj(η - r), a j that the scan may have lost: at η = {eta:g}, r = 1, ρ1 must vanish; it is {printed:.3g} as printed and "
        "{corrected:.1g} with j"), EXAMPLE),
    Row("(33), Fig. 4", "X, X' and X'' of the single harmonic cam, then a dwell", equations.profile, within_bound(
        "the printed curves are those of the example to {off:.1g} of their largest"), EXAMPLE, DISPLACEMENT),
    Row("(23), Fig. 5", "Ψ(y) = a X''m (X''X + X'²)/(X'm² Xm)", equations.load_slope, within_bound(
        "the slope of the spring's torque is that to {off:.1g} of its largest, {largest:.4g}; its mean is {mean:.1g}"), EXAMPLE, PSI),
    Row("Figs. 6, 7", SMALL, chart.means, wind_up, EXAMPLE, MEAN),
    Row("Figs. 6, 7, contact", "the follower stays on the cam for Q below 0.1 and leaves it above", chart.losses, contact, EXAMPLE,
        MEAN_SLOPE),
    Row("§6 (1)", "the wind-up stays within 0.02 turns, so that linearising it is safe", chart.later_turns, judge_later_turns, EXAMPLE,
        HISTORIES[12]),
    Row("§6 (2)", "ten harmonics, an 11 x 11 matrix, give the edges", chart.eleven, judge_eleven, EXAMPLE, ELEVEN),
    Row("Fig. 8, §7, places", INTEGERS, chart.at_q_with_errors, whole_numbers_only, EXAMPLE, CHART),
    Row("Fig. 8", "the tongues at η ≈ 1 and 2 are much wider than the others", chart.at_q, widest, EXAMPLE, CHART),
    Row("Fig. 8, §7, Q", "tongues widen with Q", chart.growing, widen_with_q, EXAMPLE, CHART),
    Row("Fig. 8, §7, speed", "tongues widen towards the natural frequency (small η)", chart.at_q_in_both, widen_with_speed, EXAMPLE,
        CHART),
    *_POINTS,
    Row("§6, Figs. 9-12", "the histories say the same as the chart of Fig. 8", chart.histories_and_chart, judge_histories_and_chart,
        EXAMPLE, CHART),
)  # fmt: skip
"""Every row of the paper."""
