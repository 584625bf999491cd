"""The command ``profile``: a cam's profile, or the path of its cutter, as a file for machines and drawings."""

from __future__ import annotations

from pathlib import Path

from core.commands import Painter
from core.commands.common import as_json, design_file, drive_name, one_studied, verdict
from core.frozen import frozen
from core.output.profile import (
    FORMATS,
    Request,
    facts_text,
    job_of,
    write,
)
from core.output.profile.digits import rounded_up
from core.requests import typed


@frozen(kw_only=True)
class Arguments:
    """Of which cam, and what the file shall hold."""

    design: Path = design_file()
    out: Path = typed(
        f"file to write, its ending says how: {'|'.join(FORMATS)}; FILE.json beside it holds the facts, as --json prints them",
        type=Path,
        metavar="FILE",
    )
    drive: str = drive_name()
    request: Request = Request()
    json: bool = as_json()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """The file, and the deviation that it reaches on the terminal."""
    study = one_studied(arguments.design, arguments.drive)
    job = job_of(study, arguments.out, arguments.request)
    made, main = write(job, arguments.out), job.main
    if arguments.json:
        print(facts_text(job, arguments.out), end="")
    else:
        for path in made:
            print(path)
        print(
            f"{main.count} points on {main.curve.length:.9g} mm, at most {rounded_up(main.deviation, 4):g} mm from the exact curve"
        )
    return verdict(study, ("cam",))
