"""The numbers of a measured table by cam angle; every wrong row is named by its line."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

import numpy as np

from core.design import LoadPoint
from core.frozen import frozen
from core.measured.columns import ColumnLayout, column_name
from core.measured.sheet import (
    DECIMALS,
    DELIMITERS,
    RowFault,
    TableError,
    Worksheet,
    WorksheetRow,
    line_ranges,
    number,
    read_sheet,
)
from core.measured.units import ANGLE_UNITS, TIME_UNITS

# -- A table of force over the turn, from text ------------------------------------------------------------------


MOST_POINTS = 3600


def load_points(data: bytes, name: str = "table") -> tuple[LoadPoint, ...]:
    """The rows of the first two columns: cam angle [deg], force [N] or torque [N m]; delimiter, decimal mark and header are found.

    Raises TableError where there are no two columns of numbers, a row holds something else, or there are more than
    ``MOST_POINTS``. Whether the angles rise and the table closes is the design's to judge.
    """
    sheet = read_sheet(data, name)
    rows = [(row.line, [number(cell, sheet.decimal) for cell in row.cells[:2]]) for row in sheet.rows]
    wrong = [line for line, values in rows if len(values) < 2 or None in values]
    if wrong:
        raise TableError(
            name, [RowFault(wrong[0], "no two numbers; wanted: a cam angle and a force in each row", len(wrong))]
        )
    if len(rows) > MOST_POINTS:
        raise TableError(name, [RowFault(0, f"{len(rows)} rows; allowed: at most {MOST_POINTS}")])
    return tuple(LoadPoint(*values) for _, values in rows)  # type: ignore[arg-type]


def load_table_text(points: Iterable[LoadPoint]) -> str:
    """The same rows under their headings, cells apart by tabs."""
    return "\n".join(["cam angle, deg\tforce", *(f"{point.deg!r}\t{point.value!r}" for point in points)])


# -- the numbers of a measured table by cam angle ---------------------------------------------------------------


LEAST_ANGLES = 4  # different cam angles a curve can be laid through
SAME = 1e-6  # deg: angles this close are one
FEW = 5  # rows wrong in the same way that are named each
SOME = 2000  # rows of a long table whose digits are counted
LARGEST = 1e12  # of any number, so that squares of it stay numbers
OUT_OF_ORDER = 0.02  # of the rows may stand out of order before the whole table counts as unsorted


@frozen(eq=False)
class MeasuredColumn:
    """A column of values.

    name, quantity, unit  of it; order: of the derivative
    values    (n,) in the motion's unit per degree^order, nan where a cell holds none
    size      how many of that one unit of the table is
    decimals  after the point in the file, at most
    """

    name: str
    quantity: str
    unit: str
    order: int
    values: np.ndarray
    size: float
    decimals: int


@frozen(eq=False)
class MeasuredTable:
    """Measured values by cam angle, in the order of the file.

    motion_unit  mm or deg
    lines        (n,) line of the file
    angles       (n,) cam angle [deg], 0 ... 360
    values       (n,) in motion_unit per degree^order
    size         how many of that one unit of the table is
    decimals     after the point in the file, at most
    closing      the row a whole turn after the first, and the first; None where no row closes the turn so
    notes        what was found and how it was taken
    beside       the columns of the other quantities
    """

    name: str
    layout: ColumnLayout
    motion_unit: str
    lines: np.ndarray
    angles: np.ndarray
    values: np.ndarray
    size: float
    decimals: int
    closing: tuple[int, int] | None
    notes: tuple[str, ...]
    other_columns: tuple[MeasuredColumn, ...] = ()

    @property
    def columns(self) -> tuple[MeasuredColumn, ...]:
        """The column of the motion, and those of its other derivatives."""
        how = self.layout
        own = MeasuredColumn(how.name, how.quantity, self.unit, how.order, self.values, self.size, self.decimals)
        return (own, *self.other_columns)

    @property
    def unit(self) -> str:
        """The unit of the values as the file has them."""
        return self.layout.unit.name

    def used_rows(self, left_out: Sequence[int]) -> np.ndarray:
        """The rows but those left out, by their place in the table."""
        kept = np.ones(self.angles.size, dtype=bool)
        kept[list(left_out)] = False
        return np.flatnonzero(kept)

    def lines_text(self, rows: Sequence[int]) -> str:
        """The lines of these rows, ``lines 4-9, 12``."""
        return line_ranges(self.lines[list(rows)].tolist())


def read_table(
    sheet: Worksheet, how: ColumnLayout, speed_rpm: float | None = None, leave_out: Collection[int] = ()
) -> MeasuredTable:
    """The numbers of the columns that ``how`` names; rows in the order of the file, but for the lines that are left out.

    Raises TableError with every wrong row: a cell that is no number, a row too short, an angle out of order. Where many rows
    are wrong in the same way, the first stands for all.
    """
    if missing := set(leave_out) - {row.line for row in sheet.rows} if leave_out else set():
        raise TableError(
            sheet.name, [RowFault(0, f"{line_ranges(missing)} to be left out: no row of the table stands there")]
        )
    lines, raw, values, other_columns, decimals, others = (_at_once if sheet.numbers is not None else _row_by_row)(
        sheet, how, set(leave_out)
    )
    seconds = TIME_UNITS.get(how.angle_unit)
    by = ANGLE_UNITS.get(how.angle_unit, how.turn) if seconds is None else seconds * 6.0 * (speed_rpm or 1.0)
    turned = raw * by * how.part
    angles = np.mod(turned, 360.0)
    angles = np.where((angles > 360.0 - SAME) | (angles < SAME), 0.0, angles)
    different = distinct_angles(angles)[0].size
    if different < LEAST_ANGLES:
        problem = f"{different} different cam angles; at least {LEAST_ANGLES} are wanted"
        raise TableError(sheet.name, [RowFault(0, problem)])
    size = how.unit.by_degree(speed_rpm)
    closing = _closing(turned, angles)
    sizes = [other.unit.by_degree(speed_rpm) for other in how.other_columns]
    return MeasuredTable(
        sheet.name,
        how,
        how.unit.motion,
        lines,
        angles,
        values * size,
        size,
        decimals,
        closing,
        (*_notes(lines, turned, angles, closing), *_no_numbers(sheet, how, set(leave_out))),
        tuple(
            MeasuredColumn(other.name, other.quantity, other.unit.name, other.order, column * each, each, digits)
            for other, column, each, digits in zip(how.other_columns, other_columns, sizes, others, strict=True)
        ),
    )


_Columns = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int, list[int]]
"""Lines, angles and values (n,), other columns (k, n), digits behind the point of the values and of the others."""


def _at_once(sheet: Worksheet, how: ColumnLayout, leave_out: Collection[int]) -> _Columns:
    """Of a long table of numbers; their digits are those of some of its rows."""
    numbers = sheet.numbers
    assert numbers is not None
    lines = sheet.rows[0].line + np.arange(len(sheet.rows))
    if leave_out:
        kept = ~np.isin(lines, list(leave_out))
        lines, numbers = lines[kept], numbers[kept]
    if how.value_column >= numbers.shape[1] or how.angle_column >= numbers.shape[1]:
        raise TableError(
            sheet.name, [RowFault(0, f"{numbers.shape[1]} columns of numbers; no column {how.value_column + 1}")]
        )
    raw, values = numbers[:, how.angle_column], numbers[:, how.value_column]
    if too_large := np.flatnonzero(
        np.abs(numbers[:, [how.angle_column, how.value_column]]).max(axis=1) > LARGEST
    ).tolist():
        raise TableError(
            sheet.name, [RowFault(int(lines[too_large[0]]), f"too large; wanted: at most {LARGEST:g}", len(too_large))]
        )
    if wrong := _out_of_order(raw, lines):
        raise TableError(sheet.name, wrong)
    some = [sheet.rows[i] for i in range(0, len(sheet.rows), max(1, len(sheet.rows) // SOME))]
    columns = [how.value_column, *(other.column for other in how.other_columns)]
    digits = [
        max((_decimals(row.cells[c], sheet.decimal) for row in some if c < len(row.cells)), default=0) for c in columns
    ]
    return lines, raw, values, numbers[:, columns[1:]].T, digits[0], digits[1:]


def _row_by_row(sheet: Worksheet, how: ColumnLayout, leave_out: Collection[int]) -> _Columns:
    faults: dict[object, list[RowFault]] = {}
    lines, pairs, decimals = [], [], 0
    other_columns: list[list[float]] = []
    others = [0] * len(how.other_columns)
    columns = how.angle_column, how.value_column
    last = max(columns)
    for row in sheet.rows:
        if row.line in leave_out:
            continue
        if _has_wrong_columns(sheet, row, last):
            alike = faults.setdefault(("columns",), [])
            alike.append(RowFault(row.line, _columns_text(sheet, row, last) if len(alike) < FEW else ""))
            continue
        pair = [number(row.cells[column], sheet.decimal) for column in columns]
        if problems := _cells_wrong(sheet, row, columns, pair):
            faults.setdefault(tuple(problems), []).append(RowFault(row.line, "; ".join(problems.values())))
            continue
        lines.append(row.line)
        pairs.append(pair)
        other_columns.append([_or_nan(sheet, row, other.column) for other in how.other_columns])
        decimals = max(decimals, _decimals(row.cells[how.value_column], sheet.decimal))
        for k, other in enumerate(how.other_columns):
            if not np.isnan(other_columns[-1][k]):
                others[k] = max(others[k], _decimals(row.cells[other.column], sheet.decimal))
    raw, values = np.array(pairs, dtype=float).reshape(-1, 2).T
    faults["angles"] = _out_of_order(raw, np.array(lines))
    if any(faults.values()):
        raise TableError(sheet.name, sorted(fault for alike in faults.values() for fault in _gathered(alike)))
    others_of = np.array(other_columns, dtype=float).reshape(len(lines), len(how.other_columns)).T
    return np.array(lines), raw, values, others_of, decimals, others


def _no_numbers(sheet: Worksheet, how: ColumnLayout, leave_out: Collection[int]) -> Iterator[str]:
    """A sentence for each other column with cells that hold something, but no number."""
    for other in how.other_columns if sheet.numbers is None else ():
        cells = {
            row.line: row.cells[other.column]
            for row in sheet.rows
            if row.line not in leave_out and other.column < len(row.cells) and row.cells[other.column].strip()
        }
        if wrong := [line for line, cell in cells.items() if number(cell, sheet.decimal) is None]:
            which = "the cell is" if len(wrong) == 1 else "these cells are"
            yield f"{other.name}, {line_ranges(wrong)}: {cells[wrong[0]]!r} is no number; {which} left out"


def _or_nan(sheet: Worksheet, row: WorksheetRow, column: int) -> float:
    value = number(row.cells[column], sheet.decimal) if column < len(row.cells) else None
    return np.nan if value is None else value


def _has_wrong_columns(sheet: Worksheet, row: WorksheetRow, last: int) -> bool:
    """Whether a row has too few cells, or too many that are numbers; remarks behind the columns are not."""
    behind = row.cells[sheet.columns :]
    return last >= len(row.cells) or any(number(cell, sheet.decimal) is not None for cell in behind)


def _columns_text(sheet: Worksheet, row: WorksheetRow, last: int) -> str:
    """What is wrong with the number of a row's cells."""
    count = len(row.cells)
    shown = _shown(DELIMITERS[sheet.delimiter].join(row.cells))
    return f"{shown} has {count} {'column' if count == 1 else 'columns'}; {max(sheet.columns, last + 1)} are wanted"


def _cells_wrong(
    sheet: Worksheet, row: WorksheetRow, columns: Sequence[int], values: Sequence[float | None]
) -> dict[str, str]:
    """Kind of fault and column -> what is wrong with the cell there; values: the numbers they are taken for."""
    problems = {}
    for column, value in zip(columns, values, strict=True):
        cell, there = row.cells[column], column_name(sheet, column)
        if not cell:
            problems[f"nothing in {there}"] = f"nothing stands in {there}"
        elif value is None or abs(value) > LARGEST:
            wanted = _wanted(cell, sheet, value)
            problems[f"{wanted} in {there}"] = f"{_shown(cell)} in {there}: {wanted}"
    return problems


def _gathered(alike: Sequence[RowFault]) -> Sequence[RowFault]:
    """Faults of the same kind; where they are many, the first, which names the lines of the others."""
    if len(alike) <= FEW:
        return alike
    first, *others = alike
    text = f"{first.text}; the same in {len(others)} more rows, {line_ranges(f.line for f in others)}"
    return [RowFault(first.line, text, len(alike), tuple(f.line for f in others))]


def _shown(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _wanted(cell: str, sheet: Worksheet, value: float | None) -> str:
    mark = DECIMALS[sheet.decimal]
    other = "." if mark == "," else ","
    if value is not None:
        return f"too large; wanted: at most {LARGEST:g}"
    if other in cell and number(cell.replace(other, ""), sheet.decimal) is not None:
        return f"a thousand, or a decimal {mark!r} meant? wanted: a number without {other!r}"
    return f"wanted: a number with a decimal {mark!r}"


def _decimals(cell: str, decimal: str) -> int:
    """Digits behind the decimal mark, those that an exponent moves there counted too."""
    mantissa, _, exponent = cell.lower().replace("d", "e").partition("e")
    behind = len(mantissa.strip().partition(DECIMALS[decimal])[2].strip('"'))
    return behind - int(exponent) if exponent.lstrip("+-").isdecimal() else behind


def _out_of_order(raw: np.ndarray, lines: np.ndarray) -> list[RowFault]:
    """Single rows that stand out of an order which the rows around them keep; none where the table has no order."""
    steps = np.diff(raw)
    if raw.size < LEAST_ANGLES or not steps.any():
        return []
    sign = 1.0 if (steps > 0.0).sum() >= (steps < 0.0).sum() else -1.0
    rising = sign * raw
    result: set[int] = set()
    for i in np.flatnonzero(sign * steps < 0.0).tolist():
        continues = i + 2 >= raw.size or rising[i + 2] > rising[i + 1]
        if i + 2 < raw.size and rising[i + 2] > rising[i]:
            result.add(i + 1)  # too small
        elif i > 0 and rising[i + 1] > rising[i - 1] and continues:
            result.add(i)  # too large
    if len(result) > max(2.0, OUT_OF_ORDER * raw.size):
        return []
    order = "rise" if sign > 0.0 else "fall"
    wanted = f"where the angles {order}; wanted: the rows in order, or this angle mended"
    return [
        RowFault(int(lines[i]), f"angle {raw[i]:g} behind {raw[i - 1]:g} and before {raw[i + 1]:g}, {wanted}")
        for i in sorted(result)
    ]


# -- the rows as a whole ----------------------------------------------------------------------------------------


def distinct_angles(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different cam angles [deg] in order (m,), and for each row (n,) which of them it stands at."""
    order = np.argsort(angles, kind="stable")
    ordered = angles[order]
    new = np.concatenate(([True], np.diff(ordered) > SAME))
    place = np.empty(angles.size, dtype=int)
    place[order] = np.cumsum(new) - 1
    return ordered[new], place


def gaps(angles: np.ndarray) -> list[tuple[float, float]]:
    """Stretches (from, to) [deg] without a row: wider than 10 deg and thrice the usual distance; the last may pass 360."""
    apart, _ = distinct_angles(angles)
    width = np.diff(np.append(apart, apart[0] + 360.0))
    wide = width > max(10.0, 3.0 * float(np.median(width)))
    return [(float(apart[i]), float(apart[i] + width[i])) for i in np.flatnonzero(wide)]


def _notes(lines: np.ndarray, turned: np.ndarray, angles: np.ndarray, closing: tuple[int, int] | None) -> Iterator[str]:
    """Sentences on the rows as a whole; turned: the angles before they are laid into one turn [deg]."""
    steps = np.diff(turned)
    rising, falling = int((steps > 0.0).sum()), int((steps < 0.0).sum())
    if rising and falling and min(rising, falling) > 1:
        yield "the angles rise and fall; the rows are sorted"
    elif falling > rising:
        yield "the angles fall; the rows are sorted"
    reach = float(turned.max() - turned.min())
    if reach > 360.0 + SAME:
        yield f"the angles cover {reach / 360.0:.4g} turns, which are laid over one another"
    _, place = distinct_angles(angles)
    if closing is not None:
        last, first = closing
        yield f"line {lines[last]} is a whole turn after line {lines[first]}: the same cam angle again"
    others = place if closing is None else np.delete(place, closing[0])
    again = others.size - np.unique(others).size
    if again and reach <= 360.0 + SAME:
        rows = lines[place == int(np.bincount(others).argmax())]
        where = ", ".join(map(str, rows[:4]))
        yield f"{again} {'row repeats' if again == 1 else 'rows repeat'} a cam angle (as lines {where}): their mean counts"


def _closing(turned: np.ndarray, angles: np.ndarray) -> tuple[int, int] | None:
    """The row a turn after the first, and the first; turned: the angles before they are laid into one turn [deg]."""
    first, last = int(np.argmin(turned)), int(np.argmax(turned))
    closed = abs(turned[last] - turned[first] - 360.0) <= SAME and abs(angles[last] - angles[first]) <= SAME
    return (last, first) if closed else None
