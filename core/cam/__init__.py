"""Cam shape from the follower's motion, its limits and its proof."""

from core.cam.limits import PRESSURE_LIMITS, findings, require_hold, undercut
from core.cam.proof import centre_residual, tangency, tangency_residual
from core.cam.shape import ENVELOPES, CamShape, Flank, envelope, relative_motion

__all__ = [
    "ENVELOPES", "PRESSURE_LIMITS", "CamShape", "Flank", "centre_residual", "envelope", "findings", "relative_motion",
    "require_hold", "tangency", "tangency_residual", "undercut",
]  # fmt: skip
