"""The dialog before an inspection table is written: probe, tolerance, cam angles; with a plot of the lift and its band, computed
beside the window."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from PySide6.QtWidgets import QVBoxLayout, QWidget

from core.design import Design
from core.output.files.inspection import Inspection, inspection
from core.output.files.probe import InspectionRequest
from core.study import Study
from kindyna_gui.forms.computed_dialog import ComputedDialog, accepted
from kindyna_gui.inspection.form import ProbeForm
from kindyna_gui.labels import sentence
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import DASHED, SCREEN

ANGLE = "Cam angle, °"


class InspectionDialog(ComputedDialog):
    """``made`` is the inspection that the file will hold."""

    command, ending, help_page = "inspection", ".csv", "tour#Export > Inspection table"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design = design
        self.lift, self.band = XYPlot(ANGLE, "Lift, mm"), XYPlot(ANGLE, "Band, µm")
        plots = QVBoxLayout()
        plots.addWidget(self.lift, 3)
        plots.addWidget(self.band, 2)
        for plot in (self.lift, self.band):
            plot.setMinimumSize(420, 130)
        super().__init__(parent, "inspection table", ProbeForm(design), plots)
        self.resize(960, 560)
        self.changed()

    def job(self) -> Callable[[], Inspection]:
        return partial(_computed, self._design, self.form.request)

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
        self.lift.show_lines([Line(x, lift, SCREEN.family("displacement"))])
        self.band.show_lines(
            [
                Line(x, 1e3 * (upper - lift), SCREEN.limit, "Upper"),
                Line(x, 0.0 * x, SCREEN.family("displacement"), "Lift"),
                Line(x, 1e3 * (lower - lift), SCREEN.limit, "Lower", DASHED),
            ]
        )


def _computed(design: Design, request: InspectionRequest) -> Inspection:
    made = inspection(Study(design), request)
    made.setup.findings  # noqa: B018 - here, not in the window's thread
    return made


def _summary(made: Inspection) -> str:
    """What the table will hold."""
    at = made.setup
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
