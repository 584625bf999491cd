"""In a checkout ``core`` is a package of its own, whose name another folder may have; in the wheel it is inside ``kindyna``."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def foreign_core() -> str:
    """Return what is imported in place of the checkout's ``core``, and the remedy, in one line; empty where nothing is."""
    if (_PACKAGE / "resources").is_dir():  # the wheel
        return ""
    package = _PACKAGE.parents[1]
    try:
        spec = find_spec(package.name)
    except ValueError:  # put into sys.modules without one
        spec = None
    place = "" if spec is None else str(next(iter(spec.submodule_search_locations or ()), spec.origin))
    if place and Path(place).resolve() == package:
        return ""
    return (
        f"{place or 'a module without a file'} is imported as {package.name} in place of {package}, which kindyna requires in a checkout: "
        f"rename it, take its folder off sys.path, or install kindyna from its wheel, which has no module of that name"
    )
