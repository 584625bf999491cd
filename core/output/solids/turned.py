"""Surfaces around the axis of a cam in space: faces and triangles between rims, and the ends of its blank with bore and keyway.

A rim runs counter-clockwise seen from +z. A face around the axis is in two halves, so that no edge ends where it begins; the
edges between both halves are its seams.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, ceil, pi

import numpy as np

from core.output.solids.body import (
    BodyBuilder,
    CircleCurve,
    KnotVector,
    LineCurve,
    Loop,
    PlaneSurface,
    SplineCurve,
    Surface,
    reversed_loop,
)
from core.output.solids.mesh import level_triangles, wall_triangles
from core.output.solids.outline import Outline, polygon
from core.output.solids.patches import greville, spline_through
from core.output.solids.prism import UP, Prism, Wall

UPRIGHT = 1e-9  # [mm] around the cylinder, from which a seam is no straight line
HELIX = KnotVector(5, np.linspace(0.0, 1.0, 4), (6, 1, 1, 6))

Halves = tuple[Loop, Loop]
"""A rim from the first seam to the second, and from there to the first."""

# -- faces ------------------------------------------------------------------------------------------------------


def circle_rim(
    builder: BodyBuilder, radius: float, height: float, angles: Sequence[float]
) -> tuple[tuple[int, int], Halves]:
    """Vertices of a circle about the axis at two polar angles [rad], and its halves."""
    first, second = (
        builder.vertex(np.array([radius * np.cos(angle), radius * np.sin(angle), height])) for angle in angles
    )
    curve = CircleCurve(np.array([0.0, 0.0, height]), UP, radius)
    return (first, second), (
        ((builder.edge(curve, first, second), True),),
        ((builder.edge(curve, second, first), True),),
    )


def cylinder_seam(builder: BodyBuilder, low: int, high: int) -> int:
    """Edge between two vertices on a cylinder about the axis: a straight line, at different polar angles a helix."""
    start, end = builder.point(low), builder.point(high)
    polar, radius = (np.arctan2(*p[1::-1]) for p in (start, end)), [float(np.hypot(*p[:2])) for p in (start, end)]
    first, last = polar
    turn = float(np.mod(last - first + pi, 2.0 * pi) - pi)
    if abs(turn) * radius[0] <= UPRIGHT:
        return builder.edge(LineCurve(), low, high)
    part = greville(HELIX)
    angle, size = first + turn * part, np.interp(part, (0.0, 1.0), radius)
    points = np.stack(
        (size * np.cos(angle), size * np.sin(angle), np.interp(part, (0.0, 1.0), (start[2], end[2]))), axis=-1
    )
    return builder.edge(SplineCurve(HELIX, spline_through(HELIX, part, points)), low, high)


def add_band(
    builder: BodyBuilder, surface: Surface, lower: Halves, upper: Halves, seams: Sequence[int], is_along: bool = True
) -> None:
    """Add both halves of a face between two rims; the seams run from the lower to the upper one."""
    for k in (0, 1):
        loop = (*lower[k], (seams[1 - k], True), *reversed_loop(upper[k]), (seams[k], False))
        builder.face(surface, loop, is_along=is_along)


def add_ends(builder: BodyBuilder, rims: tuple[Halves, Halves], heights: tuple[float, float], hole: Outline) -> None:
    """Add the flat ends of a blank with these rims at two heights [mm], and the walls of its bore."""
    low, high = ([*rim[0], *rim[1]] for rim in rims)
    loops: list[list[Loop]] = [[reversed_loop(tuple(low))], [tuple(high)]]
    if hole:
        first, count = builder.add(Prism("", (Wall(hole, *heights),)).body), len(hole)
        loops[0].append(tuple((first + i, False) for i in reversed(range(count))))
        loops[1].append(tuple((first + count + i, True) for i in range(count)))
    for height, normal, around in zip(heights, (-UP, UP), loops, strict=True):
        builder.face(PlaneSurface(np.array([0.0, 0.0, height]), normal), *around)


# -- triangles --------------------------------------------------------------------------------------------------


def chord_angle(radius: float, tolerance: float) -> float:
    """Angle [rad] of a chord whose distance from its circle is the tolerance, 2 acos(1 - e/r)."""
    return 2.0 * acos(max(1.0 - tolerance / radius, 0.5))


def circle_points(radius: float, height: float, tolerance: float, count: int = 0) -> np.ndarray:
    """Corners of a circle about the axis, so many that chords keep a tolerance [mm] unless their number is given.

    Returns
    -------
    ndarray (n, 3) [mm]
    """
    n = count or ceil(2.0 * pi / chord_angle(radius, tolerance))
    angle = 2.0 * pi * np.arange(n) / n
    return np.stack((radius * np.cos(angle), radius * np.sin(angle), np.full(n, height)), axis=-1)


def paired_triangles(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Triangles between rims that have their corners in pairs.

    Parameters
    ----------
    lower, upper : ndarray (n, 3) [mm]
        Corners of closed rims.

    Returns
    -------
    ndarray (2 n, 3, 3) [mm]
        Counter-clockwise seen from outside.
    """
    low, high = np.roll(lower, -1, axis=0), np.roll(upper, -1, axis=0)
    return np.concatenate((np.stack((lower, low, high), axis=1), np.stack((lower, high, upper), axis=1)))


def zipped_triangles(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Triangles between rims on a cylinder, whose next corner is always the one at the smaller polar angle.

    Parameters
    ----------
    lower, upper : ndarray (n, 3), (m, 3) [mm]
        Corners of closed rims, with rising polar angle.

    Returns
    -------
    ndarray (n + m, 3, 3) [mm]
        Counter-clockwise seen from outside; none is wider than the widest step of the rims.
    """
    low, high = (np.arctan2(rim[:, 1], rim[:, 0]) for rim in (lower, upper))
    away = np.mod(high - low[0] + pi, 2.0 * pi) - pi
    start = int(np.abs(away).argmin())
    upper = np.roll(upper, -start, axis=0)
    angles = [np.append(np.unwrap(low), low[0] + 2.0 * pi), np.unwrap(np.roll(high, -start))]
    angles[1] += low[0] + away[start] - angles[1][0]
    angles[1] = np.append(angles[1], angles[1][0] + 2.0 * pi)
    is_upper = np.repeat([False, True], [len(lower), len(upper)])
    order = np.argsort(np.concatenate((angles[0][1:], angles[1][1:])), kind="stable")
    is_upper = is_upper[order]
    i, j = np.cumsum(~is_upper), np.cumsum(is_upper)  # corners reached
    a, b = lower[i % len(lower)], upper[j % len(upper)]
    before = np.where(is_upper[:, None], upper[(j - 1) % len(upper)], lower[(i - 1) % len(lower)])
    return np.where(is_upper[:, None, None], np.stack((a, b, before), axis=1), np.stack((before, a, b), axis=1))


def end_triangles(low: np.ndarray, high: np.ndarray, hole: Outline, tolerance: float) -> np.ndarray:
    """Triangles of the flat ends of a blank and of its bore.

    Parameters
    ----------
    low, high : ndarray (n, 3) [mm]
        Rims of both ends.
    hole : Outline
        Bore with its keyway; empty without one.
    tolerance : float [mm]

    Returns
    -------
    ndarray (m, 3, 3) [mm]
        Counter-clockwise seen from outside.
    """
    holes = [polygon(hole, tolerance)] if hole else []
    parts = [wall_triangles(points, low[0, 2], high[0, 2]) for points in holes]
    for rim, is_up in ((low, False), (high, True)):
        parts.append(level_triangles([rim[:, 0] + 1j * rim[:, 1], *holes], rim[0, 2], is_up, tolerance))
    return np.concatenate(parts)
