"""A flexible camshaft as files: its tables and report, its chart and other figures."""

from __future__ import annotations

import csv as comma
from collections import Counter
from collections.abc import Iterable, Sequence
from io import StringIO
from textwrap import wrap
from typing import Any

import numpy as np

from core.design import UNITS
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

# -- A flexible camshaft as files -------------------------------------------------------------------------------


UNSEEN = 1e-5  # of η: an edge that is off by less is not seen in a picture


def stability_files(
    study: Study,
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
    runs = followed(shaft, at or [(machine.eta, machine.q)], periods)
    means = shaft.averages(q, eta_max or ETA_MAX)
    made: dict[str, str | bytes] = {
        **tables(shaft, np.array(q or [machine.q]), runs, means, eta_max or ETA_MAX),
        **steady_tables(study, shaft),
        "report.txt": report(study),
        "summary.json": to_json(summary(study)),
    }
    return made, (
        machine_chart(shaft, title, q, eta_max),
        Figure("coefficients", title, (coefficients_plot(shaft.coefficients),)),
        Figure("windup_averages", title, averages_plots(means)),
        Figure("windup", title, tuple(history_plot(each) for each in runs)),
        *_steady_figures(title, shaft.steady_turn),
    )


def machine_chart(shaft: Stability, title: str, q: Sequence[float] = (), eta_max: float | None = None) -> Chart:
    """The chart with the machine's place; q: rows to be marked; eta_max: None as far as shows the machine."""
    top = eta_max or shaft.eta_max
    return chart(
        shaft.coefficients, shaft.machine, title, eta_max=top, damping=shaft.machine.damping, marked=q, error=UNSEEN
    )


def followed(shaft: Stability, points: Sequence[tuple[float, float]], periods: float) -> tuple[History, ...]:
    """The wind-up from rest at points (η, Q) of the chart, over so many periods."""
    eta, q = np.array(points).T
    return histories(shaft.coefficients, eta, q, shaft.machine.damping, periods, contact=shaft.contact)


# -- the steady response -----------------------------------------------------------------------------------


def steady_tables(study: Study, shaft: Stability) -> dict[str, str | bytes]:
    """File name -> text of the machine's own steady response; none where there is none."""
    turn = shaft.steady_turn
    if turn is None:
        return {}
    if study.design.listed:
        made = {ORBIT: orbit_table(study.camshaft, turn)}
    else:
        parts = table(study, ORBIT, ("stability",))
        made = {} if parts is None else as_texts({ORBIT: parts})
    return {**made, "harmonics.csv": harmonics_table(turn)}


def _steady_figures(title: str, turn: SteadyTurn | None) -> tuple[Figure, ...]:
    return () if turn is None else (Figure("steady", title, (*steady_plots(turn), harmonics_plot(turn))),)


def orbit_table(camshaft: Camshaft[Study], turn: SteadyTurn) -> str:
    """Wind-up and torque of a shaft of several drives by the angle of its input, which is the machine's, and each follower's error."""
    degrees = camshaft.angle_degrees
    theta = np.deg2rad(degrees)
    names = [f"{camshaft.slugs[each.name]}_follower_error_{each.unit}" for each in turn.followers]
    errors = [turn.error(theta, i) / UNITS[each.unit].factor + 0.0 for i, each in enumerate(turn.followers)]
    wind_up = turn.wind_up(theta)
    return csv(
        ["input_angle_deg", "wind_up_deg", *names, "shaft_torque_nm"],
        [degrees, np.rad2deg(wind_up), *errors, turn.torque(theta)],
    )


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


def tables(
    shaft: Stability, q: np.ndarray, runs: Sequence[History], means: Averages, eta_max: float
) -> dict[str, str | bytes]:
    """File name -> text of the tables of a flexible shaft: tongues of the rows q, histories, means, coefficients."""
    count, damping = count_up_to(eta_max), shaft.machine.damping
    return {
        TONGUES: tongues_csv([tongues(shaft.coefficients, q, count, e, damping, error=1e-11) for e in EQUATIONS]),
        "windup.csv": csv(*windup_columns(runs)),
        "windup_averages.csv": csv(*averages_columns(means)),
        "coefficients.csv": csv(*coefficients_columns(shaft.coefficients)),
    }


def needed_text(needed: Stiffness) -> str:
    """What a wanted speed asks of the shaft, in one line."""
    if needed.allowed:
        return f"At {needed.rpm:.6g} rpm the present {needed.current:.6g} N·m/rad keeps clear of every forbidden band."
    softer = "" if needed.softer is None else f" or at most {needed.softer:.6g}"
    where = "in" if needed.inside else "too near"
    return (
        f"At {needed.rpm:.6g} rpm the shaft needs at least {needed.stiffer:.6g} N·m/rad{softer}; "
        f"the present {needed.current:.6g} stands {where} a forbidden band."
    )


# -- what the papers say against what comes out here, as files --------------------------------------------------


LINE = 108  # characters of a claim's line
HARD_SPACE = "\N{NO-BREAK SPACE}"


def rows_data(claims: Sequence[Claim]) -> list[dict[str, str]]:
    """One row a claim; ``file``: its table, relative to the folder of all papers."""
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
    """Where its numbers stand; pictures have the same name with another ending."""
    return f"{claim.paper}/{claim.name}.csv"


def table_text(table: FigureTable) -> str:
    """As CSV: numbers alone as in every other table; where there are words, these as they are."""
    if not any(isinstance(column, tuple) for column in table.columns):
        return csv(table.names, [np.asarray(column) for column in table.columns])
    text = StringIO()
    writer = comma.writer(text, lineterminator="\n")
    writer.writerow(table.names)
    writer.writerows([_cell(value) for value in row] for row in table.rows)
    return text.getvalue()


def _cell(value: Any) -> str:
    return value if isinstance(value, str) else repr(float(value))


def tables_of(claims: Sequence[Claim]) -> dict[str, str | bytes]:
    """File name -> text of the tables of the claims, each once."""
    first = {table_file(claim): claim for claim in reversed(claims)}
    return {name: table_text(first[name].table) for name in dict.fromkeys(table_file(claim) for claim in claims)}


# -- as text ------------------------------------------------------------------------------------------------


def claims_text(head: str, claims: Sequence[Claim]) -> str:
    """The claims of a paper against ours under a heading, and how many there are of each verdict, with what it means."""
    lines = [head, "=" * len(head)]
    for claim in claims:
        lines += ["", f"{claim.where}: {claim.verdict}"]
        for who, sentence in (("the paper", claim.says), ("here", claim.here)):
            start = f"    {who + ':':<11}"
            kept = sentence.replace(" = ", f"{HARD_SPACE}={HARD_SPACE}")
            rows = wrap(kept, LINE, initial_indent=start, subsequent_indent=" " * len(start))
            lines += [row.replace(HARD_SPACE, " ") for row in rows]
    counts = [(verdict, count, VERDICTS[verdict]) for verdict, count in counted(claims)]
    return (
        "\n".join([*lines, "", *(f"{count:4d}  {verdict:<14}{meaning}" for verdict, count, meaning in counts)]) + "\n"
    )


def counted(claims: Iterable[Claim]) -> list[tuple[str, int]]:
    """The verdicts that there are, in the order of their table, and how many of each."""
    counts = Counter(claim.verdict for claim in claims)
    return [(verdict, counts[verdict]) for verdict in VERDICTS if counts[verdict]]


# -- Kim1990's, of the example or of a file like it -----------------------------------------------------------


def kim_files(
    examples: Examples, shaft: Stability, periods: float, eta_max: float
) -> tuple[dict[str, str | bytes], Chart, tuple[Figure, ...]]:
    """Kim1990's Figs. 4 to 12: the tables they are drawn from, the chart, which is Fig. 8, and the others."""
    damping = shaft.machine.damping
    histories, means = runs(examples, periods, damping), averages(examples, ROWS, eta_max, damping)
    made = tables(shaft, np.array(sorted({q for _, _, q, _ in FIGURES})), histories, means, eta_max)
    wind_up, slope = averages_plots(means)
    profile = DISPLACEMENT.drawing
    assert profile is not None
    numbered = {
        5: coefficients_plot(shaft.coefficients, ("ψ",)),
        6: wind_up,
        7: slope,
        **{number: history_plot(each) for (number, *_), each in zip(FIGURES, histories, strict=True)},
    }
    figures = [Figure(f"figure_{n}", f"Kim1990 Fig. {n}", (plot,)) for n, plot in numbered.items()]
    fourth = profile(examples)
    assert isinstance(fourth, Figure)
    drawn = chart(shaft.coefficients, None, "Kim1990 Fig. 8", eta_max=eta_max, error=UNSEEN)
    return {**made, "figure_4.csv": table_text(DISPLACEMENT.table(examples))}, drawn, (fourth, *figures)
