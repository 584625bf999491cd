"""How fast a turn is played: parts and multiples of the shaft's own speed."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import pi

LEAST_TURN, LONGEST_TURN = 0.5, 120.0  # seconds per turn that are offered
CALM, PATIENT = 2.0, 12.0  # a turn in true time that takes so many seconds is played so
USUAL_TURN = 4.0  # else about so many


@dataclass(frozen=True)
class Speed:
    """Part of the shaft's own speed, and what a turn takes then [s]."""

    part: Fraction
    seconds: float


@lru_cache(maxsize=8)
def speeds(omega: float) -> tuple[Speed, ...]:
    """The speeds offered for a shaft that turns at omega [rad/s] either way, the slowest first; true time is always among them."""
    steps = [Fraction(m) * Fraction(10) ** e for e in range(-8, 5) for m in (1, 2, 5)]
    true_turn = 2.0 * pi / abs(omega)
    offered = [Speed(part, true_turn / float(part)) for part in steps]
    return tuple(s for s in offered if LEAST_TURN <= s.seconds <= LONGEST_TURN or s.part == 1)


def usual(omega: float) -> Speed:
    """The speed to begin with: true time where it can be watched, else what comes near a few seconds."""
    rows = speeds(omega)
    true = next(s for s in rows if s.part == 1)
    if CALM <= true.seconds <= PATIENT:
        return true
    return min(rows, key=lambda s: max(s.seconds / USUAL_TURN, USUAL_TURN / s.seconds))
