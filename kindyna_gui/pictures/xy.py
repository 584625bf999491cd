"""Small plots of one quantity over another, with axes and a legend of their own: histories, phase planes, spectra."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np
import pyqtgraph as pg
from PySide6.QtGui import QPainterPath
from PySide6.QtWidgets import QFrame, QWidget

from kindyna_gui.pictures.items import Outline, Tag, wrapped
from kindyna_gui.pictures.plot_parts import BOTTOM_HEIGHT, LEFT_WIDTH, Axis, angle_ticks
from kindyna_gui.pictures.style import BLUE, DASHED, GREEN, LIGHT, ORANGE, PURPLE, SMALL, TEXT, THIN, VERMILION, Theme
from kindyna_gui.pictures.units import decimals_of, number, ticks

if TYPE_CHECKING:
    from core.stability import Plot

LEAST_X, LEAST_Y = 46.0, 26.0  # pixels between ticks
FREE = 0.06  # of the range, left free around the curves
RIGHT_MARGIN, LEGEND_HEIGHT = 16, 18
WHOLE_TURN = (0.0, 360.0)  # an axis of cam angles
ROWS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE)
"""Colours of the curves of a plot, one after the other."""


@dataclass(frozen=True, eq=False)
class Line:
    """One curve: x and y (n,), nan where it is broken, its colour, its name in the legend, dashes."""

    x: np.ndarray
    y: np.ndarray
    colour: str
    label: str = ""
    dash: tuple[float, ...] = ()


class XYPlot(pg.PlotWidget):
    """Curves with axes of their own; ``marks``: upright lines with a text, such as where the follower leaves the cam."""

    def __init__(self, across: str, upwards: str, parent: QWidget | None = None, theme: Theme = LIGHT) -> None:
        self._theme = theme
        axes = {side: Axis(side, theme) for side in ("left", "bottom")}
        super().__init__(parent, background=theme.paper, axisItems=axes, enableMenu=False)
        self.setCacheMode(self.CacheModeFlag.CacheNone)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setAntialiasing(True)
        self._axes, self._titles = axes, (across, upwards)
        plot = self.getPlotItem()
        self._view: pg.ViewBox = plot.getViewBox()
        plot.hideButtons()
        plot.layout.setContentsMargins(2, 6, RIGHT_MARGIN, 2)
        self._view.setMouseEnabled(False, False)
        self._view.disableAutoRange()
        self._view.setDefaultPadding(0.0)
        axes["left"].setWidth(LEFT_WIDTH)
        axes["bottom"].setHeight(BOTTOM_HEIGHT)
        self._grid = self._outline(theme.faint, -80.0)
        self._zero = self._outline(theme.quiet, -70.0)
        self._zero.setOpacity(0.6)
        self._drawn: list[pg.PlotCurveItem] = []
        self._marks: list[tuple[Outline, Tag, float]] = []
        self._message = Tag("", theme.quiet, theme, TEXT)
        self._view.addItem(self._message, ignoreBounds=True)
        self._words, self._note = "", ""
        self._legend: list[str] = []
        self._view.sigResized.connect(self._lay)
        self.show_message("")

    def _outline(self, colour: str, z: float, dash: tuple[float, ...] = ()) -> Outline:
        item = Outline(QPainterPath(), self._theme.pen(colour, THIN, dash))
        item.setZValue(z)
        self._view.addItem(item, ignoreBounds=True)
        return item

    # -- what is drawn --------------------------------------------------------------------------------------

    @property
    def lines(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """x and y of the curves that are drawn."""
        return [(item.xData, item.yData) for item in self._drawn]

    @property
    def message(self) -> str:
        return self._words

    def show_lines(
        self, lines: list[Line], marks: tuple[tuple[float, str], ...] = (), square: bool = False, note: str = ""
    ) -> None:
        """Draw these curves and no others; square: zero in the middle of both axes; note: for the legend."""
        self._clear()
        for line in lines:
            item = pg.PlotCurveItem(antialias=True)
            broken = not np.isfinite(line.y).all()
            pen = self._theme.pen(line.colour, THIN, line.dash)
            item.setData(line.x, line.y, pen=pen, connect="finite" if broken else "all")
            self._view.addItem(item, ignoreBounds=True)
            self._drawn.append(item)
        self._name([(line.colour, line.label) for line in lines if line.label], note)
        x, y = (np.concatenate(part) for part in zip(*((line.x, line.y) for line in lines), strict=True))
        ranges = [self._range(x, square, tight=not square), self._range(y, square)]
        self._view.setRange(xRange=ranges[0], yRange=ranges[1], padding=0.0)
        for at, text in marks:
            line = self._outline(self._theme.limit, 5.0, DASHED)
            tag = Tag(text, self._theme.limit, self._theme, lean=(0.0, 0.0), backing=True)
            tag.setZValue(20.0)
            self._view.addItem(tag, ignoreBounds=True)
            self._marks.append((line, tag, at))
        self._words = ""
        self._lay()

    def name_axes(self, across: str, upwards: str) -> None:
        """The titles of the axes of what is shown next."""
        self._titles = across, upwards

    def show_plot(self, plot: Plot) -> None:
        """Draw a plot of the core: with one curve in ink, with several each row of them in its colour."""
        self.name_axes(plot.across, plot.upwards)
        alone = len({curve.row for curve in plot.curves}) == 1
        self.show_lines(
            [
                Line(
                    curve.x,
                    curve.y,
                    self._theme.ink if alone else ROWS[curve.row % len(ROWS)],
                    curve.label,
                    DASHED if curve.dashed else (),
                )
                for curve in plot.curves
            ],
            plot.marks,
            note=plot.note,
        )

    def _name(self, named: list[tuple[str, str]], note: str = "") -> None:
        """The legend above the curves; no room is lost where none has a name."""
        self._legend = [f'<span style="color:{colour}">—</span> {escape(name)}' for colour, name in named]
        self._note = note
        item = self.getPlotItem()
        item.layout.setRowFixedHeight(0, LEGEND_HEIGHT if named else 0)
        item.titleLabel.setMaximumHeight(LEGEND_HEIGHT if named else 0)

    def _show_legend(self, width: float) -> None:
        """With its note where there is room for both."""
        item, parts = self.getPlotItem(), [*self._legend, escape(self._note)]
        for told in (parts, self._legend) if self._note else (self._legend,):
            item.setTitle("&nbsp;&nbsp; ".join(told) or None, size=f"{SMALL}px", color=self._theme.ink)
            wide = item.titleLabel.minimumWidth()
            item.titleLabel.setMinimumWidth(0.0)  # else a long legend would widen the plot
            if wide <= width:
                break

    @staticmethod
    def _range(values: np.ndarray, square: bool, tight: bool = False) -> tuple[float, float]:
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        if square:
            half = max(abs(low), abs(high)) or 1.0
            low, high = -half, half
        elif not tight:
            low, high = min(low, 0.0), max(high, 0.0)
        if high - low <= 1e-12 * max(abs(low), abs(high), 1e-300):
            high = low + 1.0
        free = 0.0 if tight else FREE * (high - low)
        return low - free, high + free

    def show_message(self, text: str) -> None:
        """Nothing but a text: what is missing, or what would fill this plot."""
        self._clear()
        self._name([])
        self._words = text
        self._view.setRange(xRange=(0.0, 1.0), yRange=(0.0, 1.0), padding=0.0)
        self._lay()

    def _clear(self) -> None:
        for item in self._drawn:
            self._view.removeItem(item)
        for line, tag, _ in self._marks:
            self._view.removeItem(line)
            self._view.removeItem(tag)
        self._drawn, self._marks = [], []

    # -- layout ---------------------------------------------------------------------------------------------

    def _lay(self, *_: object) -> None:
        (low, high), (bottom, top) = self._view.viewRange()
        width, height = max(self._view.width(), 1.0), max(self._view.height(), 1.0)
        across, step_x = ticks(low, high, max(2, int(width / LEAST_X)))
        if (low, high) == WHOLE_TURN:
            across, step_x = [x for x, _ in angle_ticks(width)], 1.0
        upwards, step_y = ticks(bottom, top, max(2, int(height / LEAST_Y)))
        if not self._drawn:
            across, upwards = [], []
        self._show_legend(width)
        grid, zero = QPainterPath(), QPainterPath()
        for x in across:
            grid.moveTo(x, bottom)
            grid.lineTo(x, top)
        for y in upwards:
            path = zero if y == 0.0 else grid
            path.moveTo(low, y)
            path.lineTo(high, y)
        self._grid.redraw(grid)
        self._zero.redraw(zero)
        self._axes["bottom"].show_ticks([(x, number(x, decimals_of(step_x))) for x in across])
        self._axes["left"].show_ticks([(y, number(y, decimals_of(step_y))) for y in upwards])
        self._axes["bottom"].show_title(self._titles[0] if self._drawn else "", self._theme.ink)
        self._axes["left"].show_title(self._titles[1] if self._drawn else "", self._theme.ink)
        for line, tag, at in self._marks:
            path = QPainterPath()
            path.moveTo(at, bottom)
            path.lineTo(at, top)
            line.redraw(path)
            right = (high - at) / (high - low) * width > tag.size[0] + 10.0
            tag.set_lean(0.0 if right else 1.0, 0.0)
            tag.shift(4.0 if right else -4.0, 2.0)
            tag.setPos(at, top)
        self._message.set_text(wrapped(self._words, width - 16.0, TEXT))
        self._message.setPos(0.5 * (low + high), 0.5 * (bottom + top))


__all__ = ["Line", "XYPlot"]
