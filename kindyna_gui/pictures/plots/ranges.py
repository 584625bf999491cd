"""What a value axis shows: all that is usual, 0 where it belongs, limits that are not far away."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite

import numpy as np

FREE = 0.07  # of the values' range, left free above and below
FAR_LIMIT = 3.0  # a limit further out than so many times the values is not shown
FROM_ZERO = frozenset({"velocity", "acceleration", "jerk", "pressure-angle", "force", "torque", "curvature", "ratio"})
"""Families whose axis always shows 0; places, lengths and angles show it only where it is near."""


def usual_range(values: np.ndarray) -> tuple[float, float]:
    """Least and largest value (n,); where some are infinite, of those that are not near infinity either."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return 0.0, 0.0
    low, high = float(finite.min()), float(finite.max())
    if finite.size < values.size or not isfinite(high - low):
        inner = np.percentile(finite, (2.0, 98.0))
        spread = 0.5 * float(inner[1] - inner[0])
        return max(low, float(inner[0]) - spread), min(high, float(inner[1]) + spread)
    return low, high


def peak(rows: Sequence[np.ndarray]) -> float:
    """The largest usual size of several curves."""
    return max(max(abs(side) for side in usual_range(values)) for values in rows)


def shown_range(rows: Sequence[np.ndarray], families: Iterable[str], limits: Sequence[float]) -> tuple[float, float]:
    """Lowest and highest value of the axis for these curves and limits, in one unit."""
    return room_for([usual_range(values) for values in rows], families, limits)


def room_for(
    sides: Sequence[tuple[float, float]], families: Iterable[str], limits: Sequence[float]
) -> tuple[float, float]:
    """The same for curves whose usual ranges are known."""
    low, high = min(side[0] for side in sides), max(side[1] for side in sides)
    near = 0.3 * (high - low)
    if FROM_ZERO.intersection(families) or 0.0 < low < near or -near < high < 0.0:
        low, high = min(low, 0.0), max(high, 0.0)
    for limit in limits:
        if abs(limit) <= FAR_LIMIT * max(abs(low), abs(high)):
            low, high = min(low, limit), max(high, limit)
    size = max(abs(low), abs(high))
    if high - low <= 1e-9 * size or high == low:
        half = 0.1 * size or 1.0
        low, high = low - half, high + half
    room = FREE * (high - low)
    return low - room, high + room
