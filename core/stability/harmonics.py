"""Harmonic balance as matrices: multiplying by a function of the cam angle, in cosines and sines (Kim1990 (26), (27)).

Real and symmetric where Kim1990's exponentials make a Hermitian Toeplitz matrix of twice the work. The harmonics are whole
for responses of the period of the cam (g = 0), and halves for those of twice that period (g = 1/2).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np


@dataclass(frozen=True, eq=False)
class Basis:
    """Harmonics from ``first`` to ``last``: cos(number θ) of the numbers ``cosines``, then sin of ``sines``; orthonormal
    in the mean over a turn, or two where the numbers are halves."""

    cosines: np.ndarray
    sines: np.ndarray

    @property
    def numbers(self) -> np.ndarray:
        """(n,) of all of them."""
        return np.concatenate((self.cosines, self.sines))


@lru_cache(maxsize=128)
def basis(first: int, last: int, half: bool) -> Basis:
    """Harmonics above ``first`` (-1: the constant too) up to ``last``; halves: first + 1/2 ... last - 1/2."""
    if half:
        numbers = np.arange(max(first, 0), last) + 0.5
        return Basis(numbers, numbers)
    numbers = np.arange(first + 1, last + 1).astype(float)
    return Basis(numbers, numbers[numbers > 0.0])


@dataclass(frozen=True, eq=False)
class _Indices:
    """Where the coefficients of a block stand: c_{i+j}, c_{|i-j|} and the signs of the latter."""

    plus: np.ndarray
    minus: np.ndarray
    sign: np.ndarray
    scale: np.ndarray


@lru_cache(maxsize=128)
def _indices(left: Basis, right: Basis) -> _Indices:
    i, j = left.numbers[:, None], right.numbers
    half_root = np.sqrt(0.5)
    scale = np.where(left.numbers == 0.0, half_root, 1.0)[:, None] * np.where(right.numbers == 0.0, half_root, 1.0)
    return _Indices((i + j).astype(int), np.abs(i - j).astype(int), np.sign(j - i), scale)


def product(c: np.ndarray, left: Basis, right: Basis) -> np.ndarray:
    """Matrices (rows, left, right) of multiplying by functions with Fourier coefficients c (rows, order + 1).

    <cos i, f cos j> = Re(c_{i-j} + c_{i+j}), <sin i, f sin j> = Re(c_{i-j} - c_{i+j}), <cos i, f sin j> = -Im(c_{j-i} + c_{i+j}).
    """
    at = _indices(left, right)
    a, b = left.cosines.size, right.cosines.size
    even, odd = c.real, c.imag
    out = even[:, at.minus]
    out[:, :a, :b] += even[:, at.plus[:a, :b]]
    out[:, a:, b:] -= even[:, at.plus[a:, b:]]
    out[:, :a, b:] = -odd[:, at.plus[:a, b:]] - at.sign[:a, b:] * odd[:, at.minus[:a, b:]]
    out[:, a:, :b] = -odd[:, at.plus[a:, :b]] + at.sign[a:, :b] * odd[:, at.minus[a:, :b]]
    out *= at.scale
    return out


def slope(numbers: Basis) -> np.ndarray:
    """Matrix (n, n) of d/dθ: cos iθ -> -i sin iθ, sin iθ -> i cos iθ."""
    a = numbers.cosines.size
    out = np.zeros((numbers.numbers.size, numbers.numbers.size))
    for j, n in enumerate(numbers.sines):
        i = int(np.flatnonzero(numbers.cosines == n)[0])
        out[a + j, i], out[i, a + j] = -n, n
    return out
