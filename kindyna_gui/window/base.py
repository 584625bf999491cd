"""What its parts may ask of it; titles."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol

from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QTabBar, QTabWidget, QVBoxLayout, QWidget

from core.design import Design
from kindyna_gui.documents.session import Session
from kindyna_gui.export import Exports
from kindyna_gui.files.file_actions import Documents
from kindyna_gui.pictures.plots.quantities import title_for
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_CAM
from kindyna_gui.settings import Settings
from kindyna_gui.view import View
from kindyna_gui.window.docks import PLAYER_BAR, VIEWS, Dock, DockShares
from kindyna_gui.window.status_line import StatusLine

# -- centre ----------------------------------------------------------------------------------------------


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


# -- base ------------------------------------------------------------------------------------------------


class DesignEdits(Protocol):
    """Edits that begin in a menu; status_message: what has been done, or why not."""

    status_message: Any

    def new_by_picture(self) -> None:
        """Begin with a mechanism chosen by its picture."""

    def change(self, make: Callable[[], Design], text: str) -> None:
        """Another design in one step; where it cannot be made or is refused, the status line shows why."""

    def lay_out(self, make: Callable[[], Design], text: str) -> None:
        """The same, made from what is typed; it need not fit together."""


class LoadEdits(Protocol):
    """Rows of the loads, asked for in the drawing."""

    def add(self, name: str) -> None:
        """A row more in one of the lists of the loads."""


class Window(QMainWindow):
    """One session and one player, the views of them, and what menus do with them."""

    session: Session
    player: Player
    settings: Settings
    documents: Documents
    exports: Exports
    designing: DesignEdits
    status: StatusLine
    centre: CentralPages
    docks: dict[str, Dock]
    shares: DockShares
    actions_by_key: dict[str, QAction]

    @property
    def loads(self) -> LoadEdits:
        """What adds rows to the loads."""
        raise NotImplementedError

    def view(self, name: str) -> View | None:
        """A view by its name in ``VIEWS``; None where it has not been seen yet."""
        raise NotImplementedError

    def show_task(self, name: str) -> None:
        """Show one of ``TASKS`` as it was left."""
        raise NotImplementedError

    def stages_on_screen(self) -> tuple[str, ...]:
        """The stages that views on screen read."""
        raise NotImplementedError

    def show_view(self, name: str) -> View:
        """Bring a view to the front, made now where it is not there yet."""
        raise NotImplementedError

    def focus_field(self, path: str) -> None:
        """Bring the field of a path, or of a section, before the reader."""
        raise NotImplementedError

    def draw(self, on: bool, tool: str = "choose") -> None:
        """Begin to draw the linkage with the mouse, or leave it."""
        raise NotImplementedError

    def export_picture(self, name: str) -> None:
        """Ask for a file and write the picture of a view there."""
        raise NotImplementedError

    def keep_layout(self) -> None:
        """Ask for a name, and keep the layout at hand under it."""
        raise NotImplementedError

    def take_layout(self, name: str) -> None:
        """A layout that was kept under a name."""
        raise NotImplementedError

    def forget_layout(self, name: str) -> None:
        """Do without a layout that was kept under a name."""
        raise NotImplementedError

    def begin_tutorial(self, name: str) -> None:
        """A lesson at this window, step by step."""
        raise NotImplementedError

    def show_help(self, name: str, words: str = "") -> None:
        """A page of the help, at these words."""
        raise NotImplementedError


# -- titles ----------------------------------------------------------------------------------------------


def title_of(name: str, design: Design) -> str:
    """What a view of ``VIEWS`` is called while this design is in place."""
    row = VIEWS[name]
    return title_for(design, row.quantities[0], row.title) if row.quantities else row.title


def why_absent(name: str, design: Design) -> str:
    """Why this design has nothing for a view of ``VIEWS``; empty where it has."""
    return NO_CAM if VIEWS[name].of_cam and design.drive.cam is None else ""


class Titles(QObject):
    """Keeps the titles of window, docks, menus and undo actions up to date."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._session = window, window.session
        self._entries: dict[str, tuple[str, str]] = {}  # of the menus: text and tip of a design with a cam
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._soon.timeout.connect(self._show_or_hide)
        self._session.file_changed.connect(self.name_window)
        self._session.design_changed.connect(self.name_docks)
        self.name_window()
        self.name_docks()
        self.name_steps()

    def name_window(self) -> None:
        """The file, and whether it is saved, in the title of the window."""
        self._window.setWindowTitle(f"{self._window.documents.name}[*] \u2013 KINDYNA")
        self._window.setWindowModified(self._session.modified)
        self._window.setWindowFilePath(str(self._session.path or ""))

    def name_docks(self) -> None:
        """Titles of docks and pages as the design calls their quantities."""
        if self._session.drag_source:  # by the mouse nothing becomes another kind of design
            return
        for name, dock in self._window.docks.items():
            title = title_of(name, self._session.design)
            if title != dock.windowTitle():
                dock.setWindowTitle(title)
            self._name_entry(name, title)

    def _name_entry(self, name: str, title: str) -> None:
        """The entry of a menu is called as what it shows now, and greyed where that is nothing, with the reason."""
        action = self._window.actions_by_key.get(f"show_view:{name}")
        if action is None:
            return
        usual, tip = self._entries.setdefault(name, (action.text(), action.statusTip()))
        why, own = why_absent(name, self._session.design), title == VIEWS[name].title
        action.setText(usual if own else title)
        action.setStatusTip(why or (tip if own else f"{title} over the {self._session.study.angle_name}"))
        action.setToolTip(action.statusTip())
        action.setEnabled(not why)

    def name_steps(self) -> None:
        """What Undo and Redo would take back, in their entries."""
        stack = self._session.stack
        for key, able, text in (
            ("undo", stack.canUndo(), stack.undoText()),
            ("redo", stack.canRedo(), stack.redoText()),
        ):
            action, word = self._window.actions_by_key[key], key.capitalize()
            action.setEnabled(able)
            action.setText(f"&{word} {text}".rstrip().replace(" &", " &&"))
            action.setToolTip(f"{word} {text}".rstrip())

    def docks_moved(self) -> None:
        """Docks with tabs need no title of their own; which have is known once they are laid out."""
        self._soon.start()

    def _show_or_hide(self) -> None:
        for dock in self._window.docks.values():
            others = [d for d in self._window.tabifiedDockWidgets(dock) if not d.isHidden()]
            dock.show_title(dock.isFloating() or not others)
