"""Groups of links that are no dyads: Newton's method on the loop equations, from the neighbouring position.

The unknowns are the poses of all links of the group, three numbers each, with lengths in units of the linkage's size. Every pair
gives two equations, and the driving pair one more. The Jacobian J is square; for redundant links it has more rows, and least
squares solve the equations where these are consistent. The same J gives the position and its three derivatives.
"""

from __future__ import annotations

import numpy as np

from core.frozen import frozen
from core.mechanism.dyads import Bodies, line_of
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import Joint, LinkGroup
from core.numerics.derivatives import Derivatives, cross, difference, dot, product

STEPS = 30  # of Newton's method; two or three are enough from the neighbouring position
CONSISTENT = 1e-9  # of the size: redundant pairs whose gaps are smaller are consistent
NEAR = 1e-9  # after a correction this small, relative to the size, the next one is only rounding


@frozen(eq=False)
class GroupSolution:
    """A solved group of links.

    Attributes
    ----------
    poses : dict of int to Pose
        Pose of each link, by its number.
    matrix : ndarray (n, rows, 3m), dimensionless
        Jacobian J of the loop equations of m links.
    determinant : ndarray (n,), dimensionless
        Signed determinant of J, divided by the lengths of its rows; for a redundant group the product of its singular values.
    """

    poses: dict[int, Pose]
    matrix: np.ndarray
    determinant: np.ndarray


def newton(
    group: LinkGroup, known: Bodies, q: Derivatives, start: np.ndarray, steps: int = STEPS
) -> tuple[np.ndarray, np.ndarray]:
    """Position of a group that closes all its pairs, by Newton's method.

    Parameters
    ----------
    group : LinkGroup
    known : mapping of int to Pose
        Poses of the links already solved.
    q : Derivatives
        Position of the driver (n,) [rad or m].
    start : ndarray (3m, n), dimensionless
        First guess: x and y in units of the size, and angle [rad], of each of the m links.
    steps : int
        Most iterations.

    Returns
    -------
    coordinates : ndarray (3m, n), dimensionless
        The solution, in the form of `start`.
    correction : ndarray (n,), dimensionless
        Largest last correction; infinite where redundant pairs are inconsistent.
    """
    x = start.copy()
    last = np.full(x.shape[1], np.inf)
    for _ in range(steps):
        bodies = {**known, **_poses(group, _at_rest(x))}
        gaps = _gaps(group, bodies, q, 0)
        change = _solve(_matrix(group, bodies), -gaps)
        length = np.abs(change).max(axis=0)
        change *= np.minimum(1.0, 0.5 / np.maximum(length, 1e-300))  # half a radian, or half the size, at once
        x += change
        last = length
        if not (length > NEAR).any():
            break
    if gaps.shape[0] > x.shape[0]:
        gaps = _gaps(group, {**known, **_poses(group, _at_rest(x))}, q, 0)
        last = np.where(np.abs(gaps).max(axis=0) <= CONSISTENT, last, np.inf)
    return x, last


def group_solution(group: LinkGroup, known: Bodies, q: Derivatives, x: np.ndarray) -> GroupSolution:
    """Poses with three derivatives, by differentiating the loop equations: J x⁽ᵏ⁾ = right side of order k.

    Parameters
    ----------
    group : LinkGroup
    known : mapping of int to Pose
        Poses of the links already solved.
    q : Derivatives
        Position of the driver (n,) [rad or m].
    x : ndarray (3m, n), dimensionless
        Coordinates that close all pairs, as from `newton`.

    Returns
    -------
    GroupSolution
    """
    states = _at_rest(x)
    matrix = _matrix(group, {**known, **_poses(group, states)})
    lengths = np.sqrt((matrix * matrix).sum(axis=2)).prod(axis=1)
    square = matrix.shape[1] == matrix.shape[2]
    with np.errstate(invalid="ignore"):
        determinant = (np.linalg.det(matrix) if square else _singular_value_product(matrix)) / lengths
    for order in (1, 2, 3):
        states[order] = _solve(matrix, -_gaps(group, {**known, **_poses(group, states)}, q, order))
    return GroupSolution(_poses(group, states), matrix, determinant)


def _singular_value_product(matrix: np.ndarray) -> np.ndarray:
    """Product of the singular values (n,) of (n, rows, m): zero where the links can move with the driver at rest."""
    failed = ~np.isfinite(matrix).all(axis=(1, 2))
    product = np.linalg.svd(np.where(failed[:, None, None], 0.0, matrix), compute_uv=False).prod(axis=1)
    return np.asarray(np.where(failed, np.nan, product))


def _poses(group: LinkGroup, states: np.ndarray) -> dict[int, Pose]:
    """Poses of the links at coordinates with three derivatives (4, 3m, n)."""
    return {
        link: Pose.of(group.size * (states[:, 3 * i] + 1j * states[:, 3 * i + 1]), states[:, 3 * i + 2])
        for i, link in enumerate(group.links)
    }


def _at_rest(x: np.ndarray) -> np.ndarray:
    """Coordinates (3m, n) with zero derivatives (4, 3m, n)."""
    return np.stack([x, *3 * [np.zeros_like(x)]])


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solution (m, n) of matrix (n, rows, m) and right side (rows, n); by least squares with more rows, or where singular."""
    if matrix.shape[1] > matrix.shape[2]:
        q, r = np.linalg.qr(matrix)
        right = np.einsum("nij,in->jn", q, right)
        matrix = r
    try:
        return np.linalg.solve(matrix, right.T[..., None])[..., 0].T
    except np.linalg.LinAlgError:
        return np.einsum("nij,jn->in", np.linalg.pinv(matrix), right)


def _gaps(group: LinkGroup, bodies: Bodies, q: Derivatives, order: int) -> np.ndarray:
    """Gap of every pair (rows, n), lengths in units of the size, or its derivative of an order 1 ... 3.

    The first row is the driving pair's distance from q, where the group has that pair; `bodies` have the derivatives of lower order.
    """
    rows: list[np.ndarray] = []
    if group.driven is not None:
        rows.append(_driver_gap(group, group.driven, bodies, q, order))
    for joint in group.joints:
        a, b = (line_of(bodies, end) for end in (joint.first, joint.second))
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


def _driver_gap(group: LinkGroup, driven: Joint, bodies: Bodies, q: Derivatives, order: int) -> np.ndarray:
    """Difference (n,) between the driving pair's coordinate and q, or its derivative of this order."""
    if driven.revolute:
        turn = bodies[driven.second.link].turn[order] - bodies[driven.first.link].turn[order] - q[order]
        return np.asarray(turn if order else np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi)
    line, point = line_of(bodies, driven.first), bodies[driven.second.link].fixed_point(driven.second.point)
    return np.asarray((product(line[1], difference(point, line[0]), dot)[order] - q[order]) / group.size)


def _matrix(group: LinkGroup, bodies: Bodies) -> np.ndarray:
    """Jacobian J (n, rows, 3m) of the gaps by the coordinates."""
    n = max(pose.origin[0].size for pose in bodies.values())
    drives = int(group.driven is not None)
    matrix = np.zeros((n, drives + 2 * len(group.joints), 3 * len(group.links)))
    if group.driven is not None:
        _fill_driven(group, group.driven, bodies, matrix[:, 0])
    for row, joint in enumerate(group.joints):
        first, second = drives + 2 * row, drives + 2 * row + 1
        if not joint.revolute:
            a, b = (line_of(bodies, end) for end in (joint.first, joint.second))
            direction, gap = a[1][0], b[0][0] - a[0][0]
        for end, sign in ((joint.first, -1.0), (joint.second, 1.0)):
            if end.link not in group.links:
                continue
            column = 3 * group.links.index(end.link)
            arm = 1j * end.point * bodies[end.link].unit / group.size
            if joint.revolute:
                matrix[:, first, column] = matrix[:, second, column + 1] = sign
                matrix[:, first, column + 2], matrix[:, second, column + 2] = sign * arm.real, sign * arm.imag
            else:
                matrix[:, first, column + 2] = sign
                matrix[:, second, column], matrix[:, second, column + 1] = -sign * direction.imag, sign * direction.real
                matrix[:, second, column + 2] = sign * cross(direction, arm)
                if sign < 0.0:  # the line turns with its link
                    matrix[:, second, column + 2] -= dot(direction, gap) / group.size
    return matrix


def _fill_driven(group: LinkGroup, driven: Joint, bodies: Bodies, row: np.ndarray) -> None:
    """Write the derivative of the driving pair's coordinate by each coordinate into a row (n, 3m)."""
    line, point = line_of(bodies, driven.first), bodies[driven.second.link].fixed_point(driven.second.point)[0]
    direction, gap = line[1][0], point - line[0][0]
    for end, sign in ((driven.first, -1.0), (driven.second, 1.0)):
        if end.link not in group.links:
            continue
        column = 3 * group.links.index(end.link)
        if driven.revolute:
            row[:, column + 2] = sign
            continue
        row[:, column], row[:, column + 1] = sign * direction.real, sign * direction.imag
        row[:, column + 2] = sign * dot(direction, 1j * end.point * bodies[end.link].unit / group.size)
        if sign < 0.0:  # the line turns with its link
            row[:, column + 2] += cross(direction, gap) / group.size
