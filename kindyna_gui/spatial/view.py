"""View of a cam in space: shaded picture, and the unrolled flanks coloured by pressure angle."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtWidgets import QTabWidget, QWidget

from core.spatial.picture import blank_of, cam_facets, roller_facets
from core.study import Study
from core.study.limits import limit_of
from kindyna_gui.documents.session import Session
from kindyna_gui.pictures.units import nearest
from kindyna_gui.player import Player
from kindyna_gui.requirements import NOT_IN_SPACE, Unavailable
from kindyna_gui.spatial.solid import OBLIQUE, SolidCanvas
from kindyna_gui.spatial.unrolled import UnrolledCanvas
from kindyna_gui.view import View

ANGLES = {False: 144, True: 120}  # steps of the picture around the turn: one roller, a turret, whose flanks are short
POSES = 8  # of the rollers over the turn, which fit in the picture
ROWS = 24  # points along the roller in the map


class SpatialView(View):
    """Pages of a cam in space at the current cam angle; only the page in front is computed."""

    stages = ("cam",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.solid = SolidCanvas()
        self.unrolled = UnrolledCanvas()
        self.tabs = QTabWidget(documentMode=True)
        self._fill: dict[QWidget, Callable[[Study, float], None]] = {
            self.solid: self._fill_solid,
            self.unrolled: self._fill_unrolled,
        }
        for page, title in ((self.solid, "Shaded"), (self.unrolled, "Unrolled flanks")):
            self.tabs.addTab(page, title)
        self.tabs.currentChanged.connect(lambda _: self.wake())
        self._filled: dict[QWidget, Study] = {}  # page -> the study it shows
        self.set_column(self.tabs, grows=self.tabs)

    def refresh(self, study: Study) -> None:
        if not study.has_surface:
            raise Unavailable(NOT_IN_SPACE)
        _ = study.surface  # raises the reason if there is none

    def follow(self, theta: float) -> None:
        study, page = self.session.study, self.tabs.currentWidget()
        if not study.has_surface:
            return
        if self._filled.get(page) is not study:
            limit = limit_of(study, "pressure_angle_rise_deg")
            self._fill[page](study, np.deg2rad(45.0 if limit is None else limit.value))
            self._filled[page] = study
        if page is self.solid:
            shape = study.surface
            y = float(shape.motion.y[nearest(study.theta, theta)])
            self.solid.rollers, self.solid.angle = roller_facets(shape.machine, y), shape.sense * theta
        self.unrolled.theta = theta
        page.update()

    def _fill_solid(self, study: Study, steepest: float) -> None:
        shape = study.surface
        machine, blank = shape.machine, blank_of(shape, study.design.drive.cam)
        self.solid.cam = cam_facets(machine, study.motion_rows, shape.sense, blank, ANGLES[machine.is_turret])
        self.solid.limit = steepest
        poses = shape.motion.y[:: max(1, shape.motion.y.size // POSES)]
        self.solid.frame([roller_facets(machine, float(y)) for y in poses])

    def _fill_unrolled(self, study: Study, steepest: float) -> None:
        shape = study.surface
        self.unrolled.maps = [
            (f"Flank {side}", surface.pressure_angle) for side, surface in shape.along_length(ROWS).items()
        ]
        self.unrolled.ends, self.unrolled.limit = (shape.machine.inner, shape.machine.outer), steepest

    def fit(self) -> None:
        self.solid.look(*OBLIQUE)


__all__ = ["NOT_IN_SPACE", "SpatialView"]
