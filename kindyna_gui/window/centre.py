"""The middle of the window: pages behind tabs, the mechanism first, with the player's bar below them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QTabBar, QTabWidget, QVBoxLayout, QWidget

from kindyna_gui.documents.session import Session
from kindyna_gui.player import Player
from kindyna_gui.view import View
from kindyna_gui.window.docks import PLAYER_BAR, VIEWS


class TabPage(QWidget):
    """The place of a view behind a tab; the view is made when it first comes to the front."""

    def __init__(self, name: str, make: Callable[[str], View]) -> None:
        super().__init__()
        self.name, self._make = name, make
        self.view: View | None = None
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)

    def build(self) -> View:
        """The view, made now where it is not there yet."""
        if self.view is None:
            self.view = self._make(self.name)
            self._column.addWidget(self.view)
            self.setFocusProxy(self.view)
        return self.view


class CentralPages(QWidget):
    """Pages are made when they are first shown; all but the mechanism can be closed."""

    def __init__(self, session: Session, player: Player, make: Callable[[str], View]) -> None:
        super().__init__()
        self._make = make
        self._pages: dict[str, TabPage] = {}
        self.tabs = QTabWidget(documentMode=True, tabsClosable=True)
        self.tabs.setTabBarAutoHide(True)
        self.tabs.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # else Tab would end in its bar while that is hidden
        self.tabs.tabCloseRequested.connect(self.tabs.removeTab)
        self.tabs.currentChanged.connect(self._front_changed)
        self.bar = PLAYER_BAR(session, player)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self.tabs, 1)
        layout.addWidget(self.bar)

    def begin(self) -> None:
        """Show the first page, which stays."""
        self.show_page("mechanism")
        for side in (QTabBar.ButtonPosition.LeftSide, QTabBar.ButtonPosition.RightSide):
            self.tabs.tabBar().setTabButton(0, side, None)

    def page(self, name: str) -> View | None:
        """A page by its name in ``VIEWS``; None where it has not been seen yet."""
        page = self._pages.get(name)
        return page.view if page is not None else None

    def show_page(self, name: str) -> View:
        """Bring a page to the front, made now where it is not there yet."""
        page = self._add(name)
        view = page.build()  # before it is shown, so that it has its size at once
        self.tabs.setCurrentWidget(page)
        return view

    def _add(self, name: str) -> TabPage:
        page = self._pages.get(name)
        if page is None:
            page = self._pages[name] = TabPage(name, self._make)
        if self.tabs.indexOf(page) < 0:
            self.tabs.addTab(page, VIEWS[name].title)
        return page

    def _front_changed(self, index: int) -> None:
        page = self.tabs.widget(index)
        if isinstance(page, TabPage):
            page.build()

    @property
    def open_pages(self) -> tuple[tuple[str, ...], str]:
        """The names of the pages that are open, in their order, and of the one in front."""
        pages = [self.tabs.widget(index) for index in range(self.tabs.count())]
        front = self.tabs.currentWidget()
        names = tuple(page.name for page in pages if isinstance(page, TabPage))
        return names, front.name if isinstance(front, TabPage) else ""

    def lay(self, names: Sequence[str], front: str) -> None:
        """Open these pages and no others, this one in front; nothing else comes to the front on the way."""
        for name in names:
            self._add(name)
        page = self._pages.get(front)
        if page is not None and self.tabs.indexOf(page) >= 0:
            page.build()
            self.tabs.setCurrentWidget(page)
        for name, other in self._pages.items():
            if name not in names and name != "mechanism" and self.tabs.indexOf(other) >= 0:
                self.tabs.removeTab(self.tabs.indexOf(other))
        self.tabs.updateGeometry()  # at once: else the width that a page needed, which has gone, would widen the window
        column = self.layout()
        assert column is not None, "made with one"
        column.activate()

    @property
    def current(self) -> View | None:
        """The page in front."""
        page = self.tabs.currentWidget()
        return page.view if isinstance(page, TabPage) else None

    def views(self) -> Iterator[View]:
        """Every page there is, and the bar."""
        yield from (page.view for page in self._pages.values() if page.view is not None)
        yield self.bar


__all__ = ["CentralPages"]
