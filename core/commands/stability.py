"""Commands about stability and papers: figures and stability."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, folder, out_folder, pictures, require_shaft, verdict
from core.design.fields import Info, choice, flag, number
from core.errors import KindynaError, NoStability
from core.frozen import frozen
from core.number_text import result_text
from core.output.lines import finding_line
from core.output.report import point_text, stability_text
from core.output.stability_files import (
    claim_tables,
    claims_data,
    claims_text,
    kim_files,
    stability_files,
    stiffness_text,
    table_file,
)
from core.output.summary import to_json
from core.papers import PAPERS, Claim, Examples, claims
from core.papers.kim1990_chart import EXAMPLE, require_kim
from core.project import load
from core.project.files import write_into
from core.requests import number_reader, option, text_option
from core.stability import ETA_MAX, Stability, with_flexible_shaft
from core.stability.critical_speeds import TYPICAL_ETA, TYPICAL_Q, Machine
from core.study import Study, findings_of
from core.units import NO_UNIT, UNITS

# -- the command ``figures`` ------------------------------------------------------------------------------------


ALL = "all"


@frozen(kw_only=True)
class FiguresArguments:
    """Arguments of ``figures``: a paper and a folder."""

    paper: str = option(choice("Paper", (*PAPERS, ALL), help=" | ".join((*PAPERS, ALL))), "PAPER")
    out: Path = text_option("write tables and pictures there", type=folder, metavar="DIR")
    json: bool = as_json("print the rows as JSON")


def run_figures(arguments: FiguresArguments, painter: Painter | None) -> int:
    """Print every claim with its verdict; write its figure or table as CSV and, with a painter, as SVG and PNG."""
    papers = tuple(PAPERS) if arguments.paper == ALL else (arguments.paper,)
    examples = Examples()
    by_paper = {paper: claims(paper, examples) for paper in papers}
    rows = [claim for group in by_paper.values() for claim in group]
    files: dict[str, str | bytes] = {**claim_tables(rows), **_painted(rows, painter)}
    if arguments.json:
        text = to_json(claims_data(rows))
    else:
        text = "\n".join(
            claims_text(f"{PAPERS[paper].label}: {PAPERS[paper].title}", group) for paper, group in by_paper.items()
        )
    write_into(arguments.out, files)
    print(text, end="")
    return DONE


def _painted(rows: list[Claim], painter: Painter | None) -> dict[str, bytes]:
    """Pictures of the tables; empty without a painter, with a message."""
    if painter is None:
        return dict(pictures(painter))
    images: dict[str, bytes] = {}
    first = {table_file(claim): claim for claim in reversed(rows)}
    for name in dict.fromkeys(table_file(claim) for claim in rows):
        for picture, data in painter(first[name].drawing).items():
            images[name.removesuffix(".csv") + picture[picture.rindex(".") :]] = data
    return images


# -- the command ``stability`` ----------------------------------------------------------------------------------


MOST_ETA = 60.0
KIM = "kim1990"

_q = number_reader(Info("Inertia ratio Q", low=0.0, high=100.0, open_low=True), NO_UNIT)
_eta = number_reader(Info("Frequency ratio", low=0.0, high=MOST_ETA, open_low=True), NO_UNIT)
_rpm = number_reader(Info("Speed", low=0.0, high=1e5, open_low=True), UNITS["rpm"])
Point = Callable[[Machine], tuple[float, float]]


def _point(text: str) -> Point:
    """Read a point of the chart, or a speed of the machine; the result gives (η, Q) of a machine."""
    if text.lower().endswith("rpm"):
        rpm = _rpm(text[:-3].strip())
        return lambda machine: (machine.eta_at(rpm), machine.q)
    eta, comma, q = text.partition(",")
    if not comma:
        raise argparse.ArgumentTypeError(
            f"{text!r}: a point of the chart; allowed: ETA,Q such as 0.85,0.1, or a speed such as 1500rpm"
        )
    point = _eta(eta), _q(q)
    return lambda machine: point


def _points(shaft: Stability, requested: Sequence[Point]) -> list[tuple[float, float]]:
    """Points of the chart. Raises KindynaError for a speed at which the shaft vibrates too often in a turn."""
    points = [point(shaft.machine) for point in requested]
    for eta, _ in points:
        if eta > MOST_ETA:
            rpm, least = shaft.machine.rpm(eta), shaft.machine.rpm(MOST_ETA)
            raise KindynaError(
                f"--at {result_text(rpm, 5)}rpm: the shaft vibrates {result_text(eta, 3)} times a turn; "
                f"allowed: {result_text(least, 5)} rpm and more"
            )
    return points


@frozen(kw_only=True)
class StabilityArguments:
    """Arguments of ``stability``: a design, and the points, rows and speeds of its chart."""

    design: Path = design_file()
    out: Path | None = out_folder("write tables, report and chart there")
    q: tuple[float, ...] = text_option(
        "rows of the tables (tongues: that of the machine; averages: also its multiples)",
        default=(),
        action="append",
        type=_q,
        metavar="Q",
    )
    eta_max: float | None = option(
        number(
            "Frequency ratio",
            0.0,
            MOST_ETA,
            open_low=True,
            default=None,
            help="greatest frequency ratio of the tongues",
        ),
        default_text=f"{ETA_MAX:g}; the chart shows the machine too",
        metavar="ETA",
    )
    at: tuple[Point, ...] = text_option(
        "verdicts of all models there, and histories from rest (default: the machine's point); or a speed, 1500rpm",
        default=(),
        action="append",
        type=_point,
        metavar="ETA,Q",
    )
    periods: float = option(
        number("Turns", 0.0, 1000.0, open_low=True, default=30.0, help="turns of a history"), metavar="N"
    )
    rpm: tuple[float, ...] = text_option(
        "print the stiffness that the shaft needs to run at this speed",
        default=(),
        action="append",
        type=_rpm,
        metavar="RPM",
    )
    guess: bool = flag(
        "Guess", help=f"where the shaft is rigid, assume a typical one, Q = {TYPICAL_Q:g} and η = {TYPICAL_ETA:g}"
    )
    claims: bool = flag(
        "Claims",
        help="printed and computed values of Kim1990's cam; with --out its Figs. 4-12 as tables and pictures",
    )


def run_stability(arguments: StabilityArguments, painter: Painter | None) -> int:
    """Print the section of the report; with a folder, write tables, report and pictures."""
    design = load(arguments.design)
    if design.listed and (arguments.guess or arguments.claims):
        given = "--guess" if arguments.guess else "--claims"
        raise KindynaError(f"{given}: only for a design with one drive; this one has {len(design.drives)}")
    study = Study(design)
    require_shaft(study)
    if arguments.guess and design.camshaft.elastic is None:
        study = Study(with_flexible_shaft(design, study.linkage, study.loading, study.omega))
    try:
        shaft = study.flexible_shaft()
    except NoStability as error:
        if design.listed or study.design.camshaft.elastic is not None:
            raise
        raise NoStability(error.problem, error.field, f"{error.hint}, or assume typical ones with --guess") from None
    return (_claims if arguments.claims else _machine)(study, shaft, arguments, painter)


def _machine(study: Study, shaft: Stability, arguments: StabilityArguments, painter: Painter | None) -> int:
    """Print and write the stability of the design's shaft. Raises NoStability where there is none."""
    shaft.exact  # noqa: B018 - asked before anything is written: the report only notes that it has no answer
    needed = [stiffness_text(shaft.stiffness_for(rpm)) for rpm in arguments.rpm]
    points = _points(shaft, arguments.at)
    verdicts = [(eta, q, shaft.verdicts(eta, q, arguments.periods)) for eta, q in points]
    verdict_text = "".join("\n" + point_text(shaft, *row) for row in verdicts)
    text = stability_text(study) + verdict_text
    if arguments.out is not None:
        files, drawn = stability_files(study, shaft, arguments.q, points, arguments.periods, arguments.eta_max)
        files["report.txt"] = f"{files['report.txt']!s}{verdict_text}"
        write_into(arguments.out, {**files, **pictures(painter, *drawn)})
    print(text, end="")
    for line in needed:
        print(line)
    for finding in findings_of(study, ("stability",)):
        print(finding_line(finding))
    return verdict(study, ("stability",))


def _claims(study: Study, shaft: Stability, arguments: StabilityArguments, painter: Painter | None) -> int:
    """Print and write the claims of the paper about its cam, and its figures."""
    require_kim(shaft.coefficients)
    examples = Examples({EXAMPLE: study.design})
    text = claims_text(f"{PAPERS[KIM].label}: printed and computed values", claims(KIM, examples))
    if arguments.out is not None:
        files, chart, figures = kim_files(examples, shaft, arguments.periods, arguments.eta_max or ETA_MAX)
        painted = pictures(painter, chart, *figures)
        named = {name.replace("stability", "figure_8"): data for name, data in painted.items()}
        write_into(arguments.out, {"claims.txt": text, **files, **named})
    print(text, end="")
    return DONE
