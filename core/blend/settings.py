"""What a designer sets of a blended motion: the settings, constraints on them, and the ranges that they have."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import NamedTuple

from core.blend.equations import Equations, Row
from core.blend.family import Family, Task
from core.blend.polynomials import UNIT, whole

HEIGHTS = ("h1", "h2", "h3", "h4", "h5", "h6")
SETTINGS = (*HEIGHTS, "vcv", "vcv2", "length", "peak", "acceleration")
MAY_VANISH = ("h2", "h5", "length")
"""What may be 0: a constant velocity of no length, where the curves about it meet."""
POINT = "point"
NONLINEAR = ("acceleration", POINT)
_PER_DEGREE = {"vcv": 1, "vcv2": 1, "acceleration": 2}
_SPEEDS = {"vcv": "W", "vcv2": "R"}
ALIKE = 1e-9  # two ranges that are nearer to each other are one
NONE = 1e-12  # a share of the upper end that is 0
TIED = 1e-12  # values that are the same but for rounding


class Constraint(NamedTuple):
    """name of ``SETTINGS`` or ``point``, its value, and where a point lies [deg from the start of the curves]."""

    name: str
    value: float
    at: float = 0.0

    @property
    def linear(self) -> bool:
        """Whether it is a linear equation in x1, x2, ... with t given."""
        return self.name not in NONLINEAR

    @property
    def size(self) -> float:
        """By what a miss is divided: the value, or the stroke (1) for a point and for what shall be 0."""
        return 1.0 if self.name == POINT else self.value or 1.0


def hardest_first(constraints: Sequence[Constraint]) -> list[Constraint]:
    """Those that are not linear, then the others, of each the last given first."""
    return sorted(constraints, key=lambda c: (c.linear, -constraints.index(c)))


def unit_of(name: str, task: Task) -> float:
    """What a setting is where stroke of the rise and span are 1 and so is the setting."""
    if name in ("length", "peak"):
        return task.span
    return task.rise / task.span ** _PER_DEGREE.get(name, 0)


def in_units(constraint: Constraint, task: Task) -> Constraint:
    """The constraint for a stroke and a span of 1."""
    name, value, at_angle = constraint
    return Constraint(name, value / unit_of(name, task), at_angle / task.span)


def ratio(name: str, family: Family) -> tuple[str, str]:
    """A linear setting as a form divided by another; an empty name is 1."""
    if name == "length":
        return ("h2", "W") if family.has_constant_rise else ("h5", "R")
    if name == "peak":
        return "up", "W"
    return _SPEEDS.get(name, name), ""


def equations_of(constraints: Iterable[Constraint], family: Family, equations: Equations) -> list[Row]:
    """The linear constraints as equations, without any rounding: form - value · other form = 0."""
    found = []
    for constraint in constraints:
        if constraint.linear:
            above, below = (equations.exact(name) for name in ratio(constraint.name, family))
            value = whole(constraint.value)
            found.append(tuple([UNIT * a - value * b for a, b in zip(above, below, strict=True)]))
    return found


# -- ranges -----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Range:
    """What a setting may be, from low to high; an open end can only be approached."""

    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    def times(self, factor: float) -> Range:
        """In other units; a lower end that is 0 but for rounding is 0."""
        low = 0.0 if isfinite(self.high) and abs(self.low) <= NONE * abs(self.high) else self.low
        return Range(low * factor, self.high * factor, self.low_open, self.high_open)


def merged(ranges: Iterable[Range]) -> list[Range]:
    """The same values in order, ranges that meet made one."""
    found: list[Range] = []
    for r in sorted(ranges, key=lambda r: (r.low, r.low_open)):
        if found and r.low <= found[-1].high + ALIKE * abs(found[-1].high):
            last = found.pop()
            high = max(last.high, r.high)
            low_open = last.low_open and (r.low_open or not tied(r.low, last.low))
            open_ = all(q.high_open for q in (last, r) if tied(q.high, high))
            r = Range(last.low, high, low_open, open_)
        found.append(r)
    return found


def tied(a: float, b: float) -> bool:
    return a == b or (isfinite(a - b) and abs(a - b) <= TIED * max(abs(a), abs(b)))


def hull(ranges: Sequence[Range]) -> tuple[float, float]:
    """The ends of all of them."""
    return ranges[0].low, ranges[-1].high
