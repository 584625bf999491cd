"""The room that docks have of the window, kept while the window grows and shrinks.

Qt squeezes docks when a window shrinks and gives what a growing one gains to the middle alone: a column of plots that
has once been narrow would stay so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType

from PySide6.QtCore import QEvent, QObject, QSize, Qt, QTimer
from PySide6.QtWidgets import QDockWidget, QMainWindow, QTabBar

from core.frozen import frozen
from kindyna_gui.view import in_sight

ACROSS, UPWARDS = Qt.Orientation.Horizontal, Qt.Orientation.Vertical
Area = Qt.DockWidgetArea
NEAR = 8  # pixels from tabs to what they belong to


def _grown(size: int, then: int, now: int) -> int:
    return round(size * now / then)


def _same(size: int, then: int, now: int) -> int:
    return size


@frozen
class ResizeRule:
    """How the docks of an area take part in another size of the window: their width, and their height.

    Each takes a dock's size, and the window's at that time and now.
    """

    across: Callable[[int, int, int], int]
    upwards: Callable[[int, int, int], int]


RULES: Mapping[Area, ResizeRule] = MappingProxyType(
    {
        Area.LeftDockWidgetArea: ResizeRule(_grown, _grown),
        Area.RightDockWidgetArea: ResizeRule(_grown, _grown),
        Area.TopDockWidgetArea: ResizeRule(_grown, _same),
        Area.BottomDockWidgetArea: ResizeRule(_grown, _same),
    }
)
FORMS = frozenset({"parameters"})
"""Docks that need no more width in a large window; a picture does."""


class DockShares(QObject):
    """Notes the sizes of docks whenever the user gives them others, and restores them after a resize of the window."""

    def __init__(self, window: QMainWindow, docks: Iterable[QDockWidget]) -> None:
        super().__init__(window)
        self._window, self._docks = window, tuple(docks)
        self._sizes: dict[str, QSize] = {}
        self._noted, self._seen = QSize(), QSize()  # sizes of the window: at the note, and when last looked at
        self._echo = False
        self._late = QTimer(self, singleShot=True, interval=0)
        self._late.timeout.connect(self._settle)
        window.installEventFilter(self)
        for dock in self._docks:
            dock.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() in (QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.Hide):
            self._late.start()
        return super().eventFilter(watched, event)

    @property
    def noted(self) -> tuple[Mapping[str, QSize], QSize]:
        """The sizes of docks that the user last saw, by name, and that of the window at the time."""
        if self._noted == self._window.size():  # tabs may have come since
            self._sizes = {name: self._place(dock) for name, dock in self._front().items()}
        return self._sizes, self._noted

    def take_up(self, sizes: Mapping[str, QSize], window: QSize) -> None:
        """Docks are there that are to have these sizes in a window of this one, and others in one of another."""
        self._sizes, self._noted, self._seen = dict(sizes), window, QSize()
        self._echo = False
        self._late.start()

    def _front(self) -> dict[str, QDockWidget]:
        """The docks in sight that stand in the window, by name."""
        return {dock.objectName(): dock for dock in self._docks if not dock.isFloating() and in_sight(dock)}

    def _settle(self) -> None:
        """All sizes are what they will be: restore them where the window has another size, else note them."""
        if not self._window.isVisible():
            return
        front, size = self._front(), self._window.size()
        grown, self._seen = size != self._seen, size
        if self._sizes.keys() != front.keys():
            grown = self._echo = False
        if grown:
            self._restore(front)
            self._echo = True  # the docks report the sizes that they have just been given
            self._late.start()
        elif self._echo:
            self._echo = False
        else:
            self._sizes = {name: self._place(dock) for name, dock in front.items()}
            self._noted = size

    def _place(self, dock: QDockWidget) -> QSize:
        """The size of a dock with the tabs above it of those that share its place, as ``resizeDocks`` counts it."""
        box = dock.geometry()
        bars = self._window.findChildren(QTabBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
        places = [bar.geometry() for bar in bars if bar.isVisible()]
        above = [tabs for tabs in places if tabs.left() == box.left() and 0 < box.top() - tabs.bottom() < NEAR]
        return QSize(box.width(), box.bottom() + 1 - min([tabs.top() for tabs in above], default=box.top()))

    def _restore(self, front: Mapping[str, QDockWidget]) -> None:
        then, now = self._noted, self._window.size()
        for area, rule in RULES.items():
            docks = [dock for dock in front.values() if self._window.dockWidgetArea(dock) == area]
            sizes = [self._sizes[dock.objectName()] for dock in docks]
            form = rule.upwards is _grown and any(dock.objectName() in FORMS for dock in docks)
            across = [(_same if form else rule.across)(size.width(), then.width(), now.width()) for size in sizes]
            upwards = [rule.upwards(size.height(), then.height(), now.height()) for size in sizes]
            self._window.resizeDocks(docks, across, ACROSS)
            self._window.resizeDocks(docks, upwards, UPWARDS)
