"""All roots and extremes of a smooth function of one number: its Chebyshev series, cut where it is not resolved
(Trefethen, Approximation Theory and Approximation Practice, ch. 18)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

Function = Callable[[np.ndarray], np.ndarray]

TERMS = 24
DEPTH = 26  # how often a stretch may be halved
RESOLVED = 1e-13  # the last terms, as a share of the function's size
REAL = 1e-3  # how far beside the real numbers a root may lie: the caller, who knows the equations, decides

_ANGLES = np.pi * (np.arange(TERMS) + 0.5) / TERMS
_PLACES = np.cos(_ANGLES)
_TRANSFORM = (2.0 / TERMS) * np.cos(np.outer(np.arange(TERMS), _ANGLES))
_TRANSFORM[0] /= 2.0


@dataclass(frozen=True)
class Series:
    """A function from low to high by its coefficients."""

    low: float
    high: float
    coefficients: np.ndarray

    def _places(self, u: np.ndarray) -> np.ndarray:
        real = u.real[(np.abs(u.imag) <= REAL) & (np.abs(u.real) <= 1.0 + REAL)]
        return 0.5 * (self.low + self.high) + 0.5 * (self.high - self.low) * np.clip(real, -1.0, 1.0)

    def where(self, value: float) -> np.ndarray:
        """Places where the function may be that high."""
        c = self.coefficients.copy()
        c[0] -= value
        if abs(c[0]) > 1.001 * np.abs(c[1:]).sum() or np.abs(c).max() <= RESOLVED:
            return np.empty(0)  # too high or too low, or the same everywhere
        return self._places(_roots(c))

    def turns(self) -> np.ndarray:
        """Places of its extremes, the ends left out."""
        return self._places(_roots(chebyshev.chebder(self.coefficients)))


def _roots(c: np.ndarray) -> np.ndarray:
    size = np.abs(c).max(initial=0.0)
    kept = np.flatnonzero(np.abs(c) > 1e-15 * size)
    if size == 0.0 or not kept.size or kept[-1] == 0:
        return np.empty(0)
    return np.atleast_1d(chebyshev.chebroots(c[: kept[-1] + 1]))


def resolved(function: Function, low: float, high: float, size: float) -> list[Series]:
    """The function as series side by side; where it is nan nothing is said of it. size: what its values are like."""
    waiting, found = [(low, high, DEPTH)], []
    while waiting:
        places = np.concatenate([0.5 * (a + b) + 0.5 * (b - a) * _PLACES for a, b, _ in waiting])
        rows = function(places).reshape(len(waiting), TERMS)
        coefficients = rows @ _TRANSFORM.T
        halved = []
        for (a, b, depth), c in zip(waiting, coefficients, strict=True):
            good = bool(np.isfinite(c).all())
            if good and (depth == 0 or np.abs(c[-3:]).max() <= RESOLVED * max(size, np.abs(c).max())):
                found.append(Series(a, b, c))
            elif depth:
                middle = 0.5 * (a + b)
                halved += [(a, middle, depth - 1), (middle, b, depth - 1)]
        waiting = halved
    return sorted(found, key=lambda s: s.low)
