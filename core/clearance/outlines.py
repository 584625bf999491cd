"""Shapes of the bodies of a design from its outlines: corners, drawings, circles of rollers, profiles of cams, points of links."""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np

from core.clearance.profile import ArcChain
from core.clearance.shapes import MM, Shape, arcs, closed_curve, convex_hull, polygon
from core.design.outlines import Outline
from core.frozen import frozen


@frozen(eq=False)
class BodyGeometry:
    """Geometry of a body that an outline without corners has.

    Attributes
    ----------
    points : ndarray (p,) complex [m]
        Points of the body in its frame.
    radius : float or None
        Radius of a roller [m].
    profile : callable or None
        The profile of a cam.
    unit : complex
        Direction of the x axis of its outlines in the frame of the body.
    """

    points: np.ndarray
    radius: float | None = None
    profile: Callable[[], ArcChain] | None = None
    unit: complex = 1.0 + 0j


def drawing_of(outline: Outline) -> bytes:
    """Content of the drawing of an outline; empty without one. Raises FileError."""
    if not outline.file:
        return b""
    from core.project.files import read_bytes  # few outlines have a drawing

    return read_bytes(os.path.join(outline.folder, outline.file))


def outline_shape(outline: Outline, drawing: bytes, geometry: BodyGeometry) -> Shape:
    """Shape of one outline in the frame of its body.

    Parameters
    ----------
    outline : Outline
    drawing : bytes
        Content of its drawing, where it has one.
    geometry : BodyGeometry
        Geometry of the body.

    Returns
    -------
    Shape

    Raises
    ------
    DrawingError
        The drawing has no closed curve, or more than one.
    """
    growth = (outline.round_mm or 0.0) * MM
    low, high = outline.layer
    layer = low * MM, high * MM
    if outline.file:
        from core.contour.drawing import read_outline  # as above

        shape = closed_curve(read_outline(drawing, outline.file), growth, layer)
        return shape if geometry.unit == 1.0 else shape.rotated(geometry.unit)
    if outline.points:
        corners = np.array([complex(point.x_mm, point.y_mm) for point in outline.points]) * MM
        return polygon(corners * geometry.unit, growth, layer)
    if geometry.radius is not None:
        return polygon(np.zeros(1, dtype=complex), geometry.radius + growth, layer)
    if geometry.profile is not None:
        chain = geometry.profile()
        return arcs(chain.start, chain.end, chain.bulge, growth, layer, chain.deviation)
    points = convex_hull(geometry.points)
    return polygon(points, growth, layer)
