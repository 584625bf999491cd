"""Timing chart: the motions of all drives over the machine angle, in the window and as a file.

Lengths are in pixels from the upper left corner, angles in degrees. The window takes all positions from the chart.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import hypot
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen, QPolygonF

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
from core.output.drawing.scales import ticks
from core.output.timing import MotionBand, bands
from kindyna_gui.pictures.plots.lines import DASHED_MARK
from kindyna_gui.pictures.style import DASHED, OUTLINE, SMALL, THIN, Theme, brush, font, rgb
from kindyna_gui.pictures.units import brief, digits, short, with_unit
from kindyna_gui.settings import sized

if TYPE_CHECKING:
    from core.valves import LobeEdge

# -- chart ---------------------------------------------------------------------------------------------

DEGREES, MILLISECONDS, CRANK = "deg", "ms", "crank"
AXES: Mapping[str, str] = MappingProxyType({DEGREES: "°", MILLISECONDS: "ms", CRANK: "°"})
"""Symbol of each unit of the axis."""

NAMES = 118.0  # greatest width of the column of names, pixels
TOP, BOTTOM, EDGE = 6.0, 34.0, 14.0  # margins around the bands
LOW, NUMBERS = 240.0, 20.0  # height below which the axis has no title, and height of its numbers
ROOM = 14.0  # space for texts above and below the curve of a band
LOW_BAND = 44.0  # a band below this height has no space for texts
TINT = 0.08  # fraction of a drive's colour where the drive moves
TWO_LINES = 32.0  # height of a band with space for name and stroke
TEXT_HEIGHT = 13.0
POINT, ARROW = 3.5, 6.0  # radius of an event, length of an arrow head
ALONG = (0.5, 0.3, 0.7)  # fractions of the arrow from band to band next to which a distance may be written
REACH, LINE_REACH = 7.0, 4.0  # reach of the mouse from a point and from a line


@frozen
class ForbiddenSpan:
    """Machine angles [deg] in which bodies of these drives meet, or are nearer than they must be; names of the bodies."""

    drives: tuple[int, ...]
    begin: float
    end: float
    names: str


@frozen
class ChartHighlights:
    """Highlighted parts of a chart.

    Attributes
    ----------
    selected : number of the selected drive; -1 for none
    row : selected row of the sequence conditions; -1 for none
    joins : drive and join of each point that is under the mouse or dragged
    label : text next to the first of these points
    is_invalid : whether the label has the colour of limits
    pair : two drives whose overlap is shaded
    forbidden : spans in which bodies of drives meet, or are nearer than they must be
    link : start of a distance that is being drawn, as drive and join, and the position of the mouse
    """

    selected: int = -1
    row: int = -1
    joins: tuple[tuple[int, int], ...] = ()
    label: str = ""
    is_invalid: bool = False
    pair: tuple[int, ...] = ()
    forbidden: tuple[ForbiddenSpan, ...] = ()
    link: tuple[tuple[int, int], QPointF] | None = None


Reference = tuple[Design, str]
"""Another design, and its name in the legend."""


def _pairs_of_bands(design: Design, reference: Reference | None) -> list[tuple[MotionBand, MotionBand | None]]:
    """Bands of a design, each with that of its drive in another design; the larger of two strokes fills the band."""
    others = () if reference is None else bands(reference[0])
    named = {band.name: band for band in others if band.joins}
    if len(design.drives) == len(others) == 1:  # its name is that of the design
        named = {bands(design)[0].name: others[0]} if others[0].joins else {}
    rows: list[tuple[MotionBand, MotionBand | None]] = []
    for band in bands(design):
        other = named.get(band.name) if band.joins else None
        if other is not None and other.unit == band.unit and (most := max(band.stroke, other.stroke)) > 0.0:
            band, other = (replace(row, level=row.level * (row.stroke / most)) for row in (band, other))
        rows.append((band, other))
    return rows


def _lobe_edges(design: Design) -> Mapping[int, tuple[tuple[LobeEdge, float], ...]]:
    """Edges of the lobes of all valves with their machine angles [deg], by the numbers of their drives."""
    if not design.has_valves:
        return {}
    from core.valves.edges import machine_edges  # only valve trains need it

    return machine_edges(design)


def accessible_text(design: Design) -> str:
    """Text for screen readers: the angles at which each drive moves."""
    rows = []
    for band in bands(design):
        moves = ", ".join(f"{short(start)} to {short(end)}°" for start, end in band.moving)
        rows.append(f"{band.name} moves from {moves}" if moves else f"{band.name} does not move")
    return "; ".join(rows)


class TimingChart:
    """Timing chart of a design.

    Parameters
    ----------
    design : Design
    width, height : float [pixels]
    unit : str
        Unit of the axis, a key of ``AXES``.
    theme : Theme
    reference : Reference, optional
        A second design, whose motions are drawn dashed in the bands of the drives with their names.
    """

    content = "motions of all drives over the machine angle"
    how = (
        "Drag a point to move one start or end, a band to turn its drive against the others; both stop at sequence conditions.\n"
        "Ctrl is ten times finer, Esc cancels. Double-click a point or a band to type the angle.\n"
        "Shift-drag from point to point: the second must come after the first."
    )

    def __init__(
        self,
        design: Design,
        width: float,
        height: float,
        unit: str,
        theme: Theme,
        reference: Reference | None = None,
    ) -> None:
        self.design, self.width, self.height, self.unit, self.theme = design, width, height, unit, theme
        rows = _pairs_of_bands(design, reference)
        self.bands: tuple[MotionBand, ...] = tuple(band for band, _ in rows)
        self.dashed: dict[int, MotionBand] = {i: band for i, (_, band) in enumerate(rows) if band is not None}
        self.reference_name = reference[1] if reference is not None and self.dashed else ""
        self.distances: tuple[TimingDistance, ...] = distances(design)
        self.edges: Mapping[int, tuple[tuple[LobeEdge, float], ...]] = _lobe_edges(design)
        self._arrows: dict[int, list[list[QPointF]]] = {}
        self._metrics = QFontMetricsF(font(SMALL))
        names = [text for band in self.bands for text in (band.name, _stroke_text(band))]
        widest = max(map(QFontMetricsF(font(SMALL, bold=True)).horizontalAdvance, names), default=0.0)
        self.left = min(widest, sized(NAMES)) + 22.0
        self.right = max(width - EDGE, self.left + 36.0)
        self.footer_height = sized(BOTTOM if height >= LOW or self.reference_name else NUMBERS)
        self.band_height = max((height - TOP - self.footer_height) / max(len(self.bands), 1), 12.0)
        self._room = sized(ROOM) if self.band_height >= sized(LOW_BAND) else 4.0

    # -- positions -------------------------------------------------------------------------------------

    @property
    def degree(self) -> float:
        """Pixels per degree."""
        return (self.right - self.left) / 360.0

    def x(self, angle: Any) -> Any:
        """Horizontal position of a machine angle."""
        return self.left + angle * self.degree

    def angle(self, x: float) -> float:
        """Machine angle at a horizontal position, 0 ... 360."""
        return min(max((x - self.left) / self.degree, 0.0), 360.0)

    def box(self, index: int) -> QRectF:
        """Box of the band of a drive."""
        return QRectF(self.left, TOP + index * self.band_height, self.right - self.left, self.band_height)

    def y(self, index: int, level: Any) -> Any:
        """Vertical position of a level 0 ... 1 in the band of a drive."""
        box = self.box(index)
        low, high = box.bottom() - self._room, box.top() + self._room
        return low - level * (low - high)

    def join_position(self, index: int, join: int) -> QPointF:
        """Position of a join of a drive, or of an edge of its lobe, which are counted after the joins."""
        edge = self.edge(index, join)
        angle = self.bands[index].joins[join] if edge is None else edge[1]
        return QPointF(self.x(angle), self.y(index, self._level(index, angle)))

    def edge(self, index: int, join: int) -> tuple[LobeEdge, float] | None:
        """Edge of the lobe of a drive with its machine angle; None for a join of the motion."""
        number = join - len(self.bands[index].joins)
        return self.edges[index][number] if number >= 0 else None

    def band_at(self, point: QPointF) -> int | None:
        """Number of the drive whose band or name is at a point."""
        number = int((point.y() - TOP) // self.band_height)
        return number if 0 <= number < len(self.bands) and point.x() <= self.width else None

    def join_at(self, point: QPointF) -> tuple[int, int] | None:
        """Drive and join at a point: the nearest join, else the nearest join line of the band; None between dwells."""
        joins = [(hypot(p.x() - point.x(), p.y() - point.y()), join) for join, p in self._events]
        distance, nearest = min(joins, default=(REACH + 1.0, (0, 0)))
        if distance <= REACH:
            return nearest
        index = self.band_at(point)
        lines = [(abs(p.x() - point.x()), join) for join, p in self._events if join[0] == index]
        distance, nearest = min(lines, default=(LINE_REACH + 1.0, (0, 0)))
        return nearest if distance <= LINE_REACH else None

    def row_at(self, point: QPointF) -> int | None:
        """Row of the sequence conditions whose arrow is at a point."""
        for row in range(len(self.distances)):
            for line in self._arrow(row):
                for a, b in pairwise(line):
                    box = QRectF(a, b).normalized().adjusted(-LINE_REACH, -LINE_REACH, LINE_REACH, LINE_REACH)
                    if box.contains(point) and self.left <= point.x() <= self.right:
                        return row
        return None

    @cached_property
    def _events(self) -> list[tuple[tuple[int, int], QPointF]]:
        """Drive, join and position of each event, of each join between two moving segments, and of each edge of a lobe."""
        events = []
        for index, (drive, band) in enumerate(zip(self.design.drives, self.bands, strict=True)):
            motion = drive.motion
            for join in range(len(band.joins)):
                assert motion is not None
                if motion.segments[join - 1].rise or motion.segments[join].rise:
                    events.append(((index, join), self.join_position(index, join)))
            numbers = range(len(band.joins), len(band.joins) + len(self.edges.get(index, ())))
            events += [((index, number), self.join_position(index, number)) for number in numbers]
        return events

    @cached_property
    def _joins_of(self) -> dict[str, tuple[int, int]]:
        """Drive and join of each event."""
        rows = [(index, join) for index, band in enumerate(self.bands) for join in range(len(band.joins))]
        return {event: row for row in rows for event in events_at(self.design, *row)}

    def _level(self, index: int, angle: float) -> float:
        band = self.bands[index]
        return float(np.interp(angle, band.angles, band.level))

    def _arrow(self, row: int) -> list[list[QPointF]]:
        """Lines of an arrow from the first event to the level of the second, then to it; two at the end of the turn."""
        if row in self._arrows:
            return self._arrows[row]
        timing, distance = self.design.timing[row], self.distances[row]
        first, second = (self._joins_of[named_event(self.design, event)] for event in (timing.first, timing.second))
        begin, end = self.join_position(*first), self.join_position(*second)
        start = end.x() - distance.after_deg * self.degree
        lines = []
        for turn in (0.0, 360.0 * self.degree, -360.0 * self.degree):
            line = [QPointF(start + turn, begin.y()), QPointF(start + turn, end.y()), QPointF(end.x() + turn, end.y())]
            low, high = min(p.x() for p in line), max(p.x() for p in line)
            if high >= self.left - 1e-6 and low <= self.right + 1e-6:
                lines.append(line)
        self._arrows[row] = lines
        return lines

    # -- values ----------------------------------------------------------------------------------------

    def value(self, angle: float) -> float:
        """Angle in the unit of the axis."""
        return milliseconds(self.design, angle) if self.unit == MILLISECONDS else angle

    def text(self, angle: float) -> str:
        """Angle in the unit of the axis, with the unit."""
        value = self.value(angle)
        return with_unit(digits(value) if self.unit == MILLISECONDS else short(value), AXES[self.unit])

    def degrees_and_ms(self, angle: float) -> str:
        """Angle in degrees and in milliseconds."""
        return f"{with_unit(short(angle), '°')}  {with_unit(digits(milliseconds(self.design, angle)), 'ms')}"

    def condition_text(self, row: int) -> str:
        """Distance from the first to the second event, and its least value, such as ``3° ≥ 2°``."""
        timing, distance = self.design.timing[row], self.distances[row]
        after = self.text(distance.after_deg)
        if self.unit == MILLISECONDS:
            after = digits(self.value(distance.after_deg), 3)
        return f"{after} {'≥' if distance.kept else '<'} {self.text(timing.least_deg)}"

    def lines(self, pair: Sequence[int]) -> list[tuple[str, bool]]:
        """Lines below the chart in a file, and whether each is violated: the distances, and the overlap of a pair of drives."""
        lines = []
        for row, timing in enumerate(self.design.timing):
            is_violated = not self.distances[row].kept
            text = f"{event_text(timing.second)} after {event_text(timing.first)}: {self.condition_text(row)}"
            lines.append((f"{text}{', violated' if is_violated else ''}", is_violated))
        if len(pair) == 2:
            names = " and ".join(self.bands[number].name for number in pair)
            overlaps = together(self.design, *pair)
            text = ", ".join(f"{self.text(begin)} - {self.text(end % 360.0)}" for begin, end in overlaps)
            lines.append((f"{names} both move: {text or 'never'}", False))
        return lines

    # -- painting --------------------------------------------------------------------------------------

    def _pen(self, colour: str, width: float = THIN, dash: tuple[float, ...] = ()) -> QPen:
        """Pen that scales with the page."""
        pen = self.theme.pen(colour, width, dash)
        pen.setCosmetic(False)
        return pen

    def paint(self, painter: QPainter, shown: ChartHighlights) -> None:
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(font(SMALL))
        self._text_boxes: list[QRectF] = []
        for index, band in enumerate(self.bands):
            for begin, end in band.moving:
                colour = QColor(tint(self.theme.drive(index), self.theme.paper))
                self._fill(painter, self.box(index), begin, end, colour)
        self._paint_axis(painter)
        for index in range(len(self.bands)):
            self._paint_band(painter, index, index == shown.selected)
        self._paint_pair(painter, shown.pair)
        self._paint_forbidden(painter, shown.forbidden)
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
            painter.drawLine(self.join_position(*shown.link[0]), shown.link[1])
        self._paint_label(painter, shown)
        painter.restore()

    def paint_cursor(self, painter: QPainter, machine: float) -> None:
        """Paint a line at a machine angle [deg]."""
        x = self.x(machine)
        painter.setPen(self._pen(self.theme.ink))
        painter.drawLine(QPointF(x, TOP), QPointF(x, self.height - self.footer_height + 4.0))

    def _paint_axis(self, painter: QPainter) -> None:
        widest = self._metrics.horizontalAdvance("0000") + 14.0
        room = max(int((self.right - self.left) / widest), 2)
        if self.unit != MILLISECONDS:
            step = next(step for step in (15, 30, 45, 60, 90, 180) if 360 / step <= room or step == 180)
            marks = [(float(angle), str(angle)) for angle in range(0, 361, step)]
        else:
            turn = milliseconds(self.design, 360.0)
            values, _ = ticks(0.0, turn, min(room, 12))
            marks = [(value / turn * 360.0, short(value)) for value in values]
        self._paint_marks(painter, marks)
        is_time = self.unit == MILLISECONDS
        self._paint_axis_name(
            painter, f"Time [ms] at {short(self.design.speed_rpm)} rpm" if is_time else "Machine angle [°]"
        )

    def _paint_marks(self, painter: QPainter, marks: Sequence[tuple[float, str]]) -> None:
        """Paint a line and a text at each angle of the axis."""
        theme, bottom = self.theme, self.height - self.footer_height
        for angle, text in marks:
            x = self.x(angle)
            painter.setPen(self._pen(theme.faint))
            painter.drawLine(QPointF(x, TOP), QPointF(x, bottom))
            painter.setPen(self._pen(theme.quiet))
            painter.drawLine(QPointF(x, bottom), QPointF(x, bottom + 4.0))
            painter.setPen(QColor(theme.ink))
            painter.drawText(QRectF(x - 40.0, bottom + 4.0, 80.0, 14.0), Qt.AlignmentFlag.AlignCenter, text)

    def _paint_axis_name(self, painter: QPainter, name: str) -> None:
        """Paint the name of the axis below its numbers, and that of the dashed curves at its end."""
        if self.footer_height < sized(BOTTOM):
            return
        painter.setPen(QColor(self.theme.quiet))
        row = QRectF(self.left, self.height - self.footer_height + 17.0, self.right - self.left, 15.0)
        painter.drawText(row, Qt.AlignmentFlag.AlignCenter, name)
        if self.reference_name:
            free = (row.width() - self._metrics.horizontalAdvance(name)) / 2.0 - 8.0
            text = self._metrics.elidedText(f"{DASHED_MARK} {self.reference_name}", Qt.TextElideMode.ElideRight, free)
            painter.drawText(row, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, text)

    def _paint_band(self, painter: QPainter, index: int, selected: bool) -> None:
        theme, band, box, colour = self.theme, self.bands[index], self.box(index), self.theme.drive(index)
        painter.setPen(self._pen(theme.faint))
        painter.drawLine(QPointF(0.0, box.bottom()), box.bottomRight())
        painter.fillRect(QRectF(0.0, box.top() + 3.0, 6.0 if selected else 4.0, box.height() - 6.0), brush(colour))
        painter.setFont(font(SMALL, bold=selected))
        painter.setPen(QColor(theme.ink))
        column = QRectF(10.0, box.top(), self.left - 16.0, box.height())
        name = QFontMetricsF(painter.font()).elidedText(band.name, Qt.TextElideMode.ElideRight, column.width())
        below = _stroke_text(band) if box.height() >= sized(TWO_LINES) else ""
        painter.drawText(column.adjusted(0.0, 0.0, 0.0, -15.0 if below else 0.0), Qt.AlignmentFlag.AlignVCenter, name)
        painter.setFont(font(SMALL))
        painter.setPen(QColor(theme.quiet))
        painter.drawText(column.adjusted(0.0, 15.0, 0.0, 0.0), Qt.AlignmentFlag.AlignVCenter, below)
        if not band.joins:
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, "Turns with the shaft, without a motion")
            return
        painter.setPen(self._pen(theme.faint))
        for angle in band.joins:
            painter.drawLine(QPointF(self.x(angle), box.top() + 2.0), QPointF(self.x(angle), box.bottom() - 2.0))
        if index in self.dashed:
            self._paint_curve(painter, index, self.dashed[index], self._pen(colour, THIN, DASHED))
        self._paint_curve(painter, index, band, self._pen(colour, 2.0 if selected else OUTLINE))
        self._paint_strokes(painter, index)

    def _paint_curve(self, painter: QPainter, index: int, band: MotionBand, pen: QPen) -> None:
        changes = np.diff(band.level, 1, prepend=np.nan, append=np.nan) != 0.0  # a dwell needs its ends only
        needed = changes[:-1] | changes[1:]
        x, y = self.x(band.angles[needed]), self.y(index, band.level[needed])
        painter.setPen(pen)
        painter.drawPolyline(QPolygonF(list(map(QPointF, x.tolist(), y.tolist()))))

    def _paint_strokes(self, painter: QPainter, index: int) -> None:
        """Write names such as ``rise 1  64°`` along the upper edge of a band, shortened to the length of the stroke."""
        drive, box = self.design.drives[index], self.box(index)
        if drive.motion is None or self._room < sized(ROOM):
            return
        painter.setPen(QColor(self.theme.text_colour(self.theme.drive(index))))
        for stroke in strokes(drive.motion):
            span = stroke.end - stroke.start
            name = stroke.name.replace(".", " ")
            begin = (stroke.start + drive.phase) % 360.0
            low, high = max(_within(begin, begin + span), key=lambda part: part[1] - part[0])
            middle, room = (low + high) / 2.0, (high - low) * self.degree
            for text in (f"{name}  {self.text(span)}", name, stroke.name.rpartition(".")[2]):
                width = self._metrics.horizontalAdvance(text)
                text_box = QRectF(self.x(middle) - width / 2.0, box.top() + 1.0, width, sized(TEXT_HEIGHT))
                if width <= room:
                    painter.drawText(text_box, Qt.AlignmentFlag.AlignCenter, text)
                    self._text_boxes.append(text_box)
                    break

    def _paint_points(self, painter: QPainter, shown: ChartHighlights) -> None:
        for join, point in self._events:
            highlighted, colour = join in shown.joins, self.theme.drive(join[0])
            radius = POINT + (1.5 if highlighted else 0.0)
            painter.setPen(self._pen(colour, OUTLINE))
            painter.setBrush(brush(colour if highlighted else self.theme.paper))
            if highlighted:
                box = self.box(join[0])
                painter.drawLine(QPointF(point.x(), box.top()), QPointF(point.x(), box.bottom()))
            painter.drawEllipse(point, radius, radius)
            self._text_boxes.append(QRectF(point.x() - radius, point.y() - radius, 2.0 * radius, 2.0 * radius))
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _paint_arrow(self, painter: QPainter, row: int, selected: bool) -> None:
        colour = self._colour(row)
        pen = self._pen(colour, 2.0 if selected else THIN)
        for line in self._arrow(row):
            painter.setPen(pen)
            painter.drawPolyline(QPolygonF(line))
            sign = 1.0 if line[2].x() >= line[1].x() else -1.0
            tip = line[2] - QPointF(sign * POINT, 0.0)
            back = tip.x() - sign * ARROW
            painter.setBrush(brush(colour))
            painter.drawPolygon(QPolygonF([tip, QPointF(back, tip.y() - 3.0), QPointF(back, tip.y() + 3.0)]))
            painter.setBrush(Qt.BrushStyle.NoBrush)

    def _colour(self, row: int) -> str:
        return self.theme.ink if self.distances[row].kept else self.theme.limit

    def _paint_distance(self, painter: QPainter, row: int, selected: bool) -> None:
        """Write a distance next to its arrow where the space is free; for a violated or selected row in any case."""
        text = self.condition_text(row)
        painter.setFont(font(SMALL, bold=selected))
        size = QFontMetricsF(painter.font()).horizontalAdvance(text) + 6.0, sized(TEXT_HEIGHT)
        start, corner, end = self._arrow(row)[0]
        left, right = min(corner.x(), end.x()), max(corner.x(), end.x())
        middle = max(min((left + right) / 2.0, self.right - size[0] / 2.0), self.left + size[0] / 2.0)
        gap = POINT + 3.0
        corners = [
            (x, y)
            for y in (end.y() - sized(TEXT_HEIGHT) - gap, end.y() + gap, end.y() - 0.5 * sized(TEXT_HEIGHT))
            for x in (right + gap, left - gap - size[0], middle - size[0] / 2.0)
        ]
        corners += [
            (x, start.y() + part * (corner.y() - start.y()) - 6.5)
            for part in ALONG
            for x in (corner.x() + 3.0, corner.x() - 3.0 - size[0])
        ]
        boxes = [QRectF(x, y, *size) for x, y in corners if x >= self.left and x + size[0] <= self.right and y >= 0.0]
        free = [box for box in boxes if not self._is_taken(box)]
        required = selected or not self.distances[row].kept
        if not free and (not required or not boxes):
            painter.setFont(font(SMALL))
            return
        box = (free or boxes)[0]
        self._text_boxes.append(box)
        painter.fillRect(box, brush(self.theme.paper, 0.8))
        painter.setPen(QColor(self._colour(row)))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)
        painter.setFont(font(SMALL))

    def _is_taken(self, box: QRectF) -> bool:
        """Whether a box covers a text, a point, an arrow or a curve."""
        if any(box.intersects(taken) for taken in (*self._text_boxes, *self._strokes)):
            return True
        return any(
            ((abs(x - box.center().x()) <= box.width() / 2.0) & (abs(y - box.center().y()) <= box.height() / 2.0)).any()
            for x, y in self._curves
        )

    @cached_property
    def _strokes(self) -> list[QRectF]:
        """Boxes of all lines of the arrows."""
        lines = (line for row in range(len(self.distances)) for line in self._arrow(row))
        return [QRectF(a, b).normalized().adjusted(-0.5, -0.5, 0.5, 0.5) for line in lines for a, b in pairwise(line)]

    @cached_property
    def _curves(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Curves of all bands, the dashed ones included, as points closer than any text."""
        angles = np.linspace(0.0, 360.0, 721)
        return [
            (self.x(angles), self.y(i, np.interp(angles, band.angles, band.level)))
            for i, band in (*enumerate(self.bands), *self.dashed.items())
            if band.joins
        ]

    def _paint_pair(self, painter: QPainter, pair: Sequence[int]) -> None:
        if len(pair) != 2:
            return
        high, low = self.box(min(pair)), self.box(max(pair))
        for begin, end in together(self.design, *pair):
            colour = brush(self.theme.limit, 0.13).color()
            self._fill(painter, QRectF(high.topLeft(), low.bottomRight()), begin, end, colour)

    def _paint_forbidden(self, painter: QPainter, spans: Sequence[ForbiddenSpan]) -> None:
        """Fields over the bands of the drives whose bodies are too near, with the names of the bodies."""
        for span in spans:
            field = QRectF(self.box(span.drives[0]).topLeft(), self.box(span.drives[-1]).bottomRight())
            colour = brush(self.theme.limit, 0.22).color()
            for band in map(self.box, span.drives):
                self._fill(painter, band, span.begin, span.end, colour)
            painter.setPen(QPen(QColor(self.theme.limit), 1.0))
            for angle in (span.begin % 360.0, span.end % 360.0):
                painter.drawLine(QPointF(self.x(angle), field.top()), QPointF(self.x(angle), field.bottom()))
            is_adjacent = span.drives[-1] - span.drives[0] == len(span.drives) - 1
            level = field.center().y() if is_adjacent else self.box(span.drives[0]).bottom() - sized(TEXT_HEIGHT) / 2.0
            width = self._metrics.horizontalAdvance(span.names) + 6.0
            middle = self.x((0.5 * (span.begin + span.end)) % 360.0)
            left = min(max(middle - width / 2.0, self.left), self.right - width)
            box = QRectF(left, level - sized(TEXT_HEIGHT) / 2.0, width, sized(TEXT_HEIGHT))
            self._text_boxes.append(box)
            painter.fillRect(box, brush(self.theme.paper, 0.85))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, span.names)

    def _paint_pair_text(self, painter: QPainter, pair: Sequence[int]) -> None:
        for begin, end in together(self.design, *pair) if len(pair) == 2 else ():
            text = self.text(end - begin)
            width = self._metrics.horizontalAdvance(text) + 6.0
            x = self.x(((begin + end) / 2.0) % 360.0)
            x = min(max(x, self.left + width / 2.0), self.right - width / 2.0)
            top = self.box(min(pair)).bottom() - sized(TEXT_HEIGHT) - 1.0
            box = QRectF(x - width / 2.0, top, width, sized(TEXT_HEIGHT))
            painter.fillRect(box, brush(self.theme.paper, 0.85))
            painter.setPen(QColor(self.theme.limit))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _fill(self, painter: QPainter, box: QRectF, begin: float, end: float, colour: QColor) -> None:
        for low, high in _within(begin, end):
            painter.fillRect(QRectF(self.x(low), box.top(), (high - low) * self.degree, box.height()), colour)

    def _paint_label(self, painter: QPainter, shown: ChartHighlights) -> None:
        if not shown.label or not shown.joins:
            return
        x = self.join_position(*shown.joins[0]).x()
        painter.setFont(font(SMALL, bold=True))
        width = QFontMetricsF(painter.font()).horizontalAdvance(shown.label) + 10.0
        left = x + 10.0 if x + 10.0 + width <= self.right else self.right - width
        box = QRectF(max(left, 2.0), self._label_top(shown.joins[0][0]), width, 17.0)
        painter.fillRect(box, brush(self.theme.paper, 0.94))
        painter.setPen(self._pen(self.theme.faint))
        painter.drawRect(box)
        painter.setPen(QColor(self.theme.limit if shown.is_invalid else self.theme.ink))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, shown.label)

    def _label_top(self, drive: int) -> float:
        """Top of the label of a drag, clear of the dragged point."""
        band = self.box(drive)
        return band.top() - 19.0 if drive == len(self.bands) - 1 > 0 else band.bottom() + 2.0


def tint(colour: str, paper: str) -> str:
    """Opaque tint of a colour on a paper, which is filled much faster than a transparent colour."""
    mixed = (round(TINT * a + (1.0 - TINT) * b) for a, b in zip(rgb(colour), rgb(paper), strict=True))
    return QColor(*mixed).name()


def _within(begin: float, end: float) -> Iterator[tuple[float, float]]:
    """Split a range of the turn into ranges within 0 ... 360."""
    yield begin, min(end, 360.0)
    if end > 360.0:
        yield 0.0, end - 360.0


def _stroke_text(band: MotionBand) -> str:
    """Stroke of a drive with its unit, such as ``150 mm``."""
    return brief(band.stroke, UNITS[band.unit].symbol, 4) if band.unit else ""


def event_text(event: str) -> str:
    """Event in words, such as ``Feed return 1 end``."""
    name = drive_of(event)
    return f"{name} {event.removeprefix(name + '.').replace('.', ' ')}"
