"""New designs with a cam in space: a slide, an arm or an indexing turret on a barrel cam or a globoidal cam."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from core.design import Design, Motion, NamedCurve, Segment, edited, with_drive
from core.design.spatial import SPATIAL_CAMS, BarrelCam, GloboidalCam, Rib, SpatialGroove
from kindyna_gui.files.beginnings import beginning, new_motion

SWING, STOPS = 30.0, 10  # swing of an arm [deg], stops of a barrel's indexer
ARM, TURRET_ARM, TURRET_ROLLER, TURRET_INNER = 80.0, 80.0, 12.0, 80.0  # [mm]
BLANK_OVER_ROLLER = 12.0  # radius of a barrel's blank beyond the inner ends of its rollers [mm]


class SpaceBeginning(NamedTuple):
    """A new design with a cam in space: its name in the group of its kind, and the function that makes it."""

    name: str
    design: Callable[[], Design]
    indexes: bool = False


def slide_in_groove() -> Design:
    """Return a barrel cam with a groove for the roller of a slide."""
    return beginning(BarrelCam.kind)


def slide_on_rib() -> Design:
    """Return a barrel cam with a rib between two rollers of a slide."""
    return edited(slide_in_groove(), "cam.form", Rib.form)


def arm_on_barrel() -> Design:
    """Return a barrel cam with a groove for the roller of an arm."""
    cam = replace(slide_in_groove().drive.cam, arm_mm=ARM)
    return with_drive(arm_on_globoid(), cam=cam)


def turret_on_barrel() -> Design:
    """Return a barrel cam with a rib that indexes a turret."""
    design, pitch = turret_on_globoid(), 360.0 / STOPS
    cam = replace(
        slide_in_groove().drive.cam, form=Rib(), arm_mm=TURRET_ARM, rollers=STOPS, roller_radius_mm=TURRET_ROLLER, length_mm=100.0,
        roller_inner_mm=TURRET_INNER, outer_radius_mm=TURRET_INNER + BLANK_OVER_ROLLER,
    )  # fmt: skip
    motion = design.drive.motion
    assert motion is not None
    dwell, index = motion.segments
    motion = replace(motion, start=0.5 * pitch, advance=pitch, segments=(dwell, replace(index, rise=pitch)))
    return with_drive(design, cam=cam, motion=motion)


def turret_on_globoid() -> Design:
    """Return a globoidal cam that indexes a turret by six stops."""
    return beginning(GloboidalCam.kind)


def arm_on_globoid() -> Design:
    """Return a globoidal cam with a groove for the roller of an arm."""
    design = turret_on_globoid()
    motion = design.drive.motion
    assert motion is not None
    swing = Motion(start=0.0, unit="deg", segments=(Segment(360.0, SWING, NamedCurve("dwell")),))
    swing = replace(new_motion(swing), start=-0.5 * SWING)
    cam = replace(design.drive.cam, form=SpatialGroove(), rollers=1)
    return with_drive(design, cam=cam, motion=swing)


SPACE_BEGINNINGS: Mapping[str, tuple[SpaceBeginning, ...]] = MappingProxyType(
    {
        SPATIAL_CAMS[BarrelCam.kind].label: (
            SpaceBeginning("Slide in a groove", slide_in_groove),
            SpaceBeginning("Slide on a rib", slide_on_rib),
            SpaceBeginning("Arm in a groove", arm_on_barrel),
            SpaceBeginning("Indexing turret", turret_on_barrel, indexes=True),
        ),
        SPATIAL_CAMS[GloboidalCam.kind].label: (
            SpaceBeginning("Indexing turret", turret_on_globoid, indexes=True),
            SpaceBeginning("Arm in a groove", arm_on_globoid),
        ),
    }
)
"""Label of a kind of cam in space -> its new designs."""
