"""What must come after what on a shaft of several drives: events of their motions by machine angle, distances kept and broken.

An event is where a rise or a return starts or ends. Segments that follow each other and go the same way are one rise or
return; they are numbered from cam angle 0 on, by where they start. A turn has no first event, so that a distance counts within half
a turn of what it must be: 5° before is 5° too early, not 355° late.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import fsum

from core.design.camshaft import drive_names, drive_of, slugs
from core.design.parts import Motion, Segment
from core.design.whole import Design
from core.frozen import frozen

ENDS = ("start", "end")
ROUNDING = 1e-9  # [deg] by which a distance that is kept may miss


@frozen
class Stroke:
    """A rise or a return of a motion: its name ``rise.1``, the segments it takes, its own cam angles [deg], the end past 360
    where it goes on over the start of the turn."""

    name: str
    segments: tuple[int, ...]
    start: float
    end: float


def strokes(motion: Motion) -> tuple[Stroke, ...]:
    """Rises and returns in the order of the turn."""
    count = len(motion.segments)
    sense = [_sense(segment) for segment in motion.segments]
    begins = [fsum(s.span_deg for s in motion.segments[:i]) for i in range(count)]
    found: list[Stroke] = []
    numbers = {"rise": 0, "return": 0}
    for i in range(count):
        if not sense[i] or (sense[i - 1] == sense[i] and count > 1 and len(set(sense)) > 1):
            continue
        if len(set(sense)) == 1 and i:  # one way all around
            break
        run = [i]
        while len(run) < count and sense[(run[-1] + 1) % count] == sense[i]:
            run.append((run[-1] + 1) % count)
        word = "rise" if sense[i] > 0 else "return"
        numbers[word] += 1
        span = fsum(motion.segments[k].span_deg for k in run)
        found.append(Stroke(f"{word}.{numbers[word]}", tuple(run), begins[i], begins[i] + span))
    return tuple(found)


def _sense(segment: Segment) -> int:
    return (segment.rise > 0.0) - (segment.rise < 0.0)


def events(design: Design) -> Mapping[str, float]:
    """Event -> machine angle [deg], 0 ... 360, of all drives that follow a motion: ``feed.return.1.end``."""
    found: dict[str, float] = {}
    for name, drive in zip(drive_names(design), design.drives, strict=True):
        for each in strokes(drive.motion) if drive.motion is not None else ():
            for end, angle in zip(ENDS, (each.start, each.end), strict=True):
                found[f"{name}.{each.name}.{end}"] = (angle + drive.phase_deg) % 360.0
    return found


@frozen
class TimingDistance:
    """How a timing is kept: machine angles of both events, how far the second comes after the first, and how much further than
    it must [deg]; negative where it is broken."""

    first_deg: float
    second_deg: float
    after_deg: float
    spare_deg: float

    @property
    def kept(self) -> bool:
        """Whether the second event comes late enough, but for rounding."""
        return self.spare_deg >= -ROUNDING


def distances(design: Design) -> tuple[TimingDistance, ...]:
    """Of each row of ``design.timing``. Raises KeyError for an event that there is not."""
    at = events(design)
    made = []
    for row in design.timing:
        first, second = at[named_event(design, row.first)], at[named_event(design, row.second)]
        spare = (second - first - row.least_deg + 180.0) % 360.0 - 180.0
        made.append(TimingDistance(first, second, spare + row.least_deg, spare))
    return tuple(made)


def named_event(design: Design, event: str) -> str:
    """An event by its drive's name, where it is written by its slug."""
    name, names = drive_of(event), drive_names(design)
    if name in names:
        return event
    by_slug = dict(zip(slugs(design), names, strict=True))
    return by_slug[name] + event.removeprefix(name) if name in by_slug else event


def contradiction(design: Design) -> tuple[int, ...]:
    """Rows of ``design.timing`` that no phases keep together in the order in which their events come now, as they follow each other
    in a ring; () where none do. With one drive turned past another they may be kept, half a turn apart.

    A row asks that phase(second) - phase(first) be at least what it lacks now. Around a ring these differences add up to 0, so
    that rows which ask for more than 0 contradict each other (a ring of positive sum, by Bellman and Ford). Where nothing is
    broken nothing contradicts.
    """
    rows = distances(design)
    names = list(drive_names(design))
    arcs = [
        (
            names.index(drive_of(named_event(design, t.first))),
            names.index(drive_of(named_event(design, t.second))),
            -d.spare_deg,
        )
        for t, d in zip(design.timing, rows, strict=True)
    ]
    reach, by = [0.0] * len(names), [-1] * len(names)
    last = -1
    for _ in range(len(names) + 1):
        last = -1
        for i, (start, end, wanted) in enumerate(arcs):
            if reach[start] + wanted > reach[end] + ROUNDING:
                reach[end], by[end], last = reach[start] + wanted, i, end
        if last < 0:
            return ()
    for _ in names:  # back into the ring
        last = arcs[by[last]][0]
    ring: list[int] = []
    at = last
    while by[at] not in ring:
        ring.append(by[at])
        at = arcs[by[at]][0]
    return tuple(reversed(ring))


def excess(design: Design, ring: Sequence[int]) -> float:
    """By how much the rows of a ring ask for more than there is [deg]."""
    rows = distances(design)
    return fsum(-rows[i].spare_deg for i in ring)
