"""Edits of a motion: its joins, mirror images of strokes, and its segments in a design.

Join k is the start of segment k; join 0 is at cam angle 0 and 360. A moved join changes the segments on both sides and no
other join; both ends of a dwell keep one level, and points of splines keep their cam angles and levels.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import fsum
from types import MappingProxyType

from core.design.design import Design, Drive, with_drive
from core.design.edits import back_at_start, balance, is_dwell, stretched, times, with_segment_inserted, without_segment
from core.design.linkage import CRANK, MOTION
from core.design.motions import (
    Curve,
    CurveBound,
    Motion,
    NamedCurve,
    OptimalCurve,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
)
from core.design.parts import OUTPUT_LOADS, Output, Shaft
from core.design.paths import all_paths, followed
from core.design.rules import faults
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws import find_law

# -- joins of a motion ------------------------------------------------------------------------------------------


LEAST_SPAN = 0.5
"""Least span of a segment when one of its joins is dragged towards the other [deg]."""

_ON = 1e-9  # distance from an end of its segment at which a point of a spline belongs to the join [deg]


def join_angles(motion: Motion) -> tuple[float, ...]:
    """Cam angles of the joins [deg], the first one 0."""
    return tuple(balance(0.0, (-s.span_deg for s in motion.segments[:k])) for k in range(len(motion.segments)))


def join_levels(motion: Motion) -> tuple[float, ...]:
    """Levels of the joins [mm or deg]."""
    return tuple(balance(motion.first, (-s.rise for s in motion.segments[:k])) for k in range(len(motion.segments)))


def joins_of_level(motion: Motion, join: int) -> frozenset[int]:
    """Joins that dwells connect to a join at one level, with the join itself."""
    count = len(motion.segments)
    connected = {join}
    for step, before in ((1, 0), (-1, -1)):
        at = join
        while is_dwell(motion.segments[(at + before) % count]) and (at + step) % count not in connected:
            at = (at + step) % count
            connected.add(at)
    return frozenset(connected)


def join_range(motion: Motion, join: int, least: float = LEAST_SPAN) -> tuple[float, float]:
    """Range of cam angles [deg] of a join; both segments, and the distance to the next point of a spline, keep ``least`` degrees.

    Join 0 stays at 0.
    """
    if join == 0:
        return 0.0, 0.0
    before, after = motion.segments[join - 1], motion.segments[join]
    current = join_angles(motion)[join]
    low = current - before.span_deg + max((p.at_deg for p in _inner(before)), default=0.0) + least
    high = current + min((p.at_deg for p in _inner(after)), default=after.span_deg) - least
    return min(balance(low, ()), current), max(balance(high, ()), current)


def with_join_moved(motion: Motion, join: int, angle: float | None = None, level: float | None = None) -> Motion:
    """Motion with a join moved to a cam angle [deg] and a level [mm or deg]; None leaves the value unchanged.

    The angle of join 0 stays 0; its level is the start of the motion. The motion may have faults where the angle is outside
    of ``join_range``, or where a law cannot have the new rise.
    """
    if angle is not None and join > 0 and angle != join_angles(motion)[join]:
        motion = _with_join_angle(motion, join, angle)
    if level is not None and level != join_levels(motion)[join]:
        motion = _with_join_level(motion, join, level)
    return motion


def _with_join_angle(motion: Motion, join: int, angle: float) -> Motion:
    segments = list(motion.segments)
    before, after = segments[join - 1], segments[join]
    span = balance(angle, (s.span_deg for s in segments[: join - 1]))
    shift = balance(span, (before.span_deg,))
    segments[join - 1] = _with_points(
        replace(before, span_deg=span),
        lambda p: replace(p, at_deg=span) if _at_end(p, before.span_deg) else p,
    )
    left = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i != join))
    segments[join] = _with_points(
        replace(after, span_deg=left),
        # the point at the far end gets its exact angle
        lambda p: (
            p
            if p.at_deg <= _ON
            else replace(p, at_deg=left if _at_end(p, after.span_deg) else balance(p.at_deg, (shift,)))
        ),
    )
    return replace(motion, segments=tuple(segments))


def _with_join_level(motion: Motion, join: int, level: float) -> Motion:
    height = balance(level, (join_levels(motion)[join],))
    lifted = joins_of_level(motion, join)
    segments = list(motion.segments)
    leaving = None
    for i, segment in enumerate(segments):
        start, end = i in lifted, (i + 1) % len(segments) in lifted
        if end and not start:
            segments[i] = _with_points(
                replace(segment, rise=balance(segment.rise, (-height,))),
                partial(_raised_at_end, span=segment.span_deg, height=height),
            )
        elif start and not end:
            leaving = i
            segments[i] = _with_points(segment, lambda p: p if p.at_deg <= _ON else _raised(p, -height))
    if leaving is not None:
        left = balance(motion.gain, (s.rise for i, s in enumerate(segments) if i != leaving))
        segments[leaving] = replace(segments[leaving], rise=left)
    start_level = balance(motion.start, (-height,)) if 0 in lifted else motion.start
    return replace(motion, start=start_level, segments=tuple(segments))


def _inner(segment: Segment) -> list[SplinePoint]:
    """Points of a spline that are at neither of its ends."""
    if not isinstance(segment.curve, SplineCurve):
        return []
    return [p for p in segment.curve.points if p.at_deg > _ON and not _at_end(p, segment.span_deg)]


def _at_end(point: SplinePoint, span: float) -> bool:
    return point.at_deg >= span - _ON


def _raised(point: SplinePoint, height: float) -> SplinePoint:
    return point if point.value is None else replace(point, value=balance(point.value, (-height,)))


def _raised_at_end(point: SplinePoint, span: float, height: float) -> SplinePoint:
    return _raised(point, height) if _at_end(point, span) else point


def _with_points(segment: Segment, change: Callable[[SplinePoint], SplinePoint]) -> Segment:
    """Segment with every point of its spline changed; any other curve stays."""
    curve = segment.curve
    if not isinstance(curve, SplineCurve):
        return segment
    return replace(segment, curve=replace(curve, points=tuple(map(change, curve.points))))


# -- the mirror image of a stroke in time -----------------------------------------------------------------------


CLOSE = 1e-9  # difference of two levels that count as equal

_PAIRS = ("c1 c4", "c2 c3", "c5 c6", "h1 h4", "h2 h3", "h5 h6", "p1 p2", "cv1 cv2")
MIRRORS: Mapping[str, str] = MappingProxyType(
    {a: b for pair in _PAIRS for a, b in (pair.split(), reversed(pair.split()))}
)
"""Law -> its mirror image; a symmetric law is its own image, other laws have none."""


def has_image(curve: Curve) -> bool:
    """Whether the mirror image of a curve in time is a curve of the table."""
    law = find_law(curve.law)
    return law is None or law.is_dwell or law.slug in MIRRORS or law.is_symmetric


def mirrored(segment: Segment) -> Segment:
    """Mirror image of a segment in time, y(span - θ), with the opposite rise; its curve must have an image."""
    return replace(segment, rise=0.0 - segment.rise, curve=_mirrored_curve(segment))


def _mirrored_curve(segment: Segment) -> Curve:
    curve = segment.curve
    if isinstance(curve, NamedCurve):
        return NamedCurve(MIRRORS.get(curve.law, curve.law), balance(1.0, (curve.crossover,)), curve.flat_fraction)
    if isinstance(curve, PolynomialCurve):
        return PolynomialCurve(_reversed_end(curve.end), _reversed_end(curve.start))
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
        if isinstance(curve, OptimalCurve):
            below, above = _reversed_bounds(curve.above), _reversed_bounds(curve.below)
            flipped = replace(curve, points=tuple(points), below=below, above=above)
            return replace(flipped, start=curve.end, end=curve.start)
        return replace(curve, points=tuple(points))
    return curve  # sine, constant and cosine acceleration are symmetric


def _reversed_bounds(bounds: tuple[CurveBound, ...]) -> tuple[CurveBound, ...]:
    """Obstacles in the image 1 - s(1 - u): what was above is below."""
    rows = reversed(bounds)
    return tuple(CurveBound(*(balance(1.0, (x,)) for x in (row.end, row.start, row.rise))) for row in rows)


def _reversed_end(end: PolynomialEnd) -> PolynomialEnd:
    return PolynomialEnd(0.0 - end.velocity, end.acceleration, times(end.jerk, -1.0))


# -- strokes ----------------------------------------------------------------------------------------------


@frozen
class _Turn:
    """Numbers of segments from a stroke on, in the order of the turn.

    Attributes
    ----------
    stroke : the stroke
    between : segments up to the next stroke in the opposite direction
    opposite : that stroke
    behind : the remaining segments
    """

    stroke: list[int]
    between: list[int]
    opposite: list[int]
    behind: list[int]


def _turn_from(motion: Motion, index: int) -> _Turn | None:
    """Turn from a segment's stroke; None for a dwell, without an opposite stroke, or where a curve has no image."""
    directions = [0 if is_dwell(s) or s.rise == 0.0 else 1 if s.rise > 0.0 else -1 for s in motion.segments]
    count, direction = len(directions), directions[index]
    if direction == 0 or -direction not in directions:
        return None
    first = index
    while directions[first - 1] == direction:
        first = (first - 1) % count
    order = [(first + k) % count for k in range(count)]
    stroke = next(k for k in range(count) if directions[order[k]] != direction)
    opposite = next(k for k in range(stroke, count) if directions[order[k]] == -direction)
    end = next((k for k in range(opposite, count) if directions[order[k]] != -direction), count)
    if not all(has_image(motion.segments[i].curve) for i in order[:stroke]):
        return None
    return _Turn(order[:stroke], order[stroke:opposite], order[opposite:end], order[end:])


def stroke_mirrored(motion: Motion, index: int) -> tuple[Motion, list[int]]:
    """Motion in which the next opposite stroke (cyclic) is the mirror image in time of a segment's stroke.

    Also returns, for each segment of the new motion, the number of its original. The segment after the image takes the
    difference in span, else the one before it, else all others in proportion; where that is not enough, both strokes share
    their span. Further strokes bring the follower back. The motion is unchanged where there is nothing to mirror.
    """
    turn = _turn_from(motion, index)
    segments = list(motion.segments)
    if turn is None:
        return motion, list(range(len(segments)))
    level = join_levels(motion)[turn.stroke[0]]
    image = [mirrored(segments[i]) for i in reversed(turn.stroke)]
    segments, image = _with_room(segments, turn, image)

    # in the order of the turn: segments, and the numbers they come from
    rows = [(segments[i], i) for i in turn.stroke + turn.between]
    rows += zip(image, reversed(turn.stroke), strict=True)
    rows += [(segments[i], i) for i in turn.behind]
    if balance(motion.gain, (s.rise for s, _ in rows)):
        rest = [k for part in (turn.behind, turn.between) for k, (_, i) in enumerate(rows) if i in part]
        closed = back_at_start([s for s, _ in rows], rest, motion.gain)
        rows = [(s, i) for s, (_, i) in zip(closed, rows, strict=True)]
    first = _first_of(turn, len(image)) % len(rows)
    rows = rows[first:] + rows[:first]
    result = tuple(s for s, _ in rows)
    ahead = len(rows) - first if first else 0  # segments before the stroke
    start = balance(level, (s.rise for s in result[:ahead]))
    start = motion.start if abs(start - motion.start) < CLOSE else start
    return replace(motion, start=start, segments=result), [i for _, i in rows]


def _first_of(turn: _Turn, image: int) -> int:
    """Position of cam angle 0 in the new order: before the same segment, or within the image."""
    at = (turn.stroke + turn.between + turn.opposite + turn.behind).index(0)
    image_start = len(turn.stroke) + len(turn.between)
    if at <= image_start:
        return at
    if at < image_start + len(turn.opposite):
        return image_start + min(at - image_start, image)
    return at + image - len(turn.opposite)


def _with_room(segments: list[Segment], turn: _Turn, image: list[Segment]) -> tuple[list[Segment], list[Segment]]:
    """Segments and image with spans that make a turn once the image replaces the opposite stroke."""
    stroke, rest = turn.stroke, turn.behind + turn.between
    more = balance(_total(segments, stroke), (_total(segments, turn.opposite),))
    if more == 0.0:
        return segments, image
    giver = _giver(segments, turn, more)
    if giver is not None:
        return with_total_span(segments, [giver], balance(segments[giver].span_deg, (more,))), image
    room = balance(_total(segments, rest), (more,))
    if rest and room >= LEAST_SPAN * len(rest):
        return with_total_span(segments, rest, room), image
    segments = with_total_span(segments, stroke, balance((360.0 - _total(segments, rest)) / 2.0, ()))
    return segments, [mirrored(segments[i]) for i in reversed(stroke)]


def _giver(segments: Sequence[Segment], turn: _Turn, more: float) -> int | None:
    """Neighbour of the image that takes the difference, preferably one that leaves the stroke at its cam angle."""
    able = [i for i in (turn.behind[:1] + turn.between[-1:]) if segments[i].span_deg - more >= LEAST_SPAN]
    first = turn.stroke[0]
    return next((i for i in able if (i < first) == (turn.opposite[0] < first)), able[0] if able else None)


def _total(segments: Sequence[Segment], which: Sequence[int]) -> float:
    """Total span of some segments [deg]."""
    return fsum(segments[i].span_deg for i in which)


def with_total_span(segments: Sequence[Segment], which: Sequence[int], total: float) -> list[Segment]:
    """Segments of which some are stretched in proportion to a total span [deg]."""
    result, factor = list(segments), total / _total(segments, which)
    for i in which:
        before_last = (result[j].span_deg for j in which[:-1])
        span = balance(total, before_last) if i == which[-1] else balance(result[i].span_deg * factor, ())
        result[i] = replace(result[i], span_deg=span, curve=stretched(result[i].curve, span / result[i].span_deg, 1.0))
    return result


# -- the motion of a design, and edits of its segments ----------------------------------------------------------


def motion_of(design: Design) -> Motion | None:
    """Motion of a design; None for a linkage with a crank at constant speed."""
    return design.drive.motion


def require_motion(design: Design) -> Motion:
    """Motion of a design.

    Raises
    ------
    DesignError
        Where there is no motion.
    """
    motion = motion_of(design)
    if motion is None:
        problem = "turns at constant speed: there is no motion to change"
        raise DesignError([Fault("linkage.driver.kind", CRANK, problem, MOTION)])
    return motion


def with_motion(design: Design, motion: Motion) -> Design:
    """Design with another motion."""
    return with_drive(design, motion=motion)


def turns_on(design: Design, turns: int) -> Design:
    """Design some turns later, where its motion has an advance: the start is increased by the advances, the assembly stays.

    An angle without second drivers is reduced to less than a turn.
    """
    motion, drive = require_motion(design), design.drive
    shift = turns * motion.gain
    if motion.unit == "deg" and not (drive.is_linkage and drive.linkage.drivers):
        shift %= 360.0
    if not shift:
        return design
    return with_drive(design, mechanism=drive.posed, motion=replace(motion, start=motion.start + shift))


def without_marks(design: Design) -> Design:
    """Design without assumed paths of its motion."""
    return replace(design, assumed=tuple(path for path in design.assumed if not path.startswith("motion.")))


def with_marks_of(design: Design, before: Sequence[int | None]) -> Design:
    """Design with the assumed paths of moved segments; paths of removed segments are removed.

    ``before`` is the previous number of each segment or of its original, None for a new one.
    """
    marks = dict.fromkeys(followed(design.assumed, "motion.segments", before))
    order = {path: i for i, path in enumerate(all_paths(design))}
    moved = iter(sorted((p for p in marks if p.startswith("motion.segments[")), key=lambda p: order.get(p, len(order))))
    return replace(design, assumed=tuple(next(moved) if p.startswith("motion.segments[") else p for p in marks))


def insert_segment(design: Design, index: int, *, before: bool = False) -> Design:
    """Design with a dwell inserted, as by ``with_segment_inserted``."""
    motion = require_motion(design)
    old, at = range(len(motion.segments)), index if before else index + 1
    changed = with_motion(design, with_segment_inserted(motion, index, before=before))
    return with_marks_of(changed, [*old[:at], None, *old[at:]])


def of_motion(motion: Motion, name: str, speed_rpm: float | None = None) -> Design:
    """Design of a motion without a mechanism, with a shaft where the speed is given."""
    shaft = None if speed_rpm is None else Shaft("ccw", speed_rpm)
    drive = Drive(motion, Output(motion.unit), None, OUTPUT_LOADS[motion.unit]())
    return Design(name, shaft, (drive,), () if shaft is None else ("shaft.rotation",))


def alone(design: Design) -> Design:
    """Design of the motion of a design without its mechanism, at the speed and sense of its shaft."""
    motion, shaft = require_motion(design), design.shaft
    drive = Drive(motion, Output(motion.unit), None, OUTPUT_LOADS[motion.unit]())
    marks = tuple(path for path in design.assumed if path.startswith(("motion.", "shaft.rotation", "shaft.speed_rpm")))
    bare_shaft = None if shaft is None else Shaft(shaft.rotation, shaft.speed_rpm)
    return Design(design.name, bare_shaft, (drive,), marks)


def with_motion_of(design: Design, source: Design) -> Design:
    """Design with the motion of another design, and its assumed paths.

    Raises
    ------
    DesignError
        Where the motion has another unit, or an advance on a cam.
    """
    motion, unit = require_motion(source), require_motion(design).unit
    if motion.unit != unit:
        problem = f"is in {motion.unit}, and this design's is in {unit}"
        raise DesignError([Fault("motion", source.name, problem, f"a motion in {unit}")])
    marks = [path for path in source.assumed if path.startswith("motion.")]
    bare = without_marks(design)
    result = with_motion(replace(bare, assumed=(*marks, *bare.assumed)), motion)
    if errors := faults(result):
        raise DesignError(errors)
    return result


def files_of(design: Design) -> tuple[str, ...]:
    """Files from which the motions of a design are computed."""
    motions = (drive.motion.follows for drive in design.drives if drive.motion is not None)
    return tuple(dict.fromkeys(name for follows in motions if follows is not None for name in follows.files))


def remove_segment(design: Design, index: int, *, balanced: bool = True) -> Design:
    """Design without a segment, as by ``without_segment``."""
    before = require_motion(design)
    motion = without_segment(before, index, balanced=balanced)
    if motion is before:
        return design
    return with_marks_of(with_motion(design, motion), [i for i in range(len(before.segments)) if i != index])


def move_join(design: Design, join: int, angle: float | None = None, level: float | None = None) -> Design:
    """Design with a join moved, as by ``with_join_moved``."""
    return with_motion(design, with_join_moved(require_motion(design), join, angle, level))


def mirror_stroke(design: Design, index: int) -> Design:
    """Design with a stroke mirrored, as by ``stroke_mirrored``; the image has the assumed paths of the stroke."""
    before = require_motion(design)
    motion, numbers = stroke_mirrored(before, index)
    return design if motion == before else with_marks_of(with_motion(design, motion), numbers)
