"""Inputs: what the user typed, its units, ranges and rules."""

from core.design.edits import (
    edited,
    stretched,
    stroke,
    with_elastic,
    with_law,
    with_layout,
    with_rise,
    with_segment_inserted,
    with_shaft,
    with_span,
    with_stroke,
    without_segment,
)
from core.design.fields import Info, info_of, unit_of
from core.design.joins import (
    LEAST_SPAN,
    join_angles,
    join_levels,
    join_range,
    joins_of_level,
    with_join_moved,
)
from core.design.linkage import (
    CRANK,
    DRIVERS,
    FRAME_LINK,
    MOTION,
    Driver,
    Link,
    Linkage,
    LinkageCam,
    LinkageLoads,
    LinkForce,
    LinkMass,
    Place,
    Side,
    Slider,
)
from core.design.mirror import has_image, mirrored, stroke_mirrored
from core.design.motions import (
    insert_segment,
    mirror_stroke,
    motion_of,
    move_join,
    remove_segment,
    require_motion,
    with_motion,
)
from core.design.parts import (
    CURVES,
    FACES,
    FOLLOWER_KINDS,
    FORMS,
    LAYOUTS,
    SENSES,
    SPRINGS,
    Cam,
    CamSlider,
    CamSliderLoads,
    Curve,
    Elastic,
    End,
    Follower,
    FollowerKind,
    Loads,
    Motion,
    Named,
    Oscillating,
    OscillatingLoads,
    Point,
    Polynomial,
    RollerCam,
    Scca,
    Segment,
    Shaft,
    Spline,
    Translating,
    TranslatingLoads,
    curve_of,
    kind_of,
)
from core.design.paths import Entry, all_paths, entries, get, is_assumed, put, with_assumed
from core.design.rules import faults, part_faults, whole_faults
from core.design.unfinished import (
    blunders,
    closed,
    closed_design,
    lacks,
    laid_out,
    one_value_apart,
    remove_laid_out,
    rise_gap,
    span_gap,
)
from core.design.units import NO_UNIT, SI, UNITS, Unit, si, split_unit
from core.design.whole import SECTIONS, Design, Drive, require_follower, require_linkage, with_drive, with_table

__all__ = [
    "CRANK", "CURVES", "DRIVERS", "FACES", "FOLLOWER_KINDS", "FORMS", "FRAME_LINK", "LAYOUTS", "LEAST_SPAN", "MOTION",
    "NO_UNIT", "SECTIONS", "SENSES", "SI", "SPRINGS", "UNITS", "Cam", "CamSlider", "CamSliderLoads", "Curve", "Design",
    "Drive", "Driver", "Elastic", "End", "Entry", "Follower", "FollowerKind", "Info", "Link", "LinkForce", "LinkMass",
    "Linkage", "LinkageCam", "LinkageLoads", "Loads", "Motion", "Named", "Oscillating", "OscillatingLoads", "Place",
    "Point", "Polynomial", "RollerCam", "Scca", "Segment", "Shaft", "Side", "Slider", "Spline", "Translating",
    "TranslatingLoads", "Unit", "all_paths", "blunders", "closed", "closed_design", "curve_of", "edited", "entries",
    "faults", "get", "has_image", "info_of", "insert_segment", "is_assumed", "join_angles", "join_levels", "join_range",
    "joins_of_level", "kind_of", "lacks", "laid_out", "mirror_stroke", "mirrored", "motion_of", "move_join",
    "one_value_apart", "part_faults", "put", "remove_laid_out", "remove_segment", "require_follower", "require_linkage",
    "require_motion", "rise_gap", "si", "span_gap", "split_unit", "stretched", "stroke", "stroke_mirrored", "unit_of", "whole_faults",
    "with_assumed", "with_drive", "with_elastic", "with_join_moved", "with_law", "with_layout", "with_motion", "with_rise",
    "with_segment_inserted", "with_shaft", "with_span", "with_stroke", "with_table",
    "without_segment",
]  # fmt: skip
