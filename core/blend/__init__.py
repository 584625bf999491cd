"""Curve blending after Yang and Son: the sequence follows from the tables, spans and heights from closed forms."""

from core.blend.best import GOALS, best
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
from core.blend.request import Blended, BlendError, Request, blend, candidates, feasible_range
from core.blend.solver import SETTINGS, Infeasible, Problem

__all__ = [
    "CONSTANT_VELOCITY",
    "ELEMENTS",
    "GOALS",
    "MOTION_TYPES",
    "SETTINGS",
    "BlendError",
    "Blended",
    "Element",
    "Family",
    "Infeasible",
    "MotionType",
    "Problem",
    "Request",
    "Sequence",
    "Solution",
    "Task",
    "admissible",
    "best",
    "blend",
    "candidates",
    "feasible_range",
    "sequences",
]  # fmt: skip
