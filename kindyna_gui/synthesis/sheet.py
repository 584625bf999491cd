"""Sheet on which a task is drawn: frames of a body that are pressed and turned, a path, and an answer that moves over it."""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from math import degrees, floor, log10, pi, radians

import numpy as np
from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QWheelEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.synthesis import BodyPose, PathPoint
from kindyna_gui.pictures.style import SCREEN

ARM, REACH, TURNS = (
    42.0,
    11.0,
    8.0,
)  # pixels: length of a frame's arm, reach of the mouse, drag from which a frame turns
FIRST_SCALE, LEAST_SCALE, MOST_SCALE = 2.5, 1e-3, 1e4  # pixels per mm
GRID_PIXELS = 45.0  # least distance of two lines
ZOOM = 1.2
PATH_POINTS = 36
"""Points of a path drawn by hand, evenly spaced by length."""
CLOSES = 0.12  # of the size: a path whose end is nearer to its start is closed
MOST_POSES = 5
LINKS = (("O2", "A"), ("A", "B"), ("B", "O4"))


class TaskSheet(QWidget):
    """Poses or a path, drawn with the mouse, and the points of an answer.

    Press at an empty place and drag to put and turn a frame; drag its origin to move it, the end of its arm to turn it; Delete removes
    the selected one. With Shift a press puts a fixed pivot, which can be dragged too. A path is drawn in one stroke. The wheel zooms,
    the right or middle button moves the sheet. Signals:
    ``poses_changed``, ``pivots_changed``, and ``path_changed`` with whether the path is closed.
    """

    poses_changed = Signal()
    pivots_changed = Signal()
    path_changed = Signal(bool)

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Sheet of the task")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setCursor(Qt.CursorShape.CrossCursor)
        self.poses: list[BodyPose] = []
        self.pivots: list[complex | None] = [None, None]
        self.points: list[PathPoint] = []
        self.draws_path = self.is_passive = False
        self.closed = False
        self.chosen = -1
        self.hint = ""
        self._scale, self._middle = FIRST_SCALE, 0j  # pixels per mm; the place in the centre [mm]
        self._drag: str = ""
        self._pivot = -1
        self._pressed = QPointF()
        self._stroke: list[complex] = []
        self._answer: Mapping[str, np.ndarray] = {}
        self._step = 0

    def sizeHint(self) -> QSize:
        return QSize(560, 380)

    def minimumSizeHint(self) -> QSize:
        return QSize(320, 220)

    # -- contents -----------------------------------------------------------------------------------------

    def show_task(self, poses: Sequence[BodyPose], points: Sequence[PathPoint], closed: bool) -> None:
        """Show the frames and the path of a task."""
        self.poses, self.points, self.closed = list(poses), list(points), closed
        self.chosen = min(self.chosen, len(self.poses) - 1)
        self.update()

    def show_answer(self, positions: Mapping[str, np.ndarray]) -> None:
        """Show the points (n,) [mm] of an answer, as of ``joint_positions``; none where the mapping is empty."""
        self._answer = positions
        self.update()

    def show_step(self, step: int) -> None:
        """Show the answer at another of its positions."""
        self._step = step
        if self._answer:
            self.update()

    def fit(self) -> None:
        """Show the full task, and the answer."""
        z = (
            [pose.z for pose in self.poses]
            + [pivot for pivot in self.pivots if pivot is not None and not self.draws_path]
            + [complex(p.x_mm, p.y_mm) for p in self.points]
        )
        z += [complex(p) for positions in self._answer.values() for p in positions[:: max(1, positions.size // 24)]]
        if not z:
            return
        x, y = [p.real for p in z], [p.imag for p in z]
        wide, high = max(max(x) - min(x), 20.0), max(max(y) - min(y), 20.0)
        self._middle = complex(0.5 * (max(x) + min(x)), 0.5 * (max(y) + min(y)))
        room = 2.0 * ARM
        self._scale = max(LEAST_SCALE, min((self.width() - room) / wide, (self.height() - room) / high))
        self.update()

    # -- places -------------------------------------------------------------------------------------------

    def at(self, z: complex) -> QPointF:
        """Pixel of a point [mm]."""
        d = (z - self._middle) * self._scale
        return QPointF(0.5 * self.width() + d.real, 0.5 * self.height() - d.imag)

    def place(self, point: QPointF) -> complex:
        """Point [mm] of a pixel."""
        d = complex(point.x() - 0.5 * self.width(), 0.5 * self.height() - point.y())
        return self._middle + d / self._scale

    def grid(self) -> float:
        """Distance of the grid's lines [mm]: 1, 2 or 5 times a power of ten."""
        least = GRID_PIXELS / self._scale
        power = 10.0 ** floor(log10(least))
        return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least)

    def snapped(self, z: complex) -> complex:
        """The nearest fifth of the grid [mm]."""
        step = 0.2 * self.grid()
        return complex(round(round(z.real / step) * step, 9), round(round(z.imag / step) * step, 9))

    def arm_end(self, pose: BodyPose) -> QPointF:
        """Pixel of the end of a frame's x axis."""
        at, turn = self.at(pose.z), cmath.rect(ARM, radians(pose.angle_deg))
        return QPointF(at.x() + turn.real, at.y() - turn.imag)

    def _hit(self, point: QPointF) -> tuple[str, int]:
        """What is under the mouse: ``turn`` or ``move`` with the number of a frame, ``pivot`` with that of a pivot, or nothing."""
        places = [("turn", i, self.arm_end(pose)) for i, pose in enumerate(self.poses)]
        places += [("move", i, self.at(pose.z)) for i, pose in enumerate(self.poses)]
        places += [("pivot", i, self.at(z)) for i, z in enumerate(self.pivots) if z is not None]
        for action, i, place in places:
            d = place - point
            if d.x() ** 2 + d.y() ** 2 <= REACH**2:
                return action, i
        return "", -1

    # -- mouse and keys -----------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._pressed = event.position()
        if event.button() != Qt.MouseButton.LeftButton:
            self._drag = "pan"
            return
        if self.is_passive:
            return
        if self.draws_path:
            self._drag, self._stroke = "draw", [self.place(event.position())]
            return
        action, index = self._hit(event.position())
        if event.modifiers() & Qt.KeyboardModifier.ShiftModifier and None in self.pivots:
            action, index = "pivot", self.pivots.index(None)
            self.pivots[index] = self.snapped(self.place(event.position()))
            self.pivots_changed.emit()
        if not action and len(self.poses) < MOST_POSES:
            z = self.snapped(self.place(event.position()))
            angle = self.poses[-1].angle_deg if self.poses else 0.0
            self.poses.append(BodyPose(z.real, z.imag, angle))
            action, index = "new", len(self.poses) - 1
            self.poses_changed.emit()
        self._drag = action
        self._pivot, self.chosen = (index, -1) if action == "pivot" else (-1, index)
        self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        d = event.position() - self._pressed
        if self._drag == "pan":
            self._middle -= complex(d.x(), -d.y()) / self._scale
            self._pressed = event.position()
        elif self._drag == "draw":
            self._stroke.append(self.place(event.position()))
        elif self._drag == "pivot":
            self.pivots[self._pivot] = self.snapped(self.place(event.position()))
            self.pivots_changed.emit()
        elif self._drag in ("turn", "new", "move"):
            if self._drag == "new" and d.x() ** 2 + d.y() ** 2 < TURNS**2:
                return
            self._change(event)
            self.poses_changed.emit()
        self.update()

    def _change(self, event: QMouseEvent) -> None:
        """Move or turn the chosen frame to the mouse; with Ctrl freely, else to the grid and to whole degrees."""
        pose, z = self.poses[self.chosen], self.place(event.position())
        is_free = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        if self._drag == "move":
            z = z if is_free else self.snapped(z)
            self.poses[self.chosen] = BodyPose(z.real, z.imag, pose.angle_deg)
        else:
            angle = degrees(cmath.phase(z - pose.z))
            self.poses[self.chosen] = BodyPose(pose.x_mm, pose.y_mm, angle if is_free else float(round(angle)))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._drag == "draw":
            points, closed = even_path(self._stroke)
            if points:
                self.points, self.closed = points, closed
                self.path_changed.emit(closed)
        self._drag, self._stroke = "", []
        self.update()

    def wheelEvent(self, event: QWheelEvent) -> None:
        before = self.place(event.position())
        factor = ZOOM if event.angleDelta().y() > 0 else 1.0 / ZOOM
        self._scale = min(max(self._scale * factor, LEAST_SCALE), MOST_SCALE)
        self._middle += before - self.place(event.position())
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and 0 <= self.chosen < len(self.poses):
            del self.poses[self.chosen]
            self.chosen = -1
            self.poses_changed.emit()
            self.update()
        else:
            super().keyPressEvent(event)

    # -- painting -----------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(SCREEN.paper))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_grid(painter)
        self._paint_path(painter)
        self._paint_answer(painter)
        for z in self.pivots:
            if z is not None and not self.is_passive and not self.draws_path:
                self._paint_pivot(painter, self.at(z))
        for i, pose in enumerate(self.poses):
            self._paint_frame(painter, pose, i)
        if self.hint and not (self.poses or self.points or self._stroke):
            painter.setPen(QColor(SCREEN.quiet))
            painter.drawText(
                self.rect().adjusted(24, 0, -24, 0), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, self.hint
            )

    def _paint_grid(self, painter: QPainter) -> None:
        step = self.grid()
        low, high = self.place(QPointF(0.0, self.height())), self.place(QPointF(self.width(), 0.0))
        painter.setPen(QPen(QColor(SCREEN.hair), 0))
        for k in range(int(low.real // step), int(high.real // step) + 2):
            x = self.at(complex(k * step, 0.0)).x()
            painter.drawLine(QPointF(x, 0.0), QPointF(x, self.height()))
        for k in range(int(low.imag // step), int(high.imag // step) + 2):
            y = self.at(complex(0.0, k * step)).y()
            painter.drawLine(QPointF(0.0, y), QPointF(self.width(), y))
        painter.setPen(QColor(SCREEN.quiet))
        painter.drawText(8, self.height() - 8, f"grid {step:g} mm")

    def _paint_path(self, painter: QPainter) -> None:
        z = self._stroke or [complex(p.x_mm, p.y_mm) for p in self.points]
        if not z:
            return
        painter.setPen(QPen(QColor(SCREEN.ink), 1.5))
        places = [self.at(p) for p in z]
        painter.drawPolyline([*places, places[0]] if self.closed and not self._stroke else places)
        if not self._stroke:
            painter.setBrush(QColor(SCREEN.ink))
            for place in places:
                painter.drawEllipse(place, 2.0, 2.0)
            painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_answer(self, painter: QPainter) -> None:
        if not self._answer:
            return
        if "P" in self._answer:
            painter.setPen(QPen(QColor(SCREEN.chosen), 1.0, Qt.PenStyle.DotLine))
            painter.drawPolyline([self.at(complex(z)) for z in self._answer["P"]])
        now = {name: self.at(complex(z[self._step % z.size])) for name, z in self._answer.items()}
        painter.setPen(QPen(QColor(SCREEN.quiet), 3.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        for first, second in LINKS:
            if first in now and second in now:
                painter.drawLine(now[first], now[second])
        if "B" not in now and "O4" in now:  # the coupler slides through its pivot
            painter.drawLine(now["A"], now["O4"])
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0))
        if "P" in now:
            for name in ("A", "B"):
                if name in now:
                    painter.drawLine(now[name], now["P"])
        painter.setBrush(QColor(SCREEN.paper))
        for name, place in now.items():
            radius = 5.0 if name.startswith("O") else 3.5
            painter.setPen(QPen(QColor(SCREEN.chosen if name == "P" else SCREEN.ink), 1.5))
            painter.drawEllipse(place, radius, radius)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_pivot(self, painter: QPainter, at: QPointF) -> None:
        painter.setPen(QPen(QColor(SCREEN.ink), 1.5))
        painter.setBrush(QColor(SCREEN.paper))
        painter.drawPolygon([at, QPointF(at.x() - 9.0, at.y() + 15.0), QPointF(at.x() + 9.0, at.y() + 15.0)])
        painter.drawEllipse(at, 4.0, 4.0)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_frame(self, painter: QPainter, pose: BodyPose, index: int) -> None:
        at, turn = self.at(pose.z), radians(pose.angle_deg)
        colour = QColor(SCREEN.chosen if index == self.chosen else SCREEN.ink)
        painter.setPen(QPen(colour, 2.0))
        for length, angle in ((ARM, turn), (0.6 * ARM, turn + 0.5 * pi)):
            end = cmath.rect(length, angle)
            painter.drawLine(at, QPointF(at.x() + end.real, at.y() - end.imag))
        painter.setBrush(colour)
        painter.drawEllipse(self.arm_end(pose), 3.5, 3.5)
        painter.setBrush(QColor(SCREEN.paper))
        painter.drawEllipse(at, 4.5, 4.5)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawText(QPointF(at.x() - 14.0, at.y() + 16.0), str(index + 1))


def even_path(stroke: Sequence[complex]) -> tuple[list[PathPoint], bool]:
    """Points of a stroke [mm], evenly spaced by length, and whether it returns to its start; none of a stroke without length."""
    z = np.array(stroke)
    z = z[np.append(True, np.abs(np.diff(z)) > 0.0)]
    if z.size < 4:
        return [], False
    size = float(np.hypot(np.ptp(z.real), np.ptp(z.imag)))
    closed = bool(abs(z[-1] - z[0]) < CLOSES * size)
    if closed:
        z = np.append(z, z[0])
    length = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    at = np.linspace(0.0, length[-1], PATH_POINTS, endpoint=not closed)
    even = np.interp(at, length, z.real) + 1j * np.interp(at, length, z.imag)
    return [PathPoint(round(p.real, 3), round(p.imag, 3)) for p in even.tolist()], closed
