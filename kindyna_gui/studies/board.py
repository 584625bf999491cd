"""Board of saved designs: cards with an image and values, a table that compares them, and their file."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QFont, QIcon, QImage, QKeyEvent, QPixmap
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QLayout,
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
from core.process import user_folder
from core.project import dumps, loads
from core.project.files import read_text, write_into
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.tables import CopyKey
from kindyna_gui.look import described
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.units import short
from kindyna_gui.rebuilt import STRETCH, connect_all, fill

CURRENT = "Current"
IMAGE = QSize(112, 72)  # pixels
CARD_WIDTH, CARD_LETTERS, CARD_LINES = 304, 30, 6
UNSORTED = ""
BAR = 24  # height of the scroll bar below the cards [pixels]
FOLDER = "boards"
STEP_MS = 40  # between two images of a card that moves
Values = Mapping[str, tuple[float, str]]
"""Name -> (value, text, which begins with the name)."""

# -- table of cards --------------------------------------------------------------------------------------


class CardsTable(QTableWidget):
    """Table that compares the cards with the current design; a double click on a row applies its design."""

    def __init__(self) -> None:
        super().__init__()
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setAccessibleName("Cards compared")
        CopyKey(self)
        self.setToolTip("In parentheses: difference from the current design")
        self.update_style()

    def update_style(self) -> None:
        """Fit rows and columns to the font."""
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        self.resizeColumnsToContents()

    def show_cards(self, current: Values, cards: Sequence[Values]) -> None:
        """Show the values of the current design, if there are any, then those of the cards."""
        names = list(dict.fromkeys(name for row in (current, *cards) for name in row))
        self.setColumnCount(len(names))
        self.setHorizontalHeaderLabels(names)
        self.setRowCount(1 + len(cards))
        self.setVerticalHeaderLabels([CURRENT, *(str(i + 1) for i in range(len(cards)))])
        self.setRowHidden(0, not current)
        bold = QFont(self.font())
        bold.setBold(True)
        for i, row in enumerate((current, *cards)):
            for j, name in enumerate(names):
                item = QTableWidgetItem(_cell_text(name, row, current if i else {}))
                item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                if not i:
                    item.setFont(bold)
                self.setItem(i, j, item)
        self.resizeColumnsToContents()


def _cell_text(name: str, row: Values, current: Values) -> str:
    """Value of a card with its difference from the current design."""
    if name not in row:
        return "–"
    value, text = row[name]
    text = text.removeprefix(f"{name} ")
    difference = value - current[name][0] if name in current else float("nan")
    if difference != difference or not difference:
        return text
    return f"{text} ({'+' if difference > 0.0 else '−'}{short(abs(difference), 3)})"


# -- board -----------------------------------------------------------------------------------------------


@frozen(eq=False)
class Card:
    """A design with name -> (value, text) of its varied numbers and its figures.

    Attributes
    ----------
    picture : callable or None
        Image of its mechanism by size in pixels, pixels of the device per pixel, and step of its motion; the mouse on the card
        lets it move. None: an image at rest.
    """

    design: Design
    values: Values
    picture: Callable[[QSize, float, int], QImage] | None = None


class _List(QListWidget):
    """Cards in a row; Delete removes the selected one."""

    delete_requested = Signal(QListWidgetItem)
    mouse_left = Signal()

    def leaveEvent(self, event: QEvent) -> None:
        self.mouse_left.emit()
        super().leaveEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Delete and self.currentRow() >= 0:
            self.delete_requested.emit(self.currentItem())
        else:
            super().keyPressEvent(event)


class Board(QWidget):
    """Cards of saved designs, as a row of images or as a table.

    Signals: ``keep_requested``, save the current design; ``changed``, cards were added or removed; ``compared``, the
    table is on display and needs the current values (``show_current``); ``reopened`` and ``pinned`` (Design), apply
    the design of a card, or pin it. ``unsorted`` names the order in which the cards were added.
    """

    keep_requested = Signal()
    changed = Signal()
    compared = Signal()
    reopened = Signal(object)
    pinned = Signal(object)

    def __init__(self, unsorted: str = "in the order of saving") -> None:
        super().__init__()
        self._unsorted = unsorted
        self.cards: list[Card] = []
        self.keep, self.sort = QPushButton("Keep this design"), WordBox()
        self.keep.setToolTip("Put the current design on the board, with its values")
        self.keep.setAutoDefault(False)
        self.sort.setAccessibleName("Sort the cards by")
        self.list = described(
            _List(),
            name="Board",
            tip="Double-click a card to apply its design; right-click to pin it; Delete removes it",
        )
        self.list.setFlow(QListView.Flow.LeftToRight)
        self.list.setWrapping(False)
        self.list.setMovement(QListView.Movement.Static)
        self.list.setIconSize(IMAGE)
        self.list.setWordWrap(True)
        self.list.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        for text, slot in (("Pin this variant", self._pin), ("Apply", self._open), ("Remove", self._remove)):
            action = QAction(text, self.list)
            action.triggered.connect(partial(self._call_for_current, slot))
            self.list.addAction(action)
        self.compare = described(
            QPushButton("Compare", autoDefault=False),
            tip="Show the cards in a table, each value with its difference from the current design",
        )
        self.compare.setCheckable(True)
        self.compare.hide()
        self.table = CardsTable()
        self.table.hide()
        self._current: Values = {}
        self.list.hide()
        self.sort.hide()
        self._moving: tuple[QListWidgetItem, Card] | None = None  # card under the mouse
        self._shown_cards: Sequence[Card] = ()  # in the list
        self._step = 0
        self._clock = QTimer(self, interval=STEP_MS)
        self.list.setMouseTracking(True)
        self._row = fill(QHBoxLayout(), self.keep, STRETCH, self.compare, self.sort, margins=0)
        fill(QVBoxLayout(self), self._row, self.list, self.table, margins=0, spacing=2)
        connect_all(
            (self.compare.toggled, self._switch),
            (self.table.cellDoubleClicked, self._open_row),
            (self.keep.clicked, self.keep_requested),
            (self.sort.activated, self._show),
            (self.list.itemActivated, self._open),
            (self.list.delete_requested, self._remove),
            (self.list.itemEntered, self._move_card),
            (self.list.viewportEntered, self._rest),
            (self.list.mouse_left, self._rest),
            (self._clock.timeout, self._turn),
        )

    def set_header(self, first: QLayout, last: QWidget) -> None:
        """Put more into the row above the cards, in front of the choices and behind them."""
        self._row.insertLayout(0, first, 1)
        self._row.addWidget(last)

    def add(self, card: Card) -> None:
        """Add a card."""
        self.cards.append(card)
        self.changed.emit()
        self._show()

    def show_cards(self, cards: Sequence[Card]) -> None:
        """Replace the cards."""
        self.cards = list(cards)
        self._show()

    @property
    def is_comparing(self) -> bool:
        """Whether the cards are shown as a table."""
        return self.compare.isChecked() and bool(self.cards)

    def show_current(self, values: Values) -> None:
        """Show the values of the current design in the table."""
        self._current = values
        if self.is_comparing:
            self.table.show_cards(values, [card.values for card in self.order])

    def _switch(self, _: bool) -> None:
        self.compared.emit()
        self._show()

    def _open_row(self, row: int, _: int) -> None:
        if row:
            self.reopened.emit(self.order[row - 1].design)

    @property
    def order(self) -> Sequence[Card]:
        """Return the cards in ascending order of the value to sort by, cards without this value last."""
        name = self.sort.currentData() or UNSORTED
        return self.cards if name == UNSORTED else sorted(self.cards, key=lambda card: _sort_key(card, name))

    def _show(self, *_: object) -> None:
        names = dict.fromkeys(name for card in self.cards for name in card.values)
        fill_choices(self.sort, {UNSORTED: self._unsorted, **{name: f"by {name}" for name in names}})
        self._rest()
        selected, self._shown_cards = self._selected, list(self.order)
        self.list.clear()
        lines = 0
        for card in self._shown_cards:
            texts = [text for _, text in card.values.values()]
            lines = max(lines, min(len(texts), CARD_LINES))
            item = QListWidgetItem(self._icon(card), "\n".join(texts[:CARD_LINES]))
            item.setToolTip("\n".join(f"{name}: {text}" for name, (_, text) in card.values.items()))
            item.setData(Qt.ItemDataRole.UserRole, self.cards.index(card))
            self.list.addItem(item)
            if card is selected:
                self.list.setCurrentItem(item)
        metrics = self.fontMetrics()
        height = card_height(lines * metrics.lineSpacing()) - BAR
        width = max(CARD_WIDTH, IMAGE.width() + CARD_LETTERS * metrics.averageCharWidth())
        for i in range(self.list.count()):
            self.list.item(i).setSizeHint(QSize(width, height))
        self.list.setFixedHeight(height + BAR)
        self.table.setFixedHeight(height + BAR)
        self.list.setVisible(bool(self.cards) and not self.is_comparing)
        self.table.setVisible(self.is_comparing)
        self.compare.setVisible(bool(self.cards))
        self.sort.setVisible(len(self.cards) > 1)
        self.show_current(self._current)

    @property
    def _selected(self) -> Card | None:
        """The card that is selected in the list, if it is still on the board."""
        item, shown = self.list.currentItem(), self._shown_cards
        card = shown[self.list.row(item)] if item is not None and self.list.row(item) < len(shown) else None
        return card if card in self.cards else None

    def _icon(self, card: Card, step: int = 0) -> QIcon:
        """Image of a card, at a step of its motion."""
        ratio, paint = self.devicePixelRatioF(), card.picture
        image = paint(IMAGE, ratio, step) if paint else thumbnail(card.design, IMAGE.width(), IMAGE.height(), ratio)
        return QIcon(QPixmap.fromImage(image))

    def _move_card(self, item: QListWidgetItem) -> None:
        """Let the image of the card under the mouse move."""
        self._rest()
        card = self.cards[item.data(Qt.ItemDataRole.UserRole)]
        if card.picture is not None:
            self._moving, self._step = (item, card), 0
            self._clock.start()

    def _turn(self) -> None:
        if self._moving is not None:
            item, card = self._moving
            self._step += 1
            item.setIcon(self._icon(card, self._step))

    def _rest(self) -> None:
        self._moving = None
        self._clock.stop()

    def _open(self, item: QListWidgetItem) -> None:
        self.reopened.emit(self.cards[item.data(Qt.ItemDataRole.UserRole)].design)

    def _call_for_current(self, act: Callable[[QListWidgetItem], None], *_: object) -> None:
        if (item := self.list.currentItem()) is not None:
            act(item)

    def _pin(self, item: QListWidgetItem) -> None:
        self.pinned.emit(self.cards[item.data(Qt.ItemDataRole.UserRole)].design)

    def _remove(self, item: QListWidgetItem) -> None:
        del self.cards[item.data(Qt.ItemDataRole.UserRole)]
        self.changed.emit()
        self._show()


def card_height(text: int) -> int:
    """Height of the row of cards with texts of this height, with its scroll bar [pixels]."""
    return max(IMAGE.height(), text) + 8 + BAR


def _sort_key(card: Card, name: str) -> tuple[bool, float]:
    value = card.values[name][0] if name in card.values else float("nan")
    return value != value, value


# -- file of the cards -----------------------------------------------------------------------------------


class BoardFile(QObject):
    """The file in which the cards of the current design are saved; a design saved under a new name keeps its cards.

    Signals: ``message`` (str), the cards cannot be saved.
    """

    message = Signal(str)

    def __init__(self, session: Session, board: Board) -> None:
        super().__init__(board)
        self._session, self._board = session, board
        self._owner = ""  # file or name of the design whose cards are on the board; empty before they are read
        session.started.connect(self._forget)
        session.file_changed.connect(self._follow_file)
        board.changed.connect(self._save)

    def load(self) -> None:
        """Show the cards of the current design, unless they are shown already."""
        if not self._owner:
            self._owner = self._current_owner
            self._board.show_cards(read_cards(self._owner))

    @property
    def _current_owner(self) -> str:
        path = self._session.path
        return f"without a file: {self._session.full_design.name}" if path is None else str(path.absolute())

    def _forget(self) -> None:
        self._owner = ""

    def _follow_file(self) -> None:
        if self._owner and self._session.path is not None and self._current_owner != self._owner:
            self._owner = self._current_owner
            self._save()

    def _save(self) -> None:
        try:
            write_cards(self._owner, self._board.cards)
        except KindynaError as error:
            self.message.emit(f"The cards cannot be saved: {error}")


def _file(owner: str) -> Path:
    return user_folder("state") / FOLDER / f"{sha256(owner.encode()).hexdigest()[:24]}.json"


def read_cards(owner: str) -> list[Card]:
    """Return the cards of a design, given by its file or its name; none where they are missing or cannot be read."""
    try:
        rows = bounded_json(read_text(_file(owner)))["cards"]
        return [
            Card(loads(row["design"]), {name: (value, text) for name, (value, text) in row["values"].items()})
            for row in rows
        ]
    except (OSError, ValueError, KeyError, TypeError, AttributeError, KindynaError):
        return []


def write_cards(owner: str, cards: Sequence[Card]) -> None:
    """Save the cards of a design. Raises FileError."""
    rows = [{"design": dumps(card.design), "values": dict(card.values)} for card in cards]
    text = json.dumps({"of": owner, "cards": rows}, ensure_ascii=False, indent=1)
    write_into(_file(owner).parent, {_file(owner).name: text})
