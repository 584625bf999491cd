"""Thickness of the rib between two rollers: the least distance between the points of its two flanks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

from core.spatial.contact import AHEAD, BEHIND, MotionRows, SpatialFlank, dots, flank, turned
from core.spatial.kinds import Machine
from core.spatial.shape import rollers_at

State = Callable[[np.ndarray], MotionRows]
"""Motion at cam angles (n,) [rad], which may be outside of one turn."""

OFFSETS = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 37)  # [rad] from a point of one flank to the first points of the other
ROWS = 3  # distances along the roller of these points
STEPS = 20  # of Newton's method
SMALL = 1e-6  # last step, as a part of the roller's outer distance; the least distance is exact to its square
LEAST = 1e-6  # second derivative, relative to lengths along the flanks
AT_ONCE = 1000  # cam angles


def rib_thickness(machine: Machine, motion: MotionRows, state: State, sense: float, refined: bool = True) -> np.ndarray:
    """Least thickness of the ribs between neighbouring rollers, d = min |p_behind(θ', u') - p_ahead(θ, u)| over θ', u' and u.

    Parameters
    ----------
    machine : Machine
    motion : MotionRows
        Cam angles θ (n,) of the flank ahead, and the motion of the design there.
    state : callable
    sense : float
        Sense of rotation, ±1.
    refined : bool
        Without it a lower bound, from the distances of a few points of each flank and their spacing.

    Returns
    -------
    ndarray (n,) [m]
        Negative where the flanks cross; NaN where fewer than two rollers are in the blank.
    """
    result = np.full(motion.theta.size, np.nan)
    for lower, upper in pairwise(rollers_at(machine, motion.y)):
        for at in _portions(np.flatnonzero(lower.touches & upper.touches)):
            near = MotionRows(*(row[at] for row in motion)).shifted(lower.offset[at])
            result[at] = np.fmin(result[at], _distances(machine, near, upper.offset[at], state, sense, refined))
    return result


def _portions(indices: np.ndarray) -> Iterator[np.ndarray]:
    yield from (indices[start : start + AT_ONCE] for start in range(0, indices.size, AT_ONCE))


def _distances(
    machine: Machine, near: MotionRows, offset: np.ndarray, state: State, sense: float, refined: bool
) -> np.ndarray:
    """Least distance (n,) [m] of the flank ahead of a roller from the flank behind another one, of a given offset (n,)."""
    n, grid = near.theta.size, near.theta + OFFSETS[:, None]
    nodes = np.linspace(machine.inner, machine.outer, ROWS)
    rows = MotionRows(*(row.reshape(grid.shape) for row in state(grid.ravel()))).shifted(offset)
    far = flank(machine, MotionRows(*(row.ravel() for row in rows)), nodes[:, None], sense, BEHIND).cam_point
    points = flank(machine, near, nodes[:, None], sense, AHEAD).cam_point
    away = far.reshape(3, 1, -1, n) - points[:, :, None]
    square = np.nan_to_num(dots(away, away), nan=np.inf)  # a cone may have no line of contact at some angles
    if not refined:
        steps = (np.diff(far.reshape(3, ROWS, *grid.shape), axis=axis) for axis in (1, 2))
        between, along = (0.5 * np.sqrt(np.nanmax(dots(step, step))) for step in steps)
        return np.asarray(np.sqrt(square.min(axis=(0, 1))) - between - np.hypot(between, along))
    row, turn = np.unravel_index(np.argmin(square, axis=1).ravel(), (ROWS, OFFSETS.size))
    column = np.tile(np.arange(n), ROWS)

    def flanks_at(theta: np.ndarray, u: np.ndarray, part: np.ndarray) -> tuple[SpatialFlank, SpatialFlank]:
        at = column[part]
        ahead = flank(machine, MotionRows(*(row[at] for row in near)), u[:1], sense, AHEAD)
        return ahead, flank(machine, state(theta).shifted(offset[at]), u[1:], sense, BEHIND)

    place = np.stack((grid[turn, column], np.repeat(nodes, n), nodes[row]))
    everywhere = np.arange(place.shape[1])
    result = _least_distance(flanks_at, everywhere, place, machine, along=False)
    apart = everywhere[result > 0.0]
    result[apart] = np.minimum(result[apart], _least_distance(flanks_at, apart, place, machine, along=True))
    least = result.reshape(ROWS, n).min(axis=0)
    return np.where(np.isfinite(least), least, np.nan)


def _least_distance(
    flanks_at: Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[SpatialFlank, SpatialFlank]],
    part: np.ndarray, place: np.ndarray, machine: Machine, along: bool,
) -> np.ndarray:  # fmt: skip
    """Least distance (k,) [m] of two flanks by Newton's method from places θ', u and u' (3, n); negative where they cross.

    ``part`` are the indices (k,) of the places, which become those of the distances; ``along``: whether u varies as well. With p and q the
    points of both flanks and d = (p - q) · n of the normal n at q, the second derivatives of half the square of the distance are
    p_u · p_u + d m_u · p_u, with the normal m at p, q_i · q_j + d n_i · q_j, and -p_u · q_i.
    """
    result, started = np.full(place.shape[1], np.inf), part
    for _ in range(STEPS):
        theta, u = place[0, part], place[1:, part]
        ahead, behind = flanks_at(theta, u, part)
        turn = behind.sense * (theta - ahead.theta)
        p, p_u, m_u = (turned(row[:, 0], turn) for row in (ahead.point, ahead.by_u, ahead.normal_by_u))
        q, q_1, q_2 = (row[:, 0] for row in (behind.point, behind.by_theta, behind.by_u))
        n, n_1, n_2 = (row[:, 0] for row in (behind.normal, behind.normal_by_theta, behind.normal_by_u))
        size, depth = np.sqrt(dots(p - q, p - q)), dots(p - q, n)
        result[part] = np.where(size < np.abs(result[part]), np.copysign(size, depth), result[part])
        moves = np.stack((-q_1, p_u, -q_2))  # derivatives of p - q by θ', u and u'
        slope = np.stack([dots(p - q, move) for move in moves])
        second = np.array([[dots(a, b) for b in moves] for a in moves])
        for i, j, change in (
            (0, 0, dots(n_1, q_1)),
            (0, 2, dots(n_1, q_2)),
            (2, 0, dots(n_1, q_2)),
            (1, 1, dots(m_u, p_u)),
            (2, 2, dots(n_2, q_2)),
        ):
            second[i, j] += depth * change
        sizes = np.sqrt(dots(moves.swapaxes(0, 1), moves.swapaxes(0, 1)))
        fixed = ((u <= machine.inner) & (slope[1:] > 0.0)) | ((u >= machine.outer) & (slope[1:] < 0.0))
        fixed[0] |= not along
        step = _newton_step(slope / sizes, second / (sizes * sizes[:, None]), fixed) / sizes
        step[0] = np.clip(step[0], OFFSETS[0] - OFFSETS[1], OFFSETS[1] - OFFSETS[0])
        step[1:] = np.clip(u + step[1:], machine.inner, machine.outer) - u
        place[:, part] += step
        part = part[np.abs(step * sizes).max(axis=0) > SMALL * machine.outer]  # not where the step is NaN
        if not part.size:
            break
    result[np.abs(result) <= SMALL * machine.outer] = 0.0
    return result[started]


def _newton_step(slope: np.ndarray, second: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Step (3, k) by slope (3, k) and second derivatives (3, 3, k), downhill also where these are not positive.

    The last two variables stay where they are ``fixed`` (2, k).
    """
    free = np.concatenate((np.ones_like(fixed[:1]), ~fixed))
    solvable = np.isfinite(second).all(axis=(0, 1))
    matrix = np.where(free & free[:, None] & solvable, second, np.eye(3)[..., None])
    values, vectors = np.linalg.eigh(np.moveaxis(matrix, -1, 0))
    along = np.einsum("kij,ik->kj", vectors, np.where(free, slope, 0.0))
    return -np.einsum("kij,kj->ik", vectors, along / np.maximum(np.abs(values), LEAST))
