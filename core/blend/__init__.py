"""Curve blending after Yang and Son: the sequence follows from the tables, spans and heights from closed forms."""

from core.blend.best import GOALS, best
from core.blend.choose import blend
from core.blend.curves import (
    CONSTANT_VELOCITY,
    ELEMENTS,
    MOTION_TYPES,
    Element,
    MotionType,
    Sequence,
    admissible,
    sequences,
)
from core.blend.family import Family, Solution, Task
from core.blend.openings import Opening, freedoms, missing_settings, open_settings, openings
from core.blend.range import Range
from core.blend.ranges import feasible_range, feasible_ranges
from core.blend.request import Blended, BlendError, Request, candidates
from core.blend.solver import Problem
from core.blend.wishes import MAY_VANISH, SETTINGS, Wish

__all__ = [
    "CONSTANT_VELOCITY",
    "ELEMENTS",
    "GOALS",
    "MAY_VANISH",
    "MOTION_TYPES",
    "SETTINGS",
    "BlendError",
    "Blended",
    "Element",
    "Family",
    "MotionType",
    "Opening",
    "Problem",
    "Range",
    "Request",
    "Sequence",
    "Solution",
    "Task",
    "Wish",
    "admissible",
    "best",
    "blend",
    "candidates",
    "feasible_range",
    "feasible_ranges",
    "freedoms",
    "missing_settings",
    "open_settings",
    "openings",
    "sequences",
]  # fmt: skip
