"""A line over the timing chart in which an angle, or a time, is typed."""

from __future__ import annotations

from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import QLineEdit, QToolTip, QWidget

from core.design import Unit
from core.output.lines import shortest
from kindyna_gui.forms.number_box import RedFrame
from kindyna_gui.forms.typed_number import parsed
from kindyna_gui.labels import no_number, sentence
from kindyna_gui.pictures.timing_chart import AXES

WIDTH, HEIGHT = 92, 24


class TypedAngle(RedFrame, QLineEdit):
    """Shown where something stands, with its value; Enter takes what was typed, Escape and another focus leave it.

    entered   (drive, join or None, value as the axis counts)
    """

    entered = Signal(int, object, float)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._parent = parent
        self.resize(WIDTH, HEIGHT)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.hide()
        self._of: tuple[int, int | None] = (0, None)
        self._unit = Unit("", 1.0)
        self.returnPressed.connect(self._take)
        self.textEdited.connect(lambda: self.set_refused(False))

    def ask(self, drive: int, join: int | None, value: float, unit: str, place: QPointF) -> None:
        """Ask for the value of a drive's phase, or of a join."""
        self._of, self._unit = (drive, join), Unit(AXES[unit], 1.0)
        self.set_refused(False)
        self.setText(shortest(round(value, 6)))
        self.setAccessibleName("Phase" if join is None else "Machine angle")
        room = self._parent.rect()
        x = min(max(int(place.x()) - WIDTH // 2, 0), room.width() - WIDTH)
        y = min(max(int(place.y()) - HEIGHT - 8, 0), room.height() - HEIGHT)
        self.move(x, y)
        self.show()
        self.setFocus()
        self.selectAll()

    def refuse(self, why: str) -> None:
        """What was typed cannot be: it stays, framed in red, with the reason."""
        self.set_refused(True)
        self.setToolTip(sentence(why))
        QToolTip.showText(self.mapToGlobal(self.rect().bottomLeft()), sentence(why), self)

    def _take(self) -> None:
        value = parsed(self.text(), self._unit, kept=True)
        if value is None:
            self.refuse(no_number(self.text()))
        else:
            self.entered.emit(*self._of, value)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape:
            self.hide()
            self._parent.setFocus()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() not in (Qt.FocusReason.PopupFocusReason, Qt.FocusReason.ActiveWindowFocusReason):
            self.hide()


__all__ = ["TypedAngle"]
