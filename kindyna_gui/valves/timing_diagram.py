"""Polar timing diagram of an inlet and an exhaust valve: their durations over the crank, TDC at the top."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import copysign, cos, radians, sin

from PySide6.QtCore import QPointF, QRectF, QSize, QSizeF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from core.valves.cam_card import TrainCard, ValveCard
from kindyna_gui.look import Picture
from kindyna_gui.pictures.plots.xy import ROWS
from kindyna_gui.pictures.style import SCREEN, TEXT, font
from kindyna_gui.pictures.units import short

LEAST, HINT = QSize(230, 230), QSize(300, 300)
INNER = 0.76  # outer radius of the exhaust's band, in radii of the diagram
BAND, GAP = 0.2, 0.02  # width of the band of a valve, and between its two rows
TEXT_SIZE = QSizeF(48.0, 18.0)  # of the text of an event, pixels
TEXT_GAP = 3.0  # pixels from the angle of an event to its text
PALE = 90  # opacity of the duration at the first lift, of 255
SIXTEENTHS = 16  # Qt counts angles of arcs in sixteenths of a degree


class TimingDiagram(Picture):
    """Timing of both valves of a card: outside the inlet, inside the exhaust; pale at the first lift, full at the second."""

    def __init__(self) -> None:
        super().__init__("Timing diagram", LEAST, HINT)

    def show_card(self, card: TrainCard) -> None:
        """Draw the valves of a card."""
        self.setAccessibleDescription("; ".join(_sentences(card)))
        self.show_picture(card)

    def draw(self, painter: QPainter) -> None:
        card: TrainCard = self.shown
        radius = 0.5 * min(self.width() - 2.0 * TEXT_SIZE.width(), self.height() - 2.0 * TEXT_SIZE.height())
        painter.translate(0.5 * self.width(), 0.5 * self.height())
        painter.setFont(font(TEXT))
        _draw_axes(painter, radius)
        for valve, ring, colour, sense in _valves(card):
            for row, is_pale in (("first", True), ("second", False)):
                middle = sense * (valve.centre_deg - valve.skew(row))
                _draw_band(painter, ring * radius, radius, middle, valve.duration(row), colour, is_pale)
        for end, dead_centre in ((0, 0.0), (1, 180.0)):
            texts = []
            for valve, _, colour, sense in _valves(card):
                value = valve.events("second")[end]
                texts.append((dead_centre - sense * value * (1.0 - 2.0 * end), f"{short(value, 4)}°", colour))
            _draw_texts(painter, radius, texts)


def _valves(card: TrainCard) -> Iterator[tuple[ValveCard, float, str, float]]:
    """Both valves: the card, the outer radius of the band, the colour, and the sign of the centre."""
    yield card.inlet, 1.0, ROWS[0], 1.0
    yield card.exhaust, INNER, ROWS[1], -1.0


def _draw_axes(painter: QPainter, radius: float) -> None:
    painter.setPen(SCREEN.pen(SCREEN.line))
    painter.drawEllipse(QPointF(), radius, radius)
    painter.drawLine(QPointF(0.0, -radius), QPointF(0.0, radius))
    painter.drawLine(QPointF(-radius, 0.0), QPointF(radius, 0.0))
    painter.setPen(SCREEN.pen(SCREEN.ink))
    for text, side in (("TDC", -1.0), ("BDC", 1.0)):
        box = QRectF(QPointF(), TEXT_SIZE)
        box.moveCenter(QPointF(0.0, 0.3 * side * radius))
        painter.fillRect(box.adjusted(8.0, 0.0, -8.0, 0.0), QColor(SCREEN.paper))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def _draw_band(
    painter: QPainter, outer: float, radius: float, middle_deg: float, duration_deg: float, colour: str, is_pale: bool
) -> None:
    """Draw a duration clockwise from the top: pale in the outer half of the band of its valve, full in the inner half."""
    width = 0.5 * (BAND - GAP) * radius
    middle = outer - 0.5 * width - (0.0 if is_pale else width + GAP * radius)
    seen = QColor(SCREEN.seen(colour))
    seen.setAlpha(PALE if is_pale else 255)
    pen = QPen(seen, width)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    painter.setPen(pen)
    duration = min(duration_deg, 360.0)
    box = QRectF(-middle, -middle, 2.0 * middle, 2.0 * middle)
    opens = middle_deg - 0.5 * duration
    painter.drawArc(box, round((90.0 - opens) * SIXTEENTHS), -round(duration * SIXTEENTHS))


def _draw_texts(painter: QPainter, radius: float, texts: Sequence[tuple[float, str, str]]) -> None:
    """Write events outside the circle at their crank angles [deg]; the left one ends there, the right one begins there."""
    ends = sorted(
        (radius * sin(radians(angle)), -radius * cos(radians(angle)), text, colour) for angle, text, colour in texts
    )
    for (x, y, text, colour), is_left in zip(ends, (True, False), strict=True):
        box = QRectF(QPointF(), TEXT_SIZE)
        box.moveCenter(QPointF(x, y + copysign(0.5 * TEXT_SIZE.height(), y)))
        box.moveLeft(x - TEXT_SIZE.width() - TEXT_GAP if is_left else x + TEXT_GAP)
        side = Qt.AlignmentFlag.AlignRight if is_left else Qt.AlignmentFlag.AlignLeft
        painter.setPen(SCREEN.pen(SCREEN.text_colour(colour)))
        painter.drawText(box, side | Qt.AlignmentFlag.AlignVCenter, text)


def _sentences(card: TrainCard) -> Iterator[str]:
    """Events of each valve at the second lift, in words."""
    near, far = card.inlet.events("second")
    yield f"inlet opens {short(near)}° BTDC, closes {short(far)}° ABDC"
    near, far = card.exhaust.events("second")
    yield f"exhaust opens {short(far)}° BBDC, closes {short(near)}° ATDC"
