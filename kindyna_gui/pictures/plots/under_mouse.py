"""Plots under the mouse: a click or a drag anywhere in them sets the angle, or values are read where the mouse is."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent

from kindyna_gui.pictures.plots.xy import XYPlot

MACHINE_ANGLE, MACHINE_TIP = "Machine angle, °", "Click or drag to set the machine angle"


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


class CursorPlot(UnderMouse, XYPlot):
    """Curves with a cursor, which a click or a drag moves; of one that only ``reads``, it stands where the mouse is.

    moved (float)   the user has clicked at, or drawn the cursor to, this place of the x axis
    read (object)   where the mouse is; None: elsewhere
    """

    moved = Signal(float)
    read = Signal(object)

    def __init__(self, across: str, upwards: str = "", *, reads: bool = False) -> None:
        super().__init__(across, upwards)
        self._reads = reads
        self.setMouseTracking(reads)
        self.viewport().setMouseTracking(reads)
        if not reads:
            self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)

    def _at(self, event: QMouseEvent) -> float:
        return float(self._view.mapSceneToView(self.mapToScene(event.position().toPoint())).x())

    def _go(self, event: QMouseEvent) -> None:
        if self._filled and not self._reads:
            frame = self.frame()
            self.moved.emit(min(max(self._at(event), frame.first), frame.last))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._reads:
            at, frame = self._at(event), self.frame()
            self._read(at if self._filled and frame.first <= at <= frame.last else None)
        else:
            super().mouseMoveEvent(event)

    def leaveEvent(self, event: QEvent) -> None:
        if self._reads:
            self._read(None)
        super().leaveEvent(event)

    def show_message(self, text: str) -> None:
        super().show_message(text)
        self.read.emit(None)

    def _read(self, at: float | None) -> None:
        self.point_out(at)
        self.read.emit(at)


__all__ = ["MACHINE_ANGLE", "MACHINE_TIP", "CursorPlot", "UnderMouse"]
