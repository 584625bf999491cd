"""core.stability.monodromy of a shaft whose train weighs nothing: one turn in closed form, slow or fast, to all digits."""

from typing import Any

import numpy as np
import pytest
from references import EPS, MP, off
from shafts import KIM, coefficients

from core.stability import monodromy


def turned(eta: float, damping: float) -> tuple[list[list[Any]], list[list[Any]]]:
    """The matrix of ζ'' + 4πζ_d η ζ' + 4π²η² ζ = 0 over one turn, and its derivative by η."""

    def entry(i: int, j: int, n: Any) -> Any:
        a, omega = 2 * MP.pi * damping * n, 2 * MP.pi * n * MP.sqrt(1 - MP.mpf(damping) ** 2)
        c, s = MP.cos(omega), MP.sin(omega) / omega
        return MP.exp(-a) * [[c + a * s, s], [-((2 * MP.pi * n) ** 2) * s, c - a * s]][i][j]

    n, step = MP.mpf(eta), MP.mpf(eta) * MP.mpf(10) ** -15
    rows = [[(entry(i, j, n), (entry(i, j, n + step) - entry(i, j, n - step)) / (2 * step)) for j in (0, 1)] for i in (0, 1)]
    return [[told[0] for told in row] for row in rows], [[told[1] for told in row] for row in rows]


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_a_bare_shaft_turns_as_in_closed_form_at_any_speed(damping: float) -> None:
    """A turn of 2πη radians passes on so many roundings of each number, through panels at rest and others; the derivative
    of sin(x)/x is the difference of two numbers that are x² times nearer to each other."""
    etas = (1e-4, 2e-3, 0.03, 0.77, 6.1, 60.3)
    found = [monodromy(coefficients(KIM), np.array([eta]), np.array([0.0]), damping=damping) for eta in etas]
    for eta, told in zip(etas, found, strict=True):
        angle = 2.0 * np.pi * eta
        rows = turned(eta, damping)
        for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
            unit = angle ** (i - j)  # ζ counts 2πη-fold
            value, slope = rows[0][i][j], rows[1][i][j]
            size = 2.0 * np.pi * unit if angle > 1.0 else 0.0
            assert off(told.matrix[0, i, j], value) <= 8.0 * EPS * (1.0 + angle) * (unit + abs(value)), (eta, i, j)
            assert off(told.slope[0, i, j], slope) <= 8.0 * EPS * (1.0 + angle + angle**-2) * (size + abs(slope)), (eta, i, j)
