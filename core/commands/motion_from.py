"""The command ``motion-from``: the motion that a curve from a drawing gives to a design's follower."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from core.commands import Painter
from core.commands.common import design_file, drive_option, number, verdict
from core.contour import GAP_MM, MOST_GAP_MM, UNITS, read_contour, trace
from core.design import only, with_only
from core.output.contour_text import contour_data, contour_text
from core.output.summary import to_json
from core.project import load, number_of, save
from core.project.files import read_bytes
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


def options(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    drive_option(parser)
    curve = "drawing with one closed curve of lines and arcs; the layer PROFILE counts where it has a curve"
    parser.add_argument("curve", metavar="CURVE.dxf", type=Path, help=curve)
    out = "design file to write: the design with the motion and the base radius of the curve"
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.toml", help=out)
    parser.add_argument("--units", default="", choices=tuple(UNITS), help="of the drawing (as its header states)")
    parser.add_argument("--centre", type=_centre, metavar="X,Y", help="of the cam, in the drawing's units (its origin)")
    gap = number("a gap in mm", f"0 ... {MOST_GAP_MM:g}")
    closes = f"over which ends of lines and arcs join that belong to no other ({GAP_MM:g})"
    parser.add_argument("--gap", type=gap, default=GAP_MM, metavar="MM", help=closes)
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The design with the motion, and on the terminal what the curve was and where velocity or acceleration jumps."""
    whole = load(arguments.design)
    number = number_of(whole, arguments.drive)
    design = only(whole, number)
    contour = read_contour(
        read_bytes(arguments.curve), arguments.curve.name, arguments.units, arguments.centre, arguments.gap
    )
    traced = trace(design, contour)
    code = verdict(Study(traced.design), ("motion", "cam"))
    save(with_only(whole, number, traced.design), arguments.out)
    print(to_json(contour_data(traced)) if arguments.json else contour_text(traced), end="")
    return code
