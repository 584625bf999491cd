"""Curve blending after Yang and Shon: the sequence follows from the tables, spans and heights from closed forms."""

from core.blend.any_sequence import best_of_sequence, blend_sequence, sequence_ranges
from core.blend.best import GOALS, best, blend
from core.blend.family import peak_of
from core.blend.feasible import OpenSettings, feasible_ranges, openings
from core.blend.request import (
    FLATS,
    LEAST_SPAN,
    LENGTHS,
    MAY_VANISH,
    SETTINGS,
    SIZES,
    Blended,
    BlendError,
    Request,
    SequenceRequest,
    SettingRange,
    has_room,
)
from core.blend.sequences import (
    CONSTANT_VELOCITY,
    ELEMENTS,
    MOTION_TYPES,
    CurveSequence,
    sequences,
)
from core.blend.solver import BlendCandidate, candidates, flat_heights
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
    "FLATS",
    "GOALS",
    "LEAST_SPAN",
    "LENGTHS",
    "MAY_VANISH",
    "MOTION_TYPES",
    "SETTINGS",
    "SIGNS",
    "SIZES",
    "TABLE",
    "BlendCandidate",
    "BlendError",
    "Blended",
    "CurveEnds",
    "CurveSequence",
    "OpenSettings",
    "Request",
    "SequenceRequest",
    "SettingRange",
    "all_sequences",
    "best",
    "best_of_sequence",
    "blend",
    "blend_sequence",
    "candidates",
    "feasible_ranges",
    "flat_heights",
    "has_room",
    "next_in",
    "openings",
    "peak_of",
    "sequence_ranges",
    "sequences",
    "state_text",
    "state_words",
    "states",
    "why_not",
]
