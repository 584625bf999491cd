"""A text of another program, told by its beginning or by a word, as a design."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from core.bounds import PROGRAM_BYTES
from core.frozen import frozen
from core.linkage_programs import linkage2, pmks, pyslvs
from core.linkage_programs.made import UNITS, Made, made
from core.linkage_programs.sketch import Sketch, refused


@frozen
class Program:
    """How a program's text begins, and what reads it."""

    title: str
    begins: Callable[[str], bool]
    read: Callable[[str], Sketch]


FORMATS: Mapping[str, Program] = MappingProxyType(
    {
        "pyslvs": Program("Pyslvs expression", lambda text: text.startswith(("M[", "#")), pyslvs.read),
        "linkage2": Program("Linkage file", lambda text: text.startswith("<"), linkage2.read),
        "pmks": Program("PMKS+ address", lambda text: bool(text), pmks.read),
    }
)


def decoded(data: bytes) -> str:
    """The text of a file: UTF-8, or as Linkage writes names, in the letters of Windows."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def read_linkage(
    text: str, format: str = "", *, name: str = "", units: str = "", mirror: bool = False, inputs: Sequence[str] = ()
) -> Made:
    """The design of a text; units: of its lengths, where it does not say; inputs: names of driven joints. Raises DesignError."""
    if len(text.encode()) > PROGRAM_BYTES:
        raise refused("text", "too long", f"at most {PROGRAM_BYTES / 1e6:g} MB")
    text = text.strip().removeprefix("\ufeff")
    row = FORMATS[format] if format else next((r for r in FORMATS.values() if r.begins(text)), None)
    if row is None:
        raise refused("text", "nothing to read", " | ".join(FORMATS))
    return made(row.read(text), name or row.title, units, mirror, inputs)


__all__ = ["FORMATS", "UNITS", "Program", "decoded", "read_linkage"]
