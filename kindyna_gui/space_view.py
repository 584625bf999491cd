"""The path in space of the part that the drives carry together, as a picture that turns by the mouse."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from core.numerics.derivatives import ISOMETRIC, seen_from
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.pictures.style import BLUE, SCREEN
from kindyna_gui.player import Player
from kindyna_gui.requirements import Unavailable
from kindyna_gui.view import View

MM = 1e3
MARGIN, TURN_PER_PIXEL, STEEPEST = 46.0, 0.5, 90.0  # pixels; degrees for a pixel of the mouse; degrees of tilt
NO_PART = (
    "No drive says what it carries. Give drives of the file a direction in space, carries = [0.0, 0.0, 1.0], and the path of the "
    "part that they carry together is drawn here."
)


class SpaceSheet(QWidget):
    """Path (n, 3) [mm], its shadow on the floor, the axes through the lowest corner, and the part; dragged, it turns."""

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Path in space")
        self.path = np.zeros((1, 3))
        self.part = np.zeros(3)
        self.text = ""
        self.turn, self.tilt = ISOMETRIC
        self._grip: QPointF | None = None
        self.setMinimumSize(1, 1)
        self.setCursor(Qt.CursorShape.OpenHandCursor)
        self.setToolTip("Drag to turn; a double click looks from above and aside again, all axes as long")

    def places(self, points: np.ndarray) -> np.ndarray:
        """Where points (n, 3) are in the picture (n,), complex, in pixels, y downwards."""
        low, high = self.path.min(axis=0), self.path.max(axis=0)
        middle = 0.5 * (low + high)
        half = 0.5 * float(np.linalg.norm(high - low)) or 1.0  # whichever way it is turned
        room = min(self.width(), self.height()) / 2.0 - MARGIN
        seen = seen_from(np.atleast_2d(points) - middle, self.turn, self.tilt) * max(room, 1.0) / half
        return np.asarray(complex(self.width(), self.height()) / 2.0 + seen.conj())

    def look(self, turn: float, tilt: float) -> None:
        """Turn the picture [deg]."""
        self.turn, self.tilt = turn % 360.0, min(max(tilt, -STEEPEST), STEEPEST)
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(SCREEN.paper))
        low, high = self.path.min(axis=0), self.path.max(axis=0)
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0))
        for axis, name in enumerate("xyz"):
            end = low.copy()
            end[axis] = max(high[axis], low[axis] + 0.15 * float((high - low).max()))
            one, other = (_point(at) for at in self.places(np.array([low, end])))
            painter.drawLine(one, other)
            way = other - one
            beside = other + way * (16.0 / max(float(np.hypot(way.x(), way.y())), 16.0))
            wide = f"{name} {high[axis] - low[axis]:.4g} mm"
            painter.drawText(beside - QPointF(4.0, -4.0), wide)
        floor = self.path.copy()
        floor[:, 2] = low[2]
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0, Qt.PenStyle.DotLine))
        painter.drawPolygon(_polygon(self.places(floor)))
        foot = self.part.copy()
        foot[2] = low[2]
        here, below = (_point(at) for at in self.places(np.array([self.part, foot])))
        painter.drawLine(here, below)
        painter.setPen(QPen(QColor(SCREEN.seen(BLUE)), 2.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolygon(_polygon(self.places(self.path)))
        painter.setPen(QPen(QColor(SCREEN.ink), 1.4))
        painter.setBrush(QColor(SCREEN.seen(BLUE)))
        painter.drawEllipse(here, 6.0, 6.0)
        painter.drawText(QPointF(10.0, 20.0), self.text)
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._grip = event.position()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._grip is not None:
            way, self._grip = event.position() - self._grip, event.position()
            self.look(self.turn - TURN_PER_PIXEL * way.x(), self.tilt + TURN_PER_PIXEL * way.y())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        self._grip = None

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self.look(*ISOMETRIC)


class SpaceView(View):
    """Of all drives, at the machine angle at hand."""

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.sheet = SpaceSheet()
        self.set_column(self.sheet, grows=self.sheet)

    def refresh(self, study: Study) -> None:
        if not (self.session.several and self.session.shaft.has_transfer_path):
            raise Unavailable(NO_PART)
        self.sheet.path = self.session.shaft.transfer_path * MM

    def follow(self, theta: float) -> None:
        if self.session.several and self.session.shaft.has_transfer_path:
            machine = self.player.machine
            self.sheet.part = self.session.shaft.at_theta(np.array([machine])).transfer_path[0] * MM
            x, y, z = self.sheet.part
            self.sheet.text = f"Machine angle {np.rad2deg(machine):.1f}°: {x:.1f}, {y:.1f}, {z:.1f} mm"
            self.sheet.update()

    def fit(self) -> None:
        self.sheet.look(*ISOMETRIC)


def _point(at: complex) -> QPointF:
    return QPointF(at.real, at.imag)


def _polygon(places: np.ndarray) -> QPolygonF:
    return QPolygonF([_point(at) for at in places])


__all__ = ["NO_PART", "SpaceSheet", "SpaceView"]
