"""The displacement diagram with velocity, acceleration and jerk below it, on one axis of angles, where there is room for them."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import Signal
from PySide6.QtGui import QPalette, QResizeEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from core.motion.extremes import Extremes
from core.study import Quantity, Study
from kindyna_gui.documents.bands import Bands
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.motion.diagram import MotionDiagram
from kindyna_gui.pictures.plots.quantities import rows_of

QUANTITIES = ("velocity", "acceleration", "jerk")
LEAST = 350  # pixels of height, from which on the three stand below the displacement
DIAGRAM, PLOT, LAST = 34, 20, 26  # shares of the height; the last plot has the angles below it


class DerivativePlots(QWidget):
    """The diagram, and below it the plots of ``QUANTITIES``, which are drawn only while there is room for them.

    angle_moved     (cam angle [rad]): a click into one of the plots, or the cursor drawn there
    room_changed    there is room for the plots, or no longer
    """

    angle_moved = Signal(float)
    room_changed = Signal()

    def __init__(self, diagram: MotionDiagram) -> None:
        super().__init__()
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        self._diagram = diagram
        self.plots = tuple(LivePlot(names=False, angles=name == QUANTITIES[-1]) for name in QUANTITIES)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(diagram, DIAGRAM)
        for plot in self.plots:
            plot.setMinimumHeight(1)
            plot.hide()
            plot.angle_moved.connect(self.angle_moved)
            column.addWidget(plot, LAST if plot is self.plots[-1] else PLOT)

    @property
    def roomy(self) -> bool:
        """Whether the plots are there."""
        return not self.plots[0].isHidden()

    def show_study(self, study: Study, bands: Bands) -> None:
        """Draw velocity, acceleration and jerk of a study, with the bands of what is made."""
        if self.roomy:
            for plot, quantity in zip(self.plots, QUANTITIES, strict=True):
                rows = rows_of(study, (quantity,))
                plot.set_curves(study, rows, read=False, bands=bands.read(rows))

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        """The channels of the plots whose extremes are not marked yet."""
        pairs = zip(self.plots, QUANTITIES, strict=True) if self.roomy else ()
        return tuple(row for plot, quantity in pairs if plot.lacks_extremes for row in rows_of(study, (quantity,)))

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        """Mark the extremes of each plot, by its quantity; None: mark none."""
        for plot in self.plots:
            if found is None or plot.lacks_extremes:  # those that were found before are not among them
                plot.show_extremes(found)

    def set_angle(self, theta: float, at_angle: Study) -> None:
        """Move the cursors to cam angle theta [rad]; at_angle: the study there."""
        if self.roomy:
            for plot in self.plots:
                plot.set_angle(theta, at_angle)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        roomy = self.height() >= LEAST
        if roomy != self.roomy:
            for plot in self.plots:
                plot.setVisible(roomy)
            self._diagram.show_angles(not roomy)
            self.room_changed.emit()


__all__ = ["QUANTITIES", "DerivativePlots"]
