"""Several drives on one shaft: each alone, as it stands there, and edits of their list.

``only`` takes a drive off its shaft and ``with_only`` puts it back; what serves a design of one drive, an edit or a study, thereby
serves each of several.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import fsum

from core.design.design import Design, Drive, TimingRow
from core.design.parts import Motion, Segment, Shaft
from core.design.paths import all_paths, followed, row_at
from core.errors import DesignError, Fault
from core.file_names import no_device
from core.frozen import frozen

# -- several drives on one shaft --------------------------------------------------------------------------------


BALANCER = "balancer"
"""What the balance cam is called where a drive is named."""

RESERVED = ("motor", BALANCER)
"""Slugs that no drive may have: columns of the shaft's table have them."""

_OTHER = {"ccw": "cw", "cw": "ccw"}
_OWN = ("name", "phase_deg", "mirrored", "carries")  # of a drive's place on its shaft


def slug(name: str) -> str:
    """A drive's name as columns and folders have it: in lower case, what is no letter and no digit as _; of no device of Windows."""
    return no_device("".join(c if c.isalnum() else "_" for c in unicodedata.normalize("NFC", name).lower()))


def drive_names(design: Design) -> tuple[str, ...]:
    """The drives by name; the design's own name where it is of one drive alone."""
    return tuple(design.name if drive.name is None else drive.name for drive in design.drives)


def slugs(design: Design) -> tuple[str, ...]:
    """Those of the drives, in their order."""
    return tuple(map(slug, drive_names(design)))


def drive_at(path: str) -> tuple[int, str] | None:
    """Number of the drive that a path of the file leads into, and the path in it alone: ``drives[1].cam.bore_mm`` gives
    (1, ``cam.bore_mm``). None for what belongs to the shaft, and for a drive's name, phase and side."""
    name, number, inside = row_at(path, "drives")
    return (number, inside) if name and inside and inside not in _OWN else None


def path_of(index: int, path: str) -> str:
    """The path in the whole file of one that leads into a drive alone."""
    return f"drives[{index}].{path}"


def drive_in(design: Design, path: str) -> tuple[int, str] | None:
    """As ``drive_at``, of a path in the file of a design: of one that lists no drives (0, path)."""
    return drive_at(path) if design.listed else (0, path)


def path_in(design: Design, index: int, path: str) -> str:
    """The inverse: the path in the file of a design of one that leads into a drive alone."""
    return path_of(index, path) if design.listed else path


def numbered(design: Design, name: str) -> int:
    """The number of the drive of this name, or slug. Raises DesignError."""
    for names in (drive_names(design), slugs(design)):
        if name in names:
            return names.index(name)
    raise DesignError([Fault("drives", name, "no drive of that name", " | ".join(drive_names(design)))])


# -- one of several -----------------------------------------------------------------------------------------


def only(design: Design, index: int) -> Design:
    """The design of one drive alone, by its own cam angle, as it stands on its shaft: at its speed, a mirrored one turning the
    other way. Without flywheel, motor and flexible shaft, which belong to all drives together. It has the drive's name.

    A design that is of one drive alone is that drive's.
    """
    if not design.listed:
        return design
    drive = design.drives[index]
    of_it = (path for path in design.assumed if path.startswith(path_of(index, "")))
    marks = [own[1] for path in of_it if (own := drive_at(path)) is not None]
    marks += [path for path in design.assumed if path in ("shaft.rotation", "shaft.speed_rpm")]
    alone = replace(drive, name=None, phase_deg=0.0, mirrored=False, carries=())
    return Design(drive.name or "", _shaft_of(design, drive), (alone,), tuple(marks))


def in_machine(design: Design, single: Design) -> Design:
    """The design of one drive under a name that serves outside, where the machine's other drives are not beside it."""
    return replace(single, name=f"{design.name}, drive {single.name}") if design.listed else single


def _shaft_of(design: Design, drive: Drive) -> Shaft | None:
    """Speed and sense of the shaft as the drive sees them."""
    shaft = design.shaft
    if shaft is None:
        return None
    rotation = _OTHER.get(shaft.rotation, shaft.rotation) if drive.mirrored else shaft.rotation
    return Shaft(rotation, shaft.speed_rpm)


def with_only(design: Design, index: int, single: Design) -> Design:
    """The inverse of ``only``: the design with one drive as ``single`` has it, its name and what is assumed of it included.
    Where ``single`` turns at another speed, or the other way, so does the shaft, and with it all that it drives."""
    if not design.listed:
        return single
    old, before = design.drives[index], only(design, index)
    drive = replace(single.drive, name=single.name, phase_deg=old.phase_deg, mirrored=old.mirrored, carries=old.carries)
    changed = with_drives(design, (*design.drives[:index], drive, *design.drives[index + 1 :]))
    if single.shaft is not None and design.shaft is not None and single.shaft != before.shaft:
        turning = _shaft_of(replace(design, shaft=single.shaft), old)
        assert turning is not None
        shaft = replace(design.shaft, rotation=turning.rotation, speed_rpm=turning.speed_rpm)
        changed = turning_together(replace(changed, shaft=shaft))
    if single.assumed == before.assumed and single.name == before.name:
        return changed
    marks = [path for path in design.assumed if (own := drive_at(path)) is None or own[0] != index]
    new = [path_of(index, path) for path in single.assumed if not path.startswith("shaft.")]
    at = next((i for i, path in enumerate(design.assumed) if path not in marks), len(marks))
    return _renamed(replace(changed, assumed=(*marks[:at], *new, *marks[at:])), before.name, single.name)


def with_drives(design: Design, drives: Sequence[Drive]) -> Design:
    """The design with these drives."""
    return replace(design, drives=tuple(drives))


def turning_together(design: Design) -> Design:
    """The design whose linkages' drivers turn as its shaft does."""
    if design.shaft is None:
        return design
    drives = []
    for drive in design.drives:
        shaft = _shaft_of(design, drive)
        if drive.is_linkage and shaft is not None:
            driver = replace(drive.linkage.driver, speed_rpm=shaft.signed_rpm)
            drive = replace(drive, mechanism=replace(drive.linkage, driver=driver))
        drives.append(drive)
    return with_drives(design, drives)


# -- edits of the list --------------------------------------------------------------------------------------


def as_list(design: Design, name: str = "") -> Design:
    """A design of one drive as one whose drives are listed; the drive is called as given, else as the design. Raises DesignError for a
    linkage without a shaft: give it one first (``edits.with_shaft``)."""
    if design.listed:
        return design
    if design.shaft is None:
        raise DesignError(
            [Fault("shaft", "(nothing)", "a drive of several needs the shaft that turns them", "a table [shaft]")]
        )
    marks = tuple(path if path.startswith("shaft.") else path_of(0, path) for path in design.assumed)
    return replace(design, drives=(replace(design.drive, name=name or design.name),), assumed=marks)


def add_drive(design: Design, single: Design, name: str = "") -> Design:
    """One drive more, behind the others: that of a design of one, which turns as this shaft does. A name that is taken gets a
    number."""
    design = as_list(design)
    index = len(design.drives)
    drive = replace(single.drive, name=free_name(design, name or single.name), phase_deg=0.0, mirrored=False)
    marks = [path_of(index, path) for path in single.assumed if not path.startswith("shaft.")]
    return _in_file_order(
        turning_together(replace(design, drives=(*design.drives, drive), assumed=(*design.assumed, *marks)))
    )


def copy_drive(design: Design, index: int) -> Design:
    """One drive more, the same as one there, right behind it."""
    drive = replace(design.drives[index], name=free_name(design, design.drives[index].name or ""))
    made = _reordered(design, [*range(index + 1), index, *range(index + 1, len(design.drives))])
    return with_drives(made, (*made.drives[: index + 1], drive, *made.drives[index + 2 :]))


def remove_drive(design: Design, index: int) -> Design:
    """One drive less, with the timing that names it; the only one stays."""
    if len(design.drives) == 1:
        return design
    name = design.drives[index].name or ""
    names = {name, slug(name)}
    fewer = reorder_timing(
        design, [i for i, t in enumerate(design.timing) if not names & {drive_of(t.first), drive_of(t.second)}]
    )
    return _reordered(fewer, [i for i in range(len(design.drives)) if i != index])


def move_drive(design: Design, index: int, to: int) -> Design:
    """One drive at another place of the list."""
    order = [i for i in range(len(design.drives)) if i != index]
    order.insert(to, index)
    return _reordered(design, order)


def rename_drive(design: Design, index: int, name: str) -> Design:
    """One drive called otherwise, in the timing too. It may have faults then: ask ``faults``."""
    old = design.drives[index].name or ""
    drives = list(design.drives)
    drives[index] = replace(drives[index], name=name)
    return _renamed(with_drives(design, drives), old, name)


def with_phase(design: Design, index: int, phase_deg: float) -> Design:
    """One drive turned against the others."""
    drives = list(design.drives)
    drives[index] = replace(drives[index], phase_deg=phase_deg)
    return with_drives(design, drives)


def with_timing(design: Design, index: int, row: TimingRow) -> Design:
    """One row of the timing in place of the one there; behind the last it is one more."""
    rows = list(design.timing)
    rows[index : index + 1] = [row]
    return replace(design, timing=tuple(rows))


def reorder_timing(design: Design, order: Sequence[int]) -> Design:
    """The rows of the timing of these numbers, in this order: one less, moved, or twice; marks of what is assumed go with them."""
    marks = followed(design.assumed, "timing", order)
    return _in_file_order(replace(design, timing=tuple(design.timing[i] for i in order), assumed=marks))


def free_name(design: Design, name: str) -> str:
    """The name, with a number behind it where a drive has one of the same slug."""
    taken = {*slugs(design), *RESERVED}
    names = (name, *(f"{name} {number}" for number in range(2, len(design.drives) + 4)))
    return next(each for each in names if slug(each) not in taken)


def drive_of(event: str) -> str:
    """The drive's name in ``NAME.rise.1.start``."""
    return event.rsplit(".", 3)[0]


def _renamed(design: Design, old: str, name: str) -> Design:
    """What the timing says of the drive of one name said of another."""
    if old == name or not design.timing:
        return design

    def event(text: str) -> str:
        written = drive_of(text)
        return name + text.removeprefix(written) if written in (old, slug(old)) else text

    return replace(design, timing=tuple(TimingRow(event(t.first), event(t.second), t.least_deg) for t in design.timing))


def _reordered(design: Design, order: Sequence[int]) -> Design:
    """The drives of these numbers; what is assumed of each goes with it."""
    marks = followed(design.assumed, "drives", order)
    return _in_file_order(with_drives(replace(design, assumed=marks), [design.drives[i] for i in order]))


def _in_file_order(design: Design) -> Design:
    place = {path: i for i, path in enumerate(all_paths(design))}
    return replace(design, assumed=tuple(sorted(design.assumed, key=lambda path: place.get(path, len(place)))))


# -- what must come after what on a shaft of several drives -----------------------------------------------------


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
