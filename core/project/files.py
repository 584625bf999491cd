"""Reading and writing files: whole or not at all, and every refusal is one clear line."""

from __future__ import annotations

import errno
import os
import re
import stat
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import MappingProxyType
from typing import NoReturn

from core.bounds import BYTES
from core.errors import FileError
from core.project.locks import NO_LOCKS, hold

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
    with _as_file_error(path, "read"):
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
    parts come; what making them raises is raised here.

    Raises FileError where one cannot be written; then nothing has changed.
    """
    _replace_all({Path(folder) / name: data for name, data in files.items()}, create_folders=True)


def _replace_all(files: Mapping[Path, Content], *, create_folders: bool, in_place: bool = False) -> None:
    """First everything that can fail for lack of space or permission, under other names; then the moves.

    What is to be taken back or swept up is noted before it is made, so that an interrupt finds it noted.
    The stacks unwind from right to left: old contents back, other names swept up, new folders removed.
    """
    with ExitStack() as folders, ExitStack() as leftovers, ExitStack() as undo:
        others = _OtherNames(leftovers)
        targets = {path: _target(path) for path in files}
        modes = {path: _permissions(path, target, in_place) for path, target in targets.items()}
        made = {}
        for path, data in files.items():
            with _as_file_error(path, "written"):
                if create_folders:
                    _create_folders(targets[path].parent, folders)
                made[path] = others.beside(targets[path])
                _write_new(made[path], data, modes[path])
        kept = {}
        if len(files) > 1:  # a single move needs no way back
            for path in (p for p in files if modes[p] is not None):
                with _as_file_error(path, "written"):
                    kept[path] = others.beside(targets[path])
                    _keep(targets[path], kept[path])
        for path, target in targets.items():
            with _as_file_error(path, "written"):
                if len(files) > 1:
                    undo.callback(_take_back, target, kept.get(path))
                os.replace(made[path], target)
        undo.pop_all()
        folders.pop_all()
    for folder in {target.parent for target in targets.values()}:
        _sync(folder)


def _target(path: Path) -> Path:
    """Where the links lead, so that a link stays a link."""
    with _as_file_error(path, "written"):
        return Path(os.path.realpath(path))


def _permissions(path: Path, target: Path, in_place: bool) -> int | None:
    """Permission bits of the file to be replaced, None where there is none."""
    with _as_file_error(path, "written"):
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

    In each folder a lock file ``.kindyna-RUN.tmp`` is made before them, held, and removed after them: names whose lock
    nobody holds were left behind by a process that was killed.
    """

    def __init__(self, leftovers: ExitStack) -> None:
        self._leftovers = leftovers
        self._runs: dict[Path, str] = {}
        self._number = 0

    def beside(self, target: Path) -> Path:
        folder = target.parent
        if folder not in self._runs:
            sweep(folder)
            self._runs[folder] = self._begin(folder)
        self._number += 1
        other = folder / f".kindyna-{self._runs[folder]}-{self._number}.tmp"
        self._leftovers.callback(_remove, other)
        return other

    def _begin(self, folder: Path) -> str:
        while True:
            run = os.urandom(8).hex()
            lock = folder / f".kindyna-{run}.tmp"
            self._leftovers.callback(_remove, lock)
            try:
                handle = hold(lock)
            except OSError as error:
                if error.errno not in NO_LOCKS:
                    raise
                return run
            if handle is not None:  # else another's sweep was quicker
                self._leftovers.callback(os.close, handle)
                return run


_OTHER_NAME = re.compile(r"\.kindyna-([0-9a-f]{16})(-\d+)?\.tmp")


def sweep(folder: AnyPath) -> None:
    """Remove what killed writes have left in a folder; the names of a write that still runs stay."""
    with suppress(OSError):
        found = [match for name in os.listdir(folder) if (match := _OTHER_NAME.fullmatch(name))]
        for run in {match[1] for match in found}:
            lock = Path(folder, f".kindyna-{run}.tmp")
            with suppress(OSError):
                handle = hold(lock)
                if handle is not None:
                    for match in found:
                        if match[1] == run:
                            _remove(Path(folder, match[0]))
                    _remove(lock)
                    os.close(handle)


def _write_new(path: Path, data: Content, mode: int | None) -> None:
    whole = data.encode() if isinstance(data, str) else data
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    handle = os.open(path, flags, 0o666 if mode is None else mode)
    try:
        for part in [whole] if isinstance(whole, bytes) else whole:
            rest = memoryview(part)
            while rest:
                rest = rest[os.write(handle, rest) :]
        os.fsync(handle)
    finally:
        os.close(handle)
    if mode is not None:
        os.chmod(path, mode)


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


def _take_back(target: Path, kept: Path | None) -> None:
    if kept is None:
        _remove(target)
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


def _remove(path: Path) -> None:
    with suppress(OSError):
        path.unlink()


def _remove_folder(path: Path) -> None:
    with suppress(OSError):  # someone else may use it by now
        path.rmdir()


def _ordinary(path: AnyPath, status: os.stat_result, done: str) -> None:
    if stat.S_ISDIR(status.st_mode):
        _refuse(path, done, "it is a folder; name a file")
    if not stat.S_ISREG(status.st_mode):
        _refuse(path, done, "it is not an ordinary file; name one")


@contextmanager
def _as_file_error(path: AnyPath, done: str) -> Iterator[None]:
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
