"""How results are kept: read-only, since others share them; made when they are asked for; in memory that stays ours."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Hashable, Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache
from typing import Any, Generic, TypeVar, cast

import numpy as np

T = TypeVar("T")


def locked(value: T) -> T:
    """The value, every array in it read-only from now on; what is made when asked is locked then."""
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, Mapping):
        for part in value.values():
            locked(part)
    elif isinstance(value, tuple):
        for part in value:
            locked(part)
    elif is_dataclass(value):
        held = vars(value)
        for name in _field_names(cast(Hashable, type(value))):
            part = held.get(name)
            if part is not None and type(part) not in _PLAIN:
                locked(part)
    return value


_PLAIN = frozenset({float, int, str, bool, complex})


@lru_cache(maxsize=256)
def _field_names(kind: Any) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))


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
                raise AttributeError(self._name)  # which tells a dataclass that there is no default
            return cast(T, self._otherwise)
        value = vars(part)[self._name]
        if callable(value):
            made = value() if self._otherwise is None or value is not self._otherwise else self._otherwise(part)
            value = vars(part)[self._name] = locked(made)
        return cast(T, value)

    def __set__(self, part: Any, value: T | Callable[[], T]) -> None:
        vars(part)[self._name] = value


_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of glibc's mallopt
_KEPT, _OWN_PAGES = 64 << 20, 32 << 20  # [bytes]


@lru_cache(maxsize=1)
def keep_freed_memory() -> None:
    """Tell the C library to keep up to 64 MB of freed memory instead of giving it back at once.

    A stage makes some fifty arrays of 30 to 200 kB and drops most of them: by default each of their pages goes back to
    the system and comes anew, zeroed, with the next stage. The lift's linkage and profile at 3600 angles cost 66 page faults
    and 0.80 ms so, none and 0.69 ms with this (medians, 2 cores, glibc 2.36).
    Every command and every
    window call it. No such knob, no harm: other C libraries do not have it.
    """
    if not sys.platform.startswith("linux"):
        return
    try:
        adjust: Any = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError):
        return
    adjust(_TRIM_THRESHOLD, _KEPT)
    adjust(_MMAP_THRESHOLD, _OWN_PAGES)
