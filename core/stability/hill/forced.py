"""The linear forced response: the harmonics of the wind-up that repeats with every turn, by harmonic balance.

Kim1990 (27) with γ = 0, [K]{A} = {P}/2π: K_rs = η² δ_rs + Q ψ_(r-s) - r D_(r-s) s + Q κ_(r-s) + 2iζη r δ_rs, P = Q (C + U). As
the paper has it, of (22), D = 1 and κ = 0; its load φ, (23), keeps C.
"""

from __future__ import annotations

import numpy as np

from core.stability.hill.coefficients import CENTRIPETAL, EXACT, LOAD, Coefficients, fourier, inertia_and_pull
from core.stability.hill.matrices import toeplitz

ORDER = 96  # least number of harmonics that are balanced


def forced_response(
    coefficients: Coefficients, eta: float, q: float, damping: float = 0.0, equation: str = EXACT, highest: int = 24
) -> np.ndarray:
    """Fourier coefficients c_0 ... c_highest (highest + 1,) of β [turns] by the angle of the input, those of -k conjugate; nan where
    η stands on the edge of a tongue, so that there is none.

    κ = C' has a delta function where C jumps: its coefficients are ik times those of C.
    """
    order = max(ORDER, 4 * highest)
    load = eta * eta if coefficients.fixed else 1.0
    inertia, pull, slope = inertia_and_pull(coefficients, equation, np.array([q]))
    rows = coefficients.panels.values
    push = q * (rows[CENTRIPETAL] + load * rows[LOAD])
    d, c, psi, right = fourier(coefficients.panels, np.concatenate((inertia, pull, slope, push[None])), 2 * order)
    r = np.arange(-order, order + 1)
    turning = load * psi + 1j * np.arange(c.size) * c
    matrix = toeplitz(turning, r.size) - r[:, None] * toeplitz(d, r.size) * r
    matrix += np.diag(eta * eta + 2j * damping * eta * r)
    right = right[: order + 1]
    try:
        found = np.linalg.solve(matrix, np.concatenate((right[:0:-1].conj(), right)) / (2.0 * np.pi))
    except np.linalg.LinAlgError:
        return np.full(highest + 1, np.nan + 0j)
    return np.asarray(found[order : order + highest + 1])
