"""Instant velocity centres: of all links, by the pairs, by velocities and by Kennedy's construction; velocity ratios by them."""

from typing import TYPE_CHECKING

from core.instant_centres.cam import CAM, cam_centres, cam_follower_centre
from core.instant_centres.centre import Centres
from core.instant_centres.collinearity import Collinearity, collinearity, moving_collinearity
from core.instant_centres.construction import Construction, KennedyStep, Triangle, construction, kennedy, line_of
from core.instant_centres.linkage import CentreTable, all_centres, primary_pairs
from core.late import late

if TYPE_CHECKING:
    from core.instant_centres.differences import (
        ABSOLUTE,
        POLE,
        TURNING,
        Corner,
        PolygonSide,
        PolygonTriangle,
        VelocityPolygon,
        velocity_differences,
        velocity_polygon,
    )
    from core.instant_centres.velocities import CHAINS, RatioArms, angular_ratio, mechanical_advantage, ratio_arms
else:
    __getattr__ = late(__name__, "velocities", "differences")

__all__ = [
    "ABSOLUTE", "CAM", "CHAINS", "POLE", "TURNING", "CentreTable", "Centres", "Collinearity", "Construction", "Corner",
    "KennedyStep", "PolygonSide", "PolygonTriangle", "RatioArms", "Triangle", "VelocityPolygon", "all_centres",
    "angular_ratio", "cam_centres", "cam_follower_centre", "collinearity", "construction", "kennedy", "line_of",
    "mechanical_advantage", "moving_collinearity", "primary_pairs", "ratio_arms", "velocity_differences",
    "velocity_polygon",
]  # fmt: skip
