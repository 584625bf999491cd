"""The command ``vibration``: how an elastic follower vibrates in its dwells, and its response spectrum over speeds."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.commands import DONE, Painter
from core.commands.common import design_file, drive_option, require_cam
from core.output.summary import to_json
from core.output.vibration_files import SPEEDS, elastic_lines, elastic_rows, spectrum_csv, spectrum_table, speeds_of
from core.project import load_one
from core.project.files import write_all
from core.study import Study

MOST_SPEEDS, FASTEST = 5000, 1e5


def _speeds(text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    try:
        ends = float(low), float(high)
    except ValueError:
        ends = (0.0, 0.0)
    if not (colon and 0.0 < ends[0] < ends[1] <= FASTEST):
        raise argparse.ArgumentTypeError(f"{text!r}: range of speeds; allowed: A:B in rpm, 0 < A < B <= {FASTEST:g}")
    return ends


def _count(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if not 2 <= value <= MOST_SPEEDS:
        raise argparse.ArgumentTypeError(f"{text!r}: speeds of the spectrum; allowed: 2 ... {MOST_SPEEDS}")
    return value


def options(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    drive_option(parser)
    parser.add_argument(
        "--speeds", type=_speeds, metavar="A:B", help="of the spectrum, in rpm (up to twice the design's)"
    )
    parser.add_argument("--count", type=_count, default=SPEEDS, metavar="N", help=f"speeds of the spectrum ({SPEEDS})")
    parser.add_argument("--out", type=Path, metavar="FILE.csv", help="the spectrum as a table")
    parser.add_argument("--json", action="store_true", help="figures and spectrum as JSON")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The residual vibration in each dwell on the terminal; the spectrum as a file. A follower that is rigid has neither."""
    study = Study(load_one(arguments.design, arguments.drive))
    require_cam(study, "vibration")
    study.elasticity  # noqa: B018 - raises, and says why, where nothing vibrates
    low, high = arguments.speeds or (None, None)
    found = None
    if arguments.out is not None or arguments.json:
        found = study.vibration(speeds_of(study, low, high, arguments.count))
    if arguments.out is not None and found is not None:
        write_all(arguments.out.parent, {arguments.out.name: spectrum_csv(study, found)})
    if arguments.json and found is not None:
        table = {name: column.tolist() for name, column in spectrum_table(study, found).items()}
        print(to_json({**elastic_rows(study), "spectrum": table}), end="")
    else:
        print("\n".join(elastic_lines(study)))
    return DONE
