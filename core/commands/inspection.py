"""The command ``inspection``: the lift that a probe measures on the cam, and whether a measured table keeps its tolerance."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from core.commands import DONE, DONE_WITH_ERRORS, Painter
from core.commands.common import design_file, drive_option, number
from core.findings import ERROR
from core.output.inspection import (
    ANGLES,
    LEAST_ANGLES,
    MOST_ANGLES,
    PROBES,
    TOLERANCE_MM,
    Comparison,
    Inspection,
    Request,
    compare,
    facts,
    inspection,
    measured_lift,
    require_name,
    write,
)
from core.output.lines import finding_line, printable
from core.output.profile import ALL_FLANKS
from core.output.summary import to_json
from core.project import load_one
from core.project.files import read_bytes
from core.study import Study


def _count(text: str) -> int:
    allowed = f"{LEAST_ANGLES} ... {MOST_ANGLES}"
    return int(number("cam angles", allowed, lambda v: v == int(v) and LEAST_ANGLES <= v <= MOST_ANGLES)(text))


def options(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    drive_option(parser)
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE", help="table to write (.csv), with a summary beside it"
    )
    parser.add_argument(
        "--probe", default="", choices=tuple(PROBES), help="what touches the cam (as its own follower does)"
    )
    length = number("a length in mm", "above 0", lambda v: v > 0.0)
    parser.add_argument(
        "--radius", type=length, metavar="MM", help="of a roller or ball (that of the cam's own follower)"
    )
    band = number("a tolerance in mm", "0 or more", lambda v: v >= 0.0)
    half = f"half the band, normal to the profile ({TOLERANCE_MM:g})"
    parser.add_argument("--tolerance", type=band, default=TOLERANCE_MM, metavar="MM", help=half)
    parser.add_argument(
        "--samples", type=_count, default=ANGLES, metavar="N", help=f"equally spaced cam angles ({ANGLES})"
    )
    parser.add_argument("--flank", default="inner", choices=ALL_FLANKS, help="which side of the cam (inner)")
    direction = number("a direction in degrees", "any number")
    stands = (
        "where the probe stands, seen from the cam centre, counter-clockwise from the x axis (as the follower, else 90)"
    )
    parser.add_argument("--direction", type=direction, metavar="DEG", help=stands)
    parser.add_argument("--measured", type=Path, metavar="TABLE", help="measured table: cam angle and lift in each row")
    parser.add_argument(
        "--fit", action="store_true", help="fit the zero marks of its angles and of its lift by least squares"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The files, and the verdict on the terminal."""
    require_name(arguments.out)
    request = Request(
        arguments.probe, arguments.radius, arguments.tolerance, arguments.samples, arguments.flank, arguments.direction
    )
    made, comparison = inspection(Study(load_one(arguments.design, arguments.drive)), request), None
    if arguments.measured is not None:
        comparison = compare(
            made.probing, measured_lift(read_bytes(arguments.measured), arguments.measured.name), arguments.fit
        )
    elif arguments.fit:
        print("--fit is left aside: there is no measured table", file=sys.stderr)
    paths = write(made, arguments.out, comparison)
    if arguments.json:
        print(to_json(facts(made, comparison)), end="")
    else:
        print("\n".join([*map(str, paths), *_lines(made, comparison)]))
    findings = made.probing.findings if comparison is None else comparison.findings
    for finding in findings:
        print(finding_line(finding), file=sys.stderr)
    return DONE_WITH_ERRORS if any(finding.severity == ERROR for finding in findings) else DONE


def _lines(made: Inspection, comparison: Comparison | None) -> list[str]:
    """What the files hold."""
    at = made.probing
    size = f", radius {at.radius:.9g} mm" if at.kind.radius else ""
    lines = [
        f"{at.kind.label}{size}; lift 0 at {at.base:.9g} mm from the cam centre, largest {made.table.lift.max():.9g} mm",
    ]
    if comparison is None:
        return lines
    row = comparison.worst
    if comparison.fitted:
        lines.append(
            f"fitted: cam angle = angle {comparison.angle_offset:+.6g} deg, lift = measured {-comparison.lift_offset:+.6g} mm"
        )
    band = at.request.tolerance_mm
    lines += [
        *(printable(note) for note in comparison.notes),
        f"{comparison.lines.size} rows; largest deviation {comparison.normal[row]:+.4g} mm normal to the profile "
        f"({comparison.deviation[row]:+.4g} mm of lift) at {comparison.table.degrees[row]:.6g} deg, line {comparison.lines[row]}",
        f"in tolerance, ± {band:g} mm"
        if comparison.in_tolerance
        else f"OUT OF TOLERANCE, ± {band:g} mm, in {comparison.out.sum()} rows",
    ]
    return lines
