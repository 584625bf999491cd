"""Mouse and keys of the plots: what a press takes hold of follows the mouse until its release, else the mouse hovers."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent

from kindyna_gui.pictures.plots.plot import FixedPlot

REACH = 9.0  # distance from the draggable point within which a press takes hold of it, pixels


class PlotMouse:
    """Mixin for a plot that responds to the mouse; its keys belong to the surrounding view."""

    _held: Qt.MouseButton | None = None  # button of the press that took hold of something

    def press(self, event: QMouseEvent) -> bool:
        """Respond to a press; returns whether it takes hold of something, which ``drag`` and ``drop`` then move."""
        return False

    def drag(self, event: QMouseEvent) -> None:
        """Move what a press took hold of."""

    def drop(self, event: QMouseEvent) -> None:
        """Release what a press took hold of."""

    def hover(self, event: QMouseEvent | None) -> None:
        """Respond to the mouse over the plot; None: it has left."""

    @property
    def is_dragging(self) -> bool:
        """Whether the mouse drags something."""
        return self._held is not None

    def let_go(self) -> None:
        """End a drag without ``drop``."""
        self._held = None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if self.press(event):
            self._held = event.button()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        (self.drag if self.is_dragging else self.hover)(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() == self._held:
            self.let_go()
            self.drop(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)  # type: ignore[misc]  # of the plot
        self.hover(None)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        event.ignore()


class AngleMouse(PlotMouse):
    """Mixin for a plot in which a click or a drag sets the angle."""

    set_angle_at: Any  # method of the plot that sets the angle at a pixel of the widget

    def press(self, event: QMouseEvent) -> bool:
        if event.button() == Qt.MouseButton.LeftButton:
            self.set_angle_at(event.position())
        return False

    def hover(self, event: QMouseEvent | None) -> None:
        if event is not None and event.buttons() & Qt.MouseButton.LeftButton:
            self.set_angle_at(event.position())


class DraggablePoint(PlotMouse, FixedPlot):
    """Plot with a point that the mouse drags; subclasses give the coordinates.

    Signals
    -------
    hovered (object) : the mouse is over this point of the plot, None outside
    picked (float, float) : this point was clicked
    grabbed () : dragging has started
    dragged (float, float) : the draggable point is now here
    released (bool) : dragging has ended, True by releasing the button, False by Escape

    Attributes
    ----------
    mouse_at : last position of the mouse [pixels]
    """

    hovered = Signal(object)
    picked = Signal(float, float)
    dragged = Signal(float, float)
    released = Signal(bool)
    grabbed = Signal()

    def __init__(self, *arguments: Any, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self.mouse_at = QPointF()
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        """Coordinates at a pixel of the widget; None outside the plot."""
        raise NotImplementedError

    def own_pixel(self) -> QPointF | None:
        """Pixel of the draggable point; None where it is not visible."""
        raise NotImplementedError

    def is_over_point(self, pixel: QPointF) -> bool:
        """Whether a press at a pixel of the widget takes hold of the point."""
        point = self.own_pixel()
        away = QPointF() if point is None else point - pixel
        return point is not None and away.x() ** 2 + away.y() ** 2 <= REACH**2

    def press(self, event: QMouseEvent) -> bool:
        if event.button() != Qt.MouseButton.LeftButton:
            return False
        if is_over := self.is_over_point(event.position()):
            self.grabbed.emit()
        elif (point := self.point_at(event.position())) is not None:
            self.picked.emit(*point)
        return is_over

    def drag(self, event: QMouseEvent) -> None:
        self.mouse_at = event.position()
        if (point := self.point_at(event.position())) is not None:
            self.dragged.emit(*point)

    def drop(self, event: QMouseEvent) -> None:
        self.released.emit(True)

    def hover(self, event: QMouseEvent | None) -> None:
        if event is not None:
            self.mouse_at = event.position()
            over = self.is_over_point(event.position())
            self.viewport().setCursor(Qt.CursorShape.SizeAllCursor if over else Qt.CursorShape.CrossCursor)
        self.hovered.emit(None if event is None else self.point_at(event.position()))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape:
            self.let_go()
            self.released.emit(False)
        else:
            super().keyPressEvent(event)
