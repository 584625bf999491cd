"""A folder that the program makes, fills and deletes by itself. A list in it proves that: its first line is a mark, each further line
names a file with the sha256 of what it holds, and is written before the file is."""

from __future__ import annotations

import hashlib
import os
import re
from contextlib import suppress
from pathlib import Path

from core.project.files import as_file_error, is_folder, listed, read_own, remove, remove_listed
from core.project.locks import NO_LINK

LIST = "kindyna-run"
_ROW = re.compile(r"([0-9a-f]{64})  ([0-9]{5}\.npz)")
_BINARY = getattr(os, "O_BINARY", 0)


class OwnFolder:
    """One such folder. It need not exist yet."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._mark = f"KINDYNA run {path.name}"
        self._hashes: dict[str, str] = {}

    def is_own(self) -> bool:
        """Whether the program has made the folder; its list is read anew."""
        self._hashes = {}
        rows = None
        with suppress(OSError):
            if is_folder(self.path):
                handle = os.open(self.path / LIST, os.O_RDONLY | NO_LINK | getattr(os, "O_NONBLOCK", 0) | _BINARY)
                try:
                    rows = listed(handle, self._mark)
                finally:
                    os.close(handle)
        matches = (_ROW.fullmatch(row) for row in rows or ())
        self._hashes = {match[2]: match[1] for match in matches if match is not None}
        return rows is not None and is_folder(self.path.parent)

    def is_usable(self) -> bool:
        """Whether it does not exist yet, or is the program's and holds nothing that its list does not name; no link leads to it."""
        if not os.path.lexists(self.path):
            return is_folder(self.path.parent) or not os.path.lexists(self.path.parent)
        if not self.is_own():
            return False
        with os.scandir(self.path) as entries:
            names = {LIST, *self._hashes}
            return all(entry.name in names and entry.is_file(follow_symlinks=False) for entry in entries)

    def write(self, name: str, data: bytes) -> None:
        """Put a file in place of one that is listed, or where none is. Raises FileError."""
        with as_file_error(self.path, "written"):
            if not os.path.lexists(self.path):
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self.path.mkdir()
                self._put(LIST, self._mark.encode(), os.O_CREAT | os.O_EXCL)
            if os.path.lexists(self.path / name) and (name in self._hashes or (self.is_own() and name in self._hashes)):
                remove(self.path / name)  # damaged, or of another process
            self._hashes[name] = hashlib.sha256(data).hexdigest()
            self._put(LIST, f"\n{self._hashes[name]}  {name}".encode(), os.O_APPEND)
            self._put(name, data, os.O_CREAT | os.O_EXCL)

    def _put(self, name: str, data: bytes, how: int) -> None:
        handle = os.open(self.path / name, os.O_WRONLY | NO_LINK | _BINARY | how, 0o666)
        with open(handle, "wb") as file:
            file.write(data)

    def read(self, name: str) -> bytes | None:
        """A file as it was written; None where it is not listed, is gone, or holds anything else by now."""
        with suppress(OSError):
            data = read_own(self.path / name) if name in self._hashes else b""
            if hashlib.sha256(data).hexdigest() == self._hashes.get(name):
                return data
        return None

    def delete(self) -> None:
        """Delete the files that the list names; where nothing else is there, the list and the folder, too."""
        if self.is_own():
            remove_listed(self.path, self._hashes)
            self._hashes = {}
            with suppress(OSError):
                if os.listdir(self.path) == [LIST]:
                    remove(self.path / LIST)
                    self.path.rmdir()


__all__ = ["LIST", "OwnFolder"]
