"""The command ``stability``: the chart of a flexible camshaft, its forbidden speeds, histories, and Kim1990's claims."""

from __future__ import annotations

import argparse
import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from textwrap import wrap

import numpy as np

from core.design import require_single_cam
from core.export import TONGUES, csv, tongues_table
from core.files import write_all
from core.findings import ERROR
from core.project import load
from core.report import finding_line, report, stability_text
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
    averages_plots,
    chart,
    claims,
    coefficients_plot,
    count_up_to,
    histories,
    history_plot,
    tongues,
)
from core.stability.claims import FIGURES, ROWS
from core.stability.figures import CAM_ANGLE
from core.study import Study
from core.summary import summary, to_json

MOST_ETA, MOST_Q, MOST_PERIODS = 60.0, 100.0, 1000.0
SAMPLES_PER_TURN = 100
COEFFICIENT_ROWS = 720
LINE = 108  # characters of a claim's line
HARD_SPACE = "\N{NO-BREAK SPACE}"

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
        "--claims",
        action="store_true",
        help="what Kim1990 says of its cam against what comes out here; with --out its Figs. 4-12 as tables and pictures",
    )


# -- the command ------------------------------------------------------------------------------------------


def stability_command(words: argparse.Namespace, painter: ChartPainter | None) -> int:
    """The section of the report on the terminal; with a folder the tables, the report and the pictures as files."""
    study = Study(require_single_cam(load(words.design)))
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
    drawn = chart(found.coefficients, machine, title, eta_max=eta_max, damping=machine.damping, marked=words.q)
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
    drawn = chart(found.coefficients, None, "Kim1990 Fig. 8", eta_max=eta_max)
    pictures = _painted(painter, drawn, *figures)
    chart_named = {name.replace("stability", "figure_8"): data for name, data in pictures.items()}
    return {**made, "figure_4.csv": profile_table(study, found), **chart_named}


def profile_plot(study: Study, found: Stability) -> Plot:
    """Displacement, velocity and acceleration by cam angle, each relative to its largest (Kim1990 Fig. 4)."""
    degrees, *rows = _profile(study, found)
    names = ("displacement X", "velocity X'", "acceleration X''")
    return Plot(CAM_ANGLE, "Relative to the largest", tuple(
        Curve(degrees, row, name, i) for i, (row, name) in enumerate(zip(rows, names, strict=True))
    ))  # fmt: skip


def profile_table(study: Study, found: Stability) -> str:
    return csv(["cam_angle_deg", "displacement", "velocity", "acceleration"], _profile(study, found))


def _profile(study: Study, found: Stability) -> list[np.ndarray]:
    sizes, y = found.coefficients.sizes, study.motion.y
    parts = (y[0] - sizes.lowest) / sizes.stroke, y[1] / sizes.slope, y[2] / sizes.curvature
    return [study.angle_degrees, *parts]


# -- tables -----------------------------------------------------------------------------------------------


def tables(
    found: Stability, q: np.ndarray, gone: Sequence[History], means: Averages, eta_max: float
) -> dict[str, str | bytes]:
    """File name -> text of the tables of a flexible shaft: tongues of the rows q, histories, means, coefficients."""
    count, damping = count_up_to(eta_max), found.machine.damping
    return {
        TONGUES: tongues_table([tongues(found.coefficients, q, count, e, damping, error=1e-11) for e in EQUATIONS]),
        "windup.csv": windup_table(gone),
        "windup_averages.csv": averages_table(means),
        "coefficients.csv": coefficients_table(found),
    }


def windup_table(gone: Sequence[History]) -> str:
    """Histories from rest, one below the other: time in turns of the input, wind-up β and its slope β', contact force as a
    multiple of M X''m ω² where there is a cam."""
    parts = []
    for each in gone:
        y = np.arange(int(each.ended * SAMPLES_PER_TURN) + 1) / SAMPLES_PER_TURN
        beta, slope = each.at(y)
        parts.append([np.full(y.size, each.eta), np.full(y.size, each.q), y, beta, slope, each.force(y)])
    names = ["eta", "q", "input_turns", "wind_up", "wind_up_slope", "contact_force_ratio"]
    table = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return csv(*((names[:-1], table[:-1]) if gone[0].contact is None else (names, table)))


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


def coefficients_table(found: Stability) -> str:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ): inertia share d, C, U, κ, ψ."""
    degrees = 360.0 * np.arange(COEFFICIENT_ROWS) / COEFFICIENT_ROWS
    rows = found.coefficients.panels.at(np.deg2rad(degrees), 5)
    return csv(["cam_angle_deg", "inertia", "centripetal", "load", "curvature", "psi"], [degrees, *rows])


def claims_text(told: Sequence[Claim]) -> str:
    """Kim1990's claims against ours, and how many agree."""
    head = "Kim, Jeon, Lee and Park 1990: what the paper says, and what comes out here"
    lines = [head, "=" * len(head)]
    for claim in told:
        lines += ["", f"{claim.where}: {claim.verdict}"]
        for who, said in (("the paper", claim.paper), ("here", claim.here)):
            start = f"    {who + ':':<11}"
            kept = said.replace(" = ", f"{HARD_SPACE}={HARD_SPACE}")
            rows = wrap(kept, LINE, initial_indent=start, subsequent_indent=" " * len(start))
            lines += [row.replace(HARD_SPACE, " ") for row in rows]
    counts = Counter(claim.verdict for claim in told)
    return "\n".join([*lines, "", ", ".join(f"{verdict}: {counts[verdict]}" for verdict in sorted(counts))]) + "\n"
