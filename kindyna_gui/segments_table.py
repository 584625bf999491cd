"""The table of segments on the screen: editors in the cells, and keys."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen
from PySide6.QtWidgets import (
    QAbstractItemDelegate,
    QAbstractItemView,
    QHeaderView,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from core.laws import LAWS
from kindyna_gui.look import WRONG
from kindyna_gui.number_box import NumberBox, WordBox
from kindyna_gui.segments_model import COLUMNS, LAW, SegmentsModel
from kindyna_gui.session import Session

Index = QModelIndex | QPersistentModelIndex


class CellDelegate(QStyledItemDelegate):
    """A list of laws, or a number that steps live, in the cell; a red frame around what was refused."""

    def __init__(self, session: Session, model: SegmentsModel, table: QTableView) -> None:
        super().__init__(table)
        self._session, self._model, self._table = session, model, table
        self.closeEditor.connect(lambda *_: session.end_gesture())

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: Index) -> QWidget:
        if index.column() == LAW:
            words = WordBox()
            words.setParent(parent)
            for slug, law in LAWS.items():
                words.addItem(law.label, slug)
            words.activated.connect(lambda _: self._choose(words))
            QTimer.singleShot(0, words, words.showPopup)
            return words
        box = NumberBox(COLUMNS[index.column()].info, self._model.unit_of(index.column()), parent)
        box.entered.connect(lambda _: self.commitData.emit(box))
        box.unreadable.connect(lambda: self.commitData.emit(box))
        box.withdrawn.connect(self._model.withdraw)
        box.finished.connect(self._session.end_gesture)
        return box

    def _choose(self, words: WordBox) -> None:
        self.commitData.emit(words)
        self.closeEditor.emit(words, QAbstractItemDelegate.EndEditHint.NoHint)

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        if isinstance(editor, WordBox):
            editor.setCurrentIndex(editor.findData(self._model.value(index.row(), LAW)))
        elif isinstance(editor, NumberBox):
            wrong = self._model.refused(index.row(), index.column())
            if not (wrong and editor.pending):
                editor.show_value(self._model.value(index.row(), index.column()))
                if wrong:
                    editor.lineEdit().setText(self._model.data(index, Qt.ItemDataRole.EditRole))
                editor.selectAll()
            editor.set_refused(wrong)

    def setModelData(self, editor: QWidget, model: Any, index: Index) -> None:
        if isinstance(editor, WordBox):
            model.setData(index, editor.currentData())
        elif isinstance(editor, NumberBox) and editor.pending:
            model.setData(index, editor.text())

    def updateEditorGeometry(self, editor: QWidget, option: QStyleOptionViewItem, index: Index) -> None:
        """Wide enough for its contents, even where the column is not; never outside of the table."""
        room = self._table.viewport().rect()
        box = QRect(option.rect)
        box.setWidth(min(max(box.width(), editor.sizeHint().width()), room.width()))
        if index.column() != LAW:
            box.moveRight(option.rect.right())
        box.moveLeft(max(0, min(box.left(), room.right() - box.width())))
        editor.setGeometry(box)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        super().paint(painter, option, index)
        if self._model.refused(index.row(), index.column()):
            painter.save()
            painter.setPen(QPen(QColor(WRONG), 1.6))
            painter.drawRect(option.rect.adjusted(1, 1, -2, -2))
            painter.restore()


class SegmentsTable(QTableView):
    """The table; keys: Enter or F2 edits, Insert and Delete add and take segments, Escape drops what was refused.

    insert_wanted, delete_wanted   the key was pressed
    """

    insert_wanted = Signal()
    delete_wanted = Signal()

    def __init__(self, session: Session, model: SegmentsModel) -> None:
        super().__init__()
        self.setModel(model)
        self._model = model
        self.setItemDelegate(CellDelegate(session, model, self))
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
            | QAbstractItemView.EditTrigger.AnyKeyPressed
        )
        self.setShowGrid(False)
        self.setAlternatingRowColors(True)
        self.setWordWrap(False)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 8)
        head = self.horizontalHeader()
        head.setHighlightSections(False)
        head.setMinimumSectionSize(36)
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(LAW, QHeaderView.ResizeMode.Stretch)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        editing = self.state() == QAbstractItemView.State.EditingState
        keys = {
            Qt.Key.Key_Return: lambda: self.edit(self.currentIndex()),
            Qt.Key.Key_Enter: lambda: self.edit(self.currentIndex()),
            Qt.Key.Key_Insert: self.insert_wanted.emit,
            Qt.Key.Key_Delete: self.delete_wanted.emit,
            Qt.Key.Key_Escape: self._model.withdraw,
        }
        action = None if editing else keys.get(Qt.Key(event.key()))
        if action is None:
            super().keyPressEvent(event)
        else:
            action()
