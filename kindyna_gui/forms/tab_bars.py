"""Tabs that all can be read: narrower where they have little room, and the last ones in a list.

Qt would cut the names, or move tabs behind arrows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QEvent, QSize, Qt
from PySide6.QtGui import QIcon, QPaintEvent, QPixmap, QResizeEvent
from PySide6.QtWidgets import (
    QMenu,
    QStyle,
    QStyleOptionTab,
    QStyleOptionTabBarBase,
    QStylePainter,
    QTabBar,
    QTabWidget,
    QToolButton,
    QWidget,
)

from kindyna_gui.look import described
from kindyna_gui.rebuilt import add_entry, clear_menu

LIST_WIDTH = 76  # pixels of the button of the list
MOST_NARROWER = 14  # pixels by which a tab can be narrower than Qt draws it; its text has about 24 more than it needs


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
    """Button at the right end of a bar, with a menu of the tabs for which it has no room.

    ``parent`` is the widget whose top right corner has the button, where that is not the bar.
    """

    def __init__(self, bar: QTabBar, parent: QWidget | None = None) -> None:
        self._corner = parent or bar
        super().__init__(self._corner, popupMode=QToolButton.ToolButtonPopupMode.InstantPopup)
        described(self, tip="List the tabs that have no room")
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._bar, self._menu = bar, QMenu(self)
        self._names: Mapping[int, str] = MappingProxyType({})
        self._menu.aboutToShow.connect(self._fill)
        self.setMenu(self._menu)

    def list_tabs(self, names: Mapping[int, str]) -> None:
        """List these tabs by their full names; without one the button is hidden."""
        self._names = names
        self.setVisible(bool(names))
        self.setText(f"{len(names)} more")
        self.setGeometry(self._corner.width() - LIST_WIDTH, 0, LIST_WIDTH, self._bar.height())

    def _fill(self) -> None:
        clear_menu(self._menu)
        for number, name in self._names.items():
            add_entry(self._menu, name, partial(self._show_tab, number)).setIcon(self._bar.tabIcon(number))

    def _show_tab(self, number: int) -> None:
        self._bar.setTabVisible(number, True)
        self._bar.setCurrentIndex(number)


class _NarrowingBar(QTabBar):
    """Bar whose tabs are ``narrower`` than Qt makes them [pixels]."""

    narrower = 0

    def tabSizeHint(self, index: int) -> QSize:
        size = super().tabSizeHint(index)
        return QSize(size.width() - self.narrower, size.height())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the names in as much room as Qt would give them; it would cut them where the tab is narrower."""
        if not self.narrower:
            super().paintEvent(event)
            return
        painter, base, current = QStylePainter(self), QStyleOptionTabBarBase(), self.currentIndex()
        base.initFrom(self)
        base.documentMode, base.shape = self.documentMode(), self.shape()
        base.tabBarRect, base.selectedTabRect = self.rect(), self.tabRect(current)
        if self.drawBase():
            painter.drawPrimitive(QStyle.PrimitiveElement.PE_FrameTabBarBase, base)
        numbers = [number for number in range(self.count()) if self.isTabVisible(number)]
        for number in sorted(numbers, key=lambda number: number == current):  # the one in front last
            tab, room = QStyleOptionTab(), self.narrower
            self.initStyleOption(tab, number)
            painter.drawControl(QStyle.ControlElement.CE_TabBarTabShape, tab)
            tab.rect = tab.rect.adjusted(-(room // 2), 0, room - room // 2, 0)
            painter.drawControl(QStyle.ControlElement.CE_TabBarTabLabel, tab)
        painter.end()

    def narrow(self, by: int) -> None:
        """Lay out the tabs with another width."""
        if by != self.narrower:
            self.narrower = by
            self.setIconSize(self.iconSize())  # Qt lays out the bar again


class FittingTabs(QTabWidget):
    """Pages whose tabs fit in the width; a page can be absent."""

    def __init__(self) -> None:
        super().__init__(documentMode=True)
        self._bar = _NarrowingBar()
        self.setTabBar(self._bar)
        self._list: TabList | None = None
        self._absent: set[int] = set()
        self.currentChanged.connect(self.fit)

    def is_present(self, index: int) -> bool:
        """Whether a page can be shown; its tab may be in the list."""
        return index not in self._absent

    def set_present(self, index: int, on: bool) -> None:
        """Show or hide a page with its tab."""
        if on != self.is_present(index):  # Qt lays out the window again even where nothing changes
            (self._absent.discard if on else self._absent.add)(index)
            self.setTabVisible(index, on)
            self.fit()

    def fit(self, *_: object) -> None:
        """Make the tabs narrower, and put the last ones in the list, where the bar has no room for all."""
        bar, present = self._bar, [number for number in range(self.count()) if self.is_present(number)]
        if not present or self.width() < LIST_WIDTH:
            return
        full = [bar.tabSizeHint(number).width() + bar.narrower for number in present]
        needed = -(-(sum(full) - self.width()) // len(present))
        narrower = min(max(needed, 0), MOST_NARROWER)
        bar.narrow(narrower)
        front = present.index(self.currentIndex()) if self.currentIndex() in present else 0
        shown = {present[i] for i in fitting_tabs([width - narrower for width in full], self.width(), front)}
        for number in present:
            if self.isTabVisible(number) != (number in shown):
                self.setTabVisible(number, number in shown)
        hidden = {number: self.tabText(number) for number in present if number not in shown}
        if hidden and self._list is None:
            self._list = TabList(bar, self)
        if self._list is not None:
            self._list.list_tabs(hidden)

    # -- Qt's own, for pages whose tab is in the list -----------------------------------------------------

    def setCurrentIndex(self, index: int) -> None:
        """Show a page, also one whose tab is in the list."""
        if self.is_present(index):
            self.setTabVisible(index, True)
        super().setCurrentIndex(index)

    def setCurrentWidget(self, page: QWidget) -> None:
        """Show a page, also one whose tab is in the list."""
        self.setCurrentIndex(self.indexOf(page))

    def setTabIcon(self, index: int, icon: QIcon | QPixmap) -> None:
        """Set the sign of a tab, which makes it wider."""
        super().setTabIcon(index, icon)
        self.fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.fit()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self.fit()


__all__ = ["LIST_WIDTH", "FittingTabs", "TabList", "fitting_tabs"]
