"""Small pictures of motions and curves: displacement, velocity and acceleration, each in its colour."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap, QPolygonF

from core.output.texts import curve_shape, type_shape
from kindyna_gui.pictures.style import SCREEN, of_theme

TYPE_SIZE, CURVE_SIZE = QSize(96, 46), QSize(72, 26)
QUANTITIES = ("displacement", "velocity", "acceleration")
EDGE, GAP, WIDTH = 2.0, 4.0, 1.5  # around the curves, between them, of a line [pixels]
_NONE = 1e-9


@of_theme
def type_icon(motion_type: str) -> QIcon:
    """The picture of a type of motion, its three curves below each other."""
    return _icon(type_shape(motion_type), TYPE_SIZE, below=True)


@of_theme
def curve_icon(curve: str) -> QIcon:
    """The picture of an elementary curve: displacement, velocity and acceleration side by side, as a row of a table has room."""
    return _icon(curve_shape(curve), CURVE_SIZE, below=False)


def _icon(shape: np.ndarray, size: QSize, below: bool) -> QIcon:
    made = QIcon()
    for ratio in (1, 2):
        picture = QPixmap(size * ratio)
        picture.setDevicePixelRatio(ratio)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        width, height = size.width() - 2.0 * EDGE, size.height() - 2.0 * EDGE
        for k, quantity in enumerate(QUANTITIES):
            if below:
                part = (height - 2.0 * GAP) / 3.0
                box = (EDGE, EDGE + k * (part + GAP), width, part)
            else:
                part = (width - 2.0 * GAP) / 3.0
                box = (EDGE + k * (part + GAP), EDGE, part, height)
            _draw(painter, shape[0], shape[k + 1], box, SCREEN.family(quantity))
        painter.end()
        made.addPixmap(picture)
    return made


def _draw(painter: QPainter, x: np.ndarray, y: np.ndarray, box: tuple[float, float, float, float], colour: str) -> None:
    """One curve in its box (left, top, width, height), on a line at 0."""
    left, top, width, height = box
    low, high = min(0.0, float(y.min())), max(0.0, float(y.max()))
    moves = high - low > _NONE
    size, above = (high - low, high) if moves else (2.0, 1.0)  # what is 0 all along lies in the middle
    across = left + width * (x - x[0]) / (x[-1] - x[0])
    down = top + height * (above - y) / size
    zero = top + height * above / size
    painter.setPen(QPen(QColor(SCREEN.faint), 1.0))
    painter.drawLine(QPointF(left, zero), QPointF(left + width, zero))
    painter.setPen(QPen(QColor(colour), WIDTH))
    painter.drawPolyline(QPolygonF([QPointF(a, b) for a, b in zip(across.tolist(), down.tolist(), strict=True)]))


__all__ = ["CURVE_SIZE", "TYPE_SIZE", "curve_icon", "type_icon"]
