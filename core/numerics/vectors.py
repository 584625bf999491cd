"""Plane vectors as complex numbers, and points that turn."""

from __future__ import annotations

from typing import Protocol

import numpy as np


class Rows(Protocol):
    """A quantity's derivatives by order."""

    def __getitem__(self, order: int, /) -> np.ndarray: ...


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


def by_real(factor: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Real times complex (n,): half the work of numpy's product, which makes the real factor complex first."""
    out = np.empty(np.broadcast_shapes(factor.shape, u.shape), dtype=complex)
    np.multiply(factor, u.real, out=out.real)
    np.multiply(factor, u.imag, out=out.imag)
    return out


def turned(u: np.ndarray, angle: Rows, order: int) -> np.ndarray:
    """A derivative (n,), of order 0 ... 3, of a vector u (n,) fixed in a body whose angle has the derivatives ``angle[1]``
    ..., (n,) or (1,).

    u' = iα'u, u'' = (iα'' - α'²)u, u''' = (i(α''' - α'³) - 3α'α'')u.
    """
    if order == 0:
        return u
    a1 = angle[1]
    if order == 1:
        if a1.size == 1:
            return u * (1j * a1)
        out = np.empty(a1.size, dtype=complex)
        np.multiply(u.real, a1, out=out.imag)
        np.multiply(u.imag, -a1, out=out.real)
        return out
    factor = np.empty(max(angle[k].size for k in range(1, order + 1)), dtype=complex)
    if order == 2:
        np.multiply(-a1, a1, out=factor.real)
        factor.imag = angle[2]
    else:
        np.multiply(-3.0 * a1, angle[2], out=factor.real)
        np.subtract(angle[3], a1 * a1 * a1, out=factor.imag)
    return np.multiply(factor, u, out=factor) if factor.size >= u.size else factor * u
