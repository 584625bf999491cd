"""What the parts of the window may ask of it. They are written against this; ``MainWindow`` is put together from them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMainWindow

from core.design import Design
from kindyna_gui.documents.session import Session
from kindyna_gui.export.exports import Exports
from kindyna_gui.files.file_actions import Documents
from kindyna_gui.player import Player
from kindyna_gui.settings import Settings
from kindyna_gui.view import View
from kindyna_gui.window.centre import CentralPages
from kindyna_gui.window.dock_sizes import DockShares
from kindyna_gui.window.docks import Dock
from kindyna_gui.window.status_line import StatusLine


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


__all__ = ["DesignEdits", "LoadEdits", "Window"]
