"""Peak coefficients of a law: how much velocity, acceleration, jerk and inertia torque it costs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from core.laws.pieces import Piece, PieceTable
from core.laws.table import Law

GRID = 257  # first sampling of a piece; its waves are at most a few turns


@dataclass(frozen=True)
class Peaks:
    """Largest |s'|, |s''|, |s'''| and |s' s''| (inertia torque) for unit rise and unit span; infinite where the quantity
    before it jumps inside the law. ``jumps_at_an_end``: the acceleration does not start or end at 0."""

    cv: float
    ca: float
    cj: float
    cm: float
    jumps_at_an_end: bool


@lru_cache(maxsize=256)
def peaks_of(pieces: tuple[Piece, ...]) -> Peaks:
    """Refined on every piece from inside, so that both sides of a jump count."""
    table = PieceTable(pieces)
    starts = [p.start for p in pieces]
    ends = [*starts[1:], 1.0]
    best = np.zeros(4)
    edges = []
    for i, (a, b) in enumerate(zip(starts, ends, strict=True)):
        w = np.linspace(0.0, b - a, GRID)
        best = np.maximum(best, _piece_peaks(table, i, w))
        edges.append(table.evaluate(np.full(2, i), np.array([0.0, b - a])))
    jerk_is_infinite = any(
        not math.isclose(left[2, 1], right[2, 0], rel_tol=1e-9, abs_tol=1e-9 * best[1])
        for left, right in pairwise(edges)
    )
    at_an_end = max(abs(edges[0][2, 0]), abs(edges[-1][2, 1])) > 1e-9 * max(best[1], 1.0)
    return Peaks(
        float(best[0]), float(best[1]), math.inf if jerk_is_infinite else float(best[2]), float(best[3]), at_an_end
    )


def peaks(law: Law) -> Peaks:
    """The peak coefficients of a law of the table."""
    return peaks_of(law.pieces)


def _quantities(rows: np.ndarray) -> np.ndarray:
    return np.abs(np.array([rows[1], rows[2], rows[3], rows[1] * rows[2]]))


def _piece_peaks(table: PieceTable, i: int, w: np.ndarray) -> np.ndarray:
    """The peaks of one piece: the sampled top, its bracket cut down until rounding decides."""
    sampled = _quantities(table.evaluate(np.full(w.size, i), w))
    tops = []
    for q, row in enumerate(sampled):
        top = int(row.argmax())
        low, high = w[max(top - 1, 0)], w[min(top + 1, w.size - 1)]
        value = row[top]
        for _ in range(12):
            x = np.linspace(low, high, 17)
            inner = _quantities(table.evaluate(np.full(17, i), x))[q]
            k = int(inner.argmax())
            value = max(value, inner[k])
            low, high = x[max(k - 1, 0)], x[min(k + 1, 16)]
        tops.append(value)
    return np.array(tops)
