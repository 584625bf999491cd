"""Level of detail: which points of a line a picture needs, so that it is the same as with all of them."""

from __future__ import annotations

import numpy as np

UNSEEN = 0.05  # pixels by which a line may be off: next to nothing of what antialiasing makes of an edge
PIECES = (64, 8, 4)  # points that one piece of line may stand for, tried in turn
PER_SCALE = 2.0  # a line thinned for one scale serves others up to so many times smaller


def needed(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Indices (m,), ascending, of those points of a line through ``points`` (n,) complex that have to be kept.

    No point left out lies further than ``tolerance`` from the straight piece that takes its place, so that extremes,
    corners and jumps stay; the first and the last point are kept, all where the tolerance is 0, and all that stand
    beside a gap (NaN).
    """
    n = points.size
    if tolerance <= 0.0 or n < 3:
        return np.arange(n)
    kept = np.zeros(n, dtype=bool)
    kept[-1] = True
    starts = np.arange(0, n - 1, PIECES[0])
    for length, shorter in zip(PIECES, (*PIECES[1:], 1), strict=True):
        near = _near(points, starts, np.minimum(starts + length, n - 1), length, tolerance)
        kept[starts[near]] = True
        starts = (starts[~near, None] + np.arange(0, length, shorter)).ravel()
        starts = starts[starts < n - 1]
    kept[starts] = True
    return np.flatnonzero(kept)


def _near(points: np.ndarray, start: np.ndarray, end: np.ndarray, length: int, tolerance: float) -> np.ndarray:
    """Whether all points between start and end (b,), indices, stand near the straight line between the two (b,)."""
    chord = points[end] - points[start]
    size = np.abs(chord)[:, None]
    inner = points[np.minimum(start[:, None] + np.arange(1, length), end[:, None])] - points[start, None]
    turned = inner * chord.conj()[:, None]  # along the line and beside it, times its length
    room = tolerance * size
    near = (np.abs(turned.imag) <= room) & (turned.real >= -room) & (np.abs(inner) <= size + tolerance)
    return np.asarray(near.all(axis=1))


def level(scale: float) -> float:
    """The scale a line is thinned for where it is drawn at ``scale``: the next power of two from it on, so that a
    picture that is zoomed little by little is not thinned anew each time."""
    return float(PER_SCALE ** np.ceil(np.log2(scale)))
