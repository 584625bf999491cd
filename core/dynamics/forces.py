"""Inverse dynamics: every reaction, the contact force and the torque that turns the cam or the driver (Shin1995 §4).

Forces follow from three kinds of walks through the mechanism: of its own loads, of one newton of contact force, and of one
newton of friction in each pair that rubs. The contact force is what leaves nothing to be given to the driver; friction is
found from the reactions, which are affine in it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from core.cam import OUTER, CamShape, Flank
from core.dynamics.elements import Friction, Load, Loading, Rate
from core.dynamics.friction import (
    JAMMED,
    GuideReaction,
    below_jamming,
    guide_reaction,
    jam_factor,
    jammed,
    jams_most,
    limitless,
    magnitudes,
)
from core.dynamics.walk import Walk, input_loads, input_of
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics
from core.numerics.derivatives import cross, dot, finite, opposite, spread
from core.numerics.lazy import Lazy, once

# -- inverse dynamics -------------------------------------------------------------------------------------------


BEARING = "bearing"
CAM_FACE = "cam_face"
"""Where a face slides on the cam, among what rubs."""
JAMS = 1.0  # the factor from which friction may jam
_NONE, _NO_FORCE = np.zeros(1), np.zeros(1, dtype=complex)


class Contact(NamedTuple):
    """One flank of the cam at n cam angles.

    at        (n,) complex [m], where it is touched, in the global frame
    pressing  (n,) complex: n + μ v̂, the force on the cam for one newton of contact, friction of a face that slides included
    force     (n,) [N]; of a cam that holds the follower from both sides 0 where the other flank carries
    lever     (n,) what one newton asks of the driver [m, or 1]
    """

    at: np.ndarray
    pressing: np.ndarray
    force: np.ndarray
    lever: np.ndarray


@frozen(eq=False)
class Forces:
    """All forces at n cam or crank angles, at constant speed ``omega`` [rad/s]; complex = global frame [N].

    pairs     pair name -> (n,) force by ``on`` on ``body``, friction included; ``bearing`` by the frame on the camshaft
    couples   pair name -> (n,) couple [N m] by ``on`` on ``body``: of sliding pairs, of pins that rub, and
              what drives a body beside the driver
    contact   (n,) F_c [N], > 0 presses the follower on the cam; in a groove < 0 where the outer flank carries; 0 without a cam
    contacts  where the cam is touched, flank by flank; empty without a cam
    torque    (n,) T_c [N m], > 0 drives the cam (27); 0 without a cam
    driver    (n,) on the driver where no cam moves it: torque [N m] counter-clockwise where it is pinned to the frame, force
              [N] along its line where it slides; else 0
    lever     (n,) what one newton on the flank that carries asks of the driver [m, or 1]; infinite without a cam
    follower_torque  (n,) T_L [N m] that the contact gives the follower's link about its pivot (24); for a guide: force [N]
    guide     the guide's normal force, friction and jamming factor; None where the design has no guide
    lost      (n,) power [W] lost to friction; rubbing: pair, or ``CAM_FACE`` -> its share
    jam       (n,) the factor that must stay below 1: the spectral radius of μ|∂N/∂f| over all pairs that rub
    most_jamming  (n,) number of the pair, among those that rub, whose friction feeds on itself most
    contact_jam  (n,) likewise: how much of the lever of the contact's normal force its friction takes away
    """

    omega: float
    contact: np.ndarray
    contacts: tuple[Contact, ...]
    torque: np.ndarray
    driver: np.ndarray
    lever: np.ndarray
    contact_jam: np.ndarray
    lost: Lazy[np.ndarray] = Lazy()
    rubbing: Lazy[Mapping[str, np.ndarray]] = Lazy()
    pairs: Lazy[Mapping[str, np.ndarray]] = Lazy()
    couples: Lazy[Mapping[str, np.ndarray]] = Lazy()
    jam: Lazy[np.ndarray] = Lazy()
    most_jamming: Lazy[np.ndarray] = Lazy()
    follower_torque: Lazy[np.ndarray] = Lazy()
    guide: Lazy[GuideReaction | None] = Lazy()

    @property
    def carrying(self) -> np.ndarray:
        """Of a cam that holds the follower from both sides (n,) [N]: > 0 where the first flank carries, < 0 where the other."""
        return self.contacts[0].force - self.contacts[1].force


class _Case:
    """A walk of loads with the contact force (n,) that leaves nothing to the driver; without a cam, what the driver is given."""

    def __init__(self, walk: Walk, press: Walk | None) -> None:
        self.walk, self.press = walk, press
        self.contact = np.zeros(1) if press is None else -walk.needed / press.needed
        self.driver = walk.needed if press is None else np.zeros(1)

    def carried(self, name: str) -> np.ndarray:
        """What a pair carries (n,), a pin's force or the normal force of a slide, with what the contact adds to it."""
        one = None if self.press is None else self.press.carried(name)
        return _with_contact(self.walk.carried(name), self.contact, one, _NONE)

    def couple(self, name: str) -> np.ndarray:
        """The couple on a sliding pair (n,), likewise."""
        return _with_contact(
            self.walk.couple(name), self.contact, None if self.press is None else self.press.couple(name), _NONE
        )


def _with_contact(own: np.ndarray | None, contact: np.ndarray, one: np.ndarray | None, none: np.ndarray) -> np.ndarray:
    """Own and contact's share; ``one``: of one newton of contact."""
    if one is None:
        return none if own is None else own
    return contact * one if own is None else own + contact * one


class _Reactions(NamedTuple):
    """Forces and couples of all pairs, (n,) or (1,)."""

    pairs: dict[str, np.ndarray]
    couples: dict[str, np.ndarray]


class _Solution(NamedTuple):
    """Contact force and what the driver is given, (n,) or (1,), with the friction that goes with them, and its size in each pair;
    made when they are read: what it takes there per radian of the shaft [N m], the reactions, those of the guide, the jam
    factor, and the number of the pair that jams most."""

    contact: np.ndarray
    driver: np.ndarray
    sizes: dict[str, np.ndarray]
    lost: Callable[[], dict[str, np.ndarray]]
    reactions: Callable[[], _Reactions]
    guide: Callable[[], GuideReaction] | None
    jam: Callable[[], np.ndarray]
    most: Callable[[], np.ndarray]


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def newton_euler(
    kinematics: Kinematics, shape: CamShape | None, loading: Loading, omega: float, acceleration: float = 0.0
) -> Forces:
    """Forces at camshaft speed omega [rad/s, > 0] and acceleration [rad/s²] of the coordinate that the poses are differentiated by.

    T_c = -d (C × F_c (n + μ v̂)) (27) at the contact C, where a face that slides rubs by μ F_c v̂ on the cam, v̂ the direction of
    the follower relative to it; F_c from the equilibrium of the driven bodies, never from T_c, which is 0/0 in a dwell (25),
    (26). A groove or a conjugate pair holds the follower from both sides: where the first flank would have to pull, the other one
    carries. Where friction jams the forces are infinite; the findings say so.

    References
    ----------
    Newton and Euler: balance of the links, balance of the camshaft; virtual power, F_c = Q/l; Coulomb friction, friction in closed form;
    Shin1995 (21), (22), (23), (24)-(27), corrected.
    """
    rate = Rate(omega, acceleration)
    n, friction_of_cam = kinematics.theta.shape[-1], loading.contact_friction
    flanks = () if shape is None else shape.flanks
    pressing = tuple(_pressing(flank, shape.rotation_sign, friction_of_cam) for flank in flanks if shape is not None)
    places: dict[str, np.ndarray] = {}
    presses = [
        Walk(kinematics, [Load(flank.body, flank.contact, opposite(push))], places)
        for flank, push in zip(flanks, pressing, strict=True)
    ]
    contact_jam = np.zeros(n)
    if friction_of_cam and shape is not None:
        smooth = Walk(
            kinematics, [Load(kinematics.carrier, shape.flank.contact, opposite(shape.flank.normal))], places
        ).needed
        contact_jam = spread(finite(1.0 - presses[0].needed / smooth, nan=0.0), n)
        if (jams := contact_jam >= JAMS).any():
            presses[0].needed = np.where(jams, smooth / JAMMED, presses[0].needed)
    own = Walk(kinematics, [load for element in loading.elements for load in element.loads(kinematics, rate)], places)
    signs = {f.pair: _direction(kinematics, f.pair) * np.sign(omega) for f in loading.frictions}
    rubbing = {f.pair: Walk(kinematics, unit_friction(kinematics, f), places) for f in loading.frictions}

    def carried_by(press: Walk | None) -> _Solution:
        cases = {name: _Case(walk, press) for name, walk in rubbing.items()}
        return _with_friction(kinematics, loading, _Case(own, press), cases, signs)

    found, shares = _carried(carried_by, presses)
    torque = _NONE
    contacts = tuple(
        Contact(flank.contact, push, spread(share, n), spread(press.needed, n))
        for flank, push, share, press in zip(flanks, pressing, shares, presses, strict=True)
    )
    if shape is not None:
        turning = [share * cross(at, push) for share, (at, push, *_) in zip(shares, contacts, strict=True)]
        torque = np.asarray(-shape.rotation_sign * sum(turning[1:], turning[0]))
        if not friction_of_cam:  # in a dwell no power goes in, only rounding
            torque = np.where(kinematics.motion.velocity_sign == 0.0, 0.0, torque)

    def rubbing_power() -> dict[str, np.ndarray]:
        taken = found.lost()
        if friction_of_cam and shape is not None:
            taken = {**taken, CAM_FACE: friction_of_cam * shares[0] * np.abs(shape.flank.sliding)}
        return {name: spread(part * omega, n) for name, part in taken.items()}

    def reactions() -> _Reactions:
        pairs, couples = found.reactions()
        if contacts:
            loaded = [-share * push for share, push in zip(shares, pressing, strict=True)]
            pairs = {**pairs, BEARING: np.asarray(sum(loaded[1:], loaded[0]))}
        return _Reactions(*({name: spread(row, n) for name, row in rows.items()} for rows in (pairs, couples)))

    kept = once(reactions)
    pulled = [share for flank, share in zip(flanks, shares, strict=True) if flank.name == OUTER]
    lever = np.full(n, np.inf) if not contacts else contacts[0].lever
    for other in contacts[1:]:
        lever = np.where(other.force > 0.0, other.lever, lever)
    forces = Forces(
        omega=omega,
        pairs=lambda: kept().pairs,
        couples=lambda: kept().couples,
        contact=spread(shares[0] - pulled[0] if pulled else found.contact if not shares else shares[0], n),
        contacts=contacts,
        torque=spread(torque, n),
        driver=spread(found.driver, n),
        lever=lever,
        lost=lambda: spread(np.asarray(sum(rubbing_power().values(), _NONE)), n),
        rubbing=rubbing_power,
        most_jamming=lambda: spread(found.most(), n),
        jam=lambda: np.maximum(found.jam(), contact_jam),
        contact_jam=contact_jam,
        follower_torque=lambda: np.zeros(n) if shape is None else _follower_torque(kinematics, contacts),
        guide=found.guide,
    )
    return limitless(forces) if any(jammed(force) for force in (*found.sizes.values(), *shares)) else forces


def _carried(carried_by: Callable[[Walk | None], _Solution], presses: list[Walk]) -> tuple[_Solution, list[np.ndarray]]:
    """The solution with the flank that carries at each angle, and the force on each flank (n,): the first one where it is
    pressed; where it would have to pull, the other one, from the same equation with its own lever. With one flank alone it
    is that, whatever the sign."""
    first = carried_by(presses[0] if presses else None)
    if len(presses) < 2:
        return first, [first.contact for _ in presses]
    pulls = ~(first.contact >= 0.0)
    if not pulls.any():
        return first, [first.contact, np.zeros(1)]
    other = carried_by(presses[1])
    shares = [np.where(pulls, 0.0, first.contact), np.where(pulls, other.contact, 0.0)]
    return _chosen(pulls, other, first), shares


def _chosen(which: np.ndarray, one: Any, other: Any) -> Any:
    """Of two solutions that or this, angle by angle."""
    if isinstance(one, np.ndarray):
        return np.where(which, one, other)
    if callable(one):
        return lambda: _chosen(which, one(), other())
    if isinstance(one, dict):
        return {name: _chosen(which, one[name], other[name]) for name in one}
    if isinstance(one, tuple):
        parts = [_chosen(which, a, b) for a, b in zip(one, other, strict=True)]
        return type(one)(*parts)
    if isinstance(one, GuideReaction):
        return replace(
            one,
            **{
                field.name: _chosen(which, getattr(one, field.name), getattr(other, field.name))
                for field in fields(one)
            },
        )
    return one


def _pressing(flank: Flank, sense: float, friction: float) -> np.ndarray:
    """n + μ v̂ (n,): the force on the cam for one newton of contact, v̂ = ± i d n the direction of the follower relative to it."""
    if not friction:
        return flank.normal
    rubs = sense * friction * np.sign(flank.sliding)
    turned = np.empty(np.shape(rubs), dtype=complex)
    turned.real, turned.imag = 1.0, rubs
    # by a name: numpy turns round products with large nameless ones, which changes their last bits
    return flank.normal * turned


def unit_friction(kinematics: Kinematics, friction: Friction) -> list[Load]:
    """One newton of friction (one newton metre in a pin) on ``body`` against positive slip, and the like on ``on``."""
    pair = kinematics.pairs[friction.pair]
    at = kinematics.bodies[pair.body].place(pair.point)
    force = np.zeros(1, dtype=complex) if pair.kind == REVOLUTE else -kinematics.line(pair)
    couple = -1.0 if pair.kind == REVOLUTE else 0.0
    return [Load(pair.body, at, force, couple), Load(pair.on, at, -force, -couple)]


def _direction(kinematics: Kinematics, name: str) -> np.ndarray:
    """Which way a pair slips (n,): -1, 0, 1, as the motion's segment says; rounding beside a dwell must not toggle it."""
    forward = kinematics.sense * kinematics.motion.velocity_sign
    return forward if name == kinematics.driver_name else np.asarray(forward * np.sign(kinematics.slip(name)))


def _normal(kinematics: Kinematics, name: str, force: np.ndarray) -> np.ndarray:
    """The normal force N of a sliding pair (n,), along its line + 90 deg; of a pin the force itself."""
    pair = kinematics.pairs[name]
    return force if pair.kind == REVOLUTE else dot(1j * kinematics.line(pair), force)


def _with_friction(
    kinematics: Kinematics, loading: Loading, case: _Case, rubbing: Mapping[str, _Case], signs: Mapping[str, np.ndarray]
) -> _Solution:
    """What the loads ask for, with the friction that goes with the reactions."""
    sizes, jam, most = _sizes(kinematics, loading, case, rubbing, signs)
    signed = {name: signs[name] * size for name, size in sizes.items()}
    contact, driver = case.contact, case.driver
    for name, size in signed.items():
        contact, driver = contact + size * rubbing[name].contact, driver + size * rubbing[name].driver

    def lost() -> dict[str, np.ndarray]:
        speed = kinematics.sense * kinematics.motion.displacement[1]
        slips = {name: 1.0 if name == kinematics.driver_name else kinematics.slip(name) for name in signed}
        return {name: size * slips[name] * speed for name, size in signed.items()}

    @once
    def reactions() -> _Reactions:
        return _reactions(kinematics, case, contact, {name: (rubbing[name], size) for name, size in signed.items()})

    def guide() -> GuideReaction:
        n, name = kinematics.theta.shape[-1], loading.guide
        normal, rubs = _normal(kinematics, name, reactions().pairs[name]), -signed[name] if name in signed else _NONE
        return GuideReaction(spread(normal, n), spread(rubs, n), jam)

    return _Solution(contact, driver, sizes, lost, reactions, guide if loading.guide else None, jam, most)


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _reactions(
    kinematics: Kinematics, case: _Case, contact: np.ndarray, signed: Mapping[str, tuple[_Case, np.ndarray]]
) -> _Reactions:
    """Of the own loads, of friction of these sizes with their signs (n,), and of the contact force (n,)."""
    shares = [(size, rubbing.walk) for rubbing, size in signed.values()]
    if case.press is not None:
        shares.append((contact, case.press))
    pairs: dict[str, np.ndarray] = {}
    couples: dict[str, np.ndarray] = {}
    for name, pair in kinematics.pairs.items():
        turns = pair.kind == REVOLUTE
        for total, part_of in ((pairs, Walk.carried), *(() if turns else ((couples, Walk.couple),))):
            parts = [part_of(case.walk, name)]
            parts += [None if (one := part_of(walk, name)) is None else size * one for size, walk in shares]
            given = [part for part in parts if part is not None]
            total[name] = np.asarray(sum(given[1:], given[0])) if given else _NO_FORCE if turns else _NONE
        if not turns:
            pairs[name] = 1j * kinematics.line(pair) * pairs[name]
    for name in (input_of(dyad.bodies[0]) for dyad in kinematics.dyads if dyad.on):
        parts = [case.walk.couple(name)]
        parts += [None if (one := walk.couple(name)) is None else size * one for size, walk in shares]
        couples[name] = np.asarray(sum((part for part in parts if part is not None), _NONE))
    for name, (_, size) in signed.items():
        if kinematics.pairs[name].kind == REVOLUTE:
            couples[name] = couples.get(name, 0.0) - size
        else:
            pairs[name] = pairs[name] - size * kinematics.line(kinematics.pairs[name])
    return _Reactions(pairs, couples)


def _sizes(
    kinematics: Kinematics, loading: Loading, case: _Case, rubbing: Mapping[str, _Case], signs: Mapping[str, np.ndarray]
) -> tuple[dict[str, np.ndarray], Callable[[], np.ndarray], Callable[[], np.ndarray]]:
    """Friction of every pair that rubs (n,) [N; N m in pins], the jam factor (n,), and the number of the pair that jams most (n,),
    both made when they are read.

    A slide of some length rubs by both edges, each of them with its own share of the reaction and of the friction.
    """
    n, frictions = kinematics.theta.shape[-1], loading.frictions
    if not frictions:
        return {}, lambda: np.zeros(n), lambda: np.zeros(1, dtype=int)
    if len(frictions) == 1 and not frictions[0].length and kinematics.pairs[frictions[0].pair].kind != REVOLUTE:
        (friction,) = frictions
        (normal,), (gain,) = (_carried_by(kinematics, friction, of) for of in (case, rubbing[friction.pair]))
        reaction = guide_reaction(normal, signs[friction.pair], -gain, friction.coefficient)
        return {friction.pair: np.abs(reaction.friction)}, lambda: reaction.jam, lambda: np.zeros(1, dtype=int)
    normals = [_carried_by(kinematics, f, case) for f in frictions]
    number = np.repeat(np.arange(len(frictions)), [len(parts) for parts in normals])
    by_pair = [[part for f in frictions for part in _carried_by(kinematics, f, rubbing[g.pair])] for g in frictions]
    parts = [part for row in (*normals, *by_pair) for part in row]
    shape = np.broadcast_shapes((n,), *(np.shape(part) for part in parts))  # of many designs beside each other (m, n)

    def flat(row: Any) -> np.ndarray:
        return np.broadcast_to(row, shape).ravel()

    limits = [f.coefficient * f.radius for f in frictions]
    coefficients = np.array([flat(c) for c in limits] if any(map(np.ndim, limits)) else limits)[number]
    gains = np.empty((number.size, number.size, flat(_NONE).size), dtype=complex)
    for column, g in enumerate(number):
        for row, part in enumerate(by_pair[g]):
            gains[row, column] = flat(signs[frictions[g].pair] * part)
    free = np.array([flat(part) for row in normals for part in row]).astype(complex)
    found = magnitudes(free, gains, coefficients, below_jamming(gains, coefficients))
    found = found * coefficients.reshape(number.size, -1)
    sizes = {f.pair: found[number == i].sum(axis=0).reshape(shape) for i, f in enumerate(frictions)}
    return (
        sizes,
        lambda: jam_factor(gains, coefficients).reshape(shape),
        lambda: number[jams_most(gains, coefficients)].reshape(shape),
    )


def _carried_by(kinematics: Kinematics, friction: Friction, case: _Case) -> list[np.ndarray]:
    """What carries the reaction of a pair that rubs, each (n,): the pair, or the two edges of a slide of some length."""
    normal = case.carried(friction.pair)
    return _edges(normal, case.couple(friction.pair), friction.length) if friction.length else [normal]


def carried(kinematics: Kinematics, forces: Forces, friction: Friction) -> list[np.ndarray]:
    """What a slide that rubs carries (n,), of some length by both of its edges: where the sign of one changes friction breaks."""
    normal, couple = (
        _normal(kinematics, friction.pair, forces.pairs[friction.pair]),
        forces.couples.get(friction.pair, _NONE),
    )
    return _edges(normal, couple, friction.length)


def _edges(normal: np.ndarray, couple: np.ndarray, length: float) -> list[np.ndarray]:
    """N, or of a slide of some length N/2 ± M/length."""
    return [0.5 * normal + couple / length, 0.5 * normal - couple / length] if length else [normal]


def _follower_torque(kinematics: Kinematics, contacts: tuple[Contact, ...]) -> np.ndarray:
    """T_L = -F_c (r_C × n) about the pivot that holds the follower's link (24), with the friction of the contact; along its
    guide -F_c n·e; of all flanks."""
    if not kinematics.ground:
        return np.full(kinematics.theta.shape[-1], np.nan)
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind != REVOLUTE:
        rows = [-each.force * dot(each.pressing, kinematics.line(pair)) for each in contacts]
    else:
        pivot = kinematics.bodies[pair.body].place(pair.point)
        rows = [-each.force * cross(each.at - pivot, each.pressing) for each in contacts]
    return np.asarray(sum(rows[1:], rows[0]))


# -- which reactions statics does not fix -----------------------------------------------------------------------


_RANK = 1e-9  # of the largest singular value
_SHARE = 1e-7  # of the largest share in what may be added to the reactions


def undetermined_pairs(kinematics: Kinematics) -> frozenset[str]:
    """The pairs whose forces could be others in the same equilibrium: those with a share in the null space of the equations of
    balance of all bodies, A R + loads = 0, at the angle where that is smallest (at a dead centre it is larger). The columns of A are
    the two components of each pair, what drives, and what each second driver gives."""
    if not any(dyad.redundant for dyad in kinematics.dyads):
        return frozenset()
    matrices = _balance(kinematics)
    _, s, vh = np.linalg.svd(matrices[np.isfinite(matrices).all(axis=(1, 2))])
    ranks = (s > _RANK * s[:, :1]).sum(axis=1)
    best = int(ranks.argmax())
    free = np.abs(vh[best, ranks[best] :])
    shares = free.max(axis=0, initial=0.0)
    moved = shares > _SHARE * max(float(shares.max(initial=0.0)), 1e-300)
    return frozenset(name for i, name in enumerate(kinematics.pairs) if moved[2 * i : 2 * i + 2].any())


def _balance(kinematics: Kinematics) -> np.ndarray:
    """A (n, 3 bodies, columns), moments in parts of the size of the mechanism."""
    n = kinematics.theta.size
    bodies = [name for name in kinematics.bodies if name != FRAME]
    inputs = [dyad for dyad in kinematics.dyads if dyad.on]
    matrix = np.zeros((n, 3 * len(bodies), 2 * len(kinematics.pairs) + 1 + len(inputs)))
    places = {name: kinematics.bodies[pair.body].place(pair.point) for name, pair in kinematics.pairs.items()}
    size = max((float(np.abs(at - next(iter(places.values()))).max()) for at in places.values()), default=1.0) or 1.0

    def put(column: int, name: str, force: np.ndarray, couple: float) -> None:
        pair, at = kinematics.pairs[name], places[name]
        for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
            if body in bodies:
                row = 3 * bodies.index(body)
                matrix[:, row, column] += sign * force.real
                matrix[:, row + 1, column] += sign * force.imag
                matrix[:, row + 2, column] += sign * ((np.conj(at) * force).imag / size + couple)

    for i, (name, pair) in enumerate(kinematics.pairs.items()):
        one = np.ones(1, dtype=complex)
        turns = pair.kind == REVOLUTE
        put(2 * i, name, one if turns else 1j * kinematics.line(pair), 0.0)
        put(2 * i + 1, name, 1j * one if turns else 0.0 * one, 0.0 if turns else 1.0)
    driving, drives = kinematics.driver_pair, 2 * len(kinematics.pairs)
    turns = driving.kind == REVOLUTE
    put(drives, kinematics.driver_name, np.zeros(1, dtype=complex) if turns else kinematics.line(driving), float(turns))
    for i, dyad in enumerate(inputs, 1):
        for _, load in input_loads(kinematics, dyad, np.ones(1)):
            if load.body in bodies:
                row = 3 * bodies.index(load.body)
                matrix[:, row, drives + i] += load.force.real
                matrix[:, row + 1, drives + i] += load.force.imag
                matrix[:, row + 2, drives + i] += (np.conj(load.at) * load.force).imag / size + load.couple
    return matrix
