"""Dimensions found rather than tried: the smallest, the largest or the best value of a field that keeps its limits."""

from core.find.limits import LIMITS, Reading
from core.find.offer import limits_without, offered, varied
from core.find.solution import Solution, find
from core.find.wanted import WANTED

__all__ = ["LIMITS", "WANTED", "Reading", "Solution", "find", "limits_without", "offered", "varied"]
