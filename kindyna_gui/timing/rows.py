"""What must come after what on the shaft: the list of distances, and below it the form of the chosen one."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSize, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from core.design import UNITS, Design, TimingRow, entry_at, events, named_event
from kindyna_gui.forms.field_parts import UnitLabel
from kindyna_gui.forms.list_parts import list_button, taken_by_list
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import no_number
from kindyna_gui.look import coloured
from kindyna_gui.note import MessageLabel
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.timing_chart import TimingChart, plain

HEADINGS = (
    TableHeading("First", wide=True),
    TableHeading("then", wide=True),
    TableHeading("after", number=True),
    TableHeading("least", number=True),
)
EMPTY = "Nothing must come after anything yet. Draw from point to point with Shift, or press Add."


class RowsList(RowsTable):
    """The list itself. moved (-1 or 1): Alt+Up, Alt+Down; removed: Delete."""

    moved = Signal(int)
    removed = Signal()

    def __init__(self) -> None:
        super().__init__(HEADINGS)
        self.setWordWrap(False)
        self.setAccessibleName("What must come after what")

    def sizeHint(self) -> QSize:
        return QSize(280, 110)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)


class TimingRows(QWidget):
    """List, buttons and form.

    chosen    (int): a row of the list
    changed   (int, Timing): the form has another row of this number
    finished  the gesture in the form is over
    added     a row more is wanted; reordered (list, int): these rows in this order, of which that one is chosen then
    """

    chosen = Signal(int)
    changed = Signal(int, object)
    finished = Signal()
    added = Signal()
    reordered = Signal(object, int)

    def __init__(self) -> None:
        super().__init__()
        self._design: Design | None = None
        self._row, self._showing, self._note = -1, False, ""
        self.list = RowsList()
        self.first, self.second = WordBox(), WordBox()
        self.first.setAccessibleName("First")
        self.second.setAccessibleName("Then")
        for box in (self.first, self.second):
            box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            box.activated.connect(self._events_chosen)
        self.least: NumberBox | None = None
        self.message = MessageLabel(SCREEN.quiet)
        self.buttons = {
            "add": list_button("Add", "insert", "One distance more", self.added.emit),
            "copy": list_button("Copy", "duplicate", "The chosen one once more", self._copy),
            "remove": list_button("Remove", "delete", "Take the chosen one away (Del)", self._remove),
            "up": list_button("Up", "up", "Further up in the list (Alt+Up)", lambda: self._move(-1)),
            "down": list_button("Down", "down", "Further down in the list (Alt+Down)", lambda: self._move(1)),
        }
        bar = QHBoxLayout()
        bar.setContentsMargins(2, 1, 2, 1)
        bar.setSpacing(0)
        for button in self.buttons.values():
            bar.addWidget(button)
        bar.addStretch(1)
        self._form = QWidget()
        self._grid = QGridLayout(self._form)
        self._grid.setContentsMargins(6, 2, 6, 4)
        self._grid.setVerticalSpacing(3)
        self._grid.setColumnStretch(1, 1)
        for row, (text, box) in enumerate((("First", self.first), ("then", self.second))):
            label = QLabel(text)
            label.setBuddy(box)
            self._grid.addWidget(label, row, 0)
            self._grid.addWidget(box, row, 1, 1, 1 if row else 4)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.list, 1)
        column.addLayout(bar)
        column.addWidget(self._form)
        column.addWidget(self.message)
        self.list.selectionModel().currentRowChanged.connect(lambda index, *_: self._choose(index.row()))
        self.list.moved.connect(self._move)
        self.list.removed.connect(self._remove)

    # -- what is shown --------------------------------------------------------------------------------------

    def show_rows(self, chart: TimingChart, row: int, note: str) -> None:
        """The rows of a chart's design, one of them chosen; note: what is wrong with all of them together."""
        design = self._design = chart.design
        self._row = row
        rows = [
            TableRow(
                (plain(each.first), plain(each.second), chart.text(at.after_deg), chart.text(each.least_deg)),
                tip=""
                if at.kept
                else f"{chart.text(-at.spare_deg)} too early: turn one of the two drives, or change its motion",
                colour="" if at.kept else SCREEN.limit,
            )
            for each, at in zip(design.timing, chart.distances, strict=True)
        ]
        self._showing = True  # what is chosen in the list meanwhile is not the user's choice
        try:
            if [(each.tip, each.colour) for each in rows] == [(each.tip, each.colour) for each in self.list.rows.rows]:
                self.list.update_rows(rows)
            else:
                self.list.show_rows(rows)
            if row < 0:
                self.list.clearSelection()
            elif self.list.currentIndex().row() != row:
                self.list.selectRow(row)
        finally:
            self._showing = False
        there, last = row >= 0, len(rows) - 1
        for name, on in (("copy", there), ("remove", there), ("up", row > 0), ("down", there and row < last)):
            self.buttons[name].setEnabled(on)
        self._form.setVisible(there)
        if there:
            self._show_form(design, row)
        self._note = note
        self._show_note()

    def _show_note(self) -> None:
        """What is to be said of the list as it stands."""
        coloured(self.message, SCREEN.limit if self._note else SCREEN.quiet)
        self.message.show_message(self._note or ("" if self._count else EMPTY))

    def _show_form(self, design: Design, row: int) -> None:
        names = list(events(design))
        for box, event in ((self.first, design.timing[row].first), (self.second, design.timing[row].second)):
            if [box.itemData(i) for i in range(box.count())] != names:
                box.clear()
                for name in names:
                    box.addItem(plain(name), name)
            box.setCurrentIndex(names.index(named_event(design, event)))
        if self.least is None:
            entry = entry_at(design, f"timing[{row}].least_deg")
            assert entry is not None
            self.least = NumberBox(entry.info, UNITS["deg"])
            self.least.setAccessibleName("at least")
            self.least.setMaximumWidth(90)
            self.least.entered.connect(self._least_entered)
            self.least.finished.connect(self.finished)
            self.least.unreadable.connect(self._unreadable)
            self.least.withdrawn.connect(self._show_note)
            label = QLabel("at least")
            label.setBuddy(self.least)
            for column, part in enumerate((label, self.least, UnitLabel(UNITS["deg"])), 2):
                self._grid.addWidget(part, 1, column)
        if not self.least.pending or not self.least.hasFocus():
            self.least.show_value(design.timing[row].least_deg)

    # -- by the user ----------------------------------------------------------------------------------------

    def _choose(self, row: int) -> None:
        if row != self._row and not self._showing:
            self.chosen.emit(row)

    def _events_chosen(self, *_: object) -> None:
        if self._design is not None and self._row >= 0:
            row = replace(
                self._design.timing[self._row], first=self.first.currentData(), second=self.second.currentData()
            )
            self._change(row)
            self.finished.emit()

    def _least_entered(self, value: float) -> None:
        if self._design is not None and self._row >= 0:
            self._change(replace(self._design.timing[self._row], least_deg=value))

    def _change(self, row: TimingRow) -> None:
        self.changed.emit(self._row, row)

    def _unreadable(self) -> None:
        assert self.least is not None
        self.refuse(no_number(self.least.text()))

    def refuse(self, text: str) -> None:
        """What was typed is wrong: it stays, framed in red."""
        if self.least is not None:
            self.least.set_refused(True)
        coloured(self.message, SCREEN.limit)
        self.message.show_message(text)

    def _copy(self) -> None:
        order = [*range(self._count)]
        self.reordered.emit([*order[: self._row + 1], *order[self._row :]], self._row + 1)

    def _remove(self) -> None:
        if self._row >= 0:
            self.reordered.emit([i for i in range(self._count) if i != self._row], min(self._row, self._count - 2))

    def _move(self, by: int) -> None:
        to = self._row + by
        if self._row >= 0 and 0 <= to < self._count:
            order = [i for i in range(self._count) if i != self._row]
            order.insert(to, self._row)
            self.reordered.emit(order, to)

    @property
    def _count(self) -> int:
        return len(self._design.timing) if self._design is not None else 0


__all__ = ["EMPTY", "TimingRows"]
