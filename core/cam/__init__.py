"""Cam shape from the follower's motion, its limits and its proof."""

from core.cam.checks import keyway_corners, keyway_unknown
from core.cam.crossings import Crossing, crossings
from core.cam.faces import FACES, FaceRow, row_of
from core.cam.forms import FORMS, FormRow, envelope, faces_of, form_row, forward_push
from core.cam.groove import Wall, thinnest_wall, wall_findings
from core.cam.limits import (
    PRESSURE_LIMITS,
    PRESSURE_SOURCE,
    findings,
    further_findings,
    limits_of,
    require_hold,
    undercut,
)
from core.cam.proof import centre_residual, gaps, tangency, tangency_residual
from core.cam.radii import Radius, smallest_radii
from core.cam.shape import (
    INNER,
    OUTER,
    SECOND,
    CamShape,
    FaceOutline,
    Flank,
    relative_motion,
)
from core.cam.sizes import second_entry

__all__ = [
    "FACES",
    "FORMS",
    "INNER",
    "OUTER",
    "PRESSURE_LIMITS",
    "PRESSURE_SOURCE",
    "SECOND",
    "CamShape",
    "Crossing",
    "FaceOutline",
    "FaceRow",
    "Flank",
    "FormRow",
    "Radius",
    "Wall",
    "centre_residual",
    "crossings",
    "envelope",
    "faces_of",
    "findings",
    "form_row",
    "forward_push",
    "further_findings",
    "gaps",
    "keyway_corners",
    "keyway_unknown",
    "limits_of",
    "relative_motion",
    "require_hold",
    "row_of",
    "second_entry",
    "smallest_radii",
    "tangency",
    "tangency_residual",
    "thinnest_wall",
    "undercut",
    "wall_findings",
]  # fmt: skip
