"""A flexible shaft to begin with, where nothing is known of it yet."""

from __future__ import annotations

from dataclasses import fields

from core.design import Design, Elastic, with_assumed, with_elastic
from core.dynamics import Loading
from core.errors import NoStability
from core.mechanism.kinematics import Kinematics

USUAL_Q, USUAL_ETA = 0.05, 10.25  # between two tongues, which stand at halves


def first_guess(kinematics: Kinematics, loading: Loading, omega: float) -> Elastic | None:
    """A shaft at Q = 0.05 and η = 10.25, both usual: I_c = max J / Q, K_s = I_c (η ω)²; rounded to three digits, for it is a
    guess. None where nothing is moved. omega [rad/s]."""
    largest = float(loading.inertia(kinematics)[0].max(initial=0.0))
    if largest <= 0.0:
        return None
    own = largest / USUAL_Q
    return Elastic(float(f"{own:.3g}"), float(f"{own * (USUAL_ETA * omega) ** 2:.3g}"))


def flexible(design: Design, kinematics: Kinematics, loading: Loading, omega: float) -> Design:
    """The design with a first guess of its shaft's elasticity, marked as assumed; omega [rad/s]. Raises NoStability where
    nothing is moved."""
    guess = first_guess(kinematics, loading, omega)
    if guess is None:
        raise NoStability("nothing is moved that could twist the shaft", "loads", "give masses")
    design = with_elastic(design, guess)
    for field in fields(guess)[:2]:  # inertia and stiffness; the rest is no figure of the machine
        design = with_assumed(design, f"shaft.{field.name}", True)
    return design
