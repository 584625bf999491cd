"""Free paper for texts that move with a drawing: where a text covers no part, and no other text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF

from kindyna_gui.pictures.drawing.labels import DrawnDots
from kindyna_gui.pictures.items import Tag, Viewport

GAPS = (9.0, 20.0, 34.0, 52.0)  # from a place to its text, pixels
EDGE, PAD = 6.0, 1.5  # kept free along the picture's edge, and about a text, pixels
PART, COVERS, LEAVES, FURTHER = 9.0, 8.0, 50.0, 0.4  # costs: covering a part, a text, leaving, each longer gap
CLEAR, MOST_STEPS = 8.0, 40  # of an arrow at the edge from a text, and how often it goes so far inwards, pixels
_DIRECTIONS = np.array([1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j, 1, -1, 1j, -1j])


class TakenSpace:
    """What is taken at one sample: dots of the drawing and boxes of texts, in pixels of the whole scene, y downwards."""

    def __init__(self, viewport: Viewport, ink: DrawnDots, texts: Iterable[QRectF]) -> None:
        self._viewport = viewport
        self._x, self._y = ink.place[0].real * viewport.scale, -ink.place[0].imag * viewport.scale
        self._radius, self._weight = ink.radius * viewport.scale, ink.weight
        self._boxes: list[tuple[float, float, float, float]] = []  # middles and halves
        for box in texts:
            self.take(box)
        seen, scale = viewport.visible, viewport.scale
        left, right, top, low = (v * scale for v in (seen.left(), seen.right(), -seen.bottom(), -seen.top()))
        self._sheet = (left + EDGE, top + EDGE, right - EDGE, low - EDGE)

    def take(self, box: QRectF) -> None:
        """Nothing else shall stand there."""
        middle = box.center()
        self._boxes.append((middle.x(), middle.y(), 0.5 * box.width(), 0.5 * box.height()))

    def inwards(self, place: complex) -> complex:
        """A place [mm] moved towards the middle of the picture until no text stands there."""
        scale, middle = self._viewport.scale, self._viewport.centre
        for _ in range(MOST_STEPS):
            x, y = place.real * scale, -place.imag * scale
            if not any(
                abs(x - left) < wide + CLEAR and abs(y - top) < high + CLEAR for left, top, wide, high in self._boxes
            ):
                break
            offset = middle - place
            place += offset * min(1.0, CLEAR / max(abs(offset) * scale, 1e-9))
        return place

    def dot(self, place: complex, radius: float) -> None:
        """No text shall cover a mark at a place [mm]; radius in pixels."""
        pixel = place.conjugate() * self._viewport.scale
        self.take(QRectF(pixel.real - radius, pixel.imag - radius, 2.0 * radius, 2.0 * radius))

    def cost(self, centres: np.ndarray, width: float, height: float) -> np.ndarray:
        """How bad it is that boxes of this size stand about ``centres`` (c,): 0 where all is free (c,)."""
        x, y = centres.real, centres.imag
        wide, high = width / 2.0 + PAD, height / 2.0 + PAD
        near = np.abs(self._x - 0.5 * (x.min() + x.max())) < self._radius + wide + 0.5 * (x.max() - x.min())
        near &= np.abs(self._y - 0.5 * (y.min() + y.max())) < self._radius + high + 0.5 * (y.max() - y.min())
        over = np.maximum(np.abs(x[:, None] - self._x[near]) - wide, 0.0) ** 2
        over += np.maximum(np.abs(y[:, None] - self._y[near]) - high, 0.0) ** 2
        occupied = np.minimum((over < self._radius[near] ** 2) @ self._weight[near], PART)
        if self._boxes:
            across, along, half_wide, half_high = np.array(self._boxes).T
            beside = np.abs(x[:, None] - across) >= wide + half_wide
            beside |= np.abs(y[:, None] - along) >= high + half_high
            occupied += COVERS * (~beside).sum(axis=1)
        left, top, right, low = self._sheet
        out = (x - wide < left) | (x + wide > right) | (y - high < top) | (y + high > low)
        return np.asarray(occupied + LEAVES * out)

    def settle(self, tag: Tag, places: Sequence[complex], gaps: tuple[float, ...] = GAPS) -> None:
        """Put a text beside one of some places [mm], rather the first and rather near, where it covers least; far from
        it a thin line leads there."""
        width, height = tag.size
        reach = np.repeat(gaps, _DIRECTIONS.size)
        directions = np.tile(_DIRECTIONS, len(gaps))
        shifts = directions.real * (reach + width / 2.0) - 1j * directions.imag * (reach + height / 2.0)
        further = FURTHER * np.repeat(np.arange(len(gaps)), _DIRECTIONS.size)
        best, least = (places[0], 0), np.inf
        for number, place in enumerate(places):
            cost = (
                self.cost(place.conjugate() * self._viewport.scale + shifts, width + 4.0, height)
                + further
                + FURTHER * number
            )
            side = int(np.argmin(cost))
            if cost[side] < least:
                best, least = (place, side), float(cost[side])
            if least < PART:
                break
        place, side = best
        shift = complex(shifts[side])
        tag.setPos(QPointF(place.real, place.imag))
        tag.shift(shift.real, shift.imag)
        tag.lead(side >= _DIRECTIONS.size)
        middle = place.conjugate() * self._viewport.scale + shift
        self._boxes.append((middle.real, middle.imag, width / 2.0 + 2.0, height / 2.0))
