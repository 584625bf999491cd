"""What a designer may ask of a blended motion, as equations and measures of a family."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from core.blend.equations import Equations, Row
from core.blend.family import Family, Task
from core.blend.polynomials import ONE, weighed, whole

HEIGHTS = ("h1", "h2", "h3", "h4", "h5", "h6")
SETTINGS = (*HEIGHTS, "vcv", "vcv2", "length", "peak", "acceleration")
MAY_VANISH = ("h2", "h5", "length")
"""What may be 0: a constant velocity of no length, where the curves about it meet."""
POINT = "point"
_PER_DEGREE = {"vcv": 1, "vcv2": 1, "acceleration": 2}
_SPEEDS = {"vcv": "W", "vcv2": "R"}
BENT = ("acceleration", POINT)
"""What is not linear in the linear numbers of a family."""


class Wish(NamedTuple):
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


def size_of(name: str, task: Task) -> float:
    """The unit in which a setting is measured where stroke of the rise and span are 1."""
    if name in ("length", "peak"):
        return task.span
    return task.rise / task.span ** _PER_DEGREE.get(name, 0)


def in_units(wish: Wish, task: Task) -> Wish:
    """The wish for a stroke and a span of 1."""
    return Wish(wish.name, wish.value / size_of(wish.name, task), wish.at / task.span)


def ratio(name: str, family: Family) -> tuple[str, str]:
    """A linear setting as a form divided by another; an empty name is 1."""
    if name == "length":
        return ("h2", "W") if family.has_constant_rise else ("h5", "R")
    if name == "peak":
        return "up", "W"
    return _SPEEDS.get(name, name), ""


def equation(wish: Wish, family: Family, equations: Equations) -> Row:
    """A linear wish as an equation, without any rounding."""
    above, below = ratio(wish.name, family)
    value = whole(wish.value)
    rows = zip(equations.exact(above), equations.exact(below), strict=True)
    return tuple([weighed(ONE, a, value, b) for a, b in rows])
