"""Inverse dynamics: reactions, contact force, and the torque on the cam or on the driver.

A walk (``core.dynamics.walk``) solves the forces of the mechanism, body by body, for one set of loads: the applied and inertia
forces, one newton of contact force, one newton of friction in a pair. The contact force is F_c = Q/l: Q is the torque or force of the
loads on the driver, l the driver effort that balances one newton of contact. Friction follows from the reactions, which are affine
functions of it.

Source: Shin, Kim and Ha 1995, section 4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from core.cam import OUTER, CamShape
from core.dynamics.elements import Rate
from core.dynamics.friction import (
    GuideReaction,
    critical_friction,
    guide_reaction,
    is_jammed,
    jam_factor,
    jam_factor_bound,
    magnitudes,
    with_infinities,
)
from core.dynamics.loading import Friction, Loading
from core.dynamics.unit_loads import LoadCase, UnitLoads, unit_loads
from core.dynamics.walk import Walk, input_loads, input_of
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics
from core.numerics.derivatives import cross, dot, spread
from core.numerics.lazy import Lazy, once

# -- inverse dynamics -------------------------------------------------------------------------------------------


BEARING = "bearing"
CAM_FACE = "cam_face"
"""Name of the friction of a face that slides on the cam, among the pairs."""
_ZERO, _ZERO_FORCE = np.zeros(1), np.zeros(1, dtype=complex)


class Contact(NamedTuple):
    """Contact of one flank of the cam at n cam angles.

    Attributes
    ----------
    at : ndarray (n,) complex [m]
        Point of contact in the global frame.
    direction : ndarray (n,) complex, dimensionless
        n + μ v̂: force on the cam per newton of contact, with the friction of a face that slides.
    force : ndarray (n,) [N]
        Normal force, positive where it presses; with two flanks, 0 on the one that is not in contact.
    lever : ndarray (n,) [m or dimensionless]
        Driver effort l that balances one newton of contact.
    """

    at: np.ndarray
    direction: np.ndarray
    force: np.ndarray
    lever: np.ndarray


@frozen(eq=False)
class Forces:
    """All forces at n cam or crank angles, at constant speed ``omega`` [rad/s]; complex arrays are in the global frame.

    Attributes
    ----------
    contact : ndarray (n,) [N]
        Contact force F_c, positive where the follower presses on the cam; negative where the outer flank of a groove is in contact; 0
        without a cam.
    contacts : tuple of Contact
        One per flank; empty without a cam.
    torque : ndarray (n,) [N m]
        Torque T_c (27) that the shaft must supply, positive where it drives the cam; 0 without a cam.
    driver : ndarray (n,) [N m or N]
        On a driver without a disk cam: torque counter-clockwise where it is pinned to the frame, force along its line where
        it slides; otherwise 0.
    lever : ndarray (n,) [m or dimensionless]
        Driver effort that balances one newton on the flank in contact; infinite without a cam.
    contact_jam : ndarray (n,), dimensionless
        Share of the lever of the contact's normal force that its friction cancels.
    friction_power : ndarray (n,) [W]
        Power lost to friction.
    friction_power_by_pair : mapping
        Pair, or ``CAM_FACE`` -> its share (n,) [W].
    pairs : mapping
        Pair -> force (n,) complex [N] by ``on`` on ``body``, with friction; ``bearing``: by the frame on the camshaft.
    normals : mapping
        Pair with friction -> its normal force (n,) [N], along its line + 90°; of a pin its force, complex.
    couples : mapping
        Pair -> couple (n,) [N m] by ``on`` on ``body``: of sliding pairs, of pins with friction, of second drivers.
    jam : ndarray (n,), dimensionless
        Jam factor, the spectral radius of μ|∂N/∂f| over all pairs with friction; below 1 unless the mechanism jams.
    most_jamming : ndarray (n,) int, dimensionless
        Index of the friction with the largest part in the jam factor.
    follower_torque : ndarray (n,) [N m or N]
        Torque T_L (24) of the contact on the follower about its pivot; if the follower slides, the force along its guide.
    guide : GuideReaction or None
        Reaction of the guide; None without a guide.
    in_space : bool
        Whether a cam in space exerts the effort on the driver; then contact and torque are those of this cam.
    """

    omega: float
    contact: np.ndarray
    contacts: tuple[Contact, ...]
    torque: np.ndarray
    driver: np.ndarray
    lever: np.ndarray
    contact_jam: np.ndarray
    friction_power: Lazy[np.ndarray] = Lazy()
    friction_power_by_pair: Lazy[Mapping[str, np.ndarray]] = Lazy()
    pairs: Lazy[Mapping[str, np.ndarray]] = Lazy()
    normals: Lazy[Mapping[str, np.ndarray]] = Lazy()
    couples: Lazy[Mapping[str, np.ndarray]] = Lazy()
    jam: Lazy[np.ndarray] = Lazy()
    most_jamming: Lazy[np.ndarray] = Lazy()
    follower_torque: Lazy[np.ndarray] = Lazy()
    guide: Lazy[GuideReaction | None] = Lazy()
    in_space: bool = False

    @property
    def signed_contact(self) -> np.ndarray:
        """Contact force (n,) [N] of a cam with two flanks: positive at the first flank, negative at the second."""
        return self.contacts[0].force - self.contacts[1].force


class _Reactions(NamedTuple):
    """Forces and couples of all pairs, (n,) or (1,)."""

    pairs: dict[str, np.ndarray]
    couples: dict[str, np.ndarray]


class _Solution(NamedTuple):
    """Contact force and driver effort, (n,) or (1,), with the friction that belongs to them.

    sizes: magnitude of the friction in each pair [N; N m in pins]. The other attributes are functions that compute when called:
    the work of friction per radian of the shaft [N m], the reactions, the normal forces of pairs with friction, the reaction of
    the guide, the jam factor, and the index of the pair that jams most.
    """

    contact: np.ndarray
    driver: np.ndarray
    sizes: dict[str, np.ndarray]
    friction_work: Callable[[], dict[str, np.ndarray]]
    reactions: Callable[[], _Reactions]
    normals: Callable[[], dict[str, np.ndarray]]
    guide: Callable[[], GuideReaction] | None
    jam: Callable[[], np.ndarray]
    most_jamming: Callable[[], np.ndarray]


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def newton_euler(
    kinematics: Kinematics,
    shape: CamShape | None,
    loading: Loading,
    omega: float,
    acceleration: float = 0.0,
    units: UnitLoads | None = None,
) -> Forces:
    """Contact force F_c = Q/l, torque T_c = -d C × F_c (n + μ v̂) and reactions at a speed and acceleration of camshaft or crank.

    Q = Σ (F·∂r/∂q + M ∂α/∂q) is the torque or force of the loads on the driver, whose coordinate is q; l is the driver effort
    that balances one newton of contact; C is the point of contact, n the unit normal into the cam, d the sense of rotation. A
    sliding face exerts the friction μ F_c v̂ on the cam, v̂ the direction in which it slides. F_c does not follow from T_c (25),
    (26), which is 0/0 in a dwell. In a groove or a conjugate pair the second flank is in contact where the first one would have
    to pull. Where friction jams, the forces are infinite.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    shape : CamShape or None
        The cam; None without one.
    loading : Loading
    omega : float
        Speed of camshaft or crank [rad/s], positive.
    acceleration : float
        Acceleration of camshaft or crank [rad/s²].
    units : UnitLoads, optional
        Reactions to unit loads at these cam angles, if they are already known; they do not depend on loads and speed.

    Returns
    -------
    Forces

    References
    ----------
    Shin, Kim and Ha 1995, section 4, eqs. (21) to (23), corrected, and (24) to (27). Newton and Euler: balance of the
    links, balance of the camshaft; virtual power, F_c = Q/l; Coulomb friction, friction in closed form.
    """
    rate = Rate(omega, acceleration)
    n, cam_friction = kinematics.count, loading.contact_friction
    flanks = () if shape is None else shape.flanks
    if units is None:
        units = unit_loads(kinematics, shape, cam_friction, tuple(f.pair for f in loading.frictions))
    loads = loading.loads(kinematics, rate)
    loads_walk = Walk(kinematics, loads, units.points)
    signs = {f.pair: units.slip_signs[f.pair] * np.sign(omega) for f in loading.frictions}

    def solve_with(unit_contact: Walk | None) -> _Solution:
        cases = {f.pair: units.friction_case(f.pair, unit_contact) for f in loading.frictions}
        return _with_friction(kinematics, loading, LoadCase(loads_walk, unit_contact), cases, signs)

    solution, flank_forces = _solve_flanks(solve_with, units.contacts)
    torque = _ZERO
    contacts = tuple(
        [
            Contact(flank.contact, direction, spread(force, n), spread(walk.effort, n))
            for flank, direction, force, walk in zip(
                flanks, units.directions, flank_forces, units.contacts, strict=True
            )
        ]
    )
    if shape is not None:
        moments = [force * arm for force, arm in zip(flank_forces, units.torque_arms, strict=True)]
        torque = np.asarray(-shape.rotation_sign * sum(moments[1:], moments[0]))
        if not cam_friction:  # in a dwell the power is 0, but for rounding
            torque = np.where(kinematics.motion.velocity_sign == 0.0, 0.0, torque)

    def friction_power_by_pair() -> dict[str, np.ndarray]:
        work = solution.friction_work()
        if cam_friction and shape is not None:
            work = {**work, CAM_FACE: cam_friction * flank_forces[0] * np.abs(shape.flank.sliding)}
        return {name: spread(part * omega, n) for name, part in work.items()}

    @once
    def reactions() -> _Reactions:
        pairs, couples = solution.reactions()
        if contacts:
            on_cam = [-force * direction for force, direction in zip(flank_forces, units.directions, strict=True)]
            pairs = {**pairs, BEARING: np.asarray(sum(on_cam[1:], on_cam[0]))}
        return _Reactions(*({name: spread(row, n) for name, row in rows.items()} for rows in (pairs, couples)))

    outer = [force for flank, force in zip(flanks, flank_forces, strict=True) if flank.name == OUTER]
    lever = np.full(n, np.inf) if not contacts else contacts[0].lever
    for contact in contacts[1:]:
        lever = np.where(contact.force > 0.0, contact.lever, lever)
    forces = Forces(
        omega=omega,
        pairs=lambda: reactions().pairs,
        normals=lambda: {name: spread(row, n) for name, row in solution.normals().items()},
        couples=lambda: reactions().couples,
        contact=spread(
            flank_forces[0] - outer[0] if outer else flank_forces[0] if flank_forces else solution.contact, n
        ),
        contacts=contacts,
        torque=spread(torque, n),
        driver=spread(solution.driver, n),
        lever=lever,
        friction_power=lambda: spread(np.asarray(sum(friction_power_by_pair().values(), _ZERO)), n),
        friction_power_by_pair=friction_power_by_pair,
        most_jamming=lambda: spread(solution.most_jamming(), n),
        jam=lambda: np.maximum(solution.jam(), units.contact_jam),
        contact_jam=units.contact_jam,
        follower_torque=lambda: np.zeros(n) if shape is None else _follower_torque(kinematics, contacts),
        guide=solution.guide,
    )
    if any(map(is_jammed, (*solution.sizes.values(), *flank_forces))):
        return with_infinities(forces)
    return forces


def with_cam_in_space(
    forces: Forces, y_1: np.ndarray, gain_ahead: np.ndarray, gain_behind: np.ndarray, sign: float
) -> Forces:
    """Forces of a motion that a cam in space makes: T_c = Q y', F_c = Q/|∂p/∂y · n|.

    Parameters
    ----------
    forces : Forces
        Of the motion without a cam; its driver has the effort Q.
    y_1 : ndarray (n,) [m/rad or dimensionless]
        Derivative y' of the motion by cam angle.
    gain_ahead, gain_behind : ndarray (n,) [dimensionless or m]
        |∂p/∂y · n| of the flank ahead of the roller and of the flank behind it.
    sign : float
        Sign of the driver's effort, ±1.

    Returns
    -------
    Forces
        The contact force is positive on the flank behind the roller, negative on the flank ahead.

    References
    ----------
    Virtual power, T_c δθ = Q δy and Q δy = F_c n · δp.
    """
    effort = sign * forces.driver
    contact = np.where(effort >= 0.0, effort / gain_behind, effort / gain_ahead) + 0.0
    lazy = {
        field.name: partial(getattr, forces, field.name)
        for field in fields(forces)
        if isinstance(vars(Forces).get(field.name), Lazy)
    }
    plain = {field.name: getattr(forces, field.name) for field in fields(forces) if field.name not in lazy}
    return Forces(**{**plain, **lazy, "contact": contact, "torque": effort * y_1, "in_space": True})


def _solve_flanks(
    solve_with: Callable[[Walk | None], _Solution], unit_contacts: Sequence[Walk]
) -> tuple[_Solution, list[np.ndarray]]:
    """The solution with the flank in contact at each angle, and the force on each flank (n,).

    The first flank is in contact where it presses; where it would have to pull, the second one, by the same equation
    with its lever. A single flank is in contact whatever the sign.
    """
    first = solve_with(unit_contacts[0] if unit_contacts else None)
    if len(unit_contacts) < 2:
        return first, [first.contact for _ in unit_contacts]
    pulls = ~(first.contact >= 0.0)
    if not pulls.any():
        return first, [first.contact, np.zeros(1)]
    second = solve_with(unit_contacts[1])
    forces = [np.where(pulls, 0.0, first.contact), np.where(pulls, second.contact, 0.0)]
    return _choose(pulls, second, first), forces


def _choose(mask: np.ndarray, left: Any, right: Any) -> Any:
    """The left solution where the mask (n,) is true, the right one elsewhere."""
    if isinstance(left, np.ndarray):
        return np.where(mask, left, right)
    if callable(left):
        return lambda: _choose(mask, left(), right())
    if isinstance(left, dict):
        return {name: _choose(mask, left[name], right[name]) for name in left}
    if isinstance(left, tuple):
        return type(left)(*(_choose(mask, a, b) for a, b in zip(left, right, strict=True)))
    if isinstance(left, GuideReaction):
        names = [field.name for field in fields(left)]
        return replace(left, **{name: _choose(mask, getattr(left, name), getattr(right, name)) for name in names})
    return left


def _normal(kinematics: Kinematics, name: str, force: np.ndarray) -> np.ndarray:
    """Normal force N (n,) of a sliding pair, along its line + 90°; of a pin its force."""
    pair = kinematics.pairs[name]
    return force if pair.kind == REVOLUTE else dot(1j * kinematics.line(pair), force)


def _with_friction(
    kinematics: Kinematics,
    loading: Loading,
    case: LoadCase,
    unit_cases: Mapping[str, LoadCase],
    signs: Mapping[str, np.ndarray],
) -> _Solution:
    """Solution for the loads and the friction that their reactions cause."""
    sizes, jam, most_jamming = _sizes(kinematics, loading, case, unit_cases, signs)
    signed = {name: signs[name] * size for name, size in sizes.items()}
    contact, driver = case.contact, case.driver
    for name, size in signed.items():
        if case.unit_contact is None:
            driver = driver + size * unit_cases[name].driver
        else:
            contact = contact + size * unit_cases[name].contact

    shares = {name: (unit_cases[name], size) for name, size in signed.items()}

    def friction_work() -> dict[str, np.ndarray]:
        speed = kinematics.driver_sign * kinematics.motion.displacement[1]
        slips = {name: 1.0 if name == kinematics.driver_name else kinematics.slip(name) for name in signed}
        return {name: size * slips[name] * speed for name, size in signed.items()}

    @once
    def reactions() -> _Reactions:
        return _reactions(kinematics, case, contact, shares, kinematics.pairs)

    def normals() -> dict[str, np.ndarray]:  # without the reactions of the other pairs
        forces = _reactions(kinematics, case, contact, shares, signed).pairs
        return {name: _normal(kinematics, name, forces[name]) for name in signed}

    def guide() -> GuideReaction:
        n, name = kinematics.count, loading.guide
        normal, friction = (
            _normal(kinematics, name, reactions().pairs[name]),
            -signed[name] if name in signed else _ZERO,
        )
        return GuideReaction(spread(normal, n), spread(friction, n), jam)

    return _Solution(
        contact, driver, sizes, friction_work, reactions, normals, guide if loading.guide else None, jam, most_jamming
    )


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _reactions(
    kinematics: Kinematics,
    case: LoadCase,
    contact: np.ndarray,
    signed: Mapping[str, tuple[LoadCase, np.ndarray]],
    names: Iterable[str],
) -> _Reactions:
    """Reactions of the named pairs to the loads, to friction of these signed sizes (n,), and to the contact force (n,)."""
    shares = [(size, unit_case.walk) for unit_case, size in signed.values()]
    if case.unit_contact is not None:
        shares.append((contact, case.unit_contact))

    def parts(value: Callable[[Walk, str], np.ndarray | None], name: str) -> list[np.ndarray]:
        rows = [value(case.walk, name)]
        rows += [None if (unit := value(walk, name)) is None else size * unit for size, walk in shares]
        return [row for row in rows if row is not None]

    pairs: dict[str, np.ndarray] = {}
    couples: dict[str, np.ndarray] = {}
    for name in names:
        pair = kinematics.pairs[name]
        is_pin = pair.kind == REVOLUTE
        for total, value in ((pairs, Walk.reaction), *(() if is_pin else ((couples, Walk.couple),))):
            rows = parts(value, name)
            total[name] = np.asarray(sum(rows[1:], rows[0])) if rows else _ZERO_FORCE if is_pin else _ZERO
        if not is_pin:
            pairs[name] = 1j * kinematics.line(pair) * pairs[name]
    for name in (input_of(dyad.bodies[0]) for dyad in kinematics.dyads if dyad.on):
        couples[name] = np.asarray(sum(parts(Walk.couple, name), _ZERO))
    for name, (_, size) in signed.items():
        if kinematics.pairs[name].kind == REVOLUTE:
            couples[name] = couples.get(name, 0.0) - size
        else:
            pairs[name] = pairs[name] - size * kinematics.line(kinematics.pairs[name])
    return _Reactions(pairs, couples)


def _sizes(
    kinematics: Kinematics,
    loading: Loading,
    case: LoadCase,
    unit_cases: Mapping[str, LoadCase],
    signs: Mapping[str, np.ndarray],
) -> tuple[dict[str, np.ndarray], Callable[[], np.ndarray], Callable[[], np.ndarray]]:
    """Friction of every pair (n,) [N; N m in pins]; functions of the jam factor and of the pair that jams most (n,).

    A slide of finite length has friction at both edges, each with its share of the reaction.
    """
    n, frictions = kinematics.count, loading.frictions
    if not frictions:
        return {}, lambda: np.zeros(n), lambda: np.zeros(1, dtype=int)
    if len(frictions) == 1 and not frictions[0].length and kinematics.pairs[frictions[0].pair].kind != REVOLUTE:
        (friction,) = frictions
        (normal,), (gain,) = [_reaction_parts(friction, c) for c in (case, unit_cases[friction.pair])]
        reaction = guide_reaction(normal, signs[friction.pair], -gain, friction.coefficient)
        return {friction.pair: np.abs(reaction.friction)}, lambda: reaction.jam, lambda: np.zeros(1, dtype=int)
    normals = [_reaction_parts(f, case) for f in frictions]
    number = np.repeat(np.arange(len(frictions)), [len(parts) for parts in normals])
    by_pair = [[part for f in frictions for part in _reaction_parts(f, unit_cases[g.pair])] for g in frictions]
    parts = [part for row in (*normals, *by_pair) for part in row]
    shape = np.broadcast_shapes((n,), *(np.shape(part) for part in parts))  # (m, n) for m designs

    def flat(row: Any) -> np.ndarray:
        return np.broadcast_to(row, shape).ravel()

    limits = [f.coefficient * f.radius for f in frictions]
    coefficients = np.array([flat(c) for c in limits] if any(map(np.ndim, limits)) else limits)[number]
    gains = np.empty((number.size, number.size, flat(_ZERO).size), dtype=complex)
    for column, g in enumerate(number):
        for row, part in enumerate(by_pair[g]):
            gains[row, column] = flat(signs[frictions[g].pair] * part)
    frictionless = np.array([flat(part) for row in normals for part in row]).astype(complex)
    forces = magnitudes(frictionless, gains, coefficients, jam_factor_bound(gains, coefficients))
    forces = forces * coefficients.reshape(number.size, -1)
    sizes = {f.pair: forces[number == i].sum(axis=0).reshape(shape) for i, f in enumerate(frictions)}
    return (
        sizes,
        lambda: jam_factor(gains, coefficients).reshape(shape),
        lambda: number[critical_friction(gains, coefficients)].reshape(shape),
    )


def _reaction_parts(friction: Friction, case: LoadCase) -> list[np.ndarray]:
    """Reactions of a pair with friction, (n,) each: the pair's, or those of the two edges of a slide."""
    normal = case.reaction(friction.pair)
    return _edge_forces(normal, case.couple(friction.pair), friction.length) if friction.length else [normal]


def edge_forces(kinematics: Kinematics, forces: Forces, friction: Friction) -> list[np.ndarray]:
    """Normal force of a pair with friction, or of the two edges of a slide; friction jumps where one changes its sign.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    forces : Forces
        With or without this friction.
    friction : Friction

    Returns
    -------
    list of ndarray (n,) [N]
        Complex for a pin.
    """
    normal = forces.normals.get(friction.pair)
    if normal is None:
        normal = _normal(kinematics, friction.pair, forces.pairs[friction.pair])
    couple = forces.couples.get(friction.pair, _ZERO) if friction.length else _ZERO
    return _edge_forces(normal, couple, friction.length)


def _edge_forces(normal: np.ndarray, couple: np.ndarray, length: float) -> list[np.ndarray]:
    """N, or for a slide of finite length N/2 ± M/length."""
    return [0.5 * normal + couple / length, 0.5 * normal - couple / length] if length else [normal]


def _follower_torque(kinematics: Kinematics, contacts: tuple[Contact, ...]) -> np.ndarray:
    """Torque T_L = -F_c (r_C × n) on the follower (24), with friction, or force -F_c n·e along its guide."""
    if not kinematics.ground:
        return np.full(kinematics.count, np.nan)
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind != REVOLUTE:
        rows = [-contact.force * dot(contact.direction, kinematics.line(pair)) for contact in contacts]
    else:
        pivot = kinematics.bodies[pair.body].position(pair.point)
        rows = [-contact.force * cross(contact.at - pivot, contact.direction) for contact in contacts]
    return np.asarray(sum(rows[1:], rows[0]))


# -- statically indeterminate reactions -------------------------------------------------------------------------


_RANK = 1e-9  # of the largest singular value
_SHARE = 1e-7  # of the largest component in the null space


def undetermined_pairs(kinematics: Kinematics) -> frozenset[str]:
    """Pairs whose forces statics does not determine.

    They have a component in the null space of the balance of all bodies, A R + loads = 0, at the angle where that space
    is smallest (it is larger at a dead centre). The columns of A are the two components of each pair, the driver, and
    each second driver.
    """
    if not kinematics.is_redundant:
        return frozenset()
    matrices = _balance(kinematics)
    _, s, vh = np.linalg.svd(matrices[np.isfinite(matrices).all(axis=(1, 2))])
    ranks = (s > _RANK * s[:, :1]).sum(axis=1)
    best = int(ranks.argmax())
    null_space = np.abs(vh[best, ranks[best] :])
    shares = null_space.max(axis=0, initial=0.0)
    undetermined = shares > _SHARE * max(float(shares.max(initial=0.0)), 1e-300)
    return frozenset(name for i, name in enumerate(kinematics.pairs) if undetermined[2 * i : 2 * i + 2].any())


def _balance(kinematics: Kinematics) -> np.ndarray:
    """Matrix A (n, 3 bodies, columns), with moments relative to the size of the mechanism."""
    n = kinematics.theta.size
    bodies = [name for name in kinematics.bodies if name != FRAME]
    inputs = [dyad for dyad in kinematics.dyads if dyad.on]
    matrix = np.zeros((n, 3 * len(bodies), 2 * len(kinematics.pairs) + 1 + len(inputs)))
    points = {name: kinematics.bodies[pair.body].position(pair.point) for name, pair in kinematics.pairs.items()}
    size = max((float(np.abs(at - next(iter(points.values()))).max()) for at in points.values()), default=1.0) or 1.0

    def fill(column: int, name: str, force: np.ndarray, couple: float) -> None:
        pair, at = kinematics.pairs[name], points[name]
        for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
            if body in bodies:
                row = 3 * bodies.index(body)
                matrix[:, row, column] += sign * force.real
                matrix[:, row + 1, column] += sign * force.imag
                matrix[:, row + 2, column] += sign * ((np.conj(at) * force).imag / size + couple)

    for i, (name, pair) in enumerate(kinematics.pairs.items()):
        unit = np.ones(1, dtype=complex)
        is_pin = pair.kind == REVOLUTE
        fill(2 * i, name, unit if is_pin else 1j * kinematics.line(pair), 0.0)
        fill(2 * i + 1, name, 1j * unit if is_pin else 0.0 * unit, 0.0 if is_pin else 1.0)
    driving, drives = kinematics.driver_pair, 2 * len(kinematics.pairs)
    is_pin = driving.kind == REVOLUTE
    fill(
        drives,
        kinematics.driver_name,
        np.zeros(1, dtype=complex) if is_pin else kinematics.line(driving),
        float(is_pin),
    )
    for i, dyad in enumerate(inputs, 1):
        for _, load in input_loads(kinematics, dyad, np.ones(1)):
            if load.body in bodies:
                row = 3 * bodies.index(load.body)
                matrix[:, row, drives + i] += load.force.real
                matrix[:, row + 1, drives + i] += load.force.imag
                matrix[:, row + 2, drives + i] += (np.conj(load.at) * load.force).imag / size + load.couple
    return matrix
