"""How results are kept: read-only, since others share them; made when they are first read."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields, is_dataclass
from functools import lru_cache, reduce
from threading import Event
from types import MappingProxyType
from typing import Any, Generic, TypeVar, cast

import numpy as np

from core.errors import ResultPending

# -- giving up a long computation -------------------------------------------------------------------------------


class Cancelled(Exception):
    """The result is no longer wanted."""


_FLAG: ContextVar[Event | None] = ContextVar("flag", default=None)


@contextmanager
def cancellable(flag: Event) -> Iterator[None]:
    """What is computed inside, in this thread, raises Cancelled at its next checkpoint once the flag is set."""
    token = _FLAG.set(flag)
    try:
        yield
    finally:
        _FLAG.reset(token)


def checkpoint() -> None:
    """Raises Cancelled where the flag of the computation at hand is set."""
    flag = _FLAG.get()
    if flag is not None and flag.is_set():
        raise Cancelled


Later = Callable[[Hashable, Callable[[], Any]], str]
"""Lets what a key names be computed elsewhere; what has become of that, empty where it is there by now."""
_LATER: ContextVar[Later | None] = ContextVar("later", default=None)


@contextmanager
def postponing(later: Later) -> Iterator[None]:
    """What takes long is not computed inside, in this thread, but raises ResultPending."""
    token = _LATER.set(later)
    try:
        yield
    finally:
        _LATER.reset(token)


def postpone(what: str, key: Hashable, compute: Callable[[], Any], field: str) -> None:
    """Before something that may take long, and that ``compute`` keeps where it is found. Raises ResultPending, which names a field, where
    this thread must not wait for it and it is not there yet."""
    later = _LATER.get()
    state = "" if later is None else later(key, compute)
    if state:
        raise ResultPending(
            f"{what} {state}", field, "the button in the status line ends the search, or begins it anew"
        )


# -- columns ----------------------------------------------------------------------------------------------------


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


_PLAIN_TYPES = frozenset((float, int, str, bool, complex, type(None)))
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
    if type(part) in _PLAIN_TYPES:
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


# -- how results are kept ---------------------------------------------------------------------------------------


T = TypeVar("T")


def locked(value: T) -> T:
    """The value, every array in it read-only from now on; what is made later is locked then."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
        return value
    for part in _parts_of(cast(Hashable, type(value)))(value):
        if (kind := type(part)) not in _WITHOUT:
            if kind is np.ndarray:
                part.flags.writeable = False
            else:
                locked(part)
    return value


_PLAIN = ("float", "int", "str", "bool", "complex", "tuple[str, ...]")
_WITHOUT: set[type] = {float, int, str, bool, complex, type(None)}
"""Kinds of values that hold no arrays: most of what a result holds."""


@lru_cache(maxsize=256)
def _parts_of(kind: Any) -> Callable[[Any], Iterable[Any]]:
    """What a value of this kind holds."""
    if issubclass(kind, Mapping):
        return lambda value: value.values()
    if issubclass(kind, tuple):
        return iter
    if is_dataclass(kind) and any(field.type not in _PLAIN for field in fields(kind)):
        names = [field.name for field in fields(kind)]
        return lambda value: map(vars(value).get, names)
    _WITHOUT.add(kind)
    return lambda value: ()


def once(make: Callable[[], T]) -> Callable[[], T]:
    """The function, called once: what it gave from then on. As ``functools.cache``, whose wrapper costs ten times as much."""
    made: list[T] = []

    def value() -> T:
        if not made:
            made.append(make())
        return made[0]

    return value


class Lazy(Generic[T]):
    """A field of a dataclass that may be given as a function: its value is made when it is first read.

    otherwise  makes it from the other fields where it is not given
    """

    def __init__(self, otherwise: Callable[[Any], T] | None = None) -> None:
        self._otherwise = otherwise

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, part: Any, owner: type) -> T:
        if part is None:
            if self._otherwise is None:
                raise AttributeError(self._name)  # so that a dataclass finds no default
            return cast(T, self._otherwise)
        value = vars(part)[self._name]
        if callable(value):
            made = value() if self._otherwise is None or value is not self._otherwise else self._otherwise(part)
            value = vars(part)[self._name] = locked(made)
        return cast(T, value)

    def __set__(self, part: Any, value: T | Callable[[], T]) -> None:
        vars(part)[self._name] = value
