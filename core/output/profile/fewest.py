"""The fewest points that keep a tolerance: from cam angle 0 on always the longest span that keeps it.

Where a part of a span deviates no more than the whole, no other choice of points from cam angle 0 on needs fewer.
"""

from __future__ import annotations

import numpy as np

from core.numerics.cancellation import checkpoint
from core.output.profile.curve import ProfileCurve
from core.output.profile.deviation import ROUNDING, of_spans
from core.output.profile.fits import FitMethod

GRID = 64  # places from which spans are first tried
TRIED = np.linspace(0.0, 1.0, 25)[1:]  # lengths of spans, parts of the longest, that are tried first
STEPS = 60  # of a search for the longest span, at most
WINDOW = 2e-5  # relative: a deviation so little below the tolerance is at it
SLIVER = 1e-9  # of the curve: the last span is not left so short
NARROW = 1e-7  # relative width of the bracket at which a search ends
SINGLY = 100  # so few spans are searched one after the other
ROUNDS = 4  # of points from spans that begin near them
AT_ONCE = 2048  # spans that are searched together
CHECKED = 128  # spans that are checked together


class TooMany(Exception):
    """The tolerance takes about so many points."""

    def __init__(self, count: int) -> None:
        super().__init__(count)
        self.count = count


def longest(
    curve: ProfileCurve,
    fit: FitMethod,
    begin: np.ndarray,
    tolerance: float,
    guess: np.ndarray | None = None,
    end: float = np.inf,
) -> np.ndarray:
    """Longest spans (m,) [mm] from arc lengths ``begin`` (m,) [mm], not beyond ``end``, that keep the tolerance [mm], searched from
    a guess; without one spans of all lengths are tried first, for a longer one may deviate less than a shorter one.

    The deviation grows as a power of the span; a bracket is kept beside that. What is returned has been tried.
    """
    most = np.minimum(curve.turned(begin, fit.most_turning), end) - begin
    low, high = np.zeros(begin.size), np.full(begin.size, np.inf)
    if guess is None:
        lengths = most[:, None] * TRIED
        off = of_spans(curve, fit, np.repeat(begin, TRIED.size), lengths.ravel()).reshape(lengths.shape)
        last = np.where(off <= tolerance, np.arange(1, TRIED.size + 1), 0).max(axis=1)
        rows = np.arange(begin.size)
        low = np.where(last > 0, lengths[rows, last - 1], 0.0)
        high = np.where(last < TRIED.size, lengths[rows, np.minimum(last, TRIED.size - 1)], np.inf)
        guess = np.where(np.isfinite(high), 0.5 * (low + high), most)
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


def _longest(curve: ProfileCurve, fit: FitMethod, begin: np.ndarray, tolerance: float, guess: np.ndarray) -> np.ndarray:
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


def _singly(curve: ProfileCurve, fit: FitMethod, tolerance: float) -> list[float]:
    """Each span searched from the end of the one before."""
    s, found = 0.0, []
    while s < curve.length * (1.0 - SLIVER):
        found.append(s)
        s += float(longest(curve, fit, np.array([s]), tolerance, end=curve.length)[0])
    return found


def fewest(curve: ProfileCurve, fit: FitMethod, tolerance: float, most: int) -> np.ndarray:
    """Arc lengths (n,) [mm] of the fewest points, the first at cam angle 0, between which the fit keeps the tolerance [mm].

    Few are searched one after the other. Of many the longest spans are searched for many places at once; points taken from them are
    places for the next round, until they stand where the spans were searched. Spans that still exceed the tolerance, over joins,
    are then searched singly.
    Raises TooMany where it takes more than ``most``.
    """
    allowed = tolerance / (1.0 + 3.0 * ROUNDING) - curve.error
    kept = allowed / (1.0 + 4.0 * WINDOW)  # by spans between which others are interpolated
    end = curve.length
    places = np.linspace(0.0, end, GRID, endpoint=False)
    spans = longest(curve, fit, places, kept)
    with np.errstate(divide="ignore"):
        count = float((end / GRID / spans).sum())
    if not count <= most:
        raise TooMany(int(min(count, 1e12)))
    if count <= SINGLY:
        return np.array(_singly(curve, fit, kept))
    for _ in range(ROUNDS):
        points = np.array(_walk(places, spans, 0.0, end))
        spans = _longest(
            curve, fit, points, kept, np.interp(points, np.append(places, end), np.append(spans, spans[0]))
        )
        places = points
    found = _walk(places, spans, 0.0, end)
    good = 0  # so many spans have been checked
    while good < len(found):
        nodes = np.array(
            found[good : good + CHECKED] + ([end] if good + CHECKED >= len(found) else found[good + CHECKED :][:1])
        )
        bad = np.flatnonzero(of_spans(curve, fit, nodes[:-1], np.diff(nodes)) > allowed)
        if not bad.size:
            good += nodes.size - 1
            continue
        good += int(bad[0]) + 1
        span = longest(curve, fit, np.array(found[good - 1 : good]), kept, end=end)
        begin = found[good - 1] + float(span[0])
        places, spans = _anew(curve, fit, places, spans, begin, kept)
        found = [*found[:good], *_walk(places, spans, begin, end)]
    return np.array(found)


def _anew(
    curve: ProfileCurve, fit: FitMethod, places: np.ndarray, spans: np.ndarray, begin: float, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Places and their spans, from ``begin`` on some of them replaced by those where points from there would stand."""
    points = np.array(_walk(places, spans, begin, curve.length)[:CHECKED])
    if not points.size:
        return places, spans
    guess = np.interp(points, np.append(places, curve.length), np.append(spans, spans[0]))
    before, after = places < points[0], places > points[-1]
    found = longest(curve, fit, points, tolerance, guess)
    return np.concatenate((places[before], points, places[after])), np.concatenate((spans[before], found, spans[after]))
