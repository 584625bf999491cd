"""Dimensions, texts and scales in the corners of a drawing, and velocities and forces as arrows.

Arrows of one quantity have one scale over the turn.
"""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
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
from core.output.drawing.scales import nice_below
from kindyna_gui.pictures.drawing.cam_parts import ColourScale, bar_width, centre_within_reach, colour_bar
from kindyna_gui.pictures.drawing.geometry import MM, Body, Geometry
from kindyna_gui.pictures.drawing.parts import DIMENSIONS
from kindyna_gui.pictures.items import Arrow, DrawnPart, Move, Outline, Tag, pinned, riding, text_size, wrapped
from kindyna_gui.pictures.shapes import arrow_head, joined, polyline, segments
from kindyna_gui.pictures.style import DASHED, OUTLINE, SMALL, TEXT, THIN, Theme, brush
from kindyna_gui.pictures.units import number, readable, short, with_unit
from kindyna_gui.settings import size_of, sized

# -- dimensions ----------------------------------------------------------------------------------------

AWAY, LEVEL = 4.0, 3.5  # distance of a dimension line from the part, and from the next dimension line, in units
BEYOND, DIMENSION_HEAD = 1.0, 1.6  # extension line beyond the dimension line, and arrow head, in units
SHORT, TEXT_OFFSET = 9.0, 4.5  # length below which a value is outside the dimension, and its offset, in units
TEXT_HALF = 3.5  # half the width of a value, in units
DIRECTIONS = 10.0  # distinct directions per radian
ARC, ARC_STEPS = 0.22, 40  # radius of an angle's arc by the shorter leg, and pieces of the arc
Z_DIMENSIONS = 10.0


class DimensionRoom(NamedTuple):
    """Space for a dimension.

    Attributes
    ----------
    across : direction of the extension lines
    away : distance of the dimension line [mm]
    part : position of the value, as a fraction of the length
    unit : size of symbols [mm]
    """

    across: complex
    away: float
    part: float
    unit: float


class DimensionLines(NamedTuple):
    """Lines, arrow heads and the position of the value, in the frame of the dimension's body [mm]."""

    lines: QPainterPath
    heads: QPainterPath
    text: complex


def _length(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """Length between extension lines; a short one has its value outside."""
    across, away, part, unit = room
    first, second = (point * MM for point in row.points)
    reach = max((first * across.conjugate()).real, (second * across.conjugate()).real) + away
    start, end = (point + (reach - (point * across.conjugate()).real) * across for point in (first, second))
    over = across * BEYOND * unit
    lines = segments([(start, end), (first + over, start + over), (second + over, end + over)])
    size = abs(end - start)
    along = (end - start) / (size or 1.0)
    tip = min(DIMENSION_HEAD * unit, 0.45 * size)
    heads = joined(arrow_head(start, -along, tip), arrow_head(end, along, tip))
    text = start + part * (end - start) if size > SHORT * unit else end + along * TEXT_OFFSET * unit
    return DimensionLines(lines, heads, text)


def _radius(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """Radius from the centre to the circle; a small one has its value outside."""
    unit = room.unit
    centre, edge = (point * MM for point in row.points)
    size = abs(edge - centre)
    along = (edge - centre) / size
    inside = size > SHORT * unit
    text = centre + 0.6 * (edge - centre) if inside else edge + along * TEXT_OFFSET * unit
    return DimensionLines(
        segments([(centre, edge if inside else text)]),
        arrow_head(edge, along, min(DIMENSION_HEAD * unit, 0.5 * size)),
        text,
    )


def _angle(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """Arc between the legs of an angle."""
    vertex, first, second = (point * MM for point in row.points)
    radius = ARC * min(abs(first - vertex), abs(second - vertex))
    start, span = cmath.phase(first - vertex), np.deg2rad(row.value)
    arc = [vertex + cmath.rect(radius, start + span * k / ARC_STEPS) for k in range(ARC_STEPS + 1)]
    tip = min(DIMENSION_HEAD * room.unit, 0.4 * radius * abs(span))
    quarter = 1j if span > 0.0 else -1j
    heads = joined(
        arrow_head(arc[0], -quarter * (arc[0] - vertex) / radius, tip),
        arrow_head(arc[-1], quarter * (arc[-1] - vertex) / radius, tip),
    )
    return DimensionLines(polyline(arc), heads, arc[ARC_STEPS // 2])


SHAPES: Mapping[str, Callable[[Dimension, DimensionRoom], DimensionLines]] = MappingProxyType(
    {LENGTH: _length, RADIUS: _radius, ANGLE: _angle}
)
"""Function that draws each kind of dimension."""


def dimension_text(row: Dimension) -> str:
    """Symbol and value of a dimension; millimetres have no unit, as in a workshop drawing."""
    return f"{row.symbol}{short(row.value, 7)}{'°' if row.kind == ANGLE else ''}"


class PlacedDimension(NamedTuple):
    """A drawn dimension and the motion of its body: origin (n,) [mm], turn (n,), and the body where it moves."""

    row: Dimension
    drawn: DimensionLines
    origin: np.ndarray
    turn: np.ndarray
    body: Body | None


def placed_dimensions(geometry: Geometry) -> Iterator[PlacedDimension]:
    """All dimensions of the drive; parallel dimensions on one side of a body have increasing distances."""
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
    """Unit vector perpendicular to a dimension, towards the outside."""
    along = row.along or row.points[1] - row.points[0]
    across = 1j * along / abs(along)
    return across if (across * outwards.conjugate()).real >= 0.0 else -across


def dimensions(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """All dimensions of the drive, which move with their bodies."""
    colour = theme.family("length")
    for index, (row, drawn, origin, turn, body) in enumerate(placed_dimensions(geometry)):
        tag = Tag(dimension_text(row), theme.text_colour(colour), theme, SMALL, backing=True)
        items = (
            ("lines", Outline(drawn.lines, theme.pen(colour, THIN))),
            ("heads", Outline(drawn.heads, None, brush(colour))),
        )
        for name, item in items:
            move = None if body is None else riding(item, body.z, body.turn)
            yield DrawnPart(f"{DIMENSIONS}.{index}.{name}", item, (DIMENSIONS,), Z_DIMENSIONS, move)
        yield DrawnPart(
            f"{DIMENSIONS}.{index}.text",
            tag,
            (DIMENSIONS,),
            Z_DIMENSIONS + 0.1,
            pinned(tag, origin + drawn.text * turn),
        )


def dimension_strokes(geometry: Geometry) -> list[tuple[np.ndarray, np.ndarray]]:
    """Strokes from (n,) to (n,) [mm] at the values of the dimensions, which labels avoid."""
    half = TEXT_HALF * geometry.unit
    tracks = [row.origin + row.drawn.text * row.turn for row in placed_dimensions(geometry)]
    return [(track - half, track + half) for track in tracks]


# -- texts and scales in the corners -------------------------------------------------------------------

MARGIN = 12.0  # from the edge of the view, pixels
TOP_STRIP, BOTTOM_STRIP = 30.0, 44.0  # strips of the view for texts, free of the mechanism, pixels
BAR_PIXELS, BAR_PART = 190.0, 0.35  # longest scale bar: pixels, fraction of the width of the view
ARROW_PIXELS = 90.0  # longest arrow of a vector scale
BAR_HEIGHT = 5.0
COLOUR_BAR, COLOUR_HEIGHT, COLOUR_TICKS, COLOUR_ROW = 190.0, 7.0, 22.0, 46.0  # least width and heights, pixels
Z_OVERLAY = 20.0


@frozen
class VectorUnit:
    """Scale of the vectors of a layer: quantity, unit as in channels, and arrow length of one unit [mm]."""

    layer: str
    family: str
    unit: str
    mm_per_unit: float


class Group(QGraphicsItem):
    """Parent item that draws nothing but its children."""

    def __init__(self, children: Sequence[QGraphicsItem] = ()) -> None:
        super().__init__()
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents)
        for child in children:
            child.setParentItem(self)

    def boundingRect(self) -> QRectF:
        return QRectF()

    def paint(self, *_: object) -> None:
        """Draw nothing: the children draw themselves."""


class _Corner(Group):
    """A point of the scene whose children are drawn in pixels, y downwards."""

    def __init__(self) -> None:
        super().__init__()
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self.setZValue(Z_OVERLAY)


class ScaleBar(_Corner):
    """Scale bar of a round length with two fields, lower left."""

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
        """Texts of the bar."""
        return [mark.text for mark in self._marks]

    def lay(self, scale: float, width: float) -> None:
        """Place the bar for a scale [pixels per mm] and the width of the view [pixels]."""
        size = size_of("mm")  # the length is round in the displayed unit
        self.length_mm = nice_below(min(BAR_PIXELS, BAR_PART * width) / scale / size) * size
        width = self.length_mm * scale
        unit = readable("mm", self.length_mm)
        shown = self.length_mm / unit.size
        for path_item, left, right in ((self._frame, 0.0, width), (self._field, 0.0, width / 2)):
            path = QPainterPath()
            path.addRect(QRectF(left, -BAR_HEIGHT, right - left, BAR_HEIGHT))
            path_item.redraw(path)
        texts = ("0", short(shown / 2), with_unit(short(shown), unit.symbol))
        for part, (mark, text) in enumerate(zip(self._marks, texts, strict=True)):
            mark.set_text(text)
            mark.setPos(QPointF(part * width / 2, -BAR_HEIGHT - 2.0))
        gap = width / 2 - 0.5 * (self._marks[1].size[0] + max(self._marks[0].size[0], self._marks[2].size[0]))
        self._marks[1].setVisible(gap > 4.0)


class VectorScale(_Corner):
    """Arrow of a round value, lower right."""

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
        """Quantity of the vectors."""
        return self._row.family

    def lay(self, scale: float) -> None:
        """Place the arrow for a scale [pixels per mm]."""
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
        unit = readable(self._row.unit, value * 2.0)
        self._tag.set_text(f"{self._row.family} {with_unit(short(value / unit.size), unit.symbol)}")
        self._tag.setPos(QPointF(-width - 8.0, 0.0))


class ColourBar(_Corner):
    """Colour scale with its title and its ticks, lower right."""

    def __init__(self, scale: ColourScale, theme: Theme) -> None:
        super().__init__()
        self.width = width = max(COLOUR_BAR, bar_width(scale))
        path = QPainterPath()
        path.addRect(QRectF(0.0, 0.0, width, COLOUR_HEIGHT))
        self._bar = Outline(path, theme.pen(theme.ink, THIN), QBrush(scale.gradient(width)))
        self._bar.setParentItem(self)
        self._bar.setPos(-width, -COLOUR_HEIGHT)
        self._tags = [self._tag(scale.title, theme, -width, -COLOUR_HEIGHT - 2.0, (0.0, 1.0))]
        for x, text in colour_bar(scale, width):
            self._tags.append(self._tag(text, theme, x - width, 2.0, (x / width, 0.0)))

    def _tag(self, text: str, theme: Theme, x: float, y: float, lean: tuple[float, float]) -> Tag:
        tag = Tag(text, theme.ink, theme, SMALL, lean)
        tag.setParentItem(self)
        tag.setPos(x, y)
        return tag

    @property
    def texts(self) -> list[str]:
        """Title of the scale, then its ticks."""
        return [tag.text for tag in self._tags]


class Overlay:
    """All texts and scales in the corners of one scene."""

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
        self.reading_text, self._reading_room = "", 0.0  # values under the mouse
        add(self.reading)
        add(self.bar)
        add(self.angle)

    @property
    def text(self) -> str:
        return self._text.text

    def show_angle(self, degrees: float, turn: int = 0) -> None:
        """Show the current angle [deg] and the number of the turn."""
        turns = f" {'+' if turn > 0 else '-'} {abs(turn)} turn{'s' if abs(turn) > 1 else ''}" if turn else ""
        self._text.set_text(f"{self.angle_name.capitalize()} {number(degrees, 1)}°{turns}")

    def show_reading(self, text: str) -> None:
        """Show values next to the cam angle; "" hides them."""
        if text != self.reading_text:
            self.reading_text = text
            self._read.set_text(wrapped(text, self._reading_room))
            self.reading.setVisible(bool(text))

    def add_colours(self, layer: str, scale: ColourScale) -> None:
        """Add the scale of a colour layer."""
        self.colours[layer] = ColourBar(scale, self._theme)
        self._add(self.colours[layer])

    def drop_colours(self, remove: Callable[[QGraphicsItem], None]) -> None:
        """Remove all colour scales."""
        for bar in self.colours.values():
            remove(bar)
        self.colours = {}

    def add_scale(self, row: VectorUnit) -> None:
        """Add the scale of a vector layer."""
        self.vectors[row.layer] = VectorScale(row, self._theme)
        self._add(self.vectors[row.layer])

    def drop_scales(self, remove: Callable[[QGraphicsItem], None]) -> None:
        """Remove all vector scales."""
        for arrow in self.vectors.values():
            remove(arrow)
        self.vectors = {}

    def show_layers(self, shown: Mapping[str, bool]) -> None:
        """Show the scales of the visible layers, one for each quantity."""
        self.bar.setVisible(shown["scale"])
        for layer, item in self.colours.items():
            item.setVisible(shown[layer])
        families: set[str] = set()
        for layer, arrow in self.vectors.items():
            arrow.setVisible(shown[layer] and arrow.family not in families)
            families |= {arrow.family} if shown[layer] else set()

    def boxes(self, visible: QRectF, scale: float) -> list[QRectF]:
        """Boxes of the texts and scales in pixels of the scene, y downwards."""
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
            height = sized((1.0 + 1.5 * shown) * MARGIN) + len(bars) * sized(COLOUR_ROW)
            width = max(2.5 * ARROW_PIXELS, *bars, 0.0)
            boxes.append(QRectF(right - width, low - height, width, height))
        return boxes

    def lay(self, visible: QRectF, scale: float) -> None:
        """Place everything for a view of ``visible`` [mm] at ``scale`` [pixels per mm]."""
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


# -- velocities and forces -----------------------------------------------------------------------------

LONGEST, ARROW_HEAD = 16.0, 1.8  # longest arrow and its head, in units
Z_ARROW = 11.0
NO_VECTOR = 1e-9  # vectors below this fraction of the largest count as zero


@frozen(eq=False)
class Field:
    """Vectors at moving points.

    Attributes
    ----------
    family, unit : quantity and SI unit of the vectors
    rows : key, point (n,) [mm] and vector (n,) [SI] of each arrow
    peak : size [SI] that sets the scale, the largest of all fields with a common scale; 0 takes the largest vector
    """

    family: str
    unit: str
    rows: tuple[tuple[str, np.ndarray, np.ndarray], ...]
    peak: float = 0.0

    @property
    def largest(self) -> float:
        """Size of the largest vector [SI]; sizes that tend to infinity are left out."""
        sizes = [np.abs(vector[np.isfinite(vector)]) for _, _, vector in self.rows]
        finite = np.concatenate(sizes) if sizes else np.zeros(0)
        if not finite.size:
            return 0.0
        top, typical = float(finite.max()), float(np.percentile(finite, 98.0))
        return top if top < 20.0 * typical or typical == 0.0 else typical

    def mm_per_unit(self, geometry: Geometry) -> float:
        """Length of the arrow [mm] of one SI unit."""
        peak = self.peak or self.largest
        return LONGEST * geometry.unit / peak if peak > 0.0 else 0.0


def velocities(geometry: Geometry) -> Field:
    """Velocities of all points of moving bodies, and of a follower's instant centre, V_Q = Q θ̇.

    Points that coincide have one arrow. The instant centre may be far away, so it does not influence the scale.

    References
    ----------
    Shin 1995, eq. (15).
    """
    rows: list[tuple[str, np.ndarray, np.ndarray]] = []
    for name, pose in geometry.kinematics.bodies.items():
        for point in geometry.bodies[name].nodes:
            track = pose.point(point)
            position, velocity = track[0] * MM, track[1] * geometry.study.omega
            if not any(np.abs(position - known).max() <= NO_VECTOR * geometry.unit for _, known, _ in rows):
                rows.append((f"{name}.{point}", position, velocity))
    field = _nonzero(Field("velocity", "m/s", tuple(rows)))
    if geometry.shape is None:
        return field
    q = centre_within_reach(geometry)
    q = np.where(np.isfinite(q), q, 0.0)
    velocity = 1j * geometry.study.sense * geometry.study.omega * q / MM
    return _nonzero(replace(field, rows=(*field.rows, ("centre", q, velocity)), peak=field.largest))


def forces(geometry: Geometry) -> Field:
    """Reactions of pairs and cam, friction, springs and other loads, to the scale of all forces."""
    return _force_field(geometry, lambda row: row.kind not in MASS_KINDS)


def inertia(geometry: Geometry) -> Field:
    """Weight and inertia force of every body at its centre of mass, to the scale of all forces."""
    return _force_field(geometry, lambda row: row.kind in MASS_KINDS)


def _force_field(geometry: Geometry, is_shown: Callable[[ForceOnBody], bool]) -> Field:
    """Selected forces on the bodies: in a pair the force from ``on`` on ``body``, at the cam that on the follower."""
    try:
        bodies = geometry.study.free_bodies
    except NoSolution:
        return Field("force", "N", ())
    pairs = geometry.kinematics.pairs
    loaded_body = {name: pair.body if pair.body in bodies else pair.on for name, pair in pairs.items()}
    rows = [
        (row, (_key(row, geometry), row.at * MM, row.force))
        for body, acting in bodies.items()
        for row in acting
        if (loaded_body[row.name] == body if row.name in loaded_body else body != CAM or row.name == BEARING)
    ]
    peak = Field("force", "N", tuple(drawn for _, drawn in rows)).largest
    return _nonzero(Field("force", "N", tuple(drawn for row, drawn in rows if is_shown(row)), peak))


def _key(row: ForceOnBody, geometry: Geometry) -> str:
    """Key of a force: the pair of a reaction, else the kind and the element; the first flank has the kind only."""
    shape = geometry.shape
    if row.kind == REACTION:
        return row.name
    if shape is not None and row.kind == CONTACT and row.name == shape.flank.name:
        return row.kind
    return f"{row.kind}.{row.name}" + (f".{row.body}" if row.kind == SPRING else "")


def _nonzero(field: Field) -> Field:
    """Drop vectors that are zero over the turn; infinite vectors become zero, because they have no arrow."""
    rows = tuple((key, track, np.where(np.isfinite(v), v, 0.0)) for key, track, v in field.rows)
    least = NO_VECTOR * (field.peak or field.largest)
    return replace(field, rows=tuple(row for row in rows if np.abs(row[2]).max(initial=0.0) > least))


def arrows(field: Field, layer: str, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """One arrow for each row of a field."""
    scale = field.mm_per_unit(geometry)
    for key, track, vector in field.rows:
        dash = DASHED if layer == "inertia" else ()
        item = Arrow(theme.pen(theme.family(field.family), OUTLINE, dash), ARROW_HEAD * geometry.unit)
        yield DrawnPart(f"{layer}.{key}", item, (layer,), Z_ARROW, _follow(item, track, vector * scale))


def _follow(item: Arrow, track: np.ndarray, vector: np.ndarray) -> Move:
    return lambda i: item.point(complex(track[i]), complex(vector[i]))


FIELDS: Mapping[str, Callable[[Geometry], Field]] = MappingProxyType(
    {"velocities": velocities, "forces": forces, "inertia": inertia}
)
"""Vector layers, computed when first shown."""


def arrow_strokes(field: Field, geometry: Geometry) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Start and end (n,) [mm] of the arrows of a field."""
    scale = field.mm_per_unit(geometry)
    for _, track, vector in field.rows:
        yield track, track + vector * scale
