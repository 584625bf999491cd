"""How results are kept: read-only, since others share them; made when they are first read."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache
from typing import Any, Generic, TypeVar, cast

import numpy as np

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
