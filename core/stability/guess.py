"""A flexible shaft to begin with, where nothing is known of it yet."""

from __future__ import annotations

from core.design import Elastic
from core.dynamics import Loading
from core.stability.coefficients import inertia
from core.train import Train

USUAL_Q, USUAL_ETA = 0.05, 10.0


def first_guess(train: Train, loading: Loading, omega: float) -> Elastic | None:
    """A shaft at Q = 0.05 and η = 10, both usual: I_c = max J / Q, K_s = I_c (η ω)²; rounded to three digits, for it is a
    guess. None where nothing is moved. omega [rad/s]."""
    largest = float(inertia(train, loading)[0].max(initial=0.0))
    if largest <= 0.0:
        return None
    own = largest / USUAL_Q
    return Elastic(float(f"{own:.3g}"), float(f"{own * (USUAL_ETA * omega) ** 2:.3g}"))
