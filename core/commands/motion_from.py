"""The command ``motion-from``: the motion that a curve from a drawing gives to a design's follower."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from core.commands import Painter
from core.commands.common import as_json, design_file, drive_name, verdict
from core.contour import GAP_MM, MOST_GAP_MM, UNITS, read_contour, trace
from core.design import only, with_only
from core.design.fields import choice, number
from core.frozen import frozen
from core.output.contour_text import contour_data, contour_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.project.files import read_bytes
from core.requests import asked, typed
from core.study import Study


def _centre(text: str) -> complex:
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        x = y = math.nan
    if not (math.isfinite(x) and math.isfinite(y)):
        raise argparse.ArgumentTypeError(
            f"{text!r}: must be X,Y: two numbers with decimal points, in the drawing's units"
        )
    return complex(x, y)


@frozen(kw_only=True)
class Arguments:
    """Which curve, for which design, and how the drawing is read."""

    design: Path = design_file()
    drive: str = drive_name()
    curve: Path = typed(
        "drawing with one closed curve of lines and arcs; the layer PROFILE counts where it has a curve",
        "CURVE.dxf",
        type=Path,
    )
    out: Path = typed(
        "design file to write: the design with the motion and the base radius of the curve",
        type=Path,
        metavar="FILE.toml",
    )
    units: str = asked(choice("Units", tuple(UNITS), default="", help="of the drawing"), usual="as its header states")
    centre: complex | None = typed(
        "of the cam, in the drawing's units", default=None, usual="its origin", type=_centre, metavar="X,Y"
    )
    gap_mm: float = number(
        "Gap", 0.0, MOST_GAP_MM, default=GAP_MM, help="over which ends of lines and arcs join that belong to no other"
    )
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The design with the motion, and on the terminal what the curve was and where velocity or acceleration jumps."""
    whole = load(arguments.design)
    number = number_of(whole, arguments.drive)
    design = only(whole, number)
    contour = read_contour(
        read_bytes(arguments.curve), arguments.curve.name, arguments.units, arguments.centre, arguments.gap_mm
    )
    traced = trace(design, contour)
    code = verdict(Study(traced.design), ("motion", "cam"))
    save(with_only(whole, number, traced.design), arguments.out)
    print(to_json(contour_data(traced)) if arguments.json else contour_text(traced), end="")
    return code
