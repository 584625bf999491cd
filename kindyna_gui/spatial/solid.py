"""Shaded picture of a cam in space with its rollers; the mouse turns it, and facets are painted from far to near."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from core.numerics.derivatives import seen_from
from core.spatial.picture import FLANK, ROLLER, Facets
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.turning import TurnedByMouse
from kindyna_gui.spatial.colours import shaded_brushes

MARGIN = 26.0  # pixels
OBLIQUE = (35.0, 25.0)  # turn and tilt [deg] with which it opens
LIGHT = np.array([-0.35, 0.55, 0.76])  # towards the light: right, up, towards the viewer
MM = 1e3


class SolidCanvas(TurnedByMouse, QWidget):
    """Picture of the cam and its rollers at a cam angle, which a drag turns."""

    turn, tilt = first_view = OBLIQUE

    def __init__(self) -> None:
        super().__init__(accessibleName="Cam in space")
        self.cam: Facets | None = None
        self.rollers: Facets | None = None
        self.angle = 0.0  # of the cam about z [rad]
        self.limit = np.pi / 4.0  # pressure angle whose colour is the last one [rad]
        self.setMinimumSize(1, 1)
        self.setCursor(Qt.CursorShape.OpenHandCursor)
        self.setToolTip("Drag to turn; double-click for the first view")

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(SCREEN.paper))
        if self.cam is not None and self.rollers is not None:
            self._paint(painter)
        painter.end()

    def _paint(self, painter: QPainter) -> None:
        """Paint the facets that face the viewer, the farthest first."""
        assert self.cam is not None
        assert self.rollers is not None
        cam = self.cam.moved(self.angle)
        corners = np.concatenate((cam.corners, self.rollers.corners)) * MM
        normals = np.concatenate((cam.normals, self.rollers.normals))
        sort = np.concatenate((cam.sort, self.rollers.sort))
        pressure = np.concatenate((cam.pressure_angle, self.rollers.pressure_angle))
        directions = [seen_from(axis, self.turn, self.tilt) for axis in np.eye(3)[:, None]]
        right, up = (
            np.array([complex(d[0]).real for d in directions]),
            np.array([complex(d[0]).imag for d in directions]),
        )
        towards = np.cross(right, up)
        facing = normals @ towards > 1e-6
        corners, normals, sort, pressure = corners[facing], normals[facing], sort[facing], pressure[facing]
        order = np.argsort((corners @ towards).mean(axis=1), kind="stable")
        pixels = self._pixels(corners.reshape(-1, 3)).reshape(-1, 4)
        brightness = np.clip(normals @ (LIGHT[0] * right + LIGHT[1] * up + LIGHT[2] * towards), 0.0, 1.0)
        colours = shaded_brushes(sort == FLANK, sort == ROLLER, pressure / self.limit, brightness)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        last: QBrush | None = None
        for k in order.tolist():
            brush = colours[k]
            if brush is not last:
                painter.setBrush(brush)
                painter.setPen(QPen(brush.color(), 1.0))
                last = brush
            painter.drawPolygon(QPolygonF([QPointF(z.real, z.imag) for z in pixels[k].tolist()]))

    def _pixels(self, points: np.ndarray) -> np.ndarray:
        """Pixels (n,) complex of points (n, 3) [mm], of the same size in any direction and at any cam angle."""
        assert self.cam is not None
        assert self.rollers is not None
        both = np.concatenate((self.cam.corners, self.rollers.corners)).reshape(-1, 3) * MM
        reach, low, high = float(np.hypot(both[:, 0], both[:, 1]).max()), both[:, 2].min(), both[:, 2].max()
        half = float(np.hypot(reach, 0.5 * (high - low)))
        scale = max(min(self.width(), self.height()) / 2.0 - MARGIN, 1.0) / half
        seen = seen_from(points - np.array([0.0, 0.0, 0.5 * (low + high)]), self.turn, self.tilt)
        return np.asarray(0.5 * complex(self.width(), self.height()) + scale * seen.conj())
