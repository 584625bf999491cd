"""The board: designs that were kept as cards with a picture and their values, sorted, and reopened."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QIcon, QKeyEvent, QPixmap
from PySide6.QtWidgets import QHBoxLayout, QListView, QListWidget, QListWidgetItem, QPushButton, QVBoxLayout, QWidget

from core.design import Design
from core.frozen import frozen
from kindyna_gui.forms.amount import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.pictures.thumbnails import thumbnail
from kindyna_gui.studies.cards_table import CardsTable, Values

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
