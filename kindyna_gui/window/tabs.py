"""Tabs of docks and pages: where a bar has no room for all names they are shortened, then the last tabs are in a list.

Qt would cut the names, or move tabs behind arrows.
"""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QChildEvent, QEvent, QObject
from PySide6.QtWidgets import QTabBar
from shiboken6 import isValid

from kindyna_gui.forms.tab_bars import TabList, fitting_tabs
from kindyna_gui.rebuilt import single_shot
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import VIEWS, Dock

RELAID = (QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.LayoutRequest, QEvent.Type.FontChange)


def widths_of(bar: QTabBar) -> list[int]:
    """Widths of the tabs with their present names, also of those in the list."""
    return [bar.tabSizeHint(number).width() for number in range(bar.count())]


def fitting_names(bar: QTabBar, names: Sequence[str], short_names: Sequence[str]) -> list[str]:
    """Return the names of the tabs, shortened where that saves most until all have room."""
    text_width = bar.fontMetrics().horizontalAdvance
    saved = [text_width(name) - text_width(short) for name, short in zip(names, short_names, strict=True)]
    more = (text_width(name) - text_width(bar.tabText(number)) for number, name in enumerate(names))
    beyond, result = sum(widths_of(bar)) + sum(more) - bar.width(), list(names)
    for number in sorted(range(len(names)), key=lambda number: -saved[number]):
        if beyond <= 0:
            break
        beyond, result[number] = beyond - saved[number], short_names[number]
    return result


class WindowTabs(QObject):
    """Fits the tabs of the docks and pages of a window whenever they are laid out."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._pages = window, window.centre.tabs
        self._lists: dict[QTabBar, TabList | None] = {}  # bars, which Qt may delete, and their lists where needed
        self._soon = single_shot(self, self.fit)
        window.installEventFilter(self)
        self._pages.installEventFilter(self)
        self._follow(self._pages.tabBar())

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        kind = event.type()
        if kind in RELAID:
            self._soon.start()
        elif kind == QEvent.Type.ChildPolished and isinstance(event, QChildEvent):
            child = event.child()
            if isinstance(child, QTabBar):
                self._follow(child)
        return super().eventFilter(watched, event)

    def _follow(self, bar: QTabBar) -> None:
        self._lists[bar] = None
        bar.currentChanged.connect(self._soon.start)
        bar.installEventFilter(self)
        self._soon.start()

    def fit(self) -> None:
        """Shorten names, and put tabs in a list, where a bar has no room for them."""
        self._lists = {bar: tabs for bar, tabs in self._lists.items() if isValid(bar)}
        by_text = {
            dock.windowTitle(): dock
            for dock in sorted(self._window.docks.values(), key=lambda dock: not dock.isHidden())
        }
        rows: dict[QTabBar, list[Dock]] = {}
        for bar in self._lists:
            texts = [bar.tabText(number) for number in range(bar.count())]
            is_shown = bar.geometry().right() > 0  # Qt keeps the bar of a single dock out of sight
            if texts and bar.parentWidget() is self._window and is_shown and by_text.keys() >= set(texts):
                rows[bar] = [by_text[text] for text in texts]
        self._hide_unused(rows)
        names: dict[Dock, str] = {}
        for bar, docks in rows.items():
            fitting = fitting_names(bar, [dock.title for dock in docks], [dock.short_title for dock in docks])
            names.update(zip(docks, fitting, strict=True))
        for dock in self._window.docks.values():
            if (name := names.get(dock, dock.title)) != dock.windowTitle():
                dock.setWindowTitle(name)
        for bar, docks in rows.items():
            self._show_fitting(bar, [dock.title for dock in docks])
        if self._pages.tabBar().isVisible():
            self._fit_pages(self._pages.tabBar())

    def _hide_unused(self, rows: dict[QTabBar, list[Dock]]) -> None:
        """Hide bars that Qt leaves where docks in tabs were before they were moved, until they belong to docks again."""

        def distance(bar: QTabBar) -> int:
            docks = rows[bar]
            return (
                docks[max(0, bar.currentIndex())].geometry().topLeft() - bar.geometry().bottomLeft()
            ).manhattanLength()

        used: set[Dock] = set()
        for bar in sorted(rows, key=distance):
            docks = set(rows[bar])
            tabbed = {
                dock for dock in (*self._window.tabifiedDockWidgets(rows[bar][0]), rows[bar][0]) if not dock.isHidden()
            }
            is_used = tabbed == docks and not docks & used
            bar.setVisible(is_used)
            if is_used:
                used |= docks
            else:
                del rows[bar]

    def _fit_pages(self, bar: QTabBar) -> None:
        names = self._window.centre.open_pages[0]
        titles = [VIEWS[name].title for name in names]
        for number, name in enumerate(fitting_names(bar, titles, [VIEWS[name].short_title for name in names])):
            if name != bar.tabText(number):
                bar.setTabText(number, name)
        self._show_fitting(bar, titles)

    def _show_fitting(self, bar: QTabBar, titles: Sequence[str]) -> None:
        """Show the tabs that have room, with their titles as tips, and the list of the others."""
        shown = fitting_tabs(widths_of(bar), bar.width(), bar.currentIndex())
        for number in sorted(range(bar.count()), key=lambda number: number not in shown):  # one is always shown
            if bar.tabToolTip(number) != titles[number]:
                bar.setTabToolTip(number, titles[number])
            if bar.isTabVisible(number) != (number in shown):
                bar.setTabVisible(number, number in shown)
        hidden = {number: titles[number] for number in range(bar.count()) if number not in shown}
        tabs = self._lists[bar]
        if hidden and tabs is None:
            tabs = self._lists[bar] = TabList(bar)
        if tabs is not None:
            tabs.list_tabs(hidden)


__all__ = ["WindowTabs"]
