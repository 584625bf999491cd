"""The dialogs before tables or an animation are written, and the progress of what takes long."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QDoubleSpinBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from core.frozen import frozen
from core.output.export import names
from core.study import SAMPLES, Study
from kindyna_gui.dialogs import file_to_save
from kindyna_gui.look import QUIET, coloured
from kindyna_gui.pictures.film import FORMATS, LEAST_SECONDS, MOST_FRAMES, Film

LEAST_SAMPLES, MOST_SAMPLES = 36, 5_000_000
SIZES = ((480, 360), (640, 480), (800, 600), (1024, 768), (1280, 960))
USUAL_SIZE = (800, 600)


@frozen
class TablesWanted:
    """Where the tables shall go, and at how many cam angles of a turn."""

    folder: Path
    samples: int


class TablesDialog(QDialog):
    """Folder and cam angles per turn."""

    def __init__(self, parent: QWidget, folder: Path, study: Study, several: bool = False) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export tables")
        self.folder = QLineEdit(str(folder))
        self.folder.setMinimumWidth(360)
        browse = QPushButton("Browse...")
        browse.clicked.connect(self._browse)
        self.samples = QSpinBox(minimum=LEAST_SAMPLES, maximum=MOST_SAMPLES, value=SAMPLES)
        self.samples.setGroupSeparatorShown(False)
        self.step = QLabel()
        coloured(self.step, QUIET)
        self.samples.valueChanged.connect(self._show_summary)
        self._show_summary(SAMPLES)
        where, how_many = QHBoxLayout(), QHBoxLayout()
        where.addWidget(self.folder, 1)
        where.addWidget(browse)
        how_many.addWidget(self.samples)
        how_many.addWidget(self.step, 1)
        *first, last = names(study.design)
        files = f"{', '.join(first)} and {last}"
        if several:
            files = (
                "shaft.csv and summary.json of the whole shaft, and the tables of each drive in a folder of its name"
            )
        summary = QLabel(f"Writes {files}; files of these names are replaced.")
        summary.setWordWrap(True)
        coloured(summary, QUIET)
        form = QFormLayout()
        form.addRow("Folder", where)
        form.addRow("Machine angles per turn" if several else f"{study.angle_name.capitalize()}s per turn", how_many)
        export = _lay_out(self, form, summary, "Export")
        self.folder.textChanged.connect(lambda text: export.setEnabled(bool(text.strip())))

    @property
    def wanted(self) -> TablesWanted:
        return TablesWanted(Path(self.folder.text()).expanduser(), self.samples.value())

    def _show_summary(self, samples: int) -> None:
        self.step.setText(f"one row every {360.0 / samples:.6g}°")

    def _browse(self) -> None:
        name = QFileDialog.getExistingDirectory(self, "Export tables into folder", self.folder.text())
        if name:
            self.folder.setText(name)


class FilmDialog(QDialog):
    """Frames, size, format and duration of an animation of one turn."""

    def __init__(self, parent: QWidget, seconds: float) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export animation")
        self.format = QComboBox()
        for ending, name in FORMATS.items():
            self.format.addItem(name, ending)
        self.pixels = QComboBox()
        for width, height in SIZES:
            self.pixels.addItem(f"{width} \u00d7 {height} pixels", (width, height))
        self.pixels.setCurrentIndex(SIZES.index(USUAL_SIZE))
        self.frames = QSpinBox(minimum=8, maximum=MOST_FRAMES, value=72, singleStep=12)
        self.seconds = QDoubleSpinBox(minimum=LEAST_SECONDS, maximum=600.0, decimals=2, singleStep=0.5)
        self.seconds.setValue(seconds)
        self.seconds.setSuffix(" s")
        self.summary = QLabel()
        coloured(self.summary, QUIET)
        for box in (self.frames, self.seconds):
            box.valueChanged.connect(self._show_summary)
        self._show_summary()
        form = QFormLayout()
        form.addRow("Format", self.format)
        form.addRow("Size", self.pixels)
        form.addRow("Frames per turn", self.frames)
        form.addRow("One turn takes", self.seconds)
        _lay_out(self, form, self.summary, "Save animation...")

    @property
    def wanted(self) -> Film:
        width, height = self.pixels.currentData()
        return Film(self.format.currentData(), self.frames.value(), width, height, self.seconds.value())

    def _show_summary(self, *_: object) -> None:
        frames, seconds = self.frames.value(), self.seconds.value()
        self.summary.setText(f"a frame every {360.0 / frames:.4g}°, {frames / seconds:.3g} frames per second")


def _lay_out(dialog: QDialog, form: QFormLayout, summary: QLabel, accept: str) -> QPushButton:
    """Form, what it means, and the buttons below; the one that accepts."""
    buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
    buttons.button(QDialogButtonBox.StandardButton.Ok).setText(accept)
    buttons.accepted.connect(dialog.accept)
    buttons.rejected.connect(dialog.reject)
    column = QVBoxLayout(dialog)
    column.addLayout(form)
    column.addWidget(summary)
    column.addWidget(buttons)
    return buttons.button(QDialogButtonBox.StandardButton.Ok)


# -- the questions, as functions that tests can answer ----------------------------------------------------


def tables_wanted(parent: QWidget, folder: Path, study: Study, several: bool = False) -> TablesWanted | None:
    """Ask where tables shall go; None where the user cancels."""
    dialog = TablesDialog(parent, folder, study, several)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    wanted = dialog.wanted if accepted else None
    dialog.deleteLater()
    return wanted


def film_wanted(parent: QWidget, folder: Path, name: str, seconds: float) -> tuple[Path, Film] | None:
    """Ask what an animation shall be like and for its file."""
    dialog = FilmDialog(parent, seconds)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    film = dialog.wanted if accepted else None
    dialog.deleteLater()
    if film is None:
        return None
    suggestion = folder / f"{name}{film.ending}"
    path = file_to_save(parent, suggestion, "Export animation", {film.ending: FORMATS[film.ending]})
    return None if path is None else (path, film)
