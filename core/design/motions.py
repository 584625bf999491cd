"""The motion of a design of any kind, and edits of its segments: what is assumed of a segment goes where it goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from core.design.edits import with_segment_inserted, without_segment
from core.design.joins import with_join_moved
from core.design.linkage import CRANK, MOTION
from core.design.mirror import stroke_mirrored
from core.design.parts import Motion
from core.design.paths import all_paths, followed
from core.design.whole import Design, with_drive
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


def insert_segment(design: Design, index: int) -> Design:
    """``with_segment_inserted`` in a design."""
    motion = require_motion(design)
    old = range(len(motion.segments))
    changed = with_motion(design, with_segment_inserted(motion, index))
    return with_marks_of(changed, [*old[: index + 1], None, *old[index + 1 :]])


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
    "insert_segment", "mirror_stroke", "motion_of", "move_join", "remove_segment", "require_motion", "with_marks_of",
    "with_motion", "without_marks",
]  # fmt: skip
