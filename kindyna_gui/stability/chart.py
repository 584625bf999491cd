"""The chart of stability under the hand: a point is hovered, picked, or drawn away from the machine's own."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QWidget

from kindyna_gui.pictures.plots.stability_chart import ChartPlot

REACH = 9.0  # pixels from the machine's point


class StabilityChart(ChartPlot):
    """The chart with its reactions; all points are (η, Q). ``mouse_at``: where the mouse was last [pixels].

    hovered   (object): the point under the mouse, None where it is beside the chart
    picked    (float, float): a click
    pulled    (float, float): the machine's point is drawn there; released: it was let go there, or Escape gave it up
    """

    hovered = Signal(object)
    picked = Signal(float, float)
    pulled = Signal(float, float)
    released = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._pulling = False
        self.mouse_at = QPointF()
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    @property
    def pulling(self) -> bool:
        """Whether the machine's point is held with the mouse."""
        return self._pulling

    def _over_own(self, place: QPointF) -> bool:
        machine = self.chart.machine if self.chart is not None else None
        if machine is None or not self.own.isVisible():
            return False
        away = self.pixel(machine.eta, machine.q) - place
        return away.x() ** 2 + away.y() ** 2 <= REACH**2

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._over_own(event.position()):
            self._pulling = True
            return
        point = self.point_at(event.position())
        if point is not None:
            self.picked.emit(*point)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        self.mouse_at = event.position()
        point = self.point_at(event.position())
        if self._pulling:
            if point is not None:
                self.pulled.emit(*point)
            return
        over = self._over_own(event.position())
        self.viewport().setCursor(Qt.CursorShape.SizeAllCursor if over else Qt.CursorShape.CrossCursor)
        self.hovered.emit(point)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() == Qt.MouseButton.LeftButton and self._pulling:
            self._pulling = False
            self.released.emit(True)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape:
            self._pulling = False
            self.released.emit(False)
        else:
            event.ignore()

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.hovered.emit(None)


__all__ = ["StabilityChart"]
