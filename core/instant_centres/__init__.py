"""Instant velocity centres: of all links, by the pairs, by velocities and by Kennedy's construction; what they tell."""

from core.instant_centres.cam import CAM_CENTRES, cam_follower_centre
from core.instant_centres.centre import Centres
from core.instant_centres.construction import Construction, Triangle, Wanted, construction, kennedy, line_of
from core.instant_centres.linkage import CentreTable, all_centres, collinearity, primary_pairs
from core.instant_centres.velocities import Difference, angular_ratio, mechanical_advantage, velocity_differences

__all__ = [
    "CAM_CENTRES", "CentreTable", "Centres", "Construction", "Difference", "Triangle", "Wanted", "all_centres",
    "angular_ratio", "cam_follower_centre", "collinearity", "construction", "kennedy", "line_of", "mechanical_advantage",
    "primary_pairs", "velocity_differences",
]  # fmt: skip
