"""Parts of the window that are replaced: for another kind of design, another segment, another number of plots.

A part that is replaced is one widget, the content of a ``ContentArea``; no layout is emptied item by item. PySide keeps
a wrapper for each item of a layout that was filled and then added to another one. If the widgets of such a layout are
deleted one by one, Qt deletes the items, and the wrappers remain: the next object created at the same address is taken
for a layout item, and the process crashes. If the widget with the outer layout is deleted, the wrappers are deleted
with it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QActionGroup
from PySide6.QtWidgets import QApplication, QMenu, QVBoxLayout, QWidget

AGAIN_MS = 100  # interval of the checks whether a removed part can be deleted


def remove_part(part: QWidget, *sources: QObject) -> None:
    """Hide a part now, and delete it after the current events: one of its own signals may be the caller.

    Until then neither the part nor its children emit signals, or receive those of ``sources``: an editor that loses the
    focus would enter its text into a design that no longer has the field.
    """
    for child in (part, *part.findChildren(QObject)):
        child.blockSignals(True)
        for source in sources:
            source.disconnect(child)
    part.hide()
    delete_later(part)


def delete_later(part: QObject) -> None:
    """Delete an object after the current events, and not while a dialog or menu is open, which it may have opened."""
    if QApplication.activeModalWidget() is None and QApplication.activePopupWidget() is None:
        part.deleteLater()
        return
    again = QTimer(part, singleShot=True, interval=AGAIN_MS)
    again.timeout.connect(partial(delete_later, part))
    again.start()


def clear_menu(menu: QMenu) -> None:
    """Remove all entries of a menu, with their groups and submenus; a selected entry may be the caller."""
    removed = QObject(menu)
    for child in menu.children():
        if isinstance(child, QActionGroup | QMenu):
            child.deleteLater()
    for action in menu.actions():
        menu.removeAction(action)
        if action.parent() is menu:
            action.setParent(removed)
    delete_later(removed)


class ContentArea(QWidget):
    """Area with one content, which is replaced.

    sources: objects whose signals the contents receive; a removed content is disconnected from them.
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
        """The current content."""
        return self._content

    def replace(self, content: QWidget) -> None:
        """Replace the content by a widget that is laid out with its children."""
        before, self._content = self._content, content
        self._column.addWidget(content)
        if before is not None:
            remove_part(before, *self._sources)
        content.show()


def call_soon(owner: QObject, action: Callable[[], Any]) -> None:
    """Call a function in the next turn of the event loop, unless its owner has been deleted by then.

    ``QTimer.singleShot`` keeps its function for ever if the owner is deleted first, and with a method everything its
    object refers to. A timer of the owner is deleted with it.
    """
    timer = QTimer(owner, singleShot=True)
    timer.timeout.connect(action)
    timer.timeout.connect(timer.deleteLater)
    timer.start()


__all__ = ["ContentArea", "call_soon", "clear_menu", "delete_later", "remove_part"]
