"""The dialog before a design is scaled: by which factor, and whether masses grow along."""

from __future__ import annotations

from PySide6.QtWidgets import QCheckBox, QDialog, QDialogButtonBox, QFormLayout, QVBoxLayout, QWidget

from core.commands.designs import ScaleArguments
from core.design import scale_text
from core.requests import command_words, field_info
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.as_command import add_copy
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import sentence
from kindyna_gui.note import MessageLabel
from kindyna_gui.pictures.style import SCREEN

FACTOR, MASSES = field_info(ScaleArguments, "factor"), field_info(ScaleArguments, "masses")
WIDTH = 380  # of the text, pixels


class ScaleDialog(QDialog):
    """A factor, a box for the masses, and below what that does."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle("Scale the design")
        self.factor = NumberBox(FACTOR)
        self.factor.show_value(1.0)
        self.factor.setToolTip(sentence(FACTOR.help))
        self.factor.setAccessibleName(FACTOR.label)
        self.masses = QCheckBox(MASSES.label)
        self.masses.setChecked(True)
        self.text = MessageLabel(SCREEN.quiet)
        self.text.setFixedWidth(WIDTH)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.scale_button = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.scale_button.setText("Scale")
        add_copy(
            self.buttons,
            parent,
            "scale",
            lambda: (
                "scaled.toml",
                command_words(ScaleArguments, {"factor": self.factor.value, "masses": self.masses.isChecked()}),
            ),
        )
        give_help(self, "tour#Scale the design")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        form = QFormLayout()
        form.addRow(FACTOR.label, self.factor)
        form.addRow(self.masses)
        column = QVBoxLayout(self)
        column.addLayout(form)
        column.addWidget(self.text)
        column.addWidget(self.buttons)
        self.factor.entered.connect(self._enter)
        self.factor.unreadable.connect(self._refuse)
        self.masses.toggled.connect(self._show)
        self._show()
        self.factor.selectAll()

    def _enter(self, value: float) -> None:
        if FACTOR.admits(value):
            self.factor.show_value(value)
            self._show()
        else:
            self._refuse()

    def _refuse(self) -> None:
        self.factor.set_refused(True)
        self.scale_button.setEnabled(False)
        self.text.show_message("The factor is a number above 0: 0.1, or 1/10.")

    def _show(self, *_: object) -> None:
        self.scale_button.setEnabled(True)
        self.text.show_message(scale_text(self.factor.value or 1.0, self.masses.isChecked()))

    def accept(self) -> None:
        """What stands in the field counts, confirmed or not."""
        self.factor.confirm()
        if not self.factor.refused:
            super().accept()


def scale_wanted(parent: QWidget) -> tuple[float, bool] | None:
    """Ask for a factor and whether masses grow along; None where the user cancels."""
    dialog = ScaleDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    wanted = dialog.factor.value or 1.0, dialog.masses.isChecked()
    dialog.deleteLater()
    return wanted if accepted else None


__all__ = ["ScaleDialog", "scale_wanted"]
