"""A controller's table as a motion: its pieces as polynomial segments joined as the controller joins them, pairs as a table."""

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
from core.output.controllers.layout import FileTable, read
from core.output.controllers.rows import KINDS, Controller, Table, evaluated
from core.output.controllers.slave import TURN
from core.output.controllers.table import read_back

POLYNOMIALS = frozenset({"quintic-hermite", "cubic-hermite", "zebra"})
"""Interpolations whose pieces are quintics at most, each by what it does at its ends; others run through values alone."""


@frozen
class ReadMotion:
    """A controller's table, and the motion that it is; interpolation: what the controller runs between its rows."""

    controller: Controller
    interpolation: str
    rows: int
    motion: Motion


def motion_of(row: Controller, data: bytes, interpolation: str | None = None, unit: str = "mm") -> ReadMotion:
    """The motion of a file, a turn of its master being 360°. Raises KindynaError where it is none, or does not begin at 0."""
    found = read(row, data)
    words = {word: name for name, word in row.words.items()}
    if found.word and found.word not in words:
        raise KindynaError(f"{row.slug}: {found.word} between its rows; allowed: {' | '.join(words)}")
    kind = row.chosen(interpolation or words.get(found.word))
    if kind == "zebra" and found.slave.size % 2:
        raise KindynaError(f"{row.slug}: {found.slave.size} rows; allowed: an even number, segments in pairs")
    per_turn = _turn(row, found)
    table = read_back(row, found, per_turn)
    if abs(table.x[0]) > 1e-9 or abs(table.x[-1] - TURN) > 1e-6:
        raise KindynaError(
            f"{row.slug}: the master runs from {table.x[0]:.9g} to {table.x[-1]:.9g} deg; allowed: from 0, one turn"
        )
    gain = float(table.states[0, -1] - table.states[0, 0])
    gain = gain if abs(gain) > 1e-9 else 0.0
    segments = _polynomials(kind, table, gain) if kind in POLYNOMIALS else _pairs(table, kind, gain)
    return ReadMotion(row, kind, found.slave.size, Motion(float(table.states[0, 0]), segments, unit, gain or None))


def _turn(row: Controller, found: FileTable) -> float:
    """Units of the master in a turn: as the file says, or as far as its rows go where both ends of the turn have one."""
    if found.range is not None and (row.closing or "master" not in row.columns):
        return found.range[1] - found.range[0]
    return TURN


def _polynomials(kind: str, table: Table, gain: float) -> tuple[Segment, ...]:
    h, coefficients = np.diff(table.x), KINDS[kind].coefficients(table)
    starts, ends = evaluated(coefficients, np.zeros(h.size)), evaluated(coefficients, h)
    rises = np.diff(table.states[0])
    made = []
    for span, rise, a, b in zip(
        _closing(h, TURN), _closing(rises, gain), starts.T.tolist(), ends.T.tolist(), strict=True
    ):
        made.append(Segment(span, rise, PolynomialCurve(PolynomialEnd(a[1], a[2]), PolynomialEnd(b[1], b[2]))))
    return tuple(made)


def _closing(values: np.ndarray, total: float) -> list[float]:
    """Values whose sum is exactly this, where rounding alone keeps it from being so."""
    made: list[float] = values.tolist()
    missing = fsum([total, *(-value for value in made)])
    if abs(missing) <= 1e-9:
        made[int(np.argmax(values))] += missing
    return made


def _pairs(table: Table, kind: str, rise: float) -> tuple[Segment, ...]:
    values = table.states[0] - table.states[0, 0]
    values[-1] = rise
    slopes: list[Any] = [None] * values.size
    if kind == "clamped-spline":
        slopes[0], slopes[-1] = table.slopes
    points = [SplinePoint(at, value, v) for at, value, v in zip(table.x.tolist(), values.tolist(), slopes, strict=True)]
    points[0], points[-1] = SplinePoint(0.0, 0.0, slopes[0]), SplinePoint(TURN, rise, slopes[-1])
    return (Segment(TURN, rise, TableCurve(tuple(points))),)


def put_into(design: Design, found: ReadMotion) -> Design:
    """The design with this motion."""
    require_motion(design)
    return without_marks(with_motion(design, found.motion))


def motion_facts(found: ReadMotion) -> dict[str, Any]:
    """As ``measured --controller --json`` prints them."""
    begins = np.concatenate(([0.0], np.cumsum([each.span_deg for each in found.motion.segments])))
    return {
        "controller": found.controller.slug,
        "interpolation": found.interpolation,
        "rows": found.rows,
        "start": found.motion.start,
        "segments": [
            {"law": each.curve.law, "start_deg": begin, "span_deg": each.span_deg, "rise": each.rise}
            for begin, each in zip(begins.tolist(), found.motion.segments, strict=False)
        ],
        "open": list(found.controller.open),
    }


def motion_text(found: ReadMotion) -> str:
    """The same for the terminal."""
    count, law = len(found.motion.segments), found.motion.segments[0].curve.law
    lines = [
        f"{found.rows} rows of {found.controller.label}, {found.interpolation}: {count} segment{'s' * (count > 1)} {law}"
    ]
    return "\n".join([*lines, *(f"open: {each}" for each in found.controller.open)]) + "\n"


__all__ = ["ReadMotion", "motion_facts", "motion_of", "motion_text", "put_into"]
