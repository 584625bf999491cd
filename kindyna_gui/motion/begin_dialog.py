"""The dialog before a design that begins with its motion: an indexer, a flying shear; its peaks are told at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from PySide6.QtWidgets import QWidget

from core.design import Design
from core.errors import KindynaError
from core.frozen import frozen
from core.motion.curves import FlyingShear, Indexer, flying_shear, indexer
from core.output.channels import begun_text
from core.requests import command_words
from kindyna_gui.forms.request_dialog import RequestDialog
from kindyna_gui.forms.request_form import RequestForm

WIDTH = 380  # pixels


@frozen
class Beginning:
    """One row: title, command of the command line, what is asked for, what makes the design of it."""

    title: str
    command: str
    kind: Any
    make: Callable[[Any], Design]


BEGINNINGS: Mapping[str, Beginning] = MappingProxyType(
    {
        "indexer": Beginning("Indexer", "indexer", Indexer, indexer),
        "flying_shear": Beginning("Flying shear", "flying-shear", FlyingShear, flying_shear),
    }
)


class BeginDialog(RequestDialog):
    """The form of a row of ``BEGINNINGS``."""

    reads = False

    def __init__(self, parent: QWidget, row: Beginning) -> None:
        self.row, self.command, self.help_page = row, row.command, f"making#{row.title}"
        super().__init__(
            parent, f"New {row.title[:1].lower()}{row.title[1:]}", RequestForm(row.kind), "Begin", self._tell
        )
        self.told.setFixedWidth(WIDTH)
        self.told.setMinimumHeight(6 * self.fontMetrics().lineSpacing())
        self.form.changed.connect(self._allow)
        self._allow()

    def asked(self) -> tuple[str, list[str]]:
        return f"{self.command}.toml", command_words(self.row.kind, self.form.values)

    def design(self) -> Design:
        """That is asked for. Raises DesignError where it cannot be."""
        return self.row.make(self.row.kind(**self.form.values))

    def _tell(self, values: Mapping[str, Any]) -> str:
        try:
            return begun_text(self.row.make(self.row.kind(**values)))
        except KindynaError as error:
            return str(error)

    def _allow(self) -> None:
        try:
            self.design()
        except KindynaError:
            self.accept_button.setEnabled(False)
        else:
            self.accept_button.setEnabled(True)


def beginning_wanted(parent: QWidget, name: str) -> Design | None:
    """Ask for what a design begins with; None where the user cancels."""
    dialog = BeginDialog(parent, BEGINNINGS[name])
    accepted = dialog.exec() == RequestDialog.DialogCode.Accepted
    made = dialog.design() if accepted else None
    dialog.deleteLater()
    return made


__all__ = ["BEGINNINGS", "BeginDialog", "beginning_wanted"]
