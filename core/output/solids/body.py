"""Boundary of a body in space: vertices, edges on curves, faces on surfaces with their loops of edges."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from core.frozen import frozen

# -- curves -----------------------------------------------------------------------------------------------------


@frozen(eq=False)
class LineCurve:
    """A straight line through the vertices of its edge."""


@frozen(eq=False)
class CircleCurve:
    """A circle, run through counter-clockwise about its axis.

    Attributes
    ----------
    centre : ndarray (3,) [mm]
    axis : ndarray (3,), dimensionless
        Unit vector.
    radius : float [mm]
    """

    centre: np.ndarray
    axis: np.ndarray
    radius: float


@frozen(eq=False)
class KnotVector:
    """Degree and knots of a B-spline.

    Attributes
    ----------
    degree : int
    knots : ndarray (k,) [any]
        Distinct knots, rising.
    multiplicities : tuple of int
        One for each knot.
    """

    degree: int
    knots: np.ndarray
    multiplicities: tuple[int, ...]


@frozen(eq=False)
class SplineCurve:
    """A B-spline curve.

    Attributes
    ----------
    basis : KnotVector
    points : ndarray (m, 3) [mm]
        Control points.
    """

    basis: KnotVector
    points: np.ndarray


Curve: TypeAlias = LineCurve | CircleCurve | SplineCurve

# -- surfaces ---------------------------------------------------------------------------------------------------


@frozen(eq=False)
class PlaneSurface:
    """A plane.

    Attributes
    ----------
    origin : ndarray (3,) [mm]
    normal : ndarray (3,), dimensionless
        Unit vector.
    """

    origin: np.ndarray
    normal: np.ndarray


@frozen(eq=False)
class CylinderSurface:
    """A cylinder, whose normal points away from its axis.

    Attributes
    ----------
    origin : ndarray (3,) [mm]
        A point of the axis.
    axis : ndarray (3,), dimensionless
        Unit vector.
    radius : float [mm]
    """

    origin: np.ndarray
    axis: np.ndarray
    radius: float


@frozen(eq=False)
class TorusSurface:
    """A torus, whose normal points away from the circle in its middle.

    Attributes
    ----------
    centre : ndarray (3,) [mm]
    axis : ndarray (3,), dimensionless
        Unit vector.
    major_radius, minor_radius : float [mm]
        Radius of the circle about the axis, and distance of the surface from that circle.
    """

    centre: np.ndarray
    axis: np.ndarray
    major_radius: float
    minor_radius: float


@frozen(eq=False)
class SplineSurface:
    """A B-spline surface S(u, v), whose normal is ∂S/∂u × ∂S/∂v.

    Attributes
    ----------
    along, across : KnotVector
        By u and by v.
    points : ndarray (m, k, 3) [mm]
        Control points.
    """

    along: KnotVector
    across: KnotVector
    points: np.ndarray


Surface: TypeAlias = PlaneSurface | CylinderSurface | TorusSurface | SplineSurface

# -- topology ---------------------------------------------------------------------------------------------------


@frozen(eq=False)
class Edge:
    """An edge on its curve, in the direction of the curve, from one vertex to another; vertices by their index."""

    curve: Curve
    start: int
    end: int


Loop: TypeAlias = tuple[tuple[int, bool], ...]
"""Edges of a loop by their index, in order, each with whether it is run through forwards; the face is on the left."""


def reversed_loop(loop: Loop) -> Loop:
    """The loop in the opposite direction."""
    return tuple((edge, not is_forward) for edge, is_forward in reversed(loop))


@frozen(eq=False)
class Face:
    """A face on its surface.

    Attributes
    ----------
    surface : Surface
    loops : tuple of Loop
        The outer loop first.
    is_along : bool
        Whether the outward normal is that of the surface; otherwise it is the opposite one.
    """

    surface: Surface
    loops: tuple[Loop, ...]
    is_along: bool = True


@frozen(eq=False)
class Body:
    """A body, closed or an open sheet.

    Attributes
    ----------
    name : str
    vertices : ndarray (n, 3) [mm]
    edges : tuple of Edge
    faces : tuple of Face
    is_closed : bool
        Whether the faces enclose a solid.
    """

    name: str
    vertices: np.ndarray
    edges: tuple[Edge, ...]
    faces: tuple[Face, ...]
    is_closed: bool


class BodyBuilder:
    """Vertices, edges and faces of a body, added one after the other; each addition returns its index."""

    def __init__(self) -> None:
        self._vertices: list[np.ndarray] = []
        self._edges: list[Edge] = []
        self._faces: list[Face] = []

    def vertex(self, point: np.ndarray) -> int:
        """Add a vertex.

        Parameters
        ----------
        point : ndarray (3,) [mm]
        """
        self._vertices.append(point)
        return len(self._vertices) - 1

    def point(self, vertex: int) -> np.ndarray:
        """Point of a vertex.

        Returns
        -------
        ndarray (3,) [mm]
        """
        return self._vertices[vertex]

    def edge(self, curve: Curve, start: int, end: int) -> int:
        """Add an edge between two vertices."""
        self._edges.append(Edge(curve, start, end))
        return len(self._edges) - 1

    def face(self, surface: Surface, *loops: Loop, is_along: bool = True) -> None:
        """Add a face, whose loops run counter-clockwise seen from outside, the outer one first."""
        self._faces.append(Face(surface, loops, is_along))

    def add(self, body: Body) -> int:
        """Add the faces of a body with their edges and vertices, and return the index of its first edge."""
        first, at = len(self._edges), len(self._vertices)
        self._vertices += list(body.vertices)
        self._edges += [Edge(edge.curve, edge.start + at, edge.end + at) for edge in body.edges]
        for face in body.faces:
            loops = tuple(tuple((edge + first, is_forward) for edge, is_forward in loop) for loop in face.loops)
            self.face(face.surface, *loops, is_along=face.is_along)
        return first

    def body(self, name: str, is_closed: bool) -> Body:
        """The body."""
        return Body(name, np.array(self._vertices), tuple(self._edges), tuple(self._faces), is_closed)
