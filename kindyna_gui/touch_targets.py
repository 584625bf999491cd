"""Parts of drawings and plots under the mouse: their context menus, and the read-out during a drag."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from html import escape
from typing import Any

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRect, QSize, Qt
from PySide6.QtGui import QColor, QKeyEvent, QPainter
from PySide6.QtWidgets import QApplication, QLabel, QMenu, QWidget

from core.design import Design, get, split_unit
from core.errors import NoSolution
from core.frozen import frozen
from core.study import Study, quantity
from core.units import Unit
from kindyna_gui.forms.number_box import parsed
from kindyna_gui.labels import name_of
from kindyna_gui.labels import value_text as shown_value
from kindyna_gui.pictures.plots.quantities import limits_on, rows_of
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import measure
from kindyna_gui.rebuilt import add_entry
from kindyna_gui.saving import copy_picture
from kindyna_gui.view import ExplainableNumber, View, ViewHost

ReadoutLine = tuple[str, bool]
"""A line next to the mouse, and whether a limit is violated."""
MenuEntry = tuple[str, Callable[[], Any]]
"""Text of an entry of a context menu, and its function."""
READOUT_QUANTITIES = ("pressure_angle", "pitch_curvature", "drive_torque", "contact_force", "contact_pressure")
"""Quantities shown during a drag, as far as the design has them."""


@frozen
class MouseTarget:
    """The part under the mouse.

    noun     its name for the user: ``Roller``
    path     path of the field that a click opens, or empty
    explain  channel whose value can be explained, or empty
    value    text that is copied; if empty, the value of the field
    export   key of the menu entry that exports its shape, or empty
    point    name of the point of a linkage, whose path can be shown
    """

    noun: str
    path: str
    explain: str = ""
    value: str = ""
    export: str = ""
    point: str = ""


# -- context menu -----------------------------------------------------------------------------------------------


def _design_of(target: MouseTarget, view: View) -> Design:
    """Return the full design for a path through its drives, else the design of the current drive."""
    design: Design = view.session.full_design
    return design if target.path.startswith(("drives[", "timing[")) else view.session.design


def value_text(design: Design, path: str) -> str:
    """Value of a field with its unit; empty if the field is no number."""
    try:
        value = get(design, path)
    except KeyError:
        return ""
    return shown_value(float(value), split_unit(path)[1]) if isinstance(value, float | int) else ""


def search_for(design: Design, path: str) -> str:
    """Search of Find that varies a field; empty if there is none."""
    from core.find import available_searches, available_shaft_searches, varied_fields

    if path.endswith((".phase_deg", ".centre_deg")):
        return next((search for search in available_shaft_searches(design) if search == "phases"), "")
    searches = () if design.listed else available_searches(design)
    return next((search for search in searches if varied_fields(design, search) == (path,)), "")


def _edit(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    name = name_of(_design_of(target, view), target.path) if target.path else ""
    return (f"Edit {name}", lambda: host.focus_field(target.path)) if name else None


def _find(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    design = _design_of(target, view)
    search = search_for(design, target.path)
    return (f"Find {name_of(design, target.path)}...", lambda: host.show_search(search)) if search else None


def _vary(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    design = _design_of(target, view)
    if not value_text(design, target.path):
        return None
    return f"Vary {name_of(design, target.path)}", lambda: view.session.vary(target.path)


def _explain(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    rows = rows_of(view.session.study, (target.explain,)) if target.explain else ()
    if not rows:
        return None
    label = rows[0].label
    return f"Explain {label[:1].lower()}{label[1:]} here", lambda: host.explain(ExplainableNumber(target.explain))


def _copy(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    value = target.value or value_text(_design_of(target, view), target.path)
    return (f"Copy {value}", lambda: QApplication.clipboard().setText(value)) if value else None


def _export(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    return (EXPORTS[target.export], lambda: host.do(target.export)) if target.export else None


def _copy_picture(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    return "Copy picture", lambda: copy_picture(view)


def _fit(target: MouseTarget, view: View, host: ViewHost) -> MenuEntry | None:
    return None if type(view).fit is View.fit else ("Fit", view.fit)


EXPORTS = {"exports.profile": "Export profile...", "exports.surfaces": "Export solid and surfaces..."}
"""Key of a menu entry that exports a shape -> its text in a context menu."""
MENU_ENTRIES = (_edit, _find, _vary, _explain, _copy, _export, _copy_picture, _fit)
"""Functions that return the entry of the menu for a part, None if it does not apply."""


def menu_entries(target: MouseTarget | None, view: View, host: ViewHost) -> Iterator[MenuEntry]:
    """Yield the entries of the context menu of a part, or of the empty drawing."""
    entries = (entry(target or MouseTarget("", ""), view, host) for entry in MENU_ENTRIES)
    return (entry for entry in entries if entry is not None)


def open_menu(
    target: MouseTarget | None, view: View, host: ViewHost, on_screen: QPoint, more: QWidget | None = None
) -> QMenu:
    """Open the context menu of a part; the actions of the widget ``more`` are added below."""
    menu = QMenu(view)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    if target is not None:
        menu.addSection(target.noun)
    for text, run in menu_entries(target, view, host):
        add_entry(menu, text, run)
    paths = getattr(view, "paths", None)
    if paths is not None and target is not None and target.point:
        add_entry(menu, "Show path", partial(paths.toggle, target.point), checked=paths.is_shown(target.point))
    if more is not None and more.actions():
        menu.addSeparator()
        menu.addActions(more.actions())
    menu.popup(on_screen)
    return menu


# -- read-out next to the mouse -----------------------------------------------------------------------------------


def typed_key(typed: str, event: QKeyEvent, unit: Unit, enter: Callable[[float | None], bool]) -> str | None:
    """Typed number of a drag after one more key; None if the key does not belong to a number.

    Return passes the number to ``enter``, None where the text is no number, which returns whether the text is used up.
    """
    text = event.text()
    if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
        return "" if enter(parsed(typed, unit) if typed else None) else typed
    if event.key() == Qt.Key.Key_Backspace:
        return typed[:-1]
    return typed + text if text and (text in "+-*/(). ," or text.isalnum()) else None


def paint_readout(painter: QPainter, lines: Sequence[ReadoutLine], mouse: QPointF, room: QRect) -> None:
    """Paint lines next to the mouse, at a pixel; violated limits in the colour of limits."""
    if not lines:
        return
    metrics = painter.fontMetrics()
    size = QSize(max(metrics.horizontalAdvance(text) for text, _ in lines) + 12, len(lines) * metrics.height() + 8)
    box = QRect(mouse.toPoint() + QPoint(16, 16), size)
    if box.right() > room.right():
        box.moveRight(mouse.toPoint().x() - 16)
    if box.bottom() > room.bottom():
        box.moveBottom(mouse.toPoint().y() - 16)
    box.moveLeft(max(box.left(), room.left()))
    painter.setPen(QColor(SCREEN.line))
    painter.setBrush(QColor(SCREEN.paper))
    painter.drawRect(box)
    for number, (text, violated) in enumerate(lines):
        painter.setPen(QColor(SCREEN.limit if violated else SCREEN.ink))
        painter.drawText(box.left() + 6, box.top() + 4 + number * metrics.height() + metrics.ascent(), text)


class MouseReadout(QLabel):
    """Lines next to the mouse, over the whole window."""

    def __init__(self, view: QWidget) -> None:
        self._room = view.window()
        super().__init__(self._room)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setStyleSheet(
            f"color: {SCREEN.ink}; background: {SCREEN.paper}; border: 1px solid {SCREEN.line}; padding: 3px 5px"
        )

    def show_lines(self, lines: Sequence[ReadoutLine], on_screen: QPoint) -> None:
        """Show lines at the mouse; hide the read-out if there are none."""
        self.setText(
            "<br>".join(
                f"<span style='color:{SCREEN.limit if violated else SCREEN.ink}'>{escape(text)}</span>"
                for text, violated in lines
            )
        )
        self.adjustSize()
        room = self._room
        mouse = room.mapFromGlobal(on_screen)
        right, below = mouse.x() + 16 + self.width() <= room.width(), mouse.y() + 16 + self.height() <= room.height()
        self.move(mouse.x() + (16 if right else -16 - self.width()), mouse.y() + (16 if below else -16 - self.height()))
        self.setVisible(bool(lines))
        self.raise_()


# -- values of the read-out ---------------------------------------------------------------------------------------


def readout_lines(study: Study, path: str, stages: tuple[str, ...]) -> list[ReadoutLine]:
    """Lines of the read-out: the dragged field, then peaks with their limits.

    Pressure angle and undercut are always shown, forces only if ``stages``, the stages on the screen, contain theirs.
    """
    lines: list[ReadoutLine] = [(f"{name_of(study.design, path)} {value_text(study.design, path)}", False)]
    shown = {*study.stages} & {"cam", *stages}
    for row in rows_of(study, [name for name in READOUT_QUANTITIES if quantity(name).stage in shown]):
        try:
            values = row.values(study)
            limits = [limit.value / row.unit.factor for limit in limits_on(study, row.name)]
        except NoSolution:
            continue
        lines.append(
            _radius(values * row.unit.factor, [limit * row.unit.factor for limit in limits])
            if row.name == "pitch_curvature"
            else _peak(row, values, limits)
        )
    return lines


def _peak(row: Any, values: np.ndarray, limits: list[float]) -> ReadoutLine:
    """Compare the contact force with its lower limit, other peaks with their upper limit."""
    is_lower = row.name == "contact_force"
    peak = float(values.min() if is_lower else values[np.argmax(np.abs(values))])
    limit = (max if is_lower else min)(limits, default=None)
    violated = limit is not None and (peak < limit if is_lower else abs(peak) > limit)
    text = f"{row.label} {'least ' if is_lower else ''}{measure(peak, row.unit.symbol)}"
    return (text if limit is None else f"{text}, limit {measure(limit, row.unit.symbol)}"), violated


def _radius(values: np.ndarray, limits: list[float]) -> ReadoutLine:
    """Compare the smallest radius of the pitch curve with the limit of undercut; curvatures in 1/m."""
    largest = float(values.max())
    if not limits or largest <= 0.0:
        return "No undercut", False
    text = f"Pitch radius {measure(1e3 / largest, 'mm')}, undercut below {measure(1e3 / min(limits), 'mm')}"
    return text, largest >= min(limits)


__all__ = [
    "MouseReadout", "MouseTarget", "ReadoutLine", "menu_entries", "open_menu", "paint_readout", "readout_lines", "typed_key",
]  # fmt: skip
