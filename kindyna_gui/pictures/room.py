"""Free paper for texts that move with a drawing: where a text covers no part, and no other text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF

from kindyna_gui.pictures.items import Tag
from kindyna_gui.pictures.labels import Ink
from kindyna_gui.pictures.sight import Sight

GAPS = (9.0, 20.0, 34.0, 52.0)  # from a place to its text, pixels
EDGE, PAD = 6.0, 1.5  # kept free along the picture's edge, and about a text, pixels
PART, COVERS, LEAVES, FURTHER = 9.0, 8.0, 50.0, 0.4  # costs: covering a part, a text, leaving, each longer gap
_WAYS = np.array([1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j, 1, -1, 1j, -1j])


class Room:
    """What is taken at one sample: dots of the drawing and boxes of texts, in pixels of the whole scene, y downwards."""

    def __init__(self, sight: Sight, ink: Ink, texts: Iterable[QRectF]) -> None:
        self._sight = sight
        self._place = ink.place[0].conj() * sight.scale
        self._radius, self._weight = ink.radius * sight.scale, ink.weight
        self._boxes = list(texts)

    def take(self, box: QRectF) -> None:
        """Nothing else shall stand there."""
        self._boxes.append(box)

    def dot(self, place: complex, radius: float) -> None:
        """No text shall cover a mark at a place [mm]; radius in pixels."""
        pixel = place.conjugate() * self._sight.scale
        self.take(QRectF(pixel.real - radius, pixel.imag - radius, 2.0 * radius, 2.0 * radius))

    def cost(self, centres: np.ndarray, width: float, height: float) -> np.ndarray:
        """How bad it is that boxes of this size stand about ``centres`` (c,): 0 where all is free (c,)."""
        half = complex(width / 2.0 + PAD, height / 2.0 + PAD)
        apart = centres[:, None] - self._place
        x = np.maximum(np.abs(apart.real) - half.real, 0.0)
        y = np.maximum(np.abs(apart.imag) - half.imag, 0.0)
        found = np.minimum((np.hypot(x, y) < self._radius) @ self._weight, PART)
        for box in self._boxes:
            middle = box.center()
            found += COVERS * (
                (np.abs(centres.real - middle.x()) < half.real + box.width() / 2.0)
                & (np.abs(centres.imag - middle.y()) < half.imag + box.height() / 2.0)
            )
        seen, scale = self._sight.visible, self._sight.scale
        out = (centres.real - half.real < seen.left() * scale + EDGE) | (centres.real + half.real > seen.right() * scale - EDGE)
        out |= (centres.imag - half.imag < -seen.bottom() * scale + EDGE) | (
            centres.imag + half.imag > -seen.top() * scale - EDGE
        )
        return np.asarray(found + LEAVES * out)

    def settle(self, tag: Tag, places: Sequence[complex], gaps: tuple[float, ...] = GAPS) -> None:
        """Put a text beside one of some places [mm], rather the first, where it covers least; far from it a thin line
        leads there."""
        width, height = tag.size
        scale = self._sight.scale
        reach = np.array(gaps)[:, None]
        shifts = (_WAYS.real * (reach + width / 2.0) - 1j * _WAYS.imag * (reach + height / 2.0)).ravel()
        pixels = np.conj(places)[:, None] * scale
        cost = self.cost((pixels + shifts).ravel(), width + 4.0, height).reshape(len(places), -1)
        cost += FURTHER * (np.arange(shifts.size) // _WAYS.size + np.arange(len(places))[:, None])
        which, best = divmod(int(np.argmin(cost)), shifts.size)
        place, shift, pixel = places[which], complex(shifts[best]), complex(pixels[which, 0])
        tag.setPos(QPointF(place.real, place.imag))
        tag.shift(shift.real, shift.imag)
        tag.lead(best >= _WAYS.size)
        box = QRectF(0.0, 0.0, width + 4.0, height)
        box.moveCenter(QPointF((pixel + shift).real, (pixel + shift).imag))
        self.take(box)
