"""The dialog before a profile is written: format, points, what runs through them, flank, cutter; with a picture of what comes of
it and the deviation, computed beside the window."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QCheckBox, QComboBox, QFormLayout, QHBoxLayout, QVBoxLayout, QWidget

from core.design import Design
from core.frozen import frozen
from core.output.profile import FITS, FORMATS, LEAST_POINTS, MACHINING, MOST_POINTS, Job, Machining, Request, job_of
from core.output.profile.digits import rounded_up
from core.study import Study
from kindyna_gui.export.profile_preview import Preview, PreviewPicture, preview
from kindyna_gui.forms.amount import Amount, fill_choices
from kindyna_gui.forms.computed_dialog import ComputedDialog, accepted

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


class ProfileDialog(ComputedDialog):
    """What the file shall hold; ``job`` is what was computed for it, None while there is none."""

    def __init__(self, parent: QWidget, design: Design) -> None:
        super().__init__(parent, design, "profile")
        self._design = design
        self._values = {name: row.first for name, row in ENTRIES.items()}
        self.format, self.points, self.fit = (QComboBox(self) for _ in range(3))
        self.value, self.cutter = Amount(), Amount()
        fill_choices(self.format, {ending: f"{row.label} ({ending})" for ending, row in FORMATS.items()})
        self.format.setCurrentIndex(self.format.findData(".dxf"))
        fill_choices(self.points, {name: row.text for name, row in ENTRIES.items()})
        self.cutter.setDecimals(4)
        self.cutter.setRange(0.0, 1e5)
        self.cutter.setSuffix(" mm")
        self.cutter.setSpecialValueText("none: the profile itself")
        self.cutter.setValue(getattr(design.drive.cam, "cutter_radius_mm", None) or 0.0)
        self.machining = {row.name: Amount() for row in MACHINING}
        self.conventional = QCheckBox("Conventional instead of climb milling")
        self.picture = PreviewPicture()
        self.result.setMinimumHeight(5 * self.fontMetrics().lineSpacing())
        self._lay_out()
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(self._compute)
        self.format.currentIndexChanged.connect(self._offer_fits)
        self.points.currentIndexChanged.connect(self._offer_value)
        for box in (self.fit, self.flank):
            box.currentIndexChanged.connect(self._changed)
        for amount in (self.value, self.cutter, *self.machining.values()):
            amount.valueChanged.connect(self._changed)
        self.conventional.toggled.connect(self._changed)
        self._offer_value()
        self._offer_fits()

    @property
    def job(self) -> Job | None:
        return None if self.made is None else self.made.job

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.addRow("Format", self.format)
        form.addRow("Points", self.points)
        form.addRow("", self.value)
        form.addRow("Between them", self.fit)
        if self.several_flanks:
            form.addRow("Flank", self.flank)
        form.addRow("Cutter radius", self.cutter)
        usual = Machining()
        for row in MACHINING:
            amount = self.machining[row.name]
            amount.setDecimals(4)
            amount.setRange(row.low, row.high)
            amount.setSuffix(f" {row.unit}")
            amount.setSpecialValueText(row.zero)
            amount.setValue(getattr(usual, row.name))
            amount.setToolTip(f"{row.label}: {row.help}")
            form.addRow(row.label, amount)
        form.addRow("", self.conventional)
        self._form = form
        left = QVBoxLayout()
        left.addLayout(form)
        left.addWidget(self.result)
        left.addStretch(1)
        self.result.setFixedWidth(FORM_WIDTH)
        sides = QHBoxLayout()
        sides.addLayout(left)
        sides.addWidget(self.picture, 1)
        column = QVBoxLayout(self)
        column.addLayout(sides)
        column.addWidget(self.buttons)

    # -- what is wanted --------------------------------------------------------------------------------------

    @property
    def ending(self) -> str:
        ending: str = self.format.currentData()
        return ending

    @property
    def request(self) -> Request:
        how = {name: amount.value() for name, amount in self.machining.items()}
        return Request(
            self.points.currentData(),
            self.value.value(),
            self.fit.currentData(),
            self.flank.currentData(),
            self.cutter.value(),
            Machining(**how, conventional=self.conventional.isChecked()),
        )

    def _offer_fits(self) -> None:
        """What the format can hold, and how a machine that follows it goes."""
        for part in (*self.machining.values(), self.conventional):
            self._form.setRowVisible(part, FORMATS[self.ending].machined)
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
        self.expect()
        self._work.stop()
        self._pause.start()

    def _compute(self) -> None:
        self.begin(partial(_computed, self._design, self.ending, self.request))

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_made(self, made: Preview | None) -> str:
        self.picture.show_preview(made)
        return "" if made is None else _summary(made.job)


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
    made: Preview | None = accepted(dialog)
    return None if made is None else (made.job, dialog.ending)
