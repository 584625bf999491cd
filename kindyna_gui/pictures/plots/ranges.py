"""What a value axis shows: all that is usual, 0 where it belongs, limits that are not far away."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite

import numpy as np

FREE = 0.07  # of the values' range, left free above and below
FAR_LIMIT = 3.0  # a limit further out than so many times the values is not shown
SPIKE = 3.0  # what lies further out than so many times the range of the rest is a spike ...
REST, CORE = (
    0.02,
    0.05,
)  # ... that is without this share of the lowest and highest values; the core of it that is shown then
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


def readable_range(values: np.ndarray, moving: np.ndarray) -> tuple[float, float]:
    """The same without spikes, as of the torque near a dead centre, which would leave a line of all the rest.

    moving: (n,) at which samples the mechanism moves; dwells are shown, but say nothing of what is usual in between.
    """
    low, high = usual_range(values)
    known = np.isfinite(values)
    ordered, resting = np.sort(values[known & moving]), values[known & ~moving]
    if not _leaves(low, high, *_without(ordered, REST)):
        return low, high
    inner = _without(ordered, CORE)
    room = 0.5 * (inner[1] - inner[0])
    shown = (
        inner[0] - room if _leaves(low, inner[1], *inner) else low,
        inner[1] + room if _leaves(inner[0], high, *inner) else high,
    )
    return (min(shown[0], *resting), max(shown[1], *resting)) if resting.size else shown


def _without(ordered: np.ndarray, share: float) -> tuple[float, float]:
    """Lowest and highest of values in rising order (n,) without this share of either end."""
    cut = int(share * ordered.size)
    return (float(ordered[cut]), float(ordered[-1 - cut])) if ordered.size else (0.0, 0.0)


def _leaves(low: float, high: float, inner_low: float, inner_high: float) -> bool:
    """Whether a range goes far beyond an inner one."""
    return 0.0 < SPIKE * (inner_high - inner_low) < max(inner_low - low, high - inner_high)


def peak(rows: Sequence[np.ndarray]) -> float:
    """The largest usual size of several curves."""
    return max(max(abs(side) for side in usual_range(values)) for values in rows)


def shown_range(rows: Sequence[np.ndarray], families: Iterable[str], limits: Sequence[float]) -> tuple[float, float]:
    """Lowest and highest value of the axis for these curves and limits, in one unit."""
    return room_for([usual_range(values) for values in rows], families, limits)


def room_for(
    sides: Sequence[tuple[float, float]], families: Iterable[str], limits: Sequence[float], free: float = FREE
) -> tuple[float, float]:
    """The same for curves whose usual ranges are known; free: part of the values' range, left free above and below."""
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
    room = free * (high - low)
    return low - room, high + room
