"""Velocity differences, V_P = V_A + V_PA, and the polygon they make from one pole (Velocity, 6.1).

Two points of one body: V_PA = iω(P - A), across the line between them. Two points that coincide, of bodies that slide on
each other: V_PA lies along the guide.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.mechanism.kinematics import FRAME, FRAME_POSE, SLIDING, Kinematics, Pair, Pose
from core.mechanism.mechanism import body_name
from core.numerics.vectors import dot

TURNING = "turning"
ABSOLUTE = "absolute"


@frozen(eq=False)
class PolygonTriangle:
    """One triangle of the velocity polygon.

    kind              ``turning``: A and P are points of one body; ``sliding``: they coincide, and P's body slides on A's
    body, on          of P and of A
    a, p              names of the points
    at_a, at_p        (n,) complex [m]
    v_a, v_pa, v_p    (n,) complex, by the motion's angle: V_A and V_P by the poses, V_PA by the angular velocity or the
                      direction of the guide alone
    """

    kind: str
    body: str
    on: str
    a: str
    p: str
    at_a: np.ndarray
    at_p: np.ndarray
    v_a: np.ndarray
    v_pa: np.ndarray
    v_p: np.ndarray

    @property
    def gap(self) -> np.ndarray:
        """(n,) by how much V_A + V_PA misses V_P: rounding alone."""
        return np.abs(self.v_a + self.v_pa - self.v_p)


def velocity_differences(kinematics: Kinematics) -> Iterator[PolygonTriangle]:
    """The triangles of a mechanism: of every moving body for each two of its points, A being its pivot on the frame or the
    one nearer to the driver; then of every sliding pair."""
    for name, body in kinematics.bodies.items():
        if name != FRAME:
            for a, p in combinations(_outwards(kinematics, name), 2):
                yield _turning(name, body, a, p)
    for pair in kinematics.pairs.values():
        if pair.kind == SLIDING:
            yield _sliding(kinematics, pair)


def _outwards(kinematics: Kinematics, name: str) -> list[str]:
    """The named points of a body: its pivot on the frame before the one by which it is reached first, then the others."""
    named = [point for point in kinematics.bodies[name].points if not point.isdecimal()]
    fixed = kinematics.bodies[FRAME].points if FRAME in kinematics.bodies else {}
    joined = [pair.point for pair in kinematics.pairs.values() if pair.body == name and pair.point in named]
    return sorted(named, key=lambda point: (point not in fixed, point not in joined[:1]))


def _turning(name: str, body: Pose, a: str, p: str) -> PolygonTriangle:
    turned = 1j * body.turn[1] * (body.points[p] - body.points[a]) * body.unit
    return PolygonTriangle(
        TURNING, name, name, a, p, body.place(a), body.place(p), body.place(a, 1), turned, body.place(p, 1)
    )


def _sliding(kinematics: Kinematics, pair: Pair) -> PolygonTriangle:
    """P is the pin of the link that slides, where it has one; A the point of the other that lies under it now."""
    axis = kinematics.line(pair)
    swapped = pair.point.isdecimal() and body_name(int(pair.point)) == pair.on
    name, on = (pair.on, pair.body) if swapped else (pair.body, pair.on)
    body, line = kinematics.bodies[name], kinematics.bodies.get(on, FRAME_POSE)
    p = next(iter(_outwards(kinematics, name)), pair.point)
    place, speed = body.place(p), body.place(p, 1)
    under = line.origin[1] + 1j * line.turn[1] * (place - line.origin[0])
    return PolygonTriangle(SLIDING, name, on, p, p, place, place, under, dot(speed - under, axis) * axis, speed)


# -- the polygon ------------------------------------------------------------------------------------------

Corner = tuple[str, str]
"""A point and, of one that only coincides with it, the body it belongs to, else empty."""
POLE: Corner = ("", FRAME)


@frozen(eq=False)
class PolygonSide:
    """One vector of the polygon: absolute from the pole, else a difference; ``body`` turns with it, or slides.

    vector (n,) complex, by the motion's angle
    """

    kind: str
    body: str
    start: Corner
    end: Corner
    vector: np.ndarray


@frozen(eq=False)
class VelocityPolygon:
    """Where the velocities end that start at the pole: corner -> (n,) complex, by the motion's angle; the vectors between
    them; ``images``: of each body with three points or more the corners of its velocity image."""

    corners: Mapping[Corner, np.ndarray]
    sides: tuple[PolygonSide, ...]
    images: Mapping[str, tuple[Corner, ...]]

    @property
    def steps(self) -> tuple[PolygonSide, ...]:
        """The vectors in the order in which they are constructed: V_A, then V_PA from its end, then V_P = V_A + V_PA."""
        absolute = {side.end: side for side in self.sides if side.kind == ABSOLUTE}
        order: dict[tuple[Corner, Corner], PolygonSide] = {}
        for side in self.sides:
            if side.kind != ABSOLUTE:
                for each in (absolute.get(side.start), side, absolute.get(side.end)):
                    if each is not None:
                        order.setdefault((each.start, each.end), each)
        return (*order.values(), *(side for key, side in absolute.items() if (POLE, key) not in order))

    @property
    def longest(self) -> np.ndarray:
        """Length (n,) [m per rad] of the longest velocity from the pole."""
        return np.max([np.abs(v) for v in self.corners.values()] or [np.zeros(1)], axis=0)


def velocity_polygon(kinematics: Kinematics) -> VelocityPolygon:
    """All velocities of a mechanism's points from one pole, with their differences; points of the frame are the pole."""
    fixed = set(kinematics.bodies[FRAME].points) if FRAME in kinematics.bodies else set()
    corners: dict[Corner, np.ndarray] = {}
    sides: list[PolygonSide] = []
    images: dict[str, tuple[Corner, ...]] = {}

    def corner(point: str, body: str, velocity: np.ndarray, owner: str) -> Corner:
        key = POLE if (point in fixed and not body) or body == FRAME else (point, body)
        if key != POLE and key not in corners:
            corners[key] = velocity
            sides.append(PolygonSide(ABSOLUTE, owner, POLE, key, velocity))
        return key

    for d in velocity_differences(kinematics):
        start = corner(d.a, d.on if d.kind == SLIDING else "", d.v_a, d.on)
        end = corner(d.p, "", d.v_p, d.body)
        if POLE not in (start, end):
            sides.append(PolygonSide(d.kind, d.body, start, end, d.v_pa))
    for name, body in kinematics.bodies.items():
        own = [(p, "") if p not in fixed else POLE for p in body.points if not p.isdecimal()]
        if name != FRAME and len(own) > 2:
            images[name] = tuple(own)
    return VelocityPolygon(MappingProxyType(corners), tuple(sides), MappingProxyType(images))
