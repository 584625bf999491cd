"""The velocity polygon: from one pole every point's velocity, between their ends the differences V_PA, to one scale."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.frozen import frozen
from core.instant_centres import ABSOLUTE, POLE, TURNING, Corner, Side, VelocityPolygon
from core.mechanism import link_number
from kindyna_gui.pictures.drawing.polygon_labels import Placing, Text
from kindyna_gui.pictures.style import DASHED, LIGHT, OUTLINE, SMALL, TEXT, THIN, font
from kindyna_gui.pictures.units import nice_below, short

EDGE, STRIP = 34.0, 26.0  # around the polygon, and for the scale below it, pixels
HEAD, SPREAD = 9.0, 0.3  # of an arrow: its length, half its width by its length, pixels
SHORTEST = 20.0  # a vector below this has no room for its name, pixels
BAR = 90.0  # longest arrow of the scale, pixels
FINER = 1.5  # from one scale to the next finer
NO_MOTION = 1e-9  # of the largest velocity of the turn: what is slower does not move
RARE = 3.0  # velocities beyond this many times the usual ones come only near dead centres: the scale is not made for them
NOTHING = "Nothing moves at this angle."


def vector_name(side: Side) -> tuple[str, str]:
    """``V`` and its index: of a point, ``BA`` of B against A; of a block on a link, ``A3A4``."""
    p, a = _point(side.end), _point(side.start)
    if side.kind == ABSOLUTE:
        return "V", p
    if side.kind == TURNING:
        return "V", f"{p}{a}"
    return "V", f"{side.end[0]}{link_number(side.body)}{_point(side.start)}"


def corner_name(corner: Corner) -> tuple[str, str]:
    """``a`` and its index, the link where the point only coincides with it; ``o`` and ``v`` of the pole."""
    if corner == POLE:
        return "o", "v"
    return corner[0].lower(), str(link_number(corner[1])) if corner[1] else ""


def _point(corner: Corner) -> str:
    return f"{corner[0]}{link_number(corner[1])}" if corner[1] else corner[0]


@frozen
class Frame:
    """Where the pole stands and the scale: pixels for 1 m/s; y upwards in the polygon, downwards on the sheet."""

    pole: complex
    scale: float

    def at(self, velocity: complex) -> complex:
        """The pixel of a velocity [m/s], y downwards."""
        return self.pole + velocity.conjugate() * self.scale


def box_of(polygon: VelocityPolygon, omega: float) -> tuple[complex, complex]:
    """Lower left and upper right of all velocities over the turn [m/s], without those near dead centres."""
    ends = np.array([np.zeros_like(polygon.longest, dtype=complex), *np.broadcast_arrays(*polygon.corners.values())]) * omega
    ends = np.where(np.isfinite(ends), ends, 0.0)
    usual = RARE * float(np.percentile(np.abs(ends).max(axis=0), 90.0))
    kept = ends[:, np.abs(ends).max(axis=0) <= usual] if usual > 0.0 else ends
    return complex(kept.real.min(), kept.imag.min()), complex(kept.real.max(), kept.imag.max())


def framed(low: complex, high: complex, width: float, height: float) -> Frame:
    """The frame in which a box of velocities fills a sheet."""
    room_x, room_y = max(width - 2.0 * EDGE, 10.0), max(height - 2.0 * EDGE - STRIP, 10.0)
    size = high - low
    scale = min(room_x / max(size.real, 1e-300), room_y / max(size.imag, 1e-300))
    if not math.isfinite(scale) or abs(size) == 0.0:
        return Frame(complex(width, height - STRIP) / 2.0, 1.0)
    middle = complex(width / 2.0, (height - STRIP) / 2.0)
    return Frame(middle - ((low + high) / 2.0).conjugate() * scale, scale)


class PolygonSheet(QWidget):
    """One polygon at one position. Its scale goes in steps, so that the polygon grows and shrinks as the mechanism moves
    and yet can be read where all is slow."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._theme = LIGHT
        self._box = (0j, 0j)
        self._sides: list[tuple[Side, complex, complex]] = []
        self._images: list[tuple[str, list[complex]]] = []
        self._corners: dict[Corner, complex] = {}
        self._largest = 0.0
        self._angle = ""
        self._placing = Placing()

    def sizeHint(self) -> QSize:
        return QSize(320, 300)

    def minimumSizeHint(self) -> QSize:
        return QSize(140, 120)

    # -- what is shown ------------------------------------------------------------------------------------

    def frame_for(self, polygon: VelocityPolygon, omega: float) -> None:
        """Take the scale for all that follows from a polygon over the whole turn, omega [rad/s]."""
        self._box = box_of(polygon, omega)
        self._largest = max(abs(self._box[0]), abs(self._box[1]))
        self._placing = Placing()

    def show_polygon(self, polygon: VelocityPolygon, omega: float, angle: str) -> None:
        """Show a polygon of one position; angle: the text about it."""
        place = {POLE: 0j, **{key: complex(v[0]) * omega for key, v in polygon.corners.items()}}
        self._corners = {key: v for key, v in place.items() if np.isfinite(v)}
        self._sides = [
            (s, place[s.start], complex(s.vector[0]) * omega) for s in polygon.sides if {s.start, s.end} <= set(self._corners)
        ]
        self._images = [
            (body, [place[c] for c in corners])
            for body, corners in polygon.images.items()
            if set(corners) <= set(self._corners)
        ]
        self._angle = angle
        self.update()

    @property
    def at_rest(self) -> bool:
        """Nothing moves."""
        return max((abs(v) for v in self._corners.values()), default=0.0) <= NO_MOTION * self._largest

    @property
    def frame_now(self) -> Frame:
        """Where the pole stands and the scale of what is drawn: of the whole turn, or as many steps finer as leave the
        polygon on the sheet."""
        low, high = self._box
        width, height = self.width(), self.height()
        turn = framed(low, high, width, height)
        x, y = ([f(v) for v in self._corners.values()] for f in (lambda v: v.real, lambda v: v.imag))
        if not x or self.at_rest:
            return turn
        own_low, own_high = complex(min(x), min(y)), complex(max(x), max(y))
        own = framed(own_low, own_high, width, height)
        steps = math.floor(math.log(own.scale / turn.scale) / math.log(FINER) + 1e-9)
        if steps == 0 and low.real <= own_low.real and own_high.real <= high.real and low.imag <= own_low.imag:
            return turn if own_high.imag <= high.imag else own
        scale = turn.scale * FINER**steps
        return Frame(own.pole + ((own_low + own_high) / 2.0).conjugate() * (own.scale - scale), scale)

    def vectors(self) -> dict[str, tuple[complex, complex]]:
        """What is drawn: ``V_BA`` -> where it starts [pixel, y downwards], the vector [m/s]; none where nothing moves."""
        frame = self.frame_now
        if self.at_rest:
            return {}
        return {"_".join(vector_name(side)): (frame.at(start), vector) for side, start, vector in self._sides}

    @property
    def velocity_scale(self) -> tuple[float, float]:
        """The velocity of the scale's arrow [mm/s] and its length [pixels]."""
        scale = self.frame_now.scale / 1e3
        value = nice_below(min(BAR, 0.4 * self.width()) / scale)
        return value, value * scale

    # -- drawing ------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        if self._corners:
            self._paint(painter)
        painter.end()

    def _paint(self, painter: QPainter) -> None:
        theme, frame = self._theme, self.frame_now
        painter.setPen(QColor(theme.ink))
        painter.setFont(font(TEXT))
        painter.drawText(QPointF(10.0, 18.0), self._angle)
        if self.at_rest:
            painter.setPen(QColor(theme.quiet))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, NOTHING)
            return
        painter.setPen(Qt.PenStyle.NoPen)
        for body, corners in self._images:
            tint = QColor(theme.links[(link_number(body) - 2) % len(theme.links)])
            tint.setAlphaF(0.55)
            painter.setBrush(tint)
            painter.drawPolygon(QPolygonF([_dot(frame.at(v)) for v in corners]))
        for side, start, vector in self._sides:
            self._arrow(painter, side.kind, frame.at(start), frame.at(start + vector))
        painter.setPen(QPen(QColor(theme.ink), THIN))
        painter.setBrush(QColor(theme.paper))
        painter.drawEllipse(_dot(frame.pole), 3.0, 3.0)
        strokes = [(frame.at(start), frame.at(start + vector)) for _, start, vector in self._sides]
        sheet = QRectF(2.0, 22.0, self.width() - 4.0, self.height() - STRIP - 22.0)
        for text in self._placing.laid(list(self._texts(frame)), strokes, sheet):
            _write(painter, text)
        self._scale(painter)

    def _pen(self, kind: str) -> QPen:
        if kind == ABSOLUTE:
            return QPen(QColor(self._theme.family("velocity")), OUTLINE)
        pen = QPen(QColor(self._theme.ink), OUTLINE)
        if kind != TURNING:
            pen.setDashPattern([part / OUTLINE for part in DASHED])
        return pen

    def _arrow(self, painter: QPainter, kind: str, start: complex, end: complex) -> None:
        length = abs(end - start)
        if length < 1.0:
            return
        pen, along = self._pen(kind), (end - start) / length
        head = min(HEAD, 0.5 * length)
        painter.setPen(pen)
        painter.drawLine(_dot(start), _dot(end - 0.8 * head * along))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(pen.color())
        painter.drawPolygon(QPolygonF([_dot(end), *(_dot(end + head * along * (-1.0 + s * 1j)) for s in (SPREAD, -SPREAD))]))

    def _texts(self, frame: Frame) -> Iterator[Text]:
        theme = self._theme
        middle = sum(self._corners.values()) / len(self._corners)
        for key, velocity in self._corners.items():
            yield Text("corner", *corner_name(key), frame.at(velocity), _away(velocity - middle), theme.ink, *_size(corner_name(key)))
        for side, start, vector in self._sides:
            if abs(vector) * frame.scale >= SHORTEST:
                name, colour = vector_name(side), theme.letters(self._pen(side.kind).color().name())
                across = _away(vector) * 1j
                yield Text("side", *name, frame.at(start + vector / 2.0), across, colour, *_size(name), vector.conjugate() * frame.scale)

    def _scale(self, painter: QPainter) -> None:
        """An arrow of a round velocity, lower left."""
        value, length = self.velocity_scale
        y = self.height() - 0.5 * STRIP
        self._arrow(painter, ABSOLUTE, complex(10.0, y), complex(10.0 + length, y))
        painter.setPen(QColor(self._theme.ink))
        painter.setFont(font(SMALL))
        painter.drawText(QPointF(18.0 + length, y + 4.0), f"{short(value)} mm/s")


def _away(vector: complex) -> complex:
    """The direction of a velocity on the sheet, y downwards."""
    return vector.conjugate() / abs(vector) if vector else 1.0 + 0j


def _dot(place: complex) -> QPointF:
    return QPointF(place.real, place.imag)


INDEX = 8  # height of an index, pixels


def _size(name: tuple[str, str]) -> tuple[float, float]:
    """Width and height of a name with its index, pixels."""
    big, small = QFontMetricsF(font(TEXT)), QFontMetricsF(font(INDEX))
    return big.horizontalAdvance(name[0]) + small.horizontalAdvance(name[1]), big.ascent() + 2.0


def _write(painter: QPainter, text: Text) -> None:
    """A name with its index, its box about the text's middle."""
    left, low = text.middle.real - text.width / 2.0, text.middle.imag + text.height / 2.0 - 2.0
    painter.setPen(QColor(text.colour))
    painter.setFont(font(TEXT))
    painter.drawText(QPointF(left, low), text.name)
    shift = QFontMetricsF(font(TEXT)).horizontalAdvance(text.name)
    painter.setFont(font(INDEX))
    painter.drawText(QPointF(left + shift, low + 3.0), text.index)
