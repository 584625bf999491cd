"""Limits of everything that is read, in one table, and numbers read within them."""

from __future__ import annotations

import json
import math
from typing import Any

BYTES = 64_000_000
"""Of a text, a table, a drawing or a picture file."""
PROGRAM_BYTES = 1_000_000
"""Of a linkage of another program."""
ROWS, COLUMNS, CELLS = 2_000_000, 16_384, 20_000_000
"""Of a table."""
FIELD = 1_000_000
"""Characters of a cell of a table, or of a text of a design."""
DIGITS = 400
"""Characters of a number."""
NESTING = 64
"""Tables, lists, elements or blocks in each other."""
LINES = 200_000
"""Straight lines of a drawing that are shown, once its blocks are laid out."""
PIXELS = 64_000_000
"""Of a picture."""
_VALUES, _PARTS = 5_000_000, 1_000_000  # of JSON


def bounded_float(text: str) -> float:
    """The number in a text. Raises ValueError where it is none, is not finite, or has more than ``DIGITS`` characters."""
    value = float(text) if len(text) <= DIGITS else math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text[:40]!r} is no finite number of at most {DIGITS} characters")
    return value


def number_from_one(text: str, most: int) -> int:
    """The whole number 1 ... most that a text is; 0 where it is none of them."""
    return int(text) if text.isdecimal() and len(text) <= DIGITS and int(text) <= most else 0


def bounded_json(text: str) -> Any:
    """What a JSON text holds. Raises ValueError where it is none, is nested too deeply, or holds more than memory should."""
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
