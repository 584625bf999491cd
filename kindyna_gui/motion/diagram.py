"""Displacement diagram."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from math import hypot

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetricsF, QPainter
from PySide6.QtWidgets import QWidget

from core.design import UNITS, Design, Motion, SplineCurve, join_angles, join_levels, join_range, require_motion
from core.design.edits import is_dwell
from core.frozen import frozen
from core.motion import Join
from core.output.lines import shortest
from core.study import Quantity, Study
from kindyna_gui.labels import sentence, value_text
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.curves import NO_BANDS, CurvePlot
from kindyna_gui.pictures.plots.lines import Z_CURVE, Z_REFERENCE
from kindyna_gui.pictures.plots.plot import Span, peak, shown_range, spans
from kindyna_gui.pictures.plots.quantities import Curve
from kindyna_gui.pictures.style import DASHED, SCREEN, SMALL, THIN, brush, font
from kindyna_gui.pictures.units import MINUS, digits, nice_below, readable, short, with_unit
from kindyna_gui.settings import point, sized, symbol_of

# -- grips -----------------------------------------------------------------------------------------------

POINT, LINE, LEVEL = "point", "line", "level"
REACH, LINE_REACH = 7.0, 4.0  # pixels from a point, from a line
AWAY = 8.0  # a dwell's line begins so many pixels from its ends, which belong to the points
TREMBLE = 3.0  # pixels that a hand may tremble in a direction that it does not mean
ANGLE_STEP = 0.5  # degrees
LEVEL_PIXELS = 2.5  # the most that a step of levels, 1, 2 or 5 times a power of ten, is high
FINE = 0.1  # of the travel, and of the steps


@frozen
class Grip:
    """Something to take hold of: a join's point (angle and level), the line through it (its angle), or the level line
    of a dwell. ``segment``: of a dwell's line the dwell, else the segment before the join."""

    kind: str
    join: int
    segment: int

    @property
    def turns(self) -> bool:
        """Whether it can be drawn along the cam angle."""
        return self.kind != LEVEL and self.join > 0

    @property
    def lifts(self) -> bool:
        """Whether it can be drawn to another level."""
        return self.kind != LINE


@frozen
class DiagramScale:
    """How the diagram is laid out: pixels from ``left`` to ``right`` are 0 ... 360 degrees, from ``bottom`` up to
    ``top`` (pixels count downwards) the levels ``low`` ... ``high``."""

    left: float
    right: float
    top: float
    bottom: float
    low: float
    high: float

    def x(self, angle: float) -> float:
        return self.left + angle / 360.0 * (self.right - self.left)

    def y(self, level: float) -> float:
        return self.bottom - (level - self.low) / (self.high - self.low) * (self.bottom - self.top)

    def angle(self, x: float) -> float:
        return min(max((x - self.left) / self.degree, 0.0), 360.0)

    @property
    def degree(self) -> float:
        """Pixels that are one degree."""
        return max(self.right - self.left, 1.0) / 360.0

    @property
    def unit(self) -> float:
        """Pixels that are one unit of level."""
        return max(self.bottom - self.top, 1.0) / (self.high - self.low)

    @property
    def level_step(self) -> float:
        """A round step of levels that a hand can aim at."""
        return nice_below(LEVEL_PIXELS / self.unit)


def places(motion: Motion, scale: DiagramScale) -> Iterator[tuple[int, float, float]]:
    """Every join and where it stands [pixels]; join 0 stands at both ends."""
    levels = join_levels(motion)
    for join, angle in enumerate(join_angles(motion)):
        yield join, scale.x(angle), scale.y(levels[join])
    yield 0, scale.x(360.0), scale.y(levels[0] + motion.gain)


def grip_at(motion: Motion, scale: DiagramScale, x: float, y: float) -> Grip | None:
    """What the mouse would take hold of: the nearest point, else the nearest line, else the level line of a dwell."""
    joins_at, last = list(places(motion, scale)), len(motion.segments) - 1
    away, join = min((hypot(x - px, y - py), join) for join, px, py in joins_at)
    if away <= REACH:
        return Grip(POINT, join, join - 1 if join else last)
    if not scale.top <= y <= scale.bottom:
        return None
    lines = [(abs(x - px), join) for join, px, _ in joins_at if join > 0]
    away, join = min(lines, default=(math.inf, 0))
    if away <= LINE_REACH:
        return Grip(LINE, join, join - 1)
    for i, segment in enumerate(motion.segments):
        _, begin, level = joins_at[i]
        if is_dwell(segment) and begin + AWAY < x < joins_at[i + 1][1] - AWAY and abs(y - level) <= LINE_REACH:
            return Grip(LEVEL, i, i)
    return None


def segment_at(motion: Motion, angle: float) -> int:
    """The segment at a cam angle [deg]; at a join the one behind it."""
    return max(i for i, begin in enumerate(join_angles(motion)) if begin <= angle)


def snapped(value: float, step: float, direction: int = 0) -> float:
    """The nearest multiple of a step, or the next one up (direction 1) or down (-1), in decimals."""
    count = value / step
    whole = {0: round(count), 1: math.floor(count + 1e-6) + 1, -1: math.ceil(count - 1e-6) - 1}[direction]
    return round(whole * step, 10) + 0.0


def snapped_angle(angle: float) -> float:
    """A cam angle [deg] snapped where it was pointed at; a round one, which was typed or stepped to, stays."""
    typed = round(angle, 2)
    return typed + 0.0 if abs(typed - angle) < 1e-6 else snapped(angle, ANGLE_STEP)


class Pull:
    """One pull at a grip, from the press of the button on: each move of the mouse gives the angle and the level that
    the join shall have, None where it keeps what it had.

    A direction counts once the hand has moved in it by more than it trembles, so a point drawn sideways keeps its
    level. Values snap to steps, ``fine`` ten times finer at a tenth of the travel; ``one_direction``: only in the direction in
    which the hand has moved more. An angle stays between its neighbours.
    """

    def __init__(self, motion: Motion, grip: Grip, scale: DiagramScale) -> None:
        self.motion, self.grip = motion, grip
        self._scale = scale  # as it was: the diagram may grow meanwhile
        self._angle, self._level = join_angles(motion)[grip.join], join_levels(motion)[grip.join]
        self._range = join_range(motion, grip.join)
        self._travel = [0.0, 0.0]  # of the hand, pixels
        self._moved = [0.0, 0.0]  # of the join, pixels
        self._intended = [False, False]

    def move(
        self, dx: float, dy: float, fine: bool = False, one_direction: bool = False
    ) -> tuple[float | None, float | None]:
        """The hand has moved on by so many pixels."""
        for k, by in enumerate((dx, dy)):
            self._travel[k] += by
            self._moved[k] += by * (FINE if fine else 1.0)
            self._intended[k] = self._intended[k] or abs(self._travel[k]) > TREMBLE
        sideways = abs(self._travel[0]) >= abs(self._travel[1])
        turns = self.grip.turns and self._intended[0] and (not one_direction or sideways or not self.grip.lifts)
        lifts = self.grip.lifts and self._intended[1] and (not one_direction or not sideways or not self.grip.turns)
        by = FINE if fine else 1.0
        return self._turned(by) if turns else None, self._lifted(by) if lifts else None

    def _turned(self, by: float) -> float:
        wanted = snapped(self._angle + self._moved[0] / self._scale.degree, ANGLE_STEP * by)
        low, high = self._range
        return min(max(wanted, low), high)

    def _lifted(self, by: float) -> float:
        return snapped(self._level - self._moved[1] / self._scale.unit, self._scale.level_step * by)


def nudged(
    motion: Motion, join: int, scale: DiagramScale, direction: tuple[int, int], fine: bool = False
) -> tuple[float | None, float | None]:
    """Angle and level of a join one step on by keys: -1, 0 or 1 in angle and in level."""
    by = FINE if fine else 1.0
    low, high = join_range(motion, join)
    angle = min(max(snapped(join_angles(motion)[join], ANGLE_STEP * by, direction[0]), low), high)
    level = snapped(join_levels(motion)[join], scale.level_step * by, direction[1])
    return angle if direction[0] and join else None, level if direction[1] else None


# -- marks -----------------------------------------------------------------------------------------------

LETTERS = "svaj"
_PER = ("", "/rad", "/rad²", "/rad³")
_ORDERS = ("displacement", "velocity", "acceleration", "jerk")
_JERK = 3


@frozen
class JoinMark:
    """One quantity at a join: its letter; where it jumps the size of the jump, bare and with its unit; the tone of the theme.

    A jump of jerk is usual and stays quiet; every other one is red.
    """

    letter: str
    size: str = ""
    sized: str = ""
    tone: str = "good"

    @property
    def jumps(self) -> bool:
        """Whether the quantity jumps there."""
        return bool(self.size)

    @property
    def loud(self) -> bool:
        """Whether the jump is a fault, and not only worth knowing."""
        return self.tone == "limit"

    @property
    def colour(self) -> str:
        """The colour of that tone."""
        return str(getattr(SCREEN, self.tone))


def marks(join: Join, motion: Motion) -> tuple[JoinMark, ...]:
    """s, v, a and j at a join."""
    return tuple(_mark(join, motion, order) for order in range(4))


def _mark(join: Join, motion: Motion, order: int) -> JoinMark:
    if not join.jumps[order]:
        return JoinMark(LETTERS[order])
    size = jump_text(join, order, motion).lstrip(MINUS)
    sized = with_unit(size, UNITS[motion.unit].symbol + _PER[order])
    return JoinMark(LETTERS[order], size, sized, "quiet" if order == _JERK else "limit")


def jump_text(join: Join, order: int, motion: Motion) -> str:
    """The jump with its sign, in the motion's unit per radian of cam angle."""
    return digits(float(join.jump[order]) / motion.scale, 3)


FIRST = 3  # of the variants: the first loud jump with its size

Parts = tuple[tuple[str, str], ...]
"""Texts and their colours, from left to right."""


def variants(row: Sequence[JoinMark]) -> tuple[Parts, ...]:
    """The texts for the marks of a join, the longest first: every jump with its size and unit; only the loud ones;
    without units; only the first; none."""
    loud = next((mark for mark in row if mark.loud), None)
    return (
        tuple((_mark_text(mark, mark.sized), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.sized if mark.loud else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.size if mark.loud else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.size if mark is loud else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, ""), mark.colour) for mark in row),
    )


def _mark_text(mark: JoinMark, size: str) -> str:
    if not mark.jumps:
        return mark.letter
    return f"Δ{mark.letter}\u00a0{size}" if size else f"Δ{mark.letter}"


def join_text(join: Join, motion: Motion) -> str:
    """``s v a Δj``: a letter where the quantity is continuous, its jump where not; the first loud one with its size."""
    return " ".join(text for text, _ in variants(marks(join, motion))[FIRST])


def join_help(join: Join, motion: Motion) -> str:
    """The join in sentences: what is continuous there, and how far the rest jumps."""
    jumping = [k for k in range(4) if join.jumps[k]]
    smooth = [_ORDERS[k] for k in range(4) if k not in jumping]
    rows = [f"continuous in {', '.join(smooth)}"] if smooth else []
    unit = UNITS[motion.unit].symbol
    rows += [f"{_ORDERS[k]} jumps by {with_unit(jump_text(join, k, motion), unit + _PER[k])}" for k in jumping]
    return "\n".join(map(sentence, rows))


# -- diagram ---------------------------------------------------------------------------------------------

FLAT = 50.0  # shown above and below a motion without any rise, in its unit
ANGLES = 21  # height of the numbers below, pixels
RADIUS = 4.0  # of a join's point, pixels
LETTER = 10  # height of a mark's letter, pixels
ROW = 11.0  # from mark to mark
BESIDE = 4.0  # of the marks from their line


@frozen
class JoinLabel:
    """Where a join is drawn to; ``refused``: it cannot be there; ``right``: it is the join at 360 degrees."""

    text: str
    refused: bool = False
    right: bool = False


class MotionDiagram(CurvePlot):
    """The diagram without its reactions: ``show_motion`` draws a study, the attributes below what is pointed out.

    chosen   the chosen segment
    over     what the mouse is over, or draws at
    label    beside the drawn join
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._axes["bottom"].show_title("", self._theme.ink)  # the room is wanted for the curve
        self.setViewportUpdateMode(self.ViewportUpdateMode.FullViewportUpdate)
        self.chosen = 0
        self.over: Grip | None = None
        self.label: JoinLabel | None = None
        self.motion: Motion | None = None
        self._marks: list[tuple[JoinMark, ...]] = []
        self._held: tuple[float, float] | None = None
        self._now, self._was = self._curve(Z_CURVE), self._curve(Z_REFERENCE)
        self._was.setPen(self._theme.pen(self._theme.quiet, THIN, DASHED))
        self._picture: tuple[object, ...] = ()
        self._rows: tuple[np.ndarray, ...] = ()

    def update_style(self) -> None:
        super().update_style()
        self._picture = ()

    def _curve(self, z: float) -> pg.PlotCurveItem:
        item = pg.PlotCurveItem(antialias=True)
        item.setZValue(z)
        self._view.addItem(item, ignoreBounds=True)
        return item

    def show_angles(self, on: bool) -> None:
        """The numbers along the bottom, which a plot below may have instead."""
        self.show_numbers(on)

    def _size_axes(self) -> None:
        super()._size_axes()
        if self._numbered_below:
            self._axes["bottom"].setHeight(sized(ANGLES))

    # -- what is drawn ------------------------------------------------------------------------------------

    def show_motion(
        self, study: Study, channel: Quantity, before: np.ndarray | None, bands: Mapping[str, np.ndarray] = NO_BANDS
    ) -> None:
        """Draw the displacement of a study; before: that of the motion before the last edit at as many equally spaced
        cam angles (n,) [the channel's unit], None where there is none; bands: column -> percentiles, within which machines lie.

        Where all would be drawn as it is nothing is touched, and so nothing painted."""
        values = channel.values(study)
        motion = require_motion(study.design)
        picture = (motion, self.chosen, channel.slug, symbol_of(channel.unit.symbol), point(), before is None, *bands)
        rows = (values, *(() if before is None else (before,)), *bands.values())
        if (
            self._held is None
            and picture == self._picture
            and all(a is b or np.array_equal(a, b) for a, b in zip(rows, self._rows, strict=True))
        ):
            return
        self._picture, self._rows = picture if self._held is None else (), rows
        self._angles = np.append(np.rad2deg(study.theta), 360.0)
        curve = Curve(channel, values, self._theme.family(channel.family), gain=motion.gain)
        self._curves, self._theta, self._exact_values = [curve], study.theta, None
        band = bands.get(channel.slug)
        ends = [] if band is None else [band[0], band[-1]]
        shown = [each for each in (values, before, *ends) if each is not None]
        whole = [np.append(row, row[0] + motion.gain) for row in shown]  # what is gained in the turn, too
        low, high = shown_range(whole, (channel.family,), ())
        if all(row.min() == row.max() for row in shown):  # room to lay out a motion in
            low, high = float(values[0]) - FLAT, float(values[0]) + FLAT
        if self._held is None:
            self.rung = readable(channel.unit.symbol, peak(whole))
        else:  # while a join is drawn the picture may grow, but what the hand draws at stays under it
            low, high = min(low, self._held[0]), max(high, self._held[1])
        self._now.setPen(self._theme.pen(curve.colour))
        self._put(self._now, values, motion.gain)
        self._was.setVisible(before is not None)
        if before is not None:
            self._put(self._was, before, motion.gain)
        self._spans = spans(motion)
        self.motion, self._marks = motion, [marks(join, motion) for join in study.program.joins]
        size = self.rung.size
        self._view.setRange(yRange=(low / size, high / size), padding=0.0)
        self._shade([] if band is None else [(curve, band)])
        if QAccessible.isActive():
            self._describe()
        self._view.updateMatrix()  # else painting updates it, and all is painted again
        self._lay()
        self.point_out()

    def _put(self, item: pg.PlotCurveItem, values: np.ndarray, gain: float) -> None:
        item.setData(self._angles, np.append(values, values[:1] + gain) / self.rung.size, skipFiniteCheck=True)

    def hold(self, on: bool) -> None:
        """Keep the range of levels while a join is drawn, but for what grows out of it."""
        frame, size = self.frame(), self.rung.size
        self._held = (frame.low * size, frame.high * size) if on else None

    def point_out(self) -> None:
        """What is chosen, or under the mouse, has changed."""
        self.scene().update()  # with the curves, in one go

    def _names(self, width: float) -> list[tuple[float, str]]:
        return numbered(self._spans, width)

    # -- where it is --------------------------------------------------------------------------------------

    def scale_now(self) -> DiagramScale:
        """How the diagram is laid out at present."""
        box, frame, size = self._view.sceneBoundingRect(), self.frame(), self.rung.size
        return DiagramScale(box.left(), box.right(), box.top(), box.bottom(), frame.low * size, frame.high * size)

    def place_of(self, angle: float, level: float) -> QPointF:
        """Where a cam angle [deg] and a level [the motion's unit] stand in the widget [pixels]."""
        scale = self.scale_now()
        return QPointF(self.mapFromScene(QPointF(scale.x(angle), scale.y(level))))

    def place_of_join(self, join: int) -> QPointF:
        """Where the point of a join stands in the widget [pixels]."""
        assert self.motion is not None
        return self.place_of(join_angles(self.motion)[join], join_levels(self.motion)[join])

    # -- painting -----------------------------------------------------------------------------------------

    def drawForeground(self, painter: QPainter, rect: QRectF) -> None:
        """Everything that is pointed out, over the curves; scene and pixels are one."""
        if self.motion is None:
            return
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        scale = self.scale_now()
        joins_at = list(places(self.motion, scale))
        self._paint_chosen(painter, scale, joins_at)
        self._paint_lines(painter, scale, joins_at)
        self._paint_spline_points(painter, scale)
        self._paint_marks(painter, scale, joins_at)
        self._paint_points(painter, joins_at)
        self._paint_label(painter, scale, joins_at)
        painter.restore()

    def _paint_chosen(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        """A bar above the chosen segment; the level line of a dwell that is pointed at."""
        if self.chosen < len(joins_at) - 1:
            left, right = joins_at[self.chosen][1], joins_at[self.chosen + 1][1]
            painter.fillRect(QRectF(left, scale.top - 1.0, right - left, 3.0), QColor(SCREEN.chosen))
        if self.over is not None and self.over.kind == LEVEL:
            _, left, y = joins_at[self.over.segment]
            painter.setPen(self._theme.pen(SCREEN.chosen, 3.0))
            painter.drawLine(QPointF(left, y), QPointF(joins_at[self.over.segment + 1][1], y))

    def _paint_lines(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)  # upright, and much faster
        for join, x, _ in joins_at[1:-1]:
            pointed = self.over is not None and self.over.join == join and self.over.kind != LEVEL
            painter.setPen(self._theme.pen(SCREEN.chosen, 2.0) if pointed else self._theme.pen(SCREEN.line))
            painter.drawLine(QPointF(x, scale.top), QPointF(x, scale.bottom))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)

    def _paint_points(self, painter: QPainter, joins_at: Sequence[tuple[int, float, float]]) -> None:
        own = (self.chosen + 1) % max(len(joins_at) - 1, 1)
        for join, x, y in joins_at:
            pointed = self.over is not None and self.over.join == join and self.over.kind != LINE
            colour = SCREEN.chosen if pointed or join == own else self._curves[0].colour
            painter.setPen(self._theme.pen(colour, 1.5))
            painter.setBrush(brush(colour if pointed else self._theme.paper))
            radius = RADIUS + (1.0 if pointed else 0.0)
            painter.drawEllipse(QPointF(x, y), radius, radius)

    def _paint_spline_points(self, painter: QPainter, scale: DiagramScale) -> None:
        """What splines must pass through: a small square each."""
        assert self.motion is not None
        painter.setPen(self._theme.pen(self._curves[0].colour))
        painter.setBrush(brush(self._theme.paper))
        begins, levels = join_angles(self.motion), join_levels(self.motion)
        for begin, level, segment in zip(begins, levels, self.motion.segments, strict=True):
            for each in segment.curve.points if isinstance(segment.curve, SplineCurve) else ():
                if each.value is not None:
                    x, y = scale.x(begin + each.at_deg), scale.y(level + each.value)
                    painter.drawRect(QRectF(x - 2.5, y - 2.5, 5.0, 5.0))

    def _paint_marks(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        """s v a j beside each line, in that half of the height where its point is not."""
        row = sized(ROW)
        height = row * 4.0
        if scale.bottom - scale.top < height + 12.0:
            return
        painter.setFont(font(LETTER))
        rooms = rooms_beside([x for _, x, _ in joins_at])
        for k, ((_, x, y), (left, room)) in enumerate(zip(joins_at[1:], rooms, strict=True)):
            top = scale.bottom - height - 3.0 if y < (scale.top + scale.bottom) / 2.0 else scale.top + 5.0
            self._paint_stack(painter, self._marks[k], x, top, left, room - 2.0 * BESIDE)

    def _paint_stack(
        self, painter: QPainter, row: Sequence[JoinMark], x: float, top: float, left: bool, room: float
    ) -> None:
        """One below the other, each as long as there is room beside the line at ``x``."""
        metrics = QFontMetricsF(painter.font())
        for k, mark in enumerate(row):
            texts = (f"Δ{mark.letter} {mark.sized}", f"Δ{mark.letter} {mark.size}") if mark.loud else ()
            short = f"Δ{mark.letter}" if mark.jumps else mark.letter
            text = next((t for t in texts if metrics.horizontalAdvance(t) <= room), short)
            width = metrics.horizontalAdvance(text)
            box = QRectF(x - BESIDE - width if left else x + BESIDE, top + k * sized(ROW), width, sized(ROW))
            painter.fillRect(box.adjusted(-1.0, 0.0, 1.0, 0.0), brush(self._theme.paper, 0.75))
            painter.setPen(QColor(mark.colour))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_label(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        if self.label is None or self.over is None:
            return
        _, x, y = joins_at[-1 if self.label.right else self.over.join]
        width, height = text_size(self.label.text)
        left = x + 9.0 if x + 14.0 + width <= scale.right else x - 9.0 - width
        up = y - 8.0 - height if y - 12.0 - height >= scale.top else y + 8.0
        box = QRectF(max(left, scale.left + 2.0), up, width, height).adjusted(-3.0, -1.0, 3.0, 1.0)
        painter.fillRect(box, brush(self._theme.paper, 0.92))
        painter.setFont(font(SMALL))
        painter.setPen(QColor(SCREEN.limit if self.label.refused else SCREEN.chosen))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self.label.text)


def label_text(motion: Motion, angle: float | None, level: float | None, join: int) -> str:
    """``76.5°  −150 mm``: where a join is drawn to."""
    at = join_angles(motion)[join] if angle is None else angle
    height = join_levels(motion)[join] if level is None else level
    return f"{shortest(at)}°  {with_unit(short(height), UNITS[motion.unit].symbol)}"


def step_name(before: Design, after: Design, join: int) -> str:
    """The step of the undo stack: ``Move start of segment 3 to 80°, -10 mm``; only what has changed is named."""
    was, now = require_motion(before), require_motion(after)
    texts = [
        value_text(values(now)[join], UNITS[unit])
        for values, unit in ((join_angles, "deg"), (join_levels, now.unit))
        if values(was)[join] != values(now)[join]
    ]
    return f"Move start of segment {join + 1} to {', '.join(texts)}"


def numbered(rows: Sequence[Span], width: float) -> list[tuple[float, str]]:
    """Number and name of each segment where there is room for both, else its number, if there is room for that."""
    ticks = []
    for number, span in enumerate(rows, 1):
        room = (span.end - span.start) / 360.0 * width
        for text in (f"{number}  {span.name}", str(number)):
            if text_size(text)[0] + 6.0 <= room:
                ticks.append(((span.start + span.end) / 2.0, text))
                break
    return ticks


def rooms_beside(ends: Sequence[float]) -> list[tuple[bool, float]]:
    """For each line but the first, at rising places: whether its marks stand to the left, and how wide they may be.

    They stand in the wider segment, those of the last before it; two that face each other share a segment.
    """
    last = len(ends) - 1
    lefts = [k == last or ends[k] - ends[k - 1] > ends[k + 1] - ends[k] for k in range(1, last + 1)]
    rooms = []
    for k, left in enumerate(lefts):
        room = ends[k + 1] - ends[k] if left else ends[k + 2] - ends[k + 1]
        other = k - 1 if left else k + 1
        facing = 0 <= other <= last - 1 and lefts[other] is not left
        rooms.append((left, room / 2.0 if facing else room))
    return rooms
