"""Plots over a turn that stand on the screen: a click or a drag anywhere in them sets the angle."""

from __future__ import annotations

from math import degrees, radians
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent

from kindyna_gui.pictures.plots.lines import Cursor
from kindyna_gui.pictures.plots.xy import XYPlot


class UnderMouse:
    """What a plot does with the mouse; ``_go`` sets the angle by where the mouse is. The keys belong to the player."""

    _go: Any

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._go(event)
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._go(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        event.ignore()


class MachinePlot(UnderMouse, XYPlot):
    """Curves over the machine angle 0 ... 360°, with a cursor.

    angle_moved   the user has clicked at, or drawn the cursor to, this machine angle [rad]
    """

    angle_moved = Signal(float)
    ANGLE = "Machine angle, °"

    def __init__(self, title: str) -> None:
        self._cursor: Cursor | None = None
        self._at = 0.0
        super().__init__(self.ANGLE, title)
        self._cursor = Cursor(self._view, self._theme)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip("Click or drag to set the machine angle")

    @property
    def shown(self) -> bool:
        """Whether there are curves that the cursor stands in."""
        return bool(self._drawn)

    @property
    def machine(self) -> float:
        """Machine angle of the cursor [deg]."""
        return degrees(self._at)

    def set_machine(self, machine: float) -> None:
        """Move the cursor [rad]."""
        self._at = machine
        self._place_cursor()

    def _place_cursor(self) -> None:
        if self._cursor is not None:
            self._cursor.setVisible(self.shown)
            self._cursor.setPos(self.machine, 0.0)

    def _lay(self, *args: object) -> None:
        super()._lay(*args)
        if self._cursor is not None:
            frame = self.frame()
            self._cursor.span(frame.low, frame.high)
            self._place_cursor()

    def _go(self, event: QMouseEvent) -> None:
        if self.shown:
            place = self._view.mapSceneToView(self.mapToScene(event.position().toPoint()))
            self.angle_moved.emit(radians(min(max(float(place.x()), 0.0), 360.0)))


__all__ = ["MachinePlot", "UnderMouse"]
