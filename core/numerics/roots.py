"""Arithmetic of which the rounding is known: sums and squares in two parts, high + low."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple, TypeVar

import numpy as np

from core.numerics.lazy import locked

# -- arithmetic of which the rounding is known ------------------------------------------------------------------


F = TypeVar("F", float, np.ndarray)
_SPLITTER = 134217729.0  # 2^27 + 1: halves of a float's digits (Veltkamp)


def two_sum(a: F, b: F) -> tuple[F, F]:
    """a + b rounded, and what rounding took (Knuth)."""
    total = a + b
    part = total - a
    rest = b - part
    part -= total
    part += a
    rest += part
    return total, rest


def _square(a: F) -> tuple[F, F]:
    """a² rounded, and what rounding took (Dekker)."""
    high = _SPLITTER * a
    high -= high - a
    low = a - high
    square = a * a
    rest = high * high
    rest -= square
    high *= 2.0 * low
    rest += high
    low *= low
    rest += low
    return square, rest


def square_of(high: F, low: F) -> tuple[F, F]:
    """(high + low)² for a small ``low``."""
    square, rest = _square(high)
    return square, rest + 2.0 * high * low


def squares_of(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x² + y² (n,)."""
    (x2, x_rest), (y2, y_rest) = _square(x), _square(y)
    square, rest = two_sum(x2, y2)
    rest += x_rest + y_rest
    return square, rest


# -- gauss's rule and Legendre's polynomials --------------------------------------------------------------------


@lru_cache(maxsize=64)
def gauss_legendre(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (count,) in rising order and weights (count,) on -1 ... 1: eigenvalues of the tridiagonal matrix of Golub and Welsch, with
    a step of Newton's; exact for polynomials of degree 2 count - 1."""
    k = np.arange(1, count)
    x = np.linalg.eigvalsh(np.diag(k / np.sqrt(4.0 * k * k - 1.0), -1))
    x -= _value(x, count) / _slope(x, count)
    x = 0.5 * (x - x[::-1])
    weight = 2.0 / ((1.0 - x * x) * _slope(x, count) ** 2)
    return locked((x, weight * (2.0 / weight.sum())))


def _value(x: np.ndarray, count: int) -> np.ndarray:
    return legendre(x, count + 1)[count]


def _slope(x: np.ndarray, count: int) -> np.ndarray:
    """P'_count."""
    p = legendre(x, count + 1)
    return count * (p[count - 1] - x * p[count]) / (1.0 - x * x)


@lru_cache(maxsize=64)
def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """The same on 0 ... 1."""
    x, weight = gauss_legendre(count)
    return locked((0.5 + 0.5 * x, 0.5 * weight))


def legendre(x: np.ndarray, count: int) -> np.ndarray:
    """P_0 ... P_(count - 1) (count, n) at x (n,)."""
    p = np.ones((max(count, 2), x.size))
    p[1] = x
    for k in range(1, count - 1):
        p[k + 1] = ((2 * k + 1) * x * p[k] - k * p[k - 1]) / (k + 1)
    return p[:count]


def legendre_powers(count: int) -> np.ndarray:
    """Of the same the coefficients (count, count) of x**k, a row each."""
    p = np.eye(count)
    for k in range(1, count - 1):
        p[k + 1] = -k * p[k - 1] / (k + 1)
        p[k + 1, 1:] += (2 * k + 1) * p[k, :-1] / (k + 1)
    return p


def integrated(p: np.ndarray, one: np.ndarray) -> np.ndarray:
    """Their integrals from -1 (n - 1, ...): of P_0 ... P_n (n + 1, ...), the last of which has none, as values or as coefficients;
    one: 1 as these are. (2k + 1) P_k is the derivative of P_(k+1) - P_(k-1)."""
    below = np.concatenate((-one[None], p[:-2]))
    return np.asarray((p[1:] - below) / (2.0 * np.arange(p.shape[0] - 1.0) + 1.0)[:, None])


# -- roots and minima of functions of one number that are dear to evaluate --------------------------------------


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
