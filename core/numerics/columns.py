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
    return float(value.flat[0]) if isinstance(value, Column) else value


def greatest(values: Sequence[Any]) -> Any:
    """The greatest of some numbers; of many designs a column."""
    many = any(isinstance(value, Column) for value in values)
    return column(reduce(np.maximum, values)) if many else max(values)


_PLAIN = frozenset((float, int, str, bool, complex, type(None)))
Take = Callable[[np.ndarray], Any]
"""A column (m,) of designs -> what stands in its place: at angles (n,) of theirs a column (n,), of one design a number."""
Taker = Callable[[Take, dict[int, Any]], Any]


def design_by_design(number: int) -> Take:
    """The numbers of one design."""
    return lambda row: float(row[number])


def at_angles_of(owner: np.ndarray) -> Take:
    """Of designs at angles (n,), each of which belongs to the design ``owner`` (n,)."""
    return lambda row: row[owner].view(Column)


def repeated(designs: slice, each: int) -> Take:
    """Of some designs, so many angles of each one after the other."""
    return lambda row: np.repeat(row[designs], each).view(Column)


def taker(part: Any) -> Taker | None:
    """How a part is made whose columns stand for designs; None where it has none. What is made takes from ``made``, by the identity of
    a column, what that became, so that what was shared stays so."""
    if type(part) in _PLAIN:
        return None
    if isinstance(part, np.ndarray):
        return lambda take, made: made[id(part)] if id(part) in made else made.setdefault(id(part), take(part))
    if isinstance(part, Mapping):
        rows = _takers(part)
        return rows and (lambda take, made: MappingProxyType({**part, **{k: t(take, made) for k, t in rows.items()}}))
    if isinstance(part, tuple):
        values, kind = _takers(dict(enumerate(part))), getattr(type(part), "_make", tuple)
        return values and (
            lambda take, made: kind([values[i](take, made) if i in values else x for i, x in enumerate(part)])
        )
    if is_dataclass(part) and not isinstance(part, type):
        own = {f.name: vars(part)[f.name] for f in fields(part)}
        changed = _takers(own)
        return changed and (
            lambda take, made: type(part)(**{**own, **{name: t(take, made) for name, t in changed.items()}})
        )
    return None


def _takers(parts: Mapping[Any, Any]) -> Any:
    """Those of the parts that have columns, by their keys; None where none has."""
    return {key: found for key, part in parts.items() if (found := taker(part)) is not None} or None


def taken(part: Any, take: Take) -> Any:
    """The part with its columns taken."""
    make = taker(part)
    return part if make is None else make(take, {})
