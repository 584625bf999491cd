"""What a plot of curves stands on: paper with grid and segments, axes and their ticks."""

from __future__ import annotations

from collections.abc import Sequence

import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainterPath

from core.design import Motion
from core.frozen import frozen
from core.laws import named_law
from kindyna_gui.pictures.items import Outline, text_size
from kindyna_gui.pictures.plots.axis import Axis
from kindyna_gui.pictures.plots.frame import (
    BOTTOM_HEIGHT,
    LEFT_WIDTH,
    TOP_HEIGHT,
    Z_BANDS,
    Z_CURSOR,
    Z_CURVE,
    Z_GRID,
    Z_REFERENCE,
    Z_ZERO,
    Frame,
)
from kindyna_gui.pictures.plots.lines import LimitLine
from kindyna_gui.pictures.style import THIN, Theme, brush
from kindyna_gui.pictures.units import decimals_of, number, ticks
from kindyna_gui.preferences.units import sized

ANGLE_STEPS = (30, 60, 90, 180)  # between ticks of the cam angle, deg
LEAST_ANGLE_PIXELS, LEAST_VALUE_PIXELS, LEAST_ACROSS = 38.0, 26.0, 46.0  # between ticks; of numbers along the bottom
NAME_ROOM = 4.0  # between a segment's name and its ends, pixels


@frozen
class Span:
    """One segment of the motion: where it starts and ends [deg], its law's name, and that in short."""

    start: float
    end: float
    name: str
    short: str = ""


def spans(motion: Motion | None) -> list[Span]:
    """The segments of a motion in order; none without one."""
    made, at = [], 0.0
    for segment in motion.segments if motion is not None else ():
        law = named_law(segment.curve.law)
        made.append(Span(at, at + segment.span_deg, law.label, law.short_name))
        at += segment.span_deg
    return made


def angle_step(width: float) -> int:
    """Degrees between ticks of a whole turn on so many pixels."""
    return next((s for s in ANGLE_STEPS if width * s / 360.0 >= sized(LEAST_ANGLE_PIXELS)), ANGLE_STEPS[-1])


def angle_ticks(width: float) -> list[tuple[float, str]]:
    """Places of a whole turn [deg] and their texts, as many as the width [pixels] has room for."""
    return [(float(d), str(d)) for d in range(0, 361, angle_step(width))]


def value_ticks(low: float, high: float, pixels: float, least: float = LEAST_VALUE_PIXELS) -> list[tuple[float, str]]:
    """Round numbers, at least so many pixels from each other where two have room."""
    values, step = ticks(low, high, max(2, int(pixels / sized(least))))
    return [(value, number(value, decimals_of(step))) for value in values]


def name_ticks(segments: Sequence[Span], width: float) -> list[tuple[float, str]]:
    """The names of the segments, in short where they are too narrow on paper, none where even that is too long."""
    rows = []
    for span in segments:
        room = (span.end - span.start) / 360.0 * width
        fitting = (name for name in (span.name, span.short) if name and text_size(name)[0] + NAME_ROOM <= room)
        rows += [((span.start + span.end) / 2.0, name) for name in [next(fitting, "")] if name]
    return rows


class Paper:
    """Grid, zero line and shaded segments, each one static item of the view box."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        self._bands = Outline(QPainterPath(), None, brush(theme.band))
        self._grid = Outline(QPainterPath(), theme.pen(theme.faint, THIN))
        self._zero = Outline(QPainterPath(), theme.pen(theme.quiet, THIN))
        self._zero.setOpacity(0.6)
        rows = ((self._bands, Z_BANDS), (self._grid, Z_GRID), (self._zero, Z_ZERO))
        for item, z in rows:
            item.setZValue(z)
            view.addItem(item, ignoreBounds=True)

    def draw(self, segments: Sequence[Span], across: Sequence[float], values: Sequence[float], frame: Frame) -> None:
        """frame: what the axes show."""
        low, high = frame.low, frame.high
        bands, grid, zero = QPainterPath(), QPainterPath(), QPainterPath()
        for span in segments[1::2]:
            bands.addRect(QRectF(span.start, low, span.end - span.start, high - low))
        for place in across:
            grid.moveTo(place, low)
            grid.lineTo(place, high)
        for value in values:
            path = zero if value == 0.0 and frame.low < 0.0 else grid  # at the edge the axis itself stands
            path.moveTo(frame.first, value)
            path.lineTo(frame.last, value)
        for item, path in ((self._bands, bands), (self._grid, grid), (self._zero, zero)):
            item.redraw(path)


__all__ = [
    "BOTTOM_HEIGHT",
    "LEAST_ACROSS",
    "LEFT_WIDTH",
    "TOP_HEIGHT",
    "Z_CURSOR",
    "Z_CURVE",
    "Z_REFERENCE",
    "Axis",
    "LimitLine",
    "Paper",
    "Span",
    "angle_ticks",
    "name_ticks",
    "spans",
    "value_ticks",
]
