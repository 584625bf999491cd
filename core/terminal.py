"""What a terminal would obey, or hide, is written out before it is printed: names and cells of files may hold anything."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import Any, TextIO

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
