"""Side view and end view of a cam in space with its rollers, in the drawing of the output that they move.

Lengths are in mm, angles in degrees.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QPainterPath

from core.frozen import frozen
from core.spatial.views import RollerOutline
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.items import DrawnPart, Outline, Tag, riding
from kindyna_gui.pictures.shapes import arc_arrow, circle, curve, joined, keyed_bore, outline, scaled, segments
from kindyna_gui.pictures.style import CHAIN, DOTTED, OUTLINE, THIN, Theme, brush
from kindyna_gui.pictures.units import brief, number

Z_CAM, Z_REST, Z_EDGES, Z_TURRET, Z_STEM, Z_ROLLER = 2.0, 2.1, 2.5, 2.9, 3.9, 4.0
BEYOND = 3.0  # of a centre line over the cam, in units
ARROW_RADIUS, ARROW_START, ARROW_SPAN = 0.62, 200.0, 80.0  # by the cam's radius; deg
STEM = 0.35  # half the width of a roller's pin, by the roller's radius


def cam_in_space(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Both views of the cam, and its rollers."""
    if geometry.space is None:
        return
    yield from _side_view(geometry, theme)
    yield from _end_view(geometry, theme)
    yield from _rollers(geometry, theme)


def part_at(geometry: Geometry, index: int, point: complex) -> str:
    """Name of the part at a point [mm] in either view: roller 2, turret or cam; empty where none is drawn."""
    views = geometry.space
    if views is None:
        return ""
    machine = views.machine
    for roller in views.rollers(float(geometry.study.surface.motion.y[index])):
        if any(_contains(corners * MM, point) for corners in (_side(roller), _end(roller))):
            return f"roller {roller.number}" if machine.rollers > 1 else "roller"
    if (
        machine.is_turret and not machine.is_cylindrical and abs(point) <= MM * machine.inner
    ):  # that of a barrel is a line
        return "turret"
    angle = float(np.deg2rad(geometry.cam_rotation[index]))
    return "cam" if _contains(views.outline(angle) * MM, point) or on_end_view(geometry, point) else ""


@frozen
class EdgeReading:
    """Values at a point of an edge in the side view: text, and position in the drawing [mm]."""

    text: str
    point: complex

    def position(self, cam_turn: complex) -> complex:
        """Position in the drawing [mm]."""
        return self.point


def edge_reading(geometry: Geometry, index: int, point: complex, reach: float) -> EdgeReading | None:
    """Values at the visible edge nearest to a point [mm]; None where it is farther away than ``reach`` [mm]."""
    views = geometry.space
    assert views is not None
    edge = views.nearest_edge(float(np.deg2rad(geometry.cam_rotation[index])), point / MM, reach / MM)
    if edge is None:
        return None
    line, i, position = edge
    of_roller = f" of roller {line.number}" if views.machine.rollers > 1 else ""
    degrees = number(float(np.rad2deg(line.theta[i])), 1)
    text = (
        f"Flank {line.side}{of_roller} at {degrees}°: pressure angle {number(float(np.rad2deg(line.pressure_angle[i])), 1)}°, "
        f"u {brief(line.u * MM, 'mm')} along the roller"
    )
    return EdgeReading(text, position * MM)


def on_end_view(geometry: Geometry, point: complex) -> bool:
    """Whether a point [mm] is on the end view of the cam."""
    return geometry.space is not None and abs(point - geometry.axis) <= MM * geometry.space.radii[0]


def _contains(corners: np.ndarray, point: complex) -> bool:
    return bool(corners.size) and outline(corners).contains(QPointF(point.real, point.imag))


def _side_view(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    views = geometry.space
    assert views is not None
    angle = np.deg2rad(geometry.cam_rotation)
    body = Outline(QPainterPath(), theme.pen(theme.cam_line, OUTLINE), brush(theme.cam))
    rest = Outline(QPainterPath(), None, brush(theme.cam))
    edges = Outline(QPainterPath(), theme.pen(theme.cam_line, THIN))

    @lru_cache(maxsize=2)
    def edges_at(i: int) -> tuple[tuple[bool, np.ndarray], ...]:
        return views.edges_at(float(angle[i]))

    def move(i: int) -> None:
        body.redraw(outline(views.outline(float(angle[i])) * MM))

    def move_rest(i: int) -> None:
        areas = joined(*(outline(area * MM) for _, edge in edges_at(i) for area in views.down_to_axis(edge)))
        areas.setFillRule(Qt.FillRule.WindingFill)  # areas overlap
        rest.redraw(areas)

    def move_edges(i: int) -> None:
        edges.redraw(joined(*(curve(edge * MM) for is_visible, edge in edges_at(i) if is_visible)))

    yield DrawnPart("cam", body, ("cam",), Z_CAM, move)
    yield DrawnPart("cam.rest", rest, ("cam",), Z_REST, move_rest)
    yield DrawnPart("cam.edges", edges, ("cam",), Z_EDGES, move_edges)
    over = BEYOND * geometry.unit
    ends = [
        MM * views.origin + complex(views.axes.side[2]) * z
        for z in (MM * views.ends[0] - over, MM * views.ends[1] + over)
    ]
    yield DrawnPart(
        "axis", Outline(segments([(ends[0], ends[1])]), theme.pen(theme.quiet, THIN, CHAIN)), ("cam",), Z_EDGES
    )
    yield _title("side", "Side view", geometry.view_boxes[0], geometry, theme)


def _end_view(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    views = geometry.space
    assert views is not None
    centre, (outer, inner) = MM * views.end_origin, (MM * radius for radius in views.radii)
    pen = theme.pen(theme.cam_line, OUTLINE)
    yield DrawnPart("cam.end", Outline(circle(outer, centre), pen, brush(theme.cam)), ("cam",), Z_CAM)
    floor = Outline(circle(inner, centre), theme.pen(theme.cam_line, THIN, DOTTED))
    yield DrawnPart("cam.floor", floor, ("cam",), Z_EDGES)
    track = np.full(geometry.samples, centre)
    turn = complex(views.axes.end[0]) * np.exp(1j * np.deg2rad(geometry.cam_rotation))
    hole = max((radius for name, radius in geometry.known_circles if name == "bore"), default=0.0)
    if hole:
        bore = Outline(
            keyed_bore(geometry.keyway) if geometry.keyway else circle(hole),
            theme.pen(theme.cam_line, THIN),
            brush(theme.paper),
        )
        yield DrawnPart("bore", bore, ("cam",), Z_EDGES, riding(bore, track, turn))
    mark = Outline(segments([(0.76 * inner + 0j, outer + 0j)]), theme.pen(theme.cam_line, THIN))
    yield DrawnPart("zero", mark, ("cam",), Z_EDGES, riding(mark, track, turn))
    over = outer + BEYOND * geometry.unit
    cross = segments([(centre - over, centre + over), (centre - 1j * over, centre + 1j * over)])
    yield DrawnPart("axis.end", Outline(cross, theme.pen(theme.quiet, THIN, CHAIN)), ("cam",), Z_EDGES)
    start, span = (ARROW_START, ARROW_SPAN) if views.sense > 0 else (ARROW_START + ARROW_SPAN, -ARROW_SPAN)
    shapes = arc_arrow(ARROW_RADIUS * inner + 0.5 * hole * (1.0 - ARROW_RADIUS), start, span, 1.6 * geometry.unit)
    for key, shape in zip(("sense", "sense.head"), shapes, strict=True):
        arrow = Outline(
            scaled(shape, 1.0, centre), theme.pen(theme.cam_line, THIN), brush(theme.cam_line) if "." in key else None
        )
        yield DrawnPart(key, arrow, ("cam",), Z_EDGES)
    yield _title("end", "End view", geometry.view_boxes[1], geometry, theme)


def _title(key: str, text: str, box: tuple[complex, complex], geometry: Geometry, theme: Theme) -> DrawnPart:
    """Name of a view below it."""
    tag = Tag(text, theme.quiet, theme, lean=(0.5, 0.0), backing=True)
    tag.setPos(QPointF(0.5 * (box[0] + box[1]).real, box[0].imag - BEYOND * geometry.unit))
    return DrawnPart(f"title.{key}", tag, ("cam", "labels"), Z_EDGES)


def _rollers(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Rollers with their axes; in the end view those that are in the blank."""
    views = geometry.space
    assert views is not None
    y = geometry.study.surface.motion.y

    @lru_cache(maxsize=2)
    def outlines(i: int) -> tuple[RollerOutline, ...]:
        return tuple(views.rollers(float(y[i])))

    def redrawn(item: Outline, k: int, view: Callable[[RollerOutline], np.ndarray]) -> Callable[[int], None]:
        return lambda i: item.redraw(outline(view(outlines(i)[k]) * MM))

    for k, roller in enumerate(outlines(0)):
        for key, view in (("", _side), (".end", _end)):
            item = Outline(QPainterPath(), theme.pen(theme.ink, OUTLINE), brush(theme.roller, 0.75))
            yield DrawnPart(f"roller{roller.number}{key}", item, ("roller",), Z_ROLLER, redrawn(item, k, view))
        if views.machine.slides:
            yield from _pin(k, roller, geometry, theme)
    if views.machine.is_turret:
        radius = MM * (views.machine.lever if views.machine.is_cylindrical else views.machine.inner)
        disc = Outline(
            circle(radius),
            theme.pen(theme.ink, OUTLINE),
            None if views.machine.is_cylindrical else brush(theme.links[0]),
        )
        yield DrawnPart("turret", disc, ("linkage",), Z_TURRET)


def _side(roller: RollerOutline) -> np.ndarray:
    return roller.side


def _end(roller: RollerOutline) -> np.ndarray:
    return roller.end if roller.in_blank else roller.end[:0]


def _pin(k: int, roller: RollerOutline, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Pin of a slide's roller, from the roller to the slide, which is at the height 0 of the drawing."""
    views = geometry.space
    assert views is not None
    low, high = MM * (roller.side.imag.max()), 0.0
    half = STEM * MM * views.machine.radius
    at_start = MM * 0.5 * (roller.side.real.min() + roller.side.real.max()) - geometry.reference[0].real
    corners = at_start + np.array([complex(x, y) for x, y in ((-half, low), (half, low), (half, high), (-half, high))])
    item = Outline(outline(corners), theme.pen(theme.ink, OUTLINE), brush(theme.links[0]))
    turn = np.ones(geometry.samples, dtype=complex)
    yield DrawnPart(f"stem.roller{roller.number}", item, ("linkage",), Z_STEM, riding(item, geometry.reference, turn))


__all__ = ["EdgeReading", "cam_in_space", "edge_reading", "on_end_view", "part_at"]
