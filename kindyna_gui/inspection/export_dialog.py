"""The dialog before an inspection table is written: probe, tolerance, cam angles; with a plot of the lift and its band, computed
beside the window."""

from __future__ import annotations

from functools import partial

import numpy as np
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from core.design import Design
from core.output.inspection import ANGLES, LEAST_ANGLES, MOST_ANGLES, Inspection, Request, inspection
from core.study import Study
from kindyna_gui.forms.amount import Amount
from kindyna_gui.forms.computed_dialog import ComputedDialog, accepted
from kindyna_gui.inspection.form import ProbeForm
from kindyna_gui.labels import sentence
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import DASHED, LIGHT

PAUSE_MS = 150  # after the last change before the table is computed
FORM_WIDTH = 300  # pixels
ANGLE = "Cam angle, °"


class InspectionDialog(ComputedDialog):
    """``made`` is the inspection that the file will hold."""

    def __init__(self, parent: QWidget, design: Design) -> None:
        super().__init__(parent, design, "inspection table")
        self._design = design
        self.form, self.samples = ProbeForm(design, self.flank), Amount()
        self.samples.setDecimals(0)
        self.samples.setRange(LEAST_ANGLES, MOST_ANGLES)
        self.samples.setValue(ANGLES)
        self.form.form.addRow("Cam angles", self.samples)
        self.lift, self.band = XYPlot(ANGLE, "Lift, mm"), XYPlot(ANGLE, "Band, µm")
        self.result.setMinimumHeight(5 * self.fontMetrics().lineSpacing())
        self._lay_out()
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(self._compute)
        self.form.changed.connect(self._changed)
        self.samples.valueChanged.connect(self._changed)
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
        column = QVBoxLayout(self)
        column.addLayout(sides)
        column.addWidget(self.buttons)
        self.resize(960, 560)

    def _changed(self) -> None:
        self.expect()
        self._work.stop()
        self._pause.start()

    def _compute(self) -> None:
        self.begin(partial(_computed, self._design, self.form.request(int(self.samples.value()))))

    def show_waiting(self) -> None:
        """The plots stay until there are others."""

    def show_made(self, made: Inspection | None) -> str:
        if made is None:
            self.lift.show_message("")
            self.band.show_message("")
            return ""
        self._show(made)
        return _summary(made)

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
    made: Inspection | None = accepted(InspectionDialog(parent, design))
    return made


__all__ = ["InspectionDialog", "inspection_wanted"]
