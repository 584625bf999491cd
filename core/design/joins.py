"""Joins of a motion and how they are moved: join k is where segment k begins, join 0 stands at cam angle 0 and 360.

A moved join takes what lies on it along and leaves every other join alone: the segments on both sides grow and shrink,
the ends of a dwell keep one level, and what a spline states of cam angles and levels stays true.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from core.design.edits import balance, is_dwell
from core.design.parts import Motion, Segment, SplineCurve, SplinePoint

LEAST_SPAN = 0.5
"""Degrees that a segment keeps when one of its joins is drawn towards the other."""

_ON = 1e-9  # a point of a spline this close to an end of its segment [deg] belongs to the join there


def join_angles(motion: Motion) -> tuple[float, ...]:
    """Cam angle of each join [deg], the first one 0."""
    return tuple(balance(0.0, (-s.span_deg for s in motion.segments[:k])) for k in range(len(motion.segments)))


def join_levels(motion: Motion) -> tuple[float, ...]:
    """Where the follower stands at each join, in the motion's unit."""
    return tuple(balance(motion.start, (-s.rise for s in motion.segments[:k])) for k in range(len(motion.segments)))


def joins_of_level(motion: Motion, join: int) -> frozenset[int]:
    """The joins that dwells keep at one level with this one, and itself."""
    count = len(motion.segments)
    held = {join}
    for step, before in ((1, 0), (-1, -1)):
        at = join
        while is_dwell(motion.segments[(at + before) % count]) and (at + step) % count not in held:
            at = (at + step) % count
            held.add(at)
    return frozenset(held)


def join_range(motion: Motion, join: int, least: float = LEAST_SPAN) -> tuple[float, float]:
    """The cam angles [deg] between which a join can be moved: both segments keep ``least`` degrees, and so does what
    lies between the join and the next point of a spline. Join 0 stays at 0."""
    if join == 0:
        return 0.0, 0.0
    before, after = motion.segments[join - 1], motion.segments[join]
    here = join_angles(motion)[join]
    low = here - before.span_deg + max((p.at_deg for p in _inner(before)), default=0.0) + least
    high = here + min((p.at_deg for p in _inner(after)), default=after.span_deg) - least
    return min(balance(low, ()), here), max(balance(high, ()), here)


def with_join_moved(motion: Motion, join: int, angle: float | None = None, level: float | None = None) -> Motion:
    """A join put at a cam angle [deg] and a level [the motion's unit]; None leaves that as it is.

    The angle of join 0 stays 0; its level is the start of the motion. It may have faults where the angle is out of
    ``join_range`` or a law cannot rise that way.
    """
    if angle is not None and join > 0 and angle != join_angles(motion)[join]:
        motion = _turned(motion, join, angle)
    if level is not None and level != join_levels(motion)[join]:
        motion = _lifted(motion, join, level)
    return motion


def _turned(motion: Motion, join: int, angle: float) -> Motion:
    segments = list(motion.segments)
    before, after = segments[join - 1], segments[join]
    span = balance(angle, (s.span_deg for s in segments[: join - 1]))
    by = balance(span, (before.span_deg,))
    segments[join - 1] = _with_points(
        replace(before, span_deg=span),
        lambda p: replace(p, at_deg=span) if _at_end(p, before.span_deg) else p,
    )
    left = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i != join))
    segments[join] = _with_points(
        replace(after, span_deg=left),
        # the one at the far end must not miss it by rounding
        lambda p: (
            p
            if p.at_deg <= _ON
            else replace(p, at_deg=left if _at_end(p, after.span_deg) else balance(p.at_deg, (by,)))
        ),
    )
    return replace(motion, segments=tuple(segments))


def _lifted(motion: Motion, join: int, level: float) -> Motion:
    by = balance(level, (join_levels(motion)[join],))
    lifted = joins_of_level(motion, join)
    segments = list(motion.segments)
    leaving = None
    for i, segment in enumerate(segments):
        start, end = i in lifted, (i + 1) % len(segments) in lifted
        if end and not start:
            segments[i] = _with_points(
                replace(segment, rise=balance(segment.rise, (-by,))),
                partial(_raised_at_end, span=segment.span_deg, by=by),
            )
        elif start and not end:
            leaving = i
            segments[i] = _with_points(segment, lambda p: p if p.at_deg <= _ON else _raised(p, -by))
    if leaving is not None:
        left = balance(motion.gain, (s.rise for i, s in enumerate(segments) if i != leaving))
        segments[leaving] = replace(segments[leaving], rise=left)
    start_level = balance(motion.start, (-by,)) if 0 in lifted else motion.start
    return replace(motion, start=start_level, segments=tuple(segments))


def _inner(segment: Segment) -> list[SplinePoint]:
    """The points of a spline that lie on neither of its ends."""
    if not isinstance(segment.curve, SplineCurve):
        return []
    return [p for p in segment.curve.points if p.at_deg > _ON and not _at_end(p, segment.span_deg)]


def _at_end(point: SplinePoint, span: float) -> bool:
    return point.at_deg >= span - _ON


def _raised(point: SplinePoint, by: float) -> SplinePoint:
    return point if point.value is None else replace(point, value=balance(point.value, (-by,)))


def _raised_at_end(point: SplinePoint, span: float, by: float) -> SplinePoint:
    return _raised(point, by) if _at_end(point, span) else point


def _with_points(segment: Segment, change: Callable[[SplinePoint], SplinePoint]) -> Segment:
    """The segment with every point of its spline changed; any other curve stays."""
    curve = segment.curve
    if not isinstance(curve, SplineCurve):
        return segment
    return replace(segment, curve=replace(curve, points=tuple(map(change, curve.points))))


__all__ = ["LEAST_SPAN", "join_angles", "join_levels", "join_range", "joins_of_level", "with_join_moved"]
