"""The instant centre of a follower and its cam, by Kennedy's theorem from the pole of the follower's link."""

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

# -- all n(n-1)/2 instant centres of a solved mechanism ---------------------------------------------------------


EPS = float(np.finfo(float).eps)
_AT_REST = 1e3 * EPS  # relative velocity, against those of the driver, below which two bodies do not move on each other
_AGREES = 1e-6  # of unit vectors: lines that miss a centre by more have none in common


@frozen(eq=False)
class CentreTable:
    """The centres of all bodies of a mechanism.

    bodies        their names, the frame first
    centres       pair of names, in the order of ``bodies`` -> Centres (n,), scaled to the size
    primary       the pairs whose centre a pin or a guide shows at sight
    size          [m] of the mechanism
    """

    bodies: tuple[str, ...]
    centres: Mapping[Key, Centres]
    primary: frozenset[Key]
    size: float

    @cached_property
    def construction(self) -> Construction:
        """In which order Kennedy's theorem finds the others."""
        return construction(self.bodies, self.primary)

    @cached_property
    def _order(self) -> Mapping[str, int]:
        return {name: i for i, name in enumerate(self.bodies)}

    def key(self, a: str, b: str) -> Key:
        """The key of two bodies, given in either order."""
        return key_of(a, b, self._order)

    def of(self, a: str, b: str) -> Centres:
        """The centre of two bodies, in either order."""
        return self.centres[self.key(a, b)]


def centres_in_motion(
    kinematics: Kinematics, size: float, names: tuple[str, ...], wanted: Iterable[Key] = ()
) -> tuple[dict[Key, Centres], dict[Key, np.ndarray], frozenset[Key]]:
    """Centres scaled to the size, in the order of the names (of those wanted only, where any are): of the pairs at sight, of all others
    by velocity; how much the two bodies move against each other (n,), as a part of the fastest body's velocity; and which are seen.

    Where two bodies have no velocity against each other, a centre by velocity is made of rounding, and its error bound is large.
    """
    order = {name: i for i, name in enumerate(names)}
    primary = {key: centre.scaled(size) for key, centre in primary_pairs(kinematics, order).items()}
    speed = max(
        (float(np.abs(p.turn[1]).max()) * size + float(np.abs(p.origin[1]).max()) for p in kinematics.bodies.values()),
        default=0.0,
    )
    found: dict[Key, Centres] = {}
    motion: dict[Key, np.ndarray] = {}
    for key in wanted or combinations(names, 2):
        centre = _by_velocity(kinematics.bodies[key[0]], kinematics.bodies[key[1]])
        motion[key] = np.hypot(np.abs(centre.point), centre.weight * size) / speed
        if key in primary:
            found[key] = primary[key]
            continue
        with np.errstate(divide="ignore"):
            error_bound = np.maximum(
                1.0, 1.0 / motion[key]
            )  # where both move nearly alike, little is left of their velocities
        found[key] = replace(centre.scaled(size), error_bound=error_bound)
    return found, motion, frozenset(primary)


def all_centres(kinematics: Kinematics, size: float, bodies: Iterable[str] = ()) -> CentreTable:
    """The centres of the bodies named (all of the kinematics, where none is), for all positions at once.

    The driver must move (unit speed), for a mechanism at rest has no velocities. Where two bodies happen to have
    none against each other, Kennedy's construction gives the limit; 0 (point and weight) where they never move against each
    other, and every point is a centre.
    """
    names = tuple(bodies) or tuple(kinematics.bodies)
    found, motion, primary = centres_in_motion(kinematics, size, names)
    resting = {key: rests for key in found if key not in primary and (rests := motion[key] <= _AT_REST).any()}
    for wanted in construction(names, primary).steps if resting else ():
        if wanted.key in resting:
            limit, now = kennedy(found, wanted, size).scaled(size), found[wanted.key]
            agrees, rests = agreement(found, wanted, limit, size) < _AGREES, resting[wanted.key]
            found[wanted.key] = Centres(
                np.where(rests, np.where(agrees, limit.point, 0.0), now.point),
                np.where(rests, np.where(agrees, limit.weight, 0.0), now.weight),
                now.error_bound,
            )
    return CentreTable(names, MappingProxyType(found), primary, size)


def _by_velocity(a: Pose, b: Pose) -> Centres:
    """Where both have the same velocity: z_a' + iω_a(P - z_a) = z_b' + iω_b(P - z_b)."""
    wa, wb = a.turn[1], b.turn[1]
    return Centres(wb * b.origin[0] - wa * a.origin[0] + 1j * (b.origin[1] - a.origin[1]), wb - wa)


def primary_pairs(kinematics: Kinematics, order: Mapping[str, int]) -> dict[Key, Centres]:
    """The centres that pins (at the pin, for every two links on it) and guides (at infinity across them) show."""
    found: dict[Key, Centres] = {}
    pins: dict[str, set[str]] = {}
    for pair in kinematics.pairs.values():
        if pair.kind == REVOLUTE:
            pins.setdefault(pair.point, set()).update((pair.on, pair.body))
        elif pair.on in order and pair.body in order:
            across = 1j * kinematics.line(pair)
            found[key_of(pair.on, pair.body, order)] = Centres(across, np.zeros(across.size))
    for name, links in pins.items():
        for a, b in combinations([n for n in links if n in order], 2):
            key = key_of(a, b, order)
            at = kinematics.bodies[key[0] if key[0] != FRAME else key[1]].position(name)
            found[key] = Centres(at, np.ones(at.size))
    return dict(sorted(found.items(), key=lambda item: (order[item[0][0]], order[item[0][1]])))


# -- the instant centre of a follower and its cam, by Kennedy's theorem from the pole of the --------------------


CAM, CAMSHAFT = "cam", "camshaft"
"""The cam as a body, and the pin that holds it on the frame."""

_LARGEST_BOUND = 1e6


def cam_follower_centre(kinematics: Kinematics, sense: float) -> Centres:
    """Centre Q of the follower body relative to the cam (Shin1995 §3); sense: d = +1 for a cam turning counter-clockwise, -1
    clockwise.

    By the three-centres theorem on the line through the cam centre and the pole p/w of the follower's link on the frame, which
    is its pivot, infinitely far across its guide, or where the circle diagram finds it from the pairs. The reference point R
    moves by R' = ik(wR - p), which gives k, and Q = kp/(φ' - d), φ' = kw (Shin1995 (18) counts φ' against the cam). Where R is the
    pole, no two triangles reach the pole or rounding decides it, by the velocity of R: Q = (φ'R + iR')/(φ'-d).
    """
    follower = kinematics.follower
    turn, place, speed = follower.turn[1], follower.origin[0], follower.origin[1]
    point, weight = turn * place + 1j * speed, turn - sense
    pole = _pole(kinematics)
    if pole is None:
        return Centres(point, weight)
    arm = 1j * (pole.weight * place - pole.point)
    square = dot(arm, arm)
    with np.errstate(divide="ignore", invalid="ignore"):
        k = dot(arm, speed) / square
        # relative to the pole's distance from R, which the construction knows as a part of its size
        error_bound = pole.error_bound * np.abs(place).max() / np.sqrt(square)
    known = error_bound < _LARGEST_BOUND
    return Centres(np.where(known, k * pole.point, point), weight, np.where(known, np.maximum(error_bound, 1.0), 1.0))


def cam_centres(kinematics: Kinematics, sense: float) -> CentreTable:
    """All centres of the frame, the links that the cam drives and the cam itself, which stands last; sense as in
    ``cam_follower_centre``, which gives that of cam and follower: it counts as one that a pair shows, for the contact normal does.

    The cam always turns, so that each link has a centre on it in a dwell too; those of the links on each other are then found by
    Kennedy's construction.
    """
    theta = kinematics.theta
    row = np.zeros((4, theta.size))
    turn = row.copy()
    turn[0], turn[1] = sense * theta, sense
    cam, frame = Pose.of(row + 0j, turn, MappingProxyType({CAMSHAFT: 0j})), Pose.of(row + 0j, row)
    joined = {name for pair in kinematics.pairs.values() for name in (pair.on, pair.body)}
    names = (FRAME, *(name for name in kinematics.bodies if name in joined and name != FRAME), CAM)
    whole = replace(
        kinematics,
        bodies=MappingProxyType({FRAME: frame, **kinematics.bodies, CAM: cam}),
        pairs=MappingProxyType({**kinematics.pairs, CAMSHAFT: Pair(REVOLUTE, FRAME, CAM, CAMSHAFT)}),
    )
    size = float(np.abs(kinematics.follower.origin[0]).max())
    table = all_centres(whole, size, names)
    followed = {table.key(kinematics.carrier, CAM): cam_follower_centre(kinematics, sense).scaled(size)}
    return replace(
        table, centres=MappingProxyType({**table.centres, **followed}), primary=table.primary | frozenset(followed)
    )


def _pole(kinematics: Kinematics) -> Centres | None:
    """The centre of the follower's link on the frame from the places of the pairs, scaled; None where it is not reached."""
    names = tuple(
        dict.fromkeys(
            (FRAME, *(name for name in kinematics.bodies if name != kinematics.follower_body), kinematics.carrier)
        )
    )
    order = {name: i for i, name in enumerate(names)}
    size = float(np.abs(kinematics.follower.origin[0]).max())
    found = {key: centre.scaled(size) for key, centre in primary_pairs(kinematics, order).items()}
    wanted = (FRAME, kinematics.carrier)
    for step in () if wanted in found else construction(names, frozenset(found)).steps:
        found[step.key] = kennedy(found, step, size).scaled(size)
    return found.get(wanted)


# -- the theorem of three centres as a proof of a table of centres ----------------------------------------------


Triple = tuple[str, str, str]
PROVEN = 12  # bodies of which every centre is proven: as many as a table of them all can show


@frozen(eq=False)
class Collinearity:
    """For T triples of bodies at n positions.

    triples  (T,) names of bodies
    zero     (T, n) determinant of the three centres' coordinates, each a vector (point/size, weight) of length 1: 0 by
             the theorem
    error_bound    (T, n) how many times the rounding of the poses it carries; infinite where the three bodies do not move
             against each other, and the theorem says nothing
    """

    triples: tuple[Triple, ...]
    zero: np.ndarray
    error_bound: np.ndarray


def proving_triples(bodies: tuple[str, ...], primary: Iterable[Key]) -> tuple[Triple, ...]:
    """Triples of b bodies that hold every centre, about b²/2 of the b³/6 there are.

    First the frame (the first body) with every two others: from λ_ab P_ab = λ_fb P_fb - λ_fa P_fa, λ the relative turning
    velocities, which these say, that of any other three follows by adding three of them. Then, for every two bodies, a third
    one that pins or guides join to both: the line through these two centres is known without velocities.
    """
    shown = {frozenset(key) for key in primary}
    neighbours = {name: {other for key in shown if name in key for other in key - {name}} for name in bodies}
    order = {name: i for i, name in enumerate(bodies)}
    frame, *others = bodies
    found = dict.fromkeys((frame, a, b) for a, b in combinations(others, 2))
    for a, b in combinations(bodies, 2):
        common = neighbours[a] & neighbours[b]
        if common:
            third = min(common, key=order.__getitem__)
            first, second, last = sorted((a, b, third), key=order.__getitem__)
            found[first, second, last] = None
    return tuple(found)


def joining_triples(bodies: tuple[str, ...], primary: Iterable[Key]) -> tuple[Triple, ...]:
    """The frame with every two bodies that a pin or a guide joins, about b of them: each line through two centres on the frame holds the
    one that is seen. The centres of all other bodies follow from those on the frame, by the sums of ``proving_triples``."""
    frame = bodies[0]
    return tuple((frame, a, b) for a, b in primary if frame not in (a, b))


def collinearity(table: CentreTable) -> np.ndarray:
    """The largest determinant (n,) of the proving triples of a table of centres: 0 by Kennedy's theorem."""
    triples = proving_triples(table.bodies, table.primary)
    return np.asarray(_determinants(table.centres, triples, table.size).max(axis=0, initial=0.0))


def moving_collinearity(kinematics: Kinematics, size: float) -> Collinearity:
    """The proof at every position of a mechanism whose driver moves at unit speed; size [m] of the mechanism. Of more bodies than
    ``PROVEN`` that of the centres on the frame.

    A determinant carries the rounding of its worst centre, and no less than that of the largest relative velocity of the
    three bodies: three links pinned to each other in a triangle have pins to see, and no centres.
    """
    bodies = tuple(kinematics.bodies)
    order = {name: i for i, name in enumerate(bodies)}
    triples = (proving_triples if len(bodies) <= PROVEN else joining_triples)(bodies, primary_pairs(kinematics, order))
    wanted = dict.fromkeys(key for triple in triples for key in combinations(triple, 2))
    centres, motion, _ = centres_in_motion(kinematics, size, bodies, wanted)
    n = kinematics.theta.size
    rows = {key: np.broadcast_to(np.asarray(centre.error_bound, dtype=float), (n,)) for key, centre in centres.items()}
    with np.errstate(divide="ignore"):
        standstill = 1.0 / _of_keys({key: np.broadcast_to(m, (n,)) for key, m in motion.items()}, triples).max(axis=1)
    error_bound = np.maximum(_of_keys(rows, triples).max(axis=1), standstill)
    return Collinearity(triples, _determinants(centres, triples, size), error_bound)


def _of_keys(rows: Mapping[Key, np.ndarray], triples: tuple[Triple, ...]) -> np.ndarray:
    """Rows of the centres (a, b), (b, c), (a, c) of each triple (T, 3, ...)."""
    at = {key: i for i, key in enumerate(rows)}
    which = [(at[a, b], at[b, c], at[a, c]) for a, b, c in triples]
    return np.array(list(rows.values()))[np.array(which, dtype=int).reshape(-1, 3)]


def _determinants(centres: Mapping[Key, Centres], triples: tuple[Triple, ...], size: float) -> np.ndarray:
    """|h1 · (h2 × h3)| (T, n)."""
    points = _of_keys({key: centre.point / size for key, centre in centres.items()}, triples)
    weights = _of_keys({key: centre.weight for key, centre in centres.items()}, triples)
    (x1, x2, x3), (y1, y2, y3) = np.moveaxis(points.real, 1, 0), np.moveaxis(points.imag, 1, 0)
    w1, w2, w3 = np.moveaxis(weights, 1, 0)
    return np.asarray(np.abs(x1 * (y2 * w3 - y3 * w2) + y1 * (w2 * x3 - w3 * x2) + w1 * (x2 * y3 - x3 * y2)))
