"""Walls of a groove: where two far stretches of it come nearest to each other."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import Any

import numpy as np

from core.cam.shape import OUTER, CamShape
from core.cam.sizes import ENTRIES
from core.findings import ERROR, Finding
from core.frozen import frozen
from core.motion import TURN, Angles
from core.numerics.vectors import dot

POINTS = 360  # of the turn, at which stretches that come near are looked for
GRID = 4  # points on either side of the middle, as the search closes in
CLOSER = 0.3  # of its width each time
FINEST = 1e-9  # [rad]

ShapeAt = Callable[[np.ndarray], CamShape]


@frozen
class Wall:
    """What is left between two stretches of a groove: its thickness [m], less than 0 where they run into each other, and the two
    cam angles [rad]."""

    thickness: float
    first: float
    second: float


def thinnest_wall(shape_at: ShapeAt, found: CamShape, angles: Angles) -> Wall | None:
    """The thinnest wall that is gone, of two stretches that face each other; None where all stand.

    Two stretches face each other where the distance D of their pitch curves is a local minimum of both cam angles: there it is
    normal to both. Between them stand D less Rr on the side of each inner flank and Rr + play on that of each outer one.
    shape_at: the cam at any cam angles; found, angles: at equally spaced ones, of which some are taken.
    """
    step = max(1, angles.theta.size // POINTS)
    theta = angles.theta[::step]
    place, _, reach = _pitch(found, angles, step)
    distance = np.abs(place[None, :] - place[:, None])
    rows, columns = np.nonzero(np.triu(distance <= 2.0 * max(reach), 1))
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for sign in (1, -1):
            beside = distance[(rows + sign * down) % theta.size, (columns + sign * right) % theta.size]
            lowest = distance[rows, columns] <= beside
            rows, columns = rows[lowest], columns[lowest]
    if not rows.size:
        return None
    at = int(np.argmin(distance[rows, columns]))
    i, j = rows[at], columns[at]
    wall = _refined(shape_at, float(theta[i]), float(theta[j]), TURN * step / angles.theta.size)
    return (
        Wall(wall.thickness, min(wall.first, wall.second), max(wall.first, wall.second))
        if wall.thickness <= 0.0
        else None
    )


def _pitch(shape: CamShape, angles: Angles, step: int = 1) -> tuple[np.ndarray, np.ndarray, tuple[float, float]]:
    """Pitch curve and normal towards the inner flank, both in the cam's own frame, and how far the flanks are from it."""
    inner = shape.flank
    back = angles.unit.conj() if shape.sense > 0.0 else angles.unit
    return inner.pitch[::step], (inner.normal * back)[::step], (inner.offset, -shape.only(OUTER).flank.offset)


def _thickness(near: np.ndarray, one: np.ndarray, other: np.ndarray, reach: tuple[float, float]) -> np.ndarray:
    """Of the wall between points of the pitch curve with the differences ``near`` (m, n) and normals (m,), (n,)."""
    inner, outer = reach
    first = np.where(dot(one[:, None], near) > 0.0, inner, outer)
    second = np.where(dot(other[None, :], near) < 0.0, inner, outer)
    return np.asarray(np.abs(near) - first - second)


def _refined(shape_at: ShapeAt, first: float, second: float, width: float) -> Wall:
    """The least distance near two cam angles, by a grid that closes in on it."""
    steps = np.arange(-GRID, GRID + 1) / GRID
    thickness = np.inf
    while width > FINEST:
        theta = np.concatenate((first + width * steps, second + width * steps)) % TURN
        shape = shape_at(theta)
        place, towards, reach = _pitch(shape, Angles(theta, np.zeros(theta.size, dtype=int)))
        half = steps.size
        near = place[None, half:] - place[:half, None]
        i, j = np.unravel_index(int(np.argmin(np.abs(near))), near.shape)
        thickness = float(_thickness(near, towards[:half], towards[half:], reach)[i, j])
        first, second, width = float(theta[i]), float(theta[half + j]), width * CLOSER
    return Wall(thickness, first, second)


def wall_findings(wall: Wall | None, cam: Any) -> list[Finding]:
    """Two stretches of a groove that run into each other."""
    if wall is None:
        return []
    values: dict[str, float | str] = {"overlap_mm": -1e3 * wall.thickness, "other_deg": degrees(wall.second)}
    return [Finding("groove-flanks-meet", ERROR, ENTRIES[type(cam)].size, degrees(wall.first), values)]
