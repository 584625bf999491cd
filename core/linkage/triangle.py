"""The triangle that every dyad comes down to, by Kahan's formula: accurate down to dead centres."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from core.exact import two_sum


@np.errstate(invalid="ignore")
def area4(r: np.ndarray, a: float, b: float) -> np.ndarray:
    """K = 4 x area of the triangles with sides r (n,), a, b, NaN where there is none (0 on a straight line).

    K = sqrt((a+b-r)(a+b+r)(r-|a-b|)(r+|a-b|)), of which what rounding takes from a+b and a-b is given back, so that each
    factor is good to an eps: as accurate as Kahan's formula (Miscalculating Area and Angles of a Needle-like Triangle)
    without putting the sides in order. Only one factor turns negative where they do not meet.
    """
    product, folded = _gaps(r, a, b)
    product *= folded
    product *= r + (a + b)
    product *= r + abs(a - b)
    return np.sqrt(product, out=product)


def room4(r: np.ndarray, a: float, b: float) -> np.ndarray:
    """What is left (n,) before the sides no longer meet: the lesser of a+b-r and r-|a-b|, negative where they do not."""
    return np.minimum(*_gaps(r, a, b))


def _gaps(r: np.ndarray, a: float, b: float) -> tuple[np.ndarray, np.ndarray]:
    """a+b-r and r-|a-b| (n,), good to an eps."""
    (reach, more), (fold, less) = two_sum(a, b), two_sum(max(a, b), -min(a, b))
    stretched, folded = reach - r, r - fold
    stretched += more
    folded -= less
    return stretched, folded


def _square(small: Any, mid: Any, big: Any) -> Any:
    """K² for sides that are sorted."""
    gap = big - mid
    return (big + (mid + small)) * (small - gap) * (small + gap) * (big + (mid - small))


def area4_of(a: float, b: float, c: float) -> float:
    """The same for three plain lengths; NaN where they make no triangle."""
    small, mid, big = sorted((a, b, c))
    product = _square(small, mid, big)
    return math.sqrt(product) if product >= 0.0 else math.nan


def opposite_angle(a: float, b: float, c: float) -> float:
    """Angle between the sides a and b [rad], NaN where a, b, c make no triangle."""
    return math.atan2(area4_of(a, b, c), a * a + (b - c) * (b + c))
