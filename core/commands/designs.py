"""Commands about designs: compare, explain, find, report and scale."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from core.commands import DONE, DONE_WITH_ERRORS, NOTHING_DONE, Painter
from core.commands.common import (
    as_json,
    design_file,
    drive_name,
    ending_with,
    in_file,
    one_studied,
    out_folder,
    pictures,
    samples_per_turn,
    studied,
    verdict,
)
from core.design import only, rescaled, scale_text, with_only
from core.design.fields import choice, flag, number
from core.errors import KindynaError, NoSolution
from core.find import BOUNDS, CAM_SEARCHES, LIMITS, SEARCHES, SHAFT_SEARCHES, Solution, StatedLimits, find, same_design
from core.findings import ERROR
from core.frozen import frozen
from core.output.compare import (
    ComparedDesign,
    compare_designs,
    compared_design,
    comparison_csv,
    comparison_data,
    comparison_document,
    comparison_text,
)
from core.output.explain import as_row, explained
from core.output.explain import as_text as explain_as_text
from core.output.export import bounded_study
from core.output.lines import finding_line
from core.output.report import report
from core.output.report.document import ENDINGS, PARTS, Cover, Printed, document
from core.output.summary import summary, to_json
from core.project import load, number_of, save
from core.project.files import write, write_into
from core.requests import option, text_option
from core.shaft import AIMS
from core.study import Study, findings_of
from core.study.limits import FieldBound, Limit

# -- the command ``compare`` ------------------------------------------------------------------------------------


@frozen(kw_only=True)
class CompareArguments:
    """Arguments of ``compare``: two designs and a file."""

    a: Path = text_option("design file (.toml)", "A", type=Path)
    b: Path = text_option("design file to compare with A", "B", type=Path)
    out: Path | None = text_option(
        "also write the comparison to this file",
        default=None,
        type=ending_with("a comparison", ".csv", ".html"),
        metavar="FILE",
    )
    json: bool = as_json()


def run_compare(arguments: CompareArguments, painter: Painter | None) -> int:
    """Print the comparison of two designs; write it to a file where one is given."""
    comparison = compare_designs(_side(arguments.a), _side(arguments.b))
    if arguments.out is not None:
        if arguments.out.suffix.lower() == ".csv":
            write(arguments.out, comparison_csv(comparison).encode())
        else:
            from core.output.report.document import html

            write(arguments.out, html(comparison_document(comparison), {}).encode())
    print(to_json(comparison_data(comparison)) if arguments.json else comparison_text(comparison), end="")
    return DONE


def _side(path: Path) -> ComparedDesign:
    """A design to compare. Raises KindynaError with its file where it has no solution."""
    design = load(path)
    try:
        return compared_design(studied(design))
    except NoSolution as error:
        raise KindynaError(f"{path}: {error}") from error


# -- the command ``explain`` ------------------------------------------------------------------------------------


@frozen(kw_only=True)
class ExplainArguments:
    """Arguments of ``explain``: a design, a quantity and an angle."""

    design: Path = design_file()
    quantity: str = text_option(
        "column of a table, or a figure of the flywheel: drive_torque_nm, needed_inertia_kg_m2", "QUANTITY"
    )
    at: float | None = text_option(
        "angle of cam, crank or machine; by default that of the greatest value", default=None, type=float, metavar="DEG"
    )
    drive: str = drive_name()
    json: bool = as_json()


def run_explain(arguments: ExplainArguments, painter: Painter | None) -> int:
    """Print equation, symbols and proof of a number."""
    study = one_studied(arguments.design, arguments.drive) if arguments.drive else studied(load(arguments.design))
    explanation = explained(study, arguments.quantity, arguments.at)
    print(to_json(as_row(explanation)) if arguments.json else explain_as_text(explanation), end="")
    return DONE


# -- the command ``find`` ---------------------------------------------------------------------------------------


PATIENCE = 2.0  # seconds between two lines of progress


def _limit(text: str) -> tuple[str, float | None]:
    key, equals, value = text.partition("=")
    if equals and value == "none":
        return key, None
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not equals or not math.isfinite(number):
        raise argparse.ArgumentTypeError(
            f"{text!r}: must be KEY=VALUE, the value a number with a decimal point, or none"
        )
    return key, number


def _limits_help() -> str:
    keys = f"{' | '.join(LIMITS)} (radii of the profile), or the path of a varied field with _min or _max"
    table: Mapping[str, Limit | FieldBound] = {**LIMITS, **BOUNDS}
    typical = "; ".join(f"{key} {row.help}" for key, row in table.items() if row.help)
    return f"{keys}. A limit that is not given is that of the design, else the typical one: {typical}. none: no limit"


@frozen(kw_only=True)
class FindArguments:
    """Arguments of ``find``: a design, a dimension and its limits."""

    design: Path = design_file()
    drive: str = drive_name()
    what: str = text_option("; ".join(f"{name}: {words}" for name, words in SEARCHES.items()), "WHAT")
    limit: tuple[tuple[str, float | None], ...] = text_option(
        _limits_help(), default=(), action="append", type=_limit, metavar="KEY=VALUE"
    )
    aim: str = option(
        choice("Aim", tuple(AIMS), default="peak", help="property of the torque that the phases minimise"), "--for"
    )
    into: Path | None = text_option("write the design with the solution", default=None, type=Path, metavar="FILE")
    json: bool = as_json()


def run_find(arguments: FindArguments, painter: Painter | None) -> int:
    """Print the solution, or the best value and the limits that it violates."""
    machine, what = load(arguments.design), arguments.what
    if what in SHAFT_SEARCHES and arguments.drive:
        raise KindynaError(f"--drive {arguments.drive}: {what} belongs to the whole shaft; omit --drive")
    number = 0 if what in SHAFT_SEARCHES else number_of(machine, arguments.drive)
    design = machine if what in SHAFT_SEARCHES else only(machine, number)
    solution = find(
        design,
        what,
        _limits(arguments.limit),
        aim=arguments.aim,
        notify=_Progress().report,
        machine=same_design if what in SHAFT_SEARCHES else partial(with_only, machine, number),
    )
    print(to_json(_data(solution)) if arguments.json else _text(solution), end="")
    if not solution.is_valid:
        print(
            f"no value satisfies every limit; the best one violates: {'; '.join(solution.violations)}", file=sys.stderr
        )
        return NOTHING_DONE
    if arguments.into is not None:
        save(solution.machine, arguments.into)
    is_contact_search = what in CAM_SEARCHES and CAM_SEARCHES[what].seeks_contact
    study, stages = studied(solution.design), ("dynamics",) if what in SHAFT_SEARCHES or is_contact_search else ("cam",)
    errors = [finding for finding in findings_of(study, stages) if finding.severity == ERROR]
    for finding in errors if what in SHAFT_SEARCHES else in_file(errors, machine, number):
        print(finding_line(finding, study.angle_name), file=sys.stderr)
    return DONE_WITH_ERRORS if errors else DONE


class _Progress:
    """Prints the number of designs tried, every ``PATIENCE`` seconds, on a terminal."""

    def __init__(self) -> None:
        self._last = time.monotonic()

    def report(self, count: int) -> None:
        now = time.monotonic()
        if now - self._last > PATIENCE and sys.stderr.isatty():
            self._last = now
            print(f"{count} designs tried ...", file=sys.stderr)


def _limits(given: Sequence[tuple[str, float | None]]) -> StatedLimits:
    """Limits by key. Raises KindynaError for a key with two values."""
    limits = dict(given)
    for key, value in given:
        if value != limits[key]:
            both = (f"{key} = {'none' if bound is None else f'{bound:g}'}" for bound in (value, limits[key]))
            raise KindynaError(f"limit {', '.join(both)}: a limit has one value; give one")
    return limits


def _data(solution: Solution) -> dict[str, object]:
    return {
        "answer": dict(solution.answer),
        "reached": dict(solution.reached),
        "curve": [list(point) for point in solution.curve],
        "limits": dict(solution.limits),
        "reasons": dict(solution.reasons),
        "curve_of": solution.curve_of,
        "against": list(solution.violations),
        "end": solution.end,
        "held_by": list(solution.next_findings),
        "besides": list(solution.notes),
        "taken": dict(solution.applied),
        "assumed": dict(solution.assumed),
    }


def _text(solution: Solution) -> str:
    heading = f"{solution.target}:" if solution.is_valid else "the best value, which violates limits:"
    lines = [heading, *(f"  {path} = {value:.9g}" for path, value in solution.answer.items()), "reached:"]
    for key, value in solution.reached.items():
        number = f"{value:.7g}" if math.isfinite(value) else "none"
        limit, reason = solution.limits.get(key), solution.reasons.get(key)
        against = "" if limit is None else ", not undercut" if not limit and key in LIMITS else f", limit {limit:.6g}"
        lines.append(f"  {key} = {number}{against}{f' ({reason})' if reason else ''}")
    lines += [f"it depends on {path} = {value:.9g}, which is assumed" for path, value in solution.assumed.items()]
    if solution.end:
        lines.append(f"no limit determines it: it is at the end of its range, {solution.end}")
    lines += [f"beyond it: {text}" for text in solution.next_findings]
    lines += [f"comes with it: {text}" for text in solution.notes]
    lines += [f"set in the design: {path} = {value:.12g}" for path, value in solution.applied.items()]
    return "\n".join(lines) + "\n"


# -- the command ``report`` -------------------------------------------------------------------------------------


@frozen(kw_only=True)
class ReportArguments:
    """Arguments of ``report``: a design, a folder or file, and the parts to leave out of a file."""

    design: Path = design_file()
    samples: int = samples_per_turn()
    out: Path | None = out_folder(
        "also write report, summary and pictures there; NAME.html or NAME.pdf: instead, the report as one file"
    )
    without: tuple[str, ...] = text_option(
        f"parts to leave out of NAME.html or NAME.pdf: {', '.join(PARTS)}",
        default=(),
        nargs="+",
        choices=tuple(PARTS),
        metavar="PART",
    )
    cover: Cover = Cover()


def run_report(arguments: ReportArguments, painter: Painter | None) -> int:
    """Print the report; with a folder, write it as files too."""
    study = studied(load(arguments.design), arguments.samples)
    if arguments.out is not None and arguments.out.suffix.lower() in ENDINGS:
        return _write_document(study, arguments, painter)
    text = report(study)
    if arguments.out is not None:
        files: dict[str, str | bytes] = {"report.txt": text, "summary.json": to_json(summary(bounded_study(study)))}
        write_into(arguments.out, {**files, **_pictures(study, painter)})
    print(text, end="")
    return verdict(study)


def _pictures(study: Study, painter: Painter | None) -> Mapping[str, bytes]:
    """Pictures of a design; of several drives, in a folder of every drive."""
    if painter is None:
        return pictures(painter)
    drawn = ((slug, painter(drive)) for slug, drive in study.solved_drives.items())
    return {f"{slug}/{name}".removeprefix("/"): data for slug, images in drawn for name, data in images.items()}


def _write_document(study: Study, arguments: ReportArguments, painter: Painter | None) -> int:
    """Write the report as one HTML or PDF file."""
    out = arguments.out
    assert out is not None
    ending = out.suffix.lower()
    report_document = document(study, [name for name in PARTS if name not in arguments.without], arguments.cover)
    if report_document.lacking:
        print(report_document.lacking, file=sys.stderr)
    painted = painter(Printed(report_document, ending)) if painter is not None else {}
    if ending not in painted:
        if ending != ".html":
            raise KindynaError(f"{out}: a PDF needs kindyna --headless; NAME.html can be written without it")
        if painter is None and report_document.pictures:
            print("pictures left out: they need kindyna --headless", file=sys.stderr)
        from core.output.report.document import html

        painted = {ending: html(report_document, {}).encode()}
    write(out, painted[ending])
    print(out)
    return verdict(study)


# -- the command ``scale`` --------------------------------------------------------------------------------------


@frozen(kw_only=True)
class ScaleArguments:
    """Arguments of ``scale``: a design, a factor and a file."""

    design: Path = design_file()
    factor: float = option(
        number("Factor of all lengths", 0.0, open_low=True, help="0.1 or 1/10 makes the machine ten times smaller"),
        "FACTOR",
        help="of all lengths, with a decimal point: 0.1",
    )
    out: Path = text_option("design file to write", type=Path, metavar="FILE.toml")
    masses: bool = option(
        flag("Scale masses and inertias too, as for the same material", default=True),
        "--keep-masses",
        help="keep masses and moments of inertia; else they are scaled by FACTOR^3 and FACTOR^5, as parts of the same "
        "material do",
    )


def run_scale(arguments: ScaleArguments, painter: Painter | None) -> int:
    """Write the scaled design to a file, and print what was scaled."""
    if arguments.out.resolve() == arguments.design.resolve():
        raise KindynaError(f"--out {arguments.out}: is the design that is read; choose another file")
    save(rescaled(load(arguments.design), arguments.factor, masses=arguments.masses), arguments.out)
    print(scale_text(arguments.factor, arguments.masses))
    return DONE
