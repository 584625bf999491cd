"""Dimensions found rather than tried: the smallest, the largest or the best value of a field that keeps its limits."""

from core.find.limits import LIMITS, Reading
from core.find.offer import limits_without, offered, varied
from core.find.on_shaft import EXTRA, ON_SHAFT, offered_on_shaft
from core.find.ranking import (
    FIGURES,
    Figure,
    Ranked,
    blend_candidates,
    figures_of,
    in_order,
    law_candidates,
    moving_segments,
    ranked,
    ranking,
)
from core.find.remedies import remedy_of
from core.find.searches import SEARCHES, find
from core.find.solution import Solution
from core.find.wanted import WANTED

__all__ = [
    "EXTRA",
    "FIGURES", "LIMITS", "ON_SHAFT", "SEARCHES", "WANTED", "Figure", "Ranked", "Reading", "Solution", "blend_candidates", "figures_of",
    "find", "in_order", "law_candidates", "limits_without", "moving_segments", "offered", "offered_on_shaft", "ranked", "ranking",
    "remedy_of", "varied",
]  # fmt: skip
