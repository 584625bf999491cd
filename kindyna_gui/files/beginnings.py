"""Designs to begin with: every follower with every face and form, and a motion of 120° up, 60° above, 120° back, 60° below."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from core.design import (
    FOLLOWER_KINDS,
    Design,
    Drive,
    LinkageLoads,
    Motion,
    NamedCurve,
    Segment,
    all_paths,
    edited,
    faults,
    stroke,
    with_assumed,
    with_drive,
    with_stroke,
)
from core.design.followers import Roller
from core.errors import KindynaError
from core.findings import ERROR
from core.mechanism.drawing_edits import empty_linkage
from core.project import load
from core.stress import is_line_contact
from core.study import Study, findings_of
from kindyna_gui.places import example

NEW_LAW = "modified-sine"
"""Of the rise and the return that a new design begins with."""

FIRST_OF_KIND: Mapping[str, str] = MappingProxyType(
    {"cam-slider": "transfer_lift", "translating": "card_picker", "oscillating": "rocker_cam"}
)
"""Kind of follower -> the example whose lengths, stroke and loads a new design of the kind begins with."""

DISTANCE = "follower.second.distance_mm"
OWN_LENGTHS: Mapping[str, float] = MappingProxyType({DISTANCE: 150.0})
"""Path -> value [mm] in new designs that have it: another one than an edit begins with, which would make both cams of a symmetric
motion one."""

SAMPLES = 180  # of a turn, to see whether a motion suits a mechanism


def beginning(kind: str, changes: Mapping[str, str] = MappingProxyType({}), name: str = "") -> Design:
    """A design of this kind of follower with a whole motion; changes: of face and form, path -> word."""
    label = FOLLOWER_KINDS[kind].label
    design: Design = load(example(FIRST_OF_KIND[kind]))
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    design = replace(design, name=name or f"New {label[:1].lower()}{label[1:]}", assumed=assumed)
    assert design.drive.motion is not None
    design = with_drive(design, motion=new_motion(design.drive.motion))
    for path, word in changes.items():
        design = edited(design, path, word)
    for path, length in OWN_LENGTHS.items():
        design = edited(design, path, length) if path in all_paths(design) else design
    return _with_surfaces(design)


def _with_surfaces(design: Design) -> Design:
    """Width and materials that are usual, all assumed, so that the pressure of the contact can be read; of an edge there is none."""
    drive = design.drive
    if not is_line_contact(drive.face):
        return design
    rolls = isinstance(drive.face, Roller)
    width = drive.face.radius_mm if rolls else drive.cam.base_radius_mm / 4.0
    offered = {
        "cam.thickness_mm": float(round(width)),
        "cam.material": "16mncr5",
        "cam.roller_material": "100cr6" if rolls else "16mncr5",
    }
    for path, value in offered.items():
        design = with_assumed(edited(design, path, value), path, True)
    return design


def empty_sheet() -> Design:
    """A linkage of which nothing is drawn yet."""
    return Design("New linkage", None, (Drive(None, empty_linkage(), None, LinkageLoads()),))


def new_motion(motion: Motion) -> Motion:
    """Rise, dwell, return and dwell from the base position over 120, 60, 120 and 60 degrees, with the stroke of a motion."""
    height = stroke(motion)
    segments = tuple(
        Segment(span, rise, NamedCurve(law))
        for span, rise, law in (
            (120.0, height, NEW_LAW),
            (60.0, 0.0, "dwell"),
            (120.0, -height, NEW_LAW),
            (60.0, 0.0, "dwell"),
        )
    )
    return replace(motion, start=0.0, segments=segments)


def dwell_first(design: Design) -> Design:
    """A design to begin with whose motion begins with its dwell at the base position, instead of with the rise."""
    motion = design.drive.motion
    assert motion is not None
    *others, last = motion.segments
    return with_drive(design, motion=replace(motion, segments=(last, *others)))


def with_motion_kept(design: Design, motion: Motion | None) -> Design:
    """The design with the motion that was there before: as it is where it suits, else its levels scaled to the design's own
    stroke, where that suits; where there was none, or neither suits, the design as it is."""
    own = design.drive.motion
    if motion is None or own is None:
        return design
    wanted = [motion] if motion.unit == own.unit else []
    if stroke(motion):
        wanted.append(with_stroke(replace(motion, unit=own.unit), stroke(own)))
    assumed = tuple(path for path in design.assumed if not path.startswith("motion."))
    made = (with_drive(replace(design, assumed=assumed), motion=each) for each in wanted)
    return next((each for each in made if _sound(each)), design)


def _sound(design: Design) -> bool:
    """Whether the follower can go so, on a cam without faults."""
    if faults(design):
        return False
    try:
        return not any(finding.severity == ERROR for finding in findings_of(Study(design, SAMPLES), ("linkage", "cam")))
    except KindynaError:
        return False
