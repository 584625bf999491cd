"""Texts in plots: extremes of curves, extremes and title of a polar plot, and values at the cursor.

Each text goes where it covers no curve and no other text; an extreme without such room has only its dot.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from math import floor, isfinite, log10

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPainterPath, QPolygonF

from core.frozen import frozen
from core.output.drawing.scales import DisplayUnit
from kindyna_gui.pictures.items import Outline, Tag, text_size
from kindyna_gui.pictures.plots.library import pg
from kindyna_gui.pictures.plots.lines import Z_CURSOR, Z_CURVE, CurveLine, Frame, PlotMark, cut
from kindyna_gui.pictures.plots.quantities import Curve
from kindyna_gui.pictures.style import SMALL, TEXT, THIN, Theme, brush, font
from kindyna_gui.pictures.units import digits, measure, number, short
from kindyna_gui.settings import sized

DIGITS = 4  # of values
DOT, ARROW = 2.5, 5.0  # radius of a dot, half width of an arrow, pixels
GAP = 4.0  # between them and the text
TEXT_ROOM = 17.0  # above and below a curve, for a text and its dot
LEADING = 2.0  # of a text's box that its glyphs leave free, above and below
SIDES = ((0.5, 1.0), (0.0, 1.0), (1.0, 1.0), (0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.0, 0.0), (1.0, 0.0))
"""Position of the dot in the text's box, in the order of trial, for a highest value: text above, at the upper right,
upper left, right, left, below ..."""
POLAR_GAPS = (5.0, 12.0, 20.0)  # from a dot to its text, pixels
POLAR_TURNS = 22.5 * np.array([0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8])
"""Angles of the text from the outward direction, in the order of trial [deg]."""
POLAR_PAD = 2.0  # on both sides of a text, pixels
BUTTON, EDGE = 24.0, 4.0  # left free in the upper right corner and on the left, pixels
TEXT_GAP = 8.0  # of a text from its point, pixels
STEPS = 6  # by half its height that a text may be moved up or down
READOUT_GAP = 6.0  # of a text from the cursor's line, pixels
LIFT = 9.0  # of a text's middle above its value, so that it does not cover a level curve

# -- extremes of a curve ---------------------------------------------------------------------------------


@frozen
class Extreme:
    """An extreme of a curve.

    Attributes
    ----------
    angle : cam angle [deg]
    value : in the unit of the axis
    highest : whether it is the highest value, else the lowest
    colour : of the curve
    refined : False for the largest sample of a peak beyond the axis, which may be infinite and has no text
    """

    angle: float
    value: float
    highest: bool
    colour: str
    refined: bool = True

    def text(self, low: float, high: float) -> str:
        """Value at its angle, with as many digits as can be read on an axis from ``low`` to ``high``."""
        if not self.refined:
            return ""
        value = digits(self.value, DIGITS)
        if isfinite(self.value):
            leading_power = floor(log10(max(abs(low), abs(high), 2.0 * abs(self.value)) / 2.0))
            value = min(value, number(self.value, DIGITS - 1 - leading_power), key=len)
            value = value if value.strip("0.") else "0"
        return f"{value} at {short(round(self.angle, 2), 5)}°"


def both_ends(curve: Curve, ends: Sequence[tuple[float, float]], size: float, refined: bool = True) -> list[Extreme]:
    """Lowest and highest value of a curve; none where it is level.

    Parameters
    ----------
    curve : Curve
    ends : sequence of (angle [deg], value), in the curve's unit
    size : float
        Unit of the axis in the curve's unit.
    refined : bool
        Whether the ends are refined, else they are samples.
    """
    if ends[1][1] - ends[0][1] <= curve.floor:
        return []
    return [
        Extreme(angle, curve.shown(value, size), highest, curve.colour, refined)
        for (angle, value), highest in zip(ends, (False, True), strict=True)
    ]


class MarkText(Tag):
    """Text of an extreme."""


class ExtremeMark(PlotMark):
    """Dot and text of an extreme; an arrow at the edge where the value is beyond the axis."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        self._theme = theme
        self.extreme = Extreme(0.0, 0.0, True, theme.quiet)
        self.above = self.outside = False  # whether the value is above the axis; above or below it
        self._text_box: QRectF | None = None  # box of the text in the frame, None where it has no room
        self._form: tuple[bool, bool] | None = None  # above and outside, of the sign that is drawn
        self._sign = Outline(QPainterPath())
        self._sign.setFlag(self._sign.GraphicsItemFlag.ItemIgnoresTransformations)
        self.tag = MarkText("", theme.quiet, theme, SMALL, backing=True)
        super().__init__(view, (self.tag, Z_CURVE + 1.0), (self._sign, Z_CURVE + 2.0))

    def show(self, extreme: Extreme, frame: Frame) -> None:
        """Draw the dot at the extreme, or an arrow at the edge of the frame beyond which it is."""
        self.extreme = extreme
        self.above, self.outside = extreme.value > frame.high, not frame.low <= extreme.value <= frame.high
        at = min(max(extreme.value, frame.low), frame.high)
        for item in (self._sign, self.tag):
            item.setPos(extreme.angle, at)
        self._sign.setVisible(True)
        if self._form != (self.above, self.outside):
            self._form = self.above, self.outside
            self._sign.redraw(_arrow(self.above) if self.outside else _dot())
        self._sign.setBrush(brush(extreme.colour if self.outside else self._theme.paper))
        self._sign.setPen(self._theme.pen(extreme.colour))
        self.tag.set_text(extreme.text(frame.low, frame.high))

    def hide(self) -> None:
        """Hide the mark until ``show``."""
        self._sign.setVisible(False)
        self.show_text(None)

    def lay(self, frame: Frame, occupied: Sequence[QRectF], curves: Sequence[CurveLine]) -> QRectF:
        """Put the text where it covers no curve and no occupied box, or leave it out.

        Returns
        -------
        QRectF
            Box of dot and text [pixels from the frame's lower left corner, y upwards].
        """
        room = QRectF(0.0, -LEADING, frame.width, frame.height + 2.0 * LEADING)
        sign_box = self.sign_box(frame)
        if not self.tag.text:
            self.show_text(None)
            return sign_box
        for clear, (x, y) in product((True, False), self._leans()):
            self.tag.set_lean(x, y)
            away = GAP + (2.0 * ARROW if self.outside else 0.0)
            self.tag.shift(GAP * (1.0 - 2.0 * x) * 1.5, (1.0 - 2.0 * y) * (away - LEADING))
            box = self.box(frame)
            text_box = box.adjusted(0.0, LEADING, 0.0, -LEADING)
            is_free = room.contains(box) and not any(map(text_box.intersects, (*occupied, sign_box)))
            if is_free and (not clear or not any(curve.enters(text_box, frame) for curve in curves)):
                if not clear and not self.outside:
                    break
                self.show_text(text_box)
                return box.united(sign_box)
        self.show_text(None)
        return sign_box

    def show_text(self, text_box: QRectF | None) -> None:
        """Show the text, whose box in the frame is given, or hide it."""
        self._text_box = text_box
        self.tag.setVisible(text_box is not None)

    def give_way(self, boxes: Sequence[QRectF]) -> None:
        """Hide the text where one of these boxes covers it."""
        text_box = self._text_box
        self.tag.setVisible(text_box is not None and not any(map(text_box.intersects, boxes)))

    def _leans(self) -> Sequence[tuple[float, float]]:
        """Positions of the dot in the text's box, in the order of trial."""
        if self.outside:  # inwards from its arrow
            return [(x, 0.0 if self.above else 1.0) for x in (0.5, 0.0, 1.0)]
        return SIDES if self.extreme.highest else [(x, 1.0 - y) for x, y in SIDES]

    def box(self, frame: Frame) -> QRectF:
        """Box of the text in the frame [pixels from its lower left corner, y upwards]."""
        return frame.box(self.tag.pos().x(), self.tag.pos().y(), self.tag.pixel_box())

    def sign_box(self, frame: Frame) -> QRectF:
        """Box of the dot or arrow in the frame [pixels from its lower left corner, y upwards]."""
        return frame.box(self.tag.pos().x(), self.tag.pos().y(), self._sign.boundingRect())


def _dot() -> QPainterPath:
    path = QPainterPath()
    path.addEllipse(QPointF(0.0, 0.0), DOT, DOT)
    return path


def _arrow(upwards: bool) -> QPainterPath:
    """Arrow with its tip at the upper or lower edge of the frame."""
    inwards = 1.0 if upwards else -1.0  # in pixels of the screen, y downwards
    corners = ((0.0, 1.0), (ARROW, 1.0 + 2.0 * ARROW), (-ARROW, 1.0 + 2.0 * ARROW))
    path = QPainterPath()
    path.addPolygon(QPolygonF([QPointF(x, inwards * y) for x, y in corners]))
    path.closeSubpath()
    return path


def lay_marks(
    marks: Sequence[ExtremeMark], frame: Frame, occupied: Sequence[QRectF], curves: Sequence[CurveLine]
) -> list[QRectF]:
    """Put the texts clear of each other, of occupied boxes and of the curves, arrows first; returns their boxes."""
    boxes = [*occupied, *(mark.sign_box(frame) for mark in marks)]
    text_boxes: list[QRectF] = []
    texts: set[tuple[float, float, str]] = set()
    for mark in sorted(marks, key=lambda mark: not mark.outside):
        sign_box, text = mark.sign_box(frame), (mark.tag.x(), mark.tag.y(), mark.tag.text)
        if text in texts:  # several curves that leave the axis at a dead centre
            mark.show_text(None)
            continue
        texts.add(text)
        text_boxes.append(mark.lay(frame, [box for box in boxes if box != sign_box], curves))
        boxes.append(text_boxes[-1])
    return text_boxes


# -- extremes of a polar plot ----------------------------------------------------------------------------


@frozen
class PolarMark:
    """Dot, or arrow, and text of an extreme in a polar plot.

    Attributes
    ----------
    extreme : Extreme
    at : position of the dot [pixels]
    outwards : unit vector away from the centre, y downwards
    text, box : text and its box [pixels], empty where there is no room for it
    """

    extreme: Extreme
    at: QPointF
    outwards: complex
    text: str
    box: QRectF

    @property
    def dot(self) -> QRectF:
        """Box of the dot or arrow [pixels]."""
        half = DOT + 1.0 if math.isfinite(self.extreme.value) else 2.0 * ARROW
        return QRectF(self.at.x() - half, self.at.y() - half, 2.0 * half, 2.0 * half)

    def paint(self, painter: QPainter, theme: Theme) -> None:
        """Paint dot or arrow, and the text."""
        finite = math.isfinite(self.extreme.value)
        painter.setPen(theme.pen(self.extreme.colour, THIN))
        painter.setBrush(brush(theme.paper if finite else self.extreme.colour))
        if finite:
            painter.drawEllipse(self.at, DOT, DOT)
        else:
            along = self.outwards if self.extreme.highest else -self.outwards
            corners = (0j, -2.0 * ARROW * along + 1j * ARROW * along, -2.0 * ARROW * along - 1j * ARROW * along)
            painter.drawPolygon(QPolygonF([self.at + QPointF(c.real, c.imag) for c in corners]))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if not self.box.isEmpty():
            painter.fillRect(self.box, brush(theme.paper, 0.85))
            painter.setFont(font(SMALL))
            painter.setPen(QColor(theme.quiet))
            painter.drawText(self.box, Qt.AlignmentFlag.AlignCenter, self.text)


def lay_polar_marks(
    extremes: Sequence[Extreme],
    position: Callable[[Extreme], QPointF],
    ends: tuple[float, float],
    curves: Sequence[np.ndarray],
    occupied: Sequence[QRectF],
    room: QRectF,
) -> list[PolarMark]:
    """Put each text next to its dot where it covers no curve and no occupied box, else leave it out.

    Parameters
    ----------
    extremes : sequence of Extreme
    position : function that returns an extreme's position [pixels]
    ends : values of the innermost and the outermost circle
    curves : sequence of ndarray (n,) complex
        Points x + iy [pixels].
    occupied : sequence of QRectF
        Boxes of other texts [pixels].
    room : QRectF
        Box that contains every text [pixels].
    """
    marks: list[PolarMark] = []
    shown = [
        PolarMark(e, position(e), cmath.rect(1.0, -math.radians(e.angle)), e.text(*ends), QRectF()) for e in extremes
    ]
    texts: set[tuple[str, float, float]] = set()
    for mark in shown:
        key = (mark.text, round(mark.at.x()), round(mark.at.y()))
        width, height = text_size(mark.text)
        others = [*occupied, *(other.dot for other in shown), *(other.box for other in marks)]
        boxes = _boxes(mark, QSizeF(width + 2.0 * POLAR_PAD, height))
        free = (box for box in boxes if room.contains(box) and not any(box.intersects(other) for other in others))
        box = next((box for box in free if not any(_enters(curve, box) for curve in curves)), QRectF())
        marks.append(PolarMark(mark.extreme, mark.at, mark.outwards, mark.text, QRectF() if key in texts else box))
        texts.add(key)
    return marks


def _boxes(mark: PolarMark, size: QSizeF) -> Iterator[QRectF]:
    """Boxes around the dot in the order of trial: a highest value's outwards first, a lowest value's inwards."""
    preferred = mark.outwards if mark.extreme.highest else -mark.outwards
    arrow_length = 0.0 if math.isfinite(mark.extreme.value) else 2.0 * ARROW
    for gap in POLAR_GAPS:
        for turn in POLAR_TURNS.tolist():
            side = preferred * cmath.rect(1.0, math.radians(turn))
            away = gap + arrow_length
            box = QRectF(QPointF(), size)
            box.moveCenter(
                mark.at + QPointF(side.real * (away + 0.5 * size.width()), side.imag * (away + 0.5 * size.height()))
            )
            yield box


def _enters(curve: np.ndarray, box: QRectF) -> bool:
    x, y = curve.real, curve.imag
    return bool(((box.left() < x) & (x < box.right()) & (box.top() < y) & (y < box.bottom())).any())


# -- title and values of a polar plot --------------------------------------------------------------------


def paint_title(painter: QPainter, names: Sequence[tuple[str, str]], unit: str, ink: str, width: float) -> None:
    """Paint the names of the curves, (text, colour), and their unit above a plot of this width [pixels]."""
    painter.setFont(font(TEXT))
    metrics = QFontMetricsF(font(TEXT))
    advance = metrics.horizontalAdvance
    pieces = title_pieces(names, unit, ink, advance, width - EDGE - BUTTON)
    length = sum(advance(text) for text, _ in pieces)
    x = max(EDGE, min((width - length) / 2.0, width - length - BUTTON))
    for text, colour in pieces:
        painter.setPen(QColor(colour))
        painter.drawText(QPointF(x, 6.0 + metrics.ascent()), text)
        x += advance(text)


def title_pieces(
    names: Sequence[tuple[str, str]], unit: str, ink: str, advance: Callable[[str], float], room: float
) -> list[tuple[str, str]]:
    """Texts and colours of a title in order; where the room [pixels] is too small, each name is cut to its share."""
    marks = ["," if i < len(names) - 1 or unit else "" for i in range(len(names))]
    last = [(unit, ink)] if unit else []
    pieces = [(f"{text}{mark} ", colour) for (text, colour), mark in zip(names, marks, strict=True)] + last
    if sum(advance(text) for text, _ in pieces) <= room:
        return pieces
    share = (room - advance(unit)) / len(names) - advance(", ")
    return [
        (f"{cut(text, share, advance)}{mark} ", colour) for (text, colour), mark in zip(names, marks, strict=True)
    ] + last


def box_near(at: QPointF, size: QSizeF, left: bool, occupied: Sequence[QRectF], room: QRectF) -> QRectF:
    """Box of a text near a point: the nearest free one, first on the preferred side at the point's height.

    Where no box is free, occupied boxes are ignored.
    """
    boxes = [
        QRectF(
            QPointF(
                at.x() - TEXT_GAP - size.width() if side else at.x() + TEXT_GAP,
                at.y() - (0.5 + 0.5 * up) * size.height(),
            ),
            size,
        )
        for step in range(STEPS)
        for up in ((step, -step) if step else (0,))
        for side in (left, not left)
    ]
    inside = [box for box in boxes if room.contains(box)]
    free = (box for box in inside if not any(map(box.intersects, occupied)))
    return next(free, inside[0] if inside else boxes[0])


# -- values at the cursor --------------------------------------------------------------------------------


class Readout(PlotMark):
    """A curve's value next to the cursor, with a dot on the curve."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        self._theme, self._colour = theme, ("", "")
        dot = QPainterPath()
        dot.addEllipse(QRectF(-3.0, -3.0, 6.0, 6.0))
        self.dot = Outline(dot, theme.pen(theme.paper))
        self.dot.setFlag(self.dot.GraphicsItemFlag.ItemIgnoresTransformations)
        self.tag = Tag("", theme.ink, theme, SMALL, (0.0, 0.5), backing=True)
        super().__init__(view, (self.dot, Z_CURSOR), (self.tag, Z_CURSOR))
        self.hide()

    def set_colour(self, colour: str) -> None:
        """Set the colour of the dot and, in a readable shade, of the text."""
        if (colour, self._theme.paper) != self._colour:
            self._colour = (colour, self._theme.paper)
            self.dot.setBrush(brush(colour))
            self.tag.set_colour(self._theme.text_colour(colour))

    def hide(self) -> None:
        """Hide dot and text."""
        self.dot.setVisible(False)
        self.tag.setVisible(False)


def place_readouts(
    readouts: Sequence[Readout],
    at: float,
    values: Sequence[float],
    display_unit: DisplayUnit,
    frame: Frame,
    others: Sequence[QRectF] = (),
) -> list[QRectF]:
    """Write the values next to the cursor, in a column within the frame, ordered by value.

    The column is on the right of the cursor, or on the left where there is no room. Where there is room the values
    stay clear of other texts.

    Parameters
    ----------
    readouts : sequence of Readout
    at : float
        Position of the cursor on the x axis.
    values : sequence of float
        Value of each curve, in the unit of the axis; may be infinite.
    display_unit : DisplayUnit
        Unit that the values are written in.
    frame : Frame
    others : sequence of QRectF
        Boxes of other texts [pixels from the frame's lower left corner, y upwards].

    Returns
    -------
    list of QRectF
        Boxes of the values, in the same coordinates.
    """
    rows = []
    for reading, value in zip(readouts, values, strict=True):
        is_finite = abs(value) < float("inf")
        reading.tag.set_text(measure(value, display_unit.symbol))
        reading.dot.setVisible(is_finite)
        reading.tag.setVisible(True)
        if is_finite:
            reading.dot.setPos(at, value)
        rows.append((frame.pixel(value) + sized(LIFT) if is_finite else frame.height / 2, reading.tag))
    widest = max((tag.size[0] for _, tag in rows), default=0.0)
    line = (at - frame.first) / (frame.last - frame.first) * frame.width
    right = line + READOUT_GAP + widest + 4.0 <= frame.width
    reach = (line, line + READOUT_GAP + widest + 2.0) if right else (line - READOUT_GAP - widest - 2.0, line)
    occupied = [(box.top(), box.bottom()) for box in others if reach[0] < box.right() and box.left() < reach[1]]
    heights = stacked_clear(occupied, [row[0] for row in rows], rows[0][1].size[1] if rows else 0.0, frame.height)
    for (_, tag), height in zip(rows, heights, strict=True):
        tag.set_lean(0.0 if right else 1.0, 0.5)
        tag.shift(READOUT_GAP if right else -READOUT_GAP, 0.0)
        tag.setPos(at, frame.value(height))
    lefts = [line + READOUT_GAP if right else line - READOUT_GAP - tag.size[0] for _, tag in rows]
    return [
        QRectF(left, height - tag.size[1] / 2.0, *tag.size)
        for left, height, (_, tag) in zip(lefts, heights, rows, strict=True)
    ]


def stacked_clear(
    occupied: Sequence[tuple[float, float]], middles: Sequence[float], height: float, room: float
) -> list[float]:
    """Stack boxes as ``stacked``, outside the occupied intervals (from, to); over all where the gaps are too small."""
    gaps, low = [], 0.0
    for start, end in [*sorted(occupied), (room, room)]:
        if start - low >= height + 2.0:
            gaps.append((low, start))
        low = max(low, end)
    if not occupied or not gaps:
        return stacked(middles, height, room)
    chosen: dict[tuple[float, float], list[int]] = {gap: [] for gap in gaps}
    for i, middle in enumerate(middles):
        free = [gap for gap in gaps if (len(chosen[gap]) + 1) * height + 2.0 <= gap[1] - gap[0]]
        if not free:
            return stacked(middles, height, room)
        nearest = min(free, key=lambda gap: max(gap[0] + height / 2 - middle, middle - gap[1] + height / 2, 0.0))
        chosen[nearest].append(i)
    positions = list(middles)
    for (low, high), inside in chosen.items():
        heights = stacked([middles[i] - low for i in inside], height, high - low)
        for i, at in zip(inside, heights, strict=True):
            positions[i] = at + low
    return positions


def stacked(middles: Sequence[float], height: float, room: float) -> list[float]:
    """Middles of boxes of one height, shifted as little as needed to be separate and within 0 ... room."""
    order = sorted(range(len(middles)), key=lambda i: middles[i])
    positions = [min(max(middles[i], height / 2 + 1.0), room - height / 2 - 1.0) for i in order]
    for i in range(1, len(positions)):
        positions[i] = max(positions[i], positions[i - 1] + height)
    excess = positions[-1] - (room - height / 2 - 1.0) if positions else 0.0
    if excess > 0.0:
        positions[-1] -= excess
        for i in range(len(positions) - 2, -1, -1):
            positions[i] = min(positions[i], positions[i + 1] - height)
    by_index = dict(zip(order, positions, strict=True))
    return [by_index[i] for i in range(len(middles))]
