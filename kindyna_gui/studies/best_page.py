"""Optimum, tolerances."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from html import escape
from queue import Empty, SimpleQueue
from typing import Any

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QCheckBox, QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.design import Design
from core.errors import KindynaError
from core.numerics.lazy import Cancelled
from core.varying import Optimum, StudyOfMany, ToleranceResult, optimise, remarks
from core.varying.tolerances import SHARE
from kindyna_gui.background import Background
from kindyna_gui.documents.pins import scatters
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import reason
from kindyna_gui.look import bold_label, coloured
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.studies.rows import ToleranceRows, WaveRow
from kindyna_gui.studies.texts import OF, answer_html, label_of, parts_html, tighter_html, value_text

# -- best page -------------------------------------------------------------------------------------------

GOALS = ("Goal", "And")
NONE = ""
SMALL, LARGE = "small", "large"
POLL_MS = 60  # while a search runs
Step = tuple[Mapping[str, Any], float, int]
"""Fields, goal, and number of the start: a place on the path of a search."""


class BestPage(QWidget):
    """A search goes on while the page cannot be seen: it was started by hand, and ends by itself or by *Stop*.

    goals_changed  (dict: key of what is asked -> whether it is made small)
    robust_changed (float or None): the share of machines that must keep the limits
    wanted         the search is to begin
    stepped        the path has grown, or another search begins
    found          an answer is there
    taken (Design) an answer is to be taken over
    """

    goals_changed = Signal(object)  # a dict of Qt would sort its keys
    robust_changed = Signal(object)
    wanted = Signal()
    stepped = Signal()
    found = Signal()
    taken = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.answer: Optimum | None = None
        self.study: StudyOfMany | None = None  # of the search, or of the answer
        self.path: list[Step] = []
        self._told: SimpleQueue[Step] = SimpleQueue()
        self._work = Background(self)
        self._work.result.connect(self._end)
        self._poll = QTimer(self, interval=POLL_MS)
        self._poll.timeout.connect(self._fetch)
        self.ways = [self._word(f"{title}: how", self._choose) for title in GOALS]
        self.goals = [self._word(f"{title}: what", self._choose) for title in GOALS]
        for way in self.ways:
            fill_choices(way, {SMALL: "least", LARGE: "greatest"})
        self.robust = QCheckBox(f"Robust: {100.0 * SHARE:.2f} % of machines within the limits")
        self.robust.toggled.connect(lambda on: self.robust_changed.emit(SHARE if on else None))
        self.start, self.stop, self.take = QPushButton("Find the best"), QPushButton("Stop"), QPushButton("Take over")
        for button in (self.start, self.stop, self.take):
            button.setAutoDefault(False)
        self.start.setToolTip("Search from several starts, beside the window; the path is drawn meanwhile")
        self.take.setToolTip("This design in place of the one at hand, as one step")
        self.start.clicked.connect(self.wanted)
        self.stop.clicked.connect(self._work.cancel)
        self.take.clicked.connect(self._take)
        self.progress, self.told = QLabel(wordWrap=True), QLabel(wordWrap=True)
        self.told.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        grid = QGridLayout()
        grid.setContentsMargins(0, 0, 0, 0)
        for row, title in enumerate(GOALS):
            grid.addWidget(QLabel(title), row, 0)
            grid.addWidget(self.ways[row], row, 1)
            grid.addWidget(self.goals[row], row, 2)
        grid.setColumnStretch(2, 1)
        buttons = QHBoxLayout()
        for button in (self.start, self.stop):
            buttons.addWidget(button)
        buttons.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 6, 6)
        column.setSpacing(8)
        column.addWidget(bold_label("The best design within the limits"))
        column.addLayout(grid)
        column.addWidget(self.robust)
        column.addLayout(buttons)
        column.addWidget(self.progress)
        column.addWidget(self.told)
        column.addWidget(self.take, 0, Qt.AlignmentFlag.AlignLeft)
        column.addStretch(1)
        self._show_state()

    def _word(self, name: str, act: Callable[[int], None]) -> WordBox:
        word = WordBox()
        word.setAccessibleName(name)
        word.activated.connect(act)
        return word

    # -- what is wanted --------------------------------------------------------------------------------------

    def show_goals(
        self, design: Design, asked: Mapping[str, object], goals: Mapping[str, bool], robust: float | None
    ) -> None:
        """What can be a goal, and what is; of what a robust design is."""
        names = {}
        for key in asked:
            slug, _, of = key.partition(":")
            names[key] = label_of(design, slug) + (f", {OF[of]}" if of and of != "abs" else "")
        rows = [*goals.items(), *((NONE, True),) * 2][:2]
        for (key, small), way, word in zip(rows, self.ways, self.goals, strict=True):
            fill_choices(word, {NONE: "–", **names})
            word.setCurrentIndex(word.findData(key))
            way.setCurrentIndex(way.findData(SMALL if small else LARGE))
            way.setEnabled(key != NONE)
        self.robust.blockSignals(True)
        self.robust.setChecked(robust is not None)
        self.robust.blockSignals(False)
        self.robust.setEnabled(bool(design.tolerances) or robust is not None)
        self.robust.setToolTip("" if design.tolerances else "The design has no tolerances yet")
        self._show_state()

    def _choose(self, _: int) -> None:
        rows = zip(self.ways, self.goals, strict=True)
        self.goals_changed.emit(
            {word.currentData(): way.currentData() == SMALL for way, word in rows if word.currentData() != NONE}
        )

    # -- the search ------------------------------------------------------------------------------------------

    def search(self, study: StudyOfMany) -> None:
        """Find the best design of this study, in place of a search that runs."""
        self.answer, self.study, self.path, self._told = None, study, [], SimpleQueue()
        told = self._told
        self._work.start([(study, partial(_searched, study, lambda *step: told.put(step)))])
        self._poll.start()
        self.progress.setText("Designs are spread between the bounds …")
        self.told.setText("")
        self._show_state()
        self.stepped.emit()

    def refuse(self, text: str) -> None:
        """Why it cannot begin."""
        self.progress.setText(text)

    def forget(self) -> None:
        """Another design: nothing is searched for, nor found."""
        self._work.stop()
        self._poll.stop()
        self.answer, self.study, self.path = None, None, []
        self.progress.setText("")
        self.told.setText("")
        self._show_state()
        self.stepped.emit()

    @property
    def busy(self) -> bool:
        return self._work.busy

    def close_work(self) -> None:
        """The window closes."""
        self._poll.stop()
        self._work.close()

    def _fetch(self) -> None:
        """The steps that were told since the last time."""
        before = len(self.path)
        while True:
            try:
                self.path.append(self._told.get_nowait())
            except Empty:
                break
        if len(self.path) > before and self.study is not None:
            _, goal, start = self.path[-1]
            first = self.study.file.goals[0]
            name = label_of(self.study.base, first.quantity)
            self.progress.setText(f"Start {start}, step {len(self.path)}: {name} {value_text(first.key, goal)}")
            self.stepped.emit()

    def _end(self, study: StudyOfMany, found: tuple[Optimum, Sequence[str]] | KindynaError | Cancelled) -> None:
        self._fetch()
        self._poll.stop()
        if isinstance(found, Cancelled):
            self.progress.setText(f"Stopped after {len(self.path)} steps; the design stays as it is.")
        elif isinstance(found, KindynaError):
            self.progress.setText(reason(study.base, found))
        else:
            self.answer, said = found
            self.progress.setText("")
            self.told.setText("<br>".join([answer_html(study.base, study, self.answer), *map(escape, said)]))
        self._show_state()
        self.found.emit()

    def _take(self) -> None:
        if self.answer is not None:
            self.taken.emit(self.answer.design)

    def _show_state(self) -> None:
        self.start.setEnabled(not self.busy)
        self.stop.setVisible(self.busy)
        self.take.setVisible(self.answer is not None and self.answer.is_better)


def _searched(study: StudyOfMany, tell: Callable[..., None]) -> tuple[Optimum, Sequence[str]]:
    """The answer, and what is said beside it."""
    found = optimise(study, tell)
    return found, remarks(study, found)


# -- made page -------------------------------------------------------------------------------------------

NO_TOLERANCE = "Without tolerances every machine is as designed."


class MadePage(QWidget):
    """The form of the tolerances, and what follows from them for what is asked."""

    def __init__(self) -> None:
        super().__init__()
        self.rows, self.waves = ToleranceRows(), WaveRow()
        self.bands = QCheckBox("Bands in the plots")
        self.bands.setToolTip(
            "Over the cam angle: between which values 90 % of 2000 machines lie, and, paler, 99.73 % (percentiles 0.135 … 99.865)"
        )
        self.tighter, self.parts = QLabel(wordWrap=True), QLabel()
        for label in (self.tighter, self.parts):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.note = QLabel(wordWrap=True)
        coloured(self.note, SCREEN.quiet)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 6, 6)
        column.setSpacing(8)
        for part in (self.rows, self.waves, self.bands, self.tighter, self.note, self.parts):
            column.addWidget(part)
        column.addStretch(1)

    def show_design(self, design: Design) -> None:
        """The tolerances of this design."""
        self.rows.show_rows(design)
        self.waves.show_waves(design.waviness)
        self.waves.setVisible(any(drive.cam is not None for drive in design.drives))
        self.bands.setEnabled(scatters(design))

    def show_result(self, design: Design, made: ToleranceResult | None, sought: bool = False) -> None:
        """What follows from them; None: nothing yet. sought: whether it is known which to tighten."""
        few = made is not None and made.share is not None and made.share.value < SHARE
        text = (
            ""
            if not few
            else tighter_html(design, made)
            if sought and made is not None
            else "Which to tighten is sought …"
        )
        self.tighter.setText(text)
        self.tighter.setVisible(bool(text))
        self.parts.setText("" if made is None else parts_html(design, made))
        self.note.setText(
            NO_TOLERANCE
            if not scatters(design)
            else ""
            if made is None
            else "Part of what each quantity scatters, and its change by one unit more:"
        )
        self.note.setVisible(bool(self.note.text()))
