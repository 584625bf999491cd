"""Polygons of vectors at the angle at hand: of a linkage's velocities, of the forces on a body; and the force in a pair over the turn."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QPushButton, QWidget

from core.errors import KindynaError
from core.instant_centres import VelocityPolygon, velocity_polygon
from core.mechanism.kinematics import CAM, FRAME
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.note import Note
from kindyna_gui.pictures.vector_polygon.forces import (
    body_label,
    force_box,
    force_diagram,
    pair_box,
    pair_diagram,
    pair_label,
)
from kindyna_gui.pictures.vector_polygon.sheet import PolygonDiagram, PolygonSheet
from kindyna_gui.pictures.vector_polygon.velocities import step_text, velocity_box, velocity_diagram
from kindyna_gui.player import Player
from kindyna_gui.requirements import lists_links
from kindyna_gui.view import View

ABSENT = "The velocity polygon is drawn of linkages; velocities of a cam's follower are drawn in the mechanism."
VELOCITIES, FORCES_ON, FORCE_IN = "velocities", "body", "pair"
BUTTON = 58  # width of a button beside the step's text, pixels
Choice = tuple[str, str]
"""What is drawn, and of which body or pair."""


class PolygonView(View):
    """One diagram, moving with the crank; a list above it says of what. A linkage begins with its velocities, a cam's follower with
    the forces on it."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.choice = QComboBox()
        self.choice.setObjectName("polygon")
        self.choice.setToolTip(
            "What is drawn: velocities from one pole, the forces on a body end to end, or the force in a pin or guide"
        )
        self.choice.currentIndexChanged.connect(self._choose)
        self.sheet = PolygonSheet()
        self.note = Note()
        self.back, self.next, self.all = QPushButton("&Back"), QPushButton("&Next"), QPushButton("&All")
        self.back.setToolTip("One vector less")
        self.next.setToolTip("The next vector of the construction, V_P = V_A + V_PA; the first time begin at the pole")
        self.all.setToolTip("All vectors")
        self.step_label = QLabel(wordWrap=True, alignment=Qt.AlignmentFlag.AlignCenter)
        self.step_label.setMinimumSize(1, 1)
        self.back.clicked.connect(lambda: self._step(-1))
        self.next.clicked.connect(lambda: self._step(1))
        self.all.clicked.connect(lambda: self._show_steps(None))
        self.steps_row = QWidget()
        row = QHBoxLayout(self.steps_row)
        row.setContentsMargins(8, 0, 8, 4)
        for button in (self.back, self.next, self.all):
            button.setMaximumWidth(BUTTON)
        for widget in (self.back, self.step_label, self.next, self.all):
            row.addWidget(widget, 1 if widget is self.step_label else 0)
        self.set_column(self.choice, self.sheet, self.steps_row, self.note, grows=self.sheet)
        self._steps: int | None = None
        self._polygon: VelocityPolygon | None = None
        session.started.connect(partial(setattr, self, "_steps", None))
        self._chosen: Choice | None = None
        self._diagram: Callable[[Study], PolygonDiagram] | None = None

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Forces are computed only while they are drawn."""
        kind, _ = self._wanted()
        return ("linkage",) if kind == VELOCITIES else ("linkage", "cam", "dynamics")

    def _wanted(self) -> Choice:
        """What was chosen, as far as this design has it."""
        rows = [choice for choice, _ in self._rows()]
        return self._chosen if self._chosen is not None and self._chosen in rows else rows[0]

    def _rows(self) -> list[tuple[Choice, str]]:
        """What can be chosen of this design, and its text."""
        study = self.session.study
        rows = [((VELOCITIES, ""), "Velocities")] if lists_links(study.design) else []
        try:
            mechanism = study.mechanism
            pairs = mechanism.pair_names.values()  # of a drawing that can be put together
        except KindynaError:
            return rows or [((VELOCITIES, ""), "Velocities")]
        bodies = [body for body in mechanism.bodies.values() if body != FRAME] + [CAM] * ("cam" in study.stages)
        rows += [((FORCES_ON, body), f"Forces on {body_label(body)}") for body in bodies]
        return rows + [((FORCE_IN, name), f"Force at {pair_label(name)} over the turn") for name in pairs]

    def _choose(self, index: int) -> None:
        if index >= 0:
            self.choose(*self.choice.itemData(index))

    def choose(self, kind: str, name: str = "") -> None:
        """Draw the velocities, the forces on a body, or the force in a pair; without a name of the first."""
        rows = [choice for choice, _ in self._rows() if choice[0] == kind]
        self._chosen = (kind, name) if name or not rows else rows[0]
        self.invalidate()

    def refresh(self, study: Study) -> None:
        wanted, rows = self._wanted(), self._rows()
        with QSignalBlocker(self.choice):
            if [self.choice.itemText(i) for i in range(self.choice.count())] != [text for _, text in rows]:
                self.choice.clear()
                for choice, text in rows:
                    self.choice.addItem(text, choice)
            self.choice.setCurrentIndex([choice for choice, _ in rows].index(wanted))
        self._polygon = None
        self._diagram = {VELOCITIES: self._velocities, FORCES_ON: self._forces_on, FORCE_IN: self._force_in}[wanted[0]](
            study, wanted[1]
        )

    def _velocities(self, study: Study, _: str) -> Callable[[Study], PolygonDiagram]:
        self._polygon = velocity_polygon(study.linkage)
        self.sheet.frame_for(velocity_box(self._polygon, study.omega))
        return lambda at_angle: velocity_diagram(velocity_polygon(at_angle.linkage), at_angle.omega, self._steps)

    # -- step by step ---------------------------------------------------------------------------------------

    def _step(self, by: int) -> None:
        """One vector more or less; from all of them, Next begins at the pole, and Back takes the last away."""
        if self._polygon is not None:
            most = len(self._polygon.steps)
            now = self._steps if self._steps is not None else most if by < 0 else -1
            self._show_steps(min(max(now + by, 0), most))

    def _show_steps(self, count: int | None) -> None:
        self._steps = count
        self.follow(self.player.theta)

    def _tell_step(self) -> None:
        polygon, count = self._polygon, self._steps
        self.steps_row.setVisible(polygon is not None)
        if polygon is not None:
            most = len(polygon.steps)
            self.step_label.setText(
                "" if count is None else f"{count} of {most}: {step_text(polygon, min(count, most))}"
            )
            self.back.setEnabled(count != 0)
            self.next.setEnabled(count != most)
            self.all.setEnabled(count is not None)

    # -- the diagram ----------------------------------------------------------------------------------------

    def _forces_on(self, study: Study, body: str) -> Callable[[Study], PolygonDiagram]:
        rows = study.free_bodies.get(body, ())
        self.sheet.frame_for(force_box(rows))
        largest = max((float(np.abs(row.force[np.isfinite(row.force)]).max(initial=0.0)) for row in rows), default=0.0)
        return lambda at_angle: force_diagram(at_angle.free_bodies.get(body, ()), largest)

    def _force_in(self, study: Study, name: str) -> Callable[[Study], PolygonDiagram]:
        turn = study.dynamics.pairs[name]
        self.sheet.frame_for(pair_box(turn))
        return lambda at_angle: pair_diagram(name, complex(at_angle.dynamics.pairs[name][0]), turn)

    def follow(self, theta: float) -> None:
        study = self.session.study
        if self._diagram is None:
            return
        self._tell_step()
        try:
            diagram = self._diagram(self.session.at(theta))
        except KindynaError as error:
            self.note.show_message(reason(study.design, error))
            return
        absent = self._chosen == (VELOCITIES, "") != self._wanted()
        self.note.show_message(ABSENT if absent else "")
        name = study.angle_name.capitalize()
        self.sheet.show_diagram(diagram, f"{name} {math.degrees(theta):.1f}°")


__all__ = ["PolygonView"]
