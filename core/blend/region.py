"""All points that meet linear constraints and leave more than one number free: with t given they are a polytope, whose
corners run along curves. A setting that is linear, or a quotient of such, takes its extremes on these."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from math import inf

import numpy as np

from core.blend.curve import SAME, Curve, Extreme, Stretch, between
from core.blend.equations import Row, solution_spaces
from core.blend.evaluator import Evaluator
from core.blend.request import Constraint, Range, merged, tied

NEAR = 1e-6  # a height of a face, as a share of the stroke, that is above 0
SAMPLES = 24  # values of t of a sample of points
MIXES = 24  # points for each of these

Pieces = list[tuple[Curve, Stretch]]


@dataclass(frozen=True)
class Part:
    """A connected part of a region: its corners' curves over t from low to high, or lines at one t."""

    corners: Pieces
    low: float
    high: float

    def at(self, t: float) -> np.ndarray:
        """The corners at one t (corners, numbers)."""
        if self.low == self.high:
            return np.array([c.place(p)[1] for c, s in self.corners for p in (s.low, s.high)])
        return np.array([c.place(t)[1] for c, s in self.corners if s.low <= t <= s.high])


class Region:
    """The feasible points of a family that meet equations."""

    def __init__(self, evaluator: Evaluator, rows: Sequence[Row]) -> None:
        self._evaluator, self._rows = evaluator, list(rows)

    @cached_property
    def parts(self) -> list[Part]:
        """Where there is room for every height that must be above 0."""
        pieces = [(curve, stretch) for curve in self._edges() for stretch in curve.stretches]
        return [*self._along_t([(c, s) for c, s in pieces if c.t is None]), *self._at_one_t(pieces)]

    def _edges(self) -> Iterable[Curve]:
        """Curves on which as many heights are 0 as numbers are free, but one."""
        family, equations = self._evaluator.family, self._evaluator.equations
        missing = family.freedom - 1 - len(self._rows)
        for names in combinations((*family.positive, *family.constant), missing):
            spaces = solution_spaces(equations, [*self._rows, *(equations.exact(n) for n in names)])
            yield from (Curve.of(family, s, closed=True) for s in spaces if s.freedom == 1)

    def _along_t(self, pieces: Pieces) -> Iterable[Part]:
        cuts = sorted({end for _, s in pieces for end in (s.low, s.high)})
        runs: list[tuple[float, float]] = []
        for low, high in pairwise(cuts):
            middle = between(low, high)
            corners = [c.place(middle)[1] for c, s in pieces if s.low < middle < s.high]
            if corners and self._is_feasible(middle, corners):
                runs = [*runs[:-1], (runs[-1][0], high)] if runs and runs[-1][1] == low else [*runs, (low, high)]
        for low, high in runs:
            inside = [(c, Stretch(max(s.low, low), min(s.high, high))) for c, s in pieces]
            yield Part([(c, s) for c, s in inside if s.low < s.high], low, high)

    def _at_one_t(self, pieces: Pieces) -> Iterable[Part]:
        pinned = [(c, s) for c, s in pieces if c.t is not None]
        while pinned:
            t = pinned[0][0].t or 0.0
            here = [(c, s) for c, s in pinned if abs((c.t or 0.0) - t) <= 1e-9 * t]
            pinned = [piece for piece in pinned if piece not in here]
            part = Part(here, t, t)
            if self._is_feasible(t, part.at(t)):
                yield part

    def _is_feasible(self, t: float, corners: Sequence[Sequence[float]] | np.ndarray, least: float = 0.0) -> bool:
        """Whether the middle of corners is."""
        return self._evaluator.is_feasible((t, tuple(map(float, np.mean(corners, axis=0)))), least)

    # -- what a setting may be ----------------------------------------------------------------------------

    def ranges(self, name: str) -> list[Range]:
        """Of a linear setting; of an acceleration only the upper end counts."""
        return merged(self._range(name, part) for part in self.parts)

    def _range(self, name: str, part: Part) -> Range:
        found = [(c, e) for c, s in part.corners for e in c.extremes(name, s)]
        low, high = min(e.value for _, e in found), max(e.value for _, e in found)
        return Range(low, high, *(self._is_open(name, part, found, value) for value in (low, high)))

    def _is_open(self, name: str, part: Part, found: Sequence[tuple[Curve, Extreme]], value: float) -> bool:
        """Whether a setting has an extreme value only where a height is 0 that must be above: on one corner, or on the face
        between all corners of the same t that have it."""
        there = [(c, e) for c, e in found if tied(1.0 + e.value, 1.0 + value)]
        if not all(e.open for _, e in there) or value == inf:
            return value == inf
        for t in {c.place(e.p)[0] for c, e in there if 0.0 < e.p < c.top}:
            corners = part.at(t)
            values = self._evaluator.values(Constraint(name, value), np.full(len(corners), t), corners.T)
            face = corners[np.abs(values - value) <= SAME * max(1.0, abs(value))]
            if len(face) and self._is_feasible(t, face, NEAR):
                return False
        return True

    # -- points of it -------------------------------------------------------------------------------------

    def sample(self) -> np.ndarray:
        """Points (1 + numbers, n), always the same, ``MIXES`` at the same t beside each other."""
        chance = np.random.default_rng(1995)
        found = [np.empty((1 + len(self._evaluator.equations.numbers), 0))]
        for part in self.parts:
            for value in _spread(part.low, part.high):
                corners = part.at(float(value))
                if len(corners):
                    x = chance.dirichlet(np.ones(len(corners)), MIXES) @ corners
                    found.append(np.vstack([np.full(MIXES, value), x.T]))
        return np.concatenate(found, axis=1)


def _spread(low: float, high: float) -> np.ndarray:
    """Values from low to high, closer to each other at both ends."""
    a, b = low / (1.0 + low), 1.0 if high == inf else high / (1.0 + high)
    share = 0.5 - 0.5 * np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)
    place = a + (b - a) * share
    return place / (1.0 - place) if high > low else np.full(SAMPLES, low)
