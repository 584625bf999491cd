"""Field metadata: label, range and help of every number a user can type. Forms, validation and tables walk it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, cast

from core.design.units import Unit, split_unit
from core.errors import Fault

_KEY = "kindyna"
LARGEST = 1e15  # in the field's own unit: squares and products of such numbers still are numbers


@dataclass(frozen=True)
class Info:
    """What is known of one field.

    low, high  bounds of a number (``open_low``: low itself is excluded); no bound stated means ``LARGEST``
    choices    bounds words, or a few numbers
    step       a sensible step of a spin box, 0 = by magnitude
    optional   may be None
    whole      a number without a fraction
    """

    label: str
    help: str = ""
    low: float = -LARGEST
    high: float = LARGEST
    open_low: bool = False
    choices: tuple[Any, ...] = ()
    step: float = 0.0
    optional: bool = False
    whole: bool = False

    def allowed(self, unit: Unit) -> str:
        """The allowed range as text: ``> 0 mm``, ``0 ... 1``, ``ccw | cw``."""
        if self.choices:
            return " | ".join(map(str, self.choices))
        symbol = f" {unit.symbol}" if unit.symbol else ""
        if self.low == -LARGEST and self.high == LARGEST:
            return f"any number{' of' + symbol if symbol else ''} up to +-{LARGEST:g}"
        if self.high == LARGEST:
            return f"{'>' if self.open_low else '>='} {self.low:g}{symbol}"
        return f"{'above ' if self.open_low else ''}{self.low:g} ... {self.high:g}{symbol}"

    def admits(self, value: Any) -> bool:
        if self.choices:
            return value in self.choices
        if value is None:
            return self.optional
        if self.whole and not isinstance(value, int):
            return False
        above = value > self.low if self.open_low else value >= self.low
        return bool(above and value <= self.high and math.isfinite(value))


def number(
    label: str,
    low: float = -LARGEST,
    high: float = LARGEST,
    *,
    open_low: bool = False,
    default: Any = dataclasses.MISSING,
    help: str = "",
    step: float = 0.0,
) -> Any:
    """A dataclass field for a number; its unit is told by its name."""
    info = Info(label, help, low, high, open_low, step=step, optional=default is None)
    return dataclasses.field(default=default, metadata={_KEY: info})


def whole(label: str, low: int, high: int, *, default: Any = dataclasses.MISSING, help: str = "") -> Any:
    """A dataclass field for a number without a fraction."""
    info = Info(label, help, low, high, step=1.0, whole=True)
    return dataclasses.field(default=default, metadata={_KEY: info})


LONGEST_MM = 1e9


def length(label: str, *, help: str = "", default: Any = dataclasses.MISSING) -> Any:
    """A dataclass field for a length that must be positive."""
    return number(label, 0.0, LONGEST_MM, open_low=True, help=help, default=default)


def coordinate(label: str, *, help: str = "", default: Any = dataclasses.MISSING) -> Any:
    """A dataclass field for a signed distance."""
    return number(label, -LONGEST_MM, LONGEST_MM, help=help, default=default)


def choice(label: str, choices: tuple[str, ...], *, default: Any = dataclasses.MISSING, help: str = "") -> Any:
    """A dataclass field for one word of several."""
    return dataclasses.field(default=default, metadata={_KEY: Info(label, help, choices=choices)})


@dataclass(frozen=True)
class Placing:
    """Where the parts in a field stand in the file.

    inside  the keys of the part stand in the table of the whole
    key     rows are told by this field of theirs, as ``points.A``; else by number
    single  a row is one value; row: makes one from name and value
    """

    inside: bool = False
    key: str = ""
    single: bool = False
    row: Callable[[str, Any], Any] | None = None


_PLACING = "kindyna-placing"
_PLAIN = Placing()


def placed(placing: Placing, default: Any = dataclasses.MISSING) -> Any:
    """A dataclass field for a part or a list of parts."""
    return dataclasses.field(default=default, metadata={_PLACING: placing})


def placing_of(field: dataclasses.Field[Any]) -> Placing:
    """Where the parts in a field stand in the file."""
    placing: Placing = field.metadata.get(_PLACING, _PLAIN)
    return placing


def info_of(field: dataclasses.Field[Any]) -> Info | None:
    """The metadata of a dataclass field, None where it holds no entry of its own (a part, a list)."""
    return field.metadata.get(_KEY)


def unit_of(field: dataclasses.Field[Any]) -> Unit:
    return split_unit(field.name)[1]


def field_faults(part: Any, path: str) -> list[Fault]:
    """Every field of a part that is outside its range; ``path`` is the part's own."""
    found = []
    for field, info in _entries_of(cast(Hashable, type(part))):
        value = getattr(part, field.name)
        if not info.admits(value):
            problem = "unknown word" if info.choices else "outside its range"
            found.append(Fault(f"{path}.{field.name}", value, problem, info.allowed(unit_of(field))))
    return found


@lru_cache(maxsize=256)
def _entries_of(kind: Any) -> tuple[tuple[dataclasses.Field[Any], Info], ...]:
    """The fields of a part that hold entries of their own."""
    return tuple((field, info) for field in dataclasses.fields(kind) if (info := info_of(field)) is not None)
