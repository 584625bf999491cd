"""Points of a family along one number: where they are feasible and what settings are there, all of it polynomials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from math import inf

import numpy as np

from core.blend.equations import Equations, Row, SolutionSpace
from core.blend.evaluator import EPS, ROUNDING, Place
from core.blend.family import Family
from core.blend.polynomials import (
    UNIT,
    Floats,
    Polynomial,
    quotient_at,
    roots,
    rounded,
    vanishes,
    whole,
)
from core.blend.request import Constraint, ratio

OPEN = 1e-9  # a height that must be above 0 this small at the end of a range: an open end
SAME = 1e-9  # a setting that varies by less over all that the others leave is determined by them
_ENDLESS = 1e6  # times the stroke: a height beside a pole
_EDGE = 1e-7  # how far beside a place where 0/0 stands a quotient is taken, as a share of the stretch

Quotient = tuple[Polynomial, Polynomial]


@dataclass(frozen=True)
class Stretch:
    """A feasible part of a curve, from low to high of its number."""

    low: float
    high: float


@dataclass(frozen=True)
class Extreme:
    """A value that a setting takes at p, or only approaches."""

    value: float
    p: float
    open: bool


@dataclass(frozen=True)
class Curve:
    """Points along a number p, 0 < p < top: x_j = x[j-1](p)/below(p).

    t       its value; None where p is t
    closed  heights that are 0 all along are let pass, though they must be above 0
    """

    family: Family
    equations: Equations
    t: float | None
    x: tuple[Polynomial, ...]
    below: Polynomial
    top: float
    closed: bool = False

    @classmethod
    def of(cls, family: Family, space: SolutionSpace, closed: bool = False) -> Curve:
        """A solution space of one free number."""
        rows, top = space.leading()
        return cls(family, space.equations, space.t, tuple(r[0] for r in rows), space.below, top, closed)

    def over(self, name: str) -> Polynomial:
        """A form, or 1 for an empty name, as a polynomial of p; all times the same one."""
        row = form_row(self.equations, name, self.t)
        return sum([p * x for p, x in zip(row[1:], self.x, strict=True) if p and x], row[0] * self.below)

    @cached_property
    def heights(self) -> dict[str, Polynomial]:
        return {name: self.over(name) for name in (*self.family.positive, *self.family.constant)}

    @cached_property
    def under(self) -> Polynomial:
        """What all forms are divided by."""
        return self.over("")

    @cached_property
    def _rounded(self) -> dict[str, Floats]:
        """The heights, and what they are divided by under an empty name."""
        rows = {**self.heights, "": self.under}
        return dict(zip(rows, rounded(rows.values()), strict=True))

    @cached_property
    def _places(self) -> list[Floats]:
        return rounded([*self.x, self.below])

    def place(self, p: float) -> Place:
        """t and the x there."""
        *numerators, below = self._places
        return (p if self.t is None else self.t), tuple(quotient_at(n, below, p) for n in numerators)

    def places(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same at many p (n,): t (n,) and x (numbers, n)."""
        with np.errstate(all="ignore"):
            rows = polynomials_at(self._places, p)
            return (p if self.t is None else np.full_like(p, self.t)), rows[:-1] / rows[-1]

    # -- where it is feasible -----------------------------------------------------------------------------

    @cached_property
    def stretches(self) -> list[Stretch]:
        """Where every height is what it must be: cut at the roots of all of them, each part tried in its middle."""
        cuts = sorted({p for polynomial in (*self.heights.values(), self.under) for p in roots(polynomial, 0.0, self.top)})
        found: list[Stretch] = []
        for low, high in pairwise([0.0, *(p for p in cuts if 0.0 < p < self.top), self.top]):
            if not self.is_feasible(between(low, high)):
                continue
            if found and found[-1].high == low and self._goes_on(low):
                found[-1] = Stretch(found[-1].low, high)
            else:
                found.append(Stretch(low, high))
        return found

    def is_feasible(self, p: float) -> bool:
        """Whether every height is what it must be."""
        if not all(-ROUNDING <= self.height(n, p) < _ENDLESS for n in self.family.constant):
            return False
        positive = [n for n in self.family.positive if self.heights[n] or not self.closed]
        return all(0.0 < self.height(n, p) < _ENDLESS and not vanishes(self._rounded[n], p, EPS) for n in positive)

    def height(self, name: str, p: float) -> float:
        """A height, as a share of the stroke of the rise."""
        return quotient_at(self._rounded[name], self._rounded[""], p)

    def _goes_on(self, p: float) -> bool:
        """Whether a cut between two feasible parts is none: a height of constant velocity touches 0, or 0/0 stands."""
        return vanishes(self._rounded[""], p, SAME) or self.is_feasible(p)

    def is_open(self, p: float) -> bool:
        """Whether an end of a stretch can only be approached."""
        return p in (0.0, self.top) or any(self.height(n, p) <= OPEN for n in self.family.positive)

    # -- settings -----------------------------------------------------------------------------------------

    def quotients(self, name: str) -> list[Quotient]:
        """A setting as a quotient; the acceleration as the greatest of several, each factor S²/h."""
        if name != "acceleration":
            above, below = ratio(name, self.family)
            return [(self.over(above), self.over(below))]
        found = []
        for row in self.family.accelerations:
            speed = self.over(row.speed)
            found.append((whole(row.factor) * (speed * speed), UNIT * (self.heights[row.height] * self.under)))
        return found

    def where(self, constraint: Constraint) -> list[float]:
        """All p at which a setting may have its value, feasible or not; of an acceleration those of every curve."""
        value = whole(constraint.value)
        quotients = self.quotients(constraint.name)
        return [p for above, below in quotients for p in roots(UNIT * above - value * below, 0.0, self.top)]

    def extremes(self, name: str, stretch: Stretch) -> list[Extreme]:
        """What a setting may have as its least and its greatest value on a stretch."""
        quotients = self.quotients(name)
        shut = self.closed and not all(self.heights[n] for n in self.family.positive)
        inside = between(stretch.low, stretch.high)
        open_ = {p: self.is_open(p) for p in (stretch.low, stretch.high)}
        places = [stretch.low, *sorted(set(_turns(quotients, stretch))), inside, stretch.high]
        if any(not below for _, below in quotients):  # the acceleration of a height that is 0 all along
            return [Extreme(inf, p, True) for p in places]
        pairs = [rounded(q) for q in quotients]
        return [
            Extreme(max(_value(above, below, p, inside) for above, below in pairs), p, open_.get(p, shut)) for p in places
        ]


def form_row(equations: Equations, name: str, t: float | None) -> Row:
    """A form, or 1 for an empty name, by 1, x1, ...: polynomials in t, or numbers where t is given; all times the same."""
    row = equations.exact(name)
    return row if t is None else at_t(row, t)


def at_t(row: Row, t: float) -> Row:
    """A row of polynomials in t as a row of numbers, all times the same one."""
    powers = [whole(t**e) for e in range(max(map(len, row)))]
    return tuple([Polynomial([sum(c * p for c, p in zip(r.coefficients, powers, strict=False))]) for r in row])


def polynomials_at(rows: Sequence[Floats], p: np.ndarray) -> np.ndarray:
    """Polynomials at many p (n,): (polynomials, n)."""
    return np.array([np.polyval(row[::-1], p) if row else np.zeros_like(p) for row in rows])


def _turns(quotients: Sequence[Quotient], stretch: Stretch) -> Iterable[float]:
    """Where a quotient has an extreme, or two are equal."""
    for above, below in quotients:
        slope = above.derivative() * below - above * below.derivative()
        yield from roots(slope, stretch.low, stretch.high)
    for (a, b), (c, d) in combinations(quotients, 2):
        yield from roots(a * d - c * b, stretch.low, stretch.high)


def _value(above: Floats, below: Floats, p: float, inside: float) -> float:
    if 0.0 < p < inf and vanishes(below, p, 1e-13):
        if not vanishes(above, p, SAME):
            return inf
        p += _EDGE * (inside - p)
    return quotient_at(above, below, p)


def between(low: float, high: float) -> float:
    """A number inside."""
    if high == inf:
        return 2.0 * low if low > 0.0 else 1.0
    return 0.5 * (low + high)
