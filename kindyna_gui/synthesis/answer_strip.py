"""The linkages that are proposed for a task, as cards under the drawing: their figures, their small moving images, *Take over*."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.design import Design
from core.frozen import frozen
from core.synthesis import FOUR_BAR, INVERTED, SLIDER_CRANK, Answer, Synthesis, Task, synthesise
from core.synthesis.judge import is_same, joint_positions
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.look import described
from kindyna_gui.pictures.units import brief, readable_text, short
from kindyna_gui.rebuilt import STRETCH, connect_all, fill, single_shot, widget_with
from kindyna_gui.studies.board import Board, Card, card_height
from kindyna_gui.synthesis.sheet_painting import AnswerPicture, Positions
from kindyna_gui.synthesis.task_form import BOUNDED

FRAME_MS, STEPS = 40, 120
KINDS = FOUR_BAR, SLIDER_CRANK, INVERTED
CARD_VALUES = 5  # on a card
MARGINS = (6, 2, 6, 4)  # around the cards, pixels
EMPTY = "The linkages for the task appear here as cards"
CHOSEN = "chosen dyads"
TAKE_OVER = (
    "Make the selected linkage the design, as one undo step, with the loads that fit it; a driver that cannot turn fully follows a motion "
    "from the first pose to the last"
)
UNDER_MOTION = (
    "Let the present motion drive the selected linkage, as one undo step: its lowest position is the first pose of the task, its highest "
    "one the last"
)
FAINT_MS = 300  # from the start of a search until the cards of the last one are grey


@frozen(eq=False)
class Proposals:
    """Result of a task, and the positions of the points of each answer."""

    task: Task
    synthesis: Synthesis
    positions: tuple[Positions, ...]

    @property
    def answers(self) -> Sequence[Answer]:
        """Those that are shown: the good ones, or all where there is none."""
        synthesis = self.synthesis
        return synthesis.answers[: synthesis.shown] or synthesis.answers


def propose(task: Task) -> Proposals:
    """Linkages for a task, with the positions of their points."""
    synthesis = synthesise(task)
    return Proposals(task, synthesis, tuple(positions_of(answer) for answer in synthesis.answers))


def positions_of(answer: Answer) -> Positions:
    """Positions (n,) [mm] of the points of an answer while its driver passes its turn, or its range in both directions."""
    positions = joint_positions(answer, STEPS)
    if answer.turns_fully:
        return positions
    return {name: np.concatenate((z, z[-2:0:-1])) for name, z in positions.items()}


@frozen(eq=False)
class ShownAnswer:
    """An answer with a card: the positions of its points, and what distinguishes it from those of the search."""

    answer: Answer
    positions: Positions
    mark: str = ""


class AnswerStrip(QWidget):
    """Cards of linkages under the drawing.

    Signals: ``shown`` (Positions) when another card is selected; ``stepped`` (int) as the linkage moves; ``taken``, ``taken_under_motion``,
    ``changed_over`` (Answer) for *Take over*, *Under the motion*, *Drive by the other link*; ``stopped`` when the user stops the search.
    """

    shown = Signal(object)
    stepped = Signal(int)
    taken = Signal(object)
    taken_under_motion = Signal(object)
    changed_over = Signal(object)
    stopped = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.board = Board("the best first")
        self.summary = QLabel()
        self.summary.setMinimumWidth(1)
        self.stop = described(QPushButton("&Stop", autoDefault=False), tip="Stop the search")
        self.put_button = described(QPushButton("&Take over", autoDefault=False), tip=TAKE_OVER)
        self.motion_button = QPushButton("Under the &motion", autoDefault=False)
        self.proposals: Proposals | None = None
        self._rows: dict[Card, ShownAnswer] = {}
        self._why_no_motion = ""
        self._step = 0
        self._clock = QTimer(self, interval=FRAME_MS)
        self._faint = single_shot(self, self._show_faint, FAINT_MS)
        self.board.keep.hide()
        self.board.sort.setSizeAdjustPolicy(WordBox.SizeAdjustPolicy.AdjustToContents)
        self.board.list.setToolTip(
            "Click a card to see it move over the task; double-click to take it over; right-click to drive it by its other link"
        )
        buttons = widget_with(fill(QHBoxLayout(), self.motion_button, self.put_button, margins=0))
        self.board.set_header(fill(QHBoxLayout(), (self.summary, 1), self.stop), buttons)
        actions = (
            ("Under the motion", self.taken_under_motion, self.motion_button.isEnabled),
            ("Drive by the other link", self.changed_over, self.put_button.isEnabled),
        )
        for text, signal, is_enabled in actions:
            action = QAction(text, self.board.list)
            action.triggered.connect(partial(self._emit, signal, is_enabled))
            self.board.list.addAction(action)
        fill(QVBoxLayout(self), self.board, STRETCH, margins=MARGINS, spacing=0)
        self.stop.hide()
        self.end()
        self.update_style()
        self.show_motion("")
        self.set_ready(False)
        connect_all(
            (self._clock.timeout, self._turn),
            (self.board.list.currentItemChanged, self._show_card),
            (self.board.reopened, self._take_design),
            (self.put_button.clicked, partial(self._emit, self.taken, self.put_button.isEnabled)),
            (self.motion_button.clicked, partial(self._emit, self.taken_under_motion, self.motion_button.isEnabled)),
            (self.stop.clicked, self.stopped),
        )

    def update_style(self) -> None:
        """Reserve the height of the cards, so that the drawing above keeps its size under the mouse."""
        lines = CARD_VALUES * self.board.fontMetrics().lineSpacing()
        self.setMinimumHeight(self.put_button.sizeHint().height() + 2 + card_height(lines) + sum(MARGINS[1::2]))

    def set_ready(self, on: bool) -> None:
        """Let the selected linkage be taken over, or not: the task has changed since."""
        self.put_button.setEnabled(on)
        self.motion_button.setEnabled(on and not self._why_no_motion)

    def show_motion(self, why_not: str) -> None:
        """Offer *Under the motion*, or say why the present design has none."""
        self._why_no_motion = why_not
        self.motion_button.setToolTip(why_not or UNDER_MOTION)
        self.set_ready(self.put_button.isEnabled())

    # -- a search -----------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Show that a search is running; the last cards stay, grey after a moment."""
        self.set_ready(False)
        if not self._faint.isActive() and self.stop.isHidden():
            self._faint.start()

    def _show_faint(self) -> None:
        self.summary.setText("Searching ...")
        self.stop.show()
        self.board.list.setEnabled(False)

    def end(self, text: str = "") -> None:
        """Show that no search is running, and say why there is no result."""
        self._faint.stop()
        self.stop.hide()
        self.board.list.setEnabled(True)
        self.summary.setText(text or EMPTY)
        self.summary.setToolTip(self.summary.text())  # also where it has no room

    def show_none(self) -> None:
        """Show that there is no linkage for the task."""
        self.end()
        self.proposals = None
        self._show_rows([])

    def show_proposals(self, proposals: Proposals) -> None:
        """Show the linkages that were found, with the same place selected as before, at first the best."""
        self.end(_summary(proposals))
        self.proposals = proposals
        rows = [ShownAnswer(*row) for row in zip(proposals.answers, proposals.positions, strict=False)]
        self._show_rows(rows, max(0, self.board.list.currentRow()))

    def add_chosen(self, answer: Answer) -> None:
        """Show the linkage of two chosen dyads as the first card, and select it."""
        others = [row for row in self._rows.values() if not is_same(row.answer, answer)]
        self._show_rows([ShownAnswer(answer, positions_of(answer), CHOSEN), *others])

    def replace_selected(self, answer: Answer) -> None:
        """Show another linkage on the selected card: the same one, with the other side link as its driver."""
        selected, rows = self._selected, list(self._rows.values())
        if selected is not None:
            row = rows.index(selected)
            rows[row] = ShownAnswer(answer, positions_of(answer), selected.mark)
            self._show_rows(rows, row)

    def show_again(self) -> None:
        """Show the cards in the units and colours on display."""
        is_ready = self.put_button.isEnabled()
        self._show_rows(list(self._rows.values()), max(0, self.board.list.currentRow()))
        self.set_ready(is_ready)

    def _show_rows(self, rows: Sequence[ShownAnswer], selected: int = 0) -> None:
        cards = [
            Card(row.answer.candidate.design, card_values(row.answer, row.mark), AnswerPicture(row.positions))
            for row in rows
        ]
        self._rows = dict(zip(cards, rows, strict=True))
        self.board.show_cards(cards)
        self.set_ready(bool(rows))
        if rows:
            self.board.list.setCurrentRow(min(selected, len(rows) - 1))
        else:
            self._clock.stop()
            self.shown.emit({})

    # -- the selected card --------------------------------------------------------------------------------

    @property
    def _selected(self) -> ShownAnswer | None:
        item = self.board.list.currentItem()
        index = None if item is None else item.data(Qt.ItemDataRole.UserRole)
        if index is None or index >= len(self.board.cards):
            return None
        return self._rows.get(self.board.cards[index])

    @property
    def answer(self) -> Answer | None:
        """The answer whose card is selected."""
        return None if self._selected is None else self._selected.answer

    def _show_card(self, *_: object) -> None:
        if self._selected is not None:
            self.shown.emit(self._selected.positions)
            self.run(True)

    def run(self, on: bool) -> None:
        """Let the selected linkage move over the task, or not."""
        if on and self._selected is not None:
            self._clock.start()
        else:
            self._clock.stop()

    def _turn(self) -> None:
        self._step += 1
        self.stepped.emit(self._step)

    def _take_design(self, design: Design) -> None:
        """Take the linkage of a card over, unless the task has changed since."""
        row = next((row for card, row in self._rows.items() if card.design is design), None)
        if row is not None and self.put_button.isEnabled():
            self.taken.emit(row.answer)

    def _emit(self, signal: Any, is_enabled: Callable[[], bool], *_: object) -> None:
        if self.answer is not None and is_enabled():
            signal.emit(self.answer)


def _summary(proposals: Proposals) -> str:
    """How many linkages there are, and how many are hidden."""
    synthesis, count = proposals.synthesis, len(proposals.answers)
    extent = "all that there are" if synthesis.complete else "the best of a sweep"
    text = f"{count} {'linkage' if count == 1 else 'linkages'}, {extent}"
    if not synthesis.shown:
        return f"Only with defects or beyond limits: {text}"
    return f"{text}; {synthesis.hidden} with defects or beyond limits are hidden" if synthesis.hidden else text


def card_values(answer: Answer, mark: str = "") -> Mapping[str, tuple[float, str]]:
    """Name -> value and text of the figures on a card."""
    error = max(answer.error_mm / answer.size_mm, answer.error_deg)
    exact = answer.error_mm <= 1e-9 * answer.size_mm and answer.error_deg <= 1e-9
    texts = [brief(answer.error_mm, "mm", 3)] if answer.error_mm > 0.0 else []
    texts += [f"{short(answer.error_deg, 3)}°"] if answer.error_deg > 1e-9 else []
    transmission, ratio = (", beyond its limit" if name in answer.violated else "" for name in BOUNDED)
    notes = filter(None, (mark, "full turn" if answer.turns_fully else ""))
    kind = ", ".join([answer.candidate.kind.capitalize(), *notes, *(f"{defect} defect" for defect in answer.defects)])
    return {
        "kind": (float(KINDS.index(answer.candidate.kind)), kind),
        "error": (error, "exact" if exact else f"error {', '.join(texts)}"),
        "transmission angle": (
            answer.transmission_deg,
            f"transmission angle {short(answer.transmission_deg, 4)}°{transmission}",
        ),
        "longest to shortest link": (
            answer.length_ratio,
            f"longest to shortest link {short(answer.length_ratio, 3)}{ratio}",
        ),
        "size": (answer.size_mm, f"size {readable_text(answer.size_mm, 'mm', 4)}"),
    }
