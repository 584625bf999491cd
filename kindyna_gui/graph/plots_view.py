"""Curves over one turn, one plot in each dock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeyEvent, QPalette

from core.motion.extremes import Range
from core.output.channels import Channel
from core.study import Study
from kindyna_gui.documents.exports import save_numbers, save_picture
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.marked_view import MarkedView
from kindyna_gui.graph.quantities import figures_of, quantities_for, rows_of, split, stages_of, why_empty
from kindyna_gui.look import QUIET
from kindyna_gui.note import Note
from kindyna_gui.window.player import Player, obey

LEAST_WIDTH = 240  # below it labels and axes no longer fit


class PlotView(MarkedView):
    """One plot of a few quantities of one unit; those that a design does not have are named with the reason."""

    keeps_pace = False  # a hand is guided by what it draws

    def __init__(self, session: Session, player: Player, quantities: Sequence[str]) -> None:
        super().__init__(session, player)
        self.usual = tuple(quantities)
        self.plot = LivePlot()
        self.plot.setMinimumWidth(LEAST_WIDTH)
        self.note = Note(QUIET, margin=3)
        self.note.setIndent(6)
        self.rows: tuple[Channel, ...] = ()
        self.message = ""  # in place of the curves
        self.set_column(self.plot, self.note, grows=self.plot)
        self.content.setBackgroundRole(QPalette.ColorRole.Base)
        self.content.setAutoFillBackground(True)
        self.plot.angle_moved.connect(self._turn)
        self.plot.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
        for text, slot in (
            ("Export picture...", lambda: save_picture(self, self.usual[0])),
            ("Export numbers...", lambda: save_numbers(self, self.rows, self.usual[0])),
        ):
            action = QAction(text, self.plot)
            action.triggered.connect(slot)
            self.plot.addAction(action)
        self.plot.addActions([self.marks, self.plot.whole_action])

    @property
    def quantities(self) -> tuple[str, ...]:
        """What is shown of the design in place."""
        return quantities_for(self.session.study, self.usual)

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those that the quantities shown need."""
        return stages_of(self.quantities)

    def refresh(self, study: Study) -> None:
        quantities = self.quantities
        if not quantities and study.design.drive.links:
            _ = study.linkage  # where it stands nowhere, that is the reason
        drawn, missing = split(study, rows_of(study, quantities))
        self.rows = tuple(drawn)
        self.plot.name_angle(study)
        self.message = "" if drawn else "\n".join(missing) or why_empty(study, self.usual)
        if drawn:
            self.plot.set_curves(study, drawn, read=False)  # ``follow`` comes next
        else:
            self.plot.show_message(self.message)
        self.note.show_message("\n".join(["; ".join(missing), *figures_of(study, self.usual)]).strip() if drawn else "")
        self.look_for_extremes(study)

    def lacking(self, study: Study) -> tuple[Channel, ...]:
        return self.rows if self.plot.lacks_extremes else ()

    def show_extremes(self, found: Mapping[str, Range] | None) -> None:
        self.plot.show_extremes(found)

    def follow(self, theta: float) -> None:
        self.plot.set_angle(theta, self.session.at(theta) if self.rows else None)
        self.extremes.resume()

    def _turn(self, theta: float) -> None:
        self.player.play(False)
        self.player.set_theta(theta)

    @property
    def no_picture(self) -> str:
        return super().no_picture or self.message

    def picture(self, ending: str) -> bytes:
        """The plot on paper, without the cursor."""
        from kindyna_gui.pictures.files import curves_file

        self.pull()
        return curves_file(self.session.study, [self.rows], ending, self.marks.isChecked())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)


__all__ = ["PlotView"]
