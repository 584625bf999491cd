"""Feasible points along one variable, where linear constraints leave one free, or two with a prescribed acceleration.

Roots and extremes of a smooth function along such a track are those of its Chebyshev series, subdivided where it is
not resolved (Trefethen 2013, Approximation Theory and Approximation Practice, ch. 18).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, pairwise
from math import inf, pi

import numpy as np
from numpy.polynomial import Chebyshev

from core.blend.equations import PeakAcceleration, PointFamily, Row, SolutionSpace
from core.blend.evaluator import Evaluator, Point
from core.blend.polynomials import Floats, Polynomial, roots, to_floats, to_integer
from core.blend.region import OPEN, Interval, RegionCurve, polynomials_at
from core.blend.request import SIZES, Constraint, SettingRange, height_of
from core.frozen import frozen

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Values (n,) at t (n,) and x (numbers, n)."""

TERMS = 24
DEPTH = 26  # number of bisections of an interval
RESOLVED = 1e-13  # last coefficients of a resolved series relative to the function
REAL = 1e-3  # largest imaginary part of a root relative to the interval; the equations decide later
_SAME = 1e-9  # relative excess of another curve over a prescribed acceleration
_REACHED = 1e-6  # relative error of the acceleration in the middle of an arc
_AT_END = 1e-6  # distance from the end of a track relative to its width, at which a point is the end
_INSIDE = 1e-12  # distance from the ends at which a track is evaluated, relative to its width

_ANGLES = np.pi * (np.arange(TERMS) + 0.5) / TERMS
_NODES = np.cos(_ANGLES)
_TRANSFORM = (2.0 / TERMS) * np.cos(np.outer(np.arange(TERMS), _ANGLES))
_TRANSFORM[0] /= 2.0


@frozen
class Track:
    """Feasible points along a variable z, low to high.

    Attributes
    ----------
    points_at : from z (n,) to t (n,) and x (numbers, n), all dimensionless
    """

    points_at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    @classmethod
    def along(cls, curve: RegionCurve, interval: Interval) -> Track:
        """Track along a feasible part of a curve; an unbounded variable p is mapped to z = p/(1 + p)."""
        open_ = (curve.is_open(p) for p in interval)
        if curve.points.top < inf:
            return cls(curve.points_at, *interval, *open_)
        low, high = map(_bounded, interval)
        return cls(lambda z: curve.points_at(z / (1.0 - z)), low, high, *open_)

    def solutions_at(self, function: Function, value: float) -> Iterator[Point]:
        """Points where a function may have a value."""
        for series in _resolved(lambda z: function(*self.points_at(z)), self.low, self.high):
            t, x = self.points_at(_roots(series - value))
            yield from ((float(a), tuple(float(v) for v in b)) for a, b in zip(t, x.T, strict=True))

    def ranges(self, function: Function) -> Iterator[SettingRange]:
        """Range of a function along the track, from its ends and extremes; empty where it has no value."""
        series = _resolved(lambda z: function(*self.points_at(z)), self.low, self.high)
        width = self.high - self.low
        ends = np.array([self.low + _INSIDE * width, self.high - _INSIDE * width])
        positions = np.concatenate([ends, *(_roots(s.deriv()) for s in series), *(s.domain for s in series[1:-1])])
        values = function(*self.points_at(positions))
        at_ends = [
            np.abs(positions - end) <= _AT_END * width for end in (self.low, self.high)
        ]  # an arc may also have its extreme there
        open_ = (at_ends[0] & self.low_open) | (at_ends[1] & self.high_open)
        is_finite = np.isfinite(values)
        if is_finite.any():
            values, open_ = values[is_finite], open_[is_finite]
            low, high = float(values.min()), float(values.max())
            tolerance = 1e-9 * max(abs(low), abs(high))
            yield SettingRange(
                low, high, bool(open_[values <= low + tolerance].all()), bool(open_[values >= high - tolerance].all())
            )


def _bounded(p: float) -> float:
    """The value p/(1 + p)."""
    return 1.0 if p == inf else p / (1.0 + p)


# -- Chebyshev series -------------------------------------------------------------------------------------


def _roots(series: Chebyshev) -> np.ndarray:
    """Positions where a series may be 0."""
    low, high = series.domain
    trimmed = series.trim(1e-15 * np.abs(series.coef).max())
    first, *rest = np.abs(trimmed.coef)
    if first > 1.001 * sum(rest) or max(first, *rest) <= RESOLVED or not rest:
        return np.empty(0)  # no sign change, or constant
    z, half = trimmed.roots(), 0.5 * (high - low)
    is_real = (np.abs(z.imag) <= REAL * half) & (np.abs(z.real - low - half) <= (1.0 + REAL) * half)
    return np.clip(z.real[is_real], low, high)


def _resolved(function: Callable[[np.ndarray], np.ndarray], low: float, high: float) -> list[Chebyshev]:
    """A function of values about 1 as adjacent series; none where it is NaN."""
    waiting, result = [(low, high, DEPTH)], []
    while waiting:
        positions = np.concatenate([0.5 * (a + b) + 0.5 * (b - a) * _NODES for a, b, _ in waiting])
        rows = function(positions).reshape(len(waiting), TERMS) @ _TRANSFORM.T
        halved = []
        for (a, b, depth), c in zip(waiting, rows, strict=True):
            if np.isfinite(c).all() and (depth == 0 or np.abs(c[-3:]).max() <= RESOLVED * max(1.0, np.abs(c).max())):
                result.append(Chebyshev(c, (a, b)))
            elif depth:
                middle = 0.5 * (a + b)
                halved += [(a, middle, depth - 1), (middle, b, depth - 1)]
        waiting = halved
    return sorted(result, key=lambda series: series.domain[0])


# -- prescribed acceleration ------------------------------------------------------------------------------

Quadratic = tuple[Polynomial, Polynomial, Polynomial]


@frozen
class Arc:
    """One root y of a quadratic between two values of p; z runs from 0 to 1 and is smooth where the two roots meet."""

    points: PointFamily
    x: list[Floats]
    quadratic: list[Floats]
    root: int
    low: float
    high: float

    def points_at(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points of the arc.

        Parameters
        ----------
        z : ndarray (n,), dimensionless

        Returns
        -------
        t : ndarray (n,), dimensionless
        x : ndarray (numbers, n), dimensionless
        """
        a, b = _bounded(self.low), _bounded(self.high)
        share = a + (b - a) * np.sin(0.5 * pi * z) ** 2
        with np.errstate(all="ignore"):
            p = share / (1.0 - share)
            *rows, denominator = polynomials_at(self.x, p)
            y = self._y(*polynomials_at(self.quadratic, p))
            x = (np.array(rows[::2]) + np.array(rows[1::2]) * y) / denominator
        return self.points.t_at(p), x

    def _y(self, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Root of a y² + b y + c = 0; that of the linear equation where a is 0 all along."""
        if not self.quadratic[0]:
            return -c / b
        square = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
        q = -0.5 * (b + np.where(b >= 0.0, square, -square))
        return np.where((b >= 0.0) == (self.root < 0), q / a, c / q)


def acceleration_tracks(
    evaluator: Evaluator, constraints: Sequence[Constraint], acceleration: Constraint
) -> list[Track]:
    """Feasible points that satisfy linear constraints and a prescribed acceleration, with one variable free.

    The acceleration is the largest one of all curves, or that of one curve.
    """
    result, rows = [], evaluator.family.accelerations
    is_single = acceleration.name in SIZES
    if is_single:
        index = evaluator.family.acceleration_of(height_of(acceleration.name))
        rows = rows[index : index + 1]
    for space in evaluator.spaces(constraints):
        if space.freedom == 2:
            for row in rows:
                for arc in _arcs(evaluator, space, row, acceleration.value, is_single):
                    open_ = (bool(evaluator.family.flats) and _has_no_room(evaluator, arc, z) for z in (0.0, 1.0))
                    result.append(Track(arc.points_at, 0.0, 1.0, *open_))
    return result


def _has_no_room(evaluator: Evaluator, arc: Arc, z: float) -> bool:
    """Whether a height that must be positive, or a ramp of a curve with constant acceleration, is 0."""
    t, x = arc.points_at(np.array([z]))
    return min(evaluator.at(evaluator.family.positive, (float(t[0]), tuple(map(float, x[:, 0]))))) <= OPEN


def _arcs(
    evaluator: Evaluator, space: SolutionSpace, row: PeakAcceleration, value: float, is_single: bool
) -> Iterator[Arc]:
    for first in range(len(space.free)):  # the acceleration may not depend on every variable
        points = space.along(first)
        a, b, c = _quadratic(points, row, value)
        if a or b:
            break
    cuts = {*roots(b * b - 4 * (a * c)), *roots(a), *([] if a else roots(b)), *_kinks(evaluator, points, (a, b, c))}
    x, quadratic = to_floats([*(p for r in points.x for p in r), points.below]), to_floats([a, b, c])
    for low, high in pairwise([0.0, *sorted(p for p in cuts if 0.0 < p < points.top), points.top]):
        for root in (1, -1) if a else (1,):
            arc = Arc(points, x, quadratic, root, low, high)
            if _is_met(evaluator, arc, row, value, is_single):
                yield arc


def _quadratic(points: PointFamily, row: PeakAcceleration, value: float) -> Quadratic:
    """Coefficients of y², y and 1 in factor S² - value h = 0."""
    (s0, s1), (h0, h1), (under, _) = (points.form(name) for name in (row.speed, row.height, ""))
    factor, target = to_integer(row.factor), to_integer(value)
    return (
        factor * (s1 * s1),
        2 * factor * (s0 * s1) - target * (h1 * under),
        factor * (s0 * s0) - target * (h0 * under),
    )


def _kinks(evaluator: Evaluator, points: PointFamily, quadratic: Quadratic) -> Iterator[float]:
    """Values of p where two curves have equal acceleration, or a constant velocity or acceleration vanishes.

    There k0 + k1 y = 0.
    """
    a, b, c = quadratic
    rows = [_equal(points, first, second) for first, second in combinations(evaluator.family.accelerations, 2)]
    family = evaluator.family
    ends = (*family.constant, *(family.positive if family.flats else ()))
    for k0, k1 in (*rows, *(points.form(name) for name in ends)):
        yield from roots(a * k0 * k0 - b * k0 * k1 + c * k1 * k1 if k1 else k0)


def _equal(points: PointFamily, first: PeakAcceleration, second: PeakAcceleration) -> Row:
    """Coefficients k0, k1 of equal accelerations of two curves, factor S²/h with R = t W: linear in the heights."""
    a, b = points.form(first.height), points.form(second.height)
    shift, square = (2, 1.0) if points.t is None else (0, points.t**2)
    if first.speed == second.speed:
        shift, square = 0, 1.0
    a = tuple([to_integer(second.factor * square) * p.times_power(shift) for p in a])
    return tuple([p - to_integer(first.factor) * q for p, q in zip(a, b, strict=True)])


def _is_met(evaluator: Evaluator, arc: Arc, row: PeakAcceleration, value: float, is_single: bool) -> bool:
    """Whether the middle of an arc is feasible and no other curve, unless ``is_single``, has a larger acceleration."""
    t, x = arc.points_at(np.array([0.5]))
    if not (np.isfinite(x).all() and evaluator.is_feasible((float(t[0]), tuple(map(float, x[:, 0]))))):
        return False
    forms = evaluator.forms(t, x)
    accelerations = [float(evaluator.acceleration(i, forms)[0, 0]) for i in range(len(evaluator.family.accelerations))]
    acceleration = accelerations[evaluator.family.accelerations.index(row)]
    return abs(acceleration / value - 1.0) <= _REACHED and (is_single or max(accelerations) <= value * (1.0 + _SAME))
