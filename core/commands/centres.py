"""The command ``centres``: instant centres and velocities of a linkage at one position, as JSON."""

from __future__ import annotations

import argparse

from core.commands import DONE, Painter
from core.commands.common import design_file, folder, number, pictures
from core.output.centres import centres_data, snapshot
from core.output.summary import to_json
from core.project import load
from core.project.files import write_all
from core.study import Study


def words(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    angle = number("angle of the driver in degrees", "any number")
    parser.add_argument("--angle", type=angle, required=True, metavar="DEG", help="of the driver")
    parser.add_argument("--out", type=folder, metavar="DIR", help="also write them there, with pictures")


def run(words: argparse.Namespace, painter: Painter | None) -> int:
    """Instant centres and velocities of a linkage at one position, as JSON; with a folder also drawn."""
    study = Study(load(words.design))
    text = to_json(centres_data(study, words.angle))
    if words.out is not None:
        made: dict[str, str | bytes] = {"centres.json": text}
        made.update(pictures(painter, snapshot(study, words.angle)))
        write_all(words.out, made)
    print(text, end="")
    return DONE
