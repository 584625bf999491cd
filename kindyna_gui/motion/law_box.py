"""The cell of a law: its name, and the pictures of all laws when it is opened."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QRect, Qt, Signal
from PySide6.QtGui import QKeyEvent

from core.design import CURVES
from core.laws import LAWS
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import law_label
from kindyna_gui.motion.law_picker import LawPicker

_COMMANDS = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier


class LawBox(WordBox):
    """The name of a law; its list is the picker.

    cancelled  the picker was closed without a choice
    """

    cancelled = Signal()

    def __init__(self) -> None:
        super().__init__()
        for slug in (*LAWS, *CURVES):
            self.addItem(law_label(slug), slug)
        self.picker: LawPicker | None = None

    def showPopup(self) -> None:
        self.open("")

    def open(self, typed: str) -> None:
        """Open the picker, with this typed already."""
        if self.picker is not None:
            return
        self.picker = LawPicker(self, self.currentData(), typed)
        self.picker.picked.connect(self._picked)
        self.picker.closed.connect(self._closed)
        self.picker.open_at(QRect(self.mapToGlobal(QPoint(0, 0)), self.size()))

    def hidePopup(self) -> None:
        if self.picker is not None:
            self.picker.close()

    def _picked(self, slug: str) -> None:
        self.picker = None
        index = self.findData(slug)
        self.setCurrentIndex(index)
        self.activated.emit(index)

    def _closed(self) -> None:
        self.picker = None
        self.cancelled.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.text().strip() and event.text().isprintable() and not event.modifiers() & _COMMANDS:
            self.open(event.text())
        else:
            super().keyPressEvent(event)


__all__ = ["LawBox"]
