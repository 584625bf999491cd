"""Curve blending after Yang and Son: the sequence follows from the tables, spans and heights from closed forms."""

from core.blend.best import GOALS, best, blend
from core.blend.feasible import Opening, feasible_ranges, openings
from core.blend.request import MAY_VANISH, SETTINGS, Blended, BlendError, Range, Request
from core.blend.sequences import (
    CONSTANT_VELOCITY,
    ELEMENTS,
    MOTION_TYPES,
    CurveSequence,
    sequences,
)
from core.blend.solver import Candidate, candidates

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
    "CurveSequence",
    "Opening",
    "Range",
    "Request",
    "best",
    "blend",
    "candidates",
    "feasible_ranges",
    "openings",
    "sequences",
]
