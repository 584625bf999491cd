"""What a plot of curves is made of besides its curves: paper with grid and segments, axes, cursor, limits."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import pyqtgraph as pg
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainterPath

from core.design import Motion
from core.laws import find_law
from kindyna_gui.pictures.items import Outline, Tag, text_size
from kindyna_gui.pictures.style import SMALL, TEXT, THIN, Theme, brush, font
from kindyna_gui.pictures.units import Rung, decimals_of, measure, number, ticks

ANGLE_STEPS = (30, 60, 90, 180)  # between ticks of the cam angle, deg
LEAST_ANGLE_PIXELS, LEAST_VALUE_PIXELS = 38.0, 26.0  # between ticks
LEFT_WIDTH, TOP_HEIGHT, BOTTOM_HEIGHT = 66, 17, 38  # of the axes, pixels
Z_BANDS, Z_GRID, Z_ZERO, Z_LIMIT, Z_REFERENCE, Z_CURVE, Z_CURSOR = -90.0, -80.0, -70.0, 5.0, 8.0, 10.0, 20.0
SIDE = 6.0  # of a cursor's text from its line, pixels
LIFT = 9.0  # of its middle above the value, so that a level curve is not covered


@dataclass(frozen=True)
class Span:
    """One segment of the motion: where it starts and ends [deg], and its law's name."""

    start: float
    end: float
    name: str


def spans(motion: Motion) -> list[Span]:
    """The segments of a motion in order."""
    made, at = [], 0.0
    for segment in motion.segments:
        law = find_law(segment.curve.law)
        made.append(Span(at, at + segment.span_deg, law.label if law is not None else segment.curve.law))
        at += segment.span_deg
    return made


class Axis(pg.AxisItem):
    """An axis that shows the ticks it is given, in the quiet colour of the paper."""

    def __init__(self, orientation: str, theme: Theme, line: bool = True) -> None:
        super().__init__(orientation, pen=theme.pen(theme.quiet), textPen=theme.pen(theme.ink), maxTickLength=-4)
        self._title = ("", "")
        self._rows: list[tuple[float, str]] | None = None
        self.enableAutoSIPrefix(False)
        self.setStyle(tickFont=font(SMALL), autoExpandTextSpace=False, hideOverlappingLabels=False, tickTextOffset=4)
        if not line:
            self.setStyle(tickLength=0, tickTextOffset=1)
            self.setPen(theme.pen(theme.faint))
            hidden = theme.pen(theme.faint)
            hidden.setCapStyle(Qt.PenCapStyle.FlatCap)  # a tick without length leaves no dot
            self.setTickPen(hidden)
            self.setTextPen(theme.pen(theme.quiet))

    def show_ticks(self, rows: Sequence[tuple[float, str]]) -> None:
        if list(rows) != self._rows:  # pyqtgraph would draw the axis anew
            self._rows = list(rows)
            self.setTicks([self._rows])

    def show_title(self, text: str, colour: str) -> None:
        """The axis' name; put in the middle anew, which setLabel alone does not do."""
        style = {"color": colour, "font-size": f"{TEXT}px"}
        if (text, colour) != self._title:
            self._title = (text, colour)
            self.setLabel(re.sub(r"_(\w+)", r"<sub>\1</sub>", escape(text)), **style)
        self.resizeEvent()

    def wheelEvent(self, event: object) -> None:
        """Left to the view around."""

    def mouseDragEvent(self, event: object) -> None:
        """Left to the view around."""


def angle_step(width: float) -> int:
    """Degrees between ticks of a whole turn on so many pixels."""
    return next((s for s in ANGLE_STEPS if width * s / 360.0 >= LEAST_ANGLE_PIXELS), ANGLE_STEPS[-1])


def angle_ticks(width: float) -> list[tuple[float, str]]:
    return [(float(d), str(d)) for d in range(0, 361, angle_step(width))]


def value_ticks(low: float, high: float, height: float) -> list[tuple[float, str]]:
    values, step = ticks(low, high, max(2, int(height / LEAST_VALUE_PIXELS)))
    return [(value, number(value, decimals_of(step))) for value in values]


def name_ticks(segments: Sequence[Span], width: float) -> list[tuple[float, str]]:
    """The names of those segments that are wide enough on paper for theirs."""
    rows = []
    for span in segments:
        room = (span.end - span.start) / 360.0 * width
        if text_size(span.name)[0] + 6.0 <= room:
            rows.append(((span.start + span.end) / 2.0, span.name))
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

    def draw(
        self, segments: Sequence[Span], angles: Sequence[float], values: Sequence[float], low: float, high: float
    ) -> None:
        """low, high: what the value axis shows."""
        bands, grid, zero = QPainterPath(), QPainterPath(), QPainterPath()
        for span in segments[1::2]:
            bands.addRect(QRectF(span.start, low, span.end - span.start, high - low))
        for angle in angles:
            grid.moveTo(angle, low)
            grid.lineTo(angle, high)
        for value in values:
            path = zero if value == 0.0 else grid
            path.moveTo(0.0, value)
            path.lineTo(360.0, value)
        for item, path in ((self._bands, bands), (self._grid, grid), (self._zero, zero)):
            item.redraw(path)


class LimitLine:
    """A thin red line over the whole turn with its value at the right end."""

    def __init__(self, view: pg.ViewBox, theme: Theme, value: float, text: str) -> None:
        self.value, self.text = value, text
        path = QPainterPath()
        path.moveTo(0.0, value)
        path.lineTo(360.0, value)
        self._line = Outline(path, theme.pen(theme.limit))
        self._tag = Tag(text, theme.limit, theme, SMALL, (1.0, 1.0), backing=True)
        self._tag.setPos(360.0, value)
        self._items = (self._line, self._tag)
        for item, z in zip(self._items, (Z_LIMIT, Z_CURSOR + 1.0), strict=True):
            item.setZValue(z)
            view.addItem(item, ignoreBounds=True)

    def lay(self, low: float, high: float, height: float) -> None:
        """The text stands above the line, below it where there is no room."""
        room = (high - self.value) / (high - low) * height
        self._tag.set_lean(1.0, 1.0 if room > self._tag.size[1] + 2.0 else 0.0)
        self._tag.shift(-4.0, 0.0)

    def remove(self, view: pg.ViewBox) -> None:
        for item in self._items:
            view.removeItem(item)


class Readout:
    """A curve's value beside the cursor, with a dot on the curve."""

    def __init__(self, view: pg.ViewBox, theme: Theme, colour: str) -> None:
        dot = QPainterPath()
        dot.addEllipse(QRectF(-3.0, -3.0, 6.0, 6.0))
        self.dot = Outline(dot, theme.pen(theme.paper), brush(colour))
        self.dot.setFlag(self.dot.GraphicsItemFlag.ItemIgnoresTransformations)
        self.tag = Tag("", theme.letters(colour), theme, SMALL, (0.0, 0.5), backing=True)
        self.hide()
        for item in (self.dot, self.tag):
            item.setZValue(Z_CURSOR)
            view.addItem(item, ignoreBounds=True)

    def hide(self) -> None:
        self.dot.setVisible(False)
        self.tag.setVisible(False)

    def remove(self, view: pg.ViewBox) -> None:
        view.removeItem(self.dot)
        view.removeItem(self.tag)


@dataclass(frozen=True)
class Frame:
    """What a plot shows at which size: values from low to high on width x height pixels."""

    low: float
    high: float
    width: float
    height: float

    def pixel(self, value: float) -> float:
        """Height of a value above the axis, pixels."""
        return (value - self.low) / (self.high - self.low) * self.height

    def value(self, pixel: float) -> float:
        return self.low + pixel / self.height * (self.high - self.low)


def place_readouts(
    readouts: Sequence[Readout], angle: float, values: Sequence[float], rung: Rung, frame: Frame
) -> None:
    """Write the values beside the cursor at ``angle`` [deg]: on its right, on its left where there is no room, one
    above the other in their order, all within the frame."""
    rows = []
    for reading, value in zip(readouts, values, strict=True):
        known = abs(value) < float("inf")
        reading.tag.set_text(measure(value, rung.symbol))
        reading.dot.setVisible(known)
        reading.tag.setVisible(True)
        if known:
            reading.dot.setPos(angle, value)
        rows.append((frame.pixel(value) + LIFT if known else frame.height / 2, reading.tag))
    heights = stacked([row[0] for row in rows], rows[0][1].size[1] if rows else 0.0, frame.height)
    widest = max((tag.size[0] for _, tag in rows), default=0.0)
    right = angle / 360.0 * frame.width + SIDE + widest + 4.0 <= frame.width
    for (_, tag), at in zip(rows, heights, strict=True):
        tag.set_lean(0.0 if right else 1.0, 0.5)
        tag.shift(SIDE if right else -SIDE, 0.0)
        tag.setPos(angle, frame.value(at))


def stacked(middles: Sequence[float], height: float, room: float) -> list[float]:
    """Middles of boxes of one height, moved apart and into 0 ... room as little as that needs."""
    order = sorted(range(len(middles)), key=lambda i: middles[i])
    placed = [min(max(middles[i], height / 2 + 1.0), room - height / 2 - 1.0) for i in order]
    for i in range(1, len(placed)):
        placed[i] = max(placed[i], placed[i - 1] + height)
    over = placed[-1] - (room - height / 2 - 1.0) if placed else 0.0
    if over > 0.0:
        placed[-1] -= over
        for i in range(len(placed) - 2, -1, -1):
            placed[i] = min(placed[i], placed[i + 1] - height)
    back = dict(zip(order, placed, strict=True))
    return [back[i] for i in range(len(middles))]
