"""Regions of points that satisfy linear constraints.

Where one variable is free, the points lie on curves along which every setting is a quotient of polynomials. Where more
are free, at given t they are a polytope whose corners run along such curves; a setting that is linear, or a quotient of
linear forms, has its extremes on these curves.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import combinations, pairwise
from math import inf
from typing import NamedTuple

import numpy as np

from core.blend.equations import Family, PointFamily, SolutionSpace
from core.blend.evaluator import EPS, ROUNDING, Evaluator, Point
from core.blend.polynomials import UNIT, Floats, Polynomial, is_negligible, quotient_at, roots, to_floats, to_integer
from core.blend.request import SIZES, Constraint, SettingRange, height_of, merged, ratio, tied
from core.frozen import frozen

OPEN = 1e-9  # an end of a range is open where a height that must be positive is smaller
SAME = 1e-9  # relative variation below which a setting is determined by the others
NEAR = 1e-6  # least positive height of a face relative to the stroke
SAMPLES = 24  # values of t of a sample of points
MIXES = 24  # sample points at each of these
_SHARP = 1e-4  # largest relative change of an extreme when it is refined
_ENDLESS = 1e6  # heights above this multiple of the stroke are next to a pole
_EDGE = 1e-7  # distance from a point 0/0 at which a quotient is evaluated, relative to the interval

Quotient = tuple[Polynomial, Polynomial]
Interval = tuple[float, float]
"""A feasible part of a curve, from low to high in its variable."""


class SettingExtreme(NamedTuple):
    """A value that a setting has at p, or approaches there."""

    value: float
    p: float
    open: bool


@frozen
class RegionCurve:
    """Points along one variable p, 0 < p < top.

    Attributes
    ----------
    closed : whether heights that must be positive may be 0 all along
    """

    family: Family
    points: PointFamily
    closed: bool = False

    @classmethod
    def of(cls, family: Family, spaces: Iterable[SolutionSpace], closed: bool = False) -> list[RegionCurve]:
        """Curves of the solution spaces that have one free variable."""
        return [cls(family, space.along(), closed) for space in spaces if space.freedom == 1]

    def form(self, name: str) -> Polynomial:
        """A form as a polynomial of p, all forms times the same polynomial; the empty name is the form 1."""
        return self.points.form(name)[0]

    @cached_property
    def heights(self) -> dict[str, Polynomial]:
        """Name -> polynomial of the heights that must be positive, or not negative."""
        return {name: self.form(name) for name in (*self.family.positive, *self.family.constant)}

    @cached_property
    def denominator(self) -> Polynomial:
        """Common denominator of all forms."""
        return self.form("")

    @cached_property
    def _rounded(self) -> dict[str, Floats]:
        """Heights and, under an empty name, their denominator, in floating point."""
        rows = {**self.heights, "": self.denominator}
        return dict(zip(rows, to_floats(rows.values()), strict=True))

    @cached_property
    def _point_polynomials(self) -> list[Floats]:
        return to_floats([*(row[0] for row in self.points.x), self.points.below])

    def point_at(self, p: float) -> Point:
        """Point at one p."""
        *numerators, denominator = self._point_polynomials
        return (p if self.points.t is None else self.points.t), tuple(
            quotient_at(n, denominator, p) for n in numerators
        )

    def points_at(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points at many p.

        Parameters
        ----------
        p : ndarray (n,), dimensionless

        Returns
        -------
        t : ndarray (n,), dimensionless
        x : ndarray (numbers, n), dimensionless
        """
        with np.errstate(all="ignore"):
            rows = polynomials_at(self._point_polynomials, p)
            return self.points.t_at(p), rows[:-1] / rows[-1]

    # -- feasibility --------------------------------------------------------------------------------------

    @cached_property
    def intervals(self) -> list[Interval]:
        """Feasible intervals: between the roots of all heights, each tested at its middle."""
        top = self.points.top
        cuts = sorted(
            {p for polynomial in (*self.heights.values(), self.denominator) for p in roots(polynomial, 0.0, top)}
        )
        result: list[Interval] = []
        for low, high in pairwise([0.0, *(p for p in cuts if 0.0 < p < top), top]):
            if not self.is_feasible(between(low, high)):
                continue
            if result and result[-1][1] == low and self._continues(low):
                low = result.pop()[0]
            result.append((low, high))
        return result

    def is_feasible(self, p: float) -> bool:
        """Whether every height is positive, or not negative, as required."""
        if not all(-ROUNDING <= self.height(n, p) < _ENDLESS for n in self.family.constant):
            return False
        positive = [n for n in self.family.positive if self.heights[n] or not self.closed]
        return all(0.0 < self.height(n, p) < _ENDLESS and not is_negligible(self._rounded[n], p, EPS) for n in positive)

    def height(self, name: str, p: float) -> float:
        """Height relative to the stroke of the rise."""
        return quotient_at(self._rounded[name], self._rounded[""], p)

    def _continues(self, p: float) -> bool:
        """Whether the curve is feasible across a cut: a height of constant velocity touches 0, or a form is 0/0."""
        return is_negligible(self._rounded[""], p, SAME) or self.is_feasible(p)

    def is_open(self, p: float) -> bool:
        """Whether an end of an interval can only be approached."""
        return p in (0.0, self.points.top) or any(self.height(n, p) <= OPEN for n in self.family.positive)

    # -- settings -----------------------------------------------------------------------------------------

    def quotients(self, name: str) -> list[Quotient]:
        """A setting as a quotient; the acceleration as the largest of several, each factor S²/h."""
        rows = self.family.accelerations
        if name in SIZES:
            at = self.family.acceleration_of(height_of(name))
            rows = rows[at : at + 1]
        elif name != "acceleration":
            numerator, denominator = ratio(name, self.family)
            return [(self.form(numerator), self.form(denominator))]
        result = []
        for row in rows:
            speed = self.form(row.speed)
            result.append((to_integer(row.factor) * (speed * speed), UNIT * (self.form(row.height) * self.denominator)))
        return result

    def solutions_at(self, constraint: Constraint) -> list[float]:
        """All p at which a setting may have its value, feasible or not; of an acceleration for every curve."""
        value, quotients = to_integer(constraint.value), self.quotients(constraint.name)
        return [
            p
            for numerator, denominator in quotients
            for p in roots(UNIT * numerator - value * denominator, 0.0, self.points.top)
        ]

    def extremes(self, name: str, interval: Interval) -> list[SettingExtreme]:
        """Candidates for the least and the greatest value of a setting on an interval."""
        quotients, inside = self.quotients(name), between(*interval)
        is_all_open = self.closed and not all(self.heights[n] for n in self.family.positive)
        open_ = {p: self.is_open(p) for p in interval}
        positions = [interval[0], *sorted(set(_extreme_positions(quotients, interval))), inside, interval[1]]
        if any(not denominator for _, denominator in quotients):  # acceleration of a height that is 0 all along
            return [SettingExtreme(inf, p, True) for p in positions]
        pairs = [to_floats(q) for q in quotients]
        return [
            SettingExtreme(
                max(_value(numerator, denominator, p, inside) for numerator, denominator in pairs),
                p,
                open_.get(p, is_all_open),
            )
            for p in positions
        ]


def polynomials_at(rows: Sequence[Floats], p: np.ndarray) -> np.ndarray:
    """Values of polynomials at many p.

    Parameters
    ----------
    rows : sequence of Floats
    p : ndarray (n,), dimensionless

    Returns
    -------
    ndarray (polynomials, n), dimensionless
    """
    return np.array([np.polyval(row[::-1], p) if row else np.zeros_like(p) for row in rows])


def _extreme_positions(quotients: Sequence[Quotient], interval: Interval) -> Iterable[float]:
    """Positions where a quotient has an extreme, or two quotients are equal."""
    for numerator, denominator in quotients:
        slope = numerator.derivative() * denominator - numerator * denominator.derivative()
        yield from roots(slope, *interval)
    for (a, b), (c, d) in combinations(quotients, 2):
        yield from roots(a * d - c * b, *interval)


def _value(numerator: Floats, denominator: Floats, p: float, inside: float) -> float:
    if 0.0 < p < inf and is_negligible(denominator, p, 1e-13):
        if not is_negligible(numerator, p, SAME):
            return inf
        p += _EDGE * (inside - p)
    return quotient_at(numerator, denominator, p)


def between(low: float, high: float) -> float:
    """A number between two others."""
    if high == inf:
        return 2.0 * low if low > 0.0 else 1.0
    return 0.5 * (low + high)


# -- several free variables -------------------------------------------------------------------------------

Pieces = list[tuple[RegionCurve, Interval]]


@frozen
class RegionPart:
    """Connected part of a region: the curves of its corners over t from low to high, or lines at one t."""

    corners: Pieces
    low: float
    high: float

    def at(self, t: float) -> np.ndarray:
        """Corners at one t.

        Parameters
        ----------
        t : float

        Returns
        -------
        ndarray (corners, numbers), dimensionless
        """
        if self.low == self.high:
            return np.array([c.point_at(p)[1] for c, interval in self.corners for p in interval])
        return np.array([c.point_at(t)[1] for c, (low, high) in self.corners if low <= t <= high])


class Region:
    """Feasible points of a family that satisfy linear constraints."""

    def __init__(self, evaluator: Evaluator, constraints: Sequence[Constraint]) -> None:
        self._evaluator, self._constraints = evaluator, tuple(constraints)

    @cached_property
    def parts(self) -> list[RegionPart]:
        """Connected parts in which every height that must be positive can be."""
        pieces = [(curve, interval) for curve in self._edges() for interval in curve.intervals]
        free = [(c, s) for c, s in pieces if c.points.t is None]
        return [*self._along_t(free), *self._at_one_t([(c, s) for c, s in pieces if c.points.t is not None])]

    def _edges(self) -> Iterable[RegionCurve]:
        """Curves on which all but one of the free variables are fixed by heights of 0."""
        family = self._evaluator.family
        missing = family.freedom - 1 - len(self._constraints)
        for names in combinations((*family.positive, *family.constant), missing):
            zero = [Constraint(name, 0.0) for name in names]
            yield from RegionCurve.of(family, self._evaluator.spaces([*self._constraints, *zero]), closed=True)

    def _along_t(self, pieces: Pieces) -> Iterable[RegionPart]:
        t_intervals: list[Interval] = []
        for low, high in pairwise(sorted({end for _, interval in pieces for end in interval})):
            middle = between(low, high)
            corners = [c.point_at(middle)[1] for c, s in pieces if s[0] < middle < s[1]]
            if corners and self._is_feasible(middle, corners):
                t_intervals = (
                    [*t_intervals[:-1], (t_intervals[-1][0], high)]
                    if t_intervals and t_intervals[-1][1] == low
                    else [*t_intervals, (low, high)]
                )
        for low, high in t_intervals:
            inside = [(c, (max(s[0], low), min(s[1], high))) for c, s in pieces]
            yield RegionPart([(c, s) for c, s in inside if s[0] < s[1]], low, high)

    def _at_one_t(self, pieces: Pieces) -> Iterable[RegionPart]:
        while pieces:
            t = pieces[0][0].points.t or 0.0
            same_t = [(c, s) for c, s in pieces if abs((c.points.t or 0.0) - t) <= 1e-9 * t]
            pieces = [piece for piece in pieces if piece not in same_t]
            part = RegionPart(same_t, t, t)
            if self._is_feasible(t, part.at(t)):
                yield part

    def _is_feasible(self, t: float, corners: Sequence[Sequence[float]] | np.ndarray, least: float = 0.0) -> bool:
        """Whether the middle of corners is."""
        return self._evaluator.is_feasible((t, tuple(map(float, np.mean(corners, axis=0)))), least)

    # -- what a setting may be ----------------------------------------------------------------------------

    def ranges(self, name: str) -> list[SettingRange]:
        """Ranges of a linear setting, or of an acceleration where one variable is free."""
        return merged(self._range(name, part) for part in self.parts)

    def _range(self, name: str, part: RegionPart) -> SettingRange:
        result = [(c, e) for c, interval in part.corners for e in c.extremes(name, interval)]
        ends = min(result, key=lambda row: row[1].value), max(result, key=lambda row: row[1].value)
        low, high = (self._sharpened(name, *end) for end in ends)
        return SettingRange(low, high, *(self._is_open(name, part, result, end.value) for _, end in ends))

    def _is_open(
        self, name: str, part: RegionPart, result: Sequence[tuple[RegionCurve, SettingExtreme]], value: float
    ) -> bool:
        """Whether a setting has an extreme only where a height is 0 that must be positive.

        Checked at one corner, or on the face between all corners with that value at the same t.
        """
        extremes = [(c, e) for c, e in result if tied(1.0 + e.value, 1.0 + value)]
        if not all(e.open for _, e in extremes) or value == inf:
            return value == inf
        for t in {c.point_at(e.p)[0] for c, e in extremes if 0.0 < e.p < c.points.top}:
            corners = part.at(t)
            values = self._evaluator.values(Constraint(name, value), np.full(len(corners), t), corners.T)
            face = corners[np.abs(values - value) <= SAME * max(1.0, abs(value))]
            if len(face) and self._is_feasible(t, face, NEAR):
                return False
        return True

    def _sharpened(self, name: str, curve: RegionCurve, end: SettingExtreme) -> float:
        """An extreme refined by Newton's method on the constraints and on the heights that are 0 there."""
        if not 0.0 < end.p < curve.points.top or not 0.0 < end.value < inf:
            return end.value
        zero_heights = [Constraint(n, 0.0) for n in curve.heights if abs(curve.height(n, end.p)) <= OPEN]
        point, is_met = self._evaluator.solve([*self._constraints, *zero_heights], curve.point_at(end.p))
        value = self._evaluator.value_at(Constraint(name, end.value), point)
        return value if is_met and abs(value - end.value) <= _SHARP * end.value else end.value

    # -- points of it -------------------------------------------------------------------------------------

    def sample(self) -> np.ndarray:
        """Sample of points, ``MIXES`` adjacent ones at the same t; always the same sample.

        Returns
        -------
        ndarray (1 + numbers, n), dimensionless
        """
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
    """Values from low to high, denser towards both ends."""
    a, b = low / (1.0 + low), 1.0 if high == inf else high / (1.0 + high)
    share = 0.5 - 0.5 * np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)
    position = a + (b - a) * share
    return position / (1.0 - position) if high > low else np.full(SAMPLES, low)
