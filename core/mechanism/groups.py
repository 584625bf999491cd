"""Groups of links that are no dyads: Newton on the loop equations, from the neighbouring position.

Unknown are the poses of all links of the group, three numbers each, lengths in units of the linkage's size. Every pair
gives two equations, so that the matrix J is square; it serves positions, three derivatives and forces alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.mechanism.closing import Bodies
from core.mechanism.plan import Held, Joint
from core.train import Pose
from core.vectors import cross, dot, turning, unit

STEPS = 30  # of Newton; from the neighbouring position two or three do
NEAR = 1e-9  # after a correction this small, relative to the size, the next would be rounding
_BINOMIALS = ((), (1.0, 1.0), (1.0, 2.0, 1.0), (1.0, 3.0, 3.0, 1.0))


@dataclass(frozen=True)
class Group:
    """Links solved together: their numbers and all their pairs; size [m] of the linkage."""

    links: tuple[int, ...]
    joints: tuple[Joint, ...]
    size: float


@dataclass(frozen=True, eq=False)
class Settled:
    """A solved group: poses by link, J (n, 3m, 3m), its determinant relative to its rows' lengths (n,) with its sign."""

    poses: dict[int, Pose]
    matrix: np.ndarray
    determinant: np.ndarray


def newton(group: Group, known: Bodies, start: np.ndarray, steps: int = STEPS) -> tuple[np.ndarray, np.ndarray]:
    """From ``start`` (3m, n) to a position that closes: coordinates (3m, n) and the last correction (n,)."""
    x = start.copy()
    last = np.full(x.shape[1], np.inf)
    for _ in range(steps):
        poses = _poses(group, x)
        miss = _miss(group, {**known, **poses})
        change = _solve(_matrix(group, {**known, **poses}), -miss)
        length = np.abs(change).max(axis=0)
        change *= np.minimum(1.0, 0.5 / np.maximum(length, 1e-300))  # half a radian, or half the size, at once
        x += change
        last = length
        if not (length > NEAR).any():
            break
    return x, last


def settled(group: Group, known: Bodies, x: np.ndarray) -> Settled:
    """Poses with three derivatives from coordinates that close (3m, n)."""
    poses = _poses(group, x)
    everything = {**known, **poses}
    matrix = _matrix(group, everything)
    lengths = np.sqrt((matrix * matrix).sum(axis=2)).prod(axis=1)
    determinant = np.linalg.det(matrix) / lengths
    for order in (1, 2, 3):
        rates = _solve(matrix, -_closure(group, everything, order))
        for i, link in enumerate(group.links):
            pose = poses[link]
            pose.z[order] = group.size * (rates[3 * i] + 1j * rates[3 * i + 1])
            pose.angle[order] = rates[3 * i + 2]
    return Settled(poses, matrix, determinant)


def _poses(group: Group, x: np.ndarray) -> dict[int, Pose]:
    """Poses at these coordinates, derivatives still 0."""
    n = x.shape[1]
    made = {}
    for i, link in enumerate(group.links):
        z, angle = np.zeros((4, n), dtype=complex), np.zeros((4, n))
        z[0] = group.size * (x[3 * i] + 1j * x[3 * i + 1])
        angle[0] = x[3 * i + 2]
        made[link] = Pose(z, angle, unit=unit(angle[0]))
    return made


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """matrix (n, m, m), right (m, n) -> (m, n); where it is singular, a step of least squares."""
    try:
        return np.linalg.solve(matrix, right.T[..., None])[..., 0].T
    except np.linalg.LinAlgError:
        return np.einsum("nij,jn->in", np.linalg.pinv(matrix), right)


def _miss(group: Group, bodies: Bodies) -> np.ndarray:
    """How far every pair is open (3m, n), lengths in units of the size."""
    rows: list[np.ndarray] = []
    for joint in group.joints:
        a, b = bodies[joint.first.link], bodies[joint.second.link]
        heading = a.unit
        gap = b.z[0] + joint.second.point * b.unit - a.z[0] - joint.first.point * heading
        if joint.revolute:
            rows += [gap.real / group.size, gap.imag / group.size]
        else:
            turn = b.angle[0] - a.angle[0] + np.angle(joint.second.along / joint.first.along)
            turn = np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi
            rows += [turn, cross(joint.first.along * heading, gap) / group.size]
    return np.array(np.broadcast_arrays(*rows))


def _closure(group: Group, bodies: Bodies, order: int) -> np.ndarray:
    """How far every pair opens in this order of derivative, 1 ... 3 (3m, n), by what is known of the rates so far."""
    rows: list[np.ndarray] = []
    for joint in group.joints:
        a, b = (_states(bodies, held) for held in (joint.first, joint.second))
        gap = b[0] - a[0]
        if joint.revolute:
            rows += [gap[order].real / group.size, gap[order].imag / group.size]
        else:
            turn = bodies[joint.second.link].angle[order] - bodies[joint.first.link].angle[order]
            across = sum(c * cross(a[1][k], gap[order - k]) for k, c in enumerate(_BINOMIALS[order]))
            rows += [turn, np.asarray(across) / group.size]
    return np.array(np.broadcast_arrays(*rows))


def _states(bodies: Bodies, held: Held) -> tuple[np.ndarray, np.ndarray]:
    """A pair's point and the direction of its line on a link (4, n)."""
    pose = bodies[held.link]
    return pose.at(held.point), turning(held.along * pose.unit, pose.angle)


def _matrix(group: Group, bodies: Bodies) -> np.ndarray:
    """J (n, 3m, 3m): how each pair opens with each coordinate."""
    n = max(pose.z.shape[1] for pose in bodies.values())
    size = 3 * len(group.links)
    matrix = np.zeros((n, size, size))
    for row, joint in enumerate(group.joints):
        first, second = 2 * row, 2 * row + 1
        if not joint.revolute:
            a, b = (_states(bodies, held) for held in (joint.first, joint.second))
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
