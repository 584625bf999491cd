"""Edits that evaluate a segment's curve: split or copy a segment, add a point to a spline, shift the motion.

The two parts share the span of the original, so that no other join moves.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import ceil, floor

import numpy as np

from core.design import (
    AT_REST,
    Curve,
    CurveBound,
    Design,
    Motion,
    OptimalCurve,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
    get,
    join_angles,
    join_levels,
    put,
    require_motion,
    stretched,
    with_motion,
)
from core.design.curves import segment_shape, with_joined_ends
from core.design.edits import balance, is_dwell
from core.design.motion_edits import with_marks_of
from core.errors import DesignError, Fault
from core.laws import LAWS, PieceTable, find_law

LEAST_CUT = 1e-3
"""Least span [deg] of both parts of a split segment; where one would be shorter, the segment is split at its middle."""

_SAME = 1e-9  # [deg] closer angles are equal


def cut_at(motion: Motion, index: int, angle: float | None = None) -> float:
    """Cam angle [deg] at which a segment is split: ``angle`` where it is inside the segment, else the middle."""
    begin, span = join_angles(motion)[index], motion.segments[index].span_deg
    if angle is not None and begin + LEAST_CUT < angle < begin + span - LEAST_CUT:
        return angle
    return balance(begin, (-span / 2.0,))


def with_segment_split(motion: Motion, index: int, angle: float | None = None) -> Motion:
    """Split a segment in two at a cam angle [deg]; at its middle where ``angle`` is None or outside.

    The displacement at the split is unchanged. Dwells, constant velocity, polynomials and splines keep their curve
    exactly; of any other law both parts are segments of that law, from rest to rest where the law is, because a part of
    its curve is no law. Raises NoSpline where the points of a spline contradict each other.
    """
    segment = motion.segments[index]
    begin, whole_turn = join_angles(motion)[index], len(motion.segments) == 1
    first_span = balance(cut_at(motion, index, angle), (begin,))
    state = _state(motion, index, first_span)
    first_rise = state[0] if _has_exact_parts(segment) else balance(state[0], ())
    if whole_turn and _is_least_jerk(segment.curve):
        segment = _with_stated_ends(segment, _state(motion, index, 0.0))
    curves = _cut_curves(segment, first_span, first_rise, state)
    return _replaced_by_two(motion, index, (first_span, first_rise), curves)


def with_segment_copied(motion: Motion, index: int) -> Motion:
    """Replace a segment by two copies, each with half of its span and half of its rise.

    Where the segment has no rise, each copy has its full height. Raises NoSpline where the points of a spline
    contradict each other.
    """
    segment = motion.segments[index]
    if len(motion.segments) == 1 and _is_least_jerk(segment.curve):
        segment = _with_stated_ends(segment, _state(motion, index, 0.0))
    height = 0.5 if segment.rise else 1.0
    curve = stretched(segment.curve, 0.5, height)
    return _replaced_by_two(motion, index, (balance(segment.span_deg / 2.0, ()), segment.rise * height), (curve, curve))


def split_segment(design: Design, index: int, angle: float | None = None) -> Design:
    """Split a segment of a design; assumptions about the segment hold for both parts."""
    return _with_two_segments(design, with_segment_split(require_motion(design), index, angle), index)


def copy_segment(design: Design, index: int) -> Design:
    """Copy a segment of a design; assumptions about the segment hold for its copy."""
    return _with_two_segments(design, with_segment_copied(require_motion(design), index), index)


def _with_two_segments(design: Design, motion: Motion, index: int) -> Design:
    old = range(len(require_motion(design).segments))
    return with_marks_of(with_motion(design, motion), [*old[: index + 1], index, *old[index + 1 :]])


def add_point(design: Design, index: int, angle: float | None = None) -> Design:
    """Add a point on the current curve of a segment's spline; the curve does not change.

    The point is at a cam angle [deg] inside the segment; where ``angle`` is None or a point exists there, it is in the
    middle of the widest gap. Raises NoSpline where the points contradict each other.
    """
    motion = require_motion(design)
    segment = motion.segments[index]
    assert isinstance(segment.curve, SplineCurve)
    points = segment.curve.points
    at = -1.0 if angle is None else balance(angle, (join_angles(motion)[index],))
    occupied = sorted({0.0, segment.span_deg, *(p.at_deg for p in points)})
    if not 0.0 < at < segment.span_deg or min(abs(at - point_deg) for point_deg in occupied) < LEAST_CUT:
        begin, end = max(pairwise(occupied), key=lambda gap: gap[1] - gap[0])
        at = balance(begin, (-(end - begin) / 2.0,))
    new_point = SplinePoint(at, balance(_state(motion, index, at)[0], ()))
    curve = replace(segment.curve, points=tuple(sorted((*points, new_point), key=lambda p: p.at_deg)))
    segments = (*motion.segments[:index], replace(segment, curve=curve), *motion.segments[index + 1 :])
    return with_motion(design, replace(motion, segments=segments))


def add_bound(design: Design, index: int, key: str, angle: float) -> Design:
    """Add an obstacle of an optimal law that its present curve touches, so that it does not change.

    The obstacle ``below`` which the law passes ends at a cam angle [deg], the one ``above`` which it passes begins there; in the
    middle of the segment, where the angle is outside it.
    """
    motion = require_motion(design)
    segment = motion.segments[index]
    at = balance(angle, (join_angles(motion)[index],))
    u = round((at if 0.0 < at < segment.span_deg else 0.5 * segment.span_deg) / segment.span_deg, 3)
    is_below = key == "below"
    rise = _state(motion, index, u * segment.span_deg)[0] / segment.rise
    rise = (ceil(1e3 * rise) if is_below else floor(1e3 * rise)) / 1e3
    bound = CurveBound(0.0, u, rise) if is_below else CurveBound(u, 1.0, rise)
    path = f"motion.segments[{index}].{key}"
    return put(design, path, (*get(design, path), bound))


# -- shifted motion -------------------------------------------------------------------------------------------


def shift_motion(design: Design, by_deg: float) -> Design:
    """Shift a motion to later cam angles: y(θ - by).

    The segment that contains the new start of the turn is split, and adjacent dwells are merged; of a lobe the nose moves.
    Raises DesignError where that segment cannot be split, because parts of its law are no laws.
    """
    motion = require_motion(design)
    if motion.lobe is not None:
        nose = balance(motion.lobe.nose_at_deg, (-by_deg,)) % 360.0
        return with_motion(design, replace(motion, lobe=replace(motion.lobe, nose_at_deg=nose)))
    at = balance(360.0, (by_deg % 360.0,)) % 360.0
    begins, numbers = join_angles(motion), list(range(len(motion.segments)))
    index = max(i for i, begin in enumerate(begins) if begin <= at + _SAME)
    if at - begins[index] > _SAME:
        segment = motion.segments[index]
        if not _has_exact_parts(segment) and not is_dwell(segment):
            end = balance(begins[index], (-segment.span_deg,))
            problem = f"starts the turn at {at:g} deg, inside segment {index + 1}, whose law cannot be split"
            raise DesignError(
                [
                    Fault(
                        "motion.shift",
                        f"{by_deg:g} deg",
                        problem,
                        f"a turn that starts at {begins[index]:g} or {end:g} deg, or in a dwell",
                    )
                ]
            )
        motion = with_segment_split(motion, index, at)
        numbers.insert(index, index)
        index += 1
    if index == 0:
        return design
    before = floor(-by_deg / 360.0)  # full turns, each with an advance
    start = balance(join_levels(motion)[index], (-before * motion.gain,))
    segments = [*motion.segments[index:], *motion.segments[:index]]
    numbers = [*numbers[index:], *numbers[:index]]
    meet = len(motion.segments) - index  # the previous start of the turn
    if is_dwell(segments[meet - 1]) and is_dwell(segments[meet]):
        span = balance(segments[meet - 1].span_deg, (-segments[meet].span_deg,))
        segments[meet - 1 : meet + 1] = [replace(segments[meet - 1], span_deg=span)]
        del numbers[meet]
    return with_marks_of(with_motion(design, replace(motion, start=start, segments=tuple(segments))), numbers)


# -- parts ------------------------------------------------------------------------------------------------


def _replaced_by_two(motion: Motion, index: int, first: tuple[float, float], curves: tuple[Curve, Curve]) -> Motion:
    """Replace a segment by two; ``first``: span and rise of the first part."""
    segment = motion.segments[index]
    parts = [Segment(*first, curves[0], segment.fixed), Segment(0.0, segment.rise - first[1], curves[1], segment.fixed)]
    segments = [*motion.segments[:index], *parts, *motion.segments[index + 1 :]]
    span = balance(360.0, (s.span_deg for s in segments))
    segments[index] = replace(parts[0], curve=_with_exact_end(curves[0], first[0], first[0]))
    segments[index + 1] = replace(
        parts[1], span_deg=span, curve=_with_exact_end(curves[1], segment.span_deg - first[0], span)
    )
    return replace(motion, segments=tuple(segments))


def _with_exact_end(curve: Curve, rounded: float, span: float) -> Curve:
    """A spline whose points at the end of the segment have exactly the end's angle, which rounding may have changed."""
    if not isinstance(curve, SplineCurve):
        return curve
    return replace(
        curve, points=tuple(replace(p, at_deg=span) if abs(p.at_deg - rounded) <= _SAME else p for p in curve.points)
    )


def _state(motion: Motion, index: int, at_deg: float) -> tuple[float, float, float, float]:
    """s, v, a, j of a segment at an angle from its start [unit of the motion, per degree]; s from its start."""
    segment = motion.segments[index]
    shape = segment_shape(with_joined_ends(motion, index), len(motion.segments) == 1, f"motion.segments[{index}]")
    curve = PieceTable(shape.pieces).at(np.array([at_deg / segment.span_deg])).all[:, 0]
    s, v, a, j = (shape.gain * curve / segment.span_deg ** np.arange(4)).tolist()
    return s, v, a, j


def _has_exact_parts(segment: Segment) -> bool:
    """Whether parts of the curve are curves of the same kind."""
    law = find_law(segment.curve.law)
    straight = law is not None and law.pieces == LAWS["constant-velocity"].pieces
    return straight or isinstance(segment.curve, PolynomialCurve) or _is_least_jerk(segment.curve)


def _is_least_jerk(curve: Curve) -> bool:
    """Whether a curve is the one of least jerk through its points: a spline or a table."""
    return isinstance(curve, SplineCurve) and not isinstance(curve, OptimalCurve)


def _cut_curves(segment: Segment, at: float, rise: float, state: tuple[float, ...]) -> tuple[Curve, Curve]:
    """Curves of both parts of a segment split ``at`` degrees from its start, where s, v, a, j are ``state``."""
    curve = segment.curve
    _, v, a, j = state
    if isinstance(curve, PolynomialCurve):
        # as many end conditions as the original (degree 5 to 7), hence the same polynomial
        return (
            PolynomialCurve(curve.start, PolynomialEnd(v, a, None if curve.end.jerk is None else j)),
            PolynomialCurve(PolynomialEnd(v, a, None if curve.start.jerk is None else j), curve.end),
        )
    if isinstance(curve, SplineCurve):
        # each part of a curve of least jerk is the curve of least jerk between its ends (Bellman 1957)
        before = [p for p in curve.points if p.at_deg < at - _SAME]
        after = [p for p in curve.points if p.at_deg > at + _SAME]
        shifted = [
            SplinePoint(
                balance(p.at_deg, (at,)), None if p.value is None else p.value - rise, p.velocity, p.acceleration
            )
            for p in after
        ]
        if isinstance(curve, TableCurve):  # rows of a table have values; its new ends are not joined
            return (
                replace(curve, points=(*before, SplinePoint(at, rise, v, a)), end=AT_REST),
                replace(curve, points=(SplinePoint(0.0, 0.0, v, a), *shifted), start=AT_REST),
            )
        if isinstance(curve, OptimalCurve):
            return _cut_optimal(
                curve, at / segment.span_deg, rise / (segment.rise or 1.0), tuple(before), tuple(shifted)
            )
        ends = SplinePoint(at, None, v, a), SplinePoint(0.0, None, v, a)
        return replace(curve, points=(*before, ends[0])), replace(curve, points=(ends[1], *shifted))
    return curve, curve


def _cut_optimal(
    curve: OptimalCurve, u: float, s: float, before: tuple[SplinePoint, ...], after: tuple[SplinePoint, ...]
) -> tuple[OptimalCurve, OptimalCurve]:
    """Optimal laws of both parts, from rest to rest, of a law split at u and s, with its obstacles."""

    def part(
        from_u: float, to_u: float, from_s: float, to_s: float, bounds: tuple[CurveBound, ...]
    ) -> tuple[CurveBound, ...]:
        width, height = to_u - from_u, (to_s - from_s) or 1.0
        return tuple(
            CurveBound(
                (max(row.start, from_u) - from_u) / width,
                (min(row.end, to_u) - from_u) / width,
                (row.rise - from_s) / height,
            )
            for row in bounds
            if row.end > from_u + _SAME and row.start < to_u - _SAME
        )

    first, second = (0.0, u, 0.0, s), (u, 1.0, s, 1.0)
    return (
        replace(curve, points=before, end=AT_REST, below=part(*first, curve.below), above=part(*first, curve.above)),
        replace(curve, points=after, start=AT_REST, below=part(*second, curve.below), above=part(*second, curve.above)),
    )


def _with_stated_ends(segment: Segment, state: tuple[float, ...]) -> Segment:
    """A periodic spline over the full turn, with its state at the join stated at both ends.

    Without it a part of the turn would start and end at rest.
    """
    assert isinstance(segment.curve, SplineCurve)
    s, v, a, _ = state
    inner = tuple(p for p in segment.curve.points if _SAME < p.at_deg < segment.span_deg - _SAME)
    # a displacement of 0 at the start needs no statement
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
