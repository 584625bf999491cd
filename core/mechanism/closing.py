"""What closing a dyad's loop needs: known ends, turning vectors and sliding lines in each order of derivative."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core.mechanism.plan import Held
from core.train import Pose
from core.vectors import cross, turning

Bodies = Mapping[int, Pose]


def pin_of(bodies: Bodies, held: Held) -> np.ndarray:
    """A point of a known link (4, n)."""
    return bodies[held.link].at(held.point)


def line_of(bodies: Bodies, held: Held) -> tuple[np.ndarray, np.ndarray]:
    """A point of a known line and its direction (4, n)."""
    pose = bodies[held.link]
    return pose.at(held.point), turning(held.along * pose.unit, pose.angle)


def angles(heading: np.ndarray, rates: np.ndarray) -> np.ndarray:
    angle = np.empty((4, heading.size))
    np.arctan2(heading.imag, heading.real, out=angle[0])
    angle[1:] = rates
    return angle


def placed(at: np.ndarray, local: complex, heading: np.ndarray, angle: np.ndarray) -> Pose:
    """The link whose point ``local`` is at ``at`` (4, n)."""
    if local == 0.0:
        return Pose(at, angle, unit=heading)
    return Pose(at - turning(local * heading, angle), angle, unit=heading)


def turned_like(pose: Pose, by: complex) -> tuple[np.ndarray, np.ndarray]:
    """Heading and angles of a link that keeps its angle against another."""
    heading = pose.unit * by
    return heading, angles(heading, np.broadcast_to(pose.angle[1:], (3, heading.size)))


def earlier(s: np.ndarray, t: np.ndarray, order: int) -> np.ndarray:
    """The derivative of s t (n,) in this order without its term in s's highest derivative (Leibniz)."""
    if order == 0:
        return np.zeros_like(t[0])
    return np.asarray(sum(c * s[k] * t[order - k] for k, c in enumerate(BINOMIAL[order])))


BY_ROUNDING = 64.0 * float(np.finfo(float).eps)  # a gap negative by so much of the size is none
PARALLEL = 64.0 * float(np.finfo(float).eps)
BINOMIAL = ((), (1.0,), (1.0, 2.0), (1.0, 3.0, 3.0))


def leg(long: np.ndarray | float, short: np.ndarray, size: float) -> np.ndarray:
    """√(long² - short²) of a right-angled triangle, NaN where there is none; 0 where that is by rounding."""
    room = long - np.abs(short)
    inside = room * (long + np.abs(short))
    none = np.where(room < -BY_ROUNDING * size, np.nan, 0.0)
    return np.sqrt(np.where(inside < 0.0, none, inside))


def centripetal(u: np.ndarray, rates: np.ndarray, order: int) -> np.ndarray:
    """The derivative of a turning vector u in this order (1, 2, 3) without its term in the angle's highest one."""
    w = rates[0]
    if order == 1:
        return np.zeros_like(u)
    if order == 2:
        return -(w * w) * u
    factor = np.empty(u.shape, dtype=complex)
    factor.real, factor.imag = -3.0 * w * rates[1], -(w * w * w)
    return factor * u


def product(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """s t with three derivatives (4, n)."""
    out = np.empty((4, s.shape[1]), dtype=complex)
    for order in range(4):
        out[order] = s[order] * t[0] + earlier(s, t, order)
    return out


def two_slides(rest: np.ndarray, t1: np.ndarray, t2: np.ndarray) -> np.ndarray:
    """s1, s2 (2, 4, n) with t1 s1 + t2 s2 = rest, and their derivatives."""
    n = rest.shape[1]
    s = np.empty((2, 4, n))
    inverse = 1.0 / cross(t1[0], t2[0])
    for order in range(4):
        known = rest[order] - earlier(s[0], t1, order) - earlier(s[1], t2, order)
        s[0, order], s[1, order] = cross(known, t2[0]) * inverse, cross(t1[0], known) * inverse
    return s


def full(turned: tuple[np.ndarray, np.ndarray], n: int) -> tuple[np.ndarray, np.ndarray]:
    return np.broadcast_to(turned[0], n).copy(), np.broadcast_to(turned[1], (4, n)).copy()
