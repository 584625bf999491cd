"""A blended motion put into a design: over the whole turn, or in place of what the motion does between its angles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from core.blend.request import Blended
from core.design import Cam, Design, Motion, Segment, join_levels, mirrored, require_motion, with_motion
from core.design.edits import back_at_start, balance, is_dwell
from core.design.motions import with_marks_of, without_marks
from core.design.rules import CLOSING
from core.errors import DesignError, Fault

Numbered = tuple[Segment, int | None]
"""A segment, and its number in the motion it comes from; None where it is new."""


def into_design(design: Design, blended: Blended) -> Design:
    """The design with a blended motion: over the whole turn where that comes back to where it starts, else in place of
    what the motion does between its angles. Raises DesignError."""
    whole = abs(blended.gain - require_motion(design).gain) <= CLOSING
    return over_the_turn(design, blended) if whole else in_place(design, blended)


def over_the_turn(design: Design, blended: Blended) -> Design:
    """The design with its motion replaced by dwell - blended curves - dwell. Raises DesignError where the blended
    motion does not come back to where it starts, or is in another unit."""
    _require_unit(design, blended)
    total = blended.gain
    if abs(total - require_motion(design).gain) > CLOSING:
        value = f"rises add up to {total:.9g} {blended.request.unit}"
        raise _refused("motion.segments", value, "a rise or a return alone is no whole motion", "DRRD | RRR")
    request = blended.request
    return _turn(design, [(request.start, blended.segments)], 360.0 - request.end, blended.first_level)


def in_place(design: Design, blended: Blended) -> Design:
    """The design with the blended curves in place of what its motion does between their angles; the rest stays, and
    dwells that reach over an end are cut there.

    Where the follower then ends at another level, the next segment that moves brings it back; where nothing else moves,
    the blended curves do so, run backwards. Raises DesignError where a segment that moves would have to be cut, the
    turn has no room left for the way back, or the units differ.
    """
    _require_unit(design, blended)
    motion, request = require_motion(design), blended.request
    before, after = _outside(motion, request.start, request.end)
    if not motion.gain and abs(blended.gain) > CLOSING and all(is_dwell(segment) for segment, _ in before + after):
        return _there_and_back(design, blended)
    rows: list[Numbered] = [*before, *((segment, None) for segment in blended.segments), *after]
    segments = [segment for segment, _ in rows]
    if abs(math.fsum(s.rise for s in segments) - motion.gain) > CLOSING:
        behind = len(rows) - len(after)
        segments = list(back_at_start(segments, [*range(behind, len(rows)), *range(len(before))], motion.gain))
    changed = with_motion(design, replace(motion, segments=tuple(segments)))
    return with_marks_of(changed, [number for _, number in rows])


def _refused(path: str, value: object, problem: str, allowed: str) -> DesignError:
    return DesignError([Fault(path, value, problem, allowed)])


def _require_unit(design: Design, blended: Blended) -> None:
    unit = require_motion(design).unit
    if blended.request.unit != unit:
        raise _refused("motion", f"a blend in {blended.request.unit}", "not the unit of this design's motion", unit)


def _turn(design: Design, runs: Sequence[tuple[float, Sequence[Segment]]], after: float, start: float) -> Design:
    """The design with a motion of its own: runs of curves, each behind a dwell of so many degrees, and a last dwell."""
    segments: list[Segment] = []
    for dwell, curves in runs:
        segments += [*([Segment(dwell, 0.0)] if dwell > 0.0 else []), *curves]
    segments += [Segment(after, 0.0)] if after > 0.0 else []
    start = balance(start, (-_lowest(design),))
    motion = replace(require_motion(design), start=start, segments=tuple(segments))
    return without_marks(with_motion(design, motion))


def _lowest(design: Design) -> float:
    """Where a motion over the whole turn has its lowest level: on a base circle that is typed, else where it was."""
    return 0.0 if isinstance(design.drive.cam, Cam) else min(join_levels(require_motion(design)))


def _there_and_back(design: Design, blended: Blended) -> Design:
    """The blended stroke and its mirror image, about 180 degrees where both fit so, else in what is left of the turn."""
    request, curves = blended.request, blended.segments
    start, end = request.start, request.end
    image = [mirrored(segment) for segment in reversed(curves)]
    if end <= 180.0:
        return _turn(design, [(start, curves), (360.0 - 2.0 * end, image)], start, blended.first_level)
    room = 360.0 - end if end < 360.0 else start
    if room <= 0.0:
        angles = f"{start:g} ... {end:g} deg"
        raise _refused("motion.segments", angles, "leaves no room for the way back", "less than the whole turn")
    image = [replace(s, span_deg=s.span_deg * room / (end - start)) for s in image]
    if end < 360.0:
        return _turn(design, [(start, curves), (0.0, image)], 0.0, blended.first_level)
    return _turn(design, [(0.0, image), (0.0, curves)], 0.0, blended.first_level + blended.gain)


def _outside(motion: Motion, start: float, end: float) -> tuple[list[Numbered], list[Numbered]]:
    """What the motion does before and after these cam angles [deg]. Raises DesignError where one of them lies inside a
    segment that moves."""
    before: list[Numbered] = []
    after: list[Numbered] = []
    at = 0.0
    for number, segment in enumerate(motion.segments):
        first, at = at, balance(at, (-segment.span_deg,))
        for angle in (start, end):
            if first + CLOSING < angle < at - CLOSING and not is_dwell(segment):
                angles, place = f"{first:g} ... {at:g} deg", f"a join, or an angle in a dwell; not {angle:g} deg"
                raise _refused(f"motion.segments[{number}]", angles, "moves, and would be cut", place)
        if first < start - CLOSING:
            span = segment.span_deg if at <= start + CLOSING else balance(start, (first,))
            before.append((replace(segment, span_deg=span), number))
        if at > end + CLOSING:
            span = segment.span_deg if first >= end - CLOSING else balance(at, (end,))
            after.append((replace(segment, span_deg=span), number))
    return before, after
