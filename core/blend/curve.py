"""Points of a family along one number: where they are feasible and what can be measured there, all of it polynomials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from math import inf

import numpy as np

from core.blend.equations import Equations, Row
from core.blend.family import Bend, Family
from core.blend.flats import Flat
from core.blend.metering import EPS, ROUNDING
from core.blend.polynomials import (
    NOTHING,
    ONE,
    Exact,
    Poly,
    crossed,
    derivative,
    plus,
    quotient_at,
    roots,
    rounded,
    scaled,
    times,
    trimmed,
    vanishes,
    weighed,
    whole,
)
from core.blend.wishes import Wish, ratio

OPEN = 1e-9  # a height that must be above 0 this small at the end of a range: an open end
SAME = 1e-9  # a setting that varies by less over all that the others leave is determined by them
_ENDLESS = 1e6  # times the stroke: a height beside a pole
_EDGE = 1e-7  # how far beside a place where 0/0 stands it is looked, as a share of the stretch

Quotient = tuple[Exact, Exact]


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
    limits  what else must not be below 0, as polynomials
    """

    family: Family
    equations: Equations
    t: float | None
    x: tuple[Exact, ...]
    below: Exact
    top: float
    closed: bool = False
    limits: tuple[Exact, ...] = ()

    @classmethod
    def of(cls, family: Family, flat: Flat, closed: bool = False) -> Curve:
        """A flat of one free number."""
        if flat.t is None:
            return cls(family, flat.equations, None, tuple(r[0] for r in flat.x), flat.below, flat.equations.top, closed)
        rows = tuple(trimmed([whole(v) for v in row]) for row in flat.numbers)
        return cls(family, flat.equations, flat.t, rows, (ONE,), flat.equations.tops[flat.free[0] - 1], closed)

    def over(self, name: str) -> Exact:
        """A form, or 1 for an empty name, as a polynomial of p; all times the same one."""
        return self.over_row(self.equations.exact(name))

    def over_row(self, row: Row) -> Exact:
        """The same of any row of polynomials in t."""
        row = row if self.t is None else at_t(row, self.t)
        made = times(row[0], self.below)
        for p, numerator in zip(row[1:], self.x, strict=True):
            if p and numerator:
                made = plus(made, times(p, numerator))
        return made

    @cached_property
    def under(self) -> Exact:
        return self.over("")

    @cached_property
    def heights(self) -> dict[str, Exact]:
        return {name: self.over(name) for name in (*self.family.positive, *self.family.constant)}

    @cached_property
    def _rounded(self) -> dict[str, Poly]:
        """The heights, and what they are divided by under an empty name."""
        rows = {**self.heights, "": self.under}
        return dict(zip(rows, rounded(list(rows.values())), strict=True))

    @cached_property
    def _places(self) -> tuple[list[Poly], Poly]:
        made = rounded([*self.x, self.below])
        return made[:-1], made[-1]

    def place(self, p: float) -> tuple[float, tuple[float, ...]]:
        """t and the x there."""
        numerators, below = self._places
        return (p if self.t is None else self.t), tuple(quotient_at(n, below, p) for n in numerators)

    def places(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same at many p (n,): t (n,) and x (numbers, n)."""
        numerators, below = self._places
        with np.errstate(all="ignore"):
            rows = [np.polyval(n[::-1], p) if n else np.zeros_like(p) for n in (*numerators, below)]
            x = np.array(rows[:-1]).reshape(len(self.x), p.size) / rows[-1]
        return (p if self.t is None else np.full_like(p, self.t)), x

    # -- where it is feasible -----------------------------------------------------------------------------

    @cached_property
    def stretches(self) -> list[Stretch]:
        """Where every height is what it must be: cut at the roots of all of them, each part tried in its middle."""
        polynomials = (*self.heights.values(), *self.limits, self.under)
        cuts = sorted({x for p in polynomials for x in roots(p, 0.0, self.top)})
        found: list[Stretch] = []
        for low, high in pairwise([0.0, *(x for x in cuts if 0.0 < x < self.top), self.top]):
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
        for name in self.family.positive:
            if self.closed and not self.heights[name]:
                continue
            if not 0.0 < self.height(name, p) < _ENDLESS or vanishes(self._rounded[name], p, EPS):
                return False
        return all(quotient_at(rounded([limit])[0], (1.0,), p) >= 0.0 for limit in self.limits)

    def height(self, name: str, p: float) -> float:
        """A height, as a share of the stroke of the rise."""
        return quotient_at(self._rounded[name], self._rounded[""], p)

    def _goes_on(self, p: float) -> bool:
        """Whether a cut between two feasible parts is none: a height of constant velocity touches 0, or 0/0 stands."""
        return vanishes(self._rounded[""], p, SAME) or self.is_feasible(p)

    def is_open(self, p: float) -> bool:
        """Whether an end of a stretch can only be approached."""
        return p in (0.0, self.top) or any(self.height(n, p) <= OPEN for n in self.family.positive)

    # -- what is measured ---------------------------------------------------------------------------------

    def quotients(self, name: str) -> list[Quotient]:
        """A setting as a quotient; the acceleration as the greatest of several."""
        if name == "acceleration":
            return [self.bend(b) for b in self.family.bends]
        above, below = ratio(name, self.family)
        return [(self.over(above), self.over(below))]

    def bend(self, bend: Bend) -> Quotient:
        """The largest acceleration of a curve."""
        speed = self.over(bend.speed)
        below = times(self.heights[bend.height], self.under)
        return scaled(whole(bend.factor), times(speed, speed)), scaled(ONE, below)

    def where(self, wish: Wish) -> list[float]:
        """All p at which a setting may have its value, feasible or not; of an acceleration those of every curve."""
        found = []
        for above, below in self.quotients(wish.name):
            found += roots(weighed(ONE, above, whole(wish.value), below), 0.0, self.top)
        return found

    def extremes(self, quotients: Sequence[Quotient], stretch: Stretch) -> list[Extreme]:
        """What the greatest of the quotients may have as its least and its greatest value on a stretch."""
        turns = sorted(set(self._turns(quotients, stretch)))
        shut = self.closed and not all(self.heights[n] for n in self.family.positive)
        inside = between(stretch.low, stretch.high)
        open_ = {stretch.low: self.is_open(stretch.low), stretch.high: self.is_open(stretch.high)}
        places = [stretch.low, *turns, inside, stretch.high]
        if any(not below for _, below in quotients):  # the acceleration of a height that is 0 all along
            return [Extreme(inf, p, True) for p in places]
        pairs = [rounded(q) for q in quotients]
        return [
            Extreme(max(_value(above, below, p, inside) for above, below in pairs), p, open_.get(p, shut)) for p in places
        ]

    def _turns(self, quotients: Sequence[Quotient], stretch: Stretch) -> Iterable[float]:
        """Where a quotient has an extreme, or two are equal."""
        for above, below in quotients:
            slope = crossed(derivative(above), below, above, derivative(below))
            yield from roots(slope, stretch.low, stretch.high)
        for (a, b), (c, d) in combinations(quotients, 2):
            yield from roots(crossed(a, d, c, b), stretch.low, stretch.high)


def at_t(row: Row, t: float) -> Row:
    """A row of polynomials in t as a row of numbers, all times the same one."""
    powers = [whole(t**e) for e in range(max(map(len, row)))]
    return tuple(trimmed([sum(c * p for c, p in zip(r, powers, strict=False))]) if r else NOTHING for r in row)


def _value(above: Poly, below: Poly, p: float, inside: float) -> float:
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
