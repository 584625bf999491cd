"""Roots and minima of functions of one number that are dear to evaluate."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

PASSES = 200
GOLDEN = 0.5 * (3.0 - 5.0**0.5)
EPS = float(np.finfo(float).eps)

Function = Callable[[float], float]


class BracketEnds(NamedTuple):
    """What is left of a bracket: its two ends, and the function there."""

    a: float
    fa: float
    b: float
    fb: float


def bracketed_root(function: Function, ends: BracketEnds, finest: float = 0.0) -> BracketEnds:
    """The bracket [a, b] of a change of sign narrowed to the width ``finest``, or to the last bits: false position, where an end
    that stays a second time counts half (Illinois).

    The function may be NaN or infinite beyond b, on the side of a: there the bracket is halved.
    """
    a, fa, b, fb = ends
    weight_a, weight_b, side = fa, fb, 0
    for _ in range(PASSES):
        width = abs(b - a)
        least = max(finest, 2.0 * EPS * max(abs(a), abs(b)))
        if width <= least or fb == 0.0:
            break
        if np.isfinite(weight_a) and weight_a != weight_b:
            x = b - weight_b * (b - a) / (weight_b - weight_a)
            inside = min(0.25 * least, 0.25 * width)
            x = min(max(x, min(a, b) + inside), max(a, b) - inside)
        else:
            x = 0.5 * (a + b)
        if x in (a, b):
            break
        fx = function(x)
        if fx == 0.0:
            return BracketEnds(a, fa, x, 0.0)
        if np.isfinite(fx) and (fx > 0.0) == (fb > 0.0):
            b, fb, weight_b = x, fx, fx
            weight_a = 0.5 * weight_a if side > 0 else fa
            side = 1
        else:
            a, fa, weight_a = x, fx, fx
            weight_b = 0.5 * weight_b if side < 0 else fb
            side = -1
    return BracketEnds(a, fa, b, fb)


def bounded_minimum(function: Function, low: float, high: float, finest: float) -> tuple[float, float]:
    """Where a function of one hollow has its least value in [low, high], to ``finest``, and that value: parabolas through the
    three best points, golden section where they do not help (Brent 1973, ch. 5). The ends themselves are not evaluated."""
    a, b = low, high
    x = w = v = a + GOLDEN * (b - a)
    fx = fw = fv = function(x)
    step = last = 0.0
    for _ in range(PASSES):
        middle, least = 0.5 * (a + b), finest + 2.0 * EPS * abs(x)
        if abs(x - middle) <= 2.0 * least - 0.5 * (b - a):
            break
        p = q = 0.0
        if abs(last) > least and np.isfinite((fx, fw, fv)).all():
            r, q = (x - w) * (fx - fv), (x - v) * (fx - fw)
            p, q = (x - v) * q - (x - w) * r, 2.0 * (q - r)
            p, q = (-p, q) if q > 0.0 else (p, -q)
        if q and abs(p) < abs(0.5 * q * last) and q * (a - x) < p < q * (b - x):
            last, step = step, p / q
            if min(x + step - a, b - x - step) < 2.0 * least:
                step = float(np.copysign(least, middle - x))
        else:
            last = (a if x >= middle else b) - x
            step = GOLDEN * last
        u = x + (step if abs(step) >= least else float(np.copysign(least, step)))
        fu = function(u)
        if fu <= fx:
            a, b = (x, b) if u >= x else (a, x)
            v, fv, w, fw, x, fx = w, fw, x, fx, u, fu
        else:
            a, b = (u, b) if u < x else (a, u)
            if fu <= fw or w == x:
                v, fv, w, fw = w, fw, u, fu
            elif fu <= fv or v in (x, w):
                v, fv = u, fu
    return x, fx
