"""Detection of changes of design files, and of the files linked to them, by other programs."""

from __future__ import annotations

import os
from contextlib import suppress
from enum import Enum
from pathlib import Path

from core.design import Design
from core.design.motion_edits import files_of
from core.errors import FileError
from core.project import loads_drawing, save
from core.project.files import read_bytes, read_text


class OnDisk(Enum):
    """State of a file, compared with its content when it was last read or written."""

    SAME = "same"
    CHANGED = "changed"
    GONE = "gone"
    SOURCE = "source"
    """The file is unchanged, but a linked file has changed."""


class DesignFiles:
    """Reads and writes designs, and remembers the text of each file and the hashes of its linked files."""

    def __init__(self) -> None:
        self._texts: dict[Path, str] = {}
        self._sources: dict[Path, tuple[str, ...]] = {}
        self._hashes: dict[str, bytes | None] = {}

    def note(self, path: Path, design: Design | None = None) -> None:
        """Remember the present content of a file, and of the files linked to its design."""
        with suppress(FileError):
            self._texts[path] = read_text(path)
            if design is not None:
                self._note_sources(path, design)

    def _note_sources(self, path: Path, design: Design) -> None:
        self._sources[path] = files_of(design)
        self._hashes |= {name: _hash(name) for name in self._sources[path]}

    def sources(self, path: Path) -> tuple[str, ...]:
        """Files linked to a design."""
        return self._sources.get(path, ())

    def changed_sources(self, path: Path) -> tuple[str, ...]:
        """Linked files that have changed since the design was read."""
        return tuple(name for name in self.sources(path) if _hash(name) != self._hashes[name])

    def read(self, path: Path) -> Design:
        """Design in a file. Raises FileError, DesignError."""
        text = read_text(path)
        design = loads_drawing(text, source=str(path))
        self._texts[path] = text
        self._note_sources(path, design)
        return design

    def write(self, design: Design, path: Path) -> None:
        """Write a design. Raises FileError, DesignError."""
        self._texts[path] = save(design, path, in_place=True)
        self._sources[path] = files_of(design)
        for name in self._sources[path]:  # the design still depends on the linked files as they were read
            if name not in self._hashes:
                self._hashes[name] = _hash(name)

    def state(self, path: Path) -> OnDisk:
        """State of a file; SAME for a file that was never read or written."""
        if path not in self._texts:
            return OnDisk.SAME
        try:
            if read_text(path) != self._texts[path]:
                return OnDisk.CHANGED
        except FileError:
            return OnDisk.CHANGED if os.path.lexists(path) else OnDisk.GONE
        return OnDisk.SOURCE if self.changed_sources(path) else OnDisk.SAME


def _hash(name: str) -> bytes | None:
    """Hash of a file's content; None where the file is missing."""
    from hashlib import sha256  # imported here to save start-up time

    with suppress(FileError):
        return sha256(read_bytes(name)).digest()
    return None
