"""The interface of the window that its parts use, the pages in its middle, and the titles of docks and entries."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Protocol

from PySide6.QtCore import QObject, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow, QMenu, QSizePolicy, QTabBar, QTabWidget, QVBoxLayout, QWidget

from core.design import Design
from core.study import names_of
from kindyna_gui.documents.session import Session
from kindyna_gui.export import Exports
from kindyna_gui.files.file_actions import Documents
from kindyna_gui.pictures.plots.quantities import title_for
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import fill, single_shot
from kindyna_gui.requirements import why_no_disk
from kindyna_gui.settings import Settings
from kindyna_gui.view import View
from kindyna_gui.window.docks import PLAYER_BAR, VIEWS, Dock, least_size
from kindyna_gui.window.status_line import PAUSE_MS, StatusLine

FRAME = 4  # pixels of a tab widget around its pages

# -- pages in the middle ---------------------------------------------------------------------------------


class TabPage(QWidget):
    """A page that makes its view when it first comes to the front."""

    def __init__(self, name: str, make: Callable[[str], View]) -> None:
        super().__init__()
        self.name, self._make = name, make
        self.view: View | None = None
        self._column = fill(QVBoxLayout(self), margins=0)

    def build(self) -> View:
        """Return the view, created at the first call."""
        if self.view is None:
            self.view = self._make(self.name)
            self._column.addWidget(self.view)
            self.setFocusProxy(self.view)
        return self.view


class CentralPages(QWidget):
    """Pages in tabs above the player bar; all but the mechanism can be closed."""

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
        fill(QVBoxLayout(self), (self.tabs, 1), self.bar, margins=0, spacing=0)

    def begin(self) -> None:
        """Show the mechanism, with the focus in it; its page has no button to close it."""
        self.show_page("mechanism").setFocus()
        for side in (QTabBar.ButtonPosition.LeftSide, QTabBar.ButtonPosition.RightSide):
            self.tabs.tabBar().setTabButton(0, side, None)

    def page(self, name: str) -> View | None:
        """Return the view of a page by its name in ``VIEWS``; None while it has not been created."""
        page = self._pages.get(name)
        return page.view if page is not None else None

    def show_page(self, name: str) -> View:
        """Bring a page to the front and return its view."""
        page = self._add(name)
        view = page.build()  # before it is shown, so that it has its size from the start
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
        front = self.tabs.widget(index)
        for page in self._pages.values():  # one behind others needs no room
            policy = QSizePolicy.Policy.Preferred if page is front else QSizePolicy.Policy.Ignored
            page.setSizePolicy(policy, policy)
        if isinstance(front, TabPage):
            front.build()

    def least_with(self, name: str) -> tuple[int, int]:
        """Least width and height with this page in front, above the player bar."""
        width, height = least_size(VIEWS[name].least, self.page(name))
        tabs = self.tabs.tabBar().sizeHint().height() if self.tabs.count() > 1 else 0
        return max(width + FRAME, self.bar.minimumWidth()), height + FRAME + tabs + self.bar.minimumHeight()

    @property
    def open_pages(self) -> tuple[tuple[str, ...], str]:
        """Names of the open pages, in their order, and of the page in front."""
        pages = [self.tabs.widget(index) for index in range(self.tabs.count())]
        front = self.tabs.currentWidget()
        names = tuple(page.name for page in pages if isinstance(page, TabPage))
        return names, front.name if isinstance(front, TabPage) else ""

    def set_pages(self, names: Sequence[str], front: str) -> None:
        """Open these pages and close all others, without showing any but the one in front."""
        for name in names:
            self._add(name)
        page = self._pages.get(front)
        if page is not None and self.tabs.indexOf(page) >= 0:
            page.build()
            self.tabs.setCurrentWidget(page)
        for name, page in self._pages.items():
            if name not in names and name != "mechanism" and self.tabs.indexOf(page) >= 0:
                self.tabs.removeTab(self.tabs.indexOf(page))
        self.tabs.updateGeometry()  # at once: else the width of a page just removed would widen the window
        column = self.layout()
        assert column is not None, "set in __init__"
        column.activate()

    @property
    def current(self) -> View | None:
        """View of the page in front."""
        page = self.tabs.currentWidget()
        return page.view if isinstance(page, TabPage) else None

    def views(self) -> Iterator[View]:
        """Yield the views of all pages, and the player bar."""
        yield from (page.view for page in self._pages.values() if page.view is not None)
        yield self.bar


# -- the window as its parts see it ----------------------------------------------------------------------


class DesignEdits(Protocol):
    """Edits chosen in menus; signal ``status_message`` says what was done, or why not."""

    status_message: Any

    def new_by_picture(self) -> None:
        """Begin with a mechanism chosen from images."""

    def new_valve_train(self) -> None:
        """Begin with the inlet and exhaust valve of a cam card."""

    def change(self, make: Callable[[], Design], text: str) -> None:
        """Replace the design in one undo step; if it cannot be built or is refused, the status line shows why."""

    def lay_out(self, make: Callable[[], Design], text: str) -> None:
        """Replace the typed design in one undo step; the new one may be incomplete."""


class LoadEdits(Protocol):
    """Edits of the loads' rows."""

    def add(self, name: str) -> None:
        """Add a row to one of the lists of the loads."""


class Window(QMainWindow):
    """One session and one player, their views, and the slots of the menus."""

    session: Session
    player: Player
    settings: Settings
    documents: Documents
    exports: Exports
    designing: DesignEdits
    status: StatusLine
    centre: CentralPages
    docks: dict[str, Dock]
    actions_by_key: dict[str, QAction]

    @property
    def loads(self) -> LoadEdits:
        """Edits of the loads' rows."""
        raise NotImplementedError

    def view(self, name: str) -> View | None:
        """Return a view by its name in ``VIEWS``; None while it has not been created."""
        dock = self.docks.get(name)
        return dock.view if dock is not None else self.centre.page(name)

    def drawing(self, in_front: bool = False) -> Any:
        """Return the drawing of the mechanism, and bring it to the front."""
        return self.show_view("mechanism") if in_front else self.view("mechanism")

    def close_view(self, name: str) -> None:
        """Close the dock of a view."""
        self.docks[name].close()

    def show_task(self, name: str) -> None:
        """Show one of ``TASKS`` in the layout last used."""
        raise NotImplementedError

    def stages_on_screen(self) -> tuple[str, ...]:
        """Return the stages that views on screen read."""
        raise NotImplementedError

    def show_view(self, name: str) -> View:
        """Bring a view to the front and return it."""
        raise NotImplementedError

    def focus_field(self, path: str) -> None:
        """Show and focus the field of a path, or the fields of a section."""
        raise NotImplementedError

    def draw(self, on: bool, tool: str = "choose") -> None:
        """Switch drawing with the mouse on or off."""
        raise NotImplementedError

    def export_picture(self, name: str) -> None:
        """Ask for a file and save the picture of a view in it."""
        raise NotImplementedError

    def save_layout(self) -> None:
        """Ask for a name and save the current layout under it."""
        raise NotImplementedError

    def restore_layout(self, name: str) -> None:
        """Restore a saved layout."""
        raise NotImplementedError

    def delete_layout(self, name: str) -> None:
        """Delete a saved layout."""
        raise NotImplementedError

    def begin_tutorial(self, name: str) -> None:
        """Begin a tutorial in this window."""
        raise NotImplementedError

    def show_help(self, name: str, words: str = "") -> None:
        """Show a page of the help, scrolled to these words."""
        raise NotImplementedError


# -- titles ----------------------------------------------------------------------------------------------


def title_of(name: str, design: Design) -> str:
    """Return the title of a view of ``VIEWS`` for a design."""
    row = VIEWS[name]
    return title_for(design, row.quantities[0], row.title) if row.quantities else row.title


def why_absent(name: str, design: Design) -> str:
    """Return why a view of ``VIEWS`` is empty for a design; empty text where it is not."""
    row = VIEWS[name]
    return "" if not row.of_cam or (row.quantities and design.drive.has_surface) else why_no_disk(design)


class Titles(QObject):
    """Keeps the titles of window, docks, menus and undo actions up to date."""

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._session = window, window.session
        self._named: tuple[object, ...] = ()  # what the titles of the docks depend on
        self._entries: dict[str, tuple[str, str]] = {}  # text and tip of menu entries as in MENUS
        self._soon = single_shot(self, self._show_or_hide)
        self._session.file_changed.connect(self.name_window)
        self._session.design_changed.connect(self.name_docks)
        self._session.drag_ended.connect(self.name_steps)
        self._session.drag_ended.connect(self.name_window)
        self._pause = single_shot(self, self.name_steps, PAUSE_MS)
        for menu in self._window.actions_by_key["undo"].associatedObjects():
            if isinstance(menu, QMenu):
                menu.aboutToShow.connect(self.name_steps)
        self.name_window()
        self.name_docks()
        self.steps_changed()
        self.name_steps()

    def name_window(self) -> None:
        """Show the name of the file, and whether it is saved, in the title of the window."""
        self._window.setWindowTitle(f"{self._window.documents.name}[*] \u2013 KINDYNA")
        self._window.setWindowModified(self._session.modified)
        self._window.setWindowFilePath(str(self._session.path or ""))

    def name_docks(self) -> None:
        """Update titles of docks and pages to the design's names of quantities."""
        if self._session.drag_source:  # a drag with the mouse never changes the kind of design
            return
        design = self._session.design
        kind = names_of(design), design.drive.cam is None, self._session.study.angle_name
        if kind == self._named:
            return
        self._named = kind
        for name, dock in self._window.docks.items():
            title = title_of(name, design)
            if title != dock.title:
                dock.title = title
                dock.setWindowTitle(title)  # shortened once the tabs are laid out
            self._name_entry(name, title)

    def _name_entry(self, name: str, title: str) -> None:
        """Give a menu entry the title of its view; disable it, with the reason, where the view is empty."""
        action = self._window.actions_by_key.get(f"show_view:{name}")
        if action is None:
            return
        text, tip = self._entries.setdefault(name, (action.text(), action.statusTip()))
        why, is_default = why_absent(name, self._session.design), title == VIEWS[name].title
        action.setText(text if is_default else title)
        action.setStatusTip(
            why
            or (
                tip
                if is_default
                else f"Plot the {title[:1].lower()}{title[1:]} over the {self._session.study.angle_name}"
            )
        )
        action.setToolTip(action.statusTip())
        action.setEnabled(not why)

    def steps_changed(self) -> None:
        """Enable Undo and Redo now, and name their steps once editing pauses.

        Each text would lay out the toolbar and paint the window.
        """
        stack = self._session.stack
        for key, able in (("undo", stack.canUndo()), ("redo", stack.canRedo())):
            self._window.actions_by_key[key].setEnabled(able)
        if self._session.drag_source is None:
            self._pause.start()

    def name_steps(self) -> None:
        """Name the steps that Undo and Redo would change in their entries."""
        self._pause.stop()
        stack = self._session.stack
        for key, text in (("undo", stack.undoText()), ("redo", stack.redoText())):
            action, word = self._window.actions_by_key[key], key.capitalize()
            action.setText(f"&{word} {text}".rstrip().replace(" &", " &&"))
            action.setToolTip(f"{word} {text}".rstrip())

    def docks_moved(self) -> None:
        """Update which docks show a title, once they are laid out: a dock in tabs needs none."""
        self._soon.start()

    def _show_or_hide(self) -> None:
        for dock in self._window.docks.values():
            others = [d for d in self._window.tabifiedDockWidgets(dock) if not d.isHidden()]
            dock.show_title(dock.isFloating() or not others)
