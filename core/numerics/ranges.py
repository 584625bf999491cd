"""Ranges in which a function of one variable is not negative, and minima at which it falls to zero."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Function = Callable[[np.ndarray], np.ndarray]

_CUTS = 257  # samples in a bracket of a minimum; so many cost little more than a few
_ROUNDS = 3  # each makes the bracket 128 times narrower
_NEIGHBOURS = np.array([-3, -2, -1, 1, 2, 3])[:, None]  # samples around the lowest one
_PARTS = np.linspace(0.0, 1.0, 9)[1:-1, None]  # of a bracket of a change of sign
_DECADES = 10.0 ** -np.arange(1.0, 17.0)[:, None]
_DISTANCES = np.concatenate((-_DECADES, _DECADES))  # parts of the bracket, from the zero of the secant


def nonnegative_ranges(function: Function, at: np.ndarray, value: np.ndarray) -> list[tuple[float, float]]:
    """Ranges in which a function is >= 0; NaN counts as negative.

    A gap or a range between two samples is detected where the slopes at the samples indicate it, except next to infinite values.

    Parameters
    ----------
    function : callable
        Values (n,) at positions (n,).
    at : ndarray (n,) [rad or m]
        Rising samples of the position.
    value : ndarray (n,) [unit of the function]
        Values of the function there.

    Returns
    -------
    list of (float, float)
        Ends of each range [rad or m].
    """
    value = _nan_is_negative(value)
    for sign in (1.0, -1.0):  # gaps, then ranges between samples
        at, value = _with_minima(function, at, value, sign)
    good = value >= 0.0
    edge = np.flatnonzero(good[1:] != good[:-1])
    inside = _edges(function, at[[edge, edge + 1]], value[[edge, edge + 1]], good[edge]) if edge.size else edge
    ends = {int(i): float(x) for i, x in zip(edge, inside, strict=True)}
    ranges, begin = [], float(at[0]) if good[0] else None
    for i in edge.tolist():
        if good[i] and begin is not None:
            ranges.append((begin, ends[i]))
            begin = None
        else:
            begin = ends[i]
    if begin is not None:
        ranges.append((begin, float(at[-1])))
    return ranges


def zero_minima(function: Function, at: np.ndarray, value: np.ndarray, least: float) -> np.ndarray:
    """Minima at which a function, not negative, falls to zero within a tolerance.

    Near such a minimum the signed square root of the function is smooth, and its interpolant through six samples gives the zero;
    otherwise the bracket is narrowed.

    Parameters
    ----------
    function : callable
        Values (n,) at positions (n,).
    at : ndarray (n,) [rad or m]
        Rising samples of the position.
    value : ndarray (n,) [unit of the function]
        Values of the function there.
    least : float
        Tolerance, in the unit of the function.

    Returns
    -------
    ndarray (k,) [rad or m]
    """
    value = _nan_is_negative(value)
    around = _may_reach_zero(value, value) + _NEIGHBOURS
    if around.size and around.min() >= 0 and around.max() < at.size:
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sign(_NEIGHBOURS) * np.sqrt(value[around])
            zeros = _at_zero(at[around], root)
        near = (at[around[2]] < zeros) & (zeros < at[around[3]])
        if near.all() and (function(zeros) <= least).all():
            return zeros
    minima, values = _lowest(function, at, value, 1.0)
    return minima[values <= least]


def _at_zero(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Zeros (k,) of y by x, by Lagrange's polynomial in y through points (m, k)."""
    differences = y[:, None] - y
    diagonal = np.arange(len(y))
    parts = y[:, None] / differences
    parts[diagonal, diagonal] = 1.0
    return np.asarray((x * parts.prod(axis=0)).sum(axis=0))


def _nan_is_negative(value: np.ndarray) -> np.ndarray:
    return np.where(np.isnan(value), -np.inf, value)


def _with_minima(function: Function, at: np.ndarray, value: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
    """The samples together with the minima of sign times the function between them that may be on the other side of zero."""
    minima, values = _lowest(function, at, value, sign)
    order = np.argsort(np.concatenate((at, minima)), kind="stable")
    return np.concatenate((at, minima))[order], np.concatenate((value, values))[order]


def _lowest(function: Function, at: np.ndarray, value: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
    """Minima (k,) of sign times the function that may reach zero, and the function there."""
    middle = _may_reach_zero(value, sign * value)
    low, high = at[middle - 1], at[middle + 1]
    if not middle.size:
        return low, low
    share = np.linspace(0.0, 1.0, _CUTS)[:, None]
    rows = np.arange(middle.size)
    for _ in range(_ROUNDS):
        x = low + (high - low) * share
        y = sign * _nan_is_negative(function(x.ravel())).reshape(x.shape)
        best = y.argmin(axis=0)
        before, after = np.maximum(best - 1, 0), np.minimum(best + 1, _CUTS - 1)
        low, high = x[before, rows], x[after, rows]
    lowest, value = x[best, rows], y[best, rows]
    corner = _corner(low, y[before, rows], high, y[after, rows])
    corner_value = sign * _nan_is_negative(function(corner))
    is_lower = corner_value < value
    return np.where(is_lower, corner, lowest), sign * np.where(is_lower, corner_value, value)


def _may_reach_zero(value: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Indices (k,) of samples of v, ±value (n,), that are lowest among their neighbours, none of them infinite, and may be near 0."""
    left, middle, right = v[:-2], v[1:-1], v[2:]
    with np.errstate(invalid="ignore"):
        steepest = np.maximum(left - middle, right - middle)
        mask = (middle >= 0.0) & (middle <= left) & (middle <= right) & (middle <= steepest) & np.isfinite(middle)
        mask &= (value[:-2] < np.inf) & (value[2:] < np.inf)
    return np.flatnonzero(mask) + 1


def _corner(low: np.ndarray, left: np.ndarray, high: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Zero between low and high of a minimum with a corner, two straight lines with the values left and right at the ends.

    The sine of the angle between two guides has such a corner where they become parallel.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        corner = (low * right + high * left) / (left + right)
    return np.where(np.isfinite(corner) & (low <= corner) & (corner <= high), corner, low)


def _edges(function: Function, at: np.ndarray, value: np.ndarray, good: np.ndarray) -> np.ndarray:
    """At each change of sign in brackets (2, m), the last number (m,) at which the function is >= 0.

    The function is >= 0 at the first end of a bracket where `good`, else at the second. A call costs more than its values, so each
    bracket is divided at many points at a time: evenly, and closer and closer to the zero of the secant.
    """
    at, value = (np.where(good, pair, pair[::-1]) for pair in (at, value))
    rows = np.arange(good.size)
    while True:
        (begin, end), (above, below) = at, value
        width = end - begin
        with np.errstate(invalid="ignore", divide="ignore"):
            part = above / (above - below)
        part = np.where(np.isfinite(part), part, 0.5)
        x = begin + width * np.sort(np.clip(np.concatenate((_PARTS + 0.0 * part, part + _DISTANCES)), 0.0, 1.0), axis=0)
        if not ((x != begin) & (x != end)).any():
            return begin
        y = _nan_is_negative(function(x.ravel())).reshape(x.shape)
        x, y = np.vstack((begin, x, end)), np.vstack((above, y, below))
        good = y >= 0.0
        good[0], good[-1] = True, False  # also where rounding changes the ends
        first = good.argmin(axis=0)  # the first negative one
        at, value = (np.array([row[first - 1, rows], row[first, rows]]) for row in (x, y))
