"""Double-length arithmetic, Gauss quadrature with Legendre polynomials, roots and minima of one variable.

Sources: T. J. Dekker 1971; D. E. Knuth, *The Art of Computer Programming*, vol. 2; G. H. Golub and J. H. Welsch 1969;
R. P. Brent 1973.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple, TypeVar

import numpy as np

from core.numerics.lazy import locked

# -- double-length arithmetic: high + low -----------------------------------------------------------------------


F = TypeVar("F", float, np.ndarray)
_SPLITTER = 134217729.0  # 2^27 + 1 splits a float into halves of its digits (Veltkamp)


def two_sum(a: F, b: F) -> tuple[F, F]:
    """Sum a + b, rounded, and its rounding error.

    References
    ----------
    Knuth, *The Art of Computer Programming*, vol. 2, sec. 4.2.2, theorem B.
    """
    total = a + b
    part = total - a
    rest = b - part
    part -= total
    part += a
    rest += part
    return total, rest


def _square(a: F) -> tuple[F, F]:
    """a², rounded, and its rounding error (Dekker 1971)."""
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


def double_square(high: F, low: F) -> tuple[F, F]:
    """Square (high + low)² in double length, for a small ``low``."""
    square, rest = _square(high)
    return square, rest + 2.0 * high * low


def double_sum_of_squares(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sum of squares x² + y² in double length.

    Parameters
    ----------
    x, y : ndarray (n,) [any]

    Returns
    -------
    high, low : ndarray (n,) [square of the unit]
    """
    (x2, x_rest), (y2, y_rest) = _square(x), _square(y)
    square, rest = two_sum(x2, y2)
    rest += x_rest + y_rest
    return square, rest


# -- Gauss quadrature and Legendre polynomials ------------------------------------------------------------------


@lru_cache(maxsize=64)
def gauss_legendre(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss-Legendre quadrature on -1 ... 1, exact for polynomials of degree 2 count - 1.

    Eigenvalues of the tridiagonal matrix of Golub and Welsch, refined by a step of Newton's method.

    Returns
    -------
    nodes, weights : ndarray (count,), dimensionless
        Nodes in ascending order.

    References
    ----------
    G. H. Golub and J. H. Welsch 1969, Calculation of Gauss quadrature rules.
    """
    k = np.arange(1, count)
    x = np.linalg.eigvalsh(np.diag(k / np.sqrt(4.0 * k * k - 1.0), -1))
    x -= legendre(x, count + 1)[count] / _slope(x, count)
    x = 0.5 * (x - x[::-1])
    weight = 2.0 / ((1.0 - x * x) * _slope(x, count) ** 2)
    return locked((x, weight * (2.0 / weight.sum())))


def _slope(x: np.ndarray, count: int) -> np.ndarray:
    """P'_count."""
    p = legendre(x, count + 1)
    return count * (p[count - 1] - x * p[count]) / (1.0 - x * x)


@lru_cache(maxsize=64)
def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss-Legendre quadrature on 0 ... 1.

    Returns
    -------
    nodes, weights : ndarray (count,), dimensionless
        Nodes in ascending order.
    """
    x, weight = gauss_legendre(count)
    return locked((0.5 + 0.5 * x, 0.5 * weight))


def legendre(x: np.ndarray, count: int) -> np.ndarray:
    """Legendre polynomials P_0 ... P_(count - 1).

    Parameters
    ----------
    x : ndarray (n,), dimensionless
    count : int

    Returns
    -------
    ndarray (count, n), dimensionless
    """
    p = np.ones((max(count, 2), x.size))
    p[1] = x
    for k in range(1, count - 1):
        p[k + 1] = ((2 * k + 1) * x * p[k] - k * p[k - 1]) / (k + 1)
    return p[:count]


def legendre_coefficients(count: int) -> np.ndarray:
    """Coefficients of the powers xᵏ in P_0 ... P_(count - 1).

    Returns
    -------
    ndarray (count, count), dimensionless
        A row for each polynomial.
    """
    p = np.eye(count)
    for k in range(1, count - 1):
        p[k + 1] = -k * p[k - 1] / (k + 1)
        p[k + 1, 1:] += (2 * k + 1) * p[k, :-1] / (k + 1)
    return p


def legendre_integrals(p: np.ndarray, one: np.ndarray) -> np.ndarray:
    """Integrals from -1 of the Legendre polynomials, by (2k + 1) P_k = (P_(k+1) - P_(k-1))'.

    Parameters
    ----------
    p : ndarray (k + 1, ...), dimensionless
        P_0 ... P_k, as values or as coefficients.
    one : ndarray (...), dimensionless
        The constant 1 in the same form.

    Returns
    -------
    ndarray (k, ...), dimensionless
        Integrals of all but the last.
    """
    below = np.concatenate((-one[None], p[:-2]))
    return np.asarray((p[1:] - below) / (2.0 * np.arange(p.shape[0] - 1.0) + 1.0)[:, None])


# -- roots and minima of functions of one variable that are expensive to evaluate -------------------------------


PASSES = 200
GOLDEN = 0.5 * (3.0 - 5.0**0.5)
EPS = float(np.finfo(float).eps)

Function = Callable[[float], float]


class BracketEnds(NamedTuple):
    """Two ends of a bracket, and the values of the function there."""

    a: float
    fa: float
    b: float
    fb: float


def bracketed_root(function: Function, ends: BracketEnds, tolerance: float = 0.0) -> BracketEnds:
    """Narrow the bracket [a, b] of a sign change by regula falsi, with the Illinois modification.

    The function may be NaN or infinite on the side of a; the bracket is bisected there.

    Parameters
    ----------
    function : callable
    ends : BracketEnds
    tolerance : float
        Width of the resulting bracket; 0: to the last bits.

    Returns
    -------
    BracketEnds

    References
    ----------
    M. Dowell and P. Jarratt 1971, A modified regula falsi method.
    """
    a, fa, b, fb = ends
    weight_a, weight_b, side = fa, fb, 0
    for _ in range(PASSES):
        width = abs(b - a)
        least = max(tolerance, 2.0 * EPS * max(abs(a), abs(b)))
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


def bounded_minimum(function: Function, low: float, high: float, tolerance: float) -> tuple[float, float]:
    """Minimum of a unimodal function in [low, high], by parabolic interpolation and golden section (Brent's method).

    Parameters
    ----------
    function : callable
        It is not evaluated at the ends.
    low, high : float
    tolerance : float
        Accuracy of x.

    Returns
    -------
    x, minimum : float

    References
    ----------
    R. P. Brent 1973, *Algorithms for Minimization without Derivatives*, ch. 5.
    """
    a, b = low, high
    x = w = v = a + GOLDEN * (b - a)
    fx = fw = fv = function(x)
    step = last = 0.0
    for _ in range(PASSES):
        middle, least = 0.5 * (a + b), tolerance + 2.0 * EPS * abs(x)
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
