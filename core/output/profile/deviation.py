"""How far what a file describes is from the exact curve: the largest distance, refined."""

from __future__ import annotations

import numpy as np

from core.numerics.cancellation import checkpoint
from core.output.profile.curve import ProfileCurve
from core.output.profile.fits import CurveChain, FitMethod

INSIDE = (np.arange(17) + 0.5) / 17  # where a span is looked at first
CLOSER = np.linspace(0.0, 1.0, 9)  # where between neighbours of the highest
PASSES = 5
AT_ONCE = 64  # spans that are refined together
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
    for first in range(0, count, AT_ONCE):
        span = order[first : first + AT_ONCE]
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
