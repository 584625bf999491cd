"""A dialog with questions on the left and their result on the right, which it puts into the design."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QHBoxLayout, QLayout, QVBoxLayout, QWidget

from core.design import Design
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.refusal import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import sentence
from kindyna_gui.look import coloured
from kindyna_gui.note import MessageLabel
from kindyna_gui.pictures.style import SCREEN

AROUND = QSize(40, 60)  # left free on the screen, with frame and title


class PutDialog(QDialog):
    """Two columns above a message and the buttons.

    Subclasses call ``frame`` once and implement ``accept`` with ``put``.

    message      what would become of the design, or what is wrong
    put_button   enabled by the subclass while there is something to put
    help_page    on what is put, with the words to look for there behind #
    """

    help_page = "making#Segments"

    def __init__(self, session: Session, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        give_help(self, self.help_page)
        self.setWindowTitle(title)
        self._session = session
        self.message = MessageLabel(SCREEN.quiet)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.put_button = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.put_button.setText("&Put into the design")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)

    def frame(self, questions: QLayout, width: int, shown: QWidget | QLayout, usual: QSize, least: QSize) -> None:
        """Lay out the dialog. questions: the left column, ``width`` pixels wide; shown: the right one; usual and least: its size."""
        questions.setContentsMargins(0, 0, 0, 0)
        questions.setSpacing(6)
        left = QWidget()
        left.setLayout(questions)
        left.setFixedWidth(width)
        middle = QHBoxLayout()
        middle.setSpacing(12)
        middle.addWidget(left)
        if isinstance(shown, QLayout):
            middle.addLayout(shown, 1)
        else:
            middle.addWidget(shown, 1)
        foot = QHBoxLayout()
        foot.addWidget(self.message, 1)
        foot.addWidget(self.buttons)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 10, 12, 10)
        column.addLayout(middle, 1)
        column.addLayout(foot)
        self.setMinimumSize(least)
        self.resize(usual.boundedTo(self.screen().availableGeometry().size() - AROUND))

    def show_message(self, text: str, wrong: bool = False) -> None:
        """What the values typed lead to; wrong: why they cannot be."""
        coloured(self.message, SCREEN.limit if wrong else SCREEN.quiet)
        self.message.show_message(text)

    def put(self, design: Design, step: str) -> None:
        """Put a design in place as one step of this name and close; where the session refuses it, show why and stay open."""
        session = self._session
        refused: list[str] = []

        def listen(refusal: Refusal) -> None:
            refused.extend(f"{name}: {text}" for _, name, text in refusal.reasons)

        session.refused.connect(listen)
        session.end_gesture()
        done = session.put(design, step)
        session.refused.disconnect(listen)
        session.end_gesture()
        if done:
            super().accept()
        else:
            session.withdraw("")
            self.show_message(sentence("; ".join(refused)), wrong=True)

    def open_once(self) -> None:
        """Open over its window; it is deleted once closed."""
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.open()


__all__ = ["PutDialog"]
