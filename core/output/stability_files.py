"""Files of a flexible camshaft, and of the papers: tables, reports, charts and figures."""

from __future__ import annotations

import csv as comma
from collections import Counter
from collections.abc import Iterable, Sequence
from io import StringIO
from textwrap import wrap

import numpy as np

from core.design import UNITS
from core.number_text import result_text
from core.output.export import TONGUES, as_texts, csv, table, tongues_csv
from core.output.report import report
from core.output.summary import summary, to_json
from core.papers import VERDICTS, Claim, Examples, FigureTable
from core.papers.kim1990 import DISPLACEMENT
from core.papers.kim1990_chart import FIGURES, ROWS, averages, runs
from core.plot import Figure
from core.stability import (
    EQUATIONS,
    ETA_MAX,
    Averages,
    Chart,
    History,
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
from core.stability.critical_speeds import averages_columns, coefficients_columns, windup_columns
from core.study import Camshaft, Study
from core.study.quantities import ORBIT

# -- flexible camshaft ------------------------------------------------------------------------------------------


UNSEEN = 1e-5  # error of η that is invisible in a chart


def stability_files(
    study: Study,
    shaft: Stability,
    q: Sequence[float] = (),
    at: Sequence[tuple[float, float]] = (),
    periods: float = 30.0,
    eta_max: float | None = None,
) -> tuple[dict[str, str | bytes], tuple[Chart | Figure, ...]]:
    """Tables and texts of a flexible shaft as file name -> content, and its chart and figures.

    Parameters
    ----------
    study : Study
    shaft : Stability
    q : sequence of float
        Values of Q in the tables; empty: that of the machine.
    at : sequence of (float, float)
        Points (η, Q) of the histories from rest over ``periods`` turns; empty: that of the machine.
    periods : float
    eta_max : float, optional
        Range of tables and chart; None: 5.6 in the tables, and in the chart as far as the machine.
    """
    machine, title = shaft.machine, study.design.name
    runs = windup_histories(shaft, at or [(machine.eta, machine.q)], periods)
    means = shaft.averages(q, eta_max or ETA_MAX)
    contents: dict[str, str | bytes] = {
        **shaft_tables(shaft, np.array(q or [machine.q]), runs, means, eta_max or ETA_MAX),
        **steady_tables(study, shaft),
        "report.txt": report(study),
        "summary.json": to_json(summary(study)),
    }
    turn = shaft.steady_turn
    steady = [] if turn is None else [Figure("steady", title, (*steady_plots(turn), harmonics_plot(turn)))]
    return contents, (
        machine_chart(shaft, title, q, eta_max),
        Figure("coefficients", title, (coefficients_plot(shaft.coefficients),)),
        Figure("windup_averages", title, averages_plots(means)),
        Figure("windup", title, tuple(history_plot(run) for run in runs)),
        *steady,
    )


def machine_chart(shaft: Stability, title: str, q: Sequence[float] = (), eta_max: float | None = None) -> Chart:
    """Chart with the point of the machine, marked values of Q, up to ``eta_max`` (None: as far as the machine)."""
    top = eta_max or shaft.eta_max
    return chart(
        shaft.coefficients, shaft.machine, title, eta_max=top, damping=shaft.machine.damping, marked=q, error=UNSEEN
    )


def windup_histories(shaft: Stability, points: Sequence[tuple[float, float]], periods: float) -> tuple[History, ...]:
    """Wind-up from rest at points (η, Q) of the chart."""
    eta, q = np.array(points).T
    return histories(shaft.coefficients, eta, q, shaft.machine.damping, periods, contact=shaft.contact)


# -- the steady response -----------------------------------------------------------------------------------


def steady_tables(study: Study, shaft: Stability) -> dict[str, str | bytes]:
    """File name -> text of the steady response of the machine; empty where there is none."""
    turn = shaft.steady_turn
    if turn is None:
        return {}
    if study.design.listed:
        result = {ORBIT: orbit_table(study.camshaft, turn)}
    else:
        parts = table(study, ORBIT, ("stability",))
        result = {} if parts is None else as_texts({ORBIT: parts})
    return {**result, "harmonics.csv": harmonics_table(turn)}


def orbit_table(camshaft: Camshaft[Study], turn: SteadyTurn) -> str:
    """Wind-up and torque of a shaft of several drives, and errors of the followers, by the angle of its input."""
    degrees = camshaft.angle_degrees
    theta = np.deg2rad(degrees)
    names = [f"{camshaft.slugs[follower.name]}_follower_error_{follower.unit}" for follower in turn.followers]
    errors = [turn.error(theta, i) / UNITS[follower.unit].factor + 0.0 for i, follower in enumerate(turn.followers)]
    wind_up = turn.wind_up(theta)
    return csv(
        ["input_angle_deg", "wind_up_deg", *names, "shaft_torque_nm"],
        [degrees, np.rad2deg(wind_up), *errors, turn.torque(theta)],
    )


def harmonics_table(turn: SteadyTurn) -> str:
    """Harmonics a cos(kθ + φ) of the wind-up by the angle of the input, as CSV.

    Columns for the steady response, and for the linear forced response by (21) and (22), which are (27) of Kim1990 with γ = 0,
    where it exists.
    """
    columns: list[tuple[str, np.ndarray]] = [("harmonic", np.arange(turn.highest + 1.0))]
    for name, harmonics in {"steady": turn.harmonics(), **turn.linear()}.items():
        if np.isfinite(harmonics).all():
            size = np.where(np.arange(harmonics.size) == 0, 360.0, 720.0) * np.abs(harmonics)
            columns += [(f"{name}_amplitude_deg", size), (f"{name}_phase_deg", np.rad2deg(np.angle(harmonics)))]
    return csv(*zip(*columns, strict=True))


# -- tables and sentences ----------------------------------------------------------------------------------


def shaft_tables(
    shaft: Stability, q: np.ndarray, runs: Sequence[History], means: Averages, eta_max: float
) -> dict[str, str | bytes]:
    """Tables of a flexible shaft as file name -> text: tongues, histories, means, coefficients.

    Parameters
    ----------
    shaft : Stability
    q : ndarray (m,), dimensionless
        Values of Q of the tongues.
    runs : sequence of History
    means : Averages
    eta_max : float
    """
    count, damping = count_up_to(eta_max), shaft.machine.damping
    return {
        TONGUES: tongues_csv([tongues(shaft.coefficients, q, count, e, damping, error=1e-11) for e in EQUATIONS]),
        "windup.csv": csv(*windup_columns(runs)),
        "windup_averages.csv": csv(*averages_columns(means)),
        "coefficients.csv": csv(*coefficients_columns(shaft.coefficients)),
    }


def stiffness_text(needed: Stiffness) -> str:
    """Stiffness that a speed requires of the shaft, in one line."""
    if needed.allowed:
        return f"At {result_text(needed.rpm)} rpm the current {result_text(needed.current)} N·m/rad is outside every forbidden band."
    softer = "" if needed.softer is None else f" or at most {result_text(needed.softer, 5)}"
    position = "in" if needed.inside else "too near"
    return (
        f"At {result_text(needed.rpm, 5)} rpm the shaft needs at least {result_text(needed.stiffer, 5)} N·m/rad{softer}; "
        f"the current {result_text(needed.current)} is {position} a forbidden band."
    )


# -- claims of the papers, compared with results ----------------------------------------------------------------


LINE = 108  # characters of a claim's line
HARD_SPACE = "\N{NO-BREAK SPACE}"


def claims_data(claims: Sequence[Claim]) -> list[dict[str, str]]:
    """Claims as rows; ``file`` is the table, relative to the folder of all papers."""
    return [
        {
            "paper": c.paper,
            "where": c.where,
            "says": c.says,
            "here": c.here,
            "verdict": c.verdict,
            "file": table_file(c),
        }
        for c in claims
    ]


def table_file(claim: Claim) -> str:
    """File of a claim's table; images have the same name with another ending."""
    return f"{claim.paper}/{claim.name}.csv"


def table_text(table: FigureTable) -> str:
    """Table of a figure as CSV; words unchanged."""
    if not any(isinstance(column, tuple) for column in table.columns):
        return csv(table.names, [np.asarray(column) for column in table.columns])
    text = StringIO()
    writer = comma.writer(text, lineterminator="\n")
    writer.writerow(table.names)
    writer.writerows([value if isinstance(value, str) else repr(float(value)) for value in row] for row in table.rows)
    return text.getvalue()


def claim_tables(claims: Sequence[Claim]) -> dict[str, str | bytes]:
    """File name -> text of the tables of the claims."""
    first = {table_file(claim): claim for claim in reversed(claims)}
    return {name: table_text(first[name].table) for name in dict.fromkeys(table_file(claim) for claim in claims)}


# -- text ---------------------------------------------------------------------------------------------------


def claims_text(heading: str, claims: Sequence[Claim]) -> str:
    """Claims of a paper and the results under a heading, and the number of each verdict with its meaning."""
    lines = [heading, "=" * len(heading)]
    for claim in claims:
        lines += ["", f"{claim.where}: {claim.verdict}"]
        for source, sentence in (("the paper", claim.says), ("here", claim.here)):
            start = f"    {source + ':':<11}"
            protected = sentence.replace(" = ", f"{HARD_SPACE}={HARD_SPACE}")
            rows = wrap(protected, LINE, initial_indent=start, subsequent_indent=" " * len(start))
            lines += [row.replace(HARD_SPACE, " ") for row in rows]
    counts = [(verdict, count, VERDICTS[verdict]) for verdict, count in verdict_counts(claims)]
    return (
        "\n".join([*lines, "", *(f"{count:4d}  {verdict:<14}{meaning}" for verdict, count, meaning in counts)]) + "\n"
    )


def verdict_counts(claims: Iterable[Claim]) -> list[tuple[str, int]]:
    """Verdicts that occur, in the order of their table, and their numbers."""
    counts = Counter(claim.verdict for claim in claims)
    return [(verdict, counts[verdict]) for verdict in VERDICTS if counts[verdict]]


# -- figures of Kim1990 -----------------------------------------------------------------------------------------


def kim_files(
    examples: Examples, shaft: Stability, periods: float, eta_max: float
) -> tuple[dict[str, str | bytes], Chart, tuple[Figure, ...]]:
    """Figures 4 to 12 of Kim1990: their tables, the chart (figure 8), and the other figures."""
    damping = shaft.machine.damping
    histories, means = runs(examples, periods, damping), averages(examples, ROWS, eta_max, damping)
    tables = shaft_tables(shaft, np.array(sorted({q for _, _, q, _ in FIGURES})), histories, means, eta_max)
    wind_up, slope = averages_plots(means)
    profile = DISPLACEMENT.drawing
    assert profile is not None
    numbered = {
        5: coefficients_plot(shaft.coefficients, ("ψ",)),
        6: wind_up,
        7: slope,
        **{number: history_plot(history) for (number, *_), history in zip(FIGURES, histories, strict=True)},
    }
    figures = [Figure(f"figure_{n}", f"Kim1990 Fig. {n}", (plot,)) for n, plot in numbered.items()]
    fourth = profile(examples)
    assert isinstance(fourth, Figure)
    drawn = chart(shaft.coefficients, None, "Kim1990 Fig. 8", eta_max=eta_max, error=UNSEEN)
    return {**tables, "figure_4.csv": table_text(DISPLACEMENT.table(examples))}, drawn, (fourth, *figures)
