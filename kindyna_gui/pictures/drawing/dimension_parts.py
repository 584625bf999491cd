"""Dimensions on the drawing: lengths between extension lines, radii and angles with arrows, each beside its value."""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from PySide6.QtGui import QPainterPath

from core.followers.dimensions import ANGLE, LENGTH, RADIUS, Dimension, dimensions_of
from core.mechanism.kinematics import FRAME
from kindyna_gui.pictures.drawing.geometry import MM, Body, Geometry
from kindyna_gui.pictures.drawing.layers import DIMENSIONS
from kindyna_gui.pictures.items import DrawnPart, Outline, Tag, pinned, riding
from kindyna_gui.pictures.shapes import arrow_head, joined, polyline, segments
from kindyna_gui.pictures.style import SMALL, THIN, Theme, brush
from kindyna_gui.pictures.units import short

AWAY, LEVEL, BEYOND, HEAD = (
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
    one, other = (place * MM for place in row.places)
    reach = max((one * across.conjugate()).real, (other * across.conjugate()).real) + away
    ends = [place + (reach - (place * across.conjugate()).real) * across for place in (one, other)]
    over = across * BEYOND * unit
    lines = segments([(ends[0], ends[1]), (one + over, ends[0] + over), (other + over, ends[1] + over)])
    size = abs(ends[1] - ends[0])
    way = (ends[1] - ends[0]) / (size or 1.0)
    head = min(HEAD * unit, 0.45 * size)
    heads = joined(arrow_head(ends[0], -way, head), arrow_head(ends[1], way, head))
    return DimensionLines(
        lines, heads, ends[0] + part * (ends[1] - ends[0]) if size > SHORT * unit else ends[1] + way * BESIDE * unit
    )


def _radius(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """From the centre to the circle; the value of a small one stands outside."""
    unit = room.unit
    centre, edge = (place * MM for place in row.places)
    size = abs(edge - centre)
    way = (edge - centre) / size
    inside = size > SHORT * unit
    text = centre + 0.6 * (edge - centre) if inside else edge + way * BESIDE * unit
    return DimensionLines(
        segments([(centre, edge if inside else text)]), arrow_head(edge, way, min(HEAD * unit, 0.5 * size)), text
    )


def _angle(row: Dimension, room: DimensionRoom) -> DimensionLines:
    """An arc between the legs."""
    vertex, first, other = (place * MM for place in row.places)
    radius = ARC * min(abs(first - vertex), abs(other - vertex))
    start, span = cmath.phase(first - vertex), np.deg2rad(row.value)
    arc = [vertex + cmath.rect(radius, start + span * k / ARC_STEPS) for k in range(ARC_STEPS + 1)]
    head = min(HEAD * room.unit, 0.4 * radius * abs(span))
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
        outwards = complex(((origin + sum(row.places) * MM / len(row.places) * turn - middle) / turn).mean())
        across = _across(row, outwards)
        direction = (row.body, round(DIRECTIONS * cmath.phase(across))) if row.kind == LENGTH else ("", -1)
        number, unit = levels[direction], geometry.unit
        levels[direction] += 1
        room = DimensionRoom(across, (AWAY + LEVEL * number) * unit, 0.5 / (1.0 + 0.5 * number), unit)
        yield PlacedDimension(row, SHAPES[row.kind](row, room), origin, turn, body)


def _across(row: Dimension, outwards: complex) -> complex:
    """The unit vector square to what is measured, on the outer side."""
    along = row.along or row.places[1] - row.places[0]
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


def strokes(geometry: Geometry) -> list[tuple[np.ndarray, np.ndarray]]:
    """Where their values stand, as strokes from (n,) to (n,) [mm] of which names keep clear."""
    half = TEXT_HALF * geometry.unit
    tracks = [each.origin + each.drawn.text * each.turn for each in laid(geometry)]
    return [(track - half, track + half) for track in tracks]
