"""Recovery files of unsaved work: one file for each window, locked while its process runs.

A recovery file is a design file whose first line, a comment, contains in JSON what the format has no key for: the path of the
design's file, the time of writing, and incomplete input. So one move replaces all of it, and it can be opened as any other design.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import FileError
from core.frozen import frozen
from core.project.files import NO_LOCKS, acquire_lock, read_text, remove, remove_lock, sweep, write

_HEADER = "# unsaved "


@frozen
class Unsaved:
    """Unsaved work.

    Attributes
    ----------
    design : str
        Text of the design, as in a file.
    path : Path or None
        The design's file, where it has one.
    draft : mapping or None
        Typed values that contradict each other, as text, numbers, lists and dictionaries.
    time : float
        Time of writing, seconds since 1970.
    drive : int
        Index of the selected drive.
    """

    design: str
    path: Path | None
    draft: Mapping[str, Any] | None = None
    time: float = 0.0
    drive: int = 0


def _text(unsaved: Unsaved) -> str:
    import json  # late: needed only with unsaved work

    path = None if unsaved.path is None else str(unsaved.path)
    header = {"path": path, "time": unsaved.time, "draft": unsaved.draft, "drive": unsaved.drive}
    line = json.dumps(header).replace("\x7f", "\\u007f")  # not allowed in a comment of TOML
    return f"{_HEADER}{line}\n{unsaved.design}"


def _parsed(text: str) -> Unsaved:
    """Content of a recovery file; all of it is the design where the first line has another form."""
    import json

    first, _, rest = text.partition("\n")
    try:
        header = json.loads(first.removeprefix(_HEADER))
        path, draft, when = header["path"], header["draft"], float(header["time"])
        return Unsaved(rest, None if path is None else Path(path), draft, when, int(header.get("drive", 0)))
    except (ValueError, KeyError, TypeError):
        return Unsaved(text, None)


class RecoveryFile:
    """The recovery file of one window, locked from the first `write` to `close`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._path: Path | None = None
        self._lock: int | None = None

    def write(self, unsaved: Unsaved) -> None:
        """Replace the recovery file atomically. Raises FileError where it cannot be written; then nothing has changed."""
        if self._path is None:
            try:
                self._begin()
            except OSError as error:
                raise FileError(
                    f"{self._folder}: cannot be written: {error.strerror}; make room or permit it"
                ) from error
        assert self._path is not None
        write(self._path, _text(unsaved))

    def _begin(self) -> None:
        """Create the folder, choose a name and lock it."""
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        while self._path is None:
            path = self._folder / f"{os.urandom(8).hex()}.toml"
            try:
                self._lock = acquire_lock(_lock_of(path))
            except OSError as error:
                if error.errno not in NO_LOCKS:
                    raise
                self._path = path
            if self._lock is not None:  # else another process has removed it as a leftover
                self._path = path

    def clear(self) -> None:
        """Remove the file, as nothing is unsaved."""
        if self._path is not None:
            remove(self._path)

    def close(self) -> None:
        """Remove the file and its lock, as the window closes."""
        if self._path is not None:
            remove(self._path)
            remove_lock(_lock_of(self._path), self._lock)
            self._path = self._lock = None


@frozen
class Recoverable:
    """Unsaved work of a process that has ended, locked for other processes until `discard` or `release`."""

    file: Path
    unsaved: Unsaved
    _lock: int | None

    def discard(self) -> None:
        """Remove the file, which is recovered or not needed."""
        remove(self.file)
        remove_lock(_lock_of(self.file), self._lock)

    def release(self) -> None:
        """Unlock the file for another time."""
        if self._lock is not None:
            os.close(self._lock)


def find(folder: Path) -> list[Recoverable]:
    """Unsaved work of processes that have ended, the latest first; locks without work and temporary files are removed."""
    sweep(folder, private=True)
    result = []
    for path in sorted({file.with_suffix(".toml") for file in folder.glob("*") if file.suffix in (".toml", ".lock")}):
        try:
            lock = acquire_lock(_lock_of(path))
            if lock is None:
                continue
        except OSError as error:
            if error.errno not in NO_LOCKS:
                continue
            lock = None
        if not path.exists():
            remove_lock(_lock_of(path), lock)
            continue
        try:
            result.append(Recoverable(path, _parsed(read_text(path)), lock))
        except FileError:  # the file stays for another time
            if lock is not None:
                os.close(lock)
    return sorted(result, key=lambda work: work.unsaved.time, reverse=True)


def now(design: str, path: Path | None, draft: Mapping[str, Any] | None = None, drive: int = 0) -> Unsaved:
    """Unsaved work with the current time."""
    return Unsaved(design, path, draft, time.time(), drive)


def _lock_of(path: Path) -> Path:
    return path.with_suffix(".lock")
