"""Where two points are passed at once: over two free numbers cells are cut smaller, and those dropped in which a quadratic
through nine places, doubted by twice its bend, leaves no zero."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from math import inf

import numpy as np

from core.blend.curve import Curve, between
from core.blend.metering import Meter
from core.blend.region import Part, Region
from core.blend.wishes import Wish

CELLS = 12  # in either direction at first
HALVINGS = 6
MOST = 3000  # cells: more lie along a line on which both points are passed

Places = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""t (n,) and x (numbers, n) at coordinates 0 ... 1 (2, n)."""
_NINE = np.array([(i, j) for i in (-1.0, 0.0, 1.0) for j in (-1.0, 0.0, 1.0)])


def crossings(meter: Meter, region: Region, wishes: Sequence[Wish]) -> Iterator[tuple[float, tuple[float, ...]]]:
    """t and x near which both wishes may be met, in a region that leaves two numbers free."""
    for part in region.parts:
        for places in _in_plane(part) if part.low == part.high else _strips(part):
            yield from _near(meter, places, wishes)


def _strips(part: Part) -> Iterator[Places]:
    """Between two corners each, along t."""
    for low, high in pairwise(sorted({end for _, s in part.corners for end in (s.low, s.high)})):
        middle = between(low, high)
        there = [c for c, s in part.corners if s.low < middle < s.high]
        at = np.array([c.place(middle)[1] for c in there])
        widest = int(np.argmax(np.ptp(at, axis=0)))
        first, last = (there[int(i(at[:, widest]))] for i in (np.argmin, np.argmax))
        yield partial(_in_strip, first, last, low, high)


def _in_strip(first: Curve, last: Curve, low: float, high: float, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b = low / (1.0 + low), 1.0 if high == inf else high / (1.0 + high)
    place = a + (b - a) * at[0]
    with np.errstate(all="ignore"):
        t = place / (1.0 - place)
    x = first.places(t)[1]
    return t, x + at[1] * (last.places(t)[1] - x)


def _in_plane(part: Part) -> Iterator[Places]:
    """At one t: the rectangle about the corners; a mere line belongs to a strip."""
    corners = np.array([c.place(p)[1] for c, s in part.corners for p in (s.low, s.high)])
    origin = corners.mean(axis=0)
    along = np.linalg.svd(corners - origin)[2][:2]
    reach = (corners - origin) @ along.T
    low, high = reach.min(axis=0)[:, None], reach.max(axis=0)[:, None]
    if len(along) == 2 and (high - low).min() > 1e-9:
        yield lambda at: (np.full(at.shape[1], part.low), origin[:, None] + along.T @ (low + at * (high - low)))


def _near(meter: Meter, places: Places, wishes: Sequence[Wish]) -> Iterator[tuple[float, tuple[float, ...]]]:
    axis = (np.arange(CELLS) + 0.5) / CELLS
    centres, half = np.array(np.meshgrid(axis, axis)).reshape(2, -1), 0.5 / CELLS
    for depth in range(HALVINGS + 1):
        centres = centres[:, _may_hold(meter, places, wishes, centres, half)]
        if depth == HALVINGS or not 0 < centres.shape[1] <= MOST:
            break
        half *= 0.5
        corners = [(i, j) for i in (-half, half) for j in (-half, half)]
        centres = np.concatenate([centres + np.array(c)[:, None] for c in corners], axis=1)
    if centres.shape[1] <= MOST:
        t, x = places(centres)
        yield from ((float(a), tuple(float(v) for v in b)) for a, b in zip(t, x.T, strict=True))


def _may_hold(
    meter: Meter, places: Places, wishes: Sequence[Wish], centres: np.ndarray, half: float
) -> np.ndarray:
    """Cells in which neither wish is excluded, nor both at once, and no height is below 0 throughout."""
    t, x = places(np.clip(centres[:, :, None] + half * _NINE.T[:, None, :], 1e-12, 1.0 - 1e-12).reshape(2, -1))
    kept = np.ones(centres.shape[1], dtype=bool)
    values = meter.equations.values(t, x)
    for name in (*meter.family.positive, *meter.family.constant):
        middle, slopes, doubt = _quadratic(values[meter.equations.place_of(name)])
        kept &= ~(middle + np.abs(slopes).sum(axis=0) + doubt < 0.0)
    rows = [_quadratic(meter.many(wish, t, x) - wish.value) for wish in wishes]
    for middle, slopes, doubt in rows:
        kept &= ~(np.abs(middle) > np.abs(slopes).sum(axis=0) + doubt)
    (f, (a, b), one), (g, (c, d), two) = rows
    spin = np.abs(a * d - b * c)  # the zero of both planes, and how far the bends may move it
    kept &= ~(np.abs(d * f - b * g) > spin + np.abs(d) * one + np.abs(b) * two)
    kept &= ~(np.abs(a * g - c * f) > spin + np.abs(c) * one + np.abs(a) * two)
    return kept


def _quadratic(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Value in the middle of each cell, change from there to its ends by both coordinates (2, n), and what to doubt of
    that; nan where nothing is known."""
    f = values.reshape(-1, 3, 3)
    middle = f[:, 1, 1]
    slopes = 0.5 * np.array([f[:, 2, 1] - f[:, 0, 1], f[:, 1, 2] - f[:, 1, 0]])
    bends = np.abs(f[:, 2, 1] - 2.0 * middle + f[:, 0, 1]) + np.abs(f[:, 1, 2] - 2.0 * middle + f[:, 1, 0])
    return middle, slopes, bends + 0.5 * np.abs(f[:, 2, 2] - f[:, 2, 0] - f[:, 0, 2] + f[:, 0, 0])
