"""Edits that keep a design whole: what one change asks of its neighbours is done in the same step.

Spans must make a turn and rises must come back to the start, so no single one of them can change alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import fsum
from types import MappingProxyType
from typing import Any

from core.design.parts import CamSlider, Motion, Named, Segment, SingleCam
from core.design.paths import put, with_section
from core.laws import find_law


def with_span(motion: Motion, index: int, span_deg: float) -> Motion:
    """One segment's span [deg] changed; the next segment (cyclic) gives or takes the difference."""
    segments = list(motion.segments)
    other = (index + 1) % len(segments)
    if other == index:
        return replace(motion, segments=(replace(segments[index], span_deg=span_deg),))
    rest = fsum([360.0, -span_deg, *(-s.span_deg for i, s in enumerate(segments) if i not in (index, other))])
    segments[index] = replace(segments[index], span_deg=span_deg)
    segments[other] = replace(segments[other], span_deg=rest)
    return replace(motion, segments=tuple(segments))


def with_rise(motion: Motion, index: int, rise: float) -> Motion:
    """One segment's rise changed; the next segment that moves (cyclic) brings the follower back."""
    segments = list(motion.segments)
    segments[index] = replace(segments[index], rise=rise)
    others = [(index + k) % len(segments) for k in range(1, len(segments))]
    for other in others:
        if not _still(segments[other]):
            rest = -fsum(s.rise for i, s in enumerate(segments) if i != other)
            segments[other] = replace(segments[other], rise=rest + 0.0)
            break
    return replace(motion, segments=tuple(segments))


def stroke(motion: Motion) -> float:
    """Highest minus lowest level at the ends of segments, in the motion's unit."""
    levels = [fsum([motion.start, *(s.rise for s in motion.segments[:i])]) for i in range(len(motion.segments) + 1)]
    return max(levels) - min(levels)


def with_stroke(motion: Motion, wanted: float) -> Motion:
    """All rises and the start scaled so that the stroke becomes ``wanted``; the level 0 stays where it is."""
    now = stroke(motion)
    if now == 0.0:
        return motion
    by = wanted / now
    segments = tuple(replace(s, rise=s.rise * by) for s in motion.segments)
    return replace(motion, start=motion.start * by, segments=segments)


def with_law(motion: Motion, index: int, law: str) -> Motion:
    """One segment's law changed; what becomes a dwell loses its rise to the next segment that moves."""
    segments = list(motion.segments)
    segments[index] = replace(segments[index], curve=Named(law))
    changed = replace(motion, segments=tuple(segments))
    row = find_law(law)
    return with_rise(changed, index, 0.0) if row is not None and row.still else changed


def with_layout(follower: CamSlider, layout: str) -> CamSlider:
    """The layout changed; the pivot goes to the other side of the cam where the letter asks for it."""
    left = layout in "abef"
    side = abs(follower.pivot_x_mm) if left else -abs(follower.pivot_x_mm)
    return replace(follower, layout=layout, pivot_x_mm=side)


def _still(segment: Segment) -> bool:
    law = find_law(segment.curve.law)
    return law is not None and law.still


def _segment_edit(change: Callable[[Motion, int, Any], Motion]) -> Callable[[SingleCam, str, Any], SingleCam]:
    def edit(design: SingleCam, path: str, value: Any) -> SingleCam:
        index = int(re.findall(r"\[(\d+)\]", path)[0])
        return with_section(design, "motion", change(design.drive.motion, index, value))

    return edit


def _layout_edit(design: SingleCam, path: str, value: Any) -> SingleCam:
    follower = design.drive.follower
    assert isinstance(follower, CamSlider)
    return with_section(design, "follower", with_layout(follower, value))


def _stroke_edit(design: SingleCam, path: str, value: Any) -> SingleCam:
    return with_section(design, "motion", with_stroke(design.drive.motion, value))


EDITS: Mapping[str, Callable[[SingleCam, str, Any], SingleCam]] = MappingProxyType(
    {
        r"motion\.segments\[\d+\]\.span_deg": _segment_edit(with_span),
        r"motion\.segments\[\d+\]\.rise(_mm|_deg)?": _segment_edit(with_rise),
        r"motion\.segments\[\d+\]\.law": _segment_edit(with_law),
        r"motion\.stroke(_mm|_deg)?": _stroke_edit,
        r"follower\.layout": _layout_edit,
    }
)
"""Paths (as patterns) that ask something of their neighbours; every other path is simply put."""


def edited(design: SingleCam, path: str, value: Any) -> SingleCam:
    """The design with the value at a path changed and what goes with it. It may have faults: ask ``faults``."""
    for pattern, edit in EDITS.items():
        if re.fullmatch(pattern, path):
            return edit(design, path, value)
    return put(design, path, value)
