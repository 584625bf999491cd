"""Inverse dynamics: every reaction, the contact force and the torque that turns the cam or the driver (Shin1995 §4).

Forces follow from three kinds of walks through the mechanism: of its own loads, of one newton of contact force, and of one
newton of friction in each pair that rubs. The contact force is what leaves nothing to be given to the driver; friction is
found from the reactions, which are affine in it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from core.cam import CamShape
from core.dynamics.elements import Friction, Load, Loading, Rate
from core.dynamics.friction import JAMMED, GuideReaction, guide_reaction, jam_factor, jammed, limitless, magnitudes
from core.dynamics.walk import Walk
from core.mechanism.kinematics import REVOLUTE, Kinematics
from core.numerics.lazy import Lazy
from core.numerics.vectors import cross, dot

BEARING = "bearing"
JAMS = 1.0  # the factor from which friction may jam


@dataclass(frozen=True, eq=False)
class Forces:
    """All forces at n cam or crank angles, at constant speed ``omega`` [rad/s]; complex = global frame [N].

    pairs     pair name -> (n,) force by ``on`` on ``body``, friction included; ``bearing`` by the frame on the camshaft
    couples   pair name -> (n,) couple [N m] by ``on`` on ``body``: of sliding pairs, and of pins that rub
    contact   (n,) F_c [N], > 0 presses the follower on the cam; 0 without a cam
    pressing  (n,) complex: n + μ v̂, the force on the cam for one newton of contact, friction of a face that slides included
    torque    (n,) T_c [N m], > 0 drives the cam (27); 0 without a cam
    driver    (n,) on the driver where no cam moves it: torque [N m] counter-clockwise where it is pinned to the frame, force
              [N] along its line where it slides; else 0
    lever     (n,) what one newton of contact asks of the driver [m, or 1]; infinite without a cam
    follower_torque  (n,) T_L [N m] that the contact gives the follower's link about its pivot (24); for a guide: force [N]
    guide     the guide's normal force, friction and jamming factor; None where the design has no guide
    lost      (n,) power [W] lost to friction
    jam       (n,) the factor that must stay below 1: the spectral radius of μ|∂N/∂f| over all pairs that rub
    contact_jam  (n,) likewise: how much of the lever of the contact's normal force its friction takes away
    """

    omega: float
    pairs: Mapping[str, np.ndarray]
    couples: Mapping[str, np.ndarray]
    contact: np.ndarray
    pressing: np.ndarray
    torque: np.ndarray
    driver: np.ndarray
    lever: np.ndarray
    lost: np.ndarray
    jam: np.ndarray
    contact_jam: np.ndarray
    follower_torque: Lazy[np.ndarray] = Lazy()
    guide: GuideReaction | None = None


@dataclass(frozen=True, eq=False)
class _Case:
    """Reactions of one load case, the contact force that it asks for included."""

    pairs: Mapping[str, np.ndarray]
    couples: Mapping[str, np.ndarray]
    contact: np.ndarray
    driver: np.ndarray


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def newton_euler(
    kinematics: Kinematics, shape: CamShape | None, loading: Loading, omega: float, acceleration: float = 0.0
) -> Forces:
    """Forces at camshaft speed omega [rad/s, > 0] and acceleration [rad/s²] of the coordinate that the poses are differentiated by.

    T_c = -d (C × F_c (n + μ v̂)) (27) at the contact C, where a face that slides rubs by μ F_c v̂ on the cam, v̂ the direction of
    the follower relative to it; F_c from the equilibrium of the driven bodies, never from T_c, which is 0/0 in a dwell (25),
    (26). Where friction jams the forces are infinite; the findings say so.
    """
    rate = Rate(omega, acceleration)
    n, friction_of_cam = kinematics.theta.size, loading.contact_friction
    cam = None if shape is None else (shape.flank.contact, _pressing(shape, friction_of_cam))
    places: dict[str, np.ndarray] = {}
    press = None if cam is None else Walk(kinematics, [Load(kinematics.carrier, cam[0], -cam[1])], places)
    contact_jam = np.zeros(n)
    if friction_of_cam and shape is not None and press is not None:
        smooth = Walk(kinematics, [Load(kinematics.carrier, shape.flank.contact, -shape.flank.normal)], places).needed
        contact_jam = np.broadcast_to(np.nan_to_num(1.0 - press.needed / smooth, nan=0.0), n)
        press.needed = np.where(contact_jam < JAMS, press.needed, smooth / JAMMED)
    own = Walk(kinematics, [load for element in loading.elements for load in element.loads(kinematics, rate)], places)
    case = _case(own, press)
    signs, rubbing = {}, {}
    for friction in loading.frictions:
        signs[friction.pair] = _direction(kinematics, friction.pair) * np.sign(omega)
        rubbing[friction.pair] = _case(Walk(kinematics, _unit_friction(kinematics, friction), places), press)
    total, guide, jam, lost = _with_friction(kinematics, loading, case, rubbing, signs)
    pairs, contact = dict(total.pairs), total.contact
    if cam is not None:
        pairs[BEARING] = -contact * cam[1]
    torque = np.zeros(n) if shape is None or cam is None else -shape.sense * cross(cam[0], contact * cam[1])
    if friction_of_cam and shape is not None:
        lost = lost + friction_of_cam * contact * np.abs(shape.flank.sliding)
    forces = Forces(
        omega=omega,
        pairs=pairs,
        couples=total.couples,
        contact=np.broadcast_to(contact, n),
        pressing=np.zeros(n, dtype=complex) if cam is None else cam[1],
        torque=torque,
        driver=np.broadcast_to(total.driver, n),
        lever=np.full(n, np.inf) if press is None else np.broadcast_to(press.needed, n),
        lost=lost * omega,
        jam=np.maximum(jam, contact_jam),
        contact_jam=contact_jam,
        follower_torque=lambda: np.zeros(n) if shape is None else _follower_torque(kinematics, shape, contact, forces.pressing),
        guide=guide,
    )
    return limitless(forces) if (guide is not None and jammed(guide.normal)) or jammed(contact) else forces


def _pressing(shape: CamShape, friction: float) -> np.ndarray:
    """n + μ v̂ (n,): the force on the cam for one newton of contact, v̂ = ± i d n the direction of the follower relative to it."""
    flank = shape.flank
    if not friction:
        return flank.normal
    return flank.normal * (1.0 + 1j * shape.sense * friction * np.sign(flank.sliding))


def _case(walk: Walk, press: Walk | None) -> _Case:
    """A walk's reactions with the contact force that leaves nothing to the driver."""
    if press is None:
        return _Case(walk.pairs, walk.couples, np.zeros(1), walk.needed)
    contact = -walk.needed / press.needed
    names, couples = {*walk.pairs, *press.pairs}, {*walk.couples, *press.couples}
    return _Case(
        {name: walk.pairs.get(name, 0.0) + contact * press.pairs.get(name, 0.0) for name in names},
        {name: walk.couples.get(name, 0.0) + contact * press.couples.get(name, 0.0) for name in couples},
        contact,
        np.zeros(1),
    )


def _unit_friction(kinematics: Kinematics, friction: Friction) -> list[Load]:
    """One newton of friction (one newton metre in a pin) on ``body`` against positive slip, and the like on ``on``."""
    pair = kinematics.pairs[friction.pair]
    at = kinematics.bodies[pair.body].place(pair.point)
    force = np.zeros(1, dtype=complex) if pair.kind == REVOLUTE else -kinematics.line(pair)
    couple = -1.0 if pair.kind == REVOLUTE else 0.0
    return [Load(pair.body, at, force, couple), Load(pair.on, at, -force, -couple)]


def _direction(kinematics: Kinematics, name: str) -> np.ndarray:
    """Which way a pair slips (n,): -1, 0, 1, as the motion's segment says; rounding beside a dwell must not toggle it."""
    if name == kinematics.driver_name:
        return kinematics.motion.velocity_sign
    return np.asarray(kinematics.motion.velocity_sign * np.sign(kinematics.slip(name)))


def _normal(kinematics: Kinematics, name: str, force: np.ndarray) -> np.ndarray:
    """The normal force N of a sliding pair (n,), along its line + 90 deg; of a pin the force itself."""
    pair = kinematics.pairs[name]
    return force if pair.kind == REVOLUTE else dot(1j * kinematics.line(pair), force)


def _with_friction(
    kinematics: Kinematics, loading: Loading, case: _Case, rubbing: Mapping[str, _Case], signs: Mapping[str, np.ndarray]
) -> tuple[_Case, GuideReaction | None, np.ndarray, np.ndarray]:
    """The reactions with the friction that goes with them, those of the guide, the jam factor, and what friction takes per
    radian of the shaft [N m]."""
    n, guide = kinematics.theta.size, None
    pairs, couples, contact, driver = dict(case.pairs), dict(case.couples), case.contact, case.driver
    sizes, jam = _sizes(kinematics, loading, case, rubbing, signs)
    lost = np.zeros(n)
    for name, size in sizes.items():
        signed, one = signs[name] * size, rubbing[name]
        for other, force in one.pairs.items():
            pairs[other] = pairs.get(other, 0.0) + signed * force
        for other, couple in one.couples.items():
            couples[other] = couples.get(other, 0.0) + signed * couple
        contact, driver = contact + signed * one.contact, driver + signed * one.driver
        moves = kinematics.motion.y[1] if name == kinematics.driver_name else kinematics.slip(name) * kinematics.motion.y[1]
        lost = lost + signed * moves
        if kinematics.pairs[name].kind == REVOLUTE:
            couples[name] = couples.get(name, 0.0) - signed
        else:
            pairs[name] = pairs[name] - signed * kinematics.line(kinematics.pairs[name])
    if loading.guide:
        name = loading.guide
        normal = np.broadcast_to(_normal(kinematics, name, pairs[name]), n)
        rubs = -signs[name] * sizes[name] if name in sizes else np.zeros(n)
        guide = GuideReaction(normal, np.broadcast_to(rubs, n), jam)
    sliding = (name for name, pair in kinematics.pairs.items() if pair.kind != REVOLUTE)
    pairs = {name: np.broadcast_to(pairs.get(name, 0j), n) for name in kinematics.pairs}
    couples = {name: np.broadcast_to(couples.get(name, 0.0), n) for name in {**dict.fromkeys(sliding), **couples}}
    return _Case(pairs, couples, contact, driver), guide, jam, lost


def _sizes(
    kinematics: Kinematics, loading: Loading, case: _Case, rubbing: Mapping[str, _Case], signs: Mapping[str, np.ndarray]
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Friction of every pair that rubs (n,) [N; N m in pins], and the jam factor (n,)."""
    n, frictions = kinematics.theta.size, loading.frictions
    if not frictions:
        return {}, np.zeros(n)
    normals = [_normal(kinematics, f.pair, case.pairs[f.pair]) for f in frictions]
    gains = [[_normal(kinematics, f.pair, _of(rubbing[g.pair], f.pair)) for g in frictions] for f in frictions]
    if len(frictions) == 1 and kinematics.pairs[frictions[0].pair].kind != REVOLUTE:
        (friction,) = frictions
        reaction = guide_reaction(normals[0], signs[friction.pair], -gains[0][0], friction.coefficient)
        return {friction.pair: np.abs(reaction.friction)}, reaction.jam
    coefficients = np.array([f.coefficient * f.radius for f in frictions])
    signed = np.array([[np.broadcast_to(signs[g.pair] * one, n) for g, one in zip(frictions, row, strict=True)] for row in gains])
    matrix = np.moveaxis(signed, 2, 0)
    jam = jam_factor(matrix, coefficients)
    free = np.array([np.broadcast_to(normal, n) for normal in normals]).T.astype(complex)
    found = magnitudes(free, matrix, coefficients, jam) * coefficients
    return {f.pair: found[:, i] for i, f in enumerate(frictions)}, jam


def _of(case: _Case, name: str) -> np.ndarray:
    return np.asarray(case.pairs.get(name, np.zeros(1, dtype=complex)))


def _follower_torque(kinematics: Kinematics, shape: CamShape, contact: np.ndarray, pressing: np.ndarray) -> np.ndarray:
    """T_L = -F_c (r_C × n) about the pivot that holds the follower's link (24), with the friction of the contact; along its
    guide -F_c n·e."""
    if not kinematics.ground:
        return np.full(kinematics.theta.size, np.nan)
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind != REVOLUTE:
        return -contact * dot(pressing, kinematics.line(pair))
    return -contact * cross(shape.flank.contact - kinematics.bodies[pair.body].place(pair.point), pressing)
