"""One quantity over another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QAccessible, QBrush, QKeyEvent, QMouseEvent, QPainterPath, QPen
from PySide6.QtWidgets import QGraphicsItem, QWidget

from core.dynamics import ContactMap
from core.frozen import frozen
from kindyna_gui.pictures.items import Outline, Tag, text_size
from kindyna_gui.pictures.plots.lines import (
    MACHINES,
    TOP_HEIGHT,
    Z_CURSOR,
    Z_CURVE,
    Z_LIMIT,
    Cursor,
    Entry,
    Frame,
    band_entry,
    band_items,
)
from kindyna_gui.pictures.plots.marks import Readout, place_readouts
from kindyna_gui.pictures.plots.plot import LEAST_ACROSS, FixedPlot, Ticks, angle_ticks, value_ticks
from kindyna_gui.pictures.style import (
    BLUE,
    DASHED,
    GREEN,
    ORANGE,
    PURPLE,
    SCREEN,
    TEXT,
    THIN,
    VERMILION,
    Theme,
    brush,
    no_pen,
    rgb,
)
from kindyna_gui.pictures.units import NOTHING_DRAWN, DisplayUnit, lines_words, short
from kindyna_gui.settings import sized

if TYPE_CHECKING:
    from core.plot import PlotCurve
    from core.stability import Plot


# -- pulled point ----------------------------------------------------------------------------------------

REACH = 9.0  # pixels from the own point


class PulledPoint(FixedPlot):
    """A mixin before the class of the plot, which says in the numbers of its points what lies at a place, and where its own stands.
    ``mouse_at``: where the mouse was last [pixels].

    hovered   (object): the point under the mouse, None where it is beside the plot
    picked    (float, float): a click
    pulled    (float, float): the own point is drawn there; released (bool): it was let go there, or Escape gave it up
    """

    hovered = Signal(object)
    picked = Signal(float, float)
    pulled = Signal(float, float)
    released = Signal(bool)
    grabbed = Signal()

    def __init__(self, *arguments: Any, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self._pulling = False
        self.mouse_at = QPointF()
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    def point_at(self, pixel: QPointF) -> tuple[float, float] | None:
        """The point at a place of the widget; None beside the plot."""
        raise NotImplementedError

    def own_pixel(self) -> QPointF | None:
        """Where the own point stands in the widget; None where it is not seen."""
        raise NotImplementedError

    @property
    def pulling(self) -> bool:
        """Whether the own point is held with the mouse."""
        return self._pulling

    def _over_own(self, place: QPointF) -> bool:
        own = self.own_pixel()
        if own is None:
            return False
        away = own - place
        return away.x() ** 2 + away.y() ** 2 <= REACH**2

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._over_own(event.position()):
            self._pulling = True
            self.grabbed.emit()
            return
        point = self.point_at(event.position())
        if point is not None:
            self.picked.emit(*point)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        self.mouse_at = event.position()
        point = self.point_at(event.position())
        if self._pulling:
            if point is not None:
                self.pulled.emit(*point)
            return
        over = self._over_own(event.position())
        self.viewport().setCursor(Qt.CursorShape.SizeAllCursor if over else Qt.CursorShape.CrossCursor)
        self.hovered.emit(point)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() == Qt.MouseButton.LeftButton and self._pulling:
            self._pulling = False
            self.released.emit(True)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape:
            self._pulling = False
            self.released.emit(False)
        else:
            event.ignore()

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.hovered.emit(None)


# -- xy --------------------------------------------------------------------------------------------------

NO_UNIT = DisplayUnit("", 1.0, 0.0)
FREE = 0.06  # of the range, left free around the curves
FOR_MARKS = 0.06  # of it, and so much more above them where upright lines have texts
APART, BESIDE = (
    3.0,
    10.0,
)  # of a text from its level rule, and what it needs more than its width beside an upright one, pixels
Z_IMAGE, Z_BEHIND, Z_DOTS = -5.0, -1.0, Z_CURVE + 1.0
Ends = tuple[float, float]
WHOLE_TURN = (0.0, 360.0)  # an axis of cam angles
ROWS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE)
"""Colours of the curves of a plot, one after the other."""


@frozen(eq=False)
class Line:
    """One curve: x and y (n,), nan where it is broken, its colour, its name in the legend, dashes, how many times as wide as
    others it is; read: its value stands beside the cursor; band: x (m,) and percentiles (5, m) within which
    machines lie, shaded."""

    x: np.ndarray
    y: np.ndarray
    colour: str
    label: str = ""
    dash: tuple[float, ...] = ()
    width: int = 1
    read: bool = False
    band: tuple[np.ndarray, np.ndarray] | None = None


@frozen(eq=False)
class Dots:
    """Single points: x and y (n,), one colour for all or one each, their diameter [pixels]; hollow: band_outlines; behind: the
    curves."""

    x: np.ndarray
    y: np.ndarray
    colour: str | Sequence[str]
    size: float = 9.0
    hollow: bool = False
    behind: bool = False


@frozen
class Rule:
    """A line with a text: upright at a place of the x axis, or level at a value; low: the text stands at its lower end."""

    at: float
    text: str
    colour: str
    level: bool = False
    low: bool = False


class XYPlot(FixedPlot):
    """Curves with axes of their own, dots and rules among them, such as where the follower leaves the cam.

    rung    the unit that values beside the cursor are written in
    shown   the curves that were drawn last
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
        self._dots: tuple[Dots, ...] = ()
        self._numbered = True
        self.rung = NO_UNIT
        self._valued: list[Line] = []
        self._readouts: list[Readout] = []
        self._cursor: Cursor | None = None
        self._title_colour = theme.ink
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

    @property
    def dots(self) -> tuple[Dots, ...]:
        """The single points that are drawn."""
        return self._dots

    @property
    def rules(self) -> list[Rule]:
        """The lines with a text that are drawn."""
        return [rule for rule, _, _ in self._ruled]

    @property
    def cursor_at(self) -> float | None:
        """Where the cursor stands on the x axis; None where it is not seen."""
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
        rung: DisplayUnit = NO_UNIT,
        shaded: str = MACHINES,
    ) -> None:
        """Draw these curves and no others; square: zero in the middle of both axes; note: for the legend; alike: one unit is as long
        on both axes; fit: zero need not be on the y axis; marks: rules upright, whose texts stand above the curves;
        quiet: they are places, not warnings; rung: the unit of values that are read at the cursor;
        shaded: what bands are, for the legend."""
        self._clear()
        if self._theme.is_dark:
            lines = [replace(line, colour=self._theme.seen(line.colour)) for line in lines]
        self._filled, self.shown = True, tuple(lines)
        for line in lines:
            item = pg.PlotCurveItem(antialias=True)
            broken = not np.isfinite(line.y).all()
            pen = self._theme.pen(line.colour, THIN * line.width, line.dash)
            item.setData(line.x, line.y, pen=pen, connect="finite" if broken else "all")
            self._include(item)
            self._drawn.append(item)
        banded = [(line, *line.band) for line in lines if line.band is not None]
        for line, places, ends in banded:
            for area in band_items(places, ends, line.colour):
                self._add(area, area.zValue())
        names = [Entry(line.colour, line.label) for line in lines if line.label]
        self._name([*names, *([band_entry(self._theme, shaded)] if banded and shaded else [])], note)
        self._read_lines([line for line in lines if line.read], rung)
        x, y = (np.concatenate([getattr(each, axis) for each in (*lines, *dots)]) for axis in "xy")
        self._alike = alike
        y = np.concatenate([y, *(ends[i] for *_, ends in banded for i in (0, -1))])
        if alike:
            fit = True
        ranges = [self._range(x, square, tight=not square and not alike, fit=fit), self._range(y, square, fit=fit)]
        if marks and not square and not alike:  # their texts stand above the curves
            low, high = ranges[1]
            ranges[1] = (low, high + FOR_MARKS * (high - low))
        self._wanted = (ranges[0], ranges[1])
        if QAccessible.isActive():
            self._speak()
        self._view.setRange(xRange=ranges[0], yRange=ranges[1], padding=0.0)
        colour = self._theme.quiet if quiet else self._theme.limit
        for rule in (*(Rule(at, text, colour) for at, text in marks), *rules):
            tag = Tag(rule.text, rule.colour, self._theme, lean=(0.0, 0.0), backing=True)
            self._include(tag, Z_CURSOR)
            self._ruled.append((rule, self._outline(rule.colour, Z_LIMIT, DASHED), tag))
        self._dots = tuple(dots)
        for each in dots:
            item = pg.ScatterPlotItem(each.x, each.y, size=each.size, antialias=True, **self._look(each))
            self._add(item, Z_BEHIND if each.behind else Z_DOTS)
        self._message_text = ""
        self._lay()

    def _look(self, dots: Dots) -> dict[str, Any]:
        """Their brushes and pens: one of each for a colour, as pyqtgraph draws every other one apart."""

        def look(colour: str) -> tuple[QBrush, QPen]:
            if dots.hollow:
                return brush(self._theme.paper), self._theme.pen(colour)
            return brush(colour), no_pen()

        if isinstance(dots.colour, str):
            return dict(zip(("brush", "pen"), look(dots.colour), strict=True))
        looks = {colour: look(colour) for colour in dict.fromkeys(dots.colour)}
        return {kind: [looks[colour][k] for colour in dots.colour] for k, kind in enumerate(("brush", "pen"))}

    def _add(self, item: QGraphicsItem, z: float) -> None:
        """Besides the curves, until something else is shown."""
        self._include(item, z)
        self._extra.append(item)

    def show_image(self, pixels: np.ndarray, place: QRectF) -> None:
        """Colours (n, m, 4) below the curves, in a rectangle in the numbers of the axes."""
        image = pg.ImageItem()
        image.setImage(pixels)
        image.setRect(place)
        self._add(image, Z_IMAGE)

    def across_at(self, place: QPoint) -> float:
        """Where a place of the widget [pixels] stands on the x axis."""
        return float(self._view.mapSceneToView(self.mapToScene(place)).x())

    def show_range(self, across: Ends | None = None, upwards: Ends | None = None) -> None:
        """Show no more and no less of the curves than this; None: what it is."""
        self._view.setRange(xRange=across, yRange=upwards, padding=0.0)
        self._lay()

    def show_ticks(self, across: Ticks, upwards: Ticks) -> None:
        """Number the axes by these in place of round numbers, until something else is shown."""
        self._ticks = across, upwards
        self._lay()

    def point_out(self, at: float | None) -> None:
        """A cursor at this place of the x axis; None: none."""
        if self._cursor is None and at is not None:
            self._cursor = Cursor(self._view, self._theme)
            self._span_cursor(self.frame())
        if self._cursor is not None:
            self._cursor.setVisible(at is not None and self._filled)
            if at is not None:
                self._cursor.setPos(at, 0.0)
        self._read_out()

    def _read_lines(self, lines: list[Line], rung: DisplayUnit) -> None:
        """From now on the values of these stand beside the cursor, and of no others."""
        self._valued, self.rung = lines, rung
        while len(self._readouts) > len(lines):
            self._readouts.pop().remove(self._view)
        while len(self._readouts) < len(lines):
            self._readouts.append(Readout(self._view, self._theme))
        for readout, line in zip(self._readouts, lines, strict=True):
            readout.set_colour(line.colour)

    def _read_out(self) -> None:
        """The values of the points nearest to the cursor."""
        at = self.cursor_at
        if at is None:
            for readout in self._readouts:
                readout.hide()
        elif self._valued:
            values = [float(line.y[np.argmin(np.abs(line.x - at))]) for line in self._valued]
            place_readouts(self._readouts, at, values, self.rung, self.frame())

    def readings(self) -> list[str]:
        """The texts beside the cursor, in the order of the curves that are read."""
        return [readout.tag.text for readout in self._readouts if readout.tag.isVisible()]

    def show_numbers(self, on: bool, title: str = "") -> None:
        """As of all plots; the title is that of ``name_axes``."""
        self._numbered = on
        super().show_numbers(on, title or (self._titles[0] if self._filled else ""))

    def _span_cursor(self, frame: Frame) -> None:
        if self._cursor is not None:
            self._cursor.span(frame.low, frame.high)

    def _speak(self) -> None:
        """What is drawn, in words."""
        across, upwards = self._titles
        quantity = upwards.rpartition(", ")[0] or upwards
        self.setAccessibleName(f"Plot of {quantity[:1].lower()}{quantity[1:]}" if quantity else "Plot")
        lines = [(line.label, line.x, line.y) for line in self.shown if self._filled]
        self.setAccessibleDescription(lines_words(lines, across, upwards) or self._message_text or NOTHING_DRAWN)

    def name_axes(self, across: str, upwards: str, colour: str = "") -> None:
        """The titles of the axes of what is shown next; colour: of the one upwards, ink where empty."""
        self._titles, self._title_colour = (across, upwards), self._theme.letters(colour) if colour else self._theme.ink

    def _colour(self, curve: PlotCurve, alone: bool) -> str:
        """That of its quantity; of none that of its row, ink where there is only one."""
        if curve.family:
            return self._theme.family(curve.family)
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
        self._read_lines([], NO_UNIT)
        self.point_out(None)
        self._name([])
        self._message_text = text
        self._speak()
        self._view.setRange(xRange=(0.0, 1.0), yRange=(0.0, 1.0), padding=0.0)
        self._lay()

    def _clear(self) -> None:
        for item in (*self._drawn, *self._extra, *(item for _, *items in self._ruled for item in items)):
            self._view.removeItem(item)
        self._drawn, self._extra, self._ruled, self._dots = [], [], [], ()
        self._ticks = None
        self._filled = False

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
        if self._alike and self._filled:
            self._one_scale()
        frame = self.frame()
        low, high = frame.first, frame.last
        whole = (low, high) == WHOLE_TURN
        across = angle_ticks(frame.width) if whole else value_ticks(low, high, frame.width, LEAST_ACROSS)
        upwards = value_ticks(frame.low, frame.high, frame.height)
        self.draw_axes(frame, *((self._ticks or (across, upwards)) if self._filled else ((), ())))
        self.name_below(self._titles[0] if self._filled and self._numbered else "")
        title = _fitting(self._titles[1], frame.height) if self._filled else ""
        self._axes["left"].show_title(title, self._title_colour)
        self._span_cursor(frame)
        for ruled in self._ruled:
            _stand(*ruled, frame)
        self._read_out()


def _stand(rule: Rule, line: Outline, tag: Tag, frame: Frame) -> None:
    """A rule over the whole plot, its text on the side of it where there is room."""
    path = QPainterPath()
    if rule.level:
        path.moveTo(frame.first, rule.at)
        path.lineTo(frame.last, rule.at)
        above = frame.height - frame.pixel(rule.at) > tag.size[1] + APART
        tag.set_lean(1.0, 1.0 if above else 0.0)
        tag.shift(-APART, -APART if above else APART)
        tag.setPos(frame.last, rule.at)
    else:
        path.moveTo(rule.at, frame.low)
        path.lineTo(rule.at, frame.high)
        right = (frame.last - rule.at) / (frame.last - frame.first) * frame.width > tag.size[0] + BESIDE
        tag.set_lean(0.0 if right else 1.0, 1.0 if rule.low else 0.0)
        tag.shift(4.0 if right else -4.0, -APART if rule.low else 2.0)
        tag.setPos(rule.at, frame.low if rule.low else frame.high)
    line.redraw(path)


def _fitting(title: str, height: float) -> str:
    """The title of an axis upwards, its unit alone where it is longer than the axis with what is free above it."""
    return title if text_size(title, TEXT)[0] <= height + sized(TOP_HEIGHT) else title.rpartition(", ")[2]


# -- contact map -----------------------------------------------------------------------------------------

RPM = math.pi / 30.0
FAINT, FULL = 0.06, 0.75  # opacity of no force, of the greatest
LOST = 0.3  # least opacity where the force is negative
ACROSS, UPWARDS = "Cam angle, °", "Camshaft speed, rpm"


def show_map(plot: XYPlot, found: ContactMap, own: float) -> None:
    """Blue where the cam presses the follower, vermilion where it would have to pull; the line between them, and the design's
    speed ``own`` [rpm]."""
    degrees, rpm = np.rad2deg(found.theta), found.omega / RPM
    top, step = float(rpm[-1]), float(rpm[-1]) / rpm.size
    lines = [Line(np.array(WHOLE_TURN), np.array([own, own]), SCREEN.ink, f"{short(own, 6)} rpm", DASHED)]
    for row, label in zip(found.zero / RPM, ("0 N", ""), strict=True):
        shown = np.where(row <= top, row, np.nan)
        if np.isfinite(shown).any():
            lines.append(Line(degrees, shown, VERMILION, label))
    peak = float(found.force.max())
    plot.name_axes(ACROSS, UPWARDS)
    plot.show_lines(lines, note=f"blue: up to {short(peak, 3)} N, orange: off the cam")
    low = float(rpm[0])
    plot.show_image(_coloured(found.force), QRectF(0.0, low - 0.5 * step, 360.0, top - low + step))
    plot.show_range(WHOLE_TURN, (0.0, top))


def _coloured(force: np.ndarray) -> np.ndarray:
    """Colours (n, m, 4) of forces (m, n): the stronger, the fuller."""
    most = float(np.abs(force).max()) or 1.0
    strength = np.sqrt(np.abs(force.T) / most)
    made = np.empty((*strength.shape, 4), dtype=np.ubyte)
    pressed, lost = (np.array(rgb(name), dtype=np.ubyte) for name in (BLUE, VERMILION))
    off = (force.T < 0.0)[..., None]
    made[..., :3] = np.where(off, lost, pressed)
    least = np.where(off[..., 0], LOST, FAINT)
    made[..., 3] = np.round(255.0 * (least + (FULL - least) * strength))
    return made


# -- under mouse -----------------------------------------------------------------------------------------

MACHINE_ANGLE, MACHINE_TIP = "Machine angle, °", "Click or drag to set the machine angle"


class UnderMouse:
    """What a plot does with the mouse; ``_go`` sets the angle by where the mouse is. The keys belong to the player."""

    _go: Any

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._go(event)
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._go(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        event.ignore()


class CursorPlot(UnderMouse, XYPlot):
    """Curves with a cursor, which a click or a drag moves; of one that only ``reads``, it stands where the mouse is.

    moved (float)   the user has clicked at, or drawn the cursor to, this place of the x axis
    read (object)   where the mouse is; None: elsewhere
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

    def _at(self, event: QMouseEvent) -> float:
        return float(self._view.mapSceneToView(self.mapToScene(event.position().toPoint())).x())

    def _go(self, event: QMouseEvent) -> None:
        if self._filled and not self._reads:
            frame = self.frame()
            self.moved.emit(min(max(self._at(event), frame.first), frame.last))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._reads:
            at, frame = self._at(event), self.frame()
            self._read(at if self._filled and frame.first <= at <= frame.last else None)
        else:
            super().mouseMoveEvent(event)

    def leaveEvent(self, event: QEvent) -> None:
        if self._reads:
            self._read(None)
        super().leaveEvent(event)

    def show_message(self, text: str) -> None:
        super().show_message(text)
        self.read.emit(None)

    def _read(self, at: float | None) -> None:
        self.point_out(at)
        self.read.emit(at)
