"""Tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

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
from PySide6.QtGui import QColor, QIcon, QKeyEvent, QKeySequence, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QApplication, QHeaderView, QStyledItemDelegate, QTableView, QWidget

from core.frozen import frozen
from kindyna_gui.documents.session import Session
from kindyna_gui.rebuilt import soon
from kindyna_gui.settings import symbol_of
from kindyna_gui.view import ExplainableNumber

# -- copy in a table takes all of it to the clipboard, for a spreadsheet ---------------------------------


def table_text(model: QAbstractItemModel) -> str:
    """Headings and rows as shown, cells apart by tabs; of a tree what stands below a row follows it."""
    heads = [model.headerData(column, Qt.Orientation.Horizontal) for column in range(model.columnCount())]
    return "\n".join("\t".join(_cell(text) for text in line) for line in (heads, *_lines(model, QModelIndex())))


def _lines(model: QAbstractItemModel, above: QModelIndex) -> Iterator[list[object]]:
    for row in range(model.rowCount(above)):
        yield [model.index(row, column, above).data() for column in range(model.columnCount(above))]
        yield from _lines(model, model.index(row, 0, above))


def _cell(text: object) -> str:
    return "" if text is None else " ".join(str(text).split())


class CopyKey(QObject):
    """Lets Copy in a table of Qt's own take all of it."""

    def __init__(self, view: QAbstractItemView) -> None:
        super().__init__(view)
        self._view = view
        view.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        return isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress and copied(self._view, event)


def copied(view: QAbstractItemView, event: QKeyEvent) -> bool:
    """Whether a key was Copy, and has been done."""
    if not event.matches(QKeySequence.StandardKey.Copy):
        return False
    QApplication.clipboard().setText(table_text(view.model()))
    return True


# -- cell editor -----------------------------------------------------------------------------------------

ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)


class CellTable(QTableView):
    """Enter edits a cell, Copy takes the whole table; Insert and Delete ask for a row more or less.

    insert_requested, delete_requested   of the chosen row
    """

    insert_requested = Signal()
    delete_requested = Signal()

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


class CellDelegate(QStyledItemDelegate):
    """Commits what stands in the editor as long as the table has it open: the focus leaves an editor once more while it is
    being closed."""

    def __init__(self, session: Session, model: QAbstractItemModel, table: QTableView) -> None:
        super().__init__(table)
        self._session = session
        self._table = table
        self._open: QWidget | None = None
        self._index = QPersistentModelIndex()
        self.closeEditor.connect(self._closed)
        model.modelAboutToBeReset.connect(self._closed)

    def opened(self, editor: QWidget, index: QModelIndex | QPersistentModelIndex) -> None:
        """This is the editor now, of the cell at ``index``."""
        self._open, self._index = editor, QPersistentModelIndex(index)

    def commit(self, editor: QWidget) -> None:
        """Give what stands in an editor to the model, if it is the one that is open."""
        if self._is_open(editor):
            self.commitData.emit(editor)

    def eventFilter(self, editor: Any, event: QEvent) -> bool:
        """Qt commits an editor that the focus leaves, or a moment after Enter: one too that the table has given up by then."""
        if not self._is_open(editor):
            return False
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress and event.key() in ENTER:
            soon(editor, lambda: self._commit_and_close(editor))
            return False  # the editor has the key first
        return super().eventFilter(editor, event)

    def _commit_and_close(self, editor: QWidget) -> None:
        if self._is_open(editor):
            self.commitData.emit(editor)
        if self._is_open(editor):
            self.closeEditor.emit(editor, QStyledItemDelegate.EndEditHint.SubmitModelCache)

    def _is_open(self, editor: QObject) -> bool:
        """A row that is removed takes its editor from the table without a word."""
        return editor is self._open and self._table.indexWidget(QModelIndex(self._index)) is editor  # type: ignore[call-overload]

    def _closed(self) -> None:  # without the editor, which may have gone by now
        self._open = None
        self._session.end_gesture()


# -- tables that are only read: rows of text, numbers flush right ----------------------------------------

Index = QModelIndex | QPersistentModelIndex
EDGE = 4  # pixels around a text that goes across columns
LEADING = 5  # between the lines of a table, pixels


@frozen
class TableRow:
    """Cells from left to right; icon before the first; tip and colour for the whole row; across: the column whose text has the room
    of all behind it, and as many lines as it needs; number: what is explained of it."""

    cells: tuple[str, ...]
    icon: QIcon | None = None
    tip: str = ""
    colour: str = ""
    across: int | None = None
    number: ExplainableNumber | None = None


@frozen
class TableHeading:
    """A column: its title, whether its cells are numbers, whether it takes the room that is left, what it holds in a sentence, and the
    unit of its values, which is shown as the user prefers it."""

    title: str
    number: bool = False
    wide: bool = False
    tip: str = ""
    unit: str = ""

    @property
    def shown(self) -> str:
        """Title and unit."""
        return f"{self.title}, {symbol_of(self.unit)}" if self.unit else self.title


class RowsModel(QAbstractTableModel):
    """Rows under headings."""

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
        """Other contents in as many rows, of which no view is told; which cells of some of the rows have another text."""
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
    """A quiet table; Copy takes all of it to the clipboard."""

    def __init__(self, headings: Sequence[TableHeading]) -> None:
        super().__init__()
        self.rows = RowsModel(headings)
        self.rows.setParent(self)
        self.setAccessibleName(", ".join(heading.title for heading in headings if heading.title))
        self._widths: dict[int, tuple[int, int]] = {}  # of a column: of its widest text, and what that needs
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
        head = self.horizontalHeader()
        head.setHighlightSections(False)
        head.setMinimumSectionSize(30)
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        for column, heading in enumerate(headings):
            if heading.wide:
                head.setSectionResizeMode(column, QHeaderView.ResizeMode.Stretch)

    @property
    def number(self) -> ExplainableNumber | None:
        """That of the chosen row."""
        at = self.currentIndex().row()
        return self.rows.rows[at].number if 0 <= at < len(self.rows.rows) else None

    def show_rows(self, rows: Sequence[TableRow]) -> None:
        """Show these rows, the chosen one staying chosen."""
        chosen = self.currentIndex().row()
        self._widths.clear()
        self.clearSpans()
        self.rows.show(rows)
        for number, row in enumerate(rows):
            if row.across is not None and row.across + 1 < len(row.cells):
                self.setSpan(number, row.across, 1, len(row.cells) - row.across)
        self.resizeRowsToContents()
        if 0 <= chosen < len(rows):
            self.selectRow(chosen)

    def show_buttons(self, column: int, buttons: Iterable[QWidget]) -> None:
        """Put a button over the cell of each row, as long as these rows are shown."""
        for row, button in enumerate(buttons):
            self.setIndexWidget(self.rows.index(row, column), button)
        self.resizeRowsToContents()

    def update_rows(self, rows: Sequence[TableRow]) -> None:
        """Show other contents in as many rows, quickly enough for a turning crank; else as ``show_rows``.

        Only cells in sight whose text is another one are drawn anew. A column becomes wider where a text needs it, and not
        narrower again, so that nothing jumps.
        """
        if not rows or len(rows) != len(self.rows.rows) or not self.isVisible():
            self.show_rows(rows)
            return
        changed = self.rows.replace(rows, self._rows_in_sight())
        for cell in changed:
            self.update(cell)
        self._widen(changed)

    def _widen(self, cells: Iterable[Index]) -> None:
        """Give their columns the width that these cells need."""
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

    def _rows_in_sight(self) -> range:
        """The numbers of the rows of which something can be seen."""
        first, last = self.rowAt(0), self.rowAt(self.viewport().height() - 1)
        return range(max(first, 0), last + 1 if last >= 0 else len(self.rows.rows))

    def sizeHintForColumn(self, column: int) -> int:
        """The width that the texts of a column need; the cells are asked once, then only those that become wider."""
        if column not in self._widths:
            texts = [row.cells[column] for row in self.rows.rows]
            widest = max(map(self.fontMetrics().horizontalAdvance, texts), default=0)
            self._widths[column] = (widest, super().sizeHintForColumn(column))
        return self._widths[column][1]

    def sizeHintForRow(self, number: int) -> int:
        row, height = self.rows.rows[number], super().sizeHintForRow(number)
        if row.across is None:
            return height
        room = sum(self.columnWidth(column) for column in range(row.across, len(row.cells))) - 2 * EDGE
        text = self.fontMetrics().boundingRect(QRect(0, 0, room, 0), Qt.TextFlag.TextWordWrap, row.cells[row.across])
        return max(height, text.height() + 2 * EDGE)

    def resizeRowsToContents(self) -> None:
        """As high as their texts; Qt would give each the height of a heading, though none stands beside it."""
        least = self.fontMetrics().height() + LEADING
        for number in range(len(self.rows.rows)):
            self.setRowHeight(number, max(self.sizeHintForRow(number), least))

    def scrollContentsBy(self, dx: int, dy: int) -> None:
        """What comes into sight may be wider than what was."""
        super().scrollContentsBy(dx, dy)
        if dy:
            self._widen(self.rows.index(row, column) for row in self._rows_in_sight() for column in tuple(self._widths))

    def changeEvent(self, event: QEvent) -> None:
        """Another font, other widths."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._widths.clear()
            self.resizeRowsToContents()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.resizeRowsToContents()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if copied(self, event):
            return
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.currentIndex().isValid():
            self.activated.emit(self.currentIndex())
        else:
            super().keyPressEvent(event)
