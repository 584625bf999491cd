"""The layouts of the window: one for each task, restored as the user left it, and those saved under a name.

A task is laid out by the rule of ``room`` whenever it is shown, a view is called or closed, and the window or the content of
a view has another size. What the user changes with the mouse is the arrangement that the rule then follows, until the layout
is reset. Showing a task moves docks and pages and does nothing else: visible views update themselves, hidden ones wait.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtWidgets import QApplication, QToolBar

from core.design import Design, motion_of
from kindyna_gui.rebuilt import is_in_sight, single_shot
from kindyna_gui.requirements import lists_links
from kindyna_gui.settings import TaskLayout
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import CENTRE, COLUMNS, VIEWS, Dock
from kindyna_gui.window.room import FORMS, Plan, plan_docks
from kindyna_gui.window.tasks import INSPECTOR, TASKS, Task

ACROSS, UPWARDS = Qt.Orientation.Horizontal, Qt.Orientation.Vertical
SMALL = QSize(200, 100)  # size of a dock before it is laid out, else Qt would count its previous size
SHOWN = {QEvent.Type.Show: False, QEvent.Type.Hide: True}
"""Event of a dock -> whether the dock is hidden then; Qt sends both also where only its window, or a tab, is shown."""


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
        self._settings = window.settings
        self._last: dict[str, TaskLayout] = {}  # layouts of this run, by task
        self._plans: dict[str, Plan] = {}  # those that the rule has laid out, by task
        self._opened_then: dict[str, tuple[list[str], list[str]]] = {}  # docks open and in front when a task was left
        self._by_hand: dict[str, Task] = {}  # arrangements by the user, by task
        self._pages_behind: dict[str, str] = {}  # pages that gave way to the mechanism for want of room, by task
        self._kinds: dict[str, tuple[bool, bool]] = {}  # whether a task is laid out for a linkage, for several drives
        self._in_space: dict[str, bool] = {}  # whether a task has shown the page of a cam in space
        self.current = ""
        self._inspector = INSPECTOR  # width of the parameters in every task; the user may have changed it
        self._is_laying = False  # whether docks or pages are being laid out here
        self._is_restored_by_hand = False
        self._is_furnished = False  # whether docks have been raised
        self._begun = False  # whether the window has been shown, or has its size of the last run
        self._grabbed: dict[str, QSize] = {}  # sizes of docks when the mouse was pressed on an edge
        self._soon = single_shot(self, self.refit)
        self._released = single_shot(self, self._take_dragged)
        self._moved = single_shot(self, self._take_moved)
        self._restored = single_shot(self, self._take_restored)
        self._centre.tabs.currentChanged.connect(self._make_room)
        window.installEventFilter(self)
        for dock in self._docks.values():
            dock.need_changed.connect(self._soon.start)
            dock.installEventFilter(self)
            dock.dockLocationChanged.connect(self._dock_moved)
            dock.topLevelChanged.connect(self._dock_moved)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is not self._window:
            if not self._is_laying and SHOWN.get(event.type()) == watched.isHidden():  # type: ignore[attr-defined]
                self._soon.start()
        elif event.type() == QEvent.Type.Resize:
            self._soon.start()
        elif event.type() == QEvent.Type.MouseButtonPress:  # only the edges of docks leave it to the window
            self._grabbed = self._sizes
        elif event.type() == QEvent.Type.MouseButtonRelease:
            self._released.start()
        return super().eventFilter(watched, event)

    # -- changes by the user ----------------------------------------------------------------------------------

    @property
    def _sizes(self) -> dict[str, QSize]:
        from kindyna_gui.window.hand import docks_in_sight  # imported here to save start-up time

        return {dock.objectName(): dock.size() for dock in docks_in_sight(self._window)}

    def _take_dragged(self) -> None:
        """Take the arrangement where the user has dragged the edge of a dock, with the width of the parameters."""
        if self._sizes != self._grabbed:
            self._take_by_hand(with_width=True)

    def _dock_moved(self, *_: object) -> None:
        if not self._is_laying:
            self._moved.start()

    def _take_moved(self) -> None:
        """Take the arrangement where the user has dropped a dock, or has let it float."""
        if QApplication.mouseButtons() == Qt.MouseButton.NoButton:  # else it is being dragged
            self._take_by_hand()
            self.refit()

    def _take_by_hand(self, *, with_width: bool = False) -> None:
        """Take what the user sees as the arrangement of the current task, and the width of the parameters for all tasks."""
        if not self._window.isVisible():
            return
        from kindyna_gui.window.hand import task_by_hand  # imported here to save start-up time

        forms = self._docks["parameters"]
        if with_width and is_in_sight(forms) and not forms.isFloating():
            self._inspector = forms.width()
        self._by_hand[self.current] = task_by_hand(self._window, self._row, QSize(*self._size()))
        self._plans[self.current] = self._plan(self._opened, self._in_front, "", self._centre.open_pages[1])

    def _take_restored(self) -> None:
        """Lay out the restored docks by the rule, in the user's arrangement where they have one."""
        if not self._window.isVisible():  # then once it is shown
            return
        if self._is_restored_by_hand:
            self._take_by_hand(with_width=True)
        self._apply(self._opened, self._in_front)

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
        """The current task as the user has arranged it, or for a window of this width."""
        return self._by_hand.get(self.current) or TASKS[self.current].at(self._window.width())

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
        self.changed.emit(task)

    def _note(self) -> None:
        """Note the layout of the current task."""
        for pending, take in ((self._moved, self._take_moved), (self._restored, self._take_restored)):
            if pending.isActive():
                pending.stop()
                take()
        if self._window.isVisible():
            self._opened_then[self.current] = self._opened, self._in_front
        self._last[self.current] = TaskLayout(
            self._window.saveState(self._settings.VERSION),
            *self._centre.open_pages,
            *self._kinds[self.current],
            self.current in self._by_hand,
        )

    def _lay(self) -> None:
        """Lay out the current task as it was left, for this window and design."""
        layout = self._last.get(self.current) or self._settings.layout(self.current)
        with self._laying():
            if layout is not None and self.current in self._opened_then:
                opened, fronts = self._opened_then[self.current]
                names = self._names_now(self._plans[self.current].task, opened)
                self._hide_others(names)
                self._set_pages(layout.pages, layout.front)
                self._apply(names, fronts)
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
        for kept in (self._by_hand, self._pages_behind, self._plans, self._opened_then):
            kept.pop(self.current, None)
        with self._laying():
            self._set_pages(tuple(name for name in layout.pages if name in VIEWS), layout.front)
            self._hide_others({name for group in self._row.groups for name in (*group.names, *group.more)})
            self._is_restored_by_hand = layout.by_hand
            self._restored.start()
            return self._window.restoreState(layout.state, self._settings.VERSION)

    def _set_pages(self, names: Sequence[str], front: str) -> None:
        with self._laying():
            self._centre.set_pages(names, front)

    @contextmanager
    def _laying(self) -> Iterator[None]:
        """What happens to docks and pages within is no change by the user."""
        before, self._is_laying = self._is_laying, True
        yield
        self._is_laying = before

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
        before, self.current = self.current, task
        restored = self._restore(layout)
        if restored:
            self._last[task] = layout
        else:
            self.current = before
        self._lay()
        if not restored:
            raise ValueError("it is damaged")
        self.changed.emit(task)
        self.follow_design()

    # -- layouts by the rule ---------------------------------------------------------------------------------

    def _arrange(self) -> None:
        """Lay out the current task for the first time."""
        for kept in (self._by_hand, self._pages_behind):
            kept.pop(self.current, None)
        row, self._kinds[self.current] = self._row, self._kinds_of_design
        with self._laying():
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
        """The first of these docks in each group; the parameters before all others."""
        ordered = sorted(names, key=lambda name: name != FORMS)
        rows = ([name for name in ordered if name in members] for _, members in self._row.all_docks)
        return [row[0] for row in rows if row]

    def _apply(
        self, names: Iterable[str], fronts: Collection[str], called: str = "", before: Plan | None = None
    ) -> None:
        """Open these docks, with room for the one, or the page in the middle, that has just been called.

        ``before``: the plan that is kept as long as everything has room in it.
        """
        pages, page = self._centre.open_pages
        wanted = self._pages_behind.get(self.current, page) if page == "mechanism" else page
        plan = self._plan(names, fronts, called, wanted, before)
        if not plan.fits and called in self._docks:
            self._pages_behind[self.current], wanted = wanted, "mechanism"  # it needs least room
            plan = self._plan(names, fronts, called, wanted)
        with self._laying():
            if wanted in pages and wanted != page:
                self._set_pages(pages, wanted)
            if not self._is_at(plan):
                self._move(plan)
            self._plans[self.current] = plan
            self._resize()

    def _plan(
        self, names: Iterable[str], fronts: Collection[str], called: str, page: str, before: Plan | None = None
    ) -> Plan:
        needs, opened = {name: dock.need() for name, dock in self._docks.items()}, tuple(dict.fromkeys(names))
        least, size, forms = self._centre.least_with(page), self._size(), self._inspector
        return plan_docks(
            self._row, needs, least, size, opened, in_front=fronts, called=called, forms=forms, before=before
        )

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
        """Move the docks to the groups of a plan, those without a position to their groups of the task."""
        window, opened = self._window, {name for group in plan.groups for name in group.names}
        rows = {group.index: list(group.names) for group in plan.groups}
        self._hide_others(opened)
        for index, (group, members) in enumerate(self._row.all_docks):
            placed = rows.get(index, [])
            others = (name for name in members if name not in opened and not self._docks[name].isFloating())
            closed = [name for name in others if window.dockWidgetArea(self._docks[name]) == CENTRE]
            docks = [self._docks[name] for name in (*placed, *closed)]
            for dock in docks[:1]:
                window.addDockWidget(group.area, dock, UPWARDS if group.area in COLUMNS else ACROSS)
            for dock in docks[1:]:
                window.tabifyDockWidget(docks[0], dock)
            for dock in docks:
                dock.show_title(len(placed) < 2)  # at once: Qt would count it with the tabs
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

    def refit(self, *, page_called: bool = False) -> None:
        """Lay out the docks anew for the size of the window and of their content, and for docks just shown or closed.

        ``page_called``: the page in front has just been called, which no dock called before sends to the back.
        """
        plan = self._plans.get(self.current)
        if plan is None or not self._window.isVisible():
            return
        placed, opened = {name for group in plan.groups for name in group.names}, self._opened
        names = [name for name in plan.names if name in opened or name not in placed]
        in_front, page, shown = set(self._in_front), self._centre.open_pages[1], set(opened) - placed
        is_dock_called = plan.called in in_front and not page_called
        called = plan.called if is_dock_called else "" if page in self._row.pages else page
        fronts = [
            g.front if g.front in in_front else next((n for n in g.names if n in in_front), g.front)
            for g in plan.groups
        ]
        fronts = fronts if self._is_furnished else list(plan.fronts)
        self._apply((*self._names_now(plan.task, names), *shown), fronts, next(iter(shown), called), before=plan)

    def _names_now(self, then: Task, names: Sequence[str]) -> list[str]:
        """Open docks of a task, with those that a window of this width opens at first in place of those of its width then."""
        before, now = ([name for group in row.groups for name in group.names] for row in (then, self._row))
        return [name for name in names if name in now or name not in before] + [n for n in now if n not in before]

    def shown(self) -> None:
        """Lay out the docks for the size in which the window is first shown."""
        if self.current not in self._plans:
            self._restored.start()
        elif not self._begun:
            plan = self._plans[self.current]
            closed = {name for name in plan.names if self._docks[name].isHidden()}
            self._apply([name for name in self._names_now(plan.task, plan.names) if name not in closed], plan.fronts)
        self._begun = True

    def furnish(self) -> None:
        """Raise the front docks of a first layout; Qt ignores it before the docks are shown."""
        self._is_furnished = True
        if self.current in self._plans:
            self._raise_fronts(self._plans[self.current])

    def open(self, dock: Dock) -> None:
        """Show a dock where it has room; one that is open stays where it is, and in front whatever room it needs then."""
        name, plan = dock.objectName(), self._plans.get(self.current)
        if dock.isHidden() and dock.isFloating():
            dock.show()
        elif dock.isHidden():
            self._apply((*self._opened, name), self._in_front, called=name)
        elif plan is not None and name in plan.names:
            self._plans[self.current] = replace(plan, called=name)

    def _make_room(self) -> None:
        """Give the middle the size that the page needs which has come to the front."""
        if not self._is_laying:
            self._pages_behind.pop(self.current, None)
            self.refit(page_called=True)

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
        self._show_cam_in_space()

    def _show_cam_in_space(self) -> None:
        """Show the page of a cam in space where the mechanism is large, once a design has such a cam; close it with the last."""
        is_in_space, was_in_space = (
            self._window.session.design.drive.has_surface,
            self._in_space.get(self.current, False),
        )
        if self._row.large != "mechanism" or is_in_space == was_in_space:
            return
        self._in_space[self.current] = is_in_space
        pages, front = self._centre.open_pages
        others = tuple(name for name in pages if name != "surface")
        if is_in_space:
            self._set_pages((*others, "surface"), front)
        elif "surface" in pages:
            self._set_pages(others, "mechanism" if front == "surface" else front)

    def _has_open_group(self, name: str, opened: Collection[str]) -> bool:
        """Whether the user has not closed all docks of the group of this one."""
        group, members = next(row for row in self._row.all_docks if name in row[1])
        return not group.names or any(member in opened for member in members)


__all__ = ["Layouts", "first_task"]
