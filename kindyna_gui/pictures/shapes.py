"""Symbols of mechanisms as paths: links, plates, levers, pivots, bearings, hatching, arrows.

Lengths are in mm, y upwards; ``unit`` is the size of symbols [mm]. Symbols are built at a size of a few units and then
scaled, so that mechanisms of micrometres and of kilometres look alike. Bodies consist of overlapping pieces: merging
their outlines would take longer than the rest of a drawing, and would replace their arcs by straight lines.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize
from PySide6.QtGui import QPainterPath, QPolygonF, QTransform
from shiboken6 import VoidPtr

PIN, EYE, HUB = 0.6, 1.15, 1.45  # radii of a pin, of the eye around it, of a lever's hub, in units
BAR, WEB = 0.62, 7.0  # half the width of a bar, reach of a lever's web, in units
HATCH = 0.75  # distance of hatching lines, in units
CACHE_SIZE = 64  # symbols of each kind; most edits change few of them


def at(point: complex) -> QPointF:
    """Point of the complex plane as Qt's type."""
    return QPointF(point.real, point.imag)


def scaled(path: QPainterPath, unit: float, position: complex = 0j, turn: complex = 1 + 0j) -> QPainterPath:
    """Scale a symbol from units to mm, rotate it by a unit vector, and move it to its position [mm]."""
    a, b = unit * turn.real, unit * turn.imag
    return QTransform(a, b, -b, a, position.real, position.imag).map(path)


def polyline(points: Iterable[complex], closed: bool = False) -> QPainterPath:
    """Straight lines from point to point."""
    polygon = QPolygonF([at(p) for p in points])
    path = QPainterPath()
    path.addPolygon(polygon)
    if closed:
        path.closeSubpath()
    return path


def circle(radius: float, centre: complex = 0j) -> QPainterPath:
    """Circle about a centre."""
    path = QPainterPath()
    path.addEllipse(at(centre), radius, radius)
    return path


def outline(points: np.ndarray) -> QPainterPath:
    """Closed curve through points (n,) complex."""
    path = curve(points)
    path.closeSubpath()
    return path


def curve(points: np.ndarray) -> QPainterPath:
    """Open curve through points (n,) complex, copied as one block of memory, which saves milliseconds."""
    polygon = QPolygonF()
    polygon.resize(points.size)
    if points.size:
        memory: Any = VoidPtr(polygon.data(), 16 * points.size, True)  # type: ignore[arg-type, call-arg]
        np.frombuffer(memory, dtype=complex)[:] = points
    path = QPainterPath()
    path.addPolygon(polygon)
    return path


def keyed_bore(keyway: Sequence[complex]) -> QPainterPath:
    """Bore with a keyway: an arc from the last corner of the keyway to its first."""
    first, last = keyway[0], keyway[-1]
    span = float(np.mod(np.angle(first / last), 2.0 * np.pi))
    return outline(np.append(last * np.exp(1j * np.linspace(0.0, span, 360)), keyway[:-1]))


def joined(*paths: QPainterPath) -> QPainterPath:
    """Several paths as one path that keeps their outlines."""
    result = QPainterPath()
    for path in paths:
        result.addPath(path)
    return result


def fit_transform(points: np.ndarray, size: QSize, margin: float) -> QTransform:
    """Transform from mm, y upwards, to pixels that shows all points (n,) [mm] within a margin [pixels]."""
    low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
    extent, middle = high - low, 0.5 * (low + high)
    scale = min((size.width() - 2 * margin) / extent.real, (size.height() - 2 * margin) / extent.imag)
    to_centre = QTransform().translate(0.5 * size.width(), 0.5 * size.height())
    return to_centre.scale(scale, -scale).translate(-middle.real, -middle.imag)


def segments(lines: Iterable[tuple[complex, complex]]) -> QPainterPath:
    """Separate straight lines, (start, end)."""
    path = QPainterPath()
    for start, end in lines:
        path.moveTo(at(start))
        path.lineTo(at(end))
    return path


def bar(start: complex, end: complex, half_width: float) -> QPainterPath:
    """Bar with round ends."""
    length = abs(end - start)
    path = QPainterPath()
    path.addRoundedRect(
        QRectF(-half_width, -half_width, length + 2 * half_width, 2 * half_width), half_width, half_width
    )
    turn = (end - start) / length if length else 1 + 0j
    return scaled(path, 1.0, start, turn)


def _pieces(paths: Sequence[QPainterPath], unit: float, position: complex) -> tuple[QPainterPath, ...]:
    return tuple(scaled(path, unit, position) for path in paths)


@lru_cache(maxsize=CACHE_SIZE)
def lever(hub: complex, ends: tuple[complex, ...], unit: float) -> tuple[QPainterPath, ...]:
    """Pieces of a lever with several arms from one hub, stiffened by a web between neighbours."""
    local = sorted(((end - hub) / unit for end in ends), key=cmath.phase)
    paths = [circle(HUB)]
    for end in local:
        paths += [bar(0j, end, BAR), circle(EYE, end)]
    for end, neighbour in zip(local, local[1:] + local[:1], strict=True):
        if 0.0 < math.degrees(cmath.phase(neighbour / end)) < 170.0:
            reach = min(WEB, 0.4 * abs(end), 0.4 * abs(neighbour))
            web = [0j, reach * end / abs(end), reach * neighbour / abs(neighbour)]
            paths.append(polyline(web, closed=True))
    return _pieces(paths, unit, hub)


@lru_cache(maxsize=CACHE_SIZE)
def plate(corners: tuple[complex, ...], unit: float) -> tuple[QPainterPath, ...]:
    """Pieces of a plate with eyes at three or more points."""
    centre = sum(corners) / len(corners)
    local = sorted(((c - centre) / unit for c in corners), key=cmath.phase)
    paths = [polyline(local, closed=True)]
    for corner, neighbour in zip(local, local[1:] + local[:1], strict=True):
        paths += [bar(corner, neighbour, BAR), circle(EYE, corner)]
    return _pieces(paths, unit, centre)


@lru_cache(maxsize=CACHE_SIZE)
def link(ends: tuple[complex, ...], unit: float) -> tuple[QPainterPath, ...]:
    """Pieces of a bar between two points, with eyes."""
    start, end = ends
    local = (end - start) / unit
    return _pieces([bar(0j, local, BAR), circle(EYE), circle(EYE, local)], unit, start)


@lru_cache(maxsize=CACHE_SIZE)
def stem(length: float, half_width: float, eye: float) -> tuple[QPainterPath, ...]:
    """Pieces of a bar along +x from an eye at the origin, with a square end; lengths in units."""
    path = QPainterPath()
    path.addRect(QRectF(0.0, -half_width, length, 2 * half_width))
    return path, circle(eye)


@lru_cache(maxsize=CACHE_SIZE)
def hatched_box(left: float, right: float, low: float, high: float, gap: float) -> QPainterPath:
    """Strokes at 45° inside a box."""
    lines = []
    for i in range(math.ceil((left - high) / gap), math.floor((right - low) / gap) + 1):
        c = i * gap  # x = y + c
        start, end = max(low, left - c), min(high, right - c)
        if end - start > 1e-6 * gap:
            lines.append((complex(start + c, start), complex(end + c, end)))
    return segments(lines)


def hatching(start: complex, end: complex, depth: float, gap: float) -> QPainterPath:
    """Short strokes at 45° on the right of the line from start to end, at equal distances of about ``gap``."""
    length = abs(end - start)
    count = max(2, min(400, round(length / gap)))
    return scaled(_strokes(count, depth / gap), length / count, start, (end - start) / length)


@lru_cache(maxsize=CACHE_SIZE)
def _strokes(count: int, depth: float) -> QPainterPath:
    """Strokes below the +x axis, one in each unit of length."""
    middles = (0.5 + i for i in range(count))
    return segments((x + 0.25 * depth, complex(x - 0.75 * depth, -depth)) for x in middles)


@lru_cache(maxsize=1)
def pedestal() -> tuple[QPainterPath, QPainterPath]:
    """Fixed pivot below the origin, in units: triangle, and hatched ground."""
    half, height, ground_half = 1.9, 3.4, 2.9
    triangle = polyline([0j, complex(-half, -height), complex(half, -height)], closed=True)
    ground = segments([(complex(-ground_half, -height), complex(ground_half, -height))])
    ground.addPath(hatching(complex(-ground_half, -height), complex(ground_half, -height), 0.85, HATCH))
    return triangle, ground


@lru_cache(maxsize=CACHE_SIZE)
def bearing(inner: float, outer: float) -> tuple[QPainterPath, QPainterPath, QPainterPath]:
    """Shaft in its bearing, radii in mm: bush, hatching of the bush, shaft with centre lines."""
    bush = circle(outer)
    gap = (outer - inner) * 0.55
    lines = []
    for i in range(-60, 61):
        c = i * gap
        if abs(c) >= outer:
            continue
        reach, hole = math.sqrt(outer * outer - c * c), inner * inner - c * c
        turn = cmath.exp(0.25j * math.pi)
        if hole <= 0.0:
            lines.append((complex(-reach, c) * turn, complex(reach, c) * turn))
        else:
            half_hole = math.sqrt(hole)
            lines += [
                (complex(-reach, c) * turn, complex(-half_hole, c) * turn),
                (complex(half_hole, c) * turn, complex(reach, c) * turn),
            ]
    shaft = joined(circle(inner), segments([(-outer * 1.5 + 0j, outer * 1.5 + 0j), (-1.5j * outer, 1.5j * outer)]))
    return bush, segments(lines), shaft


def cross(size: float, centre: complex = 0j) -> QPainterPath:
    """Two lines through a point, which extend ``size`` from it in both directions."""
    return segments([(centre - size, centre + size), (centre - 1j * size, centre + 1j * size)])


def arrow_head(tip: complex, along: complex, size: float) -> QPainterPath:
    """Slim arrowhead; ``along`` is a unit vector."""
    base = tip - along * size
    side = 1j * along * size * 0.27
    return polyline([tip, base + side, base - side], closed=True)


@lru_cache(maxsize=CACHE_SIZE)
def arc_arrow(radius: float, start: float, span: float, head_length: float) -> tuple[QPainterPath, QPainterPath]:
    """Arc about the origin from ``start`` over ``span`` [deg, counter-clockwise], and the arrowhead at its end."""
    stop = span - math.copysign(math.degrees(0.7 * head_length / radius), span)
    angles = [math.radians(start + stop * i / 40.0) for i in range(41)]
    line = polyline([cmath.rect(radius, a) for a in angles])
    end = cmath.rect(radius, math.radians(start + span))
    chord = end - cmath.rect(radius, math.radians(start + span) - math.copysign(head_length / radius, span))
    return line, arrow_head(end, chord / abs(chord), head_length)
