"""The command ``measured``: a table read, a motion fitted to it, printed and perhaps written into a design."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import number
from core.design import require_motion
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
from core.project import load, save
from core.project.files import read_bytes


def words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("table", metavar="TABLE", type=Path, help="CSV or text file with a row for each cam angle")
    parser.add_argument(
        "--error",
        type=number("measuring error", "0 or more", lambda v: v >= 0.0),
        metavar="E",
        help="measuring error of a value, in the table's unit; 0 = through all rows (what the rows tell)",
    )
    parser.add_argument("--column", default="", metavar="NAME", help="of the values: its name, or number from 1")
    parser.add_argument("--angle-column", default="", metavar="NAME", help="of the angles or times")
    parser.add_argument(
        "--angle-unit", default="", choices=(*ANGLE_UNITS, *TIME_UNITS), help="where the header does not say"
    )
    parser.add_argument("--value-unit", default="", metavar="UNIT", help="mm, in, mm/s, mm/deg2, g, ...")
    parser.add_argument("--quantity", default="", choices=QUANTITIES, help="what was measured")
    parser.add_argument("--delimiter", choices=tuple(DELIMITERS), help="between cells (detected)")
    parser.add_argument("--decimal", choices=tuple(DECIMALS), help="decimal mark (detected)")
    parser.add_argument(
        "--speed",
        type=number("speed in rpm", "above 0", lambda v: v > 0.0),
        metavar="RPM",
        help="of the shaft, for times and values per second (that of the design)",
    )
    parser.add_argument(
        "--lowest",
        type=number("lowest position", "any number"),
        metavar="Y",
        help="lowest position of the motion (as measured)",
    )
    parser.add_argument("--keep-all", action="store_true", help="fit wrong rows, too, and rows that contradict each other")
    parser.add_argument("--into", type=Path, metavar="DESIGN", help="write the motion into a design file")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(words: argparse.Namespace, painter: Painter | None) -> int:
    """A motion fitted to a measured table, printed and perhaps written into a design; the exit code."""
    design = load(words.into) if words.into is not None else None
    unit = "mm" if design is None else require_motion(design).unit
    speed = words.speed if words.speed is not None or design is None else design.speed_rpm
    wish = ColumnChoice(words.column, words.angle_column, words.angle_unit, words.value_unit, words.quantity)
    sheet = read_sheet(read_bytes(words.table), words.table.name, words.delimiter, words.decimal)
    table = read_table(sheet, layout(sheet, wish, unit, speed), speed)
    found = fit(table, words.error, words.lowest, words.keep_all)
    if design is not None:
        save(into_design(design, found), words.into)
    print(to_json(fit_data(sheet, found)) if words.json else fit_text(sheet, found), end="")
    return DONE
