"""What a graph shows: which channels in which plot. And the tree of channels to tick."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from types import MappingProxyType

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPixmap, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTreeWidget, QTreeWidgetItem

from core.study import Quantity
from core.study.quantities import DYNAMICS, KINEMATICS, LINKAGE, ORBIT, PROFILE, SERVO
from kindyna_gui.forms.copying import CopyKey
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import legible

GROUPS: Mapping[str, str] = MappingProxyType(
    {
        KINEMATICS: "Kinematics",
        LINKAGE: "Linkage",
        PROFILE: "Cam profile",
        DYNAMICS: "Dynamics",
        SERVO: "Servo",
        ORBIT: "Flexible shaft, steady",
    }
)
"""Tables of the core in the order of the tree."""

HEADINGS = ("Quantity", "", "Unit")
LEAST_WIDTH, USUAL_WIDTH, ROW_HEIGHT = 150, 272, 20  # pixels; symbols are left out where the tree is narrow
FIRST = (("displacement",), ("velocity",), ("acceleration",))
"""Quantities of the plots a new graph begins with."""


@dataclass
class Choice:
    """Plots in order, each a list of quantities, and which of them takes the next one ticked."""

    plots: list[list[str]] = field(default_factory=lambda: [list(row) for row in FIRST])
    active: int = 0

    @property
    def chosen(self) -> list[str]:
        """Every quantity shown, in the order of the plots."""
        return [name for plot in self.plots for name in plot]

    def tick(self, name: str, units: Mapping[str, str]) -> None:
        """Show a quantity: in the active plot where that is empty or of the same unit, else in a plot of its own.

        units: unit of each quantity.
        """
        if name in self.chosen:
            return
        here = self.plots[self.active] if self.plots else None
        if here is not None and all(units[other] == units[name] for other in here):
            here.append(name)
            return
        self.plots.append([name])
        self.active = len(self.plots) - 1

    def untick(self, name: str) -> None:
        """Show a quantity no longer; a plot that has nothing left goes, too."""
        for index, plot in enumerate(self.plots):
            if name in plot:
                plot.remove(name)
                if not plot:
                    self.remove(index)
                return

    def add(self) -> None:
        """An empty plot at the end, which takes what is ticked next; there is never more than one."""
        if [] not in self.plots:
            self.plots.append([])
        self.active = self.plots.index([])

    def remove(self, index: int) -> None:
        """A plot less."""
        del self.plots[index]
        if index < self.active or self.active >= len(self.plots):
            self.active = max(0, self.active - 1)

    def keep(self, names: Iterable[str]) -> None:
        """Drop what this kind of design does not have."""
        known = set(names)
        for name in [name for name in self.chosen if name not in known]:
            self.untick(name)


def tip_of(row: Quantity) -> str:
    """Equation and source of a channel."""
    lines = [f"<b>{escape(row.label)}</b> {escape(legible(row.symbol))}"]
    lines.append(f"{escape(legible(row.equation))}<br>Source: {escape(row.source)}")
    lines.append(f"<span style='color:{SCREEN.quiet}'>column {escape(row.slug)} of {row.table}</span>")
    return "<br>".join(lines)


class ChannelTree(QTreeWidget):
    """Every channel of a design, by the table it stands in, to be ticked.

    ticked   (quantity, on): the user has ticked or unticked a quantity
    """

    ticked = Signal(str, bool)

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Channels")
        self.setHeaderLabels(HEADINGS)
        self.setRootIsDecorated(False)
        self.setIndentation(4)
        self.setMinimumWidth(LEAST_WIDTH)
        self.setUniformRowHeights(True)
        self.setAlternatingRowColors(True)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setIconSize(QSize(12, 10))
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        head = self.header()
        head.setStretchLastSection(False)
        head.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        CopyKey(self)
        self._items: dict[str, QTreeWidgetItem] = {}
        self._rows: tuple[Quantity, ...] = ()
        self.itemChanged.connect(self._changed)
        self.itemClicked.connect(self._clicked)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.setColumnHidden(1, self.width() < USUAL_WIDTH - 4)

    def show_rows(self, rows: Sequence[Quantity], reasons: Mapping[str, str]) -> None:
        """List these channels; reasons: why some cannot be drawn, by quantity."""
        with QSignalBlocker(self):
            if tuple(rows) != self._rows:
                self._build(rows)
            for row in rows:
                item, why = self._items[row.name], reasons.get(row.name, "")
                item.setForeground(0, QColor(SCREEN.quiet if why else SCREEN.ink))
                item.setToolTip(0, escape(why) or tip_of(row))

    def _build(self, rows: Sequence[Quantity]) -> None:
        self.clear()
        self._rows, self._items = tuple(rows), {}
        for table, title in GROUPS.items():
            if not any(row.table == table for row in rows):
                continue
            group = QTreeWidgetItem(self, [title])
            group.setFirstColumnSpanned(True)
            group.setSizeHint(0, QSize(0, ROW_HEIGHT))
            bold = group.font(0)
            bold.setBold(True)
            group.setFont(0, bold)
            group.setFlags(Qt.ItemFlag.ItemIsEnabled)
            for row in rows:
                if row.table == table:
                    self._items[row.name] = _item(group, row)
            group.setExpanded(True)

    def show_ticks(self, names: Iterable[str]) -> None:
        """Tick these and no others."""
        on = set(names)
        with QSignalBlocker(self):
            for name, item in self._items.items():
                item.setCheckState(0, Qt.CheckState.Checked if name in on else Qt.CheckState.Unchecked)

    def item_of(self, quantity: str) -> QTreeWidgetItem:
        """The line of a quantity. Raises KeyError."""
        return self._items[quantity]

    def _changed(self, item: QTreeWidgetItem, column: int) -> None:
        name = item.data(0, Qt.ItemDataRole.UserRole)
        if name and column == 0:
            self.ticked.emit(name, item.checkState(0) == Qt.CheckState.Checked)

    def _clicked(self, item: QTreeWidgetItem, column: int) -> None:
        """Symbol and unit belong to the box as its name does."""
        if column > 0 and item.data(0, Qt.ItemDataRole.UserRole):
            on = item.checkState(0) == Qt.CheckState.Checked
            item.setCheckState(0, Qt.CheckState.Unchecked if on else Qt.CheckState.Checked)


def _item(group: QTreeWidgetItem, row: Quantity) -> QTreeWidgetItem:
    item = QTreeWidgetItem(group, [row.label, legible(row.symbol), row.unit.symbol])
    item.setData(0, Qt.ItemDataRole.UserRole, row.name)
    item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsUserCheckable | Qt.ItemFlag.ItemIsSelectable)
    item.setCheckState(0, Qt.CheckState.Unchecked)
    item.setSizeHint(0, QSize(0, ROW_HEIGHT))
    item.setIcon(0, _swatch(SCREEN.family(row.family)))
    for column in range(len(HEADINGS)):
        item.setToolTip(column, tip_of(row))
    return item


def _swatch(colour: str) -> QIcon:
    """A short line in the colour of a family."""
    picture = QPixmap(QSize(24, 20))
    picture.setDevicePixelRatio(2.0)
    picture.fill(Qt.GlobalColor.transparent)
    painter = QPainter(picture)
    painter.fillRect(1, 4, 11, 2, QColor(colour))
    painter.end()
    return QIcon(picture)
