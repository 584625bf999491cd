"""Units in field names. Users type mm, degrees and rpm; the stages see SI and radians only, and the change
from one to the other happens here and nowhere else."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from functools import lru_cache
from types import MappingProxyType
from typing import Any

from core.frozen import frozen


@frozen
class Unit:
    """symbol as printed; factor from the user's unit to SI."""

    symbol: str
    factor: float


UNITS: Mapping[str, Unit] = MappingProxyType(
    {
        "mm": Unit("mm", 1e-3),
        "deg": Unit("°", math.pi / 180.0),
        "rpm": Unit("rpm", math.pi / 30.0),
        "kg": Unit("kg", 1.0),
        "kg_m2": Unit("kg·m²", 1.0),
        "n": Unit("N", 1.0),
        "mpa": Unit("MPa", 1e6),
        "gpa": Unit("GPa", 1e9),
        "nm": Unit("N·m", 1.0),
        "n_per_mm": Unit("N/mm", 1e3),
        "n_s_per_mm": Unit("N·s/mm", 1e3),
        "j": Unit("J", 1.0),
        "w": Unit("W", 1.0),
        "m_s2": Unit("m/s²", 1.0),
        "nm_s_per_rad": Unit("N·m·s/rad", 1.0),
        "nm_per_rad": Unit("N·m/rad", 1.0),
        "mm_s": Unit("mm/s", 1e-3),
        "mm_s2": Unit("mm/s²", 1e-3),
        "mm_s3": Unit("mm/s³", 1e-3),
        "deg_s": Unit("°/s", math.pi / 180.0),
        "deg_s2": Unit("°/s²", math.pi / 180.0),
        "deg_s3": Unit("°/s³", math.pi / 180.0),
        "rad_s": Unit("rad/s", 1.0),
        "rad_s2": Unit("rad/s²", 1.0),
        "per_mm": Unit("1/mm", 1e3),
    }
)
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


class SI:
    """The same part in SI and radians; names lose their unit suffix: ``rod_mm`` -> ``rod`` [m]."""

    def __init__(self, part: Any) -> None:
        for f in fields(part):
            value = getattr(part, f.name)
            name, unit = split_unit(f.name)
            is_number = isinstance(value, int | float) and not isinstance(value, bool)
            self.__dict__[name] = value * unit.factor if is_number else value

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("read-only")


@lru_cache(maxsize=64)
def si(part: Any) -> SI:
    """The part of a design in SI units and radians (cached: parts are frozen)."""
    return SI(part)
