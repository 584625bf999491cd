"""Design files, and those that their motions follow from, compared with what was read from them or written to them last: has another
program changed one since?"""

from __future__ import annotations

import os
from contextlib import suppress
from enum import Enum
from hashlib import sha256
from pathlib import Path

from core.design import Design
from core.design.motion_edits import files_of
from core.errors import FileError
from core.project import loads_drawing, save
from core.project.files import read_bytes, read_text


class OnDisk(Enum):
    """A file, compared with what was read or written last."""

    SAME = "same"
    CHANGED = "changed"
    GONE = "gone"
    SOURCE = "source"
    """The file is as it was; one that its motions follow from is not."""


class DesignFiles:
    """Reads and writes designs and keeps the text that each file had then, and what its sources held; contents count, not times."""

    def __init__(self) -> None:
        self._texts: dict[Path, str] = {}
        self._sources: dict[Path, tuple[str, ...]] = {}
        self._held: dict[str, bytes | None] = {}

    def note(self, path: Path, design: Design | None = None) -> None:
        """Take what a file holds now for what was read, and what the motions of its design follow from."""
        with suppress(FileError):
            self._texts[path] = read_text(path)
            if design is not None:
                self._note_sources(path, design)

    def _note_sources(self, path: Path, design: Design) -> None:
        self._sources[path] = files_of(design)
        self._held |= {name: _held(name) for name in self._sources[path]}

    def sources(self, path: Path) -> tuple[str, ...]:
        """The files that the motions of a design follow from."""
        return self._sources.get(path, ())

    def changed_sources(self, path: Path) -> tuple[str, ...]:
        """Those of them that hold something else than when the design was read."""
        return tuple(name for name in self.sources(path) if _held(name) != self._held[name])

    def read(self, path: Path) -> Design:
        """The design in a file. Raises FileError, DesignError."""
        text = read_text(path)
        design = loads_drawing(text, source=str(path))
        self._texts[path] = text
        self._note_sources(path, design)
        return design

    def write(self, design: Design, path: Path) -> None:
        """Write a design. Raises FileError, DesignError."""
        self._texts[path] = save(design, path, in_place=True)
        self._sources[path] = files_of(design)
        for name in self._sources[path]:  # the design in hand is still of what was read of the others
            if name not in self._held:
                self._held[name] = _held(name)

    def state(self, path: Path) -> OnDisk:
        """Whether a file holds what was read or written last; ``SAME`` for one that never was."""
        if path not in self._texts:
            return OnDisk.SAME
        try:
            if read_text(path) != self._texts[path]:
                return OnDisk.CHANGED
        except FileError:
            return OnDisk.CHANGED if os.path.lexists(path) else OnDisk.GONE
        return OnDisk.SOURCE if self.changed_sources(path) else OnDisk.SAME


def _held(name: str) -> bytes | None:
    """What a source holds, as a short sum; None where it is gone."""
    with suppress(FileError):
        return sha256(read_bytes(name)).digest()
    return None
