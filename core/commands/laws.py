"""The command ``laws``: the table of laws with their peak coefficients."""

from __future__ import annotations

import argparse

from core.commands import DONE, Painter
from core.laws import LAWS, Peaks, peaks
from core.output.lines import columns, digits
from core.output.summary import to_json


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON; infinite = null")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
    """The table of laws with their peak coefficients."""
    if arguments.json:
        print(to_json([{"law": slug, **_coefficients(peaks(law))} for slug, law in LAWS.items()]), end="")
    else:
        print(_text(), end="")
    return DONE


def _coefficients(peak: Peaks) -> dict[str, float]:
    """For unit rise and span."""
    return {"cv": peak.cv, "ca": peak.ca, "cj": peak.cj, "cm": peak.cm}


def _text() -> str:
    rows: list[tuple[str, ...]] = [("law", "velocity", "acceleration", "jerk", "torque", "")]
    for slug, law in LAWS.items():
        peak = peaks(law)
        numbers = [digits(value) for value in _coefficients(peak).values()]
        rows.append((slug, *numbers, "acceleration jumps at an end" if peak.jumps_at_an_end else ""))
    return "\n".join(columns(rows)) + "\n"
