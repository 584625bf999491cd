"""Painting of the linkage as drawn, also of an incomplete one: links, pins, guides, loads and lengths, in pixels."""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import field
from itertools import combinations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QPainter, QPainterPath, QPen, QPolygonF

from core.design import Design
from core.design.linkage import FRAME_LINK, Link, Linkage
from core.design.topology import driver_turns, input_slides
from core.frozen import frozen
from core.mechanism.drawing_targets import edges, faces_at, outline
from core.mechanism.drawn import PointPositions, edges_of, frame_link, input_pin, link_pose, slider_line
from core.mechanism.drivers import wheel_pairs
from core.output.drawing.palette import BLUE, VERMILION
from kindyna_gui.linkage.draw_tools import row_index
from kindyna_gui.linkage.snapping import FACE, PixelFunction
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import number, short

BAR, PIN, BLOCK = 5.0, 4.0, (15.0, 10.0)  # half width of a bar, radius of a pin, half sides of a block, pixels
FORCE = 46.0  # length of the arrow of a force, pixels
PER = {(True, False): "mm/°", (False, True): "°/mm"}  # unit of a ratio by (link slides, driver slides); else ": 1"


@frozen
class Highlights:
    """Parts to highlight: selected points, links and row of the loads, wrong points and links, locked parts."""

    points: Collection[str] = ()
    links: Collection[int] = ()
    row: str = ""
    wrong_points: Collection[str] = ()
    wrong_links: Collection[int] = ()
    locked: Collection[str] = ()


@frozen(eq=False)
class LinkageSketch:
    """Drawing of a design with given positions of its points, at ``scale`` pixels per mm; ``to`` maps mm to pixels.

    ``lengths`` receives the rectangles of the painted lengths, by link and points.
    """

    design: Design
    positions: PointPositions
    to: PixelFunction
    scale: float
    lengths: dict[tuple[int, str, str], QRectF] = field(default_factory=dict)

    @property
    def linkage(self) -> Linkage:
        """The linkage of the design."""
        linkage: Linkage = self.design.drive.linkage
        return linkage

    # -- parts by position --------------------------------------------------------------------------------------

    def block(self, link: Link) -> QPainterPath:
        """Outline of the block of a sliding link, in pixels; empty if the link does not slide."""
        path = QPainterPath()
        slider = next((s for s in self.linkage.sliders if s.link == link.number), None)
        at = next((self.positions[name] for name in link.places if name in self.positions), None)
        if slider is None or at is None or slider.on not in self.linkage.by_number:
            return path
        _, along = slider_line(self.linkage, slider, self.positions)
        across = 1j * along
        corners = [
            (a * BLOCK[0] * along + b * BLOCK[1] * across) / self.scale for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
        ]
        path.addPolygon(QPolygonF([self.to(at + corner) for corner in (*corners, corners[0])]))
        return path

    def load_positions(self) -> Mapping[str, complex]:
        """Row of the loads, or of second inputs -> position of its symbol [mm]."""
        positions: dict[str, complex] = {}
        loads = self.design.drive.loads
        for i, mass in enumerate(loads.masses):
            if mass.link in self.linkage.by_number:
                origin, axis = link_pose(self.linkage, mass.link, self.positions)
                positions[f"loads.masses[{i}]"] = origin + complex(mass.centre_x_mm, mass.centre_y_mm) * axis
        for i, force in enumerate(loads.forces):
            if force.point in self.positions:
                direction = complex(force.x_n, force.y_n)
                positions[f"loads.forces[{i}]"] = self.positions[force.point] - (
                    direction / abs(direction) * FORCE / self.scale if direction else 0j
                )
        for i, spring in enumerate(loads.springs):
            first, second = (self._end(end) for end in (spring.from_, spring.to))
            if first is not None and second is not None:
                positions[f"loads.springs[{i}]"] = 0.5 * (first + second)
        for i, driver in enumerate(self.linkage.drivers):
            if (pin := input_pin(self.linkage, driver)) in self.positions:
                positions[f"linkage.drivers[{i}]"] = self.positions[pin] + (-24.0 + 20.0j) / self.scale
        return positions

    def _end(self, end: object) -> complex | None:
        point, link = getattr(end, "point", None), getattr(end, "link", 0)
        if point is not None:
            return self.positions.get(point)
        if link not in self.linkage.by_number:
            return None
        origin, axis = link_pose(self.linkage, link, self.positions)
        return origin + complex(getattr(end, "x_mm", 0.0) or 0.0, getattr(end, "y_mm", 0.0) or 0.0) * axis

    def link_at(self, pixel: QPointF) -> int | None:
        """Return the uppermost link under a pixel, or None."""
        for link in reversed(self.linkage.links):
            if link.number != FRAME_LINK and self.block(link).contains(pixel):
                return link.number
        return next(iter(faces_at(self.linkage, self.positions, self.from_pixel(pixel), FACE / self.scale)), None)

    def from_pixel(self, pixel: QPointF) -> complex:
        """Position [mm] at a pixel."""
        origin = self.to(0j)
        return complex(pixel.x() - origin.x(), origin.y() - pixel.y()) / self.scale

    def length_at(self, pixel: QPointF) -> tuple[int, str, str] | None:
        """Return the length whose number is under a pixel: its link and two points."""
        return next((key for key, rect in self.lengths.items() if rect.adjusted(-2, -2, 2, 2).contains(pixel)), None)

    def load_at(self, at: complex) -> str:
        """Return the row of the loads whose symbol is at a position; empty if there is none."""
        return next((row for row, point in self.load_positions().items() if abs(point - at) * self.scale <= 9.0), "")

    # -- painting -----------------------------------------------------------------------------------------------

    def paint(
        self, painter: QPainter, highlights: Highlights, dimensions: bool = True, grey: Collection[int] = frozenset()
    ) -> None:
        """Paint the drawing; the links in ``grey`` do not move."""
        self._paint_lines(painter)
        for link in self.linkage.links:
            if link.number == FRAME_LINK:
                continue
            fill = QColor(SCREEN.faint if link.number in grey else SCREEN.link(link.number))
            pen = _outline_pen(link.number in highlights.links, link.number in highlights.wrong_links)
            self._paint_face(painter, link, fill, pen)
            painter.setPen(pen)
            painter.setBrush(QBrush(fill))
            painter.drawPath(self.block(link))
        for name in frame_link(self.linkage).places:
            self._paint_pedestal(painter, self.to(self.positions[name]))
        link_counts = Counter(name for link in self.linkage.links for name in link.places)
        for name, at in self.positions.items():
            painter.setPen(_outline_pen(name in highlights.points, name in highlights.wrong_points))
            painter.setBrush(QBrush(QColor(SCREEN.paper if link_counts[name] > 1 else SCREEN.cam)))
            painter.drawEllipse(self.to(at), PIN, PIN)
            if name in highlights.locked:
                painter.drawText(self.to(at) + QPointF(-14.0, 4.0), "⚿")
        self._paint_wheels(painter)
        self._paint_driver(painter)
        self._paint_loads(painter, highlights.row)
        self._paint_names(painter)
        if dimensions:
            self._paint_lengths(painter, highlights)

    def _paint_face(self, painter: QPainter, link: Link, fill: QColor, pen: QPen) -> None:
        """Paint the bars between the corners and the area inside them, the outline before the fill."""
        corners = outline(link, self.positions)
        for shade, wide in ((pen.color(), 2.0 * (BAR + pen.widthF())), (fill, 2.0 * BAR)):
            painter.setPen(QPen(shade, wide, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            for first, second in edges(corners):
                painter.drawLine(self.to(first), self.to(second))
        if len(corners) > 2:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QBrush(fill))
            painter.drawPolygon(QPolygonF([self.to(at) for at in corners]))

    def _paint_lines(self, painter: QPainter) -> None:
        """Paint the guides of blocks dash-dotted, hatched on the frame."""
        for slider in self.linkage.sliders:
            if slider.on not in self.linkage.by_number or slider.link not in self.linkage.by_number:
                continue
            through, along = slider_line(self.linkage, slider, self.positions)
            block = next(
                (self.positions[n] for n in self.linkage.by_number[slider.link].places if n in self.positions), through
            )
            reach = (abs(block - through) + 60.0 / self.scale) if slider.on == FRAME_LINK else 60.0 / self.scale
            middle = 0.5 * (block + through) if slider.on == FRAME_LINK else block
            painter.setPen(_dash_dotted_pen(1.0))
            painter.drawLine(self.to(middle - along * reach), self.to(middle + along * reach))
            if slider.on == FRAME_LINK:
                painter.setPen(QPen(QColor(SCREEN.quiet), 1.0))
                below = -1j * along * (BLOCK[1] + 2.0) / self.scale
                for i in range(-4, 5):
                    start = block + below + along * (i * 7.0 / self.scale)
                    painter.drawLine(self.to(start), self.to(start + (-1j - 0.6) * along * 6.0 / self.scale))
                painter.drawLine(
                    self.to(block + below - along * 32.0 / self.scale),
                    self.to(block + below + along * 32.0 / self.scale),
                )

    def _paint_pedestal(self, painter: QPainter, at: QPointF) -> None:
        painter.setPen(QPen(QColor(SCREEN.ink), 1.3))
        painter.setBrush(QBrush(QColor(SCREEN.paper)))
        x, y = at.x(), at.y()
        painter.drawPolygon(QPolygonF([at, QPointF(x - 8.0, y + 14.0), QPointF(x + 8.0, y + 14.0)]))
        painter.drawLine(QPointF(x - 13.0, y + 14.0), QPointF(x + 13.0, y + 14.0))
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0))
        for i in range(6):
            painter.drawLine(QPointF(x - 11.0 + 4.6 * i, y + 14.0), QPointF(x - 14.5 + 4.6 * i, y + 19.0))

    def _paint_driver(self, painter: QPainter) -> None:
        """Paint an arrow around the pivot of the driving link, or along its guide."""
        link = self.linkage.by_number.get(self.linkage.driver.link)
        if link is None or link.number == FRAME_LINK or self.linkage.drawn is None:
            return
        painter.setPen(QPen(QColor(SCREEN.seen(BLUE)), 2.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        pivot = next((name for name in link.places if name in frame_link(self.linkage).places), None)
        rotation_sign = -1.0 if self.linkage.driver.speed_rpm < 0.0 else 1.0
        if pivot is not None and self.linkage.drawn.driver_deg is not None:
            centre = self.to(self.positions[pivot])
            angle = self.linkage.drawn.driver_deg
            painter.drawArc(QRectF(centre.x() - 17, centre.y() - 17, 34, 34), round(16 * (angle - 35)), 16 * 70)
            end = math.radians(angle + 35.0 * rotation_sign)
            self._arrow_tip(
                painter,
                centre + QPointF(17.0 * math.cos(end), -17.0 * math.sin(end)),
                cmath.exp(1j * end) * 1j * rotation_sign,
            )
        elif self.linkage.drawn.driver_mm is not None:
            slider = next((s for s in self.linkage.sliders if s.link == link.number), None)
            at = next((self.positions[name] for name in link.places if name in self.positions), None)
            if slider is not None and at is not None:
                _, along = slider_line(self.linkage, slider, self.positions)
                tip = self.to(at + along * 34.0 / self.scale)
                painter.drawLine(self.to(at), tip)
                self._arrow_tip(painter, tip, along)

    def _arrow_tip(self, painter: QPainter, tip: QPointF, direction: complex) -> None:
        painter.save()
        painter.setBrush(QBrush(painter.pen().color()))
        back = [tip + QPointF((w * direction).real, -(w * direction).imag) for w in (-8.0 + 3.5j, -8.0 - 3.5j)]
        painter.drawPolygon(QPolygonF([tip, *back]))
        painter.restore()

    def _paint_loads(self, painter: QPainter, chosen: str) -> None:
        positions = self.load_positions()
        loads = self.design.drive.loads
        for row, at in positions.items():
            pixel, ink = self.to(at), QColor(SCREEN.chosen if row == chosen else SCREEN.ink)
            painter.setPen(QPen(ink, 2.0 if row == chosen else 1.2))
            if ".masses" in row:
                rect = QRectF(pixel.x() - 7, pixel.y() - 7, 14, 14)
                painter.setBrush(QBrush(QColor(SCREEN.paper)))
                painter.drawEllipse(rect)
                painter.setBrush(QBrush(ink))
                painter.drawPie(rect, 0, 16 * 90)
                painter.drawPie(rect, 16 * 180, 16 * 90)
            elif ".drivers" in row:
                self._paint_input(painter, pixel, row_index(row), row == chosen)
            elif ".forces" in row:
                force = loads.forces[row_index(row)]
                tip = self.to(self.positions[force.point])
                painter.setPen(QPen(QColor(SCREEN.chosen if row == chosen else SCREEN.seen(VERMILION)), 2.2))
                direction = complex(force.x_n, force.y_n)
                painter.drawLine(pixel, tip)
                if direction:
                    self._arrow_tip(painter, tip, direction / abs(direction))
            else:
                spring = loads.springs[row_index(row)]
                first, second = (self._end(end) for end in (spring.from_, spring.to))
                assert first is not None
                assert second is not None
                self._paint_spring(painter, first, second)

    def _paint_input(self, painter: QPainter, pixel: QPointF, index: int, chosen: bool) -> None:
        """Paint the ratio of a second input next to its pin, with an arc around the pin."""
        second = self.linkage.drivers[index]
        pin = self.to(self.positions[input_pin(self.linkage, second)])
        painter.setPen(QPen(QColor(SCREEN.chosen if chosen else SCREEN.seen(BLUE)), 2.4 if chosen else 1.6))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawArc(QRectF(pin.x() - 13, pin.y() - 13, 26, 26), 16 * 70, 16 * 130)
        ratio = self.linkage.ratios.get(second.link)
        unit = PER.get((input_slides(self.linkage, second), not driver_turns(self.linkage)), ": 1")
        text = second.motion or ("ratio?" if ratio is None else f"{short(ratio)} {unit}")
        rect = QRectF(pixel.x() - 92.0, pixel.y() - 9.0, 100.0, 18.0)
        painter.drawText(rect, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, text)

    def _paint_wheels(self, painter: QPainter) -> None:
        """Paint the pitch circles of second inputs with wheels, dash-dotted."""
        painter.setPen(_dash_dotted_pen(1.2))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for pair in wheel_pairs(self.linkage) if self.linkage.drivers else ():
            if pair.along and pair.first.point in self.positions:
                along = pair.along * link_pose(self.linkage, pair.carrier, self.positions)[1]
                at = self.positions[pair.first.point] - 1j * along * pair.first.radius
                painter.drawLine(*(self.to(at + s * along * pair.first.radius) for s in (-1.5, 1.5)))
            for wheel in pair.circles:
                if wheel.point in self.positions:
                    painter.drawEllipse(self.to(self.positions[wheel.point]), *[wheel.radius * self.scale] * 2)

    def _paint_spring(self, painter: QPainter, first: complex, second: complex) -> None:
        direction = second - first
        across = 1j * direction / abs(direction) * 6.0 / self.scale if direction else 0j
        coils = 9
        line = [first, first + 0.15 * direction]
        line += [
            first + direction * (0.15 + 0.7 * (i + 0.5) / coils) + across * (1 if i % 2 else -1) for i in range(coils)
        ]
        line += [first + 0.85 * direction, second]
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolyline(QPolygonF([self.to(at) for at in line]))

    def _paint_names(self, painter: QPainter) -> None:
        painter.setPen(QColor(SCREEN.ink))
        fixed = frame_link(self.linkage).places
        away_of = dict.fromkeys(self.positions, 0j)  # sum of the directions from the other points of its links
        for link in self.linkage.links:
            ends = [(p.name, self.positions[p.name]) for p in link.points if p.name in self.positions]
            for (first, a), (second, b) in combinations(ends if link.number != FRAME_LINK else (), 2):
                if a != b:
                    away_of[first] += (a - b) / abs(a - b)
                    away_of[second] += (b - a) / abs(a - b)
        for name, at in self.positions.items():
            away = away_of[name]
            direction = away / abs(away) if abs(away) > 0.3 and name not in fixed else complex(1.0, 0.6)
            pixel = self.to(at) + QPointF(13.0 * direction.real - 4.0, -13.0 * direction.imag + 4.0)
            painter.drawText(pixel, name)

    def _paint_lengths(self, painter: QPainter, highlights: Highlights) -> None:
        """Paint the length next to every bar, and the lengths of the sides of a selected plate."""
        self.lengths.clear()
        painter.save()
        font = QFont(painter.font())
        font.setPointSizeF(max(7.0, font.pointSizeF() - 1.0))
        painter.setFont(font)
        for link in self.linkage.links:
            if link.number == FRAME_LINK or (len(link.points) > 2 and link.number not in highlights.links):
                continue
            for first, second in edges_of(link):
                if first not in self.positions or second not in self.positions:
                    continue
                value = abs(link.places[second] - link.places[first])
                text = number(value, 2).rstrip("0").rstrip(".")
                a, b = self.positions[first], self.positions[second]
                if abs(b - a) * self.scale < 34.0:
                    continue
                across = 1j * (b - a) / abs(b - a)
                across = across if across.imag >= 0.0 else -across
                wide = painter.fontMetrics().horizontalAdvance(text) + 6.0
                high = painter.fontMetrics().height()
                offset = BAR + 3.0 + 0.5 * (wide * abs(across.real) + high * abs(across.imag))
                at = self.to(0.5 * (a + b) + across * offset / self.scale)
                rect = QRectF(at.x() - wide / 2.0, at.y() - high / 2.0, wide, high)
                self.lengths[(link.number, first, second)] = rect
                locked = f"{link.number}:{first}:{second}" in highlights.locked
                painter.setPen(QColor(SCREEN.chosen if locked else SCREEN.quiet))
                painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, f"[{text}]" if locked else text)
        painter.restore()

    def paint_path(self, painter: QPainter, path: np.ndarray, is_driven: bool) -> None:
        """Paint the path of a point (n,) [mm], dotted where the driver does not determine it."""
        style = Qt.PenStyle.SolidLine if is_driven else Qt.PenStyle.DotLine
        painter.setPen(QPen(QColor(SCREEN.seen(BLUE)), 1.4, style))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolyline(QPolygonF([self.to(complex(at)) for at in np.append(path, path[:1]) if np.isfinite(at)]))


def _outline_pen(is_selected: bool, is_wrong: bool) -> QPen:
    colour = SCREEN.chosen if is_selected else SCREEN.limit if is_wrong else SCREEN.ink
    return QPen(QColor(colour), 2.4 if is_selected or is_wrong else 1.4)


def _dash_dotted_pen(width: float) -> QPen:
    pen = QPen(QColor(SCREEN.quiet), width)
    pen.setDashPattern([10.0, 4.0, 2.0, 4.0])
    return pen
