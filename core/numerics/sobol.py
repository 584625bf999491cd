"""Scrambled Sobol sequence, the points of ``scipy.stats.qmc.Sobol`` without the import of ``scipy.stats``, which takes a second.

Sources: Joe and Kuo (2008), Constructing Sobol sequences with better two-dimensional projections; Matoušek (1998), On the
L2-discrepancy for anchored boxes, for the scrambling.
"""

from __future__ import annotations

from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

BITS = 30
DIRECTIONS = "_sobol_direction_numbers.npz"
"""File of scipy: primitive polynomials and first direction numbers of Joe and Kuo, for 21,201 dimensions."""


def sobol(dimensions: int, seed: int, start: int, count: int) -> np.ndarray:
    """Points of a scrambled Sobol sequence.

    Parameters
    ----------
    dimensions : int
        Number d of dimensions.
    seed : int
        Seed of the scrambling.
    start, count : int
        Number of the first point, and how many follow.

    Returns
    -------
    ndarray (count, d), dimensionless
        From 0 to 1.

    References
    ----------
    Joe and Kuo (2008), Constructing Sobol sequences with better two-dimensional projections; directions as in scipy.
    """
    shift, directions = _scrambled(dimensions, seed)
    number = np.arange(start, start + count)
    gray = number ^ (number >> 1)
    points = np.tile(shift, (count, 1))
    for bit in range(int(gray.max(initial=0)).bit_length()):
        points ^= np.where(((gray >> bit) & 1)[:, None] == 1, directions[:, bit], 0)
    return points / 2.0**BITS


@lru_cache(maxsize=16)
def _scrambled(dimensions: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random shift (d,), and direction numbers (d, BITS) multiplied by random lower triangular matrices of bits."""
    (rng,) = np.random.default_rng(seed).spawn(1)  # as scipy does
    shift = rng.integers(2, size=(dimensions, BITS), dtype=np.uint32).astype(int) @ (1 << np.arange(BITS))
    matrix = np.tril(rng.integers(2, size=(dimensions, BITS, BITS), dtype=np.uint32)).astype(int)
    matrix[:, np.arange(BITS), np.arange(BITS)] = 1
    weights = 1 << np.arange(BITS)[::-1]  # of the bits, the highest first
    bits = (_directions(dimensions)[:, None, :] // weights[:, None]) & 1
    return shift, np.einsum("dpj,p->dj", (matrix @ bits) & 1, weights)


def _directions(dimensions: int) -> np.ndarray:
    """Direction numbers (d, BITS), by the recurrence of the primitive polynomial of every dimension."""
    scipy = find_spec("scipy")
    assert scipy is not None
    assert scipy.origin is not None
    with np.load(Path(scipy.origin).parent / "stats" / DIRECTIONS) as file:
        polynomials, first = (file[name][:dimensions].tolist() for name in ("poly", "vinit"))
    result = np.ones((dimensions, BITS), dtype=int)
    for row, polynomial, numbers in zip(result[1:], polynomials[1:], first[1:], strict=True):
        degree = polynomial.bit_length() - 1
        row[:degree] = numbers[:degree]
        for j in range(degree, BITS):
            row[j] = row[j - degree]
            for k in range(degree):
                if (polynomial >> (degree - 1 - k)) & 1:
                    row[j] ^= row[j - k - 1] << (k + 1)
    return result << np.arange(BITS)[::-1]
