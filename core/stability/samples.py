"""Samples of a wind-up within the steps of the integrator, and the integrals of its size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.motion import TURN
from core.stability.contact import Contact
from core.stability.integrator import OUTSIDE, STAGES, Step
from core.stability.nonlinear import Equation
from core.stability.panels import powers

SAMPLES = np.linspace(0.0, 1.0, 25)  # parts of a step
BISECTIONS = 30  # of a cell between two samples; the integral changes with the square of what is left

_POWERS = powers(2.0 * SAMPLES - 1.0, STAGES + 2).T


@dataclass(frozen=True, eq=False)
class StepSamples:
    """The wind-up at k places of each of n steps, at a step's ends from inside it.

    y             (n, k) turns of the input
    beta          (n, k) β [turns]
    rate          (n, k) β'
    acceleration  (n, k) θ̈/ω² = -β''/2π of the cam
    theta         (n, k) cam angle within its turn [rad]; at a join it may lie beyond it by rounding
    inward        (n, k) [rad] a little towards the middle of the motion's piece: the side of a join that holds here
    """

    y: np.ndarray
    beta: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    theta: np.ndarray
    inward: np.ndarray

    @staticmethod
    def of(equation: Equation, steps: Step, part: np.ndarray) -> StepSamples:
        """At parts (n or 1, k) of the steps, 0 ... 1."""
        x = steps.within(part)
        y = steps.y[:, None] + steps.h[:, None] * part
        theta = TURN * (y - x[..., 0] - steps.turn[:, None])
        middle = 0.5 * (equation.begins + equation.ends)[steps.piece]
        rate, second = equation.velocities(steps.trajectory, steps.piece, steps.turn, y, x)
        return StepSamples(y, x[..., 0], rate, second / -TURN, theta, OUTSIDE * np.sign(middle[:, None] - theta))

    def moves(self, contact: Contact) -> np.ndarray:
        """Where (n, k) the follower moves."""
        return np.asarray(contact.moves[contact.panels.index(self.theta + self.inward)])

    def force(self, contact: Contact, eta: float) -> np.ndarray:
        """Contact force (n, k) as a multiple of M X''m ω²."""
        rows = contact.panels.at(self.theta.ravel(), 3, self.inward.ravel()).reshape(3, *self.theta.shape)
        return contact.force(rows, eta, 1.0 - self.rate, self.acceleration)


def size_integrals(steps: Step) -> tuple[np.ndarray, np.ndarray]:
    """∫ |β| dy and ∫ |β'| dy (n,) over steps (n,), of the polynomials of β through the nodes."""
    beta = steps.powers[:, 0]
    order = np.arange(1, beta.shape[1] + 1)
    primitive = np.pad(beta / order, ((0, 0), (1, 0)))
    by_part = beta[:, 1:] * order[:-1]
    return 0.5 * steps.h * _absolute(beta, primitive), _absolute(by_part, beta)


def _absolute(f: np.ndarray, primitive: np.ndarray) -> np.ndarray:
    """∫ |f| dt (n,) over t = -1 ... 1 of polynomials (n, K), powers of t, with their primitives (n, K + 1).

    Between two samples f changes its sign once at most; the place is found by bisection.
    """
    values, area = f @ _POWERS[: f.shape[1]], primitive @ _POWERS[: primitive.shape[1]]
    total = np.abs(np.diff(area))
    i, j = np.nonzero(values[:, :-1] * values[:, 1:] < 0.0)
    low, high, negative = 2.0 * SAMPLES[j] - 1.0, 2.0 * SAMPLES[j + 1] - 1.0, values[i, j] < 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        before = (_values(f[i], middle) < 0.0) == negative
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    top = _values(primitive[i], 0.5 * (low + high))
    total[i, j] = np.abs(top - area[i, j]) + np.abs(area[i, j + 1] - top)
    return np.asarray(total.sum(axis=1))


def _values(f: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Values (m,) of polynomials (m, K) at t (m,)."""
    return np.einsum("mk,mk->m", f, powers(t, f.shape[1]))
