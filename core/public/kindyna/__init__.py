"""Cam and mechanism design from Python: ``import kindyna as kd``.

Numbers are in the unit at the end of their name, angles in degrees; arrays are float64 and read-only. A public name is
imported when it is first used. ``KINDYNA_KEEP_MEMORY=0`` in the environment leaves the memory settings of the process alone.
"""

from __future__ import annotations

from kindyna._checkout import foreign_core

if problem := foreign_core():
    raise ImportError(problem)

from importlib import import_module
from typing import TYPE_CHECKING, Any

from core import __version__ as __version__

if TYPE_CHECKING:
    from core.errors import KindynaError
    from kindyna._design import Design, FindResult, Optimum, Study, design, example, examples, measured, open
    from kindyna._pictures import Picture
    from kindyna._results import Channel, Clearance, Explanation, Extreme, Finding, ManyResult
    from kindyna._synthesis import LinkageAnswer, SynthesisResult, synthesise

__all__ = [
    "Channel", "Clearance", "Design", "Explanation", "Extreme", "FindResult", "Finding", "KindynaError", "LinkageAnswer", "ManyResult",
    "Optimum", "Picture", "Study", "SynthesisResult", "design", "example", "examples", "measured", "open", "synthesise",
]  # fmt: skip

_MODULES = {
    "_columns": ("KindynaError",),
    "_design": ("Design", "FindResult", "Optimum", "Study", "design", "example", "examples", "measured", "open"),
    "_pictures": ("Picture",),
    "_results": ("Channel", "Clearance", "Explanation", "Extreme", "Finding", "ManyResult"),
    "_synthesis": ("LinkageAnswer", "SynthesisResult", "synthesise"),
}


def __getattr__(name: str) -> Any:
    for module, names in _MODULES.items():
        if name in names:
            globals()[name] = value = getattr(import_module(f"{__name__}.{module}"), name)
            return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
