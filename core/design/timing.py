"""Turning a drive, or a join of its motion, on a shaft of several drives: permitted ranges, and motions at the same time.

All angles are machine angles [deg]. A turned join leaves the others at their machine angles; turning the join at cam angle 0
changes the phase of the drive.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from math import inf

from core.design.camshaft import ENDS, Stroke, distances, drive_names, named_event, strokes, with_drives, with_phase
from core.design.design import Design
from core.design.edits import balance
from core.design.motion_edits import join_angles, join_range, with_join_moved
from core.design.motions import Motion
from core.frozen import frozen

HALF = 180.0 - 1e-6
"""Greatest distance [deg]: half a turn and more counts in the opposite direction."""


@frozen
class AngleRoom:
    """Range of an angle from its present value.

    Attributes
    ----------
    low, high : range, low <= 0 <= high [deg]
    low_row, high_row : sequence conditions that limit it there; None where the motion does, or nothing
    """

    low: float
    high: float
    low_row: int | None = None
    high_row: int | None = None

    def within(self, angle: float) -> float:
        """Nearest angle in the range [deg]."""
        return min(max(angle, self.low), self.high)

    def stop(self, angle: float) -> int | None:
        """Sequence condition that an angle violates; None where there is none."""
        return self.low_row if angle < self.low else self.high_row if angle > self.high else None


def machine_joins(design: Design, index: int) -> tuple[float, ...]:
    """Machine angles of the joins of a drive's motion, 0 ... 360 [deg]; empty without a motion."""
    drive = design.drives[index]
    return (
        ()
        if drive.motion is None
        else tuple(balance(drive.phase, (-angle,)) % 360.0 for angle in join_angles(drive.motion))
    )


def events_at(design: Design, index: int, join: int) -> tuple[str, ...]:
    """Events at a join: the end of a rise or return, the start of the next."""
    drive = design.drives[index]
    if drive.motion is None:
        return ()
    name, count = drive_names(design)[index], len(drive.motion.segments)
    ends = [(stroke, (stroke.segments[0], (stroke.segments[-1] + 1) % count)) for stroke in strokes(drive.motion)]
    at_join = [(end, stroke) for stroke, joins in ends for end, at in zip(ENDS, joins, strict=True) if at == join]
    return tuple(f"{name}.{stroke.name}.{end}" for end, stroke in sorted(at_join, key=lambda row: row[0]))


# -- turning ------------------------------------------------------------------------------------------------


def phase_room(design: Design, index: int) -> AngleRoom:
    """Range in which a drive can be turned against the others without violating a satisfied sequence condition."""
    joins = range(len(machine_joins(design, index)))
    return _room(design, {event for join in joins for event in events_at(design, index, join)}, AngleRoom(-inf, inf))


def join_room(design: Design, index: int, join: int) -> AngleRoom:
    """Range in which a join can be turned between its neighbours without violating a satisfied sequence condition.

    Raises
    ------
    ValueError
        For a drive without a motion.
    """
    motion, number = _with_join_inside(design, index, join)
    if number == 0:
        return AngleRoom(0.0, 0.0)
    at, (low, high) = join_angles(motion)[number], join_range(motion, number)
    return _room(
        design,
        set(events_at(design, index, join)),
        AngleRoom(min(balance(low, (at,)), 0.0), max(balance(high, (at,)), 0.0)),
    )


def _room(design: Design, turned_events: Collection[str], room: AngleRoom) -> AngleRoom:
    """Range limited by the satisfied sequence conditions."""
    for i, (row, at) in enumerate(zip(design.timing, distances(design), strict=True)):
        if not at.kept:
            continue
        second, first = (named_event(design, event) in turned_events for event in (row.second, row.first))
        direction = second - first
        low, high = -max(at.spare_deg, 0.0), HALF - at.spare_deg
        if direction < 0:
            low, high = -high, -low
        if direction and low > room.low:
            room = replace(room, low=low, low_row=i)
        if direction and high < room.high:
            room = replace(room, high=high, high_row=i)
    return room


def turn_drive(design: Design, index: int, phase_deg: float) -> Design:
    """Design with a drive at another phase, 0 ... 360 [deg]."""
    return with_phase(design, index, balance(phase_deg, ()) % 360.0)


def turn_join(design: Design, index: int, join: int, angle: float) -> Design:
    """Design with a join turned by an angle [deg]; it may have faults where the angle is outside of ``join_room``.

    Raises
    ------
    ValueError
        For a drive without a motion.
    """
    motion, number = _with_join_inside(design, index, join)
    if number == 0 or angle == 0.0:
        return design
    motion = with_join_moved(motion, number, balance(join_angles(motion)[number], (-angle,)))
    drive = design.drives[index]
    if join == 0:
        segments = (*motion.segments[1:], motion.segments[0])
        assert drive.motion is not None
        motion = replace(motion, start=drive.motion.start, segments=segments)
        phase = balance(drive.phase, (-angle,)) % 360.0
    drives = list(design.drives)
    drives[index] = replace(drive, motion=motion)
    changed = with_drives(design, drives)
    return with_phase(changed, index, phase) if join == 0 else changed


def _with_join_inside(design: Design, index: int, join: int) -> tuple[Motion, int]:
    """Motion of a drive and the number of a join in it.

    The join at cam angle 0 is join 1 of the motion that begins a segment earlier; it stays 0 where the drive has no phase or
    one segment.
    """
    motion = design.drives[index].motion
    if motion is None:
        raise ValueError("a drive without a motion has no joins")
    if join or not design.listed or len(motion.segments) < 2:
        return motion, join
    last = motion.segments[-1]
    earlier = replace(motion, start=balance(motion.start, (last.rise,)), segments=(last, *motion.segments[:-1]))
    return earlier, 1


# -- motions at the same time -------------------------------------------------------------------------------


def moving(design: Design, index: int) -> tuple[tuple[float, float], ...]:
    """Ranges of machine angles [deg] in which a drive moves, adjacent ones joined; they start in 0 ... 360 and may end above 360."""
    drive = design.drives[index]
    rows = list(_machine_ranges(strokes(drive.motion), drive.phase)) if drive.motion is not None else []
    return _joined(rows)


def together(design: Design, first: int, second: int) -> tuple[tuple[float, float], ...]:
    """Ranges of machine angles [deg] in which both drives move, in the form of ``moving``."""
    overlaps = []
    for begin, end in moving(design, first):
        for second_begin, second_end in moving(design, second):
            for turn in (-360.0, 0.0, 360.0):
                low, high = max(begin, second_begin + turn), min(end, second_end + turn)
                if high > low:
                    overlaps.append((low % 360.0, low % 360.0 + balance(high, (low,))))
    return _joined(sorted(set(overlaps)))


def _machine_ranges(rows: tuple[Stroke, ...], phase: float) -> Iterator[tuple[float, float]]:
    for stroke in rows:
        begin = balance(stroke.start, (-phase,)) % 360.0
        yield begin, begin + balance(stroke.end, (stroke.start,))


def _joined(rows: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Ranges in ascending order, adjacent and overlapping ones joined."""
    ranges: list[tuple[float, float]] = []
    for begin, end in sorted(rows):
        if ranges and begin <= ranges[-1][1] + 1e-9:
            ranges[-1] = ranges[-1][0], max(end, ranges[-1][1])
        else:
            ranges.append((begin, end))
    if len(ranges) > 1 and ranges[-1][1] >= ranges[0][0] + 360.0 - 1e-9:  # past the start of the turn
        begin, end = ranges.pop()
        ranges[0] = begin, max(end, ranges[0][1] + 360.0)
        ranges.sort()
    return tuple(ranges)


# -- time ---------------------------------------------------------------------------------------------------


def milliseconds(design: Design, angle: float) -> float:
    """Time of the shaft for an angle [deg] at constant speed [ms]."""
    return angle / 360.0 * 60_000.0 / design.speed_rpm
