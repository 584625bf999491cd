"""Units of measure: one row a quantity, with the units of files, of the display, and those that may be typed.

Users type mm, degrees and rpm; computations use SI and radians only.
"""

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
    """Size of a unit in SI units, exactly: over/under times a power of π."""

    over: int
    under: int = 1
    pi: int = 0

    def __mul__(self, other: int | Size) -> Size:
        factor = other if isinstance(other, Size) else Size(other)
        return _reduced(self.over * factor.over, self.under * factor.under, self.pi + factor.pi)

    def __truediv__(self, other: int | Size) -> Size:
        divisor = other if isinstance(other, Size) else Size(other)
        return _reduced(self.over * divisor.under, self.under * divisor.over, self.pi - divisor.pi)

    @property
    def factor(self) -> float:
        """The size as a float, rounded once; rounded twice where it contains π."""
        if not self.pi:
            return self.over / self.under
        over, under = self.over, self.under
        return over * math.pi**self.pi / under if self.pi > 0 else over / (under * math.pi**-self.pi)

    @property
    def value(self) -> Fraction | float:
        """The size as a fraction; a float where it contains π."""
        from fractions import Fraction

        return self.factor if self.pi else Fraction(self.over, self.under)


def _reduced(over: int, under: int, pi: int) -> Size:
    common = math.gcd(over, under)
    return Size(over // common, under // common, pi)


@frozen
class UnitKind:
    """The units of one quantity.

    Attributes
    ----------
    name : the quantity
    units : symbol as printed -> size, in the order of the menus
    stored : suffix of fields, keys and columns -> symbol of their unit
    others : symbol -> size of units that are not on the menus; they can be typed, or show very large or small values
    typed : further spelling -> symbol; the symbols themselves can be typed without special characters: ``Nm``, ``m/s2``, ``deg``
    shown : symbol of a unit -> units that show its values, coarsest first, each with the least peak value, in that unit, at
        which it is used; values in a unit without an entry are shown in that unit
    decimals : decimals of a rounded number in a file, in addition to those of a length in mm
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
        """Symbol -> size of all units."""
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
    UnitKind("length by angle", {"mm/°": _MILLI / _DEGREE, "mm/rad": _MILLI, "in/°": _INCH / _DEGREE},
             {"mm_per_deg": "mm/°"}, decimals=3),
    UnitKind("length by angle²", {"mm/°²": _MILLI / _DEGREE / _DEGREE, "mm/rad²": _MILLI, "in/°²": _INCH / _DEGREE / _DEGREE},
             {"mm_per_deg2": "mm/°²"}, decimals=5),
    UnitKind("force", {"N": _ONE, "mN": _MILLI, "kN": _KILO, "MN": _MEGA, "lbf": _POUND_FORCE}, {"n": "N"}, {"GN": _GIGA},
             shown={"N": (("GN", 2.0), ("MN", 2.0), ("kN", 2.0), ("N", 0.2), ("mN", 0.0))}),
    UnitKind("torque", {"N·m": _ONE, "N·mm": _MILLI, "kN·m": _KILO, "lbf·in": _POUND_FORCE * _INCH}, {"nm": "N·m"},
             {"GN·m": _GIGA, "MN·m": _MEGA, "mN·m": _MILLI},
             shown={"N·m": (("GN·m", 2.0), ("MN·m", 2.0), ("kN·m", 2.0), ("N·m", 0.2), ("mN·m", 0.0))}),
    UnitKind("stress", {"MPa": _MEGA, "Pa": _ONE, "kPa": _KILO, "GPa": _GIGA, "N/mm²": _MEGA, "bar": _ONE * 10**5,
             "psi": _POUND_FORCE / _INCH / _INCH},
             {"mpa": "MPa", "gpa": "GPa"}),
    UnitKind("pressure times velocity", {"MPa·m/s": _MEGA, "psi·ft/min": _POUND_FORCE / _INCH / _INCH * _INCH * 12 / _MINUTE},
             {"mpa_m_s": "MPa·m/s"}),
    UnitKind("mass", {"kg": _ONE, "g (mass)": _MILLI, "t": _KILO}, {"kg": "kg"}, {"lb": _POUND}, {"g": "g (mass)"}),
    UnitKind("density", {"kg/m³": _ONE, "g/cm³": _KILO}, {"kg_m3": "kg/m³"}),
    UnitKind("inertia", {"kg·m²": _ONE, "lb·in²": _POUND * _INCH * _INCH}, {"kg_m2": "kg·m²"},
             {"kg·cm²": _ONE / 10**4, "kg·mm²": _MICRO, "g·cm²": _ONE / 10**7}),
    UnitKind("stiffness", {"N/mm": _KILO, "N/m": _ONE, "kN/mm": _MEGA, "lbf/in": _POUND_FORCE / _INCH},
             {"n_per_mm": "N/mm"}, {"kN/m": _KILO}),
    UnitKind("damping", {"N·s/mm": _KILO, "N·s/m": _ONE, "lbf·s/in": _POUND_FORCE / _INCH}, {"n_s_per_mm": "N·s/mm"}),
    UnitKind("torsional stiffness", {"N·m/rad": _ONE, "lbf·in/rad": _POUND_FORCE * _INCH},
             {"nm_per_rad": "N·m/rad"}, {"N·m/°": _ONE / _DEGREE}),
    UnitKind("torsional damping", {"N·m·s/rad": _ONE, "lbf·in·s/rad": _POUND_FORCE * _INCH},
             {"nm_s_per_rad": "N·m·s/rad"}),
    UnitKind("curvature", {"1/mm": _KILO, "1/m": _ONE, "1/in": _ONE / _INCH}, {"per_mm": "1/mm"}, {"1/µm": _MEGA, "1/km": _MILLI},
             shown={"1/mm": (("1/µm", 2.0), ("1/mm", 0.2), ("1/m", 0.2), ("1/km", 0.0))}),
    UnitKind("energy", {"J": _ONE, "mJ": _MILLI, "kJ": _KILO}, {"j": "J"}),
    UnitKind("power", {"W": _ONE, "mW": _MILLI, "kW": _KILO}, {"w": "W"}),
    UnitKind("ratio", {"%": _ONE / 100}),
)  # fmt: skip

KINDS: Mapping[str, UnitKind] = MappingProxyType({row.name: row for row in _ROWS})
_ROW_BY_SYMBOL: Mapping[str, UnitKind] = MappingProxyType({symbol: row for row in _ROWS for symbol in row.units})


# -- units of fields, keys and columns ----------------------------------------------------------------------


@frozen
class Unit:
    """A unit: its symbol as printed, and its factor to SI."""

    symbol: str
    factor: float


UNITS: Mapping[str, Unit] = MappingProxyType(
    {end: Unit(symbol, row.units[symbol].factor) for row in _ROWS for end, symbol in row.stored.items()}
)
"""Suffix of a name -> its unit."""
NO_UNIT = Unit("", 1.0)


@lru_cache(maxsize=1024)
def split_unit(name: str) -> tuple[str, Unit]:
    """Split a name from its unit: ``rod_mass_kg`` gives (``rod_mass``, kg). The longest suffix wins; a name may have no unit."""
    parts = name.split("_")
    for i in range(1, len(parts)):
        suffix = "_".join(parts[i:])
        if suffix in UNITS:
            return "_".join(parts[:i]), UNITS[suffix]
    return name, NO_UNIT


# -- units by their symbols ---------------------------------------------------------------------------------


def unit_kind(symbol: str) -> UnitKind:
    """Row of a unit; an unknown unit has a row that contains only it."""
    return _ROW_BY_SYMBOL.get(symbol) or UnitKind(symbol, {symbol: _ONE} if symbol else {})


def quantity_kind(symbol: str) -> str:
    """Quantity that a unit measures."""
    return unit_kind(symbol).name


def compatible_units(symbol: str) -> tuple[str, ...]:
    """Units of the same quantity, in the order of the menus."""
    return tuple(unit_kind(symbol).units)


def conversion_factor(before: str, after: str) -> float:
    """Factor that converts a value between two units of one quantity.

    Raises
    ------
    KeyError
        Where the units measure different quantities.
    """
    if before == after:
        return 1.0
    sizes = unit_kind(after).sizes
    return (sizes[before] / sizes[after]).factor


def display_units(symbol: str) -> tuple[tuple[str, float, float], ...]:
    """Units that show values of a unit, coarsest first.

    Returns
    -------
    tuple of (symbol, factor, least)
        The factor from the display unit to the given one, and the least peak value, in the display unit, at which it is used.
    """
    units = unit_kind(symbol).shown.get(symbol, ((symbol, 0.0),))
    return tuple((unit, conversion_factor(unit, symbol), least) for unit, least in units)


@lru_cache(maxsize=64)
def accepted_units(symbol: str) -> Mapping[str, Fraction | float]:
    """Spelling of a unit that may be typed after a number -> its size in the given unit, exact without π; longest first."""
    row = unit_kind(symbol)
    spellings = {**{text: unit for unit in row.sizes for text in _spellings(unit)}, **row.typed}
    sizes = {text: (row.sizes[unit] / row.sizes[symbol]).value for text, unit in spellings.items()}
    return dict(sorted(sizes.items(), key=lambda item: -len(item[0])))


def _spellings(symbol: str) -> list[str]:
    """A symbol as printed, and as typed on a keyboard without its special characters."""
    signs = {"·": ("·", "", " "), "²": ("²", "2", "^2"), "³": ("³", "3", "^3"), "µ": ("µ", "u"), "°": ("°", "deg")}
    parts = [signs.get(character, (character,)) for character in symbol]
    return ["".join(text) for text in product(*parts)]


_PLAIN = str.maketrans({"·": "", "*": "", "^": "", " ": "", "_": "", "²": "2", "³": "3", "μ": "µ", "⋅": ""})


def _plain(text: str) -> str:
    return re.sub(r"°|degrees?|deg\b|deg(?=[/s])", "deg", text.translate(_PLAIN)).replace("um", "µm")


_SYMBOLS: dict[str, str] = {}  # plain spelling -> symbol
for _symbol in _ROW_BY_SYMBOL:
    _SYMBOLS.setdefault(_plain(_symbol), _symbol)
_LOWER_CASE_SYMBOLS: dict[str, str] = {}
for _text, _symbol in _SYMBOLS.items():
    _LOWER_CASE_SYMBOLS.setdefault(_text.lower(), _symbol)


def unit_symbol(text: str) -> str:
    """Symbol of a unit in any spelling, ``deg/s2``, ``Nm``, ``um``; empty for an unknown unit."""
    plain = _plain(text.strip())
    return _SYMBOLS.get(plain) or _LOWER_CASE_SYMBOLS.get(plain.lower(), "")


__all__ = [
    "KINDS", "NO_UNIT", "UNITS", "Size", "Unit", "UnitKind", "accepted_units", "compatible_units", "conversion_factor",
    "display_units", "quantity_kind", "split_unit", "unit_kind", "unit_symbol",
]  # fmt: skip
