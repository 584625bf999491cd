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
            cuts[id(row)][1].flags.writeable = False
        return cuts[id(row)][1]

    part: T = _cut(cut, value)
    return part


def _cut(cut: Cut, value: Any) -> Any:
    cutter = _cutter(cast(Hashable, type(value)))
    return value if cutter is None else cutter(cut, value)


@lru_cache(maxsize=256)
def _cutter(kind: Any) -> Callable[[Cut, Any], Any] | None:
    """Function that cuts a value of this type; None for a type without arrays."""
    if issubclass(kind, np.ndarray):
        return lambda cut, value: cut(value)
    if issubclass(kind, Derivatives):
        return lambda cut, value: Derivatives(lambda order: cut(value[order]), value.constant)
    if issubclass(kind, Mapping):
        return _cut_mapping
    if issubclass(kind, tuple):
        build = getattr(kind, "_make", kind)
        return lambda cut, value: build([_cut(cut, item) for item in value])
    if is_dataclass(kind):
        return _fields_cutter(kind)
    return None


def _cut_mapping(cut: Cut, value: Mapping[Any, Any]) -> Mapping[Any, Any]:
    if all(_cutter(cast(Hashable, type(item))) is None for item in value.values()):
        return value
    return MappingProxyType({name: _cut(cut, item) for name, item in value.items()})


_PLAIN = ("float", "int", "str", "bool", "complex", "tuple[str, ...]", "Mapping[str, complex]", "Mapping[str, Pair]")


def _fields_cutter(kind: Any) -> Callable[[Cut, Any], Any] | None:
    """Function that cuts the fields of a dataclass; None where none of them has arrays."""
    plain = [field.name for field in fields(kind) if field.type in _PLAIN]
    lazy = [field.name for field in fields(kind) if isinstance(vars(kind).get(field.name), Lazy)]
    eager = [field.name for field in fields(kind) if field.name not in (*plain, *lazy)]
    if not eager and not lazy:
        return None

    def cut_fields(cut: Cut, value: Any) -> Any:
        present = vars(value)
        parts = {name: _cut(cut, present[name]) for name in eager}
        if not lazy and all(parts[name] is present[name] for name in eager):
            return value
        result = object.__new__(kind)
        parts |= {name: present[name] for name in plain} | {name: partial(_cut_lazy, cut, value, name) for name in lazy}
        vars(result).update(parts)
        return result

    return cut_fields


def _cut_lazy(cut: Cut, value: Any, name: str) -> Any:
    return _cut(cut, getattr(value, name))
