"""The line above a polar plot: names with their colours, and the unit."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QFontMetricsF, QPainter

from kindyna_gui.pictures.style import TEXT, font

BUTTON = 24.0  # kept free in the upper right corner, pixels


def paint_title(painter: QPainter, names: Sequence[tuple[str, str]], unit: str, ink: str, width: float) -> None:
    """names: text and colour of each curve; width: of the plot, pixels."""
    painter.setFont(font(TEXT))
    metrics = QFontMetricsF(font(TEXT))
    told = [(f"{text}{',' if i < len(names) - 1 or unit else ''} ", colour) for i, (text, colour) in enumerate(names)]
    if unit:
        told.append((unit, ink))
    long = sum(metrics.horizontalAdvance(text) for text, _ in told)
    x = max(4.0, min((width - long) / 2.0, width - long - BUTTON))
    for text, colour in told:
        painter.setPen(QColor(colour))
        painter.drawText(QPointF(x, 6.0 + metrics.ascent()), text)
        x += metrics.horizontalAdvance(text)
