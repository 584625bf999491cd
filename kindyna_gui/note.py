"""Labels for messages, hidden while there is none, and for texts that change all the time."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QPalette, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.requirements import ways_of


def linked(sentence: str) -> str:
    """A sentence, with what can be done about it as links to entries of the menus."""
    ways = ways_of(sentence)
    if not ways:
        return sentence
    from html import escape

    return " ".join((escape(sentence), *(f'<a href="{way.entry}">{escape(way.text)}</a>' for way in ways)))


class MessageLabel(QLabel):
    """A text that wraps; an empty one hides the label."""

    def __init__(self, colour: str) -> None:
        super().__init__(wordWrap=True)
        coloured(self, colour)
        self.setForegroundRole(QPalette.ColorRole.WindowText)  # on paper it would be that of texts
        self.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse | Qt.TextInteractionFlag.LinksAccessibleByMouse
        )
        self.hide()

    def show_message(self, text: str) -> None:
        """Show this text; the label takes no room where it is empty."""
        if text != self.text() or self.isHidden() == bool(text):
            self.setText(text)
            self.setVisible(bool(text))


def bold_label(text: str) -> QLabel:
    """A heading inside a dialog."""
    label = QLabel(text)
    font = label.font()
    font.setBold(True)
    label.setFont(font)
    return label


class Note(MessageLabel):
    """The line below a picture that names what it does not show, and why; it never widens its parent."""

    def __init__(self, colour: str = "", margin: int = 6) -> None:
        super().__init__(colour or SCREEN.limit)
        self.setMargin(margin)
        self.setMinimumSize(1, 1)


class SteadyText(QWidget):
    """A text that may change in every frame: what is around it is laid out anew only where it needs more lines than ever."""

    def __init__(self, colour: str = "") -> None:
        super().__init__()
        self._label = QLabel(self, wordWrap=True)
        self._label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        if colour:
            coloured(self._label, colour)
        self.setMinimumHeight(self._label.fontMetrics().height())

    def text(self) -> str:
        return self._label.text()

    def show_text(self, text: str) -> None:
        """Show this text; the height grows with it and does not shrink, so that nothing below jumps."""
        if text != self.text():
            self._label.setText(text)
            self._grow()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._label.setGeometry(self.rect())
        if event.size().width() != event.oldSize().width():  # what it needed when it was narrow says nothing now
            self.setMinimumHeight(max(self._label.heightForWidth(self.width()), self._label.fontMetrics().height()))

    def _grow(self) -> None:
        needed = self._label.heightForWidth(self.width())
        if needed > self.minimumHeight():
            self.setMinimumHeight(needed)


def beside(box: QWidget, text: QLabel) -> QHBoxLayout:
    """What is chosen in a view, and beside it a text of two lines, which keeps its height so that nothing below it moves."""
    row = QHBoxLayout()
    row.setContentsMargins(6, 4, 6, 2)
    row.setSpacing(8)
    row.addWidget(box)
    row.addWidget(text, 1)
    text.setMinimumHeight(2 * text.fontMetrics().lineSpacing() + 2)
    return row


__all__ = ["MessageLabel", "Note", "SteadyText", "beside", "bold_label", "linked"]
