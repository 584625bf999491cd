"""Atomic reading and writing of files, lock files, and the program's private files; every error is one line."""

from __future__ import annotations

import errno
import os
import re
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import NoReturn

from core.bounds import BYTES
from core.errors import FileError

# -- lock files -------------------------------------------------------------------------------------------------


_BUSY = (errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK)
NO_LOCKS = (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL)
"""Error numbers of file systems without locks."""
NO_LINK = getattr(os, "O_NOFOLLOW", 0)
"""Flag of `os.open`: an error where the file is a symbolic link."""


def acquire_lock(path: str | os.PathLike[str], *, create: bool = True) -> int | None:
    """Lock a file, which is created where it is missing: its handle, or None where it is locked already.

    The system releases the lock when the handle is closed, and also when the process is killed.

    Raises
    ------
    OSError
        The file cannot be created or is a link, or, with a number in `NO_LOCKS`, the file system has no locks.
    """
    handle = os.open(path, os.O_RDWR | (os.O_CREAT if create else 0) | NO_LINK, 0o600)
    try:
        is_locked = _lock(handle) and _is_same_file(path, handle)
    except BaseException:
        os.close(handle)
        raise
    if not is_locked:
        os.close(handle)
        return None
    return handle


def _is_same_file(path: str | os.PathLike[str], handle: int) -> bool:
    """Whether the path still leads to the open file, which another process may have removed before it was locked."""
    try:
        return os.path.samestat(os.fstat(handle), os.lstat(path))
    except FileNotFoundError:
        return False


def remove_lock(path: Path, handle: int | None) -> None:
    """Delete a lock file before it is released, so that no other process locks a file that disappears."""
    remove(path)
    if handle is not None:
        os.close(handle)
    if sys.platform == "win32":  # which removes no open file
        remove(path)


def _lock(handle: int) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in _BUSY:
            return False
        raise
    return True


# -- reading and writing files ----------------------------------------------------------------------------------


AnyPath = str | os.PathLike[str]
Content = bytes | str | Iterator[bytes]

_REASONS: Mapping[int, str] = MappingProxyType(
    {
        errno.ENOENT: "no such file or folder; check the spelling",
        errno.ENOTDIR: "there is a file instead of a folder; choose another folder",
        errno.EEXIST: "there is a file instead of a folder; choose another folder",
        errno.EISDIR: "it is a folder; name a file",
        errno.EACCES: "permission denied; change its permissions or choose another place",
        errno.EPERM: "permission denied; change its permissions or choose another place",
        errno.EROFS: "the disk is read-only; choose another place",
        errno.ENOSPC: "the disk is full; free some space or choose another place",
        errno.EDQUOT: "your share of the disk is full; free some space or choose another place",
        errno.EFBIG: "larger than the disk's limit for a file; choose another place",
        errno.ENAMETOOLONG: "the name is too long; shorten it",
        errno.ELOOP: "its symbolic links lead in a circle; correct them",
        errno.EIO: "the disk does not respond; check it",
    }
)


_inputs: set[tuple[int, int]] | None = None  # device and number of each file that the running command has read


@contextmanager
def inputs_protected() -> Iterator[None]:
    """Context in which files that were read are only overwritten in place, so that a mistyped name destroys no input."""
    global _inputs
    before, _inputs = _inputs, set()
    try:
        yield
    finally:
        _inputs = before


def read_bytes(path: AnyPath, most_bytes: int = BYTES) -> bytes:
    """Content of a file. Raises FileError where it is missing, not an ordinary file, not readable or too large."""
    with as_file_error(path, "read"):
        status = os.stat(path)
        _ordinary(path, status, "read")
        if _inputs is not None:
            _inputs.add((status.st_dev, status.st_ino))
        data = b""
        if status.st_size <= most_bytes:
            with open(path, "rb") as file:
                data = file.read(most_bytes + 1)
    if max(status.st_size, len(data)) > most_bytes:
        _refuse(path, "read", f"larger than {most_bytes / 1e6:g} MB; name another file")
    return data


def read_text(path: AnyPath, most_bytes: int = BYTES) -> str:
    """Text of a UTF-8 file without its byte order mark.

    Raises FileError where it is missing, not an ordinary file, not readable, too large or not UTF-8.
    """
    data = read_bytes(path, most_bytes)
    try:
        return data.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        _refuse(path, "read", f"not UTF-8 text (byte {error.start + 1}); save it as UTF-8 text", error)


def write(path: AnyPath, data: bytes | str, *, in_place: bool = False) -> None:
    """Write one file atomically; its permissions do not change, and symbolic links are followed.

    in_place: also where the file was read within `inputs_protected`. Raises FileError where it cannot be written; then nothing has
    changed.
    """
    _replace_all({Path(path): data}, create_folders=False, in_place=in_place)


def write_all(folder: AnyPath, files: Mapping[str, Content]) -> None:
    """Write all files (name: content) or none; missing folders are created, and symbolic links are followed.

    An iterator is written as its parts are produced, and its errors are raised. Raises FileError where a file cannot be written;
    then nothing has changed.
    """
    _replace_all({Path(folder) / name: data for name, data in files.items()}, create_folders=True)


def write_into(folder: AnyPath, files: Mapping[str, Content], *, typed: str = "") -> None:
    """Write files as `write_all` does, under names of which the user typed at most one.

    Raises FileError also where one of the other files is a symbolic link, or is in a folder that is one.
    """
    paths = {Path(folder) / name: data for name, data in files.items()}
    _replace_all(paths, create_folders=True, without_links=(Path(folder), typed))


def _replace_all(
    files: Mapping[Path, Content],
    *,
    create_folders: bool,
    in_place: bool = False,
    without_links: tuple[Path, str] | None = None,
) -> None:
    """Write all files under temporary names, where space or permission may be lacking, and then move them.

    Every step that must be undone is registered before it is taken, so that an interrupt can undo it. The stacks unwind from right
    to left: old contents restored, temporary names removed, new folders removed.
    """
    with ExitStack() as folders, ExitStack() as leftovers, ExitStack() as undo:
        temporary = _TemporaryNames(leftovers)
        targets = {path: _target(path) for path in files}
        if without_links is not None:
            _require_inside(targets, *without_links)
        modes = {path: _permissions(path, target, in_place) for path, target in targets.items()}
        written, identities = {}, {}
        for path, data in files.items():
            with as_file_error(path, "written"):
                if create_folders:
                    _create_folders(targets[path].parent, folders)
                written[path] = temporary.name_for(targets[path])
                identities[path] = _write_new(written[path], data, modes[path])
        backups = {}
        if len(files) > 1:  # a single move needs no backup
            for path in (p for p in files if modes[p] is not None):
                with as_file_error(path, "written"):
                    backups[path] = temporary.name_for(targets[path])
                    _back_up(targets[path], backups[path])
        for path, target in targets.items():
            with as_file_error(path, "written"):
                if len(files) > 1:
                    undo.callback(_restore, target, backups.get(path), identities[path])
                os.replace(written[path], target)
        undo.pop_all()
        folders.pop_all()
    for folder in {target.parent for target in targets.values()}:
        _sync(folder)


def _target(path: Path) -> Path:
    """Target of symbolic links, so that a link stays a link."""
    with as_file_error(path, "written"):
        return Path(os.path.realpath(path))


def _require_inside(targets: Mapping[Path, Path], folder: Path, typed: str) -> None:
    """Raise FileError for a file, other than the typed one, to which a link inside the folder leads."""
    real = _target(folder)
    for path, target in targets.items():
        name = path.relative_to(folder)
        if str(name) != typed and os.path.normcase(target) != os.path.normcase(real / name):
            _refuse(path, "written", "it is a symbolic link, or behind one; remove the link or choose another folder")


def _permissions(path: Path, target: Path, in_place: bool) -> int | None:
    """Permission bits of the file to be replaced, None where there is none."""
    with as_file_error(path, "written"):
        try:
            status = os.stat(target)
        except FileNotFoundError:
            return None
        _ordinary(path, status, "written")
        if not in_place and (status.st_dev, status.st_ino) in (_inputs or ()):
            _refuse(path, "written", "this command reads it; choose another name")
        effective = os.access in os.supports_effective_ids
        if not os.access(target, os.W_OK, effective_ids=effective):  # a move would replace it
            _refuse(path, "written", "it is write-protected; change its permissions or choose another name")
        return stat.S_IMODE(status.st_mode)


class _TemporaryNames:
    """Free names in the folders of the targets, registered for removal: `.kindyna-RUN-1.tmp`, `.kindyna-RUN-2.tmp` ...

    In each folder a locked file `.kindyna-RUN.tmp` is created first and removed last. After a first line that marks it, it lists the
    names. Where it is not locked, a killed process has left them.
    """

    def __init__(self, leftovers: ExitStack) -> None:
        self._leftovers = leftovers
        self._runs: dict[Path, tuple[str, int | None]] = {}  # with the handle of the lock
        self._number = 0

    def name_for(self, target: Path) -> Path:
        """A new name in the folder of the target."""
        folder = target.parent
        if folder not in self._runs:
            sweep(folder)
            self._runs[folder] = self._begin(folder)
        self._number += 1
        run, lock = self._runs[folder]
        path = folder / f".kindyna-{run}-{self._number}.tmp"
        if lock is not None:
            os.write(lock, f"\n{path.name}".encode())
        self._leftovers.callback(remove, path)
        return path

    def _begin(self, folder: Path) -> tuple[str, int | None]:
        while True:
            run = os.urandom(8).hex()
            lock = folder / f".kindyna-{run}.tmp"
            self._leftovers.callback(remove, lock)
            try:
                handle = acquire_lock(lock)
            except OSError as error:
                if error.errno not in NO_LOCKS:
                    raise
                return run, None
            if handle is not None:  # else another process has removed the file
                self._leftovers.callback(os.close, handle)
                os.write(handle, _mark(run).encode())
                return run, handle


_TEMPORARY_NAME = re.compile(r"\.kindyna-([0-9a-f]{16})(-\d+)?\.tmp")


def _mark(run: str) -> str:
    """First line of a lock file, which no other program writes."""
    return f"KINDYNA write {run}"


def sweep(folder: AnyPath, *, private: bool = False) -> None:
    """Remove the temporary files that killed processes have left in a folder and listed in their lock files.

    Files of a running process stay, and files of the user with such a name. private: the folder belongs to the program, so that the
    name alone identifies its files.
    """
    with suppress(OSError):
        matches = [match for name in os.listdir(folder) if (match := _TEMPORARY_NAME.fullmatch(name))]
        for run in {match[1] for match in matches}:
            with suppress(OSError):
                _sweep(Path(folder), run, {match[0] for match in matches if match[1] == run}, private)


def _sweep(folder: Path, run: str, names: set[str], private: bool) -> None:
    lock = folder / f".kindyna-{run}.tmp"
    handle = acquire_lock(lock, create=private)
    if handle is None:
        return
    is_swept = False
    try:
        rows = listed(handle, _mark(run))
        for name in sorted(names if private else names.intersection(rows or ())):
            remove(folder / name)
        is_swept = private or rows is not None
    finally:
        if is_swept:
            remove_lock(lock, handle)
        else:
            os.close(handle)


def _write_new(path: Path, data: Content, mode: int | None) -> Identity:
    content = data.encode() if isinstance(data, str) else data
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    handle = os.open(path, flags, 0o666 if mode is None else mode)
    try:
        for part in [content] if isinstance(content, bytes) else content:
            rest = memoryview(part)
            while rest:
                rest = rest[os.write(handle, rest) :]
        os.fsync(handle)
        status = os.fstat(handle)
    finally:
        os.close(handle)
    if mode is not None:
        os.chmod(path, mode)
    return status.st_dev, status.st_ino


def _sync(folder: Path) -> None:
    """Write the entries of a folder to the disk, on systems that allow it."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _back_up(target: Path, backup: Path) -> None:
    """Give the old content a second name, or copy it where the disk has no hard links."""
    try:
        os.link(target, backup)
    except OSError:
        import shutil  # late: slow to import, and rarely needed

        shutil.copy2(target, backup)


def _restore(target: Path, backup: Path | None, identity: Identity) -> None:
    if backup is None:
        remove(target, identity)
    else:
        with suppress(OSError):
            os.replace(backup, target)


def _create_folders(folder: Path, undo: ExitStack) -> None:
    missing = []
    while not folder.exists():
        missing.append(folder)
        folder = folder.parent
    for path in reversed(missing):
        undo.callback(_remove_folder, path)
        path.mkdir(exist_ok=True)


def _remove_folder(path: Path) -> None:
    with suppress(OSError):  # someone else may use it by now
        path.rmdir()


# -- files that belong to the program -----------------------------------------------------------------------

Identity = tuple[int, int]
"""Device and number of a file."""

MOST_OWN = 1 << 30
"""Most bytes of such a file."""


def remove(path: Path, identity: Identity | None = None) -> None:
    """Delete a file that the program has written; no other function deletes files.

    Links, folders, other special files and files in a linked folder stay, and files with another identity than the given one.
    """
    with suppress(OSError):
        status = os.lstat(path)
        if (
            stat.S_ISREG(status.st_mode)
            and identity in (None, (status.st_dev, status.st_ino))
            and is_folder(path.parent)
        ):
            os.unlink(path)


def remove_listed(folder: Path, names: Iterable[str]) -> None:
    """Delete files in a folder by their relative names, and the folders in it that become empty."""
    for name in names:
        path = folder / name
        remove(path)
        while path.parent != folder:
            path = path.parent
            _remove_folder(path)


def is_folder(path: Path) -> bool:
    """Whether a path is a folder and not a link to one."""
    try:
        status = os.lstat(path)
    except OSError:
        return False
    return stat.S_ISDIR(status.st_mode) and getattr(status, "st_reparse_tag", 0) != _JUNCTION


_JUNCTION = 0xA0000003  # a link of Windows that lstat reports as a folder


def read_own(path: Path) -> bytes:
    """Content of an ordinary file, opened without following a link. Raises OSError."""
    handle = os.open(path, os.O_RDONLY | NO_LINK | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(handle, "rb") as file:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL), str(path))
        return file.read(MOST_OWN)


def require_own_json(path: Path, keys: Iterable[str]) -> None:
    """Raise FileError for an existing file that is not a JSON object with these keys, so that it is not overwritten."""
    import json

    _require_own(path, lambda data: json.loads(data).keys() >= set(keys))


def require_own_csv(path: Path, columns: Iterable[str]) -> None:
    """Raise FileError for an existing file that is not a table with these columns, so that it is not overwritten."""
    _require_own(path, lambda data: data.split(b"\n", 1)[0].decode().rstrip("\r") == ",".join(columns))


def _require_own(path: Path, is_own: Callable[[bytes], bool]) -> None:
    if _permissions(path, _target(path), in_place=False) is None:
        return
    try:
        is_replaceable = is_own(read_own(path))
    except (OSError, ValueError, AttributeError, RecursionError):
        is_replaceable = False
    if not is_replaceable:
        _refuse(path, "written", "it belongs to another program; choose another folder or name")


def listed(handle: int, mark: str) -> list[str] | None:
    """Lines of an open list after its first line, the mark; None where the first line is another one."""
    os.lseek(handle, 0, os.SEEK_SET)
    data = b"".join(iter(lambda: os.read(handle, 1 << 20), b""))
    first, *lines = data.decode("utf-8", "replace").split("\n")
    return lines if first == mark else None


def _ordinary(path: AnyPath, status: os.stat_result, done: str) -> None:
    if stat.S_ISDIR(status.st_mode):
        _refuse(path, done, "it is a folder; name a file")
    if not stat.S_ISREG(status.st_mode):
        _refuse(path, done, "it is not an ordinary file; name one")


@contextmanager
def as_file_error(path: AnyPath, done: str) -> Iterator[None]:
    """Context that raises a FileError of one line for an error of the system."""
    try:
        yield
    except OSError as error:
        text = error.strerror or type(error).__name__
        reason = _REASONS.get(error.errno or 0, f"{text}; choose another place")
        _refuse(path, done, reason, error)
    except UnicodeEncodeError as error:
        _refuse(path, done, "it contains characters that UTF-8 cannot encode; remove them", error)
    except ValueError as error:  # a null character
        _refuse(path, done, "this is no file name; choose another", error)


def _refuse(path: AnyPath, done: str, reason: str, cause: Exception | None = None) -> NoReturn:
    text = os.fspath(path)
    shown = text if text and text.isprintable() else repr(text)
    raise FileError(f"{shown}: cannot be {done}: {reason}") from cause


# -- folders that belong to the program -------------------------------------------------------------------------


LIST = "kindyna-run"
_ROW = re.compile(r"([0-9a-f]{64})  ([0-9]{5}\.npz)")
_BINARY = getattr(os, "O_BINARY", 0)


def _sha256(data: bytes) -> str:
    import hashlib  # imported here to save start-up time

    return hashlib.sha256(data).hexdigest()


class OwnFolder:
    """A folder that the program creates, fills and deletes; it need not exist yet."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._mark = f"KINDYNA run {path.name}"
        self._hashes: dict[str, str] = {}

    def is_own(self) -> bool:
        """Whether the program has created the folder; its list is read again."""
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
        """Whether the folder does not exist yet, or is the program's with nothing but listed files, and is not a link."""
        if not os.path.lexists(self.path):
            return is_folder(self.path.parent) or not os.path.lexists(self.path.parent)
        if not self.is_own():
            return False
        with os.scandir(self.path) as entries:
            names = {LIST, *self._hashes}
            return all(entry.name in names and entry.is_file(follow_symlinks=False) for entry in entries)

    def write(self, name: str, data: bytes) -> None:
        """Write a new file, or replace a listed one. Raises FileError."""
        with as_file_error(self.path, "written"):
            if not os.path.lexists(self.path):
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self.path.mkdir()
                self._put(LIST, self._mark.encode(), os.O_CREAT | os.O_EXCL)
            if os.path.lexists(self.path / name) and (name in self._hashes or (self.is_own() and name in self._hashes)):
                remove(self.path / name)  # damaged, or of another process
            self._hashes[name] = _sha256(data)
            self._put(LIST, f"\n{self._hashes[name]}  {name}".encode(), os.O_APPEND)
            self._put(name, data, os.O_CREAT | os.O_EXCL)

    def _put(self, name: str, data: bytes, how: int) -> None:
        handle = os.open(self.path / name, os.O_WRONLY | NO_LINK | _BINARY | how, 0o666)
        with open(handle, "wb") as file:
            file.write(data)

    def read(self, name: str) -> bytes | None:
        """Content of a file as it was written; None where it is not listed, is missing, or has changed."""
        with suppress(OSError):
            data = read_own(self.path / name) if name in self._hashes else b""
            if _sha256(data) == self._hashes.get(name):
                return data
        return None

    def delete(self) -> None:
        """Delete the listed files, and the list and the folder where nothing else remains."""
        if self.is_own():
            remove_listed(self.path, self._hashes)
            self._hashes = {}
            with suppress(OSError):
                if os.listdir(self.path) == [LIST]:
                    remove(self.path / LIST)
                    self.path.rmdir()
