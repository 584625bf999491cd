"""Incomplete designs: gaps of a motion, edits of single values, merging of edits, and closing of a motion.

A motion is complete where its spans make one turn, its rises add up to its advance, and its laws fit their rises.
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
from core.design.motions import Motion, NamedCurve, Segment
from core.design.paths import all_paths
from core.design.rules import CLOSING, faults, incomplete_faults, part_faults, total_of
from core.errors import Fault
from core.laws import find_law

RETURN_LAW = "modified-sine"
"""Default law of a return."""

_CELL = re.compile(r"motion\.segments\[(\d+)\]\.(span_deg|rise|law)(?:_mm|_deg)?")


def span_gap(motion: Motion) -> float:
    """Excess of the spans over one turn [deg]; 0 within the tolerance."""
    return _gap(total_of(s.span_deg for s in motion.segments) - 360.0)


def rise_gap(motion: Motion) -> float:
    """Excess of the rises over the advance [mm or deg]; 0 within the tolerance."""
    return _gap(total_of(s.rise for s in motion.segments) - motion.gain)


def _gap(number: float) -> float:
    return 0.0 if abs(number) <= CLOSING else balance(number, ())


def missing_of_motion(design: Design) -> list[Fault]:
    """Faults of incomplete motions in a design; other faults are not listed."""
    if design.listed:
        singles = ((i, missing_of_motion(only(design, i))) for i in range(len(design.drives)))
        return [replace(fault, path=path_of(i, fault.path)) for i, faults_i in singles for fault in faults_i]
    motion = motion_of(design)
    return [] if motion is None else incomplete_faults(motion, "motion")


def with_value(design: Design, path: str, value: object, typed: Collection[str] = ()) -> Design:
    """Design with a value of its motion changed; the motion may be incomplete before and after.

    A balanced motion stays balanced by another segment (``edited``), by a typed one only where no other can. Where that is
    not possible, or the motion was not balanced, only the one value changes.
    """
    if design.listed and (found := drive_at(path)) is not None:
        index, rest = found
        return with_only(design, index, with_value(only(design, index), rest, value))
    cell = _CELL.fullmatch(path)
    if cell is None:
        return edited(design, path, value)
    kind, gap = ("span_deg", span_gap) if cell[2] == "span_deg" else ("rise", rise_gap)  # a dwell has no rise
    motion = require_motion(design)
    changed = _with_cell(motion, int(cell[1]), cell[2], value)
    if cell[2] == "law" and _keeps_return(motion, changed, int(cell[1])):
        missing = -rise_gap(changed)
        return with_motion(
            design,
            changed if is_dwell(changed.segments[int(cell[1])]) else _with_cell(changed, int(cell[1]), "rise", missing),
        )
    if gap(motion) == 0.0 != gap(changed):
        cells = [match for before in typed if (match := _CELL.fullmatch(before)) is not None]
        balanced = edited(design, path, value, {int(match[1]) for match in cells if match[2] == kind})
        if len(faults(balanced)) <= len(faults(design)):
            return balanced
    return with_motion(design, changed)


def _keeps_return(before: Motion, after: Motion, index: int) -> bool:
    """Whether a rise has become a dwell while one other segment moves, whose rise is then retained; or the reverse."""
    moving = [s for i, s in enumerate(after.segments) if i != index and not is_dwell(s)]
    current, previous = after.segments[index], before.segments[index]
    if is_dwell(current):
        return not before.gain and previous.rise != 0.0 and len(moving) == 1 and rise_gap(before) == 0.0
    return is_dwell(previous) and len(moving) == 1 and rise_gap(before) != 0.0


def differs_in_one_value(design: Design, changed: Design, path: str) -> bool:
    """Whether the motions of two designs differ only in the span, rise or law at a path."""
    cell, a, b = _CELL.fullmatch(path), motion_of(design), motion_of(changed)
    if cell is None or a is None or b is None or len(a.segments) != len(b.segments):
        return False
    index = int(cell[1])
    without: dict[str, Any] = {{"law": "curve"}.get(cell[2], cell[2]): None}
    first, second = (replace(m.segments[index], **without) for m in (a, b))
    restored = replace(b, segments=(*b.segments[:index], a.segments[index], *b.segments[index + 1 :]))
    return first == second and a == restored


def _with_cell(motion: Motion, index: int, key: str, value: Any) -> Motion:
    """Motion with one value of a segment changed; a new dwell has no rise."""
    segment = motion.segments[index]
    if key == "law":
        changed = with_law(replace(motion, segments=(segment,)), 0, str(value)).segments[0]
    else:
        changed = replace(segment, **{key: value})
    return replace(motion, segments=(*motion.segments[:index], changed, *motion.segments[index + 1 :]))


def remove_from_incomplete(design: Design, index: int) -> Design:
    """Design without a segment of its motion; an incomplete motion stays so."""
    return remove_segment(design, index, balanced=not missing_of_motion(design))


# -- merging of edits --------------------------------------------------------------------------------------


def merged(base: Design, mine: Design, theirs: Design) -> Design:
    """``mine`` with all changes that ``theirs`` made to ``base``; where both changed a value, theirs is taken.

    The drives are those of ``theirs``. A motion counts as one value, since its spans and rises depend on each other.
    """
    if mine is base:
        return theirs
    result: Design = _merged(base, mine, theirs)
    if result.listed:
        result = replace(result, drives=_merged_drives(base.drives, mine.drives, theirs.drives))
    new = ({*mine.assumed} | {*theirs.assumed}) - {*base.assumed}
    marks = ({*base.assumed} & {*mine.assumed} & {*theirs.assumed}) | (new and new & {*all_paths(result)})
    return replace(
        result, assumed=tuple(path for path in dict.fromkeys((*mine.assumed, *theirs.assumed)) if path in marks)
    )


def _merged(base: Any, mine: Any, theirs: Any) -> Any:
    if {type(part) for part in (base, mine, theirs)} == {Motion}:
        base, mine, theirs = base.typed, mine.typed, theirs.typed
    if mine == base:
        return theirs
    if theirs == base:
        return mine
    kinds = {type(part) for part in (base, mine, theirs)}
    if kinds == {tuple} and len(base) == len(mine) == len(theirs):
        return tuple(map(_merged, base, mine, theirs))
    if len(kinds) == 1 and is_dataclass(mine) and kinds != {Motion}:
        names = [part.name for part in fields(mine)]
        values = {name: _merged(*(getattr(part, name) for part in (base, mine, theirs))) for name in names}
        return replace(mine, **values)  # type: ignore[type-var]
    return theirs


def _merged_drives(base: tuple[Drive, ...], mine: tuple[Drive, ...], theirs: tuple[Drive, ...]) -> tuple[Drive, ...]:
    """Drives are matched by name; a new name in a list of equal length by its number."""
    numbers = {drive.name: i for i, drive in enumerate(base)}
    if len(theirs) == len(base):
        names = [drive.name for drive in theirs]
        numbers |= {name: i for i, name in enumerate(names) if name not in numbers and base[i].name not in names}
    return tuple(
        _merged(base[numbers[drive.name]], mine[numbers[drive.name]], drive) if drive.name in numbers else drive
        for drive in theirs
    )


# -- closing of a motion ----------------------------------------------------------------------------------


def closed(motion: Motion, index: int = -1) -> Motion | None:
    """Complete motion with the fewest changes, spans first, then a return; None where no such change completes it.

    The segment ``index`` changes only where no other can.
    """
    if not 0 <= index < len(motion.segments):
        index = max(range(len(motion.segments)), key=lambda i: abs(motion.segments[i].rise))
    for turn in _turns(motion, index):
        for candidate in _returns(turn, index):
            if not part_faults(candidate, "motion"):
                return candidate
    return None


def closed_design(design: Design, index: int = -1) -> Design | None:
    """Design with its motion completed, as by ``closed``, and the assumed paths of moved segments."""
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
    """Numbers of the other segments, in the order of the turn from the one after ``index`` on."""
    count = len(motion.segments)
    return [(index + k) % count for k in range(1, count)]


def _turns(motion: Motion, index: int) -> Iterator[Motion]:
    """Motions with spans that make one turn, in the order of preference.

    The motion itself; with the rest of the turn as a segment at its end, a return where one is missing; with one segment
    shorter or longer; with all but ``index`` in proportion; with all in proportion.
    """
    gap = span_gap(motion)
    if gap == 0.0:
        yield motion
        return
    segments = list(motion.segments)
    if gap < 0.0:
        added = Segment(balance(0.0, (gap,)), balance(0.0, (rise_gap(motion),)), NamedCurve(RETURN_LAW))
        yield replace(motion, segments=(*segments, added if added.rise else replace(added, curve=NamedCurve("dwell"))))
    for k in _after(motion, index):
        span = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i != k))
        yield _with_cell(motion, k, "span_deg", span)
    for which in (sorted(_after(motion, index)), range(len(segments))):
        room = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i not in which))
        yield replace(motion, segments=tuple(with_total_span(segments, which, room) if which else segments))


def _returns(motion: Motion, index: int) -> Iterator[Motion]:
    """Motions with rises that add up, in the order of preference.

    The motion itself; the next moving segment takes the difference; a dwell after ``index`` becomes the return, of several
    the one with the most similar span, but not the first; the second half of a single dwell does; else the second half of
    ``index`` itself. At last laws that do not fit their rises are replaced.
    """
    gap = rise_gap(motion)
    if gap == 0.0:
        yield motion
    segments = list(motion.segments)
    yield from (
        replace(motion, segments=back_at_start(segments, (k,), motion.gain))
        for k in _after(motion, index)
        if not is_dwell(segments[k])
    )
    if gap != 0.0:
        back = balance(0.0, (gap,))
        dwells = [i for i in range(index + 1, len(segments)) if is_dwell(segments[i])]
        for law in (_law_back(segments[index]), RETURN_LAW):
            if len(dwells) > 1:
                at = min(reversed(dwells[1:]), key=lambda i: abs(segments[i].span_deg - segments[index].span_deg))
                return_ = replace(segments[at], rise=back, curve=NamedCurve(law))
                yield replace(motion, segments=(*segments[:at], return_, *segments[at + 1 :]))
            for at in (dwells[-1] if dwells else index,):
                span = segments[at].span_deg
                first = replace(segments[at], span_deg=span / 2.0)
                second = Segment(span - span / 2.0, back, NamedCurve(law))
                yield replace(motion, segments=(*segments[:at], first, second, *segments[at + 1 :]))
    fitting = [_fitting(segment) for segment in segments]
    if fitting != segments:
        yield from _returns(replace(motion, segments=tuple(fitting)), index)


def _law_back(segment: Segment) -> str:
    """Law of the return of a segment: its mirror image, itself where it is symmetric."""
    law = find_law(segment.curve.law)
    if law is None or law.is_dwell or not (law.is_symmetric or law.slug in MIRRORS):
        return RETURN_LAW
    return MIRRORS.get(law.slug, law.slug)


def _fitting(segment: Segment) -> Segment:
    """Segment with a law that fits its rise."""
    law = find_law(segment.curve.law)
    if law is not None and law.is_dwell and segment.rise != 0.0:
        return replace(segment, curve=NamedCurve(RETURN_LAW))
    if law is not None and law.rises < 0 and segment.rise >= 0.0:
        return replace(segment, curve=NamedCurve(MIRRORS.get(law.slug, RETURN_LAW)))
    return segment
