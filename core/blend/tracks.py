"""Feasible points along one number: along a curve, or where an acceleration is prescribed beside linear constraints; and
all roots and extremes of a smooth function there, from its Chebyshev series, cut where it is not resolved (Trefethen,
Approximation Theory and Approximation Practice, ch. 18)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, pairwise
from math import inf, pi

import numpy as np
from numpy.polynomial import Chebyshev

from core.blend.equations import PointFamily, PeakAcceleration, Row, SolutionSpace
from core.blend.evaluator import Evaluator, Place
from core.blend.polynomials import Floats, Polynomial, roots, to_floats, to_integer
from core.blend.region import OPEN, RegionCurve, Stretch, polynomials_at
from core.blend.request import SIZES, Constraint, SettingRange, height_of
from core.frozen import frozen

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Values (n,) at t (n,) and x (numbers, n)."""

TERMS = 24
DEPTH = 26  # how often a stretch may be halved
RESOLVED = 1e-13  # the last terms, as a share of the function's size
REAL = 1e-3  # how far beside the real numbers a root may lie: the caller, who knows the equations, decides
_SAME = 1e-9  # by how much more another curve may have a prescribed acceleration
_REACHED = 1e-6  # how well the middle of an arc must have it
_AT_END = 1e-6  # what lies so near to an end of a track is at its end, as a share of its width
_INSIDE = 1e-12  # how far from its ends a track is evaluated, as a share of its width

_ANGLES = np.pi * (np.arange(TERMS) + 0.5) / TERMS
_PLACES = np.cos(_ANGLES)
_TRANSFORM = (2.0 / TERMS) * np.cos(np.outer(np.arange(TERMS), _ANGLES))
_TRANSFORM[0] /= 2.0


@frozen
class Track:
    """Feasible points along a number z from low to high: places gives t (n,) and x (numbers, n) at z (n,)."""

    places: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    @classmethod
    def along(cls, curve: RegionCurve, stretch: Stretch) -> Track:
        """A feasible part of a curve; a number without end is counted as z = p/(1 + p)."""
        open_ = (curve.is_open(p) for p in stretch)
        if curve.points.top < inf:
            return cls(curve.places, *stretch, *open_)
        low, high = map(_bounded, stretch)
        return cls(lambda z: curve.places(z / (1.0 - z)), low, high, *open_)

    def where(self, function: Function, value: float) -> Iterator[Place]:
        """Places where a function may have a value."""
        for series in _resolved(lambda z: function(*self.places(z)), self.low, self.high):
            t, x = self.places(_roots(series - value))
            yield from ((float(a), tuple(float(v) for v in b)) for a, b in zip(t, x.T, strict=True))

    def ranges(self, function: Function) -> Iterator[SettingRange]:
        """What a function is along the track: at its ends and at every turn; nothing where it has no value."""
        series = _resolved(lambda z: function(*self.places(z)), self.low, self.high)
        width = self.high - self.low
        ends = np.array([self.low + _INSIDE * width, self.high - _INSIDE * width])
        places = np.concatenate([ends, *(_roots(s.deriv()) for s in series), *(s.domain for s in series[1:-1])])
        values = function(*self.places(places))
        at_ends = [
            np.abs(places - end) <= _AT_END * width for end in (self.low, self.high)
        ]  # where an arc turns as well
        open_ = (at_ends[0] & self.low_open) | (at_ends[1] & self.high_open)
        good = np.isfinite(values)
        if good.any():
            values, open_ = values[good], open_[good]
            low, high = float(values.min()), float(values.max())
            near = 1e-9 * max(abs(low), abs(high))
            yield SettingRange(
                low, high, bool(open_[values <= low + near].all()), bool(open_[values >= high - near].all())
            )


def _bounded(p: float) -> float:
    """p/(1 + p)."""
    return 1.0 if p == inf else p / (1.0 + p)


# -- Chebyshev series -------------------------------------------------------------------------------------


def _roots(series: Chebyshev) -> np.ndarray:
    """Places where a series may be 0."""
    low, high = series.domain
    kept = series.trim(1e-15 * np.abs(series.coef).max())
    first, *others = np.abs(kept.coef)
    if first > 1.001 * sum(others) or max(first, *others) <= RESOLVED or not others:
        return np.empty(0)  # above or below 0, or the same everywhere
    z, half = kept.roots(), 0.5 * (high - low)
    near = (np.abs(z.imag) <= REAL * half) & (np.abs(z.real - low - half) <= (1.0 + REAL) * half)
    return np.clip(z.real[near], low, high)


def _resolved(function: Callable[[np.ndarray], np.ndarray], low: float, high: float) -> list[Chebyshev]:
    """A function of values about 1 as series side by side; nothing where it is nan."""
    waiting, result = [(low, high, DEPTH)], []
    while waiting:
        places = np.concatenate([0.5 * (a + b) + 0.5 * (b - a) * _PLACES for a, b, _ in waiting])
        rows = function(places).reshape(len(waiting), TERMS) @ _TRANSFORM.T
        halved = []
        for (a, b, depth), c in zip(waiting, rows, strict=True):
            if np.isfinite(c).all() and (depth == 0 or np.abs(c[-3:]).max() <= RESOLVED * max(1.0, np.abs(c).max())):
                result.append(Chebyshev(c, (a, b)))
            elif depth:
                middle = 0.5 * (a + b)
                halved += [(a, middle, depth - 1), (middle, b, depth - 1)]
        waiting = halved
    return sorted(result, key=lambda series: series.domain[0])


# -- where an acceleration is prescribed ------------------------------------------------------------------

Quadratic = tuple[Polynomial, Polynomial, Polynomial]


@frozen
class Arc:
    """One root y of a quadratic between two values of p; z runs from 0 to 1, smooth even where the two roots meet."""

    points: PointFamily
    x: list[Floats]
    quadratic: list[Floats]
    root: int
    low: float
    high: float

    def places(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """t (n,) and x (numbers, n)."""
        a, b = _bounded(self.low), _bounded(self.high)
        share = a + (b - a) * np.sin(0.5 * pi * z) ** 2
        with np.errstate(all="ignore"):
            p = share / (1.0 - share)
            *rows, below = polynomials_at(self.x, p)
            y = self._y(*polynomials_at(self.quadratic, p))
            x = (np.array(rows[::2]) + np.array(rows[1::2]) * y) / below
        return self.points.t_at(p), x

    def _y(self, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """A root of a y² + b y + c = 0; the one there is where a is 0 all along."""
        if not self.quadratic[0]:
            return -c / b
        square = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
        q = -0.5 * (b + np.where(b >= 0.0, square, -square))
        return np.where((b >= 0.0) == (self.root < 0), q / a, c / q)


def acceleration_tracks(
    evaluator: Evaluator, constraints: Sequence[Constraint], acceleration: Constraint
) -> list[Track]:
    """All feasible points that meet linear constraints, which leave two numbers free, and have that largest acceleration, of all
    curves or of one."""
    result, rows = [], evaluator.family.accelerations
    alone = acceleration.name in SIZES
    if alone:
        at = evaluator.family.acceleration_of(height_of(acceleration.name))
        rows = rows[at : at + 1]
    for space in evaluator.spaces(constraints):
        if space.freedom == 2:
            for row in rows:
                for arc in _arcs(evaluator, space, row, acceleration.value, alone):
                    open_ = (bool(evaluator.family.flats) and _has_no_room(evaluator, arc, z) for z in (0.0, 1.0))
                    result.append(Track(arc.places, 0.0, 1.0, *open_))
    return result


def _has_no_room(evaluator: Evaluator, arc: Arc, z: float) -> bool:
    """Whether a height that must be above 0, or what a constant acceleration leaves of its curve, is 0 there."""
    t, x = arc.places(np.array([z]))
    return min(evaluator.at(evaluator.family.positive, (float(t[0]), tuple(map(float, x[:, 0]))))) <= OPEN


def _arcs(
    evaluator: Evaluator, space: SolutionSpace, row: PeakAcceleration, value: float, alone: bool
) -> Iterator[Arc]:
    for first in range(len(space.free)):  # y may be a number on which the acceleration does not depend
        points = space.along(first)
        a, b, c = _quadratic(points, row, value)
        if a or b:
            break
    cuts = {*roots(b * b - 4 * (a * c)), *roots(a), *([] if a else roots(b)), *_kinks(evaluator, points, (a, b, c))}
    x, quadratic = to_floats([*(p for r in points.x for p in r), points.below]), to_floats([a, b, c])
    for low, high in pairwise([0.0, *sorted(p for p in cuts if 0.0 < p < points.top), points.top]):
        for root in (1, -1) if a else (1,):
            arc = Arc(points, x, quadratic, root, low, high)
            if _is_met(evaluator, arc, row, value, alone):
                yield arc


def _quadratic(points: PointFamily, row: PeakAcceleration, value: float) -> Quadratic:
    """factor S² - value h = 0 by y², y and 1."""
    (s0, s1), (h0, h1), (under, _) = (points.form(name) for name in (row.speed, row.height, ""))
    factor, share = to_integer(row.factor), to_integer(value)
    return (
        factor * (s1 * s1),
        2 * factor * (s0 * s1) - share * (h1 * under),
        factor * (s0 * s0) - share * (h0 * under),
    )


def _kinks(evaluator: Evaluator, points: PointFamily, quadratic: Quadratic) -> Iterator[float]:
    """Values of p where two curves have the same acceleration, or where there is no room left for a constant velocity or
    acceleration: k0 + k1 y = 0 there."""
    a, b, c = quadratic
    rows = [_equal(points, one, two) for one, two in combinations(evaluator.family.accelerations, 2)]
    family = evaluator.family
    ends = (*family.constant, *(family.positive if family.flats else ()))
    for k0, k1 in (*rows, *(points.form(name) for name in ends)):
        yield from roots(a * k0 * k0 - b * k0 * k1 + c * k1 * k1 if k1 else k0)


def _equal(points: PointFamily, one: PeakAcceleration, two: PeakAcceleration) -> Row:
    """Where two curves have the same acceleration, factor S²/h with R = t W: linear in the heights."""
    a, b = points.form(one.height), points.form(two.height)
    shift, square = (2, 1.0) if points.t is None else (0, points.t**2)
    if one.speed == two.speed:
        shift, square = 0, 1.0
    a = tuple([to_integer(two.factor * square) * p.times_power(shift) for p in a])
    return tuple([p - to_integer(one.factor) * q for p, q in zip(a, b, strict=True)])


def _is_met(evaluator: Evaluator, arc: Arc, row: PeakAcceleration, value: float, alone: bool) -> bool:
    """Whether the middle of an arc is feasible and no other curve, unless this one is meant alone, has a larger acceleration."""
    t, x = arc.places(np.array([0.5]))
    if not (np.isfinite(x).all() and evaluator.is_feasible((float(t[0]), tuple(map(float, x[:, 0]))))):
        return False
    forms = evaluator.forms(t, x)
    accelerations = [float(evaluator.acceleration(i, forms)[0, 0]) for i in range(len(evaluator.family.accelerations))]
    here = accelerations[evaluator.family.accelerations.index(row)]
    return abs(here / value - 1.0) <= _REACHED and (alone or max(accelerations) <= value * (1.0 + _SAME))
