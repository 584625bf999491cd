"""The triangle that a dyad of two rods comes down to, accurate down to its dead centres."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from core.numerics.compensated_sum import square_of, squares_of, two_sum


class Brackets(NamedTuple):
    """Of triangles with the sides r (n,), a, b: r², (a+b)² - r² and r² - (a-b)² [m²] (n,).

    Their product is K² = (4 x area)². The brackets are the distances from the two dead centres, in squares; each is
    negative where the sides do not meet.
    """

    square: np.ndarray
    stretched: np.ndarray
    folded: np.ndarray

    def gap(self, a: float, b: float) -> np.ndarray:
        """What is left before the sides no longer meet (n,) [m]: the lesser of a+b-r and r-|a-b|."""
        r, shortest = np.sqrt(self.square), abs(a - b)
        over = r + shortest
        return np.minimum(self.stretched / (a + b + r), self.folded / np.where(over > 0.0, over, 1.0))


NEAR = 0.25  # of r²: a bracket below it is near a dead centre


def brackets(x: np.ndarray, y: np.ndarray, a: float, b: float) -> Brackets:
    """The brackets for r² = x² + y² (n,) [m²]; those near a dead centre by ``_near_dead_centre``."""
    square = x * x
    square += y * y
    longest, shortest = a + b, a - b
    found = Brackets(square, longest * longest - square, square - shortest * shortest)
    near = np.minimum(found.stretched, found.folded) < NEAR * square
    if near.any():
        if square.shape != near.shape:
            found = Brackets(*(np.array(np.broadcast_to(each, near.shape)) for each in found))
        sides = (np.broadcast_to(each, near.shape)[near] for each in (x, y, a, b))
        for all_of, those in zip(found, _near_dead_centre(*sides), strict=True):
            all_of[near] = those
    return found


def _near_dead_centre(x: np.ndarray, y: np.ndarray, a: np.ndarray, b: np.ndarray) -> Brackets:
    """Every square is kept with what rounding took from it: near a dead centre a bracket is a small difference of large
    squares, and would lose (S/K)² eps otherwise (Kahan, Miscalculating Area and Angles of a Needle-like Triangle).
    """
    square, rest = squares_of(x, y)
    (longest, more), (shortest, less) = square_of(*two_sum(a, b)), square_of(*two_sum(a, -b))
    stretched, folded = longest - square, square - shortest
    stretched += more - rest
    folded += rest - less
    return Brackets(square, stretched, folded)


def area4_of(a: Any, b: Any, c: Any) -> Any:
    """K = 4 x area of the triangle with three plain lengths, by Kahan's formula; NaN where they make none."""
    small, mid, big = np.sort(np.broadcast_arrays(a, b, c), axis=0)
    gap = big - mid
    product = (big + (mid + small)) * (small - gap) * (small + gap) * (big + (mid - small))
    return np.sqrt(np.where(product >= 0.0, product, np.nan))


def opposite_angle(a: Any, b: Any, c: Any) -> Any:
    """Angle between the sides a and b [rad], NaN where a, b, c make no triangle."""
    return np.arctan2(area4_of(a, b, c), a * a + (b - c) * (b + c))
