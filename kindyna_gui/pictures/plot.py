"""Curves over one turn of the cam: ``CurvePlot``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from math import degrees
from typing import Any

import numpy as np
import pyqtgraph as pg
from PySide6.QtGui import QPen
from PySide6.QtWidgets import QWidget

from core.channels import Channel
from core.design import motion_of
from core.study import Study
from kindyna_gui.pictures.items import Tag, text_size, wrapped
from kindyna_gui.pictures.plot_curves import Curve, drawn_alike, limits_of, read_curves
from kindyna_gui.pictures.plot_frame import Frame
from kindyna_gui.pictures.plot_lines import Cursor, CurveLine, LimitLine
from kindyna_gui.pictures.plot_parts import (
    BOTTOM_HEIGHT,
    LEFT_WIDTH,
    TOP_HEIGHT,
    Z_CURVE,
    Z_REFERENCE,
    Axis,
    Paper,
    Span,
    angle_ticks,
    name_ticks,
    spans,
    value_ticks,
)
from kindyna_gui.pictures.ranges import room_for, usual_range
from kindyna_gui.pictures.readouts import Readout, place_readouts
from kindyna_gui.pictures.style import DASHED, LIGHT, SMALL, TEXT, THIN, Theme
from kindyna_gui.pictures.turn import Line, line_of, nearest
from kindyna_gui.pictures.units import Rung, legible, readable, short, with_unit

LEGEND_HEIGHT, RIGHT_MARGIN = 18, 16  # pixels
WILD = 50.0  # values next to infinity are cut at so many times the rest's range


class CurvePlot(pg.PlotWidget):
    """One or several channels of one unit against the cam angle, 0 ... 360 deg, with a cursor.

    names, angles   whether the segments' names stand along the top, and the cam angle's numbers along the bottom:
                    of plots one below the other only the first and the last show them
    unseen          pixels by which a curve may be off where that saves points; on paper none
    """

    unseen = 0.0

    def __init__(
        self, parent: QWidget | None = None, *, names: bool = True, angles: bool = True, theme: Theme = LIGHT
    ) -> None:
        self._theme = theme
        axes = {side: Axis(side, theme, line=side != "top") for side in ("left", "bottom", "top")}
        super().__init__(parent, background=theme.paper, axisItems=axes, enableMenu=False)
        self.setCacheMode(self.CacheModeFlag.CacheNone)  # kept paper would stand in an SVG as pixels
        self._axes = axes
        plot = self.getPlotItem()
        self._view: pg.ViewBox = plot.getViewBox()
        plot.hideButtons()
        plot.layout.setContentsMargins(2, 2, RIGHT_MARGIN, 2)
        self._view.setMouseEnabled(False, False)
        self._view.disableAutoRange()
        self._view.setDefaultPadding(0.0)
        self._view.setRange(xRange=(0.0, 360.0), yRange=(0.0, 1.0), padding=0.0)
        plot.showAxis("top")
        plot.getAxis("right").unlinkFromView()  # never shown, it would still be laid out at each change
        axes["left"].setWidth(LEFT_WIDTH)
        axes["bottom"].setHeight(BOTTOM_HEIGHT if angles else 6)
        axes["top"].setHeight(TOP_HEIGHT if names else 4)
        axes["bottom"].setStyle(showValues=angles)
        axes["top"].setStyle(showValues=names)
        if angles:
            axes["bottom"].show_title("Cam angle, °", theme.ink)
        self._with_angles = angles
        self._paper = Paper(self._view, theme)
        self._cursor = Cursor(self._view, theme)
        self._message = Tag("", theme.quiet, theme, TEXT)
        self._view.addItem(self._message, ignoreBounds=True)
        self._words = ""
        self._angle, self._with_cursor, self._named = 0.0, True, names
        self._spans: list[Span] = []
        self._line: Line | None = None
        self._theta = np.zeros(0)
        self._curves: list[Curve] = []
        self._there: list[float] | None = None
        self._readings: list[Readout] = []
        self._limits: list[LimitLine] = []
        self._drawn: list[CurveLine] = []
        self._told: tuple[object, ...] = ()
        self._named_curves = ""
        self._laid: tuple[object, ...] = ()
        self.rung = Rung("", 1.0, 0.0)
        self._view.sigResized.connect(self._lay)
        self.show_message("")

    def keep_axes(self) -> None:
        """For a screen: axes are kept as pixels, so that the cursor moves over them without their being drawn anew."""
        for axis in self._axes.values():
            axis.setCacheMode(axis.CacheMode.DeviceCoordinateCache)
            axis.label.setCacheMode(axis.CacheMode.DeviceCoordinateCache)

    # -- what is drawn --------------------------------------------------------------------------------------

    def set_curves(
        self, study: Study, channels: Sequence[Channel], reference: Study | None = None, read: bool = True
    ) -> None:
        """Draw these channels of the study; reference: a second study, dashed. Raises NoAnswer where one has none.

        Where all would be drawn as it is nothing is touched, and so nothing painted. read: False where ``set_angle``
        follows at once, so that no value is written twice.
        """
        curves = read_curves(study, channels, self._theme)
        others = [] if reference is None else read_curves(reference, channels, self._theme)
        segments, limits = spans(motion_of(study.design)), limits_of(study, channels)
        told = (tuple(segments), tuple(limits))
        line = line_of(study)
        if not others and told == self._told and line.alike(self._line) and drawn_alike(curves, self._curves):
            return
        self._told = told if not others else ()
        self._curves, self._spans, self._words, self._there = curves, segments, "", None
        self._line, self._theta = line, study.theta
        self._name_angle(study)
        sides = [usual_range(curve.values) for curve in curves + others]
        self.rung = readable(curves[0].channel.unit.symbol, max(abs(side) for pair in sides for side in pair))
        size = self.rung.size
        low, high = room_for(
            [(low / size, high / size) for low, high in sides],
            {row.family for row in channels},
            [value / size for value, _, _ in limits],
        )
        self._view.setRange(yRange=(low, high), padding=0.0)
        rows = [(curve, line, Z_CURVE, ()) for curve in curves]
        if reference is not None:
            other = line_of(reference)
            rows += [(curve, other, Z_REFERENCE, DASHED) for curve in others]
        self._drawn = self._grown(self._drawn, len(rows), lambda: CurveLine(self._view))
        for item, (curve, along, z, dash) in zip(self._drawn, rows, strict=True):
            self._draw(item, curve, along, z, self._theme.pen(curve.colour, THIN, dash))
        self._readings = self._grown(self._readings, len(curves), lambda: Readout(self._view, self._theme))
        for reading, curve in zip(self._readings, curves, strict=True):
            reading.set_colour(curve.colour)
        shown = [(value / size, *words) for value, *words in limits if low <= value / size <= high]
        self._limits = self._grown(self._limits, len(shown), lambda: LimitLine(self._view, self._theme))
        for line, (value, words, brief) in zip(self._limits, shown, strict=True):
            line.tell(value, words.format(with_unit(short(value, 4), self.rung.symbol)), brief)
        self._legend(reference is not None)
        self._lay_out()
        if read:
            self._write()

    def _name_angle(self, study: Study) -> None:
        if self._with_angles:
            self._axes["bottom"].show_title(f"{study.angle_name.capitalize()}, °", self._theme.ink)

    def show_message(self, text: str) -> None:
        """Nothing but a text in the middle: what is missing, or what would fill this plot."""
        for pool in (self._drawn, self._readings, self._limits):
            self._grown(pool, 0, _nothing)
        self._drawn, self._readings, self._limits = [], [], []
        self._curves, self._spans, self._told, self._there = [], [], (), None
        self._legend(False)
        self._axes["left"].show_title("", self._theme.ink)
        self._words = text
        self._view.setRange(yRange=(0.0, 1.0), padding=0.0)
        self._message.setPos(180.0, 0.5)
        self._lay()

    def _draw(self, item: CurveLine, curve: Curve, along: Line, z: float, pen: QPen) -> None:
        values = along.of(curve.values) / self.rung.size
        finite = np.isfinite(values)
        if not finite.all():
            low, high = self._view.viewRange()[1]
            room = WILD * (high - low)
            values = np.where(finite, np.clip(values, low - room, high + room), np.nan)
        item.show_points(along.angles, values, pen, z)

    def _grown(self, pool: list[Any], count: int, make: Callable[[], Any]) -> list[Any]:
        """So many items, those that there are first."""
        for item in pool[count:]:
            if isinstance(item, CurveLine):
                self._view.removeItem(item)
            else:
                item.remove(self._view)
        return pool[:count] + [make() for _ in range(count - len(pool))]

    def _legend(self, reference: bool) -> None:
        """Names of the curves above the plot, where there is more than one to tell apart."""
        plot, rows = self.getPlotItem(), []
        if len(self._curves) > 1 or reference:
            rows = [(curve.colour, "—", curve.channel.label) for curve in self._curves]
            rows += [(self._theme.quiet, "– –", "reference")] if reference else []
        told = "&nbsp;&nbsp; ".join(f'<span style="color:{c}">{mark}</span> {escape(name)}' for c, mark, name in rows)
        if told == self._named_curves:
            return
        self._named_curves = told
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
        self._cursor.setPos(degrees(theta), 0.0)
        self._write()

    def show_cursor(self, shown: bool) -> None:
        """Pictures on paper have no cursor."""
        self._with_cursor = shown
        self._write()

    def readings(self) -> list[str]:
        """The texts beside the cursor, in the order of the curves."""
        return [reading.tag.text for reading in self._readings]

    def _write(self) -> None:
        self._cursor.setVisible(self._with_cursor and bool(self._curves))
        if not self._with_cursor:
            for reading in self._readings:
                reading.hide()
        elif self._readings:
            at = nearest(self._theta, self._angle)
            known = self._there or [float(curve.values[at]) for curve in self._curves]
            values = [
                0.0 if abs(value) <= curve.floor else value / self.rung.size
                for value, curve in zip(known, self._curves, strict=True)
            ]
            place_readouts(self._readings, degrees(self._angle), values, self.rung, self.frame(), self._limits)

    # -- layout ---------------------------------------------------------------------------------------------

    def frame(self) -> Frame:
        """What is shown at which size."""
        low, high = self._view.viewRange()[1]
        return Frame(low, high, max(self._view.width(), 1.0), max(self._view.height(), 1.0))

    def _lay(self, *_: object) -> None:
        self._lay_out()
        self._write()

    def _lay_out(self) -> None:
        frame = self.frame()
        unseen = self.unseen / self.devicePixelRatioF()
        for curve in self._drawn:
            curve.lay(frame, unseen)
        for limit in self._limits:
            limit.lay_clear(frame, self._drawn)
        if self._curves:
            self._axes["left"].show_title(self._title(frame.height), self._title_colour())
        paper = (frame, tuple(self._spans), bool(self._curves), self._words)
        if paper != self._laid:
            self._laid = paper
            self._lay_paper(frame)
        self.scene().prepareForPaint()  # else the transformation follows in the paint event and asks for another

    def _lay_paper(self, frame: Frame) -> None:
        angles = angle_ticks(frame.width)
        values = value_ticks(frame.low, frame.high, frame.height) if self._curves else []
        self._paper.draw(self._spans, [a for a, _ in angles], [v for v, _ in values], frame.low, frame.high)
        self._cursor.span(frame.low, frame.high)
        self._axes["bottom"].show_ticks(angles)
        self._axes["left"].show_ticks(values)
        self._message.set_text(wrapped(self._words, frame.width - 16.0, TEXT))
        self._axes["top"].show_ticks(self._names(frame.width) if self._named else [])

    def _names(self, width: float) -> list[tuple[float, str]]:
        """What stands along the top: places [deg] and names of segments."""
        return name_ticks(self._spans, width)

    def _title(self, height: float) -> str:
        """Quantity and unit, as short as the axis needs."""
        row, unit = self._curves[0].channel, self.rung.symbol
        families = {curve.channel.family for curve in self._curves}
        family = "Transmission angle" if row.quantity.startswith("transmission.") else row.family.replace("-", " ").capitalize()
        shared = (family,) if len(families) == 1 else ()
        names = (row.label, legible(row.symbol)) if len(self._curves) == 1 else shared
        for name in names:
            text = f"{name}, {unit}" if unit else name
            if text_size(text, TEXT)[0] <= height + TOP_HEIGHT:
                return text
        return unit

    def _title_colour(self) -> str:
        return self._theme.letters(self._curves[0].colour) if len(self._curves) == 1 else self._theme.ink


def _nothing() -> None:
    """Makes none."""


__all__ = ["Curve", "CurvePlot"]
