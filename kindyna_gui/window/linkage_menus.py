"""Menus of a linkage: which link leads it and how, and where the roller of its cam is."""

from __future__ import annotations

from functools import partial
from typing import Any

from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QMenu

from core.design import CRANK, Design, Driver
from core.errors import KindynaError
from core.mechanism.drivers import driver_position, drivers, roller_points, with_driver, with_roller, without_roller
from kindyna_gui.labels import driver_text
from kindyna_gui.player import TURN
from kindyna_gui.requirements import lists_links
from kindyna_gui.waiting import beside
from kindyna_gui.window.base import Window


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
    from kindyna_gui.linkage.drawing_deeds import DEEDS

    for tool in TOOLS.values():
        action = menu.addAction(f"{tool.text}\t{tool.key}")
        action.setStatusTip(tool.tip)
        action.triggered.connect(partial(_draw, window, tool.name))
    menu.addSeparator()
    view: Any = window.view("mechanism")
    for deed in DEEDS:
        action = menu.addAction(f"{deed.text}\t{deed.key}")
        action.setStatusTip(deed.tip)
        action.setEnabled(view is not None and view.draws)
        action.triggered.connect(partial(_do, window, deed))


def _draw(window: Window, tool: str, *_: object) -> None:
    window.draw(True, tool)


def _do(window: Window, deed: Any, *_: object) -> None:
    view: Any = window.view("mechanism")
    view.drawing.deeds[deed.name].trigger()


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


__all__ = ["fill_drivers", "fill_rollers"]
