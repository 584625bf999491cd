"""The small parts of a form's row: a name that can be dragged, an asterisk that can be clicked."""

from __future__ import annotations

from itertools import pairwise

from PySide6.QtCore import QPoint, QSize, Qt, Signal
from PySide6.QtGui import QColor, QContextMenuEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QLabel, QMenu, QSizePolicy, QWidget

from core.units import Unit
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.preferences.units import TOLD, symbol_of

_PIXELS_A_STEP = 6


def in_tab_order(*widgets: QWidget) -> None:
    """Tab goes from each to the next; what is made late would else come last."""
    for before, after in pairwise(widgets):
        QWidget.setTabOrder(before, after)


class NameLabel(QLabel):
    """The name of a field; dragged sideways it turns the number up and down.

    dragged    (int): so many steps further
    released   the drag, or a click, is over
    menu_wanted  (QPoint, QMenu): what can be done with it, at this place of the screen, by a menu that is empty yet
    """

    dragged = Signal(int)
    released = Signal()
    menu_wanted = Signal(object, object)

    def __init__(self, html: str, draggable: bool) -> None:
        super().__init__(html)
        self._from: QPoint | None = None
        self._done = 0
        self._draggable = draggable
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        if draggable:
            self.setCursor(Qt.CursorShape.SizeHorCursor)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        menu = QMenu(self)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.menu_wanted.emit(event.globalPos(), menu)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._from, self._done = event.globalPosition().toPoint(), 0

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._from is None or not self._draggable:
            return
        steps = round((event.globalPosition().toPoint() - self._from).x() / _PIXELS_A_STEP)
        if steps != self._done:
            self.dragged.emit(steps - self._done)
            self._done = steps

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._from is not None:
            self._from = None
            self.released.emit()


class UnitLabel(QLabel):
    """The unit that a number is shown in."""

    def __init__(self, unit: Unit) -> None:
        super().__init__()
        self._symbol = unit.symbol
        coloured(self, SCREEN.quiet)
        self._show()
        TOLD.changed.connect(self._show)

    def _show(self) -> None:
        self.setText(symbol_of(self._symbol))


class AssumedMark(QAbstractButton):
    """An asterisk that is faint until checked."""

    def __init__(self) -> None:
        super().__init__(checkable=True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        return QSize(18, 20)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        if self.underMouse():
            painter.fillRect(self.rect(), self.palette().midlight())
        painter.setPen(QColor(SCREEN.assumed if self.isChecked() else SCREEN.line))
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "∗")
        painter.end()
