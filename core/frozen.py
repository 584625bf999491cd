"""Frozen dataclasses that import quickly. ``dataclasses.dataclass(frozen=True)`` compiles up to six methods for each class, half
of what an import cost; here all classes share them, and only ``__init__`` is compiled for each, when its first instance is made.
What the fields of a class are is found out when it is first asked for, too: of few classes in one run."""

from __future__ import annotations

import reprlib
from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError, dataclass, field, fields
from operator import attrgetter
from threading import RLock
from typing import Any, dataclass_transform


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: Any = None, *, eq: bool = True, kw_only: bool = False) -> Any:
    """A class whose instances hold the annotated fields and never change: equal, and of one hash, where all fields are
    (eq=False: only with themselves). ``fields``, ``replace``, ``asdict`` and ``copy`` take it as any other dataclass."""
    if kind is None:
        return lambda kind: frozen(kind, eq=eq, kw_only=kw_only)
    made: Any = kind
    for name in ("__dataclass_fields__", "__dataclass_params__"):
        setattr(made, name, _Later(made, name, kw_only))
    made.__init__, made.__repr__, made.__setattr__, made.__delattr__ = _Init(made), _repr, _refuse, _refuse
    if eq:
        values = _values(made)
        made.__eq__ = lambda self, other: values(self) == values(other) if type(self) is type(other) else NotImplemented
        made.__hash__, made.__setstate__ = _hash(values), _set_state
    return made


_FINDING_OUT = RLock()


class _Later:
    """What ``dataclass`` finds out about a class, until it is first asked for."""

    def __init__(self, kind: Any, name: str, kw_only: bool) -> None:
        self._kind, self._name, self._kw_only = kind, name, kw_only

    def __get__(self, part: Any, owner: Any) -> Any:
        with _FINDING_OUT:
            if vars(self._kind)[self._name] is self:
                dataclass(init=False, repr=False, eq=False, kw_only=self._kw_only)(self._kind)
        return vars(self._kind)[self._name]


def _hash(values: Callable[[Any], tuple[Any, ...]]) -> Any:
    """Computed once: caches ask for the hash of the same design, with all its parts, dozens of times for each edit."""

    def hashed(self: Any) -> int:
        try:
            return self._hash
        except AttributeError:
            object.__setattr__(self, "_hash", made := hash(values(self)))
            return made

    return hashed


def _set_state(self: Any, state: dict[str, Any]) -> None:
    vars(self).update(state)
    vars(self).pop("_hash", None)  # texts have another hash in another process


def _values(kind: Any) -> Callable[[Any], tuple[Any, ...]]:
    """What two instances are compared by."""
    read: Any = None

    def values(self: Any) -> tuple[Any, ...]:
        nonlocal read
        if read is None:
            names = [each.name for each in fields(kind) if each.compare]
            read = attrgetter(*names) if len(names) > 1 else lambda self: tuple(getattr(self, name) for name in names)
        return read(self)

    return values


class _Init:
    """The ``__init__`` of a class until it is first asked for, which few classes are in one run: then it is compiled, and stands
    in the class itself."""

    def __init__(self, kind: Any) -> None:
        self._kind = kind

    def __get__(self, part: Any, owner: Any) -> Any:
        self._kind.__init__ = made = _init(self._kind)
        return made.__get__(part, owner)


def _init(kind: Any) -> Any:
    given: Any = sorted(fields(kind), key=lambda each: bool(each.kw_only))
    names: dict[str, Any] = {"_put": object.__setattr__}
    set_later = any(
        hasattr(type(vars(kind).get(each.name)), "__set__") for each in given
    )  # they put it there, too, but slowly
    parameters, lines = ["self"], ["_all = self.__dict__"] if set_later else []
    for each in given:
        name = value = each.name
        if each.kw_only and "*" not in parameters:
            parameters.append("*")
        if each.default_factory is not MISSING:
            names |= {f"default_{name}": MISSING, f"make_{name}": each.default_factory}
            value = f"make_{name}() if {name} is default_{name} else {name}"
        elif each.default is not MISSING:
            names[f"default_{name}"] = each.default
        parameters.append(f"{name}=default_{name}" if f"default_{name}" in names else name)
        lines.append(f"_all[{name!r}] = {value}" if set_later else f"_put(self, {name!r}, {value})")
    exec(f"def __init__({', '.join(parameters)}):\n " + "\n ".join(lines or ["pass"]), names)
    names["__init__"].__qualname__ = f"{kind.__qualname__}.__init__"
    return names["__init__"]


@reprlib.recursive_repr()
def _repr(self: Any) -> str:
    values = ", ".join(f"{each.name}={getattr(self, each.name)!r}" for each in fields(self) if each.repr)
    return f"{type(self).__qualname__}({values})"


def _refuse(self: Any, name: str, *value: Any) -> None:
    raise FrozenInstanceError(
        f"{type(self).__qualname__}.{name} cannot be changed: make another with dataclasses.replace"
    )
