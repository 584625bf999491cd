"""The timing chart as a view: chart, what its axis counts in, which two drives may not move together, and the list of distances."""

from __future__ import annotations

from math import degrees, fsum, radians

from PySide6.QtCore import QPoint, QSignalBlocker, Qt
from PySide6.QtWidgets import QComboBox, QFrame, QHBoxLayout, QLabel, QScrollArea, QSplitter, QVBoxLayout, QWidget

from core.design import (
    Design,
    TimingRow,
    contradiction,
    drive_names,
    events,
    excess,
    reorder_timing,
    together,
    with_timing,
)
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import name_of
from kindyna_gui.pictures.timing_chart import DEGREES, MILLISECONDS, TimingChart, plain
from kindyna_gui.pictures.units import short
from kindyna_gui.player import Player
from kindyna_gui.timing.canvas import HOW, TimingCanvas
from kindyna_gui.timing.rows import TimingRows
from kindyna_gui.view import View

LIST_WIDTH = 320
PATH = "timing"


class TimingView(View):
    """Chart and list over the session's whole shaft. Each drag, each typed value, each row is a step of the undo stack."""

    of_whole = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.canvas = TimingCanvas(self._put)
        self._rows_of: tuple[TimingChart, int, bool] | None = None
        self.rows = TimingRows()
        self.unit = QComboBox()
        for key, text in ((DEGREES, "degrees"), (MILLISECONDS, "milliseconds")):
            self.unit.addItem(text, key)
        self.unit.setAccessibleName("Axis")
        self.pair = (QComboBox(), QComboBox())
        for number, box in enumerate(self.pair, 1):
            box.setAccessibleName(f"Drive {number} that may move at the same time")
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(5)
            box.activated.connect(self._choose_pair)
        self.overlap = QLabel()
        self.overlap.setMinimumWidth(1)
        bar = QWidget()
        line = QHBoxLayout(bar)
        line.setContentsMargins(6, 2, 6, 2)
        label = QLabel("Axis")
        label.setBuddy(self.unit)
        self._both = QLabel("Both move")
        self._both.setBuddy(self.pair[0])
        for part in (label, self.unit, self._both, *self.pair):
            line.addWidget(part)
        line.addWidget(self.overlap, 1)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(bar)
        scroll = QScrollArea(widgetResizable=True)  # where there are many drives
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scroll.setWidget(self.canvas)
        column.addWidget(scroll, 1)
        self.splitter = QSplitter(Qt.Orientation.Horizontal)
        self.splitter.addWidget(left)
        self.splitter.addWidget(self.rows)
        self.splitter.setStretchFactor(0, 1)
        self.splitter.setChildrenCollapsible(False)
        self.splitter.setSizes([3 * LIST_WIDTH, LIST_WIDTH])
        self.set_column(self.splitter, grows=self.splitter)
        self.canvas.setToolTip(HOW)
        self._connect()

    def _connect(self) -> None:
        self.unit.activated.connect(self._choose_unit)
        canvas, rows = self.canvas, self.rows
        canvas.taken.connect(self._take)
        canvas.let_go.connect(self._let_go)
        canvas.drive_chosen.connect(self.session.choose_drive)
        canvas.row_chosen.connect(self._choose_row)
        canvas.row_wanted.connect(self._add_between)
        canvas.angle_wanted.connect(self._go)
        canvas.asked.connect(self._open_menu)
        rows.chosen.connect(self._choose_row)
        rows.changed.connect(self._change_row)
        rows.finished.connect(self.session.end_gesture)
        rows.added.connect(self._add)
        rows.reordered.connect(self._reorder)
        self.session.started.connect(canvas.forget)
        self.session.restored.connect(canvas.void)

    # -- from the session -----------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        whole, canvas = self._whole, self.canvas
        canvas.chosen = self.session.chosen if self.session.several else -1
        canvas.row = min(canvas.row, len(whole.timing) - 1)
        canvas.show_design(whole)
        of = canvas.chart, canvas.row, canvas.chosen < 0
        if of == self._rows_of:  # nothing that stands here has changed
            return
        self._rows_of = of
        for part in (self.rows, self._both, *self.pair, self.overlap):
            part.setVisible(canvas.chosen >= 0)
        self._show_pair()
        self._show_rows()

    def follow(self, theta: float) -> None:
        self.canvas.machine = degrees(self.player.machine)
        self.canvas.update()

    @property
    def _whole(self) -> Design:
        whole: Design = self.session.whole
        return whole

    def _show_rows(self) -> None:
        self.rows.show_rows(self.canvas.chart, self.canvas.row, self._contradiction())

    def _contradiction(self) -> str:
        """Which rows no phases keep together, in the order in which their events come now."""
        ring = contradiction(self._whole)
        if not ring:
            return ""
        numbers = ", ".join(str(i + 1) for i in sorted(ring))
        more = short(excess(self._whole, ring), 4)
        return f"In their order no phases keep rows {numbers} together: they ask for {more}° too much. Lessen one, or lengthen a dwell."

    def _show_pair(self) -> None:
        names = ("nothing", *drive_names(self._whole))
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
            both = fsum(end - begin for begin, end in together(self._whole, *self.canvas.pair))
            text = self.canvas.chart.both(round(both, 9)) if both else "never"
        self.overlap.setText(text)

    # -- by the user ----------------------------------------------------------------------------------------

    def _put(self, design: Design, label: str, path: str) -> bool:
        """One step, of all drives."""
        return self.session.put_whole(design, label, path)

    def _take(self) -> None:
        self.session.end_gesture()
        self.session.take_hold(self)

    def _let_go(self, back: bool) -> None:
        self.session.end_gesture()
        self.session.release()

    def _choose_unit(self) -> None:
        self.canvas.set_unit(self.unit.currentData())
        self._show_rows()

    def set_unit(self, unit: str) -> None:
        """Let the axis count in degrees or in milliseconds."""
        self.unit.setCurrentIndex(self.unit.findData(unit))
        self._choose_unit()

    def _choose_pair(self) -> None:
        self._show_pair()
        self.canvas.update()

    def _choose_row(self, row: int) -> None:
        self.canvas.row = row
        self.canvas.update()
        self._show_rows()

    def _go(self, angle: float) -> None:
        self.player.play(False)
        self.player.set_machine(radians(angle))

    def _open_menu(self, path: str, on_screen: QPoint) -> None:
        from kindyna_gui.touched import Thing, open_menu

        if self._host is not None:
            open_menu(Thing(name_of(self._whole, path), path) if path else None, self, self._host, on_screen)

    def _one_step(self, design: Design, label: str, row: int) -> None:
        self.session.end_gesture()
        if self._put(design, label, ""):
            self._choose_row(row)
        self.session.end_gesture()

    def _add_between(self, first: str, second: str) -> None:
        row = TimingRow(first, second, 0.0)
        self._one_step(
            with_timing(self._whole, len(self._whole.timing), row),
            f"Let {plain(second)} follow {plain(first)}",
            len(self._whole.timing),
        )

    def _add(self) -> None:
        """What follows the end of the chosen drive's first movement on another drive, until it is chosen otherwise."""
        at = events(self._whole)
        name = drive_names(self._whole)[min(max(self.canvas.chosen, 0), len(self._whole.drives) - 1)]
        first = next(
            (event for event in at if event.startswith(f"{name}.") and event.endswith(".end")), next(iter(at), "")
        )
        others = [event for event in at if not event.startswith(f"{name}.")] or list(at)
        if first and others:
            self._add_between(first, min(others, key=lambda event: (at[event] - at[first]) % 360.0))

    def _change_row(self, number: int, row: TimingRow) -> None:
        label = f"Let {plain(row.second)} follow {plain(row.first)} by {short(row.least_deg)}°"
        if not self._put(with_timing(self._whole, number, row), label, f"{PATH}[{number}]"):
            self.rows.refuse("allowed: -360 ... 360°")
            self.session.withdraw(f"{PATH}[{number}]")

    def _reorder(self, order: list[int], row: int) -> None:
        count = len(self._whole.timing)
        word = "Remove" if len(order) < count else "Copy" if len(order) > count else "Move"
        self._one_step(reorder_timing(self._whole, order), f"{word} a distance of the timing", row)

    def focus_field(self, path: str) -> bool:
        """Choose the row of a path ``timing[2]``; False where it is none."""
        number = path.removeprefix(f"{PATH}[").partition("]")[0]
        if not path.startswith(f"{PATH}[") or not number.isdecimal():
            return False
        self.pull()
        if int(number) < len(self._whole.timing):
            self._choose_row(int(number))
            self.rows.list.setFocus()
        return True

    # -- as a picture ---------------------------------------------------------------------------------------

    def picture(self, ending: str) -> bytes:
        from kindyna_gui.pictures.timing_file import timing_file

        return timing_file(self._whole, ending, self.canvas.unit, self.canvas.pair)


__all__ = ["TimingView"]
