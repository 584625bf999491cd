"""All points that meet linear wishes and leave more than one number free: with t given they are a polytope, whose corners
run along curves. A setting that is linear, or a quotient of such, takes its extremes on these."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from math import inf

import numpy as np

from core.blend.curve import Curve, Extreme, Stretch, between
from core.blend.equations import Equations, Row
from core.blend.family import Family
from core.blend.flats import flats
from core.blend.metering import Meter
from core.blend.range import Range, merged, tied

NEAR = 1e-6  # how near to each other corners at an extreme are one face's
_SAMPLES = 24  # values of t of a sample of points
_MIXES = 24  # points for each of these

Pieces = list[tuple[Curve, Stretch]]


@dataclass(frozen=True)
class Part:
    """A connected part of a region: its corners' curves over t from low to high, or lines at one t."""

    corners: tuple[tuple[Curve, Stretch], ...]
    low: float
    high: float


class Region:
    """The feasible points that meet linear equations of a family."""

    def __init__(self, family: Family, meter: Meter, rows: Sequence[Row]) -> None:
        self.family, self.meter, self._rows = family, meter, list(rows)

    @property
    def _equations(self) -> Equations:
        return self.meter.equations

    @cached_property
    def edges(self) -> list[Curve]:
        """Curves on which as many heights are 0 as numbers are free, but one."""
        missing = self.family.freedom - 1 - len(self._rows)
        found = []
        for names in combinations((*self.family.positive, *self.family.constant), missing):
            zeros = [self._equations.exact(n) for n in names]
            rows = flats(self._equations, [*self._rows, *zeros])
            found += [Curve.of(self.family, f, closed=True) for f in rows if f.freedom == 1]
        return found

    @cached_property
    def parts(self) -> list[Part]:
        """Where there is room for every height that must be above 0."""
        pieces = [(c, s) for c in self.edges for s in c.stretches]
        return [*self._along_t([(c, s) for c, s in pieces if c.t is None]), *self._at_t(pieces)]

    def _along_t(self, pieces: Pieces) -> Iterable[Part]:
        cuts = sorted({end for _, s in pieces for end in (s.low, s.high)})
        runs: list[tuple[float, float]] = []
        for low, high in pairwise(cuts):
            middle = between(low, high)
            corners = [c.place(middle)[1] for c, s in pieces if s.low < middle < s.high]
            if corners and self.meter.is_feasible(middle, np.mean(corners, axis=0)):
                runs = [*runs[:-1], (runs[-1][0], high)] if runs and runs[-1][1] == low else [*runs, (low, high)]
        for low, high in runs:
            inside = [(c, Stretch(max(s.low, low), min(s.high, high))) for c, s in pieces]
            yield Part(tuple((c, s) for c, s in inside if s.low < s.high), low, high)

    def _at_t(self, pieces: Pieces) -> Iterable[Part]:
        pinned = [(c, s) for c, s in pieces if c.t is not None]
        while pinned:
            t = pinned[0][0].t or 0.0
            here = tuple((c, s) for c, s in pinned if abs((c.t or 0.0) - t) <= 1e-9 * t)
            pinned = [(c, s) for c, s in pinned if abs((c.t or 0.0) - t) > 1e-9 * t]
            corners = [c.place(p)[1] for c, s in here for p in (s.low, s.high)]
            if self.meter.is_feasible(t, np.mean(corners, axis=0)):
                yield Part(here, t, t)

    # -- what a setting may be ----------------------------------------------------------------------------

    def ranges(self, name: str) -> list[Range]:
        """Of a linear setting; of an acceleration only the upper end counts."""
        return merged(self._range(name, part) for part in self.parts)

    def _range(self, name: str, part: Part) -> Range:
        found = [(c, e) for c, s in part.corners for e in c.extremes(c.quotients(name), s)]
        low, high = min(e.value for _, e in found), max(e.value for _, e in found)
        return Range(low, high, self._is_open(found, low), self._is_open(found, high))

    def _is_open(self, found: Sequence[tuple[Curve, Extreme]], value: float) -> bool:
        """Whether an extreme lies only where a height is 0 that must be above: on one corner, or between several."""
        there = [(c, e) for c, e in found if tied(e.value, value)]
        if not all(e.open for _, e in there) or value == inf:
            return value == inf
        places = [c.place(e.p) for c, e in there if 0.0 < e.p < c.top]
        for t, _ in places:
            face = [x for other, x in places if abs(other - t) <= NEAR * t]
            if self.meter.is_feasible(t, np.mean(face, axis=0), NEAR):
                return False
        return True

    # -- points of it -------------------------------------------------------------------------------------

    def sample(self, seed: int = 1995) -> list[tuple[np.ndarray, np.ndarray]]:
        """Points, drawn anew in the same way each time: for some t each, t (n,) and x (numbers, n)."""
        chance = np.random.default_rng(seed)
        return [self._mixed(t, corners, chance) for part in self.parts for t, corners in self._corners(part)]

    def _corners(self, part: Part) -> Iterable[tuple[float, np.ndarray]]:
        """Values of t with the corners there (corners, numbers)."""
        if part.low == part.high:
            yield part.low, np.array([c.place(p)[1] for c, s in part.corners for p in (s.low, s.high)])
            return
        for t in _spread(part.low, part.high):
            corners = [c.place(t)[1] for c, s in part.corners if s.low <= t <= s.high]
            if corners:
                yield t, np.array(corners)

    def _mixed(self, t: float, corners: np.ndarray, chance: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        shares = chance.dirichlet(np.ones(len(corners)), _MIXES)
        return np.full(_MIXES, t), (shares @ corners).T


def _spread(low: float, high: float) -> np.ndarray:
    """Values from low to high, closer to each other at both ends."""
    a, b = low / (1.0 + low), 1.0 if high == inf else high / (1.0 + high)
    share = 0.5 - 0.5 * np.cos(np.pi * (np.arange(_SAMPLES) + 0.5) / _SAMPLES)
    place = a + (b - a) * share
    return place / (1.0 - place)
