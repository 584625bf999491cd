"""The curves of a graph as a list, with the buttons that add, copy, remove, move and take back."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QKeyEvent, QPainter, QPixmap
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QMenu, QToolButton, QVBoxLayout, QWidget

from core.frozen import frozen
from kindyna_gui.forms.list_parts import list_button, taken_by_list
from kindyna_gui.pictures.style import SCREEN

LIST_HEIGHT = 128
EMPTY = "No curve yet: press Add, or drop files here"


@frozen
class CurveRow:
    """What the list shows of a curve: name, colour, whether it is drawn; fault: why it is not; note: what was left out of it, or
    what the design at hand has not of it (lacking)."""

    name: str
    colour: str
    shown: bool
    fault: str = ""
    note: str = ""
    lacking: bool = False


class _List(QListWidget):
    """moved (-1 or 1): Alt+Up, Alt+Down; removed: Delete."""

    moved = Signal(int)
    removed = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not taken_by_list(self, event):
            super().keyPressEvent(event)

    def sizeHint(self) -> QSize:
        return QSize(260, LIST_HEIGHT)


class CurveRows(QWidget):
    """List and buttons.

    chosen (int); ticked (int, bool): shown or hidden; removed, copied; moved (-1 or 1)
    """

    chosen = Signal(int)
    ticked = Signal(int, bool)

    def __init__(
        self, slots: dict[str, Callable[[], object]], additions: Sequence[tuple[str, str, Callable[[], object]]]
    ) -> None:
        """slots: of copy, remove, up, down, undo, redo; additions: text, tip and slot of the menu of Add."""
        super().__init__()
        self.list = _List()
        self.list.setAccessibleName("Curves")
        self.list.setAlternatingRowColors(True)
        self.list.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setIconSize(QSize(18, 10))
        self.list.currentRowChanged.connect(self._choose)
        self.list.itemChanged.connect(self._tick)
        self.list.moved.connect(lambda step: slots["up" if step < 0 else "down"]())
        self.list.removed.connect(lambda: slots["remove"]())
        self.menu = QMenu(self)
        for text, tip, slot in additions:
            action = self.menu.addAction(text)
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(lambda _=False, slot=slot: slot())
        add = list_button("Add", "insert", "One curve more", None)
        add.setMenu(self.menu)
        add.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.buttons = {
            "add": add,
            "copy": list_button("Copy", "duplicate", "The chosen curve once more", slots["copy"]),
            "remove": list_button("Remove", "delete", "Take the chosen curve away (Del)", slots["remove"]),
            "up": list_button("↑", "", "Further up in the list (Alt+Up)", slots["up"]),
            "down": list_button("↓", "", "Further down in the list, drawn above (Alt+Down)", slots["down"]),
            "undo": list_button(
                "Undo", "undo", "Take the last change of the graph back (Ctrl+Z in this list)", slots["undo"]
            ),
            "redo": list_button("Redo", "redo", "Make it again (Ctrl+Y in this list)", slots["redo"]),
        }
        bar = QHBoxLayout()
        bar.setContentsMargins(2, 1, 2, 1)
        bar.setSpacing(0)
        for name, button in self.buttons.items():
            if name in ("undo", "redo"):
                button.setEnabled(False)
            if name in ("copy", "remove", "undo", "redo"):
                button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonIconOnly)
            button.setAccessibleName(button.text() if len(button.text()) > 1 else name)
            bar.addWidget(button)
        bar.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        buttons = QWidget()
        buttons.setLayout(bar)
        buttons.setMinimumWidth(1)
        column.addWidget(buttons)
        column.addWidget(self.list, 1)
        self.list.setMinimumSize(1, 40)

    def show_rows(self, rows: Sequence[CurveRow], row: int) -> None:
        """These curves, one of them chosen."""
        with QSignalBlocker(self.list):
            while self.list.count() > len(rows):
                self.list.takeItem(self.list.count() - 1)
            while self.list.count() < len(rows):
                self.list.addItem(QListWidgetItem())
            for i, each in enumerate(rows):
                self._fill(self.list.item(i), each)
            self.list.setCurrentRow(row)
        there = 0 <= row < len(rows)
        enabled = {
            "copy": there,
            "remove": there,
            "up": row > 0,
            "down": there and row < len(rows) - 1,
        }
        for name, on in enabled.items():
            self.buttons[name].setEnabled(on)

    @staticmethod
    def _fill(item: QListWidgetItem, row: CurveRow) -> None:
        mark = "  (not drawn)" if row.fault else "  (not here)" if row.lacking else "  *" if row.note else ""
        item.setText(row.name + mark)
        item.setToolTip(row.fault or row.note or row.name)
        item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsUserCheckable)
        item.setCheckState(Qt.CheckState.Checked if row.shown else Qt.CheckState.Unchecked)
        usual = item.listWidget().palette().text().color() if row.shown and not row.lacking else SCREEN.quiet
        item.setForeground(QColor(SCREEN.limit if row.fault else usual))
        item.setIcon(_swatch(row.colour))

    def _choose(self, row: int) -> None:
        self.chosen.emit(row)

    def _tick(self, item: QListWidgetItem) -> None:
        self.ticked.emit(self.list.row(item), item.checkState() == Qt.CheckState.Checked)


def _swatch(colour: str) -> QIcon:
    """A short line in a colour; nothing where there is none."""
    picture = QPixmap(QSize(36, 20))
    picture.setDevicePixelRatio(2.0)
    picture.fill(Qt.GlobalColor.transparent)
    if colour:
        painter = QPainter(picture)
        painter.fillRect(1, 4, 16, 2, QColor(colour))
        painter.end()
    return QIcon(picture)


__all__ = ["EMPTY", "CurveRow", "CurveRows"]
