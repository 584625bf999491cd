"""What is visible of a scene, for items that are measured in pixels or end at the picture's edge."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QRectF


class Viewport:
    """visible: rectangle [mm], y upwards; scale: pixels per mm. The scene keeps it up to date."""

    def __init__(self) -> None:
        self.visible, self.scale = QRectF(-100.0, -100.0, 200.0, 200.0), 1.0

    @property
    def centre(self) -> complex:
        """Of what is visible, x + iy [mm]."""
        place = self.visible.center()
        return complex(place.x(), place.y())

    def holds(self, place: complex, margin: float = 0.0) -> bool:
        """Whether a place [mm] is visible, and so many pixels away from the edge."""
        room = margin / self.scale
        box = self.visible.adjusted(room, room, -room, -room)
        return box.left() <= place.real <= box.right() and box.top() <= place.imag <= box.bottom()

    def edge(self, towards: complex, margin: float) -> complex:
        """Where the ray from the middle leaves the picture, so many pixels before its edge [mm]."""
        room = margin / self.scale
        half = complex(self.visible.width() / 2.0 - room, self.visible.height() / 2.0 - room)
        direction = towards / abs(towards)
        reach = min(
            half.real / abs(direction.real) if abs(direction.real) > 1e-12 else np.inf,
            half.imag / abs(direction.imag) if abs(direction.imag) > 1e-12 else np.inf,
        )
        return self.centre + reach * direction

    def across(self, line: np.ndarray) -> tuple[complex, complex] | None:
        """The part of the line a x + b y + c = 0 [mm] that is visible; None where none is."""
        a, b, c = (float(part) for part in line)
        length = float(np.hypot(a, b))
        if length == 0.0 or not np.isfinite(length + c):
            return None
        normal = complex(a, b) / length
        foot = self.centre - normal * ((normal.conjugate() * self.centre).real + c / length)
        along = 1j * normal
        low, high = -np.inf, np.inf
        sides = (
            (foot.real, along.real, self.visible.left(), self.visible.right()),
            (foot.imag, along.imag, self.visible.top(), self.visible.bottom()),
        )
        for start, rate, least, most in sides:
            if abs(rate) < 1e-12:
                if not least <= start <= most:
                    return None
                continue
            ends = sorted(((least - start) / rate, (most - start) / rate))
            low, high = max(low, ends[0]), min(high, ends[1])
        return (foot + low * along, foot + high * along) if low < high else None
