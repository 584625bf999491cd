"""Obstacles of optimal laws in the displacement diagram: hatched fields whose edges the mouse drags."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter

from core.design import CurveBound, Motion, OptimalCurve, join_angles, join_levels
from core.frozen import frozen
from core.number_text import shortest
from kindyna_gui.motion.diagram import FINE, LINE_REACH, DiagramScale, snap
from kindyna_gui.pictures.style import SCREEN, Theme

START, END, RISE = "start", "end", "rise"
SHARE = 0.005  # step of a dragged start or end, as a fraction of the span
NAMES = {START: "from", END: "to", RISE: "rise"}


@frozen
class Obstacle:
    """Obstacle of the law of a segment.

    Attributes
    ----------
    segment : number of the segment
    key : ``below`` or ``above``, the side on which the law passes
    number : number in its list
    """

    segment: int
    key: str
    number: int

    def path(self, edge: str) -> str:
        """Path of the number that an edge changes."""
        return f"motion.segments[{self.segment}].{self.key}[{self.number}].{edge}"


@frozen
class ObstacleEdge:
    """Edge of an obstacle that can be dragged: START, END, or RISE, the level that the law keeps."""

    obstacle: Obstacle
    edge: str

    @property
    def path(self) -> str:
        """Path of the number that it changes."""
        return self.obstacle.path(self.edge)

    @property
    def is_level(self) -> bool:
        """Whether it is the level, which moves up and down; the others move along the angle."""
        return self.edge == RISE

    @property
    def name(self) -> str:
        """Name within the name of an undo step."""
        obstacle = self.obstacle
        return f"{NAMES[self.edge]} of obstacle {obstacle.key} {obstacle.number + 1} of segment {obstacle.segment + 1}"


def obstacle_fields(motion: Motion, scale: DiagramScale) -> Iterator[tuple[Obstacle, QRectF, float]]:
    """Yield each obstacle, its field [pixels], from the level that the law keeps to the edge of the diagram, and that level."""
    for i, (begin, level, segment) in enumerate(
        zip(join_angles(motion), join_levels(motion), motion.segments, strict=True)
    ):
        for key in ("below", "above") if isinstance(segment.curve, OptimalCurve) else ():
            bounds: tuple[CurveBound, ...] = getattr(segment.curve, key)
            for number, bound in enumerate(bounds):
                left, right = (scale.x(begin + part * segment.span_deg) for part in (bound.start, bound.end))
                y = min(max(scale.y(level + bound.rise * segment.rise), scale.top), scale.bottom)
                is_upper = (key == "below") == (segment.rise > 0.0)
                top, bottom = (scale.top, y) if is_upper else (y, scale.bottom)
                yield Obstacle(i, key, number), QRectF(left, top, right - left, bottom - top), y


def edge_at(motion: Motion, scale: DiagramScale, x: float, y: float) -> ObstacleEdge | None:
    """Find the edge of an obstacle under the mouse; edges at the ends of the segment belong to its joins."""
    for obstacle, field, level in obstacle_fields(motion, scale):
        segment = motion.segments[obstacle.segment]
        bound = getattr(segment.curve, obstacle.key)[obstacle.number]
        if field.left() <= x <= field.right() and abs(y - level) <= LINE_REACH:
            return ObstacleEdge(obstacle, RISE)
        for edge, part, at in ((START, bound.start, field.left()), (END, bound.end, field.right())):
            if 0.0 < part < 1.0 and abs(x - at) <= LINE_REACH and field.top() <= y <= field.bottom():
                return ObstacleEdge(obstacle, edge)
    return None


def edge_value(motion: Motion, edge: ObstacleEdge, scale: DiagramScale, x: float, y: float, fine: bool) -> float:
    """Fraction of the span or of the rise for an edge at a position of the mouse [pixels]."""
    index = edge.obstacle.segment
    segment, factor = motion.segments[index], FINE if fine else 1.0
    if edge.edge != RISE:
        part = (scale.angle(x) - join_angles(motion)[index]) / segment.span_deg
        return min(max(snap(part, SHARE * factor), 0.0), 1.0)
    level = scale.low + (scale.bottom - y) / (scale.bottom - scale.top) * (scale.high - scale.low)
    level = snap(level, scale.level_step * factor)
    return round((level - join_levels(motion)[index]) / segment.rise, 6)


def edge_text(edge: ObstacleEdge, value: float) -> str:
    """Name of the undo step that moves an edge."""
    return f"Move {edge.name} to {shortest(value)}"


def paint_obstacles(
    painter: QPainter, motion: Motion, scale: DiagramScale, theme: Theme, active: ObstacleEdge | None
) -> None:
    """Paint each obstacle as a hatched field, with the level that the law keeps as a line."""
    for obstacle, field, level in obstacle_fields(motion, scale):
        is_active = active is not None and active.obstacle == obstacle
        colour = SCREEN.chosen if is_active else SCREEN.limit
        painter.fillRect(field, QBrush(QColor(colour), Qt.BrushStyle.BDiagPattern))
        painter.setPen(theme.pen(colour, 2.0 if is_active and active is not None and active.edge == RISE else 1.0))
        painter.drawLine(QPointF(field.left(), level), QPointF(field.right(), level))
        for edge, x in ((START, field.left()), (END, field.right())):
            is_edge = is_active and active is not None and active.edge == edge
            painter.setPen(theme.pen(colour, 2.0 if is_edge else 1.0))
            painter.drawLine(QPointF(x, field.top()), QPointF(x, field.bottom()))
