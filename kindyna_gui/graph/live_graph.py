"""A graph with mouse and keys: drag and wheel zoom, a click sets a point, and Back undoes each zoom."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QWidget

from core.output.graph import GraphPoint, point_at
from kindyna_gui.pictures.plots.graph import GraphPlot
from kindyna_gui.pictures.plots.graph_ranges import GraphRange, narrowed, shifted, zoomed
from kindyna_gui.pictures.plots.mouse import PlotMouse

CLICK = 4.0  # pixels: a shorter drag is a click
NOTCH = 0.8  # factor of the range for one notch of the wheel
WHEEL_MS = 400  # notches within this time are one step
MOST_STEPS = 100
SHIFT = Qt.KeyboardModifier.ShiftModifier
TIP = (
    "Drag: zoom. Click on a curve: point A, then point B. Wheel: zoom, over an axis this axis only. "
    "Middle button or Shift: move. Double click: show all. Backspace: back. Esc: remove the points. "
    "Left, right: move the last point."
)


class LiveGraph(PlotMouse, GraphPlot):
    """The graph on the screen. Signals: ``points_changed``; ``part_changed``, the visible part has changed."""

    points_changed = Signal()
    part_changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        self._past: list[GraphRange] = []
        self._pressed = QPointF()
        self._moved_from: GraphRange | None = None  # visible part at the start of a move
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setToolTip(TIP)
        self._wheel = QTimer(self, singleShot=True, interval=WHEEL_MS)

    def range_replaced(self) -> None:
        self._past.clear()
        self.let_go()  # the graph under the mouse has changed
        self.show_rubber(None)
        self.part_changed.emit()

    # -- visible part ---------------------------------------------------------------------------------------

    @property
    def part(self) -> dict[str, Any]:
        """The visible part as plain data; empty if all is visible."""
        if not self._past or not self.data.series or self.shown == self.full_range():
            return {}
        return {
            "axes": self._axis_keys(),
            "x": list(self.shown.x),
            "values": [list(ends) for ends in self.shown.values],
        }

    def restore_part(self, data: Mapping[str, Any]) -> None:
        """Show a saved part if the axes are the same; ``back`` shows all."""
        if not self.data.series or data.get("axes") != self._axis_keys():
            return
        try:
            across, values = _ends(data["x"]), tuple(_ends(row) for row in data["values"])
        except (KeyError, TypeError, ValueError):
            return
        if len(values) == len(self.data.axes):
            self._step(GraphRange(across, values))

    def _axis_keys(self) -> list[str]:
        """Side, unit and scale of each axis."""
        keys = [
            f"{axis.side} {display_unit.symbol} {axis.scale.log}"
            for axis, display_unit in zip(self.data.axes, self.display_units, strict=True)
        ]
        return [f"x {self.data.x_unit} {self.graph.x.log}", *keys]

    @property
    def can_go_back(self) -> bool:
        """Whether there is a step of zooming to undo."""
        return bool(self._past)

    def _step(self, shown: GraphRange) -> None:
        """Show another part, as a step that ``back`` undoes."""
        if shown != self.shown:
            self._past = [*self._past[1 - MOST_STEPS :], self.shown]
            self.show_range(shown)
            self.part_changed.emit()

    def back(self) -> None:
        """Undo one step of zooming."""
        if self._past:
            self.show_range(self._past.pop())
            self.part_changed.emit()

    def show_all(self) -> None:
        """Show all curves, or the ranges set for the axes."""
        if self.data.series:
            self._step(self.full_range())

    def _wheeled(self, at: QPointF, factor: float) -> GraphRange:
        """Zoom about a point of the plot; over an axis zoom this axis only."""
        x = zoomed(self.shown.x, at.x(), factor) if 0.0 <= at.x() <= 1.0 else self.shown.x
        values = self.shown.values
        if at.y() >= 0.0:
            side = self._axis_at(at)
            indices = range(len(values)) if 0.0 <= at.x() <= 1.0 else () if side is None else (side,)
            values = tuple(zoomed(ends, at.y(), factor) if i in indices else ends for i, ends in enumerate(values))
        return GraphRange(x, values)

    def _axis_at(self, at: QPointF) -> int | None:
        """Index of the axis of values at a point outside the plot."""
        if at.x() < 0.0:
            return self._slots.index(0) if 0 in self._slots else None
        scene = self._view.sceneBoundingRect()
        x = scene.left() + at.x() * scene.width()
        for slot, (axis, _) in enumerate(self._right_axes, 1):
            box = axis.sceneBoundingRect()
            if slot in self._slots and box.left() <= x <= box.right():
                return self._slots.index(slot)
        return None

    # -- mouse ----------------------------------------------------------------------------------------------

    def press(self, event: QMouseEvent) -> bool:
        is_move = event.button() == Qt.MouseButton.MiddleButton or bool(event.modifiers() & SHIFT)
        if not self.data.series or not (is_move or event.button() == Qt.MouseButton.LeftButton):
            return False
        self._pressed, self._moved_from = event.position(), self.shown if is_move else None
        return True

    def drag(self, event: QMouseEvent) -> None:
        begin, end = self.fraction(self._pressed), self.fraction(event.position())
        if self._moved_from is not None:
            x = shifted(self._moved_from.x, begin.x() - end.x())
            self.show_range(
                GraphRange(x, tuple(shifted(ends, begin.y() - end.y()) for ends in self._moved_from.values))
            )
        elif self._is_drag(event.position()):
            self.show_rubber(self._box(begin, end))

    def _is_drag(self, at: QPointF) -> bool:
        distance = at - self._pressed
        return max(abs(distance.x()), abs(distance.y())) >= CLICK

    def _box(self, begin: QPointF, end: QPointF) -> QRectF:
        """Rectangle of a drag, in fractions of the plot; a drag along one axis keeps the range of the other."""
        x = sorted(min(max(f, 0.0), 1.0) for f in (begin.x(), end.x()))
        y = sorted(min(max(f, 0.0), 1.0) for f in (begin.y(), end.y()))
        wide, high = (x[1] - x[0]) * self._view.width(), (y[1] - y[0]) * self._view.height()
        x = [0.0, 1.0] if wide < CLICK else x
        y = [0.0, 1.0] if high < 3.0 * CLICK else y
        return QRectF(x[0], y[0], x[1] - x[0], y[1] - y[0])

    def drop(self, event: QMouseEvent) -> None:
        self.show_rubber(None)
        if self._moved_from is not None:
            shown, self.shown = self.shown, self._moved_from
            self._step(shown)
        elif self._is_drag(event.position()):
            box = self._box(self.fraction(self._pressed), self.fraction(event.position()))
            x = narrowed(self.shown.x, box.left(), box.right())
            self._step(GraphRange(x, tuple(narrowed(ends, box.top(), box.bottom()) for ends in self.shown.values)))
        else:
            self._point_to(event.position())

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        super().mouseDoubleClickEvent(event)
        self.show_all()

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.accept()
        delta = event.angleDelta().y() or event.angleDelta().x()
        if not self.data.series or not delta:
            return
        shown = self._wheeled(self.fraction(event.position()), NOTCH ** (delta / 120.0))
        if self._wheel.isActive():
            self.show_range(shown)
            self.part_changed.emit()
        else:
            self._step(shown)
        self._wheel.start()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key = event.key()
        if key == Qt.Key.Key_Backspace:
            self.back()
        elif key == Qt.Key.Key_Escape and self.points:
            self.set_points(())
        elif key in (Qt.Key.Key_Left, Qt.Key.Key_Right) and self.points:
            self._shift_point(-1.0 if key == Qt.Key.Key_Left else 1.0)
        else:
            super().keyPressEvent(event)

    # -- points ---------------------------------------------------------------------------------------------

    def set_points(self, points: tuple[GraphPoint, ...]) -> None:
        """Mark up to two points."""
        self.show_points(points)
        self.points_changed.emit()

    def _point_to(self, pixel: QPointF) -> None:
        """Set point A, then point B; a third click sets point A again."""
        point = self.nearest(pixel)
        if point is not None:
            self.set_points((*self.points, point) if len(self.points) == 1 else (point,))

    def _shift_point(self, sign: float) -> None:
        """Move the last point by a pixel; on a curve whose x is not ordered, to its next point."""
        *before, last = self.points
        series = self.data.series[last.series]
        if series.is_ordered:
            wide = self.shown.x[1] - self.shown.x[0]
            pixel = sign * wide / max(self._view.width(), 1.0)
            at = last.x * 10.0**pixel if self.graph.x.log else last.x + pixel
            point = point_at(self.data, last.series, at)
        else:
            nearest = int(np.nanargmin((series.x - last.x) ** 2 + (series.y - last.y) ** 2))
            i = min(max(nearest + int(sign), 0), series.x.size - 1)
            point = GraphPoint(last.series, float(series.x[i]), float(series.y[i]))
        self.set_points((*before, point))


def _ends(row: Any) -> tuple[float, float]:
    """Return the ends of a saved range. Raises TypeError, ValueError."""
    low, high = (float(end) for end in row)
    if not (isfinite(low) and isfinite(high) and low < high):
        raise ValueError
    return low, high


__all__ = ["LiveGraph"]
