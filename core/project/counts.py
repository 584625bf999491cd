"""Counts of a design file, bounded before it is read: what is larger than any design is refused in one line."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

from core.design.rules import MOST_KEYS, count_fault
from core.errors import MISSING, DesignError, Fault
from core.project.messages import spelled

MARKS: Mapping[str, tuple[str, int]] = MappingProxyType(
    {"=": ("entries", 30_000), "{": ("tables", 15_000), ",": ("values", 100_000), "\n[": ("headers", 15_000)}
)
"""Mark of TOML -> what it stands before or between, and how many of them a file may have. 3,600 segments take a third."""

DEEPEST = 12  # tables and lists in each other


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
