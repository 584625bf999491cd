"""Springs and dampers between points: each along the line of its two ends, as long as these are apart."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from PySide6.QtGui import QPainterPath, QTransform

from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.items import Outline, Part
from kindyna_gui.pictures.drawing.shapes import joined, polyline, segments
from kindyna_gui.pictures.style import OUTLINE, Theme

COILS = 11
HALF_WIDTH, APART = 1.3, 2.0  # of a spring; of spring and damper from their common line, in units
START, END = 0.2, 0.8  # of the length: what of it is coiled
Z_SPRING = 8.0


def springs(geometry: Geometry, theme: Theme) -> Iterator[Part]:
    """One symbol for each: coils where it has a rate, a piston in its cylinder where it damps."""
    for spring, one, other in geometry.springs:
        item = Outline(symbol(bool(spring.rate), bool(spring.damping), geometry.unit), theme.pen(theme.ink, OUTLINE))
        along = other - one

        def move(i: int, item: Outline = item, one: np.ndarray = one, along: np.ndarray = along) -> None:
            """Stretched along the line of its ends, as wide as ever."""
            x, y, size = along.real[i], along.imag[i], abs(along[i]) or 1.0
            item.setTransform(QTransform(x, y, -y / size, x / size, one.real[i], one.imag[i]))

        yield Part(f"spring.{spring.name}", item, ("linkage",), Z_SPRING, move)


def symbol(coiled: bool, damped: bool, unit: float) -> QPainterPath:
    """From (0, 0) to (1, 0), widths in mm."""
    beside = APART * unit if coiled and damped else 0.0
    parts = []
    if coiled:
        x = np.linspace(START, END, 2 * COILS + 1)
        y = np.where(np.arange(x.size) % 2, 1.0, -1.0) * HALF_WIDTH * unit
        y[0] = y[-1] = 0.0
        line = [complex(0.5 * START, 0.0), *(complex(a, b) for a, b in zip(x, y, strict=True)), complex(1.0 - 0.5 * START, 0.0)]
        parts.append(polyline([z + 1j * beside for z in line]))
    if damped:
        half, low = 1j * HALF_WIDTH * unit, -1j * beside
        cup = [0.65 + half, 0.4 + half, 0.4 - half, 0.65 - half]
        parts += [
            polyline([z + low for z in cup]),
            segments([(0.5 * START + low, 0.4 + low), (0.55 + 0.7 * half + low, 0.55 - 0.7 * half + low), (0.55 + low, 0.9 + low)]),
        ]
    ends = [(0j, complex(0.5 * START)), (complex(1.0 - 0.5 * START), 1.0 + 0j)]
    if beside:
        ends += [(x + 1j * beside, x - 1j * beside) for x in (0.5 * START, 1.0 - 0.5 * START)]
    return joined(*parts, segments(ends))
