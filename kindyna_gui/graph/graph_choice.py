"""Selection of channels for the page Graph, and files read in the background for the page Curves."""

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
from core.study.quantities import CLEARANCES, DYNAMICS, KINEMATICS, LINKAGE, ORBIT, PROFILE, SERVO
from kindyna_gui.background import Background
from kindyna_gui.forms.tables import CopyKey
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import legible

GROUPS: Mapping[str, str] = MappingProxyType(
    {
        KINEMATICS: "Kinematics",
        LINKAGE: "Linkage",
        CLEARANCES: "Clearances",
        PROFILE: "Cam profile",
        DYNAMICS: "Dynamics",
        SERVO: "Servo",
        ORBIT: "Flexible shaft, steady",
    }
)
"""Tables of core in the order of the tree, with their titles."""

HEADINGS = ("Quantity", "", "Unit")
BESIDE_NAMES = 76  # pixels of a row for its box, the sign of its curve and the gaps between the columns
LEAST_WIDTH, DEFAULT_WIDTH, ROW_HEIGHT = 150, 272, 20  # pixels; a narrower tree hides the symbols
FIRST = (("displacement",), ("velocity",), ("acceleration",))
"""Quantities of each plot of a new graph."""
PAUSE_MS, PROGRESS_MS = 100, 100
Stamp = tuple[int, int, int] | None
"""Time of the last change [ns], size [bytes] and inode of a file; None if it does not exist."""
READING = "is being read"
CANCELLED = "reading was cancelled; Files > Read files again reads it"

# -- channels of a graph ---------------------------------------------------------------------------------


@dataclass
class PlotSelection:
    """Plots of a graph, each a list of quantities; the active plot receives the next quantity."""

    plots: list[list[str]] = field(default_factory=lambda: [list(row) for row in FIRST])
    active: int = 0

    @property
    def quantities(self) -> list[str]:
        """All quantities on display, in the order of the plots."""
        return [name for plot in self.plots for name in plot]

    def tick(self, name: str, units: Mapping[str, str]) -> None:
        """Show a quantity: in the active plot if that is empty or has the same unit, else in a new plot.

        units: quantity -> unit.
        """
        if name in self.quantities:
            return
        plot = self.plots[self.active] if self.plots else None
        if plot is not None and all(units[member] == units[name] for member in plot):
            plot.append(name)
        else:
            self.plots.append([name])
            self.active = len(self.plots) - 1

    def untick(self, name: str) -> None:
        """Remove a quantity, and its plot if that becomes empty."""
        for index, plot in enumerate(self.plots):
            if name in plot:
                plot.remove(name)
                if not plot:
                    self.remove(index)
                return

    def add(self) -> None:
        """Activate an empty plot at the end, which is added if there is none."""
        if [] not in self.plots:
            self.plots.append([])
        self.active = self.plots.index([])

    def remove(self, index: int) -> None:
        """Remove a plot."""
        del self.plots[index]
        if index < self.active or self.active >= len(self.plots):
            self.active = max(0, self.active - 1)

    def restrict_to(self, names: Iterable[str]) -> None:
        """Remove all quantities except these."""
        known = set(names)
        for name in [name for name in self.quantities if name not in known]:
            self.untick(name)


def tip_of(row: Quantity) -> str:
    """Return the tip of a channel: equation, source and column."""
    return (
        f"<b>{escape(row.label)}</b> {escape(legible(row.symbol))}<br>"
        f"{escape(legible(row.equation))}<br>Source: {escape(row.source)}<br>"
        f"<span style='color:{SCREEN.quiet}'>column {escape(row.slug)} of {row.table}</span>"
    )


class ChannelTree(QTreeWidget):
    """Tree of the channels of a design, by table, with a box for each.

    Signal ``ticked`` (str, bool): the user has ticked or unticked a quantity.
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
        header = self.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        CopyKey(self)
        self._items: dict[str, QTreeWidgetItem] = {}
        self._rows: tuple[Quantity, ...] = ()
        self.itemChanged.connect(self._changed)
        self.itemClicked.connect(self._clicked)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.setColumnHidden(1, self.width() < DEFAULT_WIDTH - 4)

    @property
    def full_width(self) -> int:
        """Width at which no name is cut."""
        advance, columns = self.fontMetrics().horizontalAdvance, range(self.columnCount())
        texts = [max((advance(item.text(column)) for item in self._items.values()), default=0) for column in columns]
        return sum(texts) + BESIDE_NAMES + self.verticalScrollBar().sizeHint().width()

    def show_rows(self, rows: Sequence[Quantity], reasons: Mapping[str, str]) -> bool:
        """List these channels, and return whether they are others; reasons: quantity -> why it cannot be drawn."""
        with QSignalBlocker(self):
            are_others = tuple(rows) != self._rows
            if are_others:
                self._build(rows)
            for row in rows:
                item, text = self._items[row.name], reasons.get(row.name, "")
                item.setForeground(0, QColor(SCREEN.quiet if text else SCREEN.ink))
                item.setToolTip(0, escape(text) or tip_of(row))
        return are_others

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
        """Tick exactly these quantities."""
        ticked = set(names)
        with QSignalBlocker(self):
            for name, item in self._items.items():
                item.setCheckState(0, Qt.CheckState.Checked if name in ticked else Qt.CheckState.Unchecked)

    def item_of(self, quantity: str) -> QTreeWidgetItem:
        """Return the row of a quantity. Raises KeyError."""
        return self._items[quantity]

    def _changed(self, item: QTreeWidgetItem, column: int) -> None:
        name = item.data(0, Qt.ItemDataRole.UserRole)
        if name and column == 0:
            self.ticked.emit(name, item.checkState(0) == Qt.CheckState.Checked)

    def _clicked(self, item: QTreeWidgetItem, column: int) -> None:
        """Change the box also for a click on symbol or unit."""
        if column > 0 and item.data(0, Qt.ItemDataRole.UserRole):
            is_checked = item.checkState(0) == Qt.CheckState.Checked
            item.setCheckState(0, Qt.CheckState.Unchecked if is_checked else Qt.CheckState.Checked)


def _item(group: QTreeWidgetItem, row: Quantity) -> QTreeWidgetItem:
    item = QTreeWidgetItem(group, [row.label, legible(row.symbol), row.unit.symbol])
    item.setData(0, Qt.ItemDataRole.UserRole, row.name)
    item.setFlags(Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsUserCheckable | Qt.ItemFlag.ItemIsSelectable)
    item.setCheckState(0, Qt.CheckState.Unchecked)
    item.setSizeHint(0, QSize(0, ROW_HEIGHT))
    item.setIcon(0, swatch(SCREEN.family(row.family), 11, 12))
    for column in range(len(HEADINGS)):
        item.setToolTip(column, tip_of(row))
    return item


def swatch(colour: str, line: int = 0, width: int = 18) -> QIcon:
    """Icon in a colour, or of a line of a length in it [pixels]; empty without a colour."""
    image = QPixmap(QSize(2 * width, 20))
    image.setDevicePixelRatio(2.0)
    image.fill(QColor("transparent" if line or not colour else colour))
    if line and colour:
        painter = QPainter(image)
        painter.fillRect(1, 4, line, 2, QColor(colour))
        painter.end()
    return QIcon(image)


# -- files of a graph ------------------------------------------------------------------------------------


def _stamp(path: str) -> Stamp:
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


@dataclass
class _File:
    """A file of the graph.

    Attributes
    ----------
    source : Source or None
        Content as read last.
    fault : str
        Why it cannot be read.
    note : str
        Why the content may be out of date.
    stamp : Stamp
        State of the file when it was read.
    is_due : bool
        Whether it must be read.
    """

    source: Source | None = None
    fault: str = READING
    note: str = ""
    stamp: Stamp = None
    is_due: bool = True


class GraphSources(QObject):
    """The current design and the files that the curves of a graph name, read in the background.

    Signals: ``changed``, a file was read, has changed, or was removed; ``progress`` (str, float), name of the file
    being read, empty if none is, and the part of it that is read, 0 ... 1.
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
        self._ticking.timeout.connect(self._report_progress)

    # -- sources --------------------------------------------------------------------------------------------

    def __call__(self, name: str) -> Source:
        """Return the source of a curve. Raises KindynaError where it cannot be read, or is not read yet."""
        if not name:
            if self.design is None:
                raise KindynaError("there is no design")
            return self.design
        file = self._files.get(name)
        if file is None or file.source is None:
            raise KindynaError(f"{Path(name).name}: {file.fault if file else READING}")
        return file.source

    def note(self, name: str) -> str:
        """Return why the curves of a file may be out of date; empty if they are not."""
        file = self._files.get(name)
        return f"{Path(name).name} {file.note}" if file is not None and file.note else ""

    @property
    def names(self) -> tuple[str, ...]:
        """Paths of the files, in the order of their opening."""
        return tuple(self._files)

    @property
    def reading(self) -> bool:
        """Whether files are being read."""
        return self._work.busy

    @property
    def busy(self) -> bool:
        """Whether files are being read, or about to be compared."""
        return self.reading or self._soon.isActive()

    # -- reading --------------------------------------------------------------------------------------------

    def request(self, names: Iterable[str]) -> None:
        """Use exactly these files, and read the new ones."""
        paths = [name for name in dict.fromkeys(names) if name]
        new = [name for name in paths if name not in self._files]
        if set(self._files) == set(paths):
            return
        self._files = {name: self._files.get(name) or _File() for name in paths}
        self._watch()
        if new:
            self._read()

    def read_again(self) -> None:
        """Read all files, also those that could not be read or were cancelled."""
        for file in self._files.values():
            file.is_due = True
        self._read()

    def _read(self) -> None:
        due = [name for name, file in self._files.items() if file.is_due]
        if not due:
            return
        self._done = dict.fromkeys(due, 0.0)
        for name in due:
            self._files[name].stamp = _stamp(name)
        self._work.start([(name, partial(self._job, self._done, name)) for name in due])
        self._ticking.start()

    @staticmethod
    def _job(done: dict[str, float], name: str) -> Source:
        return read_source(Path(name), partial(done.__setitem__, name))

    def cancel(self) -> None:
        """Stop reading; the rows of the files that were not read show it."""
        self._work.cancel()

    def _take(self, name: str, result: object) -> None:
        self._done.pop(name, None)
        is_cancelled = isinstance(result, Cancelled)
        for path in [key for key, file in self._files.items() if file.is_due] if is_cancelled else [name]:
            if path in self._files:
                self._store(self._files[path], result)
        if is_cancelled or not self._done:
            self._ticking.stop()
            self.progress.emit("", 0.0)
        self.changed.emit()

    @staticmethod
    def _store(file: _File, result: object) -> None:
        file.is_due = False
        if isinstance(result, Cancelled | KindynaError):
            first_line = str(result).split("\n")[0].partition(": ")[2] or str(result)
            file.fault = CANCELLED if isinstance(result, Cancelled) else first_line
            if file.source is not None:
                file.note = f"has changed and cannot be read ({file.fault}); its last curves are shown"
        else:
            file.source, file.fault, file.note = result, "", ""  # type: ignore[assignment]

    def _report_progress(self) -> None:
        if self._done:
            name = next(iter(self._done))
            self.progress.emit(Path(name).name, self._done[name])

    # -- watching -------------------------------------------------------------------------------------------

    def compare(self) -> None:
        """Check all files now: read those that have changed; removed ones keep their last curves."""
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
                file.note = "was removed; its last curves are shown" if file.source is not None else ""
            else:
                file.is_due = True
        if any(file.is_due for file in self._files.values()):
            self._read()
        if changed:
            self.changed.emit()

    def _watch(self) -> None:
        paths = {str(path) for name in self._files for path in (Path(name), Path(name).parent) if path.exists()}
        watched = {*self._system.files(), *self._system.directories()}
        if watched - paths:
            self._system.removePaths(sorted(watched - paths))
        if paths - watched:
            self._system.addPaths(sorted(paths - watched))

    def close(self) -> None:
        """Stop reading for good."""
        self._ticking.stop()
        self._work.close()
