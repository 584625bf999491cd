"""A measured table and the motion fitted to it as text and as data."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from typing import Any

import numpy as np

from core.measured import MotionFit, Worksheet
from core.measured.columns import column_name
from core.measured.fitting import EXACT, MOST, contradiction
from core.output.lines import columns

PLURALS = {"displacement": "displacements", "velocity": "velocities", "acceleration": "accelerations"}
LARGE = 4.0  # measuring errors
WAVES, LEAST_WAVES = 1.0, 12  # of ``MotionFit.waves``, which is 2 at random; rows that it takes to judge
MOST_LINES = 30  # of wrong rows before the rest is counted only


def digits(value: float, most: int = 6) -> str:
    """So many significant digits, without needless zeros."""
    return f"{value + 0.0:.{most}g}"


def notes(fit: MotionFit) -> tuple[str, ...]:
    """What was found in the table, what was guessed, and what the fit made of it; a sentence each."""
    return (*fit.table.layout.guesses, *fit.table.notes, *_of_the_fit(fit))


def _of_the_fit(fit: MotionFit) -> Iterator[str]:
    table, unit = fit.table, fit.table.unit
    if fit.guessed:
        yield f"the measuring error is not stated; {digits(fit.error, 2)} {unit} is what the rows themselves tell"
    result, left_out = fit.outliers, "left out of the fit" if fit.left_out else "fitted with the others"
    if result.wrong:
        yield f"{table.named(result.wrong)}: wrong, no smooth curve joins them to the rows beside; {left_out}"
    if result.possible:
        yield f"{table.named(result.possible)}: beside wrong rows, they may be wrong too, nothing tells; {left_out}"
    if result.undecided:
        yield f"{contradiction(table, result)}; {left_out}"
    if table.closing is not None:
        last, first = table.closing
        apart = (table.values[last] - table.values[first]) / table.size
        if abs(apart) > LARGE * sqrt(2.0) * fit.error:
            yield f"the table does not close: a turn later, line {table.lines[last]} is {digits(apart, 4)} {unit} off"
    if fit.error and fit.rms > 1.001 * fit.error:
        why = f"{MOST} points" if len(fit.points) >= MOST else "rows that repeat a cam angle"
        yield f"{why} leave {digits(fit.rms, 4)} {unit}, more than the measuring error"
    if fit.error == 0.0 and fit.smoothing:
        yield f"more rows than {MOST} points can go through; the curve is the nearest one"
    if fit.waves < WAVES and fit.error and fit.residuals.size >= LEAST_WAVES:
        yield "residuals beside each other are alike: the curve leaves out some of the motion; a smaller error would keep it"
    for other, off, size, row in fit.differences():
        part = f", {digits(100.0 * off / size, 2)} % of its largest" if size else ""
        there = f"line {table.lines[row]} ({digits(float(table.angles[row]))} deg)"
        most = f"{digits(off, 3)} {other.unit.name}"
        yield f"{other.name} is compared, not fitted: the motion's {other.quantity} is at most {most} off{part}, {there}"
    order, motion_unit = table.layout.order, fit.motion.unit
    if order:
        stands = f"its lowest position is {digits(fit.lowest)} {motion_unit}"
        yield f"a table of {PLURALS[table.layout.quantity]} does not tell where the follower stands; {stands}"
        if abs(fit.offset) > EXACT * float(np.ptp(table.values)) / abs(table.size):
            gained = f"{digits(fit.offset * table.size * 360.0, 4)} {motion_unit}{'' if order == 1 else '/deg'}"
            taken = f"{digits(fit.offset, 4)} {unit} is taken off every row"
            yield f"over a turn the table gains {gained}, which no cam can; {taken}"


def suspicions(fit: MotionFit) -> list[str]:
    """A line for each wrong row, the worst first."""
    return [row_line(fit, i) for i in worst_first(fit)]


def worst_first(fit: MotionFit) -> list[int]:
    """The wrong rows by their residual."""
    return sorted(fit.outliers.wrong, key=lambda i: -abs(fit.residuals[i]))


def row_line(fit: MotionFit, row: int) -> str:
    """A row with its residual: ``line 57 (54.5 deg): 12.34 mm, 4.98 mm off the curve``."""
    table = fit.table
    there = f"line {table.lines[row]} ({digits(float(table.angles[row]))} deg)"
    value = digits(float(table.values[row] / table.size))
    return f"{there}: {value} {table.unit}, {digits(float(fit.residuals[row]), 4)} {table.unit} off the curve"


def detected(sheet: Worksheet, fit: MotionFit) -> list[tuple[str, str]]:
    """How the file was read: what, and how."""
    layout = fit.table.layout
    headers = {0: "no header", 1: "1 header line"}.get(sheet.header, f"{sheet.header} header lines")
    return [
        ("rows", f"{len(sheet.rows)}, {headers}, {sheet.encoding}"),
        ("delimiter", f"{sheet.delimiter}, decimal {sheet.decimal}"),
        ("cam angle", f"{column_name(sheet, layout.angle_column)}, in {layout.angle_unit}"),
        (layout.quantity, f"{column_name(sheet, layout.value_column)}, in {layout.unit.name}"),
    ]


def figures(fit: MotionFit) -> list[tuple[str, str]]:
    """The figures of the fit: name, value with unit."""
    unit, motion_unit = fit.table.unit, fit.motion.unit
    power = 5 - 2 * fit.table.layout.order
    through = float(np.abs(fit.residuals).max()) <= EXACT * float(np.abs(fit.table.values / fit.table.size).max())
    return [
        ("measuring error", f"{digits(fit.error, 4)} {unit}"),
        ("rms residual", f"{digits(0.0 if through else fit.rms, 4)} {unit}"),
        ("largest residual", "none; the curve goes through all rows" if through else row_line(fit, fit.largest)),
        ("points", f"{len(fit.points)} of {len(fit.residuals)} rows, free to choose {digits(fit.freedom, 3)} values"),
        (
            "smoothing",
            f"{digits(fit.smoothing, 4)} deg{'' if power == 1 else f'^{power}'}" if fit.smoothing else "none",
        ),
        ("stroke", f"{digits(fit.stroke)} {motion_unit}, from {digits(fit.lowest)} {motion_unit} on"),
    ]


def fit_text(sheet: Worksheet, fit: MotionFit) -> str:
    """All of it to read."""
    lines = [sheet.name, *columns(_padded(detected(sheet, fit)), left=2), ""]
    lines += columns(_padded(figures(fit)), left=2)
    for heading, entries in (("Notes", notes(fit)), ("Wrong rows", suspicions(fit))):
        if entries:
            lines += ["", heading, *(f"  {line}" for line in entries[:MOST_LINES])]
            lines += [f"  and {len(entries) - MOST_LINES} more"] if len(entries) > MOST_LINES else []
    return "\n".join(lines) + "\n"


def _padded(rows: list[tuple[str, str]]) -> list[tuple[str, str]]:
    return [(f"  {name}", value) for name, value in rows]


def fit_data(sheet: Worksheet, fit: MotionFit) -> dict[str, Any]:
    """The same as data; every residual with its line."""
    table, layout = fit.table, fit.table.layout
    return {
        "table": {
            "name": sheet.name,
            "encoding": sheet.encoding,
            "delimiter": sheet.delimiter,
            "decimal": sheet.decimal,
            "header_lines": sheet.header,
            "rows": len(sheet.rows),
            "angle": {
                "column": layout.angle_column + 1,
                "name": sheet.names[layout.angle_column],
                "unit": layout.angle_unit,
            },
            "value": {
                "column": layout.value_column + 1,
                "name": sheet.names[layout.value_column],
                "unit": layout.unit.name,
                "quantity": layout.quantity,
            },
        },
        "fit": {
            "error": fit.error,
            "error_guessed": fit.guessed,
            "rms_residual": fit.rms,
            "largest_residual": {"line": int(table.lines[fit.largest]), "value": float(fit.residuals[fit.largest])},
            "points": len(fit.points),
            "free_values": fit.freedom,
            "smoothing": fit.smoothing,
            "offset": fit.offset,
            f"stroke_{fit.motion.unit}": fit.stroke,
            f"lowest_{fit.motion.unit}": fit.lowest,
            f"start_{fit.motion.unit}": fit.motion.start,
        },
        "notes": list(notes(fit)),
        "left_out": [int(table.lines[i]) for i in fit.left_out],
        "undecided": [int(table.lines[i]) for stretch in fit.outliers.undecided for i in stretch],
        "possible": [int(table.lines[i]) for i in fit.outliers.possible],
        "suspects": [int(table.lines[i]) for i in fit.outliers.wrong],
        "residuals": [
            {"line": int(n), "cam_angle_deg": float(a), "value": float(v / table.size), "residual": float(r)}
            for n, a, v, r in zip(table.lines, table.angles, table.values, fit.residuals, strict=True)
        ],
    }
