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
    """The peaks (4,) of one piece: the sampled top of each quantity, its bracket cut down until rounding decides."""
    low, high, best, each = np.zeros(4), np.full(4, width), np.zeros(4), np.arange(4)
    for count in (GRID, *[17] * 12):
        w = np.linspace(low, high, count)
        row = table.rows(np.full(w.size, i), w.ravel())
        v, a, j = (row(order).reshape(count, 4) for order in (1, 2, 3))
        sampled = np.abs(np.stack((v[:, 0], a[:, 1], j[:, 2], (v * a)[:, 3]), axis=1))
        top = sampled.argmax(axis=0)
        best = np.maximum(best, sampled[top, each])
        low, high = w[np.maximum(top - 1, 0), each], w[np.minimum(top + 1, count - 1), each]
    return best
