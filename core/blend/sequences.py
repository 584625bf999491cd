"""The elementary curves as the blending sees them, and which may follow which (Yang Tables 1 and 2, Fig. 1)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise
from math import pi, sqrt
from types import MappingProxyType

from core.frozen import frozen

# -- the elementary curves as the blending sees them, and which may follow which (Yang Tables 1 and -------------


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


# -- which curve may follow which, and why another may not ------------------------------------------------------


DWELL: State = (0, 0)
SIGNS = {-1: "-", 0: "0", 1: "+"}
_MOVES = {-1: "falling", 0: "at rest", 1: "rising"}
_VELOCITIES = {-1: "falling", 0: "rest", 1: "rising"}
_ACCELERATIONS = {-1: "downwards", 0: "none", 1: "upwards"}
_ACCELERATES = {-1: "with acceleration downwards", 0: "without acceleration", 1: "with acceleration upwards"}


@frozen
class CurveEnds:
    """A row of Yang's Table 1: signs of displacement, velocity and acceleration at start and end of a curve, and what may
    follow it."""

    curve: str
    displacement: tuple[int, int]
    velocity: tuple[int, int]
    acceleration: tuple[int, int]
    usable_next: tuple[str, ...]


def state_text(state: State) -> str:
    """``v +, a 0``."""
    return f"v {SIGNS[state[0]]}, a {SIGNS[state[1]]}"


def state_words(state: State) -> str:
    """``rising without acceleration``."""
    return f"{_MOVES[state[0]]} {_ACCELERATES[state[1]]}"


def join_error(first: str, second: str) -> str:
    """Why a curve cannot follow another, in a sentence; empty where it may."""
    end, start = ELEMENTS[first].end, ELEMENTS[second].start
    if end[0] != start[0]:
        return f"velocity would jump from {_VELOCITIES[end[0]]} to {_VELOCITIES[start[0]]}"
    if end[1] != start[1]:
        return f"acceleration would jump from {_ACCELERATIONS[end[1]]} to {_ACCELERATIONS[start[1]]}"
    return f"{first} once more is the same curve: give it more height and span" if first == second else ""


TABLE = tuple(
    CurveEnds(
        name,
        (0, 1) if row.velocity_sign > 0 else (1, 0),
        (row.start[0], row.end[0]),
        (row.start[1], row.end[1]),
        tuple(other for other in ELEMENTS if not join_error(name, other)),
    )
    for name, row in ELEMENTS.items()
)
"""Every elementary curve, in the order of Yang's Table 1."""


def states(sequence: CurveSequence) -> tuple[State, ...]:
    """The state at each place of a sequence (Yang Fig. 1): where it starts, where curves meet, where it ends."""
    return (ELEMENTS[sequence.curves[0]].start, *(ELEMENTS[name].end for name in sequence.curves))


def all_sequences(motion_type: str) -> tuple[CurveSequence, ...]:
    """Of a type of motion, without a constant velocity and with one in any stroke."""
    return tuple(each for constant in CONSTANT_VELOCITY for each in sequences(motion_type, constant))


def next_curves(motion_type: str, curves: tuple[str, ...]) -> tuple[str, ...]:
    """What follows these first curves in any sequence of a type of motion, in the order of the table; after the last curve of
    one that never dwells its first, in the next turn."""
    count = len(curves)
    if ELEMENTS[curves[-1]].end == ELEMENTS[curves[0]].start != DWELL and any(
        s.curves == curves for s in all_sequences(motion_type)
    ):
        return curves[:1]
    found = {
        s.curves[count] for s in all_sequences(motion_type) if s.curves[:count] == curves and len(s.curves) > count
    }
    return tuple(name for name in ELEMENTS if name in found)


def motion_type_of(sequence: str) -> tuple[str, str]:
    """The type of motion and the constant velocity of a sequence such as ``C1-CV1-C2``; empty where no type has it."""
    for motion_type in MOTION_TYPES:
        for constant in CONSTANT_VELOCITY:
            if any(str(each) == sequence.upper() for each in sequences(motion_type, constant)):
                return motion_type, constant
    return "", ""


def sequence_error(sequence: str) -> str:
    """What is wrong with a sequence of curves, in words: a curve that is none of the table, or two that do not join; empty where all
    join."""
    names = sequence.upper().split("-")
    for name in names:
        if name not in ELEMENTS:
            return f"{name}: unknown curve; allowed: {' | '.join(ELEMENTS)}"
    usable = {row.curve: row.usable_next for row in TABLE}
    for one, other in pairwise(names):
        if other not in usable[one]:
            return (
                f"{other} cannot follow {one}: {join_error(one, other)}; allowed after {one}: {' | '.join(usable[one])}"
            )
    return ""
