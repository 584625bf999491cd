"""Bodies between planes z = constant: walls that rise from outlines, and the plane faces that close them."""

from __future__ import annotations

import numpy as np

from core.frozen import frozen
from core.output.solids.body import (
    Body,
    CircleCurve,
    Curve,
    CylinderSurface,
    Edge,
    Face,
    KnotVector,
    LineCurve,
    Loop,
    PlaneSurface,
    SplineCurve,
    SplineSurface,
    Surface,
)
from core.output.solids.outline import DEGREE, Arc, Line, Outline, Spline, area

UP = np.array([0.0, 0.0, 1.0])


@frozen(eq=False)
class Wall:
    """A wall on an outline, from z = low to z = high [mm]; the material is on the left of the outline."""

    outline: Outline
    low: float
    high: float


@frozen
class Rim:
    """Lower or upper rim of a wall, which is given by its index."""

    wall: int
    is_high: bool


@frozen
class Cap:
    """A plane face between rims, the outer one first; ``is_up``: its outward normal is +z, otherwise -z."""

    is_up: bool
    rims: tuple[Rim, ...]


@frozen(eq=False)
class Prism:
    """A body of walls and caps; without caps an open sheet."""

    name: str
    walls: tuple[Wall, ...]
    caps: tuple[Cap, ...] = ()

    @property
    def volume(self) -> float:
        """Sum of area times height of the walls [mm³]; the outline of a hole has a negative area."""
        return sum(area(wall.outline) * (wall.high - wall.low) for wall in self.walls)

    def level(self, rim: Rim) -> float:
        """Height of a rim [mm]."""
        wall = self.walls[rim.wall]
        return wall.high if rim.is_high else wall.low

    @property
    def body(self) -> Body:
        """Vertices, edges and faces of the prism.

        A wall of n pieces has 2n vertices and 3n edges: those of the lower rim, of the upper rim, and upright ones. A cap
        runs through the edges of an upper rim forwards, of a lower rim backwards.
        """
        vertices: list[np.ndarray] = []
        edges: list[Edge] = []
        faces: list[Face] = []
        rims: dict[Rim, Loop] = {}
        for index, wall in enumerate(self.walls):
            count, vertex, edge = len(wall.outline), sum(map(len, vertices)), len(edges)
            corners = np.array([piece.start for piece in wall.outline])
            low, high, upright = (
                [(first + i, True) for i in range(count)] for first in (edge, edge + count, edge + 2 * count)
            )
            for z, first in ((wall.low, vertex), (wall.high, vertex + count)):
                vertices.append(in_space(corners, z))
                edges += [
                    Edge(_curve(piece, z), first + i, first + (i + 1) % count) for i, piece in enumerate(wall.outline)
                ]
            edges += [Edge(LineCurve(), vertex + i, vertex + count + i) for i in range(count)]
            for i, piece in enumerate(wall.outline):
                loop = (low[i], upright[(i + 1) % count], _backwards(high[i]), _backwards(upright[i]))
                surface, is_along = _surface(piece, wall)
                faces.append(Face(surface, (loop,), is_along))
            rims[Rim(index, True)] = tuple(high)
            rims[Rim(index, False)] = tuple(_backwards(step) for step in reversed(low))
        for cap in self.caps:
            plane = PlaneSurface(np.array([0.0, 0.0, self.level(cap.rims[0])]), UP if cap.is_up else -UP)
            faces.append(Face(plane, tuple(rims[rim] for rim in cap.rims)))
        return Body(self.name, np.concatenate(vertices), tuple(edges), tuple(faces), bool(self.caps))


def _backwards(step: tuple[int, bool]) -> tuple[int, bool]:
    edge, is_forward = step
    return edge, not is_forward


def in_space(z: np.ndarray, height: float) -> np.ndarray:
    """Points of a plane z = constant.

    Parameters
    ----------
    z : ndarray (...) complex [mm]
    height : float [mm]

    Returns
    -------
    ndarray (..., 3) [mm]
    """
    return np.stack((z.real, z.imag, np.full(z.shape, height)), axis=-1)


def _point(z: complex, height: float) -> np.ndarray:
    return np.array([z.real, z.imag, height])


def _curve(piece: Line | Arc | Spline, height: float) -> Curve:
    if isinstance(piece, Line):
        return LineCurve()
    if isinstance(piece, Arc):
        return CircleCurve(_point(piece.centre, height), UP if piece.sweep > 0.0 else -UP, piece.radius)
    return SplineCurve(KnotVector(DEGREE, *piece.knots), in_space(piece.points, height))


def _surface(piece: Line | Arc | Spline, wall: Wall) -> tuple[Surface, bool]:
    """Surface over a piece, and whether its normal points to the right of the piece, out of the material."""
    if isinstance(piece, Line):
        out = -1j * (piece.end - piece.start) / abs(piece.end - piece.start)
        return PlaneSurface(_point(piece.start, wall.low), _point(out, 0.0)), True
    if isinstance(piece, Arc):
        return CylinderSurface(_point(piece.centre, wall.low), UP, piece.radius), piece.sweep > 0.0
    across = KnotVector(1, np.array([0.0, wall.high - wall.low]), (2, 2))
    points = np.stack([in_space(piece.points, height) for height in (wall.low, wall.high)], axis=1)
    return SplineSurface(KnotVector(DEGREE, *piece.knots), across, points), True
