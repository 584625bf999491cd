"""The motion laws as a table: what each costs, which are drawn, which one the chosen segment has."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import count
from typing import Any

import numpy as np
from PySide6.QtCore import (
    QAbstractTableModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QPointF,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QColor, QFont, QIcon, QPainter, QPixmap

from core.frozen import frozen
from core.laws import LAWS, Law, peaks
from kindyna_gui.motion.laws_plot import LineStyle, stroke_of
from kindyna_gui.pictures.style import SCREEN, of_theme
from kindyna_gui.pictures.units import digits

Index = QModelIndex | QPersistentModelIndex
NAME, VELOCITY, ACCELERATION, JERK, TORQUE, ENDS = range(6)
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
NOTHING = 1e-9  # an end value below this, as a share of the peak, is 0


@frozen
class LawsColumn:
    """Heading, and what its numbers mean."""

    title: str
    help: str


COLUMNS = (
    LawsColumn("Law", "Tick laws to draw them over each other"),
    LawsColumn("Velocity", "Largest velocity: times rise / span"),
    LawsColumn("Accel.", "Largest acceleration: times rise / span²"),
    LawsColumn("Jerk", "Largest jerk inside the law: times rise / span³; ∞ where the acceleration jumps inside"),
    LawsColumn("Torque", "Largest velocity times acceleration, the torque that inertia asks of the camshaft: times rise² / span³"),
    LawsColumn("Ends", "What is not 0 where the law starts (left) and ends (right): next to a dwell it jumps there"),
)  # fmt: skip


@frozen
class LawRow:
    """One law: its four peak coefficients, infinite where there is no end to it, and which of v and a do not start and
    end at 0."""

    law: Law
    numbers: tuple[float, float, float, float]
    starts: str
    ends: str

    @property
    def slug(self) -> str:
        return self.law.slug

    @property
    def ends_text(self) -> str:
        """``a | a``: left what jumps at the start, right what jumps at the end; empty where nothing does."""
        return f"{self.starts or '–'} | {self.ends or '–'}" if self.starts or self.ends else ""

    @property
    def ends_help(self) -> str:
        """What jumps at the ends of the law, in a sentence."""
        names = {"v": "velocity", "a": "acceleration"}
        parts = [
            f"{' and '.join(names[letter] for letter in letters.split())} {verb} at 0"
            for letters, verb in ((self.starts, "does not start"), (self.ends, "does not end"))
            if letters
        ]
        return "; ".join(parts).capitalize() if parts else "Starts and ends without velocity and acceleration"


@cache
def law_rows() -> tuple[LawRow, ...]:
    """Every law, in the order of the table of laws."""
    rows = []
    for law in LAWS.values():
        peak = peaks(law)
        at_ends = law(np.array([0.0, 1.0]))[1:3]
        sizes = (peak.cv, peak.ca)
        starts, ends = (
            " ".join(
                letter
                for letter, value, size in zip("va", at_ends[:, side], sizes, strict=True)
                if abs(value) > NOTHING * max(size, 1.0)
            )
            for side in (0, 1)
        )
        rows.append(LawRow(law, (peak.cv, peak.ca, peak.cj, peak.cm), starts, ends))
    return tuple(rows)


class LawsModel(QAbstractTableModel):
    """The laws in the order last sorted by; ticked ones have a stroke of their own.

    ticked   the laws that are drawn have changed
    """

    ticked = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.rows = list(law_rows())
        self._strokes: dict[str, int] = {}  # slug -> number of its stroke, in the order of ticking
        self._marked: tuple[str, str] = ("", "")  # slug, and the text beside it

    # -- what is ticked and marked --------------------------------------------------------------------------

    @property
    def drawn(self) -> list[tuple[Law, LineStyle]]:
        """The laws that are ticked, in the order of ticking."""
        return [(LAWS[slug], stroke_of(number)) for slug, number in self._strokes.items()]

    def tick(self, slug: str, on: bool) -> None:
        """Draw a law, or draw it no longer; it takes the first stroke that is free."""
        if on == (slug in self._strokes):
            return
        if on:
            taken = set(self._strokes.values())
            self._strokes[slug] = next(i for i in count() if i not in taken)
        else:
            del self._strokes[slug]
        row = self.row_of(slug)
        self.dataChanged.emit(self.index(row, NAME), self.index(row, NAME))
        self.ticked.emit()

    def untick_all(self, *_: object) -> None:
        """Draw none."""
        self._strokes.clear()
        self._all_changed()
        self.ticked.emit()

    def mark(self, slug: str, text: str) -> None:
        """Show a text beside one law: which segment has it."""
        if (slug, text) != self._marked:
            self._marked = (slug, text)
            self._all_changed()

    def _all_changed(self) -> None:
        self.dataChanged.emit(self.index(0, 0), self.index(len(self.rows) - 1, ENDS))

    def row_of(self, slug: str) -> int:
        """Where a law stands; -1 where it is none of the table."""
        return next((i for i, row in enumerate(self.rows) if row.slug == slug), -1)

    # -- the table ------------------------------------------------------------------------------------------

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self.rows)

    def columnCount(self, parent: Index | None = None) -> int:
        return len(COLUMNS)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Vertical:
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return COLUMNS[section].title
        if role in (Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.StatusTipRole):
            return COLUMNS[section].help
        return _aligned(section) if role == Qt.ItemDataRole.TextAlignmentRole else None

    def flags(self, index: Index) -> Qt.ItemFlag:
        base = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return base | Qt.ItemFlag.ItemIsUserCheckable if index.column() == NAME else base

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        row, column = self.rows[index.row()], index.column()
        marked = row.slug == self._marked[0]
        if role == Qt.ItemDataRole.DisplayRole:
            return self._text(row, column)
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return _aligned(column)
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._tip(row, column)
        if role == Qt.ItemDataRole.FontRole and marked and column == NAME:
            font = QFont()
            font.setBold(True)
            return font
        if role == Qt.ItemDataRole.ForegroundRole and column == ENDS:
            return QColor(SCREEN.quiet)
        if column == NAME and role == Qt.ItemDataRole.CheckStateRole:
            return Qt.CheckState.Checked if row.slug in self._strokes else Qt.CheckState.Unchecked
        if column == NAME and role == Qt.ItemDataRole.DecorationRole:
            return swatch(self._strokes.get(row.slug, -1))
        return None

    def _text(self, row: LawRow, column: int) -> str:
        if column == NAME:
            return f"{row.law.label}  {self._marked[1]}" if row.slug == self._marked[0] else row.law.label
        return row.ends_text if column == ENDS else digits(row.numbers[column - VELOCITY], 4)

    def _tip(self, row: LawRow, column: int) -> str:
        """Formula; all digits; what the ends are like."""
        if column == NAME:
            return f"{row.law.label}: {row.law.source}"
        if column == ENDS:
            return row.ends_help
        return f"{digits(row.numbers[column - VELOCITY], 9)}\n{COLUMNS[column].help}"

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        if role != Qt.ItemDataRole.CheckStateRole or index.column() != NAME:
            return False
        self.tick(self.rows[index.row()].slug, Qt.CheckState(value) == Qt.CheckState.Checked)
        return True

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        """By a column, -1: as the table of laws has them; laws alike in it stay in that order."""
        self.layoutAboutToBeChanged.emit()
        before = [(index, self.rows[index.row()].slug) for index in self.persistentIndexList()]
        self.rows = self._sorted(column, order == Qt.SortOrder.DescendingOrder)
        for index, slug in before:
            self.changePersistentIndex(index, self.index(self.row_of(slug), index.column()))
        self.layoutChanged.emit()

    def _sorted(self, column: int, downwards: bool) -> list[LawRow]:
        rows: Sequence[LawRow] = law_rows()
        if column == NAME:
            return sorted(rows, key=lambda row: row.law.label.casefold(), reverse=downwards)
        if column == ENDS:
            return sorted(rows, key=lambda row: row.ends_text, reverse=downwards)
        if column < 0:
            return list(rows)
        return sorted(rows, key=lambda row: row.numbers[column - VELOCITY], reverse=downwards)

    def as_text(self) -> str:
        """Headings and rows for the clipboard, cells apart by tabs."""
        lines = [[column.title for column in COLUMNS]]
        lines += [[row.law.label, *(f"{n:.9g}" for n in row.numbers), row.ends_text] for row in self.rows]
        return "\n".join("\t".join(line) for line in lines)


def _aligned(column: int) -> Qt.AlignmentFlag:
    return _LEFT if column == NAME else _RIGHT if column < ENDS else Qt.AlignmentFlag.AlignCenter


@of_theme
def swatch(number: int) -> QIcon:
    """A short line in a stroke; a blank of the same size for -1, so that names stand below each other."""
    picture = QPixmap(QSize(56, 24))
    picture.setDevicePixelRatio(2.0)
    picture.fill(Qt.GlobalColor.transparent)
    if number >= 0:
        stroke = stroke_of(number)
        painter = QPainter(picture)
        pen = SCREEN.pen(SCREEN.seen(stroke.colour), 2.0 * stroke.width, stroke.dash)
        painter.setPen(pen)
        painter.drawLine(QPointF(1.0, 6.0), QPointF(27.0, 6.0))
        painter.end()
    return QIcon(picture)


__all__ = ["COLUMNS", "ENDS", "NAME", "LawRow", "LawsModel", "law_rows", "swatch"]
