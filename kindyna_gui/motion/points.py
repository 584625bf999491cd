"""The points of a spline as a small table: every cell is an entry of the design; an empty one is left open."""

from __future__ import annotations

from math import degrees
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QStyleOptionViewItem,
    QTableView,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import Design, SplineCurve, SplinePoint, put, require_motion
from core.motion.split import add_point
from kindyna_gui.documents.refusal import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import waiting_paths
from kindyna_gui.forms.cell_editor import CellDelegate, CellTable
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.typed_number import parsed
from kindyna_gui.labels import no_number, sentence, value_text
from kindyna_gui.look import icon
from kindyna_gui.motion.fields import OptionalBox, described, point_columns
from kindyna_gui.motion.grips import snapped_angle
from kindyna_gui.motion.segments_model import readable
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.preferences.units import TOLD, symbol_of

Index = QModelIndex | QPersistentModelIndex
TITLES = ("At", "Value", "v", "a")
HELP = (
    "angle from the start of the segment",
    "level from the start of the segment",
    "velocity there; empty = left to the curve",
    "acceleration there; empty = left to the curve",
)


class PointsModel(QAbstractTableModel):
    """The points of one segment.

    error_changed (str): what is wrong with the last edit, empty when nothing is
    """

    error_changed = Signal(str)

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session = session
        self.segment = 0
        self._points: tuple[SplinePoint, ...] = ()
        self.columns = point_columns(require_motion(session.typed))
        self._wrong: dict[str, str] = {}
        self._faulty: frozenset[str] = frozenset()  # paths of what does not fit together
        self._trying = ""
        session.refused.connect(self._refused)
        session.accepted.connect(self._accepted)
        session.restored.connect(self.withdraw)
        TOLD.changed.connect(self._told)

    def _told(self) -> None:
        """Other units: heads and cells say so."""
        self._changed()
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, len(TITLES) - 1)

    def show(self, design: Design, segment: int) -> None:
        """Show the points of a segment."""
        curve = require_motion(design).segments[segment].curve
        points = curve.points if isinstance(curve, SplineCurve) else ()
        self.columns = point_columns(require_motion(design))
        if (segment, len(points)) != (self.segment, len(self._points)):
            self.beginResetModel()
            self.segment, self._points = segment, points
            self._wrong.clear()
            self.endResetModel()
        elif (points, waiting_paths(self._session)) != (self._points, self._faulty):
            self._points = points
            self._changed()
        self._faulty = waiting_paths(self._session)

    def _changed(self) -> None:
        if self._points:
            self.dataChanged.emit(self.index(0, 0), self.index(len(self._points) - 1, len(TITLES) - 1))

    def path(self, row: int, column: int) -> str:
        return f"motion.segments[{self.segment}].points[{row}].{self.columns[column][0]}"

    def value(self, row: int, column: int) -> float | None:
        number: float | None = getattr(self._points[row], self.columns[column][0])
        return number

    def faulty(self, row: int, column: int) -> bool:
        """What stands in the cell does not fit to the rest."""
        path = self.path(row, column)
        return path in self._faulty or path.rpartition(".")[0] in self._faulty

    def refused(self, row: int, column: int) -> bool:
        """Whether what was typed into a cell cannot be."""
        return self.path(row, column) in self._wrong

    # -- model for Qt ------------------------------------------------------------------------------------

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self._points)

    def columnCount(self, parent: Index | None = None) -> int:
        return len(TITLES)

    def flags(self, index: Index) -> Qt.ItemFlag:
        return Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEditable

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Vertical:
            return str(section + 1) if role == Qt.ItemDataRole.DisplayRole else None
        if role == Qt.ItemDataRole.DisplayRole:
            return f"{TITLES[section]} {symbol_of(self.columns[section][2].symbol)}"
        if role == Qt.ItemDataRole.ToolTipRole:
            return sentence(HELP[section])
        right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        return right if role == Qt.ItemDataRole.TextAlignmentRole else None

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        row, column = index.row(), index.column()
        wrong = self._wrong.get(self.path(row, column))
        value = self.value(row, column)
        if role == Qt.ItemDataRole.DisplayRole:
            return wrong if wrong is not None else "" if value is None else readable(value, self.columns[column][2])
        if role == Qt.ItemDataRole.EditRole:
            return wrong if wrong is not None else value
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        if role == Qt.ItemDataRole.ForegroundRole and (wrong is not None or self.faulty(row, column)):
            return QColor(SCREEN.limit)
        return sentence(HELP[column]) if role == Qt.ItemDataRole.ToolTipRole else None

    # -- to and from the session --------------------------------------------------------------------------

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Enter a text; an empty one leaves the entry open."""
        row, column = index.row(), index.column()
        path, unit = self.path(row, column), self.columns[column][2]
        name = described(self._session.typed, path)
        self._trying = str(value)
        if not str(value).strip() and self.columns[column][1].optional:
            return self._session.edit(path, None, f"Leave {name} free")
        number = parsed(str(value), unit)
        if number is None:
            self._session.refuse(path, no_number(str(value)))
            return False
        return self._session.edit(path, number, f"Change {name} to {value_text(number, unit)}")

    def _refused(self, refusal: Refusal) -> None:
        if refusal.path.startswith(f"motion.segments[{self.segment}].points[") and self._points:
            self._wrong = {refusal.path: self._trying}
            self.error_changed.emit(refusal.at(refusal.path))
            self._changed()

    def _accepted(self, path: str) -> None:
        if path in self._wrong:
            self.withdraw()

    def withdraw(self) -> None:
        """Forget what was refused."""
        if self._wrong:
            self._wrong.clear()
            self.error_changed.emit("")
            self._changed()


class _Delegate(CellDelegate):
    """A number, which may be left open, in the cell."""

    def __init__(self, session: Session, model: PointsModel, table: QTableView) -> None:
        super().__init__(session, model, table)
        self._model = model

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: Index) -> QWidget:
        _, info, unit = self._model.columns[index.column()]
        box = OptionalBox(info, unit, parent) if info.optional else NumberBox(info, unit, parent)
        box.setMinimumWidth(1)
        box.entered.connect(lambda _: self.commit(box))
        box.unreadable.connect(lambda: self.commit(box))
        if isinstance(box, OptionalBox):
            box.emptied.connect(lambda: self.commit(box))
        box.withdrawn.connect(self._model.withdraw)
        box.finished.connect(self._session.end_gesture)
        self.opened(box, index)
        return box

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        assert isinstance(editor, NumberBox)
        wrong = self._model.refused(index.row(), index.column())
        if not (wrong and editor.pending):
            value = self._model.value(index.row(), index.column())
            editor.show_value(value)
            if wrong:
                editor.lineEdit().setText(str(self._model.data(index, Qt.ItemDataRole.EditRole)))
            editor.selectAll()
        editor.set_refused(wrong)

    def setModelData(self, editor: QWidget, model: Any, index: Index) -> None:
        if isinstance(editor, NumberBox) and editor.pending:
            model.setData(index, editor.text())


class PointsTable(QWidget):
    """The table with its two buttons."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__()
        self._session, self._player = session, player
        self.model = PointsModel(session, self)
        self.table = CellTable()
        self.table.setModel(self.model)
        self.table.setItemDelegate(_Delegate(session, self.model, self.table))
        self.table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.table.setShowGrid(False)
        self.table.setAlternatingRowColors(True)
        self.table.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
            | QAbstractItemView.EditTrigger.AnyKeyPressed
        )
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.table.horizontalHeader().setHighlightSections(False)
        self.table.setMinimumHeight(3 * (self.fontMetrics().height() + 6) + 6)
        self.table.insert_requested.connect(self.add)
        self.table.delete_requested.connect(self.remove)
        self.add_button = self._button("add", "Point", "A point where the cam stands, on the curve (Ins)", self.add)
        self.remove_button = self._button("close", "Remove", "Take the chosen point away (Del)", self.remove)
        buttons = QVBoxLayout()
        buttons.setSpacing(1)
        buttons.addWidget(self.add_button)
        buttons.addWidget(self.remove_button)
        buttons.addStretch(1)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.table, 1)
        row.addLayout(buttons)

    def _button(self, name: str, text: str, tip: str, slot: Any) -> QToolButton:
        button = QToolButton(autoRaise=True)
        button.setIcon(icon(name))
        button.setText(text)
        button.setToolTip(tip)
        button.clicked.connect(lambda: slot())
        return button

    def show_segment(self, design: Design, segment: int) -> None:
        """Show the points of a segment."""
        self.model.show(design, segment)
        self.remove_button.setEnabled(self.model.rowCount() > 0)
        if self.model.rowCount() and not self.table.currentIndex().isValid():
            self.table.setCurrentIndex(self.model.index(0, 1))

    def add(self) -> None:
        """A point where the cam stands, else in the longest stretch without one."""
        design, segment = self._session.typed, self.model.segment
        angle = snapped_angle(degrees(self._player.theta))
        self._session.end_gesture()
        self._session.lay_out(add_point(design, segment, angle), f"Add point to segment {segment + 1}")

    def remove(self) -> None:
        """Take the chosen point away."""
        row, design = self.table.currentIndex().row(), self._session.typed
        curve = require_motion(design).segments[self.model.segment].curve
        if row < 0 or not isinstance(curve, SplineCurve):
            return
        points = (*curve.points[:row], *curve.points[row + 1 :])
        changed = put(design, f"motion.segments[{self.model.segment}].points", points)
        self._session.end_gesture()
        self._session.lay_out(changed, f"Remove point {row + 1} of segment {self.model.segment + 1}")


__all__ = ["PointsModel", "PointsTable"]
