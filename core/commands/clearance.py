"""The command ``clearance``: least clearances of bodies with outlines over the turn, proven, and their meetings."""

from __future__ import annotations

import argparse
from pathlib import Path

from core.commands import DONE, DONE_WITH_ERRORS, Painter
from core.commands.common import as_json, design_file, ending_with, studied
from core.design.fields import number
from core.frozen import frozen
from core.output.clearance import clearance_data, clearance_line, is_kept
from core.output.export import MM, clearance_table
from core.output.summary import to_json
from core.project import load
from core.project.files import write_all
from core.requests import option, text_option


def _pair(text: str) -> tuple[str, str]:
    """Read the names of two bodies. Raises argparse.ArgumentTypeError."""
    first, comma, second = text.partition(",")
    if not (comma and first.strip() and second.strip()) or "," in second:
        raise argparse.ArgumentTypeError(
            f"{text!r}: pair of bodies; allowed: two names, as 'link 3,frame' or feed.arm,clamp.cam"
        )
    return first.strip(), second.strip()


@frozen(kw_only=True)
class ClearanceArguments:
    """Arguments of ``clearance``: a design with outlines, pairs of bodies, and what they must keep."""

    design: Path = design_file()
    pair: tuple[tuple[str, str], ...] = text_option(
        "two bodies: 'link 3,frame'; several times for several pairs",
        default=(),
        default_text="every pair with a common layer that does not touch by design",
        action="append",
        type=_pair,
        metavar="A,B",
    )
    least: float | None = option(
        number("Least clearance", 0.0, 1e9, default=None, help="that every pair must keep, in mm"),
        default_text="as [[clearances]] state, else 0",
        metavar="MM",
    )
    tolerance: float = option(
        number("Tolerance", 1e-6, 1e3, default=0.001, help="between the least distance and its proven bound, in mm"),
        metavar="MM",
    )
    out: Path | None = text_option(
        "the distances over the turn as a table", default=None, type=ending_with("table", ".csv"), metavar="FILE.csv"
    )
    json: bool = as_json()


def run_clearance(arguments: ClearanceArguments, painter: Painter | None) -> int:
    """Print the least clearances; write the distances over the turn to a file."""
    study = studied(load(arguments.design))
    clearances = study.clearances
    pairs = tuple(map(clearances.pair, arguments.pair)) or clearances.require_pairs()
    results = [(clearances.least(pair, arguments.tolerance / MM), pair) for pair in dict.fromkeys(pairs)]
    if arguments.out is not None:
        write_all(
            arguments.out.parent, {arguments.out.name: b"".join(clearance_table(study, [pair for _, pair in results]))}
        )
    required = [clearances.required(pair) if arguments.least is None else arguments.least for _, pair in results]
    if arguments.json:
        print(to_json([clearance_data(result) for result, _ in results]), end="")
    else:
        for (result, _), least in zip(results, required, strict=True):
            print(clearance_line(result, least))
    kept = all(is_kept(result, least) for (result, _), least in zip(results, required, strict=True))
    return DONE if kept else DONE_WITH_ERRORS
