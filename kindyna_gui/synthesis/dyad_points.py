"""Dyads of a task of poses as points that can be clicked: their fixed and moving pivots at the first pose, guides as lines."""

from __future__ import annotations

import cmath
from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from core.synthesis import BodyPose, Dyad
from core.synthesis.dyads import GUIDE, TURNING_GUIDE
from kindyna_gui.linkage.snapping import PixelFunction
from kindyna_gui.pictures.style import SCREEN

REACH = 8.0  # distance within which a point is hit, pixels
FIXED_SIZE, MOVING_SIZE = 2.5, 2.2  # half of a fixed pivot's square, radius of a moving pivot, pixels
MARKED_SIZE = 6.0  # half of the triangle of a fixed pivot that is marked, pixels
HINT = "Click two dyads: their linkage is a card; a second click or Esc releases a dyad"


class DyadPoints(QObject):
    """Dyads at the first pose. Fixed pivots are squares, moving ones dots; the mouse on either one shows the link between them.

    Attributes
    ----------
    dyads : tuple of Dyad
    chosen : list of Dyad
        The first of a pair, while the second one is not chosen.

    Signals: ``paired`` with two dyads when the second one is clicked; ``changed`` when it must be painted again.
    """

    paired = Signal(object, object)
    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.dyads: tuple[Dyad, ...] = ()
        self.chosen: list[Dyad] = []
        self._pose = BodyPose(0.0, 0.0)
        self._hovered: Dyad | None = None
        self._pivots = np.empty((0, 2), dtype=complex)  # fixed and moving one of each dyad [mm]

    def show_dyads(self, dyads: Sequence[Dyad], pose: BodyPose | None) -> None:
        """Show dyads at a pose; a chosen one stays chosen where it is among them."""
        self.dyads, self._pose = tuple(dyads) if pose is not None else (), pose or self._pose
        self.chosen = [dyad for dyad in self.chosen if dyad in self.dyads]
        self._hovered = None
        self._pivots = np.array([self.points(dyad) for dyad in self.dyads])
        self.changed.emit()

    def points(self, dyad: Dyad) -> tuple[complex, complex]:
        """Fixed and moving pivot of a dyad at the pose [mm]; of a sliding one the fixed or the moving point of its line."""
        return dyad.fixed, dyad.moving_at(self._pose)

    # -- mouse and keys -----------------------------------------------------------------------------------

    def dyad_at(self, pixel: QPointF, to: PixelFunction) -> Dyad | None:
        """The dyad with a pivot under the mouse, else the one whose line is there."""
        if not self.dyads:
            return None
        distance = np.abs(_pixels(self._pivots, to) - complex(pixel.x(), pixel.y()))
        nearest = int(distance.argmin())
        if distance.flat[nearest] < REACH:
            return self.dyads[nearest // 2]
        return next((dyad for dyad in self.dyads if self._distance_to_line(dyad, pixel, to) < 0.5 * REACH), None)

    def _distance_to_line(self, dyad: Dyad, pixel: QPointF, to: PixelFunction) -> float:
        line = dyad.line_at(self._pose)
        if line is None:
            return float("inf")
        start, end = to(line[0]), to(line[0] + cmath.rect(1.0, line[1]))
        along = complex(end.x() - start.x(), end.y() - start.y())
        d = complex(pixel.x() - start.x(), pixel.y() - start.y())
        return abs((along.conjugate() * d).imag) / abs(along)

    def hover(self, pixel: QPointF, to: PixelFunction) -> None:
        """Show the link of the dyad under the mouse."""
        dyad = self.dyad_at(pixel, to)
        if dyad != self._hovered:
            self._hovered = dyad
            self.changed.emit()

    def click(self, pixel: QPointF, to: PixelFunction) -> bool:
        """Choose the dyad under the mouse, or release it where it is chosen; False where there is none."""
        dyad = self.dyad_at(pixel, to)
        if dyad is None:
            return False
        if dyad in self.chosen:
            self.chosen.remove(dyad)
        elif self.chosen:
            first = self.chosen.pop()
            self.paired.emit(first, dyad)
        else:
            self.chosen.append(dyad)
        self.changed.emit()
        return True

    def release(self) -> bool:
        """Release the chosen dyad; False where none is chosen."""
        was_chosen = bool(self.chosen)
        self.chosen.clear()
        if was_chosen:
            self.changed.emit()
        return was_chosen

    # -- painting -----------------------------------------------------------------------------------------

    def paint(self, painter: QPainter, to: PixelFunction, visible: QRectF) -> None:
        """Paint all dyads, the chosen one and the one under the mouse with its link."""
        middle = complex(visible.center().x(), visible.center().y())
        reach = abs(complex(visible.width(), visible.height()))
        quiet, ink, chosen = (QColor(colour) for colour in (SCREEN.quiet, SCREEN.ink, SCREEN.chosen))
        if self.dyads:
            self._paint_pivots(painter, to, quiet)
        for dyad in self.dyads:
            self._paint_line(painter, to, dyad, QPen(quiet, 1.0, Qt.PenStyle.DashLine), middle, reach)
        if self._hovered is not None:
            self._paint_marked(painter, to, self._hovered, ink, middle, reach)
        for dyad in self.chosen:
            self._paint_marked(painter, to, dyad, chosen, middle, reach)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_pivots(self, painter: QPainter, to: PixelFunction, colour: QColor) -> None:
        """Paint the pivots of all dyads at once."""
        pixels = _pixels(self._pivots, to)
        kinds = np.array([dyad.kind for dyad in self.dyads])
        rows = (
            (pixels[kinds != GUIDE, 0], FIXED_SIZE, Qt.PenCapStyle.SquareCap),
            (pixels[kinds != TURNING_GUIDE, 1], MOVING_SIZE, Qt.PenCapStyle.RoundCap),
        )
        for points, size, cap in rows:  # points of a wide pen: triangles take ten times as long
            painter.setPen(QPen(colour, 2.0 * size, Qt.PenStyle.SolidLine, cap))
            painter.drawPoints(QPolygonF([QPointF(z.real, z.imag) for z in points.tolist()]))

    def _paint_line(
        self, painter: QPainter, to: PixelFunction, dyad: Dyad, pen: QPen, middle: complex, reach: float
    ) -> None:
        line = dyad.line_at(self._pose)
        if line is not None:
            at, along = line[0], cmath.rect(1.0, line[1])
            length = reach + abs(at - middle)
            painter.setPen(pen)
            painter.drawLine(to(at - length * along), to(at + length * along))

    def _paint_marked(
        self, painter: QPainter, to: PixelFunction, dyad: Dyad, colour: QColor, middle: complex, reach: float
    ) -> None:
        """Paint a dyad that is chosen or under the mouse: its link, its pivots larger."""
        fixed, moving = map(to, self.points(dyad))
        self._paint_line(painter, to, dyad, QPen(colour, 1.5, Qt.PenStyle.DashLine), middle, reach)
        painter.setPen(QPen(colour, 3.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(fixed, moving)
        painter.setPen(QPen(colour, 1.0))
        painter.setBrush(colour)
        if dyad.kind != GUIDE:
            painter.drawPolygon(_triangle(complex(fixed.x(), fixed.y()), MARKED_SIZE))
        if dyad.kind != TURNING_GUIDE:
            painter.drawEllipse(moving, 4.0, 4.0)


def _pixels(z: np.ndarray, to: PixelFunction) -> np.ndarray:
    """Pixels x + iy of positions [mm]; the mapping is linear."""
    origin, x_unit, y_unit = (complex(p.x(), p.y()) for p in map(to, (0j, 1.0 + 0j, 1j)))
    return origin + z.real * (x_unit - origin) + z.imag * (y_unit - origin)


def _triangle(z: complex, size: float) -> QPolygonF:
    corners = ((0.0, -size), (-size, size), (size, size), (0.0, -size))
    return QPolygonF([QPointF(z.real + x, z.imag + y) for x, y in corners])
