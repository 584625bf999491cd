"""Proof of the forces by laws they were not computed from: power, and linear and angular momentum of all bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.cam import CamShape
from core.dynamics.elements import Element, Load, Loading, Rate
from core.dynamics.forces import Forces
from core.dynamics.walk import input_loads, input_of
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics
from core.numerics.vectors import cross


@np.errstate(invalid="ignore")  # inf - inf where friction jams, which counts as balanced
def power_residual(kinematics: Kinematics, shape: CamShape | None, forces: Forces, loading: Loading) -> np.ndarray:
    """What cam or driver give against the rates of kinetic and potential energy and what friction takes (n,), relative to
    the peak of its terms and of ω|R||F_c|, the product that T_c ω is taken from: where the cam only holds, nothing else is
    left."""
    omega = forces.omega
    given = power_given(kinematics, forces)
    terms = power_terms(kinematics, forces, loading)
    sizes = list(terms)
    if shape is not None:
        sizes += [omega * np.abs(each.at) * each.force for each in forces.contacts]
    else:
        sizes.append(given)
    return _relative(given - sum(terms), sizes)


def peak_load(element: Element, kinematics: Kinematics, omega: float) -> tuple[float, str]:
    """The largest force of an element over the angles of the kinematics, at a steady speed [rad/s], and its unit; of what has no
    force its largest couple."""
    parts = list(element.loads(kinematics, Rate(omega)))
    force = max((float(np.abs(load.force).max()) for load in parts), default=0.0)
    couple = max((float(np.abs(load.couple).max()) for load in parts), default=0.0)
    return (force, "N") if force or not couple else (couple, "N·m")


def power_terms(kinematics: Kinematics, forces: Forces, loading: Loading) -> list[np.ndarray]:
    """Where the power given goes [W], each (n,): into kinetic energy, into friction, into each force element."""
    omega = forces.omega
    terms = [0.5 * omega**3 * loading.inertia(kinematics, 2)[1], forces.lost]
    for element in loading.elements:
        terms += [omega * element.potential(kinematics)[0], element.lost(kinematics, abs(omega))]
    return terms


def power_given(kinematics: Kinematics, forces: Forces) -> np.ndarray:
    """What cam or driver, and inputs with motions of their own, give the mechanism (n,) [W]."""
    given = forces.torque + forces.driver * kinematics.motion.displacement[1]
    for dyad in (each for each in kinematics.dyads if each.on and each.by_motion):
        body, on = (kinematics.bodies[name].turn[1] for name in (dyad.bodies[0], dyad.on))
        given = given + forces.couples[input_of(dyad.bodies[0])] * (body - on)
    return np.asarray(given * forces.omega)


def power_of_gravity(kinematics: Kinematics, loading: Loading, omega: float) -> np.ndarray:
    """What the weight of all bodies gives the mechanism (n,) [W]: > 0 while they sink."""
    return np.asarray(sum(power_of(mass, kinematics, omega) for mass in loading.masses))


def power_of(element: Element, kinematics: Kinematics, omega: float) -> np.ndarray:
    """What a force element gives the mechanism (n,) [W]: < 0 where it takes, as a damper always does."""
    return np.asarray(-omega * element.potential(kinematics)[0] - element.lost(kinematics, omega))


def kinetic_energy(kinematics: Kinematics, loading: Loading, omega: float, body: str | None = None) -> np.ndarray:
    """Of all bodies, or of one (n,) [J] at constant speed [rad/s]: J ω²/2, J as they are worth at the shaft."""
    masses = tuple(mass for mass in loading.masses if body in (None, mass.body))
    return np.asarray(0.5 * omega * omega * replace(loading, masses=masses).inertia(kinematics, 1)[0])


@np.errstate(invalid="ignore")
def momentum_residual(kinematics: Kinematics, shape: CamShape | None, forces: Forces, loading: Loading) -> np.ndarray:
    """Sum of outer forces and inertia forces of all bodies, and of their moments about the origin (n,), each relative to
    the peak of its terms, of a moment |r||F|. Power alone cannot see an error in a pin, the pivot or a frictionless guide.

    Outer forces are those of the frame, of the cam, of the driver, and of all force elements.
    """
    outer: list[Load] = [load for element in loading.elements for load in element.loads(kinematics, Rate(forces.omega))]
    for name, pair in kinematics.pairs.items():
        if FRAME in (pair.on, pair.body):
            sign = 1.0 if pair.on == FRAME else -1.0
            at = kinematics.bodies[pair.body if pair.on == FRAME else pair.on].place(pair.point)
            couple = sign * forces.couples.get(name, np.zeros(1))
            outer.append(Load("", at, sign * forces.pairs.get(name, np.zeros(1, dtype=complex)), couple))
            if name == kinematics.driver_name:
                turns = pair.kind == REVOLUTE
                push = np.zeros(1, dtype=complex) if turns else forces.driver * kinematics.line(pair)
                outer.append(Load("", at, push, forces.driver if turns else 0.0))
    for dyad in (each for each in kinematics.dyads if each.on):  # its wheels are held by the frame
        loads = (load for _, load in input_loads(kinematics, dyad, forces.couples[input_of(dyad.bodies[0])]))
        outer += [load for load in loads if load.body != FRAME]
    outer += [Load("", each.at, -each.force * each.pressing) for each in forces.contacts]
    linear = [load.force for load in outer]
    moments = [cross(load.at, load.force) + load.couple for load in outer]
    products = [np.abs(load.at) * np.abs(load.force) + np.abs(load.couple) for load in outer]
    return np.maximum(_relative(np.abs(sum(linear)), linear), _relative(np.asarray(sum(moments)), products))


def _relative(residual: np.ndarray, terms: Sequence[np.ndarray]) -> np.ndarray:
    finite = np.isfinite(residual)
    peak = max((float(np.abs(t[np.isfinite(t)]).max(initial=0.0)) for t in map(np.asarray, terms)), default=0.0)
    return np.where(finite, np.abs(residual), 0.0) / (peak or 1.0)
