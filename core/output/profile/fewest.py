"""The fewest points that keep a tolerance: from cam angle 0 on always the longest span that keeps it.

Where a part of a span deviates no more than the whole, no other choice of points from cam angle 0 on needs fewer.
"""

from __future__ import annotations

import numpy as np

from core.numerics.cancellation import checkpoint
from core.output.profile.curve import Curve
from core.output.profile.deviation import ROUNDING, of_spans
from core.output.profile.fits import Fit

GRID = 256  # places from which spans are first tried
STEPS = 60  # of a search for the longest span, at most
WINDOW = 2e-5  # relative: a deviation so little below the tolerance is at it
SLIVER = 1e-9  # of the curve: the last span is not left so short
NARROW = 1e-7  # relative width of the bracket at which a search ends
ROUNDS = 3  # of points from spans that begin near them
AT_ONCE = 2048


class TooMany(Exception):
    """The tolerance takes about so many points."""

    def __init__(self, count: int) -> None:
        super().__init__(count)
        self.count = count


def longest(curve: Curve, fit: Fit, begin: np.ndarray, tolerance: float, guess: np.ndarray) -> np.ndarray:
    """Longest spans (m,) [mm] from arc lengths ``begin`` (m,) [mm] that keep the tolerance [mm], searched from a guess.

    The deviation grows as a power of the span; a bracket is kept beside that. What is returned has been tried.
    """
    most = curve.turned(begin, fit.most_turning) - begin
    low, high = np.zeros(begin.size), np.full(begin.size, np.inf)
    span = np.minimum(guess, most)
    active = np.arange(begin.size)
    for step in range(STEPS):
        checkpoint()
        tried = span[active]
        off = of_spans(curve, fit, begin[active], tried)
        fits = off <= tolerance
        low[active] = np.where(fits, tried, low[active])
        high[active] = np.where(fits, high[active], tried)
        done = fits & ((off >= tolerance * (1.0 - WINDOW)) | (tried >= most[active]))
        done |= high[active] - low[active] <= NARROW * high[active]
        with np.errstate(divide="ignore"):
            factor = (tolerance * (1.0 - 0.5 * WINDOW) / off) ** (1.0 / fit.order)
        tried = np.minimum(tried * np.clip(factor, 0.25, 4.0), most[active])
        a, b = low[active], high[active]
        halve = np.isfinite(b) & ((tried <= a) | (tried >= b) | (step % 4 == 3))
        span[active] = np.where(halve, 0.5 * (a + b), tried)
        active = active[~done]
        if not active.size:
            break
    return low


def _longest(curve: Curve, fit: Fit, begin: np.ndarray, tolerance: float, guess: np.ndarray) -> np.ndarray:
    """The same for any number of spans."""
    parts = range(0, begin.size, AT_ONCE)
    return np.concatenate(
        [longest(curve, fit, begin[i : i + AT_ONCE], tolerance, guess[i : i + AT_ONCE]) for i in parts]
    )


def _walk(places: np.ndarray, spans: np.ndarray, begin: float, end: float) -> list[float]:
    """Points from ``begin`` on to below ``end``, each a span behind the one before; spans are known at places (m,)."""
    x, y = np.append(places, end), np.append(spans, spans[0])
    s, found = begin, []
    while s < end * (1.0 - SLIVER):
        found.append(s)
        s += float(np.interp(s, x, y))
        if len(found) % 1000 == 0:
            checkpoint()
    return found


def fewest(curve: Curve, fit: Fit, tolerance: float, most: int) -> np.ndarray:
    """Arc lengths (n,) [mm] of the fewest points, the first at cam angle 0, between which the fit keeps the tolerance [mm].

    Longest spans are searched for many places at once; points taken from them are places for the next round, until they stand
    where the spans were searched. Spans that still exceed the tolerance, over joins, are then searched one by one.
    Raises TooMany where it takes more than ``most``.
    """
    allowed = tolerance / (1.0 + 3.0 * ROUNDING) - curve.error
    kept = allowed / (1.0 + 4.0 * WINDOW)  # by spans between which others are interpolated
    end = curve.length
    places = np.linspace(0.0, end, GRID, endpoint=False)
    spans = longest(curve, fit, places, kept, np.full(GRID, end / 8.0))
    count = float((end / GRID / spans).sum())
    if not count <= most:
        raise TooMany(int(min(count, 1e12)))
    for _ in range(ROUNDS):
        points = np.array(_walk(places, spans, 0.0, end))
        spans = _longest(curve, fit, points, kept, np.interp(points, np.append(places, end), np.append(spans, spans[0])))
        places = points
    found = _walk(places, spans, 0.0, end)
    good = 0  # points before this one have been checked
    while True:
        nodes = np.array(found)
        lengths = np.diff(np.append(nodes, end))
        off = np.concatenate(
            [of_spans(curve, fit, nodes[i : i + AT_ONCE], lengths[i : i + AT_ONCE]) for i in range(good, nodes.size, AT_ONCE)]
        )
        bad = np.flatnonzero(off > allowed) + good
        if not bad.size:
            return nodes
        good = int(bad[0])
        span = longest(curve, fit, nodes[good : good + 1], kept, lengths[good : good + 1])
        found = [*found[: good + 1], *_walk(places, spans, found[good] + float(span[0]), end)]
        good += 1
