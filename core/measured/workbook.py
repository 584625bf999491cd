"""Tables from a workbook, .xlsx, .xls or .ods: one of its sheets, or a range of it, as cells of text."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import NoReturn

from core.bounds import CELLS, COLUMNS, ROWS
from core.measured import workbook_process
from core.measured.sheet import RowFault, TableError, Worksheet, read_sheet

_RANGE = re.compile(r"([A-Z]{1,3})([1-9]\d{0,6}):([A-Z]{1,3})([1-9]\d{0,6})", re.IGNORECASE)
_MEMORY, _SECONDS = 500 << 20, 20
"""Bytes and seconds of CPU in which a workbook is read."""


def is_workbook(data: bytes) -> bool:
    """Whether a file's bytes are those of a workbook."""
    return data.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0"))


def sheet_names(data: bytes, name: str) -> tuple[str, ...]:
    """The sheets of a workbook. Raises TableError."""
    return _read(data, name, "names")[0]


def read_workbook(data: bytes, name: str, sheet: str = "", cells: str = "") -> Worksheet:
    """A sheet of a workbook; lines are its rows. sheet: empty = the first; cells: ``A1:C400``, empty = all.

    Raises TableError where there is no such sheet, no table in it, or nothing installed that reads workbooks.
    """
    match = _RANGE.fullmatch(cells.strip()) if cells else None
    if cells and match is None:
        _refuse(name, f"range {cells[:40]!r}; wanted: two corners, as A1:C400")
    names, lines = _read(data, name, "sheet", sheet)
    if not names or (sheet and sheet not in names):
        _refuse(name, f"no sheet {sheet!r}; there are: {', '.join(names)[:500]}" if names else "no sheet in it")
    if match is not None:
        left, right = _column(match[1]), _column(match[3]) + 1
        top, bottom = int(match[2]) - 1, int(match[4])
        lines = [
            b"\t".join(line.split(b"\t")[left:right]) if top <= i < bottom else b"" for i, line in enumerate(lines)
        ]
    return read_sheet(b"\n".join(lines), name, "tab", "point")


def _read(data: bytes, name: str, task: str, sheet: str = "") -> tuple[tuple[str, ...], list[bytes]]:
    """Names of the sheets, and the lines of one. Raises TableError."""
    if find_spec("python_calamine") is None:
        _refuse(name, "a workbook; pip install 'kindyna[tables]' to read it, or save it as CSV")
    limits = map(str, (_MEMORY, _SECONDS, ROWS, COLUMNS, CELLS))
    command = [sys.executable, "-P", str(Path(workbook_process.__file__)), *limits, task, sheet.replace("\0", "")]
    try:
        done = subprocess.run(command, input=data, capture_output=True, timeout=3 * _SECONDS)
        head = json.loads(done.stdout.partition(b"\n")[0])
    except (subprocess.TimeoutExpired, ValueError):
        limit = f"{_MEMORY >> 20} MB and {_SECONDS} s"
        _refuse(name, f"a workbook that takes more than {limit} to read; save the range of the table as CSV")
    if "fault" in head:
        _refuse(name, head["fault"])
    return tuple(head["names"]), done.stdout.split(b"\n")[1:]


def _refuse(name: str, problem: str) -> NoReturn:
    raise TableError(name, [RowFault(0, problem)])


def _column(letters: str) -> int:
    number = 0
    for letter in letters.upper():
        number = 26 * number + ord(letter) - ord("A") + 1
    return number - 1


__all__ = ["is_workbook", "read_workbook", "sheet_names"]
