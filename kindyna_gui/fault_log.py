"""The log of the program's faults: a file of bounded size in the user's state folder, oldest entries first."""

from __future__ import annotations

import re
import traceback
from collections import Counter, deque
from pathlib import Path
from time import localtime, strftime

from kindyna_gui.places import state_folder

MOST_BYTES, OLDER_FILES = 256 * 1024, 2
PACKAGES = ("kindyna", "PySide6-Essentials", "pyqtgraph", "numpy", "scipy")
MOST_ACTIONS = 20  # that an entry lists
_OVERRIDE = re.compile(r"(Error calling Python override of [\w:]+\(\): )+")  # what Qt's bindings put before a message


def log_file() -> Path:
    """The file that faults are written to; older ones stand beside it as ``.1``, ``.2``."""
    return state_folder() / "kindyna.log"


def log_text() -> str:
    """What the log holds, the newest entry last; empty where nothing has failed."""
    newest = log_file()
    files = [newest.with_name(f"{newest.name}.{n}") for n in range(OLDER_FILES, 0, -1)]
    return "".join(f.read_text(encoding="utf-8", errors="replace") for f in (*files, newest) if f.is_file())


def report_text() -> str:
    """What somebody who is asked for help wants to know: versions, system, and the log."""
    import platform
    from importlib.metadata import PackageNotFoundError, version

    def of(name: str) -> str:
        try:
            return version(name)
        except PackageNotFoundError:
            return "not installed"

    rows = [f"{name} {of(name)}" for name in PACKAGES]
    head = [f"Python {platform.python_version()}, {platform.platform()}", ", ".join(rows)]
    return "\n".join((*head, "", log_text() or "Nothing has failed.", ""))


def short(error: BaseException) -> str:
    """An exception in one line: its type and its message."""
    message = " ".join(_OVERRIDE.sub("", str(error)).split())
    return f"{type(error).__name__}: {message}" if message else type(error).__name__


class FaultLog:
    """Writes entries: when, what was done before, the state of the window, the traceback.

    The same fault, by its type and by the line that raised it, is written in full once; then its 2nd, 4th, 8th ... time in
    one line, so that a fault repeated at every frame does not rotate its own first entry away.
    """

    def __init__(self) -> None:
        self._actions: deque[str] = deque(maxlen=MOST_ACTIONS)
        self._times: Counter[tuple[str, str, int]] = Counter()

    def note(self, action: str) -> None:
        """Remember what the user has just done."""
        self._actions.append(f"{strftime('%H:%M:%S', localtime())}  {action}")

    def write(self, error: BaseException, state: str) -> None:
        """Write an entry. state: lines about the window. Where the file cannot be written nothing is raised."""
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
                self._put(f"{short(error)} (the same again, {times} times by now)")
            return
        actions = "\n".join(f"  {action}" for action in self._actions) or "  nothing yet"
        trace = "".join(traceback.format_exception(error)).rstrip()
        lines = f"{short(error)}\n{state}\nDone before, the last at the end:\n{actions}\n{trace}".splitlines()
        self._put("\n    ".join(lines))

    def add(self, sentence: str) -> None:
        """What became of it, below the entry."""
        self._put(sentence)

    @staticmethod
    def _put(text: str) -> None:
        # only now: the window need not wait for these modules; and the file is open no longer than it must be
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
