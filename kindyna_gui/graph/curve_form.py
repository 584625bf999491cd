"""The form of one curve: where it comes from, its columns and units, what is subtracted, its axis and how it is drawn."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Signal
from PySide6.QtGui import QColor, QIcon, QPixmap
from PySide6.QtWidgets import QGridLayout, QLabel, QLineEdit, QWidget

from core.design import Info, split_unit
from core.errors import KindynaError
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
    GraphCurve,
    Source,
    column_label,
    compatible_units,
)
from core.units import KINDS
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.note import MessageLabel
from kindyna_gui.pictures.style import DRIVES, FAMILIES, SCREEN

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


__all__ = ["ChoiceBox", "CurveForm", "name_of_row"]
