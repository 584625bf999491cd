"""Groups of links that are no dyads: Newton on the loop equations, from the neighbouring position.

Unknown are the poses of all links of the group, three numbers each, lengths in units of the linkage's size. Every pair
gives two equations, and the pair that drives one more. J is square; of links that more pairs hold than need be it has more rows, and
least squares close them where they agree. It serves positions and three derivatives.
"""

from __future__ import annotations

import numpy as np

from core.frozen import frozen
from core.mechanism.dyads import Bodies, line_of
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import Joint, LinkGroup
from core.numerics.derivatives import Derivatives, cross, difference, dot, product

STEPS = 30  # of Newton; from the neighbouring position two or three do
AGREES = 1e-9  # of the size: pairs that are open by less agree, where there are more of them than need be
NEAR = 1e-9  # after a correction this small, relative to the size, the next would be rounding


@frozen(eq=False)
class GroupSolution:
    """A solved group: poses by link, J (n, rows, 3m), its determinant relative to its rows' lengths (n,) with its sign; with more rows the
    product of its singular values."""

    poses: dict[int, Pose]
    matrix: np.ndarray
    determinant: np.ndarray


def newton(
    group: LinkGroup, known: Bodies, q: Derivatives, start: np.ndarray, steps: int = STEPS
) -> tuple[np.ndarray, np.ndarray]:
    """From ``start`` (3m, n) to a position that closes, with the driver at q: coordinates (3m, n) and the last correction (n,), infinite
    where pairs that are too many do not agree."""
    x = start.copy()
    last = np.full(x.shape[1], np.inf)
    for _ in range(steps):
        bodies = {**known, **_poses(group, _at_rest(x))}
        opening = _opening(group, bodies, q, 0)
        change = _solve(_matrix(group, bodies), -opening)
        length = np.abs(change).max(axis=0)
        change *= np.minimum(1.0, 0.5 / np.maximum(length, 1e-300))  # half a radian, or half the size, at once
        x += change
        last = length
        if not (length > NEAR).any():
            break
    if opening.shape[0] > x.shape[0]:
        opening = _opening(group, {**known, **_poses(group, _at_rest(x))}, q, 0)
        last = np.where(np.abs(opening).max(axis=0) <= AGREES, last, np.inf)
    return x, last


def group_solution(group: LinkGroup, known: Bodies, q: Derivatives, x: np.ndarray) -> GroupSolution:
    """Poses with three derivatives from coordinates that close (3m, n)."""
    states = _at_rest(x)
    matrix = _matrix(group, {**known, **_poses(group, states)})
    lengths = np.sqrt((matrix * matrix).sum(axis=2)).prod(axis=1)
    square = matrix.shape[1] == matrix.shape[2]
    with np.errstate(invalid="ignore"):
        determinant = (np.linalg.det(matrix) if square else _measure(matrix)) / lengths
    for order in (1, 2, 3):
        states[order] = _solve(matrix, -_opening(group, {**known, **_poses(group, states)}, q, order))
    return GroupSolution(_poses(group, states), matrix, determinant)


def _measure(matrix: np.ndarray) -> np.ndarray:
    """(n,) the product of the singular values of (n, rows, m): zero where the links could move although the driver stands."""
    lost = ~np.isfinite(matrix).all(axis=(1, 2))
    found = np.linalg.svd(np.where(lost[:, None, None], 0.0, matrix), compute_uv=False).prod(axis=1)
    return np.asarray(np.where(lost, np.nan, found))


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
    """matrix (n, rows, m), right (rows, n) -> (m, n); with more rows, or where it is singular, by least squares."""
    if matrix.shape[1] > matrix.shape[2]:
        q, r = np.linalg.qr(matrix)
        right = np.einsum("nij,in->jn", q, right)
        matrix = r
    try:
        return np.linalg.solve(matrix, right.T[..., None])[..., 0].T
    except np.linalg.LinAlgError:
        return np.einsum("nij,jn->in", np.linalg.pinv(matrix), right)


def _opening(group: LinkGroup, bodies: Bodies, q: Derivatives, order: int) -> np.ndarray:
    """How far every pair is open (rows, n), lengths in units of the size, and how far the one that drives is from q; or the derivative of
    this order, 1 ... 3, by what is known of the rates so far."""
    rows: list[np.ndarray] = []
    if group.driven is not None:
        rows.append(_beyond(group, group.driven, bodies, q, order))
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


def _beyond(group: LinkGroup, driven: Joint, bodies: Bodies, q: Derivatives, order: int) -> np.ndarray:
    """How far the pair that drives is beyond q, in this order (n,)."""
    if driven.revolute:
        turn = bodies[driven.second.link].turn[order] - bodies[driven.first.link].turn[order] - q[order]
        return np.asarray(turn if order else np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi)
    line, point = line_of(bodies, driven.first), bodies[driven.second.link].carried(driven.second.point)
    return np.asarray((product(line[1], difference(point, line[0]), dot)[order] - q[order]) / group.size)


def _matrix(group: LinkGroup, bodies: Bodies) -> np.ndarray:
    """J (n, rows, 3m): how each pair opens with each coordinate."""
    n = max(pose.origin[0].size for pose in bodies.values())
    drives = int(group.driven is not None)
    matrix = np.zeros((n, drives + 2 * len(group.joints), 3 * len(group.links)))
    if group.driven is not None:
        _fill_driven(group, group.driven, bodies, matrix[:, 0])
    for row, joint in enumerate(group.joints):
        first, second = drives + 2 * row, drives + 2 * row + 1
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


def _fill_driven(group: LinkGroup, driven: Joint, bodies: Bodies, row: np.ndarray) -> None:
    """What the pair that drives moves with each coordinate, into a row (n, 3m)."""
    line, point = line_of(bodies, driven.first), bodies[driven.second.link].carried(driven.second.point)[0]
    direction, gap = line[1][0], point - line[0][0]
    for held, sign in ((driven.first, -1.0), (driven.second, 1.0)):
        if held.link not in group.links:
            continue
        at = 3 * group.links.index(held.link)
        if driven.revolute:
            row[:, at + 2] = sign
            continue
        row[:, at], row[:, at + 1] = sign * direction.real, sign * direction.imag
        row[:, at + 2] = sign * dot(direction, 1j * held.point * bodies[held.link].unit / group.size)
        if sign < 0.0:  # the line turns with its link
            row[:, at + 2] += cross(direction, gap) / group.size
