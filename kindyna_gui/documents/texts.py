"""Designs as texts: the command of a dialog, what does not fit, differences of designs, unsaved work."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from time import localtime, strftime
from typing import TYPE_CHECKING, Any

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
    get,
    motion_of,
    put,
    require_motion,
    rise_gap,
    span_gap,
    split_unit,
)
from core.design.curves import unsolved_segment
from core.errors import MISSING, DesignError, KindynaError
from core.frozen import frozen
from core.motion import Join, program
from core.project import load, loads
from core.project.recovery import Recoverable, Unsaved
from kindyna_gui.documents.edits import IncompleteDesign
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import choice_text, law_label, name_of, segment_of, sentence, value_text
from kindyna_gui.look import MessageLabel, described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import fill

if TYPE_CHECKING:
    from core.project.differences import ValueDifference

UNSAVED = Path("DESIGN.toml")
CommandOptions = Callable[[], tuple[str, Sequence[str]]]
"""The file or folder that a command writes, or only the ending where the file has the design's name; and the options."""
SEGMENTS = "motion.segments"
"""Path of the faults of the motion: its spans do not add up to a turn, or its rises not to zero."""
NO_MECHANISM = "Not a mechanism yet"
NAMES = {"assumed": "Assumed values", "follower.kind": "Kind of follower"}
"""Names of keys that no form shows."""
SIZE = (680, 460)  # of the recovery dialog, pixels
LINES = 4  # of the list of unsaved work

# -- the command that does the same as a dialog ----------------------------------------------------------


def command_line(
    name: str, design: Path | None, out: str, words: Sequence[str], drive: str = "", file_option: str = "--out"
) -> str:
    """Return the command line with a design's file, the options, and the name of a drive, where they are given.

    ``file_option`` is the option for the file that the command writes.
    """
    from shlex import join  # imported here to save start-up time

    read = [] if design is None else [str(design)]
    file = f"{design.stem}{out}" if design is not None and out.startswith(".") and "/" not in out else out
    of_drive = ["--drive", drive] if drive else []
    return join(["kindyna", "--headless", name, *read, *words, *of_drive, file_option, file])


def add_copy(
    buttons: QDialogButtonBox,
    parent: QWidget,
    name: str,
    options: CommandOptions,
    *,
    of_drive: bool = False,
    reads: bool = True,
    file_option: str = "--out",
) -> QPushButton:
    """Add a button to a dialog that copies its command, and return it.

    ``of_drive``: for one drive; ``reads``: the command reads a design; ``file_option``: its option for the file it writes.
    """

    def line() -> str:
        session: Any = getattr(parent, "session", None)
        drive = session.design.name if session is not None and session.has_several_drives and of_drive else ""
        design = session.path if session is not None and session.path is not None else UNSAVED
        return command_line(name, design if reads else None, *options(), drive, file_option)

    return add_copy_of_line(buttons, line)


def command_text(name: str, words: Sequence[str]) -> str:
    """Return the command line with these words."""
    from shlex import join  # imported here to save start-up time

    return join(["kindyna", "--headless", name, *words])


def session_options(session: Any) -> dict[str, Any]:
    """Return the options for the current design's file and for the selected drive of a shaft."""
    return {"into": session.path or UNSAVED, "drive": session.design.name if session.has_several_drives else ""}


def add_copy_of_line(buttons: QDialogButtonBox, line: Callable[[], str]) -> QPushButton:
    """Add a button to a dialog that copies the command line returned by a function, and return it."""
    button = copy_button(line)
    buttons.addButton(button, QDialogButtonBox.ButtonRole.ActionRole)
    return button


def copy_button(line: Callable[[], str]) -> QPushButton:
    """Return a button that copies the command line returned by a function."""

    def copy() -> None:
        QApplication.clipboard().setText(line())
        button.setText("Copied")

    button = described(
        QPushButton("Copy as command", autoDefault=False), tip="Copy the command that does the same to the clipboard"
    )
    button.clicked.connect(lambda: copy())
    return button


# -- what does not fit together --------------------------------------------------------------------------


BACK = "Back to the last valid values"


def misfit_sentences(session: Session) -> list[str]:
    """Return a sentence for each reason why the values do not fit, the motion of the selected drive first."""
    if session.incomplete is not None and session.is_incomplete_linkage:
        from core.mechanism.unfinished import mobility

        return [sentence(row) for row in mobility(session.typed.drive.linkage).sentences] or [NO_MECHANISM]
    if reasons := session.waits_for.reasons:
        return [sentence(f"{name}: {text}") for _, name, text in reasons]
    typed, misfit, motion = session.typed, session.misfit, motion_of(session.typed)
    rows = [] if motion is None or not misfit.reasons else _gaps(motion)
    rows += [f"{name}: {text}" for path, name, text in misfit.reasons if not (rows and path == SEGMENTS)]
    if rows and segment_of(misfit.path) is not None and not rows[0].startswith(name_of(typed, misfit.path)):
        rows[0] = f"{name_of(typed, misfit.path)}: {rows[0]}"
    return [sentence(row) for row in rows]


def waiting_text(session: Session) -> str:
    """Return which values do not fit yet, such as ``Does not fit yet: Rod L2``, or are not in effect; '' where all fit."""
    if session.incomplete is not None and session.is_incomplete_linkage:
        return NO_MECHANISM
    if session.waits_for.reasons:
        return "Not in effect yet: the laws of the motion"
    names = dict.fromkeys(name for _, name, _ in session.misfit.reasons)
    return f"Does not fit yet: {', '.join(names)}" if names else ""


def back_text(session: Session) -> str:
    """Return what the last valid values are, where a single value does not fit: ``Back to 845 mm``."""
    path = session.misfit.path
    try:
        valid = get(session.design, path)
        if put(session.typed, path, valid) == session.design and not isinstance(valid, tuple):
            return f"Back to {value_text(valid, split_unit(path)[1])}"
    except (KeyError, DesignError):  # only the typed design has it
        pass
    return BACK


def _gaps(motion: Motion) -> list[str]:
    """Return by how much the spans differ from a turn, and the end of the motion from its start."""
    deg, unit, rows = UNITS["deg"], UNITS[motion.unit], []
    if gap := span_gap(motion):
        total = value_text(360.0 + gap, deg)
        rows.append(
            f"spans add up to {total}, {value_text(abs(gap), deg)} {'more' if gap > 0.0 else 'less'} than a turn"
        )
    if gap := rise_gap(motion):
        rows.append(f"the follower ends {value_text(abs(gap), unit)} {'above' if gap > 0.0 else 'below'} its start")
    return rows


def waiting_paths(session: Session) -> frozenset[str]:
    """Return the paths of the values that do not fit: those of the reasons, and the one typed last."""
    misfit = session.misfit
    return frozenset({path for path, _, _ in misfit.reasons if path != SEGMENTS} | {misfit.path} - {""})


def motion_waits(session: Session) -> bool:
    """Whether the typed motion is not applied yet."""
    return session.incomplete is not None and motion_of(session.typed) != motion_of(session.design)


def joins_of(motion: Motion) -> tuple[Join, ...]:
    """Return the joins of an incomplete motion; none where its spans do not add up to a turn, or a curve is not known."""
    try:
        return () if span_gap(motion) or unsolved_segment(motion) is not None else program(motion).joins
    except KindynaError:
        return ()


def closing_text(session: Session) -> str:
    """Return what would close the motion: ``segment 4: Modified sine, -40 mm``; '' where no single change would."""
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
    """Return the law, span and rise of a segment that differ from before."""
    texts = [law_label(after.curve.law)] if before is None or before.curve.law != after.curve.law else []
    if before is None or before.span_deg != after.span_deg:
        texts.append(value_text(float(f"{after.span_deg:.6g}"), UNITS["deg"]))
    if before is None or before.rise != after.rise:
        texts.append(value_text(float(f"{after.rise:.6g}"), UNITS[motion.unit]))
    return ", ".join(texts)


# -- differences of designs ------------------------------------------------------------------------------


def difference_text(before: Design | None, after: Design, difference: ValueDifference) -> tuple[str, str, str]:
    """Return the name of a value that differs between two designs, and both values as texts."""
    design = before if before is not None and difference.after is MISSING else after
    name = NAMES.get(difference.path) or name_of(design, difference.path)
    unit = split_unit(difference.path.rpartition(".")[2])[1] or NO_UNIT
    return name, _any_text(difference.before, unit), _any_text(difference.after, unit)


def _any_text(value: Any, unit: Unit) -> str:
    """Return a value of a file as text: a number, a word, a list or a table."""
    if value is MISSING:
        return "none"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_any_text(item, NO_UNIT)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return f"({', '.join(_any_text(item, NO_UNIT) for item in value)})"
    if isinstance(value, float):
        return value_text(value, unit)
    return choice_text(value) if isinstance(value, str) else str(value)


# -- unsaved work of a process that has ended ------------------------------------------------------------


class OnRecovery(Enum):
    """What to do with unsaved work of a process that ended unexpectedly."""

    RECOVER = "recover"
    OPEN = "open the file as it is"
    DISCARD = "discard"
    LATER = "later"


@frozen
class RecoveryComparison:
    """Unsaved work compared with its file.

    ``title`` is name and time of the work, ``note`` what the user should know about it, ``rows`` the differences as name,
    value in the file and recovered value; ``is_unsaved`` is False where the file has all of it.
    """

    title: str
    note: str
    rows: tuple[tuple[str, str, str], ...] = ()
    is_unsaved: bool = True


def compare(unsaved: Unsaved) -> RecoveryComparison:
    """Compare unsaved work with its file; where it has none, all its values are differences."""
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
        notes.insert(0, "It has no file yet, so all values are listed.")
    else:
        notes.insert(0, f"{path}{_later(path, unsaved.time)}.")
        try:
            base = load(path)
        except KindynaError as error:
            notes.append(f"The file cannot be read, so all values are listed: {error}")
    from core.project.differences import differences  # imported here to save start-up time

    rows = tuple(difference_text(base, typed, row) for row in differences(base, typed))
    return RecoveryComparison(title, " ".join(notes), rows, bool(rows) or unsaved.draft is not None)


def _later(path: Path, time: float) -> str:
    """Return a note where the file is newer than the work."""
    try:
        changed = path.stat().st_mtime
    except OSError:
        return ""
    return f" was changed later, {strftime('%Y-%m-%d %H:%M', localtime(changed))}" if changed > time + 1.0 else ""


class RecoveryDialog(QDialog):
    """A list of unsaved work, and the differences of the selected one below it."""

    def __init__(self, parent: QWidget, entries: Sequence[Recoverable]) -> None:
        super().__init__(parent)
        self.setWindowTitle("Unsaved work")
        self.entries, self.choice = list(entries), OnRecovery.LATER
        self._comparisons = [compare(entry.unsaved) for entry in entries]
        many = len(entries) > 1
        header = QLabel(
            "KINDYNA has ended without saving this design:" if not many else "KINDYNA has ended without saving:"
        )
        self.list = QListWidget()
        self.list.addItems([row.title for row in self._comparisons])
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
        self.open_file.setToolTip("The unsaved work is retained, and offered again at the next start")
        self.discard.setToolTip("The unsaved work is deleted")
        self.later.setToolTip(
            "The unsaved work is retained, and offered again by Recover unsaved work, or at the next start"
        )
        footer = QHBoxLayout()
        for button in (self.discard, self.later, self.open_file, self.recover):
            footer.addWidget(button)
        footer.insertStretch(1, 1)
        fill(QVBoxLayout(self), header, self.list, self.note, (self.table, 1), footer)
        self.resize(*SIZE)
        self.list.currentRowChanged.connect(self._show)
        self.list.setCurrentRow(0)

    @property
    def chosen(self) -> Recoverable:
        """The selected unsaved work."""
        return self.entries[self.list.currentRow()]

    def _button(self, text: str, choice: OnRecovery) -> QPushButton:
        button = QPushButton(text, autoDefault=False)
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
