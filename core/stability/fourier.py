"""Fourier coefficients of functions given on panels, to any order: the polynomial of each panel is integrated exactly.

c_k = (1/2π) ∫ f e^{-ikθ} dθ. On a panel of half width h around θ0 a Legendre polynomial gives
∫ P_l e^{-ikθ} dθ = 2h (-i)^l j_l(kh) e^{-ikθ0}, j_l the spherical Bessel function: no rule to be fine enough for k
(Filon's idea), and jumps at the ends of panels cost nothing.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from core.motion import TURN
from core.stability.panels import NODES, Panels, to_legendre

MOST_KEPT = 2_000_000  # entries of a matrix that is kept, 32 MB
BLOCK = 64  # panels that are worked on at once where there are so many that none is kept


def _weights(start: np.ndarray, width: np.ndarray, highest: int) -> np.ndarray:
    """Of panels with starts and widths (m,): (highest + 1, m NODES)."""
    from scipy.special import spherical_jn

    k = np.arange(highest + 1)
    half = 0.5 * width
    degree = np.arange(NODES)
    # panels come in few widths
    widths, at = np.unique(half, return_inverse=True)
    bessel = spherical_jn(degree[:, None, None], k[:, None] * widths)  # (l, k, widths)
    turned = bessel * ((-1j) ** degree)[:, None, None]
    by_node = np.tensordot(turned, to_legendre(NODES), (0, 0))  # (k, widths, node)
    shift = np.exp(-1j * k[:, None] * (start + half)) * (2.0 * half / TURN)
    return np.ascontiguousarray((by_node[:, at] * shift[..., None]).reshape(k.size, -1))


@lru_cache(maxsize=16)
def _kept(panels: Panels, highest: int) -> np.ndarray:
    return _weights(panels.start, panels.width, highest)


def fourier(panels: Panels, values: np.ndarray, highest: int) -> np.ndarray:
    """c_0 ... c_highest (..., highest + 1) of functions given at the nodes (..., m, NODES); c_-k is the conjugate.

    Exact for the panel's polynomials: what these leave of the function stands in ``truncation``. The matrix is kept for the
    next row of a chart, where it is not larger than ``MOST_KEPT``.
    """
    enough = 64
    while enough < highest:
        enough *= 2
    if (enough + 1) * panels.count * NODES <= MOST_KEPT:
        flat = values.reshape(*values.shape[:-2], -1)
        return flat @ _kept(panels, enough)[: highest + 1].T
    out = np.zeros((*values.shape[:-2], highest + 1), dtype=complex)
    for first in range(0, panels.count, BLOCK):
        some = slice(first, first + BLOCK)
        flat = values[..., some, :].reshape(*values.shape[:-2], -1)
        out += flat @ _weights(panels.start[some], panels.width[some], highest).T
    return out


def truncation(panels: Panels, values: np.ndarray) -> np.ndarray:
    """What the panels' polynomials leave of functions (..., m, NODES), as the mean of |last Legendre coefficients|: no
    Fourier coefficient is wrong by more."""
    last = np.abs(values @ to_legendre(NODES)[-2:].T).sum(axis=-1)
    return last @ panels.width / TURN
