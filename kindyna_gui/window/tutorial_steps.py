"""What a step asks for: where in the window it is done, which is marked, and how the hand does it."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QEventLoop, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QAction, QKeySequence, QMouseEvent
from PySide6.QtWidgets import QAbstractItemView, QApplication, QMenu, QWidget

from core.errors import KindynaError
from core.frozen import frozen
from kindyna_gui.window.base import Window

Place = tuple[QWidget, QRect]
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
PATIENCE = 20.0  # seconds
RADIUS = 14  # pixels around a place of the drawing
_KEY = re.compile(r"(?:(?:Ctrl|Shift|Alt)\+)*(?:[A-Za-z0-9]|F\d+|Return|Tab|Esc|Space|Del|Up|Down|Left|Right)")


class CannotDo(KindynaError):
    """The hand did not find what a step names."""


@frozen
class Deed:
    """One row: where it is done, None where that is not in sight; what brings that place into sight; how it is done."""

    place: Callable[[Window, Any], Place | None]
    show: Callable[[Window, Any], object]
    play: Callable[[Window, Any], None]


def settle() -> None:
    """Let the events at hand run, and those that they start. Mouse and keys of the user wait: they could end what is being played."""
    for _ in range(5):
        QApplication.processEvents(QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents)


def wait_for(condition: Callable[[], object], what: str) -> None:
    """Let events run until something is so. Raises CannotDo."""
    late = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > late:
            raise CannotDo(f"{what}: waited for it in vain")
        settle()
        time.sleep(0.002)


# -- mouse and keys -----------------------------------------------------------------------------------------


def _mouse(widget: QWidget, kind: QEvent.Type, at: QPointF, button: Qt.MouseButton, held: Qt.MouseButton) -> None:
    """One event of the mouse, as the window system sends it."""
    event = QMouseEvent(kind, at, widget.mapToGlobal(at), button, held, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(widget, event)


def _press(widget: QWidget, at: QPoint) -> None:
    place = QPointF(at)
    _mouse(widget, QEvent.Type.MouseMove, place, NONE, NONE)
    settle()
    _mouse(widget, QEvent.Type.MouseButtonPress, place, LEFT, LEFT)


def _release(widget: QWidget, at: QPoint) -> None:
    _mouse(widget, QEvent.Type.MouseButtonRelease, QPointF(at), LEFT, NONE)
    settle()


def click(widget: QWidget, at: QPoint | None = None) -> None:
    """With the left button; in the middle where no place is named."""
    place = widget.rect().center() if at is None else at
    _press(widget, place)
    _release(widget, place)


def _keys(window: Window, keys: list[str]) -> None:
    """Keys, ``Ctrl+K``, ``Return``, and texts that are typed, on whatever has the focus."""
    from PySide6.QtTest import QTest

    for each in keys:
        target = QApplication.focusWidget() or window
        if _KEY.fullmatch(each) and (len(each) > 1 or each.isupper()):
            sequence: Any = QKeySequence(each)
            QTest.keyClick(target, sequence[0].key(), sequence[0].keyboardModifiers())
        else:
            for letter in each:  # the first digit may open a box, in which the others are typed
                QTest.keyClicks(QApplication.focusWidget() or window, letter)
                settle()
        settle()


# -- menus --------------------------------------------------------------------------------------------------


def plain(text: str) -> str:
    """An entry without its keys of access, its shortcut and its dots."""
    text = text.partition("\t")[0].replace("&&", "\0").replace("&", "").replace("\0", "&")
    return text.removesuffix("...")


def _way(way: str) -> list[str]:
    return [each.strip() for each in way.split(">")]


def _entry(place: QWidget, text: str) -> QAction:
    for action in place.actions():
        if plain(action.text()) == text and action.isVisible():
            return action
    raise CannotDo(f"{text}: no such entry; there are {', '.join(plain(each.text()) for each in place.actions())}")


def _menu_place(window: Window, way: str) -> Place | None:
    """The title in the bar; once menus are open, the entry of the last of them."""
    titles = _way(way)
    popup = QApplication.activePopupWidget()
    if isinstance(popup, QMenu):
        for action in popup.actions():
            if plain(action.text()) in titles:
                return popup, popup.actionGeometry(action)
    bar = window.menuBar()
    return bar, bar.actionGeometry(_entry(bar, titles[0]))


def _menu(window: Window, way: str) -> None:
    """Click the title, and the entries of the menus that open."""
    place: QWidget = window.menuBar()
    for i, text in enumerate(titles := _way(way)):
        action = _entry(place, text)
        geometry = place.actionGeometry(action) if isinstance(place, QMenu) else window.menuBar().actionGeometry(action)
        if not action.isEnabled():
            raise CannotDo(f"{way}: {text} cannot be chosen")
        click(place, geometry.center())
        menu = action.menu()
        if i < len(titles) - 1:
            if not isinstance(menu, QMenu):
                raise CannotDo(f"{way}: {text} opens no menu")
            wait_for(menu.isVisible, text)
            place = menu


# -- fields -------------------------------------------------------------------------------------------------


def _editor(window: Window, path: str) -> QWidget | None:
    """Of a field that is in sight."""
    at = path.partition("].")[2] if path.startswith("drives[") else path
    for view in window.findChildren(QWidget):
        fields = getattr(view, "fields", None)
        if isinstance(fields, Mapping) and at in fields and fields[at].editor.isVisible():
            return fields[at].editor
    return None


def _field_place(window: Window, path: str) -> Place | None:
    editor = _editor(window, path)
    if editor is not None:
        return editor, editor.rect()
    view: Any = window.view("motion") if ".segments[" in path else None
    if view is None or not view.on_screen():
        return None
    table = view.table
    return table.viewport(), table.visualRect(table.currentIndex())


def _field(window: Window, path: str) -> None:
    """Lead to the field, and choose what stands in it, so that typing takes its place."""
    window.focus_field(path)
    settle()
    editor: Any = _editor(window, path)
    if editor is not None:
        editor.setFocus()
        if hasattr(editor, "selectAll"):
            editor.selectAll()
        return
    table: Any = getattr(window.view("motion"), "table", None)
    if ".segments[" not in path or table is None:
        raise CannotDo(f"{path}: this design has no such field")
    table.setFocus()
    _keys(window, ["Return"])
    wait_for(lambda: table.state() == QAbstractItemView.State.EditingState, path)


# -- the drawing --------------------------------------------------------------------------------------------


def _canvas(window: Window) -> Any:
    view: Any = window.view("mechanism")
    return view.canvas if view is not None else None


def _pixel(window: Window, where: str | list[float]) -> QPoint:
    """Of a place of the drawing [mm], or of a named point of the linkage that is drawn."""
    view: Any = window.view("mechanism")
    if isinstance(where, str):
        places = view.drawing.sheet[1] if view.draws else {}
        if where not in places:
            raise CannotDo(
                f"{where}: the drawing has no such point; it has {', '.join(places) or 'none that can be named'}"
            )
        at = QPointF(places[where].real, places[where].imag)
    else:
        at = QPointF(*where)
    place: QPoint = view.canvas.viewportTransform().map(at).toPoint()
    return place


def _drag_place(window: Window, places: list[Any]) -> Place | None:
    canvas = _canvas(window)
    if canvas is None or not canvas.isVisible():
        return None
    try:
        at = _pixel(window, places[0])
    except CannotDo:
        return None
    return canvas.viewport(), QRect(at - QPoint(RADIUS, RADIUS), at + QPoint(RADIUS, RADIUS))


def _drag(window: Window, places: list[Any]) -> None:
    """Press at the first place, go through the others and release at the last; one place alone is clicked."""
    view: Any = window.show_view("mechanism")
    wait_for(lambda: view.on_screen() and view.up_to_date, "the drawing")
    area = view.canvas.viewport()
    pixels = [_pixel(window, each) for each in places]
    _press(area, pixels[0])
    for start, end in pairwise(pixels):
        for part in (0.3, 0.7, 1.0):
            _mouse(area, QEvent.Type.MouseMove, QPointF(start + (end - start) * part), NONE, LEFT)
            settle()
    _release(area, pixels[-1])


DEEDS: Mapping[str, Deed] = MappingProxyType(
    {
        "menu": Deed(_menu_place, lambda window, way: None, _menu),
        "field": Deed(_field_place, lambda window, path: window.focus_field(path), _field),
        "drag": Deed(_drag_place, lambda window, places: window.show_view("mechanism"), _drag),
        "keys": Deed(lambda window, keys: None, lambda window, keys: None, _keys),
        "type": Deed(lambda window, keys: None, lambda window, keys: None, _keys),  # keys once more, after another deed
    }
)
"""Key of ``do`` -> how it is marked and done."""


def play(window: Window, do: Mapping[str, Any]) -> None:
    """Do what a step asks for, with mouse and keys. Raises CannotDo."""
    for key, what in do.items():
        DEEDS[key].play(window, what)


def place_of(window: Window, do: Mapping[str, Any]) -> Place | None:
    """Where the step is done, the first of its places that is in sight; None where none is."""
    found = map(partial(_seen, window), do.items())
    return next((place for place in found if place is not None), None)


def _seen(window: Window, row: tuple[str, Any]) -> Place | None:
    try:
        return DEEDS[row[0]].place(window, row[1])
    except CannotDo:
        return None
