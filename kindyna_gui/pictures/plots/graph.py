"""Plot of a graph: curves over one x, value axes on both sides, zoomed ranges, and two marked points.

Nothing here reads a file or computes a channel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QAccessible, QPainterPath
from PySide6.QtWidgets import QGraphicsItem, QGraphicsSimpleTextItem, QWidget

from core.output.drawing.palette import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from core.output.drawing.scales import DisplayUnit
from core.output.graph import ANGLES, DASHES, RIGHT, Graph, GraphAxis, GraphData, GraphPoint, Series, angle_marks
from core.units import conversion_factor
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.graph_ranges import (
    GraphRange,
    axis_units,
    bounded,
    full_range,
    is_outline,
    scaled,
    ticks_of,
)
from kindyna_gui.pictures.plots.library import pg
from kindyna_gui.pictures.plots.lines import (
    LEFT_WIDTH,
    Z_CURSOR,
    Z_CURVE,
    Z_REFERENCE,
    Entry,
    add_item,
    band_entry,
    band_items,
    reference_entry,
)
from kindyna_gui.pictures.plots.plot import EDGE, RIGHT_MARGIN, TOP_MARGIN, Axis, FixedPlot, with_one_scale
from kindyna_gui.pictures.style import DASHED, SCREEN, TEXT, Theme, brush, font, shade
from kindyna_gui.pictures.units import lines_words, with_unit
from kindyna_gui.settings import sized

SYMBOLS = {"circle": "o", "square": "s", "triangle": "t1", "cross": "x", "plus": "+"}
SIGNS = {"solid": "—", "dashed": "- -", "dotted": "···", "dash-dot": "-·-"}
MARK, POINT = 6.0, 7.0  # pixels
TITLE_HEIGHT = 20
RIGHT_WIDTH = 74  # of an axis on the right, pixels
DOT, MOST_ISOLATED = 3.0, 1000  # pixels of an isolated value, more than the line's width; number of such values drawn
NARROW = 1000.0  # a curve narrower than one part in so many of the width is drawn with all its points
MOST_MARKS = 90  # number of points of a curve that are marked
NEAR = 24.0  # greatest distance of a click from its curve, pixels
POINT_NAMES = ("A", "B")
SHADES = 3  # of a quantity's colour that can be distinguished
_OTHER_COLOURS = (PURPLE, ORANGE, SKY, VERMILION, GREEN, BLUE)
"""Colours in order, for curves whose quantity and drive are unknown."""
Bands = Mapping[int, tuple[np.ndarray, np.ndarray]]
"""Number of a curve -> x (n,) and percentiles (5, n) of its machines, in its units."""
Dashed = tuple[GraphData, str]
"""Curves of another design, by the keys of the curves, and its name."""
NO_CHANNEL_BANDS: Bands = MappingProxyType({})


class GraphPlot(FixedPlot):
    """Plot of a graph.

    Attributes
    ----------
    graph, data : the graph, and its curves with their axes
    display_units : display unit of each axis of values
    shown : range that is shown
    points : points that are marked, at most two
    bands : bands of the curves
    reference : curves of another design and its name; None: no other design
    references : number of a curve -> that of another design, drawn dashed
    """

    def __init__(self, parent: QWidget | None = None, theme: Theme = SCREEN) -> None:
        self.graph, self.data = Graph(), GraphData((), (), "", "", {}, {}, {})
        self.display_units: tuple[DisplayUnit, ...] = ()
        self.shown = GraphRange((0.0, 1.0), ())
        self.points: tuple[GraphPoint, ...] = ()
        self.bands = NO_CHANNEL_BANDS
        self._items: list[pg.PlotDataItem] = []
        self._areas: list[tuple[pg.ViewBox, Outline]] = []
        self.reference: Dashed | None = None
        self.references: dict[int, Series] = {}
        self._right_axes: list[tuple[Axis, pg.ViewBox]] = []
        self._slots: list[int] = []
        self._point_items: list[list[QGraphicsItem]] = []
        self._fitted_size: tuple[float, float] | None = None  # size at which an outline fills the plot
        self._thinned_width = 0.0  # pixels
        super().__init__(parent, theme, centred=True)
        self._heading = QGraphicsSimpleTextItem(self._canvas)
        self._heading.setFont(font(TEXT + 1, bold=True))
        self._heading.setBrush(brush(theme.ink))
        self._lines = [self._outline(theme.quiet, Z_CURSOR, DASHED) for _ in POINT_NAMES]
        self._angle_line = self._outline(theme.quiet, Z_CURSOR)
        self._angle: float | None = None
        self._rubber = self._outline(theme.quiet, Z_CURSOR + 1.0, DASHED)

    # -- curves ---------------------------------------------------------------------------------------------

    @property
    def curves(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Coordinates x and y of all curves."""
        return [item.getOriginalDataset() for item in self._items]

    @property
    def painted(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Points of all curves that are painted at this size and range."""
        return [(x, y) for x, y in (item.getData() for item in self._items) if x is not None]

    @property
    def titles(self) -> dict[str, str]:
        """Titles of the axes: ``bottom``, ``left``, and ``right1``, ``right2`` ... from inside out."""
        titles = {"bottom": self._across()}
        for i, slot in enumerate(self._slots):
            titles["left" if slot == 0 else f"right{slot}"] = self._upwards(i)
        return titles

    def show_graph(
        self,
        graph: Graph,
        data: GraphData,
        keep: bool = False,
        message: str = "",
        bands: Bands = NO_CHANNEL_BANDS,
        reference: Dashed | None = None,
    ) -> None:
        """Draw the curves of a graph.

        Parameters
        ----------
        graph : Graph
        data : GraphData
        keep : bool
            Keep the part that the user has chosen where the axes are the same.
        message : str
            Text in place of curves where there are none.
        bands : mapping of int to (x, percentiles)
            Number of a curve -> x (n,) and percentiles (5, n) of the machines, drawn as shaded bands.
        reference : GraphData and name, optional
            Curves of another design, drawn dashed, each in the colour and on the axis of the curve with its key.
        """
        same = (
            keep
            and self.can_go_back
            and [(a.side, a.unit) for a in data.axes] == [(a.side, a.unit) for a in self.data.axes]
            and bool(data.series)
        )
        units = axis_units(data)
        same = same and units == self.display_units and _scales(graph) == _scales(self.graph)
        self.graph, self.data, self.display_units = graph, data, units
        for item in self._items:
            item.getViewBox().removeItem(item)
        for view, area in self._areas:
            view.removeItem(area)
        self.bands, self.reference = bands, reference
        self._slots = self._assign_slots()
        for _, view in self._right_axes:
            view.setGeometry(self._view.geometry())
        self._items = [self._draw(i) for i in range(len(data.series))]
        self.references = {} if reference is None else self._matching(reference[0])
        self._areas = [self._draw_dashed(number, series) for number, series in self.references.items()]
        self._areas += [area for number, band in bands.items() for area in self._shade(number, *band)]
        self._message_text = "" if data.series else message
        names = [Entry(self.colour(i), series.name, self._sign(series)) for i, series in enumerate(data.series)]
        names += [reference_entry(reference[1], self._theme)] if reference is not None and self.references else []
        self._name([*names, *([band_entry(self._theme)] if bands else [])])
        self._heading.setText(graph.title)
        self._above = float(TOP_MARGIN + (sized(TITLE_HEIGHT) if graph.title else 0))
        self._canvas.layout.setContentsMargins(EDGE, self._above, RIGHT_MARGIN, EDGE)
        self._fit_legend()
        self.points = tuple(point for point in self.points if point.series < len(data.series))
        self._describe()
        before = self.shown
        if same:
            self.show_range(before)
        else:
            self.fit()
        if self.shown != before:
            self.range_replaced()

    @property
    def can_go_back(self) -> bool:
        """Whether the user has chosen the part that is shown; on paper never."""
        return False

    def range_replaced(self) -> None:
        """Act on another visible part, shown because the curves have changed; on paper nothing depends on it."""

    def _describe(self) -> None:
        """Set name and, where a screen reader is active, description."""
        self.setAccessibleName(self.graph.title or "Graph")
        if QAccessible.isActive():
            rows = [
                lines_words([(series.name, series.x, series.y)], self._across(), self._upwards(self.axis_of(number)))
                for number, series in enumerate(self.data.series)
            ]
            self.describe(self.accessibleName(), "; ".join(rows))

    def _assign_slots(self) -> list[int]:
        """Slot of each axis of the graph, 0 on the left, 1, 2 ... on the right; hides the other axes."""
        slots, right = [], 0
        for axis in self.data.axes:
            if axis.side == RIGHT or 0 in slots:
                right += 1
                slots.append(right)
            else:
                slots.append(0)
        while len(self._right_axes) < right:
            self._right_axes.append(self._new_right_axis())
        has_left = not slots or 0 in slots
        self._axes["left"].setVisible(has_left)
        self._axes["left"].setWidth(sized(LEFT_WIDTH) if has_left else 8)
        for number, (axis, _) in enumerate(self._right_axes, 1):
            axis.setVisible(number in slots)
            axis.setWidth(sized(RIGHT_WIDTH) if number in slots else 0)
        return slots

    def _new_right_axis(self) -> tuple[Axis, pg.ViewBox]:
        """Add an axis on the right, outside the others."""
        axis, view = Axis("right", self._theme), pg.ViewBox(enableMenu=False)
        view.setParentItem(self._canvas)  # after its construction, else it is not notified when it must be painted
        view.setMouseEnabled(False, False)
        view.disableAutoRange()
        view.setDefaultPadding(0.0)
        view.setZValue(self._view.zValue() + 1.0)
        axis.linkToView(view)
        axis.setZValue(0.5)
        self._canvas.layout.addItem(axis, 2, 2 + len(self._right_axes))
        return axis, view

    def view_of(self, axis: int) -> pg.ViewBox:
        """View box of the curves of an axis of the graph."""
        slot = self._slots[axis]
        return self._view if slot == 0 else self._right_axes[slot - 1][1]

    def axis_of(self, series: int) -> int:
        """Number of the axis of values of a curve."""
        return next(i for i, axis in enumerate(self.data.axes) if series in axis.series)

    def colour(self, number: int) -> str:
        """Colour of a curve: the one chosen for it, else its drive's, else its quantity's.

        Curves of one quantity have shades of its colour; further ones have the other colours in order.
        """
        series = self.data.series[number]
        row = self.graph.curve(series.key)
        if row is not None and row.colour:
            return self._theme.seen(row.colour)
        if series.part >= 0:
            return self._theme.drive(series.part)
        shade_number = sum(s.family == series.family and s.part < 0 for s in self.data.series[:number])
        drives = {self._theme.drive(s.part) for s in self.data.series if s.part >= 0}
        if series.family and self._theme.family(series.family).lower() in drives:
            shade_number += 1  # a drive has that colour
        if series.family and shade_number <= SHADES:
            return self._theme.seen(shade(self._theme.family(series.family), shade_number))
        other = shade_number - (SHADES + 1 if series.family else 0)
        return self._theme.seen(_OTHER_COLOURS[other % len(_OTHER_COLOURS)])

    def _sign(self, series: Series) -> str:
        row = self.graph.curve(series.key)
        return "—" if row is None else SIGNS[row.dash]

    def _draw(self, number: int) -> pg.PlotDataItem:
        """Draw a curve; pyqtgraph omits points finer than a pixel, except peaks, and points outside the range."""
        series, axis = self.data.series[number], self.axis_of(number)
        row, scale = self.graph.curve(series.key), self.data.axes[axis].scale
        x, y = scaled(series.x, self.graph.x.log), scaled(series.y, scale.log, self.display_units[axis].size)
        if self.graph.x.log:
            x, y = x[np.isfinite(x)], y[np.isfinite(x)]
        is_finite = bool(np.isfinite(y).all())
        colour, width = self.colour(number), row.width if row else 1.0
        item = pg.PlotDataItem()
        self.view_of(axis).addItem(item, ignoreBounds=True)  # before its data, else it requests a range
        item.setData(
            x,
            y,
            pen=self._theme.pen(colour, width, DASHES[row.dash] if row else ()),
            connect="all" if is_finite else "finite",
            skipFiniteCheck=is_finite,
            antialias=True,
            clipToView=series.is_ordered,
            downsampleMethod="peak",
        )
        item.setZValue(Z_CURVE + number)
        isolated = np.flatnonzero(_is_isolated(y)) if row is None or row.mark not in SYMBOLS else np.array([], int)
        if isolated.size:  # no line connects them
            isolated = isolated[:: max(1, -(-isolated.size // MOST_ISOLATED))]
            _put_dots(item, x[isolated], y[isolated], symbol="o", size=DOT + width, pen=None, brush=colour)
        if row is not None and row.mark in SYMBOLS:
            every = max(1, -(-x.size // MOST_MARKS))
            style = {"symbol": SYMBOLS[row.mark], "size": MARK, "pen": self._theme.pen(colour), "brush": None}
            _put_dots(item, x[::every], y[::every], **style)
        if row is not None and row.mark == ANGLES:
            previous = sum(curve.mark == ANGLES for curve in self.graph.curves[: self.graph.number(row.key)])
            self._mark_angles(item, series, axis, colour, inwards=previous % 2 == 1)
        return item

    def _matching(self, data: GraphData) -> dict[int, Series]:
        """Number of a curve -> the curve of another design with its key, drive and unit."""
        others = {(row.key, row.part, row.x_unit, row.y_unit): row for row in data.series}
        pairs = ((i, others.get((row.key, row.part, row.x_unit, row.y_unit))) for i, row in enumerate(self.data.series))
        return {number: row for number, row in pairs if row is not None}

    def _draw_dashed(self, number: int, series: Series) -> tuple[pg.ViewBox, Outline]:
        """Draw a curve of another design next to the one with this number; returns it with its view box."""
        axis = self.axis_of(number)
        y = scaled(series.y, self.data.axes[axis].scale.log, self.display_units[axis].size)
        line = pg.arrayToQPath(scaled(series.x, self.graph.x.log), y, "finite")
        item, view = Outline(line, self._theme.pen(self.colour(number), 1.0, DASHED)), self.view_of(axis)
        view.addItem(item, ignoreBounds=True)
        item.setZValue(Z_REFERENCE)
        return view, item

    def _shade(self, number: int, x: np.ndarray, band: np.ndarray) -> list[tuple[pg.ViewBox, Outline]]:
        """Shade the areas of a curve's band; returns each with its view box."""
        axis = self.axis_of(number)
        upwards = scaled(band, self.data.axes[axis].scale.log, self.display_units[axis].size)
        view = self.view_of(axis)
        areas = [(view, item) for item in band_items(scaled(x, self.graph.x.log), upwards, self.colour(number))]
        for _, item in areas:
            view.addItem(item, ignoreBounds=True)
        return areas

    def _mark_angles(self, item: pg.PlotDataItem, series: Series, axis: int, colour: str, inwards: bool) -> None:
        """Mark angles along a curve by dots, with texts on the outer side, or on the inner side where ``inwards``."""
        marks = angle_marks(series)
        x = scaled(np.array([x for x, *_ in marks]), self.graph.x.log)
        y = scaled(np.array([y for _, y, _ in marks]), self.data.axes[axis].scale.log, self.display_units[axis].size)
        _put_dots(item, x, y, symbol="o", size=MARK, pen=self._theme.pen(colour), brush=self._theme.paper)
        middle = [0.5 * (float(np.nanmin(values)) + float(np.nanmax(values))) for values in (x, y)] if marks else []
        for point, (*_, text) in zip(zip(x.tolist(), y.tolist(), strict=True), marks, strict=True):
            if isfinite(point[0]) and isfinite(point[1]):
                right, above = (point[0] >= middle[0]) != inwards, (point[1] >= middle[1]) != inwards
                tag = Tag(
                    text,
                    self._theme.text_colour(colour),
                    self._theme,
                    lean=(0.0 if right else 1.0, 1.0 if above else 0.0),
                )
                tag.shift(6.0 if right else -6.0, -3.0 if above else 3.0)
                tag.setPos(*point)
                tag.setParentItem(item)

    def show_angle(self, angle: float | None) -> None:
        """Draw a line at this x [deg], or none."""
        self._angle = angle
        has_line = angle is not None and not self.graph.x.log
        self._angle_line.redraw(self.frame().vertical(angle or 0.0) if has_line else QPainterPath())

    # -- marked points --------------------------------------------------------------------------------------

    def show_points(self, points: Sequence[GraphPoint]) -> None:
        """Mark these points, at most two, and no others."""
        self.points = tuple(points)
        self._lay()

    def _draw_points(self) -> None:
        for items in self._point_items:
            for item in items:
                self.scene().removeItem(item)
        self._point_items = []
        frame = self.frame()
        for number, line in enumerate(self._lines):
            path = QPainterPath()
            if number < len(self.points):
                point = self.points[number]
                at = self.position(point)
                path = frame.vertical(at.x())
                self._point_items.append(self._dot(point, at, POINT_NAMES[number]))
            line.redraw(path)

    def _dot(self, point: GraphPoint, at: QPointF, name: str) -> list[QGraphicsItem]:
        colour = self.colour(point.series)
        dot = pg.ScatterPlotItem(
            [at.x()], [at.y()], symbol="o", size=POINT, pen=self._theme.pen(self._theme.paper), brush=colour
        )
        tag = Tag(name, self._theme.ink, self._theme, lean=(0.0, 1.0), backing=True)
        tag.shift(5.0, -4.0)
        tag.setPos(at)
        view = self.view_of(self.axis_of(point.series))
        add_item(view, dot, Z_CURSOR + 2.0)
        add_item(view, tag, Z_CURSOR + 3.0)
        return [dot, tag] if isfinite(at.y()) else [dot]

    def position(self, point: GraphPoint) -> QPointF:
        """Coordinates of a point on its axes."""
        axis = self.axis_of(point.series)
        x, y = (np.array([value]) for value in (point.x, point.y))
        shown = scaled(y, self.data.axes[axis].scale.log, self.display_units[axis].size)
        return QPointF(float(scaled(x, self.graph.x.log)[0]), float(shown[0]))

    def pixel_of(self, point: GraphPoint) -> QPointF:
        """Pixel of a point in the widget."""
        return self.to_pixel(self.position(point), self.view_of(self.axis_of(point.series)))

    def nearest(self, pixel: QPointF) -> GraphPoint | None:
        """Point of the nearest curve at a pixel of the widget; None where no curve is near."""
        best: tuple[float, GraphPoint] | None = None
        for number, series in enumerate(self.data.series):
            view = self.view_of(self.axis_of(number))
            at = self.to_axes(pixel, view)
            across, upwards = view.viewPixelSize()
            x, y = self._items[number].getOriginalDataset()
            if x is None or not len(x) or not (across and upwards):  # without a curve, or without an extent
                continue
            near = slice(None)
            if series.is_ordered:
                ends = np.searchsorted(x, (at.x() - NEAR * across, at.x() + NEAR * across))
                near = slice(max(int(ends[0]) - 1, 0), int(ends[1]) + 1)
            away = np.hypot((x[near] - at.x()) / across, (y[near] - at.y()) / upwards)
            if series.is_ordered:
                away = np.append(away, abs(float(np.interp(at.x(), x, y, np.nan, np.nan)) - at.y()) / upwards)
            if not np.isfinite(away).any():
                continue
            i = int(np.nanargmin(away))
            if away[i] <= NEAR and (best is None or away[i] < best[0]):
                best = float(away[i]), self._point(number, at.x(), (near.start or 0) + i)
        return best[1] if best is not None else None

    def _point(self, number: int, x: float, i: int) -> GraphPoint:
        """Point of a curve at coordinate x, or its point i where its x is not ordered."""
        series = self.data.series[number]
        if not series.is_ordered:
            drawn = series.x > 0.0 if self.graph.x.log else slice(None)
            return GraphPoint(number, float(series.x[drawn][i]), float(series.y[drawn][i]))
        at = 10.0**x if self.graph.x.log else x
        at = min(max(at, float(series.x[0])), float(series.x[-1]))
        return GraphPoint(number, at, series.at(at))

    # -- range that is shown --------------------------------------------------------------------------------

    def full_range(self) -> GraphRange:
        """Range of the full graph, or the typed one; with one scale for an outline."""
        ends = {number: band[[0, -1]] for number, (_, band) in self.bands.items()}
        drawn = []
        for i, series in enumerate(self.data.series):
            rows = [series, self.references[i]] if i in self.references else [series]
            across, values = (np.concatenate([getattr(row, axis) for row in rows]) for axis in "xy")
            drawn.append(replace(series, x=across, y=np.append(values, ends.get(i, ()))))
        shown = full_range(replace(self.data, series=tuple(drawn)), self.graph.x, self.display_units)
        if not is_outline(self.data, self.graph.x):
            return shown
        unit = self.display_units[0].size * conversion_factor(self.data.axes[0].unit, self.data.x_unit)
        x, y = with_one_scale(shown.x, shown.values[0], self.frame(), unit)
        return GraphRange(x, (y,))

    def fit(self) -> None:
        """Show the full graph; an outline is fitted again when the plot's size changes."""
        self.show_range(self.full_range())
        frame = self.frame()
        self._fitted_size = (frame.width, frame.height) if is_outline(self.data, self.graph.x) else None

    def show_range(self, shown: GraphRange) -> None:
        """Show these ranges of the axes."""
        shown = GraphRange(bounded(shown.x), tuple(bounded(ends) for ends in shown.values))
        self.shown, self._fitted_size = shown, None
        thinned = {
            item: series.is_ordered and _is_wide(item.getOriginalDataset()[0], shown.x)
            for item, series in zip(self._items, self.data.series, strict=True)
        }
        for item in self._items:
            if not thinned[item]:  # before the range widens
                item.setDownsampling(auto=False)
        first = shown.values[0] if shown.values else (0.0, 1.0)
        self._view.setRange(xRange=shown.x, yRange=first, padding=0.0)
        for i, ends in enumerate(shown.values):
            self.view_of(i).setRange(xRange=shown.x, yRange=ends, padding=0.0)
        for item in self._items:
            if thinned[item]:
                item.setDownsampling(auto=True)
        self._lay()

    def show_rubber(self, box: QRectF | None) -> None:
        """Show a rectangle, in fractions of the plot from its lower left corner, or none."""
        path, frame = QPainterPath(), self.frame()
        if box is not None:
            width, height = frame.last - frame.first, frame.high - frame.low
            x, y = frame.first + box.x() * width, frame.low + box.y() * height
            path.addRect(x, y, box.width() * width, box.height() * height)
        self._rubber.redraw(path)

    def fraction(self, pixel: QPointF) -> QPointF:
        """Position of a pixel of the widget in fractions of the plot, from its lower left corner."""
        box, at = self._view.sceneBoundingRect(), self.mapToScene(pixel.toPoint())
        return QPointF((at.x() - box.left()) / max(box.width(), 1.0), (box.bottom() - at.y()) / max(box.height(), 1.0))

    # -- layout ---------------------------------------------------------------------------------------------

    def _across(self) -> str:
        return _titled(self.data.x_title, self.data.x_unit) if self.data.series else ""

    def _upwards(self, axis: int) -> str:
        return _titled(self.data.axes[axis].title, self.display_units[axis].symbol)

    def _lay(self, *_: object) -> None:
        if not hasattr(self, "_rubber"):  # under construction
            return
        frame, ink = self.frame(), self._theme.ink
        if self._fitted_size not in (None, (frame.width, frame.height)):
            self.fit()
            return
        across = (
            ticks_of(self.shown.x, frame.width, self.graph.x.log, self.data.x_unit == "°", across=True)
            if self.data.series
            else []
        )
        ticks = [
            ticks_of(ends, frame.height, axis.scale.log)
            for axis, ends in zip(self.data.axes, self.shown.values, strict=True)
        ]
        self.draw_axes(frame, across, ticks[0] if ticks else [])
        self._axes["bottom"].show_title(self._across(), ink)
        self._axes["left"].show_title("", ink)
        for i, slot in enumerate(self._slots):
            axis = self._axes["left"] if slot == 0 else self._right_axes[slot - 1][0]
            axis.show_ticks(ticks[i])
            colours = {self.colour(number) for number in self.data.axes[i].series}
            axis.show_title(
                self._upwards(i),
                self._theme.text_colour(colours.pop()) if len(colours) == 1 and len(self._slots) > 1 else ink,
            )
        for _, view in self._right_axes:
            view.setGeometry(self._view.geometry())
        if frame.width != self._thinned_width:
            self._thinned_width = frame.width
            for item in self._items:
                item.viewRangeChanged()  # pyqtgraph thins out by the width, but ignores a change of the width alone
        box = self._heading.boundingRect()
        self._heading.setPos(
            max(float(EDGE), self._view.geometry().center().x() - 0.5 * box.width()), float(TOP_MARGIN)
        )
        self._draw_points()
        self.show_angle(self._angle)


def _put_dots(item: pg.PlotDataItem, x: np.ndarray, y: np.ndarray, **style: Any) -> None:
    """Draw dots of one style, pyqtgraph's keywords, with a curve."""
    pg.ScatterPlotItem(x, y, useCache=False, **style).setParentItem(item)


def _is_wide(x: np.ndarray | None, ends: tuple[float, float]) -> bool:
    """Whether a curve is wider than a vertical line in this range, so that it can be thinned out."""
    return x is not None and len(x) > 1 and float(x[-1] - x[0]) * NARROW > ends[1] - ends[0]


def _is_isolated(y: np.ndarray) -> np.ndarray:
    """Values (n,) of bool that have no neighbour."""
    finite = np.isfinite(y)
    padded = np.concatenate(([False], finite, [False]))
    return finite & ~padded[:-2] & ~padded[2:]


def _scales(graph: Graph) -> tuple[GraphAxis, ...]:
    """Axes of a graph without their titles."""
    return tuple(replace(scale, title="") for scale in (graph.x, graph.left, graph.right))


def _titled(title: str, unit: str) -> str:
    return f"{title}, {with_unit('', unit).strip()}" if unit and title else title or unit


__all__ = ["POINT_NAMES", "GraphPlot"]
