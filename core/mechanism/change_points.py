"""The branch that a linkage follows: which side of a dyad holds where, over change points, and where Newton starts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from core.numerics.vectors import unit

State = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Of a link: origin and angle (4, n), x axis (n,)."""

HALF = 0.01  # half the width of a bridge, in units of the driver's coordinate scale


@dataclass(frozen=True, eq=False)
class Track:
    """A group's path: driver positions (m,), and there its coordinates with three derivatives (m, 4, 3k)."""

    at: np.ndarray
    states: np.ndarray

    @property
    def low(self) -> float:
        return float(self.at[0])

    @property
    def high(self) -> float:
        return float(self.at[-1])

    def start(self, q: np.ndarray) -> np.ndarray:
        """Coordinates near those at q (3k, n), by Taylor from the nearest node."""
        nearest = np.searchsorted(0.5 * (self.at[1:] + self.at[:-1]), q)
        step = q - self.at[nearest]
        x, v, a, j = (self.states[nearest, k].T for k in range(4))
        return np.asarray(x + step * (v + step * (a / 2.0 + step * j / 6.0)))


@dataclass(frozen=True, eq=False)
class Bridge:
    """A dyad's two links over a change point, where its equations are 0/0 although the links move on smoothly.

    at, half   the change point and half the width [rad or m]
    links      their numbers
    power      (8, 6) coefficients, by (q - at)/half, of x, y, angle of the first link, then of the second: they agree
               with the closed form and its three derivatives at both ends
    """

    at: float
    half: float
    links: tuple[int, int]
    power: np.ndarray

    def within(self, q: np.ndarray) -> np.ndarray:
        return np.abs(q - self.at) < self.half

    def apply(self, q: np.ndarray, there: np.ndarray, states: Mapping[int, State]) -> None:
        """Set the links' states at q (4, n) where ``there`` (n,) says so."""
        u = (q[0, there] - self.at) / self.half
        by_q = [polyval(u, polyder(self.power, order)).T / self.half**order for order in range(4)]
        _, v, a, j = q[:, there, None]
        rows = (
            by_q[0],
            by_q[1] * v,
            by_q[2] * v * v + by_q[1] * a,
            by_q[3] * v * v * v + 3.0 * by_q[2] * v * a + by_q[1] * j,
        )
        for i, link in enumerate(self.links):
            z, angle, heading = states[link]
            for order, row in enumerate(rows):
                z[order, there] = row[:, 3 * i] + 1j * row[:, 3 * i + 1]
                angle[order, there] = row[:, 3 * i + 2]
            heading[there] = unit(angle[0, there])


def bridge(at: float, half: float, links: tuple[int, int], states: np.ndarray) -> Bridge:
    """The bridge through states (2, 4, 6): at both ends x, y, angle of both links and three derivatives by q."""
    rows = [polyval(u, polyder(np.eye(8), order)) for u in (-1.0, 1.0) for order in range(4)]
    right = (states * half ** np.arange(4.0)[:, None]).reshape(8, 6)
    return Bridge(at, half, links, np.linalg.solve(np.array(rows), right))


@dataclass
class Branch:
    """Which of its assemblies a linkage is in, by step of its plan, as far as it has been solved: tracks of groups; change
    points of dyads (rising, (m,)), the driver position from which their sides count, and the bridges over them."""

    start: float = 0.0
    tracks: dict[int, Track] = field(default_factory=dict)
    changes: dict[int, np.ndarray] = field(default_factory=dict)
    bridges: dict[int, tuple[Bridge, ...]] = field(default_factory=dict)

    def side(self, step: int, stated: float, q: np.ndarray) -> float | np.ndarray:
        """The stated side at the start of the course, the other one beyond each change point."""
        changes = self.changes.get(step)
        if changes is None or not changes.size:
            return stated
        passed = np.searchsorted(changes, q) - np.searchsorted(changes, self.start + 1e-9)
        return np.where(passed % 2 == 0, stated, -stated)
