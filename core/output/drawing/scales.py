"""Lines and scales of drawings: points that a thinned line needs, ticks at round numbers, units without exponents."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from core.frozen import frozen
from core.units import display_units

UNSEEN = 0.05  # error of a thinned line, pixels: invisible in an antialiased edge
PIECES = (64, 8, 4)  # numbers of points that one straight piece may replace, in the order of trial
MOST, FINEST = 1e5, 1e-3  # a peak outside these limits is shown with a power of ten in the unit

# -- thinned lines ----------------------------------------------------------------------------------------------


def needed(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Indices of the points that a thinned line needs.

    No omitted point is further than the tolerance from the straight piece that replaces it, so that extremes, corners
    and jumps remain. The first and the last point are needed, and both points at a gap.

    Parameters
    ----------
    points : ndarray (n,) complex [any unit of length]
        Points x + iy of the line; NaN in gaps.
    tolerance : float
        In the unit of the points; 0 returns all indices.

    Returns
    -------
    ndarray (m,) of int, ascending, dimensionless
    """
    n = points.size
    if tolerance <= 0.0 or n < 3:
        return np.arange(n)
    is_needed = np.zeros(n, dtype=bool)
    is_needed[-1] = True
    starts = np.arange(0, n - 1, PIECES[0])
    for length, shorter in zip(PIECES, (*PIECES[1:], 1), strict=True):
        near = _near(points, starts, np.minimum(starts + length, n - 1), length, tolerance)
        is_needed[starts[near]] = True
        starts = (starts[~near, None] + np.arange(0, length, shorter)).ravel()
        starts = starts[starts < n - 1]
    is_needed[starts] = True
    return np.flatnonzero(is_needed)


def _near(points: np.ndarray, start: np.ndarray, end: np.ndarray, length: int, tolerance: float) -> np.ndarray:
    """Whether all points between two indices (b,) are near the straight line between them, (b,) of bool."""
    chord = points[end] - points[start]
    size = np.abs(chord)[:, None]
    inner = points[np.minimum(start[:, None] + np.arange(1, length), end[:, None])] - points[start, None]
    local = inner * chord.conj()[:, None]  # components along and across the line, times its length
    room = tolerance * size
    near = (np.abs(local.imag) <= room) & (local.real >= -room) & (np.abs(inner) <= size + tolerance)
    return np.asarray(near.all(axis=1))


# -- ticks ------------------------------------------------------------------------------------------------------


def decimals_of(step: float) -> int:
    """Number of decimals that ticks with this step need."""
    return max(0, -math.floor(math.log10(step) + 1e-9))


def nice_below(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten up to ``value`` (> 0)."""
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))


def nice_step(span: float, most: int) -> float:
    """Smallest of 1, 2, 5 times a power of ten that divides ``span`` into at most ``most`` pieces."""
    least = span / max(1, most)
    power = 10.0 ** math.floor(math.log10(least))
    return power * next(step for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least * (1.0 - 1e-12))


def ticks(low: float, high: float, most: int) -> tuple[list[float], float]:
    """Round values from ``low`` to ``high``, at least two, and their step."""
    for pieces in range(max(1, most), max(1, most) + 4):
        step = nice_step(high - low, pieces)
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last > first:
            break
    return [step * i for i in range(first, last + 1)], step


# -- units ------------------------------------------------------------------------------------------------------

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@frozen
class DisplayUnit:
    """Unit that values are shown in.

    Attributes
    ----------
    symbol : of the unit
    size : in units of the channel
    least : least peak value, in this unit, for which it is used
    """

    symbol: str
    size: float
    least: float


@lru_cache(maxsize=128)
def _display_units(symbol: str) -> tuple[DisplayUnit, ...]:
    """Units in which values of this unit can be shown, the largest first."""
    return tuple(DisplayUnit(*row) for row in display_units(symbol))


def readable_unit(symbol: str, peak: float) -> DisplayUnit:
    """Unit that shows values up to ``peak`` (in ``symbol``) without an exponent."""
    units = _display_units(symbol)
    if not 0.0 < peak < math.inf:
        return next((unit for unit in units if unit.size == 1.0), units[-1])
    unit = next((unit for unit in units if peak / unit.size >= unit.least), units[-1])
    shown = peak / unit.size
    if FINEST <= shown < MOST:
        return unit
    power = 3 * math.floor(math.log10(shown) / 3.0)
    factor = f"10{str(power).translate(_SUPERSCRIPT)}"
    return DisplayUnit(f"{factor} {unit.symbol}".rstrip(), unit.size * 10.0**power, 0.0)
