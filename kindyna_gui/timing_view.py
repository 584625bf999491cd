"""View of the timing of several drives: chart, list of sequence conditions, and form of the selected condition."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import partial
from math import degrees, fsum, radians
from typing import TYPE_CHECKING

from PySide6.QtCore import QPoint, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QComboBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QSizePolicy,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from core.design import (
    UNITS,
    Design,
    TimingRow,
    contradiction,
    drive_names,
    entry_at,
    events,
    excess,
    named_event,
    reorder_timing,
    together,
    with_timing,
)
from core.errors import KindynaError
from core.study import Study
from kindyna_gui.background import Background
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import UnitLabel
from kindyna_gui.forms.load_rows import list_button, row_of_buttons, taken_by_list
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.forms.refusal import RefusalLine, accept_in_range
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import name_of
from kindyna_gui.look import described, scrolled
from kindyna_gui.pictures.paper.timing_chart import (
    CRANK,
    DEGREES,
    MILLISECONDS,
    ForbiddenSpan,
    TimingChart,
    event_text,
)
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import connect_all, fill, widget_with
from kindyna_gui.timing_canvas import TimingCanvas
from kindyna_gui.view import View

if TYPE_CHECKING:
    from core.study.clearances import Clearances

# -- list of sequence conditions -------------------------------------------------------------------------

HEADINGS = (
    TableHeading("First", wide=True),
    TableHeading("then", wide=True),
    TableHeading("after", number=True),
    TableHeading("least", number=True),
)
EMPTY = "No sequence conditions yet. Shift-drag from one event to another, or press Add."


class RowsList(RowsTable):
    """Table of the conditions. Signals: moved (-1 or 1) for Alt+Up and Alt+Down, removed for Delete."""

    moved = Signal(int)
    removed = Signal()

    def __init__(self) -> None:
        super().__init__(HEADINGS)
        self.setWordWrap(False)
        self.setAccessibleName("Sequence conditions")

    def sizeHint(self) -> QSize:
        return QSize(280, 110)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)


class TimingRows(QWidget):
    """Table of the sequence conditions with buttons, and the form of the selected one.

    - chosen (int): a row was selected
    - changed (int, TimingRow): the form has changed this row
    - finished: the input in the form is complete
    - added: the user adds a row
    - reordered (list, int): new order of the rows, and the row to select then
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
        self.message = RefusalLine()
        self.buttons = {
            "add": list_button("Add", "insert", "Add a sequence condition", self.added.emit),
            "copy": list_button("Copy", "duplicate", "Duplicate the selected condition", self._copy),
            "remove": list_button("Remove", "delete", "Remove the selected condition (Del)", self._remove),
            "up": list_button("Up", "up", "Move up (Alt+Up)", lambda: self._move(-1)),
            "down": list_button("Down", "down", "Move down (Alt+Down)", lambda: self._move(1)),
        }
        self._form = QWidget()
        self._grid = fill(QGridLayout(self._form), margins=(6, 2, 6, 4))
        self._grid.setVerticalSpacing(3)
        self._grid.setColumnStretch(1, 1)
        for row, (text, box) in enumerate((("First", self.first), ("then", self.second))):
            label = QLabel(text)
            label.setBuddy(box)
            self._grid.addWidget(label, row, 0)
            self._grid.addWidget(box, row, 1, 1, 1 if row else 4)
        fill(
            QVBoxLayout(self),
            (self.list, 1),
            row_of_buttons(self.buttons.values(), above=1),
            self._form,
            self.message,
            margins=0,
            spacing=0,
        )
        self.list.selectionModel().currentRowChanged.connect(lambda index, *_: self._choose(index.row()))
        self.list.moved.connect(self._move)
        self.list.removed.connect(self._remove)

    # -- content --------------------------------------------------------------------------------------------

    def show_rows(self, chart: TimingChart, row: int, note: str) -> None:
        """Show the conditions of a chart's design and select one; ``note``: a contradiction among them."""
        design = self._design = chart.design
        self._row = row
        rows = [
            TableRow(
                (
                    event_text(condition.first),
                    event_text(condition.second),
                    chart.text(at.after_deg),
                    chart.text(condition.least_deg),
                ),
                tip=""
                if at.kept
                else f"{chart.text(-at.spare_deg)} too early: change the phase or the motion of one of the two",
                colour="" if at.kept else SCREEN.limit,
            )
            for condition, at in zip(design.timing, chart.distances, strict=True)
        ]
        self._showing = True  # selections from here on are not by the user
        try:
            if [(new.tip, new.colour) for new in rows] == [(old.tip, old.colour) for old in self.list.rows.rows]:
                self.list.update_rows(rows)
            else:
                self.list.show_rows(rows)
            if row < 0:
                self.list.clearSelection()
            elif self.list.currentIndex().row() != row:
                self.list.selectRow(row)
        finally:
            self._showing = False
        is_selected, last = row >= 0, len(rows) - 1
        self.buttons["copy"].setEnabled(is_selected)
        self.buttons["remove"].setEnabled(is_selected)
        self.buttons["up"].setEnabled(row > 0)
        self.buttons["down"].setEnabled(is_selected and row < last)
        self._form.setVisible(is_selected)
        if is_selected:
            self._show_form(design, row)
        self._note = note
        self._show_note()

    def _show_note(self) -> None:
        """Show the note on the list, or how to add the first condition."""
        text = self._note or ("" if self._count else EMPTY)
        self.message.show_refusal(text, is_wrong=bool(self._note))

    def _show_form(self, design: Design, row: int) -> None:
        names = list(events(design))
        for box, event in ((self.first, design.timing[row].first), (self.second, design.timing[row].second)):
            if [box.itemData(i) for i in range(box.count())] != names:
                box.clear()
                for name in names:
                    box.addItem(event_text(name), name)
            box.setCurrentIndex(names.index(named_event(design, event)))
        if self.least is None:
            entry = entry_at(design, f"timing[{row}].least_deg")
            assert entry is not None
            self.least = described(NumberBox(entry.info, UNITS["deg"]), name="at least")
            self.least.setMaximumWidth(90)
            accept_in_range(self.least, self.message, self._least_entered)
            connect_all((self.least.finished, self.finished), (self.least.withdrawn, self._show_note))
            label = QLabel("at least")
            label.setBuddy(self.least)
            for column, part in enumerate((label, self.least, UnitLabel(UNITS["deg"])), 2):
                self._grid.addWidget(part, 1, column)
        if not self.least.pending or not self.least.hasFocus():
            self.least.show_value(design.timing[row].least_deg)

    # -- input ----------------------------------------------------------------------------------------------

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


# -- forbidden spans ----------------------------------------------------------------------------------------


def forbidden_spans(clearances: Clearances) -> tuple[ForbiddenSpan, ...]:
    """Return the machine angles in which bodies of drives meet, or are nearer than they must be; none without a solution."""
    spans: list[ForbiddenSpan] = []
    with suppress(KindynaError):  # the findings report it
        for pair in clearances.pairs:
            drives = tuple(sorted({body.drive for body in pair if body.drive is not None}))
            names = " – ".join(clearances.texts(pair))
            for begin, end in clearances.too_near(pair) if drives else ():
                first, last = degrees(begin), degrees(end)
                spans.append(ForbiddenSpan(drives, first, last if first <= last else last + 360.0, names))
    return tuple(spans)


# -- timing view -----------------------------------------------------------------------------------------

LIST_WIDTH = 320
PATH = "timing"


class TimingView(View):
    """Chart and list of conditions for all drives; each drag, typed value and row is an undo step."""

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.pins = Pins.of(session)
        self.pins.changed.connect(self.invalidate)
        self.canvas = TimingCanvas(self._put)
        self._content_key: tuple[TimingChart, int, bool] | None = None
        self.rows = TimingRows()
        self._fields = Background(self)
        self._fields.result.connect(self._show_forbidden)
        self.unit = QComboBox()
        for key, text in ((DEGREES, "degrees"), (MILLISECONDS, "milliseconds")):
            self.unit.addItem(text, key)
        self.unit.setAccessibleName("Axis")
        self.pair = (QComboBox(), QComboBox())
        for number, box in enumerate(self.pair, 1):
            box.setAccessibleName(f"Drive {number} of the overlap")
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(5)
            box.activated.connect(self._choose_pair)
        self.overlap = QLabel()
        self.overlap.setMinimumWidth(1)
        label = QLabel("Axis")
        label.setBuddy(self.unit)
        self._overlap_label = QLabel("Overlap of")
        self._overlap_label.setBuddy(self.pair[0])
        bar = widget_with(
            fill(
                QHBoxLayout(),
                label,
                self.unit,
                self._overlap_label,
                *self.pair,
                (self.overlap, 1),
                margins=(6, 2, 6, 2),
            )
        )
        left = widget_with(fill(QVBoxLayout(), bar, (scrolled(self.canvas), 1), margins=0, spacing=0))
        self.splitter = QSplitter(Qt.Orientation.Horizontal)
        self.splitter.addWidget(left)
        self.splitter.addWidget(self.rows)
        self.splitter.setStretchFactor(0, 1)
        self.splitter.setChildrenCollapsible(False)
        self.splitter.setSizes([3 * LIST_WIDTH, LIST_WIDTH])
        self.set_column(self.splitter, grows=self.splitter)
        self.canvas.setToolTip(TimingChart.how)
        self._connect()

    def _connect(self) -> None:
        self.unit.activated.connect(self._choose_unit)
        canvas, rows = self.canvas, self.rows
        connect_all(
            (canvas.drag_started, self._begin_drag),
            (canvas.drag_ended, self._end_drag),
            (canvas.drive_chosen, self.session.choose_drive),
            (canvas.row_chosen, self._choose_row),
            (canvas.condition_drawn, self._add_between),
            (canvas.angle_chosen, self._set_angle),
            (canvas.menu_requested, self._open_menu),
            (rows.chosen, self._choose_row),
            (rows.changed, self._change_row),
            (rows.finished, self.session.end_gesture),
            (rows.added, self._add),
            (rows.reordered, self._reorder),
            (self.session.started, canvas.forget),
            (self.session.restored, canvas.drop),
        )

    # -- from the session -----------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        design, canvas = self._design, self.canvas
        canvas.chosen = self.session.chosen if self.session.has_several_drives else -1
        canvas.row = min(canvas.row, len(design.timing) - 1)
        self._offer_crank(design)
        canvas.show_design(design, self.pins.named_design)
        self._search_forbidden(design)
        content = canvas.chart, canvas.row, canvas.chosen < 0
        if content == self._content_key:
            return
        self._content_key = content
        self._show_parts()
        self._show_pair()
        self._show_rows()

    def _search_forbidden(self, design: Design) -> None:
        """Search in the background for spans in which bodies of drives are too near."""
        if not (design.outlines and design.listed):
            self._fields.stop()
            self.canvas.forbidden = ()
            return
        clearances = self.session.full_study.clearances
        self._fields.start([(design, partial(forbidden_spans, clearances))])

    def _show_forbidden(self, design: object, spans: object) -> None:
        if design is self._design and isinstance(spans, tuple):
            self.canvas.forbidden = spans
            self.canvas.update()

    @property
    def busy(self) -> bool:
        return super().busy or self._fields.busy

    def leave(self) -> None:
        super().leave()
        self._fields.close()

    def _offer_crank(self, design: Design) -> None:
        """List crank degrees for an engine with valves; without them return to degrees."""
        index = self.unit.findData(CRANK)
        if design.has_valves and index < 0:
            self.unit.addItem("crank degrees", CRANK)
        elif index >= 0 and not design.has_valves:
            if self.canvas.unit == CRANK:
                self.unit.setCurrentIndex(self.unit.findData(DEGREES))
                self.canvas.set_unit(DEGREES)
            self.unit.removeItem(index)

    def _show_parts(self) -> None:
        """Show the conditions and the overlap of two drives where there are several, not over the crank."""
        is_shown = self.canvas.chosen >= 0 and self.canvas.unit != CRANK
        for part in (self.rows, self._overlap_label, *self.pair, self.overlap):
            part.setVisible(is_shown)

    def follow(self, theta: float) -> None:
        self.canvas.machine = degrees(self.player.machine)
        self.canvas.update()

    @property
    def _design(self) -> Design:
        design: Design = self.session.full_design
        return design

    def _show_rows(self) -> None:
        self.rows.show_rows(self.canvas.chart, self.canvas.row, self._contradiction())

    def _contradiction(self) -> str:
        """Message where no phases satisfy all conditions in the present order of events; else empty."""
        rows = contradiction(self._design)
        if not rows:
            return ""
        numbers = ", ".join(str(i + 1) for i in sorted(rows))
        more = short(excess(self._design, rows), 4)
        return (
            f"No phases satisfy conditions {numbers} together in this order of events: they require {more}° more than "
            "a turn has. Reduce one of their distances, or lengthen a dwell."
        )

    def _show_pair(self) -> None:
        names = ("(none)", *drive_names(self._design))
        for box in self.pair:
            if [box.itemText(i) for i in range(box.count())] != list(names):
                index = min(box.currentIndex(), len(names) - 1)
                with QSignalBlocker(box):
                    box.clear()
                    box.addItems(list(names))
                    box.setCurrentIndex(max(index, 0))
        pair = tuple(box.currentIndex() - 1 for box in self.pair)
        self.canvas.pair = pair if min(pair) >= 0 and pair[0] != pair[1] else ()
        text = ""
        if self.canvas.pair:
            overlap = fsum(end - begin for begin, end in together(self._design, *self.canvas.pair))
            text = self.canvas.chart.degrees_and_ms(round(overlap, 9)) if overlap else "never"
        self.overlap.setText(text)

    # -- input ----------------------------------------------------------------------------------------------

    def _put(self, design: Design, label: str, path: str) -> bool:
        """Put a design of all drives as one undo step."""
        return self.session.put_full_design(design, label, path)

    def _begin_drag(self) -> None:
        self.session.end_gesture()
        self.session.begin_drag(self)

    def _end_drag(self, is_cancelled: bool) -> None:
        self.session.end_gesture()
        self.session.end_drag()

    def _choose_unit(self) -> None:
        self.canvas.set_unit(self.unit.currentData())
        self._show_parts()
        self._show_rows()

    def set_unit(self, unit: str) -> None:
        """Set the unit of the axis: degrees, milliseconds, or crank degrees."""
        self.unit.setCurrentIndex(self.unit.findData(unit))
        self._choose_unit()

    def _choose_pair(self) -> None:
        self._show_pair()
        self.canvas.update()

    def _choose_row(self, row: int) -> None:
        self.canvas.row = row
        self.canvas.update()
        self._show_rows()

    def _set_angle(self, angle: float) -> None:
        self.player.play(False)
        self.player.set_machine(radians(angle))

    def _open_menu(self, path: str, on_screen: QPoint) -> None:
        from kindyna_gui.touch_targets import MouseTarget, open_menu

        if self._host is not None:
            open_menu(MouseTarget(name_of(self._design, path), path) if path else None, self, self._host, on_screen)

    def _one_step(self, design: Design, label: str, row: int) -> None:
        with self.session.one_step():
            if self._put(design, label, ""):
                self._choose_row(row)

    def _add_between(self, first: str, second: str) -> None:
        row = TimingRow(first, second, 0.0)
        self._one_step(
            with_timing(self._design, len(self._design.timing), row),
            f"Let {event_text(second)} follow {event_text(first)}",
            len(self._design.timing),
        )

    def _add(self) -> None:
        """Add a condition: the next event of another drive after the first end of the selected drive."""
        at = events(self._design)
        name = drive_names(self._design)[min(max(self.canvas.chosen, 0), len(self._design.drives) - 1)]
        first = next(
            (event for event in at if event.startswith(f"{name}.") and event.endswith(".end")), next(iter(at), "")
        )
        others = [event for event in at if not event.startswith(f"{name}.")] or list(at)
        if first and others:
            self._add_between(first, min(others, key=lambda event: (at[event] - at[first]) % 360.0))

    def _change_row(self, number: int, row: TimingRow) -> None:
        label = f"Let {event_text(row.second)} follow {event_text(row.first)} by {short(row.least_deg)}°"
        self._put(with_timing(self._design, number, row), label, f"{PATH}[{number}]")

    def _reorder(self, order: list[int], row: int) -> None:
        count = len(self._design.timing)
        word = "Remove" if len(order) < count else "Duplicate" if len(order) > count else "Move"
        self._one_step(reorder_timing(self._design, order), f"{word} a sequence condition", row)

    def focus_field(self, path: str) -> bool:
        """Select the row of a path such as ``timing[2]``; False for other paths."""
        number = path.removeprefix(f"{PATH}[").partition("]")[0]
        if not path.startswith(f"{PATH}[") or not number.isdecimal():
            return False
        self.pull()
        if int(number) < len(self._design.timing):
            self._choose_row(int(number))
            self.rows.list.setFocus()
        return True

    # -- as a picture ---------------------------------------------------------------------------------------

    def picture(self, ending: str) -> bytes:
        from kindyna_gui.pictures.paper.timing_page import timing_file

        return timing_file(self._design, ending, self.canvas.unit, self.canvas.pair, self.pins.named_design)
