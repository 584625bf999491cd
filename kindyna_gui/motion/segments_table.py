"""Table of the segments of a motion: model, cells and keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from decimal import Decimal
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QModelIndex, QObject, QPersistentModelIndex, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetrics, QKeyEvent, QPainter, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractItemDelegate,
    QAbstractItemView,
    QHeaderView,
    QStyle,
    QStyleOptionViewItem,
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
from core.number_text import shortest
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox, parsed
from kindyna_gui.forms.tables import CellDelegate, CellModel, CellTable, draw_refused
from kindyna_gui.labels import law_label, no_number, sentence, value_text
from kindyna_gui.motion.diagram import FIRST_FAULT, Parts, join_help, join_marks, join_text, mark_variants
from kindyna_gui.motion.editor import DIRECTIONS
from kindyna_gui.motion.law_picker import LawBox, law_tip
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import call_soon
from kindyna_gui.settings import number_text, point, size_of, symbol_of

Index = QModelIndex | QPersistentModelIndex
LAW, FROM, TO, SPAN, RISE, JOIN = range(6)
SEGMENT_INFO: Mapping[str, Info] = MappingProxyType({f.name: i for f in fields(Segment) if (i := info_of(f))})
LONGEST = 7  # characters of a number that is not rounded
RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
READ_ONLY = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
EDITABLE = READ_ONLY | Qt.ItemFlag.ItemIsEditable
NO_MOTION = Motion(0.0, (Segment(360.0, 0.0),))
"""Shown for a design without a motion."""
LEAST_ROWS, MOST_ROWS = 5, 12
GAP = 6  # between the marks of a join, pixels
INSET = 4  # between a text and the sides of its cell, pixels
ALT = Qt.KeyboardModifier.AltModifier

# -- model -----------------------------------------------------------------------------------------------


@frozen
class SegmentColumn:
    """Column of the table: heading, tip, and the key of the file that it edits."""

    title: str
    help: str
    key: str
    info: Info


COLUMNS = (
    SegmentColumn("Law", "motion law of the segment", "law", Info("Law", choices=tuple(EVERY_LAW))),
    SegmentColumn(
        "From",
        "cam angle where the segment starts; moves the end of the previous segment",
        "",
        SEGMENT_INFO["span_deg"],
    ),
    SegmentColumn(
        "To", "cam angle where the segment ends; the next segment takes the difference", "", SEGMENT_INFO["span_deg"]
    ),
    SegmentColumn(
        "Span",
        "duration of the segment in cam angle; the next segment takes the difference",
        "span_deg",
        SEGMENT_INFO["span_deg"],
    ),
    SegmentColumn(
        "Rise", "end minus start; the next segment that moves brings the follower back", "rise", SEGMENT_INFO["rise"]
    ),
    SegmentColumn(
        "Join", "quantities that are continuous at the end of the segment, and the jumps of the others", "", Info("")
    ),
)


def difference(to: float, start: float) -> float:
    """Difference of two numbers in decimals: 76.5 - 35 is exactly 41.5."""
    return float(Decimal(shortest(to)) - Decimal(shortest(start)))


def readable(value: float, unit: Unit = NO_UNIT) -> str:
    """Number for a narrow column: all digits if they are few, else rounded."""
    text = number_text(value, unit)
    return (
        text if len(text) <= LONGEST else shortest(float(f"{value / size_of(unit.symbol):.5g}")).replace(".", point())
    )


def _ends(motion: Motion) -> tuple[float, ...]:
    """Cam angles [deg] where each segment starts, and where the last one ends."""
    begins = join_angles(motion)
    return (*begins, balance(begins[-1], (-motion.segments[-1].span_deg,)))


@frozen
class SegmentCell:
    """Contents of a cell.

    Attributes
    ----------
    short : text for a narrow column
    variants : texts of the marks of a join, the longest first
    """

    text: str
    colour: str | None
    right: bool
    short: str = ""
    italic: bool = False
    refused: bool = False
    variants: tuple[Parts, ...] = ()


class SegmentsModel(CellModel):
    """Table model of the segments; refused texts are red."""

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(session, parent)
        self._motion, self._assumed = motion_of(session.typed) or NO_MOTION, session.typed.assumed
        self._angles = _ends(self._motion)
        self._joins: tuple[Join, ...] = ()
        self._shown = False
        self._cells: dict[tuple[int, int], SegmentCell] = {}

    # -- design ------------------------------------------------------------------------------------------

    def show(self, design: Design, joins: tuple[Join, ...], faulty: frozenset[str] = frozenset()) -> None:
        """Show the motion of a design, its joins (none for an incomplete motion), and mark the values at faulty paths.

        Does nothing if only another part of the design has changed.
        """
        motion, assumed = require_motion(design), design.assumed
        if self._shown and (motion, assumed, faulty) == (self._motion, self._assumed, self._faulty):
            return
        same_rows = self._shown and len(motion.segments) == len(self._motion.segments)
        if not same_rows:
            self.beginResetModel()
        self._cells.clear()
        self._motion, self._assumed, self._joins, self._faulty = motion, assumed, joins, faulty
        self._angles, self._shown = _ends(motion), True
        if same_rows:
            self._all_changed()
        else:
            self._wrong.clear()
            self.endResetModel()
            self.error_changed.emit("", {})

    def _all_changed(self) -> None:
        self._cells.clear()
        super()._all_changed()

    def edits(self, path: str) -> bool:
        rows = range(self.rowCount())
        return any(path == self.path(row, column) for row in rows for column in (LAW, SPAN, RISE))

    # -- interface of the Qt model -----------------------------------------------------------------------

    @property
    def unit(self) -> Unit:
        """Unit of the motion."""
        return UNITS[self._motion.unit]

    def info_of(self, column: int) -> Info:
        return COLUMNS[column].info

    def nearest(self, row: int, column: int, number: float | None) -> float | None:
        """The nearest rise; a span at an end of its range leaves no room for its neighbours."""
        return super().nearest(row, column, number) if column == RISE else None

    def unit_of(self, column: int) -> Unit:
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
        return (LEFT if section in (LAW, JOIN) else RIGHT) if role == Qt.ItemDataRole.TextAlignmentRole else None

    def flags(self, index: Index) -> Qt.ItemFlag:
        row, column = index.row(), index.column()
        return READ_ONLY if self.is_fixed(row, column) else EDITABLE

    def is_fixed(self, row: int, column: int) -> bool:
        """Whether a cell cannot be edited, since it follows from others or has a single possible value."""
        return (
            column == JOIN
            or (column == FROM and row == 0)
            or (column == TO and row == self.rowCount() - 1)
            or (column == RISE and self.is_dwell(row))
        )

    def is_dwell(self, row: int) -> bool:
        """Whether the segment of this row is a dwell."""
        law = find_law(self._motion.segments[row].curve.law)
        return law is not None and law.is_dwell

    def path(self, row: int, column: int) -> str:
        if column in (FROM, TO):
            row, column = (row - 1 if column == FROM else row), SPAN
        key = COLUMNS[column].key
        key = f"{key}_{self._motion.unit}" if column == RISE else key
        return f"motion.segments[{row}].{key}" if key and row >= 0 else ""

    def value(self, row: int, column: int) -> Any:
        """Value of a cell in the design: slug, number, or text."""
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
            return LEFT if column in (LAW, JOIN) else RIGHT
        if role == Qt.ItemDataRole.EditRole:
            wrong = self._wrong.get(self.path(row, column)) if self.is_refused(row, column) else None
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
        """Contents of a cell, cached until the motion changes, since a table is painted often."""
        cell = self._cells.get((row, column))
        if cell is None:
            cell = self._cells[row, column] = self._make_cell(row, column)
        return cell

    def _make_cell(self, row: int, column: int) -> SegmentCell:
        refused, assumed = self.is_refused(row, column), self.is_assumed(row, column)
        value = self._wrong[self.path(row, column)] if refused else self.value(row, column)
        if column == JOIN:
            texts = mark_variants(join_marks(self._joins[row], self._motion)) if self._joins else ()
            return SegmentCell(value, SCREEN.quiet, False, variants=texts)
        text = (
            law_label(value)
            if column == LAW
            else readable(value, self.unit_of(column))
            if isinstance(value, float)
            else value
        )
        refused = refused or self.is_faulty(row, column)
        colour = (
            SCREEN.limit
            if refused
            else SCREEN.assumed
            if assumed
            else SCREEN.quiet
            if self.is_fixed(row, column)
            else None
        )
        return SegmentCell(
            text, colour, column != LAW, named_law(value).short_label if column == LAW else "", assumed, refused
        )

    def _tip(self, row: int, column: int) -> str:
        if column == JOIN:
            return join_help(self._joins[row], self._motion) if self._joins else ""
        text = law_tip(self.value(row, LAW)) if column == LAW else COLUMNS[column].help
        mark = "\nAssumed, not taken from a source" if self.is_assumed(row, column) else ""
        return sentence(text) + mark

    def is_assumed(self, row: int, column: int) -> bool:
        """Whether the value of a cell is marked as assumed."""
        return column in (LAW, SPAN, RISE) and self.path(row, column) in self._assumed

    def is_faulty(self, row: int, column: int) -> bool:
        """Whether the value of a cell contradicts others."""
        return column not in (FROM, TO, JOIN) and self.path(row, column) in self._faulty

    # -- edits -------------------------------------------------------------------------------------------

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Enter a law or the text of a number; False if the session refuses it."""
        row, column = index.row(), index.column()
        path = self.path(row, column)
        self._try(row, column, str(value))
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
        """Move the start of a segment to a cam angle [deg]."""
        low, high = self.value(row - 1, FROM), self.value(row, TO)
        span = difference(angle, low)
        if not low < angle < high:
            end, above, below = (value_text(value, UNITS["deg"]) for value in (angle, low, high))
            self._session.refuse(
                path, f"{end} is outside the neighbouring segments; allowed: above {above} ... below {below}"
            )
            return False
        return self._session.edit(path, span, f"Move start of segment {row + 1} to {value_text(angle, UNITS['deg'])}")


# -- cells -----------------------------------------------------------------------------------------------


class SegmentDelegate(CellDelegate):
    """Editors and painting of the cells: law picker, number box, red frame around a refused text.

    Cells are painted from ``SegmentsModel.cell``, since a dragged join repaints the table at every move of the mouse and
    Qt's delegate reads seven roles of the model per cell.
    """

    _model: SegmentsModel

    # -- editors -----------------------------------------------------------------------------------------

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
        return self.open_box(box, index)

    def _choose(self, laws: LawBox) -> None:
        self.commit(laws)
        self.closeEditor.emit(laws, QAbstractItemDelegate.EndEditHint.NoHint)

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        if isinstance(editor, LawBox):
            editor.setCurrentIndex(editor.findData(self._model.value(index.row(), LAW)))
        else:
            super().setEditorData(editor, index)

    def setModelData(self, editor: QWidget, model: Any, index: Index) -> None:
        """Enter a changed value; the unchanged one only discards a refused text."""
        if isinstance(editor, LawBox):
            value, changed = editor.currentData(), editor.currentData() != self._model.value(index.row(), LAW)
        elif isinstance(editor, NumberBox):
            value, changed = editor.text(), editor.pending
        else:
            return
        if changed:  # the same law again would reset its settings
            model.setData(index, value)
        elif self._model.is_refused(index.row(), index.column()):
            self._model.withdraw()

    def updateEditorGeometry(self, editor: QWidget, option: QStyleOptionViewItem, index: Index) -> None:
        """Make the editor wide enough for its contents, within the table."""
        room = self._table.viewport().rect()
        box = QRect(option.rect)
        box.setWidth(min(max(box.width(), editor.sizeHint().width()), room.width()))
        if index.column() != LAW:
            box.moveRight(option.rect.right())
        box.moveLeft(max(0, min(box.left(), room.right() - box.width())))
        editor.setGeometry(box)

    # -- painting ----------------------------------------------------------------------------------------

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
            draw_refused(painter, box)

    def _paint_text(self, painter: QPainter, box: QRect, cell: SegmentCell, light: bool) -> None:
        painter.setPen(QColor(SCREEN.paper if light else cell.colour or SCREEN.ink))
        painter.setFont(self._font(cell.italic))
        side = Qt.AlignmentFlag.AlignRight if cell.right else Qt.AlignmentFlag.AlignLeft
        text, metrics = cell.text, painter.fontMetrics()
        if metrics.horizontalAdvance(text) > box.width():
            text = metrics.elidedText(cell.short or text, Qt.TextElideMode.ElideRight, box.width())
        painter.drawText(box, side | Qt.AlignmentFlag.AlignVCenter, text)

    def _paint_marks(self, painter: QPainter, box: QRect, variants: tuple[Parts, ...], light: bool) -> None:
        """Paint the longest variant for which there is room."""
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
    """Width of the marks of a join with the gaps between them [pixels]."""
    return sum(metrics.horizontalAdvance(text) for text, _ in parts) + GAP * (len(parts) - 1)


# -- table -----------------------------------------------------------------------------------------------


class SegmentsTable(CellTable):
    """Table of the segments.

    Enter or F2 edits a cell, Insert and Delete add and remove segments, Alt and the arrow keys move the join at the end of
    the selected segment, Escape discards a refused text. Signals: ``nudge_requested`` (direction in angle and level, fine)
    at Alt and an arrow key; ``dropped`` at Escape without a refused text.
    """

    nudge_requested = Signal(tuple, bool)
    dropped = Signal()

    def __init__(self, session: Session, model: SegmentsModel) -> None:
        super().__init__(model)
        self._model = model
        self._widths: list[int] = []
        self._lengths: tuple[int | str, ...] = ()
        self.setItemDelegate(SegmentDelegate(session, model, self))
        self.setAccessibleName("Segments of the motion")
        self.setTabKeyNavigation(False)  # arrow keys move between cells, Tab leaves the table
        self.setWordWrap(False)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        rows = self.verticalHeader()
        rows.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        rows.setDefaultAlignment(Qt.AlignmentFlag.AlignCenter)
        rows.setHighlightSections(False)
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setMinimumSectionSize(30)
        header.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        header.setSectionResizeMode(LAW, QHeaderView.ResizeMode.Stretch)
        model.modelReset.connect(self.fit_columns)
        model.dataChanged.connect(self.fit_columns)
        self.update_style()

    def update_style(self) -> None:
        """Fit rows and columns to the font size."""
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.verticalHeader().setFixedWidth(self.fontMetrics().horizontalAdvance("99") + 6)
        self._lengths = ()
        self.fit_columns()

    # -- widths ------------------------------------------------------------------------------------------

    def fit_columns(self, *_: object) -> None:
        """Fit the widths of the columns to their texts, without Qt's own layout of the header at every change.

        In a narrow table the names of the laws get their width before the joins; in a wide one both share the rest.
        """
        rows, room = range(self._model.rowCount()), self.viewport().width()
        cells = [self._model.cell(row, column) for row in rows for column in range(len(COLUMNS))]
        lengths = (room, *(len(cell.text) if cell.right or cell.variants else cell.text for cell in cells))
        if lengths == self._lengths:  # as usual while a join is dragged
            return
        self._lengths = lengths
        metrics = self.fontMetrics()
        widths = [self._needed_width(column, metrics, FIRST_FAULT) for column in range(len(COLUMNS))]
        room -= sum(widths[FROM:JOIN])
        laws = [self._model.cell(row, LAW) for row in rows]
        least = max((metrics.horizontalAdvance(cell.short or cell.text) for cell in laws), default=0) + 2 * INSET
        if room - widths[JOIN] < least:
            widths[JOIN] = max(room - least, self._needed_width(JOIN, metrics, -1))
        widths[JOIN] += max((room - widths[JOIN] - widths[LAW]) * 2 // 3, 0)
        if widths != self._widths:
            self._widths = widths
            for column, width in enumerate(widths):
                if column != LAW:
                    self.setColumnWidth(column, width)

    def _needed_width(self, column: int, metrics: QFontMetrics, variant: int) -> int:
        """Return the width of a column with this variant of the marks of joins [pixels]."""
        needed = metrics.horizontalAdvance(str(self._model.headerData(column, Qt.Orientation.Horizontal)))
        for row in range(self._model.rowCount()):
            cell = self._model.cell(row, column)
            width = (
                parts_width(cell.variants[variant], metrics) if cell.variants else metrics.horizontalAdvance(cell.text)
            )
            needed = max(needed, width)
        return needed + 2 * INSET + 1

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.fit_columns()

    def height_of(self, rows: int) -> int:
        """Height of the heading and a number of rows [pixels]."""
        return self.horizontalHeader().sizeHint().height() + rows * self.verticalHeader().defaultSectionSize() + 4

    def sizeHint(self) -> QSize:
        """Size for all rows up to ``MOST_ROWS``; the diagram gets the rest."""
        return QSize(360, self.height_of(min(self._model.rowCount(), MOST_ROWS)))

    def minimumSizeHint(self) -> QSize:
        return QSize(200, self.height_of(min(self._model.rowCount(), LEAST_ROWS)))

    # -- keys --------------------------------------------------------------------------------------------

    def currentChanged(self, current: Index, previous: Index) -> None:
        super().currentChanged(current, previous)
        self.viewport().update()  # the row of the selected segment is tinted

    def keyPressEvent(self, event: QKeyEvent) -> None:
        modifiers = event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
        fine = bool(modifiers & Qt.KeyboardModifier.ShiftModifier)
        if self.state() == QAbstractItemView.State.EditingState:
            super().keyPressEvent(event)
        elif event.key() in DIRECTIONS and modifiers & ~Qt.KeyboardModifier.ShiftModifier == ALT:
            self.nudge_requested.emit(DIRECTIONS[event.key()], fine)
        elif event.key() == Qt.Key.Key_Escape:
            if not self._model.withdraw():
                self.dropped.emit()
        else:
            super().keyPressEvent(event)
