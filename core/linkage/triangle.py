"""The triangle that every dyad comes down to, by Kahan's formula: accurate down to dead centres."""

from __future__ import annotations

import math
from typing import Any

import numpy as np


def area4(r: np.ndarray, a: float, b: float) -> np.ndarray:
    """K = 4 x area of the triangles with sides r (n,), a, b, NaN where there is none (0 on a straight line).

    Sorted A >= B >= C: K = sqrt((A+(B+C))(C-(A-B))(C+(A-B))(A+(B-C))). Kahan, Miscalculating Area and Angles of a
    Needle-like Triangle. A single factor, C-(A-B), turns negative where the sides do not meet.
    """
    return area4_and_room(r, a, b)[0]


def area4_and_room(r: np.ndarray, a: float, b: float) -> tuple[np.ndarray, np.ndarray]:
    """K as ``area4`` gives it, and C-(A-B) (n,): what is left before the sides no longer meet, negative where K is NaN."""
    low, high = min(a, b), max(a, b)
    big, mid, small = np.maximum(r, high), np.clip(r, low, high), np.minimum(r, low)
    product = _square(small, mid, big)
    return np.sqrt(np.where(product < 0.0, np.nan, product)), small - (big - mid)


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
