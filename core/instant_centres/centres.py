"""Instant centres of all bodies by velocities and pairs, of follower and cam by Kennedy's theorem, and the proof by collinearity.

Source: Shin 1995 §3 for follower and cam.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import combinations
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.instant_centres.construction import Centres, Construction, Key, agreement, construction, kennedy, key_of
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics, Pair, Pose
from core.numerics.derivatives import dot

# -- all n(n-1)/2 instant centres of a mechanism ----------------------------------------------------------------


EPS = float(np.finfo(float).eps)
_AT_REST = 1e3 * EPS  # relative velocity, as a part of the fastest, below which two bodies have no relative motion
_AGREES = 1e-6  # of unit vectors: lines that miss a centre by more have no common point


@frozen(eq=False)
class CentreTable:
    """Instant centres of all bodies of a mechanism.

    Attributes
    ----------
    bodies : tuple of str
        Names, the frame first.
    centres : mapping of Key to Centres
        Centres (n,) by pair of names, in the order of `bodies`, scaled to the size.
    primary : frozenset of Key
        Pairs of bodies whose centre is given by a pin or a guide.
    size : float
        Size [m] of the mechanism.
    """

    bodies: tuple[str, ...]
    centres: Mapping[Key, Centres]
    primary: frozenset[Key]
    size: float

    @cached_property
    def construction(self) -> Construction:
        """Order in which Kennedy's theorem gives the other centres."""
        return construction(self.bodies, self.primary)

    @cached_property
    def _order(self) -> Mapping[str, int]:
        return {name: i for i, name in enumerate(self.bodies)}

    def key(self, a: str, b: str) -> Key:
        """Key of two bodies, given in either order."""
        return key_of(a, b, self._order)

    def centre(self, a: str, b: str) -> Centres:
        """Centre of two bodies, given in either order."""
        return self.centres[self.key(a, b)]


def centres_in_motion(
    kinematics: Kinematics, size: float, names: tuple[str, ...], keys: Iterable[Key] = ()
) -> tuple[dict[Key, Centres], dict[Key, np.ndarray], frozenset[Key]]:
    """Instant centres of a moving mechanism: primary ones from the pairs, all others from velocities.

    A centre from velocities has a large error bound where the two bodies have no relative velocity.

    Parameters
    ----------
    kinematics : Kinematics
        With a moving driver.
    size : float
        Size [m] of the mechanism.
    names : tuple of str
        Bodies.
    keys : iterable of Key
        Pairs of bodies whose centres are computed; by default all.

    Returns
    -------
    centres : dict of Key to Centres
        Scaled to the size.
    motion : dict of Key to ndarray (n,), dimensionless
        Relative velocity of the two bodies, as a part of that of the fastest body.
    primary : frozenset of Key
        Pairs of bodies whose centre is given by a pin or a guide.
    """
    order = {name: i for i, name in enumerate(names)}
    primary = {key: centre.scaled(size) for key, centre in primary_pairs(kinematics, order).items()}
    speed = max(
        (float(np.abs(p.turn[1]).max()) * size + float(np.abs(p.origin[1]).max()) for p in kinematics.bodies.values()),
        default=0.0,
    )
    centres: dict[Key, Centres] = {}
    motion: dict[Key, np.ndarray] = {}
    for key in keys or combinations(names, 2):
        centre = _by_velocity(kinematics.bodies[key[0]], kinematics.bodies[key[1]])
        motion[key] = np.hypot(np.abs(centre.point), centre.weight * size) / speed
        if key in primary:
            centres[key] = primary[key]
            continue
        with np.errstate(divide="ignore"):
            error_bound = np.maximum(1.0, 1.0 / motion[key])  # nearly equal velocities cancel
        centres[key] = replace(centre.scaled(size), error_bound=error_bound)
    return centres, motion, frozenset(primary)


def all_centres(kinematics: Kinematics, size: float, bodies: Iterable[str] = ()) -> CentreTable:
    """Instant centres of some bodies, by default of all, at all positions.

    The driver must move, as in `unit_speed_kinematics`. Where two bodies have no relative velocity at a position, Kennedy's
    construction gives the limit; point and weight are 0 where they never have any, so that every point is a centre.
    """
    names = tuple(bodies) or tuple(kinematics.bodies)
    centres, motion, primary = centres_in_motion(kinematics, size, names)
    resting = {key: rests for key in centres if key not in primary and (rests := motion[key] <= _AT_REST).any()}
    for step in construction(names, primary).steps if resting else ():
        if step.key in resting:
            limit, current = kennedy(centres, step, size).scaled(size), centres[step.key]
            agrees, rests = agreement(centres, step, limit, size) < _AGREES, resting[step.key]
            centres[step.key] = Centres(
                np.where(rests, np.where(agrees, limit.point, 0.0), current.point),
                np.where(rests, np.where(agrees, limit.weight, 0.0), current.weight),
                current.error_bound,
            )
    return CentreTable(names, MappingProxyType(centres), primary, size)


def _by_velocity(a: Pose, b: Pose) -> Centres:
    """Point P with the same velocity on both bodies: z_a' + iω_a(P - z_a) = z_b' + iω_b(P - z_b)."""
    wa, wb = a.turn[1], b.turn[1]
    return Centres(wb * b.origin[0] - wa * a.origin[0] + 1j * (b.origin[1] - a.origin[1]), wb - wa)


def primary_pairs(kinematics: Kinematics, order: Mapping[str, int]) -> dict[Key, Centres]:
    """Centres given by pairs: at a pin for every two links on it, and at infinity across a guide."""
    centres: dict[Key, Centres] = {}
    pins: dict[str, set[str]] = {}
    for pair in kinematics.pairs.values():
        if pair.kind == REVOLUTE:
            pins.setdefault(pair.point, set()).update((pair.on, pair.body))
        elif pair.on in order and pair.body in order:
            across = 1j * kinematics.line(pair)
            centres[key_of(pair.on, pair.body, order)] = Centres(across, np.zeros(across.size))
    for name, links in pins.items():
        for a, b in combinations([n for n in links if n in order], 2):
            key = key_of(a, b, order)
            at = kinematics.bodies[key[0] if key[0] != FRAME else key[1]].position(name)
            centres[key] = Centres(at, np.ones(at.size))
    return dict(sorted(centres.items(), key=lambda item: (order[item[0][0]], order[item[0][1]])))


# -- instant centre of follower and cam -------------------------------------------------------------------------


CAM, CAMSHAFT = "cam", "camshaft"
"""Names of the cam as a body, and of its pin on the frame."""

_LARGEST_BOUND = 1e6


def cam_follower_centre(kinematics: Kinematics, rotation_sign: float) -> Centres:
    """Instant centre of follower and cam, Q = kp/(φ' - d), φ' = kw.

    By Kennedy's theorem Q is on the line through the cam centre and the pole p/w of the follower's link on the frame, which is its
    pivot, the point at infinity across its guide, or given by the circle diagram. The velocity of the reference point,
    R' = ik(wR - p), gives k. Where R is the pole, or the pole is unknown or uncertain, Q = (φ'R + iR')/(φ' - d). The source's
    (18) counts φ' against the cam.

    Parameters
    ----------
    kinematics : Kinematics
    rotation_sign : float
        d: +1 for a cam that turns counter-clockwise, -1 clockwise.

    Returns
    -------
    Centres

    References
    ----------
    Shin 1995 §3, eq. (18).
    """
    follower = kinematics.follower
    turn, z, speed = follower.turn[1], follower.origin[0], follower.origin[1]
    point, weight = turn * z + 1j * speed, turn - rotation_sign
    pole = _pole(kinematics)
    if pole is None:
        return Centres(point, weight)
    arm = 1j * (pole.weight * z - pole.point)
    square = dot(arm, arm)
    with np.errstate(divide="ignore", invalid="ignore"):
        k = dot(arm, speed) / square
        # relative to the pole's distance from R
        error_bound = pole.error_bound * np.abs(z).max() / np.sqrt(square)
    known = error_bound < _LARGEST_BOUND
    return Centres(np.where(known, k * pole.point, point), weight, np.where(known, np.maximum(error_bound, 1.0), 1.0))


def cam_centres(kinematics: Kinematics, rotation_sign: float) -> CentreTable:
    """Instant centres of the frame, the links that the cam drives, and the cam, which is the last body.

    The centre of cam and follower, `cam_follower_centre`, is a primary one, as the contact normal gives it. Since the cam always
    turns, each link has a centre on it in a dwell too; Kennedy's construction then gives those between the links.
    """
    theta = kinematics.theta
    row = np.zeros((4, theta.size))
    turn = row.copy()
    turn[0], turn[1] = rotation_sign * theta, rotation_sign
    cam, frame = Pose.of(row + 0j, turn, MappingProxyType({CAMSHAFT: 0j})), Pose.of(row + 0j, row)
    paired = {name for pair in kinematics.pairs.values() for name in (pair.on, pair.body)}
    names = (FRAME, *(name for name in kinematics.bodies if name in paired and name != FRAME), CAM)
    with_cam = replace(
        kinematics,
        bodies=MappingProxyType({FRAME: frame, **kinematics.bodies, CAM: cam}),
        pairs=MappingProxyType({**kinematics.pairs, CAMSHAFT: Pair(REVOLUTE, FRAME, CAM, CAMSHAFT)}),
    )
    size = _size(kinematics)
    table = all_centres(with_cam, size, names)
    contact = {table.key(kinematics.carrier, CAM): cam_follower_centre(kinematics, rotation_sign).scaled(size)}
    return replace(
        table, centres=MappingProxyType({**table.centres, **contact}), primary=table.primary | frozenset(contact)
    )


def _size(kinematics: Kinematics) -> float:
    """Largest distance of the follower from the camshaft [m], rounded up to a power of two, which scales without rounding.

    So a centre does not depend on the other positions that are calculated with it.
    """
    _, exponent = np.frexp(np.abs(kinematics.follower.origin[0]).max())
    return float(np.ldexp(1.0, exponent))


def _pole(kinematics: Kinematics) -> Centres | None:
    """Centre of the follower's link on the frame, from the pairs and scaled; None where the construction does not reach it."""
    names = tuple(
        dict.fromkeys(
            (FRAME, *(name for name in kinematics.bodies if name != kinematics.follower_body), kinematics.carrier)
        )
    )
    order = {name: i for i, name in enumerate(names)}
    size = _size(kinematics)
    centres = {key: centre.scaled(size) for key, centre in primary_pairs(kinematics, order).items()}
    key = (FRAME, kinematics.carrier)
    for step in () if key in centres else construction(names, frozenset(centres)).steps:
        centres[step.key] = kennedy(centres, step, size).scaled(size)
    return centres.get(key)


# -- Kennedy's theorem as a proof of a table of centres ---------------------------------------------------------


Triple = tuple[str, str, str]
PROVEN = 12  # most bodies of which every centre is proven, as many as a table shows


@frozen(eq=False)
class Collinearity:
    """Kennedy's theorem for T triples of bodies at n positions.

    Attributes
    ----------
    triples : tuple of Triple
        Names of the bodies.
    zero : ndarray (T, n), dimensionless
        Determinant of the three centres' coordinates, each a vector (point/size, weight) of length 1; 0 by the theorem.
    error_bound : ndarray (T, n), dimensionless
        Error of the determinant as a multiple of that of the poses; infinite where the three bodies have no relative motion, for
        which the theorem does not hold.
    """

    triples: tuple[Triple, ...]
    zero: np.ndarray
    error_bound: np.ndarray


def proving_triples(bodies: tuple[str, ...], primary: Iterable[Key]) -> tuple[Triple, ...]:
    """Triples of b bodies that contain every centre, about b²/2 of all b³/6.

    First the frame (the first body) with every two others, λ_ab P_ab = λ_fb P_fb - λ_fa P_fa with the relative angular velocities
    λ; the equation of any other triple is the sum of three of these. Then, for every two bodies, a third one with a pair to both:
    the line through these two centres is known without velocities.
    """
    primary_keys = {frozenset(key) for key in primary}
    neighbours = {name: {n for key in primary_keys if name in key for n in key - {name}} for name in bodies}
    order = {name: i for i, name in enumerate(bodies)}
    frame, *others = bodies
    triples = dict.fromkeys((frame, a, b) for a, b in combinations(others, 2))
    for a, b in combinations(bodies, 2):
        common = neighbours[a] & neighbours[b]
        if common:
            third = min(common, key=order.__getitem__)
            first, second, last = sorted((a, b, third), key=order.__getitem__)
            triples[first, second, last] = None
    return tuple(triples)


def joining_triples(bodies: tuple[str, ...], primary: Iterable[Key]) -> tuple[Triple, ...]:
    """The frame with every two bodies that have a pair, about b of them.

    The centre of the pair is on the line through the centres of both bodies on the frame. The other centres follow from those on
    the frame, by the sums of `proving_triples`.
    """
    frame = bodies[0]
    return tuple((frame, a, b) for a, b in primary if frame not in (a, b))


def collinearity(table: CentreTable) -> np.ndarray:
    """Largest determinant of the proving triples of a table of centres, 0 by Kennedy's theorem.

    Parameters
    ----------
    table : CentreTable

    Returns
    -------
    ndarray (n,), dimensionless
    """
    triples = proving_triples(table.bodies, table.primary)
    return np.asarray(_determinants(table.centres, triples, table.size).max(axis=0, initial=0.0))


def moving_collinearity(kinematics: Kinematics, size: float) -> Collinearity:
    """Kennedy's theorem at every position of a mechanism whose driver moves; size [m] of the mechanism.

    For more bodies than `PROVEN` only the centres on the frame are proven. The error bound of a determinant is that of its worst
    centre, and at least the inverse of the largest relative velocity of the three bodies, since three links pinned to each other in
    a triangle have pins but no instant centres.
    """
    bodies = tuple(kinematics.bodies)
    order = {name: i for i, name in enumerate(bodies)}
    triples = (proving_triples if len(bodies) <= PROVEN else joining_triples)(bodies, primary_pairs(kinematics, order))
    keys = dict.fromkeys(key for triple in triples for key in combinations(triple, 2))
    centres, motion, _ = centres_in_motion(kinematics, size, bodies, keys)
    n = kinematics.theta.size
    rows = {key: np.broadcast_to(np.asarray(centre.error_bound, dtype=float), (n,)) for key, centre in centres.items()}
    with np.errstate(divide="ignore"):
        standstill = 1.0 / _by_triple({key: np.broadcast_to(m, (n,)) for key, m in motion.items()}, triples).max(axis=1)
    error_bound = np.maximum(_by_triple(rows, triples).max(axis=1), standstill)
    return Collinearity(triples, _determinants(centres, triples, size), error_bound)


def _by_triple(rows: Mapping[Key, np.ndarray], triples: tuple[Triple, ...]) -> np.ndarray:
    """Rows of the centres (a, b), (b, c), (a, c) of every triple (T, 3, ...)."""
    at = {key: i for i, key in enumerate(rows)}
    which = [(at[a, b], at[b, c], at[a, c]) for a, b, c in triples]
    return np.array(list(rows.values()))[np.array(which, dtype=int).reshape(-1, 3)]


def _determinants(centres: Mapping[Key, Centres], triples: tuple[Triple, ...], size: float) -> np.ndarray:
    """Determinants |h1 · (h2 × h3)| (T, n)."""
    points = _by_triple({key: centre.point / size for key, centre in centres.items()}, triples)
    weights = _by_triple({key: centre.weight for key, centre in centres.items()}, triples)
    (x1, x2, x3), (y1, y2, y3) = np.moveaxis(points.real, 1, 0), np.moveaxis(points.imag, 1, 0)
    w1, w2, w3 = np.moveaxis(weights, 1, 0)
    return np.asarray(np.abs(x1 * (y2 * w3 - y3 * w2) + y1 * (w2 * x3 - w3 * x2) + w1 * (x2 * y3 - x3 * y2)))
