"""File > Import measured motion: settings of reading and fit on the left, the fitted motion on the right."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QModelIndex, QSize, Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QFormLayout,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from core.design import Info, require_motion
from core.errors import KindynaError
from core.measured import MotionFit, is_workbook, sheet_names, with_measured_motion
from core.measured.columns import LETTERS
from core.output.measured_text import fit_figures
from core.project.files import read_bytes
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import UNSAVED, add_copy_of_line
from kindyna_gui.forms.number_box import NameBox, NumberBox, WordBox
from kindyna_gui.forms.request_form import PutDialog
from kindyna_gui.labels import sentence
from kindyna_gui.look import bold_label, described
from kindyna_gui.measured.form import (
    ReadingForm,
    TableReader,
    TableReading,
    TableRequest,
    measured_command,
    symbol,
    with_symbols,
)
from kindyna_gui.measured.segments import (
    EntryTable,
    SegmentTable,
    fault_entries,
    fault_summary,
    fit_entries,
    show_residuals,
    show_rows,
)
from kindyna_gui.measured.sheet import SheetTable, fault_marks, fit_marks
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.rebuilt import connect_all, fill

WAIT = 0.15  # seconds for a fast result, before the dialog says that it is computing
COMPUTING = "Reading the table and fitting the motion. Cancel stops it."
TABLES = "Tables (*.csv *.txt *.dat *.tsv *.asc *.xlsx *.xls *.ods)"
FORM_WIDTH, TYPICAL_SIZE, LEAST_SIZE = 350, QSize(1240, 780), QSize(900, 560)
ANY_NUMBER, NOT_NEGATIVE = Info("Lowest position"), Info("Measuring error", low=0.0)


class MeasuredDialog(PutDialog):
    """Dialog that reads a table, fits a motion, and puts it into the design as one step.

    Reading and fit run in the background.
    """

    help_page = "making#Measured motions"

    def __init__(self, session: Session, path: Path, data: bytes, parent: QWidget | None = None) -> None:
        super().__init__(session, "Import measured motion", parent)
        self._path = path
        motion = require_motion(session.design)
        self._unit = motion.unit
        self._reader = self._read(data)
        self._request = TableRequest()
        self.reading = TableReading()
        self._work = Background(self)
        self.form = ReadingForm(motion.unit)
        self.errors = {quantity: NumberBox(NOT_NEGATIVE) for quantity in LETTERS.values()}
        self.lowest = NumberBox(ANY_NUMBER)
        self.residual_of = described(WordBox(), tip="Select the column whose residuals are shown")
        self.keep_all = described(
            QCheckBox("&Keep wrong rows"),
            tip="Keep the rows that no smooth curve joins to their neighbours; otherwise they are left out",
        )
        self.mirror = described(
            QCheckBox("M&irror"), tip="Reflect half a lobe in the row of its largest lift (--mirror)"
        )
        self.laws, self.dwells = QCheckBox("La&ws"), QCheckBox("&Dwells")
        self.laws.setToolTip("Use laws that fit within the error; otherwise tables between the dwells")
        self.dwells.setToolTip("Detect dwells; without laws and dwells the motion is one spline")
        for box in (self.laws, self.dwells):
            box.setChecked(True)
        self.rows_plot, self.residual_plot = XYPlot("", ""), XYPlot("", "")
        self.derivative_plots = XYPlot("", ""), XYPlot("", "")
        for plot in self.plots[:-1]:
            plot.show_numbers(False)
        self.entries, self.segments = EntryTable(), SegmentTable()
        self.pages = described(WordBox(), tip="Select the sheet of the workbook")
        self.pages.addItems(self._pages(data))
        self.cells = described(NameBox(), tip="Cells of the table, by two opposite corners")
        self.cells.setPlaceholderText("All cells, or A1:C400")
        self.sheet = SheetTable()
        self.leave = described(
            QPushButton("Leave these rows &out", autoDefault=False),
            tip="Leave these lines out; the file does not change",
        )
        self.leave.hide()
        self.alternatives = described(
            WordBox(),
            name="Rows that may be wrong",
            tip="Steps show that some rows are wrong, but not which: select the rows to leave out",
        )
        self.alternatives.hide()
        self.put_button.setToolTip("Put the motion into the design (one undo step)")
        self._lay_out()
        self._connect()
        self.read_and_fit()

    def _read(self, data: bytes) -> TableReader:
        return TableReader(self._path.name, data, self._unit, self._session.design.speed_rpm)

    # -- layout ------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.workbook = QWidget()
        workbook_row = fill(QHBoxLayout(self.workbook), margins=0)
        for text, box in (("&Sheet", self.pages), ("cells", self.cells)):
            label = QLabel(text)
            label.setBuddy(box)
            workbook_row.addWidget(label)
            workbook_row.addWidget(box, 1)
        self.workbook.setVisible(self.pages.count() > 0)
        self.estimate = described(
            QPushButton("Esti&mate", autoDefault=False),
            tip="Estimate the errors from the scatter of the rows, at least the rounding of the last digit",
        )
        heading = fill(QHBoxLayout(), (bold_label("Fit"), 1), self.estimate)
        checked = (self.laws, self.dwells, self.keep_all, self.mirror)
        result = QWidget()
        self.figures = QFormLayout(result)
        self.figures.setVerticalSpacing(3)
        self._figures: dict[str, QLabel] = {}
        tabs = QTabWidget()
        tabs.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # its tab bar has the focus instead
        tabs.addTab(self.sheet, "T&able")
        tabs.addTab(result, "Res&ult")
        left = fill(
            QVBoxLayout(),
            self._file_row(),
            self.workbook,
            self.form,
            4,
            heading,
            self._number_rows(),
            fill(QHBoxLayout(), *checked),
            (tabs, 1),
        )
        notes = fill(QVBoxLayout(), self.entries, (self.leave, 0, Qt.AlignmentFlag.AlignLeft), self.alternatives)
        footer = fill(QHBoxLayout(), (self.segments, 11), (notes, 10))
        derivatives = ((plot, 2) for plot in self.derivative_plots)
        right = fill(QVBoxLayout(), (self.rows_plot, 5), *derivatives, (self.residual_plot, 3), (footer, 3), spacing=2)
        self.frame(left, FORM_WIDTH, right, TYPICAL_SIZE, LEAST_SIZE)

        reading = (self.again, self.pages, self.cells, *self.form.boxes.values(), self.estimate, *self.errors.values())
        fitting = (self.lowest, self.residual_of, *checked, tabs.tabBar(), self.sheet)
        results = (self.segments, self.entries, self.leave, self.alternatives)
        for previous, following in pairwise((*reading, *fitting, *results, *self.buttons.buttons())):
            self.setTabOrder(previous, following)

    def _file_row(self) -> QHBoxLayout:
        name = described(bold_label(self._path.name), tip=str(self._path))
        name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.again = described(
            QPushButton("&Read again", autoDefault=False), tip="Read the file again after you corrected it"
        )
        return fill(QHBoxLayout(), (name, 1), self.again)

    def _number_rows(self) -> QGridLayout:
        grid = fill(QGridLayout(), spacing=(8, 4))
        self.units = {**{quantity: QLabel() for quantity in self.errors}, "lowest": QLabel(symbol(self._unit))}
        self.labels: dict[str, QLabel] = {}
        rows = (
            ("&Error of displacement", self.errors["displacement"], "displacement"),
            ("of velocity", self.errors["velocity"], "velocity"),
            ("of acceleration", self.errors["acceleration"], "acceleration"),
            ("&Lowest position", self.lowest, "lowest"),
        )
        for row, (text, box, name) in enumerate(rows):
            label = self.labels[name] = QLabel(text)
            label.setBuddy(box)
            grid.addWidget(label, row, 0)
            grid.addWidget(box, row, 1)
            grid.addWidget(self.units[name], row, 2)
        label = QLabel("Residuals of")
        label.setBuddy(self.residual_of)
        self.labels["residuals"] = label
        grid.addWidget(label, len(rows), 0)
        grid.addWidget(self.residual_of, len(rows), 1, 1, 2)
        grid.setColumnStretch(1, 1)
        for box in self.errors.values():
            box.setToolTip("Standard deviation of a measured value; with 0 the curve passes through all rows")
        self.lowest.setToolTip("Lowest position of the follower; the full motion is displaced with it")
        return grid

    def _connect(self) -> None:
        self.form.changed.connect(self._columns_changed)
        for quantity, box in self.errors.items():
            self.ask_number(box, partial(self._state_error, quantity), self.read_and_fit)
        self.ask_number(self.lowest, lambda value: self._change_request(lowest=value), self.read_and_fit)
        connect_all(
            (self.estimate.clicked, lambda: self._change_request(errors={})),
            (self.keep_all.toggled, lambda on: self._change_request(keep_all=on)),
            (self.mirror.toggled, lambda on: self._change_request(mirror=on)),
            (self.laws.toggled, lambda on: self._change_request(laws=on)),
            (self.dwells.toggled, lambda on: self._change_request(dwells=on)),
            (self.again.clicked, self._read_again),
            (self.leave.clicked, self._leave_out),
            (self.alternatives.activated, self._leave_alternative_out),
            (self.pages.activated, self._page_changed),
            (self.cells.editingFinished, self._cells_changed),
            (self.residual_of.activated, self._show_residuals),
            (self.sheet.left_out, lambda lines: self._change_request(leave_out=lines)),
            (self.sheet.chosen, self._mark_line),
        )
        add_copy_of_line(self.buttons, self._as_command)
        self._work.result.connect(lambda _, reading: self._show_reading(reading))
        self.finished.connect(self._work.stop)
        self.segments.switched.connect(lambda switches: self._change_request(switches=switches))
        for signal in (self.segments.clicked, self.segments.activated):
            signal.connect(lambda index: self._mark_angle(self.segments.start(index.row())))
        self.entries.clicked.connect(self._mark_entry)
        self.entries.activated.connect(self._mark_entry)

    # -- reading -----------------------------------------------------------------------------------------

    @property
    def plots(self) -> tuple[XYPlot, ...]:
        """Plots of rows and motion, of the other derivatives, and of the residuals."""
        return (self.rows_plot, *self.derivative_plots, self.residual_plot)

    @property
    def busy(self) -> bool:
        """Whether the table is being read or the motion fitted."""
        return self._work.busy

    def read_and_fit(self) -> None:
        """Read and fit as requested and show the result; a running calculation is cancelled."""
        self.put_button.setEnabled(False)
        self._work.start([("", partial(self._reader.read_and_fit, self.form.request(self._request), self.reading))])
        if not self._work.wait(WAIT):
            self.show_message(COMPUTING)
            if self.reading.fit is None:
                self.rows_plot.show_message("Reading the table …")

    def _show_reading(self, reading: TableReading) -> None:
        self.reading = reading
        fit, layout, faults = reading.fit, reading.layout, reading.faults
        self.leave.setVisible(fit is None and any(fault.line for fault in faults))
        self._show_alternatives()
        self.form.show_layout(reading.sheet, layout)
        self.form.ask_trust(layout, fit is not None and bool(fit.contradicted))
        if layout is not None:
            units = {layout.quantity: layout.unit.name}
            units.update((column.quantity, column.unit.name) for column in layout.other_columns)
            for quantity, box in self.errors.items():
                self.units[quantity].setText(symbol(units[quantity]) if quantity in units else "")
                for part in (self.labels[quantity], box, self.units[quantity]):
                    part.setVisible(quantity in units)
        self.put_button.setEnabled(not faults)
        for widget in (*self.errors.values(), self.lowest, self.estimate, self.keep_all, self.laws, self.dwells):
            widget.setEnabled(fit is not None or reading.is_refused)
        if fit is not None:
            self._show_fit(fit)
            if faults:
                self.show_message(sentence(faults[0].text), wrong=True)
        elif reading.is_refused:  # the last curve stays
            if reading.is_switch_refused:
                self.segments.refuse()
            elif not reading.is_open:
                self.error.set_refused(True)
            self.show_message(sentence(with_symbols(faults[0].text)), wrong=True)
        else:
            self._show_faults()
        marks = fault_marks(faults) if fit is None else fit_marks(fit)
        self.sheet.show_sheet(reading.sheet, layout, marks, self._request.leave_out)

    @property
    def error(self) -> NumberBox:
        """Box of the error of the column that defines the motion."""
        layout = self.reading.layout
        return self.errors[layout.quantity if layout is not None else "displacement"]

    def _change_request(self, **changes: Any) -> None:
        self._request = replace(self._request, **changes)
        self.read_and_fit()

    def _state_error(self, quantity: str, value: float) -> None:
        self._change_request(errors={**self._request.errors, quantity: value})

    def _columns_changed(self) -> None:
        """Read with other units or columns; typed errors and levels no longer apply."""
        self._request = replace(self._request, errors={}, lowest=None, leave_out=(), switches=())
        self.read_and_fit()

    def _pages(self, data: bytes) -> tuple[str, ...]:
        """Names of the sheets of a workbook; none for a text file, or without a reader."""
        try:
            return sheet_names(data, self._path.name) if is_workbook(data) else ()
        except KindynaError:
            return ()

    def _page_changed(self) -> None:
        self.form.forget()
        self._change_request(page=self.pages.currentText(), cells="", leave_out=(), errors={}, lowest=None, switches=())
        self.cells.setText("")

    def _cells_changed(self) -> None:
        if self.cells.text().strip() != self._request.cells:
            self.form.forget()
            self._change_request(cells=self.cells.text().strip(), leave_out=(), errors={}, lowest=None, switches=())

    def _as_command(self) -> str:
        session = self._session
        drive = session.design.name if session.has_several_drives else ""
        return measured_command(self.form.request(self._request), self._path, session.path or UNSAVED, drive)

    def _leave_out(self) -> None:
        """Leave out the wrong lines in addition to those already left out."""
        lines = (line for fault in self.reading.faults if fault.line for line in (fault.line, *fault.others))
        self._change_request(leave_out=tuple(sorted({*self._request.leave_out, *lines})))

    def _show_alternatives(self) -> None:
        """List the alternatives where the table leaves open which rows are wrong; the user selects one."""
        fit = self.reading.fit if self.reading.faults else None
        self.alternatives.clear()
        self.alternatives.addItem("Which rows are wrong?", ())
        if fit is not None:
            for rows in fit.outliers.readings:
                self.alternatives.addItem(f"{fit.table.lines_text(rows)} ({len(rows)} rows)", rows)
        has_alternatives = self.alternatives.count() > 1
        self.alternatives.setVisible(has_alternatives)
        self.alternatives.set_waiting(has_alternatives)

    def _leave_alternative_out(self, index: int) -> None:
        rows, table = self.alternatives.itemData(index), self.reading.table
        if rows and table is not None:
            lines = {int(table.lines[row]) for row in rows}
            self._change_request(leave_out=tuple(sorted({*self._request.leave_out, *lines})))

    def _read_again(self) -> None:
        try:
            self._reader = self._read(read_bytes(self._path))
        except KindynaError as error:
            dialogs.show_faults(self, f"{self._path.name} cannot be read.", str(error).splitlines())
        else:
            self.reading = TableReading()
            self._change_request(leave_out=(), switches=())

    # -- display -----------------------------------------------------------------------------------------

    def _show_fit(self, fit: MotionFit) -> None:
        main_order = fit.table.layout.order
        show_rows(self.rows_plot, fit, main_order)
        for plot, order in zip(self.derivative_plots, (k for k in range(3) if k != main_order), strict=True):
            show_rows(plot, fit, order)
        chosen = self.residual_of.currentIndex()
        self.residual_of.clear()
        self.residual_of.addItems([sentence(column_fit.column.quantity) for column_fit in fit.columns])
        self.residual_of.setCurrentIndex(chosen if 0 <= chosen < len(fit.columns) else 0)
        for widget in (self.labels["residuals"], self.residual_of):
            widget.setVisible(len(fit.columns) > 1)
        self._show_residuals()
        for column_fit in fit.columns:
            if column_fit.column.quantity in self.errors:
                self.errors[column_fit.column.quantity].show_value(column_fit.error)
        self.lowest.show_value(float(f"{fit.lowest:.6g}") if self._request.lowest is None else fit.lowest)
        self._show_figures(fit_figures(fit))
        self.segments.show_fit(fit, self._request.switches)
        self.entries.show_entries(fit_entries(fit))
        layout = self.reading.layout
        guesses = f"Guessed: {'; '.join(map(with_symbols, layout.guesses))}. " if layout and layout.guesses else ""
        self.show_message(f"{guesses}The motion replaces that of the design; Undo restores it.")

    def _show_faults(self) -> None:
        faults = self.reading.faults
        self.segments.show_fit(None, ())
        self.entries.show_entries(fault_entries(faults))
        self._show_figures([])
        self.rows_plot.show_message("The table cannot be read yet")
        for plot in self.plots[1:]:
            plot.show_message("")
        self.show_message(fault_summary(faults), wrong=True)

    def _show_figures(self, rows: list[tuple[str, str]]) -> None:
        """Show the figures of the fit, except the error, which is in its own field."""
        shown = dict(row for row in rows if row[0] != "measuring error")
        for name in shown:
            if name not in self._figures:
                self._figures[name] = QLabel(wordWrap=True)
                self.figures.addRow(sentence(name), self._figures[name])
        for name, label in self._figures.items():
            label.setText(with_symbols(shown.get(name, "")))

    def _show_residuals(self) -> None:
        if self.reading.fit is not None:
            show_residuals(self.residual_plot, self.reading.fit, max(self.residual_of.currentIndex(), 0))

    def _mark_entry(self, index: QModelIndex) -> None:
        line, angle = self.entries.line(index.row()), self.entries.angle(index.row())
        if line:
            self.sheet.show_line(line)
        self._mark_angle(angle)

    def _mark_line(self, line: int) -> None:
        table = self.reading.table
        angles = table.angles[table.lines == line] if table is not None else np.zeros(0)
        self._mark_angle(float(angles[0]) if angles.size else None)

    def _mark_angle(self, angle: float | None) -> None:
        for plot in self.plots:
            plot.point_out(angle)

    # -- result ------------------------------------------------------------------------------------------

    def accept(self) -> None:
        """Put the fitted motion into the design, if there is one."""
        if self.put_button.isEnabled() and self.reading.fit is not None:
            self.put(with_measured_motion(self._session.design, self.reading.fit), f"Import {self._path.name}")


def import_measured(session: Session, parent: QWidget) -> MeasuredDialog | None:
    """Ask for a table and open the dialog over a window; None if the user cancels."""
    opened = dialogs.opened_file(parent, "Import measured motion", TABLES)
    if opened is None:
        return None
    dialog = MeasuredDialog(session, *opened, parent)
    dialog.open_once()
    return dialog


__all__ = ["MeasuredDialog", "import_measured"]
