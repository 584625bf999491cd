"""Tables of the window: copied to the clipboard as text, edited cell by cell, or read-only rows under headings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import (
    QAbstractItemModel,
    QAbstractTableModel,
    QEvent,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QRect,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QAction, QColor, QIcon, QKeyEvent, QKeySequence, QPainter, QPen, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QApplication, QHeaderView, QStyledItemDelegate, QTableView, QWidget

from core.design import Info
from core.frozen import frozen
from core.number_text import shortest
from core.units import Unit
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox, parsed
from kindyna_gui.labels import value_text
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import call_soon, connect_all, single_shot
from kindyna_gui.settings import DISPLAY, symbol_of
from kindyna_gui.view import ExplainableNumber

ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
Index = QModelIndex | QPersistentModelIndex
NO_CELL = -1, -1
if TYPE_CHECKING:
    from kindyna_gui.forms.refusal import Remedies

EDGE = 4  # pixels around a text across several columns
LEADING = 5  # pixels between the lines of a table
LEAST_ROWS, MOST_LEAST_HEIGHT = 3, 160  # rows, or all where there are fewer, at which it can be read; at most [pixels]
LEAST_WIDE = 110  # width of a column that takes the remaining width, below which its texts cannot be read [pixels]

# -- Copy takes the full table to the clipboard, for a spreadsheet ---------------------------------------


def table_text(model: QAbstractItemModel) -> str:
    """Return headings and rows as shown, cells separated by tabs; in a tree the children of a row follow it."""
    headings = [model.headerData(column, Qt.Orientation.Horizontal) for column in range(model.columnCount())]
    return "\n".join("\t".join(_cell(text) for text in line) for line in (headings, *_lines(model, QModelIndex())))


def _lines(model: QAbstractItemModel, above: QModelIndex) -> Iterator[list[object]]:
    for row in range(model.rowCount(above)):
        yield [model.index(row, column, above).data() for column in range(model.columnCount(above))]
        yield from _lines(model, model.index(row, 0, above))


def _cell(text: object) -> str:
    return "" if text is None else " ".join(str(text).split())


class CopyKey(QObject):
    """Makes Copy in a plain Qt table copy all of it."""

    def __init__(self, view: QAbstractItemView) -> None:
        super().__init__(view)
        self._view = view
        view.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        return isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress and copied(self._view, event)


def copied(view: QAbstractItemView, event: QKeyEvent) -> bool:
    """Copy the table where a key is Copy, and return whether it was."""
    if not event.matches(QKeySequence.StandardKey.Copy):
        return False
    QApplication.clipboard().setText(table_text(view.model()))
    return True


# -- tables edited cell by cell --------------------------------------------------------------------------


class CellTable(QTableView):
    """A table in which Enter edits a cell and Copy copies the table.

    Signals: ``insert_requested`` and ``delete_requested`` when Insert or Delete is pressed on the current row.
    """

    insert_requested = Signal()
    delete_requested = Signal()

    def __init__(self, model: QAbstractItemModel) -> None:
        super().__init__(showGrid=False)
        self.setModel(model)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setAlternatingRowColors(True)
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
            | QAbstractItemView.EditTrigger.AnyKeyPressed
        )

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key = event.key()
        if self.state() == QAbstractItemView.State.EditingState:
            super().keyPressEvent(event)
        elif copied(self, event):
            return
        elif key in ENTER:  # does nothing where a cell cannot be edited
            self.edit(self.currentIndex(), QAbstractItemView.EditTrigger.EditKeyPressed, event)
        elif key == Qt.Key.Key_Insert:
            self.insert_requested.emit()
        elif key == Qt.Key.Key_Delete:
            self.delete_requested.emit()
        else:
            super().keyPressEvent(event)


class CellModel(QAbstractTableModel):
    """Model of a table whose cells edit the design; a text that the session refuses stays in its cell.

    ``error_changed`` (str, Remedies) gives the error of the last edit; empty if there is none.
    """

    error_changed = Signal(str, object)

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session = session
        self._faulty: frozenset[str] = frozenset()  # paths of values that contradict each other
        self._wrong: dict[str, str] = {}  # path -> the text that was refused
        self._trying, self._cell = "", NO_CELL  # the text that was entered last, and its cell
        connect_all(
            (session.refused, self._refused),
            (session.accepted, self._accepted),
            (session.restored, self.withdraw),
            (DISPLAY.changed, self._update_units),
        )

    def path(self, row: int, column: int) -> str:
        """Path that a cell edits; empty if it edits none."""
        raise NotImplementedError

    def value(self, row: int, column: int) -> Any:
        """Value of a cell in the design."""
        raise NotImplementedError

    def info_of(self, column: int) -> Info:
        """Metadata of the values of a column."""
        raise NotImplementedError

    def unit_of(self, column: int) -> Unit:
        """Unit of the numbers of a column."""
        raise NotImplementedError

    def edits(self, path: str) -> bool:
        """Whether one of the cells edits a path."""
        raise NotImplementedError

    def is_refused(self, row: int, column: int) -> bool:
        """Whether the text typed into a cell was refused."""
        return (row, column) == self._cell and self.path(row, column) in self._wrong

    def _try(self, row: int, column: int, text: str) -> None:
        """Note the text that is entered into a cell."""
        self._trying, self._cell = text, (row, column)

    def _all_changed(self) -> None:
        if self.rowCount():
            last = self.index(self.rowCount() - 1, self.columnCount() - 1)
            self.dataChanged.emit(self.index(0, 0), last)

    def _update_units(self) -> None:
        """Show headings and cells in other units."""
        self._all_changed()
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, self.columnCount() - 1)

    def _refused(self, refusal: Refusal) -> None:
        from kindyna_gui.forms.refusal import NO_REMEDIES, with_value  # imported here to save start-up time

        if self.edits(refusal.path):
            text, remedies = refusal.at(refusal.path), NO_REMEDIES
            if self._cell != NO_CELL and self.path(*self._cell) == refusal.path:
                number = parsed(self._trying, self.unit_of(self._cell[1]))
                text = with_value(text, value_text(number, self.unit_of(self._cell[1])))
                remedies = self._remedies(*self._cell, number)
            else:  # it was entered elsewhere
                self._cell = NO_CELL
            self._wrong = {refusal.path: self._trying}
            self.error_changed.emit(text, remedies)
            self._all_changed()

    def nearest(self, row: int, column: int, number: float | None) -> float | None:
        """Return the value nearest to a refused number that a cell admits; None where there is none."""
        from kindyna_gui.forms.refusal import nearest_value

        return nearest_value(self._session, self.path(row, column), self.info_of(column), number)

    def _remedies(self, row: int, column: int, number: float | None) -> Remedies:
        """Remedies of a refused cell."""
        from kindyna_gui.forms.refusal import value_remedies

        unit = self.unit_of(column)

        def use(value: float) -> None:
            self._session.end_gesture()
            self.setData(self.index(row, column), f"{shortest(value)} {unit.symbol}")
            self._session.end_gesture()

        nearest, valid = self.nearest(row, column, number), self.value(row, column)
        return value_remedies(lambda value: value_text(value, unit), nearest, valid, use, self.withdraw)

    def _accepted(self, path: str) -> None:
        if path in self._wrong:
            self.withdraw()
        elif not self._wrong:
            self._cell = NO_CELL

    def withdraw(self) -> bool:
        """Discard a refused text; False if there is none."""
        if not self._wrong:
            return False
        wrong, self._wrong = self._wrong, {}
        self._cell = NO_CELL
        self.error_changed.emit("", {})
        self._all_changed()
        for path in wrong:
            self._session.clear_refusal(path)
        return True


def draw_refused(painter: QPainter, box: QRect) -> None:
    """Draw the frame of a refused cell."""
    painter.save()
    painter.setPen(QPen(QColor(SCREEN.limit), 1.6))
    painter.drawRect(box.adjusted(1, 1, -2, -2))
    painter.restore()


class CellDelegate(QStyledItemDelegate):
    """Commits the text of an editor only while the table has it open: the focus leaves an editor again while it closes."""

    def __init__(self, session: Session, model: CellModel, table: QTableView) -> None:
        super().__init__(table)
        self._session = session
        self._model = model
        self._table = table
        self._open: QWidget | None = None
        self._index = QPersistentModelIndex()
        self.closeEditor.connect(self._closed)
        model.modelAboutToBeReset.connect(self._closed)

    def opened(self, editor: QWidget, index: QModelIndex | QPersistentModelIndex) -> None:
        """Note the open editor and its cell."""
        self._open, self._index = editor, QPersistentModelIndex(index)

    def open_box(self, box: NumberBox, index: Index) -> NumberBox:
        """Open a box for the number of a cell."""
        connect_all(
            (box.entered, lambda _: self.commit(box)),
            (box.unreadable, lambda: self.commit(box)),
            (box.withdrawn, self._model.withdraw),
            (box.finished, self._session.end_gesture),
        )
        self.opened(box, index)
        return box

    def setEditorData(self, editor: Any, index: Index) -> None:
        """Show the number of a cell, or the text that was refused, unless another one is being typed."""
        wrong = self._model.is_refused(index.row(), index.column())
        if not (wrong and editor.pending):
            editor.show_value(self._model.value(index.row(), index.column()))
            if wrong:
                editor.lineEdit().setText(str(self._model.data(index, Qt.ItemDataRole.EditRole)))
            editor.selectAll()
        editor.set_refused(wrong)

    def commit(self, editor: QWidget) -> None:
        """Write the text of an editor to the model, if the editor is open."""
        if self._is_open(editor):
            self.commitData.emit(editor)

    def eventFilter(self, editor: Any, event: QEvent) -> bool:
        """Commit on Enter and when the focus leaves; Qt would commit an editor too that the table has closed by then."""
        if not self._is_open(editor):
            return False
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress and event.key() in ENTER:
            call_soon(editor, lambda: self._commit_and_close(editor))
            return False  # the editor has the key first
        return super().eventFilter(editor, event)

    def _commit_and_close(self, editor: QWidget) -> None:
        if self._is_open(editor):
            self.commitData.emit(editor)
        if self._is_open(editor):
            self.closeEditor.emit(editor, QStyledItemDelegate.EndEditHint.SubmitModelCache)

    def _is_open(self, editor: QObject) -> bool:
        """Whether the editor is open: a row that is removed closes its editor without a signal."""
        return editor is self._open and self._table.indexWidget(QModelIndex(self._index)) is editor  # type: ignore[call-overload]

    def _closed(self) -> None:  # without the editor, which may be deleted by now
        self._open = None
        self._session.end_gesture()


# -- read-only tables: rows of text, numbers aligned right -----------------------------------------------


@frozen
class TableRow:
    """A row of a table: its cells, an icon before the first, a tip and a colour for all of them.

    ``across`` is the column whose text spans all columns after it, on several lines if necessary; ``number`` is the number
    of the row that can be explained.
    """

    cells: tuple[str, ...]
    icon: QIcon | None = None
    tip: str = ""
    colour: str = ""
    across: int | None = None
    number: ExplainableNumber | None = None


@frozen
class TableHeading:
    """The heading of a column: its title, whether it has numbers, whether it takes the remaining width, its tip and unit.

    The unit is shown as the preferences say. Columns with ``spare`` are hidden where the table is too narrow, that of the
    largest number first.
    """

    title: str
    number: bool = False
    wide: bool = False
    tip: str = ""
    unit: str = ""
    spare: int = 0

    @property
    def shown(self) -> str:
        """Title with the unit on display."""
        return f"{self.title}, {symbol_of(self.unit)}" if self.unit else self.title


class RowsModel(QAbstractTableModel):
    """The model of a read-only table."""

    def __init__(self, headings: Sequence[TableHeading]) -> None:
        super().__init__()
        self._headings = tuple(headings)
        self.rows: tuple[TableRow, ...] = ()

    def show(self, rows: Sequence[TableRow]) -> None:
        """Show these rows."""
        self.beginResetModel()
        self.rows = tuple(rows)
        self.endResetModel()

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self.rows)

    def columnCount(self, parent: Index | None = None) -> int:
        return len(self._headings)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Vertical:
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return self._headings[section].shown
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._headings[section].tip or None
        return self._aligned(section) if role == Qt.ItemDataRole.TextAlignmentRole else None

    def replace(self, rows: Sequence[TableRow], among: range) -> list[Index]:
        """Replace the rows by as many others, without notifying views; return the changed cells among some of the rows."""
        before, self.rows = self.rows, tuple(rows)
        changed: list[Index] = []
        for number in among:
            old, new = before[number].cells, self.rows[number].cells
            changed += [self.index(number, column) for column in range(len(new)) if new[column] != old[column]]
        return changed

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        row, column = self.rows[index.row()], index.column()
        if role == Qt.ItemDataRole.DisplayRole:
            return row.cells[column]
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return self._aligned(column)
        if role == Qt.ItemDataRole.DecorationRole and column == 0:
            return row.icon
        if role == Qt.ItemDataRole.ToolTipRole:
            return row.tip or None
        if role == Qt.ItemDataRole.SizeHintRole and column == row.across:
            return QSize(0, 0)  # it widens no column
        if role == Qt.ItemDataRole.ForegroundRole and row.colour:
            return QColor(row.colour)
        return None

    def _aligned(self, column: int) -> Qt.AlignmentFlag:
        side = Qt.AlignmentFlag.AlignRight if self._headings[column].number else Qt.AlignmentFlag.AlignLeft
        return side | Qt.AlignmentFlag.AlignVCenter


class RowsTable(QTableView):
    """A read-only table; Copy takes all of it to the clipboard.

    Signal ``rows_resized``: rows have the heights of their texts in the current columns.
    """

    rows_resized = Signal()

    def __init__(self, headings: Sequence[TableHeading]) -> None:
        super().__init__()
        self.rows = RowsModel(headings)
        self.rows.setParent(self)
        self.setAccessibleName(", ".join(heading.title for heading in headings if heading.title))
        self._least_height = 0  # for ``LEAST_ROWS``
        self._widths: dict[int, tuple[int, int]] = {}  # column -> width of its widest text, and the width it needs
        self.setModel(self.rows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.setAlternatingRowColors(True)
        self.setWordWrap(True)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.verticalHeader().hide()
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setMinimumSectionSize(30)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        for column, heading in enumerate(headings):
            if heading.wide:
                header.setSectionResizeMode(column, QHeaderView.ResizeMode.Stretch)
        self._soon = single_shot(self, self.resizeRowsToContents)
        if any(heading.wide for heading in headings):  # its texts have more lines where it is narrow
            header.sectionResized.connect(self._soon.start)
        self._headings = tuple(headings)
        self._chosen: dict[int, bool] = {}  # columns that the user has shown or hidden
        header.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        for column, heading in enumerate(headings):
            if heading.spare:
                action = QAction(heading.title, header, checkable=True, checked=True)
                action.setData(column)
                action.triggered.connect(partial(self._choose_column, column))
                header.addAction(action)

    # -- columns that give way -----------------------------------------------------------------------------

    def _choose_column(self, column: int, on: bool) -> None:
        self._chosen[column] = on
        self._fit_columns()
        self.resizeRowsToContents()

    def _fit_columns(self) -> None:
        """Hide the columns with ``spare`` for which there is no room, unless the user has chosen them."""
        header, spare = self.horizontalHeader(), [c for c, heading in enumerate(self._headings) if heading.spare]
        if not spare:
            return
        widths = [
            max(header.sectionSizeHint(column), LEAST_WIDE if heading.wide else self.sizeHintForColumn(column))
            for column, heading in enumerate(self._headings)
        ]
        hidden = {column for column in spare if self._chosen.get(column) is False}
        for column in sorted(spare, key=lambda column: -self._headings[column].spare):
            room = self.viewport().width() - sum(widths) + sum(widths[other] for other in hidden)
            if room < 0 and column not in self._chosen:
                hidden.add(column)
        for column in spare:
            if self.isColumnHidden(column) != (column in hidden):
                self.setColumnHidden(column, column in hidden)
        for action in header.actions():
            action.setChecked(action.data() not in hidden)

    @property
    def number(self) -> ExplainableNumber | None:
        """The number of the current row that can be explained."""
        current = self.currentIndex().row()
        return self.rows.rows[current].number if 0 <= current < len(self.rows.rows) else None

    def height_of(self, rows: int) -> int:
        """Height of the headings and the first rows, at most all [pixels]."""
        heights = (self.rowHeight(row) for row in range(min(rows, self.rows.rowCount())))
        heading = 0 if self.horizontalHeader().isHidden() else self.horizontalHeader().sizeHint().height()
        return heading + sum(heights) + 2 * self.frameWidth()

    def minimumSizeHint(self) -> QSize:
        return QSize(super().minimumSizeHint().width(), self._least_height)

    def show_rows(self, rows: Sequence[TableRow]) -> None:
        """Show these rows, and keep the number of the current one."""
        chosen = self.currentIndex().row()
        self._widths.clear()
        self.clearSpans()
        self.rows.show(rows)
        for number, row in enumerate(rows):
            if row.across is not None and row.across + 1 < len(row.cells):
                self.setSpan(number, row.across, 1, len(row.cells) - row.across)
        self._fit_columns()
        self.resizeRowsToContents()
        if 0 <= chosen < len(rows):
            self.selectRow(chosen)

    def show_buttons(self, column: int, buttons: Iterable[QWidget]) -> None:
        """Put a button over a cell of each row, as long as these rows are shown."""
        for row, button in enumerate(buttons):
            self.setIndexWidget(self.rows.index(row, column), button)
        self.resizeRowsToContents()

    def update_rows(self, rows: Sequence[TableRow]) -> None:
        """Show other texts in the same number of rows, fast enough for a turning crank; else as ``show_rows``.

        Only visible cells with another text are drawn. A column becomes wider where a text needs it, and never narrower, so
        that nothing jumps.
        """
        if not rows or len(rows) != len(self.rows.rows) or not self.isVisible():
            self.show_rows(rows)
            return
        changed = self.rows.replace(rows, self._visible_rows())
        for cell in changed:
            self.update(cell)
        self._widen(changed)

    def _widen(self, cells: Iterable[Index]) -> None:
        """Widen columns to the width that these cells need."""
        advance, wider = self.fontMetrics().horizontalAdvance, set()
        for cell in cells:
            column = cell.column()
            widest, hint = self._widths.get(column, (0, 0))
            width = advance(self.rows.rows[cell.row()].cells[column])
            if hint and width > widest:
                self._widths[column] = (width, max(hint, self.sizeHintForIndex(cell).width()))
                wider.add(column)
        for column in wider:
            self.resizeColumnToContents(column)
        if wider:
            self._fit_columns()

    def _visible_rows(self) -> range:
        """Return the numbers of the visible rows."""
        first, last = self.rowAt(0), self.rowAt(self.viewport().height() - 1)
        return range(max(first, 0), last + 1 if last >= 0 else len(self.rows.rows))

    def sizeHintForColumn(self, column: int) -> int:
        """Return the width of a column's texts; it is measured once, then only for cells that become wider."""
        if column not in self._widths:
            texts = [row.cells[column] for row in self.rows.rows]
            widest = max(map(self.fontMetrics().horizontalAdvance, texts), default=0)
            self._widths[column] = (widest, super().sizeHintForColumn(column))
        return self._widths[column][1]

    def sizeHintForRow(self, number: int) -> int:
        row, height = self.rows.rows[number], super().sizeHintForRow(number)
        if row.across is None:
            return height
        width = sum(self.columnWidth(column) for column in range(row.across, len(row.cells))) - 2 * EDGE
        text = self.fontMetrics().boundingRect(QRect(0, 0, width, 0), Qt.TextFlag.TextWordWrap, row.cells[row.across])
        return max(height, text.height() + 2 * EDGE)

    def resizeRowsToContents(self) -> None:
        """Set row heights to their texts; Qt would use the height of a row heading, though there is none."""
        least = self.fontMetrics().height() + LEADING
        for number in range(len(self.rows.rows)):
            self.setRowHeight(number, max(self.sizeHintForRow(number), least))
        least_height = min(self.height_of(LEAST_ROWS), MOST_LEAST_HEIGHT)
        if least_height != self._least_height:
            self._least_height = least_height
            self.updateGeometry()
        self.rows_resized.emit()

    def scrollContentsBy(self, dx: int, dy: int) -> None:
        """Widen columns for the rows that become visible."""
        super().scrollContentsBy(dx, dy)
        if dy:
            self._widen(self.rows.index(row, column) for row in self._visible_rows() for column in tuple(self._widths))

    def changeEvent(self, event: QEvent) -> None:
        """Measure texts again when the font changes."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._widths.clear()
            self._fit_columns()
            self.resizeRowsToContents()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit_columns()
        self.resizeRowsToContents()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if copied(self, event):
            return
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.currentIndex().isValid():
            self.activated.emit(self.currentIndex())
        else:
            super().keyPressEvent(event)
