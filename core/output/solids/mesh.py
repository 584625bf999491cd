"""Triangles of bodies between planes, and STL files.

Sources: D. Eberly, *Triangulation by Ear Clipping*, 2002; the binary STL of 3D Systems, 1989.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import KindynaError
from core.numerics.derivatives import cross
from core.numerics.lazy import checkpoint
from core.output.solids.outline import polygon
from core.output.solids.patches import OR_STEP, TooFine
from core.output.solids.prism import Cap, Prism, in_space

MOST_VERTICES = 20_000  # of a plane face
SINGLE = 2.0**-24  # relative rounding of a number of four bytes
HEADER_BYTES = 80


def prism_triangles(prism: Prism, tolerance: float) -> np.ndarray:
    """Triangles of a prism, counter-clockwise seen from outside.

    Parameters
    ----------
    prism : Prism
    tolerance : float [mm]
        Largest distance of its walls from the triangles.

    Returns
    -------
    ndarray (n, 3, 3) [mm]
        Triangle, corner, coordinate.

    Raises
    ------
    TooFine
        The tolerance requires too many triangles.
    """
    polygons = [polygon(wall.outline, tolerance) for wall in prism.walls]
    triangles = [
        wall_triangles(points, wall.low, wall.high) for points, wall in zip(polygons, prism.walls, strict=True)
    ]
    triangles += [_cap(prism, cap, polygons, tolerance) for cap in prism.caps]
    return np.concatenate(triangles)


def wall_triangles(points: np.ndarray, low: float, high: float) -> np.ndarray:
    """Triangles of an upright wall on a closed polygon.

    Parameters
    ----------
    points : ndarray (n,) complex [mm]
        Corners, with the material on their left.
    low, high : float [mm]
        Heights of its rims.

    Returns
    -------
    ndarray (2 n, 3, 3) [mm]
        Counter-clockwise seen from outside.
    """
    start = np.stack((in_space(points, low), in_space(points, high)))
    end = np.roll(start, -1, axis=1)
    lower, upper = np.stack((start[0], end[0], end[1]), axis=1), np.stack((start[0], end[1], start[1]), axis=1)
    return np.concatenate((lower, upper))


def level_triangles(loops: Sequence[np.ndarray], height: float, is_up: bool, tolerance: float) -> np.ndarray:
    """Triangles of a face in a plane z = constant.

    Parameters
    ----------
    loops : sequence of ndarray (n,) complex [mm]
        The outer polygon, counter-clockwise seen from +z, then the holes, clockwise.
    height : float [mm]
    is_up : bool
        Whether the face is seen from +z; otherwise from -z.
    tolerance : float [mm]
        Of the file, for the error.

    Returns
    -------
    ndarray (m, 3, 3) [mm]
        Counter-clockwise seen from the side of the face.

    Raises
    ------
    TooFine
        The loops have too many corners.
    """
    points = np.concatenate(loops)
    if points.size > MOST_VERTICES:
        raise TooFine(tolerance, f"a face would have {points.size} corners, the limit is {MOST_VERTICES}", OR_STEP)
    corners = triangulate(loops)
    return in_space(points, height)[corners if is_up else corners[:, ::-1]]


def _cap(prism: Prism, cap: Cap, polygons: Sequence[np.ndarray], tolerance: float) -> np.ndarray:
    # an upper rim runs as its outline does, a lower one backwards; a face that looks down is mirrored by reversing all
    loops = [polygons[rim.wall] if rim.is_high == cap.is_up else polygons[rim.wall][::-1] for rim in cap.rims]
    return level_triangles(loops, prism.level(cap.rims[0]), cap.is_up, tolerance)


# -- triangles of a polygon with holes --------------------------------------------------------------------------


def triangulate(loops: Sequence[np.ndarray]) -> np.ndarray:
    """Triangles of a polygon with holes, by clipping ears.

    Parameters
    ----------
    loops : sequence of ndarray (n,) complex [mm]
        The outer polygon, counter-clockwise, then the holes, clockwise.

    Returns
    -------
    ndarray (m, 3), dimensionless
        Corners of m triangles, counter-clockwise: indices into the points of all loops in their order.
    """
    points = np.concatenate(loops)
    first = np.cumsum([0, *(loop.size for loop in loops[:-1])])
    rings = [np.arange(loop.size) + start for loop, start in zip(loops, first, strict=True)]
    outer, holes = rings[0], sorted(rings[1:], key=lambda ring: -points[ring].real.max())
    for hole in holes:
        outer = _with_hole(points, outer, hole)
    return _clip_ears(points, outer)


def _with_hole(points: np.ndarray, outer: np.ndarray, hole: np.ndarray) -> np.ndarray:
    """One ring that runs along the outer ring, across a bridge around the hole, and back.

    The bridge joins the rightmost point of the hole to a corner of the outer ring that it sees.
    """
    at = int(np.argmax(points[hole].real))
    eye = points[hole[at]]
    start, end = points[outer], points[np.roll(outer, -1)]
    crossing = np.flatnonzero((start.imag <= eye.imag) & (end.imag > eye.imag))  # of the ray to the right, from inside
    part = (eye.imag - start.imag[crossing]) / (end.imag[crossing] - start.imag[crossing])
    x = start.real[crossing] + part * (end.real[crossing] - start.real[crossing])
    x = np.where(x >= eye.real, x, np.inf)
    nearest = int(np.argmin(x))
    hit, edge = complex(x[nearest], eye.imag), int(crossing[nearest])
    ends = np.array([edge, (edge + 1) % outer.size])
    corner = int(ends[np.argmax(points[outer[ends]].real)])
    # another corner in the triangle from the eye hides that corner; the one at the least angle to the ray is seen
    triangle = np.array([eye, hit, points[outer[corner]]])
    if float(cross(triangle[1] - triangle[0], triangle[2] - triangle[0])) < 0.0:
        triangle = triangle[[0, 2, 1]]
    in_front = (start.real > eye.real) & (start != points[outer[corner]])  # a triangle of no height holds its line
    hiding = np.flatnonzero(_inside(start, triangle) & in_front)
    if hiding.size:
        slope = np.abs(start[hiding].imag - eye.imag) / np.maximum(start[hiding].real - eye.real, 1e-300)
        corner = int(hiding[np.lexsort((start[hiding].real, slope))[0]])
    ring = np.roll(hole, -at)
    return np.concatenate((outer[: corner + 1], ring, ring[:1], outer[corner:]))


def _inside(points: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Whether points (n,) are in a counter-clockwise triangle (3,), its sides included."""
    a, b, c = triangle
    return np.asarray(
        (cross(b - a, points - a) >= 0.0) & (cross(c - b, points - b) >= 0.0) & (cross(a - c, points - c) >= 0.0)
    )


def _clip_ears(points: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """Triangles (m, 3) of a ring of corners: an ear is a convex corner whose triangle holds no reflex corner."""
    z = points[ring]
    count = ring.size
    previous, following = [*range(-1, count - 1)], [*range(1, count + 1)]
    previous[0], following[-1] = count - 1, 0
    coordinates = z.tolist()

    def turn(i: int) -> float:
        a, b, c = coordinates[previous[i]], coordinates[i], coordinates[following[i]]
        return (b.real - a.real) * (c.imag - b.imag) - (b.imag - a.imag) * (c.real - b.real)

    is_reflex = cross(z - np.roll(z, 1), np.roll(z, -1) - z) <= 0.0
    ends_bridge = np.bincount(ring)[ring] > 1  # convex on both sides of the bridge, and yet in the way
    triangles: list[tuple[int, int, int]] = []
    at, refused, allow_flat = 0, 0, False
    while count > 3:
        a, b, c = previous[at], at, following[at]
        is_convex = not is_reflex[b] or (allow_flat and turn(b) >= 0.0)
        if is_convex and not _holds(
            z[is_reflex | ends_bridge], np.array([coordinates[a], coordinates[b], coordinates[c]])
        ):
            triangles.append((a, b, c))
            following[a], previous[c] = c, a
            is_reflex[b] = ends_bridge[b] = False
            for i in (a, c):
                is_reflex[i] = is_reflex[i] and turn(i) <= 0.0
            count -= 1
            refused, allow_flat = 0, False
            at = following[c]  # every second corner, so that triangles do not all meet in one
            if not len(triangles) % 512:
                checkpoint()
        else:
            at = c
            refused += 1
            if refused > count:
                if allow_flat:
                    raise KindynaError("the outline crosses itself: it has no triangles")
                refused, allow_flat = 0, True
    triangles.append((previous[at], at, following[at]))
    return ring[np.array(triangles)]


def _holds(corners: np.ndarray, triangle: np.ndarray) -> bool:
    """Whether one of these corners, other than those of the triangle, is in the triangle."""
    inside = corners[_inside(corners, triangle)]
    return bool(((inside != triangle[0]) & (inside != triangle[1]) & (inside != triangle[2])).any())


def bisected_triangles(triangles: np.ndarray, longest: float) -> np.ndarray:
    """Triangles bisected at their longest sides until none is longer than a length, for a drawing that sorts them by distance.

    Parameters
    ----------
    triangles : ndarray (n, 3, 3) [mm]
    longest : float [mm]

    Returns
    -------
    ndarray (m, 3, 3) [mm]
        With the same sense as before.
    """
    while True:
        sides = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
        is_long = sides.max(axis=1) > longest
        if not is_long.any():
            return triangles
        first, corners = sides[is_long].argmax(axis=1), triangles[is_long]
        rows = np.arange(first.size)
        a, b, c = (corners[rows, (first + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        halves = np.concatenate((np.stack((a, middle, c), axis=1), np.stack((middle, b, c), axis=1)))
        triangles = np.concatenate((triangles[~is_long], halves))


# -- STL --------------------------------------------------------------------------------------------------------


def stl_rounding(triangles: np.ndarray) -> float:
    """Largest distance by which an STL file rounds corners within a size.

    Parameters
    ----------
    triangles : ndarray (n, 3, 3) [mm]

    Returns
    -------
    float [mm]
    """
    return float(np.sqrt(3.0) * SINGLE * np.abs(triangles).max())


def stl_bytes(name: str, triangles: np.ndarray) -> bytes:
    """A binary STL file.

    Parameters
    ----------
    name : str
        Text of its header; other characters than ASCII are replaced.
    triangles : ndarray (n, 3, 3) [mm]
        Triangle, corner, coordinate; counter-clockwise seen from outside.
    """
    corners = triangles.astype("<f4")
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("about", "<u2")])
    rounded = corners.astype(float)
    normal = np.cross(rounded[:, 1] - rounded[:, 0], rounded[:, 2] - rounded[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    rows["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    rows["corners"] = corners
    header = f"STL {name}".encode("ascii", "replace")[:HEADER_BYTES].ljust(HEADER_BYTES)
    return header + np.uint32(len(rows)).astype("<u4").tobytes() + rows.tobytes()
