"""The dialog before a hand-over is written: for which controller, with which error, with G-code or without."""

from __future__ import annotations

from dataclasses import fields

from PySide6.QtWidgets import QCheckBox, QComboBox, QWidget

from core.output.controllers.rows import controllers
from core.output.handover import HandoverRequest
from core.requests import build_request, command_words
from kindyna_gui.export.report_dialog import kept_cover
from kindyna_gui.forms.amount import fill_choices
from kindyna_gui.forms.request_dialog import RequestDialog
from kindyna_gui.forms.request_form import RequestForm

TOLD = "Profile, drawing and inspection table of every cam, report, web page, and the design itself; a list says what each is."


class HandoverDialog(RequestDialog):
    """A controller besides what the form asks."""

    command, help_page = "handover", "tour#Export > Hand-over"

    def asked(self) -> tuple[str, list[str]]:
        request = self.request
        values = {each.name: getattr(request, each.name) for each in fields(HandoverRequest)}
        return ".zip", command_words(HandoverRequest, values)

    def __init__(self, parent: QWidget) -> None:
        self.controller, self.gcode = QComboBox(), QCheckBox("G-code of every cam too")
        fill_choices(self.controller, {"": "None", **{slug: row.label for slug, row in controllers().items()}})
        first, above = {"paper": kept_cover()["paper"]}, [("Controller", self.controller)]
        form = RequestForm(HandoverRequest, first=first, above=above)
        form.rows.addRow("", self.gcode)
        super().__init__(parent, "Hand-over", form, "Save hand-over...", lambda values: TOLD)

    @property
    def request(self) -> HandoverRequest:
        """As it stands."""
        own = {"controller": self.controller.currentData(), "gcode": self.gcode.isChecked()}
        return build_request(HandoverRequest, {**kept_cover(), **self.form.values, **own})


def handover_wanted(parent: QWidget) -> HandoverRequest | None:
    """Ask what a hand-over shall hold; None where the user cancels."""
    dialog = HandoverDialog(parent)
    return None if dialog.values() is None else dialog.request


__all__ = ["HandoverDialog", "handover_wanted"]
