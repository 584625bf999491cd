"""Numbers of a measured table by cam angle; every faulty row is reported with its line."""

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
from core.number_text import result_text

# -- table of force over the turn -------------------------------------------------------------------------------


MOST_POINTS = 3600


def load_points(data: bytes, name: str = "table") -> tuple[LoadPoint, ...]:
    """Rows of the first two columns: cam angle [deg], and force [N] or torque [N m]; the format is detected.

    Raises TableError where there are no two columns of numbers, a row contains anything else, or the rows are more than
    ``MOST_POINTS``. Order and closure of the angles are checked in the design.
    """
    sheet = read_sheet(data, name)
    rows = [(row.line, [number(cell, sheet.decimal) for cell in row.cells[:2]]) for row in sheet.rows]
    wrong = [line for line, values in rows if len(values) < 2 or None in values]
    if wrong:
        raise TableError(
            name, [RowFault(wrong[0], "no two numbers; required: a cam angle and a force in each row", len(wrong))]
        )
    if len(rows) > MOST_POINTS:
        raise TableError(name, [RowFault(0, f"{len(rows)} rows; allowed: at most {MOST_POINTS}")])
    return tuple(LoadPoint(*values) for _, values in rows)  # type: ignore[arg-type]


def load_table_text(points: Iterable[LoadPoint]) -> str:
    """Points as text with headers and tabs between cells."""
    return "\n".join(["cam angle, deg\tforce", *(f"{point.deg!r}\t{point.value!r}" for point in points)])


# -- measured table ---------------------------------------------------------------------------------------------


LEAST_ANGLES = 4  # least number of distinct cam angles of a curve
SAME = 1e-6  # [deg] closer angles are equal
FEW = 5  # greatest number of rows with the same fault that are listed individually
SOME = 2000  # rows of a long table whose digits are counted
LARGEST = 1e12  # largest number, whose square does not overflow
OUT_OF_ORDER = 0.02  # greatest fraction of single rows out of order; more are an unsorted table


@frozen(eq=False)
class MeasuredColumn:
    """A column of values.

    Attributes
    ----------
    name, quantity, unit : as in the table
    order : order of the derivative
    values : ndarray (n,) [unit of the motion per deg^order], NaN where a cell has no number
    size : one unit of the table in that unit
    decimals : greatest number of decimals in the file
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

    Attributes
    ----------
    motion_unit : mm or deg
    lines : ndarray (n,), dimensionless
        Lines in the file.
    angles : ndarray (n,) [deg]
        Cam angles, 0 ... 360.
    values : ndarray (n,) [motion_unit per deg^order]
    size : one unit of the table in that unit
    decimals : greatest number of decimals in the file
    closing : the row a full turn after the first, and the first; None where there is none
    notes : sentences on the table and its interpretation
    other_columns : columns of the other quantities
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
        """Column of the motion, then those of its other derivatives."""
        layout = self.layout
        motion_column = MeasuredColumn(
            layout.name, layout.quantity, self.unit, layout.order, self.values, self.size, self.decimals
        )
        return (motion_column, *self.other_columns)

    @property
    def unit(self) -> str:
        """Unit of the values in the file."""
        return self.layout.unit.name

    def used_rows(self, left_out: Sequence[int]) -> np.ndarray:
        """Numbers of the rows in use.

        Parameters
        ----------
        left_out : sequence of int
            Rows that are left out.

        Returns
        -------
        ndarray (m,), dimensionless
        """
        is_used = np.ones(self.angles.size, dtype=bool)
        is_used[list(left_out)] = False
        return np.flatnonzero(is_used)

    def lines_text(self, rows: Sequence[int]) -> str:
        """Lines of some rows as text: ``lines 4-9, 12``."""
        return line_ranges(self.lines[list(rows)].tolist())


def read_table(
    sheet: Worksheet, layout: ColumnLayout, speed_rpm: float | None = None, leave_out: Collection[int] = ()
) -> MeasuredTable:
    """Numbers of the columns of a layout, in the order of the file, without the lines that are left out.

    Raises TableError with every faulty row: a cell without a number, a row that is too short, an angle out of order.
    Where many rows have the same fault, the first one lists the others.
    """
    if missing := set(leave_out) - {row.line for row in sheet.rows} if leave_out else set():
        raise TableError(
            sheet.name, [RowFault(0, f"{line_ranges(missing)} cannot be left out: the table has no row there")]
        )
    lines, raw, values, other_columns, decimals, other_decimals = (
        _array_columns if sheet.numbers is not None else _parsed_columns
    )(sheet, layout, set(leave_out))
    seconds = TIME_UNITS.get(layout.angle_unit)
    degrees = ANGLE_UNITS.get(layout.angle_unit, layout.turn) if seconds is None else seconds * 6.0 * (speed_rpm or 1.0)
    unwrapped = raw * degrees * layout.part
    angles = np.mod(unwrapped, 360.0)
    angles = np.where((angles > 360.0 - SAME) | (angles < SAME), 0.0, angles)
    different = distinct_angles(angles)[0].size
    if different < LEAST_ANGLES:
        problem = f"{different} different cam angles; at least {LEAST_ANGLES} are required"
        raise TableError(sheet.name, [RowFault(0, problem)])
    size = layout.unit.by_degree(speed_rpm)
    closing = _closing(unwrapped, angles)
    sizes = [other.unit.by_degree(speed_rpm) for other in layout.other_columns]
    return MeasuredTable(
        sheet.name,
        layout,
        layout.unit.motion,
        lines,
        angles,
        values * size,
        size,
        decimals,
        closing,
        (*_notes(lines, unwrapped, angles, closing), *_no_numbers(sheet, layout, set(leave_out))),
        tuple(
            MeasuredColumn(other.name, other.quantity, other.unit.name, other.order, column * factor, factor, digits)
            for other, column, factor, digits in zip(
                layout.other_columns, other_columns, sizes, other_decimals, strict=True
            )
        ),
    )


_Columns = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int, list[int]]
"""Lines, angles and values (n,), other columns (k, n), numbers of decimals of the values and of the others."""


def _array_columns(sheet: Worksheet, layout: ColumnLayout, leave_out: Collection[int]) -> _Columns:
    """Columns of a long table of numbers; decimals are counted in a sample of its rows."""
    numbers = sheet.numbers
    assert numbers is not None
    lines = sheet.rows[0].line + np.arange(len(sheet.rows))
    if leave_out:
        is_used = ~np.isin(lines, list(leave_out))
        lines, numbers = lines[is_used], numbers[is_used]
    if layout.value_column >= numbers.shape[1] or layout.angle_column >= numbers.shape[1]:
        raise TableError(
            sheet.name, [RowFault(0, f"{numbers.shape[1]} columns of numbers; no column {layout.value_column + 1}")]
        )
    raw, values = numbers[:, layout.angle_column], numbers[:, layout.value_column]
    if too_large := np.flatnonzero(
        np.abs(numbers[:, [layout.angle_column, layout.value_column]]).max(axis=1) > LARGEST
    ).tolist():
        raise TableError(
            sheet.name, [RowFault(int(lines[too_large[0]]), f"too large; allowed: at most {LARGEST:g}", len(too_large))]
        )
    if faults := _out_of_order(raw, lines):
        raise TableError(sheet.name, faults)
    sampled = [sheet.rows[i] for i in range(0, len(sheet.rows), max(1, len(sheet.rows) // SOME))]
    columns = [layout.value_column, *(other.column for other in layout.other_columns)]
    digits = [
        max((_decimals(row.cells[c], sheet.decimal) for row in sampled if c < len(row.cells)), default=0)
        for c in columns
    ]
    return lines, raw, values, numbers[:, columns[1:]].T, digits[0], digits[1:]


def _parsed_columns(sheet: Worksheet, layout: ColumnLayout, leave_out: Collection[int]) -> _Columns:
    faults: dict[object, list[RowFault]] = {}
    lines, pairs, decimals = [], [], 0
    other_values: list[list[float]] = []
    other_decimals = [0] * len(layout.other_columns)
    columns = layout.angle_column, layout.value_column
    last = max(columns)
    for row in sheet.rows:
        if row.line in leave_out:
            continue
        if _has_wrong_columns(sheet, row, last):
            same_faults = faults.setdefault(("columns",), [])
            same_faults.append(RowFault(row.line, _columns_text(sheet, row, last) if len(same_faults) < FEW else ""))
            continue
        pair = [number(row.cells[column], sheet.decimal) for column in columns]
        if problems := _cell_faults(sheet, row, columns, pair):
            faults.setdefault(tuple(problems), []).append(RowFault(row.line, "; ".join(problems.values())))
            continue
        lines.append(row.line)
        pairs.append(pair)
        other_values.append([_or_nan(sheet, row, other.column) for other in layout.other_columns])
        decimals = max(decimals, _decimals(row.cells[layout.value_column], sheet.decimal))
        for k, other in enumerate(layout.other_columns):
            if not np.isnan(other_values[-1][k]):
                other_decimals[k] = max(other_decimals[k], _decimals(row.cells[other.column], sheet.decimal))
    raw, values = np.array(pairs, dtype=float).reshape(-1, 2).T
    faults["angles"] = _out_of_order(raw, np.array(lines))
    if any(faults.values()):
        raise TableError(
            sheet.name, sorted(fault for same_faults in faults.values() for fault in _summarised(same_faults))
        )
    others = np.array(other_values, dtype=float).reshape(len(lines), len(layout.other_columns)).T
    return np.array(lines), raw, values, others, decimals, other_decimals


def _no_numbers(sheet: Worksheet, layout: ColumnLayout, leave_out: Collection[int]) -> Iterator[str]:
    """A sentence for each other column with non-empty cells that are no number."""
    for other in layout.other_columns if sheet.numbers is None else ():
        cells = {
            row.line: row.cells[other.column]
            for row in sheet.rows
            if row.line not in leave_out and other.column < len(row.cells) and row.cells[other.column].strip()
        }
        if lines := [line for line, cell in cells.items() if number(cell, sheet.decimal) is None]:
            which = "the cell is" if len(lines) == 1 else "these cells are"
            yield f"{other.name}, {line_ranges(lines)}: {cells[lines[0]]!r} is no number; {which} left out"


def _or_nan(sheet: Worksheet, row: WorksheetRow, column: int) -> float:
    value = number(row.cells[column], sheet.decimal) if column < len(row.cells) else None
    return np.nan if value is None else value


def _has_wrong_columns(sheet: Worksheet, row: WorksheetRow, last: int) -> bool:
    """Whether a row has too few cells, or too many with numbers; remarks after the columns are allowed."""
    further = row.cells[sheet.columns :]
    return last >= len(row.cells) or any(number(cell, sheet.decimal) is not None for cell in further)


def _columns_text(sheet: Worksheet, row: WorksheetRow, last: int) -> str:
    """Text on a wrong number of cells."""
    count = len(row.cells)
    shown = _shown(DELIMITERS[sheet.delimiter].join(row.cells))
    return f"{shown} has {count} {'column' if count == 1 else 'columns'}; {max(sheet.columns, last + 1)} are required"


def _cell_faults(
    sheet: Worksheet, row: WorksheetRow, columns: Sequence[int], values: Sequence[float | None]
) -> dict[str, str]:
    """Kind of fault and column -> its text."""
    problems = {}
    for column, value in zip(columns, values, strict=True):
        cell, column_text = row.cells[column], column_name(sheet, column)
        if not cell:
            problems[f"nothing in {column_text}"] = f"{column_text} is empty"
        elif value is None or abs(value) > LARGEST:
            remedy = _remedy(cell, sheet, value)
            problems[f"{remedy} in {column_text}"] = f"{_shown(cell)} in {column_text}: {remedy}"
    return problems


def _summarised(faults: Sequence[RowFault]) -> Sequence[RowFault]:
    """Faults of the same kind; where they are many, the first one with the lines of the others."""
    if len(faults) <= FEW:
        return faults
    first, *others = faults
    text = f"{first.text}; the same in {len(others)} more rows, {line_ranges(f.line for f in others)}"
    return [RowFault(first.line, text, len(faults), tuple(f.line for f in others))]


def _shown(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _remedy(cell: str, sheet: Worksheet, value: float | None) -> str:
    mark = DECIMALS[sheet.decimal]
    other_mark = "." if mark == "," else ","
    if value is not None:
        return f"too large; allowed: at most {LARGEST:g}"
    if other_mark in cell and number(cell.replace(other_mark, ""), sheet.decimal) is not None:
        return f"thousands separator or decimal mark? required: a number without {other_mark!r}"
    return f"required: a number with a decimal {mark!r}"


def _decimals(cell: str, decimal: str) -> int:
    """Number of decimals of a cell, with its exponent."""
    mantissa, _, exponent = cell.lower().replace("d", "e").partition("e")
    count = len(mantissa.strip().partition(DECIMALS[decimal])[2].strip('"'))
    return count - int(exponent) if exponent.lstrip("+-").isdecimal() else count


def _out_of_order(raw: np.ndarray, lines: np.ndarray) -> list[RowFault]:
    """Single rows out of the order of the rows around them; empty where the table has no order."""
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
    remedy = f"where the angles {order}; sort the rows, or correct this angle"
    return [
        RowFault(int(lines[i]), f"angle {raw[i]:g} after {raw[i - 1]:g} and before {raw[i + 1]:g}, {remedy}")
        for i in sorted(result)
    ]


# -- all rows ---------------------------------------------------------------------------------------------------


def distinct_angles(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distinct cam angles in order.

    Parameters
    ----------
    angles : ndarray (n,) [deg]

    Returns
    -------
    distinct : ndarray (m,) [deg]
    index : ndarray (n,), dimensionless
        Number of the distinct angle of each row.
    """
    order = np.argsort(angles, kind="stable")
    ordered = angles[order]
    new = np.concatenate(([True], np.diff(ordered) > SAME))
    index = np.empty(angles.size, dtype=int)
    index[order] = np.cumsum(new) - 1
    return ordered[new], index


def gaps(angles: np.ndarray) -> list[tuple[float, float]]:
    """Intervals without rows that are wider than 10 deg and than three typical distances.

    Parameters
    ----------
    angles : ndarray (n,) [deg]

    Returns
    -------
    list of tuple of float
        From and to [deg]; the last one may exceed 360.
    """
    ordered, _ = distinct_angles(angles)
    width = np.diff(np.append(ordered, ordered[0] + 360.0))
    wide = width > max(10.0, 3.0 * float(np.median(width)))
    return [(float(ordered[i]), float(ordered[i] + width[i])) for i in np.flatnonzero(wide)]


def _notes(
    lines: np.ndarray, unwrapped: np.ndarray, angles: np.ndarray, closing: tuple[int, int] | None
) -> Iterator[str]:
    """Sentences on all rows; ``unwrapped``: angles [deg] before the reduction to one turn."""
    steps = np.diff(unwrapped)
    rising, falling = int((steps > 0.0).sum()), int((steps < 0.0).sum())
    if rising and falling and min(rising, falling) > 1:
        yield "the angles rise and fall; the rows are sorted"
    elif falling > rising:
        yield "the angles fall; the rows are sorted"
    reach = float(unwrapped.max() - unwrapped.min())
    if reach > 360.0 + SAME:
        yield f"the angles cover {result_text(reach / 360.0)} turns, which are superposed"
    _, index = distinct_angles(angles)
    if closing is not None:
        last, first = closing
        yield f"line {lines[last]} is a full turn after line {lines[first]}: the same cam angle again"
    others = index if closing is None else np.delete(index, closing[0])
    repeats = others.size - np.unique(others).size
    if repeats and reach <= 360.0 + SAME:
        rows = lines[index == int(np.bincount(others).argmax())]
        shown = ", ".join(map(str, rows[:4]))
        yield f"{repeats} {'row repeats' if repeats == 1 else 'rows repeat'} a cam angle (as lines {shown}): their mean is used"


def _closing(unwrapped: np.ndarray, angles: np.ndarray) -> tuple[int, int] | None:
    """The row a full turn after the first, and the first; ``unwrapped``: angles [deg] before their reduction."""
    first, last = int(np.argmin(unwrapped)), int(np.argmax(unwrapped))
    closed = abs(unwrapped[last] - unwrapped[first] - 360.0) <= SAME and abs(angles[last] - angles[first]) <= SAME
    return (last, first) if closed else None
