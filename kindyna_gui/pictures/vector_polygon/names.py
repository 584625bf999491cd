"""Where the names in a polygon of vectors stand: off its vectors and off each other, without jumping as it moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QRectF

from core.frozen import frozen

CROSSES, COVERS, LEAVES, MOVES, LATER = 3.0, 6.0, 12.0, 0.8, 0.15
"""Costs: a vector or another text covered, outside of the sheet, another place than before, each place further down."""
_SPREAD = np.exp(1j * np.deg2rad([0.0, 40.0, -40.0, 85.0, -85.0, 130.0, -130.0, 180.0]))
_ALONG = (0.0, -0.16, 0.16, 0.28, -0.28)


@frozen
class PlacedName:
    """A name with an index; pixels, y downwards.

    kind        ``corner``: beside ``anchor``, ``away`` at best; ``side``: on either side of the vector ``along``
    value       beside the name
    middle      of its box, once it has been laid
    """

    kind: str
    name: str
    index: str
    anchor: complex
    away: complex
    colour: str
    width: float
    height: float
    along: complex = 0j
    value: str = ""
    middle: complex = 0j

    def places(self) -> np.ndarray:
        """Middles where it may stand, the best first (m,)."""
        half = complex(self.width, self.height) / 2.0
        if self.kind == "corner":
            directions = self.away * _SPREAD
            return np.concatenate([self.anchor + _pushed(directions, half, gap) for gap in (5.0, 13.0)])
        directions = self.away * np.array([1.0, -1.0])
        return np.concatenate([self.anchor + part * self.along + _pushed(directions, half, 3.0) for part in _ALONG])


def _pushed(directions: np.ndarray, half: complex, gap: float) -> np.ndarray:
    """Shifts in directions (m,) until a box of these halves is ``gap`` off a point."""
    return (
        directions * gap
        + np.clip(1.5 * directions.real, -1, 1) * half.real
        + 1j * np.clip(1.5 * directions.imag, -1, 1) * half.imag
    )


class NameLayout:
    """Lays texts; each keeps its place of the picture before where that is about as good."""

    def __init__(self) -> None:
        self._before: dict[tuple[str, str, str], int] = {}

    def laid(
        self, texts: Sequence[PlacedName], strokes: Sequence[tuple[complex, complex]], sheet: QRectF
    ) -> list[PlacedName]:
        """The texts with their middles; strokes: vectors from, to."""
        done: list[PlacedName] = []
        for text in texts:
            places = text.places()
            half = complex(text.width / 2.0 + 1.0, text.height / 2.0)
            cost = LATER * np.arange(places.size)
            for start, end in strokes:
                cost += CROSSES * _crossed(places, half, start, end)
            for other in done:
                cost += COVERS * (
                    (np.abs(places.real - other.middle.real) < half.real + other.width / 2.0)
                    & (np.abs(places.imag - other.middle.imag) < half.imag + other.height / 2.0)
                )
            cost += LEAVES * (
                (places.real - half.real < sheet.left())
                | (places.real + half.real > sheet.right())
                | (places.imag - half.imag < sheet.top())
                | (places.imag + half.imag > sheet.bottom())
            )
            key = (text.kind, text.name, text.index)
            cost += MOVES * (np.arange(places.size) != self._before.get(key, 0))
            best = self._before[key] = int(np.argmin(cost))
            done.append(replace(text, middle=complex(places[best])))
        return done


def _crossed(middles: np.ndarray, half: complex, start: complex, end: complex) -> np.ndarray:
    """Whether a stretch runs through boxes about ``middles`` (m,)."""
    low, high = np.zeros(middles.size), np.ones(middles.size)
    vector = end - start
    for at, step, room, centre in (
        (start.real, vector.real, half.real, middles.real),
        (start.imag, vector.imag, half.imag, middles.imag),
    ):
        if abs(step) < 1e-9:
            low = np.where(np.abs(centre - at) < room, low, 2.0)
            continue
        one, other = (centre - room - at) / step, (centre + room - at) / step
        low, high = np.maximum(low, np.minimum(one, other)), np.minimum(high, np.maximum(one, other))
    return np.asarray(low < high)
