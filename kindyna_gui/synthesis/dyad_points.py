"""Dyads of a task of poses as points that can be clicked: their fixed and moving pivots at the first pose, guides as lines."""

from __future__ import annotations

import cmath
from collections.abc import Sequence

from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen

from core.synthesis import BodyPose, Dyad
from core.synthesis.dyads import GUIDE, TURNING_GUIDE
from kindyna_gui.linkage.snapping import PixelFunction
from kindyna_gui.pictures.style import SCREEN

REACH = 8.0  # distance within which a point is hit, pixels
FIXED_SIZE, MOVING_SIZE = 4.0, 2.6  # half of a fixed pivot's triangle, radius of a moving pivot, pixels
HINT = "Click two dyads: their linkage is a card; a second click or Esc releases a dyad"


class DyadPoints(QObject):
    """Dyads at the first pose. Fixed pivots are triangles, moving ones dots; the mouse on either one shows the link between them.

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

    def show_dyads(self, dyads: Sequence[Dyad], pose: BodyPose | None) -> None:
        """Show dyads at a pose; a chosen one stays chosen where it is among them."""
        self.dyads, self._pose = tuple(dyads) if pose is not None else (), pose or self._pose
        self.chosen = [dyad for dyad in self.chosen if dyad in self.dyads]
        self._hovered = None
        self.changed.emit()

    def points(self, dyad: Dyad) -> tuple[complex, complex]:
        """Fixed and moving pivot of a dyad at the pose [mm]; of a sliding one the fixed or the moving point of its line."""
        return dyad.fixed, dyad.moving_at(self._pose)

    # -- mouse and keys -----------------------------------------------------------------------------------

    def dyad_at(self, pixel: QPointF, to: PixelFunction) -> Dyad | None:
        """The dyad with a pivot under the mouse, else the one whose line is there."""
        best, result = REACH, None
        for dyad in self.dyads:
            for z in self.points(dyad):
                d = to(z) - pixel
                distance = abs(complex(d.x(), d.y()))
                if distance < best:
                    best, result = distance, dyad
        if result is None:
            result = next((dyad for dyad in self.dyads if self._distance_to_line(dyad, pixel, to) < 0.5 * REACH), None)
        return result

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
        for dyad in self.dyads:
            self._paint_dyad(painter, to, dyad, quiet, middle, reach)
        if self._hovered is not None:
            self._paint_dyad(painter, to, self._hovered, ink, middle, reach, with_link=True)
        for dyad in self.chosen:
            self._paint_dyad(painter, to, dyad, chosen, middle, reach, with_link=True)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_dyad(
        self,
        painter: QPainter,
        to: PixelFunction,
        dyad: Dyad,
        colour: QColor,
        middle: complex,
        reach: float,
        *,
        with_link: bool = False,
    ) -> None:
        fixed, moving = self.points(dyad)
        line = dyad.line_at(self._pose)
        if line is not None:
            at, along = line[0], cmath.rect(1.0, line[1])
            length = reach + abs(at - middle)
            painter.setPen(QPen(colour, 1.5 if with_link else 1.0, Qt.PenStyle.DashLine))
            painter.drawLine(to(at - length * along), to(at + length * along))
        if with_link:
            painter.setPen(QPen(colour, 3.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawLine(to(fixed), to(moving))
        grow = 1.5 if with_link else 1.0
        painter.setPen(QPen(colour, 1.0))
        painter.setBrush(colour if with_link else QColor(SCREEN.paper))
        if dyad.kind != GUIDE:
            p, size = to(fixed), FIXED_SIZE * grow
            painter.drawPolygon(
                [QPointF(p.x(), p.y() - size), QPointF(p.x() - size, p.y() + size), QPointF(p.x() + size, p.y() + size)]
            )
        if dyad.kind != TURNING_GUIDE:
            painter.setBrush(colour)
            painter.drawEllipse(to(moving), MOVING_SIZE * grow, MOVING_SIZE * grow)
