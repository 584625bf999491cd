"""A design that does not fit together yet: edits of single values, and what has been typed of it beside the last one that did.

Of a motion also by how much it misses, and a way to close it: whole is one whose spans make one turn, whose rises come back to the
start, and whose laws fit their rises.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

from core.design.camshaft import drive_at, only, path_of, with_only
from core.design.design import Design, Drive
from core.design.edits import back_at_start, balance, edited, is_dwell, with_law
from core.design.motion_edits import (
    MIRRORS,
    motion_of,
    remove_segment,
    require_motion,
    with_marks_of,
    with_motion,
    with_total_span,
)
from core.design.parts import Motion, NamedCurve, Segment
from core.design.paths import all_paths
from core.design.rules import CLOSING, faults, incomplete_faults, part_faults, total_of
from core.errors import Fault
from core.laws import find_law

RETURN_LAW = "modified-sine"
"""Of a return that no other segment gives a law."""

_CELL = re.compile(r"motion\.segments\[(\d+)\]\.(span_deg|rise|law)(?:_mm|_deg)?")


def span_gap(motion: Motion) -> float:
    """By how much the spans exceed one turn [deg]; 0 where they make one."""
    return _gap(total_of(s.span_deg for s in motion.segments) - 360.0)


def rise_gap(motion: Motion) -> float:
    """How far above its start, and its advance, the follower ends, in the motion's unit; 0 where it comes back."""
    return _gap(total_of(s.rise for s in motion.segments) - motion.gain)


def _gap(number: float) -> float:
    return 0.0 if abs(number) <= CLOSING else balance(number, ())


def lacks(design: Design) -> list[Fault]:
    """What the motion of a design still lacks to be whole, each motion where there are several; it may have other faults
    besides."""
    if design.listed:
        singles = ((i, lacks(only(design, i))) for i in range(len(design.drives)))
        return [replace(fault, path=path_of(i, fault.path)) for i, found in singles for fault in found]
    motion = motion_of(design)
    return [] if motion is None else incomplete_faults(motion, "motion")


def laid_out(design: Design, path: str, value: object, typed: Collection[str] = ()) -> Design:
    """The design with a value of its motion changed, which need not be whole before or after.

    What was in balance stays so, by the segment that gives or takes the difference (``edited``), one of those typed before only
    where no other can; where that is not possible, or the motion was out of balance already, only the one value changes.
    """
    if design.listed and (own := drive_at(path)) is not None:
        return with_only(design, own[0], laid_out(only(design, own[0]), own[1], value))
    cell = _CELL.fullmatch(path)
    if cell is None:
        return edited(design, path, value)
    kind, gap = (
        ("span_deg", span_gap) if cell[2] == "span_deg" else ("rise", rise_gap)
    )  # a law that rests takes a rise away
    motion = require_motion(design)
    alone = _with_cell(motion, int(cell[1]), cell[2], value)
    if cell[2] == "law" and _way_back_waits(motion, alone, int(cell[1])):
        missing = -rise_gap(alone)
        return with_motion(
            design,
            alone if is_dwell(alone.segments[int(cell[1])]) else _with_cell(alone, int(cell[1]), "rise", missing),
        )
    if gap(motion) == 0.0 != gap(alone):
        kept = {int(each[1]) for before in typed if (each := _CELL.fullmatch(before)) is not None and each[2] == kind}
        balanced = edited(design, path, value, kept)
        if len(faults(balanced)) <= len(faults(design)):
            return balanced
    return with_motion(design, alone)


def _way_back_waits(before: Motion, after: Motion, index: int) -> bool:
    """Whether a rise has become a dwell, and the only other segment that moves would lose its own rise to it: that is kept for the way
    back; or a dwell has become the rise that it waits for."""
    moving = [s for i, s in enumerate(after.segments) if i != index and not is_dwell(s)]
    now, was = after.segments[index], before.segments[index]
    if is_dwell(now):
        return not before.gain and was.rise != 0.0 and len(moving) == 1 and rise_gap(before) == 0.0
    return is_dwell(was) and len(moving) == 1 and rise_gap(before) != 0.0


def one_value_apart(design: Design, other: Design, path: str) -> bool:
    """Whether the motions of two designs differ in nothing but the span, rise or law at a path."""
    cell, one, two = _CELL.fullmatch(path), motion_of(design), motion_of(other)
    if cell is None or one is None or two is None or len(one.segments) != len(two.segments):
        return False
    index = int(cell[1])
    without: dict[str, Any] = {{"law": "curve"}.get(cell[2], cell[2]): None}
    first, second = (replace(m.segments[index], **without) for m in (one, two))
    there = replace(two, segments=(*two.segments[:index], one.segments[index], *two.segments[index + 1 :]))
    return first == second and one == there


def _with_cell(motion: Motion, index: int, key: str, value: Any) -> Motion:
    """One value of a segment changed and no other; a dwell does not rise."""
    segment = motion.segments[index]
    if key == "law":
        changed = with_law(replace(motion, segments=(segment,)), 0, str(value)).segments[0]
    else:
        changed = replace(segment, **{key: value})
    return replace(motion, segments=(*motion.segments[:index], changed, *motion.segments[index + 1 :]))


def remove_laid_out(design: Design, index: int) -> Design:
    """A segment taken out of a motion, which need not be whole: what is out of balance stays so."""
    return remove_segment(design, index, balanced=not lacks(design))


# -- what is typed beside the last design that fits --------------------------------------------------------


def merged(base: Design, mine: Design, theirs: Design) -> Design:
    """``mine``, in which all is changed that ``theirs`` has changed of ``base``; where both have changed a value, it is theirs.

    All three have the same drives, or theirs has others. A motion is one value, since its spans and rises depend on each other.
    """
    if mine is base:
        return theirs
    made: Design = _merged(base, mine, theirs)
    if made.listed:
        made = replace(made, drives=_merged_drives(base.drives, mine.drives, theirs.drives))
    new = ({*mine.assumed} | {*theirs.assumed}) - {*base.assumed}
    marks = ({*base.assumed} & {*mine.assumed} & {*theirs.assumed}) | (new and new & {*all_paths(made)})
    return replace(
        made, assumed=tuple(path for path in dict.fromkeys((*mine.assumed, *theirs.assumed)) if path in marks)
    )


def _merged(base: Any, mine: Any, theirs: Any) -> Any:
    if mine == base:
        return theirs
    if theirs == base:
        return mine
    kinds = {type(each) for each in (base, mine, theirs)}
    if kinds == {tuple} and len(base) == len(mine) == len(theirs):
        return tuple(map(_merged, base, mine, theirs))
    if len(kinds) == 1 and is_dataclass(mine) and kinds != {Motion}:
        names = [each.name for each in fields(mine)]
        values = {name: _merged(*(getattr(part, name) for part in (base, mine, theirs))) for name in names}
        return replace(mine, **values)  # type: ignore[type-var]
    return theirs


def _merged_drives(base: tuple[Drive, ...], mine: tuple[Drive, ...], theirs: tuple[Drive, ...]) -> tuple[Drive, ...]:
    """Drives go by their names; one of a new name, of as many as there were, by its place."""
    places = {drive.name: i for i, drive in enumerate(base)}
    if len(theirs) == len(base):
        names = [drive.name for drive in theirs]
        places |= {name: i for i, name in enumerate(names) if name not in places and base[i].name not in names}
    return tuple(
        _merged(base[places[each.name]], mine[places[each.name]], each) if each.name in places else each
        for each in theirs
    )


# -- closing ----------------------------------------------------------------------------------------------


def closed(motion: Motion, index: int = -1) -> Motion | None:
    """The motion made whole with as little as possible changed, and never the segment ``index`` where another will
    do: spans first, then a return. None where no such change makes it whole."""
    if not 0 <= index < len(motion.segments):
        index = max(range(len(motion.segments)), key=lambda i: abs(motion.segments[i].rise))
    for turn in _turns(motion, index):
        for found in _returns(turn, index):
            if not part_faults(found, "motion"):
                return found
    return None


def closed_design(design: Design, index: int = -1) -> Design | None:
    """``closed`` in a design: what is assumed of a segment goes where it goes."""
    before = require_motion(design)
    motion = closed(before, index)
    if motion is None:
        return None
    changed = with_motion(design, motion)
    if len(motion.segments) == len(before.segments):
        return changed
    numbers: list[int | None] = list(range(len(before.segments)))
    at = next((i for i, s in enumerate(before.segments) if s != motion.segments[i]), len(numbers) - 1)
    return with_marks_of(changed, [*numbers[: at + 1], None, *numbers[at + 1 :]])


def _after(motion: Motion, index: int) -> list[int]:
    """The other segments, in the order of the turn from the one behind ``index`` on."""
    count = len(motion.segments)
    return [(index + k) % count for k in range(1, count)]


def _turns(motion: Motion, index: int) -> Iterator[Motion]:
    """The motion with spans that make one turn: as it is; what is left of the turn added as a segment at its end, a
    return where one is missing; one segment shorter or longer; all but ``index`` in proportion; all in proportion."""
    gap = span_gap(motion)
    if gap == 0.0:
        yield motion
        return
    segments = list(motion.segments)
    if gap < 0.0:
        added = Segment(balance(0.0, (gap,)), balance(0.0, (rise_gap(motion),)), NamedCurve(RETURN_LAW))
        yield replace(motion, segments=(*segments, added if added.rise else replace(added, curve=NamedCurve("dwell"))))
    for other in _after(motion, index):
        span = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i != other))
        yield _with_cell(motion, other, "span_deg", span)
    for others in (sorted(_after(motion, index)), range(len(segments))):
        room = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i not in others))
        yield replace(motion, segments=tuple(with_total_span(segments, others, room) if others else segments))


def _returns(motion: Motion, index: int) -> Iterator[Motion]:
    """The motion with rises that come back: as it is; the next segment that moves takes the difference; a dwell behind
    ``index`` becomes the return, of several the one most like it in span, but not the first; the second half of the
    only one does; else the second half of ``index`` itself. A law that only returns gives way to one that does not,
    where nothing else helps."""
    gap = rise_gap(motion)
    if gap == 0.0:
        yield motion
    segments = list(motion.segments)
    for other in _after(motion, index):
        if not is_dwell(segments[other]):
            yield replace(motion, segments=back_at_start(segments, (other,), motion.gain))
    if gap != 0.0:
        back = balance(0.0, (gap,))
        dwells = [i for i in range(index + 1, len(segments)) if is_dwell(segments[i])]
        for law in (_law_back(segments[index]), RETURN_LAW):
            if len(dwells) > 1:
                at = min(reversed(dwells[1:]), key=lambda i: abs(segments[i].span_deg - segments[index].span_deg))
                made = replace(segments[at], rise=back, curve=NamedCurve(law))
                yield replace(motion, segments=(*segments[:at], made, *segments[at + 1 :]))
            for at in (dwells[-1] if dwells else index,):
                whole = segments[at].span_deg
                first = replace(segments[at], span_deg=whole / 2.0)
                second = Segment(whole - whole / 2.0, back, NamedCurve(law))
                yield replace(motion, segments=(*segments[:at], first, second, *segments[at + 1 :]))
    fitting = [_fitting(segment) for segment in segments]
    if fitting != segments:
        yield from _returns(replace(motion, segments=tuple(fitting)), index)


def _law_back(segment: Segment) -> str:
    """The law of a return that answers a segment: its mirror image, itself where its halves are alike."""
    law = find_law(segment.curve.law)
    if law is None or law.is_dwell or not (law.is_symmetric or law.slug in MIRRORS):
        return RETURN_LAW
    return MIRRORS.get(law.slug, law.slug)


def _fitting(segment: Segment) -> Segment:
    """The segment with a law that fits its rise."""
    law = find_law(segment.curve.law)
    if law is not None and law.is_dwell and segment.rise != 0.0:
        return replace(segment, curve=NamedCurve(RETURN_LAW))
    if law is not None and law.rises < 0 and segment.rise >= 0.0:
        return replace(segment, curve=NamedCurve(MIRRORS.get(law.slug, RETURN_LAW)))
    return segment


__all__ = [
    "RETURN_LAW", "closed", "closed_design", "lacks", "laid_out", "merged", "one_value_apart", "remove_laid_out", "rise_gap",
    "span_gap",
]  # fmt: skip
