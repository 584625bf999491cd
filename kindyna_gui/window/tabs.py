"""Tabs of docks and pages: where a bar has no room for all names they are shortened, then the last tabs are in a list.

Qt would cut the names, or move tabs behind arrows.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from PySide6.QtCore import QChildEvent, QEvent, QObject, Qt
from PySide6.QtWidgets import QMenu, QTabBar, QToolButton
from shiboken6 import isValid

from kindyna_gui.look import described
from kindyna_gui.rebuilt import add_entry, clear_menu, single_shot
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import VIEWS, Dock

RELAID = (QEvent.Type.Resize, QEvent.Type.Show, QEvent.Type.LayoutRequest, QEvent.Type.FontChange)
LIST_WIDTH = 76  # pixels of the button of the list


def fitting_tabs(widths: Sequence[int], room: int, front: int) -> list[int]:
    """Return the numbers of the tabs that have room: all, or the one in front and as many as leave room for the list."""
    if sum(widths) <= room:
        return list(range(len(widths)))
    shown, left = [front], room - LIST_WIDTH - widths[front]
    for number, width in enumerate(widths):
        if number == front:
            continue
        if width > left:
            break
        shown.append(number)
        left -= width
    return sorted(shown)


class TabList(QToolButton):
    """Button at the right end of a bar, with a menu of the tabs for which it has no room."""

    def __init__(self, bar: QTabBar) -> None:
        super().__init__(bar, popupMode=QToolButton.ToolButtonPopupMode.InstantPopup)
        described(self, tip="List the views whose tabs have no room")
        self.setObjectName("tab_list")
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.hide()
        self.bar, self._menu = bar, QMenu(self)
        self._menu.aboutToShow.connect(self._fill)
        self.setMenu(self._menu)

    def fitting_names(self, names: Sequence[str], short_names: Sequence[str]) -> list[str]:
        """Return the names, shortened where that saves most until all have room."""
        text_width, bar = self.bar.fontMetrics().horizontalAdvance, self.bar
        saved = [text_width(name) - text_width(short) for name, short in zip(names, short_names, strict=True)]
        more = [text_width(name) - text_width(bar.tabText(number)) for number, name in enumerate(names)]
        beyond, result = sum(self._widths) + sum(more) - bar.width(), list(names)
        for number in sorted(range(len(names)), key=lambda number: -saved[number]):
            if beyond <= 0:
                break
            beyond, result[number] = beyond - saved[number], short_names[number]
        return result

    @property
    def _widths(self) -> list[int]:
        return [self.bar.tabSizeHint(number).width() for number in range(self.bar.count())]

    def fit(self, names: Sequence[str]) -> None:
        """Show the tabs that have room, and this list for the others; ``names``: full names, which are the tips."""
        bar = self.bar
        shown = fitting_tabs(self._widths, bar.width(), bar.currentIndex())
        for number in sorted(
            range(bar.count()), key=lambda number: number not in shown
        ):  # the front one is never hidden
            bar.setTabToolTip(number, names[number])
            if bar.isTabVisible(number) != (number in shown):
                bar.setTabVisible(number, number in shown)
        hidden = bar.count() - len(shown)
        self.setVisible(hidden > 0)
        if hidden:
            self.setText(f"{hidden} more")
            self.setGeometry(bar.width() - LIST_WIDTH, 0, LIST_WIDTH, bar.height())

    def _fill(self) -> None:
        clear_menu(self._menu)
        for number in range(self.bar.count()):
            if not self.bar.isTabVisible(number):
                add_entry(self._menu, self.bar.tabToolTip(number), partial(self._show, number))

    def _show(self, number: int) -> None:
        self.bar.setTabVisible(number, True)
        self.bar.setCurrentIndex(number)


class WindowTabs(QObject):
    """Fits the tabs of the docks and pages of a window whenever they are laid out."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._pages = window, window.centre.tabs
        self._lists: list[TabList] = []  # of bars that Qt may delete
        self._soon = single_shot(self, self.fit)
        window.installEventFilter(self)
        self._pages.installEventFilter(self)
        self._of_pages = self._follow(self._pages.tabBar())

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if isinstance(event, QChildEvent):
            child = event.child()
            if event.type() == QEvent.Type.ChildPolished and isinstance(child, QTabBar):
                self._follow(child)
        elif event.type() in RELAID:
            self._soon.start()
        return super().eventFilter(watched, event)

    def _follow(self, bar: QTabBar) -> TabList:
        tabs = TabList(bar)
        self._lists.append(tabs)
        bar.currentChanged.connect(self._soon.start)
        bar.installEventFilter(self)
        self._soon.start()
        return tabs

    def fit(self) -> None:
        """Shorten names, and put tabs in a list, where a bar has no room for them."""
        by_text = {dock.windowTitle(): dock for dock in self._window.docks.values() if not dock.isHidden()}
        rows: dict[TabList, list[Dock]] = {}
        self._lists = [tabs for tabs in self._lists if isValid(tabs)]
        for tabs in self._lists:
            texts = [tabs.bar.tabText(number) for number in range(tabs.bar.count())]
            if tabs is not self._of_pages and tabs.bar.isVisible() and by_text.keys() >= set(texts):
                rows[tabs] = [by_text[text] for text in texts]
        names: dict[Dock, str] = {}
        for tabs, docks in rows.items():
            fitting = tabs.fitting_names([dock.title for dock in docks], [dock.short_title for dock in docks])
            names.update(zip(docks, fitting, strict=True))
        for dock in self._window.docks.values():
            if (name := names.get(dock, dock.title)) != dock.windowTitle():
                dock.setWindowTitle(name)
        for tabs, docks in rows.items():
            tabs.fit([dock.title for dock in docks])
        if self._of_pages.bar.isVisible():
            self._fit_pages(self._of_pages)

    def _fit_pages(self, tabs: TabList) -> None:
        bar, names = tabs.bar, self._window.centre.open_pages[0]
        titles = [VIEWS[name].title for name in names]
        for number, name in enumerate(tabs.fitting_names(titles, [VIEWS[name].short_title for name in names])):
            if name != bar.tabText(number):
                bar.setTabText(number, name)
        tabs.fit(titles)


__all__ = ["TabList", "WindowTabs", "fitting_tabs"]
