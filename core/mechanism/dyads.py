"""Dyads in closed form: two links between known ends, for all positions at once, with three derivatives.

Each kind closes one vector loop with two unknowns x1, x2: c1 x1 + c2 x2 = D, where D holds what is known of the loop
in each order of derivative. The determinant c1 × c2 vanishes at a dead centre.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from core.linkage.triangle import area4_and_room
from core.mechanism.closing import (
    BINOMIAL,
    BY_ROUNDING,
    PARALLEL,
    Bodies,
    angles,
    centripetal,
    earlier,
    full,
    leg,
    line_of,
    pin_of,
    placed,
    product,
    turned_like,
    two_slides,
)
from core.mechanism.plan import Joint
from core.train import Pose
from core.vectors import cross, dot, turning

Sides = float | np.ndarray
"""+1 or -1, for all positions or for each."""


@dataclass(frozen=True, eq=False)
class Closed:
    """A solved dyad.

    poses     of its two links
    columns   c1, c2 (n,) complex: how the loop opens with each of its two coordinates [m per rad, or 1]
    gap       (n,) what is left before it can no longer be assembled [m, or 1]: negative where it cannot
    sine      (n,) |c1 × c2|/(|c1||c2|), 0 at a dead centre: the sine of the transmission angle
    reach     (n,) size of the loop's terms, which rounding is relative to [m]
    """

    poses: tuple[Pose, Pose]
    columns: tuple[np.ndarray, np.ndarray]
    gap: np.ndarray
    sine: np.ndarray
    reach: np.ndarray


# -- the kinds --------------------------------------------------------------------------------------------


def _rrr(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> Closed:
    """Two rods between pins P_a, P_b: the triangle r, L_a, L_b by Kahan's area, as for arm and rod of the cam slider.

    A = d(r² + L_a² - L_b² + iσK)/(2r²), B = A - d from P_b: iA α - iB β = D, A × B = σK/2.
    """
    outer_a, inner, outer_b = joints
    a, b = pin_of(bodies, outer_a.first), pin_of(bodies, outer_b.first)
    rod_a, rod_b = inner.first.point - outer_a.second.point, inner.second.point - outer_b.second.point
    la, lb = abs(rod_a), abs(rod_b)
    d = b - a
    square = d[0].real ** 2 + d[0].imag ** 2
    r = np.sqrt(square)
    area, room = area4_and_room(r, la, lb)
    if not (room >= 0.0).all():
        area = np.where((room < 0.0) & (room > -BY_ROUNDING * (la + lb)), 0.0, area)
    k = side * area
    difference = (la - lb) * (la + lb)
    scale = 0.5 / square
    to_a, to_b = np.empty_like(d[0]), np.empty_like(d[0])
    to_a.real, to_b.real = (square + difference) * scale, (difference - square) * scale
    to_a.imag = to_b.imag = k * scale
    to_a *= d[0]
    to_b *= d[0]
    turn = 0.5 * k  # A × B
    between = 0.5 * (la * la + lb * lb - square)  # A · B
    alpha, beta = np.empty((3, r.size)), np.empty((3, r.size))
    inverse = 1.0 / turn
    alpha[0], beta[0] = dot(d[1], to_b) * inverse, dot(d[1], to_a) * inverse
    a1, b1 = alpha[0], beta[0]
    a2, b2 = a1 * a1, b1 * b1
    alpha[1] = (dot(d[2], to_b) + a2 * between - b2 * (lb * lb)) * inverse
    beta[1] = (dot(d[2], to_a) + a2 * (la * la) - b2 * between) * inverse
    a3, b3 = 3.0 * a1 * alpha[1], 3.0 * b1 * beta[1]
    alpha[2] = (dot(d[3], to_b) + a3 * between - b3 * (lb * lb)) * inverse + a2 * a1
    beta[2] = (dot(d[3], to_a) + a3 * (la * la) - b3 * between) * inverse + b2 * b1
    heading_a, heading_b = to_a * (1.0 / rod_a), to_b * (1.0 / rod_b)
    angle_a, angle_b = angles(heading_a, alpha), angles(heading_b, beta)
    poses = (
        placed(np.broadcast_to(a, d.shape), outer_a.second.point, heading_a, angle_a),
        placed(np.broadcast_to(b, d.shape), outer_b.second.point, heading_b, angle_b),
    )
    return Closed(poses, (1j * to_a, -1j * to_b), room, area * (0.5 / (la * lb)), r + (la + lb))


def _rrp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> Closed:
    """Rod from a pin P to a pin J of a slider on a known line: A = (σc + ie)t, e the distance of P from the path of J,
    c = √((L-e)(L+e)); iA α - t s = D."""
    outer, inner, guide = joints
    p = pin_of(bodies, outer.first)
    g, t = line_of(bodies, guide.first)
    rod = inner.first.point - outer.second.point
    length = abs(rod)
    on_line = (inner.second.point - guide.second.point) / guide.second.along
    rail = g + (1j * on_line.imag) * t
    path = rail - p
    n = path.shape[1]
    direction = np.broadcast_to(t, (4, n))
    away = np.broadcast_to(cross(t[0], path[0]), n)
    c = side * leg(length, away, length)
    slide, alpha = np.empty((4, n)), np.empty((3, n))
    slide[0] = c - dot(path[0], t[0])
    to_joint = np.empty(n, dtype=complex)
    to_joint.real, to_joint.imag = c, away
    to_joint = to_joint * t[0]
    inverse = 1.0 / c
    still = guide.first.link == 1
    for order in (1, 2, 3):
        known = path[order] if still else path[order] + earlier(slide, direction, order)
        if order > 1:
            known = known - centripetal(to_joint, alpha, order)
        alpha[order - 1] = -cross(known, t[0]) * inverse
        slide[order] = -dot(known, to_joint) * inverse
    heading = to_joint * (1.0 / rod)
    angle = angles(heading, alpha)
    heading_b, angle_b = turned_like(bodies[guide.first.link], guide.first.along / guide.second.along)
    heading_b, angle_b = full((heading_b, angle_b), n)
    joint = rail + product(slide, direction)
    poses = (
        placed(np.broadcast_to(p, path.shape), outer.second.point, heading, angle),
        placed(joint, inner.second.point, heading_b, angle_b),
    )
    size = np.abs(c)
    reach = length + np.abs(path[0])
    return Closed(poses, (1j * to_joint, -direction[0]), length - np.abs(away), size / length, reach)


def _rpr(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> Closed:
    """A link that slides on another, both on pins P_a, P_b: P_a - P_b = (s + ie)t, s = σ√(r² - e²); id β + t s = D."""
    outer_a, inner, outer_b = joints
    a, b = pin_of(bodies, outer_a.first), pin_of(bodies, outer_b.first)
    own = (outer_a.second.point - inner.first.point) / inner.first.along
    other = (outer_b.second.point - inner.second.point) / inner.second.along
    offset = own.imag - other.imag
    d = a - b
    n = d.shape[1]
    square = d[0].real ** 2 + d[0].imag ** 2
    r = np.sqrt(square)
    slide, beta = np.empty((4, n)), np.empty((3, n))
    slide[0] = side * leg(r, np.full(n, offset), abs(offset))
    t = np.empty((3, n), dtype=complex)
    t[0].real, t[0].imag = slide[0], -offset
    t[0] *= d[0] / square
    inverse = 1.0 / slide[0]
    for order in (1, 2, 3):
        known = d[order]
        if order > 1:
            known = (
                known
                - centripetal(d[0], beta, order)
                - sum(c * slide[k] * t[order - k] for k, c in enumerate(BINOMIAL[order]) if k)
            )
        beta[order - 1] = cross(t[0], known) * inverse
        slide[order] = dot(d[0], known) * inverse
        if order < 3:
            t[order] = centripetal(t[0], beta, order) + 1j * beta[order - 1] * t[0]
    heading_a, heading_b = t[0] / inner.first.along, t[0] / inner.second.along
    poses = (
        placed(np.broadcast_to(a, d.shape), outer_a.second.point, heading_a, angles(heading_a, beta)),
        placed(np.broadcast_to(b, d.shape), outer_b.second.point, heading_b, angles(heading_b, beta)),
    )
    size = np.abs(slide[0])
    gap = r - abs(offset)
    return Closed(poses, (1j * d[0], t[0]), gap, size / r, r + abs(offset))


def _prp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> Closed:
    """Two links on known lines, pinned to each other: where two lines cross; t1 s1 - t2 s2 = D."""
    guide_a, inner, guide_b = joints
    lines = []
    for guide, held in ((guide_a, inner.first), (guide_b, inner.second)):
        g, t = line_of(bodies, guide.first)
        on_line = (held.point - guide.second.point) / guide.second.along
        lines.append((g + (1j * on_line.imag) * t, t))
    (g1, t1), (g2, t2) = lines
    n = max(g1.shape[1], g2.shape[1])
    slides = two_slides(np.broadcast_to(g2 - g1, (4, n)), t1, -t2)
    joint = g1 + product(slides[0], t1)
    headings = [
        turned_like(bodies[guide.first.link], guide.first.along / guide.second.along) for guide in (guide_a, guide_b)
    ]
    poses = (
        placed(joint, inner.first.point, *full(headings[0], n)),
        placed(joint, inner.second.point, *full(headings[1], n)),
    )
    return _crossing(poses, t1[0], -t2[0], np.abs(slides[0, 0]) + np.abs(slides[1, 0]) + np.abs(g2[0] - g1[0]))


def _rpp(bodies: Bodies, joints: tuple[Joint, ...], side: Sides) -> Closed:
    """A link on a pin P slides on another, which slides on a known line: P = g + s2 t2 + (s1 + iy) t1."""
    outer, inner, guide = joints
    p = pin_of(bodies, outer.first)
    g, t2 = line_of(bodies, guide.first)
    known = bodies[guide.first.link]
    heading_b, angle_b = turned_like(known, guide.first.along / guide.second.along)
    heading_a, angle_a = turned_like(
        known, guide.first.along / guide.second.along * inner.second.along / inner.first.along
    )
    t1 = turning(inner.second.along * heading_b, angle_b)
    y = ((outer.second.point - inner.first.point) / inner.first.along).imag
    between = turning((inner.second.point - guide.second.point) * heading_b, angle_b)
    n = max(p.shape[1], g.shape[1])
    slides = two_slides(np.broadcast_to(p - g - between - 1j * y * t1, (4, n)), t1, t2)
    line_b = g + product(slides[1], t2)
    poses = (
        placed(np.broadcast_to(p, (4, n)), outer.second.point, *full((heading_a, angle_a), n)),
        placed(line_b, guide.second.point, *full((heading_b, angle_b), n)),
    )
    return _crossing(poses, t1[0], t2[0], np.abs(slides[0, 0]) + np.abs(slides[1, 0]) + np.abs(p[0] - g[0]))


DYADS: Mapping[str, Callable[[Bodies, tuple[Joint, ...], Sides], Closed]] = MappingProxyType(
    {"RRR": _rrr, "RRP": _rrp, "RPR": _rpr, "PRP": _prp, "RPP": _rpp}
)


def _crossing(poses: tuple[Pose, Pose], c1: np.ndarray, c2: np.ndarray, reach: np.ndarray) -> Closed:
    """Lines that cross in one point: only where they are parallel is there none."""
    n = reach.size
    sine = np.broadcast_to(np.abs(cross(c1, c2)), n)
    columns = (np.broadcast_to(c1, n), np.broadcast_to(c2, n))
    return Closed(poses, columns, sine - PARALLEL, sine, reach)
