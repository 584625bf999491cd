"""The command ``laws``: the table of laws with their peak coefficients."""

from __future__ import annotations

import argparse
import math

from core.commands import DONE, Painter
from core.laws import LAWS, Peaks, peaks
from core.output.report import columns, digits
from core.output.summary import to_json


def words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON; infinite = null")


def run(words: argparse.Namespace, painter: Painter | None) -> int:
    """The table of laws with their peak coefficients."""
    if words.json:
        print(to_json([{"law": slug, **_coefficients(peaks(law))} for slug, law in LAWS.items()]), end="")
    else:
        print(_text(), end="")
    return DONE


def _coefficients(found: Peaks) -> dict[str, float | None]:
    """For unit rise and span; infinite = None."""
    numbers = {"cv": found.cv, "ca": found.ca, "cj": found.cj, "cm": found.cm}
    return {name: value if math.isfinite(value) else None for name, value in numbers.items()}


def _text() -> str:
    rows: list[tuple[str, ...]] = [("law", "velocity", "acceleration", "jerk", "torque", "")]
    for slug, law in LAWS.items():
        found = peaks(law)
        numbers = [digits(value) for value in _coefficients(found).values()]
        rows.append((slug, *numbers, "acceleration jumps at an end" if found.jumps_at_an_end else ""))
    return "\n".join(columns(rows)) + "\n"
