"""Small plots of one quantity over another, with axes and a legend of their own: histories, phase planes, spectra."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyqtgraph as pg
from PySide6.QtGui import QPainterPath
from PySide6.QtWidgets import QWidget

from core.frozen import frozen
from kindyna_gui.pictures.items import Outline, Tag, text_size
from kindyna_gui.pictures.plots.background import LEAST_ACROSS, TOP_HEIGHT, angle_ticks, value_ticks
from kindyna_gui.pictures.plots.fixed_plot import FixedPlot
from kindyna_gui.pictures.plots.legend import Entry
from kindyna_gui.pictures.style import (
    BLUE,
    DASHED,
    FAMILIES,
    GREEN,
    LIGHT,
    ORANGE,
    PURPLE,
    TEXT,
    THIN,
    VERMILION,
    Theme,
)

if TYPE_CHECKING:
    from core.plot import Curve
    from core.stability import Plot

FREE = 0.06  # of the range, left free around the curves
FOR_MARKS = 0.06  # of it, and so much more above them where upright lines have texts
WHOLE_TURN = (0.0, 360.0)  # an axis of cam angles
ROWS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE)
"""Colours of the curves of a plot, one after the other."""


@frozen(eq=False)
class Line:
    """One curve: x and y (n,), nan where it is broken, its colour, its name in the legend, dashes."""

    x: np.ndarray
    y: np.ndarray
    colour: str
    label: str = ""
    dash: tuple[float, ...] = ()


class XYPlot(FixedPlot):
    """Curves with axes of their own; ``marks``: upright lines with a text, such as where the follower leaves the cam."""

    def __init__(self, across: str, upwards: str, parent: QWidget | None = None, theme: Theme = LIGHT) -> None:
        super().__init__(parent, theme, centred=True)
        self.setAntialiasing(True)
        self._titles = (across, upwards)
        self._drawn: list[pg.PlotCurveItem] = []
        self._marks: list[tuple[Outline, Tag, float]] = []
        self._alike = False
        self._wanted = ((0.0, 1.0), (0.0, 1.0))
        self.show_message("")

    # -- what is drawn --------------------------------------------------------------------------------------

    @property
    def lines(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """x and y of the curves that are drawn."""
        return [(item.xData, item.yData) for item in self._drawn]

    @property
    def message(self) -> str:
        return self._message_text

    def show_lines(
        self,
        lines: list[Line],
        marks: tuple[tuple[float, str], ...] = (),
        square: bool = False,
        note: str = "",
        alike: bool = False,
        fit: bool = False,
        quiet: bool = False,
    ) -> None:
        """Draw these curves and no others; square: zero in the middle of both axes; note: for the legend; alike: one unit is as long
        on both axes; fit: zero need not be on the y axis;
        quiet: the marks are places, not warnings."""
        self._clear()
        for line in lines:
            item = pg.PlotCurveItem(antialias=True)
            broken = not np.isfinite(line.y).all()
            pen = self._theme.pen(line.colour, THIN, line.dash)
            item.setData(line.x, line.y, pen=pen, connect="finite" if broken else "all")
            self._include(item)
            self._drawn.append(item)
        self._name([Entry(line.colour, line.label) for line in lines if line.label], note)
        x, y = (np.concatenate(part) for part in zip(*((line.x, line.y) for line in lines), strict=True))
        self._alike = alike
        if alike:
            fit = True
        ranges = [self._range(x, square, tight=not square and not alike, fit=fit), self._range(y, square, fit=fit)]
        if marks and not square and not alike:  # their texts stand above the curves
            low, high = ranges[1]
            ranges[1] = (low, high + FOR_MARKS * (high - low))
        self._wanted = (ranges[0], ranges[1])
        self._view.setRange(xRange=ranges[0], yRange=ranges[1], padding=0.0)
        for at, text in marks:
            colour = self._theme.quiet if quiet else self._theme.limit
            line = self._outline(colour, 5.0, DASHED)
            tag = Tag(text, colour, self._theme, lean=(0.0, 0.0), backing=True)
            self._include(tag, 20.0)
            self._marks.append((line, tag, at))
        self._message_text = ""
        self._lay()

    def fit_height(self, low: float, high: float) -> None:
        """Show values from low to high, of curves that reach beyond only these."""
        self._view.setRange(yRange=(low, high), padding=0.0)
        self._lay()

    def name_axes(self, across: str, upwards: str) -> None:
        """The titles of the axes of what is shown next."""
        self._titles = across, upwards

    def _colour(self, curve: Curve, alone: bool) -> str:
        """That of its quantity; of none that of its row, ink where there is only one."""
        if curve.family:
            return FAMILIES[curve.family]
        return self._theme.ink if alone else ROWS[curve.row % len(ROWS)]

    def show_plot(self, plot: Plot) -> None:
        """Draw a plot of the core: a quantity in its colour, else one curve in ink, of several each row of them in its colour."""
        self.name_axes(plot.across, plot.upwards)
        alone = len({curve.row for curve in plot.curves}) == 1
        self.show_lines(
            [
                Line(
                    curve.x,
                    curve.y,
                    self._colour(curve, alone),
                    curve.label,
                    DASHED if curve.dashed else (),
                )
                for curve in plot.curves
            ],
            plot.marks,
            note=plot.note,
            alike=plot.alike,
            fit=plot.fit,
            quiet=plot.quiet,
        )

    @staticmethod
    def _range(values: np.ndarray, square: bool, tight: bool = False, fit: bool = False) -> tuple[float, float]:
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        if square:
            half = max(abs(low), abs(high)) or 1.0
            low, high = -half, half
        elif not tight and not fit:
            low, high = min(low, 0.0), max(high, 0.0)
        if high - low <= 1e-12 * max(abs(low), abs(high), 1e-300):
            high = low + 1.0
        free = 0.0 if tight else FREE * (high - low)
        return low - free, high + free

    def show_message(self, text: str) -> None:
        """Nothing but a text: what is missing, or what would fill this plot."""
        self._clear()
        self._name([])
        self._message_text = text
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

    def _one_scale(self) -> None:
        """The ranges wanted, the narrower of the two widened until a unit is as long on both axes."""
        (left, right), (low, high) = self._wanted
        width, height = max(self._view.width(), 1.0), max(self._view.height(), 1.0)
        unit = max((right - left) / width, (high - low) / height)
        x, y = 0.5 * (left + right), 0.5 * (low + high)
        across, upwards = 0.5 * unit * width, 0.5 * unit * height
        self._view.setRange(xRange=(x - across, x + across), yRange=(y - upwards, y + upwards), padding=0.0)

    def _lay(self, *_: object) -> None:
        if self._alike and self._drawn:
            self._one_scale()
        frame = self.frame()
        low, high = frame.first, frame.last
        whole = (low, high) == WHOLE_TURN
        across = angle_ticks(frame.width) if whole else value_ticks(low, high, frame.width, LEAST_ACROSS)
        upwards = value_ticks(frame.low, frame.high, frame.height)
        self._rule(frame, *((across, upwards) if self._drawn else ((), ())))
        self._axes["bottom"].show_title(self._titles[0] if self._drawn else "", self._theme.ink)
        self._axes["left"].show_title(_fitting(self._titles[1], frame.height) if self._drawn else "", self._theme.ink)
        for line, tag, at in self._marks:
            path = QPainterPath()
            path.moveTo(at, frame.low)
            path.lineTo(at, frame.high)
            line.redraw(path)
            right = (high - at) / (high - low) * frame.width > tag.size[0] + 10.0
            tag.set_lean(0.0 if right else 1.0, 0.0)
            tag.shift(4.0 if right else -4.0, 2.0)
            tag.setPos(at, frame.high)


def _fitting(title: str, height: float) -> str:
    """The title of an axis upwards, its unit alone where it is longer than the axis with what is free above it."""
    return title if text_size(title, TEXT)[0] <= height + TOP_HEIGHT else title.rpartition(", ")[2]


__all__ = ["Line", "XYPlot"]
