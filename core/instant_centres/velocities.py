"""Velocity polygon, and velocity ratios by instant centres: directed distances and mechanical advantage.

Source: lecture *Velocity*, 6.1 and 6.4.
"""

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

# -- velocity differences V_P = V_A + V_PA ----------------------------------------------------------------------


TURNING = "turning"
ABSOLUTE = "absolute"


@frozen(eq=False)
class PolygonTriangle:
    """One triangle V_P = V_A + V_PA of the velocity polygon.

    Attributes
    ----------
    kind : str
        TURNING: A and P are points of one body; SLIDING: A and P coincide, and the body of P slides on that of A.
    body, on : str
        Bodies of P and of A.
    a, p : str
        Names of the points.
    at_a, at_p : ndarray (n,) complex [m]
        Positions of A and P.
    v_a, v_pa, v_p : ndarray (n,) complex [m/rad]
        By the motion's angle: V_A and V_P from the poses, V_PA from the angular velocity or the direction of the guide.
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
        """Closure error |V_A + V_PA - V_P| (n,) [m/rad], which is only rounding."""
        return np.abs(self.v_a + self.v_pa - self.v_p)


def velocity_differences(kinematics: Kinematics) -> Iterator[PolygonTriangle]:
    """Velocity triangles of every two points of each moving body, then of every sliding pair.

    Point A is the body's pivot on the frame, or the point nearer to the driver.
    """
    for name, body in kinematics.bodies.items():
        if name != FRAME:
            yield from (_turning(name, body, a, p) for a, p in combinations(_outwards(kinematics, name), 2))
    yield from (_sliding(kinematics, pair) for pair in kinematics.pairs.values() if pair.kind == SLIDING)


def _outwards(kinematics: Kinematics, name: str) -> list[str]:
    """Named points of a body: its pivot on the frame, the point of its first pair, then the others."""
    named = [point for point in kinematics.bodies[name].points if not point.isdecimal()]
    fixed = kinematics.bodies[FRAME].points if FRAME in kinematics.bodies else {}
    paired = [pair.point for pair in kinematics.pairs.values() if pair.body == name and pair.point in named]
    return sorted(named, key=lambda point: (point not in fixed, point not in paired[:1]))


def _turning(name: str, body: Pose, a: str, p: str) -> PolygonTriangle:
    v_pa = 1j * body.turn[1] * (body.points[p] - body.points[a]) * body.unit
    return PolygonTriangle(
        TURNING, name, name, a, p, body.position(a), body.position(p), body.position(a, 1), v_pa, body.position(p, 1)
    )


def _sliding(kinematics: Kinematics, pair: Pair) -> PolygonTriangle:
    """P is the pin of the sliding link, where it has one; A is the coincident point of the other body."""
    axis = kinematics.line(pair)
    is_swapped = pair.point.isdecimal() and body_name(int(pair.point)) == pair.on
    name, on = (pair.on, pair.body) if is_swapped else (pair.body, pair.on)
    body, line = kinematics.bodies[name], kinematics.bodies.get(on, FRAME_POSE)
    p = next(iter(_outwards(kinematics, name)), pair.point)
    at_p, v_p = body.position(p), body.position(p, 1)
    v_a = line.origin[1] + 1j * line.turn[1] * (at_p - line.origin[0])
    return PolygonTriangle(SLIDING, name, on, p, p, at_p, at_p, v_a, dot(v_p - v_a, axis) * axis, v_p)


# -- velocity polygon -------------------------------------------------------------------------------------------

Corner = tuple[str, str]
"""Name of a point, and the body of a point that only coincides with it, else empty."""
POLE: Corner = ("", FRAME)


@frozen(eq=False)
class PolygonSide:
    """One vector of the polygon, absolute from the pole or a difference.

    Attributes
    ----------
    kind : str
        ABSOLUTE, TURNING or SLIDING.
    body : str
        Body whose motion the vector shows.
    start, end : Corner
    vector : ndarray (n,) complex [m/rad]
        Velocity by the motion's angle.
    """

    kind: str
    body: str
    start: Corner
    end: Corner
    vector: np.ndarray


@frozen(eq=False)
class VelocityPolygon:
    """Velocities of a mechanism's points from one pole.

    Attributes
    ----------
    corners : mapping of Corner to ndarray (n,) complex [m/rad]
        Absolute velocities by the motion's angle.
    sides : tuple of PolygonSide
    images : mapping of str to tuple of Corner
        Corners of the velocity image of each body with three points or more.
    """

    corners: Mapping[Corner, np.ndarray]
    sides: tuple[PolygonSide, ...]
    images: Mapping[str, tuple[Corner, ...]]

    @property
    def steps(self) -> tuple[PolygonSide, ...]:
        """Vectors in the order of the construction: V_A, V_PA from its end, then V_P = V_A + V_PA."""
        absolute = {side.end: side for side in self.sides if side.kind == ABSOLUTE}
        order: dict[tuple[Corner, Corner], PolygonSide] = {}
        for side in self.sides:
            if side.kind != ABSOLUTE:
                for vector in (absolute.get(side.start), side, absolute.get(side.end)):
                    if vector is not None:
                        order.setdefault((vector.start, vector.end), vector)
        return (*order.values(), *(side for key, side in absolute.items() if (POLE, key) not in order))

    @property
    def longest(self) -> np.ndarray:
        """Length (n,) [m/rad] of the longest velocity from the pole."""
        return np.max([np.abs(v) for v in self.corners.values()] or [np.zeros(1)], axis=0)


def velocity_polygon(kinematics: Kinematics) -> VelocityPolygon:
    """Velocity polygon of a mechanism; points of the frame are the pole."""
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
        image = [(p, "") if p not in fixed else POLE for p in body.points if not p.isdecimal()]
        if name != FRAME and len(image) > 2:
            images[name] = tuple(image)
    return VelocityPolygon(MappingProxyType(corners), tuple(sides), MappingProxyType(images))


# -- velocity ratios by instant centres -------------------------------------------------------------------------


def angular_ratio(table: CentreTable, body: str, driver: str) -> np.ndarray:
    """Ratio of angular velocities, ω_b/ω_d = I_1d I_db / I_1b I_db, with directed distances on the line of the three centres.

    Parameters
    ----------
    table : CentreTable
    body, driver : str
        Bodies b and d.

    Returns
    -------
    ndarray (n,), dimensionless
        0 where the body's centre on the frame is at infinity; NaN where the three centres coincide.

    References
    ----------
    Lecture *Velocity*, 6.4.
    """
    return ratio_arms(table, body, driver).ratio


def mechanical_advantage(table: CentreTable, output: str, driver: str) -> np.ndarray:
    """Mechanical advantage without losses, torque at the output per torque at the driver: ω_driver/ω_output.

    Parameters
    ----------
    table : CentreTable
    output, driver : str
        Bodies.

    Returns
    -------
    ndarray (n,), dimensionless

    References
    ----------
    Lecture *Velocity*, 6.4.
    """
    with np.errstate(divide="ignore"):
        return 1.0 / angular_ratio(table, output, driver)


@frozen(eq=False)
class RatioArms:
    """Two distances on one line whose quotient is a velocity ratio, as both bodies have one velocity at their common centre.

    Attributes
    ----------
    body, base : str
        The ratio is ω_body/ω_base.
    base_key, body_key, common_key : Key
        Keys of the centres I_1base, I_1body and I_base,body.
    base_arm : ndarray (n,) [m]
        Distance I_1base I_base,body, not negative.
    body_arm : ndarray (n,) [m]
        Distance I_1body I_base,body, negative in the opposite direction; infinite where the body does not turn and has the
        velocity ω_base · base_arm.
    ratio : ndarray (n,), dimensionless
    """

    body: str
    base: str
    base_key: Key
    body_key: Key
    common_key: Key
    base_arm: np.ndarray
    body_arm: np.ndarray
    ratio: np.ndarray


def ratio_arms(table: CentreTable, body: str, base: str) -> RatioArms:
    """Distances that give the angular velocity of a body from that of another moving body."""
    keys = table.key(FRAME, base), table.key(FRAME, body), table.key(base, body)
    base_pole, body_pole, common = (table.centres[key] for key in keys)
    to_base, to_body = _arm(common, base_pole), _arm(common, body_pole)
    # the common direction is that of the longer arm
    along = np.where(np.abs(to_base) > np.abs(to_body), to_base, to_body)
    with np.errstate(divide="ignore", invalid="ignore"):
        above, below = (to_base * along.conjugate()).real, (to_body * along.conjugate()).real
        ratio = np.asarray(body_pole.weight * above / (base_pole.weight * below)) + 0.0
        base_arm = np.abs(to_base / (common.weight * base_pole.weight))
        body_arm = np.abs(to_body / (common.weight * body_pole.weight))
        body_arm = np.where(body_pole.is_far(table.size), np.inf, np.where(ratio < 0.0, -body_arm, body_arm))
    return RatioArms(body, base, *keys, base_arm, body_arm, ratio)


def _arm(common: Centres, pole: Centres) -> np.ndarray:
    """Vector (n,) from the pole to the common centre, times both weights."""
    return np.asarray(common.point * pole.weight - pole.point * common.weight)


# -- compared bodies --------------------------------------------------------------------------------------------


def to_driver(table: CentreTable, driver: str) -> tuple[tuple[str, str], ...]:
    """Pairs of every moving body and the driver."""
    return tuple((body, driver) for body in table.bodies if body not in (FRAME, driver))


def link_by_link(table: CentreTable, driver: str) -> tuple[tuple[str, str], ...]:
    """Pairs of every moving body and the body before it to which it is pinned, from the driver outwards; else the driver."""
    reached, pairs = [driver], []
    remaining = [body for body in table.bodies if body not in (FRAME, driver)]
    while remaining:
        pinned = ((body, base) for base in reached for body in remaining if _is_pinned(table, body, base))
        body, base = next(pinned, (remaining[0], driver))
        pairs.append((body, base))
        reached.append(body)
        remaining.remove(body)
    return tuple(pairs)


def _is_pinned(table: CentreTable, a: str, b: str) -> bool:
    key = table.key(a, b)
    return key in table.primary and bool((table.centres[key].weight != 0.0).all())


CHAINS: Mapping[str, Callable[[CentreTable, str], tuple[tuple[str, str], ...]]] = MappingProxyType(
    {"ratios": to_driver, "chain": link_by_link}
)
"""Function for the compared bodies: each with the driver, or from link to link."""
