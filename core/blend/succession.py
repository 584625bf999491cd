"""Which curve may follow which, and why another may not: Yang's Table 1 as a table, and the states of Fig. 1 along a sequence."""

from __future__ import annotations

from itertools import pairwise

from core.blend.sequences import CONSTANT_VELOCITY, ELEMENTS, MOTION_TYPES, CurveSequence, State, sequences
from core.frozen import frozen

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


def why_not(first: str, second: str) -> str:
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
        tuple(other for other in ELEMENTS if not why_not(name, other)),
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


def next_in(motion_type: str, curves: tuple[str, ...]) -> tuple[str, ...]:
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


def type_of(sequence: str) -> tuple[str, str]:
    """The type of motion and the constant velocity of a sequence such as ``C1-CV1-C2``; empty where no type has it."""
    for motion_type in MOTION_TYPES:
        for constant in CONSTANT_VELOCITY:
            if any(str(each) == sequence.upper() for each in sequences(motion_type, constant)):
                return motion_type, constant
    return "", ""


def broken_at(sequence: str) -> str:
    """What is wrong with a sequence of curves, in words: a curve that is none of the table, or two that do not join; empty where all
    join."""
    names = sequence.upper().split("-")
    for name in names:
        if name not in ELEMENTS:
            return f"{name}: unknown curve; allowed: {' | '.join(ELEMENTS)}"
    usable = {row.curve: row.usable_next for row in TABLE}
    for one, other in pairwise(names):
        if other not in usable[one]:
            return f"{other} cannot follow {one}: {why_not(one, other)}; allowed after {one}: {' | '.join(usable[one])}"
    return ""
