"""Plots on the screen: a click or a drag anywhere in it sets the cam angle."""

from __future__ import annotations

from math import radians
from typing import Any

from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QAction, QMouseEvent
from PySide6.QtWidgets import QToolButton, QWidget

from kindyna_gui.pictures.detail import UNSEEN
from kindyna_gui.pictures.plots.extreme_marks import TEXT_ROOM
from kindyna_gui.pictures.plots.frame import Frame
from kindyna_gui.pictures.plots.plot import CurvePlot
from kindyna_gui.pictures.plots.polar import PolarPlot
from kindyna_gui.pictures.plots.under_mouse import UnderMouse
from kindyna_gui.pictures.style import SMALL, font

TIP = "Click or drag to set the cam angle; right click to export"


class _Turned(UnderMouse):
    """The angle where the mouse is, of curves that are there."""

    readings: Any
    angle_at: Any
    angle_moved: Any

    def _go(self, event: QMouseEvent) -> None:
        if self.readings():
            self.angle_moved.emit(radians(self.angle_at(event.position())))


class LivePlot(_Turned, CurvePlot):
    """Curves over one turn under the mouse.

    angle_moved   the user has clicked at, or drawn the cursor to, this cam angle [rad]
    """

    angle_moved = Signal(float)
    unseen = UNSEEN
    text_room = TEXT_ROOM
    whole_action: QAction | None = None
    whole_button: QToolButton | None = None

    def __init__(self, parent: QWidget | None = None, *, names: bool = True, angles: bool = True) -> None:
        super().__init__(parent, names=names, angles=angles)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip(TIP)
        self.keep_axes()
        self.whole_action = QAction("Show all", self, checkable=True, enabled=False)
        self.whole_action.setToolTip("Let the axis reach to the peaks that are far off all the rest, or cut them off")
        self.whole_action.toggled.connect(self.show_whole)
        self.whole_button = QToolButton(self, autoRaise=True)
        self.whole_button.setDefaultAction(self.whole_action)
        self.whole_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.whole_button.setFont(font(SMALL))
        self.whole_button.hide()

    def _covered(self, frame: Frame) -> list[QRectF]:
        """The button in the upper right corner, where there are peaks far off all the rest."""
        if self.whole_button is None or self.whole_action is None:  # the plot is still being made
            return []
        self.whole_action.setEnabled(self.spiked)
        self.whole_button.setVisible(self.spiked)
        if not self.spiked:
            return []
        size, corner = self.whole_button.sizeHint(), self.mapFromScene(self.getViewBox().sceneBoundingRect().topRight())
        self.whole_button.setGeometry(corner.x() - size.width() - 1, corner.y() + 1, size.width(), size.height())
        return [
            QRectF(frame.width - size.width() - 1.0, frame.height - size.height() - 1.0, size.width(), size.height())
        ]

    def angle_at(self, pixel: QPointF) -> float:
        """The cam angle [deg] at a place of the widget [pixels], 0 ... 360 also beside the axes."""
        place = self.getViewBox().mapSceneToView(self.mapToScene(pixel.toPoint()))
        return min(max(float(place.x()), 0.0), 360.0)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if (
            event.button() == Qt.MouseButton.LeftButton
            and self.cut_at(event.position())
            and self.whole_action is not None
        ):
            self.whole_action.trigger()
            event.accept()
        else:
            super().mousePressEvent(event)


class LivePolar(_Turned, PolarPlot):
    """Curves in polar form under the mouse."""

    unseen = UNSEEN

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip(TIP)
