"""Inverse dynamics: every reaction, the contact force and the torque that turns the cam or the driver (Shin1995 §4).

Forces follow from three kinds of walks through the mechanism: of its own loads, of one newton of contact force, and of one
newton of friction in each pair that rubs. The contact force is what leaves nothing to be given to the driver; friction is
found from the reactions, which are affine in it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from core.cam import CamShape
from core.dynamics.elements import Friction, Load, Loading, Rate
from core.dynamics.friction import JAMMED, GuideReaction, guide_reaction, jam_factor, jammed, limitless, magnitudes
from core.dynamics.walk import Walk
from core.mechanism.kinematics import REVOLUTE, Kinematics
from core.numerics.lazy import Lazy
from core.numerics.vectors import cross, dot, spread

BEARING = "bearing"
JAMS = 1.0  # the factor from which friction may jam
_NONE, _NO_FORCE = np.zeros(1), np.zeros(1, dtype=complex)


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


class _Case:
    """A walk of loads with the contact force (n,) that leaves nothing to the driver; without a cam, what the driver is given."""

    def __init__(self, walk: Walk, press: Walk | None) -> None:
        self.walk, self.press = walk, press
        self.contact = np.zeros(1) if press is None else -walk.needed / press.needed
        self.driver = walk.needed if press is None else np.zeros(1)

    def pair(self, name: str) -> np.ndarray:
        """A pair's force (n,), with what the contact adds to it."""
        force = self.walk.pairs.get(name, _NO_FORCE)
        if self.press is None or name not in self.press.pairs:
            return force
        return force + self.contact * self.press.pairs[name]


class _Reactions(NamedTuple):
    """Forces and couples of all pairs, contact force, and what the driver is given, (n,) or (1,)."""

    pairs: dict[str, np.ndarray]
    couples: dict[str, np.ndarray]
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
    pressing = np.zeros(n, dtype=complex) if cam is None else cam[1]
    places: dict[str, np.ndarray] = {}
    press = None if cam is None else Walk(kinematics, [Load(kinematics.carrier, cam[0], -cam[1])], places)
    contact_jam = np.zeros(n)
    if friction_of_cam and shape is not None and press is not None:
        smooth = Walk(kinematics, [Load(kinematics.carrier, shape.flank.contact, -shape.flank.normal)], places).needed
        contact_jam = np.broadcast_to(np.nan_to_num(1.0 - press.needed / smooth, nan=0.0), n)
        press.needed = np.where(contact_jam < JAMS, press.needed, smooth / JAMMED)
    own = Walk(kinematics, [load for element in loading.elements for load in element.loads(kinematics, rate)], places)
    case = _Case(own, press)
    signs, rubbing = {}, {}
    for friction in loading.frictions:
        signs[friction.pair] = _direction(kinematics, friction.pair) * np.sign(omega)
        rubbing[friction.pair] = _Case(Walk(kinematics, _unit_friction(kinematics, friction), places), press)
    total, guide, jam, lost = _with_friction(kinematics, loading, case, rubbing, signs)
    pairs, contact, torque = total.pairs, total.contact, _NONE
    if shape is not None and cam is not None:
        pairs[BEARING] = -contact * cam[1]
        torque = shape.sense * cross(cam[0], pairs[BEARING])
        if not friction_of_cam:  # in a dwell no power goes in, only rounding
            torque = np.where(kinematics.motion.velocity_sign == 0.0, 0.0, torque)
        if friction_of_cam:
            lost = lost + friction_of_cam * contact * np.abs(shape.flank.sliding)
    forces = Forces(
        omega=omega,
        pairs={name: spread(force, n) for name, force in pairs.items()},
        couples={name: spread(couple, n) for name, couple in total.couples.items()},
        contact=spread(contact, n),
        pressing=pressing,
        torque=spread(torque, n),
        driver=spread(total.driver, n),
        lever=np.full(n, np.inf) if press is None else spread(press.needed, n),
        lost=spread(lost * omega, n),
        jam=np.maximum(jam, contact_jam),
        contact_jam=contact_jam,
        follower_torque=lambda: np.zeros(n) if shape is None else _follower_torque(kinematics, shape, contact, pressing),
        guide=guide,
    )
    return limitless(forces) if (guide is not None and jammed(guide.normal)) or jammed(contact) else forces


def _pressing(shape: CamShape, friction: float) -> np.ndarray:
    """n + μ v̂ (n,): the force on the cam for one newton of contact, v̂ = ± i d n the direction of the follower relative to it."""
    flank = shape.flank
    if not friction:
        return flank.normal
    return flank.normal * (1.0 + 1j * shape.sense * friction * np.sign(flank.sliding))


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


def _reactions(case: _Case, rubbing: Mapping[str, _Case], signed: Mapping[str, np.ndarray]) -> _Reactions:
    """Of the own loads, of friction of these sizes with their signs (n,), and of the contact force that both ask for."""
    contact, driver = case.contact, case.driver
    pairs, couples = dict(case.walk.pairs), dict(case.walk.couples)
    for name, size in signed.items():
        contact, driver = contact + size * rubbing[name].contact, driver + size * rubbing[name].driver
    shares = [(size, rubbing[name].walk) for name, size in signed.items()]
    for size, walk in shares if case.press is None else [*shares, (contact, case.press)]:
        for total, parts in ((pairs, walk.pairs), (couples, walk.couples)):
            for name, part in parts.items():
                total[name] = total[name] + size * part if name in total else size * part
    return _Reactions(pairs, couples, contact, driver)


def _with_friction(
    kinematics: Kinematics, loading: Loading, case: _Case, rubbing: Mapping[str, _Case], signs: Mapping[str, np.ndarray]
) -> tuple[_Reactions, GuideReaction | None, np.ndarray, np.ndarray]:
    """The reactions with the friction that goes with them, those of the guide, the jam factor, and what friction takes per
    radian of the shaft [N m]."""
    sizes, jam = _sizes(kinematics, loading, case, rubbing, signs)
    signed = {name: signs[name] * size for name, size in sizes.items()}
    total, lost, guide = _reactions(case, rubbing, signed), _NONE, None
    pairs, couples = total.pairs, total.couples
    for name, size in signed.items():
        slip = 1.0 if name == kinematics.driver_name else kinematics.slip(name)
        lost = lost + size * slip * kinematics.motion.displacement[1]
        if kinematics.pairs[name].kind == REVOLUTE:
            couples[name] = couples.get(name, 0.0) - size
        else:
            pairs[name] = pairs[name] - size * kinematics.line(kinematics.pairs[name])
    for name, pair in kinematics.pairs.items():
        pairs.setdefault(name, _NO_FORCE)
        if pair.kind != REVOLUTE:
            couples.setdefault(name, _NONE)
    if loading.guide:
        n, name = kinematics.theta.size, loading.guide
        normal, rubs = _normal(kinematics, name, pairs[name]), -signed[name] if name in signed else _NONE
        guide = GuideReaction(spread(normal, n), spread(rubs, n), jam)
    return total, guide, jam, lost


def _sizes(
    kinematics: Kinematics, loading: Loading, case: _Case, rubbing: Mapping[str, _Case], signs: Mapping[str, np.ndarray]
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Friction of every pair that rubs (n,) [N; N m in pins], and the jam factor (n,)."""
    n, frictions = kinematics.theta.size, loading.frictions
    if not frictions:
        return {}, np.zeros(n)
    normals = [_normal(kinematics, f.pair, case.pair(f.pair)) for f in frictions]
    gains = [[_normal(kinematics, f.pair, rubbing[g.pair].pair(f.pair)) for g in frictions] for f in frictions]
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


def _follower_torque(kinematics: Kinematics, shape: CamShape, contact: np.ndarray, pressing: np.ndarray) -> np.ndarray:
    """T_L = -F_c (r_C × n) about the pivot that holds the follower's link (24), with the friction of the contact; along its
    guide -F_c n·e."""
    if not kinematics.ground:
        return np.full(kinematics.theta.size, np.nan)
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind != REVOLUTE:
        return -contact * dot(pressing, kinematics.line(pair))
    return -contact * cross(shape.flank.contact - kinematics.bodies[pair.body].place(pair.point), pressing)
