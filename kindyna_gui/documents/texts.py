"""Designs in words, as a command."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from time import localtime, strftime
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QListWidget,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from core.design import (
    NO_UNIT,
    UNITS,
    Design,
    Motion,
    Segment,
    Unit,
    motion_of,
    require_motion,
    rise_gap,
    span_gap,
    split_unit,
)
from core.errors import MISSING, KindynaError
from core.frozen import frozen
from core.motion import Join, program
from core.project import ValueDifference, differences, load, loads
from core.project.recovery import Recoverable, Unsaved
from kindyna_gui.documents.edits import IncompleteDesign
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import choice_text, law_label, name_of, segment_of, sentence, value_text
from kindyna_gui.look import MessageLabel
from kindyna_gui.pictures.style import SCREEN

# -- what a dialog asks for, as a line for the command line ----------------------------------------------

UNSAVED = Path("DESIGN.toml")

Asked = Callable[[], tuple[str, Sequence[str]]]
"""The file, or the folder, that a command writes, the ending of a file alone where that is called as the design; and its options."""


def command_line(name: str, design: Path | None, out: str, words: Sequence[str], drive: str = "") -> str:
    """A command on a design's file, if on any, of one drive where one is named."""
    read = [] if design is None else [str(design)]
    file = f"{design.stem}{out}" if design is not None and out.startswith(".") and "/" not in out else out
    of_drive = ["--drive", drive] if drive else []
    return shlex.join(["kindyna", "--headless", name, *read, *words, *of_drive, "--out", file])


def add_copy(
    buttons: QDialogButtonBox, parent: QWidget, name: str, asked: Asked, *, of_drive: bool = False, reads: bool = True
) -> None:
    """A button of a dialog over the window that puts its command into the clipboard; of_drive: the command takes one of several;
    reads: it is on a design."""

    def line() -> str:
        session: Any = getattr(parent, "session", None)
        drive = session.design.name if session is not None and session.several and of_drive else ""
        design = session.path if session is not None and session.path is not None else UNSAVED
        return command_line(name, design if reads else None, *asked(), drive)

    add_copy_of_line(buttons, line)


def command_text(name: str, words: Sequence[str]) -> str:
    """A command with these words."""
    return shlex.join(["kindyna", "--headless", name, *words])


def session_options(session: Any) -> dict[str, Any]:
    """The file of the design at hand, and which drive of a shaft it is, as commands name them."""
    return {"into": session.path or UNSAVED, "drive": session.design.name if session.several else ""}


def add_copy_of_line(buttons: QDialogButtonBox, line: Callable[[], str]) -> None:
    """The same button, of a command that is command_text otherwise."""
    buttons.addButton(copy_button(line), QDialogButtonBox.ButtonRole.ActionRole)


def copy_button(line: Callable[[], str]) -> QPushButton:
    """It by itself, for a window."""

    def copy() -> None:
        QApplication.clipboard().setText(line())
        button.setText("Copied")

    button = QPushButton("Copy as command")
    button.setToolTip("The same for the command line, into the clipboard")
    button.setAutoDefault(False)
    button.clicked.connect(lambda: copy())
    return button


# -- texts -----------------------------------------------------------------------------------------------

WHOLE = "motion.segments"
"""Path of the faults of the whole motion: it makes no turn, or does not come back."""


NO_MECHANISM = "Not a mechanism yet"


def misfit_sentences(session: Session) -> list[str]:
    """A sentence for each thing that does not fit together, what the motion of the chosen drive lacks first; none where all does."""
    if session.incomplete is not None and session.is_incomplete_linkage:
        from core.mechanism.unfinished import mobility

        return [sentence(row) for row in mobility(session.typed.drive.linkage).sentences] or [NO_MECHANISM]
    typed, misfit, motion = session.typed, session.misfit, motion_of(session.typed)
    rows = [] if motion is None or not misfit.reasons else _gaps(motion)
    rows += [f"{name}: {text}" for path, name, text in misfit.reasons if not (rows and path == WHOLE)]
    if rows and segment_of(misfit.path) is not None and not rows[0].startswith(name_of(typed, misfit.path)):
        rows[0] = f"{name_of(typed, misfit.path)}: {rows[0]}"
    return [sentence(row) for row in rows]


def waiting_text(session: Session) -> str:
    """What does not fit to the rest: ``Does not fit yet: Rod L2``; '' where all does."""
    if session.incomplete is not None and session.is_incomplete_linkage:
        return NO_MECHANISM
    names = dict.fromkeys(name for _, name, _ in session.misfit.reasons)
    return f"Does not fit yet: {', '.join(names)}" if names else ""


def _gaps(motion: Motion) -> list[str]:
    """By how much a motion makes no turn, and does not come back."""
    deg, own, rows = UNITS["deg"], UNITS[motion.unit], []
    if gap := span_gap(motion):
        total = value_text(360.0 + gap, deg)
        rows.append(
            f"spans add up to {total}, {value_text(abs(gap), deg)} {'more' if gap > 0.0 else 'less'} than a turn"
        )
    if gap := rise_gap(motion):
        rows.append(f"the follower ends {value_text(abs(gap), own)} {'above' if gap > 0.0 else 'below'} its start")
    return rows


def waiting_paths(session: Session) -> frozenset[str]:
    """The paths of the values that do not fit together, as far as they are known: those that are named, and the one typed last."""
    misfit = session.misfit
    return frozenset({path for path, _, _ in misfit.reasons if path != WHOLE} | {misfit.path} - {""})


def motion_waits(session: Session) -> bool:
    """Whether the motion that is typed is not in place."""
    return session.incomplete is not None and motion_of(session.typed) != motion_of(session.design)


def joins_of(motion: Motion) -> tuple[Join, ...]:
    """The joins of an unfinished motion; none where its spans make no turn, or a curve has no answer."""
    try:
        return () if span_gap(motion) else program(motion).joins
    except KindynaError:
        return ()


def closing_text(session: Session) -> str:
    """What would close the motion: ``segment 4: Modified sine, -40 mm``; '' where nothing simple would, or it is whole."""
    closing = session.closing
    if closing is None:
        return ""
    motion = require_motion(session.typed)
    before, after = list(motion.segments), list(require_motion(closing).segments)
    new = -1
    if len(after) > len(before):
        new = next((i for i, segment in enumerate(before) if segment != after[i]), len(before) - 1) + 1
        before.insert(new, after[new])
    rows = [
        f"{'a new ' if i == new else ''}segment {i + 1}: {_changes(None if i == new else before[i], segment, motion)}"
        for i, segment in enumerate(after)
        if i == new or segment != before[i]
    ]
    return "; ".join(rows)


def _changes(before: Segment | None, after: Segment, motion: Motion) -> str:
    """Law, span and rise of a segment, as far as they are others than before."""
    texts = [law_label(after.curve.law)] if before is None or before.curve.law != after.curve.law else []
    if before is None or before.span_deg != after.span_deg:
        texts.append(value_text(float(f"{after.span_deg:.6g}"), UNITS["deg"]))
    if before is None or before.rise != after.rise:
        texts.append(value_text(float(f"{after.rise:.6g}"), UNITS[motion.unit]))
    return ", ".join(texts)


NAMES = {"assumed": "Assumed values", "follower.kind": "Kind of follower"}
"""Of keys that no form shows."""


def difference_text(before: Design | None, after: Design, difference: ValueDifference) -> tuple[str, str, str]:
    """A value that differs between two designs: its name, what stands in the one, what in the other."""
    design = before if before is not None and difference.after is MISSING else after
    name = NAMES.get(difference.path) or name_of(design, difference.path)
    unit = split_unit(difference.path.rpartition(".")[2])[1] or NO_UNIT
    return name, _any_text(difference.before, unit), _any_text(difference.after, unit)


def _any_text(value: Any, unit: Unit) -> str:
    """A value of a file: a number, a word, a list or a table."""
    if value is MISSING:
        return "nothing"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_any_text(each, NO_UNIT)}" for key, each in value.items())
    if isinstance(value, list | tuple):
        return f"({', '.join(_any_text(each, NO_UNIT) for each in value)})"
    if isinstance(value, float):
        return value_text(value, unit)
    return choice_text(value) if isinstance(value, str) else str(value)


# -- recovery dialog -------------------------------------------------------------------------------------

SIZE = (680, 460)
LINES = 4  # of the list of work


class OnRecovery(Enum):
    """What to do with unsaved work of a process that has died."""

    RECOVER = "recover"
    OPEN = "open the file as it is"
    DISCARD = "discard"
    LATER = "later"


@frozen
class RecoveryComparison:
    """Unsaved work beside its file.

    title   name and time of the work; note: what the user should know of it
    rows    its differences: name, value in the file, value recovered
    lost    False where the file holds all of it
    """

    title: str
    note: str
    rows: tuple[tuple[str, str, str], ...] = ()
    lost: bool = True


def compare(unsaved: Unsaved) -> RecoveryComparison:
    """Unsaved work beside what its file holds; beside nothing where it has no file."""
    when = strftime("%Y-%m-%d %H:%M", localtime(unsaved.time)) if unsaved.time else ""
    path = unsaved.path
    try:
        design = loads(unsaved.design, source="the recovery file")
        typed = design if unsaved.draft is None else IncompleteDesign.from_state(unsaved.draft).design
    except KindynaError as error:
        return RecoveryComparison(f"Damaged work, {when}".rstrip(", "), f"It cannot be read: {error}")
    title = f"{design.name if path is None else path.name}, {when}".rstrip(", ")
    notes = ["Its values do not fit together yet."] if unsaved.draft is not None else []
    base: Design | None = None
    if path is None:
        notes.insert(0, "It has no file yet; all its values are listed.")
    else:
        notes.insert(0, f"{path}{_later(path, unsaved.time)}.")
        try:
            base = load(path)
        except KindynaError as error:
            notes.append(f"The file cannot be read, so all values are listed: {error}")
    rows = tuple(difference_text(base, typed, each) for each in differences(base, typed))
    return RecoveryComparison(title, " ".join(notes), rows, bool(rows) or unsaved.draft is not None)


def _later(path: Path, time: float) -> str:
    """The note where the file is newer than the work."""
    try:
        changed = path.stat().st_mtime
    except OSError:
        return ""
    return f" was changed later, {strftime('%Y-%m-%d %H:%M', localtime(changed))}" if changed > time + 1.0 else ""


class RecoveryDialog(QDialog):
    """A list of work, and below it what differs in the chosen one."""

    def __init__(self, parent: QWidget, entries: Sequence[Recoverable]) -> None:
        super().__init__(parent)
        self.setWindowTitle("Unsaved work")
        self.entries, self.choice = list(entries), OnRecovery.LATER
        self._comparisons = [compare(each.unsaved) for each in entries]
        many = len(entries) > 1
        head = QLabel(
            "KINDYNA has ended without saving this design:" if not many else "KINDYNA has ended without saving:"
        )
        self.list = QListWidget()
        self.list.addItems([each.title for each in self._comparisons])
        self.list.setFixedHeight(
            self.list.sizeHintForRow(0) * min(len(entries), LINES) + 2 * self.list.frameWidth() + 4
        )
        self.note = MessageLabel(SCREEN.quiet)
        self.table = QTableWidget(0, 3)
        self.table.setHorizontalHeaderLabels(["What differs", "In the file", "Recovered"])
        self.table.verticalHeader().hide()
        self.table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.table.setSelectionMode(QAbstractItemView.SelectionMode.NoSelection)
        self.table.horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.recover = self._button("&Recover", OnRecovery.RECOVER)
        self.open_file = self._button("&Open the file as it is", OnRecovery.OPEN)
        self.discard = self._button("&Discard", OnRecovery.DISCARD)
        self.later = self._button("&Later", OnRecovery.LATER)
        self.recover.setDefault(True)
        self.open_file.setToolTip("The unsaved work is kept, and offered again at the next start")
        self.discard.setToolTip("The unsaved work is removed for good")
        self.later.setToolTip(
            "The unsaved work is kept, and offered again by Recover unsaved work, or at the next start"
        )
        foot = QHBoxLayout()
        for button in (self.discard, self.later, self.open_file, self.recover):
            foot.addWidget(button)
        foot.insertStretch(1, 1)
        column = QVBoxLayout(self)
        for widget in (head, self.list, self.note):
            column.addWidget(widget)
        column.addWidget(self.table, 1)
        column.addLayout(foot)
        self.resize(*SIZE)
        self.list.currentRowChanged.connect(self._show)
        self.list.setCurrentRow(0)

    @property
    def chosen(self) -> Recoverable:
        """The design that the current line stands for."""
        return self.entries[self.list.currentRow()]

    def _button(self, text: str, choice: OnRecovery) -> QPushButton:
        button = QPushButton(text)
        button.setAutoDefault(False)
        button.clicked.connect(lambda: self._choose(choice))
        return button

    def _choose(self, choice: OnRecovery) -> None:
        self.choice = choice
        self.accept()

    def _show(self, row: int) -> None:
        comparison = self._comparisons[row]
        self.note.show_message(comparison.note)
        self.table.setRowCount(len(comparison.rows))
        for i, texts in enumerate(comparison.rows):
            for j, text in enumerate(texts):
                item = QTableWidgetItem(text)
                item.setToolTip(text)
                if j:
                    item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                self.table.setItem(i, j, item)
        self.table.resizeColumnsToContents()
        for column in (1, 2):
            self.table.setColumnWidth(column, min(max(self.table.columnWidth(column), 90), SIZE[0] // 3))
        self.open_file.setEnabled(self.entries[row].unsaved.path is not None)
