"""Edits that ask where a curve stands: a segment cut at a cam angle, followed by a copy of itself, or a spline that
gets one more point.

Two made of one share its span, so that no other join moves and the follower comes back as before.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import floor

import numpy as np

from core.design import (
    AT_REST,
    Curve,
    Design,
    Motion,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
    join_angles,
    join_levels,
    require_motion,
    stretched,
    with_motion,
)
from core.design.edits import balance, is_dwell
from core.design.motion_edits import with_marks_of
from core.errors import DesignError, Fault
from core.laws import LAWS, PieceTable, find_law
from core.motion.curves import segment_shape, with_joined_ends

LEAST_CUT = 1e-3
"""Degrees that both parts of a cut segment must have; where one had less the segment is cut in its middle."""

_SAME = 1e-9  # a point of a spline this close to the cut [deg] lies on it


def cut_at(motion: Motion, index: int, angle: float | None = None) -> float:
    """Where a segment is cut [deg of cam angle]: at ``angle`` where that lies inside of it, else in its middle."""
    begin, span = join_angles(motion)[index], motion.segments[index].span_deg
    if angle is not None and begin + LEAST_CUT < angle < begin + span - LEAST_CUT:
        return angle
    return balance(begin, (-span / 2.0,))


def with_segment_split(motion: Motion, index: int, angle: float | None = None) -> Motion:
    """A segment cut in two at a cam angle [deg]; None, or one outside of it: in its middle.

    The follower stands at the cut where it stood before. A dwell, constant velocity, a polynomial and a spline go on
    exactly as before; the parts of any other law are two segments of that law, each from rest to rest where the law
    is, for a part of its curve is no law of the table. Raises NoSpline where the points of a spline contradict.
    """
    segment = motion.segments[index]
    begin, whole_turn = join_angles(motion)[index], len(motion.segments) == 1
    first = balance(cut_at(motion, index, angle), (begin,))
    state = _state(motion, index, first)
    rise = state[0] if _goes_on(segment) else balance(state[0], ())
    if whole_turn and isinstance(segment.curve, SplineCurve):
        segment = _as_part_of_a_turn(segment, _state(motion, index, 0.0))
    curves = _cut_curves(segment, first, rise, state)
    return _with_two(motion, index, (first, rise), curves)


def with_segment_copied(motion: Motion, index: int) -> Motion:
    """A copy behind a segment: both have half of its span and half of its rise, so the shape comes twice and the
    follower stands at the end where it stood before. Where the segment ends at the level it began at, each copy has
    its whole height. Raises NoSpline where the points of a spline contradict."""
    segment = motion.segments[index]
    if len(motion.segments) == 1 and isinstance(segment.curve, SplineCurve):
        segment = _as_part_of_a_turn(segment, _state(motion, index, 0.0))
    height = 0.5 if segment.rise else 1.0
    curve = stretched(segment.curve, 0.5, height)
    return _with_two(motion, index, (balance(segment.span_deg / 2.0, ()), segment.rise * height), (curve, curve))


def split_segment(design: Design, index: int, angle: float | None = None) -> Design:
    """``with_segment_split`` in a design: what is assumed of the segment is assumed of both parts."""
    return _doubled(design, with_segment_split(require_motion(design), index, angle), index)


def copy_segment(design: Design, index: int) -> Design:
    """``with_segment_copied`` in a design: what is assumed of the segment is assumed of its copy."""
    return _doubled(design, with_segment_copied(require_motion(design), index), index)


def _doubled(design: Design, motion: Motion, index: int) -> Design:
    old = range(len(require_motion(design).segments))
    return with_marks_of(with_motion(design, motion), [*old[: index + 1], index, *old[index + 1 :]])


def add_point(design: Design, index: int, angle: float | None = None) -> Design:
    """A point more for the spline of a segment, where it runs already: nothing moves until the point is moved. At a
    cam angle [deg] inside of the segment; None, or where a point stands already: in the middle of the longest stretch
    without one. Raises NoSpline where its points contradict."""
    motion = require_motion(design)
    segment = motion.segments[index]
    assert isinstance(segment.curve, SplineCurve)
    points = segment.curve.points
    at = -1.0 if angle is None else balance(angle, (join_angles(motion)[index],))
    taken = sorted({0.0, segment.span_deg, *(p.at_deg for p in points)})
    if not 0.0 < at < segment.span_deg or min(abs(at - place) for place in taken) < LEAST_CUT:
        begin, end = max(pairwise(taken), key=lambda gap: gap[1] - gap[0])
        at = balance(begin, (-(end - begin) / 2.0,))
    point = SplinePoint(at, balance(_state(motion, index, at)[0], ()))
    curve = replace(segment.curve, points=tuple(sorted((*points, point), key=lambda p: p.at_deg)))
    segments = (*motion.segments[:index], replace(segment, curve=curve), *motion.segments[index + 1 :])
    return with_motion(design, replace(motion, segments=segments))


# -- begun elsewhere in the turn ------------------------------------------------------------------------------


def shift_motion(design: Design, by_deg: float) -> Design:
    """The design whose motion does the same so much later [deg]: y(θ - by). The segment in which the turn then begins is cut in two, and
    dwells that meet are one. Raises DesignError where it cannot be cut, for parts of its law are no laws of the table."""
    motion = require_motion(design)
    at = balance(360.0, (by_deg % 360.0,)) % 360.0
    begins, numbers = join_angles(motion), list(range(len(motion.segments)))
    index = max(i for i, begin in enumerate(begins) if begin <= at + _SAME)
    if at - begins[index] > _SAME:
        segment = motion.segments[index]
        if not _goes_on(segment) and not is_dwell(segment):
            end = balance(begins[index], (-segment.span_deg,))
            problem = f"begins the turn at {at:g} deg, within segment {index + 1}, whose law has no parts"
            raise DesignError(
                [
                    Fault(
                        "motion.shift",
                        f"{by_deg:g} deg",
                        problem,
                        f"a turn that begins at {begins[index]:g} or {end:g} deg, or in a dwell",
                    )
                ]
            )
        motion = with_segment_split(motion, index, at)
        numbers.insert(index, index)
        index += 1
    if index == 0:
        return design
    before = floor(-by_deg / 360.0)  # whole turns, each of an advance
    start = balance(join_levels(motion)[index], (-before * motion.gain,))
    segments = [*motion.segments[index:], *motion.segments[:index]]
    numbers = [*numbers[index:], *numbers[:index]]
    meet = len(motion.segments) - index  # where the turn began before
    if is_dwell(segments[meet - 1]) and is_dwell(segments[meet]):
        span = balance(segments[meet - 1].span_deg, (-segments[meet].span_deg,))
        segments[meet - 1 : meet + 1] = [replace(segments[meet - 1], span_deg=span)]
        del numbers[meet]
    return with_marks_of(with_motion(design, replace(motion, start=start, segments=tuple(segments))), numbers)


# -- parts ------------------------------------------------------------------------------------------------


def _with_two(motion: Motion, index: int, first: tuple[float, float], curves: tuple[Curve, Curve]) -> Motion:
    """A segment replaced by two; first: span and rise of the first one."""
    whole = motion.segments[index]
    parts = [Segment(*first, curves[0]), Segment(0.0, whole.rise - first[1], curves[1])]
    segments = [*motion.segments[:index], *parts, *motion.segments[index + 1 :]]
    span = balance(360.0, (s.span_deg for s in segments))
    segments[index] = replace(parts[0], curve=_ending(curves[0], first[0], first[0]))
    segments[index + 1] = replace(parts[1], span_deg=span, curve=_ending(curves[1], whole.span_deg - first[0], span))
    return replace(motion, segments=tuple(segments))


def _ending(curve: Curve, meant: float, span: float) -> Curve:
    """The points on the end of a spline put where the end comes to lie by rounding."""
    if not isinstance(curve, SplineCurve):
        return curve
    return replace(
        curve, points=tuple(replace(p, at_deg=span) if abs(p.at_deg - meant) <= _SAME else p for p in curve.points)
    )


def _state(motion: Motion, index: int, at_deg: float) -> tuple[float, float, float, float]:
    """s, v, a, j of a segment at an angle from its start: the motion's unit, per degree; s from its start. They go into designs, so
    they are plain numbers."""
    segment = motion.segments[index]
    shape = segment_shape(with_joined_ends(motion, index), len(motion.segments) == 1, f"motion.segments[{index}]")
    y = PieceTable(shape.pieces).at(np.array([at_deg / segment.span_deg])).all[:, 0]
    s, v, a, j = (shape.gain * y / segment.span_deg ** np.arange(4)).tolist()
    return s, v, a, j


def _goes_on(segment: Segment) -> bool:
    """A curve whose parts are curves of its own kind."""
    law = find_law(segment.curve.law)
    straight = law is not None and law.pieces == LAWS["constant-velocity"].pieces
    return straight or isinstance(segment.curve, PolynomialCurve | SplineCurve)


def _cut_curves(segment: Segment, at: float, rise: float, state: tuple[float, ...]) -> tuple[Curve, Curve]:
    """The curves of both parts of a segment cut ``at`` degrees from its start, where s, v, a, j are ``state``."""
    curve = segment.curve
    _, v, a, j = state
    if isinstance(curve, PolynomialCurve):
        # of degree 5 to 7: as many conditions as the whole had, and so the same polynomial again
        return (
            PolynomialCurve(curve.start, PolynomialEnd(v, a, None if curve.end.jerk is None else j)),
            PolynomialCurve(PolynomialEnd(v, a, None if curve.start.jerk is None else j), curve.end),
        )
    if isinstance(curve, SplineCurve):
        # each part of a curve of least jerk is the curve of least jerk between its ends (Bellman)
        before = [p for p in curve.points if p.at_deg < at - _SAME]
        after = [p for p in curve.points if p.at_deg > at + _SAME]
        moved = [
            SplinePoint(
                balance(p.at_deg, (at,)), None if p.value is None else p.value - rise, p.velocity, p.acceleration
            )
            for p in after
        ]
        if isinstance(curve, TableCurve):  # whose rows have values, and which is joined to nothing else here
            return (
                replace(curve, points=(*before, SplinePoint(at, rise, v, a)), end=AT_REST),
                replace(curve, points=(SplinePoint(0.0, 0.0, v, a), *moved), start=AT_REST),
            )
        ends = SplinePoint(at, None, v, a), SplinePoint(0.0, None, v, a)
        return replace(curve, points=(*before, ends[0])), replace(curve, points=(ends[1], *moved))
    return curve, curve


def _as_part_of_a_turn(segment: Segment, state: tuple[float, ...]) -> Segment:
    """A spline over the whole turn, which joins itself, with its state at its join stated at both ends: a part of a
    turn would start and end at rest."""
    assert isinstance(segment.curve, SplineCurve)
    s, v, a, _ = state
    inner = tuple(p for p in segment.curve.points if _SAME < p.at_deg < segment.span_deg - _SAME)
    # at its start it stands at its start, where nothing else is stated
    value = s if isinstance(segment.curve, TableCurve) else s or None
    ends = (SplinePoint(0.0, value, v, a), SplinePoint(segment.span_deg, value, v, a))
    return replace(segment, curve=replace(segment.curve, points=(ends[0], *inner, ends[1])))


__all__ = [
    "add_point",
    "copy_segment",
    "cut_at",
    "shift_motion",
    "split_segment",
    "with_segment_copied",
    "with_segment_split",
]
