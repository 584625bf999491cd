"""The elementary curves as the blending sees them, and which may follow which (Yang Tables 1 and 2, Fig. 1)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from math import pi, sqrt
from types import MappingProxyType

from core.frozen import frozen

State = tuple[int, int]
"""Signs of velocity and acceleration at an end of a curve; a dwell is (0, 0)."""


@frozen
class BlendCurve:
    """One row of Yang's Table 1.

    velocity_sign  1 rise, -1 return
    start, end     states; a curve may follow where its start is the state reached
    speed          c of v = c h/β at its moving end, 0 where it has none
    peak           c of the largest |a| = c h/β²
    """

    velocity_sign: int
    start: State
    end: State
    speed: float
    peak: float


_H, _P = pi * pi / 4.0, 216.0 / 41.0
KAPPA = sqrt(_P)
"""κ: a return of P2 that joins H2 takes κ √(h h3)/V."""

ELEMENTS: Mapping[str, BlendCurve] = MappingProxyType(
    {
        "C1": BlendCurve(1, (0, 0), (1, 0), 2.0, pi),
        "C2": BlendCurve(1, (1, 0), (0, 0), 2.0, pi),
        "C3": BlendCurve(-1, (0, 0), (-1, 0), 2.0, pi),
        "C4": BlendCurve(-1, (-1, 0), (0, 0), 2.0, pi),
        "C5": BlendCurve(1, (0, 0), (0, 0), 0.0, 2.0 * pi),
        "C6": BlendCurve(-1, (0, 0), (0, 0), 0.0, 2.0 * pi),
        "H1": BlendCurve(1, (0, 1), (1, 0), pi / 2.0, _H),
        "H2": BlendCurve(1, (1, 0), (0, -1), pi / 2.0, _H),
        "H3": BlendCurve(-1, (0, -1), (-1, 0), pi / 2.0, _H),
        "H4": BlendCurve(-1, (-1, 0), (0, 1), pi / 2.0, _H),
        "H5": BlendCurve(1, (0, 1), (0, -1), 0.0, 2.0 * _H),
        "H6": BlendCurve(-1, (0, -1), (0, 1), 0.0, 2.0 * _H),
        "P1": BlendCurve(1, (0, 0), (0, -1), 0.0, _P),
        "P2": BlendCurve(-1, (0, -1), (0, 0), 0.0, _P),
        "CV1": BlendCurve(1, (1, 0), (1, 0), 1.0, 0.0),
        "CV2": BlendCurve(-1, (-1, 0), (-1, 0), 1.0, 0.0),
    }
)
CONSTANT = ("CV1", "CV2")


@frozen
class MotionType:
    """One of Yang's motions by the states it passes: rise from ``bottom`` to ``top``, return to ``after``; a motion
    without one of them has None there."""

    label: str
    rise: tuple[State, State] | None
    back: tuple[State, State] | None


MOTION_TYPES: Mapping[str, MotionType] = MappingProxyType(
    {
        "DRD": MotionType("Dwell - rise - dwell", ((0, 0), (0, 0)), None),
        "DRD-return": MotionType("Dwell - return - dwell", None, ((0, 0), (0, 0))),
        "DRRD": MotionType("Dwell - rise - return - dwell", ((0, 0), (0, -1)), ((0, -1), (0, 0))),
        "RRR": MotionType("Rise - return - rise", ((0, 1), (0, -1)), ((0, -1), (0, 1))),
    }
)
CONSTANT_VELOCITY = ("none", "rise", "return", "both")


@frozen
class CurveSequence:
    """Curves of the rise and of the return, either empty where the motion has none."""

    rise: tuple[str, ...]
    back: tuple[str, ...]

    @property
    def curves(self) -> tuple[str, ...]:
        """Names of the curves of rise and return, in the order of the motion."""
        return self.rise + self.back

    def __str__(self) -> str:
        return "-".join(self.curves)


def _strokes(ends: tuple[State, State] | None, velocity_sign: int, constant: bool) -> list[tuple[str, ...]]:
    """All chains of curves of a rise or a return between two states that dwell only at their ends: with a curve of
    constant velocity, or without one."""
    if ends is None:
        return [] if constant else [()]
    result: list[tuple[str, ...]] = []
    open_chains: list[tuple[tuple[str, ...], State]] = [((), ends[0])]
    while open_chains:
        chain, state = open_chains.pop()
        for name, row in ELEMENTS.items():
            if row.velocity_sign != velocity_sign or row.start != state or name in chain:
                continue
            if row.end == ends[1]:
                result.append((*chain, name))
            elif row.end[0] != 0:
                open_chains.append(((*chain, name), row.end))
    return sorted((c for c in result if any(n in CONSTANT for n in c) == constant), key=lambda c: (len(c), c))


@lru_cache(maxsize=32)
def sequences(motion_type: str, constant: str = "none") -> tuple[CurveSequence, ...]:
    """Every sequence the tables admit for a type of motion, fewest curves first; constant: one of
    ``CONSTANT_VELOCITY``."""
    row = MOTION_TYPES[motion_type]
    rises = _strokes(row.rise, 1, constant in ("rise", "both"))
    backs = _strokes(row.back, -1, constant in ("return", "both"))
    return tuple(sorted((CurveSequence(r, b) for r in rises for b in backs), key=lambda s: (len(s.curves), str(s))))
