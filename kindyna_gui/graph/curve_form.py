"""Forms of the page Curves: axes and title, the selected curve, and the list of curves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from sys import float_info
from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QMenu,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import Info, split_unit
from core.errors import KindynaError
from core.frozen import frozen
from core.output.drawing.palette import FAMILIES
from core.output.graph import (
    ALL,
    DASHES,
    LEAST_WIDTH,
    MARKS,
    MOST_WIDTH,
    SHAFT,
    SIDES,
    ColumnHeading,
    DesignSource,
    Graph,
    GraphAxis,
    GraphCurve,
    Source,
    column_label,
    compatible_units,
)
from core.units import KINDS
from kindyna_gui.forms.load_rows import list_button, taken_by_list
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.forms.refusal import Misfit, RefusalLine, accept_in_range
from kindyna_gui.graph.graph_choice import swatch
from kindyna_gui.look import MessageLabel, bold_label, coloured
from kindyna_gui.pictures.style import DRIVES, SCREEN
from kindyna_gui.pictures.units import typed

AXES = {"x": "Along the bottom", "left": "On the left", "right": "On the right"}
RANGE = Info("Range", "empty: to the ends of the curves", -float_info.max, float_info.max, optional=True)
OPEN = "\0open"
LIST_HEIGHT = 128
EMPTY = "No curve yet: press Add, or drop files here"
_COLOURS = tuple(dict.fromkeys((*DRIVES, *FAMILIES.values())))[:12]
_SIDE_NAMES = {"auto": "by unit", "left": "left", "right": "right"}
Choice = tuple[str, str]
"""A choice of a box: its text and its value."""

# -- axes and title --------------------------------------------------------------------------------------


@frozen
class AxisDefaults:
    """Automatic title and display unit of an axis, with the size of this unit in the curves' unit."""

    title: str = ""
    symbol: str = ""
    size: float = 1.0


class AxesForm(QWidget):
    """Form of the title and the axes. Signal ``changed`` (Graph, str): the new graph, and the field that changed."""

    changed = Signal(object, str)

    def __init__(self) -> None:
        super().__init__()
        self._graph, self._defaults = Graph(), dict.fromkeys(AXES, AxisDefaults())
        self.title = QLineEdit()
        self.title.setAccessibleName("Title of the graph")
        self.title.editingFinished.connect(lambda: self._set_title("", self.title))
        self.titles: dict[str, QLineEdit] = {}
        self.logs: dict[str, QCheckBox] = {}
        self.ends: dict[tuple[str, str], NumberBox] = {}
        self._units: dict[str, QLabel] = {}
        self.message = RefusalLine((0, 0, 0, 0))
        grid = QGridLayout(self)
        grid.setContentsMargins(6, 4, 6, 4)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 1)
        label = QLabel("Title")
        label.setBuddy(self.title)
        grid.addWidget(label, 0, 0)
        grid.addWidget(self.title, 0, 1)
        for number, (axis, text) in enumerate(AXES.items()):
            self._add(grid, 1 + 4 * number, axis, text)
        grid.addWidget(self.message, 13, 0, 1, 2)
        grid.setRowStretch(14, 1)

    def _add(self, grid: QGridLayout, row: int, axis: str, text: str) -> None:
        header, title, log, unit = bold_label(text), QLineEdit(), QCheckBox("Logarithmic"), QLabel()
        title.setAccessibleName(f"Title, {text.lower()}")
        log.setAccessibleName(f"Logarithmic, {text.lower()}")
        coloured(unit, SCREEN.quiet)
        grid.addWidget(header, row, 0, 1, 2)
        label = QLabel("Title")
        label.setBuddy(title)
        grid.addWidget(label, row + 1, 0)
        grid.addWidget(title, row + 1, 1)
        grid.addWidget(QLabel("from"), row + 2, 0)
        line = QHBoxLayout()
        line.setSpacing(4)
        for end, between in (("low", "to"), ("high", "")):
            box = NumberBox(RANGE)
            box.setAccessibleName(f"{'From' if end == 'low' else 'To'}, {text.lower()}")
            box.setToolTip("Empty: to the ends of the curves")
            side = "from" if end == "low" else "to"
            accept_in_range(box, self.message, partial(self._limit, axis, end), f"{text}, {side}")
            line.addWidget(box, 1)
            if between:
                line.addWidget(QLabel(between))
            self.ends[axis, end] = box
        line.addWidget(unit)
        grid.addLayout(line, row + 2, 1)
        grid.addWidget(log, row + 3, 1)
        title.editingFinished.connect(lambda: self._set_title(axis, title))
        log.toggled.connect(lambda on, axis=axis: self._set_log(axis, on))
        self.titles[axis], self.logs[axis], self._units[axis] = title, log, unit

    def show_graph(self, graph: Graph, defaults: Mapping[str, AxisDefaults]) -> None:
        """Show the settings of a graph, and the automatic titles where none are set."""
        self._graph, self._defaults = graph, dict(defaults)
        _show(self.title, graph.title, "none")
        for axis in AXES:
            scale, default = getattr(graph, axis), self._defaults.get(axis, AxisDefaults())
            _show(self.titles[axis], scale.title, default.title or "automatic")
            self._units[axis].setText(default.symbol)
            with QSignalBlocker(self.logs[axis]):
                self.logs[axis].setChecked(scale.log)
            for end in ("low", "high"):
                box, value = self.ends[axis, end], getattr(scale, end)
                if not box.pending and not (box.hasFocus() and box.is_refused):
                    box.show_value(None if value is None else value / default.size)

    # -- input ----------------------------------------------------------------------------------------------

    def _set_title(self, axis: str, box: QLineEdit) -> None:
        """Set the title of an axis, or that of the graph for the axis ""."""
        text, part = box.text().strip(), getattr(self._graph, axis) if axis else self._graph
        if text == part.title:
            return
        box.setModified(False)
        if axis:
            self._scale(axis, "title", title=text)
        else:
            self.changed.emit(replace(self._graph, title=text), "title")

    def _limit(self, axis: str, end: str, value: float | None) -> Misfit | None:
        size, scale = self._defaults.get(axis, AxisDefaults()).size, getattr(self._graph, axis)
        changed: GraphAxis = replace(scale, **{end: None if value is None else value * size})
        box = self.ends[axis, end]
        allowed = ""
        if changed.low is not None and changed.high is not None and changed.low >= changed.high:
            limit = (changed.high if end == "low" else changed.low) / size
            allowed = f"{'less' if end == 'low' else 'more'} than {typed(limit)}"
        elif changed.log and value is not None and value <= 0.0:
            allowed = "above 0 on a logarithmic axis"
        if allowed and value is not None:
            return f"outside its range; allowed: {allowed}, not {box.with_unit(value)}", box.info
        self._scale(axis, end, **{end: getattr(changed, end)})
        return None

    def _set_log(self, axis: str, on: bool) -> None:
        """Use a logarithmic axis or a linear one; an end that is not positive is ignored on a logarithmic axis."""
        scale = getattr(self._graph, axis)
        has_invalid_end = on and any(end is not None and end <= 0.0 for end in (scale.low, scale.high))
        text = f"{AXES[axis]}: a logarithmic axis has no values of 0 and less; this end of the range is ignored"
        self.message.show_refusal(text if has_invalid_end else "")
        self._scale(axis, "log", log=on)

    def _scale(self, axis: str, what: str, **changes: object) -> None:
        self.changed.emit(
            replace(self._graph, **{axis: replace(getattr(self._graph, axis), **changes)}), f"{axis} {what}"
        )


def _show(box: QLineEdit, text: str, placeholder: str) -> None:
    box.setPlaceholderText(placeholder)
    if box.text() != text and not (box.hasFocus() and box.isModified()):
        box.setText(text)


# -- the selected curve ----------------------------------------------------------------------------------


class ChoiceBox(WordBox):
    """Box of texts with their values. Signal ``picked`` (str): the user has selected a value."""

    picked = Signal(str)

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setIconSize(QSize(18, 10))
        self.setMaxVisibleItems(24)
        self._rows: tuple[Choice, ...] = ()
        self.activated.connect(lambda index: self.picked.emit(str(self.itemData(index))))

    def show_choices(self, rows: Sequence[Choice], value: str) -> None:
        """Show these choices, one of them selected; a value that is none of them is added in parentheses."""
        choices = tuple(rows) if any(row[1] == value for row in rows) else (*rows, (f"({value})", value))
        with QSignalBlocker(self):
            if choices != self._rows:
                self._rows = choices
                self.clear()
                for choice in choices:
                    self.addItem(*choice)
            self.setCurrentIndex(next(i for i, choice in enumerate(choices) if choice[1] == value))

    def reset(self, value: str) -> None:
        """Select this one of the choices again."""
        self.show_choices(self._rows, value)


class CurveForm(QWidget):
    """Form of the selected curve.

    Signals: ``changed`` (GraphCurve, str), the new curve and the field that changed; ``file_requested``, open a file.
    """

    changed = Signal(object, str)
    file_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._curve = GraphCurve()
        self._source_of: Callable[[str], Source] | None = None
        self.boxes = {
            name: ChoiceBox(text)
            for name, text in (
                ("source", "From"),
                ("drive", "Drive"),
                ("y", "Values"),
                ("y_unit", "Unit of the values"),
                ("x", "Over"),
                ("x_unit", "Unit of the values along x"),
                ("minus", "Minus"),
                ("side", "Axis"),
                ("colour", "Colour"),
                ("dash", "Stroke"),
                ("mark", "Marks"),
            )
        }
        self.name = QLineEdit()
        self.name.setAccessibleName("Name")
        self.width_box = NumberBox(Info("Width", low=LEAST_WIDTH, high=MOST_WIDTH, step=0.5))
        self.width_box.setAccessibleName("Width")
        self.fault, self.note = MessageLabel(SCREEN.limit), MessageLabel(SCREEN.quiet)
        grid = QGridLayout(self)
        grid.setContentsMargins(6, 4, 6, 4)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 3)
        grid.setColumnStretch(3, 2)
        self._drive_label = QLabel("Drive")
        rows: tuple[tuple[tuple[str | QLabel, QWidget], ...], ...] = (
            (("From", self.boxes["source"]),),
            ((self._drive_label, self.boxes["drive"]),),
            (("Values", self.boxes["y"]), ("in", self.boxes["y_unit"])),
            (("over", self.boxes["x"]), ("in", self.boxes["x_unit"])),
            (("Minus", self.boxes["minus"]),),
            (("Name", self.name),),
            (("Axis", self.boxes["side"]), ("Colour", self.boxes["colour"])),
            (("Stroke", self.boxes["dash"]), ("Width", self.width_box)),
            (("Marks", self.boxes["mark"]),),
        )
        for row, parts in enumerate(rows):
            for i, (text, box) in enumerate(parts):
                label = text if isinstance(text, QLabel) else QLabel(text)
                label.setBuddy(box)
                grid.addWidget(label, row, 2 * i)
                is_wide = len(parts) == 1 and row < 6
                grid.addWidget(box, row, 2 * i + 1, 1, 3 if is_wide else 1)
        self.refusal = RefusalLine((0, 0, 0, 0))
        for row, part in enumerate((self.refusal, self.fault, self.note), len(rows)):
            grid.addWidget(part, row, 0, 1, 4)
        grid.setRowStretch(len(rows) + 3, 1)
        for name, box in self.boxes.items():
            box.picked.connect(lambda value, name=name: self._pick(name, value))
        self.name.editingFinished.connect(lambda: self._pick("name", self.name.text().strip()))
        accept_in_range(self.width_box, self.refusal, self._set_width)

    # -- display --------------------------------------------------------------------------------------------

    def show_curve(
        self,
        graph: Graph,
        curve: GraphCurve,
        names: Sequence[str],
        source_of: Callable[[str], Source],
        fault: str,
        note: str,
    ) -> None:
        """Show a curve of the graph; names: paths of the open files."""
        self._curve, self._source_of = curve, source_of
        files = [(Path(name).name, name) for name in dict.fromkeys((*names, curve.source)) if name]
        boxes = self.boxes
        boxes["source"].show_choices((("this design", ""), *files, ("open a file …", OPEN)), curve.source)
        source, headings = self._headings(curve, source_of)
        drives = source.drives if isinstance(source, DesignSource) else ()
        rows = (
            ("the selected drive", ""),
            *((name, name) for name in drives),
            ("all drives, a curve each", ALL),
            ("the shaft", SHAFT),
        )
        boxes["drive"].show_choices(rows, curve.drive)
        for part in (boxes["drive"], self._drive_label):
            part.setVisible(bool(drives) or bool(curve.drive))
        for axis, default in (("x", 0), ("y", source.default_column(headings) if source is not None else 1)):
            self._show_column(axis, headings, default)
        subtrahends = [
            (f"{i}  {name_of_row(row)}", row.key) for i, row in enumerate(graph.curves, 1) if row.key != curve.key
        ]
        boxes["minus"].show_choices((("no curve", ""), *subtrahends), curve.minus)
        boxes["side"].show_choices([(_SIDE_NAMES[side], side) for side in SIDES], curve.side)
        boxes["dash"].show_choices([(dash, dash) for dash in DASHES], curve.dash)
        boxes["mark"].show_choices([(mark, mark) for mark in MARKS], curve.mark)
        boxes["colour"].show_choices((("automatic", ""), *((colour, colour) for colour in _COLOURS)), curve.colour)
        for i in range(1, boxes["colour"].count()):
            boxes["colour"].setItemIcon(i, swatch(str(boxes["colour"].itemData(i))))
        if self.name.text() != curve.name and not self.name.isModified():
            self.name.setText(curve.name)
        self.name.setPlaceholderText("from source and column")
        if not self.width_box.pending:
            self.width_box.show_value(curve.width)
        self.fault.show_message(fault)
        self.note.show_message(note)

    @staticmethod
    def _headings(
        curve: GraphCurve, source_of: Callable[[str], Source]
    ) -> tuple[Source | None, tuple[ColumnHeading, ...]]:
        try:
            source = source_of(curve.source)
        except KindynaError:
            return None, ()
        try:
            return source, source.headings(source.parts(curve.drive)[0])
        except KindynaError:
            return source, ()

    def _show_column(self, axis: str, headings: tuple[ColumnHeading, ...], default: int) -> None:
        value = getattr(self._curve, axis)
        heading = next((h for h in headings if value in (h.name, split_unit(h.name)[0])), None)
        if heading is None and not value and len(headings) > default:
            heading = headings[default]
        counts = Counter(h.label for h in headings)
        rows = [(h.label if counts[h.label] == 1 else f"{h.label}, {h.unit or h.name}", h.name) for h in headings]
        column = heading.name if heading is not None else value
        if all(name != column for _, name in rows):
            rows.append((f"({column_label(column)})" if column else "…", column))
        self.boxes[axis].show_choices(rows, column)
        column_unit = heading.unit if heading is not None else ""
        unit = getattr(self._curve, f"{axis}_unit")
        known = compatible_units(column_unit) if column_unit else [u for kind in KINDS.values() for u in kind.units]
        units = [(symbol, symbol) for symbol in known if symbol != column_unit]
        self.boxes[f"{axis}_unit"].show_choices(
            [(column_unit or "no unit", ""), *units], unit if unit != column_unit else ""
        )

    def _default_channel(self) -> str:
        """Channel of a new curve of the current design."""
        source, headings = self._headings(GraphCurve(), self._source_of) if self._source_of is not None else (None, ())
        return headings[source.default_column(headings)].name if source is not None and headings else ""

    # -- input ----------------------------------------------------------------------------------------------

    def _pick(self, name: str, value: str) -> None:
        if value == OPEN:
            self.boxes["source"].reset(self._curve.source)
            self.file_requested.emit()
            return
        if value == getattr(self._curve, name):
            return
        changes: dict[str, Any] = {name: value}
        changed = replace(self._curve, **changes)
        if name == "source":  # has other columns
            changed = replace(changed, x="", y="" if value else self._default_channel(), x_unit="", y_unit="", drive="")
        elif name in ("x", "y"):
            changes = {f"{name}_unit": ""}
            changed = replace(changed, **changes)
        self.name.setModified(False)
        self.changed.emit(changed, name)

    def _set_width(self, value: float) -> None:
        self.changed.emit(replace(self._curve, width=value), "width")


def name_of_row(curve: GraphCurve) -> str:
    """Return the name of a curve, else its column, drive and file."""
    column = column_label(curve.y) if curve.y else "first column"
    return curve.name or ", ".join(part for part in (column, curve.drive, Path(curve.source).stem) if part)


# -- list of curves --------------------------------------------------------------------------------------


@frozen
class CurveRow:
    """Row of the list of curves.

    Attributes
    ----------
    name, colour : str
    shown : bool
        Whether the user shows the curve.
    fault : str
        Why it cannot be drawn.
    note : str
        What is omitted from it, or missing in the current design.
    is_missing : bool
        Whether the current design does not have the curve.
    """

    name: str
    colour: str
    shown: bool
    fault: str = ""
    note: str = ""
    is_missing: bool = False


class _List(QListWidget):
    """List with keys. Signals: ``moved`` (-1 or 1) for Alt+Up and Alt+Down; ``removed`` for Delete."""

    moved = Signal(int)
    removed = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)

    def sizeHint(self) -> QSize:
        return QSize(260, LIST_HEIGHT)


class CurveRows(QWidget):
    """List of curves with its buttons. Signals: ``selected`` (int); ``ticked`` (int, bool), shown or hidden."""

    selected = Signal(int)
    ticked = Signal(int, bool)

    def __init__(
        self, slots: dict[str, Callable[[], object]], additions: Sequence[tuple[str, str, Callable[[], object]]]
    ) -> None:
        """Slots: for copy, remove, up, down, undo, redo; additions: text, tip and slot of each entry of the menu Add."""
        super().__init__()
        self.list = _List()
        self.list.setAccessibleName("Curves")
        self.list.setAlternatingRowColors(True)
        self.list.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setIconSize(QSize(18, 10))
        self.list.currentRowChanged.connect(self.selected)
        self.list.itemChanged.connect(self._tick)
        self.list.moved.connect(lambda step: slots["up" if step < 0 else "down"]())
        self.list.removed.connect(lambda: slots["remove"]())
        self.menu = QMenu(self)
        for text, tip, slot in additions:
            action = self.menu.addAction(text)
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(lambda _=False, slot=slot: slot())
        add = list_button("Add", "insert", "Add a curve", None)
        add.setMenu(self.menu)
        add.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.buttons = {
            "add": add,
            "copy": list_button("Copy", "duplicate", "Duplicate the selected curve", slots["copy"]),
            "remove": list_button("Remove", "delete", "Remove the selected curve (Del)", slots["remove"]),
            "up": list_button("↑", "", "Move up in the list (Alt+Up)", slots["up"]),
            "down": list_button("↓", "", "Move down in the list; drawn on top (Alt+Down)", slots["down"]),
            "undo": list_button(
                "Undo", "undo", "Undo the last change of the graph (Ctrl+Z in this list)", slots["undo"]
            ),
            "redo": list_button("Redo", "redo", "Redo the change (Ctrl+Y in this list)", slots["redo"]),
        }
        bar = QHBoxLayout()
        bar.setContentsMargins(2, 1, 2, 1)
        bar.setSpacing(0)
        for name, button in self.buttons.items():
            if name in ("undo", "redo"):
                button.setEnabled(False)
            if name in ("copy", "remove", "undo", "redo"):
                button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonIconOnly)
            button.setAccessibleName(button.text() if len(button.text()) > 1 else name)
            bar.addWidget(button)
        bar.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        buttons = QWidget()
        buttons.setLayout(bar)
        buttons.setMinimumWidth(1)
        column.addWidget(buttons)
        column.addWidget(self.list, 1)
        self.list.setMinimumSize(1, 40)

    def show_rows(self, rows: Sequence[CurveRow], row: int) -> None:
        """Show these curves, one of them selected."""
        with QSignalBlocker(self.list):
            while self.list.count() > len(rows):
                self.list.takeItem(self.list.count() - 1)
            while self.list.count() < len(rows):
                self.list.addItem(QListWidgetItem())
            for i, curve in enumerate(rows):
                self._fill(self.list.item(i), curve)
            self.list.setCurrentRow(row)
        is_selected = 0 <= row < len(rows)
        enabled = {
            "copy": is_selected,
            "remove": is_selected,
            "up": row > 0,
            "down": is_selected and row < len(rows) - 1,
        }
        for name, on in enabled.items():
            self.buttons[name].setEnabled(on)

    @staticmethod
    def _fill(item: QListWidgetItem, row: CurveRow) -> None:
        mark = (
            "  (not drawn)" if row.fault else "  (not in this design)" if row.is_missing else "  *" if row.note else ""
        )
        item.setText(row.name + mark)
        item.setToolTip(row.fault or row.note or row.name)
        item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsUserCheckable)
        item.setCheckState(Qt.CheckState.Checked if row.shown else Qt.CheckState.Unchecked)
        normal = item.listWidget().palette().text().color() if row.shown and not row.is_missing else SCREEN.quiet
        item.setForeground(QColor(SCREEN.limit if row.fault else normal))
        item.setIcon(swatch(row.colour, 16))

    def _tick(self, item: QListWidgetItem) -> None:
        self.ticked.emit(self.list.row(item), item.checkState() == Qt.CheckState.Checked)
