"""A measured table becomes the motion: how it is read on the left, what comes of it on the right, with every change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QModelIndex, QSize, Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QFormLayout,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from core.design import Info, require_motion
from core.errors import KindynaError
from core.findings import ERROR, NOTE, WARNING
from core.frozen import frozen
from core.measured import MOST_BYTES, MotionFit, RowFault, into_design, is_workbook, sheet_names
from core.measured.event import events
from core.output.measured_text import event_lines, figures, notes, row_line, segment_lines, worst_first
from core.project.files import read_bytes
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.forms.put_dialog import PutDialog
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import sentence
from kindyna_gui.look import sign
from kindyna_gui.measured.form import ReadingForm
from kindyna_gui.measured.plot import show_residuals, show_rows
from kindyna_gui.measured.request import TableAnswer, TableReader, TableRequest, spelled, symbol
from kindyna_gui.note import bold_label
from kindyna_gui.pictures.plots.xy import XYPlot

MOST = 200  # faults or wrong rows in the list
AT_ONCE = 0.15  # seconds that an answer is waited for before the dialog says that it is being computed
COMPUTING = "Reading the table and fitting a curve to it. Cancel gives it up."


@frozen
class TableNote:
    """What was noticed of a table: line of the file (0: none), text, severity, cam angle [deg] of that line."""

    line: int
    text: str
    severity: str
    angle: float | None = None


def fit_entries(fit: MotionFit) -> list[TableNote]:
    """Entries of a fit: wrong rows, the worst first, then the notes on what was assumed."""
    rows = worst_first(fit)[:MOST]
    wrong = [TableNote(int(fit.table.lines[i]), _off(fit, i), WARNING, float(fit.table.angles[i])) for i in rows]
    segments = [
        TableNote(0, spelled(line), NOTE, found.start_deg)
        for found, line in zip(fit.found, segment_lines(fit), strict=True)
    ]
    found = [
        TableNote(0, spelled(line), NOTE, event.start) for event in events(fit) for line in event_lines(fit, (event,))
    ]
    return [*wrong, *segments, *found, *(TableNote(0, spelled(note), NOTE) for note in notes(fit))]


def _off(fit: MotionFit, row: int) -> str:
    """What is wrong with a row; its line stands in the other column."""
    text = spelled(row_line(fit, row).partition("(")[2].replace("):", ":", 1))
    return f"{text}, left out" if row in fit.left_out else text


def fault_entries(faults: Sequence[RowFault]) -> list[TableNote]:
    """Entries for the faults of a file."""
    shown = [TableNote(fault.line, fault.text, ERROR) for fault in faults[:MOST]]
    more = len(faults) - MOST
    return [*shown, TableNote(0, f"and {more} more", ERROR)] if more > 0 else shown


def counted(faults: Sequence[RowFault]) -> str:
    """All faults in one sentence."""
    rows = sum(fault.rows for fault in faults if fault.line)
    if not rows:
        return sentence(faults[0].text)
    return f"{rows} {'row is' if rows == 1 else 'rows are'} wrong: correct how the file is read, or mend it and read it again."


class EntryTable(RowsTable):
    """The list of entries."""

    def __init__(self) -> None:
        super().__init__((TableHeading("Line", number=True), TableHeading("What was found", wide=True)))
        self._entries: tuple[TableNote, ...] = ()

    def show_entries(self, entries: Sequence[TableNote]) -> None:
        """Show these entries."""
        self._entries = tuple(entries)
        tip = "Click to see it in the plots"
        self.show_rows(
            [
                TableRow((str(f.line or ""), sentence(f.text)), sign(f.severity), "" if f.angle is None else tip)
                for f in self._entries
            ]
        )

    def angle(self, row: int) -> float | None:
        """The cam angle [deg] of an entry, None where it has none."""
        return self._entries[row].angle if 0 <= row < len(self._entries) else None


TABLES = "Tables (*.csv *.txt *.dat *.tsv *.asc *.xlsx *.xls *.ods)"
LEFT_WIDTH, USUAL, LEAST = 330, QSize(1080, 720), QSize(900, 560)
ANY_NUMBER, NOT_NEGATIVE = Info("Lowest position"), Info("Measuring error", low=0.0)


class MeasuredDialog(PutDialog):
    """Shows what a table holds and what motion comes of it, and puts that into the design as one step.

    Both are computed beside the window; what comes at once is shown at once.
    """

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
        self.error, self.lowest = NumberBox(NOT_NEGATIVE), NumberBox(ANY_NUMBER)
        self.keep_all = QCheckBox("Keep all rows, wrong ones too")
        self.keep_all.setToolTip("Else rows that no smooth curve joins to those beside them are left out")
        self.laws, self.dwells = (
            QCheckBox("&Laws that fit within the error"),
            QCheckBox("&Dwells that stand exactly still"),
        )
        self.laws.setToolTip("Else tables between the dwells")
        self.dwells.setToolTip("Without laws and dwells the motion is one spline")
        for box in (self.laws, self.dwells):
            box.setChecked(True)
        self.rows_plot, self.residual_plot = XYPlot("", ""), XYPlot("", "")
        self.derivative_plots = XYPlot("", ""), XYPlot("", "")
        for plot in self.plots[:-1]:
            plot.show_numbers(False)
        self.entries = EntryTable()
        self.pages = WordBox()
        self.pages.setToolTip("Sheet of the workbook")
        self.pages.addItems(self._pages(data))
        self.pages.setVisible(self.pages.count() > 1)
        self.leave = QPushButton("Leave these &rows out")
        self.leave.setToolTip("Their lines are passed over; the file stays as it is")
        self.leave.setAutoDefault(False)
        self.leave.hide()
        self._lay_out()
        self._connect()
        self.read_and_fit()

    def _read(self, data: bytes) -> TableReader:
        return TableReader(self._path.name, data, self._unit, self._session.design.speed_rpm)

    # -- building -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        left = QVBoxLayout()
        left.addLayout(self._head())
        left.addWidget(self.form)
        left.addSpacing(8)
        left.addWidget(bold_label("Fit"))
        left.addLayout(self._numbers())
        left.addWidget(self.laws)
        left.addWidget(self.dwells)
        left.addWidget(self.keep_all)
        left.addSpacing(8)
        left.addWidget(bold_label("Result"))
        self.figures = QFormLayout()
        self.figures.setVerticalSpacing(3)
        self._figures: dict[str, QLabel] = {}
        left.addLayout(self.figures)
        left.addStretch(1)
        right = QVBoxLayout()
        right.setSpacing(2)
        right.addWidget(self.rows_plot, 4)
        for plot in self.derivative_plots:
            right.addWidget(plot, 2)
        right.addWidget(self.residual_plot, 3)
        right.addWidget(self.entries, 3)
        right.addWidget(self.leave, 0, Qt.AlignmentFlag.AlignLeft)
        self.frame(left, LEFT_WIDTH, right, USUAL, LEAST)

    def _head(self) -> QHBoxLayout:
        row = QHBoxLayout()
        name = bold_label(self._path.name)
        name.setToolTip(str(self._path))
        name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.again = QPushButton("&Read again")
        self.again.setToolTip("After the file was mended")
        self.again.setAutoDefault(False)
        row.addWidget(name, 1)
        row.addWidget(self.pages)
        row.addWidget(self.again)
        return row

    def _numbers(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        self.units = {"error": QLabel(), "lowest": QLabel(symbol(self._unit))}
        self.estimate = QPushButton("&Estimate")
        self.estimate.setToolTip("What the scatter of the rows tells, at least the rounding of the last digit")
        self.estimate.setAutoDefault(False)
        rows = (("Measuring &error", self.error, "error"), ("&Lowest position", self.lowest, "lowest"))
        for row, (text, box, name) in enumerate(rows):
            label = QLabel(text)
            label.setBuddy(box)
            grid.addWidget(label, row, 0)
            grid.addWidget(box, row, 1)
            grid.addWidget(self.units[name], row, 2)
        grid.addWidget(self.estimate, 0, 3)
        grid.setColumnStretch(1, 1)
        self.error.setToolTip("Standard deviation of one measured value; 0 lays the curve through all rows")
        self.lowest.setToolTip("Where the follower stands at its lowest; the whole motion moves with it")
        return grid

    def _connect(self) -> None:
        self.form.changed.connect(self._read_otherwise)
        self.error.entered.connect(self._state_error)
        self.lowest.entered.connect(lambda value: self._change_request(lowest=value))
        for box in (self.error, self.lowest):
            box.unreadable.connect(lambda box=box: box.set_refused(True))
        self.estimate.clicked.connect(lambda: self._change_request(error=None))
        self.keep_all.toggled.connect(lambda on: self._change_request(keep_all=on))
        self.laws.toggled.connect(lambda on: self._change_request(laws=on))
        self.dwells.toggled.connect(lambda on: self._change_request(dwells=on))
        self.again.clicked.connect(self._read_again)
        self.leave.clicked.connect(self._leave_out)
        self.pages.activated.connect(self._turn_to_page)
        self._work.result.connect(lambda _, answer: self._take(answer))
        self.finished.connect(self._work.stop)
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
        self.form.show_read(answer.sheet, answer.layout)
        self.units["error"].setText(symbol(answer.layout.unit.name) if answer.layout else "")
        self.put_button.setEnabled(not answer.faults)
        for widget in (self.error, self.lowest, self.estimate, self.keep_all, self.laws, self.dwells):
            widget.setEnabled(answer.fit is not None or answer.refused)
        if answer.fit is not None:
            self._show_fit(answer.fit)
            if answer.faults:
                self.show_message(sentence(answer.faults[0].text), wrong=True)
        elif answer.refused:  # the last curve stays
            self.error.set_refused(True)
            self.show_message(sentence(answer.faults[0].text), wrong=True)
        else:
            self._show_faults()

    def _change_request(self, **changes: float | bool | tuple[int, ...] | str | None) -> None:
        self._request = replace(self._request, **changes)  # type: ignore[arg-type]
        self.read_and_fit()

    def _state_error(self, value: float) -> None:
        if value >= 0.0:
            self._change_request(error=value)
        else:
            self.error.set_refused(True)
            self.show_message("Measuring error: allowed: 0 or more", wrong=True)

    def _read_otherwise(self) -> None:
        """Read in other units, or another column: error and level typed before are dropped."""
        self._request = replace(self._request, error=None, lowest=None, leave_out=())
        self.read_and_fit()

    def _pages(self, data: bytes) -> tuple[str, ...]:
        """The sheets of a workbook; none of a text, or where nothing reads it."""
        try:
            return sheet_names(data, self._path.name) if is_workbook(data) else ()
        except KindynaError:
            return ()

    def _turn_to_page(self) -> None:
        self.form.forget()
        self._change_request(page=self.pages.currentText(), leave_out=(), error=None, lowest=None)

    def _leave_out(self) -> None:
        """Pass over the lines that are wrong, besides those passed over already."""
        lines = (line for fault in self.answer.faults if fault.line for line in (fault.line, *fault.others))
        self._change_request(leave_out=tuple(sorted({*self._request.leave_out, *lines})))

    def _read_again(self) -> None:
        try:
            self._reader = self._read(read_bytes(self._path, MOST_BYTES))
        except KindynaError as error:
            dialogs.show_faults(self, f"{self._path.name} cannot be read.", str(error).splitlines())
        else:
            self.answer = TableAnswer()
            self._change_request(leave_out=())

    # -- showing --------------------------------------------------------------------------------------------

    def _show_fit(self, fit: MotionFit) -> None:
        own = fit.table.layout.order
        show_rows(self.rows_plot, fit, own)
        for plot, order in zip(self.derivative_plots, (k for k in range(3) if k != own), strict=True):
            show_rows(plot, fit, order)
        show_residuals(self.residual_plot, fit)
        self.error.show_value(fit.error)
        self.lowest.show_value(float(f"{fit.lowest:.6g}") if self._request.lowest is None else fit.lowest)
        self._show_figures(figures(fit))
        self.entries.show_entries(fit_entries(fit))
        self.show_message("The motion of the design is replaced; Undo brings it back.")

    def _show_faults(self) -> None:
        faults = self.answer.faults
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

    def _point_out(self, index: QModelIndex) -> None:
        for plot in self.plots:
            plot.point_out(self.entries.angle(index.row()))

    # -- the end --------------------------------------------------------------------------------------------

    def accept(self) -> None:
        """Put the motion into the design, where the table gives one."""
        if self.put_button.isEnabled() and self.answer.fit is not None:
            self.put(into_design(self._session.design, self.answer.fit), f"Import {self._path.name}")


def import_measured(session: Session, parent: QWidget) -> MeasuredDialog | None:
    """Ask for a table and open the dialog over a window; it is deleted once closed."""
    opened = dialogs.opened_file(parent, "Import measured motion", TABLES, MOST_BYTES)
    if opened is None:
        return None
    dialog = MeasuredDialog(session, *opened, parent)
    dialog.open_once()
    return dialog


__all__ = ["MeasuredDialog", "import_measured"]
