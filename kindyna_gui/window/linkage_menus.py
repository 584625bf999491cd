"""Menus of links and loads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QMenu

from core.design import CRANK, AttachedEnd, Design, Driver, Target, get, holds_of, load_lists, with_new_row
from core.errors import KindynaError
from core.mechanism.drivers import driver_position, drivers, roller_points, with_driver, with_roller, without_roller
from core.output.load_text import row_name
from kindyna_gui.background import beside
from kindyna_gui.forms.load_rows import put_attachment
from kindyna_gui.forms.loads_page import WHAT, first_field, parts_of, reordered, what_of
from kindyna_gui.labels import driver_text
from kindyna_gui.player import TURN
from kindyna_gui.requirements import lists_links
from kindyna_gui.window.base import Window

# -- linkage menus ---------------------------------------------------------------------------------------


def fill_drivers(window: Window, menu: QMenu) -> None:
    """Every link that can lead the linkage, at speed or by a motion."""
    design = _linkage(window, menu)
    if design is None:
        return
    group, now = QActionGroup(menu), design.drive.linkage.driver
    for driver in drivers(design):
        action = _choice(menu, group, driver_text(driver).replace("the motion", "a motion"), _same(driver, now))
        loses = _loses(design, driver)
        action.setStatusTip(
            f"The linkage goes on from the position in which it stands now{f', without {loses}' if loses else ''}"
        )
        action.triggered.connect(partial(_drive, window, driver))


def _same(one: Driver, other: Driver) -> bool:
    return (one.link, one.kind) == (other.link, other.kind)


def _loses(design: Design, driver: Driver) -> str:
    """What the design loses with another driver: a crank at speed has neither motion nor cam."""
    if driver.kind != CRANK or design.drive.motion is None:
        return ""
    return "its motion" if design.drive.cam is None else "its motion and its cam"


def _drive(window: Window, driver: Driver, *_: object) -> None:
    """Let another link lead; the drawing stays as it stands."""
    session, player = window.session, window.player
    if _same(driver, session.design.drive.linkage.driver):
        return
    before = session.design
    player.play(False)

    def changed() -> Design:
        made = beside(
            window, "Looking how the links can be put together", partial(with_driver, before, driver, kinematics)
        )
        if made is None:
            raise KindynaError("stopped before it was done")
        return made

    kinematics = session.at(player.theta).linkage
    step, loses = (
        f"Let link {driver.link} {'turn at speed' if driver.kind == CRANK else 'follow a motion'}",
        _loses(before, driver),
    )
    window.designing.change(changed, f"{step}, without {loses}" if loses else step)
    if session.design is not before:
        if loses:
            window.status.show_message(f"{step}: the linkage has lost {loses}, Undo brings back what it had")
        player.set_theta(
            driver_position(session.design.drive.mechanism, kinematics) % TURN if driver.kind == CRANK else 0.0
        )


def fill_rollers(window: Window, menu: QMenu) -> None:
    """No cam, or one under a roller at any point that moves; greyed where a crank turns at speed."""
    design = _linkage(window, menu)
    if design is None:
        return
    group, cam = QActionGroup(menu), design.drive.cam
    none = _choice(menu, group, "No cam", cam is None)
    none.triggered.connect(partial(_change, window, without_roller(design), "Take the cam away"))
    menu.addSeparator()
    for link, point in roller_points(design):
        here = cam is not None and cam.point == point
        action = _choice(menu, group, f"{point} on link {link}", here)
        action.setEnabled(design.drive.motion is not None)
        tip = "A cam about the origin under a roller here makes the linkage follow its motion"
        action.setStatusTip(
            tip if design.drive.motion is not None else "First let a link follow a motion: Driver does that"
        )
        if design.drive.motion is not None and not here:
            made = with_roller(design, link, point)
            action.triggered.connect(partial(_change, window, made, f"Put the cam roller on {point} of link {link}"))


def _change(window: Window, design: Design, text: str, *_: object) -> None:
    window.designing.change(lambda: design, text)


def fill_drawing(window: Window, menu: QMenu) -> None:
    """The tools of Draw, and what is done with what is chosen; greyed where no linkage is there."""
    menu.menuAction().setEnabled(bool(window.session.typed.drive.links))
    from kindyna_gui.linkage.draw_tools import TOOLS
    from kindyna_gui.linkage.drawing_actions import ACTIONS

    for tool in TOOLS.values():
        action = menu.addAction(f"{tool.text}\t{tool.key}")
        action.setStatusTip(tool.tip)
        action.triggered.connect(partial(_draw, window, tool.name))
    menu.addSeparator()
    view: Any = window.view("mechanism")
    for row in ACTIONS:
        action = menu.addAction(f"{row.text}\t{row.key}")
        action.setStatusTip(row.tip)
        action.setEnabled(view is not None and view.draws)
        action.triggered.connect(partial(_do, window, row.name))


def _draw(window: Window, tool: str, *_: object) -> None:
    window.draw(True, tool)


def _do(window: Window, action: str, *_: object) -> None:
    view: Any = window.view("mechanism")
    view.drawing.actions[action].trigger()


def _linkage(window: Window, menu: QMenu) -> Design | None:
    """The design, where it is a linkage; else the menu is not there."""
    design = window.session.design
    menu.menuAction().setVisible(lists_links(design))
    return design if lists_links(design) else None


def _choice(menu: QMenu, group: QActionGroup, text: str, checked: bool) -> QAction:
    action = menu.addAction(text)
    action.setCheckable(True)
    action.setChecked(checked)
    group.addAction(action)
    return action


# -- load rows -------------------------------------------------------------------------------------------

MASSES = "masses"
ONCE: Mapping[str, Callable[[Any], object]] = MappingProxyType(
    {MASSES: lambda held: held.link, "pair_friction": lambda held: held}
)
"""List of the loads in which each place stands once -> what of the place tells it."""


class LoadActions(QObject):
    """Rows of the loads of the chosen drive, added, attached elsewhere and brought before the reader."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._session = window, window.session

    def add(self, name: str) -> None:
        """A row more in one of the lists of the loads, where the user clicks in the drawing."""
        self._window.documents.settle()
        holds = [hold for hold in holds_of(self._session.typed.drive, name) if not hold.output]
        added = partial(self._added, name)
        if not holds or not self._ask(f"Add {what_of(name)}", holds, added, can_be_left=True):
            added(())

    def _added(self, name: str, held: Sequence[Target | None]) -> None:
        before = self._session.typed
        if there := self._once(name, held):
            self.open(there)
            self._window.status.show_message(f"{row_name(before, there)} is there already: these are its values")
            return
        make = partial(with_new_row, before, f"loads.{name}", held)
        self._window.designing.lay_out(make, f"Add {what_of(name)}")
        if self._session.typed is not before:
            if name == MASSES:
                self._show_masses()
            self.open(f"loads.{name}[{len(getattr(self._session.typed.drive.loads, name)) - 1}]")

    def _show_masses(self) -> None:
        """Draw the centres of mass, where they can be dragged."""
        view: Any = self._window.view("mechanism")
        for action in view.layer_actions():
            if action.objectName() == f"layer:{MASSES}":
                action.setChecked(True)

    def _once(self, name: str, held: Sequence[Target | None]) -> str:
        """The row that holds on there already, of a list in which each link, or each pair, stands once; empty where none does."""
        if name in ONCE and held:
            drive = self._session.typed.drive
            (hold,) = holds_of(drive, name)
            for i, row in enumerate(getattr(drive.loads, name)):
                if ONCE[name](hold.read(row)) == ONCE[name](held[0]):
                    return f"loads.{name}[{i}]"
        return ""

    def pick(self, path: str, key: str) -> None:
        """Let a row hold on elsewhere, where the user clicks in the drawing."""
        name, _ = parts_of(path)
        design = self._session.typed
        hold = next(hold for hold in holds_of(design.drive, name) if hold.key == key)
        others = [each.read(get(design, path)) for each in holds_of(design.drive, name) if each.key != key]

        def taken(held: Sequence[Target | None]) -> None:
            if put_attachment(self._session, path, hold, held[0]):
                self.open(path)

        self._ask(row_name(design, path), [hold], taken, beside=others)

    def _ask(
        self,
        what: str,
        holds: Sequence[AttachedEnd],
        taken: Any,
        can_be_left: bool = False,
        beside: Sequence[Target | None] = (),
    ) -> bool:
        """Whether there is a drawing in which it can be asked for."""
        view: Any = self._window.show_view("mechanism")
        view.pull()
        if view.in_trouble:
            return False
        view.pick(what, holds, taken, can_be_left, beside)
        return True

    def open(self, path: str) -> None:
        """Choose a row, and bring its form before the reader; empty: what belongs to no row."""
        self._session.choose_load(path)
        self._window.focus_field(first_field(self._session.typed, path) if path else "loads")

    def give_masses(self) -> None:
        """What nothing has: of links the first mass, asked for in the drawing where there is none; of a follower its fields."""
        drive = self._session.typed.drive
        if MASSES not in load_lists(drive):
            self._session.choose_load("")
            self._window.focus_field("loads")
        elif drive.loads.masses:
            self.open(f"loads.{MASSES}[0]")
        else:
            self._window.focus_field("loads")
            self.add(MASSES)


def fill_added(window: Window, menu: QMenu) -> None:
    """One entry for each list of loads that the design can have."""
    for name in load_lists(window.session.typed.drive):
        text, tip = WHAT[name]
        action = menu.addAction(text)
        action.setStatusTip(tip)
        action.triggered.connect(partial(_add, window, name))


def _add(window: Window, name: str, *_: object) -> None:
    window.loads.add(name)


def fill_taken(window: Window, menu: QMenu) -> None:
    """One entry for each row that there is."""
    design = window.session.typed
    for name in load_lists(design.drive):
        rows = getattr(design.drive.loads, name)
        for index in range(len(rows)):
            action = menu.addAction(row_name(design, f"loads.{name}[{index}]"))
            action.setStatusTip("Taken out of the loads; Undo brings it back")
            action.triggered.connect(partial(_take, window, name, index))
    if menu.isEmpty():
        action = menu.addAction("Nothing there")
        action.setStatusTip("The loads have no rows yet: Add to the loads begins one")
        action.setEnabled(False)


def _take(window: Window, name: str, index: int, *_: object) -> None:
    design = window.session.typed
    left = [i for i in range(len(getattr(design.drive.loads, name))) if i != index]
    text = f"Remove {row_name(design, f'loads.{name}[{index}]').lower()}"
    window.designing.lay_out(lambda: reordered(window.session.typed, name, left), text)
