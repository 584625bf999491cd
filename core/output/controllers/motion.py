"""A controller's table as a motion: pieces as polynomial segments, pairs as a table."""

from __future__ import annotations

from math import fsum
from typing import Any

import numpy as np

from core.design import (
    Motion,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplinePoint,
    TableCurve,
    require_motion,
    with_motion,
)
from core.design.design import Design
from core.design.motion_edits import without_marks
from core.errors import KindynaError
from core.frozen import frozen
from core.number_text import result_text
from core.output.controllers.layout import FileTable, read_file
from core.output.controllers.rows import KINDS, Controller, Table, evaluate
from core.output.controllers.slave import TURN
from core.output.controllers.table import table_from_file

POLYNOMIALS = frozenset({"quintic-hermite", "cubic-hermite", "zebra"})
"""Interpolations whose pieces are determined by the states at their ends; the others interpolate values only."""


@frozen
class ControllerMotion:
    """A motion from a controller's table, with the interpolation between its rows."""

    controller: Controller
    interpolation: str
    rows: int
    motion: Motion


def read_motion(row: Controller, data: bytes, interpolation: str | None = None, unit: str = "mm") -> ControllerMotion:
    """The motion of a file, one turn of its master being 360°. Raises KindynaError where it is none, or does not start at 0."""
    contents = read_file(row, data)
    words = {word: name for name, word in row.words.items()}
    if contents.word and contents.word not in words:
        raise KindynaError(f"{row.slug}: interpolation {contents.word}: unknown; allowed: {' | '.join(words)}")
    kind = row.select_interpolation(interpolation or words.get(contents.word))
    if kind == "zebra" and contents.slave.size % 2:
        raise KindynaError(f"{row.slug}: {contents.slave.size} rows; allowed: an even number, segments in pairs")
    per_turn = _turn(row, contents)
    table = table_from_file(row, contents, per_turn)
    if abs(table.x[0]) > 1e-9 or abs(table.x[-1] - TURN) > 1e-6:
        raise KindynaError(
            f"{row.slug}: the master runs from {result_text(table.x[0], 6)} to {result_text(table.x[-1], 6)} deg; allowed: from 0, one turn"
        )
    gain = float(table.states[0, -1] - table.states[0, 0])
    gain = gain if abs(gain) > 1e-9 else 0.0
    segments = _polynomials(kind, table, gain) if kind in POLYNOMIALS else _pairs(table, kind, gain)
    return ControllerMotion(
        row, kind, contents.slave.size, Motion(float(table.states[0, 0]), segments, unit, gain or None)
    )


def _turn(row: Controller, contents: FileTable) -> float:
    """Master units in a turn: as the file states, or the range of its rows where both ends of the turn have one."""
    if contents.range is not None and (row.has_both_ends or "master" not in row.columns):
        return contents.range[1] - contents.range[0]
    return TURN


def _polynomials(kind: str, table: Table, gain: float) -> tuple[Segment, ...]:
    h, coefficients = np.diff(table.x), KINDS[kind].coefficients(table)
    starts, ends = evaluate(coefficients, np.zeros(h.size)), evaluate(coefficients, h)
    rises = np.diff(table.states[0])
    segments = []
    for span, rise, a, b in zip(
        _closing(h, TURN), _closing(rises, gain), starts.T.tolist(), ends.T.tolist(), strict=True
    ):
        segments.append(Segment(span, rise, PolynomialCurve(PolynomialEnd(a[1], a[2]), PolynomialEnd(b[1], b[2]))))
    return tuple(segments)


def _closing(values: np.ndarray, total: float) -> list[float]:
    """Values corrected to the exact total, where they differ from it by rounding."""
    result: list[float] = values.tolist()
    missing = fsum([total, *(-value for value in result)])
    if abs(missing) <= 1e-9:
        result[int(np.argmax(values))] += missing
    return result


def _pairs(table: Table, kind: str, rise: float) -> tuple[Segment, ...]:
    values = table.states[0] - table.states[0, 0]
    values[-1] = rise
    slopes: list[Any] = [None] * values.size
    if kind == "clamped-spline":
        slopes[0], slopes[-1] = table.slopes
    points = [SplinePoint(at, value, v) for at, value, v in zip(table.x.tolist(), values.tolist(), slopes, strict=True)]
    points[0], points[-1] = SplinePoint(0.0, 0.0, slopes[0]), SplinePoint(TURN, rise, slopes[-1])
    return (Segment(TURN, rise, TableCurve(tuple(points))),)


def with_controller_motion(design: Design, source: ControllerMotion) -> Design:
    """The design with this motion."""
    require_motion(design)
    return without_marks(with_motion(design, source.motion))


def motion_facts(source: ControllerMotion) -> dict[str, Any]:
    """Facts about the motion for ``measured --controller --json``."""
    starts = np.concatenate(([0.0], np.cumsum([segment.span_deg for segment in source.motion.segments])))
    return {
        "controller": source.controller.slug,
        "interpolation": source.interpolation,
        "rows": source.rows,
        "start": source.motion.start,
        "segments": [
            {"law": segment.curve.law, "start_deg": start, "span_deg": segment.span_deg, "rise": segment.rise}
            for start, segment in zip(starts.tolist(), source.motion.segments, strict=False)
        ],
        "open": list(source.controller.open),
    }


def motion_text(source: ControllerMotion) -> str:
    """Facts about the motion for the terminal."""
    count, law = len(source.motion.segments), source.motion.segments[0].curve.law
    lines = [
        f"{source.rows} rows of {source.controller.label}, {source.interpolation}: {count} segment{'s' * (count > 1)} {law}"
    ]
    return "\n".join([*lines, *(f"open: {text}" for text in source.controller.open)]) + "\n"
