"""Plates: bodies of a design from their outlines and layers, as solids in the frame of the body."""

from __future__ import annotations

from math import pi

import numpy as np

from core.clearance.shapes import MM, Shape
from core.design.outline_bodies import body_named
from core.errors import KindynaError
from core.output.solids.disk import Prisms
from core.output.solids.outline import Arc, Line, Outline, area, reversed_outline
from core.output.solids.prism import Cap, Prism, Rim, Wall
from core.study import Study

SMOOTH = 1e-9  # [rad] turn of a corner that counts as rounding


def body_plates(study: Study, name: str) -> Prisms:
    """Plates of a body, one for each of its outlines, with the points where pins join it to other bodies.

    Raises
    ------
    KindynaError
        The design has no such body with an outline, an outline has no layer with both ends, or it cannot be grown.
    """
    clearances = study.clearances
    body = body_named(study.design, name)
    if body is None or body not in clearances.names:
        allowed = " | ".join(clearances.names.values()) or "none, add [[outlines]]"
        raise KindynaError(f"of: {name!r} is no body with an outline; allowed: {allowed}")
    rows = [row for row in clearances.outlines[body] if row.plane is None]
    for row in rows:
        if row.layer_from_mm is None or row.layer_to_mm is None or not row.layer_from_mm < row.layer_to_mm:
            raise KindynaError(
                f"of: the outline of {name} has no thickness; allowed: layer_from_mm below layer_to_mm, both given"
            )
    shape = clearances.shape(body, None)
    prisms = tuple(
        Prism(name, (Wall(_outline(shape, i, name), row.layer[0], row.layer[1]),), _CAPS) for i, row in enumerate(rows)
    )
    pins = {
        f"pin {number}": np.array([z.real / MM, z.imag / MM, rows[0].layer[0]])
        for number, z in enumerate(clearances.pins_of(body), 1)
    }
    return Prisms(prisms, shape.deviation / MM, pins)


_CAPS = (Cap(False, (Rim(0, False),)), Cap(True, (Rim(0, True),)))


def _outline(shape: Shape, number: int, name: str) -> Outline:
    """One outline of a shape, grown, counter-clockwise [mm]."""
    rows = np.flatnonzero(shape.outline == number)
    growth = float(shape.growth[rows[0]]) / MM
    start, end = complex(shape.start[rows[0]] / MM), complex(shape.end[rows[0]] / MM)
    if not shape.encloses[number]:
        if start == end:
            return Arc(start, growth, 0.0, pi), Arc(start, growth, pi, pi)
        return _grown([Line(start, end), Line(end, start)], growth, name)
    pieces: list[Line | Arc] = [
        Arc(complex(shape.centre[i] / MM), float(shape.radius[i] / MM),
            float(np.angle(shape.start[i] - shape.centre[i])), float(shape.sweep[i]))
        if shape.radius[i] > 0.0
        else Line(complex(shape.start[i] / MM), complex(shape.end[i] / MM))
        for i in rows.tolist()
    ]  # fmt: skip
    outline: Outline = tuple(pieces)
    outline = outline if area(outline) > 0.0 else reversed_outline(outline)
    return _grown([piece for piece in outline if isinstance(piece, Line | Arc)], growth, name)


def _tangents(piece: Line | Arc) -> tuple[complex, complex]:
    """Unit tangents at the start and at the end."""
    if isinstance(piece, Line):
        tangent = (piece.end - piece.start) / abs(piece.end - piece.start)
        return tangent, tangent
    side = 1j if piece.sweep > 0.0 else -1j
    first, last = ((z - piece.centre) / piece.radius * side for z in (piece.start, piece.end))
    return first, last


def _grown(pieces: list[Line | Arc], growth: float, name: str) -> Outline:
    """Outline around counter-clockwise pieces at a distance to their right, with an arc about each corner."""
    if growth <= 0.0:
        return tuple(pieces)
    result: list[Line | Arc] = []
    for piece, after in zip(pieces, [*pieces[1:], pieces[0]], strict=True):
        first, last = _tangents(piece)
        if isinstance(piece, Line):
            result.append(Line(piece.start - 1j * first * growth, piece.end - 1j * last * growth))
        else:
            radius = piece.radius + (growth if piece.sweep > 0.0 else -growth)
            if radius <= 0.0:
                raise KindynaError(_hollow(name, growth))
            result.append(Arc(piece.centre, radius, piece.from_angle, piece.sweep))
        turn = float(np.angle(_tangents(after)[0] / last))
        turn = abs(turn) if abs(turn) > pi - SMOOTH else turn  # of a bar, at its end
        if turn < -SMOOTH:
            raise KindynaError(_hollow(name, growth))
        if turn > SMOOTH:
            result.append(Arc(piece.end, growth, float(np.angle(-1j * last)), turn))
    return tuple(result)


def _hollow(name: str, growth: float) -> str:
    return (
        f"of: the outline of {name} has a hollow that {growth:g} mm of round_mm would fill; "
        "give the corners of the plate itself, or a drawing"
    )
