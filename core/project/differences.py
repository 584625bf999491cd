"""Differences of two designs, value by value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from core.design import Design
from core.errors import MISSING


class ValueDifference(NamedTuple):
    """A value that differs: its path as in the file, and the values before and after.

    A value is MISSING where there is none; for an added or removed row of a list (`motion.segments[3]`) the other one is the row.
    """

    path: str
    before: Any
    after: Any


def differences(before: Design | None, after: Design) -> list[ValueDifference]:
    """All values that differ, in the order of the file; all values of `after` where there is no design before.

    Rows of lists are matched where they are equal, and between these in their order. The index in a path is that in `after`, or
    that in `before` for a removed row.
    """
    from core.project.writing import to_table  # late: few commands write or compare

    tables = [{} if design is None else to_table(design) for design in (before, after)]
    for table in tables:
        table.pop("format", None)  # a key of the file, not of the design
    return list(_compare("", *tables))


def _compare(path: str, before: Any, after: Any) -> Iterator[ValueDifference]:
    if _is_table(before) and _is_table(after):
        yield from _tables(path, {} if before is MISSING else before, {} if after is MISSING else after)
    elif _is_rows(before) and _is_rows(after):
        yield from _rows(path, [] if before is MISSING else before, [] if after is MISSING else after)
    elif before != after:
        yield ValueDifference(path, before, after)


def _tables(path: str, before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[ValueDifference]:
    for key in {**before, **after}:
        below = f"{path}.{key}" if path else key
        yield from _compare(below, before.get(key, MISSING), after.get(key, MISSING))


def _rows(path: str, before: Sequence[Any], after: Sequence[Any]) -> Iterator[ValueDifference]:
    from difflib import SequenceMatcher

    matcher = SequenceMatcher(None, [repr(row) for row in before], [repr(row) for row in after], autojunk=False)
    for _, i, i_end, j, j_end in matcher.get_opcodes():
        common = min(i_end - i, j_end - j)
        for k in range(common):
            yield from _compare(f"{path}[{j + k}]", before[i + k], after[j + k])
        yield from (ValueDifference(f"{path}[{k}]", before[k], MISSING) for k in range(i + common, i_end))
        yield from (ValueDifference(f"{path}[{k}]", MISSING, after[k]) for k in range(j + common, j_end))


def _is_table(value: Any) -> bool:
    return value is MISSING or isinstance(value, Mapping)


def _is_rows(value: Any) -> bool:
    if value is MISSING:
        return True
    return isinstance(value, Sequence) and bool(value) and all(isinstance(row, Mapping) for row in value)
