"""Size limits of all files and texts that are read, and numbers read within them."""

from __future__ import annotations

import json
import math
from typing import Any

BYTES = 64_000_000
"""Size of a text, table, drawing or image file."""
PROGRAM_BYTES = 1_000_000
"""Size of a linkage file of another program."""
ROWS, COLUMNS, CELLS = 2_000_000, 16_384, 20_000_000
"""Size of a table."""
FIELD = 1_000_000
"""Characters in a cell of a table, or in a text of a design."""
DIGITS = 400
"""Characters in a number."""
NESTING = 64
"""Nesting depth of tables, lists, elements or blocks."""
LINES = 200_000
"""Straight lines of a drawing that are shown, after its blocks are expanded."""
PIXELS = 64_000_000
"""Pixels of an image."""
_VALUES, _PARTS = 5_000_000, 1_000_000  # values, lists and tables of a JSON text


def bounded_float(text: str) -> float:
    """Read a finite number from a text.

    Raises
    ------
    ValueError
        Where the text is no number, is not finite, or has more than ``DIGITS`` characters.
    """
    value = float(text) if len(text) <= DIGITS else math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text[:40]!r} is no finite number of at most {DIGITS} characters")
    return value


def number_from_one(text: str, most: int) -> int:
    """Read a whole number 1 ... most from a text; 0 where the text is no such number."""
    return int(text) if text.isdecimal() and len(text) <= DIGITS and int(text) <= most else 0


def bounded_json(text: str) -> Any:
    """Parse a JSON text.

    Raises
    ------
    ValueError
        Where the text is not JSON, is nested too deeply, or has too many values.
    """
    if text.count(",") > _VALUES or text.count("[") + text.count("{") > _PARTS:
        raise ValueError(f"more than {_VALUES} values, or than {_PARTS} lists and tables")
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


__all__ = [
    "BYTES", "CELLS", "COLUMNS", "DIGITS", "FIELD", "LINES", "NESTING", "PIXELS", "PROGRAM_BYTES", "ROWS", "bounded_float",
    "bounded_json", "number_from_one",
]  # fmt: skip
