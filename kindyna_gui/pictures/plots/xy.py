"""Plot of quantities over any quantity: curves, dots, rules, and a cursor.

It also draws the map of the contact force over cam angle and speed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QBrush, QMouseEvent, QPen
from PySide6.QtWidgets import QGraphicsItem, QWidget

from core.design.engine import HALF_CYCLE
from core.dynamics import ContactMap
from core.frozen import frozen
from core.output.drawing.palette import BLUE, GREEN, ORANGE, PURPLE, VERMILION
from core.output.drawing.scales import DisplayUnit
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.library import pg
from kindyna_gui.pictures.plots.lines import (
    DASHED_MARK,
    MACHINES,
    TEXT_POSITIONS,
    Z_CURSOR,
    Z_CURVE,
    Z_LIMIT,
    Cursor,
    Entry,
    Frame,
    band_entry,
    band_items,
    enters,
    reference_entry,
)
from kindyna_gui.pictures.plots.marks import Readout, place_readouts
from kindyna_gui.pictures.plots.mouse import AngleMouse
from kindyna_gui.pictures.plots.plot import (
    LEAST_ACROSS,
    FixedPlot,
    Ticks,
    angle_ticks,
    cycle_ticks,
    fitting_title,
    value_ticks,
    with_one_scale,
)
from kindyna_gui.pictures.style import DASHED, SCREEN, THIN, Theme, brush, no_pen, rgb
from kindyna_gui.pictures.units import lines_words, short

if TYPE_CHECKING:
    from core.plot import PlotCurve
    from core.stability import Plot


NO_UNIT = DisplayUnit("", 1.0, 0.0)
FREE = 0.06  # of the range, left free around the curves
FOR_MARKS = 0.06  # of the range, left free in addition for the texts of vertical lines
RULE_GAP = 3.0  # of a text from its horizontal line, pixels
RULE_ROOM = 10.0  # more than its width that a text needs to the right of its vertical line, pixels
Z_IMAGE, Z_BEHIND, Z_DOTS = -5.0, -1.0, Z_CURVE + 1.0
Ends = tuple[float, float]
WHOLE_TURN = (0.0, 360.0)  # an axis of cam angles
CRANK_CYCLE = (-HALF_CYCLE, HALF_CYCLE)  # an axis of crank angles
ROWS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE)
"""Colours of the curves of a plot in order."""
MACHINE_ANGLE, MACHINE_TIP = "Machine angle, °", "Click or drag to set the machine angle"

# -- curves, dots and rules ------------------------------------------------------------------------------


@frozen(eq=False)
class Line:
    """A curve of a plot.

    Attributes
    ----------
    x, y : ndarray (n,), in the units of the axes; y is NaN where the curve is interrupted
    colour, label : colour, and name in the legend
    dash : pattern of dashes, empty for a solid line
    width : in multiples of the normal width
    read : whether its value is shown at the cursor
    band : x (m,) and percentiles (5, m) of the machines, drawn as a shaded band
    reference : name of the design that it belongs to, where that is another one
    """

    x: np.ndarray
    y: np.ndarray
    colour: str
    label: str = ""
    dash: tuple[float, ...] = ()
    width: int = 1
    read: bool = False
    band: tuple[np.ndarray, np.ndarray] | None = None
    reference: str = ""


def reference_lines(lines: Iterable[Line], name: str) -> list[Line]:
    """Curves of another design, dashed; the legend has the name of the design in place of theirs."""
    return [replace(line, label="", dash=DASHED, read=False, band=None, reference=name) for line in lines]


@frozen(eq=False)
class Dots:
    """Single points of a plot.

    Attributes
    ----------
    x, y : ndarray (n,), in the units of the axes
    colour : one for all points, or one for each point
    size : diameter [pixels]
    hollow : draw circles without fill
    behind : draw them behind the curves
    texts : text above each point, empty for none; () for no texts at all
    """

    x: np.ndarray
    y: np.ndarray
    colour: str | Sequence[str]
    size: float = 9.0
    hollow: bool = False
    behind: bool = False
    texts: Sequence[str] = ()


@frozen
class Rule:
    """A line with a text over the full plot.

    Attributes
    ----------
    at : position on the x axis, or the value of a horizontal line
    level : whether it is horizontal, else vertical
    low : whether the text is at the lower end of a vertical line
    """

    at: float
    text: str
    colour: str
    level: bool = False
    low: bool = False


class XYPlot(FixedPlot):
    """Plot of curves, dots and rules over any quantity.

    Attributes
    ----------
    display_unit : unit of the values at the cursor
    shown : curves that were drawn last
    dots : single points that are drawn
    """

    def __init__(self, across: str, upwards: str, parent: QWidget | None = None, theme: Theme = SCREEN) -> None:
        super().__init__(parent, theme, centred=True)
        self.setAntialiasing(True)
        self._titles = (across, upwards)
        self._drawn: list[pg.PlotCurveItem] = []
        self._filled = False
        self.shown: tuple[Line, ...] = ()
        self._ticks: tuple[Ticks, Ticks] | None = None
        self._extra: list[QGraphicsItem] = []
        self._ruled: list[tuple[Rule, Outline, Tag]] = []
        self._names: tuple[list[Entry], str] = ([], "")
        self.dots: tuple[Dots, ...] = ()
        self.display_unit = NO_UNIT
        self._valued: list[Line] = []
        self._readouts: list[Readout] = []
        self._cursor: Cursor | None = None
        self._title_hue = ""
        self._alike = False
        self._ranges = ((0.0, 1.0), (0.0, 1.0))
        self.show_message("")

    # -- contents -------------------------------------------------------------------------------------------

    @property
    def lines(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Points of the curves that are drawn, x and y."""
        return [(item.xData, item.yData) for item in self._drawn]

    @property
    def message(self) -> str:
        """Text shown in place of curves; empty where there are curves."""
        return self._message_text

    @property
    def rules(self) -> list[Rule]:
        """Lines with a text that are drawn."""
        return [rule for rule, _, _ in self._ruled]

    @property
    def cursor_at(self) -> float | None:
        """Position of the cursor on the x axis; None where it is not visible."""
        return self._cursor.value() if self._cursor is not None and self._cursor.isVisible() else None

    def show_lines(
        self,
        lines: Sequence[Line],
        marks: tuple[tuple[float, str], ...] = (),
        square: bool = False,
        note: str = "",
        alike: bool = False,
        fit: bool = False,
        quiet: bool = False,
        rules: Sequence[Rule] = (),
        dots: Sequence[Dots] = (),
        display_unit: DisplayUnit = NO_UNIT,
        shaded: str = MACHINES,
    ) -> None:
        """Draw these curves and no others.

        Parameters
        ----------
        lines : sequence of Line
        marks : tuple of (position, text)
            Vertical lines whose texts are above the curves.
        square : bool
            Zero is in the middle of both axes.
        note : str
            Follows the names in the legend.
        alike : bool
            One unit is equally long on both axes.
        fit : bool
            The y axis need not include zero.
        quiet : bool
            The marks are positions, not warnings, and have the quiet colour.
        rules, dots : sequence of Rule, of Dots
        display_unit : DisplayUnit
            Unit of the values at the cursor.
        shaded : str
            Name of the bands in the legend.
        """
        self._clear()
        if self._theme.is_dark:
            lines = [replace(line, colour=self._theme.seen(line.colour)) for line in lines]
        self._filled, self.shown = True, tuple(lines)
        for line in lines:
            item = pg.PlotCurveItem(antialias=True)
            is_finite = np.isfinite(line.y).all()
            pen = self._theme.pen(line.colour, THIN * line.width, line.dash)
            item.setData(line.x, line.y, pen=pen, connect="all" if is_finite else "finite")
            self._include(item)
            self._drawn.append(item)
        banded = [(line, *line.band) for line in lines if line.band is not None]
        for line, band_x, percentiles in banded:
            for area in band_items(band_x, percentiles, line.colour):
                self._add(area, area.zValue())
        names = [Entry(line.colour, line.label) for line in lines if line.label]
        names += [
            reference_entry(name, self._theme) for name in dict.fromkeys(line.reference for line in lines) if name
        ]
        self._names = ([*names, *([band_entry(self._theme, shaded)] if banded and shaded else [])], note)
        self._name_lines()
        self._read_lines([line for line in lines if line.read], display_unit)
        x, y = (np.concatenate([getattr(row, axis) for row in (*lines, *dots)]) for axis in "xy")
        y = np.concatenate([y, *(percentiles[i] for *_, percentiles in banded for i in (0, -1))])
        self._alike, fit = alike, fit or alike
        ranges = [self._range(x, square, tight=not square and not alike, fit=fit), self._range(y, square, fit=fit)]
        if marks and not square and not alike:  # their texts are above the curves
            low, high = ranges[1]
            ranges[1] = (low, high + FOR_MARKS * (high - low))
        self._ranges = (ranges[0], ranges[1])
        if QAccessible.isActive():
            self._describe()
        self._view.setRange(xRange=ranges[0], yRange=ranges[1], padding=0.0)
        colour = self._theme.quiet if quiet else self._theme.limit
        for rule in (*(Rule(at, text, colour) for at, text in marks), *rules):
            tag = Tag(rule.text, rule.colour, self._theme, lean=(0.0, 0.0), backing=True)
            self._include(tag, Z_CURSOR)
            self._ruled.append((rule, self._outline(rule.colour, Z_LIMIT, DASHED), tag))
        self.dots = tuple(dots)
        for group in dots:
            item = pg.ScatterPlotItem(group.x, group.y, size=group.size, antialias=True, **self._dot_style(group))
            self._add(item, Z_BEHIND if group.behind else Z_DOTS)
            for x, y, text in zip(group.x.tolist(), group.y.tolist(), group.texts, strict=False):
                if text:
                    tag = Tag(text, self._theme.ink, self._theme, lean=(0.5, 1.0))
                    tag.setPos(x, y)
                    tag.shift(0.0, -0.5 * group.size)
                    self._add(tag, Z_DOTS)
        self._message_text = ""
        self._lay()

    def _dot_style(self, dots: Dots) -> dict[str, Any]:
        """Brushes and pens of dots: one object for a colour, as pyqtgraph draws each further object separately."""

        def style(colour: str) -> tuple[QBrush, QPen]:
            if dots.hollow:
                return brush(self._theme.paper), self._theme.pen(colour)
            return brush(colour), no_pen()

        if isinstance(dots.colour, str):
            return dict(zip(("brush", "pen"), style(dots.colour), strict=True))
        styles = {colour: style(colour) for colour in dict.fromkeys(dots.colour)}
        return {kind: [styles[colour][k] for colour in dots.colour] for k, kind in enumerate(("brush", "pen"))}

    def _add(self, item: QGraphicsItem, z: float) -> None:
        """Add an item that is removed when something else is shown."""
        self._include(item, z)
        self._extra.append(item)

    def show_image(self, pixels: np.ndarray, rectangle: QRectF) -> None:
        """Show colours (n, m, 4) below the curves, in a rectangle in the units of the axes."""
        image = pg.ImageItem()
        image.setImage(pixels)
        image.setRect(rectangle)
        self._add(image, Z_IMAGE)

    def across_at(self, pixel: QPoint) -> float:
        """Position on the x axis of a pixel of the widget."""
        return self.to_axes(QPointF(pixel)).x()

    def show_range(self, across: Ends | None = None, upwards: Ends | None = None) -> None:
        """Set the ranges of the axes; None leaves an axis unchanged."""
        self._view.setRange(xRange=across, yRange=upwards, padding=0.0)
        self._lay()

    def show_ticks(self, across: Ticks, upwards: Ticks) -> None:
        """Use these ticks instead of round numbers until something else is shown."""
        self._ticks = across, upwards
        self._lay()

    def point_out(self, at: float | None) -> None:
        """Show the cursor at this position of the x axis, or hide it where it is None."""
        if self._cursor is None and at is not None:
            self._cursor = Cursor(self._view, self._theme)
            self._cursor.span(self.frame())
        if self._cursor is not None:
            self._cursor.setVisible(at is not None and self._filled)
            if at is not None:
                self._cursor.setPos(at, 0.0)
        self._read_out()

    def _read_lines(self, lines: list[Line], display_unit: DisplayUnit) -> None:
        """Set the curves whose values are shown at the cursor."""
        self._valued, self.display_unit = lines, display_unit
        self._readouts = self._resized(self._readouts, len(lines), lambda: Readout(self._view, self._theme))
        for readout, line in zip(self._readouts, lines, strict=True):
            readout.set_colour(line.colour)

    def _read_out(self) -> None:
        """Show the values of the points nearest to the cursor."""
        at = self.cursor_at
        if at is None:
            for readout in self._readouts:
                readout.hide()
        elif self._valued:
            values = [float(line.y[np.argmin(np.abs(line.x - at))]) for line in self._valued]
            place_readouts(self._readouts, at, values, self.display_unit, self.frame())

    def readings(self) -> list[str]:
        """Texts at the cursor, in the order of the curves that are read."""
        return [readout.tag.text for readout in self._readouts if readout.tag.isVisible()]

    def show_numbers(self, on: bool, title: str = "") -> None:
        """Show numbers and a title along the bottom, by default that of ``name_axes``, or neither."""
        super().show_numbers(on, title or (self._titles[0] if self._filled else ""))

    def _describe(self) -> None:
        """Set name and description for screen readers."""
        across, upwards = self._titles
        quantity = upwards.rpartition(", ")[0] or upwards
        lines = [(line.label, line.x, line.y) for line in self.shown if self._filled]
        name = f"Plot of {quantity[:1].lower()}{quantity[1:]}" if quantity else "Plot"
        self.describe(name, lines_words(lines, across, upwards))

    def name_axes(self, across: str, upwards: str, colour: str = "") -> None:
        """Set the titles of the axes for the next contents, and the colour of the upward one; "" for ink."""
        self._titles, self._title_hue = (across, upwards), colour

    def _colour(self, curve: PlotCurve, is_single_row: bool) -> str:
        """Colour of the curve's quantity; without one that of its row, or ink for a single row."""
        if curve.family:
            return self._theme.family(curve.family)
        return self._theme.ink if is_single_row else ROWS[curve.row % len(ROWS)]

    def show_plot(self, plot: Plot, reference: Plot | None = None, reference_name: str = "") -> None:
        """Draw a plot that the core describes, and dashed the solid curves of the same plot of another design."""
        self.name_axes(plot.across, plot.upwards)
        others = [line for line in self._lines_of(reference) if not line.dash] if reference is not None else []
        self.show_lines(
            [*self._lines_of(plot), *reference_lines(others, reference_name)],
            plot.marks,
            note=plot.note,
            alike=plot.alike,
            fit=plot.fit,
            quiet=plot.quiet,
        )

    def _lines_of(self, plot: Plot) -> list[Line]:
        is_single_row = len({curve.row for curve in plot.curves}) == 1
        return [
            Line(c.x, c.y, self._colour(c, is_single_row), c.label, DASHED if c.dashed else ()) for c in plot.curves
        ]

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
        """Show only a text, such as the input that is missing."""
        self._clear()
        self._read_lines([], NO_UNIT)
        self.point_out(None)
        self._name([])
        self._message_text = text
        self._describe()
        self._view.setRange(xRange=(0.0, 1.0), yRange=(0.0, 1.0), padding=0.0)
        self._lay()

    def _clear(self) -> None:
        for item in (*self._drawn, *self._extra, *(item for _, *items in self._ruled for item in items)):
            self._view.removeItem(item)
        self._drawn, self._extra, self._ruled, self.dots, self._listed = [], [], [], (), {}
        self._ticks = None
        self._filled = False

    # -- layout ---------------------------------------------------------------------------------------------

    def _lay(self, *_: object) -> None:
        if self._alike and self._filled:  # one unit is equally long on both axes
            x, y = with_one_scale(*self._ranges, self.frame())
            self._view.setRange(xRange=x, yRange=y, padding=0.0)
        frame = self.frame()
        low, high = frame.first, frame.last
        if (low, high) == WHOLE_TURN:
            across = angle_ticks(frame.width)
        elif (low, high) == CRANK_CYCLE:
            across = cycle_ticks(low, high, frame.width)
        else:
            across = value_ticks(low, high, frame.width, LEAST_ACROSS)
        upwards = value_ticks(frame.low, frame.high, frame.height)
        self.draw_axes(frame, *((self._ticks or (across, upwards)) if self._filled else ((), ())))
        self.name_below(self._titles[0] if self._filled else "")
        title, unit = self._titles[1], self._titles[1].rpartition(", ")[2]
        colour = self._theme.text_colour(self._title_hue) if self._title_hue else self._theme.ink
        self._axes["left"].show_title(fitting_title((title,), unit, frame.height) if self._filled else "", colour)
        if self._cursor is not None:
            self._cursor.span(frame)
        self._lay_rules(frame)
        self._read_out()

    def _lay_rules(self, frame: Frame) -> None:
        """Put the texts of rules clear of curves and of each other, else in the legend, where they stay at this size."""
        size = complex(frame.width / (frame.last - frame.first), frame.height / (frame.high - frame.low))
        curves = [(x - frame.first) * size.real + 1j * (y - frame.low) * size.imag for x, y in self.lines]
        boxes: list[QRectF] = []
        before = list(self._listed)
        self._forget_listed(frame)
        for rule, line, tag in self._ruled:
            is_clear = _draw_rule(rule, line, tag, frame, curves, boxes)
            if rule.text in self._listed or not is_clear:
                tag.setVisible(False)
                self._listed[rule.text] = Entry(rule.colour, rule.text, DASHED_MARK)
            else:
                boxes.append(frame.box(tag.pos().x(), tag.pos().y(), tag.pixel_box()))
        if list(self._listed) != before:
            self._name_lines()

    def _name_lines(self) -> None:
        """Name the curves above the plot, and rules whose texts have no room in it."""
        names, note = self._names
        self._name([*names, *(entry for text, entry in self._listed.items() if text)], note)


def _draw_rule(
    rule: Rule, line: Outline, tag: Tag, frame: Frame, curves: Sequence[np.ndarray], occupied: Sequence[QRectF]
) -> bool:
    """Draw a rule over the full plot, with its text on it where that covers no curve and no occupied box.

    Returns False where there is no such place; then the text is hidden.
    """
    line.redraw(frame.horizontal(rule.at) if rule.level else frame.vertical(rule.at))
    room = QRectF(-1.0, -1.0, frame.width + 2.0, frame.height + 2.0)
    for _ in _text_places(rule, tag, frame):
        box = frame.box(tag.pos().x(), tag.pos().y(), tag.pixel_box())
        is_free = room.contains(box) and not any(map(box.intersects, occupied))
        if is_free and not any(enters(curve, box) for curve in curves):
            tag.setVisible(True)
            return True
    tag.setVisible(False)
    return False


def _text_places(rule: Rule, tag: Tag, frame: Frame) -> Iterator[None]:
    """Put the text at one place on its line after the other: at the end of the line first, on its roomier side."""
    if rule.level:
        above = frame.height - frame.pixel(rule.at) > tag.size[1] + RULE_GAP
        for over, part in product((above, not above), TEXT_POSITIONS):
            tag.set_lean(part, 1.0 if over else 0.0)
            tag.shift(RULE_GAP * (1.0 - 2.0 * part), -RULE_GAP if over else RULE_GAP)
            tag.setPos(frame.first + part * (frame.last - frame.first), rule.at)
            yield
        return
    right = (frame.last - rule.at) / (frame.last - frame.first) * frame.width > tag.size[0] + RULE_ROOM
    for part, on_right in product(TEXT_POSITIONS, (right, not right)):
        part = 1.0 - part if rule.low else part
        tag.set_lean(0.0 if on_right else 1.0, 1.0 - part)
        tag.shift(4.0 if on_right else -4.0, RULE_GAP * (2.0 * part - 1.0))
        tag.setPos(rule.at, frame.low + part * (frame.high - frame.low))
        yield


# -- map of the contact force ----------------------------------------------------------------------------

RPM = math.pi / 30.0
FAINT, FULL = 0.06, 0.75  # opacity at zero force, at the greatest
LIFTED = 0.3  # least opacity where the force is negative
ACROSS, UPWARDS = "Cam angle, °", "Camshaft speed, rpm"


def zero_lines(contact: ContactMap) -> list[Line]:
    """Curves of the speeds [rpm] at which the contact force is zero, within the speeds of the map."""
    rows = np.where(contact.zero <= contact.omega[-1], contact.zero, np.nan) / RPM
    labels = zip(rows, ("0 N", ""), strict=True)
    return [Line(np.rad2deg(contact.theta), row, VERMILION, text) for row, text in labels if np.isfinite(row).any()]


def show_map(plot: XYPlot, contact: ContactMap, speed: float, pinned: Sequence[Line] = ()) -> None:
    """Draw the contact force over cam angle and speed: blue in contact, orange where the follower lifts off.

    Lines show where the force is zero, also that of a pinned variant, and the design's speed [rpm].
    """
    rpm = contact.omega / RPM
    top, step = float(rpm[-1]), float(rpm[-1]) / rpm.size
    lines = [Line(np.array(WHOLE_TURN), np.array([speed, speed]), SCREEN.ink, f"{short(speed, 6)} rpm", DASHED)]
    lines += [*zero_lines(contact), *pinned]
    peak = float(contact.force.max())
    plot.name_axes(ACROSS, UPWARDS)
    plot.show_lines(lines, note=f"blue: up to {short(peak, 3)} N, orange: off the cam")
    low = float(rpm[0])
    plot.show_image(_force_colours(contact.force), QRectF(0.0, low - 0.5 * step, 360.0, top - low + step))
    plot.show_range(WHOLE_TURN, (0.0, top))


def _force_colours(force: np.ndarray) -> np.ndarray:
    """Colours (n, m, 4) of forces (m, n) [N]; a larger force is more opaque."""
    greatest = float(np.abs(force).max()) or 1.0
    strength = np.sqrt(np.abs(force.T) / greatest)
    pixels = np.empty((*strength.shape, 4), dtype=np.ubyte)
    contact_colour, lift_colour = (np.array(rgb(name), dtype=np.ubyte) for name in (BLUE, VERMILION))
    lifted = (force.T < 0.0)[..., None]
    pixels[..., :3] = np.where(lifted, lift_colour, contact_colour)
    least = np.where(lifted[..., 0], LIFTED, FAINT)
    pixels[..., 3] = np.round(255.0 * (least + (FULL - least) * strength))
    return pixels


# -- cursor that the mouse moves -------------------------------------------------------------------------


class CursorPlot(AngleMouse, XYPlot):
    """Plot with a cursor that a click or a drag moves or, where it ``reads``, that follows the mouse.

    Signals
    -------
    moved (float) : the user has clicked at, or dragged the cursor to, this position of the x axis
    read (object) : position of the mouse on the x axis, None outside the plot
    """

    moved = Signal(float)
    read = Signal(object)

    def __init__(self, across: str, upwards: str = "", *, reads: bool = False) -> None:
        super().__init__(across, upwards)
        self._reads = reads
        self.setMouseTracking(reads)
        self.viewport().setMouseTracking(reads)
        if not reads:
            self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)

    def set_angle_at(self, pixel: QPointF) -> None:
        if self._filled and not self._reads:
            frame = self.frame()
            self.moved.emit(min(max(self.to_axes(pixel).x(), frame.first), frame.last))

    def hover(self, event: QMouseEvent | None) -> None:
        if not self._reads:
            super().hover(event)
            return
        frame, at = self.frame(), None if event is None else self.to_axes(event.position()).x()
        read = at if at is not None and self._filled and frame.first <= at <= frame.last else None
        self.point_out(read)
        self.read.emit(read)

    def show_message(self, text: str) -> None:
        super().show_message(text)
        self.read.emit(None)
