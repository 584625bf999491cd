"""The process and its system: memory that it keeps; how it ends by an interrupt, a reader that goes away, a disk that is full,
in one line at most, never a traceback."""

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
from typing import Any, TextIO

# -- parts of a room that few commands need ---------------------------------------------------------------------


def lazy_attributes(room: str, *modules: str) -> Callable[[str], Any]:
    """``__getattr__`` of a room whose other modules offer names too, imported one after the other until one has the name. The
    room lists these names for readers and the type check where ``TYPE_CHECKING``. None may be that of a module."""

    def read(name: str) -> Any:
        if not name.startswith("__"):
            for module in modules:
                there = import_module(f"{room}.{module}")
                if hasattr(there, name):
                    setattr(sys.modules[room], name, found := getattr(there, name))
                    return found
        raise AttributeError(f"module {room!r} has no attribute {name!r}")

    return read


# -- where the program's own files are --------------------------------------------------------------------------


_ROOT = Path(__file__).resolve().parents[1]


def resources() -> Path:
    """The folder of examples, materials, help, icons and translations."""
    installed = _ROOT / "kindyna_gui" / "resources"
    return installed if installed.is_dir() else _ROOT / "resources"


# -- what a terminal would obey, or hide, is written out before it is printed -----------------------------------


_OBEYED = r"[^\n\t\x20-\x7e\xa0-\U0010ffff]|[\xad\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ud800-\udfff]"
"""Control characters but line end and tabulator, marks that turn or join text, and halves of characters."""


def harmless(text: str) -> str:
    """The text with such characters as JSON spells them, ``\\u009b``."""
    if all(line.isprintable() for line in text.split("\n")):  # as nearly all is; the pattern takes 3 ms to compile
        return text
    return re.sub(_OBEYED, lambda match: f"\\u{ord(match[0]):04x}", text)


class _Stream:
    """A stream that writes only what is harmless; in all else the stream behind it."""

    def __init__(self, behind: TextIO) -> None:
        self._behind = behind

    def write(self, text: str) -> int:
        self._behind.write(harmless(text))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._behind, name)


@contextmanager
def harmless_output() -> Iterator[None]:
    """All that is printed on standard output and standard error is harmless to the terminal."""
    streams: list[Any] = [None if stream is None else _Stream(stream) for stream in (sys.stdout, sys.stderr)]
    with redirect_stdout(streams[0]), redirect_stderr(streams[1]):
        yield


# -- the process and its system ---------------------------------------------------------------------------------


DONE, NOTHING_DONE, INTERRUPTED = 0, 2, 130


@contextmanager
def importing() -> Iterator[None]:
    """An interrupt (Ctrl+C) while the modules of the program are imported ends it quietly, with exit code 130."""
    with nothing_collected():
        try:
            before = signal.signal(signal.SIGINT, lambda *_: os._exit(INTERRUPTED))
        except ValueError:  # not the main thread, which alone may change that
            yield
            return
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)


@contextmanager
def nothing_collected() -> Iterator[None]:
    """While modules are imported no garbage is searched for, and what came with them is not searched afterwards either: it stays
    as long as the process. Of the command ``check`` these searches were a tenth."""
    before, collects = len(sys.modules), gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if len(sys.modules) > before:
            gc.freeze()
        if collects:
            gc.enable()


@lru_cache(maxsize=1)
def end_at_once() -> None:
    """At the end of the process no garbage is searched for: its memory goes with it. Every command calls it."""
    atexit.register(gc.freeze)


def exit_code(run: Callable[[], int]) -> int:
    """Run the program; its exit code, once all that it printed is written, harmless to the terminal."""
    try:
        with harmless_output():
            try:
                code = run()
            except SystemExit as stop:
                code = int(stop.code or 0)
        _flush()
        return code
    except BrokenPipeError:  # the reader went away; nothing is left to say to it
        _give_up_printing()
        return DONE
    except OSError as error:
        _give_up_printing()
        place = error.filename or "standard output"
        _say(f"{place}: {(error.strerror or str(error)).lower()}; choose another place, or make room there")
        return NOTHING_DONE
    except KeyboardInterrupt:
        _say("interrupted")
        return NOTHING_DONE


def _flush() -> None:
    if sys.stdout is not None:
        sys.stdout.flush()


def _give_up_printing() -> None:
    """What is still to be printed goes nowhere, or Python would try to write it once more at its end."""
    with suppress(OSError, ValueError):  # a stream that is no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _say(line: str) -> None:
    with suppress(OSError):
        print(line, file=sys.stderr)


_TRIM_THRESHOLD, _MMAP_THRESHOLD, _MOST_ARENAS = -1, -3, -8  # of glibc's mallopt
_KEPT, _OWN_PAGES = 128 << 20, 32 << 20  # [bytes]


@lru_cache(maxsize=1)
def keep_freed_memory() -> None:
    """Tell the C library to keep up to 128 MB of freed memory instead of giving it back at once, and to keep it in one place.

    A stage makes some fifty arrays of 30 to 200 kB and drops most of them: by default each of their pages goes back to
    the system and comes anew, zeroed, with the next stage. The lift's linkage and profile at 3600 angles cost 66 page faults
    and 0.80 ms so, none and 0.69 ms with this (medians, 2 cores, glibc 2.36); a block of many designs, of about 100 MB, costs 25,000 and
    twice the time. Nor does each thread that computes beside the window
    get a heap of its own, as it does by default, and leaves behind full of holes: a window in use grows for ever so. Every
    command and every window call it. Other C libraries have no such setting, and nothing happens.
    """
    if not sys.platform.startswith("linux"):
        return
    import ctypes

    try:
        adjust: Any = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError):
        return
    adjust(_MOST_ARENAS, 1)
    adjust(_TRIM_THRESHOLD, _KEPT)
    adjust(_MMAP_THRESHOLD, _OWN_PAGES)
