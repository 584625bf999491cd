"""Labels for messages, hidden while there is none."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QLabel

from kindyna_gui.look import WRONG, coloured


class MessageLabel(QLabel):
    """A text that wraps; an empty one hides the label."""

    def __init__(self, colour: str) -> None:
        super().__init__(wordWrap=True)
        coloured(self, colour)
        self.setForegroundRole(QPalette.ColorRole.WindowText)  # on paper it would be that of texts
        self.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.hide()

    def show_message(self, text: str) -> None:
        if text != self.text() or self.isHidden() == bool(text):
            self.setText(text)
            self.setVisible(bool(text))


class Note(MessageLabel):
    """The line below a picture that names what it does not show, and why; it never widens its parent."""

    def __init__(self, colour: str = WRONG, margin: int = 6) -> None:
        super().__init__(colour)
        self.setMargin(margin)
        self.setMinimumSize(1, 1)


__all__ = ["MessageLabel", "Note"]
