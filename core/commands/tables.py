"""Commands about tables: ecam and measured."""

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
    MotionFit,
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
from core.measured.segment_table import segment_from_table
from core.number_text import result_text
from core.output.controllers.deviation import curve_csv, error_curve, facts, text
from core.output.controllers.motion import (
    ControllerMotion,
    motion_facts,
    motion_text,
    read_motion,
    with_controller_motion,
)
from core.output.controllers.rows import controller
from core.output.controllers.slave import EcamRequest, drive_slave
from core.output.controllers.table import Ecam, ecam
from core.output.measured_text import fit_data, fit_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.project.files import read_bytes, write_all
from core.requests import number_reader, option, require_in_range, text_option
from core.units import NO_UNIT

# -- the command ``ecam`` ---------------------------------------------------------------------------------------


@frozen(kw_only=True)
class EcamArguments:
    """Arguments of ``ecam``: a design, a controller and a file."""

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
    """Write the table, and print its certificate."""
    result, curve = controller_table(load(arguments.design), arguments)
    files: dict[Path, str | bytes] = {arguments.out: result.content, **curve}
    for path, content in files.items():
        write_all(path.parent, {path.name: content})
    print(to_json(facts(result)) if arguments.json else text(result), end="")
    return DONE


def controller_table(design: Design, arguments: EcamArguments) -> tuple[Ecam, dict[Path, str]]:
    """Table for a controller; the file of ``curve`` with its content, where it is requested. Raises KindynaError, NoSolution."""
    row, request = controller(arguments.controller), arguments.request
    require_in_range(request)
    slave, name, speed = drive_slave(design, arguments.drive, request)
    result = ecam(slave, row, request, name, speed)
    if arguments.curve is None:
        return result, {}
    errors_by_rows = error_curve(slave, result.interpolation, result.placing, closing=row.has_both_ends)
    return result, {arguments.curve: curve_csv(errors_by_rows)}


# -- the command ``measured`` -----------------------------------------------------------------------------------


def errors(text: str) -> Errors:
    """Read measuring errors, as ``0.01``, or ``s=0.001,v=0.5`` by quantity. Raises argparse.ArgumentTypeError."""
    if "=" not in text:
        return ERROR(text)
    by_quantity = {}
    for part in text.split(","):
        letter, _, value = (text.strip() for text in part.partition("="))
        if letter not in LETTERS:
            raise argparse.ArgumentTypeError(f"{part!r}: measuring error; allowed: s=E, v=E, a=E")
        by_quantity[LETTERS[letter]] = ERROR(value)
    return by_quantity


def line_numbers(text: str) -> tuple[int, ...]:
    """Read numbers of lines, as ``57,60-63``. Raises argparse.ArgumentTypeError."""
    numbers: list[int] = []
    for part in text.split(","):
        ends = [number_from_one(end.strip(), ROWS) for end in part.split("-")]
        if len(ends) > 2 or not all(ends) or len(numbers) + ends[-1] - ends[0] > ROWS:
            raise argparse.ArgumentTypeError(f"{part!r}: lines to be left out; allowed: 57,60-63")
        numbers += range(ends[0], ends[-1] + 1)
    return tuple(numbers)


def switches(text: str) -> Switches:
    """Read kinds of segments, as ``56=table,180=modified-sine``. Raises argparse.ArgumentTypeError."""
    kinds = []
    for part in text.split(","):
        angle, mark, kind = (text.strip() for text in part.partition("="))
        if not mark or kind not in segment_kinds():
            raise argparse.ArgumentTypeError(
                f"{part!r}: segment; allowed: DEG=KIND, KIND of {', '.join(segment_kinds())}"
            )
        kinds.append((ANGLE(angle), kind))
    return tuple(kinds)


ANGLE = number_reader(Info("Cam angle", low=0.0, high=360.0), NO_UNIT)
ERROR = number_reader(Info("Measuring error", low=0.0), NO_UNIT)
LIFT = number_reader(Info("Lift", low=0.0, open_low=True), NO_UNIT)


@frozen(kw_only=True)
class MeasuredArguments:
    """Arguments of ``measured``: a table, how it is read and fitted, and a design for the motion."""

    table: Path = text_option("CSV, text or workbook (.xlsx, .ods) with a row for every cam angle", "TABLE", type=Path)
    error: Errors = text_option(
        "measuring error of a value, in its column's unit; a single one is of the displacement; 0 = the rounding of the table",
        default=None,
        default_text="estimated from the rows",
        type=errors,
        metavar="E|s=E,v=E,a=E",
    )
    sheet: str = text_option("sheet of a workbook", default="", default_text="its first", metavar="NAME")
    range: str = text_option("cells of a workbook's sheet", default="", default_text="all of it", metavar="A1:C400")
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
        "lift above the base circle at which the duration of an event is stated, in the unit of the motion; repeat it",
        default=(),
        default_text="1 and 1.27 mm",
        action="append",
        type=LIFT,
        metavar="S",
    )
    no_laws: bool = flag("No laws", help="fit tables between the dwells, no motion laws")
    no_dwells: bool = flag("No dwells", help="no exact dwells; with --no-laws: one spline")
    switch: Switches = text_option(
        "kind of the segment at a cam angle, instead of the recognised one: table, dwell or a law",
        default=(),
        type=switches,
        metavar="DEG=KIND,...",
    )
    keep_all: bool = flag("All rows", help="fit outliers too, and rows that contradict each other")
    mirror: bool = flag("Mirror", help="reflect half a lobe in the row of its greatest lift")
    controller: str = text_option(
        "read the table exactly, as a table of this controller",
        default="",
        metavar="SLUG",
    )
    segment: int = text_option(
        "segment of the design, from 1, whose curve the first two columns give, scaled to its span and rise",
        "--segment",
        default=0,
        default_text="the whole motion",
        type=int,
        metavar="N",
    )
    as_is: bool = flag("As it is", help="with --segment: with the span and rise of the table")
    joined: bool = flag(
        "Joined", help="with --segment: velocity and acceleration at its ends are those of its neighbours"
    )
    into: Path | None = text_option("write the motion into a design file", default=None, type=Path, metavar="DESIGN")
    made_as: str | None = option(
        choice("As", ("design", "segment", "motion"), default=None),
        "--as",
        help="a new design or motion for --into, of the motion alone; segment: that of --segment",
        default_text="design, or segment with --segment",
    )
    drive: str = drive_name()
    json: bool = as_json()


def run_measured(arguments: MeasuredArguments, painter: Painter | None) -> int:
    """Fit a motion to a measured table, print it, and write it into a design where one is given."""
    if arguments.made_as == "segment" and not arguments.segment:
        raise KindynaError("--as segment: give --segment N too")
    is_new_design = arguments.made_as in (None, "design", "motion") and not arguments.segment
    new = arguments.into if is_new_design and arguments.into is not None and not arguments.into.exists() else None
    machine = load(arguments.into) if arguments.into is not None and new is None else None
    which = 0 if machine is None else number_of(machine, arguments.drive)
    design = None if machine is None else only(machine, which)
    unit = "mm" if design is None else require_motion(design).unit
    speed = arguments.speed_rpm if arguments.speed_rpm is not None or design is None else design.speed_rpm
    if arguments.controller:
        controller_motion = _controller_motion(arguments, unit)
        if new is not None:
            save(of_motion(controller_motion.motion, arguments.table.stem, speed), new)
        elif arguments.into is not None and machine is not None and design is not None:
            save(
                with_only(machine, which, with_controller_motion(design, controller_motion)),
                arguments.into,
                in_place=True,
            )
        print(to_json(motion_facts(controller_motion)) if arguments.json else motion_text(controller_motion), end="")
        return DONE
    sheet = _sheet(arguments)
    if arguments.segment:
        return _segment(arguments, sheet, machine, which)
    fitted = _fit(arguments, sheet, unit, speed)
    if new is not None:
        save(of_motion(fitted.motion, arguments.table.stem, speed), new)
    elif arguments.into is not None and machine is not None and design is not None:
        save(with_only(machine, which, with_measured_motion(design, fitted)), arguments.into, in_place=True)
    lifts = arguments.lift
    print(to_json(fit_data(sheet, fitted, lifts)) if arguments.json else fit_text(sheet, fitted, lifts), end="")
    return DONE


def measured_design(arguments: MeasuredArguments) -> Design:
    """Design of the measured motion alone, as for a new file of ``into``. Raises KindynaError."""
    if arguments.made_as == "segment":
        raise KindynaError("--as segment: requires a design with that segment; allowed: design | motion")
    if arguments.controller:
        motion = _controller_motion(arguments).motion
    else:
        motion = _fit(arguments, _sheet(arguments), "mm", arguments.speed_rpm).motion
    return of_motion(motion, arguments.table.stem, arguments.speed_rpm)


def _controller_motion(arguments: MeasuredArguments, unit: str = "mm") -> ControllerMotion:
    return read_motion(controller(arguments.controller), read_bytes(arguments.table), unit=unit)


def _sheet(arguments: MeasuredArguments) -> Worksheet:
    data, name = read_bytes(arguments.table), arguments.table.name
    if is_workbook(data):
        return read_workbook(data, name, arguments.sheet, arguments.range)
    return read_sheet(data, name, arguments.delimiter, arguments.decimal)


def _fit(arguments: MeasuredArguments, sheet: Worksheet, unit: str, speed: float | None) -> MotionFit:
    """Fit of a table, whose motion is in ``unit`` where its columns do not say."""
    table = read_table(sheet, layout(sheet, arguments.columns, unit, speed), speed, arguments.leave_out)
    return fit(
        mirror_rows(table) if arguments.mirror else table,
        arguments.error,
        arguments.lowest,
        arguments.keep_all,
        not arguments.no_laws,
        not arguments.no_dwells,
        arguments.switch,
    )


def _segment(arguments: MeasuredArguments, sheet: Worksheet, machine: Design | None, which: int) -> int:
    """Write the table into a design as the curve of a segment. Raises KindynaError."""
    if machine is None or arguments.into is None:
        raise KindynaError("measured --segment: give --into DESIGN too")
    design = only(machine, which)
    count = len(require_motion(design).segments)
    if not 1 <= arguments.segment <= count:
        raise KindynaError(f"--segment {arguments.segment}: no such segment; allowed: 1 ... {count}")
    index = arguments.segment - 1
    changed = segment_from_table(design, index, sheet, as_is=arguments.as_is, joined=arguments.joined)
    save(with_only(machine, which, changed), arguments.into, in_place=True)
    row = require_motion(changed).segments[index]
    print(
        f"segment {arguments.segment}: {len(sheet.rows)} rows, span {result_text(row.span_deg, 6)} deg, "
        f"rise {result_text(row.rise, 6)} {require_motion(changed).unit}"
    )
    return DONE
