"""Layouts of the window, the parts that are replaced, what of a widget can be seen, and calls after a pause.

Parts are replaced for another kind of design, another segment, another number of plots.

A part that is replaced is one widget, the content of a ``ContentArea``; no layout is emptied item by item. PySide keeps
a wrapper for each item of a layout that was filled and then added to another one. If the widgets of such a layout are
deleted one by one, Qt deletes the items, and the wrappers remain: the next object created at the same address is taken
for a layout item, and the process crashes. If the widget with the outer layout is deleted, the wrappers are deleted
with it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtGui import QAction, QActionGroup, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QFormLayout,
    QLayout,
    QMenu,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

AGAIN_MS = 100  # interval of the checks whether a removed part can be deleted
STRETCH = None
"""Part of a layout that takes the remaining room."""

Part = QWidget | QLayout | tuple[str | QWidget | QLayout | int | Qt.AlignmentFlag, ...] | int | None
Filled = TypeVar("Filled", bound=QLayout)


def fill(
    layout: Filled,
    *parts: Part,
    margins: int | tuple[int, int, int, int] | None = None,
    spacing: int | tuple[int, int] | None = None,
) -> Filled:
    """Add parts to a layout, and return it.

    A part of a row or column is a widget or layout, alone or with its stretch and alignment, a space in pixels, or
    ``STRETCH``; a part of a form is a widget or layout, alone or after its label. Two spacings, between columns and
    between rows, are those of a grid.
    """
    if margins is not None:
        layout.setContentsMargins(*((margins,) * 4 if isinstance(margins, int) else margins))
    target: Any = layout
    if isinstance(spacing, tuple):
        target.setHorizontalSpacing(spacing[0])
        target.setVerticalSpacing(spacing[1])
    elif spacing is not None:
        target.setSpacing(spacing)
    for part in parts:
        item = part if isinstance(part, tuple) else (part,)
        if isinstance(layout, QFormLayout):
            target.addRow(*item)
        elif part is STRETCH:
            target.addStretch(1)
        elif isinstance(part, int):
            target.addSpacing(part)
        elif isinstance(item[0], QLayout):
            target.addLayout(*item)
        else:
            target.addWidget(*item)
    return layout


def widget_with(layout: QLayout) -> QWidget:
    """Return a new widget with this layout."""
    widget = QWidget()
    widget.setLayout(layout)
    return widget


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
    single_shot(part, partial(delete_later, part), AGAIN_MS).start()


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


def add_entry(
    menu: QMenu,
    text: str,
    action: Callable[[], object],
    tip: str = "",
    *,
    enabled: bool = True,
    checked: bool | None = None,
) -> QAction:
    """Add an entry to a menu, which calls a function without arguments; None for ``checked``: it cannot be checked."""
    entry = menu.addAction(text)
    entry.setStatusTip(tip)
    entry.setEnabled(enabled)
    entry.setCheckable(checked is not None)
    entry.setChecked(bool(checked))
    entry.triggered.connect(lambda: action())
    return entry


class ContentArea(QWidget):
    """Area with one content, which is replaced.

    sources: objects whose signals the contents receive; a removed content is disconnected from them.
    """

    def __init__(self, *sources: QObject) -> None:
        super().__init__()
        self._sources = sources
        self.content: QWidget | None = None
        self._column = fill(QVBoxLayout(self), margins=0, spacing=0)

    def replace(self, content: QWidget) -> None:
        """Replace the content by a widget that is laid out with its children."""
        before, self.content = self.content, content
        self._column.addWidget(content)
        if before is not None:
            remove_part(before, *self._sources)
        content.show()


def connect_all(*rows: tuple[Any, Any]) -> None:
    """Connect each signal to the function, or the other signal, of its row."""
    for signal, slot in rows:
        signal.connect(slot)


def close_by_escape(window: QWidget) -> None:
    """Let Escape close a window that asks nothing."""
    QShortcut(QKeySequence(Qt.Key.Key_Escape), window).activated.connect(window.close)


def single_shot(owner: QObject, action: Callable[[], Any], interval: int = 0) -> QTimer:
    """Timer that calls a function once, ``interval`` milliseconds after it was last started."""
    timer = QTimer(owner, singleShot=True, interval=interval)
    timer.timeout.connect(action)
    return timer


def call_soon(owner: QObject, action: Callable[[], Any]) -> None:
    """Call a function in the next turn of the event loop, unless its owner has been deleted by then.

    ``QTimer.singleShot`` keeps its function for ever if the owner is deleted first, and with a method everything its
    object refers to. A timer of the owner is deleted with it.
    """
    timer = single_shot(owner, action)
    timer.timeout.connect(timer.deleteLater)
    timer.start()


__all__ = [
    "STRETCH",
    "ContentArea",
    "Part",
    "add_entry",
    "call_soon",
    "clear_menu",
    "connect_all",
    "delete_later",
    "fill",
    "remove_part",
    "single_shot",
    "widget_with",
]


# -- visibility ------------------------------------------------------------------------------------------


def is_in_sight(widget: QWidget) -> bool:
    """Whether something of a widget can be seen.

    isVisible() is True also for a dock tabbed behind another, which Qt places beyond the edge of its window.
    visibleRegion() leaves out what the widget's own opaque children cover.
    """
    if not widget.isVisible():
        return False
    rect, at = widget.rect(), widget
    while not rect.isEmpty() and not at.isWindow():
        within = at.parentWidget()
        assert within is not None
        rect, at = rect.translated(at.pos()) & within.rect(), within
    return not rect.isEmpty()


def scroll_to(widget: QWidget | None) -> None:
    """Scroll a widget into sight in every scroll area around it.

    Qt does this itself only where the focus comes from a widget of the same scroll area.
    """
    around = None if widget is None or widget.isWindow() else widget.parentWidget()
    while widget is not None and around is not None and not around.isWindow():
        if isinstance(around, QScrollArea):
            around.ensureWidgetVisible(widget)
        elif isinstance(around, QAbstractItemView):
            around.scrollTo(around.indexAt(widget.mapTo(around.viewport(), widget.rect().center())))
        around = around.parentWidget()
