"""Gauss's rule and Legendre's polynomials. Not numpy's, whose import of all kinds of polynomials costs as much as a stage."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from core.numerics.lazy import locked


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
