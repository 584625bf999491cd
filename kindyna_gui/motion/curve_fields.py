"""Form of the curve of a segment: settings of its law, ends of a polynomial, points of a spline."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import Field as DataField
from dataclasses import fields, replace
from functools import cached_property, partial
from math import degrees
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QModelIndex, QObject, QPersistentModelIndex, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QStyleOptionViewItem,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import (
    NO_UNIT,
    UNITS,
    ComputedCurve,
    Design,
    Info,
    Motion,
    NamedCurve,
    OptimalCurve,
    PolynomialCurve,
    PolynomialEnd,
    SccaCurve,
    SplineCurve,
    SplinePoint,
    TableCurve,
    Unit,
    entries,
    get,
    info_of,
    put,
    require_motion,
)
from core.laws import find_law, peaks
from core.motion.split import add_point
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import waiting_paths
from kindyna_gui.forms.fields import Field, FieldSpec
from kindyna_gui.forms.number_box import NumberBox, parsed, row_height
from kindyna_gui.forms.tables import CellDelegate, CellModel, CellTable
from kindyna_gui.labels import law_label, name_of, no_number, segment_of, sentence, value_text
from kindyna_gui.look import coloured, described, icon
from kindyna_gui.motion.diagram import snap_angle
from kindyna_gui.motion.segments_table import readable
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, ContentArea, connect_all, fill

if TYPE_CHECKING:
    from kindyna_gui.forms.refusal import FloatingRefusal, Remedies
    from kindyna_gui.motion.optimal_form import ListLine
from kindyna_gui.settings import symbol_of

PER_DEGREE = {"value": "", "velocity": "/°", "acceleration": "/°²", "jerk": "/°³"}
STEP_AT_0 = {"at_deg": 1.0, "value": 1.0, "velocity": 0.1, "acceleration": 0.01, "jerk": 0.001}
"""Step of an entry whose value is 0."""
CURVE_KEYS = ("crossover", "cv_fraction", "ramp_fraction", "flat_fraction")
END_KEYS = ("start", "end")
Index = QModelIndex | QPersistentModelIndex
TITLES = ("At", "Value", "v", "a")
HELP = (
    "angle from the start of the segment",
    "level above the start of the segment",
    "velocity at the point; empty = left open",
    "acceleration at the point; empty = left open",
)

# -- fields ----------------------------------------------------------------------------------------------


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


def end_specs(motion: Motion, path: str) -> Iterator[FieldSpec]:
    """Yield the fields of one end of a polynomial; path such as ``motion.segments[1].start``."""
    for field in fields(PolynomialEnd):
        field_path = f"{path}.{field.name}"
        unit = motion_unit(field.name, motion)
        yield FieldSpec(field_path, entry_info(field), unit, partial(get, path=field_path), can_be_assumed=False)


def point_columns(motion: Motion) -> list[tuple[str, Info, Unit]]:
    """Name, label with range and help, and unit of each entry of a point of a spline."""
    return [(field.name, entry_info(field), motion_unit(field.name, motion)) for field in fields(SplinePoint)]


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


class CurveField(Field):
    """Field of a curve, whose undo steps name the segment."""

    def _step(self, value: Any) -> str:
        name = name_in_sentence(self.session.typed, self.spec.path)
        return f"Change {name} to {value_text(value, self.spec.unit)}"


class EndField(CurveField):
    """Field of an end of a polynomial; a jerk may be left open."""

    hint = "free"

    def _number_box(self) -> NumberBox:
        if not self.spec.info.optional:
            return super()._number_box()
        box = OptionalBox(self.spec.info, self.spec.unit, hint=self.hint)
        connect_all(
            (box.entered, self._enter),
            (box.emptied, self._leave_open),
            (
                box.unreadable,
                lambda: self.session.refuse(
                    self.spec.path, "not a number; enter a number, or nothing to leave it open"
                ),
            ),
            (box.withdrawn, lambda: self.session.clear_refusal(self.spec.path)),
            (box.finished, self.session.end_gesture),
            (self.label.dragged, box.stepBy),
            (self.label.released, self._label_released),
        )
        return box

    def _leave_open(self) -> None:
        self.edit(None, f"Leave {name_in_sentence(self.session.typed, self.spec.path)} open")


class LimitField(EndField):
    """Field of a limit, which may be left out; where no law keeps it, a button takes the least one."""

    hint = "none"

    def _show_refusals(self) -> None:
        super()._show_refusals()
        if self._misfit and not self._refusals and not self.is_obsolete:
            from kindyna_gui.motion.optimal_form import refusal_of_limit  # imported here to save start-up time

            self.message.show_refusal(*refusal_of_limit(self.session, self.session.typed, self.spec.path))


def name_in_sentence(design: Design, path: str) -> str:
    """Name of an entry within a sentence."""
    name = name_of(design, path)
    return f"{name[:1].lower()}{name[1:]}"


# -- points of a spline ----------------------------------------------------------------------------------


class PointsModel(CellModel):
    """Table model of the points of a segment."""

    def __init__(self, session: Session, parent: QObject | None = None) -> None:
        super().__init__(session, parent)
        self.segment = 0
        self._points: tuple[SplinePoint, ...] = ()
        self.columns = point_columns(require_motion(session.typed))

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
            self._all_changed()
        self._faulty = waiting_paths(self._session)

    def path(self, row: int, column: int) -> str:
        return f"motion.segments[{self.segment}].points[{row}].{self.columns[column][0]}"

    def value(self, row: int, column: int) -> float | None:
        """Value of a cell; None if it is left open."""
        number: float | None = getattr(self._points[row], self.columns[column][0])
        return number

    def is_faulty(self, row: int, column: int) -> bool:
        """Whether the value of a cell contradicts others."""
        path = self.path(row, column)
        return path in self._faulty or path.rpartition(".")[0] in self._faulty

    def info_of(self, column: int) -> Info:
        return self.columns[column][1]

    def unit_of(self, column: int) -> Unit:
        return self.columns[column][2]

    def edits(self, path: str) -> bool:
        return path.startswith(f"motion.segments[{self.segment}].points[") and bool(self._points)

    # -- interface of the Qt model -----------------------------------------------------------------------

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
        return sentence(HELP[column]) if role == Qt.ItemDataRole.ToolTipRole else None

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

    _model: PointsModel

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


class PointsTable(QWidget):
    """Table of the points with its two buttons."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__()
        self._session, self._player = session, player
        self.model = PointsModel(session, self)
        self.table = CellTable(self.model)
        self.table.setItemDelegate(_Delegate(session, self.model, self.table))
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.table.horizontalHeader().setHighlightSections(False)
        self.table.setMinimumHeight(3 * (self.fontMetrics().height() + 6) + 6)
        self.model.error_changed.connect(self._show_refusal)
        self.table.insert_requested.connect(self.add)
        self.table.delete_requested.connect(self.remove)
        self.add_button = self._button(
            "add", "Point", "Add a point on the curve at the current cam angle (Ins)", self.add
        )
        self.remove_button = self._button("close", "Remove", "Remove the selected point (Del)", self.remove)
        buttons = fill(QVBoxLayout(), self.add_button, self.remove_button, STRETCH, spacing=1)
        fill(QHBoxLayout(self), (self.table, 1), buttons, margins=0, spacing=4)

    @cached_property
    def refusal(self) -> FloatingRefusal:
        """The refusal of a point, created with the first one."""
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

    def show_segment(self, design: Design, segment: int) -> None:
        """Show the points of a segment."""
        self.model.show(design, segment)
        self.remove_button.setEnabled(self.model.rowCount() > 0)
        if self.model.rowCount() and not self.table.currentIndex().isValid():
            self.table.setCurrentIndex(self.model.index(0, 1))

    def add(self) -> None:
        """Add a point at the current cam angle, or in the longest gap if that angle is outside the segment."""
        design, segment = self._session.typed, self.model.segment
        angle = snap_angle(degrees(self._player.theta))
        self._session.end_gesture()
        self._session.lay_out(add_point(design, segment, angle), f"Add point to segment {segment + 1}")

    def remove(self) -> None:
        """Remove the selected point."""
        row, design = self.table.currentIndex().row(), self._session.typed
        curve = require_motion(design).segments[self.model.segment].curve
        if row < 0 or not isinstance(curve, SplineCurve):
            return
        points = (*curve.points[:row], *curve.points[row + 1 :])
        changed = put(design, f"motion.segments[{self.model.segment}].points", points)
        self._session.end_gesture()
        self._session.lay_out(changed, f"Remove point {row + 1} of segment {self.model.segment + 1}")


# -- form of a curve -------------------------------------------------------------------------------------


def has_crossover(motion: Motion, index: int) -> bool:
    """Whether the crossover from acceleration to deceleration can be set."""
    curve = motion.segments[index].curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    return law is not None and law.is_symmetric and peaks(law).ca > 0.0


def keys_of_form(motion: Motion, index: int) -> tuple[str, ...]:
    """Keys of the curve that have a field; of a named curve only those that its law has."""
    curve = motion.segments[index].curve
    law = find_law(curve.law) if isinstance(curve, NamedCurve) else None
    if law is None:
        return CURVE_KEYS
    return (
        *(("crossover",) if has_crossover(motion, index) else ()),
        *(("flat_fraction",) if law.flat is not None else ()),
    )


def kind_of_form(motion: Motion, index: int) -> type | None:
    """Class of the curve whose form is shown; None if the curve has no settings."""
    curve = motion.segments[index].curve
    return None if isinstance(curve, NamedCurve) and not keys_of_form(motion, index) else type(curve)


class SegmentCurveForm(QWidget):
    """Form of the curve of a segment; built again only for another kind of curve or another segment."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__()
        self._session, self._player = session, player
        self._shown: tuple[int, type | str, tuple[str, ...]] = (-1, "", ())
        self.fields: dict[str, Field] = {}
        self.points: PointsTable | None = None
        self.lists: list[ListLine] = []
        self._form_area = ContentArea(session, player)
        self._column = fill(QVBoxLayout(self), self._form_area, margins=(10, 3, 6, 0), spacing=2)
        self.update_style()

    def update_style(self) -> None:
        """Keep room for at least one row, so that selecting a segment moves nothing."""
        self.setMinimumHeight(row_height(self) + 5)

    def show_segment(self, design: Design, index: int) -> None:
        """Show the curve of a segment."""
        motion = require_motion(design)
        kind = kind_of_form(motion, index)
        shown = (index, kind or motion.segments[index].curve.law, keys_of_form(motion, index))
        if shown != self._shown:
            self._shown = shown
            self._build(design, index, kind)
        for field in self.fields.values():
            field.refresh(design)
        for line in self.lists:
            line.show_design(design)
        if self.points is not None:
            self.points.show_segment(design, index)

    def _build(self, design: Design, index: int, kind: type | None) -> None:
        self._paper = QWidget()
        self.fields, self.points, self.lists = {}, None, []
        if kind is None:
            self._add_sentence(f"{law_label(require_motion(design).segments[index].curve.law)}: no further settings")
        else:
            FORMS[kind](self, design, index)
        self._form_area.replace(self._paper)

    def _add_sentence(self, text: str) -> None:
        label = coloured(QLabel(text, wordWrap=True), SCREEN.quiet)
        self._grid().addWidget(label, 0, 0)

    # -- forms of the kinds of curves --------------------------------------------------------------------

    def _rows(self, design: Design, index: int, keys: tuple[str, ...] = ()) -> QGridLayout:
        """Add a row for each key: crossover, or widths."""
        grid, keys = self._grid(), keys or keys_of_form(require_motion(design), index)
        for entry in entries(design, "motion"):
            if segment_of(entry.path) == index and entry.path.rpartition(".")[2] in keys:
                field = self._register(CurveField(self._session, FieldSpec.of(entry)))
                field.add_to(grid, 2 * len(self.fields))
        grid.setColumnStretch(1, 1)
        return grid

    def _ends(self, design: Design, index: int) -> None:
        """Add a row for each end: velocity, acceleration and jerk, with units in the headings."""
        grid, motion = self._grid(), require_motion(design)
        for row, end in enumerate(END_KEYS, 1):
            name = QLabel(f"{end.capitalize()} ")
            grid.addWidget(name, 2 * row, 0)
            for column, spec in enumerate(end_specs(motion, f"motion.segments[{index}].{end}"), 1):
                field = self._register(EndField(self._session, spec))
                field.editor.setMinimumWidth(1)
                field.editor.setAccessibleName(f"{end.capitalize()}, {spec.info.label.lower()}")
                if row == 1:
                    heading = coloured(QLabel(f"{spec.info.label} {symbol_of(spec.unit.symbol)}"), SCREEN.quiet)
                    grid.addWidget(heading, 0, column, Qt.AlignmentFlag.AlignRight)
                    grid.setColumnStretch(column, 1)
                for unused in (field.label, field.unit):
                    if unused is not None:
                        unused.setParent(self._paper)
                        unused.hide()
                grid.addWidget(field.editor, 2 * row, column)

    def _points(self, design: Design, index: int) -> None:
        """Add the table of points of a spline."""
        self._add_points(self._grid())

    def _table(self, design: Design, index: int) -> None:
        """Add the conditions at the ends of a table, and its rows."""
        self._add_points(self._rows(design, index, END_KEYS))

    def _optimal(self, design: Design, index: int) -> None:
        """Add aim, ends, limits and obstacles of an optimal law, and its points."""
        from kindyna_gui.motion.optimal_form import add_rows, scrolled_grid  # imported here to save start-up time

        grid = scrolled_grid(self._paper)
        self.lists = add_rows(
            self._session, design, index, grid, lambda spec: self._register(LimitField(self._session, spec))
        )
        self._add_points(grid)

    def _add_points(self, grid: QGridLayout) -> None:
        self.points = PointsTable(self._session, self._player)
        grid.addWidget(self.points, grid.rowCount(), 0, 1, -1)

    def _computed(self, design: Design, index: int) -> None:
        """Add a sentence that says what the curve follows from."""
        motion = require_motion(design)
        self._add_sentence(
            "This curve follows from the lobe: change its lift, durations or ramp, or choose Lobe to segments"
            if motion.lobe is not None
            else "This curve follows from other files"
            if motion.follows is not None
            else "This curve follows from the torque of the drives: change the drives, or the spring of the balance cam"
        )

    def _grid(self) -> QGridLayout:
        grid = fill(QGridLayout(self._paper), margins=0, spacing=(6, 2))
        return grid

    def _register(self, field: Field) -> Field:
        field.setParent(self._paper)  # deleted together
        self.fields[field.spec.path] = field
        return field

    # -- focus -------------------------------------------------------------------------------------------

    def focus_field(self, path: str) -> bool:
        """Show and focus the field of a path; False if the form does not have it."""
        field = self.fields.get(path)
        if field is not None:
            field.focus()
            return True
        line = next((line for line in self.lists if path.startswith(line.path)), None)
        if line is not None:
            line.setFocus(Qt.FocusReason.OtherFocusReason)
            return True
        if self.points is not None and ".points" in path:
            self.points.table.setFocus(Qt.FocusReason.OtherFocusReason)
            return True
        return False


FORMS: Mapping[type, Callable[[SegmentCurveForm, Design, int], object]] = MappingProxyType(
    {
        NamedCurve: SegmentCurveForm._rows,
        SccaCurve: SegmentCurveForm._rows,
        PolynomialCurve: SegmentCurveForm._ends,
        SplineCurve: SegmentCurveForm._points,
        TableCurve: SegmentCurveForm._table,
        OptimalCurve: SegmentCurveForm._optimal,
        ComputedCurve: SegmentCurveForm._computed,
    }
)
"""Class of a curve -> function that lays out its form."""
