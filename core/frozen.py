"""Frozen dataclasses that import quickly.

``dataclasses.dataclass(frozen=True)`` compiles up to six methods for each class, half of the import time. Here all classes
share these methods; only ``__init__`` is compiled for each class, when its first instance is created. The fields of a class
are collected when they are first read, which is rare in one run.
"""

from __future__ import annotations

import reprlib
from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError, dataclass, field, fields
from operator import attrgetter
from threading import RLock
from typing import Any, dataclass_transform


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: Any = None, *, eq: bool = True, kw_only: bool = False) -> Any:
    """Make a class a frozen dataclass, with ``fields``, ``replace``, ``asdict`` and ``copy`` as for any dataclass.

    Two instances are equal, with the same hash, where all fields are equal; with eq=False an instance equals only itself.
    """
    if kind is None:
        return lambda kind: frozen(kind, eq=eq, kw_only=kw_only)
    result: Any = kind
    for name in ("__dataclass_fields__", "__dataclass_params__"):
        setattr(result, name, _LazyFields(result, name, kw_only))
    result.__init__, result.__repr__, result.__setattr__, result.__delattr__ = (
        _LazyInit(result),
        _repr,
        _refuse,
        _refuse,
    )
    if eq:
        values = _values(result)
        result.__eq__ = lambda self, right: (
            values(self) == values(right) if type(self) is type(right) else NotImplemented
        )
        result.__hash__, result.__setstate__ = _hash(values), _set_state
    return result


_COLLECTING_FIELDS = RLock()


class _LazyFields:
    """The fields and parameters of a dataclass, collected when they are first read."""

    def __init__(self, kind: Any, name: str, kw_only: bool) -> None:
        self._kind, self._name, self._kw_only = kind, name, kw_only

    def __get__(self, instance: Any, owner: Any) -> Any:
        with _COLLECTING_FIELDS:
            if vars(self._kind)[self._name] is self:
                dataclass(init=False, repr=False, eq=False, kw_only=self._kw_only)(self._kind)
        return vars(self._kind)[self._name]


def _hash(values: Callable[[Any], tuple[Any, ...]]) -> Any:
    """Hash computed once: caches hash the same design, with all its parts, dozens of times for each edit."""

    def hashed(self: Any) -> int:
        try:
            return self._hash
        except AttributeError:
            object.__setattr__(self, "_hash", value := hash(values(self)))
            return value

    return hashed


def _set_state(self: Any, state: dict[str, Any]) -> None:
    vars(self).update(state)
    vars(self).pop("_hash", None)  # hashes of texts differ between processes


def _values(kind: Any) -> Callable[[Any], tuple[Any, ...]]:
    """Function that returns the fields by which two instances are compared."""
    read: Any = None

    def values(self: Any) -> tuple[Any, ...]:
        nonlocal read
        if read is None:
            names = [field.name for field in fields(kind) if field.compare]
            read = attrgetter(*names) if len(names) > 1 else lambda self: tuple(getattr(self, name) for name in names)
        return read(self)

    return values


class _LazyInit:
    """The ``__init__`` of a class, compiled and stored in the class at its first use, which is rare in one run."""

    def __init__(self, kind: Any) -> None:
        self._kind = kind

    def __get__(self, instance: Any, owner: Any) -> Any:
        self._kind.__init__ = compiled = _compile_init(self._kind)
        return compiled.__get__(instance, owner)


def _compile_init(kind: Any) -> Any:
    parts: Any = sorted(fields(kind), key=lambda part: bool(part.kw_only))
    names: dict[str, Any] = {"_put": object.__setattr__}
    parameters, entries = ["self"], []
    for part in parts:
        name = value = part.name
        if part.kw_only and "*" not in parameters:
            parameters.append("*")
        if part.default_factory is not MISSING:
            names |= {f"default_{name}": MISSING, f"make_{name}": part.default_factory}
            value = f"make_{name}() if {name} is default_{name} else {name}"
        elif part.default is not MISSING:
            names[f"default_{name}"] = part.default
        parameters.append(f"{name}=default_{name}" if f"default_{name}" in names else name)
        entries.append(f"{name!r}: {value}")
    # all fields at once, past any descriptor, take half of the time of one after the other
    then = "\n self.__post_init__()" if hasattr(kind, "__post_init__") else ""
    exec(f"def __init__({', '.join(parameters)}):\n _put(self, '__dict__', {{{', '.join(entries)}}}){then}", names)
    names["__init__"].__qualname__ = f"{kind.__qualname__}.__init__"
    return names["__init__"]


@reprlib.recursive_repr()
def _repr(self: Any) -> str:
    values = ", ".join(f"{part.name}={getattr(self, part.name)!r}" for part in fields(self) if part.repr)
    return f"{type(self).__qualname__}({values})"


def _refuse(self: Any, name: str, *value: Any) -> None:
    raise FrozenInstanceError(
        f"{type(self).__qualname__}.{name} cannot be changed: create a new instance with dataclasses.replace"
    )
