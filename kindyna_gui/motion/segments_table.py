"""The table of segments on the screen: editors in the cells, and keys."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetrics, QKeyEvent, QPainter, QPen, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractItemDelegate,
    QAbstractItemView,
    QHeaderView,
    QStyle,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from kindyna_gui.documents.session import Session
from kindyna_gui.forms.cell_editor import CellDelegate, CellTable
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.motion.editor import DIRECTIONS
from kindyna_gui.motion.law_picker import LawBox
from kindyna_gui.motion.marks import FIRST, Parts
from kindyna_gui.motion.segments_model import COLUMNS, FROM, JOIN, LAW, SegmentCell, SegmentsModel
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import soon

Index = QModelIndex | QPersistentModelIndex
LEAST_ROWS, MOST_ROWS = 5, 12
GAP = 6  # between the marks of a join, pixels
INSET = 4  # of a text from the sides of its cell, pixels


class SegmentDelegate(CellDelegate):
    """The picker of laws, or a number that steps live, in the cell; a red frame around what was refused.

    Cells are painted from ``SegmentsModel.cell``: a drawn join repaints the whole table at every move of the mouse,
    and the usual delegate reads seven roles of the model per cell.
    """

    def __init__(self, session: Session, model: SegmentsModel, table: QTableView) -> None:
        super().__init__(session, model, table)
        self._model, self._table = model, table

    # -- editors ------------------------------------------------------------------------------------------

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: Index) -> QWidget:
        if index.column() == LAW:
            laws = LawBox()
            laws.setParent(parent)
            laws.activated.connect(lambda _: self._choose(laws))
            laws.cancelled.connect(lambda: self.closeEditor.emit(laws, QAbstractItemDelegate.EndEditHint.NoHint))
            soon(laws, laws.showPopup)
            self.opened(laws, index)
            return laws
        box = NumberBox(COLUMNS[index.column()].info, self._model.unit_of(index.column()), parent)
        box.entered.connect(lambda _: self.commit(box))
        box.unreadable.connect(lambda: self.commit(box))
        box.withdrawn.connect(self._model.withdraw)
        box.finished.connect(self._session.end_gesture)
        self.opened(box, index)
        return box

    def _choose(self, laws: LawBox) -> None:
        self.commit(laws)
        self.closeEditor.emit(laws, QAbstractItemDelegate.EndEditHint.NoHint)

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        if isinstance(editor, LawBox):
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
        """What is in place already is no edit, but takes back what was refused there."""
        if isinstance(editor, LawBox):
            value, changed = editor.currentData(), editor.currentData() != self._model.value(index.row(), LAW)
        elif isinstance(editor, NumberBox):
            value, changed = editor.text(), editor.pending
        else:
            return
        if changed:  # else the parameters of a law would be lost
            model.setData(index, value)
        elif self._model.refused(index.row(), index.column()):
            self._model.withdraw()

    def updateEditorGeometry(self, editor: QWidget, option: QStyleOptionViewItem, index: Index) -> None:
        """Wide enough for its contents, even where the column is not; never outside of the table."""
        room = self._table.viewport().rect()
        box = QRect(option.rect)
        box.setWidth(min(max(box.width(), editor.sizeHint().width()), room.width()))
        if index.column() != LAW:
            box.moveRight(option.rect.right())
        box.moveLeft(max(0, min(box.left(), room.right() - box.width())))
        editor.setGeometry(box)

    # -- painting -----------------------------------------------------------------------------------------

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        row, column = index.row(), index.column()
        cell, box = self._model.cell(row, column), option.rect
        current = self._table.currentIndex()
        chosen = row == current.row() and column == current.column()
        active = bool(option.state & QStyle.StateFlag.State_Active) and self._table.hasFocus()
        if chosen:
            painter.fillRect(box, QColor(SCREEN.chosen if active else SCREEN.idle))
        elif row == current.row():
            painter.fillRect(box, QColor(SCREEN.chosen_row))
        inner = box.adjusted(INSET, 0, -INSET, 0)
        if cell.variants:
            self._paint_marks(painter, inner, cell.variants, chosen and active)
        else:
            self._paint_text(painter, inner, cell, chosen and active)
        if cell.refused:
            painter.save()
            painter.setPen(QPen(QColor(SCREEN.limit), 1.6))
            painter.drawRect(box.adjusted(1, 1, -2, -2))
            painter.restore()

    def _paint_text(self, painter: QPainter, box: QRect, cell: SegmentCell, light: bool) -> None:
        painter.setPen(QColor(SCREEN.paper if light else cell.colour or SCREEN.ink))
        painter.setFont(self._font(cell.italic))
        side = Qt.AlignmentFlag.AlignRight if cell.right else Qt.AlignmentFlag.AlignLeft
        text, metrics = cell.text, painter.fontMetrics()
        if metrics.horizontalAdvance(text) > box.width():
            text = metrics.elidedText(cell.short or text, Qt.TextElideMode.ElideRight, box.width())
        painter.drawText(box, side | Qt.AlignmentFlag.AlignVCenter, text)

    def _paint_marks(self, painter: QPainter, box: QRect, variants: tuple[Parts, ...], light: bool) -> None:
        """Paint the longest variant that fits."""
        painter.setFont(self._font(False))
        metrics = painter.fontMetrics()
        row = next((parts for parts in variants if parts_width(parts, metrics) <= box.width()), variants[-1])
        x = box.left()
        for text, colour in row:
            painter.setPen(QColor(SCREEN.paper if light else colour))
            painter.drawText(
                QRect(x, box.top(), box.right() - x + 1, box.height()), Qt.AlignmentFlag.AlignVCenter, text
            )
            x += metrics.horizontalAdvance(text) + GAP

    def _font(self, italic: bool) -> QFont:
        font = QFont(self._table.font())
        font.setItalic(italic)
        return font


def parts_width(parts: Parts, metrics: QFontMetrics) -> int:
    """Pixels that the marks of a join take, the gaps between them included."""
    return sum(metrics.horizontalAdvance(text) for text, _ in parts) + GAP * (len(parts) - 1)


class SegmentsTable(CellTable):
    """The table; keys: Enter or F2 edits, Insert and Delete add and take segments, Alt and the arrows move the join at
    the end of the chosen segment, Escape drops what was refused.

    nudge_requested   (direction in angle and level, finely): Alt and an arrow
    dropped   Escape, and nothing had been refused
    """

    nudge_requested = Signal(tuple, bool)
    dropped = Signal()

    def __init__(self, session: Session, model: SegmentsModel) -> None:
        super().__init__()
        self.setModel(model)
        self._model = model
        self._widths: list[int] = []
        self._lengths: tuple[int | str, ...] = ()
        self.setItemDelegate(SegmentDelegate(session, model, self))
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
            | QAbstractItemView.EditTrigger.AnyKeyPressed
        )
        self.setAccessibleName("Segments of the motion")
        self.setTabKeyNavigation(False)  # arrows go from cell to cell, Tab on to what comes next
        self.setShowGrid(False)
        self.setAlternatingRowColors(True)
        self.setWordWrap(False)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        rows = self.verticalHeader()
        rows.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        rows.setDefaultAlignment(Qt.AlignmentFlag.AlignCenter)
        rows.setHighlightSections(False)
        head = self.horizontalHeader()
        head.setHighlightSections(False)
        head.setMinimumSectionSize(30)
        head.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        head.setSectionResizeMode(LAW, QHeaderView.ResizeMode.Stretch)
        model.modelReset.connect(self.fit_columns)
        model.dataChanged.connect(self.fit_columns)
        self.redress()

    def redress(self) -> None:
        """As high and wide as its letters want it."""
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.verticalHeader().setFixedWidth(self.fontMetrics().horizontalAdvance("99") + 6)
        self._lengths = ()
        self.fit_columns()

    # -- widths -------------------------------------------------------------------------------------------

    def fit_columns(self, *_: object) -> None:
        """Columns as wide as their texts; done here, for a header that does it itself lays all of them out anew at
        every change. In a narrow table the names of the laws come before the joins, in a wide one both share the rest."""
        rows, room = range(self._model.rowCount()), self.viewport().width()
        cells = [self._model.cell(row, column) for row in rows for column in range(len(COLUMNS))]
        lengths = (room, *(len(cell.text) if cell.right or cell.variants else cell.text for cell in cells))
        if lengths == self._lengths:  # texts as long as before, as mostly while a join is drawn
            return
        self._lengths = lengths
        metrics = self.fontMetrics()
        widths = [self._wanted(column, metrics, FIRST) for column in range(len(COLUMNS))]
        room -= sum(widths[FROM:JOIN])
        laws = [self._model.cell(row, LAW) for row in rows]
        least = max((metrics.horizontalAdvance(cell.short or cell.text) for cell in laws), default=0) + 2 * INSET
        if room - widths[JOIN] < least:
            widths[JOIN] = max(room - least, self._wanted(JOIN, metrics, -1))
        widths[JOIN] += max((room - widths[JOIN] - widths[LAW]) * 2 // 3, 0)
        if widths != self._widths:
            self._widths = widths
            for column, width in enumerate(widths):
                if column != LAW:
                    self.setColumnWidth(column, width)

    def _wanted(self, column: int, metrics: QFontMetrics, variant: int) -> int:
        """The width of a column; variant: which of the variants of the marks of joins."""
        head = self._model.headerData(column, Qt.Orientation.Horizontal)
        wanted = metrics.horizontalAdvance(str(head))
        for row in range(self._model.rowCount()):
            cell = self._model.cell(row, column)
            width = (
                parts_width(cell.variants[variant], metrics) if cell.variants else metrics.horizontalAdvance(cell.text)
            )
            wanted = max(wanted, width)
        return wanted + 2 * INSET + 1

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.fit_columns()

    def height_of(self, rows: int) -> int:
        """Pixels for the head and so many rows."""
        return self.horizontalHeader().sizeHint().height() + rows * self.verticalHeader().defaultSectionSize() + 4

    def sizeHint(self) -> QSize:
        """All rows, where they are not too many: what is left is the diagram's."""
        return QSize(360, self.height_of(min(self._model.rowCount(), MOST_ROWS)))

    def minimumSizeHint(self) -> QSize:
        return QSize(200, self.height_of(min(self._model.rowCount(), LEAST_ROWS)))

    # -- keys ---------------------------------------------------------------------------------------------

    def currentChanged(self, current: Index, previous: Index) -> None:
        super().currentChanged(current, previous)
        self.viewport().update()  # the whole row of the chosen segment is tinted

    def _drop(self) -> None:
        if not self._model.withdraw():
            self.dropped.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        held = event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
        fine = bool(held & Qt.KeyboardModifier.ShiftModifier)
        if self.state() == QAbstractItemView.State.EditingState:
            super().keyPressEvent(event)
        elif event.key() in DIRECTIONS and held & ~Qt.KeyboardModifier.ShiftModifier == _ALT:
            self.nudge_requested.emit(DIRECTIONS[event.key()], fine)
        elif event.key() == Qt.Key.Key_Escape:
            self._drop()
        else:
            super().keyPressEvent(event)


_ALT = Qt.KeyboardModifier.AltModifier

__all__ = ["SegmentDelegate", "SegmentsTable", "parts_width"]
