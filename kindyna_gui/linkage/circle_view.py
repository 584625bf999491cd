"""The lecture's circle diagram beside the drawing, with Back and Next."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton

from core.instant_centres import Construction
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.pictures.circle_diagram import Diagram, step_text
from kindyna_gui.player import Player
from kindyna_gui.requirements import require_links
from kindyna_gui.view import View

ABSENT = "The circle diagram finds the centres of a linkage; this is a cam with its follower."


class CircleView(View):
    """The diagram with Back and Next; the same step is drawn in the mechanism."""

    stages = ("linkage",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.diagram = Diagram()
        self.text = QLabel(wordWrap=True)
        self.text.setMinimumSize(1, 1)
        self.text.setContentsMargins(8, 0, 8, 0)
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.count = QLabel(alignment=Qt.AlignmentFlag.AlignCenter)
        self.back, self.next, self.end = QPushButton("&Back"), QPushButton("&Next"), QPushButton("&End")
        self.back.setToolTip("One step back")
        self.next.setToolTip("Find the next centre; its lines are drawn in the mechanism")
        self.end.setToolTip("Leave the construction; the drawing shows its own layers again")
        self.back.clicked.connect(lambda: self._go(-1))
        self.next.clicked.connect(lambda: self._go(1))
        self.end.clicked.connect(lambda: session.choose_step(None))
        row = QHBoxLayout()
        row.setContentsMargins(8, 0, 8, 6)
        for widget in (self.back, self.count, self.next, self.end):
            row.addWidget(widget, 1 if widget is self.count else 0)
        self.set_column(self.diagram, self.text, row, grows=self.diagram, spacing=4)
        session.step_changed.connect(self._redraw)

    def _plan(self) -> tuple[tuple[str, ...], Construction]:
        study = self.session.study
        table = study.centres
        return table.bodies, table.construction

    def refresh(self, study: Study) -> None:
        require_links(study.design, ABSENT)
        bodies, plan = self._plan()
        chosen = self.session.step
        step = min(chosen or 0, len(plan.steps))
        self.diagram.show_step(bodies, plan, step)
        more = (
            f" {len(plan.beyond)} centres are not reached by two triangles."
            if plan.beyond and step == len(plan.steps)
            else ""
        )
        self.text.setText(step_text(plan, step) + more)
        self.count.setText(f"{step} of {len(plan.steps)}")
        self.back.setEnabled(step > 0)
        self.next.setEnabled(step < len(plan.steps))
        self.end.setEnabled(chosen is not None)

    def _redraw(self) -> None:
        if self.on_screen() and self.up_to_date and not self.in_trouble:
            self.refresh(self.session.study)
        else:
            self.invalidate()

    def _go(self, step: int) -> None:
        _, plan = self._plan()
        now = self.session.step or 0
        self.session.choose_step(min(max(now + step, 0), len(plan.steps)))


__all__ = ["CircleView", "Diagram"]
