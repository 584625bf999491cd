"""Submenus of a linkage, Compo > Driver, Cam roller, Drawing, and edits of the loads' rows, Dyna > Add to the loads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QObject
from PySide6.QtGui import QActionGroup
from PySide6.QtWidgets import QMenu

from core.design import CRANK, AttachedEnd, Design, Driver, Target, get, holds_of, load_lists, with_new_row
from core.design.fields import in_sentence
from core.errors import KindynaError
from core.mechanism.drivers import driver_position, drivers, roller_points, with_driver, with_roller, without_roller
from core.output.load_text import row_name
from kindyna_gui.background import in_background
from kindyna_gui.forms.load_rows import put_attachment
from kindyna_gui.forms.loads_page import WHAT, first_field, parts_of, reordered, what_of
from kindyna_gui.labels import driver_text
from kindyna_gui.player import TURN
from kindyna_gui.rebuilt import add_entry
from kindyna_gui.requirements import lists_links
from kindyna_gui.window.base import Window

MASSES = "masses"
ONCE: Mapping[str, Callable[[Any], object]] = MappingProxyType(
    {MASSES: lambda target: target.link, "pair_friction": lambda target: target}
)
"""Lists of the loads with at most one row for each link, or pair -> the link, or pair, of a row's target."""
SEARCH = "Calculating how the links can be assembled"

# -- the driver, the cam roller and drawing ----------------------------------------------------------------


def fill_drivers(window: Window, menu: QMenu) -> None:
    """Add each link that can drive the linkage, at constant speed or by a motion."""
    design = _linkage(window, menu)
    if design is None:
        return
    group, now = QActionGroup(menu), design.drive.linkage.driver
    for driver in drivers(design):
        removed = _removed(design, driver)
        action = add_entry(
            menu,
            driver_text(driver).replace("the motion", "a motion"),
            partial(_drive, window, driver),
            f"Starts from the current position{f'; removes {removed}' if removed else ''}",
            checked=_same(driver, now),
        )
        group.addAction(action)


def _same(first: Driver, second: Driver) -> bool:
    return (first.link, first.kind) == (second.link, second.kind)


def _removed(design: Design, driver: Driver) -> str:
    """What another driver removes from the design: a crank at constant speed has no motion and no cam."""
    if driver.kind != CRANK or design.drive.motion is None:
        return ""
    return "its motion" if not design.drive.has_disk else "its motion and its cam"


def _drive(window: Window, driver: Driver) -> None:
    """Make another link the driver, in the current position of the linkage."""
    session, player = window.session, window.player
    if _same(driver, session.design.drive.linkage.driver):
        return
    before = session.design
    player.play(False)

    def changed() -> Design:
        design = in_background(window, SEARCH, partial(with_driver, before, driver, kinematics))
        if design is None:
            raise KindynaError("cancelled")
        return design

    kinematics = session.at(player.theta).linkage
    step = f"Drive link {driver.link} {'at constant speed' if driver.kind == CRANK else 'by a motion'}"
    removed = _removed(before, driver)
    window.designing.change(changed, f"{step}, without {removed}" if removed else step)
    if session.design is not before:
        if removed:
            window.status.show_message(f"{step}: removed {removed}; Undo restores it")
        player.set_theta(
            driver_position(session.design.drive.mechanism, kinematics) % TURN if driver.kind == CRANK else 0.0
        )


def fill_rollers(window: Window, menu: QMenu) -> None:
    """Add the entry without a cam, and one for each moving point that can carry a roller; these need a motion."""
    design = _linkage(window, menu)
    if design is None:
        return
    group, cam = QActionGroup(menu), design.drive.cam

    def change(changed: Design, text: str) -> None:
        window.designing.change(lambda: changed, text)

    without = partial(change, without_roller(design), "Remove the cam")
    group.addAction(add_entry(menu, "No cam", without, checked=cam is None))
    menu.addSeparator()
    has_motion = design.drive.motion is not None
    tip = "Put a roller on this point; a cam around the origin moves it, and the linkage follows its motion"
    for link, point in roller_points(design):
        is_current = cam is not None and cam.point == point
        with_cam = with_roller(design, link, point) if has_motion and not is_current else design
        action = add_entry(
            menu,
            f"{point} on link {link}",
            partial(change, with_cam, f"Put the cam roller on {point} of link {link}"),
            tip if has_motion else "First drive a link by a motion: Compo > Driver",
            enabled=has_motion,
            checked=is_current,
        )
        group.addAction(action)


def fill_drawing(window: Window, menu: QMenu) -> None:
    """Add the tools of Draw and the actions on selected parts; disabled without a linkage."""
    menu.menuAction().setEnabled(bool(window.session.typed.drive.links))
    from kindyna_gui.linkage.draw_tools import TOOLS
    from kindyna_gui.linkage.drawing_actions import ACTIONS

    for tool in TOOLS.values():
        add_entry(menu, f"{tool.text}\t{tool.key}", partial(window.draw, True, tool.name), tool.tip)
    menu.addSeparator()
    view: Any = window.view("mechanism")
    draws = view is not None and view.draws

    def do(name: str) -> None:
        view.drawing.actions[name].trigger()

    for row in ACTIONS:
        add_entry(menu, f"{row.text}\t{row.key}", partial(do, row.name), row.tip, enabled=draws)


def _linkage(window: Window, menu: QMenu) -> Design | None:
    """The design, if it is a linkage; else None, and the menu is hidden."""
    design = window.session.design
    menu.menuAction().setVisible(lists_links(design))
    return design if lists_links(design) else None


# -- rows of the loads -----------------------------------------------------------------------------------


class LoadActions(QObject):
    """Adds, attaches and shows rows of the selected drive's loads."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._session = window, window.session

    def add(self, name: str) -> None:
        """Add a row to one of the lists of the loads, attached where the user clicks in the drawing."""
        self._window.documents.settle()
        ends = [end for end in holds_of(self._session.typed.drive, name) if not end.output]
        added = partial(self._added, name)
        if not ends or not self._pick(f"Add {what_of(name)}", ends, added, can_be_left=True):
            added(())

    def _added(self, name: str, targets: Sequence[Target | None]) -> None:
        before = self._session.typed
        if existing := self._existing(name, targets):
            self.open(existing)
            self._window.status.show_message(f"{row_name(before, existing)} exists already: change its values here")
            return
        make = partial(with_new_row, before, f"loads.{name}", targets)
        self._window.designing.lay_out(make, f"Add {what_of(name)}")
        if self._session.typed is not before:
            if name == MASSES:
                self._show_masses()
            self.open(f"loads.{name}[{len(getattr(self._session.typed.drive.loads, name)) - 1}]")

    def _show_masses(self) -> None:
        """Show the layer of the centres of mass, which can be dragged."""
        view: Any = self._window.view("mechanism")
        for action in view.layer_actions():
            if action.objectName() == f"layer:{MASSES}":
                action.setChecked(True)

    def _existing(self, name: str, targets: Sequence[Target | None]) -> str:
        """Path of the row of the same link or pair in a list that has one for each; empty where there is none."""
        if name in ONCE and targets:
            drive = self._session.typed.drive
            (end,) = holds_of(drive, name)
            for i, row in enumerate(getattr(drive.loads, name)):
                if ONCE[name](end.read(row)) == ONCE[name](targets[0]):
                    return f"loads.{name}[{i}]"
        return ""

    def pick(self, path: str, key: str) -> None:
        """Attach an end of a row where the user clicks in the drawing."""
        name, _ = parts_of(path)
        design = self._session.typed
        ends = holds_of(design.drive, name)
        end = next(end for end in ends if end.key == key)
        others = [end.read(get(design, path)) for end in ends if end.key != key]

        def picked(targets: Sequence[Target | None]) -> None:
            if put_attachment(self._session, path, end, targets[0]):
                self.open(path)

        self._pick(row_name(design, path), [end], picked, others=others)

    def _pick(
        self,
        what: str,
        ends: Sequence[AttachedEnd],
        picked: Any,
        can_be_left: bool = False,
        others: Sequence[Target | None] = (),
    ) -> bool:
        """Let the user pick targets in the drawing; False where there is no drawing."""
        view: Any = self._window.show_view("mechanism")
        view.pull()
        if view.in_trouble:
            return False
        view.pick(what, ends, picked, can_be_left, others)
        return True

    def open(self, path: str) -> None:
        """Select a row and show its form; empty path: the fields of no row."""
        self._session.choose_load(path)
        self._window.focus_field(first_field(self._session.typed, path) if path else "loads")

    def give_masses(self) -> None:
        """Show the fields of the masses; a linkage without masses gets its first one by a click in the drawing."""
        drive = self._session.typed.drive
        if MASSES not in load_lists(drive):
            self._session.choose_load("")
            self._window.focus_field("loads")
        elif drive.loads.masses:
            self.open(f"loads.{MASSES}[0]")
        else:
            self._window.focus_field("loads")
            self.add(MASSES)


def fill_additions(window: Window, menu: QMenu) -> None:
    """Add an entry for each list of loads that the design can have."""
    for name in load_lists(window.session.typed.drive):
        text, tip = WHAT[name]
        add_entry(menu, text, partial(window.loads.add, name), tip)


def fill_removals(window: Window, menu: QMenu) -> None:
    """Add an entry that removes each row of the loads."""
    design = window.session.typed
    for name in load_lists(design.drive):
        rows = getattr(design.drive.loads, name)
        for index in range(len(rows)):
            text = row_name(design, f"loads.{name}[{index}]")
            add_entry(menu, text, partial(_remove, window, name, index), "Remove this load")
    if menu.isEmpty():
        action = menu.addAction("No loads")
        action.setStatusTip("There are no loads yet: use Add to the loads")
        action.setEnabled(False)


def _remove(window: Window, name: str, index: int) -> None:
    design = window.session.typed
    remaining = [i for i in range(len(getattr(design.drive.loads, name))) if i != index]
    text = f"Remove {in_sentence(row_name(design, f'loads.{name}[{index}]'))}"
    window.designing.lay_out(lambda: reordered(window.session.typed, name, remaining), text)
