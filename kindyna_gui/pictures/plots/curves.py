"""Curves over one turn of the cam: ``CurvePlot``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import degrees
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QAccessible, QPen
from PySide6.QtWidgets import QWidget

from core.design import motion_of
from core.motion.extremes import Extremes
from core.study import Quantity, Study
from core.study.quantities import TRANSMISSION, shape_of
from kindyna_gui.pictures.items import Outline, text_size
from kindyna_gui.pictures.plots.lines import (
    TOP_HEIGHT,
    Z_CURVE,
    Z_REFERENCE,
    Cursor,
    CurveLine,
    Entry,
    Frame,
    LimitLine,
    closed,
    shades,
    shades_entry,
)
from kindyna_gui.pictures.plots.marks import Extreme, ExtremeMark, Readout, both_ends, lay_marks, place_readouts
from kindyna_gui.pictures.plots.plot import (
    FREE,
    FixedPlot,
    Span,
    angle_ticks,
    name_ticks,
    readable_range,
    room_for,
    spans,
    usual_range,
    value_ticks,
)
from kindyna_gui.pictures.plots.quantities import Curve, drawn_alike, limits_of, moving, read_curves
from kindyna_gui.pictures.style import DASHED, SCREEN, TEXT, THIN, Theme
from kindyna_gui.pictures.units import (
    NOTHING_DRAWN,
    DisplayUnit,
    TurnSamples,
    curve_words,
    legible,
    line_of,
    nearest,
    readable,
    short,
    with_unit,
)
from kindyna_gui.settings import point, sized, symbol_of

UNNAMED = 4  # height of the axis above where no names stand there, pixels
MOST_FREE = 0.13  # of the height
NO_BANDS: Mapping[str, np.ndarray] = MappingProxyType({})
WILD = 50.0  # values next to infinity are cut at so many times the rest's range


class CurvePlot(FixedPlot):
    """One or several channels of one unit against the cam angle, 0 ... 360 deg, with a cursor.

    names, angles   whether the segments' names stand along the top, and the cam angle's numbers along the bottom:
                    of plots one below the other only the first and the last show them
    unseen          pixels by which a curve may be off where that saves points; on paper none
    text_room       pixels that are left free above and below the curves, for the texts of extremes
    """

    unseen = 0.0
    text_room = 0.0

    def __init__(
        self, parent: QWidget | None = None, *, names: bool = True, angles: bool = True, theme: Theme = SCREEN
    ) -> None:
        self._named = names
        super().__init__(parent, theme, top=True)
        self._axes["top"].setStyle(showValues=names)
        self.show_numbers(angles, angle_title("cam angle"))
        self._with_angles = angles
        self._cursor = Cursor(self._view, theme)
        self._angle, self._with_cursor = 0.0, True
        self._spans: list[Span] = []
        self._line: TurnSamples | None = None
        self._theta = np.zeros(0)
        self._curves: list[Curve] = []
        self._others: list[Curve] = []
        self._beside: TurnSamples | None = None
        self._exact_values: list[float] | None = None
        self._readings: list[Readout] = []
        self._limits: list[LimitLine] = []
        self._drawn: list[CurveLine] = []
        self._bands: list[Outline] = []
        self._drawn_bands: Sequence[tuple[Curve, np.ndarray]] = ()
        self._drawn_marks: tuple[object, ...] = ()
        self._asked: tuple[Study, tuple[Quantity, ...], Study | None, Mapping[str, np.ndarray]] | None = None
        self._core: tuple[float, float] | None = None  # what the axis must show at least
        self._whole = self._spiked = False
        self._ranges: Mapping[str, Extremes] | None = None
        self._extremes: list[Extreme] = []
        self._extreme_marks: list[ExtremeMark] = []
        self._boxes: list[QRectF] = []
        self._laid: tuple[object, ...] = ()
        self.rung = DisplayUnit("", 1.0, 0.0)
        self.show_message("")

    def _size_axes(self) -> None:
        super()._size_axes()
        if not self._named:
            self._axes["top"].setHeight(UNNAMED)

    def update_style(self) -> None:
        super().update_style()
        self._laid = ()
        self.draw_again()

    def keep_axes(self) -> None:
        """For a screen: axes are kept as pixels, so that the cursor moves over them without their being drawn anew."""
        for axis in self._axes.values():
            axis.setCacheMode(axis.CacheMode.DeviceCoordinateCache)
            axis.label.setCacheMode(axis.CacheMode.DeviceCoordinateCache)

    # -- what is drawn --------------------------------------------------------------------------------------

    def set_curves(
        self,
        study: Study,
        channels: Sequence[Quantity],
        reference: Study | None = None,
        read: bool = True,
        bands: Mapping[str, np.ndarray] = NO_BANDS,
    ) -> None:
        """Draw these channels of the study; reference: a second study, dashed; bands: column -> percentiles (5, n), evenly over the turn,
        within which machines lie, shaded. Raises NoSolution where one has none.

        Where all would be drawn as it is nothing is touched, and so nothing painted. read: False where ``set_angle``
        follows at once, so that no value is written twice.
        """
        self.name_angle(study)
        curves = read_curves(study, channels, self._theme)
        others = [] if reference is None else read_curves(reference, channels, self._theme)
        segments, limits = spans(motion_of(study.design)), limits_of(study, channels)
        marks = (tuple(segments), tuple(limits), symbol_of(channels[0].unit.symbol), point())
        line = line_of(study)
        shaded = [(curve, bands[curve.channel.slug]) for curve in curves if curve.channel.slug in bands]
        beside = None if reference is None else line_of(reference)
        if (
            marks == self._drawn_marks
            and [id(each) for _, each in shaded] == [id(each) for _, each in self._drawn_bands]
            and line.alike(self._line)
            and drawn_alike(curves, self._curves)
            and drawn_alike(others, self._others)
            and (beside is None or beside.alike(self._beside))
        ):
            return
        self._drawn_marks, self._others, self._beside = marks, others, beside
        self._curves, self._spans, self._message_text, self._exact_values = curves, segments, "", None
        self._line, self._theta = line, study.theta
        self._asked, self._ranges = (study, tuple(channels), reference, bands), None
        values = [*(curve.values for curve in curves + others), *(each[i] for _, each in shaded for i in (0, -1))]
        whole = [usual_range(each) for each in values]
        moves = [moving(study)] * len(curves) + [moving(reference or study)] * len(others)
        moves += [np.ones(each.shape[-1], dtype=bool) for _, each in shaded for _ in (0, 1)]
        calm = [readable_range(each, at) for each, at in zip(values, moves, strict=True)]
        self._spiked = calm != whole
        sides = whole if self._whole else calm
        self.rung = readable(curves[0].channel.unit.symbol, max(abs(side) for pair in sides for side in pair))
        size = self.rung.size
        self._core = room_for(
            [(low / size, high / size) for low, high in sides],
            {row.family for row in channels},
            [value / size for value, _ in limits],
            free=0.0,
        )
        low, high = self._reach(self._core)
        rows = [(curve, line, Z_CURVE, DASHED if curve.channel.approximates else ()) for curve in curves]
        if beside is not None:
            rows += [(curve, beside, Z_REFERENCE, DASHED) for curve in others]
        self._drawn = self._grown(self._drawn, len(rows), lambda: CurveLine(self._view))
        for item, (curve, along, z, dash) in zip(self._drawn, rows, strict=True):
            self._draw(item, curve, along, z, self._theme.pen(curve.colour, THIN, dash))
        self._shade(shaded)
        self._readings = self._grown(self._readings, len(curves), lambda: Readout(self._view, self._theme))
        for reading, curve in zip(self._readings, curves, strict=True):
            reading.set_colour(curve.colour)
        shown = [(value / size, *words) for value, words in limits if low <= value / size <= high]
        self._limits = self._grown(self._limits, len(shown), lambda: LimitLine(self._view, self._theme))
        for limit, (value, text, brief, field) in zip(self._limits, shown, strict=True):
            limit.set_value(value, text.format(with_unit(short(value, 4), self.rung.symbol)), brief, field)
        self._name_curves(reference is not None, bool(shaded))
        self._find_extremes()
        self._lay_out()
        if QAccessible.isActive():
            self._speak()
        if read:
            self._write()

    @property
    def spiked(self) -> bool:
        """Whether there are values so far off that the axis does not reach to them, unless the whole is wanted."""
        return self._spiked and bool(self._curves)

    @property
    def whole(self) -> bool:
        """Whether the axis reaches to all values, spikes included."""
        return self._whole

    def show_whole(self, on: bool) -> None:
        """Let the axis reach to all values, or cut spikes off, which an arrow marks at the edge."""
        if on != self._whole:
            self._whole = on
            self.draw_again()

    def draw_again(self) -> None:
        """The same curves, on an axis that fits them as it is wanted now."""
        known = self._ranges
        if self._curves and self._asked is not None:
            self._drawn_marks = ()
            study, channels, reference, bands = self._asked
            self.set_curves(study, channels, reference, bands=bands)
            self.show_extremes(known)

    # -- extremes -------------------------------------------------------------------------------------------

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        """Mark the highest and lowest value of each curve; found: by quantity, in SI. None: only where a spike is cut off."""
        self._ranges = found
        self._find_extremes()
        self._speak()
        self._lay_out()
        self._write()

    def _speak(self) -> None:
        self.setAccessibleName(
            f"Plot of {', '.join(curve.channel.label.lower() for curve in self._curves) or 'nothing'}"
        )
        self.setAccessibleDescription(self.spoken() or self._message_text or NOTHING_DRAWN)

    @property
    def lacks_extremes(self) -> bool:
        """Whether other curves are drawn than those whose extremes were shown last."""
        return bool(self._curves) and self._ranges is None

    def marked(self) -> list[Extreme]:
        """The extremes that are marked, each at its angle, in the unit of the axis."""
        return [mark.extreme for mark in self._extreme_marks]

    def _reach(self, core: tuple[float, float]) -> tuple[float, float]:
        """Let the axis show these values, with room for a text above and below; what it shows."""
        part = min(sized(self.text_room) / max(self._view.height(), 1.0), MOST_FREE)
        room = max(FREE, part / (1.0 - 2.0 * part)) * (core[1] - core[0])
        shown = (core[0] - room, core[1] + room)
        if tuple(self._view.viewRange()[1]) != shown:
            self._view.setRange(yRange=shown, padding=0.0)
        return shown

    def _find_extremes(self) -> None:
        (low, high), size = self._view.viewRange()[1], self.rung.size
        rows = []
        for curve in self._curves:
            if curve.channel.approximates:
                continue
            refined = (self._ranges or {}).get(curve.channel.name)
            ends = self._sampled(curve) if refined is None else curve.ends(refined)
            found = both_ends(curve, ends, size, refined is not None)
            rows += [extreme for extreme in found if extreme.refined or not low <= extreme.value <= high]
        self._extremes = rows

    def spoken(self) -> str:
        """The curves in words: from where to where each goes, and where it is largest."""
        rows = []
        for curve in self._curves:
            refined = (self._ranges or {}).get(curve.channel.name)
            ends = self._sampled(curve) if refined is None else curve.ends(refined)
            low, high = (value / self.rung.size for _, value in ends)
            angle, _ = max(ends, key=lambda end: abs(end[1]))
            rows.append(curve_words(curve.channel.label.lower(), self.rung.symbol, low, high, angle, "°"))
        return "; ".join(rows)

    def _sampled(self, curve: Curve) -> list[tuple[float, float]]:
        """Lowest and highest sample, (angle [deg], value)."""
        known = np.where(np.isnan(curve.values), 0.0, curve.values)
        return [(degrees(self._theta[i]), float(known[i])) for i in (int(known.argmin()), int(known.argmax()))]

    def name_angle(self, study: Study) -> None:
        """The angle below is the one that this study turns by, be there curves of it or only a message."""
        if self._with_angles:
            self.name_below(angle_title(study.angle_name))

    def show_message(self, text: str) -> None:
        """Nothing but a text in the middle: what is missing, or what would fill this plot."""
        for pool in (self._drawn, self._readings, self._limits):
            self._grown(pool, 0, _nothing)
        self._drawn, self._readings, self._limits, self._extremes = [], [], [], []
        self._shade([])
        self._curves, self._others, self._spans, self._drawn_marks, self._exact_values = [], [], [], (), None
        self._name_curves(False)
        self._axes["left"].show_title("", self._theme.ink)
        self._message_text, self._core = text, None
        self._view.setRange(yRange=(0.0, 1.0), padding=0.0)
        self._speak()
        self._lay()

    def _shade(self, bands: Sequence[tuple[Curve, np.ndarray]]) -> None:
        """Fill from the first to the last percentile of each band faintly, from the second to the last but one more strongly."""
        self._drawn_bands = bands
        for item in self._bands:
            self._view.removeItem(item)
        self._bands = []
        low, high = self._view.viewRange()[1]
        room = WILD * (high - low)
        for curve, rows in bands:
            angles, ends = closed(rows, curve.gain)
            for item in shades(angles, np.clip(ends / self.rung.size, low - room, high + room), curve.colour):
                self._view.addItem(item, ignoreBounds=True)
                self._bands.append(item)

    @property
    def bands(self) -> list[np.ndarray]:
        """The percentiles that are shaded, of each curve that has any."""
        return [rows for _, rows in self._drawn_bands]

    def _draw(self, item: CurveLine, curve: Curve, along: TurnSamples, z: float, pen: QPen) -> None:
        values = along.of(curve.values, curve.gain) / self.rung.size
        finite = np.isfinite(values)
        if self._spiked or not finite.all():
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

    def _name_curves(self, reference: bool, made: bool = False) -> None:
        """Names of the curves above the plot, where there is more than one."""
        rows: list[Entry] = []
        if len(self._curves) > 1 or reference or made:
            rows = [Entry(c.colour, c.channel.label, "– –" if c.channel.approximates else "—") for c in self._curves]
            rows += [Entry(self._theme.quiet, "reference", "– –")] if reference else []
            rows += [shades_entry(self._theme)] if made else []
        self._name(rows)

    # -- cursor ---------------------------------------------------------------------------------------------

    @property
    def angle(self) -> float:
        """Cam angle of the cursor [rad]."""
        return self._angle

    def set_angle(self, theta: float, at_angle: Study | None = None) -> None:
        """Move the cursor to cam angle theta [rad].

        at_angle: the same study at this one angle, for exact readings; else they are those of the nearest sample.
        """
        self._angle = theta
        self._exact_values = (
            None if at_angle is None else [float(curve.channel.values(at_angle)[0]) for curve in self._curves]
        )
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
        frame = self.frame()
        written: list[QRectF] = []
        if not self._with_cursor:
            for reading in self._readings:
                reading.hide()
        elif self._readings:
            at = nearest(self._theta, self._angle)
            known = self._exact_values or [float(curve.values[at]) for curve in self._curves]
            values = [
                0.0 if abs(value) <= curve.floor else value / self.rung.size
                for value, curve in zip(known, self._curves, strict=True)
            ]
            written = place_readouts(self._readings, degrees(self._angle), values, self.rung, frame, self._boxes)
        for mark in self._extreme_marks:  # in a low plot there may be no other room for what is read at the cursor
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
        for place, limit in enumerate(self._limits):
            limit.lay_clear(frame, self._drawn, [other.box(frame) for other in self._limits[:place]])
        self._lay_extremes(frame)
        if self._curves:
            self._axes["left"].show_title(self._title(frame.height), self._title_colour())
        paper = (frame, tuple(self._spans), bool(self._curves), self._message_text)
        if paper != self._laid:
            self._laid = paper
            self._lay_paper(frame)
        self.scene().prepareForPaint()  # else the transformation follows in the paint event and causes another

    def _lay_extremes(self, frame: Frame) -> None:
        wanted = self._extremes
        self._extreme_marks = self._grown(
            self._extreme_marks, len(wanted), lambda: ExtremeMark(self._view, self._theme)
        )
        for mark, extreme in zip(self._extreme_marks, wanted, strict=True):
            mark.stand(extreme, frame)
        taken = self._covered(frame) + [limit.box(frame) for limit in self._limits]
        self._boxes = taken + lay_marks(self._extreme_marks, frame, taken, self._drawn)

    def _covered(self, frame: Frame) -> list[QRectF]:
        """What else covers a part of the frame [pixels from its lower left corner, y upwards]."""
        return []

    def cut_at(self, pixel: QPointF) -> bool:
        """Whether an arrow of a value that is cut off, or its text, stands at a place of the widget [pixels]."""
        frame, corner = self.frame(), self.mapFromScene(self._view.sceneBoundingRect().bottomLeft())
        at = QPointF(pixel.x() - corner.x(), corner.y() - pixel.y())
        return any(
            mark.outside and (mark.sign_box(frame) | mark.box(frame)).contains(at) for mark in self._extreme_marks
        )

    def limit_at(self, pixel: QPointF) -> str:
        """The path of the field of the limit whose text stands at a place of the widget [pixels]; empty where none does."""
        frame, corner = self.frame(), self.mapFromScene(self._view.sceneBoundingRect().bottomLeft())
        at = QPointF(pixel.x() - corner.x(), corner.y() - pixel.y())
        return next((limit.field for limit in self._limits if limit.box(frame).contains(at)), "")

    def _lay_paper(self, frame: Frame) -> None:
        values = value_ticks(frame.low, frame.high, frame.height) if self._curves else []
        self.rule(frame, angle_ticks(frame.width), values, self._spans)
        self._cursor.span(frame.low, frame.high)
        self._axes["top"].show_ticks(self._names(frame.width) if self._named else [])

    def _names(self, width: float) -> list[tuple[float, str]]:
        """What stands along the top: places [deg] and names of segments."""
        return name_ticks(self._spans, width)

    def _title(self, height: float) -> str:
        """Quantity and unit, as short as the axis needs."""
        row, unit = self._curves[0].channel, self.rung.symbol
        families = {curve.channel.family for curve in self._curves}
        family = (
            "Transmission angle" if shape_of(row.name) == TRANSMISSION else row.family.replace("-", " ").capitalize()
        )
        shared = (family,) if len(families) == 1 else ()
        names = (row.label, legible(row.symbol)) if len(self._curves) == 1 else shared
        for name in names:
            text = f"{name}, {unit}" if unit else name
            if text_size(text, TEXT)[0] <= height + sized(TOP_HEIGHT):
                return text
        return unit

    def _title_colour(self) -> str:
        return self._theme.letters(self._curves[0].colour) if len(self._curves) == 1 else self._theme.ink


def angle_title(name: str) -> str:
    """Of the axis along the bottom."""
    return f"{name.capitalize()}, °"


def _nothing() -> None:
    """Makes none."""


__all__ = ["Curve", "CurvePlot"]
