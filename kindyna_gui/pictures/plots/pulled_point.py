"""A plot in which one point is the design's own: it is drawn away with the mouse, another one is clicked, any is hovered."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent

from kindyna_gui.pictures.plots.fixed_plot import FixedPlot

REACH = 9.0  # pixels from the own point


class PulledPoint(FixedPlot):
    """A mixin before the class of the plot, which says in the numbers of its points what lies at a place, and where its own stands.
    ``mouse_at``: where the mouse was last [pixels].

    hovered   (object): the point under the mouse, None where it is beside the plot
    picked    (float, float): a click
    pulled    (float, float): the own point is drawn there; released (bool): it was let go there, or Escape gave it up
    """

    hovered = Signal(object)
    picked = Signal(float, float)
    pulled = Signal(float, float)
    released = Signal(bool)
    grabbed = Signal()

    def __init__(self, *arguments: Any, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self._pulling = False
        self.mouse_at = QPointF()
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        """The point at a place of the widget; None beside the plot."""
        raise NotImplementedError

    def own_pixel(self) -> QPointF | None:
        """Where the own point stands in the widget; None where it is not seen."""
        raise NotImplementedError

    @property
    def pulling(self) -> bool:
        """Whether the own point is held with the mouse."""
        return self._pulling

    def _over_own(self, place: QPointF) -> bool:
        own = self.own_pixel()
        if own is None:
            return False
        away = own - place
        return away.x() ** 2 + away.y() ** 2 <= REACH**2

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._over_own(event.position()):
            self._pulling = True
            self.grabbed.emit()
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


__all__ = ["PulledPoint"]
