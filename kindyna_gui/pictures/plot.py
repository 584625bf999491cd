"""Curves over one turn of the cam: ``CurvePlot``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from math import degrees, pi

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from core.channels import Channel
from core.study import Study
from kindyna_gui.pictures.items import Tag, text_size, wrapped
from kindyna_gui.pictures.limits import limit_of
from kindyna_gui.pictures.plot_parts import (
    BOTTOM_HEIGHT,
    LEFT_WIDTH,
    TOP_HEIGHT,
    Z_CURSOR,
    Z_CURVE,
    Z_REFERENCE,
    Axis,
    Frame,
    LimitLine,
    Paper,
    Readout,
    Span,
    angle_ticks,
    name_ticks,
    place_readouts,
    spans,
    value_ticks,
)
from kindyna_gui.pictures.ranges import peak, shown_range
from kindyna_gui.pictures.style import DASHED, LIGHT, SMALL, TEXT, THIN, Theme, shade
from kindyna_gui.pictures.units import Rung, legible, readable, short, with_unit

LEGEND_HEIGHT, RIGHT_MARGIN = 18, 16  # pixels
WILD = 50.0  # values next to infinity are cut at so many times the rest's range


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve: its channel, its values in the channel's unit (n,), its colour."""

    channel: Channel
    values: np.ndarray
    colour: str


class CurvePlot(pg.PlotWidget):
    """One or several channels of one unit against the cam angle, 0 ... 360 deg, with a movable cursor.

    names, angles   whether the segments' names stand along the top, and the cam angle's numbers along the bottom:
                    of plots one below the other only the first and the last show them
    angle_moved     the user has drawn the cursor to this cam angle [rad]
    """

    angle_moved = Signal(float)

    def __init__(
        self, parent: QWidget | None = None, *, names: bool = True, angles: bool = True, theme: Theme = LIGHT
    ) -> None:
        self._theme = theme
        axes = {side: Axis(side, theme, line=side != "top") for side in ("left", "bottom", "top")}
        super().__init__(parent, background=theme.paper, axisItems=axes)
        self.setCacheMode(self.CacheModeFlag.CacheNone)  # kept paper would stand in an SVG as pixels
        self._axes = axes
        plot = self.getPlotItem()
        self._view: pg.ViewBox = plot.getViewBox()
        plot.hideButtons()
        plot.setMenuEnabled(False)
        plot.layout.setContentsMargins(2, 2, RIGHT_MARGIN, 2)
        self._view.setMouseEnabled(False, False)
        self._view.disableAutoRange()
        self._view.setDefaultPadding(0.0)
        self._view.setRange(xRange=(0.0, 360.0), yRange=(0.0, 1.0), padding=0.0)
        plot.showAxis("top")
        axes["left"].setWidth(LEFT_WIDTH)
        axes["bottom"].setHeight(BOTTOM_HEIGHT if angles else 6)
        axes["top"].setHeight(TOP_HEIGHT if names else 4)
        axes["bottom"].setStyle(showValues=angles)
        axes["top"].setStyle(showValues=names)
        if angles:
            axes["bottom"].show_title("Cam angle, °", theme.ink)
        self._paper = Paper(self._view, theme)
        self._cursor = pg.InfiniteLine(0.0, 90.0, theme.pen(theme.quiet), movable=True, bounds=(0.0, 360.0))
        self._cursor.setHoverPen(theme.pen(theme.limit))
        self._cursor.setZValue(Z_CURSOR)
        self._cursor.sigDragged.connect(self._dragged)
        self._view.addItem(self._cursor, ignoreBounds=True)
        self._message = Tag("", theme.quiet, theme, TEXT)
        self._view.addItem(self._message, ignoreBounds=True)
        self._words = ""
        self._angle, self._with_cursor, self._named = 0.0, True, names
        self._spans: list[Span] = []
        self._curves: list[Curve] = []
        self._there: list[float] | None = None
        self._readings: list[Readout] = []
        self._limits: list[LimitLine] = []
        self._drawn: list[pg.PlotCurveItem] = []
        self.rung = Rung("", 1.0, 0.0)
        self._view.sigResized.connect(self._lay)
        self.show_message("")

    # -- what is drawn --------------------------------------------------------------------------------------

    def set_curves(self, study: Study, channels: Sequence[Channel], reference: Study | None = None) -> None:
        """Draw these channels of the study; reference: a second study, dashed. Raises NoAnswer where one has none."""
        curves = self._read(study, channels)
        others = [] if reference is None else self._read(reference, channels)
        self._clear()
        self._words = ""
        self._curves, self._spans = curves, spans(study.design.drive.motion)
        self._angles = np.append(np.rad2deg(study.theta), 360.0)
        self.rung = readable(curves[0].channel.unit.symbol, peak([curve.values for curve in curves + others]))
        limits = [(row, limit_of(study, row.quantity)) for row in channels]
        alone = len(channels) == 1
        told = [
            (limit.value / row.unit.factor / self.rung.size, limit.words if alone else f"{row.label}: {limit.words}")
            for row, limit in limits
            if limit
        ]
        families = {row.family for row in channels}
        rows = [curve.values / self.rung.size for curve in curves + others]
        low, high = shown_range(rows, families, [value for value, _ in told])
        for curve in others:
            theta = np.append(np.rad2deg(reference.theta), 360.0) if reference is not None else self._angles
            self._draw(theta, curve, Z_REFERENCE, low, high, DASHED)
        for curve in curves:
            self._draw(self._angles, curve, Z_CURVE, low, high)
            self._readings.append(Readout(self._view, self._theme, curve.colour))
        for value, words in told:
            if low <= value <= high:
                text = words.format(with_unit(short(value, 4), self.rung.symbol))
                self._limits.append(LimitLine(self._view, self._theme, value, text))
        self._legend(reference is not None)
        self._view.setRange(yRange=(low, high), padding=0.0)
        self._lay()

    def show_message(self, text: str) -> None:
        """Nothing but a text in the middle: what is missing, or what would fill this plot."""
        self._clear()
        self._spans = []
        self._legend(False)
        self._axes["left"].show_title("", self._theme.ink)
        self._words = text
        self._view.setRange(yRange=(0.0, 1.0), padding=0.0)
        self._message.setPos(180.0, 0.5)
        self._lay()

    def _read(self, study: Study, channels: Sequence[Channel]) -> list[Curve]:
        seen: dict[str, int] = {}
        curves = []
        for row in channels:
            nth = seen[row.family] = seen.get(row.family, -1) + 1
            curves.append(Curve(row, row.values(study), shade(self._theme.family(row.family), nth)))
        return curves

    def _draw(
        self, theta: np.ndarray, curve: Curve, z: float, low: float, high: float, dash: tuple[float, ...] = ()
    ) -> None:
        values = np.append(curve.values, curve.values[:1]) / self.rung.size
        whole = bool(np.isfinite(values).all())
        if not whole:
            room = WILD * (high - low)
            values = np.where(np.isfinite(values), np.clip(values, low - room, high + room), np.nan)
        item = pg.PlotCurveItem()
        item.setData(
            theta,
            values,
            pen=self._theme.pen(curve.colour, THIN, dash),
            connect="all" if whole else "finite",
            skipFiniteCheck=whole,
            antialias=True,
        )
        item.setZValue(z)
        self._view.addItem(item, ignoreBounds=True)
        self._drawn.append(item)

    def _clear(self) -> None:
        for item in self._drawn:
            self._view.removeItem(item)
        for reading in self._readings:
            reading.remove(self._view)
        for limit in self._limits:
            limit.remove(self._view)
        self._drawn, self._readings, self._limits, self._curves, self._there = [], [], [], [], None

    def _legend(self, reference: bool) -> None:
        """Names of the curves above the plot, where there is more than one to tell apart."""
        plot, rows = self.getPlotItem(), []
        if len(self._curves) > 1 or reference:
            rows = [(curve.colour, "—", curve.channel.label) for curve in self._curves]
            rows += [(self._theme.quiet, "– –", "reference")] if reference else []
        told = "&nbsp;&nbsp; ".join(f'<span style="color:{c}">{mark}</span> {escape(name)}' for c, mark, name in rows)
        plot.setTitle(told or None, size=f"{SMALL}px", color=self._theme.ink, justify="left")
        if told:
            plot.titleLabel.setMaximumHeight(LEGEND_HEIGHT)
            plot.layout.setRowFixedHeight(0, LEGEND_HEIGHT)

    # -- cursor ---------------------------------------------------------------------------------------------

    @property
    def angle(self) -> float:
        """Cam angle of the cursor [rad]."""
        return self._angle

    def set_angle(self, theta: float, there: Study | None = None) -> None:
        """Move the cursor to cam angle theta [rad].

        there: the same study at this one angle, for exact readings; else they are those of the nearest sample.
        """
        self._angle = theta
        self._there = None if there is None else [float(curve.channel.values(there)[0]) for curve in self._curves]
        self._cursor.setValue(degrees(theta))
        self._write()

    def show_cursor(self, shown: bool) -> None:
        """Pictures on paper have no cursor."""
        self._with_cursor = shown
        self._write()

    def readings(self) -> list[str]:
        """The texts beside the cursor, in the order of the curves."""
        return [reading.tag.text for reading in self._readings]

    def _dragged(self) -> None:
        self._angle, self._there = float(self._cursor.value()) * pi / 180.0, None
        self._write()
        self.angle_moved.emit(self._angle)

    def _write(self) -> None:
        self._cursor.setVisible(self._with_cursor and bool(self._curves))
        if not self._with_cursor:
            for reading in self._readings:
                reading.hide()
        elif self._readings:
            samples = self._angles.size - 1
            at = round(self._angle / (2.0 * pi) * samples) % samples
            known = self._there or [float(curve.values[at]) for curve in self._curves]
            values = [value / self.rung.size for value in known]
            place_readouts(self._readings, degrees(self._angle), values, self.rung, self.frame())

    # -- layout ---------------------------------------------------------------------------------------------

    def frame(self) -> Frame:
        """What is shown at which size."""
        low, high = self._view.viewRange()[1]
        return Frame(low, high, max(self._view.width(), 1.0), max(self._view.height(), 1.0))

    def _lay(self, *_: object) -> None:
        frame = self.frame()
        angles = angle_ticks(frame.width)
        values = value_ticks(frame.low, frame.high, frame.height) if self._curves else []
        self._paper.draw(self._spans, [a for a, _ in angles], [v for v, _ in values], frame.low, frame.high)
        self._axes["bottom"].show_ticks(angles)
        self._axes["left"].show_ticks(values)
        self._message.set_text(wrapped(self._words, frame.width - 16.0, TEXT))
        self._axes["top"].show_ticks(name_ticks(self._spans, frame.width) if self._named else [])
        for limit in self._limits:
            limit.lay(frame.low, frame.high, frame.height)
        if self._curves:
            self._axes["left"].show_title(self._title(frame.height), self._title_colour())
        self._write()

    def _title(self, height: float) -> str:
        """Quantity and unit, as short as the axis needs."""
        row, unit = self._curves[0].channel, self.rung.symbol
        families = {curve.channel.family for curve in self._curves}
        shared = (row.family.replace("-", " ").capitalize(),) if len(families) == 1 else ()
        names = (row.label, legible(row.symbol)) if len(self._curves) == 1 else shared
        for name in names:
            text = f"{name}, {unit}" if unit else name
            if text_size(text, TEXT)[0] <= height + TOP_HEIGHT:
                return text
        return unit

    def _title_colour(self) -> str:
        return self._theme.letters(self._curves[0].colour) if len(self._curves) == 1 else self._theme.ink
