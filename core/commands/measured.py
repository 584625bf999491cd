"""The command ``measured``: a table read, a motion fitted to it, printed and perhaps written into a design."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import drive_option, number
from core.design import only, require_motion, with_only
from core.measured import (
    ANGLE_UNITS,
    DECIMALS,
    DELIMITERS,
    QUANTITIES,
    TIME_UNITS,
    ColumnChoice,
    fit,
    into_design,
    layout,
    read_sheet,
    read_table,
)
from core.output.measured_text import fit_data, fit_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.project.files import read_bytes


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("table", metavar="TABLE", type=Path, help="CSV or text file with a row for each cam angle")
    error = number("measuring error", "0 or more", lambda v: v >= 0.0)
    exact = "measuring error of a value, in the table's unit; 0 = through all rows (what the rows tell)"
    parser.add_argument("--error", type=error, metavar="E", help=exact)
    parser.add_argument("--column", default="", metavar="NAME", help="of the values: its name, or number from 1")
    parser.add_argument("--angle-column", default="", metavar="NAME", help="of the angles or times")
    units = (*ANGLE_UNITS, *TIME_UNITS)
    parser.add_argument("--angle-unit", default="", choices=units, help="where the header does not say")
    parser.add_argument("--value-unit", default="", metavar="UNIT", help="mm, in, mm/s, mm/deg2, g, ...")
    parser.add_argument("--quantity", default="", choices=QUANTITIES, help="what was measured")
    parser.add_argument("--delimiter", choices=tuple(DELIMITERS), help="between cells (detected)")
    parser.add_argument("--decimal", choices=tuple(DECIMALS), help="decimal mark (detected)")
    speed = number("speed in rpm", "above 0", lambda v: v > 0.0)
    shaft = "of the shaft, for times and values per second (that of the design)"
    parser.add_argument("--speed", type=speed, metavar="RPM", help=shaft)
    lowest = number("lowest position", "any number")
    parser.add_argument("--lowest", type=lowest, metavar="Y", help="lowest position of the motion (as measured)")
    parser.add_argument(
        "--keep-all", action="store_true", help="fit wrong rows, too, and rows that contradict each other"
    )
    parser.add_argument("--into", type=Path, metavar="DESIGN", help="write the motion into a design file")
    drive_option(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """A motion fitted to a measured table, printed and perhaps written into a design; the exit code."""
    whole = load(arguments.into) if arguments.into is not None else None
    which = 0 if whole is None else number_of(whole, arguments.drive)
    design = None if whole is None else only(whole, which)
    unit = "mm" if design is None else require_motion(design).unit
    speed = arguments.speed if arguments.speed is not None or design is None else design.speed_rpm
    wish = ColumnChoice(
        arguments.column, arguments.angle_column, arguments.angle_unit, arguments.value_unit, arguments.quantity
    )
    sheet = read_sheet(read_bytes(arguments.table), arguments.table.name, arguments.delimiter, arguments.decimal)
    table = read_table(sheet, layout(sheet, wish, unit, speed), speed)
    fitted = fit(table, arguments.error, arguments.lowest, arguments.keep_all)
    if whole is not None and design is not None:
        save(with_only(whole, which, into_design(design, fitted)), arguments.into, in_place=True)
    print(to_json(fit_data(sheet, fitted)) if arguments.json else fit_text(sheet, fitted), end="")
    return DONE
