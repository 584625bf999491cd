"""The base of all plots: paper with axes whose ranges are set, never searched."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QPainterPath, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QFrame, QGraphicsGridLayout, QGraphicsItem, QSizePolicy, QWidget

from kindyna_gui.pictures.items import Outline, Tag, wrapped
from kindyna_gui.pictures.plots.axis import Axis
from kindyna_gui.pictures.plots.background import Paper, Span
from kindyna_gui.pictures.plots.frame import BOTTOM_HEIGHT, LEFT_WIDTH, TOP_HEIGHT, Frame
from kindyna_gui.pictures.plots.legend import Entry, Legend
from kindyna_gui.pictures.style import SCREEN, TEXT, THIN, Theme
from kindyna_gui.preferences.units import sized

EDGE, RIGHT_MARGIN = 2, 16  # around the axes, pixels
TOP_MARGIN = 6  # where nothing stands above the plot
BARE, NUMBERS = 6, 20  # heights of an axis without numbers, and with numbers alone
LOW = 150  # pixels of height, below which a plot has no room for the name of its angle
DEGREES = ", °"  # behind such a name
LEGEND_SHARE = 0.25  # of the height, for more than two lines of names
MESSAGE_EDGE = 16.0  # left free beside a message
PLACES = {
    "top": (1, 1),
    "bottom": (3, 1),
    "left": (2, 0),
}  # row and column, in the order of drawing; the first row has the names
Ticks = Sequence[tuple[float, str]]


class Sheet(pg.GraphicsWidget):
    """Axes around a picture, and the room above for names: ``pg.PlotItem`` without its menus, which take most of its time."""

    def __init__(self, axes: Mapping[str, Axis]) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.layout = QGraphicsGridLayout(self)
        self.layout.setSpacing(0.0)
        self.view = pg.ViewBox(parent=self, enableMenu=False)
        self.layout.addItem(self.view, 2, 1)
        for side in (side for side in PLACES if side in axes):
            axis = axes[side]
            axis.linkToView(self.view)
            axis.setZValue(0.5)  # above what is filled, below what is to be read over it
            axis.setFlag(QGraphicsItem.GraphicsItemFlag.ItemNegativeZStacksBehindParent)
            self.layout.addItem(axis, *PLACES[side])
        self.layout.setRowStretchFactor(2, 100)
        self.layout.setColumnStretchFactor(1, 100)


class FixedPlot(pg.GraphicsView):
    """Nothing zooms, pans, looks for its range or opens a menu, and the wheel is left to what is around.

    top      whether there is an axis above, for names
    centred  whether the legend stands above the middle, else above the left end
    corner   pixels of the upper right corner that something else covers, which the legend stays clear of
    """

    def __init__(
        self, parent: QWidget | None = None, theme: Theme = SCREEN, *, top: bool = False, centred: bool = False
    ) -> None:
        sides = ("left", "bottom", "top") if top else ("left", "bottom")
        axes = {side: Axis(side, theme, line=side != "top") for side in sides}
        super().__init__(parent, background=theme.paper)
        self._sheet = sheet = Sheet(axes)
        self.setCentralItem(sheet)
        self.setCacheMode(self.CacheModeFlag.CacheNone)  # kept paper would stand in an SVG as pixels
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._theme, self._axes, self.corner = theme, axes, 0.0
        self._view = sheet.view
        self._above = float(EDGE if top else TOP_MARGIN)
        sheet.layout.setContentsMargins(EDGE, self._above, RIGHT_MARGIN, EDGE)
        self._view.setMouseEnabled(False, False)
        self._view.disableAutoRange()
        self._view.setDefaultPadding(0.0)
        self._view.setRange(xRange=(0.0, 360.0), yRange=(0.0, 1.0), padding=0.0)
        self._numbered_below, self._title_below, self._low = True, "", False
        self._below: tuple[bool, str, bool] | None = None
        self._size_axes()
        self._paper = Paper(self._view, theme)
        self._legend = Legend(sheet, theme.ink, centred)
        self._message = Tag("", theme.quiet, theme, TEXT)
        self._include(self._message)
        self._message_text = ""
        self._view.sigResized.connect(self._lay)

    def _include(self, item: QGraphicsItem, z: float | None = None) -> None:
        """Into the plot, in the numbers of the axes."""
        if z is not None:
            item.setZValue(z)
        self._view.addItem(item, ignoreBounds=True)

    def _outline(self, colour: str, z: float, dash: tuple[float, ...] = (), fill: QBrush | None = None) -> Outline:
        item = Outline(QPainterPath(), self._theme.pen(colour, THIN, dash), fill)
        self._include(item, z)
        return item

    def show_numbers(self, on: bool, title: str = "") -> None:
        """Numbers and a title along the bottom, or neither: of plots one below the other only the last has them."""
        self._numbered_below, self._title_below = on, title
        self._show_below()

    def name_below(self, title: str) -> None:
        """Another title along the bottom."""
        self._title_below = title
        self._show_below()

    def _show_below(self) -> None:
        """Of an angle a low plot has the unit alone, behind its last number; where all is as it was nothing is painted anew."""
        on, axis, self._low = self._numbered_below, self._axes["bottom"], self._is_low
        if self._below == (on, self._title_below, self._low):
            return
        self._below = on, self._title_below, self._low
        self._size_axes()
        axis.setStyle(showValues=on)
        axis.show_title(self._title_below if on and not self._low else "", self._theme.ink)

    @property
    def _is_low(self) -> bool:
        return self._numbered_below and self._title_below.endswith(DEGREES) and self.height() < LOW

    def _size_axes(self) -> None:
        """Room for their numbers and titles."""
        self._axes["left"].setWidth(sized(LEFT_WIDTH))
        below = NUMBERS if self._low else BOTTOM_HEIGHT if self._numbered_below else BARE
        self._axes["bottom"].setHeight(sized(below) if self._numbered_below else below)
        if "top" in self._axes:
            self._axes["top"].setHeight(sized(TOP_HEIGHT))

    def redress(self) -> None:
        """Theme or letters have changed: lay out anew what is there."""
        for item in self.scene().items():
            if callable(letter := getattr(item, "letter", None)):
                letter()
        self._size_axes()
        self._fit_legend()
        self._lay()

    def getViewBox(self) -> pg.ViewBox:
        """What stands between the axes, in their numbers."""
        return self._view

    def getAxis(self, side: str) -> Axis:
        return self._axes[side]

    def close(self) -> bool:
        """As of any widget, which can be shown again; pyqtgraph would take the scene apart."""
        return QWidget.close(self)

    # -- legend ---------------------------------------------------------------------------------------------

    @property
    def legend(self) -> Legend:
        return self._legend

    def keep_corner(self, width: float) -> None:
        """Something so wide [pixels] stands in the upper right corner, over the plot."""
        self.corner = width
        self._fit_legend()

    def _name(self, entries: Sequence[Entry], note: str = "") -> None:
        """The legend above the curves; no room is lost where nothing has a name."""
        self._legend.set_entries(entries, note)
        self._fit_legend()

    def _fit_legend(self) -> None:
        """Between the left axis and what is kept free on the right."""
        left = EDGE + sized(LEFT_WIDTH)
        width = self.width() - left - max(RIGHT_MARGIN, self.corner)
        self._legend.fit(QRectF(left, self._above, width, LEGEND_SHARE * self.height()))
        layout = self._sheet.layout
        if layout.rowMinimumHeight(0) != self._legend.height:
            layout.setRowFixedHeight(0, self._legend.height)

    def resizeEvent(self, event: QResizeEvent | None) -> None:
        if event is not None:  # pyqtgraph's own call while it is being made
            self._fit_legend()  # first, for the plot gets what is left of the height
            if self._low != self._is_low:
                self._show_below()
        super().resizeEvent(event)

    # -- layout ---------------------------------------------------------------------------------------------

    def frame(self) -> Frame:
        """What is shown at which size."""
        (first, last), (low, high) = self._view.viewRange()
        return Frame(low, high, max(self._view.width(), 1.0), max(self._view.height(), 1.0), first, last)

    def pixel_at(self, across: float) -> QPointF:
        """Where a place of the x axis stands in the widget [pixels], in the middle of the plot's height."""
        frame = self.frame()
        place = self._view.mapViewToScene(QPointF(across, 0.5 * (frame.low + frame.high)))
        return QPointF(self.mapFromScene(place))

    def rule(self, frame: Frame, across: Ticks, upwards: Ticks, bands: Sequence[Span] = ()) -> None:
        """Grid, zero line, bands and ticks; the message in the middle."""
        self._paper.draw(bands, [at for at, _ in across], [at for at, _ in upwards], frame)
        last = len(across) - 1
        self._axes["bottom"].show_ticks(
            [(at, f"{text}°" if self._low and i == last else text) for i, (at, text) in enumerate(across)]
        )
        self._axes["left"].show_ticks(upwards)
        self._message.set_text(wrapped(self._message_text, frame.width - MESSAGE_EDGE, TEXT))
        self._message.setPos(0.5 * (frame.first + frame.last), 0.5 * (frame.low + frame.high))

    def _lay(self, *_: object) -> None:
        """The plot has another size, or shows something else."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # the axes are fixed; what is around may want to scroll


__all__ = ["FixedPlot"]
