"""core.stability to the last digits: one turn of a shaft whose mechanism weighs nothing in closed form, slow or fast; derivatives
of the wind-up through jumps; the contact force; samples."""

from typing import Any

import numpy as np
import pytest
from references import EPS, MP, off
from shafts import HARD, KIM, coefficients, of, push

from core.stability import history, monodromy
from core.stability.integrator import Integrator
from core.stability.windup import History


def turned(eta: float, damping: float) -> tuple[list[list[Any]], list[list[Any]]]:
    """The matrix of ζ'' + 4πζ_d η ζ' + 4π²η² ζ = 0 over one turn, and its derivative by η."""

    def entry(i: int, j: int, n: Any) -> Any:
        a, omega = 2 * MP.pi * damping * n, 2 * MP.pi * n * MP.sqrt(1 - MP.mpf(damping) ** 2)
        c, s = MP.cos(omega), MP.sin(omega) / omega
        return MP.exp(-a) * [[c + a * s, s], [-((2 * MP.pi * n) ** 2) * s, c - a * s]][i][j]

    n, step = MP.mpf(eta), MP.mpf(eta) * MP.mpf(10) ** -15
    rows = [
        [(entry(i, j, n), (entry(i, j, n + step) - entry(i, j, n - step)) / (2 * step)) for j in (0, 1)] for i in (0, 1)
    ]
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
            assert off(told.slope[0, i, j], slope) <= 8.0 * EPS * (1.0 + angle + angle**-2) * (size + abs(slope)), (
                eta,
                i,
                j,
            )


# -- the nonlinear wind-up --------------------------------------------------------------------------------

TAU = 2.0 * np.pi


def state(gone: History, y: float) -> np.ndarray:
    """(β, Π) of a history at y."""
    beta, rate = (float(each[0]) for each in gone.at(np.array([y])))
    d = gone.coefficients.panels.at(np.array([np.mod(TAU * (y - beta), TAU)]), 1)[0, 0]
    return np.array([beta, (1.0 + gone.q * d) * (1.0 - rate)])


@pytest.mark.parametrize("name", ["parabolic", "high dwell"])
def test_derivatives_through_jumps_of_the_inertia_keep_eleven_digits(name: str) -> None:
    """Against differences of sixth order of histories, which pass joins exactly."""
    found, eta, q, step, y = coefficients(HARD[name]), 1.7, 0.2, 3e-4, 1.3
    start = np.array([0.01, 1.03])
    change = Integrator(found, eta, q).run(start, 0.0, y, change=True).change
    assert change is not None

    def end(shift: np.ndarray) -> np.ndarray:
        beta, momentum = start + shift
        return state(history(found, eta, q, 0.0, y, (beta, momentum)), y)

    for column in (0, 1):
        unit = np.eye(2)[column] * step
        rows = [weight * (end(k * unit) - end(-k * unit)) for k, weight in ((1, 45.0), (2, -9.0), (3, 1.0))]
        by_difference = sum(rows) / (60.0 * step)
        assert np.abs(by_difference - change[0, :, column]).max() < 3e-12 * np.abs(change[0]).max()


def test_the_contact_force_keeps_its_digits() -> None:
    """M Ẍ + K_v X from what the history tells, by the plain formulas of Kim's cam and (13)."""
    eta, q = 2.0, 0.05
    gone = history(coefficients(KIM), eta, q, 0.0, 3.0, contact=of(KIM).contact)
    y = np.linspace(0.05, 2.95, 60)
    beta, rate = gone.at(y)
    theta = np.mod(TAU * (y - beta), TAU)
    moving = (theta > 0.1) & (theta < 3.0)
    theta, beta, rate = theta[moving], beta[moving], rate[moving]
    acceleration = np.array([push(eta, q, 0.0, *each) for each in zip(theta, beta, rate, strict=True)]) / -TAU
    x, x1, x2 = (1.0 - np.cos(2.0 * theta)) / 2.0, np.sin(2.0 * theta), 2.0 * np.cos(2.0 * theta)
    force = (x2 * (1.0 - rate) ** 2 + x1 * acceleration) / 2.0 + 1.5 * x  # X''m = 2, X_m = 1
    along = np.cos(np.arctan2(9.0 * x1, 40.0 + 9.0 * x))
    assert np.abs(gone.force(y[moving]) * along - force).max() < 1e-13 * np.abs(force).max()


def test_the_samples_of_a_history_are_its_values_and_satisfy_13() -> None:
    """Where the cam goes forward and back; θ̈/ω² = -β''/2π by the plain formulas of Kim's cam and (13)."""
    eta, q = 0.9, 0.2
    gone = history(coefficients(KIM), eta, q, 0.01, 2.9)
    seen = gone.samples
    assert (seen.rate > 1.0).any()
    assert seen.y[-1, -1] == pytest.approx(2.9, abs=1e-13)
    inside = seen.y[:, 1:-1].ravel()
    for told, which in zip(gone.at(inside), (seen.beta, seen.rate), strict=True):
        assert np.abs(which[:, 1:-1].ravel() - told).max() < 1e-13
    beta, rate = gone.at(inside)
    theta = np.mod(TAU * (inside - beta), TAU)
    bend = [push(eta, q, 0.01, t if t < np.pi else np.nan, b, r) for t, b, r in zip(theta, beta, rate, strict=True)]
    away = np.abs(np.mod(theta + 1.0, np.pi) - 1.0) > 1e-6
    assert np.abs(-TAU * seen.acceleration[:, 1:-1].ravel() - bend)[away].max() < 1e-12 * np.abs(bend).max()
