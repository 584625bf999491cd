"""Extremes, read-outs."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from math import floor, isfinite, log10

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPainterPath, QPolygonF

from core.frozen import frozen
from kindyna_gui.pictures.items import Outline, Tag, text_size
from kindyna_gui.pictures.plots.lines import Z_CURSOR, Z_CURVE, CurveLine, Frame, cut
from kindyna_gui.pictures.plots.quantities import Curve
from kindyna_gui.pictures.style import SMALL, TEXT, THIN, Theme, brush, font
from kindyna_gui.pictures.units import DisplayUnit, digits, measure, number, short
from kindyna_gui.settings import sized

# -- extreme marks ---------------------------------------------------------------------------------------

DIGITS = 4  # of values
DOT, ARROW = 2.5, 5.0  # radius of a dot, half width of an arrow, pixels
GAP = 4.0  # between them and the text
TEXT_ROOM = 17.0  # above and below a curve, for a text and its dot
LEADING = 2.0  # of a text's box that its letters leave free, above and below
SIDES = ((0.5, 1.0), (0.0, 1.0), (1.0, 1.0), (0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.0, 0.0), (1.0, 0.0))
"""Where the place lies in the text's box, what is tried first at the front, for a highest value: above it, at its upper right,
upper left, right, left, below ..."""


@frozen
class Extreme:
    """An extreme of a curve: its cam angle [deg], its value in the unit of the axis, whether it is the highest.

    refined   False: the largest sample of a peak beyond the axis, which may be infinite: it has no text
    """

    angle: float
    value: float
    highest: bool
    colour: str
    refined: bool = True

    def text(self, low: float, high: float) -> str:
        """Its value, with as many digits as can be read between the ends of the axis, at its angle."""
        if not self.refined:
            return ""
        value = digits(self.value, DIGITS)
        if isfinite(self.value):
            least = floor(log10(max(abs(low), abs(high), 2.0 * abs(self.value)) / 2.0))
            value = min(value, number(self.value, DIGITS - 1 - least), key=len)
            value = value if value.strip("0.") else "0"
        return f"{value} at {short(round(self.angle, 2), 5)}°"


def both_ends(curve: Curve, ends: Sequence[tuple[float, float]], size: float, refined: bool = True) -> list[Extreme]:
    """Lowest and highest value of a curve, (angle [deg], value) each, on an axis whose unit is ``size`` of the curve's; none
    where it is level."""
    if ends[1][1] - ends[0][1] <= curve.floor:
        return []
    values = [0.0 if abs(value) <= curve.floor else value / size for _, value in ends]
    return [Extreme(ends[i][0], values[i], bool(i), curve.colour, refined) for i in (0, 1)]


class MarkText(Tag):
    """The text of an extreme."""


class ExtremeMark:
    """One extreme as it is drawn."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        self._theme = theme
        self.extreme = Extreme(0.0, 0.0, True, theme.quiet)
        self.above = self.outside = False  # its value lies above what the axis shows, or above or below it
        self._letters: QRectF | None = None  # where its text stands, if it has a place
        self._sign = Outline(QPainterPath())
        self._sign.setFlag(self._sign.GraphicsItemFlag.ItemIgnoresTransformations)
        self.tag = MarkText("", theme.quiet, theme, SMALL, backing=True)
        for item, z in ((self.tag, Z_CURVE + 1.0), (self._sign, Z_CURVE + 2.0)):
            item.setZValue(z)
            view.addItem(item, ignoreBounds=True)

    def remove(self, view: pg.ViewBox) -> None:
        view.removeItem(self._sign)
        view.removeItem(self.tag)

    def stand(self, extreme: Extreme, frame: Frame) -> None:
        """At its place, or as an arrow at the edge beyond which it lies."""
        self.extreme = extreme
        self.above, self.outside = extreme.value > frame.high, not frame.low <= extreme.value <= frame.high
        at = min(max(extreme.value, frame.low), frame.high)
        for item in (self._sign, self.tag):
            item.setPos(extreme.angle, at)
        path = QPainterPath()
        if self.outside:
            inwards = 1.0 if self.above else -1.0  # of pixels of the screen
            corners = ((0.0, 1.0), (ARROW, 1.0 + 2.0 * ARROW), (-ARROW, 1.0 + 2.0 * ARROW))
            path.addPolygon(QPolygonF([QPointF(x, inwards * y) for x, y in corners]))
            path.closeSubpath()
        else:
            path.addEllipse(QPointF(0.0, 0.0), DOT, DOT)
        self._sign.redraw(path)
        self._sign.setBrush(brush(extreme.colour if self.outside else self._theme.paper))
        self._sign.setPen(self._theme.pen(extreme.colour))
        self.tag.set_text(extreme.text(frame.low, frame.high))

    def lay(self, frame: Frame, taken: Sequence[QRectF], curves: Sequence[CurveLine]) -> QRectF:
        """Put the text where it covers neither a curve nor what is taken, or leave it out; the box it takes [pixels from the
        frame's lower left corner, y upwards]."""
        room = QRectF(0.0, -LEADING, frame.width, frame.height + 2.0 * LEADING)
        own = self.sign_box(frame)
        if not self.tag.text:
            self.show_text(None)
            return own
        for clear, (x, y) in product((True, False), self._leans()):
            self.tag.set_lean(x, y)
            away = GAP + (2.0 * ARROW if self.outside else 0.0)
            self.tag.shift(GAP * (1.0 - 2.0 * x) * 1.5, (1.0 - 2.0 * y) * (away - LEADING))
            box = self.box(frame)
            letters = box.adjusted(0.0, LEADING, 0.0, -LEADING)
            free = room.contains(box) and not any(letters.intersects(other) for other in taken)
            if (
                free
                and not letters.intersects(own)
                and (not clear or not any(c.enters(letters, frame) for c in curves))
            ):
                if not clear and not self.outside:
                    break
                self.show_text(letters)
                return box.united(own)
        self.show_text(None)
        return own

    def show_text(self, letters: QRectF | None) -> None:
        """letters: the text's place in the frame; None where it has none."""
        self._letters = letters
        self.tag.setVisible(letters is not None)

    def give_way(self, boxes: Sequence[QRectF]) -> None:
        """Show the text where it has a place and none of these boxes covers it."""
        letters = self._letters
        self.tag.setVisible(letters is not None and not any(letters.intersects(box) for box in boxes))

    def _leans(self) -> Sequence[tuple[float, float]]:
        if self.outside:  # inwards, beside its arrow
            return [(x, 0.0 if self.above else 1.0) for x in (0.5, 0.0, 1.0)]
        return SIDES if self.extreme.highest else [(x, 1.0 - y) for x, y in SIDES]

    def box(self, frame: Frame) -> QRectF:
        """Where the text stands in the frame, pixels from its lower left corner, y upwards."""
        return self._in_frame(self.tag.pixel_box(), frame)

    def sign_box(self, frame: Frame) -> QRectF:
        """The same of its dot or arrow."""
        return self._in_frame(self._sign.boundingRect(), frame)

    def _in_frame(self, box: QRectF, frame: Frame) -> QRectF:
        x, y = self.tag.pos().x() / 360.0 * frame.width, frame.pixel(self.tag.pos().y())
        return QRectF(x + box.left(), y - box.bottom(), box.width(), box.height())


def lay_marks(
    marks: Sequence[ExtremeMark], frame: Frame, taken: Sequence[QRectF], curves: Sequence[CurveLine]
) -> list[QRectF]:
    """Lay the texts clear of each other, of what is taken and of the curves, those at the edge first; the boxes they take."""
    boxes = [*taken, *(mark.sign_box(frame) for mark in marks)]
    laid: list[QRectF] = []
    texts: set[tuple[float, float, str]] = set()
    for mark in sorted(marks, key=lambda mark: not mark.outside):
        own, text = mark.sign_box(frame), (mark.tag.x(), mark.tag.y(), mark.tag.text)
        if text in texts:  # several curves that leave the axis at a dead centre
            mark.show_text(None)
            continue
        texts.add(text)
        laid.append(mark.lay(frame, [box for box in boxes if box != own], curves))
        boxes.append(laid[-1])
    return laid


# -- polar marks -----------------------------------------------------------------------------------------

GAPS = (5.0, 12.0, 20.0)  # from a dot to its text, pixels
TURNS = 22.5 * np.array(
    [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8]
)  # of the text from the way outwards, deg
PAD = 2.0  # beside a text, pixels


@frozen
class PolarMark:
    """An extreme where it is drawn [pixels]: its dot, the way outwards, its text and the text's box, empty where there is
    no room for it."""

    extreme: Extreme
    at: QPointF
    outwards: complex
    text: str
    box: QRectF

    @property
    def dot(self) -> QRectF:
        """What the dot or the arrow takes."""
        half = DOT + 1.0 if math.isfinite(self.extreme.value) else 2.0 * ARROW
        return QRectF(self.at.x() - half, self.at.y() - half, 2.0 * half, 2.0 * half)

    def paint(self, painter: QPainter, theme: Theme) -> None:
        """Dot or arrow, and the text."""
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
    place: Callable[[Extreme], QPointF],
    ends: tuple[float, float],
    curves: Sequence[np.ndarray],
    taken: Sequence[QRectF],
    room: QRectF,
) -> list[PolarMark]:
    """Put each text beside its dot, a highest value's outwards if it can be, where it covers neither curves, arrays (n,) of
    places x + iy [pixels], nor what is taken; else it is left out. ends: of the circles' values."""
    marks: list[PolarMark] = []
    shown = [PolarMark(e, place(e), _outwards(e), e.text(*ends), QRectF()) for e in extremes]
    texts: set[tuple[str, float, float]] = set()
    for mark in shown:
        key = (mark.text, round(mark.at.x()), round(mark.at.y()))
        width, height = text_size(mark.text)
        others = [*taken, *(other.dot for other in shown), *(other.box for other in marks)]
        boxes = _boxes(mark, QSizeF(width + 2.0 * PAD, height))
        free = (box for box in boxes if room.contains(box) and not any(box.intersects(other) for other in others))
        box = next((box for box in free if not any(_enters(curve, box) for curve in curves)), QRectF())
        marks.append(PolarMark(mark.extreme, mark.at, mark.outwards, mark.text, QRectF() if key in texts else box))
        texts.add(key)
    return marks


def _outwards(extreme: Extreme) -> complex:
    """The unit vector away from the centre, y downwards."""
    return cmath.rect(1.0, -math.radians(extreme.angle))


def _boxes(mark: PolarMark, size: QSizeF) -> Iterator[QRectF]:
    """Around the dot, what is tried first at the front."""
    way = mark.outwards if mark.extreme.highest else -mark.outwards
    extra = 0.0 if math.isfinite(mark.extreme.value) else 2.0 * ARROW
    for gap in GAPS:
        for turn in TURNS.tolist():
            side = way * cmath.rect(1.0, math.radians(turn))
            away = gap + extra
            box = QRectF(QPointF(), size)
            box.moveCenter(
                mark.at + QPointF(side.real * (away + 0.5 * size.width()), side.imag * (away + 0.5 * size.height()))
            )
            yield box


def _enters(curve: np.ndarray, box: QRectF) -> bool:
    x, y = curve.real, curve.imag
    return bool(((box.left() < x) & (x < box.right()) & (box.top() < y) & (y < box.bottom())).any())


# -- polar texts -----------------------------------------------------------------------------------------

BUTTON, EDGE = 24.0, 4.0  # kept free in the upper right corner, on the left, pixels


def paint_title(painter: QPainter, names: Sequence[tuple[str, str]], unit: str, ink: str, width: float) -> None:
    """names: text and colour of each curve; width: of the plot, pixels."""
    painter.setFont(font(TEXT))
    metrics = QFontMetricsF(font(TEXT))
    advance = metrics.horizontalAdvance
    pieces = title_pieces(names, unit, ink, advance, width - EDGE - BUTTON)
    long = sum(advance(text) for text, _ in pieces)
    x = max(EDGE, min((width - long) / 2.0, width - long - BUTTON))
    for text, colour in pieces:
        painter.setPen(QColor(colour))
        painter.drawText(QPointF(x, 6.0 + metrics.ascent()), text)
        x += advance(text)


def title_pieces(
    names: Sequence[tuple[str, str]], unit: str, ink: str, advance: Callable[[str], float], room: float
) -> list[tuple[str, str]]:
    """Texts and colours, one after the other; where they have no room [pixels], each name is cut to its share of it."""
    marks = ["," if i < len(names) - 1 or unit else "" for i in range(len(names))]
    last = [(unit, ink)] if unit else []
    whole = [(f"{text}{mark} ", colour) for (text, colour), mark in zip(names, marks, strict=True)] + last
    if sum(advance(text) for text, _ in whole) <= room:
        return whole
    each = (room - advance(unit)) / len(names) - advance(", ")
    return [
        (f"{cut(text, each, advance)}{mark} ", colour) for (text, colour), mark in zip(names, marks, strict=True)
    ] + last


TEXT_GAP = 8.0  # of a text from the point it belongs to, pixels
STEPS = 6  # heights of a text that it may be moved up or down


def near(at: QPointF, size: QSizeF, left: bool, taken: Sequence[QRectF], room: QRectF) -> QRectF:
    """The box of a text beside a point: on the wanted side at the point's height if that is free, else as near to it as
    can be; where nothing is free, as if all were."""
    boxes = list(_places(at, size, left))
    inside = [box for box in boxes if room.contains(box)]
    free = (box for box in inside if not any(box.intersects(other) for other in taken))
    return next(free, inside[0] if inside else boxes[0])


def _places(at: QPointF, size: QSizeF, left: bool) -> Iterator[QRectF]:
    for step in range(STEPS):
        for up in (step, -step) if step else (0,):
            for side in (left, not left):
                x = at.x() - TEXT_GAP - size.width() if side else at.x() + TEXT_GAP
                yield QRectF(QPointF(x, at.y() - (0.5 + 0.5 * up) * size.height()), size)


# -- the values of the curves beside the cursor ----------------------------------------------------------

READOUT_GAP = 6.0  # of a text from the cursor's line, pixels
LIFT = 9.0  # of its middle above the value, so that a level curve is not covered


class Readout:
    """A curve's value beside the cursor, with a dot on the curve."""

    def __init__(self, view: pg.ViewBox, theme: Theme) -> None:
        self._theme, self._colour = theme, ("", "")
        dot = QPainterPath()
        dot.addEllipse(QRectF(-3.0, -3.0, 6.0, 6.0))
        self.dot = Outline(dot, theme.pen(theme.paper))
        self.dot.setFlag(self.dot.GraphicsItemFlag.ItemIgnoresTransformations)
        self.tag = Tag("", theme.ink, theme, SMALL, (0.0, 0.5), backing=True)
        self.hide()
        for item in (self.dot, self.tag):
            item.setZValue(Z_CURSOR)
            view.addItem(item, ignoreBounds=True)

    def set_colour(self, colour: str) -> None:
        if (colour, self._theme.paper) != self._colour:
            self._colour = (colour, self._theme.paper)
            self.dot.setBrush(brush(colour))
            self.tag.set_colour(self._theme.letters(colour))

    def hide(self) -> None:
        self.dot.setVisible(False)
        self.tag.setVisible(False)

    def remove(self, view: pg.ViewBox) -> None:
        view.removeItem(self.dot)
        view.removeItem(self.tag)


def place_readouts(
    readouts: Sequence[Readout],
    at: float,
    values: Sequence[float],
    rung: DisplayUnit,
    frame: Frame,
    others: Sequence[QRectF] = (),
) -> list[QRectF]:
    """Write the values beside the cursor at this place of the x axis: on its right, on its left where there is no room, one
    above the other in their order, all within the frame and, where there is room, clear of other texts (boxes as of
    ``LimitLine.box``); the boxes that they take."""
    rows = []
    for reading, value in zip(readouts, values, strict=True):
        known = abs(value) < float("inf")
        reading.tag.set_text(measure(value, rung.symbol))
        reading.dot.setVisible(known)
        reading.tag.setVisible(True)
        if known:
            reading.dot.setPos(at, value)
        rows.append((frame.pixel(value) + sized(LIFT) if known else frame.height / 2, reading.tag))
    widest = max((tag.size[0] for _, tag in rows), default=0.0)
    line = (at - frame.first) / (frame.last - frame.first) * frame.width
    right = line + READOUT_GAP + widest + 4.0 <= frame.width
    reach = (line, line + READOUT_GAP + widest + 2.0) if right else (line - READOUT_GAP - widest - 2.0, line)
    boxes = [box for box in others if reach[0] < box.right() and box.left() < reach[1]]
    taken = [(box.top(), box.bottom()) for box in boxes]
    heights = beside(taken, [row[0] for row in rows], rows[0][1].size[1] if rows else 0.0, frame.height)
    for (_, tag), height in zip(rows, heights, strict=True):
        tag.set_lean(0.0 if right else 1.0, 0.5)
        tag.shift(READOUT_GAP if right else -READOUT_GAP, 0.0)
        tag.setPos(at, frame.value(height))
    lefts = [line + READOUT_GAP if right else line - READOUT_GAP - tag.size[0] for _, tag in rows]
    return [
        QRectF(left, height - tag.size[1] / 2.0, *tag.size)
        for left, height, (_, tag) in zip(lefts, heights, rows, strict=True)
    ]


def beside(taken: Sequence[tuple[float, float]], middles: Sequence[float], height: float, room: float) -> list[float]:
    """``stacked`` in what is left of 0 ... room besides what is taken (from, to); in all of it where that is too
    little."""
    gaps, low = [], 0.0
    for start, end in [*sorted(taken), (room, room)]:
        if start - low >= height + 2.0:
            gaps.append((low, start))
        low = max(low, end)
    if not taken or not gaps:
        return stacked(middles, height, room)
    chosen: dict[tuple[float, float], list[int]] = {gap: [] for gap in gaps}
    for i, middle in enumerate(middles):
        free = [gap for gap in gaps if (len(chosen[gap]) + 1) * height + 2.0 <= gap[1] - gap[0]]
        if not free:
            return stacked(middles, height, room)
        near = min(free, key=lambda gap: max(gap[0] + height / 2 - middle, middle - gap[1] + height / 2, 0.0))
        chosen[near].append(i)
    placed = list(middles)
    for (low, high), inside in chosen.items():
        heights = stacked([middles[i] - low for i in inside], height, high - low)
        for i, at in zip(inside, heights, strict=True):
            placed[i] = at + low
    return placed


def stacked(middles: Sequence[float], height: float, room: float) -> list[float]:
    """Middles of boxes of one height, moved apart and into 0 ... room as little as that needs."""
    order = sorted(range(len(middles)), key=lambda i: middles[i])
    placed = [min(max(middles[i], height / 2 + 1.0), room - height / 2 - 1.0) for i in order]
    for i in range(1, len(placed)):
        placed[i] = max(placed[i], placed[i - 1] + height)
    over = placed[-1] - (room - height / 2 - 1.0) if placed else 0.0
    if over > 0.0:
        placed[-1] -= over
        for i in range(len(placed) - 2, -1, -1):
            placed[i] = min(placed[i], placed[i + 1] - height)
    back = dict(zip(order, placed, strict=True))
    return [back[i] for i in range(len(middles))]
