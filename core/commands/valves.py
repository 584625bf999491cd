"""The command ``valve``: figures of the valves of a design on the crank, and the lift table of a lobe."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, drive_name, ending_with
from core.design import numbered
from core.errors import KindynaError
from core.frozen import frozen
from core.output.export import csv
from core.output.summary import to_json
from core.project import load, load_one
from core.project.files import write_all
from core.requests import text_option
from core.valves import LIFTS, lift_table, require_opening, valve_data, valve_timings
from core.valves.figures import INCH, LiftTableRequest, valve_text

UNITS = {"": 1.0, "mm": 1.0, "in": INCH, "thou": INCH / 1000.0}
"""Unit of a lift -> its size [mm]."""


def lifts(text: str) -> tuple[float, ...]:
    """Read lifts in mm, as ``0.15,0.050in,1mm,20thou``. Raises argparse.ArgumentTypeError."""
    values = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*(\d*\.?\d+(?:e-?\d+)?)\s*(mm|in|thou)?\s*", part)
        value = float(match[1]) * UNITS[match[2] or ""] if match else 0.0
        if not 0.0 < value < 1e6:
            raise argparse.ArgumentTypeError(f"{part!r}: lift; allowed: above 0, as 0.15, 1mm, 0.050in or 20thou")
        values.append(round(value, 12))
    return tuple(values)


@frozen(kw_only=True)
class ValveArguments(LiftTableRequest):
    """Arguments of ``valve``: a design with valves, the lifts of the events, and a file for the lift table."""

    design: Path = design_file()
    at: tuple[float, ...] = text_option(
        "lifts of the events: 0.15,0.050in,1mm,20thou",
        default=LIFTS,
        default_text="0.1524,1.27,1 mm",
        type=lifts,
        metavar="LIFTS",
    )
    drive: str = drive_name()
    table: Path | None = text_option(
        "file for the lift of the follower by cam degree from the nose",
        default=None,
        type=ending_with("table", ".csv"),
        metavar="FILE.csv",
    )
    json: bool = as_json()


def run_valve(arguments: ValveArguments, painter: Painter | None) -> int:
    """Print the figures, or write the table."""
    if arguments.table is not None:
        names, columns = lift_table(load_one(arguments.design, arguments.drive), arguments.step, arguments.unit)
        write_all(arguments.table.parent, {arguments.table.name: csv(names, columns)})
        print(arguments.table)
        return DONE
    design = load(arguments.design)
    timings = valve_timings(design)
    if arguments.drive:
        name = design.drives[numbered(design, arguments.drive)].name
        timings = tuple(timing for timing in timings if timing.name == name)
        if not timings:
            raise KindynaError(f"drive {arguments.drive!r}: it moves no valve; allowed: a drive with [drives.valve]")
    require_opening(timings)
    data = valve_data(timings, arguments.at)
    print(to_json(data) if arguments.json else valve_text(data), end="")
    return DONE
