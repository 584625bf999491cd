"""Roots, ranges and extremes of functions of one number that exist on part of 0 ... 1 only.

Every function takes an array and is nan where it does not exist: one call looks at many places, and a bracket is cut
down by as many parts as a call takes, so that a handful of calls reach the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

POINTS = 193  # of a first look
PARTS = 33  # points that cut a bracket down
STEPS = 60  # more than enough: each step is a factor of 16 or 32
NEAR = 1e-32  # how near to 0 is looked

Function = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Interval:
    """low and high; the function was seen to exist at both, and in between."""

    low: float
    high: float


def _grid() -> np.ndarray:
    """0 ... 1 without its ends, with decades of points near both for what happens only there."""
    middle = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, POINTS - 1) / (POINTS - 1))
    low = 10.0 ** np.concatenate((np.arange(-32.0, -16.0, 4.0), np.arange(-16.0, -4.0)))
    high = 1.0 - 10.0 ** np.arange(-15.0, -4.0)
    return np.unique(np.concatenate((low, middle, high, [1.0 - 2.0**-53])))


GRID = _grid()


def _between(interval: Interval) -> np.ndarray:
    """The same spread over an interval, ends included."""
    x = interval.low + (interval.high - interval.low) * GRID
    return np.unique(np.concatenate(([interval.low], x[(x > interval.low) & (x < interval.high)], [interval.high])))


def intervals(slack: Function) -> list[Interval]:
    """Where slack >= 0 on 0 ... 1, each end found to the last bit. A stretch too short for the first look is found by
    the top of the slack in it."""
    x = GRID
    values = slack(x)
    for i in tops(values):
        if values[i] < 0.0:
            at, top = highest(slack, float(x[max(i - 1, 0)]), float(x[min(i + 1, x.size - 1)]))
            if top >= 0.0:
                place = int(np.searchsorted(x, at))
                x, values = np.insert(x, place, at), np.insert(values, place, top)
                return _joined(slack, x, values)  # at most one stretch is as short as that
    return _joined(slack, x, values)


def _joined(slack: Function, x: np.ndarray, values: np.ndarray) -> list[Interval]:
    good = values >= 0.0  # nan is not
    found, begin = [], float(x[0]) if good[0] else None
    for i in np.flatnonzero(good[1:] != good[:-1]):
        edge = _edge(slack, float(x[i]), float(x[i + 1]), bool(good[i]))
        if good[i + 1]:
            begin = edge
        elif begin is not None:
            found.append(Interval(begin, edge))
            begin = None
    if begin is not None:
        found.append(Interval(begin, float(x[-1])))
    return found


def _edge(slack: Function, a: float, b: float, good_a: bool) -> float:
    """The last number at which slack >= 0, between a and b."""
    good, bad = (a, b) if good_a else (b, a)
    for _ in range(STEPS):
        x = np.linspace(good, bad, PARTS)
        kept = slack(x[1:-1]) >= 0.0
        k = PARTS - 2 if kept.all() else int(np.argmin(kept))
        step = float(x[k]), float(x[k + 1])
        if step == (good, bad) or step[0] == step[1]:
            break
        good, bad = step
    return good


def tops(values: np.ndarray) -> np.ndarray:
    """Where samples are not below their neighbours, an end or a place beside nan included."""
    filled = np.where(np.isnan(values), -np.inf, values)
    beside = np.concatenate(([-np.inf], filled, [-np.inf]))
    return np.flatnonzero((filled >= beside[:-2]) & (filled >= beside[2:]) & (filled > -np.inf))


def highest(function: Function, a: float, b: float) -> tuple[float, float]:
    """Place and value of the top between a and b, where there is one top; an edge or a jump may be it."""
    best, value = a, -np.inf
    for _ in range(STEPS):
        x = np.linspace(a, b, PARTS)
        values = function(x)
        values = np.where(np.isnan(values), -np.inf, values)
        i = int(np.argmax(values))
        if values[i] > value:
            best, value = float(x[i]), float(values[i])
        narrower = float(x[max(i - 1, 0)]), float(x[min(i + 1, PARTS - 1)])
        if narrower == (a, b) or narrower[1] - narrower[0] <= 1e-16 * abs(best):
            break
        a, b = narrower
    return best, value


def roots(function: Function, interval: Interval, size: float) -> list[float]:
    """Zeros in an interval; one that is only touched counts, and so does an end that misses zero by rounding (1e-12 of
    ``size``, that of the terms)."""
    x = _between(interval)
    values = function(x)
    for sign in (1.0, -1.0):  # a pair of zeros between two samples
        for i in tops(sign * values):
            if sign * values[i] < 0.0:
                at, top = highest(_times(sign, function), float(x[max(i - 1, 0)]), float(x[min(i + 1, x.size - 1)]))
                if top >= -1e-14 * size:
                    place = int(np.searchsorted(x, at))
                    top = top if top > 0.0 else 0.0
                    x, values = np.insert(x, place, at), np.insert(values, place, sign * top)
                    break
    found = [float(v) for v in x[values == 0.0]]
    with np.errstate(invalid="ignore"):
        crossed = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0.0)
    for i in crossed:
        root = _root(function, float(x[i]), float(x[i + 1]), float(values[i]), float(values[i + 1]))
        if root is not None:
            found.append(root)
    for i in (0, -1):
        if 0.0 < abs(values[i]) <= 1e-12 * size and not any(abs(x[i] - r) <= 1e-9 for r in found):
            found.append(float(x[i]))
    return sorted(set(found))


def _times(sign: float, function: Function) -> Function:
    return lambda x: sign * function(x)


def _root(function: Function, a: float, b: float, fa: float, fb: float) -> float | None:
    """The sign change between a and b to the last bit; None where it is a jump or a pole."""
    bound = max(abs(fa), abs(fb))
    for _ in range(STEPS):
        x = np.linspace(a, b, PARTS)
        inner = function(x[1:-1])
        values = np.concatenate(([fa], inner, [fb]))
        same = np.sign(values) == np.sign(fa)
        k = int(np.argmin(same)) - 1 if not same.all() else PARTS - 2
        if values[k + 1] == 0.0:
            return float(x[k + 1])
        if np.isnan(values[k + 1]):
            return None
        step = float(x[k]), float(x[k + 1])
        if step == (a, b) or step[0] == step[1]:
            break
        (a, b), fa, fb = step, float(values[k]), float(values[k + 1])
    best, value = min(((a, abs(fa)), (b, abs(fb))), key=lambda p: p[1])
    return best if value <= 1e-6 * bound else None


def bracketed(function: Function, a: np.ndarray, b: np.ndarray, fa: np.ndarray, fb: np.ndarray) -> np.ndarray:
    """Zeros of many functions at once, each between its a and b, where they differ in sign: Chandrupatla's method, which
    interpolates where that is safe and halves where it is not (Adv. Eng. Software 28, 1997)."""
    a, b, fa, fb = (np.array(v, dtype=float) for v in (b, a, fb, fa))
    c, fc, t = b.copy(), fb.copy(), np.full(a.shape, 0.5)
    for _ in range(STEPS):
        x = a + t * (b - a)
        fx = function(x)
        same = np.sign(fx) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = x, fx
        best = np.where(np.abs(fa) < np.abs(fb), a, b)
        least = 4e-16 * np.abs(best) + 1e-300
        with np.errstate(all="ignore"):
            t_least = least / np.abs(b - c)
            if ((t_least > 0.5) | (fa == 0.0) | (b == c)).all():
                break
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            inner = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            safe = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi) & np.isfinite(inner)
        t = np.where(safe, inner, 0.5)
        t_least = np.where(np.isfinite(t_least), np.minimum(t_least, 0.5), 0.5)
        t = np.clip(t, t_least, 1.0 - t_least)
    return np.where(np.abs(fa) < np.abs(fb), a, b)


def extent(function: Function, interval: Interval) -> tuple[tuple[float, float], tuple[float, float]]:
    """(value, place) of the lowest and of the highest value on an interval, ends included."""
    x = _between(interval)
    values = function(x)
    ends = []
    for sign in (-1.0, 1.0):
        signed = sign * values
        best = max(_refined(_times(sign, function), x, signed))
        ends.append((sign * best[0], best[1]))
    return ends[0], ends[1]


def _refined(function: Function, x: np.ndarray, values: np.ndarray) -> Iterable[tuple[float, float]]:
    top = np.nanmax(values)
    spread = top - np.nanmin(values)
    for i in tops(values):
        yield float(values[i]), float(x[i])
        if 0 < i < x.size - 1 and values[i] >= top - 0.1 * spread:
            at, value = highest(function, float(x[i - 1]), float(x[i + 1]))
            yield value, at
