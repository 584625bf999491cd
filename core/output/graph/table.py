"""All columns of a text table as numbers, however long it is; what is no number leaves a gap, and a note says where."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from core.bounds import COLUMNS
from core.frozen import frozen
from core.measured.sheet import (
    DELIMITERS,
    LineRuns,
    RowFault,
    TableError,
    Worksheet,
    decoded,
    number,
    read_sheet,
    require_cells,
    require_lines,
    split,
)
from core.numerics.cancellation import checkpoint
from core.project.files import read_bytes

SAMPLE, LEAST_SAMPLE = 500, 50  # lines by which header, delimiter and decimal mark are found, fewer of long ones
SAMPLE_TEXT = 100_000  # characters of them
LINES_AT_ONCE, CELLS_AT_ONCE = 20_000, 1_000_000  # between two looks at whether the table is still wanted
FEW = 3  # cells that are no numbers, of one column, before the rest is counted
_COMMENTS = ("#", "%", "//")

Progress = Callable[[float], object]
"""Is called with how much is done, 0 ... 1."""


@frozen(eq=False)
class NumberTable:
    """A table. names: of its columns, each once; values (columns, rows), nan where nothing stands; notes: a line for whatever was
    left out."""

    name: str
    names: tuple[str, ...]
    values: np.ndarray
    notes: tuple[str, ...]


def read_table_file(path: Path, progress: Progress = lambda part: None) -> NumberTable:
    """The table in a file. Raises FileError where it cannot be read, TableError where no row holds two numbers."""
    return read_numbers(read_bytes(path), path.name, progress)


def read_numbers(data: bytes, name: str, progress: Progress = lambda part: None) -> NumberTable:
    """The numbers in a table's bytes; its delimiter, decimal mark and header are found as for measured tables.

    Blocks of lines that hold numbers and nothing else are read at once, others line by line. Raises TableError.
    """
    text, _ = decoded(data, name)
    require_lines(text, name)
    lines = re.split(r"\r\n|\r", text) if "\r" in text and "\n" not in text else text.replace("\r\n", "\n").split("\n")
    widest = max(map(len, lines[:LEAST_SAMPLE])) + 1
    sample = "\n".join(lines[: max(LEAST_SAMPLE, min(SAMPLE, SAMPLE_TEXT // widest))]).encode()
    sheet = read_sheet(sample, name)
    if wider := _wider(sheet, lines):
        sheet = read_sheet(sample, name, columns=wider)
    if sheet.columns > COLUMNS:
        raise TableError(name, [RowFault(0, f"more than {COLUMNS} columns; wanted: at most {COLUMNS}")])
    reader = _Reader(sheet.delimiter, sheet.decimal, sheet.columns)
    begin = sheet.rows[0].line - 1
    require_cells(len(lines) - begin, sheet.columns, name)
    values, count = np.empty((sheet.columns, len(lines) - begin)), 0
    step = min(LINES_AT_ONCE, max(1, CELLS_AT_ONCE // sheet.columns))
    for at in range(begin, len(lines), step):
        checkpoint()
        progress((at - begin) / max(1, len(lines) - begin))
        block = reader.block(lines[at : at + step], at)
        values[:, count : count + len(block)] = block.T
        count += len(block)
    values = values[:, :count] if count == values.shape[1] else values[:, :count].copy()
    names = _named(sheet.names)
    header = [] if any(sheet.names) else ["there is no header: columns are called by their numbers"]
    return NumberTable(name, names, values, (*header, *reader.notes(names)))


def _wider(sheet: Worksheet, lines: Sequence[str]) -> int:
    """Columns of the header where it has more than most rows, and some row as many: those at the end are shorter, or rarely filled. 0
    where it has not."""
    begin = sheet.rows[0].line - 1
    above = next((line for line in reversed(lines[:begin]) if line.strip()), "")
    wide = len(split(above.strip().lstrip("#%/"), sheet.delimiter))
    if sheet.delimiter == "spaces" or wide <= sheet.columns:
        return 0
    mark = DELIMITERS[sheet.delimiter]
    return wide if any(line.count(mark) >= wide - 1 for line in lines[begin:]) else 0


def _named(headings: Sequence[str]) -> tuple[str, ...]:
    """Each name once; a column without one is called by its number."""
    counts = Counter(headings)
    return tuple(
        f"column {i}" if not name else name if counts[name] == 1 else f"column {i} {name}"
        for i, name in enumerate(headings, 1)
    )


@dataclass
class _Reader:
    """Lines to numbers; what was wrong in them is gathered."""

    delimiter: str
    decimal: str
    columns: int
    wrong: dict[int, list[str]] = field(default_factory=dict)
    more: Counter[int] = field(default_factory=Counter)
    short: dict[int, LineRuns] = field(default_factory=dict)
    long: LineRuns = field(default_factory=LineRuns)
    empty: dict[int, LineRuns] = field(default_factory=dict)

    def block(self, lines: Sequence[str], at: int) -> np.ndarray:
        """The rows (n, columns) of lines; at: the number of the first, from 0."""
        made = self._at_once(lines)
        return made if made is not None else self._one_by_one(lines, at)

    def _at_once(self, lines: Sequence[str]) -> np.ndarray | None:
        """None where anything but numbers stands there."""
        if self.decimal == "comma":
            if any("." in line for line in lines):
                return None
            lines = [line.replace(",", ".") for line in lines]
        if not any(lines):
            return np.zeros((0, self.columns))
        mark = None if self.delimiter == "spaces" else DELIMITERS[self.delimiter]
        if mark is not None and lines[0].endswith(mark):  # as some programs end every line
            lines = [line.rstrip(mark) for line in lines]
        try:
            made = np.loadtxt(lines, delimiter=mark, comments=None, ndmin=2)
        except ValueError:
            return None
        return made if made.shape[1] == self.columns and not np.isinf(made).any() else None

    def _one_by_one(self, lines: Sequence[str], at: int) -> np.ndarray:
        made = np.full((len(lines), self.columns), np.nan)
        used = np.zeros(len(lines), dtype=bool)
        for i, line in enumerate(lines):
            text = line.strip()
            if not text or text.startswith(_COMMENTS):
                continue
            cells = split(
                re.split(r"#|%|//", line, maxsplit=1)[0] if re.match(r"\s*[-+.\d]", line) else line, self.delimiter
            )
            used[i] = True
            if len(cells) < self.columns:
                self.short.setdefault(len(cells), LineRuns()).add(at + i + 1)
            elif len(cells) > self.columns:
                self.long.add(at + i + 1)
            for column, cell in enumerate(cells[: self.columns]):
                value = number(cell, self.decimal)
                if value is not None and np.isfinite(value):
                    made[i, column] = value
                elif not cell:
                    self.empty.setdefault(column, LineRuns()).add(at + i + 1)
                elif cell.lower() not in ("nan", "-", "na", "n/a"):
                    shown = self.wrong.setdefault(column, [])
                    if len(shown) < FEW:
                        shown.append(f"line {at + i + 1}: {cell[:30]!r}")
                    else:
                        self.more[column] += 1
        return made[used]

    def notes(self, names: Sequence[str]) -> tuple[str, ...]:
        """A line for each kind of fault."""
        made = []
        for column, cells in sorted(self.wrong.items()):
            more = f"; and {self.more[column]} more" if self.more[column] else ""
            made.append(f"{names[column]}, {'; '.join(cells)}{more}: no number, left out")
        made += [f"{names[column]}: nothing in {lines}, a gap" for column, lines in sorted(self.empty.items())]
        for count, lines in sorted(self.short.items()):
            short = f"{lines} {'has' if lines.count == 1 else 'have'} {count} of {self.columns} columns"
            made.append(f"{short}: those behind end, or have a gap, there")
        if self.long.count:
            made.append(f"{self.long}: more than {self.columns} columns; what is behind them is left out")
        return tuple(made)


__all__ = ["NumberTable", "Progress", "read_numbers", "read_table_file"]
