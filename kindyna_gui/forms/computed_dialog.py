"""A dialog before an export: what the file will hold is computed beside the window for the choices made, and shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QLayout,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.cam import form_row
from core.design import Design
from core.errors import KindynaError
from core.requests import command_words
from kindyna_gui.background import Background
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.as_command import add_copy
from kindyna_gui.forms.request_form import RequestForm
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN

WAITING = "computing ..."
PAUSE_MS = 150  # after the last change before anything is computed
FORM_WIDTH = 300  # pixels, at least
RESULT_LINES = 5


class ComputedDialog(QDialog):
    """The form of a request on the left, what comes of it in words below, and shown on the right. ``made`` is what was computed
    for the request, None while there is none; subclasses say what is computed and how it is shown.

    what: the file, as the title and messages call it.
    command, ending: of the command line that asks for the same, and of the file that it writes; help_page: on this export
    """

    command, ending, help_page = "", "", "tour"

    result: QLabel  # type: ignore[assignment]

    def __init__(self, parent: QWidget, what: str, form: RequestForm, shown: QWidget | QLayout) -> None:
        super().__init__(parent)
        self.setWindowTitle(f"Export {what}")
        give_help(self, self.help_page)
        self.made: Any = None
        self._work = Background(self)
        self.form, self.result = form, QLabel()
        self.result.setWordWrap(True)
        self.result.setMinimumHeight(RESULT_LINES * self.fontMetrics().lineSpacing())
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.export: QPushButton = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.export.setText(f"Save {what}...")
        add_copy(self.buttons, parent, self.command, self.asked, of_drive=True)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        left = QVBoxLayout()
        width = max(FORM_WIDTH, self.form.sizeHint().width())
        for widget in (self.form, self.result):
            widget.setFixedWidth(width)
            left.addWidget(widget)
        left.addStretch(1)
        sides = QHBoxLayout()
        sides.addLayout(left)
        if isinstance(shown, QLayout):
            sides.addLayout(shown, 1)
        else:
            sides.addWidget(shown, 1)
        column = QVBoxLayout(self)
        column.addLayout(sides)
        column.addWidget(self.buttons)
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(lambda: self._work.start([("", self.job())]))
        self._work.result.connect(self._take)
        self.finished.connect(self._pause.stop)
        self.finished.connect(self._work.close)
        self.form.changed.connect(self.changed)

    # -- for subclasses -------------------------------------------------------------------------------------

    def asked(self) -> tuple[str, list[str]]:
        """What the command writes, and its options."""
        return self.ending, command_words(self.form.kind, self.form.values)

    def job(self) -> Callable[[], Any]:
        """What computes what the file will hold, for the request as it is now."""
        raise NotImplementedError

    def show_made(self, made: Any) -> str:
        """Show what was computed, None where there is no answer; in words."""
        raise NotImplementedError

    def show_waiting(self) -> None:
        """Show that something else is being computed."""

    def changed(self) -> None:
        """What was computed is void, what is being computed is given up."""
        self.made = None
        self.export.setEnabled(False)
        self.show_waiting()
        self._tell(WAITING, SCREEN.quiet)
        self._work.stop()
        self._pause.start()

    # -- what comes of it -----------------------------------------------------------------------------------

    def _take(self, _: object, result: Any) -> None:
        self.made = None if isinstance(result, KindynaError) else result
        text = self.show_made(self.made)
        self._tell(str(result) if self.made is None else text, SCREEN.limit if self.made is None else SCREEN.ink)
        self.export.setEnabled(self.made is not None)

    def _tell(self, text: str, colour: str) -> None:
        self.result.setText(text)
        coloured(self.result, colour)


def flanks(design: Design) -> dict[str, tuple[str, ...]]:
    """The flanks that a form offers of a design's cam."""
    assert design.drive.cam is not None, "a design without cam has no profile"
    return {"flank": form_row(design.drive.cam.form).flanks}


def accepted(dialog: ComputedDialog) -> Any:
    """What was computed, once the user has accepted it; None where the user cancels."""
    made = dialog.made if dialog.exec() == QDialog.DialogCode.Accepted else None
    dialog.deleteLater()
    return made
