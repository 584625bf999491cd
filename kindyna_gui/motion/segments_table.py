"""Segments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from decimal import Decimal
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, QRect, QSize, Qt, Signal
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

from core.design import (
    NO_UNIT,
    UNITS,
    Design,
    Info,
    Motion,
    Segment,
    Unit,
    info_of,
    join_angles,
    motion_of,
    require_motion,
)
from core.design.edits import balance
from core.frozen import frozen
from core.laws import EVERY_LAW, find_law, named_law
from core.motion import Join
from core.output.lines import shortest
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox, parsed
from kindyna_gui.forms.tables import CellDelegate, CellTable
from kindyna_gui.labels import law_label, no_number, sentence, value_text
from kindyna_gui.motion.diagram import FIRST, Parts, join_help, join_text, marks, variants
from kindyna_gui.motion.editor import DIRECTIONS
from kindyna_gui.motion.law_picker import LawBox, law_tip
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import call_soon
from kindyna_gui.settings import DISPLAY, number_text, point, size_of, symbol_of

# -- segments model --------------------------------------------------------------------------------------

Index = QModelIndex | QPersistentModelIndex
LAW, FROM, TO, SPAN, RISE, JOIN = range(6)
_SEGMENT: Mapping[str, Info] = MappingProxyType({f.name: i for f in fields(Segment) if (i := info_of(f))})
LONGEST = 7  # characters of a number that are all shown
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
_SHOWN = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
_EDITED = _SHOWN | Qt.ItemFlag.ItemIsEditable
STILL = Motion(0.0, (Segment(360.0, 0.0),))
"""What stands in the place of a motion where a kind of design has none."""


@frozen
class SegmentColumn:
    """One row of the table of columns: heading, what it means, and the key of the file that it edits."""

    title: str
    help: str
    key: str
    info: Info


COLUMNS = (
    SegmentColumn("Law", "motion law of the segment", "law", Info("Law", choices=tuple(EVERY_LAW))),
    SegmentColumn(
        "From", "cam angle where the segment begins; moves the end of the one before", "", _SEGMENT["span_deg"]
    ),
    SegmentColumn(
        "To", "cam angle where the segment ends; the next one takes the difference", "", _SEGMENT["span_deg"]
    ),
    SegmentColumn(
        "Span", "cam angle the segment takes; the next one takes the difference", "span_deg", _SEGMENT["span_deg"]
    ),
    SegmentColumn(
        "Rise", "end minus start; the next segment that moves brings the follower back", "rise", _SEGMENT["rise"]
    ),
    SegmentColumn("Join", "what is continuous at the end of the segment, and how far the rest jumps", "", Info("")),
)


def difference(to: float, start: float) -> float:
    """to - start, as a reader would compute it: 76.5 - 35 is 41.5 and nothing else."""
    return float(Decimal(shortest(to)) - Decimal(shortest(start)))


def readable(value: float, unit: Unit = NO_UNIT) -> str:
    """A number for a narrow column, as it is shown: all its digits where they are few, else those that matter."""
    text = number_text(value, unit)
    return (
        text if len(text) <= LONGEST else shortest(float(f"{value / size_of(unit.symbol):.5g}")).replace(".", point())
    )


def _ends(motion: Motion) -> tuple[float, ...]:
    """The cam angle where each segment begins, and where the last one ends [deg]."""
    begins = join_angles(motion)
    return (*begins, balance(begins[-1], (-motion.segments[-1].span_deg,)))


@frozen
class SegmentCell:
    """A cell as it is painted: its text, with a short one for narrow columns; of a join the variants of its marks, the
    longest first."""

    text: str
    colour: str | None
    right: bool
    short: str = ""
    italic: bool = False
    refused: bool = False
    variants: tuple[Parts, ...] = ()


class SegmentsModel(QAbstractTableModel):
    """The segments in order. What is typed is an edit of the session; what it refuses stays in its cell, in red.

    error_changed (str): what is wrong with the last edit, empty when nothing is
    """

    error_changed = Signal(str)

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session = session
        self._motion, self._assumed = motion_of(session.typed) or STILL, session.typed.assumed
        self._angles = _ends(self._motion)
        self._joins: tuple[Join, ...] = ()
        self._faulty: frozenset[str] = frozenset()  # paths of what does not fit together
        self._shown = False
        self._wrong: dict[str, str] = {}  # path -> the text that was refused
        self._cells: dict[tuple[int, int], SegmentCell] = {}
        self._trying = ""
        session.refused.connect(self._refused)
        session.accepted.connect(self._accepted)
        session.restored.connect(self.withdraw)
        DISPLAY.changed.connect(self._told)

    def _told(self) -> None:
        """Other units: heads and cells say so."""
        self._all_changed()
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, self.columnCount() - 1)

    # -- from the session ---------------------------------------------------------------------------------

    def show(self, design: Design, joins: tuple[Join, ...], faulty: frozenset[str] = frozenset()) -> None:
        """Show the motion of a design, its joins where it is whole enough to have any, and mark what is amiss at these
        paths; where another part of the design has changed there is nothing to do."""
        motion, assumed = require_motion(design), design.assumed
        if self._shown and (motion, assumed, faulty) == (self._motion, self._assumed, self._faulty):
            return
        same = self._shown and len(motion.segments) == len(self._motion.segments)
        if not same:
            self.beginResetModel()
        self._cells.clear()
        self._motion, self._assumed, self._joins, self._faulty = motion, assumed, joins, faulty
        self._angles, self._shown = _ends(motion), True
        if same:
            self._all_changed()
        else:
            self._wrong.clear()
            self.endResetModel()
            self.error_changed.emit("")

    def _all_changed(self) -> None:
        self._cells.clear()
        last = self.index(self.rowCount() - 1, self.columnCount() - 1)
        self.dataChanged.emit(self.index(0, 0), last)

    def _refused(self, refusal: Refusal) -> None:
        rows = range(self.rowCount())
        if any(refusal.path == self.path(row, column) for row in rows for column in (LAW, SPAN, RISE)):
            self._wrong = {refusal.path: self._trying}
            self.error_changed.emit(refusal.at(refusal.path))
            self._all_changed()

    def _accepted(self, path: str) -> None:
        if path in self._wrong:
            self.withdraw()

    def withdraw(self) -> bool:
        """Forget what was refused; False where nothing was."""
        if not self._wrong:
            return False
        wrong, self._wrong = self._wrong, {}
        self.error_changed.emit("")
        self._all_changed()
        for path in wrong:
            self._session.clear_refusal(path)
        return True

    # -- the table ----------------------------------------------------------------------------------------

    @property
    def unit(self) -> Unit:
        """Of the motion."""
        return UNITS[self._motion.unit]

    def unit_of(self, column: int) -> Unit:
        """The unit that a column is counted in."""
        return self.unit if column == RISE else UNITS["deg"]

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self._motion.segments)

    def columnCount(self, parent: Index | None = None) -> int:
        return len(COLUMNS)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Vertical:
            return str(section + 1) if role == Qt.ItemDataRole.DisplayRole else None
        column = COLUMNS[section]
        if role == Qt.ItemDataRole.DisplayRole:
            unit = f" {symbol_of(self.unit_of(section).symbol)}" if section in (FROM, TO, SPAN, RISE) else ""
            return column.title + unit
        if role == Qt.ItemDataRole.ToolTipRole:
            return sentence(column.help)
        return (_LEFT if section in (LAW, JOIN) else _RIGHT) if role == Qt.ItemDataRole.TextAlignmentRole else None

    def flags(self, index: Index) -> Qt.ItemFlag:
        row, column = index.row(), index.column()
        return _SHOWN if self.fixed(row, column) else _EDITED

    def fixed(self, row: int, column: int) -> bool:
        """Whether a cell cannot be edited: it follows from others, or has a single possible value."""
        return (
            column == JOIN
            or (column == FROM and row == 0)
            or (column == TO and row == self.rowCount() - 1)
            or (column == RISE and self.is_dwell(row))
        )

    def is_dwell(self, row: int) -> bool:
        """Whether the follower rests in the segment of this row."""
        law = find_law(self._motion.segments[row].curve.law)
        return law is not None and law.is_dwell

    def path(self, row: int, column: int) -> str:
        """What a cell edits; empty where it edits nothing."""
        if column in (FROM, TO):
            row, column = (row - 1 if column == FROM else row), SPAN
        key = COLUMNS[column].key
        key = f"{key}_{self._motion.unit}" if column == RISE else key
        return f"motion.segments[{row}].{key}" if key and row >= 0 else ""

    def value(self, row: int, column: int) -> Any:
        """What the design has there: slug, number, or text."""
        segment = self._motion.segments[row]
        if column == JOIN:
            return join_text(self._joins[row], self._motion) if self._joins else ""
        if column in (FROM, TO):
            return self._angles[row if column == FROM else row + 1]
        return segment.curve.law if column == LAW else segment.span_deg if column == SPAN else segment.rise

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if not index.isValid():
            return None
        row, column = index.row(), index.column()
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return _LEFT if column in (LAW, JOIN) else _RIGHT
        if role == Qt.ItemDataRole.EditRole:
            wrong = self._wrong.get(self.path(row, column)) if self.refused(row, column) else None
            return self.value(row, column) if wrong is None else wrong
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._tip(row, column)
        cell = self.cell(row, column)
        if role == Qt.ItemDataRole.DisplayRole:
            return cell.text
        if role == Qt.ItemDataRole.ForegroundRole:
            return None if cell.colour is None else QColor(cell.colour)
        if role == Qt.ItemDataRole.FontRole and cell.italic:
            font = QFont()
            font.setItalic(True)
            return font
        return None

    def cell(self, row: int, column: int) -> SegmentCell:
        """A cell as it is painted; made once for each state of the motion, for a table is painted often."""
        cell = self._cells.get((row, column))
        if cell is None:
            cell = self._cells[row, column] = self._make_cell(row, column)
        return cell

    def _make_cell(self, row: int, column: int) -> SegmentCell:
        refused, assumed = self.refused(row, column), self.assumed(row, column)
        value = self._wrong[self.path(row, column)] if refused else self.value(row, column)
        if column == JOIN:
            rows = variants(marks(self._joins[row], self._motion)) if self._joins else ()
            return SegmentCell(value, SCREEN.quiet, False, variants=rows)
        text = (
            law_label(value)
            if column == LAW
            else readable(value, self.unit_of(column))
            if isinstance(value, float)
            else value
        )
        refused = refused or self.faulty(row, column)
        colour = (
            SCREEN.limit
            if refused
            else SCREEN.assumed
            if assumed
            else SCREEN.quiet
            if self.fixed(row, column)
            else None
        )
        return SegmentCell(
            text, colour, column != LAW, named_law(value).short_label if column == LAW else "", assumed, refused
        )

    def _tip(self, row: int, column: int) -> str:
        if column == JOIN:
            return join_help(self._joins[row], self._motion) if self._joins else ""
        text = law_tip(self.value(row, LAW)) if column == LAW else COLUMNS[column].help
        mark = "\nAssumed, not taken from a source" if self.assumed(row, column) else ""
        return sentence(text) + mark

    def assumed(self, row: int, column: int) -> bool:
        """Whether the value of a cell is marked as a guess."""
        return column in (LAW, SPAN, RISE) and self.path(row, column) in self._assumed

    def refused(self, row: int, column: int) -> bool:
        """What stands in the cell is not in the design."""
        return column not in (FROM, TO) and self.path(row, column) in self._wrong

    def faulty(self, row: int, column: int) -> bool:
        """What stands in the cell does not fit to the rest."""
        return column not in (FROM, TO, JOIN) and self.path(row, column) in self._faulty

    # -- to the session -----------------------------------------------------------------------------------

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Enter a slug, or a text that should be a number; False where the session refuses it."""
        row, column = index.row(), index.column()
        path = self.path(row, column)
        self._trying = str(value)
        if column == LAW:
            return self._session.edit(path, value, f"Change law of segment {row + 1} to {law_label(value)}")
        number = parsed(str(value), self.unit_of(column))
        if number is None:
            self._session.refuse(path, no_number(str(value)))
            return False
        if column in (FROM, TO):
            return self._move_join(row if column == FROM else row + 1, path, number)
        name = COLUMNS[column].title.lower()
        text = f"Change {name} of segment {row + 1} to {value_text(number, self.unit_of(column))}"
        return self._session.edit(path, number, text)

    def _move_join(self, row: int, path: str, angle: float) -> bool:
        """Put the start of a segment at a cam angle [deg]."""
        low, high = self.value(row - 1, FROM), self.value(row, TO)
        span = difference(angle, low)
        self._trying = shortest(span)
        if not low < angle < high:
            end, *ends = (value_text(each, UNITS["deg"]) for each in (angle, low, high))
            self._session.refuse(
                path, f"an end at {end} lies beyond a neighbour; allowed: above {ends[0]} ... below {ends[1]}"
            )
            return False
        return self._session.edit(path, span, f"Move start of segment {row + 1} to {value_text(angle, UNITS['deg'])}")


# -- the table of segments on the screen: editors in the cells, and keys ---------------------------------

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
            call_soon(laws, laws.showPopup)
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
        self.update_style()

    def update_style(self) -> None:
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
