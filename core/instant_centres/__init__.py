"""Instant centres of all bodies, from pairs, velocities and Kennedy's construction, and velocity ratios."""

from typing import TYPE_CHECKING

from core.instant_centres.centres import (
    CAM,
    CentreTable,
    Collinearity,
    all_centres,
    cam_centres,
    cam_follower_centre,
    collinearity,
    moving_collinearity,
    primary_pairs,
)
from core.instant_centres.construction import (
    Centres,
    Construction,
    KennedyStep,
    Triangle,
    construction,
    kennedy,
    triangle_line,
)
from core.process import lazy_attributes

if TYPE_CHECKING:
    from core.instant_centres.velocities import (
        ABSOLUTE,
        CHAINS,
        POLE,
        TURNING,
        Corner,
        PolygonSide,
        PolygonTriangle,
        RatioArms,
        VelocityPolygon,
        angular_ratio,
        mechanical_advantage,
        ratio_arms,
        velocity_differences,
        velocity_polygon,
    )
else:
    __getattr__ = lazy_attributes(__name__, "velocities")

__all__ = [
    "ABSOLUTE", "CAM", "CHAINS", "POLE", "TURNING", "CentreTable", "Centres", "Collinearity", "Construction", "Corner",
    "KennedyStep", "PolygonSide", "PolygonTriangle", "RatioArms", "Triangle", "VelocityPolygon", "all_centres",
    "angular_ratio", "cam_centres", "cam_follower_centre", "collinearity", "construction", "kennedy", "mechanical_advantage",
    "moving_collinearity", "primary_pairs", "ratio_arms", "triangle_line", "velocity_differences", "velocity_polygon",
]  # fmt: skip
