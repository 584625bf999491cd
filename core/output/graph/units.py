"""Units of the columns of a graph: which they are by a column's name, what they measure, and the change from one to another."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from types import MappingProxyType

from core.design import split_unit
from core.measured.units import unit_in

_TURN = 2.0 * math.pi
_INCH, _GRAVITY, _POUND = 0.0254, 9.80665, 4.4482216152605

KINDS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "length": {"mm": 1e-3, "µm": 1e-6, "cm": 1e-2, "m": 1.0, "in": _INCH, "thou": 1e-3 * _INCH, "ft": 12.0 * _INCH},
        "angle": {"°": _TURN / 360.0, "rad": 1.0, "turns": _TURN},
        "time": {"s": 1.0, "ms": 1e-3, "min": 60.0},
        "velocity": {"mm/s": 1e-3, "µm/s": 1e-6, "cm/s": 1e-2, "m/s": 1.0, "in/s": _INCH},
        "acceleration": {"mm/s²": 1e-3, "m/s²": 1.0, "in/s²": _INCH, "g": _GRAVITY},
        "jerk": {"mm/s³": 1e-3, "m/s³": 1.0},
        "angular velocity": {"°/s": _TURN / 360.0, "rad/s": 1.0, "rpm": _TURN / 60.0, "Hz": _TURN},
        "angular acceleration": {"°/s²": _TURN / 360.0, "rad/s²": 1.0},
        "angular jerk": {"°/s³": _TURN / 360.0, "rad/s³": 1.0},
        "length by angle": {"mm/°": 1e-3 * 360.0 / _TURN, "mm/rad": 1e-3, "in/°": _INCH * 360.0 / _TURN},
        "length by angle²": {"mm/°²": 1e-3 * (360.0 / _TURN) ** 2, "mm/rad²": 1e-3},
        "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": _POUND},
        "torque": {"N·m": 1.0, "N·mm": 1e-3, "kN·m": 1e3},
        "stress": {"MPa": 1e6, "Pa": 1.0, "kPa": 1e3, "GPa": 1e9, "N/mm²": 1e6, "bar": 1e5},
        "mass": {"kg": 1.0, "g (mass)": 1e-3, "t": 1e3},
        "inertia": {"kg·m²": 1.0},
        "stiffness": {"N/mm": 1e3, "N/m": 1.0, "kN/mm": 1e6},
        "damping": {"N·s/mm": 1e3, "N·s/m": 1.0},
        "torsional stiffness": {"N·m/rad": 1.0},
        "curvature": {"1/mm": 1e3, "1/m": 1.0},
        "energy": {"J": 1.0, "mJ": 1e-3, "kJ": 1e3},
        "power": {"W": 1.0, "mW": 1e-3, "kW": 1e3},
        "ratio": {"%": 0.01},
    }
)
"""What is measured -> its units by symbol, and how many of the SI unit each is."""

_KIND: Mapping[str, str] = MappingProxyType({symbol: kind for kind, units in KINDS.items() for symbol in units})
_PLAIN = str.maketrans({"·": "", "*": "", "^": "", " ": "", "_": "", "²": "2", "³": "3", "μ": "µ", "⋅": ""})


def _plain(text: str) -> str:
    return re.sub(r"°|degrees?|deg\b|deg(?=[/s])", "deg", text.translate(_PLAIN)).replace("um", "µm")


_SPELLED: dict[str, str] = {}
for _symbol in _KIND:
    _SPELLED.setdefault(_plain(_symbol), _symbol)
_LOOSELY: dict[str, str] = {}
for _text, _symbol in _SPELLED.items():
    _LOOSELY.setdefault(_text.lower(), _symbol)


def unit_called(text: str) -> str:
    """The symbol of a unit that is spelled somehow, ``deg/s2``, ``Nm``, ``um``; empty where it is none that is known."""
    plain = _plain(text.strip())
    return _SPELLED.get(plain) or _LOOSELY.get(plain.lower(), "")


def unit_of_column(name: str) -> str:
    """The unit that a column's name ends in: as in our own tables (``force_n``), in brackets, behind a comma, or as measured
    tables have it; what stands in brackets and is no known unit is taken as it is; empty where there is none."""
    inside = re.findall(r"[\[(]([^\])]*)[\])]\s*$", name)
    if inside:
        return unit_called(inside[-1]) or inside[-1].strip()
    own = split_unit(name.strip())[1].symbol
    if own:
        return own
    tail = re.split(r",\s*|_", name.strip())
    return unit_called(unit_in(name)) or (unit_called(tail[-1]) if len(tail) > 1 else "")


def without_unit(name: str) -> str:
    """A column's name in words: ``contact_force_n`` -> ``contact force``."""
    text = re.sub(r"\s*[\[(][^\])]*[\])]\s*$", "", name.strip())
    short, unit = split_unit(text)
    if not unit.symbol and unit_of_column(text):
        short = re.sub(r"(_|,\s*)[^_,]*$", "", text)
        words = re.fullmatch(r"(.*\S)\s+(\S+)", short)  # "Hub mm", "Hub in mm"
        short = re.sub(r"\s+in$", "", words[1]) if short == text and words and unit_called(words[2]) else short
    return short.replace("_", " ").strip()


def kind_of(symbol: str) -> str:
    """What a unit measures; one that is not known only itself."""
    return _KIND.get(symbol, symbol)


def units_like(symbol: str) -> tuple[str, ...]:
    """The units that values in this one can be shown in."""
    return tuple(KINDS.get(kind_of(symbol), ())) or ((symbol,) if symbol else ())


def change(before: str, after: str) -> float:
    """What a value in one unit is to be multiplied by to be in another that measures the same. Raises KeyError."""
    if before == after:
        return 1.0
    units = KINDS[kind_of(before)]
    return units[before] / units[after]


__all__ = ["KINDS", "change", "kind_of", "unit_called", "unit_of_column", "units_like", "without_unit"]
