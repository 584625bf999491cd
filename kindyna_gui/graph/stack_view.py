"""Displacement, velocity, acceleration, jerk and pressure angle under each other, on one axis of angles."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

from PySide6.QtGui import QKeyEvent, QPalette

from core.motion.extremes import Extremes
from core.study import Quantity, Study
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.marked_view import MarkedView
from kindyna_gui.pictures.plots.quantities import quantities_for, rows_of, split, stages_of, why_empty
from kindyna_gui.player import Player, obey
from kindyna_gui.view import NumberAtHand

SHARES: Mapping[str, int] = MappingProxyType(
    {"displacement": 22, "velocity": 18, "acceleration": 18, "jerk": 18, "pressure_angle": 24}
)
"""Quantity -> its share of the height; the first has the names of the segments above it, the last the angles below it."""


class StackView(MarkedView):
    """One plot for each of ``SHARES``; one that the design does not have says why."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        first, *_, last = SHARES
        self.plots = {name: LivePlot(names=name == first, angles=name == last) for name in SHARES}
        self._drawn: dict[str, list[Quantity]] = {}
        for plot in self.plots.values():
            plot.setMinimumHeight(1)
            plot.angle_moved.connect(self._turn)
            self.offer_explanation(plot)
            self.offer_deeds(plot, partial(self._rows_of, plot))
            plot.addActions([self.marks, plot.whole_action])
        self.set_column(*self.plots.values(), grows=self.plots[first])
        for index, share in enumerate(SHARES.values()):
            self.content.layout().setStretch(index, share)  # type: ignore[union-attr]
        self.content.setBackgroundRole(QPalette.ColorRole.Base)
        self.content.setAutoFillBackground(True)

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those that the quantities shown need."""
        return stages_of(quantities_for(self.session.study, tuple(SHARES)))

    def refresh(self, study: Study) -> None:
        for name, plot in self.plots.items():
            drawn, missing = split(study, rows_of(study, quantities_for(study, (name,))))
            self._drawn[name] = list(drawn)
            plot.name_angle(study)
            if drawn:
                plot.set_curves(study, drawn, read=False, bands=self.bands.read(drawn))  # ``follow`` comes next
            else:
                plot.show_message("\n".join(missing) or why_empty(study, (name,)))
        self.look_for_extremes(study)

    def _rows_of(self, plot: LivePlot) -> list[Quantity]:
        return next((rows for name, rows in self._drawn.items() if self.plots[name] is plot), [])

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        return tuple(row for name, plot in self.plots.items() if plot.lacks_extremes for row in self._drawn[name])

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        for plot in self.plots.values():
            if found is None or plot.lacks_extremes:  # those that were found before are not among them
                plot.show_extremes(found)

    def follow(self, theta: float) -> None:
        for name, plot in self.plots.items():
            plot.set_angle(theta, self.session.at(theta) if self._drawn[name] else None)
        self.extremes.resume()

    def number_at_hand(self) -> NumberAtHand | None:
        chosen = next((name for name, plot in self.plots.items() if plot.underMouse()), "pressure_angle")
        rows = self._drawn.get(chosen)
        return NumberAtHand(rows[0].slug) if rows else None

    def _turn(self, theta: float) -> None:
        self.player.play(False)
        self.player.set_theta(theta)

    def picture(self, ending: str) -> bytes:
        """The plots on paper, without the cursor."""
        from kindyna_gui.pictures.files import curves_file

        self.pull()
        drawn = [rows for rows in self._drawn.values() if rows]
        bands = self.bands.read([row for rows in drawn for row in rows])
        return curves_file(self.session.study, drawn, ending, self.marks.isChecked(), bands)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)


__all__ = ["StackView"]
