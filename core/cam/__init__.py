"""Cam shape from the follower's motion, its limits and its proof."""

from core.cam.faces import FACES, FaceRow, envelope, row_of
from core.cam.limits import PRESSURE_LIMITS, findings, require_hold, undercut
from core.cam.proof import centre_residual, gaps, tangency, tangency_residual
from core.cam.shape import CamShape, Flank, FlatFlank, RoundFlank, flat_flank, relative_motion, round_flank

__all__ = [
    "FACES",
    "PRESSURE_LIMITS",
    "CamShape",
    "FaceRow",
    "Flank",
    "FlatFlank",
    "RoundFlank",
    "centre_residual",
    "envelope",
    "findings",
    "flat_flank",
    "gaps",
    "relative_motion",
    "require_hold",
    "round_flank",
    "row_of",
    "tangency",
    "tangency_residual",
    "undercut",
]  # fmt: skip
