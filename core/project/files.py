"""Reading and writing files: whole or not at all, and every refusal is one clear line."""

from __future__ import annotations

import errno
import hashlib
import os
import re
import stat
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import NoReturn

from core.bounds import BYTES
from core.errors import FileError

# -- lock files -------------------------------------------------------------------------------------------------


_BUSY = (errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK)
NO_LOCKS = (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL)
"""Numbers of the error on file systems that have no locks."""
NO_LINK = getattr(os, "O_NOFOLLOW", 0)
"""Flag of ``os.open``: an error where the file is a symbolic link."""


def hold(path: str | os.PathLike[str], *, create: bool = True) -> int | None:
    """Make a lock file, or open one that exists, and hold it: its handle, or None where another process or this one holds it.

    The system gives the lock free with the handle, so also where the process is killed. Raises OSError where the file
    cannot be made or is a link, and one of ``NO_LOCKS`` where the file system has no locks.
    """
    handle = os.open(path, os.O_RDWR | (os.O_CREAT if create else 0) | NO_LINK, 0o600)
    try:
        held = _lock(handle) and _still_there(path, handle)
    except BaseException:
        os.close(handle)
        raise
    if not held:
        os.close(handle)
        return None
    return handle


def _still_there(path: str | os.PathLike[str], handle: int) -> bool:
    """False where it was taken away by another between making and locking."""
    try:
        return os.path.samestat(os.fstat(handle), os.lstat(path))
    except FileNotFoundError:
        return False


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
        errno.ENOTDIR: "a file stands where a folder should be; choose another folder",
        errno.EEXIST: "a file stands where a folder should be; choose another folder",
        errno.EISDIR: "it is a folder; name a file",
        errno.EACCES: "permission denied; change its permissions or choose another place",
        errno.EPERM: "permission denied; change its permissions or choose another place",
        errno.EROFS: "the disk is read-only; choose another place",
        errno.ENOSPC: "the disk is full; free some space or choose another place",
        errno.EDQUOT: "your share of the disk is full; free some space or choose another place",
        errno.EFBIG: "larger than the disk's limit for a file; choose another place",
        errno.ENAMETOOLONG: "the name is too long; shorten it",
        errno.ELOOP: "its symbolic links lead in a circle; mend them",
        errno.EIO: "the disk does not answer; check it",
    }
)


_inputs: set[tuple[int, int]] | None = None  # device and number of each file that the command at work has read


@contextmanager
def inputs_kept() -> Iterator[None]:
    """Within it no file that was read is written over, but in place: a name typed twice costs nobody a measured table."""
    global _inputs
    before, _inputs = _inputs, set()
    try:
        yield
    finally:
        _inputs = before


def read_bytes(path: AnyPath, most_bytes: int = BYTES) -> bytes:
    """What a file holds. Raises FileError where it is missing, no ordinary file, not to be read or too large."""
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
    """The text of a UTF-8 file, without its byte order mark.

    Raises FileError where it is missing, no ordinary file, not to be read, too large or no UTF-8.
    """
    data = read_bytes(path, most_bytes)
    try:
        return data.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        _refuse(path, "read", f"not UTF-8 text (byte {error.start + 1}); save it as UTF-8 text", error)


def write(path: AnyPath, data: bytes | str, *, in_place: bool = False) -> None:
    """Write one file, whole or not at all; permissions are kept, symbolic links followed to their target.

    in_place: it is to be changed, whether it was read or not. Raises FileError where it cannot be written; then nothing has changed.
    """
    _replace_all({Path(path): data}, create_folders=False, in_place=in_place)


def write_all(folder: AnyPath, files: Mapping[str, Content]) -> None:
    """Write all files (name: content) or none; folders that are missing are created. A content of parts is written as its
    parts come; what making them raises is raised here. The user chose the names: symbolic links are followed.

    Raises FileError where one cannot be written; then nothing has changed.
    """
    _replace_all({Path(folder) / name: data for name, data in files.items()}, create_folders=True)


def write_into(folder: AnyPath, files: Mapping[str, Content], *, typed: str = "") -> None:
    """As ``write_all``, under names that the program chose, but the one that the user typed.

    Raises FileError also where one of the others is a symbolic link, or lies in a folder that is one.
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
    """First everything that can fail for lack of space or permission, under other names; then the moves.

    What is to be taken back or swept up is noted before it is made, so that an interrupt finds it noted.
    The stacks unwind from right to left: old contents back, other names swept up, new folders removed.
    """
    with ExitStack() as folders, ExitStack() as leftovers, ExitStack() as undo:
        others = _OtherNames(leftovers)
        targets = {path: _target(path) for path in files}
        if without_links is not None:
            _require_inside(targets, *without_links)
        modes = {path: _permissions(path, target, in_place) for path, target in targets.items()}
        made, identities = {}, {}
        for path, data in files.items():
            with as_file_error(path, "written"):
                if create_folders:
                    _create_folders(targets[path].parent, folders)
                made[path] = others.beside(targets[path])
                identities[path] = _write_new(made[path], data, modes[path])
        kept = {}
        if len(files) > 1:  # a single move needs no way back
            for path in (p for p in files if modes[p] is not None):
                with as_file_error(path, "written"):
                    kept[path] = others.beside(targets[path])
                    _keep(targets[path], kept[path])
        for path, target in targets.items():
            with as_file_error(path, "written"):
                if len(files) > 1:
                    undo.callback(_take_back, target, kept.get(path), identities[path])
                os.replace(made[path], target)
        undo.pop_all()
        folders.pop_all()
    for folder in {target.parent for target in targets.values()}:
        _sync(folder)


def _target(path: Path) -> Path:
    """Where the links lead, so that a link stays a link."""
    with as_file_error(path, "written"):
        return Path(os.path.realpath(path))


def _require_inside(targets: Mapping[Path, Path], folder: Path, typed: str) -> None:
    """Raises FileError for a file other than the typed one to which a link inside of the folder leads."""
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
            _refuse(path, "written", "it is what is read here; choose another name")
        effective = os.access in os.supports_effective_ids
        if not os.access(target, os.W_OK, effective_ids=effective):  # a move would not mind
            _refuse(path, "written", "it is write-protected; change its permissions or choose another name")
        return stat.S_IMODE(status.st_mode)


class _OtherNames:
    """Free names beside targets, each noted to be swept up: ``.kindyna-RUN-1.tmp``, ``.kindyna-RUN-2.tmp`` ...

    In each folder a lock file ``.kindyna-RUN.tmp`` is made before them, held, and removed after them. It lists them after a line
    that marks it: names in it were left behind by a process that was killed where nobody holds it.
    """

    def __init__(self, leftovers: ExitStack) -> None:
        self._leftovers = leftovers
        self._runs: dict[Path, tuple[str, int | None]] = {}  # with the handle of the lock
        self._number = 0

    def beside(self, target: Path) -> Path:
        folder = target.parent
        if folder not in self._runs:
            sweep(folder)
            self._runs[folder] = self._begin(folder)
        self._number += 1
        run, lock = self._runs[folder]
        other = folder / f".kindyna-{run}-{self._number}.tmp"
        if lock is not None:
            os.write(lock, f"\n{other.name}".encode())
        self._leftovers.callback(remove, other)
        return other

    def _begin(self, folder: Path) -> tuple[str, int | None]:
        while True:
            run = os.urandom(8).hex()
            lock = folder / f".kindyna-{run}.tmp"
            self._leftovers.callback(remove, lock)
            try:
                handle = hold(lock)
            except OSError as error:
                if error.errno not in NO_LOCKS:
                    raise
                return run, None
            if handle is not None:  # else another's sweep was quicker
                self._leftovers.callback(os.close, handle)
                os.write(handle, _mark(run).encode())
                return run, handle


_OTHER_NAME = re.compile(r"\.kindyna-([0-9a-f]{16})(-\d+)?\.tmp")


def _mark(run: str) -> str:
    """First line of a lock file: no other program writes it."""
    return f"KINDYNA write {run}"


def sweep(folder: AnyPath, *, private: bool = False) -> None:
    """Remove what killed writes have left in a folder: the names that their lock files list. The names of a write that still
    runs stay, and files of the user that are called so.

    private: the folder is the program's alone, where the name proves whose a file is.
    """
    with suppress(OSError):
        matches = [match for name in os.listdir(folder) if (match := _OTHER_NAME.fullmatch(name))]
        for run in {match[1] for match in matches}:
            with suppress(OSError):
                _sweep(Path(folder), run, {match[0] for match in matches if match[1] == run}, private)


def _sweep(folder: Path, run: str, names: set[str], private: bool) -> None:
    lock = folder / f".kindyna-{run}.tmp"
    handle = hold(lock, create=private)
    if handle is None:
        return
    try:
        rows = listed(handle, _mark(run))
        if private or rows is not None:
            for name in sorted(names if private else names.intersection(rows or ())):
                remove(folder / name)
            remove(lock)
    finally:
        os.close(handle)


def _write_new(path: Path, data: Content, mode: int | None) -> Identity:
    whole = data.encode() if isinstance(data, str) else data
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    handle = os.open(path, flags, 0o666 if mode is None else mode)
    try:
        for part in [whole] if isinstance(whole, bytes) else whole:
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
    """Have the disk keep the names in a folder as they are now; some systems cannot, and do so by themselves."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _keep(target: Path, other: Path) -> None:
    """A second name for the old content; a copy where the disk knows no second names."""
    try:
        os.link(target, other)
    except OSError:
        import shutil  # slow to import, and few saves keep a copy

        shutil.copy2(target, other)


def _take_back(target: Path, kept: Path | None, identity: Identity) -> None:
    if kept is None:
        remove(target, identity)
    else:
        with suppress(OSError):
            os.replace(kept, target)


def _create_folders(folder: Path, undo: ExitStack) -> None:
    missing = []
    while not folder.exists():
        missing.append(folder)
        folder = folder.parent
    for each in reversed(missing):
        undo.callback(_remove_folder, each)
        each.mkdir(exist_ok=True)


def _remove_folder(path: Path) -> None:
    with suppress(OSError):  # someone else may use it by now
        path.rmdir()


# -- files of the program's own -----------------------------------------------------------------------------

Identity = tuple[int, int]
"""Device and number of a file."""

MOST_OWN = 1 << 30
"""Bytes of such a file."""


def remove(path: Path, identity: Identity | None = None) -> None:
    """Delete a file that the program has written: nothing else deletes a file. A link, a folder, what is no ordinary file and what lies
    in a folder that is a link stays, and a file of another identity where one is given."""
    with suppress(OSError):
        status = os.lstat(path)
        if (
            stat.S_ISREG(status.st_mode)
            and identity in (None, (status.st_dev, status.st_ino))
            and is_folder(path.parent)
        ):
            os.unlink(path)


def remove_listed(folder: Path, names: Iterable[str]) -> None:
    """Delete the files of a folder that a list of the program's own names, and the folders in it where they alone were."""
    for name in names:
        path = folder / name
        remove(path)
        while path.parent != folder:
            path = path.parent
            _remove_folder(path)


def is_folder(path: Path) -> bool:
    """Whether it is a folder, and no link to one."""
    try:
        status = os.lstat(path)
    except OSError:
        return False
    return stat.S_ISDIR(status.st_mode) and getattr(status, "st_reparse_tag", 0) != _JUNCTION


_JUNCTION = 0xA0000003  # of Windows: a link that lstat takes for a folder


def read_own(path: Path) -> bytes:
    """What an ordinary file holds, opened without following a link. Raises OSError."""
    handle = os.open(path, os.O_RDONLY | NO_LINK | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(handle, "rb") as file:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL), str(path))
        return file.read(MOST_OWN)


def require_own_json(path: Path, keys: Iterable[str]) -> None:
    """Raises FileError for a file that is no JSON object of the program's, which has these keys: it is not replaced unasked."""
    import json

    if _permissions(path, _target(path), in_place=False) is None:
        return
    try:
        own = json.loads(read_own(path)).keys() >= set(keys)
    except (OSError, ValueError, AttributeError, RecursionError):
        own = False
    if not own:
        _refuse(path, "written", "it belongs to something else; choose another folder or name")


def listed(handle: int, mark: str) -> list[str] | None:
    """The lines of an open list of the program's own behind the first, its mark; None where another line is the first."""
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
    """Raise FileError, in one line, for an error of the system."""
    try:
        yield
    except OSError as error:
        text = error.strerror or type(error).__name__
        reason = _REASONS.get(error.errno or 0, f"{text}; choose another place")
        _refuse(path, done, reason, error)
    except UnicodeEncodeError as error:
        _refuse(path, done, "it holds characters that UTF-8 does not have; remove them", error)
    except ValueError as error:  # a null character
        _refuse(path, done, "that is no file name; choose another", error)


def _refuse(path: AnyPath, done: str, reason: str, cause: Exception | None = None) -> NoReturn:
    text = os.fspath(path)
    shown = text if text and text.isprintable() else repr(text)
    raise FileError(f"{shown}: cannot be {done}: {reason}") from cause


# -- A folder that the program makes, fills and deletes by itself -----------------------------------------------


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
