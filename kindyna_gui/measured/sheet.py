"""Its cells; controller tables."""

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
from core.output.measured_text import digits
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

# -- controller dialog -----------------------------------------------------------------------------------

TITLE, FILES = "Import controller table", "Tables of controllers (*)"
WIDTH, USUAL, LEAST = 330, QSize(900, 480), QSize(700, 360)
POINTS = 1441  # of the curve


class ControllerTableDialog(PutDialog):
    """``found`` is the motion of the file, None where the chosen controller has no such files."""

    help_page = "controllers#Import controller table"

    def __init__(self, session: Session, path: Path, data: bytes, parent: QWidget | None = None) -> None:
        super().__init__(session, TITLE, parent)
        self._path, self._data, self._rows = path, data, controllers()
        self._unit = require_motion(session.design).unit
        self.found: ControllerMotion | None = None
        self.controller, self.interpolation, self.plot = QComboBox(), QComboBox(), XYPlot("", "")
        self.form = QFormLayout()
        self.form.addRow("Controller", self.controller)
        self.form.addRow("Between two rows", self.interpolation)
        left = QVBoxLayout()
        left.addWidget(bold_label(path.name))
        left.addLayout(self.form)
        left.addStretch(1)
        self.frame(left, WIDTH, self.plot, USUAL, LEAST)
        add_copy_of_line(self.buttons, self._as_command)
        fill_choices(self.controller, {slug: row.label for slug, row in self._rows.items()})
        self.controller.setMinimumContentsLength(24)
        self.controller.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.controller.currentIndexChanged.connect(self._suit_controller)
        self.interpolation.currentIndexChanged.connect(self._read)
        fitting = next((i for i, slug in enumerate(self._rows) if self._motion(slug, None)[0] is not None), 0)
        self.controller.setCurrentIndex(fitting)
        self._suit_controller()

    def _motion(self, slug: str, interpolation: str | None) -> tuple[ControllerMotion | None, str]:
        """What the file is to a controller, or why it is nothing."""
        try:
            return read_motion(self._rows[slug], self._data, interpolation, self._unit), ""
        except KindynaError as error:
            return None, str(error)

    def _suit_controller(self) -> None:
        row = self._rows[self.controller.currentData()]
        usual: dict[Any, str] = {} if row.interpolation_asked else {None: "As the file says, or usual"}
        known = {name: sentence(name.replace("-", " ")) for name in INTERPOLATIONS if name in row.interpolation}
        self.interpolation.blockSignals(True)
        fill_choices(self.interpolation, {**usual, **known})
        self.interpolation.blockSignals(False)
        self.form.setRowVisible(self.interpolation, self.interpolation.count() > 1)
        self._read()

    def _read(self) -> None:
        self.found, wrong = self._motion(self.controller.currentData(), self.interpolation.currentData())
        self.put_button.setEnabled(self.found is not None)
        if self.found is None:
            self.plot.show_message("")
            self.show_message(sentence(wrong), wrong=True)
            return
        self.show_message(motion_text(self.found).strip())
        motion = self.found.motion
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

        asked = {"table": self._path, "controller": self.controller.currentData(), **session_options(self._session)}
        return command_text("measured", command_words(MeasuredArguments, asked))

    def accept(self) -> None:
        """Put the motion into the design as one step."""
        if self.found is not None:
            self.put(with_controller_motion(self._session.design, self.found), f"Import {self._path.name}")


def import_controller(session: Session, parent: QWidget) -> None:
    """Ask for a file and open the dialog over a window."""
    opened = dialogs.opened_file(parent, TITLE, FILES)
    if opened is not None:
        ControllerTableDialog(session, *opened, parent).open_once()


# -- sheet -----------------------------------------------------------------------------------------------

Index = QModelIndex | QPersistentModelIndex
TINT = 0.16  # of a column's colour behind its cells
DOUBT = "It may be wrong: nothing tells"
ROWS_MEASURED = 60  # that tell how wide a column is
WIDEST = 120  # pixels of a column
MOST = 5000  # rows marked of a column that contradicts another


@frozen
class Mark:
    """What is wrong with a row: its columns (empty: all), and why."""

    columns: tuple[int, ...]
    text: str


def fault_marks(faults: Collection[RowFault]) -> dict[int, Mark]:
    """By line, of rows that cannot be read."""
    return {line: Mark((), fault.text) for fault in faults if fault.line for line in (fault.line, *fault.others)}


def fit_marks(fit: MotionFit) -> dict[int, Mark]:
    """By line, of rows that contradict those beside them: what stands there, and what was expected."""
    how, table = fit.table.layout, fit.table
    places = (how.value_column, *(each.column for each in how.other_columns))
    marks: dict[int, Mark] = {}
    for i, each in enumerate(fit.columns):
        rows = list(fit.spoiled.get(each.column.order, ()))
        curve = fit.curve(table.angles[rows], i) if rows else ()
        for row, expected in zip(rows, curve, strict=True):
            line, unit = int(table.lines[row]), symbol(each.column.unit)
            before = marks.get(line, Mark((), ""))
            left = ", left out" if i or row in fit.left_out else ""
            told = f"{each.column.name}: {digits(float(expected), 5)} {unit} expected{left}"
            marks[line] = Mark((*before.columns, places[i]), "; ".join(filter(None, (before.text, told))))
    by_order = {each.column.order: (place, each.column.name) for place, each in zip(places, fit.columns, strict=True)}
    for gap in fit.contradicted:
        (place, _), (_, before_name) = by_order[gap.order], by_order[gap.order - 1]
        for row in np.flatnonzero(np.isin(np.round(table.angles, 6), np.round(gap.angles, 6)))[:MOST].tolist():
            marks.setdefault(int(table.lines[row]), Mark((place,), f"It contradicts {before_name}"))
    doubtful = (*fit.outliers.possible, *(row for stretch in fit.outliers.undecided for row in stretch))
    for row in doubtful:
        marks.setdefault(int(table.lines[row]), Mark((places[0],), DOUBT))
    return marks


class SheetModel(QAbstractTableModel):
    """Lines of the file with a check each, and their cells.

    switched   line that was checked or unchecked; whether it is checked
    """

    switched = Signal(int, bool)

    def __init__(self) -> None:
        super().__init__()
        self.sheet: Worksheet | None = None
        self.marks: Mapping[int, Mark] = {}
        self.left_out: Collection[int] = ()
        self._colours: dict[int, str] = {}

    def show(
        self, sheet: Worksheet | None, how: ColumnLayout | None, marks: Mapping[int, Mark], left_out: Collection[int]
    ) -> None:
        """Show this sheet, so read, with these rows marked, and these left out."""
        colours = {} if how is None else {how.angle_column: SCREEN.quiet, how.value_column: SCREEN.family(how.quantity)}
        for each in how.other_columns if how is not None else ():
            colours[each.column] = SCREEN.family(each.quantity)
        same = sheet is self.sheet
        if not same:
            self.beginResetModel()
        self.sheet, self.marks, self.left_out, self._colours = sheet, marks, frozenset(left_out), colours
        if not same:
            self.endResetModel()
        elif sheet is not None and sheet.rows:
            self.dataChanged.emit(self.index(0, 0), self.index(self.rowCount() - 1, self.columnCount() - 1))
            self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, self.columnCount() - 1)

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if self.sheet is None or (parent is not None and parent.isValid()) else len(self.sheet.rows)

    def columnCount(self, parent: Index | None = None) -> int:
        return 0 if self.sheet is None else self.sheet.columns + 1

    def row_of(self, line: int) -> int | None:
        """Where a line of the file stands."""
        rows = self.sheet.rows if self.sheet is not None else ()
        at = bisect_left(rows, line, key=lambda row: row.line)
        return at if at < len(rows) and rows[at].line == line else None

    def line_of(self, row: int) -> int:
        """The line of the file that stands there."""
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
            return "Unchecked lines are left out; Space switches those chosen" if not section else None
        return None

    def flags(self, index: Index) -> Qt.ItemFlag:
        usual = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return usual | Qt.ItemFlag.ItemIsUserCheckable if index.column() == 0 else usual

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
    """The sheet; Space leaves the chosen rows out, or takes them back.

    left_out   lines that are left out from now on
    chosen     line of the row that was chosen
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
        self, sheet: Worksheet | None, how: ColumnLayout | None, marks: Mapping[int, Mark], left_out: Collection[int]
    ) -> None:
        """As of the model; of another sheet the first row that is marked comes into sight."""
        other = sheet is not self.cells.sheet
        self.cells.show(sheet, how, marks, left_out)
        if other and sheet is not None:
            for column in range(self.cells.columnCount()):
                width = max(self.sizeHintForColumn(column), self.horizontalHeader().sectionSizeHint(column))
                self.setColumnWidth(column, min(width, WIDEST))
            if marks and (row := self.cells.row_of(min(marks))) is not None:
                self.scrollTo(self.cells.index(row, 0), QAbstractItemView.ScrollHint.PositionAtCenter)

    def show_line(self, line: int) -> None:
        """Choose the row of a line and bring it into sight."""
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
