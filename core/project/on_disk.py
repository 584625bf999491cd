"""Design files compared with what was read from them or written to them last: has another program changed one since?"""

from __future__ import annotations

import os
from contextlib import suppress
from enum import Enum
from pathlib import Path

from core.design import Design
from core.errors import FileError
from core.project import loads_drawing, save
from core.project.files import read_text


class OnDisk(Enum):
    """A file, compared with what was read or written last."""

    SAME = "same"
    CHANGED = "changed"
    GONE = "gone"


class DesignFiles:
    """Reads and writes designs and keeps the text that each file had then; contents count, not times."""

    def __init__(self) -> None:
        self._texts: dict[Path, str] = {}

    def note(self, path: Path) -> None:
        """Take what a file holds now for what was read."""
        with suppress(FileError):
            self._texts[path] = read_text(path)

    def read(self, path: Path) -> Design:
        """The design in a file. Raises FileError, DesignError."""
        text = read_text(path)
        design = loads_drawing(text, source=str(path))
        self._texts[path] = text
        return design

    def write(self, design: Design, path: Path) -> None:
        """Write a design. Raises FileError, DesignError."""
        self._texts[path] = save(design, path, in_place=True)

    def state(self, path: Path) -> OnDisk:
        """Whether a file holds what was read or written last; ``SAME`` for one that never was."""
        if path not in self._texts:
            return OnDisk.SAME
        try:
            return OnDisk.SAME if read_text(path) == self._texts[path] else OnDisk.CHANGED
        except FileError:
            return OnDisk.CHANGED if os.path.lexists(path) else OnDisk.GONE
