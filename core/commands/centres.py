"""The command ``centres``: instant centres and velocities of a linkage at one position, as JSON."""

from __future__ import annotations

import argparse
import math

from core.centring import centres_data
from core.commands import DONE, Painter
from core.commands.common import design_file
from core.project import load
from core.study import Study
from core.summary import to_json


def words(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    parser.add_argument("--angle", type=_angle, required=True, metavar="DEG", help="of the driver")


def _angle(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.inf
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r}: angle of the driver in degrees; allowed: any number")
    return value


def run(words: argparse.Namespace, painter: Painter | None) -> int:
    """Instant centres and velocities of a linkage at one position, as JSON."""
    print(to_json(centres_data(Study(load(words.design)), words.angle)), end="")
    return DONE
