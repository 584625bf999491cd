"""A drawing as SVG to scale: one unit is one millimetre, the y axis points upwards as in every other file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import atan, sin
from types import MappingProxyType
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from core.output.profile.drawing import LAYERS, CircleShape, LineShape, Shape, reach
from core.output.profile.fits import Arcs, Cubics

MARGIN = 0.05  # of the drawing's size, around it
STROKE = 0.25  # mm
DASHES: Mapping[str, str] = MappingProxyType({"CENTER": "8 1.5 1 1.5", "DASHED": "2.5 1.5"})
"""Of a line type."""


def _at(z: complex) -> str:
    """A point; no minus zero."""
    return f"{z.real + 0.0!r} {0.0 - z.imag!r}"


def _arcs(shape: Arcs) -> str:
    """Chords are lines; an arc that turns left runs clockwise on paper whose y axis points down, of sweep 0."""
    vertices, ends = shape.vertices.tolist(), np.roll(shape.vertices, -1).tolist()
    parts = [f"M {_at(vertices[0])}"]
    for start, end, bulge in zip(vertices, ends, shape.b.ravel().tolist(), strict=True):
        if bulge:
            radius = 0.5 * abs(end - start) / abs(sin(2.0 * atan(bulge)))
            parts.append(f"A {radius!r} {radius!r} 0 0 {0 if bulge > 0.0 else 1} {_at(end)}")
        else:
            parts.append(f"L {_at(end)}")
    return _path([*parts, "Z"])


def _cubics(shape: Cubics) -> str:
    parts = [f"C {_at(a)} {_at(b)} {_at(c)}" for _, a, b, c in shape.points.tolist()]
    return _path([f"M {_at(complex(shape.points[0, 0]))}", *parts, "Z"])


def _path(parts: Sequence[str]) -> str:
    lines = "\n".join(parts)
    return f'<path d="{lines}"/>'


def _circle(shape: CircleShape) -> str:
    return f'<circle cx="0" cy="0" r="{shape.radius!r}"/>'


def _line(shape: LineShape) -> str:
    (a, b), (c, d) = _at(shape.start).split(), _at(shape.end).split()
    return f'<line x1="{a}" y1="{b}" x2="{c}" y2="{d}"/>'


SHAPES: Mapping[type, Callable[[Any], str]] = MappingProxyType(
    {Arcs: _arcs, Cubics: _cubics, CircleShape: _circle, LineShape: _line}
)


def written(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> bytes:
    """The file: a comment, a title, a group for each layer."""
    return "\n".join(_lines(comment, layers)).encode("utf-8", "replace")


def _lines(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> Iterator[str]:
    half = (1.0 + MARGIN) * reach(layers)
    half = float(np.ceil(half))
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield from ("<!--", *(re.sub("-(?=-)", "- ", line) for line in comment), "-->")  # two hyphens end a comment
    size = f'width="{2.0 * half:g}mm" height="{2.0 * half:g}mm" viewBox="{-half:g} {-half:g} {2.0 * half:g} {2.0 * half:g}"'
    yield f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="none" stroke-width="{STROKE:g}">'
    yield f"<title>{escape(comment[0])}</title>"
    yield f"<desc>{escape('; '.join(comment[1:]))}</desc>"
    for name, shapes in layers.items():
        row = LAYERS[name]
        dashes = f' stroke-dasharray="{DASHES[row.line]}"' if row.line in DASHES else ""
        yield f'<g id="{name}" stroke="{row.stroke}"{dashes}>'
        yield from (SHAPES[type(shape)](shape) for shape in shapes)
        yield "</g>"
    yield "</svg>\n"


__all__ = ["written"]
