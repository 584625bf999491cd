"""The motion of a design of any kind, and edits of its segments: what is assumed of a segment goes where it goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from core.design.edits import with_segment_inserted, without_segment
from core.design.joins import with_join_moved
from core.design.linkage import CRANK, MOTION
from core.design.mirror import stroke_mirrored
from core.design.parts import OUTPUT_LOADS, Motion, Output, Shaft
from core.design.paths import all_paths, followed
from core.design.rules import faults
from core.design.whole import Design, Drive, with_drive
from core.errors import DesignError, Fault


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


__all__ = [
    "alone", "files_of", "insert_segment", "mirror_stroke", "motion_of", "move_join", "of_motion", "remove_segment", "require_motion",
    "with_marks_of", "with_motion", "with_motion_of", "without_marks",
]  # fmt: skip
