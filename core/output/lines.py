"""Lines of plain text: numbers, columns, findings. Separate from the report, which is slower to load."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.findings import Finding
from core.number_text import RESULT_DIGITS, result_text

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""Beginnings of a cell that a spreadsheet reads as a formula."""


def digits(value: float | None, most: int = RESULT_DIGITS) -> str:
    """A result with equal digits down a column of a table; None is infinite, as in ``summary.json``."""
    return "infinite" if value is None or not math.isfinite(value) else result_text(value, most, padded=True)


def columns(rows: Sequence[Sequence[str]], left: int = 1) -> list[str]:
    """Rows as aligned text; the first ``left`` columns flush left, the others right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            c.ljust(w) if i < left else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def text_cell(text: str, delimiter: str = ",") -> str:
    """A cell of a table with text.

    An apostrophe precedes a text that a spreadsheet would compute; a text with delimiters, quotes or line ends is quoted.
    """
    safe = f"'{text}" if text[:1] in FORMULA else text
    return '"' + safe.replace('"', '""') + '"' if set(safe) & {delimiter, '"', "\n", "\r"} else safe


def printable(text: str) -> str:
    """The text on one line, without characters that a terminal executes."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)


def finding_line(finding: Finding, angle: str = "cam angle") -> str:
    """A finding on one line."""
    drive = f"{printable(str(finding.values['drive']))}: " if "drive" in finding.values else ""
    location = (
        ""
        if finding.cam_angle_deg is None or finding.states_angle
        else f", at {angle} {result_text(finding.cam_angle_deg)} °"
    )
    return f"{finding.severity}: {drive}{finding.message}{location} [{finding.field}]"
