"""Parts of the window that are made anew: for another kind of design, another segment, another number of plots.

What is made anew stands in one widget, its content, which is replaced whole; no layout is emptied by hand. PySide keeps a
wrapper for each item of a layout that was filled and then added to another one. Where the widgets of such a layout go one by
one, Qt deletes the items and the wrappers stay behind: whatever is created at the same address next is taken for a layout
item, and the process dies. Where the widget goes that has the outer layout, they go with it. So does what a part still has to do
once the events at hand are done (``soon``).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QActionGroup
from PySide6.QtWidgets import QApplication, QMenu, QVBoxLayout, QWidget

AGAIN_MS = 100  # between two looks whether what has gone can be deleted


def take_away(part: QWidget, *sources: QObject) -> None:
    """Hide a part now, and delete it when the events at hand are done: one of its own signals may have led here.

    Until then neither it nor what it holds emits a signal, or is called by one of ``sources``: focus that leaves an editor
    would enter its text into a design that no longer has the field.
    """
    for each in (part, *part.findChildren(QObject)):
        each.blockSignals(True)
        for source in sources:
            source.disconnect(each)
    part.hide()
    let_go(part)


def let_go(part: QObject) -> None:
    """Delete it when the events at hand are done, and no dialog or menu is open: one of its own events may have opened that, and goes on
    behind it."""
    if QApplication.activeModalWidget() is None and QApplication.activePopupWidget() is None:
        part.deleteLater()
        return
    again = QTimer(part, singleShot=True, interval=AGAIN_MS)
    again.timeout.connect(partial(let_go, part))
    again.start()


def clear_menu(menu: QMenu) -> None:
    """Take all entries out of a menu, with the groups and menus that were made for them: one that has been chosen may have led here."""
    gone = QObject(menu)
    for child in menu.children():
        if isinstance(child, QActionGroup | QMenu):
            child.deleteLater()
    for action in menu.actions():
        menu.removeAction(action)
        if action.parent() is menu:
            action.setParent(gone)
    let_go(gone)


class Rebuilt(QWidget):
    """The place of a content that is replaced whole.

    sources: objects whose signals the contents are connected to, which a content that is removed must not react to any longer.
    """

    def __init__(self, *sources: QObject) -> None:
        super().__init__()
        self._sources = sources
        self._content: QWidget | None = None
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(0)

    @property
    def content(self) -> QWidget | None:
        """What stands here now."""
        return self._content

    def replace(self, content: QWidget) -> None:
        """Put a content, laid out with its own children, in place of the one before."""
        before, self._content = self._content, content
        self._column.addWidget(content)
        if before is not None:
            take_away(before, *self._sources)
        content.show()


def soon(owner: QObject, deed: Callable[[], Any]) -> None:
    """Do it when the event loop comes round again, unless its owner has gone by then.

    ``QTimer.singleShot`` keeps what it is to call for ever where the owner goes first, and with a method all that its object reaches:
    a timer of the owner goes with it.
    """
    timer = QTimer(owner, singleShot=True)
    timer.timeout.connect(deed)
    timer.timeout.connect(timer.deleteLater)
    timer.start()


__all__ = ["Rebuilt", "clear_menu", "let_go", "soon", "take_away"]
