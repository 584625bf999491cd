"""Peak coefficients of a law: how much velocity, acceleration, jerk and inertia torque it costs."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise

import numpy as np

from core.frozen import frozen
from core.laws.pieces import PieceTable
from core.laws.table import Law

GRID = 257  # first sampling of a piece; its waves are at most a few turns
NEAR = 0.99  # of the highest sample: lower tops cannot pass it between two samples
ROUNDING = 1e-12


@frozen
class Peaks:
    """Largest |s'|, |s''|, |s'''| and |s' s''| (inertia torque) for unit rise and unit span; infinite where the quantity
    before it jumps inside the law. ``jumps_at_an_end``: the acceleration does not start or end at 0."""

    cv: float
    ca: float
    cj: float
    cm: float
    jumps_at_an_end: bool


@lru_cache(maxsize=256)
def peaks(law: Law) -> Peaks:
    """The peak coefficients of a law, refined on every piece from inside, so that both sides of a jump count."""
    table = PieceTable(law.pieces)
    best, edges = np.zeros(4), []
    for i, width in enumerate(np.diff(table.starts, append=1.0)):
        best = np.maximum(best, _piece_peaks(table, i, width))
        edges.append(table.rows(np.full(2, i), np.array([0.0, width]))(2))
    jerk_is_infinite = any(
        not math.isclose(left[1], right[0], rel_tol=1e-9, abs_tol=1e-9 * best[1]) for left, right in pairwise(edges)
    )
    at_an_end = max(abs(edges[0][0]), abs(edges[-1][1])) > 1e-9 * max(best[1], 1.0)
    cv, ca, cj, cm = best.tolist()
    return Peaks(cv, ca, math.inf if jerk_is_infinite else cj, cm, at_an_end)


def _piece_peaks(table: PieceTable, i: int, width: float) -> np.ndarray:
    """The peaks (4,) of one piece: of each quantity every sampled top that may be the highest, its bracket cut down until rounding
    decides."""
    w = np.linspace(0.0, width, GRID)
    sampled = _sizes(table, i, np.repeat(w[:, None], 4, axis=1), np.arange(4))
    best = sampled.max(axis=0)
    up = np.diff(sampled, axis=0, prepend=-1.0) > ROUNDING * best
    down = np.diff(sampled, axis=0, append=-1.0) <= ROUNDING * best
    top, of = np.nonzero(up & down & (sampled >= NEAR * best))
    low, high = w[np.maximum(top - 1, 0)], w[np.minimum(top + 1, GRID - 1)]
    each = np.arange(of.size)
    for _ in range(12):
        places = np.linspace(low, high, 17)
        values = _sizes(table, i, places, of)
        at = values.argmax(axis=0)
        np.maximum.at(best, of, values[at, each])
        low, high = places[np.maximum(at - 1, 0), each], places[np.minimum(at + 1, 16), each]
    return best


def _sizes(table: PieceTable, i: int, places: np.ndarray, of: np.ndarray) -> np.ndarray:
    """|s'|, |s''|, |s'''| or |s' s''| at places (n, m) of a piece: per column the quantity of that number (m,)."""
    row = table.rows(np.full(places.size, i), places.ravel())
    v, a, j = (row(order).reshape(places.shape) for order in (1, 2, 3))
    return np.abs(np.select([of == 0, of == 1, of == 2], [v, a, j], v * a))
