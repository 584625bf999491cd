"""A dialog that asks for a request: its form, what it means in words, and the buttons."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QVBoxLayout, QWidget

from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.as_command import add_copy
from kindyna_gui.forms.request_form import RequestForm
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN

Told = Callable[[Mapping[str, Any]], str]
"""What a request means, in a sentence, by the values of its fields."""


class RequestDialog(QDialog):
    """form: for what a dialog asks besides; accept_button: says what is done then; told: the words below.

    command  of the command line that asks for the same; reads: it is on a design; help_page: on it
    """

    command, reads, help_page = "", True, "tour"

    def __init__(self, parent: QWidget, title: str, form: RequestForm, accept: str, told: Told) -> None:
        super().__init__(parent)
        give_help(self, self.help_page)
        self.setWindowTitle(title)
        self.form, self.told = form, QLabel(wordWrap=True)
        coloured(self.told, SCREEN.quiet)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.accept_button = buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.accept_button.setText(accept)
        add_copy(buttons, parent, self.command, self.asked, reads=self.reads)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        for widget in (form, self.told, buttons):
            column.addWidget(widget)
        form.changed.connect(lambda: self.told.setText(told(form.values)))
        self.told.setText(told(form.values))

    def asked(self) -> tuple[str, list[str]]:
        """What the command writes, and its options."""
        raise NotImplementedError

    def values(self) -> dict[str, Any] | None:
        """Ask; what stands in the form by field, None where the user cancels."""
        values = self.form.values if self.exec() == QDialog.DialogCode.Accepted else None
        self.deleteLater()
        return values


__all__ = ["RequestDialog", "Told"]
