"""Plots that are no chart and no curves by cam angle, one below the other, as a file."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QLabel, QVBoxLayout

from kindyna_gui.pictures.files import RATIO, png, svg
from kindyna_gui.pictures.plots.paper_sheet import MARGIN, PaperSheet
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.style import LIGHT, SMALL, Theme

if TYPE_CHECKING:
    from core.stability import Figure

WIDTH, HEIGHT = 960, 300  # of one plot


class XYSheet(PaperSheet):
    """The plots of a figure under its title."""

    def __init__(self, figure: Figure, theme: Theme) -> None:
        super().__init__(theme)
        column = QVBoxLayout(self)
        column.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        title = QLabel(figure.title)
        title.setStyleSheet(f"color: {theme.ink}; font-size: {SMALL + 2}px")
        column.addWidget(title)
        self.plots: list[XYPlot] = []
        for each in figure.plots:
            plot = XYPlot(each.across, each.upwards, theme=theme)
            plot.show_plot(each)
            column.addWidget(plot, 1)
            self.plots.append(plot)
        self.resize(WIDTH, HEIGHT * len(figure.plots) + 40)


def figure_file(figure: Figure, ending: str) -> bytes:
    """A figure as a file, ``.png`` or ``.svg``."""
    vector = ending == ".svg"
    sheet = XYSheet(figure, LIGHT if vector else replace(LIGHT, ratio=RATIO))
    sheet.grab()  # the axes find their sizes
    return svg(sheet, figure.title) if vector else png(sheet)


__all__ = ["XYSheet", "figure_file"]
