"""The log of errors in the program: files of limited size in the user's state folder, oldest entries first."""

from __future__ import annotations

import re
import traceback
from collections import Counter, deque
from pathlib import Path
from time import localtime, strftime

from core.process import user_folder

MOST_BYTES, OLDER_FILES = 256 * 1024, 2
PACKAGES = ("kindyna", "PySide6-Essentials", "pyqtgraph", "numpy", "scipy")
MOST_ACTIONS = 20  # actions that an entry lists
_OVERRIDE = re.compile(r"(Error calling Python override of [\w:]+\(\): )+")  # prefix of a message by Qt's bindings


def log_file() -> Path:
    """Return the log file; older ones in the same folder end in ``.1``, ``.2``."""
    return user_folder("state") / "kindyna.log"


def log_text() -> str:
    """Return the text of the log, the newest entry last; empty where nothing has failed."""
    newest = log_file()
    files = [newest.with_name(f"{newest.name}.{n}") for n in range(OLDER_FILES, 0, -1)]
    return "".join(f.read_text(encoding="utf-8", errors="replace") for f in (*files, newest) if f.is_file())


def report_text() -> str:
    """Return a report for support: versions, system, and the log."""
    import platform
    from importlib.metadata import PackageNotFoundError, version

    def version_of(name: str) -> str:
        try:
            return version(name)
        except PackageNotFoundError:
            return "not installed"

    rows = [f"{name} {version_of(name)}" for name in PACKAGES]
    header = [f"Python {platform.python_version()}, {platform.platform()}", ", ".join(rows)]
    return "\n".join((*header, "", log_text() or "Nothing has failed.", ""))


def short(error: BaseException) -> str:
    """Return an exception in one line: its type and its message."""
    message = " ".join(_OVERRIDE.sub("", str(error)).split())
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


class FaultLog:
    """Writes entries with time, last actions, state of the window, and traceback.

    The same error, by its type and the line that raised it, is written in full once; its 2nd, 4th, 8th ... occurrence takes
    one line, so that an error at every frame does not push its first entry out of the log.
    """

    def __init__(self) -> None:
        self._actions: deque[str] = deque(maxlen=MOST_ACTIONS)
        self._times: Counter[tuple[str, str, int]] = Counter()

    def note(self, action: str) -> None:
        """Remember an action of the user."""
        self._actions.append(f"{strftime('%H:%M:%S', localtime())}  {action}")

    def write(self, error: BaseException, state: str) -> None:
        """Write an entry with lines about the state of the window; nothing is raised where the file cannot be written."""
        steps = traceback.extract_tb(error.__traceback__)
        key = (
            (type(error).__name__, steps[-1].filename, steps[-1].lineno or 0)
            if steps
            else (type(error).__name__, "", 0)
        )
        self._times[key] += 1
        times = self._times[key]
        if times > 1:
            if times & (times - 1) == 0:
                self._put(f"{short(error)} (repeated, {times} times so far)")
            return
        actions = "\n".join(f"  {action}" for action in self._actions) or "  none"
        trace = "".join(traceback.format_exception(error)).rstrip()
        lines = f"{short(error)}\n{state}\nActions before, the last one at the end:\n{actions}\n{trace}".splitlines()
        self._put("\n    ".join(lines))

    def add(self, sentence: str) -> None:
        """Write what happened after an entry."""
        self._put(sentence)

    @staticmethod
    def _put(text: str) -> None:
        # imported here to save start-up time; the file is open only while it is written
        import logging
        from logging.handlers import RotatingFileHandler

        path = log_file()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            handler = RotatingFileHandler(path, maxBytes=MOST_BYTES, backupCount=OLDER_FILES, encoding="utf-8")
        except OSError:
            return
        handler.setFormatter(logging.Formatter("%(asctime)s  %(message)s"))
        handler.handle(logging.makeLogRecord({"msg": text}))
        handler.close()


__all__ = ["FaultLog", "log_file", "log_text", "short"]
