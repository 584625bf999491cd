"""Search for free space in a drawing, where a text covers neither a part nor another text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF

from kindyna_gui.pictures.drawing.labels import DrawnDots
from kindyna_gui.pictures.items import Tag, Viewport

GAPS = (9.0, 20.0, 34.0, 52.0)  # from a point to its text, pixels
EDGE, PAD = 6.0, 1.5  # free margins along the edge of the view, and around a text, pixels
PART, COVERS, LEAVES, FURTHER = 9.0, 8.0, 50.0, 0.4  # costs: covering a part, a text, leaving the view, a longer gap
CLEAR, MOST_STEPS = 8.0, 40  # distance of an arrow from a text, pixels; how often the arrow moves inwards by it
_DIRECTIONS = np.array([1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j, 1, -1, 1j, -1j])


class OccupiedSpace:
    """Occupied space at one sample: dots of the drawing and boxes of texts, in pixels of the scene, y downwards."""

    def __init__(self, viewport: Viewport, dots: DrawnDots, texts: Iterable[QRectF]) -> None:
        self._viewport = viewport
        self._x, self._y = dots.points[0].real * viewport.scale, -dots.points[0].imag * viewport.scale
        self._radius, self._weight = dots.radius * viewport.scale, dots.weight
        self._boxes: list[tuple[float, float, float, float]] = []  # centres and half sizes
        for box in texts:
            self.reserve(box)
        visible, scale = viewport.visible, viewport.scale
        edges = visible.left(), visible.right(), -visible.bottom(), -visible.top()
        left, right, top, low = (edge * scale for edge in edges)
        self._view = (left + EDGE, top + EDGE, right - EDGE, low - EDGE)

    def reserve(self, box: QRectF) -> None:
        """Reserve a box, so that no other text is placed there."""
        middle = box.center()
        self._boxes.append((middle.x(), middle.y(), 0.5 * box.width(), 0.5 * box.height()))

    def inwards(self, point: complex) -> complex:
        """Move a point [mm] towards the centre of the view until no text is near it."""
        scale, middle = self._viewport.scale, self._viewport.centre
        for _ in range(MOST_STEPS):
            x, y = point.real * scale, -point.imag * scale
            if not any(
                abs(x - left) < wide + CLEAR and abs(y - top) < high + CLEAR for left, top, wide, high in self._boxes
            ):
                break
            offset = middle - point
            point += offset * min(1.0, CLEAR / max(abs(offset) * scale, 1e-9))
        return point

    def dot(self, point: complex, radius: float) -> None:
        """Reserve the space of a mark at a point [mm]; radius in pixels."""
        pixel = point.conjugate() * self._viewport.scale
        self.reserve(QRectF(pixel.real - radius, pixel.imag - radius, 2.0 * radius, 2.0 * radius))

    def cost(self, centres: np.ndarray, width: float, height: float) -> np.ndarray:
        """Costs (c,) of boxes of this size around ``centres`` (c,); 0 where the space is free."""
        x, y = centres.real, centres.imag
        wide, high = width / 2.0 + PAD, height / 2.0 + PAD
        near = np.abs(self._x - 0.5 * (x.min() + x.max())) < self._radius + wide + 0.5 * (x.max() - x.min())
        near &= np.abs(self._y - 0.5 * (y.min() + y.max())) < self._radius + high + 0.5 * (y.max() - y.min())
        over = np.maximum(np.abs(x[:, None] - self._x[near]) - wide, 0.0) ** 2
        over += np.maximum(np.abs(y[:, None] - self._y[near]) - high, 0.0) ** 2
        occupied = np.minimum((over < self._radius[near] ** 2) @ self._weight[near], PART)
        if self._boxes:
            across, along, half_wide, half_high = np.array(self._boxes).T
            separate = np.abs(x[:, None] - across) >= wide + half_wide
            separate |= np.abs(y[:, None] - along) >= high + half_high
            occupied += COVERS * (~separate).sum(axis=1)
        left, top, right, low = self._view
        out = (x - wide < left) | (x + wide > right) | (y - high < top) | (y + high > low)
        return np.asarray(occupied + LEAVES * out)

    def place_text(self, tag: Tag, points: Sequence[complex], gaps: tuple[float, ...] = GAPS) -> None:
        """Place a text where it covers least, next to one of the points [mm]; a thin line leads to it from afar.

        The first points and short gaps are preferred.
        """
        width, height = tag.size
        reach = np.repeat(gaps, _DIRECTIONS.size)
        directions = np.tile(_DIRECTIONS, len(gaps))
        shifts = directions.real * (reach + width / 2.0) - 1j * directions.imag * (reach + height / 2.0)
        further = FURTHER * np.repeat(np.arange(len(gaps)), _DIRECTIONS.size)
        best, least = (points[0], 0), np.inf
        for number, point in enumerate(points):
            centres = point.conjugate() * self._viewport.scale + shifts
            cost = self.cost(centres, width + 4.0, height) + further + FURTHER * number
            side = int(np.argmin(cost))
            if cost[side] < least:
                best, least = (point, side), float(cost[side])
            if least < PART:
                break
        point, side = best
        shift = complex(shifts[side])
        tag.setPos(QPointF(point.real, point.imag))
        tag.shift(shift.real, shift.imag)
        tag.lead(side >= _DIRECTIONS.size)
        middle = point.conjugate() * self._viewport.scale + shift
        self._boxes.append((middle.real, middle.imag, width / 2.0 + 2.0, height / 2.0))
