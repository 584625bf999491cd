"""Menus that add rows to the loads, and take them away: masses, forces, springs, friction, process forces."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from core.design import entries, load_lists, with_new_row, with_rows_in_order
from kindyna_gui.labels import row_name

if TYPE_CHECKING:
    from kindyna_gui.window.main_window import MainWindow

WHAT = {
    "masses": ("&Mass", "A mass and an inertia on a link"),
    "forces": ("&Force", "A constant force and a torque on a link"),
    "springs": ("&Spring and damper", "Between two points of links, or of a link and the frame"),
    "torsion_springs": ("&Torsion spring and damper", "Between two links"),
    "pair_friction": ("F&riction", "In a pin or along a slide"),
    "process": ("&Process force", "Over a part of the turn, at a part of the motion, or as a table"),
}
"""List of the loads -> its entry in the menu, and what it is."""


def fill_added(window: MainWindow, menu: QMenu) -> None:
    """One entry for each list of loads that the design can have."""
    for name in load_lists(window.session.design.drive):
        text, tip = WHAT[name]
        action = menu.addAction(text)
        action.setStatusTip(tip)
        action.triggered.connect(partial(_add, window, name))


def _add(window: MainWindow, name: str, *_: object) -> None:
    what = WHAT[name][0].replace("&", "").lower()
    before = window.session.design
    window.designing.change(lambda: with_new_row(window.session.design, f"loads.{name}"), f"Add {what}")
    design = window.session.design
    if design is not before:
        row = f"loads.{name}[{len(getattr(design.drive.loads, name)) - 1}]."
        window.focus_field(next((each.path for each in entries(design, "loads") if each.path.startswith(row)), "loads"))


def fill_taken(window: MainWindow, menu: QMenu) -> None:
    """One entry for each row that there is."""
    design = window.session.design
    for name in load_lists(design.drive):
        rows = getattr(design.drive.loads, name)
        for index in range(len(rows)):
            action = menu.addAction(row_name(design, f"loads.{name}[{index}]"))
            action.setStatusTip("Taken out of the loads; Undo brings it back")
            action.triggered.connect(partial(_take, window, name, index))
    if menu.isEmpty():
        action = menu.addAction("Nothing there")
        action.setStatusTip("The loads have no rows: Dyna > Add to the loads")
        action.setEnabled(False)


def _take(window: MainWindow, name: str, index: int, *_: object) -> None:
    design, path = window.session.design, f"loads.{name}"
    left = [i for i in range(len(getattr(design.drive.loads, name))) if i != index]
    text = f"Remove {row_name(design, f'{path}[{index}]').lower()}"
    window.designing.change(lambda: with_rows_in_order(window.session.design, path, left), text)


__all__ = ["WHAT", "fill_added", "fill_taken"]
