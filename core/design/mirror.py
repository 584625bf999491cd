"""The mirror image of a stroke in time: a return that runs the rise backwards, or the other way round.

A stroke is a run of segments that move one way without a rest between them, so a blend of several curves is one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import fsum
from types import MappingProxyType

from core.design.edits import back_at_start, balance, is_dwell, stretched, times
from core.design.joins import LEAST_SPAN, join_levels
from core.design.parts import (
    Curve,
    Motion,
    NamedCurve,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
)
from core.frozen import frozen
from core.laws import find_law

CLOSE = 1e-9  # a level this near to where it was is where it was

_PAIRS = ("c1 c4", "c2 c3", "c5 c6", "h1 h4", "h2 h3", "h5 h6", "p1 p2", "cv1 cv2")
MIRRORS: Mapping[str, str] = MappingProxyType(
    {a: b for pair in _PAIRS for a, b in (pair.split(), reversed(pair.split()))}
)
"""Law -> the law that is its mirror image; a law of two like halves is its own, and any other has none."""


def has_image(curve: Curve) -> bool:
    """Whether the curve run backwards is a curve that can be named."""
    law = find_law(curve.law)
    return law is None or law.is_dwell or law.slug in MIRRORS or law.symmetric


def mirrored(segment: Segment) -> Segment:
    """The segment run backwards: y(θ) becomes y(span - θ), so its rise turns round. Its curve must have an image."""
    return Segment(segment.span_deg, 0.0 - segment.rise, _mirrored_curve(segment))


def _mirrored_curve(segment: Segment) -> Curve:
    curve = segment.curve
    if isinstance(curve, NamedCurve):
        return NamedCurve(MIRRORS.get(curve.law, curve.law), balance(1.0, (curve.crossover,)), curve.flat_fraction)
    if isinstance(curve, PolynomialCurve):
        return PolynomialCurve(_backwards(curve.end), _backwards(curve.start))
    if isinstance(curve, SplineCurve):
        points = [
            SplinePoint(
                balance(segment.span_deg, (p.at_deg,)),
                None if p.value is None else balance(p.value, (segment.rise,)),
                times(p.velocity, -1.0),
                p.acceleration,
            )
            for p in reversed(curve.points)
        ]
        if isinstance(curve, TableCurve):
            return TableCurve(tuple(points), start=curve.end, end=curve.start)
        return replace(curve, points=tuple(points))
    return curve  # sine, constant and cosine acceleration are symmetric


def _backwards(end: PolynomialEnd) -> PolynomialEnd:
    return PolynomialEnd(0.0 - end.velocity, end.acceleration, times(end.jerk, -1.0))


# -- strokes ----------------------------------------------------------------------------------------------


@frozen
class _Turn:
    """The segments in the order of the turn, begun with a stroke: the stroke itself, what lies between it and the next
    stroke the other way, that stroke, and what is behind; each a list of numbers of segments."""

    own: list[int]
    between: list[int]
    other: list[int]
    behind: list[int]


def _direction(segment: Segment) -> int:
    return 0 if is_dwell(segment) or segment.rise == 0.0 else 1 if segment.rise > 0.0 else -1


def _turn_from(motion: Motion, index: int) -> _Turn | None:
    """None where the segment is in no stroke, no stroke goes the other way, or a curve of it has no image."""
    directions = [_direction(s) for s in motion.segments]
    count, direction = len(directions), directions[index]
    if direction == 0 or -direction not in directions:
        return None
    first = index
    while directions[first - 1] == direction:
        first = (first - 1) % count
    order = [(first + k) % count for k in range(count)]
    own = next(k for k in range(count) if directions[order[k]] != direction)
    there = next(k for k in range(own, count) if directions[order[k]] == -direction)
    end = next((k for k in range(there, count) if directions[order[k]] != -direction), count)
    if not all(has_image(motion.segments[i].curve) for i in order[:own]):
        return None
    return _Turn(order[:own], order[own:there], order[there:end], order[end:])


def stroke_mirrored(motion: Motion, index: int) -> tuple[Motion, list[int]]:
    """The next stroke the other way (cyclic) becomes the mirror image of the one that the segment is part of: its
    curves backwards in time, its spans, its rises turned round; and for each segment of the new motion the number of the
    one that it, or whose image it, was.

    What the image takes more or less of the turn comes from the segment behind it, else from the one before it, else
    from all others alike; where that is not enough, both strokes share the span they have. Other strokes, where there
    are any, bring the follower back. The same motion where there is nothing to mirror.
    """
    turn = _turn_from(motion, index)
    segments = list(motion.segments)
    if turn is None:
        return motion, list(range(len(segments)))
    level = join_levels(motion)[turn.own[0]]
    image = [mirrored(segments[i]) for i in reversed(turn.own)]
    segments, image = _with_room(segments, turn, image)

    # in the order of the turn: segments, and the numbers they come from
    rows = [(segments[i], i) for i in turn.own + turn.between]
    rows += zip(image, reversed(turn.own), strict=True)
    rows += [(segments[i], i) for i in turn.behind]
    if balance(motion.gain, (s.rise for s, _ in rows)):
        others = [k for part in (turn.behind, turn.between) for k, (_, i) in enumerate(rows) if i in part]
        closed = back_at_start([s for s, _ in rows], others, motion.gain)
        rows = [(s, i) for s, (_, i) in zip(closed, rows, strict=True)]
    first = _first_of(turn, len(image)) % len(rows)
    rows = rows[first:] + rows[:first]
    made = tuple(s for s, _ in rows)
    ahead = len(rows) - first if first else 0  # segments before the stroke
    start = balance(level, (s.rise for s in made[:ahead]))
    start = motion.start if abs(start - motion.start) < CLOSE else start
    return replace(motion, start=start, segments=made), [i for _, i in rows]


def _first_of(turn: _Turn, image: int) -> int:
    """Where cam angle 0 comes to stand in the new order: before what it stood before, or within the image."""
    at = (turn.own + turn.between + turn.other + turn.behind).index(0)
    there = len(turn.own) + len(turn.between)
    if at <= there:
        return at
    if at < there + len(turn.other):
        return there + min(at - there, image)
    return at + image - len(turn.other)


def _with_room(segments: list[Segment], turn: _Turn, image: list[Segment]) -> tuple[list[Segment], list[Segment]]:
    """The segments, and the image, with spans that make a turn once the image stands in the place of the other
    stroke."""
    own, others = turn.own, turn.behind + turn.between
    more = balance(_total(segments, own), (_total(segments, turn.other),))
    if more == 0.0:
        return segments, image
    giver = _giver(segments, turn, more)
    if giver is not None:
        return with_total_span(segments, [giver], balance(segments[giver].span_deg, (more,))), image
    room = balance(_total(segments, others), (more,))
    if others and room >= LEAST_SPAN * len(others):
        return with_total_span(segments, others, room), image
    segments = with_total_span(segments, own, balance((360.0 - _total(segments, others)) / 2.0, ()))
    return segments, [mirrored(segments[i]) for i in reversed(own)]


def _giver(segments: Sequence[Segment], turn: _Turn, more: float) -> int | None:
    """The neighbour of the image that gives or takes the difference: one that leaves the stroke at its cam angle, if
    it can be helped."""
    able = [i for i in (turn.behind[:1] + turn.between[-1:]) if segments[i].span_deg - more >= LEAST_SPAN]
    first = turn.own[0]
    return next((i for i in able if (i < first) == (turn.other[0] < first)), able[0] if able else None)


def _total(segments: Sequence[Segment], which: Sequence[int]) -> float:
    """Degrees that these segments take together."""
    return fsum(segments[i].span_deg for i in which)


def with_total_span(segments: Sequence[Segment], which: Sequence[int], total: float) -> list[Segment]:
    """The segments, some of them stretched alike so that they take ``total`` degrees together."""
    made, by = list(segments), total / _total(segments, which)
    for i in which:
        others = (made[j].span_deg for j in which[:-1])
        span = balance(total, others) if i == which[-1] else balance(made[i].span_deg * by, ())
        made[i] = replace(made[i], span_deg=span, curve=stretched(made[i].curve, span / made[i].span_deg, 1.0))
    return made


__all__ = ["MIRRORS", "has_image", "mirrored", "stroke_mirrored", "with_total_span"]
