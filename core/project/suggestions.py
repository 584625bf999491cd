"""Confirmation of suggestions for misspelled keys and words: each is put into the tables of the file, which are read again."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from core.errors import DesignError, Fault
from core.project.reading_faults import spelled

MOST = 8  # confirmed suggestions; fewer for a large file, which is read again for each
_LARGE = 20_000  # most entries read again in total
_MEANT = re.compile(r" \(did you mean '([^']{1,60})'\?\)")

Tables = Mapping[str, Any]


def confirmed(faults: Sequence[Fault], table: Tables, read: Callable[[Tables], object]) -> list[Fault]:
    """Faults of a file without the suggestions that `read` refuses, or that are too many to be confirmed."""
    meant = [_MEANT.search(fault.problem) for fault in faults]
    left = max(1, min(MOST, _LARGE // (1 + _entries(table)))) if any(meant) else 0
    result = []
    for fault, match in zip(faults, meant, strict=True):
        if match is not None:
            left -= 1
            if left < 0 or not _is_accepted(fault, match[1], table, read):
                fault = replace(fault, problem=fault.problem.replace(match[0], ""))
        result.append(fault)
    return result


def _entries(value: Any) -> int:
    inner = value.values() if isinstance(value, Mapping) else value if isinstance(value, list | tuple) else ()
    return 1 + sum(map(_entries, inner))


def _is_accepted(fault: Fault, word: str, table: Tables, read: Callable[[Tables], object]) -> bool:
    """Whether the entry has no fault with the suggested word as its key or value."""
    steps = [int(i) if i else name for name, i in re.findall(r"([^.\[\]]+)|\[(\d+)\]", fault.path)]
    renames, path = fault.problem.startswith("unknown key"), fault.path
    if renames:
        path = ".".join([*fault.path.rpartition(".")[:1], word]).lstrip(".")
    try:
        read(_with(table, steps, word, renames))
    except (KeyError, IndexError, TypeError):  # the suggested key exists, or the path leads through no table
        return False
    except DesignError as error:
        return all(f.path != path and not f.path.startswith((f"{path}.", f"{path}[")) for f in error.faults)
    return True


def _with(value: Any, steps: Sequence[str | int], word: str, renames: bool) -> Any:
    """Tables with one entry replaced, its value or its key. Raises KeyError where it is missing, or the new key exists."""
    step, *rest = steps
    if isinstance(value, Mapping):
        key = next((key for key in value if spelled(key) == step), None)
        if key is None or (renames and not rest and word in value):
            raise KeyError(step)
        return {
            (word if renames and not rest and each == key else each): (
                inner if each != key or (renames and not rest) else _with(inner, rest, word, renames) if rest else word
            )
            for each, inner in value.items()
        }
    rows = list(value)
    rows[int(step)] = _with(rows[int(step)], rest, word, renames) if rest else word
    return rows
