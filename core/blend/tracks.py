"""Feasible points along one number, and what a smooth function has there: all its roots and extremes, from its Chebyshev
series, cut where it is not resolved (Trefethen, Approximation Theory and Approximation Practice, ch. 18)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.polynomial import chebyshev

from core.blend.curve import Curve, Stretch
from core.blend.evaluator import Place
from core.blend.settings import Range

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Values (n,) at t (n,) and x (numbers, n)."""

TERMS = 24
DEPTH = 26  # how often a stretch may be halved
RESOLVED = 1e-13  # the last terms, as a share of the function's size
REAL = 1e-3  # how far beside the real numbers a root may lie: the caller, who knows the equations, decides
_INSIDE = 1e-12  # how far from its ends a track is evaluated, as a share of its width

_ANGLES = np.pi * (np.arange(TERMS) + 0.5) / TERMS
_PLACES = np.cos(_ANGLES)
_TRANSFORM = (2.0 / TERMS) * np.cos(np.outer(np.arange(TERMS), _ANGLES))
_TRANSFORM[0] /= 2.0


@dataclass(frozen=True)
class Track:
    """Feasible points along a number z from low to high: places gives t (n,) and x (numbers, n) at z (n,)."""

    places: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    low: float
    high: float
    low_open: bool = False
    high_open: bool = False

    @classmethod
    def along(cls, curve: Curve, stretch: Stretch) -> Track:
        """A feasible part of a curve; a number without end is counted as z = p/(1 + p)."""
        open_ = curve.is_open(stretch.low), curve.is_open(stretch.high)
        if curve.top < inf:
            return cls(curve.places, stretch.low, stretch.high, *open_)
        low, high = (1.0 if p == inf else p / (1.0 + p) for p in (stretch.low, stretch.high))
        return cls(lambda z: curve.places(z / (1.0 - z)), low, high, *open_)

    def where(self, function: Function, value: float) -> Iterator[Place]:
        """Places where a function may have a value."""
        for series in _resolved(lambda z: function(*self.places(z)), self.low, self.high):
            t, x = self.places(series.where(value))
            yield from ((float(a), tuple(float(v) for v in b)) for a, b in zip(t, x.T, strict=True))

    def ranges(self, function: Function) -> Iterator[Range]:
        """What a function is along the track: at its ends and at every turn; nothing where it has no value."""
        series = _resolved(lambda z: function(*self.places(z)), self.low, self.high)
        width = self.high - self.low
        ends = np.array([self.low + _INSIDE * width, self.high - _INSIDE * width])
        places = np.concatenate([ends, *(s.turns() for s in series), *([s.low, s.high] for s in series[1:-1])])
        values = function(*self.places(places))
        open_ = np.array([self.low_open, self.high_open, *[False] * (places.size - 2)])
        good = np.isfinite(values)
        if good.any():
            values, open_ = values[good], open_[good]
            low, high = float(values.min()), float(values.max())
            near = 1e-9 * max(abs(low), abs(high))
            yield Range(low, high, bool(open_[values <= low + near].all()), bool(open_[values >= high - near].all()))


# -- Chebyshev series -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Series:
    """A function from low to high by its Chebyshev coefficients."""

    low: float
    high: float
    coefficients: np.ndarray

    def where(self, value: float) -> np.ndarray:
        """Places where the function may have a value."""
        c = self.coefficients.copy()
        c[0] -= value
        if abs(c[0]) > 1.001 * np.abs(c[1:]).sum() or np.abs(c).max() <= RESOLVED:
            return np.empty(0)  # too high or too low, or the same everywhere
        return self._places(c)

    def turns(self) -> np.ndarray:
        """Places of its extremes, the ends left out."""
        return self._places(chebyshev.chebder(self.coefficients))

    def _places(self, c: np.ndarray) -> np.ndarray:
        """The roots of a series over the same stretch."""
        size = np.abs(c).max(initial=0.0)
        kept = np.flatnonzero(np.abs(c) > 1e-15 * size)
        if size == 0.0 or not kept.size or kept[-1] == 0:
            return np.empty(0)
        u = np.atleast_1d(chebyshev.chebroots(c[: kept[-1] + 1]))
        real = u.real[(np.abs(u.imag) <= REAL) & (np.abs(u.real) <= 1.0 + REAL)]
        return 0.5 * (self.low + self.high) + 0.5 * (self.high - self.low) * np.clip(real, -1.0, 1.0)


def _resolved(function: Callable[[np.ndarray], np.ndarray], low: float, high: float) -> list[Series]:
    """A function of values about 1 as series side by side; nothing where it is nan."""
    waiting, found = [(low, high, DEPTH)], []
    while waiting:
        places = np.concatenate([0.5 * (a + b) + 0.5 * (b - a) * _PLACES for a, b, _ in waiting])
        rows = function(places).reshape(len(waiting), TERMS) @ _TRANSFORM.T
        halved = []
        for (a, b, depth), c in zip(waiting, rows, strict=True):
            if np.isfinite(c).all() and (depth == 0 or np.abs(c[-3:]).max() <= RESOLVED * max(1.0, np.abs(c).max())):
                found.append(Series(a, b, c))
            elif depth:
                middle = 0.5 * (a + b)
                halved += [(a, middle, depth - 1), (middle, b, depth - 1)]
        waiting = halved
    return sorted(found, key=lambda s: s.low)
