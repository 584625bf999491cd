"""Suggestions for misspelled keys and words, confirmed: each is put into the file's tables, which are then read again."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from core.errors import DesignError, Fault
from core.project.reading_faults import spelled

MOST = 8  # suggestions that are confirmed; of a large file fewer, since each is one more reading
_LARGE = 20_000  # entries that are read again in all
_MEANT = re.compile(r" \(did you mean '([^']{1,60})'\?\)")

Tables = Mapping[str, Any]


def confirmed(faults: Sequence[Fault], table: Tables, read: Callable[[Tables], object]) -> list[Fault]:
    """The faults of a file, each suggestion left out that ``read`` refuses in its turn, or that is one too many to be confirmed."""
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
    """Whether the entry has no fault with this word as its key, or as its value."""
    steps = [int(i) if i else name for name, i in re.findall(r"([^.\[\]]+)|\[(\d+)\]", fault.path)]
    renames, path = fault.problem.startswith("unknown key"), fault.path
    if renames:
        path = ".".join([*fault.path.rpartition(".")[:1], word]).lstrip(".")
    try:
        read(_with(table, steps, word, renames))
    except (KeyError, IndexError, TypeError):  # the suggestion is there already, or the path leads through no table
        return False
    except DesignError as error:
        return all(each.path != path and not each.path.startswith((f"{path}.", f"{path}[")) for each in error.faults)
    return True


def _with(value: Any, steps: Sequence[str | int], word: str, renames: bool) -> Any:
    """The tables with one entry replaced: its value, or its key. Raises KeyError where there is none, or where the key is there already."""
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
