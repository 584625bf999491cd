"""The command ``ecam``: a motion as a table for a servo controller, with the error that the controller makes of it."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.bounds import ROWS, number_from_one
from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, drive_name, ending_with
from core.design import Design, Info, only, require_motion, with_only
from core.design.fields import choice, flag, number
from core.design.motion_edits import of_motion
from core.errors import KindynaError
from core.frozen import frozen
from core.measured import (
    ALL_DETECTED,
    DECIMALS,
    DELIMITERS,
    ColumnChoice,
    Errors,
    Switches,
    Worksheet,
    fit,
    is_workbook,
    layout,
    mirror_rows,
    read_sheet,
    read_table,
    read_workbook,
    segment_kinds,
    with_measured_motion,
)
from core.measured.columns import LETTERS
from core.measured.fitting import segment_from_table
from core.output.controllers.deviation import curve_csv, error_curve, facts, text
from core.output.controllers.motion import motion_facts, motion_text, read_motion, with_controller_motion
from core.output.controllers.rows import controller
from core.output.controllers.slave import EcamRequest, drive_slave
from core.output.controllers.table import ecam
from core.output.measured_text import fit_data, fit_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.project.files import read_bytes, write_all
from core.requests import number_reader, option, require_in_range, text_option
from core.units import NO_UNIT

# -- the command ``ecam`` ---------------------------------------------------------------------------------------


@frozen(kw_only=True)
class EcamArguments:
    """Of which design, for which controller, and where to."""

    design: Path = design_file()
    out: Path = text_option("file to write", type=Path, metavar="FILE")
    controller: str = text_option("row of the table of controllers", metavar="SLUG")
    drive: str = drive_name()
    request: EcamRequest = EcamRequest()
    curve: Path | None = text_option(
        "errors of tables with other numbers of rows",
        default=None,
        type=ending_with("errors", ".csv"),
        metavar="OUT.csv",
    )
    json: bool = as_json()


def run_ecam(arguments: EcamArguments, painter: Painter | None) -> int:
    """The file, and its certificate on the terminal."""
    row, request = controller(arguments.controller), arguments.request
    require_in_range(request)
    slave, name, speed = drive_slave(load(arguments.design), arguments.drive, request)
    made = ecam(slave, row, request, name, speed)
    files: dict[Path, str | bytes] = {arguments.out: made.content}
    if arguments.curve is not None:
        files[arguments.curve] = curve_csv(
            error_curve(slave, made.interpolation, made.placing, closing=row.has_both_ends)
        )
    for path, content in files.items():
        write_all(path.parent, {path.name: content})
    print(to_json(facts(made)) if arguments.json else text(made), end="")
    return DONE


# -- the command ``measured`` -----------------------------------------------------------------------------------


def errors(text: str) -> Errors:
    """``0.01``, or ``s=0.001,v=0.5``: by quantity. Raises argparse.ArgumentTypeError."""
    if "=" not in text:
        return ERROR(text)
    made = {}
    for part in text.split(","):
        letter, _, value = (each.strip() for each in part.partition("="))
        if letter not in LETTERS:
            raise argparse.ArgumentTypeError(f"{part!r}: measuring error; allowed: s=E, v=E, a=E")
        made[LETTERS[letter]] = ERROR(value)
    return made


def line_numbers(text: str) -> tuple[int, ...]:
    """``57,60-63``. Raises argparse.ArgumentTypeError."""
    found: list[int] = []
    for part in text.split(","):
        ends = [number_from_one(each.strip(), ROWS) for each in part.split("-")]
        if len(ends) > 2 or not all(ends) or len(found) + ends[-1] - ends[0] > ROWS:
            raise argparse.ArgumentTypeError(f"{part!r}: lines to be left out; allowed: 57,60-63")
        found += range(ends[0], ends[-1] + 1)
    return tuple(found)


def switches(text: str) -> Switches:
    """``56=table,180=modified-sine``. Raises argparse.ArgumentTypeError."""
    made = []
    for part in text.split(","):
        angle, there, kind = (each.strip() for each in part.partition("="))
        if not there or kind not in segment_kinds():
            raise argparse.ArgumentTypeError(
                f"{part!r}: segment; allowed: DEG=KIND, KIND of {', '.join(segment_kinds())}"
            )
        made.append((ANGLE(angle), kind))
    return tuple(made)


ANGLE = number_reader(Info("Cam angle", low=0.0, high=360.0), NO_UNIT)
ERROR = number_reader(Info("Measuring error", low=0.0), NO_UNIT)
LIFT = number_reader(Info("Lift", low=0.0, open_low=True), NO_UNIT)


@frozen(kw_only=True)
class MeasuredArguments:
    """Which table, how it is read and fitted, and where the motion goes."""

    table: Path = text_option("CSV, text or workbook (.xlsx, .ods) with a row for each cam angle", "TABLE", type=Path)
    error: Errors = text_option(
        "measuring error of a value, in its column's unit; one alone is of the displacement; 0 = the rounding of the table",
        default=None,
        default_text="what the rows tell",
        type=errors,
        metavar="E|s=E,v=E,a=E",
    )
    sheet: str = text_option("of a workbook", default="", default_text="its first", metavar="NAME")
    range: str = text_option("of a workbook's sheet", default="", default_text="all of it", metavar="A1:C400")
    leave_out: tuple[int, ...] = text_option(
        "lines of the file that are left out", default=(), type=line_numbers, metavar="LINES"
    )
    columns: ColumnChoice = ALL_DETECTED
    delimiter: str | None = option(
        choice("Delimiter", tuple(DELIMITERS), default=None, help="between cells"), default_text="detected"
    )
    decimal: str | None = option(
        choice("Decimal mark", tuple(DECIMALS), default=None, help="decimal mark"), default_text="detected"
    )
    speed_rpm: float | None = option(
        number("Speed", 0.0, 1e5, open_low=True, default=None),
        help="of the shaft, for times and values per second",
        default_text="that of the design",
    )
    lowest: float | None = option(
        number("Lowest position", default=None, help="lowest position of the motion"),
        default_text="as measured",
        metavar="Y",
    )
    lift: tuple[float, ...] = text_option(
        "where the duration of an event is stated, above the base circle, in the unit of the motion; more than one: again",
        default=(),
        default_text="1 and 1.27 mm",
        action="append",
        type=LIFT,
        metavar="S",
    )
    no_laws: bool = flag("No laws", help="tables between the dwells, no laws of the table of laws")
    no_dwells: bool = flag("No dwells", help="no dwells that stand exactly still; with --no-laws: one spline")
    switch: Switches = text_option(
        "what the segment at a cam angle shall be in place of what is found: table, dwell or a law",
        default=(),
        type=switches,
        metavar="DEG=KIND,...",
    )
    keep_all: bool = flag("All rows", help="fit wrong rows, too, and rows that contradict each other")
    mirror: bool = flag("Mirror", help="the rows are half a lobe, which is reflected in the row of its largest lift")
    controller: str = text_option(
        "the table is of this controller, a row of the table of controllers, and read exactly",
        default="",
        metavar="SLUG",
    )
    segment: int = text_option(
        "the table's first two columns are the curve of this segment of the design, counted from 1, stretched to its span and rise",
        "--segment",
        default=0,
        default_text="the whole motion",
        type=int,
        metavar="N",
    )
    as_is: bool = flag("As it is", help="with --segment: with the table's own span and rise")
    joined: bool = flag(
        "Joined", help="with --segment: velocity and acceleration at its ends are those of its neighbours"
    )
    into: Path | None = text_option("write the motion into a design file", default=None, type=Path, metavar="DESIGN")
    made_as: str | None = option(
        choice("As", ("design", "segment", "motion"), default=None),
        "--as",
        help="a design or motion that is not there yet is made by --into, of the motion alone; segment: that of --segment",
        default_text="design, or segment with --segment",
    )
    drive: str = drive_name()
    json: bool = as_json()


def run_measured(arguments: MeasuredArguments, painter: Painter | None) -> int:
    """A motion fitted to a measured table, printed and perhaps written into a design; the exit code."""
    if arguments.made_as == "segment" and not arguments.segment:
        raise KindynaError("--as segment: wanted: --segment N, which it becomes")
    makes = arguments.made_as in (None, "design", "motion") and not arguments.segment
    new = arguments.into if makes and arguments.into is not None and not arguments.into.exists() else None
    whole = load(arguments.into) if arguments.into is not None and new is None else None
    which = 0 if whole is None else number_of(whole, arguments.drive)
    design = None if whole is None else only(whole, which)
    unit = "mm" if design is None else require_motion(design).unit
    speed = arguments.speed_rpm if arguments.speed_rpm is not None or design is None else design.speed_rpm
    if arguments.controller:
        found = read_motion(controller(arguments.controller), read_bytes(arguments.table), unit=unit)
        if new is not None:
            save(of_motion(found.motion, arguments.table.stem, speed), new)
        elif arguments.into is not None and whole is not None and design is not None:
            save(with_only(whole, which, with_controller_motion(design, found)), arguments.into, in_place=True)
        print(to_json(motion_facts(found)) if arguments.json else motion_text(found), end="")
        return DONE
    data, name = read_bytes(arguments.table), arguments.table.name
    if is_workbook(data):
        sheet = read_workbook(data, name, arguments.sheet, arguments.range)
    else:
        sheet = read_sheet(data, name, arguments.delimiter, arguments.decimal)
    if arguments.segment:
        return _segment(arguments, sheet, whole, which)
    table = read_table(sheet, layout(sheet, arguments.columns, unit, speed), speed, arguments.leave_out)
    fitted = fit(
        mirror_rows(table) if arguments.mirror else table,
        arguments.error,
        arguments.lowest,
        arguments.keep_all,
        not arguments.no_laws,
        not arguments.no_dwells,
        arguments.switch,
    )
    if new is not None:
        save(of_motion(fitted.motion, arguments.table.stem, speed), new)
    elif arguments.into is not None and whole is not None and design is not None:
        save(with_only(whole, which, with_measured_motion(design, fitted)), arguments.into, in_place=True)
    lifts = arguments.lift
    print(to_json(fit_data(sheet, fitted, lifts)) if arguments.json else fit_text(sheet, fitted, lifts), end="")
    return DONE


def _segment(arguments: MeasuredArguments, sheet: Worksheet, whole: Design | None, which: int) -> int:
    """The table as the curve of a segment of the design. Raises KindynaError."""
    if whole is None or arguments.into is None:
        raise KindynaError("measured --segment: wanted: --into DESIGN, whose segment it becomes")
    design = only(whole, which)
    count = len(require_motion(design).segments)
    if not 1 <= arguments.segment <= count:
        raise KindynaError(f"--segment {arguments.segment}: no such segment; allowed: 1 ... {count}")
    index = arguments.segment - 1
    made = segment_from_table(design, index, sheet, as_is=arguments.as_is, joined=arguments.joined)
    save(with_only(whole, which, made), arguments.into, in_place=True)
    row = require_motion(made).segments[index]
    print(
        f"segment {arguments.segment}: {len(sheet.rows)} rows, span {row.span_deg:.9g} deg, rise {row.rise:.9g} {require_motion(made).unit}"
    )
    return DONE
