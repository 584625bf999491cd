"""Dialogs before tables, animation, report and hand-over are written, and the functions that open them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.commands.export import ExportArguments
from core.design import Design
from core.errors import KindynaError
from core.frozen import frozen
from core.output.controllers.rows import controllers
from core.output.export import FORMATS, Film, file_names
from core.output.handover import HandoverRequest
from core.output.report.document import PAPERS, PARTS, Cover
from core.requests import build_request, command_words
from core.study import Study
from core.valves.figures import LiftTableRequest, lift_table, table_steps
from kindyna_gui.dialogs import file_to_save, give_help
from kindyna_gui.documents.texts import add_copy
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import NameBox
from kindyna_gui.forms.refusal import FloatingRefusal
from kindyna_gui.forms.request_form import RequestDialog, RequestForm
from kindyna_gui.look import described
from kindyna_gui.pictures.units import short
from kindyna_gui.rebuilt import fill
from kindyna_gui.settings import Settings

# -- tables and animation --------------------------------------------------------------------------------

SIZES = ((480, 360), (640, 480), (800, 600), (1024, 768), (1280, 960))


@frozen
class TablesRequest:
    """Folder of the tables, and number of cam angles per turn."""

    folder: Path
    samples: int


SHAFT_FILES = "shaft.csv and summary.json of the shaft, and the tables of each drive in a folder of its name"


class TablesDialog(RequestDialog):
    """Dialog for the folder and the number of cam angles per turn."""

    command, help_page = "export", "tour#Export > Tables"

    def __init__(self, parent: QWidget, folder: Path, study: Study) -> None:
        if study.design.listed:
            files, angle = SHAFT_FILES, "machine angle"
        else:
            *first, last = file_names(study.design)
            files, angle = f"{', '.join(first)} and {last}", study.angle_name

        def summary(values: Mapping[str, Any]) -> str:
            step = f"One row every {short(360.0 / values['samples'])}°."
            return f"{step} Writes {files}. Files with these names are replaced."

        self.folder = described(NameBox(str(folder)), name="Folder")
        self.folder.setMinimumWidth(360)
        browse = QPushButton("Browse...")
        browse.clicked.connect(self._browse)
        where = fill(QHBoxLayout(), (self.folder, 1), browse)
        form = RequestForm(ExportArguments, above=[("Folder", where)])
        form.name_row("samples", f"{angle.capitalize()}s per turn")
        super().__init__(parent, "Export tables", form, "Export", summary)
        self._refusal, self._first = FloatingRefusal(self.folder), folder
        self.folder.textChanged.connect(self._judge_folder)

    @property
    def is_complete(self) -> bool:
        return super().is_complete and bool(self.folder.text().strip())

    def _judge_folder(self, text: str) -> None:
        is_wrong = not text.strip()
        self.folder.set_refused(is_wrong)
        back = {f"Back to {self._first.name}": partial(self.folder.setText, str(self._first))}
        self._refusal.show_refusal("Enter the folder of the tables" if is_wrong else "", back)
        self.update_summary()

    def command_options(self) -> tuple[str, list[str]]:
        return self.folder.text(), command_words(ExportArguments, self.form.values)

    def _browse(self) -> None:
        name = QFileDialog.getExistingDirectory(self, "Export tables into folder", self.folder.text())
        if name:
            self.folder.setText(name)


class FilmDialog(RequestDialog):
    """Dialog for the size, duration and format of an animation of one turn."""

    command, help_page = "animation", "tour#Export > Animation"

    def command_options(self) -> tuple[str, list[str]]:
        width, height = self.pixels.currentData()
        values = self.form.values
        return Film(**values).ending, [*command_words(Film, values), "--size", f"{width}x{height}"]

    def __init__(self, parent: QWidget, seconds: float) -> None:
        self.pixels = QComboBox()
        for width, height in SIZES:
            self.pixels.addItem(f"{width} \u00d7 {height} pixels", (width, height))
        self.pixels.setCurrentIndex(SIZES.index((Film().width, Film().height)))
        form = RequestForm(Film, initial={"seconds": seconds}, above=[("Size", self.pixels)])
        super().__init__(parent, "Export animation", form, "Save animation...", _frame_summary)


def _frame_summary(values: Mapping[str, Any]) -> str:
    frames, seconds = values["frames"], values["seconds"]
    return f"a frame every {short(360.0 / frames)}°, {short(frames / seconds, 3)} frames per second"


class LiftTableDialog(RequestDialog):
    """Dialog for step and unit of the lift table of a lobe."""

    command, of_drive, file_option, help_page = "valve", True, "--table", "valves#From the card to both valves"

    def __init__(self, parent: QWidget, design: Design) -> None:
        def summary(values: Mapping[str, Any]) -> str:
            try:
                (_, lift_name), (_, lift) = lift_table(design, values["step"], values["unit"])
            except KindynaError:
                return f"{short(values['step'])}° does not divide the turn: use 360° over a whole number, such as 1° or 0.5°."
            most = f"{short(lift.max(), 6)} {values['unit']}"
            return f"{lift.size} rows from −180° to 180° of the cam from the nose, {lift_name} up to {most}, as CSV."

        super().__init__(parent, "Export lift table", RequestForm(LiftTableRequest), "Export...", summary)

    @property
    def is_complete(self) -> bool:
        if not super().is_complete:
            return False
        try:
            return bool(table_steps(self.form.values["step"]))
        except KindynaError:
            return False

    def command_options(self) -> tuple[str, list[str]]:
        return ".csv", command_words(LiftTableRequest, self.form.values)


def ask_lift_table(parent: QWidget, design: Design) -> LiftTableRequest | None:
    """Ask for step and unit of the lift table of a drive; None where the user cancels."""
    values = LiftTableDialog(parent, design).values()
    return None if values is None else LiftTableRequest(**values)


def ask_tables(parent: QWidget, folder: Path, study: Study) -> TablesRequest | None:
    """Ask for the folder of the tables; None where the user cancels."""
    dialog = TablesDialog(parent, folder, study)
    values = dialog.values()
    return None if values is None else TablesRequest(Path(dialog.folder.text()).expanduser(), values["samples"])


def ask_animation(parent: QWidget, folder: Path, name: str, seconds: float) -> tuple[Path, Film] | None:
    """Ask for the settings of an animation and its file; None where the user cancels."""
    dialog = FilmDialog(parent, seconds)
    values = dialog.values()
    if values is None:
        return None
    width, height = dialog.pixels.currentData()
    film = replace(Film(**values), width=width, height=height)
    suggestion = folder / f"{name}{film.ending}"
    path = file_to_save(parent, suggestion, "Export animation", {film.ending: FORMATS[film.ending]})
    return None if path is None else (path, film)


# -- report dialog ---------------------------------------------------------------------------------------

KINDS = {".pdf": "PDF, pages to print", ".html": "HTML, one page for any browser"}
COVER_LINES = ("customer", "author", "company", "revision", "date", "logo")
"""Lines of the first page."""
SAVED_LINES = ("customer", "author", "company", "logo")
"""Lines that the next report begins with."""


def saved_cover() -> dict[str, str]:
    """Lines and paper size of the last report, or of the preferences."""
    settings = Settings()
    return {
        **{name: settings.written(name) for name in SAVED_LINES},
        "paper": settings.written("paper") or next(iter(PAPERS)),
    }


@frozen
class ReportRequest:
    """Ending of the file, its parts, its first page, and whether it is opened afterwards."""

    ending: str
    parts: tuple[str, ...]
    cover: Cover
    opened: bool


class ReportDialog(QDialog):
    """Dialog for the kind of file, the first page, and the parts of a report."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._settings = Settings()
        self.setWindowTitle("Report")
        self.kind = QComboBox()
        for ending, name in KINDS.items():
            self.kind.addItem(name, ending)
        self.parts = {name: QCheckBox(text) for name, text in PARTS.items()}
        self.opened = QCheckBox("Open it")
        saved = saved_cover()
        self.lines = {name: QLineEdit(saved.get(name, "")) for name in COVER_LINES}
        self.paper = QComboBox()
        self.paper.addItems(list(PAPERS))
        self.paper.setCurrentText(saved["paper"])
        boxes = QVBoxLayout()
        for box in self.parts.values():
            box.setChecked(True)
            boxes.addWidget(box)
        form = QFormLayout()
        form.addRow("File", self.kind)
        for name, line in self.lines.items():
            line.setPlaceholderText("none")
            form.addRow(name.capitalize(), line)
        form.addRow("Paper", self.paper)
        form.addRow("With", boxes)
        form.addRow("Then", self.opened)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.button(QDialogButtonBox.StandardButton.Ok).setText("Save report...")
        add_copy(buttons, parent, "report", self._command_options)
        give_help(self, "tour#writes one file to hand on")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        fill(QVBoxLayout(self), form, buttons)

    @property
    def request(self) -> ReportRequest:
        """The report that the dialog describes."""
        parts = tuple(name for name, box in self.parts.items() if box.isChecked())
        texts = {name: box.text().strip() for name, box in self.lines.items()}
        cover = Cover(**texts, paper=self.paper.currentText())
        return ReportRequest(self.kind.currentData(), parts, cover, self.opened.isChecked())

    def _command_options(self) -> tuple[str, list[str]]:
        request = self.request
        without = [name for name in PARTS if name not in request.parts]
        cover = command_words(Cover, {field.name: getattr(request.cover, field.name) for field in fields(Cover)})
        return request.ending, [*cover, *(["--without", *without] if without else [])]

    def remember(self) -> None:
        """Save customer, author, company, logo and paper for the next report."""
        for name in SAVED_LINES:
            self._settings.write(name, self.lines[name].text().strip())
        self._settings.write("paper", self.paper.currentText())


def ask_report(parent: QWidget) -> ReportRequest | None:
    """Ask for the settings of a report; None where the user cancels."""
    dialog = ReportDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    request = dialog.request
    if accepted:
        dialog.remember()
    dialog.deleteLater()
    return request if accepted else None


def open_outside(path: Path) -> None:
    """Open a file in the default program of the desktop."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path.resolve())))


# -- hand-over dialog ------------------------------------------------------------------------------------

CONTENT = (
    "Profile, drawing and inspection table of every cam, its solid where the design states the dimensions, report, web page, "
    "the design itself, and a list of all files."
)


class HandoverDialog(RequestDialog):
    """Dialog for the contents of a hand-over, with a controller and G-code."""

    command, help_page = "handover", "tour#Export > Hand-over"

    def command_options(self) -> tuple[str, list[str]]:
        request = self.request
        values = {field.name: getattr(request, field.name) for field in fields(HandoverRequest)}
        return ".zip", command_words(HandoverRequest, values)

    def __init__(self, parent: QWidget) -> None:
        self.controller, self.gcode = QComboBox(), QCheckBox("G-code of every cam too")
        fill_choices(self.controller, {"": "None", **{slug: row.label for slug, row in controllers().items()}})
        first, above = {"paper": saved_cover()["paper"]}, [("Controller", self.controller)]
        form = RequestForm(HandoverRequest, initial=first, above=above)
        form.rows.addRow("", self.gcode)
        super().__init__(parent, "Hand-over", form, "Save hand-over...", lambda values: CONTENT)

    @property
    def request(self) -> HandoverRequest:
        """The hand-over that the dialog describes."""
        choices = {"controller": self.controller.currentData(), "gcode": self.gcode.isChecked()}
        return build_request(HandoverRequest, {**saved_cover(), **self.form.values, **choices})


def ask_handover(parent: QWidget) -> HandoverRequest | None:
    """Ask for the contents of a hand-over; None where the user cancels."""
    dialog = HandoverDialog(parent)
    return None if dialog.values() is None else dialog.request
