"""One sequence of curves as a family of solutions: from its free numbers to every height, span and speed, in closed form.

Only the joining laws are used here: equal speeds and accelerations at the joins, the stroke, the total span. What the
designer asks for on top is the business of the solver.

Symbols: h, g strokes of rise and return; h1, h2, h3 the curves before, of and after the constant velocity of the rise,
h4, h5, h6 those of the return (time mirror of h3, h2, h1); V, V2 the speeds of rise and return; r = V2/V.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import Any

import numpy as np

from core.blend.curves import CONSTANT, ELEMENTS, KAPPA, Sequence

Values = Any
"""A number or an array (n,) of them: the equations are the same."""


@dataclass(frozen=True)
class Task:
    """Strokes of rise and return [mm or deg] and the total span [deg]; 0 for a stroke the motion lacks."""

    rise: float
    back: float
    span: float


@dataclass(frozen=True)
class Solution:
    """heights (all positive magnitudes) and spans [deg] curve by curve, in the order of the sequence; speeds of rise
    and return [per deg], 0 where the motion has none."""

    sequence: Sequence
    heights: tuple[float, ...]
    spans: tuple[float, ...]
    speed: float
    back_speed: float

    @property
    def peak_span(self) -> float:
        """Span of the rise [deg]."""
        return sum(self.spans[: len(self.sequence.rise)])

    @property
    def peak_acceleration(self) -> float:
        """Largest |acceleration| [per deg²]."""
        parts = zip(self.sequence.curves, self.heights, self.spans, strict=True)
        rows = ((ELEMENTS[name].peak, h, b) for name, h, b in parts)
        return max(c * h / (b * b) if b * b else inf for c, h, b in rows if c)


@dataclass(frozen=True)
class Family:
    """A sequence whose rise is made of several curves, or that has no free number at all.

    mirrored: the return is the rise run backwards.
    """

    sequence: Sequence
    mirrored: bool = False

    @property
    def has_constant_rise(self) -> bool:
        """True where the rise has a stretch of constant velocity."""
        return self._rise_cv

    @property
    def positive(self) -> tuple[str, ...]:
        """Heights that must be above 0."""
        if len(self.sequence.rise) == 1:
            return ()
        return ("h1", "h3", *(("h4", "h6") if len(self.sequence.back) > 1 else ()))

    @property
    def constant(self) -> tuple[str, ...]:
        """Heights of constant velocity, which may be 0."""
        return (*(("h2",) if self._rise_cv else ()), *(("h5",) if self._back_cv else ()))

    def rise_work(self, found: Mapping[str, Values]) -> Values:
        """Span of the rise times its speed."""
        rise = self.sequence.rise
        return ELEMENTS_SPAN[rise[0]] * found["h1"] + found["h2"] + ELEMENTS_SPAN[rise[-1]] * found["h3"]

    @property
    def _rise_cv(self) -> bool:
        return any(name in CONSTANT for name in self.sequence.rise)

    @property
    def _back_cv(self) -> bool:
        return any(name in CONSTANT for name in self.sequence.back)

    @property
    def _single_back(self) -> str:
        return self.sequence.back[0] if len(self.sequence.back) == 1 else ""

    @property
    def _harmonic(self) -> bool:
        """The motion that never dwells: bottoms match in acceleration too."""
        return self.sequence.curves[0] == "H1"

    @property
    def bent(self) -> str:
        """The one free number in which the family is not linear; empty where nothing is free."""
        if len(self.sequence.rise) == 1:
            return ""
        if self._single_back == "H6":
            return "h1" if self._rise_cv else ""
        if len(self.sequence.back) > 1 and not self.mirrored:
            if not self._harmonic or self._back_cv:
                return "r"
            return "s" if self._rise_cv else "h1"
        return "h1" if self._harmonic and len(self.sequence.back) > 1 and not self._rise_cv else "h3"

    @property
    def linear(self) -> tuple[str, ...]:
        """The other free numbers: with ``bent`` given, every height and W are linear in them."""
        bent, names = self.bent, []
        if bent in ("r", "s") or (bent == "h3" and self._rise_cv):
            names.append("h1")
        if bent == "r" and self._rise_cv:
            names.append("h3")
        if bent == "r" and not self._harmonic and self._back_cv:
            names.append("h6")
        return tuple(names)

    @property
    def free(self) -> tuple[str, ...]:
        """All free numbers: ``h1``, ``h3``, ``h6``; ``r``, speed of the return over that of the rise; ``s`` = h1 + h3."""
        return (*((self.bent,) if self.bent else ()), *self.linear)

    def solve(self, task: Task, free: Mapping[str, Values]) -> dict[str, np.ndarray]:
        """Heights h1 ... h6 and W = V x span from the free numbers (n,); heights may come out negative: not feasible."""
        h, g = task.rise, task.back
        if len(self.sequence.rise) == 1:
            return {}
        if self._single_back == "H6":
            h1 = h3 = free["h1"] if "h1" in free else np.array([h / 2.0])
        else:
            h1 = free["h1"] if "h1" in free else h - free["h3"]
            h3 = free["s"] - h1 if "s" in free else free["h3"] if "h3" in free else h - h1
        found = {"h1": h1, "h2": h - h1 - h3 if self._rise_cv else 0.0, "h3": h3, "r": 1.0}
        w = self.rise_work(found)
        if self._single_back:
            factor = KAPPA if self._single_back == "P2" else pi / sqrt(2.0)
            found["h4"] = g
            found["W"] = w + factor * np.sqrt(g * np.maximum(h3, 0.0))
        elif self.sequence.back:
            found.update(self._back(task, free, h1, h3))
            found["W"] = w + self._back_work(found) / found["r"]
        else:
            found["W"] = w
        names, columns = tuple(found), np.broadcast_arrays(*found.values())
        return dict(zip(names, columns, strict=True))

    def _back_work(self, found: Mapping[str, Values]) -> Values:
        """Span of the return times its speed."""
        back = self.sequence.back
        return ELEMENTS_SPAN[back[0]] * found["h4"] + found["h5"] + ELEMENTS_SPAN[back[-1]] * found["h6"]

    def _back(self, task: Task, free: Mapping[str, Values], h1: Values, h3: Values) -> dict[str, Values]:
        """Equal acceleration at the top: h4 = r² h3; for a motion that never dwells also h6 = r² h1."""
        g = task.back
        if self.mirrored:
            return {"r": 1.0, "h4": h3, "h6": h1, "h5": g - h1 - h3 if self._back_cv else 0.0}
        if self._harmonic:
            r2 = free["r"] ** 2 if self._back_cv else g / (h1 + h3)
            return {
                "r": np.sqrt(r2),
                "h4": r2 * h3,
                "h6": r2 * h1,
                "h5": g - r2 * (h1 + h3) if self._back_cv else 0.0,
            }
        r = free["r"]
        h4 = r * r * h3
        if self._back_cv:
            return {"r": r, "h4": h4, "h6": free["h6"], "h5": g - h4 - free["h6"]}
        return {"r": r, "h4": h4, "h6": g - h4, "h5": 0.0}

    def parts(self, task: Task, found: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Heights and spans [deg] of the curves, in order: (curves, n) each."""
        rise, back = self.sequence.rise, self.sequence.back
        if len(rise) == 1:
            return _without_freedom(self.sequence, task)
        speed = found["W"] / task.span
        heights = _heights(rise, found["h1"], found["h2"], found["h3"])
        spans = [ELEMENTS_SPAN[n] * x / speed for n, x in zip(rise, heights, strict=True)]
        if self._single_back:
            heights.append(found["h4"])
            spans.append(task.span - sum(spans))
        elif back:
            returned = _heights(back, found["h4"], found["h5"], found["h6"])
            spans += [ELEMENTS_SPAN[n] * x / (found["r"] * speed) for n, x in zip(back, returned, strict=True)]
            heights += returned
        return np.array(heights), np.array(spans)

    def solution(self, task: Task, found: Mapping[str, np.ndarray], i: int = 0) -> Solution:
        """The i-th point with its spans and speeds."""
        # a height of constant velocity may be 0 but for rounding
        heights, spans = (tuple(max(float(v), 0.0) for v in rows[:, i]) for rows in self.parts(task, found))
        speed = float(found["W"][i]) / task.span if found else 0.0
        back_speed = float(found["r"][i]) * speed if len(self.sequence.back) > 1 else 0.0
        return Solution(self.sequence, heights, spans, speed, back_speed)


ELEMENTS_SPAN = {name: row.speed for name, row in ELEMENTS.items()}
"""span = c h/V of the curves that reach the speed V at an end."""


def _heights(names: tuple[str, ...], first: Values, middle: Values, last: Values) -> list[Values]:
    return [first, middle, last] if len(names) == 3 else [first, last]


def _without_freedom(sequence: Sequence, task: Task) -> tuple[np.ndarray, np.ndarray]:
    """C5; C6; P1-P2 and H5-H6, whose spans make the accelerations at the top equal: β1/β2 = √(h/g)."""
    if not sequence.back:
        return np.array([[task.rise]]), np.array([[task.span]])
    share = sqrt(task.rise) / (sqrt(task.rise) + sqrt(task.back))
    first = task.span * share
    return np.array([[task.rise], [task.back]]), np.array([[first], [task.span - first]])
