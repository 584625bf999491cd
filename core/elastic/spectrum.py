"""The response spectrum of an elastic follower: how it vibrates at many speeds of the shaft."""

from __future__ import annotations

import numpy as np

from core.elastic.equivalent import Equivalent
from core.elastic.pieces import Oscillator
from core.elastic.response import Dwell, ProgramTurn, dwells, oscillators
from core.frozen import frozen
from core.motion import Program
from core.numerics.cancellation import checkpoint

STEP = np.deg2rad(0.5)  # widest distance of the angles at which the largest values are taken
AT_ONCE = 50  # speeds


@frozen(eq=False)
class Spectrum:
    """At speeds omega (m,) [rad/s], from rest and steady (see ``ResidualVibration``), the latter infinite where there is none; SI by time.

    residual      (2, d, m) amplitude of z - s at the start of each dwell
    error         (2, m) largest |z - s| over the turn, and ``acceleration`` (2, m) largest |z''|: of angles 0.5° apart at the most;
                  both empty, (2, 0), where they were not asked for
    """

    omega: np.ndarray
    dwells: tuple[Dwell, ...]
    residual: np.ndarray
    error: np.ndarray
    acceleration: np.ndarray


def spectrum(one: Equivalent, program: Program, omega: np.ndarray, largest: bool = True) -> Spectrum:
    """At speeds (m,) > 0 [rad/s]; largest: with the largest values over the turn. Raises Cancelled where it is no longer wanted."""
    turn, parts = ProgramTurn(program, STEP if largest else None), []
    for first in range(0, omega.size, AT_ONCE):
        checkpoint()
        parts.append(_at(one, turn, omega[first : first + AT_ONCE], largest))
    residual, error, acceleration = (np.concatenate(rows, axis=-1) for rows in zip(*parts, strict=True))
    return Spectrum(omega, dwells(program), residual, error, acceleration)


@np.errstate(invalid="ignore")
def _at(
    one: Equivalent, turn: ProgramTurn, omega: np.ndarray, largest: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    oscillator = oscillators(one, omega)
    states = turn.states(oscillator)
    width = oscillator.root.imag[:, 0]
    residual = np.array([np.abs(rows).T / width for rows in (states.in_dwells_from_rest, states.in_dwells)])
    error, acceleration = np.zeros((2, 0)), np.zeros((2, 0))
    if largest:
        both = (_largest(one, turn, oscillator, rows, omega) for rows in (states.from_rest, states.steady))
        error, acceleration = (np.array(rows) for rows in zip(*both, strict=True))
    return _finite(residual), _finite(error), _finite(acceleration)


def _largest(
    one: Equivalent, turn: ProgramTurn, oscillator: Oscillator, states: np.ndarray, omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """|z - s| and |z''| (m,) of the states (m, n)."""
    e, speed = oscillator.errors(states)
    natural = (one.natural / omega[:, None]) ** 2
    z2 = -(2.0 * oscillator.decay * (turn.pieces.at_start(1) + speed) + oscillator.closing * turn.places + natural * e)
    return np.abs(e).max(axis=1), np.abs(z2).max(axis=1) * omega**2


def _finite(values: np.ndarray) -> np.ndarray:
    """Infinite where there is no number."""
    return np.where(np.isnan(values), np.inf, values)
