"""Legs of a turn of the cam, each to be solved as a whole: cells, none across a join, with Gauss-Legendre nodes at which all
that the train does is known beforehand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import pi

import numpy as np

from core.motion import TURN
from core.stability.coefficients import still
from core.stability.panels import NODES, Panels, gauss

TOGETHER = 2.0  # panels of the coefficients per cell at full accuracy
FULL = 1e-13
PHASE = 2.0  # [rad] of the shaft's own wave per cell, so that whoever looks at parts of it misses nothing
LEG = 4.5  # [rad] of it per leg, where the train moves
LONGEST = 9.0  # [rad] per leg at all

_NODES = gauss(NODES)[0]


@dataclass(eq=False)
class Leg:
    """A part of the turn in cells (K,): edges (K + 1,) [turns of the cam]; how often it was halved."""

    panels: Panels
    edges: np.ndarray
    halved: int = 0

    def halves(self) -> Leg:
        """With twice as many cells."""
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        return Leg(self.panels, np.sort(np.append(self.edges, middle)), self.halved + 1)

    def split(self) -> tuple[Leg, Leg]:
        """One after the other."""
        at = self.edges.size // 2
        return Leg(self.panels, self.edges[: at + 1], self.halved), Leg(self.panels, self.edges[at:], self.halved)

    def rows(self, edges: np.ndarray) -> np.ndarray:
        """d, C, U (3, n, K, NODES) at the nodes of cells with other edges (n, K + 1)."""
        place = nodes(edges)
        return self.panels.at(TURN * place.ravel(), 3).reshape(3, *place.shape)

    @cached_property
    def own(self) -> np.ndarray:
        """The same of its own cells, n = 1."""
        return self.rows(self.edges[None])


def nodes(edges: np.ndarray) -> np.ndarray:
    """(n, K, NODES) of cells with edges (n, K + 1)."""
    return edges[:, :-1, None] + np.diff(edges)[..., None] * _NODES


def legs_of(panels: Panels, eta: float, error: float) -> list[Leg]:
    """All legs of the turn for shafts up to this η and a wanted error."""
    edges, moves = _cells(panels, 2.0 * pi * eta, max(1, round(TOGETHER * (error / FULL) ** (1.0 / NODES))))
    phase = 2.0 * pi * eta * np.diff(edges)
    legs, begin = [], 0
    for i in range(1, edges.size):
        span = phase[begin : i + 1]  # with the next cell
        if i + 1 == edges.size or span.sum() > LONGEST or span[moves[begin : i + 1]].sum() > LEG:
            legs.append(Leg(panels, edges[begin : i + 1]))
            begin = i
    return legs


def _cells(panels: Panels, fastest: float, together: int) -> tuple[np.ndarray, np.ndarray]:
    """Edges (K + 1,) [turns], and where the train moves (K,): so many panels each, or all on which it rests; narrower where
    the fastest wave [rad per turn] asks for it."""
    first = np.flatnonzero(np.diff(panels.piece, prepend=-1))
    resting = np.logical_and.reduceat(still(panels), first)
    edges, moves = [0.0], []
    for begin, end, rests in zip(first, [*first[1:], panels.count], resting, strict=True):
        marks = [*panels.start[begin : end : end - begin if rests else together], panels.start[end % panels.count]]
        marks[-1] += TURN * (end == panels.count)
        for low, high in pairwise(marks):
            parts = max(1, int(np.ceil(fastest * (high - low) / (TURN * PHASE))))
            edges += [*(np.linspace(low, high, parts + 1)[1:] / TURN)]
            moves += [not rests] * parts
    edges[-1] = 1.0
    return np.array(edges), np.array(moves)
