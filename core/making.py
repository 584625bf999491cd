"""What the commands of motion making print, the table of laws and a blended motion as Yang's Fig. 4 does; and how a
blended motion comes into a design."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

from core.blend import Blended
from core.design import Design, Motion, Segment, join_levels, mirrored, require_motion, with_motion
from core.design.edits import back_at_start, rest, still
from core.design.motions import with_marks_of, without_marks
from core.design.rules import CLOSING
from core.errors import DesignError, Fault
from core.laws import LAWS, peaks
from core.report import columns, digits


def laws_data() -> list[dict[str, Any]]:
    """Every law's peak coefficients for unit rise and span; infinite = None."""
    told = []
    for slug, law in LAWS.items():
        found = peaks(law)
        numbers = {"cv": found.cv, "ca": found.ca, "cj": found.cj, "cm": found.cm}
        told.append({"law": slug, **{k: v if math.isfinite(v) else None for k, v in numbers.items()}})
    return told


def laws_text() -> str:
    """The same to read."""
    rows: list[tuple[str, ...]] = [("law", "velocity", "acceleration", "jerk", "torque", "")]
    for slug, law in LAWS.items():
        found = peaks(law)
        numbers = [digits(v if math.isfinite(v) else None) for v in (found.cv, found.ca, found.cj, found.cm)]
        rows.append((slug, *numbers, "acceleration jumps at an end" if found.jumps_at_an_end else ""))
    return "\n".join(columns(rows)) + "\n"


@dataclass(frozen=True)
class CurveRow:
    """One blended curve: from which cam angle over how many degrees, from which level how much higher."""

    curve: str
    angle: float
    span: float
    level: float
    rise: float


def curve_rows(blended: Blended) -> list[CurveRow]:
    """The curves in order; the motion starts at level 0, or falls to it."""
    angle, level = blended.request.start, _first_level(blended)
    told = []
    for segment in blended.segments:
        told.append(CurveRow(segment.curve.law.upper(), angle, segment.span_deg, level, segment.rise))
        angle, level = angle + segment.span_deg, level + segment.rise
    return told


def _first_level(blended: Blended) -> float:
    levels = list(accumulate((s.rise for s in blended.segments), initial=0.0))
    return -min(levels) + 0.0


def curves_data(blended: Blended) -> list[dict[str, Any]]:
    """The curves in order, with their angles and levels. A motion in degrees has a ``level_deg`` where one in mm has a
    ``start_mm``: its ``start_deg`` is the cam angle."""
    unit = blended.request.unit
    level = {"mm": "start_mm", "deg": "level_deg"}[unit]
    return [
        {"curve": r.curve, "start_deg": r.angle, "span_deg": r.span, level: r.level, f"rise_{unit}": r.rise}
        for r in curve_rows(blended)
    ]


def blend_text(blended: Blended) -> str:
    """Sequence, spans and the table of starts and ends."""
    unit = blended.request.unit
    rows: list[tuple[str, ...]] = [
        ("curve", f"height {unit}", "span deg", "cam from deg", "cam to deg", f"from {unit}", f"to {unit}")
    ]
    for r in curve_rows(blended):
        numbers = (abs(r.rise), r.span, r.angle, r.angle + r.span, r.level, r.level + r.rise)
        rows.append((r.curve, *(digits(round(v, 12), 9) for v in numbers)))
    solution = blended.solution
    lines = [f"sequence {'-'.join(blended.curves)}", "", *columns(rows), ""]
    for label, speed in (("rise", solution.speed), ("return", solution.back_speed)):
        if speed:
            lines.append(f"peak velocity of the {label} {digits(speed, 9)} {unit}/deg")
    lines.append(f"peak acceleration {digits(solution.peak_acceleration, 9)} {unit}/deg^2")
    return "\n".join(lines) + "\n"


def changed_beside(before: Motion, after: Motion, blended: Blended) -> tuple[int, Segment] | None:
    """What moves otherwise beside the blended curves, so that the follower comes back to where it starts: the first such
    segment and its number, counted from 1; None where the rest stays as it was."""
    was = {(s.curve, s.rise) for s in before.segments}
    others = ((n, s) for n, s in enumerate(after.segments, 1) if s.rise and s not in blended.segments)
    return next(((n, s) for n, s in others if (s.curve, s.rise) not in was), None)


def beside_text(before: Design, after: Design, blended: Blended) -> str:
    """The same in a line, for a design into which the curves came; nothing where the rest stays."""
    changed = changed_beside(require_motion(before), require_motion(after), blended)
    if changed is None:
        return ""
    n, segment = changed
    moves = f"{digits(segment.rise, 9)} {blended.request.unit} over {digits(segment.span_deg, 9)} deg"
    return f"in the design segment {n}, {segment.curve.law}, moves otherwise, to come back: {moves}\n"


# -- into a design ----------------------------------------------------------------------------------------

Numbered = tuple[Segment, int | None]
"""A segment, and its number in the motion it comes from; None where it is new."""


def into_design(design: Design, blended: Blended) -> Design:
    """The design with a blended motion: over the whole turn where that comes back to where it starts, else in place of
    what the motion does between its angles. Raises DesignError."""
    return over_the_turn(design, blended) if abs(_gain(blended)) <= CLOSING else in_place(design, blended)


def over_the_turn(design: Design, blended: Blended) -> Design:
    """The design with its motion replaced by dwell - blended curves - dwell. Raises DesignError where the blended
    motion does not come back to where it starts, or is in another unit."""
    _require_unit(design, blended)
    total = _gain(blended)
    if abs(total) > CLOSING:
        told = f"rises add up to {total:.9g} {blended.request.unit}"
        raise _refused("motion.segments", told, "a rise or a return alone is no whole motion", "DRRD | RRR")
    request = blended.request
    return _turn(design, [(request.start, blended.segments)], 360.0 - request.end, _first_level(blended))


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
    if abs(_gain(blended)) > CLOSING and all(still(segment) for segment, _ in before + after):
        return _there_and_back(design, blended)
    rows: list[Numbered] = [*before, *((segment, None) for segment in blended.segments), *after]
    segments = [segment for segment, _ in rows]
    if abs(math.fsum(s.rise for s in segments)) > CLOSING:
        behind = len(rows) - len(after)
        segments = list(back_at_start(segments, [*range(behind, len(rows)), *range(len(before))]))
    changed = with_motion(design, replace(motion, segments=tuple(segments)))
    return with_marks_of(changed, [number for _, number in rows])


def _gain(blended: Blended) -> float:
    """How much higher the curves end than they start."""
    return math.fsum(s.rise for s in blended.segments)


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
    motion = Motion(rest(start, (-_lowest(design),)), tuple(segments), require_motion(design).unit)
    return without_marks(with_motion(design, motion))


def _lowest(design: Design) -> float:
    """Where a motion over the whole turn has its lowest level: a cam's on the base circle, that of a link where it was."""
    return 0.0 if not design.drive.is_linkage else min(join_levels(require_motion(design)))


def _there_and_back(design: Design, blended: Blended) -> Design:
    """The blended stroke and its mirror image, about 180 degrees where both fit so, else in what is left of the turn."""
    request, curves = blended.request, blended.segments
    start, end = request.start, request.end
    image = [mirrored(segment) for segment in reversed(curves)]
    if end <= 180.0:
        return _turn(design, [(start, curves), (360.0 - 2.0 * end, image)], start, _first_level(blended))
    room = 360.0 - end if end < 360.0 else start
    if room <= 0.0:
        told = f"{start:g} ... {end:g} deg"
        raise _refused("motion.segments", told, "leaves no room for the way back", "less than the whole turn")
    image = [replace(s, span_deg=s.span_deg * room / (end - start)) for s in image]
    if end < 360.0:
        return _turn(design, [(start, curves), (0.0, image)], 0.0, _first_level(blended))
    return _turn(design, [(0.0, image), (0.0, curves)], 0.0, _first_level(blended) + _gain(blended))


def _outside(motion: Motion, start: float, end: float) -> tuple[list[Numbered], list[Numbered]]:
    """What the motion does before and after these cam angles [deg]. Raises DesignError where one of them lies inside a
    segment that moves."""
    before: list[Numbered] = []
    after: list[Numbered] = []
    at = 0.0
    for number, segment in enumerate(motion.segments):
        first, at = at, rest(at, (-segment.span_deg,))
        for angle in (start, end):
            if first + CLOSING < angle < at - CLOSING and not still(segment):
                told, place = f"{first:g} ... {at:g} deg", f"a join, or an angle in a dwell; not {angle:g} deg"
                raise _refused(f"motion.segments[{number}]", told, "moves, and would be cut", place)
        if first < start - CLOSING:
            span = segment.span_deg if at <= start + CLOSING else rest(start, (first,))
            before.append((replace(segment, span_deg=span), number))
        if at > end + CLOSING:
            span = segment.span_deg if first >= end - CLOSING else rest(at, (end,))
            after.append((replace(segment, span_deg=span), number))
    return before, after
