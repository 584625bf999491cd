"""Painting of a task and of an answer, in pixels: frames of the body, pivots and their lines, the area, the path, the moving linkage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF, QTransform

from core.frozen import frozen
from core.synthesis import Task
from core.synthesis.task import MOVING, PATH
from kindyna_gui.linkage.snapping import PixelFunction
from kindyna_gui.pictures.shapes import curve, fit_transform
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.synthesis.task_parts import (
    AREA,
    LINE,
    PIVOT,
    POINT,
    POSE,
    Part,
    corners,
    direction,
    parts_of,
    position,
)

ARM = 42.0  # length of a frame's arm, pixels
DOT = 2.0  # radius of a point of a path, pixels
MARGIN = 5.0  # around the small image of a linkage, pixels
MOST_DOTS = 400  # a path of more points is drawn without them
LINKS = (("O2", "A"), ("A", "B"), ("B", "O4"))
Positions = Mapping[str, np.ndarray]
"""Name of a point -> its positions (n,) [mm] while the driver passes its turn, or its range."""


@frozen
class SheetPainter:
    """Paints a task; ``to`` maps mm to pixels, ``visible`` is the visible region [mm], ``selected`` a part in the colour of selection."""

    to: PixelFunction
    visible: QRectF
    selected: Part | None = None

    def paint(self, painter: QPainter, task: Task) -> None:
        """Paint the parts of a task, the area below all others."""
        if task.path is not None and task.path.points and task.kind == PATH:
            self._paint_path(painter, task)
        for part in sorted(parts_of(task), key=lambda part: (AREA, LINE, PIVOT, POSE, POINT).index(part.kind)):
            colour = QColor(SCREEN.chosen if part == self.selected else SCREEN.ink)
            if part.kind == AREA:
                self._paint_area(painter, task, colour)
            elif part.kind == POSE:
                self._paint_frame(painter, task, part, colour)
            elif part.kind in (PIVOT, LINE):
                self._paint_pivot(painter, task, part, colour)
            elif part == self.selected:
                painter.setPen(QPen(colour, 2.0))
                painter.drawEllipse(self.to(position(task, part)), 6.0, 6.0)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def arm_end(self, task: Task, part: Part) -> QPointF:
        """Pixel of the end of a part's arm."""
        return self._shifted(self.to(position(task, part)), ARM * direction(task, part))

    @staticmethod
    def _shifted(at: QPointF, d: complex) -> QPointF:
        return QPointF(at.x() + d.real, at.y() - d.imag)

    def _paint_frame(self, painter: QPainter, task: Task, part: Part, colour: QColor) -> None:
        at, x_axis = self.to(position(task, part)), direction(task, part)
        painter.setPen(QPen(colour, 2.0))
        painter.drawLine(at, self.arm_end(task, part))
        painter.drawLine(at, self._shifted(at, 0.6j * ARM * x_axis))
        painter.setBrush(colour)
        painter.drawEllipse(self.arm_end(task, part), 3.5, 3.5)
        painter.setBrush(QColor(SCREEN.paper))
        painter.drawEllipse(at, 4.5, 4.5)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawText(QPointF(at.x() - 14.0, at.y() + 16.0), str(part.index + 1))

    def _paint_pivot(self, painter: QPainter, task: Task, part: Part, colour: QColor) -> None:
        """Paint a pivot: a fixed one on its triangle, a moving one as a circle with a dot; with its line, and the number of its dyad."""
        pivot, at = task.pivots[part.index], self.to(position(task, part))
        is_moving = pivot.of == MOVING
        if part.kind == LINE:
            self._paint_line(painter, task, part, colour)
        painter.setPen(QPen(colour, 1.5))
        painter.setBrush(QColor(SCREEN.paper))
        if not is_moving and part.kind == PIVOT:
            painter.drawPolygon([at, QPointF(at.x() - 9.0, at.y() + 15.0), QPointF(at.x() + 9.0, at.y() + 15.0)])
        painter.drawEllipse(at, *(2 * [5.5 if is_moving else 4.0]))
        if is_moving:
            painter.setBrush(colour)
            painter.drawEllipse(at, 1.5, 1.5)
        name = "both" if pivot.dyad is None else str(pivot.dyad)
        painter.drawText(QPointF(at.x() + 12.0, at.y() + 15.0), f"{'moving' if is_moving else 'fixed'} {name}")

    def _paint_line(self, painter: QPainter, task: Task, part: Part, colour: QColor) -> None:
        """Paint the line of a pivot through the visible region, and the arm that turns it."""
        z, along = position(task, part), direction(task, part)
        reach = abs(complex(self.visible.width(), self.visible.height())) + abs(
            z - complex(self.visible.center().x(), self.visible.center().y())
        )
        pen = QPen(colour, 1.2)
        pen.setDashPattern([10.0, 4.0, 2.0, 4.0])
        painter.setPen(pen)
        painter.drawLine(self.to(z - reach * along), self.to(z + reach * along))
        painter.setPen(QPen(colour, 1.5))
        painter.setBrush(colour)
        painter.drawEllipse(self.arm_end(task, part), 3.5, 3.5)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_area(self, painter: QPainter, task: Task, colour: QColor) -> None:
        assert task.area is not None
        places = [self.to(z) for z in corners(task.area).values()]
        shade = QColor(SCREEN.chosen)
        shade.setAlpha(22)
        painter.setPen(QPen(colour, 1.2, Qt.PenStyle.DashLine))
        painter.setBrush(shade)
        painter.drawPolygon(QPolygonF(places))
        painter.setPen(QPen(colour, 1.2))
        painter.setBrush(QColor(SCREEN.paper))
        for place in places:
            painter.drawRect(QRectF(place.x() - 3.5, place.y() - 3.5, 7.0, 7.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        top_left = self.to(corners(task.area)["high left"])
        painter.drawText(QPointF(top_left.x() + 8.0, top_left.y() + 16.0), "fixed pivots")

    def _paint_path(self, painter: QPainter, task: Task) -> None:
        assert task.path is not None
        places = [self.to(complex(p.x_mm, p.y_mm)) for p in task.path.points]
        painter.setPen(QPen(QColor(SCREEN.ink), 1.5))
        painter.drawPolyline([*places, places[0]] if task.path.closed else places)
        if len(places) <= MOST_DOTS:
            painter.setBrush(QColor(SCREEN.ink))
            for place in places:
                painter.drawEllipse(place, DOT, DOT)
        painter.setBrush(Qt.BrushStyle.NoBrush)


def paint_stroke(painter: QPainter, to: PixelFunction, stroke: Sequence[complex]) -> None:
    """Paint a line that is being drawn by hand."""
    painter.setPen(QPen(QColor(SCREEN.chosen), 1.5))
    painter.drawPolyline([to(z) for z in stroke])


# -- an answer ---------------------------------------------------------------------------------------------------


def paint_answer(painter: QPainter, view: QTransform, positions: Positions, step: int, small: bool = False) -> None:
    """Paint a linkage at one of its positions, with the path of its point P; ``small``: with thin lines, for a card.

    ``view`` maps mm to pixels.
    """
    ink, quiet, chosen = (QColor(colour) for colour in (SCREEN.ink, SCREEN.quiet, SCREEN.chosen))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if "P" in positions:
        painter.setPen(QPen(chosen, 1.0, Qt.PenStyle.SolidLine if small else Qt.PenStyle.DotLine))
        painter.drawPath(view.map(curve(positions["P"])))
    if "B" in positions and "O4" not in positions:  # the line on which its block slides
        z = positions["B"]
        painter.setPen(QPen(quiet, 1.0, Qt.PenStyle.DashLine))
        painter.drawPath(view.map(curve(np.array([z[0], max(z, key=lambda p: abs(p - z[0]))]))))
    points = {name: z[step % z.size] for name, z in positions.items()}
    now = {name: view.map(QPointF(z.real, z.imag)) for name, z in points.items()}
    painter.setPen(QPen(ink if small else quiet, 1.5 if small else 3.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    for first, second in LINKS:
        if first in now and second in now:
            painter.drawLine(now[first], now[second])
    if "B" not in now and "O4" in now:  # the coupler slides through its pivot
        painter.drawLine(now["A"], now["O4"])
    painter.setPen(QPen(quiet, 1.0))
    for name in ("A", "B"):
        if name in now and "P" in now:
            painter.drawLine(now[name], now["P"])
    painter.setBrush(QColor(SCREEN.paper))
    for name, place in now.items():
        radius = (2.5 if small else 5.0) if name.startswith("O") else 1.5 if small else 3.5
        painter.setPen(QPen(chosen if name == "P" else ink, 1.0 if small else 1.5))
        painter.drawEllipse(place, radius, radius)
    painter.setBrush(Qt.BrushStyle.NoBrush)


class AnswerPicture:
    """Small image of a linkage at any of its positions."""

    def __init__(self, positions: Positions) -> None:
        self._positions = positions

    def __call__(self, size: QSize, ratio: float, step: int) -> QImage:
        """Image of this size in pixels at one position."""
        image = QImage(size * ratio, QImage.Format.Format_RGB32)
        image.setDevicePixelRatio(ratio)
        image.fill(QColor(SCREEN.paper))
        view = fit_transform(np.concatenate(list(self._positions.values())), size, MARGIN)
        painter = QPainter(image)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        paint_answer(painter, view, self._positions, step, small=True)
        painter.end()
        return image
