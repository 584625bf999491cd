"""Pictures in space that the mouse turns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QPointF
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QWidget

from core.numerics.derivatives import ISOMETRIC

TURN_PER_PIXEL, STEEPEST = 0.5, 90.0
"""Rotation per pixel of the mouse, and largest tilt [deg]."""

if TYPE_CHECKING:
    _Widget = QWidget
else:
    _Widget = object


class TurnedByMouse(_Widget):
    """Mixin of a widget, before its Qt class: a drag turns the picture, a double click returns to its first view.

    Attributes
    ----------
    turn, tilt : float
        Rotation about the vertical axis, and tilt [deg].
    first_view : tuple of float
        Turn and tilt of the first view [deg].
    flattest : float
        Least tilt [deg].
    turns : bool
        Whether the mouse turns it.
    """

    turn, tilt = first_view = ISOMETRIC
    flattest = -STEEPEST
    turns = True
    _grip: QPointF | None = None

    def look(self, turn: float, tilt: float) -> None:
        """Set rotation and tilt [deg]."""
        self.turn, self.tilt = turn % 360.0, min(max(tilt, self.flattest), STEEPEST)
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._grip = event.position() if self.turns else None

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._grip is not None:
            drag, self._grip = event.position() - self._grip, event.position()
            self.look(self.turn - TURN_PER_PIXEL * drag.x(), self.tilt + TURN_PER_PIXEL * drag.y())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        self._grip = None

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        if self.turns:
            self.look(*self.first_view)
