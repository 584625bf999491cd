"""Dyads in closed form: two links between known ends, for all positions at once, with three derivatives.

Each kind closes one vector loop with two unknowns x1, x2: c1 x1 + c2 x2 = D, where D holds what is known of the loop
in each order of derivative. The determinant c1 × c2 vanishes at a dead centre.
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
    vector_derivative,
)
from core.numerics.lazy import Lazy
from core.numerics.roots import double_square, double_sum_of_squares, two_sum

# -- what closing a dyad's loop needs ---------------------------------------------------------------------------


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
    spin = body_vector(along, angle)
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
        return (
            whole[order] - lower_order_terms(slides.part(0), t1, order) - lower_order_terms(slides.part(1), t2, order)
        )

    slides = loop(t1[0], t2[0], cross(t1[0], t2[0]), known)
    return slides.part(0), slides.part(1)


# -- the triangle that a dyad of two rods comes down to, accurate down to its dead centres ----------------------


class Brackets(NamedTuple):
    """Of triangles with the sides r (n,), a, b: r², (a+b)² - r² and r² - (a-b)² [m²] (n,).

    Their product is K² = (4 x area)². The brackets are the distances from the two dead centres, in squares; each is
    negative where the sides do not meet.
    """

    square: np.ndarray
    stretched: np.ndarray
    folded: np.ndarray

    def gap(self, a: float, b: float) -> np.ndarray:
        """What is left before the sides no longer meet (n,) [m]: the lesser of a+b-r and r-|a-b|."""
        r, shortest = np.sqrt(self.square), abs(a - b)
        over = r + shortest
        return np.minimum(self.stretched / (a + b + r), self.folded / np.where(over > 0.0, over, 1.0))


NEAR = 0.25  # of r²: a bracket below it is near a dead centre


def brackets(x: np.ndarray, y: np.ndarray, a: float, b: float) -> Brackets:
    """The brackets for r² = x² + y² (n,) [m²]; those near a dead centre by ``_near_dead_centre``."""
    square = x * x
    square += y * y
    longest, shortest = a + b, a - b
    found = Brackets(square, longest * longest - square, square - shortest * shortest)
    near = np.minimum(found.stretched, found.folded) < NEAR * square
    if near.any():
        if square.shape != near.shape:
            found = Brackets(*(np.array(np.broadcast_to(each, near.shape)) for each in found))
        sides = (np.broadcast_to(each, near.shape)[near] for each in (x, y, a, b))
        for all_of, those in zip(found, _near_dead_centre(*sides), strict=True):
            all_of[near] = those
    return found


def _near_dead_centre(x: np.ndarray, y: np.ndarray, a: np.ndarray, b: np.ndarray) -> Brackets:
    """Every square is kept with what rounding took from it: near a dead centre a bracket is a small difference of large
    squares, and would lose (S/K)² eps otherwise (Kahan, Miscalculating Area and Angles of a Needle-like Triangle).
    """
    square, rest = double_sum_of_squares(x, y)
    (longest, more), (shortest, less) = double_square(*two_sum(a, b)), double_square(*two_sum(a, -b))
    stretched, folded = longest - square, square - shortest
    stretched += more - rest
    folded += rest - less
    return Brackets(square, stretched, folded)


def area4_of(a: Any, b: Any, c: Any) -> Any:
    """K = 4 x area of the triangle with three plain lengths, by Kahan's formula; NaN where they make none."""
    small, mid, big = np.sort(np.broadcast_arrays(a, b, c), axis=0)
    gap = big - mid
    product = (big + (mid + small)) * (small - gap) * (small + gap) * (big + (mid - small))
    return np.sqrt(np.where(product >= 0.0, product, np.nan))


def opposite_angle(a: Any, b: Any, c: Any) -> Any:
    """Angle between the sides a and b [rad], NaN where a, b, c make no triangle."""
    return np.arctan2(area4_of(a, b, c), a * a + (b - c) * (b + c))


# -- dyads in closed form ---------------------------------------------------------------------------------------


Sides = float | np.ndarray
"""+1 or -1, for all positions or for each."""


@frozen(eq=False)
class DyadSolution:
    """A solved dyad; all but the poses is made when it is first read, and has one value where it is the same everywhere.

    poses     of its two links
    columns   c1, c2 (n,) complex: how the loop opens with each of its two coordinates [m per rad, or 1]
    gap       (n,) what is left before it can no longer be assembled [m, or 1]: negative where it cannot
    sine      (n,) |c1 × c2|/(|c1||c2|), 0 at a dead centre: the sine of the transmission angle
    reach     (n,) size of the loop's terms, which rounding is relative to [m]
    """

    poses: tuple[Pose, Pose]
    columns: Lazy[tuple[np.ndarray, np.ndarray]] = Lazy()
    gap: Lazy[np.ndarray] = Lazy()
    sine: Lazy[np.ndarray] = Lazy()
    reach: Lazy[np.ndarray] = Lazy()

    @property
    def transmission(self) -> np.ndarray:
        """Transmission angle (n,) [rad], 0 … π/2, by sine and cosine: near 90° the sine alone has lost half of its digits."""
        c1, c2 = self.columns
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine = np.abs(dot(c1, c2)) / np.abs(c1 * c2)
        return np.where(
            self.sine > 0.0, np.arctan2(self.sine, cosine), 0.0
        )  # where a dyad folds the columns have no direction


# -- the kinds --------------------------------------------------------------------------------------------


def _rrr(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """Two rods between pins P_a, P_b: the triangle r, L_a, L_b by its area K/4.

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
        missed = sides.gap(la, lb)
        by_rounding = (missed < 0.0) & (missed > -BY_ROUNDING * (la + lb))
        product_of_brackets = np.where(by_rounding, 0.0, product_of_brackets)
    area = np.sqrt(product_of_brackets)
    k = side * area
    to_a, to_b = np.empty(k.shape, dtype=complex), np.empty(k.shape, dtype=complex)
    sum_and_difference = (la + lb) * (la - lb)
    np.subtract(sum_and_difference, square, out=to_b.real)
    np.add(sum_and_difference, square, out=to_a.real)
    to_b.imag = to_a.imag = k
    scale = d[0] * (0.5 / square)
    to_b *= scale
    to_a *= scale

    def known(order: int, turns: Chain) -> np.ndarray:
        if order == 1:
            return d[1]
        return centripetal(to_b, turns.part(1), order) - centripetal(to_a, turns.part(0), order) + d[order]

    turns = loop(1j * to_a, -1j * to_b, -0.5 * k, known)

    def alone(row: int, to: np.ndarray, rod: complex) -> tuple[Callable[[], np.ndarray], Derivatives]:
        def heading() -> np.ndarray:
            return to * (1.0 / rod)

        return heading, turns.part(row, angle_of(heading))

    first, heading = placed(a, outer_a.second.point, *alone(0, to_a, rod_a)), alone(1, to_b, rod_b)
    if inner.second.point:
        second = placed(b, outer_b.second.point, *heading)
    else:  # its origin is the joint, which the first link carries
        second = placed(first.carried(inner.first.point), inner.second.point, *heading)
    return DyadSolution(
        (first, second),
        lambda: (1j * to_a, -1j * to_b),
        lambda: sides.gap(la, lb),
        lambda: np.abs(k) * (0.5 / (la * lb)),
        lambda: np.sqrt(square) + (la + lb),
    )


def _rrp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """Rod from a pin P to a pin J of a slider on a known line: A = (σc + ie)t, e the distance of P from the path of J,
    c = √((L-e)(L+e)); iA α - t s = D."""
    outer, inner, guide = joints
    p = pin_of(bodies, outer.first)
    g, t = line_of(bodies, guide.first)
    rod = inner.first.point - outer.second.point
    length = abs(rod)
    rail = beside(g, t, ((inner.second.point - guide.second.point) / guide.second.along).imag)
    path = difference(rail, p)
    away = cross(t[0], path[0])
    c = side * leg(length, away, length)
    to_joint = np.empty(c.shape, dtype=complex)
    to_joint.real, to_joint.imag = c, away
    to_joint = np.multiply(to_joint, t[0])

    def start() -> np.ndarray:
        return np.asarray(c - dot(path[0], t[0]))

    def known(order: int, both: Chain) -> np.ndarray:
        moved = path[order] if t.constant else path[order] + lower_order_terms(both.part(1, start), t, order)
        return moved - centripetal(to_joint, both.part(0), order)

    def heading() -> np.ndarray:
        return to_joint * (1.0 / rod)

    both = loop(1j * to_joint, -t[0], c, known)
    angle, slide = both.part(0, angle_of(heading)), both.part(1, start)
    joint = sum_of(rail, product(slide, t))
    poses = (
        placed(p, outer.second.point, heading, angle),
        placed(
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
    own = (outer_a.second.point - inner.first.point) / inner.first.along
    other = (outer_b.second.point - inner.second.point) / inner.second.along
    offset = own.imag - other.imag
    d = difference(a, b)
    square = d[0].real ** 2 + d[0].imag ** 2
    r = np.sqrt(square)
    s = side * leg(r, np.asarray(offset), abs(offset))
    along = np.empty(s.shape, dtype=complex)
    along.real, along.imag = s, -offset
    along *= d[0] / square

    def known(order: int, both: Chain) -> np.ndarray:
        turn, slide = both.part(0), both.part(1)
        left = d[order] - centripetal(d[0], turn, order)
        for k in range(1, order):
            left = left - BINOMIAL[order][k] * slide[k] * vector_derivative(along, turn, order - k)
        return left

    both = loop(1j * d[0], along, -s, known)

    def lying(own_line: complex) -> tuple[Callable[[], np.ndarray], Derivatives]:
        def heading() -> np.ndarray:
            return along / own_line

        return heading, both.part(0, angle_of(heading))

    poses = (
        placed(a, outer_a.second.point, *lying(inner.first.along)),
        placed(b, outer_b.second.point, *lying(inner.second.along)),
    )
    return DyadSolution(
        poses, lambda: (1j * d[0], along), lambda: r - abs(offset), lambda: np.abs(s) / r, lambda: r + abs(offset)
    )


def _prp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """Two links on known lines, pinned to each other: where two lines cross; t1 s1 - t2 s2 = D."""
    guide_a, inner, guide_b = joints
    lines = []
    for guide, held in ((guide_a, inner.first), (guide_b, inner.second)):
        g, t = line_of(bodies, guide.first)
        lines.append((beside(g, t, ((held.point - guide.second.point) / guide.second.along).imag), t))
    (g1, t1), (g2, t2) = lines
    opposite = scaled(t2, -1.0)
    apart = difference(g2, g1)
    s1, s2 = two_slides(apart, t1, opposite)
    joint = sum_of(g1, product(s1, t1))
    turns = [
        turned_like(bodies[guide.first.link], guide.first.along / guide.second.along) for guide in (guide_a, guide_b)
    ]
    poses = (placed(joint, inner.first.point, *turns[0]), placed(joint, inner.second.point, *turns[1]))
    return _crossing(poses, t1, opposite, lambda: np.abs(s1[0]) + np.abs(s2[0]) + np.abs(apart[0]))


def _rpp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> DyadSolution:
    """A link on a pin P slides on another, which slides on a known line: P = g + s2 t2 + (s1 + iy) t1."""
    outer, inner, guide = joints
    p = pin_of(bodies, outer.first)
    g, t2 = line_of(bodies, guide.first)
    known = bodies[guide.first.link]
    by = guide.first.along / guide.second.along
    heading_b, angle_b = turned_like(known, by)
    turned_a = turned_like(known, by * inner.second.along / inner.first.along)
    t1 = body_vector(inner.second.along * heading_b(), angle_b)
    y = ((outer.second.point - inner.first.point) / inner.first.along).imag
    between = body_vector((inner.second.point - guide.second.point) * heading_b(), angle_b)
    apart = difference(p, g)
    s1, s2 = two_slides(difference(apart, beside(between, t1, y)), t1, t2)
    poses = (
        placed(p, outer.second.point, *turned_a),
        placed(sum_of(g, product(s2, t2)), guide.second.point, heading_b, angle_b),
    )
    return _crossing(poses, t1, t2, lambda: np.abs(s1[0]) + np.abs(s2[0]) + np.abs(apart[0]))


DYADS: Mapping[str, Callable[[Bodies, tuple[Joint, ...], Sides], DyadSolution]] = MappingProxyType(
    {"RRR": _rrr, "RRP": _rrp, "RPR": _rpr, "PRP": _prp, "RPP": _rpp}
)


def _crossing(
    poses: tuple[Pose, Pose], c1: Derivatives, c2: Derivatives, reach: Callable[[], np.ndarray]
) -> DyadSolution:
    """Lines that cross in one point: only where they are parallel is there none."""

    def sine() -> np.ndarray:
        return np.abs(cross(c1[0], c2[0]))

    return DyadSolution(poses, lambda: (c1[0], c2[0]), lambda: sine() - PARALLEL, sine, reach)
