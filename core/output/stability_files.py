"""What is known of a flexible camshaft as files: its tables and report, its chart and other figures, and Kim1990's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.output.report import report
from core.output.stability_tables import profile_plot, profile_table, tables
from core.output.summary import summary, to_json
from core.stability import (
    ETA_MAX,
    Chart,
    Figure,
    History,
    Stability,
    averages_plots,
    chart,
    coefficients_plot,
    histories,
    history_plot,
)
from core.stability.claims import FIGURES, ROWS
from core.study import Study

UNSEEN = 1e-5  # of η: an edge that is off by less is not seen in a picture


def stability_files(
    study: Study,
    found: Stability,
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
    machine, title = found.machine, study.design.name
    gone = _followed(found, at or [(machine.eta, machine.q)], periods)
    means = found.averages(q, eta_max or ETA_MAX)
    made: dict[str, str | bytes] = {
        **tables(found, np.array(q or [machine.q]), gone, means, eta_max or ETA_MAX),
        "report.txt": report(study),
        "summary.json": to_json(summary(study, study.stages)),
    }
    top, damping = eta_max or found.eta_max, machine.damping
    return made, (
        chart(found.coefficients, machine, title, eta_max=top, damping=damping, marked=q, error=UNSEEN),
        Figure("coefficients", title, (coefficients_plot(found.coefficients),)),
        Figure("windup_averages", title, averages_plots(means)),
        Figure("windup", title, tuple(history_plot(each) for each in gone)),
    )


def _followed(found: Stability, points: Sequence[tuple[float, float]], periods: float) -> tuple[History, ...]:
    eta, q = np.array(points).T
    return histories(found.coefficients, eta, q, found.machine.damping, periods, contact=found.contact)


def paper_files(
    study: Study, found: Stability, periods: float, eta_max: float
) -> tuple[dict[str, str | bytes], Chart, tuple[Figure, ...]]:
    """Kim1990's Figs. 4 to 12: the tables they are drawn from, the chart, which is Fig. 8, and the others."""
    gone = _followed(found, [(eta, q) for _, eta, q, _ in FIGURES], periods)
    means = found.averages(ROWS, eta_max)
    made = tables(found, np.array(sorted({q for _, _, q, _ in FIGURES})), gone, means, eta_max)
    wind_up, slope = averages_plots(means)
    numbered = {
        4: profile_plot(study, found),
        5: coefficients_plot(found.coefficients, ("ψ",)),
        6: wind_up,
        7: slope,
        **{number: history_plot(each) for (number, *_), each in zip(FIGURES, gone, strict=True)},
    }
    figures = tuple(Figure(f"figure_{n}", f"Kim1990 Fig. {n}", (plot,)) for n, plot in numbered.items())
    drawn = chart(found.coefficients, None, "Kim1990 Fig. 8", eta_max=eta_max, error=UNSEEN)
    return {**made, "figure_4.csv": profile_table(study, found)}, drawn, figures
