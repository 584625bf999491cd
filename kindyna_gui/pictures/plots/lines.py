"""The lines of a plot: its curves, the bands behind them, the limits that must not be crossed, the cursor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from kindyna_gui.pictures.detail import needed
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.frame import Z_CURSOR, Z_LIMIT, Z_REFERENCE, Frame
from kindyna_gui.pictures.plots.legend import Entry
from kindyna_gui.pictures.style import SMALL, Theme, brush

PLACES = (1.0, 0.0, 0.75, 0.5, 0.25)  # along a limit's line, for its text
BAND_STRENGTH = (0.16, 0.3)  # opacity of the outer band, of the inner one above it


class CurveLine(Outline):
    """A curve over the turn; on the screen it is drawn from those of its points that its size there needs.

    x, y    all its points (n,), in the units of the axes
    drawn   how many of them the path goes through
    """

    x: np.ndarray  # type: ignore[assignment]
    y: np.ndarray  # type: ignore[assignment]

    def __init__(self, view: pg.ViewBox) -> None:
        super().__init__(QPainterPath())
        self.x = self.y = np.zeros(0)
        self.drawn, self._whole = 0, True
        self._laid: tuple[object, ...] = ()
        view.addItem(self, ignoreBounds=True)

    def show_points(self, x: np.ndarray, y: np.ndarray, pen: QPen, z: float) -> None:
        """Be a curve through these points; a gap where y is NaN. To be laid before it is drawn."""
        self.x, self.y, self._whole = x, y, bool(np.isfinite(y).all())
        self._laid = ()
        self.setPen(pen)
        self.setZValue(z)

    def lay(self, frame: Frame, unseen: float) -> None:
        """Take the points that a plot of this size needs to be off by no more than ``unseen`` pixels; all where it is
        0."""
        wanted = (frame, unseen)
        if wanted == self._laid:
            return
        self._laid = wanted
        pixels = self.x * (frame.width / 360.0) + 1j * self.y * (frame.height / (frame.high - frame.low))
        kept = needed(pixels, unseen)
        self.drawn = int(kept.size)
        connect = "all" if self._whole else "finite"
        self.redraw(pg.arrayToQPath(self.x[kept], self.y[kept], connect, finiteCheck=not self._whole))

    def enters(self, box: QRectF, frame: Frame) -> bool:
        """Whether the curve comes into a box in the frame [pixels from its lower left corner, y upwards]."""
        first, last = np.searchsorted(self.x, np.array([box.left(), box.right()]) / frame.width * 360.0)
        part = self.y[max(first - 1, 0) : last + 1]
        part = part if self._whole else part[np.isfinite(part)]
        low, high = frame.value(box.top()), frame.value(box.bottom())
        return bool(part.size) and not (part.max() < low or part.min() > high)

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        super().paint(painter, option, widget)


class LimitLine:
    """A thin red line over the whole turn with its value at the right end."""

    def __init__(self, view: pg.ViewBox, theme: Theme, value: float = 0.0, text: str = "") -> None:
        path = QPainterPath()
        path.lineTo(360.0, 0.0)
        self._line = Outline(path, theme.pen(theme.limit))
        self._tag = Tag("", theme.limit, theme, SMALL, (1.0, 1.0), backing=True)
        self._items = (self._line, self._tag)
        for item, z in zip(self._items, (Z_LIMIT, Z_CURSOR + 1.0), strict=True):
            item.setZValue(z)
            view.addItem(item, ignoreBounds=True)
        self.set_value(value, text)

    def set_value(self, value: float, text: str, short: str = "", field: str = "") -> None:
        """Stand at this value with this text, or with the short one where it would cover a curve; field: where it is stated."""
        self.value, self.text, self._short, self.field = value, text, short, field
        self._tag.set_text(text)
        self._line.setPos(0.0, value)
        self._tag.setPos(360.0, value)

    def lay(self, low: float, high: float, height: float) -> None:
        """The text stands above the line at its right end, below it where there is no room."""
        self._stand(1.0, self._above(low, high, height))

    def lay_clear(self, frame: Frame, curves: Sequence[CurveLine], taken: Sequence[QRectF] = ()) -> None:
        """The same, but further left, below the line, or in short where it would cover a curve otherwise, or one of the boxes taken."""
        above = self._above(frame.low, frame.high, frame.height)
        room = QRectF(-1.0, 0.0, frame.width + 2.0, frame.height)
        for text, over, part in product((self.text, self._short), (above, not above), PLACES):
            self._tag.set_text(text)
            self._stand(part, over)
            box = self.box(frame).adjusted(0.0, -2.0, 0.0, 2.0)
            covers = any(curve.enters(box, frame) for curve in curves) or any(map(box.intersects, taken))
            if text and room.contains(box) and not covers:
                return
        self._tag.set_text(self.text)
        if self._short and self._tag.size[0] + 8.0 > frame.width:
            self._tag.set_text(self._short)
        self._stand(1.0, above)

    def _above(self, low: float, high: float, height: float) -> bool:
        return (high - self.value) / (high - low) * height > self._tag.size[1] + 2.0

    def _stand(self, part: float, above: bool) -> None:
        """At a part of the line's length, above or below it."""
        self._tag.setPos(360.0 * part, self.value)
        self._tag.set_lean(part, 1.0 if above else 0.0)
        self._tag.shift(4.0 - 8.0 * part, 0.0)

    def box(self, frame: Frame) -> QRectF:
        """Where the text stands in the frame, pixels from its lower left corner, y upwards."""
        box, place = self._tag.pixel_box(), frame.pixel(self.value)
        x = self._tag.pos().x() / 360.0 * frame.width
        return QRectF(x + box.left(), place - box.bottom(), box.width(), box.height())

    def remove(self, view: pg.ViewBox) -> None:
        for item in self._items:
            view.removeItem(item)


class Cursor(Outline):
    """The upright line at the cam angle."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        path = QPainterPath()
        path.lineTo(0.0, 1.0)
        super().__init__(path, theme.pen(theme.quiet))
        self.setZValue(Z_CURSOR)
        view.addItem(self, ignoreBounds=True)

    def span(self, low: float, high: float) -> None:
        """Reach over the values that are shown."""
        path = QPainterPath()
        path.moveTo(0.0, low)
        path.lineTo(0.0, high)
        self.redraw(path)

    def value(self) -> float:
        """The cam angle [deg]."""
        return float(self.pos().x())


def closed(band: np.ndarray, gain: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Cam angles [deg] (n + 1,) to the end of the turn, and the percentiles (5, n + 1) there, which grow by ``gain`` in a turn."""
    return np.linspace(0.0, 360.0, band.shape[1] + 1), np.column_stack([band, band[:, :1] + gain])


def rings(x: np.ndarray, ends: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Round the area from the first to the last percentile (5, n), and from the second to the last but one: x, value (m,), opacity."""
    for i, strength in enumerate(BAND_STRENGTH):
        known = np.isfinite(x) & np.isfinite(ends[i]) & np.isfinite(ends[-1 - i])
        there, low, high = x[known], ends[i][known], ends[-1 - i][known]
        yield np.append(there, there[::-1]), np.append(low, high[::-1]), strength


def shades(x: np.ndarray, ends: np.ndarray, colour: str) -> Iterator[Outline]:
    """These areas, the outer one faint, as drawn."""
    for across, upwards, strength in rings(x, ends):
        item = Outline(pg.arrayToQPath(across, upwards), fill=brush(colour, strength))
        item.setZValue(Z_REFERENCE - 1.0)
        yield item


MACHINES = "90 and 99.73 % of machines"


def shades_entry(theme: Theme, text: str = MACHINES) -> Entry:
    """What the legend says of them."""
    return Entry(theme.quiet, text, "▒")
