"""The command ``profile``: a cam's profile, or the path of its cutter, as a file for machines and drawings."""

from __future__ import annotations

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path

from core.commands import Painter
from core.commands.common import design_file, drive_option, number, one_studied, verdict
from core.output.profile import (
    ALL_FLANKS,
    FITS,
    FORMATS,
    LEAST_POINTS,
    MACHINING,
    MOST_POINTS,
    Machining,
    Request,
    facts_text,
    format_of,
    job_of,
    write,
)
from core.output.profile.digits import rounded_up


def _count(text: str) -> float:
    allowed = f"{LEAST_POINTS} ... {MOST_POINTS}"
    return number("points", allowed, lambda v: v == int(v) and LEAST_POINTS <= v <= MOST_POINTS)(text)


def _within(low: float, high: float, value: float) -> bool:
    return low <= value <= high


def options(parser: argparse.ArgumentParser) -> None:
    design_file(parser)
    out = f"file to write, its ending says how: {'|'.join(FORMATS)}; FILE.json beside it holds the facts, as --json prints them"
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help=out)
    parser.add_argument("--flank", default="inner", choices=ALL_FLANKS, help="which side of the cam (inner)")
    drive_option(parser)
    length = number("a length in mm", "above 0", lambda v: v > 0.0)
    points = parser.add_mutually_exclusive_group()
    points.add_argument("--samples", type=_count, metavar="N", help="points at equal cam angles")
    points.add_argument(
        "--spacing", type=length, metavar="MM", help="points at equal arc lengths, at most so far apart"
    )
    points.add_argument("--tolerance", type=length, metavar="MM", help="the fewest points that keep a tolerance")
    cutter = "path of the centre of a cutter or grinding wheel of this radius"
    parser.add_argument("--cutter", type=length, default=0.0, metavar="RADIUS_MM", help=cutter)
    parser.add_argument(
        "--as", dest="fit", choices=tuple(FITS), help="what runs from point to point (spline; CSV: polyline)"
    )
    usual = Machining()
    for row in MACHINING:
        read = number(
            row.label.lower(), f"{row.low:g} ... {row.high:g} {row.unit}", partial(_within, row.low, row.high)
        )
        first = getattr(usual, row.name)
        text = f"G-code: {row.label.lower()}, {row.help} ({row.zero or f'{first:g}'})"
        option = "--" + row.name.partition("_")[0]
        parser.add_argument(option, dest=row.name, type=read, default=first, metavar=row.unit.upper(), help=text)
    parser.add_argument("--conventional", action="store_true", help="G-code: conventional instead of climb milling")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The file, and the deviation that it reaches on the terminal."""
    usual = format_of(arguments.out)
    given = [(name, getattr(arguments, name)) for name in ("samples", "spacing", "tolerance")]
    sampling, value = next((pair for pair in given if pair[1] is not None), usual.sampling)
    how = replace(
        Machining(conventional=arguments.conventional), **{row.name: getattr(arguments, row.name) for row in MACHINING}
    )
    request = Request(sampling, value, arguments.fit or usual.fits[0], arguments.flank, arguments.cutter, how)
    study = one_studied(arguments.design, arguments.drive)
    job = job_of(study, arguments.out, request)
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
