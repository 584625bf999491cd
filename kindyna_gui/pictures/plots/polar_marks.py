"""The highest and lowest values of curves in polar form: a dot and a quiet text; an arrow where a value is infinite."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QPainter, QPolygonF

from core.frozen import frozen
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.extreme_marks import ARROW, DOT, Extreme
from kindyna_gui.pictures.style import SMALL, THIN, Theme, brush, font

GAPS = (5.0, 12.0, 20.0)  # from a dot to its text, pixels
TURNS = 22.5 * np.array(
    [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8]
)  # of the text from the way outwards, deg
PAD = 2.0  # beside a text, pixels


@frozen
class PolarMark:
    """An extreme where it is drawn [pixels]: its dot, the way outwards, its text and the text's box, empty where there is
    no room for it."""

    extreme: Extreme
    at: QPointF
    outwards: complex
    text: str
    box: QRectF

    @property
    def dot(self) -> QRectF:
        """What the dot or the arrow takes."""
        half = DOT + 1.0 if math.isfinite(self.extreme.value) else 2.0 * ARROW
        return QRectF(self.at.x() - half, self.at.y() - half, 2.0 * half, 2.0 * half)

    def paint(self, painter: QPainter, theme: Theme) -> None:
        """Dot or arrow, and the text."""
        finite = math.isfinite(self.extreme.value)
        painter.setPen(theme.pen(self.extreme.colour, THIN))
        painter.setBrush(brush(theme.paper if finite else self.extreme.colour))
        if finite:
            painter.drawEllipse(self.at, DOT, DOT)
        else:
            along = self.outwards if self.extreme.highest else -self.outwards
            corners = (0j, -2.0 * ARROW * along + 1j * ARROW * along, -2.0 * ARROW * along - 1j * ARROW * along)
            painter.drawPolygon(QPolygonF([self.at + QPointF(c.real, c.imag) for c in corners]))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if not self.box.isEmpty():
            painter.fillRect(self.box, brush(theme.paper, 0.85))
            painter.setFont(font(SMALL))
            painter.setPen(QColor(theme.quiet))
            painter.drawText(self.box, Qt.AlignmentFlag.AlignCenter, self.text)


def lay_polar_marks(
    extremes: Sequence[Extreme],
    place: Callable[[Extreme], QPointF],
    ends: tuple[float, float],
    curves: Sequence[np.ndarray],
    taken: Sequence[QRectF],
    room: QRectF,
) -> list[PolarMark]:
    """Put each text beside its dot, a highest value's outwards if it can be, where it covers neither curves, arrays (n,) of
    places x + iy [pixels], nor what is taken; else it is left out. ends: of the circles' values."""
    marks: list[PolarMark] = []
    shown = [PolarMark(e, place(e), _outwards(e), e.text(*ends), QRectF()) for e in extremes]
    texts: set[tuple[str, float, float]] = set()
    for mark in shown:
        key = (mark.text, round(mark.at.x()), round(mark.at.y()))
        width, height = text_size(mark.text)
        others = [*taken, *(other.dot for other in shown), *(other.box for other in marks)]
        boxes = _boxes(mark, QSizeF(width + 2.0 * PAD, height))
        free = (box for box in boxes if room.contains(box) and not any(box.intersects(other) for other in others))
        box = next((box for box in free if not any(_enters(curve, box) for curve in curves)), QRectF())
        marks.append(PolarMark(mark.extreme, mark.at, mark.outwards, mark.text, QRectF() if key in texts else box))
        texts.add(key)
    return marks


def _outwards(extreme: Extreme) -> complex:
    """The unit vector away from the centre, y downwards."""
    return cmath.rect(1.0, -math.radians(extreme.angle))


def _boxes(mark: PolarMark, size: QSizeF) -> Iterator[QRectF]:
    """Around the dot, what is tried first at the front."""
    way = mark.outwards if mark.extreme.highest else -mark.outwards
    extra = 0.0 if math.isfinite(mark.extreme.value) else 2.0 * ARROW
    for gap in GAPS:
        for turn in TURNS.tolist():
            side = way * cmath.rect(1.0, math.radians(turn))
            away = gap + extra
            box = QRectF(QPointF(), size)
            box.moveCenter(
                mark.at + QPointF(side.real * (away + 0.5 * size.width()), side.imag * (away + 0.5 * size.height()))
            )
            yield box


def _enters(curve: np.ndarray, box: QRectF) -> bool:
    x, y = curve.real, curve.imag
    return bool(((box.left() < x) & (x < box.right()) & (box.top() < y) & (y < box.bottom())).any())


__all__ = ["PolarMark", "lay_polar_marks"]
