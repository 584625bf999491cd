"""Polar plot over the cam angle: the angle increases counter-clockwise, the value outwards."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt, Signal
from PySide6.QtGui import (
    QBrush,
    QColor,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPen,
    QPixmap,
    QPolygonF,
    QResizeEvent,
)
from PySide6.QtWidgets import QWidget

from core.design import motion_of
from core.motion.extremes import Extremes
from core.output.drawing.scales import decimals_of, needed, nice_step
from core.output.drawing.turn import peak, spans, typical_range
from core.plot import Span
from core.study import Quantity, Study
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.curves import NO_BANDS, PINNED, TurnCurves
from kindyna_gui.pictures.plots.lines import DASHED_MARK, band_entry, band_outlines, closed_band
from kindyna_gui.pictures.plots.marks import Extreme, PolarMark, both_ends, box_near, lay_polar_marks, paint_title
from kindyna_gui.pictures.plots.quantities import read_curves, reference_curves
from kindyna_gui.pictures.shapes import outline
from kindyna_gui.pictures.style import DASHED, SCREEN, SMALL, TEXT, THIN, Theme, brush, font
from kindyna_gui.pictures.units import number, readable
from kindyna_gui.settings import sized

HOLE = 0.16  # of the radius: size of the innermost circle where values may be negative
CIRCLE_PIXELS, MOST_CIRCLES = 30.0, 6  # least distance of circles, so that their texts do not touch
EDGE, TITLE = 32.0, 22.0  # pixels around the outer circle for angles, above it for the name
SPOKES = 30  # angle between two spokes, deg
TEXT_ANGLE = 15.0  # of the circles' texts, between two spokes, deg
HINTS = QPainter.RenderHint.Antialiasing | QPainter.RenderHint.TextAntialiasing


class PolarPlot(TurnCurves, QWidget):
    """Quantities of one unit over the cam angle, with a ray at the current angle.

    Signals
    -------
    angle_moved : the user has clicked at, or dragged the ray to, this cam angle [rad]

    Attributes
    ----------
    message : text shown where nothing is drawn
    circles : values whose circles are drawn
    """

    angle_moved = Signal(float)

    def __init__(self, parent: QWidget | None = None, theme: Theme = SCREEN) -> None:
        super().__init__(parent)
        self._theme = theme
        self._rows: list[tuple[Quantity, np.ndarray, str]] = []
        self._shaded: list[tuple[np.ndarray, np.ndarray, str]] = []
        self._dashed: list[tuple[np.ndarray, np.ndarray, str]] = []  # values and angles of the reference, and colour
        self._reference_name = ""
        self._spans: list[Span] = []
        self.message = ""
        self._marks: list[PolarMark] | None = None
        self._range = (0.0, 1.0)
        self._low, self._high, self.circles, self._step = 0.0, 1.0, [0.0, 1.0], 1.0
        self._paths: list[QPainterPath] | None = None
        self._pixmap: QPixmap | None = None
        self.setMinimumSize(120, 120)

    # -- curves -------------------------------------------------------------------------------------------

    def set_curves(
        self,
        study: Study,
        channels: Sequence[Quantity],
        *,
        reference: Study | None = None,
        bands: Mapping[str, np.ndarray] = NO_BANDS,
        reference_name: str = PINNED,
    ) -> None:
        """Draw quantities of a study.

        Parameters
        ----------
        study : Study
        channels : sequence of Quantity, of one unit
        reference : Study, optional
            A second study, drawn dashed.
        bands : mapping of str to ndarray (5, n)
            Column of a channel -> percentiles of the machines at equal steps over the turn, drawn as shaded bands.
        reference_name : str
            Name of the reference.

        Raises
        ------
        NoSolution
            Where a quantity has no solution.
        """
        self._curves = read_curves(study, channels, self._theme)
        shaded = [(curve, bands[curve.channel.slug]) for curve in self._curves if curve.channel.slug in bands]
        dashed = reference_curves(reference, self._curves)
        values = [
            *(curve.values for curve in (*self._curves, *dashed)),
            *(band[i] for _, band in shaded for i in (0, -1)),
        ]
        self.display_unit = readable(channels[0].unit.symbol, peak(values))
        shown = [v / self.display_unit.size for v in values]
        ranges = [typical_range(v) for v in shown]
        self._range = (min(0.0, *(low for low, _ in ranges)), max(0.0, *(high for _, high in ranges)))
        self._scale()
        self._theta, self._is_full_turn = study.theta, study.theta.size == study.samples
        colours = [self._theme.quiet if curve.channel.approximates else curve.colour for curve in self._curves]
        self._rows = list(zip(channels, shown[: len(channels)], colours, strict=True))
        self._shaded = [
            (*closed_band(band / self.display_unit.size, curve.gain / self.display_unit.size), curve.colour)
            for curve, band in shaded
        ]
        shown_reference = [row.values / self.display_unit.size for row in dashed]
        theta = self._theta if reference is None else reference.theta
        self._dashed = [(row, theta, curve.colour) for row, curve in zip(shown_reference, dashed, strict=True)]
        self._reference_name = reference_name if dashed else ""
        self._spans, self.message, self._paths = spans(motion_of(study.design)), "", None
        self._ranges = self._marks = self._pixmap = self._exact_values = None
        self.update()

    def update_style(self) -> None:
        """Lay out again after a change of theme or font size; the view sets the curves again."""
        self._marks = self._paths = self._pixmap = None
        self._scale()
        self.update()

    def show_message(self, text: str) -> None:
        """Show only a text, such as the input that is missing."""
        self._rows, self._curves, self._shaded, self._dashed, self._spans, self.message = [], [], [], [], [], text
        self._ranges = self._marks = self._paths = self._pixmap = None
        self.update()

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        """Mark the highest and lowest value of each curve (by quantity, in SI); None: mark none."""
        self._ranges = extremes
        self._marks = self._pixmap = None
        self.update()

    def marked(self) -> list[Extreme]:
        """Extremes that are marked, in the unit of the circles."""
        ends = [
            (curve, (self._ranges or {}).get(curve.channel.name))
            for curve in self._curves
            if not curve.channel.approximates
        ]
        return [
            row for curve, pair in ends if pair for row in both_ends(curve, curve.ends(pair), self.display_unit.size)
        ]

    def _scale(self) -> None:
        """Choose round values for the circles; where none is negative the centre is 0, so that shapes are true."""
        low, high = self._range
        if high == low:
            high = low + 1.0
        room = self.radius * (1.0 - HOLE if low < 0.0 else 1.0)
        most = min(max(int(room / sized(CIRCLE_PIXELS)), 1), MOST_CIRCLES)
        self._step = nice_step(high - low, most)
        first, last = math.floor(low / self._step + 1e-9), math.ceil(high / self._step - 1e-9)
        self.circles = [self._step * i for i in range(first, last + 1)]
        self._low, self._high = self.circles[0], self.circles[-1]

    def _show_values(self) -> None:
        self.update()

    # -- geometry -----------------------------------------------------------------------------------------

    @property
    def centre(self) -> QPointF:
        """Centre of the circles [pixels]."""
        return QPointF(self.width() / 2.0, (self.height() + sized(TITLE)) / 2.0)

    @property
    def radius(self) -> float:
        """Radius of the outermost circle [pixels]."""
        return max(10.0, min(self.width() / 2.0, (self.height() - sized(TITLE)) / 2.0) - sized(EDGE))

    def distance(self, value: float) -> float:
        """Radius of a value's circle [pixels]."""
        hole = HOLE if self._low < 0.0 else 0.0
        part = (min(max(value, self._low), self._high) - self._low) / (self._high - self._low)
        return self.radius * (hole + (1.0 - hole) * part)

    def position(self, angle: float, distance: float) -> QPointF:
        """Pixel at a cam angle [deg] and a distance from the centre [pixels]."""
        turn = math.radians(angle)
        return self.centre + QPointF(distance * math.cos(turn), -distance * math.sin(turn))

    def angle_at(self, pixel: QPointF) -> float:
        """Cam angle [deg] at a pixel of the widget."""
        away = pixel - self.centre
        return math.degrees(math.atan2(-away.y(), away.x())) % 360.0

    # -- painting -----------------------------------------------------------------------------------------

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._scale()
        self._paths = self._marks = self._pixmap = None

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        if not self._with_cursor:
            self._paint_background(painter)
        else:  # on the screen the ray moves over cached pixels
            if self._pixmap is None or self._pixmap.devicePixelRatio() != self.devicePixelRatioF():
                self._pixmap = QPixmap(self.size() * self.devicePixelRatioF())
                self._pixmap.setDevicePixelRatio(self.devicePixelRatioF())
                pixels = QPainter(self._pixmap)
                self._paint_background(pixels)
                pixels.end()
            painter.drawPixmap(0, 0, self._pixmap)
            painter.setRenderHints(HINTS)
            if self._rows:
                self._paint_cursor(painter)
        painter.end()

    def _paint_background(self, painter: QPainter) -> None:
        """Paint everything except the ray and its values."""
        painter.setRenderHints(HINTS)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        if self._rows:
            self._paint_axes(painter)
            for path, fill in self.areas:
                painter.fillPath(path, fill)
            for path, (_, _, colour) in zip(self.references, self._dashed, strict=True):
                painter.setPen(self._theme.pen(colour, THIN, DASHED))
                painter.drawPath(path)
            for path, (_, _, colour) in zip(self.paths, self._rows, strict=True):
                painter.setPen(self._theme.pen(colour, THIN))
                painter.drawPath(path)
            for mark in self.marks:
                mark.paint(painter, self._theme)
            names = [(row.label, self._theme.text_colour(colour)) for row, _, colour in self._rows]
            if self._dashed:
                names.append((f"{DASHED_MARK} {self._reference_name}", self._theme.quiet))
            if self._shaded:
                names.append((band_entry(self._theme).name, self._theme.quiet))
            paint_title(painter, names, self.display_unit.symbol, self._theme.ink, self.width())
        else:
            painter.setFont(font(TEXT))
            painter.setPen(QColor(self._theme.quiet))
            room = self.rect().adjusted(16, 16, -16, -16)
            painter.drawText(room, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, self.message)

    def _paint_axes(self, painter: QPainter) -> None:
        """Paint segments, circles, spokes and their texts."""
        theme, centre, radius = self._theme, self.centre, self.radius
        inner = self.distance(self._low)
        painter.setPen(Qt.PenStyle.NoPen)
        for span in self._spans[1::2]:
            path = QPainterPath(centre)
            box = QRectF(centre.x() - radius, centre.y() - radius, 2.0 * radius, 2.0 * radius)
            path.arcTo(box, span.start, span.end - span.start)
            path.closeSubpath()
            painter.fillPath(path, brush(theme.band))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        faint, zero = theme.pen(theme.faint), QPen(QColor(theme.quiet), THIN)
        for value in self.circles:
            painter.setPen(zero if value == 0.0 or value == self.circles[-1] else faint)
            painter.drawEllipse(centre, self.distance(value), self.distance(value))
        painter.setPen(faint)
        for angle in range(0, 360, SPOKES):
            painter.drawLine(self.position(angle, inner), self.position(angle, radius))
        painter.setFont(font(SMALL))
        painter.setPen(QColor(theme.ink))
        for text, box in self.texts():
            painter.fillRect(box, QColor(theme.paper))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def texts(self) -> list[tuple[str, QRectF]]:
        """Angles around the circles and values on them, with their boxes [pixels]."""
        rows = [(f"{angle}°", self.position(angle, self.radius + 14.0)) for angle in range(0, 360, SPOKES)]
        for value in self.circles:
            if self.distance(value) > 0.0:
                point = self.position(TEXT_ANGLE, self.distance(value))
                rows.append((number(value, decimals_of(self._step)), point))
        result = []
        for text, point in rows:
            width, height = text_size(text)
            box = QRectF(0.0, 0.0, width + 4.0, height)
            box.moveCenter(point)
            result.append((text, box))
        return result

    @property
    def paths(self) -> list[QPainterPath]:
        """Lines of the curves [pixels]."""
        if self._paths is None:
            self._paths = [self._curve(values) for _, values, _ in self._rows]
        return self._paths

    @property
    def marks(self) -> list[PolarMark]:
        """Dots and texts of the extremes."""
        if self._marks is None:
            curves = [self._points(values) for _, values, _ in self._rows]
            curves += [self._points(values, theta) for values, theta, _ in self._dashed]
            self._marks = lay_polar_marks(
                self.marked(),
                lambda extreme: self.position(extreme.angle, self.distance(extreme.value)),
                (self._low, self._high),
                curves,
                [box for _, box in self.texts()],
                QRectF(self.rect()).adjusted(0.0, sized(TITLE), 0.0, 0.0),
            )
        return self._marks

    @property
    def references(self) -> list[QPainterPath]:
        """Dashed lines of the reference [pixels]."""
        return [self._curve(values, theta) for values, theta, _ in self._dashed]

    @property
    def bands(self) -> list[np.ndarray]:
        """Percentiles (5, n + 1) of the bands that are shaded, in the unit of the circles."""
        return [band for _, band, _ in self._shaded]

    @property
    def areas(self) -> list[tuple[QPainterPath, QBrush]]:
        """Outlines of the shaded bands [pixels], with their fills."""
        return [
            (outline(self._points(values, np.deg2rad(angles))), brush(colour, opacity))
            for x, band, colour in self._shaded
            for angles, values, opacity in band_outlines(x, band)
        ]

    def _points(self, values: np.ndarray, theta: np.ndarray | None = None) -> np.ndarray:
        """Points (n,) x + iy [pixels] of values (n,) at the study's angles, or at given angles [rad]."""
        hole = HOLE if self._low < 0.0 else 0.0
        part = (np.clip(values, self._low, self._high) - self._low) / (self._high - self._low)
        away = self.radius * (hole + (1.0 - hole) * part)
        return np.asarray(
            away * np.exp(-1j * (self._theta if theta is None else theta)) + complex(self.centre.x(), self.centre.y())
        )

    def _curve(self, values: np.ndarray, theta: np.ndarray | None = None) -> QPainterPath:
        """One closed line, interrupted where a value is infinite; at the study's angles, or at given angles [rad]."""
        points = self._points(values, theta)
        finite = np.isfinite(values)
        if finite.all() and self._is_full_turn:
            closed = np.append(points, points[:1])
            return outline(closed[needed(closed, self.unseen / self.devicePixelRatioF())[:-1]])
        path = QPainterPath()
        for run in np.split(np.arange(values.size), np.flatnonzero(np.diff(finite)) + 1):
            if finite[run[0]]:
                path.addPolygon(QPolygonF([QPointF(p.real, p.imag) for p in points[run].tolist()]))
        return path

    def readouts(self) -> list[tuple[str, QRectF]]:
        """Values at the ray and their boxes [pixels]: inwards and, where there is room, clear of all other texts."""
        left, occupied, room = math.cos(self._angle) > 0.0, [box for _, box in self.texts()], QRectF(self.rect())
        occupied += [mark.box for mark in self.marks]
        result = []
        for value, text in zip(self._values_at_cursor(), self.readings(), strict=True):
            width, height = text_size(text)
            box = box_near(self._on_ray(value), QSizeF(width + 6.0, height), left, occupied, room)
            occupied.append(box)
            result.append((text, box))
        return result

    def _on_ray(self, value: float) -> QPointF:
        """Pixel of a value on the ray; on the outermost circle where it is infinite."""
        return self.position(math.degrees(self._angle), self.distance(value if math.isfinite(value) else self._high))

    def _paint_cursor(self, painter: QPainter) -> None:
        theme, angle = self._theme, math.degrees(self._angle)
        painter.setPen(theme.pen(theme.quiet))
        painter.drawLine(self.position(angle, self.distance(self._low)), self.position(angle, self.radius))
        painter.setFont(font(SMALL))
        readouts = zip(self._values_at_cursor(), self.readouts(), self._rows, strict=True)
        for value, (text, box), (_, _, colour) in readouts:
            if math.isfinite(value):
                painter.setPen(QPen(QColor(theme.paper), THIN))
                painter.setBrush(QColor(colour))
                painter.drawEllipse(self._on_ray(value), 3.5, 3.5)
                painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.fillRect(box, brush(theme.paper, 0.85))
            painter.setPen(QColor(theme.text_colour(colour)))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


__all__ = ["PolarPlot"]
