"""The tabs Best design and Tolerances of the study dock."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from html import escape
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QCheckBox, QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.design import Design
from core.errors import KindynaError
from core.numerics.lazy import Cancelled
from core.varying import Optimum, StudyOfMany, ToleranceResult, optimise, remarks, rounded_optimum
from core.varying.tolerances import SHARE
from kindyna_gui.background import Background
from kindyna_gui.documents.figures import figure_label, label_of
from kindyna_gui.documents.pins import scatters
from kindyna_gui.forms.exact_switch import EXACT, ExactSwitch, takes_exact
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import bold_label, coloured, described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import number
from kindyna_gui.rebuilt import STRETCH, fill
from kindyna_gui.studies.rows import ToleranceRows, WaveRow
from kindyna_gui.studies.texts import numbers_html, optimum_html, parts_html, tighter_html, value_text

GOALS = ("Goal", "And")
NONE = ""
SMALL, LARGE = "small", "large"
POLL_MS = 60  # while a search runs
NO_TOLERANCE = "Without tolerances every machine is as designed."
Step = tuple[Mapping[str, Any], float, int]
"""A point on the path of a search: field -> value, value of the goal, number of the start."""

# -- best design -----------------------------------------------------------------------------------------


class BestPage(QWidget):
    """Goals, the search for the best design, and its result.

    A search continues while the page is hidden; it ends by itself or with *Stop*.

    Signals: ``goals_changed`` (dict of key of a goal to True if it is minimised); ``robust_changed`` (float or
    None), the share of machines that must keep the limits; ``search_requested``; ``stepped``, the path has changed;
    ``finished``; ``take_over`` (Design), apply the result.
    """

    goals_changed = Signal(object)  # a dict of Qt would sort its keys
    robust_changed = Signal(object)
    search_requested = Signal()
    stepped = Signal()
    finished = Signal()
    take_over = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._result: BestDesign | None = None
        self.study: StudyOfMany | None = None  # of the search or its result
        self.path: list[Step] = []
        self._steps: SimpleQueue[Step] = SimpleQueue()
        self._work = Background(self)
        self._work.result.connect(self._end)
        self._poll = QTimer(self, interval=POLL_MS)
        self._poll.timeout.connect(self._fetch)
        self.directions = [self._word(f"{title}: least or greatest", self._choose) for title in GOALS]
        self.goals = [self._word(f"{title}: quantity", self._choose) for title in GOALS]
        for direction in self.directions:
            fill_choices(direction, {SMALL: "least", LARGE: "greatest"})
        self.robust = QCheckBox(f"Robust: {number(100.0 * SHARE, 2)} % of machines within the limits")
        self.robust.toggled.connect(lambda on: self.robust_changed.emit(SHARE if on else None))
        self.start, self.stop, self.take = QPushButton("Find the best"), QPushButton("Stop"), QPushButton("Take over")
        self.exact = ExactSwitch()
        for button in (self.start, self.stop, self.take):
            button.setAutoDefault(False)
        self.start.setToolTip("Search from several starts in the background; the path of the search is drawn")
        self.take.setToolTip("Use this design (one undo step)")
        self.start.clicked.connect(self.search_requested)
        self.stop.clicked.connect(self._work.cancel)
        self.take.clicked.connect(self._take_over)
        self.progress, self.result_text = QLabel(wordWrap=True), QLabel(wordWrap=True)
        self.result_text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        grid = fill(QGridLayout(), margins=0)
        for row, title in enumerate(GOALS):
            grid.addWidget(QLabel(title), row, 0)
            grid.addWidget(self.directions[row], row, 1)
            grid.addWidget(self.goals[row], row, 2)
        grid.setColumnStretch(2, 1)
        buttons = fill(QHBoxLayout(), self.start, self.stop, STRETCH)
        fill(
            QVBoxLayout(self),
            bold_label("The best design within the limits"),
            grid,
            self.robust,
            buttons,
            self.progress,
            self.result_text,
            fill(QHBoxLayout(), self.take, self.exact, STRETCH),
            STRETCH,
            margins=(8, 6, 6, 6),
            spacing=8,
        )
        EXACT.changed.connect(self._show_result)
        self._show_state()

    def _word(self, name: str, act: Callable[[int], None]) -> WordBox:
        word = described(WordBox(), name=name)
        word.activated.connect(act)
        return word

    # -- goals ----------------------------------------------------------------------------------------------

    def show_goals(
        self, design: Design, figures: Iterable[str], goals: Mapping[str, bool], robust: float | None
    ) -> None:
        """Offer figures and varied numbers of a design as goals; show the goals, and the share of machines for a robust design."""
        names = {key: figure_label(design, key) for key in figures}
        rows = [*goals.items(), *((NONE, True),) * 2][:2]
        for (key, is_minimised), direction, word in zip(rows, self.directions, self.goals, strict=True):
            fill_choices(word, {NONE: "–", **names})
            word.setCurrentIndex(word.findData(key))
            direction.setCurrentIndex(direction.findData(SMALL if is_minimised else LARGE))
            direction.setEnabled(key != NONE)
        self.robust.blockSignals(True)
        self.robust.setChecked(robust is not None)
        self.robust.blockSignals(False)
        self.robust.setEnabled(bool(design.tolerances) or robust is not None)
        self.robust.setToolTip("" if design.tolerances else "Enter a tolerance first")
        self._show_state()

    def _choose(self, _: int) -> None:
        rows = [(word.currentData(), direction) for word, direction in zip(self.goals, self.directions, strict=True)]
        self.goals_changed.emit({key: direction.currentData() == SMALL for key, direction in rows if key != NONE})

    # -- search ---------------------------------------------------------------------------------------------

    def search(self, study: StudyOfMany) -> None:
        """Search for the best design of a study; a running search is stopped."""
        self.clear()
        self.study, self._steps = study, SimpleQueue()
        steps = self._steps
        self._work.start([(study, partial(_optimise, study, lambda *step: steps.put(step)))])
        self._poll.start()
        self.progress.setText("Computing designs between the bounds …")
        self._show_state()

    def refuse(self, text: str) -> None:
        """Show why the search cannot start."""
        self.progress.setText(text)

    def clear(self) -> None:
        """Stop the search and remove its result."""
        self._work.stop()
        self._poll.stop()
        self._result, self.study, self.path = None, None, []
        self.progress.setText("")
        self.result_text.setText("")
        self._show_state()
        self.stepped.emit()

    @property
    def busy(self) -> bool:
        """Whether a search runs."""
        return self._work.busy

    def close_work(self) -> None:
        """Stop for good."""
        self._poll.stop()
        self._work.close()

    def _fetch(self) -> None:
        """Show the steps since the last call."""
        before = len(self.path)
        while True:
            try:
                self.path.append(self._steps.get_nowait())
            except Empty:
                break
        if len(self.path) > before and self.study is not None:
            _, goal, start = self.path[-1]
            first = self.study.file.goals[0]
            name = label_of(self.study.base, first.field or first.quantity)
            self.progress.setText(f"Start {start}, step {len(self.path)}: {name} {value_text(first.key, goal)}")
            self.stepped.emit()

    @property
    def optimum(self) -> Optimum | None:
        """The best design, with rounded numbers unless *Exact* is on; None where there is none."""
        result = self._result
        return None if result is None else result.optimum if takes_exact() else result.rounded

    def _end(self, study: StudyOfMany, result: BestDesign | KindynaError | Cancelled) -> None:
        self._fetch()
        self._poll.stop()
        if isinstance(result, Cancelled):
            self.progress.setText(f"Stopped after {len(self.path)} steps; the design does not change.")
        elif isinstance(result, KindynaError):
            self.progress.setText(reason(study.base, result))
        else:
            self._result = result
            self.progress.setText("")
            self._show_result()
        self._show_state()
        self.finished.emit()

    def _show_result(self) -> None:
        if self._result is not None and self.study is not None and self.optimum is not None:
            design, optimum = self.study.base, self.optimum
            notes = [*self._result.notes, *([sentence(optimum.note)] if optimum.note else [])]
            lines = [optimum_html(design, self.study, optimum), *map(escape, notes)]
            self.result_text.setText("<br>".join(lines) + numbers_html(design, optimum))

    def _take_over(self) -> None:
        if self.optimum is not None:
            self.take_over.emit(self.optimum.design)

    def _show_state(self) -> None:
        self.start.setEnabled(not self.busy)
        self.stop.setVisible(self.busy)
        for part in (self.take, self.exact):
            part.setVisible(self.optimum is not None and self.optimum.is_better)


class BestDesign(NamedTuple):
    """Result of a search: the best design, the same with rounded numbers, and remarks."""

    optimum: Optimum
    rounded: Optimum
    notes: Sequence[str]


def _optimise(study: StudyOfMany, report_step: Callable[..., None]) -> BestDesign:
    optimum = optimise(study, report_step)
    return BestDesign(optimum, rounded_optimum(study, optimum), remarks(study, optimum))


# -- tolerances ------------------------------------------------------------------------------------------


class TolerancePage(QWidget):
    """Form of the tolerances, with their effect on the requested figures."""

    def __init__(self) -> None:
        super().__init__()
        self.rows, self.waves = ToleranceRows(), WaveRow()
        self.bands = described(
            QCheckBox("Bands in the plots"),
            tip="Over the cam angle: the range of 90 % of 2000 machines, and paler that of 99.73 % (percentiles 0.135 … 99.865)",
        )
        self.tighter, self.parts = QLabel(wordWrap=True), QLabel()
        for label in (self.tighter, self.parts):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.note = coloured(QLabel(wordWrap=True), SCREEN.quiet)
        fill(
            QVBoxLayout(self),
            self.rows,
            self.waves,
            self.bands,
            self.tighter,
            self.note,
            self.parts,
            STRETCH,
            margins=(8, 6, 6, 6),
            spacing=8,
        )

    def show_design(self, design: Design) -> None:
        """Show the tolerances of a design."""
        self.rows.show_rows(design)
        self.waves.show_waves(design.waviness)
        self.waves.setVisible(any(drive.has_disk for drive in design.drives))
        self.bands.setEnabled(scatters(design))

    def show_result(self, design: Design, result: ToleranceResult | None, has_tighter: bool = False) -> None:
        """Show the effect of the tolerances, None if there is none; has_tighter: the tolerances to tighten are computed."""
        text = ""
        if result is not None and result.share is not None and result.share.value < SHARE:
            text = tighter_html(design, result) if has_tighter else "Calculating which tolerance to tighten …"
        self.tighter.setText(text)
        self.tighter.setVisible(bool(text))
        self.parts.setText("" if result is None else parts_html(design, result))
        if not scatters(design):
            self.note.setText(NO_TOLERANCE)
        else:
            note = "Part of the scatter of each quantity, and change of the quantity per unit:"
            self.note.setText("" if result is None else note)
        self.note.setVisible(bool(self.note.text()))
