"""Tables from a workbook, .xlsx, .xls or .ods: one of its sheets, or a range of it, as cells of text."""

from __future__ import annotations

import re
from io import BytesIO
from typing import Any

from core.measured.sheet import RowFault, TableError, Worksheet, read_sheet

_RANGE = re.compile(r"([A-Z]{1,3})([1-9]\d*):([A-Z]{1,3})([1-9]\d*)", re.IGNORECASE)


def is_workbook(data: bytes) -> bool:
    """Whether a file's bytes are those of a workbook."""
    return data.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0"))


def sheet_names(data: bytes, name: str) -> tuple[str, ...]:
    """The sheets of a workbook. Raises TableError."""
    return tuple(_opened(data, name).sheet_names)


def read_workbook(data: bytes, name: str, sheet: str = "", cells: str = "") -> Worksheet:
    """A sheet of a workbook; lines are its rows. sheet: empty = the first; cells: ``A1:C400``, empty = all.

    Raises TableError where there is no such sheet, no table in it, or nothing installed that reads workbooks.
    """
    book = _opened(data, name)
    names = book.sheet_names
    if sheet and sheet not in names:
        raise TableError(name, [RowFault(0, f"no sheet {sheet!r}; there are: {', '.join(names)}")])
    rows = book.get_sheet_by_name(sheet or names[0]).to_python(skip_empty_area=False)
    left, top, right, bottom = 0, 0, None, len(rows)
    if cells:
        match = _RANGE.fullmatch(cells.strip())
        if match is None:
            raise TableError(name, [RowFault(0, f"range {cells!r}; wanted: two corners, as A1:C400")])
        left, right = _column(match[1]), _column(match[3]) + 1
        top, bottom = int(match[2]) - 1, int(match[4])
    lines = [
        "" if not top <= i < bottom else "\t".join(_text(cell) for cell in row[left:right])
        for i, row in enumerate(rows)
    ]
    return read_sheet("\n".join(lines).encode(), name, "tab", "point")


def _opened(data: bytes, name: str) -> Any:
    try:
        from python_calamine import CalamineError, CalamineWorkbook
    except ImportError:
        text = "a workbook; pip install 'kindyna[tables]' to read it, or save it as CSV"
        raise TableError(name, [RowFault(0, text)]) from None
    try:
        return CalamineWorkbook.from_filelike(BytesIO(data))
    except (CalamineError, OSError, ValueError) as error:
        raise TableError(name, [RowFault(0, f"a workbook that cannot be read: {error}")]) from None


def _column(letters: str) -> int:
    number = 0
    for letter in letters.upper():
        number = 26 * number + ord(letter) - ord("A") + 1
    return number - 1


def _text(cell: object) -> str:
    """A number with all its digits; a text in one line."""
    return repr(cell) if isinstance(cell, float) else " ".join(str(cell).split())


__all__ = ["is_workbook", "read_workbook", "sheet_names"]
