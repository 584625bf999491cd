"""Dialogs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
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
from core.errors import KindynaError
from core.frozen import frozen
from core.output.controllers.rows import controllers
from core.output.export import FORMATS, Film, file_names
from core.output.files.cam_drawing import drawing
from core.output.files.sheet import DrawingRequest
from core.output.handover import HandoverFile, HandoverRequest, drive_folders
from core.output.report.document import PAPERS, PARTS, Cover, document
from core.requests import build_request, command_words
from core.study import Study
from kindyna_gui.dialogs import file_to_save, give_help
from kindyna_gui.documents.texts import add_copy
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.request_form import RequestDialog, RequestForm
from kindyna_gui.pictures.paper.report import GoOn, report_file
from kindyna_gui.pictures.paper.sheets import sheet_file
from kindyna_gui.settings import Settings

# -- the dialogs before tables or an animation are written -----------------------------------------------

SIZES = ((480, 360), (640, 480), (800, 600), (1024, 768), (1280, 960))


@frozen
class TablesWanted:
    """Where the tables shall go, and at how many cam angles of a turn."""

    folder: Path
    samples: int


OF_SHAFT = "shaft.csv and summary.json of the whole shaft, and the tables of each drive in a folder of its name"


class TablesDialog(RequestDialog):
    """Folder and cam angles per turn."""

    command, help_page = "export", "tour#Export > Tables"

    def __init__(self, parent: QWidget, folder: Path, study: Study) -> None:
        if study.design.listed:
            files, angle = OF_SHAFT, "machine angle"
        else:
            *first, last = file_names(study.design)
            files, angle = f"{', '.join(first)} and {last}", study.angle_name

        def told(values: Mapping[str, Any]) -> str:
            step = f"One row every {360.0 / values['samples']:.6g}°."
            return f"{step} Writes {files}; files of these names are replaced."

        self.folder = QLineEdit(str(folder))
        self.folder.setAccessibleName("Folder")
        self.folder.setMinimumWidth(360)
        browse = QPushButton("Browse...")
        browse.clicked.connect(self._browse)
        where = QHBoxLayout()
        where.addWidget(self.folder, 1)
        where.addWidget(browse)
        form = RequestForm(ExportArguments, above=[("Folder", where)])
        form.name_row("samples", f"{angle.capitalize()}s per turn")
        super().__init__(parent, "Export tables", form, "Export", told)
        self.folder.textChanged.connect(lambda text: self.accept_button.setEnabled(bool(text.strip())))

    def command_options(self) -> tuple[str, list[str]]:
        return self.folder.text(), command_words(ExportArguments, self.form.values)

    def _browse(self) -> None:
        name = QFileDialog.getExistingDirectory(self, "Export tables into folder", self.folder.text())
        if name:
            self.folder.setText(name)


class FilmDialog(RequestDialog):
    """How an animation of one turn shall be; its size is one of some."""

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
        super().__init__(parent, "Export animation", form, "Save animation...", _frames_told)


def _frames_told(values: Mapping[str, Any]) -> str:
    frames, seconds = values["frames"], values["seconds"]
    return f"a frame every {360.0 / frames:.4g}°, {frames / seconds:.3g} frames per second"


# -- the questions, as functions that tests can answer ----------------------------------------------------


def tables_wanted(parent: QWidget, folder: Path, study: Study) -> TablesWanted | None:
    """Ask where tables shall go; None where the user cancels."""
    dialog = TablesDialog(parent, folder, study)
    values = dialog.values()
    return None if values is None else TablesWanted(Path(dialog.folder.text()).expanduser(), values["samples"])


def film_wanted(parent: QWidget, folder: Path, name: str, seconds: float) -> tuple[Path, Film] | None:
    """Ask what an animation shall be like and for its file."""
    dialog = FilmDialog(parent, seconds)
    values = dialog.values()
    if values is None:
        return None
    width, height = dialog.pixels.currentData()
    film = replace(Film(**values), width=width, height=height)
    suggestion = folder / f"{name}{film.ending}"
    path = file_to_save(parent, suggestion, "Export animation", {film.ending: FORMATS[film.ending]})
    return None if path is None else (path, film)


# -- handover --------------------------------------------------------------------------------------------


def painted(
    study: Study, request: HandoverRequest, go_on: GoOn = lambda done: True
) -> tuple[list[HandoverFile], list[tuple[str, str]]] | None:
    """The files, and what there is none of with the reason; None where it was not to go on. Raises NoSolution where there is no report."""
    made = document(study, cover=request)
    report = report_file(made, ".pdf", go_on)
    if report is None:
        return None
    files = [HandoverFile("report.pdf", "the whole report", report)]
    left_out = [("logo", made.lacking)] if made.lacking else []
    title = {name: getattr(request, name) for name in ("author", "company", "logo", "date")}
    for folder, name, each in drive_folders(study):
        if "cam" not in each.stages:
            continue
        of = f" of {name}" if name else ""
        try:
            files.append(
                HandoverFile(
                    f"{folder}drawing.pdf",
                    f"drawing of the cam{of} for the workshop",
                    sheet_file(drawing(each, DrawingRequest(**title)), ".pdf"),
                )
            )
        except KindynaError as error:
            left_out.append((f"drawing{of}", str(error)))
    return files, left_out


# -- report dialog ---------------------------------------------------------------------------------------

KINDS = {".pdf": "PDF, pages to print", ".html": "HTML, one page for any browser"}
LINES, KEPT = ("customer", "author", "company", "revision", "date", "logo"), ("customer", "author", "company", "logo")
"""What the first page may say, and what of it is the same the next time."""


def kept_cover() -> dict[str, str]:
    """What a first page said the last time, or stands in the preferences."""
    settings = Settings()
    return {**{name: settings.written(name) for name in KEPT}, "paper": settings.written("paper") or next(iter(PAPERS))}


@frozen
class ReportWanted:
    """Ending of the file, the parts that stand in it, what its first page says, whether it is opened when it is written."""

    ending: str
    parts: tuple[str, ...]
    cover: Cover
    opened: bool


class ReportDialog(QDialog):
    """Kind of file and a box for each part that may be left out."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._settings = Settings()
        self.setWindowTitle("Report")
        self.kind = QComboBox()
        for ending, name in KINDS.items():
            self.kind.addItem(name, ending)
        self.parts = {name: QCheckBox(text) for name, text in PARTS.items()}
        self.opened = QCheckBox("Open it")
        kept = kept_cover()
        self.lines = {name: QLineEdit(kept.get(name, "")) for name in LINES}
        self.paper = QComboBox()
        self.paper.addItems(list(PAPERS))
        self.paper.setCurrentText(kept["paper"])
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
        add_copy(buttons, parent, "report", self._asked)
        give_help(self, "tour#writes one file to hand on")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(form)
        column.addWidget(buttons)

    @property
    def wanted(self) -> ReportWanted:
        """Kind of file, chapters, and whether it is opened then."""
        parts = tuple(name for name, box in self.parts.items() if box.isChecked())
        texts = {name: box.text().strip() for name, box in self.lines.items()}
        cover = Cover(**texts, paper=self.paper.currentText())
        return ReportWanted(self.kind.currentData(), parts, cover, self.opened.isChecked())

    def _asked(self) -> tuple[str, list[str]]:
        wanted = self.wanted
        without = [name for name in PARTS if name not in wanted.parts]
        cover = command_words(Cover, {each.name: getattr(wanted.cover, each.name) for each in fields(Cover)})
        return wanted.ending, [*cover, *(["--without", *without] if without else [])]

    def remember(self) -> None:
        """For the next report: who makes them for whom, and on which paper."""
        for name in KEPT:
            self._settings.write(name, self.lines[name].text().strip())
        self._settings.write("paper", self.paper.currentText())


def report_wanted(parent: QWidget) -> ReportWanted | None:
    """Ask what a report shall hold; None where the user cancels."""
    dialog = ReportDialog(parent)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    wanted = dialog.wanted
    if accepted:
        dialog.remember()
    dialog.deleteLater()
    return wanted if accepted else None


def open_outside(path: Path) -> None:
    """Show a file in the program that the desktop has for it."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path.resolve())))


# -- handover dialog -------------------------------------------------------------------------------------

TOLD = "Profile, drawing and inspection table of every cam, report, web page, and the design itself; a list says what each is."


class HandoverDialog(RequestDialog):
    """A controller besides what the form asks."""

    command, help_page = "handover", "tour#Export > Hand-over"

    def command_options(self) -> tuple[str, list[str]]:
        request = self.request
        values = {each.name: getattr(request, each.name) for each in fields(HandoverRequest)}
        return ".zip", command_words(HandoverRequest, values)

    def __init__(self, parent: QWidget) -> None:
        self.controller, self.gcode = QComboBox(), QCheckBox("G-code of every cam too")
        fill_choices(self.controller, {"": "None", **{slug: row.label for slug, row in controllers().items()}})
        first, above = {"paper": kept_cover()["paper"]}, [("Controller", self.controller)]
        form = RequestForm(HandoverRequest, initial=first, above=above)
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
