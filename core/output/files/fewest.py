"""The fewest points that keep a tolerance: starting from cam angle 0, always the longest span that keeps it.

Where a part of a span deviates no more than the full span, no other choice of points from cam angle 0 on needs fewer.
"""

from __future__ import annotations

import numpy as np

from core.numerics.lazy import checkpoint
from core.output.files.profile_curve import ProfileCurve
from core.output.files.profile_fit import CurveChain, FitMethod

# -- deviation of the curve in a file from the exact curve ------------------------------------------------------


SAMPLES = (np.arange(17) + 0.5) / 17  # positions in a span that are sampled first
FINE_SAMPLES = np.linspace(0.0, 1.0, 9)  # between the neighbours of the sample with the largest distance
PASSES = 5
REFINED_AT_ONCE = 64  # spans that are refined together
NEIGHBOURS = 8  # spans on either side that a point may be nearer to than to the span that it belongs to
BLOCK = 4096  # spans that are sampled together
ROUNDING = 1e-5  # relative error that refining may leave


def span_deviation(curve: ProfileCurve, fit: FitMethod, begin: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Largest distance between the curve and the pieces that a fit puts over given spans of it.

    The largest of samples, and of the parabola through the sample with the largest distance.

    Parameters
    ----------
    curve : ProfileCurve
    fit : FitMethod
    begin : ndarray (m,) [mm]
        Arc lengths at which the spans begin.
    length : ndarray (m,) [mm]
        Lengths of the spans.

    Returns
    -------
    ndarray (m,) [mm]
    """
    pieces = fit.pieces(curve.ends(begin), curve.ends(begin + length))
    return piece_deviation(curve, pieces, np.arange(begin.size), begin, length)


def piece_deviation(
    curve: ProfileCurve, chain: CurveChain, span: np.ndarray, begin: np.ndarray, length: np.ndarray
) -> np.ndarray:
    """Largest distance of parts of the curve from the pieces of a chain over them: sampled twice, then by a parabola.

    Parameters
    ----------
    curve : ProfileCurve
    chain : CurveChain
    span : ndarray (m,), dimensionless
        Indices of the pieces.
    begin : ndarray (m,) [mm]
        Arc lengths at which they begin.
    length : ndarray (m,) [mm]
        Their lengths.

    Returns
    -------
    ndarray (m,) [mm]
    """
    rows = np.arange(span.size)
    part, highest = np.broadcast_to(SAMPLES, (span.size, SAMPLES.size)), np.zeros(span.size)
    for _ in range(2):
        distance = chain.distance(span, curve.at(begin[:, None] + part * length[:, None]), part)
        peak = np.argmax(distance, axis=1)
        highest = np.maximum(highest, distance[rows, peak])
        part = _refine(part, peak)
    return np.maximum(highest, _parabola_top(distance, np.clip(peak, 1, FINE_SAMPLES.size - 2)))


def _refine(part: np.ndarray, peak: np.ndarray) -> np.ndarray:
    """Positions in a span, closer together, between the neighbours of the peak (m,) of each row (m, k)."""
    position, step = part[np.arange(peak.size), peak], part[:, 1] - part[:, 0]
    low, high = np.clip(position - step, 0.0, 1.0), np.clip(position + step, 0.0, 1.0)
    return np.asarray(low[:, None] + (high - low)[:, None] * FINE_SAMPLES)


def _parabola_top(value: np.ndarray, peak: np.ndarray) -> np.ndarray:
    """Largest value (m,) of the parabola through the sample at ``peak`` and its neighbours; else that of the sample."""
    rows = np.arange(peak.size)
    left, middle, right = value[rows, peak - 1], value[rows, peak], value[rows, peak + 1]
    curvature, slope = left - 2.0 * middle + right, right - left
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(
            (curvature < 0.0) & (np.abs(slope) <= -2.0 * curvature), -0.125 * slope * slope / curvature, 0.0
        )
    return np.asarray(middle + rise)


def largest_deviation(curve: ProfileCurve, chain: CurveChain, nodes: np.ndarray) -> tuple[float, float]:
    """Largest distance of any point of the curve from a chain, and where it is.

    It is exact to within ``ROUNDING`` and never too small. The spans are refined in the order of the distance from the
    pieces over them, which is an upper bound, as long as that bound exceeds the largest distance so far; where points are
    few, the piece of a neighbouring span may be nearer.

    Parameters
    ----------
    curve : ProfileCurve
    chain : CurveChain
        Its n pieces, one a span.
    nodes : ndarray (n,) [mm]
        Arc lengths at which the spans begin; each ends where the next begins.

    Returns
    -------
    deviation, arc_length : float [mm]
    """
    count = nodes.size
    length = np.diff(np.append(nodes, nodes[0] + curve.length))
    bound = np.empty(count)
    for first in range(0, count, BLOCK):
        checkpoint()
        span = np.arange(first, min(first + BLOCK, count))
        bound[span] = piece_deviation(curve, chain, span, nodes[span], length[span])
    worst = (0.0, 0.0)
    order = np.argsort(-bound, kind="stable")
    for first in range(0, count, REFINED_AT_ONCE):
        span = order[first : first + REFINED_AT_ONCE]
        if bound[span[0]] <= worst[0]:
            break
        checkpoint()
        worst = max(worst, _refined_deviation(curve, chain, nodes, length, span))
    return worst[0] * (1.0 + ROUNDING) + curve.error, worst[1]


def _refined_deviation(
    curve: ProfileCurve, chain: CurveChain, nodes: np.ndarray, length: np.ndarray, span: np.ndarray
) -> tuple[float, float]:
    """The largest distance of points of the spans (m,) from the chain [mm], and the arc length where it is [mm]."""
    count = nodes.size
    reach = min(NEIGHBOURS, count // 2)
    neighbours = np.mod(span[:, None] + np.arange(-reach, reach + 1), count)
    part = np.broadcast_to(SAMPLES, (span.size, SAMPLES.size))
    rows = np.arange(span.size)
    largest, position = np.zeros(span.size), np.zeros(span.size)
    for _ in range(PASSES):
        z = curve.at(nodes[span, None] + part * length[span, None])
        distance = np.full(z.shape, np.inf)
        for neighbour in neighbours.T:
            guess = np.where((neighbour == span)[:, None], part, 0.5)
            np.minimum(distance, chain.distance(neighbour, z, guess), out=distance)
        peak = np.argmax(distance, axis=1)
        position = np.where(distance[rows, peak] > largest, part[rows, peak], position)
        np.maximum(largest, distance[rows, peak], out=largest)
        part = _refine(part, peak)
    row = int(np.argmax(largest))
    return float(largest[row]), float(nodes[span[row]] + position[row] * length[span[row]])


# -- the fewest points that keep a tolerance --------------------------------------------------------------------


GRID = 64  # starts from which spans are first searched
TRIAL_LENGTHS = np.linspace(0.0, 1.0, 25)[1:]  # parts of the longest possible span that are tried first
STEPS = 60  # of a search for the longest span, at most
WINDOW = 2e-5  # relative: a deviation so little below the tolerance counts as equal to it
SLIVER = 1e-9  # relative to the curve: the last span is longer
NARROW = 1e-7  # relative width of the bracket at which a search ends
SINGLY = 100  # up to this number spans are searched one after the other
ROUNDS = 4  # in which the starts of spans are replaced by the points that follow from them
SPANS_AT_ONCE = 2048  # spans that are searched together
CHECKED_AT_ONCE = 128  # spans that are checked together


class TooManyPoints(Exception):
    """The tolerance requires about ``count`` points, more than allowed."""

    def __init__(self, count: int) -> None:
        super().__init__(count)
        self.count = count


def longest_spans(
    curve: ProfileCurve,
    fit: FitMethod,
    begin: np.ndarray,
    tolerance: float,
    guess: np.ndarray | None = None,
    end: float = np.inf,
) -> np.ndarray:
    """Longest spans that keep a tolerance, none beyond ``end``.

    The deviation grows as a power of the span's length, and a bracket is narrowed as well. Every returned length has been
    tried. Without a guess, spans of all lengths are tried first: a longer one may deviate less than a shorter one.

    Parameters
    ----------
    curve : ProfileCurve
    fit : FitMethod
    begin : ndarray (m,) [mm]
        Arc lengths at which the spans begin.
    tolerance : float [mm]
    guess : ndarray (m,) [mm], optional
        Lengths from which the search starts.
    end : float [mm]
        Arc length that no span exceeds.

    Returns
    -------
    ndarray (m,) [mm]
        Lengths of the spans.
    """
    limit = np.minimum(curve.end_of_turning(begin, fit.most_turning), end) - begin
    low, high = np.zeros(begin.size), np.full(begin.size, np.inf)
    if guess is None:
        lengths = limit[:, None] * TRIAL_LENGTHS
        deviation = span_deviation(curve, fit, np.repeat(begin, TRIAL_LENGTHS.size), lengths.ravel()).reshape(
            lengths.shape
        )
        last = np.where(deviation <= tolerance, np.arange(1, TRIAL_LENGTHS.size + 1), 0).max(axis=1)
        rows = np.arange(begin.size)
        low = np.where(last > 0, lengths[rows, last - 1], 0.0)
        high = np.where(last < TRIAL_LENGTHS.size, lengths[rows, np.minimum(last, TRIAL_LENGTHS.size - 1)], np.inf)
        guess = np.where(np.isfinite(high), 0.5 * (low + high), limit)
    span = np.minimum(guess, limit)
    active = np.arange(begin.size)
    for step in range(STEPS):
        checkpoint()
        tried = span[active]
        deviation = span_deviation(curve, fit, begin[active], tried)
        is_within = deviation <= tolerance
        low[active] = np.where(is_within, tried, low[active])
        high[active] = np.where(is_within, high[active], tried)
        done = is_within & ((deviation >= tolerance * (1.0 - WINDOW)) | (tried >= limit[active]))
        done |= high[active] - low[active] <= NARROW * high[active]
        with np.errstate(divide="ignore"):
            factor = (tolerance * (1.0 - 0.5 * WINDOW) / deviation) ** (1.0 / fit.order)
        tried = np.minimum(tried * np.clip(factor, 0.25, 4.0), limit[active])
        a, b = low[active], high[active]
        halve = np.isfinite(b) & ((tried <= a) | (tried >= b) | (step % 4 == 3))
        span[active] = np.where(halve, 0.5 * (a + b), tried)
        active = active[~done]
        if not active.size:
            break
    return low


def _longest_in_blocks(
    curve: ProfileCurve, fit: FitMethod, begin: np.ndarray, tolerance: float, guess: np.ndarray
) -> np.ndarray:
    """Longest spans (m,) [mm] for any number of starts, computed in blocks."""
    parts = range(0, begin.size, SPANS_AT_ONCE)
    return np.concatenate(
        [
            longest_spans(curve, fit, begin[i : i + SPANS_AT_ONCE], tolerance, guess[i : i + SPANS_AT_ONCE])
            for i in parts
        ]
    )


def _points_along(starts: np.ndarray, spans: np.ndarray, begin: float, end: float) -> list[float]:
    """Points from ``begin`` to below ``end``, each one span behind the last; spans (m,) are given at ``starts`` (m,)."""
    x, y = np.append(starts, end), np.append(spans, spans[0])
    s, points = begin, []
    while s < end * (1.0 - SLIVER):
        points.append(s)
        s += float(np.interp(s, x, y))
        if len(points) % 1000 == 0:
            checkpoint()
    return points


def _search_singly(curve: ProfileCurve, fit: FitMethod, tolerance: float) -> list[float]:
    """Points of which each is the end of the longest span from the last."""
    s, points = 0.0, []
    while s < curve.length * (1.0 - SLIVER):
        points.append(s)
        s += float(longest_spans(curve, fit, np.array([s]), tolerance, end=curve.length)[0])
    return points


def fewest_points(curve: ProfileCurve, fit: FitMethod, tolerance: float, most: int) -> np.ndarray:
    """Arc lengths of the fewest points, the first at cam angle 0, between which a fit keeps a tolerance.

    Up to ``SINGLY`` spans are searched one after the other. For more, the longest spans are searched from many starts at
    once; points interpolated from them are the starts of the next round, until starts and points agree. Spans that still
    exceed the tolerance, at joins of the motion, are then searched singly.

    Parameters
    ----------
    curve : ProfileCurve
    fit : FitMethod
    tolerance : float [mm]
    most : int
        Largest number of points allowed.

    Returns
    -------
    ndarray (n,) [mm]

    Raises
    ------
    TooManyPoints
        The tolerance requires more than ``most`` points.
    """
    allowed = tolerance / (1.0 + 3.0 * ROUNDING) - curve.error
    safe = allowed / (1.0 + 4.0 * WINDOW)  # for spans between which others are interpolated
    end = curve.length
    starts = np.linspace(0.0, end, GRID, endpoint=False)
    spans = longest_spans(curve, fit, starts, safe)
    with np.errstate(divide="ignore"):
        count = float((end / GRID / spans).sum())
    if not count <= most:
        raise TooManyPoints(int(min(count, 1e12)))
    if count <= SINGLY:
        return np.array(_search_singly(curve, fit, safe))
    for _ in range(ROUNDS):
        nodes = np.array(_points_along(starts, spans, 0.0, end))
        guess = np.interp(nodes, np.append(starts, end), np.append(spans, spans[0]))
        starts, spans = nodes, _longest_in_blocks(curve, fit, nodes, safe, guess)
    points = _points_along(starts, spans, 0.0, end)
    checked = 0  # number of spans
    while checked < len(points):
        nodes = np.array(
            points[checked : checked + CHECKED_AT_ONCE]
            + ([end] if checked + CHECKED_AT_ONCE >= len(points) else points[checked + CHECKED_AT_ONCE :][:1])
        )
        bad = np.flatnonzero(span_deviation(curve, fit, nodes[:-1], np.diff(nodes)) > allowed)
        if not bad.size:
            checked += nodes.size - 1
            continue
        checked += int(bad[0]) + 1
        span = longest_spans(curve, fit, np.array(points[checked - 1 : checked]), safe, end=end)
        begin = points[checked - 1] + float(span[0])
        starts, spans = _search_again(curve, fit, starts, spans, begin, safe)
        points = [*points[:checked], *_points_along(starts, spans, begin, end)]
    return np.array(points)


def _search_again(
    curve: ProfileCurve, fit: FitMethod, starts: np.ndarray, spans: np.ndarray, begin: float, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Starts and their spans; from ``begin`` on, some are replaced by searched spans at the points that follow."""
    points = np.array(_points_along(starts, spans, begin, curve.length)[:CHECKED_AT_ONCE])
    if not points.size:
        return starts, spans
    guess = np.interp(points, np.append(starts, curve.length), np.append(spans, spans[0]))
    before, after = starts < points[0], starts > points[-1]
    longest = longest_spans(curve, fit, points, tolerance, guess)
    return np.concatenate((starts[before], points, starts[after])), np.concatenate(
        (spans[before], longest, spans[after])
    )
