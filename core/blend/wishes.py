"""What a designer may ask of a blended motion, measured in many points of a family at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from core.blend.curves import ELEMENTS
from core.blend.family import Family, Task, Values
from core.laws import find_law

HEIGHTS = ("h1", "h2", "h3", "h4", "h5", "h6")
SETTINGS = (*HEIGHTS, "vcv", "vcv2", "length", "peak", "acceleration")
POINT = "point"
BENT = ("acceleration", POINT)
"""What is not linear in the linear numbers of a family."""

Found = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Wish:
    """name of ``SETTINGS`` or ``point``, its value, and where a point lies [deg from the start of the curves]."""

    name: str
    value: float
    at: float = 0.0

    @property
    def linear(self) -> bool:
        return self.name not in BENT


def hardest_first(wishes: Sequence[Wish]) -> list[Wish]:
    """Those that are not linear, then the others, of each the last said first."""
    return sorted(wishes, key=lambda w: (w.linear, -wishes.index(w)))


def level_at(family: Family, task: Task, found: Found, at: float) -> np.ndarray:
    """Displacement above the lowest level at an angle from the start of the curves."""
    heights, spans = family.parts(task, found)
    start, level = 0.0, np.full(heights.shape[1], max(0.0, task.back - task.rise) if family.sequence.back else 0.0)
    place = level.copy()
    for name, height, span in zip(family.sequence.curves, heights, spans, strict=True):
        law = find_law(name.lower())
        assert law is not None
        way = ELEMENTS[name].way
        u = np.where(span > 0.0, (at - start) / np.where(span > 0.0, span, 1.0), 1.0)
        reached = level + way * height * law(np.clip(u, 0.0, 1.0))[0]
        place = np.where(at >= start, reached, place)
        start, level = start + span, level + way * height
    return place


def peak_acceleration(family: Family, task: Task, found: Found) -> np.ndarray:
    """Largest |a| [per deg²]."""
    heights, spans = family.parts(task, found)
    rows = [
        ELEMENTS[name].peak * h / (b * b)
        for name, h, b in zip(family.sequence.curves, heights, spans, strict=True)
        if ELEMENTS[name].peak
    ]
    return np.max(rows, axis=0)


def _length(family: Family, task: Task, found: Found) -> Values:
    constant = found["h2"] if family.has_constant_rise else found["h5"] / found["r"]
    return constant * task.span / found["W"]


MEASURES: Mapping[str, Callable[[Family, Task, Found], Values]] = MappingProxyType(
    {
        "vcv": lambda family, task, found: found["W"] / task.span,
        "vcv2": lambda family, task, found: found["r"] * found["W"] / task.span,
        "length": _length,
        "peak": lambda family, task, found: family.rise_work(found) * task.span / found["W"],
        "acceleration": peak_acceleration,
    }
)

# The equation of a wish multiplied out, so that it is linear in the linear numbers.
_MISSES: Mapping[str, Callable[[Family, Task, Found, float], Values]] = MappingProxyType(
    {
        "vcv": lambda family, task, found, v: found["W"] - v * task.span,
        "vcv2": lambda family, task, found, v: found["r"] * found["W"] - v * task.span,
        "length": lambda family, task, found, v: (
            found["h2"] * task.span - v * found["W"]
            if family.has_constant_rise
            else found["h5"] * task.span - v * found["r"] * found["W"]
        ),
        "peak": lambda family, task, found, v: family.rise_work(found) * task.span - v * found["W"],
    }
)


def measure(wish: Wish, family: Family, task: Task, found: Found) -> np.ndarray:
    """What is asked, in points of a family (n,)."""
    if wish.name == POINT:
        return level_at(family, task, found, wish.at)
    if wish.name in HEIGHTS:
        return found[wish.name]
    return MEASURES[wish.name](family, task, found)


def miss(wish: Wish, family: Family, task: Task, found: Found) -> np.ndarray:
    """A linear wish's equation, left side minus right."""
    if wish.name in HEIGHTS:
        return found[wish.name] - wish.value
    return _MISSES[wish.name](family, task, found, wish.value)
