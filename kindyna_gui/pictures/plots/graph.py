"""Curves of a graph over one x, on axes of their own on both sides; what is shown of them, and two points with their values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite
from types import MappingProxyType

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QAccessible, QPainterPath
from PySide6.QtWidgets import QGraphicsItem, QGraphicsSimpleTextItem, QWidget

from core.output.graph import ANGLES, DASHES, RIGHT, Graph, GraphAxis, GraphData, GraphPoint, Series, angle_marks
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.graph_ranges import Shown, bounded, evenly, is_outline, rungs, scaled, ticks_of, whole
from kindyna_gui.pictures.plots.lines import LEFT_WIDTH, Z_CURSOR, Z_CURVE, Entry, band_entry, band_items
from kindyna_gui.pictures.plots.plot import EDGE, RIGHT_MARGIN, TOP_MARGIN, Axis, FixedPlot
from kindyna_gui.pictures.style import (
    BLUE,
    DASHED,
    GREEN,
    ORANGE,
    PURPLE,
    SCREEN,
    SKY,
    TEXT,
    VERMILION,
    Theme,
    brush,
    font,
    shade,
)
from kindyna_gui.pictures.units import NOTHING_DRAWN, DisplayUnit, lines_words, with_unit
from kindyna_gui.settings import sized

SYMBOLS = {"circle": "o", "square": "s", "triangle": "t1", "cross": "x", "plus": "+"}
SIGNS = {"solid": "—", "dashed": "- -", "dotted": "···", "dash-dot": "-·-"}
MARK, POINT = 6.0, 7.0  # pixels
TITLE_HEIGHT = 20
RIGHT_WIDTH = 74  # of an axis on the right, pixels
DOT, MOST_ALONE = 3.0, 1000  # pixels of a value that has no neighbour, beyond the width of the line; so many at most
NARROW = 1000.0  # a curve that takes less than one part in so many of the width is drawn as it is
MOST_MARKS = 90  # points of a curve that are marked; of more, so many of them
NEAR = 24.0  # pixels from a curve at which a click is still meant for it
LETTERS = ("A", "B")
SHADES = 3  # of a quantity's colour that can be told from it and from each other
_OWN = (PURPLE, ORANGE, SKY, VERMILION, GREEN, BLUE)
"""Colours of curves of which nothing says what they are, one after the other."""
Bands = Mapping[int, tuple[np.ndarray, np.ndarray]]
"""Place of a curve -> x (n,) and percentiles (5, n), in its units."""
NO_CHANNEL_BANDS: Bands = MappingProxyType({})


class GraphPlot(FixedPlot):
    """A graph, drawn: nothing here reads a file or computes a channel.

    shown   the part that is shown; rungs: the unit in which each axis is read
    """

    def __init__(self, parent: QWidget | None = None, theme: Theme = SCREEN) -> None:
        self.graph, self.found = Graph(), GraphData((), (), "", "", {}, {}, {})
        self.rungs: tuple[DisplayUnit, ...] = ()
        self.shown = Shown((0.0, 1.0), ())
        self.points: tuple[GraphPoint, ...] = ()
        self.bands = NO_CHANNEL_BANDS
        self._items: list[pg.PlotDataItem] = []
        self._shades: list[tuple[pg.ViewBox, Outline]] = []
        self._further: list[tuple[Axis, pg.ViewBox]] = []
        self._slots: list[int] = []
        self._places: list[list[QGraphicsItem]] = []
        self._fitted_for: tuple[float, float] | None = None  # size at which an outline fills the plot
        self._thinned_for = 0.0  # pixels across
        super().__init__(parent, theme, centred=True)
        self._heading = QGraphicsSimpleTextItem(self._canvas)
        self._heading.setFont(font(TEXT + 1, bold=True))
        self._heading.setBrush(brush(theme.ink))
        self._lines = [self._outline(theme.quiet, Z_CURSOR, DASHED) for _ in LETTERS]
        self._angle = self._outline(theme.quiet, Z_CURSOR)
        self._at_angle: float | None = None
        self._rubber = self._outline(theme.quiet, Z_CURSOR + 1.0, DASHED)

    # -- what is drawn --------------------------------------------------------------------------------------

    @property
    def curves(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """x and y as drawn, of all curves."""
        return [item.getOriginalDataset() for item in self._items]

    @property
    def painted(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """The points of all curves that are painted at this size and range."""
        return [(x, y) for x, y in (item.getData() for item in self._items) if x is not None]

    @property
    def drawn_points(self) -> int:
        """How many they are."""
        return sum(len(x) for x, _ in self.painted)

    @property
    def titles(self) -> dict[str, str]:
        """Titles of the axes: ``bottom``, ``left``, and those on the right from inside out."""
        made = {"bottom": self._across()}
        for i, slot in enumerate(self._slots):
            made["left" if slot == 0 else f"right{slot}"] = self._upwards(i)
        return made

    def show_graph(
        self, graph: Graph, found: GraphData, keep: bool = False, message: str = "", bands: Bands = NO_CHANNEL_BANDS
    ) -> None:
        """Draw these curves; keep: the part that is shown stays, where the axes are the same; message: where there is none; bands: place
        of a curve -> its x and percentiles, between which machines lie, shaded."""
        same = (
            keep
            and [(a.side, a.unit) for a in found.axes] == [(a.side, a.unit) for a in self.found.axes]
            and bool(found.series)
        )
        sizes = rungs(found)
        same = same and sizes == self.rungs and _scales(graph) == _scales(self.graph)
        self.graph, self.found, self.rungs = graph, found, sizes
        for item in self._items:
            item.getViewBox().removeItem(item)
        for view, area in self._shades:
            view.removeItem(area)
        self.bands = bands
        self._slots = self._seats()
        for _, view in self._further:
            view.setGeometry(self._view.geometry())
        self._items = [self._drawn(i) for i in range(len(found.series))]
        self._shades = [each for number, band in bands.items() for each in self._shaded(number, *band)]
        self._message_text = "" if found.series else message
        names = [Entry(self.colour(i), each.name, self._sign(each)) for i, each in enumerate(found.series)]
        self._name([*names, *([band_entry(self._theme)] if bands else [])])
        self._heading.setText(graph.title)
        self._above = float(TOP_MARGIN + (sized(TITLE_HEIGHT) if graph.title else 0))
        self._canvas.layout.setContentsMargins(EDGE, self._above, RIGHT_MARGIN, EDGE)
        self._fit_legend()
        self.points = tuple(point for point in self.points if point.series < len(found.series))
        self._speak()
        if same:
            self.show_part(self.shown)
        else:
            self.fit()

    def _speak(self) -> None:
        """What is drawn, in words, where somebody hears them."""
        self.setAccessibleName(self.graph.title or "Graph")
        if QAccessible.isActive():
            rows = [
                lines_words([(each.name, each.x, each.y)], self._across(), self._upwards(self.axis_of(number)))
                for number, each in enumerate(self.found.series)
            ]
            self.setAccessibleDescription("; ".join(rows) or self._message_text or NOTHING_DRAWN)

    def _seats(self) -> list[int]:
        """For each axis of the graph its place: 0 on the left, from 1 on the right; those that have none are hidden."""
        made, right = [], 0
        for axis in self.found.axes:
            if axis.side == RIGHT or 0 in made:
                right += 1
                made.append(right)
            else:
                made.append(0)
        while len(self._further) < right:
            self._further.append(self._one_more())
        self._axes["left"].setVisible(not made or 0 in made)
        self._axes["left"].setWidth(sized(LEFT_WIDTH) if not made or 0 in made else 8)
        for number, (axis, _) in enumerate(self._further, 1):
            axis.setVisible(number in made)
            axis.setWidth(sized(RIGHT_WIDTH) if number in made else 0)
        return made

    def _one_more(self) -> tuple[Axis, pg.ViewBox]:
        """An axis further out on the right."""
        axis, view = Axis("right", self._theme), pg.ViewBox(enableMenu=False)
        view.setParentItem(self._canvas)  # once it is made: only then does it hear when it is to be painted
        view.setMouseEnabled(False, False)
        view.disableAutoRange()
        view.setDefaultPadding(0.0)
        view.setZValue(self._view.zValue() + 1.0)
        axis.linkToView(view)
        axis.setZValue(0.5)
        self._canvas.layout.addItem(axis, 2, 2 + len(self._further))
        return axis, view

    def view_of(self, axis: int) -> pg.ViewBox:
        """What the curves of an axis of the graph stand in."""
        slot = self._slots[axis]
        return self._view if slot == 0 else self._further[slot - 1][1]

    def axis_of(self, series: int) -> int:
        """The axis on which a curve stands."""
        return next(i for i, axis in enumerate(self.found.axes) if series in axis.series)

    def colour(self, series: int) -> str:
        """The row's own, else the drive's, else the quantity's, those of one quantity in band_items, of many in colours of their own."""
        each = self.found.series[series]
        row = self.graph.curve(each.key)
        if row is not None and row.colour:
            return self._theme.seen(row.colour)
        if each.part >= 0:
            return self._theme.drive(each.part)
        alike = [
            i for i, other in enumerate(self.found.series[:series]) if other.family == each.family and other.part < 0
        ]
        drives = {self._theme.drive(other.part) for other in self.found.series if other.part >= 0}
        if each.family and self._theme.family(each.family).lower() in drives:
            alike.append(-1)  # a drive has that colour
        if each.family and len(alike) <= SHADES:
            return self._theme.seen(shade(self._theme.family(each.family), len(alike)))
        return self._theme.seen(_OWN[(len(alike) - (SHADES + 1 if each.family else 0)) % len(_OWN)])

    def _sign(self, series: Series) -> str:
        row = self.graph.curve(series.key)
        return "—" if row is None else SIGNS[row.dash]

    def _drawn(self, number: int) -> pg.PlotDataItem:
        """pyqtgraph thins out what is finer than a pixel, keeping every peak, and leaves out what is out of sight."""
        series, axis = self.found.series[number], self.axis_of(number)
        row, scale = self.graph.curve(series.key), self.found.axes[axis].scale
        x, y = scaled(series.x, self.graph.x.log), scaled(series.y, scale.log, self.rungs[axis].size)
        if self.graph.x.log:
            x, y = x[np.isfinite(x)], y[np.isfinite(x)]
        whole_line = bool(np.isfinite(y).all())
        colour, width = self.colour(number), row.width if row else 1.0
        item = pg.PlotDataItem()
        self.view_of(axis).addItem(
            item, ignoreBounds=True
        )  # first: with data it would ask the widget around for its range
        item.setData(
            x,
            y,
            pen=self._theme.pen(colour, width, DASHES[row.dash] if row else ()),
            connect="all" if whole_line else "finite",
            skipFiniteCheck=whole_line,
            antialias=True,
            clipToView=series.is_ordered,
            downsampleMethod="peak",
        )
        item.setZValue(Z_CURVE + number)
        alone = np.flatnonzero(_alone(y)) if row is None or row.mark not in SYMBOLS else np.array([], dtype=int)
        if alone.size:  # no line leads to them
            alone = alone[:: max(1, -(-alone.size // MOST_ALONE))]
            dots = pg.ScatterPlotItem(
                x[alone], y[alone], symbol="o", size=DOT + width, pen=None, brush=colour, useCache=False
            )
            dots.setParentItem(item)
        if row is not None and row.mark in SYMBOLS:
            every = max(1, -(-x.size // MOST_MARKS))
            marks = pg.ScatterPlotItem(
                x[::every],
                y[::every],
                symbol=SYMBOLS[row.mark],
                size=MARK,
                pen=self._theme.pen(colour),
                brush=None,
                useCache=False,
            )
            marks.setParentItem(item)
        if row is not None and row.mark == ANGLES:
            others = [each.mark == ANGLES for each in self.graph.curves[: self.graph.number(row.key)]]
            self._mark_angles(item, series, axis, colour, inwards=sum(others) % 2 == 1)
        return item

    def _shaded(self, number: int, x: np.ndarray, band: np.ndarray) -> list[tuple[pg.ViewBox, Outline]]:
        """The areas behind a curve, each with what it stands in."""
        axis = self.axis_of(number)
        upwards = scaled(band, self.found.axes[axis].scale.log, self.rungs[axis].size)
        view = self.view_of(axis)
        made = [(view, item) for item in band_items(scaled(x, self.graph.x.log), upwards, self.colour(number))]
        for _, item in made:
            view.addItem(item, ignoreBounds=True)
        return made

    def _mark_angles(self, item: pg.PlotDataItem, series: Series, axis: int, colour: str, inwards: bool) -> None:
        """Dots along a curve, each with its angle beside it, on the side away from the curve's middle; of every second curve on the
        other one."""
        marks = angle_marks(series)
        x = scaled(np.array([x for x, *_ in marks]), self.graph.x.log)
        y = scaled(np.array([y for _, y, _ in marks]), self.found.axes[axis].scale.log, self.rungs[axis].size)
        dots = pg.ScatterPlotItem(
            x, y, symbol="o", size=MARK, pen=self._theme.pen(colour), brush=self._theme.paper, useCache=False
        )
        dots.setParentItem(item)
        middle = [0.5 * (float(np.nanmin(values)) + float(np.nanmax(values))) for values in (x, y)] if marks else []
        for place, (*_, text) in zip(zip(x.tolist(), y.tolist(), strict=True), marks, strict=True):
            if isfinite(place[0]) and isfinite(place[1]):
                right, above = (place[0] >= middle[0]) != inwards, (place[1] >= middle[1]) != inwards
                tag = Tag(
                    text, self._theme.letters(colour), self._theme, lean=(0.0 if right else 1.0, 1.0 if above else 0.0)
                )
                tag.shift(6.0 if right else -6.0, -3.0 if above else 3.0)
                tag.setPos(*place)
                tag.setParentItem(item)

    def show_angle(self, angle: float | None) -> None:
        """A line at this x [deg]; None: no line."""
        self._at_angle = angle
        path, frame = QPainterPath(), self.frame()
        if angle is not None and not self.graph.x.log:
            path.moveTo(angle, frame.low)
            path.lineTo(angle, frame.high)
        self._angle.redraw(path)

    # -- points ---------------------------------------------------------------------------------------------

    def show_points(self, points: Sequence[GraphPoint]) -> None:
        """Mark these, at most two, and no others."""
        self.points = tuple(points)
        self._lay()

    def _place_points(self) -> None:
        for items in self._places:
            for item in items:
                self.scene().removeItem(item)
        self._places = []
        frame = self.frame()
        for number, line in enumerate(self._lines):
            path = QPainterPath()
            if number < len(self.points):
                point = self.points[number]
                at = self.place(point)
                path.moveTo(at.x(), frame.low)
                path.lineTo(at.x(), frame.high)
                self._places.append(self._dot(point, at, LETTERS[number]))
            line.redraw(path)

    def _dot(self, point: GraphPoint, at: QPointF, letter: str) -> list[QGraphicsItem]:
        colour = self.colour(point.series)
        dot = pg.ScatterPlotItem(
            [at.x()], [at.y()], symbol="o", size=POINT, pen=self._theme.pen(self._theme.paper), brush=colour
        )
        tag = Tag(letter, self._theme.ink, self._theme, lean=(0.0, 1.0), backing=True)
        tag.shift(5.0, -4.0)
        tag.setPos(at)
        view = self.view_of(self.axis_of(point.series))
        for item, z in ((dot, Z_CURSOR + 2.0), (tag, Z_CURSOR + 3.0)):
            item.setZValue(z)
            view.addItem(item, ignoreBounds=True)
        return [dot, tag] if isfinite(at.y()) else [dot]

    def place(self, point: GraphPoint) -> QPointF:
        """A point as drawn, in the numbers of its axis."""
        axis = self.axis_of(point.series)
        x, y = (np.array([value]) for value in (point.x, point.y))
        shown = scaled(y, self.found.axes[axis].scale.log, self.rungs[axis].size)
        return QPointF(float(scaled(x, self.graph.x.log)[0]), float(shown[0]))

    def pixel_of(self, point: GraphPoint) -> QPointF:
        """Where it stands in the widget."""
        view = self.view_of(self.axis_of(point.series))
        return QPointF(self.mapFromScene(view.mapViewToScene(self.place(point))))

    def nearest(self, pixel: QPointF) -> GraphPoint | None:
        """The point of the nearest curve at a place of the widget; None where none is near."""
        scene = self.mapToScene(pixel.toPoint())
        best: tuple[float, GraphPoint] | None = None
        for number, series in enumerate(self.found.series):
            view = self.view_of(self.axis_of(number))
            at = view.mapSceneToView(scene)
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
                best = float(away[i]), self._taken(number, at.x(), (near.start or 0) + i)
        return best[1] if best is not None else None

    def _taken(self, number: int, x: float, i: int) -> GraphPoint:
        series = self.found.series[number]
        if not series.is_ordered:
            kept = series.x[series.x > 0.0] if self.graph.x.log else series.x
            other = series.y[series.x > 0.0] if self.graph.x.log else series.y
            return GraphPoint(number, float(kept[i]), float(other[i]))
        at = 10.0**x if self.graph.x.log else x
        at = min(max(at, float(series.x[0])), float(series.x[-1]))
        return GraphPoint(number, at, series.at(at))

    # -- what part of it ------------------------------------------------------------------------------------

    def all_of_it(self) -> Shown:
        """The whole graph, or what is typed for it; an outline undistorted."""
        with_bands = [
            replace(each, y=np.append(each.y, self.bands[i][1][[0, -1]])) if i in self.bands else each
            for i, each in enumerate(self.found.series)
        ]
        shown = whole(replace(self.found, series=tuple(with_bands)), self.graph.x, self.rungs)
        if not is_outline(self.found, self.graph.x):
            return shown
        frame = self.frame()
        return evenly(shown, self.found, self.rungs[0].size, frame.width, frame.height)

    def fit(self) -> None:
        """Show the whole graph; an outline at any size of the plot."""
        self.show_part(self.all_of_it())
        frame = self.frame()
        self._fitted_for = (frame.width, frame.height) if is_outline(self.found, self.graph.x) else None

    def show_part(self, shown: Shown) -> None:
        """Show this part of the axes."""
        shown = Shown(bounded(shown.x), tuple(bounded(ends) for ends in shown.values))
        self.shown, self._fitted_for = shown, None
        rows = zip(self._items, self.found.series, strict=True)
        thinned = [series.is_ordered and _is_wide(item.getOriginalDataset()[0], shown.x) for item, series in rows]
        self._thin_out(
            [each for each, on in zip(self._items, thinned, strict=True) if not on], False
        )  # before it is shown so wide
        first = shown.values[0] if shown.values else (0.0, 1.0)
        self._view.setRange(xRange=shown.x, yRange=first, padding=0.0)
        for i, ends in enumerate(shown.values):
            self.view_of(i).setRange(xRange=shown.x, yRange=ends, padding=0.0)
        self._thin_out([each for each, on in zip(self._items, thinned, strict=True) if on], True)
        self._lay()

    @staticmethod
    def _thin_out(items: Sequence[pg.PlotDataItem], on: bool) -> None:
        for item in items:
            item.setDownsampling(auto=on)

    def show_rubber(self, box: QRectF | None) -> None:
        """A rectangle in fractions of the plot from its lower left corner; None: none."""
        path, frame = QPainterPath(), self.frame()
        if box is not None:
            wide, high = frame.last - frame.first, frame.high - frame.low
            path.addRect(
                frame.first + box.x() * wide, frame.low + box.y() * high, box.width() * wide, box.height() * high
            )
        self._rubber.redraw(path)

    def fraction(self, pixel: QPointF) -> QPointF:
        """A place of the widget in fractions of the plot, from its lower left corner."""
        box, at = self._view.sceneBoundingRect(), self.mapToScene(pixel.toPoint())
        return QPointF((at.x() - box.left()) / max(box.width(), 1.0), (box.bottom() - at.y()) / max(box.height(), 1.0))

    # -- layout ---------------------------------------------------------------------------------------------

    def _across(self) -> str:
        return _titled(self.found.x_title, self.found.x_unit) if self.found.series else ""

    def _upwards(self, axis: int) -> str:
        return _titled(self.found.axes[axis].title, self.rungs[axis].symbol)

    def _lay(self, *_: object) -> None:
        if not hasattr(self, "_rubber"):  # still being made
            return
        frame, ink = self.frame(), self._theme.ink
        if self._fitted_for not in (None, (frame.width, frame.height)):
            self.fit()
            return
        there = bool(self.found.series)
        across = (
            ticks_of(self.shown.x, frame.width, self.graph.x.log, self.found.x_unit == "°", across=True)
            if there
            else []
        )
        ticks = [
            ticks_of(ends, frame.height, axis.scale.log)
            for axis, ends in zip(self.found.axes, self.shown.values, strict=True)
        ]
        self.draw_axes(frame, across, ticks[0] if ticks else [])
        self._axes["bottom"].show_title(self._across(), ink)
        self._axes["left"].show_title("", ink)
        for i, slot in enumerate(self._slots):
            axis = self._axes["left"] if slot == 0 else self._further[slot - 1][0]
            axis.show_ticks(ticks[i])
            colours = {self.colour(number) for number in self.found.axes[i].series}
            axis.show_title(
                self._upwards(i),
                self._theme.letters(colours.pop()) if len(colours) == 1 and len(self._slots) > 1 else ink,
            )
        for _, view in self._further:
            view.setGeometry(self._view.geometry())
        if frame.width != self._thinned_for:
            self._thinned_for = frame.width
            for item in self._items:
                item.viewRangeChanged()  # pyqtgraph thins out by the width, but does not look again where only that changes
        box = self._heading.boundingRect()
        self._heading.setPos(
            max(float(EDGE), self._view.geometry().center().x() - 0.5 * box.width()), float(TOP_MARGIN)
        )
        self._place_points()
        self.show_angle(self._at_angle)


def _is_wide(x: np.ndarray | None, ends: tuple[float, float]) -> bool:
    """Whether a curve is to be seen as more than an upright line, so that thinning it out leaves something of it."""
    return x is not None and len(x) > 1 and float(x[-1] - x[0]) * NARROW > ends[1] - ends[0]


def _alone(y: np.ndarray) -> np.ndarray:
    """Which values have no neighbour."""
    there = np.isfinite(y)
    beside = np.concatenate(([False], there, [False]))
    return there & ~beside[:-2] & ~beside[2:]


def _scales(graph: Graph) -> tuple[GraphAxis, ...]:
    """Its axes, whatever their titles."""
    return tuple(replace(scale, title="") for scale in (graph.x, graph.left, graph.right))


def _titled(title: str, unit: str) -> str:
    return f"{title}, {with_unit('', unit).strip()}" if unit and title else title or unit


__all__ = ["LETTERS", "GraphPlot"]
