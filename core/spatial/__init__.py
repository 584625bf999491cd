"""Cams in space, barrel and globoidal: flanks under cylindrical and conical rollers, and the figures by which they are judged."""

from core.spatial.contact import (
    AHEAD,
    BEHIND,
    SIDES,
    MotionRows,
    SpatialFlank,
    dots,
    flank,
    intrusion,
    meshing,
    sliding,
    sliding_parts,
    turned,
)
from core.spatial.kinds import KINDS, Machine, RollerAxis, machine_of, roller_axis
from core.spatial.picture import FlankPatch, RollerTrack, flank_patches, roller_tracks
from core.spatial.rib import rib_thickness
from core.spatial.shape import RollerAt, SpatialShape, handover_angles, rollers_at, spatial_shape, turret_limit

__all__ = [
    "AHEAD",
    "BEHIND",
    "KINDS",
    "SIDES",
    "FlankPatch",
    "Machine",
    "MotionRows",
    "RollerAt",
    "RollerAxis",
    "RollerTrack",
    "SpatialFlank",
    "SpatialShape",
    "dots",
    "flank",
    "flank_patches",
    "handover_angles",
    "intrusion",
    "machine_of",
    "meshing",
    "rib_thickness",
    "roller_axis",
    "roller_tracks",
    "rollers_at",
    "sliding",
    "sliding_parts",
    "spatial_shape",
    "turned",
    "turret_limit",
]
