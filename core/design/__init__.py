"""Inputs: what the user typed, its units, ranges and rules."""

from core.design.fields import Info, field_faults, info_of, unit_of
from core.design.parts import (
    FACES,
    FOLLOWER_KINDS,
    FORMS,
    LAYOUTS,
    SENSES,
    Cam,
    CamSlider,
    CamSliderLoads,
    Curve,
    Design,
    Drive,
    Follower,
    FollowerKind,
    Loads,
    Motion,
    Named,
    RollerCam,
    Segment,
    Shaft,
    SingleCam,
    Translating,
    TranslatingLoads,
    kind_of,
)
from core.design.paths import Entry, entries, get, put
from core.design.rules import faults, part_faults
from core.design.units import NO_UNIT, SI, UNITS, Unit, si, split_unit

__all__ = [
    "FACES", "FOLLOWER_KINDS", "FORMS", "LAYOUTS", "NO_UNIT", "SENSES", "SI", "UNITS", "Cam", "CamSlider", "CamSliderLoads",
    "Curve", "Design", "Drive", "Entry", "Follower", "FollowerKind", "Info", "Loads", "Motion", "Named", "RollerCam", "Segment",
    "Shaft", "SingleCam", "Translating", "TranslatingLoads", "Unit", "entries", "faults", "field_faults", "get", "info_of",
    "kind_of", "part_faults", "put", "si", "split_unit", "unit_of",
]  # fmt: skip
