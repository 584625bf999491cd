"""A table of force over the turn, from text: two columns, cam angle and force, as a spreadsheet or a file has them."""

from __future__ import annotations

from collections.abc import Iterable

from core.design import LoadPoint
from core.measured.sheet import RowFault, TableError, number, read_sheet

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


def as_text(points: Iterable[LoadPoint]) -> str:
    """The same rows under their headings, cells apart by tabs."""
    return "\n".join(["cam angle, deg\tforce", *(f"{point.deg!r}\t{point.value!r}" for point in points)])


__all__ = ["as_text", "load_points"]
