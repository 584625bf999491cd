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
from core.measured.structure import DWELL, difference
from core.output.lines import columns

PLURALS = {"displacement": "displacements", "velocity": "velocities", "acceleration": "accelerations"}
LARGE = 5.0  # measuring errors
NEXT_TO_NOTHING = 1e-9  # of a column's size
WAVES, LEAST_WAVES = 1.0, 12  # of ``MotionFit.waves``, which is 2 at random; rows that it takes to judge
IN_INCHES = {1.27: " (0.05 in)"}
MOST_LINES = 30  # of wrong rows before the rest is counted only


def digits(value: float, most: int = 6) -> str:
    """So many significant digits, without needless zeros."""
    return f"{value + 0.0:.{most}g}"


def notes(fit: MotionFit) -> tuple[str, ...]:
    """What was found in the table, what was guessed, and what the fit made of it; a sentence each."""
    return (*fit.table.layout.guesses, *fit.table.notes, *_of_the_fit(fit))


def _of_the_fit(fit: MotionFit) -> Iterator[str]:
    table, unit = fit.table, fit.table.unit
    if fit.is_guessed:
        yield f"the measuring error is not stated; {digits(fit.error, 2)} {unit} is what the rows themselves tell"
    for gap in fit.gaps:
        what = "the spline bridges the gap" if gap.level is None else "the rows at both ends are level: a dwell"
        yield f"no rows from {digits(gap.start)} to {digits(float(np.mod(gap.end, 360.0)) or 360.0)} deg; {what}"
    result, left_out = fit.outliers, "left out of the fit" if fit.left_out else "fitted with the others"
    if result.wrong:
        yield f"{table.lines_text(result.wrong)}: wrong, no smooth curve joins them to the rows beside; {left_out}"
    for each in fit.columns[1:]:
        if wrong := fit.spoiled.get(each.column.order, ()):
            rows = table.lines_text(wrong)
            yield f"{each.column.name}: {rows}: wrong, no smooth curve joins them to those beside; these cells are left out"
    if result.possible:
        yield f"{table.lines_text(result.possible)}: beside wrong rows, they may be wrong too, nothing tells; {left_out}"
    if result.undecided:
        yield f"{contradiction(table, result)}; {left_out}"
    if table.closing is not None:
        last, first = table.closing
        apart = (table.values[last] - table.values[first]) / table.size
        if abs(apart) > LARGE * sqrt(2.0) * fit.error:
            yield f"the table does not close: a turn later, line {table.lines[last]} is {digits(apart, 4)} {unit} off"
    if fit.error and fit.rms > 1.001 * fit.error and not fit.segments:
        why = f"{MOST} points" if len(fit.points) >= MOST else "rows that repeat a cam angle"
        yield f"{why} leave {digits(fit.rms, 4)} {unit}, more than the measuring error"
    if fit.error == 0.0 and fit.smoothing and not fit.segments:
        yield f"more rows than {MOST} points can go through; the curve is the nearest one"
    if fit.waves < WAVES and fit.error and not fit.segments and fit.residuals.size >= LEAST_WAVES:
        yield "residuals beside each other are alike: the curve leaves out some of the motion; a smaller error would keep it"
    yield from _of_the_columns(fit)
    for jump in fit.jumps:
        by = f"{table.motion_unit}/deg2"
        yield f"the acceleration jumps at {digits(jump.angle)} deg, from {digits(jump.before, 4)} to {digits(jump.after, 4)} {by}"
    for step in velocity_jumps(fit):
        by = f"{table.motion_unit}/deg"
        yield f"the velocity jumps at {digits(step.angle)} deg, from {digits(step.before, 4)} to {digits(step.after, 4)} {by}"
    order, motion_unit = table.layout.order, fit.motion.unit
    if order:
        stands = f"its lowest position is {digits(fit.lowest)} {motion_unit}"
        yield f"a table of {PLURALS[table.layout.quantity]} does not tell where the follower stands; {stands}"
        if abs(fit.offset) > EXACT * float(np.ptp(table.values)) / abs(table.size):
            gained = f"{digits(fit.offset * table.size * 360.0, 4)} {motion_unit}{'' if order == 1 else '/deg'}"
            taken = f"{digits(fit.offset, 4)} {unit} is taken off every row"
            yield f"over a turn the table gains {gained}, which no cam can; {taken}"


def _of_the_columns(fit: MotionFit) -> Iterator[str]:
    """A sentence for each column that the motion misses by more than its error."""
    by_order = {each.column.order: each.column for each in fit.columns}
    for gap in fit.contradicted:
        own, before = by_order[gap.order], by_order[gap.order - 1]
        rows = np.flatnonzero(np.isin(np.round(fit.table.angles, 6), np.round(gap.angles, 6)))
        yield (
            f"{own.name} contradicts {before.name}: in the whole it is {digits(gap.factor, 4)} times its derivative, and {rows.size} rows "
            f"are off by more than their errors, {fit.table.lines_text(rows.tolist())}; {_trusted(fit, before, own)}: "
            f"correct the unit or the speed, or say which to trust"
        )
    if fit.table.layout.trusted and fit.compared:
        names = ", ".join(by_order[order].name for order in fit.compared)
        yield f"the motion is made of {', '.join(fit.table.layout.trusted)}, as chosen; compared only: {names}"
    for each in fit.columns:
        if each.column.order in fit.compared:
            continue
        used = fit.table.used_rows((*fit.left_out, *fit.spoiled.get(each.column.order, ())))
        size = float(np.nanmax(np.abs(each.column.values), initial=0.0)) / abs(each.column.size)
        allowed = max(each.error, 10.0**-each.column.decimals / sqrt(12.0), NEXT_TO_NOTHING * size)
        left = np.abs(np.nan_to_num(each.residuals[used]))
        far = used[left > LARGE * allowed]
        if far.size:
            worst = int(used[np.argmax(left)])
            part = f", {digits(100.0 * float(left.max()) / size, 2)} % of its largest" if size else ""
            there = f"line {fit.table.lines[worst]} ({digits(float(fit.table.angles[worst]))} deg)"
            yield (
                f"{each.column.name}: {far.size} of {used.size} rows contradict the motion by more than {LARGE:g} times their error of "
                f"{digits(each.error, 2)} {each.column.unit}: {digits(float(left.max()), 3)} {each.column.unit} at most{part}, {there}; "
                f"{fit.table.lines_text(far.tolist())}"
            )


def _trusted(fit: MotionFit, *columns: MeasuredColumn) -> str:
    """Which of two columns that contradict each other make the motion."""
    return ", ".join(
        f"{each.name} is {'compared only' if each.order in fit.compared else 'trusted'}" for each in columns
    )


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


def rows_of(fit: MotionFit, segment: SegmentFit) -> np.ndarray:
    """The rows between the ends of a segment, in its order."""
    along = np.mod(fit.table.angles - segment.start_deg + 1e-9, 360.0)
    inside = np.flatnonzero(along <= segment.span_deg + 2e-9)
    return inside[np.argsort(along[inside], kind="stable")]


def segment_fit(fit: MotionFit, segment: SegmentFit) -> tuple[float, float]:
    """The largest residual of its rows, and their root mean square, in the unit of the motion's column."""
    rows = np.setdiff1d(rows_of(fit, segment), fit.left_out)
    left = np.abs(fit.residuals[rows])
    return (float(left.max()), sqrt(float(np.mean(left**2)))) if rows.size else (0.0, 0.0)


def from_zero(segments: Sequence[SegmentFit]) -> list[SegmentFit]:
    """The segments as the motion has them, from cam angle 0 on: a dwell that passes it is two."""
    told: list[SegmentFit] = []
    for each in segments:
        before = difference(360.0, each.start_deg)
        if each.law == DWELL and 1e-9 < before < each.span_deg - 1e-9 and each.span_deg < 360.0:
            behind = replace(each, start_deg=0.0, span_deg=difference(each.span_deg, before))
            told = [behind, *told, replace(each, span_deg=before)]
        else:
            told.append(each)
    return told


def segment_lines(fit: MotionFit, segments: Sequence[SegmentFit]) -> list[str]:
    """A line for each segment: ``lines 36-77 (35 ... 76.5 deg) are modified-sine within 0.4 um: -150 mm``."""
    found = []
    for segment in segments:
        rows, (most, _) = rows_of(fit, segment), segment_fit(fit, segment)
        lines = f"lines {fit.table.lines[rows[0]]}-{fit.table.lines[rows[-1]]}" if rows.size else "no line"
        where = f"{digits(segment.start_deg)} ... {digits(segment.start_deg + segment.span_deg)} deg"
        rise = "" if segment.law == "dwell" else f": {digits(segment.rise)} {fit.motion.unit}"
        several = (
            f"; {', '.join(segment.ambiguous)} fit as well as each other, none is taken" if segment.ambiguous else ""
        )
        found.append(f"{lines} ({where}) are {segment.law} within {digits(most, 2)} {fit.table.unit}{rise}{several}")
    return found


def event_lines(fit: MotionFit, found: Sequence[Event]) -> list[str]:
    """Lines for each event: ``110 ... 250 deg, 140 deg off the base circle, lift 9.4 mm``, its durations at stated lifts, its ramps."""
    unit, lines = fit.motion.unit, []
    for each in found:
        where = f"{digits(each.start)} ... {digits(each.end)} deg"
        lines.append(
            f"{where}: {digits(each.end - each.start)} deg off the base circle, lift {digits(each.lift)} {unit}"
        )
        for at in each.durations:
            where = f"{digits(at.start)} ... {digits(at.end)} deg"
            lines.append(
                f"at {digits(at.lift)} {unit} lift{IN_INCHES.get(at.lift, '')}: {digits(at.end - at.start)} deg, {where}"
            )
        for ramp in each.ramps:
            where = f"{digits(ramp.start, 4)} ... {digits(ramp.end, 4)} deg"
            lines.append(f"ramp {where}: {digits(ramp.velocity, 3)} {unit}/deg")
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
        *_of_other_columns(fit),
        ("points", f"{len(fit.points)} of {len(fit.residuals)} rows, free to choose {digits(fit.freedom, 3)} values"),
        (
            "smoothing",
            f"{digits(fit.smoothing, 4)} deg{'' if power == 1 else f'^{power}'}" if fit.smoothing else "none",
        ),
        ("stroke", f"{digits(fit.stroke)} {motion_unit}, from {digits(fit.lowest)} {motion_unit} on"),
    ]


def _of_other_columns(fit: MotionFit) -> Iterator[tuple[str, str]]:
    for each in fit.columns[1:]:
        largest = float(np.nanmax(np.abs(each.residuals), initial=0.0))
        size = float(np.nanmax(np.abs(each.column.values), initial=0.0)) / abs(each.column.size)
        value = f"rms {digits(each.rms, 4)}, largest {digits(largest, 4)} {each.column.unit}"
        yield f"residual of {each.column.quantity}", "none" if largest <= NEXT_TO_NOTHING * size else value


def fit_text(sheet: Worksheet, fit: MotionFit, lifts: Sequence[float] = ()) -> str:
    """All of it to read; lifts: where the durations of events are stated, the usual ones where there are none."""
    lines = [sheet.name, *columns(_padded(detected(sheet, fit)), left=2), ""]
    lines += columns(_padded(figures(fit)), left=2)
    parts = (
        ("Segments", segment_lines(fit, from_zero(fit.segments))),
        ("Events", event_lines(fit, events(fit, lifts))),
        ("Notes", notes(fit)),
        ("Wrong rows", suspicions(fit)),
    )
    for heading, entries in parts:
        if entries:
            lines += ["", heading, *(f"  {line}" for line in entries[:MOST_LINES])]
            lines += [f"  and {len(entries) - MOST_LINES} more"] if len(entries) > MOST_LINES else []
    return "\n".join(lines) + "\n"


def _segment_data(fit: MotionFit, segment: SegmentFit) -> dict[str, Any]:
    rows, (most, rms) = rows_of(fit, segment), segment_fit(fit, segment)
    return {
        "law": segment.law,
        "start_deg": segment.start_deg,
        "span_deg": segment.span_deg,
        "rise": segment.rise,
        "fit": {"max": most, "rms": rms},
        "rows": [int(fit.table.lines[rows[0]]), int(fit.table.lines[rows[-1]])] if rows.size else [],
        **({"fits_as_well": list(segment.ambiguous)} if segment.ambiguous else {}),
    }


def _padded(rows: list[tuple[str, str]]) -> list[tuple[str, str]]:
    return [(f"  {name}", value) for name, value in rows]


def fit_data(sheet: Worksheet, fit: MotionFit, lifts: Sequence[float] = ()) -> dict[str, Any]:
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
                "quantity": each.column.quantity,
                "name": each.column.name,
                "unit": each.column.unit,
                "error": each.error,
                "error_guessed": each.is_guessed,
                "compared_only": each.column.order in fit.compared,
                "rms_residual": each.rms,
                "largest_residual": {
                    "line": int(table.lines[each.largest]),
                    "value": float(each.residuals[each.largest]),
                },
            }
            for each in fit.columns
        ],
        "segments": [_segment_data(fit, each) for each in from_zero(fit.segments)],
        "events": [_event_data(each, fit.motion.unit) for each in events(fit, lifts)],
        "velocity_jumps": [
            {"cam_angle_deg": each.angle, "before": each.before, "after": each.after} for each in velocity_jumps(fit)
        ],
        "jumps": [{"cam_angle_deg": each.angle, "before": each.before, "after": each.after} for each in fit.jumps],
        "notes": list(notes(fit)),
        "spoiled": [
            {
                "line": int(table.lines[row]),
                "column": each.column.name,
                "value": float(each.column.values[row] / each.column.size),
                "expected": float(fit.curve(table.angles[[row]], i)[0]),
            }
            for i, each in enumerate(fit.columns)
            for row in fit.spoiled.get(each.column.order, ())
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
