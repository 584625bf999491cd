"""Tables with cells that are edited: their keys, and delegates whose editors commit on their own, at every step of a number."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QAbstractItemModel, QEvent, QModelIndex, QObject, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QAbstractItemView, QStyledItemDelegate, QTableView, QWidget

from kindyna_gui.documents.session import Session
from kindyna_gui.forms.copying import copied
from kindyna_gui.rebuilt import soon

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


__all__ = ["CellDelegate", "CellTable"]
