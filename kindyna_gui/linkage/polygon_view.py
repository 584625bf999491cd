"""The velocity polygon of a linkage at the angle at hand: V_P = V_A + V_PA of every link and slide."""

from __future__ import annotations

import math

from core.errors import KindynaError
from core.instant_centres import velocity_polygon
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import sentence
from kindyna_gui.note import Note
from kindyna_gui.pictures.drawing.polygon import PolygonSheet
from kindyna_gui.requirements import lists_links, require_links
from kindyna_gui.view import View
from kindyna_gui.window.player import Player

ABSENT = "The velocity polygon is drawn of linkages; velocities of a cam's follower are drawn in the mechanism."


class PolygonView(View):
    """The polygon, moving with the crank; its numbers stand in the table of differences."""

    stages = ("linkage",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.sheet = PolygonSheet()
        self.note = Note()
        self.set_column(self.sheet, self.note, grows=self.sheet)

    def refresh(self, study: Study) -> None:
        require_links(study.design, ABSENT)
        self.sheet.frame_for(velocity_polygon(study.linkage), study.omega)

    def follow(self, theta: float) -> None:
        study = self.session.study
        if not lists_links(study.design):
            return
        try:
            at_angle = self.session.at(theta)
            polygon = velocity_polygon(at_angle.linkage)
        except KindynaError as error:
            self.note.show_message(sentence(str(error)))
            return
        self.note.show_message("")
        name = study.angle_name.capitalize()
        self.sheet.show_polygon(polygon, study.omega, f"{name} {math.degrees(theta):.1f}°")


__all__ = ["PolygonView"]
