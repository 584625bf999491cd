"""What is touched with the mouse, in drawings, plots and charts: what can be done with it, what is typed meanwhile, and what answers while
it is drawn elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from html import escape
from typing import Any

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRect, QSize, Qt
from PySide6.QtGui import QColor, QKeyEvent, QPainter
from PySide6.QtWidgets import QApplication, QLabel, QMenu, QWidget

from core.design import Design, get, split_unit
from core.errors import NoSolution
from core.frozen import frozen
from core.study import Study
from kindyna_gui.labels import name_of
from kindyna_gui.labels import value_text as shown_value
from kindyna_gui.pictures.plots.quantities import limits_on, rows_of
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import measure
from kindyna_gui.saving import copy_picture
from kindyna_gui.view import ExplainableNumber, View, ViewHost

Answer = tuple[str, bool]
"""A line beside the mouse, and whether it says that a limit is passed."""


@frozen
class Thing:
    """What lies under the mouse.

    noun     for the reader: ``Roller``
    path     of the field that a click opens; empty: none
    explain  the channel whose value here is explained; empty: none
    value    what is copied; empty: the value of the field
    profile  it has a profile, which can be written
    """

    noun: str
    path: str
    explain: str = ""
    value: str = ""
    profile: bool = False


Deed = tuple[str, Callable[[], Any]]
"""An entry of a menu, and what it does."""

# -- what can be done with it -----------------------------------------------------------------------------------


def _design_of(thing: Thing, view: View) -> Design:
    """The whole where the path leads through its drives, else the design of the drive at hand."""
    whole: Design = view.session.full_design
    return whole if thing.path.startswith(("drives[", "timing[")) else view.session.design


def value_text(design: Design, path: str) -> str:
    """The value of a field with its unit; empty where the path leads to no number."""
    try:
        value = get(design, path)
    except KeyError:
        return ""
    return shown_value(float(value), split_unit(path)[1]) if isinstance(value, float | int) else ""


def search_for(design: Design, path: str) -> str:
    """What Find seeks that varies this field; empty where nothing does."""
    from core.find import available_searches, available_shaft_searches, varied_fields

    if path.endswith(".phase_deg"):
        return next((what for what in available_shaft_searches(design) if what == "phases"), "")
    return (
        ""
        if design.listed
        else next((what for what in available_searches(design) if varied_fields(design, what) == (path,)), "")
    )


def _edit(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    name = name_of(_design_of(thing, view), thing.path) if thing.path else ""
    return (f"Edit {name}", lambda: host.focus_field(thing.path)) if name else None


def _find(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    design = _design_of(thing, view)
    what = search_for(design, thing.path)
    return (f"Find {name_of(design, thing.path)}...", lambda: host.show_search(what)) if what else None


def _vary(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    design = _design_of(thing, view)
    if not value_text(design, thing.path):
        return None
    return f"Vary {name_of(design, thing.path)}", lambda: view.session.vary(thing.path)


def _explain(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    rows = rows_of(view.session.study, (thing.explain,)) if thing.explain else ()
    if not rows:
        return None
    label = rows[0].label
    return f"Explain {label[:1].lower()}{label[1:]} here", lambda: host.explain(ExplainableNumber(thing.explain))


def _copy(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    value = thing.value or value_text(_design_of(thing, view), thing.path)
    return (f"Copy {value}", lambda: QApplication.clipboard().setText(value)) if value else None


def _export(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    return ("Export profile...", lambda: host.do("exports.profile")) if thing.profile else None


def _copy_picture(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    return "Copy picture", lambda: copy_picture(view)


def _fit(thing: Thing, view: View, host: ViewHost) -> Deed | None:
    return None if type(view).fit is View.fit else ("Fit", view.fit)


DEEDS = (_edit, _find, _vary, _explain, _copy, _export, _copy_picture, _fit)
"""What can be done with a thing: each row its entry of the menu, None where it cannot be done."""


def deeds(thing: Thing | None, view: View, host: ViewHost) -> Iterator[Deed]:
    """The entries of the context menu over a thing, and where there is none: text and what it does."""
    found = (row(thing or Thing("", ""), view, host) for row in DEEDS)
    return (deed for deed in found if deed is not None)


def open_menu(thing: Thing | None, view: View, host: ViewHost, on_screen: QPoint, more: QWidget | None = None) -> QMenu:
    """The context menu over a thing; more: a widget whose own entries stand below."""
    menu = QMenu(view)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    if thing is not None:
        menu.addSection(thing.noun)
    for text, do in deeds(thing, view, host):
        menu.addAction(text).triggered.connect(lambda _, do=do: do())
    if more is not None and more.actions():
        menu.addSeparator()
        menu.addActions(more.actions())
    menu.popup(on_screen)
    return menu


# -- what stands beside the mouse while something is held --------------------------------------------------------


def typed_on(typed: str, event: QKeyEvent) -> str | None:
    """What is typed of a number after one key more; None where the key belongs to no number."""
    text = event.text()
    if event.key() == Qt.Key.Key_Backspace:
        return typed[:-1]
    return typed + text if text and (text in "+-*/(). ," or text.isalnum()) else None


def paint_beside(painter: QPainter, lines: Sequence[Answer], here: QPointF, room: QRect) -> None:
    """Lines beside the mouse, in pixels; what passes a limit in the colour of limits."""
    if not lines:
        return
    metrics = painter.fontMetrics()
    size = QSize(max(metrics.horizontalAdvance(text) for text, _ in lines) + 12, len(lines) * metrics.height() + 8)
    box = QRect(here.toPoint() + QPoint(16, 16), size)
    if box.right() > room.right():
        box.moveRight(here.toPoint().x() - 16)
    if box.bottom() > room.bottom():
        box.moveBottom(here.toPoint().y() - 16)
    painter.setPen(QColor(SCREEN.line))
    painter.setBrush(QColor(SCREEN.paper))
    painter.drawRect(box)
    for number, (text, passed) in enumerate(lines):
        painter.setPen(QColor(SCREEN.limit if passed else SCREEN.ink))
        painter.drawText(box.left() + 6, box.top() + 4 + number * metrics.height() + metrics.ascent(), text)


class BesideMouse(QLabel):
    """Lines beside the mouse, over all of the window, where the widget below has no room for them."""

    def __init__(self, view: QWidget) -> None:
        self._room = view.window()
        super().__init__(self._room)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setStyleSheet(
            f"color: {SCREEN.ink}; background: {SCREEN.paper}; border: 1px solid {SCREEN.line}; padding: 3px 5px"
        )

    def tell(self, lines: Sequence[Answer], on_screen: QPoint) -> None:
        """Show these where the mouse is; none: nothing."""
        self.setText(
            "<br>".join(
                f"<span style='color:{SCREEN.limit if passed else SCREEN.ink}'>{escape(text)}</span>"
                for text, passed in lines
            )
        )
        self.adjustSize()
        room = self._room
        here = room.mapFromGlobal(on_screen)
        right, below = here.x() + 16 + self.width() <= room.width(), here.y() + 16 + self.height() <= room.height()
        self.move(here.x() + (16 if right else -16 - self.width()), here.y() + (16 if below else -16 - self.height()))
        self.setVisible(bool(lines))
        self.raise_()


# -- what answers while it is drawn elsewhere -------------------------------------------------------------------


ANSWERS = ("pressure_angle", "pitch_curvature", "drive_torque", "contact_force", "contact_pressure")
"""Quantities that are told, those that a design has."""


def answers(study: Study, path: str, stages: tuple[str, ...]) -> list[Answer]:
    """The value that the mouse changes, and below it what answers: pressure angle and undercut, and of forces what is on the screen
    anyway (``stages``); each with the limit that it is held against."""
    lines: list[Answer] = [(f"{name_of(study.design, path)} {value_text(study.design, path)}", False)]
    for row in rows_of(study, ANSWERS):
        if row.stage not in ("cam", *stages):
            continue
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


def _peak(row: Any, values: np.ndarray, limits: list[float]) -> Answer:
    """A force is held against the least that is wanted, all else against the most."""
    low = row.name == "contact_force"
    top = float(values.min() if low else values[np.argmax(np.abs(values))])
    held = (max if low else min)(limits, default=None)
    passed = held is not None and (top < held if low else abs(top) > held)
    text = f"{row.label} {'least ' if low else ''}{measure(top, row.unit.symbol)}"
    return (text if held is None else f"{text}, limit {measure(held, row.unit.symbol)}"), passed


def _radius(values: np.ndarray, limits: list[float]) -> Answer:
    """The least radius of the pitch curve against that from which on it is undercut [1/m]."""
    top = float(values.max())
    if not limits or top <= 0.0:
        return "No undercut", False
    text = f"Pitch radius {measure(1e3 / top, 'mm')}, undercut below {measure(1e3 / min(limits), 'mm')}"
    return text, top >= min(limits)


__all__ = ["Answer", "BesideMouse", "Thing", "answers", "deeds", "open_menu", "paint_beside", "typed_on"]
