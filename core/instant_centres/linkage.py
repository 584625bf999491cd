"""All n(n-1)/2 instant centres of a solved mechanism: those of the pairs from where the pairs are, the others from velocities."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import combinations
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.instant_centres.centre import Centres, Key, key_of
from core.instant_centres.construction import Construction, agreement, construction, kennedy
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics, Pose

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
            at = kinematics.bodies[key[0] if key[0] != FRAME else key[1]].place(name)
            found[key] = Centres(at, np.ones(at.size))
    return dict(sorted(found.items(), key=lambda item: (order[item[0][0]], order[item[0][1]])))
