"""View of a cam in space: shaded picture, side and end, and the unrolled flanks coloured by pressure angle."""

from __future__ import annotations

import numpy as np
from PySide6.QtWidgets import QTabWidget

from core.spatial.picture import cam_facets, roller_facets
from core.study import Study
from core.study.limits import limit_of
from kindyna_gui.documents.session import Session
from kindyna_gui.player import Player
from kindyna_gui.requirements import Unavailable
from kindyna_gui.spatial.solid import END, OBLIQUE, SIDE, SolidCanvas
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
        self.solid = SolidCanvas("Cam in space", [("", OBLIQUE)], turns=True)
        self.planes = SolidCanvas("Side and end view", [("Side view", SIDE), ("End view", END)], turns=False)
        self.unrolled = UnrolledCanvas()
        self.tabs = QTabWidget(documentMode=True)
        for page, title in ((self.solid, "Shaded"), (self.planes, "Side and end"), (self.unrolled, "Unrolled flanks")):
            self.tabs.addTab(page, title)
        self.set_column(self.tabs, grows=self.tabs)

    def refresh(self, study: Study) -> None:
        if not study.has_surface:
            raise Unavailable(NOT_IN_SPACE)
        shape, cam = study.surface, study.design.drive.cam
        limit = limit_of(study, "pressure_angle_rise_deg")
        steepest = np.deg2rad(45.0 if limit is None else limit.value)

        machine = shape.machine
        y = shape.motion.y
        middle = 0.5 * float(y.min() + y.max()) if machine.slides else 0.0
        outer = 1e-3 * cam.outer_radius_mm if cam.outer_radius_mm else machine.outer
        facets = cam_facets(
            machine,
            study.motion_rows,
            shape.sense,
            outer,
            0.5e-3 * (cam.bore_mm or 0.0),
            middle,
            ANGLES[machine.is_turret],
        )
        for canvas in (self.solid, self.planes):
            canvas.cam, canvas.limit = facets, steepest
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
        for canvas in (self.solid, self.planes):
            canvas.rollers, canvas.angle = roller_facets(shape.machine, float(shape.motion.y[0])), shape.sense * theta
            canvas.update()
        self.unrolled.theta = theta
        self.unrolled.update()

    def fit(self) -> None:
        self.solid.look(*OBLIQUE)


__all__ = ["NOT_IN_SPACE", "SpatialView"]
