"""The lecture's circle diagram, step by step: known centres as solid lines, the wanted one dotted, its two triangles."""

from __future__ import annotations

import cmath
import math

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.instant_centres import Construction, KennedyStep
from core.mechanism import link_number
from kindyna_gui.pictures.drawing.centre_parts import centre_name
from kindyna_gui.pictures.style import BLUE, GREEN, SCREEN, font

_TINTS = (BLUE, GREEN)  # of the two triangles


class Diagram(QWidget):
    """Links as numbers on a circle, centres as lines between them."""

    NUMBER = 11.0  # radius of a number's disc, pixels

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName("Circle diagram")
        self.bodies: tuple[str, ...] = ()
        self.solid: tuple[tuple[str, str], ...] = ()
        self.dotted: tuple[tuple[str, str], ...] = ()
        self.wanted: KennedyStep | None = None

    def sizeHint(self) -> QSize:
        return QSize(220, 200)

    def minimumSizeHint(self) -> QSize:
        return QSize(120, 110)

    def show_step(self, bodies: tuple[str, ...], plan: Construction, step: int) -> None:
        """step: 0 shows what is known at sight; then one centre more each time."""
        self.bodies = bodies
        self.wanted = plan.steps[step - 1] if step else None
        self.solid = (*plan.known, *(w.key for w in plan.steps[: max(step - 1, 0)]))
        self.dotted = tuple(w.key for w in plan.steps[max(step - 1, 0) :])
        self.update()

    def place(self, body: str) -> QPointF:
        """Where a link's number stands; the first at the top, then clockwise [pixels]."""
        part = self.bodies.index(body) / len(self.bodies)
        radius = 0.5 * min(self.width(), self.height()) - self.NUMBER - 4.0
        turn = cmath.rect(radius, 2.0 * math.pi * part - math.pi / 2.0 - math.pi / len(self.bodies))
        return QPointF(self.width() / 2.0 + turn.real, self.height() / 2.0 + turn.imag)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(SCREEN.paper))
        if self.bodies:
            self._paint(painter)
        painter.end()

    def _paint(self, painter: QPainter) -> None:
        middle = QPointF(self.width() / 2.0, self.height() / 2.0)
        radius = abs(complex((self.place(self.bodies[0]) - middle).x(), (self.place(self.bodies[0]) - middle).y()))
        painter.setPen(QPen(QColor(SCREEN.shaft), 1.0))
        painter.drawEllipse(middle, radius, radius)
        if self.wanted is not None:
            for triangle, colour in zip(self.wanted.triangles, _TINTS, strict=False):
                tint = QColor(colour)
                tint.setAlphaF(0.16)
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(tint)
                painter.drawPolygon(QPolygonF([self.place(b) for b in (*self.wanted.key, triangle.third)]))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for keys, pen in (
            (self.dotted, QPen(QColor(SCREEN.quiet), 1.0, Qt.PenStyle.DotLine)),
            (self.solid, QPen(QColor(SCREEN.ink), 1.5)),
        ):
            painter.setPen(pen)
            for key in keys:
                painter.drawLine(self.place(key[0]), self.place(key[1]))
        if self.wanted is not None:
            painter.setPen(QPen(QColor(SCREEN.limit), 2.0, Qt.PenStyle.DotLine))
            painter.drawLine(self.place(self.wanted.key[0]), self.place(self.wanted.key[1]))
        painter.setFont(font(12))
        for body in self.bodies:
            box = QRectF(0.0, 0.0, 2.0 * self.NUMBER, 2.0 * self.NUMBER)
            box.moveCenter(self.place(body))
            painter.setPen(QPen(QColor(SCREEN.ink), 1.0))
            painter.setBrush(QColor(SCREEN.paper))
            painter.drawEllipse(box)
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, str(link_number(body)))


def step_text(plan: Construction, step: int) -> str:
    """A sentence that describes a step."""
    if step == 0:
        names = ", ".join(centre_name(key) for key in plan.known)
        return f"Known at sight, by pins and guides: {names}. Wanted: {len(plan.steps)} more."
    wanted = plan.steps[step - 1]
    lines = [
        f"{centre_name(t.first)}\u2013{centre_name(t.second)} (links {_three(wanted, t.third)})"
        for t in wanted.triangles[:2]
    ]
    return f"{centre_name(wanted.key)} lies on the lines {' and '.join(lines)}: where they cross."


def _three(wanted: KennedyStep, third: str) -> str:
    return ", ".join(str(n) for n in sorted(link_number(body) for body in (*wanted.key, third)))


__all__ = ["Diagram", "step_text"]
