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


@lru_cache(maxsize=16)
def _weights(panels: Panels, highest: int) -> np.ndarray:
    from scipy.special import spherical_jn

    k = np.arange(highest + 1)
    half = 0.5 * panels.width
    degree = np.arange(NODES)
    # panels come in few widths
    widths, at = np.unique(half, return_inverse=True)
    bessel = spherical_jn(degree[:, None, None], k[:, None] * widths)  # (l, k, widths)
    turned = bessel * ((-1j) ** degree)[:, None, None]
    by_node = np.tensordot(turned, to_legendre(NODES), (0, 0))  # (k, widths, node)
    shift = np.exp(-1j * k[:, None] * (panels.start + half)) * (2.0 * half / TURN)
    return np.ascontiguousarray((by_node[:, at] * shift[..., None]).reshape(k.size, -1))


def weights(panels: Panels, highest: int) -> np.ndarray:
    """Matrix (highest + 1, m NODES) that takes values at the nodes to c_0 ... c_highest."""
    enough = 64
    while enough < highest:
        enough *= 2
    return _weights(panels, enough)[: highest + 1]


def fourier(panels: Panels, values: np.ndarray, highest: int) -> np.ndarray:
    """c_0 ... c_highest (..., highest + 1) of functions given at the nodes (..., m, NODES); c_-k is the conjugate.

    Exact for the panel's polynomials: what these leave of the function stands in ``truncation``.
    """
    flat = values.reshape(*values.shape[:-2], -1)
    return flat @ weights(panels, highest).T


def truncation(panels: Panels, values: np.ndarray) -> np.ndarray:
    """What the panels' polynomials leave of functions (..., m, NODES), as the mean of |last Legendre coefficients|: no
    Fourier coefficient is wrong by more."""
    last = np.abs(values @ to_legendre(NODES)[-2:].T).sum(axis=-1)
    return last @ panels.width / TURN
