"""Reader of a sheet of a workbook, in a separate process with limited memory and time.

A few bytes of a workbook can require any amount of either. The file is run as a script and imports only the library for
workbooks.

Standard input: the workbook. Arguments: limits of bytes, seconds, rows, columns and cells; ``sheet`` or ``names``; name
of the sheet. Standard output: a line of JSON, ``{"names": [...]}`` or ``{"fault": "..."}``; then the rows of the sheet
with tabs between cells.
"""

import json
import sys
from contextlib import suppress
from io import BytesIO


def main() -> None:
    """Write the result."""
    memory, seconds, rows, columns, cells = map(int, sys.argv[1:6])
    task, name = sys.argv[6:8]
    if sys.platform != "win32":  # there the process that waits for this one limits the time, and nothing the memory
        import resource

        for kind, greatest in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_AS, memory), (resource.RLIMIT_CPU, seconds)):
            _, hard = resource.getrlimit(kind)
            limit = greatest if hard == resource.RLIM_INFINITY else min(greatest, hard)
            with suppress(ValueError):  # macOS refuses a limit of memory
                resource.setrlimit(kind, (limit, limit))
    data = sys.stdin.buffer.read()
    write = sys.stdout.buffer.write
    try:
        from python_calamine import CalamineWorkbook

        book = CalamineWorkbook.from_filelike(BytesIO(data))
        header: dict[str, object] = {"names": book.sheet_names}
        texts: list[bytes] = []
        if task == "sheet" and (name in book.sheet_names if name else book.sheet_names):
            sheet = book.get_sheet_by_name(name or book.sheet_names[0])
            top, left = sheet.start or (0, 0)
            high, wide = top + sheet.height, left + sheet.width
            if high > rows or wide > columns or high * wide > cells:
                header = {
                    "fault": f"{high} rows of {wide} columns; allowed: at most {rows} rows, {columns} columns, {cells} cells"
                }
            else:
                texts = [
                    ("\t" * left + "\t".join(map(_text, row))).encode(errors="replace") for row in sheet.iter_rows()
                ]
    except BaseException as error:  # panics of the library are no subclasses of Exception
        header, texts = {"fault": f"a workbook that cannot be read: {' '.join(str(error).split())[:200]}"}, []
    write(json.dumps(header).encode() + b"\n")
    write(b"\n".join(texts))


def _text(cell: object) -> str:
    """Number with all its digits; text in one line."""
    return repr(cell) if isinstance(cell, float) else " ".join(str(cell).split())


if __name__ == "__main__":
    main()
