"""The response spectrum of an elastic follower: how it vibrates at many speeds of the shaft."""

from __future__ import annotations

import numpy as np

from core.elastic.equivalent import Equivalent
from core.elastic.response import Dwell, States, Turn, dwells, oscillators
from core.frozen import frozen
from core.motion import Program
from core.numerics.cancellation import checkpoint

STEP = np.deg2rad(0.5)  # widest distance of the angles at which the largest values are taken
AT_ONCE = 25  # speeds


@frozen(eq=False)
class Spectrum:
    """At speeds omega (m,) [rad/s], from rest and steady (see ``Residual``), the latter infinite where there is none; SI by time.

    residual      (2, d, m) amplitude of z - s at the start of each dwell
    error         (2, m) largest |z - s| over the turn, and ``acceleration`` (2, m) largest |z''|: of angles 0.5° apart at the most
    """

    omega: np.ndarray
    dwells: tuple[Dwell, ...]
    residual: np.ndarray
    error: np.ndarray
    acceleration: np.ndarray


def spectrum(one: Equivalent, program: Program, omega: np.ndarray) -> Spectrum:
    """At speeds (m,) > 0 [rad/s]. Raises Cancelled where it is no longer wanted."""
    turn, parts = Turn(program, STEP), []
    for first in range(0, omega.size, AT_ONCE):
        checkpoint()
        parts.append(_at(one, turn, omega[first : first + AT_ONCE]))
    residual, error, acceleration = (np.concatenate(rows, axis=-1) for rows in zip(*parts, strict=True))
    return Spectrum(omega, dwells(program), residual, error, acceleration)


@np.errstate(invalid="ignore")
def _at(one: Equivalent, turn: Turn, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    oscillator = oscillators(one, omega)
    states: States = turn.states(oscillator)
    width = oscillator.root.imag
    residual = np.array([np.abs(rows).T / width[:, 0] for rows in (states.in_dwells_from_rest, states.in_dwells)])
    natural = (one.natural / omega[:, None]) ** 2
    error, acceleration = [], []
    for rows in (states.from_rest, states.steady):
        e, speed = oscillator.errors(rows)
        z2 = -(2.0 * oscillator.decay * (turn.pieces.at_start(1) + speed) + oscillator.closing * turn.places + natural * e)
        error.append(np.abs(e).max(axis=1))
        acceleration.append(np.abs(z2).max(axis=1) * omega**2)
    return tuple(np.where(np.isnan(part), np.inf, part) for part in (residual, np.array(error), np.array(acceleration)))  # type: ignore[return-value]
