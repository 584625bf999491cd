"""Plane vectors as complex numbers, and points that turn."""

from __future__ import annotations

import numpy as np

BLOCK = 16_384  # vectors that are worked on at once: what a processor's cache holds


def cross(a: np.ndarray | complex, b: np.ndarray | complex) -> np.ndarray:
    """a × b, the component out of the plane."""
    return np.asarray(a.real * b.imag - a.imag * b.real)


def dot(a: np.ndarray | complex, b: np.ndarray | complex) -> np.ndarray:
    """a · b."""
    return np.asarray(a.real * b.real + a.imag * b.imag)


def unit(angle: np.ndarray) -> np.ndarray:
    """e^{i angle}."""
    out = np.empty(np.shape(angle), dtype=complex)
    np.cos(angle, out=out.real)
    np.sin(angle, out=out.imag)
    return out


def turned(u: np.ndarray, angle: np.ndarray, order: int, out: np.ndarray | None = None) -> np.ndarray:
    """A derivative (n,), of order 0 ... 3, of a vector u (n,) fixed in a body whose angle is ``angle`` (4, n).

    u' = iα'u, u'' = (iα'' - α'²)u, u''' = (i(α''' - α'³) - 3α'α'')u.
    """
    if order == 0:
        return np.positive(u, out=out)
    _, a1, a2, a3 = angle
    factor = np.empty(u.size, dtype=complex)
    if order == 1:
        factor.real, factor.imag = 0.0, a1
    elif order == 2:
        np.multiply(-a1, a1, out=factor.real)
        factor.imag = a2
    else:
        np.multiply(-3.0 * a1, a2, out=factor.real)
        np.subtract(a3, a1 * a1 * a1, out=factor.imag)
    return np.multiply(factor, u, out=factor if out is None else out)


def turning(u: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """The vector itself and its three derivatives (4, n)."""
    out = np.empty((4, u.size), dtype=complex)
    block = BLOCK if u.shape == angle.shape[1:] else max(u.size, 1)
    for i in range(0, u.size, block):
        at = slice(i, i + block)
        for order in range(4):
            turned(u[at], angle[:, at], order, out[order, at])
    return out
