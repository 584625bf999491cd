"""A measured table becomes the motion: how it is read on the left, what comes of it on the right, with every change."""

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
from kindyna_gui.look import bold_label
from kindyna_gui.measured.form import ReadingForm, TableAnswer, TableReader, TableRequest, as_command, spelled, symbol
from kindyna_gui.measured.segments import (
    EntryTable,
    SegmentTable,
    counted,
    fault_entries,
    fit_entries,
    show_residuals,
    show_rows,
)
from kindyna_gui.measured.sheet import SheetTable, fault_marks, fit_marks
from kindyna_gui.pictures.plots.xy import XYPlot

AT_ONCE = 0.15  # seconds that an answer is waited for before the dialog says that it is being computed
COMPUTING = "Reading the table and fitting a curve to it. Cancel gives it up."
TABLES = "Tables (*.csv *.txt *.dat *.tsv *.asc *.xlsx *.xls *.ods)"
LEFT_WIDTH, USUAL, LEAST = 350, QSize(1240, 780), QSize(900, 560)
ANY_NUMBER, NOT_NEGATIVE = Info("Lowest position"), Info("Measuring error", low=0.0)


class MeasuredDialog(PutDialog):
    """Shows what a table holds and what motion comes of it, and puts that into the design as one step.

    Both are computed beside the window; what comes at once is shown at once.
    """

    help_page = "making#Measured motions"

    def __init__(self, session: Session, path: Path, data: bytes, parent: QWidget | None = None) -> None:
        super().__init__(session, "Import measured motion", parent)
        self._path = path
        motion = require_motion(session.design)
        self._unit = motion.unit
        self._reader = self._read(data)
        self._request = TableRequest()
        self.answer = TableAnswer()
        self._work = Background(self)
        self.form = ReadingForm(motion.unit)
        self.errors = {quantity: NumberBox(NOT_NEGATIVE) for quantity in LETTERS.values()}
        self.lowest = NumberBox(ANY_NUMBER)
        self.residual_of = WordBox()
        self.residual_of.setToolTip("The column whose residuals are shown")
        self.keep_all = QCheckBox("&Keep wrong rows")
        self.keep_all.setToolTip("Else rows that no smooth curve joins to those beside them are left out")
        self.mirror = QCheckBox("M&irror")
        self.mirror.setToolTip("The rows are half a lobe, which is reflected in the row of its largest lift (--mirror)")
        self.laws, self.dwells = (
            QCheckBox("La&ws"),
            QCheckBox("&Dwells"),
        )
        self.laws.setToolTip("Those that fit within the error; else tables between the dwells")
        self.dwells.setToolTip("Those that stand exactly still; without laws and dwells the motion is one spline")
        for box in (self.laws, self.dwells):
            box.setChecked(True)
        self.rows_plot, self.residual_plot = XYPlot("", ""), XYPlot("", "")
        self.derivative_plots = XYPlot("", ""), XYPlot("", "")
        for plot in self.plots[:-1]:
            plot.show_numbers(False)
        self.entries, self.segments = EntryTable(), SegmentTable()
        self.pages = WordBox()
        self.pages.setToolTip("Sheet of the workbook")
        self.pages.addItems(self._pages(data))
        self.cells = NameBox()
        self.cells.setPlaceholderText("All cells, or A1:C400")
        self.cells.setToolTip("The cells of the sheet that are the table, by two of their corners")
        self.sheet = SheetTable()
        self.leave = QPushButton("Leave these rows &out")
        self.leave.setToolTip("Their lines are passed over; the file stays as it is")
        self.leave.setAutoDefault(False)
        self.leave.hide()
        self.readings = WordBox()
        self.readings.setAccessibleName("Rows that may be wrong")
        self.readings.setToolTip(
            "Steps in the rows say that some are wrong, but not which: those that are chosen are left out"
        )
        self.readings.hide()
        self.put_button.setText("&Take")
        self.put_button.setToolTip("Put the motion into the design, as one step")
        self._lay_out()
        self._connect()
        self.read_and_fit()

    def _read(self, data: bytes) -> TableReader:
        return TableReader(self._path.name, data, self._unit, self._session.design.speed_rpm)

    # -- building -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        left = QVBoxLayout()
        left.addLayout(self._head())
        self.workbook = QWidget()
        of_workbook = QHBoxLayout(self.workbook)
        of_workbook.setContentsMargins(0, 0, 0, 0)
        for text, box in (("&Sheet", self.pages), ("cells", self.cells)):
            label = QLabel(text)
            label.setBuddy(box)
            of_workbook.addWidget(label)
            of_workbook.addWidget(box, 1)
        self.workbook.setVisible(self.pages.count() > 0)
        left.addWidget(self.workbook)
        left.addWidget(self.form)
        left.addSpacing(4)
        self.estimate = QPushButton("Esti&mate")
        self.estimate.setToolTip("What the scatter of the rows tells, at least the rounding of the last digit")
        self.estimate.setAutoDefault(False)
        heading = QHBoxLayout()
        heading.addWidget(bold_label("Fit"), 1)
        heading.addWidget(self.estimate)
        left.addLayout(heading)
        left.addLayout(self._numbers())
        checks = QHBoxLayout()
        for check in (self.laws, self.dwells, self.keep_all, self.mirror):
            checks.addWidget(check)
        left.addLayout(checks)
        result = QWidget()
        self.figures = QFormLayout(result)
        self.figures.setVerticalSpacing(3)
        self._figures: dict[str, QLabel] = {}
        tabs = QTabWidget()
        tabs.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # its bar stands in the order; itself it would lead back there
        tabs.addTab(self.sheet, "T&able")
        tabs.addTab(result, "Res&ult")
        left.addWidget(tabs, 1)
        right = QVBoxLayout()
        right.setSpacing(2)
        right.addWidget(self.rows_plot, 4)
        for plot in self.derivative_plots:
            right.addWidget(plot, 2)
        right.addWidget(self.residual_plot, 3)
        foot = QHBoxLayout()
        foot.addWidget(self.segments, 11)
        notes = QVBoxLayout()
        notes.addWidget(self.entries)
        notes.addWidget(self.leave, 0, Qt.AlignmentFlag.AlignLeft)
        notes.addWidget(self.readings)
        foot.addLayout(notes, 10)
        right.addLayout(foot, 3)
        self.frame(left, LEFT_WIDTH, right, USUAL, LEAST)

        reading = (self.again, self.pages, self.cells, *self.form.boxes.values(), self.estimate, *self.errors.values())
        checked = (self.laws, self.dwells, self.keep_all, self.mirror)
        fitting = (self.lowest, self.residual_of, *checked, tabs.tabBar(), self.sheet)
        ends = self.buttons.buttons()
        order = (*reading, *fitting, self.segments, self.entries, self.leave, self.readings, *ends)
        for before, after in pairwise(order):
            self.setTabOrder(before, after)

    def _head(self) -> QHBoxLayout:
        row = QHBoxLayout()
        name = bold_label(self._path.name)
        name.setToolTip(str(self._path))
        name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.again = QPushButton("&Read again")
        self.again.setToolTip("After the file was mended")
        self.again.setAutoDefault(False)
        row.addWidget(name, 1)
        row.addWidget(self.again)
        return row

    def _numbers(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
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
            box.setToolTip("Standard deviation of one measured value; 0 lays the curve through all rows")
        self.lowest.setToolTip("Where the follower stands at its lowest; the whole motion moves with it")
        return grid

    def _connect(self) -> None:
        self.form.changed.connect(self._read_otherwise)
        for quantity, box in self.errors.items():
            box.entered.connect(partial(self._state_error, quantity))
        self.lowest.entered.connect(lambda value: self._change_request(lowest=value))
        for box in (*self.errors.values(), self.lowest):
            box.unreadable.connect(lambda box=box: box.set_refused(True))
        self.estimate.clicked.connect(lambda: self._change_request(errors={}))
        self.keep_all.toggled.connect(lambda on: self._change_request(keep_all=on))
        self.mirror.toggled.connect(lambda on: self._change_request(mirror=on))
        self.laws.toggled.connect(lambda on: self._change_request(laws=on))
        self.dwells.toggled.connect(lambda on: self._change_request(dwells=on))
        self.again.clicked.connect(self._read_again)
        self.leave.clicked.connect(self._leave_out)
        self.readings.activated.connect(self._choose_reading)
        self.pages.activated.connect(self._turn_to_page)
        self.cells.editingFinished.connect(self._choose_cells)
        self.residual_of.activated.connect(self._show_residuals)
        self.sheet.left_out.connect(lambda lines: self._change_request(leave_out=lines))
        self.sheet.chosen.connect(self._point_out_line)
        add_copy_of_line(self.buttons, self._as_command)
        self._work.result.connect(lambda _, answer: self._take(answer))
        self.finished.connect(self._work.stop)
        self.segments.switched.connect(lambda switches: self._change_request(switches=switches))
        for signal in (self.segments.clicked, self.segments.activated):
            signal.connect(lambda index: self._point_at(self.segments.start(index.row())))
        self.entries.clicked.connect(self._point_out)
        self.entries.activated.connect(self._point_out)

    # -- reading --------------------------------------------------------------------------------------------

    @property
    def plots(self) -> tuple[XYPlot, ...]:
        """Rows and motion, its other derivatives, residuals."""
        return (self.rows_plot, *self.derivative_plots, self.residual_plot)

    @property
    def busy(self) -> bool:
        """Whether the table is being read, or a curve fitted."""
        return self._work.busy

    def read_and_fit(self) -> None:
        """Read and fit as requested, and show the result; what was being computed is given up."""
        self.put_button.setEnabled(False)
        self._work.start([("", partial(self._reader.answer, self.form.request(self._request), self.answer))])
        if not self._work.wait(AT_ONCE):
            self.show_message(COMPUTING)
            if self.answer.fit is None:
                self.rows_plot.show_message("The table is being read")

    def _take(self, answer: TableAnswer) -> None:
        self.answer = answer
        self.leave.setVisible(answer.fit is None and any(fault.line for fault in answer.faults))
        self._offer_readings()
        self.form.show_read(answer.sheet, answer.layout)
        self.form.ask_trust(answer.layout, answer.fit is not None and bool(answer.fit.contradicted))
        if answer.layout is not None:
            how = answer.layout
            units = {how.quantity: how.unit.name, **{each.quantity: each.unit.name for each in how.other_columns}}
            for quantity, box in self.errors.items():
                self.units[quantity].setText(symbol(units[quantity]) if quantity in units else "")
                for each in (self.labels[quantity], box, self.units[quantity]):
                    each.setVisible(quantity in units)
        self.put_button.setEnabled(not answer.faults)
        for widget in (*self.errors.values(), self.lowest, self.estimate, self.keep_all, self.laws, self.dwells):
            widget.setEnabled(answer.fit is not None or answer.refused)
        if answer.fit is not None:
            self._show_fit(answer.fit)
            if answer.faults:
                self.show_message(sentence(answer.faults[0].text), wrong=True)
        elif answer.refused:  # the last curve stays
            if answer.of_switch:
                self.segments.refuse()
            elif not answer.is_open:
                self.error.set_refused(True)
            self.show_message(sentence(spelled(answer.faults[0].text)), wrong=True)
        else:
            self._show_faults()
        marks = fault_marks(answer.faults) if answer.fit is None else fit_marks(answer.fit)
        self.sheet.show_sheet(answer.sheet, answer.layout, marks, self._request.leave_out)

    @property
    def error(self) -> NumberBox:
        """Of the motion's column."""
        how = self.answer.layout
        return self.errors[how.quantity if how is not None else "displacement"]

    def _change_request(self, **changes: Any) -> None:
        self._request = replace(self._request, **changes)
        self.read_and_fit()

    def _state_error(self, quantity: str, value: float) -> None:
        if value >= 0.0:
            self._change_request(errors={**self._request.errors, quantity: value})
        else:
            self.errors[quantity].set_refused(True)
            self.show_message("Measuring error: allowed: 0 or more", wrong=True)

    def _read_otherwise(self) -> None:
        """Read in other units, or another column: error and level typed before are dropped."""
        self._request = replace(self._request, errors={}, lowest=None, leave_out=(), switches=())
        self.read_and_fit()

    def _pages(self, data: bytes) -> tuple[str, ...]:
        """The sheets of a workbook; none of a text, or where nothing reads it."""
        try:
            return sheet_names(data, self._path.name) if is_workbook(data) else ()
        except KindynaError:
            return ()

    def _turn_to_page(self) -> None:
        self.form.forget()
        self._change_request(page=self.pages.currentText(), cells="", leave_out=(), errors={}, lowest=None, switches=())
        self.cells.setText("")

    def _choose_cells(self) -> None:
        if self.cells.text().strip() != self._request.cells:
            self.form.forget()
            self._change_request(cells=self.cells.text().strip(), leave_out=(), errors={}, lowest=None, switches=())

    def _as_command(self) -> str:
        session = self._session
        drive = session.design.name if session.has_several_drives else ""
        return as_command(self.form.request(self._request), self._path, session.path or UNSAVED, drive)

    def _leave_out(self) -> None:
        """Pass over the lines that are wrong, besides those passed over already."""
        lines = (line for fault in self.answer.faults if fault.line for line in (fault.line, *fault.others))
        self._change_request(leave_out=tuple(sorted({*self._request.leave_out, *lines})))

    def _offer_readings(self) -> None:
        """Which rows are wrong where the table itself does not say it: none of the readings is taken before it is chosen."""
        found = self.answer.fit if self.answer.faults else None
        self.readings.clear()
        self.readings.addItem("Which rows are wrong?", ())
        for rows in found.outliers.readings if found is not None else ():
            assert found is not None
            self.readings.addItem(f"{found.table.lines_text(rows)} ({len(rows)} rows)", rows)
        readings = self.readings.count() > 1
        self.readings.setVisible(readings)
        self.readings.set_waiting(readings)

    def _choose_reading(self, index: int) -> None:
        rows, table = self.readings.itemData(index), self.answer.table
        if rows and table is not None:
            lines = {int(table.lines[row]) for row in rows}
            self._change_request(leave_out=tuple(sorted({*self._request.leave_out, *lines})))

    def _read_again(self) -> None:
        try:
            self._reader = self._read(read_bytes(self._path))
        except KindynaError as error:
            dialogs.show_faults(self, f"{self._path.name} cannot be read.", str(error).splitlines())
        else:
            self.answer = TableAnswer()
            self._change_request(leave_out=(), switches=())

    # -- showing --------------------------------------------------------------------------------------------

    def _show_fit(self, fit: MotionFit) -> None:
        own = fit.table.layout.order
        show_rows(self.rows_plot, fit, own)
        for plot, order in zip(self.derivative_plots, (k for k in range(3) if k != own), strict=True):
            show_rows(plot, fit, order)
        chosen = self.residual_of.currentIndex()
        self.residual_of.clear()
        self.residual_of.addItems([sentence(each.column.quantity) for each in fit.columns])
        self.residual_of.setCurrentIndex(chosen if 0 <= chosen < len(fit.columns) else 0)
        for widget in (self.labels["residuals"], self.residual_of):
            widget.setVisible(len(fit.columns) > 1)
        self._show_residuals()
        for each in fit.columns:
            if each.column.quantity in self.errors:
                self.errors[each.column.quantity].show_value(each.error)
        self.lowest.show_value(float(f"{fit.lowest:.6g}") if self._request.lowest is None else fit.lowest)
        self._show_figures(fit_figures(fit))
        self.segments.show_fit(fit, self._request.switches)
        self.entries.show_entries(fit_entries(fit))
        guesses = (
            f"Guessed: {'; '.join(map(spelled, self.answer.layout.guesses))}. "
            if self.answer.layout and self.answer.layout.guesses
            else ""
        )
        self.show_message(f"{guesses}The motion of the design is replaced; Undo brings it back.")

    def _show_faults(self) -> None:
        faults = self.answer.faults
        self.segments.show_fit(None, ())
        self.entries.show_entries(fault_entries(faults))
        self._show_figures([])
        self.rows_plot.show_message("Nothing can be drawn before the table can be read")
        for plot in self.plots[1:]:
            plot.show_message("")
        self.show_message(counted(faults), wrong=True)

    def _show_figures(self, rows: list[tuple[str, str]]) -> None:
        """What the fit came to; what stands beside it already is left out."""
        shown = dict(row for row in rows if row[0] != "measuring error")
        for name in shown:
            if name not in self._figures:
                self._figures[name] = QLabel(wordWrap=True)
                self.figures.addRow(sentence(name), self._figures[name])
        for name, label in self._figures.items():
            label.setText(spelled(shown.get(name, "")))

    def _show_residuals(self) -> None:
        if self.answer.fit is not None:
            show_residuals(self.residual_plot, self.answer.fit, max(self.residual_of.currentIndex(), 0))

    def _point_out(self, index: QModelIndex) -> None:
        line, angle = self.entries.line(index.row()), self.entries.angle(index.row())
        if line:
            self.sheet.show_line(line)
        self._point_at(angle)

    def _point_out_line(self, line: int) -> None:
        table = self.answer.table
        at = table.angles[table.lines == line] if table is not None else np.zeros(0)
        self._point_at(float(at[0]) if at.size else None)

    def _point_at(self, angle: float | None) -> None:
        for plot in self.plots:
            plot.point_out(angle)

    # -- the end --------------------------------------------------------------------------------------------

    def accept(self) -> None:
        """Put the motion into the design, where the table gives one."""
        if self.put_button.isEnabled() and self.answer.fit is not None:
            self.put(with_measured_motion(self._session.design, self.answer.fit), f"Import {self._path.name}")


def import_measured(session: Session, parent: QWidget) -> MeasuredDialog | None:
    """Ask for a table and open the dialog over a window; it is deleted once closed."""
    opened = dialogs.opened_file(parent, "Import measured motion", TABLES)
    if opened is None:
        return None
    dialog = MeasuredDialog(session, *opened, parent)
    dialog.open_once()
    return dialog


__all__ = ["MeasuredDialog", "import_measured"]
