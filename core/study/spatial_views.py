"""Side view and end view of the cam in space of a study."""

from __future__ import annotations

from core.spatial.picture import blank_of
from core.spatial.views import CamViews, cam_views
from core.study.stages import memory
from core.study.study import Study


def spatial_views(study: Study) -> CamViews:
    """Side view and end view of a cam in space; the same object while motion and cam are the same.

    Raises
    ------
    NoSuchStage
        The design has no cam in space.
    NoCam
        No cam is possible.
    """
    shape = study.surface
    blank = blank_of(shape, study.design.drive.cam)
    views: CamViews = memory.get(
        "views", (study.depends_on("cam"), blank),
        lambda: cam_views(shape.machine, study.motion_rows, shape.sense, blank), is_locked=True,
    )  # fmt: skip
    return views
