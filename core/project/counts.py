"""Counts of a design file, bounded before it is read: what is larger than any design is refused in one line."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

from core.bounds import DIGITS, FIELD, NESTING
from core.design.rules import MOST_KEYS, count_fault
from core.errors import MISSING, DesignError, Fault
from core.project.messages import spelled

MARKS: Mapping[str, tuple[str, int]] = MappingProxyType(
    {"=": ("entries", 30_000), "{": ("tables", 15_000), ",": ("values", 100_000), "\n[": ("headers", 15_000)}
)
"""Mark of TOML -> what it stands before or between, and how many of them a file may have. 3,600 segments take a third."""

DEEPEST = 12  # tables and lists in each other
MOST_DIGITS = 4300  # of a whole number that Python reads, and says that it is too large
MOST_KEY_PARTS = 50  # a.b.c = ... : tomllib's time grows with the square of the parts
_TEXT = re.compile(
    r'''"""(?:[^"\\]++|\\.|"(?!""))*+(?:"{3,5}|\Z)|"(?:[^"\\\n]++|\\[^\n])*+"?|#[^\n]*+'''
    r"""|'{3}(?:[^']++|'(?!''))*+(?:'{3,5}|\Z)|'[^'\n]*+'?""",
    re.DOTALL,
)
"""A text or a comment of TOML, to its end or that of the file."""


def require_few_marks(text: str, source: str) -> None:
    """Raises DesignError for a text that would take long to parse: by its headers, then by its marks."""
    headers = Counter(name.strip() for name in re.findall(r"(?m)^[ \t]*\[\[([^\[\]\n]*)\]\]", text))
    for name, count in headers.items():
        if fault := count_fault(name, count):
            raise DesignError([fault])
    for mark, (what, most) in MARKS.items():
        if (count := text.count(mark)) > most:
            problem = f"{count} {what} ({mark.strip()}) are too many for a design"
            raise DesignError([Fault(source, MISSING, problem, f"at most {most}")])
    bare = _TEXT.sub(_emptied, text)
    for problem, at, allowed in _beyond(bare):
        line = bare.count("\n", 0, at) + 1
        raise DesignError([Fault(source, MISSING, f"not TOML: {problem} (at line {line})", allowed)])


def _emptied(text: re.Match[str]) -> str:
    """A text without what it holds, in as many lines; one that is too long as a word that is."""
    if text[0][0] != "#" and len(text[0]) > FIELD:
        return "_" * (FIELD + 1)
    return f'""{chr(10) * text[0].count(chr(10))}' if text[0][0] != "#" else ""


def _beyond(bare: str) -> Iterator[tuple[str, int, str]]:
    """Problem, place and what is allowed, of a file without its texts and comments."""
    deep = 0
    for mark in re.finditer(r"[\[\]{}]", bare):
        deep += 1 if mark[0] in "[{" else -1
        if deep > NESTING:
            yield "nested too deeply", mark.start(), f"at most {NESTING} tables and lists in each other"
    for word in re.finditer(r"[\w+.-]++", bare):
        if (length := word.end() - word.start()) > FIELD:
            yield "a text too long", word.start(), f"at most {FIELD} characters"
        if length > MOST_DIGITS and word[0].lstrip("+-")[:1].isdigit():
            yield "a number of too many digits", word.start(), f"at most {DIGITS}"
    for key in re.finditer(r"[^\n{},\[\]=]++", bare):
        if key[0].count(".") > MOST_KEY_PARTS:
            yield f"a key of more than {MOST_KEY_PARTS} parts", key.start(), f"at most {MOST_KEY_PARTS}"


def require_few_entries(table: Mapping[str, Any]) -> None:
    """Raises DesignError for the first table of too many keys, or list of too many entries."""
    for fault in _faults(table, "", DEEPEST):
        raise DesignError([fault])


def _faults(value: Any, path: str, deeper: int) -> Iterator[Fault]:
    if not deeper:
        return  # nothing of a design stands there
    if isinstance(value, Mapping):
        if len(value) > MOST_KEYS:
            yield Fault(path, MISSING, f"{len(value)} keys are too many for a table", f"at most {MOST_KEYS}")
            return
        for key, inner in value.items():
            yield from _faults(inner, f"{path}.{spelled(key)}" if path else spelled(key), deeper - 1)
    elif isinstance(value, list | tuple):
        if fault := count_fault(path, len(value)):
            yield fault
            return
        for i, inner in enumerate(value):
            if isinstance(inner, Mapping | list | tuple):
                yield from _faults(inner, f"{path}[{i}]", deeper - 1)
