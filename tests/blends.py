"""Blended motions written from Yang's equations alone: heights first, speeds and spans from them, and what can be
measured on the result. No formula of ``core`` stands here."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, isclose, pi, sin, sqrt

KAPPA = sqrt(216.0 / 41.0)
A = pi / 2.0 - 1.0

# Yang's Table 1, column "usable next", with C5's way out completed as its states say; rows of constant velocity too.
NEXT = {
    "C1": "C2 H2 CV1", "C2": "C1 C3 C5 C6 P1", "C3": "C4 H4 CV2", "C4": "C1 C3 C5 C6 P1", "C5": "C1 C3 C6 P1",
    "C6": "C1 C3 C5 P1", "H1": "C2 H2 CV1", "H2": "H3 H6 P2", "H3": "C4 H4 CV2", "H4": "H1 H5", "H5": "H3 H6 P2",
    "H6": "H1 H5", "P1": "H3 H6 P2", "P2": "C1 C3 C5 C6 P1", "CV1": "C2 H2", "CV2": "C4 H4",
}  # fmt: skip


def _p1(u: float) -> tuple[float, float, float]:
    powers = {3: 250, 5: -852, 6: 1096, 7: -558, 8: 105}
    return (
        sum(c * u**k for k, c in powers.items()) / 41,
        sum(c * k * u ** (k - 1) for k, c in powers.items()) / 41,
        sum(c * k * (k - 1) * u ** (k - 2) for k, c in powers.items()) / 41,
    )


def _backwards(f):
    return lambda u: (f(1 - u)[0], -f(1 - u)[1], f(1 - u)[2])


def _turned(f):
    return lambda u: (1 - f(u)[0], -f(u)[1], -f(u)[2])


RISING = {
    "C1": lambda u: (u - sin(pi * u) / pi, 1 - cos(pi * u), pi * sin(pi * u)),
    "C2": lambda u: (u + sin(pi * u) / pi, 1 + cos(pi * u), -pi * sin(pi * u)),
    "C5": lambda u: (u - sin(2 * pi * u) / (2 * pi), 1 - cos(2 * pi * u), 2 * pi * sin(2 * pi * u)),
    "H1": lambda u: (1 - cos(pi * u / 2), pi / 2 * sin(pi * u / 2), pi**2 / 4 * cos(pi * u / 2)),
    "H2": lambda u: (sin(pi * u / 2), pi / 2 * cos(pi * u / 2), -(pi**2) / 4 * sin(pi * u / 2)),
    "H5": lambda u: ((1 - cos(pi * u)) / 2, pi / 2 * sin(pi * u), pi**2 / 2 * cos(pi * u)),
    "P1": _p1,
    "CV1": lambda u: (u, 1.0, 0.0),
}
CURVES = {
    **RISING,
    "P2": _backwards(_p1),
    **{f"{k[0]}{n}": _turned(RISING[k]) for k, n in
       {"C1": 3, "C2": 4, "C5": 6, "H1": 3, "H2": 4, "H5": 6}.items()},
    "CV2": _turned(RISING["CV1"]),
}  # fmt: skip
"""Displacement, velocity and acceleration for unit height and span: returns fall from 1 to 0."""
SPEEDS = {"C": 2.0, "H": pi / 2.0}
PEAKS = {"C1": pi, "C5": 2 * pi, "H1": pi**2 / 4, "H5": pi**2 / 2, "P1": 216 / 41}
_LIKE = {"C2": "C1", "C3": "C1", "C4": "C1", "C6": "C5", "H2": "H1", "H3": "H1", "H4": "H1", "H6": "H5", "P2": "P1"}

SEQUENCES = {
    ("DRD", "none"): ["C5", "C1-C2"],
    ("DRD", "rise"): ["C1-CV1-C2"],
    ("DRD-return", "none"): ["C6", "C3-C4"],
    ("DRD-return", "return"): ["C3-CV2-C4"],
    ("DRRD", "none"): ["P1-P2", "C1-H2-P2", "P1-H3-C4", "C1-H2-H3-C4"],
    ("DRRD", "rise"): ["C1-CV1-H2-P2", "C1-CV1-H2-H3-C4"],
    ("DRRD", "return"): ["P1-H3-CV2-C4", "C1-H2-H3-CV2-C4"],
    ("DRRD", "both"): ["C1-CV1-H2-H3-CV2-C4"],
    ("RRR", "none"): ["H5-H6", "H1-H2-H6", "H5-H3-H4", "H1-H2-H3-H4"],
    ("RRR", "rise"): ["H1-CV1-H2-H6", "H1-CV1-H2-H3-H4"],
    ("RRR", "return"): ["H5-H3-CV2-H4", "H1-H2-H3-CV2-H4"],
    ("RRR", "both"): ["H1-CV1-H2-H3-CV2-H4"],
}
# physics.md §2; the mirrored six-curve ones have two
FREEDOM = {
    "C5": 0, "C6": 0, "P1-P2": 0, "H5-H6": 0, "C1-C2": 1, "C3-C4": 1, "C1-CV1-C2": 2, "C3-CV2-C4": 2,
    "C1-H2-P2": 1, "P1-H3-C4": 1, "C1-CV1-H2-P2": 2, "P1-H3-CV2-C4": 2, "C1-H2-H3-C4": 2, "C1-CV1-H2-H3-C4": 3,
    "C1-H2-H3-CV2-C4": 3, "C1-CV1-H2-H3-CV2-C4": 4, "H1-H2-H6": 0, "H5-H3-H4": 0, "H1-H2-H3-H4": 1,
    "H1-CV1-H2-H6": 1, "H5-H3-CV2-H4": 1, "H1-CV1-H2-H3-H4": 2, "H1-H2-H3-CV2-H4": 2, "H1-CV1-H2-H3-CV2-H4": 3,
}  # fmt: skip


@dataclass(frozen=True)
class Motion:
    """Curves with heights (magnitudes) and spans, from angle ``start``."""

    curves: tuple[str, ...]
    heights: tuple[float, ...]
    spans: tuple[float, ...]
    start: float = 0.0

    @property
    def rises(self) -> tuple[bool, ...]:
        return tuple(c in ("C1", "C2", "C5", "H1", "H2", "H5", "P1", "CV1") for c in self.curves)

    @property
    def stroke(self) -> float:
        return sum(h for h, up in zip(self.heights, self.rises, strict=True) if up)

    @property
    def return_stroke(self) -> float:
        return sum(h for h, up in zip(self.heights, self.rises, strict=True) if not up)

    def at(self, i: int, u: float) -> tuple[float, float, float]:
        """Displacement from the curve's own foot, velocity and acceleration on the i-th curve."""
        s, v, a = CURVES[self.curves[i]](u)
        h, b = self.heights[i], self.spans[i]
        return h * s, h * v / b, h * a / b**2

    def level(self, angle: float) -> float:
        """Displacement above the lowest level."""
        levels = [0.0]
        for h, up in zip(self.heights, self.rises, strict=True):
            levels.append(levels[-1] + (h if up else -h))
        begin = self.start
        for i, (span, up) in enumerate(zip(self.spans, self.rises, strict=True)):
            if angle <= begin + span:
                foot = levels[i] if up else levels[i + 1]
                return foot - min(levels) + self.at(i, (angle - begin) / span)[0]
            begin += span
        raise ValueError(angle)

    def settings(self) -> dict[str, float]:
        """All that can be asked of it."""
        told = {"acceleration": self.acceleration}
        ups = [i for i, up in enumerate(self.rises) if up]
        downs = [i for i, up in enumerate(self.rises) if not up]
        for rows, names in ((ups, ("h1", "h2", "h3")), (downs, ("h4", "h5", "h6"))):
            if len(rows) < 2:
                continue
            names = names if len(rows) == 3 else names[::2]
            told.update({n: self.heights[i] for n, i in zip(names, rows, strict=True)})
            first = rows[0]
            told["vcv" if rows is ups else "vcv2"] = abs(self.at(first, 1.0)[1])
            if len(rows) == 3:
                told["length2" if "length" in told else "length"] = self.spans[rows[1]]
        if ups and downs:
            told["peak"] = self.start + sum(self.spans[i] for i in ups)
        return told

    @property
    def acceleration(self) -> float:
        rows = zip(self.curves, self.heights, self.spans, strict=True)
        return max(PEAKS[_LIKE.get(c, c)] * h / b**2 for c, h, b in rows if not c.startswith("CV"))


def _shares(chance: random.Random, n: int, total: float) -> list[float]:
    """n numbers above 0 of that sum."""
    parts = [chance.uniform(0.05, 1.0) ** 2 for _ in range(n)]
    return [total * p / sum(parts) for p in parts]


def free_motion(
    sequence: str, chance: random.Random, stroke: float, back: float, start: float, span: float, mirrored: bool = False
) -> Motion:
    """A motion of that sequence, all that is free drawn by chance."""
    curves = tuple(sequence.split("-"))
    if (curves[0] in ("C3", "P1", "H5") and len(curves) > 2) or curves == ("C3", "C4"):
        swap = {"C3": "C2", "C4": "C1", "CV2": "CV1", "P1": "P2", "H3": "H2", "H4": "H1", "H5": "H6"}
        other = free_motion("-".join(swap[c] for c in reversed(curves)), chance, back, stroke, start, span)
        return Motion(curves, other.heights[::-1], other.spans[::-1], start)
    ups = [c for c in curves if c in ("C1", "C2", "C5", "H1", "H2", "H5", "P1", "CV1")]
    downs = curves[len(ups) :]
    if len(curves) == 1:
        return Motion(curves, (stroke if ups else back,), (span,), start)
    if len(ups) == 1:
        first = span * sqrt(stroke) / (sqrt(stroke) + sqrt(back))
        return Motion(curves, (stroke, back), (first, span - first), start)
    if downs in (("H6",),):
        if len(ups) == 3:
            middle = stroke * chance.uniform(0.05, 0.95)
            rise = [(stroke - middle) / 2, middle, (stroke - middle) / 2]
        else:
            rise = [stroke / 2, stroke / 2]
    else:
        rise = _shares(chance, len(ups), stroke)
    rise_work = sum(_work(c, h) for c, h in zip(ups, rise, strict=True))
    if not downs:
        speed = rise_work / span
        return Motion(curves, tuple(rise), tuple(_work(c, h) / speed for c, h in zip(ups, rise, strict=True)), start)
    if len(downs) == 1:
        factor = KAPPA if downs == ("P2",) else pi / sqrt(2.0)
        last = factor * sqrt(back * rise[-1])
        speed = (rise_work + last) / span
        spans = [_work(c, h) / speed for c, h in zip(ups, rise, strict=True)]
        return Motion(curves, (*rise, back), (*spans, last / speed), start)
    fall, ratio = _fall(downs, rise, chance, back, mirrored)
    fall_work = sum(_work(c, h) for c, h in zip(downs, fall, strict=True))
    speed = (rise_work + fall_work / ratio) / span
    spans = [_work(c, h) / speed for c, h in zip(ups, rise, strict=True)]
    spans += [_work(c, h) / (speed * ratio) for c, h in zip(downs, fall, strict=True)]
    return Motion(curves, (*rise, *fall), tuple(spans), start)


def _work(curve: str, height: float) -> float:
    return SPEEDS.get(curve[0] if not curve.startswith("CV") else "", 1.0) * height


def _fall(
    downs: Sequence[str], rise: list[float], chance: random.Random, back: float, mirrored: bool
) -> tuple[list[float], float]:
    """Heights of a return of several curves whose acceleration at the top, and that of H4 at the bottom, is the rise's."""
    if mirrored:
        return rise[::-1], 1.0
    h1, h3 = rise[0], rise[-1]
    if downs[-1] == "H4":
        r2 = back / (h1 + h3) * (1.0 if len(downs) == 2 else chance.uniform(0.05, 0.95))
        rest = back - r2 * (h1 + h3)
        return ([r2 * h3, r2 * h1] if len(downs) == 2 else [r2 * h3, rest, r2 * h1]), sqrt(r2)
    r2 = back / h3 * chance.uniform(0.03, 0.97)
    return [r2 * h3, *_shares(chance, len(downs) - 1, back - r2 * h3)], sqrt(r2)


def check_joins(motion: Motion, harmonic: bool) -> None:
    """v and a the same on both sides of every join to 1e-12 of their largest; a motion that never dwells joins round the
    turn in acceleration too."""
    n = len(motion.curves)
    rows = [(motion.at(i, 0.0), motion.at(i, 1.0)) for i in range(n)]
    largest = [max(abs(motion.at(i, u / 16)[k]) for i in range(n) for u in range(17)) for k in (1, 2)]
    ends = list(range(n - 1)) if not harmonic else list(range(n))
    for i in ends:
        for k, size in zip((1, 2), largest, strict=True):
            assert abs(rows[i][1][k] - rows[(i + 1) % n][0][k]) <= 1e-12 * size, (i, k, motion)
    if not harmonic:
        for k, size in zip((1, 2), largest, strict=True):
            assert abs(rows[0][0][k]) <= 1e-12 * size
            assert abs(rows[-1][1][k]) <= 1e-12 * size
    for a, b in zip(motion.curves, motion.curves[1:], strict=False):
        assert b in NEXT[a].split()


def same(a: float, b: float, bound: float) -> bool:
    return isclose(a, b, rel_tol=bound, abs_tol=0.0)
