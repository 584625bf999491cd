"""Velocity polygons and force polygons.

A polygon is drawn at one position, in steps of scale that keep it readable over the turn.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPainterPath, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.dynamics import (
    CONTACT,
    DRIVE,
    FRICTION,
    INERTIA,
    LOAD,
    MASS_KINDS,
    REACTION,
    SPRING,
    WEIGHT,
    ForceOnBody,
    imbalance,
)
from core.frozen import frozen
from core.instant_centres import ABSOLUTE, POLE, TURNING, Corner, PolygonSide, VelocityPolygon
from core.mechanism import link_number
from core.number_text import result_text
from core.output.drawing.scales import nice_below
from kindyna_gui.pictures.style import DASHED, OUTLINE, SCREEN, SMALL, TEXT, THIN, font
from kindyna_gui.pictures.units import number, readable, readable_text, short, with_unit
from kindyna_gui.settings import sized

# -- layout of names -----------------------------------------------------------------------------------

CROSSES, COVERS, LEAVES, MOVES, LATER = 3.0, 6.0, 12.0, 0.8, 0.15
"""Costs: covering a vector, covering a text, leaving the sheet, changing the position, taking a later position."""
_SPREAD = np.exp(1j * np.deg2rad([0.0, 40.0, -40.0, 85.0, -85.0, 130.0, -130.0, 180.0]))
_ALONG = (0.0, -0.16, 0.16, 0.28, -0.28)


@frozen
class PlacedName:
    """A name with an index, and its position in pixels, y downwards.

    Attributes
    ----------
    kind : ``corner``, a name next to ``anchor``, or ``side``, a name on either side of a vector
    name, index, value : texts; the value follows the name
    anchor : corner, or middle of the vector
    away : preferred direction from the anchor to the name
    width, height : size of the box
    along : vector of a ``side``
    middle : centre of the box, set by the layout
    """

    kind: str
    name: str
    index: str
    anchor: complex
    away: complex
    colour: str
    width: float
    height: float
    along: complex = 0j
    value: str = ""
    middle: complex = 0j

    def positions(self) -> np.ndarray:
        """Possible centres of the box (m,), the best first."""
        half = complex(self.width, self.height) / 2.0
        if self.kind == "corner":
            directions = self.away * _SPREAD
            return np.concatenate([self.anchor + _pushed(directions, half, gap) for gap in (5.0, 13.0)])
        directions = self.away * np.array([1.0, -1.0])
        return np.concatenate([self.anchor + part * self.along + _pushed(directions, half, 3.0) for part in _ALONG])


def _pushed(directions: np.ndarray, half: complex, gap: float) -> np.ndarray:
    """Offsets in directions (m,) at which a box of half size ``half`` is ``gap`` away from a point."""
    return (
        directions * gap
        + np.clip(1.5 * directions.real, -1, 1) * half.real
        + 1j * np.clip(1.5 * directions.imag, -1, 1) * half.imag
    )


class NameLayout:
    """Layout of names that prefers the positions of the previous drawing."""

    def __init__(self) -> None:
        self._previous: dict[tuple[str, str, str], int] = {}

    def place(
        self, texts: Sequence[PlacedName], strokes: Sequence[tuple[complex, complex]], sheet: QRectF
    ) -> list[PlacedName]:
        """Place the names clear of the vectors, each given by its start and end."""
        placed: list[PlacedName] = []
        for text in texts:
            positions = text.positions()
            half = complex(text.width / 2.0 + 1.0, text.height / 2.0)
            cost = LATER * np.arange(positions.size)
            for start, end in strokes:
                cost += CROSSES * _crossed(positions, half, start, end)
            for name in placed:
                cost += COVERS * (
                    (np.abs(positions.real - name.middle.real) < half.real + name.width / 2.0)
                    & (np.abs(positions.imag - name.middle.imag) < half.imag + name.height / 2.0)
                )
            cost += LEAVES * (
                (positions.real - half.real < sheet.left())
                | (positions.real + half.real > sheet.right())
                | (positions.imag - half.imag < sheet.top())
                | (positions.imag + half.imag > sheet.bottom())
            )
            key = (text.kind, text.name, text.index)
            cost += MOVES * (np.arange(positions.size) != self._previous.get(key, 0))
            best = self._previous[key] = int(np.argmin(cost))
            placed.append(replace(text, middle=complex(positions[best])))
        return placed


def _crossed(middles: np.ndarray, half: complex, start: complex, end: complex) -> np.ndarray:
    """Whether a line segment crosses boxes around ``middles`` (m,)."""
    low, high = np.zeros(middles.size), np.ones(middles.size)
    vector = end - start
    for origin, step, room, centre in (
        (start.real, vector.real, half.real, middles.real),
        (start.imag, vector.imag, half.imag, middles.imag),
    ):
        if abs(step) < 1e-9:
            low = np.where(np.abs(centre - origin) < room, low, 2.0)
            continue
        first, second = (centre - room - origin) / step, (centre + room - origin) / step
        low, high = np.maximum(low, np.minimum(first, second)), np.minimum(high, np.maximum(first, second))
    return np.asarray(low < high)


# -- diagrams and their sheet --------------------------------------------------------------------------

EDGE, STRIP = 34.0, 26.0  # margin around the polygon, and strip for the scale below it, pixels
TIP_LENGTH, TIP_SHAPE = 9.0, 0.3  # arrow head: its length in pixels, and half its width by its length
SHORTEST = 20.0  # a shorter vector has no room for its name, pixels
BAR = 90.0  # longest arrow of the scale, pixels
LINE = 13.0  # height of a line of text, pixels
FINER = 1.5  # factor from one scale to the next finer one
ZERO = 1e-9  # vectors below this fraction of the largest over the turn count as zero
RARE = 3.0  # vectors above this many times the typical ones, as near dead centres, do not influence the scale
INDEX = 8  # height of an index, pixels
GAP = 5.0  # between a name and its value, pixels


@frozen
class PolygonKind:
    """Kind of diagram: quantity, unit of the scale, value of one SI unit in that unit, and text of an empty diagram."""

    family: str
    unit: str
    factor: float
    empty_text: str


@frozen
class PolygonVector:
    """One vector: symbol and index, start and vector [SI]; a ``plain`` vector is not in the colour of the quantity."""

    name: str
    index: str
    start: complex
    vector: complex
    plain: bool = False
    dashed: bool = False
    value: str = ""


@frozen
class PolygonCorner:
    """A corner of the polygon: symbol, index and position [SI]."""

    name: str
    index: str
    position: complex


@frozen(eq=False)
class PolygonDiagram:
    """Polygon at one position.

    Attributes
    ----------
    kind : kind of diagram
    strokes : vectors
    corners : corners of a velocity polygon; the first is the pole
    images : number and corners of each link's image
    curve : path of a vector's end over the turn (n,) [SI]
    lines : texts below the angle
    """

    kind: PolygonKind
    strokes: tuple[PolygonVector, ...]
    corners: tuple[PolygonCorner, ...] = ()
    images: tuple[tuple[int, tuple[complex, ...]], ...] = ()
    curve: np.ndarray | None = None
    lines: tuple[str, ...] = ()

    @property
    def points(self) -> list[complex]:
        """All corners and ends of vectors [SI]."""
        ends = [end for s in self.strokes for end in (s.start, s.start + s.vector)]
        return [*(corner.position for corner in self.corners), *ends]


@frozen
class Frame:
    """Pixel of the pole, and scale [pixels per SI unit]; y is upwards in the polygon, downwards on the sheet."""

    pole: complex
    scale: float

    def at(self, end: complex) -> complex:
        """Pixel of a point [SI], y downwards."""
        return self.pole + end.conjugate() * self.scale


def box_of(ends: np.ndarray) -> tuple[complex, complex]:
    """Lower left and upper right of all ends (k, n) over the turn [SI], without rare sizes, as near dead centres."""
    ends = np.where(np.isfinite(ends), ends, 0.0)
    limit = RARE * float(np.percentile(np.abs(ends).max(axis=0), 90.0))
    typical = ends[:, np.abs(ends).max(axis=0) <= limit] if limit > 0.0 else ends
    return complex(typical.real.min(), typical.imag.min()), complex(typical.real.max(), typical.imag.max())


def fitted_frame(low: complex, high: complex, width: float, height: float, top: float = 0.0) -> Frame:
    """Frame in which a box of vectors fills a sheet [pixels] below lines of text of height ``top``."""
    room_x, room_y = max(width - 2.0 * EDGE, 10.0), max(height - 2.0 * EDGE - sized(STRIP) - top, 10.0)
    size = high - low
    scale = min(room_x / max(size.real, 1e-300), room_y / max(size.imag, 1e-300))
    if not math.isfinite(scale) or abs(size) == 0.0:
        return Frame(complex(width, height - STRIP + top) / 2.0, 1.0)
    middle = complex(width / 2.0, (height - sized(STRIP) + top) / 2.0)
    return Frame(middle - ((low + high) / 2.0).conjugate() * scale, scale)


class PolygonSheet(QWidget):
    """One polygon at one position.

    The scale changes in steps: the polygon grows and shrinks with the motion, and small polygons stay readable.
    """

    def __init__(self) -> None:
        super().__init__(accessibleName="Polygon")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._theme = SCREEN
        self._box = (0j, 0j)
        self._diagram: PolygonDiagram | None = None
        self._largest = 0.0
        self._angle = ""
        self._layout = NameLayout()

    def sizeHint(self) -> QSize:
        return QSize(320, 300)

    def minimumSizeHint(self) -> QSize:
        return QSize(140, 120)

    # -- contents --------------------------------------------------------------------------------------

    def set_box(self, box: tuple[complex, complex]) -> None:
        """Set the scale by the lower left and upper right of all vectors over the turn [SI]."""
        self._box = box
        self._largest = max(abs(box[0]), abs(box[1]))
        self._layout = NameLayout()

    def show_diagram(self, diagram: PolygonDiagram, angle: str) -> None:
        """Show a diagram of one position; ``angle`` is its title."""
        self._diagram, self._angle = diagram, angle
        self.update()

    @property
    def lines(self) -> tuple[str, ...]:
        """Texts below the angle."""
        if self._diagram is None:
            return ()
        return tuple(line for line in (*self._diagram.lines, self.unnamed) if line)

    @property
    def curve(self) -> np.ndarray:
        """Path of a vector's end over the turn (n,) [SI]; empty without such a path."""
        return (
            np.zeros(0, dtype=complex) if self._diagram is None or self._diagram.curve is None else self._diagram.curve
        )

    @property
    def is_empty(self) -> bool:
        """Whether all vectors are zero."""
        return max((abs(s.vector) for s in self._strokes), default=0.0) <= ZERO * self._largest

    @property
    def _strokes(self) -> tuple[PolygonVector, ...]:
        return () if self._diagram is None else self._diagram.strokes

    @property
    def frame(self) -> Frame:
        """Frame of the drawn polygon: the frame of the turn, or finer by as many steps as fit the sheet."""
        low, high = self._box
        width, height = self.width(), self.height()
        top = sized(LINE) * len(self._diagram.lines) if self._diagram is not None else 0.0
        turn = fitted_frame(low, high, width, height, top)
        if self._diagram is None or self.is_empty or self.curve.size:
            return turn
        x, y = ([f(v) for v in self._diagram.points] for f in (lambda v: v.real, lambda v: v.imag))
        least, most = complex(min(x), min(y)), complex(max(x), max(y))
        largest = fitted_frame(least, most, width, height, top)
        steps = math.floor(math.log(largest.scale / turn.scale) / math.log(FINER) + 1e-9)
        if steps == 0 and low.real <= least.real and most.real <= high.real and low.imag <= least.imag:
            return turn if most.imag <= high.imag else largest
        scale = turn.scale * FINER**steps
        return Frame(largest.pole + ((least + most) / 2.0).conjugate() * (largest.scale - scale), scale)

    def vectors(self) -> dict[str, tuple[complex, complex]]:
        """Start [pixel, y downwards] and vector [SI] of each drawn vector by name, such as ``V_BA``."""
        frame = self.frame
        if self.is_empty:
            return {}
        return {f"{s.name}_{s.index}": (frame.at(s.start), s.vector) for s in self._strokes}

    @property
    def values(self) -> dict[str, str]:
        """Values at the vectors by name."""
        return {f"{s.name}_{s.index}": s.value for s in self._strokes if s.value}

    @property
    def unnamed(self) -> str:
        """List of the vectors that are too short for a name, with their values."""
        scale = self.frame.scale
        short_ones = [s for s in self._strokes if s.value and abs(s.vector) * scale < SHORTEST]
        return f"Short vectors: {', '.join(f'{s.name} {s.index} {s.value}' for s in short_ones)}" if short_ones else ""

    @property
    def scale_bar(self) -> tuple[float, float]:
        """Value [unit of the kind] and length [pixels] of the scale's arrow."""
        assert self._diagram is not None
        scale = self.frame.scale / self._diagram.kind.factor
        value = nice_below(min(BAR, 0.4 * self.width()) / scale)
        return value, value * scale

    # -- drawing ---------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        if self._diagram is not None:
            self._paint(painter, self._diagram)
        painter.end()

    def _paint(self, painter: QPainter, diagram: PolygonDiagram) -> None:
        theme, frame = self._theme, self.frame
        painter.setPen(QColor(theme.ink))
        painter.setFont(font(TEXT))
        painter.drawText(QPointF(10.0, 18.0), self._angle)
        if self.is_empty and not self.curve.size:
            painter.setPen(QColor(theme.quiet))
            text = next((line for line in diagram.lines if line), diagram.kind.empty_text)
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, text)
            return
        painter.setPen(QColor(theme.quiet))
        painter.setFont(font(SMALL))
        for row, line in enumerate(self.lines):
            painter.drawText(QPointF(10.0, sized(33.0 + LINE * row)), line)
        painter.setPen(Qt.PenStyle.NoPen)
        for link, corners in diagram.images:
            tint = QColor(theme.link(link))
            tint.setAlphaF(0.55)
            painter.setBrush(tint)
            painter.drawPolygon(QPolygonF([_dot(frame.at(v)) for v in corners]))
        if self.curve.size:
            self._draw_curve(painter, frame)
        for stroke in diagram.strokes:
            self._arrow(painter, self._pen(stroke), frame.at(stroke.start), frame.at(stroke.start + stroke.vector))
        painter.setPen(QPen(QColor(theme.ink), THIN))
        painter.setBrush(QColor(theme.paper))
        if diagram.corners:
            painter.drawEllipse(_dot(frame.pole), 3.0, 3.0)
        strokes = [(frame.at(s.start), frame.at(s.start + s.vector)) for s in diagram.strokes]
        top = sized(22.0 + LINE * len(self.lines))
        sheet = QRectF(2.0, top, self.width() - 4.0, self.height() - sized(STRIP) - top)
        for name in self._layout.place(list(self._texts(diagram, frame)), strokes, sheet):
            _write(painter, name)
        self._scale(painter, diagram)

    def _draw_curve(self, painter: QPainter, frame: Frame) -> None:
        """Draw the path of a vector's end, with axes through the pole."""
        painter.setPen(QPen(QColor(self._theme.faint), THIN))
        painter.drawLine(QPointF(0.0, frame.pole.imag), QPointF(self.width(), frame.pole.imag))
        painter.drawLine(QPointF(frame.pole.real, 0.0), QPointF(frame.pole.real, self.height()))
        path = QPainterPath()
        path.addPolygon(QPolygonF([_dot(frame.at(complex(end))) for end in self.curve]))
        path.closeSubpath()
        painter.setPen(QPen(QColor(self._theme.quiet), OUTLINE))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPath(path)

    def _pen(self, stroke: PolygonVector) -> QPen:
        assert self._diagram is not None
        pen = QPen(QColor(self._theme.ink if stroke.plain else self._theme.family(self._diagram.kind.family)), OUTLINE)
        if stroke.dashed:
            pen.setDashPattern([part / OUTLINE for part in DASHED])
        return pen

    def _arrow(self, painter: QPainter, pen: QPen, start: complex, end: complex) -> None:
        length = abs(end - start)
        if length < 1.0:
            return
        along = (end - start) / length
        tip = min(TIP_LENGTH, 0.5 * length)
        painter.setPen(pen)
        painter.drawLine(_dot(start), _dot(end - 0.8 * tip * along))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(pen.color())
        painter.drawPolygon(
            QPolygonF([_dot(end), *(_dot(end + tip * along * (-1.0 + s * 1j)) for s in (TIP_SHAPE, -TIP_SHAPE))])
        )

    def _texts(self, diagram: PolygonDiagram, frame: Frame) -> Iterator[PlacedName]:
        theme, points = self._theme, diagram.points
        named = [corner for corner in diagram.corners if corner.name]
        middle = sum(points) / len(points)
        centre = sum(corner.position for corner in named) / max(1, len(named))
        for corner in named:
            name = (corner.name, corner.index)
            yield PlacedName(
                "corner", *name, frame.at(corner.position), _away(corner.position - centre), theme.ink, *_size(*name)
            )
        for s in diagram.strokes:
            if abs(s.vector) * frame.scale >= SHORTEST:
                colour = theme.text_colour(self._pen(s).color().name())
                across = _away(s.vector) * 1j
                if s.value and (across * _away(s.start + s.vector / 2.0 - middle).conjugate()).real < 0.0:
                    across = -across  # outside the polygon
                size = _size(s.name, s.index, s.value)
                yield PlacedName(
                    "side",
                    s.name,
                    s.index,
                    frame.at(s.start + s.vector / 2.0),
                    across,
                    colour,
                    *size,
                    s.vector.conjugate() * frame.scale,
                    value=s.value,
                )

    def _scale(self, painter: QPainter, diagram: PolygonDiagram) -> None:
        """Draw the scale: an arrow of a round value, lower left."""
        value, length = self.scale_bar
        y = self.height() - 0.5 * sized(STRIP)
        pen = QPen(QColor(self._theme.family(diagram.kind.family)), OUTLINE)
        self._arrow(painter, pen, complex(10.0, y), complex(10.0 + length, y))
        painter.setPen(QColor(self._theme.ink))
        painter.setFont(font(SMALL))
        text = f"{short(value)} {diagram.kind.unit}"
        if diagram.kind.factor == 1.0:
            unit = readable(diagram.kind.unit, 2.0 * value)
            text = with_unit(short(value / unit.size), unit.symbol)
        painter.drawText(QPointF(18.0 + length, y + 4.0), text)


def _away(vector: complex) -> complex:
    """Direction of a vector on the sheet, y downwards."""
    return vector.conjugate() / abs(vector) if vector else 1.0 + 0j


def _dot(point: complex) -> QPointF:
    return QPointF(point.real, point.imag)


def _size(name: str, index: str, value: str = "") -> tuple[float, float]:
    """Width and height of a name with its index and value [pixels]."""
    name_font, index_font, value_font = (QFontMetricsF(font(pixels)) for pixels in (TEXT, INDEX, SMALL))
    value_width = GAP + value_font.horizontalAdvance(value) if value else 0.0
    width = name_font.horizontalAdvance(name) + index_font.horizontalAdvance(index) + value_width
    return width, name_font.ascent() + 2.0


def _write(painter: QPainter, text: PlacedName) -> None:
    """Draw a name with its index and value."""
    left, low = text.middle.real - text.width / 2.0, text.middle.imag + text.height / 2.0 - 2.0
    painter.setPen(QColor(text.colour))
    for part, pixels, down, gap in (
        (text.name, TEXT, 0.0, 0.0),
        (text.index, INDEX, 3.0, 0.0),
        (text.value, SMALL, 0.0, GAP),
    ):
        painter.setFont(font(pixels))
        painter.drawText(QPointF(left + gap, low + down), part)
        left += gap + QFontMetricsF(font(pixels)).horizontalAdvance(part)


# -- force polygons ------------------------------------------------------------------------------------

FORCES = PolygonKind("force", "N", 1.0, "No force acts at this angle.")
SYMBOLS: Mapping[str, str] = MappingProxyType(
    {REACTION: "F", CONTACT: "F", FRICTION: "R", DRIVE: "D", SPRING: "S", LOAD: "P", WEIGHT: "G", INERTIA: "\u2212ma"}
)
"""Symbol of each kind of force; the index names the pair, the element or the body."""
JAMMED = "Friction jams at this angle: the forces are infinite."
COUPLE_SYMBOLS: Mapping[str, str] = MappingProxyType({REACTION: "M", INERTIA: "\u2212Iα"})
"""Symbol of each kind of couple that differs from the symbol of the force."""
NO_COUPLE = 1e-9  # couples below this fraction of the largest at the angle are left out
NO_FORCE = 1e-9  # forces below this fraction of the largest on the body over the turn are left out


def body_label(body: str) -> str:
    """Name of a body in words, such as ``link 3``, ``arm`` or ``follower``."""
    return re.sub(r"(?<=[a-z])(?=\d)", " ", body).replace("_", " ")


def pair_label(name: str) -> str:
    """Name of a pair in words, such as ``A``, ``arm pin`` or ``guide of link 4``."""
    return f"guide of link {name}" if name.isdecimal() else body_label(name)


def force_name(row: ForceOnBody) -> tuple[str, str]:
    """Symbol and index of a force, such as ``F`` with the pair or ``cam``, or ``S`` with the number of the spring."""
    if row.kind == CONTACT:
        return SYMBOLS[row.kind], "cam" if row.name == "inner" else row.name
    if row.kind == FRICTION and row.name in ("inner", "outer", "second"):
        return SYMBOLS[row.kind], "cam"
    words = body_label(row.name)
    return SYMBOLS[row.kind], re.sub(r"^(?:link|spring) (?=\d)|(?<=^torsion) spring", "", words)


def force_box(rows: Sequence[ForceOnBody]) -> tuple[complex, complex]:
    """Lower left and upper right of a body's polygon over the turn [N]."""
    ends = (
        list(accumulate((row.force for row in rows), initial=np.zeros_like(rows[0].force)))
        if rows
        else [np.zeros(1, dtype=complex)]
    )
    return box_of(np.array(ends))


def force_diagram(rows: Sequence[ForceOnBody], largest: float) -> PolygonDiagram:
    """Force polygon of a body at one position; ``largest`` is the largest force on it over the turn [N]."""
    if not all(np.isfinite(row.force[0]) for row in rows):
        return PolygonDiagram(FORCES, (), lines=(JAMMED,))
    strokes: list[PolygonVector] = []
    start = 0j
    for row in rows:
        force = complex(row.force[0])
        if abs(force) > NO_FORCE * largest:
            strokes.append(
                PolygonVector(
                    *force_name(row), start, force, dashed=row.kind in MASS_KINDS, value=readable_text(abs(force), "N")
                )
            )
            start += force
    residual, _ = imbalance(tuple(rows))
    closed = "closed" if residual[0] == 0.0 else f"closed to {result_text(float(residual[0]), 1)} N"
    text = f"{len(strokes)} forces, {closed}" if strokes else ""
    return PolygonDiagram(FORCES, tuple(strokes), lines=(text, _couples(rows), ""))


def _couples(rows: Sequence[ForceOnBody]) -> str:
    """List of the couples on the body, which the polygon does not show."""
    largest = max((abs(float(row.couple[0])) for row in rows), default=0.0)
    texts = []
    for row in rows:
        couple = float(row.couple[0])
        if np.isfinite(couple) and abs(couple) > NO_COUPLE * largest:
            symbol, index = force_name(row)
            symbol = COUPLE_SYMBOLS.get(row.kind, symbol)
            texts.append(f"{symbol} {index} {readable_text(couple, 'N·m')}")
    return f"Couples: {', '.join(texts)}" if texts else ""


def pair_box(force: np.ndarray) -> tuple[complex, complex]:
    """Lower left and upper right of one force (n,) over the turn [N]."""
    return box_of(np.array([np.zeros_like(force), force]))


def pair_diagram(name: str, force: complex, turn: np.ndarray) -> PolygonDiagram:
    """Force [N] in a pair, and the path of its end over the turn (n,), which is the load on the bearing."""
    finite = turn[np.isfinite(turn)]
    if not np.isfinite(force):
        return PolygonDiagram(FORCES, (), curve=finite, lines=(JAMMED,))
    size, angle = readable_text(abs(force), "N"), number(math.degrees(np.angle(force)), 1)
    text = f"x {readable_text(force.real, 'N')}, y {readable_text(force.imag, 'N')}: {size} at {angle}°"
    stroke = PolygonVector("F", body_label(name), 0j, force, value=size)
    return PolygonDiagram(FORCES, (stroke,), (PolygonCorner("", "", 0j),), curve=finite, lines=(text,))


# -- velocity polygons ---------------------------------------------------------------------------------

VELOCITIES = PolygonKind("velocity", "mm/s", 1e3, "Nothing moves at this angle.")


def vector_name(side: PolygonSide) -> tuple[str, str]:
    """Symbol and index of a velocity: a point, ``BA`` for B relative to A, or ``A3A4`` for a block on a link."""
    end, start = _point(side.end), _point(side.start)
    if side.kind == ABSOLUTE:
        return "V", end
    if side.kind == TURNING:
        return "V", f"{end}{start}"
    return "V", f"{side.end[0]}{link_number(side.body)}{start}"


def corner_name(corner: Corner) -> tuple[str, str]:
    """Symbol and index of a corner: the point, and the link of a coincident point; ``o`` and ``v`` for the pole."""
    if corner == POLE:
        return "o", "v"
    return corner[0].lower(), str(link_number(corner[1])) if corner[1] else ""


def _point(corner: Corner) -> str:
    return f"{corner[0]}{link_number(corner[1])}" if corner[1] else corner[0]


def velocity_box(polygon: VelocityPolygon, omega: float) -> tuple[complex, complex]:
    """Lower left and upper right of all velocities over the turn [m/s]."""
    return box_of(
        np.array([*np.broadcast_arrays(np.zeros_like(polygon.longest, dtype=complex), *polygon.corners.values())])
        * omega
    )


def velocity_step_text(polygon: VelocityPolygon, count: int) -> str:
    """Text of the last of ``count`` steps: a velocity from the pole, a relative velocity, or the sum of both."""
    if not count:
        return "All velocities start at the pole"
    done = polygon.steps[:count]
    side, name = done[-1], "_".join(vector_name(done[-1]))
    if side.kind != ABSOLUTE:
        if side.kind != TURNING:
            return f"{name} along the guide"
        return f"{name} across the line from {_point(side.start)} to {_point(side.end)}"
    relative = next((step for step in done if step.kind != ABSOLUTE and step.end == side.end), None)
    if relative is None:
        return f"{name} from the pole"
    starts = (step for step in done if step.kind == ABSOLUTE and step.end == relative.start)
    first = next(("_".join(vector_name(step)) for step in starts), "")
    return f"{name} = {first} + {'_'.join(vector_name(relative))}"


def velocity_diagram(polygon: VelocityPolygon, omega: float, steps: int | None = None) -> PolygonDiagram:
    """Velocity polygon at one position; ``steps`` limits it to the first vectors of the construction."""
    sides = polygon.sides if steps is None else polygon.steps[:steps]
    positions = {POLE: 0j, **{key: complex(v[0]) * omega for key, v in polygon.corners.items()}}
    reached = {POLE, *(end for side in sides for end in (side.start, side.end))}
    known = {key: v for key, v in positions.items() if np.isfinite(v) and key in reached}
    strokes = [
        PolygonVector(
            *vector_name(s),
            positions[s.start],
            complex(s.vector[0]) * omega,
            plain=s.kind != ABSOLUTE,
            dashed=s.kind not in (ABSOLUTE, TURNING),
        )
        for s in sides
        if {s.start, s.end} <= set(known)
    ]
    complete = [(body, corners) for body, corners in polygon.images.items() if set(corners) <= set(known)]
    images = [(link_number(body), tuple(positions[c] for c in corners)) for body, corners in complete]
    return PolygonDiagram(
        VELOCITIES,
        tuple(strokes),
        tuple(PolygonCorner(*corner_name(key), v) for key, v in known.items()),
        tuple(images),
    )
