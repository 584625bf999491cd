"""Shared results: read-only arrays, fields computed when they are first read, columns of many designs, cancellation."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields, is_dataclass
from functools import lru_cache, reduce
from threading import Event
from types import MappingProxyType
from typing import Any, Generic, TypeVar, cast, overload

import numpy as np

from core.errors import ResultPending

# -- cancelling and postponing a long computation ---------------------------------------------------------------


class Cancelled(Exception):
    """The computation is cancelled."""


_FLAG: ContextVar[Event | None] = ContextVar("flag", default=None)


@contextmanager
def cancellable(flag: Event) -> Iterator[None]:
    """Make the next checkpoint inside the block, in this thread, raise Cancelled once the flag is set."""
    token = _FLAG.set(flag)
    try:
        yield
    finally:
        _FLAG.reset(token)


def checkpoint() -> None:
    """Raise Cancelled where the flag of the current computation is set; long loops call it.

    Raises
    ------
    Cancelled
    """
    flag = _FLAG.get()
    if flag is not None and flag.is_set():
        raise Cancelled


Postpone = Callable[[Hashable, Callable[[], Any]], str]
"""Key and function of a result -> state of its computation in another thread, empty where it is complete."""
_POSTPONE: ContextVar[Postpone | None] = ContextVar("postpone", default=None)


@contextmanager
def postponing(later: Postpone) -> Iterator[None]:
    """Leave long computations inside the block to another thread; reading their results raises ResultPending."""
    token = _POSTPONE.set(later)
    try:
        yield
    finally:
        _POSTPONE.reset(token)


def postpone(what: str, key: Hashable, compute: Callable[[], Any], field: str) -> None:
    """Announce a long computation, whose function ``compute`` stores its result.

    Raises
    ------
    ResultPending
        With the field, where this thread must not wait for the result, and it is not complete.
    """
    later = _POSTPONE.get()
    state = "" if later is None else later(key, compute)
    if state:
        raise ResultPending(f"{what} {state}", field, "the button in the status line stops or restarts the search")


# -- columns: many designs in one array -------------------------------------------------------------------------


class Column(np.ndarray):
    """Values of many designs, or of their cam angles, in place of one number of a part.

    A column is true where any of its values is not 0: a formula then runs for all designs, and gives 0 where the value is 0.
    The truth of a comparison is undefined. A part with columns is equal only to itself.
    """

    __hash__ = object.__hash__  # type: ignore[assignment]

    def __bool__(self) -> bool:
        if self.dtype == bool and self.ndim:
            raise TypeError("a comparison of many designs has no single truth value")
        return bool(np.asarray(self).any())


def column(values: Any) -> Column:
    """Column from values (m,)."""
    return np.asarray(values).view(Column)


def first_value(value: Any) -> Any:
    """Number that all designs share: the first of a column, or the number itself."""
    return float(value.flat[0]) if isinstance(value, Column) else value


def greatest(values: Sequence[Any]) -> Any:
    """Greatest of several numbers; with many designs a column."""
    has_column = any(isinstance(value, Column) for value in values)
    return column(reduce(np.maximum, values)) if has_column else max(values)


_PLAIN_TYPES = frozenset((float, int, str, bool, complex, type(None)))
ColumnMap = Callable[[np.ndarray], Any]
"""Column (m,) of designs -> its replacement: a column (n,) at n angles, or the number of one design."""
PartMapper = Callable[[ColumnMap, dict[int, Any]], Any]


def one_design(number: int) -> ColumnMap:
    """Map of a column to the number of one design."""
    return lambda row: float(row[number])


def at_owners(owner: np.ndarray) -> ColumnMap:
    """Map of a column to a value at each of n angles.

    Parameters
    ----------
    owner : ndarray (n,) of int, dimensionless
        Number of the design to which each angle belongs.
    """
    return lambda row: row[owner].view(Column)


def repeated_values(designs: slice, count: int) -> ColumnMap:
    """Map of a column to ``count`` equal values for each of some designs, one design after the other."""
    return lambda row: np.repeat(row[designs], count).view(Column)


def part_mapper(part: Any) -> PartMapper | None:
    """Function that copies a part with its columns mapped; None where the part has no columns.

    Its second argument caches mapped columns by identity, so that shared columns remain shared.
    """
    if type(part) in _PLAIN_TYPES:
        return None
    if isinstance(part, np.ndarray):
        return lambda f, cache: cache[id(part)] if id(part) in cache else cache.setdefault(id(part), f(part))
    if isinstance(part, Mapping):
        rows = _part_mappers(part.items())
        return rows and (lambda f, cache: MappingProxyType({**part, **{k: m(f, cache) for k, m in rows.items()}}))
    if isinstance(part, tuple):
        items, kind = _part_mappers(enumerate(part)), getattr(type(part), "_make", tuple)
        return items and (lambda f, cache: kind([items[i](f, cache) if i in items else x for i, x in enumerate(part)]))
    names, values = _field_names(part.__class__), getattr(part, "__dict__", {})
    changed = _part_mappers([(name, values[name]) for name in names])
    rest = changed and {name: values[name] for name in names if name not in changed}
    return changed and (lambda f, cache: type(part)(**rest, **{name: m(f, cache) for name, m in changed.items()}))


def _part_mappers(parts: Iterable[tuple[Any, Any]]) -> Any:
    """Mappers of the parts that have columns, by key; None where no part has columns."""
    return {
        key: mapper
        for key, part in parts
        if type(part) not in _PLAIN_TYPES and (mapper := part_mapper(part)) is not None
    } or None


@lru_cache(maxsize=1024)
def _field_names(kind: Any) -> tuple[str, ...]:
    """Names of the fields of a dataclass; empty for another type."""
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else ()


def map_columns(part: Any, column_map: ColumnMap) -> Any:
    """Copy of a part with its columns mapped."""
    mapper = part_mapper(part)
    return part if mapper is None else mapper(column_map, {})


# -- read-only and lazy values ----------------------------------------------------------------------------------


T = TypeVar("T")


def locked(value: T) -> T:
    """Make every array in a value read-only, and return it; lazy fields are locked when they are computed."""
    kind: Any = type(value)
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif kind not in _WITHOUT_ARRAYS:
        for part in _parts_of(kind)(value):
            if type(part) is np.ndarray:
                part.flags.writeable = False
            elif type(part) not in _WITHOUT_ARRAYS:
                locked(part)
    return value


def self_locking(kind: type[T]) -> type[T]:
    """Class decorator: no array in an instance has to be locked; its lazy fields are locked when they are computed."""
    _WITHOUT_ARRAYS.add(kind)
    return kind


_WITHOUT_ARRAYS: set[type] = {float, int, str, bool, complex, type(None)}
"""Types without arrays, which most values in a result have."""
_NAMES_WITHOUT_ARRAYS = {"float", "int", "str", "bool", "complex", "None", "tuple", "Mapping", "Lazy", "Derivatives"}
"""Names in the annotation of a field that holds no unlocked array; the rows of Derivatives are read-only from the start."""


def _may_hold_arrays(field: Any) -> bool:
    return not set(re.findall(r"[^\W\d]\w*", str(field.type))) <= _NAMES_WITHOUT_ARRAYS


@lru_cache(maxsize=256)
def _parts_of(kind: Any) -> Callable[[Any], Iterable[Any]]:
    """Function that returns the parts of a value of this type."""
    if issubclass(kind, Mapping):
        return lambda value: value.values()
    if issubclass(kind, tuple):
        return iter
    if is_dataclass(kind) and (names := [field.name for field in fields(kind) if _may_hold_arrays(field)]):
        return lambda value: map(vars(value).get, names)
    _WITHOUT_ARRAYS.add(kind)
    return lambda value: ()


def once(compute: Callable[[], T]) -> Callable[[], T]:
    """Function that calls ``compute`` once and then returns its result; its overhead is a tenth of ``functools.cache``."""
    result: list[T] = []

    def value() -> T:
        if not result:
            result.append(compute())
        return result[0]

    return value


class lazy(Generic[T]):
    """Property computed when it is first read, as ``functools.cached_property`` without the lock that it has in Python 3.11.

    With that lock a thread waits while another one computes the same property of any other object.
    """

    def __init__(self, compute: Callable[[Any], T]) -> None:
        self._compute = compute
        self.__doc__ = compute.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, instance: None, owner: type) -> lazy[T]: ...
    @overload
    def __get__(self, instance: object, owner: type) -> T: ...
    def __get__(self, instance: Any, owner: type) -> Any:
        if instance is None:
            return self
        value = instance.__dict__[self._name] = self._compute(instance)
        return value


class Lazy(Generic[T]):
    """Field of a dataclass that may be given as a function: its value is computed when it is first read.

    Where the field is not given, ``otherwise`` computes it from the other fields.
    """

    def __init__(self, otherwise: Callable[[Any], T] | None = None) -> None:
        self._otherwise = otherwise

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, instance: Any, owner: type) -> T:
        if instance is None:
            if self._otherwise is None:
                raise AttributeError(self._name)  # so that a dataclass finds no default
            return cast(T, self._otherwise)
        values: dict[str, Any] = instance.__dict__
        value: T = values[self._name]
        if callable(value):
            otherwise: Any = self._otherwise
            value = values[self._name] = locked(value(instance) if value is otherwise else value())
        return value

    def __set__(self, instance: Any, value: T | Callable[[], T]) -> None:
        vars(instance)[self._name] = value
