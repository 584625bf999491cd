"""Units of measure, one row for each kind of them: what files store, what is shown, what may be typed. Users type mm, degrees and
rpm; the stages see SI and radians only."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import field
from functools import lru_cache
from itertools import product
from types import MappingProxyType
from typing import TYPE_CHECKING

from core.frozen import frozen

if TYPE_CHECKING:  # few commands read a typed unit
    from fractions import Fraction


@frozen
class Size:
    """How many of the SI unit one unit is, exactly: over/under times a power of π."""

    over: int
    under: int = 1
    pi: int = 0

    def __mul__(self, other: int | Size) -> Size:
        by = other if isinstance(other, Size) else Size(other)
        return _reduced(self.over * by.over, self.under * by.under, self.pi + by.pi)

    def __truediv__(self, other: int | Size) -> Size:
        by = other if isinstance(other, Size) else Size(other)
        return _reduced(self.over * by.under, self.under * by.over, self.pi - by.pi)

    @property
    def factor(self) -> float:
        """Rounded once; twice where π stands in it."""
        if not self.pi:
            return self.over / self.under
        over, under = self.over, self.under
        return over * math.pi**self.pi / under if self.pi > 0 else over / (under * math.pi**-self.pi)

    @property
    def value(self) -> Fraction | float:
        """Exact where π does not stand in it."""
        from fractions import Fraction

        return self.factor if self.pi else Fraction(self.over, self.under)


def _reduced(over: int, under: int, pi: int) -> Size:
    common = math.gcd(over, under)
    return Size(over // common, under // common, pi)


@frozen
class UnitKind:
    """One row: the units that measure the same.

    name      what is measured, in words
    units     symbol as printed -> size; those that are offered, in that order
    stored    ending of fields, keys and columns -> symbol of the unit that such a number counts in
    others    further ones, not offered: typed, or shown where values are very large or small
    typed     spelling that may be typed too -> symbol; beside the symbols, and these without their signs: ``Nm``, ``m/s2``, ``deg``
    shown     symbol of the unit that values are in -> the units that they are shown in, coarsest first, with the peak value, counted
              in itself, from which each serves; values in others are shown as they are
    decimals  that a number of a file needs beyond those of a length, where it is rounded to what the mouse can tell
    """

    name: str
    units: Mapping[str, Size]
    stored: Mapping[str, str] = field(default_factory=dict)
    others: Mapping[str, Size] = field(default_factory=dict)
    typed: Mapping[str, str] = field(default_factory=dict)
    shown: Mapping[str, tuple[tuple[str, float], ...]] = field(default_factory=dict)
    decimals: int = 0

    @property
    def sizes(self) -> Mapping[str, Size]:
        """Of all its units."""
        return {**self.units, **self.others}


_ONE = Size(1)
_KILO, _MEGA, _GIGA, _MILLI, _MICRO = _ONE * 10**3, _ONE * 10**6, _ONE * 10**9, _ONE / 10**3, _ONE / 10**6
_INCH, _GRAVITY, _POUND = Size(254, 10**4), Size(980665, 10**5), Size(45359237, 10**8)
_POUND_FORCE = _POUND * _GRAVITY
_TURN = Size(2, 1, 1)
_DEGREE, _MINUTE = _TURN / 360, _ONE * 60

_ROWS = (
    UnitKind("length", {"mm": _MILLI, "µm": _MICRO, "cm": _ONE / 100, "m": _ONE, "in": _INCH, "thou": _INCH / 1000, "ft": _INCH * 12},
             {"mm": "mm", "mm_per_turn": "mm"}, {"km": _KILO}, {'"': "in"}, {"mm": (("km", 20.0), ("m", 20.0), ("mm", 0.05), ("µm", 0.0))}),
    UnitKind("angle", {"°": _DEGREE, "rad": _ONE, "turns": _TURN}, {"deg": "°"}, typed={"turn": "turns"}, decimals=2),
    UnitKind("time", {"s": _ONE, "ms": _MILLI, "min": _MINUTE}),
    UnitKind("velocity", {"mm/s": _MILLI, "µm/s": _MICRO, "cm/s": _ONE / 100, "m/s": _ONE, "mm/min": _MILLI / _MINUTE, "in/s": _INCH},
             {"mm_s": "mm/s", "mm_min": "mm/min"}, {"km/s": _KILO},
             shown={"mm/s": (("m/s", 1.0), ("mm/s", 0.05), ("µm/s", 0.0)), "m/s": (("km/s", 2.0), ("m/s", 0.2), ("mm/s", 0.0))}),
    UnitKind("acceleration", {"mm/s²": _MILLI, "m/s²": _ONE, "in/s²": _INCH, "g": _GRAVITY}, {"m_s2": "m/s²", "mm_s2": "mm/s²"},
             {"µm/s²": _MICRO}, shown={"mm/s²": (("m/s²", 1.0), ("mm/s²", 0.05), ("µm/s²", 0.0))}),
    UnitKind("jerk", {"mm/s³": _MILLI, "m/s³": _ONE, "in/s³": _INCH}, {"mm_s3": "mm/s³"}, {"µm/s³": _MICRO},
             shown={"mm/s³": (("m/s³", 1.0), ("mm/s³", 0.05), ("µm/s³", 0.0))}),
    UnitKind("angular velocity", {"°/s": _DEGREE, "rad/s": _ONE, "rpm": _TURN / _MINUTE, "Hz": _TURN},
             {"rpm": "rpm", "deg_s": "°/s", "rad_s": "rad/s"}, typed={"/min": "rpm", "1/min": "rpm", "1/s": "Hz"}),
    UnitKind("angular acceleration", {"°/s²": _DEGREE, "rad/s²": _ONE}, {"deg_s2": "°/s²", "rad_s2": "rad/s²"}),
    UnitKind("angular jerk", {"°/s³": _DEGREE, "rad/s³": _ONE}, {"deg_s3": "°/s³"}),
    UnitKind("length by angle", {"mm/°": _MILLI / _DEGREE, "mm/rad": _MILLI, "in/°": _INCH / _DEGREE}),
    UnitKind("length by angle²", {"mm/°²": _MILLI / _DEGREE / _DEGREE, "mm/rad²": _MILLI, "in/°²": _INCH / _DEGREE / _DEGREE}),
    UnitKind("force", {"N": _ONE, "mN": _MILLI, "kN": _KILO, "MN": _MEGA, "lbf": _POUND_FORCE}, {"n": "N"}, {"GN": _GIGA},
             shown={"N": (("GN", 2.0), ("MN", 2.0), ("kN", 2.0), ("N", 0.2), ("mN", 0.0))}),
    UnitKind("torque", {"N·m": _ONE, "N·mm": _MILLI, "kN·m": _KILO, "lbf·in": _POUND_FORCE * _INCH}, {"nm": "N·m"},
             {"GN·m": _GIGA, "MN·m": _MEGA, "mN·m": _MILLI},
             shown={"N·m": (("GN·m", 2.0), ("MN·m", 2.0), ("kN·m", 2.0), ("N·m", 0.2), ("mN·m", 0.0))}),
    UnitKind("stress", {"MPa": _MEGA, "Pa": _ONE, "kPa": _KILO, "GPa": _GIGA, "N/mm²": _MEGA, "bar": _ONE * 10**5,
             "psi": _POUND_FORCE / _INCH / _INCH},
             {"mpa": "MPa", "gpa": "GPa"}),
    UnitKind("mass", {"kg": _ONE, "g (mass)": _MILLI, "t": _KILO}, {"kg": "kg"}, {"lb": _POUND}, {"g": "g (mass)"}),
    UnitKind("inertia", {"kg·m²": _ONE}, {"kg_m2": "kg·m²"}, {"kg·cm²": _ONE / 10**4, "kg·mm²": _MICRO, "g·cm²": _ONE / 10**7}),
    UnitKind("stiffness", {"N/mm": _KILO, "N/m": _ONE, "kN/mm": _MEGA, "lbf/in": _POUND_FORCE / _INCH},
             {"n_per_mm": "N/mm"}, {"kN/m": _KILO}),
    UnitKind("damping", {"N·s/mm": _KILO, "N·s/m": _ONE}, {"n_s_per_mm": "N·s/mm"}),
    UnitKind("torsional stiffness", {"N·m/rad": _ONE}, {"nm_per_rad": "N·m/rad"}, {"N·m/°": _ONE / _DEGREE}),
    UnitKind("torsional damping", {"N·m·s/rad": _ONE}, {"nm_s_per_rad": "N·m·s/rad"}),
    UnitKind("curvature", {"1/mm": _KILO, "1/m": _ONE, "1/in": _ONE / _INCH}, {"per_mm": "1/mm"}, {"1/µm": _MEGA, "1/km": _MILLI},
             shown={"1/mm": (("1/µm", 2.0), ("1/mm", 0.2), ("1/m", 0.2), ("1/km", 0.0))}),
    UnitKind("energy", {"J": _ONE, "mJ": _MILLI, "kJ": _KILO}, {"j": "J"}),
    UnitKind("power", {"W": _ONE, "mW": _MILLI, "kW": _KILO}, {"w": "W"}),
    UnitKind("ratio", {"%": _ONE / 100}),
)  # fmt: skip

KINDS: Mapping[str, UnitKind] = MappingProxyType({row.name: row for row in _ROWS})
_OF_SYMBOL: Mapping[str, UnitKind] = MappingProxyType({symbol: row for row in _ROWS for symbol in row.units})


# -- units of fields, keys and columns ----------------------------------------------------------------------


@frozen
class Unit:
    """symbol as printed; factor from the user's unit to SI."""

    symbol: str
    factor: float


UNITS: Mapping[str, Unit] = MappingProxyType(
    {end: Unit(symbol, row.units[symbol].factor) for row in _ROWS for end, symbol in row.stored.items()}
)
"""By the ending of a name."""
NO_UNIT = Unit("", 1.0)


@lru_cache(maxsize=1024)
def split_unit(name: str) -> tuple[str, Unit]:
    """``rod_mass_kg`` -> (``rod_mass``, kg). The longest suffix wins; a name without one has no unit."""
    parts = name.split("_")
    for i in range(1, len(parts)):
        suffix = "_".join(parts[i:])
        if suffix in UNITS:
            return "_".join(parts[:i]), UNITS[suffix]
    return name, NO_UNIT


# -- units by their symbols ---------------------------------------------------------------------------------


def unit_kind(symbol: str) -> UnitKind:
    """The row of a unit; one that is not known measures only itself."""
    return _OF_SYMBOL.get(symbol) or UnitKind(symbol, {symbol: _ONE} if symbol else {})


def kind_of(symbol: str) -> str:
    """What a unit measures."""
    return unit_kind(symbol).name


def units_like(symbol: str) -> tuple[str, ...]:
    """The units that values in this one can be shown in."""
    return tuple(unit_kind(symbol).units)


def change(before: str, after: str) -> float:
    """What a value in one unit is to be multiplied by to be in another that measures the same. Raises KeyError."""
    if before == after:
        return 1.0
    sizes = unit_kind(after).sizes
    return (sizes[before] / sizes[after]).factor


def shown_in(symbol: str) -> tuple[tuple[str, float, float], ...]:
    """The units that values in this one are shown in, coarsest first: symbol, how many of this one it is, and the peak value, counted
    in itself, from which it serves; the unit itself where there are no others."""
    own = unit_kind(symbol).shown.get(symbol, ((symbol, 0.0),))
    return tuple((each, change(each, symbol), least) for each, least in own)


@lru_cache(maxsize=64)
def accepted(symbol: str) -> Mapping[str, Fraction | float]:
    """What may be typed behind a number in this unit -> how many of this one it is, exactly where it can be; longest first."""
    row = unit_kind(symbol)
    meant = {**{text: each for each in row.sizes for text in _spellings(each)}, **row.typed}
    made = {text: (row.sizes[each] / row.sizes[symbol]).value for text, each in meant.items()}
    return dict(sorted(made.items(), key=lambda item: -len(item[0])))


def _spellings(symbol: str) -> list[str]:
    """A symbol with its signs, and as they are typed where the keyboard has none."""
    signs = {"·": ("·", "", " "), "²": ("²", "2", "^2"), "³": ("³", "3", "^3"), "µ": ("µ", "u"), "°": ("°", "deg")}
    parts = [signs.get(letter, (letter,)) for letter in symbol]
    return ["".join(text) for text in product(*parts)]


_PLAIN = str.maketrans({"·": "", "*": "", "^": "", " ": "", "_": "", "²": "2", "³": "3", "μ": "µ", "⋅": ""})


def _plain(text: str) -> str:
    return re.sub(r"°|degrees?|deg\b|deg(?=[/s])", "deg", text.translate(_PLAIN)).replace("um", "µm")


_SPELLED: dict[str, str] = {}
for _symbol in _OF_SYMBOL:
    _SPELLED.setdefault(_plain(_symbol), _symbol)
_LOOSELY: dict[str, str] = {}
for _text, _symbol in _SPELLED.items():
    _LOOSELY.setdefault(_text.lower(), _symbol)


def unit_called(text: str) -> str:
    """The symbol of a unit that is spelled somehow, ``deg/s2``, ``Nm``, ``um``; empty where it is none that is known."""
    plain = _plain(text.strip())
    return _SPELLED.get(plain) or _LOOSELY.get(plain.lower(), "")


__all__ = [
    "KINDS", "NO_UNIT", "UNITS", "Size", "Unit", "UnitKind", "accepted", "change", "kind_of", "shown_in", "split_unit", "unit_called",
    "unit_kind", "units_like",
]  # fmt: skip
