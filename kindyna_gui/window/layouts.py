"""The layouts of the window: one for each task, each remembered as it was left.

A task that has not been used yet is laid out from its row in ``TASKS``. To show another one changes where docks and pages
stand and nothing else: what comes into view catches up by itself, what goes out of view rests.
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
_LYING = (TOP, BOTTOM)
_OPPOSITE = {LEFT: RIGHT, RIGHT: LEFT}
SMALL = QSize(200, 100)  # of a dock before it is laid out: else the place where it stood before would count


def first_task(design: Design) -> str:
    """The task in which a design is best begun: a motion in the motion editor, a linkage that a crank turns in its drawing."""
    return "compo" if motion_of(design) is None else "make"


class Layouts(QObject):
    """Shows one task after the other.

    changed (str): another task is in place, by its name in ``TASKS``
    """

    changed = Signal(str)

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._docks, self._centre = window, window.docks, window.centre
        self._shares, self._settings = window.shares, window.settings
        self._left: dict[str, TaskLayout] = {}
        self._sizes: dict[str, tuple[Mapping[str, QSize], QSize]] = {}
        self._kinds: dict[str, tuple[bool, bool]] = {}  # whether a task is laid out for a linkage, for several drives
        self.current = ""
        self._inspector = 0  # width of the parameters in the task before
        self._wide = False  # what is in place was laid out for a wide window
        self._begun = False  # the window has the size in which this task was left, or has been shown

    # -- from run to run ------------------------------------------------------------------------------------

    def begin(self) -> None:
        """The task that was in place at the end of the last run, or the one for the design."""
        self._begun = self._settings.restore_geometry(self._window)
        design = self._window.session.design
        kept = self._settings.task
        suited = kept in TASKS and not (kept == "make" and motion_of(design) is None)
        self.current = kept if suited else first_task(design)
        self._arrange()  # docks that have no place yet could not be given the one where they were left
        self._lay()
        self.changed.emit(self.current)

    def save(self) -> None:
        """Keep every layout for the next run."""
        self._leave()
        for name, layout in self._left.items():
            self._settings.save_layout(name, layout)
        self._settings.save_window(self._window, self.current)

    @property
    def _is_wide(self) -> bool:
        return TASKS[self.current].is_wide(self._window.width())

    @property
    def _row(self) -> Task:
        """The task in place, as it is in a window of this width."""
        return TASKS[self.current].at(self._window.width())

    # -- tasks ----------------------------------------------------------------------------------------------

    def show(self, task: str) -> None:
        """Show a task as it was left."""
        if task == self.current:
            return
        self._leave()
        self.current = task
        self._lay()
        if task in self._sizes:
            sizes, window = self._sizes[task]
            self._shares.take_up(self._with_width(sizes), window)
        self.changed.emit(task)

    def _leave(self) -> None:
        """Note how the task in place is left."""
        forms = self._docks["parameters"]
        if is_in_sight(forms) and not forms.isFloating():
            self._inspector = forms.width()
        self._left[self.current] = TaskLayout(
            self._window.saveState(self._settings.VERSION), *self._centre.open_pages, *self._kinds[self.current]
        )
        self._sizes[self.current] = self._shares.noted

    def _with_width(self, sizes: Mapping[str, QSize]) -> Mapping[str, QSize]:
        """Sizes of docks with the width that the parameters had in the task before."""
        then = sizes.get("parameters")
        if then is None or not self._inspector:
            return sizes
        area, more = self._window.dockWidgetArea(self._docks["parameters"]), self._inspector - then.width()
        side, by = (LEFT, -more) if area in _LYING else (area, more)
        moved = {name for name in sizes if self._window.dockWidgetArea(self._docks[name]) == side}
        return {name: QSize(max(size.width() + by * (name in moved), 1), size.height()) for name, size in sizes.items()}

    def _keep_width(self) -> None:
        """The parameters as wide as in the task before; where they stand over the middle, that is as wide."""
        forms, large = self._docks["parameters"], self._docks.get(self._row.large)
        if not self._inspector or forms.isHidden() or forms.isFloating():
            return
        if self._window.dockWidgetArea(forms) not in _LYING:
            self._window.resizeDocks([forms], [self._inspector], ACROSS)
        elif large is not None:
            self._window.resizeDocks([large], [max(self._window.width() - self._inspector - SEPARATOR, 1)], ACROSS)

    def _lay(self) -> None:
        for dock in self._docks.values():
            dock.lift_limit()
        layout = self._left.get(self.current) or self._settings.layout(self.current)
        if layout is None or not self._restore(layout):
            self._arrange()
        else:
            self._keep_width()
            self._kinds[self.current] = (layout.links, layout.several)
        self._suit_kinds()

    def _restore(self, layout: TaskLayout) -> bool:
        """Docks and pages as they were left; False where broken. What goes may be larger than what comes and would enlarge the
        window: pages go first, and docks that have no place of their own here, which Qt counts until all are laid."""
        self._centre.lay(tuple(name for name in layout.pages if name in VIEWS), layout.front)
        named = {name for group in self._row.groups for name in (*group.names, *group.more)}
        for name, dock in self._docks.items():
            if name not in named and not dock.isFloating():
                dock.hide()
        return self._window.restoreState(layout.state, self._settings.VERSION)

    def reset(self) -> None:
        """The first layout of the task in place."""
        self._inspector = 0
        for dock in self._docks.values():
            dock.lift_limit()
        self._arrange()
        self._suit_kinds()

    # -- layouts with a name --------------------------------------------------------------------------------

    def keep(self, name: str) -> None:
        """Keep the task in place, as it stands, under a name."""
        self._leave()
        self._settings.name_layout(name, self.current, self._left[self.current])

    def take(self, name: str) -> None:
        """Show the task that is kept under a name, as it was then. Raises ValueError, with the reason, where that cannot be."""
        task, layout = self._settings.named_layout(name)
        if task not in TASKS:
            raise ValueError("of a task that is not here")
        self._leave()
        sound = self._restore(layout)
        if sound:
            self._left[task], self.current, self._inspector = layout, task, 0
        self._lay()
        if not sound:
            raise ValueError("broken")
        self.changed.emit(task)
        self.suit()

    # -- the first layout -----------------------------------------------------------------------------------

    def _arrange(self) -> None:
        """Every dock at its place, the first of each group in front."""
        row = self._row
        self._wide = self._is_wide
        for dock in self._docks.values():
            if dock.isFloating():
                dock.setFloating(False)
            self._window.removeDockWidget(dock)
            dock.resize(SMALL)
        self._centre.lay(row.pages, row.front)
        for group, names in row.places:
            self._window.addDockWidget(group.area, self._docks[names[0]], UPWARDS)
            for name in names[1:]:
                self._window.tabifyDockWidget(self._docks[names[0]], self._docks[name])
            for name in names:
                self._docks[name].setVisible(name in group.names)
        self._kinds[self.current] = (False, False)
        self._raise_fronts()
        self.proportion()

    def proportion(self) -> None:
        """The sizes of the first layout; they count only once the window has its own."""
        row, window = self._row, self._window
        layout = window.layout()
        assert layout is not None, "a main window has one"
        layout.activate()
        for area, side in row.sides.items():
            shown = [group for group in row.groups if group.area == area and self._front(group)]
            docks: list[Dock] = [self._docks[self._front(group)] for group in shown]
            if not docks:
                continue
            if area in _LYING:
                window.resizeDocks(docks[:1], [side.size(window.height())], UPWARDS)
                continue
            window.resizeDocks(docks[:1], [self._across(area, side)], ACROSS)
            window.resizeDocks(docks, [round(1000 * group.part) for group in shown], UPWARDS)

    def _across(self, area: Area, side: DockExtent) -> int:
        """Width of a side of the first layout; with the parameters at the width that they had in the task before."""
        at = next((group.area for group in self._row.groups if "parameters" in group.names), None)
        if self._inspector and at == area:
            return self._inspector
        if self._inspector and at in _LYING and area == LEFT:
            return max(self._window.width() - self._inspector - SEPARATOR, 1)
        return side.size(self._window.width())

    def _front(self, group: DockGroup) -> str:
        """The dock that stands for the group: the first of those that are there at first, else one that the design has brought;
        empty where there is none."""
        own = [name for names in self._row.of_kinds for name in names if name in group.more]
        return next(iter((*group.names[:1], *(name for name in own if not self._docks[name].isHidden()))), "")

    def shown(self) -> None:
        """The window has come to the screen."""
        if not self._begun:
            self._begun = True
            if self._wide != self._is_wide:  # it was laid out for another width
                self.reset()
            self.proportion()

    def furnish(self) -> None:
        """The docks are there: which of them stand in front counts only now."""
        if self.current not in self._left and self._settings.layout(self.current) is None:
            self._raise_fronts()

    def _raise_fronts(self) -> None:
        row = self._row
        for group in row.groups:
            if group.names:
                self._docks[group.names[0]].raise_()
        for there, names in zip(self._kinds[self.current], row.of_kinds, strict=True):
            for front in self._fronts(names) if there else ():
                self._docks[front].raise_()

    def open(self, dock: Dock) -> None:
        """Show a dock at its place, which keeps its width; alone at its side it takes the usual part of the window."""
        if not dock.isHidden():
            return
        area = self._window.dockWidgetArea(dock)
        below = area in _LYING
        docks = [each for each in self._docks.values() if is_in_sight(each) and not each.isFloating()]
        beside = [each for each in docks if self._window.dockWidgetArea(each) == area]
        width = beside[0].width() if beside else 0
        across = [
            (each, each.width())
            for each in docks
            if not below and self._window.dockWidgetArea(each) == _OPPOSITE.get(area)
        ][:1]
        dock.show()
        if dock.isFloating():
            return
        side = self._row.sides.get(area)
        if beside and not below:
            self._window.resizeDocks([dock], [width], ACROSS)
        elif not beside and side is not None:
            whole = self._window.height() if below else self._window.width()
            self._window.resizeDocks([dock], [side.size(whole)], UPWARDS if below else ACROSS)
        for other, kept in across:  # what is taken, is taken from the middle
            self._window.resizeDocks([other], [kept], ACROSS)

    # -- kinds of design ------------------------------------------------------------------------------------

    def suit(self) -> None:
        """Another design has begun: one without a motion has nothing to be made; linkages bring docks of their own."""
        if self.current == "make" and motion_of(self._window.session.design) is None:
            self.show(first_task(self._window.session.design))
        else:
            self._suit_kinds()

    def _suit_kinds(self) -> None:
        """Docks of linkages come with a linkage and go with it, those of several drives with these, before or behind what else
        stands at their place."""
        session, task = self._window.session, self._row
        kinds = (lists_links(session.design), session.several)
        for number, (there, names) in enumerate(zip(kinds, task.of_kinds, strict=True)):
            if names and there != self._kinds[self.current][number]:
                self._bring(number, there, names)

    def _bring(self, number: int, there: bool, own: tuple[str, ...]) -> None:
        """Show or hide the docks of one kind of design."""
        group, names = next(place for place in self._row.places if own[0] in place[1])
        others = [name for name in names if name not in own and not self._docks[name].isHidden()]
        if there and group.names and not others:
            return  # the user does without what stands at this place
        before = self._kinds[self.current]
        self._kinds[self.current] = (there, before[1]) if number == 0 else (before[0], there)
        for name in own:
            self._docks[name].setVisible(there)
        if there and any(name not in names for name in own):  # one stands alone at its side
            self.proportion()
        for front in self._fronts(own) if there else others[:1]:
            self._docks[front].raise_()

    def _fronts(self, own: Sequence[str]) -> list[str]:
        """The first of these docks at each place."""
        rows = ([name for name in own if name in names] for _, names in self._row.places)
        return [row[0] for row in rows if row]


__all__ = ["Layouts", "first_task"]
