"""The question what to do with unsaved work that processes have left behind, beside what its file holds."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from time import localtime, strftime

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
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

from core.design import Design
from core.errors import KindynaError
from core.frozen import frozen
from core.project import differences, load, loads
from core.project.recovery import Recoverable, Unsaved
from kindyna_gui.documents.draft import Draft
from kindyna_gui.documents.texts import difference_text
from kindyna_gui.note import MessageLabel
from kindyna_gui.pictures.style import SCREEN

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
        typed = design if unsaved.draft is None else Draft.from_state(unsaved.draft).whole
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


__all__ = ["OnRecovery", "RecoveryComparison", "RecoveryDialog", "compare"]
