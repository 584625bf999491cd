"""Kim1990's own matrices, as printed: (27), (28) with harmonics -5 ... 5 whichever the period is, no more and no less."""

from __future__ import annotations

import numpy as np

from core.stability.coefficients import LOAD_SLOPE, Coefficients
from core.stability.fourier import fourier

ORDER = 5  # 11 x 11


def matrix(coefficients: Coefficients, q: float, half: bool) -> np.ndarray:
    """The Hermitian matrix (11, 11) whose eigenvalues are the η² at which the determinant |K| of (32) vanishes: ρ_r and G_k
    without η². For γ = jπ (half) the harmonics are r + 1/2, one more above than below."""
    r = np.arange(-ORDER, ORDER + 1) + (0.5 if half else 0.0)
    c = q * fourier(coefficients.panels, coefficients.panels.values[LOAD_SLOPE], 2 * ORDER)
    apart = np.arange(r.size)[:, None] - np.arange(r.size)
    toeplitz = np.where(apart >= 0, c[np.abs(apart)], c[np.abs(apart)].conj())
    return np.diag(r * r).astype(complex) - toeplitz


def edges(coefficients: Coefficients, q: float, count: int = 2 * ORDER - 1) -> np.ndarray:
    """Edges (count, 2) of the tongues 1 ... count, count ≤ 11, as Kim1990 Fig. 8 has them: each pair of eigenvalues one
    tongue; nan where an eleventh value is left without a second."""
    whole, half = (np.sqrt(np.maximum(np.linalg.eigvalsh(matrix(coefficients, q, g)), 0.0)) for g in (False, True))
    values = [np.append(half if n % 2 else whole, np.nan) for n in range(1, count + 1)]
    return np.array([row[n - 1 : n + 1] for n, row in enumerate(values, 1)])
