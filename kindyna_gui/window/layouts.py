"""The layouts of the window: one for each task, restored as the user left it, and those saved under a name.

A task is laid out by the rule of ``room`` when it is first shown, when a view is called, when the window has another size
and when the design is of another kind. Once the user has changed a layout with the mouse, it keeps its proportions until a
view is called. Showing a task moves docks and pages and does nothing else: visible views update themselves, hidden ones
wait.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from PySide6.QtCore import QObject, QSize, Qt, Signal
from PySide6.QtWidgets import QToolBar

from core.design import Design, motion_of
from kindyna_gui.rebuilt import is_in_sight, single_shot
from kindyna_gui.requirements import lists_links
from kindyna_gui.settings import TaskLayout
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import LEFT, VIEWS, Dock
from kindyna_gui.window.room import COLUMNS, Plan, plan_docks
from kindyna_gui.window.tasks import INSPECTOR, TASKS, Task

ACROSS, UPWARDS = Qt.Orientation.Horizontal, Qt.Orientation.Vertical
SMALL = QSize(200, 100)  # size of a dock before it is laid out, else Qt would count its previous size
NEAR = 3  # pixels by which Qt may miss the size of a dock


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
        self._plans: dict[str, Plan] = {}  # those that the rule has laid out, by task
        self._sizes: dict[str, tuple[Mapping[str, QSize], QSize]] = {}
        self._kinds: dict[str, tuple[bool, bool]] = {}  # whether a task is laid out for a linkage, for several drives
        self.current = ""
        self._inspector = INSPECTOR  # width of the parameters in every task; the user may have changed it
        self._is_laying = False  # whether pages are being set, before the docks are laid out
        self._begun = False  # whether the window has been shown, or has its size of the last run
        self._soon = single_shot(self, self.refit)
        self._shares.refit = self.refit
        self._centre.tabs.currentChanged.connect(self._make_room)
        for dock in self._docks.values():
            dock.need_changed.connect(self._soon.start)

    # -- from run to run ------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Show the task of the end of the last run, or the first one for the design."""
        self._begun = self._settings.restore_geometry(self._window)
        design = self._window.session.design
        last = self._settings.task
        is_usable = last in TASKS and not (last == "make" and motion_of(design) is None)
        self.current = last if is_usable else first_task(design)
        self._arrange()  # Qt restores only docks that were laid out before
        if self._settings.layout(self.current) is not None:
            del self._plans[self.current]
            self._lay()
        self.changed.emit(self.current)

    def save(self) -> None:
        """Write every layout to the settings."""
        self._note()
        for name, layout in self._last.items():
            self._settings.save_layout(name, layout)
        self._settings.save_window(self._window, self.current)

    @property
    def _row(self) -> Task:
        """The current task, for a window of this width."""
        return TASKS[self.current].at(self._window.width())

    # -- tasks ----------------------------------------------------------------------------------------------

    def show(self, task: str) -> None:
        """Show a task in the layout last used."""
        if task == self.current:
            if large := self._docks.get(self._row.large):
                self.open(large)
            return
        self._note()
        self.current = task
        self._lay()
        if task in self._sizes and task not in self._plans:
            sizes, window = self._sizes[task]
            self._shares.set_sizes(self._with_width(sizes), window)
        self.changed.emit(task)

    def _note(self) -> None:
        """Note the layout of the current task."""
        self._sizes[self.current] = self._shares.noted_sizes
        if self._is_by_hand:
            self._plans.pop(self.current, None)
            forms = self._docks["parameters"]
            if is_in_sight(forms) and not forms.isFloating():
                self._inspector = forms.width()
        self._last[self.current] = TaskLayout(
            self._window.saveState(self._settings.VERSION), *self._centre.open_pages, *self._kinds[self.current]
        )

    def _with_width(self, sizes: Mapping[str, QSize]) -> Mapping[str, QSize]:
        """Return sizes of docks in which the parameters have their width of the previous task."""
        then = sizes.get("parameters")
        if then is None:
            return sizes
        area, wider = self._window.dockWidgetArea(self._docks["parameters"]), self._inspector - then.width()
        side, change = (area, wider) if area in COLUMNS else (LEFT, -wider)
        changed = {name for name in sizes if self._window.dockWidgetArea(self._docks[name]) == side}
        return {
            name: QSize(max(size.width() + change * (name in changed), 1), size.height())
            for name, size in sizes.items()
        }

    def _lay(self) -> None:
        """Lay out the current task as it was left, for this window and design."""
        layout, plan = (
            self._last.get(self.current) or self._settings.layout(self.current),
            self._plans.get(self.current),
        )
        if layout is not None and plan is not None:
            names = self._names_now(plan)
            self._hide_others(names)
            self._set_pages(layout.pages, layout.front)
            self._apply(names, plan.fronts)
        elif layout is None or not self._restore(layout):
            self._arrange()
        else:
            self._kinds[self.current] = (layout.links, layout.several)
        self._show_kind_docks()

    def _restore(self, layout: TaskLayout) -> bool:
        """Restore docks and pages; False where the layout is damaged.

        Pages, and docks that no group names, are hidden first: Qt counts their sizes until all docks are laid out, and
        they would enlarge the window.
        """
        self._plans.pop(self.current, None)
        self._set_pages(tuple(name for name in layout.pages if name in VIEWS), layout.front)
        self._hide_others({name for group in self._row.groups for name in (*group.names, *group.more)})
        return self._window.restoreState(layout.state, self._settings.VERSION)

    def _set_pages(self, names: Sequence[str], front: str) -> None:
        self._is_laying = True
        self._centre.set_pages(names, front)
        self._is_laying = False

    def _hide_others(self, names: Collection[str]) -> None:
        """Hide all docks but these before pages with other least sizes are shown: together they could widen the window."""
        for name, dock in self._docks.items():
            if name not in names and not dock.isFloating():
                dock.hide()

    def reset(self) -> None:
        """Restore the first layout of the current task."""
        self._inspector = INSPECTOR
        self._arrange()

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
            self._last[task], self.current = layout, task
            self._plans.pop(task, None)
        self._lay()
        if not restored:
            raise ValueError("it is damaged")
        self.changed.emit(task)
        self.follow_design()

    # -- layouts by the rule ---------------------------------------------------------------------------------

    def _arrange(self) -> None:
        """Lay out the current task for the first time."""
        row, self._kinds[self.current] = self._row, self._kinds_of_design
        for dock in self._docks.values():
            if dock.isFloating():
                dock.setFloating(False)
            self._window.removeDockWidget(dock)
            dock.resize(SMALL)
        self._set_pages(row.pages, row.pages[-1])
        kinds = zip(self._kinds[self.current], row.kind_docks, strict=True)
        of_kind = [name for is_kind, names in kinds if is_kind for name in names]
        first = [name for group in row.groups for name in group.names]
        self._apply((*of_kind, *first), self._fronts((*of_kind, *first)))

    def _fronts(self, names: Iterable[str]) -> list[str]:
        """The first of these docks in each group."""
        rows = ([name for name in names if name in members] for _, members in self._row.all_docks)
        return [row[0] for row in rows if row]

    def _apply(self, names: Iterable[str], fronts: Collection[str], called: str = "") -> None:
        """Open these docks, with room for the one, or the page in the middle, that has just been called."""
        needs = {name: dock.need() for name, dock in self._docks.items()}
        names, size = tuple(dict.fromkeys(names)), self._size()

        def planned() -> Plan:
            least, forms = self._centre.least, self._inspector
            return plan_docks(self._row, needs, least, size, names, in_front=fronts, called=called, forms=forms)

        plan = planned()
        if not plan.fits and called in self._docks:
            self._set_pages(self._centre.open_pages[0], "mechanism")  # it needs least room
            plan = planned()
        if not self._is_at(plan):
            self._move(plan)
        self._plans[self.current] = plan
        self._resize()

    def _size(self) -> tuple[int, int]:
        """Size of docks and middle: of the window without menus, toolbars and status line."""
        window = self._window
        above = max(bar.sizeHint().height() for bar in window.findChildren(QToolBar))
        below = window.menuBar().sizeHint().height() + window.statusBar().sizeHint().height()
        return window.width(), window.height() - above - below

    def _is_at(self, plan: Plan) -> bool:
        """Whether the docks are in the groups of a plan, in whatever size."""
        window, opened = self._window, set(self._opened)
        return opened == {name for group in plan.groups for name in group.names} and all(
            window.dockWidgetArea(dock) == group.area
            and opened & {other.objectName() for other in window.tabifiedDockWidgets(dock)} == {*group.names} - {name}
            for group in plan.groups
            for name in group.names
            for dock in (self._docks[name],)
        )

    def _move(self, plan: Plan) -> None:
        """Move the docks to the groups of a plan, those not open to their groups of the task."""
        window, opened = self._window, {name for group in plan.groups for name in group.names}
        rows = {group.index: list(group.names) for group in plan.groups}
        self._hide_others(opened)
        for index, (group, members) in enumerate(self._row.all_docks):
            closed = [n for n in members if n not in opened and not self._docks[n].isFloating()]
            docks = [self._docks[name] for name in (*rows.get(index, ()), *closed)]
            for dock in docks[:1]:
                window.addDockWidget(group.area, dock, UPWARDS if group.area in COLUMNS else ACROSS)
            for dock in docks[1:]:
                window.tabifyDockWidget(docks[0], dock)
            for dock in docks:
                dock.setVisible(dock.objectName() in opened)
        self._raise_fronts(plan)

    def _raise_fronts(self, plan: Plan) -> None:
        for front in plan.fronts:
            self._docks[front].raise_()

    def _resize(self) -> None:
        """Set the sizes of the current plan; Qt applies them only once the window has its size."""
        plan, layout = self._plans[self.current], self._window.layout()
        assert layout is not None, "a main window has one"
        layout.activate()
        for area, extent in plan.extents.items():
            groups = [group for group in plan.groups if group.area == area]
            docks = [self._docks[group.front] for group in groups]
            across, along = (ACROSS, UPWARDS) if area in COLUMNS else (UPWARDS, ACROSS)
            self._window.resizeDocks(docks[:1], [extent], across)
            self._window.resizeDocks(docks, [group.length for group in groups], along)

    @property
    def _opened(self) -> list[str]:
        """Docks that are open in the window, in the order of the task."""
        names = (name for _, members in self._row.all_docks for name in members)
        return [name for name in names if not (self._docks[name].isHidden() or self._docks[name].isFloating())]

    @property
    def _in_front(self) -> list[str]:
        return [name for name in self._opened if is_in_sight(self._docks[name])]

    @property
    def _is_by_hand(self) -> bool:
        """Whether the docks that the user last saw have other sizes than the rule has given them."""
        plan, (noted, _) = self._plans.get(self.current), self._shares.noted_sizes
        if plan is None or len(noted) != len(plan.groups) or not noted.keys() <= plan.sizes.keys():
            return True
        laid = ((noted[name], plan.sizes[name]) for name in noted)
        return any(abs(now.width() - w) > NEAR or abs(now.height() - h) > NEAR for now, (w, h) in laid)

    def refit(self, *, page_called: bool = False) -> bool:
        """Lay out the docks anew for the size of the window and of their content; False in a layout by hand.

        ``page_called``: the page in front has just been called, which no dock called before sends to the back.
        """
        if self._is_by_hand:
            return False
        plan, in_front, page = self._plans[self.current], set(self._in_front), self._centre.open_pages[1]
        is_dock_called = plan.called in in_front and not page_called
        called = plan.called if is_dock_called else "" if page in self._row.pages else page
        fronts = [
            g.front if g.front in in_front else next((n for n in g.names if n in in_front), g.front)
            for g in plan.groups
        ]
        self._apply(self._names_now(plan), fronts, called)
        return True

    def _names_now(self, plan: Plan) -> list[str]:
        """Docks of a plan, with those that a window of this width opens at first in place of those of its width."""
        then, now = ([name for group in row.groups for name in group.names] for row in (plan.task, self._row))
        return [name for name in plan.names if name in now or name not in then] + [n for n in now if n not in then]

    def shown(self) -> None:
        """Lay out the docks for the size in which the window is first shown."""
        if not self._begun:
            self._begun = True
            plan = self._plans[self.current]
            closed = {name for name in plan.names if self._docks[name].isHidden()}
            self._apply([name for name in self._names_now(plan) if name not in closed], plan.fronts)

    def furnish(self) -> None:
        """Raise the front docks of a first layout; Qt ignores it before the docks are shown."""
        if self.current in self._plans:
            self._raise_fronts(self._plans[self.current])

    def open(self, dock: Dock) -> None:
        """Show a dock where it has room."""
        if dock.isHidden() and dock.isFloating():
            dock.show()
        elif dock.isHidden():
            name = dock.objectName()
            self._apply((*self._opened, name), self._in_front, called=name)

    def _make_room(self) -> None:
        """Give the middle the size that the page needs which has come to the front."""
        if self._is_laying or not self._window.isVisible() or self.refit(page_called=True):
            return
        least, now = self._centre.least, self._centre.size()
        if least[0] > now.width() or least[1] > now.height():
            self._apply(self._opened, self._in_front, called=self._centre.open_pages[1])

    # -- kinds of design ------------------------------------------------------------------------------------

    def follow_design(self) -> None:
        """Leave Make if the new design has no motion; show or hide the docks of its kind."""
        if self.current == "make" and motion_of(self._window.session.design) is None:
            self.show(first_task(self._window.session.design))
        else:
            self._show_kind_docks()

    @property
    def _kinds_of_design(self) -> tuple[bool, bool]:
        """Whether the design has a linkage, and several drives."""
        session = self._window.session
        return lists_links(session.design), session.has_several_drives

    def _show_kind_docks(self) -> None:
        """Show or hide the docks of linkages and those of several drives, as the design needs them."""
        before, kinds = self._kinds[self.current], self._kinds_of_design
        self._kinds[self.current] = kinds
        opened = self._opened
        names, called = opened, list[str]()
        for was, is_kind, of_kind in zip(before, kinds, self._row.kind_docks, strict=True):
            if is_kind and not was:
                called += [name for name in of_kind if self._has_open_group(name, opened)]
            elif was and not is_kind:
                names = [name for name in names if name not in of_kind]
        if called or names != opened:
            self._apply((*called, *names), self._fronts((*called, *self._in_front)))

    def _has_open_group(self, name: str, opened: Collection[str]) -> bool:
        """Whether the user has not closed all docks of the group of this one."""
        group, members = next(row for row in self._row.all_docks if name in row[1])
        return not group.names or any(member in opened for member in members)


__all__ = ["Layouts", "first_task"]
