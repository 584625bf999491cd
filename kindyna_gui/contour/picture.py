"""The curve of a drawing with the path of the follower's round and the places where velocity or acceleration jumps; and the motion
over the cam angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QSize
from PySide6.QtGui import QPainter, QPaintEvent, QTransform
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.contour import ContourElement, TracedMotion
from core.design import UNITS, require_motion
from core.motion import program
from kindyna_gui.pictures.plots.ranges import shown_range
from kindyna_gui.pictures.plots.xy import WHOLE_TURN, Dots, Line, XYPlot
from kindyna_gui.pictures.shapes import at, circle, outline, segments
from kindyna_gui.pictures.style import CHAIN, OUTLINE, SCREEN, THIN, brush, no_pen
from kindyna_gui.pictures.units import readable

DRAWN = 97  # points of an arc
MARGIN = 18  # pixels
DOT, CROSS = 3.0, 5.0  # radius of a jump's mark, half the size of the cam centre's, pixels
MARK = 8.0  # of a jump in the plot, pixels
SMOOTH = np.linspace(0.0, 360.0, 2881)  # where the motion is drawn


def points(elements: Sequence[ContourElement]) -> np.ndarray:
    """A chain of lines and arcs as points (n,) that a picture needs."""
    return np.concatenate([each.at(np.linspace(0.0, 1.0, 2 if each.is_line else DRAWN)) for each in elements])


class CurvePicture(QWidget):
    """The curve at cam angle 0, mm upwards and to the right."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._traced: TracedMotion | None = None
        self._chosen: int | None = None
        self._curve = self._path = np.zeros(0, dtype=complex)
        self.setAccessibleName("The drawn curve, and the follower on it")
        self.setMinimumSize(240, 240)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(380, 380)

    def show_traced(self, traced: TracedMotion | None) -> None:
        """The curve that was read; None: nothing."""
        self._traced, self._chosen = traced, None
        if traced is not None:
            self._curve, self._path = points(traced.contour.elements), points(traced.path)
        self.update()

    def point_out(self, jump: int | None) -> None:
        """The follower's round where a jump is."""
        self._chosen = jump
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), brush(SCREEN.paper))
        if self._traced is not None:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self._draw(painter, self._traced)

    def _draw(self, painter: QPainter, traced: TracedMotion) -> None:
        radius = traced.design.drive.face.radius_mm
        mm, size = self._scale(radius)
        if radius:
            painter.setPen(SCREEN.pen(SCREEN.quiet, THIN, CHAIN))
            painter.drawPath(mm.map(outline(self._path)))
        painter.setPen(SCREEN.pen(SCREEN.ink, OUTLINE))
        painter.drawPath(mm.map(outline(self._curve)))
        painter.setPen(SCREEN.pen(SCREEN.quiet, THIN))
        middle = mm.map(QPointF(0.0, 0.0))
        place = complex(middle.x(), middle.y())
        painter.drawPath(segments([(place - CROSS, place + CROSS), (place - 1j * CROSS, place + 1j * CROSS)]))
        if self._chosen is not None and self._chosen < len(traced.jumps):
            chosen = mm.map(at(traced.jumps[self._chosen].place))
            painter.strokePath(
                circle(max(radius * size, 2.0 * DOT), complex(chosen.x(), chosen.y())),
                SCREEN.pen(SCREEN.limit, OUTLINE),
            )
        painter.setPen(no_pen())
        for jump in traced.jumps:
            painter.setBrush(brush(SCREEN.limit if jump.order == 1 else SCREEN.family("acceleration")))
            painter.drawEllipse(mm.map(at(jump.place)), DOT, DOT)

    def _scale(self, radius: float) -> tuple[QTransform, float]:
        """From mm, y upwards, to pixels, with room for the round all around; and pixels to the millimetre."""
        z = np.concatenate((self._curve, self._path, [0.0]))
        room = complex(radius, radius) if radius else 0j
        low, high = complex(z.real.min(), z.imag.min()) - room, complex(z.real.max(), z.imag.max()) + room
        size, middle = high - low, 0.5 * (low + high)
        scale = min((self.width() - 2 * MARGIN) / size.real, (self.height() - 2 * MARGIN) / size.imag)
        made = QTransform().translate(0.5 * self.width(), 0.5 * self.height())
        return made.scale(scale, -scale).translate(-middle.real, -middle.imag), scale


def show_motion(plot: XYPlot, traced: TracedMotion) -> None:
    """The motion that comes of a curve over one turn, with a dot where velocity or acceleration jumps."""
    motion = require_motion(traced.design)
    compiled = program(motion)
    angles = np.array([jump.angle for jump in traced.jumps], dtype=float)
    heights = [compiled.state(compiled.angles(np.deg2rad(a))).y[0] / motion.scale for a in (SMOOTH, angles)]
    rung = readable(UNITS[motion.unit].symbol, float(np.abs(heights[0]).max()))
    colour = SCREEN.family("displacement")
    plot.name_axes("Cam angle, °", f"Displacement, {rung.symbol}", colour)
    colours = [SCREEN.limit if jump.order == 1 else SCREEN.family("acceleration") for jump in traced.jumps]
    curve = Line(SMOOTH, heights[0] / rung.size, colour)
    plot.show_lines([curve], dots=[Dots(angles, heights[1] / rung.size, colours, MARK)])
    plot.point_out(None)
    plot.show_range(WHOLE_TURN, shown_range([curve.y], {"displacement"}, ()))


__all__ = ["CurvePicture", "points", "show_motion"]
