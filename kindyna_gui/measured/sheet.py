"""Cells of a measured table with marks on wrong rows, and the dialog that imports the table of a controller."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QAbstractTableModel, QModelIndex, QPersistentModelIndex, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QKeyEvent
from PySide6.QtWidgets import QAbstractItemView, QComboBox, QFormLayout, QTableView, QVBoxLayout, QWidget

from core.design import require_motion
from core.errors import KindynaError
from core.frozen import frozen
from core.measured import MotionFit, RowFault, Worksheet
from core.measured.columns import ColumnLayout
from core.motion import program
from core.output.controllers.motion import ControllerMotion, motion_text, read_motion, with_controller_motion
from core.output.controllers.rows import INTERPOLATIONS, controllers
from core.requests import command_words
from kindyna_gui import dialogs
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy_of_line, command_text, session_options
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.request_form import PutDialog
from kindyna_gui.forms.tables import copied
from kindyna_gui.labels import sentence
from kindyna_gui.look import bold_label
from kindyna_gui.measured.form import symbol
from kindyna_gui.pictures.plots.xy import Dots, Line, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.rebuilt import STRETCH, fill

TITLE, FILES = "Import controller table", "Tables of controllers (*)"
FORM_WIDTH, TYPICAL_SIZE, LEAST_SIZE = 330, QSize(900, 480), QSize(700, 360)
POINTS = 1441  # of the curve
Index = QModelIndex | QPersistentModelIndex
TINT = 0.16  # opacity of a column's colour behind its cells
DOUBTFUL = "This row may be wrong; the table does not decide it"
ROWS_MEASURED = 60  # rows that determine the width of a column
WIDEST = 120  # pixels of a column
MOST_MARKS = 5000  # rows marked in a column that contradicts another

# -- controller tables -----------------------------------------------------------------------------------


class ControllerTableDialog(PutDialog):
    """Dialog that imports the table of a controller as a motion.

    ``controller_motion`` is None if the file is not a table of the selected controller.
    """

    help_page = "controllers#Import controller table"

    def __init__(self, session: Session, path: Path, data: bytes, parent: QWidget | None = None) -> None:
        super().__init__(session, TITLE, parent)
        self._path, self._data, self._rows = path, data, controllers()
        self._unit = require_motion(session.design).unit
        self.controller_motion: ControllerMotion | None = None
        self.controller, self.interpolation, self.plot = QComboBox(), QComboBox(), XYPlot("", "")
        self.form = fill(QFormLayout(), ("Controller", self.controller), ("Between two rows", self.interpolation))
        left = fill(QVBoxLayout(), bold_label(path.name), self.form, STRETCH)
        self.frame(left, FORM_WIDTH, self.plot, TYPICAL_SIZE, LEAST_SIZE)
        add_copy_of_line(self.buttons, self._as_command)
        fill_choices(self.controller, {slug: row.label for slug, row in self._rows.items()})
        self.controller.setMinimumContentsLength(24)
        self.controller.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.controller.currentIndexChanged.connect(self._controller_changed)
        self.interpolation.currentIndexChanged.connect(self._read)
        matching = next((i for i, slug in enumerate(self._rows) if self._motion(slug, None)[0] is not None), 0)
        self.controller.setCurrentIndex(matching)
        self._controller_changed()

    def _motion(self, slug: str, interpolation: str | None) -> tuple[ControllerMotion | None, str]:
        """Read the file as a table of a controller; the text says why it is none."""
        try:
            return read_motion(self._rows[slug], self._data, interpolation, self._unit), ""
        except KindynaError as error:
            return None, str(error)

    def _controller_changed(self) -> None:
        row = self._rows[self.controller.currentData()]
        default: dict[Any, str] = {} if row.interpolation_asked else {None: "As in the file, else the default"}
        known = {name: sentence(name.replace("-", " ")) for name in INTERPOLATIONS if name in row.interpolation}
        self.interpolation.blockSignals(True)
        fill_choices(self.interpolation, {**default, **known})
        self.interpolation.blockSignals(False)
        self.form.setRowVisible(self.interpolation, self.interpolation.count() > 1)
        self._read()

    def _read(self) -> None:
        self.controller_motion, error = self._motion(self.controller.currentData(), self.interpolation.currentData())
        self.put_button.setEnabled(self.controller_motion is not None)
        if self.controller_motion is None:
            self.plot.show_message("")
            self.show_message(sentence(error), wrong=True)
            return
        self.show_message(motion_text(self.controller_motion).strip())
        motion = self.controller_motion.motion
        compiled = program(motion)
        ends = np.rad2deg(np.append(compiled.starts, compiled.ends[-1]))
        curve, rows = (
            compiled.state(compiled.angles(np.deg2rad(x))).displacement[0] / motion.scale
            for x in (np.linspace(0.0, 360.0, POINTS)[:-1], ends[:-1])
        )
        self.plot.name_axes("Cam angle, °", f"Displacement, {'°' if motion.unit == 'deg' else motion.unit}")
        line = Line(np.linspace(0.0, 360.0, POINTS)[:-1], curve, SCREEN.family("displacement"))
        self.plot.show_lines([line], fit=True, dots=[Dots(ends[:-1], rows, SCREEN.ink, 4.0)])

    def _as_command(self) -> str:
        from core.commands.tables import MeasuredArguments

        options = {"table": self._path, "controller": self.controller.currentData(), **session_options(self._session)}
        return command_text("measured", command_words(MeasuredArguments, options))

    def accept(self) -> None:
        """Put the motion into the design as one step."""
        if self.controller_motion is not None:
            self.put(with_controller_motion(self._session.design, self.controller_motion), f"Import {self._path.name}")


def import_controller(session: Session, parent: QWidget) -> None:
    """Ask for a file and open the dialog over a window."""
    opened = dialogs.opened_file(parent, TITLE, FILES)
    if opened is not None:
        ControllerTableDialog(session, *opened, parent).open_once()


# -- marks -----------------------------------------------------------------------------------------------


@frozen
class Mark:
    """Mark of a wrong row: its wrong columns (empty: all), and the reason."""

    columns: tuple[int, ...]
    text: str


def fault_marks(faults: Collection[RowFault]) -> dict[int, Mark]:
    """Marks by line of the rows that cannot be read."""
    return {line: Mark((), fault.text) for fault in faults if fault.line for line in (fault.line, *fault.others)}


def fit_marks(fit: MotionFit) -> dict[int, Mark]:
    """Marks by line of the rows that contradict their neighbours, with the expected values."""
    table = fit.table
    columns = (table.layout.value_column, *(column.column for column in table.layout.other_columns))
    marks: dict[int, Mark] = {}
    for i, column_fit in enumerate(fit.columns):
        rows = list(fit.spoiled.get(column_fit.column.order, ()))
        curve = fit.curve(table.angles[rows], i) if rows else ()
        for row, expected in zip(rows, curve, strict=True):
            line, unit = int(table.lines[row]), symbol(column_fit.column.unit)
            previous = marks.get(line, Mark((), ""))
            left_out = ", left out" if i or row in fit.left_out else ""
            text = f"{column_fit.column.name}: {short(float(expected))} {unit} expected{left_out}"
            marks[line] = Mark((*previous.columns, columns[i]), "; ".join(filter(None, (previous.text, text))))
    by_order = {
        column_fit.column.order: (column, column_fit.column.name)
        for column, column_fit in zip(columns, fit.columns, strict=True)
    }
    for gap in fit.contradicted:
        (column, _), (_, integral_name) = by_order[gap.order], by_order[gap.order - 1]
        for row in np.flatnonzero(np.isin(np.round(table.angles, 6), np.round(gap.angles, 6)))[:MOST_MARKS].tolist():
            marks.setdefault(int(table.lines[row]), Mark((column,), f"Contradicts {integral_name}"))
    doubtful = (*fit.outliers.possible, *(row for rows in fit.outliers.undecided for row in rows))
    for row in doubtful:
        marks.setdefault(int(table.lines[row]), Mark((columns[0],), DOUBTFUL))
    return marks


# -- sheet -----------------------------------------------------------------------------------------------


class SheetModel(QAbstractTableModel):
    """Table model of the lines of a file, each with a check box.

    ``switched`` (line, bool) is emitted when a line is checked or unchecked.
    """

    switched = Signal(int, bool)

    def __init__(self) -> None:
        super().__init__()
        self.sheet: Worksheet | None = None
        self.marks: Mapping[int, Mark] = {}
        self.left_out: Collection[int] = ()
        self._colours: dict[int, str] = {}

    def show(
        self, sheet: Worksheet | None, layout: ColumnLayout | None, marks: Mapping[int, Mark], left_out: Collection[int]
    ) -> None:
        """Show a sheet with the colours of its columns, marks by line, and lines left out."""
        colours = {}
        if layout is not None:
            colours = {layout.angle_column: SCREEN.quiet, layout.value_column: SCREEN.family(layout.quantity)}
            colours.update((column.column, SCREEN.family(column.quantity)) for column in layout.other_columns)
        is_same = sheet is self.sheet
        if not is_same:
            self.beginResetModel()
        self.sheet, self.marks, self.left_out, self._colours = sheet, marks, frozenset(left_out), colours
        if not is_same:
            self.endResetModel()
        elif sheet is not None and sheet.rows:
            self.dataChanged.emit(self.index(0, 0), self.index(self.rowCount() - 1, self.columnCount() - 1))
            self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, self.columnCount() - 1)

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if self.sheet is None or (parent is not None and parent.isValid()) else len(self.sheet.rows)

    def columnCount(self, parent: Index | None = None) -> int:
        return 0 if self.sheet is None else self.sheet.columns + 1

    def row_of(self, line: int) -> int | None:
        """Row of a line of the file; None if the sheet does not have it."""
        rows = self.sheet.rows if self.sheet is not None else ()
        index = bisect_left(rows, line, key=lambda row: row.line)
        return index if index < len(rows) and rows[index].line == line else None

    def line_of(self, row: int) -> int:
        """Line of the file of a row."""
        assert self.sheet is not None
        return self.sheet.rows[row].line

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if self.sheet is None or orientation == Qt.Orientation.Vertical:
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return (self.sheet.names[section - 1] or str(section)) if section else "Line"
        if role == Qt.ItemDataRole.ForegroundRole and section - 1 in self._colours:
            return QColor(SCREEN.text_colour(self._colours[section - 1]))
        if role == Qt.ItemDataRole.ToolTipRole:
            return "Unchecked lines are left out; Space checks or unchecks the selected lines" if not section else None
        return None

    def flags(self, index: Index) -> Qt.ItemFlag:
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return flags | Qt.ItemFlag.ItemIsUserCheckable if index.column() == 0 else flags

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        assert self.sheet is not None
        row, column = self.sheet.rows[index.row()], index.column() - 1
        mark, out = self.marks.get(row.line), row.line in self.left_out
        if role == Qt.ItemDataRole.DisplayRole:
            return str(row.line) if column < 0 else row.cells[column] if column < len(row.cells) else ""
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        if role == Qt.ItemDataRole.CheckStateRole and column < 0:
            return Qt.CheckState.Unchecked if out else Qt.CheckState.Checked
        if role == Qt.ItemDataRole.BackgroundRole and column in self._colours and column >= 0:
            colour = QColor(self._colours[column])
            colour.setAlphaF(TINT)
            return colour
        wrong = mark is not None and (not mark.columns or column in (-1, *mark.columns))
        if role == Qt.ItemDataRole.ForegroundRole and (out or wrong):
            return QColor(SCREEN.quiet if out else SCREEN.limit)
        if role == Qt.ItemDataRole.FontRole and (out or wrong):
            font = QFont()
            font.setStrikeOut(out)
            font.setBold(not out)
            return font
        if role == Qt.ItemDataRole.ToolTipRole and mark is not None:
            return mark.text
        return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Check or uncheck a line."""
        if role != Qt.ItemDataRole.CheckStateRole:
            return False
        self.switched.emit(self.line_of(index.row()), Qt.CheckState(value) == Qt.CheckState.Checked)
        return True


class SheetTable(QTableView):
    """Table of the sheet; Space checks or unchecks the selected rows.

    Signals: ``left_out`` (all lines that are left out) after a change; ``chosen`` (line) when a row is selected.
    """

    left_out = Signal(object)
    chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.cells = SheetModel()
        self.cells.setParent(self)
        self.setModel(self.cells)
        self.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.verticalHeader().hide()
        self.setAccessibleName("Rows of the file")
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 4)
        self.horizontalHeader().setHighlightSections(False)
        self.horizontalHeader().setResizeContentsPrecision(ROWS_MEASURED)
        self.cells.switched.connect(lambda line, on: self._switch([line], on))
        self.selectionModel().currentRowChanged.connect(self._choose)

    def show_sheet(
        self, sheet: Worksheet | None, layout: ColumnLayout | None, marks: Mapping[int, Mark], left_out: Collection[int]
    ) -> None:
        """Show a sheet, see `SheetModel.show`; another sheet is scrolled to its first marked row."""
        is_other = sheet is not self.cells.sheet
        self.cells.show(sheet, layout, marks, left_out)
        if is_other and sheet is not None:
            for column in range(self.cells.columnCount()):
                width = max(self.sizeHintForColumn(column), self.horizontalHeader().sectionSizeHint(column))
                self.setColumnWidth(column, min(width, WIDEST))
            if marks and (row := self.cells.row_of(min(marks))) is not None:
                self.scrollTo(self.cells.index(row, 0), QAbstractItemView.ScrollHint.PositionAtCenter)

    def show_line(self, line: int) -> None:
        """Select the row of a line and scroll to it."""
        row = self.cells.row_of(line)
        if row is not None:
            self.selectRow(row)
            self.scrollTo(self.cells.index(row, 0), QAbstractItemView.ScrollHint.PositionAtCenter)

    def _choose(self, index: QModelIndex) -> None:
        if index.isValid():
            self.chosen.emit(self.cells.line_of(index.row()))

    def _switch(self, lines: Collection[int], on: bool) -> None:
        out = frozenset(self.cells.left_out)
        self.left_out.emit(tuple(sorted(out - frozenset(lines) if on else out | frozenset(lines))))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        rows = [index.row() for index in self.selectionModel().selectedRows()]
        if copied(self, event):
            return
        if event.key() == Qt.Key.Key_Space and rows:
            lines = [self.cells.line_of(row) for row in rows]
            self._switch(lines, set(lines) <= set(self.cells.left_out))
        else:
            super().keyPressEvent(event)
