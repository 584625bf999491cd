"""A measured table and the motion fitted to it as text and as data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import sqrt
from typing import Any

import numpy as np

from core.measured import MeasuredColumn, MotionFit, SegmentFit, Worksheet
from core.measured.columns import column_name
from core.measured.event import Event, events, velocity_jumps
from core.measured.fitting import EXACT, MOST, contradiction
from core.measured.segments import difference
from core.measured.structure import DWELL
from core.number_text import result_text
from core.output.lines import columns

PLURALS = {"displacement": "displacements", "velocity": "velocities", "acceleration": "accelerations"}
LARGE = 5.0  # in measuring errors
NEGLIGIBLE = 1e-9  # relative to a column's size
WAVES, LEAST_WAVES = 1.0, 12  # limit of ``MotionFit.waves``, which is 2 for random residuals; rows required for it
IN_INCHES = {1.27: " (0.05 in)"}
MOST_LINES = 30  # of wrong rows; further ones are counted


def notes(fit: MotionFit) -> tuple[str, ...]:
    """Sentences on the table, on assumptions about it, and on the fit."""
    return (*fit.table.layout.guesses, *fit.table.notes, *_fit_notes(fit))


def _fit_notes(fit: MotionFit) -> Iterator[str]:
    table, unit = fit.table, fit.table.unit
    if fit.is_guessed:
        yield f"the measuring error is not stated; {result_text(fit.error, 2)} {unit} is estimated from the rows"
    for gap in fit.gaps:
        treatment = "the spline bridges the gap" if gap.level is None else "the rows at both ends are level: a dwell"
        yield f"no rows from {result_text(gap.start)} to {result_text(float(np.mod(gap.end, 360.0)) or 360.0)} deg; {treatment}"
    result, use = fit.outliers, "omitted from the fit" if fit.left_out else "fitted with the others"
    if result.wrong:
        yield f"{table.lines_text(result.wrong)}: wrong, no smooth curve joins them to their neighbours; {use}"
    for column_fit in fit.columns[1:]:
        if wrong := fit.spoiled.get(column_fit.column.order, ()):
            rows = table.lines_text(wrong)
            yield f"{column_fit.column.name}: {rows}: wrong, no smooth curve joins them to their neighbours; these cells are omitted"
    if result.possible:
        yield f"{table.lines_text(result.possible)}: next to wrong rows, possibly wrong too; {use}"
    if result.undecided:
        yield f"{contradiction(table, result)}; {use}"
    if table.closing is not None:
        last, first = table.closing
        gap_at_end = (table.values[last] - table.values[first]) / table.size
        if abs(gap_at_end) > LARGE * sqrt(2.0) * fit.error:
            yield f"the table does not close: a turn later, the deviation of line {table.lines[last]} is {result_text(gap_at_end)} {unit}"
    if fit.error and fit.rms > 1.001 * fit.error and not fit.segments:
        why = f"{MOST} points" if len(fit.points) >= MOST else "rows that repeat a cam angle"
        yield f"{why} leave {result_text(fit.rms)} {unit}, more than the measuring error"
    if fit.error == 0.0 and fit.smoothing and not fit.segments:
        yield f"more rows than {MOST} points can interpolate; the curve is the nearest one"
    if fit.waves < WAVES and fit.error and not fit.segments and fit.residuals.size >= LEAST_WAVES:
        yield "neighbouring residuals are alike: the curve omits a part of the motion; a smaller error would retain it"
    yield from _column_notes(fit)
    for jump in fit.jumps:
        per = f"{table.motion_unit}/deg2"
        yield f"the acceleration jumps at {result_text(jump.angle)} deg, from {result_text(jump.before)} to {result_text(jump.after)} {per}"
    for step in velocity_jumps(fit):
        per = f"{table.motion_unit}/deg"
        yield f"the velocity jumps at {result_text(step.angle)} deg, from {result_text(step.before)} to {result_text(step.after)} {per}"
    order, motion_unit = table.layout.order, fit.motion.unit
    if order:
        position = f"its lowest position is {result_text(fit.lowest)} {motion_unit}"
        yield f"a table of {PLURALS[table.layout.quantity]} does not determine the position of the follower; {position}"
        if abs(fit.offset) > EXACT * float(np.ptp(table.values)) / abs(table.size):
            gained = f"{result_text(fit.offset * table.size * 360.0)} {motion_unit}{'' if order == 1 else '/deg'}"
            correction = f"{result_text(fit.offset)} {unit} is subtracted from every row"
            yield f"over a turn the table gains {gained}, which no cam can; {correction}"


def _column_notes(fit: MotionFit) -> Iterator[str]:
    """A sentence for each column from which the motion deviates by more than its error."""
    by_order = {column_fit.column.order: column_fit.column for column_fit in fit.columns}
    for gap in fit.contradicted:
        column, integral = by_order[gap.order], by_order[gap.order - 1]
        rows = np.flatnonzero(np.isin(np.round(fit.table.angles, 6), np.round(gap.angles, 6)))
        yield (
            f"{column.name} contradicts {integral.name}: overall it is {result_text(gap.factor)} times its derivative, "
            f"and {rows.size} rows deviate by more than their errors, {fit.table.lines_text(rows.tolist())}; "
            f"{_roles(fit, integral, column)}: correct the unit or the speed, or choose which to trust"
        )
    if fit.table.layout.trusted and fit.compared:
        names = ", ".join(by_order[order].name for order in fit.compared)
        yield f"the motion is fitted to {', '.join(fit.table.layout.trusted)}, as chosen; compared only: {names}"
    for column_fit in fit.columns:
        column = column_fit.column
        if column.order in fit.compared:
            continue
        used = fit.table.used_rows((*fit.left_out, *fit.spoiled.get(column.order, ())))
        size = float(np.nanmax(np.abs(column.values), initial=0.0)) / abs(column.size)
        allowed = max(column_fit.error, 10.0**-column.decimals / sqrt(12.0), NEGLIGIBLE * size)
        residuals = np.abs(np.nan_to_num(column_fit.residuals[used]))
        wrong = used[residuals > LARGE * allowed]
        if wrong.size:
            worst = int(used[np.argmax(residuals)])
            part = f", {result_text(100.0 * float(residuals.max()) / size, 2)} % of its largest" if size else ""
            location = f"line {fit.table.lines[worst]} ({result_text(float(fit.table.angles[worst]))} deg)"
            yield (
                f"{column.name}: {wrong.size} of {used.size} rows contradict the motion by more than {LARGE:g} times their error "
                f"of {result_text(column_fit.error, 2)} {column.unit}: {result_text(float(residuals.max()), 3)} "
                f"{column.unit} at most{part}, "
                f"{location}; "
                f"{fit.table.lines_text(wrong.tolist())}"
            )


def _roles(fit: MotionFit, *columns: MeasuredColumn) -> str:
    """Role of two columns that contradict each other: trusted, or compared only."""
    return ", ".join(
        f"{column.name} is {'compared only' if column.order in fit.compared else 'trusted'}" for column in columns
    )


def wrong_row_lines(fit: MotionFit) -> list[str]:
    """A line for each wrong row, the largest residual first."""
    return [row_line(fit, i) for i in wrong_rows(fit)]


def wrong_rows(fit: MotionFit) -> list[int]:
    """Wrong rows, the largest residual first."""
    return sorted(fit.outliers.wrong, key=lambda i: -abs(fit.residuals[i]))


def row_line(fit: MotionFit, row: int) -> str:
    """A row with its residual: ``line 57 (54.5 deg): 12.34 mm, 4.98 mm from the curve``."""
    table = fit.table
    location = f"line {table.lines[row]} ({result_text(float(table.angles[row]))} deg)"
    value = result_text(float(table.values[row] / table.size))
    return f"{location}: {value} {table.unit}, {result_text(float(fit.residuals[row]))} {table.unit} from the curve"


def segment_rows(fit: MotionFit, segment: SegmentFit) -> np.ndarray:
    """Rows between the ends of a segment, in its order.

    Returns
    -------
    ndarray (k,), dimensionless
        Indices of the rows.
    """
    offset = np.mod(fit.table.angles - segment.start_deg + 1e-9, 360.0)
    inside = np.flatnonzero(offset <= segment.span_deg + 2e-9)
    return inside[np.argsort(offset[inside], kind="stable")]


def segment_residuals(fit: MotionFit, segment: SegmentFit) -> tuple[float, float]:
    """Largest residual of a segment's rows, and their root mean square, in the unit of the motion's column."""
    rows = np.setdiff1d(segment_rows(fit, segment), fit.left_out)
    residuals = np.abs(fit.residuals[rows])
    return (float(residuals.max()), sqrt(float(np.mean(residuals**2)))) if rows.size else (0.0, 0.0)


def split_at_zero(segments: Sequence[SegmentFit]) -> list[SegmentFit]:
    """Segments of the motion from cam angle 0 on: a dwell that passes it becomes two."""
    result: list[SegmentFit] = []
    for segment in segments:
        before = difference(360.0, segment.start_deg)
        if segment.law == DWELL and 1e-9 < before < segment.span_deg - 1e-9 and segment.span_deg < 360.0:
            second = replace(segment, start_deg=0.0, span_deg=difference(segment.span_deg, before))
            result = [second, *result, replace(segment, span_deg=before)]
        else:
            result.append(segment)
    return result


def segment_lines(fit: MotionFit, segments: Sequence[SegmentFit]) -> list[str]:
    """A line for each segment: ``lines 36-77 (35 ... 76.5 deg) are modified-sine within 0.4 um: -150 mm``."""
    texts = []
    for segment in segments:
        rows, (largest, _) = segment_rows(fit, segment), segment_residuals(fit, segment)
        lines = f"lines {fit.table.lines[rows[0]]}-{fit.table.lines[rows[-1]]}" if rows.size else "no line"
        location = f"{result_text(segment.start_deg)} ... {result_text(segment.start_deg + segment.span_deg)} deg"
        rise = "" if segment.law == "dwell" else f": {result_text(segment.rise)} {fit.motion.unit}"
        alternatives = f"; {', '.join(segment.ambiguous)} fit equally well, none is chosen" if segment.ambiguous else ""
        texts.append(
            f"{lines} ({location}) are {segment.law} within {result_text(largest, 2)} {fit.table.unit}{rise}{alternatives}"
        )
    return texts


def event_lines(fit: MotionFit, listed: Sequence[Event]) -> list[str]:
    """Lines for each event: ``110 ... 250 deg, 140 deg off the base circle, lift 9.4 mm``, durations at lifts, ramps."""
    unit, lines = fit.motion.unit, []
    for event in listed:
        location = f"{result_text(event.start)} ... {result_text(event.end)} deg"
        lines.append(
            f"{location}: {result_text(event.end - event.start)} deg off the base circle, lift {result_text(event.lift)} {unit}"
        )
        for at in event.durations:
            location = f"{result_text(at.start)} ... {result_text(at.end)} deg"
            lines.append(
                f"at {result_text(at.lift)} {unit} lift{IN_INCHES.get(at.lift, '')}: {result_text(at.end - at.start)} deg, {location}"
            )
        for ramp in event.ramps:
            location = f"{result_text(ramp.start)} ... {result_text(ramp.end)} deg"
            lines.append(f"ramp {location}: {result_text(ramp.velocity, 3)} {unit}/deg")
    return lines


def _event_data(event: Event, unit: str) -> dict[str, Any]:
    return {
        "start_deg": event.start,
        "end_deg": event.end,
        f"lift_{unit}": event.lift,
        "durations": [
            {f"lift_{unit}": at.lift, "start_deg": at.start, "end_deg": at.end, "duration_deg": at.end - at.start}
            for at in event.durations
        ],
        "ramps": [
            {"start_deg": ramp.start, "end_deg": ramp.end, f"{unit}_per_deg": ramp.velocity} for ramp in event.ramps
        ],
    }


def reading_rows(sheet: Worksheet, fit: MotionFit) -> list[tuple[str, str]]:
    """How the file was read: name and value."""
    layout = fit.table.layout
    headers = {0: "no header", 1: "1 header line"}.get(sheet.header, f"{sheet.header} header lines")
    return [
        ("rows", f"{len(sheet.rows)}, {headers}, {sheet.encoding}"),
        ("delimiter", f"{sheet.delimiter}, decimal {sheet.decimal}"),
        ("cam angle", f"{column_name(sheet, layout.angle_column)}, in {layout.angle_unit}"),
        (layout.quantity, f"{column_name(sheet, layout.value_column)}, in {layout.unit.name}"),
    ]


def fit_figures(fit: MotionFit) -> list[tuple[str, str]]:
    """Figures of the fit: name, value with unit."""
    unit, motion_unit = fit.table.unit, fit.motion.unit
    power = 5 - 2 * fit.table.layout.order
    is_exact = float(np.abs(fit.residuals).max()) <= EXACT * float(np.abs(fit.table.values / fit.table.size).max())
    return [
        ("measuring error", f"{result_text(fit.error)} {unit}"),
        ("rms residual", f"{result_text(0.0 if is_exact else fit.rms)} {unit}"),
        ("largest residual", "none; the curve interpolates all rows" if is_exact else row_line(fit, fit.largest)),
        *_column_figures(fit),
        ("points", f"{len(fit.points)} of {len(fit.residuals)} rows, {result_text(fit.freedom, 3)} free values"),
        (
            "smoothing",
            f"{result_text(fit.smoothing)} deg{'' if power == 1 else f'^{power}'}" if fit.smoothing else "none",
        ),
        ("stroke", f"{result_text(fit.stroke)} {motion_unit}, from {result_text(fit.lowest)} {motion_unit}"),
    ]


def _column_figures(fit: MotionFit) -> Iterator[tuple[str, str]]:
    for column_fit in fit.columns[1:]:
        largest = float(np.nanmax(np.abs(column_fit.residuals), initial=0.0))
        size = float(np.nanmax(np.abs(column_fit.column.values), initial=0.0)) / abs(column_fit.column.size)
        value = f"rms {result_text(column_fit.rms)}, largest {result_text(largest)} {column_fit.column.unit}"
        yield f"residual of {column_fit.column.quantity}", "none" if largest <= NEGLIGIBLE * size else value


def fit_text(sheet: Worksheet, fit: MotionFit, lifts: Sequence[float] = ()) -> str:
    """Table and fit as text; ``lifts``: where the durations of events are stated, empty: the default lifts."""
    lines = [sheet.name, *columns(_padded(reading_rows(sheet, fit)), left=2), ""]
    lines += columns(_padded(fit_figures(fit)), left=2)
    parts = (
        ("Segments", segment_lines(fit, split_at_zero(fit.segments))),
        ("Events", event_lines(fit, events(fit, lifts))),
        ("Notes", notes(fit)),
        ("Wrong rows", wrong_row_lines(fit)),
    )
    for heading, entries in parts:
        if entries:
            lines += ["", heading, *(f"  {line}" for line in entries[:MOST_LINES])]
            lines += [f"  and {len(entries) - MOST_LINES} more"] if len(entries) > MOST_LINES else []
    return "\n".join(lines) + "\n"


def _segment_data(fit: MotionFit, segment: SegmentFit) -> dict[str, Any]:
    rows, (largest, rms) = segment_rows(fit, segment), segment_residuals(fit, segment)
    return {
        "law": segment.law,
        "start_deg": segment.start_deg,
        "span_deg": segment.span_deg,
        "rise": segment.rise,
        "fit": {"max": largest, "rms": rms},
        "rows": [int(fit.table.lines[rows[0]]), int(fit.table.lines[rows[-1]])] if rows.size else [],
        **({"fits_as_well": list(segment.ambiguous)} if segment.ambiguous else {}),
    }


def _padded(rows: list[tuple[str, str]]) -> list[tuple[str, str]]:
    return [(f"  {name}", value) for name, value in rows]


def fit_data(sheet: Worksheet, fit: MotionFit, lifts: Sequence[float] = ()) -> dict[str, Any]:
    """Table and fit as data; every residual with its line."""
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
            "error_guessed": fit.is_guessed,
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
        "columns": [
            {
                "quantity": column_fit.column.quantity,
                "name": column_fit.column.name,
                "unit": column_fit.column.unit,
                "error": column_fit.error,
                "error_guessed": column_fit.is_guessed,
                "compared_only": column_fit.column.order in fit.compared,
                "rms_residual": column_fit.rms,
                "largest_residual": {
                    "line": int(table.lines[column_fit.largest]),
                    "value": float(column_fit.residuals[column_fit.largest]),
                },
            }
            for column_fit in fit.columns
        ],
        "segments": [_segment_data(fit, segment) for segment in split_at_zero(fit.segments)],
        "events": [_event_data(event, fit.motion.unit) for event in events(fit, lifts)],
        "velocity_jumps": [
            {"cam_angle_deg": jump.angle, "before": jump.before, "after": jump.after} for jump in velocity_jumps(fit)
        ],
        "jumps": [{"cam_angle_deg": jump.angle, "before": jump.before, "after": jump.after} for jump in fit.jumps],
        "notes": list(notes(fit)),
        "spoiled": [
            {
                "line": int(table.lines[row]),
                "column": column_fit.column.name,
                "value": float(column_fit.column.values[row] / column_fit.column.size),
                "expected": float(fit.curve(table.angles[[row]], i)[0]),
            }
            for i, column_fit in enumerate(fit.columns)
            for row in fit.spoiled.get(column_fit.column.order, ())
        ],
        "left_out": [int(table.lines[i]) for i in fit.left_out],
        "undecided": [int(table.lines[i]) for stretch in fit.outliers.undecided for i in stretch],
        "readings": [[int(table.lines[i]) for i in reading] for reading in fit.outliers.readings],
        "possible": [int(table.lines[i]) for i in fit.outliers.possible],
        "suspects": [int(table.lines[i]) for i in fit.outliers.wrong],
        "residuals": [
            {"line": int(n), "cam_angle_deg": float(a), "value": float(v / table.size), "residual": float(r)}
            for n, a, v, r in zip(table.lines, table.angles, table.values, fit.residuals, strict=True)
        ],
    }
