"""The line above a polar plot: names with their colours, and the unit."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QFontMetricsF, QPainter

from kindyna_gui.pictures.plots.legend import cut
from kindyna_gui.pictures.style import TEXT, font

BUTTON, EDGE = 24.0, 4.0  # kept free in the upper right corner, on the left, pixels


def paint_title(painter: QPainter, names: Sequence[tuple[str, str]], unit: str, ink: str, width: float) -> None:
    """names: text and colour of each curve; width: of the plot, pixels."""
    painter.setFont(font(TEXT))
    metrics = QFontMetricsF(font(TEXT))
    advance = metrics.horizontalAdvance
    pieces = title_pieces(names, unit, ink, advance, width - EDGE - BUTTON)
    long = sum(advance(text) for text, _ in pieces)
    x = max(EDGE, min((width - long) / 2.0, width - long - BUTTON))
    for text, colour in pieces:
        painter.setPen(QColor(colour))
        painter.drawText(QPointF(x, 6.0 + metrics.ascent()), text)
        x += advance(text)


def title_pieces(
    names: Sequence[tuple[str, str]], unit: str, ink: str, advance: Callable[[str], float], room: float
) -> list[tuple[str, str]]:
    """Texts and colours, one after the other; where they have no room [pixels], each name is cut to its share of it."""
    marks = ["," if i < len(names) - 1 or unit else "" for i in range(len(names))]
    last = [(unit, ink)] if unit else []
    whole = [(f"{text}{mark} ", colour) for (text, colour), mark in zip(names, marks, strict=True)] + last
    if sum(advance(text) for text, _ in whole) <= room:
        return whole
    each = (room - advance(unit)) / len(names) - advance(", ")
    return [(f"{cut(text, each, advance)}{mark} ", colour) for (text, colour), mark in zip(names, marks, strict=True)] + last
