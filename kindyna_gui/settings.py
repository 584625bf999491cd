"""What the window remembers from one run to the next: the layouts of its tasks, recent files, the last folder."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QByteArray, QSettings
from PySide6.QtWidgets import QMainWindow

from core.bounds import FIELD, number_from_one
from core.frozen import frozen
from kindyna_gui.preferences.kept import LONGEST, kept_text, kept_value

MOST_RECENT = 8


@frozen
class TaskLayout:
    """How a task was left: the docks, the pages in the middle and the one in front, whether docks of linkages are there, and of
    several drives."""

    state: QByteArray
    pages: tuple[str, ...]
    front: str
    links: bool
    several: bool = False


def _key(name: str) -> str:
    """A name without the signs that part the keys of settings."""
    return name.encode().hex()


class Settings:
    """A thin layer over QSettings."""

    VERSION = 6
    """Of the layouts, raised whenever docks come or go: those of another version are left alone, and not used."""

    def __init__(self) -> None:
        self._kept = QSettings("KINDYNA", "KINDYNA")

    def save_window(self, window: QMainWindow, task: str) -> None:
        """Keep place and size of the window, and the task that is in place."""
        self._kept.setValue("window/geometry", window.saveGeometry())
        self._kept.setValue("window/task", task)
        self._kept.sync()

    def restore_geometry(self, window: QMainWindow) -> bool:
        """False where nothing was kept; then nothing changes."""
        geometry = kept_value(self._kept, "window/geometry")
        return isinstance(geometry, QByteArray) and window.restoreGeometry(geometry)

    def written(self, name: str) -> str:
        """What a report's first page said the last time; empty where nothing."""
        return kept_text(self._kept, f"report/{name}")

    def write(self, name: str, text: str) -> None:
        """Keep it."""
        self._kept.setValue(f"report/{name}", text)

    @property
    def task(self) -> str:
        """The task of the last run; empty where there was none."""
        return kept_text(self._kept, "window/task")

    @property
    def named_layouts(self) -> list[str]:
        """The names under which the user keeps layouts, those of other versions too."""
        return self._texts("layouts/names")

    def _texts(self, key: str) -> list[str]:
        """A list of texts, of which Qt keeps one alone as a text; those that are none are left out."""
        kept = kept_value(self._kept, key)
        texts = [kept] if isinstance(kept, str) else kept if isinstance(kept, list) else []
        return [text for text in texts if isinstance(text, str) and text and len(text) <= LONGEST and "\0" not in text]

    def name_layout(self, name: str, task: str, layout: TaskLayout) -> None:
        """Keep the layout of a task under a name, in place of what was kept under it."""
        key = f"layouts/{_key(name)}"
        self._kept.setValue("layouts/names", sorted({*self.named_layouts, name}, key=str.casefold))
        self._kept.setValue(f"{key}/version", self.VERSION)
        self._kept.setValue(f"{key}/task", task)
        self._write_layout(key, layout)

    def forget_layout(self, name: str) -> None:
        self._kept.setValue("layouts/names", [each for each in self.named_layouts if each != name])
        self._kept.remove(f"layouts/{_key(name)}")

    def named_layout(self, name: str) -> tuple[str, TaskLayout]:
        """The task and its layout that are kept under a name. Raises ValueError, with the reason, where they cannot be used."""
        key = f"layouts/{_key(name)}"
        version, task = kept_text(self._kept, f"{key}/version"), kept_text(self._kept, f"{key}/task")
        if version != str(self.VERSION):
            newer = number_from_one(version, 10**9) > self.VERSION
            raise ValueError("of a newer version of KINDYNA" if newer else "of an older version, which had other docks")
        layout = self._read_layout(key)
        if layout is None:
            raise ValueError("broken")
        return task, layout

    def save_layout(self, task: str, layout: TaskLayout) -> None:
        """Keep the layout of a task."""
        self._write_layout(f"layout{self.VERSION}/{task}", layout)

    def _write_layout(self, key: str, layout: TaskLayout) -> None:
        self._kept.setValue(f"{key}/docks", layout.state)
        self._kept.setValue(f"{key}/pages", " ".join((layout.front, *layout.pages)))
        self._kept.setValue(f"{key}/links", int(layout.links))
        self._kept.setValue(f"{key}/several", int(layout.several))

    def layout(self, task: str) -> TaskLayout | None:
        """The layout of a task; None where none of this version was kept."""
        return self._read_layout(f"layout{self.VERSION}/{task}")

    def _read_layout(self, key: str) -> TaskLayout | None:
        state, names = kept_value(self._kept, f"{key}/docks"), kept_text(self._kept, f"{key}/pages").split()
        if not isinstance(state, QByteArray) or not names:
            return None
        links, several = (kept_text(self._kept, f"{key}/{kind}") == "1" for kind in ("links", "several"))
        return TaskLayout(state, tuple(names[1:]), names[0], links, several)

    @property
    def graph(self) -> str:
        """The graph of the last run, as text; empty where there was none."""
        return kept_text(self._kept, "window/graph", longest=FIELD)

    @graph.setter
    def graph(self, text: str) -> None:
        self._kept.setValue("window/graph", text)

    @property
    def welcome(self) -> bool:
        """Whether the welcome page is shown where the program is started without a file."""
        return kept_text(self._kept, "window/welcome", "1") != "0"

    @welcome.setter
    def welcome(self, shown: bool) -> None:
        self._kept.setValue("window/welcome", "1" if shown else "0")

    @property
    def recent(self) -> list[Path]:
        """Files opened or saved, the latest first."""
        return [Path(name) for name in self._texts("files/recent")[:MOST_RECENT]]

    def add_recent(self, path: Path) -> None:
        """Put a file at the head of the recent ones; the next dialog begins in its folder."""
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
        folder = Path(kept_text(self._kept, "files/folder") or Path.home())
        return folder if folder.is_dir() else Path.home()

    @folder.setter
    def folder(self, folder: Path) -> None:
        self._kept.setValue("files/folder", str(folder))
