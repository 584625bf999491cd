"""Base of all plots: axes with given ticks, background, layout with legend and message, and the range of an axis.

No plot zooms, pans or searches its own range; a view decides what is shown.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from math import ceil
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QBrush, QPainter, QPainterPath, QPen, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QFrame, QGraphicsGridLayout, QGraphicsItem, QSizePolicy, QWidget

from core.frozen import frozen
from core.output.drawing.scales import decimals_of, ticks
from core.plot import Span
from kindyna_gui.pictures.items import Outline, Tag, text_size, wrapped
from kindyna_gui.pictures.plots.library import pg
from kindyna_gui.pictures.plots.lines import (
    BOTTOM_HEIGHT,
    LEFT_WIDTH,
    TOP_HEIGHT,
    Z_BANDS,
    Z_GRID,
    Z_ZERO,
    Entry,
    Frame,
    Legend,
    add_item,
)
from kindyna_gui.pictures.style import SCREEN, SMALL, TEXT, THIN, Theme, brush, font
from kindyna_gui.pictures.units import NOTHING_DRAWN, number
from kindyna_gui.settings import sized

ANGLE_STEPS = (30, 60, 90, 180)  # between ticks of the cam angle, deg
LEAST_ANGLE_PIXELS, LEAST_VALUE_PIXELS, LEAST_ACROSS = 38.0, 26.0, 46.0  # between ticks; of numbers along the bottom
NAME_ROOM = 4.0  # between a segment's name and its ends, pixels
EDGE, RIGHT_MARGIN = 2, 16  # around the axes, pixels
TOP_MARGIN = 6  # above a plot that has no axis at the top
BARE, NUMBERS = 6, 20  # heights of an axis without numbers, and with numbers alone
LEAST = QSize(160, 80)  # between the axes, at which curves can be read [pixels]
LOW = 150  # pixels of height without the legend, below which a plot has no room for the name of its angle
DEGREES = ", °"  # end of such a name
LEGEND_SHARE = 0.25  # of the height, for more than two lines of names
MESSAGE_EDGE = 16.0  # left free on both sides of a message
Ticks = Sequence[tuple[float, str]]
Ends = tuple[float, float]

# -- axis with given ticks -------------------------------------------------------------------------------

_MEASURING_BOX = QRectF(0.0, 0.0, 100.0, 100.0)
TITLE_OFFSET = 9.0  # of the title of an axis on the right, pixels inwards
_TEXT_HEIGHT = 0.8  # of the measured height: what the glyphs fill
Line = tuple[QPen, QPointF, QPointF]
Flags = Qt.AlignmentFlag | Qt.TextFlag
Text = tuple[QRectF, Flags, str]


class Axis(pg.AxisItem):
    """Axis with given ticks, in the theme's quiet colour.

    Attributes
    ----------
    shown : values and texts of the ticks
    """

    def __init__(self, orientation: str, theme: Theme, line: bool = True) -> None:
        super().__init__(orientation, pen=theme.pen(theme.quiet), textPen=theme.pen(theme.ink), maxTickLength=-4)
        self._title = ("", "")
        self.shown: list[tuple[float, str]] = []
        self._sizes: dict[str, tuple[float, float]] = {}
        self.setTicks([[]])
        self.enableAutoSIPrefix(False)
        self.setStyle(tickFont=font(SMALL), autoExpandTextSpace=False, hideOverlappingLabels=False, tickTextOffset=4)
        if not line:
            self.setStyle(tickLength=0, tickTextOffset=1)
            self.setPen(theme.pen(theme.faint))
            hidden = theme.pen(theme.faint)
            hidden.setCapStyle(Qt.PenCapStyle.FlatCap)  # a tick without length leaves no dot
            self.setTickPen(hidden)
            self.setTextPen(theme.pen(theme.quiet))

    def update_font(self) -> None:
        """Use the font size that is set now."""
        if self.style["tickFont"] == font(SMALL):
            return
        self._sizes = {}
        self.setStyle(tickFont=font(SMALL))
        self.redraw_title(str)

    def show_ticks(self, rows: Sequence[tuple[float, str]]) -> None:
        """Show ticks at these values with these texts, and no others."""
        if list(rows) != self.shown:  # pyqtgraph would draw the axis again
            self.shown = list(rows)
            self.setTicks([self.shown])

    def show_title(self, text: str, colour: str) -> None:
        """Show the axis' title, centred, which setLabel alone does not do."""
        style = {"color": colour, "font-size": f"{round(sized(TEXT))}px"}
        if (text, colour) != self._title:
            self._title = (text, colour)
            self.setLabel(re.sub(r"_(\w+)", r"<sub>\1</sub>", escape(text)), **style)
            self.resizeEvent()
            _forget(self.label)

    def redraw_title(self, colour: Callable[[str], str]) -> None:
        """Draw the title again in the current font size; ``colour`` maps its colour before to the new one."""
        text, before = self._title
        if text:
            self._title = ("", "")
            self.show_title(text, colour(before))

    def resizeEvent(self, event: object = None) -> None:
        """Keep the title on the right inside the axis, where pyqtgraph would let it hang over the end."""
        super().resizeEvent(event)
        _forget(self)
        if self.orientation == "right" and getattr(self, "label", None) is not None:
            self.label.moveBy(-sized(TITLE_OFFSET), 0.0)

    # -- drawing --------------------------------------------------------------------------------------------

    def generateDrawSpecs(self, painter: QPainter) -> tuple[Line, list[Line], list[Text]]:
        """Axis, ticks and texts in pyqtgraph's layout, without its search for tick values."""
        side, bounds, visible = _SIDES[self.orientation], self.mapRectFromParent(self.geometry()), self.boundingRect()
        low, high = self.range
        pixels = side.length(bounds) / ((high - low) or 1.0)
        ticks_shown = [
            (side.at(bounds, (value - low) * pixels), text) for value, text in self.shown if low <= value <= high
        ]
        pen, reach = self.tickPen(), side.outwards * self.style["tickLength"]
        ticks = [(pen, point, point + reach) for point, _ in ticks_shown]
        texts: list[Text] = []
        if self.style["showValues"]:
            painter.setFont(self.style["tickFont"])
            self._sizes = {text: self._sizes.get(text) or _size(painter, text) for _, text in ticks_shown}
            away = side.outwards * (max(0.0, self.style["tickLength"]) + self.style["tickTextOffset"][side.across])
            boxes = ((side.box(point + away, *self._sizes[text]), text) for point, text in ticks_shown)
            texts = [(box, side.flags, text) for box, text in boxes if visible & box == box]
        return (self.pen(), *side.line(bounds)), ticks, texts

    def wheelEvent(self, event: object) -> None:
        """Leave the wheel to the surrounding view."""

    def mouseDragEvent(self, event: object) -> None:
        """Leave dragging to the surrounding view."""


def _forget(item: QGraphicsItem) -> None:
    """Drop an item's cached pixels: where its size changes Qt would paint the new part only."""
    mode = item.cacheMode()
    item.setCacheMode(item.CacheMode.NoCache)
    item.setCacheMode(mode)


def _size(painter: QPainter, text: str) -> tuple[float, float]:
    box = painter.boundingRect(_MEASURING_BOX, Qt.AlignmentFlag.AlignCenter, text)
    return box.width(), _TEXT_HEIGHT * box.height()


@frozen
class _Side:
    """Geometry of an axis on one side of the plot.

    Attributes
    ----------
    outwards : unit vector away from the plot
    across : 0 where values increase upwards, 1 where they increase to the right
    length : length of an axis that fills a rectangle
    line : its two ends
    at : point at a distance along it [pixels]
    box : box of a text of a given width and height next to that point
    flags : alignment of the text in its box
    """

    outwards: QPointF
    across: int
    length: Callable[[QRectF], float]
    line: Callable[[QRectF], tuple[QPointF, QPointF]]
    at: Callable[[QRectF, float], QPointF]
    box: Callable[[QPointF, float, float], QRectF]
    flags: Flags


_Align, _WHOLE = Qt.AlignmentFlag, Qt.TextFlag.TextDontClip
_SIDES: Mapping[str, _Side] = MappingProxyType(
    {
        "left": _Side(
            QPointF(-1.0, 0.0), 0, QRectF.height,
            lambda r: (r.topRight() + QPointF(-1.0, -1.0), r.bottomRight() + QPointF(-1.0, 1.0)),
            lambda r, along: QPointF(r.right(), r.height() - along),
            lambda at, width, height: QRectF(at.x() - width, at.y() - height / 2.0, width, height),
            _Align.AlignRight | _Align.AlignVCenter | _WHOLE,
        ),
        "right": _Side(
            QPointF(1.0, 0.0), 0, QRectF.height,
            lambda r: (r.topLeft() + QPointF(1.0, -1.0), r.bottomLeft() + QPointF(1.0, 1.0)),
            lambda r, along: QPointF(r.left(), r.height() - along),
            lambda at, width, height: QRectF(at.x(), at.y() - height / 2.0, width, height),
            _Align.AlignLeft | _Align.AlignVCenter | _WHOLE,
        ),
        "bottom": _Side(
            QPointF(0.0, 1.0), 1, QRectF.width,
            lambda r: (r.topLeft() + QPointF(-1.0, 1.0), r.topRight() + QPointF(1.0, 1.0)),
            lambda r, along: QPointF(along, r.top()),
            lambda at, width, height: QRectF(at.x() - width / 2.0, at.y(), width, height),
            _Align.AlignHCenter | _Align.AlignTop | _WHOLE,
        ),
        "top": _Side(
            QPointF(0.0, -1.0), 1, QRectF.width,
            lambda r: (r.bottomLeft() + QPointF(-1.0, -1.0), r.bottomRight() + QPointF(1.0, -1.0)),
            lambda r, along: QPointF(along, r.bottom()),
            lambda at, width, height: QRectF(at.x() - width / 2.0, at.y() - height, width, height),
            _Align.AlignHCenter | _Align.AlignBottom | _WHOLE,
        ),
    }
)  # fmt: skip


# -- segments, ticks and background ----------------------------------------------------------------------


def angle_step(width: float) -> int:
    """Degrees between the ticks of one turn over a width [pixels]."""
    return next((s for s in ANGLE_STEPS if width * s / 360.0 >= sized(LEAST_ANGLE_PIXELS)), ANGLE_STEPS[-1])


def angle_ticks(width: float) -> list[tuple[float, str]]:
    """Ticks of one turn, angle [deg] and text, as many as the width [pixels] has room for."""
    return [(float(d), str(d)) for d in range(0, 361, angle_step(width))]


def cycle_ticks(low: float, high: float, width: float) -> list[tuple[float, str]]:
    """Ticks at multiples of 90, 180 or 360 degrees over several turns, as many as the width [pixels] has room for."""
    step = next((step for step in (90, 180) if (high - low) / step * sized(LEAST_ACROSS) <= width), 360)
    return [(float(d), number(d, 0)) for d in range(round(low), round(high) + 1, step)]


def value_ticks(low: float, high: float, pixels: float, least: float = LEAST_VALUE_PIXELS) -> list[tuple[float, str]]:
    """Ticks at round numbers, at least ``least`` pixels from each other where two have room."""
    values, step = ticks(low, high, max(2, int(pixels / sized(least))))
    return [(value, number(value, decimals_of(step))) for value in values]


def name_ticks(segments: Sequence[Span], width: float) -> list[tuple[float, str]]:
    """Names of the segments at their middles [deg]: the short name in a narrow segment, none in a narrower one."""
    rows = []
    for span in segments:
        room = (span.end - span.start) / 360.0 * width
        fitting = (name for name in (span.name, span.short) if name and text_size(name)[0] + NAME_ROOM <= room)
        rows += [((span.start + span.end) / 2.0, name) for name in [next(fitting, "")] if name]
    return rows


class Background:
    """Grid, zero line and shaded segments, each one static item of the view box."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        self._bands = Outline(QPainterPath(), None, brush(theme.band))
        self._grid = Outline(QPainterPath(), theme.pen(theme.faint, THIN))
        self._zero = Outline(QPainterPath(), theme.pen(theme.quiet, THIN))
        self._zero.setOpacity(0.6)
        for item, z in ((self._bands, Z_BANDS), (self._grid, Z_GRID), (self._zero, Z_ZERO)):
            add_item(view, item, z)

    def draw(self, segments: Sequence[Span], across: Sequence[float], values: Sequence[float], frame: Frame) -> None:
        """Shade every second segment; draw grid lines at the given places and values of the frame."""
        low, high = frame.low, frame.high
        bands, grid, zero = QPainterPath(), QPainterPath(), QPainterPath()
        for span in segments[1::2]:
            bands.addRect(QRectF(span.start, low, span.end - span.start, high - low))
        for x in across:
            grid.moveTo(x, low)
            grid.lineTo(x, high)
        for value in values:
            path = zero if value == 0.0 and frame.low < 0.0 else grid  # at the edge the axis itself is drawn
            path.moveTo(frame.first, value)
            path.lineTo(frame.last, value)
        for item, path in ((self._bands, bands), (self._grid, grid), (self._zero, zero)):
            item.redraw(path)


# -- base of the plots -----------------------------------------------------------------------------------

_AXIS_CELLS = {"top": (1, 1), "bottom": (3, 1), "left": (2, 0)}
"""Row and column of each axis, in the order of drawing; row 0 has the legend."""


class PlotCanvas(pg.GraphicsWidget):
    """Axes around the view box, and room above for the legend.

    It does what ``pg.PlotItem`` does, without the menus that take most of that one's time.
    """

    def __init__(self, axes: Mapping[str, Axis]) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.layout = QGraphicsGridLayout(self)
        self.layout.setSpacing(0.0)
        self.view = pg.ViewBox(parent=self, enableMenu=False)
        self.layout.addItem(self.view, 2, 1)
        for side in (side for side in _AXIS_CELLS if side in axes):
            axis = axes[side]
            axis.linkToView(self.view)
            axis.setZValue(0.5)  # above filled areas, below the texts over them
            axis.setFlag(QGraphicsItem.GraphicsItemFlag.ItemNegativeZStacksBehindParent)
            self.layout.addItem(axis, *_AXIS_CELLS[side])
        self.layout.setRowStretchFactor(2, 100)
        self.layout.setColumnStretchFactor(1, 100)


class FixedPlot(pg.GraphicsView):
    """Plot without zoom, pan, automatic range or menu; the wheel is left to the surrounding view.

    Parameters
    ----------
    top : whether there is an axis above, for names
    centred : whether the legend is centred above the plot, else at its left end

    Attributes
    ----------
    corner : pixels of the upper right corner that something else covers; the legend leaves them free
    legend : names of the curves above the plot
    """

    def __init__(
        self, parent: QWidget | None = None, theme: Theme = SCREEN, *, top: bool = False, centred: bool = False
    ) -> None:
        sides = ("left", "bottom", "top") if top else ("left", "bottom")
        axes = {side: Axis(side, theme, line=side != "top") for side in sides}
        super().__init__(parent, background=theme.paper)
        self._canvas = canvas = PlotCanvas(axes)
        self.setCentralItem(canvas)
        self.setCacheMode(self.CacheModeFlag.CacheNone)  # a cached background would be pixels in an SVG
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._theme, self._axes, self.corner = theme, axes, 0.0
        self._view = canvas.view
        self._above = float(EDGE if top else TOP_MARGIN)
        canvas.layout.setContentsMargins(EDGE, self._above, RIGHT_MARGIN, EDGE)
        self._view.setMouseEnabled(False, False)
        self._view.disableAutoRange()
        self._view.setDefaultPadding(0.0)
        self._view.setRange(xRange=(0.0, 360.0), yRange=(0.0, 1.0), padding=0.0)
        self._numbered_below, self._title_below, self._low = True, "", False
        self._below: tuple[bool, str, bool] | None = None
        self._size_axes()
        self._background = Background(self._view, theme)
        self.legend = Legend(canvas, theme.ink, centred)
        self._listed: dict[str, Entry] = {}  # texts of lines that have no room at this size, and are in the legend
        self._listed_size: tuple[object, ...] = ()
        self._message = Tag("", theme.quiet, theme, TEXT)
        self._include(self._message)
        self._message_text = ""
        self._view.sigResized.connect(self._lay)

    def _include(self, item: QGraphicsItem, z: float | None = None) -> None:
        """Add an item to the plot, in the coordinates of the axes."""
        if z is not None:
            item.setZValue(z)
        self._view.addItem(item, ignoreBounds=True)

    def _resized(self, pool: list[Any], count: int, make: Callable[[], Any]) -> list[Any]:
        """Pool of ``count`` items: existing ones are reused, surplus ones removed, missing ones made."""
        for item in pool[count:]:
            item.remove(self._view)
        return pool[:count] + [make() for _ in range(count - len(pool))]

    def _outline(self, colour: str, z: float, dash: tuple[float, ...] = (), fill: QBrush | None = None) -> Outline:
        item = Outline(QPainterPath(), self._theme.pen(colour, THIN, dash), fill)
        self._include(item, z)
        return item

    def show_numbers(self, on: bool, title: str = "") -> None:
        """Show numbers and a title along the bottom, or neither: in a stack only the lowest plot has them."""
        self._numbered_below, self._title_below = on, title
        self._show_below()

    def name_below(self, title: str) -> None:
        """Set the title along the bottom."""
        self._title_below = title
        self._show_below()

    def _show_below(self) -> None:
        """Show numbers and title; a low plot over an angle has only the unit, after its last number."""
        on, axis, self._low = self._numbered_below, self._axes["bottom"], self._is_low
        if self._below == (on, self._title_below, self._low):
            return
        self._below = on, self._title_below, self._low
        self._size_axes()
        axis.setStyle(showValues=on)
        axis.show_title(self._title_below if on and not self._low else "", self._theme.ink)

    @property
    def _is_low(self) -> bool:
        return self._numbered_below and self._title_below.endswith(DEGREES) and self.height() - self.legend.height < LOW

    def minimumSizeHint(self) -> QSize:
        """Size at which the curves have ``LEAST`` between the axes."""
        width = EDGE + self._axes["left"].minimumWidth() + RIGHT_MARGIN
        return QSize(LEAST.width() + ceil(width), self.least_height(self._numbered_below))

    def least_height(self, numbered: bool) -> int:
        """Height that ``minimumSizeHint`` has with numbers along the bottom, or without."""
        top = self._axes["top"].minimumHeight() if "top" in self._axes else 0.0
        below = self._height_below(numbered, low=self._title_below.endswith(DEGREES))
        return LEAST.height() + ceil(self._above + self.legend.height + top + below + EDGE)

    def _height_below(self, numbered: bool, low: bool) -> float:
        """Height of the axis below, in a low plot over an angle or in another one."""
        return sized(NUMBERS if low else BOTTOM_HEIGHT) if numbered else BARE

    def _size_axes(self) -> None:
        """Give the axes room for their numbers and titles."""
        self.updateGeometry()
        self._axes["left"].setWidth(sized(LEFT_WIDTH))
        self._axes["bottom"].setHeight(self._height_below(self._numbered_below, self._low))
        if "top" in self._axes:
            self._axes["top"].setHeight(sized(TOP_HEIGHT))

    def update_style(self) -> None:
        """Lay out again after a change of theme or font size."""
        for item in self.scene().items():
            if callable(update_font := getattr(item, "update_font", None)):
                update_font()
        self._size_axes()
        self._fit_legend()
        self._draw_in_style()

    def _draw_in_style(self) -> None:
        """Lay out the contents, in the current theme and font size."""
        self._lay()

    def getViewBox(self) -> pg.ViewBox:
        """View box between the axes, in their coordinates."""
        return self._view

    def getAxis(self, side: str) -> Axis:
        """Axis on a side: "left", "bottom" or "top"."""
        return self._axes[side]

    def close(self) -> bool:
        """Close the widget so that it can be shown again; pyqtgraph would dismantle the scene."""
        return QWidget.close(self)

    # -- legend ---------------------------------------------------------------------------------------------

    def reserve_corner(self, width: float) -> None:
        """Leave so many pixels of the upper right corner free of the legend."""
        self.corner = width
        self._fit_legend()

    def _name(self, entries: Sequence[Entry], note: str = "") -> None:
        """Set the legend; it takes no room where nothing has a name."""
        self.legend.set_entries(entries, note)
        self._fit_legend()

    def _forget_listed(self, frame: Frame) -> None:
        """Take the texts of lines from the legend where the plot has another size, at which there may be room for them.

        The height of the frame is no such size: it follows from the legend.
        """
        size = self.size(), frame.width
        if size != self._listed_size:
            self._listed_size, self._listed = size, {}

    def _fit_legend(self) -> None:
        """Fit the legend between the left axis and the reserved corner."""
        left = EDGE + sized(LEFT_WIDTH)
        width = self.width() - left - max(RIGHT_MARGIN, self.corner)
        self.legend.fit(QRectF(left, self._above, width, LEGEND_SHARE * self.height()))
        layout = self._canvas.layout
        if layout.rowMinimumHeight(0) != self.legend.height:
            layout.setRowFixedHeight(0, self.legend.height)
            self.updateGeometry()
        if self._low != self._is_low:
            self._show_below()

    def resizeEvent(self, event: QResizeEvent | None) -> None:
        if event is not None:  # None: pyqtgraph's call during construction
            self._fit_legend()  # first, because the plot gets the remaining height
        super().resizeEvent(event)

    # -- layout ---------------------------------------------------------------------------------------------

    def frame(self) -> Frame:
        """Range and size that are shown."""
        (first, last), (low, high) = self._view.viewRange()
        return Frame(low, high, max(self._view.width(), 1.0), max(self._view.height(), 1.0), first, last)

    def to_pixel(self, at: QPointF, view: pg.ViewBox | None = None) -> QPointF:
        """Pixel of the widget at a point on the axes, by default the left one."""
        return QPointF(self.mapFromScene((view or self._view).mapViewToScene(at)))

    def to_axes(self, pixel: QPointF, view: pg.ViewBox | None = None) -> QPointF:
        """Point on the axes, by default the left one, at a pixel of the widget."""
        return QPointF((view or self._view).mapSceneToView(self.mapToScene(pixel.toPoint())))

    def pixel_at(self, across: float) -> QPointF:
        """Pixel of the widget at a value of the x axis, in the middle of the plot's height."""
        frame = self.frame()
        return self.to_pixel(QPointF(across, 0.5 * (frame.low + frame.high)))

    def describe(self, name: str, text: str) -> None:
        """Set name and description for screen readers; the message describes a plot without curves."""
        self.setAccessibleName(name)
        self.setAccessibleDescription(text or self._message_text or NOTHING_DRAWN)

    def draw_axes(self, frame: Frame, across: Ticks, upwards: Ticks, segments: Sequence[Span] = ()) -> None:
        """Draw grid, zero line, shaded segments and ticks, and the message in the middle."""
        self._background.draw(segments, [at for at, _ in across], [at for at, _ in upwards], frame)
        last = len(across) - 1
        self._axes["bottom"].show_ticks(
            [(at, f"{text}°" if self._low and i == last else text) for i, (at, text) in enumerate(across)]
        )
        self._axes["left"].show_ticks(upwards)
        self._message.set_text(wrapped(self._message_text, frame.width - MESSAGE_EDGE, TEXT))
        self._message.setPos(0.5 * (frame.first + frame.last), 0.5 * (frame.low + frame.high))

    def _lay(self, *_: object) -> None:
        """Lay the plot out for its current size and contents."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # the axes are fixed; the surrounding view may scroll


# -- title and scale of an axis --------------------------------------------------------------------------


def fitting_title(titles: Iterable[str], unit: str, height: float) -> str:
    """First title of an upward axis that is no longer than the axis [pixels]; else its unit alone."""
    return next((title for title in titles if text_size(title, TEXT)[0] <= height + sized(TOP_HEIGHT)), unit)


def with_one_scale(x: Ends, y: Ends, frame: Frame, unit: float = 1.0) -> tuple[Ends, Ends]:
    """Widen the narrower of two ranges until lengths have one scale; ``unit`` is that of y in the unit of x."""
    per_pixel = max((x[1] - x[0]) / frame.width, unit * (y[1] - y[0]) / frame.height)
    return _with_width(x, per_pixel * frame.width), _with_width(y, per_pixel * frame.height / unit)


def _with_width(ends: Ends, width: float) -> Ends:
    middle = 0.5 * (ends[0] + ends[1])
    return middle - 0.5 * width, middle + 0.5 * width
