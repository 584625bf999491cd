"""Which curve may follow which (Yang Table 1, Fig. 1): the sequence step by step, and below it every curve with the signs at
its ends and why it may follow the chosen step or may not."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QModelIndex, Qt
from PySide6.QtGui import QPalette, QShowEvent
from PySide6.QtWidgets import QButtonGroup, QFrame, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from core.blend import ELEMENTS, MOTION_TYPES, SIGNS, TABLE, CurveSequence, state_text, state_words, states
from core.output.texts import verdict_after
from kindyna_gui.blend.fields import quiet
from kindyna_gui.blend.icons import CURVE_SIZE, curve_icon
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.look import text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import MINUS
from kindyna_gui.rebuilt import Rebuilt

HEADINGS = ("Curve", "s", "v", "a")
HINT = "Choose a step of the sequence, or a curve of the table: green curves may follow it."


def _signs(text: str) -> str:
    return text.replace("-", MINUS)


def _ends(signs: tuple[int, int]) -> str:
    return _signs(", ".join(SIGNS[sign] for sign in signs))


class SuccessionPage(QFrame):
    """The curves of the planned sequence as buttons between their states; the table of all curves.

    curve   what the table shows the successors of
    """

    def __init__(self) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        self._type, self._sequence = "", CurveSequence((), ())
        self._stale = False
        self.chosen: tuple[str, ...] = ()
        """The first curves of the sequence up to the chosen step, or the one curve that was chosen in the table."""
        self.steps: list[QToolButton] = []
        self.motion = quiet()
        self._place = Rebuilt()
        self.verdict = QLabel(wordWrap=True)
        self.verdict.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.table = RowsTable([*(TableHeading(text) for text in HEADINGS), TableHeading("May it follow?", wide=True)])
        self.table.setFrameShape(QFrame.Shape.NoFrame)
        self.table.setIconSize(CURVE_SIZE)
        self.table.setSelectionMode(RowsTable.SelectionMode.NoSelection)
        self.table.clicked.connect(self._clicked)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 8, 6)
        column.setSpacing(4)
        column.addWidget(self.motion)
        column.addWidget(self._place)
        column.addWidget(self.verdict)
        hint = quiet(HINT)
        hint.setWordWrap(True)
        column.addWidget(hint)
        column.addWidget(self.table, 1)

    @property
    def curve(self) -> str:
        """The last curve that is chosen; empty where none is."""
        return self.chosen[-1] if self.chosen else ""

    def show_sequence(self, motion_type: str, sequence: CurveSequence) -> None:
        """Show the curves of a motion; the step that was chosen stays chosen where the motion begins with the same curves."""
        if (motion_type, sequence) == (self._type, self._sequence):
            return
        self._type, self._sequence, self._stale = motion_type, sequence, True
        kept = sequence.curves[: len(self.chosen)] == self.chosen and self.chosen
        self.chosen = self.chosen if kept else sequence.curves[:1]
        self._refresh()

    def choose(self, curves: tuple[str, ...]) -> None:
        """Show what may follow the last of these curves, and why others may not."""
        self.chosen = curves
        self._refresh()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._refresh()

    def _refresh(self) -> None:
        """Nothing of it is made before it is seen."""
        if not self.isVisible() or not self.chosen:
            return
        if self._stale:
            self._stale = False
            self.motion.setText(
                f"{MOTION_TYPES[self._type].label}: signs of velocity and acceleration where curves meet"
            )
            self._place.replace(self._sequence_row())
        place = len(self.chosen) - 1 if self._in_sequence else -1
        for i, button in enumerate(self.steps):
            button.setChecked(i == place)
        self._show_table()

    @property
    def _in_sequence(self) -> bool:
        return self._sequence.curves[: len(self.chosen)] == self.chosen

    def _sequence_row(self) -> QWidget:
        paper = QWidget()
        row = QHBoxLayout(paper)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        group = QButtonGroup(paper)
        group.setExclusive(False)
        self.steps = []
        first, *others = states(self._sequence)
        row.addWidget(self._state(first))
        for i, (name, state) in enumerate(zip(self._sequence.curves, others, strict=True), 1):
            button = text_button(name, checks=True)
            button.setIcon(curve_icon(name))
            button.setIconSize(CURVE_SIZE * 0.8)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.setToolTip(f"{name} ends {state_words(state)}: what may follow it")
            button.clicked.connect(partial(self._step, i))
            group.addButton(button)
            self.steps.append(button)
            row.addWidget(button)
            row.addWidget(self._state(state))
        row.addStretch(1)
        return paper

    def _state(self, state: tuple[int, int]) -> QLabel:
        label = quiet(_signs(state_text(state)).replace(", ", "\n"))
        label.setToolTip(state_words(state).capitalize())
        return label

    def _step(self, count: int, *_: object) -> None:
        self.choose(self._sequence.curves[:count])

    def _clicked(self, index: QModelIndex) -> None:
        self.choose((TABLE[index.row()].curve,))

    def _show_table(self) -> None:
        kind = self._type if self._in_sequence else ""
        rows, able = [], []
        for row in TABLE:
            verdict = verdict_after(self.chosen, row.curve, kind)
            able += [row.curve] if verdict.may_follow else []
            cells = (row.curve, _ends(row.displacement), _ends(row.velocity), _ends(row.acceleration))
            colour = SCREEN.good if verdict.here else SCREEN.ink if verdict.may_follow else SCREEN.quiet
            words = verdict.words[0].upper() + verdict.words[1:]
            rows.append(TableRow((*cells, words), icon=curve_icon(row.curve), tip=words, colour=colour))
        end = ELEMENTS[self.curve].end
        ends = f"<b>{self.curve}</b> ends {state_words(end)} ({_signs(state_text(end))})"
        self.verdict.setText(f"{ends}. May follow: <b>{', '.join(able)}</b>")
        self.table.show_rows(rows)


__all__ = ["SuccessionPage"]
