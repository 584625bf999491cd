"""Plot of quantities over one turn of the cam, with segments, limits, extremes, bands and a cursor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import ceil, degrees, floor, log2, radians
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QAccessible, QPen
from PySide6.QtWidgets import QWidget

from core.design import motion_of
from core.design.fields import in_sentence
from core.motion.extremes import Extremes
from core.output.drawing.scales import DisplayUnit
from core.output.drawing.turn import (
    FREE,
    TurnSamples,
    axis_range,
    line_of,
    moving,
    readable_range,
    spans,
    typical_range,
)
from core.plot import Span
from core.study import Quantity, Study
from core.study.quantities import TRANSMISSION, shape_of
from kindyna_gui.pictures.items import Outline
from kindyna_gui.pictures.plots.lines import (
    DASHED_MARK,
    LINE_MARK,
    Z_CURVE,
    Z_REFERENCE,
    Cursor,
    CurveLine,
    Entry,
    Frame,
    LimitLine,
    band_entry,
    band_items,
    closed_band,
    reference_entry,
)
from kindyna_gui.pictures.plots.marks import Extreme, ExtremeMark, Readout, both_ends, lay_marks, place_readouts
from kindyna_gui.pictures.plots.plot import FixedPlot, angle_ticks, fitting_title, name_ticks, value_ticks
from kindyna_gui.pictures.plots.quantities import Curve, drawn_alike, limits_of, read_curves, reference_curves
from kindyna_gui.pictures.style import DASHED, SCREEN, THIN, Theme
from kindyna_gui.pictures.units import curve_words, legible, measure, nearest, readable, short, with_unit
from kindyna_gui.settings import point, sized, symbol_of

PINNED = "pinned variant"
UNNAMED = 4  # height of the axis at the top without names, pixels
ALWAYS_DRAWN = ("cam.material", "limits.contact_pressure_mpa")  # fields of limits that the axis always shows
STEPS = 6  # power of two of the steps, by whose number the range of an axis is divided at least
MOST_FREE = 0.13  # of the height, for the texts of extremes
NO_BANDS: Mapping[str, np.ndarray] = MappingProxyType({})
CLIP_RANGES = 50.0  # values are cut off at so many ranges of the axis beyond its ends


class TurnCurves:
    """Rows of a plot over one turn, straight or polar: curves of one unit, their extremes, their values at the cursor.

    Attributes
    ----------
    unseen : error of a curve that is allowed where it saves points [pixels]; 0 on paper
    display_unit : unit that the values are shown in
    angle_moved : signal (float), the user has set the cam angle [rad]
    angle_at : method that returns the cam angle [deg] at a pixel of the widget
    """

    unseen = 0.0
    display_unit = DisplayUnit("", 1.0, 0.0)
    angle_moved: Any
    angle_at: Callable[[QPointF], float]
    _curves: Sequence[Curve] = ()
    _theta = np.zeros(0)
    _angle, _with_cursor = 0.0, True
    _exact_values: Sequence[float] | None = None
    _ranges: Mapping[str, Extremes] | None = None

    @property
    def lacks_extremes(self) -> bool:
        """Whether the extremes of the current curves have not been shown yet."""
        return bool(self._curves) and self._ranges is None

    @property
    def angle(self) -> float:
        """Cam angle of the cursor [rad]."""
        return self._angle

    def set_angle(self, theta: float, at_angle: Study | None = None) -> None:
        """Move the cursor to a cam angle.

        Parameters
        ----------
        theta : float [rad]
        at_angle : Study, optional
            The same study evaluated at this angle, for exact values; else those of the nearest sample are shown.
        """
        self._angle = theta
        is_sample = bool(self._curves) and self._theta[nearest(self._theta, theta)] == theta
        self._exact_values = (
            None
            if at_angle is None or is_sample
            else [float(curve.channel.values(at_angle)[0]) for curve in self._curves]
        )
        self._show_values()

    def set_angle_at(self, pixel: QPointF) -> None:
        """Report that the user has set the cam angle at a pixel of the widget, where there is a curve."""
        if self._curves:
            self.angle_moved.emit(radians(self.angle_at(pixel)))

    def show_cursor(self, shown: bool) -> None:
        """Show or hide the cursor and its values; images on paper have none."""
        if shown != self._with_cursor:
            self._with_cursor = shown
            self._show_values()

    def _show_values(self) -> None:
        """Draw the cursor, and the values next to it."""
        raise NotImplementedError

    def _values_at_cursor(self) -> list[float]:
        """Values of the curves at the cursor, in the unit of the axis."""
        at = nearest(self._theta, self._angle) if self._curves else 0
        values = self._exact_values or [float(curve.values[at]) for curve in self._curves]
        rows = zip(self._curves, values, strict=True)
        return [curve.shown(value, self.display_unit.size) for curve, value in rows]

    def readings(self) -> list[str]:
        """Texts at the cursor, in the order of the curves."""
        return [measure(value, self.display_unit.symbol) for value in self._values_at_cursor()]


class CurvePlot(TurnCurves, FixedPlot):
    """Quantities of one unit over the cam angle, 0 ... 360°, with a cursor.

    Parameters
    ----------
    names, angles : whether the segments' names are shown along the top, and the angle's numbers along the bottom;
        in a stack the uppermost plot shows the names and the lowest the numbers

    Attributes
    ----------
    text_room : room left free above and below the curves, for the texts of extremes [pixels]
    """

    text_room = 0.0

    def __init__(
        self, parent: QWidget | None = None, *, names: bool = True, angles: bool = True, theme: Theme = SCREEN
    ) -> None:
        self._named = names
        super().__init__(parent, theme, top=True)
        self._axes["top"].setStyle(showValues=names)
        self.show_numbers(angles, angle_title("cam angle"))
        self._cursor = Cursor(self._view, theme)
        self._spans: list[Span] = []
        self._samples: TurnSamples | None = None
        self._reference_curves: list[Curve] = []
        self._reference_samples: TurnSamples | None = None
        self._readings: list[Readout] = []
        self._limits: list[LimitLine] = []
        self._reference_name = ""
        self._drawn: list[CurveLine] = []
        self._bands: list[Outline] = []
        self._drawn_bands: Sequence[tuple[Curve, np.ndarray]] = ()
        self._drawn_marks: tuple[object, ...] = ()
        self._request: tuple[Study, tuple[Quantity, ...], Study | None, Mapping[str, np.ndarray]] | None = None
        self._core: tuple[float, float] | None = None  # the range that the axis must show at least
        self._shows_spikes = self._has_spikes = False
        self._extremes: list[Extreme] = []
        self._extreme_marks: list[ExtremeMark] = []
        self._spare_marks: list[ExtremeMark] = []  # hidden until extremes are known again, after each edit
        self._boxes: list[QRectF] = []
        self._background_state: tuple[object, ...] = ()
        self.show_message("")

    def _size_axes(self) -> None:
        super()._size_axes()
        if not self._named:
            self._axes["top"].setHeight(UNNAMED)

    def _draw_in_style(self) -> None:
        self._background_state = ()
        if self._curves:
            self.draw_again()
        else:
            self._lay()

    def cache_axes(self) -> None:
        """Cache the axes as pixels, so that the cursor moves over them without drawing them again."""
        for axis in self._axes.values():
            axis.setCacheMode(axis.CacheMode.DeviceCoordinateCache)
            axis.label.setCacheMode(axis.CacheMode.DeviceCoordinateCache)

    # -- curves ---------------------------------------------------------------------------------------------

    def set_curves(
        self,
        study: Study,
        channels: Sequence[Quantity],
        reference: Study | None = None,
        read: bool = True,
        bands: Mapping[str, np.ndarray] = NO_BANDS,
        reference_name: str = PINNED,
    ) -> None:
        """Draw quantities of a study; nothing is painted again where the plot would not change.

        Parameters
        ----------
        study : Study
        channels : sequence of Quantity, of one unit
        reference : Study, optional
            A second study, drawn dashed.
        read : bool
            Write the values at the cursor; False where ``set_angle`` follows at once.
        bands : mapping of str to ndarray (5, n)
            Column of a channel -> percentiles of the machines at equal steps over the turn, drawn as shaded bands.
        reference_name : str
            Name of the reference in the legend.

        Raises
        ------
        NoSolution
            Where a quantity has no solution.
        """
        self.name_angle(study)
        curves = read_curves(study, channels, self._theme)
        dashed = reference_curves(reference, curves)
        segments, limits = spans(motion_of(study.design)), limits_of(study, channels)
        name = reference_name if dashed else ""
        marks = (tuple(segments), tuple(limits), symbol_of(channels[0].unit.symbol), point(), name)
        samples = line_of(study)
        shaded = [(curve, bands[curve.channel.slug]) for curve in curves if curve.channel.slug in bands]
        reference_samples = line_of(reference) if reference is not None and dashed else None
        if (
            marks == self._drawn_marks
            and [id(band) for _, band in shaded] == [id(band) for _, band in self._drawn_bands]
            and samples.alike(self._samples)
            and drawn_alike(curves, self._curves)
            and drawn_alike(dashed, self._reference_curves)
            and (reference_samples is None or reference_samples.alike(self._reference_samples))
        ):
            return
        self._drawn_marks, self._reference_curves, self._reference_samples = marks, dashed, reference_samples
        self._curves, self._spans, self._message_text, self._exact_values = curves, segments, "", None
        self._samples, self._theta = samples, study.theta
        self._request, self._ranges = (study, tuple(channels), reference, bands), None
        values = [curve.values for curve in curves + dashed]
        values += [band[i] for _, band in shaded for i in (0, -1)]
        full_ranges = [typical_range(row) for row in values]
        moves = [moving(study)] * len(curves) + [moving(reference) for _ in dashed if reference is not None]
        moves += [np.ones(band.shape[-1], dtype=bool) for _, band in shaded for _ in (0, 1)]
        ranges_without_spikes = [readable_range(row, at) for row, at in zip(values, moves, strict=True)]
        self._has_spikes = ranges_without_spikes != full_ranges
        ranges = full_ranges if self._shows_spikes else ranges_without_spikes
        self.display_unit = readable(curves[0].channel.unit.symbol, max(abs(end) for ends in ranges for end in ends))
        size = self.display_unit.size
        drawn = [(value, value) for value, (_, _, field) in limits if field in ALWAYS_DRAWN]
        self._core = axis_range(
            [(low / size, high / size) for low, high in [*ranges, *drawn]],
            {row.family for row in channels},
            [value / size for value, _ in limits],
            free=0.0,
        )
        low, high = self._reach(self._core)
        rows = [(curve, samples, Z_CURVE, DASHED if curve.channel.approximates else ()) for curve in curves]
        if reference_samples is not None:
            rows += [(curve, reference_samples, Z_REFERENCE, DASHED) for curve in dashed]
        self._drawn = self._resized(self._drawn, len(rows), lambda: CurveLine(self._view))
        for item, (curve, along, z, dash) in zip(self._drawn, rows, strict=True):
            self._draw(item, curve, along, z, self._theme.pen(curve.colour, THIN, dash))
        self._shade(shaded)
        self._readings = self._resized(self._readings, len(curves), lambda: Readout(self._view, self._theme))
        for reading, curve in zip(self._readings, curves, strict=True):
            reading.set_colour(curve.colour)
        shown = [(value / size, *words) for value, words in limits if low <= value / size <= high]
        self._limits = self._resized(self._limits, len(shown), lambda: LimitLine(self._view, self._theme))
        for limit, (value, text, brief, field) in zip(self._limits, shown, strict=True):
            figure = with_unit(short(value, 4), self.display_unit.symbol)
            limit.set_value(value, text.format(figure), (brief, brief.rpartition(": ")[2], figure), field)
        self._reference_name, self._listed = name, {}
        self._name_curves()
        self._find_extremes()
        self._lay_out()
        if QAccessible.isActive():
            self._describe()
        if read:
            self._write()

    @property
    def has_spikes(self) -> bool:
        """Whether some values are so large that the axis ends before them, unless spikes are shown."""
        return self._has_spikes and bool(self._curves)

    def show_spikes(self, on: bool) -> None:
        """Extend the axis to all values, or cut spikes off and mark each by an arrow at the edge."""
        if on != self._shows_spikes:
            self._shows_spikes = on
            self.draw_again()

    def draw_again(self) -> None:
        """Draw the same curves again, on an axis fitted to the current settings."""
        ranges = self._ranges
        if self._curves and self._request is not None:
            self._drawn_marks = ()
            study, channels, reference, bands = self._request
            self.set_curves(study, channels, reference, bands=bands, reference_name=self._reference_name)
            self.show_extremes(ranges)

    # -- extremes -------------------------------------------------------------------------------------------

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        """Mark the highest and lowest value of each curve (by quantity, in SI); None: only spikes that are cut off."""
        self._ranges = extremes
        self._find_extremes()
        self._describe()
        self._lay_out()
        self._write()

    def _describe(self) -> None:
        """Set name and description for screen readers."""
        labels = ", ".join(in_sentence(curve.channel.label) for curve in self._curves)
        self.describe(f"Plot of {labels or 'nothing'}", self.description())

    def marked(self) -> list[Extreme]:
        """Extremes that are marked, in the unit of the axis."""
        return [mark.extreme for mark in self._extreme_marks]

    def _reach(self, core: tuple[float, float]) -> tuple[float, float]:
        """Set the axis to these values, with room for a text above and below; returns the range shown.

        Its ends are at whole steps, so that small edits leave it: a new range draws the axis and all curves again.
        """
        part = min(sized(self.text_room) / max(self._view.height(), 1.0), MOST_FREE)
        size = core[1] - core[0]
        room = max(FREE, part / (1.0 - 2.0 * part)) * size
        step = 2.0 ** (floor(log2(size)) - STEPS)
        shown = (step * floor((core[0] - room) / step), step * ceil((core[1] + room) / step))
        if tuple(self._view.viewRange()[1]) != shown:
            self._view.setRange(yRange=shown, padding=0.0)
        return shown

    def _find_extremes(self) -> None:
        (low, high), size = self._view.viewRange()[1], self.display_unit.size
        rows = []
        for curve in self._curves:
            if curve.channel.approximates:
                continue
            ends, refined = self._ends(curve)
            extremes = both_ends(curve, ends, size, refined)
            rows += [extreme for extreme in extremes if extreme.refined or not low <= extreme.value <= high]
        self._extremes = rows

    def description(self) -> str:
        """The curves in words: the range of each, and the angle of its largest value."""
        rows = []
        for curve in self._curves:
            ends, _ = self._ends(curve)
            low, high = (value / self.display_unit.size for _, value in ends)
            angle, _ = max(ends, key=lambda end: abs(end[1]))
            rows.append(curve_words(in_sentence(curve.channel.label), self.display_unit.symbol, low, high, angle, "°"))
        return "; ".join(rows)

    def _ends(self, curve: Curve) -> tuple[list[tuple[float, float]], bool]:
        """Lowest and highest value, (angle [deg], value), and whether they are refined, else of the samples."""
        extremes = (self._ranges or {}).get(curve.channel.name)
        if extremes is not None:
            return curve.ends(extremes), True
        values = np.where(np.isnan(curve.values), 0.0, curve.values)
        indices = (int(values.argmin()), int(values.argmax()))
        return [(degrees(self._theta[i]), float(values[i])) for i in indices], False

    def name_angle(self, study: Study) -> None:
        """Name the angle below by the study's driver, with curves or only a message in the plot."""
        self.name_below(angle_title(study.angle_name))

    def show_angles(self, on: bool) -> None:
        """Show numbers and name of the angle below, or neither."""
        self.show_numbers(on, self._title_below)

    def show_message(self, text: str) -> None:
        """Show only a text in the middle, such as the input that is missing."""
        self._drawn, self._readings, self._limits = (
            self._resized(pool, 0, list) for pool in (self._drawn, self._readings, self._limits)
        )
        self._extremes = []
        self._shade([])
        self._curves, self._reference_curves, self._spans, self._drawn_marks, self._exact_values = [], [], [], (), None
        self._reference_name, self._listed = "", {}
        self._name_curves()
        self._axes["left"].show_title("", self._theme.ink)
        self._message_text, self._core = text, None
        self._view.setRange(yRange=(0.0, 1.0), padding=0.0)
        self._describe()
        self._lay()

    def _shade(self, bands: Sequence[tuple[Curve, np.ndarray]]) -> None:
        """Shade each band (5, n): faintly between its outer percentiles, more strongly between its inner ones."""
        self._drawn_bands = bands
        for item in self._bands:
            self._view.removeItem(item)
        self._bands = []
        for curve, rows in bands:
            angles, band = closed_band(rows, curve.gain)
            for item in band_items(angles, self._clipped(band / self.display_unit.size), curve.colour):
                self._view.addItem(item, ignoreBounds=True)
                self._bands.append(item)

    @property
    def bands(self) -> list[np.ndarray]:
        """Percentiles (5, n) of the bands that are shaded."""
        return [rows for _, rows in self._drawn_bands]

    def _draw(self, item: CurveLine, curve: Curve, along: TurnSamples, z: float, pen: QPen) -> None:
        values = along.of(curve.values, curve.gain) / self.display_unit.size
        finite = np.isfinite(values)
        if self._has_spikes or not finite.all():
            values = np.where(finite, self._clipped(values), np.nan)
        item.show_points(along.angles, values, pen, z)

    def _clipped(self, values: np.ndarray) -> np.ndarray:
        """Values (n,) cut off far beyond the ends of the axis."""
        low, high = self._view.viewRange()[1]
        room = CLIP_RANGES * (high - low)
        return np.clip(values, low - room, high + room)

    def _name_curves(self) -> None:
        """Name the curves above the plot where there is more than one, and limits whose texts have no room in it."""
        others = [reference_entry(self._reference_name, self._theme)] if self._reference_name else []
        others += [band_entry(self._theme)] if self._drawn_bands else []
        others += self._listed.values()
        marks = [DASHED_MARK if curve.channel.approximates else "—" for curve in self._curves]
        rows = [Entry(c.colour, c.channel.label, mark) for c, mark in zip(self._curves, marks, strict=True)]
        self._name([*rows, *others] if len(rows) > 1 or others else [])

    def angle_at(self, pixel: QPointF) -> float:
        """Cam angle [deg] at a pixel of the widget, limited to 0 ... 360."""
        return min(max(self.to_axes(pixel).x(), 0.0), 360.0)

    # -- cursor ---------------------------------------------------------------------------------------------

    def _show_values(self) -> None:
        self._cursor.setPos(degrees(self._angle), 0.0)
        self._write()

    def _write(self) -> None:
        """Write the values next to the cursor."""
        self._cursor.setVisible(self._with_cursor and bool(self._curves))
        written: list[QRectF] = []
        if not self._with_cursor:
            for reading in self._readings:
                reading.hide()
        elif self._readings:
            written = place_readouts(
                self._readings,
                degrees(self._angle),
                self._values_at_cursor(),
                self.display_unit,
                self.frame(),
                self._boxes,
            )
        for mark in self._extreme_marks:  # in a low plot the values at the cursor may need the room of these texts
            mark.give_way(written)

    # -- layout ---------------------------------------------------------------------------------------------

    def _lay(self, *_: object) -> None:
        if self._core is not None:
            self._reach(self._core)
        self._lay_out()
        self._write()

    def _lay_out(self) -> None:
        frame = self.frame()
        unseen = self.unseen / self.devicePixelRatioF()
        for curve in self._drawn:
            curve.lay(frame, unseen)
        self._lay_limits(frame)
        self._lay_extremes(frame)
        if self._curves:
            self._axes["left"].show_title(self._title(frame.height), self._title_colour())
        state = (frame, tuple(self._spans), bool(self._curves), self._message_text)
        if state != self._background_state:
            self._background_state = state
            values = value_ticks(frame.low, frame.high, frame.height) if self._curves else []
            self.draw_axes(frame, angle_ticks(frame.width), values, self._spans)
            self._cursor.span(frame)
            self._axes["top"].show_ticks(self._names(frame.width) if self._named else [])
        self.scene().prepareForPaint()  # else the transformation follows in the paint event and causes another

    def _lay_limits(self, frame: Frame) -> None:
        """Put the texts of limits clear of curves, else in the legend, where they stay at this size."""
        before = list(self._listed)
        self._forget_listed(frame)
        for number, limit in enumerate(self._limits):
            occupied = [previous.box(frame) for previous in self._limits[:number]]
            if limit.text in self._listed or not limit.lay_clear(frame, self._drawn, occupied):
                limit.hide_text()
                self._listed[limit.text] = Entry(self._theme.limit, limit.name, LINE_MARK)
        if list(self._listed) != before:
            self._name_curves()

    def _lay_extremes(self, frame: Frame) -> None:
        marks, count = self._extreme_marks + self._spare_marks, len(self._extremes)
        marks += [ExtremeMark(self._view, self._theme) for _ in range(count - len(marks))]
        self._extreme_marks, self._spare_marks = marks[:count], marks[count:]
        for mark in self._spare_marks:
            mark.hide()
        for mark, extreme in zip(self._extreme_marks, self._extremes, strict=True):
            mark.show(extreme, frame)
        occupied = self._covered(frame) + [limit.box(frame) for limit in self._limits]
        self._boxes = occupied + lay_marks(self._extreme_marks, frame, occupied, self._drawn)

    def _covered(self, frame: Frame) -> list[QRectF]:
        """Boxes of the frame that something else covers [pixels from its lower left corner, y upwards]."""
        return []

    def is_spike_at(self, pixel: QPointF) -> bool:
        """Whether the arrow of a value that is cut off, or its text, is at a pixel of the widget."""
        frame, at = self.frame(), self._in_frame(pixel)
        return any(
            mark.outside and (mark.sign_box(frame) | mark.box(frame)).contains(at) for mark in self._extreme_marks
        )

    def limit_at(self, pixel: QPointF) -> str:
        """Path of the limit whose text is at a pixel of the widget; empty where there is none."""
        frame, at = self.frame(), self._in_frame(pixel)
        return next((limit.field for limit in self._limits if limit.box(frame).contains(at)), "")

    def _in_frame(self, pixel: QPointF) -> QPointF:
        """Pixel of the widget, from the lower left corner of the frame, y upwards."""
        corner = self.mapFromScene(self._view.sceneBoundingRect().bottomLeft())
        return QPointF(pixel.x() - corner.x(), corner.y() - pixel.y())

    def _names(self, width: float) -> list[tuple[float, str]]:
        """Ticks along the top: middles [deg] and names of the segments."""
        return name_ticks(self._spans, width)

    def _title(self, height: float) -> str:
        """Quantity and unit, shortened to the height of the axis [pixels]."""
        row, unit = self._curves[0].channel, self.display_unit.symbol
        families = {curve.channel.family for curve in self._curves}
        family = (
            "Transmission angle" if shape_of(row.name) == TRANSMISSION else row.family.replace("-", " ").capitalize()
        )
        shared = (family,) if len(families) == 1 else ()
        names = (row.label, legible(row.symbol)) if len(self._curves) == 1 else shared
        return fitting_title((f"{name}, {unit}" if unit else name for name in names), unit, height)

    def _title_colour(self) -> str:
        return self._theme.text_colour(self._curves[0].colour) if len(self._curves) == 1 else self._theme.ink


def angle_title(name: str) -> str:
    """Title of the axis along the bottom."""
    return f"{name.capitalize()}, °"


__all__ = ["Curve", "CurvePlot"]
