"""Roots and ranges of functions of one number that exist on part of an interval only."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

POINTS = 129
_LEAST = 1e-300

Function = Callable[[float], float | None]
"""None where it does not exist."""


@dataclass(frozen=True)
class Interval:
    """low and high; the function was seen to exist in between, and at the ends at least as a limit."""

    low: float
    high: float


def existing_intervals(exists: Callable[[float], bool], low: float, high: float) -> list[Interval]:
    """Where a condition holds between low and high: scanned, more densely towards the ends, and each end found by
    bisection to the last bit."""
    x = low + (high - low) * _towards_ends()
    ok = [exists(float(v)) for v in x]
    found, begin = [], float(x[0]) if ok[0] else None
    for (a, good_a), (b, good_b) in pairwise(zip(map(float, x), ok, strict=True)):
        if good_a != good_b:
            edge = _bisect(exists, a, b, good_a)
            if good_b:
                begin = edge
            elif begin is not None:
                found.append(Interval(begin, edge))
                begin = None
    if begin is not None:
        found.append(Interval(begin, float(x[-1])))
    return found


def _towards_ends() -> np.ndarray:
    """0 ... 1, with decades of points at both ends for what happens only there."""
    middle = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, POINTS - 1) / (POINTS - 1))
    tail = 10.0 ** np.arange(-12.0, -4.0)
    return np.unique(np.concatenate(([0.0], tail, middle, 1.0 - tail, [1.0])))


def _bisect(exists: Callable[[float], bool], a: float, b: float, good_a: bool) -> float:
    """The last number at which the condition still holds, between a and b."""
    good, bad = (a, b) if good_a else (b, a)
    while True:
        middle = 0.5 * (good + bad)
        if middle in (good, bad):
            return good
        if exists(middle):
            good = middle
        else:
            bad = middle


def roots(function: Callable[[float], float], interval: Interval, points: int = 65) -> list[float]:
    """Zeros in an interval: sign changes of samples, each refined; a zero at an end counts."""
    from scipy.optimize import brentq

    x = interval.low + (interval.high - interval.low) * _towards_ends()[:: max(1, POINTS // points)]
    x = np.unique(np.concatenate(([interval.low], x, [interval.high])))
    values = [function(float(v)) for v in x]
    found = []
    for (a, fa), (b, fb) in pairwise(zip(map(float, x), values, strict=True)):
        if fa == 0.0:
            found.append(a)
        elif np.isfinite(fa) and np.isfinite(fb) and fa * fb < 0.0:
            found.append(float(brentq(function, a, b, xtol=1e-300, rtol=4.0 * np.finfo(float).eps, maxiter=300)))
    if values[-1] == 0.0:
        found.append(float(x[-1]))
    return found


def extent(function: Callable[[float], float], interval: Interval) -> tuple[float, float]:
    """Lowest and highest value on an interval, ends included; refined where an extreme lies inside."""
    from scipy.optimize import minimize_scalar

    x = interval.low + (interval.high - interval.low) * _towards_ends()
    values = np.array([function(float(v)) for v in x])
    ends = []
    for sign in (1.0, -1.0):
        signed = np.where(np.isnan(values), np.inf, sign * values)
        i = int(np.argmin(signed))
        best = float(signed[i])
        if 0 < i < x.size - 1:
            inner = minimize_scalar(
                lambda v, s=sign: s * function(float(v)),
                bounds=(x[i - 1], x[i + 1]),
                method="bounded",
                options={"xatol": 1e-14 * max(1.0, abs(x[i]))},
            )
            best = min(best, float(inner.fun))
        ends.append(sign * best)
    return ends[0], ends[1]
