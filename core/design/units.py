"""The parts of a design in SI units and radians: users type mm, degrees and rpm, the stages see neither, and the change from one to
the other happens here and nowhere else."""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache
from typing import Any

from core.numerics.columns import Column
from core.units import split_unit


class SI:
    """The same part in SI and radians; names lose their unit suffix: ``rod_mm`` -> ``rod`` [m]."""

    def __init__(self, part: Any) -> None:
        for f in fields(part):
            value = getattr(part, f.name)
            name, unit = split_unit(f.name)
            is_number = isinstance(value, int | float | Column) and not isinstance(value, bool)
            self.__dict__[name] = value * unit.factor if is_number else value

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("read-only")


@lru_cache(maxsize=64)
def si(part: Any) -> SI:
    """The part of a design in SI units and radians (cached: parts are frozen)."""
    return SI(part)
