"""Velocity ratios by instant centres: angular velocities with directed distances, mechanical advantage (Velocity, 6.4)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import combinations
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.instant_centres.centres import CentreTable
from core.instant_centres.construction import Centres, Key
from core.mechanism.kinematics import FRAME, FRAME_POSE, SLIDING, Kinematics, Pair, Pose
from core.mechanism.mechanism import body_name
from core.numerics.derivatives import dot

# -- velocity differences, V_P = V_A + V_PA, and the polygon they make from one pole (Velocity, 6.1) ------------


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
        TURNING, name, name, a, p, body.position(a), body.position(p), body.position(a, 1), turned, body.position(p, 1)
    )


def _sliding(kinematics: Kinematics, pair: Pair) -> PolygonTriangle:
    """P is the pin of the link that slides, where it has one; A the point of the other that lies under it now."""
    axis = kinematics.line(pair)
    swapped = pair.point.isdecimal() and body_name(int(pair.point)) == pair.on
    name, on = (pair.on, pair.body) if swapped else (pair.body, pair.on)
    body, line = kinematics.bodies[name], kinematics.bodies.get(on, FRAME_POSE)
    p = next(iter(_outwards(kinematics, name)), pair.point)
    place, speed = body.position(p), body.position(p, 1)
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


# -- velocity ratios by instant centres -------------------------------------------------------------------------


def angular_ratio(table: CentreTable, body: str, driver: str) -> np.ndarray:
    """ω_body/ω_driver = I_1d I_db / I_1b I_db, distances directed along the line of the three centres (n,).

    A centre of the body on the frame at infinity gives 0: it does not turn. NaN where the three coincide.
    """
    return ratio_arms(table, body, driver).ratio


def mechanical_advantage(table: CentreTable, output: str, driver: str) -> np.ndarray:
    """Torque at the output for a torque of 1 at the driver, without losses: ω_driver/ω_output (n,)."""
    with np.errstate(divide="ignore"):
        return 1.0 / angular_ratio(table, output, driver)


@frozen(eq=False)
class RatioArms:
    """Two distances on one line whose quotient is a velocity ratio: both bodies have one velocity at their common centre.

    body, base             the ratio is ω_body/ω_base
    other, own, common     the keys of I_1base, I_1body and I_base,body
    base_arm               (n,) I_1base I_base,body [m], never negative
    body_arm               (n,) I_1body I_base,body [m], negative where it points the other way; infinite where the body
                           does not turn: its velocity is then ω_base · base_arm
    ratio                  (n,)
    """

    body: str
    base: str
    other: Key
    own: Key
    common: Key
    base_arm: np.ndarray
    body_arm: np.ndarray
    ratio: np.ndarray


def ratio_arms(table: CentreTable, body: str, base: str) -> RatioArms:
    """The distances by which a body's angular velocity follows from that of another moving body."""
    keys = table.key(FRAME, base), table.key(FRAME, body), table.key(base, body)
    other, own, common = (table.centres[key] for key in keys)
    to_base, to_body = _arm(common, other), _arm(common, own)
    # the three lie on one line: along the longer of the two arms
    along = np.where(np.abs(to_base) > np.abs(to_body), to_base, to_body)
    with np.errstate(divide="ignore", invalid="ignore"):
        above, below = (to_base * along.conjugate()).real, (to_body * along.conjugate()).real
        ratio = np.asarray(own.weight * above / (other.weight * below)) + 0.0
        base_arm = np.abs(to_base / (common.weight * other.weight))
        body_arm = np.abs(to_body / (common.weight * own.weight))
        body_arm = np.where(own.far(table.size), np.inf, np.where(ratio < 0.0, -body_arm, body_arm))
    return RatioArms(body, base, *keys, base_arm, body_arm, ratio)


def _arm(common: Centres, held: Centres) -> np.ndarray:
    """From one centre to another, times both weights (n,)."""
    return np.asarray(common.point * held.weight - held.point * common.weight)


# -- which bodies are compared --------------------------------------------------------------------------------


def to_driver(table: CentreTable, driver: str) -> tuple[tuple[str, str], ...]:
    """Every moving body with the driver."""
    return tuple((body, driver) for body in table.bodies if body not in (FRAME, driver))


def link_by_link(table: CentreTable, driver: str) -> tuple[tuple[str, str], ...]:
    """Every moving body with the one on whose pin it hangs, from the driver outwards, as the lecture goes through its
    six-bar; with the driver where no pin joins it to a body before it."""
    reached, found = [driver], []
    waiting = [body for body in table.bodies if body not in (FRAME, driver)]
    while waiting:
        pinned = ((body, base) for base in reached for body in waiting if _pinned(table, body, base))
        body, base = next(pinned, (waiting[0], driver))
        found.append((body, base))
        reached.append(body)
        waiting.remove(body)
    return tuple(found)


def _pinned(table: CentreTable, a: str, b: str) -> bool:
    key = table.key(a, b)
    return key in table.primary and bool((table.centres[key].weight != 0.0).all())


CHAINS: Mapping[str, Callable[[CentreTable, str], tuple[tuple[str, str], ...]]] = MappingProxyType(
    {"ratios": to_driver, "chain": link_by_link}
)
"""Which body is compared with which: each with the driver, or from link to link."""
