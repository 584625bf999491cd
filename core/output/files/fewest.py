"""The fewest points that keep a tolerance: from cam angle 0 on always the longest span that keeps it.

Where a part of a span deviates no more than the whole, no other choice of points from cam angle 0 on needs fewer.
"""

from __future__ import annotations

import numpy as np

from core.numerics.lazy import checkpoint
from core.output.files.profile_curve import ProfileCurve
from core.output.files.profile_fit import CurveChain, FitMethod

# -- how far what a file describes is from the exact curve ------------------------------------------------------


INSIDE = (np.arange(17) + 0.5) / 17  # where a span is looked at first
CLOSER = np.linspace(0.0, 1.0, 9)  # where between neighbours of the highest
PASSES = 5
REFINED_AT_ONCE = 64  # spans that are refined together
NEIGHBOURS = 8  # spans on either side which a point may be nearer to than to its own
BLOCK = 4096  # spans that are sampled together
ROUNDING = 1e-5  # relative: what refining may leave


def of_spans(curve: ProfileCurve, fit: FitMethod, begin: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Largest distance (m,) [mm] between the curve over spans (m,) that begin so far along it [mm] and are so long, and the
    pieces that the fit puts there: of samples, and of the parabola through the highest."""
    pieces = fit.pieces(curve.ends(begin), curve.ends(begin + length))
    return _own(curve, pieces, np.arange(begin.size), begin, length)


def _own(curve: ProfileCurve, chain: CurveChain, span: np.ndarray, begin: np.ndarray, length: np.ndarray) -> np.ndarray:
    """The same of spans (m,) of a chain: of samples, of samples about the highest, of the parabola through the highest."""
    rows = np.arange(span.size)
    part, highest = np.broadcast_to(INSIDE, (span.size, INSIDE.size)), np.zeros(span.size)
    for _ in range(2):
        off = chain.distance(span, curve.at(begin[:, None] + part * length[:, None]), part)
        top = np.argmax(off, axis=1)
        highest = np.maximum(highest, off[rows, top])
        part = _around(part, top)
    return np.maximum(highest, _vertex(off, np.clip(top, 1, CLOSER.size - 2)))


def _around(part: np.ndarray, top: np.ndarray) -> np.ndarray:
    """Places closer together, up to the neighbours of the highest of each row (m, k)."""
    place, step = part[np.arange(top.size), top], part[:, 1] - part[:, 0]
    low, high = np.clip(place - step, 0.0, 1.0), np.clip(place + step, 0.0, 1.0)
    return np.asarray(low[:, None] + (high - low)[:, None] * CLOSER)


def _vertex(value: np.ndarray, top: np.ndarray) -> np.ndarray:
    """Of the parabola through the sample at ``top`` of each row and its neighbours (m,); the sample's own where it has none
    between them."""
    rows = np.arange(top.size)
    left, middle, right = value[rows, top - 1], value[rows, top], value[rows, top + 1]
    bend, slope = left - 2.0 * middle + right, right - left
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where((bend < 0.0) & (np.abs(slope) <= -2.0 * bend), -0.125 * slope * slope / bend, 0.0)
    return np.asarray(middle + rise)


def largest(curve: ProfileCurve, chain: CurveChain, nodes: np.ndarray) -> tuple[float, float]:
    """The largest distance [mm] of any point of the curve from the whole chain, whose n spans begin at the arc lengths
    ``nodes`` (n,) [mm] and end at the next: true to within ``ROUNDING``, and never less than it is; and its arc length [mm].

    The spans are refined in the order of what their own pieces say, which is never too little, as long as that may be the
    largest; where points are few, other spans' pieces may be nearer than a point's own.
    """
    count = nodes.size
    length = np.diff(np.append(nodes, nodes[0] + curve.length))
    own = np.empty(count)
    for first in range(0, count, BLOCK):
        checkpoint()
        span = np.arange(first, min(first + BLOCK, count))
        own[span] = _own(curve, chain, span, nodes[span], length[span])
    best = (0.0, 0.0)
    order = np.argsort(-own, kind="stable")
    for first in range(0, count, REFINED_AT_ONCE):
        span = order[first : first + REFINED_AT_ONCE]
        if own[span[0]] <= best[0]:
            break
        checkpoint()
        best = max(best, _refined(curve, chain, nodes, length, span))
    return best[0] * (1.0 + ROUNDING) + curve.error, best[1]


def _refined(
    curve: ProfileCurve, chain: CurveChain, nodes: np.ndarray, length: np.ndarray, span: np.ndarray
) -> tuple[float, float]:
    """The largest distance of points of the spans (m,) from the chain, and the arc length where it is."""
    count = nodes.size
    reach = min(NEIGHBOURS, count // 2)
    others = np.mod(span[:, None] + np.arange(-reach, reach + 1), count)
    part = np.broadcast_to(INSIDE, (span.size, INSIDE.size))
    rows = np.arange(span.size)
    best, place = np.zeros(span.size), np.zeros(span.size)
    for _ in range(PASSES):
        z = curve.at(nodes[span, None] + part * length[span, None])
        off = np.full(z.shape, np.inf)
        for other in others.T:
            # a point before its own span is nearest to another's end, one behind it to another's start
            guess = np.where((other == span)[:, None], part, 0.5)
            np.minimum(off, chain.distance(other, z, guess), out=off)
        top = np.argmax(off, axis=1)
        place = np.where(off[rows, top] > best, part[rows, top], place)
        np.maximum(best, off[rows, top], out=best)
        part = _around(part, top)
    row = int(np.argmax(best))
    return float(best[row]), float(nodes[span[row]] + place[row] * length[span[row]])


# -- the fewest points that keep a tolerance --------------------------------------------------------------------


GRID = 64  # places from which spans are first tried
TRIED = np.linspace(0.0, 1.0, 25)[1:]  # lengths of spans, parts of the longest, that are tried first
STEPS = 60  # of a search for the longest span, at most
WINDOW = 2e-5  # relative: a deviation so little below the tolerance is at it
SLIVER = 1e-9  # of the curve: the last span is not left so short
NARROW = 1e-7  # relative width of the bracket at which a search ends
SINGLY = 100  # so few spans are searched one after the other
ROUNDS = 4  # of points from spans that begin near them
SPANS_AT_ONCE = 2048  # spans that are searched together
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
    parts = range(0, begin.size, SPANS_AT_ONCE)
    return np.concatenate(
        [longest(curve, fit, begin[i : i + SPANS_AT_ONCE], tolerance, guess[i : i + SPANS_AT_ONCE]) for i in parts]
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
