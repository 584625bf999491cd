"""The layout that the user has made with the mouse, as a task: the rule of ``room`` lays it out like any other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QTabBar

from kindyna_gui.view import is_in_sight
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import BOTTOM, COLUMNS, LEFT, RIGHT, TOP, Dock
from kindyna_gui.window.tasks import Area, DockExtent, DockGroup, Task

NEAR = 8  # largest gap between a tab bar and its dock [pixels]


def size_with_tabs(window: Window, dock: Dock) -> QSize:
    """Size of a dock with the tabs above it."""
    box = dock.geometry()
    bars = window.findChildren(QTabBar, options=Qt.FindChildOption.FindDirectChildrenOnly)
    above = [
        tabs
        for tabs in (bar.geometry() for bar in bars if bar.isVisible())
        if tabs.left() == box.left() and 0 < box.top() - tabs.bottom() < NEAR
    ]
    return QSize(box.width(), box.bottom() + 1 - min([tabs.top() for tabs in above], default=box.top()))


def docks_in_sight(window: Window) -> Iterator[Dock]:
    """Yield the docks in front, that are not floating."""
    return (dock for dock in window.docks.values() if not dock.isFloating() and is_in_sight(dock))


def task_by_hand(window: Window, task: Task, room: QSize) -> Task:
    """Return a task with the groups and sizes that the docks of a window have now.

    Parameters
    ----------
    task : Task
        The task on display; its groups tell where closed docks open.
    room : QSize
        Size for docks and middle.
    """
    in_sight = sorted(docks_in_sight(window), key=lambda dock: (dock.geometry().top(), dock.geometry().left()))
    groups: list[DockGroup] = []
    sides: dict[Area, DockExtent] = {}
    for area in (LEFT, RIGHT, TOP, BOTTOM):
        docks = [dock for dock in in_sight if window.dockWidgetArea(dock) == area]
        sizes = [size_with_tabs(window, dock) for dock in docks]
        for dock, size in zip(docks, sizes, strict=True):
            names = tuple(d.objectName() for d in (dock, *window.tabifiedDockWidgets(dock)) if isinstance(d, Dock))
            groups.append(DockGroup(area, names, part=size.height() if area in COLUMNS else size.width()))
        if docks:
            width, height = sizes[0].width(), sizes[0].height()
            sides[area] = DockExtent(width / room.width()) if area in COLUMNS else DockExtent(0.0, height)
    groups = _with_closed(groups, task, room)
    return replace(task, groups=tuple(groups), sides={**task.sides, **sides}, by_hand=True)


def _with_closed(groups: list[DockGroup], task: Task, room: QSize) -> list[DockGroup]:
    """Add the closed docks: where another dock of their group in the task is, else in a group of their own."""
    placed = {name for group in groups for name in group.names}
    result = list(groups)
    for group, names in task.all_docks:
        closed = tuple(name for name in names if name not in placed)
        home = next((i for i, other in enumerate(groups) if set(names) & set(other.names)), None)
        if home is not None:
            result[home] = replace(result[home], more=(*result[home].more, *closed))
        elif closed:
            length = room.height() if group.area in COLUMNS else room.width()
            parts = sum(other.part for other in task.groups if other.area == group.area)
            result.append(DockGroup(group.area, more=closed, part=group.part / parts * length))
    return result
