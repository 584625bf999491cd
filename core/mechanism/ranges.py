"""Where a function of the driver's position is not negative: ranges refined to the last digit, narrow gaps included."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Function = Callable[[np.ndarray], np.ndarray]

_CUTS = 257  # samples of a bracket of a minimum: so many cost hardly more than a few
_ROUNDS = 3  # each makes it 128 times narrower; what is lowest is flat there
_BESIDES = np.array([-3, -2, -1, 1, 2, 3])[:, None]  # samples around a lowest one
_PARTS = np.linspace(0.0, 1.0, 9)[1:-1, None]  # of a bracket of a change of sign
_DECADES = 10.0 ** -np.arange(1.0, 17.0)[:, None]
_ABOUT = np.concatenate((-_DECADES, _DECADES))  # of it, from where a straight line through its ends changes its sign


def ranges_where(function: Function, at: np.ndarray, value: np.ndarray) -> list[tuple[float, float]]:
    """Ranges in which ``function`` (n,) -> (n,) is >= 0, from its value (n,) at rising samples at (n,); NaN counts as negative.

    A gap or an island that falls between samples is found where its slopes point at it, but not beside what is infinite.
    """
    value = _nan_is_negative(value)
    for sign in (1.0, -1.0):  # gaps, then islands
        at, value = _with_minima(function, at, value, sign)
    good = value >= 0.0
    edge = np.flatnonzero(good[1:] != good[:-1])
    inside = _edges(function, at[[edge, edge + 1]], value[[edge, edge + 1]], good[edge])
    ends = {int(i): float(x) for i, x in zip(edge, inside, strict=True)}
    found, begin = [], float(at[0]) if good[0] else None
    for i in edge.tolist():
        if good[i] and begin is not None:
            found.append((begin, ends[i]))
            begin = None
        else:
            begin = ends[i]
    if begin is not None:
        found.append((begin, float(at[-1])))
    return found


def touched(function: Function, at: np.ndarray, value: np.ndarray, least: float) -> np.ndarray:
    """Where the function (n,) -> (n,), known at samples (n,), comes down to no more than ``least`` and goes up again: places (k,).

    Beside zero its root goes through as smoothly as a line: by the samples around that is known at once; else it is narrowed down.
    """
    value = _nan_is_negative(value)
    around = _may_reach_zero(value, value) + _BESIDES
    if around.size and around.min() >= 0 and around.max() < at.size:
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sign(_BESIDES) * np.sqrt(value[around])
            places = _at_zero(at[around], root)
        near = (at[around[2]] < places) & (places < at[around[3]])
        if near.all() and (function(places) <= least).all():
            return places
    places, values = _lowest(function, at, value, 1.0)
    return places[values <= least]


def _at_zero(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """x (k,) where y is 0, by Lagrange's polynomial in y through points (m, k)."""
    others = y[:, None] - y  # of each point those that the others are away
    own = np.arange(len(y))
    parts = y[:, None] / others
    parts[own, own] = 1.0
    return np.asarray((x * parts.prod(axis=0)).sum(axis=0))


def _nan_is_negative(value: np.ndarray) -> np.ndarray:
    return np.where(np.isnan(value), -np.inf, value)


def _with_minima(function: Function, at: np.ndarray, value: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
    """The samples and, between them, minima (of sign times the function) that may lie on the other side of zero."""
    places, values = _lowest(function, at, value, sign)
    order = np.argsort(np.concatenate((at, places)), kind="stable")
    return np.concatenate((at, places))[order], np.concatenate((value, values))[order]


def _lowest(function: Function, at: np.ndarray, value: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
    spots = _may_reach_zero(value, sign * value)
    low, high = at[spots - 1], at[spots + 1]
    if not spots.size:
        return low, low
    share = np.linspace(0.0, 1.0, _CUTS)[:, None]
    rows = np.arange(spots.size)
    for _ in range(_ROUNDS):
        x = low + (high - low) * share
        y = sign * _nan_is_negative(function(x.ravel())).reshape(x.shape)
        best = y.argmin(axis=0)
        before, after = np.maximum(best - 1, 0), np.minimum(best + 1, _CUTS - 1)
        low, high = x[before, rows], x[after, rows]
    place, value = x[best, rows], y[best, rows]
    corner = _corner(low, y[before, rows], high, y[after, rows])
    there = sign * _nan_is_negative(function(corner))
    lower = there < value
    return np.where(lower, corner, place), sign * np.where(lower, there, value)


def _may_reach_zero(value: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Samples (k,) of v, the value (n,) or its opposite, between which and their neighbours it may be 0: beside nothing infinite."""
    left, middle, right = v[:-2], v[1:-1], v[2:]
    with np.errstate(invalid="ignore"):
        steepest = np.maximum(left - middle, right - middle)
        may = (middle >= 0.0) & (middle <= left) & (middle <= right) & (middle <= steepest) & np.isfinite(middle)
        may &= (value[:-2] < np.inf) & (value[2:] < np.inf)
    return np.flatnonzero(may) + 1


def _corner(low: np.ndarray, left: np.ndarray, high: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Where two straight flanks, of these values at low and high, meet at zero between them: a minimum with a corner, such as of the
    sine of guides that turn parallel, is not flat at its bottom."""
    with np.errstate(divide="ignore", invalid="ignore"):
        corner = (low * right + high * left) / (left + right)
    return np.where(np.isfinite(corner) & (low <= corner) & (corner <= high), corner, low)


def _edges(function: Function, at: np.ndarray, value: np.ndarray, good: np.ndarray) -> np.ndarray:
    """At each change of sign, between places (2, m) with these values, the last number where the function is >= 0, which it is at the
    first place where ``good`` (m,). A call costs more than its values, so each bracket is cut at many places at a time: evenly, and
    closer and closer to where a straight line is zero."""
    at, value = (np.where(good, each, each[::-1]) for each in (at, value))
    rows = np.arange(good.size)
    while True:
        (begin, end), (above, below) = at, value
        width = end - begin
        with np.errstate(invalid="ignore", divide="ignore"):
            part = above / (above - below)
        part = np.where(np.isfinite(part), part, 0.5)
        x = begin + width * np.sort(np.clip(np.concatenate((_PARTS + 0.0 * part, part + _ABOUT)), 0.0, 1.0), axis=0)
        if not ((x != begin) & (x != end)).any():
            return begin
        y = _nan_is_negative(function(x.ravel())).reshape(x.shape)
        x, y = np.vstack((begin, x, end)), np.vstack((above, y, below))
        keeps = y >= 0.0
        keeps[0], keeps[-1] = True, False  # whatever rounding makes of places that are the ends
        first = keeps.argmin(axis=0)  # the first that is negative
        at, value = (np.array([each[first - 1, rows], each[first, rows]]) for each in (x, y))
