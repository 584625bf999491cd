"""The layouts of the window: one for each task, restored as the user left it, and those saved under a name.

A task not used before is laid out from its row in ``TASKS``. Showing a task moves docks and pages and does nothing else:
visible views update themselves, hidden ones wait.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QObject, QSize, Qt, Signal

from core.design import Design, motion_of
from kindyna_gui.requirements import lists_links
from kindyna_gui.settings import TaskLayout
from kindyna_gui.view import is_in_sight
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import BOTTOM, LEFT, RIGHT, TOP, VIEWS, Dock
from kindyna_gui.window.tasks import SEPARATOR, TASKS, Area, DockExtent, DockGroup, Task

ACROSS, UPWARDS = Qt.Orientation.Horizontal, Qt.Orientation.Vertical
_HORIZONTAL = (TOP, BOTTOM)
_OPPOSITE = {LEFT: RIGHT, RIGHT: LEFT}
SMALL = QSize(200, 100)  # size of a dock before it is laid out, else Qt would count its previous size


def first_task(design: Design) -> str:
    """Return the task to begin a design in: Make where it has a motion to edit, else Compo."""
    return "compo" if motion_of(design) is None else "make"


class Layouts(QObject):
    """Lays out docks and pages for the current task.

    Signal ``changed``: the current task has changed; its name in ``TASKS``.
    """

    changed = Signal(str)

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._docks, self._centre = window, window.docks, window.centre
        self._shares, self._settings = window.shares, window.settings
        self._last: dict[str, TaskLayout] = {}  # layouts of this run, by task
        self._sizes: dict[str, tuple[Mapping[str, QSize], QSize]] = {}
        self._kinds: dict[str, tuple[bool, bool]] = {}  # whether a task is laid out for a linkage, for several drives
        self.current = ""
        self._inspector = 0  # width of the parameters in the previous task
        self._wide = False  # whether the current layout is for a wide window
        self._begun = False  # whether the window has been shown, or has its size of the last run

    # -- from run to run ------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Show the task of the end of the last run, or the first one for the design."""
        self._begun = self._settings.restore_geometry(self._window)
        design = self._window.session.design
        last = self._settings.task
        is_usable = last in TASKS and not (last == "make" and motion_of(design) is None)
        self.current = last if is_usable else first_task(design)
        self._arrange()  # Qt restores only docks that were laid out before
        self._lay()
        self.changed.emit(self.current)

    def save(self) -> None:
        """Write every layout to the settings."""
        self._note()
        for name, layout in self._last.items():
            self._settings.save_layout(name, layout)
        self._settings.save_window(self._window, self.current)

    @property
    def _is_wide(self) -> bool:
        return TASKS[self.current].is_wide(self._window.width())

    @property
    def _row(self) -> Task:
        """The current task, for a window of this width."""
        return TASKS[self.current].at(self._window.width())

    # -- tasks ----------------------------------------------------------------------------------------------

    def show(self, task: str) -> None:
        """Show a task in the layout last used."""
        if task == self.current:
            return
        self._note()
        self.current = task
        self._lay()
        if task in self._sizes:
            sizes, window = self._sizes[task]
            self._shares.set_sizes(self._with_width(sizes), window)
        self.changed.emit(task)

    def _note(self) -> None:
        """Note the layout of the current task."""
        forms = self._docks["parameters"]
        if is_in_sight(forms) and not forms.isFloating():
            self._inspector = forms.width()
        self._last[self.current] = TaskLayout(
            self._window.saveState(self._settings.VERSION), *self._centre.open_pages, *self._kinds[self.current]
        )
        self._sizes[self.current] = self._shares.noted_sizes

    def _with_width(self, sizes: Mapping[str, QSize]) -> Mapping[str, QSize]:
        """Return sizes of docks in which the parameters have their width of the previous task."""
        then = sizes.get("parameters")
        if then is None or not self._inspector:
            return sizes
        area, wider = self._window.dockWidgetArea(self._docks["parameters"]), self._inspector - then.width()
        side, change = (LEFT, -wider) if area in _HORIZONTAL else (area, wider)
        changed = {name for name in sizes if self._window.dockWidgetArea(self._docks[name]) == side}
        return {
            name: QSize(max(size.width() + change * (name in changed), 1), size.height())
            for name, size in sizes.items()
        }

    def _keep_width(self) -> None:
        """Give the parameters their width of the previous task; above the middle, give it to the middle."""
        forms, large = self._docks["parameters"], self._docks.get(self._row.large)
        if not self._inspector or forms.isHidden() or forms.isFloating():
            return
        if self._window.dockWidgetArea(forms) not in _HORIZONTAL:
            self._window.resizeDocks([forms], [self._inspector], ACROSS)
        elif large is not None:
            self._window.resizeDocks([large], [max(self._window.width() - self._inspector - SEPARATOR, 1)], ACROSS)

    def _lay(self) -> None:
        for dock in self._docks.values():
            dock.lift_limit()
        layout = self._last.get(self.current) or self._settings.layout(self.current)
        if layout is None or not self._restore(layout):
            self._arrange()
        else:
            self._keep_width()
            self._kinds[self.current] = (layout.links, layout.several)
        self._show_kind_docks()

    def _restore(self, layout: TaskLayout) -> bool:
        """Restore docks and pages; False where the layout is damaged.

        Pages, and docks that no group names, are hidden first: Qt counts their sizes until all docks are laid out, and
        they would enlarge the window.
        """
        self._centre.set_pages(tuple(name for name in layout.pages if name in VIEWS), layout.front)
        named = {name for group in self._row.groups for name in (*group.names, *group.more)}
        for name, dock in self._docks.items():
            if name not in named and not dock.isFloating():
                dock.hide()
        return self._window.restoreState(layout.state, self._settings.VERSION)

    def reset(self) -> None:
        """Restore the first layout of the current task."""
        self._inspector = 0
        for dock in self._docks.values():
            dock.lift_limit()
        self._arrange()
        self._show_kind_docks()

    # -- layouts with a name --------------------------------------------------------------------------------

    def save_as(self, name: str) -> None:
        """Save the current task and layout under a name."""
        self._note()
        self._settings.name_layout(name, self.current, self._last[self.current])

    def restore(self, name: str) -> None:
        """Restore task and layout saved under a name. Raises ValueError, with the reason, if they cannot be restored."""
        task, layout = self._settings.named_layout(name)
        if task not in TASKS:
            raise ValueError("this version has no such task")
        self._note()
        restored = self._restore(layout)
        if restored:
            self._last[task], self.current, self._inspector = layout, task, 0
        self._lay()
        if not restored:
            raise ValueError("it is damaged")
        self.changed.emit(task)
        self.follow_design()

    # -- the first layout -----------------------------------------------------------------------------------

    def _arrange(self) -> None:
        """Move every dock to its group, the first of each group in front."""
        row = self._row
        self._wide = self._is_wide
        for dock in self._docks.values():
            if dock.isFloating():
                dock.setFloating(False)
            self._window.removeDockWidget(dock)
            dock.resize(SMALL)
        self._centre.set_pages(row.pages, row.pages[-1])
        for group, names in row.all_docks:
            self._window.addDockWidget(group.area, self._docks[names[0]], UPWARDS)
            for name in names[1:]:
                self._window.tabifyDockWidget(self._docks[names[0]], self._docks[name])
            for name in names:
                self._docks[name].setVisible(name in group.names)
        self._kinds[self.current] = (False, False)
        self._raise_fronts()
        self.proportion()

    def proportion(self) -> None:
        """Set the sizes of the first layout; Qt applies them only once the window has its size."""
        row, window = self._row, self._window
        layout = window.layout()
        assert layout is not None, "a main window has one"
        layout.activate()
        for area, side in row.sides.items():
            shown = [group for group in row.groups if group.area == area and self._front(group)]
            docks: list[Dock] = [self._docks[self._front(group)] for group in shown]
            if not docks:
                continue
            if area in _HORIZONTAL:
                window.resizeDocks(docks[:1], [side.size(window.height())], UPWARDS)
                continue
            window.resizeDocks(docks[:1], [self._across(area, side)], ACROSS)
            window.resizeDocks(docks, [round(1000 * group.part) for group in shown], UPWARDS)

    def _across(self, area: Area, side: DockExtent) -> int:
        """Width of a side of the first layout; the parameters have their width of the previous task."""
        at = next((group.area for group in self._row.groups if "parameters" in group.names), None)
        if self._inspector and at == area:
            return self._inspector
        if self._inspector and at in _HORIZONTAL and area == LEFT:
            return max(self._window.width() - self._inspector - SEPARATOR, 1)
        return side.size(self._window.width())

    def _front(self, group: DockGroup) -> str:
        """The first dock of a group, else an open one of the design's kind; empty where there is none."""
        by_kind = [name for names in self._row.kind_docks for name in names if name in group.more]
        return next(iter((*group.names[:1], *(name for name in by_kind if not self._docks[name].isHidden()))), "")

    def shown(self) -> None:
        """Set the sizes of docks when the window is first shown."""
        if not self._begun:
            self._begun = True
            if self._wide != self._is_wide:  # laid out for another width
                self.reset()
            self.proportion()

    def furnish(self) -> None:
        """Raise the front docks of a first layout; Qt ignores it before the docks are shown."""
        if self.current not in self._last and self._settings.layout(self.current) is None:
            self._raise_fronts()

    def _raise_fronts(self) -> None:
        row = self._row
        for group in row.groups:
            if group.names:
                self._docks[group.names[0]].raise_()
        for is_kind, names in zip(self._kinds[self.current], row.kind_docks, strict=True):
            for front in self._fronts(names) if is_kind else ():
                self._docks[front].raise_()

    def open(self, dock: Dock) -> None:
        """Show a dock with the width of its side; alone on its side it takes the default part of the window."""
        if not dock.isHidden():
            return
        area = self._window.dockWidgetArea(dock)
        is_horizontal = area in _HORIZONTAL
        docks = [shown for shown in self._docks.values() if is_in_sight(shown) and not shown.isFloating()]
        neighbours = [shown for shown in docks if self._window.dockWidgetArea(shown) == area]
        width = neighbours[0].width() if neighbours else 0
        opposite = [
            (shown, shown.width())
            for shown in docks
            if not is_horizontal and self._window.dockWidgetArea(shown) == _OPPOSITE.get(area)
        ][:1]
        dock.show()
        if dock.isFloating():
            return
        side = self._row.sides.get(area)
        if neighbours and not is_horizontal:
            self._window.resizeDocks([dock], [width], ACROSS)
        elif not neighbours and side is not None:
            total = self._window.height() if is_horizontal else self._window.width()
            self._window.resizeDocks([dock], [side.size(total)], UPWARDS if is_horizontal else ACROSS)
        for shown, previous in opposite:  # only the middle becomes narrower
            self._window.resizeDocks([shown], [previous], ACROSS)

    # -- kinds of design ------------------------------------------------------------------------------------

    def follow_design(self) -> None:
        """Leave Make if the new design has no motion; show or hide the docks of its kind."""
        if self.current == "make" and motion_of(self._window.session.design) is None:
            self.show(first_task(self._window.session.design))
        else:
            self._show_kind_docks()

    def _show_kind_docks(self) -> None:
        """Show or hide the docks of linkages and those of several drives, as the design needs them."""
        session, task = self._window.session, self._row
        kinds = (lists_links(session.design), session.has_several_drives)
        for number, (is_kind, names) in enumerate(zip(kinds, task.kind_docks, strict=True)):
            if names and is_kind != self._kinds[self.current][number]:
                self._switch_docks(number, is_kind, names)

    def _switch_docks(self, number: int, show: bool, names: tuple[str, ...]) -> None:
        """Show or hide the docks of one kind of design."""
        group, members = next(row for row in self._row.all_docks if names[0] in row[1])
        others = [name for name in members if name not in names and not self._docks[name].isHidden()]
        if show and group.names and not others:
            return  # the user has closed all docks of this group
        before = self._kinds[self.current]
        self._kinds[self.current] = (show, before[1]) if number == 0 else (before[0], show)
        for name in names:
            self._docks[name].setVisible(show)
        if show and any(name not in members for name in names):  # one is alone on its side
            self.proportion()
        for front in self._fronts(names) if show else others[:1]:
            self._docks[front].raise_()

    def _fronts(self, names: Sequence[str]) -> list[str]:
        """The first of these docks in each group."""
        rows = ([name for name in names if name in members] for _, members in self._row.all_docks)
        return [row[0] for row in rows if row]


__all__ = ["Layouts", "first_task"]
