"""Turning a drive, or one join of its motion, on a shaft of several: how far the timing leaves room, and where two drives move at
the same time. All angles are machine angles [deg].

A join turned alone leaves the others at their machine angles; the join at a drive's own cam angle 0 too, whose drive then begins at
another phase.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from math import inf

from core.design.camshaft import ENDS, Stroke, distances, drive_names, named_event, strokes, with_drives, with_phase
from core.design.design import Design
from core.design.edits import balance
from core.design.motion_edits import join_angles, join_range, with_join_moved
from core.design.parts import Motion
from core.frozen import frozen

HALF = 180.0 - 1e-6
"""A distance of half a turn and more would count from the other side [deg]."""


@frozen
class AngleRoom:
    """How far something can be turned from where it stands: back to ``low`` <= 0 and on to ``high`` >= 0 [deg]; ``low_row`` and
    ``high_row`` are the rows of ``design.timing`` that stop it there, None where the motion itself does or nothing."""

    low: float
    high: float
    low_row: int | None = None
    high_row: int | None = None

    def within(self, by: float) -> float:
        """The nearest turn that is left."""
        return min(max(by, self.low), self.high)

    def stop(self, by: float) -> int | None:
        """The row that stops a turn by so much."""
        return self.low_row if by < self.low else self.high_row if by > self.high else None


def machine_joins(design: Design, index: int) -> tuple[float, ...]:
    """Machine angles of the joins of a drive's motion, 0 ... 360; none of a drive without a motion."""
    drive = design.drives[index]
    return (
        ()
        if drive.motion is None
        else tuple(balance(drive.phase_deg, (-angle,)) % 360.0 for angle in join_angles(drive.motion))
    )


def events_at(design: Design, index: int, join: int) -> tuple[str, ...]:
    """The events that stand at a join: a rise or a return that ends there, one that starts there."""
    drive = design.drives[index]
    if drive.motion is None:
        return ()
    name, count = drive_names(design)[index], len(drive.motion.segments)
    places = [(stroke, (stroke.segments[0], (stroke.segments[-1] + 1) % count)) for stroke in strokes(drive.motion)]
    found = [(end, stroke) for stroke, ends in places for end, at in zip(ENDS, ends, strict=True) if at == join]
    return tuple(f"{name}.{stroke.name}.{end}" for end, stroke in sorted(found, key=lambda row: row[0]))


# -- turning ------------------------------------------------------------------------------------------------


def phase_room(design: Design, index: int) -> AngleRoom:
    """How far a drive can be turned against the others so that each distance which is kept now stays kept."""
    joins = range(len(machine_joins(design, index)))
    return _room(design, {event for join in joins for event in events_at(design, index, join)}, AngleRoom(-inf, inf))


def join_room(design: Design, index: int, join: int) -> AngleRoom:
    """The same of one join, whose neighbours stay where they are. Raises ValueError for a drive without a motion."""
    motion, place = _with_join_inside(design, index, join)
    if place == 0:
        return AngleRoom(0.0, 0.0)
    at, (low, high) = join_angles(motion)[place], join_range(motion, place)
    return _room(
        design,
        set(events_at(design, index, join)),
        AngleRoom(min(balance(low, (at,)), 0.0), max(balance(high, (at,)), 0.0)),
    )


def _room(design: Design, moved: Collection[str], room: AngleRoom) -> AngleRoom:
    """What the rows of the timing leave of a room. A row that is broken already holds nothing back."""
    for i, (row, at) in enumerate(zip(design.timing, distances(design), strict=True)):
        if not at.kept:
            continue
        grows = (named_event(design, row.second) in moved) - (named_event(design, row.first) in moved)
        low, high = -max(at.spare_deg, 0.0), HALF - at.spare_deg
        if grows < 0:
            low, high = -high, -low
        if grows and low > room.low:
            room = replace(room, low=low, low_row=i)
        if grows and high < room.high:
            room = replace(room, high=high, high_row=i)
    return room


def turn_drive(design: Design, index: int, phase_deg: float) -> Design:
    """A drive at another phase, 0 ... 360."""
    return with_phase(design, index, balance(phase_deg, ()) % 360.0)


def turn_join(design: Design, index: int, join: int, by: float) -> Design:
    """One join turned by so much. It may have faults where that is out of ``join_room``. Raises ValueError for a drive without a
    motion."""
    motion, place = _with_join_inside(design, index, join)
    if place == 0 or by == 0.0:
        return design
    motion = with_join_moved(motion, place, balance(join_angles(motion)[place], (-by,)))
    drive = design.drives[index]
    if join == 0:
        segments = (*motion.segments[1:], motion.segments[0])
        assert drive.motion is not None
        motion = replace(motion, start=drive.motion.start, segments=segments)
        drive = replace(drive, phase_deg=balance(drive.phase_deg, (-by,)) % 360.0)
    drives = list(design.drives)
    drives[index] = replace(drive, motion=motion)
    return with_drives(design, drives)


def _with_join_inside(design: Design, index: int, join: int) -> tuple[Motion, int]:
    """The motion of a drive and the number of its join; that of the join at cam angle 0 is 1 in the motion that begins a segment
    earlier, and stays 0 where the drive has no phase or is one segment."""
    motion = design.drives[index].motion
    if motion is None:
        raise ValueError("a drive without a motion has no joins")
    if join or not design.listed or len(motion.segments) < 2:
        return motion, join
    last = motion.segments[-1]
    earlier = replace(motion, start=balance(motion.start, (last.rise,)), segments=(last, *motion.segments[:-1]))
    return earlier, 1


# -- two drives at the same time ----------------------------------------------------------------------------


def moving(design: Design, index: int) -> tuple[tuple[float, float], ...]:
    """Where a drive rises or returns: from 0 ... 360 on, to past 360 where it goes on over the start of the turn; what follows each
    other at once is one."""
    drive = design.drives[index]
    rows = list(_placed(strokes(drive.motion), drive.phase_deg)) if drive.motion is not None else []
    return _joined(rows)


def together(design: Design, first: int, second: int) -> tuple[tuple[float, float], ...]:
    """Where both drives move, in the same form."""
    found = []
    for begin, end in moving(design, first):
        for other, last in moving(design, second):
            for turn in (-360.0, 0.0, 360.0):
                low, high = max(begin, other + turn), min(end, last + turn)
                if high > low:
                    found.append((low % 360.0, low % 360.0 + balance(high, (low,))))
    return _joined(sorted(set(found)))


def _placed(rows: tuple[Stroke, ...], phase: float) -> Iterator[tuple[float, float]]:
    for each in rows:
        begin = balance(each.start, (-phase,)) % 360.0
        yield begin, begin + balance(each.end, (each.start,))


def _joined(rows: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Stretches of the turn in their order, those that follow each other at once as one."""
    made: list[tuple[float, float]] = []
    for begin, end in sorted(rows):
        if made and begin <= made[-1][1] + 1e-9:
            made[-1] = made[-1][0], max(end, made[-1][1])
        else:
            made.append((begin, end))
    if len(made) > 1 and made[-1][1] >= made[0][0] + 360.0 - 1e-9:  # over the start of the turn
        begin, end = made.pop()
        made[0] = begin, max(end, made[0][1] + 360.0)
        made.sort()
    return tuple(made)


# -- time ---------------------------------------------------------------------------------------------------


def milliseconds(design: Design, angle: float) -> float:
    """How long the shaft takes for an angle [deg] at its constant speed [ms]."""
    return angle / 360.0 * 60_000.0 / design.speed_rpm
