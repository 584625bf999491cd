"""The command ``stability``: the chart of a flexible camshaft, its forbidden speeds, histories, and Kim1990's claims."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from core.design import require_single_cam
from core.export import TONGUES, csv, tongues_table
from core.files import write_all
from core.findings import ERROR
from core.project import load
from core.report import columns, finding_line, report, stability_text
from core.stability import (
    EQUATIONS,
    ETA_MAX,
    Chart,
    Stability,
    averages,
    chart,
    claims,
    count_up_to,
    histories,
    tongues,
)
from core.study import Study
from core.summary import summary, to_json

MOST_ETA, MOST_Q, MOST_PERIODS = 60.0, 100.0, 1000.0
FIRST_ETA, ETA_STEP = 0.5, 0.05  # of the table of averages (Kim1990 Figs. 6, 7)
SAMPLES_PER_TURN = 100
COEFFICIENT_ROWS = 720

ChartPainter = Callable[[Chart], Mapping[str, bytes]]
"""Paints a chart: file name -> content."""


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
        "--q", action="append", default=[], type=_q, metavar="Q", help="rows of the table (the machine's own)"
    )
    parser.add_argument(
        "--eta-max", type=_eta, default=ETA_MAX, metavar="ETA", help=f"tongues up to there ({ETA_MAX:g})"
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
        "--claims", action="store_true", help="what Kim1990 says of its cam against what comes out here"
    )


# -- the command ------------------------------------------------------------------------------------------


def stability_command(words: argparse.Namespace, painter: ChartPainter | None) -> int:
    """The section of the report on the terminal; with a folder the tables, the report and the chart as files."""
    study = Study(require_single_cam(load(words.design)))
    found = study.flexible_shaft()
    if words.claims:
        text = claims_text(found)
        if words.out is not None:
            write_all(words.out, {"claims.txt": text})
        print(text, end="")
        return 0
    text = stability_text(study)
    if words.out is not None:
        write_all(words.out, stability_files(study, found, words, painter))
    print(text, end="")
    told = study.findings(("stability",))
    for finding in told:
        print(finding_line(finding))
    return 1 if any(f.severity == ERROR for f in told) else 0


def stability_files(
    study: Study, found: Stability, words: argparse.Namespace, painter: ChartPainter | None
) -> dict[str, str | bytes]:
    """File name -> content of all that the command writes."""
    damping, rows = found.machine.damping, np.array(words.q or [found.machine.q])
    count = count_up_to(words.eta_max)
    made: dict[str, str | bytes] = {
        TONGUES: tongues_table([tongues(found.coefficients, rows, count, e, damping, error=1e-11) for e in EQUATIONS]),
        "windup.csv": windup_table(found, words.at or [(found.machine.eta, found.machine.q)], words.periods),
        "windup_averages.csv": averages_table(found, rows, words.eta_max),
        "coefficients.csv": coefficients_table(found),
        "report.txt": report(study),
        "summary.json": to_json(summary(study, study.stages)),
    }
    if painter is None:
        print("pictures left out: they need kindyna --headless", file=sys.stderr)
        return made
    drawn = chart(
        found.coefficients, found.machine, study.design.name, eta_max=words.eta_max, damping=damping, marked=words.q
    )
    made.update(painter(drawn))
    return made


# -- tables -----------------------------------------------------------------------------------------------


def windup_table(found: Stability, points: Sequence[tuple[float, float]], periods: float) -> str:
    """Histories from rest, one below the other: time in turns of the input, wind-up β and its slope β', contact force as a
    multiple of M X''m ω² where there is a cam."""
    eta, q = np.array(points).T
    parts = []
    for gone in histories(found.coefficients, eta, q, found.machine.damping, periods, contact=found.contact):
        y = np.arange(int(gone.ended * SAMPLES_PER_TURN) + 1) / SAMPLES_PER_TURN
        beta, slope = gone.at(y)
        parts.append([np.full(y.size, gone.eta), np.full(y.size, gone.q), y, beta, slope, gone.force(y)])
    names = ["eta", "q", "input_turns", "wind_up", "wind_up_slope", "contact_force_ratio"]
    table = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return csv(*((names[:-1], table[:-1]) if found.contact is None else (names, table)))


def averages_table(found: Stability, q: np.ndarray, eta_max: float) -> str:
    """Means of |β| and |β'| over the first turn from rest by η (Kim1990 Figs. 6, 7); what cannot be followed is left
    out."""
    eta = FIRST_ETA + ETA_STEP * np.arange(max(1, round((eta_max - FIRST_ETA) / ETA_STEP) + 1))
    every_eta, every_q = np.tile(eta, q.size), np.repeat(q, eta.size)
    mean, slope = averages(found.coefficients, every_eta, every_q, found.machine.damping)
    there = np.isfinite(mean)
    names = ["q", "eta", "mean_wind_up", "mean_wind_up_slope"]
    return csv(names, [column[there] for column in (every_q, every_eta, mean, slope)])


def coefficients_table(found: Stability) -> str:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ): inertia share d, C, U, κ, ψ."""
    degrees = 360.0 * np.arange(COEFFICIENT_ROWS) / COEFFICIENT_ROWS
    rows = found.coefficients.panels.at(np.deg2rad(degrees), 5)
    return csv(["cam_angle_deg", "inertia", "centripetal", "load", "curvature", "psi"], [degrees, *rows])


def claims_text(found: Stability) -> str:
    """Kim1990's claims against ours."""
    lines = []
    for claim in claims(found):
        lines += columns([(f"{claim.where}:", claim.verdict)], left=2)
        lines += [f"    the paper: {claim.paper}", f"    here:      {claim.here}", ""]
    return "\n".join(lines)
