"""The middle of the window: pages behind tabs, the mechanism first, with the player's bar below them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QTabBar, QTabWidget, QVBoxLayout, QWidget

from kindyna_gui.documents.session import Session
from kindyna_gui.view import View
from kindyna_gui.window.docks import PLAYER_BAR, VIEWS
from kindyna_gui.window.player import Player


class Centre(QWidget):
    """Pages are made when they are first shown; all but the mechanism can be closed."""

    def __init__(self, session: Session, player: Player, make: Callable[[str], View]) -> None:
        super().__init__()
        self._make = make
        self._pages: dict[str, View] = {}
        self.tabs = QTabWidget(documentMode=True, tabsClosable=True)
        self.tabs.setTabBarAutoHide(True)
        self.tabs.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # else Tab would end in its bar while that is hidden
        self.tabs.tabCloseRequested.connect(self.tabs.removeTab)
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
        return self._pages.get(name)

    def show_page(self, name: str) -> View:
        """Bring a page to the front, made now where it is not there yet."""
        view = self._pages.get(name)
        if view is None:
            view = self._pages[name] = self._make(name)
        if self.tabs.indexOf(view) < 0:
            self.tabs.addTab(view, VIEWS[name].title)
        self.tabs.setCurrentWidget(view)
        return view

    @property
    def current(self) -> View | None:
        """The page in front."""
        page = self.tabs.currentWidget()
        return page if isinstance(page, View) else None

    def views(self) -> Iterator[View]:
        """Every page there is, and the bar."""
        yield from self._pages.values()
        yield self.bar


__all__ = ["Centre"]
