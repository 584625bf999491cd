"""Lines of plain text: numbers, columns, findings. Separate from the report, which is slower to load."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.findings import Finding

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""Beginnings of a cell that a spreadsheet reads as a formula."""
_PLAIN_FROM, _PLAIN_TO = 1e-7, 1e15


def digits(value: float | None, most: int = 6) -> str:
    """A number for reading: six significant digits, an exponent only for very small or large numbers."""
    if value is None or not math.isfinite(value):
        return "infinite"
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if size < -4 or size > 8:
        return f"{value:.{most - 1}e}"
    return f"{value:.{max(0, most - 1 - size)}f}"


def shortest(value: float) -> str:
    """The shortest text that reads back to the same number, without an exponent where that is not longer."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value + 0.0:g}"
    text = repr(float(value))
    if "e" in text and _PLAIN_FROM <= abs(value) < _PLAIN_TO:
        from decimal import Decimal  # slow to import, and few numbers need it

        text = f"{Decimal(text):f}"
    return text.removesuffix(".0")


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


def finding_line(finding: Finding, angle: str = "cam angle", least: int = 0) -> str:
    """A finding on one line; its figures have at least ``least`` digits."""
    drive = f"{printable(str(finding.values['drive']))}: " if "drive" in finding.values else ""
    location = (
        ""
        if finding.cam_angle_deg is None or finding.states_angle
        else f", at {angle} {digits(finding.cam_angle_deg)} °"
    )
    return f"{finding.severity}: {drive}{finding.with_digits(least)}{location} [{finding.field}]"
