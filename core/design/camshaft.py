"""Several drives on one shaft: a single drive as a design, edits of the list of drives, and sequence conditions.

``only`` returns one drive as a design and ``with_only`` puts it back, so that edits and studies of one drive apply to each of
several.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, count
from math import fsum

from core.design.curves import nose_deg, unsolved_segment
from core.design.design import SHARED, Design, Drive, TimingRow
from core.design.engine import CRANK_PER_CAM, HALF_CYCLE
from core.design.motions import Motion, NamedCurve, OptimalCurve
from core.design.outlines import FREE, ClearanceRow, Outline
from core.design.paths import all_paths, followed, row_at
from core.errors import DesignError, Fault
from core.file_names import no_device
from core.frozen import frozen

# -- several drives on one shaft --------------------------------------------------------------------------------


BALANCER = "balancer"
"""Name of the balance cam among the names of drives."""

RESERVED = ("motor", BALANCER)
"""Slugs that no drive may have, since columns of the shaft's table have them."""

_DECIMALS = 10  # of a centre, far below the accuracy of a search
_ON_SHAFT = ("name", "phase_deg", "mirrored", "carries")  # fields of a drive that a single drive does not have


def slug(name: str) -> str:
    """Name of a drive in columns and folders: lower case, with _ for other characters than letters and digits."""
    return no_device("".join(c if c.isalnum() else "_" for c in unicodedata.normalize("NFC", name).lower()))


def drive_names(design: Design) -> tuple[str, ...]:
    """Names of the drives; the name of the design where it has one drive."""
    return tuple(design.name if drive.name is None else drive.name for drive in design.drives)


def slugs(design: Design) -> tuple[str, ...]:
    """Slugs of the drives, in their order."""
    return tuple(map(slug, drive_names(design)))


def drive_at(path: str) -> tuple[int, str] | None:
    """Number of the drive in a path of the file, and the rest of the path: ``drives[1].cam.bore_mm`` gives (1, ``cam.bore_mm``).

    None for paths of the shaft, and for name, phase, mirroring and direction of a drive.
    """
    name, number, inside = row_at(path, "drives")
    return (number, inside) if name and inside and inside not in _ON_SHAFT else None


def is_shared(path: str) -> bool:
    """Whether a path belongs to a table that several drives share."""
    return path.startswith(tuple(f"{name}." for name in SHARED))


def is_of_shaft(path: str) -> bool:
    """Whether a path belongs to a table of the shaft: one that drives share, an outline, or a clearance."""
    return is_shared(path) or path.startswith(("outlines[", "clearances["))


def path_of(index: int, path: str) -> str:
    """Path in a file with several drives, from the path in a single drive."""
    return f"drives[{index}].{path}"


def drive_in(design: Design, path: str) -> tuple[int, str] | None:
    """Number of the drive and path in it, as ``drive_at``; (0, path) in a design without a list of drives."""
    return drive_at(path) if design.listed else (0, path)


def path_in(design: Design, index: int, path: str) -> str:
    """Path in the file of a design, from the path in a single drive; the inverse of ``drive_in``."""
    return path_of(index, path) if design.listed else path


def numbered(design: Design, name: str) -> int:
    """Number of the drive with a name or slug.

    Raises
    ------
    DesignError
        Where no drive has the name.
    """
    for names in (drive_names(design), slugs(design)):
        if name in names:
            return names.index(name)
    raise DesignError([Fault("drives", name, "no drive of that name", " | ".join(drive_names(design)))])


# -- a single drive of several ------------------------------------------------------------------------------


def only(design: Design, index: int) -> Design:
    """Design of a single drive, with its cam angle, its name and the speed of the shaft; a mirrored drive turns in the opposite sense.

    Flywheel, motor and flexible shaft, which belong to all drives, are left out. A design without a list of drives is
    returned as it is.
    """
    if not design.listed:
        return design
    drive = design.drives[index]
    paths = (path for path in design.assumed if path.startswith(path_of(index, "")))
    marks = [found[1] for path in paths if (found := drive_at(path)) is not None]
    marks += [path for path in design.assumed if path in ("shaft.rotation", "shaft.speed_rpm")]
    marks += [path for path in design.assumed if path.startswith("engine.")]
    single = replace(drive, name=None, phase_deg=0.0, mirrored=False, carries=())
    return Design(drive.name or "", design.shaft_of(drive), (single,), tuple(marks), engine=design.engine)


def in_machine(design: Design, single: Design) -> Design:
    """Design of a single drive with the name of the machine in its name."""
    return replace(single, name=f"{design.name}, drive {single.name}") if design.listed else single


def with_only(design: Design, index: int, single: Design) -> Design:
    """Design with one drive replaced by that of ``single``, with its name and assumed paths; the inverse of ``only``.

    Where ``single`` has another speed or sense of rotation, the shaft and all its drives get them.
    """
    if not design.listed:
        return single
    old, before = design.drives[index], only(design, index)
    drive = replace(single.drive, name=single.name, phase_deg=old.phase_deg, mirrored=old.mirrored, carries=old.carries)
    changed = with_drives(design, (*design.drives[:index], drive, *design.drives[index + 1 :]))
    if single.shaft is not None and design.shaft is not None and single.shaft != before.shaft:
        turning = replace(design, shaft=single.shaft).shaft_of(old)
        assert turning is not None
        shaft = replace(design.shaft, rotation=turning.rotation, speed_rpm=turning.speed_rpm)
        changed = turning_together(replace(changed, shaft=shaft))
    if single.engine != design.engine:
        changed = replace(changed, engine=single.engine)
    if single.assumed == before.assumed and single.name == before.name:
        return changed
    marks = [path for path in design.assumed if (found := drive_at(path)) is None or found[0] != index]
    new = [path_of(index, path) for path in single.assumed if not is_shared(path)]
    at = next((i for i, path in enumerate(design.assumed) if path not in marks), len(marks))
    return _renamed(replace(changed, assumed=(*marks[:at], *new, *marks[at:])), before.name, single.name)


_SAME_DEG = 1e-9  # machine angles that differ by less are equal


def with_mechanism(design: Design, index: int, single: Design) -> Design:
    """Design with one drive's mechanism replaced by that of ``single``; name, engine, and the speed of the shaft stay.

    What the drive carries stays where its motion has a known ratio to it. Sequence conditions follow the strokes of its motion, which may
    rise where they returned. A design without a list of drives is replaced.
    """
    if not design.listed:
        return single
    present = only(design, index)
    placed = replace(single, name=present.name, shaft=present.shaft, engine=present.engine)
    changed = with_only(design, index, placed)
    if placed.drive.carried_per_motion is None:
        row = replace(changed.drives[index], carries=())
        changed = with_drives(changed, (*changed.drives[:index], row, *changed.drives[index + 1 :]))
    return turning_together(_with_events_followed(design, changed, present.name))


def _with_events_followed(design: Design, changed: Design, name: str) -> Design:
    """The changed design with the events of a drive in its sequence conditions renamed to those at the same machine angles."""
    before, after = events(design), events(changed)

    def followed(event: str) -> str:
        named = named_event(design, event)
        if drive_of(named) != name or named not in before:
            return event
        end = named.rpartition(".")[2]
        same = (
            e
            for e, a in after.items()
            if drive_of(e) == name and e.endswith(end) and abs(a - before[named]) < _SAME_DEG
        )
        return next(same, event)

    rows = (replace(row, first=followed(row.first), second=followed(row.second)) for row in changed.timing)
    return replace(changed, timing=tuple(rows))


def with_drives(design: Design, drives: Sequence[Drive]) -> Design:
    """Design with other drives."""
    return replace(design, drives=tuple(drives))


def turning_together(design: Design) -> Design:
    """Design in which the drivers of linkages turn at the speed of the shaft."""
    if design.shaft is None:
        return design
    drives = []
    for drive in design.drives:
        shaft = design.shaft_of(drive)
        if drive.is_linkage and shaft is not None:
            driver = replace(drive.linkage.driver, speed_rpm=shaft.signed_rpm)
            drive = replace(drive, mechanism=replace(drive.linkage, driver=driver))
        drives.append(drive)
    return with_drives(design, drives)


# -- edits of the list of drives ----------------------------------------------------------------------------


def as_list(design: Design, name: str = "") -> Design:
    """Design of one drive with its drive in a list, named as given, else as the design.

    Raises
    ------
    DesignError
        For a linkage without a shaft; ``edits.with_shaft`` adds one.
    """
    if design.listed:
        return design
    if design.shaft is None:
        raise DesignError(
            [Fault("shaft", "(nothing)", "several drives need a shaft that turns them", "a table [shaft]")]
        )
    marks = tuple(path if is_of_shaft(path) else path_of(0, path) for path in design.assumed)
    name = name or design.name
    listed = replace(design, drives=(replace(design.drive, name=name),), assumed=marks)
    return _with_outlines_listed(listed, name)


def _with_outlines_listed(design: Design, name: str) -> Design:
    """Design whose outlines and clearances name the drive, which was the only one."""
    outlines = tuple(row if row.of in FREE else replace(row, drive=name) for row in design.outlines)
    clearances = tuple(
        replace(row, between=tuple(text if text in FREE else f"{slug(name)}.{text}" for text in row.between))
        for row in design.clearances
    )
    return replace(design, outlines=outlines, clearances=clearances)


def add_drive(design: Design, single: Design, name: str = "") -> Design:
    """Design with the drive of another design added at the end, at the speed of this shaft; a used name gets a number."""
    design = as_list(design)
    index = len(design.drives)
    drive = replace(single.drive, name=free_name(design, name or single.name), phase_deg=0.0, mirrored=False)
    marks = [path_of(index, path) for path in single.assumed if not is_of_shaft(path)]
    engine = design.engine or single.engine
    outlines = (replace(row, drive=drive.name) for row in single.outlines if not (single.listed or row.of in FREE))
    longer = replace(
        design,
        drives=(*design.drives, drive),
        assumed=(*design.assumed, *marks),
        engine=engine,
        outlines=(*design.outlines, *outlines),
    )
    return _in_file_order(turning_together(longer))


def copy_drive(design: Design, index: int) -> Design:
    """Design with a copy of one drive, right after it."""
    drive = replace(design.drives[index], name=free_name(design, design.drives[index].name or ""))
    longer = _reordered(design, [*range(index + 1), index, *range(index + 1, len(design.drives))])
    return with_drives(longer, (*longer.drives[: index + 1], drive, *longer.drives[index + 2 :]))


def remove_drive(design: Design, index: int) -> Design:
    """Design without one drive and the sequence conditions that name it; the only drive stays."""
    if len(design.drives) == 1:
        return design
    name = design.drives[index].name or ""
    names = {name, slug(name)}
    fewer = reorder_timing(
        design, [i for i, t in enumerate(design.timing) if not names & {drive_of(t.first), drive_of(t.second)}]
    )
    fewer = _with_outlines_of(fewer, name, None)
    return _reordered(fewer, [i for i in range(len(design.drives)) if i != index])


def move_drive(design: Design, index: int, to: int) -> Design:
    """Design with one drive moved to another position in the list."""
    order = [i for i in range(len(design.drives)) if i != index]
    order.insert(to, index)
    return _reordered(design, order)


def rename_drive(design: Design, index: int, name: str) -> Design:
    """Design with one drive renamed, in the sequence conditions too; the name may be faulty, see ``faults``."""
    old = design.drives[index].name or ""
    drives = list(design.drives)
    drives[index] = replace(drives[index], name=name)
    return _renamed(with_drives(design, drives), old, name)


def phase_path(design: Design, index: int) -> str:
    """Path of the field that determines the phase of a drive: the centre of its valve, else the phase itself."""
    return path_of(index, "phase_deg" if design.drives[index].valve is None else "valve.centre_deg")


def phase_value(design: Design, index: int, phase_deg: float) -> float:
    """Value of the field at ``phase_path`` with which a drive has a phase; a centre is the one nearest to the present centre."""
    drive = design.drives[index]
    if drive.valve is None or drive.motion is None:
        return phase_deg
    centre = CRANK_PER_CAM * (phase_deg + nose_deg(drive.motion)) - drive.valve.cylinder_deg
    cycle = 2.0 * HALF_CYCLE
    return round(centre - cycle * round((centre - drive.valve.centre_deg) / cycle), _DECIMALS) + 0.0


def with_phase(design: Design, index: int, phase_deg: float) -> Design:
    """Design with another phase of one drive; a drive that moves a valve has another centre."""
    return with_phase_value(design, index, phase_value(design, index, phase_deg))


def with_phase_value(design: Design, index: int, value: float) -> Design:
    """Design with another value of the field at ``phase_path``."""
    drives, drive = list(design.drives), design.drives[index]
    valve = drive.valve
    if valve is None:
        drives[index] = replace(drive, phase_deg=value)
    else:
        drives[index] = replace(drive, valve=replace(valve, centre_deg=value))
    return with_drives(design, drives)


def with_timing(design: Design, index: int, row: TimingRow) -> Design:
    """Design with one sequence condition replaced, or added after the last."""
    rows = list(design.timing)
    rows[index : index + 1] = [row]
    return replace(design, timing=tuple(rows))


def reorder_timing(design: Design, order: Sequence[int]) -> Design:
    """Design with the sequence conditions of these numbers, in this order, and their assumed paths."""
    marks = followed(design.assumed, "timing", order)
    return _in_file_order(replace(design, timing=tuple(design.timing[i] for i in order), assumed=marks))


def free_name(design: Design, name: str) -> str:
    """The name, with the next free number where its slug is used: ``Roller``, ``Roller 2``, ``Roller 3``."""
    used = {*slugs(design), *RESERVED}
    match = re.search(r" ([1-9][0-9]?)$", name)
    stem, number = (name[: match.start()], int(match[1])) if match else (name, 1)
    names = chain((name,), (f"{stem} {n}" for n in count(number + 1)))
    return next(candidate for candidate in names if slug(candidate) not in used)


def drive_of(event: str) -> str:
    """Name of the drive in an event, ``NAME.rise.1.start``."""
    return event.rsplit(".", 3)[0]


def _renamed(design: Design, old: str, name: str) -> Design:
    """Design with a drive renamed in the sequence conditions, outlines and clearances."""
    if old == name:
        return design
    design = _with_outlines_of(design, old, name)
    if not design.timing:
        return design

    def event(text: str) -> str:
        written = drive_of(text)
        return name + text.removeprefix(written) if written in (old, slug(old)) else text

    return replace(design, timing=tuple(TimingRow(event(t.first), event(t.second), t.least_deg) for t in design.timing))


def _with_outlines_of(design: Design, old: str, name: str | None) -> Design:
    """Design whose outlines and clearances name a drive by its new name; without those of a removed drive (None)."""
    if not (design.outlines or design.clearances):
        return design
    written = (old, slug(old))

    def outline(row: Outline) -> Outline | None:
        if row.drive not in written:
            return row
        return None if name is None else replace(row, drive=name)

    def clearance(row: ClearanceRow) -> ClearanceRow | None:
        parts = [text.rpartition(".") for text in row.between]
        if name is None:
            return None if any(drive in written for drive, _, _ in parts) else row
        return replace(
            row,
            between=tuple(f"{slug(name) if drive in written else drive}{dot}{word}" for drive, dot, word in parts),
        )

    outlines = [(i, new) for i, row in enumerate(design.outlines) if (new := outline(row)) is not None]
    clearances = [(i, kept) for i, row in enumerate(design.clearances) if (kept := clearance(row)) is not None]
    marks = followed(design.assumed, "outlines", [i for i, _ in outlines])
    marks = followed(marks, "clearances", [i for i, _ in clearances])
    return replace(
        design,
        outlines=tuple(row for _, row in outlines),
        clearances=tuple(row for _, row in clearances),
        assumed=marks,
    )


def _reordered(design: Design, order: Sequence[int]) -> Design:
    """Design with the drives of these numbers, in this order, and their assumed paths."""
    marks = followed(design.assumed, "drives", order)
    return _in_file_order(with_drives(replace(design, assumed=marks), [design.drives[i] for i in order]))


def _in_file_order(design: Design) -> Design:
    order = {path: i for i, path in enumerate(all_paths(design))}
    return replace(design, assumed=tuple(sorted(design.assumed, key=lambda path: order.get(path, len(order)))))


# -- sequence conditions ----------------------------------------------------------------------------------------


ENDS = ("start", "end")
ROUNDING = 1e-9  # [deg] permitted violation of a sequence condition


@frozen
class Stroke:
    """A rise or a return of a motion: its name ``rise.1``, its segments, and its cam angles [deg].

    The end is above 360 where it continues past the start of the turn.
    """

    name: str
    segments: tuple[int, ...]
    start: float
    end: float


def strokes(motion: Motion) -> tuple[Stroke, ...]:
    """Rises and returns of a motion, in the order of the turn."""
    count = len(motion.segments)
    directions = [(segment.rise > 0.0) - (segment.rise < 0.0) for segment in motion.segments]
    begins = [fsum(s.span_deg for s in motion.segments[:i]) for i in range(count)]
    result: list[Stroke] = []
    numbers = {"rise": 0, "return": 0}
    for i in range(count):
        if not directions[i] or (directions[i - 1] == directions[i] and count > 1 and len(set(directions)) > 1):
            continue
        if len(set(directions)) == 1 and i:  # one stroke over the full turn
            break
        run = [i]
        while len(run) < count and directions[(run[-1] + 1) % count] == directions[i]:
            run.append((run[-1] + 1) % count)
        word = "rise" if directions[i] > 0 else "return"
        numbers[word] += 1
        span = fsum(motion.segments[k].span_deg for k in run)
        result.append(Stroke(f"{word}.{numbers[word]}", tuple(run), begins[i], begins[i] + span))
    return tuple(result)


def events(design: Design) -> Mapping[str, float]:
    """Event ``feed.return.1.end`` -> machine angle 0 ... 360 [deg], of all drives with a motion."""
    angles: dict[str, float] = {}
    for name, drive in zip(drive_names(design), design.drives, strict=True):
        for stroke in strokes(drive.motion) if drive.motion is not None else ():
            for end, angle in zip(ENDS, (stroke.start, stroke.end), strict=True):
                angles[f"{name}.{stroke.name}.{end}"] = (angle + drive.phase) % 360.0
    return angles


@frozen
class TimingDistance:
    """Distances of a sequence condition [deg].

    Attributes
    ----------
    first_deg, second_deg : machine angles of both events [deg]
    after_deg : distance from the first to the second [deg]
    spare_deg : distance beyond the required one [deg], negative where the condition is violated
    """

    first_deg: float
    second_deg: float
    after_deg: float
    spare_deg: float

    @property
    def kept(self) -> bool:
        """Whether the condition is satisfied, within rounding."""
        return self.spare_deg >= -ROUNDING


def distances(design: Design) -> tuple[TimingDistance, ...]:
    """Distances of every sequence condition.

    Raises
    ------
    KeyError
        For an unknown event.
    """
    at = events(design)
    result = []
    for row in design.timing:
        first, second = at[named_event(design, row.first)], at[named_event(design, row.second)]
        spare = (second - first - row.least_deg + 180.0) % 360.0 - 180.0
        result.append(TimingDistance(first, second, spare + row.least_deg, spare))
    return tuple(result)


def named_event(design: Design, event: str) -> str:
    """The event with the name of its drive in place of its slug."""
    name, names = drive_of(event), drive_names(design)
    if name in names:
        return event
    by_slug = dict(zip(slugs(design), names, strict=True))
    return by_slug[name] + event.removeprefix(name) if name in by_slug else event


def contradiction(design: Design) -> tuple[int, ...]:
    """Sequence conditions that no phases satisfy together in the present order of their events, as a cycle; () where there are none.

    A condition requires that phase(second) - phase(first) is at least its present shortfall. Around a cycle these
    differences add up to 0, so that conditions with a positive sum contradict each other (positive cycle, by Bellman and
    Ford). With the events in another order they may be satisfiable.
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
    reach, arc_to = [0.0] * len(names), [-1] * len(names)
    last = -1
    for _ in range(len(names) + 1):
        last = -1
        for i, (start, end, shortfall) in enumerate(arcs):
            if reach[start] + shortfall > reach[end] + ROUNDING:
                reach[end], arc_to[end], last = reach[start] + shortfall, i, end
        if last < 0:
            return ()
    for _ in names:  # back into the cycle
        last = arcs[arc_to[last]][0]
    cycle: list[int] = []
    at = last
    while arc_to[at] not in cycle:
        cycle.append(arc_to[at])
        at = arcs[arc_to[at]][0]
    return tuple(reversed(cycle))


def excess(design: Design, cycle: Sequence[int]) -> float:
    """Angle that a cycle of contradicting conditions requires beyond a full turn [deg]."""
    rows = distances(design)
    return fsum(-rows[i].spare_deg for i in cycle)


# -- optimal laws of all drives ---------------------------------------------------------------------------------


def unsolved_motions(design: Design) -> tuple[Motion, ...]:
    """Motions of a design with optimal laws that are not solved yet: reading them takes long."""
    motions = dict.fromkeys(drive.motion for drive in design.drives if drive.motion is not None)
    return tuple(motion for motion in motions if unsolved_segment(motion) is not None)


def with_plain_laws(design: Design) -> Design:
    """Design with a cycloidal law in place of every optimal one, whose motion is known at once."""

    def plain(motion: Motion) -> Motion:
        if not any(isinstance(segment.curve, OptimalCurve) for segment in motion.segments):
            return motion
        rows = (
            replace(s, curve=NamedCurve("cycloidal")) if isinstance(s.curve, OptimalCurve) else s
            for s in motion.segments
        )
        return replace(motion, segments=tuple(rows), follows=None)

    drives = (d if d.motion is None else replace(d, motion=plain(d.motion)) for d in design.drives)
    return replace(design, drives=tuple(drives))
