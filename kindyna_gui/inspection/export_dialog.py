"""The dialog before an inspection table is written: probe, tolerance, cam angles; with a plot of the lift and its band, computed
beside the window."""

from __future__ import annotations

from functools import partial

import numpy as np
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.design import Design
from core.errors import KindynaError
from core.output.inspection import ANGLES, LEAST_ANGLES, MOST_ANGLES, Inspection, Request, inspection
from core.study import Study
from kindyna_gui.background import Background
from kindyna_gui.forms.amount import Amount
from kindyna_gui.inspection.form import ProbeForm
from kindyna_gui.labels import sentence
from kindyna_gui.look import INK, QUIET, WRONG, coloured
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import DASHED, LIGHT

PAUSE_MS = 150  # after the last change before the table is computed
FORM_WIDTH = 300  # pixels
ANGLE = "Cam angle, °"


class InspectionDialog(QDialog):
    """``made`` is what was computed for the choices, None while there is nothing."""

    def __init__(self, parent: QWidget, design: Design) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export inspection table")
        self.made: Inspection | None = None
        self._design, self._work = design, Background(self)
        self.form, self.samples = ProbeForm(design), Amount()
        self.samples.setDecimals(0)
        self.samples.setRange(LEAST_ANGLES, MOST_ANGLES)
        self.samples.setValue(ANGLES)
        self.form.form.addRow("Cam angles", self.samples)
        self.lift, self.band = XYPlot(ANGLE, "Lift, mm"), XYPlot(ANGLE, "Band, µm")
        self.result = QLabel()
        self.result.setWordWrap(True)
        self.result.setMinimumHeight(5 * self.fontMetrics().lineSpacing())
        self._lay_out()
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(self._compute)
        self._work.result.connect(self._take)
        self.form.changed.connect(self._changed)
        self.samples.valueChanged.connect(self._changed)
        self.finished.connect(self._work.close)
        self._changed()

    def _lay_out(self) -> None:
        left = QVBoxLayout()
        left.addWidget(self.form)
        left.addWidget(self.result)
        left.addStretch(1)
        self.form.setFixedWidth(FORM_WIDTH)
        self.result.setFixedWidth(FORM_WIDTH)
        plots = QVBoxLayout()
        plots.addWidget(self.lift, 3)
        plots.addWidget(self.band, 2)
        for plot in (self.lift, self.band):
            plot.setMinimumSize(420, 130)
        sides = QHBoxLayout()
        sides.addLayout(left)
        sides.addLayout(plots, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.export: QPushButton = buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.export.setText("Choose file...")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(sides)
        column.addWidget(buttons)
        self.resize(960, 560)

    def _changed(self) -> None:
        self.made = None
        self.export.setEnabled(False)
        self._tell("computing ...", QUIET)
        self._pause.start()

    def _compute(self) -> None:
        self._work.start([("", partial(_computed, self._design, self.form.request(int(self.samples.value()))))])

    def _take(self, _: object, result: Inspection | KindynaError) -> None:
        if self._pause.isActive():  # it has been changed since
            return
        if isinstance(result, Inspection):
            self.made = result
            self._show(result)
            self._tell(_summary(result), INK)
        else:
            self.lift.show_message("")
            self.band.show_message("")
            self._tell(str(result), WRONG)
        self.export.setEnabled(self.made is not None)

    def _show(self, made: Inspection) -> None:
        """The lift, and below it the band about it: beside the lift itself it could not be seen."""
        table = made.table
        x = np.append(table.degrees, 360.0)
        lift, lower, upper = (np.append(y, y[0]) for y in (table.lift, table.lower, table.upper))
        self.lift.show_lines([Line(x, lift, LIGHT.family("displacement"))])
        self.band.show_lines(
            [
                Line(x, 1e3 * (upper - lift), LIGHT.limit, "Upper"),
                Line(x, 0.0 * x, LIGHT.family("displacement"), "Lift"),
                Line(x, 1e3 * (lower - lift), LIGHT.limit, "Lower", DASHED),
            ]
        )

    def _tell(self, text: str, colour: str) -> None:
        self.result.setText(text)
        coloured(self.result, colour)


def _computed(design: Design, request: Request) -> Inspection:
    made = inspection(Study(design), request)
    made.probing.findings  # noqa: B018 - here, not in the window's thread
    return made


def _summary(made: Inspection) -> str:
    """What the table will hold."""
    at = made.probing
    first = (
        f"{made.table.degrees.size} rows; largest lift {made.table.lift.max():.6g} mm. Lift 0 stands at {at.base:.6g} mm from the cam "
        "centre."
    )
    return "\n".join([first, *(f"{sentence(found.message)}." for found in at.findings)])


def inspection_wanted(parent: QWidget, design: Design) -> Inspection | None:
    """Ask what an inspection table shall hold; computed, None where the user cancels."""
    dialog = InspectionDialog(parent, design)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    made = dialog.made if accepted else None
    dialog.deleteLater()
    return made


__all__ = ["InspectionDialog", "inspection_wanted"]
