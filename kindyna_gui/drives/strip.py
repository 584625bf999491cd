"""The strip above the mechanism: the drives on the shaft by name and colour, and how many of them are drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from kindyna_gui.drives.rows import DriveRow
from kindyna_gui.look import tool_bar

ONE, BESIDE, ON_SHAFT = "one", "beside", "shaft"
ARRANGEMENTS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        ONE: ("One", "Draw the chosen drive alone, with all its layers; its joints can be dragged"),
        BESIDE: (
            "Side by side",
            "Draw all drives beside each other, to one scale, at one machine angle; a click chooses",
        ),
        ON_SHAFT: ("On the shaft", "Draw all drives about their common shaft, as seen from this end; a click chooses"),
    }
)
"""How the drives are drawn: text and tip of each way."""


class DriveStrip(QWidget):
    """A button for each drive, the chosen one down; at the right end how they are drawn.

    chosen    (number): a drive was clicked
    arranged  (name in ``ARRANGEMENTS``): another way to draw them was clicked
    """

    chosen = Signal(int)
    arranged = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._rows: tuple[DriveRow, ...] = ()
        self.bar, self.ways = tool_bar("Drives on the shaft", self), tool_bar("How the drives are drawn", self)
        self.bar.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.bar.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.bar.setIconSize(QSize(14, 14))
        self._group: QActionGroup | None = None
        ways = QActionGroup(self)
        self.arrangements: dict[str, QAction] = {}
        for name, (text, tip) in ARRANGEMENTS.items():
            action = ways.addAction(text)
            action.setCheckable(True)
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(partial(self._arrange, name))
            self.arrangements[name] = action
            self.ways.addAction(action)
        self.arrangements[ONE].setChecked(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(4, 1, 4, 1)
        row.setSpacing(0)
        row.addWidget(self.bar, 1)
        row.addWidget(self.ways)
        self.hide()

    def _arrange(self, name: str, *_: object) -> None:
        self.arranged.emit(name)

    def show_drives(self, rows: Sequence[DriveRow], chosen: int) -> None:
        """Name these drives, of which one is chosen."""
        if tuple(rows) != self._rows:
            self._rows = tuple(rows)
            self._build()
        if self._group is not None and chosen < len(rows):
            self._group.actions()[chosen].setChecked(True)

    @property
    def actions_of_drives(self) -> list[QAction]:
        """One for each drive, in their order."""
        return [] if self._group is None else self._group.actions()

    def _build(self) -> None:
        self.bar.clear()
        if self._group is not None:
            self._group.deleteLater()
        self._group = QActionGroup(self)
        for number, row in enumerate(self._rows):
            action = self._group.addAction(row.icon, row.name.replace("&", "&&"))
            action.setCheckable(True)
            tip = row.problem or f"Show {row.name} in the forms and plots"
            action.setToolTip(tip)
            action.setStatusTip(tip)
            action.triggered.connect(partial(self._choose, number))
            self.bar.addAction(action)

    def _choose(self, number: int, *_: object) -> None:
        self.chosen.emit(number)


__all__ = ["ARRANGEMENTS", "BESIDE", "ONE", "ON_SHAFT", "DriveStrip"]
