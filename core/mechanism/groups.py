"""Groups of links that are no dyads: Newton on the loop equations, from the neighbouring position.

Unknown are the poses of all links of the group, three numbers each, lengths in units of the linkage's size. Every pair
gives two equations, so that the matrix J is square; it serves positions, three derivatives and forces alike.
"""

from __future__ import annotations

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import Pose
from core.mechanism.loop_closure import Bodies, line_of
from core.mechanism.plan import Joint
from core.numerics.derivatives import difference, product
from core.numerics.vectors import cross, dot

STEPS = 30  # of Newton; from the neighbouring position two or three do
NEAR = 1e-9  # after a correction this small, relative to the size, the next would be rounding


@frozen
class LinkGroup:
    """Links solved together: their numbers and all their pairs; size [m] of the linkage."""

    links: tuple[int, ...]
    joints: tuple[Joint, ...]
    size: float


@frozen(eq=False)
class GroupSolution:
    """A solved group: poses by link, J (n, 3m, 3m), its determinant relative to its rows' lengths (n,) with its sign."""

    poses: dict[int, Pose]
    matrix: np.ndarray
    determinant: np.ndarray


def newton(group: LinkGroup, known: Bodies, start: np.ndarray, steps: int = STEPS) -> tuple[np.ndarray, np.ndarray]:
    """From ``start`` (3m, n) to a position that closes: coordinates (3m, n) and the last correction (n,)."""
    x = start.copy()
    last = np.full(x.shape[1], np.inf)
    for _ in range(steps):
        bodies = {**known, **_poses(group, _at_rest(x))}
        change = _solve(_matrix(group, bodies), -_opening(group, bodies, 0))
        length = np.abs(change).max(axis=0)
        change *= np.minimum(1.0, 0.5 / np.maximum(length, 1e-300))  # half a radian, or half the size, at once
        x += change
        last = length
        if not (length > NEAR).any():
            break
    return x, last


def group_solution(group: LinkGroup, known: Bodies, x: np.ndarray) -> GroupSolution:
    """Poses with three derivatives from coordinates that close (3m, n)."""
    states = _at_rest(x)
    matrix = _matrix(group, {**known, **_poses(group, states)})
    lengths = np.sqrt((matrix * matrix).sum(axis=2)).prod(axis=1)
    determinant = np.linalg.det(matrix) / lengths
    for order in (1, 2, 3):
        states[order] = _solve(matrix, -_opening(group, {**known, **_poses(group, states)}, order))
    return GroupSolution(_poses(group, states), matrix, determinant)


def _poses(group: LinkGroup, states: np.ndarray) -> dict[int, Pose]:
    """Poses at coordinates with three derivatives (4, 3m, n)."""
    return {
        link: Pose.of(group.size * (states[:, 3 * i] + 1j * states[:, 3 * i + 1]), states[:, 3 * i + 2])
        for i, link in enumerate(group.links)
    }


def _at_rest(x: np.ndarray) -> np.ndarray:
    """Coordinates (3m, n) that do not change (4, 3m, n)."""
    return np.stack([x, *3 * [np.zeros_like(x)]])


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """matrix (n, m, m), right (m, n) -> (m, n); where it is singular, a step of least squares."""
    try:
        return np.linalg.solve(matrix, right.T[..., None])[..., 0].T
    except np.linalg.LinAlgError:
        return np.einsum("nij,jn->in", np.linalg.pinv(matrix), right)


def _opening(group: LinkGroup, bodies: Bodies, order: int) -> np.ndarray:
    """How far every pair is open (3m, n), lengths in units of the size; or the derivative of this order, 1 ... 3, by what is
    known of the rates so far."""
    rows: list[np.ndarray] = []
    for joint in group.joints:
        a, b = (line_of(bodies, held) for held in (joint.first, joint.second))
        gap = difference(b[0], a[0])
        if joint.revolute:
            rows += [gap[order].real / group.size, gap[order].imag / group.size]
            continue
        turn = bodies[joint.second.link].turn[order] - bodies[joint.first.link].turn[order]
        if not order:
            turn = turn + np.angle(joint.second.along / joint.first.along)
            turn = np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi
        rows += [turn, product(a[1], gap, cross)[order] / group.size]
    return np.array(np.broadcast_arrays(*rows))


def _matrix(group: LinkGroup, bodies: Bodies) -> np.ndarray:
    """J (n, 3m, 3m): how each pair opens with each coordinate."""
    n = max(pose.origin[0].size for pose in bodies.values())
    size = 3 * len(group.links)
    matrix = np.zeros((n, size, size))
    for row, joint in enumerate(group.joints):
        first, second = 2 * row, 2 * row + 1
        if not joint.revolute:
            a, b = (line_of(bodies, held) for held in (joint.first, joint.second))
            direction, gap = a[1][0], b[0][0] - a[0][0]
        for held, sign in ((joint.first, -1.0), (joint.second, 1.0)):
            if held.link not in group.links:
                continue
            at = 3 * group.links.index(held.link)
            arm = 1j * held.point * bodies[held.link].unit / group.size
            if joint.revolute:
                matrix[:, first, at] = matrix[:, second, at + 1] = sign
                matrix[:, first, at + 2], matrix[:, second, at + 2] = sign * arm.real, sign * arm.imag
            else:
                matrix[:, first, at + 2] = sign
                matrix[:, second, at], matrix[:, second, at + 1] = -sign * direction.imag, sign * direction.real
                matrix[:, second, at + 2] = sign * cross(direction, arm)
                if sign < 0.0:  # the line turns with its link
                    matrix[:, second, at + 2] -= dot(direction, gap) / group.size
    return matrix
