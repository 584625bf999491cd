"""The linkages that are proposed for a task, as cards under the drawing: their figures, their small moving images, *Take over*."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from core.frozen import frozen
from core.synthesis import Answer, Synthesis, Task, synthesise
from core.synthesis.judge import joint_positions
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.look import described
from kindyna_gui.pictures.units import brief, readable_text, short
from kindyna_gui.rebuilt import connect_all, fill, single_shot
from kindyna_gui.studies.board import Board, Card
from kindyna_gui.synthesis.sheet_painting import AnswerPicture, Positions
from kindyna_gui.synthesis.task_form import BOUNDED

FRAME_MS, STEPS = 40, 120
FAINT_MS = 300  # from the start of a search until the cards of the last one are grey


@frozen(eq=False)
class Proposals:
    """Result of a task, and the positions of the points of each answer."""

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
    return Proposals(synthesis, tuple(positions_of(answer) for answer in synthesis.answers))


def positions_of(answer: Answer) -> Positions:
    """Positions (n,) [mm] of the points of an answer while its driver passes its turn, or its range in both directions."""
    positions = joint_positions(answer, STEPS)
    if answer.turns_fully:
        return positions
    return {name: np.concatenate((z, z[-2:0:-1])) for name, z in positions.items()}


class AnswerStrip(QWidget):
    """Cards of linkages under the drawing.

    Signals: ``shown`` (Positions) when another card is selected; ``stepped`` (int) as the linkage moves; ``taken`` (Answer);
    ``stopped`` when the user stops the search.
    """

    shown = Signal(object)
    stepped = Signal(int)
    taken = Signal(object)
    stopped = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.board = Board("the best first")
        self.found = QLabel()
        self.found.setMinimumWidth(1)
        self.stop = described(QPushButton("&Stop", autoDefault=False), tip="Stop the search")
        self.put_button = described(
            QPushButton("&Take over", autoDefault=False), tip="Make the selected linkage the design, as one undo step"
        )
        self.proposals: Proposals | None = None
        self._step = 0
        self._clock = QTimer(self, interval=FRAME_MS)
        self._faint = single_shot(self, self._show_faint, FAINT_MS)
        self.board.keep.hide()
        self.board.sort.setSizeAdjustPolicy(WordBox.SizeAdjustPolicy.AdjustToContents)
        self.board.list.setToolTip("Click a card to see it move over the task; double-click to take it over")
        self.board.set_header(fill(QHBoxLayout(), (self.found, 1), self.stop), self.put_button)
        fill(QVBoxLayout(self), self.board, margins=(6, 2, 6, 4))
        self.stop.hide()
        self.put_button.setEnabled(False)
        connect_all(
            (self._clock.timeout, self._turn),
            (self.board.list.currentItemChanged, self._show_card),
            (self.board.reopened, lambda *_: self.take()),
            (self.put_button.clicked, lambda *_: self.take()),
            (self.stop.clicked, self.stopped),
        )

    # -- a search -----------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Show that a search is running; the last cards stay, grey after a moment."""
        self.put_button.setEnabled(False)
        if not self._faint.isActive() and self.stop.isHidden():
            self._faint.start()

    def _show_faint(self) -> None:
        self.found.setText("Searching ...")
        self.stop.show()
        self.board.list.setEnabled(False)

    def end(self, text: str = "") -> None:
        """Show that no search is running, and say why there is no result."""
        self._faint.stop()
        self.stop.hide()
        self.board.list.setEnabled(True)
        self.found.setText(text)

    def show_none(self) -> None:
        """Show that there is no linkage for the task."""
        self.end()
        self.proposals = None
        self._show_cards()

    def show_proposals(self, proposals: Proposals) -> None:
        """Show the linkages that were found."""
        self.end(_summary(proposals))
        self.proposals = proposals
        self._show_cards()

    def _show_cards(self) -> None:
        """Show the cards, with the same place selected as before, at first the best."""
        row = max(0, self.board.list.currentRow())
        proposals = self.proposals
        answers = proposals.answers if proposals is not None else ()
        positions = proposals.positions if proposals is not None else ()
        self.board.show_cards(
            [
                Card(answer.candidate.design, card_values(answer), AnswerPicture(z))
                for answer, z in zip(answers, positions, strict=False)
            ]
        )
        self.put_button.setEnabled(bool(answers))
        if answers:
            self.board.list.setCurrentRow(min(row, len(answers) - 1))
        else:
            self._clock.stop()
            self.shown.emit({})

    # -- the selected card --------------------------------------------------------------------------------

    @property
    def _index(self) -> int | None:
        item = self.board.list.currentItem()
        index = None if item is None else item.data(Qt.ItemDataRole.UserRole)
        return (
            index if self.proposals is not None and index is not None and index < len(self.proposals.answers) else None
        )

    @property
    def answer(self) -> Answer | None:
        """The answer whose card is selected."""
        return None if self._index is None or self.proposals is None else self.proposals.answers[self._index]

    def _show_card(self, *_: object) -> None:
        if self._index is not None and self.proposals is not None:
            self.shown.emit(self.proposals.positions[self._index])
            self.run(True)

    def run(self, on: bool) -> None:
        """Let the selected linkage move over the task, or not."""
        if on and self._index is not None:
            self._clock.start()
        else:
            self._clock.stop()

    def _turn(self) -> None:
        self._step += 1
        self.stepped.emit(self._step)

    def take(self) -> None:
        """Take the selected linkage over, unless the task has changed since."""
        answer = self.answer
        if answer is not None and self.put_button.isEnabled():
            self.taken.emit(answer)


def _summary(proposals: Proposals) -> str:
    """How many linkages there are, and how many are hidden."""
    synthesis, count = proposals.synthesis, len(proposals.answers)
    extent = "all that there are" if synthesis.complete else "the best of a sweep"
    text = f"{count} {'linkage' if count == 1 else 'linkages'}, {extent}"
    if not synthesis.shown:
        return f"Only with defects or beyond limits: {text}"
    return f"{text}; {synthesis.hidden} with defects or beyond limits are hidden" if synthesis.hidden else text


def card_values(answer: Answer) -> Mapping[str, tuple[float, str]]:
    """Name -> value and text of the figures on a card."""
    error = max(answer.error_mm / answer.size_mm, answer.error_deg)
    exact = answer.error_mm <= 1e-9 * answer.size_mm and answer.error_deg <= 1e-9
    texts = [brief(answer.error_mm, "mm", 3)] if answer.error_mm > 0.0 else []
    texts += [f"{short(answer.error_deg, 3)}°"] if answer.error_deg > 1e-9 else []
    transmission, ratio = (", beyond its limit" if name in answer.violated else "" for name in BOUNDED)
    kind = ", ".join([answer.candidate.kind.capitalize(), *(f"{defect} defect" for defect in answer.defects)])
    return {
        answer.candidate.kind: (0.0, kind),
        "error": (error, "exact" if exact else f"error {', '.join(texts)}"),
        "transmission angle": (
            answer.transmission_deg,
            f"transmission angle {short(answer.transmission_deg, 4)}°{transmission}",
        ),
        "longest to shortest": (
            answer.length_ratio,
            f"longest to shortest link {short(answer.length_ratio, 3)}{ratio}",
        ),
        "size": (answer.size_mm, f"size {readable_text(answer.size_mm, 'mm', 4)}"),
    }
