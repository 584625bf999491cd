"""View of a cam in space: shaded picture, and the unrolled flanks coloured by pressure angle."""

from __future__ import annotations

import numpy as np
from PySide6.QtWidgets import QTabWidget

from core.spatial.picture import blank_of, cam_facets, roller_facets
from core.study import Study
from core.study.limits import limit_of
from kindyna_gui.documents.session import Session
from kindyna_gui.player import Player
from kindyna_gui.requirements import Unavailable
from kindyna_gui.spatial.solid import OBLIQUE, SolidCanvas
from kindyna_gui.spatial.unrolled import UnrolledCanvas
from kindyna_gui.view import View

ANGLES = {False: 144, True: 120}  # steps of the picture around the turn: one roller, a turret, whose flanks are short
ROWS = 24  # points along the roller in the map
NOT_IN_SPACE = (
    "This design has no cam in space. A motion alone can have one: File > New, Barrel cam or Globoidal cam, or in the file "
    '[cam] with kind = "barrel" or "globoidal".'
)


class SpatialView(View):
    """Pages of a cam in space at the current cam angle."""

    stages = ("cam",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.solid = SolidCanvas()
        self.unrolled = UnrolledCanvas()
        self.tabs = QTabWidget(documentMode=True)
        for page, title in ((self.solid, "Shaded"), (self.unrolled, "Unrolled flanks")):
            self.tabs.addTab(page, title)
        self.set_column(self.tabs, grows=self.tabs)

    def refresh(self, study: Study) -> None:
        if not study.has_surface:
            raise Unavailable(NOT_IN_SPACE)
        shape, cam = study.surface, study.design.drive.cam
        limit = limit_of(study, "pressure_angle_rise_deg")
        steepest = np.deg2rad(45.0 if limit is None else limit.value)

        machine = shape.machine
        facets = cam_facets(machine, study.motion_rows, shape.sense, blank_of(shape, cam), ANGLES[machine.is_turret])
        self.solid.cam, self.solid.limit = facets, steepest
        self.unrolled.maps = [
            (f"Flank {side} of the roller", surface.pressure_angle)
            for side, surface in shape.along_length(ROWS).items()
        ]
        self.unrolled.ends, self.unrolled.limit = (machine.inner, machine.outer), steepest

    def follow(self, theta: float) -> None:
        study = self.session.study
        if not study.has_surface:
            return
        shape = study.at_theta(np.array([theta])).surface
        self.solid.rollers = roller_facets(shape.machine, float(shape.motion.y[0]))
        self.solid.angle = shape.sense * theta
        self.solid.update()
        self.unrolled.theta = theta
        self.unrolled.update()

    def fit(self) -> None:
        self.solid.look(*OBLIQUE)


__all__ = ["NOT_IN_SPACE", "SpatialView"]
