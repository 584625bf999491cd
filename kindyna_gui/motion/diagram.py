"""Displacement diagram of a motion: the curve, the joins with their marks, and what the mouse can drag.

A grip is a point, line or level that can be dragged. A mark names a quantity at a join: green where it is continuous, with
the size of the jump where it is not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from math import hypot

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetricsF, QPainter
from PySide6.QtWidgets import QWidget

from core.design import UNITS, Design, Motion, SplineCurve, join_angles, join_levels, join_range, require_motion
from core.design.edits import is_dwell
from core.frozen import frozen
from core.motion import Join
from core.number_text import MINUS, shortest
from core.output.drawing.scales import nice_below
from core.output.drawing.turn import peak, shown_range, spans
from core.plot import Span
from core.study import Quantity, Study
from kindyna_gui.labels import sentence, value_text
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.curves import NO_BANDS, PINNED, CurvePlot
from kindyna_gui.pictures.plots.library import pg
from kindyna_gui.pictures.plots.lines import Z_CURVE, Z_REFERENCE
from kindyna_gui.pictures.plots.quantities import Curve, reference_curves
from kindyna_gui.pictures.style import DASHED, SCREEN, SMALL, THIN, brush, font
from kindyna_gui.pictures.units import readable, short, with_unit
from kindyna_gui.settings import point, sized, symbol_of

POINT, LINE, LEVEL = "point", "line", "level"
REACH, LINE_REACH = 7.0, 4.0  # pixels from a point, from a line
CLEARANCE = 8.0  # pixels between a dwell's line and the points at its ends
TREMBLE = 3.0  # pixels of unintended motion of the hand
ANGLE_STEP = 0.5  # [deg]
LEVEL_PIXELS = 2.5  # largest height of a step of levels, which is 1, 2 or 5 times a power of ten
FINE = 0.1  # factor on travel and steps
SYMBOLS = "svaj"
PER_ORDER = ("", "/rad", "/rad²", "/rad³")
ORDERS = ("displacement", "velocity", "acceleration", "jerk")
JERK = 3
FIRST_FAULT = 3  # index among `mark_variants`
FLAT = 50.0  # shown above and below a motion without any rise, in its unit
AXIS_HEIGHT = 21  # of the numbers below, pixels
RADIUS = 4.0  # of a join's point, pixels
SYMBOL_HEIGHT = 10  # of a mark, pixels
MARK_HEIGHT = 11.0  # from mark to mark, pixels
MARK_GAP = 4.0  # between the marks and their line, pixels

Parts = tuple[tuple[str, str], ...]
"""Texts and their colours, from left to right."""

# -- grips -----------------------------------------------------------------------------------------------


@frozen
class Grip:
    """What the mouse can drag: the point of a join, the line through it, or the level line of a dwell.

    Attributes
    ----------
    kind : POINT (angle and level), LINE (angle) or LEVEL (level)
    join : number of the join, from 0
    segment : the dwell of a level line, else the segment before the join
    """

    kind: str
    join: int
    segment: int

    @property
    def changes_angle(self) -> bool:
        """Whether dragging changes the cam angle."""
        return self.kind != LEVEL and self.join > 0

    @property
    def changes_level(self) -> bool:
        """Whether dragging changes the level."""
        return self.kind != LINE


@frozen
class DiagramScale:
    """Scale of the diagram.

    ``left`` to ``right`` [pixels] is 0 ... 360°; ``bottom`` up to ``top`` [pixels, downwards] is ``low`` ... ``high``
    [unit of the motion].
    """

    left: float
    right: float
    top: float
    bottom: float
    low: float
    high: float

    def x(self, angle: float) -> float:
        """Pixels of a cam angle [deg]."""
        return self.left + angle / 360.0 * (self.right - self.left)

    def y(self, level: float) -> float:
        """Pixels of a level."""
        return self.bottom - (level - self.low) / (self.high - self.low) * (self.bottom - self.top)

    def angle(self, x: float) -> float:
        """Cam angle [deg] at x [pixels], within the turn."""
        return min(max((x - self.left) / self.degree, 0.0), 360.0)

    @property
    def degree(self) -> float:
        """Pixels per degree."""
        return max(self.right - self.left, 1.0) / 360.0

    @property
    def unit(self) -> float:
        """Pixels per unit of level."""
        return max(self.bottom - self.top, 1.0) / (self.high - self.low)

    @property
    def level_step(self) -> float:
        """Round step of levels that the mouse can resolve."""
        return nice_below(LEVEL_PIXELS / self.unit)


def join_positions(motion: Motion, scale: DiagramScale) -> Iterator[tuple[int, float, float]]:
    """Yield each join and its x and y [pixels]; join 0 is at both ends."""
    levels = join_levels(motion)
    for join, angle in enumerate(join_angles(motion)):
        yield join, scale.x(angle), scale.y(levels[join])
    yield 0, scale.x(360.0), scale.y(levels[0] + motion.gain)


def grip_at(motion: Motion, scale: DiagramScale, x: float, y: float) -> Grip | None:
    """Find the grip under the mouse: the nearest point, else the nearest line, else the level line of a dwell."""
    joins_at, last = list(join_positions(motion, scale)), len(motion.segments) - 1
    distance, join = min((hypot(x - px, y - py), join) for join, px, py in joins_at)
    if distance <= REACH:
        return Grip(POINT, join, join - 1 if join else last)
    if not scale.top <= y <= scale.bottom:
        return None
    lines = [(abs(x - px), join) for join, px, _ in joins_at if join > 0]
    distance, join = min(lines, default=(math.inf, 0))
    if distance <= LINE_REACH:
        return Grip(LINE, join, join - 1)
    for i, segment in enumerate(motion.segments):
        _, begin, level = joins_at[i]
        if (
            is_dwell(segment)
            and begin + CLEARANCE < x < joins_at[i + 1][1] - CLEARANCE
            and abs(y - level) <= LINE_REACH
        ):
            return Grip(LEVEL, i, i)
    return None


def segment_at(motion: Motion, angle: float) -> int:
    """Number of the segment at a cam angle [deg]; at a join the following segment."""
    return max(i for i, begin in enumerate(join_angles(motion)) if begin <= angle)


def snap(value: float, step: float, direction: int = 0) -> float:
    """Round to the nearest multiple of a step, or to the next one up (direction 1) or down (-1)."""
    count = value / step
    multiple = {0: round(count), 1: math.floor(count + 1e-6) + 1, -1: math.ceil(count - 1e-6) - 1}[direction]
    return round(multiple * step, 10) + 0.0


def snap_angle(angle: float) -> float:
    """Snap a cam angle [deg] from the mouse to a step; an angle with at most two decimals is returned unchanged."""
    rounded = round(angle, 2)
    return rounded + 0.0 if abs(rounded - angle) < 1e-6 else snap(angle, ANGLE_STEP)


class GripDrag:
    """Drag of a grip: turns the travel of the mouse into angle and level of the join.

    A direction counts once the mouse has moved in it by more than ``TREMBLE``, so a point dragged sideways keeps its level.
    An angle stays between its neighbours.
    """

    def __init__(self, motion: Motion, grip: Grip, scale: DiagramScale) -> None:
        self.motion, self.grip = motion, grip
        self._scale = scale  # at the press of the button; the diagram may rescale later
        self._angle, self._level = join_angles(motion)[grip.join], join_levels(motion)[grip.join]
        self._range = join_range(motion, grip.join)
        self._travel = [0.0, 0.0]  # of the mouse, pixels
        self._displacement = [0.0, 0.0]  # of the join, pixels
        self._intended = [False, False]

    def move(
        self, dx: float, dy: float, fine: bool = False, one_direction: bool = False
    ) -> tuple[float | None, float | None]:
        """Return angle [deg] and level of the join after another move of the mouse [pixels]; None where it does not change.

        ``fine`` divides travel and steps by ten; ``one_direction`` keeps to the direction of the larger travel.
        """
        factor = FINE if fine else 1.0
        for k, travel in enumerate((dx, dy)):
            self._travel[k] += travel
            self._displacement[k] += travel * factor
            self._intended[k] = self._intended[k] or abs(self._travel[k]) > TREMBLE
        grip, is_sideways = self.grip, abs(self._travel[0]) >= abs(self._travel[1])
        angle = level = None
        if grip.changes_angle and self._intended[0] and (not one_direction or is_sideways or not grip.changes_level):
            target = snap(self._angle + self._displacement[0] / self._scale.degree, ANGLE_STEP * factor)
            angle = min(max(target, self._range[0]), self._range[1])
        if grip.changes_level and self._intended[1] and not (one_direction and is_sideways and grip.changes_angle):
            level = snap(self._level - self._displacement[1] / self._scale.unit, self._scale.level_step * factor)
        return angle, level


def step_join(
    motion: Motion, join: int, scale: DiagramScale, direction: tuple[int, int], fine: bool = False
) -> tuple[float | None, float | None]:
    """Angle [deg] and level of a join after a step by keys; direction: -1, 0 or 1 in angle and in level."""
    factor = FINE if fine else 1.0
    low, high = join_range(motion, join)
    angle = min(max(snap(join_angles(motion)[join], ANGLE_STEP * factor, direction[0]), low), high)
    level = snap(join_levels(motion)[join], scale.level_step * factor, direction[1])
    return angle if direction[0] and join else None, level if direction[1] else None


# -- marks of a join -------------------------------------------------------------------------------------


@frozen
class JoinMark:
    """Mark of a quantity at a join.

    A jump of jerk is common and has the quiet colour; any other jump is red.

    Attributes
    ----------
    symbol : s, v, a or j
    size : size of the jump as text; empty where the quantity is continuous
    size_with_unit : the same with its unit
    tone : name of the colour in the theme
    """

    symbol: str
    size: str = ""
    size_with_unit: str = ""
    tone: str = "good"

    @property
    def has_jump(self) -> bool:
        """Whether the quantity jumps at the join."""
        return bool(self.size)

    @property
    def is_fault(self) -> bool:
        """Whether the jump is a fault."""
        return self.tone == "limit"

    @property
    def colour(self) -> str:
        """Colour of the mark."""
        return str(getattr(SCREEN, self.tone))


def join_marks(join: Join, motion: Motion) -> tuple[JoinMark, ...]:
    """Marks of s, v, a and j at a join."""
    return tuple(_mark(join, motion, order) for order in range(4))


def _mark(join: Join, motion: Motion, order: int) -> JoinMark:
    if not join.jumps[order]:
        return JoinMark(SYMBOLS[order])
    size = jump_text(join, order, motion).lstrip(MINUS)
    size_with_unit = with_unit(size, UNITS[motion.unit].symbol + PER_ORDER[order])
    return JoinMark(SYMBOLS[order], size, size_with_unit, "quiet" if order == JERK else "limit")


def jump_text(join: Join, order: int, motion: Motion) -> str:
    """Text of the jump with its sign, in the motion's unit per radian of cam angle."""
    return short(float(join.jump[order]) / motion.scale)


def mark_variants(row: Sequence[JoinMark]) -> tuple[Parts, ...]:
    """Texts for the marks of a join, the longest first.

    Sizes with units of all jumps; of faults only; without units; of the first fault only; no sizes.
    """
    first = next((mark for mark in row if mark.is_fault), None)
    return (
        tuple((_mark_text(mark, mark.size_with_unit), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.size_with_unit if mark.is_fault else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.size if mark.is_fault else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, mark.size if mark is first else ""), mark.colour) for mark in row),
        tuple((_mark_text(mark, ""), mark.colour) for mark in row),
    )


def _mark_text(mark: JoinMark, size: str) -> str:
    if not mark.has_jump:
        return mark.symbol
    return f"Δ{mark.symbol}\u00a0{size}" if size else f"Δ{mark.symbol}"


def join_text(join: Join, motion: Motion) -> str:
    """Text of the marks of a join, such as ``s v a Δj``: Δ marks a jump, the first fault has its size."""
    return " ".join(text for text, _ in mark_variants(join_marks(join, motion))[FIRST_FAULT])


def join_help(join: Join, motion: Motion) -> str:
    """Sentences about a join: which quantities are continuous, and how far the others jump."""
    jumping = [k for k in range(4) if join.jumps[k]]
    smooth = [ORDERS[k] for k in range(4) if k not in jumping]
    rows = [f"continuous in {', '.join(smooth)}"] if smooth else []
    unit = UNITS[motion.unit].symbol
    rows += [f"{ORDERS[k]} jumps by {with_unit(jump_text(join, k, motion), unit + PER_ORDER[k])}" for k in jumping]
    return "\n".join(map(sentence, rows))


# -- diagram ---------------------------------------------------------------------------------------------


@frozen
class JoinLabel:
    """Label next to a dragged join; ``refused``: not possible; ``right``: the join is at 360°."""

    text: str
    refused: bool = False
    right: bool = False


class MotionDiagram(CurvePlot):
    """The diagram without reactions to the mouse: ``show_motion`` draws a study.

    Attributes
    ----------
    chosen : number of the selected segment
    hovered : the grip under the mouse, or the dragged one
    label : label next to the dragged join
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._axes["bottom"].show_title("", self._theme.ink)  # leaves more room for the curve
        self.setViewportUpdateMode(self.ViewportUpdateMode.FullViewportUpdate)
        self.chosen = 0
        self.hovered: Grip | None = None
        self.label: JoinLabel | None = None
        self.motion: Motion | None = None
        self._marks: list[tuple[JoinMark, ...]] = []
        self._fixed_range: tuple[float, float] | None = None
        self._current, self._before = self._curve(Z_CURVE), self._curve(Z_REFERENCE)
        self._before.setPen(self._theme.pen(self._theme.quiet, THIN, DASHED))
        self._drawn_state: tuple[object, ...] = ()
        self._rows: tuple[np.ndarray, ...] = ()

    def update_style(self) -> None:
        super().update_style()
        self._drawn_state = ()

    def _curve(self, z: float) -> pg.PlotCurveItem:
        item = pg.PlotCurveItem(antialias=True)
        item.setZValue(z)
        self._view.addItem(item, ignoreBounds=True)
        return item

    def _height_below(self, numbered: bool, low: bool) -> float:
        return sized(AXIS_HEIGHT) if numbered else super()._height_below(numbered, low)

    # -- curves ------------------------------------------------------------------------------------------

    def show_motion(
        self,
        study: Study,
        channel: Quantity,
        before: np.ndarray | None,
        bands: Mapping[str, np.ndarray] = NO_BANDS,
        reference: Study | None = None,
        reference_name: str = PINNED,
    ) -> None:
        """Draw the displacement of a study; if nothing has changed, nothing is painted again.

        Parameters
        ----------
        study : Study
            The motion, with n cam angles.
        channel : Quantity
            Channel of the displacement.
        before : ndarray (n,) [unit of the channel] or None
            Displacement before the last edit; None where there is a reference.
        bands : mapping of str to ndarray (k, n) [unit of the channel]
            Percentiles of machines built to the tolerances, by channel.
        reference : Study, optional
            A second study, drawn dashed in place of the displacement before.
        reference_name : str
            Name of the reference in the legend.
        """
        values = channel.values(study)
        motion = require_motion(study.design)
        curve = Curve(channel, values, self._theme.family(channel.family), gain=motion.gain)
        dashed = reference_curves(reference, [curve])
        name = reference_name if dashed else ""
        drawn = (
            motion,
            self.chosen,
            channel.slug,
            symbol_of(channel.unit.symbol),
            point(),
            before is None,
            name,
            *bands,
        )
        others = [(row.values, row.gain) for row in dashed] + ([] if before is None else [(before, motion.gain)])
        rows = (values, *(row for row, _ in others), *bands.values())
        if (
            self._fixed_range is None
            and drawn == self._drawn_state
            and all(a is b or np.array_equal(a, b) for a, b in zip(rows, self._rows, strict=True))
        ):
            return
        self._drawn_state, self._rows = drawn if self._fixed_range is None else (), rows
        self._curves, self._theta, self._exact_values = [curve], study.theta, None
        band = bands.get(channel.slug)
        ends = [] if band is None else [(band[i], motion.gain) for i in (0, -1)]
        shown = [(values, motion.gain), *others, *ends]
        full_turn = [np.append(row, row[0] + gain) for row, gain in shown]  # with the advance of the turn
        low, high = shown_range(full_turn, (channel.family,), ())
        if all(row.min() == row.max() for row, _ in shown):  # room to drag a first rise
            low, high = float(values[0]) - FLAT, float(values[0]) + FLAT
        if self._fixed_range is None:
            self.display_unit = readable(channel.unit.symbol, peak(full_turn))
        else:  # while a join is dragged the range may only grow
            low, high = min(low, self._fixed_range[0]), max(high, self._fixed_range[1])
        self._current.setPen(self._theme.pen(curve.colour))
        self._put(self._current, study, values, motion.gain)
        self._before.setVisible(bool(others))
        for row, gain in others:
            self._before.setPen(self._theme.pen(curve.colour if dashed else self._theme.quiet, THIN, DASHED))
            self._put(self._before, study if reference is None else reference, row, gain)
        self._reference_name = name
        self._spans = spans(motion)
        self.motion, self._marks = motion, [join_marks(join, motion) for join in study.program.joins]
        size = self.display_unit.size
        self._view.setRange(yRange=(low / size, high / size), padding=0.0)
        self._shade([] if band is None else [(curve, band)])
        self._name_curves()
        if QAccessible.isActive():
            self._describe()
        self._view.updateMatrix()  # otherwise painting updates it, and paints all again
        self._lay()
        self.update_highlight()

    def _put(self, item: pg.PlotCurveItem, study: Study, values: np.ndarray, gain: float) -> None:
        angles = np.append(np.rad2deg(study.theta), 360.0)
        item.setData(angles, np.append(values, values[:1] + gain) / self.display_unit.size, skipFiniteCheck=True)

    def fix_range(self, on: bool) -> None:
        """Keep the range of levels while a join is dragged; it may only grow."""
        frame, size = self.frame(), self.display_unit.size
        self._fixed_range = (frame.low * size, frame.high * size) if on else None

    def update_highlight(self) -> None:
        """Paint again after another segment was selected, or another grip is under the mouse."""
        self.scene().update()  # together with the curves

    def _names(self, width: float) -> list[tuple[float, str]]:
        return segment_labels(self._spans, width)

    # -- positions ---------------------------------------------------------------------------------------

    def scale_now(self) -> DiagramScale:
        """Return the current scale of the diagram."""
        box, frame, size = self._view.sceneBoundingRect(), self.frame(), self.display_unit.size
        return DiagramScale(box.left(), box.right(), box.top(), box.bottom(), frame.low * size, frame.high * size)

    def position_of(self, angle: float, level: float) -> QPointF:
        """Position in the widget [pixels] of a cam angle [deg] and a level [unit of the motion]."""
        scale = self.scale_now()
        return QPointF(self.mapFromScene(QPointF(scale.x(angle), scale.y(level))))

    def position_of_join(self, join: int) -> QPointF:
        """Position of a join in the widget [pixels]."""
        assert self.motion is not None
        return self.position_of(join_angles(self.motion)[join], join_levels(self.motion)[join])

    # -- painting ----------------------------------------------------------------------------------------

    def drawForeground(self, painter: QPainter, rect: QRectF) -> None:
        """Paint lines, points and marks over the curves; a unit of the scene is a pixel."""
        if self.motion is None:
            return
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        scale = self.scale_now()
        joins_at = list(join_positions(self.motion, scale))
        self.paint_below(painter, scale)
        self._paint_chosen(painter, scale, joins_at)
        self._paint_lines(painter, scale, joins_at)
        self._paint_spline_points(painter, scale)
        self._paint_marks(painter, scale, joins_at)
        self._paint_points(painter, joins_at)
        self._paint_label(painter, scale, joins_at)
        painter.restore()

    def paint_below(self, painter: QPainter, scale: DiagramScale) -> None:
        """Paint what lines, points and marks are painted over."""

    def _paint_chosen(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        """Paint a bar above the selected segment, and the level line of the dwell under the mouse."""
        if self.chosen < len(joins_at) - 1:
            left, right = joins_at[self.chosen][1], joins_at[self.chosen + 1][1]
            painter.fillRect(QRectF(left, scale.top - 1.0, right - left, 3.0), QColor(SCREEN.chosen))
        if self.hovered is not None and self.hovered.kind == LEVEL:
            _, left, y = joins_at[self.hovered.segment]
            painter.setPen(self._theme.pen(SCREEN.chosen, 3.0))
            painter.drawLine(QPointF(left, y), QPointF(joins_at[self.hovered.segment + 1][1], y))

    def _paint_lines(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)  # vertical lines need none; much faster
        for join, x, _ in joins_at[1:-1]:
            is_hovered = self.hovered is not None and self.hovered.join == join and self.hovered.kind != LEVEL
            painter.setPen(self._theme.pen(SCREEN.chosen, 2.0) if is_hovered else self._theme.pen(SCREEN.line))
            painter.drawLine(QPointF(x, scale.top), QPointF(x, scale.bottom))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)

    def _paint_points(self, painter: QPainter, joins_at: Sequence[tuple[int, float, float]]) -> None:
        end_of_chosen = (self.chosen + 1) % max(len(joins_at) - 1, 1)
        for join, x, y in joins_at:
            is_hovered = self.hovered is not None and self.hovered.join == join and self.hovered.kind != LINE
            colour = SCREEN.chosen if is_hovered or join == end_of_chosen else self._curves[0].colour
            painter.setPen(self._theme.pen(colour, 1.5))
            painter.setBrush(brush(colour if is_hovered else self._theme.paper))
            radius = RADIUS + (1.0 if is_hovered else 0.0)
            painter.drawEllipse(QPointF(x, y), radius, radius)

    def _paint_spline_points(self, painter: QPainter, scale: DiagramScale) -> None:
        """Paint a small square at each point of a spline."""
        assert self.motion is not None
        painter.setPen(self._theme.pen(self._curves[0].colour))
        painter.setBrush(brush(self._theme.paper))
        begins, levels = join_angles(self.motion), join_levels(self.motion)
        for begin, level, segment in zip(begins, levels, self.motion.segments, strict=True):
            for spline_point in segment.curve.points if isinstance(segment.curve, SplineCurve) else ():
                if spline_point.value is not None:
                    x, y = scale.x(begin + spline_point.at_deg), scale.y(level + spline_point.value)
                    painter.drawRect(QRectF(x - 2.5, y - 2.5, 5.0, 5.0))

    def _paint_marks(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        """Paint s v a j next to each line, in the half of the height without its point."""
        height = 4.0 * sized(MARK_HEIGHT)
        if scale.bottom - scale.top < height + 12.0:
            return
        painter.setFont(font(SYMBOL_HEIGHT))
        spaces = mark_spaces([x for _, x, _ in joins_at])
        for k, ((_, x, y), (left, width)) in enumerate(zip(joins_at[1:], spaces, strict=True)):
            top = scale.bottom - height - 3.0 if y < (scale.top + scale.bottom) / 2.0 else scale.top + 5.0
            self._paint_stack(painter, self._marks[k], x, top, left, width - 2.0 * MARK_GAP)

    def _paint_stack(
        self, painter: QPainter, row: Sequence[JoinMark], x: float, top: float, left: bool, space: float
    ) -> None:
        """Paint marks one below the other, each as long as the space next to the line at ``x`` allows."""
        metrics = QFontMetricsF(painter.font())
        for k, mark in enumerate(row):
            symbol = f"Δ{mark.symbol}" if mark.has_jump else mark.symbol
            texts = (f"{symbol} {mark.size_with_unit}", f"{symbol} {mark.size}") if mark.is_fault else ()
            text = next((t for t in texts if metrics.horizontalAdvance(t) <= space), symbol)
            width = metrics.horizontalAdvance(text)
            box_left = x - MARK_GAP - width if left else x + MARK_GAP
            box = QRectF(box_left, top + k * sized(MARK_HEIGHT), width, sized(MARK_HEIGHT))
            painter.fillRect(box.adjusted(-1.0, 0.0, 1.0, 0.0), brush(self._theme.paper, 0.75))
            painter.setPen(QColor(mark.colour))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_label(
        self, painter: QPainter, scale: DiagramScale, joins_at: Sequence[tuple[int, float, float]]
    ) -> None:
        if self.label is None or self.hovered is None:
            return
        _, x, y = joins_at[-1 if self.label.right else self.hovered.join]
        width, height = text_size(self.label.text)
        left = x + 9.0 if x + 14.0 + width <= scale.right else x - 9.0 - width
        up = y - 8.0 - height if y - 12.0 - height >= scale.top else y + 8.0
        box = QRectF(max(left, scale.left + 2.0), up, width, height).adjusted(-3.0, -1.0, 3.0, 1.0)
        painter.fillRect(box, brush(self._theme.paper, 0.92))
        painter.setFont(font(SMALL))
        painter.setPen(QColor(SCREEN.limit if self.label.refused else SCREEN.chosen))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self.label.text)


def label_text(motion: Motion, angle: float | None, level: float | None, join: int) -> str:
    """Text of the position of a dragged join, such as ``76.5°  −150 mm``."""
    at = join_angles(motion)[join] if angle is None else angle
    height = join_levels(motion)[join] if level is None else level
    return f"{shortest(at)}°  {with_unit(short(height), UNITS[motion.unit].symbol)}"


def step_name(before: Design, after: Design, join: int) -> str:
    """Name of the undo step, such as ``Move start of segment 3 to 80°, -10 mm``, with the changed values only."""
    motion_before, motion_after = require_motion(before), require_motion(after)
    texts = [
        value_text(values(motion_after)[join], UNITS[unit])
        for values, unit in ((join_angles, "deg"), (join_levels, motion_after.unit))
        if values(motion_before)[join] != values(motion_after)[join]
    ]
    return f"Move start of segment {join + 1} to {', '.join(texts)}"


def segment_labels(rows: Sequence[Span], width: float) -> list[tuple[float, str]]:
    """Cam angle [deg] and label of each segment: number and name, the number alone, or none, as ``width`` allows."""
    labels = []
    for number, span in enumerate(rows, 1):
        space = (span.end - span.start) / 360.0 * width
        for text in (f"{number}  {span.name}", str(number)):
            if text_size(text)[0] + 6.0 <= space:
                labels.append(((span.start + span.end) / 2.0, text))
                break
    return labels


def mark_spaces(ends: Sequence[float]) -> list[tuple[bool, float]]:
    """Space for the marks of each line but the first, at rising x [pixels].

    Returns
    -------
    list of (bool, float [pixels])
        Whether the marks are to the left of their line, and their largest width. They are in the wider of the two segments,
        those of the last line in the one before it; marks that face each other share a segment.
    """
    last = len(ends) - 1
    lefts = [k == last or ends[k] - ends[k - 1] > ends[k + 1] - ends[k] for k in range(1, last + 1)]
    spaces = []
    for k, left in enumerate(lefts):
        space = ends[k + 1] - ends[k] if left else ends[k + 2] - ends[k + 1]
        neighbour = k - 1 if left else k + 1
        is_shared = 0 <= neighbour <= last - 1 and lefts[neighbour] is not left
        spaces.append((left, space / 2.0 if is_shared else space))
    return spaces
