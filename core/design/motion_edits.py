"""Joins of a motion and how they are moved: join k is where segment k begins, join 0 stands at cam angle 0 and 360.

A moved join takes what lies on it along and leaves every other join alone: the segments on both sides grow and shrink,
the ends of a dwell keep one level, and what a spline states of cam angles and levels stays true.
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
from core.design.parts import (
    OUTPUT_LOADS,
    Curve,
    Motion,
    NamedCurve,
    Output,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    Shaft,
    SplineCurve,
    SplinePoint,
    TableCurve,
)
from core.design.paths import all_paths, followed
from core.design.rules import faults
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.laws import find_law

# -- joins of a motion and how they are moved -------------------------------------------------------------------


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


# -- the mirror image of a stroke in time -----------------------------------------------------------------------


CLOSE = 1e-9  # a level this near to where it was is where it was

_PAIRS = ("c1 c4", "c2 c3", "c5 c6", "h1 h4", "h2 h3", "h5 h6", "p1 p2", "cv1 cv2")
MIRRORS: Mapping[str, str] = MappingProxyType(
    {a: b for pair in _PAIRS for a, b in (pair.split(), reversed(pair.split()))}
)
"""Law -> the law that is its mirror image; a law of two like halves is its own, and any other has none."""


def has_image(curve: Curve) -> bool:
    """Whether the curve run backwards is a curve that can be named."""
    law = find_law(curve.law)
    return law is None or law.is_dwell or law.slug in MIRRORS or law.is_symmetric


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


# -- the motion of a design of any kind, and edits of its segments ----------------------------------------------


def motion_of(design: Design) -> Motion | None:
    """The motion program; None of a linkage whose crank turns at speed."""
    return design.drive.motion


def require_motion(design: Design) -> Motion:
    """The motion program. Raises DesignError where there is none."""
    motion = motion_of(design)
    if motion is None:
        problem = "turns at constant speed: there is no motion to change"
        raise DesignError([Fault("linkage.driver.kind", CRANK, problem, MOTION)])
    return motion


def with_motion(design: Design, motion: Motion) -> Design:
    """The design with another motion."""
    return with_drive(design, motion=motion)


def turns_on(design: Design, turns: int) -> Design:
    """The design as it runs so many turns later, where its motion does not come back: begun so many advances further on, its linkage
    assembled as it was. An angle that turns nothing else is without whole turns."""
    motion, drive = require_motion(design), design.drive
    on = turns * motion.gain
    if motion.unit == "deg" and not (drive.is_linkage and drive.linkage.drivers):
        on %= 360.0
    return with_drive(design, mechanism=drive.posed, motion=replace(motion, start=motion.start + on)) if on else design


def without_marks(design: Design) -> Design:
    """The design with nothing assumed of its motion any more."""
    return replace(design, assumed=tuple(path for path in design.assumed if not path.startswith("motion.")))


def with_marks_of(design: Design, before: Sequence[int | None]) -> Design:
    """Assumed paths for segments that have moved; before: for each segment the number that it, or what it is a copy
    of, had, None where it is new. What was assumed of removed segments is dropped."""
    kept = dict.fromkeys(followed(design.assumed, "motion.segments", before))
    order = {path: i for i, path in enumerate(all_paths(design))}
    moved = iter(sorted((p for p in kept if p.startswith("motion.segments[")), key=lambda p: order.get(p, len(order))))
    return replace(design, assumed=tuple(next(moved) if p.startswith("motion.segments[") else p for p in kept))


def insert_segment(design: Design, index: int, *, before: bool = False) -> Design:
    """``with_segment_inserted`` in a design."""
    motion = require_motion(design)
    old, at = range(len(motion.segments)), index if before else index + 1
    changed = with_motion(design, with_segment_inserted(motion, index, before=before))
    return with_marks_of(changed, [*old[:at], None, *old[at:]])


def of_motion(motion: Motion, name: str, speed_rpm: float | None = None) -> Design:
    """A design of this motion alone, on a shaft where its speed is known."""
    shaft = None if speed_rpm is None else Shaft("ccw", speed_rpm)
    drive = Drive(motion, Output(motion.unit), None, OUTPUT_LOADS[motion.unit]())
    return Design(name, shaft, (drive,), () if shaft is None else ("shaft.rotation",))


def alone(design: Design) -> Design:
    """The motion of a design without its mechanism, at the speed and sense of its shaft."""
    motion, shaft = require_motion(design), design.shaft
    drive = Drive(motion, Output(motion.unit), None, OUTPUT_LOADS[motion.unit]())
    marks = tuple(path for path in design.assumed if path.startswith(("motion.", "shaft.rotation", "shaft.speed_rpm")))
    own = None if shaft is None else Shaft(shaft.rotation, shaft.speed_rpm)
    return Design(design.name, own, (drive,), marks)


def with_motion_of(design: Design, other: Design) -> Design:
    """The design with the motion of another one, and what is assumed of it. Raises DesignError where that is in another unit, or goes on
    on a cam."""
    motion, unit = require_motion(other), require_motion(design).unit
    if motion.unit != unit:
        problem = f"is in {motion.unit}, and this design's is in {unit}"
        raise DesignError([Fault("motion", other.name, problem, f"a motion in {unit}")])
    marks = [path for path in other.assumed if path.startswith("motion.")]
    bare = without_marks(design)
    made = with_motion(replace(bare, assumed=(*marks, *bare.assumed)), motion)
    if found := faults(made):
        raise DesignError(found)
    return made


def files_of(design: Design) -> tuple[str, ...]:
    """The files that the motions of a design follow from."""
    motions = (drive.motion.follows for drive in design.drives if drive.motion is not None)
    return tuple(dict.fromkeys(name for follows in motions if follows is not None for name in follows.files))


def remove_segment(design: Design, index: int, *, balanced: bool = True) -> Design:
    """``without_segment`` in a design."""
    before = require_motion(design)
    motion = without_segment(before, index, balanced=balanced)
    if motion is before:
        return design
    return with_marks_of(with_motion(design, motion), [i for i in range(len(before.segments)) if i != index])


def move_join(design: Design, join: int, angle: float | None = None, level: float | None = None) -> Design:
    """``with_join_moved`` in a design."""
    return with_motion(design, with_join_moved(require_motion(design), join, angle, level))


def mirror_stroke(design: Design, index: int) -> Design:
    """``stroke_mirrored`` in a design: what is assumed of the stroke is assumed of its image."""
    before = require_motion(design)
    motion, numbers = stroke_mirrored(before, index)
    return design if motion == before else with_marks_of(with_motion(design, motion), numbers)
