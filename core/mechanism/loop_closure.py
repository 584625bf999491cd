"""What closing a dyad's loop needs: known ends, turning vectors and sliding lines in each order of derivative."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from core.mechanism.kinematics import Pose
from core.mechanism.plan import JointEnd
from core.numerics.derivatives import Chain, Derivatives, Rows, difference, earlier, scaled, sum_of, turning
from core.numerics.vectors import cross

Bodies = Mapping[int, Pose]


def pin_of(bodies: Bodies, held: JointEnd) -> Derivatives:
    """A point of a known link."""
    return bodies[held.link].carried(held.point)


def line_of(bodies: Bodies, held: JointEnd) -> tuple[Derivatives, Derivatives]:
    """A point of a known line and its direction."""
    pose = bodies[held.link]
    return pose.carried(held.point), scaled(pose.spin, held.along)


def beside(point: Derivatives, direction: Derivatives, offset: float) -> Derivatives:
    """The point so far to the left of the direction."""
    return sum_of(point, scaled(direction, 1j * offset)) if offset else point


def angle_of(heading: Callable[[], np.ndarray]) -> Callable[[], np.ndarray]:
    """A function that gives the angle (n,) [rad], -π ... π, of a unit vector (n,)."""

    def angle() -> np.ndarray:
        along = heading()
        return np.asarray(np.arctan2(along.imag, along.real))

    return angle


def placed(at: Derivatives, local: complex, heading: Callable[[], np.ndarray], angle: Derivatives) -> Pose:
    """The link whose point ``local`` is at ``at``."""
    if not local:
        return Pose(at, angle, unit=heading)
    along = heading()
    spin = turning(along, angle)
    return Pose(difference(at, scaled(spin, local)), angle, unit=along, spin=spin)


def turned_like(pose: Pose, by: complex) -> tuple[Callable[[], np.ndarray], Derivatives]:
    """Heading and angle of a link that keeps its angle against another."""

    def heading() -> np.ndarray:
        return pose.unit * by

    angle = angle_of(heading)
    return heading, Derivatives(lambda order: pose.turn[order] if order else angle(), pose.turn.constant)


BY_ROUNDING = 64.0 * float(np.finfo(float).eps)  # a gap negative by so much of the size is none
PARALLEL = 64.0 * float(np.finfo(float).eps)


def leg(long: np.ndarray | float, short: np.ndarray, size: float) -> np.ndarray:
    """√(long² - short²) of a right-angled triangle, NaN where there is none; 0 where that is by rounding."""
    room = long - np.abs(short)
    inside = room * (long + np.abs(short))
    none = np.where(room < -BY_ROUNDING * size, np.nan, 0.0)
    return np.sqrt(np.where(inside < 0.0, none, inside))


def centripetal(u: np.ndarray, angle: Derivatives, order: int) -> np.ndarray:
    """The derivative of a turning vector u in this order (1, 2, 3) without its term in the angle's highest one."""
    if order == 1:
        return np.zeros_like(u)
    w = angle[1]
    if order == 2:
        return -(w * w) * u
    factor = np.empty(np.broadcast(w, angle[2]).shape, dtype=complex)
    factor.real, factor.imag = -3.0 * w * angle[2], -(w * w * w)
    return factor * u


def loop(c1: np.ndarray, c2: np.ndarray, determinant: np.ndarray, known: Callable[[int, Chain], np.ndarray]) -> Chain:
    """The loop's two coordinates x1, x2 in each order of derivative, from c1 x1 + c2 x2 = D by Cramer's rule.

    c1, c2       (n,) complex columns; determinant (n,) c1 × c2, which its own geometry knows better than their product
    known        order, chain -> D (n,): what is known of the loop in this order, the lower orders of x1 and x2 included
    """
    inverse = 1.0 / determinant

    def follow(order: int, x: Chain) -> Rows:
        right = known(order, x)
        return cross(right, c2) * inverse, cross(c1, right) * inverse

    return Chain(follow)


def two_slides(whole: Derivatives, t1: Derivatives, t2: Derivatives) -> tuple[Derivatives, Derivatives]:
    """s1, s2 with t1 s1 + t2 s2 = whole."""

    def known(order: int, slides: Chain) -> np.ndarray:
        if not order:
            return whole[0]
        return whole[order] - earlier(slides.part(0), t1, order) - earlier(slides.part(1), t2, order)

    slides = loop(t1[0], t2[0], cross(t1[0], t2[0]), known)
    return slides.part(0), slides.part(1)
