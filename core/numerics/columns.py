"""Columns: a number of a design that many designs have each for itself, so that one formula serves them all at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import reduce
from types import MappingProxyType
from typing import Any

import numpy as np


class Column(np.ndarray):
    """One value for each of many designs, or for each of their cam angles, in place of a plain number of a part.

    True where any of them is not 0, as a plain number is: what a part has at all, some design has; where the others have 0, the
    formula gives 0. A comparison has no truth of its own. A part that holds columns is equal only to itself.
    """

    __hash__ = object.__hash__  # type: ignore[assignment]

    def __bool__(self) -> bool:
        if self.dtype == bool and self.ndim:
            raise TypeError("a comparison of many designs is true of some of them")
        return bool(np.asarray(self).any())


def column(values: Any) -> Column:
    """Values (m,) as a column."""
    return np.asarray(values).view(Column)


def first_of(value: Any) -> Any:
    """A number; of many designs that of the first, for what all of them share."""
    return float(value[0]) if isinstance(value, Column) else value


def greatest(values: Sequence[Any]) -> Any:
    """The greatest of some numbers; of many designs a column."""
    many = any(isinstance(value, Column) for value in values)
    return column(reduce(np.maximum, values)) if many else max(values)


def one_by_one(function: Callable[[list[float]], float], values: Sequence[Any]) -> Any:
    """A function of plain numbers, of which some are columns (m,), for each design by itself."""
    return column([function(row) for row in np.array(np.broadcast_arrays(*values)).T.tolist()])


def taken(part: Any, owner: Any, made: dict[int, Any] | None = None) -> Any:
    """A part whose columns (m,) stand for designs, at angles (n,) that belong to the designs ``owner`` (n,): its columns are (n,); of one
    design, by its number, they are plain numbers.

    made: by the identity of a column what it became, so that what was shared stays so.
    """
    made = {} if made is None else made
    if isinstance(part, np.ndarray):
        if id(part) not in made:
            made[id(part)] = float(part[owner]) if isinstance(owner, int) else part[owner].view(Column)
        return made[id(part)]
    if isinstance(part, Mapping):
        rows = {key: taken(value, owner, made) for key, value in part.items()}
        return MappingProxyType(rows) if any(rows[key] is not part[key] for key in rows) else part
    if isinstance(part, tuple):
        values = [taken(value, owner, made) for value in part]
        if all(new is old for new, old in zip(values, part, strict=True)):
            return part
        return type(part)(*values) if hasattr(part, "_fields") else tuple(values)
    if is_dataclass(part) and not isinstance(part, type):
        changed = {f.name: taken(vars(part)[f.name], owner, made) for f in fields(part)}
        if all(changed[name] is vars(part)[name] for name in changed):
            return part
        return type(part)(**changed)
    return part
