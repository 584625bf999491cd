"""The command ``centres``: instant centres and velocities of a mechanism at one position, as JSON."""

from __future__ import annotations

from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import design_file, drive_name, out_folder, pictures
from core.design.fields import number
from core.frozen import frozen
from core.output.position import centres_data, snapshot
from core.output.summary import to_json
from core.project import load_one
from core.project.files import write_into
from core.requests import asked
from core.study import Study


@frozen(kw_only=True)
class Arguments:
    """Of which design, and at which angle."""

    design: Path = design_file()
    drive: str = drive_name()
    angle_deg: float = asked(number("Angle of the driver or the cam in degrees"), help="of the driver, or of the cam")
    out: Path | None = out_folder("also write them there, with pictures")


def run(arguments: Arguments, painter: Painter | None) -> int:
    """Instant centres and velocities at one position, as JSON; with a folder those of a linkage also drawn."""
    study = Study(load_one(arguments.design, arguments.drive))
    text = to_json(centres_data(study, arguments.angle_deg))
    if arguments.out is not None:
        made: dict[str, str | bytes] = {"centres.json": text}
        if study.design.drive.links:
            made.update(pictures(painter, snapshot(study, arguments.angle_deg)))
        write_into(arguments.out, made)
    print(text, end="")
    return DONE
