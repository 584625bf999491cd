"""Results at some of the angles of a larger result, so that several sets of angles share one solution."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache, partial
from types import MappingProxyType
from typing import Any, TypeVar, cast

import numpy as np

from core.numerics.derivatives import Derivatives
from core.numerics.lazy import Lazy

T = TypeVar("T")
Cut = Callable[[np.ndarray], np.ndarray]


def part_of(value: T, selected: slice | np.ndarray, count: int) -> T:
    """A result at selected angles, as views where ``selected`` is a slice; what is lazy remains so.

    Parameters
    ----------
    value : any
        Arrays whose last axis has ``count`` angles, in dataclasses, mappings and tuples; other values are the same at any angle.
    selected : slice or ndarray (k,) of int, dimensionless
        Numbers of the angles.
    count : int
        Number of angles of the result.
    """
    cuts: dict[int, tuple[np.ndarray, np.ndarray]] = {}  # by identity: what shares an array shares its part

    def cut(row: np.ndarray) -> np.ndarray:
        if not row.ndim or row.shape[-1] != count:
            return row
        if id(row) not in cuts:
            cuts[id(row)] = row, row[..., selected]
        return cuts[id(row)][1]

    part: T = _cut(cut, value)
    return part


def _same(cut: Cut, value: Any) -> Any:
    return value


@lru_cache(maxsize=256)
def _cutter(kind: Any) -> Callable[[Cut, Any], Any]:
    """Function that cuts a value of this type."""
    if issubclass(kind, np.ndarray):
        return lambda cut, value: cut(value)
    if issubclass(kind, Derivatives):
        return lambda cut, value: Derivatives(lambda order: cut(value[order]), value.constant)
    if issubclass(kind, Mapping):
        return lambda cut, value: MappingProxyType({name: _cut(cut, item) for name, item in value.items()})
    if issubclass(kind, tuple):
        build = getattr(kind, "_make", kind)
        return lambda cut, value: build([_cut(cut, item) for item in value])
    if is_dataclass(kind):
        return partial(_cut_fields, kind, *_field_names(kind))
    return _same


def _field_names(kind: Any) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the fields of a dataclass, and those of its lazy fields."""
    names = tuple(field.name for field in fields(kind))
    return names, tuple(name for name in names if isinstance(vars(kind).get(name), Lazy))


def _cut_fields(kind: Any, names: tuple[str, ...], lazy: tuple[str, ...], cut: Cut, value: Any) -> Any:
    own = vars(value)
    parts = {name: _cut(cut, own[name]) for name in names if name not in lazy}
    if not lazy and all(parts[name] is own[name] for name in names):
        return value
    return kind(**parts, **{name: partial(_cut_lazy, cut, value, name) for name in lazy})


def _cut_lazy(cut: Cut, value: Any, name: str) -> Any:
    return _cut(cut, getattr(value, name))


def _cut(cut: Cut, value: Any) -> Any:
    return _cutter(cast(Hashable, type(value)))(cut, value)
