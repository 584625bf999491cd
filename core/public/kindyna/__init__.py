"""Cam and mechanism design from Python: ``import kindyna as kd``.

Numbers are in the unit at the end of their name, angles in degrees; arrays are float64 and read-only. A public name is
imported when it is first used.
"""

from __future__ import annotations

from kindyna._checkout import foreign_core

if problem := foreign_core():
    raise ImportError(problem)

from core import __version__ as __version__
from core.errors import KindynaError

__all__ = ["KindynaError"]


def __dir__() -> list[str]:
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
