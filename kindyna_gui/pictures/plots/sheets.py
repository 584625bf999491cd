"""Plots that are not curves by cam angle, as files: polar plots side by side, plots of a figure below each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout

from core.study import Quantity, Study
from kindyna_gui.pictures.detail import UNSEEN
from kindyna_gui.pictures.paper import MARGIN, RATIO, PaperSheet, png, svg
from kindyna_gui.pictures.plots.curves import channel_extremes
from kindyna_gui.pictures.plots.plot import NO_BANDS
from kindyna_gui.pictures.plots.polar import PolarPlot
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.style import LIGHT, SMALL, Theme

CELL = (560, 560)  # of a plot on paper, pixels


def columns_for(count: int, width: float, height: float) -> int:
    """Columns of a grid in which so many square plots become largest in the room given."""
    sizes = {c: min(width / c, height / math.ceil(count / c)) for c in range(1, max(1, count) + 1)}
    return max(sizes, key=lambda c: sizes[c])


class PolarSheet(PaperSheet):
    """Polar plots side by side, for files; unseen: pixels by which curves may be off; 0 draws every point; marks: whether
    extremes are marked; bands: as ``set_curves``."""

    def __init__(
        self,
        study: Study,
        rows: Sequence[Sequence[Quantity]],
        theme: Theme,
        unseen: float = 0.0,
        marks: bool = True,
        bands: Mapping[str, np.ndarray] = NO_BANDS,
    ) -> None:
        super().__init__(theme)
        grid = QGridLayout(self)
        grid.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        columns = math.ceil(math.sqrt(len(rows)))
        for place, row in enumerate(rows):
            plot = PolarPlot(self, theme)
            plot.unseen = unseen
            plot.set_curves(study, row, bands=bands)
            plot.show_extremes(channel_extremes(study, row) if marks else None)
            plot.show_cursor(False)
            grid.addWidget(plot, place // columns, place % columns)
        self.resize(CELL[0] * columns, CELL[1] * math.ceil(len(rows) / columns))


def polar_file(
    study: Study,
    rows: Sequence[Sequence[Quantity]],
    ending: str,
    marks: bool = True,
    bands: Mapping[str, np.ndarray] = NO_BANDS,
) -> bytes:
    """Polar plots as a file, ``.png`` or ``.svg``, their extremes marked, bands shaded. Raises NoSolution where one has no values."""
    if ending == ".svg":
        return svg(PolarSheet(study, rows, LIGHT, marks=marks, bands=bands), study.design.name)
    return png(PolarSheet(study, rows, replace(LIGHT, ratio=RATIO), UNSEEN / RATIO, marks, bands))


if TYPE_CHECKING:
    from core.stability import Figure

WIDTH, HEIGHT = 960, 300  # of one plot
ALIKE = (720, 640)  # of one whose axes have one scale


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
        sizes = [ALIKE if each.alike else (WIDTH, HEIGHT) for each in figure.plots]
        self.resize(max(width for width, _ in sizes), sum(height for _, height in sizes) + 40)


def figure_file(figure: Figure, ending: str) -> bytes:
    """A figure as a file, ``.png`` or ``.svg``."""
    vector = ending == ".svg"
    sheet = XYSheet(figure, LIGHT if vector else replace(LIGHT, ratio=RATIO))
    sheet.grab()  # the axes find their sizes
    return svg(sheet, figure.title) if vector else png(sheet)


__all__ = ["XYSheet", "figure_file"]
