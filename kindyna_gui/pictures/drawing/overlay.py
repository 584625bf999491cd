"""Corners, dimensions, vectors."""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QBrush, QPainterPath
from PySide6.QtWidgets import QGraphicsItem

from core.dynamics import BEARING, CONTACT, MASS_KINDS, REACTION, SPRING, ForceOnBody
from core.errors import NoSolution
from core.followers.dimensions import ANGLE, LENGTH, RADIUS, Dimension, dimensions_of
from core.frozen import frozen
from core.mechanism.kinematics import CAM, FRAME
from kindyna_gui.pictures.drawing.cam_parts import ColourScale, bar_width, centre_within_reach, colour_bar
from kindyna_gui.pictures.drawing.geometry import MM, Body, Geometry
from kindyna_gui.pictures.drawing.parts import DIMENSIONS
from kindyna_gui.pictures.items import Arrow, DrawnPart, Move, Outline, Tag, pinned, riding, text_size, wrapped
from kindyna_gui.pictures.shapes import arrow_head, joined, polyline, segments
from kindyna_gui.pictures.style import DASHED, OUTLINE, SMALL, TEXT, THIN, Theme, brush
from kindyna_gui.pictures.units import nice_below, readable, short, with_unit
from kindyna_gui.settings import size_of, sized

# -- dimension parts -------------------------------------------------------------------------------------

AWAY, LEVEL, BEYOND, DIMENSION_HEAD = (
    4.0,
    3.5,
    1.0,
    1.6,
)  # in units: from what is measured, from level to level, of extension lines, of a head
SHORT, BESIDE, TEXT_HALF = (
    9.0,
    4.5,
    3.5,
)  # below which a value stands beside; how far; half of a value's width, in units
DIRECTIONS = 10.0  # directions that differ, per radian
ARC, ARC_STEPS = 0.22, 40  # radius of an angle's arc, parts of its shorter leg; pieces of the arc
Z_DIMENSIONS = 10.0


class DimensionRoom(NamedTuple):
    """Where a dimension finds room: a length goes out by ``away`` [mm] along ``across``, and its value stands at a ``part`` of it;
    unit of symbols [mm]."""

    across: complex
    away: float
    part: float
    unit: float


class DimensionLines(NamedTuple):
    """lines and heads in the frame of the dimension's body [mm]; text: where its value stands there."""

    lines: QPainterPath
    heads: QPainterPath
    text: complex


def _length(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """Between extension lines that go out from the farther end; a short one has its value beside it."""
    across, away, part, unit = room
    one, other = (place * MM for place in row.points)
    reach = max((one * across.conjugate()).real, (other * across.conjugate()).real) + away
    ends = [place + (reach - (place * across.conjugate()).real) * across for place in (one, other)]
    over = across * BEYOND * unit
    lines = segments([(ends[0], ends[1]), (one + over, ends[0] + over), (other + over, ends[1] + over)])
    size = abs(ends[1] - ends[0])
    way = (ends[1] - ends[0]) / (size or 1.0)
    head = min(DIMENSION_HEAD * unit, 0.45 * size)
    heads = joined(arrow_head(ends[0], -way, head), arrow_head(ends[1], way, head))
    return DimensionLines(
        lines, heads, ends[0] + part * (ends[1] - ends[0]) if size > SHORT * unit else ends[1] + way * BESIDE * unit
    )


def _radius(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """From the centre to the circle; the value of a small one stands outside."""
    unit = room.unit
    centre, edge = (place * MM for place in row.points)
    size = abs(edge - centre)
    way = (edge - centre) / size
    inside = size > SHORT * unit
    text = centre + 0.6 * (edge - centre) if inside else edge + way * BESIDE * unit
    return DimensionLines(
        segments([(centre, edge if inside else text)]),
        arrow_head(edge, way, min(DIMENSION_HEAD * unit, 0.5 * size)),
        text,
    )


def _angle(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """An arc between the legs."""
    vertex, first, other = (place * MM for place in row.points)
    radius = ARC * min(abs(first - vertex), abs(other - vertex))
    start, span = cmath.phase(first - vertex), np.deg2rad(row.value)
    arc = [vertex + cmath.rect(radius, start + span * k / ARC_STEPS) for k in range(ARC_STEPS + 1)]
    head = min(DIMENSION_HEAD * room.unit, 0.4 * radius * abs(span))
    sense = 1j if span > 0.0 else -1j
    heads = joined(
        arrow_head(arc[0], -sense * (arc[0] - vertex) / radius, head),
        arrow_head(arc[-1], sense * (arc[-1] - vertex) / radius, head),
    )
    return DimensionLines(polyline(arc), heads, arc[ARC_STEPS // 2])


SHAPES: Mapping[str, Callable[[Dimension, DimensionRoom], DimensionLines]] = MappingProxyType(
    {LENGTH: _length, RADIUS: _radius, ANGLE: _angle}
)
"""Kind of a dimension -> how it is drawn: dimension, where there is room."""


def text_of(row: Dimension) -> str:
    """Symbol and value: millimetres without their unit, as in a workshop's drawing."""
    return f"{row.symbol}{short(row.value, 7)}{'°' if row.kind == ANGLE else ''}"


class PlacedDimension(NamedTuple):
    """A dimension as it is drawn, and how its body goes: origin (n,) [mm], turn (n,), the body itself where it moves."""

    row: Dimension
    drawn: DimensionLines
    origin: np.ndarray
    turn: np.ndarray
    body: Body | None


def laid(geometry: Geometry) -> Iterator[PlacedDimension]:
    """All dimensions of the drive; those that are parallel on one side of a body stand on levels beside each other."""
    low, high = geometry.core_box
    middle, levels = (low + high) / 2.0, Counter[tuple[str, int]]()
    for row in dimensions_of(geometry.study.design, geometry.kinematics):
        body = geometry.bodies.get(row.body) if row.body != FRAME else None
        turn = np.ones(geometry.samples, dtype=complex) if body is None else body.turn
        origin = np.zeros(geometry.samples, dtype=complex) if body is None else body.z
        outwards = complex(((origin + sum(row.points) * MM / len(row.points) * turn - middle) / turn).mean())
        across = _across(row, outwards)
        direction = (row.body, round(DIRECTIONS * cmath.phase(across))) if row.kind == LENGTH else ("", -1)
        number, unit = levels[direction], geometry.unit
        levels[direction] += 1
        room = DimensionRoom(across, (AWAY + LEVEL * number) * unit, 0.5 / (1.0 + 0.5 * number), unit)
        yield PlacedDimension(row, SHAPES[row.kind](row, room), origin, turn, body)


def _across(row: Dimension, outwards: complex) -> complex:
    """The unit vector square to what is measured, on the outer side."""
    along = row.along or row.points[1] - row.points[0]
    across = 1j * along / abs(along)
    return across if (across * outwards.conjugate()).real >= 0.0 else -across


def dimensions(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """All dimensions of the drive; each rides with the body that it belongs to."""
    colour = theme.family("length")
    for number, (row, drawn, origin, turn, body) in enumerate(laid(geometry)):
        tag = Tag(text_of(row), theme.letters(colour), theme, SMALL, backing=True)
        items = (
            ("lines", Outline(drawn.lines, theme.pen(colour, THIN))),
            ("heads", Outline(drawn.heads, None, brush(colour))),
        )
        for name, item in items:
            move = None if body is None else riding(item, body.z, body.angle)
            yield DrawnPart(f"{DIMENSIONS}.{number}.{name}", item, (DIMENSIONS,), Z_DIMENSIONS, move)
        yield DrawnPart(
            f"{DIMENSIONS}.{number}.text",
            tag,
            (DIMENSIONS,),
            Z_DIMENSIONS + 0.1,
            pinned(tag, origin + drawn.text * turn),
        )


def dimension_strokes(geometry: Geometry) -> list[tuple[np.ndarray, np.ndarray]]:
    """Where their values stand, as strokes from (n,) to (n,) [mm] of which names keep clear."""
    half = TEXT_HALF * geometry.unit
    tracks = [each.origin + each.drawn.text * each.turn for each in laid(geometry)]
    return [(track - half, track + half) for track in tracks]


# -- overlay ---------------------------------------------------------------------------------------------

MARGIN = 12.0  # from the picture's edge, pixels
TOP_STRIP, BOTTOM_STRIP = 30.0, 44.0  # of a picture, kept free of the mechanism, pixels
BAR_PIXELS, BAR_PART = 190.0, 0.35  # longest scale bar: pixels, part of the picture's width
ARROW_PIXELS = 90.0  # longest arrow of a legend
THICK = 5.0
COLOUR_BAR, COLOUR_HIGH, COLOUR_TICKS, COLOUR_ROW = 190.0, 7.0, 22.0, 46.0  # of a scale of colours, at least, pixels
Z_OVERLAY = 20.0


@frozen
class VectorUnit:
    """A scale of vectors: layer, colour, unit (as a channel spells it), length of the arrow of one unit [mm]."""

    layer: str
    family: str
    unit: str
    mm_per_unit: float


class _Corner(QGraphicsItem):
    """A place of the scene whose children are drawn in pixels, y downwards."""

    def __init__(self) -> None:
        super().__init__()
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents)
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self.setZValue(Z_OVERLAY)

    def boundingRect(self) -> QRectF:
        return QRectF()

    def paint(self, *_: object) -> None:
        """Nothing of its own."""


class ScaleBar(_Corner):
    """A bar of two fields and a round length, on the lower left."""

    def __init__(self, theme: Theme) -> None:
        super().__init__()
        self._theme = theme
        self._frame = Outline(QPainterPath(), theme.pen(theme.ink, THIN), brush(theme.paper))
        self._field = Outline(QPainterPath(), theme.pen(theme.ink, THIN), brush(theme.ink))
        self._marks = [Tag("", theme.ink, theme, SMALL, (0.5, 1.0)) for _ in range(3)]
        for item in (self._frame, self._field, *self._marks):
            item.setParentItem(self)
        self.length_mm = 0.0

    @property
    def texts(self) -> list[str]:
        """What stands beside the bar."""
        return [mark.text for mark in self._marks]

    def lay(self, scale: float, width: float) -> None:
        """scale: pixels per mm; width: of the picture, pixels."""
        size = size_of("mm")  # round in the unit that is shown
        self.length_mm = nice_below(min(BAR_PIXELS, BAR_PART * width) / scale / size) * size
        width = self.length_mm * scale
        rung = readable("mm", self.length_mm)
        shown = self.length_mm / rung.size
        for path_item, left, right in ((self._frame, 0.0, width), (self._field, 0.0, width / 2)):
            path = QPainterPath()
            path.addRect(QRectF(left, -THICK, right - left, THICK))
            path_item.redraw(path)
        texts = ("0", short(shown / 2), with_unit(short(shown), rung.symbol))
        for part, (mark, text) in enumerate(zip(self._marks, texts, strict=True)):
            mark.set_text(text)
            mark.setPos(QPointF(part * width / 2, -THICK - 2.0))
        apart = width / 2 - 0.5 * (self._marks[1].size[0] + max(self._marks[0].size[0], self._marks[2].size[0]))
        self._marks[1].setVisible(apart > 4.0)


class VectorScale(_Corner):
    """An arrow of a round length with its value, on the lower right."""

    def __init__(self, row: VectorUnit, theme: Theme) -> None:
        super().__init__()
        colour = theme.family(row.family)
        self._row = row
        self._line = Outline(QPainterPath(), theme.pen(colour, OUTLINE), brush(colour))
        self._tag = Tag("", theme.ink, theme, SMALL, (1.0, 0.5))
        self._line.setParentItem(self)
        self._tag.setParentItem(self)

    @property
    def text(self) -> str:
        return self._tag.text

    @property
    def family(self) -> str:
        """The quantity."""
        return self._row.family

    def lay(self, scale: float) -> None:
        """scale: pixels per mm."""
        per_unit = self._row.mm_per_unit * scale
        if per_unit <= 0.0:
            return
        size = size_of(self._row.unit)
        value = nice_below(ARROW_PIXELS / per_unit / size) * size
        width = value * per_unit
        path = QPainterPath(QPointF(-width, 0.0))
        path.lineTo(-9.0, 0.0)
        for x, y in ((-9.0, -3.0), (0.0, 0.0), (-9.0, 3.0), (-9.0, 0.0)):
            path.lineTo(x, y)
        self._line.redraw(path)
        rung = readable(self._row.unit, value * 2.0)
        self._tag.set_text(f"{self._row.family} {with_unit(short(value / rung.size), rung.symbol)}")
        self._tag.setPos(QPointF(-width - 8.0, 0.0))


class ColourBar(_Corner):
    """The colours of a scale with its name and its ticks, on the lower right."""

    def __init__(self, scale: ColourScale, theme: Theme) -> None:
        super().__init__()
        self.width = width = max(COLOUR_BAR, bar_width(scale))
        path = QPainterPath()
        path.addRect(QRectF(0.0, 0.0, width, COLOUR_HIGH))
        self._bar = Outline(path, theme.pen(theme.ink, THIN), QBrush(scale.gradient(width)))
        self._bar.setParentItem(self)
        self._bar.setPos(-width, -COLOUR_HIGH)
        self._tags = [self._tag(scale.title, theme, -width, -COLOUR_HIGH - 2.0, (0.0, 1.0))]
        for x, text in colour_bar(scale, width):
            self._tags.append(self._tag(text, theme, x - width, 2.0, (x / width, 0.0)))

    def _tag(self, text: str, theme: Theme, x: float, y: float, lean: tuple[float, float]) -> Tag:
        tag = Tag(text, theme.ink, theme, SMALL, lean)
        tag.setParentItem(self)
        tag.setPos(x, y)
        return tag

    @property
    def texts(self) -> list[str]:
        """Its name, then its ticks."""
        return [tag.text for tag in self._tags]


class Overlay:
    """All corners of one scene."""

    def __init__(self, theme: Theme, add: Callable[[QGraphicsItem], None]) -> None:
        self._theme, self._add = theme, add
        self.bar = ScaleBar(theme)
        self.angle = _Corner()
        self._text = Tag("", theme.ink, theme, TEXT, (0.0, 0.0))
        self._text.setParentItem(self.angle)
        self.angle_name = "cam angle"
        self.vectors: dict[str, VectorScale] = {}
        self.colours: dict[str, ColourBar] = {}
        self.reading = _Corner()
        self._read = Tag("", theme.ink, theme, SMALL, (1.0, 0.0), backing=True)
        self._read.setParentItem(self.reading)
        self._reading_text, self._reading_room = "", 0.0
        add(self.reading)
        add(self.bar)
        add(self.angle)

    @property
    def text(self) -> str:
        return self._text.text

    def show_angle(self, degrees: float, turn: int = 0) -> None:
        """Write the angle [deg] at hand, and of which turn it is."""
        turns = f" {'+' if turn > 0 else '-'} {abs(turn)} turn{'s' if abs(turn) > 1 else ''}" if turn else ""
        self._text.set_text(f"{self.angle_name.capitalize()} {degrees:.1f}°{turns}")

    @property
    def reading_text(self) -> str:
        """The values under the mouse; empty where there are none."""
        return self._reading_text

    def show_reading(self, text: str) -> None:
        """Values at a place, beside the cam angle; empty: none."""
        if text != self._reading_text:
            self._reading_text = text
            self._read.set_text(wrapped(text, self._reading_room))
            self.reading.setVisible(bool(text))

    def add_colours(self, layer: str, scale: ColourScale) -> None:
        """The scale of a layer of colours."""
        self.colours[layer] = ColourBar(scale, self._theme)
        self._add(self.colours[layer])

    def drop_colours(self, remove: Callable[[QGraphicsItem], None]) -> None:
        """Take all scales of colours away."""
        for bar in self.colours.values():
            remove(bar)
        self.colours = {}

    def add_scale(self, row: VectorUnit) -> None:
        """A line for the length of the vectors of one layer."""
        self.vectors[row.layer] = VectorScale(row, self._theme)
        self._add(self.vectors[row.layer])

    def drop_scales(self, remove: Callable[[QGraphicsItem], None]) -> None:
        """Take the scales of all vectors away."""
        for arrow in self.vectors.values():
            remove(arrow)
        self.vectors = {}

    def show_layers(self, shown: Mapping[str, bool]) -> None:
        """Show what belongs to these layers (name -> shown), vectors of one quantity once."""
        self.bar.setVisible(shown["scale"])
        for layer, item in self.colours.items():
            item.setVisible(shown[layer])
        told: set[str] = set()
        for layer, arrow in self.vectors.items():  # layers of one quantity have one scale
            arrow.setVisible(shown[layer] and arrow.family not in told)
            told |= {arrow.family} if shown[layer] else set()

    def boxes(self, visible: QRectF, scale: float) -> list[QRectF]:
        """Where the corners are taken, in pixels of the whole scene, y downwards."""
        left, right = visible.left() * scale, visible.right() * scale
        top, low = -visible.bottom() * scale, -visible.top() * scale
        widest = text_size(f"{self.angle_name.capitalize()} 360.0°", TEXT)[0]
        boxes = [QRectF(left, top, max(widest, self._text.size[0]) + 2.0 * MARGIN, sized(TOP_STRIP))]
        if self.bar.isVisible():
            boxes.append(
                QRectF(left, low - sized(BOTTOM_STRIP), self.bar.length_mm * scale + 4.0 * MARGIN, sized(BOTTOM_STRIP))
            )
        shown = sum(arrow.isVisible() for arrow in self.vectors.values())
        bars = [bar.width + MARGIN for bar in self.colours.values() if bar.isVisible()]
        if shown or bars:
            high, wide = (
                sized((1.0 + 1.5 * shown) * MARGIN) + len(bars) * sized(COLOUR_ROW),
                max(2.5 * ARROW_PIXELS, *bars, 0.0),
            )
            boxes.append(QRectF(right - wide, low - high, wide, high))
        return boxes

    def lay(self, visible: QRectF, scale: float) -> None:
        """visible: the picture's rectangle [mm]; scale: pixels per mm."""
        edge = MARGIN / scale
        self.angle.setPos(visible.left() + edge, visible.bottom() - 0.7 * edge)
        self.bar.setPos(visible.left() + edge, visible.top() + edge)
        self.bar.lay(scale, visible.width() * scale)
        below = 0.0
        for bar in self.colours.values():
            if bar.isVisible():
                bar.setPos(visible.right() - edge, visible.top() + (below + sized(COLOUR_TICKS)) / scale)
                below += sized(COLOUR_ROW)
        for row, arrow in enumerate(arrow for arrow in self.vectors.values() if arrow.isVisible()):
            arrow.setPos(visible.right() - edge, visible.top() + (1.3 + sized(1.5) * row) * edge + below / scale)
            arrow.lay(scale)
        self.reading.setPos(visible.right() - edge, visible.bottom() - 0.7 * edge)
        self._reading_room = visible.width() * scale - self._text.size[0] - 4.0 * MARGIN


# -- velocities and forces as arrows, to one scale over the whole turn -----------------------------------

LONGEST, ARROW_HEAD = 16.0, 1.8  # longest arrow and its head, in units
Z_ARROW = 11.0
NO_VECTOR = 1e-9  # a vector below this part of the largest is no vector


@frozen(eq=False)
class Field:
    """Vectors at moving places, in SI.

    rows   key, place (n,) [mm], vector (n,) [SI]
    peak   what the scale is made for [SI]: of several fields to one scale the largest of all; 0: of these vectors
    """

    family: str
    unit: str
    rows: tuple[tuple[str, np.ndarray, np.ndarray], ...]
    peak: float = 0.0

    @property
    def largest(self) -> float:
        """Size of the largest vector that is not near infinity [SI]."""
        sizes = [np.abs(vector[np.isfinite(vector)]) for _, _, vector in self.rows]
        finite = np.concatenate(sizes) if sizes else np.zeros(0)
        if not finite.size:
            return 0.0
        top, usual = float(finite.max()), float(np.percentile(finite, 98.0))
        return top if top < 20.0 * usual or usual == 0.0 else usual

    def mm_per_unit(self, geometry: Geometry) -> float:
        """Length of an arrow [mm] for one unit (SI)."""
        peak = self.peak or self.largest
        return LONGEST * geometry.unit / peak if peak > 0.0 else 0.0


def velocities(geometry: Geometry) -> Field:
    """Velocity of every point of every body that moves; points that stay together count once. Of a cam's follower also V_Q = Q θ̇ of the
    instant centre (Shin1995 (15)), which may move far away: the scale is made for the others."""
    rows: list[tuple[str, np.ndarray, np.ndarray]] = []
    for name, pose in geometry.kinematics.bodies.items():
        for point in geometry.bodies[name].nodes:
            track = pose.point(point)
            place, speed = track[0] * MM, track[1] * geometry.study.omega
            if not any(np.abs(place - other).max() <= NO_VECTOR * geometry.unit for _, other, _ in rows):
                rows.append((f"{name}.{point}", place, speed))
    field = _moving(Field("velocity", "m/s", tuple(rows)))
    if geometry.shape is None:
        return field
    q = centre_within_reach(geometry)
    q = np.where(np.isfinite(q), q, 0.0)
    turning = 1j * geometry.study.sense * geometry.study.omega * q / MM
    return _moving(replace(field, rows=(*field.rows, ("centre", q, turning)), peak=field.largest))


def forces(geometry: Geometry) -> Field:
    """What pairs and cam answer with, friction, springs and other loads; to the scale of all that acts."""
    return _acting(geometry, lambda row: row.kind not in MASS_KINDS)


def inertia(geometry: Geometry) -> Field:
    """Weight and inertia force of every body, at its centre of mass; to the same scale."""
    return _acting(geometry, lambda row: row.kind in MASS_KINDS)


def _acting(geometry: Geometry, wanted: Callable[[ForceOnBody], bool]) -> Field:
    """Those forces on the bodies that are wanted: of a pair by ``on`` on ``body``, of the cam on the follower."""
    try:
        bodies = geometry.study.free_bodies
    except NoSolution:
        return Field("force", "N", ())
    pairs = geometry.kinematics.pairs
    carried = {name: pair.body if pair.body in bodies else pair.on for name, pair in pairs.items()}
    rows = [
        (row, (_key(row, geometry), row.at * MM, row.force))
        for body, acting in bodies.items()
        for row in acting
        if (carried[row.name] == body if row.name in carried else body != CAM or row.name == BEARING)
    ]
    peak = Field("force", "N", tuple(drawn for _, drawn in rows)).largest
    return _moving(Field("force", "N", tuple(drawn for row, drawn in rows if wanted(row)), peak))


def _key(row: ForceOnBody, geometry: Geometry) -> str:
    """A pair's name for its reaction; else the kind and whose it is, of the first flank the kind alone."""
    shape = geometry.shape
    if row.kind == REACTION:
        return row.name
    if shape is not None and row.kind == CONTACT and row.name == shape.flank.name:
        return row.kind
    return f"{row.kind}.{row.name}" + (f".{row.body}" if row.kind == SPRING else "")


def _moving(field: Field) -> Field:
    """Without the vectors that stay zero; infinite ones, which have no arrow, become zero."""
    rows = tuple((key, place, np.where(np.isfinite(v), v, 0.0)) for key, place, v in field.rows)
    least = NO_VECTOR * (field.peak or field.largest)
    return replace(field, rows=tuple(row for row in rows if np.abs(row[2]).max(initial=0.0) > least))


def arrows(field: Field, layer: str, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """One arrow for each row."""
    scale = field.mm_per_unit(geometry)
    for key, place, vector in field.rows:
        dash = DASHED if layer == "inertia" else ()
        item = Arrow(theme.pen(theme.family(field.family), OUTLINE, dash), ARROW_HEAD * geometry.unit)
        yield DrawnPart(f"{layer}.{key}", item, (layer,), Z_ARROW, _follow(item, place, vector * scale))


def _follow(item: Arrow, place: np.ndarray, vector: np.ndarray) -> Move:
    return lambda i: item.point(complex(place[i]), complex(vector[i]))


FIELDS: Mapping[str, Callable[[Geometry], Field]] = MappingProxyType(
    {"velocities": velocities, "forces": forces, "inertia": inertia}
)
"""Layers of vectors, computed when first shown."""


def arrow_strokes(field: Field, geometry: Geometry) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Where arrows start and end (n,), (n,) [mm]."""
    scale = field.mm_per_unit(geometry)
    for _, place, vector in field.rows:
        yield place, place + vector * scale
