"""Unsaved work on the disk: one file for each window, with a lock that is held while its process lives.

A recovery file is a design file whose first line, a comment, holds in JSON what the format has no place for: the design's own
file, when it was written, and what is typed that does not fit together yet. So one move puts all of it in place, and it can be opened as
any other design.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import FileError
from core.frozen import frozen
from core.project.files import NO_LOCKS, hold, read_text, remove, sweep, write

_HEAD = "# unsaved "


@frozen
class Unsaved:
    """Unsaved work.

    design   text of the design, as in a file
    path     of the design's own file, None where it has none
    draft    what is typed that does not fit together yet, of text, numbers, lists and dictionaries; None where it fits
    time     when it was written, seconds since 1970
    drive    number of the drive that was chosen then, from 0
    """

    design: str
    path: Path | None
    draft: Mapping[str, Any] | None = None
    time: float = 0.0
    drive: int = 0


def _text(unsaved: Unsaved) -> str:
    import json  # not before something is unsaved

    path = None if unsaved.path is None else str(unsaved.path)
    head = {"path": path, "time": unsaved.time, "draft": unsaved.draft, "drive": unsaved.drive}
    line = json.dumps(head).replace("\x7f", "\\u007f")  # which no comment of TOML may hold
    return f"{_HEAD}{line}\n{unsaved.design}"


def _parsed(text: str) -> Unsaved:
    """What a recovery file holds; all of it as the design where its first line is not as written here."""
    import json

    first, _, rest = text.partition("\n")
    try:
        head = json.loads(first.removeprefix(_HEAD))
        path, draft, when = head["path"], head["draft"], float(head["time"])
        return Unsaved(rest, None if path is None else Path(path), draft, when, int(head.get("drive", 0)))
    except (ValueError, KeyError, TypeError):
        return Unsaved(text, None)


class RecoveryFile:
    """The recovery file of one window, whose lock is held from the first ``write`` to ``close``."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._path: Path | None = None
        self._lock: int | None = None

    def write(self, unsaved: Unsaved) -> None:
        """Put unsaved work in the place of what was there, whole or not at all, and have the disk keep it.

        Raises FileError where it cannot be written; then nothing has changed.
        """
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
        """Make the folder, choose a name and hold its lock."""
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        while self._path is None:
            path = self._folder / f"{os.urandom(8).hex()}.toml"
            try:
                self._lock = hold(_lock_of(path))
            except OSError as error:
                if error.errno not in NO_LOCKS:
                    raise
                self._path = path
            if self._lock is not None:  # else another process has taken it for one that was left behind
                self._path = path

    def clear(self) -> None:
        """Nothing is unsaved any more."""
        if self._path is not None:
            remove(self._path)

    def close(self) -> None:
        """Nothing is unsaved, and the window is closed."""
        if self._path is not None:
            remove(self._path)
            _remove_lock(self._path, self._lock)
            self._path = self._lock = None


@frozen
class Recoverable:
    """Unsaved work of a process that has died. Until ``discard`` or ``release`` no other process finds it."""

    file: Path
    unsaved: Unsaved
    _lock: int | None

    def discard(self) -> None:
        """Remove it: it is recovered, or not wanted."""
        remove(self.file)
        _remove_lock(self.file, self._lock)

    def release(self) -> None:
        """Leave it to be found again."""
        if self._lock is not None:
            os.close(self._lock)


def find(folder: Path) -> list[Recoverable]:
    """Unsaved work of processes that have died, the latest first. Their locks without work, and files half written, are
    removed."""
    sweep(folder, private=True)
    left = []
    for path in sorted({each.with_suffix(".toml") for each in folder.glob("*") if each.suffix in (".toml", ".lock")}):
        try:
            lock = hold(_lock_of(path))
            if lock is None:
                continue
        except OSError as error:
            if error.errno not in NO_LOCKS:
                continue
            lock = None
        if not path.exists():
            _remove_lock(path, lock)
            continue
        try:
            left.append(Recoverable(path, _parsed(read_text(path)), lock))
        except FileError:  # it stays for another time
            if lock is not None:
                os.close(lock)
    return sorted(left, key=lambda each: each.unsaved.time, reverse=True)


def now(design: str, path: Path | None, draft: Mapping[str, Any] | None = None, drive: int = 0) -> Unsaved:
    """Unsaved work as of this moment."""
    return Unsaved(design, path, draft, time.time(), drive)


def _lock_of(path: Path) -> Path:
    return path.with_suffix(".lock")


def _remove_lock(path: Path, lock: int | None) -> None:
    remove(_lock_of(path))
    if lock is not None:
        os.close(lock)
    if os.name == "nt":  # where no open file can be removed
        remove(_lock_of(path))
