"""Curve blending after Yang and Son: the sequence follows from the tables, spans and heights from closed forms."""

from core.blend.choose import GOALS, best, blend
from core.blend.curves import (
    CONSTANT_VELOCITY,
    ELEMENTS,
    MOTION_TYPES,
    Sequence,
    sequences,
)
from core.blend.feasible import Opening, feasible_ranges, openings
from core.blend.request import Blended, BlendError, Candidate, Request, candidates
from core.blend.settings import MAY_VANISH, SETTINGS, Range

__all__ = [
    "CONSTANT_VELOCITY",
    "ELEMENTS",
    "GOALS",
    "MAY_VANISH",
    "MOTION_TYPES",
    "SETTINGS",
    "BlendError",
    "Blended",
    "Candidate",
    "Opening",
    "Range",
    "Request",
    "Sequence",
    "best",
    "blend",
    "candidates",
    "feasible_ranges",
    "openings",
    "sequences",
]
