"""Motion laws over each other: displacement, velocity, acceleration or jerk for a rise and a span of 1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QFrame, QSizePolicy, QWidget

from core.laws import Law
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plot_parts import BOTTOM_HEIGHT, LEFT_WIDTH, Axis, Paper, value_ticks
from kindyna_gui.pictures.ranges import shown_range
from kindyna_gui.pictures.style import (
    BLACK,
    BLUE,
    GREEN,
    LIGHT,
    ORANGE,
    PURPLE,
    SKY,
    SMALL,
    THIN,
    VERMILION,
    Theme,
    font,
)

WIDE = 360.0  # u = 1 stands where the other plots have 360°, so that paper and grid are theirs
POINTS = 241  # of a piece of a law
RIGHT_MARGIN = 16  # pixels
QUANTITIES = (
    ("Displacement", "s", "displacement"),
    ("Velocity", "v", "velocity"),
    ("Acceleration", "a", "acceleration"),
    ("Jerk", "j", "jerk"),
)
"""Name, letter and family of each plot, in the order of the derivatives."""


@dataclass(frozen=True)
class Stroke:
    """Colour and dashes of a curve."""

    colour: str
    dash: tuple[float, ...]


_COLOURS = (BLUE, VERMILION, GREEN, BLACK, PURPLE, ORANGE, SKY)
_DASHES: tuple[tuple[float, ...], ...] = ((), (8.0, 3.0), (2.0, 2.0), (9.0, 3.0, 2.0, 3.0), (14.0, 4.0))
STROKES = tuple(Stroke(_COLOURS[i % 7], _DASHES[i % 5]) for i in range(35))
"""All different: neighbours differ in both, so that the curves can be told apart without colour."""


@cache
def _samples(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """u (n,), and s, v, a, j there (4, n): at a join inside the law both sides, so that a jump is upright."""
    starts = [piece.start for piece in law.pieces]
    rows = []
    for start, end in zip(starts, [*starts[1:], 1.0], strict=True):
        u = np.linspace(start, end, POINTS)
        u[-1] = end if end == 1.0 else np.nextafter(end, 0.0)
        rows.append(u)
    u = np.concatenate(rows)
    return u, law(u)


class LawPlot(pg.PlotWidget):
    """One of ``QUANTITIES`` of several laws."""

    def __init__(self, order: int, theme: Theme = LIGHT) -> None:
        self._theme, self._order = theme, order
        axes = {side: Axis(side, theme) for side in ("left", "bottom")}
        super().__init__(background=theme.paper, axisItems=axes, enableMenu=False)
        self.setCacheMode(self.CacheModeFlag.CacheNone)  # kept paper would stand in an SVG as pixels
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._axes = axes
        plot = self.getPlotItem()
        self._view: pg.ViewBox = plot.getViewBox()
        plot.hideButtons()
        plot.layout.setContentsMargins(2, 6, RIGHT_MARGIN, 2)
        self._view.setMouseEnabled(False, False)
        self._view.disableAutoRange()
        self._view.setDefaultPadding(0.0)
        self._view.setRange(xRange=(0.0, WIDE), yRange=(0.0, 1.0), padding=0.0)
        axes["left"].setWidth(LEFT_WIDTH)
        self._paper = Paper(self._view, theme)
        self.curves: dict[str, pg.PlotCurveItem] = {}
        self._view.sigResized.connect(self._lay)
        self.show_numbers(True)

    def show_numbers(self, on: bool) -> None:
        """Of plots one below the other only the last has the numbers of u below it."""
        axis = self._axes["bottom"]
        axis.setHeight(BOTTOM_HEIGHT if on else 6)
        axis.setStyle(showValues=on)
        axis.show_title("u, share of the span" if on else "", self._theme.ink)

    def show_laws(self, laws: Sequence[tuple[Law, Stroke]]) -> None:
        """Draw these laws and no others."""
        for item in self.curves.values():
            self._view.removeItem(item)
        self.curves = {}
        rows = []
        for law, stroke in laws:
            u, values = _samples(law)
            rows.append(values[self._order])
            item = pg.PlotCurveItem()
            pen = self._theme.pen(stroke.colour, THIN, stroke.dash)
            item.setData(WIDE * u, values[self._order], pen=pen, antialias=True, skipFiniteCheck=True)
            self._view.addItem(item, ignoreBounds=True)
            self.curves[law.slug] = item
        low, high = shown_range(rows, {QUANTITIES[self._order][2]}, ()) if rows else (0.0, 1.0)
        self._view.setRange(yRange=(low, high), padding=0.0)
        self._lay()

    def frame_now(self) -> tuple[float, float]:
        """Lowest and highest value that are shown."""
        low, high = self._view.viewRange()[1]
        return float(low), float(high)

    def _lay(self, *_: object) -> None:
        low, high = self.frame_now()
        height = max(self._view.height(), 1.0)
        step = 0.1 if self._view.width() > 420.0 else 0.2
        places = [(WIDE * step * i, f"{step * i:.1f}") for i in range(round(1.0 / step) + 1)]
        values = value_ticks(low, high, height) if self.curves else []
        self._paper.draw([], [at for at, _ in places], [value for value, _ in values], low, high)
        self._axes["bottom"].show_ticks(places)
        self._axes["left"].show_ticks(values)
        name, letter, _ = QUANTITIES[self._order]
        self._axes["left"].show_title(name if text_size(name)[0] + 10.0 <= height else letter, self._theme.ink)

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()


class Legend(QWidget):
    """Names of the curves with their strokes, in as many lines as they need."""

    GAP, LINE, SAMPLE = 16, 17, 26  # pixels: between entries, height of a line, of a stroke

    def __init__(self, theme: Theme = LIGHT) -> None:
        super().__init__()
        self._theme = theme
        self.laws: list[tuple[Law, Stroke]] = []
        policy = QSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.setSizePolicy(policy)

    def show_laws(self, laws: Sequence[tuple[Law, Stroke]]) -> None:
        self.laws = list(laws)
        self._fit()
        self.update()

    def _places(self) -> list[tuple[float, int]]:
        """Left edge [pixels] and line of each entry."""
        made, x, line = [], float(LEFT_WIDTH), 0
        for law, _ in self.laws:
            width = self.SAMPLE + 6.0 + text_size(law.label, SMALL)[0]
            if x > LEFT_WIDTH and x + width > self.width() - RIGHT_MARGIN:
                x, line = float(LEFT_WIDTH), line + 1
            made.append((x, line))
            x += width + self.GAP
        return made

    def _fit(self) -> None:
        lines = 1 + max((line for _, line in self._places()), default=0)
        self.setFixedHeight(lines * self.LINE + 6)

    def sizeHint(self) -> QSize:
        return QSize(LEFT_WIDTH, self.LINE + 6)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        painter.setFont(font(SMALL))
        for (law, stroke), (x, line) in zip(self.laws, self._places(), strict=True):
            middle = 4.0 + (line + 0.5) * self.LINE
            painter.setPen(self._theme.pen(stroke.colour, 2.0, stroke.dash))
            painter.drawLine(QPointF(x, middle), QPointF(x + self.SAMPLE, middle))
            painter.setPen(QColor(self._theme.ink))
            box = QRectF(x + self.SAMPLE + 6.0, middle - self.LINE / 2.0, self.width(), self.LINE)
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, law.label)
        painter.end()


__all__ = ["QUANTITIES", "STROKES", "WIDE", "LawPlot", "Legend", "Stroke"]
