"""Lock files: held while a process lives, free however it ends."""

from __future__ import annotations

import errno
import os
import sys

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
