"""The command ``ecam``: a motion as a table for a servo controller, with the error that the controller makes of it."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import as_json, design_file, drive_name, ending_with
from core.frozen import frozen
from core.output.controllers.facts import curve_csv, error_curve, facts, text
from core.output.controllers.made import ecam
from core.output.controllers.of_design import slave_of
from core.output.controllers.request import Request
from core.output.controllers.row import controller
from core.output.summary import to_json
from core.project import load
from core.project.files import write_all
from core.requests import require, typed


@frozen(kw_only=True)
class Arguments:
    """Of which design, for which controller, and where to."""

    design: Path = design_file()
    out: Path = typed("file to write", type=Path, metavar="FILE")
    controller: str = typed("row of the table of controllers", metavar="SLUG")
    drive: str = drive_name()
    request: Request = Request()
    curve: Path | None = typed(
        "errors of tables with other numbers of rows",
        default=None,
        type=ending_with("errors", ".csv"),
        metavar="OUT.csv",
    )
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The file, and its certificate on the terminal."""
    row, request = controller(arguments.controller), arguments.request
    require(request)
    slave, name, speed = slave_of(load(arguments.design), arguments.drive, request)
    made = ecam(slave, row, request, name, speed)
    files: dict[Path, str | bytes] = {arguments.out: made.content}
    if arguments.curve is not None:
        files[arguments.curve] = curve_csv(error_curve(slave, made.interpolation, made.placing, closing=row.closing))
    for path, content in files.items():
        write_all(path.parent, {path.name: content})
    print(to_json(facts(made)) if arguments.json else text(made), end="")
    return DONE
