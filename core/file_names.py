"""File and folder names from texts of a design, valid on every system."""

from __future__ import annotations

import re

_DEVICE = re.compile(r"(con|conin\$|conout\$|prn|aux|nul|(com|lpt)[0-9¹²³])", re.IGNORECASE)
_NOT_IN_NAMES = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|]')
LONGEST = 200
"""Bytes of a name; file systems allow 255, and an extension follows."""


def no_device(name: str) -> str:
    """Append ``_`` to a name that is a device of Windows: ``con`` gives ``con_``."""
    return f"{name}_" if _DEVICE.fullmatch(name) else name


def file_name(text: str) -> str:
    """File name, without extension, from a text: no path, no device of Windows, no dots or blanks at its ends; it may be empty."""
    name = _NOT_IN_NAMES.sub("-", text).encode("utf-8", "replace")[:LONGEST].decode("utf-8", "ignore").strip(". ")
    first, dot, rest = name.partition(".")  # Windows reads con.txt as the device, too
    return f"{no_device(first.rstrip())}{dot}{rest}" if dot else no_device(first)


__all__ = ["LONGEST", "file_name", "no_device"]
