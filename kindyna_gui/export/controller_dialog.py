"""The dialog before a controller's table is written: the request, the errors over the turn with the rows that make them, and the error
over the number of rows, from which a click takes a number."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QComboBox, QGridLayout, QWidget

from core.design import Design
from core.frozen import frozen
from core.output.controllers.deviation import ErrorCurves, error_curve, errors_over_turn, text
from core.output.controllers.rows import INTERPOLATIONS, Controller, controllers
from core.output.controllers.slave import EQUAL, PLACED, EcamRequest, drive_slave, slave_choices
from core.output.controllers.table import NOT_PUBLISHED, Ecam, ecam
from core.requests import command_words
from kindyna_gui.forms.amount import fill_choices
from kindyna_gui.forms.computed_dialog import ComputedDialog, accepted
from kindyna_gui.forms.request_form import RequestForm
from kindyna_gui.labels import sentence
from kindyna_gui.pictures.plots.xy import Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import DASHED, SCREEN

ANGLE = "Master, °"
FAMILIES = ("displacement", "velocity", "acceleration")
COUNTS, MOST_DECADES = (10, 30, 100, 300, 1000, 3000), 14  # on the axes
ROWS, POINTS = "Number of rows", "points"


@frozen(eq=False)
class Computed:
    """A table, its errors over the turn, and those of tables with other numbers of rows (column -> (n,))."""

    made: Ecam
    errors: ErrorCurves | None
    curve: Mapping[str, np.ndarray]


class ControllerDialog(ComputedDialog):
    """``made`` is the table that the file will hold, with what is shown of it."""

    command, ending, help_page = "ecam", ".csv", "controllers#Rows"

    def asked(self) -> tuple[str, list[str]]:
        words = command_words(EcamRequest, {**self.form.values, "of": self.of.currentData()})
        return self.ending, ["--controller", self.controller.currentData(), *words]

    def __init__(self, parent: QWidget, design: Design, drive: str) -> None:
        self._design, self._drive, self._rows = design, drive, controllers()
        self.controller, self.of = QComboBox(), QComboBox()
        self.plots = [XYPlot("" if i < 2 else ANGLE, "") for i in range(3)]
        self.curve = XYPlot("Rows", "")
        grid = QGridLayout()
        for i, plot in enumerate(self.plots):
            plot.setMinimumSize(420, 120)
            grid.addWidget(plot, i, 0)
        self.curve.setMinimumSize(300, 200)
        self.curve.setToolTip("Click: a table with so many rows")
        grid.addWidget(self.curve, 0, 1, 3, 1)
        grid.setColumnStretch(0, 3)
        grid.setColumnStretch(1, 2)
        form = RequestForm(EcamRequest, above=[("Controller", self.controller), ("Slave", self.of)])
        super().__init__(parent, "controller table", form, grid)
        self.curve.viewport().installEventFilter(self)
        fill_choices(self.controller, {slug: row.label for slug, row in self._rows.items()})
        self.controller.setMinimumContentsLength(24)
        self.controller.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        fill_choices(self.of, {name: sentence(label) for name, label in slave_choices(design, drive).items()})
        self.controller.currentIndexChanged.connect(self._suit_controller)
        self.of.currentIndexChanged.connect(self.changed)
        self.resize(1180, 640)
        self._suit_controller()

    @property
    def row(self) -> Controller:
        """The controller that is chosen."""
        return self._rows[self.controller.currentData()]

    def _suit_controller(self) -> None:
        """What it can be set to run, and where it takes rows."""
        row, form = self.row, self.form
        usual: dict[Any, str] = {} if row.interpolation_asked else {None: "What it usually runs"}
        known = {name: sentence(name.replace("-", " ")) for name in INTERPOLATIONS if name in row.interpolation}
        for name, choices in (("interpolation", {**usual, **known}), ("placing", self._placings())):
            form.boxes[name].blockSignals(True)
            fill_choices(form.boxes[name], choices)
            form.boxes[name].blockSignals(False)
            form.rows.setRowVisible(form.boxes[name], len(choices) > 1)
        form.rows.setRowVisible(form.boxes["segment"], row.last_is_one)
        form.boxes["segment"].setEnabled(row.last_is_one)
        self.changed()

    def _placings(self) -> dict[Any, str]:
        words: dict[Any, str] = {PLACED: "Placed for the least error", EQUAL: "At equal steps"}
        return {None: words[EQUAL]} if self.row.equal_steps else {None: "As the controller takes them", **words}

    def job(self) -> Callable[[], Computed]:
        request: EcamRequest = self.form.request
        return partial(_computed, self._design, self._drive, self.row, request, self.of.currentData())

    # -- what comes of it -----------------------------------------------------------------------------------

    def show_made(self, made: Computed | None) -> str:
        if made is None or made.errors is None:
            for plot in (*self.plots, self.curve):
                plot.show_message("" if made is None else NOT_PUBLISHED)
            return "" if made is None else text(made.made)
        self._show_errors(made.made, made.errors)
        self._show_curve(made.made, made.curve)
        return text(made.made)

    def _show_errors(self, made: Ecam, errors: ErrorCurves) -> None:
        limits = made.request.limits if made.request.points is None else (np.inf,) * 3
        for plot, name, symbol, limit, shown in zip(self.plots, FAMILIES, "sva", limits, errors.curves, strict=True):
            if shown is None:
                plot.show_message("straight lines have no acceleration")
                continue
            plot.name_axes(ANGLE if plot is self.plots[-1] else "", f"Error of {symbol}, {shown.unit}")
            rows = Dots(made.table.x, np.zeros(made.table.x.size), SCREEN.ink, 4.0)
            line = Line(errors.x, shown.values * shown.factor, SCREEN.family(name), read=True)
            ends = np.array([0.0, 360.0])
            kept = [
                Line(ends, np.full(2, end * shown.factor), SCREEN.limit, dash=DASHED)
                for end in (limit, -limit)
                if np.isfinite(end)
            ]
            plot.show_lines([*kept, line], dots=[rows])

    def _show_curve(self, made: Ecam, curve: Mapping[str, np.ndarray]) -> None:
        unit, times = ("µm", "") if made.slave.unit == "mm" else ("0.001°", "× ")
        self.curve.name_axes("Rows", f"Largest error, {unit}")
        seen = curve["deviation"] > 0.0
        x, y = np.log10(curve["rows"][seen]), np.log10(1e3 * curve["deviation"][seen])
        assert made.deviation is not None
        here = np.log10([made.rows, max(1e3 * made.deviation.values[0], 1e-12)])
        dots = Dots(here[:1], here[1:], SCREEN.limit, 9.0)
        rule = Rule(float(here[0]), f"{made.rows} rows: {1e3 * made.deviation.values[0]:.3g} {times}{unit}", SCREEN.ink)
        self.curve.show_lines([Line(x, y, SCREEN.family("displacement"))], fit=True, dots=[dots], rules=[rule])
        low, high = int(np.ceil(y.min())), int(np.floor(y.max()))
        decades = range(low, high + 1, 1 + (high - low) // MOST_DECADES)
        self.curve.show_ticks([(float(np.log10(n)), f"{n}") for n in COUNTS if x[0] <= np.log10(n) <= x[-1]],
                              [(float(k), f"{10.0**k:g}") for k in decades])  # fmt: skip

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """A click on the curve takes a number of rows."""
        if event.type() == QEvent.Type.MouseButtonPress and isinstance(event, QMouseEvent):
            if event.button() == Qt.MouseButton.LeftButton and self.made is not None and self.made.curve:
                self._take_rows(10.0 ** self.curve.across_at(event.position().toPoint()))
            return True
        return super().eventFilter(watched, event)

    def _take_rows(self, rows: float) -> None:
        there = self.made.curve["rows"]
        least, most = max(there[0], self.row.rows[0]), min(there[-1], self.row.rows[1])
        self.form.choose(ROWS, POINTS)
        for name in ("velocity_error", "acceleration_error"):
            self.form.show_value(name, None)
        self.form.boxes[POINTS].setValue(round(float(np.clip(rows, least, most))))


@lru_cache(maxsize=8)
def _curve(
    design: Design, drive: str, request: EcamRequest, kind: str, placing: str, closing: bool
) -> Mapping[str, np.ndarray]:
    return error_curve(drive_slave(design, drive, request)[0], kind, placing, closing=closing)


def _computed(design: Design, drive: str, row: Controller, request: EcamRequest, of: str) -> Computed:
    request = replace(request, of=of)
    slave, name, speed = drive_slave(design, drive, request)
    made = ecam(slave, row, request, name, speed)
    alike = EcamRequest(of=of, reverse=request.reverse, shift_deg=request.shift_deg, segment=request.segment)
    curve = _curve(design, drive, alike, made.interpolation, made.placing, row.has_both_ends)
    return Computed(made, None if made.deviation is None else errors_over_turn(made), curve)


def table_wanted(parent: QWidget, design: Design, drive: str) -> Ecam | None:
    """Ask what a controller's table shall hold; computed, None where the user cancels."""
    made: Computed | None = accepted(ControllerDialog(parent, design, drive))
    return None if made is None else made.made


__all__ = ["ControllerDialog", "table_wanted"]
