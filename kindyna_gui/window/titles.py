"""Titles: of the window its file, of each dock what it shows, of Undo and Redo their steps."""

from __future__ import annotations

from PySide6.QtCore import QObject, QTimer

from core.design import Design
from kindyna_gui.pictures.plots.quantities import title_for
from kindyna_gui.requirements import NO_CAM
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import VIEWS


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
        if self._session.held:  # by the mouse nothing becomes another kind of design
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


__all__ = ["Titles", "title_of"]
