"""The process: lazy imports, resources, safe terminal output, exit codes, garbage collection and freed memory.

An interrupt, a closed pipe or a full disk ends the program with one line at most, without a traceback.
"""

from __future__ import annotations

import atexit
import gc
import os
import re
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, TextIO

# -- lazy imports -----------------------------------------------------------------------------------------------


def lazy_attributes(package: str, *modules: str) -> Callable[[str], Any]:
    """``__getattr__`` of a package that imports some of its modules only when one of their names is used.

    The modules are imported one after the other until one has the name. The package lists these names under
    ``TYPE_CHECKING``; a name must differ from those of its modules.
    """

    def read(name: str) -> Any:
        if not name.startswith("__"):
            for module in modules:
                imported = import_module(f"{package}.{module}")
                if hasattr(imported, name):
                    setattr(sys.modules[package], name, value := getattr(imported, name))
                    return value
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    return read


# -- files of the program, and the user's folders ---------------------------------------------------------------


_ROOT = Path(__file__).resolve().parents[1]
"""The checkout; in an installed wheel the package ``kindyna``."""


def resources() -> Path:
    """The folder of examples, materials, help, icons and translations."""
    return _ROOT / "resources"


_DESKTOP = {
    "settings": ("XDG_CONFIG_HOME", ".config", "KINDYNA"),
    "cache": ("XDG_CACHE_HOME", ".cache", "KINDYNA"),
    "state": ("XDG_STATE_HOME", ".local/state", "kindyna"),
}
_USER_FOLDERS = {
    "win32": {
        "settings": ("APPDATA", "AppData/Roaming", "KINDYNA"),
        "cache": ("LOCALAPPDATA", "AppData/Local", "KINDYNA/Cache"),
        "state": ("LOCALAPPDATA", "AppData/Local", "KINDYNA"),
    },
    "darwin": {
        "settings": ("", "Library/Preferences", "KINDYNA"),
        "cache": ("", "Library/Caches", "KINDYNA"),
        "state": ("", "Library/Application Support", "KINDYNA"),
    },
}
"""System -> environment variable, folder of the user's home where that is not set, and the program's folder in it."""


def user_folder(kind: Literal["settings", "cache", "state"]) -> Path:
    """The program's folder of a user, by the convention of the system; it need not exist yet.

    In the cache is what can be computed again, in the state are log and recovery files.
    """
    variable, default, name = _USER_FOLDERS.get(sys.platform, _DESKTOP)[kind]
    named = Path(os.environ.get(variable, ""))
    return (named if named.is_absolute() else Path.home() / default) / name


# -- terminal output --------------------------------------------------------------------------------------------


_CONTROL_CHARACTERS = (
    r"[^\n\t\x20-\x7e\xa0-\U0010ffff]|[\xad\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ud800-\udfff]"
)
"""Control characters except line end and tabulator, marks that reverse or join text, and lone surrogates."""


def harmless(text: str) -> str:
    r"""Escape control characters as in JSON, ``\u009b``."""
    if all(line.isprintable() for line in text.split("\n")):  # the usual case; the pattern takes 3 ms to compile
        return text
    return re.sub(_CONTROL_CHARACTERS, lambda match: f"\\u{ord(match[0]):04x}", text)


class _Stream:
    """A text stream that escapes control characters; all else is passed to the wrapped stream."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        self._stream.write(harmless(text))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def _set_encodings() -> None:
    """Replace characters that an output cannot encode; UTF-8, as in files, where Windows has a code page for pipes."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            has_code_page = sys.platform == "win32" and not stream.isatty() and "PYTHONIOENCODING" not in os.environ
            stream.reconfigure(encoding="utf-8" if has_code_page else None, errors="replace")


@contextmanager
def harmless_output() -> Iterator[None]:
    """Escape control characters in all that is printed on standard output and standard error."""
    streams: list[Any] = [None if stream is None else _Stream(stream) for stream in (sys.stdout, sys.stderr)]
    with redirect_stdout(streams[0]), redirect_stderr(streams[1]):
        yield


# -- exit codes, garbage and memory -----------------------------------------------------------------------------


DONE, NOTHING_DONE, INTERRUPTED = 0, 2, 130


@contextmanager
def importing() -> Iterator[None]:
    """End the program quietly, with exit code 130, at an interrupt (Ctrl+C) while its modules are imported."""
    with without_garbage_collection():
        try:
            before = signal.signal(signal.SIGINT, lambda *_: os._exit(INTERRUPTED))
        except ValueError:  # only the main thread may set it
            yield
            return
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)


@contextmanager
def without_garbage_collection() -> Iterator[None]:
    """Suspend garbage collection while modules are imported, and exclude their objects from later collections.

    These objects last as long as the process; searching them took a tenth of the command ``check``.
    """
    before, was_enabled = len(sys.modules), gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if len(sys.modules) > before:
            gc.freeze()
        if was_enabled:
            gc.enable()


@lru_cache(maxsize=1)
def skip_last_collection() -> None:
    """Skip the garbage collection at the end of the process, which frees all memory anyway."""
    atexit.register(gc.freeze)


def exit_code(run: Callable[[], int]) -> int:
    """Run the program and write its output; returns the exit code."""
    _set_encodings()
    try:
        with harmless_output():
            try:
                code = run()
            except SystemExit as stop:
                code = int(stop.code or 0)
        _flush()
        return code
    except BrokenPipeError:  # the reading process has ended
        _discard_output()
        return DONE
    except OSError as error:
        _discard_output()
        target = error.filename or "standard output"
        _print_error(f"{target}: {(error.strerror or str(error)).lower()}; choose another folder, or free disk space")
        return NOTHING_DONE
    except KeyboardInterrupt:
        _print_error("interrupted")
        return NOTHING_DONE


def _flush() -> None:
    if sys.stdout is not None:
        sys.stdout.flush()


def _discard_output() -> None:
    """Discard pending output, which Python would else try to write once more at exit."""
    with suppress(OSError, ValueError):  # a stream that is no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _print_error(line: str) -> None:
    with suppress(OSError):
        print(line, file=sys.stderr)


_TRIM_THRESHOLD, _MMAP_THRESHOLD, _MOST_ARENAS = -1, -3, -8  # of glibc's mallopt
_RETAINED, _MAPPED_BLOCK = 128 << 20, 32 << 20  # [bytes]


@lru_cache(maxsize=1)
def keep_freed_memory() -> None:
    """Make glibc retain up to 128 MB of freed memory, in one heap for all threads.

    A stage allocates some fifty arrays of 30 to 200 kB and frees most of them. By default their pages return to the system,
    and the next stage gets them anew, zeroed: the linkage and profile of a lift at 3600 angles cost 66 page faults and
    0.80 ms, with this setting none and 0.69 ms (medians, 2 cores, glibc 2.36); a block of many designs, about 100 MB, costs
    25,000 page faults and twice the time. By default each thread also has a heap, which fragments, so that the window's
    memory grows without limit. Other C libraries have no such setting; there the function has no effect.

    The first study of a process calls it. Where the environment variable KINDYNA_KEEP_MEMORY is 0, as a program that only
    uses ``core`` may set it, the settings of the process remain as they are.
    """
    if sys.platform == "linux" and os.environ.get("KINDYNA_KEEP_MEMORY") != "0":
        import ctypes

        with suppress(AttributeError, OSError):
            adjust: Any = ctypes.CDLL(None).mallopt
            adjust(_MOST_ARENAS, 1)
            adjust(_TRIM_THRESHOLD, _RETAINED)
            adjust(_MMAP_THRESHOLD, _MAPPED_BLOCK)
