"""The cards of the board as a table: a row for each, below that of the design at hand, with how far each value lies from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QAbstractItemView, QTableWidget, QTableWidgetItem

from kindyna_gui.forms.copying import CopyKey
from kindyna_gui.pictures.units import short

AT_HAND = "At hand"
Values = Mapping[str, tuple[float, str]]
"""Name -> (value, text, which begins with the name)."""


class CardsTable(QTableWidget):
    """Double-click a row to take its design over."""

    def __init__(self) -> None:
        super().__init__()
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setAccessibleName("Cards compared")
        CopyKey(self)
        self.setToolTip("In parentheses how far a value lies from that of the design at hand")
        self.redress()

    def redress(self) -> None:
        """As high and wide as its letters want it."""
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.resizeColumnsToContents()

    def show_cards(self, own: Values, cards: Sequence[Values]) -> None:
        """The design at hand, then these."""
        names = list(dict.fromkeys(name for row in (own, *cards) for name in row))
        self.setColumnCount(len(names))
        self.setHorizontalHeaderLabels(names)
        self.setRowCount(1 + len(cards))
        self.setVerticalHeaderLabels([AT_HAND, *(str(i + 1) for i in range(len(cards)))])
        bold = QFont(self.font())
        bold.setBold(True)
        for i, row in enumerate((own, *cards)):
            for j, name in enumerate(names):
                item = QTableWidgetItem(_text(name, row, own if i else {}))
                item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                if not i:
                    item.setFont(bold)
                self.setItem(i, j, item)
        self.resizeColumnsToContents()


def _text(name: str, row: Values, own: Values) -> str:
    if name not in row:
        return "–"
    value, text = row[name]
    shown = text.removeprefix(f"{name} ")
    before = own[name][0] if name in own else float("nan")
    away = value - before
    if away != away or not away:
        return shown
    return f"{shown} ({'+' if away > 0.0 else '−'}{short(abs(away), 3)})"


__all__ = ["CardsTable"]
