"""The linear equations whose stability is asked, one row each: what they make of the coefficients.

All are ζ'' + (η² w + p) 4π² ζ = 0, a dot-less ' by y = θ_i/2π, before damping.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from core.stability.coefficients import CENTRIPETAL, INERTIA, LOAD_SLOPE, Coefficients


@dataclass(frozen=True)
class Equation:
    """``whole``: D and C are kept; else D → 1 and C is dropped, which is not consistent to first order in Q."""

    slug: str
    label: str
    whole: bool
    source: str


EXACT, APPROXIMATE = "exact_21", "approx_22"

EQUATIONS: Mapping[str, Equation] = MappingProxyType(
    {
        EXACT: Equation(
            EXACT,
            "Hill form (21), exact",
            True,
            "Kim1990 (21)",
        ),
        APPROXIMATE: Equation(
            APPROXIMATE,
            "Kim1990 (22), approximate",
            False,
            "Kim1990 (22), with X''X for its X''X''",
        ),
    }
)


def inertia_and_pull(
    coefficients: Coefficients, equation: str, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """D, Q C and Q ψ (rows, m, NODES) for Q (rows,); with a fixed spring Q ψ is still to be multiplied by η²."""
    rows = coefficients.panels.values
    q = np.asarray(q, dtype=float)[:, None, None]
    pull = q * rows[LOAD_SLOPE]
    if not EQUATIONS[equation].whole:
        return np.ones_like(pull), np.zeros_like(pull), pull
    return 1.0 + q * rows[INERTIA], q * rows[CENTRIPETAL], pull


def weight_and_potential(coefficients: Coefficients, equation: str, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """w and p (rows, m, NODES) of ζ'' + 4π²(η² w + p) ζ = 0, ζ = √D β.

    (21): w = 1/D, p = Qψ/D + (QC/D)²; a fixed spring, whose ψ = η² ψ1: w = (1 + Qψ1)/D, p = (QC/D)².
    """
    d, c, pull = inertia_and_pull(coefficients, equation, q)
    speed = (c / d) ** 2
    if coefficients.fixed:
        return (1.0 + pull) / d, speed
    return 1.0 / d, pull / d + speed
