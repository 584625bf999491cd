"""View of the outlines of bodies and of their clearances: a list of outlines with its form, a list of pairs with what they must keep."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import degrees
from typing import Any

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QGridLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QSplitter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import UNITS, Design, Outline, OutlinePoint, faults, info_of
from core.design.outline_bodies import body_named
from core.design.outline_edits import (
    add_outline,
    body_title,
    possible_bodies,
    with_clearance,
    with_outline,
    with_outline_order,
)
from core.design.outlines import CAM, ClearanceRow
from core.errors import KindynaError, angle_list
from core.number_text import shortest
from core.study import Study
from core.study.clearances import Clearances, LeastClearance
from kindyna_gui.dialogs import file_to_open
from kindyna_gui.documents.edits import fault_reasons
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import UnitLabel
from kindyna_gui.forms.load_rows import list_button, row_of_buttons, taken_by_list
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.refusal import RefusalLine, accept_in_range
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.look import described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import readable_text, short
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import add_entry, clear_menu, connect_all, fill, widget_with
from kindyna_gui.view import View

OUTLINE_HEADINGS = (
    TableHeading("Body", wide=True),
    TableHeading("Shape", wide=True),
    TableHeading("Layer", spare=1),
)
PAIR_HEADINGS = (
    TableHeading("Bodies", wide=True),
    TableHeading("Least clearance", number=True),
    TableHeading("at", number=True),
    TableHeading("must keep", number=True),
)
EMPTY = "No outlines yet. Press Add to give a body its outline; then the least clearances are listed at the right."
ALONE = "No two bodies that do not touch by design share a layer. Add an outline of another body."
PAUSE_MS = 150
_NUMBER = r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?"
FIELDS = {"round_mm": "Grown by", "layer_from_mm": "Layer from", "layer_to_mm": "Layer to"}
"""Number of an outline -> its label in the form."""


def shape_text(outline: Outline) -> str:
    """Return the shape of an outline in words."""
    grown = f" + {readable_text(outline.round_mm, 'mm')}" if outline.round_mm else ""
    if outline.file:
        return f"{os.path.basename(outline.file)}{grown}"
    if outline.points:
        count = len(outline.points)
        return f"{'point' if count == 1 else f'{count} corners'}{grown}"
    return ("profile" if outline.of == CAM else "circle" if not outline.round_mm else "its points") + grown


def layer_text(outline: Outline) -> str:
    """Return the layer of an outline, such as ``0 … 12 mm``; empty for all layers."""
    low, high = outline.layer_from_mm, outline.layer_to_mm
    if low is None and high is None:
        return ""
    return f"{'' if low is None else short(low)} … {'' if high is None else short(high)} mm".strip()


def corners_text(outline: Outline) -> str:
    """Return the corners of an outline as they are typed: ``0, 0; 10, 0; 10, 5``."""
    return "; ".join(f"{shortest(point.x_mm)}, {shortest(point.y_mm)}" for point in outline.points)


def corners(text: str) -> tuple[OutlinePoint, ...] | None:
    """Return corners from their text; None where it is none."""
    numbers = re.findall(_NUMBER, text)
    if len(numbers) % 2 or re.sub(rf"{_NUMBER}|[\s;,()\[\]]", "", text):
        return None
    values = list(map(float, numbers))
    return tuple(OutlinePoint(x, y) for x, y in zip(values[::2], values[1::2], strict=True))


class ListTable(RowsTable):
    """A list of rows. Signals: ``removed`` for Delete; ``chosen`` with the number of the row that becomes current."""

    moved = Signal(int)
    removed = Signal()
    chosen = Signal(int)

    def __init__(self, headings: tuple[TableHeading, ...], name: str) -> None:
        super().__init__(headings)
        self.setWordWrap(False)
        self.setAccessibleName(name)
        self.selectionModel().currentRowChanged.connect(lambda now, _: self.chosen.emit(now.row()))

    def sizeHint(self) -> QSize:
        return QSize(260, 96)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)

    def show_list(self, rows: list[TableRow], current: int) -> None:
        """Show these rows and select one, without a signal."""
        was = self.blockSignals(True)
        self.show_rows(rows)
        if 0 <= current < len(rows):
            self.selectRow(current)
        else:
            self.clearSelection()
        self.blockSignals(was)


class ClearanceView(View):
    """Outlines and clearances of all bodies; each change is an undo step."""

    is_design_wide = True
    pause_ms = PAUSE_MS

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.outlines = ListTable(OUTLINE_HEADINGS, "Outlines")
        self.pairs = ListTable(PAIR_HEADINGS, "Clearances")
        self.message, self.pair_message = RefusalLine(), RefusalLine()
        self._row, self._pair_row = 0, 0
        self._showing = False
        self.menu = QMenu(self)
        self.menu.aboutToShow.connect(self._fill)
        self.buttons = {
            "add": list_button("Add", "insert", "Add an outline of a body", None),
            "copy": list_button("Copy", "duplicate", "Duplicate the selected outline", self._copy),
            "remove": list_button("Remove", "delete", "Remove the selected outline (Del)", self._remove),
            "file": list_button(
                "Drawing…", "", "Take the outline from a DXF drawing of lines and arcs", self._choose_file
            ),
        }
        self.buttons["add"].setMenu(self.menu)
        self.buttons["add"].setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.boxes: dict[str, NumberBox] = {}
        self.corners = described(
            QLineEdit(placeholderText="x, y; x, y; …"),
            name="Corners",
            tip="Corners in mm in the frame of the body: x, y; x, y; …",
        )
        self.corners.editingFinished.connect(self._corners_typed)
        self.form = self._outline_form()
        self.least = self._box(ClearanceRow, "least_mm", "Must keep", self.pair_message, self._least_entered)
        self.pair_form = widget_with(
            fill(QGridLayout(), margins=(6, 2, 6, 4)),
        )
        self._add_row(self.pair_form, 0, "Must keep", self.least)
        left = widget_with(
            fill(
                QVBoxLayout(),
                (self.outlines, 1),
                row_of_buttons(self.buttons.values(), above=1),
                self.form,
                self.message,
                margins=0,
                spacing=0,
            )
        )
        right = widget_with(
            fill(QVBoxLayout(), (self.pairs, 1), self.pair_form, self.pair_message, margins=0, spacing=0)
        )
        self.splitter = QSplitter(Qt.Orientation.Horizontal)
        for part in (left, right):
            self.splitter.addWidget(part)
        self.splitter.setChildrenCollapsible(False)
        self.set_column(self.splitter, grows=self.splitter)
        connect_all(
            (self.outlines.chosen, self._choose),
            (self.outlines.removed, self._remove),
            (self.pairs.chosen, self._choose_pair),
            (self.pairs.clicked, lambda index: self._show_angle(index.row())),
            (self.pairs.removed, partial(self._put_clearance, None)),
        )

    # -- forms ----------------------------------------------------------------------------------------------

    def _outline_form(self) -> QWidget:
        form = widget_with(fill(QGridLayout(), margins=(6, 2, 6, 4)))
        self._add_row(form, 0, "Corners", self.corners)
        for row, (name, label) in enumerate(FIELDS.items(), 1):
            self.boxes[name] = self._box(Outline, name, label, self.message, partial(self._number_entered, name))
            self._add_row(form, row, label, self.boxes[name])
        return form

    def _box(self, kind: Any, name: str, label: str, line: RefusalLine, accept: Callable[[Any], object]) -> NumberBox:
        info = next(info_of(part) for part in kind.__dataclass_fields__.values() if part.name == name)
        assert info is not None
        box = described(NumberBox(info, UNITS["mm"]), name=label)
        accept_in_range(box, line, accept)
        box.finished.connect(self.session.end_gesture)
        return box

    @staticmethod
    def _add_row(form: QWidget, row: int, text: str, editor: QWidget) -> None:
        grid = form.layout()
        assert isinstance(grid, QGridLayout)
        label = QLabel(text)
        label.setBuddy(editor)
        grid.addWidget(label, row, 0)
        grid.addWidget(editor, row, 1)
        grid.addWidget(UnitLabel(UNITS["mm"]), row, 2)
        grid.setColumnStretch(1, 1)

    # -- from the session -----------------------------------------------------------------------------------

    @property
    def _design(self) -> Design:
        design: Design = self.session.full_design
        return design

    @property
    def clearances(self) -> Clearances:
        """Clearances of the current design."""
        clearances: Clearances = self.session.full_study.clearances
        return clearances

    def preparation(self) -> Callable[[], Any] | None:
        clearances = self.clearances
        return lambda: [clearances.least(pair) for pair in clearances.pairs]

    def refresh(self, study: Study) -> None:
        design = self._design
        self._row = min(max(self._row, 0), len(design.outlines) - 1)
        rows = [
            TableRow((body_title(design, row.of, row.drive), shape_text(row), layer_text(row)))
            for row in design.outlines
        ]
        self.outlines.show_list(rows, self._row)
        self.form.setVisible(bool(rows))
        for key in ("copy", "remove", "file"):
            self.buttons[key].setEnabled(bool(rows))
        self.message.show_refusal("" if rows else EMPTY, is_wrong=False)
        if rows:
            self._show_form(design.outlines[self._row])
        self._show_pairs(design)

    def _show_form(self, outline: Outline) -> None:
        if not self.corners.hasFocus():
            self.corners.setText(corners_text(outline))
        self.corners.setEnabled(not outline.file)
        for name, box in self.boxes.items():
            if not box.pending or not box.hasFocus():
                box.show_value(getattr(outline, name))

    def _show_pairs(self, design: Design) -> None:
        rows, text = [], ""
        try:
            clearances = self.clearances if design.outlines else None
            results = [] if clearances is None else [(pair, clearances.least(pair)) for pair in clearances.pairs]
            for pair, result in results:
                rows.append(_pair_row(result, self._stated(pair), self.clearances.required(pair)))
            text = "" if rows or not design.outlines else ALONE
        except KindynaError as error:
            rows, text = [], str(error)
        self._pair_row = min(max(self._pair_row, 0), len(rows) - 1)
        self.pairs.show_list(rows, self._pair_row)
        self.pair_form.setVisible(bool(rows))
        self.pair_message.show_refusal(text, is_wrong=text not in ("", ALONE))
        if rows and (not self.least.pending or not self.least.hasFocus()):
            self.least.show_value(self.clearances.required(self.clearances.pairs[self._pair_row]))

    def _stated(self, pair: Any) -> bool:
        return any(
            {body_named(self._design, text) for text in row.between} == set(pair) for row in self._design.clearances
        )

    # -- by the user ----------------------------------------------------------------------------------------

    def _fill(self) -> None:
        clear_menu(self.menu)
        design = self._design
        for word, drive in possible_bodies(design):
            title = body_title(design, word, drive)
            add_entry(self.menu, title, partial(self.add, word, drive), f"Add an outline of {title}")

    def add(self, word: str, drive: str | None = None) -> None:
        """Add an outline of a body as one undo step, and select it."""
        design = add_outline(self._design, word, drive)
        self._row = len(design.outlines) - 1
        self._put(design, f"Outline of {body_title(design, word, drive)}")

    def _copy(self) -> None:
        order = [*range(len(self._design.outlines))]
        self._reorder([*order[: self._row + 1], *order[self._row :]], "Duplicate")

    def _remove(self) -> None:
        if self._design.outlines:
            self._reorder([i for i in range(len(self._design.outlines)) if i != self._row], "Remove")

    def _reorder(self, order: list[int], verb: str) -> None:
        row = self._design.outlines[self._row]
        self._put(
            with_outline_order(self._design, order),
            f"{verb} an outline of {body_title(self._design, row.of, row.drive)}",
        )

    def _choose(self, row: int) -> None:
        if 0 <= row < len(self._design.outlines):
            self._row = row
            self.message.show_refusal("")
            self._show_form(self._design.outlines[row])

    def _choose_pair(self, row: int) -> None:
        if 0 <= row < len(self.clearances.pairs):
            self._pair_row = row
            self.least.show_value(self.clearances.required(self.clearances.pairs[row]))

    def _show_angle(self, row: int) -> None:
        """Turn the machine to the angle of a pair's least clearance."""
        if 0 <= row < len(self.clearances.pairs):
            self.player.play(False)
            self.player.set_machine(self.clearances.least(self.clearances.pairs[row]).theta)

    def _number_entered(self, name: str, value: float | None) -> None:
        changes: dict[str, Any] = {name: value}
        self._change(**changes)

    def _corners_typed(self) -> None:
        if not self._design.outlines or self.corners.text() == corners_text(self._design.outlines[self._row]):
            return
        points = corners(self.corners.text())
        if points is None:
            self.message.show_refusal("Corners are pairs of numbers in mm: 0, 0; 20, 0; 20, 10")
            return
        self._change(points=points)

    def _choose_file(self) -> None:
        path = file_to_open(self, "Outline from a drawing", "Drawings (*.dxf)")
        if path is not None:
            self.take_file(str(path))

    def take_file(self, path: str) -> None:
        """Take the selected outline from a DXF drawing."""
        home = self.session.path
        folder = os.path.dirname(os.path.abspath(home)) if home else ""
        name = os.path.relpath(path, folder) if folder else os.path.abspath(path)
        self._change(file=name, folder=folder, points=())

    def _change(self, **changes: Any) -> None:
        row = self._row
        outline = replace(self._design.outlines[row], **changes)
        design = with_outline(self._design, row, outline)
        self._put(design, f"Outline of {body_title(design, outline.of, outline.drive)}", f"outlines[{row}]")

    def _least_entered(self, value: float) -> None:
        self._put_clearance(value)

    def _put_clearance(self, value: float | None) -> None:
        if self._design.outlines and self.clearances.pairs:
            pair = self.clearances.pairs[self._pair_row]
            names = " and ".join(self.clearances.texts(pair))
            self._put(with_clearance(self._design, pair, value), f"Clearance of {names}", f"clearances.{names}")

    def _put(self, design: Design, label: str, path: str = "") -> None:
        if wrong := faults(design):
            texts = (f"{name}: {text}" for _, name, text in fault_reasons(design, wrong[:2]))
            self.message.show_refusal(". ".join(texts))
            return
        self.session.put_full_design(design, label, path)

    def focus_field(self, path: str) -> bool:
        """Select the outline, or the pair, of a path such as ``outlines[2].round_mm``; False for other paths."""
        match = re.match(r"(outlines|clearances)\[(\d+)\]", path)
        if match is None:
            return False
        self.pull()
        number = int(match[2])
        if match[1] == "outlines" and number < len(self._design.outlines):
            self.outlines.selectRow(number)
            self.outlines.setFocus()
        return True


def _pair_row(result: LeastClearance, is_stated: bool, least_mm: float) -> TableRow:
    """Row of a pair: names, least clearance with its angle, and what it must keep."""
    names = " – ".join(result.names)
    stated = readable_text(least_mm, "mm") if is_stated else ""
    if result.meets:
        ranges = [(degrees(begin), degrees(end)) for begin, end in result.meets]
        first = short(ranges[0][0], 4)
        return TableRow(
            (names, "meet", f"{first}°", stated), tip=f"They meet at {angle_list(ranges)}", colour=SCREEN.limit
        )
    value = result.value * 1e3
    proven = f"Proven: at least {short(result.at_least * 1e3, 6)} mm over the turn"
    cells = (names, readable_text(value, "mm", 5), f"{short(degrees(result.theta), 4)}°", stated)
    return TableRow(cells, tip=proven, colour=SCREEN.limit if value < least_mm else "")
