"""Harmonic balance as matrices: multiplying by a function of the cam angle, in cosines and sines (Kim1990 (26), (27)).

Real and symmetric where Kim1990's exponentials make a Hermitian Toeplitz matrix of twice the work. The harmonics are whole
for responses of the period of the cam (g = 0), and halves for those of twice that period (g = 1/2).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from core.frozen import frozen
from core.stability.hill.coefficients import LOAD_SLOPE, Coefficients, fourier


@frozen(eq=False)
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


@frozen(eq=False)
class _Parts:
    """An entry of a block is the sum of two coefficients, c_|i-j| and c_{i+j}, real or imaginary parts: where they stand in
    (Re c, Im c), and with which weights."""

    minus: np.ndarray
    plus: np.ndarray
    of_minus: np.ndarray
    of_plus: np.ndarray


@lru_cache(maxsize=128)
def _parts(left: Basis, right: Basis, count: int) -> _Parts:
    """For ``count`` coefficients."""
    i, j = left.numbers[:, None], right.numbers
    sine, other = (np.arange(b.numbers.size) >= b.cosines.size for b in (left, right))
    mixed = sine[:, None] != other
    half_root = np.sqrt(0.5)
    scale = np.where(i == 0.0, half_root, 1.0) * np.where(j == 0.0, half_root, 1.0)
    across = np.where(sine[:, None], np.sign(j - i), -np.sign(j - i))
    return _Parts(
        np.abs(i - j).astype(int) + count * mixed,
        (i + j).astype(int) + count * mixed,
        np.where(mixed, across, 1.0) * scale,
        np.where(sine[:, None] | other, -1.0, 1.0) * scale,
    )


def product(c: np.ndarray, left: Basis, right: Basis) -> np.ndarray:
    """Matrices (..., left, right) of multiplying by functions with Fourier coefficients c (..., order + 1).

    <cos i, f cos j> = Re(c_{i-j} + c_{i+j}), <sin i, f sin j> = Re(c_{i-j} - c_{i+j}), <cos i, f sin j> = -Im(c_{j-i} + c_{i+j}).
    """
    at = _parts(left, right, c.shape[-1])
    both = np.concatenate((c.real, c.imag), axis=-1)
    out = both.take(at.minus, axis=-1)
    out *= at.of_minus
    more = both.take(at.plus, axis=-1)
    more *= at.of_plus
    out += more
    return out


def toeplitz(c: np.ndarray, size: int) -> np.ndarray:
    """Hermitian matrix (size, size) of multiplying by a function with Fourier coefficients c (size or more,), by exponentials."""
    apart = np.arange(size)[:, None] - np.arange(size)
    return np.asarray(np.where(apart >= 0, c[np.abs(apart)], c[np.abs(apart)].conj()))


# -- Kim1990's own matrices: (27), (28) without their misprints, with harmonics -5 ... 5 whichever the period is -----

KIM_ORDER = 5  # 11 x 11


def kim_matrix(coefficients: Coefficients, q: float, half: bool) -> np.ndarray:
    """The Hermitian matrix (11, 11) whose eigenvalues are the η² at which the determinant |K| of (32) vanishes: ρ_r and G_k
    without η². For γ = jπ (half) the harmonics are r + 1/2, one more above than below."""
    r = np.arange(-KIM_ORDER, KIM_ORDER + 1) + (0.5 if half else 0.0)
    c = q * fourier(coefficients.panels, coefficients.panels.values[LOAD_SLOPE], 2 * KIM_ORDER)
    return np.diag(r * r).astype(complex) - toeplitz(c, r.size)


def kim_edges(coefficients: Coefficients, q: float, count: int = 2 * KIM_ORDER - 1) -> np.ndarray:
    """Edges (count, 2) of the tongues 1 ... count, count ≤ 11, as Kim1990 Fig. 8 has them: each pair of eigenvalues one
    tongue; nan where an eleventh value is left without a second."""
    whole, half = (np.sqrt(np.maximum(np.linalg.eigvalsh(kim_matrix(coefficients, q, g)), 0.0)) for g in (False, True))
    values = [np.append(half if n % 2 else whole, np.nan) for n in range(1, count + 1)]
    return np.array([row[n - 1 : n + 1] for n, row in enumerate(values, 1)])
