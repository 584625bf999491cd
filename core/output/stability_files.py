"""A flexible camshaft as files: its tables and report, its chart and other figures, and Kim1990's, with the paper's claims."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from textwrap import wrap

import numpy as np

from core.design import UNITS
from core.output.channels import ORBIT
from core.output.export import TONGUES, csv, table, texts, tongues_table
from core.output.report import report, shaft_report
from core.output.shaft_summary import shaft_summary
from core.output.summary import summary, to_json
from core.stability import (
    EQUATIONS,
    ETA_MAX,
    Averages,
    Chart,
    Claim,
    Curve,
    Figure,
    History,
    Plot,
    Stability,
    SteadyTurn,
    Stiffness,
    averages_plots,
    chart,
    coefficients_plot,
    count_up_to,
    harmonics_plot,
    histories,
    history_plot,
    steady_plots,
    tongues,
)
from core.stability.claims import FIGURES, ROWS
from core.stability.figures import CAM_ANGLE
from core.study import ShaftStudy, Study

UNSEEN = 1e-5  # of η: an edge that is off by less is not seen in a picture


def stability_files(
    study: Study | ShaftStudy,
    shaft: Stability,
    q: Sequence[float] = (),
    at: Sequence[tuple[float, float]] = (),
    periods: float = 30.0,
    eta_max: float | None = None,
) -> tuple[dict[str, str | bytes], tuple[Chart | Figure, ...]]:
    """File name -> content of the tables and texts of a flexible shaft, and what is to be painted beside them.

    q        rows of the tables; empty: the machine's own
    at       points (η, Q) of the histories from rest, through ``periods`` turns; empty: the machine's own
    eta_max  of the tables and the chart; None: 5.6, of the chart as far as shows the machine
    """
    machine, title = shaft.machine, study.design.name
    runs = _followed(shaft, at or [(machine.eta, machine.q)], periods)
    means = shaft.averages(q, eta_max or ETA_MAX)
    made: dict[str, str | bytes] = {
        **tables(shaft, np.array(q or [machine.q]), runs, means, eta_max or ETA_MAX),
        **steady_tables(study, shaft),
        "report.txt": shaft_report(study) if isinstance(study, ShaftStudy) else report(study),
        "summary.json": to_json(shaft_summary(study) if isinstance(study, ShaftStudy) else summary(study, study.stages)),
    }
    top, damping = eta_max or shaft.eta_max, machine.damping
    return made, (
        chart(shaft.coefficients, machine, title, eta_max=top, damping=damping, marked=q, error=UNSEEN),
        Figure("coefficients", title, (coefficients_plot(shaft.coefficients),)),
        Figure("windup_averages", title, averages_plots(means)),
        Figure("windup", title, tuple(history_plot(each) for each in runs)),
        *_steady_figures(title, shaft.steady_turn),
    )


def _followed(shaft: Stability, points: Sequence[tuple[float, float]], periods: float) -> tuple[History, ...]:
    eta, q = np.array(points).T
    return histories(shaft.coefficients, eta, q, shaft.machine.damping, periods, contact=shaft.contact)


def paper_files(
    study: Study, shaft: Stability, periods: float, eta_max: float
) -> tuple[dict[str, str | bytes], Chart, tuple[Figure, ...]]:
    """Kim1990's Figs. 4 to 12: the tables they are drawn from, the chart, which is Fig. 8, and the others."""
    runs = _followed(shaft, [(eta, q) for _, eta, q, _ in FIGURES], periods)
    means = shaft.averages(ROWS, eta_max)
    made = tables(shaft, np.array(sorted({q for _, _, q, _ in FIGURES})), runs, means, eta_max)
    wind_up, slope = averages_plots(means)
    numbered = {
        4: profile_plot(study, shaft),
        5: coefficients_plot(shaft.coefficients, ("ψ",)),
        6: wind_up,
        7: slope,
        **{number: history_plot(each) for (number, *_), each in zip(FIGURES, runs, strict=True)},
    }
    figures = tuple(Figure(f"figure_{n}", f"Kim1990 Fig. {n}", (plot,)) for n, plot in numbered.items())
    drawn = chart(shaft.coefficients, None, "Kim1990 Fig. 8", eta_max=eta_max, error=UNSEEN)
    return {**made, "figure_4.csv": profile_table(study, shaft)}, drawn, figures


# -- the steady response -----------------------------------------------------------------------------------


def steady_tables(study: Study | ShaftStudy, shaft: Stability) -> dict[str, str | bytes]:
    """File name -> text of the machine's own steady response; none where there is none."""
    turn = shaft.steady_turn
    if turn is None:
        return {}
    if isinstance(study, Study):
        parts = table(study, ORBIT, ("stability",))
        made = {} if parts is None else texts({ORBIT: parts})
    else:
        made = {ORBIT: orbit_table(study, turn)}
    return {**made, "harmonics.csv": harmonics_table(turn)}


def _steady_figures(title: str, turn: SteadyTurn | None) -> tuple[Figure, ...]:
    return () if turn is None else (Figure("steady", title, (*steady_plots(turn), harmonics_plot(turn))),)


def orbit_table(study: ShaftStudy, turn: SteadyTurn) -> str:
    """Wind-up and torque of a shaft of several drives by the angle of its input, which is the machine's, and each follower's error."""
    degrees = study.angle_degrees
    theta = np.deg2rad(degrees)
    names = [f"{study.slugs[each.name]}_follower_error_{each.unit}" for each in turn.followers]
    errors = [turn.error(theta, i) / UNITS[each.unit].factor + 0.0 for i, each in enumerate(turn.followers)]
    wind_up = turn.wind_up(theta)
    return csv(["input_angle_deg", "wind_up_deg", *names, "shaft_torque_nm"], [degrees, np.rad2deg(wind_up), *errors, turn.torque(theta)])


def harmonics_table(turn: SteadyTurn) -> str:
    """Amplitudes and phases of the wind-up's harmonics by the angle of the input, a cos(kθ + φ): of the true steady response, and of the
    linear forced response by (21) and by (22), Kim1990's (27) with γ = 0, where there is one."""
    columns: list[tuple[str, np.ndarray]] = [("harmonic", np.arange(turn.highest + 1.0))]
    for name, found in {"steady": turn.harmonics(), **turn.linear()}.items():
        if np.isfinite(found).all():
            size = np.where(np.arange(found.size) == 0, 360.0, 720.0) * np.abs(found)
            columns += [(f"{name}_amplitude_deg", size), (f"{name}_phase_deg", np.rad2deg(np.angle(found)))]
    return csv(*zip(*columns, strict=True))


# -- tables and sentences ----------------------------------------------------------------------------------

SAMPLES_PER_TURN = 100
COEFFICIENT_ROWS = 720
LINE = 108  # characters of a claim's line
HARD_SPACE = "\N{NO-BREAK SPACE}"


def tables(
    shaft: Stability, q: np.ndarray, runs: Sequence[History], means: Averages, eta_max: float
) -> dict[str, str | bytes]:
    """File name -> text of the tables of a flexible shaft: tongues of the rows q, histories, means, coefficients."""
    count, damping = count_up_to(eta_max), shaft.machine.damping
    return {
        TONGUES: tongues_table([tongues(shaft.coefficients, q, count, e, damping, error=1e-11) for e in EQUATIONS]),
        "windup.csv": windup_table(runs),
        "windup_averages.csv": averages_table(means),
        "coefficients.csv": coefficients_table(shaft),
    }


def windup_table(runs: Sequence[History]) -> str:
    """Histories from rest, one below the other: time in turns of the input, wind-up β and its slope β', contact force as a
    multiple of M X''m ω² where there is a cam."""
    parts = []
    for each in runs:
        y = np.arange(int(each.ended * SAMPLES_PER_TURN) + 1) / SAMPLES_PER_TURN
        beta, slope = each.at(y)
        parts.append([np.full(y.size, each.eta), np.full(y.size, each.q), y, beta, slope, each.force(y)])
    names = ["eta", "q", "input_turns", "wind_up", "wind_up_slope", "contact_force_ratio"]
    table = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return csv(*((names[:-1], table[:-1]) if runs[0].contact is None else (names, table)))


def averages_table(means: Averages) -> str:
    """Means of |β| and |β'| by η (Kim1990 Figs. 6, 7), and 1 where the follower leaves the cam within the turn; what cannot
    be followed is left out."""
    there = np.isfinite(means.wind_up).ravel()
    columns = [
        np.repeat(means.q, means.eta.size),
        np.tile(means.eta, means.q.size),
        means.wind_up.ravel(),
        means.slope.ravel(),
    ]
    names = ["q", "eta", "mean_wind_up", "mean_wind_up_slope"]
    if means.lost is not None:
        names.append("leaves_cam")
        columns.append(means.lost.ravel().astype(float))
    return csv(names, [column[there] for column in columns])


def coefficients_table(shaft: Stability) -> str:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ): inertia share d, C, U, κ, ψ."""
    degrees = 360.0 * np.arange(COEFFICIENT_ROWS) / COEFFICIENT_ROWS
    rows = shaft.coefficients.panels.at(np.deg2rad(degrees), 5)
    return csv(["cam_angle_deg", "inertia", "centripetal", "load", "curvature", "psi"], [degrees, *rows])


def claims_text(claims: Sequence[Claim]) -> str:
    """Kim1990's claims against ours, and how many agree."""
    head = "Kim, Jeon, Lee and Park 1990: what the paper says, and what comes out here"
    lines = [head, "=" * len(head)]
    for claim in claims:
        lines += ["", f"{claim.where}: {claim.verdict}"]
        for who, sentence in (("the paper", claim.paper), ("here", claim.here)):
            start = f"    {who + ':':<11}"
            kept = sentence.replace(" = ", f"{HARD_SPACE}={HARD_SPACE}")
            rows = wrap(kept, LINE, initial_indent=start, subsequent_indent=" " * len(start))
            lines += [row.replace(HARD_SPACE, " ") for row in rows]
    counts = Counter(claim.verdict for claim in claims)
    return "\n".join([*lines, "", ", ".join(f"{verdict}: {counts[verdict]}" for verdict in sorted(counts))]) + "\n"


def profile_plot(study: Study, shaft: Stability) -> Plot:
    """Displacement, velocity and acceleration by cam angle, each relative to its largest (Kim1990 Fig. 4)."""
    degrees, *rows = _profile(study, shaft)
    names = ("displacement X", "velocity X'", "acceleration X''")
    return Plot(CAM_ANGLE, "Relative to the largest", tuple(
        Curve(degrees, row, name, i) for i, (row, name) in enumerate(zip(rows, names, strict=True))
    ))  # fmt: skip


def profile_table(study: Study, shaft: Stability) -> str:
    return csv(["cam_angle_deg", "displacement", "velocity", "acceleration"], _profile(study, shaft))


def _profile(study: Study, shaft: Stability) -> list[np.ndarray]:
    sizes, y = shaft.coefficients.sizes, study.motion.displacement
    parts = (y[0] - sizes.lowest) / sizes.stroke, y[1] / sizes.slope, y[2] / sizes.curvature
    return [study.angle_degrees, *parts]


def needed_text(needed: Stiffness) -> str:
    """What a wanted speed asks of the shaft, in one line."""
    if needed.allowed:
        return f"At {needed.rpm:.6g} rpm the present {needed.now:.6g} N·m/rad keeps clear of every forbidden band."
    softer = "" if needed.softer is None else f" or at most {needed.softer:.6g}"
    where = "in" if needed.inside else "too near"
    return (
        f"At {needed.rpm:.6g} rpm the shaft needs at least {needed.stiffer:.6g} N·m/rad{softer}; "
        f"the present {needed.now:.6g} stands {where} a forbidden band."
    )
