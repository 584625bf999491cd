"""Dimensions found rather than tried: the smallest, the largest or the best value of a field that keeps its limits."""

from core.find.limits import LIMITS, Reading
from core.find.offer import limits_without, offered, varied
from core.find.on_shaft import ON_SHAFT, offered_on_shaft
from core.find.searches import SEARCHES, find
from core.find.solution import Solution
from core.find.wanted import WANTED

__all__ = [
    "LIMITS", "ON_SHAFT", "SEARCHES", "WANTED", "Reading", "Solution", "find", "limits_without", "offered", "offered_on_shaft", "varied",
]  # fmt: skip
