"""Words of G-code (ISO 6983): numbers and comments that every control reads."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType
from unicodedata import name, normalize

DIGITS = 4
"""Decimals of a coordinate in mm or deg."""


def coordinate(value: float) -> str:
    """A number with a decimal point, without trailing zeros and minus zero."""
    text = f"{value:.{DIGITS}f}".rstrip("0")
    return "0." if text == "-0." else text


def remark(text: str) -> str:
    """A comment in ASCII, without characters that end it or that a machine executes."""
    return f"({''.join(map(_ascii, text))})"


_REPLACEMENTS: Mapping[str, str] = MappingProxyType(
    {"(": "[", ")": "]", ";": ",", "%": " percent", "°": " deg", **dict.fromkeys('!?~$"\\`^{}|', "_")}
)  # Grbl executes ! ? ~ everywhere


def _ascii(c: str) -> str:
    """A character in ASCII: without accents, or by its name (캠: HANGUL SYLLABLE KAEM), or _."""
    if c in _REPLACEMENTS or c.isascii():
        return _REPLACEMENTS.get(c, c)
    plain = "".join(_REPLACEMENTS.get(part, part) for part in normalize("NFKD", c) if part.isascii())
    if plain:
        return plain
    match = re.search(r"(?: LETTER| SYLLABLE| IDEOGRAPH-)(.+?)(?: WITH .*)?$", name(c, ""))
    return match[1].strip().replace(" ", "-") if match else "-" if name(c, "").endswith(" DASH") else "_"
