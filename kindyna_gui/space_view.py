"""View of the path in space of the part that several drives carry together; the mouse turns it."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from core.numerics.derivatives import seen_from
from core.output.drawing.palette import BLUE
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.turning import TurnedByMouse
from kindyna_gui.pictures.units import brief, number
from kindyna_gui.player import Player
from kindyna_gui.requirements import Unavailable
from kindyna_gui.view import View

MM = 1e3
MARGIN = 46.0  # pixels
NO_PART = (
    "No drive of this design carries a part. In the file, give each drive that carries it a direction in space, such as "
    "carries = [0.0, 0.0, 1.0]. This view then draws the path of the part."
)


class PathCanvas(TurnedByMouse, QWidget):
    """Drawing of the path (n, 3) [mm], its shadow, axes through the lowest corner, and the part; a drag turns it."""

    def __init__(self) -> None:
        super().__init__(accessibleName="Path in space")
        self.path = np.zeros((1, 3))
        self.part = np.zeros(3)
        self.text = ""
        self.setMinimumSize(1, 1)
        self.setCursor(Qt.CursorShape.OpenHandCursor)
        self.setToolTip("Drag to turn; double-click for the isometric view")

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) [mm] as complex pixels (n,), imaginary part downwards."""
        low, high = self.path.min(axis=0), self.path.max(axis=0)
        middle = 0.5 * (low + high)
        half = 0.5 * float(np.linalg.norm(high - low)) or 1.0  # for any rotation
        room = min(self.width(), self.height()) / 2.0 - MARGIN
        seen = seen_from(np.atleast_2d(points) - middle, self.turn, self.tilt) * max(room, 1.0) / half
        return np.asarray(complex(self.width(), self.height()) / 2.0 + seen.conj())

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(SCREEN.paper))
        low, high = self.path.min(axis=0), self.path.max(axis=0)
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0))
        for axis, name in enumerate("xyz"):
            end = low.copy()
            end[axis] = max(high[axis], low[axis] + 0.15 * float((high - low).max()))
            origin, tip = (_point(z) for z in self.pixels(np.array([low, end])))
            painter.drawLine(origin, tip)
            direction = tip - origin
            text_at = tip + direction * (16.0 / max(float(np.hypot(direction.x(), direction.y())), 16.0))
            painter.drawText(text_at - QPointF(4.0, -4.0), f"{name} {brief(high[axis] - low[axis], 'mm')}")
        floor = self.path.copy()
        floor[:, 2] = low[2]
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0, Qt.PenStyle.DotLine))
        painter.drawPolygon(_polygon(self.pixels(floor)))
        shadow = self.part.copy()
        shadow[2] = low[2]
        part, below = (_point(z) for z in self.pixels(np.array([self.part, shadow])))
        painter.drawLine(part, below)
        painter.setPen(QPen(QColor(SCREEN.seen(BLUE)), 2.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolygon(_polygon(self.pixels(self.path)))
        painter.setPen(QPen(QColor(SCREEN.ink), 1.4))
        painter.setBrush(QColor(SCREEN.seen(BLUE)))
        painter.drawEllipse(part, 6.0, 6.0)
        painter.drawText(QPointF(10.0, 20.0), self.text)
        painter.end()


class SpaceView(View):
    """Path of the part that the drives carry, and the part at the current machine angle."""

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.canvas = PathCanvas()
        self.set_column(self.canvas, grows=self.canvas)

    def refresh(self, study: Study) -> None:
        if not (self.session.has_several_drives and self.session.shaft.has_transfer_path):
            raise Unavailable(NO_PART)
        self.canvas.path = self.session.shaft.transfer_path * MM

    def follow(self, theta: float) -> None:
        if self.session.has_several_drives and self.session.shaft.has_transfer_path:
            machine = self.player.machine
            self.canvas.part = self.session.shaft.at_theta(np.array([machine])).transfer_path[0] * MM
            at = ", ".join(brief(value, "mm") for value in self.canvas.part.tolist())
            self.canvas.text = f"Machine angle {number(np.rad2deg(machine), 1)}°: {at}"
            self.canvas.update()

    def fit(self) -> None:
        self.canvas.look(*self.canvas.first_view)


def _point(z: complex) -> QPointF:
    return QPointF(z.real, z.imag)


def _polygon(pixels: np.ndarray) -> QPolygonF:
    return QPolygonF([_point(z) for z in pixels])


__all__ = ["NO_PART", "PathCanvas", "SpaceView"]
