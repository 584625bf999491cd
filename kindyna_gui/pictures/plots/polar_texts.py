"""Texts of a polar plot: the line above it with names and unit, and places where a value covers no other text."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from PySide6.QtCore import QPointF, QRectF, QSizeF
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
    return [
        (f"{cut(text, each, advance)}{mark} ", colour) for (text, colour), mark in zip(names, marks, strict=True)
    ] + last


SIDE = 8.0  # of a text from the point it belongs to, pixels
STEPS = 6  # heights of a text that it may be moved up or down


def near(at: QPointF, size: QSizeF, left: bool, taken: Sequence[QRectF], room: QRectF) -> QRectF:
    """The box of a text beside a point: on the wanted side at the point's height if that is free, else as near to it as
    can be; where nothing is free, as if all were."""
    boxes = list(_places(at, size, left))
    inside = [box for box in boxes if room.contains(box)]
    free = (box for box in inside if not any(box.intersects(other) for other in taken))
    return next(free, inside[0] if inside else boxes[0])


def _places(at: QPointF, size: QSizeF, left: bool) -> Iterator[QRectF]:
    for step in range(STEPS):
        for up in (step, -step) if step else (0,):
            for side in (left, not left):
                x = at.x() - SIDE - size.width() if side else at.x() + SIDE
                yield QRectF(QPointF(x, at.y() - (0.5 + 0.5 * up) * size.height()), size)
