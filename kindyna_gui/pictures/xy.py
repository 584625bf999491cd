"""Small plots of one quantity over another that is no cam angle: histories, phase planes, spectra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyqtgraph as pg
from PySide6.QtGui import QPainterPath
from PySide6.QtWidgets import QFrame, QWidget

from kindyna_gui.pictures.items import Outline, Tag, wrapped
from kindyna_gui.pictures.plot_parts import BOTTOM_HEIGHT, LEFT_WIDTH, Axis
from kindyna_gui.pictures.style import DASHED, LIGHT, TEXT, THIN, Theme
from kindyna_gui.pictures.units import decimals_of, number, ticks

LEAST_X, LEAST_Y = 46.0, 26.0  # pixels between ticks
FREE = 0.06  # of the range, left free around the curves
RIGHT_MARGIN = 16


@dataclass(frozen=True, eq=False)
class Line:
    """One curve: x and y (n,), its colour, dashes, and whether its points stand as bars on zero."""

    x: np.ndarray
    y: np.ndarray
    colour: str
    dash: tuple[float, ...] = ()
    bars: bool = False


class XYPlot(pg.PlotWidget):
    """Curves with axes of their own; ``marks``: upright lines with a text, such as where the follower leaves the cam."""

    def __init__(self, across: str, upwards: str, parent: QWidget | None = None, theme: Theme = LIGHT) -> None:
        self._theme = theme
        axes = {side: Axis(side, theme) for side in ("left", "bottom")}
        super().__init__(parent, background=theme.paper, axisItems=axes)
        self.setCacheMode(self.CacheModeFlag.CacheNone)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setAntialiasing(True)
        self._axes, self._titles = axes, (across, upwards)
        plot = self.getPlotItem()
        self._view: pg.ViewBox = plot.getViewBox()
        plot.hideButtons()
        plot.setMenuEnabled(False)
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
        self._words = ""
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

    def show_lines(self, lines: list[Line], marks: tuple[tuple[float, str], ...] = (), square: bool = False) -> None:
        """Draw these curves and no others; square: zero in the middle of both axes."""
        self._clear()
        for line in lines:
            item = pg.PlotCurveItem(antialias=True)
            x, y = line.x, line.y
            if line.bars:
                x, y = (
                    np.repeat(line.x, 3),
                    np.column_stack((0.0 * line.y, line.y, np.full(line.y.size, np.nan))).ravel(),
                )
            item.setData(
                x, y, pen=self._theme.pen(line.colour, THIN, line.dash), connect="finite" if line.bars else "all"
            )
            self._view.addItem(item, ignoreBounds=True)
            self._drawn.append(item)
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
        upwards, step_y = ticks(bottom, top, max(2, int(height / LEAST_Y)))
        if not self._drawn:
            across, upwards = [], []
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
