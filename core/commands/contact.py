"""The command ``contact``: whether the follower stays on its cam, its flights where it does not, and the map over angle and speed."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from core.commands import DONE, Painter
from core.commands.common import design_file, drive_option, one_studied, require_cam, samples, within
from core.motion import degrees
from core.output.contact_files import SPEEDS, flight_lines, lift_off_lines, map_csv, map_of
from core.project.files import write_all

MOST_SPEEDS, MOST_TURNS, ANGLES, TURNS = 2000, 200.0, 360, 3.0


def _speeds(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if not 1 <= value <= MOST_SPEEDS:
        raise argparse.ArgumentTypeError(f"{text!r}: speeds of the map; allowed: 1 ... {MOST_SPEEDS}")
    return value


def options(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    drive_option(parser)
    parser.add_argument("--flights", action="store_true", help="follow the follower after it has left the cam")
    parser.add_argument(
        "--turns",
        type=within(0.0, MOST_TURNS, "turns"),
        default=TURNS,
        metavar="N",
        help=f"through so many ({TURNS:g})",
    )
    parser.add_argument("--out", type=Path, metavar="FILE.csv", help="the contact force over cam angle and speed")
    parser.add_argument(
        "--samples", type=samples, default=ANGLES, metavar="N", help=f"cam angles of the table ({ANGLES})"
    )
    parser.add_argument("--speeds", type=_speeds, default=SPEEDS, metavar="N", help=f"speeds of the table ({SPEEDS})")
    top = within(0.0, 1e5, "speed")
    parser.add_argument(
        "--rpm", type=top, metavar="RPM", help="highest speed of the table (above the design's and that of lift-off)"
    )


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The speed of lift-off on the terminal, with the flights where they are asked for; the map as a file."""
    study = one_studied(arguments.design, arguments.drive)
    require_cam(study, "contact")
    study.contact_force  # noqa: B018 - raises, and says why, where no contact can be lost
    lines = lift_off_lines(study)
    if arguments.flights:
        lines += ["", *flight_lines(study, study.flights(arguments.turns))]
    if arguments.out is not None:
        theta = np.deg2rad(degrees(arguments.samples))
        found = map_of(study, theta, arguments.rpm, arguments.speeds)
        write_all(arguments.out.parent, {arguments.out.name: map_csv(found)})
    print("\n".join(lines))
    return DONE
