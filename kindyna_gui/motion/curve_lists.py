"""Lists of a curve: points, obstacles and cycles, as tables whose cells edit the design."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import Field as DataField
from dataclasses import fields, replace
from functools import cached_property
from math import degrees
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QModelIndex, QObject, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QHBoxLayout, QHeaderView, QStyleOptionViewItem, QTabBar, QToolButton, QVBoxLayout, QWidget

from core.design import (
    NO_UNIT,
    UNITS,
    CurveBound,
    Design,
    Info,
    Motion,
    SplinePoint,
    Unit,
    get,
    info_of,
    put,
    require_motion,
)
from core.design.rules import MOST_CYCLES
from core.frozen import frozen
from core.motion.split import add_bound, add_point
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import waiting_paths
from kindyna_gui.forms.number_box import NumberBox, parsed
from kindyna_gui.forms.tables import CellDelegate, CellModel, CellTable
from kindyna_gui.labels import name_of, no_number, sentence, value_text
from kindyna_gui.look import described, icon
from kindyna_gui.motion.diagram import snap_angle
from kindyna_gui.motion.segments_table import readable
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, fill, widget_with
from kindyna_gui.settings import symbol_of

if TYPE_CHECKING:
    from kindyna_gui.forms.refusal import FloatingRefusal, Remedies

PER_DEGREE = {"value": "", "velocity": "/°", "acceleration": "/°²", "jerk": "/°³"}
STEP_AT_0 = {"at_deg": 1.0, "value": 1.0, "velocity": 0.1, "acceleration": 0.01, "jerk": 0.001}
"""Step of an entry whose value is 0."""

Index = QModelIndex | QPersistentModelIndex
TITLES = ("At", "Value", "v", "a")
HELP = (
    "angle from the start of the segment",
    "level above the start of the segment",
    "velocity at the point; empty = left open",
    "acceleration at the point; empty = left open",
)


# -- numbers of a curve ------------------------------------------------------------------------------------


def motion_unit(name: str, motion: Motion) -> Unit:
    """Unit of an entry of a curve; a velocity is in the motion's unit per degree."""
    if name == "at_deg":
        return UNITS["deg"]
    return Unit(UNITS[motion.unit].symbol + PER_DEGREE[name], 1.0) if name in PER_DEGREE else NO_UNIT


def entry_info(field: DataField[Any]) -> Info:
    """Label, range and help of an entry, with a step for the value 0."""
    info = info_of(field)
    assert info is not None
    return replace(info, step=info.step or STEP_AT_0.get(field.name, 0.0))


class OptionalBox(NumberBox):
    """Box for a number that may be left open by an empty text.

    ``emptied`` is emitted when an empty text is confirmed.
    """

    emptied = Signal()

    def __init__(self, info: Info, unit: Unit = NO_UNIT, parent: QWidget | None = None, hint: str = "free") -> None:
        self._is_open = False
        super().__init__(info, unit, parent)
        self.lineEdit().setPlaceholderText(hint)

    def show_value(self, value: float | None) -> None:
        self._is_open = value is None
        super().show_value(0.0 if value is None else value)
        if value is None:
            self._tried = ""
            self.lineEdit().clear()

    @property
    def pending(self) -> bool:
        return bool(self.text()) if self._is_open else super().pending

    def confirm(self) -> None:
        if self.text().strip():
            super().confirm()
        elif self._is_open:
            self.show_value(None)
        else:
            self._tried = self.text()
            self.emptied.emit()

    def withdraw(self) -> None:
        if self._is_open:
            self.show_value(None)
            self.withdrawn.emit()
        else:
            super().withdraw()


def name_in_sentence(design: Design, path: str) -> str:
    """Name of an entry within a sentence."""
    name = name_of(design, path)
    return f"{name[:1].lower()}{name[1:]}"


# -- lists ---------------------------------------------------------------------------------------------------

Column = tuple[str, Info, Unit]
"""Key of a number in its row, empty where the row is the number; label with range and help; unit."""


@frozen
class CurveList:
    """A list of a curve.

    Attributes
    ----------
    key : of the curve
    noun : name of a row
    tab : title of its tab
    titles, helps : heading and tip of each column
    columns : function of the motion
    add : function that adds a row to a segment at a cam angle [deg]
    tip : of the button that adds a row
    """

    key: str
    noun: str
    tab: str
    titles: tuple[str, ...]
    helps: tuple[str, ...]
    columns: Callable[[Motion], list[Column]]
    add: Callable[[Design, int, float], Design]
    tip: str


def _columns(kind: Any) -> Callable[[Motion], list[Column]]:
    def columns(motion: Motion) -> list[Column]:
        units = {f.name: motion_unit(f.name, motion) if kind is SplinePoint else NO_UNIT for f in fields(kind)}
        return [(f.name, entry_info(f), units[f.name]) for f in fields(kind)]

    return columns


def _add_cycles(design: Design, index: int, angle: float) -> Design:
    path = f"motion.segments[{index}].vibration_free"
    return put(design, path, (*get(design, path), NEW_CYCLES))


NEW_CYCLES = 2.0
SETTINGS = "Settings"  # tab of the fields
_CYCLES = Info("Cycles", "natural periods of a follower in the span", 0.0, MOST_CYCLES, open_low=True, step=0.1)
_BOUND_HELPS = ("start of the obstacle, as a fraction of the span", "end of the obstacle, as a fraction of the span")
POINTS = CurveList(
    "points", "point", "Points", TITLES, HELP, _columns(SplinePoint), add_point,
    "Add a point on the curve at the current cam angle (Ins)",
)  # fmt: skip
OPTIMAL_LISTS = (
    POINTS,
    CurveList(
        "below", "obstacle", "Below", ("From", "To", "Most"), (*_BOUND_HELPS, "most of the rise there, as a fraction"),
        _columns(CurveBound), lambda design, index, angle: add_bound(design, index, "below", angle),
        "Add an obstacle that the law passes below, up to the current cam angle (Ins)",
    ),
    CurveList(
        "above", "obstacle", "Above", ("From", "To", "Least"), (*_BOUND_HELPS, "least of the rise there, as a fraction"),
        _columns(CurveBound), lambda design, index, angle: add_bound(design, index, "above", angle),
        "Add an obstacle that the law passes above, from the current cam angle on (Ins)",
    ),
    CurveList(
        "vibration_free", "follower", "Vibration-free", ("Cycles",), (_CYCLES.help,), lambda motion: [("", _CYCLES, NO_UNIT)],
        _add_cycles, "Add an undamped follower that is at rest after the segment: its cycles in the span (Ins)",
    ),
)  # fmt: skip
"""Lists of an optimal law."""


class ListModel(CellModel):
    """Table model of a list of the curve of a segment."""

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(session, parent)
        self.segment, self.list = 0, POINTS
        self._rows: tuple[Any, ...] = ()
        self.columns = POINTS.columns(require_motion(session.typed))

    def show(self, design: Design, segment: int, shown: CurveList) -> None:
        """Show a list of a segment."""
        motion = require_motion(design)
        rows = getattr(motion.segments[segment].curve, shown.key, ())
        self.columns = shown.columns(motion)
        if (segment, shown, len(rows)) != (self.segment, self.list, len(self._rows)):
            self.beginResetModel()
            self.segment, self.list, self._rows = segment, shown, rows
            self._wrong.clear()
            self.endResetModel()
        elif (rows, waiting_paths(self._session)) != (self._rows, self._faulty):
            self._rows = rows
            self._all_changed()
        self._faulty = waiting_paths(self._session)

    @property
    def list_path(self) -> str:
        """Path of the list."""
        return f"motion.segments[{self.segment}].{self.list.key}"

    def path(self, row: int, column: int) -> str:
        key = self.columns[column][0]
        return f"{self.list_path}[{row}].{key}" if key else f"{self.list_path}[{row}]"

    def value(self, row: int, column: int) -> float | None:
        """Value of a cell; None if it is left open."""
        key = self.columns[column][0]
        number: float | None = getattr(self._rows[row], key) if key else self._rows[row]
        return number

    def is_faulty(self, row: int, column: int) -> bool:
        """Whether the value of a cell contradicts others."""
        path = self.path(row, column)
        return not self._faulty.isdisjoint((path, f"{self.list_path}[{row}]", self.list_path))

    def info_of(self, column: int) -> Info:
        return self.columns[column][1]

    def unit_of(self, column: int) -> Unit:
        return self.columns[column][2]

    def edits(self, path: str) -> bool:
        return path.startswith(f"{self.list_path}[") and bool(self._rows)

    # -- interface of the Qt model -----------------------------------------------------------------------

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self._rows)

    def columnCount(self, parent: Index | None = None) -> int:
        return len(self.columns)

    def flags(self, index: Index) -> Qt.ItemFlag:
        return Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEditable

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Vertical:
            return str(section + 1) if role == Qt.ItemDataRole.DisplayRole else None
        if role == Qt.ItemDataRole.DisplayRole:
            return f"{self.list.titles[section]} {symbol_of(self.columns[section][2].symbol)}".rstrip()
        if role == Qt.ItemDataRole.ToolTipRole:
            return sentence(self.list.helps[section])
        right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        return right if role == Qt.ItemDataRole.TextAlignmentRole else None

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        row, column = index.row(), index.column()
        wrong = self._wrong[self.path(row, column)] if self.is_refused(row, column) else None
        value = self.value(row, column)
        if role == Qt.ItemDataRole.DisplayRole:
            return wrong if wrong is not None else "" if value is None else readable(value, self.columns[column][2])
        if role == Qt.ItemDataRole.EditRole:
            return wrong if wrong is not None else value
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        if role == Qt.ItemDataRole.ForegroundRole and (wrong is not None or self.is_faulty(row, column)):
            return QColor(SCREEN.limit)
        return sentence(self.list.helps[column]) if role == Qt.ItemDataRole.ToolTipRole else None

    # -- edits -------------------------------------------------------------------------------------------

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Enter a text; an empty one leaves the entry open."""
        row, column = index.row(), index.column()
        path, unit = self.path(row, column), self.columns[column][2]
        name = name_in_sentence(self._session.typed, path)
        self._try(row, column, str(value))
        if not str(value).strip() and self.columns[column][1].optional:
            return self._session.edit(path, None, f"Leave {name} open")
        number = parsed(str(value), unit)
        if number is None:
            self._session.refuse(path, no_number(str(value)))
            return False
        return self._session.edit(path, number, f"Change {name} to {value_text(number, unit)}")


class _Delegate(CellDelegate):
    """Editor of a cell: a number, which may be left open."""

    _model: ListModel

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: Index) -> QWidget:
        _, info, unit = self._model.columns[index.column()]
        box = OptionalBox(info, unit, parent) if info.optional else NumberBox(info, unit, parent)
        box.setMinimumWidth(1)
        if isinstance(box, OptionalBox):
            box.emptied.connect(lambda: self.commit(box))
        return self.open_box(box, index)

    def setModelData(self, editor: QWidget, model: Any, index: Index) -> None:
        if isinstance(editor, NumberBox) and editor.pending:
            model.setData(index, editor.text())


class ListsTable(QWidget):
    """Table of a list of a curve with its two buttons; with several lists below tabs, of which the first has the settings."""

    def __init__(
        self, session: Session, player: Player, lists: Sequence[CurveList] = (POINTS,), settings: QWidget | None = None
    ) -> None:
        super().__init__()
        self._session, self._player, self._lists, self._settings = session, player, lists, settings
        self.model = ListModel(session, self)
        self.table = CellTable(self.model)
        self.table.setItemDelegate(_Delegate(session, self.model, self.table))
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.table.horizontalHeader().setHighlightSections(False)
        self.table.setMinimumHeight(3 * (self.fontMetrics().height() + 6) + 6)
        self.model.error_changed.connect(self._show_refusal)
        self.table.insert_requested.connect(lambda: self.add())
        self.table.delete_requested.connect(self.remove)
        self.add_button = self._button("add", "Add", "", self.add)
        self.remove_button = self._button("close", "Remove", "", self.remove)
        self.tabs = QTabBar(drawBase=False, expanding=False)
        self.tabs.setAccessibleName("Lists of the law")
        for title in (*([] if settings is None else [SETTINGS]), *(shown.tab for shown in lists)):
            self.tabs.addTab(title)
        self.tabs.currentChanged.connect(self._choose_tab)
        buttons = fill(QVBoxLayout(), self.add_button, self.remove_button, STRETCH, spacing=1)
        self._rows = widget_with(fill(QHBoxLayout(), (self.table, 1), buttons, margins=0, spacing=4))
        pages = [self._rows] if settings is None else [(settings, 1), (self._rows, 1)]
        fill(QVBoxLayout(self), self.tabs, *pages, margins=0, spacing=0)
        self.tabs.setVisible(settings is not None)  # in its place: alone it would be a window
        self._show_page()

    @cached_property
    def refusal(self) -> FloatingRefusal:
        """The refusal of a number, created with the first one."""
        from kindyna_gui.forms.refusal import FloatingRefusal  # imported here to save start-up time

        return FloatingRefusal(self.table)

    def _show_refusal(self, text: str, remedies: Remedies) -> None:
        if text or "refusal" in vars(self):
            self.refusal.show_refusal(text, remedies)

    def _button(self, name: str, text: str, tip: str, slot: Any) -> QToolButton:
        button = described(QToolButton(autoRaise=True), tip=tip)
        button.setIcon(icon(name))
        button.setText(text)
        button.clicked.connect(lambda: slot())
        return button

    @property
    def list(self) -> CurveList:
        """The list that is shown."""
        return self._lists[max(self.tabs.currentIndex() - self._first, 0)]

    @property
    def _first(self) -> int:
        """Number of the tab of the first list."""
        return int(self._settings is not None)

    def choose(self, key: str) -> bool:
        """Show the list of a key; False where there is none."""
        keys = [shown.key for shown in self._lists]
        if key in keys:
            self.tabs.setCurrentIndex(keys.index(key) + self._first)
        return key in keys

    def choose_settings(self) -> None:
        """Show the settings, where they have a tab."""
        self.tabs.setCurrentIndex(0)

    def _choose_tab(self) -> None:
        self._show_page()
        self.show_segment(self._session.typed, self.model.segment)

    def _show_page(self) -> None:
        """Show the settings, or a list with its buttons and their names."""
        if self._settings is not None:
            self._settings.setVisible(self.tabs.currentIndex() <= 0)
            self._rows.setVisible(self.tabs.currentIndex() > 0)
        noun = self.list.noun
        described(self.add_button, tip=self.list.tip)
        described(self.remove_button, tip=f"Remove the selected {noun} (Del)")
        self.add_button.setText(noun.capitalize())
        self.table.setAccessibleName(self.list.tab)

    def show_segment(self, design: Design, segment: int) -> None:
        """Show the lists of a segment."""
        self.model.show(design, segment, self.list)
        curve = require_motion(design).segments[segment].curve
        for i, shown in enumerate(self._lists):
            count = len(getattr(curve, shown.key, ()))
            self.tabs.setTabText(i + self._first, f"{shown.tab} ({count})" if count else shown.tab)
        self.remove_button.setEnabled(self.model.rowCount() > 0)
        if self.model.rowCount() and not self.table.currentIndex().isValid():
            self.table.setCurrentIndex(self.model.index(0, min(1, self.model.columnCount() - 1)))

    def add(self, at: float | None = None) -> None:
        """Add a row at a cam angle [deg], by default the current one, or where there is room for it."""
        design, segment = self._session.typed, self.model.segment
        angle = snap_angle(degrees(self._player.theta)) if at is None else at
        self._session.end_gesture()
        self._session.lay_out(self.list.add(design, segment, angle), f"Add {self.list.noun} to segment {segment + 1}")

    def remove(self) -> None:
        """Remove the selected row."""
        row, design = self.table.currentIndex().row(), self._session.typed
        rows = get(design, self.model.list_path)
        if row < 0 or row >= len(rows):
            return
        changed = put(design, self.model.list_path, (*rows[:row], *rows[row + 1 :]))
        self._session.end_gesture()
        self._session.lay_out(changed, f"Remove {self.list.noun} {row + 1} of segment {self.model.segment + 1}")
