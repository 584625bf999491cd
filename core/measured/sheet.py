"""Cells of a text file or workbook of numbers: encoding, delimiter, decimal mark, header lines and rows."""

from __future__ import annotations

import codecs
import csv
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec
from io import BytesIO
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple, NoReturn

import numpy as np

from core.bounds import CELLS, COLUMNS, DIGITS, FIELD, ROWS
from core.design import UNITS
from core.errors import KindynaError
from core.frozen import frozen
from core.measured import workbook_process
from core.measured.units import unit_of

# -- cells ------------------------------------------------------------------------------------------------------


DELIMITERS: Mapping[str, str] = MappingProxyType({"tab": "\t", "semicolon": ";", "comma": ",", "spaces": " "})
DECIMALS: Mapping[str, str] = MappingProxyType({"point": ".", "comma": ","})
DIALECTS = (
    *((delimiter, "point") for delimiter in DELIMITERS),
    *((delimiter, "comma") for delimiter in DELIMITERS if delimiter != "comma"),
)
"""Delimiter and decimal mark, in the order of trial."""

MOST_RANGES = 12  # greatest number of line ranges in a text; further lines are only counted
LONG = 5000  # number of lines from which a table is read as one array
SAMPLE = 400  # lines from which delimiter and columns are detected
SAMPLE_LINE, SAMPLE_TEXT = 2000, 40_000  # greatest number of characters of a sample line, and of the sample
HEADERS = 100  # lines above the rows that are searched for names
csv.field_size_limit(FIELD)
_COMMENT = re.compile(r"^\s*(#|%|//)\s?")
_STATED = re.compile(r"sep=(.)$")  # the delimiter stated by a spreadsheet
_PLAIN = r"(?:\d+(?:\.\d*)?|\.\d+)"
_EXPONENT = r"(?:[eEdD][+-]?\d+)?"
_THIN = "\u00a0\u202f\u2009'’"  # separators of thousands in any locale
_NUMBER = re.compile(rf"[+-]?{_PLAIN}{_EXPONENT}")
_BRACKETED = re.compile(r"\[[^\[\]]*\]|\([^()]*\)")
_SIGNS = str.maketrans({"·": "", "*": "", "^": "", "²": "2", "³": "3", "⋅": ""})
_OTHERS = ("kn", "mn", "knm", "kpa", "bar", "hz", "kw", "%", "-")
_SYMBOLS = frozenset((*(row.symbol.lower().translate(_SIGNS) for row in UNITS.values()), *_OTHERS))
_GROUPED = re.compile(rf"[+-]?\d{{1,3}}(?:([,{_THIN}])\d{{3}})(?:\1\d{{3}})*(?:\.\d+)?")


class RowFault(NamedTuple):
    """Fault in a line of the file; line 0: in no particular line.

    ``rows``: number of rows with the same fault; ``others``: their other lines.
    """

    line: int
    text: str
    rows: int = 1
    others: tuple[int, ...] = ()

    @property
    def path(self) -> str:
        """Where it is in the file."""
        return f"line {self.line}" if self.line else ""

    def __str__(self) -> str:
        return f"{self.path}: {self.text}" if self.line else self.text


class TableError(KindynaError):
    """A measured table that cannot be read, with one line of text per fault."""

    faults: tuple[RowFault, ...]

    def __init__(self, name: str, faults: Iterable[RowFault]) -> None:
        self.name, self.faults = name, tuple(faults)
        shown = name if name.isprintable() else repr(name)
        super().__init__("\n".join(f"{shown}, {fault}" if fault.line else f"{shown}: {fault}" for fault in self.faults))


class LineRuns:
    """Line numbers in ascending order as at most ``MOST_RANGES`` ranges; further lines are counted."""

    def __init__(self, lines: Iterable[int] = ()) -> None:
        self.count, self._rest = 0, 0
        self._runs: list[list[int]] = []
        for line in lines:
            self.add(line)

    def add(self, line: int) -> None:
        """Add a line."""
        self.count += 1
        if not self._rest and self._runs and line == self._runs[-1][1] + 1:
            self._runs[-1][1] = line
        elif len(self._runs) < MOST_RANGES:
            self._runs.append([line, line])
        else:
            self._rest += 1

    def __str__(self) -> str:
        text = ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in self._runs)
        return f"line{'s' if self.count > 1 else ''} {text}{f' and {self._rest} more' if self._rest else ''}"


def line_ranges(lines: Iterable[int]) -> str:
    """Line numbers as text: ``line 4`` or ``lines 4-9, 12 and 30 more``."""
    return str(LineRuns(sorted(lines)))


@frozen
class WorksheetRow:
    """A row: its line in the file, counted from 1, and its cells."""

    line: int
    cells: tuple[str, ...]


@frozen
class Worksheet:
    """Cells of a file.

    Attributes
    ----------
    name : name of the file
    encoding : its encoding
    delimiter, decimal : keys of ``DELIMITERS`` and ``DECIMALS``
    header : number of lines above the first row of numbers, without comments
    names : header of each column, which may be empty
    rows : all rows after the header, valid or not
    numbers : ndarray (rows, columns) [units of the columns]
        Numbers of a long table without other cells; None for other tables.
    """

    name: str
    encoding: str
    delimiter: str
    decimal: str
    header: int
    names: tuple[str, ...]
    rows: Sequence[WorksheetRow]
    numbers: np.ndarray | None = None

    @property
    def columns(self) -> int:
        """Number of columns."""
        return len(self.names)


@frozen(eq=False)
class TextRows(Sequence[WorksheetRow]):
    """Rows of a text, divided into cells on access; ``line_indices``: their line numbers, from 0."""

    name: str
    lines: Sequence[str]
    line_indices: Sequence[int]
    delimiter: str

    def __len__(self) -> int:
        return len(self.line_indices)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        return self._row(self.line_indices[index])

    def __iter__(self) -> Iterator[WorksheetRow]:
        return map(self._row, self.line_indices)

    def _row(self, line: int) -> WorksheetRow:
        cells = split_cells(_uncommented(self.lines[line]), self.delimiter)
        require_row(cells, self.name, line + 1)
        return WorksheetRow(line + 1, cells)


@frozen(eq=False)
class LongRows(Sequence[WorksheetRow]):
    """Rows of a long table, decoded from the bytes of the file on access.

    Attributes
    ----------
    ends : ndarray (n + 1,), dimensionless
        Positions of the line ends, starting with that before the first row.
    begin : line of the first row
    """

    data: bytes
    ends: np.ndarray
    begin: int
    delimiter: str

    def __len__(self) -> int:
        return self.ends.size - 1

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        i = range(len(self))[index]
        text = self.data[self.ends[i] + 1 : self.ends[i + 1]].decode("ascii")
        return WorksheetRow(self.begin + i, split_cells(text.rstrip("\r"), self.delimiter))


# -- text -------------------------------------------------------------------------------------------------


def decode(data: bytes, name: str = "table") -> tuple[str, str]:
    """Text and encoding: by the byte order mark, else UTF-8, else Korean (CP949), else Latin-1."""
    if data.startswith(b"PK\x03\x04") or data.startswith(b"\xd0\xcf\x11\xe0"):
        raise TableError(name, [RowFault(0, "a workbook, no text; save it as CSV or text")])
    for mark, codec in ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16")):
        if data.startswith(mark):
            try:
                return data.decode(codec).removeprefix("\ufeff"), codec.upper()
            except UnicodeDecodeError:
                raise TableError(
                    name, [RowFault(0, f"no {codec.upper()} text despite its byte order mark; save it as UTF-8")]
                ) from None
    if b"\0" in data:
        raise TableError(name, [RowFault(0, "no text: it holds null bytes; save it as CSV or text")])
    for codec in ("utf-8", "cp949"):
        try:
            text = data.decode(codec)
        except UnicodeDecodeError:
            continue
        if codec == "utf-8" or _is_korean(text):
            return text, codec.upper()
    return data.decode("latin-1"), "Latin-1"


def _is_korean(text: str) -> bool:
    """Whether text decoded as CP949 is Korean.

    Syllables outside of KS X 1001 are rare in Korean, and frequent where accented Latin letters are misread.
    """
    standard = text.encode("euc_kr", "ignore").decode("euc_kr")
    return 2 * (len(text) - len(standard)) <= sum(ord(c) > 127 for c in text)


# -- numbers ----------------------------------------------------------------------------------------------


def number(cell: str, decimal: str) -> float | None:
    """Number in a cell, None where it is none; ``decimal`` is a key of ``DECIMALS``.

    Thousands may be grouped where that is unambiguous: by thin spaces or apostrophes, or by the mark that is not the
    decimal one, at least twice or together with decimals.
    """
    text = cell.strip().strip('"').strip().replace("\u2212", "-")
    if len(text) > DIGITS:
        return None
    if decimal == "comma":
        if "." in text and "," not in text and text.count(".") < 2:
            return None  # ambiguous: thousands, or a decimal point
        text = text.translate({ord(","): ".", ord("."): ","})
    if _NUMBER.fullmatch(text):
        return float(text.replace("d", "e").replace("D", "e"))
    match = _GROUPED.fullmatch(text)
    if match is None or (match[1] == "," and "." not in text and text.count(",") < 2):
        return None
    return float(text.replace(match[1], ""))


def split_cells(line: str, delimiter: str) -> tuple[str, ...]:
    """Cells of a line without empty ones at its end; cells after the last allowed column are joined."""
    mark = DELIMITERS[delimiter]
    if delimiter == "spaces":
        cells = line.split(None, COLUMNS)
    elif '"' in line and line.count(mark) <= COLUMNS + FIELD:
        cells = [cell.strip() for cell in _quoted(line, mark)]
    else:
        cells = [cell.strip() for cell in line.split(mark, COLUMNS)]
    while cells and not cells[-1]:
        cells.pop()
    return tuple(cells)


def _quoted(line: str, mark: str) -> list[str]:
    """Cells of a line with quotes; divided without regard to quotes where the reader fails."""
    try:
        return next(csv.reader([line], delimiter=mark, skipinitialspace=True))
    except csv.Error:
        return line.split(mark, COLUMNS)


def require_row(cells: Sequence[str], name: str, line: int) -> None:
    """Raise TableError for a row of too many cells, or with a cell that is too long."""
    if len(cells) > COLUMNS:
        raise TableError(name, [RowFault(line, f"more than {COLUMNS} columns; allowed: at most {COLUMNS}")])
    if sum(map(len, cells)) > FIELD and any(len(cell) > FIELD for cell in cells):
        raise TableError(name, [RowFault(line, f"a cell of more than {FIELD} characters; allowed: at most {FIELD}")])


def require_lines(text: str, name: str) -> None:
    """Raise TableError for a text of too many lines."""
    count = max(text.count("\n"), text.count("\r"))
    if count > ROWS:
        raise TableError(name, [RowFault(0, f"{count} lines; allowed: at most {ROWS} rows, thin them out")])


def require_cells(rows: int, columns: int, name: str) -> None:
    """Raise TableError for a table of too many cells."""
    if rows * columns > CELLS:
        raise TableError(
            name, [RowFault(0, f"{rows} rows of {columns} columns; allowed: at most {CELLS} cells in all")]
        )


def _numbers(cells: Sequence[str], decimal: str) -> int:
    return sum(number(cell, decimal) is not None for cell in cells)


def _has_two(cells: Sequence[str], decimal: str) -> bool:
    return sum(1 for _ in islice((cell for cell in cells if number(cell, decimal) is not None), 2)) == 2


def dialect(lines: Sequence[str], delimiter: str | None = None, decimal: str | None = None) -> tuple[str, str]:
    """Delimiter and decimal mark for which most lines are two or more numbers and nothing else; given ones are used."""
    rows = [d for d in DIALECTS if delimiter in (None, d[0]) and decimal in (None, d[1])] or [("comma", "comma")]

    def score(row: tuple[str, str]) -> int:
        split_lines = (split_cells(line, row[0]) for line in lines)
        return sum(len(cells) > 1 and _numbers(cells, row[1]) == len(cells) for cells in split_lines)

    def partly(row: tuple[str, str]) -> int:
        return sum(_numbers(split_cells(line, row[0]), row[1]) > 1 for line in lines)

    best = max(rows, key=score)
    return best if score(best) else max(rows, key=partly)


# -- reading ----------------------------------------------------------------------------------------------


def read_sheet(
    data: bytes, name: str, delimiter: str | None = None, decimal: str | None = None, columns: int | None = None
) -> Worksheet:
    """Cells of a file; delimiter, decimal mark and number of columns are detected where None.

    Blank lines are skipped, and comments, which start with #, % or //. Raises TableError where no row contains two
    numbers.
    """
    is_utf16 = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if not is_utf16 and data.count(b"\n") > LONG and data.count(b"\r") == data.count(b"\r\n"):
        long_sheet = _long_sheet(data, name, delimiter, decimal)
        if long_sheet is not None:
            return long_sheet
    text, encoding = decode(data, name)
    require_lines(text, name)
    lines = re.split(r"\r\n|\r|\n", text)
    statement = _STATED.match(lines[0])
    if statement is not None:
        lines[0] = ""
        delimiter = delimiter or next((key for key, mark in DELIMITERS.items() if mark == statement[1]), None)
    comments = {i for i, line in enumerate(lines) if _COMMENT.match(line)}
    plain = [i for i, line in enumerate(lines) if line.strip() and i not in comments]
    delimiter, decimal = dialect(_sample(lines[i] for i in plain[:SAMPLE]), delimiter, decimal)
    start = _first_row(plain, lines, delimiter, decimal)
    if start is None:
        raise TableError(name, [RowFault(0, "no row contains two numbers; required: an angle and a value in each row")])
    first = plain[start]
    rows = TextRows(name, lines, plain[start:], delimiter)
    counts = islice((len(row.cells) for row in islice(rows, 10 * SAMPLE) if _has_two(row.cells, decimal)), SAMPLE)
    columns = columns or Counter(counts).most_common(1)[0][0]
    require_cells(len(rows), columns, name)
    above = [_COMMENT.sub("", line, count=1) for line in lines[max(first - HEADERS, 0) : first] if line.strip()]
    return Worksheet(name, encoding, delimiter, decimal, start, _names(above, columns, delimiter), rows)


def _long_sheet(data: bytes, name: str, delimiter: str | None, decimal: str | None) -> Worksheet | None:
    """A long table read as one array; None where this is not possible.

    Its head may have any encoding and determines the format, its rows must be ASCII numbers throughout. Only the
    positions of the line ends are stored.
    """
    ends = np.flatnonzero(np.frombuffer(data, np.uint8) == ord("\n")).astype(np.int32)  # no file exceeds 2 GB
    try:
        head = read_sheet(data[: ends[SAMPLE]], name, delimiter, decimal)
    except TableError:
        return None  # a longer header
    begin = head.rows[0].line - 1
    if data[ends[-1] + 1 :].strip():
        ends = np.append(ends, np.int32(len(data)))
    while ends.size > 1 and not data[ends[-2] + 1 : ends[-1]].strip():
        ends = ends[:-1]
    ends = ends[begin - 1 :] if begin else np.append(np.int32(-1), ends)
    stream = BytesIO(data)
    stream.seek(int(ends[0]) + 1)
    lines = islice(stream, ends.size - 1)
    decoded = (
        line.decode("ascii").replace(",", ".") if head.decimal == "comma" else line.decode("ascii") for line in lines
    )
    mark = None if head.delimiter == "spaces" else DELIMITERS[head.delimiter]
    try:
        numbers = np.loadtxt(decoded, delimiter=mark, comments=None, ndmin=2)
    except ValueError:
        return None
    if numbers.shape[0] != ends.size - 1 or not np.isfinite(numbers).all():
        return None
    return replace(head, rows=LongRows(data, ends, begin + 1, head.delimiter), numbers=numbers)


def _sample(lines: Iterable[str]) -> list[str]:
    """Lines for the detection of the delimiter, without remarks; long ones end at a complete cell."""
    sample: list[str] = []
    size = 0
    for line in lines:
        text = line[:SAMPLE_LINE]
        if len(line) > SAMPLE_LINE:
            text = text[: max(text.rfind(mark) for mark in DELIMITERS.values())]
        sample.append(_uncommented(text))
        size += len(text)
        if size > SAMPLE_TEXT:
            break
    return sample


def _uncommented(line: str) -> str:
    """Row of numbers without a remark at its end."""
    if "#" not in line and "%" not in line and "//" not in line:
        return line
    return re.split(r"#|%|//", line, maxsplit=1)[0] if re.match(r"\s*[-+.\d]", line) else line


def _first_row(plain: Sequence[int], lines: Sequence[str], delimiter: str, decimal: str) -> int | None:
    """Index of the first row among the plain lines: the first of only numbers, else the first with two numbers.

    Lines directly above it that start with a number are faulty rows, no headers.
    """
    index: int | None = None
    for i, line in enumerate(plain):
        cells = split_cells(_uncommented(lines[line]), delimiter)
        count = _numbers(cells, decimal)
        if count >= max(len(cells), 2):
            index = i
            break
        if count > 1 and index is None:
            index = i
    if index is None:
        return None
    width = len(split_cells(lines[plain[index]], delimiter))
    while index > 0:
        above = split_cells(lines[plain[index - 1]], delimiter)
        if not above or number(above[0], decimal) is None or len(above) != width:
            break
        index -= 1
    return index


def _names(above: Sequence[str], columns: int, delimiter: str) -> tuple[str, ...]:
    """Header of each column: the last line with as many cells, and the one above where it has only units."""
    result: list[tuple[str, ...]] = []
    for line in reversed(above):
        cells = _header_cells(line, columns, delimiter)
        if cells is None:
            continue
        result.insert(0, cells)
        if len(result) == 2 or not all(_is_unit(cell) for cell in cells if cell):
            break
    if not result:
        return ("",) * columns
    if len(result) == 2:
        result[1] = tuple(
            cell if unit_of(cell) or cell in ("", "-") or _BRACKETED.fullmatch(cell) else f"[{cell}]"
            for cell in result[1]
        )
    return tuple(" ".join(part for part in parts if part not in ("", "-")) for parts in zip(*result, strict=True))


def _is_unit(cell: str) -> bool:
    """Whether a header cell is a unit only: a known one, or any text in brackets."""
    plain = cell.strip("[]() ").lower().translate(_SIGNS)
    return bool(_BRACKETED.fullmatch(cell.strip()) or unit_of(plain) or plain in _SYMBOLS)


def _header_cells(line: str, columns: int, delimiter: str) -> tuple[str, ...] | None:
    """Header line divided into as many cells as there are columns, by any method."""
    header = next((cells for cells in _divided(line, delimiter) if len(cells) == columns), None)
    if header is None or not all(re.search(r"[^\W\d]|[°\"]", cell) for cell in header if cell):
        return None
    return tuple(
        re.sub("^'(?=[-=+@])", "", cell) for cell in header
    )  # an apostrophe prevents evaluation in a spreadsheet


def _divided(line: str, delimiter: str) -> Iterator[tuple[str, ...]]:
    """Cells of a line by every method in turn."""
    yield from (
        split_cells(line, mark) for mark in (delimiter, *(d for d in DELIMITERS if d not in (delimiter, "spaces")))
    )
    yield tuple(re.split(r"\s{2,}", line.strip(), maxsplit=COLUMNS))
    yield _matches(r"(?:^|(?<=[\])]))[^\[(\])]*+[\[(][^\])]*+[\])]", line)
    yield _matches(r"[^\s\[(]++(?:\s*+(?:\[[^\[\]]*+\]|\([^()]*+\)))?", line)
    yield tuple(line.split(None, COLUMNS))


def _matches(pattern: str, line: str) -> tuple[str, ...]:
    """Matches of a pattern in a line, at most one more than the allowed number of columns."""
    return tuple(match[0].strip() for match in islice(re.finditer(pattern, line), COLUMNS + 1))


# -- workbooks, .xlsx, .xls or .ods -----------------------------------------------------------------------------


_RANGE = re.compile(r"([A-Z]{1,3})([1-9]\d{0,6}):([A-Z]{1,3})([1-9]\d{0,6})", re.IGNORECASE)
_MEMORY, _SECONDS = 500 << 20, 20
"""Limits for the reading of a workbook: bytes, and seconds of CPU."""


def is_workbook(data: bytes) -> bool:
    """Whether the bytes of a file are those of a workbook."""
    return data.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0"))


def sheet_names(data: bytes, name: str) -> tuple[str, ...]:
    """Names of the sheets of a workbook. Raises TableError."""
    return _read(data, name, "names")[0]


def read_workbook(data: bytes, name: str, sheet: str = "", cells: str = "") -> Worksheet:
    """Sheet of a workbook, by default the first; ``cells``: range such as ``A1:C400``, by default all.

    Lines are rows of the sheet. Raises TableError where the sheet does not exist or contains no table, or no library
    for workbooks is installed.
    """
    match = _RANGE.fullmatch(cells.strip()) if cells else None
    if cells and match is None:
        _refuse(name, f"range {cells[:40]!r}; required: two corners, as A1:C400")
    names, lines = _read(data, name, "sheet", sheet)
    if not names or (sheet and sheet not in names):
        _refuse(name, f"no sheet {sheet!r}; sheets: {', '.join(names)[:500]}" if names else "it has no sheet")
    if match is not None:
        left, right = _column(match[1]), _column(match[3]) + 1
        top, bottom = int(match[2]) - 1, int(match[4])
        lines = [
            b"\t".join(line.split(b"\t")[left:right]) if top <= i < bottom else b"" for i, line in enumerate(lines)
        ]
    return read_sheet(b"\n".join(lines), name, "tab", "point")


def _read(data: bytes, name: str, task: str, sheet: str = "") -> tuple[tuple[str, ...], list[bytes]]:
    """Names of the sheets, and the lines of one sheet. Raises TableError."""
    if find_spec("python_calamine") is None:
        _refuse(name, "a workbook; pip install 'kindyna[tables]' to read it, or save it as CSV")
    limits = map(str, (_MEMORY, _SECONDS, ROWS, COLUMNS, CELLS))
    command = [sys.executable, "-P", str(Path(workbook_process.__file__)), *limits, task, sheet.replace("\0", "")]
    try:
        process = subprocess.run(command, input=data, capture_output=True, timeout=3 * _SECONDS)
        head = json.loads(process.stdout.partition(b"\n")[0])
    except (subprocess.TimeoutExpired, ValueError):
        limit = f"{_MEMORY >> 20} MB and {_SECONDS} s"
        _refuse(name, f"a workbook that requires more than {limit} to read; save the range of the table as CSV")
    if "fault" in head:
        _refuse(name, head["fault"])
    return tuple(head["names"]), process.stdout.split(b"\n")[1:]


def _refuse(name: str, problem: str) -> NoReturn:
    raise TableError(name, [RowFault(0, problem)])


def _column(letters: str) -> int:
    number = 0
    for letter in letters.upper():
        number = 26 * number + ord(letter) - ord("A") + 1
    return number - 1
