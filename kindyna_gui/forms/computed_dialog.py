"""A dialog before an export: what the file will hold is computed beside the window for the choices made, and shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtWidgets import QComboBox, QDialog, QDialogButtonBox, QLabel, QPushButton, QWidget

from core.cam import form_row
from core.design import Design
from core.errors import KindynaError
from kindyna_gui.background import Background
from kindyna_gui.look import INK, QUIET, WRONG, coloured

WAITING = "computing ..."


class ComputedDialog(QDialog):
    """``made`` is what was computed for the choices, None while there is none; subclasses lay out ``flank``, ``result`` and
    ``buttons`` with their own choices, and say what they show.

    what: the file, as the title and messages call it.
    """

    def __init__(self, parent: QWidget, design: Design, what: str) -> None:
        super().__init__(parent)
        self.setWindowTitle(f"Export {what}")
        self.made: Any = None
        self._work = Background(self)
        self.flank, self.result = QComboBox(self), QLabel()
        self.result.setWordWrap(True)
        assert design.drive.cam is not None, f"a design without cam has no {what}"
        for name in form_row(design.drive.cam.form).flanks:
            self.flank.addItem(name.capitalize(), name)
        self.flank.setVisible(self.several_flanks)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.export: QPushButton = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.export.setText(f"Save {what}...")
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self._work.result.connect(self._take)
        self.finished.connect(self._work.close)

    @property
    def several_flanks(self) -> bool:
        """Whether there is a choice."""
        return self.flank.count() > 1

    # -- for subclasses -------------------------------------------------------------------------------------

    def show_made(self, made: Any) -> str:
        """Show what was computed, None where there is no answer; in words."""
        raise NotImplementedError

    def show_waiting(self) -> None:
        """Show that something else is being computed."""
        raise NotImplementedError

    def expect(self) -> None:
        """What was computed before is void."""
        self.made = None
        self.export.setEnabled(False)
        self.show_waiting()
        self._tell(WAITING, QUIET)

    def begin(self, compute: Callable[[], Any]) -> None:
        """Compute what the file will hold; what was being computed is given up."""
        self._work.start([("", compute)])

    # -- what comes of it -----------------------------------------------------------------------------------

    def _take(self, _: object, result: Any) -> None:
        self.made = None if isinstance(result, KindynaError) else result
        text = self.show_made(self.made)
        self._tell(str(result) if self.made is None else text, WRONG if self.made is None else INK)
        self.export.setEnabled(self.made is not None)

    def _tell(self, text: str, colour: str) -> None:
        self.result.setText(text)
        coloured(self.result, colour)


def accepted(dialog: ComputedDialog) -> Any:
    """What was computed, once the user has accepted it; None where the user cancels."""
    made = dialog.made if dialog.exec() == QDialog.DialogCode.Accepted else None
    dialog.deleteLater()
    return made
