"""Elementary curves of blended motions and the rules for their succession (Yang Tables 1 and 2, Fig. 1)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, lru_cache
from itertools import groupby, pairwise
from math import pi, sqrt
from types import MappingProxyType

from core.frozen import frozen

# -- elementary curves ------------------------------------------------------------------------------------------


State = tuple[int, int]
"""Signs of velocity and acceleration at an end of a curve; a dwell is (0, 0)."""


@frozen
class BlendCurve:
    """Row of Yang's Table 1.

    Attributes
    ----------
    velocity_sign : 1 for a rise, -1 for a return
    start, end : states; a curve may follow where its start equals the end of the previous curve
    speed : factor c of the speed v = c h/β at the moving end, 0 where both ends are at rest
    peak : factor c of the largest acceleration |a| = c h/β²
    """

    velocity_sign: int
    start: State
    end: State
    speed: float
    peak: float


_H, _P = pi * pi / 4.0, 216.0 / 41.0
KAPPA = sqrt(_P)
"""Factor κ in the span κ √(h h3)/V of a return of P2 that joins H2."""

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
    """Yang's type of motion: states at the ends of the rise and of the return, each None where the motion lacks it."""

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
    """All chains of curves of a rise or a return between two states that dwell only at their ends.

    ``constant``: chains with, else without a curve of constant velocity.
    """
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
    """All sequences of a type of motion, fewest curves first.

    ``constant`` is an element of ``CONSTANT_VELOCITY``.
    """
    row = MOTION_TYPES[motion_type]
    rises = _strokes(row.rise, 1, constant in ("rise", "both"))
    backs = _strokes(row.back, -1, constant in ("return", "both"))
    return tuple(sorted((CurveSequence(r, b) for r in rises for b in backs), key=lambda s: (len(s.curves), str(s))))


# -- succession of curves ---------------------------------------------------------------------------------------


DWELL: State = (0, 0)
SIGNS = {-1: "-", 0: "0", 1: "+"}
_MOVES = {-1: "falling", 0: "at rest", 1: "rising"}
_VELOCITIES = {-1: "falling", 0: "rest", 1: "rising"}
_ACCELERATIONS = {-1: "downwards", 0: "none", 1: "upwards"}
_ACCELERATES = {-1: "with acceleration downwards", 0: "without acceleration", 1: "with acceleration upwards"}


@frozen
class CurveEnds:
    """Row of Yang's Table 1: signs of s, v, a at both ends of a curve, and the curves that may follow."""

    curve: str
    displacement: tuple[int, int]
    velocity: tuple[int, int]
    acceleration: tuple[int, int]
    usable_next: tuple[str, ...]


def state_text(state: State) -> str:
    """State in symbols: ``v +, a 0``."""
    return f"v {SIGNS[state[0]]}, a {SIGNS[state[1]]}"


def state_words(state: State) -> str:
    """State in words: ``rising without acceleration``."""
    return f"{_MOVES[state[0]]} {_ACCELERATES[state[1]]}"


def join_error(first: str, second: str) -> str:
    """Reason in words why a curve cannot follow another; empty where it may."""
    end, start = ELEMENTS[first].end, ELEMENTS[second].start
    if end[0] != start[0]:
        return f"velocity would jump from {_VELOCITIES[end[0]]} to {_VELOCITIES[start[0]]}"
    if end[1] != start[1]:
        return f"acceleration would jump from {_ACCELERATIONS[end[1]]} to {_ACCELERATIONS[start[1]]}"
    return f"a second {first} extends the same curve: increase its height and span instead" if first == second else ""


TABLE = tuple(
    CurveEnds(
        name,
        (0, 1) if row.velocity_sign > 0 else (1, 0),
        (row.start[0], row.end[0]),
        (row.start[1], row.end[1]),
        tuple(second for second in ELEMENTS if not join_error(name, second)),
    )
    for name, row in ELEMENTS.items()
)
"""Every elementary curve, in the order of Yang's Table 1."""


def states(sequence: CurveSequence) -> tuple[State, ...]:
    """States at the start, at every join and at the end of a sequence (Yang Fig. 1)."""
    return (ELEMENTS[sequence.curves[0]].start, *(ELEMENTS[name].end for name in sequence.curves))


def all_sequences(motion_type: str) -> tuple[CurveSequence, ...]:
    """All sequences of a type of motion, for every choice of constant velocity."""
    return tuple(sequence for constant in CONSTANT_VELOCITY for sequence in sequences(motion_type, constant))


def next_curves(motion_type: str, curves: tuple[str, ...]) -> tuple[str, ...]:
    """Curves that may follow the first curves of a sequence of a type of motion, in the order of the table.

    After the last curve of a motion that never dwells this is its first curve, in the next turn.
    """
    count = len(curves)
    if ELEMENTS[curves[-1]].end == ELEMENTS[curves[0]].start != DWELL and any(
        s.curves == curves for s in all_sequences(motion_type)
    ):
        return curves[:1]
    names = {
        s.curves[count] for s in all_sequences(motion_type) if s.curves[:count] == curves and len(s.curves) > count
    }
    return tuple(name for name in ELEMENTS if name in names)


def motion_type_of(sequence: str) -> tuple[str, str]:
    """Type of motion and constant velocity of a sequence such as ``C1-CV1-C2``; empty where no type has it."""
    for motion_type in MOTION_TYPES:
        for constant in CONSTANT_VELOCITY:
            if any(str(row) == sequence.upper() for row in sequences(motion_type, constant)):
                return motion_type, constant
    return "", ""


def sequence_error(sequence: str) -> str:
    """Fault of a sequence in words: an unknown curve, or two curves that do not join; empty where all join."""
    names = sequence.upper().split("-")
    for name in names:
        if name not in ELEMENTS:
            return f"{name}: unknown curve; allowed: {' | '.join(ELEMENTS)}"
    usable = {row.curve: row.usable_next for row in TABLE}
    for first, second in pairwise(names):
        if second not in usable[first]:
            return f"{second} cannot follow {first}: {join_error(first, second)}; allowed after {first}: {' | '.join(usable[first])}"
    return ""


# -- any sequence ---------------------------------------------------------------------------------------------------


@frozen
class CurveChain:
    """Curves that join, in any number; counted from 1.

    Attributes
    ----------
    is_full_turn : whether the curves cover the full turn
    """

    curves: tuple[str, ...]
    is_full_turn: bool

    def __str__(self) -> str:
        return "-".join(self.curves)

    @cached_property
    def joins(self) -> list[tuple[int, int]]:
        """Indices of the curves that meet without dwell; the last one meets the first in the next turn."""
        n = len(self.curves)
        pairs = [*pairwise(range(n)), *([(n - 1, 0)] if self.is_full_turn else [])]
        rows = [(i, k, ELEMENTS[self.curves[i]].end, ELEMENTS[self.curves[k]].start) for i, k in pairs]
        return [(i, k) for i, k, end, start in rows if end == start != DWELL]

    @cached_property
    def strokes(self) -> dict[str, tuple[int, ...]]:
        """Stroke (rise1, return1, ...) -> indices of its curves, in the order of the motion."""
        result: dict[str, tuple[int, ...]] = {}
        counts = {1: 0, -1: 0}
        for sign, run in groupby(range(len(self.curves)), key=lambda i: ELEMENTS[self.curves[i]].velocity_sign):
            counts[sign] += 1
            result[f"{'rise' if sign > 0 else 'return'}{counts[sign]}"] = tuple(run)
        return result

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all settings."""
        rows = list(enumerate((ELEMENTS[name] for name in self.curves), 1))
        return (
            *self.strokes,
            *(f"h{i}" for i, _ in rows),
            *(f"span{i}" for i, _ in rows),
            *(f"v{i}" for i, row in rows if row.speed),
            *(f"a{i}" for i, row in rows if row.peak),
            *(f"end{i}" for i, _ in rows[:-1]),
        )

    def indices_of(self, name: str) -> tuple[int, ...]:
        """Indices of the curves to which a setting belongs."""
        if name in self.strokes:
            return self.strokes[name]
        kind = name.rstrip("0123456789")
        last = int(name[len(kind) :])
        return tuple(range(last)) if kind == "end" else (last - 1,)

    @property
    def freedom(self) -> int:
        """Number of settings that determine the motion: heights and spans, minus the joins, minus the total span."""
        return 2 * len(self.curves) - len(self.joins) - 1
