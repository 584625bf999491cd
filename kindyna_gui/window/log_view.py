"""The error log as a page of the window."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QFontDatabase
from PySide6.QtWidgets import QApplication, QHBoxLayout, QLabel, QPlainTextEdit, QPushButton

from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.fault_log import log_file, log_text, report_text
from kindyna_gui.look import coloured, described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import fill
from kindyna_gui.view import View

EMPTY = "No errors. An error is logged here with its time, the actions before it, and the place in the program."


class LogView(View):
    """The text of the log, scrolled to the newest entry."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.text = described(QPlainTextEdit(readOnly=True, placeholderText=EMPTY), name="Log")
        self.text.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.file = coloured(QLabel(textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse), SCREEN.quiet)
        self.file.setMinimumWidth(1)
        self.copy = QPushButton("Copy all")
        self.copy.clicked.connect(lambda: QApplication.clipboard().setText(self.text.toPlainText()))
        self.report = described(
            QPushButton("Copy for a report"), tip="Copy versions, system and log, to send with a report of the error"
        )
        self.report.clicked.connect(lambda: QApplication.clipboard().setText(report_text()))
        header = fill(QHBoxLayout(), (self.file, 1), self.copy, self.report, margins=(8, 4, 8, 2))
        self.set_column(header, self.text, grows=self.text)

    def refresh(self, study: Study) -> None:
        self.file.setText(str(log_file()))
        self.file.setToolTip(self.file.text())  # of a long path the end is cut
        try:
            text = log_text()
        except OSError as error:
            text = f"{log_file()} cannot be read: {error.strerror}"
        if text != self.text.toPlainText():
            self.text.setPlainText(text)
            bar = self.text.verticalScrollBar()
            bar.setValue(bar.maximum())
        self.copy.setEnabled(bool(text))


__all__ = ["LogView"]
