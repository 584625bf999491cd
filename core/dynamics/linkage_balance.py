"""Proof of a linkage's forces by laws they were not computed from: power, and momentum of all links."""

from __future__ import annotations

import numpy as np

from core.dynamics.linkage import LinkageForces, LinkLoading
from core.train import FRAME, REVOLUTE, Train
from core.vectors import cross, dot


def linkage_power_residual(train: Train, forces: LinkageForces, loading: LinkLoading) -> np.ndarray:
    """What driver or cam give against d(KE + PE)/dt less the power of the outer forces (n,), relative to the peak of its
    terms."""
    omega = forces.omega
    driver = train.motion.y[1] * omega
    given = forces.torque * driver + forces.camshaft * omega
    rates = omega ** np.arange(4)[:, None]
    terms = []
    for body, inertia in loading.inertias.items():
        z, angle = train.bodies[body].at(inertia.centre) * rates, train.bodies[body].angle * rates
        terms.append(inertia.mass * dot(z[1], z[2]) + inertia.about_centre * angle[1] * angle[2])
        terms.append(-inertia.mass * dot(z[1], np.asarray(loading.gravity)))
    for body, point, force, torque in loading.forces:
        terms.append(-dot(train.bodies[body].place(point, 1) * omega, np.asarray(force)))
        terms.append(-torque * train.bodies[body].turn[1] * omega)
    return _relative(given - sum(terms), [given, *terms])


def linkage_momentum_residual(
    train: Train,
    forces: LinkageForces,
    loading: LinkLoading,
    contact: tuple[np.ndarray, np.ndarray, float] | None = None,
) -> np.ndarray:
    """Outer forces and moments about the origin against the rates of momentum of all links (n,), relative to the peaks
    of their terms: power alone cannot see an error in a pin."""
    square = forces.omega * forces.omega
    push: list[np.ndarray] = []
    turn: list[np.ndarray] = []
    for name, pair in train.pairs.items():
        if FRAME in (pair.on, pair.body):
            sign = 1.0 if pair.on == FRAME else -1.0
            at = train.bodies[pair.body].place(pair.point)
            push.append(sign * forces.pairs[name])
            turn += [cross(at, sign * forces.pairs[name]), sign * forces.couples.get(name, np.zeros(at.size))]
            if {pair.on, pair.body} == {FRAME, train.output}:
                if pair.kind == REVOLUTE:
                    turn.append(forces.torque)
                else:
                    drive = forces.torque * pair.axis
                    push.append(drive)
                    turn.append(cross(at, drive))
    for body, point, force, torque in loading.forces:
        at = train.bodies[body].place(point)
        push.append(np.full(at.size, force))
        turn += [cross(at, np.asarray(force)), np.full(at.size, torque)]
    if contact is not None:
        reference, normal, _ = contact
        push.append(-forces.contact * normal)
        turn.append(cross(reference, -forces.contact * normal))
    for body, inertia in loading.inertias.items():
        centre, spin = train.bodies[body].carried(inertia.centre), train.bodies[body].turn[2]
        weight = inertia.mass * (loading.gravity - square * centre[2])
        push.append(weight)
        turn += [cross(centre[0], weight), -inertia.about_centre * square * spin]
    linear, angular = np.abs(np.sum(push, axis=0)), np.abs(np.sum(turn, axis=0))
    return np.maximum(_relative(linear, push), _relative(angular, turn))


def _relative(residual: np.ndarray, terms: list[np.ndarray]) -> np.ndarray:
    finite = np.isfinite(residual)
    peak = max((float(np.abs(t[np.isfinite(t)]).max(initial=0.0)) for t in terms), default=0.0)
    return np.where(finite, np.abs(residual), 0.0) / (peak or 1.0)
