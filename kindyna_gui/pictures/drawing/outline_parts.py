"""Outlines of bodies, and the line between the two bodies that are nearest at the shown angle."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QPainterPath, QPainterPathStroker

from core.clearance import Shape
from core.design.outline_bodies import Body
from core.design.outlines import CAM, FRAME, ROLLER
from core.errors import KindynaError
from core.output.drawing.palette import VERMILION
from core.study.clearances import Clearances, NearestBodies
from kindyna_gui.pictures.drawing.geometry import MM, Geometry, OutlinedDrive
from kindyna_gui.pictures.drawing.parts import OUTLINE_LAYER as LAYER
from kindyna_gui.pictures.items import DrawnPart, Outline, Tag, riding
from kindyna_gui.pictures.shapes import segments
from kindyna_gui.pictures.style import OUTLINE, THIN, Theme, brush
from kindyna_gui.pictures.units import readable_text

Z_OUTLINE, Z_NEAREST = 2.0, 13.0
FILL = 0.14  # opacity: the mechanism carries the colour
NEAREST_ANGLES = 720  # at which the nearest bodies of a turn are computed


def outlines(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Outlines of the bodies of a drive and of the frame, and the nearest two of them, by the angle of the drive."""
    study, outlined = geometry.study, geometry.outlined or OutlinedDrive(geometry.study.clearances)
    clearances, number, machine_angle = outlined.clearances, outlined.number, outlined.position.machine_angle
    yield from body_outlines(clearances, number, geometry, theme)
    yield from frame_outlines(clearances, theme, outlined.is_mirrored)
    nearest = NearestPart(clearances, theme, number, outlined.is_mirrored)
    yield from nearest.parts(lambda i: float(machine_angle(study.theta[i])))


def body_outlines(clearances: Clearances, number: int, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Outlines of the bodies of a drive in its own frame; circles of rollers and profiles of cams are drawn anyway."""
    mirrored = clearances.design.drives[number].mirrored
    for body in clearances.names:
        if body.drive != number or body.name == ROLLER or (body.name == CAM and not _has_corners(clearances, body)):
            continue
        shape = _shape(clearances, body)
        if shape is None:
            continue
        item = Outline(path_of(shape.reflected() if mirrored else shape), theme.pen(theme.quiet, THIN), _fill(theme))
        if body.name == CAM:
            turn = np.exp(1j * geometry.rotation_sign * geometry.study.theta)
            move = riding(item, np.zeros(turn.size, dtype=complex), turn)
        else:
            moving = geometry.bodies[body.name]
            move = riding(item, moving.z, np.broadcast_to(moving.turn, moving.z.shape))
        yield DrawnPart(f"outline.{body.name}", item, LAYER, Z_OUTLINE, move)


def frame_outlines(clearances: Clearances, theme: Theme, is_mirrored: bool = False) -> Iterator[DrawnPart]:
    """Outlines of the frame; mirrored as a mirrored drive sees them."""
    body = Body(None, FRAME)
    shape = _shape(clearances, body) if body in clearances.names else None
    if shape is not None:
        path = path_of(shape.reflected() if is_mirrored else shape)
        yield DrawnPart("outline.frame", Outline(path, theme.pen(theme.quiet, THIN), _fill(theme)), LAYER, 0.2)


def _fill(theme: Theme) -> QBrush:
    return brush(theme.quiet, FILL)


def _has_corners(clearances: Clearances, body: Body) -> bool:
    return any(row.points or row.file for row in clearances.outlines[body])


def _shape(clearances: Clearances, body: Body) -> Shape | None:
    """Shape of a body in the plane of the mechanism; None where it has none, or a drawing cannot be read."""
    if all(row.plane is not None for row in clearances.outlines[body]):
        return None
    try:
        return clearances.shape(body, None)
    except KindynaError:  # the findings report it
        return None


def path_of(shape: Shape) -> QPainterPath:
    """Grown outlines of a shape [mm]."""
    path = QPainterPath()
    for number in range(len(shape.encloses)):
        points = shape.curve(number) * MM
        growth = float(shape.growth[shape.outline == number][0]) * MM
        outline = QPainterPath()
        outline.moveTo(points[0].real, points[0].imag)
        for point in points[1:].tolist():
            outline.lineTo(point.real, point.imag)
        if shape.encloses[number]:
            outline.closeSubpath()
        if growth > 0.0:
            outline = _grown(outline, points, growth)
        path.addPath(outline)
    return path


def _grown(outline: QPainterPath, points: np.ndarray, growth: float) -> QPainterPath:
    """Outline with everything that is nearer to it than the growth [mm]."""
    if np.ptp(points.real) == 0.0 and np.ptp(points.imag) == 0.0:
        circle, centre = QPainterPath(), complex(points[0])
        circle.addEllipse(centre.real - growth, centre.imag - growth, 2.0 * growth, 2.0 * growth)
        return circle
    stroker = QPainterPathStroker()
    stroker.setWidth(2.0 * growth)
    stroker.setCapStyle(Qt.PenCapStyle.RoundCap)
    stroker.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    stroker.setCurveThreshold(0.05)
    return stroker.createStroke(outline).united(outline).simplified()


class NearestPart:
    """Line between the two nearest bodies, with their distance, red where they meet or are nearer than they must be.

    ``drive`` is the number of the drive whose bodies it connects with each other and with the frame; None: all bodies.
    """

    def __init__(
        self, clearances: Clearances, theme: Theme, drive: int | None = None, is_mirrored: bool = False
    ) -> None:
        self._clearances, self._theme = clearances, theme
        self._drive, self._is_mirrored = drive, is_mirrored
        self._nearest: NearestBodies | None = None
        self._failed = False
        self.line = Outline(QPainterPath(), theme.pen(theme.ink, OUTLINE))
        self.tag = Tag("", theme.ink, theme, lean=(0.5, 1.2), backing=True)

    def parts(self, angle_at: Callable[[int], float]) -> Iterator[DrawnPart]:
        """Line and text; angle_at: index of a sample -> angle of the turn [rad]."""
        yield DrawnPart("nearest.line", self.line, LAYER, Z_NEAREST, lambda i: self.move(angle_at(i)))
        yield DrawnPart("nearest.distance", self.tag, LAYER, Z_NEAREST + 0.1, lambda i: None)

    def move(self, theta: float) -> None:
        """Show the nearest bodies at an angle of the turn [rad]."""
        nearest = self._computed()
        if nearest is None or not nearest.pairs:
            self.line.redraw(QPainterPath())
            self.tag.set_text("")
            return
        i = round(theta / (2.0 * np.pi) * NEAREST_ANGLES) % NEAREST_ANGLES
        p, q = (complex(point[i]) * MM for point in (nearest.first, nearest.second))
        p, q = (-p.conjugate(), -q.conjugate()) if self._is_mirrored else (p, q)
        distance = float(nearest.distance[i]) * MM
        pair = nearest.pairs[int(nearest.number[i])]
        least = self._clearances.required(pair)
        colour = self._theme.seen(VERMILION) if distance == 0.0 or distance < least else self._theme.ink
        self.line.setPen(self._theme.pen(colour, OUTLINE))
        self.line.redraw(segments([(p, q)]))
        names = " – ".join(self._clearances.texts(pair))
        self.tag.set_text(f"{names}: {readable_text(distance, 'mm', 4)}" if distance else f"{names} meet")
        self.tag.set_colour(colour)
        middle = 0.5 * (p + q)
        self.tag.setPos(middle.real, middle.imag)

    def _computed(self) -> NearestBodies | None:
        """The nearest bodies over the turn, computed when they are first shown."""
        if self._nearest is None and not self._failed:
            try:
                angles = self._clearances.angles(np.linspace(0.0, 2.0 * np.pi, NEAREST_ANGLES, endpoint=False))
                self._nearest = self._clearances.nearest_of_all(angles, self._drive)
            except KindynaError:  # the findings report it
                self._failed = True
        return self._nearest
