"""Where the rows of the loads stand in the drawing: which of them a click means, and what marks the chosen one."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen
from PySide6.QtWidgets import QGraphicsPathItem

from core.design import HOLDS, get, load_lists
from core.dynamics import Torsion, element_at, row_of_element
from core.errors import NoSolution
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.picking import foot, places_now
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.spring_parts import spirals
from kindyna_gui.pictures.style import SCREEN

SYMBOLS = frozenset({"spring", "damper", "load", "torque"})
"""What the keys of the drawing's parts begin with that show a row of the loads."""
REACH = 9.0  # pixels from a row within which it is meant
RING = 9.0  # radius of the mark of the chosen one, pixels
BETWEEN = 6.0  # width of its line between two ends, pixels


def row_places(geometry: Geometry, path: str, index: int) -> list[complex]:
    """Where a row of the loads stands at a sample [mm]: one place, or its two ends; none where it cannot be said."""
    design = geometry.study.design
    found: list[complex] = []
    try:
        row = get(design, path)
        element = element_at(geometry.study.loading, path)
        if isinstance(element, Torsion):
            return [complex(track[index]) for track in spirals(element, geometry)]
        for hold in HOLDS[path.partition(".")[2].partition("[")[0]]:
            held = hold.read(row)
            found += [_output(geometry, index)] if held is None else list(places_now(geometry, held, index))[:1]
    except (KeyError, NoSolution):
        return []
    return found


def _output(geometry: Geometry, index: int) -> complex:
    """The point of the output that its motion moves."""
    kinematics = geometry.kinematics
    return complex(kinematics.bodies[kinematics.output].position(kinematics.driver_pair.point)[index]) * MM


def row_paths(geometry: Geometry) -> Iterator[str]:
    """The rows of the loads by their paths."""
    drive = geometry.study.design.drive
    for name in load_lists(drive):
        yield from (f"loads.{name}[{i}]" for i in range(len(getattr(drive.loads, name))))


def rows_at(canvas: Canvas, at: complex) -> list[str]:
    """The rows of the loads under a place [mm], the nearest first."""
    geometry = canvas.drawn.geometry
    if geometry is None:
        return []
    near = []
    for i, path in enumerate(row_paths(geometry)):
        places = row_places(geometry, path, canvas.drawn.index)
        if places:
            distance = abs(at - foot(at, places[0], places[-1])) * canvas.scale_now
            near.append((distance, i, path))
    found = [path for distance, _, path in sorted(near) if distance <= REACH]
    return list(dict.fromkeys((*found, *_drawn_at(canvas, at))))


def _drawn_at(canvas: Canvas, at: complex) -> Iterator[str]:
    """The rows whose symbols are drawn at a place [mm]; empty for the loads that have no row."""
    reach = REACH / canvas.scale_now
    under = QRectF(at.real - reach, at.imag - reach, 2.0 * reach, 2.0 * reach)
    scene = canvas.drawn
    for key, part in scene.parts.items() if isinstance(scene, MechanismScene) else ():
        what, _, name = key.partition(".")
        item = part.item
        drawn = what in SYMBOLS and isinstance(item, QGraphicsPathItem) and item.isVisible() and item.opacity() > 0.0
        if drawn and item.mapToScene(item.path()).intersects(under):  # type: ignore[attr-defined]
            yield row_of_element(name)


def next_row(rows: list[str], chosen: str) -> str:
    """Of the rows under the mouse the one that a further click means."""
    return rows[(rows.index(chosen) + 1) % len(rows)] if chosen in rows else rows[0]


def paint_row(canvas: Canvas, painter: QPainter, path: str) -> None:
    """Mark the chosen row; in pixels of the viewport."""
    geometry = canvas.drawn.geometry
    if geometry is None or not path:
        return
    pixels = [
        canvas.viewportTransform().map(QPointF(at.real, at.imag))
        for at in row_places(geometry, path, canvas.drawn.index)
    ]
    pale = QColor(SCREEN.chosen)
    pale.setAlpha(70)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    if len(pixels) > 1:
        painter.setPen(QPen(pale, BETWEEN, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(pixels[0], pixels[-1])
    painter.setPen(QPen(QColor(SCREEN.chosen), 1.6))
    for pixel in pixels:
        painter.drawEllipse(pixel, RING, RING)


__all__ = ["next_row", "paint_row", "row_paths", "row_places", "rows_at"]
