"""The dialog before a profile is written: format, points, what runs through them, flank, cutter; with a picture of what comes of
it and the deviation, computed beside the window."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.cam import form_row
from core.design import Design
from core.errors import KindynaError
from core.frozen import frozen
from core.output.profile import FITS, FORMATS, LEAST_POINTS, MOST_POINTS, Job, Request, job_of
from core.output.profile.digits import rounded_up
from core.study import Study
from kindyna_gui.background import Background
from kindyna_gui.documents.profile_preview import Preview, PreviewPicture, preview
from kindyna_gui.forms.amount import Amount, fill_choices
from kindyna_gui.look import INK, QUIET, WRONG, coloured

PAUSE_MS = 150  # after the last change before a preview is computed
FORM_WIDTH = 300  # pixels


@frozen
class Entry:
    """How a sampling's value is entered: text of the choice, unit, decimals, range, first value."""

    text: str
    unit: str
    decimals: int
    low: float
    high: float
    first: float


ENTRIES: Mapping[str, Entry] = MappingProxyType(
    {
        "tolerance": Entry("The fewest that keep a tolerance", " mm", 6, 1e-6, 100.0, 1e-3),
        "spacing": Entry("At equal arc lengths", " mm", 4, 1e-4, 1e4, 1.0),
        "samples": Entry("At equal cam angles", "", 0, LEAST_POINTS, MOST_POINTS, 360),
    }
)


class ProfileDialog(QDialog):
    """What the file shall hold; ``job`` is what was computed for it, None while there is none."""

    def __init__(self, parent: QWidget, design: Design) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export profile")
        self.job: Job | None = None
        self._design, self._work = design, Background(self)
        self._values = {name: row.first for name, row in ENTRIES.items()}
        self.format, self.points, self.fit, self.flank = (QComboBox(self) for _ in range(4))
        self.value, self.cutter = Amount(), Amount()
        fill_choices(self.format, {ending: f"{row.label} ({ending})" for ending, row in FORMATS.items()})
        self.format.setCurrentIndex(self.format.findData(".dxf"))
        fill_choices(self.points, {name: row.text for name, row in ENTRIES.items()})
        assert design.drive.cam is not None, "a design without cam has no profile"
        fill_choices(self.flank, {name: name.capitalize() for name in form_row(design.drive.cam.form).flanks})
        self.cutter.setDecimals(4)
        self.cutter.setRange(0.0, 1e5)
        self.cutter.setSuffix(" mm")
        self.cutter.setSpecialValueText("none: the profile itself")
        self.picture, self.result = PreviewPicture(), QLabel()
        self.result.setWordWrap(True)
        self.result.setMinimumHeight(5 * self.fontMetrics().lineSpacing())
        self._lay_out()
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(self._compute)
        self._work.result.connect(self._take)
        self.format.currentIndexChanged.connect(self._offer_fits)
        self.points.currentIndexChanged.connect(self._offer_value)
        for box in (self.fit, self.flank):
            box.currentIndexChanged.connect(self._changed)
        for amount in (self.value, self.cutter):
            amount.valueChanged.connect(self._changed)
        self.finished.connect(self._work.close)
        self._offer_value()
        self._offer_fits()

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.addRow("Format", self.format)
        form.addRow("Points", self.points)
        form.addRow("", self.value)
        form.addRow("Between them", self.fit)
        if self.flank.count() > 1:
            form.addRow("Flank", self.flank)
        self.flank.setVisible(self.flank.count() > 1)
        form.addRow("Cutter radius", self.cutter)
        left = QVBoxLayout()
        left.addLayout(form)
        left.addWidget(self.result)
        left.addStretch(1)
        self.result.setFixedWidth(FORM_WIDTH)
        sides = QHBoxLayout()
        sides.addLayout(left)
        sides.addWidget(self.picture, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.export: QPushButton = buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.export.setText("Choose file...")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(sides)
        column.addWidget(buttons)

    # -- what is wanted --------------------------------------------------------------------------------------

    @property
    def ending(self) -> str:
        ending: str = self.format.currentData()
        return ending

    @property
    def request(self) -> Request:
        return Request(
            self.points.currentData(), self.value.value(), self.fit.currentData(), self.flank.currentData(), self.cutter.value()
        )

    def _offer_fits(self) -> None:
        """What the format can hold."""
        fill_choices(self.fit, {name: FITS[name].label.capitalize() for name in FORMATS[self.ending].fits})
        self._changed()

    def _offer_value(self) -> None:
        """The value of the sampling chosen, as it was when it was chosen last."""
        name = self.points.currentData()
        row = ENTRIES[name]
        self.value.blockSignals(True)
        self.value.setDecimals(row.decimals)
        self.value.setRange(row.low, row.high)
        self.value.setSuffix(row.unit)
        self.value.setValue(self._values[name])
        self.value.blockSignals(False)
        self._changed()

    # -- what comes of it ------------------------------------------------------------------------------------

    def _changed(self) -> None:
        if self.fit.currentData() is None:  # while it is filled
            return
        self._values[self.points.currentData()] = self.value.value()
        self.job = None
        self.export.setEnabled(False)
        self.picture.wait()
        self._tell("computing ...", QUIET)
        self._pause.start()

    def _compute(self) -> None:
        self._work.start([("", partial(_computed, self._design, self.ending, self.request))])

    def _take(self, _: object, result: Preview | KindynaError) -> None:
        if self._pause.isActive():  # it has been changed since
            return
        if isinstance(result, Preview):
            self.job = result.job
            self.picture.show_preview(result)
            self._tell(_summary(result.job), INK)
        else:
            self.picture.show_preview(None)
            self._tell(str(result), WRONG)
        self.export.setEnabled(self.job is not None)

    def _tell(self, text: str, colour: str) -> None:
        self.result.setText(text)
        coloured(self.result, colour)


def _computed(design: Design, ending: str, request: Request) -> Preview:
    return preview(job_of(Study(design), Path(f"profile{ending}"), request))


def _summary(job: Job) -> str:
    """What the file will hold."""
    main = job.main
    return (
        f"{main.count} points on {main.curve.length:.6g} mm, at most {rounded_up(main.deviation, 3):g} mm from the exact curve "
        "(red ring)."
    )


def profile_wanted(parent: QWidget, design: Design) -> tuple[Job, str] | None:
    """Ask what a profile file shall hold, computed, and the ending of its name; None where the user cancels."""
    dialog = ProfileDialog(parent, design)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    job, ending = dialog.job if accepted else None, dialog.ending
    dialog.deleteLater()
    return None if job is None else (job, ending)
