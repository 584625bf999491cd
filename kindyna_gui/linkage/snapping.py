"""Snapping of the mouse to points, lines, angles and the grid; the grid and the marks of the snaps as painted, in pixels."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from core.design import UNITS
from core.design.linkage import FRAME_LINK, Linkage
from core.frozen import frozen
from core.mechanism.drawing_targets import DrawingTarget, crossing, edges, faces_at, joined, links_with, outline
from core.mechanism.drawn import PointPositions, nearest_on_segment, slider_line
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short, typed, with_unit
from kindyna_gui.settings import number_text, size_of, symbol_of

POINT, LINE, PERPENDICULAR, ANGLE, GRID, FREE = "point", "line", "perpendicular", "angle", "grid", ""
NEAR, ALONG, TURN = 10.0, 7.0, 6.0  # snap distances from a point, a line and a ray, pixels
TOUCH = 8.0  # pins nearer to each other would overlap in the drawing, pixels
STEP_DEG = 15.0  # step of the angles that a new line snaps to
CELL = 14.0  # smallest cell of the grid, pixels
FACE = 7.0  # half width of the face of a bar, pixels
MM = UNITS["mm"]
MOST_LINES = 400  # a finer grid is not drawn

PixelFunction = Callable[[complex], QPointF]
"""Pixel of a position [mm]."""


@frozen
class Snap:
    """Position that the mouse snaps to [mm], the kind of snap, and the point or link that a click there joins."""

    at: complex
    mark: str = FREE
    text: str = ""
    point: str = ""
    link: int | None = None

    @property
    def target(self) -> DrawingTarget:
        """The position, point and link as a target of an edit."""
        return DrawingTarget(self.at, self.point, self.link)

    @property
    def label(self) -> str:
        """Text next to the mark: the kind of snap, and what a click joins."""
        return ", ".join(
            filter(None, (self.text, f"on link {self.link}" if self.link not in (None, FRAME_LINK) else ""))
        )


def snap_at(linkage: Linkage, positions: PointPositions, at: complex, barred: Collection[int] = ()) -> Snap:
    """Return the snap of an exact position, with the point or link that it joins; ``barred`` links are not joined."""
    target = joined(linkage, positions, DrawingTarget(at), barred)
    mark = POINT if target.point else FREE if target.link is None else LINE
    return Snap(target.at, mark, target.point, target.point, target.link)


def grid_step(scale: float) -> float:
    """Width of a grid cell [mm] at a scale in pixels per mm: 1, 2 or 5 times a power of ten."""
    least = CELL / scale
    power = 10.0 ** math.floor(math.log10(least))
    return next(k * power for k in (1.0, 2.0, 5.0, 10.0) if k * power >= least * (1.0 - 1e-9))


def grid_point(at: complex, scale: float) -> complex:
    """Return the nearest crossing of the grid."""
    step = grid_step(scale)
    digits = max(0, -math.floor(math.log10(step)))
    return complex(round(round(at.real / step) * step, digits) + 0.0, round(round(at.imag / step) * step, digits) + 0.0)


def point_at(positions: PointPositions, at: complex, scale: float, reach: float = NEAR) -> str:
    """Return the nearest point within a distance in pixels; empty if there is none."""
    near = {name: abs(position - at) * scale for name, position in positions.items()}
    best = min(near, key=lambda name: near[name], default="")
    return best if best and near[best] <= reach else ""


def nearest_mark(marks: Sequence[complex], at: complex, scale: float) -> complex | None:
    """Return the nearest mark of the underlay within the snap distance, or None."""
    if not len(marks):
        return None
    distances = np.abs(np.asarray(marks) - at)
    best = int(np.argmin(distances))
    return complex(marks[best]) if distances[best] * scale <= NEAR else None


def snap_to(
    linkage: Linkage,
    positions: PointPositions,
    at: complex,
    scale: float,
    start: complex | None = None,
    without: Collection[str] = (),
    free: bool = False,
    marks: Sequence[complex] = (),
    barred: Collection[int] = (),
) -> Snap:
    """Snap a position of the mouse [mm] to the drawing, at a scale in pixels per mm.

    A point has priority within ``NEAR`` pixels, over its cell of the grid, and wherever a new pin would overlap it.

    start    where the line to the mouse begins
    without  points that the mouse is moving
    free     no snapping, but to what is exactly there
    marks    corners and centres of the underlay
    barred   links that a click does not join
    """
    points = {name: position for name, position in positions.items() if name not in without}
    numbers = {*linkage.by_number} - {FRAME_LINK, *barred} - links_with(linkage, without)
    if free:
        snap = snap_at(linkage, points, at, barred)
    elif name := point_at(points, at, scale) or point_at(points, grid_point(at, scale), scale, TOUCH):
        return Snap(points[name], POINT, name, name)
    else:
        links = [link for link in linkage.links if link.number in numbers]
        lines = [(*edge, link.number) for link in links for edge in edges(outline(link, positions))]
        guides = [
            (*slider_line(linkage, slider, positions), f"on the line of link {slider.link}")
            for slider in linkage.sliders
            if slider.on in linkage.by_number
        ]
        snap = _aligned(lines, guides, at, scale, start, marks)
        if name := point_at(points, snap.at, scale, TOUCH):
            return Snap(points[name], POINT, name, name)
    if snap.point or snap.link is not None:
        return snap
    faces = faces_at(linkage, positions, snap.at, FACE / scale)
    return replace(snap, link=next((n for n in faces if n in numbers), None))


_Line = tuple[complex, complex, int]
"""Ends [mm] of an edge of a link, and the number of the link."""


_Guide = tuple[complex, complex, str]
"""Line to which the mouse snaps: through a point [mm], in a direction (unit vector), and its name."""


def snap_to_points(
    positions: PointPositions,
    at: complex,
    scale: float,
    start: complex | None = None,
    free: bool = False,
    marks: Sequence[complex] = (),
) -> Snap:
    """Snap a position of the mouse [mm] to points, marks of the underlay, rays from ``start`` and the grid, as ``snap_to``."""
    if free:
        return Snap(at)
    name = point_at(positions, at, scale) or point_at(positions, grid_point(at, scale), scale, TOUCH)
    return Snap(positions[name], POINT, name, name) if name else _aligned((), (), at, scale, start, marks)


def snapped_angle(start: complex, at: complex, scale: float, free: bool = False) -> float:
    """Angle [deg] of the line from ``start`` to the mouse: in steps of 15 near these, else in whole degrees; ``free``: as it is."""
    angle = math.degrees(cmath.phase(at - start))
    step = round(angle / STEP_DEG) * STEP_DEG
    distance = abs(at - start) * abs(math.sin(math.radians(angle - step)))
    return angle if free else step if distance * scale <= TURN else float(round(angle))


def _aligned(
    lines: Sequence[_Line],
    guides: Sequence[_Guide],
    at: complex,
    scale: float,
    start: complex | None,
    marks: Sequence[complex],
) -> Snap:
    """Snap to a mark of the underlay, the line of a link, a guide, a ray from ``start``, or the grid."""
    if (mark := nearest_mark(marks, at, scale)) is not None:
        return Snap(mark, GRID, "on the underlay")
    if (snap := _on_line(lines, at, scale, start)) is not None:
        return snap
    for through, along, text in guides:
        on = through + along * ((at - through) * along.conjugate()).real
        if abs(at - on) * scale <= ALONG:
            return Snap(on, ANGLE, text)
    grid = grid_point(at, scale)
    # close to a crossing of the grid the crossing has priority over a ray
    if start is not None and abs(at - start) * scale >= NEAR and abs(grid - at) * scale > 0.25 * CELL:
        step = round(math.degrees(cmath.phase(at - start)) / STEP_DEG) * STEP_DEG
        ray = cmath.rect(1.0, math.radians(step))
        on = start + ray * ((at - start) * ray.conjugate()).real
        if abs(on - at) * scale <= TURN:
            return _on_ray(lines, start, ray, on, scale, f"{typed(step % 360.0)}°")
    return _on_line(lines, grid, scale) or Snap(grid, GRID)


def _on_line(lines: Sequence[_Line], at: complex, scale: float, start: complex | None = None) -> Snap | None:
    """Snap to the nearest line of a link: to its crossing with another, to the foot of the perpendicular, or to the line."""
    near = [(abs(at - nearest_on_segment(at, first, second)), first, second, n) for first, second, n in lines]
    near = sorted((row for row in near if row[0] * scale <= ALONG), key=lambda row: row[0])
    if not near:
        return None
    _, first, second, number = near[0]
    for _, *other, _ in near[1:]:
        cross = crossing(first, second - first, *other)
        if cross is not None and cross not in (first, second) and abs(cross - at) * scale <= NEAR:
            return Snap(cross, LINE, "crossing", link=number)
    if start is not None:
        foot = nearest_on_segment(start, first, second)
        if abs(foot - at) * scale <= NEAR and foot not in (first, second, start):
            return Snap(foot, PERPENDICULAR, "perpendicular", link=number)
    return Snap(nearest_on_segment(at, first, second), LINE, link=number)


def _on_ray(lines: Sequence[_Line], start: complex, ray: complex, on: complex, scale: float, text: str) -> Snap:
    """Snap to a ray: where it crosses the line of a link, else at a length of whole cells of the grid."""
    end = start + ray * abs(grid_point(complex(abs(on - start), 0.0), scale))
    for first, second, number in lines:
        cross = crossing(start, ray, first, second)
        if cross is not None and abs(cross - end) * scale <= NEAR and cross != start:
            return Snap(cross, LINE, text, link=number)
    return _on_line(lines, end, scale) or Snap(complex(round(end.real, 9), round(end.imag, 9)), ANGLE, text)


# -- painting ------------------------------------------------------------------------------------------


def paint_grid(painter: QPainter, to: PixelFunction, scale: float, visible: QRectF) -> None:
    """Paint the grid over the visible region [mm], every fifth line stronger, and the axes."""
    step = grid_step(scale)
    if max(visible.width(), visible.height()) / step > MOST_LINES:
        return
    lines: dict[str, list[QLineF]] = {SCREEN.hair: [], SCREEN.dwell: [], SCREEN.line: []}
    origin, pitch = to(0j), step * scale
    left, right = origin.x() + visible.left() * scale, origin.x() + visible.right() * scale
    low, high = origin.y() - visible.top() * scale, origin.y() - visible.bottom() * scale
    for i in range(math.floor(visible.left() / step), math.ceil(visible.right() / step) + 1):
        x = origin.x() + i * pitch
        lines[_grid_colour(i)].append(QLineF(x, low, x, high))
    for i in range(math.floor(visible.top() / step), math.ceil(visible.bottom() / step) + 1):
        y = origin.y() - i * pitch
        lines[_grid_colour(i)].append(QLineF(left, y, right, y))
    for colour, rows in lines.items():
        painter.setPen(QPen(QColor(colour), 1.0))
        painter.drawLines(rows)


def _grid_colour(number: int) -> str:
    return SCREEN.line if not number else SCREEN.dwell if number % 5 == 0 else SCREEN.hair


def paint_snap(painter: QPainter, to: PixelFunction, snap: Snap, start: complex | None = None) -> None:
    """Paint the mark of a snap, and the line from ``start`` to it."""
    colour = QColor(SCREEN.chosen)
    pixel = to(snap.at)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if start is not None:
        painter.setPen(QPen(colour, 1.4, Qt.PenStyle.DashLine))
        painter.drawLine(to(start), pixel)
    painter.setPen(QPen(colour, 2.0))
    x, y = pixel.x(), pixel.y()
    if snap.mark == POINT:
        painter.drawEllipse(pixel, 8.0, 8.0)
    elif snap.mark == LINE:
        painter.drawLine(QPointF(x - 6, y - 6), QPointF(x + 6, y + 6))
        painter.drawLine(QPointF(x - 6, y + 6), QPointF(x + 6, y - 6))
    elif snap.mark == PERPENDICULAR:
        painter.drawPolyline(QPolygonF([QPointF(x - 9, y - 9), QPointF(x - 9, y), QPointF(x, y)]))
        painter.drawRect(QRectF(x - 9, y - 9, 9, 9))
    elif snap.mark == ANGLE:
        painter.drawEllipse(pixel, 3.0, 3.0)
    elif snap.mark == GRID:
        painter.drawLine(QPointF(x - 5, y), QPointF(x + 5, y))
        painter.drawLine(QPointF(x, y - 5), QPointF(x, y + 5))
    parts = [snap.label] if snap.label else []
    if start is not None and snap.at != start:
        direction = snap.at - start
        length = with_unit(short(abs(direction) / size_of("mm")), symbol_of("mm"))
        parts.insert(0, f"{length}, {short(math.degrees(cmath.phase(direction)))}°")
    elif snap.mark == GRID:
        parts.append(f"{number_text(snap.at.real, MM)}, {number_text(snap.at.imag, MM)}")
    if parts:
        above = 24.0 if snap.point else 10.0  # clear of the name of the pin
        painter.drawText(QPointF(x + 12.0, y - above), "  ".join(parts))
