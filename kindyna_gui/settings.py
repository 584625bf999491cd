"""What the window remembers from one run to the next: its layout, recent files, the last folder."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QByteArray, QSettings
from PySide6.QtWidgets import QMainWindow

LAYOUT = 2
"""Raised whenever docks come, go or change their place: an older layout is then forgotten."""

MOST_RECENT = 8


class Settings:
    """A thin layer over QSettings."""

    def __init__(self) -> None:
        self._kept = QSettings("KINDYNA", "KINDYNA")

    def save_layout(self, window: QMainWindow) -> None:
        self._kept.setValue("window/geometry", window.saveGeometry())
        self._kept.setValue("window/state", window.saveState(LAYOUT))
        self._kept.sync()

    def restore_layout(self, window: QMainWindow) -> bool:
        """False where nothing of this version was kept; then nothing changes."""
        geometry, state = self._kept.value("window/geometry"), self._kept.value("window/state")
        if not isinstance(geometry, QByteArray) or not isinstance(state, QByteArray):
            return False
        return window.restoreGeometry(geometry) and window.restoreState(state, LAYOUT)

    @property
    def recent(self) -> list[Path]:
        """Files opened or saved, the latest first."""
        kept = self._kept.value("files/recent", [])
        names = [kept] if isinstance(kept, str) else kept if isinstance(kept, list) else []
        return [Path(name) for name in names if isinstance(name, str) and name]

    def add_recent(self, path: Path) -> None:
        path = path.absolute()
        self._set_recent([path, *(p for p in self.recent if p != path)])
        self._kept.setValue("files/folder", str(path.parent))

    def drop_recent(self, path: Path) -> None:
        self._set_recent([p for p in self.recent if p != path.absolute()])

    def clear_recent(self) -> None:
        self._set_recent([])

    def _set_recent(self, paths: list[Path]) -> None:
        self._kept.setValue("files/recent", [str(p) for p in paths[:MOST_RECENT]])

    @property
    def folder(self) -> Path:
        """Where the last file was."""
        folder = Path(str(self._kept.value("files/folder", "") or Path.home()))
        return folder if folder.is_dir() else Path.home()

    @folder.setter
    def folder(self, folder: Path) -> None:
        self._kept.setValue("files/folder", str(folder))
