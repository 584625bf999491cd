"""The command ``stability``: the chart of a flexible camshaft, its forbidden speeds, histories, and Kim1990's claims."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from core.design import require_single_cam
from core.files import write_all
from core.findings import ERROR
from core.project import load
from core.report import finding_line, report, stability_text
from core.shaft_tables import claims_text, needed_text, profile_plot, profile_table, tables
from core.stability import (
    ETA_MAX,
    Chart,
    Figure,
    History,
    Stability,
    averages_plots,
    chart,
    claims,
    coefficients_plot,
    flexible,
    histories,
    history_plot,
)
from core.stability.claims import FIGURES, ROWS
from core.stability.guess import USUAL_ETA, USUAL_Q
from core.study import Study
from core.summary import summary, to_json

MOST_ETA, MOST_Q, MOST_PERIODS = 60.0, 100.0, 1000.0
UNSEEN = 1e-5  # of η: an edge that is off by less is not seen in a picture

ChartPainter = Callable[[Chart | Figure], Mapping[str, bytes]]
"""Paints a chart or another figure: file name -> content."""


# -- words ------------------------------------------------------------------------------------------------


def _number(low: float, high: float, what: str) -> Callable[[str], float]:
    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low < value <= high:  # nan is not
            raise argparse.ArgumentTypeError(f"{text!r}: {what}; allowed: above {low:g} ... {high:g}")
        return value

    return read


_q = _number(0.0, MOST_Q, "inertia ratio Q")
_eta = _number(0.0, MOST_ETA, "frequency ratio")


def _point(text: str) -> tuple[float, float]:
    eta, comma, q = text.partition(",")
    if not comma:
        raise argparse.ArgumentTypeError(f"{text!r}: a point of the chart; allowed: ETA,Q such as 0.85,0.1")
    return _eta(eta), _q(q)


def _folder(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError("a folder is wanted, nothing was given")
    return Path(text)


def stability_words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("design", metavar="DESIGN", type=Path, help="design file (.toml) with a flexible shaft")
    parser.add_argument("--out", type=_folder, metavar="DIR", help="write tables, report and chart there")
    parser.add_argument(
        "--q",
        action="append",
        default=[],
        type=_q,
        metavar="Q",
        help="rows of the tables (tongues: the machine's own; averages: it and multiples of it)",
    )
    parser.add_argument(
        "--eta-max",
        type=_eta,
        metavar="ETA",
        help=f"tongues up to there ({ETA_MAX:g}; the chart shows the machine too)",
    )
    parser.add_argument(
        "--at",
        action="append",
        default=[],
        type=_point,
        metavar="ETA,Q",
        help="histories from rest (the machine's own point)",
    )
    periods = _number(0.0, MOST_PERIODS, "turns")
    parser.add_argument("--periods", type=periods, default=30.0, metavar="N", help="turns of a history (30)")
    parser.add_argument(
        "--rpm",
        action="append",
        default=[],
        type=_number(0.0, 1e5, "speed"),
        metavar="RPM",
        help="tell how stiff the shaft must be to run at this speed",
    )
    parser.add_argument(
        "--guess",
        action="store_true",
        help=f"where the shaft is rigid, take a usual one, Q = {USUAL_Q:g} and η = {USUAL_ETA:g}",
    )
    parser.add_argument(
        "--claims",
        action="store_true",
        help="what Kim1990 says of its cam against what comes out here; with --out its Figs. 4-12 as tables and pictures",
    )


# -- the command ------------------------------------------------------------------------------------------


def stability_command(words: argparse.Namespace, painter: ChartPainter | None) -> int:
    """The section of the report on the terminal; with a folder the tables, the report and the pictures as files."""
    study = Study(require_single_cam(load(words.design)))
    if words.guess and study.design.shaft.elastic is None:
        study = Study(flexible(study.design, study.linkage, study.loading, study.omega))
    found = study.flexible_shaft()
    if words.claims:
        text = claims_text(claims(found))
        if words.out is not None:
            write_all(words.out, {"claims.txt": text, **paper_files(study, found, words, painter)})
        print(text, end="")
        return 0
    text = stability_text(study)
    if words.out is not None:
        write_all(words.out, stability_files(study, found, words, painter))
    print(text, end="")
    for rpm in words.rpm:
        print(needed_text(found.stiffness_for(rpm)))
    told = study.findings(("stability",))
    for finding in told:
        print(finding_line(finding))
    return 1 if any(f.severity == ERROR for f in told) else 0


def stability_files(
    study: Study, found: Stability, words: argparse.Namespace, painter: ChartPainter | None
) -> dict[str, str | bytes]:
    """File name -> content of all that the command writes."""
    rows = np.array(words.q or [found.machine.q])
    gone = _followed(found, words.at or [(found.machine.eta, found.machine.q)], words.periods)
    means = found.averages(words.q, words.eta_max or ETA_MAX)
    made: dict[str, str | bytes] = {
        **tables(found, rows, gone, means, words.eta_max or ETA_MAX),
        "report.txt": report(study),
        "summary.json": to_json(summary(study, study.stages)),
    }
    title, machine, eta_max = study.design.name, found.machine, words.eta_max or found.eta_max
    drawn = chart(
        found.coefficients, machine, title, eta_max=eta_max, damping=machine.damping, marked=words.q, error=UNSEEN
    )
    return made | _painted(
        painter,
        drawn,
        Figure("coefficients", title, (coefficients_plot(found.coefficients),)),
        Figure("windup_averages", title, averages_plots(means)),
        Figure("windup", title, tuple(history_plot(each) for each in gone)),
    )


def _followed(found: Stability, points: Sequence[tuple[float, float]], periods: float) -> tuple[History, ...]:
    eta, q = np.array(points).T
    return histories(found.coefficients, eta, q, found.machine.damping, periods, contact=found.contact)


def _painted(painter: ChartPainter | None, *drawn: Chart | Figure) -> dict[str, bytes]:
    if painter is None:
        print("pictures left out: they need kindyna --headless", file=sys.stderr)
        return {}
    return {name: data for each in drawn for name, data in painter(each).items()}


# -- the figures of the paper -----------------------------------------------------------------------------


def paper_files(
    study: Study, found: Stability, words: argparse.Namespace, painter: ChartPainter | None
) -> dict[str, str | bytes]:
    """Kim1990's Figs. 4 to 12: the tables they are drawn from, and a picture of each."""
    gone = _followed(found, [(eta, q) for _, eta, q, _ in FIGURES], words.periods)
    eta_max = words.eta_max or ETA_MAX
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
    figures = [Figure(f"figure_{n}", f"Kim1990 Fig. {n}", (plot,)) for n, plot in numbered.items()]
    drawn = chart(found.coefficients, None, "Kim1990 Fig. 8", eta_max=eta_max, error=UNSEEN)
    pictures = _painted(painter, drawn, *figures)
    chart_named = {name.replace("stability", "figure_8"): data for name, data in pictures.items()}
    return {**made, "figure_4.csv": profile_table(study, found), **chart_named}
