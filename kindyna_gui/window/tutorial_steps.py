"""Actions of a tutorial step: the part of the window to mark, and how the action is played with mouse and keys."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from itertools import pairwise
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QEventLoop, QPoint, QPointF, QRect, Qt, QTimer
from PySide6.QtGui import QAction, QKeySequence, QMouseEvent
from PySide6.QtWidgets import QAbstractItemView, QApplication, QMenu, QWidget

from core.errors import KindynaError
from core.frozen import frozen
from kindyna_gui.window.base import Window

Region = tuple[QWidget, QRect]  # a widget and a part of it
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
PATIENCE = 20.0  # longest time to wait for a condition [s]
POLL_MS = 5  # between two looks for a dialog
RADIUS = 14  # around a point of the drawing [pixels]
_KEY = re.compile(r"(?:(?:Ctrl|Shift|Alt)\+)*(?:[A-Za-z0-9]|F\d+|Return|Tab|Esc|Space|Del|Up|Down|Left|Right)")


class CannotDo(KindynaError):
    """A step cannot be played: the window does not have what it names."""


@frozen
class TutorialAction:
    """One key of ``do``: the region it acts on, None if not visible; how to make that visible; how to play it."""

    region: Callable[[Window, Any], Region | None]
    show: Callable[[Window, Any], object]
    play: Callable[[Window, Any], None]


def settle() -> None:
    """Process pending events and those that they post, but no input of the user, which could disturb the action."""
    for _ in range(5):
        QApplication.processEvents(QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents)


def wait_for(condition: Callable[[], object], what: str) -> None:
    """Process events until a condition is true. Raises CannotDo after ``PATIENCE`` seconds."""
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise CannotDo(f"{what}: not reached within {PATIENCE:g} s")
        settle()
        time.sleep(0.002)


# -- mouse and keys -----------------------------------------------------------------------------------------


def _mouse(widget: QWidget, kind: QEvent.Type, at: QPointF, button: Qt.MouseButton, down: Qt.MouseButton) -> None:
    """Send one mouse event; ``down`` are the buttons pressed meanwhile."""
    event = QMouseEvent(kind, at, widget.mapToGlobal(at), button, down, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(widget, event)


def _press(widget: QWidget, at: QPoint) -> None:
    point = QPointF(at)
    _mouse(widget, QEvent.Type.MouseMove, point, NONE, NONE)
    settle()
    _mouse(widget, QEvent.Type.MouseButtonPress, point, LEFT, LEFT)


def _release(widget: QWidget, at: QPoint) -> None:
    _mouse(widget, QEvent.Type.MouseButtonRelease, QPointF(at), LEFT, NONE)
    settle()


def click(widget: QWidget, at: QPoint | None = None) -> None:
    """Click with the left button, by default in the middle of the widget."""
    point = widget.rect().center() if at is None else at
    _press(widget, point)
    _release(widget, point)


def _keys(window: Window, keys: list[str]) -> None:
    """Press keys, such as ``Ctrl+K`` or ``Return``, and type texts, in the widget with the focus."""
    from PySide6.QtTest import QTest

    for text in keys:
        target = QApplication.focusWidget() or window
        if _KEY.fullmatch(text) and (len(text) > 1 or text.isupper()):
            sequence: Any = QKeySequence(text)
            QTest.keyClick(target, sequence[0].key(), sequence[0].keyboardModifiers())
        else:
            for letter in text:  # the first digit may open a box, which takes the others
                QTest.keyClicks(QApplication.focusWidget() or window, letter)
                settle()
        settle()


# -- menus --------------------------------------------------------------------------------------------------


def plain(text: str) -> str:
    """Return the text of an entry without access key, shortcut and dots."""
    text = text.partition("\t")[0].replace("&&", "\0").replace("&", "").replace("\0", "&")
    return text.removesuffix("...")


def _titles(path: str) -> list[str]:
    return [title.strip() for title in path.split(">")]


def _entry(menu: QWidget, text: str) -> QAction:
    for action in menu.actions():
        if plain(action.text()) == text and action.isVisible():
            return action
    names = ", ".join(plain(action.text()) for action in menu.actions())
    raise CannotDo(f"{text}: no such entry; the entries are {names}")


def _menu_region(window: Window, path: str) -> Region | None:
    """The title in the menu bar; once a menu is open, the entry in the last open menu."""
    titles = _titles(path)
    popup = QApplication.activePopupWidget()
    if isinstance(popup, QMenu):
        for action in popup.actions():
            if plain(action.text()) in titles:
                return popup, popup.actionGeometry(action)
    bar = window.menuBar()
    return bar, bar.actionGeometry(_entry(bar, titles[0]))


def _menu(window: Window, path: str) -> None:
    """Click the title in the menu bar and the entries of the menus that open."""
    bar = window.menuBar()
    parent: QWidget = bar
    for i, text in enumerate(titles := _titles(path)):
        action = _entry(parent, text)
        geometry = parent.actionGeometry(action) if isinstance(parent, QMenu) else bar.actionGeometry(action)
        if not action.isEnabled():
            raise CannotDo(f"{path}: {text} is not enabled")
        click(parent, geometry.center())
        menu = action.menu()
        if i < len(titles) - 1:
            if not isinstance(menu, QMenu):
                raise CannotDo(f"{path}: {text} opens no menu")
            wait_for(menu.isVisible, text)
            parent = menu


# -- fields -------------------------------------------------------------------------------------------------


def _editor(window: Window, path: str) -> QWidget | None:
    """Editor of a field, None if it is not visible."""
    at = path.partition("].")[2] if path.startswith("drives[") else path
    for view in window.findChildren(QWidget):
        fields = getattr(view, "fields", None)
        if isinstance(fields, Mapping) and at in fields and fields[at].editor.isVisible():
            return fields[at].editor
    return None


def _field_region(window: Window, path: str) -> Region | None:
    editor = _editor(window, path)
    if editor is not None:
        return editor, editor.rect()
    view: Any = window.view("motion") if ".segments[" in path else None
    if view is None or not view.on_screen():
        return None
    table = view.table
    return table.viewport(), table.visualRect(table.currentIndex())


def _field(window: Window, path: str) -> None:
    """Show and focus a field and select its text, so that typing replaces it."""
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
    """Pixel of a position in the drawing [mm], or of a named point of the linkage being drawn."""
    view: Any = window.view("mechanism")
    if isinstance(where, str):
        points = view.drawing.layout[1] if view.draws else {}
        if where not in points:
            raise CannotDo(f"{where}: the drawing has no such point; its points are {', '.join(points) or 'not named'}")
        at = QPointF(points[where].real, points[where].imag)
    else:
        at = QPointF(*where)
    pixel: QPoint = view.canvas.viewportTransform().map(at).toPoint()
    return pixel


def _drag_region(window: Window, points: list[Any]) -> Region | None:
    canvas = _canvas(window)
    if canvas is None or not canvas.isVisible():
        return None
    try:
        at = _pixel(window, points[0])
    except CannotDo:
        return None
    return canvas.viewport(), QRect(at - QPoint(RADIUS, RADIUS), at + QPoint(RADIUS, RADIUS))


def _drag(window: Window, points: list[Any]) -> None:
    """Drag from the first point to the last through the others; a single point is clicked."""
    view: Any = window.show_view("mechanism")
    wait_for(lambda: view.on_screen() and view.up_to_date, "the drawing")
    area = view.canvas.viewport()
    pixels = [_pixel(window, point) for point in points]
    _press(area, pixels[0])
    for start, end in pairwise(pixels):
        for part in (0.3, 0.7, 1.0):
            _mouse(area, QEvent.Type.MouseMove, QPointF(start + (end - start) * part), NONE, LEFT)
            settle()
    _release(area, pixels[-1])


# -- dialogs ------------------------------------------------------------------------------------------------


LAST_DIALOG = "last dialog"
"""Property of the window: title of the dialog that was opened last in this step."""


def note_dialog(window: Window, dialog: QWidget) -> None:
    """Note the title of a dialog that is open."""
    window.setProperty(LAST_DIALOG, dialog.windowTitle())


def _dialog(window: Window, steps: list[str]) -> None:
    """Choose an entry of a menu and press keys in the dialog that it opens, which then must be closed.

    Raises CannotDo where no dialog opens, or where it is still open after the keys.
    """
    path, *keys = steps
    outcome = [f"{path}: opens no dialog"]
    timer = QTimer(window, interval=POLL_MS)

    def act() -> None:
        dialog = QApplication.activeModalWidget()
        if dialog is None:
            return
        timer.stop()
        note_dialog(window, dialog)
        settle()
        _keys(window, keys)
        outcome[0] = ""
        if dialog.isVisible():
            outcome[0] = f"{path}: the dialog {dialog.windowTitle()} is still open after its keys"
            dialog.close()

    timer.timeout.connect(act)
    timer.start()
    _menu(window, path)
    timer.stop()
    window.activateWindow()  # else the keys of the next step have no widget with the focus
    settle()
    if outcome[0]:
        raise CannotDo(outcome[0])


ACTIONS: Mapping[str, TutorialAction] = MappingProxyType(
    {
        "menu": TutorialAction(_menu_region, lambda window, path: None, _menu),
        "field": TutorialAction(_field_region, lambda window, path: window.focus_field(path), _field),
        "drag": TutorialAction(_drag_region, lambda window, points: window.show_view("mechanism"), _drag),
        "dialog": TutorialAction(
            lambda window, steps: _menu_region(window, steps[0]), lambda window, steps: None, _dialog
        ),
        "keys": TutorialAction(lambda window, keys: None, lambda window, keys: None, _keys),
        "type": TutorialAction(
            lambda window, keys: None, lambda window, keys: None, _keys
        ),  # keys after another action
    }
)
"""Key of ``do`` -> its action."""


def play(window: Window, do: Mapping[str, Any]) -> None:
    """Play the actions of a step with mouse and keys. Raises CannotDo."""
    for key, value in do.items():
        ACTIONS[key].play(window, value)


def region_of(window: Window, do: Mapping[str, Any]) -> Region | None:
    """Return the first visible region of a step's actions; None where none is visible."""
    for key, value in do.items():
        with suppress(CannotDo):
            if (region := ACTIONS[key].region(window, value)) is not None:
                return region
    return None
