"""The dialog before a profile is written: its request and the format, with a picture of what comes of it and the deviation."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtWidgets import QComboBox, QWidget

from core.design import Design
from core.output.files.files import FORMATS, profile_job
from core.output.files.profile_files import ProfileDrawing
from core.output.files.profile_fit import FITS
from core.output.files.profile_request import Machining, ProfileRequest, rounded_up
from core.requests import request_fields
from core.study import Study
from kindyna_gui.export.profile_preview import Preview, PreviewPicture, preview
from kindyna_gui.forms.amount import fill_choices
from kindyna_gui.forms.computed_dialog import ComputedDialog, accepted, flanks
from kindyna_gui.forms.request_form import RequestForm

FIRST = {"samples": 360, "spacing_mm": 1.0, "tolerance_mm": 1e-3}


class ProfileDialog(ComputedDialog):
    """What the file shall hold; ``job`` is what was computed for it, None while there is none."""

    command, help_page = "profile", "tour#Export > Profile"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design, self.format, self.picture = design, QComboBox(), PreviewPicture()
        cutter = getattr(design.drive.cam, "cutter_radius_mm", None) or 0.0
        form = RequestForm(ProfileRequest, flanks(design), {**FIRST, "cutter_mm": cutter}, [("Format", self.format)])
        super().__init__(parent, "profile", form, self.picture)
        fill_choices(self.format, {ending: f"{row.label} ({ending})" for ending, row in FORMATS.items()})
        self.format.setCurrentIndex(self.format.findData(".dxf"))
        form.choose("Points", FORMATS[".dxf"].sampling[0])
        self.format.currentIndexChanged.connect(self._suit_format)
        self._suit_format()

    @property
    def ending(self) -> str:  # type: ignore[override]
        """The kind of file that is chosen: ``.dxf``."""
        ending: str = self.format.currentData()
        return ending

    def _suit_format(self) -> None:
        """What the format can hold, and how a machine that follows it goes."""
        row = FORMATS[self.ending]
        for each in request_fields(Machining):
            self.form.rows.setRowVisible(self.form.boxes[each.name], row.machined)
        fit = self.form.boxes["fit"]
        fit.blockSignals(True)
        fill_choices(fit, {name: FITS[name].label.capitalize() for name in row.fits})
        fit.blockSignals(False)
        self.changed()

    def job(self) -> Callable[[], Preview]:
        return partial(_computed, self._design, self.ending, self.form.request)

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_made(self, made: Preview | None) -> str:
        self.picture.show_preview(made)
        return "" if made is None else _summary(made.job)


def _computed(design: Design, ending: str, request: ProfileRequest) -> Preview:
    return preview(profile_job(Study(design), Path(f"profile{ending}"), request))


def _summary(job: ProfileDrawing) -> str:
    """What the file will hold."""
    main = job.main
    return (
        f"{main.count} points on {main.curve.length:.6g} mm, at most {rounded_up(main.deviation, 3):g} mm from the exact curve "
        "(red ring)."
    )


def profile_wanted(parent: QWidget, design: Design) -> tuple[ProfileDrawing, str] | None:
    """Ask what a profile file shall hold, computed, and the ending of its name; None where the user cancels."""
    dialog = ProfileDialog(parent, design)
    made: Preview | None = accepted(dialog)
    return None if made is None else (made.job, dialog.ending)
