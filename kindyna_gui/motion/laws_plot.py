"""Motion laws over each other: displacement, velocity, acceleration or jerk for a rise and a span of 1."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.frozen import frozen
from core.laws import Law
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.fixed_plot import RIGHT_MARGIN
from kindyna_gui.pictures.plots.frame import LEFT_WIDTH
from kindyna_gui.pictures.plots.ranges import shown_range
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SCREEN,
    SKY,
    SMALL,
    VERMILION,
    Theme,
    font,
)
from kindyna_gui.preferences.units import sized

POINTS = 241  # of a piece of a law
QUANTITIES = (
    ("Displacement", "s", "displacement"),
    ("Velocity", "v", "velocity"),
    ("Acceleration", "a", "acceleration"),
    ("Jerk", "j", "jerk"),
)
"""Name, letter and family of each plot, in the order of the derivatives."""


@frozen
class LineStyle:
    """Colour and dashes of a curve, and how many times as wide as others it is."""

    colour: str
    dash: tuple[float, ...]
    width: int = 1


_COLOURS = (BLUE, VERMILION, GREEN, BLACK, PURPLE, ORANGE, SKY)
_DASHES: tuple[tuple[float, ...], ...] = ((), (8.0, 3.0), (2.0, 2.0), (9.0, 3.0, 2.0, 3.0), (14.0, 4.0))


def stroke_of(number: int) -> LineStyle:
    """The stroke of the curve of that number, from 0: all different, and neighbours in colour and dashes both, so that the curves
    can be told apart without colour; those behind all pairs of these are wider."""
    colours, dashes = len(_COLOURS), len(_DASHES)
    return LineStyle(_COLOURS[number % colours], _DASHES[number % dashes], 1 + number // (colours * dashes))


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


def show_laws(plot: XYPlot, order: int, laws: Sequence[tuple[Law, LineStyle]]) -> None:
    """Draw one of ``QUANTITIES``, by its number, of these laws."""
    quantity, letter, family = QUANTITIES[order]
    lines = [
        Line(_samples(law)[0], _samples(law)[1][order], style.colour, dash=style.dash, width=style.width)
        for law, style in laws
    ]
    if lines:
        plot.name_axes("u, share of the span", f"{quantity}, {letter}")
        plot.show_lines(lines)
        plot.show_range(upwards=shown_range([line.y for line in lines], {family}, ()))
    else:
        plot.show_message("")


class LawsLegend(QWidget):
    """Names of the curves with their strokes, in as many lines as they need."""

    GAP, LINE, SAMPLE = 16, 17, 26  # pixels: between entries, height of a line, of a stroke

    def __init__(self, theme: Theme = SCREEN) -> None:
        super().__init__()
        self._theme = theme
        self.laws: list[tuple[Law, LineStyle]] = []
        policy = QSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.setSizePolicy(policy)

    def show_laws(self, laws: Sequence[tuple[Law, LineStyle]]) -> None:
        """Name these laws and no others."""
        self.laws = list(laws)
        self.setAccessibleName("Laws drawn: " + (", ".join(law.label for law, _ in laws) or "none"))
        self._fit()
        self.update()

    def _places(self) -> list[tuple[float, int]]:
        """Left edge [pixels] and line of each entry."""
        left = sized(LEFT_WIDTH)
        made, x, line = [], left, 0
        for law, _ in self.laws:
            width = self.SAMPLE + 6.0 + text_size(law.label, SMALL)[0]
            if x > left and x + width > self.width() - RIGHT_MARGIN:
                x, line = left, line + 1
            made.append((x, line))
            x += width + self.GAP
        return made

    def _fit(self) -> None:
        lines = 1 + max((line for _, line in self._places()), default=0)
        self.setFixedHeight(round(lines * sized(self.LINE)) + 6)

    def redress(self) -> None:
        """Theme or letters have changed."""
        self._fit()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(LEFT_WIDTH, round(sized(self.LINE)) + 6)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        painter.setFont(font(SMALL))
        for (law, stroke), (x, line) in zip(self.laws, self._places(), strict=True):
            middle = 4.0 + (line + 0.5) * sized(self.LINE)
            painter.setPen(self._theme.pen(self._theme.seen(stroke.colour), 2.0 * stroke.width, stroke.dash))
            painter.drawLine(QPointF(x, middle), QPointF(x + self.SAMPLE, middle))
            painter.setPen(QColor(self._theme.ink))
            box = QRectF(x + self.SAMPLE + 6.0, middle - sized(self.LINE) / 2.0, self.width(), sized(self.LINE))
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, law.label)
        painter.end()


__all__ = ["QUANTITIES", "LawsLegend", "LineStyle", "show_laws", "stroke_of"]
