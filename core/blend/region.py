"""All points that meet linear constraints. Where one number is free they lie on curves, along which every setting is a
quotient of polynomials. Where more are free, with t given they are a polytope, whose corners run along such curves: a
setting that is linear, or a quotient of such, takes its extremes on these."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import combinations, pairwise
from math import inf
from typing import NamedTuple

import numpy as np

from core.blend.equations import Family, PointFamily, SolutionSpace
from core.blend.evaluator import EPS, ROUNDING, Evaluator, Place
from core.blend.polynomials import UNIT, Floats, Polynomial, quotient_at, roots, to_floats, is_negligible, to_integer
from core.blend.request import SIZES, Constraint, SettingRange, height_of, merged, ratio, tied
from core.frozen import frozen

OPEN = 1e-9  # a height that must be above 0 this small at the end of a range: an open end
SAME = 1e-9  # a setting that varies by less over all that the others leave is determined by them
NEAR = 1e-6  # a height of a face, as a share of the stroke, that is above 0
SAMPLES = 24  # values of t of a sample of points
MIXES = 24  # points for each of these
_SHARP = 1e-4  # an extreme that moves by more of its value has become another one
_ENDLESS = 1e6  # times the stroke: a height beside a pole
_EDGE = 1e-7  # how far beside a place where 0/0 stands a quotient is taken, as a share of the stretch

Quotient = tuple[Polynomial, Polynomial]
Stretch = tuple[float, float]
"""A feasible part of a curve, from low to high of its number."""


class SettingExtreme(NamedTuple):
    """A value that a setting takes at p, or only approaches."""

    value: float
    p: float
    open: bool


@frozen
class RegionCurve:
    """Points along one number p, 0 < p < top.

    closed  heights that are 0 all along are let pass, though they must be above 0
    """

    family: Family
    points: PointFamily
    closed: bool = False

    @classmethod
    def of(cls, family: Family, spaces: Iterable[SolutionSpace], closed: bool = False) -> list[RegionCurve]:
        """Those of the solution spaces that have one free number."""
        return [cls(family, space.along(), closed) for space in spaces if space.freedom == 1]

    def form(self, name: str) -> Polynomial:
        """A form, or 1 for an empty name, as a polynomial of p; all times the same one."""
        return self.points.form(name)[0]

    @cached_property
    def heights(self) -> dict[str, Polynomial]:
        return {name: self.form(name) for name in (*self.family.positive, *self.family.constant)}

    @cached_property
    def under(self) -> Polynomial:
        """What all forms are divided by."""
        return self.form("")

    @cached_property
    def _rounded(self) -> dict[str, Floats]:
        """The heights, and what they are divided by under an empty name."""
        rows = {**self.heights, "": self.under}
        return dict(zip(rows, to_floats(rows.values()), strict=True))

    @cached_property
    def _places(self) -> list[Floats]:
        return to_floats([*(row[0] for row in self.points.x), self.points.below])

    def place(self, p: float) -> Place:
        """t and the x there."""
        *numerators, below = self._places
        return (p if self.points.t is None else self.points.t), tuple(quotient_at(n, below, p) for n in numerators)

    def places(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same at many p (n,): t (n,) and x (numbers, n)."""
        with np.errstate(all="ignore"):
            rows = polynomials_at(self._places, p)
            return self.points.t_at(p), rows[:-1] / rows[-1]

    # -- where it is feasible -----------------------------------------------------------------------------

    @cached_property
    def stretches(self) -> list[Stretch]:
        """Where every height is what it must be: cut at the roots of all of them, each part tried in its middle."""
        top = self.points.top
        cuts = sorted({p for polynomial in (*self.heights.values(), self.under) for p in roots(polynomial, 0.0, top)})
        result: list[Stretch] = []
        for low, high in pairwise([0.0, *(p for p in cuts if 0.0 < p < top), top]):
            if not self.is_feasible(between(low, high)):
                continue
            if result and result[-1][1] == low and self._continues(low):
                low = result.pop()[0]
            result.append((low, high))
        return result

    def is_feasible(self, p: float) -> bool:
        """Whether every height is what it must be."""
        if not all(-ROUNDING <= self.height(n, p) < _ENDLESS for n in self.family.constant):
            return False
        positive = [n for n in self.family.positive if self.heights[n] or not self.closed]
        return all(0.0 < self.height(n, p) < _ENDLESS and not is_negligible(self._rounded[n], p, EPS) for n in positive)

    def height(self, name: str, p: float) -> float:
        """A height, as a share of the stroke of the rise."""
        return quotient_at(self._rounded[name], self._rounded[""], p)

    def _continues(self, p: float) -> bool:
        """Whether a cut between two feasible parts is none: a height of constant velocity touches 0, or 0/0 stands."""
        return is_negligible(self._rounded[""], p, SAME) or self.is_feasible(p)

    def is_open(self, p: float) -> bool:
        """Whether an end of a stretch can only be approached."""
        return p in (0.0, self.points.top) or any(self.height(n, p) <= OPEN for n in self.family.positive)

    # -- settings -----------------------------------------------------------------------------------------

    def quotients(self, name: str) -> list[Quotient]:
        """A setting as a quotient; the acceleration as the greatest of several, each factor S²/h."""
        rows = self.family.accelerations
        if name in SIZES:
            at = self.family.acceleration_of(height_of(name))
            rows = rows[at : at + 1]
        elif name != "acceleration":
            above, below = ratio(name, self.family)
            return [(self.form(above), self.form(below))]
        result = []
        for row in rows:
            speed = self.form(row.speed)
            result.append((to_integer(row.factor) * (speed * speed), UNIT * (self.form(row.height) * self.under)))
        return result

    def where(self, constraint: Constraint) -> list[float]:
        """All p at which a setting may have its value, feasible or not; of an acceleration those of every curve."""
        value, quotients = to_integer(constraint.value), self.quotients(constraint.name)
        return [p for above, below in quotients for p in roots(UNIT * above - value * below, 0.0, self.points.top)]

    def extremes(self, name: str, stretch: Stretch) -> list[SettingExtreme]:
        """What a setting may have as its least and its greatest value on a stretch."""
        quotients, inside = self.quotients(name), between(*stretch)
        shut = self.closed and not all(self.heights[n] for n in self.family.positive)
        open_ = {p: self.is_open(p) for p in stretch}
        places = [stretch[0], *sorted(set(_turns(quotients, stretch))), inside, stretch[1]]
        if any(not below for _, below in quotients):  # the acceleration of a height that is 0 all along
            return [SettingExtreme(inf, p, True) for p in places]
        pairs = [to_floats(q) for q in quotients]
        return [
            SettingExtreme(max(_value(above, below, p, inside) for above, below in pairs), p, open_.get(p, shut))
            for p in places
        ]


def polynomials_at(rows: Sequence[Floats], p: np.ndarray) -> np.ndarray:
    """Polynomials at many p (n,): (polynomials, n)."""
    return np.array([np.polyval(row[::-1], p) if row else np.zeros_like(p) for row in rows])


def _turns(quotients: Sequence[Quotient], stretch: Stretch) -> Iterable[float]:
    """Where a quotient has an extreme, or two are equal."""
    for above, below in quotients:
        slope = above.derivative() * below - above * below.derivative()
        yield from roots(slope, *stretch)
    for (a, b), (c, d) in combinations(quotients, 2):
        yield from roots(a * d - c * b, *stretch)


def _value(above: Floats, below: Floats, p: float, inside: float) -> float:
    if 0.0 < p < inf and is_negligible(below, p, 1e-13):
        if not is_negligible(above, p, SAME):
            return inf
        p += _EDGE * (inside - p)
    return quotient_at(above, below, p)


def between(low: float, high: float) -> float:
    """A number inside."""
    if high == inf:
        return 2.0 * low if low > 0.0 else 1.0
    return 0.5 * (low + high)


# -- where more numbers are free --------------------------------------------------------------------------

Pieces = list[tuple[RegionCurve, Stretch]]


@frozen
class RegionPart:
    """A connected part of a region: its corners' curves over t from low to high, or lines at one t."""

    corners: Pieces
    low: float
    high: float

    def at(self, t: float) -> np.ndarray:
        """The corners at one t (corners, numbers)."""
        if self.low == self.high:
            return np.array([c.place(p)[1] for c, stretch in self.corners for p in stretch])
        return np.array([c.place(t)[1] for c, (low, high) in self.corners if low <= t <= high])


class Region:
    """The feasible points of a family that meet linear constraints."""

    def __init__(self, evaluator: Evaluator, constraints: Sequence[Constraint]) -> None:
        self._evaluator, self._constraints = evaluator, tuple(constraints)

    @cached_property
    def parts(self) -> list[RegionPart]:
        """Where there is room for every height that must be above 0."""
        pieces = [(curve, stretch) for curve in self._edges() for stretch in curve.stretches]
        free = [(c, s) for c, s in pieces if c.points.t is None]
        return [*self._along_t(free), *self._at_one_t([(c, s) for c, s in pieces if c.points.t is not None])]

    def _edges(self) -> Iterable[RegionCurve]:
        """Curves on which as many heights are 0 as numbers are free, but one."""
        family = self._evaluator.family
        missing = family.freedom - 1 - len(self._constraints)
        for names in combinations((*family.positive, *family.constant), missing):
            zero = [Constraint(name, 0.0) for name in names]
            yield from RegionCurve.of(family, self._evaluator.spaces([*self._constraints, *zero]), closed=True)

    def _along_t(self, pieces: Pieces) -> Iterable[RegionPart]:
        runs: list[Stretch] = []
        for low, high in pairwise(sorted({end for _, stretch in pieces for end in stretch})):
            middle = between(low, high)
            corners = [c.place(middle)[1] for c, s in pieces if s[0] < middle < s[1]]
            if corners and self._is_feasible(middle, corners):
                runs = [*runs[:-1], (runs[-1][0], high)] if runs and runs[-1][1] == low else [*runs, (low, high)]
        for low, high in runs:
            inside = [(c, (max(s[0], low), min(s[1], high))) for c, s in pieces]
            yield RegionPart([(c, s) for c, s in inside if s[0] < s[1]], low, high)

    def _at_one_t(self, pieces: Pieces) -> Iterable[RegionPart]:
        while pieces:
            t = pieces[0][0].points.t or 0.0
            here = [(c, s) for c, s in pieces if abs((c.points.t or 0.0) - t) <= 1e-9 * t]
            pieces = [piece for piece in pieces if piece not in here]
            part = RegionPart(here, t, t)
            if self._is_feasible(t, part.at(t)):
                yield part

    def _is_feasible(self, t: float, corners: Sequence[Sequence[float]] | np.ndarray, least: float = 0.0) -> bool:
        """Whether the middle of corners is."""
        return self._evaluator.is_feasible((t, tuple(map(float, np.mean(corners, axis=0)))), least)

    # -- what a setting may be ----------------------------------------------------------------------------

    def ranges(self, name: str) -> list[SettingRange]:
        """Of a linear setting, or, where one number is free, of an acceleration."""
        return merged(self._range(name, part) for part in self.parts)

    def _range(self, name: str, part: RegionPart) -> SettingRange:
        result = [(c, e) for c, stretch in part.corners for e in c.extremes(name, stretch)]
        ends = min(result, key=lambda row: row[1].value), max(result, key=lambda row: row[1].value)
        low, high = (self._sharpened(name, *end) for end in ends)
        return SettingRange(low, high, *(self._is_open(name, part, result, end.value) for _, end in ends))

    def _is_open(
        self, name: str, part: RegionPart, result: Sequence[tuple[RegionCurve, SettingExtreme]], value: float
    ) -> bool:
        """Whether a setting has an extreme value only where a height is 0 that must be above: on one corner, or on the face
        between all corners of the same t that have it."""
        there = [(c, e) for c, e in result if tied(1.0 + e.value, 1.0 + value)]
        if not all(e.open for _, e in there) or value == inf:
            return value == inf
        for t in {c.place(e.p)[0] for c, e in there if 0.0 < e.p < c.points.top}:
            corners = part.at(t)
            values = self._evaluator.values(Constraint(name, value), np.full(len(corners), t), corners.T)
            face = corners[np.abs(values - value) <= SAME * max(1.0, abs(value))]
            if len(face) and self._is_feasible(t, face, NEAR):
                return False
        return True

    def _sharpened(self, name: str, curve: RegionCurve, end: SettingExtreme) -> float:
        """An extreme as exact as the constraints themselves, not only as the curve's number: Newton's method on these, and
        on the heights that are 0 there."""
        if not 0.0 < end.p < curve.points.top or not 0.0 < end.value < inf:
            return end.value
        zero = [Constraint(n, 0.0) for n in curve.heights if abs(curve.height(n, end.p)) <= OPEN]
        place, met = self._evaluator.solved([*self._constraints, *zero], curve.place(end.p))
        value = self._evaluator.value_at(Constraint(name, end.value), place)
        return value if met and abs(value - end.value) <= _SHARP * end.value else end.value

    # -- points of it -------------------------------------------------------------------------------------

    def sample(self) -> np.ndarray:
        """Points (1 + numbers, n), always the same, ``MIXES`` at the same t beside each other."""
        chance = np.random.default_rng(1995)
        result = [np.empty((1 + len(self._evaluator.equations.numbers), 0))]
        for part in self.parts:
            for value in _spread(part.low, part.high):
                corners = part.at(float(value))
                if len(corners):
                    x = chance.dirichlet(np.ones(len(corners)), MIXES) @ corners
                    result.append(np.vstack([np.full(MIXES, value), x.T]))
        return np.concatenate(result, axis=1)


def _spread(low: float, high: float) -> np.ndarray:
    """Values from low to high, closer to each other at both ends."""
    a, b = low / (1.0 + low), 1.0 if high == inf else high / (1.0 + high)
    share = 0.5 - 0.5 * np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)
    place = a + (b - a) * share
    return place / (1.0 - place) if high > low else np.full(SAMPLES, low)
