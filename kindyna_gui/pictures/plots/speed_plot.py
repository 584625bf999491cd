"""Curves over the machine's speed, whose values are read where the mouse is."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Signal
from PySide6.QtGui import QMouseEvent

from kindyna_gui.pictures.plots.lines import Cursor
from kindyna_gui.pictures.plots.xy import XYPlot


class SpeedPlot(XYPlot):
    """Curves over a speed. A click sets nothing.

    read   where the mouse is [in the numbers of the axis]; None: it is elsewhere
    """

    read = Signal(object)

    def __init__(self, across: str, upwards: str = "") -> None:
        self._cursor: Cursor | None = None
        super().__init__(across, upwards)
        self._cursor = Cursor(self._view, self._theme)
        self._cursor.hide()
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)

    @property
    def cursor_at(self) -> float | None:
        """Where the values are read; None where they are not."""
        return self._cursor.value() if self._cursor is not None and self._cursor.isVisible() else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()

    mouseReleaseEvent = mouseDoubleClickEvent = mousePressEvent

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        place = float(self._view.mapSceneToView(self.mapToScene(event.position().toPoint())).x())
        frame = self.frame()
        self._show_cursor(place if self._drawn and frame.first <= place <= frame.last else None)

    def leaveEvent(self, event: QEvent) -> None:
        self._show_cursor(None)
        super().leaveEvent(event)

    def show_message(self, text: str) -> None:
        super().show_message(text)
        self._show_cursor(None)

    def _show_cursor(self, at: float | None) -> None:
        if self._cursor is None:  # the base begins with a message
            return
        self._cursor.setVisible(at is not None)
        if at is not None:
            self._cursor.setPos(at, 0.0)
        self.read.emit(at)

    def _lay(self, *args: object) -> None:
        super()._lay(*args)
        if self._cursor is not None:
            frame = self.frame()
            self._cursor.span(frame.low, frame.high)


__all__ = ["SpeedPlot"]
