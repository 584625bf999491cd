"""Kept cards."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QFont, QIcon, QKeyEvent, QPixmap
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QListView,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from core.bounds import bounded_json
from core.design import Design
from core.errors import KindynaError
from core.frozen import frozen
from core.project import dumps, loads
from core.project.files import read_text, write_into
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.tables import CopyKey
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.units import short
from kindyna_gui.places import state_folder

# -- cards table -----------------------------------------------------------------------------------------

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
        self.update_style()

    def update_style(self) -> None:
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


# -- board -----------------------------------------------------------------------------------------------

PICTURE = QSize(112, 72)  # pixels
CARD_WIDTH, LINES = 304, 6
AS_KEPT = ""


@frozen(eq=False)
class Card:
    """A whole design, and name -> (value, text) of its numbers and of what was asked of it."""

    design: Design
    values: Mapping[str, tuple[float, str]]


class _List(QListWidget):
    """Cards beside each other; Delete takes the chosen one away."""

    taken = Signal(QListWidgetItem)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Delete and self.currentRow() >= 0:
            self.taken.emit(self.currentItem())
        else:
            super().keyPressEvent(event)


class Board(QWidget):
    """kept: the design at hand is to be kept; reopened, pinned (Design): a card was opened, or is to be held against the design; changed:
    there are other cards; compared: they are shown as a table, beside the values of the design at hand (``show_present``)."""

    kept = Signal()
    changed = Signal()
    compared = Signal()
    reopened = Signal(object)
    pinned = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.cards: list[Card] = []
        self.keep, self.sort = QPushButton("Keep this design"), WordBox()
        self.keep.setToolTip("Put the design at hand on the board, with its values")
        self.keep.setAutoDefault(False)
        self.sort.setAccessibleName("Sort the cards by")
        self.list = _List()
        self.list.setAccessibleName("Board")
        self.list.setFlow(QListView.Flow.LeftToRight)
        self.list.setWrapping(False)
        self.list.setMovement(QListView.Movement.Static)
        self.list.setIconSize(PICTURE)
        self.list.setWordWrap(True)
        self.list.setToolTip("Double-click a card to take its design over; right click to pin it; Delete takes it away")
        self.list.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        for text, slot in (("Pin this variant", self._pin), ("Take it over", self._open), ("Take it away", self._take)):
            action = QAction(text, self.list)
            action.triggered.connect(partial(self._of_current, slot))
            self.list.addAction(action)
        self.compare = QPushButton("Compare")
        self.compare.setCheckable(True)
        self.compare.setAutoDefault(False)
        self.compare.setToolTip("The cards as a table, each value with how far it lies from that of the design at hand")
        self.compare.hide()
        self.table = CardsTable()
        self.table.hide()
        self._present: Values = {}
        self._height = self.fontMetrics().lineSpacing()
        self.list.hide()
        self.sort.hide()
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.keep)
        row.addStretch(1)
        row.addWidget(self.compare)
        row.addWidget(self.sort)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(2)
        column.addLayout(row)
        column.addWidget(self.list)
        column.addWidget(self.table)
        self.compare.toggled.connect(self._switch)
        self.table.cellDoubleClicked.connect(self._open_row)
        self.keep.clicked.connect(self.kept)
        self.sort.activated.connect(self._show)
        self.list.itemActivated.connect(self._open)
        self.list.taken.connect(self._take)

    def put(self, card: Card) -> None:
        """One card more."""
        self.cards.append(card)
        self.changed.emit()
        self._show()

    def show_cards(self, cards: Sequence[Card]) -> None:
        """These, and no others."""
        self.cards = list(cards)
        self._show()

    @property
    def comparing(self) -> bool:
        """Whether the cards are shown as a table."""
        return self.compare.isChecked() and bool(self.cards)

    def show_present(self, values: Values) -> None:
        """What the design at hand has, for the table."""
        self._present = values
        if self.comparing:
            self.table.show_cards(values, [card.values for card in self.order])

    def _switch(self, _: bool) -> None:
        self.compared.emit()
        self._show()

    def _open_row(self, row: int, _: int) -> None:
        if row:
            self.reopened.emit(self.order[row - 1].design)

    @property
    def order(self) -> Sequence[Card]:
        """The cards as they stand there: by the least value first of what they are sorted by, those without one last."""
        by = self.sort.currentData() or AS_KEPT
        return self.cards if by == AS_KEPT else sorted(self.cards, key=lambda card: _place(card, by))

    def _show(self, *_: object) -> None:
        names = dict.fromkeys(name for card in self.cards for name in card.values)
        fill_choices(self.sort, {AS_KEPT: "as kept", **{name: f"by {name}" for name in names}})
        self.list.clear()
        lines = 0
        for card in self.order:
            picture = thumbnail(card.design, PICTURE.width(), PICTURE.height(), self.devicePixelRatioF())
            texts = [text for _, text in card.values.values()]
            lines = max(lines, min(len(texts), LINES))
            item = QListWidgetItem(QIcon(QPixmap.fromImage(picture)), "\n".join(texts[:LINES]))
            item.setToolTip("\n".join(f"{name}: {text}" for name, (_, text) in card.values.items()))
            item.setData(Qt.ItemDataRole.UserRole, self.cards.index(card))
            self.list.addItem(item)
        height = max(PICTURE.height(), lines * self._height) + 8
        for i in range(self.list.count()):
            self.list.item(i).setSizeHint(QSize(CARD_WIDTH, height))
        self.list.setFixedHeight(height + 24)
        self.table.setFixedHeight(height + 24)
        self.list.setVisible(bool(self.cards) and not self.comparing)
        self.table.setVisible(self.comparing)
        self.compare.setVisible(bool(self.cards))
        self.sort.setVisible(len(self.cards) > 1)
        self.show_present(self._present)

    def _open(self, item: QListWidgetItem) -> None:
        self.reopened.emit(self.cards[item.data(Qt.ItemDataRole.UserRole)].design)

    def _of_current(self, act: Callable[[QListWidgetItem], None], *_: object) -> None:
        if (item := self.list.currentItem()) is not None:
            act(item)

    def _pin(self, item: QListWidgetItem) -> None:
        self.pinned.emit(self.cards[item.data(Qt.ItemDataRole.UserRole)].design)

    def _take(self, item: QListWidgetItem) -> None:
        del self.cards[item.data(Qt.ItemDataRole.UserRole)]
        self.changed.emit()
        self._show()


def _place(card: Card, by: str) -> tuple[bool, float]:
    value = card.values[by][0] if by in card.values else float("nan")
    return value != value, value


# -- kept cards ------------------------------------------------------------------------------------------

FOLDER = "boards"


def _file(of: str) -> Path:
    return state_folder() / FOLDER / f"{sha256(of.encode()).hexdigest()[:24]}.json"


def read_cards(of: str) -> list[Card]:
    """Those of a design, by its file or its name; none where nothing was kept, or what was kept cannot be read."""
    try:
        rows = bounded_json(read_text(_file(of)))["cards"]
        return [
            Card(loads(row["design"]), {name: (value, text) for name, (value, text) in row["values"].items()})
            for row in rows
        ]
    except (OSError, ValueError, KeyError, TypeError, AttributeError, KindynaError):
        return []


def write_cards(of: str, cards: Sequence[Card]) -> None:
    """Keep them. Raises FileError."""
    rows = [{"design": dumps(card.design), "values": dict(card.values)} for card in cards]
    text = json.dumps({"of": of, "cards": rows}, ensure_ascii=False, indent=1)
    write_into(_file(of).parent, {_file(of).name: text})
