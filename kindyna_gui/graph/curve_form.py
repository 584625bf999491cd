"""Forms of curves and axes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QKeyEvent, QPainter, QPixmap
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
from kindyna_gui.labels import no_number
from kindyna_gui.look import MessageLabel, bold_label, coloured
from kindyna_gui.pictures.style import DRIVES, FAMILIES, SCREEN

# -- axes form -------------------------------------------------------------------------------------------

AXES = {"x": "Along the bottom", "left": "On the left", "right": "On the right"}
RANGE = Info("Range", "empty: as far as the curves go", optional=True)


@frozen
class AxisSays:
    """What an axis shows by itself: its title, the unit it is read in, how many of the curves' unit that is."""

    title: str = ""
    symbol: str = ""
    size: float = 1.0


class AxesForm(QWidget):
    """changed (Graph, str): the graph as it is to be, and what was changed."""

    changed = Signal(object, str)

    def __init__(self) -> None:
        super().__init__()
        self._graph, self._says = Graph(), dict.fromkeys(AXES, AxisSays())
        self.title = QLineEdit()
        self.title.setAccessibleName("Title of the graph")
        self.title.editingFinished.connect(self._entitle)
        self.titles: dict[str, QLineEdit] = {}
        self.logs: dict[str, QCheckBox] = {}
        self.ends: dict[tuple[str, str], NumberBox] = {}
        self._units: dict[str, QLabel] = {}
        self.message = MessageLabel(SCREEN.limit)
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
        head, title, log, unit = bold_label(text), QLineEdit(), QCheckBox("Logarithmic"), QLabel()
        title.setAccessibleName(f"Title, {text.lower()}")
        log.setAccessibleName(f"Logarithmic, {text.lower()}")
        coloured(unit, SCREEN.quiet)
        grid.addWidget(head, row, 0, 1, 2)
        named = QLabel("Title")
        named.setBuddy(title)
        grid.addWidget(named, row + 1, 0)
        grid.addWidget(title, row + 1, 1)
        grid.addWidget(QLabel("from"), row + 2, 0)
        line = QHBoxLayout()
        line.setSpacing(4)
        for end, between in (("low", "to"), ("high", "")):
            box = NumberBox(RANGE)
            box.setAccessibleName(f"{'From' if end == 'low' else 'To'}, {text.lower()}")
            box.setToolTip("Empty: as far as the curves go")
            box.entered.connect(lambda value, axis=axis, end=end: self._limit(axis, end, value))
            box.unreadable.connect(lambda axis=axis, end=end: self._refuse(axis, end))
            box.withdrawn.connect(lambda: self.message.show_message(""))
            line.addWidget(box, 1)
            if between:
                line.addWidget(QLabel(between))
            self.ends[axis, end] = box
        line.addWidget(unit)
        grid.addLayout(line, row + 2, 1)
        grid.addWidget(log, row + 3, 1)
        title.editingFinished.connect(lambda axis=axis: self._name(axis))
        log.toggled.connect(lambda on, axis=axis: self._to_powers(axis, on))
        self.titles[axis], self.logs[axis], self._units[axis] = title, log, unit

    def show_graph(self, graph: Graph, says: Mapping[str, AxisSays]) -> None:
        """What is typed, and what stands there where nothing is."""
        self._graph, self._says = graph, dict(says)
        _show(self.title, graph.title, "none")
        for axis in AXES:
            scale, own = getattr(graph, axis), self._says.get(axis, AxisSays())
            _show(self.titles[axis], scale.title, own.title or "by what is drawn")
            self._units[axis].setText(own.symbol)
            with QSignalBlocker(self.logs[axis]):
                self.logs[axis].setChecked(scale.log)
            for end in ("low", "high"):
                box, value = self.ends[axis, end], getattr(scale, end)
                if not box.pending and not (box.hasFocus() and box.refused):
                    box.show_value(None if value is None else value / own.size)

    # -- what the user does ---------------------------------------------------------------------------------

    def _entitle(self) -> None:
        if self.title.text().strip() != self._graph.title:
            self.title.setModified(False)
            self.changed.emit(replace(self._graph, title=self.title.text().strip()), "title")

    def _name(self, axis: str) -> None:
        text = self.titles[axis].text().strip()
        if text != getattr(self._graph, axis).title:
            self.titles[axis].setModified(False)
            self._scale(axis, "title", title=text)

    def _limit(self, axis: str, end: str, value: float | None) -> None:
        own, scale = self._says.get(axis, AxisSays()), getattr(self._graph, axis)
        wanted: GraphAxis = replace(scale, **{end: None if value is None else value * own.size})
        if wanted.low is not None and wanted.high is not None and wanted.low >= wanted.high:
            other = (wanted.high if end == "low" else wanted.low) / own.size
            self._wrong(axis, end, f"{'less' if end == 'low' else 'more'} than {other:g}")
        elif wanted.log and value is not None and value <= 0.0:
            self._wrong(axis, end, "above 0 on a logarithmic axis")
        else:
            self.message.show_message("")
            self.ends[axis, end].show_value(value)  # no longer being typed: what is undone is seen there
            self._scale(axis, end, **{end: getattr(wanted, end)})

    def _to_powers(self, axis: str, on: bool) -> None:
        """Powers of ten, or not; an end that has no place among them stays typed, and does not count."""
        scale = getattr(self._graph, axis)
        lost = on and any(end is not None and end <= 0.0 for end in (scale.low, scale.high))
        text = f"{AXES[axis]}: 0 and less is not on a logarithmic axis; what is typed does not count there"
        self.message.show_message(text if lost else "")
        self._scale(axis, "log", log=on)

    def _wrong(self, axis: str, end: str, allowed: str) -> None:
        self.ends[axis, end].set_refused(True)
        self.message.show_message(
            f"{AXES[axis]}, {'from' if end == 'low' else 'to'}: outside its range; allowed: {allowed}"
        )

    def _refuse(self, axis: str, end: str) -> None:
        self.ends[axis, end].set_refused(True)
        self.message.show_message(f"{AXES[axis]}: {no_number(self.ends[axis, end].text())}")

    def _scale(self, axis: str, what: str, **changes: object) -> None:
        self.changed.emit(
            replace(self._graph, **{axis: replace(getattr(self._graph, axis), **changes)}), f"{axis} {what}"
        )


def _show(box: QLineEdit, text: str, usual: str) -> None:
    box.setPlaceholderText(usual)
    if box.text() != text and not (box.hasFocus() and box.isModified()):
        box.setText(text)


# -- curve form ------------------------------------------------------------------------------------------

OPEN = "\0open"
_COLOURS = tuple(dict.fromkeys((*DRIVES, *FAMILIES.values())))[:12]
_SAY = {"auto": "by its unit", "left": "left", "right": "right"}
Choice = tuple[str, str]
"""What a box holds: the text shown, and the value."""


class ChoiceBox(WordBox):
    """Words with what they mean.

    picked (str): the user has chosen this value
    """

    picked = Signal(str)

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setIconSize(QSize(18, 10))
        self.setMaxVisibleItems(24)
        self._rows: tuple[Choice, ...] = ()
        self.activated.connect(lambda index: self.picked.emit(str(self.itemData(index))))

    def show_choices(self, rows: Sequence[Choice], value: str) -> None:
        """These, of which one is chosen; a value that is none of them stays, in parentheses."""
        wanted = tuple(rows) if any(each == value for _, each in rows) else (*rows, (f"({value})", value))
        with QSignalBlocker(self):
            if wanted != self._rows:
                self._rows = wanted
                self.clear()
                for text, each in wanted:
                    self.addItem(text, each)
            self.setCurrentIndex(next(i for i, (_, each) in enumerate(wanted) if each == value))

    def take_back(self, value: str) -> None:
        """Show this one of the choices again."""
        self.show_choices(self._rows, value)


class CurveForm(QWidget):
    """changed (Curve, str): the chosen curve as it is to be, and what was changed; file_wanted: another file is to be opened."""

    changed = Signal(object, str)
    file_wanted = Signal()

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
                ("x_unit", "Unit of what it is drawn over"),
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
        for at, parts in enumerate(rows):
            for place, (text, box) in enumerate(parts):
                label = text if isinstance(text, QLabel) else QLabel(text)
                label.setBuddy(box)
                grid.addWidget(label, at, 2 * place)
                alone = len(parts) == 1 and at < 6
                grid.addWidget(box, at, 2 * place + 1, 1, 3 if alone else 1)
        grid.addWidget(self.fault, len(rows), 0, 1, 4)
        grid.addWidget(self.note, len(rows) + 1, 0, 1, 4)
        grid.setRowStretch(len(rows) + 2, 1)
        for name, box in self.boxes.items():
            box.picked.connect(lambda value, name=name: self._pick(name, value))
        self.name.editingFinished.connect(lambda: self._pick("name", self.name.text().strip()))
        self.width_box.entered.connect(self._widen)
        self.width_box.unreadable.connect(lambda: self.width_box.set_refused(True))

    # -- what is shown --------------------------------------------------------------------------------------

    def show_curve(
        self,
        graph: Graph,
        curve: GraphCurve,
        names: Sequence[str],
        source_of: Callable[[str], Source],
        fault: str,
        note: str,
    ) -> None:
        """A row of the graph; names: the files that are open."""
        self._curve, self._source_of = curve, source_of
        files = [(Path(name).name, name) for name in dict.fromkeys((*names, curve.source)) if name]
        boxes = self.boxes
        boxes["source"].show_choices((("this design", ""), *files, ("open a file …", OPEN)), curve.source)
        source, headings = self._headings(curve, source_of)
        drives = source.drives if isinstance(source, DesignSource) else ()
        rows = (
            ("the chosen one", ""),
            *((name, name) for name in drives),
            ("all, a curve each", ALL),
            ("the shaft", SHAFT),
        )
        boxes["drive"].show_choices(rows, curve.drive)
        for part in (boxes["drive"], self._drive_label):
            part.setVisible(bool(drives) or bool(curve.drive))
        for axis, usual in (("x", 0), ("y", source.default_column(headings) if source is not None else 1)):
            self._show_column(axis, headings, usual)
        others = [
            (f"{i}  {name_of_row(each)}", each.key) for i, each in enumerate(graph.curves, 1) if each.key != curve.key
        ]
        boxes["minus"].show_choices((("nothing", ""), *others), curve.minus)
        boxes["side"].show_choices([(_SAY[side], side) for side in SIDES], curve.side)
        boxes["dash"].show_choices([(dash, dash) for dash in DASHES], curve.dash)
        boxes["mark"].show_choices([(mark, mark) for mark in MARKS], curve.mark)
        boxes["colour"].show_choices((("automatic", ""), *((colour, colour) for colour in _COLOURS)), curve.colour)
        for i in range(1, boxes["colour"].count()):
            boxes["colour"].setItemIcon(i, _patch(str(boxes["colour"].itemData(i))))
        if self.name.text() != curve.name and not self.name.isModified():
            self.name.setText(curve.name)
        self.name.setPlaceholderText("by source and column")
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

    def _show_column(self, axis: str, headings: tuple[ColumnHeading, ...], usual: int) -> None:
        value = getattr(self._curve, axis)
        named = next((h for h in headings if value in (h.name, split_unit(h.name)[0])), None)
        alike = Counter(each.label for each in headings)
        rows = [
            (each.label if alike[each.label] == 1 else f"{each.label}, {each.unit or each.name}", each.name)
            for each in headings
        ]
        chosen = named.name if named else value or _first(headings, usual)
        if all(name != chosen for _, name in rows):
            rows.append((f"({column_label(chosen)})" if chosen else "…", chosen))
        self.boxes[axis].show_choices(rows, chosen)
        heading = named or (headings[usual] if not value and len(headings) > usual else None)
        own = heading.unit if heading is not None else ""
        unit = getattr(self._curve, f"{axis}_unit")
        known = compatible_units(own) if own else [each for kind in KINDS.values() for each in kind.units]
        units = [(each, each) for each in known if each != own]
        self.boxes[f"{axis}_unit"].show_choices([(own or "no unit", ""), *units], unit if unit != own else "")

    def _first_of_design(self) -> str:
        """The channel that a curve of the design at hand begins with."""
        source, headings = self._headings(GraphCurve(), self._source_of) if self._source_of is not None else (None, ())
        return headings[source.default_column(headings)].name if source is not None and headings else ""

    # -- what the user does ---------------------------------------------------------------------------------

    def _pick(self, name: str, value: str) -> None:
        if value == OPEN:
            self.boxes["source"].take_back(self._curve.source)
            self.file_wanted.emit()
            return
        if value == getattr(self._curve, name):
            return
        changes: dict[str, Any] = {name: value}
        changed = replace(self._curve, **changes)
        if name == "source":  # columns of another file
            changed = replace(changed, x="", y="" if value else self._first_of_design(), x_unit="", y_unit="", drive="")
        elif name in ("x", "y"):
            changes = {f"{name}_unit": ""}
            changed = replace(changed, **changes)
        self.name.setModified(False)
        self.changed.emit(changed, name)

    def _widen(self, value: float | None) -> None:
        if value is not None and LEAST_WIDTH <= value <= MOST_WIDTH:
            self.width_box.show_value(value)  # no longer being typed: what is undone is seen there
            self.changed.emit(replace(self._curve, width=value), "width")
        else:
            self.width_box.set_refused(True)


def _first(headings: tuple[ColumnHeading, ...], usual: int) -> str:
    return headings[usual].name if len(headings) > usual else ""


def name_of_row(curve: GraphCurve) -> str:
    """A curve by its name, else by what it is to be drawn from."""
    column = column_label(curve.y) if curve.y else "first column"
    return curve.name or ", ".join(part for part in (column, curve.drive, Path(curve.source).stem) if part)


def _patch(colour: str) -> QIcon:
    picture = QPixmap(QSize(36, 20))
    picture.setDevicePixelRatio(2.0)
    picture.fill(QColor(colour))
    return QIcon(picture)


# -- curve rows ------------------------------------------------------------------------------------------

LIST_HEIGHT = 128
EMPTY = "No curve yet: press Add, or drop files here"


@frozen
class CurveRow:
    """What the list shows of a curve: name, colour, whether it is drawn; fault: why it is not; note: what was left out of it, or
    what the design at hand has not of it (lacking)."""

    name: str
    colour: str
    shown: bool
    fault: str = ""
    note: str = ""
    lacking: bool = False


class _List(QListWidget):
    """moved (-1 or 1): Alt+Up, Alt+Down; removed: Delete."""

    moved = Signal(int)
    removed = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)

    def sizeHint(self) -> QSize:
        return QSize(260, LIST_HEIGHT)


class CurveRows(QWidget):
    """List and buttons.

    chosen (int); ticked (int, bool): shown or hidden; removed, copied; moved (-1 or 1)
    """

    chosen = Signal(int)
    ticked = Signal(int, bool)

    def __init__(
        self, slots: dict[str, Callable[[], object]], additions: Sequence[tuple[str, str, Callable[[], object]]]
    ) -> None:
        """slots: of copy, remove, up, down, undo, redo; additions: text, tip and slot of the menu of Add."""
        super().__init__()
        self.list = _List()
        self.list.setAccessibleName("Curves")
        self.list.setAlternatingRowColors(True)
        self.list.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setIconSize(QSize(18, 10))
        self.list.currentRowChanged.connect(self._choose)
        self.list.itemChanged.connect(self._tick)
        self.list.moved.connect(lambda step: slots["up" if step < 0 else "down"]())
        self.list.removed.connect(lambda: slots["remove"]())
        self.menu = QMenu(self)
        for text, tip, slot in additions:
            action = self.menu.addAction(text)
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(lambda _=False, slot=slot: slot())
        add = list_button("Add", "insert", "One curve more", None)
        add.setMenu(self.menu)
        add.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.buttons = {
            "add": add,
            "copy": list_button("Copy", "duplicate", "The chosen curve once more", slots["copy"]),
            "remove": list_button("Remove", "delete", "Take the chosen curve away (Del)", slots["remove"]),
            "up": list_button("↑", "", "Further up in the list (Alt+Up)", slots["up"]),
            "down": list_button("↓", "", "Further down in the list, drawn above (Alt+Down)", slots["down"]),
            "undo": list_button(
                "Undo", "undo", "Take the last change of the graph back (Ctrl+Z in this list)", slots["undo"]
            ),
            "redo": list_button("Redo", "redo", "Make it again (Ctrl+Y in this list)", slots["redo"]),
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
        """These curves, one of them chosen."""
        with QSignalBlocker(self.list):
            while self.list.count() > len(rows):
                self.list.takeItem(self.list.count() - 1)
            while self.list.count() < len(rows):
                self.list.addItem(QListWidgetItem())
            for i, each in enumerate(rows):
                self._fill(self.list.item(i), each)
            self.list.setCurrentRow(row)
        there = 0 <= row < len(rows)
        enabled = {
            "copy": there,
            "remove": there,
            "up": row > 0,
            "down": there and row < len(rows) - 1,
        }
        for name, on in enabled.items():
            self.buttons[name].setEnabled(on)

    @staticmethod
    def _fill(item: QListWidgetItem, row: CurveRow) -> None:
        mark = "  (not drawn)" if row.fault else "  (not here)" if row.lacking else "  *" if row.note else ""
        item.setText(row.name + mark)
        item.setToolTip(row.fault or row.note or row.name)
        item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsUserCheckable)
        item.setCheckState(Qt.CheckState.Checked if row.shown else Qt.CheckState.Unchecked)
        usual = item.listWidget().palette().text().color() if row.shown and not row.lacking else SCREEN.quiet
        item.setForeground(QColor(SCREEN.limit if row.fault else usual))
        item.setIcon(_swatch(row.colour))

    def _choose(self, row: int) -> None:
        self.chosen.emit(row)

    def _tick(self, item: QListWidgetItem) -> None:
        self.ticked.emit(self.list.row(item), item.checkState() == Qt.CheckState.Checked)


def _swatch(colour: str) -> QIcon:
    """A short line in a colour; nothing where there is none."""
    picture = QPixmap(QSize(36, 20))
    picture.setDevicePixelRatio(2.0)
    picture.fill(Qt.GlobalColor.transparent)
    if colour:
        painter = QPainter(picture)
        painter.fillRect(1, 4, 16, 2, QColor(colour))
        painter.end()
    return QIcon(picture)
