"""Timing chart."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from math import hypot
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter, QPen, QPolygonF

from core.design import (
    UNITS,
    Design,
    TimingDistance,
    distances,
    drive_of,
    events_at,
    milliseconds,
    named_event,
    strokes,
    together,
)
from core.frozen import frozen
from core.output.timing import ENDINGS, MotionBand, bands, events_csv
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.pictures.painter import png_bytes
from kindyna_gui.pictures.paper.sheets import FILES, UNITS_PER_MM
from kindyna_gui.pictures.style import DASHED, LIGHT, OUTLINE, SMALL, TEXT, THIN, Theme, brush, font, rgb
from kindyna_gui.pictures.units import brief, digits, short, ticks, with_unit
from kindyna_gui.settings import sized

# -- timing chart ----------------------------------------------------------------------------------------

# One painter serves the window and files; where things stand is asked of the same object. Pixels count from the upper left corner.

DEGREES, MILLISECONDS = "deg", "ms"
AXES: Mapping[str, str] = MappingProxyType({DEGREES: "°", MILLISECONDS: "ms"})
"""What the axis counts in -> its symbol."""

NAMES = 118.0  # the most that the column of names is wide, pixels
TOP, BOTTOM, EDGE = 6.0, 34.0, 14.0  # around the bands
LOW, NUMBERS = 240.0, 20.0  # below this height there is room for the axis' numbers only
ROOM = 14.0  # above and below the curve of a band, for texts
LOW_BAND = 44.0  # below this height a band keeps no room for texts
TRACE = 0.08  # of its colour where a drive moves
TWO_LINES = 32.0  # a band of this height has room for name and stroke
TEXT_HEIGHT = 13.0  # height of a text
POINT, ARROW = 3.5, 6.0  # of an event, of an arrowhead
ALONG = (0.5, 0.3, 0.7)  # parts of the way from band to band where a distance may stand beside its arrow
REACH, LINE_REACH = 7.0, 4.0  # of the mouse: from a point, from a line


@frozen
class ChartHighlights:
    """What is pointed out in a chart.

    chosen   number of the drive that the rest of the window shows; -1: none
    row      the chosen row of the timing; -1: none
    joins    (drive, join) that the mouse is over, or that is held
    label    beside the first of them, or beside the names where it is the band; wrong: in the colour of limits
    pair     two drives whose common movement is shaded, or none
    link     from where to where a distance is being drawn: event's drive and join, and the place of the mouse
    """

    chosen: int = -1
    row: int = -1
    joins: tuple[tuple[int, int], ...] = ()
    label: str = ""
    wrong: bool = False
    pair: tuple[int, ...] = ()
    link: tuple[tuple[int, int], QPointF] | None = None


def spoken(design: Design) -> str:
    """The chart in words: when each drive moves."""
    rows = []
    for band in bands(design):
        moves = ", ".join(f"{short(one)} to {short(other)}°" for one, other in band.moving)
        rows.append(f"{band.name} moves from {moves}" if moves else f"{band.name} does not move")
    return "; ".join(rows)


class TimingChart:
    """A chart of a design at a size; unit: what the axis counts in, a row of ``AXES``."""

    def __init__(self, design: Design, width: float, height: float, unit: str, theme: Theme) -> None:
        self.design, self.width, self.height, self.unit, self.theme = design, width, height, unit, theme
        self.bands: tuple[MotionBand, ...] = bands(design)
        self.distances: tuple[TimingDistance, ...] = distances(design)
        self._arrows: dict[int, list[list[QPointF]]] = {}
        self._metrics = QFontMetricsF(font(SMALL))
        names = [text for band in self.bands for text in (band.name, _stroke_text(band))]
        widest = max(map(QFontMetricsF(font(SMALL, bold=True)).horizontalAdvance, names), default=0.0)
        self.left = min(widest, sized(NAMES)) + 22.0
        self.right = max(width - EDGE, self.left + 36.0)
        self.foot = sized(BOTTOM if height >= LOW else NUMBERS)
        self.band_height = max((height - TOP - self.foot) / max(len(self.bands), 1), 12.0)
        self._room = sized(ROOM) if self.band_height >= sized(LOW_BAND) else 4.0

    # -- where it is ----------------------------------------------------------------------------------------

    @property
    def degree(self) -> float:
        """Pixels that are one degree."""
        return (self.right - self.left) / 360.0

    def x(self, angle: Any) -> Any:
        return self.left + angle * self.degree

    def angle(self, x: float) -> float:
        """The machine angle at a place, 0 ... 360."""
        return min(max((x - self.left) / self.degree, 0.0), 360.0)

    def box(self, index: int) -> QRectF:
        """The band of a drive."""
        return QRectF(self.left, TOP + index * self.band_height, self.right - self.left, self.band_height)

    def y(self, index: int, level: Any) -> Any:
        box = self.box(index)
        low, high = box.bottom() - self._room, box.top() + self._room
        return low - level * (low - high)

    def place(self, index: int, join: int) -> QPointF:
        """Where a join stands."""
        angle = self.bands[index].joins[join]
        return QPointF(self.x(angle), self.y(index, self._level(index, angle)))

    def band_at(self, place: QPointF) -> int | None:
        """The drive whose band, or name, is at a place."""
        number = int((place.y() - TOP) // self.band_height)
        return number if 0 <= number < len(self.bands) and place.x() <= self.width else None

    def join_at(self, place: QPointF) -> tuple[int, int] | None:
        """The join at a place: the nearest point, else the nearest line of the band there. A join between dwells is none."""
        points = [(hypot(p.x() - place.x(), p.y() - place.y()), at) for at, p in self._events]
        away, nearest = min(points, default=(REACH + 1.0, (0, 0)))
        if away <= REACH:
            return nearest
        index = self.band_at(place)
        lines = [(abs(p.x() - place.x()), at) for at, p in self._events if at[0] == index]
        away, nearest = min(lines, default=(LINE_REACH + 1.0, (0, 0)))
        return nearest if away <= LINE_REACH else None

    def row_at(self, place: QPointF) -> int | None:
        """The row of the timing whose arrow is at a place."""
        for row in range(len(self.distances)):
            for line in self._arrow(row):
                for a, b in pairwise(line):
                    box = QRectF(a, b).normalized().adjusted(-LINE_REACH, -LINE_REACH, LINE_REACH, LINE_REACH)
                    if box.contains(place) and self.left <= place.x() <= self.right:
                        return row
        return None

    @cached_property
    def _events(self) -> list[tuple[tuple[int, int], QPointF]]:
        """Every join that is an event, or between two segments that move."""
        found = []
        for index, (drive, band) in enumerate(zip(self.design.drives, self.bands, strict=True)):
            motion = drive.motion
            for join in range(len(band.joins)):
                assert motion is not None
                if motion.segments[join - 1].rise or motion.segments[join].rise:
                    found.append(((index, join), self.place(index, join)))
        return found

    @cached_property
    def _joins_of(self) -> dict[str, tuple[int, int]]:
        """Event -> drive and join."""
        rows = [(index, join) for index, band in enumerate(self.bands) for join in range(len(band.joins))]
        return {event: at for at in rows for event in events_at(self.design, *at)}

    def _level(self, index: int, angle: float) -> float:
        band = self.bands[index]
        return float(band.level[abs(band.angles - angle).argmin()])

    def _arrow(self, row: int) -> list[list[QPointF]]:
        if row not in self._arrows:
            self._arrows[row] = self._elbow(row)
        return self._arrows[row]

    def _elbow(self, row: int) -> list[list[QPointF]]:
        """An elbow from the first event to the level of the second and on to it; twice where it passes the end of the turn."""
        timing, at = self.design.timing[row], self.distances[row]
        first, second = (self._joins_of[named_event(self.design, event)] for event in (timing.first, timing.second))
        begin, end = self.place(*first), self.place(*second)
        start = end.x() - at.after_deg * self.degree
        lines = []
        for turn in (0.0, 360.0 * self.degree, -360.0 * self.degree):
            line = [QPointF(start + turn, begin.y()), QPointF(start + turn, end.y()), QPointF(end.x() + turn, end.y())]
            low, high = min(p.x() for p in line), max(p.x() for p in line)
            if high >= self.left - 1e-6 and low <= self.right + 1e-6:
                lines.append(line)
        return lines

    # -- numbers --------------------------------------------------------------------------------------------

    def value(self, angle: float) -> float:
        """An angle as the axis counts."""
        return angle if self.unit == DEGREES else milliseconds(self.design, angle)

    def text(self, angle: float) -> str:
        """An angle as the axis counts, with its unit."""
        return with_unit(
            short(self.value(angle)) if self.unit == DEGREES else digits(self.value(angle)), AXES[self.unit]
        )

    def both(self, angle: float) -> str:
        """An angle in degrees and in milliseconds."""
        return f"{with_unit(short(angle), '°')}  {with_unit(digits(milliseconds(self.design, angle)), 'ms')}"

    def at_least(self, row: int) -> str:
        """``3° ≥ 2°``: how far the second event comes after the first, and what it must."""
        timing, at = self.design.timing[row], self.distances[row]
        after = self.text(at.after_deg) if self.unit == DEGREES else digits(self.value(at.after_deg), 3)
        return f"{after} {'≥' if at.kept else '<'} {self.text(timing.least_deg)}"

    # -- painting -------------------------------------------------------------------------------------------

    def _pen(self, colour: str, width: float = THIN, dash: tuple[float, ...] = ()) -> QPen:
        """A pen that grows with the page on which the chart is painted."""
        pen = self.theme.pen(colour, width, dash)
        pen.setCosmetic(False)
        return pen

    def paint(self, painter: QPainter, shown: ChartHighlights) -> None:
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(font(SMALL))
        self._taken: list[QRectF] = []
        for index, band in enumerate(self.bands):
            for begin, end in band.moving:
                self._fill(
                    painter, self.box(index), begin, end, QColor(_tint(self.theme.drive(index), self.theme.paper))
                )
        self._paint_axis(painter)
        for index in range(len(self.bands)):
            self._paint_band(painter, index, index == shown.chosen)
        self._paint_pair(painter, shown.pair)
        painter.save()
        painter.setClipRect(QRectF(self.left - 4.0, 0.0, self.right - self.left + 8.0, self.height))
        for row in range(len(self.distances)):
            self._paint_arrow(painter, row, row == shown.row)
        painter.restore()
        self._paint_points(painter, shown)
        for row in sorted(
            range(len(self.distances)), key=lambda row: (row != shown.row, self.distances[row].spare_deg)
        ):
            self._paint_distance(painter, row, row == shown.row)
        self._paint_pair_text(painter, shown.pair)
        if shown.link is not None:
            painter.setPen(self._pen(self.theme.ink, OUTLINE, DASHED))
            painter.drawLine(self.place(*shown.link[0]), shown.link[1])
        self._paint_label(painter, shown)
        painter.restore()

    def paint_cursor(self, painter: QPainter, machine: float) -> None:
        """A line at a machine angle [deg], over the chart."""
        x = self.x(machine)
        painter.setPen(self._pen(self.theme.ink))
        painter.drawLine(QPointF(x, TOP), QPointF(x, self.height - self.foot + 4.0))

    def _paint_axis(self, painter: QPainter) -> None:
        theme, bottom = self.theme, self.height - self.foot
        widest = self._metrics.horizontalAdvance("0000") + 14.0
        room = max(int((self.right - self.left) / widest), 2)
        if self.unit == DEGREES:
            step = next(step for step in (15, 30, 45, 60, 90, 180) if 360 / step <= room or step == 180)
            marks = [(float(angle), str(angle)) for angle in range(0, 361, step)]
        else:
            turn = milliseconds(self.design, 360.0)
            values, _ = ticks(0.0, turn, min(room, 12))
            marks = [(value / turn * 360.0, short(value)) for value in values]
        for angle, text in marks:
            x = self.x(angle)
            painter.setPen(self._pen(theme.faint))
            painter.drawLine(QPointF(x, TOP), QPointF(x, bottom))
            painter.setPen(self._pen(theme.quiet))
            painter.drawLine(QPointF(x, bottom), QPointF(x, bottom + 4.0))
            painter.setPen(QColor(theme.ink))
            painter.drawText(QRectF(x - 40.0, bottom + 4.0, 80.0, 14.0), Qt.AlignmentFlag.AlignCenter, text)
        if self.foot < sized(BOTTOM):
            return
        name = "Machine angle [°]" if self.unit == DEGREES else f"Time [ms] at {short(self.design.speed_rpm)} rpm"
        painter.setPen(QColor(theme.quiet))
        painter.drawText(
            QRectF(self.left, bottom + 17.0, self.right - self.left, 15.0), Qt.AlignmentFlag.AlignCenter, name
        )

    def _paint_band(self, painter: QPainter, index: int, chosen: bool) -> None:
        theme, band, box, colour = self.theme, self.bands[index], self.box(index), self.theme.drive(index)
        painter.setPen(self._pen(theme.faint))
        painter.drawLine(QPointF(0.0, box.bottom()), box.bottomRight())
        painter.fillRect(QRectF(0.0, box.top() + 3.0, 6.0 if chosen else 4.0, box.height() - 6.0), brush(colour))
        painter.setFont(font(SMALL, bold=chosen))
        painter.setPen(QColor(theme.ink))
        column = QRectF(10.0, box.top(), self.left - 16.0, box.height())
        name = QFontMetricsF(painter.font()).elidedText(band.name, Qt.TextElideMode.ElideRight, column.width())
        below = _stroke_text(band) if box.height() >= sized(TWO_LINES) else ""
        painter.drawText(column.adjusted(0.0, 0.0, 0.0, -15.0 if below else 0.0), Qt.AlignmentFlag.AlignVCenter, name)
        painter.setFont(font(SMALL))
        painter.setPen(QColor(theme.quiet))
        painter.drawText(column.adjusted(0.0, 15.0, 0.0, 0.0), Qt.AlignmentFlag.AlignVCenter, below)
        if not band.joins:
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, "turns with the shaft: no motion of its own")
            return
        painter.setPen(self._pen(theme.faint))
        for angle in band.joins:
            painter.drawLine(QPointF(self.x(angle), box.top() + 2.0), QPointF(self.x(angle), box.bottom() - 2.0))
        painter.setPen(self._pen(colour, 2.0 if chosen else OUTLINE))
        turns = np.diff(band.level, 1, prepend=np.nan, append=np.nan) != 0.0  # a dwell needs its ends only
        kept = turns[:-1] | turns[1:]
        x, y = self.x(band.angles[kept]), self.y(index, band.level[kept])
        painter.drawPolyline(QPolygonF(list(map(QPointF, x.tolist(), y.tolist()))))
        self._paint_strokes(painter, index)

    def _paint_strokes(self, painter: QPainter, index: int) -> None:
        """``rise 1  64°`` along the upper edge of the band, as much of it as the stroke is long."""
        drive, box = self.design.drives[index], self.box(index)
        if drive.motion is None or self._room < sized(ROOM):
            return
        painter.setPen(QColor(self.theme.text_colour(self.theme.drive(index))))
        for stroke in strokes(drive.motion):
            span = stroke.end - stroke.start
            name = stroke.name.replace(".", " ")
            begin = (stroke.start + drive.phase_deg) % 360.0
            low, high = max(_within(begin, begin + span), key=lambda part: part[1] - part[0])
            middle, room = (low + high) / 2.0, (high - low) * self.degree
            for text in (f"{name}  {self.text(span)}", name, stroke.name.rpartition(".")[2]):
                width = self._metrics.horizontalAdvance(text)
                at = QRectF(self.x(middle) - width / 2.0, box.top() + 1.0, width, sized(TEXT_HEIGHT))
                if width <= room:
                    painter.drawText(at, Qt.AlignmentFlag.AlignCenter, text)
                    self._taken.append(at)
                    break

    def _paint_points(self, painter: QPainter, shown: ChartHighlights) -> None:
        for at, place in self._events:
            over, colour = at in shown.joins, self.theme.drive(at[0])
            radius = POINT + (1.5 if over else 0.0)
            painter.setPen(self._pen(colour, OUTLINE))
            painter.setBrush(brush(colour if over else self.theme.paper))
            if over:
                box = self.box(at[0])
                painter.drawLine(QPointF(place.x(), box.top()), QPointF(place.x(), box.bottom()))
            painter.drawEllipse(place, radius, radius)
            self._taken.append(QRectF(place.x() - radius, place.y() - radius, 2.0 * radius, 2.0 * radius))
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_arrow(self, painter: QPainter, row: int, chosen: bool) -> None:
        colour = self._colour(row)
        pen = self._pen(colour, 2.0 if chosen else THIN)
        for line in self._arrow(row):
            painter.setPen(pen)
            painter.drawPolyline(QPolygonF(line))
            tip, way = line[2], 1.0 if line[2].x() >= line[1].x() else -1.0
            tip = tip - QPointF(way * POINT, 0.0)
            back = tip.x() - way * ARROW
            painter.setBrush(brush(colour))
            painter.drawPolygon(QPolygonF([tip, QPointF(back, tip.y() - 3.0), QPointF(back, tip.y() + 3.0)]))
            painter.setBrush(Qt.BrushStyle.NoBrush)

    def _colour(self, row: int) -> str:
        return self.theme.ink if self.distances[row].kept else self.theme.limit

    def _paint_distance(self, painter: QPainter, row: int, chosen: bool) -> None:
        """The distance beside its arrow, where nothing else stands or runs; that of a broken or chosen row in any case."""
        text = self.at_least(row)
        painter.setFont(font(SMALL, bold=chosen))
        size = QFontMetricsF(painter.font()).horizontalAdvance(text) + 6.0, sized(TEXT_HEIGHT)
        start, corner, end = self._arrow(row)[0]
        left, right = min(corner.x(), end.x()), max(corner.x(), end.x())
        middle = max(min((left + right) / 2.0, self.right - size[0] / 2.0), self.left + size[0] / 2.0)
        beside = POINT + 3.0
        spots = [
            (x, y)
            for y in (end.y() - sized(TEXT_HEIGHT) - beside, end.y() + beside, end.y() - 0.5 * sized(TEXT_HEIGHT))
            for x in (right + beside, left - beside - size[0], middle - size[0] / 2.0)
        ]
        spots += [
            (x, start.y() + part * (corner.y() - start.y()) - 6.5)
            for part in ALONG
            for x in (corner.x() + 3.0, corner.x() - 3.0 - size[0])
        ]
        boxes = [QRectF(x, y, *size) for x, y in spots if x >= self.left and x + size[0] <= self.right and y >= 0.0]
        free = [box for box in boxes if not self._is_taken(box)]
        must = chosen or not self.distances[row].kept
        if not free and (not must or not boxes):
            painter.setFont(font(SMALL))
            return
        box = (free or boxes)[0]
        self._taken.append(box)
        painter.fillRect(box, brush(self.theme.paper, 0.8))
        painter.setPen(QColor(self._colour(row)))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
        painter.setFont(font(SMALL))

    def _is_taken(self, box: QRectF) -> bool:
        """Whether a text, a point, an arrow or a curve is there."""
        if any(box.intersects(other) for other in (*self._taken, *self._strokes)):
            return True
        return any(
            ((abs(x - box.center().x()) <= box.width() / 2.0) & (abs(y - box.center().y()) <= box.height() / 2.0)).any()
            for x, y in self._curves
        )

    @cached_property
    def _strokes(self) -> list[QRectF]:
        """The arrows, stroke by stroke."""
        lines = (line for row in range(len(self.distances)) for line in self._arrow(row))
        return [QRectF(a, b).normalized().adjusted(-0.5, -0.5, 0.5, 0.5) for line in lines for a, b in pairwise(line)]

    @cached_property
    def _curves(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """The curves as points that no text fits between."""
        at = np.linspace(0.0, 360.0, 721)
        return [
            (self.x(at), self.y(i, np.interp(at, band.angles, band.level)))
            for i, band in enumerate(self.bands)
            if band.joins
        ]

    def _paint_pair(self, painter: QPainter, pair: Sequence[int]) -> None:
        if len(pair) != 2:
            return
        high, low = self.box(min(pair)), self.box(max(pair))
        for begin, end in together(self.design, *pair):
            self._fill(
                painter, QRectF(high.topLeft(), low.bottomRight()), begin, end, brush(self.theme.limit, 0.13).color()
            )

    def _paint_pair_text(self, painter: QPainter, pair: Sequence[int]) -> None:
        for begin, end in together(self.design, *pair) if len(pair) == 2 else ():
            text = self.text(end - begin)
            width = self._metrics.horizontalAdvance(text) + 6.0
            x = self.x(((begin + end) / 2.0) % 360.0)
            x = min(max(x, self.left + width / 2.0), self.right - width / 2.0)
            box = QRectF(
                x - width / 2.0, self.box(min(pair)).bottom() - sized(TEXT_HEIGHT) - 1.0, width, sized(TEXT_HEIGHT)
            )
            painter.fillRect(box, brush(self.theme.paper, 0.85))
            painter.setPen(QColor(self.theme.limit))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _fill(self, painter: QPainter, box: QRectF, begin: float, end: float, colour: QColor) -> None:
        for low, high in _within(begin, end):
            painter.fillRect(QRectF(self.x(low), box.top(), (high - low) * self.degree, box.height()), colour)

    def _paint_label(self, painter: QPainter, shown: ChartHighlights) -> None:
        if not shown.label or not shown.joins:
            return
        at = self.place(*shown.joins[0])
        painter.setFont(font(SMALL, bold=True))
        width = QFontMetricsF(painter.font()).horizontalAdvance(shown.label) + 10.0
        band = self.box(shown.joins[0][0])  # below it, or above it where there is none below: not over what is held
        left = at.x() + 10.0 if at.x() + 10.0 + width <= self.right else self.right - width
        top = (
            band.bottom() + 2.0
            if len(self.bands) == 1 or shown.joins[0][0] < len(self.bands) - 1
            else band.top() - 19.0
        )
        box = QRectF(max(left, 2.0), top, width, 17.0)
        painter.fillRect(box, brush(self.theme.paper, 0.94))
        painter.setPen(self._pen(self.theme.faint))
        painter.drawRect(box)
        painter.setPen(QColor(self.theme.limit if shown.wrong else self.theme.ink))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, shown.label)


def _tint(colour: str, paper: str) -> str:
    """A trace of a colour on a paper, opaque: it is filled much faster."""
    mixed = (round(TRACE * a + (1.0 - TRACE) * b) for a, b in zip(rgb(colour), rgb(paper), strict=True))
    return QColor(*mixed).name()


def _within(begin: float, end: float) -> Iterator[tuple[float, float]]:
    """A stretch of the turn as parts of 0 ... 360."""
    yield begin, min(end, 360.0)
    if end > 360.0:
        yield 0.0, end - 360.0


def _stroke_text(band: MotionBand) -> str:
    """``150 mm``."""
    return brief(band.stroke, UNITS[band.unit].symbol, 4) if band.unit else ""


def plain(event: str) -> str:
    """``Feed return 1 end``: an event as it is read."""
    name = drive_of(event)
    return f"{name} {event.removeprefix(name + '.').replace('.', ' ')}"


# -- timing file -----------------------------------------------------------------------------------------

PIXEL = 0.26  # mm of paper that a pixel of the chart is
WIDTH, BAND, AROUND, MARGIN = 1060.0, 92.0, 48.0, 28.0  # of the page, a band, axis, edge, pixels
TITLE, FILE_LINE = 46.0, 15.0  # heights of the title and of a line of the list
DOTS = 2.0  # of a PNG, per pixel


def timing_file(design: Design, ending: str, unit: str = DEGREES, pair: Sequence[int] = ()) -> bytes:
    """The chart as one of ``ENDINGS``; unit: what its axis counts in; pair: two drives whose common movement is shaded."""
    assert ending in ENDINGS
    if ending == ".csv":
        return events_csv(design).encode()
    ensure_app(offscreen=True)
    height = _chart_height(design) + TITLE + FILE_LINE * len(_lines(design, pair)) + 2.5 * MARGIN

    def paint(scale: float) -> Callable[[QPainter], None]:
        return lambda painter: _paint(painter, design, unit, tuple(pair), scale)

    if ending == ".png":
        return _png(height, paint(DOTS))
    about = "Timing chart: motions of all drives over the machine angle"
    return FILES[ending](design.name, about, WIDTH * PIXEL, height * PIXEL, paint(PIXEL * UNITS_PER_MM))


def _png(height: float, paint: Callable[[QPainter], None]) -> bytes:
    image = QImage(round(WIDTH * DOTS), round(height * DOTS), QImage.Format.Format_RGB32)
    painter = QPainter(image)
    try:
        paint(painter)
    finally:
        painter.end()
    return png_bytes(image)


def _paint(painter: QPainter, design: Design, unit: str, pair: tuple[int, ...], scale: float) -> None:
    """The page, a pixel of the chart being so many units of the device."""
    theme = LIGHT
    chart = TimingChart(design, WIDTH - 2.0 * MARGIN, _chart_height(design), unit, theme)
    lines = _lines(design, pair, chart)
    painter.scale(scale, scale)
    painter.setRenderHint(QPainter.RenderHint.TextAntialiasing)
    painter.fillRect(
        QRectF(0.0, 0.0, WIDTH, chart.height + TITLE + FILE_LINE * len(lines) + 2.5 * MARGIN), QColor(theme.paper)
    )
    painter.translate(MARGIN, MARGIN)
    painter.setPen(QColor(theme.ink))
    painter.setFont(font(TEXT + 3, bold=True))
    painter.drawText(QRectF(0.0, 0.0, chart.width, 20.0), Qt.AlignmentFlag.AlignVCenter, design.name)
    painter.setFont(font(SMALL))
    painter.setPen(QColor(theme.quiet))
    about = f"Timing chart. {design.speed_rpm:g} rpm: a turn takes {chart.both(360.0).split('  ')[1]}"
    painter.drawText(QRectF(0.0, 20.0, chart.width, 16.0), Qt.AlignmentFlag.AlignVCenter, about)
    painter.translate(0.0, TITLE)
    chart.paint(painter, ChartHighlights(pair=pair))
    painter.translate(0.0, chart.height + 0.5 * MARGIN)
    for number, (text, wrong) in enumerate(lines):
        painter.setPen(QColor(theme.limit if wrong else theme.ink))
        painter.drawText(QRectF(0.0, FILE_LINE * number, chart.width, FILE_LINE), Qt.AlignmentFlag.AlignVCenter, text)


def _chart_height(design: Design) -> float:
    return BAND * len(design.drives) + AROUND


def _lines(design: Design, pair: Sequence[int], chart: TimingChart | None = None) -> list[tuple[str, bool]]:
    """What stands below the chart, and whether it is wrong: each distance, and where the two drives move together."""
    made = []
    for row, each in enumerate(design.timing):
        kept = chart is None or chart.distances[row].kept
        at = "" if chart is None else chart.at_least(row)
        made.append((f"{plain(each.second)} after {plain(each.first)}: {at}{'' if kept else ', broken'}", not kept))
    if len(pair) == 2:
        names = " and ".join(chart.bands[number].name for number in pair) if chart is not None else ""
        parts = together(design, *pair) if chart is not None else ()
        text = (
            ", ".join(f"{chart.text(begin)} - {chart.text(end % 360.0)}" for begin, end in parts)
            if chart is not None
            else ""
        )
        made.append((f"{names} both move: {text or 'never'}", False))
    return made
