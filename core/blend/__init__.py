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
from core.blend.succession import (
    SIGNS,
    TABLE,
    CurveEnds,
    all_sequences,
    next_in,
    state_text,
    state_words,
    states,
    why_not,
)

__all__ = [
    "CONSTANT_VELOCITY",
    "ELEMENTS",
    "GOALS",
    "MAY_VANISH",
    "MOTION_TYPES",
    "SETTINGS",
    "SIGNS",
    "TABLE",
    "BlendError",
    "Blended",
    "Candidate",
    "CurveEnds",
    "CurveSequence",
    "Opening",
    "Range",
    "Request",
    "all_sequences",
    "best",
    "blend",
    "candidates",
    "feasible_ranges",
    "next_in",
    "openings",
    "sequences",
    "state_text",
    "state_words",
    "states",
    "why_not",
]
