"""Layers of lines and circles in millimetres, as DXF and as SVG to scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from core.frozen import frozen
from core.output.drawing import svg
from core.output.drawing.dxf import dxf_file

_MARGIN = 0.05
COLOURS = (7, 5, 3, 1, 6, 4, 2, 30)  # of layers in DXF, in turn
STROKES = ("#000000", "#0072b2", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f")


@frozen(eq=False)
class LayerShapes:
    """Shapes on a layer.

    Attributes
    ----------
    lines : points (n,) complex [mm] of each line, and whether it is closed
    circles : centre and radius [mm]
    """

    lines: tuple[tuple[np.ndarray, bool], ...] = ()
    circles: tuple[tuple[complex, float], ...] = ()


Layers = Mapping[str, LayerShapes]


def extent(layers: Layers) -> tuple[complex, complex]:
    """Lower left and upper right corner of all shapes [mm]."""
    point_sets = [z for shapes in layers.values() for z, _ in shapes.lines]
    point_sets += [np.array([c - r * (1 + 1j), c + r * (1 + 1j)]) for s in layers.values() for c, r in s.circles]
    z = np.concatenate(point_sets)
    return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())


def dxf(comment: Sequence[str], layers: Layers) -> bytes:
    """Layers as DXF, with comments."""

    def draw(drawing: Any) -> None:
        space = drawing.modelspace()
        for i, (name, shapes) in enumerate(layers.items()):
            drawing.layers.add(name, color=COLOURS[i % len(COLOURS)])
            attributes = {"layer": name}
            for z, closed in shapes.lines:
                space.add_lwpolyline(
                    (np.column_stack((z.real, z.imag)) + 0.0).tolist(), close=closed, dxfattribs=attributes
                )
            for centre, radius in shapes.circles:
                space.add_circle((centre.real, centre.imag), radius, dxfattribs=attributes)

    return dxf_file(comment, draw)


def svg_to_scale(comment: Sequence[str], layers: Layers) -> bytes:
    """Layers as SVG to scale: one unit is one millimetre, y upwards."""
    low, high = extent(layers)
    span = high - low
    margin = _MARGIN * max(span.real, span.imag, 1e-9)
    width, height = span.real + 2.0 * margin, span.imag + 2.0 * margin
    lines: list[str] = []
    for i, (name, shapes) in enumerate(layers.items()):
        drawn = [svg.polyline(z, closed) for z, closed in shapes.lines]
        drawn += [svg.circle(centre, radius) for centre, radius in shapes.circles]
        lines += svg.group(drawn, id=name, stroke=STROKES[i % len(STROKES)])
    text = svg.document(
        lines,
        (low.real - margin, -high.imag - margin, width, height),
        (f"{width:.6g}mm", f"{height:.6g}mm"),
        comment[0],
        fill="none",
        stroke_width=f"{0.003 * max(width, height):.4g}",
    )
    return text.encode("utf-8", "replace")


WRITERS = {".dxf": dxf, ".svg": svg_to_scale}
"""Ending of a file -> its writer."""
