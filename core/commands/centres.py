"""The command ``centres``: instant centres and velocities of a mechanism at one position, as JSON."""

from __future__ import annotations

import argparse

from core.commands import DONE, Painter
from core.commands.common import design_file, drive_option, number, out_folder, pictures
from core.output.position import centres_data, snapshot
from core.output.summary import to_json
from core.project import load_one
from core.project.files import write_all
from core.study import Study


def options(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    drive_option(parser)
    angle = number("angle of the driver or the cam in degrees", "any number")
    parser.add_argument("--angle", type=angle, required=True, metavar="DEG", help="of the driver, or of the cam")
    out_folder(parser, "also write them there, with pictures")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """Instant centres and velocities at one position, as JSON; with a folder those of a linkage also drawn."""
    study = Study(load_one(arguments.design, arguments.drive))
    text = to_json(centres_data(study, arguments.angle))
    if arguments.out is not None:
        made: dict[str, str | bytes] = {"centres.json": text}
        if study.design.drive.links:
            made.update(pictures(painter, snapshot(study, arguments.angle)))
        write_all(arguments.out, made)
    print(text, end="")
    return DONE
