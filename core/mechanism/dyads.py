"""Dyads in closed form: two links between known ends, for all positions at once, with three derivatives.

Each kind closes one vector loop with two unknowns x1, x2: c1 x1 + c2 x2 = D, where D holds what is known of the loop
in each order of derivative. The determinant c1 × c2 vanishes at a dead centre.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import Pose
from core.mechanism.loop_closure import (
    BY_ROUNDING,
    PARALLEL,
    Bodies,
    angle_of,
    beside,
    centripetal,
    leg,
    line_of,
    loop,
    pin_of,
    placed,
    turned_like,
    two_slides,
)
from core.mechanism.plan import Joint
from core.mechanism.triangle import brackets
from core.numerics.derivatives import (
    BINOMIAL,
    Chain,
    Derivatives,
    difference,
    earlier,
    product,
    scaled,
    sum_of,
    turning,
)
from core.numerics.lazy import Lazy
from core.numerics.vectors import cross, dot, turned

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
        moved = path[order] if t.constant else path[order] + earlier(both.part(1, start), t, order)
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
            left = left - BINOMIAL[order][k] * slide[k] * turned(along, turn, order - k)
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
    t1 = turning(inner.second.along * heading_b(), angle_b)
    y = ((outer.second.point - inner.first.point) / inner.first.along).imag
    between = turning((inner.second.point - guide.second.point) * heading_b(), angle_b)
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
