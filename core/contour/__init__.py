"""Curves of lines and arcs from drawings, and the motion of a follower that rolls on them."""

from core.contour.drawing import (
    GAP_MM,
    MOST_GAP_MM,
    UNITS,
    Contour,
    DrawingError,
    read_contour,
    read_curve,
    read_outline,
)
from core.contour.elements import ContourElement, sampled
from core.contour.motion import TOLERANCE_MM, Jump, TracedMotion, trace

__all__ = [
    "GAP_MM", "MOST_GAP_MM", "TOLERANCE_MM", "UNITS", "Contour", "ContourElement", "DrawingError", "Jump",
    "TracedMotion", "read_contour", "read_curve", "read_outline", "sampled", "trace",
]  # fmt: skip
