"""Reads a sheet of a workbook in a process of its own, whose memory and time are limited: a few bytes of a workbook can ask for any amount
of either. Run as a file: imports nothing but the library that reads workbooks.

Standard input: the workbook. Arguments: bytes of memory, seconds, rows, columns and cells at most, ``sheet`` or ``names``, name of the
sheet. Standard output: a line of JSON, ``{"names": [...]}`` or ``{"fault": "..."}``; behind it the sheet's rows, cells parted by tabs.
"""

import json
import sys
from io import BytesIO


def main() -> None:
    """Write the answer."""
    memory, seconds, rows, columns, cells = map(int, sys.argv[1:6])
    task, name = sys.argv[6:8]
    try:
        import resource
    except ImportError:  # not on Windows
        pass
    else:
        for kind, most in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_AS, memory), (resource.RLIMIT_CPU, seconds)):
            _, hard = resource.getrlimit(kind)
            limit = most if hard == resource.RLIM_INFINITY else min(most, hard)
            resource.setrlimit(kind, (limit, limit))
    data = sys.stdin.buffer.read()
    write = sys.stdout.buffer.write
    try:
        from python_calamine import CalamineWorkbook

        book = CalamineWorkbook.from_filelike(BytesIO(data))
        head: dict[str, object] = {"names": book.sheet_names}
        texts: list[bytes] = []
        if task == "sheet" and (name in book.sheet_names if name else book.sheet_names):
            sheet = book.get_sheet_by_name(name or book.sheet_names[0])
            top, left = sheet.start or (0, 0)
            high, wide = top + sheet.height, left + sheet.width
            if high > rows or wide > columns or high * wide > cells:
                head = {
                    "fault": f"{high} rows of {wide} columns; wanted: at most {rows} rows, {columns} columns, {cells} cells"
                }
            else:
                texts = [
                    ("\t" * left + "\t".join(map(_text, row))).encode(errors="replace") for row in sheet.iter_rows()
                ]
    except BaseException as error:  # the library's panics are no exceptions
        head, texts = {"fault": f"a workbook that cannot be read: {' '.join(str(error).split())[:200]}"}, []
    write(json.dumps(head).encode() + b"\n")
    write(b"\n".join(texts))


def _text(cell: object) -> str:
    """A number with all its digits; a text in one line."""
    return repr(cell) if isinstance(cell, float) else " ".join(str(cell).split())


if __name__ == "__main__":
    main()
