"""The pinned variant behind the machine: its cam and links as lines in one grey, at the angle at hand."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen, QPolygonF, QTransform

from core.errors import KindynaError
from core.mechanism.kinematics import FRAME
from core.study import Study
from kindyna_gui.pictures.shapes import joined, outline
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.turn import nearest

MM = 1e3
WIDTH = 1.0  # pixels; Qt takes many times as long for wider lines


class Ghost:
    """Made of one study; lines at an angle in mm, y upwards."""

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def _outline(self) -> QPainterPath:
        """Of the cam in its own frame."""
        assert self.study.shape is not None
        return joined(*(outline(MM * flank.profile) for flank in self.study.shape.flanks))

    def path(self, theta: float) -> QPainterPath:
        """Outline of the cam, what touches it, links as lines between their points; empty where there is no position."""
        path = QPainterPath()
        try:
            kinematics, shape = self.study.linkage, self.study.shape
        except KindynaError:
            return path
        at = nearest(self.study.theta, theta)
        for name, pose in kinematics.bodies.items():
            points = [
                complex(np.broadcast_to(pose.position(point), self.study.theta.shape)[at]) for point in pose.points
            ]
            if name != FRAME and len(points) > 1:
                path.addPolygon(_polygon(points + points[:1]))
        if shape is not None:
            turned = QTransform().rotate(self.study.sense * float(np.rad2deg(self.study.theta[at])))
            path.addPath(turned.map(self._outline))
            if radius := MM * shape.flank.radius:
                centre = MM * complex(shape.reference[at])
                path.addEllipse(QPointF(centre.real, centre.imag), radius, radius)
        return path


def _polygon(points: list[complex]) -> QPolygonF:
    return QPolygonF([QPointF(MM * p.real, MM * p.imag) for p in points])


def paint_ghost(painter: QPainter, ghost: Ghost, theta: float, view: QTransform) -> None:
    """In pixels of a view whose scene is in mm."""
    colour = QColor(SCREEN.quiet)
    colour.setAlpha(150)
    painter.setPen(QPen(colour, WIDTH))
    painter.setBrush(QColor(0, 0, 0, 0))
    painter.drawPath(view.map(ghost.path(theta)))


__all__ = ["Ghost", "paint_ghost"]
