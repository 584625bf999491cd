"""Values of a design by the paths of its file: read, and changed all at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Any

from core.design.design import Design
from core.design.edits import edited
from core.design.paths import Entry, all_paths, entries, get, put, row_at, text_paths
from core.design.rules import faults
from core.errors import DesignError, Fault
from core.project.reading_faults import hinted
from core.units import NO_UNIT
from kindyna._checks import number, text, whole


@lru_cache(maxsize=16)
def file_values(design: Design) -> Mapping[str, Any]:
    """Return path -> value of every entry of the file, None where it is not given: names, then the order of the file."""
    single = {path: entry.value for path, entry in _entries(design)}
    paths, texts = list(all_paths(design)), set(text_paths(design))
    result = {path: get(design, path) for path in text_paths(design) if path not in paths}
    for path in paths:
        value = single[path] if path in single else get(design, path)
        if path in single or path in texts or _is_pair(value):
            result[path] = value
    return MappingProxyType(result)


def edited_design(design: Design, values: Mapping[str, Any]) -> Design:
    """Return a design with other values at paths that it has, all set at once, then judged.

    Raises
    ------
    TypeError, ValueError
        A value is not of the kind of its field, or not finite.
    DesignError
        With all faults of the new design.
    """
    present, known = dict(_entries(design)), file_values(design)
    new = {path: _typed(path, present.get(path), known[path], value) for path, value in values.items()}
    typed = {row_at(path)[1] for path in new if path.startswith("motion.segments[")}
    wrong = [fault for path, value in new.items() for fault in _unknown_word(path, present.get(path), value)]
    for fault in wrong:
        del new[fault.path]
    for path in sorted(new, key=lambda path: not isinstance(new[path], str)):  # words choose the fields
        if new[path] != known[path]:
            design = edited(design, path, new[path], typed)
    for path, value in new.items():
        if not isinstance(value, str):
            design = put(design, path, value)
    if wrong := [*wrong, *faults(design)]:
        raise DesignError(map(hinted, wrong))
    return design


def _entries(design: Design) -> Iterator[tuple[str, Entry]]:
    return ((entry.path, entry) for table in design.tables for entry in entries(design, table))


def _is_pair(value: Any) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and all(isinstance(part, float | int) for part in value)


def _unknown_word(path: str, entry: Entry | None, value: Any) -> Iterator[Fault]:
    """Return the fault of a word that its field does not have."""
    if entry is not None and isinstance(value, str) and not entry.info.admits(value):
        yield Fault(path, value, entry.info.problem, entry.info.allowed(NO_UNIT))


def _typed(path: str, entry: Entry | None, present: Any, value: Any) -> Any:
    """Return a value of the kind of its field. Raises TypeError, ValueError."""
    info = None if entry is None else entry.info
    if value is None and info is not None and info.optional:
        return None
    if isinstance(present, tuple):
        if isinstance(value, str) or not isinstance(value, Sequence) or len(value) != len(present):
            raise TypeError(f"{path} = {value!r}: {len(present)} numbers are needed")
        return tuple(number(f"{path}[{i}]", part) for i, part in enumerate(value))
    if info is None or info.choices or isinstance(present, str):
        return text(path, value)
    if info.flag:
        if not isinstance(value, bool):
            raise TypeError(f"{path} = {value!r}: True or False is needed, not {type(value).__name__}")
        return value
    return whole(path, value) if info.whole else number(path, value)
