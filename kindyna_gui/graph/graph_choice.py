"""Channels and files."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from html import escape
from pathlib import Path
from types import MappingProxyType

from PySide6.QtCore import QFileSystemWatcher, QObject, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPixmap, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTreeWidget, QTreeWidgetItem

from core.errors import KindynaError
from core.numerics.lazy import Cancelled
from core.output.graph import DesignSource, Source, read_source
from core.study import Quantity
from core.study.quantities import DYNAMICS, KINEMATICS, LINKAGE, ORBIT, PROFILE, SERVO
from kindyna_gui.background import Background
from kindyna_gui.forms.tables import CopyKey
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import legible

# -- graph choice ----------------------------------------------------------------------------------------

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


# -- graph sources ---------------------------------------------------------------------------------------

PAUSE_MS, PROGRESS_MS = 100, 100
Stamp = tuple[int, int, int] | None
READING, CANCELLED = "is being read", "reading was cancelled; Files > Read files again reads it"


def _stamp(path: str) -> Stamp:
    """By which a file is seen to be another; None where there is none."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


@dataclass
class _File:
    """source: as last read, None where it never was; fault: why it could not be, now; note: why it may be out of date."""

    source: Source | None = None
    fault: str = READING
    note: str = ""
    stamp: Stamp = None
    wanted: bool = True  # is to be read


class GraphSources(QObject):
    """What the rows of a graph name, by the path of its file.

    changed    a source has come, changed, or vanished
    progress   (what is being read, 0 ... 1); an empty text: nothing is
    """

    changed = Signal()
    progress = Signal(str, float)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.design: DesignSource | None = None
        self._files: dict[str, _File] = {}
        self._done: dict[str, float] = {}
        self._work = Background(self, 20)
        self._work.result.connect(self._take)
        self._system = QFileSystemWatcher(self)
        self._soon = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._soon.timeout.connect(self.compare)
        self._system.fileChanged.connect(lambda _: self._soon.start())
        self._system.directoryChanged.connect(lambda _: self._soon.start())
        self._ticking = QTimer(self, interval=PROGRESS_MS)
        self._ticking.timeout.connect(self._tell)

    # -- what there is --------------------------------------------------------------------------------------

    def __call__(self, name: str) -> Source:
        """The source of a row. Raises KindynaError where it is not there, or not yet."""
        if not name:
            if self.design is None:
                raise KindynaError("there is no design")
            return self.design
        file = self._files.get(name)
        if file is None or file.source is None:
            raise KindynaError(f"{Path(name).name}: {file.fault if file else READING}")
        return file.source

    def note(self, name: str) -> str:
        """Why what is shown of a file may be out of date; empty where it is not."""
        file = self._files.get(name)
        return f"{Path(name).name} {file.note}" if file is not None and file.note else ""

    @property
    def names(self) -> tuple[str, ...]:
        """The files, in the order in which they came."""
        return tuple(self._files)

    @property
    def reading(self) -> bool:
        """Whether there are files whose numbers are still to come."""
        return self._work.busy

    @property
    def busy(self) -> bool:
        return self.reading or self._soon.isActive()

    # -- reading --------------------------------------------------------------------------------------------

    def want(self, names: Iterable[str]) -> None:
        """These files and no others: what is new is read."""
        wanted = [name for name in dict.fromkeys(names) if name]
        new = [name for name in wanted if name not in self._files]
        if set(self._files) == set(wanted):
            return
        self._files = {name: self._files.get(name) or _File() for name in wanted}
        self._watch()
        if new:
            self._read()

    def read_again(self) -> None:
        """All files, also those that could not be read, or whose reading was cancelled."""
        for file in self._files.values():
            file.wanted = True
        self._read()

    def _read(self) -> None:
        open_ones = [name for name, file in self._files.items() if file.wanted]
        if not open_ones:
            return
        self._done = dict.fromkeys(open_ones, 0.0)
        for name in open_ones:
            self._files[name].stamp = _stamp(name)
        self._work.start([(name, partial(self._job, self._done, name)) for name in open_ones])
        self._ticking.start()

    @staticmethod
    def _job(done: dict[str, float], name: str) -> Source:
        return read_source(Path(name), partial(done.__setitem__, name))

    def cancel(self) -> None:
        """Read no further; the rows of what was not read say so."""
        self._work.cancel()

    def _take(self, name: str, result: object) -> None:
        self._done.pop(name, None)
        stopped = isinstance(result, Cancelled)
        for each in [key for key, file in self._files.items() if file.wanted] if stopped else [name]:
            if each in self._files:
                self._keep(self._files[each], result)
        if stopped or not self._done:
            self._ticking.stop()
            self.progress.emit("", 0.0)
        self.changed.emit()

    @staticmethod
    def _keep(file: _File, result: object) -> None:
        file.wanted = False
        if isinstance(result, Cancelled | KindynaError):
            file.fault = (
                CANCELLED
                if isinstance(result, Cancelled)
                else str(result).split("\n")[0].partition(": ")[2] or str(result)
            )
            if file.source is not None:
                file.note = f"has changed and cannot be read ({file.fault}); shown as it was read last"
        else:
            file.source, file.fault, file.note = result, "", ""  # type: ignore[assignment]

    def _tell(self) -> None:
        if self._done:
            name = next(iter(self._done))
            self.progress.emit(Path(name).name, self._done[name])

    # -- watching -------------------------------------------------------------------------------------------

    def compare(self) -> None:
        """Look at all files now: what has changed is read again, what has vanished is kept as it was."""
        self._soon.stop()
        self._watch()
        changed = False
        for name, file in self._files.items():
            stamp = _stamp(name)
            if stamp == file.stamp:
                continue
            changed = True
            file.stamp = stamp
            if stamp is None:
                file.note = "has vanished; shown as it was read last" if file.source is not None else ""
            else:
                file.wanted = True
        if any(file.wanted for file in self._files.values()):
            self._read()
        if changed:
            self.changed.emit()

    def _watch(self) -> None:
        wanted = {str(each) for name in self._files for each in (Path(name), Path(name).parent) if each.exists()}
        watched = {*self._system.files(), *self._system.directories()}
        if watched - wanted:
            self._system.removePaths(sorted(watched - wanted))
        if wanted - watched:
            self._system.addPaths(sorted(wanted - watched))

    def close(self) -> None:
        """Nothing is read any longer."""
        self._ticking.stop()
        self._work.close()
