"""Inverse dynamics of a linkage without friction: every reaction, and what its driver or its cam must give.

Walks a Train from its outermost dyad to the driver. A dyad is cut open where its loop was closed: the force F there does
no work in its two coordinates but against the loads, dot(c1, F) = -Q1, dot(c2, F) = -Q2, with the columns c1, c2 of the
kinematic loop; all other reactions follow by balance. Each kind of dyad is one row.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from core.design import LinkageLoads, si
from core.dynamics.loading import Inertia
from core.train import FRAME, REVOLUTE, Dyad, Pair, Train
from core.vectors import cross, dot


@dataclass(frozen=True, eq=False)
class LinkLoading:
    """What acts on a linkage: inertias by body; constant forces as (body, point, force [N], torque [N m]); gravity."""

    inertias: Mapping[str, Inertia]
    forces: tuple[tuple[str, str, complex, float], ...]
    gravity: complex

    @property
    def empty(self) -> bool:
        """True where nothing has mass and nothing pushes."""
        massive = any(i.mass or i.about_centre for i in self.inertias.values())
        return not massive and not any(force or torque for _, _, force, torque in self.forces)


@dataclass(frozen=True, eq=False)
class LinkageForces:
    """All forces at n positions; complex = global frame [N].

    pairs     pair name -> (n,) force by ``on`` on ``body`` at the body's point of the pair
    couples   sliding pair -> (n,) couple [N m] by ``on`` on ``body``
    torque    (n,) on the driver: torque [N m] counter-clockwise where it is pinned to the frame, force [N] along its line
              where it slides; 0 where a cam makes the linkage move
    contact   (n,) F_c [N] of a cam, > 0 presses the roller on it; 0 without one
    camshaft  (n,) T_c [N m] > 0 drives the cam; 0 without one
    lever     (n,) of the contact force on the driver: torque [N m] of a newton where it is pinned to the frame, else force
              [N] along its line; infinite without a cam
    """

    omega: float
    pairs: Mapping[str, np.ndarray]
    couples: Mapping[str, np.ndarray]
    torque: np.ndarray
    contact: np.ndarray
    camshaft: np.ndarray
    lever: np.ndarray


def link_loading(loads: LinkageLoads, name: Callable[[int], str]) -> LinkLoading:
    """The loads of a design; ``name`` gives the body of a link."""
    s = si(loads)
    inertias = {}
    for mass in loads.masses:
        m = si(mass)
        inertias[name(mass.link)] = Inertia(m.mass, complex(m.centre_x, m.centre_y), m.inertia)
    forces = tuple((name(f.link), f.point, complex(f.x_n, f.y_n), float(f.torque_nm)) for f in loads.forces)
    gravity = s.gravity * complex(np.cos(s.gravity_angle), np.sin(s.gravity_angle))
    return LinkLoading(MappingProxyType(inertias), forces, gravity)


class _Walk:
    """Loads on each body: resultant force and moment about the global origin, reactions of what is solved included."""

    def __init__(self, train: Train) -> None:
        self.train = train
        n = train.theta.size
        self.force = {name: np.zeros(n, dtype=complex) for name in train.bodies}
        self.moment = {name: np.zeros(n) for name in train.bodies}
        self.pairs: dict[str, np.ndarray] = {}
        self.couples: dict[str, np.ndarray] = {}

    def load(self, body: str, at: np.ndarray, force: np.ndarray | complex, couple: np.ndarray | float = 0.0) -> None:
        """A force at a place [m] and a couple on a body."""
        self.force[body] = self.force[body] + force
        self.moment[body] = self.moment[body] + cross(at, np.asarray(force)) + couple

    def place(self, pair: Pair) -> np.ndarray:
        """Where the body has its point of a pair (n,)."""
        return self.train.bodies[pair.body].place(pair.point)

    def line(self, pair: Pair) -> np.ndarray:
        """The direction of a sliding pair (n,)."""
        on = self.train.bodies[pair.on]
        return np.asarray(pair.axis * on.unit)

    def about(self, body: str, at: np.ndarray) -> np.ndarray:
        """Moment of a body's loads about a place."""
        return self.moment[body] - cross(at, self.force[body])

    def react(self, name: str, body: str, force: np.ndarray) -> None:
        """The pair's force on ``body``, one of its two bodies; a sliding pair's couple balances what is left of that
        body's moment. Both go to the other body too, and into the tables as by ``on`` on ``body`` of the pair."""
        pair = self.train.pairs[name]
        at = self.place(pair)
        other = pair.on if body == pair.body else pair.body
        sign = 1.0 if body == pair.body else -1.0
        self.load(body, at, force)
        couple: np.ndarray | float = 0.0
        if pair.kind != REVOLUTE:
            couple = -self.about(body, at)
            self.couples[name] = sign * couple
            self.moment[body] = self.moment[body] + couple
        self.pairs[name] = sign * force
        self.load(other, at, -force, -couple)


def _cut_force(c1: np.ndarray, c2: np.ndarray, q1: np.ndarray, q2: np.ndarray) -> np.ndarray:
    """F with dot(c1, F) = -q1 and dot(c2, F) = -q2."""
    return (1j * c2 * q1 - 1j * c1 * q2) / cross(c1, c2)


def _rrr(walk: _Walk, dyad: Dyad) -> None:
    a, b = dyad.bodies
    outer_a, inner, outer_b = dyad.pairs
    pin_a, joint, pin_b = (walk.place(walk.train.pairs[name]) for name in dyad.pairs)
    force = _cut_force(1j * (joint - pin_a), -1j * (joint - pin_b), walk.about(a, pin_a), walk.about(b, pin_b))
    walk.react(inner, a, force)
    walk.react(outer_a, a, -walk.force[a])
    walk.react(outer_b, b, -walk.force[b])


def _rrp(walk: _Walk, dyad: Dyad) -> None:
    a, b = dyad.bodies
    outer, inner, guide = dyad.pairs
    pin, joint = walk.place(walk.train.pairs[outer]), walk.place(walk.train.pairs[inner])
    t = walk.line(walk.train.pairs[guide])
    force = _cut_force(1j * (joint - pin), -t, walk.about(a, pin), dot(t, walk.force[b]))
    walk.react(inner, a, force)
    walk.react(outer, a, -walk.force[a])
    walk.react(guide, b, -walk.force[b])


def _rpr(walk: _Walk, dyad: Dyad) -> None:
    a, b = dyad.bodies
    outer_a, inner, outer_b = dyad.pairs
    pin_a, pin_b = walk.place(walk.train.pairs[outer_a]), walk.place(walk.train.pairs[outer_b])
    t = walk.line(walk.train.pairs[inner])
    turning = walk.about(a, pin_b) + walk.about(b, pin_b)
    walk.react(outer_a, a, _cut_force(1j * (pin_a - pin_b), t, turning, dot(t, walk.force[a])))
    walk.react(inner, a, -walk.force[a])
    walk.react(outer_b, b, -walk.force[b])


def _prp(walk: _Walk, dyad: Dyad) -> None:
    a, b = dyad.bodies
    guide_a, inner, guide_b = dyad.pairs
    t1, t2 = walk.line(walk.train.pairs[guide_a]), walk.line(walk.train.pairs[guide_b])
    walk.react(inner, a, _cut_force(t1, -t2, dot(t1, walk.force[a]), dot(t2, walk.force[b])))
    walk.react(guide_a, a, -walk.force[a])
    walk.react(guide_b, b, -walk.force[b])


def _rpp(walk: _Walk, dyad: Dyad) -> None:
    a, b = dyad.bodies
    outer, inner, guide = dyad.pairs
    t1, t2 = walk.line(walk.train.pairs[inner]), walk.line(walk.train.pairs[guide])
    both = walk.force[a] + walk.force[b]
    walk.react(outer, a, _cut_force(t1, t2, dot(t1, walk.force[a]), dot(t2, both)))
    walk.react(inner, a, -walk.force[a])
    walk.react(guide, b, -walk.force[b])


def _group(walk: _Walk, dyad: Dyad) -> None:
    """All reactions of a group at once, by the balance of each of its bodies."""
    train, size = walk.train, 3 * len(dyad.bodies)
    matrix = np.zeros((train.theta.size, size, size))
    columns: list[tuple[str, np.ndarray, np.ndarray]] = []
    for i, name in enumerate(dyad.pairs):
        pair = train.pairs[name]
        at = walk.place(pair)
        one = np.ones_like(at)
        pulls = (
            ((one, 0.0), (1j * one, 0.0)) if pair.kind == REVOLUTE else ((1j * walk.line(pair), 0.0), (0.0 * one, 1.0))
        )
        for k, (pull, couple) in enumerate(pulls):
            for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
                if body in dyad.bodies:
                    row = 3 * dyad.bodies.index(body)
                    matrix[:, row, 2 * i + k], matrix[:, row + 1, 2 * i + k] = sign * pull.real, sign * pull.imag
                    matrix[:, row + 2, 2 * i + k] = sign * (cross(at, pull) + couple)
        columns.append((name, *(pull for pull, _ in pulls)))  # type: ignore[arg-type]
    loads = [part for b in dyad.bodies for part in (walk.force[b].real, walk.force[b].imag, walk.moment[b])]
    found = np.linalg.solve(matrix, -np.array(loads).T[..., None])[..., 0].T
    for i, (name, first, second) in enumerate(columns):
        pair = train.pairs[name]
        force = found[2 * i] * first + found[2 * i + 1] * second
        couple = found[2 * i + 1] if pair.kind != REVOLUTE else 0.0 * found[0]
        walk.pairs[name] = force
        if pair.kind != REVOLUTE:
            walk.couples[name] = couple
        walk.load(pair.on, walk.place(pair), -force, -couple)


STATICS: Mapping[str, Callable[[_Walk, Dyad], None]] = MappingProxyType(
    {"RRR": _rrr, "RRP": _rrp, "RPR": _rpr, "PRP": _prp, "RPP": _rpp, "group": _group}
)


def _walked(walk: _Walk) -> np.ndarray:
    """Every reaction; what the driver must be given."""
    train = walk.train
    for dyad in train.dyads:
        STATICS[dyad.kind](walk, dyad)
    name = next(name for name, pair in train.pairs.items() if {pair.on, pair.body} == {FRAME, train.output})
    pair, driver = train.pairs[name], train.output
    if pair.kind == REVOLUTE:
        needed = -walk.about(driver, walk.place(pair))
        walk.react(name, driver, -walk.force[driver])
        return np.asarray(needed)
    t = walk.line(pair)
    needed = -dot(t, walk.force[driver])
    walk.load(driver, walk.place(pair), needed * t)
    walk.react(name, driver, -walk.force[driver])
    return np.asarray(needed)


def linkage_forces(
    train: Train, loading: LinkLoading, omega: float, contact: tuple[np.ndarray, np.ndarray, float] | None = None
) -> LinkageForces:
    """Forces at constant speed omega [rad/s] of what the train's derivatives are by.

    contact: of a cam the roller's centre and the normal towards the cam (n,), and the cam's sense. Then the cam holds the
    linkage, and the driver gets nothing: the roller's force is what the driver would need over what a newton there
    gives it.
    """
    own, n = _Walk(train), train.theta.size
    square = omega * omega
    for body, inertia in loading.inertias.items():
        centre, spin = train.bodies[body].carried(inertia.centre), train.bodies[body].turn[2]
        own.load(
            body,
            centre[0],
            inertia.mass * (loading.gravity - square * centre[2]),
            -inertia.about_centre * square * spin,
        )
    for body, point, force, torque in loading.forces:
        own.load(body, train.bodies[body].place(point), np.full(n, force), torque)
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = _walked(own)
        if contact is None:
            return LinkageForces(omega, own.pairs, own.couples, needed, np.zeros(n), np.zeros(n), np.full(n, np.inf))
        reference, normal, sense = contact
        newton = _Walk(train)
        newton.load(train.carrier, reference, -normal)
        lever = _walked(newton)
        pressing = -needed / lever
        pairs = {name: force + pressing * newton.pairs[name] for name, force in own.pairs.items()}
        couples = {name: couple + pressing * newton.couples[name] for name, couple in own.couples.items()}
        camshaft = -sense * cross(reference, pressing * normal)
    return LinkageForces(omega, pairs, couples, np.zeros(n), pressing, camshaft, lever)
