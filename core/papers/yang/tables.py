"""The numbers of Yang's tables of elementary curves: signs at their ends, and which curve fits where."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from core.blend import ELEMENTS, MOTION_TYPES
from core.laws import LAWS
from core.papers.examples import Examples

PRINTED = {
    "C1": ("0+", "0+", "00", "C2 H2 CV1"), "C2": ("0+", "+0", "00", "C1 C3 C5 C6 P1"), "C3": ("+0", "0-", "00", "C4 H4 CV2"),
    "C4": ("+0", "-0", "00", "C1 C3 C5 C6 P1"), "C5": ("0+", "00", "00", "C1 C3 C6 P1"), "C6": ("+0", "00", "00", "C1 C3 C5 P1"),
    "H1": ("0+", "0+", "+0", "C2 H2 CV1"), "H2": ("0+", "+0", "0-", "H3 H6 P2"), "H3": ("+0", "0-", "-0", "C4 H4 CV2"),
    "H4": ("+0", "-0", "0+", "H1 H5"), "H5": ("0+", "00", "+-", "H3 H6 P2"), "H6": ("+0", "00", "-+", "H1 H5"),
    "P1": ("0+", "00", "0-", "H3 H6 P2"), "P2": ("+0", "00", "-0", "C1 C3 C5 C6 P1"), "CV1": ("0+", "++", "00", "C2 H2"),
    "CV2": ("0-", "--", "00", "C4 H4"),
}  # fmt: skip
"""Table 1 as printed: signs of displacement, velocity and acceleration at start and end, usable next."""

PLACES = (
    ("DRD", "first of the rise", 1, "00", "+"), ("DRD", "last of the rise", 1, "+", "00"), ("DRD", "whole rise", 1, "00", "00"),
    ("DRD", "whole return", -1, "00", "00"), ("DRD", "first of the return", -1, "00", "-"), ("DRD", "last of the return", -1, "-", "00"),
    ("DRRD", "first of the rise", 1, "00", "+"), ("DRRD", "last of the rise", 1, "+", "0-"), ("DRRD", "whole rise", 1, "00", "0-"),
    ("DRRD", "whole return", -1, "0-", "00"), ("DRRD", "first of the return", -1, "0-", "-"), ("DRRD", "last of the return", -1, "-", "00"),
    ("RRR", "first of the rise", 1, "0+", "+"), ("RRR", "last of the rise", 1, "+", "0-"), ("RRR", "whole rise", 1, "0+", "0-"),
    ("RRR", "whole return", -1, "0-", "0+"), ("RRR", "first of the return", -1, "0-", "-"), ("RRR", "last of the return", -1, "-", "0+"),
)  # fmt: skip
"""Motion, place, way, and at its two ends: velocity where it moves, else velocity 0 and the sign of the acceleration."""
PRINTED_PLACES = (
    "C1",
    "C2",
    "C5",
    "C6",
    "C3",
    "C4",
    "C1",
    "H2",
    "P1",
    "P2",
    "H3",
    "C4",
    "H1",
    "H2",
    "H5",
    "H6",
    "H3",
    "H4",
)
"""Table 2 as printed, place by place."""
ENDS = np.array([0.0, 1.0])
ROUNDING = 1e-9

Numbers = Mapping[str, Any]


def _sign(value: float) -> str:
    return "0" if abs(value) < ROUNDING else "+" if value > 0.0 else "-"


def signs(curve: str) -> tuple[str, str, str]:
    """Of displacement above the lowest level, velocity and acceleration, at start and end, from the curve's own formula."""
    law = LAWS[curve.lower()]
    s, v, a = (law.rises * law(ENDS)[k] for k in range(3))
    s = s - s.min()
    first, second, third = ("".join(_sign(float(value)) for value in row) for row in (s, v, a))
    return first, second, third


def states(curve: str) -> tuple[str, str]:
    """Velocity and acceleration at the start, and at the end."""
    _, v, a = signs(curve)
    return v[0] + a[0], v[1] + a[1]


def usable_next(curve: str) -> str:
    """Every other curve that starts in the state in which this one ends."""
    end = states(curve)[1]
    return " ".join(name for name in PRINTED if name != curve and states(name)[0] == end)


def _state_of(*ends: tuple[int, int]) -> tuple[str, ...]:
    """Signs as numbers, as the blending has them, as they are printed."""
    return tuple("".join("-0+"[sign + 1] for sign in end) for end in ends)


def table_1(examples: Examples) -> Numbers:
    found = {name: (*signs(name), usable_next(name)) for name in PRINTED}
    blending = all(_state_of(row.start, row.end) == states(name) for name, row in ELEMENTS.items())
    return {"found": found, "blending": blending}


def as_table_1(found: Mapping[str, tuple[str, str, str, str]], blending: bool) -> tuple[str, str]:
    """Velocities, accelerations and usable curves against the print."""

    def same(name: str) -> bool:
        here, printed = found[name], PRINTED[name]
        return here[1:3] == printed[1:3] and set(here[3].split()) == set(printed[3].split())

    apart = [name for name in PRINTED if not same(name)]
    words = f"of {len(PRINTED)} curves {len(PRINTED) - len(apart)} have these signs at their ends and these successors, by their formulas"
    if apart:
        words += f"; not {', '.join(apart)}"
    return ("agrees" if blending and not apart else "differs"), words


def returning(examples: Examples) -> Numbers:
    """CV2's displacement, printed 0, -, among returns that are all printed +, 0: how many signs are not those of its formula."""
    here = signs("CV2")[0]
    return {
        "printed": float(sum(a != b for a, b in zip(PRINTED["CV2"][0], here, strict=True))),
        "corrected": float(sum(a != b for a, b in zip(PRINTED["C3"][0], here, strict=True))),
        "bound": 0.0,
        "here": here,
    }


def _fits(curve: str, way: int, start: str, end: str) -> bool:
    if curve.startswith("CV") or LAWS[curve.lower()].rises != way:
        return False
    reached = tuple(state if state[0] == "0" else state[0] for state in states(curve))
    return reached == (start, end)


def fitting() -> tuple[tuple[str, ...], ...]:
    """The curves that fit each of ``PLACES``."""
    return tuple(tuple(name for name in PRINTED if _fits(name, *place[2:])) for place in PLACES)


def table_2(examples: Examples) -> Numbers:
    return {"found": fitting()}


def as_table_2(found: tuple[tuple[str, ...], ...]) -> tuple[str, str]:
    rows = zip(PLACES, found, PRINTED_PLACES, strict=True)
    apart = [
        f"{place[0]}, {place[1]}: {', '.join(curves) or 'none'}"
        for place, curves, printed in rows
        if curves != (printed,)
    ]
    words = f"at {len(found) - len(apart)} of {len(found)} places exactly the printed curve fits"
    return ("differs" if apart else "agrees"), words + (f"; {'; '.join(apart)}" if apart else "")


def first_place(examples: Examples) -> Numbers:
    """Fig. 1, PQ: the first curve of a DRD rise."""
    (v, a), _ = MOTION_TYPES["DRD"].rise or ((0, 0), (0, 0))
    return {"curves": fitting()[0], "start": (v, a)}


def only_c1(curves: tuple[str, ...], start: tuple[int, int]) -> tuple[str, str]:
    words = f"from velocity {start[0]} and acceleration {start[1]}, ending at speed, there is {' or '.join(curves) or 'no curve'}"
    return ("agrees" if curves == ("C1",) and start == (0, 0) else "differs"), words
