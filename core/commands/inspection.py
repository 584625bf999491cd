"""The command ``inspection``: the lift that a probe measures on the cam, and whether a measured table keeps its tolerance."""

from __future__ import annotations

import sys
from pathlib import Path

from core.commands import DONE, DONE_WITH_ERRORS, Painter
from core.commands.common import as_json, design_file, drive_name
from core.design.fields import flag
from core.findings import ERROR
from core.frozen import frozen
from core.output.inspection import (
    Inspection,
    ProfileComparison,
    Request,
    compare,
    facts,
    inspection,
    measured_lift,
    require_name,
    write,
)
from core.output.lines import finding_line, printable
from core.output.summary import to_json
from core.project import load_one
from core.project.files import read_bytes
from core.requests import typed
from core.study import Study


@frozen(kw_only=True)
class Arguments:
    """Of which cam, how it is inspected, and the measured table that is held against it."""

    design: Path = design_file()
    drive: str = drive_name()
    out: Path = typed("table to write (.csv), with a summary beside it", type=Path, metavar="FILE")
    request: Request = Request()
    measured: Path | None = typed(
        "measured table: cam angle and lift in each row", default=None, type=Path, metavar="TABLE"
    )
    fit: bool = flag("Fit", help="fit the zero marks of its angles and of its lift by least squares")
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The files, and the verdict on the terminal."""
    require_name(arguments.out)
    made, comparison = inspection(Study(load_one(arguments.design, arguments.drive)), arguments.request), None
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


def _lines(made: Inspection, comparison: ProfileComparison | None) -> list[str]:
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
