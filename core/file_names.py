"""Names from data as names of files and folders, valid on every system."""

from __future__ import annotations

import re

_DEVICE = re.compile(r"(con|prn|aux|nul|(com|lpt)[0-9¹²³])", re.IGNORECASE)
_NOT_IN_NAMES = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|]')
LONGEST = 200
"""Bytes of a name; file systems take 255, and an ending follows."""


def no_device(name: str) -> str:
    """The name, with ``_`` appended where it is a device of Windows: ``con`` gives ``con_``."""
    return f"{name}_" if _DEVICE.fullmatch(name) else name


def file_name(text: str) -> str:
    """A text as the name of a file without its ending: no path, no device, no dots or blanks at its ends; empty where nothing is left."""
    name = _NOT_IN_NAMES.sub("-", text).encode("utf-8", "replace")[:LONGEST].decode("utf-8", "ignore").strip(". ")
    first, dot, rest = name.partition(".")  # Windows finds the device in con.txt, too
    return f"{no_device(first.rstrip())}{dot}{rest}" if dot else no_device(first)


__all__ = ["LONGEST", "file_name", "no_device"]
