"""The velocity polygon of a linkage at the angle at hand: V_P = V_A + V_PA of every link and slide."""

from __future__ import annotations

import math

from PySide6.QtWidgets import QLabel, QVBoxLayout

from core.errors import KindynaError
from core.instant_centres import velocity_polygon
from core.study import LinkageStudy, Study
from kindyna_gui.look import WRONG, coloured
from kindyna_gui.pictures.polygon import PolygonSheet
from kindyna_gui.player import Player
from kindyna_gui.session import Session
from kindyna_gui.shown_kinds import NotHere
from kindyna_gui.view import View
from kindyna_gui.wording import sentence

ABSENT = "The velocity polygon is drawn of linkages; velocities of a cam's follower are drawn in the mechanism."


class PolygonView(View):
    """The polygon, moving with the crank; its numbers stand in the table of differences."""

    stages = ("linkage",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.sheet = PolygonSheet()
        self.note = QLabel(wordWrap=True, margin=6)
        self.note.setMinimumSize(1, 1)
        self.note.hide()
        coloured(self.note, WRONG)
        column = QVBoxLayout()
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.sheet, 1)
        column.addWidget(self.note)
        self.set_content_layout(column)

    def refresh(self, study: Study) -> None:
        if not isinstance(study, LinkageStudy):
            raise NotHere(ABSENT)
        self.sheet.frame_for(velocity_polygon(study.linkage), study.omega)

    def follow(self, theta: float) -> None:
        study = self.session.study
        if not isinstance(study, LinkageStudy):
            return
        try:
            there = self.session.at(theta)
            polygon = velocity_polygon(there.linkage)
        except KindynaError as error:
            self.note.setText(sentence(str(error)))
            self.note.show()
            return
        self.note.hide()
        name = study.angle_name.capitalize()
        self.sheet.show_polygon(polygon, study.omega, f"{name} {math.degrees(theta):.1f}°")


__all__ = ["PolygonView"]
