"""Vector polygons."""

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
from kindyna_gui.pictures.style import DASHED, OUTLINE, SCREEN, SMALL, TEXT, THIN, font
from kindyna_gui.pictures.units import nice_below, number, readable, short, with_unit
from kindyna_gui.settings import sized

# -- names -----------------------------------------------------------------------------------------------

CROSSES, COVERS, LEAVES, MOVES, LATER = 3.0, 6.0, 12.0, 0.8, 0.15
"""Costs: a vector or another text covered, outside of the sheet, another place than before, each place further down."""
_SPREAD = np.exp(1j * np.deg2rad([0.0, 40.0, -40.0, 85.0, -85.0, 130.0, -130.0, 180.0]))
_ALONG = (0.0, -0.16, 0.16, 0.28, -0.28)


@frozen
class PlacedName:
    """A name with an index; pixels, y downwards.

    kind        ``corner``: beside ``anchor``, ``away`` at best; ``side``: on either side of the vector ``along``
    value       beside the name
    middle      of its box, once it has been laid
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

    def places(self) -> np.ndarray:
        """Middles where it may stand, the best first (m,)."""
        half = complex(self.width, self.height) / 2.0
        if self.kind == "corner":
            directions = self.away * _SPREAD
            return np.concatenate([self.anchor + _pushed(directions, half, gap) for gap in (5.0, 13.0)])
        directions = self.away * np.array([1.0, -1.0])
        return np.concatenate([self.anchor + part * self.along + _pushed(directions, half, 3.0) for part in _ALONG])


def _pushed(directions: np.ndarray, half: complex, gap: float) -> np.ndarray:
    """Shifts in directions (m,) until a box of these halves is ``gap`` off a point."""
    return (
        directions * gap
        + np.clip(1.5 * directions.real, -1, 1) * half.real
        + 1j * np.clip(1.5 * directions.imag, -1, 1) * half.imag
    )


class NameLayout:
    """Lays texts; each keeps its place of the picture before where that is about as good."""

    def __init__(self) -> None:
        self._before: dict[tuple[str, str, str], int] = {}

    def laid(
        self, texts: Sequence[PlacedName], strokes: Sequence[tuple[complex, complex]], sheet: QRectF
    ) -> list[PlacedName]:
        """The texts with their middles; strokes: vectors from, to."""
        done: list[PlacedName] = []
        for text in texts:
            places = text.places()
            half = complex(text.width / 2.0 + 1.0, text.height / 2.0)
            cost = LATER * np.arange(places.size)
            for start, end in strokes:
                cost += CROSSES * _crossed(places, half, start, end)
            for other in done:
                cost += COVERS * (
                    (np.abs(places.real - other.middle.real) < half.real + other.width / 2.0)
                    & (np.abs(places.imag - other.middle.imag) < half.imag + other.height / 2.0)
                )
            cost += LEAVES * (
                (places.real - half.real < sheet.left())
                | (places.real + half.real > sheet.right())
                | (places.imag - half.imag < sheet.top())
                | (places.imag + half.imag > sheet.bottom())
            )
            key = (text.kind, text.name, text.index)
            cost += MOVES * (np.arange(places.size) != self._before.get(key, 0))
            best = self._before[key] = int(np.argmin(cost))
            done.append(replace(text, middle=complex(places[best])))
        return done


def _crossed(middles: np.ndarray, half: complex, start: complex, end: complex) -> np.ndarray:
    """Whether a stretch runs through boxes about ``middles`` (m,)."""
    low, high = np.zeros(middles.size), np.ones(middles.size)
    vector = end - start
    for at, step, room, centre in (
        (start.real, vector.real, half.real, middles.real),
        (start.imag, vector.imag, half.imag, middles.imag),
    ):
        if abs(step) < 1e-9:
            low = np.where(np.abs(centre - at) < room, low, 2.0)
            continue
        one, other = (centre - room - at) / step, (centre + room - at) / step
        low, high = np.maximum(low, np.minimum(one, other)), np.minimum(high, np.maximum(one, other))
    return np.asarray(low < high)


# -- sheet -----------------------------------------------------------------------------------------------

EDGE, STRIP = 34.0, 26.0  # around the polygon, and for the scale below it, pixels
HEAD, SPREAD = 9.0, 0.3  # of an arrow: its length, half its width by its length, pixels
SHORTEST = 20.0  # a vector below this has no room for its name, pixels
BAR = 90.0  # longest arrow of the scale, pixels
LINE = 13.0  # height of a line of text, pixels
FINER = 1.5  # from one scale to the next finer
NOTHING = 1e-9  # of the largest vector of the turn: what is less is nothing
RARE = 3.0  # vectors beyond this many times the usual ones come only near dead centres: the scale is not made for them


@frozen
class Kind:
    """What a diagram is of: family of the quantity, unit of its scale, how many of that one of its own (SI) is, and what stands
    there where there is nothing."""

    family: str
    unit: str
    factor: float
    nothing: str


@frozen
class PolygonVector:
    """One vector: its letter and index, where it starts, itself [SI]; ``plain``: not in the colour of the quantity."""

    name: str
    index: str
    start: complex
    vector: complex
    plain: bool = False
    dashed: bool = False
    value: str = ""


@frozen
class PolygonCorner:
    """A corner: its letter and index, where it stands [SI]."""

    name: str
    index: str
    place: complex


@frozen(eq=False)
class PolygonDiagram:
    """What a sheet shows at one position; images: number of a link, and its corners; curve: of a vector's end over the turn (n,);
    lines: texts below the angle, the last for the names of short vectors. With corners the first of them is the pole."""

    kind: Kind
    strokes: tuple[PolygonVector, ...]
    corners: tuple[PolygonCorner, ...] = ()
    images: tuple[tuple[int, tuple[complex, ...]], ...] = ()
    curve: np.ndarray | None = None
    lines: tuple[str, ...] = ()

    @property
    def places(self) -> list[complex]:
        """Every end [SI]."""
        ends = [end for s in self.strokes for end in (s.start, s.start + s.vector)]
        return [*(corner.place for corner in self.corners), *ends]


@frozen
class Frame:
    """Where the pole stands and the scale: pixels for one of SI; y upwards in the polygon, downwards on the sheet."""

    pole: complex
    scale: float

    def at(self, end: complex) -> complex:
        """The pixel of a vector's end [SI], y downwards."""
        return self.pole + end.conjugate() * self.scale


def box_of(ends: np.ndarray) -> tuple[complex, complex]:
    """Lower left and upper right of all ends (k, n) over the turn [SI], without those of rare size, as near dead centres."""
    ends = np.where(np.isfinite(ends), ends, 0.0)
    usual = RARE * float(np.percentile(np.abs(ends).max(axis=0), 90.0))
    kept = ends[:, np.abs(ends).max(axis=0) <= usual] if usual > 0.0 else ends
    return complex(kept.real.min(), kept.imag.min()), complex(kept.real.max(), kept.imag.max())


def framed(low: complex, high: complex, width: float, height: float, top: float = 0.0) -> Frame:
    """The frame in which a box of vectors fills a sheet below lines of text of so many pixels."""
    room_x, room_y = max(width - 2.0 * EDGE, 10.0), max(height - 2.0 * EDGE - sized(STRIP) - top, 10.0)
    size = high - low
    scale = min(room_x / max(size.real, 1e-300), room_y / max(size.imag, 1e-300))
    if not math.isfinite(scale) or abs(size) == 0.0:
        return Frame(complex(width, height - STRIP + top) / 2.0, 1.0)
    middle = complex(width / 2.0, (height - sized(STRIP) + top) / 2.0)
    return Frame(middle - ((low + high) / 2.0).conjugate() * scale, scale)


class PolygonSheet(QWidget):
    """One polygon at one position. Its scale goes in steps, so that the polygon grows and shrinks as the mechanism moves
    and yet can be read where all is slow."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName("Polygon")
        self._theme = SCREEN
        self._box = (0j, 0j)
        self._diagram: PolygonDiagram | None = None
        self._largest = 0.0
        self._angle = ""
        self._placing = NameLayout()

    def sizeHint(self) -> QSize:
        return QSize(320, 300)

    def minimumSizeHint(self) -> QSize:
        return QSize(140, 120)

    # -- what is shown ------------------------------------------------------------------------------------

    def frame_for(self, box: tuple[complex, complex]) -> None:
        """Take the scale for all that follows from what the sheet must hold over the whole turn, lower left and upper right [SI]."""
        self._box = box
        self._largest = max(abs(box[0]), abs(box[1]))
        self._placing = NameLayout()

    def show_diagram(self, diagram: PolygonDiagram, angle: str) -> None:
        """Show a diagram of one position; angle: the text about it."""
        self._diagram, self._angle = diagram, angle
        self.update()

    @property
    def lines(self) -> tuple[str, ...]:
        """The texts below the angle."""
        if self._diagram is None:
            return ()
        return tuple(line for line in (*self._diagram.lines, self.unnamed) if line)

    @property
    def curve(self) -> np.ndarray:
        """The curve of a vector's end over the turn (n,) [SI]; empty where there is none."""
        return (
            np.zeros(0, dtype=complex) if self._diagram is None or self._diagram.curve is None else self._diagram.curve
        )

    @property
    def at_rest(self) -> bool:
        """Nothing moves, or acts."""
        return max((abs(s.vector) for s in self._strokes), default=0.0) <= NOTHING * self._largest

    @property
    def _strokes(self) -> tuple[PolygonVector, ...]:
        return () if self._diagram is None else self._diagram.strokes

    @property
    def frame_now(self) -> Frame:
        """Where the pole stands and the scale of what is drawn: of the whole turn, or as many steps finer as leave the
        polygon on the sheet."""
        low, high = self._box
        width, height = self.width(), self.height()
        top = sized(LINE) * len(self._diagram.lines) if self._diagram is not None else 0.0
        turn = framed(low, high, width, height, top)
        if self._diagram is None or self.at_rest or self.curve.size:
            return turn
        x, y = ([f(v) for v in self._diagram.places] for f in (lambda v: v.real, lambda v: v.imag))
        own_low, own_high = complex(min(x), min(y)), complex(max(x), max(y))
        own = framed(own_low, own_high, width, height, top)
        steps = math.floor(math.log(own.scale / turn.scale) / math.log(FINER) + 1e-9)
        if steps == 0 and low.real <= own_low.real and own_high.real <= high.real and low.imag <= own_low.imag:
            return turn if own_high.imag <= high.imag else own
        scale = turn.scale * FINER**steps
        return Frame(own.pole + ((own_low + own_high) / 2.0).conjugate() * (own.scale - scale), scale)

    def vectors(self) -> dict[str, tuple[complex, complex]]:
        """What is drawn: ``V_BA`` -> where it starts [pixel, y downwards], the vector [SI]; none where nothing moves or acts."""
        frame = self.frame_now
        if self.at_rest:
            return {}
        return {f"{s.name}_{s.index}": (frame.at(s.start), s.vector) for s in self._strokes}

    @property
    def values(self) -> dict[str, str]:
        """The value beside each vector, where it has one."""
        return {f"{s.name}_{s.index}": s.value for s in self._strokes if s.value}

    @property
    def unnamed(self) -> str:
        """The vectors too short for a name beside them, with their values."""
        scale = self.frame_now.scale
        short_ones = [s for s in self._strokes if s.value and abs(s.vector) * scale < SHORTEST]
        return f"Short: {', '.join(f'{s.name} {s.index} {s.value}' for s in short_ones)}" if short_ones else ""

    @property
    def scale_bar(self) -> tuple[float, float]:
        """The value of the scale's arrow [unit of the kind] and its length [pixels]."""
        assert self._diagram is not None
        scale = self.frame_now.scale / self._diagram.kind.factor
        value = nice_below(min(BAR, 0.4 * self.width()) / scale)
        return value, value * scale

    # -- drawing ------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        if self._diagram is not None:
            self._paint(painter, self._diagram)
        painter.end()

    def _paint(self, painter: QPainter, diagram: PolygonDiagram) -> None:
        theme, frame = self._theme, self.frame_now
        painter.setPen(QColor(theme.ink))
        painter.setFont(font(TEXT))
        painter.drawText(QPointF(10.0, 18.0), self._angle)
        if self.at_rest and not self.curve.size:
            painter.setPen(QColor(theme.quiet))
            text = next((line for line in diagram.lines if line), diagram.kind.nothing)
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, text)
            return
        painter.setPen(QColor(theme.quiet))
        painter.setFont(font(SMALL))
        for row, line in enumerate(self.lines):
            painter.drawText(QPointF(10.0, sized(33.0 + LINE * row)), line)
        painter.setPen(Qt.PenStyle.NoPen)
        for link, corners in diagram.images:
            tint = QColor(theme.links[(link - 2) % len(theme.links)])
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
        for laid in self._placing.laid(list(self._texts(diagram, frame)), strokes, sheet):
            _write(painter, laid)
        self._scale(painter, diagram)

    def _draw_curve(self, painter: QPainter, frame: Frame) -> None:
        """The curve with its axes through the pole."""
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
        head = min(HEAD, 0.5 * length)
        painter.setPen(pen)
        painter.drawLine(_dot(start), _dot(end - 0.8 * head * along))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(pen.color())
        painter.drawPolygon(
            QPolygonF([_dot(end), *(_dot(end + head * along * (-1.0 + s * 1j)) for s in (SPREAD, -SPREAD))])
        )

    def _texts(self, diagram: PolygonDiagram, frame: Frame) -> Iterator[PlacedName]:
        theme, places = self._theme, diagram.places
        named = [corner for corner in diagram.corners if corner.name]
        middle = sum(places) / len(places)
        of_corners = sum(corner.place for corner in named) / max(1, len(named))
        for corner in named:
            name = (corner.name, corner.index)
            yield PlacedName(
                "corner", *name, frame.at(corner.place), _away(corner.place - of_corners), theme.ink, *_size(*name)
            )
        for s in diagram.strokes:
            if abs(s.vector) * frame.scale >= SHORTEST:
                colour = theme.letters(self._pen(s).color().name())
                across = _away(s.vector) * 1j
                if s.value and (across * _away(s.start + s.vector / 2.0 - middle).conjugate()).real < 0.0:
                    across = -across  # outside of what closes
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
        """An arrow of a round value, lower left."""
        value, length = self.scale_bar
        y = self.height() - 0.5 * sized(STRIP)
        pen = QPen(QColor(self._theme.family(diagram.kind.family)), OUTLINE)
        self._arrow(painter, pen, complex(10.0, y), complex(10.0 + length, y))
        painter.setPen(QColor(self._theme.ink))
        painter.setFont(font(SMALL))
        rung = readable(diagram.kind.unit, 2.0 * value) if diagram.kind.factor == 1.0 else None
        text = (
            f"{short(value)} {diagram.kind.unit}" if rung is None else with_unit(short(value / rung.size), rung.symbol)
        )
        painter.drawText(QPointF(18.0 + length, y + 4.0), text)


def _away(vector: complex) -> complex:
    """The direction of a vector on the sheet, y downwards."""
    return vector.conjugate() / abs(vector) if vector else 1.0 + 0j


def _dot(place: complex) -> QPointF:
    return QPointF(place.real, place.imag)


INDEX = 8  # height of an index, pixels
GAP = 5.0  # between a name and its value, pixels


def _size(name: str, index: str, value: str = "") -> tuple[float, float]:
    """Width and height of a name with its index and value, pixels."""
    big, small, beside = QFontMetricsF(font(TEXT)), QFontMetricsF(font(INDEX)), QFontMetricsF(font(SMALL))
    gap = GAP + beside.horizontalAdvance(value) if value else 0.0
    return big.horizontalAdvance(name) + small.horizontalAdvance(index) + gap, big.ascent() + 2.0


def _write(painter: QPainter, text: PlacedName) -> None:
    """A name with its index and value, its box about the text's middle."""
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


# -- forces ----------------------------------------------------------------------------------------------

FORCES = Kind("force", "N", 1.0, "No force acts here at this angle.")
LETTERS: Mapping[str, str] = MappingProxyType(
    {REACTION: "F", CONTACT: "F", FRICTION: "R", DRIVE: "D", SPRING: "S", LOAD: "P", WEIGHT: "G", INERTIA: "\u2212ma"}
)
"""Kind of a force -> its letter; its index is the pair, the element or the body."""
DIGITS = 4
JAMS = "Friction jams here: the forces are infinite."
COUPLES: Mapping[str, str] = MappingProxyType({REACTION: "M", INERTIA: "\u2212Iα"})
"""Kind of a couple -> its letter, where that is not the force's."""
NO_COUPLE = 1e-9  # of the largest couple at this angle
NO_FORCE = 1e-9  # of the largest force on the body over the turn: what is less is left out


def body_label(body: str) -> str:
    """``link 3``, ``arm``, ``follower``."""
    return re.sub(r"(?<=[a-z])(?=\d)", " ", body).replace("_", " ")


def pair_label(name: str) -> str:
    """``A``, ``arm pin``, ``guide of link 4``."""
    return f"guide of link {name}" if name.isdecimal() else body_label(name)


def force_name(row: ForceOnBody) -> tuple[str, str]:
    """Letter and index: ``F`` and the pair, ``F`` and ``cam``, ``S`` and the number of the spring, ``torsion 1``."""
    if row.kind == CONTACT:
        return LETTERS[row.kind], "cam" if row.name == "inner" else row.name
    if row.kind == FRICTION and row.name in ("inner", "outer", "second"):
        return LETTERS[row.kind], "cam"
    words = body_label(row.name)
    return LETTERS[row.kind], re.sub(r"^(?:link|spring) (?=\d)|(?<=^torsion) spring", "", words)


def amount(value: float, unit: str = "N") -> str:
    """A force, a part of one or a couple with its unit."""
    rung = readable(unit, abs(value))
    return with_unit(short(value / rung.size, DIGITS), rung.symbol)


def force_box(rows: Sequence[ForceOnBody]) -> tuple[complex, complex]:
    """What a sheet must hold of a body's polygon over the turn [N]."""
    ends = (
        list(accumulate((row.force for row in rows), initial=np.zeros_like(rows[0].force)))
        if rows
        else [np.zeros(1, dtype=complex)]
    )
    return box_of(np.array(ends))


def force_diagram(rows: Sequence[ForceOnBody], largest: float) -> PolygonDiagram:
    """The polygon of one position, side by side in the order of the rows; largest: of the body's forces over the turn [N]."""
    if not all(np.isfinite(row.force[0]) for row in rows):
        return PolygonDiagram(FORCES, (), lines=(JAMS,))
    strokes: list[PolygonVector] = []
    place = 0j
    for row in rows:
        force = complex(row.force[0])
        if abs(force) > NO_FORCE * largest:
            strokes.append(
                PolygonVector(*force_name(row), place, force, dashed=row.kind in MASS_KINDS, value=amount(abs(force)))
            )
            place += force
    left, _ = imbalance(tuple(rows))
    closed = "closed" if left[0] == 0.0 else f"closed to {float(left[0]):.0e} N"
    text = f"{len(strokes)} forces, {closed}" if strokes else ""
    return PolygonDiagram(FORCES, tuple(strokes), lines=(text, _couples(rows), ""))


def _couples(rows: Sequence[ForceOnBody]) -> str:
    """The couples on the body, which no side of the polygon shows."""
    largest = max((abs(float(row.couple[0])) for row in rows), default=0.0)
    told = []
    for row in rows:
        couple = float(row.couple[0])
        if np.isfinite(couple) and abs(couple) > NO_COUPLE * largest:
            letter, index = force_name(row)
            letter = COUPLES.get(row.kind, letter)
            told.append(f"{letter} {index} {amount(couple, 'N·m')}")
    return f"Couples: {', '.join(told)}" if told else ""


def pair_box(force: np.ndarray) -> tuple[complex, complex]:
    """What a sheet must hold of one force over the turn [N]."""
    return box_of(np.array([np.zeros_like(force), force]))


def pair_diagram(name: str, force: complex, turn: np.ndarray) -> PolygonDiagram:
    """The force [N] in a pair from a pole, and the curve of its end over the turn (n,): what its bearing carries."""
    finite = turn[np.isfinite(turn)]
    if not np.isfinite(force):
        return PolygonDiagram(FORCES, (), curve=finite, lines=(JAMS,))
    text = f"x {amount(force.real)}, y {amount(force.imag)}: {amount(abs(force))} at {number(math.degrees(np.angle(force)), 1)}°"
    stroke = PolygonVector("F", body_label(name), 0j, force, value=amount(abs(force)))
    return PolygonDiagram(FORCES, (stroke,), (PolygonCorner("", "", 0j),), curve=finite, lines=(text,))


# -- velocities ------------------------------------------------------------------------------------------

VELOCITIES = Kind("velocity", "mm/s", 1e3, "Nothing moves at this angle.")


def vector_name(side: PolygonSide) -> tuple[str, str]:
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


def velocity_box(polygon: VelocityPolygon, omega: float) -> tuple[complex, complex]:
    """What a sheet must hold of all velocities over the turn [m/s]."""
    return box_of(
        np.array([*np.broadcast_arrays(np.zeros_like(polygon.longest, dtype=complex), *polygon.corners.values())])
        * omega
    )


def velocity_step_text(polygon: VelocityPolygon, count: int) -> str:
    """What the last of so many steps draws: a velocity from the pole, a difference, or the sum of both."""
    if not count:
        return "From the pole: all velocities start there"
    done = polygon.steps[:count]
    side, name = done[-1], "_".join(vector_name(done[-1]))
    if side.kind != ABSOLUTE:
        if side.kind != TURNING:
            return f"{name} along the guide"
        return f"{name} across the line from {_point(side.start)} to {_point(side.end)}"
    by = next((each for each in done if each.kind != ABSOLUTE and each.end == side.end), None)
    if by is None:
        return f"{name} from the pole"
    first = next(("_".join(vector_name(each)) for each in done if each.kind == ABSOLUTE and each.end == by.start), "")
    return f"{name} = {first} + {'_'.join(vector_name(by))}"


def velocity_diagram(polygon: VelocityPolygon, omega: float, steps: int | None = None) -> PolygonDiagram:
    """Of one position; steps: only so many vectors in the order of their construction, None: all."""
    sides = polygon.sides if steps is None else polygon.steps[:steps]
    place = {POLE: 0j, **{key: complex(v[0]) * omega for key, v in polygon.corners.items()}}
    reached = {POLE, *(end for side in sides for end in (side.start, side.end))}
    known = {key: v for key, v in place.items() if np.isfinite(v) and key in reached}
    strokes = [
        PolygonVector(
            *vector_name(s),
            place[s.start],
            complex(s.vector[0]) * omega,
            plain=s.kind != ABSOLUTE,
            dashed=s.kind not in (ABSOLUTE, TURNING),
        )
        for s in sides
        if {s.start, s.end} <= set(known)
    ]
    whole = [(body, corners) for body, corners in polygon.images.items() if set(corners) <= set(known)]
    images = [(link_number(body), tuple(place[c] for c in corners)) for body, corners in whole]
    return PolygonDiagram(
        VELOCITIES,
        tuple(strokes),
        tuple(PolygonCorner(*corner_name(key), v) for key, v in known.items()),
        tuple(images),
    )
