"""Studies to begin with: those that are ready for the design at hand, examples, files."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QMenu, QPushButton

from core.design import Design
from core.process import resources
from core.varying import READY, ready_study
from kindyna_gui import dialogs
from kindyna_gui.rebuilt import clear_menu


def example_studies() -> list[tuple[str, Path]]:
    """Those that come with the program: what the first line of each says, and its file."""
    files = sorted((resources() / "studies").glob("*.toml"))
    return [(path.read_text("utf-8").partition("\n")[0].removeprefix("# ").removesuffix("."), path) for path in files]


class StudyMenu(QPushButton):
    """ready (StudyFile): of the design at hand; opened (Path): the file of a study.

    of   the whole design at hand, and the number of its drive that is shown
    """

    ready = Signal(object)
    opened = Signal(object)

    def __init__(self, of: Callable[[], tuple[Design, int]]) -> None:
        super().__init__("Open a study")
        self._of = of
        self.setAutoDefault(False)
        menu = QMenu(self)
        menu.aboutToShow.connect(self._fill)
        menu.setToolTipsVisible(True)
        self.setMenu(menu)

    def _fill(self) -> None:
        menu = self.menu()
        clear_menu(menu)
        design, drive = self._of()
        menu.addSection("For this design")
        for name, row in READY.items():
            file = ready_study(design, name, min(drive, len(design.drives) - 1))
            action = menu.addAction(row.title, partial(self.ready.emit, file))
            action.setEnabled(file is not None)
        menu.addSection("Examples")
        for text, path in example_studies():
            menu.addAction(text, partial(self.opened.emit, path))
        menu.addSeparator()
        menu.addAction("From a file …", self._ask)

    def _ask(self) -> None:
        path = dialogs.file_to_open(self, "Open a study", "Studies (*.toml)")
        if path is not None:
            self.opened.emit(path)


__all__ = ["StudyMenu", "example_studies"]
