"""Commands about designs: compare, explain, report and scale."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import (
    as_json,
    design_file,
    drive_name,
    ending_with,
    one_studied,
    out_folder,
    pictures,
    samples_per_turn,
    studied,
    verdict,
)
from core.design import rescaled, scale_text
from core.design.fields import flag, number
from core.errors import KindynaError, NoSolution
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
from core.output.report import report
from core.output.report.document import ENDINGS, PARTS, Cover, Document, Printed, document
from core.output.summary import summary, to_json
from core.project import load, save
from core.project.files import write, write_into
from core.requests import option, text_option
from core.study import Study

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
    study = one_studied(load(arguments.design), arguments.drive) if arguments.drive else studied(load(arguments.design))
    explanation = explained(study, arguments.quantity, arguments.at)
    print(to_json(as_row(explanation)) if arguments.json else explain_as_text(explanation), end="")
    return DONE


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


def requested_document(study: Study, arguments: ReportArguments) -> Document:
    """The report as a document with the requested parts and cover. Raises NoSolution where the design has no solution."""
    return document(study, [name for name in PARTS if name not in arguments.without], arguments.cover)


def _write_document(study: Study, arguments: ReportArguments, painter: Painter | None) -> int:
    """Write the report as one HTML or PDF file."""
    out = arguments.out
    assert out is not None
    ending = out.suffix.lower()
    report_document = requested_document(study, arguments)
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
    design = load(arguments.design)
    save(rescaled(design, arguments.factor, masses=arguments.masses), arguments.out)
    print(scale_text(design, arguments.factor, arguments.masses))
    return DONE
