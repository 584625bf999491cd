"""The highest and lowest values of curves in their plot: a dot and a quiet text; at the edge an arrow where they leave it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import floor, isfinite, log10

import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath, QPolygonF

from core.frozen import frozen
from kindyna_gui.pictures.items import Outline, Tag
from kindyna_gui.pictures.plots.curves import Curve
from kindyna_gui.pictures.plots.frame import Z_CURVE, Frame
from kindyna_gui.pictures.plots.lines import CurveLine
from kindyna_gui.pictures.style import SMALL, Theme, brush
from kindyna_gui.pictures.units import digits, number, short

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


__all__ = ["ARROW", "DOT", "TEXT_ROOM", "Extreme", "ExtremeMark", "MarkText", "both_ends", "lay_marks"]
