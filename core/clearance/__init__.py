"""Distance of moving bodies with outlines, exact at every angle and proven over the turn."""

from core.clearance.bound import (
    BodyMotion,
    Encounter,
    Intervals,
    LeastDistance,
    body_motion,
    intervals_of,
    least_distance,
    meetings,
)
from core.clearance.distance import Placement, ShapePair, distances, nearest_points
from core.clearance.shapes import Shape, joined

__all__ = [
    "BodyMotion", "Encounter", "Intervals", "LeastDistance", "Placement", "Shape", "ShapePair", "body_motion", "distances",
    "intervals_of", "joined", "least_distance", "meetings", "nearest_points",
]  # fmt: skip
