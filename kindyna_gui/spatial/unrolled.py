"""The unrolled flanks of a cam in space, coloured by pressure angle over the cam angle and the length of the roller."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import brief, number
from kindyna_gui.spatial.colours import scale_rgb

LEFT, RIGHT, TOP, BOTTOM, GAP = 96.0, 92.0, 26.0, 44.0, 30.0  # pixels around the maps and between them
TICK = 60  # degrees
MM = 1e3


class UnrolledCanvas(QWidget):
    """Map of the pressure angle on each flank.

    Attributes
    ----------
    maps : list of (str, ndarray (m, n) [rad])
        Heading and pressure angle of each flank, the inner end of the roller first.
    ends : (float, float)
        Distances of the roller's ends [m].
    limit : float
        Pressure angle whose colour is the last one [rad].
    """

    def __init__(self) -> None:
        super().__init__(accessibleName="Pressure angle on the flanks")
        self.maps: list[tuple[str, np.ndarray]] = []
        self.ends = (0.0, 1.0)
        self.limit = np.pi / 4.0
        self.theta = 0.0
        self.under_mouse: tuple[int, float, float] | None = None  # map, cam angle [deg], part of the roller's length
        self.setMouseTracking(True)
        self.setMinimumSize(1, 1)

    def room_of(self, k: int) -> QRectF:
        """Rectangle of a map in pixels."""
        count = max(len(self.maps), 1)
        height = max((self.height() - TOP - BOTTOM - GAP * (count - 1)) / count, 1.0)
        return QRectF(LEFT, TOP + k * (height + GAP), max(self.width() - LEFT - RIGHT, 1.0), height)

    def value_at(self, k: int, degrees: float, part: float) -> float:
        """Pressure angle [deg] of a map at a cam angle [deg] and a part of the roller's length."""
        values = self.maps[k][1]
        column = int(np.clip(round(degrees / 360.0 * values.shape[1]), 0, values.shape[1] - 1))
        return float(np.rad2deg(values[round(part * (values.shape[0] - 1)), column]))

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(SCREEN.paper))
        for k, (heading, values) in enumerate(self.maps):
            self._paint_map(painter, self.room_of(k), heading, values, is_last=k == len(self.maps) - 1)
        if self.maps:
            self._paint_legend(painter)
            self._paint_reading(painter)
        painter.end()

    def _paint_map(self, painter: QPainter, room: QRectF, heading: str, values: np.ndarray, is_last: bool) -> None:
        rgb = np.ascontiguousarray(scale_rgb(values[::-1] / self.limit))  # the outer end above
        image = QImage(rgb.data, rgb.shape[1], rgb.shape[0], 3 * rgb.shape[1], QImage.Format.Format_RGB888)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(room, image)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0))
        painter.drawRect(room)
        painter.setPen(QPen(QColor(SCREEN.ink)))
        painter.drawText(QPointF(room.left(), room.top() - 8.0), heading)
        for part, u in ((0.0, self.ends[1]), (1.0, self.ends[0])):
            at = room.top() + 5.0 + part * (room.height() - 6.0)
            text = QRectF(4.0, at - 9.0, LEFT - 12.0, 18.0)
            painter.drawText(
                text, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, f"u {brief(u * MM, 'mm')}"
            )
        for tick in range(0, 361, TICK):
            x = room.left() + room.width() * tick / 360.0
            painter.drawLine(QPointF(x, room.bottom()), QPointF(x, room.bottom() + 4.0))
            if is_last:
                painter.drawText(
                    QRectF(x - 24.0, room.bottom() + 4.0, 48.0, 16.0), Qt.AlignmentFlag.AlignHCenter, f"{tick}"
                )
        if is_last:
            below = QRectF(room.left(), room.bottom() + 20.0, room.width(), 18.0)
            painter.drawText(below, Qt.AlignmentFlag.AlignHCenter, "Cam angle, °")
        x = room.left() + room.width() * (self.theta % (2.0 * np.pi)) / (2.0 * np.pi)
        painter.drawLine(QPointF(x, room.top()), QPointF(x, room.bottom()))

    def _paint_legend(self, painter: QPainter) -> None:
        """Colours of the pressure angle from 0 to the limit."""
        first = self.room_of(0)
        bar = QRectF(self.width() - RIGHT + 16.0, first.top(), 12.0, min(first.height(), 160.0))
        rgb = np.ascontiguousarray(scale_rgb(np.linspace(1.0, 0.0, 64))[:, None])
        painter.drawImage(bar, QImage(rgb.data, 1, 64, 3, QImage.Format.Format_RGB888))
        painter.setPen(QPen(QColor(SCREEN.ink)))
        painter.drawText(QPointF(bar.right() + 5.0, bar.top() + 9.0), f"{number(np.rad2deg(self.limit), 1)}°")
        painter.drawText(QPointF(bar.right() + 5.0, bar.bottom()), "0°")
        painter.setPen(QPen(QColor(SCREEN.limit)))
        painter.drawText(QPointF(bar.left(), bar.bottom() + 20.0), "beyond: red")

    def _paint_reading(self, painter: QPainter) -> None:
        painter.setPen(QPen(QColor(SCREEN.ink)))
        for k in range(len(self.maps)):
            room, at = self.room_of(k), (np.rad2deg(self.theta) % 360.0, 0.5)
            if self.under_mouse is not None and self.under_mouse[0] == k:
                at = self.under_mouse[1:]
            u = self.ends[0] + at[1] * (self.ends[1] - self.ends[0])
            value = f"{number(self.value_at(k, *at), 2)}°"
            text = f"{value} at {number(at[0], 1)}°, u {brief(u * MM, 'mm')}"
            metrics = painter.fontMetrics()
            if metrics.horizontalAdvance(f"{self.maps[k][0]}  {text}") > room.width():
                text = value
            painter.drawText(
                QRectF(room.left(), room.top() - 22.0, room.width(), 18.0),
                Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter,
                text,
            )

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        point, self.under_mouse = event.position(), None
        for k in range(len(self.maps)):
            room = self.room_of(k)
            if room.contains(point):
                part = 1.0 - (point.y() - room.top()) / room.height()
                self.under_mouse = k, 360.0 * (point.x() - room.left()) / room.width(), part
        self.update()
