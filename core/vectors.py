"""Plane vectors as complex numbers, and points that turn."""

from __future__ import annotations

import numpy as np


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


def turning(u: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """A vector u (n,) fixed in a body whose angle is ``angle`` (4, n): itself and its three derivatives (4, n).

    u' = iα'u, u'' = (iα'' - α'²)u, u''' = (i(α''' - α'³) - 3α'α'')u.
    """
    _, a1, a2, a3 = angle
    out = np.empty((4, u.size), dtype=complex)
    out[0] = u
    square = a1 * a1
    factor = np.empty((3, u.size), dtype=complex)
    factor.real[0] = 0.0
    factor.imag[0] = a1
    np.negative(square, out=factor.real[1])
    factor.imag[1] = a2
    np.multiply(-3.0 * a1, a2, out=factor.real[2])
    np.subtract(a3, a1 * square, out=factor.imag[2])
    np.multiply(factor, u, out=out[1:])
    return out
