"""Shaded picture of a cam in space with its rollers; the mouse turns it, and facets are painted from far to near."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPaintEvent, QPolygonF
from PySide6.QtWidgets import QWidget
from shiboken6 import VoidPtr

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
        self._middle, self._half = np.zeros(3), 1.0  # of what the picture shows [mm]
        self.limit = np.pi / 4.0  # pressure angle whose colour is the last one [rad]
        self._polygons: list[QPolygonF] = []  # one for each facet, used again in every picture
        self._memory: list[np.ndarray] = []
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
        self._reserve(len(pixels))
        brightness = np.clip(normals @ (LIGHT[0] * right + LIGHT[1] * up + LIGHT[2] * towards), 0.0, 1.0)
        colours = shaded_brushes(sort == FLANK, sort == ROLLER, pressure / self.limit, brightness)
        # without antialiasing neighbours share their edges without seams, so that facets need no outlines
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.setPen(Qt.PenStyle.NoPen)
        last: QBrush | None = None
        for polygon, memory, row, brush in zip(
            self._polygons, self._memory, pixels[order], (colours[k] for k in order.tolist()), strict=False
        ):
            if brush is not last:
                painter.setBrush(brush)
                last = brush
            memory[:] = row
            painter.drawPolygon(polygon)

    def _reserve(self, count: int) -> None:
        """Keep at least this many quadrangles, whose corners are written where they are."""
        for _ in range(count - len(self._polygons)):
            polygon = QPolygonF()
            polygon.resize(4)
            memory: Any = VoidPtr(polygon.data(), 64, True)  # type: ignore[arg-type, call-arg]
            self._polygons.append(polygon)
            self._memory.append(np.frombuffer(memory, dtype=complex))

    def frame(self, poses: Sequence[Facets]) -> None:
        """Fit the picture to the cam at every angle, and to its rollers in some poses, seen from any direction."""
        assert self.cam is not None
        x, y, z = np.concatenate([self.cam.corners, *(pose.corners for pose in poses)]).reshape(-1, 3).T * MM
        reach = float(np.hypot(self.cam.corners[..., 0], self.cam.corners[..., 1]).max()) * MM
        low = np.array([min(x.min(), -reach), min(y.min(), -reach), z.min()])
        high = np.array([max(x.max(), reach), max(y.max(), reach), z.max()])
        self._middle, self._half = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))

    def _pixels(self, points: np.ndarray) -> np.ndarray:
        """Pixels (n,) complex of points (n, 3) [mm]."""
        scale = max(min(self.width(), self.height()) / 2.0 - MARGIN, 1.0) / self._half
        seen = seen_from(points - self._middle, self.turn, self.tilt)
        return np.asarray(0.5 * complex(self.width(), self.height()) + scale * seen.conj())
