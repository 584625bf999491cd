"""The stress cases as figures for the page; the tests assert them (tests/core/test_stress_cases.py)."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

from stress_cases import CASES, Sample


@dataclass(frozen=True)
class Look:
    case: str
    axis: str
    value: float
    sample: Sample


def measured(quick: bool = False) -> list[Look]:
    """Every case at its values; quick: at those the tests look at, the costly ones left out."""
    found = []
    for case in CASES:
        if quick and case.few < 4:
            continue
        for value in case.some if quick else case.values:
            found.append(Look(case.name, case.axis, value, case.look(value)))
    return found


def as_csv(looks: Sequence[Look]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("case", "number", "value", "error", "bound", "printed_error"))
    for look in looks:
        s = look.sample
        writer.writerow(
            (look.case, look.axis, look.value, s.error, s.bound, "" if s.printed != s.printed else s.printed)
        )
    return text.getvalue()
