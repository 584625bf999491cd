"""Dyads in closed form: two links between known bodies, for all positions at once, with three derivatives.

Each kind closes one vector loop with two unknowns x1, x2: c1 x1 + c2 x2 = D, where D is the known part of the loop in each order
of derivative. The determinant c1 × c2 vanishes at a dead centre.

Source: W. Kahan, *Miscalculating Area and Angles of a Needle-like Triangle*, for triangles near a dead centre.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import Joint, JointEnd
from core.numerics.derivatives import (
    BINOMIAL,
    Chain,
    Derivatives,
    Rows,
    body_vector,
    cross,
    difference,
    dot,
    lower_order_terms,
    product,
    scaled,
    sum_of,
    sum_with_multiple,
    vector_derivative,
)
from core.numerics.lazy import Lazy
from core.numerics.roots import double_square, double_sum_of_squares, two_sum

# -- points, lines and loops ------------------------------------------------------------------------------------


Bodies = Mapping[int, Pose]


def pin_of(bodies: Bodies, end: JointEnd) -> Derivatives:
    """The point of a joint on a known link."""
    return bodies[end.link].fixed_point(end.point)


def line_of(bodies: Bodies, end: JointEnd) -> tuple[Derivatives, Derivatives]:
    """A point and the direction of the line of a sliding joint on a known link."""
    pose = bodies[end.link]
    return pose.fixed_point(end.point), scaled(pose.spin, end.along)


def offset_left(point: Derivatives, direction: Derivatives, offset: float) -> Derivatives:
    """The point moved by the offset to the left of the direction."""
    return sum_with_multiple(point, direction, 1j * offset) if offset else point


def angle_of(heading: Callable[[], np.ndarray]) -> Callable[[], np.ndarray]:
    """Function for the angle -π ... π of a unit vector.

    Parameters
    ----------
    heading : callable returning ndarray (n,) complex, dimensionless
        Unit vector.

    Returns
    -------
    callable returning ndarray (n,) [rad]
    """

    def angle() -> np.ndarray:
        along = heading()
        return np.asarray(np.arctan2(along.imag, along.real))

    return angle


def pose_through(at: Derivatives, local: complex, heading: Callable[[], np.ndarray], angle: Derivatives) -> Pose:
    """Pose of a link from one of its points and its angle.

    Parameters
    ----------
    at : Derivatives
        The point in the global frame (n,) [m].
    local : complex
        The same point in the link's frame [m].
    heading : callable returning ndarray (n,) complex, dimensionless
        Unit vector of the link's x axis.
    angle : Derivatives
        Angle (n,) [rad] of that axis.

    Returns
    -------
    Pose
    """
    if not local:
        return Pose(at, angle, unit=heading)
    along = heading()
    spin = body_vector(along, angle)
    return Pose(sum_with_multiple(at, spin, -local), angle, unit=along, spin=spin)


def turned_like(pose: Pose, by: complex) -> tuple[Callable[[], np.ndarray], Derivatives]:
    """Heading and angle of a link at a constant angle to another one.

    Parameters
    ----------
    pose : Pose
        The other link.
    by : complex
        Unit vector of the constant angle.

    Returns
    -------
    heading : callable returning ndarray (n,) complex, dimensionless
    angle : Derivatives
        In rad.
    """

    def heading() -> np.ndarray:
        return pose.unit * by

    angle = angle_of(heading)
    return heading, Derivatives(lambda order: pose.turn[order] if order else angle(), pose.turn.constant)


BY_ROUNDING = 64.0 * float(np.finfo(float).eps)  # relative to the size: a negative gap this small is rounding
PARALLEL = 64.0 * float(np.finfo(float).eps)


def leg(long: np.ndarray | float, short: np.ndarray, size: float) -> np.ndarray:
    """Leg of a right-angled triangle, √(long² - short²).

    Parameters
    ----------
    long : float or ndarray (n,) [m]
        Hypotenuse.
    short : ndarray (n,) [m]
        Other leg; its sign does not matter.
    size : float
        Length [m] to which rounding is relative.

    Returns
    -------
    ndarray (n,) [m]
        NaN where |short| > long, but 0 where the difference is rounding.
    """
    difference = long - np.abs(short)
    square = difference * (long + np.abs(short))
    if_negative = np.where(difference < -BY_ROUNDING * size, np.nan, 0.0)
    return np.sqrt(np.where(square < 0.0, if_negative, square))


def centripetal(u: np.ndarray, angle: Derivatives, order: int) -> np.ndarray:
    """Derivative of a rotating vector without its term in the angle's highest derivative.

    Order 1: 0; order 2: -α'² u; order 3: (-3α'α'' - iα'³) u.

    Parameters
    ----------
    u : ndarray (n,) complex [m]
        Vector of constant length.
    angle : Derivatives
        Its angle α (n,) [rad].
    order : int
        1, 2 or 3.

    Returns
    -------
    ndarray (n,) complex [m/rad^order]
    """
    if order == 1:
        return np.zeros_like(u)
    w = angle[1]
    if order == 2:
        return -(w * w) * u
    factor = np.empty(np.broadcast(w, angle[2]).shape, dtype=complex)
    factor.real, factor.imag = -3.0 * w * angle[2], -(w * w * w)
    return factor * u


def loop(c1: np.ndarray, c2: np.ndarray, determinant: np.ndarray, known: Callable[[int, Chain], np.ndarray]) -> Chain:
    """Coordinates x1, x2 of a loop in each order of derivative, from c1 x1 + c2 x2 = D by Cramer's rule.

    Parameters
    ----------
    c1, c2 : ndarray (n,) complex [m per rad, or dimensionless]
        Columns of the loop equation.
    determinant : ndarray (n,) [unit of c1 times that of c2]
        c1 × c2, from a formula of the dyad that is more accurate than the product.
    known : callable
        Order, chain -> D (n,) [m], from the known bodies and the lower orders of x1 and x2.

    Returns
    -------
    Chain
        Rows x1, x2.
    """
    inverse = 1.0 / determinant

    def follow(order: int, x: Chain) -> Rows:
        right = known(order, x)
        return cross(right, c2) * inverse, cross(c1, right) * inverse

    return Chain(follow)


def two_slides(total: Derivatives, t1: Derivatives, t2: Derivatives) -> tuple[Derivatives, Derivatives]:
    """Slides s1, s2 with t1 s1 + t2 s2 = total."""

    def known(order: int, slides: Chain) -> np.ndarray:
        if not order:
            return total[0]
        return (
            total[order] - lower_order_terms(slides.part(0), t1, order) - lower_order_terms(slides.part(1), t2, order)
        )

    slides = loop(t1[0], t2[0], cross(t1[0], t2[0]), known)
    return slides.part(0), slides.part(1)


# -- triangles, accurate near their dead centres ----------------------------------------------------------------


class Brackets(NamedTuple):
    """The brackets (a+b)² - r² and r² - (a-b)² of a triangle with sides r, a, b.

    Their product is K² = (4 × area)². Each is negative where the sides do not meet, and zero at one of the two dead centres.

    Attributes
    ----------
    square : ndarray (n,) [m²]
        r².
    stretched : ndarray (n,) [m²]
        (a+b)² - r².
    folded : ndarray (n,) [m²]
        r² - (a-b)².
    """

    square: np.ndarray
    stretched: np.ndarray
    folded: np.ndarray

    def gap(self, a: float, b: float) -> np.ndarray:
        """Distance from the nearer dead centre, the smaller of a+b-r and r-|a-b|.

        Parameters
        ----------
        a, b : float
            Sides [m].

        Returns
        -------
        ndarray (n,) [m]
            Negative where the sides do not meet.
        """
        r, shortest = np.sqrt(self.square), abs(a - b)
        over = r + shortest
        return np.minimum(self.stretched / (a + b + r), self.folded / np.where(over > 0.0, over, 1.0))


NEAR = 0.25  # of r²: a smaller bracket is near a dead centre


def brackets(x: np.ndarray, y: np.ndarray, a: float, b: float) -> Brackets:
    """Brackets of the triangle with sides r, a, b, where r² = x² + y².

    Parameters
    ----------
    x, y : ndarray (n,) [m]
        Components of the vector along the side r.
    a, b : float
        Other sides [m].

    Returns
    -------
    Brackets

    References
    ----------
    Near a dead centre: Kahan, *Miscalculating Area and Angles of a Needle-like Triangle*.
    """
    square = x * x
    square += y * y
    longest, shortest = a + b, a - b
    result = Brackets(square, longest * longest - square, square - shortest * shortest)
    near = np.minimum(result.stretched, result.folded) < NEAR * square
    if near.any():
        if square.shape != near.shape:
            result = Brackets(*(np.array(np.broadcast_to(row, near.shape)) for row in result))
        sides = (np.broadcast_to(side, near.shape)[near] for side in (x, y, a, b))
        for row, accurate in zip(result, _near_dead_centre(*sides), strict=True):
            row[near] = accurate
    return result


def _near_dead_centre(x: np.ndarray, y: np.ndarray, a: np.ndarray, b: np.ndarray) -> Brackets:
    """The same brackets with the rounding error of each square added back.

    Near a dead centre a bracket is a small difference of large squares, and would lose (S/K)² eps otherwise.
    """
    square, rest = double_sum_of_squares(x, y)
    (longest, more), (shortest, less) = double_square(*two_sum(a, b)), double_square(*two_sum(a, -b))
    stretched, folded = longest - square, square - shortest
    stretched += more - rest
    folded += rest - less
    return Brackets(square, stretched, folded)


def area4_of(a: Any, b: Any, c: Any) -> Any:
    """Four times the area of a triangle with three given sides, K; NaN where the sides make no triangle.

    References
    ----------
    Kahan, *Miscalculating Area and Angles of a Needle-like Triangle*.
    """
    low, high = np.minimum(a, b), np.maximum(a, b)
    small, mid, big = np.minimum(low, c), np.maximum(low, np.minimum(high, c)), np.maximum(high, c)
    gap = big - mid
    product = (big + (mid + small)) * (small - gap) * (small + gap) * (big + (mid - small))
    return np.sqrt(np.where(product >= 0.0, product, np.nan))


def opposite_angle(a: Any, b: Any, c: Any) -> Any:
    """Angle between the sides a and b [rad], NaN where a, b, c make no triangle."""
    return np.arctan2(area4_of(a, b, c), a * a + (b - c) * (b + c))


# -- dyads in closed form ---------------------------------------------------------------------------------------


Sides = float | np.ndarray
"""+1 or -1, one for all positions or an array (n,)."""


@frozen(eq=False)
class DyadSolution:
    """A solved dyad; all but the poses is calculated when it is first read, with shape (1,) where it is constant.

    Attributes
    ----------
    poses : tuple of Pose
        Of the two links.
    columns : tuple of ndarray (n,) complex [m per rad, or dimensionless]
        Derivatives c1, c2 of the loop by its two coordinates.
    gap : ndarray (n,) [m, or dimensionless]
        Distance from the nearest dead centre; negative where the dyad cannot be assembled.
    sine : ndarray (n,), dimensionless
        Sine of the transmission angle, |c1 × c2|/(|c1||c2|); 0 at a dead centre.
    reach : ndarray (n,) [m]
        Size of the loop's terms, to which rounding is relative.
    """

    poses: tuple[Pose, Pose]
    columns: Lazy[tuple[np.ndarray, np.ndarray]] = Lazy()
    gap: Lazy[np.ndarray] = Lazy()
    sine: Lazy[np.ndarray] = Lazy()
    reach: Lazy[np.ndarray] = Lazy()

    @property
    def transmission(self) -> np.ndarray:
        """Transmission angle (n,) [rad], 0 … π/2, from sine and cosine, since near 90° the sine loses half of its digits."""
        c1, c2 = self.columns
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine = np.abs(dot(c1, c2)) / np.abs(c1 * c2)
        return np.where(
            self.sine > 0.0, np.arctan2(self.sine, cosine), 0.0
        )  # a folded dyad has columns without direction


def _rrr(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """Two rods between pins P_a, P_b: the triangle r, L_a, L_b and its area K/4.

    With d = P_b - P_a: A = d(r² + L_a² - L_b² + iσK)/(2r²), B = A - d from P_b, A × B = σK/2; iA α - iB β = D.
    """
    outer_a, inner, outer_b = joints
    a, b = pin_of(bodies, outer_a.first), pin_of(bodies, outer_b.first)
    rod_a, rod_b = inner.first.point - outer_a.second.point, inner.second.point - outer_b.second.point
    la, lb = abs(rod_a), abs(rod_b)
    d = difference(b, a)
    sides = brackets(d[0].real, d[0].imag, la, lb)
    square, product_of_brackets = sides.square, sides.stretched * sides.folded
    if not product_of_brackets.min() >= 0.0:
        gap = sides.gap(la, lb)
        by_rounding = (gap < 0.0) & (gap > -BY_ROUNDING * (la + lb))
        product_of_brackets = np.where(by_rounding, 0.0, product_of_brackets)
    area = np.sqrt(product_of_brackets)
    k = side * area
    to_a, to_b = np.empty(k.shape, dtype=complex), np.empty(k.shape, dtype=complex)
    sum_and_difference = (la + lb) * (la - lb)
    np.subtract(sum_and_difference, square, out=to_b.real)
    np.add(sum_and_difference, square, out=to_a.real)
    to_b.imag = to_a.imag = k
    scale = d[0] * (0.5 / square)
    to_b, to_a = to_b * scale, to_a * scale  # in place, numpy rounds the product of a single angle differently

    def known(order: int, turns: Chain) -> np.ndarray:
        if order == 1:
            return d[1]
        return centripetal(to_b, turns.part(1), order) - centripetal(to_a, turns.part(0), order) + d[order]

    turns = loop(1j * to_a, -1j * to_b, -0.5 * k, known)

    def direction(row: int, to: np.ndarray, rod: complex) -> tuple[Callable[[], np.ndarray], Derivatives]:
        def heading() -> np.ndarray:
            return to * (1.0 / rod)

        return heading, turns.part(row, angle_of(heading))

    first = pose_through(a, outer_a.second.point, *direction(0, to_a, rod_a))
    direction_b = direction(1, to_b, rod_b)
    if inner.second.point:
        second = pose_through(b, outer_b.second.point, *direction_b)
    else:  # the origin of the second link is the inner joint
        second = pose_through(first.fixed_point(inner.first.point), inner.second.point, *direction_b)
    return DyadSolution(
        (first, second),
        lambda: (1j * to_a, -1j * to_b),
        lambda: sides.gap(la, lb),
        lambda: np.abs(k) * (0.5 / (la * lb)),
        lambda: np.sqrt(square) + (la + lb),
    )


def _rrp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """Rod from a pin P to a pin J of a slider on a known line: A = (σc + ie)t, iA α - t s = D.

    The distance of P from the path of J is e, and c = √((L-e)(L+e)).
    """
    outer, inner, guide = joints
    p = pin_of(bodies, outer.first)
    g, t = line_of(bodies, guide.first)
    rod = inner.first.point - outer.second.point
    length = abs(rod)
    line = offset_left(g, t, ((inner.second.point - guide.second.point) / guide.second.along).imag)
    path = difference(line, p)
    away = cross(t[0], path[0])
    c = side * leg(length, away, length)
    to_joint = np.empty(c.shape, dtype=complex)
    to_joint.real, to_joint.imag = c, away
    to_joint = np.multiply(to_joint, t[0])

    def start() -> np.ndarray:
        return np.asarray(c - dot(path[0], t[0]))

    def known(order: int, both: Chain) -> np.ndarray:
        path_term = path[order] if t.constant else path[order] + lower_order_terms(both.part(1, start), t, order)
        return path_term - centripetal(to_joint, both.part(0), order)

    def heading() -> np.ndarray:
        return to_joint * (1.0 / rod)

    both = loop(1j * to_joint, -t[0], c, known)
    angle, slide = both.part(0, angle_of(heading)), both.part(1, start)
    joint = sum_of(line, product(slide, t))
    poses = (
        pose_through(p, outer.second.point, heading, angle),
        pose_through(
            joint, inner.second.point, *turned_like(bodies[guide.first.link], guide.first.along / guide.second.along)
        ),
    )
    return DyadSolution(
        poses,
        lambda: (1j * to_joint, -t[0]),
        lambda: length - np.abs(away),
        lambda: np.abs(c) / length,
        lambda: length + np.abs(path[0]),
    )


def _rpr(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """A link that slides on another, both on pins P_a, P_b: P_a - P_b = (s + ie)t, s = σ√(r² - e²); id β + t s = D."""
    outer_a, inner, outer_b = joints
    a, b = pin_of(bodies, outer_a.first), pin_of(bodies, outer_b.first)
    pin_a = (outer_a.second.point - inner.first.point) / inner.first.along
    pin_b = (outer_b.second.point - inner.second.point) / inner.second.along
    offset = pin_a.imag - pin_b.imag
    d = difference(a, b)
    square = d[0].real ** 2 + d[0].imag ** 2
    r = np.sqrt(square)
    s = side * leg(r, np.asarray(offset), abs(offset))
    along = np.empty(s.shape, dtype=complex)
    along.real, along.imag = s, -offset
    along = along * (d[0] / square)

    def known(order: int, both: Chain) -> np.ndarray:
        turn, slide = both.part(0), both.part(1)
        left = d[order] - centripetal(d[0], turn, order)
        for k in range(1, order):
            left = left - BINOMIAL[order][k] * slide[k] * vector_derivative(along, turn, order - k)
        return left

    both = loop(1j * d[0], along, -s, known)

    def direction(local_line: complex) -> tuple[Callable[[], np.ndarray], Derivatives]:
        def heading() -> np.ndarray:
            return along / local_line

        return heading, both.part(0, angle_of(heading))

    poses = (
        pose_through(a, outer_a.second.point, *direction(inner.first.along)),
        pose_through(b, outer_b.second.point, *direction(inner.second.along)),
    )
    return DyadSolution(
        poses, lambda: (1j * d[0], along), lambda: r - abs(offset), lambda: np.abs(s) / r, lambda: r + abs(offset)
    )


def _prp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """Two links on known lines with a common pin, where the two lines intersect: t1 s1 - t2 s2 = D."""
    guide_a, inner, guide_b = joints
    lines = []
    for guide, pin in ((guide_a, inner.first), (guide_b, inner.second)):
        g, t = line_of(bodies, guide.first)
        lines.append((offset_left(g, t, ((pin.point - guide.second.point) / guide.second.along).imag), t))
    (g1, t1), (g2, t2) = lines
    opposite = scaled(t2, -1.0)
    distance = difference(g2, g1)
    s1, s2 = two_slides(distance, t1, opposite)
    joint = sum_of(g1, product(s1, t1))
    directions = [
        turned_like(bodies[guide.first.link], guide.first.along / guide.second.along) for guide in (guide_a, guide_b)
    ]
    poses = (
        pose_through(joint, inner.first.point, *directions[0]),
        pose_through(joint, inner.second.point, *directions[1]),
    )
    return _crossing(poses, t1, opposite, lambda: np.abs(s1[0]) + np.abs(s2[0]) + np.abs(distance[0]))


def _rpp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """A link on a pin P slides on another, which slides on a known line: P = g + s2 t2 + (s1 + iy) t1."""
    outer, inner, guide = joints
    p = pin_of(bodies, outer.first)
    g, t2 = line_of(bodies, guide.first)
    known = bodies[guide.first.link]
    by = guide.first.along / guide.second.along
    heading_b, angle_b = turned_like(known, by)
    direction_a = turned_like(known, by * inner.second.along / inner.first.along)
    t1 = body_vector(inner.second.along * heading_b(), angle_b)
    y = ((outer.second.point - inner.first.point) / inner.first.along).imag
    between = body_vector((inner.second.point - guide.second.point) * heading_b(), angle_b)
    distance = difference(p, g)
    s1, s2 = two_slides(difference(distance, offset_left(between, t1, y)), t1, t2)
    poses = (
        pose_through(p, outer.second.point, *direction_a),
        pose_through(sum_of(g, product(s2, t2)), guide.second.point, heading_b, angle_b),
    )
    return _crossing(poses, t1, t2, lambda: np.abs(s1[0]) + np.abs(s2[0]) + np.abs(distance[0]))


DYADS: Mapping[str, Callable[[Bodies, tuple[Joint, ...], Sides], DyadSolution]] = MappingProxyType(
    {"RRR": _rrr, "RRP": _rrp, "RPR": _rpr, "PRP": _prp, "RPP": _rpp}
)


def _crossing(
    poses: tuple[Pose, Pose], c1: Derivatives, c2: Derivatives, reach: Callable[[], np.ndarray]
) -> DyadSolution:
    """Solution of two intersecting lines, whose dead centre is where they are parallel."""

    def sine() -> np.ndarray:
        return np.abs(cross(c1[0], c2[0]))

    return DyadSolution(poses, lambda: (c1[0], c2[0]), lambda: sine() - PARALLEL, sine, reach)
