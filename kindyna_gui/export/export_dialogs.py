"""The dialogs before tables or an animation are written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtWidgets import QComboBox, QFileDialog, QHBoxLayout, QLineEdit, QPushButton, QWidget

from core.commands.export import ExportArguments
from core.frozen import frozen
from core.output.export import FORMATS, Film, names
from core.requests import command_words
from core.study import Study
from kindyna_gui.dialogs import file_to_save
from kindyna_gui.forms.request_dialog import RequestDialog
from kindyna_gui.forms.request_form import RequestForm

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
            *first, last = names(study.design)
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

    def asked(self) -> tuple[str, list[str]]:
        return self.folder.text(), command_words(ExportArguments, self.form.values)

    def _browse(self) -> None:
        name = QFileDialog.getExistingDirectory(self, "Export tables into folder", self.folder.text())
        if name:
            self.folder.setText(name)


class FilmDialog(RequestDialog):
    """How an animation of one turn shall be; its size is one of some."""

    command, help_page = "animation", "tour#Export > Animation"

    def asked(self) -> tuple[str, list[str]]:
        width, height = self.pixels.currentData()
        values = self.form.values
        return Film(**values).ending, [*command_words(Film, values), "--size", f"{width}x{height}"]

    def __init__(self, parent: QWidget, seconds: float) -> None:
        self.pixels = QComboBox()
        for width, height in SIZES:
            self.pixels.addItem(f"{width} \u00d7 {height} pixels", (width, height))
        self.pixels.setCurrentIndex(SIZES.index((Film().width, Film().height)))
        form = RequestForm(Film, first={"seconds": seconds}, above=[("Size", self.pixels)])
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
