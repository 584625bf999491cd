"""The chart of stability under the hand: a point is hovered, picked, or drawn away from the machine's own."""

from __future__ import annotations

from PySide6.QtCore import QPointF

from kindyna_gui.pictures.plots.pulled_point import PulledPoint
from kindyna_gui.pictures.plots.stability_chart import ChartPlot


class StabilityChart(PulledPoint, ChartPlot):
    """The chart with its reactions; all points are (η, Q)."""

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        return ChartPlot.point_at(self, pixel)

    def own_pixel(self) -> QPointF | None:
        machine = self.chart.machine if self.chart is not None else None
        return None if machine is None or not self.own.isVisible() else self.pixel(machine.eta, machine.q)


__all__ = ["StabilityChart"]
